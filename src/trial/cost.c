/* Cost of a run, counted: see cost.h. */
#include "cost.h"

#include "../comm/comm.h"
#include "../coupling/coupling.h"
#include "../exchange/session_private.h"
#include "../fluid/fluid.h"
#include "../member/beam.h"
#include "../time/fidelity.h"
#include "rules.h"

#include <math.h>

/* Integers: their sum over the ranks does not depend on the order. */
static double whole(double cost) {
    return floor(cost + 0.5);
}

static double iteration_cost(const spari_effort *e) {
    const spari_prices *p = &spari_rule.price;
    double N = e->unknowns, solve = N * (p->solve + p->solve_row * e->band);
    if (e->points == 0) {
        enum { PRODUCTS = 3 }; /* with stiffness, damping, mass */
        return e->nodes * p->frame_node + PRODUCTS * (p->product + p->product_row * N * e->band) + solve;
    }
    return e->nodes * p->node + e->points * (p->point + p->point_node * e->per_element) + solve;
}

static double tangent_cost(const spari_effort *e) {
    const spari_prices *p = &spari_rule.price;
    double N = e->unknowns, pairs = (double)e->per_element * e->per_element,
           form = e->elements * pairs * p->pair + e->points * (p->tangent_point + p->tangent_point_pair * pairs);
    return (e->points > 0 ? form : 0) + N * (p->factor + e->band * (p->factor_row + p->factor_fill * e->band));
}

double spari_cost_members(const spar_session *s, double *each) {
    double sum = 0;
    int k = 0;
    for (const spar_member *m = s->members; m; m = m->next, k++) {
        spari_effort e = {0};
        if (m->committed && m->row->effort && spari_fidelity_is_here(m)) {
            m->row->effort(m, &e);
        }
        double own = (double)e.iterations * whole(iteration_cost(&e)) + (double)e.tangents * whole(tangent_cost(&e));
        sum += own;
        if (each) {
            each[k] = own;
        }
    }
    return sum;
}

static int unknowns_of(const spar_member *m, int elements, int nodes) {
    return 6 * (elements * (nodes - 1) + !spari_member_root_is_prescribed(m));
}

double spari_cost_exact(const spar_member *m, int elements, int nodes, int points) {
    int unknowns = unknowns_of(m, elements, nodes);
    const spari_effort e = {.nodes = elements * (nodes - 1) + 1,
                            .elements = elements,
                            .per_element = nodes,
                            .points = (int)spari_beam_points(m, elements, nodes, points),
                            .unknowns = unknowns,
                            .band = spari_effort_band(unknowns, 6 * nodes)};
    return iteration_cost(&e) + tangent_cost(&e);
}

double spari_cost_frame(const spar_member *m, int elements, int nodes, int modes) {
    int unknowns = modes > 0 ? modes : unknowns_of(m, elements, nodes);
    const spari_effort e = {.nodes = elements * (nodes - 1) + 1,
                            .per_element = nodes,
                            .unknowns = unknowns,
                            .band = modes > 0 ? modes : spari_effort_band(unknowns, 6 * nodes)};
    return iteration_cost(&e);
}

static double count_nodes(const spar_fluid *f) {
    int64_t n = 0;
    (void)spar_fluid_get_count(f, SPAR_NODES_FORCE, &n);
    return (double)n;
}

/* Transfer of motion to the fluids and of loads from them, once. */
static double map_cost(const spar_session *s) {
    const spari_prices *p = &spari_rule.price;
    double sum = 0;
    for (const spar_fluid *f = s->fluids; f; f = spari_fluid_next(f)) {
        const spar_member *m = spari_fluid_member(f);
        double P = m->mesh.per_element;
        sum += (double)m->nodes * (p->map + p->map_pair * P) + count_nodes(f) * (p->map_node + p->map_shape * P);
    }
    return sum;
}

double spari_cost_step(const spar_session *s, int iterations) {
    const spari_prices *p = &spari_rule.price;
    const spari_coupling *c = s->own->coupling;
    double nodes = (double)c->n / 6, k = c->report[SPAR_REPORT_COLUMNS],
           accelerated = (double)c->n * k * (p->column + p->column_pair * k);
    return whole(nodes * p->step_node + iterations * (nodes * p->solution_node + map_cost(s)) +
                 (iterations - 1) * accelerated);
}

double spari_cost_fluids(const spar_session *s) {
    const spari_prices *p = &spari_rule.price;
    double sum = 0;
    for (const spar_fluid *f = s->fluids; f; f = spari_fluid_next(f)) {
        double each = spari_fluid_has_sections(f) ? p->fluid_section : p->fluid_node;
        sum += p->fluid + each * count_nodes(f);
    }
    return sum;
}

double spari_cost_solution(double given, double by_nodes, double seconds, int64_t solutions) {
    const spari_prices *p = &spari_rule.price;
    if (given > 0) {
        return whole(fmin(given * p->second, 1e15));
    }
    /* the time of a solution, relative to what its nodes lead one to expect */
    double timed = solutions > 0 ? seconds / (double)solutions * p->second : 0,
           times = timed / fmax(by_nodes, p->fluid);
    double power = times > p->believed ? floor(0.5 * log(times) / log(p->believed) + 0.5) : 0;
    return whole(fmax(by_nodes, p->fluid) * pow(p->believed, 2 * power));
}

int spari_cost_wavers(double given, double by_nodes, double seconds, int64_t solutions) {
    const double near = 2; /* timing error of a busy machine */
    return spari_cost_solution(given, by_nodes, seconds / near, solutions) !=
           spari_cost_solution(given, by_nodes, seconds * near, solutions);
}
