"""A model over many values of its parameters."""

import functools
import hashlib
import itertools
import json
import os
import pathlib
import sys

from . import _mbd
from .errors import Interrupted, RunError, UseError
from .model import Model
from .values import names_of, text_of, whole


class Sweep:
    """The table of a sweep: sweep["rpm"] is a parameter, sweep["tip.displacement.3"] a column, (points,); nan where a
    point was not done, for which `status` and `messages` say why."""

    def __init__(self, found):
        self._found = found
        #: names of the parameters, list
        self.parameters = found["parameters"]
        #: list of points, lists of texts as the model got them
        self.points = found["points"]
        #: of each point: "done", "failed" (ended too early), "refused" (wrong there, or no start), "lost" (its process
        #: ended by a signal), "open" (not run: interrupted)
        self.status = found["status"]
        #: of each point: why it is not done, or ""
        self.messages = found["messages"]
        #: time reached and CPU time of each point [s], (points,)
        self.t, self.cpu = found["t"], found["cpu"]
        #: how many rows an earlier sweep had done
        self.found = found["found"]

    @property
    def columns(self) -> "List[str]":
        """Names of what was kept, list."""
        return [name for name, _ in self._found["columns"]]

    @property
    def units(self) -> "Dict[str, str]":
        """dict: unit of each column; "" of a pure number."""
        return dict(self._found["columns"])

    @property
    def values(self) -> "numpy.ndarray":
        """All numbers, (points, columns)."""
        return self._found["values"]

    @property
    def csv(self) -> str:
        """The table as `mbd sweep` writes it, str."""
        return self._found["csv"]

    def __len__(self) -> int:
        return len(self.status)

    def __getitem__(self, name: str) -> "numpy.ndarray":
        import numpy

        if name in self.parameters:
            texts = [point[self.parameters.index(name)] for point in self.points]
            try:
                return numpy.array([float(text.split()[0]) for text in texts])
            except (ValueError, IndexError):
                return numpy.array(texts)
        columns = self.columns
        if name in columns:
            return self.values[:, columns.index(name)]
        from .errors import UnknownName

        raise UnknownName(f'"{name}" is neither a parameter nor a column of this sweep; there are '
                          f'{", ".join(self.parameters + columns)}')

    def frame(self):
        """pandas.DataFrame: a row for each point; parameters (numbers without their unit), status, columns, t, cpu, message."""
        import pandas

        data = {name: self[name] for name in self.parameters}
        data["status"] = self.status
        data.update({name: self.values[:, i] for i, name in enumerate(self.columns)})
        data.update({"t": self.t, "cpu": self.cpu, "message": self.messages})
        return pandas.DataFrame(data)

    def __repr__(self):
        return f"<mbd.Sweep of {self._found['model']!r}: {self._found['text'].splitlines()[0]}>"


