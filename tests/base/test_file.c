/* Files that are replaced whole, by save, write_vtk and series alike: links lead to their ends and stay, what is no
   file is refused and stays, nothing is left beside a file, and a disk without room leaves what was there. Oracle: what
   the system says of the names afterwards (lstat), and the bytes of a file written to a plain name. */
#include "scene.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <spar/spar_output.h>
#include <stdio.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

static spar_session *session;
static spar_member *beam;
static char home[64];

/* ---- the three writers ---- */

static int save(const char *path) {
    return spar_session_save(session, path);
}

static int picture(const char *path) {
    return spar_member_write_vtk(beam, path);
}

static int series(const char *path) {
    return spar_vtk_series_add(path, 0.5, 0, "x.vtp");
}

static const struct writer {
    int (*write)(const char *path);
    const char *suffix;
    int own_message; /* told to the session; else to the thread */
} writers[] = {{save, ".new", 1}, {picture, ".part", 1}, {series, ".part", 0}};
enum { WRITERS = sizeof writers / sizeof *writers };

static const char *message(const struct writer *w) {
    return spar_session_message(w->own_message ? session : NULL);
}

/* ---- the folder ---- */

static const char *temporary(const struct writer *w, const char *path) {
    static char name[256];
    (void)snprintf(name, sizeof name, "%s%s", path, w->suffix);
    return name;
}

static struct stat look(const char *path) {
    struct stat s = {0};
    assert_int_equal(lstat(path, &s), 0);
    return s;
}

static int is_there(const char *path) {
    struct stat s;
    return lstat(path, &s) == 0;
}

static void put(const char *path, const char *text) {
    FILE *f = fopen(path, "w");
    assert_non_null(f);
    fputs(text, f);
    assert_int_equal(fclose(f), 0);
}

static char bytes[2][1 << 16];

static size_t get(const char *path, char *to) {
    FILE *f = fopen(path, "rb");
    assert_non_null(f);
    size_t n = fread(to, 1, sizeof bytes[0], f);
    assert_int_equal(fclose(f), 0);
    return n;
}

/* The file is what the writer writes to a new name. */
static void is_written(const struct writer *w, const char *path) {
    (void)remove("fresh.vtp");
    assert_int_equal(w->write("fresh.vtp"), SPAR_OK);
    size_t n = get("fresh.vtp", bytes[0]);
    assert_true(n > 100 && n == get(path, bytes[1]));
    assert_memory_equal(bytes[0], bytes[1], n);
    (void)remove("fresh.vtp");
}

static int enter(void **state) {
    const char *base = getenv("TMPDIR");
    double K[36], M[36];
    (void)state;
    (void)snprintf(home, sizeof home, "%.40s/spar-file-XXXXXX", base ? base : "/tmp");
    if (!mkdtemp(home) || chdir(home) != 0) {
        return -1;
    }
    session = scene_session();
    scene_box(K, M);
    beam = scene_beam(session, "beam", 1, 3, 10, K, M);
    return spar_member_commit(beam);
}

static int leave(void **state) {
    char command[96];
    (void)state;
    spar_session_destroy(&session);
    (void)snprintf(command, sizeof command, "rm -rf '%s'", home);
    return chdir("/") != 0 || system(command) != 0; /* NOLINT(cert-env33-c): a folder of mkdtemp */
}

/* ---- links ---- */

static void links(void **state) {
    (void)state;
    assert_int_equal(mkdir("far", 0755), 0);
    for (int k = 0; k < WRITERS; k++) {
        const struct writer *w = writers + k;
        assert_int_equal(symlink("far/chain", "link"), 0); /* relative to where the link is */
        assert_int_equal(symlink("end", "far/chain"), 0);
        for (int there = 0; there < 2; there++) { /* it leads to nothing, then to a file */
            if (there && w->write == series) {
                (void)remove("far/end");
                put("far/end", "");
            }
            assert_int_equal(w->write("link"), SPAR_OK);
            assert_true(S_ISLNK(look("link").st_mode) && S_ISLNK(look("far/chain").st_mode));
            assert_true(S_ISREG(look("far/end").st_mode));
            assert_false(is_there(temporary(w, "far/end")) || is_there(temporary(w, "link")));
            is_written(w, "far/end");
        }
        (void)remove("link");
        assert_int_equal(symlink("link", "far/loop"), 0);
        assert_int_equal(symlink("far/loop", "link"), 0);
        (void)remove("far/loop");
        assert_int_equal(symlink("../link", "far/loop"), 0);
        assert_int_equal(w->write("link"), SPAR_ERR_IO);
        assert_true(S_ISLNK(look("link").st_mode));
        (void)remove("far/loop"), (void)remove("far/chain"), (void)remove("far/end"), (void)remove("link");
    }
}

