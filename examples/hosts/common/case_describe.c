/* What the text of a case says, done: settings, members, their loads, joints. */
#if !defined(_XOPEN_SOURCE) && !defined(_POSIX_C_SOURCE)
#define _POSIX_C_SOURCE 200809L
#endif
#include "case_parts.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

enum { FREE_MOTIONS = 6, MOST_STATIONS = 1000000 };

/* A call of spar, for a line of the file. */
#define DO(c, number, call) CASE_TRY(case_told(c, number, call))

/* ---- settings ---- */

int case_on_or_off(const spar_case *c, const case_line *line, int *on) {
    static const char *const words[] = {"off", "on", NULL};
    return case_choice(&c->text, line, 1, words, on);
}

static int set_coupling(const spar_case *c, const case_block *block) {
    static const char *const schemes[] = {"explicit", "fixed-point", "aitken", "iqn-ils", NULL};
    const case_line *how = case_find(block, "scheme"), *atol = case_find(block, "atol"),
                    *rtol = case_find(block, "rtol"), *most = case_find(block, "max_iterations");
    int scheme, limit;
    double a, r;
    int64_t whole;
    const case_line *line = how ? how : atol ? atol : rtol ? rtol : most;
    if (!line) {
        return SPAR_OK;
    }
    DO(c, 0, spar_session_get_coupling(c->session, &scheme, &a, &r, &limit));
    whole = limit;
    CASE_TRY(how ? case_choice(&c->text, how, 1, schemes, &scheme) : SPAR_OK);
    CASE_TRY(atol ? case_numbers(&c->text, atol, 1, 1, &a) : SPAR_OK);
    CASE_TRY(rtol ? case_numbers(&c->text, rtol, 1, 1, &r) : SPAR_OK);
    CASE_TRY(most ? case_whole(&c->text, most, 1, 1, INT_MAX, &whole) : SPAR_OK);
    DO(c, line->number, spar_session_set_coupling(c->session, scheme, a, r, (int)whole));
    return SPAR_OK;
}

static int set_integrator(const spar_case *c, const case_block *block) {
    const case_line *rho = case_find(block, "rho_inf"), *sub = case_find(block, "substeps");
    double r;
    int substeps;
    int64_t whole;
    if (!rho && !sub) {
        return SPAR_OK;
    }
    DO(c, 0, spar_session_get_integrator(c->session, &r, &substeps));
    whole = substeps;
    CASE_TRY(rho ? case_numbers(&c->text, rho, 1, 1, &r) : SPAR_OK);
    CASE_TRY(sub ? case_whole(&c->text, sub, 1, 1, INT_MAX, &whole) : SPAR_OK);
    DO(c, rho ? rho->number : sub->number, spar_session_set_integrator(c->session, r, (int)whole));
    return SPAR_OK;
}

static int set_rest(const spar_case *c, const case_block *block) {
    const case_line *line = case_find(block, "gravity");
    double x[3];
    int64_t whole;
    int on;
    if (line) {
        CASE_TRY(case_numbers(&c->text, line, 1, 3, x));
        DO(c, line->number, spar_session_set_gravity(c->session, x));
    }
    if ((line = case_find(block, "newton"))) {
        CASE_TRY(case_numbers(&c->text, line, 1, 2, x));
        CASE_TRY(case_whole(&c->text, line, 3, 1, INT_MAX, &whole));
        DO(c, line->number, spar_session_set_newton(c->session, x[0], x[1], (int)whole));
    }
    if ((line = case_find(block, "relaxation"))) {
        CASE_TRY(case_numbers(&c->text, line, 1, 1, x));
        DO(c, line->number, spar_session_set_relaxation(c->session, x[0]));
    }
    if ((line = case_find(block, "predictor"))) {
        CASE_TRY(case_whole(&c->text, line, 1, 0, 2, &whole));
        DO(c, line->number, spar_session_set_predictor(c->session, (int)whole));
    }
    if ((line = case_find(block, "reproducible"))) {
        CASE_TRY(case_on_or_off(c, line, &on));
        DO(c, line->number, spar_session_set_reproducible(c->session, on));
    }
    for (int64_t at = 0; (line = case_next(block, "option", &at));) {
        DO(c, line->number, spar_session_set_option(c->session, line->word[1], line->word[2]));
    }
    return SPAR_OK;
}

