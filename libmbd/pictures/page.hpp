// Pages of studies: a template for each (libmbd/pictures/page), which is part of the library and fills itself, in the
// browser, from data in JSON.
#pragma once

#include <string>
#include <string_view>

namespace mbd::study {

// Embedded when the library is built (tools/cmake/study_pages.cpp.in).
struct PageFiles {
  std::string_view style, script;  // of both pages
  std::string_view accuracy, accuracy_script;
  std::string_view effects, effects_script;
};
PageFiles page_files();

// One file that needs nothing but itself. `title` is text, `json` the data: texts of users in it stay texts.
std::string filled_page(std::string_view html, std::string_view script, std::string_view title,
                        std::string_view json);

}  // namespace mbd::study
