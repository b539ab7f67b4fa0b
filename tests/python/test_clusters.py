"""Sweeps beyond one process: shares, MPI (Open MPI, two ranks), Slurm (one node, its daemons started here) and Dask (two workers)
give the table of one process, byte for byte but for CPU times, also when one of them is killed on the way.

Tried in it, and killed: shares that take each other's points, or leave out the last; a table written by the first share to end;
rows of other shares not read, or read with another fingerprint; a last line cut short that is believed; the lock left out; ranks not
read from the environment; SLURM_NTASKS taken for the size of a step; files of rows begun anew; lost workers of Dask not told from
results, or held against points that only waited there; workers that read another model; rows of Dask at other points.
"""

import csv
import importlib.util
import os
import pathlib
import shutil
import signal
import subprocess
import tempfile
import threading
import time

import pytest

import clusters
import mbd
from conftest import PENDULUM

LONG = PENDULUM.replace('duration="0.5"', 'duration="40"')
VARY = ["--vary", "W=1:30:1", "-Q", "tip.displacement.3", "hinge.angle@rms"]

needs_mpi = pytest.mark.skipif(shutil.which("mpirun") is None,
                               reason="openmpi-bin not installed (tools/install-dependencies --with-clusters)")
needs_slurm = pytest.mark.skipif(clusters.missing() is not None, reason=str(clusters.missing()))
needs_dask = pytest.mark.skipif(importlib.util.find_spec("distributed") is None,
                                reason="python3-distributed not installed (tools/install-dependencies --with-clusters)")


@pytest.fixture
def rod(tmp_path):
    """A model that fails at its first points, and is refused at the last."""
    file = tmp_path / "rod.xml"
    file.write_text(LONG.replace("<gravity", '<parameter name="F" value="sqrt(29.5-W)"/>'
                                 '<load at="arm" force="0 0 0.1*F/(t+10*W-45)"/> <gravity'))
    return file


def table(directory):
    """Comments, and rows without CPU times."""
    text = (directory / "sweep.csv").read_text().splitlines()
    rows = list(csv.reader(line for line in text if not line.startswith("#")))
    cpu = rows[0].index("cpu")
    return [line for line in text if line.startswith("#")], [row[:cpu] + row[cpu + 1:] for row in rows]


def command(rod, out, *more):
    return [os.environ["MBD_PROGRAM"], "sweep", str(rod), *VARY, "--out", str(out), *map(str, more)]


def rows_in(out):
    return sum(max(0, file.read_bytes().count(b"\n") - 2) for file in pathlib.Path(out).glob("sweep*.rows"))


def wait_until(true, process=None, seconds=600):
    """Against hanging only."""
    end = time.monotonic() + seconds
    while not true():
        assert process is None or process.poll() is None, "it ended before it was where the test wants it"
        assert time.monotonic() < end
        time.sleep(0.02)


@pytest.fixture
def serial(rod, tmp_path, program):
    program(*command(rod, tmp_path / "serial", "--jobs", 2)[1:], "-q")
    found = table(tmp_path / "serial")
    status = [row[found[1][0].index("status")] for row in found[1][1:]]
    assert len(status) == 30 and status[29] == "refused" and "failed" in status and status.count("done") > 20
    return found


# ---- shares -------------------------------------------------------------------------------------------------

def test_shares_give_the_table_of_one_process(rod, tmp_path, program, serial):
    out = tmp_path / "o"
    for share in ("3/3", "1/3"):
        said = program(*command(rod, out, "--share", share)[1:])
        assert "the last share to end writes the table" in said and not (out / "sweep.csv").exists()
    assert "written to" in program(*command(rod, out, "--share", "2/3")[1:])
    assert table(out) == serial
    # Again, in any cut, it is there already; and the last line of a share that was cut short is run again.
    for share in ("1/1", "2/3", "4/7"):
        (out / "sweep.csv").unlink()
        assert "(30 rows found" in program(*command(rod, out, "--share", share)[1:])
        assert table(out) == serial
    file = out / "sweep.2-of-3.rows"
    file.write_bytes(file.read_bytes()[:-4])
    (out / "sweep.csv").unlink()
    assert "(29 rows found" in program(*command(rod, out, "--share", "2/3")[1:])
    assert table(out) == serial
    # Rows of another model are not believed, whoever made them.
    rod.write_text(rod.read_text().replace("9.81", "1.62"))
    program(*command(rod, out, "--share", "1/3")[1:])
    assert rows_in(out) == 30 and table(out) == serial  # of the others, and the old table
    program(*command(rod, out, "--jobs", 2)[1:])
    assert table(out) != serial


