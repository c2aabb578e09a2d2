"""The readers of other programs' files, on the small files of tests/data/models: all formats and all readers of a format give one blade, and
what a file has wrong is refused by file, line, field and value, or told.
    test_readers.py <folder to write in> [<spar-run>]
"""
import os
import re
import shutil
import subprocess
import sys
import unittest
import warnings

import numpy
import spar
from spar import hawc2, openfast, turbine, windio

RUN = sys.argv.pop() if len(sys.argv) > 2 else None
WORK = os.path.join(os.path.abspath(sys.argv.pop() if len(sys.argv) > 1 else '.'), 'readers', 'models', 'deck')
DATA = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'data', 'models')
SPEED, PITCH, WIND = 1.3, 0.02, 9.0


def copy(name=None, *changes):
    """A fresh copy of all files, in one of which parts are replaced (each is there)."""
    shutil.rmtree(WORK, ignore_errors=True)
    shutil.copytree(DATA, WORK)
    if name:
        path = os.path.join(WORK, name)
        with open(path, encoding='utf-8') as file:
            text = file.read()
        for old, new in changes:
            if old not in text:
                raise AssertionError(f'{name} has no {old!r}')
            text = text.replace(old, new, 1)
        with open(path, 'w', encoding='utf-8', newline='') as file:
            file.write(text)
    return WORK


def path(name):
    return os.path.join(WORK, name)


def fst():
    return openfast.read(path('turbine.fst'))


def beamdyn():
    return openfast.read_beamdyn(path('beamdyn.dat'))


def wind2():
    return windio.read(path('windio2.yaml'))


def wind1():
    return windio.read(path('windio1.yaml'))


def htc(name='blade1'):
    return hawc2.read_body(path('turbine.htc'), name)


def told(call):
    """The warnings of a call, and its answer."""
    with warnings.catch_warnings(record=True) as found:
        warnings.simplefilter('always')
        answer = call()
    return [str(one.message) for one in found], answer


