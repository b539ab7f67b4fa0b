#include "tests/support/browser.hpp"

#include <fmt/format.h>

#include <string_view>

#include "tests/support/machine.hpp"

namespace mbd::test {

void BrowserTest::SetUp() {
  if (shell("command -v chromium").status != 0)
    GTEST_SKIP() << "there is no Chromium to look at pages with; install it with "
                    "tools/install-dependencies --with-browser";
}

Output BrowserTest::chromium(const std::string& options, const std::filesystem::path& page) const {
  return here(
      fmt::format("timeout {} chromium --headless --no-sandbox --hide-scrollbars "
                  "--disable-gpu --enable-unsafe-swiftshader --user-data-dir=profile "
                  "--host-resolver-rules='MAP * ~NOTFOUND' {} {} 2>stderr",
                  whole_guard(200), options, quote("file://" + page.string())));
}

std::string BrowserTest::ask(std::string page, const std::string& script, int width,
                             int height) const {
  constexpr std::string_view before = "<pre id=\"answer\">", after = "</pre>";
  const std::size_t end = page.rfind("</body>");
  page.insert(end == std::string::npos ? page.size() : end, fmt::format(R"({}{}
<iframe id="unanswered" style="display:none"></iframe><script>(async () => {{
  const end = document.getElementById('unanswered').contentDocument;
  end.open();
  let a;
  try {{ a = await (async () => {{ {} }})(); }} catch (e) {{ a = {{error: String(e)}}; }}
  document.getElementById('answer').textContent = JSON.stringify(a);
  end.close();
}})();</script>)",
                                                                        before, after, script));
  write_text(file("asked.html"), page);
  const Output dom =
      chromium(fmt::format("--window-size={},{} --dump-dom", width, height), file("asked.html"));
  const std::size_t at = dom.text.find(before);
  std::string text;
  if (at != std::string::npos)
    text = dom.text.substr(at + before.size(), dom.text.find(after, at) - at - before.size());
  if (text.empty()) {
    ADD_FAILURE() << "no answer, status " << dom.status << ": " << dom.text.substr(0, 500)
                  << read_text(file("stderr"));
    return "null";
  }
  for (const auto& [entity, letter] : {std::pair{"&lt;", "<"}, {"&gt;", ">"}, {"&amp;", "&"}})
    for (std::size_t found = 0; (found = text.find(entity, found)) != std::string::npos; ++found)
      text.replace(found, std::string(entity).size(), letter);
  return text;
}

std::string BrowserTest::ask_in_frame(const std::string& page, const std::string& script, int width,
                                      int height) const {
  std::string text;
  for (const char c : page)
    text += c == '&' ? "&amp;" : c == '"' ? "&quot;" : c == '<' ? "&lt;" : std::string(1, c);
  return ask(fmt::format(R"page(<!DOCTYPE html><title>framed</title><script>
let framed;
const loaded = new Promise(done => framed = done);
</script><iframe id="framed" onload="framed()" style="border:0;width:{}px;height:{}px" srcdoc="{}"></iframe>)page",
                         width, height, text),
             R"(await loaded;
  const w = document.getElementById('framed').contentWindow, d = w.document;
  )" + script,
             1000, 1000);
}

}  // namespace mbd::test