/* Of a file with two names one gets the new file; mode and owner stay. */
static void names_and_modes(void **state) {
    (void)state;
    for (int k = 0; k < WRITERS; k++) {
        const struct writer *w = writers + k;
        put("one", "");
        assert_int_equal(chmod("one", 0640), 0);
        assert_int_equal(link("one", "other"), 0);
        struct stat before = look("one");
        assert_int_equal(w->write("one"), SPAR_OK);
        struct stat after = look("one");
        assert_true((after.st_mode & 07777) == 0640 && after.st_uid == before.st_uid && after.st_gid == before.st_gid);
        assert_true(after.st_nlink == 1 && look("other").st_ino == before.st_ino && look("other").st_size == 0);
        is_written(w, "one");
        (void)remove("one"), (void)remove("other");
        mode_t mask = umask(027);
        assert_int_equal(w->write("one"), SPAR_OK);
        (void)umask(mask);
        assert_true((look("one").st_mode & 07777) == 0640);
        (void)remove("one");
    }
}

/* ---- no files ---- */

static int make_folder(const char *path) {
    return mkdir(path, 0755);
}

static int make_pipe(const char *path) {
    return mkfifo(path, 0644);
}

static int make_socket(const char *path) {
    struct sockaddr_un name = {.sun_family = AF_UNIX};
    int fd = socket(AF_UNIX, SOCK_STREAM, 0);
    (void)snprintf(name.sun_path, sizeof name.sun_path, "%s", path);
    int status = bind(fd, (const struct sockaddr *)&name, sizeof name);
    (void)close(fd);
    return status;
}

static const struct kind {
    int (*make)(const char *path);
    const char *name;
} kinds[] = {{make_folder, "a folder"}, {make_pipe, "a pipe"}, {make_socket, "a socket"}};

static void no_files(void **state) {
    (void)state;
    for (int k = 0; k < WRITERS; k++) {
        const struct writer *w = writers + k;
        for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
            assert_int_equal(kinds[i].make("thing"), 0);
            struct stat before = look("thing");
            assert_int_equal(symlink("thing", "link"), 0);
            for (int by_link = 0; by_link < 2; by_link++) {
                assert_int_equal(w->write(by_link ? "link" : "thing"), SPAR_ERR_IO);
                assert_non_null(strstr(message(w), kinds[i].name));
                assert_non_null(strstr(message(w), "'thing'"));
                struct stat after = look("thing");
                assert_true(after.st_ino == before.st_ino && after.st_mode == before.st_mode);
            }
            assert_false(is_there(temporary(w, "thing")));
            if (w->write == save) { /* nor is it read, which could wait for ever */
                assert_int_equal(spar_session_load(session, "thing"), SPAR_ERR_IO);
            }
            (void)remove("link");
            /* in the way of the temporary file */
            assert_int_equal(rename("thing", temporary(w, "file")), 0);
            assert_int_equal(w->write("file"), SPAR_ERR_IO);
            assert_non_null(strstr(message(w), kinds[i].name));
            assert_true(look(temporary(w, "file")).st_ino == before.st_ino);
            assert_false(is_there("file"));
            (void)remove(temporary(w, "file"));
        }
    }
}

static void bad_paths(void **state) {
    (void)state;
    char longest[5000];
    memset(longest, 'x', sizeof longest - 1);
    longest[sizeof longest - 1] = '\0';
    put("file", "something");
    for (int k = 0; k < WRITERS; k++) {
        const struct writer *w = writers + k;
        const char *const paths[] = {"no/such/folder", "file/below", "no/such/", longest};
        for (size_t i = 0; i < sizeof paths / sizeof *paths; i++) {
            assert_int_equal(w->write(paths[i]), SPAR_ERR_IO);
            assert_non_null(strstr(message(w), "check the folder"));
        }
    }
    (void)remove("file");
}

/* ---- what is in the way ---- */

