"""Reads turbines and blades from the input files of OpenFAST: ElastoDyn, BeamDyn, AeroDyn.

    machine = spar.openfast.read('IEA-15-240-RWT-Monopile.fst')
    blade = spar.openfast.read_beamdyn('IEA-15-240-RWT_BeamDyn.dat')

Keys are found by their names, so that files of different releases are read. Nothing beside numpy is needed. Not taken: platform and
moorings, controllers, yaw and teeter, tuned mode shapes.
"""
import os

import numpy

from .turbine import Beam, ModelError, Sections, Turbine, body_mass, reorder, tube

_STEEL = (210e9, 7850.0)  # Pa, kg/m^3: of towers, whose files have bending stiffness and mass alone


class File:
    """An input file: its lines, and values by key."""

    def __init__(self, path):
        self.path, self.folder = os.fspath(path), os.path.dirname(os.fspath(path))
        with open(path, encoding='utf-8', errors='replace') as file:
            self.lines = file.read().splitlines()
        self.where = {}
        for i, line in enumerate(self.lines):
            words = line.replace('"', ' " ').split() if line.count('"') < 2 else [line.split('"')[1], *line.split('"')[2].split()]
            if len(words) > 1:
                self.where.setdefault(words[1].lower(), (i, words[0]))

    def fail(self, what):
        """An error of this file."""
        raise ModelError(f'{self.path}: {what}')

    def text(self, *names, otherwise=None):
        """The value of a key by one of its names."""
        for name in names:
            if name.lower() in self.where:
                return self.where[name.lower()][1]
        if otherwise is None:
            self.fail(f'it has no {names[0]}; is it a file of this module?')
        return otherwise

    def number(self, *names, otherwise=None):
        """The same, a number."""
        value = self.text(*names, otherwise=otherwise)
        try:
            return float(str(value).lower().replace('d', 'e'))
        except ValueError:
            return self.fail(f'{names[0]} is {value}, which is not a number')

    def file(self, *names):
        """A file that is named here, relative to this one."""
        return os.path.join(self.folder, self.text(*names).strip('"').replace('\\', '/'))

    def table(self, key, columns, rows=None):
        """Rows of numbers that follow a key and lines of text; rows: how many, None: the number at the key."""
        if key.lower() not in self.where:
            self.fail(f'it has no {key}')
        count, found = rows or int(float(self.where[key.lower()][1])), []
        for line in self.lines[self.where[key.lower()][0] + 1:]:
            try:
                found.append([float(word) for word in line.split()[:columns]])
            except ValueError:
                if found:
                    break
                continue
            if len(found[-1]) < columns:
                found.pop()
                if found:
                    break
            if len(found) == count:
                break
        if len(found) != count:
            self.fail(f'{key} promises {count} rows of {columns} numbers, and {len(found)} follow')
        return numpy.array(found)


def _spline(x, y, to):
    """Natural cubic spline through (x, y[n][k]) at points."""
    h, n = numpy.diff(x), len(x)
    a, b = numpy.eye(n), numpy.zeros_like(y)
    for i in range(1, n - 1):
        a[i, i - 1:i + 2] = h[i - 1], 2 * (h[i - 1] + h[i]), h[i]
        b[i] = 6 * ((y[i + 1] - y[i]) / h[i] - (y[i] - y[i - 1]) / h[i - 1])
    m = numpy.linalg.solve(a, b)
    i = numpy.clip(numpy.searchsorted(x, to) - 1, 0, n - 2)
    s, d = (to - x[i])[:, None], h[i][:, None]
    slope = (y[i + 1] - y[i]) / d - d * (2 * m[i] + m[i + 1]) / 6
    return y[i] + s * slope + s**2 * m[i] / 2 + s**3 * (m[i + 1] - m[i]) / (6 * d)


def read_beamdyn(path, blade_path=None):
    """A blade of BeamDyn's primary file and blade file. Key points are connected by natural cubic splines, as in BeamDyn.
    blade_path: None: the file that the primary one names"""
    primary = File(path)
    total = int(primary.number('kp_total'))
    if primary.number('member_total') != 1:
        primary.fail('it has several members; blades of one member are read here, others by spar.Member.read_beamdyn')
    key = primary.table('kp_total', 4, total)
    z = numpy.unique(numpy.concatenate([key[:, 2], numpy.linspace(key[0, 2], key[-1, 2], 8 * total)]))
    points = _spline(key[:, 2], key[:, [0, 1, 3]], z)
    xyz = numpy.column_stack([z, points[:, 0], points[:, 1]])
    along = numpy.concatenate([[0], numpy.cumsum(numpy.linalg.norm(numpy.diff(xyz, axis=0), axis=1))])
    blade = File(blade_path or primary.file('BldFile'))
    count = int(blade.number('station_total'))
    start = next((i for i, line in enumerate(blade.lines) if 'DISTRIBUTED' in line.upper()), None)
    if start is None:
        blade.fail('it has no distributed properties')
    numbers = []
    for line in blade.lines[start + 1:]:
        try:
            numbers += [float(word) for word in line.split()]
        except ValueError:
            break
    if len(numbers) != 73 * count:
        blade.fail(f'station_total is {count}, which needs {73 * count} numbers; {len(numbers)} follow')
    rows = numpy.array(numbers).reshape(count, 73)
    damping = numpy.zeros(6)
    if blade.number('damp_type'):
        damping = blade.table('damp_type', 6, 1)[0][[2, 0, 1, 5, 3, 4]]
    stiffness = reorder(rows[:, 1:37].reshape(-1, 6, 6))
    return Beam('blade', along / along[-1], xyz, -numpy.radians(points[:, 2]), rows[:, 0],
                (stiffness + stiffness.transpose(0, 2, 1)) / 2, reorder(rows[:, 37:].reshape(-1, 6, 6)), damping)


