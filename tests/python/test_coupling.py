"""A model that a program drives: inputs, checkpoints, steps taken again, matrices. Against closed forms."""

import pathlib
import re

import numpy as np
import pytest

import mbd

ROTOR = """<mbd name="rotor">
  <input name="torque" unit="N.mm"/><input name="push" value="0.5"/>
  <body name="wheel" mass="1" inertia="1 1 0.2"/>
  <revolute name="r" between="ground wheel" axis="0 0 1"/>
  {spring}
  <joint_torque joint="r" moment="torque"/>
  <record name="r" joint="r" quantities="angle rate"/>
  <transient duration="2" step="1e-3"/></mbd>"""


def rotor(tmp_path, k=0.0, c=0.0):
    file = tmp_path / "rotor.xml"
    spring = f'<joint_spring name="k" joint="r" angular_stiffness="{k}" angular_damping="{c}"/>' if k or c else ""
    file.write_text(ROTOR.format(spring=spring))
    return mbd.Model(file)


def test_inputs_are_held_and_ramped(tmp_path):
    s = rotor(tmp_path).stepper()
    assert s.inputs == {"torque": 0.0, "push": 0.5}
    assert s.input_names == [("torque", "N.mm"), ("push", "")]
    s.set_input("torque", 400.0)  # 2 rad/s2
    s.step_to(0.5)
    assert s["r.angle"] == pytest.approx(0.25, abs=1e-9)
    assert s["r.rate"] == pytest.approx(1.0, abs=1e-9)
    s.set_input("torque", 0.0, over=0.5)  # down to nothing in half a second
    assert s.inputs["torque"] == 400.0
    s.step_to(0.75)
    assert s.inputs["torque"] == pytest.approx(200.0)
    s.step_to(1.0)
    s.set_input("torque", 0.0)
    s.step_to(1.2)
    assert s["r.rate"] == pytest.approx(1.5, abs=1e-6)
    # steps of 1 ms: the error of order 2 of a ramp
    assert s["r.angle"] == pytest.approx(0.25 + 0.5 + 2 * (0.5**2 / 2 - 0.5**2 / 6) + 0.3, abs=3e-6)


def test_what_drives_a_joint_goes_on_with_its_rate(tmp_path):
    file = tmp_path / "slide.xml"
    file.write_text("""<mbd name="slide"><input name="x" unit="mm"/>
      <body name="b" mass="2" inertia="1 1 1"/><prismatic name="p" between="ground b" axis="1 0 0"/>
      <drive joint="p" displacement="x"/><transient duration="3" step="0.01"/>
      <record name="p" joint="p" quantities="displacement"/></mbd>""")
    s = mbd.Model(file).stepper()
    s.set_input("x", 0.0, acceleration=200.0)
    s.step_to(1.0)
    assert s["p.displacement"] == pytest.approx(0.1, abs=1e-9)
    s.set_input("x", 100.0, rate=200.0)
    s.step_to(2.0)
    assert s["p.displacement"] == pytest.approx(0.3, abs=1e-9)
    s.set_input("x", 300.0)  # at once without its rate
    with pytest.raises(mbd.RunError, match="impact"):
        s.step()


def test_adaptive_steps_end_where_they_are_told(tmp_path):
    s = rotor(tmp_path, k=5.0).stepper(method="radau", tolerance=1e-9)
    s.set_input("torque", 1000.0)
    for t in (0.1, 0.37, 1.0):
        s.step_to(t)
        assert s.t == pytest.approx(t, abs=1e-12)
        assert s["r.angle"] == pytest.approx(0.2 * (1 - np.cos(5 * t)), abs=1e-8)


def test_checkpoints_go_on_to_the_last_bit(tmp_path):
    model = rotor(tmp_path, k=5.0, c=0.1)
    s = model.stepper()
    s.set_input("torque", 300.0)
    s.step(100)
    kept = s.save()
    positions = s.quaternions
    s.step(200)
    there = s.quaternions.copy(), s.velocities.copy()
    other = rotor(tmp_path, k=5.0, c=0.1).stepper()
    other.restore(kept)
    assert other.t == pytest.approx(0.1)
    assert other.inputs["torque"] == 300.0
    other.step(200)
    assert np.array_equal(other.quaternions, there[0]) and np.array_equal(other.velocities, there[1])
    s.restore(kept)  # views go on showing the stepper
    s.step(200)
    assert np.array_equal(positions, there[0])
    with pytest.raises(mbd.UseError, match="another model"):
        rotor(tmp_path, k=5.1).stepper().restore(kept)
    with pytest.raises(mbd.UseError, match="damaged"):
        s.restore(kept[:-9])
    with pytest.raises(mbd.Error, match="cannot be saved"):
        model.stepper(method="ida", tolerance=1e-6).save()


