"""spar.windio, spar.openfast and spar.turbine against closed forms, against each other and against the library's own readers.
    test_turbine.py <folder to write in> [<spar-run>]
All models are made here: a straight blade of one section, in a turbine of round numbers.
"""
import os
import struct
import subprocess
import sys
import unittest

import numpy
import spar
from spar import controller, hawc2, openfast, results, turbine, windio

RUN = sys.argv.pop() if len(sys.argv) > 2 else None
WORK = sys.argv.pop() if len(sys.argv) > 1 else '.'
LENGTH, MASS, EDGE, FLAP, TORSION, AXIAL = 60.0, 200.0, 4e9, 1e9, 1e9, 1e10  # m, kg/m, N m^2, N
CENTRE = 0.2  # m, of the mass, to the trailing edge
DEGREE = numpy.pi / 180


def constant(value):
    return {'grid': [0.0, 1.0], 'values': [value, value]}


def polar(cl):
    """An airfoil whose lift is cl sin(2 alpha), at steps of 10 degrees."""
    alpha = numpy.linspace(-180, 180, 37)
    return {'configuration': 'default', 're_sets': [{'re': 1e7, 'cl': {'grid': list(alpha), 'values': list(cl * numpy.sin(2 * alpha * DEGREE))},
                                                     'cd': {'grid': [-180, 180], 'values': [0.01, 0.01]},
                                                     'cm': {'grid': [-180, 180], 'values': [0.0, 0.0]}}]}


def model():
    """A turbine of windIO 2 as its YAML file would give it."""
    stiffness = {'grid': [0.0, 1.0], 'K11': [1e9] * 2, 'K22': [2e9] * 2, 'K33': [AXIAL] * 2, 'K44': [EDGE] * 2, 'K55': [FLAP] * 2,
                 'K66': [TORSION] * 2}
    inertia = {'grid': [0.0, 1.0], 'mass': [MASS] * 2, 'cm_x': [0.0] * 2, 'cm_y': [CENTRE] * 2, 'i_edge': [100.0] * 2,
               'i_flap': [20.0] * 2, 'i_plr': [120.0] * 2, 'i_cp': [0.0] * 2}
    tower = {'stiffness_matrix': {'grid': [0.0, 1.0], 'K44': [1e12] * 2, 'K55': [1e12] * 2, 'K66': [8e11] * 2},
             'inertia_matrix': {'grid': [0.0, 1.0], 'mass': [5000.0] * 2}, 'structural_damping': {'mu': [0.0] * 6}}
    return {
        'name': 'test', 'windIO_version': 2.0, 'assembly': {'number_of_blades': 3, 'rotor_orientation': 'Upwind', 'rated_power': 5e6},
        'airfoils': [{'name': 'thin', 'rthick': 0.2, 'aerodynamic_center': 0.25, 'polars': [polar(1.0)]},
                     {'name': 'thick', 'rthick': 0.4, 'aerodynamic_center': 0.35, 'polars': [polar(0.5)]}],
        'components': {
            'blade': {'reference_axis': {'x': constant(0.0), 'y': constant(0.0), 'z': {'grid': [0.0, 1.0], 'values': [0.0, LENGTH]}},
                      'outer_shape': {'chord': constant(4.0), 'twist': constant(10.0), 'section_offset_y': constant(1.5),
                                      'rthick': {'grid': [0.0, 1.0], 'values': [0.4, 0.2]},
                                      'airfoils': [{'name': 'thick', 'spanwise_position': 0.0}, {'name': 'thin', 'spanwise_position': 1.0}]},
                      'structure': {'elastic_properties': {'stiffness_matrix': stiffness, 'inertia_matrix': inertia,
                                                           'structural_damping': {'mu': [1e-3, 2e-3, 3e-3, 4e-3, 5e-3, 6e-3]}}}},
            'hub': {'diameter': 4.0, 'cone_angle': 3.0, 'cd': 0.5,
                    'elastic_properties': {'mass': 4e4, 'inertia': [1e5, 1e5, 1e5], 'location': [0.5, 0.0, 0.0]}},
            'drivetrain': {'outer_shape': {'uptilt': 5.0, 'distance_tt_hub': 3.0, 'overhang': 6.0},
                           'generator': {'elastic_properties': {'mass': 1e5, 'inertia': [1e6, 5e5, 5e5], 'location': [1.5]}},
                           'elastic_properties': {'mass': 2e5, 'inertia': [1e6] * 3, 'location': [-1.0, 0.0, 2.0],
                                                  'spring_constant': 1e9, 'damping_coefficient': 1e6}},
            'yaw': {'elastic_properties': {'mass': 1e4, 'inertia': [0.0] * 3, 'location': [0.0] * 3}},
            'tower': {'reference_axis': {'x': constant(0.0), 'y': constant(0.0), 'z': {'grid': [0.0, 1.0], 'values': [10.0, 90.0]}},
                      'outer_shape': {'outer_diameter': constant(6.0)}, 'structure': {'elastic_properties': tower}}},
        'control': {'rated_rotor_speed': 12.0, 'optimal_tsr': 3.0}}


def stiffened(data, factor, *parts):
    """The model with parts that much stiffer."""
    for part in parts:
        for key, values in data['components'][part]['structure']['elastic_properties']['stiffness_matrix'].items():
            if key != 'grid':
                values[:] = [factor * value for value in values]
    return data


def old_model():
    """The same blade in windIO 1."""
    new, row = model(), numpy.triu_indices(6)
    beam = windio.read(new).blade
    back = numpy.argsort(turbine.FROM_OPENFAST)
    rows = [[list(m[back][:, back][row])] * 2 for m in (beam.stiffness[0], beam.mass[0])]
    axis = new['components']['blade']['reference_axis']
    return {'name': 'old', 'components': {
        'blade': {'outer_shape_bem': {'airfoil_position': {'grid': [0.0, 1.0], 'labels': ['thick', 'thin']}, 'chord': constant(4.0),
                                      'twist': constant(10 * DEGREE), 'pitch_axis': constant(1.5 / 4), 'reference_axis': axis},
                  'elastic_properties_mb': {'six_x_six': {'reference_axis': axis, 'twist': constant(10 * DEGREE),
                                                          'stiff_matrix': {'grid': [0.0, 1.0], 'values': rows[0]},
                                                          'inertia_matrix': {'grid': [0.0, 1.0], 'values': rows[1]}}}},
        'hub': {'diameter': 4.0, 'cone_angle': 3 * DEGREE},
        'nacelle': {'drivetrain': {'uptilt': 5 * DEGREE, 'overhang': 6.0, 'distance_tt_hub': 3.0}}},
        'airfoils': [{'name': 'thin', 'relative_thickness': 0.2, 'aerodynamic_center': 0.25, 'polars': [old_polar(1.0)]},
                     {'name': 'thick', 'relative_thickness': 0.4, 'aerodynamic_center': 0.35, 'polars': [old_polar(0.5)]}]}


