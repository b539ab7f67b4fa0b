// Forces of plug-ins (libmbd/plugin.h) for the extensions of a scene.
#pragma once

#include <filesystem>
#include <memory>

#include "elements/node/force.hpp"
#include "libmbd/scene/scene.hpp"

namespace mbd {

// Loads a plug-in and gives it to the extensions of the scene whose forces it has; it stays loaded to the end of the program.
// Throws Error with the file's name for what is no shared object or no plug-in, is of another version, has a force without name or
// function, or one that another plug-in of the scene has as well, and where no extension asks for any of its forces.
// Loading runs what is in the file: only files that are trusted.
void use_plugin(Scene& scene, const std::filesystem::path& file);

// The force of an extension, made with its values. Throws Error for one without plug-in, and with what the plug-in says.
std::shared_ptr<const Force> make_plugin_force(const ExtensionScene& extension);

// Whether the plug-in says that the force has a potential.
bool has_potential(const ExtensionScene& extension);

}  // namespace mbd
