/* The rotor's blades in the wind. Once a step, when code_saturne asks for the source terms of momentum: the structure
   goes from t^n to t^{n+1} in the flow of t^n, which it sees where its sections are at t^{n+1/2}, and what it takes
   from the flow is spread there: places and forces are both those of the middle of the step. The aerodynamics have no
   induction of their own, the flow has it. All members are on all ranks; sections and aerodynamics are on rank 0. */
#include "cs_base.h"
#include "cs_headers.h"
#include "cs_prototypes.h"
#include "line.h"
#include "nrel5mw.h"
#include "spar_saturne.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { BLADES = 3, ELEMENTS = 1, NODES = 10, MOST = 64 /* sections of a blade */ };

static struct {
    nrel5mw data;
    nrel5mw_rotor rotor;
    spar_member *blade[BLADES];
    spar_fluid *sections[BLADES]; /* rank 0 */
    spar_aero *aero;
    int n, step; /* sections of all blades; last step made */
    double speed, width, angle;
    double x[3 * BLADES * MOST], u[3 * BLADES * MOST], force[3 * BLADES * MOST], weight[BLADES * MOST];
    FILE *history;
} lines;

static void check_data(int status) {
    if (status != SPAR_OK) {
        bft_error(__FILE__, __LINE__, 0, "rotor: %s: %s", spar_status_text(status),
                  lines.data.message[0] != '\0' ? lines.data.message : spar_session_message(saturne_session()));
    }
}

static int first_rank(void) {
    return cs_glob_rank_id < 1;
}

static void make_blade(int b, double *twist) {
    double omega[3];
    for (int i = 0; i < 3; i++) {
        omega[i] = lines.speed * lines.rotor.axis[i];
    }
    check_data(nrel5mw_create_blade(&lines.data, &lines.rotor, saturne_session(), b, ELEMENTS, NODES, &lines.blade[b]));
    saturne_check(spar_member_commit(lines.blade[b]));
    saturne_check(spar_member_set_initial_velocity(lines.blade[b], lines.rotor.hub, NULL, omega));
    if (first_rank()) {
        check_data(nrel5mw_create_sections(&lines.data, &lines.rotor, b, lines.blade[b], &lines.sections[b], twist));
    }
}

void cs_user_extra_operations_initialize(cs_domain_t *domain) {
    const char *data = getenv("SPAR_DATA"); /* the run script's: examples/data */
    char folder[1024];
    double twist[MOST];
    (void)domain;
    saturne_clock_begin();
    snprintf(folder, sizeof folder, "%s/nrel5mw", data != NULL ? data : ".");
    check_data(nrel5mw_load(&lines.data, folder));
    if (lines.data.aero_n > MOST || lines.data.blades != BLADES) {
        bft_error(__FILE__, __LINE__, 0, "rotor: %d blades of at most %d sections are foreseen", BLADES, MOST);
    }
    lines.data.tilt = lines.data.precone = 0;
    nrel5mw_rotor_default(&lines.data, &lines.rotor);
    lines.n = BLADES * (int)lines.data.aero_n;
    lines.speed = saturne_number("rpm", NULL) * acos(-1.) / 30;
    lines.width = saturne_number("kernel", NULL);
    for (int b = 0; b < BLADES; b++) {
        make_blade(b, twist);
    }
    check_data(
        nrel5mw_create_aero(&lines.data, &lines.rotor, first_rank() ? BLADES : 0, lines.sections, twist, &lines.aero));
    saturne_check(spar_aero_set_effects(lines.aero, SPAR_AERO_DRAG | SPAR_AERO_MOMENT));
    saturne_resume(NULL);
    saturne_check_keys();
    lines.angle = lines.speed * cs_glob_time_step->t_prev;
    saturne_clock_end();
}

/* What rank 0 knows of its sections, to all. */
static void tell_all(double *x) {
    cs_parall_bcast(0, 3 * lines.n, CS_DOUBLE, x);
}

static void drive(double dt) {
    lines.angle += lines.speed * dt;
    for (int b = 0; b < BLADES; b++) {
        double q[7], v[6], a[6];
        nrel5mw_root_motion(&lines.data, &lines.rotor, b, lines.angle, lines.speed, 0, q, v, a);
        saturne_check(spar_member_drive(lines.blade[b], q, v, a));
    }
}

static void places(void) {
    const int n = lines.n / BLADES;
    for (int b = 0; first_rank() && b < BLADES; b++) {
        saturne_check(spar_fluid_pull_motion(lines.sections[b], 0.5, lines.x + 3 * n * b, NULL));
    }
    saturne_clock_end();
    tell_all(lines.x);
    saturne_clock_begin();
}

/* The step of the structure. Its sections see the flow at their first places of this step; iterations move them by
   millimetres. */
