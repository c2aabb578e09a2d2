"""Reads beams of HAWC2: st files (the classic 19 columns, or 30 with a full stiffness matrix) and the bodies of an htc file.

    blade = spar.hawc2.read_body('IEA_15MW_RWT_WTG_bodies.htc', 'blade1')
    r, stiffness, mass = spar.hawc2.read_st('blade_st.st')

HAWC2's axes of a section are x to the leading edge, y to the suction side, z to the tip. Radii of gyration are taken about the mass
centre, along the principal bending axes, as BECAS writes them. Bodies go along their z: upwards, as blades do (spar's x, y, z are z, y,
-x), or downwards, as towers do in HAWC2's frame, whose z points to the ground (-z, y, x: the frame of a tower of spar.turbine).
Taken are the line, the sections, concentrated masses, copies of bodies, and damping_posdef; a warning names what else a body has.
"""
import os
import warnings

import numpy
import spar

from ._text import Text, leading_numbers, number_of
from .turbine import Beam, body_mass, cross_matrix, read_by, sections_fault, tell

_CLASSIC, _FULL = 19, 30
_TO_SPAR = numpy.kron(numpy.eye(2), numpy.array([[0, 0, 1], [0, 1, 0], [-1, 0, 0]]))  # (z, y, -x) of forces, then of moments
_SETTINGS = {'name', 'type', 'nbodies', 'node_distribution', 'damping_posdef', 'concentrated_mass', 'copy_main_body', 'gravity',
             'body_eigenanalysis_file_name', 'beam_output_file_name', 'body_output_file_name'}
_BLOCKS = {'timoschenko_input', 'c2_def', 'visualization_profile'}


# ---- st files ----

def _rows(file, number, subset):
    """The numbers of set #number, subset $subset, and the line of the first."""
    inside, start, found = False, None, set()
    for i, line in enumerate(file.lines):
        words = line.split()
        if words and words[0].startswith('#'):
            inside = number_of(words[0][1:]) == number
            found.add(words[0])
        elif inside and words and words[0].startswith('$'):
            found.add(words[0])
            if number_of(words[0][1:]) == subset:
                start = i
                break
    if start is None:
        file.fail(f'subset ${subset} of set #{number} is not there; it has {", ".join(sorted(found)) or "none"}')
    said = number_of(file.lines[start].split()[1]) if len(file.lines[start].split()) > 1 else None
    if said is None or said != int(said) or not 2 <= said <= 1e5:
        file.fail('the number of rows is missing behind the subset; give $n and a whole number of at least 2', start)
    rows, count = [], int(said)
    for i in range(start + 1, start + 1 + count):
        words = (file.lines[i] if i < len(file.lines) else '').split(';')[0].replace(',', ' ').split()[:_FULL]
        rows.append([number_of(word) for word in words])
        if not words or words[0][0] in '#$':
            file.fail(f'subset ${subset} promises {count} rows, and {len(rows) - 1} follow', min(i, len(file.lines) - 1))
        if None in rows[-1]:
            file.fail(f'{words[rows[-1].index(None)]} is not a number', i)
        if len(rows[-1]) not in (_CLASSIC, _FULL) or len(rows[-1]) != len(rows[0]):
            file.fail(f'the row has {len(rows[-1])} numbers; {_CLASSIC} or {_FULL} are read, the same in all rows', i)
        if len(rows) > 1 and not rows[-1][0] > rows[-2][0]:
            file.fail(f'r is {rows[-1][0]:g} and is not above that of the previous row ({rows[-2][0]:g})', i)
    after = start + 1 + count
    if after < len(file.lines) and len(leading_numbers(file.lines[after].split(';')[0])) >= len(rows[0]):
        file.fail(f'a row follows the last one; subset ${subset} says {count}: correct it, or remove the rows', after)
    return numpy.array(rows), start + 1


