"""What Python allocates for results is what C writes, no more and no less: every output of every call, between poisoned guards, in a
scene whose counts all differ.
"""
import unittest

import guards
import numpy
import spar
from spar import _table

STIFFNESS, MASS = numpy.diag([1e6, 1e6, 1e6, 1e3, 1e3, 1e3]), numpy.diag([1, 1, 1, 2e-3, 1e-3, 1e-3])


def beam(session, name, elements, nodes, describe=None):
    """A clamped beam of 1 m along x."""
    made = session.beam_create(name, elements, nodes)
    made.set_axis([0, 1], [[0, 0, 0], [1, 0, 0]])
    made.set_sections([0], [STIFFNESS], [MASS])
    if describe:
        describe(made)
    made.commit()
    return made


def line(n, y=0.1):
    """n points beside the beams."""
    return [[x, y, 0] for x in numpy.linspace(0.05, 0.95, n)]


class Scene:
    """Members of 1, 8, 10 and 15 nodes; fluids of 2 and 40, 9 and 13, 11 nodes; lists of 7, 6, 5, 4 and 2 entries."""

    def __init__(self):
        self.session = s = spar.Session()
        s.set_tolerance(1e-3, 1e-3)
        s.set_coupling(spar.COUPLING_IQN_ILS, 1e-12, 1e-10, 30)

        def lists(one):
            one.set_masses(numpy.linspace(0, 1, 7), [1e-3 * numpy.eye(6)] * 7)
            one.set_foundation(numpy.linspace(0, 1, 6), numpy.ones((6, 3)))
            one.set_pretension(numpy.linspace(0, 1, 5), numpy.zeros((5, 6)))
            one.set_added_mass(numpy.linspace(0, 1, 4), [1e-3 * numpy.eye(6)] * 4)
            one.set_effects(spar.EFFECT_WORK, 0)

        self.rich = beam(s, 'rich', 3, 5, lists)
        self.wet = beam(s, 'wet', 2, 4, lambda one: (one.learn_added_mass([0, 1]), one.set_effects(spar.EFFECT_FLUID_HISTORY, 0)))
        self.blade = beam(s, 'blade', 2, 5)
        self.body = s.rigid_create('body', None, None, numpy.eye(6))
        self.body.set_effects(spar.EFFECT_WORK, 0)
        self.body.commit()
        self.joint = s.spring_create('spring', self.body, 0, 63, 100 * numpy.eye(6), 10 * numpy.eye(6))
        self.cloud = self.body.fluid_create('cloud')
        self.cloud.set_motion_nodes(numpy.zeros((2, 3)))
        self.cloud.set_force_nodes(numpy.zeros((40, 3)))
        self.cloud.map()
        self.cloud.set_states(3)
        self.skin = self.wet.fluid_create('skin')
        self.skin.set_motion_nodes(line(9))
        self.skin.set_force_nodes(line(13))
        self.skin.map()
        self.air = self.blade.fluid_create('air')
        self.air.set_stations(numpy.linspace(0, 1, 11))
        self.air.map()
        self.polar = spar.Polar([-3, 0, 3], [-1, 0, 1], [0.1, 0.01, 0.1])
        self.aero = spar.Aero([self.air])
        for i in range(11):
            self.aero.set_section(i, 0.1, 0.05, self.polar)
        self.aero.set_rotor([0, 0, 0], [0, 0, 1], 0.0, 1.0)
        self.aero.set_effects(spar.AERO_DRAG)
        self.trial = s.trial_create()
        self.trial.set_steps(1e-3, 8)
        self.trial.set_motion(2, 0, 0)
        self.trial.set_callbacks(None, self.solve)

    def solve(self, *_):
        """A fluid that resists."""
        velocity = self.skin.pull_motion(1.0, x=None)
        self.skin.push_forces(-0.1 * numpy.resize(velocity, (13, 3)) + 1e-3)
        self.aero.solve(1.2, numpy.full((1, 11, 3), 1e-2), 1.0)

    def advised(self):
        """The trial after its search."""
        self.session.step(1e-3, self.solve)
        self.trial.advise(0.2, 8e-3)
        return self.trial

    def reported(self):
        """The trial after its report."""
        self.trial.report_effects()
        return self.trial


