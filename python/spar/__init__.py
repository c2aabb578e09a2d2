"""spar from Python: every call of the C interface, with numpy arrays.

    import spar
    with spar.Session() as s:
        blade = s.beam_create('blade', 1, 10)
        blade.set_axis([0, 1], [[0, 0, 0], [0, 0, 61.5]])
        ...
        x, v = surface.pull_motion(1.0)
        surface.push_forces(force)
        done = s.step_check()

help(spar.Fluid.push_forces) shows what the header says. This is what differs from C:
- Names. A call is a method of its first argument, without spar_ and without the name of that: spar_fluid_push_forces is
  fluid.push_forces, spar_beam_set_axis is member.set_axis, spar_beam_create session.beam_create. A link is a joint whose
  own calls keep their name: joint.link_set_spring. A call without such an argument is a function: spar.version().
  Constants are spar.OK, ... without SPAR_.
- Arguments stand in the header's order. Left out are counts that an array given shows (n) or the library knows,
  capacities, contexts, and all results. What C takes as NULL is None, or left out at the end.
- Arrays may be lists, of the header's shape or flat. A 36 may be 6 x 6, a 9 may be 3 x 3. Numbers are converted where
  nothing is lost but digits: refused are complex and masked ones, and integers beyond those of C.
- Results come back: none, one, or a tuple in the header's order. An array that is given by its name is filled in place:
  fluid.pull_motion(1.0, x=x, v=v). One given as None is not wanted.
- Arrays of numpy.float32 take the call of single precision, if there is one: fluid.push_forces(force) calls
  spar_fluid_push_forces_f32. All arrays of the call must then be of numpy.float32.
- After fluid.set_layout arrays keep the shape (n, 3). One whose strides are those of the layout is passed as it is, another
  is copied, and results have these strides: set_layout(which, 1, n) takes arrays in Fortran's order without a copy.
- Failures raise a subclass of spar.Error with the library's message: ArgumentError, StateError, NumericError, ... .status
  is the SPAR_ERR_*. An argument of a wrong type or shape, which C cannot be given, raises TypeError or ValueError.
- A fluid's solver is a function of (session, t, dt, iteration), what is called before the steps of trials one of
  (session, t, dt), a progress one of (done, expected). They answer 0 or None to go on, any other integer to end the call.
  What they raise ends the step, or the trial's call, and is raised again. A log is a function of (level, text). It cannot
  end a call: what it raises is raised when the call is done. A log and the progress of a session must not call the session.
- A trial is made by session.trial_create(), and keeps its callbacks.
- A session is closed by `with`, close(), or at the latest when nothing refers to it; members, joints, fluids and trials
  keep it. What belonged to it is closed with it: further calls raise spar.Error. A session cannot be closed in one of its
  callbacks. Nothing of spar can be copied or pickled.
- Threads. Calls of one session wait for each other; another thread may call it while a callback runs.
- Several ranks: spar.Session(comm) with an mpi4py communicator or its Fortran integer.
The library is the one that SPAR_LIBRARY names, else the one in the folder of the package (a wheel has it there), else the
libspar.so.0.9 that the loader finds. libspar_aero is in the same folder.
"""
import ctypes
import inspect
import operator
import os
import threading
from math import prod

import numpy

from . import _table
from ._interface import CONSTANTS, VERSION


def _load(number):
    """libspar and libspar_aero, which stands on it: of one folder, and of the release that the table is of."""
    path = os.environ.get('SPAR_LIBRARY') or os.path.join(os.path.dirname(__file__), f'libspar.so.{number}')
    if 'SPAR_LIBRARY' not in os.environ and not os.path.exists(path):
        path = os.path.basename(path)
    folder, name = os.path.split(path)
    try:
        library = ctypes.CDLL(path)
        aero = ctypes.CDLL(os.path.join(folder, name.replace('libspar', 'libspar_aero', 1)))
    except OSError as fault:
        raise ImportError(f'{fault}: name libspar.so by SPAR_LIBRARY, or install the package by pip') from None
    library.spar_version.restype = ctypes.c_char_p
    release = library.spar_version().decode()
    if release.split('.')[:2] != VERSION.split('.')[:2]:
        raise ImportError(f'{path} is release {release} and this package is {VERSION}: install both from one release')
    return library, aero


_library, _aero_library = _load('0.9')


class Error(Exception):
    """A call has failed; .status is its SPAR_ERR_*. Each status has a subclass."""

    def __init__(self, status, message):
        super().__init__(message)
        self.status = status

    def __reduce__(self):
        return type(self), (self.status, str(self))


_errors = {_status: type(_name, (Error,), {'__doc__': f'A call has failed with status {_status}.', '__module__': __name__})
           for _status, _name in _table.error_names().items()}
