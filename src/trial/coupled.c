/* Eigenvalues of structure and fluid together: a flutter speed without marching in time. The structure is what
   spar_member_solve_eigenvalues takes, in some of its modes; the fluid's answer to motion in these comes from trials.
 */
#include "reduced.h"

#include "../base/quiet.h"
#include "../comm/enter.h"
#include "../session/exchange.h"
#include "../solve/assembly.h"
#include "../solve/fidelity.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double common_amplitude = 1e-5, most_amplitude = 0.1;
enum { MOST_MODES = 200 };
static const int64_t most_memory = 1000000;
/* Of the largest load, what a fluid's way to rest may differ from that of a linear system. */
static const double most_misfit = 1e-3;

typedef struct coupled_ask {
    spari_answer_ask fluid;
    int64_t n;
    double complex shift;
    double *eigenvalue, *shapes; /* the host's */
} coupled_ask;

/* ---- shapes ---- */

/* K, C or M (kind 0, 1, 2) times x. */
static void pencil_times(const spari_pencil *p, int kind, const double *x, double *y) {
    memset(y, 0, (size_t)p->n * sizeof *y);
    spari_pencil_times(p, 0, kind == 0, kind == 1, kind == 2, x, y);
}

static double shapes_product(int n, const double *a, const double *b) {
    double sum = 0;
    for (int i = 0; i < n; i++) {
        sum += a[i] * b[i];
    }
    return sum;
}

/* The undamped, symmetric part, whose eigenvectors are the shapes; with so much of M in K, which changes none of them.
 */
static int symmetric_part(const spari_pencil *p, double more, spari_pencil *to) {
    if (spari_pencil_create(to, p->n) != SPAR_OK) {
        return SPAR_ERR_MEMORY;
    }
    to->holds = p->holds;
    for (int64_t i = 0; i < p->entries; i++) {
        const spari_pencil_entry *e = p->entry + i;
        double k = 0.5 * (e->k + more * e->m), m = 0.5 * e->m;
        spari_pencil_put(to, (spari_pencil_entry){e->row, e->column, k, 0, m});
        spari_pencil_put(to, (spari_pencil_entry){e->column, e->row, k, 0, m});
    }
    for (int64_t i = 0; i < p->ties; i++) {
        spari_pencil_hold_at(to, p->tie[i]);
    }
    return to->full ? SPAR_ERR_MEMORY : SPAR_OK;
}

/* x, or its imaginary part, without what is along the `count` shapes there are; kept behind them if anything of it is
   left. room [2 n] */
static int add_shape(const spari_pencil *p, const double complex *x, int imaginary, int count, double *shape,
                     double *room) {
    int n = p->n;
    double *at = shape + (int64_t)n * count, *Mx = room;
    for (int i = 0; i < n; i++) {
        at[i] = imaginary ? cimag(x[i]) : creal(x[i]);
    }
    for (int pass = 0; pass < 2; pass++) {
        for (int k = 0; k < count; k++) {
            const double *other = shape + (int64_t)n * k;
            pencil_times(p, 2, other, Mx);
            double along = shapes_product(n, Mx, at);
            for (int i = 0; i < n; i++) {
                at[i] -= along * other[i];
            }
        }
        pencil_times(p, 2, at, Mx);
        double square = shapes_product(n, at, Mx);
        if (!(square > (pass == 0 ? 1e-8 : 0))) {
            return 0;
        }
        for (int i = 0; i < n; i++) {
            at[i] /= sqrt(square);
        }
    }
    return 1;
}

/* A little stiffness, by mass, for where there are motions without any; more than rounding makes of it. */
static double some_stiffness(const spari_pencil *p, double *diagonal) {
    double most = 0;
    memset(diagonal, 0, 2 * (size_t)p->n * sizeof *diagonal);
    for (int64_t i = 0; i < p->entries; i++) {
        const spari_pencil_entry *e = p->entry + i;
        diagonal[e->row] += e->row == e->column ? e->k : 0;
        diagonal[p->n + e->row] += e->row == e->column ? e->m : 0;
    }
    for (int i = 0; i < p->n; i++) {
        most = fmax(most, diagonal[p->n + i] > 0 ? fabs(diagonal[i]) / diagonal[p->n + i] : 0);
    }
    return most > 0 ? 1e-12 * most : 1;
}

