/* Nodal values and loads between two divisions of one line into elements: what the theory of interpolation says. */
#include "check.h"

#include "math/basis.h"
#include "math/resample.h"
#include "math/rotation.h"

#include <stdlib.h>
#include <string.h>

enum { MOST = 7 * 24 };

static const spari_mesh meshes[] = {{1, 2}, {1, 8}, {2, 4}, {2, 6}, {3, 3}, {3, 6}, {4, 5}, {5, 9}, {7, 2}, {7, 24}};
enum { MESHES = sizeof meshes / sizeof *meshes };

/* eta of each node */
static int places(spari_mesh mesh, double *eta) {
    double x[SPARI_MAX_NODES];
    spari_gll(mesh.per_element, x, NULL, NULL);
    for (int i = 0; i < mesh.elements * mesh.per_element; i++) {
        int e = i / mesh.per_element;
        eta[i] = (e + 0.5 * (1 + x[i % mesh.per_element])) / mesh.elements;
    }
    return mesh.elements * mesh.per_element;
}

/* Legendre's polynomial on [0, 1], by its recurrence: at most 1 in size */
static double legendre(int degree, double eta) {
    double before = 1, now = 2 * eta - 1;
    for (int k = 1; k < degree; k++) {
        double next = ((2 * k + 1) * (2 * eta - 1) * now - k * before) / (k + 1);
        before = now;
        now = next;
    }
    return degree == 0 ? 1 : now;
}

static double noise(int i) {
    return fmod(7.3891 * i * i + 0.618034 * i, 2) - 1;
}

/* A polynomial that the elements of the one have is the same one at the nodes of the other. */
static void test_polynomials(void **state) {
    (void)state;
    double at[MOST], on[MOST], value[2 * MOST], out[2 * MOST];
    for (int k = 0; k < MESHES * MESHES; k++) {
        spari_mesh from = meshes[k / MESHES], to = meshes[k % MESHES];
        int P = from.per_element, n = places(from, at), m = places(to, on);
        for (int degree = 0; degree < P && degree < 12; degree++) {
            for (int i = 0; i < n; i++) {
                value[2 * i] = legendre(degree, at[i]);
                value[2 * i + 1] = 3 - value[2 * i];
            }
            spari_resample_values(from, to, 2, -1, value, out);
            for (int i = 0; i < m; i++) {
                NEAR(out[2 * i], legendre(degree, on[i]), 1e-13);
                NEAR(out[2 * i + 1], 3 - legendre(degree, on[i]), 3e-13);
            }
        }
    }
}

/* Loads do the work that they did on every polynomial that the new elements have: with the first two their sum and
   moment. Any loads, their sizes about 1. */
static void test_work_is_kept(void **state) {
    (void)state;
    double at[MOST], on[MOST], load[6 * MOST], out[6 * MOST];
    for (int k = 0; k < MESHES * MESHES; k++) {
        spari_mesh from = meshes[k / MESHES], to = meshes[k % MESHES];
        int n = places(from, at), m = places(to, on);
        for (int i = 0; i < 6 * n; i++) {
            load[i] = noise(i + k);
        }
        spari_resample_loads(from, to, load, out);
        for (int degree = 0; degree < to.per_element && degree < 12; degree++) {
            for (int c = 0; c < 6; c++) {
                double before = 0, after = 0, size = 1;
                for (int i = 0; i < n; i++) {
                    before += load[6 * i + c] * legendre(degree, at[i]);
                    size += fabs(load[6 * i + c]);
                }
                for (int i = 0; i < m; i++) {
                    after += out[6 * i + c] * legendre(degree, on[i]);
                }
                NEAR(after, before, 1e-13 * size);
            }
        }
    }
}

/* The loads' way is the transpose of the values' way back, whatever the values, also where they jump between elements.
 */
static void test_transpose(void **state) {
    (void)state;
    double at[MOST], load[6 * MOST], onto[6 * MOST], value[6 * MOST], back[6 * MOST];
    for (int k = 0; k < MESHES * MESHES; k++) {
        spari_mesh from = meshes[k / MESHES], to = meshes[k % MESHES];
        int n = 6 * places(from, at), m = 6 * places(to, at);
        double one = 0, other = 0, size = 1;
        for (int i = 0; i < n; i++) {
            load[i] = noise(i);
        }
        for (int i = 0; i < m; i++) {
            value[i] = noise(i + 17);
        }
        spari_resample_loads(from, to, load, onto);
        spari_resample_values(to, from, 6, -1, value, back);
        for (int i = 0; i < n; i++) {
            one += load[i] * back[i];
            size += fabs(load[i] * back[i]);
        }
        for (int i = 0; i < m; i++) {
            other += onto[i] * value[i];
        }
        NEAR(one, other, 1e-13 * size);
    }
}

