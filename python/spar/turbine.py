"""Wind turbines as data: what spar.windio, spar.openfast and spar.hawc2 read, put into a session or written as a case file.

    machine = spar.windio.read('IEA-15-240-RWT.yaml')
    machine.blade.total_mass()                        kg
    frequency = machine.blade.modes(6)                Hz, clamped at rest
    machine.blade.write_case('blade.case')            for spar-run
    with spar.Session() as s:
        rotor = machine.build(s, speed=0.79)          tower, nacelle, hub, blades, their joints and the air
        s.step(0.02, lambda *_: rotor.blow([10, 0, 0]))

Units are SI, angles are in radians. A blade's own frame has its origin at the blade's root: x along the span, y downwind (to the
suction side), z to the trailing edge. These are OpenFAST's axes z, x, y of a blade. A tower's own frame has x upwards and y
downwind. Global axes: x downwind, y to the left of one who looks downwind, z upwards.
"""
from __future__ import annotations

import os
import warnings
from dataclasses import dataclass, field

import numpy

import spar

from ._text import ModelError

# spar's order (axial, shear y, z, torsion, bending y, z) of OpenFAST's (forces x, y, z, moments about x, y, z)
FROM_OPENFAST = [2, 0, 1, 5, 3, 4]
_TUBE_SHEAR = 0.53  # shear factor of a thin tube (Cowper 1966, Poisson's ratio 0.3)


def tell(path, left_out):
    """Warns once of what a file has and spar does not take."""
    if left_out:
        warnings.warn(f'{path}: not taken: {"; ".join(left_out)}. Describe yourself what matters to you', stacklevel=3)


def read_by(call, *arguments, path=None):
    """Calls the library, which refuses a file as the readers of Python do.
    path: of the file, for calls that do not name it"""
    try:
        return call(*arguments)
    except spar.Error as error:
        raise ModelError(f'{path}: {error}' if path else str(error)) from None


def reorder(matrix):
    """A 6x6 matrix, or several, of OpenFAST's blade axes in those of spar."""
    return numpy.asarray(matrix, float)[..., FROM_OPENFAST, :][..., FROM_OPENFAST]


def cross_matrix(v):
    """The matrix of v x."""
    return numpy.cross(numpy.asarray(v, float), numpy.eye(3)).T


def body_mass(mass, centre=(0, 0, 0), inertia=((0, 0, 0), (0, 0, 0), (0, 0, 0))):
    """The 6x6 mass of a rigid body about its node.
    mass: kg; centre[3]: m, from the node; inertia[3][3]: kg m^2, about the centre"""
    tilde = cross_matrix(centre)
    matrix = numpy.zeros((6, 6))
    matrix[:3, :3] = mass * numpy.eye(3)
    matrix[:3, 3:], matrix[3:, :3] = -mass * tilde, mass * tilde
    matrix[3:, 3:] = numpy.asarray(inertia, float) - mass * tilde @ tilde
    return matrix


def tube(diameter, stiffness_bending, stiffness_torsion, mass):
    """6x6 stiffness and mass of a thin tube of which bending, torsion and mass are known: the others follow from its diameter.
    Each argument is [n]: m, N m^2, N m^2, kg/m"""
    square = (numpy.asarray(diameter, float) / 2) ** 2
    bending, torsion, mass = (numpy.asarray(one, float) for one in (stiffness_bending, stiffness_torsion, mass))
    stiffness, inertia = numpy.zeros((len(square), 6, 6)), numpy.zeros((len(square), 6, 6))
    shear = _TUBE_SHEAR * torsion / square  # GJ = GA r^2, EI = EA r^2 / 2
    for i, values in enumerate((2 * bending / square, shear, shear, torsion, bending, bending)):
        stiffness[:, i, i] = values
    for i, values in enumerate((mass, mass, mass, mass * square, mass * square / 2, mass * square / 2)):
        inertia[:, i, i] = values
    return stiffness, inertia


