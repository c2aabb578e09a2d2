"""The package spar that Python finds, against closed forms, and what it promises of arguments, results and failures.
    test_python.py <folder to write in>
"""
import ast
import copy
import gc
import inspect
import os
import pickle
import shutil
import subprocess
import sys
import threading
import unittest

import numpy
import spar

UNIT = [1, 0, 0, 0]
WORK = sys.argv.pop() if len(sys.argv) > 1 else '.'


def body(session, mass=2.0):
    """A rigid body at the origin with one fluid node in its middle."""
    member = session.rigid_create('body', [0, 0, 0], UNIT, numpy.eye(6) * mass)
    member.commit()
    fluid = member.fluid_create('fluid')
    fluid.set_motion_nodes([[0, 0, 0]])
    fluid.set_force_nodes([[0, 0, 0]])
    fluid.map()
    return member, fluid


def cantilever(session, stiffness=1e3, length=2.0):
    """A straight clamped beam along x."""
    beam = session.beam_create('beam', 1, 6)
    beam.set_axis([0, 1], [[0, 0, 0], [length, 0, 0]])
    beam.set_sections([0], [numpy.diag([1e9, 1e9, 1e9, stiffness, stiffness, stiffness])], [numpy.eye(6)])
    beam.set_root(spar.ROOT_FIXED)
    beam.commit()
    return beam


class Values(unittest.TestCase):
    def test_fall(self):
        """Constant acceleration is exact for the integrator: -g t^2 / 2."""
        with spar.Session() as s:
            s.set_gravity([0, 0, -9.81])
            member, _ = body(s)
            for _ in range(10):
                self.assertEqual(s.step(0.1), 1)  # iterations
            q, v, a = member.get_motion()
            self.assertAlmostEqual(q[0, 2], -4.905, delta=1e-12)
            self.assertAlmostEqual(v[0, 2], -9.81, delta=1e-12)
            self.assertAlmostEqual(a[0, 2], -9.81, delta=1e-11)
            self.assertEqual((q.shape, v.shape, a.shape), ((1, 7), (1, 6), (1, 6)))
            t, step, iteration = s.get_time()
            self.assertAlmostEqual(t, 1, delta=1e-14)
            self.assertEqual((step, iteration), (10, 1))

    def test_tip_load(self):
        """Small load P at the tip: P L^3 / 3 EI, to (P L^2 / EI)^2 and the shear's 3 EI / (L^2 GA)."""
        with spar.Session() as s:
            beam = cantilever(s)
            nodes = beam.get_count()
            beam.set_load(nodes - 1, spar.LOAD_DEAD, [0, 0, 1e-3, 0, 0, 0])
            beam.solve_static(1)
            q = beam.get_motion(v=None, a=None)
            self.assertAlmostEqual(q[-1, 2], 1e-3 * 8 / 3e3, delta=1e-3 * 8 / 3e3 * 2e-6)
            numpy.testing.assert_allclose(beam.get_reaction(), [0, 0, -1e-3, 0, 2e-3, 0], atol=1e-9)  # GA = 1e9 N
            strain, force, x, _ = beam.evaluate([0.25, 0.5])
            self.assertEqual((strain.shape, x.shape), ((2, 6), (2, 3)))
            numpy.testing.assert_allclose(x[:, 0], [0.5, 1.0], atol=1e-9)
            self.assertAlmostEqual(abs(force[1, 4]), 1e-3, delta=1e-6)  # bending at half the length

    def test_modes(self):
        """First bending of a clamped beam: (1.8751)^2 sqrt(EI / rho A L^4) / 2 pi, within its rotary inertia's part."""
        with spar.Session() as s:
            beam = cantilever(s, stiffness=1e3, length=20.0)
            frequency, shapes = beam.solve_modes(3)
            expected = 1.87510407**2 * numpy.sqrt(1e3 / 20.0**4) / (2 * numpy.pi)
            self.assertAlmostEqual(frequency[0], expected, delta=0.01 * expected)
            self.assertEqual(shapes.shape, (3, 6, 6))

    def test_eigenvalues(self):
        """The same beam's growth rates and angular frequencies: nothing grows, and the frequencies are those of its modes."""
        with spar.Session() as s:
            beam = cantilever(s, stiffness=1e3, length=20.0)
            frequency, _ = beam.solve_modes(3)
            eigenvalue, shapes, frame = beam.solve_eigenvalues(3)
            self.assertLess(abs(eigenvalue[:, 0]).max(), 1e-9)
            self.assertLess(abs(eigenvalue[:, 1] - 2 * numpy.pi * frequency).max(), 1e-6 * frequency[2])
            self.assertEqual(shapes.shape, (3, 6, 6, 2))
            self.assertEqual(frame.tolist(), [0, 0, 0])

    def test_coupled(self):
        """A spring that is the fluid: x'' = -(k / m) x from x = 0, v = 1; order 2, so sin(w t) / w to 2e-5 at this dt."""
        with spar.Session() as s:
            s.set_coupling(spar.COUPLING_IQN_ILS, 1e-12, 1e-10, 30)
            member, fluid = body(s)
            member.set_initial_velocity([0, 0, 0], [1, 0, 0], [0, 0, 0])
            seen = []

            def spring(session, t, dt, iteration):
                self.assertIs(session, s)
                seen.append((t, dt, iteration))
                x, _ = fluid.pull_motion(1.0)
                fluid.push_forces(-8.0 * x)

            for _ in range(100):
                s.step(0.005, spring)
            self.assertAlmostEqual(member.get_motion()[0][0, 0], numpy.sin(1.0) / 2, delta=2e-5)
            self.assertEqual(seen[0], (0.0, 0.005, 0))
            iterations, residual, size = s.get_iterations()
            self.assertTrue(1 <= iterations <= 30 and residual[iterations - 1] < 1e-9 * size[iterations - 1] + 1e-12)
            self.assertEqual(s.get_report().shape, (spar.REPORT_COUNT,))

    def test_loop_and_joint(self):
        """A body on a spring to the ground, by hand: at rest under a load F at F / k."""
        with spar.Session() as s:
            stiffness, damping = numpy.zeros((6, 6)), numpy.zeros((6, 6))
            stiffness[1, 1], damping[1, 1] = 50.0, 20.0  # critical for 2 kg
            member, fluid = body(s)
            joint = s.spring_create('spring', member, 0, spar.FREE_Y, stiffness, damping)
            for _ in range(200):
                s.step_begin(0.02)
                done = False
                while not done:
                    s.step_solve()
                    fluid.push_forces([[3.0, 5.0, 7.0]])
                    done = s.step_check()
                s.step_accept()
            self.assertAlmostEqual(member.get_motion()[0][0, 1], 0.1, delta=1e-8)
            numpy.testing.assert_allclose(joint.get_load(), [-3, -5, -7, 0, 0, 0], atol=1e-5)
            force, moment = fluid.sum_loads([0, 0, 1.0])
            numpy.testing.assert_allclose(force, [3, 5, 7], atol=1e-12)
            numpy.testing.assert_allclose(moment, [0.1 * 7 + 1.0 * 5, -1.0 * 3, -0.1 * 3], atol=1e-6)

    def test_polar(self):
        """A straight line between two rows."""
        polar = spar.Polar([-0.5, 0.5], [-1, 3], [0.1, 0.3])
        cl, cd, cm = polar.evaluate(0.0)
        self.assertAlmostEqual(cl, 1, delta=1e-15)
        self.assertAlmostEqual(cd, 0.2, delta=1e-15)
        self.assertEqual(cm, 0)

    def test_aero(self):
        """Lift in an even wind, without induction, of sections at both ends: q c cl L."""
        with spar.Session() as s:
            blade = s.beam_create('blade', 1, 4)
            blade.set_axis([0, 1], [[0, 0, 0], [10.0, 0, 0]])
            blade.set_sections([0], [numpy.eye(6) * 1e6], [numpy.eye(6)])
            blade.set_root(spar.ROOT_FIXED)
            blade.commit()
            sections = blade.fluid_create('sections')
            sections.set_stations([0, 1])
            sections.map()
            aero = spar.Aero([sections])
            polar = spar.Polar([-3, 3], [1.2, 1.2], [0, 0])
            for i in range(2):
                aero.set_section(i, 0.5, 0.0, polar)
            aero.set_effects(0)
            wind = numpy.zeros((1, 2, 3))
            wind[..., 1] = 10.0
            aero.solve(1.2, wind, 1.0)
            _, force, _ = aero.get_loads()
            self.assertEqual(force.shape, (1, 2, 3))
            self.assertAlmostEqual(abs(force[0, :, 2].sum()), 0.5 * 1.2 * 100 * 0.5 * 1.2 * 10.0, delta=1e-9)
            alpha = aero.get_sections()[0]
            self.assertEqual(alpha.shape, (1, 2))
            aero.close()

    def test_sections(self):
        """A steel bar 0.2 x 0.1: E A, E b h^3/12; a mass centre off the line couples, and is found again."""
        p = spar.section_from_shape(spar.SHAPE_RECTANGLE, [0.2, 0.1], 210e9, 0.3, 7850)
        self.assertAlmostEqual(p[spar.SECTION_EA] / (210e9 * 0.02), 1, delta=1e-12)
        self.assertAlmostEqual(p[spar.SECTION_EI_Y] / (210e9 * 0.2 * 0.1**3 / 12), 1, delta=1e-12)
        p[spar.SECTION_MASS_Y] = 0.01
        stiffness, mass = spar.section_build(p)
        self.assertAlmostEqual(mass[5], -7850 * 0.02 * 0.01, delta=1e-12)
        again, findings = spar.section_describe(stiffness, mass)
        self.assertEqual(findings, 0)
        self.assertTrue(numpy.allclose(again, p, rtol=1e-10, atol=1e-10))
        self.assertEqual(spar.section_report(stiffness, mass), '')
        self.assertAlmostEqual(spar.section_transform(mass, 0.01, 0, 0)[5], 0, delta=1e-12)
        stiffness[1] = 1e9
        self.assertIn('is not symmetric', spar.section_report(stiffness.reshape(6, 6)))
        p[spar.SECTION_GA_Y] = 0
        with self.assertRaisesRegex(spar.Error, 'SPAR_SECTION_GA_Y is 0'):
            spar.section_build(p)

    def test_save(self):
        """A run that goes on from a file ends with the same bits."""
        ends = []
        for saved in (False, True):
            with spar.Session() as s:
                beam = cantilever(s)
                beam.set_load(5, spar.LOAD_DEAD, [0, 0, 10, 0, 0, 0])
                path = os.path.join(WORK, 'python.spar')
                if saved:
                    s.load(path)
                else:
                    for _ in range(5):
                        s.step(0.01)
                    s.save(path)
                for _ in range(5):
                    s.step(0.01)
                ends.append(beam.get_motion())
        for first, second in zip(*ends):
            self.assertTrue((first == second).all())


