/* Random scenes, each played several times: as it is; with 2, 3 or 7 threads; with getters and refused calls in
   between, around which the saved session must stay the same to the byte; saved and loaded into another session, within
   steps too, which goes on; with steps that are rejected and made again, by other dt; with both. All end with the same
   bits. Scenes have joints and lines of all kinds, members whose motion is given, fluids with added mass, guessed or
   learned, substeps, a balanced start or none, and uneven steps.

     twins [--scenes n] [--seed s] [--keep] [--one]     one: the seed is that of a scene that was told */
#include <spar/spar.h>
#include <spar/spar_analysis.h>
#include <spar/spar_coupling.h>
#include <spar/spar_structure.h>

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { MOST_MEMBERS = 7, MOST_JOINTS = 8, MOST_FLUIDS = 3, PLACES = 3, STEPS = 7, ROW = 2048, NODES = 32 };
enum way { PLAIN, THREADS, ASKED, LOADED, REJECTED, LOADED_REJECTED, WAYS };
static const char *const way_name[WAYS] = {"as it is", "threads", "asked", "loaded", "rejected", "loaded and rejected"};

typedef struct scene {
    uint64_t random; /* of the description and the run: the same in all ways */
    uint64_t own;    /* of the way */
    enum way way;
    spar_session *s;
    int members, joints, fluids, start;
    int within; /* loaded within steps too */
    spar_member *member[MOST_MEMBERS];
    int kind[MOST_MEMBERS]; /* KIND_* */
    spar_joint *joint[MOST_JOINTS];
    int driven[MOST_JOINTS];
    spar_fluid *fluid[MOST_FLUIDS];
    double heavy[MOST_FLUIDS], time;
} scene;
enum { KIND_BODY, KIND_BEAM, KIND_POINT, KIND_EXTERNAL, KIND_PRESCRIBED, KINDS };

static char folder[64], why[600];
static const double unit[4] = {1, 0, 0, 0};

