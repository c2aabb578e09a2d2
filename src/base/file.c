/* Files that are replaced as a whole: written under a temporary name in the same folder, then renamed. */
#include "file.h"

#include <errno.h>
#include <fcntl.h>
#include <spar/spar.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { LONGEST = 4096, LINKS = 40, TRIES = 20 };

static int failure(char *why, size_t size, const char *path, int reason) {
    (void)snprintf(why, size, "cannot write '%.300s': %s; check the folder, its permissions and the free disk space",
                   path, strerror(reason ? reason : EIO));
    return SPAR_ERR_IO;
}

static int no_memory_to_write(char *why, size_t size, const char *path) {
    (void)snprintf(why, size, "no memory to write '%.300s'", path);
    return SPAR_ERR_MEMORY;
}

const char *spari_file_kind(unsigned mode) {
    return S_ISREG(mode)    ? NULL
           : S_ISDIR(mode)  ? "a folder"
           : S_ISFIFO(mode) ? "a pipe"
           : S_ISSOCK(mode) ? "a socket"
                            : "a device";
}

static int refuse_kind(char *why, size_t size, const char *path, unsigned mode) {
    (void)snprintf(why, size, "cannot write '%.300s': it is %s, which is not overwritten; name a file", path,
                   spari_file_kind(mode));
    return SPAR_ERR_IO;
}

/* ---- target path ---- */

/* Target of a symbolic link. NULL with errno set if the link cannot be read. */
static char *follow_link(const char *link) {
    char to[LONGEST];
    ssize_t n = readlink(link, to, sizeof to);
    if (n < 0 || (size_t)n == sizeof to) {
        errno = n < 0 ? errno : ENAMETOOLONG;
        return NULL;
    }
    const char *slash = to[0] == '/' ? NULL : strrchr(link, '/');
    size_t folder = slash ? (size_t)(slash - link) + 1 : 0;
    char *path = malloc(folder + (size_t)n + 1);
    if (path) {
        memcpy(path, link, folder);
        memcpy(path + folder, to, (size_t)n);
        path[folder + (size_t)n] = '\0';
    }
    return path;
}

/* Follows all symbolic links. old: the existing file; st_nlink is 0 if there is none. */
static int find_place(const char *path, char **place, struct stat *old, char *why, size_t size) {
    char *at = strdup(path);
    int reason = ENOMEM;
    for (int links = 0; at && links < LINKS; links++) {
        memset(old, 0, sizeof *old);
        if (lstat(at, old) != 0 || !S_ISLNK(old->st_mode)) {
            break;
        }
        char *next = follow_link(at);
        reason = next ? reason : errno;
        free(at);
        at = next;
    }
    if (!at) {
        return reason == ENOMEM ? no_memory_to_write(why, size, path) : failure(why, size, path, reason);
    }
    int there = lstat(at, old) == 0, status = SPAR_OK;
    if (!there) {
        memset(old, 0, sizeof *old);
        status = errno == ENOENT ? SPAR_OK : failure(why, size, at, errno);
    } else if (S_ISLNK(old->st_mode)) {
        status = failure(why, size, path, ELOOP);
    } else if (!S_ISREG(old->st_mode)) {
        status = refuse_kind(why, size, at, old->st_mode);
    } else if (access(at, W_OK) != 0) {
        status = failure(why, size, at, errno);
    }
    if (status != SPAR_OK) {
        free(at);
        return status;
    }
    *place = at;
    return SPAR_OK;
}

/* ---- the temporary file ---- */

/* The lock is held until the file is closed. It distinguishes a file in use from an abandoned one. Returns 0 if
   another process holds it. On file systems without locks the call succeeds. */
static int lock(int fd) {
    struct flock whole = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
    return fcntl(fd, F_SETLK, &whole) == 0 || (errno != EACCES && errno != EAGAIN);
}

/* Whether the path still refers to the open file. */
static int is_at(int fd, const char *path) {
    struct stat open_file, named;
    return fstat(fd, &open_file) == 0 && lstat(path, &named) == 0 && open_file.st_ino == named.st_ino &&
           open_file.st_dev == named.st_dev;
}

/* Removes an abandoned temporary file. Fails if another process is writing it. */
static int clear(const char *temporary, char *why, size_t size) {
    struct stat there;
    if (lstat(temporary, &there) != 0) {
        return errno == ENOENT ? SPAR_OK : failure(why, size, temporary, errno);
    }
    if (!S_ISREG(there.st_mode) && !S_ISLNK(there.st_mode)) {
        return refuse_kind(why, size, temporary, there.st_mode);
    }
    int fd = S_ISREG(there.st_mode) ? open(temporary, O_WRONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC) : -1;
    int status = SPAR_OK;
    if (fd >= 0 && !lock(fd)) {
        (void)snprintf(why, size,
                       "cannot write '%.300s': another process is writing it; give each process its own path",
                       temporary);
        status = SPAR_ERR_IO;
    } else if ((fd < 0 || is_at(fd, temporary)) && unlink(temporary) != 0 && errno != ENOENT) {
        status = failure(why, size, temporary, errno);
    }
    if (fd >= 0) {
        (void)close(fd);
    }
    return status;
}

