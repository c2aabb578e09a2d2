/* Public calls of the blade-element fluid model. It uses sessions, members and fluids through the public headers
   alone. */
#include "aero.h"
#include "../base/environment.h"
#include "../math/rotation.h"
#include "message.h"
#include <stdlib.h>
#include <string.h>

/* All effects (SPAR_AERO_*). */
enum { SPARI_AERO_ALL = 2 * SPAR_AERO_UNSTEADY - 1 };
static const int momentum_effects = SPAR_AERO_INDUCTION | SPAR_AERO_TIP_LOSS | SPAR_AERO_HUB_LOSS | SPAR_AERO_SWIRL;
static const int wind_effects = SPAR_AERO_SHEAR | SPAR_AERO_TOWER;
static const int memory_effects = SPAR_AERO_INFLOW | SPAR_AERO_STALL | SPAR_AERO_UNSTEADY;

static int64_t count(const spar_aero *aero) {
    return aero->blades * aero->n;
}

/* ---- create and destroy ---- */

static void aero_free(spar_aero *aero) {
    for (int64_t i = 0; aero->section && i < aero->n; i++) {
        spari_table_release(aero->section[i].table);
    }
    SPARI_FREE(aero->fluid, aero->section, aero->row, aero->place, aero->length, aero->loss_radius, aero->x, aero->v,
               aero->q, aero->omega, aero->element, aero->force, aero->moment, aero->wind, aero->met, aero->inside,
               aero->was, aero->is, aero->a, aero->omega_a, aero->attached, aero);
}

void spar_aero_destroy(spar_aero **aero) {
    if (aero && *aero) {
        (*aero)->gone = (*aero)->reporting;
        if (!(*aero)->reporting) {
            aero_free(*aero);
        }
        *aero = NULL;
    }
}

static int make_arrays(spar_aero *aero) {
    int64_t all = count(aero);
    aero->fluid = spari_zalloc(aero->blades, sizeof(spar_fluid *));
    aero->section = spari_zalloc(aero->n, sizeof *aero->section);
    aero->row = spari_zalloc(all, sizeof *aero->row);
    aero->element = spari_zalloc(all, sizeof *aero->element);
    double **array[] = {&aero->place, &aero->length, &aero->x, &aero->v, &aero->q, &aero->force};
    static const int width[] = {3, 1, 3, 3, 4, 3};
    int whole = aero->fluid && aero->section && aero->row && aero->element;
    for (size_t i = 0; i < sizeof array / sizeof array[0]; i++) {
        *array[i] = spari_zalloc(width[i] * all, sizeof(double));
        whole = whole && *array[i];
    }
    return whole ? SPAR_OK : SPAR_ERR_MEMORY;
}

static int find_session(const spar_fluid *fluid, spar_session **session) {
    spar_member *member;
    SPARI_TRY(spar_fluid_get_member(fluid, &member));
    return spar_member_get_session(member, session);
}

/* Its arrays are packed, so a fluid with another layout is refused. */
static int check_packed(spar_session *session, const spar_fluid *fluid, int status, const char *call) {
    for (int which = SPAR_NODES_MOTION; which <= SPAR_NODES_FORCE; which++) {
        int64_t node = 3, component = 1;
        SPARI_TRY(spar_fluid_get_layout(fluid, which, &node, &component));
        SPARI_AERO_REQUIRE(session, node == 3 && component == 1, status,
                           "%s: fluid '%s' has a non-default array layout; reset it with spar_fluid_set_layout (3, 1)",
                           call, spar_fluid_get_name(fluid));
    }
    return SPAR_OK;
}

/* Checks that all fluids exist, belong to one session, and have n >= 2 sections each. */
static int check_blade_fluids(int blades, spar_fluid *const *fluid, const char *call, spar_session **first,
                              int64_t *n) {
    for (int b = 0; b < blades; b++) {
        SPARI_AERO_REQUIRE(*first, fluid[b], SPAR_ERR_ARGUMENT, "%s: the fluid of blade %d is NULL", call, b);
        spar_session *session;
        int64_t nodes, forces;
        SPARI_TRY(find_session(fluid[b], &session));
        *first = b == 0 ? session : *first;
        SPARI_AERO_REQUIRE(*first, session == *first, SPAR_ERR_ARGUMENT,
                           "%s: fluid '%s' of blade %d belongs to another session than blade 0", call,
                           spar_fluid_get_name(fluid[b]), b);
        SPARI_TRY(spar_fluid_get_count(fluid[b], SPAR_NODES_MOTION, &nodes));
        SPARI_TRY(spar_fluid_get_count(fluid[b], SPAR_NODES_FORCE, &forces));
        SPARI_AERO_REQUIRE(
            session, nodes >= 2 && nodes == forces, SPAR_ERR_ARGUMENT,
            "%s: fluid '%s' of blade %d has %lld motion and %lld force nodes; give it at least 2 sections "
            "with spar_fluid_set_stations",
            call, spar_fluid_get_name(fluid[b]), b, (long long)nodes, (long long)forces);
        SPARI_TRY(check_packed(session, fluid[b], SPAR_ERR_ARGUMENT, call));
        *n = b == 0 ? nodes : *n;
        SPARI_AERO_REQUIRE(
            session, nodes == *n, SPAR_ERR_ARGUMENT,
            "%s: fluid '%s' of blade %d has %lld sections, blade 0 has %lld; give all blades the same number", call,
            spar_fluid_get_name(fluid[b]), b, (long long)nodes, (long long)*n);
    }
    return SPAR_OK;
}