/* Nodes that both have keep their values to the bit, jumps between elements among them: 3 elements are every second end
   of 6. */
static void test_common_ends(void **state) {
    (void)state;
    const spari_mesh few = {3, 5}, many = {6, 4};
    double value[MOST], out[MOST];
    for (int i = 0; i < few.elements * few.per_element; i++) {
        value[i] = noise(i);
    }
    spari_resample_values(few, many, 1, -1, value, out);
    for (int e = 0; e < few.elements; e++) {
        assert_true(out[2 * e * many.per_element] == value[e * few.per_element]);
        assert_true(out[(2 * e + 2) * many.per_element - 1] == value[(e + 1) * few.per_element - 1]);
    }
    /* within an element both sides of a joint that is new are one value */
    for (int e = 1; e < many.elements; e += 2) {
        assert_true(out[e * many.per_element] == out[e * many.per_element - 1]);
    }
}

/* Turns of a beam bent to an arc, about one axis by an angle that is linear: the signs of quaternions say nothing. */
static void test_turns(void **state) {
    (void)state;
    const spari_mesh from = {3, 6}, to = {5, 4};
    double at[MOST], on[MOST], q[4 * MOST], out[4 * MOST];
    int n = places(from, at), m = places(to, on);
    for (int i = 0; i < n; i++) {
        double half = 0.7 * at[i], sign = i % 3 == 1 ? -1 : 1;
        q[4 * i] = sign * cos(half), q[4 * i + 1] = 0;
        q[4 * i + 2] = sign * 0.6 * sin(half), q[4 * i + 3] = sign * 0.8 * sin(half);
    }
    spari_resample_values(from, to, 4, 0, q, out);
    for (int i = 0; i < m; i++) {
        const double is[4] = {cos(0.7 * on[i]), 0, 0.6 * sin(0.7 * on[i]), 0.8 * sin(0.7 * on[i])};
        NEAR(spari_quat_dot(out + 4 * i, out + 4 * i), 1, 1e-15);
        NEAR(fabs(spari_quat_dot(out + 4 * i, is)), 1, 1e-13); /* of interpolation: (0.7 / 6)^6 / 6! squared */
    }
}

/* Ends of elements that are ends after too, by whole numbers alone, also of a million elements. */
static void test_ends(void **state) {
    (void)state;
    const spari_mesh four = {4, 3}, three = {3, 3}, much = {999999, 3};
    assert_int_equal(spari_resample_end(2, 0, 0, four), 0);
    assert_int_equal(spari_resample_end(2, 0, 1, four), 5);
    assert_int_equal(spari_resample_end(2, 1, 0, four), 6);
    assert_int_equal(spari_resample_end(2, 1, 1, four), 11);
    assert_int_equal(spari_resample_end(2, 0, 1, three), -1);
    assert_int_equal(spari_resample_end(2, 1, 0, three), -1);
    assert_int_equal(spari_resample_end(2, 1, 1, three), 8);
    assert_int_equal(spari_resample_end(1000000, 999999, 1, much), 3 * 999999 - 1);
    assert_int_equal(spari_resample_end(1000000, 500000, 0, much), -1);
    double xi = 0;
    for (int e = 0; e < 1000000; e += 99991) {
        int at = spari_resample_place(1000000, e, 0.25, 999999, &xi);
        NEAR((at + 0.5 * (1 + xi)) / 999999, (e + 0.625) / 1000000, 1e-15);
        assert_true(xi >= -1 && xi <= 1);
    }
}

/* One node stays one node. */
static void test_one_node(void **state) {
    (void)state;
    const spari_mesh one = {1, 1};
    const double load[6] = {1, 2, 3, 4, 5, 6};
    double out[6] = {0};
    spari_resample_loads(one, one, load, out);
    assert_memory_equal(load, out, sizeof out);
    spari_resample_values(one, one, 6, -1, load, out);
    assert_memory_equal(load, out, sizeof out);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_polynomials), cmocka_unit_test(test_work_is_kept), cmocka_unit_test(test_transpose),
        cmocka_unit_test(test_common_ends), cmocka_unit_test(test_turns),        cmocka_unit_test(test_ends),
        cmocka_unit_test(test_one_node),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
