import os
import pathlib
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]


@pytest.fixture
def models():
    return ROOT / "models"


@pytest.fixture
def program():
    """program("run", …) runs mbd; returns its output, or fails with it."""

    def run(*arguments, status=0, cwd=None):
        done = subprocess.run([os.environ["MBD_PROGRAM"], *map(str, arguments)], cwd=cwd, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
        assert done.returncode == status, done.stdout
        return done.stdout

    return run


def same_bits(a, b):
    """Whether two arrays have the same shape and bytes."""
    import numpy

    a, b = numpy.ascontiguousarray(a, dtype=float), numpy.ascontiguousarray(b, dtype=float)
    return a.shape == b.shape and a.tobytes() == b.tobytes()


# A rod on a hinge, let go: shorter than the models of the repository.
PENDULUM = """<mbd name="rod">
  <parameter name="W" value="2"/> <parameter name="L" value="1 m"/>
  <body name="arm" at="L 0 0" mass="W" inertia="0.1 0.1 0.1"/>
  <revolute name="hinge" between="ground arm" at="0 0 0" axis="0 1 0"/>
  <gravity acceleration="0 0 -9.81"/>
  <transient duration="0.5" step="1 ms"/>
  <record name="tip" at="arm" quantities="displacement velocity"/>
  <record name="hinge" joint="hinge" quantities="angle reaction_force"/>
</mbd>
"""


@pytest.fixture
def pendulum():
    import mbd

    return mbd.Model(text=PENDULUM, file="rod.xml")
