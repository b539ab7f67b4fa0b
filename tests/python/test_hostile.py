"""Models of a hostile user: other units, other layout, traps."""

import numpy
import pytest

import mbd
from conftest import same_bits


def test_other_units_and_layout(tmp_path):
    """A mass on a spring, struck: x = v/w sin(w t), w = sqrt(k/m); in mm, t, N/mm, what is used before it is given, from an
    included file, by a record that comes first."""
    (tmp_path / "sub dir").mkdir()
    (tmp_path / "sub dir" / "numbers.xml").write_text('<mbd name="n"><parameter name="v" value="500 mm/s"/></mbd>')
    file = tmp_path / "a:12: model.xml"
    file.write_text("""<?xml version="1.0"?><!-- "mbd" -->
      <mbd name="m"><include file="sub dir/numbers.xml"/>
      <record name="x" at="b" quantities="displacement velocity"/><transient tolerance="1e-10" method="radau" duration="3000 ms"
        output="0.05 s"/><spring name="s" between="ground b" at_a="0 0 0" stiffness="0.1 N/mm" length="1000 mm"/>
      <prismatic axis="0 0 -2" name="p" between="ground b"/>
      <body name="b" at="0 0 -1000 mm" mass="4e-3 t" velocity="0 0 v" inertia="1 1 1"/></mbd>""")
    m = mbd.Model(file)
    r = m.run()
    w = numpy.sqrt(100 / 4)
    # Largest difference over all rows, of the amplitude.
    assert numpy.abs(r["x.displacement.3"] - 0.5 / w * numpy.sin(w * r.time)).max() < 1e-7 * 0.5 / w
    assert numpy.abs(r["x.displacement"][:, :2]).max() < 1e-12 and len(r) == 61
    s = m.stepper()
    while s.t < 1:
        s.step()
    del m
    assert s["x.displacement.3"] == pytest.approx(0.5 / w * numpy.sin(w * s.t), abs=1e-8)
    assert mbd.modes(mbd.Model(file), count=1)["frequencies"][0] == pytest.approx(w / 2 / numpy.pi, rel=1e-9)
    # The name of the file looks like a place in a file.
    file.write_text(file.read_text().replace('mass="4e-3 t"', 'mass="4e-3 m"'))
    with pytest.raises(mbd.ModelError) as caught:
        mbd.Model(file)
    assert caught.value.file == str(file) and caught.value.line == 6
    # And in an included one.
    (tmp_path / "sub dir" / "numbers.xml").write_text('<mbd name="n">\n<parameter name="v" value="5 +"/></mbd>')
    with pytest.raises(mbd.ModelError) as caught:
        mbd.Model(file)
    assert caught.value.file.endswith("numbers.xml") and caught.value.line == 2


def test_a_model_that_is_wrong_as_it_stands_is_swept():
    text = """<mbd name="fall"> <parameter name="M" value="0"/> <body name="b" at="0 0 0" mass="M" inertia="1 1 1"/>
      <transient duration="1" step="0.1"/> <gravity acceleration="0 0 -10"/>
      <record name="b" at="b" quantities="displacement"/> </mbd>"""
    s = mbd.sweep(mbd.Model(text=text), {"M": [1, 0, 2]}, quantity="b.displacement.3")
    assert s.status == ["done", "refused", "done"]
    assert s["b.displacement.3"][0] == pytest.approx(-5, rel=1e-9) and s["M"].tolist() == [1, 0, 2]


def test_a_loop_in_python_is_a_repeat():
    """A chain of rods: the same model by <repeat>."""
    text = """<mbd name="chain"> <parameter name="N" value="3"/>
      <repeat count="N" index="i"> <body name="rod{i}" at="i+0.5 0 0" mass="1" inertia="0.01 0.1 0.1"/> </repeat>
      <spherical name="ball0" between="ground rod0" at="0 0 0"/>
      <repeat count="N-1"> <spherical name="ball{i+1}" between="rod{i} rod{i+1}" at="i+1 0 0"/> </repeat>
      <gravity acceleration="0 0 -9.81"/> <transient duration="0.3" step="1e-3"/>
      <record name="end" at="rod2" quantities="displacement"/> </mbd>"""
    scene = mbd.Scene("chain")
    for i in range(3):
        scene.body(name=f"rod{i}", at=(i + 0.5, 0, 0), mass=1, inertia=(0.01, 0.1, 0.1))
    for i in range(3):
        scene.spherical(name=f"ball{i}", between=f"{'ground' if i == 0 else f'rod{i - 1}'} rod{i}", at=(i, 0, 0))
    scene.gravity(acceleration=(0, 0, -9.81))
    scene.transient(duration=0.3, step=1e-3)
    scene.record(name="end", at="rod2", quantities="displacement")
    by_hand, by_repeat = scene.run(estimate_error=False), mbd.Model(text=text).run(estimate_error=False)
    assert same_bits(by_hand.values, by_repeat.values) and by_hand["end.displacement.3"][-1] < -0.1


def test_a_scene_that_two_files_build():
    """What another file states has no line; a place in the first would be a false one."""
    scene = mbd.Scene("two")
    exec(compile("scene.body(name='b', weight=1)", "other.py", "exec"), {"scene": scene})  # noqa: S102
    with pytest.raises(mbd.ModelError, match="weight") as caught:
        mbd.Model(scene)
    assert caught.value.line is None


def test_results_outlive_everything():
    text = """<mbd name="fall"> <body name="b" at="0 0 0" mass="1" inertia="1 1 1"/> <gravity acceleration="0 0 -10"/>
      <transient duration="1" step="0.1"/> <record name="b" at="b" quantities="displacement"/> </mbd>"""
    m = mbd.Model(text=text)
    s = m.stepper()
    z, x, state = m.run()["b.displacement.3"], s.positions, s.state()
    del m
    s.step(3)
    del s
    velocities = state.velocities
    del state
    assert z[-1] == pytest.approx(-5, rel=1e-9) and x[1, 2] == pytest.approx(-0.45, rel=1e-6) and (velocities == 0).all()


def test_what_is_no_model_or_no_row_of_numbers(models):
    with pytest.raises(TypeError, match="bytes is no str"):
        mbd.Model(text=b"<mbd name='m'/>")
    with pytest.raises(mbd.UseError, match=r"k has values of shape \(2, 2\)"):
        mbd.sweep(models / "torsion_pendulum.xml", {"k": numpy.ones((2, 2))})


def test_step_to_of_a_stepper_in_use():
    """Another thread that steps is no reason to say that the time is over."""
    import threading
    import time

    text = """<mbd name="m"><body name="b" at="1 0 0" mass="1" inertia="1 1 1"/><spherical name="s" between="ground b" at="0 0 0"/>
      <gravity acceleration="0 0 -9.81"/><transient duration="1e4" step="1e-3"/></mbd>"""
    s = mbd.Model(text=text).stepper()
    def run():
        try:
            s.step_to(300)
        except mbd.Error:
            pass
    other = threading.Thread(target=run)
    other.start()
    said = set()
    while other.is_alive():
        try:
            s.step_to(1e-3)
        except mbd.UseError as error:
            if "the time is 300 s already" in str(error):
                break  # true: the other has arrived, though its thread lives for a moment more
            said.add("in use" if "in use by another thread" in str(error) else str(error))
        time.sleep(1e-3)  # who asks without a pause keeps the interpreter's lock, and the other may take a quarter of an hour
    other.join()
    assert said <= {"in use"}