def old_polar(cl):
    one = polar(cl)['re_sets'][0]
    return {f'c_{k}': {'grid': [a * DEGREE for a in one[f'c{k}']['grid']], 'values': one[f'c{k}']['values']} for k in 'ldm'}


def write(name, text):
    path = os.path.join(WORK, name)
    with open(path, 'w', encoding='utf-8') as file:
        file.write(text)
    return path


def beamdyn_files(damped=True):
    """The same blade for BeamDyn."""
    beam = windio.read(model()).blade
    back = numpy.argsort(turbine.FROM_OPENFAST)
    blocks = []
    for eta in (0.0, 0.5, 1.0):
        blocks.append(f'{eta}\n' + '\n\n'.join('\n'.join(' '.join(f'{x:.16g}' for x in line) for line in m[back][:, back])
                                               for m in (beam.stiffness[0], beam.mass[0])) + '\n')
    write('beamdyn_blade.dat', 'BeamDyn\nmade by the test\n--- BLADE PARAMETERS ---\n3 station_total - (-)\n'
          f'{int(damped)} damp_type - (-)\n--- DAMPING ---\nmu1 mu2 mu3 mu4 mu5 mu6\n(-) (-) (-) (-) (-) (-)\n0.001 0.002 0.003 0.004 0.005 0.006\n'
          '--- DISTRIBUTED PROPERTIES ---\n' + '\n'.join(blocks))
    return write('beamdyn.dat', 'BeamDyn\nmade by the test\n--- GEOMETRY ---\n1 member_total - (-)\n3 kp_total - (-)\n1 3 - member, key points\n'
                 'kp_xr kp_yr kp_zr initial_twist\n(m) (m) (m) (deg)\n0 0 0 10\n0 0 30 10\n0 0 60 10\n'
                 '--- MATERIAL ---\n"beamdyn_blade.dat" BldFile - name\n')


