/* Eigenvalues of structure and fluid together, for example a flutter speed without time integration. The structure
   is that of spar_member_solve_eigenvalues, reduced to some of its modes. The fluid's response to motion in these
   modes comes from trials. */
#include "../trial/handle.h"
#include "reduced_model.h"
#include "shapes.h"

#include "../assembly/assembly.h"
#include "../base/environment.h"
#include "../exchange/rank_loads_and_motion.h"

#include <math.h>
#include <string.h>

static const double common_amplitude = 1e-5;
/* Maximum deviation of the fluid's decay from that of a linear system, relative to the largest load. */
static const double most_misfit = 1e-3;

typedef struct coupled_ask {
    spari_response_query fluid;
    int64_t n;
    double complex shift;
    double *eigenvalue, *shapes; /* of the host */
} coupled_ask;

/* M, C, K of the shapes. room [size] */
static void reduce_structure(const spari_small_motions *w, const double *shape, double *workspace, spari_reduced *r) {
    double *to[3] = {r->K, r->C, r->M};
    for (int kind = 0; kind < 3; kind++) {
        for (int j = 0; j < r->n; j++) {
            spari_shapes_times(&w->pencil, kind, shape + (int64_t)w->size * j, workspace);
            for (int i = 0; i < r->n; i++) {
                to[kind][r->n * i + j] = spari_shapes_product(w->size, shape + (int64_t)w->size * i, workspace);
            }
        }
    }
}

/* ---- the call ---- */

typedef struct coupled {
    spari_small_motions motions;
    spari_reduced reduced;
    double *shape, *rate, *nodes, *workspace;
    double complex *value, *x;
} coupled;

/* The structure's part, computed on every rank. */
static int find_structure(spar_session *s, const coupled_ask *ask, coupled *c) {
    int64_t modes = ask->fluid.modes, n = ask->n;
    SPARI_TRY(spari_joints_place(s));
    SPARI_TRY(spari_small_motions_create(&c->motions, s, NULL));
    c->reduced = (spari_reduced){.n = (int)modes, .dt = ask->fluid.run.dt, .memory = ask->fluid.memory};
    c->shape = spari_zalloc((modes + 1) * c->motions.size + modes, sizeof *c->shape);
    c->nodes = spari_zalloc(6 * modes * ask->fluid.nodes, sizeof *c->nodes);
    c->value = spari_zalloc(n + n * modes, sizeof *c->value);
    int there = c->shape && c->nodes && c->value && spari_reduced_create(&c->reduced) == SPAR_OK;
    SPARI_REQUIRE(s, there, SPAR_ERR_MEMORY, "no memory for %lld modes", (long long)modes);
    c->workspace = c->shape + modes * c->motions.size;
    c->rate = c->workspace + c->motions.size;
    c->x = c->value + n;
    SPARI_TRY(spari_shapes_find(&c->motions, (int)modes, c->shape, c->rate));
    for (int k = 0; k < modes; k++) {
        c->reduced.fastest = fmax(c->reduced.fastest, c->rate[k]);
    }
    spari_shapes_show(&c->motions, (int)modes, c->shape, c->nodes);
    reduce_structure(&c->motions, c->shape, c->workspace, &c->reduced);
    return SPAR_OK;
}

static int find_eigenvalues(spar_session *s, const coupled_ask *ask, coupled *c) {
    int found = 0, status = spari_reduced_prepare(&c->reduced);
    SPARI_REQUIRE(
        s, status != SPAR_OK || c->reduced.misfit <= most_misfit, SPAR_ERR_NUMERIC,
        "after the motion the fluid's loads do not decay like those of a linear system, relative error %.1e: give more "
        "steps of memory, a fluid with tighter tolerance or initially at rest, or a larger amplitude",
        c->reduced.misfit);
    if (status == SPAR_OK) {
        status = spari_reduced_solve(&c->reduced, (int)ask->n, ask->shift, &found, c->value, c->x);
    }
    SPARI_REQUIRE(s, status != SPAR_ERR_MEMORY, status, "no memory for %lld eigenvalues", (long long)ask->n);
    SPARI_REQUIRE(s, status == SPAR_OK, status, "the fluid's loads are not finite, or its added mass cancels all mass");
    SPARI_REQUIRE(s, found >= ask->n, SPAR_ERR_NUMERIC,
                  "only %d of %lld eigenvalues found; the others belong to the fluid, or are too fast for dt = %g s: "
                  "give more modes, or a smaller dt",
                  found, (long long)ask->n, ask->fluid.run.dt);
    return SPAR_OK;
}

