// The page of a study of accuracy in a real browser: headless Chromium draws it as wide as a phone and as a desk, and
// prints it. Where there is no Chromium the tests are skipped.

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "libmbd/study/accuracy/accuracy_page.hpp"
#include "libmbd/study/effects/effects.hpp"
#include "libmbd/study/effects/effects_report.hpp"
#include "tests/support/browser.hpp"
#include "tests/support/synthetic_study.hpp"

namespace mbd::test::test_accuracy_browser {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

class AccuracyPageSlow : public BrowserTest {
 protected:
  void SetUp() override {
    BrowserTest::SetUp();
    if (IsSkipped()) return;
    page_ = accuracy_page(synthetic_study(), synthetic_scene());
    write_text(file("page.html"), page_);
  }

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

    const auto said = Json::parse(ask_in_frame(page_, R"(
      for (const e of d.querySelectorAll('details')) e.open = true;
      return [w.innerWidth, d.documentElement.scrollWidth, d.documentElement.scrollHeight,
        d.querySelectorAll('table').length];)",
                                               width));
    ASSERT_EQ(said.size(), 4U) << said.dump();
    const int inner = said[0], wide = said[1], high = said[2], tables = said[3];
    EXPECT_EQ(inner, width);
    EXPECT_LE(wide, inner);
    EXPECT_GT(high, height);  // all of it, with what opens
    EXPECT_EQ(tables, 7);  // advice for two quantities, orders, reference, its runs, ends, all runs
  }
}