static uint64_t mix(uint64_t *state) {
    uint64_t x = *state += UINT64_C(0x9e3779b97f4a7c15);
    x = (x ^ (x >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    x = (x ^ (x >> 27)) * UINT64_C(0x94d049bb133111eb);
    return x ^ (x >> 31);
}

static int draw(uint64_t *state, int n) {
    return (int)(mix(state) % (uint64_t)n);
}

static double between(uint64_t *state, double a, double b) {
    return a + (b - a) * (double)(mix(state) >> 11) * 0x1p-53;
}

static void diagonal(double m[36], double a, double b) {
    memset(m, 0, 36 * sizeof *m);
    for (int i = 0; i < 6; i++) {
        m[7 * i] = i < 3 ? a : b;
    }
}

/* ---- the description ---- */

static void describe_beam(scene *w, int i, const double at[3]) {
    spar_member *b = w->member[i];
    const double eta[2] = {0, 1}, axis[6] = {0, 0, 0, 1, between(&w->random, -0.1, 0.1), 0};
    double K[36], M[36];
    static const int fidelity[] = {SPAR_FIDELITY_EXACT, SPAR_FIDELITY_EXACT, SPAR_FIDELITY_LINEAR, SPAR_FIDELITY_MODAL,
                                   SPAR_FIDELITY_RIGID};
    int root = draw(&w->random, 3), kind = fidelity[draw(&w->random, 5)];
    diagonal(K, 1e6, 500);
    diagonal(M, 2, 0.02);
    (void)spar_beam_set_axis(b, 2, eta, axis, NULL);
    (void)spar_beam_set_sections(b, 1, eta, K, M);
    (void)spar_member_set_placement(b, at, unit);
    if (w->kind[i] == KIND_PRESCRIBED) {
        (void)spar_member_set_fidelity(b, SPAR_FIDELITY_PRESCRIBED, 0);
        root = 1;
    } else {
        (void)spar_member_set_fidelity(b, kind, kind == SPAR_FIDELITY_MODAL ? 9 : 0);
    }
    (void)spar_member_set_root(b, root == 0 ? SPAR_ROOT_FIXED : root == 1 ? SPAR_ROOT_DRIVEN : SPAR_ROOT_FREE);
    if (draw(&w->random, 2)) {
        const double mu[6] = {1e-3, 1e-3, 1e-3, 1e-3, 1e-3, 1e-3};
        (void)spar_beam_set_damping(b, mu);
    }
}

static void add_member(scene *w) {
    int i = w->members;
    const double at[3] = {between(&w->random, 0, 2), 1.5 * i, between(&w->random, -1, 1)};
    char name[8];
    double M[36];
    int kind = draw(&w->random, 8), beam;
    kind = kind < 2 ? KIND_BODY : kind < 5 ? KIND_BEAM : kind - 3;
    beam = kind == KIND_BEAM || kind == KIND_PRESCRIBED;
    (void)snprintf(name, sizeof name, "m%d", i);
    diagonal(M, 2, 0.3);
    w->kind[i] = kind;
    int status = beam                 ? spar_beam_create(w->s, name, 1 + draw(&w->random, 2), 4, &w->member[i])
                 : kind == KIND_POINT ? spar_point_create(w->s, name, at, unit, &w->member[i])
                                      : spar_rigid_create(w->s, name, at, unit, M, &w->member[i]);
    spar_member *m = w->member[i];
    if (status != SPAR_OK) {
        return;
    }
    w->members++;
    if (beam) {
        describe_beam(w, i, at);
    }
    if (kind == KIND_EXTERNAL) {
        (void)spar_member_set_external(m, 1);
    }
    if (kind == KIND_BODY || kind == KIND_BEAM) {
        const double omega[3] = {0, between(&w->random, -1, 1), between(&w->random, -1, 1)}, eta[2] = {0, 1};
        double added[72];
        diagonal(added, 0.7, 0.01);
        diagonal(added + 36, 0.7, 0.01);
        if (draw(&w->random, 2)) {
            (void)spar_member_set_initial_velocity(m, at, NULL, omega);
        }
        switch (draw(&w->random, 4)) {
        case 0:
            (void)spar_member_set_added_mass(m, beam ? 2 : 1, eta, added);
            break;
        case 1:
            (void)spar_member_learn_added_mass(m, beam ? 2 : 1, eta);
            break;
        default:
            break;
        }
        if (draw(&w->random, 2)) {
            (void)spar_member_set_effects(m, SPAR_EFFECT_WORK, 0);
        }
    }
}

static void add_joint(scene *w) {
    static const int frees[] = {0, SPAR_FREE_RY, SPAR_FREE_RX | SPAR_FREE_RZ, 56, 63, SPAR_FREE_X, 63};
    int a = draw(&w->random, w->members), b = draw(&w->random, w->members + 1), k = w->joints;
    int free_motions = frees[draw(&w->random, 7)], line = draw(&w->random, 4) == 0;
    int64_t count = 1, last;
    double x[3], all[3 * NODES], K[36], D[36], far[3];
    char name[8];
    (void)snprintf(name, sizeof name, "j%d", k);
    if (spar_member_get_count(w->member[a], &count) != SPAR_OK || count > NODES ||
        spar_member_get_reference(w->member[a], all, NULL) != SPAR_OK || a == b) {
        return;
    }
    last = draw(&w->random, 2) ? count - 1 : 0;
    memcpy(x, all + 3 * last, sizeof x);
    for (int i = 0; i < 3; i++) {
        far[i] = x[i] + 0.3 + 0.2 * i;
    }
    spar_member *to = b < w->members ? w->member[b] : NULL;
    int status = line ? spar_link_create(w->s, name, w->member[a], last, x, to, 0, far, &w->joint[k])
                      : spar_joint_create(w->s, name, w->member[a], last, to, 0, free_motions, &w->joint[k]);
    if (status != SPAR_OK) {
        return;
    }
    w->joints++;
    w->driven[k] = 0;
    if (line) {
        (void)(draw(&w->random, 3) ? spar_link_set_spring(w->joint[k], 400, 4, 0.5, draw(&w->random, 2)) : 0);
        return;
    }
    diagonal(K, 60, 20);
    diagonal(D, 1, 0.3);
    for (int i = 0; i < 36; i += 7) {
        K[i] = free_motions >> (i / 7) & 1 ? K[i] : 0;
        D[i] = free_motions >> (i / 7) & 1 ? D[i] : 0;
    }
    (void)spar_joint_set_frame(w->joint[k], x, unit);
    (void)(draw(&w->random, 3) ? spar_joint_set_spring(w->joint[k], K, D, NULL) : 0);
    if (free_motions == SPAR_FREE_RY && draw(&w->random, 2)) {
        w->driven[k] = spar_joint_set_driven(w->joint[k], SPAR_FREE_RY) == SPAR_OK;
    }
}

static void add_fluid(scene *w, int i) {
    double all[3 * NODES];
    int64_t count;
    if (w->fluids == MOST_FLUIDS || spar_member_get_count(w->member[i], &count) != SPAR_OK || count > NODES ||
        spar_member_get_reference(w->member[i], all, NULL) != SPAR_OK) {
        return;
    }
    double x[3 * PLACES];
    for (int k = 0; k < PLACES; k++) {
        memcpy(x + 3 * k, all + 3 * ((count - 1) * k / (PLACES - 1)), 3 * sizeof *x);
        x[3 * k + 2] += 0.05;
    }
    spar_fluid **f = w->fluid + w->fluids;
    if (spar_fluid_create(w->member[i], "fluid", f) == SPAR_OK) {
        (void)spar_fluid_set_motion_nodes(*f, PLACES, x);
        (void)spar_fluid_set_force_nodes(*f, PLACES, x);
        (void)spar_fluid_map(*f);
        w->heavy[w->fluids++] = draw(&w->random, 2) ? between(&w->random, 0, 0.3) : 0;
    }
}

static void describe(scene *w, uint64_t seed, enum way way) {
    *w = (scene){.random = seed, .own = seed ^ (uint64_t)way * 77, .way = way};
    (void)spar_session_create(&w->s);
    const double g[3] = {0, 0, -9.81};
    (void)spar_session_set_gravity(w->s, g);
    (void)spar_session_set_newton(w->s, 1e-15, draw(&w->random, 2) ? 1e-8 : 1e-12, 50);
    (void)spar_session_set_integrator(w->s, between(&w->random, 0.5, 1), 1 + draw(&w->random, 3));
    (void)spar_session_set_predictor(w->s, draw(&w->random, 3));
    (void)spar_session_set_coupling(w->s, draw(&w->random, 4), 1e-10, 1e-8, 60);
    (void)spar_session_set_option(w->s, "coupling.unconverged", "accept");
    (void)spar_session_set_option(w->s, "coupling.patience", "1000");
    w->start = draw(&w->random, 2);
    int members = 2 + draw(&w->random, MOST_MEMBERS - 1), joints = draw(&w->random, MOST_JOINTS + 1);
    for (int i = 0; i < members; i++) {
        add_member(w);
    }
    for (int i = 0; i < w->members; i++) {
        (void)spar_member_commit(w->member[i]);
    }
    for (int i = 0; i < joints && w->members > 0; i++) {
        add_joint(w);
    }
    for (int i = 0; i < w->members; i++) {
        if (draw(&w->random, 2)) {
            add_fluid(w, i);
        }
    }
    w->within = draw(&w->own, 2);
    if (way == THREADS) {
        static const int threads[] = {2, 3, 7};
        (void)spar_session_set_threads(w->s, threads[draw(&w->own, 3)]);
    }
}

/* ---- the run ---- */

static int push_all(scene *w, double t) {
    int status = SPAR_OK;
    for (int k = 0; k < w->fluids && status == SPAR_OK; k++) {
        double v[3 * PLACES], a[3 * PLACES], f[3 * PLACES];
        status = spar_fluid_pull_poses(w->fluid[k], SPAR_NODES_MOTION, 1, NULL, NULL, v, NULL, a, NULL);
        for (int i = 0; i < 3 * PLACES; i++) {
            f[i] = -w->heavy[k] * a[i] - 0.2 * v[i] + sin(7 * t + i + k);
        }
        status = status == SPAR_OK ? spar_fluid_push_forces(w->fluid[k], f, NULL) : status;
    }
    return status;
}

static int start_fluid(spar_session *s, double t, double dt, int iteration, void *context) {
    (void)s, (void)dt, (void)iteration;
    return push_all(context, t);
}

static void motion_at(double t, int i, double q[7], double v[6], double a[6]) {
    double c = 0.3 + 0.1 * i;
    memset(q, 0, 7 * sizeof *q), memset(v, 0, 6 * sizeof *v), memset(a, 0, 6 * sizeof *a);
    q[0] = 0.1 * sin(c * t) * t, v[0] = 0.1 * (c * cos(c * t) * t + sin(c * t));
    a[0] = 0.1 * (2 * c * cos(c * t) - c * c * sin(c * t) * t);
    q[3] = cos(0.25 * c * t * t), q[5] = sin(0.25 * c * t * t), v[4] = c * t, a[4] = c;
}

/* Of what moves as it is told: ahead of a step, or within it. */
static void tell(scene *w, double t, int within) {
    double q[7], v[6], a[6];
    for (int i = 0; i < w->members; i++) {
        int root = SPAR_ROOT_FREE;
        (void)spar_member_get_root(w->member[i], &root);
        motion_at(t, i, q, v, a);
        if (within && w->kind[i] == KIND_EXTERNAL) {
            (void)spar_member_set_motion(w->member[i], q, v, a);
        } else if (!within && (w->kind[i] == KIND_POINT || (root == SPAR_ROOT_DRIVEN && w->kind[i] != KIND_EXTERNAL))) {
            (void)spar_member_drive(w->member[i], q, v, a);
        }
    }
    for (int k = 0; k < w->joints && !within; k++) {
        const double z[6] = {0, 0, 0, 0, 0.2 * t * t, 0}, rate[6] = {0, 0, 0, 0, 0.4 * t, 0};
        (void)(w->driven[k] ? spar_joint_drive(w->joint[k], z, rate, NULL) : 0);
    }
}

static char *contents(const char *path, long *size) {
    FILE *f = fopen(path, "rb");
    char *all = NULL;
    *size = 0;
    if (f && fseek(f, 0, SEEK_END) == 0 && (*size = ftell(f)) > 0 && (all = malloc((size_t)*size))) {
        rewind(f);
        *size = fread(all, 1, (size_t)*size, f) == (size_t)*size ? *size : 0;
    }
    if (f) {
        (void)fclose(f);
    }
    return all;
}

static void path_of(char path[100], const char *name) {
    (void)snprintf(path, 100, "%s/%s", folder, name);
}

/* Calls that must be refused here, and change nothing. */
static int refused(scene *w, int which) {
    const double bad[7] = {NAN, 0, 0, 0, 0, 0, 0};
    double dt = -1;
    spar_member *m = w->member[draw(&w->own, w->members)];
    spar_joint *j = w->joints ? w->joint[draw(&w->own, w->joints)] : NULL;
    switch (which) {
    case 0:
        return spar_session_set_integrator(w->s, 2, 1);
    case 1:
        return spar_step_begin(w->s, -1);
    case 2:
        return spar_session_load(w->s, "/nowhere/at/all");
    case 3:
        return spar_member_set_load(m, -1, SPAR_LOAD_DEAD, bad);
    case 4:
        return j ? spar_joint_set_load(j, bad) : SPAR_ERR_ARGUMENT;
    case 5:
        return j ? spar_joint_drive(j, bad, NULL, NULL) : SPAR_ERR_ARGUMENT;
    case 6:
        return spar_member_solve_static(m, 0);
    case 7:
        return spar_step_adaptive(w->s, &dt, NULL, NULL, NULL, NULL);
    case 8:
        return spar_member_solve_modes(m, 100000, &dt, NULL);
    case 9:
        return spar_member_drive(m, bad, NULL, NULL);
    case 10:
        return spar_session_save(w->s, "/nowhere/at/all");
    default:
        return spar_session_set_option(w->s, "coupling.reuse", "many");
    }
}

static void ask(scene *w, int which) {
    double x[19 * NODES], more[6], error;
    int64_t n = 0;
    spar_member *m = w->member[draw(&w->own, w->members)];
    spar_joint *j = w->joints ? w->joint[draw(&w->own, w->joints)] : NULL;
    (void)spar_member_get_count(m, &n);
    switch (which) {
    case 0:
        (void)spar_member_estimate_error(m, NULL, &error);
        break;
    case 1:
        (void)spar_member_solve_modes(m, 1, x, NULL);
        break;
    case 2:
        (void)spar_member_get_energy(m, SPAR_ENERGY_COUNT, x);
        (void)spar_member_get_work(m, SPAR_WORK_COUNT, x);
        break;
    case 3:
        (void)(n <= NODES ? spar_member_get_motion(m, x, x + 7 * n, x + 13 * n) : 0);
        (void)spar_member_get_reaction(m, x);
        break;
    case 4:
        (void)(j ? spar_joint_get_motion(j, x, x + 6, x + 12) : 0);
        (void)(j ? spar_joint_get_energy(j, SPAR_JOINT_ENERGY_COUNT, x) : 0);
        (void)(j ? spar_joint_get_load(j, x) : 0);
        break;
    case 5:
        (void)spar_session_get_report(w->s, SPAR_REPORT_COUNT, x);
        (void)spar_session_get_iterations(w->s, NULL, 10, x, x + 10);
        break;
    case 6:
        (void)spar_beam_evaluate(m, 1, &(const double){0.4}, x, x + 6, x + 12, x + 15);
        break;
    case 7:
        (void)spar_member_solve_eigenvalues(m, 1, NULL, x, NULL, more);
        break;
    default:
        (void)spar_member_get_learned_added_mass(m, NULL, &error, NULL, 0, NULL, NULL);
        break;
    }
}

/* The file of the session before and after a refused call and getters. */
static int stays(scene *w) {
    char before[100], after[100];
    long size[2];
    int which = draw(&w->own, 12), getter = draw(&w->own, 9);
    path_of(before, "before"), path_of(after, "after");
    int can = spar_session_save(w->s, before);
    if (draw(&w->own, 2)) {
        ask(w, getter);
        which = -1;
    } else if (refused(w, which) == SPAR_OK) {
        (void)snprintf(why, sizeof why, "a call that should be refused succeeds: number %d", which);
        return 1;
    }
    if (can != SPAR_OK || spar_session_save(w->s, after) != SPAR_OK) {
        return 0;
    }
    char *a = contents(before, &size[0]), *b = contents(after, &size[1]);
    int same = a && b && size[0] == size[1] && memcmp(a, b, (size_t)size[0]) == 0;
    free(a);
    free(b);
    if (!same) {
        (void)snprintf(why, sizeof why, "the file differs after %s %d", which < 0 ? "getter" : "refused call",
                       which < 0 ? getter : which);
    }
    return !same;
}

/* The session goes on as another one, from a file. */
static int reload(scene *w, uint64_t seed) {
    char path[100];
    scene other;
    path_of(path, "state");
    if (spar_session_save(w->s, path) != SPAR_OK) {
        (void)snprintf(why, sizeof why, "save: %.400s", spar_session_message(w->s));
        return 1;
    }
    describe(&other, seed, w->way);
    if (spar_session_load(other.s, path) != SPAR_OK) {
        if (w->time == 0 && strstr(spar_session_message(other.s), "joint '")) { /* a scene that cannot be */
            spar_session_destroy(&other.s);
            return 0;
        }
        (void)snprintf(why, sizeof why, "load: %.400s", spar_session_message(other.s));
        spar_session_destroy(&other.s);
        return 1;
    }
    spar_session_destroy(&w->s);
    other.random = w->random, other.own = w->own, other.time = w->time, other.within = w->within;
    *w = other;
    return 0;
}

/* Between any two calls of a step. *bad: what must not be. */
static void between_calls(scene *w, uint64_t seed, int *bad) {
    int phase = SPAR_PHASE_BETWEEN;
    (void)spar_session_get_phase(w->s, &phase);
    if (w->way == ASKED && draw(&w->own, 2)) {
        *bad = *bad || stays(w);
    } else if ((w->way == LOADED || w->way == LOADED_REJECTED) && draw(&w->own, w->within ? 6 : 2) == 0 &&
               (w->within || phase <= SPAR_PHASE_BETWEEN)) {
        *bad = *bad || reload(w, seed);
    }
}

/* A step to its end, or a part of it; the status. */
static int play_step(scene *w, uint64_t seed, double dt, int give_up, int *bad) {
    int done = 0, status = spar_step_begin(w->s, dt);
    for (int k = 0; !done && status == SPAR_OK && !*bad && (!give_up || k < give_up); k++) {
        tell(w, w->time + dt, 1);
        between_calls(w, seed, bad);
        status = *bad ? SPAR_OK : spar_step_solve(w->s);
        between_calls(w, seed, bad);
        status = status == SPAR_OK && !*bad ? push_all(w, w->time + dt) : status;
        between_calls(w, seed, bad);
        status = status == SPAR_OK && !*bad ? spar_step_check(w->s, &done) : status;
        between_calls(w, seed, bad);
    }
    if (status != SPAR_OK || give_up || *bad) {
        (void)spar_step_reject(w->s);
        return status;
    }
    w->time += dt;
    return spar_step_accept(w->s);
}

static void look(const scene *w, double row[ROW]) {
    int at = 1;
    memset(row, 0, ROW * sizeof *row);
    for (int i = 0; i < w->members; i++) {
        int64_t n = 0;
        (void)spar_member_get_count(w->member[i], &n);
        if (n <= NODES && at + 19 * n < ROW) {
            (void)spar_member_get_motion(w->member[i], row + at, row + at + 7 * n, row + at + 13 * n);
            at += (int)(19 * n);
        }
    }
    for (int k = 0; k < w->joints && at + 18 < ROW; k++, at += 18) {
        (void)spar_joint_get_motion(w->joint[k], row + at, row + at + 6, NULL);
        (void)spar_joint_get_load(w->joint[k], row + at + 12);
    }
}

/* A scene in one way; row[0] of each step is its status. Answers whether something was that must not be. */
static int play(uint64_t seed, enum way way, double row[STEPS + 1][ROW]) {
    scene w;
    int bad = 0, status = SPAR_OK;
    memset(row, 0, (STEPS + 1) * ROW * sizeof(double));
    describe(&w, seed, way);
    double dt = between(&w.random, 0.002, 0.02);
    if (w.start && w.members > 0) {
        status = spar_session_solve_initial(w.s, dt, start_fluid, &w, NULL);
        if (status == SPAR_OK) {
            between_calls(&w, seed, &bad);
        }
    }
    look(&w, row[0]);
    row[0][0] = status;
    for (int k = 1; k <= STEPS && w.members > 0 && status == SPAR_OK && !bad; k++) {
        double h = draw(&w.random, 3) ? dt : dt * between(&w.random, 0.2, 3);
        tell(&w, w.time + h, 0);
        between_calls(&w, seed, &bad);
        for (int again = way >= REJECTED ? draw(&w.own, 3) : 0; again > 0; again--) {
            (void)play_step(&w, seed, h * between(&w.own, 0.5, 2), 1 + draw(&w.own, 2), &bad);
            tell(&w, w.time + h, 0);
        }
        status = bad ? SPAR_OK : play_step(&w, seed, h, 0, &bad);
        look(&w, row[k]);
        row[k][0] = status;
    }
    if (status != SPAR_OK) {
        (void)snprintf(why, sizeof why, "%.500s", spar_session_message(w.s));
    }
    spar_session_destroy(&w.s);
    return bad;
}

/* Whether two ways agree to the bit; *step and *worst: where they do not, and by how much of the largest number. */
static int agree(double one[STEPS + 1][ROW], double other[STEPS + 1][ROW], int *step, double *worst) {
    for (int k = 0; k <= STEPS; k++) {
        double size = 1;
        *step = k, *worst = 0;
        for (int i = 1; i < ROW; i++) {
            size = fmax(size, fabs(one[k][i]));
            *worst = fmax(*worst, fabs(one[k][i] - other[k][i]));
        }
        *worst /= size;
        if (one[k][0] != other[k][0] || *worst > 0) {
            return 0;
        }
        if (one[k][0] != SPAR_OK) {
            return 1;
        }
    }
    return 1;
}

static int try_scene(uint64_t seed, long *steps) {
    static double plain[STEPS + 1][ROW], other[STEPS + 1][ROW];
    int step = 0;
    double worst = 0;
    (void)play(seed, PLAIN, plain);
    for (int k = 1; k <= STEPS; k++) {
        *steps += plain[k - 1][0] == SPAR_OK && plain[k][0] == SPAR_OK;
    }
    for (enum way way = THREADS; way < WAYS; way++) {
        why[0] = '\0';
        int bad = play(seed, way, other);
        if (bad || !agree(plain, other, &step, &worst)) {
            printf("== scene %#" PRIx64 ", %s: ", seed, way_name[way]);
            if (bad) {
                printf("%s\n", why);
            } else {
                printf("step %d: status %g for %g, %.3g off %s\n", step, other[step][0], plain[step][0], worst, why);
            }
            (void)fflush(stdout);
            return 1;
        }
    }
    return 0;
}

int main(int argc, char **argv) {
    long scenes = 100, steps = 0, found = 0;
    uint64_t seed = 1;
    int keep = 0, one = 0;
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--keep") == 0) {
            keep = 1;
        } else if (strcmp(argv[i], "--one") == 0) {
            one = 1;
        } else if (i + 1 < argc && strcmp(argv[i], "--scenes") == 0) {
            scenes = strtol(argv[++i], NULL, 0);
        } else if (i + 1 < argc && strcmp(argv[i], "--seed") == 0) {
            seed = strtoull(argv[++i], NULL, 0);
        } else {
            (void)fputs("twins [--scenes n] [--seed s] [--keep] [--one]\n", stderr);
            return 2;
        }
    }
    (void)snprintf(folder, sizeof folder, "%s/spar-twins-XXXXXX", access("/dev/shm", W_OK) == 0 ? "/dev/shm" : "/tmp");
    if (!mkdtemp(folder)) {
        perror("twins");
        return 2;
    }
    for (long k = 0; k < scenes && (keep || found == 0); k++) {
        found += try_scene(one ? seed : mix(&seed), &steps);
    }
    static const char *const names[] = {"before", "after", "state"};
    for (int i = 0; i < 3; i++) {
        char path[100];
        path_of(path, names[i]);
        (void)unlink(path);
    }
    (void)rmdir(folder);
    printf("%ld scenes in %d ways, %ld steps each way: %ld found\n", scenes, WAYS, steps, found);
    return found > 0;
}