class Alike(unittest.TestCase):
    """One blade of 40 m: mass 40 (200 + 100) / 4 + 40 (100 + 25) / 4, and the frequencies of one reader in all others."""

    def setUp(self):
        copy()

    def library(self, number=4):
        """By the call of the library alone."""
        with spar.Session() as session:
            member = session.beam_create('blade', 3, 8)
            member.read_beamdyn(path('beamdyn.dat'))
            member.commit()
            return member.solve_modes(number)[0]

    def test_blades(self):
        """The readers of BeamDyn's files to 1e-12; windIO 1, 2 and HAWC2 state the numbers otherwise: 1e-9."""
        want = self.library()
        numpy.testing.assert_allclose(beamdyn().modes(4), want, rtol=1e-12)
        for blade in (beamdyn(), fst().blade, wind2().blade, wind1().blade, htc(), htc('blade2')):
            self.assertAlmostEqual(blade.total_mass(), 40 * 300 / 4 + 40 * 125 / 4, delta=4e-9)
            numpy.testing.assert_allclose(blade.modes(4), want, rtol=1e-9)
            if numpy.any(blade.damping):
                numpy.testing.assert_allclose(blade.damping[3:], [6e-3, 4e-3, 5e-3], rtol=1e-12)

    def test_spar_run(self):
        """spar-run on BeamDyn's files, and on the case that Python writes: the same frequencies to 1e-12."""
        if RUN is None or not os.path.exists(RUN):
            self.skipTest('no spar-run')
        want = self.library()
        with open(path('own.case'), 'w', encoding='utf-8') as file:
            file.write('[beam blade]\nelements 3\nnodes 8\nbeamdyn beamdyn.dat\nroot fixed\n[host run]\ndo modes\nmodes 4\n')
        beamdyn().write_case(path('written.case'), 4)
        for case in ('own.case', 'written.case'):
            done = subprocess.run([RUN, path(case), '--out', path(case) + '.out'], capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, 0, done.stderr + done.stdout)
            table = numpy.genfromtxt(path(case) + '.out/modes.csv', delimiter=',', names=True)
            numpy.testing.assert_allclose(table['frequency_Hz'][:4], want, rtol=1e-12)

    def rotor(self, session, machine, read):
        """Rigid blades at a constant speed; read: called with a fluid, and with an aero object, that read the files themselves."""
        blades, air = [], []
        for b in range(3):
            x, q = machine.blade_placement(b, PITCH)
            member = session.beam_create(f'blade{b}', 3, 8)
            member.read_beamdyn(path('beamdyn.dat'))
            member.set_placement(x, q)
            member.set_root(spar.ROOT_DRIVEN)
            member.set_fidelity(spar.FIDELITY_PRESCRIBED, 0)
            member.set_initial_velocity(machine.apex(), None, SPEED * machine.shaft())
            member.commit()
            blades.append(member)
            air.append(member.fluid_create(f'air{b}'))
            read(air[-1])
            air[-1].map()
        aero = spar.Aero(air)
        read(aero)
        aero.set_rotor(machine.apex(), machine.shaft(), machine.hub_radius * numpy.cos(machine.cone), machine.tip_radius())
        aero.set_effects(63)
        aero.solve(machine.air_density, numpy.broadcast_to([WIND, 0, 0], (3, len(air[0].pull_motion(1.0, v=None)), 3)), 1.0)
        return aero.get_rotor()[0]

    def test_thrust(self):
        """Of undeformed blades: AeroDyn's files read by the library, and by Python into numbers, to 1e-12; by spar-run from the case that
        Python writes too."""
        machine = fst()
        machine.tilt = 0.0  # in an axial wind the thrust is the same at all azimuths
        span = numpy.interp((numpy.arange(30) + 0.5) / 30, machine.blade.eta, machine.blade.points[:, 0])

        def read(thing):
            thing.read_aerodyn(path('aerodyn.dat'), None, None, span)

        def put(thing):
            s = machine.sections
            if isinstance(thing, spar.Aero):
                for i, twist in enumerate(machine.section_twist()):
                    thing.set_section(i, s.chord[i], twist, spar.Polar(*s.polars[i]))
            else:
                thing.set_stations(s.eta, numpy.column_stack([0 * s.eta, s.centre]))
        with spar.Session() as session:
            want = self.rotor(session, machine, read)
        with spar.Session() as session:
            self.assertAlmostEqual(self.rotor(session, machine, put), want, delta=1e-12 * want)
        self.assertGreater(want, 1e4)
        other = wind2()
        for a, b in zip(machine.sections.polars, other.sections.polars):
            numpy.testing.assert_allclose(a, b, atol=1e-9)
        for name in ('chord', 'twist', 'centre'):
            numpy.testing.assert_allclose(getattr(machine.sections, name), getattr(other.sections, name), atol=1e-9)
        if RUN is None or not os.path.exists(RUN):
            return
        machine.write_case(path('rotor.case'), SPEED, PITCH, WIND)
        with open(path('rotor.case'), encoding='utf-8') as file:
            text = file.read()
        with open(path('rotor.case'), 'w', encoding='utf-8') as file:
            file.write(text.replace('root driven', 'root driven\nfidelity prescribed').replace('duration 10', 'duration 0.05'))
        done = subprocess.run([RUN, path('rotor.case'), '--out', path('rotor.out')], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr + done.stdout)
        table = numpy.genfromtxt(path('rotor.out/history.csv'), delimiter=',', names=True)
        self.assertAlmostEqual(float(numpy.atleast_1d(table['rotor_thrust_N'])[-1]), want, delta=1e-12 * want)

    def test_tower(self):
        """HAWC2's goes down its z: 70 (4000 A/A ..) kg with the nacelle's 80 t, and EI of I_x E; fore-aft is about spar's z."""
        tower = htc('tower')
        self.assertAlmostEqual(tower.total_mass(), 70 * 3000 + 8e4, delta=1e-6)
        numpy.testing.assert_allclose(tower.points[-1], [70, 0, 0], atol=1e-12)
        numpy.testing.assert_allclose(tower.stiffness[0].diagonal()[[0, 3, 4, 5]], [2e11 * 0.5, 8e10 * 2, 2e11, 2e11])
        eta, mass = tower.masses[0]
        self.assertEqual(eta, 1)
        numpy.testing.assert_allclose(mass, turbine.body_mass(8e4, [1, 0.5, 0], numpy.diag([1.2e5, 1e5, 1e5])), atol=1e-6)
        found, _ = windio.read_tower(path('windio2.yaml'))
        self.assertAlmostEqual(found.total_mass(), wind2().masses()['tower'], delta=1e-9)

    def test_control(self):
        """Rated speed: 16 rev/min of windIO 2; of version 1 the least of VS_maxspd 2 and 60 m/s / R."""
        self.assertAlmostEqual(wind2().rated_speed, 16 * numpy.pi / 30, delta=1e-14)
        self.assertAlmostEqual(wind1().rated_speed, 60 / wind1().tip_radius(), delta=1e-14)
        copy('windio2.yaml', ('rated_rotor_speed: 16.0, optimal_tsr: 7.0', 'supervisory: {maxTS: 90.0}, torque: {tsr: 7.5, VS_maxspd: 15.0}, '
                              'pitch: {min_pitch: 1.0}'))
        machine = wind2()  # WISDEM's: rev/min, degrees
        self.assertAlmostEqual(machine.rated_speed, 15 * numpy.pi / 30, delta=1e-14)
        self.assertEqual((machine.tip_speed_ratio, round(machine.least_pitch_at(5.0), 12)), (7.5, round(numpy.pi / 180, 12)))

    def test_wisdem_bodies(self):
        """elastic_properties_mb: the same masses by WISDEM's names."""
        want = wind2()
        copy('windio2.yaml', ('elastic_properties: {mass: 20000.0, inertia: [3.0E4, 3.0E4, 3.0E4], location: [0.0, 0.0, 0.0]}',
                              'elastic_properties_mb: {system_mass: 20000.0, system_inertia: [3.0E4, 3.0E4, 3.0E4], system_center_mass: [0, 0, 0]}'),
             ('elastic_properties: {mass: 80000.0, inertia: [4.0E5, 4.0E5, 4.0E5], location: [0.5, 0.0, 1.5], spring',
              'elastic_properties_mb: {system_mass: 80000.0, yaw_mass: 0, system_inertia: [4.0E5, 4.0E5, 4.0E5], system_center_mass: [0.5, 0, 1.5], spring'),
             ('elastic_properties: {mass: 1.0E4, inertia: [500.0, 0.0, 0.0], location: [0.0, 0.0, 0.0]}', 'elastic_properties_mb: {rotor_inertia: [500.0, 0, 0]}'))
        found = wind2()
        numpy.testing.assert_array_equal(found.hub, want.hub)
        numpy.testing.assert_array_equal(found.nacelle, want.nacelle)
        self.assertEqual((found.generator_inertia, found.drivetrain), (want.generator_inertia, want.drivetrain))

    def test_downwind(self):
        """A rotor behind its tower: without cone and tilt its thrust is that before it, and the apex lies downwind."""
        change = (('cone_angle: 2.5', 'cone_angle: 0.0'), ('uptilt: 5.0', 'uptilt: 0.0'))
        copy('windio2.yaml', *change)
        before = wind2().steady(8.0, pitch=PITCH)
        copy('windio2.yaml', *change, ('Upwind', 'Downwind'))
        machine = wind2()
        self.assertAlmostEqual(machine.steady(8.0, pitch=PITCH)['thrust'], before['thrust'], delta=1e-9 * before['thrust'])
        self.assertGreater(machine.apex()[0], 0)
        copy('elastodyn.dat', ('-4   OverHang', '4   OverHang'))
        numpy.testing.assert_allclose(fst().apex(), [4 * numpy.cos(numpy.radians(5)), 0, 71.8 - 4 * numpy.sin(numpy.radians(5))])
        copy('windio2.yaml', ('Upwind', 'Downwind'))
        self.assertAlmostEqual(wind2().cone, -numpy.radians(2.5), delta=1e-15)

    def test_marine(self):
        """MHK 2: in water, on a tower that hangs from its base; the tower carries the weight of all."""
        copy('turbine.fst', ('0   MHK', '2   MHK'), ('1.2   AirDens', '1.2   AirDens - a\n1030   WtrDens'))
        with open(path('elastodyn.dat'), encoding='utf-8') as file:
            text = file.read().replace('70   TowerHt', '-24   TowerHt').replace('0   TowerBsHt', '-9   TowerBsHt').replace('1.8   Twr2', '-1.2   Twr2')
        with open(path('elastodyn.dat'), 'w', encoding='utf-8') as file:
            file.write(text.replace('-5   ShftTilt', '0   ShftTilt'))
        names, machine = told(fst)
        self.assertRegex(' '.join(names), 'buoyancy and added mass under water')
        self.assertEqual((round(machine.apex()[2], 12), machine.air_density), (-25.2, 1030))
        with spar.Session() as session:
            session.set_gravity([0, 0, -9.81])
            rotor = machine.build(session)
            brake = numpy.zeros((6, 6))
            brake[3, 3] = 1e14
            rotor.shaft.set_spring(brake)
            rotor.tower.solve_static(1)
            masses = machine.masses()
            total = masses['tower'] + masses['nacelle'] + masses['hub'] + 3 * masses['blade']
            self.assertAlmostEqual(rotor.tower.get_reaction()[2], 9.81 * total, delta=1e-5 * 9.81 * total)
            self.assertAlmostEqual(rotor.tower.get_reference(q=None)[-1][2], -24, delta=1e-9)