/* Creates a new file. An existing file or link of this name is neither followed nor written to. */
static int open_new(const char *temporary, int *made, char *why, size_t size) {
    for (int tries = 0; tries < TRIES; tries++) {
        int fd = open(temporary, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
        if (fd >= 0 && lock(fd) && is_at(fd, temporary)) {
            *made = fd;
            return SPAR_OK;
        }
        if (fd >= 0) { /* another process removed it as abandoned */
            (void)close(fd);
        } else if (errno != EEXIST) {
            return failure(why, size, temporary, errno);
        } else {
            int status = clear(temporary, why, size);
            if (status != SPAR_OK) {
                return status;
            }
        }
    }
    return failure(why, size, temporary, EBUSY);
}

/* ---- begin and end ---- */

static void forget(spari_file *file) {
    free(file->place);
    free(file->temporary);
    *file = (spari_file){0};
}

static int open_stream(spari_file *file, const struct stat *old, char *why, size_t size) {
    int fd = -1, status = open_new(file->temporary, &fd, why, size);
    if (status != SPAR_OK) {
        return status;
    }
    if (old->st_nlink > 0) { /* mode and owner of the replaced file, as far as the system allows */
        (void)!fchown(fd, old->st_uid, old->st_gid);
        (void)fchmod(fd, old->st_mode & 0777);
    }
    file->stream = fdopen(fd, "wb");
    if (!file->stream) {
        (void)unlink(file->temporary);
        (void)close(fd);
        return no_memory_to_write(why, size, file->temporary);
    }
    return SPAR_OK;
}

int spari_file_begin(spari_file *file, const char *path, const char *suffix, char *why, size_t size) {
    struct stat old;
    *file = (spari_file){0};
    int status = find_place(path, &file->place, &old, why, size);
    if (status == SPAR_OK) {
        size_t n = strlen(file->place), m = strlen(suffix) + 1;
        file->temporary = malloc(n + m);
        if (file->temporary) {
            memcpy(file->temporary, file->place, n);
            memcpy(file->temporary + n, suffix, m);
            status = open_stream(file, &old, why, size);
        } else {
            status = no_memory_to_write(why, size, path);
        }
    }
    if (status != SPAR_OK) {
        forget(file);
    }
    errno = 0; /* write errors are reported by spari_file_end */
    return status;
}

/* A rename is safe once its folder is on disc. On systems that cannot open folders this is left to the system. */
static void sync_folder(const char *path) {
    char folder[LONGEST] = ".";
    const char *slash = strrchr(path, '/');
    if (slash && (size_t)(slash - path) + 1 < sizeof folder) {
        memcpy(folder, path, (size_t)(slash - path) + 1);
        folder[slash - path + 1] = '\0';
    }
    int fd = open(folder, O_RDONLY | O_CLOEXEC);
    if (fd >= 0) {
        (void)fsync(fd);
        (void)close(fd);
    }
}

static int errno_or(int otherwise) {
    return errno ? errno : otherwise;
}

/* Returns 0 or errno. A synchronised file is renamed while the lock is held; closing releases the lock. Otherwise
   the file is closed first, because some write errors only show when it is closed. */
static int finish(spari_file *file, int safe) {
    int ok = !ferror(file->stream) && fflush(file->stream) == 0 && (!safe || fsync(fileno(file->stream)) == 0);
    int reason = ok ? 0 : errno_or(EIO), ours = is_at(fileno(file->stream), file->temporary);
    if (!reason && !ours) {
        reason = EBUSY;
    }
    if (!reason && safe && rename(file->temporary, file->place) != 0) {
        reason = errno_or(EIO);
    }
    if (fclose(file->stream) != 0 && !reason && !safe) {
        reason = errno_or(EIO);
    }
    if (!reason && !safe && rename(file->temporary, file->place) != 0) {
        reason = errno_or(EIO);
    }
    if (reason && ours) {
        (void)unlink(file->temporary);
    }
    return reason;
}

void spari_file_drop(spari_file *file) {
    if (is_at(fileno(file->stream), file->temporary)) {
        (void)unlink(file->temporary);
    }
    (void)fclose(file->stream);
    forget(file);
}

int spari_file_end(spari_file *file, int safe, char *why, size_t size) {
    int reason = finish(file, safe), status = reason ? failure(why, size, file->place, reason) : SPAR_OK;
    if (safe && status == SPAR_OK) {
        sync_folder(file->place);
    }
    forget(file);
    return status;
}
