"""Wrong use: exceptions of documented types with the messages of C++, and no crash whatever is called."""

import os
import random
import subprocess
import sys

import numpy
import pytest

import mbd
from conftest import PENDULUM, ROOT


def test_types():
    assert issubclass(mbd.ModelError, mbd.Error) and issubclass(mbd.RunError, mbd.Error)
    assert issubclass(mbd.UseError, ValueError) and issubclass(mbd.UnknownName, KeyError)
    assert issubclass(mbd.Interrupted, KeyboardInterrupt) and not issubclass(mbd.Interrupted, mbd.Error)


def test_file_and_line(tmp_path):
    file = tmp_path / "rod.xml"
    file.write_text(PENDULUM.replace("axis=", "axes="))
    with pytest.raises(mbd.ModelError) as caught:
        mbd.Model(file)
    assert caught.value.file == str(file) and caught.value.line == 4
    assert 'unknown attribute "axes"; did you mean "axis"?' in str(caught.value)
    # What parts of a model do to each other is seen when it is compiled.
    file.write_text(PENDULUM.replace('between="ground arm"', 'between="ground leg"'))
    m = mbd.Model(file)
    for call in (m.run, m.stepper, m.check, lambda: m.columns):
        with pytest.raises(mbd.ModelError, match="leg") as caught:
            call()
        assert caught.value.line == 4
    with pytest.raises(mbd.ModelError) as caught:
        mbd.Model(tmp_path / "none.xml")
    assert caught.value.line is None and "none.xml" in str(caught.value)
    with pytest.raises(mbd.ModelError, match="no such parameter"):
        mbd.Model(text=PENDULUM, set={"V": 3})
    with pytest.raises(mbd.ModelError, match="rod.txt:1"):
        mbd.Model(text="<mbd", file="rod.txt")


@pytest.mark.parametrize("name", sorted(os.listdir(ROOT / "tests" / "bad_models"))[::7])
def test_bad_models_say_what_the_program_says(name, program):
    if not name.endswith(".xml"):
        pytest.skip("no model")
    path = ROOT / "tests" / "bad_models" / name
    done = subprocess.run([os.environ["MBD_PROGRAM"], "check", str(path)], text=True, capture_output=True, check=False)
    try:
        mbd.Model(path).check()
    except mbd.Error as error:
        assert str(error).split("\n")[0] in done.stdout + done.stderr
    else:  # what only a run finds
        assert done.returncode == 0, done.stderr


def test_names_of_results(pendulum):
    r = pendulum.run(estimate_error=False)
    with pytest.raises(mbd.UnknownName, match='did you mean "tip.displacement"') as caught:
        r["tip.displacment"]
    assert str(caught.value).startswith("rod: ")  # not the repr of a KeyError
    assert "tip" in r and "tap" not in r and 3 not in r
    with pytest.raises(TypeError):
        r[0]
    with pytest.raises(mbd.UnknownName):
        r.plot("tap")


def test_wrong_arguments(pendulum, tmp_path):
    for arguments in ((), ("a.xml", "b.xml")):
        with pytest.raises(TypeError):
            mbd.Model(*arguments)
    with pytest.raises(mbd.UseError, match="finite"):
        mbd.Model(text=PENDULUM, set={"W": float("nan")})
    with pytest.raises(TypeError):
        mbd.Model(text=PENDULUM, set={"W": object()})
    with pytest.raises(TypeError):
        pendulum.run(progress=3)
    with pytest.raises(mbd.ModelError, match="lead"):
        pendulum.run(without=["lead"])
    with pytest.raises(mbd.UseError, match="accuracy"):
        pendulum.run(accuracy=7)
    file = tmp_path / "file"
    file.write_text("")
    with pytest.raises(mbd.ModelError):
        pendulum.run(out=file / "there")
    with pytest.raises(mbd.ModelError):
        mbd.read(tmp_path)
    with pytest.raises(mbd.UseError, match="count"):
        mbd.modes(pendulum, count=0)
    with pytest.raises(mbd.UseError, match="axis"):
        mbd.modes(pendulum, rate=1, axis=(0, 0, 0))
    with pytest.raises(mbd.UseError, match="must have 3"):
        mbd.campbell(pendulum, (0, 10), axis=(1, 0))
    with pytest.raises(mbd.UseError, match="rise"):
        mbd.campbell(pendulum, (10, 0))
    with pytest.raises(mbd.UseError, match="budget"):
        mbd.effects(pendulum, budget=0)
    with pytest.raises(mbd.ModelError):
        mbd.accuracy(pendulum, vary={"colour": [1, 2]}, budget=2)
    for private in (mbd.Stepper, mbd.State):
        with pytest.raises(TypeError):
            private()


