"""Controllers of a turbine, called once a step: the usual regions of torque and pitch, or a library with Bladed's interface.

    control = spar.controller.Regions(machine)                                 made from the turbine's steady points
    control = spar.controller.Library('libdiscon.so', 'DISCON.IN')             ROSCO, or another library with DISCON
    pitch, torque = control.step(spar.controller.measure(rotor, t, dt, wind))  then rotor.set_pitch, rotor.set_torque

Units are SI, angles are in radians. Torque and speed are those of the generator.
"""
from __future__ import annotations

import ctypes
import os
from dataclasses import dataclass

import numpy

_TEXT, _RECORDS = 1024, 3300  # length of texts; records of the interface, with ROSCO's own behind those of the manual


class ControllerError(RuntimeError):
    """A controller's library cannot be used, or it has failed. The message has the library's own words."""


@dataclass
class Measures:
    """What a controller is told at the beginning of a step."""
    t: float  # s
    dt: float  # s, length of the step
    speed: float  # rad/s, rotor
    generator_speed: float  # rad/s
    torque: float  # N m, generator
    pitch: float  # rad
    wind: float = 0.0  # m/s, at the hub
    azimuth: float = 0.0  # rad, of the first blade
    out_of_plane: tuple = (0.0, 0.0, 0.0)  # N m, bending moments of the blades' roots
    in_plane: tuple = (0.0, 0.0, 0.0)
    top: tuple = (0.0, 0.0)  # m/s^2, acceleration of the tower's top: downwind, sideways


def measure(rotor, t, dt, wind=0.0, torque=0.0, pitch=0.0, gear_ratio=1.0):
    """Measures of a spar.turbine.Rotor at the time t.
    dt: s, of the next step; wind: m/s, at the hub; torque: N m, of the generator in the last step; pitch: rad, at t"""
    speed = rotor.get_speed()
    loads = [bearing.get_load() for bearing in rotor.bearings]
    top = rotor.tower.get_motion(q=None, v=None)[-1]
    return Measures(t, dt, speed, gear_ratio * speed, torque, pitch, wind, rotor.get_azimuth(),
                    tuple(-load[5] for load in loads), tuple(-load[4] for load in loads), (top[0], top[1]))


def _inertia(machine):
    """kg m^2, of all that turns, about the shaft."""
    blade = machine.blade
    radius = numpy.interp(blade.section_eta, blade.eta, blade.points[:, 0]) + machine.hub_radius
    density = blade.mass[:, 0, 0] * radius**2
    inertia = float(((density[1:] + density[:-1]) * numpy.diff(blade.section_eta)).sum() / 2) * blade.length()
    inertia += sum(m[0][0] * (machine.hub_radius + eta * blade.length())**2 for eta, m in blade.masses)
    return machine.blades * inertia + (machine.hub[3, 3] if machine.hub is not None else 0) + machine.generator_inertia


class Regions:
    """Torque by the square of the speed below rated, constant power above, with a line between. Pitch by a PI on the speed,
    whose gain follows the pitch (Hansen et al., Risoe-R-1500, 2005). Both see the speed through a filter of first order.

    machine: spar.turbine.Turbine with airfoils, rated speed and power; winds: m/s, above rated, where the gain is computed
    frequency (rad/s), ratio: of the closed loop of the speed; rate: rad/s, the fastest pitch; corner: rad/s, of the filter
    """

    def __init__(self, machine, frequency=0.2, ratio=0.8, rate=0.07, corner=1.5, gear_ratio=1.0, winds=(12.0, 15.0, 19.0, 24.0)):
        self.rated, self.power, self.rate, self.corner = machine.rated_speed, machine.rated_power, rate, corner
        self.gear, self.speed, self.pitch, self.integral = gear_ratio, None, None, None
        low = machine.steady(0.7 * self.rated * machine.tip_radius() / machine.tip_speed_ratio)
        self.optimal = low['torque'] / low['speed']**2
        self.fine = low['pitch']
        points, slope, step = [machine.steady(wind) for wind in winds], [], 0.01
        for wind, p in zip(winds, points):
            up, down = (machine.steady(wind, p['pitch'] + sign * step) for sign in (1, -1))
            slope.append((down['torque'] - up['torque']) / (2 * step))
        self.at = numpy.array([p['pitch'] for p in points])
        inertia = _inertia(machine)
        self.proportional = 2 * ratio * frequency * inertia / numpy.array(slope)
        self.part = frequency / (2 * ratio)  # of the integral gain in the proportional one, 1/s

    def _torque(self, speed, pitched):
        """N m, on the shaft."""
        low, high = 0.92 * self.rated, 0.99 * self.rated
        if pitched or speed >= high:
            return self.power / max(speed, high)
        below, top = self.optimal * min(speed, low)**2, self.power / high
        return below + max(0.0, speed - low) / (high - low) * (top - below)

    def step(self, m):
        """Pitch (rad) and torque (N m, generator) at the end of the step."""
        if self.integral is None:
            self.speed, self.pitch, self.integral = m.speed, m.pitch, m.pitch
        self.speed += (1 - numpy.exp(-self.corner * m.dt)) * (m.speed - self.speed)
        gain = float(numpy.interp(self.pitch, self.at, self.proportional))
        error = self.speed - self.rated
        self.integral = max(self.fine, self.integral + gain * self.part * error * m.dt)
        wanted = max(self.fine, self.integral + gain * error)
        self.pitch += float(numpy.clip(wanted - self.pitch, -self.rate * m.dt, self.rate * m.dt))
        return self.pitch, self._torque(self.speed, self.pitch > self.fine + 0.02) / self.gear

    def close(self):
        """Nothing to end."""