class Edges(unittest.TestCase):
    def test_failures(self):
        with spar.Session() as s:
            with self.assertRaises(spar.Error) as caught:
                s.set_integrator(2.0, 1)
            self.assertEqual(caught.exception.status, spar.ERR_ARGUMENT)
            self.assertIn('rho_inf', str(caught.exception))
            with self.assertRaises(spar.Error) as caught:
                s.step_solve()
            self.assertEqual(caught.exception.status, spar.ERR_STATE)
        with self.assertRaises(spar.Error):
            spar.Polar([1, 0], [0, 0], [0, 0])

    def test_shapes(self):
        with spar.Session() as s:
            _, fluid = body(s)
            with self.assertRaisesRegex(ValueError, r'force has the shape \(2, 3\); it must be force\[force_nodes\]\[3\]'):
                fluid.push_forces(numpy.zeros((2, 3)))
            with self.assertRaises(ValueError):
                s.set_gravity([0, 0])
            with self.assertRaisesRegex(spar.Error, 'NULL'):
                s.set_gravity()
            with self.assertRaises(TypeError):
                s.set_integrator(0.9)
            with self.assertRaises(TypeError):
                s.set_integrator(0.9, 1, 1)
            with self.assertRaises(TypeError):
                s.set_integrator(0.9, steps=1)
            with self.assertRaises(AttributeError):
                s.set_nothing()

    def test_in_place(self):
        with spar.Session() as s:
            _, fluid = body(s)
            x = numpy.full((1, 3), 9.0)
            self.assertIs(fluid.pull_motion(1.0, x=x, v=None), x)
            numpy.testing.assert_array_equal(x, numpy.zeros((1, 3)))
            with self.assertRaises(TypeError):
                fluid.pull_motion(1.0, x=numpy.zeros((1, 3), dtype=int))
            single = fluid.pull_motion_f32(1.0, v=None)
            self.assertEqual(single.dtype, numpy.float32)

    def test_raise_through(self):
        """What a fluid solver raises ends the step and is raised again; the session goes on."""
        with spar.Session() as s:
            member, _ = body(s)

            def broken(*_):
                raise KeyError('flow')

            with self.assertRaises(KeyError):
                s.step(0.1, broken)
            s.step(0.1)
            self.assertEqual(s.get_time()[1], 1)
            self.assertEqual(member.get_name(), 'body')

    def test_log(self):
        told = []
        with spar.Session() as s:
            s.set_log(lambda level, text: told.append((level, text)))
            gc.collect()
            with self.assertRaises(spar.Error):
                s.step(-1.0)
        self.assertEqual(told[0][0], spar.LOG_ERROR)
        self.assertIn('dt', told[0][1])

    def test_trial(self):
        """A run against itself has no error; each callback is called; what one raises ends the run and is raised again."""
        with spar.Session() as s:
            member, fluid = body(s)
            trial = s.trial_create()
            seen = []

            def before(session, t, dt):
                self.assertIs(session, s)
                seen.append((t, dt))

            def solve(_session, _t, _dt, iteration):
                fluid.push_forces([[0, 0, 1.0 + 0 * iteration]])

            trial.set_steps(0.1, 8)
            self.assertEqual(trial.get_steps(), (0.1, 8))
            trial.set_callbacks(before, solve)
            gc.collect()
            trial.run(0)
            self.assertEqual(len(seen), 8)
            trial.run(1)
            self.assertEqual(trial.get_errors(), (0, 0, 0))
            self.assertGreaterEqual(trial.get_cost()[1], 8)
            trial.report_effects()
            self.assertEqual(trial.get_effect(spar.ROW_GRAVITY)[0], 0)
            trial.set_option('limit', '7')
            self.assertEqual(trial.get_option('limit'), '7')
            with self.assertRaises(spar.Error) as refused:
                trial.get_beam(member)
            self.assertEqual(refused.exception.status, spar.ERR_STATE)

            def broken(*_):
                with self.assertRaises(spar.Error) as fixed:
                    trial.set_callbacks(None, None)
                self.assertIn('the trial is running', str(fixed.exception))
                raise KeyError('flow')

            trial.set_callbacks(None, broken)
            gc.collect()
            with self.assertRaises(KeyError):
                trial.run(0)
            trial.set_callbacks(before, solve)
            trial.run(0)
            trial.close()
            with self.assertRaises(spar.Error):
                trial.run(0)
            self.assertEqual(s.get_time()[1], 0)

    def test_session_progress(self):
        """Told of each iteration; an answer and a fault end the call, and the step is not made."""
        told = []
        with spar.Session() as s:
            beam = s.beam_create('beam', 1, 4)
            beam.set_axis([0, 1], [[0, 0, 0], [1, 0, 0]])
            beam.set_sections([0], [numpy.diag([1e4, 1e4, 1e4, 100, 100, 100])], [numpy.diag([1, 1, 1, 0.02, 0.01, 0.01])])
            beam.commit()
            beam.set_load(3, spar.LOAD_DEAD, [0, 0, 30, 0, 0, 0])
            s.set_progress(lambda done, expected: told.append((done, expected)))
            gc.collect()
            s.step(0.1)
            self.assertEqual(told[0], (0, 100000))
            self.assertEqual(len(told), beam.get_iterations()[0])
            before = beam.get_motion()[0]
            s.set_progress(lambda done, expected: 4 if done else 0)
            with self.assertRaisesRegex(spar.UserError, r'cancelled by the progress callback \(4\) after 1 Newton'):
                s.step(0.1)
            self.assertTrue((beam.get_motion()[0] == before).all())

            def broken(*_):
                s.get_gravity()

            s.set_progress(broken)
            with self.assertRaisesRegex(spar.StateError, 'a progress and a __del__ must not call it'):
                s.step(0.1)
            s.set_progress(None)
            s.set_option('newton.budget', '1')
            with self.assertRaisesRegex(spar.LimitError, 'newton.budget'):
                s.step(0.1)
            self.assertTrue((beam.get_motion()[0] == before).all())

    def test_progress(self):
        """Told ahead of each run; an answer and a fault end the call."""
        told = []
        with spar.Session() as s:
            body(s)
            trial = s.trial_create()
            trial.set_steps(0.1, 8)
            trial.set_progress(lambda done, expected: told.append((done, expected)))
            gc.collect()
            trial.report_effects()
            heard = len(told)
            self.assertEqual(told[0][0], 0)
            self.assertEqual(told, sorted(told, key=lambda one: one[0]))
            self.assertTrue(all(expected > done for done, expected in told))
            trial.set_progress(lambda done, expected: 4)
            with self.assertRaises(spar.Error) as refused:
                trial.report_effects()
            self.assertEqual(refused.exception.status, spar.ERR_USER)
            self.assertIn('cancelled by the progress callback (4)', str(refused.exception))

            def broken(*_):
                raise KeyError('enough')

            trial.set_progress(broken)
            with self.assertRaises(KeyError):
                trial.report_effects()
            trial.set_progress(None)
            trial.report_effects()
            self.assertEqual(len(told), heard)

    def test_life(self):
        """A member keeps its session; what is closed twice is closed."""
        session = spar.Session()
        member, _ = body(session)
        del session
        gc.collect()
        member.session.step(0.1)
        self.assertIs(member.get_session(), member.session)
        member.session.close()
        member.session.close()

    def test_texts(self):
        self.assertRegex(spar.version(), r'^\d+\.\d+\.\d+$')
        self.assertFalse(spar.has('a wish'))
        self.assertIn('argument', spar.status_text(spar.ERR_ARGUMENT).lower())
        self.assertEqual(spar.effect_name(spar.ROW_GRAVITY), 'gravity')
        with spar.Session() as s:
            s.set_option('coupling.reuse', '7')
            self.assertEqual(s.get_option('coupling.reuse'), '7')


    def test_closed(self):
        """What belonged to a session that is closed is refused, and closing it again does nothing (it ended the process)."""
        s = spar.Session()
        member, fluid = body(s)
        joint = s.joint_create('joint', member, 0, None, 0, 63)
        beam = s.beam_create('blade', 1, 4)
        beam.set_axis([0, 1], [[0, 0, 0], [10.0, 0, 0]])
        beam.set_sections([0], [numpy.eye(6) * 1e6], [numpy.eye(6)])
        beam.commit()
        sections = beam.fluid_create('sections')
        sections.set_stations([0, 1])
        sections.map()
        aero = spar.Aero([sections])
        s.close()
        for call in (member.get_motion, fluid.get_name, joint.get_load, aero.get_rotor, s.get_time,
                     lambda: fluid.pull_motion(1.0)):
            with self.assertRaisesRegex(spar.Error, 'closed'):
                call()
        with spar.Session() as other:
            with self.assertRaisesRegex(spar.Error, 'the session of this member is closed'):
                other.joint_create('joint', member, 0, None, 0, 0)
        for thing in (fluid, aero, s, s):
            thing.close()

    def test_closed_fluid(self):
        with spar.Session() as s:
            _, fluid = body(s)
            fluid.close()
            fluid.close()
            with self.assertRaisesRegex(spar.Error, 'this fluid is closed'):
                fluid.pull_motion(1.0)

    def test_one_owner(self):
        """Copies would free what the first frees."""
        with spar.Session() as s:
            member, fluid = body(s)
            for thing in (s, member, fluid, spar.Polar([-3, 3], [1, 1], [0, 0])):
                for again in (copy.copy, copy.deepcopy, pickle.dumps):
                    with self.assertRaisesRegex(TypeError, 'cannot be copied or pickled'):
                        again(thing)

    def test_arrays(self):
        """Of the header's shape, or flat; what is not is refused: (3, n) was read as (n, 3), complex as real."""
        with spar.Session() as s:
            member, fluid = body(s)
            places = numpy.arange(12.0).reshape(4, 3)
            other = member.fluid_create('other')
            for wrong in (places.T, places.reshape(2, 6), places[None]):
                with self.assertRaisesRegex(ValueError, r'it must be x\[n\]\[3\]'):
                    other.set_motion_nodes(wrong)
            for right in (places, places.ravel(), places.tolist(), numpy.asfortranarray(places)):
                other.set_motion_nodes(right)
                other.map()
                numpy.testing.assert_allclose(other.pull_motion(1.0)[0], places, atol=1e-14)
            for wrong in ([1j, 0, 0], numpy.zeros(3, complex), ['a', 'b', 'c'], [None, 0, 0]):
                with self.assertRaises(TypeError):
                    s.set_gravity(wrong)
            s.set_gravity([0, True, numpy.float32(2)])
            with self.assertRaises(ValueError):
                fluid.pull_motion(1.0, x=numpy.zeros((3, 1)))

    def test_layout(self):
        """Arrays keep the shape (n, 3) in every layout, and mean the same: those of C's order were taken as they lay."""
        with spar.Session() as s:
            member = s.rigid_create('body', [0, 0, 0], UNIT, numpy.eye(6))
            member.set_effects(spar.EFFECT_FLUID_HISTORY, 0)
            member.commit()
            places, force = numpy.arange(12.0).reshape(4, 3) + 1, numpy.arange(12.0).reshape(4, 3)
            fluid = member.fluid_create('laid')
            fluid.set_motion_nodes(places)
            fluid.set_force_nodes(places)
            fluid.map()
            fluid.push_forces(force)
            total = fluid.sum_loads([0, 0, 0])
            for node, component in ((1, 4), (8, 1), (2, 9)):
                for which in (spar.NODES_MOTION, spar.NODES_FORCE):
                    fluid.set_layout(which, node, component)
                for given in (force, numpy.asfortranarray(force), force.tolist(), numpy.repeat(force, 2, axis=0)[::2]):
                    fluid.push_forces(0 * force)
                    fluid.push_forces(given)
                    numpy.testing.assert_allclose(fluid.sum_loads([0, 0, 0]), total, rtol=1e-14)
                x, _ = fluid.pull_motion(1.0)
                numpy.testing.assert_allclose(x, places, rtol=1e-14)
                self.assertEqual(x.strides, (8 * node, 8 * component))
                self.assertIs(fluid.pull_motion(1.0, x=x, v=None), x)
                numpy.testing.assert_allclose(fluid.pull_forces(1.0), force, atol=1e-13)
                q = fluid.pull_poses(spar.NODES_FORCE, 1.0)[1]
                numpy.testing.assert_array_equal(q, [UNIT] * 4)
                with self.assertRaisesRegex(TypeError, 'strides'):
                    fluid.pull_motion(1.0, x=numpy.zeros((4, 3)))
                with self.assertRaisesRegex(ValueError, 'after set_layout'):
                    fluid.push_forces(force.ravel())
            fluid.set_layout(spar.NODES_MOTION, 1, 4)
            columns = numpy.zeros((4, 3), order='F')
            self.assertIs(fluid.pull_motion(1.0, x=columns, v=None), columns)  # without a copy
            numpy.testing.assert_allclose(columns, places, rtol=1e-14)

    def test_single(self):
        """float32 arrays take the calls of single precision; with float64 ones beside them they are refused or converted."""
        with spar.Session() as s:
            _, fluid = body(s)
            fluid.push_forces(numpy.array([[0.1, 0, 0]], dtype=numpy.float32))
            self.assertEqual(fluid.sum_loads([0, 0, 0])[0][0], float(numpy.float32(0.1)))
            x = numpy.full((1, 3), 9, dtype=numpy.float32)
            self.assertIs(fluid.pull_motion(1.0, x=x, v=None), x)
            numpy.testing.assert_array_equal(x, numpy.zeros((1, 3)))
            with self.assertRaises(TypeError):
                fluid.pull_motion(1.0, x=x, v=numpy.zeros((1, 3)))
            x.flags.writeable = False
            with self.assertRaisesRegex(TypeError, 'can be written'):
                fluid.pull_motion(1.0, x=x)

    def test_releases(self):
        """A table of another release than the library's, and one with a call that the library lacks, are refused at the import."""
        for old, new, said in (("VERSION = '", "VERSION = '7.", 'install both from one release'),
                               ('call spar_version text', 'call spar_vision text', 'the library has no spar_vision')):
            folder = os.path.join(WORK, 'releases')
            shutil.rmtree(folder, ignore_errors=True)
            shutil.copytree(os.path.dirname(spar.__file__), os.path.join(folder, 'spar'))
            with open(os.path.join(folder, 'spar', '_interface.py'), 'r+', encoding='utf-8') as file:
                text = file.read().replace(old, new).replace('"spar_version"', '"spar_vision"')
                file.seek(0)
                file.write(text)
                file.truncate()
            library = spar._library._name  # pylint: disable=protected-access
            done = subprocess.run([sys.executable, '-B', '-c', 'import spar'], capture_output=True, text=True, check=False,
                                  env={**os.environ, 'PYTHONPATH': folder, 'SPAR_LIBRARY': library})
            self.assertNotEqual(done.returncode, 0)
            self.assertIn(said, done.stderr)

    def test_errors(self):
        """Each status has its class, which can be sent to another process."""
        with spar.Session() as s:
            with self.assertRaises(spar.ArgumentError) as caught:
                s.set_integrator(2.0, 1)
            again = pickle.loads(pickle.dumps(caught.exception))
            self.assertEqual((type(again), again.status, str(again)), (spar.ArgumentError, 1, str(caught.exception)))
            with self.assertRaises(spar.StateError):
                s.step_solve()
            with self.assertRaises(spar.FileError):
                s.load(os.path.join(WORK, 'no such file'))
        kinds = [kind for kind in vars(spar).values() if inspect.isclass(kind) and issubclass(kind, spar.Error)]
        self.assertEqual(len(kinds), 1 + spar.ERR_LIMIT)

    def test_names(self):
        """A joint's spring and a line's are two calls."""
        with spar.Session() as s:
            member, _ = body(s)
            joint = s.joint_create('joint', member, 0, None, 0, 63)
            joint.set_spring(numpy.eye(6) * 50)
            with self.assertRaisesRegex(spar.Error, 'not a line'):
                joint.link_set_spring(1.0, 0.0, 1.0, 0)
            line = s.link_create('line', member, 0, [0, 0, 0], None, 0, [0, 0, 1])
            line.link_set_spring(10.0, 0.0, 1.0, 1)
            s.step(0.1)

    def test_adaptive(self):
        """A step to a tolerance takes dt and gives it back: the next one, and the one that was taken."""
        with spar.Session() as s:
            s.set_gravity([0, 0, -9.81])
            body(s)
            s.set_tolerance(1.0, 0.1)
            before = []
            dt, taken = s.step_adaptive(0.25, lambda session, t, h: before.append((t, h)))
            self.assertEqual(before[-1], (0.0, taken))
            self.assertTrue(taken <= 0.25 and dt > 0)
            self.assertEqual(s.get_time()[0], taken)


