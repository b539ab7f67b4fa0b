// Pages of `mbd view`: in headless Chromium, which says what it shows, and as files. Without Chromium, or in a build
// without pages, what needs them is skipped.
//
// Tried in the page and in the library, and killed: the frame after the one that is set; single precision from the origin
// in place of the scene's centre; quaternions w first; parts numbered from 1; resultants from the second number on; speeds
// without rotation; nothing drawn; parts that stay when hidden; pages of any size. In the tests themselves: a script from
// elsewhere, and something wider than a phone.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "libmbd/results/history.hpp"
#include "tests/support/browser.hpp"

namespace mbd::test::test_view {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

const fs::path models = fs::path(MBD_SOURCE_DIR) / "models";

// Of a build without pages: nothing is asked of it.
void skip_without_pages(const Output& made) {
  if (made.text.find("built without three.js") != std::string::npos)
    GTEST_SKIP() << "this mbd makes no pages: " << made.text;
  ASSERT_EQ(made.status, 0) << made.text;
}
const std::string view_pendulum =
    "view " + quote((models / "pendulum.xml").string()) + " --out p.html";

class ViewFile : public ProgramTest {
 protected:
  void SetUp() override { skip_without_pages(mbd(view_pendulum)); }
};

class ViewPageSlow : public BrowserTest {
 protected:
  void SetUp() override {
    BrowserTest::SetUp();
    if (!IsSkipped()) skip_without_pages(mbd(view_pendulum));
  }
  Json ask_page(const std::string& page, const std::string& script) const {
    return Json::parse(ask(read_text(file(page)), script));
  }
};

// Frame k set, positions and displacements of records read from the page are the rows of history.csv, to single precision
// of what lies about the scene's centre: 1e-7 of the scene's size and the displacement, every coordinate, some frames.
// And the beam that ends there is drawn there.
struct Placed {
  const char *model, *record, *beam;
};
class ViewPositionsSlow : public ViewPageSlow, public testing::WithParamInterface<Placed> {};

TEST_P(ViewPositionsSlow, AreThoseOfTheHistory) {
  write_text(file("far.xml"), far_away);
  const Placed& c = GetParam();
  run(c.model, "--view");
  const mbd::History history = read_history(file(c.model));
  std::vector<std::size_t> frames;
  for (std::size_t i = 0; i <= 6; ++i) frames.push_back((history.rows() - 1) * i / 6);
  const Json answer = ask_page(c.model + std::string("/view.html"),
                               fmt::format(R"(
      const all = {}, beam = mbdView.parts.find(p => p.kind === 'beam' && p.name === '{}');
      return {{frames: mbdView.frames, size: JSON.parse(document.getElementById('drawing').textContent).size,
        rows: all.map(k => {{
          mbdView.setFrame(k);
          const r = mbdView.record('{}');
          let drawn = null;
          if (beam) {{
            const p = beam.objects[0].geometry.attributes.position.array, n = beam.fine.length, m = p.length / 3 / (n + 2);
            drawn = [0, 0, 0];
            for (let i = 0; i < m; ++i) for (let j = 0; j < 3; ++j) drawn[j] += p[3 * ((n - 1) * m + i) + j] / m;
          }}
          return {{frame: mbdView.frame(), key: mbdView.keys[k], ...r, drawn}};
        }}), centre: JSON.parse(document.getElementById('drawing').textContent).centre}};)",
                                           Json(frames).dump(), c.beam, c.record));
  ASSERT_TRUE(answer.contains("rows")) << answer.dump();
  EXPECT_EQ(answer.at("frames"), history.rows());
  const auto columns =
      choose_columns(history, std::vector{std::string(c.record) + ".displacement"});
  double most = answer.at("size");
  for (const std::size_t k : columns)
    for (const double value : history.values[k]) most = std::max(most, std::abs(value));
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const Json& row = answer.at("rows").at(i);
    EXPECT_EQ(row.at("frame"), frames[i]);
    EXPECT_EQ(row.at("key").get<double>(), history.values[0][frames[i]]);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(row.at("displacement").at(k).get<double>(), history.values[columns[k]][frames[i]],
                  1e-7 * most)
          << frames[i];
      if (c.beam[0] != '\0') {
        EXPECT_NEAR(row.at("drawn").at(k).get<double>() + answer.at("centre").at(k).get<double>(),
                    row.at("position").at(k).get<double>(), 1e-6 * most);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Models, ViewPositionsSlow,
                         testing::Values(Placed{"four_bar", "C", "bar2"}, Placed{"shaft", "M", ""},
                                         Placed{"swept_cantilever", "tip", "blade"},
                                         Placed{"portal_frame", "B", "left"},
                                         Placed{"shallow_arch", "crown", ""},
                                         Placed{"far", "tip", "two"}),
                         [](const auto& of) { return std::string(of.param.model); });

// How many colours the picture has.
constexpr const char* colours = R"(
  const colours = () => {
    const c = document.getElementById('canvas'), d = document.createElement('canvas');
    d.width = c.width; d.height = c.height;
    const g = d.getContext('2d');
    g.drawImage(c, 0, 0);
    return new Set(new Uint32Array(g.getImageData(0, 0, d.width, d.height).data.buffer));
  };)";

