"""Untested: Spack is not there where this was written."""

import pathlib

from spack.package import *


class Mbd(CMakePackage):
    """Flexible multibody dynamics: how machines made of rigid and bending parts move, and what forces that takes."""

    git = "file://" + str(pathlib.Path(__file__).resolve().parents[5])
    # url = "…/mbd-0.1.0.tar.gz"
    license("BSD-3-Clause")

    version("main", branch="main")
    # version("0.1.0", sha256="…")

    variant("python", default=True, description="The Python module")
    variant("hdf5", default=True, description="Write run.h5")
    variant("metis", default=True, description="Order large frames by nested dissection")
    variant("images", default=True, description="Write PNG and WebP")

    generator("ninja")
    depends_on("cxx", type="build")
    depends_on("cmake@3.25:", type="build")
    depends_on("cli11", type="build")
    depends_on("nlohmann-json@3:", type="build")
    depends_on("eigen@3.4")
    depends_on("fmt")
    depends_on("mumps~mpi+double+shared")
    depends_on("suite-sparse")
    depends_on("sundials@6+ida+kinsol")
    depends_on("tinyxml2")
    depends_on("udunits")
    depends_on("yaml-cpp")
    depends_on("zlib-api")
    depends_on("hdf5@1.10.3:~mpi", when="+hdf5")
    depends_on("metis@5~int64", when="+metis")
    depends_on("libpng", when="+images")
    depends_on("libwebp+libwebpmux", when="+images")
    depends_on("python@3.9:", when="+python", type=("build", "link", "run"))
    depends_on("py-pybind11@2.9:", when="+python", type="build")
    depends_on("py-numpy", when="+python", type="run")
    extends("python", when="+python")

    def cmake_args(self):
        mumps = self.spec["mumps"]
        return [
            self.define("MBD_BUILD_TESTS", False),
            self.define("MBD_WERROR", False),
            self.define("MBD_UNITY", True),
            self.define("MUMPS_LIBRARY", join_path(mumps.prefix.lib, "libdmumps.so")),  # Debian calls it libdmumps_seq
            self.define_from_variant("MBD_PYTHON", "python"),
            self.define_from_variant("MBD_HDF5", "hdf5"),
            self.define_from_variant("MBD_METIS", "metis"),
            self.define_from_variant("MBD_IMAGES", "images"),
        ]

    @run_after("install")
    def install_python(self):
        if self.spec.satisfies("+python"):
            install_tree(join_path(self.build_directory, "python", "mbd"), join_path(python_platlib, "mbd"))

    @run_after("install")
    @on_package_attributes(run_tests=True)
    def check_four_bar(self):
        Executable(self.prefix.bin.mbd)("run", join_path(self.stage.source_path, "models", "four_bar.xml"))
