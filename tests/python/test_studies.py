"""Studies as data: what the program writes, without text."""

import csv
import io
import json

import numpy
import pytest

import mbd
from conftest import PENDULUM, same_bits


def test_modes(models, program, tmp_path):
    found = mbd.modes(models / "swept_cantilever.xml", count=4)
    program("modes", models / "swept_cantilever.xml", "--count", 4, "--out", tmp_path, "--quiet")
    theirs = json.loads((tmp_path / "modes.json").read_text())
    assert found["names"] == [one["name"] for one in theirs["modes"]]
    # JSON has the digits it takes to read numbers back; eigenvalues are iterated, from the same start.
    assert same_bits(found["frequencies"], [one["frequency"] for one in theirs["modes"]])
    assert found["shapes"].shape == (4, len(theirs["nodes"]), 6) and found["shapes"].dtype == complex
    shape = numpy.array(theirs["modes"][2]["shape"])
    assert numpy.abs(found["shapes"][2] - (shape[..., 0] + 1j * shape[..., 1])).max() < 1e-15
    assert same_bits(found["positions"], [node["position"] for node in theirs["nodes"]])
    assert found["axes"] is None and numpy.isnan(found["inertial_frequencies"]).all()


def test_modes_of_a_spring():
    """A mass on a spring: f = sqrt(k/m)/(2 pi)."""
    text = """<mbd name="m"> <parameter name="k" value="100"/>
      <body name="b" at="1 0 0" mass="4" inertia="1 1 1"/>
      <prismatic name="p" between="ground b" axis="1 0 0"/>
      <spring name="s" between="ground b" at_a="0 0 0" stiffness="k"/>
      <transient duration="1" step="0.01"/> </mbd>"""
    for k in (100, 400):
        found = mbd.modes(mbd.Model(text=text, set={"k": k}), count=1)
        assert found["frequencies"][0] == pytest.approx(numpy.sqrt(k / 4) / (2 * numpy.pi), rel=1e-9)


def test_whole_numbers_are_asked_for(models):
    model = models / "swept_cantilever.xml"
    assert len(mbd.modes(model, count=numpy.int32(2))["names"]) == len(mbd.modes(model, count=2.0)["names"]) == 2
    for calls in (lambda x: mbd.modes(model, count=x), lambda x: mbd.campbell(model, (1, 2), points=x),
                  lambda x: mbd.rotations(model, (1, 2), search=x), lambda x: mbd.sweep(model, {"a": "0:1:3"}, jobs=x)):
        with pytest.raises(mbd.UseError, match="is 1.9; give a whole number"):
            calls(1.9)
        with pytest.raises(TypeError, match="str is no whole number"):
            calls("2")


def test_modes_that_a_model_asks_for(program, tmp_path):
    text = """<mbd name="m"> <body name="b" at="1 0 0" mass="4" inertia="1 1 1"/>
      <prismatic name="p" between="ground b" axis="1 0 0"/>
      <spring name="s" between="ground b" at_a="0 0 0" stiffness="100"/>
      <transient duration="1" step="0.01"/> MODES </mbd>"""
    plain = mbd.Model(text=text.replace("MODES", ""))
    asking = mbd.Model(text=text.replace("MODES", '<modes count="1" mac="on"/>'))
    assert mbd.modes(plain)["mac"] is None
    found = mbd.modes(asking)
    assert found["mac"]["mac"].shape == (1, 1) and found["mac"]["mac"][0, 0] == pytest.approx(1)
    plain.run(out=tmp_path / "plain")
    asking.run(out=tmp_path / "asking")
    assert not (tmp_path / "plain/modes.csv").exists()
    (tmp_path / "m.xml").write_text(text.replace("MODES", '<modes count="1" mac="on"/>'))
    program("run", tmp_path / "m.xml", "--out", tmp_path / "theirs", "--quiet")
    for name in ("modes.csv", "mac.csv"):
        assert (tmp_path / "asking" / name).read_text() == (tmp_path / "theirs" / name).read_text()
    with pytest.raises(mbd.UseError, match="one of them"):
        mbd.modes(asking, rate=1, at=0)
    with pytest.raises(mbd.ModelError, match="cannot be read"):
        mbd.modes(asking, compare=tmp_path / "none.json")