/* `modes` shapes of unit mass [modes][size] and their rates; *count: how many there are. */
static int search_shapes(const spari_swing *w, int modes, double more, double complex *value, double *shape,
                         double *rate, double *room, int *count) {
    spari_pencil part = {0};
    int n = w->size, found = 0, status = symmetric_part(&w->pencil, more, &part);
    double complex *x = value + modes;

    *count = 0;
    if (status == SPAR_OK) {
        status = spari_spectrum(&part, modes, 0, SPARI_SPECTRUM_CHOICE, &found, value, x);
    }
    for (int k = 0; k < 2 * found && *count < modes && status == SPAR_OK; k++) {
        if (add_shape(&w->pencil, x + (int64_t)n * (k / 2), k % 2, *count, shape, room)) {
            double square = fabs(creal(value[k / 2] * value[k / 2]) + more);
            rate[(*count)++] = square > 1e-3 * more ? sqrt(square) : 0;
        }
    }
    spari_pencil_free(&part);
    return status;
}

static int find_shapes(spari_swing *w, int modes, double *shape, double *rate) {
    int64_t n = w->size;
    int count = 0;
    double complex *value = spari_zalloc(modes * (n + 1), sizeof *value);
    double *room = spari_zalloc(2 * n, sizeof *room), most = 0;
    int status = value && room ? SPAR_OK : SPAR_ERR_MEMORY;
    for (int pass = 0; pass < 2 && count < modes && status != SPAR_ERR_MEMORY; pass++) {
        double more = pass ? some_stiffness(&w->pencil, room) : 0;
        status = search_shapes(w, modes, more, value, shape, rate, room, &count);
    }
    for (int k = 0; k < count; k++) {
        most = fmax(most, rate[k]);
    }
    for (int k = 0; k < count; k++) {
        rate[k] = fmax(rate[k], most > 0 ? 0.01 * most : 1);
    }
    free(value);
    free(room);
    SPARI_REQUIRE(w->session, status != SPAR_ERR_MEMORY, status, "no memory for %d modes", modes);
    SPARI_REQUIRE(w->session, status == SPAR_OK && count == modes, SPAR_ERR_NUMERIC,
                  "%d of %d modes; the others have no mass, or have not converged: ask for fewer", count, modes);
    return SPAR_OK;
}

/* As motion of the nodes of all members [modes][nodes][6]; what spar does not solve for stands still. */
static void show_shapes(const spari_swing *w, int modes, const double *shape, double *nodes) {
    for (int k = 0; k < modes; k++, shape += w->size) {
        for (const spar_member *m = w->session->members; m; m = m->next) {
            const swing_part *part = spari_swing_part(w, m);
            if (part) {
                m->row->shape(m, shape + part->at, w->room, nodes);
            }
            nodes += 6 * m->nodes;
        }
    }
}

/* M, C, K of the shapes. room [size] */
static void reduce_structure(const spari_swing *w, const double *shape, double *room, spari_reduced *r) {
    double *to[3] = {r->K, r->C, r->M};
    for (int kind = 0; kind < 3; kind++) {
        for (int j = 0; j < r->n; j++) {
            pencil_times(&w->pencil, kind, shape + (int64_t)w->size * j, room);
            for (int i = 0; i < r->n; i++) {
                to[kind][r->n * i + j] = shapes_product(w->size, shape + (int64_t)w->size * i, room);
            }
        }
    }
}

/* ---- the call ---- */

typedef struct coupled {
    spari_swing swing;
    spari_reduced reduced;
    double *shape, *rate, *nodes, *room;
    double complex *value, *x;
} coupled;

static void coupled_free(coupled *c) {
    spari_swing_free(&c->swing);
    spari_reduced_free(&c->reduced);
    free(c->shape);
    free(c->nodes);
    free(c->value);
}