class Hostile(unittest.TestCase):
    """What a caller may do wrong ends in a refusal that names the argument: these were crashes, cut numbers, or lost words."""

    def test_states(self):
        """States are by force node: 2 motion nodes and 40 force nodes have 40 rows (2 rows were allocated, and 40 written)."""
        with spar.Session() as s:
            member, _ = body(s)
            fluid = member.fluid_create('other')
            fluid.set_motion_nodes(numpy.zeros((2, 3)))
            fluid.set_force_nodes(numpy.zeros((40, 3)))
            fluid.map()
            fluid.set_states(2)
            states = numpy.arange(80.0).reshape(40, 2)
            fluid.push_states(states)
            numpy.testing.assert_array_equal(fluid.pull_states(2), states)

    def test_wrong_kind(self):
        """A handle of another kind, or none, never reaches C."""
        with spar.Session() as s:
            member, fluid = body(s)
            polar, trial = spar.Polar([-1, 1], [0, 0], [0, 0]), s.trial_create()
            joint = s.joint_create('joint', member, 0, None, 0, 63)
            for wrong in (fluid, s, polar, trial, joint, 5, 'body', None):
                with self.assertRaisesRegex(TypeError, 'spar_joint_create: a is .*; it must be a Member'):
                    s.joint_create('k', wrong, 0, None, 0, 63)
            with self.assertRaisesRegex(TypeError, 'b is of the type Trial'):
                s.joint_create('k', member, 0, trial, 0, 63)
            with self.assertRaisesRegex(TypeError, 'sections is of the type Member'):
                spar.Aero([member])
            with self.assertRaisesRegex(TypeError, 'member is of the type Fluid'):
                trial.get_beam(fluid)
            with self.assertRaisesRegex(TypeError, 'solve is of the type int'):
                s.step(0.1, 3)
            with self.assertRaisesRegex(spar.Error, 'goes with its session'):
                member.close()
            with spar.Session() as other, self.assertRaisesRegex(spar.ArgumentError, 'different sessions'):
                s.joint_create('k', body(other)[0], 0, None, 0, 63)

    def test_numbers(self):
        """Integers that C cannot hold, numbers of other types, and the names of their arguments."""
        with spar.Session() as s:
            member, fluid = body(s)
            for number in (2**31, 2**32 + 1, -2**31 - 1):
                with self.assertRaisesRegex(spar.ArgumentError, f'order is {number}'):
                    s.set_predictor(number)
            with self.assertRaisesRegex(spar.ArgumentError, f'node is {2**64}'):
                member.set_load(2**64, 0, [1.0] * 6)
            with self.assertRaisesRegex(TypeError, 'order is of the type float; it must be an integer'):
                s.set_predictor(1.0)
            with self.assertRaisesRegex(TypeError, 'omega is of the type str; it must be a number'):
                s.set_relaxation('1')
            s.set_predictor(numpy.int64(2))
            self.assertEqual(s.get_predictor(), 2)
            with self.assertRaisesRegex(spar.ArgumentError, 'held has numbers beyond'):
                fluid.fade_motion(0.1, 0.5, None, [2**32])
            with self.assertRaisesRegex(TypeError, 'g is masked'):
                s.set_gravity(numpy.ma.array([1.0, 2.0, 3.0], mask=[0, 1, 0]))
            with self.assertRaisesRegex(spar.OutOfMemoryError, 'frequency_hz'):
                member.solve_modes(2**62)
            with self.assertRaises(spar.ArgumentError):
                member.solve_modes(-1)
            for name in ('capacity', 'n', 'session', 'context'):  # not the caller's to choose
                with self.assertRaisesRegex(TypeError, f'no argument {name}'):
                    s.get_report(**{name: 100000})
            with self.assertRaisesRegex(TypeError, 'None leaves it out'):
                s.get_time(t=1.0)

    def test_answers(self):
        """A callback answers an integer of C, or nothing: others were cut to 0, which is success."""
        with spar.Session() as s:
            _, fluid = body(s)

            def solve(*_):
                fluid.push_forces([[1.0, 0, 0]])
                return answer

            for answer in (2**32, -2**32, 0.5, 0.0, 'x', '', [], numpy.array([0]), numpy.nan):
                with self.assertRaisesRegex((TypeError, ValueError), 'spar_step: solve answered'):
                    s.step(0.1, solve)
            for answer in (1, -1, True, numpy.True_, numpy.int32(7)):
                with self.assertRaises(spar.UserError):
                    s.step(0.1, solve)
            for answer in (None, 0, False, numpy.False_, numpy.int64(0)):
                s.step(0.1, solve)

    def test_texts(self):
        """A NUL ends no text early; what is no text is refused by name; bytes of a name come back."""
        with spar.Session() as s:
            with self.assertRaisesRegex(ValueError, 'name contains a NUL'):
                s.rigid_create('bo\0dy', None, None, numpy.eye(6))
            with self.assertRaisesRegex(TypeError, 'name is of the type int'):
                s.rigid_create(7, None, None, numpy.eye(6))
            member = s.rigid_create(b'k\xf6rper', None, None, numpy.eye(6))
            self.assertEqual(os.fsencode(member.get_name()), b'k\xf6rper')
            with self.assertRaisesRegex(spar.ArgumentError, 'k.rper'):
                member.set_root(77)

    def test_unaligned(self):
        """Numbers between addresses: copied on the way in, refused where they would be filled; a read-only array is not written."""
        with spar.Session() as s:
            _, fluid = body(s)
            odd = numpy.frombuffer(bytearray(25), numpy.float64, 3, 1).reshape(1, 3)
            self.assertFalse(odd.flags.aligned)
            odd[...] = [[1, 2, 3]]
            fluid.push_forces(odd)
            numpy.testing.assert_array_equal(fluid.sum_loads()[0], [1, 2, 3])
            with self.assertRaisesRegex(TypeError, 'x is filled in place.*aligned'):
                fluid.pull_motion(1.0, x=odd)
            constant = numpy.frombuffer(numpy.array([1.0, 2.0]).tobytes())
            self.assertFalse(constant.flags.writeable)
            numpy.testing.assert_array_equal(s.sum(0, constant), [1, 2])

    def test_fade(self):
        """The distance from the line needs no array: node 0 on it has the weight 1, one beyond it 0."""
        with spar.Session() as s:
            member, _ = body(s)
            fluid = member.fluid_create('mesh')
            fluid.set_motion_nodes([[0.05, 0, 0], [0.9, 0, 0]])
            fluid.map()
            fluid.fade_motion(0.1, 0.5)
            numpy.testing.assert_array_equal(fluid.get_motion_weights(), [1, 0])
            fluid.set_motion_weights()
            numpy.testing.assert_array_equal(fluid.get_motion_weights(), [1, 1])

    def test_messages(self):
        """A constructor's failure has the library's words (it had none)."""
        with spar.Session() as s:
            _, fluid = body(s)
            with self.assertRaisesRegex(spar.ArgumentError, 'spar_aero_create: fluid .fluid. of blade 0'):
                spar.Aero([fluid])

    def test_closed_in_callback(self):
        """A session is not closed in its callbacks, its own trial may be, and a log does not call it."""
        with spar.Session() as s:
            _, fluid = body(s)
            trial = s.trial_create()
            trial.set_steps(0.1, 8)
            for thing, said in ((s, 'a callback of this session is running'), (None, 'log')):
                def solve(*_, thing=thing):
                    if thing:
                        thing.close()
                    fluid.push_forces([[0, 0, 0]])
                if thing:
                    with self.assertRaisesRegex(spar.StateError, said):
                        s.step(0.1, solve)
                    trial.set_callbacks(None, solve)
                    with self.assertRaisesRegex(spar.StateError, said):
                        trial.run(0)
            trial.set_callbacks(None, lambda *_: trial.close())
            trial.run(0)
            with self.assertRaisesRegex(spar.ArgumentError, 'this trial is closed'):
                trial.run(0)
            s.set_log(lambda *_: s.get_gravity())
            with self.assertRaisesRegex(spar.StateError, 'a log, a progress and a __del__ must not call it'):
                s.step(-1.0)
            s.set_log(None)
            s.step(0.1)

    def test_log_raises(self):
        """What a log raises is raised when the call is done, with the failure that it was told of as its context."""
        def log(_level, text):
            raise KeyError(text)

        with spar.Session() as s:
            member = s.rigid_create('body', None, None, 1e-3 * numpy.eye(6))
            s.set_log(log)
            with self.assertRaisesRegex(KeyError, 'root condition 77') as caught:
                member.set_root(77)
            self.assertIsInstance(caught.exception.__context__, spar.ArgumentError)
            s.set_log(None)
            member.commit()
            s.step(0.1)

    def test_raise_in_report(self):
        """A call that goes on without a run raises what its callback has raised (an effect's failure is a result)."""
        with spar.Session() as s:
            _, fluid = body(s)
            s.set_gravity([0, 0, -9.81])
            trial = s.trial_create()
            trial.set_steps(0.1, 8)

            def solve(*_):
                x, _ = fluid.pull_motion(1.0)
                if x[0, 2] == 0:  # without gravity
                    raise KeyError('flow')
                fluid.push_forces(0 * x)

            trial.set_callbacks(None, solve)
            with self.assertRaisesRegex(KeyError, 'flow'):
                trial.report_effects()

    def test_collector(self):
        """Trials that only a collector finds, in another thread and during calls, are left to their session."""
        with spar.Session() as s:
            body(s)
            stop = threading.Event()

            def collect():
                while not stop.is_set():
                    gc.collect(0)

            thread = threading.Thread(target=collect)
            thread.start()
            try:
                for _ in range(300):
                    trial = s.trial_create()
                    trial.set_steps(0.1, 8)
                    trial.set_callbacks(None, lambda *_, me=trial: 0)  # a cycle
                    del trial
            finally:
                stop.set()
                thread.join()
            trial = s.trial_create()
            trial.set_steps(0.1, 8)
            trial.set_callbacks(None, lambda *_, me=trial: 0)
            del trial
            gc.collect()
            self.assertTrue(s.use.left)
            s.get_gravity()
            self.assertFalse(s.use.left)

    def test_log_set_in_trial(self):
        """A log that is set during a trial's run holds from then on; the run told the one before again, whose memory may be gone."""
        told = []
        with spar.Session() as s:
            _, fluid = body(s)
            s.set_log(lambda *_: told.append('first'))
            trial = s.trial_create()
            trial.set_steps(0.1, 8)

            def solve(*_):
                s.set_log(lambda *_: told.append('second'))
                fluid.push_forces([[0, 0, 0]])

            trial.set_callbacks(None, solve)
            trial.run(0)
            gc.collect()
            with self.assertRaises(spar.ArgumentError):
                s.set_predictor(7)
            self.assertEqual(told, ['second'])

    def test_logs_of_threads(self):
        """Two logs that call each other's session, each while the other is in a call, are refused: waiting would never end."""
        sessions, meet, refused = [spar.Session(), spar.Session()], threading.Barrier(2), []

        def run(own, other):
            def log(_level, _text):
                meet.wait()
                try:
                    other.get_gravity()
                except spar.StateError as fault:
                    refused.append(str(fault))
                meet.wait()

            own.set_log(log)
            with self.assertRaises(spar.ArgumentError):
                own.set_predictor(7)

        threads = [threading.Thread(target=run, args=pair, daemon=True) for pair in (sessions, sessions[::-1])]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join(60)
            self.assertFalse(thread.is_alive())
        self.assertEqual(len(refused), 2)
        self.assertIn('a log and a __del__ do not wait', refused[0])
        for session in sessions:
            session.set_log(None)
            session.close()

    def test_threads(self):
        """Calls of one session wait for each other; another thread may call it during a callback."""
        with spar.Session() as s:
            member, fluid = body(s)
            seen = []

            def solve(*_):
                thread = threading.Thread(target=lambda: seen.append(member.get_count()))
                thread.start()
                thread.join()
                fluid.push_forces([[0, 0, 0]])

            s.step(0.1, solve)
            self.assertEqual(set(seen), {1})

            def run():
                for _ in range(50):
                    s.step(0.01)
                    fluid.pull_motion(1.0)

            threads = [threading.Thread(target=run) for _ in range(4)]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
            self.assertEqual(s.get_time()[1], 201)


