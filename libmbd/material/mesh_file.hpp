// Surfaces of triangles from files of other programs, by the Open Asset Import Library.
#pragma once

#include <filesystem>

#include "libmbd/scene/shapes.hpp"

namespace mbd {

// Triangles of a .stl, .obj, .gltf or .glb file, in its units and axes; parts of a scene in their places; polygons are cut
// into triangles, points at one place are one, and triangles without area are left out. Throws Error where this build
// has no such library, the file is missing, is larger than 64 MB, is not to be read, has no triangles, more than
// most_triangles, or coordinates that are no numbers.
TriangleMesh read_mesh_file(const std::filesystem::path& file);

inline constexpr std::size_t most_triangles = 100'000;  // a page stays below 10 MB

}  // namespace mbd
