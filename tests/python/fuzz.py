"""Random calls of the package spar, with right, wrong and hostile arguments. Results lie between poisoned guards. Callbacks call, raise
and answer nonsense, the collector runs at random, handles are closed and forgotten. Then the same from several threads.
Each call answers or raises TypeError, ValueError or spar.Error with a status and a message; the process does not end early.
    fuzz.py [<calls> [<seed> [<threads> [<folder to write in>]]]]
With one thread the same seed makes the same calls.
"""
import collections
import faulthandler
import gc
import os
import pathlib
import random
import sys
import tempfile
import threading

import guards
import numpy
import spar
from spar import _table

CALLS = [call for call in spar._calls.values() if call.public]  # pylint: disable=protected-access
HOSTILE_INTEGERS = [-1, 0, 1, 7, 65, 1001, 2**31 - 1, 2**31, -2**31, 2**32, 2**32 + 1, 2**62, 2**63 - 1, 2**63, 2**64, -2**63, 10**30, True,
                    1.0, 1.5, '1', None, float('nan'), 1j, numpy.int8(3), numpy.uint64(2**64 - 1), numpy.array(2), numpy.array([1, 2]), b'1',
                    [], object()]
HOSTILE_REALS = [float('nan'), float('inf'), -float('inf'), 1e308, -1e308, 5e-324, 0, -0.0, -1, 10**400, '1', None, 1j, numpy.float32(1),
                 numpy.array(1.0), numpy.array([1.0, 2.0]), b'1', [], object()]
HOSTILE_TEXTS = ['', 'a\0b', b'\xff\xfe', 'x' * 5000, 'a name', 'k\u00f6rper', '\ud800', 5, None, 1.5, pathlib.Path('x'), [], '%s%n%d', 'a\nb']
HOSTILE_ANSWERS = [1, -1, 7, 2**31, 2**32, 0.5, 'x', numpy.array([1, 2]), float('nan'), object(), True, numpy.True_, [], b'']
INTEGERS = {'steps': (8, 10), 'load_steps': (1, 3), 'nodes_per_element': (2, 5), 'elements': (1, 3), 'max_iterations': (1, 25),
            'substeps': (1, 2), 'threads': (1, 2), 'memory': (0, 3), 'modes': (0, 3), 'width': (0, 4), 'n': (0, 4), 'node': (0, 4),
            'node_a': (0, 4), 'node_b': (0, 4), 'i': (0, 4), 'free_motions': (0, 63), 'mask': (0, 63), 'total': (1, 3), 'scheme': (0, 3),
            'switch_on': (0, 4095), 'switch_off': (0, 4095), 'which': (0, 1), 'component': (1, 8), 'effects': (0, 2047), 'goals': (0, 31)}
BOUNDED = {'steps', 'load_steps', 'elements', 'max_iterations', 'substeps', 'memory', 'modes', 'threads', 'total'}  # work grows with them
REALS = {'dt': (1e-3, 0.05), 'theta': (0, 1), 'tolerance': (0.05, 0.5), 'length': (0.1, 1), 'amplitude': (0, 1e-3), 'drift': (1e-3, 1),
         'within': (0.01, 0.2), 'beyond': (0.2, 2), 'density': (0, 2), 'poisson': (0, 0.5), 'young': (1e6, 1e11), 'rho_inf': (0, 1)}
OPTIONS = [('coupling.reuse', '3'), ('coupling.norm', 'loads'), ('coupling.unconverged', 'accept'),
           ('coupling.unstable', 'accept'), ('theta', 'group'), ('far', 'refuse'), ('ramp', '0.1'), ('limit', '4'), ('nodes', 'keep')]
OFTEN = {'spar_step': 20, 'spar_step_begin': 3, 'spar_step_solve': 6, 'spar_step_check': 6, 'spar_step_accept': 6, 'spar_step_reject': 8,
         'spar_step_adaptive': 5, 'spar_fluid_push_forces': 8, 'spar_fluid_pull_motion': 4, 'spar_aero_solve': 8, 'spar_trial_run': 4,
         'spar_fluid_map': 4, 'spar_fluid_push_states': 3, 'spar_fluid_pull_states': 3, 'spar_session_set_log': 3}
RARE = {'spar_trial_advise': 0.02, 'spar_trial_report_effects': 0.03, 'spar_aero_report_effects': 0.03, 'spar_trial_solve_floquet': 0.02,
        'spar_trial_solve_eigenvalues': 0.1, 'spar_session_save': 0.2, 'spar_session_load': 0.2, 'spar_member_write_vtk': 0.1,
        'spar_fluid_write_vtk': 0.1, 'spar_vtk_series_add': 0.1, 'spar_session_solve_static': 0.3, 'spar_member_solve_static': 0.3,
        'spar_session_set_threads': 0.1}


