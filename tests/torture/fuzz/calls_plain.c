/* Callers whose arguments follow from their types. Written by cmake/make-bindings.sh from the headers. */
#include "fuzz.h"

void do_spar_session_get_gravity(call *c) {
    live_session *session = arg_session(c);
    double *g = arg_out(c, 3 * (int64_t)sizeof *g, 0);
    RUN(c, spar_session_get_gravity(session->s, g));
}

void do_spar_session_get_coupling(call *c) {
    live_session *session = arg_session(c);
    int *scheme = arg_out(c, (int64_t)sizeof *scheme, 1);
    double *atol = arg_out(c, (int64_t)sizeof *atol, 1);
    double *rtol = arg_out(c, (int64_t)sizeof *rtol, 1);
    int *max_iterations = arg_out(c, (int64_t)sizeof *max_iterations, 1);
    RUN(c, spar_session_get_coupling(session->s, scheme, atol, rtol, max_iterations));
}

void do_spar_session_get_time(call *c) {
    live_session *session = arg_session(c);
    double *t = arg_out(c, (int64_t)sizeof *t, 1);
    int64_t *step = arg_out(c, (int64_t)sizeof *step, 1);
    int *iteration = arg_out(c, (int64_t)sizeof *iteration, 1);
    RUN(c, spar_session_get_time(session->s, t, step, iteration));
}

void do_spar_section_from_shape(call *c) {
    int shape = arg_int(c, 0, 3);
    int64_t n = arg_count(c, 0, 4);
    double *dimension = arg_reals(c, length(n), -1, 1);
    double young = arg_real(c, 0, 1);
    double poisson = arg_real(c, 0, 1);
    double density = arg_real(c, 0, 1);
    int64_t capacity = arg_count(c, 0, 4);
    double *property = arg_out(c, SPAR_SECTION_COUNT * (int64_t)sizeof *property, 0);
    RUN(c, spar_section_from_shape(shape, n, dimension, young, poisson, density, capacity, property));
}

void do_spar_section_build(call *c) {
    int64_t n = arg_count(c, 0, 4);
    double *property = arg_reals(c, length(n), -1, 1);
    double *stiffness = arg_out(c, 36 * (int64_t)sizeof *stiffness, 1);
    double *mass = arg_out(c, 36 * (int64_t)sizeof *mass, 1);
    RUN(c, spar_section_build(n, property, stiffness, mass));
}

void do_spar_section_describe(call *c) {
    double *stiffness = arg_reals(c, 36, -1, 1);
    double *mass = arg_reals_or_null(c, 36, -1, 1);
    int64_t capacity = arg_count(c, 0, 4);
    double *property = arg_out(c, SPAR_SECTION_COUNT * (int64_t)sizeof *property, 1);
    int *findings = arg_out(c, (int64_t)sizeof *findings, 1);
    RUN(c, spar_section_describe(stiffness, mass, capacity, property, findings));
}

void do_spar_section_transform(call *c) {
    double *matrix = arg_reals(c, 36, -1, 1);
    double y = arg_real(c, 0, 1);
    double z = arg_real(c, 0, 1);
    double angle = arg_real(c, 0, 1);
    double *out = arg_out(c, 36 * (int64_t)sizeof *out, 0);
    RUN(c, spar_section_transform(matrix, y, z, angle, out));
}

void do_spar_beam_get_axis(call *c) {
    live_member *beam = arg_member(c, KIND_BEAM);
    int64_t *n = arg_out(c, (int64_t)sizeof *n, 1);
    int64_t capacity = arg_count(c, 0, 4);
    double *eta = arg_out(c, length(capacity) * (int64_t)sizeof *eta, 1);
    double *xyz = arg_out(c, length(capacity) * 3 * (int64_t)sizeof *xyz, 1);
    double *twist = arg_out(c, length(capacity) * (int64_t)sizeof *twist, 1);
    RUN(c, spar_beam_get_axis(beam->m, n, capacity, eta, xyz, twist));
}