class Blade(unittest.TestCase):
    def test_mass(self):
        """Of a body: [m I, -m c~; m c~, J] (spar_rigid_create) with Steiner's terms, by hand for c = (1, 2, 3)."""
        m = turbine.body_mass(2.0, [1, 2, 3], numpy.diag([5, 6, 7]))
        numpy.testing.assert_allclose(m[3:, :3], 2 * numpy.array([[0, -3, 2], [3, 0, -1], [-2, 1, 0]]), atol=1e-14)
        numpy.testing.assert_allclose(m[:3, 3:], m[3:, :3].T, atol=1e-14)
        numpy.testing.assert_allclose(m[3:, 3:], [[31, -4, -6], [-4, 26, -12], [-6, -12, 17]], atol=1e-13)

    def test_quaternions(self):
        """Back to the rotation, for rotations about each axis by angles near and beyond half a turn."""
        for axis in ([1, 0, 0], [0, 1, 0], [0, 0, 1], [1, -2, 3]):
            for angle in (0.1, 1.5, 3.0, 3.14159265, 4.0, 6.0):
                n = numpy.array(axis) / numpy.linalg.norm(axis)
                q, expected = turbine.quaternion(turbine.turned(axis, angle)), [numpy.cos(angle / 2), *(numpy.sin(angle / 2) * n)]
                self.assertAlmostEqual(abs(q @ expected), 1, delta=1e-12)

    def test_windio(self):
        """Mass and frequencies of a clamped beam: 1.8751^2 sqrt(EI / m L^4) / 2 pi; flap by K55, edge by K44; shear lowers by 0.5 %.
        The centre of mass off the line couples edge with extension, and flap with torsion far above."""
        blade = windio.read(model()).blade
        self.assertAlmostEqual(blade.total_mass(), MASS * LENGTH, delta=1e-8)
        f = 1.87510407**2 / (2 * numpy.pi) / LENGTH**2
        flap, edge = blade.modes(2)
        self.assertAlmostEqual(flap, f * numpy.sqrt(FLAP / MASS), delta=6e-3 * flap)
        self.assertAlmostEqual(edge, f * numpy.sqrt(EDGE / MASS), delta=2e-2 * edge)
        numpy.testing.assert_allclose(blade.damping, [3e-3, 1e-3, 2e-3, 6e-3, 4e-3, 5e-3])
        numpy.testing.assert_allclose(blade.twist, -10 * DEGREE)

    def test_tower_of_layers(self):
        """A windIO 2 tower of one steel layer: EA, EI and mass of a thin tube (diameter 6 m, wall 0.04 m), 7 % outfitting. A monopile
        below it is not read, which is told."""
        data = model()
        data['materials'] = [{'name': 'steel', 'E': 200000000000, 'nu': 0.3, 'rho': 7800}]
        data['components']['tower']['structure'] = {'outfitting_factor': 1.07, 'layers': [
            {'name': 'wall', 'material': 'steel', 'thickness': constant(0.04)}]}
        data['components']['monopile'] = {}
        with self.assertWarnsRegex(UserWarning, r'not taken: components.monopile \(the tower stands on a rigid base\)'):
            machine = windio.read(data)
        self.assertEqual(len(machine.left_out), 1)
        mean, area = 5.96, numpy.pi * 5.96 * 0.04
        for found, want in ((machine.tower.stiffness[0][4, 4], 2e11 * area * mean**2 / 8), (machine.tower.stiffness[0][0, 0], 2e11 * area),
                            (machine.tower.mass[0][0, 0], 1.07 * 7800 * area)):
            self.assertAlmostEqual(found, want, delta=1e-4 * want)  # (wall / diameter)^2
        data['components']['tower']['structure'] = {}
        with self.assertRaisesRegex(turbine.ModelError, 'no matrices and 0 layers'):
            windio.read(data)

    def test_versions(self):
        """windIO 1 and 2 of one blade are one."""
        old, new = windio.read(old_model()), windio.read(model())
        for name in ('eta', 'points', 'twist', 'stiffness', 'mass'):
            numpy.testing.assert_allclose(getattr(old.blade, name), getattr(new.blade, name), rtol=1e-14, atol=1e-14)
        for name in ('eta', 'chord', 'twist', 'centre'):
            numpy.testing.assert_allclose(getattr(old.sections, name), getattr(new.sections, name), rtol=1e-12, atol=1e-12)
        for a, b in zip(old.sections.polars, new.sections.polars):
            numpy.testing.assert_allclose(a, b, atol=1e-8)
        self.assertEqual((old.tilt, old.cone, old.overhang), (new.tilt, new.cone, new.overhang))
        self.assertIsNone(old.hub)

    def test_beamdyn(self):
        """BeamDyn's files of the same blade: the same beam, and the same frequencies as by the library's calls."""
        path = beamdyn_files()
        blade = openfast.read_beamdyn(path)
        of_windio = windio.read(model()).blade
        numpy.testing.assert_allclose(blade.stiffness[0], of_windio.stiffness[0], rtol=1e-14)
        numpy.testing.assert_allclose(blade.mass[0], of_windio.mass[0], rtol=1e-14)
        numpy.testing.assert_allclose(blade.damping, of_windio.damping)
        with spar.Session() as session:
            member = session.beam_create('blade', blade.elements, blade.nodes)
            member.read_beamdyn(path)
            member.commit()
            numpy.testing.assert_allclose(blade.modes(6), member.solve_modes(6)[0], rtol=1e-9)
        numpy.testing.assert_allclose(blade.modes(6), of_windio.modes(6), rtol=1e-6)  # of other quadratures

    def test_curved(self):
        """Prebend and twist: the points of windIO's x are spar's y; eta is arc length; BeamDyn's spline agrees with the library's."""
        data = model()
        grid = numpy.linspace(0, 1, 21)
        z, x = LENGTH * grid, -3 * grid**2
        data['components']['blade']['reference_axis'] = {k: {'grid': list(grid), 'values': list(v)} for k, v in (('x', x), ('y', 0 * x), ('z', z))}
        blade = windio.read(data).blade
        numpy.testing.assert_allclose(blade.points, numpy.column_stack([z, x, 0 * x]))
        a = 6 / LENGTH  # slope at the tip of the parabola
        self.assertAlmostEqual(blade.length(), LENGTH / 2 * (numpy.sqrt(1 + a * a) + numpy.arcsinh(a) / a), delta=1e-3)

    def hawc2_files(self, rows):
        """A blade of the model's length in HAWC2's files, of one row of numbers at both ends."""
        text = '\n'.join(f'{r} ' + ' '.join(f'{x:.16g}' for x in rows) for r in (0, LENGTH))
        write('blade.st', f'1 sets\n#1 made by the test\nr m ...\n$1 2 flexible\n{text}\n')
        return write('blade.htc', 'begin main_body ;\n  name blade1 ; of three\n  damping_posdef 0 0 0 1e-3 2e-3 3e-3 ;\n  begin timoschenko_input ;\n'
                     '    filename ./blade.st ;\n    set 1 1 ;\n  end timoschenko_input ;\n  begin c2_def ;\n    nsec 2 ;\n'
                     f'    sec 1 0 0 0 -10 ;\n    sec 2 0 0 {LENGTH} -10 ;\n  end c2_def ;\nend main_body ;\n')

    def test_hawc2(self):
        """The model's blade as HAWC2 has it, x to the leading edge: E = 1e10, G = 1e9, A = 1."""
        mass = [MASS, -CENTRE, 0, numpy.sqrt(20 / MASS), numpy.sqrt((100 - MASS * CENTRE**2) / MASS)]
        of_windio = windio.read(model()).blade
        upper = numpy.diag([2e9, 1e9, AXIAL, FLAP, EDGE, TORSION])[numpy.triu_indices(6)]
        for rows in ([*mass, 0, 0, 1e10, 1e9, 0.1, 0.4, 1, 2, 1, 1, 0, 0, 0], [*mass, 0, 0, 0, *upper]):
            blade = hawc2.read_body(self.hawc2_files(rows), 'blade1')
            for name in ('points', 'twist'):
                numpy.testing.assert_allclose(getattr(blade, name)[[0, -1]], getattr(of_windio, name)[[0, -1]], atol=1e-12)
            numpy.testing.assert_allclose(blade.stiffness[0], of_windio.stiffness[0], rtol=1e-12, atol=1e-3)
            numpy.testing.assert_allclose(blade.mass[0], of_windio.mass[0], rtol=1e-12, atol=1e-10)
            numpy.testing.assert_allclose(blade.damping, [0, 0, 0, 3e-3, 2e-3, 1e-3])

    def test_hawc2_centres(self):
        """Elastic centre 0.3 m ahead of the line and 0.1 m to the suction side, principal axes at 90 degrees: a force along the beam
        at that point does not bend. Both kinds of rows give one matrix."""
        mass = [MASS, 0, 0, 0.3, 0.7]
        upper = numpy.diag([1e9, 1e9, AXIAL, EDGE, FLAP, TORSION])[numpy.triu_indices(6)]
        found = []
        for rows in ([*mass, 0.3, 0.1, 1e10, 1e9, 0.4, 0.1, 1, 1, 1, 1, 90, 0.3, 0.1], [*mass, 90, 0.3, 0.1, *upper]):
            self.hawc2_files(rows)
            _, stiffness, inertia = hawc2.read_st(os.path.join(WORK, 'blade.st'))
            flexibility = numpy.linalg.inv(stiffness[0])
            pull = numpy.array([1, 0, 0, 0, -0.3, -0.1])  # at y = 0.1, z = -0.3: moments z N about y, -y N about z
            numpy.testing.assert_allclose((flexibility @ pull)[3:], 0, atol=1e-16)  # beside 1e-10 of one that bends
            numpy.testing.assert_allclose(inertia[0][3:, 3:], MASS * numpy.diag([0.3**2 + 0.7**2, 0.3**2, 0.7**2]), atol=1e-9)
            found.append(stiffness[0])
        numpy.testing.assert_allclose(*found, rtol=1e-12, atol=1e-2)
        self.assertAlmostEqual(found[0][4, 4], EDGE + AXIAL * 0.3**2, delta=1)  # about y, to which x has turned
        with self.assertRaisesRegex(turbine.ModelError, 'set #2'):
            hawc2.read_st(os.path.join(WORK, 'blade.st'), number=2)

    def test_case(self):
        """spar-run finds the frequencies of the case file that are found here."""
        if RUN is None or not os.path.exists(RUN):
            self.skipTest('no spar-run')
        blade = windio.read(model()).blade
        blade.masses.append((0.5, turbine.body_mass(300.0)))
        path = os.path.join(WORK, 'blade.case')
        blade.write_case(path, 5)
        done = subprocess.run([RUN, path, '--out', path + '.out'], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr + done.stdout)
        table = numpy.genfromtxt(path + '.out/modes.csv', delimiter=',', names=True)
        column = next(name for name in table.dtype.names if 'req' in name)
        numpy.testing.assert_allclose(table[column][:5], blade.modes(5), rtol=1e-4)

    def test_refused(self):
        data = model()
        data['components']['blade']['structure']['elastic_properties']['stiffness_matrix']['K44'] = [1.0]
        with self.assertRaisesRegex(turbine.ModelError, 'K44 has 1 values for 2 grid points'):
            windio.read(data)
        data = model()
        del data['components']['blade']['structure']
        with self.assertRaisesRegex(turbine.ModelError, 'blade has no structure'):
            windio.read(data)
        data = model()
        data['assembly']['rotor_orientation'] = 'Sideways'
        with self.assertRaisesRegex(turbine.ModelError, "rotor_orientation is 'Sideways'"):
            windio.read(data)
        path = write('short.dat', '--- ---\n5 NBlInpSt - (-)\nBlFract PitchAxis StrcTwst BMassDen FlpStff EdgStff\n(-) (-)\n0 0 0 1 1 1\n')
        with self.assertRaisesRegex(turbine.ModelError, 'short.dat, line 6: NBlInpSt promises 5 rows of 6 numbers, and 1 follow'):
            openfast.read_elastodyn_blade(path, 10.0)
        with self.assertRaisesRegex(turbine.ModelError, 'no hub'):
            with spar.Session() as session:
                old = windio.read(old_model())
                old.tower = windio.read(model()).tower
                old.nacelle = numpy.eye(6)
                old.build(session)


