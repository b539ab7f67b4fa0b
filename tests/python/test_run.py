"""Runs from Python: the same bits as `mbd run`, arrays that are no copies, reports, pictures, interruption."""

import json
import os
import signal
import subprocess
import sys
import textwrap

import numpy
import pytest

import mbd
from conftest import PENDULUM, same_bits

# Bodies, joints, beams; generalized-alpha, Radau and IDA; fixed and adaptive steps; statics and a path.
CASES = [
    ("pendulum", {}, {}), ("heavy_top", {}, {}), ("double_pendulum", {}, {}), ("damped_oscillator", {}, {}),
    ("torsion_pendulum", {}, {}), ("chain", {"N": 3}, {}), ("rigid_frame", {}, {}), ("free_beam", {}, {}),
    ("double_pendulum", {}, {"method": "ida", "tolerance": "1e-6"}),
    ("four_bar", {}, {}), ("bend45", {}, {}), ("elastica", {}, {}), ("shallow_arch", {}, {}),
]


@pytest.mark.parametrize("name, set, given", CASES)
def test_same_bits_as_the_program(name, set, given, models, tmp_path):
    flags = [f"--set={key}={value}" for key, value in set.items()] + [f"--{key}={value}" for key, value in given.items()]
    # Its status may be 2: other settings than those whose numbers the model expects.
    subprocess.run([os.environ["MBD_PROGRAM"], "run", str(models / f"{name}.xml"), "--out", str(tmp_path), "--quiet",
                    *flags], check=False, capture_output=True)
    ours = mbd.Model(models / f"{name}.xml", set=set).run(**given)
    theirs = mbd.read(tmp_path)
    assert ours.columns == theirs.columns
    assert len(ours) > 1
    assert same_bits(ours.values, theirs.values)
    table = tmp_path / ("path.csv" if name == "shallow_arch" else "history.csv")
    lines = [line for line in table.read_text().splitlines() if line and not line.startswith("#")]
    assert same_bits(ours.values, [[float(cell) for cell in line.split(",")] for line in lines[1:]])
    assert ours.report["solver"] == json.loads((tmp_path / "report.json").read_text())["solver"]


def test_other_settings_are_not_the_same_bits(models):
    m = mbd.Model(models / "pendulum.xml")
    assert not same_bits(m.run().values[-1], m.run(method="radau", tolerance=1e-9).values[-1])


def test_arrays_are_views(pendulum):
    r = pendulum.run()
    whole, tip, one = r.values, r["tip.displacement"], r["tip.displacement.3"]
    assert tip.shape == (501, 3) and one.shape == (501,) and r["tip"].shape == (501, 6)
    first = whole.__array_interface__["data"][0]
    at = r.columns.index("tip.displacement.1")
    assert tip.__array_interface__["data"][0] == first + 8 * at
    assert one.__array_interface__["data"][0] == first + 8 * (at + 2)
    assert numpy.shares_memory(whole, tip) and numpy.shares_memory(tip, one)
    with pytest.raises(ValueError):
        tip[0, 0] = 1.0
    del r, whole, one
    assert tip[-1, 2] < 0.0  # the rows live as long as a view of them


def test_closed_form(pendulum):
    """A rigid pendulum let go at the horizontal: energy m g L sin = J w^2 / 2 about the hinge, J = 0.1 + m L^2."""
    r = pendulum.run(method="radau", tolerance=1e-11)
    L, m, g = 1.0, 2.0, 9.81
    x, z = L + r["tip.displacement.1"], r["tip.displacement.3"]
    speed2 = (r["tip.velocity"] ** 2).sum(axis=1)
    assert numpy.abs(x ** 2 + z ** 2 - L ** 2).max() < 1e-12
    # Largest difference over all rows, of the largest energy.
    energy = 0.5 * (0.1 + m * L ** 2) * speed2 / L ** 2
    assert numpy.abs(energy + m * g * z).max() < 1e-8 * energy.max()
    assert r.units["tip.displacement"] == "m" and r.units["tip.velocity.1"] == "m/s" and r.units["hinge.angle"] == "rad"
    assert r.time[-1] == pytest.approx(0.5) and r.columns[0] == "time"


def test_units_of_parameters(pendulum):
    m = mbd.Model(text=PENDULUM, set={"L": "500 mm", "W": numpy.float64(3)})
    assert m.parameters == {"W": 3.0, "L": 0.5}
    assert pendulum.parameters == {"W": 2.0, "L": 1.0}


