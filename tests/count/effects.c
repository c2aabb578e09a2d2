/* One scene after the other, each with an effect on, off, and never described or asked for: what a step costs.

     effects count   one line a scene, "effect state steps". Under callgrind with --zero-before=count_begin and
                     --dump-before=count_end each line has its dump: instructions of the steps alone, without set-up
     effects bytes   "effect state bytes": memory that library and host hold once the steps are done
     effects words   on two ranks: "effect state up down", doubles that go from and to the members' owners per iteration

   tests/count/run makes the table of docs/explanation/effects.md from the three, and fails where off costs anything. */
#include <math.h>
#include <spar/spar_aero.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef SPARI_HAVE_MPI
#include <spar/spar_mpi.h>
#endif

#include "watch.h"

enum { NODES = 8, FLUID = 1000, WARM = 2, STEPS = 4, SECTIONS = 19, BLADES = 3 };

/* What a setting gives is marked so: 0 is an answer too. */
enum { GIVEN = 1 << 30 };
enum {
    ALL = GIVEN | SPAR_EFFECT_INERTIA | SPAR_EFFECT_GYROSCOPIC | SPAR_EFFECT_GRAVITY | SPAR_EFFECT_DAMPING |
          SPAR_EFFECT_FLUID_MOMENT,
    EVERY = (ALL & ~GIVEN) | SPAR_EFFECT_FLUID_HISTORY | SPAR_EFFECT_WORK | SPAR_EFFECT_MASSES |
            SPAR_EFFECT_FOUNDATION | SPAR_EFFECT_PRETENSION
};

/* ---- what is measured ---- */

static int words; /* of the mode */
static long long up, down;

#ifdef SPARI_HAVE_MPI
/* MPI's profiling interface: what spar sends passes here. */
int MPI_Reduce(const void *from, void *to, int n, MPI_Datatype type, MPI_Op op, int root, MPI_Comm comm) {
    up += n;
    return PMPI_Reduce(from, to, n, type, op, root, comm);
}

/* Reproducible sums are the only ones that go to all ranks at once in a type of their own. */
int MPI_Allreduce(const void *from, void *to, int n, MPI_Datatype type, MPI_Op op, MPI_Comm comm) {
    int size;
    PMPI_Type_size(type, &size);
    up += type == MPI_INT64_T ? 0 : n * (long long)size / (long long)sizeof(double);
    return PMPI_Allreduce(from, to, n, type, op, comm);
}

int MPI_Allgatherv(const void *from, int n, MPI_Datatype send, void *to, const int counts[], const int offsets[],
                   MPI_Datatype type, MPI_Comm comm) {
    int ranks;
    PMPI_Comm_size(comm, &ranks);
    for (int r = 0; r < ranks; r++) {
        down += counts[r];
    }
    return PMPI_Allgatherv(from, n, send, to, counts, offsets, type, comm);
}
#endif

/* The library's calls for memory come here (ld --wrap): a block knows its size. */
enum { HEAD = 16 };
static long long heap;
void *__real_calloc(size_t n, size_t size);
void *__wrap_calloc(size_t n, size_t size);
void *__wrap_malloc(size_t size);
void *__real_malloc(size_t size);
void *__wrap_realloc(void *block, size_t size);
char *__wrap_strdup(const char *text);
void __wrap_free(void *block);
void __real_free(void *block);

static void *mark(char *block, size_t size) {
    if (!block) {
        return NULL;
    }
    memcpy(block, &size, sizeof size);
    heap += (long long)size;
    return block + HEAD;
}

void *__wrap_calloc(size_t n, size_t size) {
    return n == 0 || size <= (SIZE_MAX - HEAD) / n ? mark(__real_calloc(1, n * size + HEAD), n * size) : NULL;
}

void *__wrap_malloc(size_t size) {
    return size <= SIZE_MAX - HEAD ? mark(__real_malloc(size + HEAD), size) : NULL;
}