/* Reference positions of the aerodynamic centres and the distances between them. */
static int find_centres(spar_aero *aero, const char *call) {
    for (int b = 0; b < aero->blades; b++) {
        double *x = aero->place + 3 * b * aero->n;
        SPARI_TRY(spar_fluid_get_nearest(aero->fluid[b], SPAR_NODES_MOTION, x, NULL, aero->x));
        for (int64_t i = 0; i < 3 * aero->n; i++) {
            x[i] += aero->x[i];
        }
        for (int64_t i = 0; i + 1 < aero->n; i++) {
            const double *a = x + 3 * i, *c = a + 3;
            double d[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]}, length = spari_norm(d);
            SPARI_AERO_REQUIRE(aero->session, length > 0.0, SPAR_ERR_ARGUMENT,
                               "%s: fluid '%s': sections %lld and %lld are at the same position", call,
                               spar_fluid_get_name(aero->fluid[b]), (long long)i, (long long)(i + 1));
            aero->length[b * aero->n + i] = length;
        }
    }
    return SPAR_OK;
}

int spar_aero_create(int blades, spar_fluid *const *sections, spar_aero **aero) {
    SPARI_AERO_REQUIRE(NULL, aero, SPAR_ERR_ARGUMENT, "%s: the pointer to the handle is NULL", __func__);
    SPARI_AERO_REQUIRE(NULL, blades >= 0 && (blades == 0 || sections), SPAR_ERR_ARGUMENT,
                       "%s: %d blades%s; give one fluid per blade", __func__, blades,
                       sections ? "" : " without fluids");
    int64_t n = 0;
    spar_session *session = NULL;
    int status = check_blade_fluids(blades, sections, __func__, &session, &n);
    SPARI_TRY(spari_aero_named(session, __func__, status));
    spar_aero *made = spari_zalloc(1, sizeof *made);
    SPARI_AERO_REQUIRE(session, made, SPAR_ERR_MEMORY, "%s: no memory", __func__);
    made->session = session;
    made->blades = blades;
    made->n = n;
    made->rotor = (spari_rotor){.turn = 1, .blades = blades, .effects = SPAR_AERO_DRAG};
    status = make_arrays(made);
    if (status != SPAR_OK) {
        spari_aero_fail(session, status, "%s: no memory for %d blades of %lld sections", __func__, blades,
                        (long long)n);
    } else {
        for (int b = 0; b < blades; b++) {
            made->fluid[b] = sections[b];
        }
        status = find_centres(made, __func__);
    }
    if (status != SPAR_OK) {
        aero_free(made);
        return spari_aero_named(session, __func__, status);
    }
    *aero = made;
    return SPAR_OK;
}

/* ---- description ---- */

#define REQUIRE_HANDLE(aero)                                                                                           \
    SPARI_AERO_REQUIRE(NULL, aero, SPAR_ERR_ARGUMENT, "%s: the aero object is NULL; create it with spar_aero_create",  \
                       __func__)

/* Effects that follow from the description, unless the host chose them. */
static int implied_effects(const spar_aero *aero) {
    if (aero->effects_given) {
        return aero->rotor.effects;
    }
    int effects = SPAR_AERO_DRAG | (aero->rotor_given ? momentum_effects : 0);
    effects |= aero->wind && aero->wind->has_shear ? SPAR_AERO_SHEAR : 0;
    effects |= aero->wind && aero->wind->has_tower ? SPAR_AERO_TOWER : 0;
    for (int64_t i = 0; i < aero->n; i++) {
        if (aero->section[i].table && spari_table_has_moment(aero->section[i].table)) {
            effects |= SPAR_AERO_MOMENT;
        }
    }
    return effects;
}

/* Allocates n doubles in *x unless they exist. */
static int have(double **x, int64_t n) {
    *x = *x ? *x : spari_zalloc(n, sizeof **x);
    return *x != NULL;
}

/* Whether moments are pushed. */
static int has_moments(int effects) {
    return (effects & (SPAR_AERO_MOMENT | SPAR_AERO_UNSTEADY)) != 0;
}

/* Allocates the memory of unsteady effects. */
static int have_memory(spar_aero *aero, int effects) {
    int64_t all = count(aero);
    int moving = (effects & SPAR_AERO_UNSTEADY) != 0;
    aero->was = aero->was ? aero->was : spari_zalloc(all, sizeof *aero->was);
    aero->is = aero->is ? aero->is : spari_zalloc(all, sizeof *aero->is);
    return aero->was && aero->is &&
           (!moving || (have(&aero->omega, 3 * all) && have(&aero->a, 3 * all) && have(&aero->omega_a, 3 * all)));
}

/* Stores the unsteady state of the sections with the fluids. As long as nothing is stored the fluids have no
   numbers, so nothing is lost if one of them fails. */
static int keep_states(const spar_aero *aero, const char *caller) {
    for (int b = 0; b < aero->blades; b++) {
        int64_t width;
        SPARI_TRY(spar_fluid_get_states(aero->fluid[b], &width, NULL));
        SPARI_AERO_REQUIRE(aero->session, width == 0 || width == SPARI_MEMORY_NUMBERS, SPAR_ERR_STATE,
                           "%s: fluid '%s' has %lld states per node set by the host (spar_fluid_set_states), but these "
                           "effects store their own states; set 0",
                           caller, spar_fluid_get_name(aero->fluid[b]), (long long)width);
        SPARI_TRY(spar_fluid_set_states(aero->fluid[b], SPARI_MEMORY_NUMBERS));
    }
    return SPAR_OK;
}

