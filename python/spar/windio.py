"""Reads wind turbines of windIO (https://windio.readthedocs.io), versions 1 and 2, and those that WISDEM writes in its own dialect.

    machine = spar.windio.read('IEA-15-240-RWT.yaml')

Taken are the blade's line, twist, 6x6 matrices and airfoils, the tower (6x6 or bending, torsion and mass, or one layer), hub,
drivetrain, yaw, and of the control the rated values. Most files of version 1 have no masses of hub and nacelle: the blade and the
geometry are read. What a file has and spar does not take is in `left_out`, and a warning names it once.
The tower stands on a rigid base: monopile and floater are not read.
Matrices are in the axes that the files of IEA-15 and IEA-22 use, which are BeamDyn's: x to the suction side, y to the trailing edge,
z to the tip, so K44 is the edgewise bending stiffness. (The schema's text says otherwise.)
Needs PyYAML. Files are read as YAML 1.2 has it: 2.1E11 is a number.
"""
import os
import re
import warnings

import numpy

from ._text import ModelError, read_lines
from .turbine import Beam, Sections, Turbine, body_mass, fill_shear, reorder, sections_fault, tell, tube

_PAIRS = [(i, j) for i in range(1, 7) for j in range(i, 7)]
_DEGREE = numpy.pi / 180
_FOUNDATIONS = ('monopile', 'jacket', 'floating_platform')
_TAKEN = {'': {'name', 'comments', 'description', 'windIO_version', 'assembly', 'components', 'airfoils', 'materials', 'control',
               'environment', 'costs', 'bos'},
          'components': {'blade', 'hub', 'nacelle', 'drivetrain', 'yaw', 'tower'},
          'control': {'rated_rotor_speed', 'optimal_tsr', 'min_pitch_table', 'supervisory', 'torque', 'pitch'}}


# ---- the file ----

class _Map(dict):
    """A mapping of the file, with the line of each key."""

    def __init__(self):
        super().__init__()
        self.lines = {}


def _loader():
    """A loader of PyYAML by YAML 1.2's rules: floats without a sign in the exponent, anchors that are given again, no key twice."""
    try:
        import yaml  # pylint: disable=import-outside-toplevel
    except ImportError:
        raise ImportError('spar.windio needs PyYAML: pip install PyYAML') from None
    parts = (yaml.cyaml.CParser,) if yaml.__with_libyaml__ else (yaml.reader.Reader, yaml.scanner.Scanner, yaml.parser.Parser)

    class Loader(yaml.composer.Composer, *parts, yaml.constructor.SafeConstructor, yaml.resolver.Resolver):
        """The parser of C where there is one, the rest in Python."""

        def __init__(self, text):
            for part in (*parts, yaml.composer.Composer, yaml.constructor.SafeConstructor, yaml.resolver.Resolver):
                part.__init__(self, *((text,) if part is parts[0] else ()))

        def compose_node(self, parent, index):
            """The next node; an anchor may be given again."""
            event = self.peek_event()
            if not isinstance(event, yaml.AliasEvent):
                self.anchors.pop(getattr(event, 'anchor', None), None)
            return super().compose_node(parent, index)

        def mapping(self, node):
            """A mapping whose keys know their lines."""
            data, own = _Map(), set()
            yield data
            for key, _ in node.value:
                name = self.construct_object(key, deep=True)
                if not isinstance(name, (str, int, float)) or (name in own and name != '<<'):
                    raise yaml.constructor.ConstructorError(None, None, f'{name} is given twice, or is no key', key.start_mark)
                own.add(name)
            self.flatten_mapping(node)
            for key, value in node.value:
                name = self.construct_object(key, deep=True)
                data[name], data.lines[name] = self.construct_object(value), key.start_mark.line + 1

    Loader.yaml_implicit_resolvers = {k: list(v) for k, v in yaml.resolver.Resolver.yaml_implicit_resolvers.items()}
    Loader.add_implicit_resolver('tag:yaml.org,2002:float', re.compile(r'^[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)[eE][-+]?[0-9]+$'),
                                 list('-+.0123456789'))
    Loader.add_constructor('tag:yaml.org,2002:map', Loader.mapping)
    return yaml, Loader


