/* Which headings and keys a case has, and what is said of others. */
#include "case_parts.h"

#include <string.h>

typedef struct known_key {
    const char *name;
    int least, most; /* values */
    int rows;        /* may stand more than once */
} known_key;

static const known_key session_keys[] = {
    {"gravity", 3, 3, 0},    {"rho_inf", 1, 1, 0},   {"substeps", 1, 1, 0}, {"newton", 3, 3, 0},
    {"scheme", 1, 1, 0},     {"atol", 1, 1, 0},      {"rtol", 1, 1, 0},     {"max_iterations", 1, 1, 0},
    {"relaxation", 1, 1, 0}, {"predictor", 1, 1, 0}, {"option", 2, 2, 1},   {"reproducible", 1, 1, 0},
    {"restart", 1, 1, 0},    {NULL, 0, 0, 0},
};
static const known_key member_keys[] = {
    {"place", 3, 3, 0}, {"orientation", 4, 4, 0}, {"root", 1, 1, 0},         {"external", 1, 1, 0},
    {"owner", 1, 1, 0}, {"spin", 3, 3, 0},        {"about", 3, 3, 0},        {"velocity", 3, 3, 0},
    {"load", 8, 8, 1},  {"effects_on", 1, 16, 0}, {"effects_off", 1, 16, 0}, {NULL, 0, 0, 0},
};
static const known_key beam_keys[] = {
    {"elements", 1, 1, 0},  {"nodes", 1, 1, 0},      {"quadrature", 2, 2, 0},    {"axis", 4, 5, 1},
    {"axis_file", 1, 1, 0}, {"node", 3, 7, 1},       {"twist_scale", 1, 1, 0},   {"section", 7, 73, 1},
    {"beamdyn", 1, 2, 0},   {"damping", 6, 6, 0},    {"modal_damping", 4, 4, 0}, {"sections_file", 1, 1, 0},
    {"fidelity", 1, 2, 0},  {"line_load", 8, 8, 1},  {"added_mass", 7, 37, 1},   {"mass_damping", 1, 1, 0},
    {"body", 7, 37, 1},     {"foundation", 4, 4, 1}, {"pretension", 7, 7, 1},    {"added_mass_response", 1, 1, 0},
    {NULL, 0, 0, 0},
};
static const known_key rigid_keys[] = {
    {"mass", 6, 36, 0}, {"added_mass", 6, 36, 0}, {"added_mass_response", 1, 1, 0}, {NULL, 0, 0, 0}};
static const known_key joint_keys[] = {
    {"a", 2, 2, 0},      {"b", 1, 2, 0},          {"free", 1, 6, 0},     {"place", 3, 3, 0},
    {"axes", 4, 4, 0},   {"stiffness", 6, 36, 0}, {"damping", 6, 36, 0}, {"preload", 6, 6, 0},
    {"driven", 1, 6, 0}, {"load", 6, 6, 0},       {NULL, 0, 0, 0},
};
static const known_key line_keys[] = {
    {"a", 5, 5, 0},      {"b", 4, 5, 0},      {"stiffness", 1, 1, 0},    {"damping", 1, 1, 0},
    {"length", 1, 1, 0}, {"driven", 1, 1, 0}, {"tension_only", 1, 1, 0}, {NULL, 0, 0, 0},
};
static const known_key output_keys[] = {
    {"folder", 1, 1, 0}, {"every", 1, 1, 0}, {"fluids", 1, 1, 0}, {"history", 1, 1, 0},
    {"watch", 2, 2, 1},  {"save", 1, 2, 0},  {NULL, 0, 0, 0},
};
static const known_key aero_keys[] = {
    {"blades", 1, 16, 0}, {"aerodyn", 1, 2, 0}, {"axes", 4, 4, 0},    {"stations", 3, 3, 0}, {"section", 4, 6, 1},
    {"rotor", 8, 8, 0},   {"turn", 1, 1, 0},    {"total", 1, 1, 0},   {"effects", 1, 12, 0}, {"shear", 9, 9, 0},
    {"tower", 8, 8, 0},   {"wind", 3, 3, 0},    {"density", 1, 1, 0}, {NULL, 0, 0, 0},
};
static const known_key no_keys[] = {{NULL, 0, 0, 0}};

