/* Reads AeroDyn's input: the primary file (table columns, names of airfoil and blade files), the blade file, and its
   airfoil files. Formats: OpenFAST documentation, AeroDyn user's guide, input files. */
#include "../base/reader.h"
#include "aerodyn.h"
#include "message.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { COLUMN_ALPHA, COLUMN_CL, COLUMN_CD, COLUMN_CM, COLUMNS };
enum { MOST_COLUMN = 16 };

static const double degree = 3.14159265358979323846 / 180;

/* Contents of the primary file. */
typedef struct deck {
    int column[COLUMNS]; /* in the airfoil tables, from 1; 0: absent */
    int tables, airfoils, use_moment;
    char **airfoil; /* [airfoils] paths */
    char *blade;
} deck;

static void deck_free(deck *d) {
    for (int i = 0; d->airfoil && i < d->airfoils; i++) {
        free(d->airfoil[i]);
    }
    free(d->airfoil);
    free(d->blade);
}

void spari_blade_free(spari_blade *blade) {
    for (int i = 0; blade->airfoil && i < blade->airfoils; i++) {
        free(blade->airfoil[i].alpha);
    }
    free(blade->airfoil);
    free(blade->row);
}

/* ---- the primary file ---- */

/* Path in the first word of the line, relative to the file. */
static int read_path(spari_reader *r, const char *what, char **path) {
    char *word = r->word;
    const char *at = r->line;
    if (!spari_read_word(&at, word) || !word[0]) {
        return SPARI_READ_FAIL(r, SPAR_ERR_IO, "%s is missing", what);
    }
    *path = spari_read_beside(r, word);
    return *path ? SPAR_OK : spari_read_no_memory(r);
}

static int read_flag(spari_reader *r, const char *what, int *flag) {
    char *word = r->word;
    const char *at = r->line;
    (void)spari_read_word(&at, word);
    const char *c = word + (word[0] == '.'); /* Fortran's .true. */
    if (!strchr("tTfF", *c) || !*c) {
        return SPARI_READ_FAIL(r, SPAR_ERR_IO, "%s is '%s'; give True or False", what, word);
    }
    *flag = *c == 't' || *c == 'T';
    return SPAR_OK;
}

static int read_columns(spari_reader *r, deck *d) {
    static const char *const key[COLUMNS] = {"InCol_Alfa", "InCol_Cl", "InCol_Cd", "InCol_Cm"};
    for (int i = 0; i < COLUMNS; i++) {
        SPARI_TRY(spari_read_key(r, key[i]));
        SPARI_TRY(spari_read_whole(r, key[i], i == COLUMN_CM ? 0 : 1, 0, &d->column[i]));
        if (d->column[i] > MOST_COLUMN) {
            return SPARI_READ_FAIL(r, SPAR_ERR_IO, "%s is %d; at most %d columns are supported", key[i], d->column[i],
                                   MOST_COLUMN);
        }
    }
    return SPAR_OK;
}

/* Reads on to the line of the blade file, with key ADBlFile(1), or ADBlFile in older files. */
static int find_blade(spari_reader *r) {
    char *word = r->word;
    for (;;) {
        SPARI_TRY(spari_read_line(r, "ADBlFile(1)"));
        const char *at = r->line;
        if (spari_read_word(&at, word) && spari_read_word(&at, word) && strncasecmp(word, "ADBlFile", 8) == 0) {
            return SPAR_OK;
        }
    }
}

static int read_deck(spari_reader *r, deck *d, int find_the_blade) {
    SPARI_TRY(spari_read_key(r, "AFTabMod"));
    SPARI_TRY(spari_read_whole(r, "AFTabMod", 1, 0, &d->tables));
    SPARI_TRY(read_columns(r, d));
    SPARI_TRY(spari_read_key(r, "NumAFfiles"));
    SPARI_TRY(spari_read_whole(r, "NumAFfiles", 1, 0, &d->airfoils));
    d->airfoil = spari_zalloc(d->airfoils, sizeof *d->airfoil);
    if (!d->airfoil) {
        return spari_read_no_memory(r);
    }
    for (int i = 0; i < d->airfoils; i++) {
        SPARI_TRY(spari_read_line(r, "the name of an airfoil file"));
        SPARI_TRY(read_path(r, "the name of an airfoil file", &d->airfoil[i]));
    }
    SPARI_TRY(spari_read_key(r, "UseBlCm"));
    SPARI_TRY(read_flag(r, "UseBlCm", &d->use_moment));
    if (find_the_blade) {
        SPARI_TRY(find_blade(r));
        SPARI_TRY(read_path(r, "ADBlFile(1)", &d->blade));
    }
    return SPAR_OK;
}

