// Pictures and animations of `mbd view`: files, and in headless Chromium, which decodes them (skipped without it).
//
// Tried in the library, and killed: positions from the origin in place of the drawing's centre; the frame after the one at
// --time; azimuth and elevation exchanged; y of the picture upward; mirrored pictures; faces in order of their distance, the
// nearest first; a depth buffer that keeps what is farther; one frame fewer.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "libmbd/compile/model.hpp"
#include "libmbd/language/reader.hpp"
#include "libmbd/results/history.hpp"
#include "libmbd/view/drawing.hpp"
#include "libmbd/view/letters.hpp"
#include "libmbd/view/picture.hpp"
#include "tests/support/browser.hpp"

namespace mbd::test::test_picture {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

const fs::path models = fs::path(MBD_SOURCE_DIR) / "models";

// The build lacks a library that the picture needs.
bool lacks(const Output& output) {
  return output.text.find("this mbd was built without lib") != std::string::npos;
}

using PictureFile = ProgramTest;

Vec3 vector_of(const Json& all) {
  return {all.at(0).get<double>(), all.at(1).get<double>(), all.at(2).get<double>()};
}

// ---- where things are ---------------------------------------------------------------------------

struct Placed {
  const char *model, *record, *beam;
  Vec3 reference;  // of the record [m], as the model states it
  double azimuth, elevation;
  int up;  // axis
};
class PicturePositions : public ProgramTest, public testing::WithParamInterface<Placed> {};

// A record's point is where a pinhole at the camera that the file states has the reference position and the displacement
// in history.csv, to 0.002 pixels (the file has three digits); so is the end of its trail, and the beam that ends there. The
// camera looks whence it was told.
TEST_P(PicturePositions, AreProjectionsOfTheHistory) {
  write_text(file("far.xml"), far_away);
  const Placed& c = GetParam();
  run(c.model, "--motion");
  const mbd::History history = read_history(file(c.model));
  const auto columns =
      choose_columns(history, std::vector{std::string(c.record) + ".displacement"});
  for (const std::size_t row : {history.rows() / 3, history.rows() - 1}) {
    const Output made = mbd(
        fmt::format("view {} --image p.svg --time {:.17g} --trails --from={},{} --pixels 800x640",
                    c.model, history.values[0][row], c.azimuth, c.elevation));
    ASSERT_EQ(made.status, 0) << made.text;
    const std::string svg = read_text(file("p.svg"));
    std::string text = svg.substr(svg.find("<metadata>") + 10);
    text = std::regex_replace(text.substr(0, text.find("</metadata>")), std::regex("&quot;"), "\"");
    const Json camera = Json::parse(text);

    const double az = c.azimuth * std::numbers::pi / 180.0,
                 el = c.elevation * std::numbers::pi / 180.0;
    Vec3 whence = Vec3::Zero();
    whence((c.up + 1) % 3) = std::cos(el) * std::cos(az);
    whence((c.up + 2) % 3) = std::cos(el) * std::sin(az);
    whence(c.up) = std::sin(el);
    const Vec3 eye = vector_of(camera.at("eye")) + vector_of(camera.at("centre"));
    // What is right of one who looks along -whence, with the axis that is up above.
    const Vec3 right = Vec3(Vec3::Unit(c.up)).cross(whence).normalized(),
               above = whence.cross(right);
    EXPECT_LT((vector_of(camera.at("ahead")) + whence).norm(), 1e-12);

    Vec3 x = c.reference;
    for (std::size_t k = 0; k < 3; ++k) x(static_cast<Index>(k)) += history.values[columns[k]][row];
    const Vec3 d = x - eye;
    const double depth = -d.dot(whence),
                 focal = 0.5 * 640 / std::tan(17.5 * std::numbers::pi / 180.0);
    const double px = 400.0 + focal * d.dot(right) / depth,
                 py = 320.0 - focal * d.dot(above) / depth;
    EXPECT_GT(px, 0.0);
    EXPECT_LT(px, 800.0);
    EXPECT_GT(py, 0.0);
    EXPECT_LT(py, 640.0);

    const std::string group = "<g data-part=\"" + std::string(c.record) + "\">";
    const auto between = [](const std::string& in, const std::string& from, const std::string& to) {
      const std::size_t begin = in.find(from);
      if (begin == std::string::npos) return std::string();
      return in.substr(begin + from.size(), in.find(to, begin + from.size()) - begin - from.size());
    };
    // The joint C of the four-bar has a group of that name too.
    bool is_there = false;
    for (std::size_t at = 0; (at = svg.find(group, at)) != std::string::npos; ++at) {
      const std::string of = svg.substr(at, svg.find("</g>", at) - at),
                        points = between(of, "points=\"", "\"");
      if (points.empty()) continue;
      is_there = true;
      EXPECT_NEAR(std::stod(between(of, "cx=\"", "\"")), px, 0.002) << row;
      EXPECT_NEAR(std::stod(between(of, "cy=\"", "\"")), py, 0.002) << row;
      EXPECT_EQ(std::count(points.begin(), points.end(), ','),
                static_cast<std::ptrdiff_t>(row + 1));
      EXPECT_NEAR(std::stod(points.substr(points.rfind(' '))), px, 0.002);
    }
    EXPECT_TRUE(is_there);
    if (c.beam[0] == '\0') continue;
    double nearest = 1e300;
    const std::string beam = "<g data-part=\"" + std::string(c.beam) + "\">";
    const std::regex corner("[ML]([-0-9.]+) ([-0-9.]+)");
    for (std::size_t at = 0; (at = svg.find(beam, at)) != std::string::npos; ++at) {
      const std::string of = svg.substr(at, svg.find("</g>", at) - at);
      for (std::sregex_iterator i(of.begin(), of.end(), corner), end; i != end; ++i)
        nearest = std::min(nearest, std::hypot(std::stod((*i)[1]) - px, std::stod((*i)[2]) - py));
    }
    EXPECT_LT(nearest, 20.0);  // half a section; the picture is 1000 across
  }
}

INSTANTIATE_TEST_SUITE_P(
    Models, PicturePositions,
    testing::Values(Placed{"four_bar", "C", "bar2", {0.24, 0.12, 0.0}, 35, 65, 2},
                    Placed{"shaft", "M", "", {3.0, 0.0, 0.0}, -140, 20, 2},
                    Placed{"far", "tip", "two", {2e4, 0.3, 1e4}, 20, -30, 2}),
    [](const auto& of) { return std::string(of.param.model); });

// A ball before a bar and the bar before the ball, as seen from the two sides; a picture in pixels and as SVG.
TEST(Picture, WhatIsNearerHidesWhatIsBehind) {
  const Scene scene = read_model_text(R"(<mbd name="two"><section name="s">
      <stiffness EA="1e8" GA2="4e7" GA3="4e7" GJ="1e5" EI2="1e5" EI3="1e5"/></section>
    <beam name="bar" section="s" from="-1 0 0" to="1 0 0" normal="0 0 1" elements="2"/>
    <body name="ball" mass="1" inertia="0.004 0.004 0.004" at="0 0 0.6"/>
    <fixed name="clamp" between="ground bar.start"/><fixed name="on" between="ground ball" at="0 0 0.6"/>
    <static/></mbd>)");
  const Model model = compile(scene);
  const Stage stage(drawing(scene, model), {});
  PictureOptions options;
  options.width = 300, options.height = 200;
  options.grid = options.words = false;
  for (const bool ball_first : {true, false}) {
    options.from = ball_first ? "z" : "-z";
    const Camera camera = camera_of(stage, options);
    // The bar is long in x, and the eye at y = 0: the middle of the ball has the bar before or behind it.
    const Vec3 d = Vec3(0.0, 0.0, 0.6) - stage.centre() - camera.eye;
    const double depth = d.dot(camera.ahead),
                 px = camera.middle[0] + camera.focal * d.dot(camera.right) / depth,
                 py = camera.middle[1] - camera.focal * d.dot(camera.above) / depth;
    EXPECT_NEAR(px, 150.0, 75.0);
    EXPECT_NEAR(py, 100.0, 50.0);
    const Pixels pixels = picture_pixels(stage, 0.0, camera, options);
    ASSERT_EQ(pixels.rgb.size(), 300U * 200U * 3U);
    const std::size_t middle =
        3 * (static_cast<std::size_t>(py) * 300 + static_cast<std::size_t>(px));
    const int red = pixels.rgb[middle], blue = pixels.rgb[middle + 2];
    EXPECT_EQ(red > blue, ball_first) << red << " " << blue;  // bodies are brown, beams blue
    EXPECT_GT(std::abs(red - blue), 30);
    EXPECT_EQ(pixels.rgb[0], 255);  // nothing in the corner
    // In SVG what covers the middle last.
    const std::string svg = picture_svg(stage, 0.0, camera, options);
    std::string part, over;
    const std::regex item("<g data-part=\"([^\"]*)\">|<path d=\"(M[^\"]*)z\"");
    const std::regex corner("[ML]([-0-9.]+) ([-0-9.]+)");
    for (std::sregex_iterator i(svg.begin(), svg.end(), item), end; i != end; ++i) {
      if ((*i)[1].matched) {
        part = (*i)[1];
        continue;
      }
      const std::string path = (*i)[2];
      std::vector<std::array<double, 2>> p;
      for (std::sregex_iterator j(path.begin(), path.end(), corner); j != end; ++j)
        p.push_back({std::stod((*j)[1]) - px - 0.3, std::stod((*j)[2]) - py - 0.2});
      bool is_inside = false;
      for (std::size_t a = 0, b = p.size() - 1; a < p.size(); b = a++)
        if ((p[a][1] > 0.0) != (p[b][1] > 0.0) &&
            p[a][0] + (p[b][0] - p[a][0]) * p[a][1] / (p[a][1] - p[b][1]) > 0.0)
          is_inside = !is_inside;
      if (is_inside) over = part;
    }
    EXPECT_EQ(over, ball_first ? "ball" : "bar");
  }
  // Half a turn about what is up shows the bar's ends exchanged: the clamp is left from -y, right from +y.
  for (const bool in_front : {true, false}) {
    options.from = in_front ? "-y" : "y";
    const std::string svg = picture_svg(stage, 0.0, camera_of(stage, options), options);
    const std::size_t at = svg.find("M", svg.find("<g data-part=\"clamp\">"));
    EXPECT_EQ(std::stod(svg.substr(at + 1)) < 150.0, in_front);
  }
}

// The range of the legend against closed forms: a strip that a tip moment bends into an arc; and a scale of displacements.
TEST_F(PictureFile, ColoursHaveALegend) {
  write_text(file("arc.xml"), R"(<mbd name="arc"><section name="s">
      <stiffness EA="1e6" GA2="4e5" GA3="4e5" GJ="80" EI2="100" EI3="100"/></section>
    <beam name="b" section="s" from="0 0 0" to="2 0 0" normal="0 0 1" elements="4"/>
    <fixed name="clamp" between="ground b.start"/><load at="b.end" moment="0 -25 0"/><static steps="4"/>
    <record name="tip" at="b.end" quantities="displacement"/></mbd>)");
  run("arc", "--motion");
  const Motion motion = read_motion(file("arc") / "motion.bin");
  const double radius = 4.0, angle = 0.5;
  const double moved = std::hypot(radius * std::sin(angle) - 2.0, radius * (1.0 - std::cos(angle)));
  FigureOptions options;
  for (const auto& [colour, value, within] : {std::tuple{"M", 25.0, 1e-6},
                                              {"displacement", moved, 1e-3},
                                              {"N", 0.0, 1e-6},
                                              {"energy", 0.5 * 25.0 * 25.0 / 100.0, 1e-6}}) {
    options.colour = colour;
    const Stage stage(motion, options);
    ASSERT_NE(stage.legend(), nullptr);
    EXPECT_NEAR(stage.legend()->low, 0.0, 1e-6) << colour;
    EXPECT_NEAR(stage.legend()->high, value, within * std::max(1.0, value)) << colour;
  }
  options.colour = "M";
  options.trails = true;
  options.scale = 2.0;
  const Stage twice(motion, options);
  options.scale = 1.0;
  const Stage once(motion, options);
  const double last = static_cast<double>(once.frames() - 1);
  const Vec3 tip = Vec3(2.0, 0.0, 0.0) - once.centre();
  EXPECT_LT(
      (twice.figure(last).trails.at(0).now - tip - 2.0 * (once.figure(last).trails.at(0).now - tip))
          .norm(),
      1e-12);
  // Under one moment the strip has one colour, lit from one side: that of the end of the scale.
  const Figure figure = once.figure(last);
  for (const Figure::Face& face : figure.faces)
    if (once.part_name(face.part) == "b") {
      EXPECT_NEAR(face.colour.r, Stage::shade(1.0).r, 1e-6);
      EXPECT_NEAR(face.colour.b, Stage::shade(1.0).b, 1e-6);
    }
  // Between two frames: linear.
  const Vec3 a = once.figure(1.0).trails.at(0).now, b = once.figure(2.0).trails.at(0).now;
  EXPECT_LT((once.figure(1.25).trails.at(0).now - (0.75 * a + 0.25 * b)).norm(), 1e-12);
  EXPECT_NEAR(once.instant(once.key(1.25)), 1.25, 1e-12);
}

// Letters stand on their line, are as high as asked, and as many as there are.
TEST(Picture, Letters) {
  for (char c = '!'; c <= '~'; ++c) {
    const Lettering one = lettering(std::string(1, c), 12.0);
    EXPECT_GT(one.width, -1e-9);
    EXPECT_LT(one.width, 12.0);
    for (const auto& stroke : one.strokes)
      for (const auto& [x, y] : stroke) {
        EXPECT_GE(x, 0.0) << c;
        EXPECT_GE(y, -14.0) << c;
        EXPECT_LE(y, 4.0) << c;
      }
  }
  EXPECT_DOUBLE_EQ(lettering("H", 12.0).strokes.at(0).at(0)[1], -12.0);
  EXPECT_DOUBLE_EQ(lettering("H", 12.0).strokes.at(0).at(1)[1], 0.0);
  EXPECT_EQ(lettering("äx", 12.0).strokes.size(), lettering("?x", 12.0).strokes.size());
}

// ---- files --------------------------------------------------------------------------------------

unsigned number_at(const std::string& bytes, std::size_t at, int count) {  // least byte first
  unsigned value = 0;
  for (int i = count; i-- > 0;)
    value = value << 8 | static_cast<unsigned char>(bytes.at(at + static_cast<std::size_t>(i)));
  return value;
}

// An animation has the frames that were asked for, and their time; a PNG its size.
TEST_F(PictureFile, AnimationsHaveTheirFrames) {
  run("pendulum", "--motion --frames 100");
  struct Case {
    const char* options;
    unsigned frames, milliseconds;
  };
  for (const Case& c : {Case{"--frames 23 --seconds 3", 23, 3000}, Case{"--seconds 2", 50, 2000},
                        Case{"--time 1:4 --frames 30 --trails", 30, 3000}}) {
    const Output made =
        mbd(std::string("view pendulum --animation a.webp --pixels 160x120 ") + c.options);
    if (lacks(made)) GTEST_SKIP() << made.text;
    ASSERT_EQ(made.status, 0) << made.text;
    EXPECT_NE(made.text.find(fmt::format("{} frames", c.frames)), std::string::npos) << made.text;
    const std::string bytes = read_text(file("a.webp"));
    EXPECT_EQ(bytes.substr(0, 4) + bytes.substr(8, 4), "RIFFWEBP");
    unsigned frames = 0, time = 0, width = 0, height = 0;
    for (std::size_t at = 12; at + 8 <= bytes.size();) {
      const std::string kind = bytes.substr(at, 4);
      const unsigned size = number_at(bytes, at + 4, 4);
      if (kind == "VP8X")
        width = number_at(bytes, at + 12, 3) + 1, height = number_at(bytes, at + 15, 3) + 1;
      if (kind == "ANMF") ++frames, time += number_at(bytes, at + 20, 3);
      at += 8 + size + size % 2;
    }
    EXPECT_EQ(frames, c.frames);
    EXPECT_EQ(time, c.milliseconds);
    EXPECT_EQ(width, 160U);
    EXPECT_EQ(height, 120U);
  }
  const Output png = mbd("view pendulum --image a.png --pixels 320x200");
  if (lacks(png)) GTEST_SKIP() << png.text;
  ASSERT_EQ(png.status, 0) << png.text;
  const std::string bytes = read_text(file("a.png"));
  EXPECT_EQ(bytes.substr(1, 3), "PNG");
  EXPECT_EQ(bytes.substr(16, 8), std::string("\0\0\x01\x40\0\0\0\xc8", 8));
}

// Every model can be drawn before a run, also one that cannot be assembled, which is an error still.
TEST_F(PictureFile, OfEveryModel) {
  for (const auto& entry : fs::directory_iterator(models)) {
    if (entry.path().extension() != ".xml") continue;
    const Output made = mbd("view " + quote(entry.path().string()) + " --image m.svg");
    EXPECT_EQ(made.status, 0) << entry.path() << made.text;
    const std::string svg = read_text(file("m.svg"));
    EXPECT_NE(svg.find("data-part="), std::string::npos) << entry.path();
    EXPECT_EQ(svg.find("nan"), std::string::npos) << entry.path();
  }
  write_text(file("open.xml"), open_hinge);
  const Output made = mbd("view open.xml --image open.svg");
  EXPECT_EQ(made.status, 1);
  EXPECT_NE(made.text.find("open.xml:6"), std::string::npos) << made.text;
  EXPECT_NE(read_text(file("open.svg")).find("data-part=\"hinge\""), std::string::npos);
}

TEST_F(PictureFile, SaysWhatIsWrong) {
  struct Case {
    std::string words;
    std::vector<std::string> parts;
  };
  run("pendulum", "--motion --frames 20");
  run("roll_up", "--motion");
  const std::string model = quote((models / "pendulum.xml").string());
  for (const Case& c : std::vector<Case>{
           {"view pendulum --image p.gif", {"--image p.gif", ".svg or .png"}},
           {"view pendulum --animation p.gif", {"--animation p.gif", ".webp"}},
           {"view pendulum --image p.svg --time 11", {"--time 11:", "times from 0 to 10 s"}},
           {"view pendulum --image p.svg --time soon", {"--time soon", "number"}},
           {"view pendulum --image p.svg --time 1:2", {"--time 1:2", "range is of --animation"}},
           {"view pendulum --animation p.webp --time 2", {"--time 2", "FROM:TO"}},
           {"view pendulum --animation p.webp --time 4:2", {"--time 4:2", "later"}},
           {"view pendulum --animation p.webp --seconds 0", {"--seconds 0"}},
           {"view pendulum --animation p.webp --seconds 100", {"2500 frames", "--seconds"}},
           {"view pendulum --animation p.webp --pixels 4000x100", {"--pixels 4000x100", "2048"}},
           {"view pendulum --image p.svg --pixels 100", {"--pixels 100", "960x600"}},
           {"view pendulum --image p.svg --from above", {"--from above", "iso, x, y, z"}},
           {"view pendulum --image p.svg --from 10,100", {"--from 10,100", "-90 to 90"}},
           {"view pendulum --image p.svg --colour heat",
            {"--colour heat", "displacement, velocity"}},
           {"view roll_up --image p.svg --colour velocity", {"--colour velocity", "displacement"}},
           {"view roll_up --image p.svg --time 2", {"--time 2:", "load factors from 0 to 1"}},
           {"view pendulum --image p.svg --scale -1", {"--scale -1"}},
           {"view pendulum --image p.svg --out p.html", {"--out", "give them apart"}},
           {"view pendulum --image p.svg --frames 9", {"--frames 9", "--animation"}},
           {"view pendulum --trails", {"--trails", "--image FILE.svg"}},
           {"view " + model + " --animation p.webp", {"--animation p.webp", "--motion"}},
           {"view " + model + " --image p.svg --time 1", {"--time 1:", "--motion"}},
           {"view " + model + " --image p.svg --colour N", {"--colour N", "--motion"}},
           {"view " + model + " --image nowhere/p.svg", {"nowhere"}}}) {
    const Output output = mbd(c.words);
    if (lacks(output)) continue;
    EXPECT_EQ(output.status, 1) << c.words << output.text;
    for (const std::string& part : c.parts)
      EXPECT_NE(output.text.find(part), std::string::npos) << c.words << ": " << output.text;
    EXPECT_FALSE(fs::exists(file("p.svg")) || fs::exists(file("p.webp"))) << c.words;
  }
}

// ---- in a browser -------------------------------------------------------------------------------

std::string base64(const std::string& bytes) {
  constexpr std::string_view letters =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned all = 0;
    for (std::size_t j = 0; j < 3; ++j)
      all = all << 8 | (i + j < bytes.size() ? static_cast<unsigned char>(bytes[i + j]) : 0U);
    for (std::size_t j = 0; j < 4; ++j)
      text += i + j < bytes.size() + 1 ? letters[all >> (18 - 6 * j) & 63U] : '=';
  }
  return text;
}

