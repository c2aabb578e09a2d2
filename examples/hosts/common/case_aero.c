/* [aero NAME]: blade elements that a case brings with it, in a steady wind: sections on members, their chords and
   polars, the rotor. Rank 0 has them; the members may be solved anywhere. */
#if !defined(_XOPEN_SOURCE) && !defined(_POSIX_C_SOURCE)
#define _POSIX_C_SOURCE 200809L
#endif
#include "case_parts.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

/* A call of spar, for a line of the file. */
#define DO(c, number, call) CASE_TRY(case_told(c, number, call))

enum { MOST_SECTIONS = 100000, MOST_ROWS = 100000 };

/* ---- sections by their rows ---- */

/* The polar of a file beside the case file: rows alpha (rad) cl cd, and cm in all of them or in none. */
static int read_polar(const spar_case *c, const case_line *line, spar_polar **polar) {
    case_text table = {0};
    char *path = case_beside(&c->text, line->word[4]);
    int status = path ? case_text_read(&table, path, 0) : case_no_memory(c);
    const int64_t n = status == SPAR_OK && table.n > 0 ? table.block->n : 0;
    const int width = n > 0 ? table.block->line[0].n + 1 : 0;
    if (status == SPAR_OK && (width < 3 || width > 4 || n > MOST_ROWS)) {
        status = case_fail(&table, 0, SPAR_ERR_ARGUMENT,
                           "is no polar; give rows of alpha (rad), cl, cd and, in all or none, cm");
    }
    double *x = status == SPAR_OK ? calloc(8 * (size_t)n, sizeof *x) : NULL, *column[4] = {NULL};
    status = status == SPAR_OK && !x ? case_no_memory(c) : status;
    for (int64_t i = 0; x && status == SPAR_OK && i < n; i++) {
        const case_line *row = table.block->line + i;
        status = row->n + 1 == width ? case_numbers(&table, row, 0, width, x + 4 * (n + i))
                                     : case_fail(&table, row->number, SPAR_ERR_ARGUMENT,
                                                 "has %d numbers where the first row has %d; give all the same number",
                                                 row->n + 1, width);
        for (int k = 0; k < 4; k++) {
            column[k] = x + k * n;
            column[k][i] = x[4 * (n + i) + k];
        }
    }
    if (status == SPAR_OK) {
        status = spar_polar_create(n, column[0], column[1], column[2], width == 4 ? column[3] : NULL, polar);
        status = status == SPAR_OK ? SPAR_OK : case_fail(&table, 0, status, "%s", spar_session_message(NULL));
    }
    free(x);
    free(path);
    case_text_free(&table);
    return status;
}

static int set_section(const spar_case *c, const case_line *line, int64_t i, spar_aero *aero) {
    spar_polar *polar = NULL;
    double x[3];
    CASE_TRY(case_numbers(&c->text, line, 1, 3, x));
    CASE_TRY(read_polar(c, line, &polar));
    int status = case_told(c, line->number, spar_aero_set_section(aero, i, x[1], x[2], polar));
    spar_polar_destroy(&polar);
    return status;
}

/* The places of the rows on one blade. */
static int place_rows(const spar_case *c, const case_block *block, int64_t n, spar_fluid *fluid) {
    const case_line *line;
    double *eta = calloc(4 * (size_t)n, sizeof *eta), *offset = eta ? eta + n : NULL;
    int status = eta ? SPAR_OK : case_no_memory(c), number = block->number;
    for (int64_t at = 0, i = 0; status == SPAR_OK && (line = case_next(block, "section", &at)); i++) {
        number = line->number;
        status = line->n == 4 || line->n == 6
                     ? case_numbers(&c->text, line, 1, 1, eta + i)
                     : case_fail(&c->text, number, SPAR_ERR_ARGUMENT,
                                 "section has %d values; give eta chord twist POLAR, and y z if it is off the line",
                                 line->n);
        status = status == SPAR_OK && line->n == 6 ? case_numbers(&c->text, line, 5, 2, offset + 3 * i + 1) : status;
    }
    status = status == SPAR_OK ? case_told(c, number, spar_fluid_set_stations(fluid, n, eta, offset)) : status;
    free(eta);
    return status;
}

/* ---- sections by AeroDyn's files ---- */

typedef struct aerodyn_files {
    const case_line *line; /* NULL: rows */
    char *primary, *blade;
    double q[4], *span;
    const double *axes;
    int64_t n; /* 0: the stations of the file */
} aerodyn_files;

