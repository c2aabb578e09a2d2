"""Reads turbines and blades from the input files of OpenFAST: ElastoDyn, BeamDyn, AeroDyn.

    machine = spar.openfast.read('IEA-15-240-RWT-Monopile.fst')
    blade = spar.openfast.read_beamdyn('IEA-15-240-RWT_BeamDyn.dat')

BeamDyn's and AeroDyn's files are read by the library (spar.Member.read_beamdyn, spar.Aero.read_aerodyn); what is here reads ElastoDyn's
and the .fst file. Keys and columns are found by their names, so that files of different releases are read. Nothing beside numpy is
needed. What a file has and spar does not take is in `left_out`, and a warning names it once: platform and moorings, controllers, yaw,
teeter, and so on.
"""
import os

import numpy
import spar

from ._text import ModelError, Text, leading_numbers, number_of
from .turbine import Beam, Sections, Turbine, body_mass, read_by, tell, tube

_STEEL = (210e9, 7850.0)  # Pa, kg/m^3: of towers, whose files have bending stiffness and mass alone
# What spar does not take, by key, where its value is neither 0 nor False
_MODULES = {'CompInflow': 'InflowWind', 'CompServo': 'ServoDyn', 'CompSeaSt': 'SeaState', 'CompHydro': 'HydroDyn',
            'CompSub': {1: 'SubDyn', 2: 'ExtPtfm'}, 'CompMooring': {1: 'MAP++', 2: 'FEAMooring', 3: 'MoorDyn', 4: 'OrcaFlex'},
            'CompIce': {1: 'IceFloe', 2: 'IceDyn'}, 'CompSoil': 'SoilDyn'}
_PARTS = {'PtfmMass': 'mass of the platform', 'PtfmRIner': 'inertia of the platform', 'TeetMod': 'teeter', 'UndSling': 'undersling',
          'Furling': 'furling', 'TipMass(1)': 'tip brakes'}
_AIR = {'TwrPotent': 'flow around the tower', 'TwrShadow': 'shadow of the tower', 'TwrAero': 'loads on the tower', 'CavitCheck': 'cavitation',
        'Buoyancy': 'buoyancy', 'NacelleDrag': 'drag of the nacelle', 'CompAA': 'noise', 'TFinAero': 'tail fin'}