void *__wrap_realloc(void *block, size_t size) {
    char *from = block, *to = __wrap_malloc(size);
    size_t old = 0;
    if (from && to) {
        memcpy(&old, from - HEAD, sizeof old);
        memcpy(to, from, old < size ? old : size);
        __wrap_free(from);
    }
    return to;
}

char *__wrap_strdup(const char *text) {
    char *copy = __wrap_malloc(strlen(text) + 1);
    return copy ? strcpy(copy, text) : NULL;
}

void __wrap_free(void *block) {
    size_t size = 0;
    if (block) {
        memcpy(&size, (char *)block - HEAD, sizeof size);
        heap -= (long long)size;
        __real_free((char *)block - HEAD);
    }
}

/* ---- scenes ---- */

/* How a scene departs from the plain one, which has none of it. */
typedef struct setting {
    int effects;                 /* of the member, if GIVEN */
    int massless, damped, heavy; /* described */
    int fluid;                   /* nodes of it */
    int velocity, moment;        /* pulled, pushed */
    int poses, accelerations;    /* pulled */
    int half, group;             /* pull at theta = 1/2 */
    int predictor, scheme;       /* if GIVEN */
    int unaudited, account, guess, laden, dragged, sprung, bedded, strung;
    int reproducible;                    /* if GIVEN */
    int aero;                            /* blades with sections */
    int aero_effects;                    /* if GIVEN */
    int rotor, no_hub, cm, shear, tower; /* described */
} setting;

typedef struct scene {
    setting is;
    spar_session *session;
    spar_member *member[BLADES];
    spar_fluid *fluid[BLADES];
    spar_aero *aero;
    spar_polar *polar;
    int64_t n;
    double *x, *v, *force, *moment, *q, *w, *a;
    double rates[6], turn[7], time;
    int iterations;
    long long described; /* memory before anything of it is built */
} scene;

static void must(const scene *s, int status, const char *what) {
    if (status != SPAR_OK) {
        fprintf(stderr, "effects: %s: %s\n", what, spar_session_message(s->session));
        exit(1);
    }
}
#define MUST(call) must(s, call, #call)

static double *room(int64_t n) {
    double *x = calloc((size_t)n, sizeof *x);
    if (!x) {
        fprintf(stderr, "effects: no memory\n");
        exit(1);
    }
    return x;
}

static void open_session(scene *s) {
#ifdef SPARI_HAVE_MPI
    if (words) {
        MUST(spar_session_create_mpi(MPI_COMM_WORLD, &s->session));
        return;
    }
#endif
    MUST(spar_session_create(&s->session));
}

/* A beam of 10 m along x whose root turns about z, loaded at its tip. */
static void make_beam(scene *s) {
    static const double eta[2] = {0, 1}, xyz[6] = {0, 0, 0, 10, 0, 0}, mu[6] = {1e-3, 1e-3, 1e-3, 1e-3, 1e-3, 1e-3},
                        g[3] = {0, 0, -9.81}, tip[6] = {0, 0, 50, 5, 0, 0}, bed[3] = {0, 10, 10},
                        pull[6] = {20, 0, 0, 0, 0, 0};
    const double k[6] = {1.4e6, 9e4, 4e4, 1.7e4, 5.9e4, 1.4e5}, m[6] = {0.5, 0.5, 0.5, 0.05, 0.02, 0.03};
    double stiffness[36] = {0}, mass[36] = {0};
    for (int i = 0; i < 6; i++) {
        stiffness[7 * i] = k[i], mass[7 * i] = m[i];
    }
    spar_member **b = &s->member[0];
    if (s->is.heavy) {
        MUST(spar_session_set_gravity(s->session, g));
    }
    MUST(spar_beam_create(s->session, "beam", 1, NODES, b));
    MUST(spar_beam_set_axis(*b, 2, eta, xyz, NULL));
    MUST(spar_beam_set_sections(*b, 1, eta, stiffness, s->is.massless ? NULL : mass));
    if (s->is.damped) {
        MUST(spar_beam_set_damping(*b, mu));
    }
    MUST(spar_member_set_root(*b, SPAR_ROOT_DRIVEN));
    if (s->is.effects & GIVEN) {
        MUST(spar_member_set_effects(*b, s->is.effects & ~GIVEN, EVERY & ~s->is.effects));
    }
    if (s->is.account) {
        MUST(spar_member_set_effects(*b, SPAR_EFFECT_WORK, 0));
    }
    if (s->is.guess) {
        MUST(spar_member_set_added_mass(*b, 1, eta, mass));
    }
    if (s->is.dragged) {
        MUST(spar_beam_set_mass_damping(*b, 0.1));
    }
    if (s->is.laden) {
        MUST(spar_beam_set_masses(*b, 1, eta + 1, mass));
    }
    if (s->is.strung) {
        MUST(spar_beam_set_pretension(*b, 1, eta, pull));
    }
    if (s->is.bedded) {
        MUST(spar_beam_set_foundation(*b, 1, eta, bed));
    }
    s->described = heap;
    MUST(spar_member_commit(*b));
    if (s->is.sprung) { /* its tip to the ground, all six motions free */
        const double spring[36] = {[14] = 10};
        MUST(spar_spring_create(s->session, "spring", *b, NODES - 1, 63, spring, NULL, NULL, NULL));
    }
    MUST(spar_member_set_load(*b, NODES - 1, SPAR_LOAD_DEAD, tip));
}