def read_elastodyn_blade(path, length):
    """A blade of ElastoDyn's blade file: straight, with flapwise and edgewise bending about the structural twist. It has no torsion and
    no extension, so both are ten times stiffer here than they could count.
    length: m, TipRad less HubRad"""
    file = File(path)
    table = file.table('NBlInpSt', 6)
    eta, twist = table[:, 0], -numpy.radians(table[:, 2])
    density = table[:, 3] * file.number('AdjBlMs', otherwise=1.0)
    flap, edge = table[:, 4] * file.number('AdjFlSt', otherwise=1.0), table[:, 5] * file.number('AdjEdSt', otherwise=1.0)
    stiffness, mass = numpy.zeros((len(eta), 6, 6)), numpy.zeros((len(eta), 6, 6))
    stiff = 10 * (flap + edge)
    for i, values in enumerate((stiff, stiff, stiff, stiff, edge, flap)):  # y is flapwise: bending about it is edgewise
        stiffness[:, i, i] = values
    for i in range(3):
        mass[:, i, i], mass[:, 3 + i, 3 + i] = density, 1e-3 * density
    mass[:, 3, 3] = 2e-3 * density
    points = numpy.column_stack([eta * length, 0 * eta, 0 * eta])
    ratio = file.number('BldFlDmp(1)', 'BldFlDmp1', otherwise=0.0) / 100
    return Beam('blade', eta, points, twist, eta, stiffness, mass).damped(ratio)


def read_elastodyn_tower(path, height):
    """A tower of ElastoDyn's tower file: a thin tube of steel with its mass and bending stiffness.
    height: m, TowerHt less TowerBsHt"""
    file = File(path)
    table = file.table('NTwInpSt', 4)
    density = table[:, 1] * file.number('AdjTwMa', otherwise=1.0)
    bending = table[:, 2] * file.number('AdjFASt', otherwise=1.0), table[:, 3] * file.number('AdjSSSt', otherwise=1.0)
    mean = (bending[0] + bending[1]) / 2
    square = 2 * mean * _STEEL[1] / (_STEEL[0] * density)  # EI = E A r^2 / 2
    stiffness, mass = tube(2 * numpy.sqrt(square), mean, mean / 1.3, density)
    stiffness[:, 4, 4], stiffness[:, 5, 5] = bending[1], bending[0]  # y is downwind: bending about z is fore-aft
    points = numpy.column_stack([table[:, 0] * height, 0 * density, 0 * density])
    beam = Beam('tower', table[:, 0], points, 0 * density, table[:, 0], stiffness, mass, nodes=6)
    return beam.damped(file.number('TwrFADmp(1)', 'TwrFADmp1', otherwise=0.0) / 100)


def read_elastodyn(path, blade=None):
    """A turbine of ElastoDyn's primary file.
    blade: a Beam, None: that of ElastoDyn's blade file"""
    file = File(path)
    degrees = numpy.pi / 180
    hub_radius = file.number('HubRad')
    if file.number('OverHang') > 0:
        file.fail('OverHang is positive: only upwind rotors are read')
    tilt, over = -file.number('ShftTilt') * degrees, -file.number('OverHang')
    if blade is None:
        blade = read_elastodyn_blade(file.file('BldFile(1)', 'BldFile1'), file.number('TipRad') - hub_radius)
    base, gear = file.number('TowerBsHt'), file.number('GBRatio', otherwise=1.0)
    centre = [file.number(f'NacCM{k}n') for k in 'xyz']
    level = file.number('NacYIner') - file.number('NacMass') * (centre[0] ** 2 + centre[1] ** 2)  # about the centre of mass
    if level < 0:
        file.fail(f'NacYIner is {file.number("NacYIner"):g}, less than that of the nacelle\'s mass at its centre')
    nacelle = body_mass(file.number('NacMass'), centre, numpy.diag([level] * 3))
    nacelle = nacelle + body_mass(file.number('YawBrMass', otherwise=0.0))
    iner = file.number('HubIner')
    hub = body_mass(file.number('HubMass'), [file.number('HubCM'), 0, 0], numpy.diag([iner] * 3))
    return Turbine(name=os.path.basename(file.path), blade=blade, blades=int(file.number('NumBl', otherwise=3)),
                   hub_radius=hub_radius, cone=-file.number('PreCone(1)') * degrees, tilt=tilt, overhang=over * numpy.cos(tilt),
                   shaft_height=file.number('Twr2Shft') + over * numpy.sin(tilt), hub=hub, nacelle=nacelle,
                   generator_inertia=file.number('GenIner') * gear**2,
                   drivetrain=(file.number('DTTorSpr'), file.number('DTTorDmp')),
                   tower=read_elastodyn_tower(file.file('TwrFile'), file.number('TowerHt') - base), tower_base=base)


