#include "rotor_options.h"
#include <math.h>
#include <spar/spar_aero.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum kind { NUMBER, WHOLE, TEXT, FLAG, SCHEME, FIDELITY, EFFECTS, WITHOUT };

typedef struct option {
    const char *name;
    enum kind kind;
    size_t field;
    double least, most;
    const char *value, *help;
} option;

#define AT(field) offsetof(rotor_options, field)
static const option options[] = {
    {"wind", NUMBER, AT(wind), 0, 100, "M/S", "wind speed at hub height [8]"},
    {"rpm", NUMBER, AT(rpm), 0, 100, "REV/MIN", "rotor speed [the turbine's at this wind]"},
    {"pitch", NUMBER, AT(pitch), -90, 90, "DEG", "blade pitch, positive towards feather [the turbine's at this wind]"},
    {"shear", NUMBER, AT(shear), -1, 1, "EXPONENT", "power law of the wind over height [0]"},
    {"hub-height", NUMBER, AT(hub_height), 1, 1000, "M", "height of the hub, for the shear [90]"},
    {"yaw", NUMBER, AT(yaw), -180, 180, "DEG", "turn of the wind about the vertical [0]"},
    {"gust", NUMBER, AT(gust), -100, 100, "M/S", "height of a 1-cos gust on top of the wind [0: none]"},
    {"gust-start", NUMBER, AT(gust_start), 0, 1e9, "S", "when it begins [10]"},
    {"gust-length", NUMBER, AT(gust_length), 1e-3, 1e9, "S", "how long it lasts [10]"},
    {"tilt", NUMBER, AT(tilt), -90, 90, "DEG", "shaft tilt [5]"},
    {"precone", NUMBER, AT(precone), -45, 45, "DEG", "blade precone, tips upwind [2.5]"},
    {"seconds", NUMBER, AT(seconds), 1e-6, 1e9, "S",
     "time to simulate [30]; spar-effects: before it looks [two turns]"},
    {"dt", NUMBER, AT(dt), 1e-7, 10, "S", "coupling step [0.02]"},
    {"rigid", FLAG, AT(rigid), 0, 0, NULL, "rigid blades"},
    {"straight", FLAG, AT(straight), 0, 0, NULL, "begin with straight blades, not with bent ones"},
    {"elements", WHOLE, AT(elements), 1, 1000, "N", "beam elements per blade [1]"},
    {"nodes", WHOLE, AT(nodes), 2, 24, "N", "nodes per element [10]"},
    {"quadrature", WHOLE, AT(quadrature), 0, 10, "N",
     "points per interval of the section table [0: the library's choice]"},
    {"fidelity", FIDELITY, AT(fidelity), 0, 0, "NAME",
     "of the blades: prescribed, rigid, linear, modal or exact [exact]"},
    {"modes", WHOLE, AT(modes), 1, 1000, "N", "of modal blades [8]"},
    {"effects", EFFECTS, 0, 0, 0, "A,B,...", "these effects alone (names below)"},
    {"without", WITHOUT, 0, 0, 0, "A,B,...", "all the scene has but these"},
    {"coupling", SCHEME, AT(scheme), 0, 0, "NAME", "explicit, fixed-point, aitken or iqn [fixed-point]"},
    {"coupling-tolerance", NUMBER, AT(coupling_tolerance), 0, 1, "R",
     "change of the loads, relative, that ends the iteration [1e-6]"},
    {"iterations", WHOLE, AT(max_iterations), 1, 1000, "N", "coupling iterations at most [20]"},
    {"relaxation", NUMBER, AT(relaxation), 1e-6, 2, "W", "of the fixed-point iteration [1]"},
    {"predictor", WHOLE, AT(predictor), 0, 2, "ORDER", "extrapolation of the loads: 0, 1, 2 [1]"},
    {"rho-inf", NUMBER, AT(rho_inf), 0, 1, "R", "spectral radius of generalised-alpha [0.8]"},
    {"substeps", WHOLE, AT(substeps), 1, 10000, "N", "structure steps per coupling step [1]"},
    {"newton", NUMBER, AT(newton), 0, 1, "R",
     "increment, relative, that ends Newton's iteration [a hundredth of the coupling's tolerance]"},
    {"theta", NUMBER, AT(theta), 0, 1, "THETA", "where in the step the fluid takes the motion [1]"},
    {"tolerance", NUMBER, AT(tolerance), 1e-12, 1, "R",
     "run with the cheapest settings that keep this error of the deflection [none: as given]"},
    {"trial", NUMBER, AT(trial), 1e-6, 1e9, "S",
     "how long trials last [--tolerance: a turn, spar-effects: half a turn]"},
    {"csv", FLAG, AT(csv), 0, 0, NULL, "spar-effects: for a spreadsheet"},
    {"vtk-every", NUMBER, AT(vtk_every), 0, 1e9, "S", "simulated time between pictures for ParaView, 0: none [0.25]"},
    {"out", TEXT, AT(out), 0, 0, "FOLDER", "where the files go [rotor-out]"},
    {"data", TEXT, AT(data), 0, 0, "FOLDER", "the turbine's tables [" SPAR_DATA_DIR "/nrel5mw]"},
    {"no-plots", FLAG, AT(no_plots), 0, 0, NULL, "no PNG plots (they need gnuplot)"},
    {"quiet", FLAG, AT(quiet), 0, 0, NULL, "no progress line"},
    {"help", FLAG, AT(help), 0, 0, NULL, "this text"},
};
enum { OPTIONS = sizeof options / sizeof options[0] };