class Told(unittest.TestCase):
    """What is filled in, or not taken, is told once, by name."""

    def test_nothing(self):
        """Of the files as they stand nothing is."""
        copy()
        for call in (fst, beamdyn, wind2, wind1, htc, lambda: htc('tower')):
            self.assertEqual(told(call)[0], [])

    def test_left_out(self):
        for name, change, call, said in (
                ('turbine.fst', ('0   CompSub', '1   CompSub'), fst, r'not taken: SubDyn \(CompSub 1\)'),
                ('turbine.fst', ('0   CompHydro', '1   CompHydro'), fst, r'HydroDyn \(CompHydro 1\)'),
                ('aerodyn.dat', ('2   NumAFfiles', '1   TwrShadow - s\n2   NumAFfiles'), fst, r'shadow of the tower \(TwrShadow 1\)'),
                ('elastodyn.dat', ('-2.5   PreCone(2)', '-3.5   PreCone(2)'), fst, r'PreCone\(2\) -3.5'),
                ('beamdyn.dat', ('"beamdyn_blade.dat"', 'True UsePitchAct - actuator\n"beamdyn_blade.dat"'), beamdyn, 'pitch actuator'),
                ('windio2.yaml', ('  tower:', '  monopile: {x: 1}\n  tower:'), wind2, 'components.monopile'),
                ('windio2.yaml', ('rotor_diameter: 82.921', 'rotor_diameter: 100.0'), wind2, 'rotor_diameter is 100 m, and the axes .* 82.921'),
                ('windio2.yaml', ('hub_height: 71.8', 'hub_height: 90.0'), wind2, 'hub_height is 90 m, and the axes .* 72.148'),
                ('windio2.yaml', ('twist: {grid: [0.0, 1.0], values: [10.0', 'twist: {grid: [0.0, 1.0], values: [0.1745'), wind2, 'look like radians'),
                ('turbine.htc', ('damping_posdef 0 0 0 5e-3', 'damping_aniso_v2 0 0 0 5e-3'), htc, 'damping_aniso_v2 of body blade1'),
                ('turbine.htc', ('damping_posdef 0 0 0 5e-3', 'damping_posdef 1 0 0 5e-3'), htc, 'mass-proportional part'),
                ('turbine.htc', ('sec 3 0 0 40', 'sec 3 0 0 50'), htc, 'r goes to 40 m, and body blade1 is 50 m')):
            copy(name, change)
            found, machine = told(call)
            self.assertEqual(len(found), 1, found)
            self.assertRegex(found[0], said)
            self.assertTrue(machine.left_out or 'not taken' not in found[0])

    def test_shear(self):
        """K11 = K22 = 0: shear as of a thin tube; the frequencies of this slender blade change by 1 %."""
        copy()
        want = wind2().blade.modes(3)
        with open(path('windio2.yaml'), encoding='utf-8') as file:
            text = re.sub(r'(K(11|22|16|26)): .*', r'\1: [0.0, 0.0, 0.0]', file.read())
        with open(path('windio2.yaml'), 'w', encoding='utf-8') as file:
            file.write(text)
        found, machine = told(wind2)
        self.assertEqual(len(found), 1)
        self.assertRegex(found[0], 'windio2.yaml: components.blade.structure.elastic_properties leaves out shear stiffness')
        numpy.testing.assert_allclose(machine.blade.modes(3), want, rtol=1.5e-2)

    def test_inertia(self):
        """i_flap in the place of i_cp, as WISDEM wrote it: i_plr less i_edge."""
        copy()
        want = wind2().blade.mass
        copy('windio2.yaml', ('i_flap: [20.0, 10.0, 2.5]', 'i_flap: [0.0, 0.0, 0.0]'), ('i_cp: [0.0, 0.0, 0.0]', 'i_cp: [60.0, 30.0, 7.5]'))
        found, machine = told(wind2)
        self.assertRegex(' '.join(found), 'has no i_flap')
        numpy.testing.assert_allclose(machine.blade.mass, want, atol=1e-12)

    def test_modal_damping(self):
        """damp_type 2: 1 % in the first two modes, met by proportional damping."""
        copy('beamdyn_blade.dat', ('1   damp_type', '2   damp_type - t\n2   n_modes - n\n0.01, 0.01 zeta - r\n  '))
        blade = beamdyn()
        with spar.Session() as session:
            member = blade.create(session)
            member.commit()
            pair = member.solve_eigenvalues(2)[0]
        numpy.testing.assert_allclose(-pair[:, 0] / numpy.hypot(pair[:, 0], pair[:, 1]), 0.01, rtol=1e-3)

    def test_density(self):
        """AeroDyn's own, where it is a number; older decks have none in the .fst."""
        copy('aerodyn.dat', ('"default"   AirDens', '1.06   AirDens'))
        self.assertEqual(fst().air_density, 1.06)

    def test_reynolds(self):
        """Polars for two Reynolds numbers, the second with twice the lift: linear in the logarithm at the rated speed, and told."""
        copy()
        want = wind2()
        with open(path('windio2.yaml'), encoding='utf-8') as file:
            text = file.read()
        one = text[text.index('          - re: 1.0E6'):text.index('  - name: thick')]
        cl = re.search(r'cl: {grid: .*?, values: \[(.*?)\]', one).group(1)
        other = one.replace('re: 1.0E6', 're: 1.0E8').replace(cl, ', '.join(f'{2 * float(x)!r}' for x in cl.split(', ')))
        with open(path('windio2.yaml'), 'w', encoding='utf-8') as file:
            file.write(text.replace(one, one + other))
        found, machine = told(wind2)
        self.assertRegex(' '.join(found), 'Reynolds numbers of 1 airfoils but those at the rated speed')
        s, last = machine.sections, want.sections.polars[-1]
        reynolds = (1.5 + s.eta[-1] * 40) * 16 * numpy.pi / 30 * s.chord[-1] / (1.81e-5 / 1.2)
        thin = (0.4 - (0.4 - 0.2 * s.eta[-1])) / 0.2  # part of the thin airfoil
        more = numpy.interp(0.7, last[0], s.polars[-1][1]) - numpy.interp(0.7, last[0], last[1])
        alone = numpy.interp(0.7, numpy.radians(numpy.linspace(-180, 180, 37)), numpy.sin(2 * numpy.radians(numpy.linspace(-180, 180, 37))))
        self.assertAlmostEqual(more, thin * alone * numpy.log10(reynolds / 1e6) / 2, delta=1e-8)

    def test_columns(self):
        """ElastoDyn's blade with the pitch axis that releases before 5 have: the same."""
        copy()
        want = openfast.read_elastodyn_blade(path('elastodyn_blade.dat'), 40.0).modes(2)
        copy('elastodyn_blade.dat', ('BlFract ', 'BlFract PitchAxis '), ('\n0 10', '\n0 0.25 10'), ('\n0.5 5', '\n0.5 0.25 5'), ('\n1 0', '\n1 0.25 0'))
        numpy.testing.assert_array_equal(openfast.read_elastodyn_blade(path('elastodyn_blade.dat'), 40.0).modes(2), want)

    def test_key_points(self):
        """Three bent key points: a parabola, as in BeamDyn and in the library."""
        copy('beamdyn.dat', ('0 0 20 5', '2 0 20 5'), ('0 0 40 0', '8 0 40 0'))
        blade = beamdyn()
        numpy.testing.assert_allclose(blade.points[:, 1], 8 * (blade.points[:, 0] / 40)**2, atol=1e-12)

    def test_numbers(self):
        """Numbers as programs write them: exponents of Fortran, YAML 1.2's floats, commas and comments in st files, anchors that are given
        again, lines that end with CR."""
        copy()
        want = htc().modes(2)
        copy('blade.st', ('\n40 25', '\n4d1, 25'), ('2e11 8e10', '2D11 8D10'))
        numpy.testing.assert_array_equal(htc().modes(2), want)
        self.assertEqual(windio.load(path('windio2.yaml'))['materials'][0]['E'], 2.1e11)
        copy('windio2.yaml', ('chord: {', 'chord: &a {'), ('twist: {', 'twist: &a {'))
        numpy.testing.assert_array_equal(wind2().blade.modes(2), wind1().blade.modes(2))
        copy('elastodyn.dat', ('\n', '\r'))
        copy('beamdyn.dat', *[('\n', '\r')] * 12)
        self.assertAlmostEqual(beamdyn().total_mass(), 4250, delta=1e-9)


