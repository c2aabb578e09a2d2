/* The index of a series of VTK files (.pvd): what ParaView opens to show them in time. */
#include "../session/status.h"
#include <errno.h>
#include <spar/spar_output.h>
#include <stdio.h>
#include <string.h>

static const char head[] = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n";
static const char foot[] = "</Collection>\n</VTKFile>\n";

/* XML text of an attribute: the characters that have a meaning there are spelled out. */
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

/* Leaves the file where the next entry goes: before the foot. Returns 0 when it does not end as an index does. */
static int find_end(FILE *file) {
    char text[sizeof foot] = "";
    long back = (long)(sizeof foot - 1);
    if (fseek(file, 0, SEEK_END) != 0) {
        return 0;
    }
    if (ftell(file) == 0) {
        fputs(head, file);
        return 1;
    }
    if (fseek(file, -back, SEEK_END) != 0 || fread(text, 1, (size_t)back, file) != (size_t)back ||
        strcmp(text, foot) != 0) {
        return 0;
    }
    return fseek(file, -back, SEEK_END) == 0;
}

int spar_vtk_series_add(const char *path, double time, int part, const char *file) {
    const char *call = "spar_vtk_series_add";
    SPARI_REQUIRE(NULL, path && path[0] && file && file[0], SPAR_ERR_ARGUMENT,
                  "%s: the path of the index or the name of the file is missing", call);
    SPARI_REQUIRE(NULL, spari_first_nonfinite(&time, 1) < 0 && part >= 0, SPAR_ERR_ARGUMENT,
                  "%s: '%s': time %g, part %d; give a finite time and a part counted from 0", call, file, time, part);
    errno = 0;
    FILE *index = fopen(path, "r+b");
    if (!index) {
        errno = 0;
        index = fopen(path, "w+b");
    }
    SPARI_REQUIRE(NULL, index, SPAR_ERR_IO, "%s: '%s' cannot be opened: %s; check the folder and its rights", call,
                  path, strerror(errno));
    if (!find_end(index)) {
        fclose(index);
        return spari_fail(NULL, SPAR_ERR_IO, "%s: '%s' is no index of a series; remove it or name another", call, path);
    }
    fprintf(index, "<DataSet timestep=\"%.17g\" part=\"%d\" file=\"", time, part);
    put_text(index, file);
    fprintf(index, "\"/>\n%s", foot);
    int bad = ferror(index);
    bad = fclose(index) != 0 || bad;
    SPARI_REQUIRE(NULL, !bad, SPAR_ERR_IO, "%s: '%s' cannot be written: %s; check the disk's room", call, path,
                  strerror(errno));
    return SPAR_OK;
}