static const struct {
    const char *name;
    int of_aero, bit;
} effects[] = {{"inertia", 0, SPAR_EFFECT_INERTIA},
               {"gyroscopic", 0, SPAR_EFFECT_GYROSCOPIC},
               {"gravity", 0, SPAR_EFFECT_GRAVITY},
               {"damping", 0, SPAR_EFFECT_DAMPING},
               {"fluid-moment", 0, SPAR_EFFECT_FLUID_MOMENT},
               {"induction", 1, SPAR_AERO_INDUCTION},
               {"tip-loss", 1, SPAR_AERO_TIP_LOSS},
               {"hub-loss", 1, SPAR_AERO_HUB_LOSS},
               {"swirl", 1, SPAR_AERO_SWIRL},
               {"drag", 1, SPAR_AERO_DRAG},
               {"moment", 1, SPAR_AERO_MOMENT}};
enum { EFFECT_COUNT = sizeof effects / sizeof effects[0] };

static const char *const schemes[] = {"explicit", "fixed-point", "aitken", "iqn"}; /* SPAR_COUPLING_* */
enum { SCHEMES = sizeof schemes / sizeof schemes[0] };

static const char *const fidelities[] = {"prescribed", "rigid", "linear", "modal", "exact"}; /* SPAR_FIDELITY_* */
enum { FIDELITIES = sizeof fidelities / sizeof fidelities[0] };

const char *rotor_scheme_name(int scheme) {
    return schemes[scheme];
}

const char *rotor_fidelity_name(int fidelity) {
    return fidelities[fidelity];
}

void rotor_options_print(const rotor_options *o, FILE *file) {
    fprintf(file, " --dt %.6g --substeps %d --predictor %d --newton %.2g --coupling %s", o->dt, o->substeps,
            o->predictor, o->newton, schemes[o->scheme]);
    if (o->scheme != SPAR_COUPLING_EXPLICIT) {
        fprintf(file, " --coupling-tolerance %.2g", o->coupling_tolerance);
    }
    if (o->rigid) {
        return;
    }
    fprintf(file, " --fidelity %s", fidelities[o->fidelity]);
    if (o->fidelity == SPAR_FIDELITY_MODAL) {
        fprintf(file, " --modes %d", o->modes);
    }
    fprintf(file, " --nodes %d", o->nodes);
    if (o->quadrature > 0) {
        fprintf(file, " --quadrature %d", o->quadrature);
    }
}