/* The section has got another polar. */
static void forget_attached(spar_aero *aero, int64_t i) {
    if (aero->attached) {
        aero->attached[i].known = 0;
    }
}

/* Attached-flow data of the sections that have polars. */
static int find_attached(spar_aero *aero) {
    aero->attached = aero->attached ? aero->attached : spari_zalloc(aero->n, sizeof *aero->attached);
    for (int64_t i = 0; aero->attached && i < aero->n; i++) {
        spari_attached *flow = aero->attached + i;
        if (aero->section[i].table && !flow->known) {
            spari_table_find_attached(aero->section[i].table, &flow->zero, &flow->slope);
            flow->known = 1;
        }
    }
    return aero->attached != NULL;
}

/* Puts effects in force, and allocates the memory that they and a rotor need. */
static int adopt(spar_aero *aero, int effects, const char *caller) {
    int64_t all = count(aero);
    int whole = !has_moments(effects) || have(&aero->moment, 3 * all);
    if (effects & memory_effects) {
        whole = have_memory(aero, effects) && whole;
    }
    whole = (!(effects & SPAR_AERO_STALL) || find_attached(aero)) && whole;
    if (effects & wind_effects) {
        aero->inside = aero->inside ? aero->inside : spari_zalloc(all, sizeof *aero->inside);
        whole = whole && have(&aero->met, 3 * all) && aero->inside;
    }
    whole = whole && (!aero->rotor_given || have(&aero->omega, 3 * all));
    if (aero->rotor_given && (effects & (SPAR_AERO_TIP_LOSS | SPAR_AERO_HUB_LOSS)) && !aero->loss_radius) {
        whole = whole && have(&aero->loss_radius, all);
        for (int64_t k = 0; whole && k < all; k++) {
            aero->loss_radius[k] = spari_rotor_radius(&aero->first, aero->place + 3 * k);
        }
    }
    SPARI_AERO_REQUIRE(aero->session, whole, SPAR_ERR_MEMORY, "%s: no memory for the effects", caller);
    if ((effects & memory_effects) && !(aero->rotor.effects & memory_effects)) {
        SPARI_TRY(spari_aero_named(aero->session, caller, keep_states(aero, caller)));
    }
    aero->rotor.effects = effects;
    return SPAR_OK;
}

int spar_aero_set_section(spar_aero *aero, int64_t i, double chord, double twist, const spar_polar *polar) {
    SPARI_GUARD_ENVIRONMENT;
    REQUIRE_HANDLE(aero);
    SPARI_AERO_REQUIRE(aero->session, i >= 0 && (aero->blades == 0 || i < aero->n), SPAR_ERR_ARGUMENT,
                       "%s: there is no section %lld; the blade has %lld, counted from 0", __func__, (long long)i,
                       (long long)aero->n);
    SPARI_AERO_REQUIRE(aero->session, isfinite(chord) && chord >= 0.0, SPAR_ERR_ARGUMENT,
                       "%s: section %lld: chord %g; give a length >= 0", __func__, (long long)i, chord);
    SPARI_AERO_REQUIRE(aero->session, isfinite(twist), SPAR_ERR_ARGUMENT,
                       "%s: section %lld: the twist is not finite; give a finite angle, rad", __func__, (long long)i);
    SPARI_AERO_REQUIRE(aero->session, polar, SPAR_ERR_ARGUMENT, "%s: section %lld: the polar is NULL", __func__,
                       (long long)i);
    if (aero->blades == 0) {
        return SPAR_OK;
    }
    spari_section old = aero->section[i];
    aero->section[i] = (spari_section){chord, cos(twist), sin(twist), spari_polar_share(polar)};
    forget_attached(aero, i);
    int status = adopt(aero, implied_effects(aero), __func__);
    if (status != SPAR_OK) {
        spari_table_release(aero->section[i].table);
        aero->section[i] = old;
        forget_attached(aero, i);
        (void)(aero->attached && find_attached(aero));
        return status;
    }
    spari_table_release(old.table);
    for (int b = 0; b < aero->blades; b++) {
        aero->row[b * aero->n + i] = 0; /* the old one may be beyond the new table */
    }
    return SPAR_OK;
}

int spar_aero_set_rotor(spar_aero *aero, const double hub[3], const double axis[3], double hub_radius,
                        double tip_radius) {
    SPARI_GUARD_ENVIRONMENT;
    REQUIRE_HANDLE(aero);
    SPARI_AERO_REQUIRE(aero->session, hub && axis, SPAR_ERR_ARGUMENT, "%s: hub or axis is NULL", __func__);
    SPARI_AERO_REQUIRE(aero->session, spari_first_nonfinite(hub, 3) < 0 && spari_first_nonfinite(axis, 3) < 0,
                       SPAR_ERR_ARGUMENT, "%s: hub or axis has an entry that is not finite; give finite numbers",
                       __func__);
    double length = hypot(hypot(axis[0], axis[1]), axis[2]);
    SPARI_AERO_REQUIRE(aero->session, isfinite(length) && length > 0.0, SPAR_ERR_ARGUMENT,
                       "%s: the axis has length %g; give a direction, pointing downwind", __func__, length);
    SPARI_AERO_REQUIRE(aero->session, hub_radius >= 0.0 && tip_radius > hub_radius && isfinite(tip_radius),
                       SPAR_ERR_ARGUMENT, "%s: hub radius %g, tip radius %g; give 0 <= hub radius < tip radius",
                       __func__, hub_radius, tip_radius);
    spari_rotor old = aero->rotor;
    int was_given = aero->rotor_given;
    for (int i = 0; i < 3; i++) {
        aero->rotor.hub[i] = hub[i];
        aero->rotor.axis[i] = axis[i] / length;
    }
    aero->rotor.hub_radius = hub_radius;
    aero->rotor.tip_radius = tip_radius;
    aero->first = was_given ? aero->first : aero->rotor;
    aero->rotor_given = 1;
    int status = adopt(aero, implied_effects(aero), __func__);
    if (status != SPAR_OK) {
        aero->rotor = old;
        aero->rotor_given = was_given;
    }
    return status;
}

