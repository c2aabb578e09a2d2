"""Reads beams of HAWC2: st files (the classic 19 columns, or 30 with a full stiffness matrix) and the line of a body in an htc file.

    blade = spar.hawc2.read_body('IEA_15MW_RWT_WTG_bodies.htc', 'blade1')
    r, stiffness, mass = spar.hawc2.read_st('blade_st.st')

HAWC2's axes of a section are x to the leading edge, y to the suction side, z to the tip. Radii of gyration are taken about the mass
centre, along the principal bending axes, as BECAS writes them. Bodies go along their z upwards, as blades do.
"""
import os

import numpy
import spar

from .turbine import Beam, ModelError

_CLASSIC, _FULL = 19, 30
_TO_SPAR = numpy.kron(numpy.eye(2), numpy.array([[0, 0, 1], [0, 1, 0], [-1, 0, 0]]))  # (z, y, -x) of forces, then of moments


def _rows(path, number, subset):
    """The numbers of set #number, subset $subset."""
    with open(path, encoding='utf-8', errors='replace') as file:
        lines = file.read().splitlines()
    inside, count, rows = False, None, []
    for line in lines:
        words = line.split()
        if words and words[0].startswith('#'):
            inside = words[0] == f'#{number}'
        elif inside and words and words[0] == f'${subset}':
            count = int(words[1])
        elif count is not None:
            rows.append([float(word) for word in words[:_FULL]])
            if len(rows) == count:
                break
    if count is None or len(rows) != count or len({len(row) for row in rows}) != 1:
        raise ModelError(f'{path}: subset ${subset} of set #{number} is not there, or its rows are not as many or not alike')
    return numpy.array(rows)


def read_st(path, number=1, subset=1):
    """r[n] (m, along the body), stiffness and mass [n][6][6] in spar's order, about the body's line, in its twisted axes: spar's y is
    HAWC2's y, spar's z is minus HAWC2's x.
    number, subset: of the file, as in `set 1 1`"""
    rows = _rows(path, number, subset)
    if rows.shape[1] not in (_CLASSIC, _FULL):
        raise ModelError(f'{path}: rows have {rows.shape[1]} numbers; {_CLASSIC} or {_FULL} are read')
    matrices = [_classic(row) if len(row) == _CLASSIC else _full(row) for row in rows]
    return rows[:, 0], numpy.stack([k for k, _ in matrices]), numpy.stack([m for _, m in matrices])


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


def read_body(path, name, st=None):
    """A main_body of an htc file.
    path: the file that has it (files that it continues in are not followed); name: of the body
    st: path of its st file, None: the one that it names, from the folder of the htc file or the one above"""
    with open(path, encoding='utf-8', errors='replace') as file:
        lines = [line.split(';')[0].split() for line in file]
    inside, body = False, {'sec': []}
    for words in lines:
        if words[:2] == ['begin', 'main_body']:
            inside = False
        elif words[:1] == ['name']:
            inside = words[1:2] == [name]
        elif inside and words[:1] == ['sec']:
            body['sec'].append([float(word) for word in words[2:6]])
        elif inside and words[:1] in (['filename'], ['set'], ['damping_posdef'], ['damping_aniso']):
            body.setdefault(words[0], words[1:])
    sec = numpy.array(body['sec'])
    if len(sec) < 2 or not (numpy.diff(sec[:, 2]) > 0).all():
        raise ModelError(f'{path}: body {name} is not there, or its c2_def does not go along z upwards')
    folder = os.path.dirname(os.path.abspath(path))
    if st is None:
        named = body.get('filename', ['?'])[0]
        places = [os.path.join(folder, *up, named) for up in ([], ['..'], ['..', 'htc'])]
        st = next((place for place in places if os.path.exists(place)), None)
        if st is None:
            raise ModelError(f'{path}: the st file of {name} is not found; name it by st=')
    r, stiffness, mass = read_st(st, *(int(word) for word in body.get('set', ['1', '1'])[:2]))
    points = numpy.column_stack([sec[:, 2], sec[:, 1], -sec[:, 0]])
    along = numpy.concatenate([[0], numpy.cumsum(numpy.linalg.norm(numpy.diff(points, axis=0), axis=1))])
    damping = numpy.zeros(6)
    if 'damping_posdef' in body:  # mass-proportional x, y, z, then stiffness-proportional about x, y, z
        values = [float(word) for word in body['damping_posdef'][:6]]
        damping[[5, 4, 3]] = values[3:6]
    return Beam(name, along / along[-1], points, numpy.radians(sec[:, 3]), r / r[-1], stiffness, mass, damping)
