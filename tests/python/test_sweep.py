"""Sweeps from Python and on the command line: values of single runs, failures as rows, going on after Ctrl-C and kill -9."""

import csv
import os
import signal
import subprocess
import time

import numpy
import pytest

import mbd
from conftest import PENDULUM, same_bits


@pytest.fixture
def rod(tmp_path):
    file = tmp_path / "rod.xml"
    file.write_text(PENDULUM)
    return file


def rows_of(directory):
    text = (directory / "sweep.csv").read_text()
    return list(csv.DictReader(line for line in text.splitlines() if not line.startswith("#")))


def test_values_are_those_of_runs(rod):
    s = mbd.sweep(rod, {"L": ["500 mm", "1 m"], "W": [1, 2, 4]}, jobs=2,
                  quantity=["tip.displacement.3", "tip.velocity.3@minimum", "hinge.angle@rms"])
    assert len(s) == 6 and s.status == ["done"] * 6 and s.points[1] == ["500 mm", "2"]
    assert s.columns == ["tip.displacement.3", "tip.velocity.3@minimum", "hinge.angle@rms"]
    for k, (L, m) in enumerate(s.points):
        r = mbd.Model(rod, set={"L": L, "W": m}).run(estimate_error=False)
        assert s.values[k, 0] == r["tip.displacement.3"][-1]
        assert s.values[k, 1] == r["tip.velocity.3"].min()
        assert s.values[k, 2] == pytest.approx(numpy.sqrt((r["hinge.angle"] ** 2).mean()), rel=1e-14)
    assert s.units["tip.velocity.3@minimum"] == "m/s" and same_bits(s["W"], [1, 2, 4, 1, 2, 4])
    pandas = pytest.importorskip("pandas")
    assert isinstance(s.frame(), pandas.DataFrame) and s.frame().shape == (6, 9)
    with pytest.raises(mbd.UnknownName):
        s["tip"]


def test_the_command_gives_the_same_table(rod, program, tmp_path):
    program("sweep", rod, "--vary", "W=1:3:1", "L=500:1000:250 mm", "--quantity", "tip", "--out", tmp_path / "a", "-q")
    s = mbd.sweep(rod, {"W": "1:3:1", "L": "500:1000:250 mm"}, quantity="tip", out=tmp_path / "b", jobs=1)
    ours, theirs = rows_of(tmp_path / "b"), rows_of(tmp_path / "a")
    assert len(ours) == 9 and [r["L"] for r in ours[:3]] == ["500", "750", "1000"]
    for a, b in zip(ours, theirs):
        assert {k: v for k, v in a.items() if k != "cpu"} == {k: v for k, v in b.items() if k != "cpu"}
    assert "# units: 1, 1, mm, -, m, m, m" in (tmp_path / "a" / "sweep.csv").read_text()
    assert same_bits(s["tip.displacement.1"], [float(r["tip.displacement.1"]) for r in theirs])


def test_failures_are_rows(rod):
    text = PENDULUM.replace("<gravity", '<load at="arm" force="0 0 1/(t-W)"/> <gravity')
    s = mbd.sweep(mbd.Model(text=text), {"W": [2, 0.25, -1, 3]}, quantity="tip.displacement.3", jobs=2)
    assert s.status == ["done", "failed", "refused", "done"]
    assert numpy.isnan(s["tip.displacement.3"]).tolist() == [False, True, True, False]
    assert 0.2 < s.t[1] <= 0.25 and "mass" in s.messages[2] and s.messages[0] == ""


def test_latin_hypercube(rod, program, tmp_path):
    plan = {"W": (1, 5), "L": "500:1000 mm"}
    s = mbd.sweep(rod, plan, latin=20, seed=3, quantity="tip.displacement.3")
    for name, low, high in [("W", 1, 5), ("L", 500, 1000)]:
        parts = numpy.floor((s[name] - low) / (high - low) * 20).astype(int)
        assert sorted(parts) == list(range(20))  # one in each part
    again = mbd.sweep(rod, plan, latin=20, seed=3, quantity="tip.displacement.3")
    other = mbd.sweep(rod, plan, latin=20, seed=4, quantity="tip.displacement.3")
    assert again.points == s.points and other.points != s.points
    assert abs(numpy.corrcoef(s["W"], s["L"])[0, 1]) < 0.9
    program("sweep", rod, "--vary", "W=1:5", "L=500:1000 mm", "--latin", 20, "--seed", 3, "--out", tmp_path / "o", "-q")
    assert [r["W"] for r in rows_of(tmp_path / "o")] == [p[0] for p in s.points]


def test_points_of_a_file(rod, program, tmp_path):
    points = tmp_path / "points.csv"
    points.write_text("# chosen\nW,L\n1,1 m\n2,500 mm\n")
    s = mbd.sweep(rod, points=points, quantity="tip.displacement.3")
    assert s.points == [["1", "1 m"], ["2", "500 mm"]]
    same = mbd.sweep(rod, points=[{"W": 1, "L": "1 m"}, {"W": 2, "L": "500 mm"}], quantity="tip.displacement.3")
    assert same_bits(same.values, s.values)
    program("sweep", rod, "--points", points, "--out", tmp_path / "o", "-q")
    assert [r["status"] for r in rows_of(tmp_path / "o")] == ["done", "done"]
    points.write_text("\ufeffW,L\n1,1 m\n", encoding="utf-8")  # as spreadsheets write it
    assert same_bits(mbd.sweep(rod, points=points, quantity="tip.displacement.3").values[0], s.values[0])
    points.write_text("W,L\n1\n")
    with pytest.raises(mbd.ModelError, match="points.csv:2") as caught:
        mbd.sweep(rod, points=points)
    assert caught.value.line == 2