static int find_files(const spar_case *c, const case_block *block, aerodyn_files *f) {
    const case_line *axes = case_find(block, "axes"), *even = case_find(block, "stations");
    double ends[2];
    f->line = case_find(block, "aerodyn");
    if (!f->line) {
        return axes || even ? case_fail(&c->text, (axes ? axes : even)->number, SPAR_ERR_ARGUMENT,
                                        "%s applies to AeroDyn's files alone; give aerodyn PRIMARY, or remove it",
                                        (axes ? axes : even)->label)
                            : SPAR_OK;
    }
    f->primary = case_beside(&c->text, f->line->word[1]);
    f->blade = f->line->n > 1 ? case_beside(&c->text, f->line->word[2]) : NULL;
    if (!f->primary || (f->line->n > 1 && !f->blade)) {
        return case_no_memory(c);
    }
    CASE_TRY(axes ? case_numbers(&c->text, axes, 1, 4, f->q) : SPAR_OK);
    f->axes = axes ? f->q : NULL;
    if (even) {
        CASE_TRY(case_whole(&c->text, even, 1, 2, MOST_SECTIONS, &f->n));
        CASE_TRY(case_numbers(&c->text, even, 2, 2, ends));
        f->span = calloc((size_t)f->n, sizeof *f->span);
        for (int64_t i = 0; f->span && i < f->n; i++) {
            f->span[i] = ends[0] + (ends[1] - ends[0]) * (double)i / (double)(f->n - 1);
        }
        return f->span ? SPAR_OK : case_no_memory(c);
    }
    return SPAR_OK;
}

static void free_files(aerodyn_files *f) {
    free(f->primary);
    free(f->blade);
    free(f->span);
}

/* ---- one [aero] ---- */

static int make_fluids(const spar_case *c, const case_block *block, const aerodyn_files *f, int64_t rows,
                       case_air *air) {
    const case_line *blades = case_find(block, "blades");
    if (!blades || (rows > 0) == (f->line != NULL)) {
        return case_fail(&c->text, block->number, SPAR_ERR_ARGUMENT,
                         "[aero %s] needs blades MEMBER ..., and either aerodyn PRIMARY or rows of section",
                         block->name);
    }
    air->fluid = calloc((size_t)blades->n, sizeof(spar_fluid *));
    if (!air->fluid) {
        return case_no_memory(c);
    }
    for (; air->blades < blades->n; air->blades++) {
        spar_member *member;
        spar_fluid **fluid = air->fluid + air->blades;
        char name[128];
        (void)snprintf(name, sizeof name, "%.100s.%d", block->name, air->blades + 1);
        CASE_TRY(case_find_member(c, blades, 1 + air->blades, &member));
        DO(c, blades->number, spar_fluid_create(member, name, fluid));
        if (f->line) {
            DO(c, f->line->number, spar_fluid_read_aerodyn(*fluid, f->primary, f->blade, f->axes, f->n, f->span));
        } else {
            CASE_TRY(place_rows(c, block, rows, *fluid));
        }
        DO(c, blades->number, spar_fluid_map(*fluid));
    }
    DO(c, block->number, spar_aero_create(air->blades, air->fluid, &air->aero));
    return SPAR_OK;
}

static int set_rotor(const spar_case *c, const case_block *block, spar_aero *aero) {
    const case_line *line;
    int64_t whole;
    double x[8];
    if ((line = case_find(block, "turn"))) {
        CASE_TRY(case_whole(&c->text, line, 1, -1, 1, &whole));
        DO(c, line->number, spar_aero_set_turn(aero, (int)whole));
    }
    if ((line = case_find(block, "total"))) {
        CASE_TRY(case_whole(&c->text, line, 1, 1, INT_MAX, &whole));
        DO(c, line->number, spar_aero_set_blades(aero, (int)whole));
    }
    if ((line = case_find(block, "rotor"))) {
        CASE_TRY(case_numbers(&c->text, line, 1, 8, x));
        DO(c, line->number, spar_aero_set_rotor(aero, x, x + 3, x[6], x[7]));
    }
    return SPAR_OK;
}

static int change_wind(const spar_case *c, const case_block *block, spar_aero *aero) {
    static const char *const laws[] = {"power", "log", "linear", NULL}; /* SPAR_SHEAR_* */
    const case_line *line;
    int law;
    double x[8];
    if ((line = case_find(block, "shear"))) {
        CASE_TRY(case_choice(&c->text, line, 1, laws, &law));
        CASE_TRY(case_numbers(&c->text, line, 2, 8, x));
        DO(c, line->number, spar_aero_set_shear(aero, law, x, x + 3, x[6], x[7]));
    }
    if ((line = case_find(block, "tower"))) {
        CASE_TRY(case_numbers(&c->text, line, 1, 8, x));
        DO(c, line->number, spar_aero_set_tower(aero, x, x + 3, x[6], x[7]));
    }
    return SPAR_OK;
}

static int choose_effects(const spar_case *c, const case_block *block, spar_aero *aero) {
    static const char *const names[] = {"induction", "tip_loss", "hub_loss", "swirl",    "drag", "moment", "shear",
                                        "tower",     "inflow",   "stall",    "unsteady", "none", NULL};
    const case_line *line = case_find(block, "effects");
    int effects = 0, which;
    for (int i = 1; line && i <= line->n; i++) {
        CASE_TRY(case_choice(&c->text, line, i, names, &which));
        effects |= names[which + 1] ? 1 << which : 0;
    }
    return line ? case_told(c, line->number, spar_aero_set_effects(aero, effects)) : SPAR_OK;
}

