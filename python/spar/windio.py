"""Reads wind turbines of windIO (https://windio.readthedocs.io), versions 1 and 2.

    machine = spar.windio.read('IEA-15-240-RWT.yaml')

Taken are the blade's line, twist, 6x6 matrices and airfoils, the tower (6x6 or bending, torsion and mass), hub, drivetrain, yaw, and
of the control the rated values. Files of version 1 have no masses of hub and nacelle: the blade and the geometry are read.
The tower stands on a rigid base: monopile and floater are not read.
Matrices are in the axes that the files of IEA-15 and IEA-22 use, which are BeamDyn's: x to the suction side, y to the trailing edge,
z to the tip, so K44 is the edgewise bending stiffness. (The schema's text says otherwise.)
Needs PyYAML.
"""
import numpy

from .turbine import Beam, ModelError, Sections, Turbine, body_mass, reorder, tube

_PAIRS = [(i, j) for i in range(1, 7) for j in range(i, 7)]


def load(path):
    """The file as it stands, as dictionaries and lists."""
    try:
        import yaml  # pylint: disable=import-outside-toplevel
    except ImportError:
        raise ImportError('spar.windio needs PyYAML: pip install PyYAML') from None
    with open(path, encoding='utf-8') as file:
        return yaml.load(file, Loader=getattr(yaml, 'CSafeLoader', yaml.SafeLoader))


def read(path, stations=None):
    """The turbine.
    path: of a YAML file, or what load() has answered
    stations: eta[n] of blade elements in (0, 1); None: 30 in the middle of equal lengths"""
    data = path if isinstance(path, dict) else load(path)
    parts = _need(data, 'components', 'the file')
    old = 'outer_shape_bem' in _need(parts, 'blade', 'components')
    blade = read_blade(data)
    hub, assembly, control = _need(parts, 'hub', 'components'), data.get('assembly', {}), data.get('control', {})
    nose = parts['nacelle']['drivetrain'] if old else parts.get('drivetrain', {}).get('outer_shape', {})
    angle = 1.0 if old else numpy.pi / 180  # of hub and drivetrain; twist has its own
    machine = Turbine(name=str(data.get('name', 'turbine')), blade=blade, blades=int(assembly.get('number_of_blades', 3)),
                      hub_radius=hub['diameter'] / 2, cone=hub.get('cone_angle', 0.0) * angle, tilt=nose.get('uptilt', 0.0) * angle,
                      overhang=nose.get('overhang', 0.0), shaft_height=nose.get('distance_tt_hub', 0.0),
                      rated_power=float(assembly.get('rated_power', 0.0)))
    if assembly.get('rotor_orientation', 'Upwind').lower() != 'upwind':
        raise ModelError(f'{machine.name}: rotor_orientation is {assembly["rotor_orientation"]}; only upwind rotors are read')
    if data.get('airfoils'):
        machine.sections = read_sections(data, blade, stations)
    machine.air_density = float((data.get('environment') or {}).get('air_density', 1.225))
    if 'tower' in parts:
        machine.tower, machine.tower_base = read_tower(data)
        machine.left_out = next((name for name in ('monopile', 'jacket', 'floating_platform') if name in parts), None)
    if not old:
        _bodies(machine, parts)
        machine.rated_speed = control.get('rated_rotor_speed', 0.0) * 2 * numpy.pi / 60
        machine.tip_speed_ratio = float(control.get('optimal_tsr', 0.0))
        if 'min_pitch_table' in control:
            table = control['min_pitch_table']
            machine.pitch_table = (numpy.asarray(table['wind_speed'], float), numpy.radians(table['min_pitch']))
    else:
        torque = control.get('torque', {})
        machine.rated_speed, machine.tip_speed_ratio = float(torque.get('VS_maxspd', 0.0)), float(torque.get('tsr', 0.0))
    return machine


def _need(data, key, where):
    if not isinstance(data, dict) or key not in data:
        raise ModelError(f'windIO: {where} has no {key}; is it a turbine of windIO?')
    return data[key]


def _at(curve, grid, what):
    """Values of {grid, values} at a grid."""
    x, y = numpy.asarray(_need(curve, 'grid', what), float), numpy.asarray(_need(curve, 'values', what), float)
    if x.shape != y.shape or x.size < 1 or not (numpy.diff(x) > 0).all():
        raise ModelError(f'windIO: {what} has {x.size} grid points and {y.size} values; give a rising grid with a value for each')
    return numpy.interp(grid, x, y)