// Filled, each text of the study is text, each link leads somewhere, and marks stand where they belong. Tried, and killed:
// texts as markup (innerHTML); links to the run before; marks of the front left out.
TEST_F(AccuracyPageSlow, FillsItself) {
  const auto said = Json::parse(ask(page_, R"(
    const text = document.querySelector('main').textContent, all = s => [...document.querySelectorAll(s)];
    const links = all('main a'), rows = all('table.runs tbody tr');
    const marked = row => row.className === 'front';
    return {ready: document.documentElement.dataset.ready, broken: all('parsererror').length, title: document.title,
      links: links.length,
      wrong: links.filter(a => {
        const row = document.querySelector(a.getAttribute('href'));
        return !row || parseInt(row.cells[0].textContent) !== parseInt(a.textContent.replace('run ', ''));
      }).length,
      ids: new Set(all('[id]').map(e => e.id)).size === all('[id]').length,
      clips: all('[clip-path]').every(e => document.querySelector(e.getAttribute('clip-path').slice(4, -1).replace(/"/g, ''))),
      strange: all('main bar, main rings, main transient').length,
      rows: rows.length, front: rows.filter(marked).length,
      marks: rows.every(r => marked(r) === r.cells[0].textContent.includes('●') &&
        marked(r) === [...r.cells].slice(1).some(c => c.textContent.startsWith('●'))),
      empty: all('main p, main td, main pre, main dd, main h3').filter(e => e.textContent.trim() === '').length,
      missing: ['D<&">.velocity', '< 3e-9', '<transient', 'bar<2>', 'stopped after 12 s', '6 settings were not tried',
        'up to time 7.2 s of 10 s', '<rings>', 'AMD EPYC', '--budget 120', 'Two ways to the same motion']
        .filter(part => !text.includes(part))};)"));
  EXPECT_EQ(said.value("ready", ""), "yes") << said.dump();
  EXPECT_EQ(said.at("title"), R"(four <bar> & "co": error against CPU time)");
  EXPECT_EQ(said.at("missing"), Json::array());
  for (const char* none : {"broken", "wrong", "strange", "empty"})
    EXPECT_EQ(said.at(none), 0) << none;
  for (const char* yes : {"ids", "clips", "marks"}) EXPECT_TRUE(said.at(yes)) << yes;
  EXPECT_GT(said.at("links"), 5);
  EXPECT_EQ(said.at("rows"), synthetic_study().points.size());
  EXPECT_GT(said.at("front"), 1);
}

TEST_F(AccuracyPageSlow, Prints) {
  const Output printed =
      chromium("--print-to-pdf=page.pdf --no-pdf-header-footer", file("page.html"));
  ASSERT_EQ(printed.status, 0) << printed.text << read_text(file("stderr"));
  const std::string pdf = read_text(file("page.pdf"));
  EXPECT_TRUE(pdf.starts_with("%PDF-"));
  EXPECT_GT(pdf.size(), 50000u);
}

// Heads sort their tables up and down, numbers by their size; a double click enlarges a picture about its point, Escape
// undoes it. Tried, and killed: numbers as words (in the test); the picture about its corner.
TEST_F(AccuracyPageSlow, SortsAndEnlarges) {
  const auto said = [&](const std::string& script, const std::string& from = "",
                        const std::string& to = "") {
    std::string page = page_;
    if (!from.empty()) page.replace(page.find(from), from.size(), to);
    return Json::parse(ask_in_frame(page, script, 390));
  };
  // Whether there is something to sort; whether it goes up after one click, and down after two.
  const std::string sorting = R"(
    const table = d.querySelector('table.runs'), heads = [...table.tHead.rows[0].cells];
    const i = heads.findIndex(h => h.textContent.includes('CPU'));
    [...table.tBodies[0].rows].forEach((r, k) => { r.cells[i].textContent = [10, 9, 100, 2.5][k % 4] + ' s'; });
    const values = () => [...table.tBodies[0].rows].map(r => parseFloat(r.cells[i].textContent)).filter(Number.isFinite);
    const sorted = sign => values().every((v, k, all) => k === 0 || sign * all[k - 1] <= sign * v);
    const before = values().length > 3 && new Set(values()).size > 2;
    heads[i].querySelector('button').click();
    const up = sorted(1) && !sorted(-1);
    heads[i].querySelector('button').click();
    return [before, up, sorted(-1), heads[i].getAttribute('aria-sort')].join();)";
  EXPECT_EQ(said(sorting), "true,true,true,descending");
  EXPECT_EQ(said(sorting, "Number.isFinite(number) ? number : text", "text"),
            "true,false,false,descending");
  EXPECT_EQ(said(R"(
    const svg = d.querySelector('figure svg'), r = svg.getBoundingClientRect(), b = () => svg.viewBox.baseVal;
    const x = Math.round(r.left + 0.75 * r.width), y = Math.round(r.top + 0.5 * r.height);
    const u = (x - r.left) / r.width, v = (y - r.top) / r.height, whole = [b().width, b().height];
    svg.dispatchEvent(new w.MouseEvent('dblclick', {clientX: x, clientY: y}));
    const close = (p, q) => Math.abs(p - q) < 1e-3 * whole[0];
    const near = close(b().width, whole[0] / 2) && close(b().x + u * b().width, u * whole[0]) &&
      close(b().y + v * b().height, v * whole[1]);
    svg.dispatchEvent(new w.KeyboardEvent('keydown', {key: 'Escape'}));
    return [near, b().x === 0 && b().width === whole[0]].join();)"),
            "true,true");
}

// One effect that costs fifteen times the whole model does not flatten the bars of the others: its own is cut, and its
// number stands; at 390 pixels letters are 10 pixels high at least, and nothing is wider.
TEST_F(AccuracyPageSlow, BarsOfEffectsAreReadable) {
  EffectsStudy study;
  study.model = "synthetic";
  study.tolerance = 1e-2;
  study.quantities.resize(1);
  study.quantities[0].name = "tip.displacement";
  const double ratios[] = {15.51, 0.9, 0.8, 0.75, 0.95, 0.7};
  for (const double ratio : ratios) {
    EffectRun& run = study.runs.emplace_back();
    run.ablation.effect = "effect " + std::to_string(study.runs.size());
    run.trial.complete = true;
    run.changes.resize(1);
    run.changes[0].rms = 0.1;
    run.cpu.ratios = {ratio};
  }
  page_ = effects_page(study);
  EXPECT_NE(page_.find(">-1451\\u003c"), std::string::npos);
  EXPECT_EQ(Json::parse(ask_in_frame(page_, R"(
    const svgs = [...d.querySelectorAll('figure svg')], bars = [...svgs[svgs.length - 1].querySelectorAll('rect[stroke]')];
    const widths = bars.map(b => b.getBoundingClientRect().width), letters = svgs.map(s => 11 * s.getScreenCTM().a);
    return [svgs.length, bars.length, Math.min(...widths.slice(1)) > 5, widths[0] < 200,
      bars.every(b => b.querySelector('title').textContent.startsWith('effect ')),
      Math.min(...letters) >= 10, d.documentElement.scrollWidth <= 390].join();)",
                                     390)),
            "2,6,true,true,true,true,true");
}

}  // namespace
}  // namespace mbd::test::test_accuracy_browser