TEST_F(ViewPageSlow, DrawsAndHides) {
  run("pendulum", "--view --frames 20");
  const Json answer = ask_page("pendulum/view.html", std::string(colours) + R"(
    const all = colours().size, first = document.getElementById('canvas').toDataURL();
    mbdView.setFrame(10);
    const moved = document.getElementById('canvas').toDataURL() !== first;
    for (const b of document.querySelectorAll('#parts .kind input')) if (b.checked) b.click();
    document.getElementById('grid').click();
    return {all, moved, none: colours().size};)");
  EXPECT_GT(answer.at("all"), 100) << answer.dump();
  EXPECT_EQ(answer.at("moved"), true);
  EXPECT_EQ(answer.at("none"), 1);  // so many colours has a picture with nothing in it
}

// What a frame asks of the graphics processor: ten times the beams and joints, the same calls and as many uploads, of no more
// than the surfaces' bound (45,000 points, 24 bytes each) and 64 bytes a solid. With 200 beams a frame took 754 calls and 400
// uploads when each part was drawn by itself. Half of them hidden, half is sent; a joint that is chosen is seen to be.
// Tried in the page, and killed: no batches; a surface of each beam by itself; batches that are filled but once; colours
// that are sent but once.
constexpr const char* count_work = R"(<script>
  const work = {calls: 0, uploads: 0, bytes: 0};
  for (const context of [window.WebGLRenderingContext, window.WebGL2RenderingContext]) {
    const all = context.prototype, counted = (of, name, count) => {
      const plain = of[name];
      if (plain) of[name] = function (...given) { count(...given); return plain.apply(this, given); };
    };
    for (const name of ['drawElements', 'drawArrays', 'drawElementsInstanced', 'drawArraysInstanced'])
      counted(all, name, () => ++work.calls);
    counted(all, 'bufferData', (target, data) => { ++work.uploads; work.bytes += data.byteLength; });
    counted(all, 'bufferSubData', (target, from, data) => { ++work.uploads; work.bytes += data.byteLength; });
    const extension = all.getExtension;
    all.getExtension = function (name) {
      const found = extension.call(this, name);
      if (found && name === 'ANGLE_instanced_arrays' && !this.watched)
        for (const call of ['drawElementsInstancedANGLE', 'drawArraysInstancedANGLE']) counted(found, call, () => ++work.calls);
      if (name === 'ANGLE_instanced_arrays') this.watched = true;
      return found;
    };
  }
</script>)";