def _line(axis, what):
    """Grid, points [n][3] in windIO's axes, and arc length from 0 to 1."""
    grid = numpy.unique(numpy.concatenate([numpy.asarray(_need(axis, k, what)['grid'], float) for k in 'xyz']))
    points = numpy.column_stack([_at(axis[k], grid, f'{what}.{k}') for k in 'xyz'])
    along = numpy.concatenate([[0], numpy.cumsum(numpy.linalg.norm(numpy.diff(points, axis=0), axis=1))])
    if not (numpy.diff(along) > 0).all():
        raise ModelError(f'windIO: {what} has two points at one position')
    return grid, points, along / along[-1]


def _stiffness(table, what):
    """6x6 matrices of K11 .. K66, those left out being 0."""
    grid = numpy.asarray(_need(table, 'grid', what), float)
    matrix = numpy.zeros((len(grid), 6, 6))
    for i, j in _PAIRS:
        values = numpy.asarray(table.get(f'K{i}{j}', numpy.zeros(len(grid))), float)
        if values.shape != grid.shape:
            raise ModelError(f'windIO: {what}.K{i}{j} has {values.size} values for {grid.size} grid points')
        matrix[:, i - 1, j - 1] = matrix[:, j - 1, i - 1] = values
    return grid, matrix


def _inertia(table, what):
    """6x6 matrices of mass, centre and moments per length."""
    grid = numpy.asarray(_need(table, 'grid', what), float)
    v = {}
    for name in ('mass', 'cm_x', 'cm_y', 'i_edge', 'i_flap', 'i_plr', 'i_cp'):
        v[name] = numpy.asarray(table.get(name, numpy.zeros(len(grid))), float)
        if v[name].shape != grid.shape:
            raise ModelError(f'windIO: {what}.{name} has {v[name].size} values for {grid.size} grid points')
    m = numpy.zeros((len(grid), 6, 6))
    for i in range(3):
        m[:, i, i] = v['mass']
    for i, j, value in ((0, 5, -v['mass'] * v['cm_y']), (1, 5, v['mass'] * v['cm_x']), (2, 3, v['mass'] * v['cm_y']),
                        (2, 4, -v['mass'] * v['cm_x']), (3, 4, -v['i_cp'])):
        m[:, i, j] = m[:, j, i] = value
    m[:, 3, 3], m[:, 4, 4], m[:, 5, 5] = v['i_edge'], v['i_flap'], v['i_plr']
    return grid, m


def _triangle(table, what):
    """6x6 matrices of rows of 21 numbers, as version 1 has them."""
    grid, rows = numpy.asarray(_need(table, 'grid', what), float), numpy.asarray(_need(table, 'values', what), float)
    if rows.shape != (len(grid), 21):
        raise ModelError(f'windIO: {what} has values of the shape {rows.shape}; it must be ({len(grid)}, 21)')
    matrix = numpy.zeros((len(grid), 6, 6))
    for k, (i, j) in enumerate(_PAIRS):
        matrix[:, i - 1, j - 1] = matrix[:, j - 1, i - 1] = rows[:, k]
    return grid, matrix


def _resampled(grid, matrix, to):
    """Matrices that are linear between the grid's points, at other ones."""
    return numpy.stack([numpy.interp(to, grid, matrix[:, i, j]) for i in range(6) for j in range(6)], axis=1).reshape(-1, 6, 6)


def read_blade(data):
    """The blade's beam."""
    blade = data['components']['blade']
    if 'elastic_properties_mb' in blade:
        elastic = _need(blade['elastic_properties_mb'], 'six_x_six', 'blade.elastic_properties_mb')
        line, twist, degrees = elastic['reference_axis'], elastic['twist'], 1.0
        (grid_k, stiffness), (grid_m, mass) = (_triangle(elastic['stiff_matrix'], 'stiff_matrix'),
                                               _triangle(elastic['inertia_matrix'], 'inertia_matrix'))
        damping = numpy.zeros(6)
    else:
        elastic = _need(_need(blade, 'structure', 'blade'), 'elastic_properties', 'blade.structure')
        line, degrees = _need(blade, 'reference_axis', 'blade'), numpy.pi / 180
        twist = _need(_need(blade, 'outer_shape', 'blade'), 'twist', 'outer_shape')
        grid_k, stiffness = _stiffness(_need(elastic, 'stiffness_matrix', 'elastic_properties'), 'stiffness_matrix')
        grid_m, mass = _inertia(_need(elastic, 'inertia_matrix', 'elastic_properties'), 'inertia_matrix')
        damping = numpy.asarray(elastic.get('structural_damping', {}).get('mu', numpy.zeros(6)), float)
    grid, points, eta = _line(line, 'blade.reference_axis')
    at = numpy.unique(numpy.concatenate([grid_k, grid_m]))
    lumps = _need_point_masses(elastic, grid, eta)
    return Beam('blade', eta, points[:, [2, 0, 1]], -_at(twist, grid, 'blade.twist') * degrees, numpy.interp(at, grid, eta),
                reorder(_resampled(grid_k, stiffness, at)), reorder(_resampled(grid_m, mass, at)),
                damping[[2, 0, 1, 5, 3, 4]], lumps)


