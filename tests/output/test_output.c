/* VTK files, read back by a small XML reader of this file's own: well formed, and every number the one that was asked
   for. Numbers are stored as bits, so the tolerance is 0 wherever the library computes nothing. */
#include "scene.h"

#include <spar/spar_output.h>
#include <stdio.h>
#include <unistd.h>

/* ---- reading ---- */

typedef struct array {
    char name[64], type[16], parent[32];
    int components;
    int64_t bytes;
    unsigned char *data;
} array;

typedef struct document {
    char root[32], *text;
    int arrays, elements;
    array array[64];
    char *datasets; /* attributes of all DataSet elements, one per line */
} document;

static char *slurp(const char *path) {
    FILE *file = fopen(path, "rb");
    if (!file) {
        return NULL;
    }
    fseek(file, 0, SEEK_END);
    long size = ftell(file);
    rewind(file);
    char *text = calloc((size_t)size + 1, 1);
    assert_int_equal(fread(text, 1, (size_t)size, file), size);
    fclose(file);
    return text;
}

static int digit_of(char c) {
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const char *at = c ? strchr(digits, c) : NULL;
    return at ? (int)(at - digits) : -1;
}

/* Base64 text of n characters: a 64-bit size, then as many bytes. */
static void decode(const char *text, size_t n, array *a) {
    assert_int_equal(n % 4, 0);
    unsigned char *out = malloc(n / 4 * 3);
    size_t size = 0;
    for (size_t i = 0; i < n; i += 4) {
        int pad = (text[i + 2] == '=') + (text[i + 3] == '=');
        unsigned bits = 0;
        for (size_t k = 0; k < 4; k++) {
            int d = text[i + k] == '=' ? 0 : digit_of(text[i + k]);
            assert_true(d >= 0);
            assert_true(text[i + k] != '=' || i + 4 == n);
            bits = bits << 6 | (unsigned)d;
        }
        for (int k = 0; k < 3 - pad; k++) {
            out[size++] = (unsigned char)(bits >> (16 - 8 * k) & 255);
        }
    }
    uint64_t told;
    assert_true(size >= sizeof told);
    memcpy(&told, out, sizeof told);
    assert_int_equal(told, size - sizeof told);
    a->bytes = (int64_t)told;
    a->data = malloc(told + 1);
    memcpy(a->data, out + sizeof told, told);
    free(out);
}

/* The value of an attribute of the tag that `at` begins, or "". */
static void attribute(const char *at, const char *end, const char *name, char *value, size_t room) {
    char key[80];
    value[0] = '\0';
    snprintf(key, sizeof key, " %s=\"", name);
    const char *found = strstr(at, key);
    if (found && found < end) {
        found += strlen(key);
        snprintf(value, room, "%.*s", (int)strcspn(found, "\""), found);
    }
}

/* The end of the tag; quotes must close within it. */
static const char *tag_end(const char *at) {
    int quoted = 0;
    for (at++; *at && (quoted || *at != '>'); at++) {
        quoted ^= *at == '"';
        assert_true(*at != '<');
    }
    assert_true(*at == '>');
    return at;
}

static void take_element(document *d, const char *at, const char *end, const char *name, const char *parent) {
    char text[64];
    if (strcmp(name, "DataArray") == 0) {
        array *a = &d->array[d->arrays++];
        attribute(at, end, "format", text, sizeof text);
        assert_string_equal(text, "binary");
        attribute(at, end, "Name", a->name, sizeof a->name);
        attribute(at, end, "type", a->type, sizeof a->type);
        attribute(at, end, "NumberOfComponents", text, sizeof text);
        a->components = atoi(text);
        snprintf(a->parent, sizeof a->parent, "%s", parent);
        decode(end + 1, strcspn(end + 1, "<\n"), a);
    } else if (strcmp(name, "DataSet") == 0) {
        size_t old = strlen(d->datasets), more = (size_t)(end - at);
        d->datasets = realloc(d->datasets, old + more + 2);
        memcpy(d->datasets + old, at, more);
        strcpy(d->datasets + old + more, "\n");
    }
}

