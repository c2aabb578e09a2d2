/* Stores positions and velocities from registers directly in the host's triples, for one vector width. Included by
   transfer_lanes.c, with its macros.
   The host's array may begin anywhere in a cache line of 64 bytes. With vectors of a full line, the interleaved
     numbers are rotated by this offset and combined with the rest of the previous vector. So whole lines are
     written, once each, and with non-temporal stores if wanted. (Processors collect written lines in few buffers;
     whole lines leave them at once, and here the stores are spread over the arithmetic.) */

#if W == 8 && defined(STREAM)
/* Destination of a run's triples. */
typedef struct NAME(flow) {
    __m512i last, rotation; /* numbers not yet written are at the end of last */
    char *to;               /* address of the next pair of vectors */
    char *line;             /* next line to write; NULL: not begun, or whole lines are impossible */
    int past;
} NAME(flow);

HERE NAME(flow) NAME(flow_to)(void *to, int past) {
    const __m512i count = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
    const int before = (int)((uintptr_t)to & 63) / 4;
    NAME(flow) f = {.to = to, .past = past, .last = count};
    f.rotation = _mm512_add_epi32(count, _mm512_set1_epi32(16 - before));
    return f;
}

HERE void NAME(write_line)(NAME(flow) * f, __m512i v) {
    const __m512i line = _mm512_permutex2var_epi32(f->last, f->rotation, v);
    if (f->past) {
        _mm512_stream_si512((void *)f->line, line);
    } else {
        _mm512_store_si512((void *)f->line, line);
    }
    f->line += 64;
    f->last = v;
}

/* Writes the n vectors of a pair. The first pair of a run is written unaligned, up to the first line. */
HERE void NAME(write_pair)(NAME(flow) * f, const int n, const __m512i *v) {
    if (f->line) {
        SPARI_UNROLL
        for (int i = 0; i < n; i++) {
            NAME(write_line)(f, v[i]);
        }
    } else {
        SPARI_UNROLL
        for (int i = 0; i < n; i++) {
            _mm512_storeu_si512((void *)(f->to + (ptrdiff_t)64 * i), v[i]);
        }
        if (((uintptr_t)f->to & 3) == 0) {
            f->line = f->to + (ptrdiff_t)64 * n - ((uintptr_t)f->to & 63);
            f->last = v[n - 1];
        }
    }
    f->to += (ptrdiff_t)64 * n;
}

/* Writes the rest of the last line. */
HERE void NAME(end_flow)(NAME(flow) * f) {
    if (f->line) {
        __m512i line = _mm512_permutex2var_epi32(f->last, f->rotation, f->last);
        memcpy(f->line, &line, (size_t)(f->to - f->line));
        f->line = NULL;
    }
}

/* 16 triples of floats from doubles. */
HERE void NAME(weave_singles)(const L (*v)[3], __m512i *out) {
    __m512 x[3];
    SPARI_UNROLL
    for (int i = 0; i < 3; i++) {
        __m256 low = _mm512_cvtpd_ps(v[0][i]), high = _mm512_cvtpd_ps(v[1][i]);
        x[i] = _mm512_insertf32x8(_mm512_castps256_ps512(low), high, 1);
    }
    const __m512i xy[3] = {_mm512_setr_epi32(0, 16, 0, 1, 17, 0, 2, 18, 0, 3, 19, 0, 4, 20, 0, 5),
                           _mm512_setr_epi32(21, 0, 6, 22, 0, 7, 23, 0, 8, 24, 0, 9, 25, 0, 10, 26),
                           _mm512_setr_epi32(0, 11, 27, 0, 12, 28, 0, 13, 29, 0, 14, 30, 0, 15, 31, 0)};
    const __m512i z[3] = {_mm512_setr_epi32(0, 1, 16, 3, 4, 17, 6, 7, 18, 9, 10, 19, 12, 13, 20, 15),
                          _mm512_setr_epi32(0, 21, 2, 3, 22, 5, 6, 23, 8, 9, 24, 11, 12, 25, 14, 15),
                          _mm512_setr_epi32(26, 1, 2, 27, 4, 5, 28, 7, 8, 29, 10, 11, 30, 13, 14, 31)};
    SPARI_UNROLL
    for (int i = 0; i < 3; i++) {
        out[i] = _mm512_castps_si512(_mm512_permutex2var_ps(_mm512_permutex2var_ps(x[0], xy[i], x[1]), z[i], x[2]));
    }
}