def read_airfoil(path):
    """alpha (rad), cl, cd, cm of the first table of an airfoil file; cm is 0 where it has none."""
    file = File(path)
    count = int(file.number('NumAlf'))
    try:
        rows = file.table('NumAlf', 4, count)
    except ModelError:
        rows = numpy.column_stack([file.table('NumAlf', 3, count), numpy.zeros(count)])
    return [numpy.radians(rows[:, 0]), *rows[:, 1:].T]


def read_aerodyn(path, blade, blade_path=None, stations=None):
    """Blade elements of AeroDyn's primary file, its first blade and its airfoils.
    blade: the Beam; stations: eta[n] in (0, 1), None: 30 in the middle of equal lengths"""
    file = File(path)
    first, count = file.where.get('numaffiles', (None,))[0], int(file.number('NumAFfiles'))
    if first is None:
        file.fail('it has no NumAFfiles')
    names = [line.split('"')[1] if '"' in line else line.split()[0] for line in file.lines[first + 1:first + 1 + count]]
    foils = [read_airfoil(os.path.join(file.folder, name.replace('\\', '/'))) for name in names]
    rows = File(blade_path or file.file('ADBlFile(1)', 'ADBlFile1')).table('NumBlNds', 7)
    stations = (numpy.arange(30) + 0.5) / 30 if stations is None else numpy.asarray(stations, float)
    span = numpy.interp(stations, blade.eta, blade.points[:, 0])

    def at(column):
        return numpy.interp(span, rows[:, 0], rows[:, column])
    polars = []
    for s in span:
        i = int(numpy.clip(numpy.searchsorted(rows[:, 0], s), 1, len(rows) - 1))
        part = float(numpy.clip((s - rows[i - 1, 0]) / (rows[i, 0] - rows[i - 1, 0]), 0, 1))
        pair = foils[int(rows[i - 1, 6]) - 1], foils[int(rows[i, 6]) - 1]
        alpha = numpy.unique(numpy.round(numpy.concatenate([pair[0][0], pair[1][0]]), 9))
        if alpha[-1] - alpha[0] > 2 * numpy.pi - 1e-6:
            alpha[0], alpha[-1] = -numpy.pi, numpy.pi
        values = [(1 - part) * numpy.interp(alpha, pair[0][0], a) + part * numpy.interp(alpha, pair[1][0], b)
                  for a, b in zip(pair[0][1:], pair[1][1:])]
        polars.append([alpha, *values])
    if file.text('UseBlCm', otherwise='True').lower().startswith('f'):
        for polar in polars:
            polar[3] = 0 * polar[0]
    away = numpy.column_stack([at(k + 1) - numpy.interp(stations, blade.eta, blade.points[:, k + 1]) for k in (0, 1)])
    turn = numpy.interp(stations, blade.eta, blade.twist)
    centre = numpy.column_stack([numpy.cos(turn) * away[:, 0] + numpy.sin(turn) * away[:, 1],
                                 numpy.cos(turn) * away[:, 1] - numpy.sin(turn) * away[:, 0]])
    return Sections(stations, at(5), numpy.radians(at(4)), centre, polars)


def read(path, beamdyn=None):
    """The turbine of an .fst file. Its blades are BeamDyn's where CompElast is 2, else ElastoDyn's.
    beamdyn: path of BeamDyn's primary file, which is then taken"""
    file = File(path)
    if beamdyn is None and file.number('CompElast') == 2:
        beamdyn = file.file('BDBldFile(1)', 'BDBldFile1')
    machine = read_elastodyn(file.file('EDFile'), read_beamdyn(beamdyn) if beamdyn else None)
    if file.number('CompAero', otherwise=0):
        aero = file.file('AeroFile')
        machine.sections = read_aerodyn(aero, machine.blade)
    density = file.text('AirDens', otherwise='1.225')
    machine.air_density = float(density) if density.lower() != 'default' else 1.225
    return machine