def sections_fault(stiffness, mass):
    """What the library says against sections, and its index; None: nothing."""
    with spar.Session() as session:
        member = session.beam_create('sections', 1, 2)
        for i, (k, m) in enumerate(zip(stiffness, mass)):
            try:
                member.set_sections([0], [k], [m])
            except spar.Error as error:
                return str(error).split("'sections': ")[-1].replace('section 0', 'the section'), i
    return None


def fill_shear(stiffness, length, what):
    """Fills in, with a warning, what stiffness [n][6][6] leaves out, as of a thin tube: shear by torsion and the radius that bending and
    extension show; torsion and extension, where they are left out too, so stiff that they do not count.
    length: m, of the beam, which extends then as one whose radius is a seventieth of it
    what: the file and the part"""
    shear, axial, torsion = ((stiffness[:, i, i] <= 0).any() for i in (1, 0, 3))
    shear |= (stiffness[:, 2, 2] <= 0).any()
    if not (shear or axial or torsion):
        return
    bending = stiffness[:, 4, 4] + stiffness[:, 5, 5]
    for i, missing in ((0, (70 / length) ** 2 * bending), (3, 10 * bending)):
        stiffness[:, i, i] = numpy.where(stiffness[:, i, i] > 0, stiffness[:, i, i], missing)
    filled = _TUBE_SHEAR * stiffness[:, 3, 3] * stiffness[:, 0, 0] / numpy.where(bending > 0, bending, 1)
    for i in (1, 2):
        stiffness[:, i, i] = numpy.where(stiffness[:, i, i] > 0, stiffness[:, i, i], filled)
    left = [name for name, is_so in (('shear', shear), ('axial', axial), ('torsional', torsion)) if is_so]
    warnings.warn(f'{what} leaves out {" and ".join(left)} stiffness, which is filled in as of a thin tube with this bending'
                  f'{" and torsion" if not torsion else ", so stiff that it does not count"}; give numbers if it matters', stacklevel=4)


def quaternion(axes):
    """[w, x, y, z] of the rotation matrix whose columns are the axes."""
    m = numpy.asarray(axes, float)
    trace = numpy.array([m[0, 0] + m[1, 1] + m[2, 2], *m.diagonal()])
    k = int(trace.argmax())
    if k == 0:
        q = numpy.array([1 + trace[0], m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]])
    else:
        i, j, k = k - 1, k % 3, (k + 1) % 3
        q = numpy.zeros(4)
        q[0], q[1 + i], q[1 + j], q[1 + k] = (m[k, j] - m[j, k], 1 + m[i, i] - m[j, j] - m[k, k], m[i, j] + m[j, i],
                                              m[i, k] + m[k, i])
    return q / numpy.linalg.norm(q)


def turned(axis, angle):
    """The rotation matrix of an angle about an axis."""
    n = numpy.asarray(axis, float) / numpy.linalg.norm(axis)
    tilde = cross_matrix(n)
    return numpy.eye(3) + numpy.sin(angle) * tilde + (1 - numpy.cos(angle)) * tilde @ tilde


