#include "alloc.h"

#include <errno.h>
#include <execinfo.h>
#include <link.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

enum { RANGES = 16, SLOTS = 1 << 17 };

static _Thread_local int armed __attribute__((tls_model("initial-exec")));
static int64_t counted, fail_at, show_at, live[ALLOC_ASKERS];
static int hit, libc_too;

/* ---- who asks ---- */

typedef struct range {
    uintptr_t from, to;
    int who;
} range;

static range ranges[RANGES];
static int range_count;

static int add_range(struct dl_phdr_info *info, size_t size, void *context) {
    int *first = context, who = *first                                  ? ALLOC_OWN /* the program itself comes first */
                                : strstr(info->dlpi_name, "/libgsl.so") ? ALLOC_GSL
                                : strstr(info->dlpi_name, "/libc.so")   ? ALLOC_LIBC
                                                                        : ALLOC_NOBODY;
    (void)size;
    if (who != ALLOC_NOBODY) {
        for (int i = 0; i < info->dlpi_phnum && range_count < RANGES; i++) {
            if (info->dlpi_phdr[i].p_type == PT_LOAD) {
                uintptr_t from = info->dlpi_addr + info->dlpi_phdr[i].p_vaddr;
                ranges[range_count++] = (range){from, from + info->dlpi_phdr[i].p_memsz, who};
            }
        }
    }
    *first = 0;
    return 0;
}

static int who_is(const void *caller) {
    for (int i = 0; i < range_count; i++) {
        if ((uintptr_t)caller >= ranges[i].from && (uintptr_t)caller < ranges[i].to) {
            return ranges[i].who;
        }
    }
    return ALLOC_NOBODY;
}

/* ---- what is alive: open addressing, in memory that is there from the start ---- */

static uintptr_t slot[SLOTS];
static int64_t number[SLOTS]; /* the how manieth it was */
static unsigned char asker[SLOTS];
static atomic_flag busy = ATOMIC_FLAG_INIT;

static size_t place(uintptr_t p) {
    return (size_t)((p >> 4) * UINT64_C(0x9E3779B97F4A7C15) >> 47);
}

static void lock(void) {
    while (atomic_flag_test_and_set(&busy)) {
    }
}

static void remember(void *p, int who) {
    if (p) {
        lock();
        size_t k = place((uintptr_t)p);
        while (slot[k] > 1) {
            k = (k + 1) % SLOTS;
        }
        slot[k] = (uintptr_t)p;
        number[k] = counted;
        asker[k] = (unsigned char)who;
        live[who]++;
        atomic_flag_clear(&busy);
    }
}

/* Who had asked for it. */
static int forget(const void *p) {
    int who = ALLOC_NOBODY;
    if (p && live[ALLOC_OWN] + live[ALLOC_GSL] + live[ALLOC_LIBC] > 0) {
        lock();
        size_t k = place((uintptr_t)p);
        while (slot[k] != 0 && slot[k] != (uintptr_t)p) {
            k = (k + 1) % SLOTS;
        }
        if (slot[k] != 0) {
            who = asker[k];
            live[who]--;
            slot[k] = slot[(k + 1) % SLOTS] == 0 ? 0 : 1; /* 1: was taken */
        }
        atomic_flag_clear(&busy);
    }
    return who;
}

/* ---- control ---- */

int alloc_arm(int on) {
    int before = armed;
    if (range_count == 0) {
        int first = 1;
        dl_iterate_phdr(add_range, &first);
    }
    armed = on;
    return before;
}

void alloc_begin(int64_t k) {
    memset(slot, 0, sizeof slot);
    memset(live, 0, sizeof live);
    counted = 0;
    hit = 0;
    fail_at = k;
}

int64_t alloc_counted(void) {
    return counted;
}

int alloc_hit(void) {
    return hit;
}

int64_t alloc_live(int who) {
    return live[who];
}

int64_t alloc_oldest(void) {
    int64_t oldest = 0;
    for (size_t k = 0; k < SLOTS; k++) {
        oldest = slot[k] > 1 && (oldest == 0 || number[k] < oldest) ? number[k] : oldest;
    }
    return oldest;
}

void alloc_show(int64_t k) {
    show_at = k;
}

void alloc_with_libc(int on) {
    libc_too = on;
}

/* Who asks, if that counts; -1: this one fails */
static int judge(const void *caller) {
    int who = armed ? who_is(caller) : ALLOC_NOBODY;
    if (who == ALLOC_NOBODY || (who == ALLOC_LIBC && !libc_too)) {
        return ALLOC_NOBODY;
    }
    if (++counted == show_at) {
        void *from[16];
        armed = 0;
        backtrace_symbols_fd(from, backtrace(from, 16), 1);
        armed = 1;
    }
    if (counted == fail_at) {
        hit = who;
        errno = ENOMEM;
        return -1;
    }
    return who;
}

/* ---- the calls themselves ---- */

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || defined(ALLOC_WRAP)
#define CALL_NAME(name) __wrap_##name
#define REAL(name) __real_##name
#else
#define CALL_NAME(name) name
#define REAL(name) __libc_##name
#endif
extern void *REAL(malloc)(size_t n);
extern void *REAL(calloc)(size_t n, size_t size);
extern void *REAL(realloc)(void *p, size_t n);
extern void REAL(free)(void *p);
void *CALL_NAME(malloc)(size_t n);
void *CALL_NAME(calloc)(size_t n, size_t size);
void *CALL_NAME(realloc)(void *p, size_t n);
void CALL_NAME(free)(void *p);

static void *made(void *p, int who) {
    if (who != ALLOC_NOBODY) {
        remember(p, who);
    }
    return p;
}

void *CALL_NAME(malloc)(size_t n) {
    int who = judge(__builtin_return_address(0));
    return who < 0 ? NULL : made(REAL(malloc)(n), who);
}

void *CALL_NAME(calloc)(size_t n, size_t size) {
    int who = judge(__builtin_return_address(0));
    return who < 0 ? NULL : made(REAL(calloc)(n, size), who);
}

void *CALL_NAME(realloc)(void *p, size_t n) {
    int who = judge(__builtin_return_address(0));
    if (who < 0) {
        return NULL;
    }
    int was = forget(p);
    void *q = REAL(realloc)(p, n);
    return made(q ? q : p, was != ALLOC_NOBODY ? was : q ? who : ALLOC_NOBODY) == q ? q : NULL;
}

void CALL_NAME(free)(void *p) {
    (void)forget(p);
    REAL(free)(p);
}