globals().update((_one.__name__, _one) for _one in _errors.values())


def _failed(status, message):
    return _errors.get(status, Error)(status, message)


def _refused(message):
    return ArgumentError(CONSTANTS['SPAR_ERR_ARGUMENT'], message)  # noqa: F821 pylint: disable=undefined-variable


# ---- the table ----

_NUMBERS = {'int': (ctypes.c_int, numpy.dtype(numpy.intc)), 'int64_t': (ctypes.c_int64, numpy.dtype(numpy.int64)),
            'double': (ctypes.c_double, numpy.dtype(numpy.float64)), 'float': (ctypes.c_float, numpy.dtype(numpy.float32))}
_CALLBACKS = {
    'fluid_solver': ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_double, ctypes.c_double, ctypes.c_int,
                                     ctypes.c_void_p),
    'before_step': ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_double, ctypes.c_double, ctypes.c_void_p),
    'progress': ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_double, ctypes.c_double, ctypes.c_void_p),
    'log': ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_int, ctypes.c_char_p, ctypes.c_void_p)}
_LAID = ('push_forces', 'push_forces_at', 'pull_forces', 'pull_motion', 'pull_poses')  # arrays [nodes][3] by the fluid's layout


def _c_type(p):
    if p.how == 'callback':
        return _CALLBACKS[p.type]
    if p.how == 'value' and p.type in _NUMBERS:
        return _NUMBERS[p.type][0]
    return ctypes.c_char_p if p.type == 'char' and p.how == 'in' else ctypes.c_void_p


class _Call:
    """One function of the library, which can be called."""

    def __init__(self, said):
        self.name, self.answer, self.parameters, self.owner = said.name, said.answer, said.parameters, said.owner
        self.asked, self.python_name, self.public = said.asked, said.python_name, said.public
        self.function = getattr(_library, self.name, None) or getattr(_aero_library, self.name, None)
        if self.function is None:
            raise ImportError(f'the library has no {self.name}: install the package and the library from one release')
        self.function.restype = {'int': ctypes.c_int, 'text': ctypes.c_char_p, 'none': None}[self.answer]
        self.function.argtypes = [_c_type(p) for p in self.parameters]
        self.by_name = {p.name: p for p in self.parameters}
        self.converters = {p.name: _converter(self, p) for p in self.asked + said.arrays_filled()}
        self.asked_names = [p.name for p in self.asked]
        self.values = {p.name for p in self.parameters if p.how == 'value'}
        self.handles = [p for p in self.asked if p.type in _table.CLASSES]
        self.required = [p.name for p in self.asked if not (p.array or p.null or p.type == 'char')]
        self.shaped = [p for p in self.parameters if p.array or p.how == 'list']
        self.single = None  # the call of the same name in single precision
        self.laid = self.owner == 'fluid' and self.python_name.replace('_f32', '') in _LAID
        self.set_of_nodes = next((d for p in self.shaped for d in p.dims if d in _SETS), None)
        self.steps = [(p, self._way(p)) for p in self.parameters]

    def _way(self, p):
        """How _Running makes C's argument of p."""
        if p is self.parameters[0] and self.owner:
            return _Running.own
        if p.how == 'callback':
            return _Running.callback
        if p.type == 'context':
            return _Running.nothing
        if p.type in _table.CLASSES:
            return _Running.handle
        if p.type == 'char':
            return _Running.text
        if p.array:
            return _Running.array
        return _Running.number if p.result else _Running.value

    def __call__(self, owner, *values, **named):
        return self.run(owner, values, named)

    def run(self, owner, values, named):
        """The call with these arguments."""
        if len(values) > len(self.asked_names):
            raise TypeError(f'{self.python_name} takes {", ".join(self.asked_names) or "no arguments"}')
        given = dict(zip(self.asked_names, values))
        for name, value in named.items():
            if name in given or name not in self.converters:
                raise TypeError(f'{self.python_name} has no argument {name} left')
            given[name] = value
        if self.single is not None and any(isinstance(value, numpy.ndarray) and value.dtype == numpy.float32
                                           for value in given.values()):
            return _Running(self.single, owner, given).run()
        return _Running(self, owner, given).run()

    def signature(self, optional, filled):
        """Its arguments, for help()."""
        kind = inspect.Parameter
        names = [kind('self', kind.POSITIONAL_ONLY)] if self.owner else []
        names += [kind(p.name, kind.POSITIONAL_OR_KEYWORD, default=None if p.name in optional else kind.empty) for p in self.asked]
        names += [kind(p.name, kind.KEYWORD_ONLY, default=...) for p in filled]
        return inspect.Signature(names)