/* ---- the blade file ---- */

static int read_station(spari_reader *r, const deck *d, spari_blade *b, int i) {
    static const char fields[] = "BlSpn, BlCrvAC, BlSwpAC, BlCrvAng, BlTwist, BlChord, BlAFID";
    double *row = b->row + (int64_t)i * SPARI_BLADE_COLUMNS;
    int airfoil = 0;
    SPARI_TRY(spari_read_line(r, "a station of the blade"));
    SPARI_TRY(spari_read_numbers(r, fields, SPARI_BLADE_COLUMNS, row));
    SPARI_TRY(spari_read_whole(r, "BlAFID", 1, SPARI_BLADE_AIRFOIL, &airfoil));
    if (airfoil > d->airfoils) {
        return SPARI_READ_FAIL(r, SPAR_ERR_IO, "BlAFID is %d; the primary file names %d airfoils", airfoil,
                               d->airfoils);
    }
    if (i > 0 && !(row[SPARI_BLADE_SPAN] > row[SPARI_BLADE_SPAN - SPARI_BLADE_COLUMNS])) {
        return SPARI_READ_FAIL(r, SPAR_ERR_IO, "BlSpn is %g and is not above the previous one (%g)",
                               row[SPARI_BLADE_SPAN], row[SPARI_BLADE_SPAN - SPARI_BLADE_COLUMNS]);
    }
    if (row[SPARI_BLADE_CHORD] < 0) {
        return SPARI_READ_FAIL(r, SPAR_ERR_IO, "BlChord is %g; give a length >= 0", row[SPARI_BLADE_CHORD]);
    }
    row[SPARI_BLADE_CURVE_ANGLE] *= degree;
    row[SPARI_BLADE_TWIST] *= degree;
    return SPAR_OK;
}

static int read_stations(spari_reader *r, const deck *d, spari_blade *b) {
    SPARI_TRY(spari_read_key(r, "NumBlNds"));
    SPARI_TRY(spari_read_whole(r, "NumBlNds", 2, 0, &b->stations));
    b->row = spari_zalloc((int64_t)b->stations * SPARI_BLADE_COLUMNS, sizeof *b->row);
    if (!b->row) {
        return spari_read_no_memory(r);
    }
    SPARI_TRY(spari_read_line(r, "the header of the stations"));
    SPARI_TRY(spari_read_line(r, "the units of the stations"));
    for (int i = 0; i < b->stations; i++) {
        SPARI_TRY(read_station(r, d, b, i));
    }
    return SPAR_OK;
}

/* ---- an airfoil file ---- */

/* The next line that is not blank or a comment, which begins with one of !#%. */
static int read_data(spari_reader *r, const char *what) {
    do {
        SPARI_TRY(spari_read_filled(r, what));
        r->line[strcspn(r->line, "!#%")] = '\0';
    } while (!r->line[strspn(r->line, " \t\r\n,")]);
    return SPAR_OK;
}

/* Reads on to the line with a key. Coordinates, lines that include files of them (@"...") and the coefficients of
   unsteady aerodynamics precede the keys and are skipped. */
static int find_data(spari_reader *r, const char *key, int *interpolation) {
    char *word = r->word;
    for (;;) {
        SPARI_TRY(read_data(r, key));
        const char *at = r->line;
        int cubic = spari_read_word(&at, word) && strcmp(word, "3") == 0;
        if (!spari_read_word(&at, word)) {
            continue;
        }
        if (strcasecmp(word, key) == 0) {
            return SPAR_OK;
        }
        if (strcasecmp(word, "InterpOrd") == 0) { /* 1, 3 or "DEFAULT", which is 1 */
            *interpolation = cubic ? SPAR_POLAR_CUBIC : SPAR_POLAR_LINEAR;
        }
    }
}