def _need_point_masses(elastic, grid, eta):
    """Point masses on the line."""
    points = elastic.get('point_mass')
    if not points:
        return []
    return [(float(numpy.interp(g, grid, eta)), body_mass(m)) for g, m in zip(points['grid'], points['mass']) if m]


def read_tower(data):
    """The tower's beam, with x upwards, and the height of its base."""
    tower = data['components']['tower']
    shape = tower.get('outer_shape', tower.get('outer_shape_bem'))
    grid, points, eta = _line(tower.get('reference_axis', shape.get('reference_axis')), 'tower.reference_axis')
    if numpy.ptp(points[:, 0]) or numpy.ptp(points[:, 1]):
        raise ModelError('windIO: the tower leans; only straight upright towers are read')
    elastic = tower.get('structure', {}).get('elastic_properties')
    damping = numpy.zeros(6)
    if elastic is None:
        at, stiffness, mass = _tower_of_layers(data, tower, shape)
    else:
        at, k = _stiffness(_need(elastic, 'stiffness_matrix', 'tower'), 'tower.stiffness_matrix')
        grid_m, m = _inertia(_need(elastic, 'inertia_matrix', 'tower'), 'tower.inertia_matrix')
        m = _resampled(grid_m, m, at)
        damping = numpy.asarray(elastic.get('structural_damping', {}).get('mu', numpy.zeros(6)), float)[[2, 0, 1, 5, 3, 4]]
        stiffness, mass = reorder(k), reorder(m)
        bare = k[:, [0, 1, 2], [0, 1, 2]] <= 0  # shear and axial stiffness may be left out, as rotary inertia may
        if bare.any() or not m[:, 3, 3].any():
            full_k, full_m = tube(_at(shape['outer_diameter'], at, 'tower.outer_diameter'), k[:, 3, 3], k[:, 5, 5], m[:, 0, 0])
            stiffness = numpy.where(stiffness == 0, full_k, stiffness)
            mass = mass if m[:, 3, 3].any() else full_m
    height = points[:, 2] - points[0, 2]
    beam = Beam('tower', eta, numpy.column_stack([height, 0 * height, 0 * height]), 0 * eta, numpy.interp(at, grid, eta), stiffness,
                mass, damping, elements=3, nodes=6)
    return beam, float(points[0, 2])


def _tower_of_layers(data, tower, shape):
    """A tube of one material, whose mass has the outfitting in it."""
    inner = tower.get('internal_structure_2d_fem') or tower.get('structure') or {}  # version 1, 2
    if len(inner.get('layers', [])) != 1:
        raise ModelError(f'windIO: the tower has no matrices and {len(inner.get("layers", []))} layers; towers of one layer are read')
    layer = inner['layers'][0]
    steel = next((m for m in data.get('materials', []) if m['name'] == layer['material']), None)
    if steel is None or not isinstance(steel['E'], (float, int)):
        raise ModelError(f'windIO: {layer["material"]} of the tower is not an isotropic material of the file')
    at = numpy.asarray(shape['outer_diameter']['grid'], float)
    outer, wall = _at(shape['outer_diameter'], at, 'tower.outer_diameter'), _at(layer['thickness'], at, 'tower.thickness')
    area = numpy.pi / 4 * (outer**2 - (outer - 2 * wall) ** 2)
    second = numpy.pi / 64 * (outer**4 - (outer - 2 * wall) ** 4)
    shear = steel.get('G') or steel['E'] / 2 / (1 + steel['nu'])
    density = steel['rho'] * area * inner.get('outfitting_factor', 1.0)
    return at, *tube(outer - wall, steel['E'] * second, 2 * shear * second, density)


