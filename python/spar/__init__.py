"""spar from Python: every call of the C interface, with numpy arrays. Needs numpy and the shared library, nothing compiled.

    import spar
    with spar.Session() as s:
        blade = s.beam_create('blade', 1, 10)
        blade.set_axis([0, 1], [[0, 0, 0], [0, 0, 61.5]])
        ...
        x, v = surface.pull_motion(1.0)
        surface.push_forces(force)
        done = s.step_check()

The headers under include/spar say what each call does; here is what is different.
- Names. A call is a method of its first argument, without spar_ and without the name of that: spar_fluid_push_forces is
  fluid.push_forces, spar_beam_set_axis is member.set_axis, spar_beam_create session.beam_create. A line is a joint whose
  own calls keep their name: joint.line_set_spring. Constants are spar.OK, ... without SPAR_.
- Arguments stand in the header's order. Left out are counts that an array given shows (n), capacities, contexts, and all
  results. What C takes as NULL is None, or left out at the end.
- Arrays may be lists, of the header's shape or flat; a 36 may be 6 x 6, a 9 be 3 x 3. Numbers are converted where nothing
  is lost but digits: complex ones are refused.
- Results come back: none, one, or a tuple in the header's order. An array that is given by its name is filled in place:
  fluid.pull_motion(1.0, x=x, v=v). One given as None is not wanted.
- Failures raise spar.Error with the library's message, .status is its SPAR_ERR_*.
- A fluid's solver is a function of (session, t, dt, iteration), what is called before the steps of trials one of
  (session, t, dt), a log one of (level, text), a progress one of (done, expected), which answers 0 or None to go on. What
  they raise ends the step, or the trial's call, and is raised again.
- A trial is made by session.trial_create(), and keeps its callbacks.
- A session is closed by `with`, close(), or at the latest when nothing refers to it; members, joints, fluids and trials
  keep it.
  What belonged to it is closed with it: further calls raise spar.Error. Nothing of spar can be copied or pickled.
- Several ranks: spar.Session(comm) with an mpi4py communicator or its Fortran integer.
The library is sought as SPAR_LIBRARY says, else where the loader finds libspar.so.0.9; libspar_aero in the same folder.
"""
import ctypes
import os
import re

import numpy

from ._interface import TABLE


def _load(number):
    """libspar and libspar_aero, which stands on it: of one folder."""
    path = os.environ.get('SPAR_LIBRARY', f'libspar.so.{number}')
    folder, name = os.path.split(path)
    return [ctypes.CDLL(path), ctypes.CDLL(os.path.join(folder, name.replace('libspar', 'libspar_aero', 1)))]


_library, _aero_library = _load('0.9')


class Error(Exception):
    """A call has failed; .status is its SPAR_ERR_*."""

    def __init__(self, status, message):
        super().__init__(message)
        self.status = status


# ---- the table ----

_NUMBERS = {'int': (ctypes.c_int, numpy.intc), 'int64_t': (ctypes.c_int64, numpy.int64),
            'double': (ctypes.c_double, numpy.float64), 'float': (ctypes.c_float, numpy.float32)}
_CALLBACKS = {
    'fluid_solver': ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_double, ctypes.c_double, ctypes.c_int,
                                     ctypes.c_void_p),
    'before_step': ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_double, ctypes.c_double, ctypes.c_void_p),
    'progress': ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_double, ctypes.c_double, ctypes.c_void_p),
    'log': ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_int, ctypes.c_char_p, ctypes.c_void_p)}
_IN_AND_OUT = {('spar_session_sum', 'x'), ('spar_step_adaptive', 'dt')}  # results that are read too
_OF_FORCE_NODES = {'get_forces', 'pull_forces', 'push_forces', 'push_forces_at', 'pull_forces_f32',
                   'push_forces_f32'}
_ENOUGH = 1000  # the capacity of lists that the library cuts off at their end