def load(path):
    """The file as it stands, as dictionaries and lists."""
    yaml, loader = _loader()
    try:
        return loader('\n'.join(read_lines(path))).get_single_data()
    except (yaml.YAMLError, RecursionError, ValueError) as error:
        if isinstance(error, ModelError):
            raise
        mark = getattr(error, 'problem_mark', None)
        what = getattr(error, 'problem', None) or str(error) or 'it nests too deeply'
        raise ModelError(f'{os.fspath(path)}{f", line {mark.line + 1}" if mark else ""}: it is no YAML that is read: {what}') from None


class Part:
    """A mapping of the file: its entries, and refusals that name file, line, field, value and cure."""

    def __init__(self, data, name='', path='windIO'):
        self.data, self.name, self.path = data, name, path
        if not isinstance(data, dict):
            raise ModelError(f'{path}: {name or "the file"} is no mapping; is it a turbine of windIO?')

    def __contains__(self, key):
        return self.data.get(key) is not None

    def fail(self, key, what):
        """Refuses the file; what: about the entry."""
        line = getattr(self.data, 'lines', {}).get(key)
        name = '.'.join(str(one) for one in (self.name, key) if one)
        raise ModelError(f'{self.path}{f", line {line}" if line else ""}: {name} {what}')

    def get(self, key):
        """An entry that must be there."""
        if key not in self:
            raise ModelError(f'{self.path}: {self.name or "the file"} has no {key}; is it a turbine of windIO?')
        return self.data[key]

    def part(self, *keys):
        """A mapping in it, through mappings."""
        now = self
        for key in keys:
            if not isinstance(now.get(key), dict):
                now.fail(key, f'is {_short(now.data[key])}; give a mapping')
            now = Part(now.data[key], f'{now.name}.{key}'.lstrip('.'), self.path)
        return now

    def parts(self, key):
        """A list of mappings in it, none where it is not."""
        values = self.data.get(key) or []
        if not isinstance(values, list) or not all(isinstance(one, dict) for one in values):
            self.fail(key, f'is {_short(values)}; give a list of mappings')
        return [Part(one, f'{self.name}.{key}[{i}]'.lstrip('.'), self.path) for i, one in enumerate(values)]

    def maybe(self, *keys):
        """A mapping in it, empty where it is not."""
        now = self
        for key in keys:
            now = now.part(key) if key in now else Part({}, f'{now.name}.{key}'.lstrip('.'), self.path)
        return now

    def numbers(self, key, count=None, low=None, high=None):
        """Finite numbers of a list, in a range."""
        value = self.get(key)
        try:
            array = numpy.asarray(value if isinstance(value, list) else [value])
        except ValueError:
            array = numpy.zeros(0, object)
        if array.dtype.kind not in 'if' or not array.size or not numpy.isfinite(array).all():
            flat = value if isinstance(value, list) else [value]
            bad = next((x for x in flat if isinstance(x, (str, bool, dict)) or x is None or x != x), value)
            self.fail(key, f'has {_short(bad)}; give finite numbers' + (' (spar.windio.load reads such as 2.1E11)' if isinstance(bad, str) else ''))
        if count is not None and array.shape[0] != count:
            self.fail(key, f'has {array.shape[0]} values for {count} grid points')
        for bound, wrong in ((low, array < low if low is not None else None), (high, array > high if high is not None else None)):
            if bound is not None and wrong.any():
                self.fail(key, f'has {array[wrong][0]:g}; give numbers from {-numpy.inf if low is None else low:g} to '
                          f'{numpy.inf if high is None else high:g}')
        return array.astype(float)

    def number(self, key, otherwise=None, low=None, high=None):
        """One number."""
        if key not in self and otherwise is not None:
            return otherwise
        if isinstance(self.get(key), list):
            self.fail(key, f'is {_short(self.data[key])}; give a number')
        return float(self.numbers(key, 1, low, high)[0])

    def grid(self, key='grid'):
        """Positions from 0 to 1, which rise."""
        grid = self.numbers(key)
        if grid.ndim != 1 or not (numpy.diff(grid) > 0).all() or grid[0] < -1e-9 or grid[-1] > 1 + 1e-9:
            bad = next((i for i in range(1, len(grid)) if not (numpy.diff(grid) > 0)[i - 1]), 0) if grid.ndim == 1 else 0
            self.fail(key, f'has {_short(grid.ravel()[bad])} as number {bad + 1}; give positions that rise within 0 to 1')
        return grid

    def at(self, key, grid, low=None, high=None):
        """Values of {grid, values} at positions."""
        curve = self.part(key)
        x = curve.grid()
        y = curve.numbers('values', len(x), low, high)
        if y.ndim != 1:
            curve.fail('values', 'are no list of numbers')
        return numpy.interp(grid, x, y)