/* What holds for all hosts first, then what is this one's. */
int case_set_session(const spar_case *c) {
    for (int own = 0; own < 2; own++) {
        for (int64_t b = 0; b < c->text.n; b++) {
            const case_block *block = c->text.block + b;
            if (case_is(block, "session") && case_is_for(block, c->host) && own == (block->name[0] != '\0')) {
                CASE_TRY(set_coupling(c, block));
                CASE_TRY(set_integrator(c, block));
                CASE_TRY(set_rest(c, block));
            }
        }
    }
    return SPAR_OK;
}

/* ---- members ---- */

/* Rows of a key, or of the file that another key names: as many numbers in each as there are in the first. */
typedef struct rows {
    int64_t n;
    int width, line; /* of the first row, for messages */
    double *x;
} rows;

static int read_rows(const case_text *text, const case_block *block, const char *key, int first, rows *r) {
    const case_line *line;
    int64_t n = 0;
    for (int64_t at = 0; (line = key ? case_next(block, key, &at) : at < block->n ? block->line + at++ : NULL);) {
        int width = line->n + 1 - first;
        r->width = n == 0 ? width : r->width;
        r->line = n == 0 ? line->number : r->line;
        if (width != r->width) {
            return case_fail(text, line->number, SPAR_ERR_ARGUMENT,
                             "%s has %d numbers where the first one, in line %d, has %d; give all the same number",
                             line->label, width, r->line, r->width);
        }
        n++;
    }
    if (n > MOST_STATIONS) {
        return case_fail(text, r->line, SPAR_ERR_ARGUMENT, "%lld rows are more than %d", (long long)n, MOST_STATIONS);
    }
    r->x = calloc((size_t)(n * r->width) + 1, sizeof *r->x);
    if (!r->x) {
        return case_fail(text, r->line, SPAR_ERR_MEMORY, "no memory for %lld rows", (long long)n);
    }
    for (int64_t at = 0; r->n < n; r->n++) {
        line = key ? case_next(block, key, &at) : block->line + r->n;
        CASE_TRY(case_numbers(text, line, first, r->width, r->x + r->n * r->width));
    }
    return SPAR_OK;
}

/* A file beside the case file: text is to be freed in any case. */
static int read_beside(const spar_case *c, const case_line *line, case_text *text) {
    char *path = case_beside(&c->text, line->word[1]);
    int status = path ? case_text_read(text, path, 0) : case_no_memory(c);
    free(path);
    return status;
}

/* x is to be freed by the caller in any case. */
static int gather(const spar_case *c, const case_block *block, const char *key, const char *file_key, rows *r) {
    const case_line *file = case_find(block, file_key), *row = case_find(block, key);
    if (!file) {
        return read_rows(&c->text, block, key, 1, r);
    }
    if (row) {
        return case_fail(&c->text, row->number, SPAR_ERR_ARGUMENT, "%s and %s (line %d) are both given; keep one", key,
                         file_key, file->number);
    }
    case_text table = {0};
    int status = read_beside(c, file, &table);
    status = status == SPAR_OK ? read_rows(&table, table.block, NULL, 0, r) : status;
    if (status == SPAR_OK && r->n == 0) {
        status = case_fail(&table, 0, SPAR_ERR_IO, "has no row of numbers; give at least one");
    }
    r->line = file->number;
    case_text_free(&table);
    return status;
}

/* Columns first to first + k - 1 of the rows, packed behind one another from x + at on. */
static double *columns(const rows *r, int first, int k, double *to) {
    for (int64_t i = 0; i < r->n; i++) {
        memcpy(to + i * k, r->x + i * r->width + first, (size_t)k * sizeof *to);
    }
    return to;
}

static int set_axis(const spar_case *c, const case_block *block, spar_member *beam, const rows *r) {
    const case_line *line = case_find(block, "twist_scale");
    double scale = 1;
    CASE_TRY(line ? case_numbers(&c->text, line, 1, 1, &scale) : SPAR_OK);
    if (r->width != 4 && r->width != 5) {
        return case_fail(&c->text, r->line, SPAR_ERR_ARGUMENT,
                         "a row of the axis has %d numbers; give eta x y z, and "
                         "twist if there is any",
                         r->width);
    }
    double *all = calloc(5 * (size_t)r->n, sizeof *all);
    if (!all) {
        return case_no_memory(c);
    }
    double *eta = columns(r, 0, 1, all), *xyz = columns(r, 1, 3, all + r->n), *twist = all + 4 * r->n;
    for (int64_t i = 0; r->width == 5 && i < r->n; i++) {
        twist[i] = r->x[5 * i + 4] * scale;
    }
    int status = spar_beam_set_axis(beam, r->n, eta, xyz, r->width == 5 ? twist : NULL);
    free(all);
    return case_told(c, r->line, status);
}

