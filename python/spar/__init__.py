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
- Arguments stand in the header's order. Left out are counts that an array given shows (n), capacities, contexts, and all
  results. What C takes as NULL is None, or left out at the end.
- Arrays may be lists, of the header's shape or flat. A 36 may be 6 x 6, a 9 may be 3 x 3. Numbers are converted where
  nothing is lost but digits: complex ones are refused.
- Results come back: none, one, or a tuple in the header's order. An array that is given by its name is filled in place:
  fluid.pull_motion(1.0, x=x, v=v). One given as None is not wanted.
- Arrays of numpy.float32 take the call of single precision, if there is one: fluid.push_forces(force) calls
  spar_fluid_push_forces_f32. All arrays of the call must then be of numpy.float32.
- After fluid.set_layout arrays keep the shape (n, 3). One whose strides are those of the layout is passed as it is, another
  is copied, and results have these strides: set_layout(which, 1, n) takes arrays in Fortran's order without a copy.
- Failures raise a subclass of spar.Error with the library's message: ArgumentError, StateError, NumericError, ... .status
  is the SPAR_ERR_*.
- A fluid's solver is a function of (session, t, dt, iteration), what is called before the steps of trials one of
  (session, t, dt), a log one of (level, text), a progress one of (done, expected), which answers 0 or None to go on. What
  they raise ends the step, or the trial's call, and is raised again.
- A trial is made by session.trial_create(), and keeps its callbacks.
- A session is closed by `with`, close(), or at the latest when nothing refers to it; members, joints, fluids and trials
  keep it. What belonged to it is closed with it: further calls raise spar.Error. Nothing of spar can be copied or pickled.
- Several ranks: spar.Session(comm) with an mpi4py communicator or its Fortran integer.
The library is the one that SPAR_LIBRARY names, else the one in the folder of the package (a wheel has it there), else the
libspar.so.0.9 that the loader finds. libspar_aero is in the same folder.
"""
import ctypes
import inspect
import os
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


# ---- the table ----

_NUMBERS = {'int': (ctypes.c_int, numpy.dtype(numpy.intc)), 'int64_t': (ctypes.c_int64, numpy.dtype(numpy.int64)),
            'double': (ctypes.c_double, numpy.dtype(numpy.float64)), 'float': (ctypes.c_float, numpy.dtype(numpy.float32))}
_CALLBACKS = {
    'fluid_solver': ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_double, ctypes.c_double, ctypes.c_int,
                                     ctypes.c_void_p),
    'before_step': ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_double, ctypes.c_double, ctypes.c_void_p),
    'progress': ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_double, ctypes.c_double, ctypes.c_void_p),
    'log': ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_int, ctypes.c_char_p, ctypes.c_void_p)}
_LAID = ('push_forces', 'push_forces_at', 'pull_forces', 'pull_motion', 'pull_poses')  # arrays [n][3] by the fluid's layout
_OF_FORCE_NODES = ('push_forces', 'push_forces_at', 'pull_forces', 'get_forces')
_ENOUGH = 1000  # the capacity of lists that the library cuts off at their end


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
        self.names = {p.name for p in self.parameters}
        self.asked_names = [p.name for p in self.asked]
        self.values = {p.name for p in self.parameters if p.how == 'value'}
        self.shaped = [p for p in self.parameters if p.array or p.how == 'list']
        self.single = None  # the call of the same name in single precision
        plain = self.python_name.replace('_f32', '')
        self.laid = self.owner == 'fluid' and plain in _LAID
        self.of_force_nodes = plain in _OF_FORCE_NODES
        self.steps = [(p, self._way(p)) for p in self.parameters]

    def _way(self, p):
        """How _Running makes C's argument of p."""
        if p is self.parameters[0] and self.owner:
            return _Running.own
        if p.how == 'callback':
            return _Running.callback
        if p.type == 'context':
            return _Running.nothing
        if p.type in _CLASSES:
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
            if name in given or name not in self.names:
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