def test_shares_side_by_side_one_killed(rod, tmp_path, serial):
    out = tmp_path / "o"
    both = [subprocess.Popen(command(rod, out, "--share", f"{i}/2", "-q", "--jobs", 1)) for i in (1, 2)]
    wait_until(lambda: rows_in(out) >= 4, both[0])
    both[0].kill()
    assert both[1].wait() == 0 and both[0].wait() == -signal.SIGKILL
    assert not (out / "sweep.csv").exists()
    kept = rows_in(out)
    assert 15 < kept + 1 < 30
    done = subprocess.run(command(rod, out, "--share", "1/2"), text=True, capture_output=True, check=True)
    assert f"({kept} rows found" in done.stdout and table(out) == serial


def test_one_share_is_run_once_at_a_time(rod, tmp_path):
    out = tmp_path / "o"
    first = subprocess.Popen(command(rod, out, "--share", "1/2", "-q", "--jobs", 1))
    try:
        wait_until(lambda: rows_in(out) >= 1, first)
        second = subprocess.run(command(rod, out, "--share", "1/2"), text=True, capture_output=True, check=False)
        assert second.returncode == 1 and "another sweep, or the same share of one, is at work here" in second.stderr
    finally:
        first.kill()
        first.wait()
    assert subprocess.run(command(rod, out, "--share", "1/2", "-q"), check=False).returncode == 0  # killed, it holds nothing


def test_shares_from_python(rod, tmp_path, serial):
    for number in (2, 1):
        s = mbd.sweep(rod, {"W": "1:30:1"}, quantity=["tip.displacement.3", "hinge.angle@rms"], jobs=2, share=f"{number}/2",
                      out=tmp_path / "o")
        assert s.status.count("open") == (15 if number == 2 else 0)
    assert table(tmp_path / "o")[1] == serial[1]
    with pytest.raises(TypeError):
        mbd.sweep(rod, {"W": [1]}, share="1/2")


def test_wrong_use(rod, tmp_path, program):
    out = tmp_path / "o"
    for share in ("3/2", "0/2", "1", "1/", "/2", "a/b", "-1/2", "1/2/3", "1/2000000", "1.5/2"):
        said = program(*command(rod, out, "--share", share)[1:], status=1)
        assert "is no share of a sweep; give I/N with I from 1 to N" in said
        with pytest.raises(mbd.ModelError, match="give I/N"):
            mbd.sweep(rod, {"W": [1]}, share=share, out=out)
    done = subprocess.run(command(rod, out, "--on", "sluurm"), text=True, capture_output=True, check=False)
    assert done.returncode >= 100 and "slurm" in done.stderr
    assert "leave out --share" in program(*command(rod, out, "--on", "slurm", "--share", "1/2")[1:], status=1)
    assert "are of --on slurm" in program(*command(rod, out, "--tasks", "3")[1:], status=1)
    nowhere = tmp_path / "bin"
    nowhere.mkdir()
    environment = dict(os.environ, PATH=str(nowhere))
    done = subprocess.run(command(rod, out, "--on", "slurm"), env=environment, text=True, capture_output=True, check=False)
    assert done.returncode == 1 and "there is no sbatch on PATH" in done.stderr
    (nowhere / "sbatch").write_text("#!/bin/sh\necho 'invalid partition specified: fast' >&2; exit 1\n")
    (nowhere / "sbatch").chmod(0o755)
    done = subprocess.run(command(rod, out, "--on", "slurm"), env=environment, text=True, capture_output=True, check=False)
    assert done.returncode == 1 and "sbatch refused: invalid partition specified: fast" in done.stderr


