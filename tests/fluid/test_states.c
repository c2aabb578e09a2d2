/* Numbers of the host's own that go with a fluid's nodes: through iterations, rejected and accepted steps, static
   solutions, trials, new nodes, save and load. */
#include "scene.h"
#include "trials.h"

#include <stdio.h>

enum { NODES = 3, WIDTH = 2, ALL = NODES * WIDTH };
static const char *const file = "test_states.spar";

typedef struct states_scene {
    spar_session *s;
    spar_member *body;
    spar_fluid *fluid;
    double last[ALL]; /* what the callback pushed last */
} states_scene;

/* A rigid body of 2 kg, free, with three nodes. */
static states_scene create(int64_t width) {
    static const double x[NODES][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, none[3] = {0}, J[3] = {1, 1, 1};
    states_scene c = {.s = scene_session()};
    double M[36];
    scene_mass(M, 2, none, J);
    OK(c.s, spar_rigid_create(c.s, "body", none, NULL, M, &c.body));
    OK(c.s, spar_member_set_root(c.body, SPAR_ROOT_FREE));
    OK(c.s, spar_member_commit(c.body));
    OK(c.s, spar_fluid_create(c.body, "fluid", &c.fluid));
    OK(c.s, spar_fluid_set_force_nodes(c.fluid, NODES, x[0]));
    OK(c.s, spar_fluid_set_motion_nodes(c.fluid, NODES, x[0]));
    OK(c.s, spar_fluid_set_states(c.fluid, width));
    OK(c.s, spar_fluid_map(c.fluid));
    return c;
}

static void expect(const states_scene *c, const double *expected) {
    double seen[ALL];
    OK(c->s, spar_fluid_pull_states(c->fluid, WIDTH, seen));
    assert_memory_equal(seen, expected, sizeof seen);
}

static void push(const states_scene *c, double first) {
    double z[ALL];
    for (int i = 0; i < ALL; i++) {
        z[i] = first + i;
    }
    OK(c->s, spar_fluid_push_states(c->fluid, WIDTH, z));
}

static void fill(double *z, double first) {
    for (int i = 0; i < ALL; i++) {
        z[i] = first + i;
    }
}

/* Pulled are the numbers at t^n, in every iteration, to the bit; those pushed last are in force once the step is
   accepted, and gone when it is rejected; a step without a push leaves them. dt is the step's, and 0 outside. */
static void life(void **state) {
    (void)state;
    states_scene c = create(WIDTH);
    double z[ALL] = {0}, dt = -1;
    int64_t width = -1;
    expect(&c, z);
    OK(c.s, spar_fluid_get_states(c.fluid, &width, &dt));
    assert_true(width == WIDTH && dt == 0);
    push(&c, 10);
    fill(z, 10);
    expect(&c, z);
    for (int accept = 0; accept < 2; accept++) {
        OK(c.s, spar_step_begin(c.s, 0.25));
        for (int k = 0; k < 3; k++) {
            OK(c.s, spar_step_solve(c.s));
            OK(c.s, spar_fluid_get_states(c.fluid, NULL, &dt));
            NEAR(dt, 0.25, 0);
            expect(&c, z);
            push(&c, 100 + 10 * k);
            expect(&c, z);
        }
        OK(c.s, accept ? spar_step_accept(c.s) : spar_step_reject(c.s));
        if (accept) {
            fill(z, 120);
        }
        expect(&c, z);
    }
    scene_run(c.s, 0.25, 2);
    expect(&c, z);
    OK(c.s, spar_step_begin(c.s, 0.25)); /* what a rejected step had is not in the next one's */
    push(&c, 7);
    OK(c.s, spar_step_reject(c.s));
    scene_run(c.s, 0.25, 1);
    expect(&c, z);
    spar_session_destroy(&c.s);
}

/* As many numbers again: they stay. Another count: zeros; so after a map of nodes that were given anew. */
static void other_counts(void **state) {
    (void)state;
    states_scene c = create(WIDTH);
    double z[ALL] = {0};
    static const double x[NODES][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    push(&c, 1);
    fill(z, 1);
    OK(c.s, spar_fluid_set_states(c.fluid, WIDTH));
    expect(&c, z);
    OK(c.s, spar_fluid_map(c.fluid)); /* the same nodes */
    expect(&c, z);
    OK(c.s, spar_fluid_set_states(c.fluid, 5));
    OK(c.s, spar_fluid_set_states(c.fluid, WIDTH));
    memset(z, 0, sizeof z);
    expect(&c, z);
    push(&c, 1);
    OK(c.s, spar_fluid_set_force_nodes(c.fluid, NODES, x[0]));
    OK(c.s, spar_fluid_map(c.fluid));
    expect(&c, z);
    spar_session_destroy(&c.s);
}

/* The exact solution of z' = v - z over the step, v held, in each of the numbers; in time that stands z = v. A force
   -z. */
static int solve(spar_session *s, double t, double dt, int iteration, void *context) {
    states_scene *c = context;
    double z[ALL], v[NODES][3], force[NODES][3] = {{0}}, step = -1;
    (void)t;
    (void)iteration;
    OK(s, spar_fluid_get_states(c->fluid, NULL, &step));
    NEAR(step, dt, 0);
    OK(s, spar_fluid_pull_states(c->fluid, WIDTH, z));
    OK(s, spar_fluid_pull_motion(c->fluid, 1, NULL, v[0]));
    for (int i = 0; i < ALL; i++) {
        double to = v[i / WIDTH][i % WIDTH] + 0.5;
        z[i] = step > 0 ? to + (z[i] - to) * exp(-step) : to;
        force[i / WIDTH][i % WIDTH] = -z[i];
    }
    memcpy(c->last, z, sizeof z);
    OK(s, spar_fluid_push_states(c->fluid, WIDTH, z));
    return spar_fluid_push_forces(c->fluid, force[0], NULL);
}

/* The balanced start has states of its own (0.5, by solve, of a body at rest); iterated steps and a save between them
   go on with the same bits; a trial in between changes nothing. */
static void trial_and_file(void **state) {
    (void)state;
    states_scene c = create(WIDTH), again = create(WIDTH), base = create(WIDTH);
    double z[ALL], report[TRY_COUNT];
    OK(c.s, spar_session_set_coupling(c.s, SPAR_COUPLING_FIXED_POINT, 1e-13, 1e-13, 50));
    OK(again.s, spar_session_set_coupling(again.s, SPAR_COUPLING_FIXED_POINT, 1e-13, 1e-13, 50));
    OK(base.s, spar_session_set_coupling(base.s, SPAR_COUPLING_FIXED_POINT, 1e-13, 1e-13, 50));
    OK(c.s, spar_session_solve_initial(c.s, 0.1, solve, &c, NULL));
    OK(base.s, spar_session_solve_initial(base.s, 0.1, solve, &base, NULL));
    for (int i = 0; i < ALL; i++) {
        z[i] = 0.5;
    }
    expect(&c, z);
    for (int k = 0; k < 6; k++) {
        OK(base.s, spar_step(base.s, 0.1, solve, &base, NULL));
        OK(c.s, spar_step(c.s, 0.1, solve, &c, NULL));
        expect(&c, c.last);
        expect(&c, base.last);
        if (k == 2) {
            memcpy(z, c.last, sizeof z);
            OK(c.s, trial_run(c.s, 0.1, 8, NULL, solve, &c, 0, report));
            assert_memory_not_equal(z, c.last, sizeof z);
            expect(&c, z);
            OK(c.s, spar_session_save(c.s, file));
        }
    }
    OK(again.s, spar_session_load(again.s, file));
    expect(&again, z);
    for (int k = 3; k < 6; k++) {
        OK(again.s, spar_step(again.s, 0.1, solve, &again, NULL));
    }
    expect(&again, base.last);
    remove(file);
    spar_session_destroy(&c.s);
    spar_session_destroy(&again.s);
    spar_session_destroy(&base.s);
}

/* A file within a step has what was pushed in it; one of a fluid without states, or with others, is refused, and what
   there was stays; a fluid that keeps none takes those of the file. */
static void files(void **state) {
    (void)state;
    states_scene c = create(WIDTH), other = create(3), none = create(0);
    double z[ALL];
    OK(c.s, spar_step_begin(c.s, 0.1));
    push(&c, 3);
    OK(c.s, spar_step_solve(c.s));
    OK(c.s, spar_session_save(c.s, file));
    OK(c.s, spar_step_accept(c.s));
    fill(z, 3);
    expect(&c, z);
    REFUSED(other.s, SPAR_ERR_ARGUMENT, "3 states per node", spar_session_load(other.s, file));
    OK(none.s, spar_session_load(none.s, file));
    OK(none.s, spar_step_accept(none.s));
    expect(&none, z);
    OK(other.s, spar_fluid_set_states(other.fluid, 0));
    OK(other.s, spar_session_save(other.s, file));
    states_scene kept = create(WIDTH);
    push(&kept, 3);
    REFUSED(kept.s, SPAR_ERR_ARGUMENT, "the saved run has 0", spar_session_load(kept.s, file));
    expect(&kept, z);
    remove(file);
    spar_session_destroy(&c.s);
    spar_session_destroy(&other.s);
    spar_session_destroy(&none.s);
    spar_session_destroy(&kept.s);
}

static void refusals(void **state) {
    (void)state;
    states_scene c = create(WIDTH);
    double z[ALL] = {0}, bad[ALL] = {0};
    bad[3] = NAN;
    push(&c, 3);
    REFUSED(c.s, SPAR_ERR_ARGUMENT, "-1 states", spar_fluid_set_states(c.fluid, -1));
    REFUSED(c.s, SPAR_ERR_ARGUMENT, "1001 states", spar_fluid_set_states(c.fluid, 1001));
    REFUSED(c.s, SPAR_ERR_ARGUMENT, "3 states per node, but 2", spar_fluid_pull_states(c.fluid, 3, z));
    REFUSED(c.s, SPAR_ERR_ARGUMENT, "3 states per node, but 2", spar_fluid_push_states(c.fluid, 3, z));
    REFUSED(c.s, SPAR_ERR_ARGUMENT, "NULL", spar_fluid_pull_states(c.fluid, WIDTH, NULL));
    REFUSED(c.s, SPAR_ERR_ARGUMENT, "NULL", spar_fluid_push_states(c.fluid, WIDTH, NULL));
    REFUSED(c.s, SPAR_ERR_ARGUMENT, "state of node 1, component 1", spar_fluid_push_states(c.fluid, WIDTH, bad));
    assert_int_equal(spar_fluid_set_states(NULL, 1), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_fluid_get_states(NULL, NULL, NULL), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_fluid_pull_states(NULL, 1, z), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_fluid_push_states(NULL, 1, z), SPAR_ERR_ARGUMENT);
    OK(c.s, spar_step_begin(c.s, 0.1));
    REFUSED(c.s, SPAR_ERR_STATE, "step is in progress", spar_fluid_set_states(c.fluid, 4));
    OK(c.s, spar_step_reject(c.s));
    scene_run(c.s, 0.1, 1);
    REFUSED(c.s, SPAR_ERR_STATE, "no step is in progress", spar_fluid_push_states(c.fluid, WIDTH, z));
    fill(z, 3);
    expect(&c, z);
    spar_session_destroy(&c.s);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(life), cmocka_unit_test(other_counts),
                                       cmocka_unit_test(trial_and_file), cmocka_unit_test(files),
                                       cmocka_unit_test(refusals)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