class Every(unittest.TestCase):
    """Every call of the table is made, with arguments that its parameters' names suggest: it answers or raises spar.Error."""

    MADE_OTHERWISE = ('spar_session_create', 'spar_session_create_fcomm', 'spar_polar_create', 'spar_aero_create')
    VALUES = {'dt': 0.01, 'steps': 8, 'load_steps': 1, 'nodes_per_element': 4, 'elements': 1, 'node': 0, 'theta': 1.0,
              'rho_inf': 0.9, 'substeps': 1, 'atol': 1e-9, 'rtol': 1e-6, 'max_iterations': 40, 'omega': 1.0, 'scheme': 1,
              'order': 1, 'threads': 1, 'on': 0, 'key': 'coupling.reuse', 'value': '4', 'node_a': 0, 'node_b': 0,
              'free_motions': 63, 'rule': 0, 'points': 0, 'alpha': 0.1, 'kind': 0, 'modes': 0, 'rank': 0, 'width': 2,
              'method': 0, 'max_distance': 10.0, 'within': 1.0, 'beyond': 2.0, 'mask': 0, 'stiffness': 10.0, 'time': 1.0,
              'damping': 0.1, 'length': 1.0, 'tension_only': 0, 'drift': 1.0, 'amplitude': 1e-4, 'memory': 0, 'goals': 1,
              'tolerance': 0.1, 'compare': 0, 'density': 1.2, 'chord': 0.5, 'twist': 0.0, 'turn': 1, 'total': 1, 'law': 0,
              'height': 10.0, 'parameter': 0.1, 'hub_radius': 0.5, 'tip_radius': 11.0, 'base_radius': 1.0,
              'top_radius': 1.0, 'alpha_rad': 0.1, 'status': 0, 'which': 0, 'flag': 1, 'convention': 0, 'response': 1,
              'switch_on': 128, 'switch_off': 2,
              'row': 0, 'feature': 'mpi', 'part': 0, 'i': 0, 'n': 1, 'capacity': 4}

    def scene(self, new):
        """Handles of each kind in a session of their own; new: with a beam that is not described yet."""
        s = spar.Session()
        member, fluid = body(s)
        beam = cantilever(s)
        blade = beam.fluid_create('blade')
        blade.set_stations([0, 1])
        blade.map()
        joint = s.joint_create('joint', member, 0, None, 0, 63)
        line = s.link_create('line', member, 0, [0, 0, 0], None, 0, [0, 0, 1])
        point = s.point_create('point', [5, 0, 0], UNIT)
        point.commit()
        trial = s.trial_create()
        trial.set_steps(0.01, 8)
        trial.set_motion(1, 0, 0)
        return {'session': [s], 'trial': [trial], 'member': [beam, member, point, *([s.beam_create('new', 1, 4)] if new else [])],
                'fluid': [fluid, blade, member.fluid_create('bare')], 'joint': [joint, line],
                'polar': [spar.Polar([-3, 3], [1, 1], [0, 0])], 'aero': [spar.Aero([blade])]}

    def argument(self, call, p, scene, owner):  # pylint: disable=too-many-return-statements
        """A value for a parameter, by what it is and is called."""
        if p.how == 'callback':
            return None
        if p.type in scene:
            return scene[p.type][0] if p.name != 'b' else None
        if p.array:
            if p.name == 'stiffness' and p.dims == [36]:
                return numpy.zeros(36)
            count = {'member': 'nodes', 'fluid': 'motion_nodes', 'aero': 'sections'}.get(call.owner)
            n = owner.size(count, {}) if count else None
            n = 2 if n is None or (n == 0 and call.python_name.startswith('set_')) else n
            shape = [d if isinstance(d, int) else {'blades': 1, 'width': 2}.get(d, n) for d in p.dims]
            value = numpy.zeros(shape, int if p.type.startswith('int') else float)
            if p.name in ('eta', 'span'):
                value[...] = numpy.linspace(0, 1, value.size)
            elif p.dims[-1] == 36:
                value[...] = numpy.eye(6).ravel()
            elif p.dims[-1] in (4, 7):
                value[..., -4] = 1
            elif p.name in ('xyz', 'axis', 'up', 'top', 'point_b'):
                value[..., 0] = numpy.linspace(1, 2, n) if value.ndim > 1 else 1
            return value
        if call.owner == 'fluid' and p.name in ('key', 'value'):
            return {'key': 'theta', 'value': 'group'}[p.name]
        if p.name in self.VALUES:
            return self.VALUES[p.name]
        if p.type != 'char':
            return 1
        return os.path.join(WORK, 'every.file') if 'path' in p.name or p.name == 'file' else 'a text'

    def test_all(self):
        answered, tried = set(), set()
        for call in spar._calls.values():  # pylint: disable=protected-access
            if call.name in self.MADE_OTHERWISE or call.name.endswith('_destroy'):
                continue
            for number in range(4):
                scene = self.scene(number == 3)
                try:
                    owners = scene[call.owner] if call.owner else [None]
                    if number >= len(owners) or call.name in answered:
                        continue
                    owner = owners[number]
                    if call.name in ('spar_step_solve', 'spar_step_check', 'spar_step_accept', 'spar_step_reject'):
                        scene['session'][0].step_begin(0.01)
                    if call.name in ('spar_step_check', 'spar_step_accept'):
                        scene['session'][0].step_solve()
                    try:
                        given = {p.name: self.argument(call, p, scene, owner) for p in call.asked}
                        tried.add(call.name)
                        call(owner, **given)
                        answered.add(call.name)
                    except spar.Error as refused:
                        self.assertTrue(0 < refused.status <= spar.ERR_LIMIT and str(refused), call.name)
                finally:
                    scene['session'][0].close()
        every = {name for name in spar._calls if not name.endswith('_destroy')}  # pylint: disable=protected-access
        self.assertEqual(every - tried, set(self.MADE_OTHERWISE))
        self.assertGreaterEqual(len(answered), 160)  # of 196; the others want more of a scene, and say so


