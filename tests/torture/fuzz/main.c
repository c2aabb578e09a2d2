/* Runs sequences in children, watches them, and makes one that shows something shorter.

     fuzz [--calls n] [--seed s] [--jobs j] [--stats] [--all] [--keep]  random sequences; the answer is 1 if one showed
   something fuzz --replay seed       one sequence, told call by call fuzz --shrink seed       one sequence, made as
   short as it can be fuzz --names            whether every function of the library is among the calls fuzz --fault
   proof: finds a fault put into the fuzzer itself, and makes its sequence short */
#include "fuzz.h"

#include "../calls.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#if defined(__SANITIZE_ADDRESS__)
#include <sanitizer/asan_interface.h>
#include <sanitizer/common_interface_defs.h>
#include <sanitizer/lsan_interface.h>
const char *__asan_default_options(void);
const char *__asan_default_options(void) {
    return "allocator_may_return_null=1:max_allocation_size_mb=512:quarantine_size_mb=16:malloc_context_size=12:"
           "exitcode=99:detect_leaks=1:handle_abort=1";
}
enum { SANITIZED = 1 };
#else
enum { SANITIZED = 0 };
#endif

enum { SEQUENCE_ROOM = 1024, BATCH = 200, JOBS = 64, PATIENCE = 30 };

/* What a child tells while it lives. */
typedef struct window {
    atomic_llong calls; /* finished ones, also those within others: it is alive */
    atomic_llong at;    /* index of the sequence */
    atomic_int call;    /* under way */
    atomic_int found;
    int found_call;
    char kind[32], text[2048];
    long long ok[CALL_COUNT], refused[CALL_COUNT];
    double seconds[CALL_COUNT]; /* with what was called within */
} window;

typedef struct options {
    long long calls;
    uint64_t seed;
    int jobs, stats, fault, keep; /* keep: goes on after a finding, with those of its kind left alone */
} options;

static window *windows; /* one a job, one for single sequences */
static window *mine;
static int terminal = 1, sink = -1;
static char top[40];

/* ---- what a child says ---- */

void fuzz_say(const char *format, ...) {
    char line[10000];
    va_list arguments;
    va_start(arguments, format);
    int n = vsnprintf(line, sizeof line - 1, format, arguments);
    va_end(arguments);
    n = n < 0 ? 0 : n > (int)sizeof line - 2 ? (int)sizeof line - 2 : n;
    line[n] = '\n';
    if (write(terminal, line, (size_t)n + 1) < 0) {
        _exit(3);
    }
}

void fuzz_finding(const char *kind, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(mine->text, sizeof mine->text, format, arguments);
    va_end(arguments);
    (void)snprintf(mine->kind, sizeof mine->kind, "%s", kind);
    mine->found_call = mine->call;
    mine->found = 1;
    _exit(70);
}

void fuzz_count(int index, int status) {
    status == SPAR_OK ? mine->ok[index]++ : mine->refused[index]++;
    mine->calls++;
}