def test_wrong_use_of_slurm_from_python(rod, tmp_path, monkeypatch):
    out = tmp_path / "o"
    for given, kind in (({"on": "sluurm"}, mbd.UseError), ({"on": 3}, mbd.UseError), ({"on": "slurm", "out": None}, TypeError),
                        ({"on": "slurm", "share": "1/2"}, TypeError), ({"on": "slurm", "client": object()}, TypeError),
                        ({"on": "slurm", "tasks": 0}, mbd.UseError), ({"on": "slurm", "tasks": float("nan")}, ValueError),
                        ({"on": "slurm", "tasks": "many"}, TypeError), ({"on": "slurm", "jobs": 0}, mbd.UseError),
                        ({"tasks": 3}, TypeError), ({"wait": False}, TypeError),
                        ({"sbatch": ["--time=9"]}, TypeError), ({"on": "slurm", "sbatch": 3}, TypeError)):
        with pytest.raises(kind):
            mbd.sweep(rod, {"W": [1]}, **{"out": out, **given})
    nowhere = tmp_path / "bin"
    nowhere.mkdir()
    monkeypatch.setenv("PATH", str(nowhere))
    with pytest.raises(mbd.UseError, match="there is no sbatch on PATH"):
        mbd.sweep(rod, {"W": [1]}, on="slurm", out=out)
    (nowhere / "sbatch").write_text("#!/bin/sh\necho 'invalid partition specified: fast' >&2; exit 1\n")
    (nowhere / "sbatch").chmod(0o755)
    with pytest.raises(mbd.UseError, match="sbatch refused: invalid partition specified: fast"):
        mbd.sweep(rod, {"W": [1]}, on="slurm", out=out)
    with pytest.raises(mbd.Error, match="tup"):
        mbd.sweep(rod, {"W": [1]}, quantity="tup", on="slurm", out=tmp_path / "p")


def test_what_launchers_say(rod, tmp_path):
    """Ranks of launchers that may not be here, and variables that make none."""
    def run(**variables):
        done = subprocess.run(command(rod, tmp_path / "o"), env={**os.environ, **variables}, text=True, capture_output=True,
                              check=False)
        return done.stdout + done.stderr
    assert "share 2/3" in run(OMPI_COMM_WORLD_RANK="1", OMPI_COMM_WORLD_SIZE="3")
    assert "share 3/3" in run(PMI_RANK="2", PMI_SIZE="3")
    assert "share 1/3" in run(SLURM_PROCID="0", SLURM_STEP_NUM_TASKS="3")
    for alone in ({"SLURM_PROCID": "0", "SLURM_NTASKS": "3"}, {"PMI_RANK": "0", "PMI_SIZE": "1"}, {"PMI_RANK": "1"}):
        assert "share" not in run(**alone)
    assert "is no number; unset it" in run(PMI_RANK="x", PMI_SIZE="2")
    assert "ranks count from 0" in run(PMI_RANK="2", PMI_SIZE="2")


# ---- MPI ----------------------------------------------------------------------------------------------------

def mpirun(rod, out):
    # A directory of its own: one that has just been killed may still be clearing the one that all share.
    session = tempfile.mkdtemp(prefix="mpi-", dir=out.parent)
    return ["mpirun", "-n", "2", "--oversubscribe", "--mca", "orte_tmpdir_base", session, *command(rod, out)]


MPI = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")


