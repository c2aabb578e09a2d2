/* spar behind code_saturne's coupling with an external structure: the functions by which it would talk to code_aster
   are defined here in place of the library's. Their order in a run, and in spar:

       couple        once: the wetted faces                fluids, maps, the saved state
       begin_step    every step                            spar_step_begin
       move          every sub-iteration: displacements    spar_step_solve, spar_fluid_pull_motion
       take_forces   every sub-iteration                   spar_fluid_push_forces, spar_step_check
       cs_ast_coupling_get_ext_cvg  after it: has the structure converged
       cs_ast_coupling_send_cvg     after it: go on?                      spar_step_accept
 */
#include "spar_saturne.h"
#include "cs_ast_coupling.h"
#include "cs_base.h"
#include "cs_headers.h"
#include "cs_prototypes.h"
#include <stdio.h>

static struct {
    int stepping, done;
    double later[2]; /* from this time on this step, s */
    const double *reference;
} host;

void saturne_set_reference(const double *vertices) {
    host.reference = vertices;
}

/* ---- once ---- */

/* code_saturne's own limits of the sub-iteration; spar's rule, so its limit must be the smaller one. */
void cs_ast_coupling_initialize(int nalimx, cs_real_t epalim) {
    (void)nalimx, (void)epalim;
}

/* A run to a limit cycle may start with a long step: the next one is `later`'s from its time on. */
static void choose_step(void) {
    if (host.later[1] > 0 && cs_glob_time_step->t_cur >= host.later[0] - 0.5 * host.later[1]) {
        cs_get_glob_time_step()->dt_ref = host.later[1];
        for (cs_lnum_t cell = 0; cell < cs_glob_mesh->n_cells_with_ghosts; cell++) {
            CS_F_(dt)->val[cell] = host.later[1];
        }
    }
}

static void couple(void) {
    const double never[2] = {0, 0};
    saturne_clock_begin();
#if SATURNE_VERSION >= 70
    host.reference = cs_field_by_name("vtx_coord0")->val;
#endif
    saturne_check_case(spar_case_make_aero(saturne_scene(), CS_MAX(cs_glob_rank_id, 0)));
    saturne_bodies_create(host.reference);
    saturne_check_case(spar_case_get_numbers(saturne_scene(), "later", 2, never, host.later));
    saturne_report_begin();
    saturne_resume(host.reference);
    saturne_check_keys();
    choose_step();
    saturne_clock_end();
}

/* ---- every step ---- */

static void begin_step(const cs_real_t *dttab) {
    double dt = cs_glob_mesh->n_cells > 0 ? dttab[0] : cs_glob_time_step->dt_ref;
    saturne_clock_begin();
    saturne_check(spar_step_begin(saturne_session(), dt));
    saturne_clock_end();
    host.stepping = 1, host.done = 0;
}

/* A structure that cannot be solved under forces far beyond all that the flow had before is not the one to blame. */
static void check_solve(int status) {
    const double growth = saturne_bodies_growth();
    if (status == SPAR_ERR_NUMERIC && growth > 100) {
        char why[1200];
        snprintf(why, sizeof why, "the flow's forces on the wetted faces are %.3g times the largest before (%.900s)",
                 growth, spar_session_message(saturne_session()));
        saturne_flow_broke(why);
    }
    saturne_check(status);
}

/* Displacements since the start of the first run. They are asked for once before the first step too. */
static void move(cs_real_3_t *displacement) {
    if (!host.stepping) {
        return;
    }
    saturne_clock_begin();
    check_solve(spar_step_solve(saturne_session()));
    saturne_check_case(spar_case_blow(saturne_scene()));
    saturne_bodies_pull(displacement);
    saturne_clock_end();
}

static void take_forces(void) {
    if (!host.stepping) {
        return;
    }
    saturne_bodies_push();
    saturne_clock_begin();
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
    saturne_bodies_output();
    saturne_clock_end();
    host.stepping = 0;
    saturne_report_step();
}

void cs_user_extra_operations(cs_domain_t *domain) {
    (void)domain;
    choose_step();
}

/* ---- the names of these in code_saturne ---- */

#if SATURNE_VERSION < 80

void CS_PROCF(astgeo, ASTGEO)(cs_lnum_t *nbfast, cs_lnum_t *lstfac, cs_lnum_t *idfast, cs_lnum_t *idnast,
                              cs_real_t *almax) {
    (void)nbfast, (void)lstfac, (void)idfast, (void)idnast, (void)almax;
    couple();
}

#if SATURNE_VERSION < 70 /* these have a counter more */
#define COUNTER(name) cs_lnum_t *name,
#define LAST_COUNTER(name) , cs_lnum_t *name
#define UNUSED(name) (void)name
#else
#define COUNTER(name)
#define LAST_COUNTER(name)
#define UNUSED(name) (void)0
#endif

void CS_PROCF(astpdt, ASTPDT)(cs_real_t *dttab LAST_COUNTER(nbpdt)) {
    UNUSED(nbpdt);
    begin_step(dttab);
}

void CS_PROCF(astcin, ASTCIN)(COUNTER(ntcast) cs_real_3_t *disale) {
    UNUSED(ntcast);
    move(disale);
}

void CS_PROCF(astfor, ASTFOR)(COUNTER(ntcast) cs_lnum_t *nbfast, cs_real_t *forast) {
    UNUSED(ntcast);
    (void)nbfast, (void)forast;
    take_forces();
}

#else

void cs_ast_coupling_geometry(cs_lnum_t n_faces, const cs_lnum_t *face_ids, cs_real_t almax) {
    (void)n_faces, (void)face_ids, (void)almax;
    couple();
}

void cs_ast_coupling_exchange_time_step(cs_real_t c_dt[]) {
    begin_step(c_dt);
}

void cs_ast_coupling_compute_displacement(cs_real_t disp[][3]) {
    move(disp);
}

/* No face is marked as an external structure's (ale.c): nothing is written there. */
cs_real_3_t *cs_ast_coupling_get_fluid_forces_pointer(void) {
    return NULL;
}

void cs_ast_coupling_exchange_fields(void) {
    take_forces();
}

#endif

/* ---- at the end ---- */

/* cs_ast_coupling_finalize is not called by 6.0; this is the last call on all ranks before MPI_Finalize */
void cs_user_extra_operations_finalize(cs_domain_t *domain) {
    (void)domain;
    saturne_report_run();
    saturne_mesh_fold();
    saturne_end();
    saturne_bodies_free();
}

void cs_ast_coupling_finalize(void) {
}