/* Allocates the description of the wind. */
static int have_wind(spar_aero *aero, const char *caller) {
    aero->wind = aero->wind ? aero->wind : spari_zalloc(1, sizeof *aero->wind);
    SPARI_AERO_REQUIRE(aero->session, aero->wind, SPAR_ERR_MEMORY, "%s: no memory for the wind", caller);
    return SPAR_OK;
}

/* Puts the new description in force, or restores the old one. */
static int adopt_wind(spar_aero *aero, const spari_wind *old, const char *caller) {
    int status = adopt(aero, implied_effects(aero), caller);
    if (status != SPAR_OK) {
        *aero->wind = *old;
    }
    return status;
}

/* Checks the arguments of a shear law; the messages name the allowed range. */
static int check_shear(const spar_aero *aero, int law, double height, double parameter, const char *call) {
    SPARI_AERO_REQUIRE(aero->session, law >= SPAR_SHEAR_POWER && law <= SPAR_SHEAR_LINEAR, SPAR_ERR_ARGUMENT,
                       "%s: shear law %d is not known; give SPAR_SHEAR_POWER, _LOG or _LINEAR", call, law);
    SPARI_AERO_REQUIRE(aero->session, isfinite(height) && height > 0.0, SPAR_ERR_ARGUMENT,
                       "%s: the reference height is %g; give one > 0 above the ground", call, height);
    SPARI_AERO_REQUIRE(aero->session, isfinite(parameter), SPAR_ERR_ARGUMENT,
                       "%s: the parameter is not finite; give a finite number", call);
    SPARI_AERO_REQUIRE(aero->session, law != SPAR_SHEAR_POWER || parameter >= 0.0, SPAR_ERR_ARGUMENT,
                       "%s: exponent %g; give one >= 0", call, parameter);
    SPARI_AERO_REQUIRE(
        aero->session, law != SPAR_SHEAR_LOG || (parameter > 0.0 && parameter < height), SPAR_ERR_ARGUMENT,
        "%s: roughness length %g, reference height %g; give 0 < roughness length < height", call, parameter, height);
    return SPAR_OK;
}

/* Direction and length of v; the length must not be zero. */
static int find_direction(const spar_aero *aero, const double v[3], double unit[3], double *length, const char *what,
                          const char *call) {
    *length = spari_first_nonfinite(v, 3) < 0 ? hypot(hypot(v[0], v[1]), v[2]) : NAN;
    SPARI_AERO_REQUIRE(aero->session, isfinite(*length) && *length > 0.0, SPAR_ERR_ARGUMENT,
                       "%s: %s has length %g; give a finite one, not 0", call, what, *length);
    for (int i = 0; i < 3; i++) {
        unit[i] = v[i] / *length;
    }
    return SPAR_OK;
}

int spar_aero_set_shear(spar_aero *aero, int law, const double ground[3], const double up[3], double height,
                        double parameter) {
    SPARI_GUARD_ENVIRONMENT;
    REQUIRE_HANDLE(aero);
    SPARI_AERO_REQUIRE(aero->session, ground && up, SPAR_ERR_ARGUMENT, "%s: ground or up is NULL", __func__);
    SPARI_AERO_REQUIRE(aero->session, spari_first_nonfinite(ground, 3) < 0, SPAR_ERR_ARGUMENT,
                       "%s: the point on the ground has an entry that is not finite; give finite numbers", __func__);
    spari_shear made = {.law = law, .height = height, .parameter = parameter};
    double length;
    SPARI_TRY(find_direction(aero, up, made.up, &length, "the upward direction", __func__));
    SPARI_TRY(check_shear(aero, law, height, parameter, __func__));
    memcpy(made.ground, ground, sizeof made.ground);
    SPARI_TRY(have_wind(aero, __func__));
    spari_wind old = *aero->wind;
    aero->wind->shear = made;
    aero->wind->has_shear = 1;
    return adopt_wind(aero, &old, __func__);
}

int spar_aero_set_tower(spar_aero *aero, const double base[3], const double top[3], double base_radius,
                        double top_radius) {
    SPARI_GUARD_ENVIRONMENT;
    REQUIRE_HANDLE(aero);
    SPARI_AERO_REQUIRE(aero->session, base && top, SPAR_ERR_ARGUMENT, "%s: base or top is NULL", __func__);
    SPARI_AERO_REQUIRE(aero->session, spari_first_nonfinite(base, 3) < 0 && spari_first_nonfinite(top, 3) < 0,
                       SPAR_ERR_ARGUMENT, "%s: base or top has an entry that is not finite; give finite numbers",
                       __func__);
    double axis[3] = {top[0] - base[0], top[1] - base[1], top[2] - base[2]};
    spari_tower made = {.base_radius = base_radius, .top_radius = top_radius};
    SPARI_TRY(find_direction(aero, axis, made.up, &made.length, "the vector from base to top", __func__));
    SPARI_AERO_REQUIRE(aero->session,
                       isfinite(base_radius) && base_radius > 0.0 && isfinite(top_radius) && top_radius > 0.0,
                       SPAR_ERR_ARGUMENT, "%s: radii %g at the base, %g at the top; give lengths > 0", __func__,
                       base_radius, top_radius);
    memcpy(made.top, top, sizeof made.top);
    SPARI_TRY(have_wind(aero, __func__));
    spari_wind old = *aero->wind;
    aero->wind->tower = made;
    aero->wind->has_tower = 1;
    return adopt_wind(aero, &old, __func__);
}

