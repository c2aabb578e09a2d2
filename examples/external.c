/* The host's own structure, coupled by spar: an external member. A disc of mass m on a spring that hardens, which the
   host integrates itself, moves in water whose added mass M is up to a hundred times m. spar carries motion to the
   fluid's nodes and loads to the member, and makes the iteration converge. Exact to compare with: the same integrator
   for one body that has both masses. */
#include <math.h>
#include <spar/spar.h>
#include <stdio.h>
#include <stdlib.h>

static const double mass = 1, stiffness = 40, hardening = 400, dt = 0.01; /* kg, N/m, N/m^3, s */
enum { STEPS = 400 };

typedef struct disc {
    double x, v, a;
} disc;

static void check(const spar_session *s, int status) {
    if (status != SPAR_OK) {
        fprintf(stderr, "external: %s: %s\n", spar_status_text(status), spar_session_message(s));
        exit(1);
    }
}

/* The host's structure over a step, by the trapezoidal rule: m a + spring(x) + added (v - v_n) / dt = load. */
static disc advance(const disc *n, double load, double added) {
    disc d = *n;
    for (int i = 0; i < 20; i++) {
        d.x = n->x + dt * n->v + 0.25 * dt * dt * (n->a + d.a);
        d.v = n->v + 0.5 * dt * (n->a + d.a);
        double force = mass * d.a + stiffness * d.x + hardening * pow(d.x, 3) + added * (d.v - n->v) / dt - load;
        double slope = mass + (stiffness + 3 * hardening * d.x * d.x) * 0.25 * dt * dt + 0.5 * added;
        d.a -= force / slope;
    }
    return d;
}

static void place(spar_session *s, spar_member *body, const disc *d) {
    const double q[7] = {d->x, 0, 0, 1}, v[6] = {d->v}, a[6] = {d->a};
    check(s, spar_member_set_motion(body, q, v, a));
}

/* One step: the loop of every external member. Returns the iterations. */
static int couple(spar_session *s, spar_member *body, spar_fluid *water, double added, disc *now) {
    disc next;
    int done = 0, iterations = 0;
    check(s, spar_step_begin(s, dt));
    while (!done) {
        double load[6], v[3];
        check(s, spar_member_get_loads(body, load)); /* predicted at first, then accelerated */
        next = advance(now, load[0], 0);
        place(s, body, &next);
        check(s, spar_step_solve(s)); /* the other members, if there are any */
        check(s, spar_fluid_pull_motion(water, 1, NULL, v));
        const double push[3] = {-added * (v[0] - now->v) / dt, 0, 0};
        check(s, spar_fluid_push_forces(water, push, NULL));
        check(s, spar_step_check(s, &done));
        iterations++;
    }
    check(s, spar_step_accept(s));
    *now = next;
    return iterations;
}

/* Largest difference of the places from those of one body with both masses, over the amplitude. */
static double run(double added, double *iterations) {
    const double x[3] = {0, 0, 0}, q[4] = {1, 0, 0, 0};
    double m[36] = {0}, off = 0;
    spar_session *s = NULL;
    spar_member *body = NULL;
    spar_fluid *water = NULL;
    for (int i = 0; i < 6; i++) {
        m[7 * i] = mass;
    }
    check(NULL, spar_session_create(&s));
    check(s, spar_session_set_coupling(s, SPAR_COUPLING_IQN_ILS, 1e-9, 1e-8, 50));
    check(s, spar_rigid_create(s, "disc", x, q, m, &body));
    check(s, spar_member_set_external(body, 1));
    check(s, spar_member_commit(body));
    check(s, spar_fluid_create(body, "water", &water));
    check(s, spar_fluid_set_motion_nodes(water, 1, x));
    check(s, spar_fluid_set_force_nodes(water, 1, x));
    check(s, spar_fluid_map(water));
    disc now = {0.2, 0, 0}, both;
    now.a = -(stiffness * now.x + hardening * pow(now.x, 3)) / (mass + added);
    both = now;
    place(s, body, &now);
    const double first[3] = {-added * now.a, 0, 0};
    check(s, spar_fluid_push_forces(water, first, NULL)); /* at t = 0 */
    *iterations = 0;
    for (int i = 0; i < STEPS; i++) {
        *iterations += (double)couple(s, body, water, added, &now) / STEPS;
        both = advance(&both, 0, added);
        off = fmax(off, fabs(now.x - both.x) / 0.2);
    }
    spar_session_destroy(&s);
    return off;
}

int main(void) {
    static const double ratios[] = {0.1, 1, 10, 100};
    printf("A disc that the host integrates, in water of added mass M; %d steps\n\n     M/m  iterations a step  "
           "difference\n",
           STEPS);
    for (int i = 0; i < 4; i++) {
        double iterations, off = run(ratios[i] * mass, &iterations);
        printf("%8g  %17.2f  %10.1e\n", ratios[i], iterations, off);
    }
    return 0;
}
