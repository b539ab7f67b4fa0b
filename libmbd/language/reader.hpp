// From an XML model to a Scene. What a model may say stands in schema.hpp.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "libmbd/scene/scene.hpp"

namespace mbd {

// Parameters set from outside, in order: name and value, an expression.
using Overrides = std::vector<std::pair<std::string, std::string>>;

// Throws Error with file, line, item, what is wrong and what to do about it, for everything the schema
// does not allow. Names of other items are not looked up here but in compile().
Scene read_model(const std::filesystem::path& file, const Overrides& overrides = {});

// The same from a string; `file` is what messages call it.
Scene read_model_text(std::string_view text, const std::string& file = "model.xml",
                      const Overrides& overrides = {});

}  // namespace mbd
