/* The same scene in other units of length, mass and time, through the public calls that solve something: steps (even,
   uneven, adaptive), equilibria of one member and of all, modes, eigenvalues with and without the fluid, Floquet's
   multipliers, initial accelerations, advice, damping fits. The results must agree when they are converted back, to
   1e-9 of the largest number of their kind (steps: 1e-7, adaptive ones 1e-5, as the coupling ends at 1e-6), with the
   same numbers of iterations: then no constant of the library has a unit. Scenes are random: a beam of any fidelity,
   with or without a body on its tip (a weld, a hinge, a ball, a loop), in a fluid with a spring, a drag and an added
   mass. test_units SEEDS [FIRST]   that many scenes instead of the few of the short form, in more units */
#include "scene.h"

#include "member/body.h"
#include "member/structure.h"

#include <stdio.h>

typedef struct unit {
    double length, mass, time; /* m, kg, s */
} unit;

/* m kg s, mm kg s, mm tonne s, um kg s, um g us, km kg s, m g ms, mixed ones, and the ends of the range. */
static const unit units[] = {{1, 1, 1},          {1e-3, 1, 1},    {1e-3, 1e3, 1},      {1e-6, 1, 1},
                             {1e-6, 1e-3, 1e-6}, {1e3, 1, 1},     {1, 1e-3, 1e-3},     {1e-4, 1e9, 1e3},
                             {1e3, 1e-9, 1e-6},  {1e-7, 1, 1e-9}, {1, 1e-12, 1},       {1, 1e12, 1},
                             {1, 1, 1e-12},      {1, 1, 1e12},    {1e-7, 1e-20, 1e-9}, {1e6, 1, 1}};
enum { SHORT_UNITS = 10, UNITS = sizeof units / sizeof *units };

/* ---- what a scene is: numbers without units ---- */

enum attached { ALONE, WELD, HINGE, BALL, LOOP, ATTACHED };
enum { MOST_NODES = 20 };
static const char *const attached_name[ATTACHED] = {"alone", "weld", "hinge", "ball", "loop"};

typedef struct plan {
    int fidelity, elements, nodes, attached;
    double K[6], M[6], mu, direction[3], from[3], gravity[3], body, spring, drag, added;
} plan;

static uint64_t dice;

static double uniform(double low, double high) {
    dice = dice * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return low + (high - low) * (double)(dice >> 11) * 0x1p-53;
}

static double spread(double low, double high) {
    return exp(uniform(log(low), log(high)));
}

static plan make_plan(int seed) {
    static const int fidelity[5] = {SPAR_FIDELITY_EXACT, SPAR_FIDELITY_EXACT, SPAR_FIDELITY_LINEAR, SPAR_FIDELITY_MODAL,
                                    SPAR_FIDELITY_RIGID};
    plan p = {.elements = 1 + seed % 2};
    dice = (uint64_t)seed * 77 + 5;
    for (int i = 0; i < 5; i++) {
        (void)uniform(0, 1);
    }
    p.fidelity = fidelity[seed / 2 % 5];
    p.attached = p.fidelity == SPAR_FIDELITY_EXACT ? seed % ATTACHED : ALONE;
    p.nodes = 4 + (int)uniform(0, 4);
    double axial = spread(1e3, 1e5), size = 0;
    for (int i = 0; i < 6; i++) {
        p.K[i] = (i < 3 ? axial : 1) * uniform(0.5, 2);
        p.M[i] = (i < 3 ? 1 : spread(1e-4, 1e-2));
    }
    p.M[3] = p.M[4] + p.M[5];
    for (int i = 0; i < 3; i++) {
        p.direction[i] = uniform(-1, 1), p.from[i] = uniform(-1, 1), p.gravity[i] = uniform(-0.1, 0.1);
        size = hypot(size, p.direction[i]);
    }
    for (int i = 0; i < 3; i++) {
        p.direction[i] /= size;
    }
    p.mu = uniform(0, 1) < 0.5 ? 0 : 0.01;
    p.body = spread(0.1, 2), p.spring = uniform(0.1, 1), p.drag = uniform(0.05, 0.3), p.added = spread(0.05, 2);
    return p;
}

/* ---- a scene in some units ---- */