static int set_nodes(const spar_case *c, spar_member *beam, const rows *r) {
    if (r->width != 3 && r->width != 7) {
        return case_fail(&c->text, r->line, SPAR_ERR_ARGUMENT,
                         "a node has %d numbers; give x y z, and qw qx qy qz if its section frame matters", r->width);
    }
    double *all = calloc(7 * (size_t)r->n, sizeof *all);
    if (!all) {
        return case_no_memory(c);
    }
    double *x = columns(r, 0, 3, all), *q = r->width == 7 ? columns(r, 3, 4, all + 3 * r->n) : NULL;
    int status = spar_beam_set_nodes(beam, r->n, x, q);
    free(all);
    return case_told(c, r->line, status);
}

static int set_sections(const spar_case *c, spar_member *beam, const rows *r) {
    int per = r->width - 1, form = per % 2 == 0 && per != 6 && per != 36 ? per / 2 : per, mass = form != per;
    if (form != 6 && form != 21 && form != 36) {
        return case_fail(
            &c->text, r->line, SPAR_ERR_ARGUMENT,
            "a row of the sections has %d numbers; give eta and 6, 21 or 36 of the stiffness, then as many "
            "of the mass, or none",
            r->width);
    }
    double *all = calloc(73 * (size_t)r->n, sizeof *all);
    if (!all) {
        return case_no_memory(c);
    }
    double *eta = columns(r, 0, 1, all), *stiffness = all + r->n, *inertia = stiffness + 36 * r->n;
    for (int64_t i = 0; i < r->n; i++) {
        const double *row = r->x + i * r->width + 1;
        case_unfold(form, row, stiffness + 36 * i);
        case_unfold(form, mass ? row + form : row, inertia + 36 * i);
    }
    int status = spar_beam_set_sections(beam, r->n, eta, stiffness, mass ? inertia : NULL);
    free(all);
    return case_told(c, r->line, status);
}

/* Axis, nodes, sections: each by its rows, where there are any. */
static int set_rows(const spar_case *c, const case_block *block, spar_member *beam) {
    rows axis = {0}, node = {0}, section = {0};
    int status = gather(c, block, "axis", "axis_file", &axis);
    status = status == SPAR_OK ? read_rows(&c->text, block, "node", 1, &node) : status;
    status = status == SPAR_OK ? gather(c, block, "section", "sections_file", &section) : status;
    if (status == SPAR_OK && axis.n > 0 && node.n > 0) {
        status = case_fail(&c->text, node.line, SPAR_ERR_ARGUMENT,
                           "nodes and an axis (line %d) are both given; keep one", axis.line);
    }
    status = status == SPAR_OK && axis.n > 0 ? set_axis(c, block, beam, &axis) : status;
    status = status == SPAR_OK && node.n > 0 ? set_nodes(c, beam, &node) : status;
    status = status == SPAR_OK && section.n > 0 ? set_sections(c, beam, &section) : status;
    free(axis.x);
    free(node.x);
    free(section.x);
    return status;
}

static int set_beamdyn(const spar_case *c, const case_line *line, spar_member *beam) {
    char *primary = case_beside(&c->text, line->word[1]), *blade = NULL;
    int status = SPAR_OK;
    if (line->n > 1) {
        blade = case_beside(&c->text, line->word[2]);
        status = blade ? SPAR_OK : case_no_memory(c);
    }
    status = primary && status == SPAR_OK ? case_told(c, line->number, spar_beam_read_beamdyn(beam, primary, blade))
                                          : case_no_memory(c);
    free(primary);
    free(blade);
    return status;
}