def _short(value):
    text = repr(value)
    return text if len(text) < 40 else text[:36] + ' ...'


def _open(source):
    """The file's top: of a path, of what load() has answered, or of a part."""
    if isinstance(source, Part):
        return source
    return Part(source) if isinstance(source, dict) else Part(load(source), '', os.fspath(source))


# ---- the whole ----

def read(path, stations=None):
    """The turbine.
    path: of a YAML file, or what load() has answered
    stations: eta[n] of blade elements in (0, 1); None: 30 in the middle of equal lengths"""
    data = _open(path)
    parts = data.part('components')
    if 'blade' not in parts and 'tower' in parts:
        raise ModelError(f'{data.path}: components has no blade; read the tower alone by spar.windio.read_tower')
    old = 'outer_shape_bem' in parts.part('blade')
    angle, most = (1.0, 1.0) if old else (_DEGREE, 60.0)  # of hub and drivetrain; twist has its own
    blade, hub, assembly = read_blade(data), parts.part('hub'), data.maybe('assembly')
    nose = parts.maybe('nacelle', 'drivetrain') if old else parts.maybe('drivetrain', 'outer_shape')
    down = assembly.data.get('rotor_orientation') or 'Upwind'
    if str(down).lower() not in ('upwind', 'downwind'):
        assembly.fail('rotor_orientation', f'is {_short(down)}; give Upwind or Downwind')
    side = -1.0 if str(down).lower() == 'downwind' else 1.0  # cone and tilt turn the tips and the rotor away from the tower
    machine = Turbine(name=str(data.data.get('name', 'turbine')), blade=blade, blades=int(assembly.number('number_of_blades', 3, 1, 20)),
                      hub_radius=hub.number('diameter', low=0) / 2, cone=side * hub.number('cone_angle', 0.0, -most, most) * angle,
                      tilt=side * nose.number('uptilt', 0.0, -most, most) * angle, overhang=side * nose.number('overhang', 0.0, 0),
                      shaft_height=nose.number('distance_tt_hub', 0.0), rated_power=assembly.number('rated_power', 0.0, 0))
    air = data.maybe('environment')
    machine.air_density = air.number('air_density', 1.225, 1e-6)
    if 'tower' in parts:
        machine.tower, machine.tower_base = read_tower(data)
    _bodies(machine, parts, old)
    _control(machine, data.maybe('control'), old)
    if 'airfoils' in data:
        machine.sections = read_sections(data, blade, stations, machine, air.number('air_dyn_viscosity', 1.81e-5, 1e-9) / machine.air_density)
    _compare(machine, data)
    machine.left_out = _left_out(data, machine)
    tell(data.path, machine.left_out)
    return machine


def _control(machine, control, old):
    """Rated speed, tip speed ratio and least pitch: those of windIO, or WISDEM's, whose speed the largest tip speed limits too."""
    rpm, angle = 2 * numpy.pi / 60, 1.0 if old else _DEGREE
    torque, fastest = control.maybe('torque'), control.maybe('supervisory').number('maxTS', numpy.inf, 1e-6)
    speed = control.number('rated_rotor_speed', 0.0, 0) * rpm or torque.number('VS_maxspd', 0.0, 0) * (1.0 if old else rpm)
    machine.rated_speed = min(speed or numpy.inf, fastest / machine.tip_radius())
    if not numpy.isfinite(machine.rated_speed):
        machine.rated_speed = 0.0
    machine.tip_speed_ratio = control.number('optimal_tsr', 0.0, 0) or torque.number('tsr', 0.0, 0)
    if 'min_pitch_table' in control:
        table = control.part('min_pitch_table')
        wind = table.numbers('wind_speed')
        if not (numpy.diff(wind) > 0).all():
            table.fail('wind_speed', 'does not rise')
        machine.pitch_table = wind, table.numbers('min_pitch', len(wind)) * _DEGREE
    elif control.maybe('pitch').number('min_pitch', 0.0):
        machine.pitch_table = numpy.zeros(1), numpy.array([control.part('pitch').number('min_pitch') * angle])


