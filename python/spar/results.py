"""Writes a run's channels for the tools of wind energy: OpenFAST's binary .outb, CSV, HDF5.

    from spar import results
    results.write('run.outb', {'Time': ('s', t), 'RotSpeed': ('rpm', speed), 'GenPwr': ('kW', power)})
    results.write('run.csv', results.read_history('blade.out/history.csv'))

Tools that read the binary files of OpenFAST open an .outb: openfast-io, pCrunch, pydatview, welib. HDF5 needs h5py.
"""
import os
import struct

import numpy

_UNITS = ('m', 'N', 'Nm', 's', 'rad', 'Hz', 'W', 'J', 'kg', 'm_s', 'm_s2', 'rad_s', 'rad_s2', 'MW', 'MN', 'MNm', 'rpm', 'deg')


def write(path, channels, description='written by spar'):
    """Writes all channels; the ending of the path says how: .outb, .csv, .h5.
    channels: name: (unit, values[n]), the first of which is the time in s
    An .outb has even steps. Where all names have at most 10 characters, values keep all digits; else they are rounded to 1/65535 of
    their range (at least to 1e-7 of the largest), as OpenFAST does by default."""
    table = {name: (unit, numpy.asarray(values, float)) for name, (unit, values) in channels.items()}
    lengths = {values.shape for _, values in table.values()}
    if len(table) < 2 or len(lengths) != 1 or len(next(iter(lengths))) != 1 or next(iter(lengths))[0] < 1:
        raise ValueError(f'{path}: give two channels at least, the time first, each of one length; they have {sorted(lengths)}')
    ending = os.path.splitext(os.fspath(path))[1].lower()
    if ending not in _WRITERS:
        raise ValueError(f'{path}: the ending must be one of {", ".join(_WRITERS)}')
    _WRITERS[ending](path, table, description)


def read_history(path):
    """Channels of a CSV file whose names end in _unit, as spar-run writes it."""
    with open(path, encoding='utf-8') as file:
        names = file.readline().strip().split(',')
        values = numpy.loadtxt(file, delimiter=',', ndmin=2)
    channels = {}
    for name, column in zip(names, values.T):
        unit = next((u for u in sorted(_UNITS, key=len, reverse=True) if name.endswith('_' + u)), None)
        plain = name[:-len(unit) - 1] if unit else name
        unit = unit.replace('_', '/').replace('s2', 's^2') if unit else '-'
        channels['Time' if plain == 't' else plain] = (unit, column)
    return channels


def _even(path, time):
    """The time's first value and step."""
    step = (time[-1] - time[0]) / (len(time) - 1) if len(time) > 1 else 1.0
    if step <= 0 or abs(time - time[0] - step * numpy.arange(len(time))).max() > 1e-6 * step * len(time):
        raise ValueError(f'{path}: an .outb has even time steps; interpolate the channels to even times, or write .csv')
    return float(time[0]), float(step)


def _write_outb(path, table, description):
    names, data = list(table), numpy.column_stack([values for _, values in table.values()])
    if not numpy.isfinite(data).all():
        raise ValueError(f'{path}: a value is not finite')
    first, step = _even(path, data[:, 0])
    units = [f'({unit})' for unit, _ in table.values()]
    width = max(10, *(len(text) for text in names + units))
    rows, count = data[:, 1:], len(names) - 1
    text = description.encode('ascii', 'replace')
    labels = b''.join(one.encode('ascii', 'replace').ljust(width)[:width] for one in names + units)
    with open(path, 'wb') as file:
        if width == 10:
            file.write(struct.pack('<hiidd', 3, count, len(rows), first, step) + struct.pack('<i', len(text)) + text + labels)
            file.write(rows.astype('<f8').tobytes())
            return
        low, high = rows.min(axis=0), rows.max(axis=0)
        scale = numpy.where(high > low, 65535 / numpy.where(high > low, high - low, 1), 1)
        scale = numpy.minimum(scale, 8e6 / numpy.maximum(abs(rows).max(axis=0), 1e-30)).astype('<f4')  # the offset has 24 bits
        offset = (-32768 - scale.astype(float) * low).astype('<f4')
        file.write(struct.pack('<hhiidd', 4, width, count, len(rows), first, step) + scale.tobytes() + offset.tobytes())
        file.write(struct.pack('<i', len(text)) + text + labels)
        packed = numpy.clip(numpy.rint(rows * scale.astype(float) + offset.astype(float)), -32768, 32767)
        file.write(packed.astype('<i2').tobytes())


def _write_csv(path, table, _description):
    numpy.savetxt(path, numpy.column_stack([values for _, values in table.values()]), delimiter=',', fmt='%.10g', comments='',
                  header=','.join(f'{name}_({unit})' for name, (unit, _) in table.items()))


def _write_hdf5(path, table, description):
    try:
        import h5py  # pylint: disable=import-outside-toplevel
    except ImportError:
        raise ImportError('HDF5 needs h5py: pip install h5py') from None
    with h5py.File(path, 'w') as file:
        file.attrs['description'] = description
        for name, (unit, values) in table.items():
            file.create_dataset(name, data=values).attrs['unit'] = unit


_WRITERS = {'.outb': _write_outb, '.csv': _write_csv, '.h5': _write_hdf5}
