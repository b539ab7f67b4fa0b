"""Models and the results of their runs."""

import html as _html
import json
import os
import sys
import tempfile
import time as _time

from . import _mbd
from .errors import Interrupted, RunError, UseError
from .values import names_of, optional_text, overrides_of


class Model:
    """A model: a file, a text, or a Scene built in Python.

    path: file name or mbd.Scene
    text: the model itself, in place of a file; `file` is what messages call it
    set: dict, values of parameters in place of the model's: numbers, or texts with a unit ("30 rpm")

    Raises ModelError, with .file and .line, for what models do not allow. What connects its parts is looked at when it
    is first run, stepped or checked.
    """

    def __init__(self, path=None, *, text=None, set=None, file="model.xml"):
        if (path is None) == (text is None):
            raise TypeError("Model: give a file or a Scene, or text=")
        self._set = overrides = overrides_of(set)
        self._source = None  # of what is no file
        if text is not None:
            if not isinstance(text, str):
                raise TypeError(f"text: {type(text).__name__} is no str")
            self._source = str(text)
            self._model = _mbd.Model.from_text(str(text), str(file), overrides)
        elif hasattr(path, "_tree"):
            self._source = path.xml()
            self._model = _mbd.Model.from_elements(path._tree(), path._file, overrides)
        else:
            self._model = _mbd.Model.from_file(os.fspath(path), overrides)
        self.results = None

    @property
    def name(self) -> str:
        """Of the model, str."""
        return self._model.name

    @property
    def file(self) -> str:
        """It was read from, str."""
        return self._model.file

    @property
    def parameters(self) -> "Dict[str, float]":
        """dict: values of all parameters, SI units."""
        return self._model.parameters

    @property
    def columns(self) -> "Dict[str, str]":
        """dict: what a run records, {column: unit}, the first is time [s] or load_factor. Compiles the model."""
        return dict(self._model.columns())

    def check(self) -> "Dict[str, Any]":
        """dict: what `mbd check --json` says: sizes, mechanism, redundant constraints, gaps, notes."""
        return json.loads(self._model.check())

    def explain(self) -> "Dict[str, Any]":
        """dict: what `mbd explain --json` says: what is simulated, where it is stated, what is absent and why."""
        return json.loads(self._model.explain())

    def run(self, progress=False, *, out=None, method=None, step=None, tolerance=None, output=None,
            stages=None, without=(), accuracy=None, quantities=(), choose_within=600.0, motion=False, frames=None,
            certify=False, estimate_error=True) -> "Results":
        """Runs the model as `mbd run` does, to the same bits, and returns Results.

        progress: True shows a line on stderr; or a function f(t, duration, step), called a few times a second
        out: directory for history.csv, history.svg and report.json, and for modes where the model asks for some; none:
        nothing is written
        method, step [s], tolerance, output [s], stages: integrate otherwise than the model says (of a <transient>)
        without: effects to leave out, as `mbd effects` names them
        accuracy: chooses settings for this error of `quantities`, within choose_within [s] of CPU time
        motion: keeps the motion for Results.view(); frames: so many, else one with each row
        certify: makes the dear checks of the certificate too
        estimate_error: estimates the error in time by a second run in other steps

        Runs on a thread of its own without Python's lock. Raises ModelError for what cannot start, RunError for a run
        that ends too early, Interrupted for Ctrl-C; the last two have .results, which are also in Model.results.
        """
        show, line = progress or None, None
        if progress is True:
            line = _ProgressLine()
            show = line.show
        elif show is not None and not callable(show):
            raise TypeError("progress: give True, False or a function of t, duration and step")
        kept = None
        if motion and out is None:
            kept = tempfile.TemporaryDirectory(prefix="mbd_")
            out = kept.name
        try:
            table, raised = self._model.run(
                show, optional_text(method, "method"), optional_text(step, "step"),
                optional_text(tolerance, "tolerance"), optional_text(output, "output"), optional_text(stages, "stages"),
                names_of(without), None if accuracy is None else float(accuracy), names_of(quantities), float(choose_within),
                bool(certify), bool(estimate_error), bool(motion), frames, None if out is None else os.fspath(out))
        finally:
            if line is not None:
                line.wipe()
        self.results = None
        if table is not None:
            self.results = Results(self.name, table, json.loads(table.report), out, kept)
        if raised is not None:
            raise Interrupted(self.results) if isinstance(raised, KeyboardInterrupt) else raised
        if not self.results.complete:
            raise RunError(f"{self.name}: {self.results.failure}", self.results.t, self.results)
        return self.results

    def stepper(self, *, method=None, step=None, tolerance=None, duration=None) -> "Stepper":
        """A Stepper at t = 0, after the equilibrium if the model has a <static>.

        method, step [s], tolerance, duration [s]: otherwise than the model's <transient> says
        """
        return _mbd.stepper(self._model, optional_text(method, "method"), optional_text(step, "step"),
                            optional_text(tolerance, "tolerance"), optional_text(duration, "duration"))

    def view(self) -> "Page":
        """A page that shows the model, with the gaps of joints that do not close."""
        return Page(self._model.page())

    def __repr__(self):
        return f"<mbd.Model {self.name!r} from {self.file or 'Python'}>"