def _compare(machine, data):
    """Warns where the diameter or the height that the file names is not that of its axes, to which WISDEM scales them."""
    assembly = data.maybe('assembly')
    found = {'rotor_diameter': 2 * machine.tip_radius(), 'hub_height': machine.apex()[2] if machine.tower else 0.0}
    for key, value in found.items():
        said = assembly.number(key, 0.0, 0)
        if said and value and abs(value / said - 1) > 0.01:
            warnings.warn(f'{data.path}: assembly.{key} is {said:g} m, and the axes of its parts give {value:.6g} m, which are taken; WISDEM '
                          f'scales the axis to the former. Correct one of them', stacklevel=3)


def _left_out(data, machine):
    """Names what the file has and spar does not take."""
    names = []
    for where, taken in _TAKEN.items():
        part = data.maybe(where) if where else data
        names += [f'{part.name}.{key}'.lstrip('.') + (' (the tower stands on a rigid base)' if key in _FOUNDATIONS else '')
                  for key in part.data if key not in taken]
    several = [len(_sets(foil)[0]) for foil in data.parts('airfoils')]
    if max(several, default=1) > 1:
        names.append(f'Reynolds numbers of {sum(n > 1 for n in several)} airfoils but those at the rated speed' if machine.rated_speed else
                     f'polars of {sum(n > 1 for n in several)} airfoils beyond their first (without a rated speed their Reynolds numbers are not known)')
    names += [f'configuration {one.data.get("configuration")} of airfoil {foil.data.get("name")}' for foil in data.parts('airfoils')
              for one in _sets(foil)[2]]
    return names


# ---- the blade ----

def _line(axis, keys='xyz'):
    """Grid, points [n][3] in windIO's axes, and arc length from 0 to 1."""
    grid = numpy.unique(numpy.concatenate([axis.part(k).grid() for k in keys]))
    points = numpy.column_stack([axis.at(k, grid) for k in keys])
    along = numpy.concatenate([[0], numpy.cumsum(numpy.linalg.norm(numpy.diff(points, axis=0), axis=1))])
    if len(grid) < 2 or not (numpy.diff(along) > 0).all():
        axis.fail('z', 'has two points at one position')
    if along[-1] > 1e3:
        axis.fail('z', f'goes along {along[-1]:g} m; give m')
    return grid, points, along / along[-1]


def _stiffness(table):
    """6x6 matrices of K11 .. K66, those left out being 0."""
    grid = table.grid()
    matrix = numpy.zeros((len(grid), 6, 6))
    for i, j in _PAIRS:
        key = f'K{i}{j}'
        if key in table:
            matrix[:, i - 1, j - 1] = matrix[:, j - 1, i - 1] = table.numbers(key, len(grid), 0 if i == j else None)
    return grid, matrix


def _inertia(table):
    """6x6 matrices of mass, centre and moments per length."""
    grid = table.grid()
    v = {name: table.numbers(name, len(grid), 0 if name in ('mass', 'i_edge', 'i_flap', 'i_plr') else None) if name in table else 0 * grid
         for name in ('mass', 'cm_x', 'cm_y', 'i_edge', 'i_flap', 'i_plr', 'i_cp')}
    m = numpy.zeros((len(grid), 6, 6))
    for i in range(3):
        m[:, i, i] = v['mass']
    for i, j, value in ((0, 5, -v['mass'] * v['cm_y']), (1, 5, v['mass'] * v['cm_x']), (2, 3, v['mass'] * v['cm_y']),
                        (2, 4, -v['mass'] * v['cm_x']), (3, 4, -v['i_cp'])):
        m[:, i, j] = m[:, j, i] = value
    m[:, 3, 3], m[:, 4, 4], m[:, 5, 5] = v['i_edge'], v['i_flap'], v['i_plr']
    return grid, m


def _triangle(table):
    """6x6 matrices of rows of 21 numbers, as version 1 has them."""
    grid = table.grid()
    rows = table.numbers('values', len(grid))
    if rows.shape != (len(grid), 21):
        table.fail('values', f'have the shape {rows.shape}; it must be ({len(grid)}, 21)')
    matrix = numpy.zeros((len(grid), 6, 6))
    for k, (i, j) in enumerate(_PAIRS):
        matrix[:, i - 1, j - 1] = matrix[:, j - 1, i - 1] = rows[:, k]
    return grid, matrix