typedef struct world {
    unit u;
    plan p;
    spar_session *s;
    spar_member *beam, *body;
    spar_joint *joint;
    spar_fluid *fluid;
    int64_t nodes;
    int calls, jumps; /* of the fluid; whether the load jumps at t = 0, else it oscillates */
    double added;
} world;

static double force_of(unit u) {
    return u.mass * u.length / (u.time * u.time);
}

static void attach_body(world *w, const double tip[3]) {
    static const int free_motions[ATTACHED] = {[HINGE] = SPAR_FREE_RY,
                                               [BALL] = SPAR_FREE_RX | SPAR_FREE_RY | SPAR_FREE_RZ,
                                               [LOOP] = SPAR_FREE_RX | SPAR_FREE_RY | SPAR_FREE_RZ};
    const double L = w->u.length, F = force_of(w->u), m = w->p.body * w->u.mass, J = 0.02 * m * L * L;
    double K[36] = {0}, D[36] = {0}, away[3];
    w->body = scene_body(w->s, "body", tip, m, (double[]){J, 1.5 * J, 2 * J});
    w->joint = scene_joint(w->s, "joint", w->body, 0, w->beam, w->nodes - 1, free_motions[w->p.attached]);
    for (int k = 3; k < 6; k++) {
        int sprung = free_motions[w->p.attached] >> k & 1;
        K[7 * k] = sprung ? 0.3 * F * L : 0, D[7 * k] = sprung ? 0.02 * F * L * w->u.time : 0;
    }
    OK(w->s, spar_joint_set_spring(w->joint, K, D, NULL));
    if (w->p.attached == LOOP) { /* its tip stays in a plane through the tip */
        for (int i = 0; i < 3; i++) {
            away[i] = tip[i] + 0.1 * L * (i == 2);
        }
        spar_joint *stop = NULL;
        OK(w->s, spar_joint_create(w->s, "stop", w->body, 0, NULL, 0, 63 & ~SPAR_FREE_Z, &stop));
        OK(w->s, spar_joint_set_frame(stop, away, NULL));
    }
}

static void create(world *w, unit u, const plan *p) {
    const double L = u.length, F = force_of(u), m = u.mass / u.length, eta[2] = {0, 1};
    double K[36], M[36], line[6], g[3], mu[6], tip[3];
    *w = (world){.u = u, .p = *p};
    for (int i = 0; i < 3; i++) {
        line[i] = p->from[i] * L, tip[i] = line[3 + i] = (p->from[i] + p->direction[i]) * L;
        g[i] = p->gravity[i] * L / (u.time * u.time);
    }
    scene_diagonal(K, p->K[0] * F, p->K[1] * F, p->K[2] * F, p->K[3] * F * L * L, p->K[4] * F * L * L,
                   p->K[5] * F * L * L);
    scene_diagonal(M, p->M[0] * m, p->M[1] * m, p->M[2] * m, p->M[3] * m * L * L, p->M[4] * m * L * L,
                   p->M[5] * m * L * L);
    OK(NULL, spar_session_create(&w->s));
    OK(w->s, spar_session_set_gravity(w->s, g));
    OK(w->s, spar_beam_create(w->s, "beam", p->elements, p->nodes, &w->beam));
    OK(w->s, spar_beam_set_axis(w->beam, 2, eta, line, NULL));
    OK(w->s, spar_beam_set_sections(w->beam, 1, eta, K, M));
    for (int i = 0; i < 6; i++) {
        mu[i] = p->mu * u.time;
    }
    OK(w->s, spar_beam_set_damping(w->beam, mu));
    OK(w->s, spar_member_set_fidelity(w->beam, p->fidelity, p->fidelity == SPAR_FIDELITY_MODAL ? 6 : 0));
    OK(w->s, spar_member_commit(w->beam));
    OK(w->s, spar_member_get_count(w->beam, &w->nodes));
    if (p->attached != ALONE) {
        attach_body(w, tip);
    }
    OK(w->s, spar_fluid_create(w->body ? w->body : w->beam, "fluid", &w->fluid));
    OK(w->s, spar_fluid_set_motion_nodes(w->fluid, 1, tip));
    OK(w->s, spar_fluid_set_force_nodes(w->fluid, 1, tip));
    OK(w->s, spar_fluid_map(w->fluid));
}