/* Triples of a pair of vectors, of which `count` nodes exist. */
HERE void NAME(give_pair)(NAME(flow) * f, const int single, const L (*v)[3], int count) {
    const int n = single ? 3 : 6;
    __m512i out[6];
    if (single) {
        NAME(weave_singles)(v, out);
    } else {
        L t[6];
        NAME(weave)(v[0], t);
        NAME(weave)(v[1], t + 3);
        SPARI_UNROLL
        for (int i = 0; i < 6; i++) {
            out[i] = _mm512_castpd_si512(t[i]);
        }
    }
    if (count >= PAIR) {
        NAME(write_pair)(f, n, out);
        return;
    }
    NAME(end_flow)(f);
    memcpy(f->to, out, (size_t)count * 3 * (single ? sizeof(float) : sizeof(double)));
}
#else
typedef struct NAME(flow) {
    char *to;
} NAME(flow);

HERE NAME(flow) NAME(flow_to)(void *to, int past) {
    (void)past;
    return (NAME(flow)){to};
}

HERE void NAME(end_flow)(NAME(flow) * f) {
    (void)f;
}

HERE void NAME(give_pair)(NAME(flow) * f, const int single, const L (*v)[3], int count) {
    double part[3 * PAIR], *out = count >= PAIR && !single ? (void *)f->to : part;
    float singles[3 * PAIR];
    const size_t n = 3 * (size_t)(count < PAIR ? count : PAIR);
    NAME(put_triples)(v[0], out);
    NAME(put_triples)(v[1], out + 3 * W);
    if (single) {
        SPARI_UNROLL_ALL
        for (int i = 0; i < 3 * PAIR; i++) {
            singles[i] = (float)part[i];
        }
        memcpy(f->to, singles, n * sizeof *singles);
        f->to += n * sizeof *singles;
        return;
    }
    if (out == part) {
        memcpy(f->to, part, n * sizeof *part);
    }
    f->to += n * sizeof *part;
}
#endif

HERE double NAME(direct)(const spari_nodes *s, int64_t first, int count, const double *c, const int consistent,
                         const int what, const int single, void *x, void *v, int past) {
    static const double huge = HUGE_VAL;
    const double *const from[4] = {s->xi, s->con[0], s->con[1], s->con[2]};
    double pad[4][PAIR];
    L least = SPLAT(&huge), out[2][SPARI_ROWS];
    NAME(flow) places = NAME(flow_to)(x, past), rates = NAME(flow_to)(v, past);
    for (int begin = 0, end = count - count % PAIR; begin < count; begin = end, end = count) {
        const double *row[4];
        NAME(begin_rows)(from, 4, 0, first, begin, end, pad, row);
        for (int i = begin; i < end; i += PAIR) {
            least = NAME(less)(least, NAME(move_pair)(s, from, row, first + i, i - begin, c, consistent, what, out));
            if (x) {
                const L t[2][3] = {{out[0][0], out[0][1], out[0][2]}, {out[1][0], out[1][1], out[1][2]}};
                NAME(give_pair)(&places, single, t, end - i);
            }
            if (what == SPARI_UPTO_RATE) {
                const L t[2][3] = {{out[0][3], out[0][4], out[0][5]}, {out[1][3], out[1][4], out[1][5]}};
                NAME(give_pair)(&rates, single, t, end - i);
            }
        }
    }
    NAME(end_flow)(&places);
    NAME(end_flow)(&rates);
    return NAME(least)(least);
}

#define DIRECT(name, consistent, what, single)                                                                         \
    TARGET SPARI_APART static double NAME(direct_##name)(const spari_nodes *s, int64_t first, int count,               \
                                                         const double *c, void *x, void *v, int past) {                \
        return NAME(direct)(s, first, count, c, consistent, what, single, x, v, past);                                 \
    }
DIRECT(places, 0, SPARI_UPTO_POSITION, 0)
DIRECT(nodal, 0, SPARI_UPTO_RATE, 0)
DIRECT(consistent, 1, SPARI_UPTO_RATE, 0)
DIRECT(places_single, 0, SPARI_UPTO_POSITION, 1)
DIRECT(nodal_single, 0, SPARI_UPTO_RATE, 1)
DIRECT(consistent_single, 1, SPARI_UPTO_RATE, 1)
#undef DIRECT

/* x, v: triples of the first node of the run, double or float; either may be NULL. past: non-temporal stores, which
   need whole lines. */
TARGET static double NAME(move_to)(const spari_nodes *s, int64_t first, int count, const double *c, int consistent,
                                   int single, void *x, void *v, int past) {
    static double (*const direct[2][3])(const spari_nodes *, int64_t, int, const double *, void *, void *, int) = {
        {NAME(direct_places), NAME(direct_nodal), NAME(direct_consistent)},
        {NAME(direct_places_single), NAME(direct_nodal_single), NAME(direct_consistent_single)}};
    return direct[!!single][v ? 1 + !!consistent : 0](s, first, count, c, x, v, past);
}
