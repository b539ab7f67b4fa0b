"""libmbd from Python: load, run, step and study models of flexible multibody dynamics.

    m = mbd.Model("rotor.xml", set={"rpm": "30 rpm"})
    r = m.run()
    r["tip.displacement"]            # numpy, one row for each row of results
    s = m.stepper(method="radau", tolerance=1e-6)
    while s.t < 1: s.step()

Numbers are in SI units and radians; strings may carry another unit ("30 rpm"). What goes wrong is an mbd.Error
(ModelError, RunError, UseError, UnknownName), Ctrl-C an mbd.Interrupted.
"""

from ._mbd import Inputs, State, Stepper
from ._mbd import has_pages, version as __version__
from .errors import Error, Interrupted, ModelError, RunError, UnknownName, UseError
from .model import Model, Page, Results, read
from .scene import Element, Scene
from .studies import accuracy, campbell, effects, linearize, modes, rotations
from .sweeps import Sweep, sweep

for _class in (Inputs, State, Stepper):
    _class.__module__ = "mbd"
del _class

__all__ = [
    "Element", "Error", "Inputs", "Interrupted", "Model", "ModelError", "Page", "Results", "RunError", "Scene", "State",
    "Stepper", "Sweep", "UnknownName", "UseError", "accuracy", "campbell", "effects", "has_pages", "linearize", "modes",
    "read", "rotations", "sweep", "__version__",
]
