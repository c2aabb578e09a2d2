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

void CS_PROCF(astgeo, ASTGEO)(cs_int_t *nbfast, cs_int_t *lstfac, cs_int_t *idfast, cs_int_t *idnast,
                              cs_real_t *almax) {
    (void)nbfast, (void)lstfac, (void)idfast, (void)idnast, (void)almax;
    const double never[2] = {0, 0};
    saturne_clock_begin();
    saturne_check_case(spar_case_make_aero(saturne_scene(), CS_MAX(cs_glob_rank_id, 0)));
    saturne_bodies_create(host.reference);
    saturne_check_case(spar_case_get_numbers(saturne_scene(), "later", 2, never, host.later));
    saturne_report_begin();
    saturne_resume(host.reference);
    saturne_check_keys();
    saturne_clock_end();
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

/* A failure after forces that grew beyond all that the flow had before is the flow's, whatever it is called. */
static void check_step(int status) {
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
void CS_PROCF(astcin, ASTCIN)(cs_int_t *ntcast, cs_real_3_t *disale) {
    (void)ntcast;
    if (!host.stepping) {
        return;
    }
    saturne_clock_begin();
    check_step(spar_step_solve(saturne_session()));
    saturne_check_case(spar_case_blow(saturne_scene()));
    saturne_bodies_pull(disale);
    saturne_clock_end();
}

void CS_PROCF(astfor, ASTFOR)(cs_int_t *ntcast, cs_int_t *nbfast, cs_real_t *forast) {
    (void)ntcast, (void)nbfast, (void)forast;
    if (!host.stepping) {
        return;
    }
    saturne_bodies_push();
    saturne_clock_begin();
    check_step(spar_step_check(saturne_session(), &host.done));
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
    saturne_bodies_free();
}

void cs_ast_coupling_finalize(void) {
}
