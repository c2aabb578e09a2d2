/* The structure of a coupled run as a text file describes it: settings, members, joints, and what is written of them.
   case.h has the format. Made on the installed headers alone. */
#if !defined(_XOPEN_SOURCE) && !defined(_POSIX_C_SOURCE)
#define _POSIX_C_SOURCE 200809L
#endif
#include "case_parts.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A call of spar, for a line of the file. */
#define DO(c, number, call) CASE_TRY(case_told(c, number, call))

int case_told(const spar_case *c, int number, int status) {
    return status == SPAR_OK ? SPAR_OK : case_fail(&c->text, number, status, "%s", spar_session_message(c->session));
}

const char *spar_case_message(void) {
    return case_message();
}

/* Whether a block with settings holds for this host: named after no host, or after this one. */
int case_is_for(const case_block *block, const char *host) {
    return block->name[0] == '\0' || (host && strcmp(block->name, host) == 0);
}

static int is_of_host(const case_block *block) {
    return case_is(block, "session") || case_is(block, "output") || case_is(block, "host");
}

static void list_others(spar_case *c, const char *host) {
    size_t used = 0;
    for (int64_t b = 0; b < c->text.n && used + 1 < sizeof c->others; b++) {
        const case_block *block = c->text.block + b;
        if (is_of_host(block) && !case_is_for(block, host)) {
            const int n = snprintf(c->others + used, sizeof c->others - used, "%s[%s %.60s] (line %d)",
                                   used > 0 ? ", " : "", block->kind, block->name, block->number);
            used += n > 0 ? (size_t)n : 0;
        }
    }
}

const char *spar_case_others(const spar_case *scene) {
    return scene ? scene->others : "";
}

/* ---- the whole ---- */

static int open_case(spar_case *c, const char *path, const char *host) {
    CASE_TRY(case_text_read(&c->text, path, 1));
    CASE_TRY(case_check_text(&c->text));
    size_t blocks = (size_t)c->text.n + 1, lines = 1;
    for (int64_t b = 0; b < c->text.n; b++) {
        lines += (size_t)c->text.block[b].n;
    }
    list_others(c, host);
    c->host = host ? malloc(strlen(host) + 1) : NULL;
    c->member = calloc(blocks, sizeof(spar_member *));
    c->joint = calloc(blocks, sizeof(spar_joint *));
    c->member_name = calloc(blocks, sizeof(const char *));
    c->joint_name = calloc(blocks, sizeof(const char *));
    c->joined = calloc(lines, sizeof(char *));
    if ((host && !c->host) || !c->member || !c->joint || !c->member_name || !c->joint_name || !c->joined) {
        return case_no_memory(c);
    }
    if (host) {
        memcpy(c->host, host, strlen(host) + 1);
    }
    return SPAR_OK;
}

int case_agree(const spar_case *c, int status) {
    int all = spar_session_sum(c->session, status, 0, NULL);
    if (all != SPAR_OK && status == SPAR_OK) {
        const char *why = spar_session_message(c->session);
        return case_fail(&c->text, 0, all, "another rank failed: %s", why[0] ? why : "it has the message");
    }
    return status;
}

int spar_case_read(const char *path, const char *host, spar_session *session, spar_case **scene) {
    if (!session) {
        return case_fail(NULL, 0, SPAR_ERR_ARGUMENT, "spar_case_read: the session is NULL");
    }
    case_quiet quiet;
    spar_case *c = calloc(1, sizeof *c);
    int status = case_quiet_begin(&quiet), numbers = status == SPAR_OK;
    spar_case none = {.session = session};
    if (!c) {
        status = case_no_memory(&none);
    } else if (!path || !scene) {
        status = case_fail(NULL, 0, SPAR_ERR_ARGUMENT, "spar_case_read: path or scene is NULL");
    } else {
        c->session = session;
        status = status == SPAR_OK ? open_case(c, path, host) : status;
        status = status == SPAR_OK ? case_set_session(c) : status;
        status = status == SPAR_OK ? case_describe_members(c) : status;
    }
    status = case_agree(c ? c : &none, status);
    if (status == SPAR_OK) {
        status = case_commit_members(c);
        status = status == SPAR_OK ? case_describe_joints(c) : status;
        status = status == SPAR_OK ? case_output_read(c) : status;
        status = case_agree(c, status);
    }
    if (numbers) {
        case_quiet_end(&quiet);
    }
    if (status != SPAR_OK) {
        spar_case_free(&c);
        return status;
    }
    *scene = c;
    return SPAR_OK;
}

void spar_case_free(spar_case **scene) {
    if (!scene || !*scene) {
        return;
    }
    spar_case *c = *scene;
    int64_t lines = 0;
    for (int64_t b = 0; b < c->text.n; b++) {
        lines += c->text.block ? c->text.block[b].n : 0;
    }
    for (int64_t i = 0; c->joined && i < lines; i++) {
        free(c->joined[i]);
    }
    void *all[] = {c->host, c->member, c->joint, c->member_name, c->joint_name, c->joined, c};
    case_output_free(&c->output);
    case_air_free(c);
    case_text_free(&c->text);
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        free(all[i]);
    }
    *scene = NULL;
}