def _function(call, said):
    """The call as a function, whose first argument is its owner, if it has one."""
    if call.owner:
        def made(self, *values, **named):
            return call.run(self, values, named)
        owner = _table.CLASSES[call.owner] + '.'
    else:
        def made(*values, **named):
            return call.run(None, values, named)
        owner = ''
    made.__name__, made.__qualname__, made.__module__ = call.python_name, owner + call.python_name, __name__
    made.__doc__ = f'{said.doc()}\n\nIn C: {call.name}.'
    made.__signature__ = call.signature(said.optional(), said.arrays_filled())
    return made


def _has_shape(shape, known):
    """Whether an array is flat, or has the sizes that are known (None: any), a square matrix in one being two."""
    if len(shape) <= 1 < len(known):
        return True
    last = known[-1:]
    forms = [known] + [known[:-1] + [root, root] for root in (3, 6) if last == [root * root]]
    return any(len(shape) == len(form) and all(b is None or a == b for a, b in zip(shape, form)) for form in forms)


def _room(shape, kind, strides=None):
    """Zeros for a result of C; with strides, in bytes, those of a fluid's layout."""
    if strides is None:
        return numpy.zeros(shape, kind)
    size = (max(shape[0], 1) - 1) * strides[0] + 2 * strides[1] + kind.itemsize
    return numpy.ndarray(shape, kind, buffer=bytearray(size), strides=strides)


def _number(kind, value):
    """A number that C reads or writes, and its address."""
    number = kind(value)
    return number, ctypes.byref(number)


# ---- from Python's values to C's ----

def _wrong(call, p, what):
    return TypeError(f'{call.name}: {p.name} is {what}')


def _integer(call, p, value):
    """An integer that C can hold."""
    try:
        value = operator.index(value)
    except TypeError:
        raise _wrong(call, p, f'of the type {type(value).__name__}; it must be an integer') from None
    limits = numpy.iinfo(_NUMBERS[p.type][1])
    if not limits.min <= value <= limits.max:
        raise _refused(f'{call.name}: {p.name} is {value}; it must be from {limits.min} to {limits.max}')
    return value


def _real(call, p, value):
    try:
        return ctypes.c_double(value).value
    except TypeError:
        raise _wrong(call, p, f'of the type {type(value).__name__}; it must be a number') from None
    except OverflowError:
        raise _refused(f'{call.name}: {p.name} is too large for a number of C') from None


def _text(call, p, value):
    """A text, as bytes; the end of C's text is a NUL."""
    if value is None:
        return None
    try:
        value = os.fsencode(value)
    except TypeError:
        raise _wrong(call, p, f'of the type {type(value).__name__}; it must be a text') from None
    if b'\0' in value:
        raise ValueError(f'{call.name}: {p.name} contains a NUL')
    return value


def _array(call, p, value):
    """An array that C can read; numbers are converted where nothing is lost but digits."""
    if value is None:
        return None
    if isinstance(value, numpy.ma.MaskedArray) and numpy.ma.is_masked(value):
        raise _wrong(call, p, 'masked in part; it must have all numbers')
    kind = _NUMBERS[p.type][1]
    value = numpy.asarray(value)
    if value.dtype == kind:
        return value.copy() if p.result else value  # read and written: not the caller's
    if value.size == 0:
        return numpy.zeros(value.shape, kind)
    if not numpy.can_cast(value.dtype, kind, 'same_kind'):
        raise _wrong(call, p, f'of {value.dtype}; it must be of {kind}')
    if kind.kind == 'i' and value.dtype.kind in 'iu':
        limits = numpy.iinfo(kind)
        if not (limits.min <= int(value.min()) and int(value.max()) <= limits.max):
            raise _refused(f'{call.name}: {p.name} has numbers beyond {limits.min} to {limits.max}')
    with numpy.errstate(over='ignore'):  # C refuses what is not finite
        return value.astype(kind)


def _in_place(call, p, value):
    """An array of the caller that C fills; None: not wanted."""
    if value is None:
        return None
    if not p.array:
        raise TypeError(f'{call.name}: {p.name} is a result; None leaves it out')
    kind = _NUMBERS[p.type][1]
    if not isinstance(value, numpy.ndarray) or isinstance(value, numpy.ma.MaskedArray) or value.dtype != kind \
            or not value.flags.aligned:
        raise _wrong(call, p, f'filled in place; it must be a contiguous, aligned array of {kind}')
    if not value.flags.writeable:
        raise _wrong(call, p, 'filled in place; it must be an array that can be written')
    return value


def _thing(call, p, value):
    """A handle of the kind that belongs there."""
    if value is None and p.null:
        return None
    if not isinstance(value, _CLASSES[p.type]):
        what = 'None' if value is None else f'of the type {type(value).__name__}'
        raise _wrong(call, p, f'{what}; it must be a {_table.CLASSES[p.type]}')
    return value