def within(scene, what):
    """In a step that is solved."""
    scene.session.step(1e-3, scene.solve)
    scene.session.step_begin(1e-3)
    scene.session.step_solve()
    scene.solve()
    return what()


def still(_scene, what):
    """Of a wing of 4 nodes in a fluid, beside one of 8 in none: its trial's answer."""
    with spar.Session() as s:
        wet, _ = beam(s, 'wet', 1, 4), beam(s, 'dry', 2, 4)
        air = wet.fluid_create('air')
        air.set_motion_nodes(line(3))
        air.set_force_nodes(line(3))
        air.map()
        trial = s.trial_create()
        trial.set_steps(1e-2, 8)
        trial.set_motion(2, 0, 0)
        trial.set_callbacks(None, lambda *_: air.push_forces(-0.1 * air.pull_motion(1.0, x=None)))
        s.step(1e-2)
        return what(trial)


def stepped(scene, what):
    """After a step."""
    scene.session.step(1e-3, scene.solve)
    return what()


def adaptive(scene, what):
    """After a step whose error is known."""
    scene.session.step_adaptive(1e-4, None, scene.solve)
    scene.session.step_adaptive(1e-4, None, scene.solve)
    return what()


def restationed(scene, what):
    """A rotor whose fluid has other stations since."""
    scene.session.step(1e-3, scene.solve)
    scene.air.set_stations([0.2, 0.5])
    scene.air.map()
    return what()


def laid(which, node, component, what):
    """With a layout of the wetted surface."""
    def run(scene):
        scene.session.step(1e-3, scene.solve)
        scene.skin.set_layout(which, node, component)
        return what(scene.skin)
    return run


