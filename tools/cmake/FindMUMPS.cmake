# Finds MUMPS (CeCILL-C), its sequential library in double precision: sparse LDL^T of symmetric indefinite
# systems. Debian's libmumps-seq-dev has no CMake config. Not linked: the library loads it (solvers/linear/inertia_solver.cpp).

find_path(MUMPS_INCLUDE_DIR dmumps_c.h)
find_library(MUMPS_LIBRARY dmumps_seq)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(MUMPS
  REQUIRED_VARS MUMPS_LIBRARY MUMPS_INCLUDE_DIR
  REASON_FAILURE_MESSAGE "On Debian: apt-get install libmumps-seq-dev")

mark_as_advanced(MUMPS_INCLUDE_DIR MUMPS_LIBRARY)