def _things(call, p, value):
    return [_thing(call, p, one) for one in value]


def _function_or_none(call, p, value):
    if value is not None and not callable(value):
        raise _wrong(call, p, f'of the type {type(value).__name__}; it must be a function or None')
    return value


def _converter(call, p):
    """What makes C's value of the caller's."""
    if p.how == 'callback':
        return _function_or_none
    if p.how == 'list':
        return _things
    if p.type in _table.CLASSES:
        return _thing
    if p.type == 'char':
        return _text
    if p.how == 'out' and p not in call.asked:
        return _in_place
    if p.array:
        return _array
    return _integer if p.type in ('int', 'int64_t') else _real


class _Running:
    """A call under way: from Python's arguments to C's, and its results back."""
    __slots__ = ('call', 'owner', 'given', 'things', 'session', 'sizes', 'results', 'raised', 'keep', 'callbacks', 'strides')

    def __init__(self, call, owner, given):
        self.call, self.owner = call, owner
        self.sizes, self.results, self.raised, self.keep, self.callbacks = {}, [], [], [], {}
        for name in call.required:
            if name not in given:
                raise TypeError(f'{call.name} lacks {name}')
        self.given = {name: call.converters[name](call, call.by_name[name], value) for name, value in given.items()}
        self.things = [] if owner is None else [owner]
        self.session = owner.session if owner is not None else None
        if call.handles:
            self.handles_given()

    def handles_given(self):
        """Things beside the owner, all of one session or of none."""
        call = self.call
        for p in call.handles:
            value = self.given.get(p.name)
            self.things += value if isinstance(value, list) else [value] if value is not None else []
        self.session = next((thing.session for thing in self.things if thing.session is not None), None)
        if any(thing.session is not None and thing.session is not self.session for thing in self.things):
            closed = ''.join(thing.closed() for thing in self.things)
            raise _refused(f'{call.name}: {closed or "the handles belong to different sessions"}')

    def run(self):
        """Calls C and answers its results."""
        uses = [self.session.use] if self.session is not None else []
        if self.call.handles or not uses:
            uses += [thing.use for thing in self.things if thing.session is None]
        entered, faults, wait = [], [], not _this_thread.calls
        try:
            for use in uses:
                use.enter(self.call.name, wait)
                entered.append(use)
            return self.answer()
        finally:
            for use in entered:
                faults += use.leave()
            if faults:
                raise faults[0]

    def answer(self):
        """The same within the use of the session."""
        call = self.call
        for thing in self.things:
            closed = thing.closed()
            if closed:  # its handle leads into memory that is another's
                raise _refused(f'{call.name}: {closed}')
        self.strides = self.owner.strides(call, self.given) if call.laid else None  # numbers between nodes, components
        for p in call.shaped:
            if p.how == 'list':
                self.sizes[p.dims[0]] = len(self.given[p.name])
            elif self.given.get(p.name) is not None:
                self.array_given(p)
        answer = self.called([way(self, p) for p, way in call.steps])
        if self.raised:
            raise self.raised[0]
        if call.answer == 'text':
            return (answer or b'').decode(errors='surrogateescape')
        if call.name == 'spar_has':
            return bool(answer)
        if call.answer == 'int' and answer != 0:
            raise _failed(answer, self.message() or _calls['spar_status_text'].function(answer).decode())
        if self.callbacks:
            self.owner.keep_callbacks(self.callbacks)
        results = [r() if callable(r) else r for r in self.results]
        return results[0] if len(results) == 1 else tuple(results) or None

    def called(self, arguments):
        """Calls C. What callbacks of a trial raise meanwhile is this call's."""
        trials = [thing for thing in self.things if thing.kind == 'trial']
        if not trials:
            return self.call.function(*arguments)
        before = [trial.raised for trial in trials]
        for trial in trials:
            trial.raised = self.raised
        try:
            return self.call.function(*arguments)
        finally:
            for trial, raised in zip(trials, before):
                trial.raised = raised

    def message(self):
        """The message of the session, else of this thread."""
        return _calls['spar_session_message'].function(self.session and self.session.handle).decode(errors='replace')

    # ---- arrays ----

    def array_given(self, p):
        """An array of the caller's, as C takes it; what it shows of the sizes."""
        value = self.given[p.name]
        strides = self.strides if self.strides is not None and p.dims[1:] == [3] else None
        self.check_shape(p, value, [self.sizes.get(d) if d == 'capacity' else self.size(d) for d in p.dims])
        if strides is not None:
            value = self.laid(p, value, strides)
        elif not (value.flags.c_contiguous and value.flags.aligned):
            if p.result and p not in self.call.asked:
                raise _wrong(self.call, p, f'filled in place; it must be a contiguous, aligned array of {value.dtype}')
            value = numpy.array(value, order='C')
        self.given[p.name] = value

    def check_shape(self, p, value, known):
        """Refuses an array of another shape; learns the sizes that nothing else says."""
        if value.shape == tuple(known):
            return
        unknown = [d for d, size in zip(p.dims, known) if size is None]
        rest = prod(size for size in known if size is not None)
        fits = _has_shape(value.shape, known)
        if fits and value.ndim == len(known):
            self.sizes.update((d, size) for d, size in zip(p.dims, value.shape) if d in unknown)
        elif fits and len(unknown) == 1 and rest and value.size % rest == 0:
            self.sizes[unknown[0]] = value.size // rest
        elif not fits or unknown or value.size != rest:
            shape = ''.join(f'[{d}]' for d in p.dims)
            raise ValueError(f'{self.call.name}: {p.name} has the shape {value.shape}; it must be {p.name}{shape}')

    def laid(self, p, value, strides):
        """An array [nodes][3] in the layout of the fluid: itself, if it is, else a copy."""
        if value.ndim != 2:
            raise ValueError(f'{self.call.name}: {p.name} has the shape {value.shape}; after set_layout it must be {p.name}[n][3]')
        strides = tuple(value.itemsize * number for number in strides)
        if value.strides[1] == strides[1] and (value.strides[0] == strides[0] or len(value) < 2) and value.flags.aligned \
                or not value.size:
            return value
        if p.result:
            raise TypeError(f'{p.name}: it is filled in place, so its strides must be {strides}; they are {value.strides}')
        copy = self.room(p, value.shape, value.dtype, strides)
        copy[...] = value
        return copy

    def size(self, d):
        """How large a dimension is; None: nothing says it yet."""
        if isinstance(d, int):
            return d
        if d in self.sizes:
            return self.sizes[d]
        if d in self.given:
            return max(0, self.given[d])  # C refuses those below 0
        if d in self.call.values:
            word = self.call.by_name[d].word
            size = self.enough(word) if d == 'capacity' else self.owner.size(word, self.given) if word else None
        else:
            size = self.owner.size(d, self.given) if self.owner is not None else None
        if size is not None:
            self.sizes[d] = size
        return size

    def enough(self, word):
        """The capacity with which no list is cut: a number, a count of the owner, or a result that C answers without room."""
        if word.isdigit():
            return int(word)
        if word not in self.call.by_name:
            return self.owner.size(word, self.given)
        count = _NUMBERS[self.call.by_name[word].type][0]()
        status = self.call.function(*[self.owner.handle if p is self.call.parameters[0] else ctypes.byref(count) if p.name == word
                                      else 0 if p.name == 'capacity' else self.given[p.name] if p.how == 'value' else None
                                      for p in self.call.parameters])
        if status != 0:
            raise _failed(status, self.message() or _calls['spar_status_text'].function(status).decode())
        return count.value

    # ---- from a parameter to C's argument ----

    def nothing(self, _p):
        """A context."""

    def own(self, _p):
        """The thing whose method this is."""
        return self.owner.handle

    def value(self, p):
        """A number, or a count that an array shows or the library knows."""
        if p.name in self.given:
            return self.given[p.name]
        if p.name == 'capacity' and not p.word:  # of as many as a constant says
            return next(q.dims[0] for q in self.call.shaped if q.result)
        size = self.size(p.name)
        return size if size is not None else 0  # of no array

    def handle(self, p):
        """Handles that are given, and a handle that the call makes."""
        if p.how == 'list':
            things = self.given[p.name]
            handles = (ctypes.c_void_p * len(things))(*[thing.handle for thing in things])
            self.keep.append(handles)
            return ctypes.cast(handles, ctypes.c_void_p) if things else None
        if p.how == 'value':
            value = self.given.get(p.name)
            return value.handle if value is not None else None
        made = ctypes.c_void_p()
        self.results.append(lambda: self.made(p, made.value))
        return ctypes.byref(made)

    def made(self, p, handle):
        """What the call has made, or found."""
        if p.type == 'session':
            return self.session
        if p.type == 'member' and self.owner is self.session:
            self.session.members.append(handle)
        if p.type in ('polar', 'aero'):
            return handle  # for the class that calls
        return _CLASSES[p.type](handle, self.session)

    def text(self, p):
        """A text, or room for one."""
        if p.how == 'in':
            return self.given.get(p.name)
        text = _room([self.size('capacity')], numpy.dtype(numpy.uint8))
        self.keep.append(text)
        self.results.append(lambda: text.tobytes().split(b'\0')[0].decode(errors='surrogateescape'))
        return text.ctypes.data

    def array(self, p):
        """An array that is given, and room for one that comes back."""
        value = self.given.get(p.name)
        if value is None and p.result and p.name not in self.given:
            shape = [self.size(d) for d in p.dims]
            kind = _NUMBERS[p.type][1]
            laid = self.strides is not None and p.dims[1:] == [3]
            value = self.room(p, shape, kind, tuple(kind.itemsize * number for number in self.strides) if laid else None)
        if value is None:
            return None
        self.keep.append(value)
        if p.result:
            self.results.append(value)
        return value.ctypes.data

    def room(self, p, shape, kind, strides):
        """Room for an array of this shape, where the machine has it."""
        try:
            return _room(shape, kind, strides)
        except (MemoryError, ValueError, OverflowError):
            fault = f'{self.call.name}: no memory for {p.name} of the shape {shape}'
            raise _failed(CONSTANTS['SPAR_ERR_MEMORY'], fault) from None

    def number(self, p):
        """Room for a number that comes back; what is given of it is read first."""
        value = self.given.get(p.name, 0)
        if value is None:
            return None
        number, address = _number(_NUMBERS[p.type][0], value)
        self.results.append(lambda: number.value)
        return address

    def callback(self, p):
        """What C calls in Python's place."""
        kind, function = _CALLBACKS[p.type], self.given.get(p.name)
        if function is None:
            made = kind()
        else:
            inside = p.type == 'log' or (p.type == 'progress' and self.owner is self.session)
            made = kind(self.telling(p, function) if inside else self.calling(p, function))
        self.keep.append(made)
        if self.owner.keeps:
            self.callbacks[p.name] = made
        return made

    def telling(self, p, function):
        """What C calls as a log, or as a session's progress, in the middle of a call: what it raises is kept until the call is done."""
        faults, name = self.session.use.faults, f'{self.call.name}: {p.name}'

        def log(_session, level, text, _context):
            try:
                function(level, text.decode(errors='replace'))
            except BaseException as fault:  # pylint: disable=broad-except
                faults.append(fault)

        def progress(_session, done, expected, _context):
            try:
                return _answered(name, function(done, expected))
            except BaseException as fault:  # pylint: disable=broad-except
                faults.append(fault)
                return 1  # the call is to end
        return log if p.type == 'log' else progress

    def calling(self, p, function):
        """What C calls. What is raised there ends the call under way, which raises it again."""
        owner, session, own, name = self.owner, self.session, self.raised, f'{self.call.name}: {p.name}'

        def called(_session, *rest):
            raised = owner.raised if owner.kind == 'trial' else own
            if raised:
                return 1  # the call is to end
            session.use.lend()
            try:
                return _answered(name, function(*rest[:-1]) if p.type == 'progress' else function(session, *rest[:-1]))
            except BaseException as fault:  # pylint: disable=broad-except
                raised.append(fault)
                return 1
            finally:
                session.use.take_back()
        return called


