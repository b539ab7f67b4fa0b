"""Files of Stepper.save() and restore(): the bytes alone, or in HDF5 beside what others can read."""

import os

from . import _mbd
from .errors import UseError

_HDF5 = (".h5", ".hdf5")


def _h5py(file):
    try:
        import h5py
    except ImportError as error:
        raise UseError(f"{file}: HDF5 needs h5py (Debian: python3-h5py), which cannot be loaded: {error}; give a file of another "
                       "ending, which gets the bytes alone") from error
    return h5py


def write(file, data, stepper):
    file = os.fsdecode(os.fspath(file))
    h5py = _h5py(file) if file.endswith(_HDF5) else None
    part = f"{file}.{os.getpid()}.part"
    try:
        if h5py:
            import numpy

            with h5py.File(part, "w") as to:
                to.attrs.update({"t": stepper.t, "method": stepper.method, "mbd": _mbd.version})
                to["checkpoint"] = numpy.frombuffer(data, numpy.uint8)
                to["nodes"] = stepper.nodes
                for name, unit in (("positions", "m"), ("quaternions", "x y z w"), ("velocities", "m/s, rad/s; node axes"),
                                   ("accelerations", "m/s2, rad/s2; node axes")):
                    to[name] = getattr(stepper, name)
                    to[name].attrs["unit"] = unit
        else:
            with open(part, "wb") as to:
                to.write(data)
        os.replace(part, file)
    except (OSError, ValueError) as error:
        _remove(part)
        raise UseError(f"{file}: cannot be written: {error}") from error


def read(file):
    file = os.fsdecode(os.fspath(file))
    h5py = _h5py(file) if file.endswith(_HDF5) else None
    try:
        if not h5py:
            with open(file, "rb") as stream:
                return stream.read()
        with h5py.File(file, "r") as stream:
            return stream["checkpoint"][()].tobytes()
    except (OSError, ValueError, KeyError, AttributeError, TypeError) as error:
        raise UseError(f"{file}: is no checkpoint that Stepper.save() has written: {error}") from error


def _remove(file):
    try:
        os.remove(file)
    except (OSError, ValueError):
        pass
