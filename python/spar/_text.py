"""Text files of other programs: their lines, and refusals that name file, line, field, value and cure."""
import math
import os


class ModelError(ValueError):
    """A model lacks something, or has something that is not possible. The message names the file or part, and the cure."""


def read_lines(path):
    """The lines of a file, without their ends. Refused is what is no text, and a file that Git has not fetched."""
    path = os.fspath(path)
    try:
        with open(path, 'rb') as file:
            data = file.read()
    except OSError as error:
        raise ModelError(f'{path}: cannot be read: {error.strerror}') from None
    except ValueError:  # a byte 0 in the name
        raise ModelError(f'{path!r} is no name of a file') from None
    if data.startswith(b'\xef\xbb\xbf'):
        data = data[3:]
    if data.startswith(b'version https://git-lfs.github.com/spec/'):
        raise ModelError(f'{path}, line 1: this is a Git LFS pointer in place of the file; fetch the file with git lfs pull')
    if b'\0' in data or data.startswith((b'\xff\xfe', b'\xfe\xff')):
        raise ModelError(f'{path}: the file is UTF-16 or no text (it has a byte 0 or begins with a mark of UTF-16); save it as UTF-8')
    return data.decode('utf-8', errors='replace').replace('\r\n', '\n').replace('\r', '\n').split('\n')


def number_of(word):
    """The finite number of a word, whose exponent may be Fortran's d; None: it is none."""
    try:
        value = float(word.lower().replace('d', 'e')) if '_' not in word else math.nan
    except ValueError:
        return None
    return value if math.isfinite(value) else None


def leading_numbers(line):
    """The numbers that a line begins with, between blanks or commas."""
    numbers = []
    for word in line.replace(',', ' ').split():
        value = number_of(word)
        if value is None:
            break
        numbers.append(value)
    return numbers


class Text:
    """A text file and its lines."""

    def __init__(self, path):
        self.path, self.lines = os.fspath(path), read_lines(path)
        self.folder = os.path.dirname(self.path)

    def fail(self, what, line=None):
        """Refuses the file.
        line: its number, from 0; None: the file as a whole"""
        raise ModelError(f'{self.path}{"" if line is None else f", line {line + 1}"}: {what}')

    def beside(self, name):
        """The path of a file that is named here, relative to this one."""
        return os.path.join(self.folder, name.strip('"\'').replace('\\', '/'))

    def check(self, value, what, line, low=None, high=None):
        """The value, or a refusal if it is out of its range."""
        if (low is not None and value < low) or (high is not None and value > high):
            limits = f'at least {low:g}' if high is None else f'at most {high:g}' if low is None else f'{low:g} to {high:g}'
            self.fail(f'{what} is {value:g}; give {limits}', line)
        return value
