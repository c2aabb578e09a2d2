"""Files of other programs with mistakes, for the readers of Python: bytes, numbers, words and lines of tests/data/models are changed, lost,
doubled and exchanged. Each file is read, or refused as a ModelError that names it; nothing else is raised, and nothing takes long.
    fuzz_texts.py [<cases> [<seed> [<folder to write in>]]]
"""
import collections
import os
import random
import shutil
import signal
import sys
import tempfile
import warnings

import spar
from spar import hawc2, openfast, turbine, windio

DATA = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'data', 'models')
WORDS = [b'', b'0', b'-1', b'2.5', b'1e300', b'nan', b'inf', b'1e-320', b'0x10', b'1d2', b'[', b'{', b'"x', b'word', b'#', b'1,2', b'7', b'!', b'@x', b"'",
         b'999999', b']', b'.', b'x y z', b'\xff\xfe', b'null', b'true', b'*a', b'&a', b'<<: 1', b'- ', b': ', b'1_0', b'begin', b'end', b'$1', b'$0', b'\0', b'\r',
         b'-0', b'1e999', b'...', b'---', b'!!float x', b'? a']
ends = [0.3, 0.7]  # of the stations: two are enough
BEAM = None


def blade():
    """A beam for AeroDyn's sections, read once, before the files go wrong."""
    global BEAM  # pylint: disable=global-statement
    if BEAM is None:
        BEAM = openfast.read_beamdyn(os.path.join(DATA, 'beamdyn.dat'))
    return BEAM


def aerodyn():
    return openfast.read_aerodyn('aerodyn.dat', blade(), stations=ends)


def elastodyn():
    return openfast.read_elastodyn('elastodyn.dat', blade())


READERS = {'turbine.fst': lambda: openfast.read('turbine.fst'), 'elastodyn.dat': elastodyn, 'elastodyn_tower.dat': elastodyn,
           'elastodyn_blade.dat': lambda: openfast.read_elastodyn_blade('elastodyn_blade.dat', 40.0),
           'beamdyn.dat': lambda: openfast.read_beamdyn('beamdyn.dat'), 'beamdyn_blade.dat': lambda: openfast.read_beamdyn('beamdyn.dat'),
           'aerodyn.dat': aerodyn, 'aerodyn_blade.dat': aerodyn, 'airfoil_thin.dat': aerodyn,
           'turbine.htc': lambda: [hawc2.read_body('turbine.htc', name) for name in ('blade2', 'tower')],
           'blade.st': lambda: [hawc2.read_st('blade.st'), hawc2.read_st('blade.st', 2)],
           'windio1.yaml': lambda: windio.read('windio1.yaml', ends), 'windio2.yaml': lambda: windio.read('windio2.yaml', ends)}


def part_at(data, at, ends_of):
    """Begin and end of the word or the line that a place is in."""
    begin = max(data.rfind(c, 0, at) for c in ends_of) + 1
    found = [i for i in (data.find(c, at) for c in ends_of) if i >= 0]
    return begin, min(found) if found else len(data)


def spoil(dice, data):
    """One mistake."""
    at = dice.randrange(len(data)) if data else 0
    kind = dice.randrange(8)
    if kind == 0:
        return data[:at] + bytes([dice.choice((dice.randrange(32, 127), dice.randrange(256)))]) + data[at + dice.randrange(2):]
    if kind in (1, 2, 3):
        begin, end = part_at(data, at, (b' ', b'\n', b',', b'[', b']', b'{', b'}'))
        return data[:begin] + dice.choice(WORDS) + data[end:]
    begin, end = part_at(data, at, (b'\n',))
    if kind == 4:
        return data[:begin] + data[end + 1:]
    if kind in (5, 6):
        to = part_at(data, dice.randrange(len(data)) if data else 0, (b'\n',))[0]
        return data[:to] + data[begin:end + 1] + data[to:]
    return data[:at] if dice.random() < 0.3 else data


def run(dice, outcomes):
    """One file with one to three mistakes, read."""
    name = dice.choice(sorted(READERS))
    with open(os.path.join(DATA, name), 'rb') as file:
        data = file.read()
    for _ in range(dice.randint(1, 3)):
        data = spoil(dice, data)
    with open(name, 'wb') as file:
        file.write(data)
    try:
        signal.alarm(30)
        READERS[name]()
        outcomes[name + ' read'] += 1
    except turbine.ModelError as refused:
        if not any(one in str(refused) for one in (*os.listdir(DATA), 'cannot open', 'cannot be read', 'Is a directory')):
            raise AssertionError(f'the refusal names no file: {refused}') from refused
        outcomes[name + ' refused'] += 1
    finally:
        signal.alarm(0)
        shutil.copy(os.path.join(DATA, name), name)


def main(cases=2000, seed=1, folder=None):
    """All of it; says how the files ended."""
    warnings.simplefilter('ignore')
    outcomes, home = collections.Counter(), os.getcwd()
    work = tempfile.mkdtemp(dir=folder)
    blade()
    for name in os.listdir(DATA):
        shutil.copy(os.path.join(DATA, name), work)
    os.chdir(work)
    for case in range(cases):
        try:
            run(random.Random(f'{seed} {case}'), outcomes)
        except BaseException:
            print(f'seed {seed}, case {case}; the files are in {work}', file=sys.stderr)
            raise
    os.chdir(home)
    shutil.rmtree(work)
    print(dict(sorted(outcomes.items())))
    refused = sum(n for name, n in outcomes.items() if 'refused' in name)
    if cases >= 300 and not 0.1 * cases < refused < 0.95 * cases:
        raise AssertionError(f'{refused} of {cases} are refused')


if __name__ == '__main__':
    assert spar.version()
    main(*[int(word) for word in sys.argv[1:3]], *sys.argv[3:4])
