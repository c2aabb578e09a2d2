/* Threads whose stack is small (128 kB, as musl's are): steps, pulls and pushes, static solutions, modes, eigenvalues,
   files, and advice with its trial runs, with vectors of each width. Half of it is left to the host: 64 kB are the
   bound. The stack is this test's own memory with a page below that nobody may touch, so that a frame too much ends the
   program. */
#include "scene.h"
#include "trials.h"

#include "fluid/state.h"
#include "member/body.h"
#include "member/structure.h"

#include <pthread.h>
#include <spar/spar_output.h>
#include <stdio.h>
#include <sys/mman.h>
#include <unistd.h>

enum {
#if defined(__SANITIZE_ADDRESS__) || !defined(__OPTIMIZE__)
    ROOM = 8, /* their frames are others */
#else
    ROOM = 1,
#endif
    STACK = ROOM * 128 * 1024,
    NODES = 300,
    PAINT = 0x5a
};

/* What a thread does and how it went: the line of the first call that failed, for assertions belong to the main one. */
typedef struct errand {
    int lanes, consistent, advised, line;
    char message[1024];
    unsigned char *top; /* of its stack */
} errand;

#define DO(call)                                                                                                       \
    do {                                                                                                               \
        if ((call) != SPAR_OK) {                                                                                       \
            e->line = __LINE__;                                                                                        \
            snprintf(e->message, sizeof e->message, "%s", spar_session_message(s));                                    \
            return;                                                                                                    \
        }                                                                                                              \
    } while (0)

typedef struct flow {
    spar_fluid *fluid;
    double x[3 * NODES], v[3 * NODES], q[4 * NODES], omega[3 * NODES], accel[3 * NODES], force[3 * NODES];
} flow;

static flow here; /* large, and one thread runs at a time */

/* A wind along y that the nodes' motion takes from; poses and times between too. */
static int solve(spar_session *s, double t, double dt, int iteration, void *context) {
    flow *f = context;
    int64_t n;
    (void)s, (void)t, (void)dt, (void)iteration;
    int status = spar_fluid_get_count(f->fluid, SPAR_NODES_MOTION, &n);
    status = status != SPAR_OK ? status : spar_fluid_pull_motion(f->fluid, 0.5, f->x, f->v);
    status = status != SPAR_OK
                 ? status
                 : spar_fluid_pull_poses(f->fluid, SPAR_NODES_MOTION, 1, NULL, f->q, NULL, f->omega, f->accel, NULL);
    status = status != SPAR_OK ? status : spar_fluid_pull_motion(f->fluid, 1, f->x, f->v);
    for (int64_t i = 0; i < 3 * n; i++) {
        f->force[i] = (i % 3 == 1 ? 0.02 : 0) - 1e-3 * f->v[i];
    }
    return status != SPAR_OK ? status : spar_fluid_push_forces(f->fluid, f->force, f->v);
}

static void set_lanes(const spar_member *m, const spar_fluid *f, int lanes) {
    m->body->lanes = lanes;
    for (int k = 0; k < 2; k++) {
        if (f->set[k].nodes) {
            f->set[k].nodes->lanes = lanes;
        }
    }
}

static void describe(errand *e, spar_session *s, spar_member **blade) {
    const double eta[2] = {0, 1}, xyz[6] = {0, 0, 0, 10, 0, 0}, down[3] = {0, 0, -9.81},
                 load[12] = {0, 0, 0.1, 0, 0, 0, 0, 0, 0.2, 0, 0, 0};
    double K[36], M[36], mu[6] = {1e-4, 1e-4, 1e-4, 1e-4, 1e-4, 1e-4};
    scene_box(K, M);
    DO(spar_session_set_gravity(s, down));
    DO(spar_session_set_coupling(s, SPAR_COUPLING_IQN_ILS, 1e-8, 1e-8, 50));
    DO(spar_beam_create(s, "blade", 2, 10, blade));
    DO(spar_beam_set_axis(*blade, 2, eta, xyz, NULL));
    DO(spar_beam_set_sections(*blade, 1, eta, K, M));
    DO(spar_beam_set_damping(*blade, mu));
    DO(spar_member_commit(*blade));
    DO(spar_beam_set_line_load(*blade, SPAR_LOAD_FOLLOWER, 2, eta, load));
    DO(spar_fluid_create(*blade, "surface", &here.fluid));
    for (int i = 0; i < NODES; i++) {
        const double x[3] = {10.0 * i / NODES, 0.1 * (i % 3), 0.1 * (i % 5)};
        memcpy(here.x + 3 * i, x, sizeof x);
    }
    DO(spar_fluid_set_interpolation(here.fluid, e->consistent ? SPAR_INTERPOLATE_CONSISTENT : SPAR_INTERPOLATE_NODAL));
    DO(spar_fluid_set_projection(here.fluid, e->consistent ? SPAR_PROJECT_RPOLY : SPAR_PROJECT_BOUNDED, 0));
    DO(spar_fluid_set_motion_nodes(here.fluid, NODES, here.x));
    DO(spar_fluid_set_force_nodes(here.fluid, NODES, here.x));
    DO(spar_fluid_map(here.fluid));
    set_lanes(*blade, here.fluid, e->lanes);
}