def _resampled(grid, matrix, to):
    """Matrices that are linear between the grid's points, at other ones."""
    return numpy.stack([numpy.interp(to, grid, matrix[:, i, j]) for i in range(6) for j in range(6)], axis=1).reshape(-1, 6, 6)


def _cure_inertia(table, mass):
    """Matrices of WISDEM with the moment about the flapwise axis in the place of the product of inertia: with a warning, what is meant,
    as the polar moment is the sum of both."""
    edge, flap, polar, product = mass[:, 3, 3], mass[:, 4, 4], mass[:, 5, 5], mass[:, 3, 4]
    if (abs(flap) <= 1e-9 * polar).all() and (abs(abs(product) - edge) <= 1e-6 * edge).all() and (polar >= edge).all() and edge.any():
        mass[:, 4, 4], mass[:, 3, 4], mass[:, 4, 3] = polar - edge, 0, 0
        warnings.warn(f'{table.path}: {table.name} has no i_flap, and i_cp is i_edge, as some versions of WISDEM write it; i_flap is taken as '
                      'i_plr less i_edge, and i_cp as 0', stacklevel=4)


def _check_sections(table, at, stiffness, mass):
    """Refuses matrices that no section has."""
    fault = sections_fault(stiffness, mass)
    if fault:
        table.fail('', f'at the position {at[fault[1]]:g}: {fault[0]}')


def _twist_unit(curve, blade, old):
    """rad of a twist's unit: degrees in version 2, also where WISDEM keeps matrices as of version 1."""
    most = numpy.abs(curve.part('twist').numbers('values')).max()
    if old and most > 2 * numpy.pi:
        curve.fail('twist', f'goes to {most:g}; version 1 has radians')
    if old or 'outer_shape' not in blade:
        return 1.0
    return _DEGREE if abs(most - numpy.abs(blade.part('outer_shape', 'twist').numbers('values')).max()) < 0.1 * most or most > 1.6 else 1.0


def read_blade(source):
    """The blade's beam.
    source: path of a YAML file, or what load() has answered"""
    blade = _open(source).part('components', 'blade')
    old, structure = 'outer_shape_bem' in blade, blade.maybe('structure')
    six = blade.maybe('elastic_properties_mb', 'six_x_six')
    six = six if six.data else structure.maybe('elastic_properties_mb', 'six_x_six')
    mu = numpy.zeros(6)
    if six.data:
        elastic, axis, unit = six, six.part('reference_axis'), _twist_unit(six, blade, old)
        (grid_k, stiffness), (grid_m, mass) = _triangle(six.part('stiff_matrix')), _triangle(six.part('inertia_matrix'))
        grid, points, eta = _line(axis)
        twist = -six.at('twist', grid) * unit
    else:
        if 'elastic_properties' not in structure and (structure.data.get('layers') or 'internal_structure_2d_fem' in blade):
            blade.fail('', 'has layers and no 6x6 matrices; sections from layers are the work of another program (PreComp in WISDEM, SONATA, '
                       'BECAS): run it, and read its windIO, BeamDyn or HAWC2 files')
        elastic = blade.part('structure').part('elastic_properties')
        (grid_k, stiffness), (grid_m, mass) = _stiffness(elastic.part('stiffness_matrix')), _inertia(elastic.part('inertia_matrix'))
        grid, points, eta = _line(blade.part('reference_axis'))
        twist = -blade.part('outer_shape').at('twist', grid, -360, 360) * _DEGREE
        if 1e-4 < abs(twist).max() < 0.7 * _DEGREE:
            warnings.warn(f'{elastic.path}: components.blade.outer_shape.twist goes to {abs(twist).max() / _DEGREE:.3g} degrees; version 2 has '
                          'degrees, and these look like radians', stacklevel=4)
        if 'mu' in elastic.maybe('structural_damping'):
            mu = elastic.part('structural_damping').numbers('mu', low=0)
            if mu.shape != (6,):
                elastic.part('structural_damping').fail('mu', f'has {mu.size} values; give 6')
    _cure_inertia(elastic, mass)
    at = numpy.unique(numpy.concatenate([grid_k, grid_m]))
    stiffness, mass = reorder(_resampled(grid_k, stiffness, at)), reorder(_resampled(grid_m, mass, at))
    fill_shear(stiffness, float(numpy.linalg.norm(numpy.diff(points, axis=0), axis=1).sum()), f'{elastic.path}: {elastic.name}')
    _check_sections(elastic, at, stiffness, mass)
    if 'point_mass' in elastic:
        lumps = elastic.part('point_mass')
        at_lump, kg = lumps.grid(), lumps.numbers('mass', len(lumps.grid()), 0)
        lumps = [(float(numpy.interp(g, grid, eta)), body_mass(m)) for g, m in zip(at_lump, kg) if m]
    else:
        lumps = []
    return Beam('blade', eta, points[:, [2, 0, 1]], twist, numpy.interp(at, grid, eta), stiffness, mass, mu[[2, 0, 1, 5, 3, 4]], lumps)