/* A spring and a drag, an added mass where `added` says so, and a force that jumps or oscillates. */
static int solve_fluid(spar_session *s, double t, double dt, int iteration, void *context) {
    world *w = context;
    const spar_member *at = w->body ? w->body : w->beam;
    const double L = w->u.length, T = w->u.time, F = force_of(w->u);
    const int64_t last = w->body ? 0 : w->nodes - 1;
    double x[3], v[3], f[3], a[6 * MOST_NODES];
    (void)dt, (void)iteration;
    w->calls++;
    OK(s, spar_fluid_pull_motion(w->fluid, 1, x, v));
    OK(s, spar_member_get_motion(at, NULL, NULL, a));
    for (int k = 0; k < 3; k++) {
        double rest = (w->p.from[k] + w->p.direction[k]) * L;
        f[k] = -w->p.drag * w->u.mass / T * v[k] - w->p.spring * F / L * (x[k] - rest) -
               w->added * w->u.mass * a[6 * last + k];
    }
    f[1] += w->jumps ? 0.1 * F : 0;
    f[2] += w->jumps ? 0.1 * F * (1 + sin(5 * t / T)) : 0;
    return spar_fluid_push_forces(w->fluid, f, NULL);
}

/* ---- results, converted to numbers without units ---- */

enum { RESULTS = 2000 };
typedef struct record {
    int n, group[RESULTS]; /* numbers of one kind are compared relative to the largest of them; negative: a count */
    double x[RESULTS];
    int kinds, failed;
    char message[400];
} record;

/* n numbers in `of` units. exact kinds are counts. */
static void note(record *r, int64_t n, const double *x, double of) {
    for (int64_t i = 0; i < n && r->n < RESULTS; i++, r->n++) {
        r->x[r->n] = x[i] / of, r->group[r->n] = r->kinds;
    }
    r->kinds++;
}

/* [n][6], forces or displacements and then moments or rotations */
static void note_sixes(record *r, int64_t n, const double *x, double first, double last) {
    for (int half = 0; half < 2; half++) {
        for (int64_t i = 0; i < 3 * n && r->n < RESULTS; i++, r->n++) {
            r->x[r->n] = x[i / 3 * 6 + 3 * half + i % 3] / (half ? last : first), r->group[r->n] = r->kinds;
        }
        r->kinds++;
    }
}

static void note_state(record *r, const world *w) {
    const double L = w->u.length, T = w->u.time, F = force_of(w->u);
    const spar_member *of[2] = {w->beam, w->body};
    for (int k = 0; k < 2 && of[k]; k++) {
        int64_t n = k ? 1 : w->nodes;
        double q[7 * MOST_NODES], v[6 * MOST_NODES], a[6 * MOST_NODES], load[6], energy[SPAR_ENERGY_COUNT];
        OK(w->s, spar_member_get_motion(of[k], q, v, a));
        for (int64_t i = 0; i < n; i++) {
            for (int c = 0; c < 3; c++) {
                q[7 * i + c] /= L;
            }
        }
        note(r, 7 * n, q, 1);
        note_sixes(r, n, v, L / T, 1 / T);
        note_sixes(r, n, a, L / (T * T), 1 / (T * T));
        OK(w->s, spar_member_get_reaction(of[k], load));
        note_sixes(r, 1, load, F, F * L);
        OK(w->s, spar_member_get_energy(of[k], SPAR_ENERGY_COUNT, energy));
        note(r, SPAR_ENERGY_COUNT, energy, F * L);
    }
    if (w->joint) {
        double z[6], load[6];
        OK(w->s, spar_joint_get_motion(w->joint, z, NULL, NULL));
        OK(w->s, spar_joint_get_load(w->joint, load));
        note_sixes(r, 1, z, L, 1);
        note_sixes(r, 1, load, F, F * L);
    }
}

/* A count, which must be the same. About: within 10 %: whether the last iteration of Newton or of the coupling is
   needed may depend on rounding. */
static void note_count(record *r, double count) {
    if (r->n < RESULTS) {
        r->x[r->n] = count, r->group[r->n++] = -1;
    }
}

static void note_count_about(record *r, double count) {
    if (r->n < RESULTS) {
        r->x[r->n] = count, r->group[r->n++] = -2;
    }
}

static void note_work(record *r, const world *w) {
    int64_t newton = 0;
    OK(w->s, spar_member_get_iterations(w->beam, &newton, NULL));
    note_count_about(r, (double)newton);
    note_count_about(r, w->calls);
}