FUZZ = r"""
import copy, random, sys
import numpy, mbd
random.seed(int(sys.argv[1]))
calls = int(sys.argv[2])
text = sys.argv[3]
odd = [None, True, -1, 0, 1, 3, 10**30, 1e-300, 1e308, -0.5, float("nan"), float("inf"), "", "x", "tip", "tip.displacement",
       "arm", "hinge", "radau", "ida", "\0", "a" * 5000, "\ud800", b"bytes", [], [1], (1, 2, 3), {}, {"W": 2}, object(), len,
       numpy.zeros(3), numpy.zeros((2, 6)), numpy.full((2, 6), numpy.nan), numpy.zeros((0, 3)), numpy.array("x"), range(4)]
models = [mbd.Model(text=text), mbd.Model(text=text, set={"W": 3})]
things = models + [m.stepper() for m in models]
things += [s.state() for s in things[2:]] + [m.run(estimate_error=False) for m in models]
scene = mbd.Scene("scene")
things += [scene, scene.section(name="s"), mbd]
skip = {"sweep", "accuracy", "effects", "campbell", "rotations", "run", "view", "save", "plot", "Page"}
fast = {"run": dict(estimate_error=False)}
allowed = (mbd.Error, TypeError, AttributeError, UnicodeError, OverflowError, KeyError, ValueError, MemoryError,
           FileNotFoundError, IndexError)
seen = set()
for _ in range(calls):
    thing = random.choice(things + odd[-6:]) if random.random() < 0.9 else random.choice(odd)
    names = [n for n in dir(thing) if not n.startswith("__") or n in ("__getitem__", "__copy__", "__contains__", "__len__", "__repr__")]
    names = [n for n in names if n not in skip and not n.startswith("_")] or ["x"]
    name = random.choice(names)
    try:
        what = getattr(thing, name)
        choice = random.random()
        if choice < 0.1:
            setattr(thing, name, random.choice(odd)) if isinstance(thing, mbd.State) else None
        elif callable(what) and type(thing).__module__.startswith("mbd") or thing is mbd:
            given = [random.choice(odd + things) for _ in range(random.choice([0, 1, 1, 1, 2, 3]))]
            if name == "step" and given and isinstance(given[0], int) and given[0] > 100:
                given = [5]
            keys = {k: random.choice(odd) for k in random.sample(["set", "text", "name", "method", "step", "tolerance", "from_",
                    "count", "duration", "place", "joint"], random.choice([0, 0, 0, 1, 2]))}
            if keys.get("count", 0) and isinstance(keys["count"], int) and keys["count"] > 100:
                del keys["count"]
            found = what(*given, **keys)
            seen.add(name)
            if type(found).__module__.startswith("mbd") and len(things) < 60:
                things.append(found)
            elif isinstance(found, numpy.ndarray):
                found.sum()
    except allowed:
        seen.add(name)
    except KeyboardInterrupt:
        raise
for s in things[2:4]:
    assert numpy.isfinite(s.positions).all()
print("calls", calls, "of", len(seen), "names")
"""


@pytest.mark.parametrize("seed", range(4))
def test_random_calls_do_not_crash(seed):
    """4 x 2500 calls of everything with anything. What is raised is one of the documented types or of Python's own."""
    text = PENDULUM.replace('duration="0.5"', 'duration="0.05"')
    done = subprocess.run([sys.executable, "-X", "faulthandler", "-c", FUZZ, str(seed), "2500", text], text=True,
                          capture_output=True, check=False)
    assert done.returncode == 0, done.stderr[-3000:]
    assert int(done.stdout.split()[3]) > 60, done.stdout