static int set_fidelity(const spar_case *c, const case_line *line, spar_member *beam) {
    static const char *const names[] = {"prescribed", "rigid", "linear", "modal", "exact", NULL};
    int kind;
    int64_t modes = 0;
    CASE_TRY(case_choice(&c->text, line, 1, names, &kind));
    if ((kind == SPAR_FIDELITY_MODAL) != (line->n > 1)) {
        return case_fail(&c->text, line->number, SPAR_ERR_ARGUMENT,
                         "fidelity %s: modal is followed by its number of modes, the others by nothing", names[kind]);
    }
    CASE_TRY(line->n > 1 ? case_whole(&c->text, line, 2, 1, INT_MAX, &modes) : SPAR_OK);
    return case_told(c, line->number, spar_member_set_fidelity(beam, kind, modes));
}

/* Masses of a beam by their eta: a guess of what the fluid adds to it, or bodies that sit on it. */
static int set_masses(const spar_case *c, const case_block *block, const char *key,
                      int (*set)(spar_member *, int64_t, const double *, const double *), spar_member *beam) {
    rows r = {0};
    int status = read_rows(&c->text, block, key, 1, &r), form = r.width - 1;
    if (status == SPAR_OK && r.n > 0 && form != 6 && form != 21 && form != 36) {
        status = case_fail(&c->text, r.line, SPAR_ERR_ARGUMENT,
                           "a row of %s has %d numbers; give eta and 6, 21 or 36 of the mass%s", key, r.width,
                           set == spar_member_set_added_mass ? " per length" : "");
    }
    double *all = status == SPAR_OK && r.n > 0 ? calloc(37 * (size_t)r.n, sizeof *all) : NULL;
    if (status == SPAR_OK && r.n > 0) {
        status = all ? SPAR_OK : case_no_memory(c);
        double *eta = all ? columns(&r, 0, 1, all) : NULL;
        for (int64_t i = 0; all && i < r.n; i++) {
            case_unfold(form, r.x + i * r.width + 1, all + r.n + 36 * i);
        }
        status = status == SPAR_OK ? case_told(c, r.line, set(beam, r.n, eta, all + r.n)) : status;
    }
    free(all);
    free(r.x);
    return status;
}

/* Numbers of a beam by their eta, `width` a row: springs to the ground, or section forces of the reference. */
static int set_stations(const spar_case *c, const case_block *block, const char *key, int width,
                        int (*set)(spar_member *, int64_t, const double *, const double *), spar_member *beam) {
    rows r = {0};
    int status = read_rows(&c->text, block, key, 1, &r);
    double *all = status == SPAR_OK && r.n > 0 ? calloc((size_t)(r.n * r.width), sizeof *all) : NULL;
    if (status == SPAR_OK && r.n > 0) {
        status = all ? case_told(c, r.line, set(beam, r.n, columns(&r, 0, 1, all), columns(&r, 1, width, all + r.n)))
                     : case_no_memory(c);
    }
    free(all);
    free(r.x);
    return status;
}

static int set_response(const spar_case *c, const case_block *block, spar_member *member) {
    static const char *const names[] = {"acceleration", "velocity", NULL}; /* in the order of SPAR_RESPONSE_* */
    const case_line *line = case_find(block, "added_mass_response");
    int response;
    CASE_TRY(line ? case_choice(&c->text, line, 1, names, &response) : SPAR_OK);
    return line ? case_told(c, line->number, spar_member_set_added_mass_response(member, response)) : SPAR_OK;
}