def read_st(path, number=1, subset=1):
    """r[n] (m, along the body), stiffness and mass [n][6][6] in spar's order, about the body's line, in its twisted axes: spar's y is
    HAWC2's y, spar's z is minus HAWC2's x.
    number, subset: of the file, as in `set 1 1`"""
    file = Text(path)
    rows, first = _rows(file, number, subset)
    matrices = []
    for i, row in enumerate(rows):
        for k, what in ((1, 'm'), *((j, 'stiffness') for j in ((8, 9, 10, 11, 12, 15) if len(row) == _CLASSIC else ()))):
            if not row[k] > 0:
                file.fail(f'the {what} (column {k + 1}) is {row[k]:g}; give a number above 0', first + i)
        try:
            matrices.append(_classic(row) if len(row) == _CLASSIC else _full(row))
        except spar.Error as error:
            file.fail(str(error), first + i)
    stiffness, mass = (numpy.stack([both[k] for both in matrices]) for k in (0, 1))
    fault = sections_fault(stiffness, mass)
    if fault:
        file.fail(fault[0], first + fault[1])
    return rows[:, 0], stiffness, mass


def _mass(p, row, angle):
    """Writes the mass of a row into properties."""
    p[spar.SECTION_ANGLE] = angle
    p[spar.SECTION_MASS], p[spar.SECTION_MASS_Y], p[spar.SECTION_MASS_Z] = row[1], row[3], -row[2]
    p[spar.SECTION_INERTIA_Y], p[spar.SECTION_INERTIA_Z] = row[1] * row[5]**2, row[1] * row[4]**2


def _classic(row):
    """Stiffness and mass of 19 numbers."""
    _, _, _, _, _, _, x_sh, y_sh, young, shear, i_x, i_y, i_p, k_x, k_y, area, pitch, x_e, y_e = row
    p = numpy.zeros(spar.SECTION_COUNT)
    _mass(p, row, numpy.radians(pitch))
    p[spar.SECTION_EA], p[spar.SECTION_GJ] = young * area, shear * i_p
    p[spar.SECTION_GA_Y], p[spar.SECTION_GA_Z] = k_y * shear * area, k_x * shear * area
    p[spar.SECTION_EI_Y], p[spar.SECTION_EI_Z] = young * i_y, young * i_x
    p[spar.SECTION_TENSION_Y], p[spar.SECTION_TENSION_Z] = y_e, -x_e
    p[spar.SECTION_SHEAR_Y], p[spar.SECTION_SHEAR_Z] = y_sh, -x_sh
    return tuple(matrix.reshape(6, 6) for matrix in spar.section_build(p))


def _full(row):
    """Stiffness and mass of 30 numbers: the matrix is about the elastic centre, in principal axes."""
    angle, x_e, y_e = numpy.radians(row[6]), row[7], row[8]
    own = numpy.zeros((6, 6))
    own[numpy.triu_indices(6)] = row[9:]
    own = own + numpy.triu(own, 1).T
    y, z = -y_e, x_e  # of the line from the elastic centre, in the body's axes
    turned = numpy.cos(angle) * y + numpy.sin(angle) * z, numpy.cos(angle) * z - numpy.sin(angle) * y
    p = numpy.zeros(spar.SECTION_COUNT)
    _mass(p, row, angle)
    return (spar.section_transform(_TO_SPAR @ own @ _TO_SPAR.T, *turned, -angle).reshape(6, 6),
            spar.section_build(p, stiffness=None).reshape(6, 6))


# ---- htc files ----

class _Body:
    """A main_body: its commands, in order, as (block, words, file, line)."""

    def __init__(self, file, line):
        self.file, self.line, self.commands, self.name = file, line, [], None

    def all(self, block, word):
        """Its commands of a block ('' for itself) with a word: words behind it, file, line."""
        return [(words[1:], file, line) for where, words, file, line in self.commands if where == block and words[0].lower() == word]

    def numbers(self, block, word, least, what):
        """The numbers of each such command."""
        for words, file, line in self.all(block, word):
            numbers = [number_of(one) for one in words]
            good = numbers[:numbers.index(None)] if None in numbers else numbers
            if len(good) < least:
                file.fail(f'{word} has {len(good)} numbers; give {what}', line)
            yield good, file, line


def _beside(file, name):
    """A file that an htc file names: from its folder, or from the one above, where HAWC2 is run."""
    places = [os.path.join(file.folder, *up, name.replace('\\', '/')) for up in ([], ['..'], ['..', '..'], ['..', 'htc'])]
    return next((place for place in places if os.path.isfile(place)), None)


