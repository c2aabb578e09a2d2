"""The IEA 15-MW turbine from its windIO file: masses, frequencies, the steady curve, and a gust on the whole turbine.
    iea15.py [FILE.yaml [OUT]] [--controller LIBRARY INPUT]
FILE: default the one of the package windIO (pip install windio PyYAML matplotlib); a turbine of windIO 2, IEA-22 too
OUT: writes OUT.csv, and OUT.png where matplotlib is
--controller: a gust through rated wind twice, with spar's controller and with this library of Bladed's interface, for example
    ROSCO with its input file for this turbine (pip install rosco). Nothing else is computed.
"""
import argparse
import importlib.util
import os

import numpy
import spar
from spar import controller, windio

# BeamDyn's blade file of the turbine has these coefficients, s; the windIO file has none
DAMPING = numpy.array([0.00084171, 0.00299005, 0.00218775, 0.00084171, 0.00218775, 0.00299005])


def packaged():
    """The file in the package windIO."""
    found = importlib.util.find_spec('windIO')
    if found is None:
        raise SystemExit('name a windIO file, or: pip install windio')
    return os.path.join(os.path.dirname(found.origin), 'examples', 'turbine', 'IEA-15-240-RWT.yaml')


def frequencies(machine):
    """Hz, of the whole turbine at rest with its shaft braked, and of the blade alone."""
    with spar.Session() as session:
        rotor = machine.build(session)
        brake = numpy.zeros((6, 6))
        brake[3, 3] = 1e13
        rotor.shaft.set_spring(brake)
        return rotor.tower.solve_modes(10)[0], machine.blade.modes(6)


def steady(machine):
    """One row for each wind: wind, rev/min, pitch in degrees, MW, MN, tip in m."""
    rows = []
    for wind in (4, 5, 6, 7, 8, 9, 10, 10.5, 11, 12, 14, 16, 18, 20, 22, 25):
        p = machine.steady(wind)
        rows.append([wind, p['speed'] * 30 / numpy.pi, numpy.degrees(p['pitch']), p['power'] / 1e6, p['thrust'] / 1e6, p['tip']])
    return numpy.array(rows)


def gust(machine, mean=9.0, rise=3.0, seconds=50.0, dt=0.05):
    """The whole turbine at `mean`, at a torque that follows the square of its speed; from 20 to 30 s a gust comes and goes."""
    start, rows = machine.steady(mean), []
    with spar.Session() as session:
        session.set_coupling(spar.COUPLING_IQN_ILS, 1.0, 1e-3, 30)
        session.set_integrator(0.7, 1)
        session.set_gravity([0, 0, -9.81])
        rotor = machine.build(session, start['speed'], start['pitch'])
        rotor.start([mean, 0, 0])
        for step in range(round(seconds / dt)):
            t = (step + 1) * dt
            wind = mean + (rise / 2 * (1 - numpy.cos(2 * numpy.pi * (t - 20) / 10)) if 20 < t < 30 else 0)
            torque = start['torque'] * (rotor.get_speed() / start['speed'])**2
            rotor.set_torque(torque)
            session.step(dt, lambda *_, wind=wind: rotor.blow([wind, 0, 0]))
            root = rotor.bearings[0].get_load()
            top = rotor.tower.get_motion(v=None, a=None)[-1, 0]
            rows.append([t, wind, rotor.get_speed() * 30 / numpy.pi, rotor.get_speed() * torque / 1e6, rotor.aero.get_rotor()[0] / 1e6,
                         top, -root[5] / 1e6])
    return numpy.array(rows)


# Quasi-steady air hardly damps the torsion of these blades (3.4 Hz): pitching in a gust excites it
AIR = (spar.AERO_INDUCTION | spar.AERO_TIP_LOSS | spar.AERO_HUB_LOSS | spar.AERO_SWIRL | spar.AERO_DRAG | spar.AERO_MOMENT
       | spar.AERO_UNSTEADY | spar.AERO_INFLOW)


def controlled(machine, control, mean=10.0, rise=4.0, seconds=120.0, dt=0.05):
    """The whole turbine under a controller; from 60 to 75 s a gust through rated wind comes and goes."""
    start, rows = machine.steady(mean), []
    with spar.Session() as session:
        session.set_coupling(spar.COUPLING_IQN_ILS, 1.0, 1e-3, 30)
        session.set_integrator(0.7, 1)
        session.set_gravity([0, 0, -9.81])
        rotor = machine.build(session, start['speed'], start['pitch'])
        rotor.aero.set_effects(AIR)
        rotor.start([mean, 0, 0])
        pitch, torque, wind = start['pitch'], start['torque'], mean
        for step in range(round(seconds / dt)):
            t, before = (step + 1) * dt, pitch
            pitch, torque = control.step(controller.measure(rotor, t - dt, dt, wind, torque, pitch))
            wind = mean + (rise / 2 * (1 - numpy.cos(2 * numpy.pi * (t - 60) / 15)) if 60 < t < 75 else 0)
            rotor.set_pitch(pitch, (pitch - before) / dt)
            rotor.set_torque(torque)
            session.step(dt, lambda *_, wind=wind: rotor.blow([wind, 0, 0]))
            rows.append([t, wind, rotor.get_speed() * 30 / numpy.pi, numpy.degrees(pitch), rotor.get_speed() * torque / 1e6,
                         rotor.aero.get_rotor()[0] / 1e6, rotor.tower.get_motion(v=None, a=None)[-1, 0]])
    control.close()
    return numpy.array(rows)


