/* spar behind code_saturne's coupling with an external structure: the functions by which it would talk to code_aster
   are defined here in place of the library's. Their order in a run, and in spar:

       astgeo                       once: the wetted faces                fluid, map
       astpdt                       every step                            spar_step_begin
       astcin                       every sub-iteration: displacements    spar_step_solve, spar_fluid_pull_motion
       astfor                       every sub-iteration: forces           spar_fluid_push_forces, spar_step_check
       cs_ast_coupling_get_ext_cvg  after it: has the structure converged
       cs_ast_coupling_send_cvg     after it: go on?                      spar_step_accept
 */
#include "spar_saturne.h"
#include "cs_ast_coupling.h"
#include "cs_base.h"
#include "cs_headers.h"
#include "cs_prototypes.h"
#include <string.h>

static struct {
    spar_member *wet;
    spar_fluid *surface;
    cs_lnum_t n_faces, n_vertices, *faces, *vertices; /* of this rank, from 0 */
    double *x0, *x;                                   /* [n_vertices][3], at the start and now */
    double *force;                                    /* [n_faces][3] */
    int stepping, done;
    double later[2]; /* from this time on this step, s */
} host;

/* ---- once ---- */

/* mark[vertex] = 1 for the vertices of these faces. */
static void mark_vertices(cs_lnum_t n, const cs_lnum_t *faces, int *mark) {
    const cs_mesh_t *mesh = cs_glob_mesh;
    for (cs_lnum_t i = 0; i < n; i++) {
        for (cs_lnum_t j = mesh->b_face_vtx_idx[faces[i]]; j < mesh->b_face_vtx_idx[faces[i] + 1]; j++) {
            mark[mesh->b_face_vtx_lst[j]] = 1;
        }
    }
}

/* All vertices, or the wetted ones. One on the border of two ranks is on both, which is right for motion; faces are on
   one. */
static void collect_vertices(int all) {
    int *mark;
    BFT_MALLOC(mark, cs_glob_mesh->n_vertices, int);
    BFT_MALLOC(host.vertices, cs_glob_mesh->n_vertices, cs_lnum_t);
    memset(mark, 0, (size_t)cs_glob_mesh->n_vertices * sizeof *mark);
    mark_vertices(host.n_faces, host.faces, mark);
    for (cs_lnum_t v = 0; v < cs_glob_mesh->n_vertices; v++) {
        if (all || mark[v]) {
            host.vertices[host.n_vertices++] = v;
        }
    }
    BFT_FREE(mark);
}

/* All vertices follow the structure, the less the farther from it; those of fixed faces do not. */
static void fade_mesh(void) {
    double fade[2];
    int *held;
    cs_lnum_t *faces, n = saturne_faces(saturne_text("fixed", ""), &faces);
    BFT_MALLOC(held, host.n_vertices, int);
    memset(held, 0, (size_t)host.n_vertices * sizeof *held);
    mark_vertices(n, faces, held);
    saturne_check_case(spar_case_get_numbers(saturne_scene(), "fade", 2, NULL, fade));
    saturne_check(spar_fluid_fade_motion(host.surface, fade[0], fade[1], host.n_vertices, NULL, held));
    BFT_FREE(held);
    BFT_FREE(faces);
}

static void couple_surface(void) {
    const cs_mesh_t *mesh = cs_glob_mesh;
    double *centres;
    BFT_MALLOC(host.x0, 3 * host.n_vertices, double);
    BFT_MALLOC(host.x, 3 * host.n_vertices, double);
    BFT_MALLOC(host.force, 3 * host.n_faces, double);
    BFT_MALLOC(centres, 3 * host.n_faces, double);
    for (cs_lnum_t i = 0; i < host.n_vertices; i++) {
        memcpy(host.x0 + 3 * i, mesh->vtx_coord + 3 * host.vertices[i], 3 * sizeof(double));
    }
    for (cs_lnum_t i = 0; i < host.n_faces; i++) {
        memcpy(centres + 3 * i, cs_glob_mesh_quantities->b_face_cog + 3 * host.faces[i], 3 * sizeof(double));
    }
    saturne_check(spar_fluid_create(host.wet, "code_saturne", &host.surface));
    saturne_check(spar_fluid_set_motion_nodes(host.surface, host.n_vertices, host.x0));
    saturne_check(spar_fluid_set_force_nodes(host.surface, host.n_faces, centres));
    saturne_check(spar_fluid_map(host.surface));
    /* code_saturne takes wall velocities from its moving mesh */
    saturne_check(spar_fluid_set_option(host.surface, "velocity", "own"));
    BFT_FREE(centres);
}

/* code_saturne's own limits of the sub-iteration; spar's rule, so its limit must be the smaller one. */
void cs_ast_coupling_initialize(int nalimx, cs_real_t epalim) {
    (void)nalimx, (void)epalim;
}

