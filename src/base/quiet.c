/* The host's floating-point traps, rounding, locale and GSL error handler, held while the library computes. */
#include "quiet.h"

#include <gsl/gsl_errno.h>
#include <pthread.h>

static _Thread_local spari_host host;

static locale_t c_locale;

static void make_locale(void) {
    c_locale = newlocale(LC_ALL_MASK, "C", (locale_t)0);
}

/* GSL has one error handler for the whole process, and its default one (NULL) aborts: off while any thread is inside.
 */
static pthread_mutex_t handler_lock = PTHREAD_MUTEX_INITIALIZER;
static gsl_error_handler_t *host_handler;
static int threads_inside;

static void hold_handler(void) {
    (void)pthread_mutex_lock(&handler_lock);
    if (threads_inside++ == 0) {
        host_handler = gsl_set_error_handler_off();
    }
    (void)pthread_mutex_unlock(&handler_lock);
}

static void give_handler_back(void) {
    (void)pthread_mutex_lock(&handler_lock);
    if (--threads_inside == 0) {
        (void)gsl_set_error_handler(host_handler);
    }
    (void)pthread_mutex_unlock(&handler_lock);
}

static void hold(void) {
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    (void)feholdexcept(&host.environment);
    if (fegetround() != FE_TONEAREST) {
        (void)fesetround(FE_TONEAREST);
    }
    pthread_once(&once, make_locale);
    host.locale = uselocale(c_locale); /* without one: it stays */
    hold_handler();
}

static void give_back(void) {
    give_handler_back();
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