def test_modes_compared(models, program, tmp_path):
    model = models / "swept_cantilever.xml"
    program("modes", model, "--count", 4, "--out", tmp_path, "--quiet")
    own = mbd.modes(model, count=4, mac=True)["mac"]["mac"]  # a load that follows the blade: not the identity
    assert numpy.abs(numpy.diag(own) - 1).max() < 1e-12
    for other in (tmp_path, tmp_path / "modes.json", model, mbd.Model(model)):
        mac = mbd.modes(model, count=4, compare=other)["mac"]
        assert numpy.abs(mac["mac"] - own).max() < 1e-9
        assert [(pair["modes"], pair["others"]) for pair in mac["pairs"]] == [([i], [i]) for i in range(4)]
    assert mac["other_frequencies"].shape == (4,) and len(mac["other_names"]) == 4


def test_campbell(models, program, tmp_path):
    model = models / "internal_damping.xml"
    found = mbd.campbell(model, ("0 rad/s", 400), count=4, points=21)
    said = program("campbell", model, "--rates", "0:400", "--count", 4, "--points", 21, "--out", tmp_path)
    text = (tmp_path / "campbell.csv").read_text()
    rows = list(csv.DictReader(io.StringIO("\n".join(line for line in text.splitlines() if not line.startswith("#")))))
    for k, branch in enumerate(found["branches"]):
        theirs = [row for row in rows if row["mode"] == str(k + 1)]
        assert same_bits(branch["rates"], [float(row["rate"]) for row in theirs])
        assert same_bits(branch["eigenvalues"].imag, [float(row["im_eigenvalue"]) for row in theirs])
    kinds = [one["kind"] for one in found["special"]]
    assert kinds == ["critical", "unstable_above"]
    for one in found["special"]:
        assert f"{one['kind'].replace('_', ' ')}" in said.replace("critical speed", "critical")
    printed = [line.split(": ")[1].split(" rad/s")[0] for line in said.splitlines() if " rpm), mode " in line]
    assert len(printed) == 2
    for text, one in zip(printed, found["special"]):  # as many digits as round-off leaves, all of them right
        digits = len(text.replace(".", ""))
        assert digits >= 9 and text == f"{one['rate']:.{digits}g}"
    # The model says it: unstable above the first frequency by (1 + external/internal damping).
    assert found["special"][1]["rate"] / found["special"][0]["rate"] == pytest.approx(1.25, rel=0.01)