TEST_F(ViewPageSlow, WorkOfAFrameIsThatOfFewCalls) {
  const auto work_of = [&](int beams) {
    write_text(file("many.xml"), fmt::format(R"(<mbd name="many">
      <section name="s"><stiffness EA="1e6" GA2="4e5" GA3="4e5" GJ="80" EI2="100" EI3="100"/>
        <mass per_length="1" inertia="2e-4 1e-4 1e-4"/></section>
      <repeat count="{}" index="i">
        <beam name="b{{i}}" section="s" from="0 0.3*i 0" to="1 0.3*i 0" normal="0 0 1" elements="2"/>
        <revolute name="j{{i}}" between="ground b{{i}}.start" axis="0 1 0"/>
      </repeat>
      <gravity acceleration="0 0 -9.81"/>
      <transient duration="0.1" step="0.01" rho_infinity="0"/>
    </mbd>)",
                                             beams));
    run("many", "--view");
    std::string page = read_text(file("many/view.html"));
    page.insert(page.find("<style>"), count_work);
    return Json::parse(ask(page, R"(
      const of = what => {
        const before = {...work};
        what();
        return Object.fromEntries(Object.keys(work).map(k => [k, work[k] - before[k]]));
      };
      mbdView.setFrame(1);
      const picture = () => document.getElementById('canvas').toDataURL(), answer = {};
      answer.all = of(() => mbdView.setFrame(5));
      const plain = picture(), joint = mbdView.parts.find(p => p.name === 'j1');
      mbdView.choose(joint);
      answer.seen = picture() !== plain;
      mbdView.choose(null);
      answer.back = picture() === plain;
      for (const b of document.querySelectorAll('#parts .row input[aria-label^="show b"]')) if (b.checked) b.click();
      answer.joints = of(() => mbdView.setFrame(7));
      return answer;)"));
  };
  const Json few = work_of(20), many = work_of(60);
  EXPECT_LE(few.at("all").at("calls"), 16) << few.dump();
  EXPECT_EQ(many.at("all").at("calls"), few.at("all").at("calls")) << many.dump();
  EXPECT_EQ(many.at("all").at("uploads"), few.at("all").at("uploads")) << many.dump();
  EXPECT_LE(many.at("all").at("uploads"), 8);
  EXPECT_LE(many.at("all").at("bytes"), 45000 * 24 + 64 * 4 * 60) << many.dump();
  for (const Json& answer : {few, many}) {
    EXPECT_EQ(answer.at("seen"), true);
    EXPECT_EQ(answer.at("back"), true);
    EXPECT_EQ(answer.at("joints").at("calls"), answer.at("all").at("calls").get<int>() - 1);
  }
}

// A click on a part of the picture, and on its name, shows its name, its line and what stands there; beside it nothing.
TEST_F(ViewPageSlow, ClicksNameTheParts) {
  run("four_bar", "--view --frames 30");
  const Json answer = ask_page("four_bar/view.html", R"(
    mbdView.setFrame(9);
    mbdView.fit(mbdView.views.z);
    const canvas = document.getElementById('canvas'), said = {};
    const click = (x, y) => {
      for (const type of ['pointerdown', 'click'])
        canvas.dispatchEvent(new MouseEvent(type, {clientX: x, clientY: y, bubbles: true}));
      return document.getElementById('details').textContent;
    };
    for (const p of mbdView.parts.filter(p => p.kind === 'beam' || p.kind === 'joint')) {
      const details = click(...mbdView.screen(p));
      said[p.name] = [mbdView.chosen(), details.includes(p.element + ' ' + p.name), details.includes('four_bar.xml:' + p.line)];
    }
    const r = canvas.getBoundingClientRect();
    const nothing = [click(r.left + 3, r.bottom - 3), mbdView.chosen()];
    const row = [...document.querySelectorAll('#parts button')].find(b => b.textContent === 'bar2');
    row.click();
    return {said, nothing, by_name: document.getElementById('details').textContent};)");
  for (const std::string name : {"bar1", "bar2", "bar3", "A", "B", "C", "D"})
    EXPECT_EQ(answer.at("said").at(name), Json({name, true, true})) << answer.dump();
  EXPECT_EQ(answer.at("said").size(), 7U);
  EXPECT_TRUE(answer.at("nothing").at(1).is_null());
  const std::string details = answer.at("by_name");
  EXPECT_NE(details.find("beam bar2"), std::string::npos);
  EXPECT_NE(details.find(R"(<beam name="bar2" section="box16")"), std::string::npos) << details;
  EXPECT_NE(details.find("0.24 m"), std::string::npos) << details;
}