/* Records a refusal instead of results: it must be the same in all units. Returns whether there is none. */
static int answered(record *r, const world *w, int status) {
    if (status != SPAR_OK) {
        (void)snprintf(r->message, sizeof r->message, "%s", spar_session_message(w->s));
        r->failed = status;
    }
    note_count(r, status);
    return status == SPAR_OK;
}

/* ---- the calls ---- */

static void even_steps(world *w, record *r) {
    int ok = 1;
    w->jumps = 1;
    for (int i = 0; i < 20 && ok; i++) {
        ok = answered(r, w, spar_step(w->s, 0.05 * w->u.time, solve_fluid, w, NULL));
    }
    note_state(r, w);
    note_work(r, w);
}

static void uneven_steps(world *w, record *r) {
    static const double dt[8] = {0.05, 0.02, 0.02, 0.07, 0.01, 0.1, 0.05, 0.0501};
    int ok = 1;
    w->jumps = 1;
    for (int i = 0; i < 16 && ok; i++) {
        ok = answered(r, w, spar_step(w->s, dt[i % 8] * w->u.time, solve_fluid, w, NULL));
    }
    note_state(r, w);
    note_work(r, w);
}

static void adaptive_steps(world *w, record *r) {
    double dt = 0.05 * w->u.time, taken = 0;
    int ok = 1;
    w->jumps = 1;
    OK(w->s, spar_session_set_tolerance(w->s, 1e-3 * w->u.length / w->u.time, 1e-3));
    for (int i = 0; i < 12 && ok; i++) {
        ok = answered(r, w, spar_step_adaptive(w->s, &dt, NULL, solve_fluid, w, &taken));
        note(r, 1, &taken, w->u.time);
    }
    note_state(r, w);
    note_work(r, w);
}

static void one_equilibrium(world *w, record *r) {
    const double F = 0.05 * force_of(w->u), load[6] = {0, F, F};
    OK(w->s, spar_member_set_load(w->beam, w->nodes - 1, SPAR_LOAD_DEAD, load));
    if (answered(r, w, spar_member_solve_static(w->beam, 2))) {
        note_state(r, w);
    }
    note_work(r, w);
}

static void all_equilibria(world *w, record *r) {
    w->jumps = 1;
    if (answered(r, w, spar_session_solve_static(w->s, 1, solve_fluid, w, NULL))) {
        note_state(r, w);
    }
    note_work(r, w);
}

static void modes(world *w, record *r) {
    double f[4];
    if (w->p.fidelity != SPAR_FIDELITY_RIGID && answered(r, w, spar_member_solve_modes(w->beam, 4, f, NULL))) {
        note(r, 4, f, 1 / w->u.time);
    }
}

static void eigenvalues(world *w, record *r) {
    double value[8];
    if (w->p.fidelity != SPAR_FIDELITY_RIGID && answered(r, w, spar_member_solve_static(w->beam, 1)) &&
        answered(r, w, spar_member_solve_eigenvalues(w->beam, 4, NULL, value, NULL, NULL))) {
        note(r, 8, value, 1 / w->u.time);
    }
}

static spar_trial *trial_in(world *w, double dt, int64_t steps) {
    spar_trial *t = NULL;
    OK(w->s, spar_trial_create(w->s, &t));
    OK(w->s, spar_trial_set_steps(t, dt * w->u.time, steps));
    OK(w->s, spar_trial_set_callbacks(t, NULL, NULL, solve_fluid, w));
    return t;
}

static void fluid_eigenvalues(world *w, record *r) {
    double value[8];
    if (w->p.fidelity == SPAR_FIDELITY_RIGID ||
        !answered(r, w, spar_session_solve_static(w->s, 1, solve_fluid, w, NULL))) {
        return;
    }
    spar_trial *t = trial_in(w, 0.01, 1);
    OK(w->s, spar_trial_set_motion(t, 4, 0, 0));
    if (answered(r, w, spar_trial_solve_eigenvalues(t, 4, NULL, value, 0, NULL, NULL))) {
        note(r, 8, value, 1 / w->u.time);
    }
}

static void multipliers(world *w, record *r) {
    double value[8];
    if (w->p.fidelity == SPAR_FIDELITY_RIGID ||
        !answered(r, w, spar_session_solve_static(w->s, 1, solve_fluid, w, NULL))) {
        return;
    }
    spar_trial *t = trial_in(w, 0.05, 8);
    OK(w->s, spar_trial_set_motion(t, 2, 0, 0));
    if (answered(r, w, spar_trial_solve_floquet(t, 4, value))) {
        note(r, 8, value, 1 / w->u.time);
    }
}