# By the name in C: what succeeds, and writes all that it can.
CALLS = {
    'spar_step_check': lambda k: within(k, k.session.step_check),
    'spar_fluid_pull_motion': [lambda k: k.cloud.pull_motion(1.0), lambda k: k.air.pull_motion(1.0),
                               laid(0, 1, 9, lambda f: f.pull_motion(1.0)), laid(0, 8, 2, lambda f: f.pull_motion(1.0))],
    'spar_step': lambda k: k.session.step(1e-3, k.solve),
    'spar_session_get_gravity': lambda k: k.session.get_gravity(),
    'spar_session_get_coupling': lambda k: k.session.get_coupling(),
    'spar_session_get_time': lambda k: k.session.get_time(),
    'spar_member_get_count': lambda k: k.rich.get_count(),
    'spar_member_get_reference': [lambda k: k.rich.get_reference(), lambda k: k.body.get_reference()],
    'spar_member_get_motion': [lambda k: k.rich.get_motion(), lambda k: k.body.get_motion()],
    'spar_member_get_loads': lambda k: k.wet.get_loads(),
    'spar_fluid_pull_poses': [lambda k: k.cloud.pull_poses(0, 1.0), lambda k: k.cloud.pull_poses(1, 1.0),
                              laid(1, 1, 13, lambda f: f.pull_poses(1, 1.0)), laid(0, 7, 2, lambda f: f.pull_poses(0, 0.5))],
    'spar_section_from_shape': lambda _: spar.section_from_shape(spar.SHAPE_BOX, [0.2, 0.1, 0.01, 0.01], 2e11, 0.3, 7850),
    'spar_section_build': lambda _: spar.section_build([1.0] * 6 + [0] * 6 + [1.0, 0, 0, 1, 1]),
    'spar_section_describe': lambda _: spar.section_describe(STIFFNESS, MASS),
    'spar_section_report': lambda _: spar.section_report(STIFFNESS + numpy.eye(6, k=1), MASS),
    'spar_section_transform': lambda _: spar.section_transform(MASS, 0.1, 0.2, 0.3),
    'spar_beam_get_elements': lambda k: k.rich.get_elements(),
    'spar_beam_get_quadrature': lambda k: k.rich.get_quadrature(),
    'spar_beam_get_axis': lambda k: k.rich.get_axis(),
    'spar_beam_get_sections': lambda k: k.rich.get_sections(),
    'spar_beam_get_masses': [lambda k: k.rich.get_masses(), lambda k: k.wet.get_masses()],
    'spar_beam_get_foundation': lambda k: k.rich.get_foundation(),
    'spar_beam_get_pretension': lambda k: k.rich.get_pretension(),
    'spar_beam_get_damping': lambda k: k.rich.get_damping(),
    'spar_beam_get_mass_damping': lambda k: k.rich.get_mass_damping(),
    'spar_beam_get_plane': lambda k: k.rich.get_plane(),
    'spar_member_get_fidelity': lambda k: k.rich.get_fidelity(),
    'spar_member_get_effects': lambda k: k.rich.get_effects(),
    'spar_member_get_placement': lambda k: k.rich.get_placement(),
    'spar_member_get_root': lambda k: k.rich.get_root(),
    'spar_member_get_external': lambda k: k.rich.get_external(),
    'spar_member_get_reaction': lambda k: k.rich.get_reaction(),
    'spar_beam_evaluate': lambda k: k.rich.evaluate([0.1, 0.2, 0.3, 0.4]),
    'spar_member_get_energy': lambda k: k.rich.get_energy(),
    'spar_member_get_work': lambda k: k.rich.get_work(),
    'spar_member_solve_modes': lambda k: k.blade.solve_modes(4),
    'spar_member_solve_eigenvalues': lambda k: k.blade.solve_eigenvalues(4),
    'spar_beam_set_modal_damping': lambda k: k.blade.set_modal_damping([0, 1], [0.01, 0.01]),
    'spar_beam_fit_damping': lambda k: k.blade.fit_damping([0, 1, 2], [0.01, 0.01, 0.02]),
    'spar_joint_get_motion': lambda k: k.joint.get_motion(),
    'spar_joint_get_load': lambda k: k.joint.get_load(),
    'spar_joint_get_energy': lambda k: stepped(k, k.joint.get_energy),
    'spar_session_get_integrator': lambda k: k.session.get_integrator(),
    'spar_session_get_newton': lambda k: k.session.get_newton(),
    'spar_member_get_iterations': lambda k: k.rich.get_iterations(),
    'spar_session_get_predictor': lambda k: k.session.get_predictor(),
    'spar_session_get_relaxation': lambda k: k.session.get_relaxation(),
    'spar_session_get_option': lambda k: k.session.get_option('coupling.norm'),
    'spar_session_get_iterations': [lambda k: k.session.get_iterations(), lambda k: stepped(k, k.session.get_iterations)],
    'spar_session_get_residual': lambda k: stepped(k, k.session.get_residual),
    'spar_session_get_report': lambda k: stepped(k, k.session.get_report),
    'spar_session_get_phase': lambda k: k.session.get_phase(),
    'spar_member_get_added_mass': lambda k: k.rich.get_added_mass(),
    'spar_member_get_added_mass_response': lambda k: k.rich.get_added_mass_response(),
    'spar_session_solve_initial': lambda k: k.session.solve_initial(1e-3, k.solve),
    'spar_session_solve_static': lambda k: k.session.solve_static(1, k.solve),
    'spar_session_get_tolerance': lambda k: k.session.get_tolerance(),
    'spar_session_get_step_control': lambda k: stepped(k, k.session.get_step_control),
    'spar_step_adaptive': lambda k: k.session.step_adaptive(1e-3, None, k.solve),
    'spar_session_get_reproducible': lambda k: k.session.get_reproducible(),
    'spar_session_get_threads': lambda k: k.session.get_threads(),
    'spar_member_get_owner': lambda k: k.rich.get_owner(),
    'spar_session_sum_balance': lambda k: stepped(k, k.session.sum_balance),
    'spar_session_sum': lambda k: k.session.sum(0, [1.0, 2.0]),
    'spar_fluid_get_motion_weights': lambda k: k.skin.get_motion_weights(),
    'spar_fluid_get_layout': lambda k: k.skin.get_layout(0),
    'spar_fluid_get_projection': lambda k: k.skin.get_projection(),
    'spar_fluid_get_interpolation': lambda k: k.skin.get_interpolation(),
    'spar_fluid_get_option': lambda k: k.skin.get_option('theta'),
    'spar_fluid_get_count': lambda k: k.skin.get_count(0),
    'spar_fluid_get_kind': lambda k: k.skin.get_kind(1),
    'spar_fluid_get_flag_count': lambda k: k.skin.get_flag_count(1, 1),
    'spar_fluid_get_map': [lambda k: k.skin.get_map(0), lambda k: k.skin.get_map(1)],
    'spar_fluid_get_nearest': [lambda k: k.skin.get_nearest(0), lambda k: k.skin.get_nearest(1)],
    'spar_fluid_get_basis': [lambda k: k.skin.get_basis(0), lambda k: k.skin.get_basis(1), lambda k: k.cloud.get_basis(1)],
    'spar_fluid_get_travel': lambda k: k.skin.get_travel(),
    'spar_fluid_get_positions': [lambda k: k.skin.get_positions(0), lambda k: k.skin.get_positions(1),
                                 laid(0, 1, 9, lambda f: f.get_positions(0))],
    'spar_fluid_pull_matrices': [lambda k: k.skin.pull_matrices(1.0, 0), laid(0, 1, 9, lambda f: f.pull_matrices(1.0, 0))],
    'spar_fluid_pull_forces': [lambda k: stepped(k, lambda: k.skin.pull_forces(0.5)), laid(1, 4, 1, lambda f: f.pull_forces(1.0))],
    'spar_fluid_get_forces': [lambda k: stepped(k, k.skin.get_forces), laid(1, 4, 1, lambda f: f.get_forces())],
    'spar_fluid_get_states': lambda k: k.cloud.get_states(),
    'spar_fluid_pull_states': lambda k: k.cloud.pull_states(3),
    'spar_fluid_pull_motion_f32': [lambda k: k.skin.pull_motion_f32(1.0), laid(0, 1, 9, lambda f: f.pull_motion_f32(1.0))],
    'spar_fluid_pull_poses_f32': [lambda k: k.skin.pull_poses_f32(0, 1.0), lambda k: k.skin.pull_poses_f32(1, 1.0),
                                  laid(1, 5, 1, lambda f: f.pull_poses_f32(1, 1.0))],
    'spar_fluid_pull_forces_f32': lambda k: stepped(k, lambda: k.skin.pull_forces_f32(1.0)),
    'spar_fluid_get_audit': lambda k: stepped(k, k.skin.get_audit),
    'spar_fluid_sum_loads': lambda k: stepped(k, k.skin.sum_loads),
    'spar_member_estimate_error': lambda k: adaptive(k, k.wet.estimate_error),
    'spar_member_get_learned_added_mass': lambda k: stepped(k, k.wet.get_learned_added_mass),
    'spar_trial_get_steps': lambda k: k.trial.get_steps(),
    'spar_trial_get_errors': lambda k: (k.trial.run(0), k.trial.run(1), k.trial.get_errors()),
    'spar_trial_get_cost': lambda k: (k.trial.run(0), k.trial.get_cost()),
    'spar_trial_get_effect': lambda k: k.reported().get_effect(spar.ROW_PREDICTOR),
    'spar_trial_get_goals': lambda k: k.trial.get_goals(),
    'spar_trial_get_option': lambda k: k.trial.get_option('limit'),
    'spar_trial_get_settings': lambda k: k.advised().get_settings(),
    'spar_trial_get_beam': lambda k: k.advised().get_beam(k.wet),
    'spar_trial_get_outcome': lambda k: k.advised().get_outcome(),
    'spar_trial_get_search': lambda k: k.advised().get_search(),
    'spar_trial_apply': lambda k: k.advised().apply(),
    'spar_trial_get_motion': lambda k: k.trial.get_motion(),
    'spar_trial_solve_eigenvalues': lambda k: still(k, lambda trial: trial.solve_eigenvalues(2)),
    'spar_trial_solve_floquet': lambda k: still(k, lambda trial: trial.solve_floquet(2)),
    'spar_polar_evaluate': lambda k: k.polar.evaluate(0.1),
    'spar_aero_get_polar': lambda k: k.aero.get_polar(1),
    'spar_aero_get_chord': [lambda k: k.aero.get_chord(), lambda k: restationed(k, k.aero.get_chord)],
    'spar_aero_get_rotor': lambda k: stepped(k, k.aero.get_rotor),
    'spar_aero_get_sections': [lambda k: stepped(k, k.aero.get_sections), lambda k: restationed(k, k.aero.get_sections)],
    'spar_aero_get_flags': [lambda k: stepped(k, k.aero.get_flags), lambda k: restationed(k, k.aero.get_flags)],
    'spar_aero_get_loads': [lambda k: stepped(k, k.aero.get_loads), lambda k: restationed(k, k.aero.get_loads)],
    'spar_aero_get_effect': lambda k: (k.aero.report_effects(k.trial), k.aero.get_effect(spar.AERO_ROW_DRAG)),
}