static void run(errand *e, spar_session *s, spar_member *blade, const char *file) {
    double frequency[4], advice[ADVICE_COUNT], eigenvalue[8], frame[3];
    const double shift[2] = {0, 1};
    DO(spar_member_solve_static(blade, 2));
    DO(spar_session_solve_static(s, 1, solve, &here, NULL));
    DO(spar_member_solve_modes(blade, 4, frequency, NULL));
    DO(spar_member_solve_eigenvalues(blade, 4, shift, eigenvalue, NULL, frame));
    for (int k = 0; k < 2; k++) {
        DO(spar_session_set_reproducible(s, k));
        DO(spar_step(s, 1e-2, solve, &here, NULL));
    }
    DO(spar_session_save(s, file));
    DO(spar_session_load(s, file));
    DO(spar_member_write_vtk(blade, file));
    if (!e->advised) {
        return;
    }
    DO(trial_advise(s, 0.5, 2e-3, 32, 32 * 2e-3, NULL, solve, &here, advice));
}

static void *work(void *context) {
    errand *e = context;
    e->top = (unsigned char *)&e;
    spar_session *s = NULL;
    spar_member *blade = NULL;
    char file[64];
    snprintf(file, sizeof file, "small_stack_%d_%d", e->lanes, e->consistent);
    if (spar_session_create(&s) != SPAR_OK) {
        e->line = __LINE__;
        return NULL;
    }
    describe(e, s, &blade);
    if (!e->line) {
        run(e, s, blade, file);
    }
    remove(file);
    spar_session_destroy(&s);
    return NULL;
}

/* From `top` down to the lowest byte that is painted no more; the stack grows downwards. Above are the thread's own
   variables, of all libraries: an OpenBLAS with threads has 60 kB of them. */
static size_t used(const unsigned char *stack, const unsigned char *top) {
    const unsigned char *at = stack;
    while (at < top && *at == PAINT) {
        at++;
    }
    return (size_t)(top - at);
}

static void all_calls_fit(void **unused) {
    (void)unused;
    const int lanes[] = {2, 4, 8}; /* those the processor lacks fall back to the next narrower */
    const size_t page = (size_t)sysconf(_SC_PAGESIZE);
    void *block = NULL;
    assert_int_equal(posix_memalign(&block, page, page + STACK), 0);
    unsigned char *room = block;
    assert_int_equal(mprotect(room, page, PROT_NONE), 0);
    for (int k = 0; k < 6; k++) {
        errand e = {.lanes = lanes[k / 2], .consistent = k % 2, .advised = k == 5};
        pthread_attr_t attributes;
        pthread_t thread;
        memset(room + page, PAINT, STACK);
        assert_int_equal(pthread_attr_init(&attributes), 0);
        assert_int_equal(pthread_attr_setstack(&attributes, room + page, STACK), 0);
        assert_int_equal(pthread_create(&thread, &attributes, work, &e), 0);
        assert_int_equal(pthread_join(thread, NULL), 0);
        pthread_attr_destroy(&attributes);
        size_t most = used(room + page, e.top);
        print_message("%d lanes, %s: %zu kB of stack\n", e.lanes, e.consistent ? "consistent" : "nodal", most / 1024);
        if (e.line) {
            fail_msg("line %d: %s", e.line, e.message);
        }
        assert_true(most > 4096 && most <= STACK / 2);
    }
    assert_int_equal(mprotect(room, page, PROT_READ | PROT_WRITE), 0);
    free(block);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(all_calls_fit)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