// Nothing is asked for elsewhere; a page that would is found out.
TEST_F(ViewPageSlow, LoadsNothing) {
  run("pendulum", "--view --frames 20");
  const std::string page = read_text(file("pendulum/view.html"));
  // It plays until it has moved: a busy machine takes its time.
  const auto ask_with = [&](const std::string& more) {
    std::string watched = page;
    watched.insert(
        watched.find("<style>"),
        "<script>const blocked = []; document.addEventListener('securitypolicyviolation', "
        "e => blocked.push(e.blockedURI));</script>" +
            more);
    return Json::parse(ask(watched, R"(
      document.getElementById('speed').value = '10';
      mbdView.play(true);
      while (mbdView.frame() === 0) await new Promise(done => setTimeout(done, 20));
      return {requests: performance.getEntriesByType('resource').length + blocked.length, frame: mbdView.frame()};)"));
  };
  const Json answer = ask_with("");
  EXPECT_EQ(answer.at("requests"), 0) << answer.dump();
  EXPECT_GT(answer.at("frame"), 0);
  EXPECT_GT(ask_with("<script src=\"https://example.org/x.js\"></script>").at("requests"), 0);
}

// At 390 pixels nothing stands beyond the edge, all that opens being open, with a part chosen, in light and dark.
TEST_F(ViewPageSlow, FitsAPhone) {
  run("swept_cantilever", "--view");
  for (const bool too_wide : {false, true}) {
    std::string page = read_text(file("swept_cantilever/view.html"));
    if (too_wide) page.insert(page.find("<main>"), "<div style='width:420px'>wide</div>");
    const Json answer = Json::parse(ask_in_frame(page, R"(
      while (!w.mbdView) await new Promise(done => setTimeout(done, 20));
      const all = [];
      for (const e of d.querySelectorAll('details')) e.open = true;
      for (let i = 0; i < 2; ++i) {
        w.mbdView.choose(w.mbdView.parts[i]);
        d.getElementById('theme').click();
        all.push(d.documentElement.scrollWidth);
      }
      return {inner: w.innerWidth, all, canvas: d.getElementById('canvas').clientWidth};)",
                                                 390, 800));
    ASSERT_TRUE(answer.contains("inner")) << answer.dump();
    EXPECT_EQ(answer.at("inner"), 390);
    for (const Json& wide : answer.at("all")) {
      if (too_wide)
        EXPECT_GT(wide, 390);
      else
        EXPECT_LE(wide, 390);
    }
    EXPECT_GT(answer.at("canvas"), 330);
  }
}

// The legend against closed forms: a strip under a tip moment (M the same everywhere, the tip at the end of an arc), and
// a stiff arm at 3 rad/s.
TEST_F(ViewPageSlow, LegendIsThatOfClosedForms) {
  write_text(file("arc.xml"), R"(<mbd name="arc"><section name="s">
      <stiffness EA="1e6" GA2="4e5" GA3="4e5" GJ="80" EI2="100" EI3="100"/></section>
    <beam name="b" section="s" from="0 0 0" to="2 0 0" normal="0 0 1" elements="4"/>
    <fixed name="clamp" between="ground b.start"/><load at="b.end" moment="0 -25 0"/><static/>
    <record name="tip" at="b.end" quantities="displacement"/></mbd>)");
  run("arc", "--view");
  const std::string legend = R"(
    const said = {};
    for (const o of document.querySelectorAll('#colour option')) {
      mbdView.colourBy(o.value);
      if (o.value) said[o.value] = [document.getElementById('legend-title').textContent,
        Number(document.getElementById('legend-low').textContent), Number(document.getElementById('legend-high').textContent)];
    }
    return said;)";
  Json answer = ask_page("arc/view.html", legend);
  EXPECT_EQ(answer.at("M").at(0), "bending moment |M| [N.m]");
  EXPECT_EQ(answer.at("M").at(1), 0.0);  // no load
  EXPECT_EQ(answer.at("M").at(2), 25.0);
  EXPECT_EQ(answer.at("energy").at(0), "strain energy per length [J/m]");
  EXPECT_NEAR(answer.at("energy").at(2).get<double>(), 0.5 * 25.0 * 25.0 / 100.0, 1e-3);
  const double radius = 4.0, angle = 0.5;
  const double moved = std::hypot(radius * std::sin(angle) - 2.0, radius * (1.0 - std::cos(angle)));
  EXPECT_EQ(answer.at("displacement").at(0), "displacement [m]");
  EXPECT_NEAR(answer.at("displacement").at(2).get<double>(), moved, 1e-3 * moved);
  EXPECT_FALSE(answer.contains("velocity"));

  write_text(file("arm.xml"), R"(<mbd name="arm"><section name="s">
      <stiffness EA="1e8" GA2="4e7" GA3="4e7" GJ="1e6" EI2="1e6" EI3="1e6"/>
      <mass per_length="1" inertia="1e-3 5e-4 5e-4"/></section>
    <body name="hub" mass="1" inertia="1 1 1"/>
    <beam name="b" section="s" from="1 0 0" to="2 0 0" normal="0 0 1"/>
    <fixed name="on" between="hub b.start"/>
    <revolute name="r" between="ground hub" at="0 0 0" axis="0 0 1"/>
    <drive joint="r" rate="t &lt; 1 ? 3*t*t*(3 - 2*t) : 3"/>
    <transient duration="2" step="0.01"/>
    <record name="tip" at="b.end" quantities="velocity"/></mbd>)");
  run("arm", "--view");
  answer = ask_page("arm/view.html", legend);
  EXPECT_EQ(answer.at("velocity").at(0), "velocity [m/s]");
  EXPECT_EQ(answer.at("velocity").at(1), 0.0);  // at rest at the start
  EXPECT_NEAR(answer.at("velocity").at(2).get<double>(), 6.0, 0.005);
  // N = m w^2 (L^2 - x^2)/2 at the first quadrature point, x = 1 + (1 - sqrt(0.6))/2.
  EXPECT_NEAR(answer.at("N").at(2).get<double>(), 12.43, 0.2);
  answer = ask_page("arm/view.html",
                    "mbdView.setFrame(200); document.getElementById('now').click();" + legend);
  EXPECT_NEAR(answer.at("velocity").at(1).get<double>(), 3.0, 0.003);
  EXPECT_NEAR(answer.at("velocity").at(2).get<double>(), 6.0, 0.005);
}