def sweep(model, vary=None, *, points=None, latin=None, seed=1, quantity=(), set=None, jobs=None, share=None,
          client=None, on=None, tasks=None, sbatch=(), wait=True, out=None, progress=False) -> "Sweep":
    """Runs a model for many values of parameters, several at once, each in a process of its own, and returns a Sweep.

    model: file, Scene or Model
    vary: {"rpm": range(10, 60), "d": ["1 mm", "2 mm"], "f": "1:10:0.5"}: all combinations, the last varies fastest
    latin: a Latin hypercube of so many points instead, in the ranges of `vary`: {"rpm": (10, 60)} or {"rpm": "10:60"}
    points: a CSV file with a line of names, or a list of dicts, instead
    quantity: columns, quantities or records, with "@minimum", "@maximum", "@largest", "@mean" or "@rms" of the rows of
      results in place of the end; none: all that is recorded
    jobs: processes at once; none: as many as there are processors, of a task of Slurm one
    share: "2/8", only every eighth point from the second on, as one of eight processes with the same `out`: the last to
      end writes the table; the others' points that are not there yet are "open"
    client: a dask.distributed.Client, whose workers run the points, each in a thread of its own, in place of processes
      here. They need this mbd, and the model's files under the same names. What a worker that dies was running runs on
      another; a point with which several have died is "lost"
    on: "slurm", to submit a job array to Slurm, a share in each of its `tasks` (none: one for each point, 100 at most), and
      wait for it; Ctrl-C ends the job. `sbatch` has options for that command, ["--partition=long"]; those of all jobs are
      better set in SBATCH_PARTITION … wait=False: submit and return; the last task writes the table in `out`, which all
      machines must see, as this mbd and the model's files
    out: directory that gets sweep.csv and keeps rows as they come: the same sweep goes on from there after Ctrl-C or a
      kill, with more or other points too
    progress: True, or a function f(done, all)

    Failures are rows. Raises ModelError where the model is wrong at any value, UseError (also for what Slurm refuses),
    RunError where tasks of Slurm ended early, and Interrupted; the last two have the Sweep so far in .results. Its processes
    are forked: meanwhile no other thread may be inside mbd.
    """
    handle = model if isinstance(model, Model) else Model(model, set=set)
    if handle is model and set:
        raise TypeError("set: give it to the Model, or give the file in place of the Model")
    _look_at_engine(on, client, share, tasks, sbatch, wait, out)
    plan = _plan_of(vary, points, latin, seed)
    if client is not None:
        if jobs is not None or share is not None:
            raise TypeError("client: its workers say how many run at once; leave out jobs and share")
        _look_at_client(client)
    elif jobs is None:
        jobs = len(os.sched_getaffinity(0)) if on is None else 1
    else:
        jobs = whole(jobs, "jobs")
        if not 1 <= jobs <= 4096:
            raise UseError(f"jobs = {jobs}: give a number of processes from 1 to 4096")
    if share is not None and out is None:
        raise TypeError("share: give out, the directory that all shares have")
    show = progress or None
    if progress is True:
        def show(done, all):
            sys.stderr.write(f"\r\033[K{done} of {all} points")
            sys.stderr.flush()
    table = _mbd.SweepTable(handle._model, plan, names_of(quantity), None if out is None else os.fspath(out),
                            _fingerprint(handle), "", "" if share is None else str(share))
    ends = ""
    try:
        if on == "slurm":
            raised, ends = _run_on_slurm(table, handle, plan, names_of(quantity), jobs, tasks, names_of(sbatch), wait, out, show)
        elif client is not None:
            raised = _run_on(client, table, handle, plan, show)
        else:
            raised = table.run(jobs, show)
    finally:
        table.leave()  # however long a traceback may hold it
        if progress is True:
            sys.stderr.write("\r\033[K")
    result = Sweep(table.found())
    _write_table(result, out, share is not None or not wait)
    if raised is not None:
        raise Interrupted(result) if isinstance(raised, KeyboardInterrupt) else raised
    if on == "slurm" and wait and not result._found["whole"]:
        open = result.status.count("open")
        raise RunError(f"{handle.name}: {open} points have no row: their tasks of Slurm ended early{ends and f' ({ends})'}, "
                       f"{os.path.join(out, 'slurm-*.log')} may say why; the same call goes on from here", results=result)
    return result


def _write_table(result, out, only_whole):
    if out is not None and (result._found["whole"] or not only_whole):
        _write_whole(pathlib.Path(out, "sweep.csv"), result.csv)


def _write_whole(file, text):
    """No other process sees a half of it."""
    part = file.with_name(f".{file.name}.{os.getpid()}.part")
    part.write_text(text, encoding="utf-8")
    part.replace(file)


def _look_at_engine(on, client, share, tasks, sbatch, wait, out):
    if on is None:
        if tasks is not None or len(sbatch) > 0 or not wait:
            raise TypeError('tasks, sbatch and wait are of on="slurm"')
        return
    if on != "slurm":
        raise UseError(f'on = {on!r}: give "slurm", or leave it out to run here')
    if client is not None or share is not None:
        raise TypeError('on="slurm" makes shares itself; leave out client and share')
    if out is None:
        raise TypeError('on="slurm": give out, the directory that all machines see')
    if tasks is not None and not 1 <= whole(tasks, "tasks") <= 1000000:
        raise UseError(f"tasks = {tasks}: give a number from 1 to 1000000")


