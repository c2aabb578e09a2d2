/* Sessions of several threads at once: each thread plays all scenes of tests/torture/memory (every public function),
   each in an order of its own, and all begin together, so that what is set up at the first use is raced for. The
   numbers must be those of the scenes played by one thread, to the last bit; under ThreadSanitizer nothing may be raced
   for.

     threads [rounds] */
#include "../memory/alloc.h"
#include "../memory/scenario.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

enum { THREADS = 4, ACTS_MAX = 32 };

/* Nothing is counted here. */
int alloc_arm(int on) {
    return on && 0;
}

int64_t alloc_counted(void) {
    return 0;
}

int alloc_hit(void) {
    return ALLOC_NOBODY;
}

typedef struct player {
    int number, complaints;
    char folder[40];
    uint64_t digest[ACTS_MAX];
} player;

static pthread_barrier_t start;

/* What takes its decisions by the clock has no numbers of its own. */
static void play(player *p, int i) {
    scenario_begin();
    acts[i].run();
    p->digest[i] = acts[i].repeats ? scenario_digest() : 0;
    p->complaints += scenario_complaints();
}

static void *play_all(void *context) {
    player *p = context;
    scenario_set(0, 1, p->folder);
    (void)pthread_barrier_wait(&start);
    for (int i = 0; i < act_count; i++) {
        play(p, (i + p->number * act_count / THREADS) % act_count);
    }
    return NULL;
}

static int clean(const char *folder) {
    char command[80];
    (void)snprintf(command, sizeof command, "rm -rf %s", folder);
    return system(command);
}

static int round_of(player players[THREADS + 1]) {
    pthread_t thread[THREADS];
    int faults = 0;
    for (int k = 0; k < THREADS; k++) {
        if (pthread_create(&thread[k], NULL, play_all, &players[k]) != 0) {
            return 1;
        }
    }
    for (int k = 0; k < THREADS; k++) {
        (void)pthread_join(thread[k], NULL);
    }
    player *alone = &players[THREADS]; /* afterwards: nothing has been set up before the threads */
    scenario_set(0, 1, alone->folder);
    for (int i = 0; i < act_count; i++) {
        play(alone, i);
        for (int k = 0; k < THREADS; k++) {
            if (players[k].digest[i] != alone->digest[i]) {
                printf("thread %d: %s: other numbers than alone\n", k, acts[i].name);
                faults++;
            }
        }
    }
    for (int k = 0; k <= THREADS; k++) {
        faults += players[k].complaints;
    }
    return faults;
}

int main(int argc, char **argv) {
    player players[THREADS + 1] = {{0}};
    int rounds = argc > 1 ? atoi(argv[1]) : 1, faults = act_count > ACTS_MAX;
    for (int k = 0; k <= THREADS; k++) {
        players[k].number = k;
        (void)snprintf(players[k].folder, sizeof players[k].folder, "/tmp/spar-threads-XXXXXX");
        faults += !mkdtemp(players[k].folder);
    }
    (void)pthread_barrier_init(&start, NULL, THREADS);
    for (int r = 0; r < rounds && faults == 0; r++) {
        faults += round_of(players);
    }
    (void)pthread_barrier_destroy(&start);
    for (int k = 0; k <= THREADS; k++) {
        faults += clean(players[k].folder) != 0;
    }
    printf("%d threads, %d scenes each, %d rounds: %d faults\n", THREADS, act_count, rounds, faults);
    return faults > 0;
}