int spar_aero_set_turn(spar_aero *aero, int turn) {
    REQUIRE_HANDLE(aero);
    SPARI_AERO_REQUIRE(
        aero->session, turn == 1 || turn == -1, SPAR_ERR_ARGUMENT,
        "%s: the direction of rotation is %d; give 1 for right-handed about the downwind axis, -1 for left-handed",
        __func__, turn);
    aero->rotor.turn = turn;
    return SPAR_OK;
}

int spar_aero_set_blades(spar_aero *aero, int total) {
    REQUIRE_HANDLE(aero);
    SPARI_AERO_REQUIRE(aero->session, total >= aero->blades, SPAR_ERR_ARGUMENT,
                       "%s: %d blades in total, but %d of them are on this rank", __func__, total, aero->blades);
    aero->rotor.blades = total;
    return SPAR_OK;
}

int spar_aero_set_effects(spar_aero *aero, int effects) {
    SPARI_GUARD_ENVIRONMENT;
    REQUIRE_HANDLE(aero);
    SPARI_AERO_REQUIRE(aero->session, (effects & ~SPARI_AERO_ALL) == 0, SPAR_ERR_ARGUMENT,
                       "%s: effects is %d; give a combination of SPAR_AERO_ effects", __func__, effects);
    SPARI_TRY(adopt(aero, effects, __func__));
    aero->effects_given = 1;
    return SPAR_OK;
}

/* ---- solve ---- */

/* Checks that the fluids are unchanged since creation, mapped, and would accept loads: a late refusal would leave
   the others with new loads. */
static int check_blades(const spar_aero *aero, const char *call) {
    int phase = SPAR_PHASE_START;
    SPARI_TRY(aero->blades > 0 ? spar_session_get_phase(aero->session, &phase) : SPAR_OK);
    for (int b = 0; b < aero->blades; b++) {
        const spar_fluid *fluid = aero->fluid[b];
        int64_t motion, force;
        SPARI_TRY(spar_fluid_get_count(fluid, SPAR_NODES_MOTION, &motion));
        SPARI_TRY(spar_fluid_get_count(fluid, SPAR_NODES_FORCE, &force));
        SPARI_AERO_REQUIRE(
            aero->session, motion == aero->n && force == aero->n, SPAR_ERR_STATE,
            "%s: fluid '%s' had %lld sections when the aero object was created and has %lld motion and %lld "
            "force nodes now; make a new one",
            call, spar_fluid_get_name(fluid), (long long)aero->n, (long long)motion, (long long)force);
        SPARI_TRY(check_packed(aero->session, fluid, SPAR_ERR_STATE, call));
        SPARI_TRY(spar_fluid_get_map(fluid, SPAR_NODES_MOTION, NULL, NULL, NULL));
        SPARI_TRY(spar_fluid_get_map(fluid, SPAR_NODES_FORCE, NULL, NULL, NULL));
    }
    SPARI_AERO_REQUIRE(
        aero->session, phase != SPAR_PHASE_BETWEEN, SPAR_ERR_STATE,
        "%s: no step is in progress; call it between spar_step_begin and spar_step_accept, or before the first "
        "step",
        call);
    return SPAR_OK;
}

static int check_described(const spar_aero *aero, const char *call) {
    for (int64_t i = 0; i < aero->n; i++) {
        SPARI_AERO_REQUIRE(aero->session, aero->section[i].table, SPAR_ERR_STATE,
                           "%s: section %lld has no chord and polar; call spar_aero_set_section", call, (long long)i);
    }
    return SPAR_OK;
}

/* Unsteady effects need whole steps. */
static int check_remembered(const spar_aero *aero, double theta, const char *call) {
    for (int b = 0; b < aero->blades && (aero->rotor.effects & memory_effects) != 0; b++) {
        double dt;
        int64_t numbers;
        SPARI_TRY(spar_fluid_get_states(aero->fluid[b], &numbers, &dt));
        SPARI_AERO_REQUIRE(
            aero->session, numbers == SPARI_MEMORY_NUMBERS, SPAR_ERR_STATE,
            "%s: fluid '%s' has %lld states per node instead of the %d that the effects with memory (inflow, "
            "stall, unsteady) need; call spar_aero_set_effects without these effects, then with them",
            call, spar_fluid_get_name(aero->fluid[b]), (long long)numbers, SPARI_MEMORY_NUMBERS);
        SPARI_AERO_REQUIRE(
            aero->session, theta >= 1.0 || dt <= 0.0, SPAR_ERR_ARGUMENT,
            "%s: theta is %g; effects with memory (inflow, stall, unsteady) advance from t^n to t^{n+1}; give 1", call,
            theta);
    }
    return SPAR_OK;
}