# ---- tasks of Slurm --------------------------------------------------------------------------------------

# More would wait for the scheduler rather than for results.
_MOST_TASKS = 100


def _run_on_slurm(table, handle, plan, quantities, jobs, tasks, options, wait, out, show):
    """Submits what is open, and waits. Returns what was raised meanwhile, or None, and how tasks ended that ended early."""
    points = len(plan.points)
    tasks = min(whole(tasks or _MOST_TASKS, "tasks"), points)
    numbers = sorted({point % tasks + 1 for point in table.open()})
    if not numbers:
        return None, ""
    out = os.path.abspath(out)
    task = json.dumps({"model": _model_of(handle), "parameters": plan.parameters, "points": plan.points,
                       "quantities": quantities, "jobs": jobs, "out": out})
    # Named after what it says: an earlier job, which may still wait, keeps its own.
    file = pathlib.Path(out, f"slurm-{hashlib.sha256(task.encode()).hexdigest()[:16]}.json")
    _write_whole(file, task)
    package = str(pathlib.Path(__file__).resolve().parents[1])  # wherever this one came from
    command = [sys.executable, "-c", "import sys; sys.path.insert(0, sys.argv.pop(1)); from mbd.sweeps import _task; _task()",
               package, str(file)]
    job = _mbd.submit_to_slurm(command, numbers, tasks, jobs, out, options)
    if not wait:
        return None, ""

    def done():
        table.look_again()
        open = len(table.open())
        if show is not None:
            show(points - open, points)
        return open == 0

    try:
        ends = _mbd.wait_for_slurm(job, done)
        done()  # what came after the last look
    except BaseException as error:
        _mbd.cancel_in_slurm(job)
        return error, ""
    return None, ends


def _task():
    """A share of a sweep, as a task of Slurm: file of the sweep, --share, I/N."""
    file, _, share = sys.argv[1:]
    with open(file, encoding="utf-8") as stream:
        task = json.load(stream)
    name, text, overrides, digest = task["model"]
    handle = _read_there(name, text, tuple(map(tuple, overrides)), digest)
    table = _mbd.SweepTable(handle._model, _mbd.SweepPlan.list(task["parameters"], task["points"]), task["quantities"],
                            task["out"], _fingerprint(handle), "", share)
    try:
        raised = table.run(task["jobs"], None)
    finally:
        table.leave()
    _write_table(Sweep(table.found()), task["out"], True)
    if raised is not None:
        raise raised


# ---- workers of Dask -------------------------------------------------------------------------------------

def _look_at_client(client):
    if not (hasattr(client, "submit") and hasattr(client, "scheduler_info")):
        raise TypeError(f"client: a {type(client).__name__} is no dask.distributed.Client")
    if getattr(client, "asynchronous", False):
        raise UseError("client: it is asynchronous; give one made without asynchronous=True")
    if not client.scheduler_info()["workers"]:
        raise UseError("client: its scheduler has no workers; start one (dask worker ADDRESS) and wait for it "
                       "(client.wait_for_workers(1)), or leave out client to run here")


def _model_of(handle):
    """What a worker reads the model from: (file, text or None, set, digest)."""
    return (handle.file if handle._source is not None else os.path.abspath(handle.file), handle._source,
            tuple(handle._set), _digest(handle))


@functools.lru_cache(maxsize=4)
def _read_there(file, text, overrides, digest):
    handle = Model(text=text, file=file, set=overrides) if text is not None else Model(file, set=overrides)
    if _digest(handle) != digest:
        raise UseError(f"{file}: is not the same on a worker as here; give workers the files of the model, and this "
                       f"version of mbd ({_mbd.version})")
    return handle


def _run_there(model, values, columns):
    """A point, on a worker."""
    return _mbd.run_point(_read_there(*model)._model, values, columns)


