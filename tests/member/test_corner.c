/* A line with corners is what its points say. Oracles: closed forms of frames, straight beams on welds, circles. */
#include "scene.h"

#include <math.h>
#include <stdio.h>

static const double EA = 7.9e6, GA = 1.65e6, GJ = 249.684, EI = 324.589;

static spar_member *bent(spar_session *s, int elements, int nodes, int64_t n, const double *xyz) {
    double K[36], M[36], eta[32];
    spar_member *b = NULL;
    char name[32];
    static int number;
    (void)snprintf(name, sizeof name, "frame %d", number++);
    scene_diagonal(K, EA, GA, GA, GJ, EI, EI);
    scene_diagonal(M, 0.3, 0.3, 0.3, 2e-5, 1e-5, 1e-5);
    for (int64_t i = 0; i < n; i++) {
        eta[i] = (double)i / (double)(n - 1);
    }
    OK(s, spar_beam_create(s, name, elements, nodes, &b));
    OK(s, spar_beam_set_axis(b, n, eta, xyz, NULL));
    OK(s, spar_beam_set_sections(b, 1, eta, K, M));
    OK(s, spar_member_set_root(b, SPAR_ROOT_FIXED));
    return b;
}

/* Displacement of the tip under a small force there. */
static void pushed(int fidelity, int elements, int nodes, int64_t n, const double *xyz, const double force[3],
                   double u[3]) {
    spar_session *s = scene_session();
    spar_member *b = bent(s, elements, nodes, n, xyz);
    double q[7], f[6] = {force[0], force[1], force[2]};
    int64_t count;
    OK(s, spar_member_set_fidelity(b, fidelity, fidelity == SPAR_FIDELITY_MODAL ? 12 : 0));
    OK(s, spar_member_commit(b));
    OK(s, spar_member_get_count(b, &count));
    OK(s, spar_member_set_load(b, count - 1, SPAR_LOAD_DEAD, f));
    OK(s, spar_member_solve_static(b, 1));
    scene_tip(b, q);
    memcpy(u, q, 3 * sizeof *u);
    spar_session_destroy(&s);
}

/* L: 1 m up, 1 m out, loads of 1e-3 N. Across its plane both legs bend and the first twists; down in its plane the
   first leg's bending lowers the second. Timoshenko beams, which elements of 4 and more nodes have exactly. Tolerance:
   the square of the deflection, 4e-11 m at 6e-6 m. With two elements, with four, and along a line whose legs have more
   points. */
static void an_l_bends_as_two_beams(void **state) {
    (void)state;
    const double xyz[9] = {0, 0, 0, 0, 0, 1, 1, 0, 1}, more[15] = {0, 0, 0, 0, 0, 0.5, 0, 0, 1, 0.5, 0, 1, 1, 0, 1},
                 across[3] = {0, 1e-3, 0}, down[3] = {0, 0, -1e-3};
    const int kinds[3] = {SPAR_FIDELITY_EXACT, SPAR_FIDELITY_LINEAR, SPAR_FIDELITY_MODAL};
    double u[3];
    for (int k = 0; k < 3; k++) {
        for (int nodes = 4; nodes <= 10; nodes += 3) {
            for (int elements = 2; elements <= 4; elements += 2) {
                const int modal = kinds[k] == SPAR_FIDELITY_MODAL;
                for (int points = 3; points <= 5; points += 2) {
                    const double *line = points == 3 ? xyz : more;
                    pushed(kinds[k], elements, nodes, points, line, across, u);
                    NEAR(u[1], 1e-3 * (2 / (3 * EI) + 1 / GJ + 2 / GA), modal ? 6e-8 : 4e-11);
                    pushed(kinds[k], elements, nodes, points, line, down, u);
                    NEAR(u[2], -1e-3 * (1 / (3 * EI) + 1 / EI + 1 / EA + 1 / GA), modal ? 6e-8 : 4e-11);
                }
            }
        }
    }
}

