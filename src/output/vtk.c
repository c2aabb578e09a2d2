/* Writes points, lines and fields as VTK files (XML, base64). */
#include "vtk.h"

#include "../base/file.h"

#include <stdio.h>
#include <string.h>

/* ---- base64 (RFC 4648) ---- */

typedef struct encoder {
    FILE *file;
    unsigned char group[3];
    int held; /* bytes waiting in group */
} encoder;

/* Encodes three bytes in four characters. */
static void spell(const unsigned char g[3], char text[4]) {
    static const char digit[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    text[0] = digit[g[0] >> 2];
    text[1] = digit[(g[0] & 3) << 4 | g[1] >> 4];
    text[2] = digit[(g[1] & 15) << 2 | g[2] >> 6];
    text[3] = digit[g[2] & 63];
}

/* Writes an incomplete group, padded. */
static void put_group(encoder *s) {
    char text[4];
    spell(s->group, text);
    for (int i = s->held + 1; i < 4; i++) {
        text[i] = '=';
    }
    (void)fwrite(text, 1, sizeof text, s->file);
    memset(s->group, 0, sizeof s->group);
    s->held = 0;
}

/* Many whole groups of three bytes at a time: one call each would dominate the cost. */
static void put_groups(encoder *s, const unsigned char *byte, size_t groups) {
    enum { AT_ONCE = 256 };
    char text[4 * AT_ONCE];
    while (groups > 0) {
        size_t now = groups < AT_ONCE ? groups : AT_ONCE;
        for (size_t i = 0; i < now; i++) {
            spell(byte + 3 * i, text + 4 * i);
        }
        (void)fwrite(text, 1, 4 * now, s->file);
        byte += 3 * now;
        groups -= now;
    }
}

static void put_bytes(encoder *s, const void *data, size_t size) {
    const unsigned char *byte = data, *end = byte + size;
    while (byte < end) {
        if (s->held == 0 && end - byte >= 3) {
            size_t groups = (size_t)(end - byte) / 3;
            put_groups(s, byte, groups);
            byte += 3 * groups;
            continue;
        }
        s->group[s->held++] = *byte++;
        if (s->held == 3) {
            put_group(s);
        }
    }
}

static void put_int64(encoder *s, int64_t value) {
    put_bytes(s, &value, sizeof value);
}

/* ---- XML ---- */

/* An array begins with its size in bytes, in the same base64 text as the numbers. */
static void begin_array(encoder *s, const char *type, const char *name, int components, int64_t tuples, size_t item) {
    fprintf(s->file, "<DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%d\" format=\"binary\">", type, name,
            components);
    put_int64(s, tuples * components * (int64_t)item);
}

static void end_array(encoder *s) {
    if (s->held > 0) {
        put_group(s);
    }
    fputs("</DataArray>\n", s->file);
}

static void put_field(encoder *s, const spari_vtk_field *f, int64_t tuples) {
    begin_array(s, "Float64", f->name, f->components, tuples, sizeof(double));
    put_bytes(s, f->value, (size_t)tuples * (size_t)f->components * sizeof(double));
    end_array(s);
}

/* Field data of the whole file: NumberOfTuples is required here, because no number of points implies it. */
static void put_fact(encoder *s, const spari_vtk_field *f) {
    fprintf(s->file,
            "<DataArray type=\"Float64\" Name=\"%s\" NumberOfComponents=\"%d\" NumberOfTuples=\"1\" format=\"binary\">",
            f->name, f->components);
    put_int64(s, f->components * (int64_t)sizeof(double));
    put_bytes(s, f->value, (size_t)f->components * sizeof(double));
    end_array(s);
}

static void put_facts(encoder *s, const spari_vtk_picture *p) {
    fputs("<FieldData>\n", s->file);
    put_fact(s, &(spari_vtk_field){"TimeValue", 1, &p->time});
    for (int i = 0; i < p->facts; i++) {
        put_fact(s, &p->fact[i]);
    }
    fputs("</FieldData>\n", s->file);
}

static void put_points(encoder *s, const spari_vtk_picture *p) {
    fputs("<PointData>\n", s->file);
    for (int i = 0; i < p->fields; i++) {
        put_field(s, &p->field[i], p->points);
    }
    fputs("</PointData>\n<Points>\n", s->file);
    put_field(s, &(spari_vtk_field){"Points", 3, p->x}, p->points);
    fputs("</Points>\n", s->file);
}

static int64_t count_line_points(const spari_vtk_picture *p) {
    return p->lines > 0 ? p->line_end[p->lines - 1] : 0;
}

static void put_vert_numbers(encoder *s, const spari_vtk_picture *p) {
    for (int64_t i = 0; i < p->verts; i++) {
        put_int64(s, p->vert ? p->vert[i] : i);
    }
}

static void put_count(encoder *s, int64_t first, int64_t n) {
    for (int64_t i = 0; i < n; i++) {
        put_int64(s, first + i);
    }
}

static void put_poly_cells(encoder *s, const spari_vtk_picture *p) {
    fputs("<Verts>\n", s->file);
    begin_array(s, "Int64", "connectivity", 1, p->verts, 8);
    put_vert_numbers(s, p);
    end_array(s);
    begin_array(s, "Int64", "offsets", 1, p->verts, 8);
    put_count(s, 1, p->verts);
    end_array(s);
    fputs("</Verts>\n<Lines>\n", s->file);
    begin_array(s, "Int64", "connectivity", 1, count_line_points(p), 8);
    for (int64_t i = 0; i < count_line_points(p); i++) {
        put_int64(s, p->line_point ? p->line_point[i] : i);
    }
    end_array(s);
    begin_array(s, "Int64", "offsets", 1, p->lines, 8);
    put_bytes(s, p->line_end, (size_t)p->lines * sizeof *p->line_end);
    end_array(s);
    fputs("</Lines>\n", s->file);
}

/* Polylines of a grid are split into segments, because some readers (meshio) have no polylines. */
static int64_t count_segments(const spari_vtk_picture *p) {
    int64_t n = 0;
    for (int64_t k = 0, at = 0; k < p->lines; at = p->line_end[k++]) {
        n += p->line_end[k] > at ? p->line_end[k] - at - 1 : 0;
    }
    return n;
}

static void put_segments(encoder *s, const spari_vtk_picture *p) {
    for (int64_t k = 0, at = 0; k < p->lines; at = p->line_end[k++]) {
        for (int64_t i = at; i + 1 < p->line_end[k]; i++) {
            put_int64(s, p->line_point ? p->line_point[i] : i);
            put_int64(s, p->line_point ? p->line_point[i + 1] : i + 1);
        }
    }
}

static void put_grid_cells(encoder *s, const spari_vtk_picture *p) {
    enum { VERTEX = 1, LINE = 3 }; /* VTK cell types */
    int64_t segments = count_segments(p);
    fputs("<Cells>\n", s->file);
    begin_array(s, "Int64", "connectivity", 1, p->verts + 2 * segments, 8);
    put_vert_numbers(s, p);
    put_segments(s, p);
    end_array(s);
    begin_array(s, "Int64", "offsets", 1, p->verts + segments, 8);
    put_count(s, 1, p->verts);
    for (int64_t k = 1; k <= segments; k++) {
        put_int64(s, p->verts + 2 * k);
    }
    end_array(s);
    begin_array(s, "UInt8", "types", 1, p->verts + segments, 1);
    for (int64_t k = 0; k < p->verts + segments; k++) {
        unsigned char type = k < p->verts ? VERTEX : LINE;
        put_bytes(s, &type, 1);
    }
    end_array(s);
    fputs("</Cells>\n", s->file);
}

static const char *byte_order(void) {
    int64_t one = 1;
    unsigned char first;
    memcpy(&first, &one, 1);
    return first == 1 ? "LittleEndian" : "BigEndian";
}

static void put_picture(FILE *file, const spari_vtk_picture *p, int grid) {
    encoder s = {.file = file};
    const char *kind = grid ? "UnstructuredGrid" : "PolyData";
    fprintf(file,
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"%s\" version=\"1.0\" byte_order=\"%s\" header_type=\"UInt64\">\n",
            kind, byte_order());
    fprintf(file, "<%s>\n", kind);
    put_facts(&s, p);
    fprintf(file, "<Piece NumberOfPoints=\"%lld\" ", (long long)p->points);
    if (grid) {
        fprintf(file, "NumberOfCells=\"%lld\">\n", (long long)(p->verts + count_segments(p)));
    } else {
        fprintf(file, "NumberOfVerts=\"%lld\" NumberOfLines=\"%lld\" NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n",
                (long long)p->verts, (long long)p->lines);
    }
    put_points(&s, p);
    (grid ? put_grid_cells : put_poly_cells)(&s, p);
    fprintf(file, "</Piece>\n</%s>\n</VTKFile>\n", kind);
}

/* ---- the file ---- */

int spari_vtk_write(spar_session *session, const char *call, const char *path, const spari_vtk_picture *picture) {
    char why[SPARI_MESSAGE_SIZE / 2];
    spari_file file;
    SPARI_REQUIRE(session, path && path[0], SPAR_ERR_ARGUMENT, "%s: the path is %s; name a file ending in .vtp or .vtu",
                  call, path ? "empty" : "NULL");
    int status = spari_file_begin(&file, path, ".part", why, sizeof why);
    if (status == SPAR_OK) {
        size_t n = strlen(path);
        put_picture(file.stream, picture, n >= 4 && strcmp(path + n - 4, ".vtu") == 0);
        status = spari_file_end(&file, 0, why, sizeof why);
    }
    SPARI_REQUIRE(session, status == SPAR_OK, status, "%s: %s", call, why);
    return SPAR_OK;
}