def _bodies(path, depth=0):
    """The main bodies of an htc file and of those that it continues in, where they are found."""
    file, bodies, body, blocks = Text(path), [], None, []
    for i, line in enumerate(file.lines):
        words = line.split(';')[0].replace(',', ' ').split()
        if not words:
            continue
        first = words[0].lower()
        if first == 'exit':
            break
        if first == 'begin' and len(words) > 1:
            blocks.append(words[1].lower())
            if blocks[-1] == 'main_body':
                body = _Body(file, i)
                bodies.append(body)
        elif first == 'end':
            block = blocks.pop() if blocks else None
            if len(words) > 1 and words[1].lower() != block and block is not None:
                file.fail(f'{words[1]} ends where {block} has begun', i)
            body = None if block == 'main_body' else body
        elif first == 'continue_in_file' and len(words) > 1:
            more = _beside(file, words[1])
            if more and depth < 8:
                bodies += _bodies(more, depth + 1)
        elif body:
            inner = blocks[blocks.index('main_body') + 1:]
            body.commands.append((inner[-1] if inner else '', words, file, i))
            if not inner and first == 'name' and len(words) > 1:
                body.name = words[1]
    return bodies


def _find(bodies, path, name):
    """The body of this name; of a copy, that which it copies."""
    for _ in range(len(bodies) + 1):
        body = next((one for one in bodies if one.name == name), None)
        if body is None:
            Text(path).fail(f'body {name} is not there; it has {", ".join(str(one.name) for one in bodies) or "none"} (files that it continues in '
                            'and that are not found are not read)')
        copies = body.all('', 'copy_main_body')
        if not copies:
            return body
        name = copies[0][0][0] if copies[0][0] else None
    return body.file.fail(f'body {name} copies itself', body.line)


def _line(body):
    """Points [n][4] x, y, z, twist of the c2_def, which its nsec counts."""
    sec = list(body.numbers('c2_def', 'sec', 5, 'its number, x, y, z and twist'))
    said = next(body.numbers('c2_def', 'nsec', 1, 'a number'), None)
    if not sec or said is None:
        body.file.fail(f'body {body.name} has no c2_def with nsec and sec; is it a beam?', body.line)
    if said[0][0] != len(sec) or len(sec) < 2:
        said[1].fail(f'nsec is {said[0][0]:g}, and {len(sec)} sec follow; give at least 2, and their number', said[2])
    for i, (numbers, file, line) in enumerate(sec):
        if numbers[0] != i + 1:
            file.fail(f'sec {numbers[0]:g} follows where sec {i + 1} is due', line)
        step = numbers[3] - sec[i - 1][0][3] if i else 0.0
        if i and (step == 0 or step * (sec[-1][0][3] - sec[0][0][3]) < 0):
            file.fail(f'z is {numbers[3]:g} and does not go on from the previous point; a body goes along its z, one way', line)
    return numpy.array([numbers[1:5] for numbers, _, _ in sec])


def _point_masses(beam, body, to_spar):
    """Concentrated masses, on nodes that are the points of the line."""
    found = list(body.numbers('', 'concentrated_mass', 8, 'node, x, y, z, mass, Ixx, Iyy and Izz'))
    if not found:
        return
    words = body.all('', 'node_distribution')
    if words and words[0][0][:1] != ['c2_def']:
        words[0][1].fail(f'nodes are distributed by {" ".join(words[0][0])}; with concentrated masses only c2_def is read', words[0][2])
    for n, file, line in found:
        if n[0] != int(n[0]) or not 1 <= n[0] <= len(beam.eta):
            file.fail(f'concentrated_mass is on node {n[0]:g} of {len(beam.eta)}', line)
        if min(n[4:8]) < 0:
            file.fail('concentrated_mass has a mass or a moment of inertia below 0', line)
    eta = [float(beam.eta[int(n[0]) - 1]) for n, _, _ in found]
    with spar.Session() as session:
        member = session.beam_create(beam.name, beam.elements, beam.nodes)
        member.set_axis(beam.eta, beam.points, beam.twist)
        member.set_sections([0], [numpy.eye(6)], [numpy.eye(6)])
        member.set_fidelity(spar.FIDELITY_PRESCRIBED, 0)
        read_by(member.commit, path=body.file.path)
        frames = numpy.atleast_2d(member.evaluate(eta, strain=None, force=None, x=None))  # the section's axes, in which masses are given
        trial = session.beam_create('trial', 1, 2)
        for at, q, (n, file, line) in zip(eta, frames, found):
            tilde = cross_matrix(q[1:])
            axes = (numpy.eye(3) + 2 * q[0] * tilde + 2 * tilde @ tilde).T @ to_spar
            xy, xz, yz = [*n[8:11], 0, 0, 0][:3]
            inertia = numpy.array([[n[5], xy, xz], [xy, n[6], yz], [xz, yz, n[7]]])
            beam.masses.append((at, body_mass(n[4], axes @ n[1:4], axes @ inertia @ axes.T)))
            try:
                trial.set_masses([0], [beam.masses[-1][1]])
            except spar.Error as error:
                file.fail(f'concentrated_mass: {error}', line)