class Described(unittest.TestCase):
    """Every call has the header's words, a signature, and a stub of the same arguments."""

    def functions(self):
        """The public calls, with the class that each belongs to, or None."""
        for call in spar._calls.values():  # pylint: disable=protected-access
            if call.public:
                owner = getattr(spar, call.owner.title()) if call.owner else None
                yield call, owner, getattr(owner or spar, call.python_name)

    def test_docstrings(self):
        found = 0
        for call, _, function in self.functions():
            self.assertIn(call.name, function.__doc__)
            self.assertGreater(len(function.__doc__), len(call.name) + 10, call.name)
            self.assertNotIn('NULL', function.__doc__)
            found += 1
        self.assertGreater(found, 200)
        self.assertIn('force[force_nodes][3]: in, N\n', spar.Fluid.push_forces.__doc__)
        self.assertEqual(str(inspect.signature(spar.Fluid.push_forces)), '(self, /, force, moment=None)')
        self.assertEqual(str(inspect.signature(spar.Fluid.pull_motion)), '(self, /, theta, *, x=Ellipsis, v=Ellipsis)')

    def test_stubs(self):
        path = os.path.join(os.path.dirname(spar.__file__), '__init__.pyi')
        with open(path, encoding='utf-8') as file:
            tree = ast.parse(file.read())
        stubs, names = {}, set()
        for one in tree.body:
            if isinstance(one, ast.ClassDef):
                names.add(one.name)
            for part in one.body if isinstance(one, ast.ClassDef) else [one]:
                if isinstance(part, ast.FunctionDef):
                    owner = one.name if isinstance(one, ast.ClassDef) else None
                    stubs.setdefault((owner, part.name), part.args)  # the first of an overload
                elif isinstance(part, ast.AnnAssign):
                    names.add(part.target.id)
        for call, owner, _ in self.functions():
            arguments = stubs[owner.__name__ if owner else None, call.python_name]
            self.assertEqual([a.arg for a in arguments.args], ['self'] * bool(owner) + [p.name for p in call.asked], call.name)
        for name, value in vars(spar).items():
            if name.isupper() and not name.startswith('_') and isinstance(value, int) or \
                    inspect.isclass(value) and value.__module__ == 'spar' and not name.startswith('_'):
                self.assertIn(name, names)