// Colours by stresses, whose largest is in the legend, against closed forms. A rectangle of 20 by 40 mm: in bending about both
// axes the sum of M h/2 / I at a corner; in torsion sqrt(3) times the shear stress in the middle of its long sides, by
// Saint-Venant's series; under a tension N fibres at 30 degrees carry cos^2 of N/A. Colours differ around the section.
// Tried in the library and in the page, and killed: no points between corners; half of what stands beside the diagonal; the
// next resultant's share in place of a fibre's.
double torsion_of_rectangle(double torque, double width,
                            double height) {  // its largest shear stress
  const double a = std::min(width, height) / 2.0, b = std::max(width, height) / 2.0;
  const double pi = std::acos(-1.0);
  double moment = 0.0, stress = 0.0;
  for (int n = 1; n < 200; n += 2) {
    const double angle = n * pi * b / (2.0 * a);
    moment += std::tanh(angle) / std::pow(n, 5);
    if (angle < 300.0) stress += 1.0 / (n * n * std::cosh(angle));
  }
  const double rigidity =
      8.0 * a * a * a * 2.0 * b / 3.0 * (1.0 - 192.0 / std::pow(pi, 5) * a / b * moment);
  return torque / rigidity * 2.0 * a * (1.0 - 8.0 / (pi * pi) * stress);
}

TEST_F(ViewPageSlow, StressesOnTheSurfaceAreThoseOfClosedForms) {
  const auto legend_of = [&](const std::string& load, const std::string& quantity,
                             const std::string& material) {
    write_text(file("bar.xml"), fmt::format(R"(<mbd name="bar">
      <material name="steel" E="200 GPa" nu="0.3"/>
      <material name="ply" EL="140 GPa" ET="9 GPa" GLT="5 GPa" nuLT="0.3" nuTN="0.4"/>
      <section name="bar"><rectangle width="20 mm" height="40 mm" {}/></section>
      <beam name="b" section="bar" from="0 0 0" to="2 0 0" normal="0 0 1" elements="2" order="3"/>
      <fixed name="clamp" between="ground b.start"/>
      <load name="f" at="b.end" {}/>
      <static/>
    </mbd>)",
                                            material, load));
    run("bar", "--motion");
    const Output made = mbd("view bar --stresses");
    EXPECT_EQ(made.status, 0) << made.text;
    return ask_page("bar/view.html", std::string(colours) + fmt::format(R"(
      mbdView.setFrame(mbdView.frames - 1);
      const plain = colours().size;
      mbdView.colourBy('{}');
      document.getElementById('now').click();  // the range of this frame: the first has no load
      const number = id => Number(document.getElementById(id).textContent);
      return {{low: number('legend-low'), high: number('legend-high'), more: colours().size - plain}};)",
                                                                        quantity));
  };
  const double width = 0.02, height = 0.04, area = width * height;
  const double bent = 30.0 * height / 2.0 / (area * height * height / 12.0) +
                      10.0 * width / 2.0 / (area * width * width / 12.0);
  Json legend = legend_of("moment=\"0 30 10\"", "von_mises", "material=\"steel\"");
  EXPECT_NEAR(legend.at("high"), bent, 1e-3 * bent) << legend.dump();
  EXPECT_LT(legend.at("low"), 0.1 * bent);  // where both take each other away
  EXPECT_GT(legend.at("more"), 50);
  const double twisted = std::sqrt(3.0) * torsion_of_rectangle(50.0, width, height);
  legend = legend_of("moment=\"50 0 0\"", "von_mises", "material=\"steel\"");
  EXPECT_NEAR(legend.at("high"), twisted, 3e-3 * twisted) << legend.dump();
  EXPECT_LT(legend.at("low"), 3e-2 * twisted);  // corners, where the mesh's is not quite nothing
  const double pulled = 1.0 / area * 0.75;  // so little that what it bends by its shear is nothing
  legend = legend_of("force=\"1 0 0\"", "fibres", "material=\"ply\" angle=\"30 deg\"");
  EXPECT_NEAR(legend.at("high"), pulled, 1e-3 * pulled) << legend.dump();
  EXPECT_NEAR(legend.at("low"), pulled, 1e-3 * pulled);
  // What cannot be shown is said.
  EXPECT_NE(mbd("view bar.xml --stresses").text.find("a model has none"), std::string::npos);
  EXPECT_NE(mbd("view bar --stresses --image b.svg").text.find("give them apart"),
            std::string::npos);
  EXPECT_NE(mbd("view bar --model bar.xml").text.find("it is for --stresses"), std::string::npos);
  EXPECT_NE(mbd("view bar bar --stresses").text.find("of one run"), std::string::npos);
}