/* The wetted faces of this rank, numbered from 1; there may be none. */
void CS_PROCF(astgeo, ASTGEO)(cs_int_t *nbfast, cs_int_t *lstfac, cs_int_t *idfast, cs_int_t *idnast,
                              cs_real_t *almax) {
    const int all = *saturne_text("fade", "") != '\0';
    (void)idfast, (void)idnast, (void)almax;
    host.n_faces = *nbfast;
    BFT_MALLOC(host.faces, host.n_faces, cs_lnum_t);
    for (cs_lnum_t i = 0; i < host.n_faces; i++) {
        host.faces[i] = lstfac[i] - 1;
    }
    saturne_clock_begin();
    saturne_check_case(spar_case_member(saturne_scene(), saturne_text("member", NULL), &host.wet));
    saturne_check_case(spar_case_make_aero(saturne_scene(), CS_MAX(cs_glob_rank_id, 0)));
    collect_vertices(all);
    couple_surface();
    if (all) {
        fade_mesh();
    }
    saturne_clock_end();
    const double never[2] = {0, 0};
    saturne_check_case(spar_case_get_numbers(saturne_scene(), "later", 2, never, host.later));
    saturne_report_begin();
    saturne_check_case(spar_case_check(saturne_scene())); /* all keys have been asked for */
}

/* ---- every step ---- */

void CS_PROCF(astpdt, ASTPDT)(cs_real_t *dttab, cs_int_t *nbpdt) {
    (void)nbpdt;
    double dt = cs_glob_mesh->n_cells > 0 ? dttab[0] : cs_glob_time_step->dt_ref;
    saturne_clock_begin();
    saturne_check(spar_step_begin(saturne_session(), dt));
    saturne_clock_end();
    host.stepping = 1, host.done = 0;
}

/* Displacements since the start of the run. They are asked for once before the first step too. */
void CS_PROCF(astcin, ASTCIN)(cs_int_t *ntcast, cs_real_3_t *disale) {
    (void)ntcast;
    if (!host.stepping) {
        return;
    }
    saturne_clock_begin();
    saturne_check(spar_step_solve(saturne_session()));
    saturne_check_case(spar_case_blow(saturne_scene()));
    saturne_check(spar_fluid_pull_motion(host.surface, 1.0, host.x, NULL));
    saturne_clock_end();
    for (cs_lnum_t i = 0; i < host.n_vertices; i++) {
        for (int c = 0; c < 3; c++) {
            disale[host.vertices[i]][c] = host.x[3 * i + c] - host.x0[3 * i + c];
        }
    }
}

void CS_PROCF(astfor, ASTFOR)(cs_int_t *ntcast, cs_int_t *nbfast, cs_real_t *forast) {
    (void)ntcast, (void)nbfast, (void)forast;
    if (!host.stepping) {
        return;
    }
    saturne_wall_forces(host.n_faces, host.faces, host.force);
    saturne_clock_begin();
    saturne_check(spar_fluid_push_forces(host.surface, host.force, NULL));
    saturne_check(spar_step_check(saturne_session(), &host.done));
    saturne_clock_end();
}

int cs_ast_coupling_get_ext_cvg(void) {
    return host.done;
}

/* icved: 1, code_saturne goes on to the next step */
void cs_ast_coupling_send_cvg(int icved) {
    if (!host.stepping || !(icved || host.done)) {
        return;
    }
    saturne_clock_begin();
    saturne_check(spar_step_accept(saturne_session()));
    saturne_check_case(spar_case_output(saturne_scene(), CS_MAX(cs_glob_rank_id, 0), 1, &host.surface));
    saturne_clock_end();
    host.stepping = 0;
    saturne_report_step(host.wet, host.surface);
}

/* A run to a limit cycle may start with a long step: code_saturne takes the next one from here. */
void cs_user_extra_operations(cs_domain_t *domain) {
    if (host.later[1] > 0 && cs_glob_time_step->t_cur >= host.later[0] - 0.5 * host.later[1]) {
        domain->time_step->dt_ref = host.later[1];
        for (cs_lnum_t cell = 0; cell < cs_glob_mesh->n_cells_with_ghosts; cell++) {
            CS_F_(dt)->val[cell] = host.later[1];
        }
    }
}

/* ---- at the end ---- */

/* cs_ast_coupling_finalize is not called by 6.0; this is the last call on all ranks before MPI_Finalize */
void cs_user_extra_operations_finalize(cs_domain_t *domain) {
    (void)domain;
    saturne_report_run();
    saturne_end();
    BFT_FREE(host.faces);
    BFT_FREE(host.vertices);
    BFT_FREE(host.x0);
    BFT_FREE(host.x);
    BFT_FREE(host.force);
}

void cs_ast_coupling_finalize(void) {
}