class File(Text):
    """An input file of OpenFAST: values by key."""

    def __init__(self, path):
        super().__init__(path)
        self.where = {}
        for i, line in enumerate(self.lines):
            words = line.replace('"', ' " ').split() if line.count('"') < 2 else [line.split('"')[1], *line.split('"')[2].split()]
            if len(words) > 1:
                self.where.setdefault(words[1].lower(), []).append((i, words[0]))

    def find(self, *names, numbers=False):
        """Line (from 0) and value of a key by one of its names; None: it is not there. Headings have no values.
        numbers: values that are none are taken if there are no others"""
        for name in names:
            found = [one for one in self.where.get(name.lower(), ()) if not one[1].startswith(('---', '==='))]
            found = numbers and [one for one in found if number_of(one[1]) is not None] or found
            if found:
                other = next((one for one in found if one[1] != found[0][1]), None)
                if other:
                    self.fail(f'{name} is {found[0][1]} in line {found[0][0] + 1} and {other[1]} here; leave one of them', other[0])
                return found[0]
        return None

    def text(self, *names, otherwise=None):
        """The value of a key by one of its names."""
        found = self.find(*names)
        if found is None and otherwise is None:
            self.fail(f'it has no {names[0]}; is it a file of this module?')
        return found[1] if found else otherwise

    def number(self, *names, otherwise=None, low=None, high=None, whole=False):
        """The same, a number in a range."""
        found = self.find(*names, numbers=True)
        if found is None:
            return float(self.text(*names, otherwise=otherwise))
        value = number_of(found[1])
        if value is None or (whole and value != int(value)):
            self.fail(f'{names[0]} is {found[1]}; give a {"whole " if whole else ""}number', found[0])
        return self.check(value, names[0], found[0], low, high)

    def file(self, *names):
        """A file that is named here, relative to this one."""
        return self.beside(self.text(*names))

    def table(self, key, *names):
        """Columns of the table that follows a key, by their headings: a line of these, one of units, then as many rows as the key says.
        Answers columns [names][rows] and the line of the first row. The first column goes from 0 to 1."""
        count = int(self.number(key, low=2, high=1e5, whole=True))
        at = self.find(key)[0]
        head = next((i for i in range(at + 1, len(self.lines)) if self.lines[i].split()[:1] and
                     self.lines[i].split()[0].lower() == names[0].lower()), None)
        if head is None:
            self.fail(f'{key} is followed by no line of headings that begins with {names[0]}', at)
        headings = [word.lower() for word in self.lines[head].split()]
        missing = [name for name in names if name.lower() not in headings]
        if missing:
            self.fail(f'the table has no column {missing[0]}; it needs {", ".join(names)}', head)
        rows, first = [], head + 2
        for i in range(first, first + count):
            rows.append(leading_numbers(self.lines[i] if i < len(self.lines) else '')[:len(headings)])
            if len(rows[-1]) < len(headings):
                self.fail(f'{key} promises {count} rows of {len(headings)} numbers, and {i - first} follow', min(i, len(self.lines) - 1))
        if first + count < len(self.lines) and len(leading_numbers(self.lines[first + count])) >= len(headings):
            self.fail(f'a row follows the last one; {key} is {count}: correct it, or remove the rows', first + count)
        columns = numpy.array(rows)[:, [headings.index(name.lower()) for name in names]].T
        for i, value in enumerate(columns[0]):
            if (i == 0 and abs(value) > 1e-5) or (i and value <= columns[0][i - 1]) or (i == count - 1 and abs(value - 1) > 1e-5):
                self.fail(f'{names[0]} is {value:g}; it must increase from 0 to 1', first + i)
        return columns, first

    def positive(self, columns, names, first):
        """Refuses what is not above 0."""
        for name, column in zip(names, columns):
            for i in numpy.flatnonzero(~(column > 0)):
                self.fail(f'{name} is {column[i]:g}; give a number above 0', first + int(i))


def read_beamdyn(path, blade_path=None):
    """A blade of BeamDyn's primary file and blade file, by the library's reader.
    Damping ratios of modes (damp_type 2) become stiffness- and mass-proportional damping that meets them as well as it can.
    blade_path: None: the file that the primary one names"""
    primary = File(path)
    with spar.Session() as session:
        member = session.beam_create('blade', Beam.elements, Beam.nodes)
        read_by(member.read_beamdyn, path, blade_path)
        _, eta, xyz, twist = member.get_axis()
        _, at, stiffness, mass = member.get_sections()
        blade = Beam('blade', eta, xyz, twist, at, stiffness.reshape(-1, 6, 6), mass.reshape(-1, 6, 6), member.get_damping())
        properties = File(blade_path or primary.file('BldFile'))
        if properties.number('damp_type') == 2:
            read_by(member.commit, path=path)
            line = properties.find('n_modes')[0] + 1
            ratio = numpy.array(leading_numbers(properties.lines[line])[:int(properties.number('n_modes'))])
            modes = numpy.flatnonzero(ratio > 0)
            if len(modes):
                read_by(member.fit_damping, modes, ratio[modes], path=path)
            blade.damping, blade.mass_damping = member.get_damping(), member.get_mass_damping()
    if primary.text('UsePitchAct', otherwise='F').lower().lstrip('.').startswith('t'):
        blade.left_out = ['pitch actuator (UsePitchAct)']
    tell(path, blade.left_out)
    return blade


def _damped(file, beam, ratio):
    """The beam with a damping ratio, for which it is solved."""
    return read_by(beam.damped, ratio, path=file.path)


