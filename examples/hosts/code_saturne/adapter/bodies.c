/* The members in the flow: which faces and vertices of this rank are theirs, motion out, forces in. */
#include "cs_base.h"
#include "cs_headers.h"
#include "cs_interface.h"
#include "spar_saturne.h"
#include <math.h>
#include <string.h>

static struct {
    int n, fades; /* fades: all vertices follow, not only the wetted ones */
    saturne_body *body;
    double largest, pushed; /* N: total force of an accepted step, the largest so far; of the last push */
} bodies;

int saturne_body_count(void) {
    return bodies.n;
}

const saturne_body *saturne_body_at(int i) {
    return bodies.body + i;
}

/* ---- faces ---- */

static int find_body(const char *name) {
    for (int b = 0; b < bodies.n; b++) {
        if (strcmp(bodies.body[b].name, name) == 0) {
            return b;
        }
    }
    return bodies.n;
}

/* `member` and `wetted` are lists of the same length; a member that stands twice is one body with both groups. */
static void name_bodies(int *owner) {
    int members = 0, groups = 0;
    saturne_check_case(spar_case_get_word(saturne_scene(), "member", 0, &members, NULL));
    saturne_check_case(spar_case_get_word(saturne_scene(), "wetted", 0, &groups, NULL));
    (void)saturne_text("member", NULL), (void)saturne_text("wetted", NULL); /* they have to be there */
    if (members > 1 && groups != members) {
        bft_error(
            __FILE__, __LINE__, 0,
            "spar: member names %d members and wetted %d groups of faces; give one group for each, those of several "
            "words in quotes",
            members, groups);
    }
    BFT_MALLOC(bodies.body, members, saturne_body);
    memset(bodies.body, 0, (size_t)members * sizeof *bodies.body);
    for (int i = 0; i < members; i++) {
        const char *name, *criterion = members > 1 ? NULL : saturne_text("wetted", NULL);
        saturne_check_case(spar_case_get_word(saturne_scene(), "member", i, NULL, &name));
        if (criterion == NULL) {
            saturne_check_case(spar_case_get_word(saturne_scene(), "wetted", i, NULL, &criterion));
        }
        const int b = find_body(name);
        bodies.body[b].name = name;
        bodies.n = CS_MAX(bodies.n, b + 1);
        saturne_check_case(spar_case_member(saturne_scene(), name, &bodies.body[b].member));
        cs_lnum_t *faces, n = saturne_faces("wetted", criterion, &faces);
        int twice = 0;
        for (cs_lnum_t f = 0; f < n; f++) {
            twice = twice || owner[faces[f]] >= 0;
            owner[faces[f]] = b;
        }
        BFT_FREE(faces);
        cs_parall_max(1, CS_INT_TYPE, &twice);
        if (twice) {
            bft_error(__FILE__, __LINE__, 0,
                      "spar: wetted '%s' of member '%s' has faces of another group; a face has one", criterion, name);
        }
    }
}

static void collect_faces(const int *owner) {
    for (int b = 0; b < bodies.n; b++) {
        saturne_body *body = bodies.body + b;
        BFT_MALLOC(body->faces, cs_glob_mesh->n_b_faces, cs_lnum_t);
        for (cs_lnum_t f = 0; f < cs_glob_mesh->n_b_faces; f++) {
            if (owner[f] == b) {
                body->faces[body->n_faces++] = f;
            }
        }
        BFT_MALLOC(body->force, 3 * body->n_faces, double);
    }
}

/* ---- vertices ---- */

/* mark[vertex] = 1 for the vertices of these faces, also where a face is on another rank. */
static void mark_vertices(cs_lnum_t n, const cs_lnum_t *faces, int *mark) {
    const cs_mesh_t *mesh = cs_glob_mesh;
    memset(mark, 0, (size_t)mesh->n_vertices * sizeof *mark);
    for (cs_lnum_t i = 0; i < n; i++) {
        for (cs_lnum_t j = mesh->b_face_vtx_idx[faces[i]]; j < mesh->b_face_vtx_idx[faces[i] + 1]; j++) {
            mark[mesh->b_face_vtx_lst[j]] = 1;
        }
    }
    if (mesh->vtx_interfaces != NULL) {
        cs_interface_set_max(mesh->vtx_interfaces, mesh->n_vertices, 1, true, CS_INT_TYPE, mark);
    }
}

/* One on the border of two ranks is on both, which is right for motion; faces are on one. */
static void collect_vertices(saturne_body *body, const int *mark, const double *reference) {
    BFT_MALLOC(body->vertices, cs_glob_mesh->n_vertices, cs_lnum_t);
    for (cs_lnum_t v = 0; v < cs_glob_mesh->n_vertices; v++) {
        if (bodies.fades || mark[v]) {
            body->vertices[body->n_vertices++] = v;
        }
    }
    BFT_MALLOC(body->x0, 3 * body->n_vertices, double);
    BFT_MALLOC(body->x, 3 * body->n_vertices, double);
    for (cs_lnum_t i = 0; i < body->n_vertices; i++) {
        memcpy(body->x0 + 3 * i, reference + 3 * body->vertices[i], 3 * sizeof(double));
    }
}