static int read_rows(spari_reader *r, const deck *d, spari_airfoil *a) {
    double x[MOST_COLUMN];
    int last = 0;
    for (int i = 0; i < COLUMNS; i++) {
        last = d->column[i] > last ? d->column[i] : last;
    }
    for (int64_t i = 0; i < a->n; i++) {
        SPARI_TRY(read_data(r, "a row of the table"));
        SPARI_TRY(spari_read_numbers(r, "a row of the table", last, x));
        a->alpha[i] = x[d->column[COLUMN_ALPHA] - 1] * degree;
        a->cl[i] = x[d->column[COLUMN_CL] - 1];
        a->cd[i] = x[d->column[COLUMN_CD] - 1];
        a->cm[i] = d->use_moment && d->column[COLUMN_CM] ? x[d->column[COLUMN_CM] - 1] : 0;
        if (i > 0 && !(a->alpha[i] > a->alpha[i - 1])) {
            return SPARI_READ_FAIL(r, SPAR_ERR_IO, "alpha is %g deg and is not above the previous row (%g)",
                                   a->alpha[i] / degree, a->alpha[i - 1] / degree);
        }
    }
    return SPAR_OK;
}

/* Checks a polar as the library does, with file and line in the message. */
static int check_polar(const spari_reader *r, const spari_airfoil *a) {
    spar_polar *polar = NULL;
    int status = spar_polar_create(a->n, a->alpha, a->cl, a->cd, a->cm, &polar);
    status = status == SPAR_OK ? spar_polar_set_interpolation(polar, a->kind) : status;
    if (status != SPAR_OK) {
        char why[SPARI_MESSAGE_SIZE / 2];
        (void)snprintf(why, sizeof why, "%s", spar_session_message(NULL));
        status = SPARI_READ_FAIL(r, status, "the table that ends here: %s", why);
    }
    spar_polar_destroy(&polar);
    return status;
}

/* The first table; further ones are for other Reynolds numbers or controls, which AFTabMod 1 ignores. */
static int read_airfoil(spari_reader *r, const deck *d, spari_airfoil *a) {
    int tables = 0, rows = 0;
    SPARI_TRY(find_data(r, "NumTabs", &a->kind));
    SPARI_TRY(spari_read_whole(r, "NumTabs", 1, 0, &tables));
    if (tables > 1 && d->tables > 1) {
        return SPARI_READ_FAIL(r, SPAR_ERR_UNSUPPORTED,
                               "%d tables with interpolation (AFTabMod %d) are not supported; use one table, or "
                               "AFTabMod 1 to read the first",
                               tables, d->tables);
    }
    SPARI_TRY(find_data(r, "NumAlf", &a->kind));
    SPARI_TRY(spari_read_whole(r, "NumAlf", 2, 0, &rows));
    a->n = rows;
    a->alpha = spari_zalloc(4 * a->n, sizeof *a->alpha);
    if (!a->alpha) {
        return spari_read_no_memory(r);
    }
    a->cl = a->alpha + a->n, a->cd = a->cl + a->n, a->cm = a->cd + a->n;
    SPARI_TRY(read_rows(r, d, a));
    return check_polar(r, a);
}

/* ---- all of them ---- */

static int read_airfoils(spari_reader *r, const deck *d, spari_blade *b) {
    b->airfoils = d->airfoils;
    b->airfoil = spari_zalloc(b->airfoils, sizeof *b->airfoil);
    if (!b->airfoil) {
        return spari_read_no_memory(r);
    }
    for (int64_t i = 0; i < b->stations; i++) {
        int which = (int)b->row[i * SPARI_BLADE_COLUMNS + SPARI_BLADE_AIRFOIL] - 1;
        if (b->airfoil[which].n == 0) {
            SPARI_TRY(spari_read_open(r, d->airfoil[which]));
            int status = read_airfoil(r, d, &b->airfoil[which]);
            (void)fclose(r->file);
            SPARI_TRY(status);
        }
    }
    return SPAR_OK;
}

int spari_blade_read(spari_blade *blade, const spar_session *session, const char *call, const char *subject,
                     const char *primary_path, const char *blade_path, int polars) {
    deck d = {0};
    spari_reader *r = spari_zalloc(1, sizeof *r);
    SPARI_AERO_REQUIRE(session, r, SPAR_ERR_MEMORY, "%s: no memory for '%s'", call, subject);
    r->fail = spari_aero_fail;
    r->session = session;
    r->call = call;
    r->subject = subject;
    int status = spari_read_open(r, primary_path);
    if (status == SPAR_OK) {
        status = read_deck(r, &d, !blade_path);
        (void)fclose(r->file);
    }
    status = status == SPAR_OK ? spari_read_open(r, blade_path ? blade_path : d.blade) : status;
    if (status == SPAR_OK) {
        status = read_stations(r, &d, blade);
        (void)fclose(r->file);
    }
    status = status == SPAR_OK && polars ? read_airfoils(r, &d, blade) : status;
    deck_free(&d);
    free(r);
    return status;
}
