/* What the files of a case share: its text (headings, lines, words, numbers), how mistakes in it are told, and what it
   has become. */
#ifndef SPAR_CASE_PARTS_H
#define SPAR_CASE_PARTS_H

#include "case.h"

#include <fenv.h>
#include <spar/spar_aero.h>
#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct case_line {
    int number, used;  /* in the file, from 1 */
    int n;             /* values behind the key */
    char **word;       /* [1 + n], the key first */
    const char *label; /* for messages: the key */
} case_line;

typedef struct case_block {
    int number;
    const char *kind, *name; /* name "" where the heading has none */
    int64_t n;
    case_line *line;
} case_block;

typedef struct case_text {
    char *path, *bytes; /* of which all words are parts */
    char **word;
    case_line *line;
    int64_t n;
    case_block *block;
} case_text;

/* Lines under headings; or, headings 0, a table: rows of numbers, in one block without kind. Returns a spar status;
   text is to be freed in any case. */
int case_text_read(case_text *text, const char *path, int headings);
void case_text_free(case_text *text);

/* Writes the message of this thread, with file and line where they are given (line 0: none). Returns `status`. */
int case_fail(const case_text *text, int line, int status, const char *format, ...)
#if defined(__GNUC__)
    __attribute__((format(printf, 4, 5)))
#endif
    ;
#ifdef __clang_analyzer__ /* reads one file at a time: what it must know is that a failure is never 0 */
#define case_fail(text, line, status, ...) ((case_fail)(text, line, status, __VA_ARGS__) ? (status) ? (status) : 1 : 1)
#endif
const char *case_message(void);

/* First line of the block with this key, from line *from on, which then is the one behind it; NULL: no more. */
const case_line *case_next(const case_block *block, const char *key, int64_t *from);
const case_line *case_find(const case_block *block, const char *key);

/* Numbers first to first + n - 1 of the line's words; what: for the message. */
int case_numbers(const case_text *text, const case_line *line, int first, int n, double *x);
int case_whole(const case_text *text, const case_line *line, int i, int64_t low, int64_t high, int64_t *x);
/* The place of a word among others, that end in NULL. */
int case_choice(const case_text *text, const case_line *line, int i, const char *const *choices, int *choice);
/* Of the numbers of a line from the first on: 6, 21 or 36 of them. */
int case_matrix(const case_text *text, const case_line *line, double matrix[36]);
/* The matrix of the 6 numbers of its diagonal, the 21 of its upper triangle or all 36. */
void case_unfold(int form, const double *from, double matrix[36]);

/* The one of n names that is most like the word; "" of none. */
const char *case_nearest(const char *word, int64_t n, const char *const *names);
/* How many letters must be put in, taken out or changed to get from one word to the other. */
int case_distance(const char *a, const char *b);
/* From here to the end numbers have a point, whatever the host's locale, are rounded to the nearest, and one that is
   too large raises no signal. */
typedef struct case_quiet {
    void *point, *host;
    fenv_t environment;
} case_quiet;
int case_quiet_begin(case_quiet *quiet);
void case_quiet_end(case_quiet *quiet);
/* path beside the case file; malloc'd, NULL: no memory. */
char *case_beside(const case_text *text, const char *path);

typedef struct case_watch {
    spar_member *member;
    int64_t node, nodes;
} case_watch;

typedef struct case_output {
    const char *folder; /* a part of the text, as the path */
    const char *history_path;
    int64_t every, watches;
    int fluids, headed;
    const char *save_path; /* NULL: nothing is saved */
    int64_t save_every;
    FILE *history;
    case_watch *watch;
    double *q, *v, *load; /* of the watched member with the most nodes */
} case_output;

/* Blade elements, on rank 0. */
typedef struct case_air {
    const char *name; /* a part of the text */
    spar_aero *aero;
    int blades;
    spar_fluid **fluid; /* [blades] */
    double density, *inflow;
} case_air;

enum { CASE_ASKS = 64, CASE_NAME = 32 };

struct spar_case {
    spar_session *session;
    char *host; /* NULL: none */
    char others[400];
    case_text text;
    int64_t members, joints;
    const char **member_name, **joint_name; /* parts of the text */
    spar_member **member;
    spar_joint **joint;
    int asks;                       /* keys that the host has asked for, */
    char ask[CASE_ASKS][CASE_NAME]; /* for the nearest name to a misspelt one */
    char **joined; /* [lines of the text] the values of a line of the host as one text, NULL: not asked for */
    case_output output;
    int64_t airs;
    case_air *air;       /* [airs] */
    int blown, restarts; /* the host has called spar_case_make_aero, spar_case_restart */
};

#define CASE_TRY(call)                                                                                                 \
    do {                                                                                                               \
        int status_ = (call);                                                                                          \
        if (status_ != SPAR_OK) {                                                                                      \
            return status_;                                                                                            \
        }                                                                                                              \
    } while (0)

/* Every heading and key is known, stands as often as it may, and has as many values as it takes. */
int case_check_text(const case_text *text);
int case_is(const case_block *block, const char *kind);
/* Whether a block holds for the host: it bears no host's name, or this one's. */
int case_is_for(const case_block *block, const char *host);
/* The status of a call of spar; a failure's message becomes that of the line. */
int case_told(const spar_case *c, int line, int status);
static inline int case_no_memory(const spar_case *c) {
    return case_fail(&c->text, 0, SPAR_ERR_MEMORY, "no memory");
}
/* What a rank alone has found wrong is known to all. Collective. */
int case_agree(const spar_case *c, int status);
int case_on_or_off(const spar_case *c, const case_line *line, int *on);
/* The member that value i of the line names, and the node that value i + 1 does. */
int case_find_member(const spar_case *c, const case_line *line, int i, spar_member **member);
int case_find_node(const spar_case *c, const case_line *line, int i, const spar_member *member, int64_t *node);

/* What the text says, in this order; only the third is collective. */
int case_set_session(const spar_case *c);
int case_describe_members(spar_case *c);
int case_commit_members(const spar_case *c);
int case_describe_joints(spar_case *c);
/* [output] into scene->output, and its end. */
int case_output_read(spar_case *c);
void case_output_free(case_output *output);
void case_air_free(spar_case *c);

#ifdef __cplusplus
}
#endif

#endif