@needs_mpi
def test_ranks_of_mpi(rod, tmp_path, serial):
    out = tmp_path / "o"
    done = subprocess.run(mpirun(rod, out), env=MPI, text=True, capture_output=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "share 1/2" in done.stdout and "share 2/2" in done.stdout and done.stdout.count("written to") >= 1
    assert table(out) == serial and {file.name for file in out.iterdir()} == {
        "sweep.csv", "sweep.1-of-2.rows", "sweep.2-of-2.rows"}


@needs_mpi
def test_a_rank_of_mpi_is_killed(rod, tmp_path, serial):
    out = tmp_path / "o"
    running = subprocess.Popen(mpirun(rod, out), env=MPI, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    wait_until(lambda: rows_in(out) >= 4, running)
    ranks = subprocess.run(["pgrep", "-P", str(running.pid)], text=True, capture_output=True, check=True).stdout.split()
    os.kill(int(ranks[-1]), signal.SIGKILL)
    assert running.wait() != 0
    assert not (out / "sweep.csv").exists()
    kept = rows_in(out)
    assert 4 <= kept < 30
    done = subprocess.run(mpirun(rod, out), env=MPI, text=True, capture_output=True, check=True)
    assert f"({kept} rows found" in done.stdout and table(out) == serial


# ---- Slurm --------------------------------------------------------------------------------------------------

@pytest.fixture(scope="module")
def slurm(tmp_path_factory):
    with clusters.Slurm(tmp_path_factory.mktemp("slurm")) as one:
        yield one


@needs_slurm
def test_tasks_of_slurm(rod, tmp_path, serial, slurm):
    out = tmp_path / "o"
    done = subprocess.run(command(rod, out, "--on", "slurm", "--tasks", 3), env=slurm.environment, text=True,
                          capture_output=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "of Slurm: 3 tasks" in done.stdout and "written to" in done.stdout
    assert table(out) == serial
    assert {file.name for file in out.glob("*.rows")} == {"sweep.rows", *(f"sweep.{i}-of-3.rows" for i in (1, 2, 3))}
    # All is there: nothing is submitted.
    again = subprocess.run(command(rod, out, "--on", "slurm", "--tasks", 3), env=slurm.environment, text=True,
                           capture_output=True, check=True)
    assert "of Slurm" not in again.stdout and "(30 rows found" in again.stdout and table(out) == serial


@needs_slurm
def test_nobody_waits_for_slurm(rod, tmp_path, serial, slurm):
    out = tmp_path / "o"
    done = subprocess.run(command(rod, out, "--on", "slurm", "--tasks", 2, "--no-wait"), env=slurm.environment, text=True,
                          capture_output=True, check=True)
    assert "the last of them writes the table" in done.stdout
    wait_until(lambda: (out / "sweep.csv").exists())
    assert table(out) == serial


def sweep_of(share):
    """Processes of this share, the oldest first."""
    return [int(pid) for pid in subprocess.run(["pgrep", "-f", f"mbd sweep .*--share {share}"], text=True, capture_output=True,
                                               check=False).stdout.split()]


@needs_slurm
def test_a_task_of_slurm_is_killed(rod, tmp_path, serial, slurm):
    out = tmp_path / "o"
    running = subprocess.Popen(command(rod, out, "--on", "slurm", "--tasks", 2), env=slurm.environment, text=True,
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    first = out / "sweep.1-of-2.rows"
    wait_until(lambda: first.exists() and first.read_bytes().count(b"\n") >= 5, running)
    os.kill(sweep_of("1/2")[0], signal.SIGKILL)
    said = running.communicate()
    assert running.returncode == 1 and "points have no row: their tasks ended early (1 COMPLETED, 1 FAILED)" in said[1], said
    kept = rows_in(out)
    assert 15 < kept < 30
    done = subprocess.run(command(rod, out, "--on", "slurm", "--tasks", 2), env=slurm.environment, text=True,
                          capture_output=True, check=False)
    assert done.returncode == 0 and "of Slurm: 1 tasks" in done.stdout and f"({kept} rows found" in done.stdout, done
    assert table(out) == serial


@needs_slurm
def test_a_task_that_slurm_begins_again_goes_on(rod, tmp_path, serial, slurm):
    out = tmp_path / "o"
    running = subprocess.Popen(command(rod, out, "--on", "slurm", "--tasks", 2), env=slurm.environment, text=True,
                               stdout=subprocess.PIPE)
    first = out / "sweep.1-of-2.rows"
    wait_until(lambda: first.exists() and first.read_bytes().count(b"\n") >= 5, running)
    job = running.stdout.readline().split()[1]
    before = first.read_bytes()
    slurm.ask("scontrol", "requeue", f"{job}_1")
    wait_until(lambda: not sweep_of("1/2"))
    # A task that is begun again waits for two minutes, unless somebody says that it need not. Not in the second in which it
    # was killed: slurmd would take the new one for that ("already killed, do not launch").
    while running.poll() is None:
        time.sleep(3)
        slurm.ask("scontrol", "update", f"JobId={job}_1", "StartTime=now")
    assert running.returncode == 0 and table(out) == serial
    after = first.read_bytes()
    assert after.startswith(before) and after.count(b"\n") == 17  # no point twice


@needs_slurm
def test_ctrl_c_ends_the_job(rod, tmp_path, slurm):
    out = tmp_path / "o"
    rod.write_text(rod.read_text().replace('duration="40"', 'duration="4000"'))
    running = subprocess.Popen(command(rod, out, "--on", "slurm", "--tasks", 2), env=slurm.environment, text=True,
                               stdout=subprocess.PIPE)
    job = running.stdout.readline().split()[1]
    wait_until(lambda: "R" in slurm.ask("squeue", "-h", "-j", job, "-o", "%t").split(), running)
    running.send_signal(signal.SIGINT)
    assert running.wait() == 130
    wait_until(lambda: slurm.ask("squeue", "-h", "-j", job, "-o", "%T") == "" and not sweep_of("[12]/2"))


@pytest.fixture
def slurm_here(slurm, monkeypatch):
    """For sbatch and its like that this process starts."""
    monkeypatch.setenv("SLURM_CONF", slurm.environment["SLURM_CONF"])
    return slurm


def on_slurm(model, out, **more):
    return mbd.sweep(model, {"W": "1:30:1"}, quantity=["tip.displacement.3", "hinge.angle@rms"], on="slurm", out=out, **more)


def jobs_of(slurm):
    """Those that wait or run, and for a moment those that have ended: what was here before may go at any time."""
    return set(slurm.ask("squeue", "-h", "-o", "%A").split())


@needs_slurm
def test_slurm_from_python(rod, tmp_path, serial, slurm_here, monkeypatch):
    monkeypatch.chdir(tmp_path)  # tasks begin wherever they do: names are those of here
    seen = []
    s = on_slurm(rod.name, "o", tasks=3, progress=lambda done, all: seen.append((done, all)))
    out = tmp_path / "o"
    assert table(out)[1] == serial[1] and s.found == 0
    assert {file.name for file in out.glob("*.rows")} == {"sweep.rows", *(f"sweep.{i}-of-3.rows" for i in (1, 2, 3))}
    assert seen[-1] == (30, 30) and seen == sorted(seen)
    # All is there: nothing is submitted, in any cut.
    before = jobs_of(slurm_here)
    again = on_slurm(rod, out, tasks=4)
    assert again.found == 30 and again.values.tobytes() == s.values.tobytes() and jobs_of(slurm_here) <= before
    # Models that are no files, and values of parameters, are sent along; options are sbatch's.
    text = mbd.Model(text=PENDULUM, set={"L": "500 mm"})
    there = mbd.sweep(text, points=[{"W": 1}, {"W": "2"}], quantity="tip", on="slurm", out=tmp_path / "text", jobs=2,
                      sbatch=["--comment=here is one", "--time=9"])
    assert there.values.tobytes() == mbd.sweep(text, {"W": [1, 2]}, quantity="tip", jobs=1).values.tobytes()


@needs_slurm
def test_python_does_not_wait_for_slurm(rod, tmp_path, serial, slurm_here):
    s = on_slurm(rod, tmp_path / "o", tasks=2, wait=False)
    assert "open" in s.status
    wait_until(lambda: (tmp_path / "o" / "sweep.csv").exists())
    assert table(tmp_path / "o")[1] == serial[1]


@needs_slurm
def test_a_task_of_python_on_slurm_is_killed(rod, tmp_path, serial, slurm_here):
    out = tmp_path / "o"
    first = out / "sweep.1-of-2.rows"
    killed = []

    def kill():  # progress is told once a second only: a quick task may begin and end between
        wait_until(lambda: first.exists() and first.read_bytes().count(b"\n") >= 4)
        killed.append(task_of_python(out, "1/2"))
        os.kill(killed[0], signal.SIGKILL)

    rod.write_text(rod.read_text().replace('duration="40"', 'duration="120"'))  # it is there when it is looked for
    killer = threading.Thread(target=kill)
    killer.start()
    with pytest.raises(mbd.RunError, match=r"their tasks of Slurm ended early \(1 COMPLETED, 1 FAILED\)") as caught:
        on_slurm(rod, out, tasks=2)
    killer.join()
    assert killed and 0 < caught.value.results.status.count("open") < 15
    s = on_slurm(rod, out, tasks=2)
    assert s.found == 30 - caught.value.results.status.count("open")
    assert s.status == mbd.sweep(rod, {"W": "1:30:1"}, quantity="tip", jobs=2).status


def task_of_python(out, share):
    """The oldest process of a share of a sweep of Python, or None."""
    found = subprocess.run(["pgrep", "-o", "-f", f"_task.*{out}/.* --share {share}"], text=True, capture_output=True, check=False)
    return int(found.stdout) if found.stdout else None


@needs_slurm
def test_ctrl_c_in_python_ends_the_job(rod, tmp_path, slurm_here):
    rod.write_text(rod.read_text().replace('duration="40"', 'duration="4000"'))
    out, before = tmp_path / "o", jobs_of(slurm_here)

    def interrupt(done, all):
        if task_of_python(out, "1/2"):
            os.kill(os.getpid(), signal.SIGINT)

    with pytest.raises(mbd.Interrupted) as caught:
        on_slurm(rod, out, tasks=2, progress=interrupt)
    assert caught.value.results.status.count("open") > 20 and (out / "sweep.csv").exists()
    wait_until(lambda: jobs_of(slurm_here) <= before and not task_of_python(out, "[12]/2"))


@needs_slurm
def test_ranks_of_srun(rod, tmp_path, serial, slurm):
    out = tmp_path / "o"
    done = subprocess.run(["srun", "-n", "2", *command(rod, out)], env=slurm.environment, text=True, capture_output=True,
                          check=False)
    assert done.returncode == 0, done.stderr
    assert "share 1/2" in done.stdout and "share 2/2" in done.stdout and table(out) == serial


# ---- Dask ---------------------------------------------------------------------------------------------------

@pytest.fixture
def client(tmp_path):
    (tmp_path / "dask").mkdir()
    with clusters.Dask(tmp_path / "dask") as dask, dask.client() as one:
        yield one


def on_dask(rod, client, out, **more):
    return mbd.sweep(rod, {"W": "1:30:1"}, quantity=["tip.displacement.3", "hinge.angle@rms"], client=client, out=out, **more)


@needs_dask
def test_workers_of_dask(rod, tmp_path, serial, client):
    seen = []
    s = on_dask(rod, client, tmp_path / "o", progress=lambda done, all: seen.append((done, all)))
    assert table(tmp_path / "o")[1] == serial[1] and seen == [(k, 30) for k in range(1, 31)]
    assert s.found == 0 and on_dask(rod, client, tmp_path / "o").found == 30
    # Models that are no files, and values of parameters, are sent along.
    text = mbd.Model(text=PENDULUM, set={"L": "500 mm"})
    here, there = (mbd.sweep(text, {"W": [1, 2]}, quantity="tip", **how) for how in ({"jobs": 1}, {"client": client}))
    assert here.values.tobytes() == there.values.tobytes()


@needs_dask
def test_a_worker_of_dask_is_killed(rod, tmp_path, serial, client):
    def kill(done, _):
        if done == 5:
            os.kill(sorted(client.run(os.getpid).values())[0], signal.SIGKILL)

    s = on_dask(rod, client, tmp_path / "o", progress=kill)
    assert table(tmp_path / "o")[1] == serial[1] and s.status.count("lost") == 0


@needs_dask
def test_points_that_kill_workers_are_lost(rod, tmp_path, client):
    # A library that ends the worker at one point.
    def arm():
        import os
        from mbd import _mbd
        run = _mbd.run_point
        _mbd.run_point = lambda model, values, columns: os._exit(1) if dict(values)["W"] == "7" else run(model, values, columns)
    client.register_worker_callbacks(arm)  # of those that are there, and of those that come
    client.run_on_scheduler(lambda dask_scheduler: setattr(dask_scheduler, "allowed_failures", 1))
    # Points that wait where it dies are none of those.
    s = mbd.sweep(rod, {"W": "5:16:1"}, quantity="tip", client=client, out=tmp_path / "o")
    assert s.status == ["done"] * 2 + ["lost"] + ["done"] * 9 and "workers that ran it died" in s.messages[2]
    again = mbd.sweep(rod, {"W": "5:16:1"}, quantity="tip", jobs=1, out=tmp_path / "o")
    assert again.found == 11 and again.status == ["done"] * 12


@needs_dask
def test_wrong_use_of_dask(rod, tmp_path, client):
    with pytest.raises(TypeError, match="no dask.distributed.Client"):
        mbd.sweep(rod, {"W": [1]}, client="tcp://127.0.0.1:1")
    for given in ({"jobs": 2}, {"share": "1/2", "out": tmp_path / "o"}):
        with pytest.raises(TypeError, match="client"):
            mbd.sweep(rod, {"W": [1]}, client=client, **given)
    # Workers that see another model.
    def other():
        from mbd import sweeps
        digest = sweeps._digest
        sweeps._digest = lambda model: digest(model) + "other"
    client.run(other)
    with pytest.raises(mbd.UseError, match="is not the same on a worker as here"):
        mbd.sweep(rod, {"W": [1]}, client=client)


@needs_dask
def test_clients_without_workers_or_workers_without_mbd(rod, tmp_path):
    for name in ("none", "bare"):
        (tmp_path / name).mkdir()
    with clusters.Dask(tmp_path / "none", workers=0) as dask, dask.client() as client:
        with pytest.raises(mbd.UseError, match="has no workers; start one"):
            mbd.sweep(rod, {"W": [1]}, client=client)
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    with clusters.Dask(tmp_path / "bare", workers=1, environment=environment) as dask, dask.client() as client:
        with pytest.raises(mbd.UseError, match="a worker has no mbd"):
            mbd.sweep(rod, {"W": [1]}, client=client)
