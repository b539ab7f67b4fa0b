"""Scenes built in Python: the names, units and defaults of model files, to the same bits."""

import numpy
import pytest

import mbd
from conftest import PENDULUM, same_bits


def rod(W=2, L="1 m"):
    scene = mbd.Scene("rod")
    scene.parameter(name="W", value=W)
    scene.parameter(name="L", value=L)
    scene.body(name="arm", at="L 0 0", mass="W", inertia=(0.1, 0.1, 0.1))
    scene.revolute(name="hinge", between="ground arm", at=[0, 0, 0], axis=numpy.array([0, 1, 0]))
    scene.gravity(acceleration=(0, 0, -9.81))
    scene.transient(duration=0.5, step="1 ms")
    scene.record(name="tip", at="arm", quantities="displacement velocity")
    scene.record(name="hinge", joint="hinge", quantities=["angle", "reaction_force"])
    return scene


def test_same_bits_as_a_file():
    by_hand, by_file = rod().run(), mbd.Model(text=PENDULUM).run()
    assert by_hand.columns == by_file.columns and same_bits(by_hand.values, by_file.values)
    assert same_bits(mbd.Model(text=rod().xml()).run().values, by_file.values)
    assert not same_bits(rod(L="0.9 m").run().values, by_file.values)
    assert same_bits(mbd.Model(rod(), set={"L": "0.9 m"}).run().values, rod(L="0.9 m").run().values)


def test_parts_of_elements():
    """A cantilever: PL^3/3EI + PL/GA, small load, one element of order 3 (exact for the cubic)."""
    scene = mbd.Scene("cantilever")
    section = scene.section(name="strip")
    D = numpy.diag([1e6, 4e5, 4e5, 80, 100, 100])
    section.stiffness(D)
    scene.beam(name="b", section="strip", from_=(0, 0, 0), to=(1, 0, 0), normal=(0, 0, 1), elements=2)
    scene.fixed(name="clamp", between="ground b.start")
    scene.load(at="b.end", force=(0, 0, -1e-3))
    scene.static(steps=1)
    scene.record(name="tip", at="b.end", quantities="displacement")
    w = scene.run()["tip.displacement.3"][-1]
    assert w == pytest.approx(-1e-3 / (3 * 100) - 1e-3 / 4e5, rel=1e-6)
    assert "<stiffness>1000000.0 0.0" in scene.xml()


def test_errors_have_the_line_of_python():
    scene = mbd.Scene("rod")
    scene.body(name="arm", mass=2, inertia="1 1 1")
    scene.revolute(name="hinge", between="ground leg", axis="0 1 0")  # line 53: this one
    scene.transient(duration=1, step=0.1)
    with pytest.raises(mbd.ModelError, match="leg") as caught:
        mbd.Model(scene).check()
    assert caught.value.file == __file__
    line = open(__file__, encoding="utf-8").read().splitlines()[caught.value.line - 1]
    assert "this one" in line
    scene = mbd.Scene("rod")
    scene.body(name="arm", weight=3)
    with pytest.raises(mbd.ModelError, match='unknown attribute "weight"'):
        mbd.Model(scene)


def test_wrong_values():
    scene = mbd.Scene("rod")
    with pytest.raises(mbd.UseError, match="mass is nan"):
        scene.body(name="arm", mass=float("nan"))
    with pytest.raises(TypeError):
        scene.body(name="arm", mass=object())
    with pytest.raises(AttributeError):
        scene.wing(name="w")
    with pytest.raises(AttributeError):
        scene.stiffness(EA=1)  # stands in a section
    with pytest.raises(mbd.UseError, match="content"):
        scene.body("text", name="b")


def test_every_element_is_there_with_its_page():
    """From the table of elements, so that what is added to the library is here too."""
    from mbd.scene import _CLASSES, _ELEMENTS

    assert len(_ELEMENTS) > 40
    for name, element in _ELEMENTS.items():
        for parent in element["parents"].split():
            method = getattr(_CLASSES[parent], name)
            assert method.__doc__ == element["page"] and element["doc"].split()[0] in method.__doc__
            for attribute in element["attributes"]:
                assert attribute["name"] in method.__doc__
    assert "GA2" in mbd.Scene.section.__doc__ or "GA2" in _CLASSES["section"].stiffness.__doc__


def test_models_of_the_repository_become_scenes(models):
    """Each element and attribute of them, by the methods: read from XML, built by calls, compiled to the same columns."""
    import xml.etree.ElementTree as tree

    def add(parent, node):
        for child in node:
            if callable(child.tag):
                continue
            given = {key + "_" if key == "from" else key: value for key, value in child.attrib.items()}
            text = (child.text or "").strip() or None
            add(getattr(parent, child.tag)(*([text] if text else []), **given), child)

    count = 0
    for file in sorted(models.glob("*.xml")):
        root = tree.parse(file).getroot()
        scene = mbd.Scene(root.attrib["name"])
        if root.find("include") is not None:
            continue
        add(scene, root)
        ours, theirs = mbd.Model(scene), mbd.Model(file)
        assert ours.columns == theirs.columns and ours.parameters == theirs.parameters, file
        count += 1
    assert count > 20