@dataclass
class Beam:
    """A beam in its own frame, as spar.Member.set_axis and set_sections take it."""
    name: str
    eta: numpy.ndarray  # [n]
    points: numpy.ndarray  # [n][3], m
    twist: numpy.ndarray  # [n], rad, right-handed about the tangent
    section_eta: numpy.ndarray  # [m]
    stiffness: numpy.ndarray  # [m][6][6]
    mass: numpy.ndarray  # [m][6][6]
    damping: numpy.ndarray = field(default_factory=lambda: numpy.zeros(6))  # [6], s
    masses: list = field(default_factory=list)  # (eta, 6x6 mass about the line)
    elements: int = 3
    nodes: int = 8  # of an element
    mass_damping: float = 0.0  # 1/s
    left_out: list = field(default_factory=list)  # what its file has and spar does not take

    def length(self):
        """m, of the line through the points."""
        return float(numpy.linalg.norm(numpy.diff(self.points, axis=0), axis=1).sum())

    def total_mass(self):
        """kg, with the masses that sit on it."""
        inner = (self.section_eta > 0) & (self.section_eta < 1)
        eta = numpy.concatenate([[0], self.section_eta[inner], [1]])
        density = numpy.interp(eta, self.section_eta, self.mass[:, 0, 0])
        mean = float(((density[1:] + density[:-1]) * numpy.diff(eta)).sum() / 2)
        return mean * self.length() + sum(matrix[0][0] for _, matrix in self.masses)

    def create(self, session, name=None):
        """The member, described, on a fixed root at the origin: give it a placement, a root and the commit."""
        member = session.beam_create(name or self.name, self.elements, self.nodes)
        member.set_axis(self.eta, self.points, self.twist)
        member.set_sections(self.section_eta, self.stiffness, self.mass)
        if numpy.any(self.damping):
            member.set_damping(self.damping)
        if self.mass_damping:
            member.set_mass_damping(self.mass_damping)
        if self.masses:
            member.set_masses([eta for eta, _ in self.masses], [matrix for _, matrix in self.masses])
        return member

    def modes(self, number=6):
        """Frequencies in Hz of the beam clamped at its root, at rest, without gravity."""
        with spar.Session() as session:
            member = self.create(session)
            member.commit()
            return member.solve_modes(number)[0]

    def damped(self, ratio):
        """Itself, with stiffness-proportional damping: this ratio of critical in the first mode, clamped."""
        self.damping = numpy.full(6, ratio / (numpy.pi * self.modes(1)[0]) if ratio else 0.0)
        return self

    def case_lines(self, name=None):
        """Its section of a case file, without a placement and a root."""
        row, column = numpy.triu_indices(6)
        lines = [f'[beam {name or self.name}]', f'elements {self.elements}', f'nodes {self.nodes}']
        lines += ['axis ' + _numbers(e, *x, t) for e, x, t in zip(self.eta, self.points, self.twist)]
        lines += ['section ' + _numbers(e, *k[row, column], *m[row, column])
                  for e, k, m in zip(self.section_eta, self.stiffness, self.mass)]
        if numpy.any(self.damping):
            lines.append('damping ' + _numbers(*self.damping))
        if self.mass_damping:
            lines.append('mass_damping ' + _numbers(self.mass_damping))
        lines += ['body ' + _numbers(e, *numpy.asarray(m)[row, column]) for e, m in self.masses]
        return lines

    def write_case(self, path, modes=10):
        """A case file for spar-run: modes of the clamped beam."""
        _write(path, [f'# {self.name}', *self.case_lines(), 'root fixed', '', '[host run]', 'do modes', f'modes {modes}'])


@dataclass
class Sections:
    """Blade elements of a blade: one entry for each section, from root to tip."""
    eta: numpy.ndarray  # [n], on the blade's line
    chord: numpy.ndarray  # [n], m
    twist: numpy.ndarray  # [n], rad, positive: the leading edge goes upwind
    centre: numpy.ndarray  # [n][2], m, aerodynamic centre from the line: to the suction side, to the trailing edge
    polars: list  # [n] of (alpha, cl, cd, cm), rad
    interpolation: list | None = None  # [n] SPAR_POLAR_*; None: linear