class _Parameter:
    def __init__(self, text):
        self.name, self.type, self.how, shape = text.split('|')
        self.dims = [int(d) if d.isdigit() else _constants.get(d, d) for d in re.findall(r'\[(\w*)\]', shape)]
        self.array = self.type in _NUMBERS and bool(self.dims)
        self.result = self.how == 'out'

    def c_type(self):
        if self.how == 'callback':
            return _CALLBACKS[self.type]
        if self.how == 'value' and self.type in _NUMBERS:
            return _NUMBERS[self.type][0]
        return ctypes.c_char_p if self.type == 'char' and self.how == 'in' else ctypes.c_void_p


class _Call:
    """One function of the library."""

    def __init__(self, name, answer, parameters):
        self.name, self.answer = name, answer
        self.parameters = [_Parameter(p) for p in parameters]
        self.function = getattr(_library if hasattr(_library, name) else _aero_library, name)
        self.function.restype = {'int': ctypes.c_int, 'text': ctypes.c_char_p, 'none': None}[answer]
        self.function.argtypes = [p.c_type() for p in self.parameters]
        shown = {d for p in self.parameters if p.how == 'list' or (p.array and self._given(p)) for d in p.dims}
        first = self.parameters[0] if self.parameters else None
        self.owner = first.type if first and first.type in _CLASSES and first.how == 'value' else None
        self.asked = [p for p in self.parameters[1 if self.owner else 0:]  # what the caller gives, in this order
                      if self._given(p) and p.type != 'context' and not (p.type == 'int64_t' and p.name in shown)
                      and not (p.how == 'value' and p.name in ('capacity', 'rows', 'columns'))
                      and not (name == 'spar_aero_create' and p.name == 'blades')]
        self.python_name = name[len('spar_'):]
        for prefix in {'member': ('member_', 'beam_')}.get(self.owner, (f'{self.owner}_',)):
            if self.python_name.startswith(prefix):
                self.python_name = self.python_name[len(prefix):]

    def _given(self, p):
        return not p.result or (self.name, p.name) in _IN_AND_OUT

    def __call__(self, owner, *values, **named):
        if len(values) > len(self.asked):
            raise TypeError(f'{self.python_name} takes {", ".join(p.name for p in self.asked) or "no arguments"}')
        given = dict(zip((p.name for p in self.asked), values))
        for name, value in named.items():
            if name in given or all(p.name != name for p in self.parameters):
                raise TypeError(f'{self.python_name} has no argument {name} left')
            given[name] = value
        return _Running(self, owner, given).run()


def _has_shape(shape, known):
    """Whether an array is flat, or has the sizes that are known (None: any), a square matrix in one being two."""
    if len(shape) <= 1 < len(known):
        return True
    last = known[-1:]
    forms = [known] + [known[:-1] + [root, root] for root in (3, 6) if last == [root * root]]
    return any(len(shape) == len(form) and all(b is None or a == b for a, b in zip(shape, form)) for form in forms)