static double now(void) {
    struct timespec t;
    (void)clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Processor time of a child that has not been waited for, s. */
static double time_used_by(pid_t child) {
    struct timespec t = {0};
    clockid_t clock;
    if (clock_getcpuclockid(child, &clock) == 0) {
        (void)clock_gettime(clock, &t);
    }
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Patience counts processor time, so that a busy machine does not matter; and so many times more by the clock, for a
   child that waits for nothing. */
enum { WAITS = 30 };

typedef struct stopwatch {
    double used, since;
} stopwatch;

static stopwatch start_watch(pid_t child) {
    return (stopwatch){time_used_by(child), now()};
}

static int is_over(const stopwatch *w, pid_t child, double patience) {
    return time_used_by(child) - w->used > patience || now() - w->since > WAITS * patience;
}

/* ---- a child ---- */

static void remove_files(int number) {
    static const char *const names[] = {"f0.spar", "f1.spar", "f2.spar", "f0.vtu", "f1.vtu", "f2.vtu",
                                        "f0.vtp",  "f1.vtp",  "f2.vtp",  "f0.pvd", "f1.pvd", "f2.pvd"};
    char path[128];
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        (void)snprintf(path, sizeof path, "%s/%d/d/%s", top, number, names[i]);
        (void)unlink(path);
    }
}

/* The folder of one job; its own names are the only ones there can be. */
static void leave_folder(int number) {
    char outer[64];
    (void)snprintf(outer, sizeof outer, "%s/%d", top, number);
    char path[128];
    (void)snprintf(path, sizeof path, "%s/d", outer);
    remove_files(number);
    if (chdir("/") == 0 && rmdir(path) == 0) {
        (void)rmdir(outer);
    }
}

/* Standard output and error become a file, to see that nothing is written; all other files lie in a folder of its own.
 */
static void enter_child(window *window_of, int number) {
    mine = window_of;
    char path[96];
    (void)snprintf(path, sizeof path, "%s/%d", top, number);
    (void)mkdir(path, 0700);
    (void)snprintf(fuzz_world.folder, sizeof fuzz_world.folder, "%s/%d/d", top, number);
    (void)mkdir(fuzz_world.folder, 0700);
    remove_files(number);
    terminal = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 100);
    strcat(path, "/out");
    sink = open(path, O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
#if defined(__SANITIZE_ADDRESS__)
    __sanitizer_set_report_fd((void *)(intptr_t)terminal);
#else
    struct rlimit limit = {(rlim_t)4 << 30, (rlim_t)4 << 30};
    (void)setrlimit(RLIMIT_AS, &limit);
#endif
    if (terminal < 0 || sink < 0 || dup2(sink, STDOUT_FILENO) < 0 || dup2(sink, STDERR_FILENO) < 0 ||
        chdir(fuzz_world.folder) != 0) {
        _exit(3);
    }
}

static void run_list(const record *list, int n, int fault, int verbose) {
    struct stat stat;
    fuzz_world.fault = fault;
    fuzz_world_begin(&fuzz_world, verbose);
    for (int i = 0; i < n; i++) {
        fuzz_world.budget = 30;
        mine->call = list[i].call;
        double since = now();
        fuzz_run(&fuzz_world, list + i);
        mine->seconds[list[i].call] += now() - since;
    }
    mine->call = CALL_COUNT;
    fuzz_world_end(&fuzz_world);
    (void)fflush(NULL);
    if (fstat(sink, &stat) == 0 && stat.st_size > 0) {
        fuzz_finding("output", "%lld bytes on standard output or error", (long long)stat.st_size);
    }
}

static void check_leaks(void) {
#if defined(__SANITIZE_ADDRESS__)
    if (__lsan_do_recoverable_leak_check()) {
        fuzz_finding("leak", "memory is lost");
    }
#endif
}

/* What the child itself says goes into a file of its folder that has no name any more. */
static void silence(void) {
    char path[96];
    (void)snprintf(path, sizeof path, "%s/said", fuzz_world.folder);
    terminal = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    (void)unlink(path);
#if defined(__SANITIZE_ADDRESS__)
    __sanitizer_set_report_fd((void *)(intptr_t)terminal);
#endif
}

/* ---- one sequence ---- */

typedef struct outcome {
    int bad, call;
    char kind[32], text[2048];
} outcome;

static const char *call_name(int what) {
    return what >= 0 && what < CALL_COUNT ? fuzz_calls[what].name : "the end of the sequence";
}

/* How a child ended that is no more. */
static outcome judge(const window *w, int status, int hung) {
    outcome o = {0};
    o.call = w->call;
    if (w->found) {
        o.bad = 1;
        o.call = w->found_call;
        memcpy(o.kind, w->kind, sizeof o.kind);
        memcpy(o.text, w->text, sizeof o.text);
    } else if (hung) {
        o.bad = 1;
        (void)strcpy(o.kind, "hang");
        (void)snprintf(o.text, sizeof o.text, "%s does not return", call_name(o.call));
    } else if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
        o.bad = 1;
        (void)strcpy(o.kind, "crash");
        (void)snprintf(o.text, sizeof o.text, "%s ends with %s %d", call_name(o.call),
                       WIFEXITED(status) ? "code" : "signal",
                       WIFEXITED(status) ? WEXITSTATUS(status) : WTERMSIG(status));
    }
    return o;
}

/* Waits for one child; kills it when it makes no call for so many seconds of processor time. */
static outcome await(pid_t child, window *w, double patience) {
    int status = 0, hung = 0;
    long long calls = -1;
    stopwatch watch = start_watch(child);
    while (waitpid(child, &status, WNOHANG) == 0) {
        if (w->calls != calls) {
            calls = w->calls;
            watch = start_watch(child);
        } else if (!hung && is_over(&watch, child, patience)) {
            hung = 1;
            (void)kill(child, SIGKILL);
        }
        (void)nanosleep(&(struct timespec){0, 300000}, NULL);
    }
    return judge(w, status, hung);
}

