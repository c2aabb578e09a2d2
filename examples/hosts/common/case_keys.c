/* Which headings and keys a case has, and what is said of others. */
#include "case_parts.h"

#include <string.h>

typedef struct known_key {
    const char *name;
    int least, most;  /* values */
    int rows;         /* may stand more than once */
    const char *text; /* values, units, default */
} known_key;

static const known_key session_keys[] = {
    {"gravity", 3, 3, 0, "x y z, m/s^2; default 0 0 0"},
    {"rho_inf", 1, 1, 0, "spectral radius at infinite frequency, 0 to 1; default 0.9"},
    {"substeps", 1, 1, 0, "structural steps per coupling step; default 1"},
    {"newton", 3, 3, 0, "atol rtol max_iterations; default 1e-15 1e-12 50"},
    {"scheme", 1, 1, 0, "explicit, fixed-point, aitken or iqn-ils; default iqn-ils"},
    {"atol", 1, 1, 0, "N, tolerance of the coupling; default 1e-9"},
    {"rtol", 1, 1, 0, "of the loads, tolerance of the coupling; default 1e-6"},
    {"max_iterations", 1, 1, 0, "of the coupling; default 50"},
    {"relaxation", 1, 1, 0, "part of the change of loads that is applied, 0 to 2; default 1"},
    {"predictor", 1, 1, 0, "order of the predicted loads, 0, 1 or 2; default 1"},
    {"option", 2, 2, 1, "KEY VALUE, as of spar_session_set_option"},
    {"reproducible", 1, 1, 0, "on or off: the same sums on any number of ranks; default off"},
    {"restart", 1, 1, 0, "FILE that save of [output] has written: the run continues from it"},
    {NULL, 0, 0, 0, NULL},
};
static const known_key member_keys[] = {
    {"place", 3, 3, 0, "x y z, m; default 0 0 0"},
    {"orientation", 4, 4, 0, "qw qx qy qz, unit quaternion; default 1 0 0 0"},
    {"root", 1, 1, 0, "free, fixed, pinned or driven; default: a beam fixed, others free"},
    {"external", 1, 1, 0, "on or off: the host solves this member; default off"},
    {"owner", 1, 1, 0, "rank that solves it; default: the ranks in turn"},
    {"spin", 3, 3, 0, "x y z, rad/s, initial angular velocity; default 0 0 0"},
    {"about", 3, 3, 0, "x y z, m, point about which it rotates initially; default 0 0 0"},
    {"velocity", 3, 3, 0, "x y z, m/s, initial velocity of that point; default 0 0 0"},
    {"load", 8, 8, 1, "NODE dead|follower fx fy fz mx my mz, N, N m; NODE: a number from 0, first or last"},
    {"effects_on", 1, 16, 0, "effects besides the defaults: inertia, gravity, work, ... (SPAR_EFFECT_*)"},
    {"effects_off", 1, 16, 0, "effects of the defaults to leave out"},
    {NULL, 0, 0, 0, NULL},
};
static const known_key beam_keys[] = {
    {"elements", 1, 1, 0, "number of elements; default 1"},
    {"nodes", 1, 1, 0, "nodes of an element; default 8"},
    {"quadrature", 2, 2, 0,
     "gauss, lobatto or sections, and a number of points; default: sections, if there are more than two"},
    {"axis", 4, 5, 1,
     "eta x y z [twist], m, rad: a point of the line; eta from 0 to 1; a corner is at an element's end"},
    {"axis_file", 1, 1, 0, "FILE of rows as of axis"},
    {"node", 3, 7, 1, "x y z [qw qx qy qz], m: a node, in place of an axis"},
    {"twist_scale", 1, 1, 0, "factor that makes rad, right-handed, of the twist; default 1"},
    {"section", 7, 73, 1,
     "eta, then 6, 21 or 36 numbers of the stiffness (N, N m, N m^2), then as many of the mass (kg/m, kg, kg m)"},
    {"beamdyn", 1, 2, 0, "PRIMARY [BLADE]: files of BeamDyn, in place of axis, sections and damping"},
    {"damping", 6, 6, 0, "mu1 .. mu6, s, stiffness-proportional; default 0"},
    {"modal_damping", 4, 4, 0, "mode ratio mode ratio: damping ratios of two modes, numbered from 0"},
    {"sections_file", 1, 1, 0, "FILE of rows as of section"},
    {"fidelity", 1, 2, 0, "exact, linear, rigid, prescribed, or modal n; default exact"},
    {"line_load", 8, 8, 1, "dead|follower eta fx fy fz mx my mz, N/m, N m/m"},
    {"added_mass", 7, 37, 1, "eta, then 6, 21 or 36 numbers (kg/m, kg, kg m): a guess of the fluid's"},
    {"mass_damping", 1, 1, 0, "alpha, 1/s; default 0"},
    {"plane", 3, 3, 0, "normal x y z of the plane that holds the beam"},
    {"body", 7, 37, 1, "eta, then 6, 21 or 36 numbers (kg, kg m, kg m^2): a rigid body on the beam"},
    {"foundation", 4, 4, 1, "eta kx ky kz, N/m^2: springs to the ground"},
    {"pretension", 7, 7, 1, "eta n vy vz t my mz, N, N m: section forces of the reference"},
    {"added_mass_response", 1, 1, 0, "acceleration or velocity; default acceleration"},
    {NULL, 0, 0, 0, NULL},
};
static const known_key rigid_keys[] = {
    {"mass", 6, 36, 0, "6, 21 or 36 numbers (kg, kg m, kg m^2)"},
    {"added_mass", 6, 36, 0, "6, 21 or 36 numbers (kg, kg m, kg m^2): a guess of the fluid's"},
    {"added_mass_response", 1, 1, 0, "acceleration or velocity; default acceleration"},
    {NULL, 0, 0, 0, NULL},
};
static const known_key joint_keys[] = {
    {"a", 2, 2, 0, "MEMBER NODE"},
    {"b", 1, 2, 0, "MEMBER NODE, or ground"},
    {"free", 1, 6, 0, "none, all, or of x y z rx ry rz; default none"},
    {"place", 3, 3, 0, "x y z, m; default: the node of a"},
    {"axes", 4, 4, 0, "qw qx qy qz of the joint's axes; default 1 0 0 0"},
    {"stiffness", 6, 36, 0, "6, 21 or 36 numbers (N/m, N, N m) along free motions; default 0"},
    {"damping", 6, 36, 0, "6, 21 or 36 numbers (N s/m, N s, N m s); default 0"},
    {"preload", 6, 6, 0, "fx fy fz mx my mz, N, N m; default 0"},
    {"driven", 1, 6, 0, "motions that the host prescribes: all, or of x y z rx ry rz; default none"},
    {"load", 6, 6, 0, "fx fy fz mx my mz, N, N m, along free motions; default 0"},
    {NULL, 0, 0, 0, NULL},
};
static const known_key line_keys[] = {
    {"a", 5, 5, 0, "MEMBER NODE x y z, m: a point that moves with the node"},
    {"b", 4, 5, 0, "MEMBER NODE x y z, or ground x y z, m"},
    {"stiffness", 1, 1, 0, "N/m; without it the link is rigid"},
    {"damping", 1, 1, 0, "N s/m; default 0"},
    {"length", 1, 1, 0, "m, unstretched; default: the distance of the two points"},
    {"driven", 1, 1, 0, "on or off: the host prescribes its length; default off"},
    {"tension_only", 1, 1, 0, "on or off: it bears no pressure; default off"},
    {NULL, 0, 0, 0, NULL},
};
static const known_key output_keys[] = {
    {"folder", 1, 1, 0, "of the VTK files; default: the working folder"},
    {"every", 1, 1, 0, "steps from one VTK file to the next; default 0: none"},
    {"fluids", 1, 1, 0, "on or off: VTK files of fluids too; default off"},
    {"history", 1, 1, 0, "FILE: t, step, iterations, residual (N), loads (N), added mass / mass, a line a step"},
    {"watch", 2, 2, 1, "MEMBER NODE: displacement, velocity, and the member's loads in the history"},
    {"save", 1, 2, 0, "FILE [n]: the session after every n-th step; default 1"},
    {NULL, 0, 0, 0, NULL},
};
static const known_key aero_keys[] = {
    {"blades", 1, 16, 0, "MEMBER ...: blades of the rotor, alike"},
    {"aerodyn", 1, 2, 0, "PRIMARY [BLADE]: chord, twist and polars from files of AeroDyn"},
    {"axes", 4, 4, 0, "qw qx qy qz of the axes of these files in the blade's own; default 1 0 0 0"},
    {"stations", 3, 3, 0, "n first last, m from the root; default: those of the file"},
    {"section", 4, 6, 1, "eta chord twist POLAR [y z], m, rad; POLAR: a file of rows alpha cl cd [cm]"},
    {"rotor", 8, 8, 0,
     "x y z  ax ay az  hub_radius tip_radius, m: a point of the shaft, its direction, the blades' ends"},
    {"turn", 1, 1, 0, "1 or -1: right-handed about the shaft, or against it; default 1"},
    {"total", 1, 1, 0, "blades of the whole rotor; default: those named"},
    {"effects", 1, 12, 0,
     "none, or of induction tip_loss hub_loss swirl drag moment shear tower inflow stall unsteady"},
    {"shear", 9, 9, 0, "power|log|linear  x y z  ux uy uz  height parameter: ground, up, where the wind is that given"},
    {"tower", 8, 8, 0, "x y z  x y z  base_radius top_radius, m: base and top of the tower, for its shadow"},
    {"wind", 3, 3, 0, "x y z, m/s"},
    {"density", 1, 1, 0, "kg/m^3"},
    {NULL, 0, 0, 0, NULL},
};
static const known_key no_keys[] = {{NULL, 0, 0, 0, NULL}};

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
                             "[%s %s] has the name of the block in line %d; rename it, or merge the two", block->kind,
                             block->name, other->number);
        }
    }
    return SPAR_OK;
}

void spar_case_explain(FILE *to) {
    for (int i = 0; i < KINDS && kinds[i].keys[0]; i++) {
        (void)fprintf(to, "%s[%s%s]", i > 0 ? "\n" : "", kinds[i].kind, kinds[i].naming == NAME_OWN ? " NAME" : "");
        if (kinds[i].naming == NAME_HOST) {
            (void)fprintf(to, ", and [%s HOST] for one host alone", kinds[i].kind);
        }
        (void)fprintf(to, "\n");
        for (int table = 0; table < 2; table++) {
            for (const known_key *k = kinds[i].keys[table]; k->name; k++) {
                (void)fprintf(to, "  %-20s %s%s\n", k->name, k->text, k->rows ? " (any number of lines)" : "");
            }
        }
    }
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