/* Blades without mass, along y and turned about x, the shaft. */
static void make_blades(scene *s) {
    for (int b = 0; b < BLADES; b++) {
        char name[8] = {'p', (char)('0' + b), 0};
        double half = 1.0471975511965976 * b, q[4] = {cos(half), sin(half), 0, 0};
        double face[4] = {sqrt(0.5), 0, 0, sqrt(0.5)},
               at[4] = {q[0] * face[0], q[1] * face[0], -q[1] * face[3], q[0] * face[3]};
        MUST(spar_point_create(s->session, name, NULL, at, &s->member[b]));
        if (s->is.effects & GIVEN) {
            MUST(spar_member_set_effects(s->member[b], s->is.effects & ~GIVEN, EVERY & ~s->is.effects));
        }
        s->described = b == 0 ? heap : s->described;
        MUST(spar_member_commit(s->member[b]));
    }
}

static void set_options(const scene *s, spar_fluid *f) {
    if (s->is.unaudited) {
        MUST(spar_fluid_set_option(f, "audit", "off"));
    }
    if (s->is.group) {
        MUST(spar_fluid_set_option(f, "theta", "group"));
    }
}

/* Nodes around the line, some metres apart from the axis. */
static void make_fluid(scene *s) {
    spar_fluid **f = &s->fluid[0];
    s->n = s->is.fluid;
    s->x = room(3 * s->n), s->v = room(3 * s->n), s->force = room(3 * s->n), s->moment = room(3 * s->n);
    s->q = room(4 * s->n), s->w = room(3 * s->n), s->a = room(3 * s->n);
    for (int64_t j = 0; j < s->n; j++) {
        double turn = 0.1 * (double)j;
        s->x[3 * j] = 10 * (double)j / (double)s->n, s->x[3 * j + 1] = cos(turn), s->x[3 * j + 2] = 0.3 * sin(turn);
        s->force[3 * j] = 1e-3, s->force[3 * j + 1] = 1e-3 * cos(turn), s->force[3 * j + 2] = 2e-3;
        s->moment[3 * j] = 1e-4;
    }
    MUST(spar_fluid_create(s->member[0], "around", f));
    set_options(s, *f);
    MUST(spar_fluid_set_motion_nodes(*f, s->n, s->x));
    MUST(spar_fluid_set_force_nodes(*f, s->n, s->x));
    MUST(spar_fluid_map(*f));
}

