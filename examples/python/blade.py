"""Frequencies of the NREL 5-MW blade over the rotor's speed (a Campbell diagram's lines), then a gust on the turning blade.
    blade.py [<csv of the tip's motion>]
Needs the package spar: `pip install .`, or PYTHONPATH=python with SPAR_LIBRARY.
"""
import os
import sys

import numpy
import spar

DATA = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'data', 'nrel5mw')
LENGTH, HUB = 61.5, 1.5


def matrices(upper):
    """[n][21] upper triangles as [n][6][6]."""
    full = numpy.zeros((len(upper), 6, 6))
    row, column = numpy.triu_indices(6)
    full[:, row, column] = upper
    full[:, column, row] = upper
    return full


def blade_of(session, omega):
    """A blade along x on a root that turns about z; lies still for omega = 0."""
    eta, x, y, z, twist = numpy.loadtxt(os.path.join(DATA, 'axis.txt')).T
    sections = numpy.loadtxt(os.path.join(DATA, 'sections.txt'))
    blade = session.beam_create('blade', 1, 10)
    blade.set_axis(eta, numpy.column_stack([x, y, z]), -numpy.radians(twist))
    blade.set_sections(sections[:, 0], matrices(sections[:, 1:22]), matrices(sections[:, 22:43]))
    blade.set_placement([HUB, 0, 0], [1, 0, 0, 0])
    blade.set_root(spar.ROOT_DRIVEN)
    blade.set_initial_velocity([0, 0, 0], [0, 0, 0], [0, 0, omega])
    blade.commit()
    blade.solve_static(1)  # centrifugal loads
    return blade


def gust(rpm, seconds=8.0, dt=0.02):
    """The tip out of the rotor's plane under a pressure that swells and goes, with drag against the blade's own motion."""
    omega, history = rpm * numpy.pi / 30, []
    with spar.Session() as s:
        s.set_coupling(spar.COUPLING_IQN_ILS, 1e-3, 1e-6, 30)
        blade = blade_of(s, omega)
        fluid = blade.fluid_create('strips')
        fluid.set_stations(numpy.linspace(0, 1, 31))
        fluid.map()
        strip = LENGTH / 30

        def load(_session, t, step, _iteration):
            v = fluid.pull_motion(1.0, x=None)
            push = 800.0 * numpy.sin(numpy.pi * min((t + step) / 4, 1)) ** 2  # N/m
            force = numpy.zeros_like(v)
            force[:, 2] = (push - 150.0 * v[:, 2]) * strip
            fluid.push_forces(force)

        for n in range(round(seconds / dt)):
            angle = omega * (n + 1) * dt
            root = [numpy.cos(angle) * HUB - HUB, numpy.sin(angle) * HUB, 0, numpy.cos(angle / 2), 0, 0, numpy.sin(angle / 2)]
            centre = numpy.array([numpy.cos(angle), numpy.sin(angle), 0]) * HUB
            turn = numpy.array([0, 0, omega])
            velocity = numpy.concatenate([numpy.cross(turn, centre), turn])
            blade.drive(root, velocity, numpy.concatenate([-omega**2 * centre, [0, 0, 0]]))
            s.step(dt, load)
            history.append((s.get_time()[0], blade.get_motion(v=None, a=None)[-1, 2]))
    return numpy.array(history)


if __name__ == '__main__':
    print('rev/min  frequencies, Hz')
    for rpm in (0, 4, 8, 12.1):
        with spar.Session() as still:
            frequency, _ = blade_of(still, rpm * numpy.pi / 30).solve_modes(5)
        print(f'{rpm:7.1f}', ' '.join(f'{f:8.4f}' for f in frequency))
    tip = gust(12.1)
    print(f'gust at 12.1 rev/min, seen from the root: the tip goes {tip[:, 1].max():.3f} m out of the plane, '
          f'{abs(tip[-1, 1]):.1e} m at {tip[-1, 0]:.1f} s')
    if len(sys.argv) > 1:
        numpy.savetxt(sys.argv[1], tip, delimiter=',', header='t_s,tip_m', comments='')