# ---- the tower and the bodies ----

def read_tower(source):
    """The tower's beam, with x upwards, and the height of its base.
    source: path of a YAML file, which may have a tower alone, or what load() has answered"""
    data = _open(source)
    tower = data.part('components', 'tower')
    shape = tower.part('outer_shape_bem' if 'outer_shape_bem' in tower else 'outer_shape')
    axis = (tower if 'reference_axis' in tower else shape).part('reference_axis')
    grid, points, eta = _line(axis)
    if numpy.ptp(points[:, 0]) or numpy.ptp(points[:, 1]) or not (numpy.diff(points[:, 2]) > 0).all():
        axis.fail('', 'leans or goes down; only straight upright towers are read')
    mu = numpy.zeros(6)
    if 'elastic_properties' not in tower.maybe('structure'):
        at, stiffness, mass = _tower_of_layers(data, tower, shape)
    else:
        elastic = tower.part('structure', 'elastic_properties')
        at, k = _stiffness(elastic.part('stiffness_matrix'))
        grid_m, m = _inertia(elastic.part('inertia_matrix'))
        m = _resampled(grid_m, m, at)
        if 'mu' in elastic.maybe('structural_damping'):
            mu = elastic.part('structural_damping').numbers('mu', 6, 0)
        stiffness, mass = reorder(k), reorder(m)
        bare = k[:, [0, 1, 2], [0, 1, 2]] <= 0  # shear and axial stiffness may be left out, as rotary inertia may
        if bare.any() or not m[:, 3, 3].any():
            full_k, full_m = tube(shape.at('outer_diameter', at, 1e-6), k[:, 3, 3], k[:, 5, 5], m[:, 0, 0])
            stiffness = numpy.where(stiffness == 0, full_k, stiffness)
            mass = mass if m[:, 3, 3].any() else full_m
        _check_sections(elastic, at, stiffness, mass)
    height = points[:, 2] - points[0, 2]
    beam = Beam('tower', eta, numpy.column_stack([height, 0 * height, 0 * height]), 0 * eta, numpy.interp(at, grid, eta), stiffness,
                mass, mu[[2, 0, 1, 5, 3, 4]], elements=3, nodes=6)
    return beam, float(points[0, 2])


def _tower_of_layers(data, tower, shape):
    """A tube of one material, whose mass has the outfitting in it."""
    inner = tower.maybe('internal_structure_2d_fem' if 'internal_structure_2d_fem' in tower else 'structure')  # version 1, 2
    layers = inner.parts('layers')
    if len(layers) != 1:
        raise ModelError(f'{data.path}: the tower has no matrices and {len(layers)} layers; towers of one layer are read')
    name = layers[0].get('material')
    steel = next((m for m in data.parts('materials') if m.data.get('name') == name), None)
    if steel is None or not isinstance(steel.get('E'), (float, int)):
        layers[0].fail('material', f'is {_short(name)}, which is not an isotropic material of the file: {_short(steel and steel.data["E"])}')
    at = shape.part('outer_diameter').grid()
    outer, wall = shape.at('outer_diameter', at, 1e-6), layers[0].at('thickness', at, 1e-9)
    if (2 * wall >= outer).any():
        layers[0].fail('thickness', 'is more than the tower\'s radius; give m')
    young = steel.number('E', low=1e-6)
    area = numpy.pi / 4 * (outer**2 - (outer - 2 * wall) ** 2)
    second = numpy.pi / 64 * (outer**4 - (outer - 2 * wall) ** 4)
    shear = steel.number('G', low=1e-6) if 'G' in steel else young / 2 / (1 + steel.number('nu', low=-0.99, high=0.5))
    density = steel.number('rho', low=1e-6) * area * inner.number('outfitting_factor', 1.0, 0.1)
    return at, *tube(outer - wall, young * second, 2 * shear * second, density)