void rotor_operating_point(double wind, double *rpm, double *pitch) {
    /* Jonkman et al., NREL/TP-500-38060, 2009, table 7-1 (steady state) */
    static const double table[][3] = {{3, 6.97, 0},      {4, 7.18, 0},      {5, 7.51, 0},      {6, 7.94, 0},
                                      {7, 8.47, 0},      {8, 9.16, 0},      {9, 10.30, 0},     {10, 11.43, 0},
                                      {11, 11.89, 0},    {11.4, 12.1, 0},   {12, 12.1, 3.83},  {13, 12.1, 6.60},
                                      {14, 12.1, 8.70},  {15, 12.1, 10.45}, {16, 12.1, 12.06}, {17, 12.1, 13.54},
                                      {18, 12.1, 14.92}, {19, 12.1, 16.23}, {20, 12.1, 17.47}, {21, 12.1, 18.70},
                                      {22, 12.1, 19.94}, {23, 12.1, 21.18}, {24, 12.1, 22.35}, {25, 12.1, 23.47}};
    enum { ROWS = sizeof table / sizeof table[0] };
    int i = 1;
    while (i + 1 < ROWS && table[i][0] < wind) {
        i++;
    }
    double t = (wind - table[i - 1][0]) / (table[i][0] - table[i - 1][0]);
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    *rpm = table[i - 1][1] + t * (table[i][1] - table[i - 1][1]);
    *pitch = table[i - 1][2] + t * (table[i][2] - table[i - 1][2]);
}

void rotor_options_help(const char *program) {
    printf("usage: %s [options]\n\n"
           "The NREL 5-MW rotor: blades as geometrically exact beams in the wind, coupled with blade element momentum "
           "theory.\n\n",
           program);
    for (int i = 0; i < OPTIONS; i++) {
        char left[64];
        snprintf(left, sizeof left, "--%s%s%s", options[i].name, options[i].value ? " " : "",
                 options[i].value ? options[i].value : "");
        printf("  %-26s %s\n", left, options[i].help);
    }
    printf("\nEffects:");
    for (int i = 0; i < EFFECT_COUNT; i++) {
        printf(" %s", effects[i].name);
    }
    printf("\n");
}

static int all_effects(int of_aero) {
    int all = 0;
    for (int i = 0; i < EFFECT_COUNT; i++) {
        all |= effects[i].of_aero == of_aero ? effects[i].bit : 0;
    }
    return all;
}

/* Sets (or clears) the effects of a list of names; a kind of effects none of which is named keeps its default when
   clearing. */
static int read_effects(rotor_options *o, const char *list, int clear) {
    int chosen[2] = {0, 0};
    for (const char *at = list; *at;) {
        size_t size = strcspn(at, ",");
        int i = 0;
        while (i < EFFECT_COUNT && !(strlen(effects[i].name) == size && strncmp(effects[i].name, at, size) == 0)) {
            i++;
        }
        if (i == EFFECT_COUNT) {
            fprintf(stderr, "rotor: there is no effect '%.*s'; --help lists them\n", (int)size, at);
            return 1;
        }
        chosen[effects[i].of_aero] |= effects[i].bit;
        at += size + (at[size] == ',');
    }
    o->effects_off = clear ? o->effects_off | chosen[0] : all_effects(0) & ~chosen[0];
    o->aero_effects = clear ? o->aero_effects & ~chosen[1] : chosen[1];
    o->aero_effects_given |= !clear || chosen[1];
    return 0;
}

static int read_number(const option *p, const char *text, double *value) {
    char *end;
    *value = strtod(text, &end);
    if (end == text || *end || !(*value >= p->least && *value <= p->most)) {
        fprintf(stderr, "rotor: --%s %s: a number from %g to %g is wanted\n", p->name, text, p->least, p->most);
        return 1;
    }
    if (p->kind == WHOLE && floor(*value) != *value) {
        fprintf(stderr, "rotor: --%s %s: a whole number is wanted\n", p->name, text);
        return 1;
    }
    return 0;
}