def _run_on(client, table, handle, plan, show):
    """Lets workers run what is open. Returns what was raised meanwhile, or None."""
    from distributed import KilledWorker, as_completed

    model, columns = _model_of(handle), table.columns()
    todo = table.open()
    done, all = len(plan.points) - len(todo), len(plan.points)
    todo = iter(todo)
    # A few more than run at once: rows come soon, and a million points are no burden to the scheduler.
    ahead = 4 * max(1, sum(worker["nthreads"] for worker in client.scheduler_info()["workers"].values()))
    point_of = {}
    aside = []  # a worker that dies is held against all points that were there, also those that waited

    def submit(point):
        future = client.submit(_run_there, model, list(zip(plan.parameters, plan.points[point])), columns, pure=False)
        point_of[future] = point
        return future

    def take(future, alone=False):
        nonlocal done
        point = point_of.pop(future)
        try:
            row = future.result()
        except KilledWorker as error:
            if not alone:
                aside.append(point)
                return
            row = ("lost", 0.0, 0.0, [], f"workers that ran it died: {error}")
        except ModuleNotFoundError as error:
            raise UseError(f"client: a worker has no mbd ({error}); install it where workers run") from error
        table.add(point, row)
        done += 1
        if show is not None:
            show(done, all)

    try:
        running = as_completed([submit(point) for point in itertools.islice(todo, ahead)])
        for future in running:
            take(future)
            for another in itertools.islice(todo, 1):
                running.add(submit(another))
        for point in aside:  # one after the other: now it is theirs alone
            take(submit(point), alone=True)
    except KeyboardInterrupt as error:
        return error
    finally:
        client.cancel(list(point_of))
    return None


def _plan_of(vary, points, latin, seed):
    if points is not None:
        if vary is not None or latin is not None:
            raise TypeError("points: are all points; leave out vary and latin")
        if isinstance(points, (str, os.PathLike)):
            return _mbd.SweepPlan.file(os.fspath(points))
        points = [dict(point) for point in points]
        names = list(points[0]) if points else []
        for point in points:
            if list(point) != names:
                raise UseError(f"points: {list(point)} are not the parameters of the first point, {names}")
        return _mbd.SweepPlan.list(names, [[text_of(value, name) for name, value in point.items()] for point in points])
    if not vary:
        raise TypeError("sweep: give vary= or points=")
    vary = dict(vary)
    if latin is not None:
        if not whole(latin, "latin") >= 1:
            raise UseError(f"latin = {latin}: give a number of points")
        ranges = []
        for name, ends in vary.items():
            if not isinstance(ends, str):
                if len(ends) != 2:
                    raise UseError(f"vary: {name} has {len(ends)} ends, must have two")
                ends = ":".join(text_of(end, name) for end in ends)
            ranges.append(f"{name}={ends}")
        return _mbd.SweepPlan.latin(ranges, whole(latin, "latin"), whole(seed, "seed"))
    if all(isinstance(values, str) for values in vary.values()):
        return _mbd.SweepPlan.grid([f"{name}={values}" for name, values in vary.items()])
    lists = []
    for name, values in vary.items():
        if isinstance(values, str):
            grid = _mbd.SweepPlan.grid([f"{name}={values}"])
            values = [point[0] for point in grid.points]
        elif not hasattr(values, "__iter__"):
            values = [values]
        if getattr(values, "ndim", 1) > 1:
            raise UseError(f"vary: {name} has values of shape {values.shape}; give numbers in one row")
        lists.append([text_of(value, name) for value in values])
        if not lists[-1]:
            raise UseError(f"vary: {name} has no values")
    return _mbd.SweepPlan.list(list(vary), [list(point) for point in itertools.product(*lists)])


def _fingerprint(model):
    """Of the model, its parameters and this library: rows of another are not believed."""
    files = [os.stat(file) for file in (_mbd.__file__, _mbd.library_file)]
    return f"{_digest(model)} " + " ".join(f"{file.st_size} {file.st_mtime_ns}" for file in files)


def _digest(model):
    """Of the model and its parameters."""
    digest = hashlib.sha256(f"{_mbd.version} {model._model.parameters}".encode())
    if model._source is not None:
        digest.update(model._source.encode())
    else:
        for file in [model.file] + model._model.includes:
            with open(file, "rb") as stream:
                digest.update(stream.read())
    return digest.hexdigest()
