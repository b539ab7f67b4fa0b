// The page of a study of accuracy in a real browser: headless Chromium draws it as wide as a phone and as a desk, and
// prints it. Where there is no Chromium the tests are skipped.

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <string>

#include "libmbd/study/accuracy/accuracy_page.hpp"
#include "tests/support/machine.hpp"
#include "tests/support/shell.hpp"
#include "tests/support/synthetic_study.hpp"

namespace mbd::test::test_accuracy_browser {
namespace {

namespace fs = std::filesystem;

class AccuracyPageSlow : public testing::Test {
 protected:
  void SetUp() override {
    if (shell("command -v chromium").status != 0)
      GTEST_SKIP() << "there is no Chromium to look at the page with; install it with "
                      "tools/install-dependencies --with-browser";
    page_ = accuracy_page(synthetic_study(), synthetic_scene());
    write_text(directory_.path() / "page.html", page_);
  }

  // A profile of its own, so that nothing of the user's is touched; stops when it hangs.
  Output chromium(const std::string& options, const fs::path& page) const {
    return shell("cd " + quote(directory_.path().string()) + " && timeout " +
                 std::to_string(whole_guard(200)) +
                 " chromium --headless --no-sandbox --disable-gpu --hide-scrollbars "
                 "--user-data-dir=profile " +
                 options + " " + quote("file://" + page.string()) + " 2>stderr");
  }

  fs::path file(const std::string& name) const { return directory_.path() / name; }

  TemporaryDirectory directory_;
  std::string page_;
};

struct Png {
  bool is = false;
  std::uint32_t width = 0, height = 0;
};

Png read_png(const std::string& bytes) {
  const auto number = [&](std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i)
      value = value << 8U | static_cast<unsigned char>(bytes[at + i]);
    return value;
  };
  if (bytes.size() < 24 || !bytes.starts_with("\x89PNG\r\n\x1a\n") || bytes.substr(12, 4) != "IHDR")
    return {};
  return {true, number(16), number(20)};
}

// A page that shows another one in a frame of that width (the windows of headless Chromium are never narrower than
// 500) and says in its title how wide its contents have become, all that opens being open.
std::string measuring(const std::string& page, int width) {
  std::string text;
  for (const char c : page) text += c == '&' ? "&amp;" : c == '"' ? "&quot;" : std::string(1, c);
  return "<!DOCTYPE html><title>not measured</title><script>function measure(f) {"
         "const d = f.contentDocument, r = d.documentElement;"
         "for (const e of d.querySelectorAll('details')) e.open = true;"
         "document.title = ['measured', f.contentWindow.innerWidth, r.scrollWidth, r.scrollHeight, "
         "d.querySelectorAll('table').length].join(' '); }</script>"
         "<iframe onload='measure(this)' style='border:0;width:" +
         std::to_string(width) + "px;height:2000px' srcdoc=\"" + text + "\"></iframe>";
}

// Nothing stands beyond the edge of the window; what is wider scrolls in a box of its own.
TEST_F(AccuracyPageSlow, FitsPhoneAndDesk) {
  constexpr int height = 2400;
  write_text(file("blank.html"), "<!DOCTYPE html><title>blank</title>");
  for (const int width : {360, 1280}) {
    SCOPED_TRACE(width);
    const std::string window =
        "--window-size=" + std::to_string(width) + "," + std::to_string(height);
    const Output drawn = chromium(window + " --screenshot=page.png", file("page.html"));
    ASSERT_EQ(drawn.status, 0) << drawn.text << read_text(file("stderr"));
    const std::string picture = read_text(file("page.png"));
    const Png png = read_png(picture);
    ASSERT_TRUE(png.is);
    EXPECT_EQ(png.width, static_cast<std::uint32_t>(width));
    EXPECT_EQ(png.height, static_cast<std::uint32_t>(height));
    ASSERT_EQ(chromium(window + " --screenshot=blank.png", file("blank.html")).status, 0);
    const std::string blank = read_text(file("blank.png"));
    ASSERT_TRUE(read_png(blank).is);
    EXPECT_GT(picture.size(), 10 * blank.size() + 50000);

    write_text(file("measured.html"), measuring(page_, width));
    const Output dom = chromium(window + " --dump-dom", file("measured.html"));
    ASSERT_EQ(dom.status, 0) << dom.text << read_text(file("stderr"));
    const std::size_t at = dom.text.find("<title>measured ");
    ASSERT_NE(at, std::string::npos) << dom.text.substr(0, 500);
    int inner = 0, wide = 0, high = 0, tables = 0;
    ASSERT_EQ(std::sscanf(dom.text.c_str() + at, "<title>measured %d %d %d %d", &inner, &wide,
                          &high, &tables),
              4);
    EXPECT_EQ(inner, width);
    EXPECT_LE(wide, inner);
    EXPECT_GT(high, height);  // all of it, with what opens
    EXPECT_EQ(tables, 7);  // advice for two quantities, orders, reference, its runs, ends, all runs
  }
}

TEST_F(AccuracyPageSlow, Prints) {
  const Output printed =
      chromium("--print-to-pdf=page.pdf --no-pdf-header-footer", file("page.html"));
  ASSERT_EQ(printed.status, 0) << printed.text << read_text(file("stderr"));
  const std::string pdf = read_text(file("page.pdf"));
  EXPECT_TRUE(pdf.starts_with("%PDF-"));
  EXPECT_GT(pdf.size(), 50000u);
}

}  // namespace
}  // namespace mbd::test::test_accuracy_browser