class _Running:
    """A call under way: from Python's arguments to C's, and its results back."""

    def __init__(self, call, owner, given):
        self.call, self.owner, self.given = call, owner, given
        self.sizes, self.results, self.raised, self.keep, self.callbacks = {}, [], [], [], {}

    def run(self):
        for p in self.call.parameters:
            if p.array and self.given.get(p.name) is not None:
                self._array_given(p)
            elif p.how == 'list':
                self.sizes['blades' if self.call.name == 'spar_aero_create' else p.dims[0]] = len(self.given[p.name])
        arguments = [self._argument(p) for p in self.call.parameters]
        answer = self._called(arguments)
        if self.call.answer == 'text':
            return (answer or b'').decode()
        if self.call.name == 'spar_has':
            return bool(answer)
        if self.call.answer == 'int' and answer != 0:
            if self.raised:
                raise self.raised[0]
            raise Error(answer, self._message())
        if isinstance(self.owner, Trial):
            self.owner.callbacks.update(self.callbacks)
        results = [r() for r in self.results]
        return results[0] if len(results) == 1 else tuple(results) or None

    def _session(self):
        """The session of the call's owner, else of what is given; None: there is none."""
        things = [self.owner] + [value for value in self.given.values() if isinstance(value, _Thing)]
        return next((thing.session for thing in things if thing is not None and thing.session is not None), None)

    def _called(self, arguments):
        """Calls C. What callbacks of a trial raise meanwhile is this call's."""
        trials = [thing for thing in (self.owner, *self.given.values()) if isinstance(thing, Trial)]
        before = [trial.raised for trial in trials]
        for trial in trials:
            trial.raised = self.raised
        try:
            return self.call.function(*arguments)
        finally:
            for trial, raised in zip(trials, before):
                trial.raised = raised

    def _message(self):
        session = self._session()
        return _calls['spar_session_message'].function(session.handle if session is not None else None).decode()

    def _array_given(self, p):
        """An array of the caller's, as C reads it; what it shows of the sizes."""
        c_kind = _NUMBERS[p.type][1]
        value = self.given[p.name]
        if p.result:  # filled in place
            if not isinstance(value, numpy.ndarray) or value.dtype != c_kind or not value.flags.c_contiguous:
                raise TypeError(f'{p.name}: a contiguous array of {numpy.dtype(c_kind)} is filled in place')
        else:
            value = numpy.asarray(value)
            if value.size and not numpy.can_cast(value.dtype, c_kind, 'same_kind'):
                raise TypeError(f'{self.call.name}: {p.name} is of {value.dtype}; it must be of {numpy.dtype(c_kind)}')
            value = self.given[p.name] = numpy.ascontiguousarray(value, dtype=c_kind)
        known = [self._size(d) for d in p.dims]
        unknown = [d for d, size in zip(p.dims, known) if size is None]
        rest = int(numpy.prod([size for size in known if size is not None], dtype=numpy.int64))
        fits = _has_shape(value.shape, known)
        if fits and value.ndim == len(known):
            self.sizes.update((d, size) for d, size in zip(p.dims, value.shape) if d in unknown)
        elif fits and len(unknown) == 1 and rest and value.size % rest == 0:
            self.sizes[unknown[0]] = value.size // rest
        elif not fits or unknown or value.size != rest:
            shape = ''.join(f'[{d}]' for d in p.dims)
            raise ValueError(f'{self.call.name}: {p.name} has the shape {value.shape}; it must be {p.name}{shape}')

    def _size(self, d):
        if isinstance(d, int):
            return d
        if d in self.sizes:
            return self.sizes[d]
        if d in self.given:
            return int(self.given[d])
        if any(p.name == d and p.how == 'value' for p in self.call.parameters):
            return _ENOUGH if d == 'capacity' and not self._array_named(d) else None
        return self.owner.size(d, self.call, self.given) if self.owner is not None else None

    def _array_named(self, d):
        return any(p.array and d in p.dims and self.given.get(p.name) is not None for p in self.call.parameters)

    def _argument(self, p):
        if p is self.call.parameters[0] and self.call.owner:
            return self._open(self.owner)
        if p.how == 'callback':
            return self._callback(p, self.given.get(p.name))
        if p.type == 'context':
            return None
        if p.type in _CLASSES:
            return self._handle(p)
        if p.type == 'char':
            return self._text(p)
        if p.array:
            return self._array(p)
        if p.result:
            return self._number(p)
        if p.name in self.given:
            return self.given[p.name]
        size = self._size(p.name) if p.type == 'int64_t' or p.name == 'blades' else None
        if p.name in ('capacity', 'rows', 'columns'):
            size = self._capacity(p.name)
        if size is None:
            if p.name == 'n':
                return 0  # of no array
            raise TypeError(f'{self.call.python_name} lacks {p.name}')
        return size

    def _open(self, thing):
        """The handle of a thing, which is there; that of one which is not leads into memory that is another's."""
        closed = thing.closed()
        if closed:
            raise Error(_constants['SPAR_ERR_ARGUMENT'], f'{self.call.name}: {closed}')
        return thing.handle

    def _capacity(self, name):
        """What the result has room for: by a constant of the table, by the caller's array, or enough."""
        for p in self.call.parameters:
            if p.array and p.result and p.how == 'out':
                if name == 'columns':
                    return self._size(p.dims[1])
                size = self._size(p.dims[0])
                if size is not None:
                    return size
        return self.sizes.get(name, _ENOUGH)

    def _handle(self, p):
        if p.how == 'list':
            handles = (ctypes.c_void_p * len(self.given[p.name]))(*[self._open(h) for h in self.given[p.name]])
            self.keep.append(handles)
            return ctypes.cast(handles, ctypes.c_void_p)
        if p.how == 'value':
            value = self.given.get(p.name)
            return self._open(value) if value is not None else None
        made = ctypes.c_void_p()
        self.keep.append(made)
        of = list(self.given.get('sections', []))[:1]
        session = self.owner.session if self.owner is not None else of[0].session if of else None
        self.results.append(lambda: session if p.type == 'session' else _CLASSES[p.type](made.value, session))
        return ctypes.addressof(made)

    def _text(self, p):
        if p.how == 'in':
            value = self.given.get(p.name)
            return os.fsencode(value) if value is not None else None
        text = ctypes.create_string_buffer(_ENOUGH)
        self.results.append(lambda: text.value.decode())
        return ctypes.addressof(text)

    def _array(self, p):
        value = self.given.get(p.name)
        if value is None and p.result and p.name not in self.given:
            shape = [self._size(d) if d != 'capacity' else self._capacity(d) for d in p.dims]
            if None in shape:
                return None  # not wanted, for nobody knows how large it is
            value = numpy.zeros(shape, _NUMBERS[p.type][1])
        if value is None:
            return None
        self.keep.append(value)
        if p.result:
            self.results.append(lambda: value)
        return value.ctypes.data

    def _number(self, p):
        if p.name in self.given and self.given[p.name] is None:
            return None
        number = _NUMBERS[p.type][0](*([self.given[p.name]] if p.name in self.given else []))
        self.keep.append(number)
        self.results.append(lambda: number.value)
        return ctypes.addressof(number)

    def _callback(self, p, function):
        kind = _CALLBACKS[p.type]
        if p.type == 'log' and function is not None:
            def called(_session, level, text, _context):
                function(level, text.decode(errors='replace'))
            self.owner.log = kind(called)  # kept as long as the session
            return self.owner.log
        made = kind() if function is None else kind(self._calling(p, function))
        self.keep.append(made)
        self.callbacks[p.name] = made  # a trial keeps it until the next
        return made

    def _calling(self, p, function):
        """What C calls. What is raised there ends the call under way, which raises it again."""
        owner, raised = self.owner, self.raised

        def called(_session, *rest):
            try:
                arguments = rest[:-1] if p.type == 'progress' else (owner.session, *rest[:-1])
                return int(function(*arguments) or 0)
            except BaseException as fault:  # pylint: disable=broad-except
                (owner.raised if isinstance(owner, Trial) else raised).append(fault)
                return 1
        return called