def _laid_out(n, kind, strides):
    """Zeros of the shape (n, 3) with these strides, in bytes."""
    size = (max(n, 1) - 1) * strides[0] + 2 * strides[1] + kind.itemsize
    return numpy.ndarray((n, 3), kind, buffer=bytearray(size), strides=strides)


class _Running:
    """A call under way: from Python's arguments to C's, and its results back."""
    __slots__ = ('call', 'owner', 'given', 'sizes', 'results', 'raised', 'keep', 'callbacks', 'strides')

    def __init__(self, call, owner, given):
        self.call, self.owner, self.given = call, owner, given
        self.sizes, self.results, self.raised, self.keep, self.callbacks = {}, [], [], [], {}
        if owner is not None:
            self.open(owner)
        self.strides = owner.strides(call, given) if call.laid else None  # numbers between nodes, components; None: packed

    def run(self):
        """Calls C and answers its results."""
        call = self.call
        for p in call.shaped:
            if p.how == 'list':
                self.sizes['blades' if call.name == 'spar_aero_create' else p.dims[0]] = len(self.given[p.name])
            elif self.given.get(p.name) is not None:
                self.array_given(p)
        arguments = [way(self, p) for p, way in call.steps]
        answer = self.called(arguments)
        if call.answer == 'text':
            return (answer or b'').decode()
        if call.name == 'spar_has':
            return bool(answer)
        if call.answer == 'int' and answer != 0:
            if self.raised:
                raise self.raised[0]
            raise _failed(answer, self.message())
        if isinstance(self.owner, Trial):
            self.owner.callbacks.update(self.callbacks)
        results = [r() if callable(r) else r for r in self.results]
        return results[0] if len(results) == 1 else tuple(results) or None

    def called(self, arguments):
        """Calls C. What callbacks of a trial raise meanwhile is this call's."""
        trials = [thing for thing in (self.owner, *self.given.values()) if isinstance(thing, Trial)]
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
        """The message of the session of the owner, else of what is given, else of none."""
        things = [self.owner] + [value for value in self.given.values() if isinstance(value, _Thing)]
        session = next((thing.session for thing in things if thing is not None and thing.session is not None), None)
        return _calls['spar_session_message'].function(session.handle if session is not None else None).decode()

    # ---- arrays ----

    def array_given(self, p):
        """An array of the caller's, as C reads it; what it shows of the sizes."""
        kind = _NUMBERS[p.type][1]
        value = self.given[p.name]
        strides = self.strides if self.strides is not None and p.dims[1:] == [3] else None
        if p.how == 'out' and p not in self.call.asked:  # filled in place
            if not isinstance(value, numpy.ndarray) or value.dtype != kind or not (strides or value.flags.c_contiguous):
                raise TypeError(f'{p.name}: a contiguous array of {kind} is filled in place')
            if not value.flags.writeable:
                raise TypeError(f'{p.name}: an array that can be written is filled in place; this one cannot')
        elif not (isinstance(value, numpy.ndarray) and value.dtype == kind):
            value = numpy.asarray(value)
            if value.size and not numpy.can_cast(value.dtype, kind, 'same_kind'):
                raise TypeError(f'{self.call.name}: {p.name} is of {value.dtype}; it must be of {kind}')
            value = value.astype(kind)
        known = [self.size(d) for d in p.dims]
        self.check_shape(p, value, known)
        if strides is not None:
            value = self.laid(p, value, strides)
        elif not value.flags.c_contiguous:
            value = numpy.ascontiguousarray(value)
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
        """An array [n][3] in the layout of the fluid: itself, if it is, else a copy."""
        if value.ndim != 2:
            raise ValueError(f'{self.call.name}: {p.name} has the shape {value.shape}; after set_layout it must be {p.name}[n][3]')
        strides = tuple(value.itemsize * number for number in strides)
        if value.strides[1] == strides[1] and (value.strides[0] == strides[0] or len(value) < 2) or not value.size:
            return value
        if p.result:
            raise TypeError(f'{p.name}: it is filled in place, so its strides must be {strides}; they are {value.strides}')
        copy = _laid_out(len(value), value.dtype, strides)
        copy[...] = value
        return copy

    def size(self, d):
        """How large a dimension is; None: nothing says it yet."""
        if isinstance(d, int):
            return d
        if d in self.sizes:
            return self.sizes[d]
        if d in self.given:
            return int(self.given[d])
        if d in self.call.values:
            return _ENOUGH if d == 'capacity' and not self.array_named(d) else None
        if self.owner is None:
            return None
        size = self.owner.size(d, self.call, self.given)
        if size is not None:
            self.sizes[d] = size
        return size

    def array_named(self, d):
        """Whether an array is given that has this dimension."""
        return any(p.array and d in p.dims and self.given.get(p.name) is not None for p in self.call.parameters)

    def capacity(self, name):
        """What the result has room for: by a constant of the table, by the caller's array, or enough."""
        for p in self.call.parameters:
            if p.array and p.result and p.how == 'out':
                if name == 'columns':
                    return self.size(p.dims[1])
                size = self.size(p.dims[0])
                if size is not None:
                    return size
        return self.sizes.get(name, _ENOUGH)

    # ---- from a parameter to C's argument ----

    def nothing(self, _p):
        """A context."""

    def open(self, thing):
        """The handle of a thing, which is there; that of one which is not leads into memory that is another's."""
        closed = thing.closed()
        if closed:
            raise _failed(CONSTANTS['SPAR_ERR_ARGUMENT'], f'{self.call.name}: {closed}')
        return thing.handle

    def own(self, _p):
        """The thing whose method this is."""
        return self.owner.handle

    def value(self, p):
        """A number, or a count that an array shows."""
        if p.name in self.given:
            return self.given[p.name]
        size = self.size(p.name) if p.type == 'int64_t' or p.name == 'blades' else None
        if p.name in ('capacity', 'rows', 'columns'):
            size = self.capacity(p.name)
        if size is None:
            if p.name == 'n':
                return 0  # of no array
            raise TypeError(f'{self.call.python_name} lacks {p.name}')
        return size

    def handle(self, p):
        """Handles that are given, and a handle that the call makes."""
        if p.how == 'list':
            handles = (ctypes.c_void_p * len(self.given[p.name]))(*[self.open(h) for h in self.given[p.name]])
            self.keep.append(handles)
            return ctypes.cast(handles, ctypes.c_void_p)
        if p.how == 'value':
            value = self.given.get(p.name)
            return self.open(value) if value is not None else None
        made = ctypes.c_void_p()
        of = list(self.given.get('sections', []))[:1]
        session = self.owner.session if self.owner is not None else of[0].session if of else None
        self.results.append(lambda: session if p.type == 'session' else _CLASSES[p.type](made.value, session))
        return ctypes.byref(made)

    def text(self, p):
        """A text, or room for one."""
        if p.how == 'in':
            value = self.given.get(p.name)
            return os.fsencode(value) if value is not None else None
        text = ctypes.create_string_buffer(_ENOUGH)
        self.results.append(lambda: text.value.decode())
        return ctypes.addressof(text)

    def array(self, p):
        """An array that is given, and room for one that comes back."""
        value = self.given.get(p.name)
        if value is None and p.result and p.name not in self.given:
            shape = [self.size(d) if d != 'capacity' else self.capacity(d) for d in p.dims]
            if None in shape:
                return None  # not wanted, for nobody knows how large it is
            kind = _NUMBERS[p.type][1]
            if self.strides is not None and p.dims[1:] == [3]:
                value = _laid_out(shape[0], kind, tuple(kind.itemsize * number for number in self.strides))
            else:
                value = numpy.zeros(shape, kind)
        if value is None:
            return None
        self.keep.append(value)
        if p.result:
            self.results.append(value)
        return value.ctypes.data

    def number(self, p):
        """Room for a number that comes back."""
        if p.name in self.given and self.given[p.name] is None:
            return None
        number = _NUMBERS[p.type][0](*([self.given[p.name]] if p.name in self.given else []))
        self.results.append(lambda: number.value)
        return ctypes.byref(number)

    def callback(self, p):
        """What C calls in Python's place."""
        kind, function = _CALLBACKS[p.type], self.given.get(p.name)
        if p.type == 'log' and function is not None:
            def called(_session, level, text, _context):
                function(level, text.decode(errors='replace'))
            self.owner.log = kind(called)  # kept as long as the session
            return self.owner.log
        made = kind() if function is None else kind(self.calling(p, function))
        self.keep.append(made)
        self.callbacks[p.name] = made  # a trial keeps it until the next
        return made

    def calling(self, p, function):
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
            raise _failed(status, _calls['spar_session_message'].function(None).decode())
        self.handle = made.value