// At the start a beam is drawn on its reference shape; later its displacements are drawn times the scale. 1e-6 of the size.
TEST_F(ViewPageSlow, ScalesDisplacements) {
  write_text(file("far.xml"), far_away);
  run("far", "--view");
  const Json answer = ask_page("far/view.html", R"(
    const beam = mbdView.parts.find(p => p.kind === 'beam' && p.name === 'two');
    const off = () => beam.now.r.map((r, i) => r.map((c, j) => c - beam.reference[i][j]));
    const most = all => Math.max(...all.flat().map(Math.abs));
    const start = most(off());
    mbdView.setFrame(80);
    const once = off(), input = document.getElementById('scale');
    const at = factor => {
      input.value = factor;
      input.dispatchEvent(new Event('change'));
      return off();
    };
    const thrice = at(3).pop(), none = most(at(0)), again = most(at(1));
    return {start, once: most(once), end: once.pop(), thrice, none, again};)");
  EXPECT_LT(answer.at("start"), 1e-6);
  EXPECT_GT(answer.at("once"), 0.01);
  EXPECT_LT(answer.at("none"), 1e-6);
  EXPECT_EQ(answer.at("again"), answer.at("once"));
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_NEAR(answer.at("thrice").at(k).get<double>(), 3.0 * answer.at("end").at(k).get<double>(),
                1e-9);
}