static void make_aero(scene *s) {
    enum { ROWS = 73 };
    static const double hub[3] = {0, 0, 0}, axis[3] = {1, 0, 0}, ground[3] = {5, 0, -90}, sky[3] = {0, 0, 1},
                        top[3] = {5, 0, 0};
    double alpha[ROWS], cl[ROWS], cd[ROWS], cm[ROWS], eta[SECTIONS] = {0}, offset[SECTIONS][3] = {{0}};
    for (int i = 0; i < ROWS; i++) {
        alpha[i] = 3.14159265358979 * (i - 36) / 36.0;
        cl[i] = 1.2 * sin(2 * alpha[i]), cd[i] = 0.01 + sin(alpha[i]) * sin(alpha[i]), cm[i] = -0.1 * sin(alpha[i]);
    }
    cl[ROWS - 1] = cl[0], cd[ROWS - 1] = cd[0], cm[ROWS - 1] = cm[0];
    for (int i = 0; i < SECTIONS; i++) {
        offset[i][0] = 2 + 58.0 * i / (SECTIONS - 1);
    }
    for (int b = 0; b < BLADES; b++) {
        MUST(spar_fluid_create(s->member[b], "blade", &s->fluid[b]));
        set_options(s, s->fluid[b]);
        MUST(spar_fluid_set_stations(s->fluid[b], SECTIONS, eta, offset[0]));
        MUST(spar_fluid_map(s->fluid[b]));
    }
    MUST(spar_polar_create(ROWS, alpha, cl, cd, s->is.cm ? cm : NULL, &s->polar));
    MUST(spar_aero_create(BLADES, s->fluid, &s->aero));
    if (s->is.aero_effects & GIVEN) {
        MUST(spar_aero_set_effects(s->aero, s->is.aero_effects & ~GIVEN));
    }
    for (int i = 0; i < SECTIONS; i++) {
        MUST(spar_aero_set_section(s->aero, i, 4 - 0.1 * i, 0.2 - 0.01 * i, s->polar));
    }
    if (s->is.rotor) {
        MUST(spar_aero_set_rotor(s->aero, hub, axis, s->is.no_hub ? 0 : 1.5, 63));
    }
    if (s->is.shear) {
        MUST(spar_aero_set_shear(s->aero, SPAR_SHEAR_POWER, ground, sky, 90, 0.2));
    }
    if (s->is.tower) {
        MUST(spar_aero_set_tower(s->aero, ground, top, 3, 2));
    }
    s->force = room(3 * BLADES * SECTIONS); /* the wind */
    for (int k = 0; k < BLADES * SECTIONS; k++) {
        s->force[3 * k] = 9;
    }
}

static void make(scene *s, const setting *is) {
    *s = (scene){.is = *is, .rates = {0, 0, 0, 0, 0, 1}, .turn = {0, 0, 0, 1, 0, 0, 0}};
    if (is->aero) {
        s->rates[3] = 1, s->rates[5] = 0;
    }
    open_session(s);
    /* the first correction of Newton is small enough and every step, of another length than the one before, forms a
       tangent: scenes differ by what a step computes, not by how soon it converges */
    MUST(spar_session_set_newton(s->session, 1, 1, 50));
    if (is->aero) {
        make_blades(s);
    } else {
        make_beam(s);
    }
    if (is->predictor & GIVEN) {
        MUST(spar_session_set_predictor(s->session, is->predictor & ~GIVEN));
    }
    const int scheme = is->scheme & GIVEN ? is->scheme & ~GIVEN : SPAR_COUPLING_EXPLICIT;
    MUST(spar_session_set_coupling(s->session, scheme, 1e-9, 1e-9, 20));
    if (is->reproducible & GIVEN) {
        MUST(spar_session_set_reproducible(s->session, is->reproducible & ~GIVEN));
    }
    if (is->aero) {
        make_aero(s);
    } else if (is->fluid) {
        make_fluid(s);
    }
}

static void unmake(scene *s) {
    double *all[] = {s->x, s->v, s->force, s->moment, s->q, s->w, s->a};
    spar_aero_destroy(&s->aero);
    spar_polar_destroy(&s->polar);
    spar_session_destroy(&s->session);
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
        free(all[i]);
    }
}

/* ---- a step ---- */