def compare(machine, library, given, out):
    """The gust with both controllers: a table, OUT.csv and OUT.png."""
    runs = {"spar's": controlled(machine, controller.Regions(machine)),
            os.path.basename(library): controlled(machine, controller.Library(library, given, (out or 'iea15') + '-controller'))}
    print('gust from 10 to 14 m/s      before: rev/min, MW    highest rev/min     MW  degrees  least MN  at the end: rev/min, MW')
    for name, rows in runs.items():
        calm, after = rows[(rows[:, 0] > 50) & (rows[:, 0] < 60)], rows[rows[:, 0] > 60]
        print('%-27s %14.2f %5.2f %18.2f %6.2f %8.2f %9.2f %20.2f %4.2f' % (
            name, calm[:, 2].mean(), calm[:, 4].mean(), after[:, 2].max(), after[:, 4].max(), after[:, 3].max(), after[:, 5].min(),
            rows[-100:, 2].mean(), rows[-100:, 4].mean()))
    if out:
        rows = list(runs.values())
        names = ',speed_rpm,pitch_deg,power_MW,thrust_MN,tower_top_m'
        numpy.savetxt(out + '.csv', numpy.hstack([rows[0], rows[1][:, 2:]]), delimiter=',', fmt='%.6g', comments='',
                      header='t_s,wind_m_s' + names + names.replace(',', ',library_'))
        plot_controlled(out + '.png', runs, machine.name)


def panels(name):
    """A figure of two rows of three axes; None without matplotlib."""
    try:
        import matplotlib  # pylint: disable=import-outside-toplevel
    except ImportError:
        print('no matplotlib: no picture')
        return None, None
    matplotlib.use('Agg')
    from matplotlib import pyplot  # pylint: disable=import-outside-toplevel
    figure, axes = pyplot.subplots(2, 3, figsize=(12, 6), constrained_layout=True)
    figure.suptitle(name)
    return figure, axes


def plot_controlled(path, runs, name):
    """Wind, speed, pitch, power, thrust and the tower's top, with each controller."""
    figure, axes = panels(name)
    if figure is None:
        return
    titles = ('wind, m/s', 'rotor speed, rev/min', 'pitch, degrees', 'power, MW', 'thrust, MN', "tower's top, downwind, m")
    for k, (axis, title) in enumerate(zip(axes.ravel(), titles)):
        for label, rows in runs.items():
            late = rows[:, 0] > 40
            axis.plot(rows[late, 0], rows[late, k + 1], label=label)
        axis.set_title(title, fontsize=10)
        axis.set_xlabel('t, s')
        axis.grid(alpha=0.3)
    axes[0, 1].legend()
    figure.savefig(path, dpi=110)


def picture(path, curve, motion, name):
    """Steady curve above, gust below."""
    figure, axes = panels(name)
    if figure is None:
        return
    for axis, x, y, label, unit in ((axes[0, 0], curve[:, 0], curve[:, 3], 'aerodynamic power, MW', 'wind, m/s'),
                                    (axes[0, 1], curve[:, 0], curve[:, 4], 'thrust, MN', 'wind, m/s'),
                                    (axes[0, 2], curve[:, 0], curve[:, 2], 'pitch, degrees', 'wind, m/s'),
                                    (axes[1, 0], motion[:, 0], motion[:, 2], 'rotor speed, rev/min', 't, s'),
                                    (axes[1, 1], motion[:, 0], motion[:, 3], 'shaft power, MW', 't, s'),
                                    (axes[1, 2], motion[:, 0], motion[:, 5], "tower's top, downwind, m", 't, s')):
        axis.plot(x, y)
        axis.set_xlabel(unit)
        axis.set_title(label, fontsize=10)
        axis.grid(alpha=0.3)
    figure.savefig(path, dpi=110)


def main():
    """All of it, or the controllers."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('file', nargs='?')
    parser.add_argument('out', nargs='?')
    parser.add_argument('--controller', nargs=2, metavar=('LIBRARY', 'INPUT'))
    said = parser.parse_args()
    machine = windio.read(said.file or packaged())
    machine.blade.elements, machine.blade.nodes, machine.tower.elements, machine.blade.damping = 2, 7, 1, DAMPING
    print(machine.name)
    if said.controller:
        compare(machine, *said.controller, said.out)
        return
    print('masses, t:', ', '.join(f'{name} {mass / 1e3:.1f}' for name, mass in machine.masses().items()))
    whole, blade = frequencies(machine)
    print('blade, Hz:', ' '.join(f'{f:.3f}' for f in blade))
    print('turbine, Hz:', ' '.join(f'{f:.3f}' for f in whole))
    curve = steady(machine)
    print('wind, m/s  rev/min  pitch, degrees      MW      MN  tip, m')
    for row in curve:
        print('%9.1f %8.2f %15.2f %7.3f %7.3f %7.2f' % tuple(row))
    motion = gust(machine)
    print(f'gust from {motion[0, 1]:.0f} to {motion[:, 1].max():.0f} m/s: speed up to {motion[:, 2].max():.2f} rev/min, '
          f"the tower's top from {motion[300:400, 5].mean():.2f} to {motion[:, 5].max():.2f} m")
    if said.out:
        numpy.savetxt(said.out + '.csv', motion, delimiter=',', fmt='%.6g', comments='',
                      header='t_s,wind_m_s,speed_rpm,shaft_power_MW,thrust_MN,tower_top_m,root_1_moment_MNm')
        picture(said.out + '.png', curve, motion, machine.name)


if __name__ == '__main__':
    main()