/* ---- look-ups ---- */

int64_t spar_case_member_count(const spar_case *scene) {
    return scene ? scene->members : 0;
}

spar_member *spar_case_member_at(const spar_case *scene, int64_t i) {
    return scene && i >= 0 && i < scene->members ? scene->member[i] : NULL;
}

/* The place of a name; -1, with a message: it is not there. line: that names it, 0: none. */
static int64_t place_of(const spar_case *c, int line, const char *what, const char *name, int64_t n,
                        const char *const *names) {
    for (int64_t i = 0; i < n; i++) {
        if (strcmp(names[i], name) == 0) {
            return i;
        }
    }
    if (n == 0) {
        (void)case_fail(&c->text, line, SPAR_ERR_ARGUMENT, "there is no %s '%.60s'; the case has none", what, name);
    } else {
        (void)case_fail(&c->text, line, SPAR_ERR_ARGUMENT, "there is no %s '%.60s'; did you mean '%s'?", what, name,
                        case_nearest(name, n, names));
    }
    return -1;
}

int spar_case_member(const spar_case *scene, const char *name, spar_member **member) {
    if (!scene || !name || !member) {
        return case_fail(NULL, 0, SPAR_ERR_ARGUMENT, "spar_case_member: an argument is NULL");
    }
    int64_t i = place_of(scene, 0, "member", name, scene->members, scene->member_name);
    *member = i < 0 ? *member : scene->member[i];
    return i < 0 ? SPAR_ERR_ARGUMENT : SPAR_OK;
}

int spar_case_joint(const spar_case *scene, const char *name, spar_joint **joint) {
    if (!scene || !name || !joint) {
        return case_fail(NULL, 0, SPAR_ERR_ARGUMENT, "spar_case_joint: an argument is NULL");
    }
    int64_t i = place_of(scene, 0, "joint", name, scene->joints, scene->joint_name);
    *joint = i < 0 ? *joint : scene->joint[i];
    return i < 0 ? SPAR_ERR_ARGUMENT : SPAR_OK;
}

int case_find_member(const spar_case *c, const case_line *line, int i, spar_member **member) {
    int64_t at = place_of(c, line->number, "member", line->word[i], c->members, c->member_name);
    *member = at < 0 ? NULL : c->member[at];
    return at < 0 ? SPAR_ERR_ARGUMENT : SPAR_OK;
}

int case_find_node(const spar_case *c, const case_line *line, int i, const spar_member *member, int64_t *node) {
    int64_t nodes;
    DO(c, line->number, spar_member_get_count(member, &nodes));
    if (i > line->n) {
        return case_fail(&c->text, line->number, SPAR_ERR_ARGUMENT,
                         "%s: '%s' has %lld nodes; name one of them: first, last, or a number", line->label,
                         spar_member_get_name(member), (long long)nodes);
    }
    int first = strcmp(line->word[i], "first") == 0, last = strcmp(line->word[i], "last") == 0;
    *node = last ? nodes - 1 : 0;
    return first || last ? SPAR_OK : case_whole(&c->text, line, i, 0, nodes - 1, node);
}

/* ---- the host's own keys ---- */

/* The line that holds: of the host's own section before the common one; the last of several of one section. at: its
   place among all lines. */
static case_line *host_line(const spar_case *c, const char *key, int64_t *at) {
    case_line *found = NULL;
    for (int own = 0; own < 2; own++) {
        for (int64_t b = 0, first = 0; b < c->text.n; first += c->text.block[b++].n) {
            const case_block *block = c->text.block + b;
            if (!case_is(block, "host") || !case_is_for(block, c->host) || own != (block->name[0] != '\0')) {
                continue;
            }
            for (int64_t i = 0; i < block->n; i++) {
                if (strcmp(block->line[i].word[0], key) == 0) {
                    found = block->line + i;
                    found->used = 1;
                    *at = first + i;
                }
            }
        }
    }
    return found;
}

static int missing_key(const spar_case *c, const char *key) {
    return case_fail(&c->text, 0, SPAR_ERR_ARGUMENT, "the host asks for '%s'; give it under [host] or [host %s]", key,
                     c->host ? c->host : "NAME");
}

static void remember_key(spar_case *c, const char *key) {
    for (int i = 0; i < c->asks; i++) {
        if (strcmp(c->ask[i], key) == 0) {
            return;
        }
    }
    if (c->asks < CASE_ASKS && strlen(key) < CASE_NAME) {
        memcpy(c->ask[c->asks++], key, strlen(key) + 1);
    }
}