/* A fluid whose forces follow the motion of the tip a little, so that an iteration has something to do. */
static void exchange(scene *s) {
    const setting *is = &s->is;
    double theta = is->half ? 0.5 : 1;
    spar_fluid *f = s->fluid[0];
    MUST(spar_fluid_pull_motion(f, theta, s->x, is->velocity ? s->v : NULL));
    if (is->poses) {
        MUST(spar_fluid_pull_poses(f, SPAR_NODES_MOTION, theta, NULL, s->q, NULL, s->w, is->accelerations ? s->a : NULL,
                                   NULL));
    }
    double follow = 1e-3 * (1 - 1e-3 * s->x[3 * s->n - 1]);
    for (int64_t j = s->n - 10; j < s->n; j++) {
        s->force[3 * j + 2] = follow;
    }
    MUST(spar_fluid_push_forces(f, s->force, is->moment ? s->moment : NULL));
}

static void step(scene *s, int k) {
    double dt = k % 2 ? 2e-3 : 2.2e-3, half, a[6] = {0};
    int done = 0;
    s->time += dt, half = 0.5 * s->time;
    s->turn[3] = cos(half);
    s->turn[s->is.aero ? 4 : 6] = sin(half);
    for (int b = 0; b < BLADES && s->member[b]; b++) {
        MUST(spar_member_drive(s->member[b], s->turn, s->rates, a));
    }
    MUST(spar_step_begin(s->session, dt));
    while (!done) {
        MUST(spar_step_solve(s->session));
        if (s->aero) {
            MUST(spar_aero_solve(s->aero, 1.225, s->force, 1));
        } else if (s->fluid[0]) {
            exchange(s);
        }
        MUST(spar_step_check(s->session, &done));
        s->iterations++;
    }
    MUST(spar_step_accept(s->session));
}

/* ---- the effects ---- */

/* functions: those of the effect alone, which must not be entered when it is off ("": none that the compiler leaves a
   name). never (flag NEVER): not described or not asked for. */
enum { NEVER = 1 };
typedef struct effect {
    const char *name, *functions;
    int flags;
    setting on, off, never;
} effect;

#define MOMENTUM (SPAR_AERO_INDUCTION | SPAR_AERO_DRAG)

