// Pages in headless Chromium, which draws them and says what they show. Where there is none, tests of pages are skipped.
#pragma once

#include <string>

#include "tests/support/program_test.hpp"

namespace mbd::test {

class BrowserTest : public ProgramTest {
 protected:
  void SetUp() override;

  // Chromium, with a profile of its own and nobody to fetch from; stops when it hangs.
  Output chromium(const std::string& options, const std::filesystem::path& page) const;

  // What `script`, the body of an asynchronous function at the end of the page, returns, as text in JSON; what it throws is
  // in `error`. It may take any time: Chromium says what is on a page once all its frames have come to an end, and one of them
  // does when the answer is there.
  std::string ask(std::string page, const std::string& script, int width = 1000,
                  int height = 700) const;

  // The same of a page in a frame that is so wide (windows of headless Chromium are never narrower than 500 pixels); it is
  // loaded when the script begins, which knows its document as `d` and its window as `w`.
  std::string ask_in_frame(const std::string& page, const std::string& script, int width,
                           int height = 2000) const;
};

}  // namespace mbd::test
