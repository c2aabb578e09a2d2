/* A member made anew with other nodes: what goes over keeps what theory says, and comes back to the bit. */
#include "scene.h"

#include "math/basis.h"
#include "math/resample.h"
#include "trial/rebuild.h"

#include <stdio.h>

enum { ELEMENTS = 2, NODES = 6 };

/* A straight beam bent by dead loads at its nodes, a follower at the tip and a line load. */
static spar_member *bent_beam(spar_session *s) {
    double K[36], M[36];
    const double follower[6] = {0, 0.3, 0.1, 0, 0, 0}, eta[2] = {0.1, 0.8},
                 line[12] = {0, 0, 0.5, 0.1, 0, 0, 0, 0, 0.2, 0, 0.3, 0};
    scene_diagonal(K, 1e5, 1e4, 1e4, 60, 80, 90);
    scene_diagonal(M, 1, 1, 1, 2e-3, 1e-3, 1e-3);
    spar_member *b = scene_beam(s, "b", ELEMENTS, NODES, 3, K, M);
    OK(s, spar_member_commit(b));
    for (int64_t i = 1; i < ELEMENTS * NODES; i++) {
        const double load[6] = {0.2 * sin((double)i), 0.3, 0.1 * (double)i, 0.01, 0.02, -0.03 * (double)i};
        OK(s, spar_member_set_load(b, i, SPAR_LOAD_DEAD, load));
    }
    OK(s, spar_member_set_load(b, ELEMENTS * NODES - 1, SPAR_LOAD_FOLLOWER, follower));
    OK(s, spar_beam_set_line_load(b, SPAR_LOAD_DEAD, 2, eta, line));
    OK(s, spar_member_solve_static(b, 4));
    return b;
}

/* Force and moment about the origin of the loads in the reference configuration. */
static void resultant(const spar_member *m, const double *load, double sum[6]) {
    memset(sum, 0, 6 * sizeof *sum);
    for (int64_t i = 0; i < m->nodes; i++) {
        double t[3];
        spari_cross(m->xr + 3 * i, load + 6 * i, t);
        for (int c = 0; c < 3; c++) {
            sum[c] += load[6 * i + c];
            sum[3 + c] += load[6 * i + 3 + c] + t[c];
        }
    }
}

/* Whether its elements have all polynomials of those there were. */
static int holds_all(const spar_member *m) {
    return m->mesh.elements % ELEMENTS == 0 && m->mesh.per_element >= NODES;
}

/* Dead, follower and line loads keep force and moment, whatever the nodes: the transpose of an interpolation that has
   all linear functions. The straight line is the same line in all. */
static void test_loads_keep_their_sums(void **state) {
    (void)state;
    const int nodes[] = {2, 4, 6, 9, 15, 12, 4, 6, 7}, elements[] = {2, 2, 2, 2, 2, 1, 3, 4, 5};
    for (size_t k = 0; k < sizeof nodes / sizeof *nodes; k++) {
        spar_session *s = scene_session();
        spar_member *b = bent_beam(s), old;
        double before[6], after[6], all[2][6], load[6 * 48];
        resultant(b, b->load.dead, before);
        OK(s, spar_member_get_loads(b, load));
        resultant(b, load, all[0]);
        spari_rebuild wish = spari_rebuild_of(b);
        wish.per_element = nodes[k];
        wish.elements = elements[k];
        OK(s, spari_member_rebuild(b, &wish, &old));
        resultant(b, b->load.dead, after);
        memcpy(b->after.q, b->now.q, (size_t)(7 * b->nodes) * sizeof(double));
        OK(s, spar_member_get_loads(b, load));
        resultant(b, load, all[1]);
        for (int c = 0; c < 6; c++) {
            NEAR(after[c], before[c], 1e-12);
            /* the follower stands at the tip, which all have; line loads are forces by the same points, and moments by
               the turns there, which fewer nodes know less well */
            NEAR(all[1][c], all[0][c], c < 3 ? 1e-11 : holds_all(b) ? 1e-10 : 0.05);
        }
        spari_member_restore(b, &old);
        spar_session_destroy(&s);
    }
}