static const effect effects[] = {
    {"inertia",
     "accelerated_forces_plain accelerated_forces_avx2",
     NEVER,
     {.effects = GIVEN | SPAR_EFFECT_INERTIA},
     {.effects = GIVEN},
     {.effects = GIVEN, .massless = 1}},
    {"gyroscopic",
     "",
     0,
     {.effects = GIVEN | SPAR_EFFECT_INERTIA | SPAR_EFFECT_GYROSCOPIC},
     {.effects = GIVEN | SPAR_EFFECT_INERTIA},
     {0}},
    {"gravity", "", NEVER, {.heavy = 1}, {.effects = ALL & ~SPAR_EFFECT_GRAVITY, .heavy = 1}, {0}},
    {"gravity, without inertia",
     "weighed_forces_plain weighed_forces_avx2",
     NEVER,
     {.heavy = 1, .effects = GIVEN | SPAR_EFFECT_GRAVITY},
     {.heavy = 1, .effects = GIVEN},
     {.effects = GIVEN | SPAR_EFFECT_GRAVITY}},
    {"damping", "", NEVER, {.damped = 1}, {.effects = ALL & ~SPAR_EFFECT_DAMPING, .damped = 1}, {0}},
    {"damping by mass",
     "spari_body_see",
     NEVER,
     {.dragged = 1},
     {.dragged = 1, .effects = ALL & ~SPAR_EFFECT_DAMPING},
     {0}},
    {"work account", "spari_work_step", NEVER, {.account = 1}, {0}, {0}},
    {"bodies on beams", "", NEVER, {.laden = 1}, {.laden = 1, .effects = ALL}, {0}},
    {"foundation",
     "element_springs spari_foundation_tangent",
     NEVER,
     {.bedded = 1},
     {.bedded = 1, .effects = ALL},
     {0}},
    {"pretension", "", NEVER, {.strung = 1}, {.strung = 1, .effects = ALL}, {0}},
    {"joints",
     "spari_constraint_find spari_constraint_times spari_constraint_gap spari_constraints_add_forces "
     "spari_joint_spring "
     "spari_joint_accept spari_joints_on",
     0,
     {.sprung = 1},
     {0},
     {0}},
    {"known added mass", "spari_added_times", NEVER, {.guess = 1}, {0}, {0}},
    {"fluid moment",
     "",
     NEVER,
     {.fluid = FLUID, .moment = 1},
     {.fluid = FLUID, .moment = 1, .effects = ALL & ~SPAR_EFFECT_FLUID_MOMENT},
     {.fluid = FLUID}},
    {"fluid history",
     "",
     NEVER,
     {.fluid = FLUID, .effects = ALL | SPAR_EFFECT_FLUID_HISTORY},
     {.fluid = FLUID, .effects = ALL},
     {.fluid = FLUID}},
    {"velocities", "", 0, {.fluid = FLUID, .velocity = 1}, {.fluid = FLUID}, {0}},
    {"poses of sections", "orientation", 0, {.fluid = FLUID, .poses = 1}, {.fluid = FLUID}, {0}},
    {"accelerations", "", 0, {.fluid = FLUID, .poses = 1, .accelerations = 1}, {.fluid = FLUID, .poses = 1}, {0}},
    {"half-step", "", 0, {.fluid = FLUID, .half = 1}, {.fluid = FLUID}, {0}},
    {"half-step on the group",
     "blend_motion",
     0,
     {.fluid = FLUID, .half = 1, .group = 1},
     {.fluid = FLUID, .group = 1},
     {0}},
    {"audit", "write_audit", 0, {.fluid = FLUID}, {.fluid = FLUID, .unaudited = 1}, {0}},
    {"reproducible sums",
     "spari_bin_loads bins_plain bins_avx2 spari_bins_merge spari_bins_add",
     NEVER,
     {.fluid = FLUID, .reproducible = GIVEN | 1},
     {.fluid = FLUID, .reproducible = GIVEN | 0},
     {.fluid = FLUID}},
    {"predictor, order 1", "", 0, {.fluid = 10, .predictor = GIVEN | 1}, {.fluid = 10, .predictor = GIVEN | 0}, {0}},
    {"predictor, order 2", "", 0, {.fluid = 10, .predictor = GIVEN | 2}, {.fluid = 10, .predictor = GIVEN | 1}, {0}},
    {"iteration",
     "spari_accelerator_next",
     NEVER,
     {.fluid = 10, .scheme = GIVEN | SPAR_COUPLING_IQN_ILS},
     {.fluid = 10, .scheme = GIVEN | SPAR_COUPLING_EXPLICIT},
     {.fluid = 10}},
    {"shaft", "", 0, {.aero = 1, .rotor = 1, .aero_effects = GIVEN | SPAR_AERO_DRAG}, {.aero = 1}, {0}},
    {"induction",
     "spari_momentum_solve",
     0,
     {.aero = 1, .rotor = 1},
     {.aero = 1, .rotor = 1, .aero_effects = GIVEN | SPAR_AERO_DRAG},
     {0}},
    {"tip loss",
     "add_loss_plain add_loss_avx2",
     0,
     {.aero = 1, .rotor = 1, .aero_effects = GIVEN | MOMENTUM | SPAR_AERO_TIP_LOSS},
     {.aero = 1, .rotor = 1, .aero_effects = GIVEN | MOMENTUM},
     {0}},
    {"hub loss",
     "add_loss_plain add_loss_avx2",
     NEVER,
     {.aero = 1, .rotor = 1, .aero_effects = GIVEN | MOMENTUM | SPAR_AERO_HUB_LOSS},
     {.aero = 1, .rotor = 1, .aero_effects = GIVEN | MOMENTUM},
     {.aero = 1, .rotor = 1, .aero_effects = GIVEN | MOMENTUM | SPAR_AERO_HUB_LOSS, .no_hub = 1}},
    {"swirl",
     "",
     0,
     {.aero = 1, .rotor = 1, .aero_effects = GIVEN | MOMENTUM | SPAR_AERO_SWIRL},
     {.aero = 1, .rotor = 1, .aero_effects = GIVEN | MOMENTUM},
     {0}},
    {"drag", "spari_table_drag", 0, {.aero = 1}, {.aero = 1, .aero_effects = GIVEN}, {0}},
    {"pitching moment",
     "spari_table_moment",
     NEVER,
     {.aero = 1, .cm = 1},
     {.aero = 1, .cm = 1, .aero_effects = GIVEN | SPAR_AERO_DRAG},
     {.aero = 1}},
    {"wind shear",
     "spari_wind_meet pow",
     0,
     {.aero = 1, .shear = 1},
     {.aero = 1, .shear = 1, .aero_effects = GIVEN | SPAR_AERO_DRAG},
     {0}},
    {"tower shadow",
     "spari_wind_meet",
     0,
     {.aero = 1, .tower = 1},
     {.aero = 1, .tower = 1, .aero_effects = GIVEN | SPAR_AERO_DRAG},
     {0}},
    {"dynamic inflow",
     "spari_inflow_step spari_lag recall_sections remember_sections",
     0,
     {.aero = 1, .rotor = 1, .aero_effects = GIVEN | MOMENTUM | SPAR_AERO_INFLOW},
     {.aero = 1, .rotor = 1, .aero_effects = GIVEN | MOMENTUM},
     {0}},
    {"dynamic stall",
     "spari_stall_step spari_lag recall_sections remember_sections",
     NEVER,
     {.aero = 1, .aero_effects = GIVEN | SPAR_AERO_DRAG | SPAR_AERO_STALL},
     {.aero = 1, .aero_effects = GIVEN | SPAR_AERO_DRAG},
     {.aero = 1}},
    {"unsteady airfoil",
     "spari_wake_step spari_lag accelerate_air recall_sections remember_sections",
     NEVER,
     {.aero = 1, .aero_effects = GIVEN | SPAR_AERO_DRAG | SPAR_AERO_UNSTEADY},
     {.aero = 1, .aero_effects = GIVEN | SPAR_AERO_DRAG},
     {.aero = 1}},
};

