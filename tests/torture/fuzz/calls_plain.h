/* The calls of calls_plain.c, as FUZZ_CALLS has those by hand. Written by cmake/make-bindings.sh from the headers. */
/* clang-format off */
#define FUZZ_PLAIN_CALLS(CALL) \
    CALL(spar_session_get_gravity, 30, FUZZ_PURE) \
    CALL(spar_session_get_coupling, 30, FUZZ_PURE) \
    CALL(spar_session_get_time, 30, FUZZ_PURE) \
    CALL(spar_section_from_shape, 30, FUZZ_CHANGES) \
    CALL(spar_section_build, 30, FUZZ_CHANGES) \
    CALL(spar_section_describe, 30, FUZZ_CHANGES) \
    CALL(spar_section_transform, 30, FUZZ_CHANGES) \
    CALL(spar_beam_get_axis, 30, FUZZ_PURE) \
    CALL(spar_beam_get_sections, 30, FUZZ_PURE) \
    CALL(spar_session_get_integrator, 30, FUZZ_PURE) \
    CALL(spar_session_get_newton, 30, FUZZ_PURE) \
    CALL(spar_session_get_predictor, 30, FUZZ_PURE) \
    CALL(spar_session_get_relaxation, 30, FUZZ_PURE) \
    CALL(spar_session_get_residual, 30, FUZZ_PURE) \
    CALL(spar_session_get_tolerance, 30, FUZZ_PURE) \
    CALL(spar_session_get_reproducible, 30, FUZZ_PURE) \
    CALL(spar_session_get_threads, 30, FUZZ_PURE) \
    CALL(spar_fluid_map_current, 30, FUZZ_CHANGES) \
    CALL(spar_aero_get_polar, 30, FUZZ_PURE)