def _answered(name, answer):
    """The status that a callback answers."""
    if answer is None:
        return 0
    try:
        status = int(answer) if isinstance(answer, numpy.bool_) else operator.index(answer)
    except TypeError:
        raise TypeError(f'{name} answered {answer!r}; it must answer an integer, or None for success') from None
    if not -2**31 <= status < 2**31:
        raise ValueError(f'{name} answered {answer}; it must answer an integer of 32 bits, or None for success')
    return status


class _ThisThread(threading.local):
    """What this thread has in its calls, and has not lent to a callback."""
    calls = 0


_this_thread = _ThisThread()


class _Use:
    """Who calls a session, or what belongs to none: one thread at a time, and others while a callback runs."""
    __slots__ = ('lock', 'thread', 'callbacks', 'open', 'left', 'replaced', 'faults')

    def __init__(self):
        self.lock = threading.Lock()
        self.thread = None  # which is in a call, and in none of its callbacks but the log
        self.callbacks = 0  # that run
        self.open = True
        self.left = []  # handles of trials that nothing refers to: a collector finds them in any thread and at any time
        self.replaced = []  # callbacks that C may be in
        self.faults = []  # what the log has raised in this call

    def enter(self, name, wait):
        """Waits until this thread may call; not in a log or a __del__, for whom it waits may be waiting for the call around these."""
        thread = threading.get_ident()
        if self.thread == thread:
            fault = f'{name}: a call of this session is in progress; a log, a progress and a __del__ must not call it'
            raise _failed(CONSTANTS['SPAR_ERR_STATE'], fault)
        if not self.lock.acquire(wait):  # pylint: disable=consider-using-with
            fault = f'{name}: another thread is in a call of this session; a log and a __del__ do not wait for it'
            raise _failed(CONSTANTS['SPAR_ERR_STATE'], fault)
        self.thread = thread
        _this_thread.calls += 1
        if not self.callbacks and (self.left or self.replaced):
            self.replaced.clear()
            while self.left and self.open:
                _destroy('trial', self.left.pop())

    def leave(self):
        """The call is done; answers what its log has raised."""
        faults = ()
        if self.faults:
            faults = self.faults.copy()
            self.faults.clear()
        _this_thread.calls -= 1
        self.thread = None
        self.lock.release()
        return faults

    def lend(self):
        """A callback begins: it may call, and so may other threads."""
        self.callbacks += 1
        _this_thread.calls -= 1
        self.thread = None
        self.lock.release()

    def take_back(self):
        """It has ended."""
        self.lock.acquire()  # pylint: disable=consider-using-with
        self.thread = threading.get_ident()
        _this_thread.calls += 1
        self.callbacks -= 1