class PictureBrowserSlow : public BrowserTest {};

// Chromium decodes what is written: the two writers of pictures agree on all but edges (pixels whose colours are further
// apart than 150 of 765 are a tenth of those that are drawn at most, where another time has more than half), and frames of
// an animation move.
TEST_F(PictureBrowserSlow, ReadThem) {
  run("four_bar", "--motion --frames 60");
  const std::string options = " --pixels 480x300 --from 60,30 --bare";
  const Output made = mbd("view four_bar --image p.svg" + options),
               png = mbd("view four_bar --image p.png" + options),
               other = mbd("view four_bar --image q.png --time 20" + options),
               webp = mbd("view four_bar --animation p.webp --frames 20" + options);
  if (lacks(png) || lacks(webp)) GTEST_SKIP() << png.text << webp.text;
  for (const Output& output : {made, png, other, webp}) ASSERT_EQ(output.status, 0) << output.text;
  const auto data = [&](const char* type, const char* name) {
    return fmt::format("await load('data:image/{};base64,{}')", type,
                       base64(read_text(file(name))));
  };
  const Json answer = Json::parse(ask(
      "<!DOCTYPE html><title>pictures</title>",
      R"(
    const load = async data => {
      const i = new Image();
      i.src = data;
      await i.decode();
      const c = document.createElement('canvas');
      c.width = 480; c.height = 300;
      const g = c.getContext('2d');
      g.drawImage(i, 0, 0, 480, 300);
      return {w: i.naturalWidth, h: i.naturalHeight, d: g.getImageData(0, 0, 480, 300).data};
    };
    const far = (a, b) => {
      let n = 0;
      for (let i = 0; i < a.d.length; i += 4)
        if ([0, 1, 2].reduce((sum, j) => sum + Math.abs(a.d[i + j] - b.d[i + j]), 0) > 150) ++n;
      return n / (a.d.length / 4);
    };)" +
          fmt::format("const svg = {}, png = {}, other = {}, webp = {};", data("svg+xml", "p.svg"),
                      data("png", "p.png"), data("png", "q.png"), data("webp", "p.webp")) +
          R"(
    let ink = 0;
    for (let i = 0; i < png.d.length; i += 4) if (png.d[i] < 200) ++ink;
    return {svg: [svg.w, svg.h], png: [png.w, png.h], webp: [webp.w, webp.h], ink: ink / (480 * 300),
      same: far(svg, png), moved: far(png, other), frame: far(webp, png)};)"));
  ASSERT_TRUE(answer.contains("same")) << answer.dump();
  for (const char* picture : {"svg", "png", "webp"})
    EXPECT_EQ(answer.at(picture), Json({480, 300}));
  EXPECT_GT(answer.at("ink"), 0.01) << answer.dump();
  EXPECT_LT(answer.at("same").get<double>(), 0.1 * answer.at("ink").get<double>()) << answer.dump();
  EXPECT_GT(answer.at("moved").get<double>(), 0.5 * answer.at("ink").get<double>())
      << answer.dump();
  EXPECT_GT(answer.at("frame"), 0.0);  // the first of the animation, which is not the end
}

}  // namespace
}  // namespace mbd::test::test_picture