def _count(thing, name, *of):
    """What a call answers whose result is one count, without what the other calls need."""
    number = ctypes.c_int64()
    status = _calls[name].function(thing.handle, *of, ctypes.byref(number))
    if status != 0:
        raise _failed(status, _calls['spar_session_message'].function(thing.session.handle).decode())
    return number.value


class Member(_Thing):
    """A structure: a beam, a rigid body, a point, or one that the host solves. A session makes it."""
    kind = 'member'

    def size(self, d, _call, _given):
        return _count(self, 'spar_member_get_count') if d in ('n', 'nodes') else None


class Joint(_Thing):
    """A joint of two members, a spring or a link. A session makes it."""
    kind = 'joint'


class Fluid(_Thing):
    """A fluid's nodes on this rank. A member makes it."""
    kind = 'fluid'

    def size(self, d, call, given):
        if d == 'n':
            return _count(self, 'spar_fluid_get_count', given.get('which', 1 if call.of_force_nodes else 0))
        if d == 'P':
            return self.get_member().get_elements()[1]
        return None

    def strides(self, call, given):
        """Numbers between nodes and between components in the layout; None: packed."""
        node, component = ctypes.c_int64(3), ctypes.c_int64(1)
        _calls['spar_fluid_get_layout'].function(self.handle, given.get('which', 1 if call.of_force_nodes else 0),
                                                 ctypes.byref(node), ctypes.byref(component))
        return None if (node.value, component.value) == (3, 1) else (node.value, component.value)