def read_elastodyn_blade(path, length):
    """A blade of ElastoDyn's blade file: straight, with flapwise and edgewise bending about the structural twist. It has no torsion and
    no extension, so both are ten times stiffer here than they could count.
    length: m, TipRad less HubRad"""
    file = File(path)
    names = ('BlFract', 'StrcTwst', 'BMassDen', 'FlpStff', 'EdgStff')
    (eta, twist, density, flap, edge), first = file.table('NBlInpSt', *names)
    file.positive((density, flap, edge), names[2:], first)
    for i in numpy.flatnonzero(abs(twist) > 180):
        file.fail(f'StrcTwst is {twist[i]:g}; give degrees, -180 to 180', first + int(i))
    density = density * file.number('AdjBlMs', otherwise=1.0, low=1e-6)
    flap, edge = flap * file.number('AdjFlSt', otherwise=1.0, low=1e-6), edge * file.number('AdjEdSt', otherwise=1.0, low=1e-6)
    stiffness, mass = numpy.zeros((len(eta), 6, 6)), numpy.zeros((len(eta), 6, 6))
    stiff = 10 * (flap + edge)
    for i, values in enumerate((stiff, stiff, stiff, stiff, edge, flap)):  # y is flapwise: bending about it is edgewise
        stiffness[:, i, i] = values
    for i in range(3):
        mass[:, i, i], mass[:, 3 + i, 3 + i] = density, 1e-3 * density
    mass[:, 3, 3] = 2e-3 * density
    points = numpy.column_stack([eta * length, 0 * eta, 0 * eta])
    ratio = file.number('BldFlDmp(1)', 'BldFlDmp1', otherwise=0.0, low=0, high=99) / 100
    return _damped(file, Beam('blade', eta, points, -numpy.radians(twist), eta, stiffness, mass), ratio)


def read_elastodyn_tower(path, height):
    """A tower of ElastoDyn's tower file: a thin tube of steel with its mass and bending stiffness.
    height: m, TowerHt less TowerBsHt"""
    file = File(path)
    names = ('HtFract', 'TMassDen', 'TwFAStif', 'TwSSStif')
    (eta, density, fore, side), first = file.table('NTwInpSt', *names)
    file.positive((density, fore, side), names[1:], first)
    density = density * file.number('AdjTwMa', otherwise=1.0, low=1e-6)
    fore, side = fore * file.number('AdjFASt', otherwise=1.0, low=1e-6), side * file.number('AdjSSSt', otherwise=1.0, low=1e-6)
    mean = (fore + side) / 2
    square = 2 * mean * _STEEL[1] / (_STEEL[0] * density)  # EI = E A r^2 / 2
    stiffness, mass = tube(2 * numpy.sqrt(square), mean, mean / 1.3, density)
    stiffness[:, 4, 4], stiffness[:, 5, 5] = side, fore  # y is downwind: bending about z is fore-aft
    points = numpy.column_stack([eta * height, 0 * eta, 0 * eta])
    beam = Beam('tower', eta, points, 0 * eta, eta, stiffness, mass, nodes=6)
    return _damped(file, beam, file.number('TwrFADmp(1)', 'TwrFADmp1', otherwise=0.0, low=0, high=99) / 100)


def _nacelle(file):
    """6x6 mass about the tower's top."""
    mass, inertia = file.number('NacMass', low=0), file.number('NacYIner', low=0)
    centre = [file.number(f'NacCM{k}n', low=-1e3, high=1e3) for k in 'xyz']
    level = inertia - mass * (centre[0] ** 2 + centre[1] ** 2)  # about the centre of mass
    if level < 0:
        file.fail(f'NacYIner is {inertia:g}, less than that of the nacelle\'s mass at its centre', file.find('NacYIner')[0])
    return body_mass(mass, centre, numpy.diag([level] * 3)) + body_mass(file.number('YawBrMass', otherwise=0.0, low=0))


