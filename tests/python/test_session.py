"""A session from a model file to a sweep, word for word as it was asked for before there was a package.
"""

import importlib.util
import os

import numpy
import pytest

import mbd
from conftest import same_bits

ROTOR = """<mbd name="rotor">
  <parameter name="rpm" value="2"/>
  <input name="torque" unit="N.m"/>
  <body name="hub" at="0 0 0" mass="1" inertia="0.1 0.1 0.1" angular_velocity="0 0 rpm"/>
  <body name="arm" at="1 0 0" mass="2" inertia="0.01 0.1 0.1" velocity="0 rpm*1 0" angular_velocity="0 0 rpm"/>
  <revolute name="shaft" between="ground hub" axis="0 0 1"/>
  <revolute name="elbow" between="hub arm" at="0.5 0 0" axis="0 1 0"/>
  <joint_torque joint="elbow" moment="torque"/>
  <joint_spring name="e" joint="elbow" angular_stiffness="100"/>
  <joint_spring name="s" joint="shaft" angular_stiffness="1"/>
  <gravity acceleration="0 0 -9.81"/>
  <transient duration="1.5" step="1 ms"/>
  <record name="tip" at="arm" quantities="displacement"/>
</mbd>
"""


@pytest.fixture
def rotor(tmp_path, monkeypatch):
    (tmp_path / "rotor.xml").write_text(ROTOR)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_the_session(rotor):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    pandas = pytest.importorskip("pandas")
    h5py = pytest.importorskip("h5py")
    k = 3.0
    m = mbd.Model("rotor.xml", set={"rpm": "30 rpm"})
    r = m.run(progress=True, motion=True)
    assert r["tip.displacement"].shape == (len(r), 3) and r.units["tip.displacement"] == "m"
    assert isinstance(r.frame(), pandas.DataFrame) and r.frame().shape == (len(r), 3)
    assert r.plot("tip") is not None
    if mbd.has_pages:
        assert r.view()._repr_html_().startswith("<iframe")
    s = m.stepper(method="radau", tolerance=1e-6)
    while s.t < 1: s.step(); q = s.angle("elbow"); s.input["torque"] = -k*q  # noqa: E701, E702
    assert s.input["torque"] == s.inputs["torque"] == -k * q != 0
    s.save("x.h5"); A = s.linearise()  # noqa: E702
    assert A.keys() == s.linearize().keys()
    with h5py.File("x.h5") as file:
        assert file.attrs["t"] == s.t and same_bits(file["positions"][()], s.positions)
        assert same_bits(file["velocities"][s.node("arm")], s.velocities[s.node("arm")])
        assert [name.decode() for name in file["nodes"][()]] == s.nodes
    other = m.stepper(method="radau", tolerance=1e-6)
    other.restore("x.h5")
    for each in (s, other):
        each.step(5)
    assert s.t == other.t and same_bits(s.positions, other.positions) and same_bits(s.velocities, other.velocities)
    assert mbd.accuracy("rotor.xml", budget=2)["quantities"]
    assert mbd.effects("rotor.xml", budget=2)
    assert len(mbd.modes("rotor.xml", set={"rpm": 0}, count=2)["frequencies"]) == 2
    t = mbd.sweep("rotor.xml", {"rpm": range(10, 60)}, quantity="tip.displacement.3", jobs=2)
    assert t.status == ["done"] * 50 and (t["rpm"] == range(10, 60)).all() and t["tip.displacement.3"].shape == (50,)
    one = mbd.Model("rotor.xml", set={"rpm": 59}).run(estimate_error=False)
    assert t["tip.displacement.3"][-1] == one["tip.displacement.3"][-1]


def test_inputs_by_name(rotor):
    s = mbd.Model("rotor.xml").stepper()
    inputs = s.input
    assert list(inputs) == ["torque"] == inputs.keys() and len(inputs) == 1 and dict(inputs) == s.inputs
    assert "torque" in inputs and "torqe" not in inputs and 3 not in inputs and "torque" in repr(inputs)
    inputs["torque"] = numpy.float32(0.5)
    inputs["torque"] += 1
    assert s.inputs == {"torque": 1.5}
    for call in (lambda: inputs["torqe"], lambda: inputs.__setitem__("torqe", 1)):
        with pytest.raises(mbd.UnknownName, match="torque"):
            call()
    for value in (float("nan"), float("inf")):
        with pytest.raises(mbd.UseError, match="finite"):
            inputs["torque"] = value
    for name, value in ((3, 1.0), ("torque", "3"), ("torque", None), ("torque", [1, 2])):
        with pytest.raises(TypeError):
            inputs[name] = value
    with pytest.raises((AttributeError, TypeError)):
        s.input = {"torque": 1}
    with pytest.raises(TypeError):
        mbd.Inputs()
    del s  # inputs hold their stepper
    assert inputs["torque"] == 1.5


@pytest.mark.parametrize("name", ["x.h5", "x.hdf5", "x.state", "with a : in it.h5"])
def test_checkpoints_in_files(rotor, name):
    if name.endswith("5"):
        pytest.importorskip("h5py")
    m = mbd.Model("rotor.xml")
    s = m.stepper()
    s.step(100)
    assert s.save(rotor / name) == s.save(file=name) == s.save()
    assert sorted(os.listdir()) == sorted(["rotor.xml", name])  # and nothing else
    s.step(100)
    for given in (name, rotor / name, os.fsencode(rotor / name).decode()):
        other = m.stepper()
        other.restore(given)
        other.step(100)
        assert same_bits(other.positions, s.positions) and same_bits(other.velocities, s.velocities)
    with pytest.raises(mbd.UseError, match="another model"):
        mbd.Model(text=ROTOR.replace('mass="2"', 'mass="3"')).stepper().restore(name)


def test_files_that_are_no_checkpoints(rotor):
    s = mbd.Model("rotor.xml").stepper()
    s.step(7)
    kept = s.save("good")
    (rotor / "cut").write_bytes(kept[:-1])
    (rotor / "empty").write_bytes(b"")
    (rotor / "words.h5").write_text("words")
    files = ["cut", "empty", "nowhere", ".", "rotor.xml", "a\0b", "words.h5", "nowhere.h5"]
    if importlib.util.find_spec("h5py") is not None:
        import h5py

        with h5py.File("other.h5", "w") as file:
            file["positions"] = numpy.zeros((2, 3))
        with h5py.File("wrong.h5", "w") as file:
            file["checkpoint"] = "words"
        with h5py.File("group.h5", "w") as file:
            file.create_group("checkpoint")
        files += ["other.h5", "wrong.h5", "group.h5"]
    for file in files:
        with pytest.raises(mbd.UseError):
            s.restore(file)
    for file in ("nowhere/x", ".", "nowhere/x.h5", "a\0b", "a\0b.h5", ""):
        with pytest.raises(mbd.UseError, match="cannot be written"):
            s.save(file)
    for file in (3, [], object()):
        with pytest.raises(TypeError):
            s.save(file)
        with pytest.raises(TypeError):
            s.restore(file)
    with pytest.raises(TypeError):
        s.restore(None)
    # It goes on as if nothing had been.
    s.step()
    again = mbd.Model("rotor.xml").stepper()
    again.restore(kept)
    again.step()
    assert same_bits(s.positions, again.positions)