def _body(part):
    """6x6 mass of elastic_properties, or of WISDEM's elastic_properties_mb; None: it has neither."""
    for name, stem in (('elastic_properties', '{}'), ('elastic_properties_mb', 'system_{}')):
        if name in part:
            body, centre = part.part(name), 'location' if stem == '{}' else 'system_center_mass'
            i, x = ([*(body.numbers(key) if key in body else []), *[0] * n][:n] for key, n in ((stem.format('inertia'), 6), (centre, 3)))
            tensor = [[i[0], i[3], i[4]], [i[3], i[1], i[5]], [i[4], i[5], i[2]]]
            least = numpy.linalg.eigvalsh(tensor)
            if least[0] < -1e-9 * abs(least[2]) or least[2] > (least[0] + least[1]) * (1 + 1e-6):
                warnings.warn(f'{body.path}: {body.name} has the principal moments {least[0]:.4g}, {least[1]:.4g}, {least[2]:.4g}, which no '
                              'body has; the library refuses it', stacklevel=5)
            extra = body.number('yaw_mass', 0.0, 0)
            return body_mass(body.number(stem.format('mass'), low=0), x, tensor) + body_mass(extra)
    return None


def _bodies(machine, parts, old):
    """Hub, nacelle and drivetrain, where the file has their masses."""
    machine.hub = _body(parts.part('hub'))
    drive = parts.maybe('nacelle') if old or 'drivetrain' not in parts else parts.part('drivetrain')
    machine.nacelle = _body(drive)
    if machine.nacelle is not None:
        yaw = _body(parts.maybe('yaw'))
        machine.nacelle = machine.nacelle + (yaw if yaw is not None else 0)
        known = drive.part('elastic_properties' if 'elastic_properties' in drive else 'elastic_properties_mb')
        machine.drivetrain = tuple(known.number(key, 0.0, 0) for key in ('spring_constant', 'damping_coefficient'))
    generator = drive.maybe('generator')
    inertia = generator.maybe('elastic_properties').data.get('inertia') or generator.maybe('elastic_properties_mb').data.get('rotor_inertia')
    if inertia:
        about = Part({'inertia': inertia}, generator.name, generator.path).numbers('inertia', low=0)[0]
        machine.generator_inertia = about * drive.maybe('gearbox').number('gear_ratio', 1.0, 1e-4, 1e4) ** 2


# ---- airfoils ----

def read_sections(source, blade, stations=None, machine=None, viscosity=1.48e-5):
    """Blade elements: chord, twist, aerodynamic centre and polar of each section. Of polars for several Reynolds numbers those at the
    rated speed of the machine are taken, without a machine the first ones.
    viscosity: m^2/s, kinematic"""
    data = _open(source)
    part = data.part('components', 'blade')
    old = 'outer_shape_bem' in part
    shape = part.part('outer_shape_bem' if old else 'outer_shape')
    grid, _, eta = _line((shape if old else part).part('reference_axis'))
    stations = numpy.asarray((numpy.arange(30) + 0.5) / 30 if stations is None else stations, float)
    at = numpy.interp(stations, eta, grid)
    chord = shape.at('chord', at, 0, blade.length())
    twist = shape.at('twist', at) * (1.0 if old else _DEGREE)
    foils = {foil.get('name'): foil for foil in data.parts('airfoils')}
    if old:
        ahead = shape.at('pitch_axis', at) * chord
        places = shape.part('airfoil_position')
        used = places.get('labels')
    else:
        ahead = shape.at('section_offset_y', at)
        used = [one.get('name') for one in shape.parts('airfoils')]
    for name in used if isinstance(used, list) else [used]:
        if not isinstance(name, str) or name not in foils:
            (places if old else shape).fail('labels' if old else 'airfoils', f'names {_short(name)}, which is no airfoil of the file')
    ratio = {name: foils[name].number('rthick' if 'rthick' in foils[name] else 'relative_thickness', low=0, high=1) for name in used}
    if old:
        x = places.grid()
        if len(x) != len(used):
            places.fail('labels', f'has {len(used)} values for {len(x)} grid points')
        thickness = numpy.interp(at, x, [ratio[name] for name in used])
    else:
        thickness = shape.at('rthick', at, 0, 1)
    side = shape.at('section_offset_x', at) if 'section_offset_x' in shape else 0 * at
    known = sorted(((ratio[name], foils[name]) for name in set(used)), key=lambda one: (one[0], one[1].data['name']))
    if not known:
        shape.fail('airfoils', 'names none')
    centre = numpy.interp(thickness, [t for t, _ in known], [foil.number('aerodynamic_center', low=-1, high=1) for _, foil in known])
    polars = {foil.data['name']: _polars(foil) for _, foil in known}
    speed = (machine.hub_radius + stations * blade.length()) * machine.rated_speed if machine else 0 * stations
    return Sections(stations, chord, twist, numpy.column_stack([side, centre * chord - ahead]),
                    [_blend(known, {name: _at_reynolds(sets, re) for name, sets in polars.items()}, t)
                     for t, re in zip(thickness, speed * chord / viscosity)])