static outcome try_list(const record *list, int n, int fault, int verbose, double patience) {
    window *w = windows + JOBS;
    memset(w, 0, sizeof *w);
    pid_t child = fork();
    if (child == 0) {
        enter_child(w, JOBS);
        if (!verbose) {
            silence();
        }
        run_list(list, n, fault, verbose);
        check_leaks();
        _exit(0);
    }
    return await(child, w, patience);
}

/* Leaves out what can be left out: halves, quarters, ... single calls, until none can. Answers the length. */
static int shorten(record *list, int n, int fault, const outcome *wanted) {
    record part[SEQUENCE_ROOM];
    int hang = strcmp(wanted->kind, "hang") == 0, tries = hang ? 100 : 5000;
    for (int size = n / 2 > 0 ? n / 2 : 1; size > 0;) {
        int less = 0;
        for (int from = n - size; n > 1 && from > -size && tries > 0; from -= size) {
            int begin = from > 0 ? from : 0, end = from + size;
            memcpy(part, list, (size_t)begin * sizeof *part);
            memcpy(part + begin, list + end, (size_t)(n - end) * sizeof *part);
            outcome o = try_list(part, n - (end - begin), fault, 0, hang ? 4 : PATIENCE);
            tries--;
            if (o.bad && strcmp(o.kind, wanted->kind) == 0 && o.call == wanted->call) {
                n -= end - begin;
                memcpy(list, part, (size_t)n * sizeof *list);
                less = 1;
            }
        }
        size = less && size == 1 ? 1 : size == 1 ? 0 : size / 2;
        size = size > n ? n : size;
    }
    return n;
}

/* Tells a sequence that shows something, the shortest of its kind; answers its length. */
static int show(uint64_t seed, int fault) {
    record list[SEQUENCE_ROOM];
    int n = fuzz_sequence(seed, list, SEQUENCE_ROOM), whole = n;
    outcome o = try_list(list, n, fault, 0, PATIENCE);
    if (!o.bad) {
        printf("  not again by itself: it needs the sequences before it\n");
        return -1;
    }
    n = shorten(list, n, fault, &o);
    printf("  %s: %s\n  shortest of %d calls: %d\n", o.kind, o.text, whole, n);
    (void)fflush(stdout);
    o = try_list(list, n, fault, 1, PATIENCE);
    printf("  => %s: %s\n", o.bad ? o.kind : "nothing", o.text);
    (void)fflush(stdout);
    return n;
}

/* ---- many ---- */

typedef struct job {
    pid_t child;
    long long first, calls;
    stopwatch watch;
    int hung;
} job;

static long long total_calls(int jobs) {
    long long sum = 0;
    for (int j = 0; j < jobs; j++) {
        sum += windows[j].calls;
    }
    return sum;
}

static void start(job *j, int number, long long first, const options *o) {
    window *w = windows + number;
    *j = (job){.first = first, .calls = w->calls};
    w->found = 0;
    (void)fflush(NULL);
    j->child = fork();
    if (j->child == 0) {
        record list[SEQUENCE_ROOM];
        enter_child(w, number);
        silence();
        for (long long k = 0; k < BATCH; k++) {
            w->at = first + k;
            run_list(list, fuzz_sequence(fuzz_mix(o->seed, (uint64_t)(first + k)), list, SEQUENCE_ROOM), o->fault, 0);
        }
        check_leaks();
        _exit(0);
    }
    j->watch = start_watch(j->child);
}

/* A batch has lost memory: which of its sequences? */
static uint64_t leaking(const options *o, long long first) {
    record list[SEQUENCE_ROOM];
    for (long long k = 0; k < BATCH; k++) {
        uint64_t seed = fuzz_mix(o->seed, (uint64_t)(first + k));
        if (try_list(list, fuzz_sequence(seed, list, SEQUENCE_ROOM), o->fault, 0, PATIENCE).bad) {
            return seed;
        }
    }
    return fuzz_mix(o->seed, (uint64_t)first);
}

/* Is it one that has been shown? */
static int shown(const outcome *found) {
    static outcome before[200];
    static int count;
    for (int i = 0; i < count; i++) {
        if (before[i].call == found->call && strcmp(before[i].kind, found->kind) == 0) {
            return ++before[i].bad > 1;
        }
    }
    if (count < 200) {
        before[count++] = *found;
    }
    return 0;
}

