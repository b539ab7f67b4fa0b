"""What `pip install .` calls (PEP 517): builds the package and the program mbd by CMake, and packs them as a wheel. Needs
CMake, a compiler and the libraries of tools/install-dependencies --with-python, and nothing from a network.

On x86-64 the wheel runs on any x86-64-v2 and is as fast as one for this machine: it has the shared library three times, of which
the loader takes one (MBD_PORTABLE in CMakeLists.txt). That compiles the kernels three times.

Environment:
  MBD_BUILD_DIR   a tree that is configured already (build/release), in place of build/pip
  MBD_CMAKE_ARGS  more options for CMake, as "-DMBD_PORTABLE=OFF -DMBD_NATIVE=ON" for this machine alone, in less than half the time
"""

import base64
import hashlib
import os
import pathlib
import platform
import re
import shlex
import subprocess
import sys
import sysconfig
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[2]


def _version():
    return re.search(r"project\(mbd VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text(encoding="utf-8"))[1]


def _metadata():
    readme = (ROOT / "tools" / "python" / "README.md").read_text(encoding="utf-8")
    return ("Metadata-Version: 2.1\nName: mbd\n"
            f"Version: {_version()}\nSummary: Flexible multibody dynamics\nLicense: see LICENSE\n"
            "Requires-Python: >=3.9\nRequires-Dist: numpy\n"
            "Provides-Extra: pictures\nRequires-Dist: pandas; extra == 'pictures'\n"
            "Requires-Dist: matplotlib; extra == 'pictures'\n"
            f"Description-Content-Type: text/markdown\n\n{readme}")


def _tag():
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    return f"{python}-{python}-{sysconfig.get_platform().replace('-', '_').replace('.', '_')}"


def _build():
    given = os.environ.get("MBD_BUILD_DIR")
    build = pathlib.Path(given).resolve() if given else ROOT / "build" / "pip"
    if not given:
        subprocess.run(["cmake", "-S", ROOT, "-B", build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                        "-DMBD_NATIVE=OFF", f"-DMBD_PORTABLE={'ON' if platform.machine() == 'x86_64' else 'OFF'}", "-DMBD_UNITY=ON", "-DMBD_PRECOMPILE=ON", "-DMBD_BUILD_TESTS=OFF", f"-DPython3_EXECUTABLE={sys.executable}",
                        *shlex.split(os.environ.get("MBD_CMAKE_ARGS", ""))], check=True)
    subprocess.run(["cmake", "--build", build, "--target", "mbd_python", "mbd_program", "--parallel",
                    str(len(os.sched_getaffinity(0)))], check=True)
    module = build / "python" / "mbd" / f"_mbd{sysconfig.get_config_var('EXT_SUFFIX')}"
    if not module.exists():
        raise SystemExit(f"{module} was not built: is Python's python3-dev of this version installed?")
    return build


def _library(build):
    """The shared library at all levels, under the name that the loader looks for; nothing where it is inside of the module."""
    if "MBD_PORTABLE:BOOL=ON" not in (build / "CMakeCache.txt").read_text(encoding="utf-8"):
        return []
    soname = "libmbd.so." + ".".join(_version().split(".")[:2])
    return [build / soname, *sorted(build.glob(f"glibc-hwcaps/*/{soname}"))]


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    info = pathlib.Path(metadata_directory) / f"mbd-{_version()}.dist-info"
    info.mkdir(parents=True, exist_ok=True)
    (info / "METADATA").write_text(_metadata(), encoding="utf-8")
    (info / "WHEEL").write_text(_wheel(), encoding="utf-8")
    return info.name


def _wheel():
    return f"Wheel-Version: 1.0\nGenerator: build_wheel.py\nRoot-Is-Purelib: false\nTag: {_tag()}\n"


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    build = _build()
    stem = f"mbd-{_version()}"
    files = {}
    for file in sorted((build / "python" / "mbd").iterdir()):
        if file.suffix in (".py", ".pyi", ".so") or file.name == "py.typed":
            files[f"mbd/{file.name}"] = file.read_bytes()
    for file in _library(build):
        files[f"mbd/{file.relative_to(build)}"] = file.read_bytes()
    files[f"{stem}.data/scripts/mbd"] = (build / "mbd").read_bytes()
    files[f"{stem}.dist-info/LICENSE"] = (ROOT / "LICENSE").read_bytes()
    files[f"{stem}.dist-info/METADATA"] = _metadata().encode()
    files[f"{stem}.dist-info/WHEEL"] = _wheel().encode()
    record = f"{stem}.dist-info/RECORD"
    lines = []
    for name, data in files.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
        lines.append(f"{name},sha256={digest},{len(data)}")
    files[record] = ("\n".join([*lines, f"{record},,"]) + "\n").encode()
    wheel = f"{stem}-{_tag()}.whl"
    with zipfile.ZipFile(pathlib.Path(wheel_directory) / wheel, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in files.items():
            entry = zipfile.ZipInfo(name)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = (0o100755 if "/scripts/" in name or ".so" in name else 0o100644) << 16
            archive.writestr(entry, data)
    return wheel