/* Reads a whole file; every tag must be closed in turn. */
static document *read_document(const char *path) {
    document *d = calloc(1, sizeof *d);
    char stack[16][32];
    int depth = 0;
    d->text = slurp(path);
    d->datasets = calloc(1, 1);
    assert_non_null(d->text);
    assert_memory_equal(d->text, "<?xml version=\"1.0\"?>\n", 22);
    for (const char *at = strchr(d->text + 1, '<'); at;) {
        const char *end = tag_end(at);
        if (at[1] == '/') {
            size_t size = (size_t)(end - at) - 2;
            assert_true(depth > 0);
            depth--;
            assert_true(strlen(stack[depth]) == size && strncmp(stack[depth], at + 2, size) == 0);
        } else {
            char name[32];
            snprintf(name, sizeof name, "%.*s", (int)strcspn(at + 1, " />\n"), at + 1);
            assert_true(depth > 0 || d->elements == 0); /* one root */
            take_element(d, at, end, name, depth > 0 ? stack[depth - 1] : "");
            if (d->elements++ == 0) {
                attribute(at, end, "type", d->root, sizeof d->root);
            }
            if (end[-1] != '/') {
                assert_true(depth < 16);
                strcpy(stack[depth++], name);
            }
        }
        at = strchr(end, '<');
    }
    assert_int_equal(depth, 0);
    return d;
}

static void free_document(document *d) {
    for (int i = 0; i < d->arrays; i++) {
        free(d->array[i].data);
    }
    free(d->text);
    free(d->datasets);
    free(d);
}

static const array *get(const document *d, const char *parent, const char *name) {
    for (int i = 0; i < d->arrays; i++) {
        if (strcmp(d->array[i].name, name) == 0 && strcmp(d->array[i].parent, parent) == 0) {
            return &d->array[i];
        }
    }
    fail_msg("there is no array '%s' in '%s'", name, parent);
    return NULL;
}

static const double *numbers(const document *d, const char *parent, const char *name, int components, int64_t tuples) {
    const array *a = get(d, parent, name);
    assert_string_equal(a->type, "Float64");
    assert_int_equal(a->components, components);
    assert_int_equal(a->bytes, tuples * components * 8);
    return (const double *)(const void *)a->data;
}

static const int64_t *integers(const document *d, const char *parent, const char *name, int64_t n) {
    const array *a = get(d, parent, name);
    assert_string_equal(a->type, "Int64");
    assert_int_equal(a->bytes, n * 8);
    return (const int64_t *)(const void *)a->data;
}

/* ---- members ---- */

enum { ELEMENTS = 2, P = 4, NODES = ELEMENTS * P, SAMPLES = ELEMENTS * ((P - 1) * 4 + 1) };

typedef struct moved {
    spar_session *session;
    spar_member *beam;
    double q[7 * NODES], v[6 * NODES], a[6 * NODES], load[6 * NODES], x[3 * NODES], frame[4 * NODES];
} moved;

/* A straight twisted beam of two elements whose host moves it: u = xi^2 along y and z, turned about x; the joint's
   copies move alike. */
static void move(moved *m) {
    const double eta[2] = {0, 1}, xyz[6] = {0, 0, 0, 5, 0, 0}, twist[2] = {0.1, 0.7};
    const double place[3] = {1, -2, 3}, turned[4] = {0.5, 0.5, -0.5, 0.5};
    m->session = scene_session();
    OK(m->session, spar_beam_create(m->session, "beam", ELEMENTS, P, &m->beam));
    OK(m->session, spar_beam_set_axis(m->beam, 2, eta, xyz, twist));
    OK(m->session, spar_member_set_external(m->beam, 1));
    OK(m->session, spar_member_set_placement(m->beam, place, turned));
    OK(m->session, spar_member_set_effects(m->beam, SPAR_EFFECT_FLUID_HISTORY, 0));
    OK(m->session, spar_member_commit(m->beam));
    OK(m->session, spar_member_get_reference(m->beam, m->x, m->frame));
    for (int i = 0; i < NODES; i++) {
        double s = (i < P ? i : i - 1) / 6.0, half = 0.4 * s;
        const double q[7] = {0.01 * s, s * s, 0.3 * s * s, cos(half), sin(half), 0, 0};
        memcpy(m->q + 7 * i, q, sizeof q);
        for (int k = 0; k < 6; k++) {
            m->v[6 * i + k] = s * (k + 1);
            m->a[6 * i + k] = -s * (k + 1.5);
            m->load[6 * i + k] = i + 0.1 * k;
        }
        OK(m->session, spar_member_set_load(m->beam, i, SPAR_LOAD_DEAD, m->load + 6 * i));
    }
    OK(m->session, spar_member_set_motion(m->beam, m->q, m->v, m->a));
}