static void initial_accelerations(world *w, record *r) {
    w->jumps = 1, w->added = w->p.added;
    if (answered(r, w, spar_session_solve_initial(w->s, 0.02 * w->u.time, solve_fluid, w, NULL))) {
        note_state(r, w);
    }
    note_work(r, w);
}

static void added_mass(world *w, record *r) {
    int ok = 1;
    w->jumps = 1, w->added = w->p.added;
    for (int i = 0; i < 10 && ok; i++) {
        ok = answered(r, w, spar_step(w->s, 0.05 * w->u.time, solve_fluid, w, NULL));
    }
    note_state(r, w);
    note_work(r, w);
}

static void advice(world *w, record *r) {
    double dt, error, cost;
    int substeps, scheme, predictor;
    w->jumps = 1;
    spar_trial *t = trial_in(w, 0.05, 64);
    OK(w->s, spar_trial_set_option(t, "nodes", "keep"));
    if (answered(r, w, spar_trial_advise(t, 0.05, 3.2 * w->u.time))) {
        OK(w->s, spar_trial_get_settings(t, &dt, &substeps, &scheme, NULL, &predictor, NULL));
        OK(w->s, spar_trial_get_outcome(t, &error, &cost, NULL, NULL));
        note(r, 1, &dt, w->u.time);
        note_count(r, substeps), note_count(r, scheme), note_count(r, predictor);
    }
}

static void damping(world *w, record *r) {
    const int64_t mode[3] = {0, 1, 2};
    const double ratio[3] = {0.01, 0.01, 0.02};
    double mu[6], achieved[3], alpha;
    if (w->p.fidelity != SPAR_FIDELITY_RIGID &&
        answered(r, w, spar_beam_fit_damping(w->beam, 3, mode, ratio, achieved))) {
        OK(w->s, spar_beam_get_damping(w->beam, mu));
        OK(w->s, spar_beam_get_mass_damping(w->beam, &alpha));
        note(r, 3, achieved, 1);
        note(r, 6, mu, w->u.time);
        note(r, 1, &alpha, 1 / w->u.time);
    }
}

typedef struct call {
    const char *name;
    void (*run)(world *w, record *r);
    double tolerance;
} call;

static const call calls[] = {
    {"even steps", even_steps, 1e-7},
    {"uneven steps", uneven_steps, 1e-7},
    {"adaptive steps", adaptive_steps, 1e-5},
    {"steps with added mass", added_mass, 1e-7},
    {"equilibrium of a member", one_equilibrium, 1e-9},
    {"equilibrium with the fluid", all_equilibria, 1e-9},
    {"modes", modes, 5e-9},
    {"eigenvalues", eigenvalues, 5e-9},
    {"eigenvalues with the fluid", fluid_eigenvalues, 1e-8},
    {"Floquet's multipliers", multipliers, 1e-8},
    {"initial accelerations", initial_accelerations, 1e-7},
    {"advice", advice, 1e-6},
    {"damping fit", damping, 2e-3},
};
enum { CALLS = sizeof calls / sizeof *calls };

/* ---- the comparison ---- */

/* The largest difference of two records, relative to the largest number of its kind; INFINITY: other counts. Numbers of
   a kind that are all small (a gap, a load along a free motion) are rounding of others. */
static double difference(const record *a, const record *b, int *where) {
    const double least = 1e-3;
    double worst = a->n == b->n ? 0 : INFINITY;
    *where = -1;
    for (int i = 0; i < a->n && a->n == b->n; i++) {
        double size = least, off = fabs(a->x[i] - b->x[i]);
        for (int k = 0; k < a->n && a->group[i] >= 0; k++) {
            size = a->group[k] == a->group[i] ? fmax(size, fabs(a->x[k])) : size;
        }
        off = a->group[i] >= 0 ? off / size : a->group[i] == -1 ? off : off <= 0.1 * a->x[i] + 1 ? 0 : off;
        if (!(off <= worst)) {
            worst = off, *where = i;
        }
    }
    return worst;
}

