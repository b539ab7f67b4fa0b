"""Packages for Debian, made by CPack of the tree that is built: what they hold and need, and that they install on a bare Debian 12
(debootstrap's minbase, nothing else) and run there. Of a portable tree (build/packages of tools/packages, PYTHONPATH and all) also
that the loader takes each level of the library, and that nothing outside of the levels needs AVX.

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
CACHE = BUILD / "CMakeCache.txt"
PORTABLE = CACHE.exists() and "MBD_PORTABLE:BOOL=ON" in CACHE.read_text()
RUNTIME = "libmbd-multibody0.1"
NAMES = {"mbd", "libmbd-multibody-dev", "python3-mbd"} | ({RUNTIME} if PORTABLE else set())
# Levels of processors: what `mbd --version` calls the instructions of the library there, registers it uses, and those it has not.
LEVELS = {"x86-64-v2": ("SSE2", "xmm", "[yz]mm"), "x86-64-v3": ("AVX2", "ymm", "zmm"), "x86-64-v4": ("AVX-512", "zmm", "tmm")}
LOADER = "/lib64/ld-linux-x86-64.so.2"


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
    # Packed as fast as can be: what they hold is looked at, not how large they are.
    run("cpack", "--config", BUILD / "CPackConfig.cmake", "-D", "CPACK_DEBIAN_COMPRESSION_TYPE=gzip", "-B", out, cwd=out)
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
    for one in (RUNTIME,) if PORTABLE else ("mbd", "python3-mbd"):
        needs = field(packages[one], "Depends")
        for library in ("libc6", "libklu", "libfmt", "libudunits2", "libmumps-seq", "libhdf5", "libmetis"):
            assert library in needs, needs
    for one in NAMES - {RUNTIME} if PORTABLE else ():
        assert f"{RUNTIME} (= {mbd.__version__})" in field(packages[one], "Depends")
    assert f"python3 (<< 3.{sys.version_info.minor + 1})" in field(packages["python3-mbd"], "Depends")


def test_levels(packages, tmp_path):
    """What is wider than a level is in files of the next alone, which the loader takes."""
    if not PORTABLE:
        pytest.skip("not a portable tree")
    for file in packages.values():
        run("dpkg-deb", "--extract", file, tmp_path)
    usr = tmp_path / "usr"
    hwcaps = usr / "lib" / "glibc-hwcaps"
    of_level = {"x86-64-v2": [usr / "bin" / "mbd", usr / "lib" / "libmbd.so.0.1", *usr.glob("lib/python3/dist-packages/mbd/*.so")],
                "x86-64-v3": [hwcaps / "x86-64-v3" / "libmbd.so.0.1"], "x86-64-v4": [hwcaps / "x86-64-v4" / "libmbd.so.0.1"]}
    assert len(of_level["x86-64-v2"]) == 3 and len(list(hwcaps.iterdir())) == 2
    for level, files in of_level.items():
        _, own, too_wide = LEVELS[level]
        for file in files:
            code = run("objdump", "-d", "--no-show-raw-insn", file)
            assert f"%{own}" in code and re.search(f"%{too_wide}", code) is None, file
    for file in (usr / "bin" / "mbd", of_level["x86-64-v2"][-1]):  # an empty part is the working directory
        path = re.search(r"\[(.*)\]", next(line for line in run("readelf", "-d", file).splitlines() if "RUNPATH" in line))[1]
        assert all(part.startswith("$ORIGIN") for part in path.split(":")), path
    expected = {}
    for level in supported_levels():
        out = tmp_path / level
        says = run(LOADER, "--glibc-hwcaps-mask", level, usr / "bin" / "mbd", "--version")
        assert f", {LEVELS[level][0]}," in says, says
        run(LOADER, "--glibc-hwcaps-mask", level, usr / "bin" / "mbd", "run", ROOT / "models" / "shaft.xml", "--out", out)
        expected[level] = (out / "history.csv").read_text().count("\n")
    assert len(set(expected.values())) == 1


def supported_levels():
    said = subprocess.run([LOADER, "--help"], text=True, capture_output=True, check=True).stdout
    return [level for level in LEVELS if re.search(rf"{level} \(supported", said)]


def test_programs_are_built_with_the_library(packages, tmp_path):
    """The library that a package brings, used as a stranger would."""
    for one in NAMES - {"mbd", "python3-mbd"}:
        run("dpkg-deb", "--extract", packages[one], tmp_path / "root")
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
               *(f"/tmp/{packages[name].name}" for name in sorted(NAMES - {"libmbd-multibody-dev"})))
        shutil.copy(ROOT / "models" / "four_bar.xml", root / "tmp")
        # Status 0: and the numbers that the model expects.
        said = inside("mbd", "run", "/tmp/four_bar.xml", "--out", "/tmp/here", "--motion")
        assert "as expected" in said or "expect" in said, said
        assert len((root / "tmp" / "here" / "history.csv").read_text().splitlines()) > 600
        rows = int(inside("python3", "-c", "import mbd; r = mbd.Model('/tmp/four_bar.xml').run(estimate_error=False);"
                          "assert r.as_expected; print(len(r))"))
        assert rows > 600
        for level in supported_levels() if PORTABLE else ():
            assert f", {LEVELS[level][0]}," in inside(LOADER, "--glibc-hwcaps-mask", level, "/usr/bin/mbd", "--version")
        # Nothing of these packages is missing, and the package for programs can be installed as well.
        assert inside("dpkg", "--audit") == ""
        planned = inside("apt-get", "install", "--simulate", "--no-install-recommends",
                         f"/tmp/{packages['libmbd-multibody-dev'].name}")
        assert re.search(r"^Inst libmbd-multibody-dev", planned, re.M) and "libeigen3-dev" in planned
    finally:
        shutil.rmtree(root, ignore_errors=True)