/* Every node stands in the file bit for bit, in the order of its number, at the samples 0, 4, 8, ... of its element. */
static void check_nodes(const document *d, const moved *m) {
    const double *x = numbers(d, "Points", "Points", 3, SAMPLES), *node = numbers(d, "PointData", "node", 1, SAMPLES);
    const double *u = numbers(d, "PointData", "displacement", 3, SAMPLES);
    const double *force = numbers(d, "PointData", "nodal_force", 3, SAMPLES);
    const double *moment = numbers(d, "PointData", "nodal_moment", 3, SAMPLES);
    const double *v = numbers(d, "PointData", "velocity", 3, SAMPLES);
    const double *w = numbers(d, "PointData", "angular_velocity", 3, SAMPLES);
    const double *a = numbers(d, "PointData", "acceleration", 3, SAMPLES);
    const double *alpha = numbers(d, "PointData", "angular_acceleration", 3, SAMPLES);
    int nodes = 0;
    for (int i = 0; i < SAMPLES; i++) {
        if (node[i] < 0) {
            assert_true(node[i] == -1 && force[3 * i] == 0 && moment[3 * i + 2] == 0);
            continue;
        }
        int n = nodes++;
        assert_true(node[i] == n);
        for (int k = 0; k < 3; k++) {
            assert_true(u[3 * i + k] == m->q[7 * n + k]);
            assert_true(x[3 * i + k] == m->x[3 * n + k] + m->q[7 * n + k]);
            assert_true(force[3 * i + k] == m->load[6 * n + k] && moment[3 * i + k] == m->load[6 * n + 3 + k]);
            assert_true(v[3 * i + k] == m->v[6 * n + k] && w[3 * i + k] == m->v[6 * n + 3 + k]);
            assert_true(a[3 * i + k] == m->a[6 * n + k] && alpha[3 * i + k] == m->a[6 * n + 3 + k]);
        }
    }
    assert_int_equal(nodes, NODES);
}

/* The axes of a section are orthonormal everywhere; at a node they are R(q) R(q_ref). Tolerance: products of unit
   quaternions, some 1e-16 each. */
static void check_axes(const document *d, const moved *m) {
    static const char *const name[] = {"section_x", "section_y", "section_z"};
    const double *axis[3], *node = numbers(d, "PointData", "node", 1, SAMPLES);
    for (int k = 0; k < 3; k++) {
        axis[k] = numbers(d, "PointData", name[k], 3, SAMPLES);
    }
    for (int i = 0; i < SAMPLES; i++) {
        for (int j = 0; j < 9; j++) {
            NEAR(spari_dot(axis[j / 3] + 3 * i, axis[j % 3] + 3 * i), j % 4 == 0 ? 1 : 0, 1e-14);
        }
        for (int k = 0; k < 3 && node[i] >= 0; k++) {
            double e[3] = {k == 0, k == 1, k == 2};
            spari_rotate(m->frame + 4 * (int)node[i], e, e);
            spari_rotate(m->q + 7 * (int)node[i] + 3, e, e);
            for (int c = 0; c < 3; c++) {
                NEAR(axis[k][3 * i + c], e[c], 1e-15 * 4);
            }
        }
    }
}

