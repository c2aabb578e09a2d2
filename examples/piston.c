/* Light pistons in pipes of heavy water: why the time coupling must iterate, and what each scheme makes of it.

   A force F sin(w t) drives each of four bodies of mass m along its pipe. The incompressible column before it moves as
   one with it, so the fluid answers with its own inertia, -M a: the worst case of added mass, where M / m decides. The
   columns differ (M, M/2, M/4, M/8), so that no single relaxation suits all four. Exact: each pair moves as one body
   of mass m + M. The fluid here is what a host would write, a few lines between spar_fluid_pull_motion and
   spar_fluid_push_forces; spar_step does the rest of the loop. */
#include <math.h>
#include <spar/spar.h>
#include <stdio.h>

static const double body = 1, force = 10, frequency = 2, dt = 0.01; /* kg, N, rad/s, s */
enum { STEPS = 200, PIPES = 4 };

typedef struct column {
    spar_member *piston;
    spar_fluid *face;
    double mass;
    double before, now; /* velocity of the piston at t^n, and in the latest iteration */
} column;

/* The pressure of the water on the pistons at the end of the step, by backward Euler. */
static int solve_water(spar_session *session, double t, double step, int iteration, void *context) {
    column *water = context;
    (void)session, (void)t, (void)iteration;
    for (int k = 0; k < PIPES; k++) {
        double v[3];
        int status = spar_fluid_pull_motion(water[k].face, 1, NULL, v);
        if (status != SPAR_OK) {
            return status;
        }
        water[k].now = v[0];
        const double push[3] = {-water[k].mass * (v[0] - water[k].before) / step, 0, 0};
        status = spar_fluid_push_forces(water[k].face, push, NULL);
        if (status != SPAR_OK) {
            return status;
        }
    }
    return SPAR_OK;
}

typedef struct outcome {
    int status;
    double iterations, error; /* mean per step; largest of the places at the end, relative to the exact ones */
    char message[512];
} outcome;

static int build_pipe(spar_session *s, int k, column *water) {
    const double x[3] = {0, k, 0}, q[4] = {1, 0, 0, 0};
    double mass[36] = {0};
    char name[16];
    for (int i = 0; i < 6; i++) {
        mass[7 * i] = body;
    }
    snprintf(name, sizeof name, "piston%d", k + 1);
    int status = spar_rigid_create(s, name, x, q, mass, &water->piston);
    if (status == SPAR_OK) {
        status = spar_member_commit(water->piston);
    }
    if (status == SPAR_OK) {
        status = spar_fluid_create(water->piston, name, &water->face);
    }
    if (status == SPAR_OK) {
        status = spar_fluid_set_motion_nodes(water->face, 1, x);
    }
    if (status == SPAR_OK) {
        status = spar_fluid_set_force_nodes(water->face, 1, x);
    }
    return status == SPAR_OK ? spar_fluid_map(water->face) : status;
}

static int march(spar_session *s, column *water, outcome *out) {
    for (int i = 1; i <= STEPS; i++) {
        const double load[6] = {force * sin(frequency * dt * i)};
        int iterations = 0, status = SPAR_OK;
        for (int k = 0; k < PIPES && status == SPAR_OK; k++) {
            status = spar_member_set_load(water[k].piston, 0, SPAR_LOAD_DEAD, load);
        }
        if (status == SPAR_OK) {
            status = spar_step(s, dt, solve_water, water, &iterations);
        }
        if (status != SPAR_OK) {
            return status;
        }
        for (int k = 0; k < PIPES; k++) {
            water[k].before = water[k].now;
        }
        out->iterations += (double)iterations / STEPS;
    }
    return SPAR_OK;
}

/* x = F / ((m + M) w) (t - sin(w t) / w) */
static int compare(const column *water, outcome *out) {
    double t = STEPS * dt, w = frequency;
    for (int k = 0; k < PIPES; k++) {
        double q[7], exact = force / (body + water[k].mass) / w * (t - sin(w * t) / w);
        int status = spar_member_get_motion(water[k].piston, q, NULL, NULL);
        if (status != SPAR_OK) {
            return status;
        }
        out->error = fmax(out->error, fabs(q[0] / exact - 1));
    }
    return SPAR_OK;
}

static outcome run(int scheme, double ratio) {
    outcome out = {0};
    spar_session *s = NULL;
    column water[PIPES] = {{0}};
    out.status = spar_session_create(&s);
    if (out.status == SPAR_OK) {
        out.status = spar_session_set_coupling(s, scheme, 1e-9, 1e-6, 50);
    }
    for (int k = 0; k < PIPES && out.status == SPAR_OK; k++) {
        water[k].mass = ratio * body / (1 << k);
        out.status = build_pipe(s, k, &water[k]);
    }
    if (out.status == SPAR_OK) {
        out.status = march(s, water, &out);
    }
    if (out.status == SPAR_OK) {
        out.status = compare(water, &out);
    }
    snprintf(out.message, sizeof out.message, "%s", spar_session_message(s));
    spar_session_destroy(&s);
    return out;
}

int main(void) {
    static const struct {
        const char *name;
        int scheme;
    } schemes[] = {{"explicit", SPAR_COUPLING_EXPLICIT},
                   {"fixed point", SPAR_COUPLING_FIXED_POINT},
                   {"Aitken", SPAR_COUPLING_AITKEN},
                   {"IQN-ILS", SPAR_COUPLING_IQN_ILS}};
    static const double ratios[] = {0.1, 0.5, 0.9, 2, 10, 100};
    char first[512] = "";
    printf("Four pistons of mass m driven against columns of water of mass M, M/2, M/4, M/8; %d steps\n"
           "iterations per step / largest error of the places at the end\n\n%8s",
           STEPS, "M / m");
    for (int k = 0; k < 4; k++) {
        printf("  %16s", schemes[k].name);
    }
    for (int i = 0; i < 6; i++) {
        printf("\n%8g", ratios[i]);
        for (int k = 0; k < 4; k++) {
            outcome out = run(schemes[k].scheme, ratios[i]);
            if (out.status == SPAR_OK && out.error < 0.5) {
                printf("  %7.1f %7.2f%%", out.iterations, 100 * out.error);
                continue;
            }
            printf("  %16s", schemes[k].scheme == SPAR_COUPLING_EXPLICIT ? "diverges" : "no convergence");
            if (out.status == SPAR_ERR_NUMERIC && !first[0]) {
                snprintf(first, sizeof first, "%s", out.message);
            }
        }
    }
    printf("\n");
    if (first[0]) {
        printf("\nWhat the library says to it: %s\n", first);
    }
    return 0;
}