/* The structure's part, on every rank by itself. */
static int find_structure(spar_session *s, const coupled_ask *ask, coupled *c) {
    int64_t modes = ask->fluid.modes, n = ask->n;
    SPARI_TRY(spari_joints_place(s));
    SPARI_TRY(spari_swing_create(&c->swing, s, NULL));
    SPARI_REQUIRE(s, c->swing.parts > 0, SPAR_ERR_UNSUPPORTED, "there is no member that spar solves for");
    SPARI_REQUIRE(s, modes <= c->swing.size, SPAR_ERR_ARGUMENT, "%lld modes; there are %d unknowns", (long long)modes,
                  c->swing.size);
    c->reduced = (spari_reduced){.n = (int)modes, .dt = ask->fluid.run.dt, .memory = ask->fluid.memory};
    c->shape = spari_zalloc((modes + 1) * c->swing.size + modes, sizeof *c->shape);
    c->nodes = spari_zalloc(6 * modes * ask->fluid.nodes, sizeof *c->nodes);
    c->value = spari_zalloc(n + n * modes, sizeof *c->value);
    int there = c->shape && c->nodes && c->value && spari_reduced_create(&c->reduced) == SPAR_OK;
    SPARI_REQUIRE(s, there, SPAR_ERR_MEMORY, "no memory for %lld modes", (long long)modes);
    c->room = c->shape + modes * c->swing.size;
    c->rate = c->room + c->swing.size;
    c->x = c->value + n;
    SPARI_TRY(find_shapes(&c->swing, (int)modes, c->shape, c->rate));
    for (int k = 0; k < modes; k++) {
        c->reduced.fastest = fmax(c->reduced.fastest, c->rate[k]);
    }
    show_shapes(&c->swing, (int)modes, c->shape, c->nodes);
    reduce_structure(&c->swing, c->shape, c->room, &c->reduced);
    return SPAR_OK;
}

static int check_fluid(spar_session *s, const spari_reduced *r) {
    SPARI_REQUIRE(s, r->misfit <= most_misfit, SPAR_ERR_NUMERIC,
                  "once the motion has ended, the fluid's loads do not come to rest as those of a linear system do, by "
                  "%.1e of them: give more steps of memory, a fluid that is solved more tightly or at rest before, or "
                  "a larger amplitude",
                  r->misfit);
    return SPAR_OK;
}

