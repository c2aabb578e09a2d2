/* The host's floating-point traps and locale, held while the library computes. */
#include "quiet.h"

#include <pthread.h>

static _Thread_local spari_host host;

static locale_t c_locale;

static void make_locale(void) {
    c_locale = newlocale(LC_ALL_MASK, "C", (locale_t)0);
}

static void hold(void) {
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    (void)feholdexcept(&host.environment);
    pthread_once(&once, make_locale);
    host.locale = uselocale(c_locale); /* without one: it stays */
}

static void give_back(void) {
    (void)uselocale(host.locale);
    (void)fesetenv(&host.environment);
}

void spari_quiet_begin(void) {
    if (host.depth++ == 0) {
        hold();
    }
}

void spari_quiet_end(void) {
    if (--host.depth == 0) {
        give_back();
    }
}

void spari_host_begin(spari_host *inside) {
    *inside = host;
    host.depth = 0;
    if (inside->depth > 0) {
        give_back();
    }
}

void spari_host_end(const spari_host *inside) {
    if (inside->depth > 0) { /* what the host has changed stays changed */
        hold();
    }
    host.depth = inside->depth;
}