/* Answers the length of the shortest sequence, 0 if nothing was found. */
static int end(job *j, int number, int status, const options *o) {
    window *w = windows + number;
    outcome found = judge(w, status, j->hung);
    j->child = 0;
    if (!found.bad) {
        return 0;
    }
    if (shown(&found)) {
        return 1;
    }
    uint64_t seed = strcmp(found.kind, "leak") == 0 ? leaking(o, j->first) : fuzz_mix(o->seed, (uint64_t)w->at);
    printf("== found: %s: %s\n  sequence %#" PRIx64 " (fuzz --shrink %#" PRIx64 ")\n", found.kind, found.text, seed,
           seed);
    (void)fflush(stdout);
    int n = show(seed, o->fault);
    return n == 0 ? -1 : n;
}

/* Of one call, over all jobs. */
typedef struct sum {
    long long ok, refused;
    double seconds;
    int lacks; /* never succeeded, or never failed */
} sum;

static sum sum_of(const options *o, int index) {
    sum s = {0};
    for (int j = 0; j < o->jobs; j++) {
        s.ok += windows[j].ok[index];
        s.refused += windows[j].refused[index];
        s.seconds += windows[j].seconds[index];
    }
    int flags = fuzz_calls[index].flags;
    const int rare = (flags & FUZZ_TRIAL) && s.refused < 300; /* some trials succeed once in fifty tries and less */
    s.lacks =
        (s.ok == 0 && !(flags & FUZZ_NEVER) && !rare) || (s.refused == 0 && !(flags & (FUZZ_TEXT | FUZZ_HARNESS)));
    return s;
}

static void stats(const options *o) {
    printf("%-34s %12s %12s %10s\n", "call", "ok", "refused", "seconds");
    for (int i = 0; i < CALL_COUNT; i++) {
        sum s = sum_of(o, i);
        printf("%-34s %12lld %12lld %10.2f%s\n", fuzz_calls[i].name, s.ok, s.refused, s.seconds,
               s.lacks ? "  <-- never" : "");
    }
}

/* Every function has succeeded and has been refused. */
static int all_tried(const options *o) {
    int all = 1;
    for (int i = 0; i < CALL_COUNT; i++) {
        sum s = sum_of(o, i);
        if (s.lacks) {
            printf("== %s: %lld times without and %lld times with a failure\n", fuzz_calls[i].name, s.ok, s.refused);
            all = 0;
        }
    }
    return all;
}

/* Looks at the jobs once; answers the length of what was found, 0 for nothing. */
static int look(job *jobs, const options *o, long long *next, int *running) {
    int found = 0;
    for (int j = 0; j < o->jobs && (found == 0 || o->keep); j++) {
        int status = 0;
        if (jobs[j].child == 0) {
            continue;
        }
        if (waitpid(jobs[j].child, &status, WNOHANG) > 0) {
            --*running;
            int length = end(jobs + j, j, status, o);
            found = length ? length : found;
            if (total_calls(o->jobs) < o->calls && (found == 0 || o->keep)) {
                start(jobs + j, j, *next, o);
                *next += BATCH;
                ++*running;
            }
        } else if (windows[j].calls != jobs[j].calls) {
            jobs[j].calls = windows[j].calls;
            jobs[j].watch = start_watch(jobs[j].child);
        } else if (!jobs[j].hung && is_over(&jobs[j].watch, jobs[j].child, PATIENCE)) {
            jobs[j].hung = 1;
            (void)kill(jobs[j].child, SIGKILL);
        }
    }
    return found;
}

static int many(const options *o) {
    job jobs[JOBS] = {{0}};
    long long next = 0;
    int running = 0, found = 0;
    double begun = now(), told = begun;
    printf("== fuzz: %lld calls, seed %#" PRIx64 ", %d jobs%s\n", o->calls, o->seed, o->jobs,
           SANITIZED ? ", sanitized" : "");
    for (int j = 0; j < o->jobs; j++, running++, next += BATCH) {
        start(jobs + j, j, next, o);
    }
    while (running > 0 && (found == 0 || o->keep)) {
        int length = look(jobs, o, &next, &running);
        found = length ? length : found;
        if (now() - told > 30) {
            told = now();
            printf("   %.0f s: %lld calls, %lld sequences\n", told - begun, total_calls(o->jobs), next);
            (void)fflush(stdout);
        }
        (void)nanosleep(&(struct timespec){0, 2000000}, NULL);
    }
    for (int j = 0; j < o->jobs; j++) {
        if (jobs[j].child > 0) {
            (void)kill(jobs[j].child, SIGKILL);
            (void)waitpid(jobs[j].child, NULL, 0);
        }
    }
    double seconds = now() - begun;
    long long calls = total_calls(o->jobs);
    printf("== %lld calls in about %lld sequences, %.1f s, %.1f us a call\n", calls, next, seconds,
           1e6 * seconds * o->jobs / (double)(calls > 0 ? calls : 1));
    if (o->stats) {
        stats(o);
    }
    return found;
}

