"""A sweep of 200 runs of the shaft over its speed uses every processor, is interrupted, and goes on.

Tried in it, and killed: one job by default; rows that are kept only at the end; a sweep that begins anew.
"""

import csv
import os
import pathlib
import signal
import subprocess
import time

import mbd
from conftest import ROOT

SHAFT = ROOT / "models" / "shaft.xml"


def children(pid):
    """Processes of a process that are there now."""
    return pathlib.Path(f"/proc/{pid}/task/{pid}/children").read_text().split()


def test_two_hundred_speeds(tmp_path):
    out = tmp_path / "o"
    command = [os.environ["MBD_PROGRAM"], "sweep", str(SHAFT), "--vary", "omega=30:69.8:0.2", "-Q", "M.displacement@largest",
               "--out", str(out)]
    processors = len(os.sched_getaffinity(0))
    for _ in range(2):  # interrupted twice
        before = (out / "sweep.rows").read_bytes().count(b"\n") - 2 if out.exists() else 0
        running = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        most, kept = 0, 0
        while kept < before + 40:
            assert running.poll() is None, "it ended before it was interrupted"
            most = max(most, len(children(running.pid)))
            time.sleep(0.01)
            if (out / "sweep.rows").exists():
                kept = (out / "sweep.rows").read_bytes().count(b"\n") - 2
        running.send_signal(signal.SIGINT)
        said = running.communicate()[0]
        assert running.returncode == 130 and "the same command goes on from here" in said
        assert most == processors
    done = subprocess.run(command, text=True, capture_output=True, check=True)
    found = int(done.stdout.split("rows found")[0].split("(")[-1])
    assert 80 <= found < 200 and "200 points, 200 done" in done.stdout
    rows = list(csv.DictReader(line for line in (out / "sweep.csv").read_text().splitlines() if not line.startswith("#")))
    assert [row["point"] for row in rows] == [str(k) for k in range(1, 201)]
    for k in (0, 37, 119, 199):  # of each part
        run = mbd.Model(SHAFT, set={"omega": rows[k]["omega"]}).run(estimate_error=False)
        assert float(rows[k]["M.displacement.3@largest"]) == abs(run["M.displacement.3"]).max()


def test_processors_that_it_may_not_use(tmp_path):
    """As taskset, a container or Slurm has it. Tried in it, and killed: all that there are."""
    one = min(os.sched_getaffinity(0))
    command = [os.environ["MBD_PROGRAM"], "sweep", str(SHAFT), "--vary", "omega=30:69:3", "-Q", "M.displacement@largest",
               "--out", str(tmp_path / "o")]
    running = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, preexec_fn=lambda: os.sched_setaffinity(0, {one}))
    most = 0
    while running.poll() is None:
        most = max(most, len(children(running.pid)))
        time.sleep(0.01)
    running.communicate()
    assert running.returncode == 0
    assert most == 1