class Sizes(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        guards.install()

    def test_every_output(self):
        """Each call of the table has its guards untouched and its arrays full; no call with results is missing."""
        for name, runs in CALLS.items():
            for number, run in enumerate(runs if isinstance(runs, list) else [runs]):
                with self.subTest(name, number=number):
                    scene = Scene()
                    self.assertEqual(guards.check(False), '')
                    run(scene)
                    self.assertEqual(guards.check(True), '')
                    scene.session.close()
        outputs = {call.name for call in spar._calls.values()  # pylint: disable=protected-access
                   if any(p.result and p.type not in _table.CLASSES for p in call.parameters)}
        self.assertEqual(outputs - set(CALLS), set())

    def test_guards(self):
        """The guards find what is written beyond an array, beside its strides and beyond a number, and what is left out."""
        array = spar._room([2, 3], numpy.dtype(float))  # pylint: disable=protected-access
        array[...] = 0
        self.assertEqual(guards.check(True), '')
        array = spar._room([2, 3], numpy.dtype(float))  # pylint: disable=protected-access
        array[0] = 0
        self.assertIn('leaves out 3', guards.check(True))
        array = spar._room([2, 3], numpy.dtype(float))  # pylint: disable=protected-access
        numpy.ctypeslib.as_array((guards.ctypes.c_double * 7).from_address(array.ctypes.data))[6] = 0
        self.assertIn('beyond an array', guards.check(False))
        array = spar._room([2, 3], numpy.dtype(float), (40, 8))  # pylint: disable=protected-access
        numpy.ctypeslib.as_array((guards.ctypes.c_double * 7).from_address(array.ctypes.data))[3] = 0
        self.assertIn('beyond an array', guards.check(False))
        number, _ = spar._number(guards.ctypes.c_int, 0)  # pylint: disable=protected-access
        guards.ctypes.c_int64.from_address(guards.ctypes.addressof(number)).value = 0
        self.assertIn('beyond a number', guards.check(False))

    def test_lists(self):
        """Lists come whole: 2500 masses (they were cut at 1000), and the rows of all stations alone."""
        with spar.Session() as s:
            eta, forces = numpy.linspace(0, 1, 2500), numpy.arange(15000.0).reshape(2500, 6)

            def long(one):
                one.set_masses(eta, [1e-6 * numpy.eye(6)] * 2500)
                one.set_pretension(eta, forces)

            one = beam(s, 'long', 1, 4, long)
            self.assertEqual([len(a) for a in one.get_masses()[1:]], [2500, 2500])
            numpy.testing.assert_array_equal(one.get_pretension()[2], forces)
            n, first, again = one.get_pretension(eta=numpy.zeros(3), force=numpy.zeros((3, 6)))
            self.assertEqual((n, len(first), again[2, 5]), (2500, 3, 17))


if __name__ == '__main__':
    unittest.main()