static int describe_beam(const spar_case *c, const case_block *block, spar_member **beam) {
    static const char *const rules[] = {"gauss", "lobatto", "sections", NULL};
    const case_line *elements = case_find(block, "elements"), *nodes = case_find(block, "nodes"), *line;
    int64_t e = 1, p = 8, points;
    double mu[6];
    int rule;
    CASE_TRY(elements ? case_whole(&c->text, elements, 1, 1, INT_MAX, &e) : SPAR_OK);
    CASE_TRY(nodes ? case_whole(&c->text, nodes, 1, 1, INT_MAX, &p) : SPAR_OK);
    DO(c, nodes ? nodes->number : block->number, spar_beam_create(c->session, block->name, (int)e, (int)p, beam));
    line = case_find(block, "beamdyn");
    CASE_TRY(line ? set_beamdyn(c, line, *beam) : SPAR_OK);
    CASE_TRY(set_rows(c, block, *beam));
    if ((line = case_find(block, "quadrature"))) {
        CASE_TRY(case_choice(&c->text, line, 1, rules, &rule));
        CASE_TRY(case_whole(&c->text, line, 2, 1, INT_MAX, &points));
        DO(c, line->number, spar_beam_set_quadrature(*beam, rule, (int)points));
    }
    if ((line = case_find(block, "damping"))) {
        CASE_TRY(case_numbers(&c->text, line, 1, 6, mu));
        DO(c, line->number, spar_beam_set_damping(*beam, mu));
    }
    if ((line = case_find(block, "mass_damping"))) {
        CASE_TRY(case_numbers(&c->text, line, 1, 1, mu));
        DO(c, line->number, spar_beam_set_mass_damping(*beam, mu[0]));
    }
    if ((line = case_find(block, "plane"))) {
        CASE_TRY(case_numbers(&c->text, line, 1, 3, mu));
        DO(c, line->number, spar_beam_set_plane(*beam, mu));
    }
    CASE_TRY(set_masses(c, block, "added_mass", spar_member_set_added_mass, *beam));
    CASE_TRY(set_response(c, block, *beam));
    CASE_TRY(set_masses(c, block, "body", spar_beam_set_masses, *beam));
    CASE_TRY(set_stations(c, block, "foundation", 3, spar_beam_set_foundation, *beam));
    CASE_TRY(set_stations(c, block, "pretension", 6, spar_beam_set_pretension, *beam));
    line = case_find(block, "fidelity");
    return line ? set_fidelity(c, line, *beam) : SPAR_OK;
}

static int describe_rigid(const spar_case *c, const case_block *block, spar_member **body) {
    const case_line *line = case_find(block, "mass");
    double mass[36];
    if (!line) {
        return case_fail(&c->text, block->number, SPAR_ERR_ARGUMENT,
                         "[rigid %s] has no mass; give 6 numbers (m m m Jx Jy Jz), 21 or 36", block->name);
    }
    CASE_TRY(case_matrix(&c->text, line, mass));
    DO(c, line->number, spar_rigid_create(c->session, block->name, NULL, NULL, mass, body));
    if ((line = case_find(block, "added_mass"))) {
        CASE_TRY(case_matrix(&c->text, line, mass));
        DO(c, line->number, spar_member_set_added_mass(*body, 1, NULL, mass));
    }
    return set_response(c, block, *body);
}

/* Effects that a line names, 0 without a line. */
static int read_effects(const spar_case *c, const case_line *line, int *effects) {
    static const struct {
        const char *name;
        int bit; /* the session refuses large_rotation, and says which fidelity to choose */
    } all[] = {{"inertia", SPAR_EFFECT_INERTIA},
               {"gyroscopic", SPAR_EFFECT_GYROSCOPIC},
               {"gravity", SPAR_EFFECT_GRAVITY},
               {"damping", SPAR_EFFECT_DAMPING},
               {"large_rotation", 16},
               {"fluid_moment", SPAR_EFFECT_FLUID_MOMENT},
               {"fluid_history", SPAR_EFFECT_FLUID_HISTORY},
               {"work", SPAR_EFFECT_WORK},
               {"masses", SPAR_EFFECT_MASSES},
               {"foundation", SPAR_EFFECT_FOUNDATION},
               {"pretension", SPAR_EFFECT_PRETENSION}};
    enum { COUNT = sizeof all / sizeof *all };
    const char *names[COUNT + 1] = {NULL};
    int which;
    for (int i = 0; i < COUNT; i++) {
        names[i] = all[i].name;
    }
    *effects = 0;
    for (int i = 1; line && i <= line->n; i++) {
        CASE_TRY(case_choice(&c->text, line, i, names, &which));
        *effects |= all[which].bit;
    }
    return SPAR_OK;
}

static int set_effects(const spar_case *c, const case_block *block, spar_member *member) {
    const case_line *with = case_find(block, "effects_on"), *without = case_find(block, "effects_off");
    int on, off;
    CASE_TRY(read_effects(c, with, &on));
    CASE_TRY(read_effects(c, without, &off));
    return with || without
               ? case_told(c, without ? without->number : with->number, spar_member_set_effects(member, on, off))
               : SPAR_OK;
}