static int read_name(const option *p, const char *text, const char *const *names, int n, int *chosen) {
    for (int i = 0; i < n; i++) {
        if (strcmp(text, names[i]) == 0) {
            *chosen = i;
            return 0;
        }
    }
    fprintf(stderr, "rotor: --%s %s:", p->name, text);
    for (int i = 0; i < n; i++) {
        fprintf(stderr, "%s%s", i == 0 ? " " : i + 1 < n ? ", " : " or ", names[i]);
    }
    fprintf(stderr, "\n");
    return 1;
}

static int read_value(rotor_options *o, const option *p, const char *text) {
    void *field = (char *)o + p->field;
    double value;
    switch (p->kind) {
    case NUMBER:
        return read_number(p, text, field);
    case WHOLE:
        if (read_number(p, text, &value) != 0) {
            return 1;
        }
        *(int *)field = (int)value;
        return 0;
    case TEXT:
        *(const char **)field = text;
        return 0;
    case SCHEME:
        return read_name(p, text, schemes, SCHEMES, field);
    case FIDELITY:
        return read_name(p, text, fidelities, FIDELITIES, field);
    case EFFECTS:
    case WITHOUT:
        return read_effects(o, text, p->kind == WITHOUT);
    case FLAG:
        break;
    }
    return 1;
}

static void set_defaults(rotor_options *o) {
    *o = (rotor_options){.wind = 8,
                         .rpm = NAN,
                         .pitch = NAN,
                         .hub_height = 90,
                         .gust_start = 10,
                         .gust_length = 10,
                         .tilt = NAN,
                         .precone = NAN,
                         .seconds = NAN,
                         .dt = 0.02,
                         .elements = 1,
                         .nodes = 10,
                         .scheme = SPAR_COUPLING_FIXED_POINT,
                         .max_iterations = 20,
                         .predictor = 1,
                         .substeps = 1,
                         .fidelity = SPAR_FIDELITY_EXACT,
                         .modes = 8,
                         .coupling_tolerance = 1e-6,
                         .newton = NAN,
                         .tolerance = NAN,
                         .trial = NAN,
                         .relaxation = 1,
                         .rho_inf = 0.8,
                         .theta = 1,
                         .vtk_every = NAN,
                         .out = "rotor-out",
                         .data = SPAR_DATA_DIR "/nrel5mw"};
    o->aero_effects = all_effects(1);
}

int rotor_options_read(rotor_options *o, int argc, char **argv) {
    set_defaults(o);
    for (int i = 1; i < argc; i++) {
        const char *name = argv[i] + 2, *value = strchr(argv[i], '=');
        size_t size = strncmp(argv[i], "--", 2) != 0 ? 0 : value ? (size_t)(value - name) : strlen(name);
        const option *p = options;
        while (p < options + OPTIONS && !(strlen(p->name) == size && strncmp(p->name, name, size) == 0)) {
            p++;
        }
        if (size == 0 || p == options + OPTIONS) {
            fprintf(stderr, "rotor: '%s' is no option; --help lists them\n", argv[i]);
            return 1;
        }
        if (p->kind == FLAG) {
            *(int *)(void *)((char *)o + p->field) = 1;
            continue;
        }
        value = value ? value + 1 : i + 1 < argc ? argv[++i] : NULL;
        if (!value) {
            fprintf(stderr, "rotor: --%s needs a value\n", p->name);
            return 1;
        }
        if (read_value(o, p, value) != 0) {
            return 1;
        }
    }
    if (isnan(o->newton)) { /* what it leaves is to be small beside what the coupling leaves */
        o->newton = fmax(1e-2 * o->coupling_tolerance, 1e-12);
    }
    return 0;
}