class Rotor(unittest.TestCase):
    def test_placement(self):
        """Blade 0 points up and leans upwind by cone less tilt; the rotor turns clockwise seen from upwind, leading edges first."""
        machine = windio.read(model())
        numpy.testing.assert_allclose(machine.apex(), [-6, 0, 93])
        x, _ = machine.blade_placement(0)
        lean = (3 + -5) * DEGREE  # the tilt leans the upper blade downwind
        numpy.testing.assert_allclose((x - machine.apex()) / 2, [-numpy.sin(lean), 0, numpy.cos(lean)], atol=1e-14)
        for b in range(3):
            x, _ = machine.blade_placement(b)
            axes = machine.blade_axes(b)
            self.assertAlmostEqual(axes[:, 0] @ machine.shaft(), -numpy.sin(3 * DEGREE), delta=1e-14)
            self.assertAlmostEqual(numpy.linalg.det(axes), 1, delta=1e-14)
            forward = numpy.cross(machine.shaft(), x - machine.apex())
            self.assertAlmostEqual(axes[:, 2] @ forward / numpy.linalg.norm(forward), -1, delta=1e-14)  # the trailing edge is behind
        y = machine.blade_placement(1)[0][1]
        self.assertAlmostEqual(y, -2 * numpy.cos(3 * DEGREE) * numpy.sin(120 * DEGREE), delta=1e-12)
        feathered = machine.blade_axes(0, 90 * DEGREE)  # the leading edge goes upwind, the trailing edge downwind
        self.assertAlmostEqual(feathered[:, 2] @ machine.shaft(), numpy.cos(3 * DEGREE), delta=1e-12)

    def test_sections(self):
        """Thickness between two airfoils gives what lies between their coefficients; the aerodynamic centre is ac chord - offset
        behind the line."""
        s = windio.read(model(), stations=[0.25, 0.5]).sections
        i = numpy.argmin(abs(s.polars[1][0] - 40 * DEGREE))
        self.assertAlmostEqual(s.polars[1][1][i], 0.75 * numpy.sin(80 * DEGREE), delta=1e-9)
        i = numpy.argmin(abs(s.polars[0][0] - 40 * DEGREE))
        self.assertAlmostEqual(s.polars[0][1][i], 0.625 * numpy.sin(80 * DEGREE), delta=1e-9)
        numpy.testing.assert_allclose(s.centre, [[0, 0.325 * 4 - 1.5], [0, 0.30 * 4 - 1.5]], atol=1e-12)

    def test_angles(self):
        """Without induction, on a stiff blade: alpha = atan(V / (omega r)) - twist - pitch, and the power is torque times speed."""
        data = model()
        data['components']['hub']['cone_angle'] = data['components']['drivetrain']['outer_shape']['uptilt'] = 0.0
        machine = windio.read(stiffened(data, 1e6, 'blade'), stations=[0.3, 0.6, 0.9])
        machine.sections.centre[:] = 0
        with spar.Session() as session:
            rotor = machine.build(session, 1.0, 4 * DEGREE, rigid=True)
            rotor.aero.set_effects(0)
            rotor.start([9, 0, 0])
            r = 2 + LENGTH * numpy.array([0.3, 0.6, 0.9])
            for alpha in rotor.aero.get_sections()[0]:
                numpy.testing.assert_allclose(alpha, numpy.arctan(9 / r) - 14 * DEGREE, atol=1e-6)
            _, torque, power = rotor.aero.get_rotor()
            self.assertAlmostEqual(power, torque, delta=1e-5 * abs(torque))
            for _ in range(3):  # it goes on turning
                rotor.turn(0.1)
                session.step(0.1, lambda *_: rotor.blow([9, 0, 0]))
            numpy.testing.assert_allclose(rotor.aero.get_sections()[0][1], numpy.arctan(9 / r) - 14 * DEGREE, atol=1e-5)

    def test_weight(self):
        """The tower's base carries the weight of all parts, and their moment about it, with everything stiff."""
        machine = windio.read(stiffened(model(), 1e4, 'blade', 'tower'))
        masses = machine.masses()
        self.assertAlmostEqual(masses['nacelle'], 2.1e5, delta=1e-6)
        self.assertAlmostEqual(masses['tower'], 80 * 5000.0, delta=1e-6)
        with spar.Session() as session:
            session.set_gravity([0, 0, -9.81])
            rotor = machine.build(session)
            brake = numpy.zeros((6, 6))
            brake[3, 3] = 1e14
            rotor.shaft.set_spring(brake)
            rotor.tower.solve_static(1)
            total = masses['tower'] + masses['nacelle'] + masses['hub'] + 3 * masses['blade']
            reaction = rotor.tower.get_reaction()
            self.assertAlmostEqual(reaction[2], 9.81 * total, delta=1e-6 * 9.81 * total)
            n = machine.shaft()
            hub = machine.apex() + 0.5 * n
            span = 2 + LENGTH / 2  # of the blades' centre on the cone's axis
            rotor_x = (machine.apex() - span * numpy.sin(3 * DEGREE) * n + CENTRE * numpy.sin(10 * DEGREE) * numpy.cos(3 * DEGREE) * n)[0]
            arm = masses['nacelle'] * -2e5 / 2.1e5 + masses['hub'] * hub[0] + 3 * masses['blade'] * rotor_x
            self.assertAlmostEqual(reaction[4], -9.81 * arm, delta=1e-4 * abs(9.81 * arm))

    def test_turns(self):
        """Free of air, weight and torque the rotor keeps its speed; a torque slows it by torque / inertia."""
        data = stiffened(model(), 1e3, 'blade', 'tower')
        del data['airfoils']
        machine = windio.read(data)
        machine.drivetrain = (1e12, 1e9)
        with spar.Session() as session:
            rotor = machine.build(session, 1.0)
            rotor.start(None)
            for _ in range(10):
                session.step(0.02)
            self.assertAlmostEqual(rotor.get_speed(), 1.0, delta=5e-5)  # what the blades stretch
            rotor.set_torque(1e6)
            for _ in range(50):
                session.step(0.02)
            r = 2 + LENGTH * numpy.linspace(0, 1, 1001)
            inertia = 3 * numpy.mean(MASS * LENGTH * (r * numpy.cos(3 * DEGREE)) ** 2) + 3 * MASS * LENGTH * CENTRE**2 + 1e5 + 1e6
            self.assertAlmostEqual(1.0 - rotor.get_speed(), 1e6 / inertia, delta=1e-2 * 1e6 / inertia)

    def test_pitch(self):
        """Pitch by 3 degrees in ten steps: the blade has turned by that on the hub, its trailing edge downwind."""
        data = stiffened(model(), 1e3, 'blade', 'tower')
        del data['airfoils']
        machine = windio.read(data)
        with spar.Session() as session:
            rotor = machine.build(session, 0.0)
            for step in range(10):
                rotor.set_pitch((step + 1) * 0.3 * DEGREE, 0.3 * DEGREE / 0.1)
                session.step(0.1)
            turns = []
            for member in (rotor.hub, rotor.blades[1]):
                w, *v = member.get_motion(v=None, a=None)[0, 3:]
                turns.append(numpy.eye(3) + 2 * w * turbine.cross_matrix(v) + 2 * turbine.cross_matrix(v) @ turbine.cross_matrix(v))
            relative, axes = turns[0].T @ turns[1], machine.blade_axes(1)
            self.assertAlmostEqual(numpy.arccos((numpy.trace(relative) - 1) / 2), 3 * DEGREE, delta=1e-6)
            expected = machine.blade_axes(1, 3 * DEGREE)
            numpy.testing.assert_allclose(relative @ axes, expected, atol=1e-6)

    def test_steady(self):
        """Below the rated power the pitch is the least one; above it the power is the rated one, here half of what it could be."""
        machine = windio.read(model())
        machine.pitch_table = ([0.0, 20.0], [0.0, 0.02])
        machine.rated_power = 0.5 * machine.steady(9.0, pitch=0.009)['power']
        low, high = machine.steady(6.0), machine.steady(9.0)
        self.assertAlmostEqual(low['pitch'], 0.006, delta=1e-15)
        self.assertTrue(0 < low['power'] < machine.rated_power)
        self.assertAlmostEqual(high['power'], machine.rated_power, delta=1e-4 * machine.rated_power)
        self.assertGreater(high['pitch'], 0.009)
        self.assertEqual(machine.speed_at(9.0), min(3 * 9 / machine.tip_radius(), 12 * numpy.pi / 30))

    def test_example(self):
        """examples/python/iea15.py on the model of this test: whole frequencies above none of the blade's, and a gust that speeds the
        rotor up and bends the tower."""
        folder = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..', 'examples', 'python')
        sys.path.insert(0, folder)
        import iea15  # pylint: disable=import-error,import-outside-toplevel
        machine = windio.read(model(), stations=(numpy.arange(8) + 0.5) / 8)
        machine.blade.damping[:] = 2e-3
        whole, blade = iea15.frequencies(machine)
        tower = machine.tower.modes(1)[0]
        self.assertLess(whole[0], 0.8 * tower)  # the machine on its top
        self.assertTrue((abs(whole / blade[0] - 1) < 0.2).sum() >= 3)  # three blades
        motion = iea15.gust(machine, seconds=26.0, dt=0.1)
        calm, late = motion[:190], motion[250]
        self.assertAlmostEqual(late[1], 12, delta=0.02)
        self.assertGreater(late[2], calm[:, 2].max())
        self.assertGreater(motion[200:, 5].max(), calm[-50:, 5].max())
        machine.rated_speed, machine.rated_power = 2.5 * 9 / machine.tip_radius(), 0.5 * machine.steady(9.0, pitch=0.0)['power']
        run = iea15.controlled(machine, controller.Regions(machine, winds=(9.5, 11.0)), mean=9.0, rise=1.0, seconds=75.0, dt=0.1)
        self.assertAlmostEqual(run[580:600, 2].mean(), machine.rated_speed * 30 / numpy.pi, delta=0.02 * machine.rated_speed * 30 / numpy.pi)
        self.assertGreater(run[600:, 3].max(), run[580:600, 3].max())

    def test_elastodyn(self):
        """A turbine of ElastoDyn's file: geometry and masses by their keys; the blade bends as a beam, flap and edge."""
        write('ed_blade.dat', '---\nmade by the test\n---\n2 NBlInpSt - (-)\n2.0 BldFlDmp(1) - (%)\n1.1 AdjBlMs - (-)\n1.0 AdjFlSt - (-)\n'
              '1.0 AdjEdSt - (-)\n---\nBlFract PitchAxis StrcTwst BMassDen FlpStff EdgStff\n(-) (-) (deg) (kg/m) (Nm^2) (Nm^2)\n'
              '0 0.25 0 200 1e9 4e9\n1 0.25 0 200 1e9 4e9\n')
        write('ed_tower.dat', '---\nmade by the test\n---\n2 NTwInpSt - (-)\n1.0 TwrFADmp(1) - (%)\n---\nHtFract TMassDen TwFAStif TwSSStif\n'
              '(-) (kg/m) (Nm^2) (Nm^2)\n0 5000 1e12 1e12\n1 5000 1e12 1e12\n')
        keys = {'NumBl': 3, 'TipRad': 62, 'HubRad': 2, 'PreCone(1)': -3, 'HubCM': 0.5, 'OverHang': -6, 'ShftTilt': -5, 'NacCMxn': -1,
                'NacCMyn': 0, 'NacCMzn': 2, 'Twr2Shft': 2.5, 'TowerHt': 90, 'TowerBsHt': 10, 'HubMass': 4e4, 'HubIner': 1e5, 'GenIner': 100,
                'NacMass': 2e5, 'NacYIner': 1.2e6, 'YawBrMass': 1e4, 'GBRatio': 97, 'DTTorSpr': 1e9, 'DTTorDmp': 1e6,
                'BldFile(1)': '"ed_blade.dat"', 'TwrFile': '"ed_tower.dat"'}
        path = write('ed.dat', '---\nmade by the test\n' + '\n'.join(f'{value}  {key}  - what it is' for key, value in keys.items()) + '\n')
        machine = openfast.read_elastodyn(path)
        numpy.testing.assert_allclose(machine.apex(), [-6 * numpy.cos(5 * DEGREE), 0, 92.5 + 6 * numpy.sin(5 * DEGREE)])
        masses = machine.masses()
        self.assertAlmostEqual(masses['blade'], 220 * 60, delta=1e-6)
        self.assertEqual((masses['hub'], masses['nacelle'], machine.generator_inertia), (4e4, 2.1e5, 100 * 97**2))
        self.assertAlmostEqual(machine.nacelle[5, 5], 1.2e6, delta=1e-6)
        f = 1.87510407**2 / (2 * numpy.pi) / LENGTH**2
        flap, edge = machine.blade.modes(2)
        self.assertAlmostEqual(flap, f * numpy.sqrt(FLAP / 220), delta=3e-3 * flap)
        self.assertAlmostEqual(edge, f * numpy.sqrt(EDGE / 220), delta=3e-3 * edge)
        self.assertAlmostEqual(machine.tower.modes(1)[0], 1.87510407**2 / (2 * numpy.pi) / 80**2 * numpy.sqrt(1e12 / 5000),
                               delta=2e-2 * machine.tower.modes(1)[0])

    def test_aerodyn(self):
        """AeroDyn's blade of the same airfoils at the same places: the sections that windIO gives."""
        machine = windio.read(model(), stations=[0.25, 0.75])
        for name, foil in (('thin', 1.0), ('thick', 0.5)):
            alpha = numpy.linspace(-180, 180, 37)
            rows = '\n'.join(f'{a:.1f} {foil * numpy.sin(2 * a * DEGREE):.12f} 0.01 0.0' for a in alpha)
            write(f'{name}.dat', f'! {name}\n1 NumTabs - tables\n37 NumAlf - rows\n! alpha cl cd cm\n{rows}\n')
        turn = 10 * DEGREE  # the aerodynamic centre lies 0.2 m ahead, then 0.5 m ahead of the line, in the twisted chord
        ends = [(0.35 * 4 - 1.5), (0.25 * 4 - 1.5)]
        rows = '\n'.join(f'{z} {c * numpy.sin(turn):.9f} {c * numpy.cos(turn):.9f} 0 10 4 {foil}' for z, c, foil in ((0, ends[0], 2), (60, ends[1], 1)))
        write('ad_blade.dat', f'---\nmade by the test\n---\n2 NumBlNds - (-)\nBlSpn BlCrvAC BlSwpAC BlCrvAng BlTwist BlChord BlAFID\n(m) ...\n{rows}\n')
        columns = '1 AFTabMod - m\n1 InCol_Alfa - c\n2 InCol_Cl - c\n3 InCol_Cd - c\n4 InCol_Cm - c\n'
        path = write('ad.dat', f'---\nmade by the test\n{columns}2 NumAFfiles - (-)\n"thin.dat" AFNames - names\n"thick.dat"\n'
                     'True UseBlCm - (flag)\n"ad_blade.dat" ADBlFile(1) - name\n')
        sections = openfast.read_aerodyn(path, machine.blade, stations=[0.25, 0.75])
        for name in ('chord', 'twist', 'centre'):
            numpy.testing.assert_allclose(getattr(sections, name), getattr(machine.sections, name), atol=1e-8)
        for a, b in zip(sections.polars, machine.sections.polars):
            numpy.testing.assert_allclose(a, b, atol=1e-8)
        alpha = machine.sections.polars[0][0]
        write('thin.dat', f'1 NumTabs - tables\n{len(alpha)} NumAlf - rows\n' + '\n'.join(f'{a / DEGREE:.9f} 0 0 0.1' for a in alpha) + '\n')
        for use, moment in (('True', 0.1), ('False', 0.0)):  # UseBlCm
            path = write('ad.dat', f'---\nmade by the test\n{columns}1 NumAFfiles - (-)\n"thin.dat" AFNames - names\n{use} UseBlCm - (flag)\n'
                         '"ad_blade1.dat" ADBlFile(1) - name\n')
            write('ad_blade1.dat', '2 NumBlNds - (-)\nBlSpn\n(m)\n0 0 0 0 10 4 1\n60 0 0 0 10 4 1\n')
            polars = openfast.read_aerodyn(path, machine.blade, stations=[0.25, 0.75]).polars
            numpy.testing.assert_allclose(polars[0][3], moment, atol=1e-12)

    def test_case(self):
        """spar-run turns the rotor of a case file in a wind, with the power that is found here after the same time."""
        if RUN is None or not os.path.exists(RUN):
            self.skipTest('no spar-run')
        machine = windio.read(model(), stations=(numpy.arange(8) + 0.5) / 8)
        machine.blade.elements = 1
        path = os.path.join(WORK, 'rotor.case')
        machine.write_case(path, 1.0, 2 * DEGREE, 8.0)
        with open(path, encoding='utf-8') as file:
            text = file.read()
        write('rotor.case', text.replace('do run', 'do static'))
        done = subprocess.run([RUN, path, '--out', path + '.out'], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr + done.stdout)
        with spar.Session() as session:
            rotor = machine.build(session, 1.0, 2 * DEGREE, rigid=True)
            rotor.start([8, 0, 0], 10)
            tip = rotor.blades[0].get_motion(v=None, a=None)[-1]
        table = numpy.genfromtxt(path + '.out/static.csv', delimiter=',', names=True, dtype=None, encoding='utf-8')
        self.assertGreater(abs(tip[0]), 0.05)
        last = table[[i for i, row in enumerate(table) if row[0] == 'blade1'][-1]]
        self.assertAlmostEqual(float(last['ux_m']), tip[0], delta=2e-3 * abs(tip[0]))


    def test_whole_case(self):
        """spar-run steps the whole turbine of a case file as the session here does: the top of the tower and the rotor's power."""
        if RUN is None or not os.path.exists(RUN):
            self.skipTest('no spar-run')
        machine = windio.read(model(), stations=(numpy.arange(8) + 0.5) / 8)
        machine.blade.elements = machine.tower.elements = 1
        path = os.path.join(WORK, 'whole.case')
        machine.write_case(path, 0.5, 1 * DEGREE, 8.0, torque=1e5)
        with open(path, encoding='utf-8') as file:
            text = file.read()
        write('whole.case', text.replace('duration 10', 'duration 1').replace('rtol 1e-4', 'rtol 1e-6'))
        done = subprocess.run([RUN, path, '--out', path + '.out'], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr + done.stdout)
        history = results.read_history(path + '.out/history.csv')
        with spar.Session() as session:
            session.set_coupling(spar.COUPLING_IQN_ILS, 1e-9, 1e-6, 50)
            session.set_integrator(0.9, 1)
            session.set_gravity([0, 0, -9.81])
            rotor = machine.build(session, 0.5, 1 * DEGREE)
            rotor.set_torque(1e5)
            rotor.blow([8, 0, 0])
            for _ in range(20):
                session.step(0.05, lambda *_: rotor.blow([8, 0, 0]))
            top = rotor.tower.get_motion(v=None, a=None)[-1]
            power = rotor.aero.get_rotor()[2]
        self.assertGreater(abs(top[0]), 1e-3)
        self.assertAlmostEqual(history['tower_ux'][1][-1], top[0], delta=1e-3 * abs(top[0]))
        self.assertAlmostEqual(history['rotor_power'][1][-1], power, delta=1e-3 * abs(power))