/* Deflection is what is left when the root's place and turn are taken off; rotation is the vector of q, here 0.8 s
   about x. Tolerances: lengths of 10 m and products of unit quaternions, 1e-16 each. */
static void check_bending(const document *d, const moved *m) {
    const double *node = numbers(d, "PointData", "node", 1, SAMPLES);
    const double *bent = numbers(d, "PointData", "deflection", 3, SAMPLES);
    const double *turn = numbers(d, "PointData", "rotation", 3, SAMPLES);
    for (int i = 0; i < SAMPLES; i++) {
        if (node[i] < 0) {
            continue;
        }
        int n = (int)node[i];
        double arm[3], carried[3];
        for (int k = 0; k < 3; k++) {
            arm[k] = m->x[3 * n + k] - m->x[k];
        }
        spari_rotate(m->q + 3, arm, carried);
        for (int k = 0; k < 3; k++) {
            NEAR(bent[3 * i + k], arm[k] + m->q[7 * n + k] - m->q[k] - carried[k], 1e-14);
        }
        NEAR(turn[3 * i], 2 * atan2(m->q[7 * n + 4], m->q[7 * n + 3]), 1e-15);
        assert_true(turn[3 * i + 1] == 0 && turn[3 * i + 2] == 0);
    }
}

/* A cantilever on a root that the host has turned by a right angle, bent by a tip load P along global z: section
   moments P (L - s) about an axis across, at any sample, and no deflection of what only turns. Linear in P at this
   size: to 1e-6. */
static void test_bent_on_a_turned_root(void **state) {
    (void)state;
    enum { N = 6, POINTS = (N - 1) * 4 + 1 };
    const double eta[2] = {0, 1}, xyz[6] = {0, 0, 0, 2, 0, 0}, tip[6] = {0, 0, 1e-3};
    double K[36] = {0}, M[36] = {0};
    for (int i = 0; i < 6; i++) {
        K[7 * i] = i < 3 ? 1e7 : 1e3;
        M[7 * i] = 1;
    }
    spar_session *s = scene_session();
    spar_member *b = NULL;
    OK(s, spar_beam_create(s, "beam", 1, N, &b));
    OK(s, spar_beam_set_axis(b, 2, eta, xyz, NULL));
    OK(s, spar_beam_set_sections(b, 1, eta, K, M));
    OK(s, spar_member_set_root(b, SPAR_ROOT_DRIVEN));
    OK(s, spar_member_commit(b));
    OK(s, spar_session_set_integrator(s, 0, 1));
    for (int i = 1; i <= 20; i++) { /* in small steps, so slow that nothing swings */
        double half = atan(1) * i / 20;
        const double at[7] = {0.25 * i, 0.3 * i, 0.35 * i, cos(half), 0, 0, sin(half)};
        OK(s, spar_member_drive(b, at, NULL, NULL));
        OK(s, spar_step(s, 10, NULL, NULL, NULL));
    }
    OK(s, spar_member_set_load(b, N - 1, SPAR_LOAD_DEAD, tip));
    OK(s, spar_member_solve_static(b, 1));
    OK(s, spar_member_write_vtk(b, "output_bent.vtp"));
    document *d = read_document("output_bent.vtp");
    const double *bent = numbers(d, "PointData", "deflection", 3, POINTS);
    const double *moment = numbers(d, "PointData", "section_moment", 3, POINTS);
    const double *x = numbers(d, "Points", "Points", 3, POINTS);
    NEAR(bent[3 * POINTS - 1], 1e-3 * 8 / 3e3 + 1e-3 * 2 / 1e7, 1e-3 * 8 / 3e3 * 1e-6); /* bending and shear */
    NEAR(bent[3 * POINTS - 3], 0, 1e-10);
    NEAR(x[3 * POINTS - 2], 6 + 2, 1e-8); /* along y now */
    for (int i = 0; i < POINTS; i++) {
        NEAR(fabs(moment[3 * i + 1]), 1e-3 * (8 - x[3 * i + 1]), 2e-9);
    }
    free_document(d);
    spar_session_destroy(&s);
}