void do_spar_beam_get_sections(call *c) {
    live_member *beam = arg_member(c, KIND_BEAM);
    int64_t *n = arg_out(c, (int64_t)sizeof *n, 1);
    int64_t capacity = arg_count(c, 0, 4);
    double *eta = arg_out(c, length(capacity) * (int64_t)sizeof *eta, 1);
    double *stiffness = arg_out(c, length(capacity) * 36 * (int64_t)sizeof *stiffness, 1);
    double *mass = arg_out(c, length(capacity) * 36 * (int64_t)sizeof *mass, 1);
    RUN(c, spar_beam_get_sections(beam->m, n, capacity, eta, stiffness, mass));
}

void do_spar_session_get_integrator(call *c) {
    live_session *session = arg_session(c);
    double *rho_inf = arg_out(c, (int64_t)sizeof *rho_inf, 1);
    int *substeps = arg_out(c, (int64_t)sizeof *substeps, 1);
    RUN(c, spar_session_get_integrator(session->s, rho_inf, substeps));
}

void do_spar_session_get_newton(call *c) {
    live_session *session = arg_session(c);
    double *atol = arg_out(c, (int64_t)sizeof *atol, 1);
    double *rtol = arg_out(c, (int64_t)sizeof *rtol, 1);
    int *max_iterations = arg_out(c, (int64_t)sizeof *max_iterations, 1);
    RUN(c, spar_session_get_newton(session->s, atol, rtol, max_iterations));
}

void do_spar_session_get_predictor(call *c) {
    live_session *session = arg_session(c);
    int *order = arg_out(c, (int64_t)sizeof *order, 0);
    RUN(c, spar_session_get_predictor(session->s, order));
}

void do_spar_session_get_relaxation(call *c) {
    live_session *session = arg_session(c);
    double *omega = arg_out(c, (int64_t)sizeof *omega, 0);
    RUN(c, spar_session_get_relaxation(session->s, omega));
}

void do_spar_session_get_residual(call *c) {
    live_session *session = arg_session(c);
    double *residual = arg_out(c, (int64_t)sizeof *residual, 1);
    double *size = arg_out(c, (int64_t)sizeof *size, 1);
    RUN(c, spar_session_get_residual(session->s, residual, size));
}

void do_spar_session_get_tolerance(call *c) {
    live_session *session = arg_session(c);
    double *drift = arg_out(c, (int64_t)sizeof *drift, 1);
    double *rtol = arg_out(c, (int64_t)sizeof *rtol, 1);
    RUN(c, spar_session_get_tolerance(session->s, drift, rtol));
}

void do_spar_session_get_reproducible(call *c) {
    live_session *session = arg_session(c);
    int *on = arg_out(c, (int64_t)sizeof *on, 0);
    RUN(c, spar_session_get_reproducible(session->s, on));
}

void do_spar_session_get_threads(call *c) {
    live_session *session = arg_session(c);
    int *threads = arg_out(c, (int64_t)sizeof *threads, 0);
    RUN(c, spar_session_get_threads(session->s, threads));
}

void do_spar_fluid_map_current(call *c) {
    live_fluid *fluid = arg_fluid(c);
    RUN(c, spar_fluid_map_current(fluid->f));
}

void do_spar_aero_get_polar(call *c) {
    live_aero *aero = arg_aero(c);
    int64_t i = arg_count(c, 0, 4);
    int64_t *n = arg_out(c, (int64_t)sizeof *n, 1);
    int64_t capacity = arg_count(c, 0, 4);
    double *alpha_rad = arg_out(c, length(capacity) * (int64_t)sizeof *alpha_rad, 1);
    double *cl = arg_out(c, length(capacity) * (int64_t)sizeof *cl, 1);
    double *cd = arg_out(c, length(capacity) * (int64_t)sizeof *cd, 1);
    double *cm = arg_out(c, length(capacity) * (int64_t)sizeof *cm, 1);
    int *kind = arg_out(c, (int64_t)sizeof *kind, 1);
    RUN(c, spar_aero_get_polar(aero->a, i, n, capacity, alpha_rad, cl, cd, cm, kind));
}