static int set_place(const spar_case *c, const case_block *block, spar_member *member) {
    const case_line *place = case_find(block, "place"), *turn = case_find(block, "orientation");
    double x[3], q[4];
    CASE_TRY(place ? case_numbers(&c->text, place, 1, 3, x) : SPAR_OK);
    CASE_TRY(turn ? case_numbers(&c->text, turn, 1, 4, q) : SPAR_OK);
    if (place || turn) {
        DO(c, turn ? turn->number : place->number,
           spar_member_set_placement(member, place ? x : NULL, turn ? q : NULL));
    }
    return SPAR_OK;
}

static int set_first_velocity(const spar_case *c, const case_block *block, spar_member *member) {
    static const char *const key[] = {"about", "velocity", "spin"};
    double x[3][3];
    const double *given[3] = {NULL};
    int number = 0;
    for (int i = 0; i < 3; i++) {
        const case_line *line = case_find(block, key[i]);
        if (line) {
            CASE_TRY(case_numbers(&c->text, line, 1, 3, x[i]));
            given[i] = x[i];
            number = line->number;
        }
    }
    if (number) {
        DO(c, number, spar_member_set_initial_velocity(member, given[0], given[1], given[2]));
    }
    return SPAR_OK;
}

static int describe_member(const spar_case *c, const case_block *block, spar_member **member) {
    static const char *const roots[] = {"free", "fixed", "pinned", "driven", NULL};
    const case_line *line;
    int choice;
    int64_t rank;
    if (case_is(block, "beam")) {
        CASE_TRY(describe_beam(c, block, member));
    } else if (case_is(block, "rigid")) {
        CASE_TRY(describe_rigid(c, block, member));
    } else {
        DO(c, block->number, spar_point_create(c->session, block->name, NULL, NULL, member));
    }
    CASE_TRY(set_place(c, block, *member));
    if ((line = case_find(block, "root"))) {
        CASE_TRY(case_choice(&c->text, line, 1, roots, &choice));
        DO(c, line->number, spar_member_set_root(*member, choice));
    }
    if ((line = case_find(block, "external"))) {
        CASE_TRY(case_on_or_off(c, line, &choice));
        DO(c, line->number, spar_member_set_external(*member, choice));
    }
    if ((line = case_find(block, "owner"))) {
        CASE_TRY(case_whole(&c->text, line, 1, 0, INT_MAX, &rank));
        DO(c, line->number, spar_member_set_owner(*member, (int)rank));
    }
    CASE_TRY(set_effects(c, block, *member));
    return set_first_velocity(c, block, *member);
}

static int is_member(const case_block *block) {
    return case_is(block, "beam") || case_is(block, "rigid") || case_is(block, "point");
}

static int is_joint(const case_block *block) {
    return case_is(block, "joint") || case_is(block, "line");
}

int case_describe_members(spar_case *c) {
    for (int64_t b = 0; b < c->text.n; b++) {
        if (is_member(c->text.block + b)) {
            CASE_TRY(describe_member(c, c->text.block + b, c->member + c->members));
            c->member_name[c->members++] = c->text.block[b].name;
        }
    }
    return SPAR_OK;
}

/* ---- what comes after the commit ---- */

static const char *const load_kinds[] = {"dead", "follower", NULL};

static int set_loads(const spar_case *c, const case_block *block, spar_member *member) {
    const case_line *line;
    for (int64_t at = 0; (line = case_next(block, "load", &at));) {
        int kind;
        int64_t node;
        double load[6];
        CASE_TRY(case_find_node(c, line, 1, member, &node));
        CASE_TRY(case_choice(&c->text, line, 2, load_kinds, &kind));
        CASE_TRY(case_numbers(&c->text, line, 3, 6, load));
        DO(c, line->number, spar_member_set_load(member, node, kind, load));
    }
    return SPAR_OK;
}

static int set_line_loads(const spar_case *c, const case_block *block, spar_member *beam) {
    for (int kind = SPAR_LOAD_DEAD; kind <= SPAR_LOAD_FOLLOWER; kind++) {
        const case_line *line;
        int64_t n = 0;
        int which, last = 0;
        double *x = calloc(7 * (size_t)block->n + 1, sizeof *x), *eta = x, *load = x ? x + block->n : NULL;
        int status = x ? SPAR_OK : case_no_memory(c);
        for (int64_t at = 0; status == SPAR_OK && (line = case_next(block, "line_load", &at));) {
            status = case_choice(&c->text, line, 1, load_kinds, &which);
            if (status == SPAR_OK && which == kind) {
                status = case_numbers(&c->text, line, 2, 1, eta + n);
                status = status == SPAR_OK ? case_numbers(&c->text, line, 3, 6, load + 6 * n) : status;
                last = line->number;
                n++;
            }
        }
        if (status == SPAR_OK && n > 0) {
            status = case_told(c, last, spar_beam_set_line_load(beam, kind, n, eta, load));
        }
        free(x);
        CASE_TRY(status);
    }
    return SPAR_OK;
}