/* ---- the table is complete ---- */

static int check_names(void) {
#define NAME(name) #name,
    static const char *const names[] = {SPAR_LOCAL_CALLS(NAME) SPAR_COLLECTIVE_CALLS(NAME)};
#undef NAME
    enum { NAMES = sizeof names / sizeof *names };
    int missing = 0;
    for (int i = 0; i < NAMES; i++) {
        int k = 0;
        while (k < CALL_COUNT && strcmp(fuzz_calls[k].name, names[i]) != 0) {
            k++;
        }
        if (k == CALL_COUNT) {
            printf("the fuzzer does not call %s: run cmake/generate\n", names[i]);
            missing++;
        }
    }
    printf("%d functions, %d missing\n", NAMES, missing);
    return NAMES < 50 || missing > 0;
}

/* ---- main ---- */

static int usage(void) {
    (void)fputs("fuzz [--calls n] [--seed s] [--jobs j] [--stats] [--all] [--keep] | --replay seed | --shrink seed | "
                "--names | --fault\n",
                stderr);
    return 2;
}

static int run(int argc, char **argv) {
    options o = {100000, 1, 1, 0, 0, 0};
    int all = 0;
    for (int i = 1; i < argc; i++) {
        const char *value = i + 1 < argc ? argv[i + 1] : NULL;
        if (strcmp(argv[i], "--stats") == 0) {
            o.stats = 1;
        } else if (strcmp(argv[i], "--all") == 0) {
            all = 1;
        } else if (strcmp(argv[i], "--keep") == 0) {
            o.keep = 1;
        } else if (strcmp(argv[i], "--fault") == 0) {
            o.fault = 1;
        } else if (strcmp(argv[i], "--names") == 0) {
            return check_names();
        } else if (!value) {
            return usage();
        } else if (strcmp(argv[i], "--calls") == 0) {
            o.calls = strtoll(argv[++i], NULL, 0);
        } else if (strcmp(argv[i], "--seed") == 0) {
            o.seed = strcmp(value, "fresh") == 0 ? fuzz_mix((uint64_t)time(NULL), (uint64_t)getpid())
                                                 : strtoull(value, NULL, 0);
            i++;
        } else if (strcmp(argv[i], "--jobs") == 0) {
            o.jobs = atoi(argv[++i]);
            o.jobs = o.jobs < 1 ? 1 : o.jobs > JOBS ? JOBS : o.jobs;
        } else if (strcmp(argv[i], "--shrink") == 0) {
            return show(strtoull(value, NULL, 0), o.fault) != -1;
        } else if (strcmp(argv[i], "--replay") == 0) {
            record list[SEQUENCE_ROOM];
            int n = fuzz_sequence(strtoull(value, NULL, 0), list, SEQUENCE_ROOM);
            outcome out = try_list(list, n, o.fault, 1, PATIENCE);
            printf("=> %s: %s\n", out.bad ? out.kind : "nothing", out.text);
            return out.bad;
        } else {
            return usage();
        }
    }
    int found = many(&o);
    if (o.fault) { /* create, describe, map, refuse, step: not many more than these */
        return found > 0 && found <= 14 ? 0 : 1;
    }
    return found != 0 || (all && !all_tried(&o));
}

int main(int argc, char **argv) {
    struct stat shm;
    const char *where = stat("/dev/shm", &shm) == 0 && access("/dev/shm", W_OK) == 0 ? "/dev/shm" : "/tmp";
    (void)snprintf(top, sizeof top, "%s/spar-fuzz-XXXXXX", where);
    windows = mmap(NULL, (JOBS + 1) * sizeof *windows, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (windows == MAP_FAILED || !mkdtemp(top)) {
        perror("fuzz");
        return 2;
    }
    mine = windows + JOBS;
    int answer = run(argc, argv);
    for (int j = 0; j <= JOBS; j++) {
        char path[80];
        (void)snprintf(path, sizeof path, "%s/%d/out", top, j);
        (void)unlink(path);
        leave_folder(j);
    }
    (void)rmdir(top);
    return answer;
}
