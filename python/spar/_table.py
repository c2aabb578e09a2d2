"""What the table of the interface says of each call: its owner, its name in Python, what it asks for and what it answers.

The package makes the calls by this, and cmake/python-stubs.py writes the type stubs by it. It needs the standard library alone.
"""
import re

from ._interface import CONSTANTS, DOCS, TABLE

CLASSES = {'session': 'Session', 'member': 'Member', 'joint': 'Joint', 'fluid': 'Fluid', 'trial': 'Trial', 'polar': 'Polar',
           'aero': 'Aero'}
NUMBERS = ('int', 'int64_t', 'double', 'float')
_IN_AND_OUT = {('spar_session_sum', 'x'), ('spar_step_adaptive', 'dt')}  # results that are read too
_PREFIXES = {'member': ('member_', 'beam_')}
_MADE_BY_CLASSES = {'spar_session_create', 'spar_session_create_fcomm', 'spar_polar_create', 'spar_aero_create'}


class Parameter:
    """name, type, how (value, in, out, list, callback), dims, array, result, null: whether None is allowed; word: what a count or a
    capacity is where no array shows it."""

    def __init__(self, text):
        self.name, self.type, self.how, shape, null = text.split('|')
        self.dims = [int(d) if d.isdigit() else CONSTANTS.get(d, d) for d in re.findall(r'\[(\w*)\]', shape)]
        self.array = self.type in NUMBERS and bool(self.dims)
        self.result = self.how == 'out'
        self.null = null == 'null' or self.how == 'callback'
        self.word = null if null != 'null' else ''


class Call:
    """One function of the library."""

    def __init__(self, name, answer, parameters):
        self.name, self.answer = name, answer
        self.parameters = [Parameter(p) for p in parameters]
        shown = {d for p in self.parameters if p.how == 'list' or (p.array and self.given(p)) for d in p.dims}
        first = self.parameters[0] if self.parameters else None
        self.owner = first.type if first and first.type in CLASSES and first.how == 'value' else None
        self.asked = [p for p in self.parameters[1 if self.owner else 0:]  # what the caller gives, in this order
                      if self.given(p) and p.type != 'context' and p.name != 'capacity'
                      and not (p.how == 'value' and (p.name in shown or p.word))]
        self.results = [p for p in self.parameters if p.result]
        self.python_name = name[len('spar_'):]
        for prefix in _PREFIXES.get(self.owner, (f'{self.owner}_',)):
            if self.python_name.startswith(prefix):
                self.python_name = self.python_name[len(prefix):]
        self.public = name not in _MADE_BY_CLASSES and not name.endswith('_destroy')

    def given(self, p):
        """Whether the caller gives a value for p."""
        return not p.result or (self.name, p.name) in _IN_AND_OUT

    def optional(self):
        """The names of those at the end that may be left out."""
        names = []
        for p in reversed(self.asked):
            if not p.null:
                break
            names.append(p.name)
        return names

    def arrays_filled(self):
        """The results that may be given by name: arrays are filled in place, None is not wanted."""
        return [p for p in self.results if p.type not in CLASSES and p.type != 'char' and not self.given(p)]

    def doc(self):
        """What the header says, NULL being None."""
        return re.sub(r'\bNULL\b', 'None', DOCS[self.name])


def read():
    """All calls by their names in C."""
    calls = [Call(words[1], words[2], words[3:]) for words in (line.split() for line in TABLE.strip().split('\n'))]
    return {call.name: call for call in calls}


def error_names():
    """SPAR_ERR_* with the name of its exception."""
    words = {'MEMORY': 'OutOfMemory', 'IO': 'File', 'COMM': 'Communication'}  # those that Python has names like
    return {status: words.get(name[9:], name[9:].title()) + 'Error'
            for name, status in CONSTANTS.items() if name.startswith('SPAR_ERR_')}