static int compare(int seed, int count) {
    static record first, other;
    const plan p = make_plan(seed);
    int wrong = 0;
    for (int c = 0; c < CALLS; c++) {
        for (int k = 0; k < count; k++) {
            world w;
            record *r = k ? &other : &first;
            memset(r, 0, sizeof *r);
            create(&w, units[k], &p);
            calls[c].run(&w, r);
            spar_session_destroy(&w.s);
            int where = -1;
            double off = k ? difference(&first, r, &where) : 0;
            if (!(off <= calls[c].tolerance)) {
                wrong++;
                print_message("seed %d (%s, fidelity %d, %d x %d nodes), %s, %g m %g kg %g s: off by %.2g in result %d "
                              "(%.17g for %.17g) %s\n",
                              seed, attached_name[p.attached], p.fidelity, p.elements, p.nodes, calls[c].name,
                              units[k].length, units[k].mass, units[k].time, off, where, where < 0 ? 0 : r->x[where],
                              where < 0 ? 0 : first.x[where],
                              r->failed != first.failed ? r->failed ? r->message : first.message : "");
            }
        }
    }
    return wrong;
}

/* A cantilever of steel with a body welded to its tip, in SI; only its length changes. F L^2 / (3 EI) = 1/300; its own
   shear adds 2e-4 of this. */
static void small_assemblies(void **state) {
    (void)state;
    double first = 0;
    for (double L = 1e4; L > 5e-13; L /= 10) {
        const double d[2] = {L / 60, L / 20}, end[3] = {L, 0, 0};
        double p[SPAR_SECTION_COUNT], K[36], M[36], q[7];
        spar_session *s = scene_session();
        OK(s, spar_section_from_shape(SPAR_SHAPE_RECTANGLE, 2, d, 2e11, 0.3, 7800, SPAR_SECTION_COUNT, p));
        OK(s, spar_section_build(SPAR_SECTION_COUNT, p, K, M));
        const double m = p[SPAR_SECTION_MASS] * L, J[3] = {0.01 * m * L * L, 0.01 * m * L * L, 0.01 * m * L * L},
                     F[6] = {0, 0.01 * p[SPAR_SECTION_EI_Z] / (L * L)};
        spar_member *b = scene_beam(s, "beam", 2, 7, L, K, M);
        OK(s, spar_member_commit(b));
        spar_member *t = scene_body(s, "tip", end, m, J);
        (void)scene_joint(s, "weld", t, 0, b, 13, 0);
        OK(s, spar_member_set_load(t, 0, SPAR_LOAD_DEAD, F));
        OK(s, spar_member_solve_static(b, 1));
        scene_tip(b, q);
        first = first > 0 ? first : q[1] / L;
        NEAR(q[1] / L, 1. / 300, 1e-6);
        NEAR(q[1] / L, first, 1e-9);
        spar_session_destroy(&s);
    }
}

/* The force that rounding errors of Newton are relative to: EA here, in millimetres and kilometres too. */
static void rounding(void **state) {
    (void)state;
    plan p = make_plan(0);
    p.K[0] = 1e4 * p.K[0], p.K[1] = p.K[2] = 1;
    static const unit all[] = {{1, 1, 1}, {1e3, 1e-3, 1}, {1e-3, 1, 1}};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
        world w;
        create(&w, all[i], &p);
        NEAR(w.beam->body->stiffest * all[i].time * all[i].time / (all[i].mass * all[i].length), p.K[0], 1e-9 * p.K[0]);
        spar_session_destroy(&w.s);
    }
}

/* Ten scenes, one of each kind of joint for each number of elements, and the other fidelities. */
static void scenes(void **state) {
    (void)state;
    int wrong = 0;
    for (int seed = 0; seed < 10; seed++) {
        wrong += compare(seed, SHORT_UNITS);
    }
    assert_int_equal(wrong, 0);
}

static int long_form(int seeds, int first) {
    int wrong = 0;
    for (int seed = first; seed < first + seeds; seed++) {
        wrong += compare(seed, UNITS);
    }
    print_message("%d scenes in %d units: %d differences\n", seeds, UNITS, wrong);
    return wrong > 0;
}

int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(scenes),
        cmocka_unit_test(small_assemblies),
        cmocka_unit_test(rounding),
    };
    return argc > 1 ? long_form(atoi(argv[1]), argc > 2 ? atoi(argv[2]) : 0)
                    : cmocka_run_group_tests(tests, NULL, NULL);
}