class Results:
    """What a run has recorded. r["tip.displacement"] is a quantity, r["tip"] all of a record, r["tip.displacement.3"]
    a column; rows are the states of history.csv. Arrays are views that cannot be written to.
    """

    def __init__(self, name, table, report, directory=None, kept=None):
        self.name = name
        self._table = table
        self._kept = kept
        #: dict, as report.json: settings, counts, residuals, energies, seconds, certificate …; {} where there is none
        self.report = report
        #: directory it was written to, str, or None
        self.directory = None if directory is None else os.fspath(directory)

    @property
    def columns(self) -> "List[str]":
        """Names of the columns, list; the first is time or load_factor."""
        return [name for name, _ in self._table.columns]

    @property
    def units(self) -> "Dict[str, str]":
        """dict: unit of each column and quantity; "" of a pure number."""
        units = {}
        for name, unit in self._table.columns:
            units[name] = unit
            quantity, dot, component = name.rpartition(".")
            if dot and component.isdigit():
                units.setdefault(quantity, unit)
        return units

    @property
    def values(self) -> "numpy.ndarray":
        """All numbers, (rows, columns)."""
        return self._table.values

    @property
    def time(self) -> "numpy.ndarray":
        """The first column: time [s], or load_factor."""
        return self._table.get(self.columns[0], self.name)

    def __getitem__(self, name: str) -> "numpy.ndarray":
        """A column, (rows,); or a quantity or a record, (rows, components). Raises UnknownName."""
        if not isinstance(name, str):
            raise TypeError("results are looked up by name: r[\"tip.displacement\"]")
        return self._table.get(name, self.name)

    def __contains__(self, name) -> bool:
        try:
            self[name]
        except (KeyError, TypeError):
            return False
        return True

    def __len__(self) -> int:
        return len(self.values)

    def __iter__(self) -> "Iterator[str]":
        return iter(self.columns)

    def keys(self) -> "List[str]":
        return self.columns

    @property
    def complete(self) -> bool:
        """Whether the run came to its end."""
        return self._table.failure == ""

    @property
    def failure(self) -> str:
        """Why it did not, str; "" if it did."""
        return self._table.failure

    @property
    def t(self) -> float:
        """Time reached [s]."""
        return self._table.t

    @property
    def certificate(self) -> "Dict[str, Any]":
        """dict: verdict and checks (value, bounds, where) of the run."""
        return self.report.get("certificate", {})

    @property
    def expectations(self) -> "List[Dict[str, Any]]":
        """list of dict: the numbers the model expects, what came, and whether it passes."""
        return self.report.get("expectations", [])

    @property
    def as_expected(self) -> bool:
        """Complete, and all expectations met."""
        return self.complete and all(one["pass"] for one in self.expectations)

    def frame(self):
        """pandas.DataFrame with a column for each column, indexed by time (or load_factor)."""
        import pandas

        columns = self.columns
        values = self.values
        index = pandas.Index(values[:, 0], name=columns[0])
        return pandas.DataFrame(values[:, 1:], index=index, columns=columns[1:], copy=True)

    def plot(self, *names, ax=None):
        """Draws records, quantities or columns (none: all) over time by matplotlib; returns the axes, one for each unit,
        or `ax`."""
        import matplotlib.pyplot as pyplot

        chosen = {}  # by unit
        for name in names or list(dict.fromkeys(c.split(".")[0] for c in self.columns[1:])):
            values = self[name]
            if values.ndim == 1:
                found = [name]
            else:
                found = [c for c in self.columns if c.rpartition(".")[0] == name] or \
                        [c for c in self.columns if c.split(".")[0] == name]
            for column in found:
                chosen.setdefault(self.units[column], []).append(column)
        if not chosen:
            raise UseError(f"{self.name}: nothing is recorded; add a <record> to the model")
        if ax is not None:
            axes = [ax] * len(chosen)
        else:
            axes = list(pyplot.subplots(len(chosen), sharex=True, squeeze=False)[1][:, 0])
        for axis, (unit, columns) in zip(axes, chosen.items()):
            for column in columns:
                axis.plot(self.time, self[column], label=column)
            axis.set_ylabel(f"[{unit}]" if unit else "")
            axis.legend()
        axes[-1].set_xlabel("time [s]" if self.columns[0] == "time" else self.columns[0])
        return ax if ax is not None else axes

    def view(self, frames=None) -> "Page":
        """The motion as a page in 3-D, of a run with motion=True; `frames`: at most so many."""
        if self.directory is None or not os.path.exists(os.path.join(self.directory, "motion.bin")):
            raise UseError("the motion was not kept; run the model with motion=True")
        return Page(_mbd.page_of_results(self.directory, frames))

    def __repr__(self):
        state = "complete" if self.complete else self.failure
        return f"<mbd.Results of {self.name!r}: {len(self)} rows, {len(self.columns)} columns; {state}>"