/* Centres of the faces where they are at the start of the first run; in a run that goes on they have moved. */
static void create_surface(saturne_body *body, const double *reference) {
    cs_mesh_t first = *cs_glob_mesh;
    double *cog = NULL, *normal = NULL, *centres;
    BFT_MALLOC(first.vtx_coord, 3 * first.n_vertices, cs_real_t);
    memcpy(first.vtx_coord, reference, 3 * (size_t)first.n_vertices * sizeof(cs_real_t));
    cs_mesh_quantities_b_faces(&first, &cog, &normal);
    BFT_MALLOC(centres, 3 * body->n_faces, double);
    for (cs_lnum_t i = 0; i < body->n_faces; i++) {
        memcpy(centres + 3 * i, cog + 3 * body->faces[i], 3 * sizeof(double));
    }
    saturne_check(spar_fluid_create(body->member, bodies.n > 1 ? body->name : "code_saturne", &body->surface));
    saturne_check(spar_fluid_set_motion_nodes(body->surface, body->n_vertices, body->x0));
    saturne_check(spar_fluid_set_force_nodes(body->surface, body->n_faces, centres));
    saturne_check(spar_fluid_map(body->surface));
    /* code_saturne takes wall velocities from its moving mesh */
    saturne_check(spar_fluid_set_option(body->surface, "velocity", "own"));
    BFT_FREE(first.vtx_coord);
    BFT_FREE(cog);
    BFT_FREE(normal);
    BFT_FREE(centres);
}

/* All vertices follow the body, the less the farther from it; those of fixed faces do not. */
static void fade_mesh(saturne_body *body) {
    double fade[2];
    int *held;
    cs_lnum_t *faces, n = saturne_faces("fixed", saturne_text("fixed", ""), &faces);
    BFT_MALLOC(held, cs_glob_mesh->n_vertices, int);
    mark_vertices(n, faces, held);
    saturne_check_case(spar_case_get_numbers(saturne_scene(), "fade", 2, NULL, fade));
    saturne_check(spar_fluid_fade_motion(body->surface, fade[0], fade[1], body->n_vertices, NULL, held));
    BFT_FREE(held);
    BFT_FREE(faces);
}

/* Weights of one vertex, w[b] by its own distance from each body: a body's own wall follows it alone, and between two
   bodies each counts by w/(1 - w), so that the motion is continuous and their sum is 1 - product of (1 - w). */
static int share_vertex(const int *wet, double *w) {
    int owners = 0, near = 0;
    double rest = 1, sum = 0, most = 0;
    for (int b = 0; b < bodies.n; b++) {
        owners += wet[b], near += w[b] >= 1;
        rest *= 1 - w[b], sum += w[b] < 1 ? w[b] / (1 - w[b]) : 0;
        most = CS_MAX(most, w[b]);
    }
    for (int b = 0; most > 0 && b < bodies.n; b++) { /* most 0: beyond all, or held */
        w[b] = owners > 0 ? (double)wet[b] / owners
               : near > 0 ? (double)(w[b] >= 1) / near
                          : (1 - rest) * w[b] / (1 - w[b]) / sum;
    }
    return owners == 0 && near > 1;
}

/* Several bodies: what each moves of the vertices. marks: [bodies][vertices], the wetted ones. */
static void share_mesh(const int *marks) {
    const cs_lnum_t n = cs_glob_mesh->n_vertices;
    double *w, *one;
    int *wet, close = 0;
    BFT_MALLOC(w, bodies.n * n, double);
    BFT_MALLOC(one, bodies.n, double);
    BFT_MALLOC(wet, bodies.n, int);
    memset(w, 0, (size_t)(bodies.n * n) * sizeof *w);
    for (int b = 0; b < bodies.n; b++) {
        const saturne_body *body = bodies.body + b;
        saturne_check(spar_fluid_get_motion_weights(body->surface, body->x)); /* not in use yet */
        for (cs_lnum_t i = 0; i < body->n_vertices; i++) {
            w[b * n + body->vertices[i]] = body->x[i];
        }
    }
    for (cs_lnum_t v = 0; v < n; v++) {
        for (int b = 0; b < bodies.n; b++) {
            one[b] = w[b * n + v], wet[b] = marks[b * n + v];
        }
        close |= share_vertex(wet, one);
        for (int b = 0; b < bodies.n; b++) {
            w[b * n + v] = one[b];
        }
    }
    for (int b = 0; b < bodies.n; b++) {
        const saturne_body *body = bodies.body + b;
        for (cs_lnum_t i = 0; i < body->n_vertices; i++) {
            body->x[i] = w[b * n + body->vertices[i]];
        }
        saturne_check(spar_fluid_set_motion_weights(body->surface, body->n_vertices, body->x));
    }
    cs_parall_max(1, CS_INT_TYPE, &close);
    if (close) {
        saturne_tell(SPAR_LOG_WARNING, "fade: some vertices are within the first distance of two members, and follow "
                                       "both by half; make it smaller if the members move apart");
    }
    BFT_FREE(w);
    BFT_FREE(one);
    BFT_FREE(wet);
}

