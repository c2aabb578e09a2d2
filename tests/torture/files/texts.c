/* Text files of others, with mistakes: BeamDyn's, AeroDyn's and those of cases, with bytes, numbers, words and lines
   changed, lost, doubled and exchanged. What is refused says why and leaves beam, sections and session as they were;
   what is read harms nothing.

       texts [cases] [seed]

   The files of a case that goes wrong stay in the folder that is printed. */
#include "scene.h"

#include "case.h"
#include <signal.h>
#include <spar/spar_aero.h>
#include <stdio.h>
#include <time.h>
#include <unistd.h>

enum { LIMIT = 30, MOST = 1 << 16, NODES = 6, STATIONS = 19, FILES = 5 };

static char home[64], name[256];
static uint64_t dice = 1;
static long refusals;

static int roll(int n) {
    dice ^= dice << 13, dice ^= dice >> 7, dice ^= dice << 17;
    return (int)(dice % (uint64_t)n);
}

static void fault(const char *what, int status, const char *message) {
    (void)fprintf(stderr, "texts: %s: %s (status %d: %s); see %s\n", name, what, status, message, home);
    exit(1);
}

static void must(int status, const spar_session *s) {
    if (status != SPAR_OK) {
        fault("a good call fails", status, spar_session_message(s));
    }
}

static void too_long(int signal_number) {
    (void)signal_number;
    (void)!write(2, "texts: waits: ", 14);
    (void)!write(2, name, strlen(name));
    _exit(3);
}

/* ---- texts ---- */

typedef struct text {
    size_t n;
    char *bytes; /* [MOST] */
} text;

static text load(const char *path) {
    text t = {0, calloc(MOST, 1)};
    FILE *file = fopen(path, "r");
    if (!file || !t.bytes) {
        fault(path, SPAR_ERR_IO, "cannot be read");
        return t;
    }
    t.n = fread(t.bytes, 1, MOST - 1, file);
    (void)fclose(file);
    return t;
}

static void store(const char *path, const text *t) {
    FILE *file = fopen(path, "w");
    if (!file || fwrite(t->bytes, 1, t->n, file) != t->n || fclose(file) != 0) {
        fault(path, SPAR_ERR_IO, "cannot be written");
    }
}

/* n bytes at `at` become what is given. */
static void replace(text *t, size_t at, size_t n, const char *with, size_t m) {
    n = n < t->n - at ? n : t->n - at;
    if (t->n - n + m < MOST) {
        memmove(t->bytes + at + m, t->bytes + at + n, t->n - at - n);
        memcpy(t->bytes + at, with, m);
        t->n += m - n;
    }
}

static int is_end(char c) {
    return c == ' ' || c == '\n' || c == '\t';
}

/* Begin of the word or line (its ends: stop) that a place is in, and its length. */
static size_t part_at(const text *t, size_t at, int line, size_t *n) {
    size_t begin = at, end = at;
    while (begin > 0 && (line ? t->bytes[begin - 1] != '\n' : !is_end(t->bytes[begin - 1]))) {
        begin--;
    }
    while (end < t->n && (line ? t->bytes[end] != '\n' : !is_end(t->bytes[end]))) {
        end++;
    }
    *n = end - begin + (line && end < t->n);
    return begin;
}

static void spoil(text *t) {
    static const char *const word[] = {"",     "0",   "-1", "2.5",    "1e300", "nan", "inf",   "1e-320",
                                       "0x10", "1d2", "[",  "\"x",    "word",  "#",   "1,2",   "7",
                                       "!",    "@x",  "'",  "999999", "]",     ".",   "x y z", "\xff\xfe"};
    char copy[256];
    size_t n, at = t->n ? (size_t)roll((int)t->n) : 0, begin;
    switch (roll(7)) {
    case 0: /* a byte */
        copy[0] = (char)(roll(3) ? 32 + roll(95) : roll(256));
        replace(t, at, (size_t)roll(2), copy, 1);
        break;
    case 1: /* a word */
    case 2:
        begin = part_at(t, at, 0, &n);
        n += n == 0;
        const char *with = word[roll((int)(sizeof word / sizeof *word))];
        replace(t, begin, n, with, strlen(with));
        break;
    case 3: /* a line is lost */
        begin = part_at(t, at, 1, &n);
        replace(t, begin, n, "", 0);
        break;
    case 4: /* doubled, or moved */
    case 5:
        begin = part_at(t, at, 1, &n);
        n = n < sizeof copy ? n : sizeof copy;
        memcpy(copy, t->bytes + begin, n);
        if (roll(2)) {
            replace(t, begin, n, "", 0);
            begin = part_at(t, t->n ? (size_t)roll((int)t->n) : 0, 1, &at);
        }
        replace(t, begin, 0, copy, n);
        break;
    default: /* the end is lost */
        t->n = roll(4) ? t->n : at;
    }
}