# ---- what calls belong to ----

def _destroy(kind, handle):
    _calls[f'spar_{kind}_destroy'].function(ctypes.byref(ctypes.c_void_p(handle)))


class _Thing:
    """A handle of the library; its methods are the calls that take it first."""
    kind, handle, session = '', None, None
    keeps = False  # callbacks, beyond the call that they are given to
    outlives = False  # its session

    def __init__(self, handle, session=None):
        self.handle = handle
        if session is not None:
            self.session = session

    def __reduce_ex__(self, _protocol):
        raise TypeError(f'a {self.kind} of spar cannot be copied or pickled: there would be two owners; save and load '
                        'its session')

    def closed(self):
        """What of it is not there any more; '' if all is."""
        if self.session is not None and self.session.handle is None:
            return f'the session of this {self.kind} is closed' if self.kind != 'session' else 'this session is closed'
        return '' if self.handle else f'this {self.kind} is closed'

    def close(self):
        """Destroys it, if it is still there; of a session with all that is made from it. Members and joints go with their session."""
        name = f'spar_{self.kind}_destroy'
        if name not in _calls:
            raise _failed(CONSTANTS['SPAR_ERR_UNSUPPORTED'], f'a {self.kind} goes with its session; close that')
        use, faults = (self.session or self).use, []
        use.enter(name, not _this_thread.calls)
        try:
            self.close_in(use)
        finally:
            faults = use.leave()
        if faults:
            raise faults[0]

    def close_in(self, _use):
        """The same within the use of its session."""
        handle, there = self.handle, self.outlives or self.session.handle is not None
        self.handle = None
        if handle and there:
            _destroy(self.kind, handle)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.kind not in ('member', 'joint'):
            self.close()