static void test_member(void **state) {
    (void)state;
    moved m;
    move(&m);
    OK(m.session, spar_member_write_vtk(m.beam, "output_beam.vtp"));
    document *d = read_document("output_beam.vtp");
    assert_string_equal(d->root, "PolyData");
    check_nodes(d, &m);
    check_axes(d, &m);
    check_bending(d, &m);
    const int64_t *vert = integers(d, "Verts", "connectivity", NODES), *end = integers(d, "Lines", "offsets", ELEMENTS);
    const int64_t *each = integers(d, "Verts", "offsets", NODES);
    const int64_t *line = integers(d, "Lines", "connectivity", SAMPLES);
    const double *node = numbers(d, "PointData", "node", 1, SAMPLES);
    for (int i = 0; i < NODES; i++) {
        assert_true(node[vert[i]] == i && each[i] == i + 1);
    }
    for (int i = 0; i < SAMPLES; i++) {
        assert_int_equal(line[i], i);
    }
    assert_int_equal(end[0], SAMPLES / 2);
    assert_int_equal(end[1], SAMPLES);
    assert_true(numbers(d, "FieldData", "TimeValue", 1, 1)[0] == 0);
    numbers(d, "FieldData", "reaction_force", 3, 1);
    free_document(d);
    assert_null(slurp("output_beam.vtp.part"));
    spar_session_destroy(&m.session);
}

/* The unstructured grid has the same points; 1 and 3 are VTK's numbers of a vertex and of a line of two points. */
static void test_grid(void **state) {
    (void)state;
    enum { SEGMENTS = SAMPLES - ELEMENTS, CELLS = NODES + SEGMENTS };
    moved m;
    move(&m);
    OK(m.session, spar_member_write_vtk(m.beam, "output_beam.vtu"));
    document *d = read_document("output_beam.vtu");
    assert_string_equal(d->root, "UnstructuredGrid");
    check_nodes(d, &m);
    const array *types = get(d, "Cells", "types");
    assert_int_equal(types->bytes, CELLS);
    const int64_t *end = integers(d, "Cells", "offsets", CELLS);
    const int64_t *joins = integers(d, "Cells", "connectivity", NODES + 2 * SEGMENTS);
    for (int i = 0; i < CELLS; i++) {
        assert_int_equal(types->data[i], i < NODES ? 1 : 3);
        assert_int_equal(end[i], i < NODES ? i + 1 : NODES + 2 * (i - NODES + 1));
    }
    for (int i = 0; i < SEGMENTS; i++) { /* none from one element to the next: their ends are the same place */
        int64_t from = i + (i >= SAMPLES / 2 - 1 ? 1 : 0);
        assert_true(joins[NODES + 2 * i] == from && joins[NODES + 2 * i + 1] == from + 1);
    }
    free_document(d);
    spar_session_destroy(&m.session);
}

/* A body is one node and no line; the time of the session and the reaction go with the file. */
static void test_body_in_time(void **state) {
    (void)state;
    const double x[3] = {1, 2, 3}, q[4] = {1, 0, 0, 0}, g[3] = {0, 0, -10}, c[3] = {0}, J[3] = {1, 1, 1};
    double M[36];
    spar_session *s = scene_session();
    spar_member *b = NULL;
    scene_mass(M, 2, c, J);
    OK(s, spar_session_set_gravity(s, g));
    OK(s, spar_rigid_create(s, "body", x, q, M, &b));
    OK(s, spar_member_set_root(b, SPAR_ROOT_FIXED));
    assert_int_equal(spar_member_write_vtk(b, "output_body.vtp"), SPAR_ERR_STATE);
    OK(s, spar_member_commit(b));
    scene_run(s, 0.25, 2);
    OK(s, spar_member_write_vtk(b, "output_body.vtp"));
    document *d = read_document("output_body.vtp");
    const double *at = numbers(d, "Points", "Points", 3, 1);
    assert_true(at[0] == 1 && at[1] == 2 && at[2] == 3);
    assert_true(numbers(d, "FieldData", "TimeValue", 1, 1)[0] == 0.5);
    NEAR(numbers(d, "FieldData", "reaction_force", 3, 1)[2], 20, 1e-12); /* m g, by the balance of forces */
    integers(d, "Lines", "offsets", 0);
    free_document(d);
    spar_session_destroy(&s);
}