def test_rotations(program, tmp_path):
    # A bob on a hinge at e from the axis: W^2 (e + l sin a) cos a = g sin a, four angles beyond a fold.
    text = """<mbd name="arm"><body name="hub" mass="1" inertia="1 1 1"/>
      <revolute name="axle" between="ground hub" axis="0 0 1"/><drive joint="axle" angle="0"/>
      <body name="bob" at="0.1 0 -1" mass="2" inertia="0 0 0"/>
      <revolute name="hinge" between="hub bob" at="0.1 0 0" axis="0 1 0"/>
      <gravity acceleration="0 0 -9.81"/><static/></mbd>"""
    found = mbd.rotations(mbd.Model(text=text), (0, "8 rad/s"), axis=(0, 0, 1), probes="bob")
    ends = []
    for path in found["paths"]:
        angles = numpy.arctan2(path["probes"][:, 0, 0], 1 - path["probes"][:, 0, 2])
        rates = path["rates"]
        assert numpy.abs(rates**2*(0.1 + numpy.sin(angles))*numpy.cos(angles) - 9.81*numpy.sin(angles)).max() < 1e-6
        ends += [angle for angle, rate in zip(angles, rates) if rate == 8]
        assert (path["growth"] > 0).tolist() == (path["unstable"] > 0).tolist()
    assert sorted(ends) == pytest.approx([-3.054819, -1.399366, -0.118532, 1.431118], abs=5e-6)
    assert sum(len(path["folds"]) for path in found["paths"]) == 1
    (tmp_path / "arm.xml").write_text(text)
    program("rotations", tmp_path / "arm.xml", "--rates", "0:8", "--axis", 0, 0, 1, "--out", tmp_path)
    lines = [line for line in (tmp_path / "rotations.csv").read_text().splitlines() if not line.startswith("#")]
    rows = list(csv.DictReader(lines))
    for k, path in enumerate(found["paths"]):
        assert same_bits(path["rates"], [float(row["rate"]) for row in rows if row["path"] == str(k + 1)])
    for wrong in ({"far": 0}, {"search": -1}, {"points": 1}, {"count": 0}, {"axis": (1, 0)}):
        with pytest.raises(mbd.UseError):
            mbd.rotations(mbd.Model(text=text), (0, 8), **wrong)
    with pytest.raises(mbd.UseError, match="rise"):
        mbd.rotations(mbd.Model(text=text), (8, 0))


def test_responses():
    # Jeffcott's rotor: m e W^2/(k - m W^2 + i c W), and F/(k - m w^2 + i c w) of a force at w = 2 W.
    text = """<mbd name="jeffcott">
      <body name="housing" mass="1e-9" inertia="1e-9 1e-9 1e-9"/>
      <body name="disk" mass="20" inertia="0.4 0.2 0.2"/>
      <bushing name="bearing" between="ground housing" stiffness="1e6 2e5 2e5" angular_stiffness="1e6 1e6 1e6"
               damping="1e3 400 400"/>
      <revolute name="R" between="housing disk" axis="1 0 0"/><drive joint="R" angle="0"/><static/></mbd>"""
    found = mbd.campbell(mbd.Model(text=text), (20, 200), count=2, points=5, at_rest="housing",
                         unbalance={"disk": "20 g.mm"}, forces={"disk": (0, "3 N")}, order=2, probes="housing")
    assert [one["place"] for one in found["unbalance_responses"]] == ["disk", "housing"]
    for one in found["unbalance_responses"]:
        W = one["rates"]
        assert numpy.abs(one["forward"] / (20e-6 * W**2 / (2e5 - 20 * W**2 + 400j * W)) - 1).max() < 1e-6
        assert numpy.abs(one["backward"]).max() < 1e-6 * numpy.abs(one["forward"]).max()
    for one in found["force_responses"]:
        w = 2 * one["rates"]
        assert numpy.abs(one["forward"] / (1.5j / (2e5 - 20 * w**2 + 400j * w)) - 1).max() < 1e-6
        assert one["besides"].max() < 1e-9 * numpy.abs(one["forward"]).max()
    for wrong in (dict(forces={"disk": (1, 2, 3)}), dict(order=0), dict(unbalance={"disk": "1 m"}),
                  dict(forces={"nowhere": 1}), dict(probes="disk")):
        with pytest.raises(mbd.Error):
            mbd.campbell(mbd.Model(text=text), (20, 200), points=2, at_rest="housing", **wrong)


def test_effects_and_accuracy():
    text = PENDULUM.replace('duration="0.5"', 'duration="0.1"')
    effects = mbd.effects(mbd.Model(text=text), budget=5)
    assert "gravity" in json.dumps(effects)
    accuracy = mbd.accuracy(mbd.Model(text=text), vary={"method": "radau", "tolerance": [1e-3, 1e-5]}, budget=5,
                            quantities="tip.displacement")
    assert accuracy["quantities"][0]["name"] == "tip.displacement"
    assert len(accuracy["points"] if "points" in accuracy else accuracy["trials"]) == 2
    json.dumps([effects, accuracy])  # nothing but data