def test_goes_on(rod, tmp_path):
    out = tmp_path / "o"
    a = mbd.sweep(rod, {"W": range(1, 6)}, quantity="tip", out=out)
    assert a.found == 0
    b = mbd.sweep(rod, {"W": range(1, 9)}, quantity="tip", out=out)  # and more points
    assert b.found == 5 and same_bits(b.values[:5], a.values)
    # A row that is cut short is run again; another model, other quantities: nothing is believed.
    rows = (out / "sweep.rows").read_bytes()
    (out / "sweep.rows").write_bytes(rows[:-7])
    assert mbd.sweep(rod, {"W": range(1, 9)}, quantity="tip", out=out).found == 7
    assert mbd.sweep(rod, {"W": range(1, 9)}, quantity="hinge", out=out).found == 0
    mbd.sweep(rod, {"W": [1]}, quantity="tip", out=out)
    rod.write_text(PENDULUM.replace("9.81", "1.62"))
    c = mbd.sweep(rod, {"W": [1]}, quantity="tip", out=out)
    assert c.found == 0 and not same_bits(c.values, a.values[:1])


@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGINT])
def test_killed_and_gone_on(rod, tmp_path, how):
    rod.write_text(PENDULUM.replace('duration="0.5"', 'duration="5"'))
    out = tmp_path / "o"
    command = [os.environ["MBD_PROGRAM"], "sweep", str(rod), "--vary", "W=1:60:1", "-Q", "tip.displacement.3", "--jobs", "2",
               "--out", str(out)]
    running = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    kept = 0
    while kept < 5 and running.poll() is None:
        time.sleep(0.02)
        if (out / "sweep.rows").exists():
            kept = (out / "sweep.rows").read_bytes().count(b"\n") - 2
    assert running.poll() is None, "it was too quick to be killed"
    running.send_signal(how)
    running.wait()
    assert running.returncode == (-9 if how == signal.SIGKILL else 130)
    done = subprocess.run(command, text=True, capture_output=True, check=True)
    found = int(done.stdout.split("rows found")[0].split("(")[-1])
    assert 5 <= found < 60
    whole = mbd.sweep(rod, {"W": "1:60:1"}, quantity="tip.displacement.3")
    assert [float(r["tip.displacement.3"]) for r in rows_of(out)] == list(whole["tip.displacement.3"])
    # No process is left.
    left = subprocess.run(["pgrep", "-f", f"mbd sweep {rod}"], text=True, capture_output=True, check=False)
    assert left.stdout == ""


def test_lost_processes_are_rows_and_tried_again(rod, tmp_path):
    rod.write_text(PENDULUM.replace('duration="0.5"', 'duration="200"'))
    out = tmp_path / "o"
    command = [os.environ["MBD_PROGRAM"], "sweep", str(rod), "--vary", "W=1,2", "-Q", "tip.displacement.3", "--jobs", "1",
               "--out", str(out)]
    running = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    child = ""
    while not child and running.poll() is None:
        time.sleep(0.02)
        child = subprocess.run(["pgrep", "-P", str(running.pid)], text=True, capture_output=True, check=False).stdout
    os.kill(int(child.split()[0]), signal.SIGKILL)
    while running.poll() is None and (out / "sweep.rows").read_bytes().count(b"\n") < 3:
        time.sleep(0.02)
    running.send_signal(signal.SIGINT)
    running.wait()
    rows = rows_of(out)
    assert [r["status"] for r in rows] == ["lost", "open"] and "signal 9" in rows[0]["message"]
    rod.write_text(PENDULUM)


def test_wrong_use(rod, program):
    for vary in ("m", "W=", "W=1:2", "W=1:2:-1", "W=1:2:0", "W=1:x:1", "W=1,,2", "1m=2", "W=1,1", "V=1:2:1"):
        assert "mbd: " in program("sweep", rod, "--vary", vary, "--out", rod.parent / "o", status=1), vary
    assert "did you mean" in program("sweep", rod, "--vary", "W=1", "-Q", "tip.displacment", "--out", rod.parent / "o", status=1)
    assert "none of end" in program("sweep", rod, "--vary", "W=1", "-Q", "tip@most", "--out", rod.parent / "o", status=1)
    for given in ({"vary": {"W": []}}, {"vary": {"W": [float("nan")]}}, {"vary": {"W": [1]}, "jobs": 0},
                  {"vary": {"W": (1, 2, 3)}, "latin": 3}, {"vary": {"W": [1]}, "quantity": "nothing"},
                  {"points": [{"W": 1}, {"L": 2}]}, {"vary": {"nothing": [1]}}):
        with pytest.raises(mbd.Error):
            mbd.sweep(rod, **given)
    for given in ({}, {"vary": {"W": [1]}, "points": "p.csv"}):
        with pytest.raises(TypeError):
            mbd.sweep(rod, **given)