/* A link at the temporary name is not followed, a file with another name not written to; what was left goes. */
static void left_overs(void **state) {
    (void)state;
    for (int k = 0; k < WRITERS; k++) {
        const struct writer *w = writers + k;
        for (int kind = 0; kind < 4; kind++) {
            const char *there = temporary(w, "file");
            put("victim", "a victim");
            int made = kind == 0   ? symlink("victim", there)
                       : kind == 1 ? symlink("nowhere", there)
                       : kind == 2 ? link("victim", there)
                                   : (put(there, "half a fi"), chmod(there, 0600));
            assert_int_equal(made, 0);
            assert_int_equal(w->write("file"), SPAR_OK);
            is_written(w, "file");
            assert_false(is_there(temporary(w, "file")) || is_there("nowhere"));
            assert_int_equal(get("victim", bytes[0]), 8);
            assert_memory_equal(bytes[0], "a victim", 8);
            assert_true((look("file").st_mode & 0777) != 0600);
            (void)remove("victim"), (void)remove("file");
        }
    }
}

/* Another process is at work on it: it is left alone until that has ended. */
static void others_at_work(void **state) {
    (void)state;
    for (int k = 0; k < WRITERS; k++) {
        const struct writer *w = writers + k;
        int ready[2], end[2];
        char byte = 0;
        assert_true(pipe(ready) == 0 && pipe(end) == 0);
        pid_t child = fork();
        if (child == 0) {
            struct flock whole = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
            int fd = open(temporary(w, "file"), O_WRONLY | O_CREAT, 0644);
            (void)close(end[1]);
            int ok = fd >= 0 && fcntl(fd, F_SETLK, &whole) == 0 && write(ready[1], "x", 1) == 1;
            _exit(!ok || read(end[0], &byte, 1) != 0);
        }
        assert_int_equal(read(ready[0], &byte, 1), 1);
        assert_int_equal(w->write("file"), SPAR_ERR_IO);
        assert_non_null(strstr(message(w), "another process is writing"));
        assert_true(is_there(temporary(w, "file")) && !is_there("file"));
        (void)close(end[1]), (void)close(end[0]), (void)close(ready[0]), (void)close(ready[1]);
        int status = 1;
        assert_true(waitpid(child, &status, 0) == child && status == 0);
        assert_int_equal(w->write("file"), SPAR_OK);
        assert_false(is_there(temporary(w, "file")));
        (void)remove("file");
    }
}

/* ---- no room ---- */

static void no_room(void **state) {
    (void)state;
    struct rlimit old, little;
    (void)signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &old), 0);
    for (int k = 0; k < WRITERS; k++) {
        const struct writer *w = writers + k;
        assert_int_equal(w->write("file"), SPAR_OK);
        size_t n = get("file", bytes[0]);
        for (rlim_t room = 0; room <= n; room += room == 0 || room == n - 1 ? 1 : n - 2) {
            little = (struct rlimit){room, old.rlim_max};
            assert_int_equal(setrlimit(RLIMIT_FSIZE, &little), 0);
            int status = w->write("file");
            assert_int_equal(setrlimit(RLIMIT_FSIZE, &old), 0);
            int fits = room >= n && w->write != series; /* a series grows */
            assert_int_equal(status, fits ? SPAR_OK : SPAR_ERR_IO);
            assert_true(fits || strstr(message(w), strerror(EFBIG)));
            assert_int_equal(get("file", bytes[1]), n);
            assert_memory_equal(bytes[0], bytes[1], n);
            assert_false(is_there(temporary(w, "file")));
        }
        (void)remove("file");
    }
}

/* A file that may not be written to stays; root may write to all. */
static void no_right(void **state) {
    (void)state;
    for (int k = 0; k < WRITERS && geteuid() != 0; k++) {
        put("file", "");
        assert_int_equal(chmod("file", 0444), 0);
        assert_int_equal(writers[k].write("file"), SPAR_ERR_IO);
        assert_true(look("file").st_size == 0);
        (void)remove("file");
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(links),     cmocka_unit_test(names_and_modes), cmocka_unit_test(no_files),
        cmocka_unit_test(bad_paths), cmocka_unit_test(left_overs),      cmocka_unit_test(others_at_work),
        cmocka_unit_test(no_room),   cmocka_unit_test(no_right),
    };
    return cmocka_run_group_tests(tests, enter, leave);
}
