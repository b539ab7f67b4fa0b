"""The package itself: stubs are current, everything public says what it is, and it can be installed without a network."""

import inspect
import os
import pathlib
import shutil
import subprocess
import sys

import pytest

import mbd
from conftest import ROOT

BUILD = pathlib.Path(mbd.__file__).resolve().parents[2]


def test_stubs_are_current():
    done = subprocess.run([sys.executable, ROOT / "tools" / "python" / "make_stubs.py", "--check"], check=False)
    assert done.returncode == 0, "run tools/python/make_stubs.py"
    compile((ROOT / "tools" / "python" / "mbd" / "__init__.pyi").read_text(encoding="utf-8"), "__init__.pyi", "exec")


def test_everything_public_has_a_docstring():
    for name in mbd.__all__:
        thing = getattr(mbd, name)
        if not (inspect.isclass(thing) or inspect.isfunction(thing)):
            continue
        assert inspect.getdoc(thing), name
        if inspect.isclass(thing) and issubclass(thing, (mbd.Model, mbd.Results, mbd.Stepper, mbd.State, mbd.Sweep)):
            for key, member in vars(thing).items():
                if key.startswith("_") or key in ("keys",):
                    continue
                assert inspect.getdoc(member), f"{name}.{key}"


def test_install(tmp_path):
    """pip install . in a fresh virtual environment, without network, of the tree that is built."""
    if not (BUILD / "CMakeCache.txt").exists() or "mbd_python" not in (BUILD / "build.ninja").read_text():
        pytest.skip("not run from a build tree")
    if shutil.which("cmake") is None or subprocess.run([sys.executable, "-c", "import ensurepip"], check=False).returncode:
        pytest.skip("Python has no ensurepip, or there is no CMake")
    venv = tmp_path / "venv"
    subprocess.run([sys.executable, "-m", "venv", "--system-site-packages", venv], check=True)
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    environment.update(MBD_BUILD_DIR=str(BUILD), PIP_NO_INDEX="1", PIP_NO_CACHE_DIR="1", PIP_DISABLE_PIP_VERSION_CHECK="1")
    done = subprocess.run([venv / "bin" / "pip", "install", ROOT], env=environment, text=True, capture_output=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    code = ("import mbd; assert mbd.__file__.startswith(%r), mbd.__file__; "
            "print(len(mbd.Model(%r).run(estimate_error=False)))" % (str(venv), str(ROOT / "models" / "pendulum.xml")))
    done = subprocess.run([venv / "bin" / "python", "-c", code], env=environment, text=True, capture_output=True, check=False,
                          cwd=tmp_path)
    assert done.returncode == 0 and int(done.stdout) > 10, done.stderr
    assert subprocess.run([venv / "bin" / "mbd", "--version"], env=environment, check=False, capture_output=True).returncode == 0