static int check_solve(const spar_aero *aero, double density, const double *inflow, double theta, const char *call) {
    spar_session *session = aero->session;
    SPARI_AERO_REQUIRE(session, isfinite(density) && density >= 0.0, SPAR_ERR_ARGUMENT,
                       "%s: density %g; give a number >= 0", call, density);
    SPARI_AERO_REQUIRE(session, theta >= 0.0 && theta <= 1.0, SPAR_ERR_ARGUMENT,
                       "%s: theta = %g lies outside [0,1]; 0 is t^n, 1 is t^{n+1}", call, theta);
    SPARI_AERO_REQUIRE(session, inflow || aero->blades == 0, SPAR_ERR_ARGUMENT, "%s: the inflow is NULL", call);
    SPARI_AERO_REQUIRE(session, aero->rotor_given || !(aero->rotor.effects & SPAR_AERO_INDUCTION), SPAR_ERR_STATE,
                       "%s: induction is requested but the rotor is not described; call spar_aero_set_rotor", call);
    SPARI_AERO_REQUIRE(session, (aero->wind && aero->wind->has_shear) || !(aero->rotor.effects & SPAR_AERO_SHEAR),
                       SPAR_ERR_STATE, "%s: shear is requested but not described; call spar_aero_set_shear", call);
    SPARI_AERO_REQUIRE(session, (aero->wind && aero->wind->has_tower) || !(aero->rotor.effects & SPAR_AERO_TOWER),
                       SPAR_ERR_STATE, "%s: a tower is requested but not described; call spar_aero_set_tower", call);
    SPARI_TRY(check_described(aero, call));
    int64_t bad = aero->blades > 0 ? spari_first_nonfinite(inflow, 3 * count(aero)) : -1;
    if (bad >= 0) {
        int blade = (int)(bad / (3 * aero->n));
        return spari_aero_fail(session, SPAR_ERR_ARGUMENT,
                               "%s: fluid '%s', blade %d, section %lld: component %d of the inflow is %g", call,
                               spar_fluid_get_name(aero->fluid[blade]), blade, (long long)(bad / 3 % aero->n),
                               (int)(bad % 3), inflow[bad]);
    }
    SPARI_TRY(check_blades(aero, call));
    return check_remembered(aero, theta, call);
}

static int pull_centres(spar_aero *aero, double theta) {
    for (int b = 0; b < aero->blades; b++) {
        int64_t at = b * aero->n;
        int moving = (aero->rotor.effects & SPAR_AERO_UNSTEADY) != 0;
        double *omega = aero->rotor_given || moving ? aero->omega + 3 * at : NULL;
        SPARI_TRY(spar_fluid_pull_poses(aero->fluid[b], SPAR_NODES_MOTION, theta, aero->x + 3 * at, aero->q + 4 * at,
                                        aero->v + 3 * at, omega, moving ? aero->a + 3 * at : NULL,
                                        moving ? aero->omega_a + 3 * at : NULL));
    }
    return SPAR_OK;
}

/* Consistent nodal loads of loads per length (element.load from `from` on), linear over each interval of a blade. */
static void lump(const spar_aero *aero, int blade, int from, double *node) {
    int64_t at = blade * aero->n;
    memset(node + 3 * at, 0, (size_t)(3 * aero->n) * sizeof *node);
    for (int64_t i = at; i + 1 < at + aero->n; i++) {
        double sixth = aero->length[i] / 6.0;
        const double *f = aero->element[i].load + from, *g = aero->element[i + 1].load + from;
        for (int c = 0; c < 3; c++) {
            double *to = node + 3 * i + c;
            to[0] += sixth * (2.0 * f[c] + g[c]);
            to[3] += sixth * (f[c] + 2.0 * g[c]);
        }
    }
}

/* Checks that the sums of loads of all fluids stay in the range of numbers. */
static int check_loads(const spar_aero *aero, const double *load, const char *what, const char *call) {
    for (int64_t i = 0; i < 3 * count(aero); i++) {
        SPARI_AERO_REQUIRE(aero->session, fabs(load[i]) < 1e200, SPAR_ERR_NUMERIC,
                           "%s: fluid '%s', blade %lld, section %lld: %s is %g; check density, inflow and chords", call,
                           spar_fluid_get_name(aero->fluid[i / (3 * aero->n)]), (long long)(i / (3 * aero->n)),
                           (long long)(i / 3 % aero->n), what, load[i]);
    }
    return SPAR_OK;
}

/* Checks the unsteady states before anything is pushed: a refused call changes nothing. */
static int check_unsteady(const spar_aero *aero, const char *call) {
    for (int64_t k = 0; k < count(aero); k++) {
        int64_t bad = spari_first_nonfinite((const double *)(const void *)(aero->is + k), SPARI_MEMORY_NUMBERS);
        SPARI_AERO_REQUIRE(
            aero->session, bad < 0, SPAR_ERR_NUMERIC,
            "%s: fluid '%s', blade %lld, section %lld: an unsteady state is %g; check the chord and the inflow", call,
            spar_fluid_get_name(aero->fluid[k / aero->n]), (long long)(k / aero->n), (long long)(k % aero->n),
            ((const double *)(const void *)(aero->is + k))[bad]);
    }
    return SPAR_OK;
}

/* Wind at the sections with shear and tower. */
static const double *meet_wind(spar_aero *aero, const double *inflow) {
    for (int64_t k = 0; k < count(aero); k++) {
        aero->inside[k] =
            spari_wind_meet(aero->wind, aero->rotor.effects, aero->x + 3 * k, inflow + 3 * k, aero->met + 3 * k);
    }
    return aero->met;
}

static void flag_inside(spar_aero *aero) {
    for (int64_t k = 0; k < count(aero); k++) {
        aero->element[k].flags |= aero->inside[k];
    }
}

