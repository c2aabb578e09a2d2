/* The structure's part of code_saturne's checkpoints: checkpoint/spar is written when the first section of a checkpoint
   is, whatever rule asked for it, and restart/spar is read when the flow goes on from its own. */
#include "cs_base.h"
#include "cs_headers.h"
#include "cs_restart.h"
#include "spar_saturne.h"

static cs_restart_write_section_t *write_section;
static int saved_step = -1;

static void write_with_structure(cs_restart_t *file, void *context, const char *name, int location, int values,
                                 cs_restart_val_type_t type, const void *value) {
    if (saved_step != cs_glob_time_step->nt_cur) {
        saved_step = cs_glob_time_step->nt_cur;
        saturne_clock_begin();
        saturne_check(spar_session_save(saturne_session(), "checkpoint/spar"));
        saturne_clock_end();
    }
    write_section(file, context, name, location, values, type, value);
}

int saturne_resumed(void) {
    return cs_glob_time_step->nt_prev > 0;
}

/* code_saturne (6.0 to 8.0) reads the displacements of the vertices, and not those of the step before, on which its own
   mesh equation builds: the mesh would fall back to the reference. */
static void restore_displacements(const double *reference) {
    const cs_field_t *f = cs_field_by_name(SATURNE_DISPLACEMENT);
    for (cs_lnum_t i = 0; i < 3 * cs_glob_mesh->n_vertices; i++) {
        f->val_pre[i] = cs_glob_mesh->vtx_coord[i] - reference[i];
    }
}

void saturne_resume(const double *reference) {
    const cs_time_step_t *time = cs_glob_time_step;
    if (saturne_resumed() && reference != NULL) {
        restore_displacements(reference);
    }
    saturne_check_case(
        spar_case_resume(saturne_scene(), saturne_resumed() ? "restart/spar" : NULL, time->t_prev, time->nt_prev));
    write_section = cs_restart_set_write_section_func(write_with_structure);
}

FILE *saturne_open_history(double t, const char *columns) {
    if (saturne_resumed()) {
        saturne_check_case(spar_case_cut_history("history.csv", t * (1 - 1e-8)));
    }
    FILE *file = fopen("history.csv", saturne_resumed() ? "a" : "w");
    if (file == NULL) {
        bft_error(__FILE__, __LINE__, 0, "spar: history.csv cannot be written here");
    }
    if (fseek(file, 0, SEEK_END) == 0 && ftell(file) == 0) {
        fprintf(file, "%s\n", columns);
    }
    return file;
}
