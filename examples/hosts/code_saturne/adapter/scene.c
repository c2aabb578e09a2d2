/* The session and the case file, with or without a mesh that moves. */
#include "cs_ale.h"
#include "cs_base.h"
#include "cs_headers.h"
#include "cs_prototypes.h"
#include "fvm_selector.h"
#include "spar_saturne.h"
#include <math.h>
#include <spar/spar_mpi.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static spar_session *session;
static spar_case *scene;

void saturne_check(int status) {
    if (status != SPAR_OK) {
        bft_error(__FILE__, __LINE__, 0, "spar: %s: %s", spar_status_text(status), spar_session_message(session));
    }
}

void saturne_check_case(int status) {
    if (status != SPAR_OK) {
        bft_error(__FILE__, __LINE__, 0, "spar: %s: %s", spar_status_text(status), spar_case_message());
    }
}

void saturne_tell(int level, const char *text) {
    if (cs_glob_rank_id < 1) {
        bft_printf("spar%s: %s\n",
                   level == SPAR_LOG_ERROR     ? ", error"
                   : level == SPAR_LOG_WARNING ? ", warning"
                                               : "",
                   text);
        bft_printf_flush();
    }
}

static void tell(const spar_session *from, int level, const char *text, void *context) {
    (void)from, (void)context;
    saturne_tell(level, text);
}

static void begin(void) {
    const char *path = getenv("SPAR_CASE");
    /* a serial run has not initialised MPI */
    saturne_check(cs_glob_n_ranks > 1 ? spar_session_create_mpi(cs_glob_mpi_comm, &session)
                                      : spar_session_create(&session));
    saturne_check(spar_session_set_log(session, tell, NULL));
    saturne_check_case(spar_case_read(path != NULL ? path : "structure.case", "code_saturne", session, &scene));
    (void)saturne_text("flow", ""); /* the run script's */
}

spar_session *saturne_session(void) {
    if (scene == NULL) {
        begin();
    }
    return session;
}

spar_case *saturne_scene(void) {
    if (scene == NULL) {
        begin();
    }
    return scene;
}

void saturne_end(void) {
    spar_case_free(&scene);
    spar_session_destroy(&session);
}

double saturne_number(const char *key, const double *otherwise) {
    double value = 0;
    saturne_check_case(spar_case_get_numbers(saturne_scene(), key, 1, otherwise, &value));
    return value;
}

const char *saturne_text(const char *key, const char *otherwise) {
    const char *text = NULL;
    saturne_check_case(spar_case_get_text(saturne_scene(), key, otherwise, &text));
    return text;
}

void saturne_check_keys(void) {
    const char *others = spar_case_others(saturne_scene());
    saturne_check_case(spar_case_check(saturne_scene()));
    if (others[0] != '\0') {
        char text[500];
        snprintf(text, sizeof text, "for another host, not used here: %s", others);
        saturne_tell(SPAR_LOG_INFO, text);
    }
}

/* A group that the mesh does not have would leave its faces uncoupled, or loose: nobody means that. */
static void refuse_selection(const char *what, const char *criterion, const char *missing) {
    const cs_mesh_t *mesh = cs_glob_mesh;
    char groups[400] = "none";
    size_t used = 0;
    for (int i = 0; i < mesh->n_groups && used + 80 < sizeof groups; i++) {
        used += (size_t)snprintf(groups + used, sizeof groups - used, "%s%.60s", i > 0 ? ", " : "",
                                 mesh->group + mesh->group_idx[i]);
    }
    bft_error(__FILE__, __LINE__, 0, "spar: %s '%s': the mesh has no boundary face of '%s'; its groups are %s", what,
              criterion, missing, groups);
}

cs_lnum_t saturne_faces(const char *what, const char *criterion, cs_lnum_t **faces) {
    const cs_mesh_t *mesh = cs_glob_mesh;
    cs_lnum_t n = 0;
    BFT_MALLOC(*faces, mesh->n_b_faces, cs_lnum_t);
    if (*criterion == '\0') {
        return 0;
    }
    const int id = fvm_selector_get_list(mesh->select_b_faces, criterion, 0, &n, *faces);
    cs_gnum_t all = (cs_gnum_t)n;
    cs_parall_counter(&all, 1);
    if (fvm_selector_n_missing(mesh->select_b_faces, id) > 0) {
        refuse_selection(what, criterion, fvm_selector_get_missing(mesh->select_b_faces, id, 0));
    } else if (all == 0) {
        refuse_selection(what, criterion, criterion);
    }
    return n;
}

void saturne_mark(const char *what, const char *criterion, int type, int *types) {
    cs_lnum_t *faces, n = saturne_faces(what, criterion, &faces);
    for (cs_lnum_t i = 0; i < n; i++) {
        types[faces[i]] = type;
    }
    BFT_FREE(faces);
}

/* ---- what flows have alike ---- */

static void set_precision(cs_field_t *field, double precision) {
    cs_var_cal_opt_t options;
    cs_field_get_key_struct(field, cs_field_key_id("var_cal_opt"), &options);
    options.epsilo = precision, options.epsrsm = 10 * precision;
    cs_field_set_key_struct(field, cs_field_key_id("var_cal_opt"), &options);
}

void saturne_steps(cs_domain_t *domain) {
    const double usual = 1e-8, precision = saturne_number("precision", &usual);
    cs_get_glob_time_step_options()->idtvar = 0;
    cs_get_glob_time_step()->dt_ref = saturne_number("dt", NULL);
    cs_get_glob_time_step()->nt_max = (int)saturne_number("steps", NULL);
    (void)domain;
    set_precision(CS_F_(vel), precision);
    set_precision(CS_F_(p), precision);
    if (cs_glob_ale != CS_ALE_NONE) {
        set_precision(CS_F_(mesh_u), precision);
    }
}

void saturne_centre(void) {
    cs_var_cal_opt_t scheme;
    cs_field_get_key_struct(CS_F_(vel), cs_field_key_id("var_cal_opt"), &scheme);
    scheme.blencv = 1, scheme.ischcv = 1, scheme.isstpc = 1;
    cs_field_set_key_struct(CS_F_(vel), cs_field_key_id("var_cal_opt"), &scheme);
}

double saturne_ramp(double t, double over) {
    return t < over ? 0.5 * (1 - cos(acos(-1.) * t / over)) : 1;
}

/* ---- the clock ---- */

static double spar_seconds, began; /* s of processor time, of this rank */

static double processor_seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

void saturne_clock_begin(void) {
    began = processor_seconds();
}

void saturne_clock_end(void) {
    spar_seconds += processor_seconds() - began;
}

void saturne_clock_read(double seconds[2]) {
    seconds[0] = spar_seconds, seconds[1] = processor_seconds();
    cs_parall_sum(2, CS_DOUBLE, seconds);
}

#if SATURNE_VERSION < 80
/* Without an XML file the library's own version of this one stops the run. */
void CS_PROCF(cs_f_user_boundary_conditions, CS_F_USER_BOUNDARY_CONDITIONS)(void) {
}
#endif