def read(directory) -> "Results":
    """Results that `mbd run` has written: a directory, or a CSV file with a line of names."""
    table = _mbd.read_table(os.fspath(directory))
    report = {}
    file = os.path.join(os.fspath(directory), "report.json")
    if os.path.isfile(file):
        with open(file, encoding="utf-8") as stream:
            report = json.load(stream)
    where = os.fspath(directory)
    return Results(report.get("model") or os.path.basename(os.path.abspath(where)), table, report,
                   where if os.path.isdir(where) else None)


class Page:
    """One HTML page that loads nothing. A notebook shows it; save() writes it."""

    def __init__(self, html):
        self.html = html

    def save(self, file):
        with open(file, "w", encoding="utf-8") as stream:
            stream.write(self.html)
        return file

    def _repr_html_(self):
        return (f'<iframe srcdoc="{_html.escape(self.html)}" style="width:100%;height:600px;border:0" '
                'allowfullscreen></iframe>')

    def __repr__(self):
        return f"<mbd.Page, {len(self.html)} bytes>"


class _ProgressLine:
    def __init__(self):
        self._begun = _time.monotonic()
        self._dirty = False

    def show(self, t, duration, step):
        left = (_time.monotonic() - self._begun) * (duration - t) / t if t > 0 else 0
        sys.stderr.write(f"\r\033[Kt = {t:.6g} of {duration:.6g} s, step {step}, {left:.0f} s left")
        sys.stderr.flush()
        self._dirty = True

    def wipe(self):
        if self._dirty:
            sys.stderr.write("\r\033[K")
            sys.stderr.flush()