def _blend(known, polars, thickness):
    """The polar of a relative thickness, linear between those of the two nearest airfoils."""
    all_t = [t for t, _ in known]
    i = int(numpy.clip(numpy.searchsorted(all_t, thickness), 1, len(known) - 1)) if len(known) > 1 else 0
    low, high = known[max(i - 1, 0)], known[i]
    part = 0.0 if high[0] == low[0] else float(numpy.clip((thickness - low[0]) / (high[0] - low[0]), 0, 1))
    return _mean(polars[low[1].data['name']], polars[high[1].data['name']], part)


def _sets(foil):
    """The sets of an airfoil, one for each Reynolds number, in rad per unit of their angles, and other configurations, which are not read."""
    polars = foil.parts('polars')
    if not polars:
        foil.fail('polars', 'are missing')
    if 're_sets' in polars[0]:
        return polars[0].parts('re_sets'), _DEGREE, polars[1:]
    return polars, 1.0, []


def _polars(foil):
    """Reynolds number and polar of each set of an airfoil, by Reynolds number; the first one if not all have one."""
    sets, scale, _ = _sets(foil)
    numbers = [one.number('re', 0.0, 0) for one in sets]
    if len(sets) > 1 and (min(numbers) <= 0 or len(set(numbers)) < len(numbers)):
        sets = sets[:1]
    return sorted(((re, _polar(one, scale)) for re, one in zip(numbers, sets)), key=lambda one: one[0]) if min(numbers) > 0 else \
        [(0.0, _polar(sets[0], scale))]


def _at_reynolds(sets, reynolds):
    """The polar at a Reynolds number, linear in its logarithm, beyond the ends the nearest; 0: the first one."""
    numbers = [re for re, _ in sets]
    if len(sets) == 1 or reynolds <= 0:
        return sets[0][1]
    i = int(numpy.clip(numpy.searchsorted(numbers, reynolds), 1, len(sets) - 1))
    return _mean(sets[i - 1][1], sets[i][1], float(numpy.clip(numpy.log(reynolds / numbers[i - 1]) / numpy.log(numbers[i] / numbers[i - 1]), 0, 1)))


def _mean(first, second, part):
    """A polar between two."""
    alpha = numpy.unique(numpy.round(numpy.concatenate([first[0], second[0]]), 9))
    return [alpha, *((1 - part) * numpy.interp(alpha, first[0], a) + part * numpy.interp(alpha, second[0], b)
                     for a, b in zip(first[1:], second[1:]))]


def _polar(one, scale):
    """alpha (rad), cl, cd, cm of a set, periodic."""
    curves = []
    for k in 'ldm':
        curve = one.part(f'c_{k}' if f'c_{k}' in one else f'c{k}')
        x = curve.numbers('grid', low=-2 * numpy.pi / scale, high=2 * numpy.pi / scale) * scale
        if x.ndim != 1 or not (numpy.diff(x) > 0).all():
            curve.fail('grid', 'does not rise; give angles in order')
        curves.append((x, curve.numbers('values', len(x))))
    alpha = numpy.unique(numpy.round(numpy.concatenate([grid for grid, _ in curves]), 9))
    values = [numpy.interp(alpha, *curve) for curve in curves]
    if alpha[-1] - alpha[0] > 2 * numpy.pi + 1e-6:
        one.fail('', 'goes round more than once; give angles over one revolution')
    if alpha[-1] - alpha[0] > 2 * numpy.pi - 1e-6:  # of a full turn both ends are one
        alpha[0], alpha[-1] = -numpy.pi, numpy.pi
        for value in values:
            value[0] = value[-1] = (value[0] + value[-1]) / 2
    return [alpha, *values]