# ---- what calls belong to ----

_OF_NO_SESSION = ('polar', 'aero')  # they do not go with one


class _Thing:
    """A handle of the library; its methods are the calls that take it first."""
    kind, owned, handle, session = '', False, None, None

    def __init__(self, handle, session=None):
        self.handle = handle
        if session is not None:
            self.session = session

    def __getattr__(self, name):
        call = _methods.get((self.kind, name))
        if call is None:
            raise AttributeError(f'there is no {self.kind} call {name}')
        return lambda *values, **named: call(self, *values, **named)

    def __dir__(self):
        return [*super().__dir__(), *(name for kind, name in _methods if kind == self.kind)]

    def __reduce_ex__(self, _protocol):
        raise TypeError(f'a {self.kind} of spar cannot be copied or pickled: there would be two owners; save and load '
                        'its session')

    def size(self, d, _call, _given):
        """How large a dimension is that no argument says."""
        return None

    def closed(self):
        """What of it is not there any more; '' if all is."""
        if self.session is not None and self.session.handle is None:
            return f'the session of this {self.kind} is closed' if self.kind != 'session' else 'this session is closed'
        return '' if self.handle else f'this {self.kind} is closed'

    def close(self):
        """Destroys it, if it is still there; of a session with all that is made from it."""
        if self.handle and (self.kind in _OF_NO_SESSION or not self.closed()):
            handle = ctypes.c_void_p(self.handle)
            self.handle = None
            _calls[f'spar_{self.kind}_destroy'].function(ctypes.addressof(handle))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def __del__(self):
        if self.owned and _library is not None:
            self.close()