void saturne_bodies_select(int mark, int *types) {
    int *owner;
    BFT_MALLOC(owner, cs_glob_mesh->n_b_faces, int);
    for (cs_lnum_t f = 0; f < cs_glob_mesh->n_b_faces; f++) {
        owner[f] = -1;
    }
    name_bodies(owner);
    collect_faces(owner);
    for (cs_lnum_t f = 0; f < cs_glob_mesh->n_b_faces; f++) {
        types[f] = owner[f] >= 0 ? mark : types[f];
    }
    BFT_FREE(owner);
}

void saturne_bodies_create(const double *reference) {
    const cs_lnum_t n = cs_glob_mesh->n_vertices;
    int *marks;
    bodies.fades = *saturne_text("fade", "") != '\0';
    BFT_MALLOC(marks, bodies.n * n, int);
    for (int b = 0; b < bodies.n; b++) {
        saturne_body *body = bodies.body + b;
        mark_vertices(body->n_faces, body->faces, marks + b * n);
        collect_vertices(body, marks + b * n, reference);
        create_surface(body, reference);
        if (bodies.fades) {
            fade_mesh(body);
        }
    }
    if (bodies.n > 1) {
        share_mesh(marks);
    }
    BFT_FREE(marks);
}

void saturne_bodies_follow(int *follows) {
    for (int b = 0; b < bodies.n; b++) {
        for (cs_lnum_t i = 0; i < bodies.body[b].n_vertices; i++) {
            follows[bodies.body[b].vertices[i]] = 1;
        }
    }
}

/* ---- every iteration ---- */

void saturne_bodies_pull(cs_real_3_t *displacement) {
    for (int set = 1; set >= 0; set--) {
        for (int b = 0; b < bodies.n; b++) {
            const saturne_body *body = bodies.body + b;
            if (set) {
                saturne_check(spar_fluid_pull_motion(body->surface, 1.0, body->x, NULL));
            }
            for (cs_lnum_t i = 0; i < body->n_vertices; i++) {
                for (int c = 0; c < 3; c++) {
                    double *u = &displacement[body->vertices[i]][c];
                    *u = set ? 0 : *u + (body->x[3 * i + c] - body->x0[3 * i + c]);
                }
            }
        }
    }
}

void saturne_bodies_push(void) {
    double size = 0;
    for (int b = 0; b < bodies.n; b++) {
        const saturne_body *body = bodies.body + b;
        saturne_wall_forces(body->n_faces, body->faces, body->force);
        for (cs_lnum_t i = 0; i < 3 * body->n_faces; i++) {
            size += fabs(body->force[i]);
        }
    }
    cs_parall_sum(1, CS_DOUBLE, &size);
    bodies.pushed = size;
    if (!(size < 1e300)) {
        saturne_flow_broke("the flow's forces on the wetted faces are no numbers");
    }
    saturne_clock_begin();
    for (int b = 0; b < bodies.n; b++) {
        saturne_check(spar_fluid_push_forces(bodies.body[b].surface, bodies.body[b].force, NULL));
    }
    saturne_clock_end();
}

void saturne_bodies_output(void) {
    spar_fluid **surface;
    BFT_MALLOC(surface, bodies.n, spar_fluid *);
    for (int b = 0; b < bodies.n; b++) {
        surface[b] = bodies.body[b].surface;
    }
    bodies.largest = CS_MAX(bodies.largest, bodies.pushed);
    saturne_check_case(spar_case_output(saturne_scene(), CS_MAX(cs_glob_rank_id, 0), bodies.n, surface));
    BFT_FREE(surface);
}

double saturne_bodies_growth(void) {
    return bodies.largest > 0 ? bodies.pushed / bodies.largest : 1;
}

void saturne_bodies_free(void) {
    for (int b = 0; b < bodies.n; b++) {
        saturne_body *body = bodies.body + b;
        BFT_FREE(body->faces);
        BFT_FREE(body->vertices);
        BFT_FREE(body->x0);
        BFT_FREE(body->x);
        BFT_FREE(body->force);
    }
    BFT_FREE(bodies.body);
    bodies.n = 0;
}