/* ---- fluids ---- */

static void test_fluids(void **state) {
    (void)state;
    moved m;
    spar_fluid *sections = NULL, *mesh = NULL, *none = NULL;
    const double eta[3] = {0, 0.6, 1}, offset[9] = {0, 0.1, 0, 0, 0.2, 0, 0, 0.3, 0};
    const double nodes[6] = {1, -2, 4, 2, -2, 3}, force[9] = {1, 2, 3, 4, 5, 6, 7, 8, 9};
    double x[9], v[9];
    move(&m);
    OK(m.session, spar_fluid_create(m.beam, "sections", &sections));
    OK(m.session, spar_fluid_set_stations(sections, 3, eta, offset));
    assert_int_equal(spar_fluid_write_vtk(sections, "output_fluid.vtp"), SPAR_ERR_STATE);
    OK(m.session, spar_fluid_map(sections));
    OK(m.session, spar_fluid_push_forces(sections, force, NULL));
    OK(m.session, spar_fluid_pull_motion(sections, 1, x, v));
    OK(m.session, spar_fluid_write_vtk(sections, "output_fluid.vtp"));
    document *d = read_document("output_fluid.vtp");
    const double *at = numbers(d, "Points", "Points", 3, 6);
    assert_memory_equal(at, x, sizeof x);
    assert_memory_equal(numbers(d, "PointData", "velocity", 3, 6), v, sizeof v);
    assert_memory_equal(numbers(d, "PointData", "force", 3, 6), force, sizeof force);
    for (int i = 0; i < 3; i++) { /* the first and the last foot are the beam's ends */
        NEAR(at[9 + i], m.x[i] + m.q[i], 1e-14);
        NEAR(at[15 + i], m.x[3 * (NODES - 1) + i] + m.q[7 * (NODES - 1) + i], 1e-14);
        NEAR(numbers(d, "PointData", "distance", 1, 6)[i], offset[3 * i + 1], 1e-15);
        NEAR(numbers(d, "PointData", "eta", 1, 6)[i], eta[i], 1e-15);
        assert_true(numbers(d, "PointData", "set", 1, 6)[3 + i] == 2);
    }
    /* the row of sections, then a connector each from node to foot */
    const int64_t ends[4] = {3, 5, 7, 9}, joined[9] = {0, 1, 2, 0, 3, 1, 4, 2, 5};
    assert_memory_equal(integers(d, "Lines", "offsets", 4), ends, sizeof ends);
    assert_memory_equal(integers(d, "Lines", "connectivity", 9), joined, sizeof joined);
    free_document(d);

    OK(m.session, spar_fluid_create(m.beam, "mesh", &mesh));
    OK(m.session, spar_fluid_set_motion_nodes(mesh, 2, nodes));
    OK(m.session, spar_fluid_set_force_nodes(mesh, 1, nodes));
    OK(m.session, spar_fluid_map(mesh));
    OK(m.session, spar_fluid_push_forces(mesh, force, NULL));
    OK(m.session, spar_fluid_pull_motion(mesh, 1, x, NULL));
    OK(m.session, spar_fluid_write_vtk(mesh, "output_fluid.vtp"));
    d = read_document("output_fluid.vtp");
    at = numbers(d, "Points", "Points", 3, 6);
    const double *set = numbers(d, "PointData", "set", 1, 6), *flags = numbers(d, "PointData", "flags", 1, 6);
    int flagged[2];
    OK(m.session, spar_fluid_get_map(mesh, SPAR_NODES_MOTION, NULL, NULL, flagged));
    assert_true(flags[0] == flagged[0] && flags[1] == flagged[1] && flags[3] == flagged[0]);
    assert_memory_equal(at, x, 6 * sizeof *x);
    assert_memory_equal(at + 6, x, 3 * sizeof *x); /* the force node is the first motion node */
    assert_true(set[0] == 0 && set[1] == 0 && set[2] == 1);
    const double *pushed = numbers(d, "PointData", "force", 3, 6);
    assert_true(pushed[0] == 0 && pushed[5] == 0 && pushed[6] == 1 && pushed[8] == 3);
    integers(d, "Lines", "offsets", 3);
    free_document(d);

    /* a rank without nodes writes a picture without points */
    OK(m.session, spar_fluid_create(m.beam, "none", &none));
    OK(m.session, spar_fluid_map(none));
    OK(m.session, spar_fluid_write_vtk(none, "output_fluid.vtp"));
    d = read_document("output_fluid.vtp");
    numbers(d, "Points", "Points", 3, 0);
    free_document(d);
    spar_session_destroy(&m.session);
}