class Refused(unittest.TestCase):
    """By file, line and field."""

    def test_all(self):
        for name, change, call, said in (
                # counts that a file says twice
                ('beamdyn_blade.dat', ('3   station_total', '2   station_total'), beamdyn, 'beamdyn_blade.dat, line 26: station 2 of 2 is at 0.5'),
                ('beamdyn.dat', ('3   kp_total', '4   kp_total'), beamdyn, 'beamdyn.dat, line 6: .*kp_total is 4'),
                ('aerodyn_blade.dat', ('2   NumBlNds', '3   NumBlNds'), fst, 'aerodyn_blade.dat ends'),
                ('airfoil_thin.dat', ('37   NumAlf', '36   NumAlf'), fst, 'airfoil_thin.dat, line 46: a row follows the last one; NumAlf is 36'),
                ('elastodyn_tower.dat', ('2   NTwInpSt', '3   NTwInpSt'), fst, 'elastodyn_tower.dat.*NTwInpSt promises 3 rows'),
                ('elastodyn_tower.dat', ('1 2000 4e10 4e10', '1 2000 4e10 4e10\n2 1 1 1'), fst, 'elastodyn_tower.dat, line 10: a row follows'),
                ('turbine.htc', ('nsec 3', 'nsec 2'), lambda: htc('tower'), 'turbine.htc, line 14: nsec is 2, and 3 sec follow'),
                ('blade.st', ('$1 3', '$1 2'), htc, 'blade.st, line 6: a row follows the last one'),
                ('blade.st', ('$1 3', '$1 4'), htc, r'blade.st, line 7: subset \$1 promises 4 rows, and 3 follow'),
                ('windio2.yaml', ('i_edge: [60.0, 30.0, 7.5]', 'i_edge: [60.0, 30.0]'), wind2, r'windio2.yaml, line \d+: .*i_edge has 2 values for 3'),
                ('windio2.yaml', ('name: small', 'name: again\nname: small'), wind2, 'windio2.yaml, line 3: .* name is given twice'),
                ('elastodyn.dat', ('3   NumBl ', '2   NumBl   - b\n3   NumBl '), fst, 'elastodyn.dat, line 4: NumBl is 2 in line 3 and 3 here'),
                # order and ends
                ('beamdyn_blade.dat', ('\n0\n', '\n0.1\n'), beamdyn, 'beamdyn_blade.dat, line 11: station 1 of 3 is at 0.1'),
                ('elastodyn_blade.dat', ('\n0.5 5', '\n0 5'), lambda: openfast.read_elastodyn_blade(path('elastodyn_blade.dat'), 40.0),
                 'elastodyn_blade.dat, line 11: BlFract is 0'),
                ('elastodyn_blade.dat', ('\n1 0', '\n0.9 0'), lambda: openfast.read_elastodyn_blade(path('elastodyn_blade.dat'), 40.0),
                 'elastodyn_blade.dat, line 12: BlFract is 0.9'),
                ('windio2.yaml', ('grid: [0.0, 0.5, 1.0]', 'grid: [1.0, 0.5, 0.0]'), wind2, r'windio2.yaml, line \d+: .*stiffness_matrix.grid has 0.5'),
                ('windio2.yaml', ('chord: {grid: [0.0, 1.0]', 'chord: {grid: [0.0, 2.0]'), wind2, r'chord.grid has 0.0 as number 1'),
                ('blade.st', ('\n20 100', '\n50 100'), htc, 'blade.st, line 6: r is 40 and is not above'),
                ('turbine.htc', ('sec 2 0 0 20', 'sec 2 0 0 50'), htc, 'turbine.htc, line .*: z is 40 and does not go on'),
                ('aerodyn_blade.dat', ('40 0 0 0 0 1 2', '0 0 0 0 0 1 2'), fst, 'aerodyn_blade.dat, line 8: BlSpn is 0'),
                # ranges
                ('aerodyn_blade.dat', ('0 0 0 0 10 3 1', '0 0 0 0 10 -3 1'), fst, 'aerodyn_blade.dat, line 7: BlChord is -3'),
                ('aerodyn_blade.dat', ('0 0 0 0 10 3 1', '0 0 0 0 10 3 0'), fst, 'aerodyn_blade.dat, line 7: BlAFID is 0'),
                ('aerodyn_blade.dat', ('40 0 0 0 0 1 2', '120 0 0 0 0 1 2'), fst, 'another unit'),
                ('elastodyn.dat', ('41.5   TipRad', '1   TipRad'), fst, 'elastodyn.dat, line .*: TipRad is 1, and HubRad is 1.5'),
                ('elastodyn.dat', ('70   TowerHt', '-24   TowerHt'), fst, 'TowerHt is -24 and TowerBsHt is 0'),
                ('elastodyn.dat', ('20000   HubMass', '-1   HubMass'), fst, r'elastodyn.dat, line \d+: HubMass is -1; give at least 0'),
                ('elastodyn.dat', ('3   NumBl ', '2.5   NumBl '), fst, r'NumBl is 2.5; give a whole number'),
                ('elastodyn_blade.dat', ('0.5 5 100', '0.5 5 -100'), lambda: openfast.read_elastodyn_blade(path('elastodyn_blade.dat'), 40.0),
                 'elastodyn_blade.dat, line 11: BMassDen is -100'),
                ('windio2.yaml', ('mass: [200.0', 'mass: [-200.0'), wind2, r'inertia_matrix.mass has -200; give numbers from 0'),
                ('windio2.yaml', ('chord: {grid: [0.0, 1.0], values: [3.0', 'chord: {grid: [0.0, 1.0], values: [-3.0'), wind2, 'chord.values has -3'),
                ('windio2.yaml', ('chord: {grid: [0.0, 1.0], values: [3.0', 'chord: {grid: [0.0, 1.0], values: [3.0E3'), wind2, 'chord.values has 3000'),
                ('windio2.yaml', ('z: {grid: [0.0, 1.0], values: [0.0, 40.0]', 'z: {grid: [0.0, 1.0], values: [0.0, 40000.0]'), wind2,
                 'goes along 40000 m'),
                ('elastodyn.dat', ('41.5   TipRad', '41500   TipRad'), fst, r'elastodyn.dat, line \d+: TipRad is 41500; give 0.001 to 1000'),
                ('elastodyn.dat', ('90   GBRatio', '1e300   GBRatio'), fst, r'elastodyn.dat, line \d+: GBRatio is 1e\+300; give 0.0001 to 10000'),
                ('windio2.yaml', ('K44: [8.0', 'K44: [-8.0'), wind2, 'K44 has -8'),
                ('windio2.yaml', ('E: 2.1E11', 'E: "2.1E11"'), wind2, 'not an isotropic material'),
                ('windio2.yaml', ('name: thin, spanwise', 'name: thinner, spanwise'), wind2, "names 'thinner', which is no airfoil"),
                ('windio1.yaml', ('cone_angle: 0.0', 'cone_angle: 2.5'), wind1, 'hub.cone_angle has 2.54363.*; give numbers from -1 to 1'),
                ('blade.st', ('70 2000', '70 -2000'), lambda: htc('tower'), r'blade.st, line 11: the m \(column 2\) is -2000'),
                ('turbine.htc', ('-1 80000', '-1 -80000'), lambda: htc('tower'), 'turbine.htc, line 8: concentrated_mass'),
                ('turbine.htc', ('concentrated_mass 3', 'concentrated_mass 4'), lambda: htc('tower'), 'is on node 4 of 3'),
                ('turbine.htc', ('1e5 1e5 1.2e5', '1e5 1e5 9e5'), lambda: htc('tower'), 'turbine.htc, line 8: concentrated_mass: .*no body'),
                ('beamdyn_blade.dat', ('1   damp_type', '3   damp_type'), beamdyn, 'beamdyn_blade.dat, line 5: damp_type is 3'),
                ('beamdyn_blade.dat', (' 1e-3 2e-3 3e-3 4e-3 5e-3 6e-3\n', ''), beamdyn, 'beamdyn_blade.dat, line 9: mu1 to mu6'),
                ('beamdyn_blade.dat', ('  400000000 0', '  400000000 9e+07'), beamdyn, 'beamdyn_blade.dat, line 11: .*not symmetric'),
                # what is no such file
                ('turbine.htc', ('copy_main_body blade1', 'copy_main_body blade2'), lambda: htc('blade2'), 'body blade2 copies itself'),
                ('turbine.htc', ('set 2 1', 'set 3 1'), lambda: htc('tower'), r'subset \$1 of set #3 is not there'),
                ('turbine.htc', ('./blade.st', './none.st'), lambda: htc('tower'), r'turbine.htc, line 10: the st file of tower, ./none.st, is not found'),
                ('blade.st', ('70 2000', '70 20x0'), lambda: htc('tower'), 'blade.st, line 11: 20x0 is not a number'),
                ('windio2.yaml', ('[0.0, 0.5, 1.0]', '[0.0, 0.5, 1.0'), wind2, r'windio2.yaml, line \d+: it is no YAML'),
                ('windio2.yaml', ('elastic_properties:\n', 'layers: [{name: x}]\n      other:\n'), wind2, 'layers and no 6x6 matrices.*PreComp'),
                ('windio2.yaml', ('  blade:', '  blades:'), wind2, 'read the tower alone by spar.windio.read_tower'),
                ('turbine.fst', ('2   CompElast', '3   CompElast'), fst, 'CompElast is 3; give 1 to 2')):
            copy(name, change)
            with self.subTest(said), warnings.catch_warnings(), self.assertRaisesRegex(turbine.ModelError, said):
                warnings.simplefilter('ignore')
                call()

    def test_texts(self):
        """UTF-16, a byte 0, a Git LFS pointer, a file that is not there: by name, whoever reads."""
        calls = {'turbine.fst': fst, 'elastodyn.dat': fst, 'beamdyn.dat': beamdyn, 'beamdyn_blade.dat': beamdyn, 'aerodyn.dat': fst,
                 'airfoil_thin.dat': fst, 'windio2.yaml': wind2, 'turbine.htc': htc, 'blade.st': htc}
        for name, call in calls.items():
            for change, said in ((lambda b: b.decode().encode('utf-16'), 'UTF-16'), (lambda b: b[:5] + b'\0' + b[5:], 'a byte 0'),
                                 (lambda b: b'version https://git-lfs.github.com/spec/v1\noid', 'git lfs pull'), (None, 'No such file|not found')):
                copy()
                if change is None:
                    os.remove(path(name))
                else:
                    with open(path(name), 'rb') as file:
                        data = change(file.read())
                    with open(path(name), 'wb') as file:
                        file.write(data)
                with self.subTest(name + said), self.assertRaisesRegex(turbine.ModelError, f'{name}.*({said})'):
                    call()


if __name__ == '__main__':
    unittest.main()