static int set_modal_damping(const spar_case *c, const case_block *block, spar_member *beam) {
    const case_line *line = case_find(block, "modal_damping");
    int64_t mode[2];
    double ratio[2];
    if (!line) {
        return SPAR_OK;
    }
    for (int i = 0; i < 2; i++) {
        CASE_TRY(case_whole(&c->text, line, 1 + 2 * i, 0, INT_MAX, mode + i));
        CASE_TRY(case_numbers(&c->text, line, 2 + 2 * i, 1, ratio + i));
    }
    return case_told(c, line->number, spar_beam_set_modal_damping(beam, mode, ratio, NULL));
}

/* Collective calls first, each of which fails on all ranks or on none; the text is the same on all. */
int case_commit_members(const spar_case *c) {
    for (int pass = 0; pass < 3; pass++) {
        for (int64_t b = 0, m = 0; b < c->text.n; b++) {
            const case_block *block = c->text.block + b;
            if (!is_member(block)) {
                continue;
            }
            spar_member *member = c->member[m++];
            int beam = case_is(block, "beam");
            if (pass == 0) {
                DO(c, block->number, spar_member_commit(member));
            } else if (pass == 1) {
                CASE_TRY(beam ? set_modal_damping(c, block, member) : SPAR_OK);
            } else {
                CASE_TRY(set_loads(c, block, member));
                CASE_TRY(beam ? set_line_loads(c, block, member) : SPAR_OK);
            }
        }
    }
    return SPAR_OK;
}

/* ---- joints ---- */

static int find_motions(const spar_case *c, const case_line *line, int *mask) {
    static const char *const names[] = {"x", "y", "z", "rx", "ry", "rz", "none", "all", NULL};
    int which;
    *mask = 0;
    for (int i = 1; line && i <= line->n; i++) {
        CASE_TRY(case_choice(&c->text, line, i, names, &which));
        *mask |= which < FREE_MOTIONS ? 1 << which : which == FREE_MOTIONS ? 0 : (1 << FREE_MOTIONS) - 1;
    }
    return SPAR_OK;
}

/* An end of a joint: MEMBER NODE, or ground, which has no member. */
static int find_end(const spar_case *c, const case_block *block, const char *key, const case_line **line,
                    spar_member **member, int64_t *node) {
    *line = case_find(block, key);
    *member = NULL;
    *node = 0;
    if (!*line) {
        return case_fail(&c->text, block->number, SPAR_ERR_ARGUMENT, "[%s %s] has no end %s; give %s MEMBER NODE%s",
                         block->kind, block->name, key, key, key[0] == 'b' ? " or b ground" : "");
    }
    if (key[0] == 'b' && strcmp((*line)->word[1], "ground") == 0) {
        return SPAR_OK;
    }
    CASE_TRY(case_find_member(c, *line, 1, member));
    return case_find_node(c, *line, 2, *member, node);
}

/* Three 6-vectors and matrices of a joint that may be there. */
static int set_joint_spring(const spar_case *c, const case_block *block, spar_joint *joint) {
    const case_line *k = case_find(block, "stiffness"), *d = case_find(block, "damping"),
                    *p = case_find(block, "preload"),
                    *line = k   ? k
                            : d ? d
                                : p;
    double stiffness[36], damping[36], preload[6];
    CASE_TRY(k ? case_matrix(&c->text, k, stiffness) : SPAR_OK);
    CASE_TRY(d ? case_matrix(&c->text, d, damping) : SPAR_OK);
    CASE_TRY(p ? case_numbers(&c->text, p, 1, 6, preload) : SPAR_OK);
    if (line) {
        DO(c, line->number, spar_joint_set_spring(joint, k ? stiffness : NULL, d ? damping : NULL, p ? preload : NULL));
    }
    return SPAR_OK;
}