static void run(const char *mode, const effect *e, const char *state, const setting *is) {
    scene s;
    make(&s, is);
    for (int k = 0; k < WARM; k++) {
        step(&s, k);
    }
    s.iterations = 0, up = down = 0;
    count_begin();
    for (int k = WARM; k < WARM + STEPS; k++) {
        step(&s, k);
    }
    count_end();
    if (strcmp(mode, "count") == 0) {
        printf("%s|%s|%d|%s\n", e->name, state, STEPS, e->functions);
    } else if (strcmp(mode, "bytes") == 0) {
        printf("%s|%s|%lld\n", e->name, state, heap - s.described);
    } else if (words == 1) {
        printf("%s|%s|%lld|%lld\n", e->name, state, up / s.iterations, down / s.iterations);
    }
    unmake(&s);
}

int main(int argc, char **argv) {
    const char *mode = argc == 2 ? argv[1] : "";
#ifdef SPARI_HAVE_MPI
    if (strcmp(mode, "words") == 0) {
        int rank;
        MPI_Init(NULL, NULL);
        MPI_Comm_rank(MPI_COMM_WORLD, &rank);
        words = rank == 0 ? 1 : -1;
    }
#endif
    if (!words && strcmp(mode, "count") != 0 && strcmp(mode, "bytes") != 0) {
        fprintf(stderr, "effects count | bytes | words (on ranks of MPI)\n");
        return 2;
    }
    for (size_t i = 0; i < sizeof effects / sizeof *effects; i++) {
        const effect *e = &effects[i];
        run(mode, e, "on", &e->on);
        run(mode, e, "off", &e->off);
        if (e->flags & NEVER) {
            run(mode, e, "never", &e->never);
        }
    }
#ifdef SPARI_HAVE_MPI
    if (words) {
        MPI_Finalize();
    }
#endif
    return 0;
}