class Library:
    """A library with Bladed's interface, the function DISCON (Bladed user manual, appendix A). All blades take one pitch.
    One library in one process: most keep their state in static variables.

    path: of the library; input_file: of its parameters; root: what it may name its own files after
    """

    def __init__(self, path, input_file, root='controller'):
        if not os.path.isfile(input_file):
            raise ControllerError(f'controller: {input_file} is not there; name the file of its parameters')
        try:
            self._call = ctypes.CDLL(os.path.abspath(path)).DISCON
        except OSError as error:
            raise ControllerError(f'controller: {error}') from None
        except AttributeError:
            raise ControllerError(f'controller: {path} has no function DISCON; a library with Bladed\'s interface is wanted') from None
        self._call.restype = None
        self.name, self._input, self._root = path, input_file.encode(), root.encode()
        self._swap, self._called = (ctypes.c_float * _RECORDS)(), False

    def _enter(self, status):
        swap, fail = self._swap, ctypes.c_int(0)
        message = ctypes.create_string_buffer(_TEXT)
        self._set({1: status, 49: _TEXT - 1, 50: len(self._input), 51: len(self._root), 64: _TEXT - 1})
        self._call(swap, ctypes.byref(fail), ctypes.create_string_buffer(self._input, _TEXT),
                   ctypes.create_string_buffer(self._root, _TEXT), message)
        if fail.value < 0:
            said = message.value.decode(errors='replace').strip()
            raise ControllerError(f'controller: {self.name}: {said or "failed without a message"}')

    def _set(self, records):
        for number, value in records.items():
            self._swap[number - 1] = value

    def step(self, m):
        """Pitch (rad) and torque (N m, generator) at the end of the step."""
        self._set({2: m.t, 3: m.dt, 4: m.pitch, 14: m.torque * m.generator_speed, 15: m.torque * m.generator_speed,
                   20: m.generator_speed, 21: m.speed, 23: m.torque, 27: m.wind, 33: m.pitch, 34: m.pitch, 53: m.top[0],
                   54: m.top[1], 60: m.azimuth, 61: len(m.out_of_plane)})
        for b, (out, inside) in enumerate(zip(m.out_of_plane, m.in_plane)):
            self._set({30 + b: out, 69 + b: inside})
        self._enter(1 if self._called else 0)
        self._called = True
        pitch, torque = self._swap[44], self._swap[46]
        if self._swap[27] == 1:  # a pitch of each blade
            pitch = self._swap[41]
            if any(self._swap[41 + b] != pitch for b in range(len(m.out_of_plane))):
                raise ControllerError(f'controller: {self.name}: demands another pitch of each blade, and this turbine has one; '
                                      'switch individual pitch off')
        if not numpy.isfinite([pitch, torque]).all():
            raise ControllerError(f'controller: {self.name}: demands a pitch or torque that is no number')
        return pitch, torque

    def close(self):
        """Tells the library that the run has ended."""
        if self._called:
            self._called = False
            self._enter(-1)
