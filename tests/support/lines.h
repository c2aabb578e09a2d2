/* Lines to project on, and an oracle for the nearest point that shares nothing with the library but the place of the
 * nodes. */
#ifndef TEST_LINES_H
#define TEST_LINES_H

enum { LINE_NODES = 24, LINE_ELEMENTS = 8 };

/* Uniform in [-1,1]; the state makes a sequence of its own. */
double line_random(unsigned long long *state);

typedef struct polyline {
    int elements, nodes; /* nodes per element */
    double x[LINE_ELEMENTS * LINE_NODES][3];
    double scale;                               /* longest side of its box */
    double gll[LINE_NODES], weight[LINE_NODES]; /* of the element, for the barycentric formula */
    int samples;                                /* per element */
    double (*sample)[3];                        /* places at equal steps of xi */
} polyline;

typedef void (*line_shape)(double eta, double x[3]);
/* Nodes on a curve; eta in [0,1] along it. */
void line_of_shape(polyline *l, int elements, int nodes, line_shape shape);
/* Element by element from given nodes [elements * nodes][3]. */
void line_of_nodes(polyline *l, int elements, int nodes, const double *x);
/* Random polynomials: Chebyshev coefficients that fall off by `decay` per degree (1: wild). */
void line_at_random(polyline *l, int nodes, double decay, unsigned long long *state);
void line_free(polyline *l);

/* Place, and first and second derivative by xi (by divided differences of the barycentric formula for the latter). */
void line_at(const polyline *l, int element, double xi, double x[3]);
void line_slope(const polyline *l, int element, double xi, double dx[3]);
void line_curve(const polyline *l, int element, double xi, double ddx[3]);

/* Least distance of p: dense scan, then golden-section search round the least samples. */
double line_distance(const polyline *l, const double p[3]);

#endif