/* Frames of three legs of 1 m, up, out, up (Z) or down (U), 1e-3 N across at the tip. Energy of a unit force along y,
   by Castigliano: with r from a point to the tip, the moment is r x e_y; its part along the leg twists, the rest bends.
   Z: legs bend by (2 - z), (1 - x), (2 - z) and twist by 1, 1, 0. U: by -z, (1 - x), -z and the same twists. Corners
   that follow each other turn alike (U) or against each other (Z). */
static void three_legs_bend_as_three_beams(void **state) {
    (void)state;
    const double xyz[2][12] = {{0, 0, 0, 0, 0, 1, 1, 0, 1, 1, 0, 2}, {0, 0, 0, 0, 0, 1, 1, 0, 1, 1, 0, 0}},
                 across[3] = {0, 1e-3, 0}, bending[2] = {7.0 / 3 + 1.0 / 3 + 1.0 / 3, 1};
    double u[3];
    for (int k = 0; k < 2; k++) {
        const double c = bending[k] / EI + 2 / GJ + 3 / GA;
        pushed(SPAR_FIDELITY_EXACT, 3, 5, 4, xyz[k], across, u);
        NEAR(u[1], 1e-3 * c, 3e-10);
        pushed(SPAR_FIDELITY_LINEAR, 6, 5, 4, xyz[k], across, u);
        NEAR(u[1], 1e-3 * c, 3e-10);
    }
}

/* The first ten frequencies of the L against two straight beams on a weld. Elements of 10 nodes: rounding, 1e-9. */
static void modes_are_those_of_welded_beams(void **state) {
    (void)state;
    const double xyz[9] = {0, 0, 0, 0, 0, 1, 1, 0, 1}, up[6] = {0, 0, 0, 0, 0, 1}, out[6] = {0, 0, 1, 1, 0, 1};
    const int kinds[2] = {SPAR_FIDELITY_EXACT, SPAR_FIDELITY_LINEAR};
    double welded[10], got[10];
    spar_session *s = scene_session();
    spar_member *a = bent(s, 1, 10, 2, up), *b = bent(s, 1, 10, 2, out);
    OK(s, spar_member_set_root(b, SPAR_ROOT_FREE));
    OK(s, spar_member_commit(a));
    OK(s, spar_member_commit(b));
    (void)scene_joint(s, "weld", a, 9, b, 0, 0);
    OK(s, spar_member_solve_modes(a, 10, welded, NULL));
    spar_session_destroy(&s);
    for (int k = 0; k < 2; k++) {
        s = scene_session();
        a = bent(s, 2, 10, 3, xyz);
        OK(s, spar_member_set_fidelity(a, kinds[k], 0));
        OK(s, spar_member_commit(a));
        OK(s, spar_member_solve_modes(a, 10, got, NULL));
        for (int i = 0; i < 10; i++) {
            NEAR(got[i], welded[i], 1e-9 * welded[i]);
        }
        spar_session_destroy(&s);
    }
}

/* What a fluid's node in the wedge outside the corner touches is the corner: it moves as a point of the shared node.
   Large displacement; rounding. The work of forces there is that of their resultant. */