def _on(file, names):
    """Names what is on in a file."""
    for key, text in names.items():
        found = file.find(key)
        if found and number_of(found[1]) != 0 and found[1].lower() not in ('false', '"default"', 'default'):
            yield f'{text} ({key} {found[1]})'


def _alike(file, blades):
    """Names what differs from blade to blade, of which the first is taken."""
    for stem in ('PreCone', 'BldFile'):
        first = file.find(f'{stem}(1)', f'{stem}1')
        for b in range(2, blades + 1):
            other = file.find(f'{stem}({b})', f'{stem}{b}')
            if first and other and (other[1] != first[1] if number_of(first[1]) is None else number_of(other[1]) != number_of(first[1])):
                yield f'{stem}({b}) {other[1]} (all blades are as the first one, {first[1]})'


def read_elastodyn(path, blade=None, hanging=False):
    """A turbine of ElastoDyn's primary file.
    blade: a Beam, None: that of ElastoDyn's blade file
    hanging: of a floating marine turbine (MHK 2), whose tower goes down from the platform"""
    file = File(path)
    degrees, blades = numpy.pi / 180, int(file.number('NumBl', otherwise=3, low=1, high=3, whole=True))
    hub_radius = file.number('HubRad', low=0)
    tip = file.number('TipRad', low=1e-3, high=1e3)
    if tip <= hub_radius:
        file.fail(f'TipRad is {tip:g}, and HubRad is {hub_radius:g}; the tip lies beyond the hub', file.find('TipRad')[0])
    tilt, over = -file.number('ShftTilt', low=-90, high=90) * degrees, -file.number('OverHang', low=-1e3, high=1e3)
    base, top = (file.number(key, low=-1e3, high=1e3) for key in ('TowerBsHt', 'TowerHt'))
    if (top <= base) != hanging or top == base:
        file.fail(f'TowerHt is {top:g} and TowerBsHt is {base:g}; the tower goes ' + ('down, as MHK is 2' if hanging else
                  'up (one that goes down is read from an .fst file with MHK 2)'), file.find('TowerHt')[0])
    if blade is None:
        blade = read_elastodyn_blade(file.file('BldFile(1)', 'BldFile1'), tip - hub_radius)
    nacelle, iner = _nacelle(file), file.number('HubIner', low=0)
    hub = body_mass(file.number('HubMass', low=0), [file.number('HubCM', low=-1e3, high=1e3), 0, 0], numpy.diag([iner] * 3))
    return Turbine(name=os.path.basename(file.path), blade=blade, blades=blades, hub_radius=hub_radius,
                   cone=-file.number('PreCone(1)', low=-90, high=90) * degrees, tilt=tilt, overhang=over * numpy.cos(tilt),
                   shaft_height=file.number('Twr2Shft', low=-1e3, high=1e3) + over * numpy.sin(tilt), hub=hub, nacelle=nacelle,
                   generator_inertia=file.number('GenIner', low=0) * file.number('GBRatio', otherwise=1.0, low=1e-4, high=1e4) ** 2,
                   drivetrain=(file.number('DTTorSpr', low=0), file.number('DTTorDmp', low=0)),
                   tower=read_elastodyn_tower(file.file('TwrFile'), abs(top - base)), tower_base=base, hanging=hanging,
                   left_out=[*_on(file, _PARTS), *_alike(file, blades), *blade.left_out])