// Two runs: at a frame of the first, records of the second are where its history is at that time, linear between rows (1e-6
// of the size), and stay where it ends; a legend names both, and hides either. A model stands beside a run in the same way.
// Tried, and killed: the row of the same number; no interpolation; nodes of the second numbered as those of the first.
TEST_F(ViewPageSlow, OverlaysTwoRuns) {
  std::string other = far_away;
  for (const auto& [from, to] :
       {std::pair{"0 0 -9.81", "0 0 -4"},
        {"duration=\"0.2\" step=\"2 ms\"", "duration=\"0.12\" step=\"4 ms\""}})
    other.replace(other.find(from), std::string(from).size(), to);
  write_text(file("far.xml"), far_away);
  write_text(file("less.xml"), other);
  run("far", "--view");
  run("less", "--view");
  const mbd::History first = read_history(file("far")), second = read_history(file("less"));
  const auto tip = choose_columns(first, std::vector<std::string>{"tip.displacement"});
  const std::string say = R"(
      const at = k => { mbdView.setFrame(k); return ['tip', SECOND].map(n => mbdView.record(n).displacement); };
      const shown = () => [0, 1].map(run => mbdView.parts.filter(p => p.kind === 'beam' && (p.run || 0) === run)
        .every(p => p.visible && p.objects.every(o => o.visible)));
      const rows = [3, 25, 58, 90].map(k => at(k)), legend = document.getElementById('runs');
      const boxes = legend.querySelectorAll('input');
      boxes[1].click();
      const without = shown();
      boxes[1].click();
      boxes[0].click();
      return {frames: mbdView.frames, rows, names: legend.textContent, without, only: shown(), wide: legend.offsetWidth,
        stated: mbdView.parts.filter(p => p.run && p.name.endsWith('two'))[0].file};)";
  const auto ask_for = [&](const std::string& page, const std::string& record) {
    std::string script = say;
    script.replace(script.find("SECOND"), 6, "'" + record + "'");
    return ask_page(page, script);
  };
  const Output made = mbd("view far less");
  ASSERT_EQ(made.status, 0) << made.text;
  Json answer = ask_for("far/overlay.html", "less: tip");
  ASSERT_TRUE(answer.contains("rows")) << answer.dump();
  EXPECT_EQ(answer.at("frames"), 101);
  EXPECT_EQ(answer.at("names"), "farless");
  EXPECT_GT(answer.at("wide"), 50);
  EXPECT_EQ(answer.at("without"), Json({true, false}));
  EXPECT_EQ(answer.at("only"), Json({false, true}));
  EXPECT_NE(answer.at("stated").get<std::string>().find("less.xml"), std::string::npos);
  const std::size_t frames[] = {3, 25, 58, 90};
  for (std::size_t i = 0; i < 4; ++i) {
    const double time = std::min(first.values[0][frames[i]], second.values[0].back());
    const std::size_t row =
        std::min(static_cast<std::size_t>(time / 0.004 + 1e-9), second.rows() - 2);
    const double u = (time - second.values[0][row]) / 0.004;
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(answer.at("rows").at(i).at(0).at(k).get<double>(),
                  first.values[tip[k]][frames[i]], 1e-6);
      EXPECT_NEAR(answer.at("rows").at(i).at(1).at(k).get<double>(),
                  (1.0 - u) * second.values[tip[k]][row] + u * second.values[tip[k]][row + 1], 1e-6)
          << frames[i];
    }
  }
  // The model, which stands still, before and after the run.
  ASSERT_EQ(mbd("view far far.xml --out both.html").status, 0);
  answer = ask_for("both.html", "far (model): tip");
  ASSERT_TRUE(answer.contains("rows")) << answer.dump();
  ASSERT_EQ(mbd("view far.xml less --out swapped.html").status, 0);
  const Json swapped = ask_for("swapped.html", "less: tip");
  ASSERT_TRUE(swapped.contains("rows")) << swapped.dump();
  EXPECT_EQ(swapped.at("frames"), 31);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(answer.at("rows").at(2).at(1).at(k).get<double>(), 0.0, 1e-6);
    EXPECT_NEAR(answer.at("rows").at(2).at(0).at(k).get<double>(), first.values[tip[k]][58], 1e-6);
    EXPECT_NEAR(swapped.at("rows").at(1).at(0).at(k).get<double>(), 0.0, 1e-6);
    EXPECT_NEAR(swapped.at("rows").at(1).at(1).at(k).get<double>(), second.values[tip[k]][25],
                1e-6);
  }
}

// A model before a run, and one whose joints do not close, with the gap.
TEST_F(ViewPageSlow, ShowsGaps) {
  write_text(file("open.xml"), open_hinge);
  const Output made = mbd("view open.xml --out open.html");
  EXPECT_EQ(made.status, 1);
  EXPECT_NE(made.text.find("hinge"), std::string::npos) << made.text;
  const Json answer = ask_page("open.html", R"(
    const hinge = mbdView.parts.find(p => p.name === 'hinge');
    mbdView.choose(hinge);
    return {fault: document.getElementById('fault').textContent, hidden: document.getElementById('fault').hidden,
      gap: hinge.gap, others: mbdView.parts.filter(p => p.gap).length, details: document.getElementById('details').textContent,
      transport: document.getElementById('transport').offsetHeight};)");
  EXPECT_NEAR(answer.at("gap").get<double>(), 0.05, 1e-12);
  EXPECT_EQ(answer.at("others"), 1);
  EXPECT_EQ(answer.at("hidden"), false);
  EXPECT_NE(answer.at("fault").get<std::string>().find("open.xml:6"), std::string::npos)
      << answer.dump();
  EXPECT_NE(answer.at("details").get<std::string>().find("0.05 m"), std::string::npos)
      << answer.dump();
  EXPECT_EQ(answer.at("transport"), 0);
}