def _bodies(machine, parts):
    """Hub, nacelle and drivetrain of version 2."""
    def matrix(body):
        i = [*body.get('inertia', []), 0, 0, 0, 0, 0, 0][:6]
        tensor = [[i[0], i[3], i[4]], [i[3], i[1], i[5]], [i[4], i[5], i[2]]]
        return body_mass(body['mass'], body.get('location', (0, 0, 0)), tensor)
    hub = parts['hub'].get('elastic_properties')
    if hub:
        machine.hub = matrix(hub)
    drive = parts.get('drivetrain', {})
    if 'elastic_properties' in drive:
        machine.nacelle = matrix(drive['elastic_properties'])
        yaw = (parts.get('yaw') or {}).get('elastic_properties')
        if yaw:
            machine.nacelle = machine.nacelle + matrix(yaw)
        machine.drivetrain = tuple(drive['elastic_properties'].get(key, 0.0) for key in ('spring_constant', 'damping_coefficient'))
    generator = drive.get('generator', {}).get('elastic_properties', {})
    if 'inertia' in generator:
        machine.generator_inertia = generator['inertia'][0] * drive.get('gearbox', {}).get('gear_ratio', 1.0) ** 2


# ---- airfoils ----

def read_sections(data, blade, stations=None):
    """Blade elements: chord, twist, aerodynamic centre and polar of each section."""
    part = data['components']['blade']
    old = 'outer_shape_bem' in part
    shape = part['outer_shape_bem' if old else 'outer_shape']
    axis = shape['reference_axis'] if old else part['reference_axis']
    grid, _, eta = _line(axis, 'blade.reference_axis')
    if stations is None:
        stations = (numpy.arange(30) + 0.5) / 30
    stations = numpy.asarray(stations, float)
    at = numpy.interp(stations, eta, grid)
    chord = _at(shape['chord'], at, 'chord')
    twist = _at(shape['twist'], at, 'twist') * (1.0 if old else numpy.pi / 180)
    foils = {foil['name']: foil for foil in data['airfoils']}
    if old:
        ahead = _at(shape['pitch_axis'], at, 'pitch_axis') * chord
        labels = shape['airfoil_position']
        thickness = numpy.interp(at, labels['grid'], [foils[name]['relative_thickness'] for name in labels['labels']])
        used = set(labels['labels'])
    else:
        ahead = _at(shape['section_offset_y'], at, 'section_offset_y')
        thickness = _at(_need(shape, 'rthick', 'outer_shape'), at, 'rthick')
        used = {one['name'] for one in shape['airfoils']}
    side = _at(shape['section_offset_x'], at, 'section_offset_x') if 'section_offset_x' in shape else 0 * at
    known = sorted(((foil.get('rthick', foil.get('relative_thickness')), foil) for name, foil in foils.items() if name in used),
                   key=lambda one: one[0])
    centre = numpy.interp(thickness, [t for t, _ in known], [foil['aerodynamic_center'] for _, foil in known])
    polars = [_blend(known, t) for t in thickness]
    return Sections(stations, chord, twist, numpy.column_stack([side, centre * chord - ahead]), polars)


def _blend(known, thickness):
    """The polar of a relative thickness, linear between those of the two nearest airfoils."""
    all_t = [t for t, _ in known]
    i = int(numpy.clip(numpy.searchsorted(all_t, thickness), 1, len(known) - 1)) if len(known) > 1 else 0
    low, high = known[max(i - 1, 0)], known[i]
    part = 0.0 if high[0] == low[0] else float(numpy.clip((thickness - low[0]) / (high[0] - low[0]), 0, 1))
    first, second = _polar(low[1]), _polar(high[1])
    alpha = numpy.unique(numpy.round(numpy.concatenate([first[0], second[0]]), 9))
    return [alpha, *((1 - part) * numpy.interp(alpha, first[0], a) + part * numpy.interp(alpha, second[0], b)
                     for a, b in zip(first[1:], second[1:]))]


def _polar(foil):
    """alpha (rad), cl, cd, cm of the first set of an airfoil, periodic."""
    one, scale = foil['polars'][0], 1.0
    if 're_sets' in one:
        one, scale = one['re_sets'][0], numpy.pi / 180
    curves = [(numpy.asarray(one[f'c_{k}' if f'c_{k}' in one else f'c{k}']['grid'], float) * scale,
               numpy.asarray(one[f'c_{k}' if f'c_{k}' in one else f'c{k}']['values'], float)) for k in 'ldm']
    alpha = numpy.unique(numpy.round(numpy.concatenate([grid for grid, _ in curves]), 9))
    values = [numpy.interp(alpha, *curve) for curve in curves]
    if alpha[-1] - alpha[0] > 2 * numpy.pi - 1e-6:  # of a full turn both ends are one
        alpha[0], alpha[-1] = -numpy.pi, numpy.pi
        for value in values:
            value[0] = value[-1] = (value[0] + value[-1]) / 2
    return [alpha, *values]