class Files(unittest.TestCase):
    """What spar_member_write_vtk writes is read by readers of others."""

    def test_meshio(self):
        """An unstructured grid of the bent cantilever: places and fields are those that the getters give."""
        try:
            import meshio  # pylint: disable=import-outside-toplevel
        except ImportError:
            self.skipTest('no meshio')
        with spar.Session() as s:
            beam = cantilever(s)
            beam.set_load(beam.get_count() - 1, spar.LOAD_DEAD, [0, 0, 10, 0, 0, 0])
            beam.solve_static(1)
            path = os.path.join(WORK, 'python_meshio.vtu')
            beam.write_vtk(path)
            mesh = meshio.read(path)
            q = beam.get_motion(v=None, a=None)
            numpy.testing.assert_array_equal(mesh.points[0], [0, 0, 0])
            tip = mesh.points[numpy.argmax(mesh.points[:, 0])]
            numpy.testing.assert_allclose(tip, [2 + q[-1, 0], q[-1, 1], q[-1, 2]], rtol=0, atol=1e-12)
            for name in ('displacement', 'deflection', 'rotation', 'velocity'):
                self.assertEqual(mesh.point_data[name].shape, (len(mesh.points), 3), name)
            self.assertEqual(set(mesh.cells_dict), {'vertex', 'line'})
            length = numpy.linalg.norm(numpy.diff(mesh.points[mesh.cells_dict['line']], axis=1), axis=2).sum()
            self.assertAlmostEqual(length, 2, delta=1e-4)  # it bends and does not stretch; chords of its line
            os.remove(path)


if __name__ == '__main__':
    unittest.main()