static void advance(double dt) {
    const int n = lines.n / BLADES;
    int done = 0;
    saturne_clock_begin();
    drive(dt);
    saturne_check(spar_step_begin(saturne_session(), dt));
    saturne_check(spar_step_solve(saturne_session()));
    places();
    saturne_clock_end();
    line_sample(lines.width, lines.n, lines.x, lines.weight, lines.u);
    saturne_clock_begin();
    while (!done) {
        saturne_check(spar_aero_solve(lines.aero, 1.225, lines.u, 1));
        saturne_check(spar_step_check(saturne_session(), &done));
        if (!done) {
            saturne_check(spar_step_solve(saturne_session()));
        }
    }
    places();
    for (int b = 0; first_rank() && b < BLADES; b++) {
        saturne_check(spar_fluid_pull_forces(lines.sections[b], 0.5, lines.force + 3 * n * b));
    }
    saturne_clock_end();
    tell_all(lines.force);
    line_sample(lines.width, lines.n, lines.x, lines.weight, lines.u); /* the kernel where the force is */
}

/* Power that the source takes from the flow, W, and its force, N. Collective. */
static double measure(const cs_real_3_t *source, double total[3]) {
    const cs_real_3_t *u = (const cs_real_3_t *)CS_F_(vel)->val;
    double sums[4] = {0};
    for (cs_lnum_t cell = 0; cell < cs_glob_mesh->n_cells; cell++) {
        for (int k = 0; k < 3; k++) {
            sums[k] -= source[cell][k];
            sums[3] -= source[cell][k] * u[cell][k];
        }
    }
    cs_parall_sum(4, CS_DOUBLE, sums);
    memcpy(total, sums, 3 * sizeof *total);
    return sums[3];
}

/* Power of the line's forces on the moving sections, in the middle of the step, W: on rank 0. */
static double line_power(void) {
    const int n = lines.n / BLADES;
    double v[3 * MOST], power = 0;
    for (int b = 0; b < BLADES; b++) {
        saturne_check(spar_fluid_pull_motion(lines.sections[b], 0.5, NULL, v));
        for (int i = 0; i < 3 * n; i++) {
            power += lines.force[3 * n * b + i] * v[i];
        }
    }
    return power;
}

/* Within the step, whose end is t + dt. */
static void record(const cs_real_3_t *source, double dt, const double tip[3]) {
    double spread[3], line[3] = {0}, least = 1e300, most = 0, thrust, torque, shaft, t;
    const double taken = measure(source, spread), ideal = pow(acos(-1.), 1.5) * pow(lines.width, 3);
    int iterations;
    if (!first_rank()) {
        return;
    }
    for (int i = 0; i < lines.n; i++) {
        least = CS_MIN(least, lines.weight[i] / ideal), most = CS_MAX(most, lines.weight[i] / ideal);
        for (int k = 0; k < 3; k++) {
            line[k] += lines.force[3 * i + k];
        }
    }
    saturne_check(spar_aero_get_rotor(lines.aero, &thrust, &torque, &shaft));
    saturne_check(spar_session_get_time(saturne_session(), &t, NULL, &iterations));
    if (lines.history == NULL) {
        lines.history = saturne_open_history(t + dt, "time_s,thrust_N,shaft_power_W,line_x_N,line_y_N,line_z_N,"
                                                     "spread_x_N,spread_y_N,spread_z_N,line_power_W,flow_power_W,"
                                                     "kernel_least,kernel_most,tip_x_m,iterations");
    }
    fprintf(lines.history, "%.9g,%.9e,%.9e,%.9e,%.9e,%.9e,%.9e,%.9e,%.9e,%.9e,%.9e,%.6f,%.6f,%.6e,%d\n", t + dt, thrust,
            shaft, line[0], line[1], line[2], spread[0], spread[1], spread[2], line_power(), taken, least, most, tip[0],
            iterations);
    fflush(lines.history);
}

void cs_user_source_terms(cs_domain_t *domain, int f_id, cs_real_t *st_exp, cs_real_t *st_imp) {
    cs_real_3_t *source = (cs_real_3_t *)st_exp;
    double q[7 * ELEMENTS * NODES];
    (void)st_imp, (void)domain;
    if (f_id != CS_F_(vel)->id) {
        return;
    }
    const int now = cs_glob_time_step->nt_cur, first = now != lines.step;
    if (first) {
        lines.step = now;
        advance(cs_glob_time_step->dt_ref);
    }
    line_spread(lines.width, lines.n, lines.x, lines.weight, lines.force, source);
    if (first) {
        saturne_check(spar_member_get_motion(lines.blade[0], q, NULL, NULL));
        record((const cs_real_3_t *)source, cs_glob_time_step->dt_ref, q + 7 * (ELEMENTS * NODES - 1));
        saturne_check(spar_step_accept(saturne_session()));
    }
}

void cs_user_extra_operations_finalize(cs_domain_t *domain) {
    double seconds[2];
    (void)domain;
    saturne_clock_read(seconds);
    if (first_rank()) {
        FILE *f = fopen("summary.txt", "w");
        if (f != NULL) {
            fprintf(f, "seconds %.3f\nspar_seconds %.3f\nspar_share %.5f\n", seconds[1], seconds[0],
                    seconds[0] / seconds[1]);
            fclose(f);
        }
        if (lines.history != NULL) {
            fclose(lines.history);
        }
    }
    spar_aero_destroy(&lines.aero);
    saturne_end();
    nrel5mw_free(&lines.data);
}
