/* A light piston in a pipe of heavy water: why the time coupling must iterate, and what each scheme makes of it.

   A force F sin(w t) drives a body of mass m along the pipe. The incompressible column before it moves as one, so the
   fluid answers with its own inertia, -M a: the worst case of added mass, where M / m decides. Exact: the two move as
   one body of mass m + M. The fluid here is what a host would write, a few lines between spar_fluid_pull_motion and
   spar_fluid_push_forces; spar_step does the rest of the loop. */
#include <math.h>
#include <spar/spar.h>
#include <stdio.h>

static const double body = 1, force = 10, frequency = 2, dt = 0.01; /* kg, N, rad/s, s */
enum { STEPS = 200 };

/* The water. */
typedef struct column {
    spar_fluid *face;
    double mass;
    double before, now; /* velocity of the piston at t^n, and in the latest iteration */
} column;

/* Its pressure on the piston at the end of the step, by backward Euler. */
static int solve_column(spar_session *session, double t, double dt_now, int iteration, void *context) {
    column *water = context;
    double v[3];
    (void)session, (void)t, (void)iteration;
    int status = spar_fluid_pull_motion(water->face, 1, NULL, v);
    if (status != SPAR_OK) {
        return status;
    }
    water->now = v[0];
    const double push[3] = {-water->mass * (v[0] - water->before) / dt_now, 0, 0};
    return spar_fluid_push_forces(water->face, push, NULL);
}

typedef struct outcome {
    int status;
    double iterations, error; /* mean per step; of the place at the end, relative to the exact one */
    char message[256];
} outcome;

static int build(spar_session *s, int scheme, spar_member **piston, column *water) {
    const double x[3] = {0}, q[4] = {1, 0, 0, 0};
    double mass[36] = {0};
    for (int i = 0; i < 6; i++) {
        mass[7 * i] = body;
    }
    int status = spar_session_set_coupling(s, scheme, 1e-9, 1e-6, 50);
    if (status == SPAR_OK) {
        status = spar_rigid_create(s, "piston", x, q, mass, piston);
    }
    if (status == SPAR_OK) {
        status = spar_member_commit(*piston);
    }
    if (status == SPAR_OK) {
        status = spar_fluid_create(*piston, "water", &water->face);
    }
    if (status == SPAR_OK) {
        status = spar_fluid_set_motion_nodes(water->face, 1, x);
    }
    if (status == SPAR_OK) {
        status = spar_fluid_set_force_nodes(water->face, 1, x);
    }
    return status == SPAR_OK ? spar_fluid_map(water->face) : status;
}

static int march(spar_session *s, spar_member *piston, column *water, outcome *out) {
    for (int i = 1; i <= STEPS; i++) {
        double load[6] = {force * sin(frequency * dt * i)};
        int iterations = 0, status = spar_member_add_load(piston, 0, load);
        if (status == SPAR_OK) {
            status = spar_step(s, dt, solve_column, water, &iterations);
        }
        if (status != SPAR_OK) {
            return status;
        }
        water->before = water->now;
        out->iterations += (double)iterations / STEPS;
    }
    return SPAR_OK;
}

static outcome run(int scheme, double ratio) {
    outcome out = {0};
    spar_session *s = NULL;
    spar_member *piston = NULL;
    column water = {.mass = ratio * body};
    out.status = spar_session_create(&s);
    if (out.status == SPAR_OK) {
        out.status = build(s, scheme, &piston, &water);
    }
    if (out.status == SPAR_OK) {
        out.status = march(s, piston, &water, &out);
    }
    if (out.status == SPAR_OK) {
        double q[7], t = STEPS * dt, w = frequency;
        double exact = force / (body + water.mass) / w * (t - sin(w * t) / w);
        out.status = spar_member_get_motion(piston, q, NULL, NULL);
        out.error = fabs(q[0] / exact - 1);
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
    char first[256] = "";
    printf("A piston of mass m driven against a column of water of mass M, %d steps\n"
           "iterations per step / error of the place at the end\n\n%8s",
           STEPS, "M / m");
    for (int k = 0; k < 4; k++) {
        printf("  %16s", schemes[k].name);
    }
    for (int i = 0; i < 6; i++) {
        printf("\n%8g", ratios[i]);
        for (int k = 0; k < 4; k++) {
            outcome out = run(schemes[k].scheme, ratios[i]);
            if (out.status == SPAR_OK && out.error < 0.5) {
                printf("  %7.1f %7.2f %%", out.iterations, 100 * out.error);
            } else {
                printf("  %16s", schemes[k].scheme == SPAR_COUPLING_EXPLICIT ? "diverges" : "no convergence");
                if (out.status == SPAR_ERR_NUMERIC && !first[0]) {
                    snprintf(first, sizeof first, "%s", out.message);
                }
            }
        }
    }
    printf("\n");
    if (first[0]) {
        printf("\nWhat the library says to it: %s\n", first);
    }
    return 0;
}