/* ---- readers ---- */

static void refused(int status, const char *message, const char *call) {
    refusals++;
    if (status < SPAR_ERR_ARGUMENT || status > SPAR_ERR_LIMIT || !message[0]) {
        fault("answers without a word", status, message);
    } else if (call && strncmp(message, call, strlen(call)) != 0) {
        fault("does not name the call", status, message);
    }
}

static spar_member *good_beam(spar_session *s) {
    double K[36], M[36];
    scene_box(K, M);
    return scene_beam(s, "blade", 1, NODES, 60, K, M);
}

static void beamdyn(void) {
    double x[3 * NODES], good[3 * NODES], q[4 * NODES];
    spar_session *s = scene_session();
    spar_member *b = good_beam(s), *other = NULL;
    int status = spar_beam_read_beamdyn(b, "primary.inp", NULL);
    if (status != SPAR_OK) {
        refused(status, spar_session_message(s), "spar_beam_read_beamdyn: ");
        spar_session *twin = scene_session();
        other = good_beam(twin);
        must(spar_member_commit(other), twin);
        must(spar_member_commit(b), s);
        must(spar_member_get_reference(other, good, q), twin);
        must(spar_member_get_reference(b, x, q), s);
        spar_session_destroy(&twin);
        if (memcmp(x, good, sizeof x) != 0) {
            fault("the beam is not as it was", status, "");
        }
    } else if ((status = spar_member_commit(b)) != SPAR_OK) {
        refused(status, spar_session_message(s), "spar_member_commit: ");
    }
    spar_session_destroy(&s);
}

/* Solved in a still wind: sections that were read are whole. */
static void blow(spar_session *s, spar_aero *aero) {
    double inflow[3 * STATIONS] = {0};
    int status = spar_aero_solve(aero, 1, inflow, 0);
    if (status != SPAR_OK) {
        refused(status, spar_session_message(s), "spar_aero_solve: ");
    }
}

static void aerodyn(const char *good) {
    double eta[2][STATIONS];
    int64_t n = 0;
    spar_session *s = scene_session();
    spar_member *b = good_beam(s);
    spar_fluid *f = NULL;
    spar_aero *aero = NULL;
    must(spar_member_commit(b), s);
    must(spar_fluid_create(b, "air", &f), s);
    must(spar_fluid_read_aerodyn(f, good, NULL, NULL, 0, NULL), s);
    must(spar_fluid_map(f), s);
    must(spar_fluid_get_map(f, SPAR_NODES_MOTION, eta[0], NULL, NULL), s);
    must(spar_aero_create(1, &f, &aero), s);
    must(spar_aero_read_aerodyn(aero, good, NULL, NULL, NULL), s);
    int status = spar_aero_read_aerodyn(aero, "primary.dat", NULL, NULL, NULL);
    if (status != SPAR_OK) {
        refused(status, spar_session_message(s), "spar_aero_read_aerodyn: ");
    }
    blow(s, aero);
    status = spar_fluid_read_aerodyn(f, "primary.dat", "blade.dat", NULL, 0, NULL);
    if (status != SPAR_OK) {
        refused(status, spar_session_message(s), "spar_fluid_read_aerodyn: ");
        must(spar_fluid_get_count(f, SPAR_NODES_MOTION, &n), s);
        must(n == STATIONS ? spar_fluid_get_map(f, SPAR_NODES_MOTION, eta[1], NULL, NULL) : SPAR_ERR_STATE, s);
        if (memcmp(eta[0], eta[1], sizeof eta[0]) != 0) {
            fault("the sections are not as they were", status, "");
        }
    } else if ((status = spar_fluid_map(f)) != SPAR_OK) {
        refused(status, spar_session_message(s), "spar_fluid_map: ");
    }
    spar_aero_destroy(&aero);
    spar_session_destroy(&s);
}