@dataclass
class Turbine:
    """A turbine whose rotor turns clockwise, seen from upwind."""
    name: str
    blade: Beam
    sections: Sections | None = None
    blades: int = 3
    hub_radius: float = 0.0  # m, from the rotor's apex to the blades' roots
    cone: float = 0.0  # rad, positive: the tips lean upwind
    tilt: float = 0.0  # rad, positive: the rotor looks up
    overhang: float = 0.0  # m, horizontal, from the tower's axis to the apex; negative: downwind
    shaft_height: float = 0.0  # m, apex above the tower's top
    hub: numpy.ndarray | None = None  # 6x6 mass about the apex; x along the shaft, downwind, y as global
    nacelle: numpy.ndarray | None = None  # 6x6 mass about the tower's top, in global axes
    generator_inertia: float = 0.0  # kg m^2, about the shaft, on its side of the gearbox
    drivetrain: tuple = (0.0, 0.0)  # N m/rad, N m s/rad; 0: rigid
    tower: Beam | None = None
    tower_base: float = 0.0  # m, height of the tower's base
    hanging: bool = False  # the tower goes down from its base: a floating marine turbine
    left_out: list = field(default_factory=list)  # what its file has and spar does not take
    air_density: float = 1.225  # kg/m^3; of a marine turbine that of the water
    rated_speed: float = 0.0  # rad/s
    rated_power: float = 0.0  # W
    tip_speed_ratio: float = 0.0
    pitch_table: tuple | None = None  # wind speeds, m/s, and the least pitch angles there, rad

    def shaft(self):
        """Direction of the shaft, downwind."""
        return numpy.array([numpy.cos(self.tilt), 0, -numpy.sin(self.tilt)])

    def top(self):
        """m, height of the tower's top."""
        length = self.tower.length() if self.tower is not None else 0.0
        return self.tower_base + (-length if self.hanging else length)

    def tower_axes(self):
        """Quaternion of the tower: its x along it, its y downwind."""
        return quaternion([[0, 1, 0], [0, 0, -1], [-1, 0, 0]] if self.hanging else [[0, 1, 0], [0, 0, 1], [1, 0, 0]])

    def apex(self):
        """Position of the rotor's apex."""
        return numpy.array([-self.overhang, 0, self.top() + self.shaft_height])

    def blade_placement(self, number, pitch=0.0):
        """Position and quaternion of a blade's root at azimuth 0 of the rotor; blade 0 is above the hub.
        pitch: rad, positive: the leading edge goes upwind"""
        n = self.shaft()
        radial = turned(n, 2 * numpy.pi * number / self.blades) @ [numpy.sin(self.tilt), 0, numpy.cos(self.tilt)]
        span = numpy.cos(self.cone) * radial - numpy.sin(self.cone) * n
        down = numpy.cos(self.cone) * n + numpy.sin(self.cone) * radial
        axes = turned(span, -pitch) @ numpy.column_stack([span, down, numpy.cross(span, down)])
        return self.apex() + self.hub_radius * span, quaternion(axes)

    def tip_radius(self):
        """m, of the tip from the shaft."""
        x, _ = self.blade_placement(0)
        out = x + self.blade.points[-1] @ self.blade_axes(0).T - self.apex()
        return float(numpy.linalg.norm(out - out @ self.shaft() * self.shaft()))

    def blade_axes(self, number, pitch=0.0):
        """The axes of a blade at its root, as columns."""
        w, x, y, z = self.blade_placement(number, pitch)[1]
        tilde = cross_matrix([x, y, z])
        return numpy.eye(3) + 2 * w * tilde + 2 * tilde @ tilde

    def masses(self):
        """kg, by part."""
        parts = {'blade': self.blade.total_mass(), 'hub': self.hub, 'nacelle': self.nacelle,
                 'tower': self.tower.total_mass() if self.tower is not None else None}
        return {name: float(m[0, 0]) if isinstance(m, numpy.ndarray) else m for name, m in parts.items() if m is not None}

    def least_pitch_at(self, wind):
        """rad, of the table of the controller; 0 without one."""
        return float(numpy.interp(wind, *self.pitch_table)) if self.pitch_table else 0.0

    def speed_at(self, wind):
        """rad/s: by the tip speed ratio, at most the rated one."""
        if not self.tip_speed_ratio or not self.rated_speed:
            raise ModelError(f'{self.name}: it has no tip speed ratio and rated speed; set tip_speed_ratio and rated_speed')
        return min(self.tip_speed_ratio * wind / self.tip_radius(), self.rated_speed)

    def steady(self, wind, pitch=None):
        """The rotor in an even wind, blades bent by air and rotation, without gravity: what one point of a power curve is.
        wind: m/s
        pitch: rad, None: the least, or more, so that the power is at most the rated one
        Answers speed (rad/s), pitch (rad), thrust (N), torque (N m), power (W), tip (m, downwind)."""
        low = self.least_pitch_at(wind) if pitch is None else pitch
        if pitch is not None or not self.rated_power:
            return self._point(wind, low)
        first, high = self._below(wind, low), low
        if first and first['power'] <= self.rated_power:
            return first
        last = None
        while last is None or last['power'] > self.rated_power:
            low, first, high = high, last or first, high + 0.05
            if high > 0.9:
                raise ModelError(f'{self.name}: at {wind} m/s no pitch up to {high:.2g} rad limits the power')
            last = self._below(wind, high)
        now = last
        while abs(now['power'] - self.rated_power) > 1e-4 * self.rated_power and high - low > 1e-7:
            share = 0.5
            if first is not None:  # the secant, inside the interval
                share = float(numpy.clip((first['power'] - self.rated_power) / (first['power'] - last['power']), 0.05, 0.95))
            now = self._point(wind, low + (high - low) * share)
            if now['power'] > self.rated_power:
                low, first = now['pitch'], now
            else:
                high, last = now['pitch'], now
        return now

    def _below(self, wind, pitch):
        """The point, None where the blades find no equilibrium: much beyond the rated power they may not."""
        try:
            return self._point(wind, pitch)
        except spar.NumericError:
            return None

    def _point(self, wind, pitch):
        with spar.Session() as session:
            rotor = self.build(session, self.speed_at(wind), pitch, rigid=True)
            rotor.start([wind, 0, 0])
            thrust, torque, power = rotor.aero.get_rotor()
            tip = rotor.blades[0].get_motion(v=None, a=None)[-1, :3] @ self.shaft()
        return {'speed': self.speed_at(wind), 'pitch': float(pitch), 'thrust': thrust, 'torque': torque, 'power': power,
                'tip': float(tip)}

    def build(self, session, speed=0.0, pitch=0.0, rigid=False):
        """The whole in a session: see Rotor.
        speed: rad/s, at the start; pitch: rad, at the start; rigid: no tower and nacelle, a hub that turns at this speed"""
        return Rotor(self, session, speed, pitch, rigid)

    def write_case(self, path, speed, pitch=0.0, wind=None, torque=None):
        """A case file for spar-run and the adapters.
        speed: rad/s; pitch: rad; wind: m/s along global x, None: no air
        torque: N m of the generator: the whole turbine, whose rotor turns freely from this speed on under air and torque
            None: the rotor alone, on roots that turn about the shaft at this speed"""
        n, apex = self.shaft(), self.apex()
        lines = [f'# {self.name}', '[session]', 'rtol 1e-4', 'rho_inf 0.9', '']
        spin = ['spin ' + _numbers(*(speed * n)), 'about ' + _numbers(*apex)]
        if torque is not None:
            lines[2:] = ['gravity 0 0 -9.81', *lines[2:]]
            lines += self._carrier_lines(torque, spin)
        for b in range(self.blades):
            x, q = self.blade_placement(b, pitch)
            lines += [*self.blade.case_lines(f'blade{b + 1}'), 'place ' + _numbers(*x), 'orientation ' + _numbers(*q)]
            if torque is None:
                lines += ['root driven', '']
            else:
                lines += ['root free', *spin, '', f'[joint bearing{b + 1}]', f'a blade{b + 1} 0', 'b hub 0', 'place ' + _numbers(*x),
                          'axes ' + _numbers(*q), '']
        if wind is not None:
            lines += self._aero_lines(path, wind)
        lines += ['[host run]', 'do run', 'dt 0.05', 'duration 10']
        if torque is None:
            lines += ['rotation ' + _numbers(*apex, *n, speed)]
        _write(path, lines)

    def _carrier_lines(self, torque, spin):
        """Tower, nacelle, generator and hub of a case file, with their joints, as Rotor has them."""
        self.need('tower', 'nacelle', 'hub')
        top = [0, 0, self.top()]
        place = ['place ' + _numbers(*self.apex()), 'orientation ' + _numbers(*quaternion(turned([0, 1, 0], self.tilt)))]
        frame = [place[0], place[1].replace('orientation', 'axes')]
        lines = [*self.tower.case_lines(), 'place ' + _numbers(0, 0, self.tower_base), 'orientation ' + _numbers(*self.tower_axes()),
                 'root fixed', '',
                 '[rigid nacelle]', 'mass ' + _numbers(*self.nacelle.ravel()), 'place ' + _numbers(*top), '',
                 '[joint yaw]', 'a nacelle 0', 'b tower last', '',
                 '[rigid hub]', 'mass ' + _numbers(*self.hub.ravel()), *place, *spin, '']
        carrier = 'hub'
        if self.drivetrain[0]:
            carrier = 'generator'
            lines += ['[rigid generator]', 'mass ' + _numbers(0, 0, 0, self.generator_inertia, 0, 0), *place, *spin,
                      'effects_off gravity gyroscopic', '', '[joint drivetrain]', 'a hub 0', 'b generator 0', 'free rx', *frame,
                      'stiffness ' + _numbers(0, 0, 0, self.drivetrain[0], 0, 0),
                      'damping ' + _numbers(0, 0, 0, self.drivetrain[1], 0, 0), '']
        return [*lines, '[joint shaft]', f'a {carrier} 0', 'b nacelle 0', 'free rx', *frame,
                'load ' + _numbers(0, 0, 0, -torque, 0, 0), '']

    def _aero_lines(self, path, wind):
        s = self.need_sections()
        names = ' '.join(f'blade{b + 1}' for b in range(self.blades))
        lines = ['[aero rotor]', f'blades {names}', 'wind ' + _numbers(wind, 0, 0),
                 'rotor ' + _numbers(*self.apex(), *self.shaft(), self.hub_radius * numpy.cos(self.cone), self.tip_radius()),
                 'density ' + _numbers(self.air_density), 'effects induction tip_loss hub_loss swirl drag moment']
        own = self.section_twist()
        for i, polar in enumerate(s.polars):
            name = f'{os.path.splitext(path)[0]}_{i}.polar'
            numpy.savetxt(name, numpy.column_stack(self._rows(i, polar)), fmt='%.17g', header='alpha (rad) cl cd cm')
            lines.append(f'section {_numbers(s.eta[i], s.chord[i], own[i])} {os.path.basename(name)} {_numbers(*s.centre[i])}')
        return [*lines, '']

    def _rows(self, i, polar):
        """Rows of a polar for a case file, which is linear between them: other curves get a row each tenth of a degree."""
        if self.sections.interpolation is None or self.sections.interpolation[i] == spar.POLAR_LINEAR:
            return polar
        curve = spar.Polar(*polar)
        curve.set_interpolation(self.sections.interpolation[i])
        alpha = numpy.union1d(polar[0], numpy.arange(polar[0][0], polar[0][-1], numpy.pi / 1800))
        return [alpha, *numpy.transpose([curve.evaluate(a) for a in alpha])]

    def need(self, *parts):
        """Refuses a turbine that lacks a part."""
        for part in parts:
            if getattr(self, part) is None:
                raise ModelError(f'{self.name}: it has no {part}; set Turbine.{part}, or take the rotor alone')

    def need_sections(self):
        """The blade elements, or a refusal."""
        if self.sections is None:
            raise ModelError(f'{self.name}: it has no airfoils; read a file that has them')
        return self.sections

    def section_twist(self):
        """Twist of the sections as spar.Aero.set_section takes it: from the beam's frames, whose z goes to the trailing edge."""
        s = self.need_sections()
        return s.twist + numpy.interp(s.eta, self.blade.eta, self.blade.twist) - numpy.pi / 2