enum { NAME_NONE, NAME_HOST, NAME_OWN }; /* what stands behind the kind in a heading */
static const struct known_kind {
    const char *kind;
    int naming;
    const known_key *keys[2];
} kinds[] = {
    {"session", NAME_HOST, {session_keys, no_keys}},
    {"beam", NAME_OWN, {beam_keys, member_keys}},
    {"rigid", NAME_OWN, {rigid_keys, member_keys}},
    {"point", NAME_OWN, {member_keys, no_keys}},
    {"joint", NAME_OWN, {joint_keys, no_keys}},
    {"line", NAME_OWN, {line_keys, no_keys}},
    {"aero", NAME_OWN, {aero_keys, no_keys}},
    {"output", NAME_HOST, {output_keys, no_keys}},
    {"host", NAME_HOST, {NULL, NULL}},
};
enum { KINDS = sizeof kinds / sizeof kinds[0], MOST_KEYS = 64 };

static const struct known_kind *find_kind(const case_block *block) {
    for (int i = 0; i < KINDS; i++) {
        if (strcmp(kinds[i].kind, block->kind) == 0) {
            return kinds + i;
        }
    }
    return NULL;
}

static int check_key(const case_text *text, const case_block *block, const struct known_kind *kind, int64_t at) {
    const case_line *line = block->line + at;
    const char *names[MOST_KEYS];
    int n = 0;
    for (int table = 0; table < 2; table++) {
        for (const known_key *k = kind->keys[table]; k->name; k++) {
            if (strcmp(k->name, line->word[0]) != 0) {
                names[n++] = k->name;
                continue;
            }
            if (line->n < k->least || line->n > k->most) {
                return case_fail(text, line->number, SPAR_ERR_ARGUMENT,
                                 k->least == k->most ? "%s has %d values; give %d" : "%s has %d values; give %d to %d",
                                 k->name, line->n, k->least, k->most);
            }
            int64_t from = 0;
            const case_line *first = case_next(block, k->name, &from);
            return k->rows || first == line ? SPAR_OK
                                            : case_fail(text, line->number, SPAR_ERR_ARGUMENT,
                                                        "%s is given twice in [%s %s], first in line %d; keep one",
                                                        k->name, block->kind, block->name, first->number);
        }
    }
    return case_fail(text, line->number, SPAR_ERR_ARGUMENT, "[%s] has no key '%.60s'; did you mean '%s'?", block->kind,
                     line->word[0], case_nearest(line->word[0], n, names));
}

/* Members share their names, and so do joints and lines. */
static int name_group(const case_block *block) {
    return case_is(block, "joint") || case_is(block, "line") ? 1
           : case_is(block, "aero")                          ? 3
           : find_kind(block)->naming == NAME_OWN            ? 2
                                                             : 0;
}

static int check_heading(const case_text *text, int64_t at) {
    const case_block *block = text->block + at;
    const struct known_kind *kind = find_kind(block);
    if (!kind) {
        const char *names[KINDS];
        for (int i = 0; i < KINDS; i++) {
            names[i] = kinds[i].kind;
        }
        return case_fail(
            text, block->number, SPAR_ERR_ARGUMENT,
            "no heading [%.60s]; did you mean [%s]? (session, beam, rigid, point, joint, line, aero, output, "
            "host)",
            block->kind, case_nearest(block->kind, KINDS, names));
    }
    if (kind->naming == NAME_OWN && block->name[0] == '\0') {
        return case_fail(text, block->number, SPAR_ERR_ARGUMENT, "[%s] needs a name of its own, as in [%s wing]",
                         block->kind, block->kind);
    }
    for (int64_t i = 0; i < at; i++) {
        const case_block *other = text->block + i;
        int same = kind->naming == NAME_OWN ? name_group(other) == name_group(block) : case_is(other, block->kind);
        if (same && strcmp(other->name, block->name) == 0) {
            return case_fail(text, block->number, SPAR_ERR_ARGUMENT,
                             "[%s %s] bears the name of line %d; give it another, or put the two together", block->kind,
                             block->name, other->number);
        }
    }
    return SPAR_OK;
}

int case_check_text(const case_text *text) {
    for (int64_t b = 0; b < text->n; b++) {
        CASE_TRY(check_heading(text, b));
        const struct known_kind *kind = find_kind(text->block + b);
        for (int64_t i = 0; kind->keys[0] && i < text->block[b].n; i++) {
            CASE_TRY(check_key(text, text->block + b, kind, i));
        }
    }
    return SPAR_OK;
}

int case_is(const case_block *block, const char *kind) {
    return strcmp(block->kind, kind) == 0;
}
