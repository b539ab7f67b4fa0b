"""Packages for Debian, made by CPack of the tree that is built: what they hold and need, and that they install on a bare Debian 12
(debootstrap's minbase, nothing else) and run there.

Tried in it, and killed: the libraries that are loaded left out of Depends; a package without shlibdeps; the module in site-packages;
the package for programs named libmbd-dev; headers left out.
"""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import urllib.request

import pytest

import mbd
from conftest import ROOT

BUILD = pathlib.Path(mbd.__file__).resolve().parents[2]
NAMES = {"mbd", "libmbd-multibody-dev", "python3-mbd"}


def run(*command, **more):
    done = subprocess.run([str(part) for part in command], text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False,
                          **more)
    assert done.returncode == 0, f"{command}\n{done.stdout[-5000:]}"
    return done.stdout


@pytest.fixture(scope="module")
def packages(tmp_path_factory):
    """File of each package."""
    if not (BUILD / "CPackConfig.cmake").exists():
        pytest.skip("not run from a build tree")
    if shutil.which("dpkg-shlibdeps") is None or shutil.which("cpack") is None:
        pytest.skip("dpkg-dev or CPack not installed")
    out = tmp_path_factory.mktemp("packages")
    run("cpack", "--config", BUILD / "CPackConfig.cmake", "-B", out, cwd=out)
    found = {file.name.split("_")[0]: file for file in out.glob("*.deb")}
    assert set(found) == NAMES
    return found


def field(package, name):
    return run("dpkg-deb", "--field", package, name).strip()


def files_of(package):
    return {line.split(None, 5)[5][1:] for line in run("dpkg-deb", "--contents", package).splitlines()}


def test_what_they_hold_and_need(packages):
    listed = {name: files_of(file) for name, file in packages.items()}
    assert "/usr/bin/mbd" in listed["mbd"]
    assert "/usr/include/mbd/mbd.hpp" in listed["libmbd-multibody-dev"]
    assert any(file.endswith("/cmake/mbd/mbdConfig.cmake") for file in listed["libmbd-multibody-dev"])
    assert "/usr/lib/python3/dist-packages/mbd/__init__.py" in listed["python3-mbd"]
    for one in NAMES:
        assert f"/usr/share/doc/{one}/copyright" in listed[one]
        assert field(packages[one], "Version") == mbd.__version__ and field(packages[one], "Architecture") != "all"
        for other in NAMES - {one}:
            assert not {file for file in listed[one] & listed[other] if not file.endswith("/")}
    for one in ("mbd", "python3-mbd"):
        needs = field(packages[one], "Depends")
        for library in ("libc6", "libklu", "libfmt", "libudunits2", "libmumps-seq", "libhdf5", "libmetis"):
            assert library in needs, needs
    assert f"python3 (<< 3.{sys.version_info.minor + 1})" in field(packages["python3-mbd"], "Depends")


def test_programs_are_built_with_the_library(packages, tmp_path):
    """The library that a package brings, used as a stranger would."""
    run("dpkg-deb", "--extract", packages["libmbd-multibody-dev"], tmp_path / "root")
    shutil.copytree(ROOT / "tools" / "example", tmp_path / "example")
    run("cmake", "-S", tmp_path / "example", "-B", tmp_path / "build", f"-DCMAKE_PREFIX_PATH={tmp_path}/root/usr",
        "-DCMAKE_BUILD_TYPE=None", "-DCMAKE_CXX_FLAGS=-O1")
    assert f"mbd_DIR:PATH={tmp_path}/root" in (tmp_path / "build" / "CMakeCache.txt").read_text()
    run("cmake", "--build", tmp_path / "build", "--target", "struck_arm")
    assert run(tmp_path / "build" / "struck_arm")


def mirror():
    """Where this machine has Debian 12 from."""
    listed = subprocess.run(["apt-get", "indextargets", "--format", "$(REPO_URI) $(RELEASE)", "Created-By: Packages"], text=True,
                            capture_output=True, check=False).stdout
    for line in listed.splitlines():
        uri, release = line.split()
        if release == "bookworm" and uri.startswith("http") and "debian" in uri:
            return uri.rstrip("/")
    return None


def test_they_run_on_a_bare_debian(packages, tmp_path):
    if os.geteuid() != 0 or shutil.which("debootstrap", path=os.environ["PATH"] + ":/usr/sbin") is None:
        pytest.skip("debootstrap not installed (tools/install-dependencies --with-packages), or no root")
    uri = mirror()
    try:
        urllib.request.urlopen(f"{uri}/dists/bookworm/Release", timeout=60).close()
    except (OSError, ValueError):
        pytest.skip("no mirror of Debian 12 answers")
    root = tmp_path / "root"
    environment = {"PATH": "/usr/sbin:/usr/bin:/sbin:/bin", "DEBIAN_FRONTEND": "noninteractive", "LC_ALL": "C",
                   **{key: value for key, value in os.environ.items() if key.lower().endswith("_proxy")}}
    try:
        run("debootstrap", "--variant=minbase", "bookworm", root, uri, env=environment)
        for file in packages.values():
            shutil.copy(file, root / "tmp")

        def inside(*command):
            return run("chroot", root, *command, env=environment)

        inside("apt-get", "install", "-y", "-q", "--no-install-recommends",
               *(f"/tmp/{packages[name].name}" for name in ("mbd", "python3-mbd")))
        shutil.copy(ROOT / "models" / "four_bar.xml", root / "tmp")
        # Status 0: and the numbers that the model expects.
        said = inside("mbd", "run", "/tmp/four_bar.xml", "--out", "/tmp/here", "--motion")
        assert "as expected" in said or "expect" in said, said
        assert len((root / "tmp" / "here" / "history.csv").read_text().splitlines()) > 600
        rows = int(inside("python3", "-c", "import mbd; r = mbd.Model('/tmp/four_bar.xml').run(estimate_error=False);"
                          "assert r.as_expected; print(len(r))"))
        assert rows > 600
        # Nothing of these packages is missing, and the package for programs can be installed as well.
        assert inside("dpkg", "--audit") == ""
        planned = inside("apt-get", "install", "--simulate", "--no-install-recommends",
                         f"/tmp/{packages['libmbd-multibody-dev'].name}")
        assert re.search(r"^Inst libmbd-multibody-dev", planned, re.M) and "libeigen3-dev" in planned
    finally:
        shutil.rmtree(root, ignore_errors=True)