class Rotor:
    """A turbine in a session.

    tower, nacelle, generator, hub, blades: members (tower, nacelle, generator: None if rigid)
    yaw, shaft, drive, bearings: joints; the shaft is free to turn about its x, bearings are driven about theirs
    air: a fluid of stations on each blade; aero: the blade elements, None without airfoils
    """

    def __init__(self, machine, session, speed, pitch, rigid):
        self.machine, self.session, self.rigid = machine, session, rigid
        self.tip_radius = machine.tip_radius()
        self.tower = self.nacelle = self.generator = self.hub = self.yaw = self.shaft = self.drive = self.aero = None
        self.bearings, self.blades, self.air = [], [], []
        self.pitch, self.angle, self.speed = pitch, 0.0, speed
        if not rigid:
            self._carry()
        for b in range(machine.blades):
            self._blade(b)
        if machine.sections is not None:
            self._air()

    def _carry(self):
        """Tower, nacelle, generator and hub, with their joints."""
        m, s = self.machine, self.session
        m.need('tower', 'nacelle', 'hub')
        self.tower = m.tower.create(s)
        self.tower.set_placement([0, 0, m.tower_base], m.tower_axes())
        self.tower.commit()
        top = self.tower.get_reference(q=None)[-1]
        self.nacelle = s.rigid_create('nacelle', top, [1, 0, 0, 0], m.nacelle)
        self.nacelle.commit()
        self.yaw = s.joint_create('yaw', self.nacelle, 0, self.tower, self.tower.get_count() - 1, 0)
        apex, axes = m.apex(), quaternion(turned([0, 1, 0], m.tilt))  # x of the shaft goes down
        self.hub = s.rigid_create('hub', apex, axes, m.hub)
        self.hub.commit()
        carrier = self.hub
        if m.drivetrain[0]:
            inertia = numpy.zeros((6, 6))
            inertia[3, 3] = m.generator_inertia
            self.generator = s.rigid_create('generator', apex, axes, inertia)
            self.generator.set_effects(0, spar.EFFECT_GRAVITY | spar.EFFECT_GYROSCOPIC)
            self.generator.commit()
            spring, damper = numpy.zeros((6, 6)), numpy.zeros((6, 6))
            spring[3, 3], damper[3, 3] = m.drivetrain
            self.drive = s.joint_create('drivetrain', self.hub, 0, self.generator, 0, spar.FREE_RX)
            self.drive.set_frame(apex, axes)
            self.drive.set_spring(spring, damper)
            carrier = self.generator
        self.shaft = s.joint_create('shaft', carrier, 0, self.nacelle, 0, spar.FREE_RX)
        self.shaft.set_frame(apex, axes)
        for part in (self.hub, self.generator):
            if part is not None:
                part.set_initial_velocity(apex, None, self.speed * m.shaft())

    def _blade(self, number):
        m, s = self.machine, self.session
        x, q = m.blade_placement(number, self.pitch)
        blade = m.blade.create(s, f'blade{number + 1}')
        blade.set_placement(x, q)
        blade.set_root(spar.ROOT_DRIVEN if self.rigid else spar.ROOT_FREE)
        blade.set_initial_velocity(m.apex(), None, self.speed * m.shaft())
        blade.commit()
        self.blades.append(blade)
        if self.hub is not None:
            bearing = s.joint_create(f'bearing{number + 1}', blade, 0, self.hub, 0, spar.FREE_RX)
            bearing.set_frame(x, q)
            bearing.set_driven(spar.FREE_RX)
            self.bearings.append(bearing)

    def _air(self):
        m, sections = self.machine, self.machine.sections
        for b, blade in enumerate(self.blades):
            air = blade.fluid_create(f'air{b + 1}')
            air.set_stations(sections.eta, numpy.column_stack([0 * sections.eta, sections.centre]))
            air.map()
            self.air.append(air)
        self.aero = spar.Aero(self.air)
        for i, (twist, rows) in enumerate(zip(m.section_twist(), sections.polars)):
            polar = spar.Polar(*rows)
            if sections.interpolation is not None:
                polar.set_interpolation(sections.interpolation[i])
            self.aero.set_section(i, sections.chord[i], twist, polar)
        self.aero.set_rotor(m.apex(), m.shaft(), m.hub_radius * numpy.cos(m.cone), self.tip_radius)
        self.aero.set_effects(spar.AERO_INDUCTION | spar.AERO_TIP_LOSS | spar.AERO_HUB_LOSS | spar.AERO_SWIRL | spar.AERO_DRAG
                              | spar.AERO_MOMENT)

    def _place(self):
        """Apex and direction of the shaft now."""
        m = self.machine
        hub, n = m.apex(), m.shaft()
        if self.hub is not None:
            q = self.hub.get_motion(v=None, a=None)[0]
            w, v = q[3], q[4:]
            hub, n = hub + q[:3], n + 2 * numpy.cross(v, numpy.cross(v, n) + w * n)
        return hub, n

    def blow(self, wind):
        """Computes the loads of the air from the latest motion, and pushes them: call it in every iteration of a step.
        wind: m/s, [3], or a function of positions x[n][3] that answers winds [n][3]"""
        hub, n = self._place()
        self.aero.set_rotor(hub, n, self.machine.hub_radius * numpy.cos(self.machine.cone), self.tip_radius)
        inflow = numpy.zeros((len(self.air), len(self.machine.sections.eta), 3))
        for b, air in enumerate(self.air):
            inflow[b] = wind(air.pull_motion(1.0, v=None)) if callable(wind) else wind
        self.aero.solve(self.machine.air_density, inflow, 1.0)

    def start(self, wind, rounds=4):
        """Brings the blades (and the tower) into equilibrium with the wind and the rotation, before the first step."""
        brake = numpy.zeros((6, 6))
        brake[3, 3] = 1e12  # N m/rad: at rest nothing else holds the shaft
        if not self.rigid:
            self.shaft.set_spring(brake)
        for _ in range(rounds):
            if self.aero is not None:
                self.blow(wind)
            for member in self.blades if self.rigid else [self.tower]:
                member.solve_static(4)
            self._spin()
        if not self.rigid:
            self.shaft.set_spring(None)
        if self.aero is not None:
            self.blow(wind)

    def _spin(self):
        """All that turns with the rotor does so about the shaft where it is now."""
        hub, n = self._place()
        for part in (*self.blades, self.hub, self.generator):
            if part is not None:
                part.set_initial_velocity(hub, None, self.speed * n)

    def set_torque(self, torque):
        """Torque of the generator, N m, against the rotation; from the next step."""
        self.shaft.set_load([0, 0, 0, -torque, 0, 0])

    def set_pitch(self, pitch, rate=0.0):
        """Pitch angle, rad, at the end of the next step, and its rate, rad/s."""
        for bearing in self.bearings:
            bearing.drive([0, 0, 0, self.pitch - pitch, 0, 0], [0, 0, 0, -rate, 0, 0], numpy.zeros(6))

    def get_speed(self):
        """rad/s, of the hub about the shaft, relative to the nacelle."""
        if self.rigid:
            return self.speed
        _, n = self._place()
        return float(n @ (self.hub.get_motion(q=None, a=None)[0, 3:] - self.nacelle.get_motion(q=None, a=None)[0, 3:]))

    def get_azimuth(self):
        """rad, of the first blade, from where it stands at azimuth 0; within one revolution."""
        if self.rigid:
            return self.angle % (2 * numpy.pi)
        q = self.hub.get_motion(v=None, a=None)[0, 3:]
        return float(2 * numpy.arctan2(q[1:] @ self.machine.shaft(), q[0]) % (2 * numpy.pi))

    def turn(self, dt):
        """Rigid rotors: drives the roots through the next step, at the speed `speed`."""
        m, n = self.machine, self.machine.shaft()
        self.angle += self.speed * dt
        rotation = turned(n, self.angle)
        q = quaternion(rotation)
        for b, blade in enumerate(self.blades):
            arm = m.blade_placement(b, self.pitch)[0] - m.apex()
            now = rotation @ arm
            omega = self.speed * n
            velocity = numpy.cross(omega, now)
            blade.drive([*(now - arm), *q], [*velocity, *omega], [*numpy.cross(omega, velocity), 0, 0, 0])


def _numbers(*values):
    return ' '.join(f'{value:.17g}' for value in values)


def _write(path, lines):
    with open(path, 'w', encoding='utf-8') as file:
        file.write('\n'.join(lines) + '\n')