/* Unsteady state at t^n, and the time since. A rank without blades has none. */
static int recall_sections(spar_aero *aero, double *dt) {
    *dt = 0.0;
    for (int b = 0; b < aero->blades; b++) {
        SPARI_TRY(spar_fluid_get_states(aero->fluid[b], NULL, dt));
        SPARI_TRY(
            spar_fluid_pull_states(aero->fluid[b], SPARI_MEMORY_NUMBERS, (double *)(void *)(aero->was + b * aero->n)));
    }
    for (int64_t k = 0; k < count(aero); k++) {
        aero->is[k] = aero->was[k];
        aero->is[k].begun = 0.0;
    }
    return SPAR_OK;
}

static int remember_sections(const spar_aero *aero) {
    for (int b = 0; b < aero->blades; b++) {
        SPARI_TRY(spar_fluid_push_states(aero->fluid[b], SPARI_MEMORY_NUMBERS,
                                         (const double *)(const void *)(aero->is + b * aero->n)));
    }
    return SPAR_OK;
}

/* Unsteady data of section i of a blade, number k of all. */
static spari_past past_of(const spar_aero *aero, int64_t i, int64_t k, double dt) {
    spari_past past = {.step = {dt, aero->was + k, aero->is + k}};
    past.attached = aero->attached ? aero->attached + i : NULL;
    if (aero->rotor.effects & SPAR_AERO_UNSTEADY) {
        past.omega = aero->omega + 3 * k;
        past.a = aero->a + 3 * k;
        past.omega_a = aero->omega_a + 3 * k;
    }
    return past;
}

/* The sections of all blades, some side by side. */
static void solve_sections(spar_aero *aero, double density, const double *inflow, int remembers, double dt) {
    int64_t all = count(aero);
    spari_rotor rotor = aero->rotor;
    rotor.effects &= rotor.hub_radius > 0.0 ? ~0 : ~SPAR_AERO_HUB_LOSS;
    for (int64_t first = 0; first < all; first += SPARI_ANNULI) {
        const spari_section *section[SPARI_ANNULI];
        spari_centre station[SPARI_ANNULI];
        spari_past past[SPARI_ANNULI];
        int side_by_side = all - first < SPARI_ANNULI ? (int)(all - first) : SPARI_ANNULI;
        for (int l = 0; l < side_by_side; l++) {
            int64_t k = first + l, i = k % aero->n;
            section[l] = aero->section + i;
            if (remembers) {
                past[l] = past_of(aero, i, k, dt);
            }
            station[l] = (spari_centre){aero->x + 3 * k,
                                        aero->q + 4 * k,
                                        aero->v + 3 * k,
                                        inflow + 3 * k,
                                        aero->loss_radius ? aero->loss_radius[k] : 0.0,
                                        aero->row + k,
                                        remembers ? past + l : NULL};
        }
        spari_elements_solve(&rotor, 8, side_by_side, section, station, density, aero->element + first);
    }
}

static int solve_elements(spar_aero *aero, double density, const double *inflow, double theta, const char *call) {
    SPARI_TRY(check_solve(aero, density, inflow, theta, call));
    aero->solved = 0;
    SPARI_TRY(pull_centres(aero, theta));
    double dt = 0.0;
    int moments = has_moments(aero->rotor.effects), remembers = (aero->rotor.effects & memory_effects) != 0,
        changed = (aero->rotor.effects & wind_effects) != 0;
    inflow = changed ? meet_wind(aero, inflow) : inflow;
    SPARI_TRY(remembers ? recall_sections(aero, &dt) : SPAR_OK);
    solve_sections(aero, density, inflow, remembers, dt);
    for (int b = 0; b < aero->blades; b++) {
        lump(aero, b, 0, aero->force);
        if (moments) {
            lump(aero, b, 3, aero->moment);
        }
    }
    if (changed) {
        flag_inside(aero);
    }
    SPARI_TRY(check_loads(aero, aero->force, "a force", call));
    SPARI_TRY(moments ? check_loads(aero, aero->moment, "a moment", call) : SPAR_OK);
    SPARI_TRY(remembers ? check_unsteady(aero, call) : SPAR_OK);
    for (int b = 0; b < aero->blades; b++) {
        int64_t at = 3 * b * aero->n;
        SPARI_TRY(spar_fluid_push_forces(aero->fluid[b], aero->force + at, moments ? aero->moment + at : NULL));
    }
    SPARI_TRY(remembers ? remember_sections(aero) : SPAR_OK);
    aero->used = aero->rotor;
    aero->rotor_used = aero->rotor_given;
    aero->solved = 1;
    return SPAR_OK;
}

int spar_aero_solve(spar_aero *aero, double density, const double *inflow, double theta) {
    SPARI_GUARD_ENVIRONMENT;
    REQUIRE_HANDLE(aero);
    aero->solves++;
    int status = spari_aero_named(aero->session, __func__, solve_elements(aero, density, inflow, theta, __func__));
    if (status != SPAR_OK && aero->blades > 0) { /* a step must not go on with old loads */
        (void)spar_fluid_fail(aero->fluid[0], status, spar_session_message(aero->session));
    }
    return status;
}

/* ---- results ---- */

static int check_solved(const spar_aero *aero, const char *caller) {
    SPARI_AERO_REQUIRE(aero->session, aero->solved, SPAR_ERR_STATE, "%s: nothing is solved yet; call spar_aero_solve",
                       caller);
    return SPAR_OK;
}