int spar_case_get_text(spar_case *scene, const char *key, const char *otherwise, const char **text) {
    if (!scene || !key || !text) {
        return case_fail(NULL, 0, SPAR_ERR_ARGUMENT, "spar_case_get_text: scene, key or text is NULL");
    }
    int64_t at = 0;
    remember_key(scene, key);
    case_line *line = host_line(scene, key, &at);
    if (!line && !otherwise) {
        return missing_key(scene, key);
    }
    if (line && !scene->joined[at]) {
        size_t size = 1;
        for (int i = 1; i <= line->n; i++) {
            size += strlen(line->word[i]) + 1;
        }
        char *all = calloc(size, 1);
        if (!all) {
            return case_no_memory(scene);
        }
        for (int i = 1; i <= line->n; i++) {
            strcat(all, i > 1 ? " " : "");
            strcat(all, line->word[i]);
        }
        scene->joined[at] = all;
    }
    *text = line ? scene->joined[at] : otherwise;
    return SPAR_OK;
}

int spar_case_get_numbers(spar_case *scene, const char *key, int n, const double *otherwise, double *x) {
    if (!scene || !key || n < 1 || !x) {
        return case_fail(NULL, 0, SPAR_ERR_ARGUMENT, "spar_case_get_numbers: scene, key or x is NULL, or n below 1");
    }
    int64_t at = 0;
    remember_key(scene, key);
    const case_line *line = host_line(scene, key, &at);
    if (!line && !otherwise) {
        return missing_key(scene, key);
    }
    if (!line) {
        memcpy(x, otherwise, (size_t)n * sizeof *x);
        return SPAR_OK;
    }
    if (line->n != n) {
        return case_fail(&scene->text, line->number, SPAR_ERR_ARGUMENT, "%s has %d values; give %d", key, line->n, n);
    }
    case_quiet quiet;
    double *all = calloc((size_t)n, sizeof *all); /* x stays as it is where a number is none */
    int status = all ? case_quiet_begin(&quiet) : case_no_memory(scene);
    if (status == SPAR_OK) {
        status = case_numbers(&scene->text, line, 1, n, all);
        case_quiet_end(&quiet);
    }
    if (status == SPAR_OK) {
        memcpy(x, all, (size_t)n * sizeof *x);
    }
    free(all);
    return status;
}

int spar_case_get_word(spar_case *scene, const char *key, int i, int *n, const char **word) {
    if (!scene || !key) {
        return case_fail(NULL, 0, SPAR_ERR_ARGUMENT, "spar_case_get_word: scene or key is NULL");
    }
    int64_t at = 0;
    remember_key(scene, key);
    const case_line *line = host_line(scene, key, &at);
    const int values = line ? line->n : 0;
    if (word && (i < 0 || i >= values)) {
        return line ? case_fail(&scene->text, line->number, SPAR_ERR_ARGUMENT, "%s has %d values; give %d", key, values,
                                i + 1)
                    : missing_key(scene, key);
    }
    if (word) {
        *word = line->word[1 + i];
    }
    if (n) {
        *n = values;
    }
    return SPAR_OK;
}

/* What a host does only if it calls for it. */
static int check_host(const spar_case *c, const case_block *block) {
    if (case_is(block, "aero") && !c->blown) {
        return case_fail(&c->text, block->number, SPAR_ERR_ARGUMENT,
                         "this host has no blade elements; remove [aero %s]", block->name);
    }
    if (c->host && is_of_host(block) && !case_is_for(block, c->host) && case_distance(block->name, c->host) <= 2) {
        return case_fail(&c->text, block->number, SPAR_ERR_ARGUMENT,
                         "[%s %s] is for another host than '%s'; did you mean [%s %s]?", block->kind, block->name,
                         c->host, block->kind, c->host);
    }
    const case_line *line =
        case_is(block, "session") && case_is_for(block, c->host) ? case_find(block, "restart") : NULL;
    return line && !c->restarts ? case_fail(&c->text, line->number, SPAR_ERR_ARGUMENT,
                                            "this host cannot continue a saved run; remove restart")
                                : SPAR_OK;
}

static int check_keys(const spar_case *c, const case_block *block) {
    const char *names[CASE_ASKS];
    for (int i = 0; i < c->asks; i++) {
        names[i] = c->ask[i];
    }
    for (int64_t i = 0; i < block->n; i++) {
        if (!block->line[i].used) {
            const char *near = case_nearest(block->line[i].word[0], c->asks, names);
            return case_fail(&c->text, block->line[i].number, SPAR_ERR_ARGUMENT,
                             "the host has not asked for '%.60s'; did you mean '%s'? Otherwise remove it",
                             block->line[i].word[0], near);
        }
    }
    return SPAR_OK;
}

static int check_all(const spar_case *scene, int common) {
    for (int64_t b = 0; b < scene->text.n; b++) {
        const case_block *block = scene->text.block + b;
        CASE_TRY(check_host(scene, block));
        if (case_is(block, "host") && case_is_for(block, scene->host) && (common || block->name[0] != '\0')) {
            CASE_TRY(check_keys(scene, block));
        }
    }
    return SPAR_OK;
}

int spar_case_check(const spar_case *scene) {
    return scene ? check_all(scene, 1) : case_fail(NULL, 0, SPAR_ERR_ARGUMENT, "spar_case_check: scene is NULL");
}

int spar_case_check_own(const spar_case *scene) {
    return scene ? check_all(scene, 0) : case_fail(NULL, 0, SPAR_ERR_ARGUMENT, "spar_case_check_own: scene is NULL");
}
