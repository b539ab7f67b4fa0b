#include "libmbd/material/scene_files.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>

#include "libmbd/text/text.hpp"

namespace mbd {

std::filesystem::path file_beside(const Source& item, const std::string& name) {
  const std::filesystem::path file = name;
  return file.is_relative() ? std::filesystem::path(item.file).parent_path() / file : file;
}

std::vector<std::string> files_of(const Scene& scene) {
  std::vector<std::string> files;
  const auto add = [&files](const std::string& file) {
    if (!file.empty() && std::ranges::find(files, file) == files.end()) files.push_back(file);
  };
  const auto add_surface = [&add](const ShapeScene& shape) {
    if (!shape.mesh.empty()) add(file_beside(shape.source, shape.mesh).string());
  };
  add(scene.file);
  for (const std::string& file : scene.includes) add(file);
  for (const Section& section : scene.sections)
    if (section.shape && !section.shape->file.empty())
      add(file_beside(section.shape->source, section.shape->file).string());
  for (const BeamScene& beam : scene.beams)
    if (beam.shape) add_surface(*beam.shape);
  for (const BodyScene& body : scene.bodies)
    for (const ShapeScene& shape : body.shapes) add_surface(shape);
  for (const ExtensionScene& extension : scene.extensions) add(extension.plugin_file);
  return files;
}

std::uint64_t checksum_of_file(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  return checksum(text);
}

}  // namespace mbd