class Session(_Thing):
    """A session of this process alone, or over a communicator."""
    kind, owned = 'session', True
    session = property(lambda self: self)

    def __init__(self, comm=None):
        super().__init__(None)
        made = ctypes.c_void_p()
        if comm is None:
            status = _calls['spar_session_create'].function(ctypes.addressof(made))
        else:
            comm = comm.py2f() if hasattr(comm, 'py2f') else int(comm)
            status = _calls['spar_session_create_fcomm'].function(comm, ctypes.addressof(made))
        if status != 0:
            raise Error(status, _calls['spar_session_message'].function(None).decode())
        self.handle = made.value


class Member(_Thing):
    kind = 'member'

    def size(self, d, call, given):
        if d in ('n', 'nodes'):
            return self.get_count()
        return None


class Joint(_Thing):
    kind = 'joint'


class Fluid(_Thing):
    kind = 'fluid'

    def size(self, d, call, given):
        if d == 'n':
            force = call.python_name in _OF_FORCE_NODES
            return self.get_count(given.get('which', 1 if force else 0))
        if d == 'P':
            return self.get_member().get_elements()[1]
        return None


class Trial(_Thing):
    kind, owned = 'trial', True

    def __init__(self, handle, session=None):
        super().__init__(handle, session)
        self.callbacks = {}  # what C calls, by the names of the arguments
        self.raised = []  # by its callbacks, in the call under way


class Polar(_Thing):
    kind, owned = 'polar', True

    def __init__(self, alpha_rad, cl, cd, cm=None):
        made = _calls['spar_polar_create'](None, alpha_rad, cl, cd, cm)
        super().__init__(made.handle)
        made.handle = None


class Aero(_Thing):
    kind, owned = 'aero', True

    def __init__(self, sections):
        made = _calls['spar_aero_create'](None, sections)
        super().__init__(made.handle, sections[0].session if sections else None)
        self.sections = list(sections)
        made.handle = None

    def closed(self):
        return super().closed() or next((fluid.closed() for fluid in self.sections if fluid.closed()), '')

    def size(self, d, call, given):
        if d == 'blades':
            return len(self.sections)
        return self.sections[0].get_count(0) if d == 'n' and self.sections else None


class _Made(_Thing):
    """What a call has made, on its way to the class that owns it."""


_CLASSES = {'session': Session, 'member': Member, 'joint': Joint, 'fluid': Fluid, 'trial': Trial, 'polar': _Made, 'aero': _Made}
_constants, _calls = {}, {}
for _line in TABLE.split('\n'):
    _words = _line.split()
    if _line.startswith('constants'):
        _constants.update((name, int(number)) for name, number in (word.split('=') for word in _words[1:]))
for _line in TABLE.split('\n'):
    _words = _line.split()
    if _line.startswith('call'):
        _calls[_words[1]] = _Call(_words[1], _words[2], _words[3:])
_methods = {}
for _one in _calls.values():
    if _one.owner and _methods.setdefault((_one.owner, _one.python_name), _one) is not _one:
        raise ImportError(f'{_one.name} and {_methods[_one.owner, _one.python_name].name} have one name')
globals().update((name[len('SPAR_'):], number) for name, number in _constants.items())


def status_text(status):
    """Name and text of a status."""
    return _calls['spar_status_text'](None, status)


def version():
    """Release, 'major.minor.patch'."""
    return _calls['spar_version'](None)


def has(feature):
    """Whether this build has a feature: 'mpi', ..."""
    return _calls['spar_has'](None, feature)


def effect_name(row):
    """Name of a row of the report of effects."""
    return _calls['spar_effect_name'](None, row)


def series_add(path, time, part, file):
    """Adds a file to an index of files in time."""
    _calls['spar_vtk_series_add'](None, path, time, part, file)
