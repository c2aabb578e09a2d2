/* Reads AeroDyn's input: the primary file (table columns, names of airfoil and blade files), the blade file, and its
   airfoil files. Formats: OpenFAST documentation, AeroDyn user's guide, input files. */
#include "../base/reader.h"
#include "aerodyn.h"
#include "message.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { COLUMN_ALPHA, COLUMN_CL, COLUMN_CD, COLUMN_CM, COLUMNS };
enum { MOST_COLUMN = 16 };

/* Equal angles of two tables, rad. */
#define SPARI_ROW_SLACK 1e-9
#define SPARI_TURN (2.0 * 3.14159265358979323846)

static const double degree = 3.14159265358979323846 / 180;

/* Contents of the primary file. */
typedef struct deck {
    int column[COLUMNS]; /* in the airfoil tables, from 1; 0: absent */
    int last;            /* of these */
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

/* Reads AFTabMod, which older files lack, and the columns of the tables. */
static int read_columns(spari_reader *r, deck *d) {
    static const char *const key[COLUMNS] = {"InCol_Alfa", "InCol_Cl", "InCol_Cd", "InCol_Cm"};
    d->tables = 1;
    for (int found = 0; !found;) {
        const char *at;
        SPARI_TRY(spari_read_line(r, key[COLUMN_ALPHA]));
        at = r->line;
        if (!spari_read_word(&at, r->word) || !spari_read_word(&at, r->word)) {
            continue;
        }
        found = strcasecmp(r->word, key[COLUMN_ALPHA]) == 0;
        if (strcasecmp(r->word, "AFTabMod") == 0) {
            SPARI_TRY(spari_read_whole(r, "AFTabMod", 1, 0, &d->tables));
        }
        if (d->tables > 3) {
            return SPARI_READ_FAIL(r, SPAR_ERR_IO, "AFTabMod is %d; give 1, 2 or 3", d->tables);
        }
    }
    for (int i = 0; i < COLUMNS; i++) {
        SPARI_TRY(i > 0 ? spari_read_key(r, key[i]) : SPAR_OK);
        SPARI_TRY(spari_read_whole(r, key[i], i == COLUMN_CM ? 0 : 1, 0, &d->column[i]));
        if (d->column[i] > MOST_COLUMN) {
            return SPARI_READ_FAIL(r, SPAR_ERR_IO, "%s is %d; at most %d columns are supported", key[i], d->column[i],
                                   MOST_COLUMN);
        }
        d->last = d->column[i] > d->last ? d->column[i] : d->last;
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
    if (i == 0 && row[SPARI_BLADE_SPAN] != 0) {
        return SPARI_READ_FAIL(r, SPAR_ERR_IO, "BlSpn of the first station is %g; it must be 0, the blade's root",
                               row[SPARI_BLADE_SPAN]);
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
    return spari_read_last(r, "NumBlNds", b->stations, SPARI_BLADE_COLUMNS);
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
    for (int64_t i = 0; i < a->n; i++) {
        SPARI_TRY(read_data(r, "a row of the table"));
        SPARI_TRY(spari_read_numbers(r, "a row of the table", d->last, x));
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

/* ---- polars ---- */

int spari_airfoil_polar(const spari_airfoil *a, spar_polar **polar) {
    SPARI_TRY(spar_polar_create(a->n, a->alpha, a->cl, a->cd, a->cm, polar));
    int status = spar_polar_set_interpolation(*polar, a->kind);
    if (status != SPAR_OK) {
        spar_polar_destroy(polar);
    }
    return status;
}

/* All angles of both tables, each once, over one full circle at most. */
static int64_t merge_rows(const spari_airfoil *a, const spari_airfoil *b, double *alpha) {
    int64_t n = 0;
    for (int64_t i = 0, j = 0; i < a->n || j < b->n;) {
        double next = j == b->n || (i < a->n && a->alpha[i] <= b->alpha[j]) ? a->alpha[i++] : b->alpha[j++];
        if (n == 0 || next > alpha[n - 1] + SPARI_ROW_SLACK) {
            alpha[n++] = next;
        }
    }
    if (alpha[n - 1] - alpha[0] > SPARI_TURN - SPARI_ROW_SLACK) { /* a full circle ends where it began */
        while (alpha[n - 1] - alpha[0] > SPARI_TURN - SPARI_ROW_SLACK) {
            n--;
        }
        alpha[n++] = alpha[0] + SPARI_TURN;
    }
    return n;
}

int spari_airfoil_blend(const spari_airfoil *a, const spari_airfoil *b, double t, spari_airfoil *c) {
    spar_polar *part[2] = {NULL, NULL};
    int64_t most = a->n + b->n;
    double *x = spari_zalloc(4 * most, sizeof *x);
    int status = x ? SPAR_OK : SPAR_ERR_MEMORY;
    status = status == SPAR_OK ? spari_airfoil_polar(a, &part[0]) : status;
    status = status == SPAR_OK ? spari_airfoil_polar(b, &part[1]) : status;
    if (status == SPAR_OK) {
        *c = (spari_airfoil){.kind = a->kind == b->kind ? a->kind : SPAR_POLAR_LINEAR, .alpha = x};
        double *column[] = {x + most, x + 2 * most, x + 3 * most};
        c->n = merge_rows(a, b, x);
        c->cl = column[0], c->cd = column[1], c->cm = column[2];
        for (int64_t i = 0; i < c->n; i++) {
            double of[2][3] = {{0}};
            for (int k = 0; k < 2; k++) {
                (void)spar_polar_evaluate(part[k], x[i], &of[k][0], &of[k][1], &of[k][2]);
            }
            for (int k = 0; k < 3; k++) {
                column[k][i] = of[0][k] + t * (of[1][k] - of[0][k]);
            }
        }
    } else {
        free(x);
    }
    spar_polar_destroy(&part[0]);
    spar_polar_destroy(&part[1]);
    return status != SPAR_OK;
}

/* Checks a polar as the library does, with file and line in the message. */
static int check_polar(const spari_reader *r, const spari_airfoil *a) {
    spar_polar *polar = NULL;
    int status = spari_airfoil_polar(a, &polar);
    if (status != SPAR_OK) {
        char why[SPARI_MESSAGE_SIZE / 2];
        (void)snprintf(why, sizeof why, "%s", spar_session_message(NULL));
        status = SPARI_READ_FAIL(r, status, "the table that ends here: %s", why);
    }
    spar_polar_destroy(&polar);
    return status;
}

static int read_table(spari_reader *r, const deck *d, int last, spari_airfoil *a) {
    int rows = 0;
    SPARI_TRY(find_data(r, "NumAlf", &a->kind));
    SPARI_TRY(spari_read_whole(r, "NumAlf", 2, 0, &rows));
    a->n = rows;
    a->alpha = spari_zalloc(4 * a->n, sizeof *a->alpha);
    if (!a->alpha) {
        return spari_read_no_memory(r);
    }
    a->cl = a->alpha + a->n, a->cd = a->cl + a->n, a->cm = a->cd + a->n;
    SPARI_TRY(read_rows(r, d, a));
    SPARI_TRY(check_polar(r, a));
    return last ? spari_read_last(r, "NumAlf", rows, d->last) : SPAR_OK;
}

/* The table of control setting 0, which AeroDyn uses if no controller moves the flaps: linear between two neighbours,
   beyond the last ones the nearest. */
static int read_of_control(spari_reader *r, const deck *d, int tables, spari_airfoil *a) {
    spari_airfoil side[2] = {{0}, {0}}; /* the nearest tables below 0, and at or above it */
    double setting[2] = {-HUGE_VAL, HUGE_VAL}, last = -HUGE_VAL;
    int status = SPAR_OK;
    for (int i = 0; i < tables && status == SPAR_OK; i++) {
        spari_airfoil now = {.kind = a->kind};
        double x = 0;
        status = find_data(r, "UserProp", &now.kind);
        status = status == SPAR_OK ? spari_read_numbers(r, "UserProp", 1, &x) : status;
        if (status == SPAR_OK && !(x > last)) {
            status = SPARI_READ_FAIL(r, SPAR_ERR_IO, "UserProp is %g and is not above that of the previous table (%g)",
                                     x, last);
        }
        status = status == SPAR_OK ? read_table(r, d, i == tables - 1, &now) : status;
        int k = x >= 0;
        if (status == SPAR_OK && fabs(x) < fabs(setting[k])) {
            free(side[k].alpha);
            side[k] = now, setting[k] = x;
        } else {
            free(now.alpha);
        }
        last = x;
    }
    if (status == SPAR_OK && side[0].n && side[1].n && setting[1] > 0) {
        status = spari_airfoil_blend(&side[0], &side[1], setting[0] / (setting[0] - setting[1]), a)
                     ? spari_read_no_memory(r)
                     : SPAR_OK;
    } else if (status == SPAR_OK) {
        int k = side[1].n > 0;
        *a = side[k];
        side[k].alpha = NULL;
    }
    free(side[0].alpha);
    free(side[1].alpha);
    return status;
}

static int read_airfoil(spari_reader *r, const deck *d, spari_airfoil *a) {
    int tables = 0;
    SPARI_TRY(find_data(r, "NumTabs", &a->kind));
    SPARI_TRY(spari_read_whole(r, "NumTabs", 1, 0, &tables));
    if (tables > 1 && d->tables == 2) {
        return SPARI_READ_FAIL(r, SPAR_ERR_UNSUPPORTED,
                               "%d tables for Reynolds numbers (AFTabMod %d) are not supported; use one table, or "
                               "AFTabMod 1 to read the first",
                               tables, d->tables);
    }
    return tables > 1 && d->tables == 3 ? read_of_control(r, d, tables, a) : read_table(r, d, tables == 1, a);
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