static void a_node_at_the_corner_moves_with_it(void **state) {
    (void)state;
    const double xyz[9] = {0, 0, 0, 0, 0, 1, 1, 0, 1}, place[6] = {-0.04, 0.03, 1.02, -0.01, -0.02, 1.05},
                 load[6] = {30, 80, -60};
    double q[12 * 7], reference[36], x[6], resultant[6], force[6] = {1, 2, 3, -2, 0.5, 4};
    spar_session *s = scene_session();
    spar_member *b = bent(s, 2, 6, 3, xyz);
    spar_fluid *water = NULL;
    OK(s, spar_member_commit(b));
    OK(s, spar_fluid_create(b, "water", &water));
    OK(s, spar_fluid_set_motion_nodes(water, 2, place));
    OK(s, spar_fluid_set_force_nodes(water, 2, place));
    OK(s, spar_fluid_map(water));
    OK(s, spar_member_set_load(b, 11, SPAR_LOAD_DEAD, load));
    OK(s, spar_member_solve_static(b, 4));
    OK(s, spar_member_get_motion(b, q, NULL, NULL));
    OK(s, spar_member_get_reference(b, reference, NULL));
    assert_true(fabs(q[7 * 5 + 1]) > 0.01);
    OK(s, spar_fluid_pull_motion(water, 1, x, NULL));
    for (int i = 0; i < 2; i++) {
        double arm[3], turned[3];
        for (int c = 0; c < 3; c++) {
            arm[c] = place[3 * i + c] - reference[15 + c];
        }
        spari_rotate(q + 7 * 5 + 3, arm, turned);
        for (int c = 0; c < 3; c++) {
            NEAR(x[3 * i + c], reference[15 + c] + q[7 * 5 + c] + turned[c], 1e-13);
        }
    }
    OK(s, spar_step_begin(s, 0.01));
    OK(s, spar_step_solve(s));
    OK(s, spar_fluid_push_forces(water, force, NULL));
    int done;
    OK(s, spar_step_check(s, &done));
    double at_nodes[12 * 6];
    OK(s, spar_member_get_loads(b, at_nodes));
    memset(resultant, 0, sizeof resultant);
    for (int i = 0; i < 12; i++) {
        for (int c = 0; c < 3; c++) {
            resultant[c] += at_nodes[6 * i + c] - (i == 11 ? load[c] : 0);
        }
    }
    for (int c = 0; c < 3; c++) {
        NEAR(resultant[c], force[c] + force[3 + c], 1e-10);
    }
    spar_session_destroy(&s);
}

/* Section axes on both sides of a corner: x along the leg, and the smallest rotation between them where the line comes
   near the vertical; level elsewhere. */
static void axes_turn_with_the_corner(void **state) {
    (void)state;
    const double up[9] = {0, 0, 0, 0, 0, 1, 0, 1, 1}, flat[9] = {0, 0, 0, 1, 0, 0, 1, 1, 0};
    /* up: y = global y turns with the line, to -z; flat: y = z x tangent */
    const double expected[2][2][9] = {{{0, 0, 1, 0, 1, 0, -1, 0, 0}, {0, 1, 0, 0, 0, -1, -1, 0, 0}},
                                      {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 1, 0, -1, 0, 0, 0, 0, 1}}};
    for (int k = 0; k < 2; k++) {
        spar_session *s = scene_session();
        spar_member *b = bent(s, 2, 4, 3, k ? flat : up);
        double q[8 * 4], x[24];
        OK(s, spar_member_commit(b));
        OK(s, spar_member_get_reference(b, x, q));
        for (int i = 0; i < 8; i++) {
            for (int axis = 0; axis < 3; axis++) {
                double e[3] = {axis == 0, axis == 1, axis == 2}, got[3];
                spari_rotate(q + 4 * i, e, got);
                for (int c = 0; c < 3; c++) {
                    NEAR(got[c], expected[k][i / 4][3 * axis + c], 1e-14);
                }
            }
        }
        spar_session_destroy(&s);
    }
}

/* Points of a half circle are no corners, on element boundaries neither: turns of 15 degrees that are alike. The nodes
   lie within the height of the circle over its chords, 1 - cos(7.5 degrees). Section axes of both sides of a boundary
   differ by the fit's error in the slope, a tenth of the turn; a corner has half of it, 0.13, in the quaternion. */