class Controller(unittest.TestCase):
    def regions(self):
        """Rated at half the power that 9 m/s could give."""
        machine = windio.read(model(), stations=(numpy.arange(8) + 0.5) / 8)
        machine.rated_speed, machine.rated_power = 2.5 * 9 / machine.tip_radius(), 0.5 * machine.steady(9.0, pitch=0.0)['power']
        return machine, controller.Regions(machine, winds=(9.5, 11.0))

    def measures(self, t, speed, pitch=0.0, dt=0.1):
        return controller.Measures(t, dt, speed, speed, 0.0, pitch)

    def test_torque(self):
        """At a constant speed: k speed^2 below rated, with k of the steady point at 70 % of it; power / speed above."""
        machine, control = self.regions()
        low = machine.steady(0.7 * machine.rated_speed * machine.tip_radius() / machine.tip_speed_ratio)
        self.assertAlmostEqual(low['speed'], 0.7 * machine.rated_speed, delta=1e-12)
        for speed, torque in ((0.7 * machine.rated_speed, low['torque']), (0.35 * machine.rated_speed, low['torque'] / 4),
                              (1.1 * machine.rated_speed, machine.rated_power / (1.1 * machine.rated_speed))):
            control.integral = None
            self.assertAlmostEqual(control.step(self.measures(0.0, speed))[1], torque, delta=1e-9 * torque)

    def test_speed(self):
        """A rotor of one degree of freedom, whose torque falls with the pitch as the turbine's at 9.5 m/s and stays with the speed:
        after a rise of its torque by 10 % it returns to the rated speed, and the pitch to where the torque is the generator's."""
        machine, control = self.regions()
        inertia, point = controller._inertia(machine), machine.steady(9.5)
        slope = control.proportional[0] / (2 * 0.8 * 0.2 * inertia)  # rad/(N m)
        speed, pitch, dt, most = machine.rated_speed, point['pitch'], 0.02, 0.0
        for step in range(6000):
            air = 1.1 * machine.rated_power / machine.rated_speed - (pitch - point['pitch']) / slope
            pitch, torque = control.step(self.measures(step * dt, speed, pitch, dt))
            speed += dt * (air - torque) / inertia
            most = max(most, speed)
        self.assertGreater(most, 1.001 * machine.rated_speed)
        self.assertAlmostEqual(speed, machine.rated_speed, delta=1e-3 * machine.rated_speed)
        want = point['pitch'] + 0.1 * machine.rated_power / machine.rated_speed * slope
        self.assertAlmostEqual(pitch, want, delta=0.02 * (want - point['pitch']))

    def test_inertia(self):
        """Three straight blades without cone: 3 m ((R + L)^3 - R^3) / 3, with the hub's and the generator's."""
        machine = windio.read(model())
        blades = MASS * ((machine.hub_radius + LENGTH)**3 - machine.hub_radius**3)
        machine.blade.section_eta = numpy.linspace(0, 1, 401)
        machine.blade.mass = numpy.repeat(machine.blade.mass[:1], 401, axis=0)
        want = blades + machine.hub[3, 3] + machine.generator_inertia
        self.assertAlmostEqual(controller._inertia(machine), want, delta=1e-5 * want)

    def test_library(self):
        """The published controller of the NREL 5-MW turbine behind DISCON: 0.0255764 N m/(rev/min)^2 below rated
        (NREL/TP-500-38060, table 7-1). A library that is missing, of another interface or fails is told in its own words."""
        library = os.path.join(WORK, 'libspar_test_discon.so')
        if not os.path.isfile(library):
            self.skipTest('no library of tests/examples/discon.c')
        speed = 100.0
        for word, said in (('follow', None), ('fail', 'generator too hot$'), ('nan', 'no number'), ('individual', 'switch individual pitch off')):
            control = controller.Library(library, write(f'{word}.in', word))
            answers = []
            try:
                for step in range(100):
                    answers.append(control.step(controller.Measures(0.02 * step, 0.02, speed / 97, speed, 0.0, 0.0)))
                self.assertIsNone(said)
                self.assertAlmostEqual(answers[-1][1], 0.0255764 * (speed * 30 / numpy.pi)**2, delta=1e-3 * answers[-1][1])
                self.assertEqual(answers[-1][0], 0)
            except controller.ControllerError as error:
                self.assertIsNotNone(said, str(error))
                self.assertRegex(str(error), said)
                self.assertGreater(len(answers), 20)
            control.close()
        for path, given, said in ((library, 'none.in', 'none.in is not there'), (os.path.join(WORK, 'none.so'), 'follow.in', 'none.so'),
                                  (os.path.join(WORK, 'libspar_test_other.so'), 'follow.in', 'no function DISCON')):
            with self.assertRaisesRegex(controller.ControllerError, said):
                controller.Library(path, os.path.join(WORK, given))


