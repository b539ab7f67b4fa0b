#include "libmbd/pictures/page.hpp"

#include <array>
#include <utility>

#include "libmbd/text/html.hpp"
#include "libmbd/text/text.hpp"

namespace mbd::study {

std::string filled_page(std::string_view html, std::string_view script, std::string_view title,
                        std::string_view json) {
  const PageFiles files = page_files();
  const std::string title_text = xml_escaped(title), data = in_script(json);
  const std::array<std::pair<std::string_view, std::string_view>, 5> words = {
      {{"@TITLE@", title_text},
       {"@STYLE@", files.style},
       {"@DATA@", data},
       {"@SHARED@", files.script},
       {"@SCRIPT@", script}}};
  return filled(html, words);
}

}  // namespace mbd::study
