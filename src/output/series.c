/* Writes the index of a series of VTK files (.pvd), which ParaView opens as an animation. */
#include "../base/environment.h"
#include "../base/file.h"
#include "../base/message.h"
#include <errno.h>
#include <spar/spar_output.h>
#include <stdio.h>
#include <string.h>

static const char head[] = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n";
static const char foot[] = "</Collection>\n</VTKFile>\n";

/* Escapes the XML special characters of an attribute. */
static void put_text(FILE *file, const char *text) {
    for (; *text; text++) {
        switch (*text) {
        case '&':
            fputs("&amp;", file);
            break;
        case '<':
            fputs("&lt;", file);
            break;
        case '"':
            fputs("&quot;", file);
            break;
        default:
            fputc(*text, file);
        }
    }
}

/* Copies the index up to its closing tags. Returns 0 if it does not end as an index. */
static int copy(FILE *from, FILE *to) {
    char block[1 << 10], end[sizeof foot] = "";
    long length = fseek(from, 0, SEEK_END) == 0 ? ftell(from) : -1, left = length - (long)(sizeof foot - 1);
    if (length == 0) {
        fputs(head, to);
        return 1;
    }
    if (left < 0 || fseek(from, left, SEEK_SET) != 0 || fread(end, 1, sizeof foot - 1, from) != sizeof foot - 1 ||
        strcmp(end, foot) != 0 || fseek(from, 0, SEEK_SET) != 0) {
        return 0;
    }
    while (left > 0) {
        size_t want = left < (long)sizeof block ? (size_t)left : sizeof block;
        if (fread(block, 1, want, from) != want) {
            return 0;
        }
        (void)fwrite(block, 1, want, to);
        left -= (long)want;
    }
    return 1;
}

/* old: the present index, NULL if there is none. */
static int put_index(FILE *old, FILE *to, double time, int part, const char *file) {
    if (!old) {
        fputs(head, to);
    } else if (!copy(old, to)) {
        return 0;
    }
    fprintf(to, "<DataSet timestep=\"%.17g\" part=\"%d\" file=\"", time, part);
    put_text(to, file);
    fprintf(to, "\"/>\n%s", foot);
    return 1;
}

int spar_vtk_series_add(const char *path, double time, int part, const char *file) {
    SPARI_GUARD_ENVIRONMENT;
    char why[SPARI_MESSAGE_SIZE / 2];
    spari_file index;
    SPARI_REQUIRE(NULL, path && path[0] && file && file[0], SPAR_ERR_ARGUMENT,
                  "%s: the path of the index or the name of the file is missing; give both", __func__);
    SPARI_REQUIRE(NULL, spari_first_nonfinite(&time, 1) < 0 && part >= 0, SPAR_ERR_ARGUMENT,
                  "%s: '%s': time %g, part %d; give a finite time and a part counted from 0", __func__, file, time,
                  part);
    int status = spari_file_begin(&index, path, ".part", why, sizeof why);
    SPARI_REQUIRE(NULL, status == SPAR_OK, status, "%s: %s", __func__, why);
    FILE *old = fopen(index.place, "rb"); /* opened if it exists */
    if (!old && errno != ENOENT) {
        int reason = errno;
        spari_file_drop(&index);
        return spari_fail(NULL, reason == ENOMEM ? SPAR_ERR_MEMORY : SPAR_ERR_IO, "%s: cannot read '%s': %s", __func__,
                          path, reason == ENOMEM ? "no memory" : strerror(reason));
    }
    int ok = put_index(old, index.stream, time, part, file);
    (void)(old && fclose(old));
    if (!ok) {
        spari_file_drop(&index);
        return spari_fail(NULL, SPAR_ERR_IO, "%s: '%s' is not an index of a series; remove it or name another file",
                          __func__, path);
    }
    status = spari_file_end(&index, 0, why, sizeof why);
    SPARI_REQUIRE(NULL, status == SPAR_OK, status, "%s: %s", __func__, why);
    return SPAR_OK;
}