static void a_circle_has_no_corner(void **state) {
    (void)state;
    double xyz[39], x[72], q[96];
    for (int i = 0; i < 13; i++) {
        const double angle = i * M_PI / 12;
        xyz[3 * i] = cos(angle), xyz[3 * i + 1] = sin(angle), xyz[3 * i + 2] = 0;
    }
    spar_session *s = scene_session();
    spar_member *b = bent(s, 4, 6, 13, xyz);
    OK(s, spar_member_commit(b));
    OK(s, spar_member_get_reference(b, x, q));
    for (int i = 0; i < 24; i++) {
        NEAR(hypot(x[3 * i], x[3 * i + 1]), 1, 8.6e-3);
    }
    for (int i = 6; i < 24; i += 6) {
        const double *here = q + 4 * i, *before = here - 4;
        const double c = here[0] * before[0] + here[1] * before[1] + here[2] * before[2] + here[3] * before[3];
        NEAR(fabs(c), 1, 0.5 * 0.013 * 0.013);
    }
    spar_session_destroy(&s);
}

/* A corner inside an element, a line that goes back: refused with the cure. A curve through three points: told. */
static void what_no_curve_shows_is_refused(void **state) {
    (void)state;
    const double ell[9] = {0, 0, 0, 0, 0, 1, 1, 0, 1}, back[9] = {0, 0, 0, 1, 0, 0, 0, 1e-4, 0},
                 bow[9] = {0, 0, 0, 1, 0, 0, 2, 0.6, 0};
    spar_session *s = scene_session();
    spar_member *b = bent(s, 1, 8, 3, ell);
    REFUSED(s, SPAR_ERR_ARGUMENT,
            "corner of 90 degrees at axis point 1 (eta 0.5), inside element 1 of 1; let an element end there",
            spar_member_commit(b));
    b = bent(s, 2, 8, 3, back);
    REFUSED(s, SPAR_ERR_ARGUMENT, "reverses at axis point 1", spar_member_commit(b));
    assert_string_equal(spar_session_get_warning(s, 0), "");
    b = bent(s, 1, 8, 3, bow);
    OK(s, spar_member_commit(b));
    assert_non_null(
        strstr(spar_session_get_warning(s, 0), "curve is fitted through its 3 axis points, whose nodes lie"));
    spar_session_destroy(&s);
}

/* Corners that leave no element between them: beside an end, and two on one element boundary. None writes beyond the
   nodes (the last node of the beam is where the axis ends, and a session that follows is whole). */
static void every_piece_has_an_element(void **state) {
    (void)state;
    static const double eta[2][4] = {{0, 1e-12, 0.5, 1}, {0, 0.5, 0.5 + 4e-10, 1}},
                        xyz[2][12] = {{0, 0, 0, 1e-11, 1e-12, 0, 5, 3, 0, 10, 6, 0},
                                      {0, 0, 0, 5, 0, 0, 5, 4e-9, 0, 5, 5, 0}};
    for (int k = 0; k < 2; k++) {
        double K[36], x[3 * 10], q[4 * 10];
        spar_session *s = scene_session();
        spar_member *b = NULL;
        scene_diagonal(K, 1e6, 1e6, 1e6, 1e3, 1e3, 1e3);
        OK(s, spar_beam_create(s, "b", 2, 5, &b));
        OK(s, spar_beam_set_axis(b, 4, eta[k], xyz[k], NULL));
        OK(s, spar_beam_set_sections(b, 1, eta[k], K, NULL));
        OK(s, spar_member_commit(b));
        OK(s, spar_member_get_reference(b, x, q));
        for (int c = 0; c < 3; c++) {
            NEAR(x[c], 0, 1e-9);
            NEAR(x[27 + c], xyz[k][9 + c], 1e-9);
        }
        spar_session_destroy(&s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_l_bends_as_two_beams),         cmocka_unit_test(three_legs_bend_as_three_beams),
        cmocka_unit_test(modes_are_those_of_welded_beams), cmocka_unit_test(a_node_at_the_corner_moves_with_it),
        cmocka_unit_test(axes_turn_with_the_corner),       cmocka_unit_test(a_circle_has_no_corner),
        cmocka_unit_test(every_piece_has_an_element),      cmocka_unit_test(what_no_curve_shows_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