static void hand_eigenvalues(const coupled_ask *ask, const coupled *c) {
    int modes = ask->fluid.modes;
    int64_t size = 6 * ask->fluid.nodes;
    for (int64_t k = 0; k < ask->n; k++) {
        ask->eigenvalue[2 * k] = creal(c->value[k]);
        ask->eigenvalue[2 * k + 1] = cimag(c->value[k]);
        for (int64_t i = 0; i < size && ask->shapes; i++) {
            double complex sum = 0;
            for (int j = 0; j < modes; j++) {
                sum += c->x[modes * k + j] * c->nodes[size * j + i];
            }
            ask->shapes[2 * (size * k + i)] = creal(sum);
            ask->shapes[2 * (size * k + i) + 1] = cimag(sum);
        }
    }
}

static int solve_coupled(spar_session *s, const char *call, coupled_ask *ask, double frame[3]) {
    coupled c = {.shape = NULL};
    int status = find_structure(s, ask, &c);
    status = spari_agree(s, status);
    if (status == SPAR_OK) {
        ask->fluid.motions = &c.motions;
        ask->fluid.shape = c.nodes;
        ask->fluid.rate = c.rate;
        status = spari_fluid_response_find(s, call, &ask->fluid, &c.reduced.response);
        ask->fluid.motions = NULL; /* these live here alone */
        ask->fluid.shape = NULL;
    }
    if (status == SPAR_OK) {
        status = find_eigenvalues(s, ask, &c);
        status = spari_agree(s, status);
    }
    if (status == SPAR_OK) {
        hand_eigenvalues(ask, &c);
        spari_give(frame, c.motions.w, 3);
    }
    spari_small_motions_free(&c.motions);
    spari_reduced_free(&c.reduced);
    SPARI_FREE(c.shape, c.nodes, c.value);
    return status;
}

/* A fluid with a state kept between steps does not show it in trials of one step. */
static int check_memory(spar_session *s, const char *call) {
    for (const spar_fluid *f = s->fluids; f; f = spari_fluid_next(f)) {
        int64_t width = 0;
        SPARI_TRY(spar_fluid_get_states(f, &width, NULL));
        SPARI_REQUIRE(
            s, width == 0, SPAR_ERR_ARGUMENT,
            "%s: fluid '%s' has states that last from step to step; a memory of 0 steps ignores them; give more steps",
            call, spar_fluid_get_name(f));
    }
    return SPAR_OK;
}

static int check_coupled(spar_trial *t, const char *call, const coupled_ask *ask, int64_t nodes,
                         const double shift[2]) {
    spar_session *s = t->session;
    SPARI_TRY(spari_shapes_ready(t, call, ask->n, "eigenvalues", ask->eigenvalue));
    SPARI_REQUIRE(
        s, t->solve, SPAR_ERR_UNSUPPORTED,
        "%s: the trial has no fluid solver; give spar_trial_set_callbacks the solver passed to spar_step, or use "
        "spar_member_solve_eigenvalues",
        call);
    SPARI_TRY(t->memory == 0 ? check_memory(s, call) : SPAR_OK);
    SPARI_REQUIRE(s, !ask->shapes || nodes == ask->fluid.nodes, SPAR_ERR_ARGUMENT,
                  "%s: shapes of %lld nodes; all members together have %lld", call, (long long)nodes,
                  (long long)ask->fluid.nodes);
    SPARI_REQUIRE(s, !shift || (isfinite(shift[0]) && isfinite(shift[1])), SPAR_ERR_ARGUMENT,
                  "%s: the shift is not finite; give finite numbers", call);
    return SPAR_OK;
}

int spar_trial_solve_eigenvalues(spar_trial *trial, int64_t n, const double shift[2], double *eigenvalue, int64_t nodes,
                                 double *shapes, double frame[3]) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_REQUIRE(NULL, trial, SPAR_ERR_ARGUMENT, "%s: the trial is NULL; create it first", __func__);
    spar_session *s = trial->session;
    spari_progress progress = spari_trial_progress(trial, __func__);
    coupled_ask ask = {.n = n, .shift = shift ? CMPLX(shift[0], fabs(shift[1])) : 0};
    ask.eigenvalue = eigenvalue, ask.shapes = shapes;
    ask.fluid = (spari_response_query){.run = spari_trial_run_of(trial, &progress), .memory = trial->memory};
    ask.fluid.run.steps = SPARI_MULTIPLE;
    ask.fluid.amplitude = trial->amplitude == 0 ? common_amplitude : trial->amplitude;
    ask.fluid.modes = (int)trial->modes;
    ask.fluid.nodes = spari_shapes_nodes(s);
    const spari_agreed arguments[] = {spari_whole("n", n)};
    SPARI_TRY(spari_trial_enter(trial, __func__, arguments, 1, check_coupled(trial, __func__, &ask, nodes, shift)));
    int status = solve_coupled(s, __func__, &ask, frame);
    return spari_trial_leave(trial, __func__, spari_progress_ends(&progress, status));
}