class Trial(_Thing):
    """Trial runs on a copy of a session. A session makes it."""
    kind, owned = 'trial', True

    def __init__(self, handle, session=None):
        super().__init__(handle, session)
        self.callbacks = {}  # what C calls, by the names of the arguments
        self.raised = []  # by its callbacks, in the call under way


class Polar(_Thing):
    """Coefficients of an airfoil over the angle of attack."""
    kind, owned = 'polar', True

    def __init__(self, alpha_rad, cl, cd, cm=None):
        made = _calls['spar_polar_create'](None, alpha_rad, cl, cd, cm)
        super().__init__(made.handle)
        made.handle = None


class Aero(_Thing):
    """Blade elements: sections has one fluid of stations for each blade."""
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
globals().update((name[len('SPAR_'):], number) for name, number in CONSTANTS.items())
_said = _table.read()
_calls = {_name: _Call(_one) for _name, _one in _said.items()}
for _name, _one in _calls.items():
    _one.single = _calls.get(_name + '_f32')
    if _one.public:
        _owner = _CLASSES[_one.owner] if _one.owner else None
        _owner = {'polar': Polar, 'aero': Aero}.get(_one.owner, _owner)
        if hasattr(_owner, _one.python_name) if _owner else _one.python_name in globals():
            raise ImportError(f'{_name}: there are two of the name {_one.python_name}')
        if _owner:
            setattr(_owner, _one.python_name, _function(_one, _said[_name]))
        else:
            globals()[_one.python_name] = _function(_one, _said[_name])
__version__ = VERSION