static int set_wind(const spar_case *c, const case_block *block, case_air *air) {
    const case_line *density = case_find(block, "density"), *wind = case_find(block, "wind");
    double u[3];
    int64_t n;
    if (!density || !wind) {
        return case_fail(&c->text, block->number, SPAR_ERR_ARGUMENT, "[aero %s] has no %s; give %s", block->name,
                         density ? "wind" : "density", density ? "wind x y z" : "density RHO");
    }
    CASE_TRY(case_numbers(&c->text, density, 1, 1, &air->density));
    CASE_TRY(case_numbers(&c->text, wind, 1, 3, u));
    DO(c, block->number, spar_fluid_get_count(air->fluid[0], SPAR_NODES_MOTION, &n));
    n *= 3 * air->blades;
    air->inflow = calloc((size_t)n, sizeof *air->inflow);
    for (int64_t i = 0; air->inflow && i < n; i++) {
        air->inflow[i] = u[i % 3];
    }
    return air->inflow ? SPAR_OK : case_no_memory(c);
}

static int make_air(const spar_case *c, const case_block *block, case_air *air) {
    aerodyn_files f = {0};
    int64_t rows = 0;
    const case_line *line;
    for (int64_t at = 0; case_next(block, "section", &at);) {
        rows++;
    }
    int status = find_files(c, block, &f);
    status = status == SPAR_OK ? make_fluids(c, block, &f, rows, air) : status;
    status = status == SPAR_OK ? set_rotor(c, block, air->aero) : status;
    if (status == SPAR_OK && f.line) {
        status = case_told(c, f.line->number, spar_aero_read_aerodyn(air->aero, f.primary, f.blade, f.axes, f.span));
    }
    for (int64_t at = 0, i = 0; status == SPAR_OK && (line = case_next(block, "section", &at)); i++) {
        status = set_section(c, line, i, air->aero);
    }
    status = status == SPAR_OK ? change_wind(c, block, air->aero) : status;
    status = status == SPAR_OK ? choose_effects(c, block, air->aero) : status;
    status = status == SPAR_OK ? set_wind(c, block, air) : status;
    free_files(&f);
    return status;
}

/* ---- all of them ---- */

static int make_all(spar_case *c) {
    case_quiet quiet;
    int status = case_quiet_begin(&quiet), numbers = status == SPAR_OK;
    c->air = calloc((size_t)c->text.n + 1, sizeof *c->air);
    status = status == SPAR_OK && !c->air ? case_no_memory(c) : status;
    for (int64_t b = 0; status == SPAR_OK && b < c->text.n; b++) {
        if (case_is(c->text.block + b, "aero")) {
            c->air[c->airs].name = c->text.block[b].name;
            status = make_air(c, c->text.block + b, c->air + c->airs++);
        }
    }
    if (numbers) {
        case_quiet_end(&quiet);
    }
    return status;
}

int spar_case_make_aero(spar_case *scene, int rank) {
    if (!scene || rank < 0) {
        return case_fail(NULL, 0, SPAR_ERR_ARGUMENT, "spar_case_make_aero: scene is NULL, or rank below 0");
    }
    int status = SPAR_OK;
    if (scene->blown) {
        status = case_fail(&scene->text, 0, SPAR_ERR_STATE, "spar_case_make_aero was called before");
    } else if (rank == 0) {
        status = make_all(scene);
    }
    scene->blown = 1;
    return case_agree(scene, status);
}

int spar_case_aero(const spar_case *scene, const char *name, spar_aero **aero) {
    if (!scene || !name || !aero) {
        return case_fail(NULL, 0, SPAR_ERR_ARGUMENT, "spar_case_aero: an argument is NULL");
    }
    for (int64_t i = 0; i < scene->airs; i++) {
        if (strcmp(scene->air[i].name, name) == 0) {
            *aero = scene->air[i].aero;
            return SPAR_OK;
        }
    }
    return case_fail(&scene->text, 0, SPAR_ERR_ARGUMENT,
                     "there is no [aero %.60s] on this rank; rank 0 has them, after spar_case_make_aero", name);
}

int64_t spar_case_aero_count(const spar_case *scene) {
    return scene ? scene->airs : 0;
}

spar_aero *spar_case_aero_at(const spar_case *scene, int64_t i, const char **name) {
    int there = scene && i >= 0 && i < scene->airs;
    if (there && name) {
        *name = scene->air[i].name;
    }
    return there ? scene->air[i].aero : NULL;
}

int spar_case_blow(spar_case *scene) {
    if (!scene) {
        return case_fail(NULL, 0, SPAR_ERR_ARGUMENT, "spar_case_blow: scene is NULL");
    }
    for (int64_t i = 0; i < scene->airs; i++) {
        DO(scene, 0, spar_aero_solve(scene->air[i].aero, scene->air[i].density, scene->air[i].inflow, 1.0));
    }
    return SPAR_OK;
}

void case_air_free(spar_case *c) {
    for (int64_t i = 0; i < c->airs; i++) {
        spar_aero_destroy(&c->air[i].aero);
        free(c->air[i].fluid);
        free(c->air[i].inflow);
    }
    free(c->air);
}