def read_aerodyn(path, blade, blade_path=None, stations=None):
    """Blade elements of AeroDyn's primary file, its first blade and its airfoils, by the library's reader.
    blade: the Beam; stations: eta[n] in (0, 1), None: 30 in the middle of equal lengths"""
    stations = (numpy.arange(30) + 0.5) / 30 if stations is None else numpy.asarray(stations, float)
    span = numpy.interp(stations, blade.eta, blade.points[:, 0])
    with spar.Session() as session:
        member = session.beam_create(blade.name, blade.elements, blade.nodes)  # its line is what matters
        member.set_axis(blade.eta, blade.points, blade.twist)
        member.set_sections([0], [numpy.eye(6)], [numpy.eye(6)])
        member.set_fidelity(spar.FIDELITY_PRESCRIBED, 0)
        read_by(member.commit, path=path)
        air, ends = member.fluid_create('air'), member.fluid_create('ends')
        read_by(ends.read_aerodyn, path, blade_path)
        read_by(ends.map, path=path)
        out = ends.get_nearest(0)[2][-1]
        if ends.get_map(0)[0][-1] < 0.98 or numpy.linalg.norm(out) > 0.1 * blade.length():
            raise ModelError(f'{path}: its last station and the tip of the blade (BlSpn {blade.points[-1, 0]:g} m) are not at one place; '
                             'is it of another blade, or in another unit?')
        read_by(air.read_aerodyn, path, blade_path, None, span)
        read_by(air.map, path=path)
        aero = read_by(spar.Aero, [air], path=path)
        read_by(aero.read_aerodyn, path, blade_path, None, span)
        eta, (_, q, arm), (chord, twist) = air.get_map(0)[0], air.get_nearest(0), aero.get_chord()
        polars = [aero.get_polar(i)[1:] for i in range(len(span))]
    w, v = q[:, :1], -q[:, 1:]  # the arm in the section's own axes
    arm = arm + 2 * numpy.cross(v, numpy.cross(v, arm) + w * arm)
    turn = twist - numpy.interp(eta, blade.eta, blade.twist) + numpy.pi / 2
    return Sections(eta, chord, (turn + numpy.pi) % (2 * numpy.pi) - numpy.pi, arm[:, 1:], [list(p[:4]) for p in polars],
                    [p[4] for p in polars])


def _density(file, aero):
    """Of the air or the water: AeroDyn's own one, else that of the .fst file."""
    key = 'WtrDens' if file.number('MHK', otherwise=0) else 'AirDens'
    for one in (aero, file):
        if one and one.text('AirDens' if one is aero else key, otherwise='default').lower() != 'default':
            return one.number('AirDens' if one is aero else key, low=0)
    return 1025.0 if key == 'WtrDens' else 1.225


def read(path, beamdyn=None):
    """The turbine of an .fst file. Its blades are BeamDyn's where CompElast is 2, else ElastoDyn's. A marine turbine (MHK 1 or 2) turns
    in water, without its buoyancy and added mass.
    beamdyn: path of BeamDyn's primary file, which is then taken"""
    file = File(path)
    mhk = int(file.number('MHK', otherwise=0, low=0, high=2, whole=True))
    if file.number('NRotors', otherwise=1, whole=True) != 1:
        file.fail('NRotors is not 1; turbines of one rotor are read', file.find('NRotors')[0])
    if beamdyn is None and file.number('CompElast', low=1, high=2, whole=True) == 2:
        beamdyn = file.file('BDBldFile(1)', 'BDBldFile1')
    machine = read_elastodyn(file.file('EDFile'), read_beamdyn(beamdyn) if beamdyn else None, mhk == 2)
    aero = None
    if file.number('CompAero', otherwise=0, whole=True):
        aero = File(file.file('AeroFile'))
        machine.sections = read_aerodyn(aero.path, machine.blade)
        machine.left_out += _on(aero, _AIR)
    machine.air_density = _density(file, aero)
    for key, names in _MODULES.items():
        kind = int(file.number(key, otherwise=0, whole=True))
        if kind:
            machine.left_out.append(f'{names.get(kind, names) if isinstance(names, dict) else names} ({key} {kind})')
    if mhk:
        machine.left_out.append(f'buoyancy and added mass under water (MHK {mhk})')
    tell(path, machine.left_out)
    return machine
