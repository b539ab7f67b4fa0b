#include "libmbd/scene/label.hpp"

namespace mbd {

std::string label(std::string_view element, std::string_view name) {
  return excerpt(element) + (name.empty() ? "" : " \"" + excerpt(name) + "\"");
}

std::string said(const Source& source, const std::string& what) {
  return Error(source, what).what();
}

}  // namespace mbd