def test_steps_are_taken_again(tmp_path):
    model = rotor(tmp_path, k=5.0)
    once, often = model.stepper(), model.stepper()
    for k in range(50):
        here = often.remember()
        for off in (70.0, -20.0, 0.0):
            often.go_back(here)
            often.set_input("torque", 100.0 * np.sin(k) + off)
            often.step()
        once.set_input("torque", 100.0 * np.sin(k))
        once.step()
    assert often["r.angle"] == pytest.approx(float(once["r.angle"]), abs=1e-10)
    assert abs(once["r.angle"]) > 1e-5


def test_matrices(tmp_path):
    model = rotor(tmp_path, k=5.0, c=0.1)
    linear = mbd.linearize(model)
    assert linear["inputs"] == [("torque", "N.mm"), ("push", "")]
    assert linear["outputs"] == [("r.angle", "rad"), ("r.rate", "rad/s")]
    assert linear["states"][0][1] == "rad" and linear["states"][1][1] == "rad/s"
    poles = np.linalg.eigvals(np.linalg.solve(linear["E"], linear["A"]))
    assert np.sort_complex(poles) == pytest.approx(np.sort_complex(np.roots([0.2, 0.1, 5.0])), rel=1e-12)
    s = 0.3 + 2.0j
    transfer = linear["C"] @ np.linalg.solve(s * linear["E"] - linear["A"], linear["B"]) + linear["D"]
    assert transfer[:, 0] == pytest.approx(np.array([1.0, s]) * 1e-3 / (0.2 * s**2 + 0.1 * s + 5.0), rel=1e-8)
    assert np.all(transfer[:, 1] == 0.0)
    values, (rows, columns) = linear["motion"]["M"][0]
    assert linear["motion"]["M"][1] == (6, 6)
    mass = np.zeros((6, 6))
    mass[rows, columns] = values
    assert mass == pytest.approx(np.diag([1, 1, 1, 1, 1, 0.2]))
    stepper = model.stepper()
    assert stepper.linearize()["A"] == pytest.approx(linear["A"])
    stepper.set_input("torque", 500.0)
    stepper.step(100)
    moving = stepper.linearize()
    assert "A" not in moving and len(moving["notes"]) == 1


def test_the_guide_makes_a_mat_file(tmp_path, monkeypatch):
    scipy_io, sparse = pytest.importorskip("scipy.io"), pytest.importorskip("scipy.sparse")
    root = pathlib.Path(__file__).parents[2]
    said = re.search(r"```python\n(linear = mbd[^`]*)```", (root / "models/GUIDE.md").read_text()).group(1)
    monkeypatch.chdir(tmp_path)
    names = {"mbd": mbd, "scipy": __import__("scipy")}
    exec(said.replace("models/", f"{root}/models/"), names)
    read, linear = scipy_io.loadmat("linear.mat"), names["linear"]
    for name in "EABCD":
        assert np.array_equal(read[name], linear[name])
    for name in "MCKG":
        assert (read["all_" + name] != sparse.csc_matrix(names["all_nodes"]["all_" + name])).nnz == 0
    assert read["A"].shape[0] > 100


def test_says_what_is_wrong(tmp_path):
    s = rotor(tmp_path).stepper()
    with pytest.raises(mbd.UnknownName, match="torque"):
        s.set_input("torqe", 1.0)
    with pytest.raises(mbd.UseError, match="not finite"):
        s.set_input("torque", float("nan"))
    with pytest.raises(mbd.UseError, match="over"):
        s.set_input("torque", 1.0, over=0.0)
    with pytest.raises(mbd.UseError, match="over"):
        s.set_input("torque", 1.0, over=1e-300)
    with pytest.raises(mbd.UseError, match="leave out rate"):
        s.set_input("torque", 1.0, over=0.5, rate=1.0)
    with pytest.raises(mbd.UseError, match="not finite"):
        s.set_input("torque", 1.0, rate=float("inf"))
    with pytest.raises(mbd.UseError, match="duration"):
        s.step_to(3.0)
    s.step_to(0.5)
    with pytest.raises(mbd.UseError, match="already"):
        s.step_to(0.1)