/* ---- refusals ---- */

static void test_refusals(void **state) {
    (void)state;
    moved m;
    move(&m);
    assert_int_equal(spar_member_write_vtk(NULL, "x.vtp"), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_fluid_write_vtk(NULL, "x.vtp"), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_member_write_vtk(m.beam, NULL), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_member_write_vtk(m.beam, ""), SPAR_ERR_ARGUMENT);
    /* the message names the path and the system's reason */
    assert_int_equal(spar_member_write_vtk(m.beam, "no-such-folder/beam.vtp"), SPAR_ERR_IO);
    assert_non_null(strstr(spar_session_message(m.session), "no-such-folder/beam.vtp"));
    assert_non_null(strstr(spar_session_message(m.session), "No such file or directory"));
    OK(m.session, spar_member_write_vtk(m.beam, "output_beam.vtp"));
    spar_session_destroy(&m.session);
}

/* ---- series ---- */

/* The index is a whole document after every call, and says what was added; names are spelled as XML wants. */
static void test_series(void **state) {
    (void)state;
    const char *path = "output_series.pvd";
    remove(path);
    for (int i = 0; i < 3; i++) {
        char file[32];
        snprintf(file, sizeof file, "a&b<\"%d\".vtp", i);
        OK(NULL, spar_vtk_series_add(path, 0.1 * i, i % 2, file));
        document *d = read_document(path);
        assert_string_equal(d->root, "Collection");
        char expected[512] = "";
        for (int k = 0; k <= i; k++) {
            size_t used = strlen(expected);
            snprintf(expected + used, sizeof expected - used,
                     "<DataSet timestep=\"%.17g\" part=\"%d\" file=\"a&amp;b&lt;&quot;%d&quot;.vtp\"/\n", 0.1 * k,
                     k % 2, k);
        }
        assert_string_equal(d->datasets, expected);
        free_document(d);
    }
    assert_int_equal(spar_vtk_series_add(path, NAN, 0, "x.vtp"), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_vtk_series_add(path, 0, -1, "x.vtp"), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_vtk_series_add(path, 0, 0, NULL), SPAR_ERR_ARGUMENT);
    assert_int_equal(spar_vtk_series_add("no-such-folder/x.pvd", 0, 0, "x.vtp"), SPAR_ERR_IO);
    assert_non_null(strstr(spar_session_message(NULL), "No such file or directory"));
    FILE *other = fopen("output_other.pvd", "w");
    fputs("something else of some length, longer than the foot of an index\n", other);
    fclose(other);
    assert_int_equal(spar_vtk_series_add("output_other.pvd", 0, 0, "x.vtp"), SPAR_ERR_IO);
    char *kept = slurp("output_other.pvd");
    assert_memory_equal(kept, "something else", 14);
    free(kept);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_member), cmocka_unit_test(test_bent_on_a_turned_root),
        cmocka_unit_test(test_grid),   cmocka_unit_test(test_body_in_time),
        cmocka_unit_test(test_fluids), cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_series),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
