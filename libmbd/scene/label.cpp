#include "libmbd/scene/label.hpp"

namespace mbd {

std::string label(std::string_view element, std::string_view name) {
  return excerpt(element) + (name.empty() ? "" : " \"" + excerpt(name) + "\"");
}

std::string said(const Source& source, const std::string& what) {
  return Error(source, what).what();
}

std::string_view element_of(const BeamScene& beam) {
  return std::holds_alternative<Straight>(beam.line) ? "beam"
         : std::holds_alternative<Arc>(beam.line)    ? "arc"
                                                     : "curve";
}

}  // namespace mbd