static int find_eigenvalues(spar_session *s, const coupled_ask *ask, coupled *c) {
    int found = 0, status = spari_reduced_prepare(&c->reduced);
    SPARI_TRY(status == SPAR_OK ? check_fluid(s, &c->reduced) : SPAR_OK);
    if (status == SPAR_OK) {
        status = spari_reduced_solve(&c->reduced, (int)ask->n, ask->shift, &found, c->value, c->x);
    }
    SPARI_REQUIRE(s, status != SPAR_ERR_MEMORY, status, "no memory for %lld eigenvalues", (long long)ask->n);
    SPARI_REQUIRE(s, status == SPAR_OK, status,
                  "the fluid's loads have no numbers, or what it accelerates takes all of the mass");
    SPARI_REQUIRE(s, found >= ask->n, SPAR_ERR_NUMERIC,
                  "%d of %lld eigenvalues; the others are the fluid's own, or faster than dt = %g s shows: give more "
                  "modes, or a smaller dt",
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
    status = spari_comm_agree(s->comm, status, s->message, sizeof s->message);
    if (status == SPAR_OK) {
        ask->fluid.swing = &c.swing;
        ask->fluid.shape = c.nodes;
        ask->fluid.rate = c.rate;
        status = spari_answer_find(s, call, &ask->fluid, &c.reduced.answer);
    }
    if (status == SPAR_OK) {
        status = find_eigenvalues(s, ask, &c);
        status = spari_comm_agree(s->comm, status, s->message, sizeof s->message);
    }
    if (status == SPAR_OK) {
        hand_eigenvalues(ask, &c);
        if (frame) {
            memcpy(frame, c.swing.w, sizeof c.swing.w);
        }
    }
    coupled_free(&c);
    return status;
}

/* What a fluid keeps from step to step no trial of one step shows. */
static int check_memory(spar_session *s, const char *call) {
    for (const spar_fluid *f = s->fluids; f; f = spari_fluid_next(f)) {
        int64_t width = 0;
        SPARI_TRY(spar_fluid_get_states(f, &width, NULL));
        SPARI_REQUIRE(
            s, width == 0, SPAR_ERR_ARGUMENT,
            "%s: fluid '%s' keeps states from step to step, which a memory of 0 steps does not see; give some "
            "more",
            call, spar_fluid_get_name(f));
    }
    return SPAR_OK;
}

static int check_coupled(spar_session *s, const char *call, const coupled_ask *ask, int64_t nodes,
                         const double shift[2], const double *eigenvalue) {
    const spari_answer_ask *f = &ask->fluid;
    SPARI_TRY(spari_trial_check(s, call, &f->run));
    SPARI_TRY(s->started ? SPAR_OK : spari_session_pushes(s, call));
    SPARI_REQUIRE(s, f->run.solve, SPAR_ERR_UNSUPPORTED,
                  "%s: without a fluid solver there is no answer; give the one that spar_step is given, or see "
                  "spar_member_solve_eigenvalues",
                  call);
    SPARI_REQUIRE(s, f->memory >= 0 && f->memory <= most_memory, SPAR_ERR_ARGUMENT,
                  "%s: a memory of %lld steps; give 0 to %lld", call, (long long)f->memory, (long long)most_memory);
    SPARI_TRY(f->memory == 0 ? check_memory(s, call) : SPAR_OK);
    SPARI_REQUIRE(s, f->amplitude > 0 && f->amplitude <= most_amplitude, SPAR_ERR_ARGUMENT,
                  "%s: an amplitude of %g; give up to %g, or 0 for %g", call, f->amplitude, most_amplitude,
                  common_amplitude);
    SPARI_REQUIRE(s, f->modes >= 1, SPAR_ERR_ARGUMENT, "%s: no modes; give 1 to %d", call, MOST_MODES);
    SPARI_REQUIRE(s, ask->n >= 0 && ask->n <= 2 * f->modes, SPAR_ERR_ARGUMENT,
                  "%s: %lld eigenvalues of %d modes; give 0 to twice as many", call, (long long)ask->n, f->modes);
    SPARI_REQUIRE(s, eigenvalue || ask->n == 0, SPAR_ERR_ARGUMENT, "%s: eigenvalue is NULL", call);
    SPARI_REQUIRE(s, !ask->shapes || nodes == f->nodes, SPAR_ERR_ARGUMENT,
                  "%s: shapes of %lld nodes; all members together have %lld", call, (long long)nodes,
                  (long long)f->nodes);
    SPARI_REQUIRE(s, !shift || (isfinite(shift[0]) && isfinite(shift[1])), SPAR_ERR_ARGUMENT,
                  "%s: the shift is not finite", call);
    return SPAR_OK;
}

int spar_session_solve_eigenvalues(spar_session *session, double dt, int64_t memory, double amplitude,
                                   spar_before_step before, spar_fluid_solver solve, void *context, int64_t modes,
                                   int64_t n, const double shift[2], double *eigenvalue, int64_t nodes, double *shapes,
                                   double frame[3]) {
    SPARI_QUIET;
    SPARI_REQUIRE(NULL, session, SPAR_ERR_ARGUMENT, "%s: the session is NULL; create it first", __func__);
    spar_session *s = session;
    coupled_ask ask = {.n = n, .shift = shift ? CMPLX(shift[0], fabs(shift[1])) : 0};
    ask.eigenvalue = eigenvalue, ask.shapes = shapes;
    ask.fluid = (spari_answer_ask){.run = {.dt = dt, .steps = SPARI_MULTIPLE}, .memory = memory};
    ask.fluid.run.before = before, ask.fluid.run.solve = solve, ask.fluid.run.context = context;
    ask.fluid.amplitude = amplitude == 0 ? common_amplitude : amplitude;
    ask.fluid.modes = modes >= 1 && modes <= MOST_MODES ? (int)modes : 0;
    for (const spar_member *m = s->members; m; m = m->next) {
        ask.fluid.nodes += m->committed ? m->nodes : 0;
    }
    spari_progress progress = spari_progress_of(s, __func__);
    ask.fluid.run.progress = &progress;
    int status = check_coupled(s, __func__, &ask, nodes, shift, eigenvalue);
    const spari_alike alike[] = {spari_real("dt", dt),
                                 spari_whole("memory", memory),
                                 spari_real("amplitude", amplitude),
                                 spari_given("before", before != NULL),
                                 spari_given("solve", solve != NULL),
                                 spari_given("progress call", progress.tell != NULL),
                                 spari_whole("modes", modes),
                                 spari_whole("n", n)};
    SPARI_TRY(spari_enter_alike(s, __func__, alike, sizeof alike / sizeof *alike, status));
    char message[SPARI_MESSAGE_SIZE];
    memcpy(message, s->message, sizeof message);
    SPARI_TRY(spari_named(s, __func__, spari_progress_ends(&progress, solve_coupled(s, __func__, &ask, frame))));
    memcpy(s->message, message, sizeof message);
    return SPAR_OK;
}