class Session(_Thing):
    """A session of this process alone, or over a communicator."""
    kind, keeps, outlives = 'session', True, True
    session = property(lambda self: self)

    def __init__(self, comm=None):
        super().__init__(None)
        self.use = _Use()
        self.alone = comm is None
        self.members = []  # their handles
        self.callbacks = {}  # log and progress, which C calls
        made = ctypes.c_void_p()
        if comm is None:
            status = _calls['spar_session_create'].function(ctypes.addressof(made))
        else:
            create = _calls['spar_session_create_fcomm']
            number = _integer(create, create.by_name['comm'], comm.py2f() if hasattr(comm, 'py2f') else comm)
            status = create.function(number, ctypes.addressof(made))
        if status != 0:
            raise _failed(status, _calls['spar_session_message'].function(None).decode(errors='replace'))
        self.handle = made.value

    def keep_callbacks(self, callbacks):
        """Keeps a log and a progress, as long as C may call them; C uses the others in their call alone."""
        for name in ('log', 'progress'):
            if name in callbacks:
                self.use.replaced.append(self.callbacks.get(name))
                self.callbacks[name] = callbacks[name]

    def size(self, word, _given):
        """What no argument says: ranks, and all_nodes, of all members."""
        if word == 'all_nodes':
            return sum(_count(self, 'spar_member_get_count', handle) for handle in self.members)
        if word != 'ranks':
            return None
        ranks = ctypes.c_double(1)
        if not self.alone:
            status = _calls['spar_session_sum'].function(self.handle, 0, 1, ctypes.byref(ranks))
            if status != 0:
                raise _failed(status, _calls['spar_session_message'].function(self.handle).decode(errors='replace'))
        return int(ranks.value)

    def close_in(self, use):
        if self.handle and use.callbacks:
            raise _failed(CONSTANTS['SPAR_ERR_STATE'], 'spar_session_destroy: a callback of this session is running; close the '
                          'session when the call has ended')
        use.open = False
        super().close_in(use)

    def __del__(self):
        if self.handle and _library is not None:  # nothing refers to it, so nothing calls it
            _destroy('session', self.handle)


def _count(thing, name, *of):
    """What a call answers whose result is one count, without what the other calls need."""
    number = ctypes.c_int64()
    status = _calls[name].function(*(of or (thing.handle,)), ctypes.byref(number))
    if status != 0:
        raise _failed(status, _calls['spar_session_message'].function(thing.session.handle).decode(errors='replace'))
    return number.value