/* Loads along the line, bent as it may be, are on other nodes what they are set there, to the bit; also where they come
   from a file. */
static void test_line_loads_as_set(void **state) {
    (void)state;
    static const int nodes[] = {3, 10, 5, 6}, elements[] = {1, 1, 4, 3};
    const double eta[4] = {0.1, 0.4, 0.4, 0.8},
                 line[24] = {0, 0, 0.5, 0.1, 0, 0, 0, 0, 0.2, 0, 0.3, 0, 1, 0, 0.5, 0.1, 0, 0, 0, 0.1, 0.2, 0, 0.3, 0};
    const char *file = "remade_line_loads.spar";
    for (size_t k = 0; k < sizeof nodes / sizeof *nodes; k++) {
        for (int saved = 0; saved < 2; saved++) {
            spar_session *s = scene_session(), *other = scene_session();
            spar_member *b = bent_beam(s), old;
            double load[2][6 * 24];
            OK(s, spar_beam_set_line_load(b, SPAR_LOAD_FOLLOWER, 4, eta, line));
            if (saved) {
                OK(s, spar_session_save(s, file));
                b = bent_beam(other);
                OK(other, spar_beam_set_line_load(b, SPAR_LOAD_DEAD, 0, NULL, NULL));
                OK(other, spar_session_load(other, file));
                assert_int_equal(remove(file), 0);
            }
            spari_rebuild wish = spari_rebuild_of(b);
            wish.per_element = nodes[k], wish.elements = elements[k];
            OK(b->session, spari_member_rebuild(b, &wish, &old));
            memcpy(b->after.q, b->now.q, (size_t)(7 * b->nodes) * sizeof(double));
            OK(b->session, spar_member_get_loads(b, load[0]));
            const double eta_of_bent[2] = {0.1, 0.8}, line_of_bent[12] = {0, 0, 0.5, 0.1, 0, 0, 0, 0, 0.2, 0, 0.3, 0};
            OK(b->session, spar_beam_set_line_load(b, SPAR_LOAD_DEAD, 2, eta_of_bent, line_of_bent));
            OK(b->session, spar_beam_set_line_load(b, SPAR_LOAD_FOLLOWER, 4, eta, line));
            OK(b->session, spar_member_get_loads(b, load[1]));
            assert_memory_equal(load[0], load[1], (size_t)(6 * b->nodes) * sizeof(double));
            spari_member_restore(b, &old);
            spar_session_destroy(&s);
            spar_session_destroy(&other);
        }
    }
}

/* A cantilever of length L under a load p along it has the section forces p (L - x) and p (L - x)^2 / 2 with any nodes
   that can have them: the load is no heap of points that fewer nodes had. */
static void test_sections_under_a_line_load(void **state) {
    (void)state;
    enum { PLACES = 9 };
    static const int from[][2] = {{1, 3}, {1, 10}, {8, 3}}, to[][2] = {{1, 10}, {4, 5}, {1, 10}};
    const double L = 3, p = 1e-3, ends[2] = {0, 1}, line[12] = {[2] = p, [8] = p};
    double K[36], M[36], eta[PLACES], force[PLACES][6];
    scene_diagonal(K, 1e6, 1e6, 1e6, 60, 80, 80);
    scene_diagonal(M, 1, 1, 1, 2e-3, 1e-3, 1e-3);
    for (int i = 0; i < PLACES; i++) {
        eta[i] = i / (PLACES - 1.0);
    }
    for (size_t k = 0; k < sizeof from / sizeof *from; k++) {
        spar_session *s = scene_session();
        spar_member *b = scene_beam(s, "b", from[k][0], from[k][1], L, K, M), old;
        OK(s, spar_member_commit(b));
        OK(s, spar_beam_set_line_load(b, SPAR_LOAD_DEAD, 2, ends, line));
        spari_rebuild wish = spari_rebuild_of(b);
        wish.elements = to[k][0], wish.per_element = to[k][1];
        OK(s, spari_member_rebuild(b, &wish, &old));
        OK(s, spar_member_solve_static(b, 1));
        OK(s, spar_beam_evaluate(b, PLACES, eta, NULL, force[0], NULL, NULL));
        for (int i = 0; i < PLACES; i++) {
            double rest = L * (1 - eta[i]);
            NEAR(fabs(force[i][2]), p * rest,
                 1e-6 * p * L); /* what the turns of 1e-4 make of them is of second order */
            NEAR(fabs(force[i][4]), 0.5 * p * rest * rest, 1e-6 * p * L * L);
        }
        spari_member_restore(b, &old);
        spar_session_destroy(&s);
    }
}