def test_report_frame_and_pictures(pendulum, tmp_path):
    r = pendulum.run(motion=True, frames=20)
    assert r.report["counts"]["nodes"] == 2 and r.certificate["verdict"] in ("pass", "warn")
    assert r.complete and r.as_expected and r.failure == ""
    pandas = pytest.importorskip("pandas")
    frame = r.frame()
    assert list(frame.columns) == r.columns[1:] and frame.index.name == "time"
    assert same_bits(frame["tip.velocity.3"].to_numpy(), r["tip.velocity.3"])
    assert isinstance(frame, pandas.DataFrame)
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    axes = r.plot("tip", "hinge.angle")
    assert len(axes) == 3  # m, m/s, rad
    line = axes[0].lines[2]
    assert line.get_label() == "tip.displacement.3" and same_bits(line.get_ydata(), r["tip.displacement.3"])
    if mbd.has_pages:
        page = r.view(frames=10)
        assert "<html" in page.html and "iframe" in page._repr_html_()
        page.save(tmp_path / "page.html")
        assert (tmp_path / "page.html").read_text(encoding="utf-8") == page.html
        assert "<html" in pendulum.view().html
    with pytest.raises(mbd.UseError, match="motion=True"):
        pendulum.run().view()


def test_what_is_written(pendulum, tmp_path):
    r = pendulum.run(out=tmp_path / "there")
    assert sorted(os.listdir(tmp_path / "there")) == ["history.csv", "history.svg", "report.json"]
    assert same_bits(mbd.read(tmp_path / "there").values, r.values)
    os.chdir(tmp_path)
    pendulum.run()
    assert os.listdir(tmp_path) == ["there"]


def test_progress(models):
    seen = []
    m = mbd.Model(models / "heavy_top.xml", set={"step": "1e-5"})
    m.run(progress=lambda t, duration, step: seen.append((t, duration, step)), estimate_error=False)
    assert seen and seen[-1][0] == pytest.approx(seen[-1][1]) and seen == sorted(seen)

    def stop(t, duration, step):
        raise KeyError("enough")

    with pytest.raises(KeyError, match="enough"):
        m.run(progress=stop, estimate_error=False)


def test_a_run_that_fails_keeps_its_rows():
    text = PENDULUM.replace('<gravity', '<load at="arm" force="0 0 1/(t-0.25)"/> <gravity')
    m = mbd.Model(text=text, file="rod.xml")
    with pytest.raises(mbd.RunError) as caught:
        m.run()
    error = caught.value
    assert 0.2 < error.t <= 0.25 and error.results is m.results and not error.results.complete
    assert error.results.failure in str(error) and len(error.results) > 200
    assert error.results.time[-1] == pytest.approx(error.t, abs=1e-3)


@pytest.mark.parametrize("how", ["signal", "callback"])
def test_interruption_keeps_rows(tmp_path, how):
    """Ctrl-C in a process of its own: the run ends soon, what was done is there, and it is a KeyboardInterrupt. While C++ is
    at work nobody but it looks for signals; a callback may raise as well."""
    text = PENDULUM.replace('duration="0.5"', 'duration="1e4" output="1 s"')
    script = tmp_path / "script.py"
    script.write_text(textwrap.dedent(f"""
        import os, signal, threading, mbd
        m = mbd.Model(text={text!r})
        def interrupt(*arguments):
            os.kill(os.getpid(), signal.SIGINT)
        if {how!r} == "signal":
            threading.Timer(0.3, interrupt).start()
        try:
            m.run(progress=interrupt if {how!r} == "callback" else None, estimate_error=False)
        except KeyboardInterrupt as error:
            assert isinstance(error, mbd.Interrupted)
            assert error.results is m.results and not m.results.complete
            print("kept", len(m.results) > 0, m.results.failure)
        """))
    done = subprocess.run([sys.executable, script], text=True, capture_output=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("kept True interrupted at t = "), done.stdout


def test_runs_beside_each_other(models):
    """Without Python's lock: the interpreter goes on, and two runs at once give the bits of one."""
    import threading

    m = mbd.Model(models / "double_pendulum.xml")
    alone = m.run(estimate_error=False).values
    found = []
    threads = [threading.Thread(target=lambda: found.append(m.run(estimate_error=False).values)) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(found) == 2 and all(same_bits(one, alone) for one in found)


def test_only_its_entry_is_exported():
    names = subprocess.run(["nm", "-D", "--defined-only", mbd._mbd.__file__], text=True, capture_output=True, check=False)
    if names.returncode != 0:
        pytest.skip("no nm")
    assert [line.split()[-1] for line in names.stdout.splitlines()] == ["PyInit__mbd"]


def test_signals_are_restored():
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
