"""Writes the type stubs of the Python package, __init__.pyi, from its table.
    python-stubs.py <python/spar of the sources> <folder of _interface.py, and of the result>
"""
import os
import sys
import types

package = types.ModuleType('spar')  # without its __init__, which loads the library
package.__path__ = [sys.argv[2], sys.argv[1]]
sys.modules['spar'] = package
from spar import _table  # noqa: E402 pylint: disable=wrong-import-position

HEAD = '''"""Types of the package spar. Written by cmake/make-bindings.sh from the headers."""
import os
from types import TracebackType
from typing import Any, Callable, Protocol, Sequence, TypeVar, overload

import numpy
from numpy.typing import ArrayLike, NDArray

class _Communicator(Protocol):
    def py2f(self) -> int: ...

_Text = str | bytes | os.PathLike[str]
_Solver = Callable[[Session, float, float, int], int | None]
_Before = Callable[[Session, float, float], int | None]
_Progress = Callable[[float, float], int | None]
_Log = Callable[[int, str], None]
_Self = TypeVar('_Self', bound='_Thing')

class Error(Exception):
    status: int
    def __init__(self, status: int, message: str) -> None: ...
'''
THING = '''
class _Thing:
    @property
    def session(self) -> Session: ...
    def close(self) -> None: ...
    def __enter__(self: _Self) -> _Self: ...
    def __exit__(self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None) -> None: ...
'''
MADE = {'session': '(self, comm: _Communicator | int | None = None)',
        'polar': '(self, alpha_rad: ArrayLike, cl: ArrayLike, cd: ArrayLike, cm: ArrayLike | None = None)',
        'aero': '(self, sections: Sequence[Fluid])'}
ARRAYS = {'int': 'NDArray[numpy.intc]', 'int64_t': 'NDArray[numpy.int64]', 'double': 'NDArray[numpy.float64]',
          'float': 'NDArray[numpy.float32]'}
NUMBERS = {'int': 'int', 'int64_t': 'int', 'double': 'float', 'float': 'float'}
CALLBACKS = {'fluid_solver': '_Solver', 'before_step': '_Before', 'progress': '_Progress', 'log': '_Log'}


def taken(p):
    """The type of an argument."""
    if p.how == 'list':
        return f'Sequence[{_table.CLASSES[p.type]}]'
    if p.how == 'callback':
        kind = CALLBACKS[p.type]
    elif p.type in _table.CLASSES:
        kind = _table.CLASSES[p.type]
    elif p.type == 'char':
        kind = '_Text'
    else:
        kind = 'ArrayLike' if p.array else NUMBERS[p.type]
    return f'{kind} | None' if p.null else kind


def answered(p):
    """The type of a result."""
    if p.type in _table.CLASSES:
        return _table.CLASSES[p.type]
    return 'str' if p.type == 'char' else ARRAYS[p.type] if p.array else NUMBERS[p.type]


def answer(call):
    """The type of all results."""
    if call.answer == 'text':
        return 'str'
    if call.name == 'spar_has':
        return 'bool'
    kinds = [answered(p) for p in call.results]
    return 'None' if not kinds else kinds[0] if len(kinds) == 1 else f'tuple[{", ".join(kinds)}]'


def stubs(call, indent):
    """The call as a method, or as a function of the module."""
    optional = call.optional()
    asked = ['self'] if call.owner else []
    asked += [f'{p.name}: {taken(p)}{" = None" if p.name in optional else ""}' for p in call.asked]
    plain = f'{indent}def {call.python_name}({", ".join(asked)}) -> {answer(call)}: ...'
    filled = [p for p in call.arrays_filled() if p.array or len(call.results) > 1]
    if not filled:
        return [plain]
    named = [f'{p.name}: {ARRAYS[p.type] + " | None" if p.array else "None"} = ...' for p in filled]
    return [f'{indent}@overload', plain, f'{indent}@overload',
            f'{indent}def {call.python_name}({", ".join(asked + ["*"] + named)}) -> Any: ...']


def write(to):
    """All of it."""
    calls = [call for call in _table.read().values() if call.public]
    print(HEAD, end='', file=to)
    for name in _table.error_names().values():
        print(f'class {name}(Error): ...', file=to)
    print(THING, end='', file=to)
    for kind, name in _table.CLASSES.items():
        print(f'\nclass {name}(_Thing):', file=to)
        if kind in MADE:
            print(f'    def __init__{MADE[kind]} -> None: ...', file=to)
        for call in calls:
            if call.owner == kind:
                print('\n'.join(stubs(call, '    ')), file=to)
    print(file=to)
    for call in calls:
        if not call.owner:
            print('\n'.join(stubs(call, '')), file=to)
    for name in _table.CONSTANTS:
        print(f'{name[len("SPAR_"):]}: int', file=to)


with open(os.path.join(sys.argv[2], '__init__.pyi'), 'w', encoding='utf-8') as file:
    write(file)