def read_body(path, name, st=None):
    """A main_body of an htc file, or the one that it copies.
    path: the htc file; files that it continues in are read where they are found
    name: of the body
    st: path of its st file, None: the one that it names, from the folder of the htc file or the one above"""
    bodies = _bodies(path)
    body = _find(bodies, path, name)
    sec = _line(body)
    down = sec[-1, 2] < sec[0, 2]
    to_spar = numpy.array([[0, 0, -1], [0, 1, 0], [1, 0, 0]] if down else [[0, 0, 1], [0, 1, 0], [-1, 0, 0]], float)
    if st is None:
        names = body.all('timoschenko_input', 'filename')
        st = _beside(names[0][1], names[0][0][0]) if names and names[0][0] else None
        if st is None:
            body.file.fail(f'the st file of {name}{", " + names[0][0][0] + "," if names and names[0][0] else ""} is not found; name it by st=',
                           names[0][2] if names else body.line)
    which = next(body.numbers('timoschenko_input', 'set', 2, 'the numbers of set and subset'), ([1, 1], None, None))[0]
    r, stiffness, mass = read_st(st, *(int(n) for n in which[:2]))
    points = (sec[:, :3] - sec[0, :3]) @ to_spar.T
    along = numpy.concatenate([[0], numpy.cumsum(numpy.linalg.norm(numpy.diff(points, axis=0), axis=1))])
    if abs(r[-1] / along[-1] - 1) > 0.01:
        warnings.warn(f'{st}: r goes to {r[-1]:g} m, and body {name} is {along[-1]:.6g} m long; the sections are spread over the body',
                      stacklevel=2)
    turn = numpy.radians(sec[:, 3])
    if down and (numpy.any(turn) or any(abs(matrix[:, i, j]).max() > 1e-9 * abs(matrix[:, i, i] * matrix[:, j, j]).max() ** 0.5
                                        for matrix in (stiffness, mass) for i in range(6) for j in range(i))):
        body.file.fail(f'body {name} goes down its z, with twist or with centres off the line; such bodies are read where they go upwards',
                       body.line)
    beam = Beam(name, along / along[-1], points, turn, r / r[-1], stiffness, mass)
    for values, file, line in list(body.numbers('', 'damping_posdef', 6, 'six numbers'))[:1]:  # mass x, y, z, stiffness about x, y, z
        if min(values[:6]) < 0:
            file.fail(f'damping_posdef has {min(values[:6]):g}; give numbers of at least 0', line)
        beam.damping[[5, 4, 3]] = values[3:6]
        if values[0] == values[1] == values[2]:
            beam.mass_damping = values[0]
        else:
            beam.left_out.append('mass-proportional part of damping_posdef, which differs from axis to axis')
    _point_masses(beam, body, to_spar)
    unknown = {words[0] if not where else where for where, words, _, _ in body.commands
               if (words[0].lower() not in _SETTINGS if not where else where not in _BLOCKS)}
    beam.left_out += [f'{word} of body {name}' for word in sorted(unknown)]
    tell(path, beam.left_out)
    return beam
