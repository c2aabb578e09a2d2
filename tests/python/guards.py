"""Poisoned memory around everything that spar from Python gives to C for results: what C writes beyond is found, and what it leaves out."""
import ctypes
import threading

import numpy
import spar

POISON = 0xa5
MARGIN = 256  # bytes on each side

MOST = 1 << 24  # bytes of an array; more is more than the machine has


class _Kept(threading.local):
    """Of each thread."""

    def __init__(self):
        super().__init__()
        self.rooms = []  # (all bytes, which of them are C's, the array)
        self.numbers = []  # (all bytes, size of the number)


_kept = _Kept()


def _room(shape, kind, strides=None):
    kind = numpy.dtype(kind)
    size = kind.itemsize
    if strides is None:
        size *= int(numpy.prod(shape, dtype=object))
    else:
        size += (max(shape[0], 1) - 1) * strides[0] + 2 * strides[1]
    if size > MOST:
        raise MemoryError
    memory = numpy.full(size + 2 * MARGIN, POISON, numpy.uint8)
    array = numpy.ndarray(shape, kind, memory.data, MARGIN, strides)
    ours = None
    if strides is not None:
        ours = numpy.zeros(len(memory), numpy.uint8)
        numpy.ndarray(shape, kind, ours.data, MARGIN, strides).view(numpy.int64 if kind.itemsize == 8 else numpy.int32)[...] = -1
    _kept.rooms.append((memory, ours, array))
    return array


def _number(kind, value):
    memory = (ctypes.c_ubyte * (ctypes.sizeof(kind) + 2 * MARGIN))(*[POISON] * (ctypes.sizeof(kind) + 2 * MARGIN))
    number = kind.from_buffer(memory, MARGIN)
    number.value = value
    _kept.numbers.append((memory, ctypes.sizeof(kind)))
    return number, ctypes.byref(number)


def install():
    """From now on every result has its guards."""
    spar._room, spar._number = _room, _number  # pylint: disable=protected-access


def mark():
    """Where the results of the next call begin: the call around it, whose callback makes it, has others."""
    return len(_kept.rooms), len(_kept.numbers)


def check(succeeded, since=(0, 0)):
    """What is wrong with the results since the last check or a mark; '' if nothing is. What succeeded has written all of its arrays."""
    fault = ''
    for memory, ours, array in _kept.rooms[since[0]:]:
        beyond = numpy.concatenate((memory[:MARGIN], memory[len(memory) - MARGIN:])) if ours is None else memory[ours == 0]
        if (beyond != POISON).any():
            fault = f'C writes beyond an array of the shape {array.shape}'
        elif succeeded and array.dtype != numpy.uint8 and array.size:  # a text ends where it ends
            numbers = numpy.ascontiguousarray(array).view(numpy.uint8).reshape(-1, array.itemsize)
            left = int((numbers == POISON).all(axis=1).sum())
            if left:
                fault = f'C leaves out {left} numbers of an array of the shape {array.shape}'
    for memory, size in _kept.numbers[since[1]:]:
        if any(byte != POISON for byte in memory[:MARGIN] + memory[MARGIN + size:]):
            fault = 'C writes beyond a number'
    del _kept.rooms[since[0]:], _kept.numbers[since[1]:]
    return fault
