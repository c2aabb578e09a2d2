/* Options of a fluid: one table, used by the setter and the getter. A new option is a field of the fluid, a row here,
   and the code that uses it. Each concerns this rank's nodes alone, so ranks may differ. */
#include "../base/environment.h"
#include "../base/setting.h"
#include "state.h"

#include <float.h>
#include <stddef.h>

#define FLUID_WORD(key, field, zero, one)                                                                              \
    {                                                                                                                  \
        "option " key, key, offsetof(spar_fluid, options.field), SPARI_IS_WORD, 0, 0, 1, zero " or " one, {zero, one}, \
            0, 0                                                                                                       \
    }
#define FLUID_REAL(key, field)                                                                                         \
    {                                                                                                                  \
        "option " key, key, offsetof(spar_fluid, options.field), SPARI_IS_REAL, 0, -DBL_MAX, DBL_MAX,                  \
            "a finite number of seconds", {NULL, NULL}, 0, 0                                                           \
    }
static const spari_setting options[] = {
    FLUID_WORD("theta", theta_on_group, "average", "group"),
    FLUID_WORD("far", far_refuse, "take", "refuse"),
    FLUID_WORD("audit", audit_off, "on", "off"),
    FLUID_WORD("velocity", own_velocity, "pulled", "own"),
    FLUID_REAL("ramp", ramp),
    FLUID_REAL("ramp.start", ramp_start),
};
enum { OPTIONS = sizeof options / sizeof *options };

static int fluid_option(const spar_fluid *fluid, const char *call, const char *key, const spari_setting **of) {
    char keys[SPARI_MESSAGE_SIZE / 2];
    *of = spari_setting_find(options, OPTIONS, 0, key);
    SPARI_FLUID_REQUIRE_OF(fluid, call, *of, SPAR_ERR_ARGUMENT, "there is no option '%s'; give one of %s", key,
                           spari_setting_keys(options, OPTIONS, 0, keys, sizeof keys));
    return SPAR_OK;
}

int spar_fluid_set_option(spar_fluid *fluid, const char *key, const char *value) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_FLUID_HANDLE(fluid);
    SPARI_TRY(spari_fluid_check_idle(fluid, __func__));
    SPARI_FLUID_REQUIRE(fluid, key && value, SPAR_ERR_ARGUMENT, "key or value is NULL");
    const spari_setting *of;
    SPARI_TRY(fluid_option(fluid, __func__, key, &of));
    double x;
    SPARI_FLUID_REQUIRE(fluid, spari_setting_read(of, value, &x), SPAR_ERR_ARGUMENT,
                        "option '%s' does not accept '%s'; give %s", key, value, of->range);
    spari_setting_store(fluid, of, x);
    return SPAR_OK;
}

int spar_fluid_get_option(const spar_fluid *fluid, const char *key, int64_t capacity, char *text) {
    SPARI_GUARD_ENVIRONMENT;
    SPARI_FLUID_HANDLE(fluid);
    SPARI_FLUID_REQUIRE(fluid, key && text, SPAR_ERR_ARGUMENT, "key or text is NULL");
    const spari_setting *of;
    SPARI_TRY(fluid_option(fluid, __func__, key, &of));
    return spari_setting_write(fluid->member->session, __func__, of, spari_setting_value(fluid, of), capacity, text);
}