WEIGHED = [call for call in CALLS for _ in range(OFTEN.get(call.name, 1))]


class Raised(Exception):
    """By a callback of the fuzzer."""


class Fuzzer:
    """One thread's random calls on what all threads share."""

    def __init__(self, seed, folder, things, limit):
        self.random, self.folder, self.things, self.limit = random.Random(seed), folder, things, limit
        self.made, self.depth, self.outcomes, self.last = 0, 0, collections.Counter(), collections.deque(maxlen=12)

    # ---- arguments ----

    def chance(self, part):
        """Whether something happens that happens in this part of all cases."""
        return self.random.random() < part

    def integer(self, name):
        if self.chance(0.06):
            value = self.random.choice(HOSTILE_INTEGERS)
            if name not in BOUNDED or not isinstance(value, int) or value < 1 or value >= 2**31:
                return value
        low, high = INTEGERS.get(name, (0, 3))
        return self.random.randint(low, high)

    def real(self, name):
        if self.chance(0.05):
            return self.random.choice(HOSTILE_REALS)
        low, high = REALS.get(name, (0, 1))
        return self.random.uniform(low, high)

    def text(self, p, call):
        if self.chance(0.06):
            return self.random.choice(HOSTILE_TEXTS)
        if 'path' in p.name or p.name == 'file':
            return os.path.join(self.folder, self.random.choice(('a.spar', 'b.spar', 'a.vtu', 'b.vtp', 'c.pvd', 'none')))
        if p.name == 'name':
            return f'{call.python_name}{self.random.randint(0, 10**6)}'
        return self.random.choice(self.random.choice(OPTIONS)) if self.chance(0.1) else None

    def array(self, p, owner, given):
        """Numbers of the header's shape, in one of many forms; some with another shape, or no numbers."""
        kind = spar._NUMBERS[p.type][1]  # pylint: disable=protected-access
        shape = []
        for d in p.dims:
            if isinstance(d, str):
                d = given.get(d) if isinstance(given.get(d), int) else None if owner is None or d in ('n', 'capacity') else self.size(owner, d)
                d = given.setdefault('n of this call', self.random.randint(0, 4)) if d is None or not 0 <= d < 100 else d
            shape.append(int(d))
        if self.chance(0.04) and shape:
            shape[self.random.randrange(len(shape))] += self.random.choice((-1, 1, 2, 40))
            shape = [max(0, d) for d in shape]
        value = numpy.zeros(shape, kind) if kind.kind == 'i' else self.numbers(p, shape)
        return self.form(value.astype(kind)) if self.chance(0.2) else value.astype(kind)

    def size(self, owner, d):
        try:
            return owner.size(d, {'which': self.random.randint(0, 1)}) if owner.handle and not owner.closed() else None
        except spar.Error:
            return None

    def numbers(self, p, shape):
        value = numpy.full(shape, self.random.uniform(-0.1, 0.1))
        if p.name in ('eta', 'span', 'alpha_rad') and value.ndim == 1:
            value = numpy.linspace(0, 1, len(value))
        elif shape and shape[-1] == 36:
            value[...] = numpy.diag([1e3, 1e3, 1e3, 1, 1, 1] if p.name == 'stiffness' else [1, 1, 1, 1e-2, 1e-2, 1e-2]).ravel()
        elif p.dims[-1] in (4, 7) and value.shape[-1:] >= (4,):
            value[...] = 0
            value[..., -4] = 1
        elif p.name in ('xyz', 'axis', 'up', 'top', 'point_b') and value.size:
            value[...] = 0
            value[..., 0] = numpy.linspace(0, 1, len(value)) if value.ndim > 1 else 1
        if self.chance(0.02) and value.size:
            value.flat[self.random.randrange(value.size)] = self.random.choice((float('nan'), float('inf'), 1e300, -1e300))
        return value

    def form(self, value):
        """The same numbers otherwise, or something that is none."""
        what = self.random.randrange(15)
        if what == 0:
            return value.tolist()
        if what == 1:
            return numpy.asfortranarray(value)
        if what == 2:
            return numpy.repeat(value, 2, axis=0)[::2] if value.ndim else value
        if what == 3:
            return value.astype(numpy.float32)
        if what == 4:
            return value.ravel()
        if what == 5:
            odd = numpy.frombuffer(bytearray(value.nbytes + 1), numpy.uint8)[1:].view(value.dtype).reshape(value.shape)
            odd[...] = value
            return odd
        if what == 6:
            value.flags.writeable = False
            return value
        if what == 7:
            return numpy.ma.array(value, mask=numpy.arange(value.size).reshape(value.shape) % 2)
        if what == 8:
            return value.astype(value.dtype.newbyteorder())
        return self.random.choice((None, 5, 'x', object(), value.astype(complex), value.astype(object), [[1], [1, 2]], numpy.array('x'), {},
                                   numpy.zeros((3, 0)), numpy.array(2.0), [2**70], numpy.zeros(3, 'M8[s]')))

    def thing(self, kind, owner):
        """A handle; most are of the kind that is asked for."""
        if self.chance(0.03):
            return self.random.choice((None, 5, 'body', object(), spar, owner))
        if self.chance(0.03):
            kind = self.random.choice(list(self.things))
        session = owner.session if owner is not None and self.chance(0.9) else None
        fitting = [thing for thing in self.things[kind] if session is None or thing.session in (session, None)]
        return self.random.choice(fitting) if fitting else None

    def argument(self, call, p, owner, given):
        """A value for a parameter."""
        if p.how == 'callback':
            return self.callback()
        if p.how == 'list':
            return [self.thing(p.type, owner) for _ in range(self.random.choice((0, 1, 1, 1, 2)))] if self.chance(0.97) else 5
        if p.type in _table.CLASSES:
            return None if p.null and self.chance(0.4) else self.thing(p.type, owner)
        if p.type == 'char':
            key = given.setdefault('key of this call', self.random.choice(OPTIONS))
            return self.text(p, call) or {'key': key[0], 'value': key[1]}.get(p.name, 'gsl')
        if p.array:
            return None if p.null and self.chance(0.4) else self.array(p, owner, given)
        return self.real(p.name) if p.type in ('double', 'float') else self.integer(p.name)

    def filled(self, call, owner, given):
        """Some results by their names: not wanted, or filled in place."""
        for p in call.parameters:
            if not p.result or p.type in _table.CLASSES or p.type == 'char' or p in call.asked or not self.chance(0.1):
                continue
            given[p.name] = self.array(p, owner, given) if p.array and self.chance(0.7) else self.random.choice((None, None, 5, 'x'))
        if self.chance(0.01):
            given[self.random.choice(('capacity', 'n', 'context', 'session', 'nothing', 'self', 'x'))] = 100000

    # ---- callbacks ----

    def callback(self):
        """A solver, a progress, a log, or what comes before a step."""
        if self.chance(0.25):
            return None
        if self.chance(0.04):
            return self.random.choice((5, 'x', object(), int))

        def called(*_):
            if self.chance(0.3):
                self.call()
            if self.chance(0.03):
                raise self.random.choice((Raised, spar.Error, SystemExit, KeyboardInterrupt, StopIteration))(*(3, 'x'))
            if self.chance(0.03):
                gc.collect()
            return self.random.choice(HOSTILE_ANSWERS) if self.chance(0.04) else self.random.choice((None, 0, False))
        return called

    # ---- calls ----

    def call(self):
        """One call, or something else that a program does with its handles."""
        if self.depth > 2:
            return
        self.depth += 1
        try:
            self.random.choice((self.call_one,) * 40 + (self.forget, self.close, self.build))()
        finally:
            self.depth -= 1

    def call_one(self):
        """A random call of a random thing."""
        call = self.random.choice(WEIGHED)
        if not self.chance(RARE.get(call.name, 1)):
            return
        owner = None
        if call.owner:
            pool = list(self.things[call.owner])
            if not pool:
                return
            owner = self.random.choice(pool)
        given = {}
        for p in call.asked:
            if not (p.name in call.optional_names and self.chance(0.3)) and not self.chance(0.005):
                given[p.name] = self.argument(call, p, owner, given)
        self.filled(call, owner, given)
        for name in ('n of this call', 'key of this call'):
            given.pop(name, None)
        self.attempt(call.name, lambda: call(owner, **given), (owner, given))

    def attempt(self, name, what, said):
        """A call, which answers or refuses."""
        self.made += 1
        self.last.append((name, said))
        succeeded, since = False, guards.mark()
        try:
            answer = what()
            succeeded = True
            self.outcomes['answered'] += 1
            for one in answer if isinstance(answer, tuple) else (answer,):
                kind = getattr(one, 'kind', None)
                if kind and kind != 'session' and len(self.things[kind]) < self.limit and one not in self.things[kind]:
                    self.things[kind].append(one)
        except spar.Error as refused:
            if not (refused.args == ('x',) or 0 < refused.status <= spar.ERR_LIMIT and str(refused)):
                raise
            self.outcomes[type(refused).__name__] += 1
        except (TypeError, ValueError, Raised, SystemExit, KeyboardInterrupt, StopIteration) as refused:
            self.outcomes[type(refused).__name__] += 1
        fault = guards.check(succeeded and name not in PARTIAL, since)
        if fault:
            raise AssertionError(f'{name}: {fault}')

    def forget(self):
        """Drops handles, and lets the collector run."""
        pool = self.things[self.random.choice(list(self.things))]
        if self.chance(0.7):
            first = self.random.randrange(12)
            del pool[first:first + 1]
        if self.chance(0.3):
            gc.collect(self.random.randrange(3))

    def close(self):
        """Closes something."""
        kind = self.random.choice(list(self.things))
        if kind == 'session' and self.chance(0.7):
            return
        pool = list(self.things[kind])
        if pool:
            thing = self.random.choice(pool)
            self.attempt(f'close a {kind}', thing.close, thing)
        for pool in self.things.values():
            pool[:] = [thing for thing in pool if not thing.closed() or self.chance(0.5)]

    def build(self):
        """A session with members, joints, fluids, a rotor and a trial, committed or not."""
        del self.things['session'][:-2]
        self.attempt('build', self.scene, ())

    def scene(self):
        s = spar.Session()
        self.things['session'].append(s)
        if self.chance(0.1):
            return
        body = s.rigid_create('body', None, None, numpy.eye(6))
        beam = s.beam_create('beam', self.random.randint(1, 2), self.random.randint(3, 4))
        beam.set_axis([0, 1], [[0, 0, 0], [1, 0, 0]])
        beam.set_sections([0], [numpy.diag([1e4, 1e4, 1e4, 10, 10, 10])], [numpy.diag([1, 1, 1, 1e-2, 1e-2, 1e-2])])
        self.things['member'][:] = self.things['member'][-self.limit // 2:] + [body, beam]
        if self.chance(0.2):
            return
        body.commit()
        beam.commit()
        joint = s.spring_create('spring', body, 0, 63, 10 * numpy.eye(6), numpy.eye(6))
        fluid = beam.fluid_create('skin')
        fluid.set_motion_nodes(numpy.linspace([0, 0.1, 0], [1, 0.1, 0], self.random.randint(0, 5)))
        fluid.set_force_nodes(numpy.linspace([0, 0.1, 0], [1, 0.1, 0], self.random.randint(0, 9)))
        stations = beam.fluid_create('stations')
        stations.set_stations(numpy.linspace(0, 1, self.random.randint(2, 7)))
        if self.chance(0.9):
            fluid.map()
            stations.map()
        trial = s.trial_create()
        trial.set_steps(0.01, 8)
        trial.set_callbacks(None, self.callback())
        for kind, new in (('joint', [joint]), ('fluid', [fluid, stations]), ('trial', [trial])):
            self.things[kind][:] = self.things[kind][-self.limit // 2:] + new
        polar = spar.Polar([-3, 0, 3], [-1, 0, 1], [0.1, 0.01, 0.1])
        self.things['polar'][:] = self.things['polar'][-3:] + [polar]
        aero = spar.Aero([stations])
        for i in range(stations.get_count(0)):
            aero.set_section(i, 0.1, 0.05, polar)
        self.things['aero'][:] = self.things['aero'][-3:] + [aero]

    def run(self, calls):
        """So many calls, those in callbacks among them."""
        with numpy.errstate(all='ignore'):  # of this thread
            while self.made < calls:
                if not self.things['session']:
                    self.build()
                self.call()


PARTIAL = {'spar_session_sum', 'build'}  # in place of what is read; many calls in one


def several(count, calls, seed, folder):
    """The same handles from several threads."""
    things = {kind: [] for kind in _table.CLASSES}
    fuzzers = [Fuzzer(seed + 1 + i, folder, things, 12) for i in range(count)]
    faults = []

    def run(fuzzer):
        try:
            fuzzer.run(calls // count)
        except BaseException as fault:  # pylint: disable=broad-except
            faults.append(fault)

    threads = [threading.Thread(target=run, args=(fuzzer,)) for fuzzer in fuzzers]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    if faults:
        raise faults[0]
    return sum((fuzzer.outcomes for fuzzer in fuzzers), collections.Counter())


def main(calls=20000, seed=1, threads=3, folder=None):
    """All of it; says how the calls ended."""
    faulthandler.enable()
    guards.install()
    for call in CALLS:
        call.optional_names = set(spar._said[call.name].optional())  # pylint: disable=protected-access
    home = os.getcwd()
    with tempfile.TemporaryDirectory(dir=folder) as work:
        os.chdir(work)  # a hostile text may be a path, too
        one = Fuzzer(seed, work, {kind: [] for kind in _table.CLASSES}, 12)
        try:
            one.run(calls)
        except BaseException:
            for name, said in one.last:
                print(f'{name}: {said}'[:600], file=sys.stderr)
            raise
        print(f'one thread, seed {seed}:', dict(one.outcomes.most_common()), flush=True)
        if threads > 1:
            print(f'{threads} threads:', dict(several(threads, calls // 2, seed, work).most_common()))
        os.chdir(home)


if __name__ == '__main__':
    main(*[int(word) for word in sys.argv[1:4]], *sys.argv[4:5])