class Member(_Thing):
    """A structure: a beam, a rigid body, a point, or one that the host solves. A session makes it."""
    kind = 'member'

    def size(self, word, _given):
        """nodes."""
        return _count(self, 'spar_member_get_count') if word == 'nodes' else None


class Joint(_Thing):
    """A joint of two members, a spring or a link. A session makes it."""
    kind = 'joint'


_SETS = {'motion_nodes': 0, 'force_nodes': 1, 'which_nodes': None}


class Fluid(_Thing):
    """A fluid's nodes on this rank. A member makes it."""
    kind = 'fluid'

    def size(self, word, given):
        """motion_nodes, force_nodes, which_nodes, P."""
        if word in _SETS:
            return _count(self, 'spar_fluid_get_count', self.handle, given['which'] if word == 'which_nodes' else _SETS[word])
        if word != 'P':
            return None
        member, each = ctypes.c_void_p(), ctypes.c_int(1)
        _calls['spar_fluid_get_member'].function(self.handle, ctypes.byref(member))
        if _count(self, 'spar_member_get_count', member) > 1:  # a beam
            _calls['spar_beam_get_elements'].function(member, None, ctypes.byref(each))
        return each.value

    def strides(self, call, given):
        """Numbers between nodes and between components in the layout; None: packed."""
        node, component = ctypes.c_int64(3), ctypes.c_int64(1)
        which = given.get('which', 0) if call.set_of_nodes == 'which_nodes' else _SETS[call.set_of_nodes]
        _calls['spar_fluid_get_layout'].function(self.handle, which, ctypes.byref(node), ctypes.byref(component))
        return None if (node.value, component.value) == (3, 1) else (node.value, component.value)


class Trial(_Thing):
    """Trial runs on a copy of a session. A session makes it."""
    kind, keeps = 'trial', True

    def __init__(self, handle, session=None):
        super().__init__(handle, session)
        self.callbacks = {}  # what C calls, by the names of the arguments
        self.raised = []  # by its callbacks, in the call under way

    def keep_callbacks(self, callbacks):
        """Keeps what C may call until others replace it."""
        self.session.use.replaced.append({name: self.callbacks.get(name) for name in callbacks})
        self.callbacks.update(callbacks)

    def size(self, word, given):
        """As of the session."""
        return self.session.size(word, given)

    def __del__(self):
        if self.handle and _library is not None and self.session.handle:
            self.session.use.left.append(self.handle)  # the session may be in a call, in another thread


class Polar(_Thing):
    """Coefficients of an airfoil over the angle of attack."""
    kind, outlives = 'polar', True

    def __init__(self, alpha_rad, cl, cd, cm=None):
        self.use = _Use()
        super().__init__(_calls['spar_polar_create'](None, alpha_rad, cl, cd, cm))

    def __del__(self):
        if self.handle and _library is not None:
            _destroy('polar', self.handle)


class Aero(_Thing):
    """Blade elements: sections has one fluid of stations for each blade."""
    kind, outlives = 'aero', True

    def __init__(self, sections):
        self.use = _Use()
        self.fluids = list(sections)
        super().__init__(_calls['spar_aero_create'](None, self.fluids))
        if self.fluids:
            self.session = self.fluids[0].session
            self.sections = _count(self, 'spar_fluid_get_count', self.fluids[0].handle, 0)

    sections = 0  # of each blade, when it was made

    def closed(self):
        return super().closed() or next((fluid.closed() for fluid in self.fluids if fluid.closed()), '')

    def size(self, word, _given):
        """blades and sections."""
        return {'blades': len(self.fluids), 'sections': self.sections}.get(word)

    def __del__(self):
        if self.handle and _library is not None:
            _destroy('aero', self.handle)


_CLASSES = {'session': Session, 'member': Member, 'joint': Joint, 'fluid': Fluid, 'trial': Trial, 'polar': Polar, 'aero': Aero}
globals().update((name[len('SPAR_'):], number) for name, number in CONSTANTS.items())
_said = _table.read()
_calls = {_name: _Call(_one) for _name, _one in _said.items()}
for _name, _one in _calls.items():
    _one.single = _calls.get(_name + '_f32')
    if _one.public:
        _owner = _CLASSES[_one.owner] if _one.owner else None
        if hasattr(_owner, _one.python_name) if _owner else _one.python_name in globals():
            raise ImportError(f'{_name}: there are two of the name {_one.python_name}')
        if _owner:
            setattr(_owner, _one.python_name, _function(_one, _said[_name]))
        else:
            globals()[_one.python_name] = _function(_one, _said[_name])
__version__ = VERSION