// ---- files --------------------------------------------------------------------------------------

// Every model can be shown before a run.
TEST_F(ViewFile, OfEveryModel) {
  int count = 0;
  for (const auto& entry : fs::directory_iterator(models)) {
    if (entry.path().extension() != ".xml") continue;
    const Output made = mbd("view " + quote(entry.path().string()) + " --out m.html");
    EXPECT_EQ(made.status, 0) << entry.path() << made.text;
    const std::string page = read_text(file("m.html"));
    EXPECT_LE(page.size(), 2'000'000U) << entry.path();
    EXPECT_NE(page.find("Permission is hereby granted"), std::string::npos);
    ++count;
  }
  EXPECT_GT(count, 30);
}

// Frames are left out evenly until the page has its size, at most; names that would end a script do not.
TEST_F(ViewFile, KeepsItsSize) {
  run("four_bar", "--view");
  const Output small = mbd("view four_bar --size 2 --out small.html");
  EXPECT_EQ(small.status, 0) << small.text;
  const auto bytes = fs::file_size(file("small.html"));
  EXPECT_LE(bytes, 2'000'000U);
  EXPECT_GT(bytes, 1'800'000U);
  EXPECT_NE(small.text.find(" of 4001 frames"), std::string::npos) << small.text;
  EXPECT_LE(fs::file_size(file("four_bar/view.html")), 20'000'000U);
  const Output few = mbd("view four_bar --frames 7 --out few.html");
  EXPECT_NE(few.text.find("7 of 4001 frames"), std::string::npos) << few.text;
  const std::string page = read_text(file("few.html"));
  const std::size_t keys = page.find("\"keys\":[") + 7;
  const Json shown = Json::parse(page.substr(keys, page.find(']', keys) + 1 - keys));
  ASSERT_EQ(shown.size(), 7U);
  for (std::size_t i = 0; i < 7; ++i)
    EXPECT_NEAR(shown.at(i).get<double>(), 6.0 * static_cast<double>(i), 0.0091);
}

TEST_F(ViewFile, SaysWhatIsWrong) {
  struct Case {
    std::string words;
    std::vector<std::string> parts;
  };
  const std::string pendulum = quote((models / "pendulum.xml").string());
  ASSERT_EQ(mbd("run " + pendulum + " --out bare --quiet --no-estimate").status, 0);
  write_text(file("text.html"), "no model");
  for (const auto& [model, results] :
       {std::pair{"pendulum", "moved"}, {"roll_up", "steps"}, {"lee_frame", "path"}})
    ASSERT_EQ(mbd("run " + quote((models / (std::string(model) + ".xml")).string()) +
                  " --motion --quiet --no-estimate --out " + results)
                  .status,
              0);
  for (const Case& c :
       std::vector<Case>{{"view bare", {"bare/motion.bin", "--motion", "<motion_output/>"}},
                         {"view nowhere.xml", {"nowhere.xml"}},
                         {"view text.html", {"text.html"}},
                         {"view " + pendulum + " --out p.svg", {"--out p.svg", ".html"}},
                         {"view " + pendulum + " --size 0.1", {"--size 0.1", "between 1 and 1000"}},
                         {"view " + pendulum + " --size 2MB", {"--size 2MB", "megabytes"}},
                         {"view " + pendulum + " --frames 3", {"--frames 3", "--motion"}},
                         {"view bare --set a=1", {"--set a=1", "results"}},
                         {"view moved steps", {"moved goes in time, steps in load steps"}},
                         {"view steps path", {"path/motion.bin", "comes back", "alone"}},
                         {"view moved moved --set a=1", {"--set a=1", "results"}},
                         {"view moved moved --image p.svg", {"--image", "of one of them"}},
                         {"view moved nowhere.xml", {"nowhere.xml"}},
                         {"view moved bare", {"bare/motion.bin", "--motion"}},
                         {"view " + pendulum + " --frames 1", {"--frames 1"}}}) {
    const Output output = mbd(c.words);
    EXPECT_EQ(output.status, 1) << c.words << output.text;
    for (const std::string& part : c.parts)
      EXPECT_NE(output.text.find(part), std::string::npos) << c.words << ": " << output.text;
  }
}

}  // namespace
}  // namespace mbd::test::test_view