static void read_case(void) {
    spar_session *s = scene_session();
    spar_case *c = NULL;
    double number[2];
    const char *word = NULL;
    int status = spar_case_read("a.case", "host", s, &c);
    if ((status == SPAR_OK) != (c != NULL)) {
        fault("answers one thing and gives another", status, spar_case_message());
    } else if (status != SPAR_OK) {
        refused(status, spar_case_message(), NULL);
    } else {
        (void)spar_case_get_text(c, "member", "none", &word);
        (void)spar_case_get_numbers(c, "fade", 2, NULL, number);
        (void)spar_case_check(c);
    }
    spar_case_free(&c);
    spar_session_destroy(&s);
}

/* ---- all of it ---- */

typedef struct deck {
    const char *folder, *from[FILES], *to[FILES]; /* all are put there; the first `spoilt` may go wrong */
    int spoilt;
} deck;

static const char a_case[] = SPAR_SOURCE_DIR "/tests/torture/files/texts.case";

static void run(const deck *d, int which, long number) {
    int at = roll(d->spoilt);
    char path[512];
    for (int i = 0; i < FILES && d->from[i]; i++) {
        (void)snprintf(path, sizeof path, "%s%s", d->folder, d->from[i]);
        text t = load(path);
        for (int k = i == at ? 1 + roll(3) : 0; k > 0; k--) {
            spoil(&t);
        }
        store(d->to[i], &t);
        free(t.bytes);
    }
    (void)snprintf(name, sizeof name, "case %ld, %s", number, d->to[at]);
    (void)alarm(LIMIT);
    if (which == 0) {
        beamdyn();
    } else if (which == 1) {
        aerodyn(SPAR_SOURCE_DIR "/tests/data/aerodyn/primary.dat");
    } else {
        read_case();
    }
}

int main(int argc, char **argv) {
    static const deck decks[] = {
        {SPAR_SOURCE_DIR "/tests/data/", {"bend_primary.inp", "bend_blade.inp"}, {"primary.inp", "bend_blade.inp"}, 2},
        {SPAR_SOURCE_DIR "/tests/data/aerodyn/",
         {"primary.dat", "blade.dat", "Cylinder1.dat", "DU35_A17.dat", "DU40_A17.dat"},
         {"primary.dat", "blade.dat", "Cylinder1.dat", "DU35_A17.dat", "DU40_A17.dat"},
         5},
        {"", {a_case}, {"a.case"}, 1},
    };
    static const char *const rest[] = {"Cylinder2", "DU30_A17", "DU25_A17", "DU21_A17", "NACA64_A17"};
    const char *base = getenv("TMPDIR");
    char command[512];
    long n = argc > 1 ? strtol(argv[1], NULL, 0) : 3000;
    dice = argc > 2 ? strtoull(argv[2], NULL, 0) : (uint64_t)time(NULL);
    printf("texts: %ld cases, seed %llu\n", n, (unsigned long long)dice);
    dice = dice * UINT64_C(0x9E3779B97F4A7C15) | 1;
    (void)signal(SIGALRM, too_long);
    (void)snprintf(home, sizeof home, "%.40s/spar-texts-XXXXXX", base ? base : "/tmp");
    if (!mkdtemp(home) || chdir(home) != 0) {
        return 2;
    }
    for (size_t i = 0; i < sizeof rest / sizeof *rest; i++) {
        (void)snprintf(command, sizeof command, SPAR_SOURCE_DIR "/tests/data/aerodyn/%s.dat", rest[i]);
        text t = load(command);
        (void)snprintf(command, sizeof command, "%s.dat", rest[i]);
        store(command, &t);
        free(t.bytes);
    }
    for (long k = 0; k < n; k++) {
        run(decks + k % 3, (int)(k % 3), k);
    }
    (void)alarm(0);
    printf("texts: %ld refusals\n", refusals);
    if (n >= 300 && (refusals < n / 10 || refusals > 2 * n)) { /* of up to two a case */
        fault("refuses nothing, or everything", SPAR_OK, "");
    }
    (void)snprintf(command, sizeof command, "rm -rf '%s'", home);
    return chdir("/") != 0 || system(command) != 0;
}
