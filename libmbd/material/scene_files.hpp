// The files that a scene is made of.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "libmbd/scene/scene.hpp"

namespace mbd {

// A name that an item states: as it is, or from the directory of the model.
std::filesystem::path file_beside(const Source& item, const std::string& name);

// All that a run of the scene depends on: its own file, those that it includes, meshes of sections, surfaces of shapes,
// plug-ins. Each once; none of a scene that a program made but those that its items name.
std::vector<std::string> files_of(const Scene& scene);

// checksum() of what is in it; of a file that cannot be read, that of nothing.
std::uint64_t checksum_of_file(const std::string& file);

}  // namespace mbd