/* Thrust, torque about the shaft and speed of the blades on this rank in the last solution. */
static void sum_rotor(const spar_aero *aero, double *thrust, double *torque, double *speed) {
    const spari_rotor *rotor = &aero->used;
    *thrust = *torque = *speed = 0.0;
    for (int64_t k = 0; k < count(aero); k++) {
        const double *x = aero->x + 3 * k, *f = aero->force + 3 * k;
        double arm[3] = {x[0] - rotor->hub[0], x[1] - rotor->hub[1], x[2] - rotor->hub[2]}, turn[3];
        spari_cross(arm, f, turn);
        *thrust += spari_dot(rotor->axis, f);
        *torque += spari_dot(rotor->axis, turn);
        if (has_moments(rotor->effects)) {
            *torque += spari_dot(rotor->axis, aero->moment + 3 * k);
        }
    }
    for (int b = 0; b < aero->blades; b++) {
        *speed += spari_dot(rotor->axis, aero->omega + 3 * b * aero->n) / aero->blades;
    }
}

int spar_aero_get_rotor(const spar_aero *aero, double *thrust, double *torque, double *power) {
    SPARI_GUARD_ENVIRONMENT;
    REQUIRE_HANDLE(aero);
    SPARI_TRY(check_solved(aero, __func__));
    SPARI_AERO_REQUIRE(aero->session, aero->rotor_used, SPAR_ERR_STATE,
                       "%s: there is no shaft; call spar_aero_set_rotor before spar_aero_solve", __func__);
    double thrust_now, torque_now, speed;
    sum_rotor(aero, &thrust_now, &torque_now, &speed);
    double value[] = {thrust_now, torque_now, torque_now * speed}, *out[] = {thrust, torque, power};
    for (int i = 0; i < 3; i++) {
        if (out[i]) {
            *out[i] = value[i];
        }
    }
    return SPAR_OK;
}

int spar_aero_get_sections(const spar_aero *aero, double *alpha, double *cl, double *cd, double *a,
                           double *a_tangential) {
    SPARI_GUARD_ENVIRONMENT;
    REQUIRE_HANDLE(aero);
    SPARI_TRY(check_solved(aero, __func__));
    double *out[] = {alpha, cl, cd, a, a_tangential};
    for (int64_t k = 0; k < count(aero); k++) {
        const spari_element *e = aero->element + k;
        double value[] = {e->alpha, e->cl, e->cd, e->a, e->a_tangential};
        for (int i = 0; i < 5; i++) {
            if (out[i]) {
                out[i][k] = value[i];
            }
        }
    }
    return SPAR_OK;
}

int spar_aero_get_chord(const spar_aero *aero, double *chord, double *twist) {
    SPARI_GUARD_ENVIRONMENT;
    REQUIRE_HANDLE(aero);
    SPARI_TRY(check_described(aero, __func__));
    for (int64_t i = 0; i < aero->n; i++) {
        const spari_section *section = aero->section + i;
        if (chord) {
            chord[i] = section->chord;
        }
        if (twist) {
            twist[i] = atan2(section->sin_twist, section->cos_twist);
        }
    }
    return SPAR_OK;
}

int spar_aero_get_polar(const spar_aero *aero, int64_t i, int64_t *n, int64_t capacity, double *alpha_rad, double *cl,
                        double *cd, double *cm, int *kind) {
    SPARI_GUARD_ENVIRONMENT;
    REQUIRE_HANDLE(aero);
    SPARI_AERO_REQUIRE(aero->session, i >= 0 && (aero->blades == 0 || i < aero->n), SPAR_ERR_ARGUMENT,
                       "%s: there is no section %lld; the blade has %lld, counted from 0", __func__, (long long)i,
                       (long long)aero->n);
    SPARI_AERO_REQUIRE(aero->session, capacity >= 0 && capacity <= SPARI_MOST, SPAR_ERR_ARGUMENT,
                       "%s: capacity is %lld; give the length of the arrays, 0 to 2^40", __func__, (long long)capacity);
    SPARI_TRY(check_described(aero, __func__));
    if (aero->blades > 0) {
        double *const value[] = {cl, cd, cm};
        int64_t rows = spari_table_rows(aero->section[i].table, capacity, alpha_rad, value, kind);
        if (n) {
            *n = rows;
        }
    }
    return SPAR_OK;
}

int spar_aero_get_flags(const spar_aero *aero, int *flags, int64_t *no_root) {
    REQUIRE_HANDLE(aero);
    SPARI_TRY(check_solved(aero, __func__));
    int64_t lost = 0;
    for (int64_t k = 0; k < count(aero); k++) {
        lost += (aero->element[k].flags & SPAR_AERO_FLAG_NO_ROOT) != 0;
        if (flags) {
            flags[k] = aero->element[k].flags;
        }
    }
    if (no_root) {
        *no_root = lost;
    }
    return SPAR_OK;
}

int spar_aero_get_loads(const spar_aero *aero, double *per_length, double *force, double *moment) {
    SPARI_GUARD_ENVIRONMENT;
    REQUIRE_HANDLE(aero);
    SPARI_TRY(check_solved(aero, __func__));
    size_t bytes = (size_t)(3 * count(aero)) * sizeof(double);
    for (int64_t k = 0; per_length && k < count(aero); k++) {
        memcpy(per_length + 6 * k, aero->element[k].load, sizeof aero->element[k].load);
    }
    if (force && bytes > 0) {
        memcpy(force, aero->force, bytes);
    }
    if (moment && bytes > 0 && has_moments(aero->used.effects)) {
        memcpy(moment, aero->moment, bytes);
    } else if (moment && bytes > 0) {
        memset(moment, 0, bytes);
    }
    return SPAR_OK;
}