static int set_joint_frame(const spar_case *c, const case_block *block, spar_joint *joint, const spar_member *a,
                           int64_t node) {
    const case_line *place = case_find(block, "place"), *axes = case_find(block, "axes");
    int64_t nodes;
    double at[3], q[4];
    if (!place && !axes) {
        return SPAR_OK;
    }
    if (place) {
        CASE_TRY(case_numbers(&c->text, place, 1, 3, at));
    } else { /* where node a is, as without a frame */
        DO(c, axes->number, spar_member_get_count(a, &nodes));
        double *x = calloc(3 * (size_t)nodes, sizeof *x);
        int status = x ? case_told(c, axes->number, spar_member_get_reference(a, x, NULL)) : case_no_memory(c);
        if (status == SPAR_OK) {
            memcpy(at, x + 3 * node, sizeof at);
        }
        free(x);
        CASE_TRY(status);
    }
    CASE_TRY(axes ? case_numbers(&c->text, axes, 1, 4, q) : SPAR_OK);
    return case_told(c, axes ? axes->number : place->number, spar_joint_set_frame(joint, at, axes ? q : NULL));
}

static int describe_joint(const spar_case *c, const case_block *block, spar_joint **joint) {
    const case_line *a, *b, *line = case_find(block, "free");
    spar_member *member_a, *member_b;
    int64_t node_a, node_b;
    int mask;
    double load[6];
    CASE_TRY(find_end(c, block, "a", &a, &member_a, &node_a));
    CASE_TRY(find_end(c, block, "b", &b, &member_b, &node_b));
    CASE_TRY(find_motions(c, line, &mask));
    DO(c, block->number, spar_joint_create(c->session, block->name, member_a, node_a, member_b, node_b, mask, joint));
    CASE_TRY(set_joint_frame(c, block, *joint, member_a, node_a));
    CASE_TRY(set_joint_spring(c, block, *joint));
    if ((line = case_find(block, "driven"))) {
        CASE_TRY(find_motions(c, line, &mask));
        DO(c, line->number, spar_joint_set_driven(*joint, mask));
    }
    if ((line = case_find(block, "load"))) {
        CASE_TRY(case_numbers(&c->text, line, 1, 6, load));
        DO(c, line->number, spar_joint_set_load(*joint, load));
    }
    return SPAR_OK;
}

static int describe_line(const spar_case *c, const case_block *block, spar_joint **joint) {
    static const char *const key[] = {"stiffness", "damping", "length"};
    const case_line *a, *b, *line;
    spar_member *member_a, *member_b;
    int64_t node_a, node_b;
    double from[3], to[3], spring[3] = {0};
    int given = 0, tension = 0, on;
    CASE_TRY(find_end(c, block, "a", &a, &member_a, &node_a));
    CASE_TRY(find_end(c, block, "b", &b, &member_b, &node_b));
    CASE_TRY(case_numbers(&c->text, a, 3, 3, from));
    CASE_TRY(case_numbers(&c->text, b, member_b ? 3 : 2, 3, to));
    DO(c, block->number,
       spar_link_create(c->session, block->name, member_a, node_a, from, member_b, node_b, to, joint));
    for (int i = 0; i < 3; i++) {
        if ((line = case_find(block, key[i]))) {
            CASE_TRY(case_numbers(&c->text, line, 1, 1, spring + i));
            given = line->number;
        }
    }
    if ((line = case_find(block, "tension_only"))) {
        CASE_TRY(case_on_or_off(c, line, &tension));
        given = line->number;
    }
    if (given) {
        DO(c, given, spar_link_set_spring(*joint, spring[0], spring[1], spring[2], tension));
    }
    if ((line = case_find(block, "driven"))) {
        CASE_TRY(case_on_or_off(c, line, &on));
        DO(c, line->number, spar_joint_set_driven(*joint, on ? SPAR_FREE_X : 0));
    }
    return SPAR_OK;
}

int case_describe_joints(spar_case *c) {
    for (int64_t b = 0; b < c->text.n; b++) {
        const case_block *block = c->text.block + b;
        if (is_joint(block)) {
            spar_joint **joint = c->joint + c->joints;
            CASE_TRY(case_is(block, "joint") ? describe_joint(c, block, joint) : describe_line(c, block, joint));
            c->joint_name[c->joints++] = block->name;
        }
    }
    return SPAR_OK;
}