/* With as many nodes or more the displacement is the same polynomial: seen at the old nodes it is what it was. */
static void test_state_goes_over(void **state) {
    (void)state;
    spar_session *s = scene_session();
    spar_member *b = bent_beam(s), old;
    double x[NODES], phi[24];
    spari_gll(NODES, x, NULL, NULL);
    spari_rebuild wish = spari_rebuild_of(b);
    wish.per_element = 9;
    OK(s, spari_member_rebuild(b, &wish, &old));
    for (int e = 0; e < ELEMENTS; e++) {
        for (int l = 0; l < NODES; l++) {
            spari_resample_basis(9, x[l], phi);
            for (int c = 0; c < 3; c++) {
                double u = 0;
                for (int k = 0; k < 9; k++) {
                    u += phi[k] * b->now.q[7 * (9 * e + k) + c];
                }
                NEAR(u, old.now.q[7 * (NODES * e + l) + c], 1e-12);
            }
        }
    }
    for (int64_t i = 0; i < b->nodes; i++) {
        NEAR(spari_quat_dot(b->now.q + 7 * i + 3, b->now.q + 7 * i + 3), 1, 1e-14);
    }
    spari_member_restore(b, &old);
    spar_session_destroy(&s);
}

/* What has been made anew is gone, what was is there: the struct byte by byte, and the member goes on. Wishes that are
   refused leave no less. */
static void test_comes_back(void **state) {
    (void)state;
    spar_session *s = scene_session();
    spar_member *b = bent_beam(s), old, before = *b;
    const spari_rebuild wishes[] = {
        {.per_element = 9, .fidelity = SPAR_FIDELITY_EXACT},
        {.per_element = 4, .fidelity = SPAR_FIDELITY_MODAL, .modes = 5},
        {.per_element = NODES, .fidelity = SPAR_FIDELITY_RIGID},
        {.per_element = NODES, .fidelity = SPAR_FIDELITY_PRESCRIBED},
        {.per_element = NODES, .fidelity = SPAR_FIDELITY_LINEAR, .left_out = SPAR_EFFECT_INERTIA},
        {.per_element = NODES, .fidelity = SPAR_FIDELITY_MODAL, .modes = 5000}, /* refused */
        {.per_element = NODES, .fidelity = SPAR_FIDELITY_EXACT, .points = 1},   /* refused: too coarse */
    };
    for (size_t k = 0; k < sizeof wishes / sizeof *wishes; k++) {
        int status = spari_member_rebuild(b, &wishes[k], &old);
        assert_int_equal(status == SPAR_OK, k < 5);
        spari_member_restore(b, &old);
        assert_memory_equal(b, &before, sizeof before);
    }
    scene_run(s, 0.01, 3);
    spar_session_destroy(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_loads_keep_their_sums),
        cmocka_unit_test(test_line_loads_as_set),
        cmocka_unit_test(test_sections_under_a_line_load),
        cmocka_unit_test(test_state_goes_over),
        cmocka_unit_test(test_comes_back),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