class Results(unittest.TestCase):
    """Files for other tools, taken apart by hand: the layout is that of OpenFAST's WrBinFAST."""

    def channels(self, name):
        t = 1 + 0.05 * numpy.arange(40)
        return {'Time': ('s', t), name: ('kW', 1e3 * numpy.sin(t)), 'Still': ('-', 0 * t + 3.25), 'Far': ('m', 1e6 + 1e-3 * t)}

    def test_outb(self):
        """Without compression: identifier 3, names of 10 characters, all digits."""
        path, made = os.path.join(WORK, 'run.outb'), self.channels('GenPwr')
        results.write(path, made, 'hello')
        with open(path, 'rb') as file:
            data = file.read()
        self.assertEqual(struct.unpack_from('<hiidd', data)[:4], (3, 3, 40, 1.0))
        self.assertAlmostEqual(struct.unpack_from('<hiidd', data)[4], 0.05, delta=1e-15)
        self.assertEqual(data[26:35], b'\x05\x00\x00\x00hello')
        self.assertEqual(data[35:115].decode().split(), ['Time', 'GenPwr', 'Still', 'Far', '(s)', '(kW)', '(-)', '(m)'])
        values = numpy.frombuffer(data, '<f8', offset=115).reshape(40, 3)
        numpy.testing.assert_array_equal(values, numpy.column_stack([v for _, v in list(made.values())[1:]]))

    def test_packed(self):
        """With a longer name: identifier 4, 16 bits, (value - offset) / scale; a channel far from 0 keeps 1e-7 of its size."""
        path, made = os.path.join(WORK, 'run.outb'), self.channels('GeneratorPower')
        results.write(path, made, '')
        with open(path, 'rb') as file:
            data = file.read()
        kind, width, count, rows = struct.unpack_from('<hhii', data)
        self.assertEqual((kind, width, count, rows), (4, 14, 3, 40))
        scale, offset = (numpy.frombuffer(data, '<f4', 3, at).astype(float) for at in (28, 40))
        self.assertEqual(data[56 + 14:56 + 28].decode(), 'GeneratorPower')
        packed = numpy.frombuffer(data, '<i2', offset=56 + 8 * 14).reshape(40, 3)
        found = (packed - offset) / scale
        for i, (name, bound) in enumerate((('GeneratorPower', 2e3 / 65535), ('Still', 1e-6), ('Far', 0.2))):
            self.assertLess(abs(found[:, i] - made[name][1]).max(), bound)

    def test_hdf5(self):
        """A data set for each channel, with its unit."""
        try:
            import h5py  # pylint: disable=import-outside-toplevel
        except ImportError:
            self.skipTest('no h5py')
        path, made = os.path.join(WORK, 'run.h5'), self.channels('Power')
        results.write(path, made)
        with h5py.File(path) as file:
            self.assertEqual((list(file['Power'][:]), file['Power'].attrs['unit']), (list(made['Power'][1]), 'kW'))

    def test_others(self):
        """CSV goes and comes; what does not fit is refused."""
        made = self.channels('Power')
        path = os.path.join(WORK, 'run.csv')
        results.write(path, made)
        with open(path, encoding='utf-8') as file:
            self.assertEqual(file.readline(), 'Time_(s),Power_(kW),Still_(-),Far_(m)\n')
        history = write('history.csv', 't_s,iterations,blade_ux_m,blade_My_Nm\n0,1,0.5,2e3\n0.1,2,0.6,3e3\n')
        read = results.read_history(history)
        self.assertEqual([(name, unit) for name, (unit, _) in read.items()], [('Time', 's'), ('iterations', '-'), ('blade_ux', 'm'), ('blade_My', 'Nm')])
        self.assertEqual(list(read['blade_My'][1]), [2e3, 3e3])
        made['Time'] = ('s', made['Time'][1]**2)
        with self.assertRaisesRegex(ValueError, 'even time steps'):
            results.write(os.path.join(WORK, 'run.outb'), made)
        with self.assertRaisesRegex(ValueError, 'ending must be one of .outb, .csv, .h5'):
            results.write(os.path.join(WORK, 'run.txt'), made)
        made['Power'] = ('kW', [1.0])
        with self.assertRaisesRegex(ValueError, 'each of one length'):
            results.write(path, made)


if __name__ == '__main__':
    unittest.main()
