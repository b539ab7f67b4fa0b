// The plot: ticks, decimation that keeps extremes, and an SVG that stands.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string>

#include "libmbd/pictures/plot.hpp"

namespace mbd::plot::test_plot {
namespace {

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

Panel sine(std::size_t points, const std::string& label) {
  Panel panel{
      .title = "A < B & \"C\"", .x_label = "time [s]", .y_label = "u [m]", .x_is_time = true};
  panel.curves.push_back({label, {}});
  for (std::size_t i = 0; i < points; ++i) {
    const double t = 10.0 * static_cast<double>(i) / static_cast<double>(points);
    panel.curves[0].trace.add({t, std::sin(t)});
  }
  return panel;
}

TEST(Plot, TicksAreOneTwoFive) {
  EXPECT_EQ(make_ticks(0, 10, 5).at, (std::vector<double>{0, 2, 4, 6, 8, 10}));
  EXPECT_EQ(make_ticks(0, 2.5, 5).step, 0.5);
  EXPECT_EQ(make_ticks(-1, 1, 2).at, (std::vector<double>{-1, 0, 1}));
  for (const double size : {1e-12, 3e-7, 0.02, 1.0, 7.3, 4e5, 9e30}) {
    const Ticks ticks = make_ticks(-0.3 * size, 0.9 * size, 6);
    EXPECT_GE(ticks.at.size(), 3u) << size;
    EXPECT_LE(ticks.at.size(), 10u) << size;
    EXPECT_GE(ticks.at.front(), -0.3 * size * (1 + 1e-9));
    EXPECT_LE(ticks.at.back(), 0.9 * size * (1 + 1e-9));
    const double lead = ticks.step / std::pow(10.0, std::floor(std::log10(ticks.step) + 1e-9));
    EXPECT_TRUE(std::abs(lead - 1) < 1e-9 || std::abs(lead - 2) < 1e-9 || std::abs(lead - 5) < 1e-9)
        << lead;
  }
}

void expect_values(const std::vector<double>& values, const std::vector<double>& expected) {
  ASSERT_EQ(values.size(), expected.size()) << testing::PrintToString(values);
  for (std::size_t i = 0; i < values.size(); ++i)
    EXPECT_NEAR(values[i], expected[i], 1e-12 * expected[i]);
}

TEST(Plot, LogTicksAreDecades) {
  LogTicks ticks = make_log_ticks(3e-4, 2e2, 8);
  expect_values(ticks.at, {1e-3, 1e-2, 1e-1, 1, 10, 100});
  EXPECT_NEAR(ticks.between.front(), 3e-4, 1e-12);
  EXPECT_NEAR(ticks.between.back(), 200, 1e-9);
  EXPECT_EQ(ticks.between.size(), 7u + 5 * 8 + 1);
  ticks = make_log_ticks(1e-16, 1, 8);  // every third power, those between only marked
  expect_values(ticks.at, {1e-15, 1e-12, 1e-9, 1e-6, 1e-3, 1});
  expect_values(ticks.between,
                {1e-16, 1e-14, 1e-13, 1e-11, 1e-10, 1e-8, 1e-7, 1e-5, 1e-4, 1e-2, .1});
  ticks = make_log_ticks(1, 32, 8);
  expect_values(ticks.at, {1, 2, 5, 10, 20});
  expect_values(ticks.between, {3, 4, 6, 7, 8, 9, 30});
  expect_values(make_log_ticks(31, 39, 4).at, {32, 34, 36, 38});
  expect_values(make_log_ticks(4e-4, 5e-2, 4).at, {1e-3, 1e-2});
  for (const double low : {1e-300, 1e-9, 0.7, 3e8}) {
    for (const double range : {1.001, 1.5, 30.0, 1e4, 1e40}) {
      ticks = make_log_ticks(low, low * range, 6);
      EXPECT_GE(ticks.at.size(), 2u) << low << ' ' << range;
      EXPECT_LE(ticks.at.size(), 13u) << low << ' ' << range;
      for (const auto* list : {&ticks.at, &ticks.between})
        for (const double at : *list)
          EXPECT_TRUE(at >= low * (1 - 1e-8) && at <= low * range * (1 + 1e-8)) << at;
    }
  }
}

// A power law is a straight line, equal factors are equal distances; zeros interrupt it.
TEST(Plot, LogAxes) {
  Panel panel{.x_label = "elements", .y_label = "error", .x_log = true, .y_log = true};
  panel.curves.push_back({"a", {}});
  for (const double n : {1.0, 2.0, 4.0, 8.0}) panel.curves[0].trace.add({n, std::pow(n, -6)});
  const std::string svg = to_svg(std::vector<Panel>{panel});
  for (const char* label : {">1<", ">2<", ">5<", ">10⁻⁵<", ">0.1<"})
    EXPECT_GE(count(svg, label), 1u) << label;
  EXPECT_EQ(count(svg, "class=\"m\""), 4u);
  std::vector<Point> drawn;
  for (std::size_t at = svg.find("cx=\""); at != std::string::npos; at = svg.find("cx=\"", at + 1))
    drawn.push_back(
        {std::stod(svg.substr(at + 4)), std::stod(svg.substr(svg.find("cy=\"", at) + 4))});
  ASSERT_EQ(drawn.size(), 4u);
  for (std::size_t i = 1; i < 4; ++i) {
    EXPECT_NEAR(drawn[i][0] - drawn[i - 1][0], drawn[1][0] - drawn[0][0], 0.11);
    EXPECT_NEAR(drawn[i][1] - drawn[i - 1][1], drawn[1][1] - drawn[0][1], 0.11);
  }
  EXPECT_GT(drawn[1][1] - drawn[0][1], 10.0);

  panel.curves[0].trace.add({16.0, 0.0});
  panel.curves[0].trace.add({32.0, 1e-9});
  const std::string broken = to_svg(std::vector<Panel>{panel});
  EXPECT_EQ(count(broken, "class=\"m\""), 5u);
  EXPECT_EQ(count(broken, "nan"), 0u);
  EXPECT_EQ(count(broken, "inf"), 0u);
  const std::size_t path = broken.find("<path d=\"M", broken.find("<g clip-path"));
  const std::string d = broken.substr(path, broken.find("fill", path) - path);
  EXPECT_EQ(count(d, "M"), 2u) << d;  // in two parts
}

// Markers filled and hollow, point by point, in every style; pale and plain curves beside them.
TEST(Plot, HollowPalePlain) {
  Panel panel{.x_log = true, .y_log = true};
  for (int style = 0; style < 6; ++style) {
    Curve curve;
    curve.label = "curve " + std::to_string(style);
    for (const double x : {1.0, 2.0, 4.0}) {
      curve.trace.add({x, std::pow(x, -2)});
      curve.hollow.push_back(x > 3.0);
    }
    panel.curves.push_back(curve);
  }
  std::string svg = to_svg(std::vector<Panel>{panel});
  EXPECT_EQ(count(svg, "class=\"m hollow\""), 6u);
  EXPECT_EQ(count(svg, "class=\"m\""), 6u * 3);  // two points and the legend
  std::set<std::string> shapes;                  // of the legend: relative to their first corner
  for (std::size_t at = svg.find("class=\"m\" d=\"M"), n = 0; n < 6; ++n) {
    const std::string d = svg.substr(at, svg.find("fill", at) - at);
    shapes.insert(std::to_string(count(d, " ")) + d.substr(d.find(' ', 12)));
    at = svg.find("class=\"m\" d=\"M", at + 1);
  }
  EXPECT_EQ(shapes.size(), 6u);

  panel.curves[1].pale = true;
  panel.curves[2].plain = true;
  svg = to_svg(std::vector<Panel>{panel});
  EXPECT_EQ(count(svg, "class=\"m hollow\""), 5u);
  EXPECT_GE(count(svg, "#b0b0b0"), 4u);
  // under all others
  EXPECT_LT(svg.find("stroke=\"#b0b0b0\"", svg.find("<g clip-path")),
            svg.find("stroke=\"#000000\"", svg.find("<g clip-path")));
}

TEST(Plot, LevelsSlopesAndChosenTicks) {
  Panel panel{.x_label = "elements", .y_label = "error", .x_log = true, .y_log = true};
  panel.curves.push_back({"a", {}});
  for (const double n : {1.0, 2.0, 4.0, 8.0}) panel.curves[0].trace.add({n, std::pow(n, -6)});
  const std::string before = to_svg(std::vector<Panel>{panel});
  EXPECT_FALSE(count(before, ">10⁻⁸<"));
  panel.levels.push_back({1e-9, "own < error"});
  panel.slopes.push_back({{2.0, 1e-3}, {4.0, 1e-3 / 64}, "−6.01 (−6)"});
  panel.x_ticks = {1, 2, 4, 8};
  const std::string svg = to_svg(std::vector<Panel>{panel});
  EXPECT_EQ(count(svg, "class=\"level\""), 2u);  // and in the legend
  EXPECT_EQ(count(svg, ">own &lt; error<"), 1u);
  EXPECT_EQ(count(svg, "class=\"slope\""), 1u);
  EXPECT_EQ(count(svg, ">−6.01 (−6)<"), 1u);
  EXPECT_EQ(count(svg, ">10⁻⁸<"), 1u);  // the axes reach the level
  for (const char* tick : {">2<", ">4<", ">8<"}) EXPECT_EQ(count(svg, tick), 1u) << tick;
  EXPECT_EQ(count(svg, ">5<"), 0u);
  panel.x_ticks.clear();  // no room for all
  for (int n = 1; n < 200; ++n) panel.x_ticks.push_back(1.0 + n / 30.0);
  EXPECT_EQ(count(to_svg(std::vector<Panel>{panel}), ">5<"), 1u);
}

TEST(Plot, IdsAreGiven) {
  const std::vector<Panel> panels = {sine(10, "a"), sine(10, "b")};
  const std::string svg = to_svg(panels, {.ids = "first-"});
  for (const char* part : {"id=\"first-0\"", "url(#first-0)", "id=\"first-1\"", "url(#first-1)"})
    EXPECT_EQ(count(svg, part), 1u) << part;
  EXPECT_EQ(count(svg, "id=\"c"), 0u);
}

TEST(Plot, TraceIsBoundedAndKeepsExtremes) {
  Trace trace(1000);
  double least = 1e9, most = -1e9;
  for (int i = 0; i < 200000; ++i) {
    const double y = std::sin(0.7 * i) + (i == 123456 ? 10.0 : i == 7 ? -10.0 : 0.0);
    trace.add({static_cast<double>(i), y});
    least = std::min(least, y);
    most = std::max(most, y);
  }
  const auto& points = trace.points();
  EXPECT_LE(points.size(), 1000u);
  EXPECT_GE(points.size(), 100u);
  const auto lower = [](const Point& a, const Point& b) { return a[1] < b[1]; };
  EXPECT_EQ((*std::max_element(points.begin(), points.end(), lower))[1], most);
  EXPECT_EQ((*std::min_element(points.begin(), points.end(), lower))[1], least);
  EXPECT_TRUE(std::is_sorted(points.begin(), points.end(),
                             [](const Point& a, const Point& b) { return a[0] < b[0]; }));
}

TEST(Plot, SvgHasItsParts) {
  Panel panel = sine(500, "C.displacement.1");
  panel.curves.push_back({"C.displacement.2", panel.curves[0].trace});
  const std::string svg = to_svg(std::vector<Panel>{panel, panel}, {});
  EXPECT_TRUE(svg.starts_with("<svg xmlns=\"http://www.w3.org/2000/svg\""));
  EXPECT_TRUE(svg.ends_with("</svg>\n"));
  EXPECT_EQ(count(svg, "<g clip-path"), 2u);
  EXPECT_EQ(count(svg, ">C.displacement.2</text>"), 2u);  // legend
  EXPECT_EQ(count(svg, "A &lt; B &amp; &quot;C&quot;"), 2u);
  EXPECT_EQ(count(svg, "<rect width=\"720\""), 1u);  // a white ground
  EXPECT_GE(count(svg, "stroke-dasharray"), 2u);     // the second curve differs in grey
  EXPECT_EQ(count(svg, "nan"), 0u);
  EXPECT_EQ(count(svg, "inf"), 0u);
}

TEST(Plot, SizeDoesNotGrowWithTheNumberOfPoints) {
  const std::string small = to_svg(std::vector<Panel>{sine(3000, "a")}, {});
  const std::string large = to_svg(std::vector<Panel>{sine(300000, "a")}, {});
  EXPECT_LT(large.size(), 3 * small.size());
}

TEST(Plot, AnglesHaveTicksAtQuarterTurns) {
  Panel panel = sine(100, "a");
  panel.x_range = {0.0, 2 * std::acos(-1.0)};
  const std::string svg = to_svg(std::vector<Panel>{panel}, {});
  for (const char* const label : {">0<", ">π/2<", ">π<", ">3π/2<", ">2π<"})
    EXPECT_EQ(count(svg, label), label == std::string(">0<") ? 1u : 1u) << label;
}

TEST(Plot, SurvivesOddData) {
  const double huge = std::numeric_limits<double>::max();
  for (const std::vector<Point>& points :
       std::vector<std::vector<Point>>{{},
                                       {{0, 0}},
                                       {{0, 3}, {1, 3}},
                                       {{0, 1e-300}, {1, 2e-300}},
                                       {{0, -huge}, {1, huge}},
                                       {{5, 1}, {5, 2}},
                                       {{0, 1e6}, {1, 1e6 + 1e-9}}}) {
    Panel panel{.curves = {{"a", {}}}};
    for (const Point& point : points) panel.curves[0].trace.add(point);
    const std::string svg = to_svg(std::vector<Panel>{panel}, {});
    EXPECT_EQ(count(svg, "nan"), 0u);
    EXPECT_EQ(count(svg, "inf"), 0u);
    EXPECT_LT(svg.size(), 20000u);
    panel.x_log = panel.y_log = true;
    const std::string log = to_svg(std::vector<Panel>{panel}, {});
    EXPECT_EQ(count(log, "nan"), 0u);
    EXPECT_EQ(count(log, "inf"), 0u);
    EXPECT_LT(log.size(), 20000u);
  }
  EXPECT_TRUE(to_svg({}, {}).ends_with("</svg>\n"));
}

// Letters on a screen 360 px wide are at least 10 px high, and pictures shrink to it.
TEST(Plot, IsLegibleOnAPhone) {
  const std::string svg = to_svg(std::vector<Panel>{sine(50, "a")}, {});
  EXPECT_EQ(count(svg, "viewBox=\"0 0 720 "), 1u);
  EXPECT_EQ(count(svg, "max-width:100%"), 1u);
  std::size_t sizes = 0;
  for (std::size_t at = svg.find("font-size=\""); at != std::string::npos;
       at = svg.find("font-size=\"", at + 1), ++sizes)
    EXPECT_GE(std::stod(svg.substr(at + 11)) * 360.0 / 720.0, 10.0);
  EXPECT_GE(sizes, 1u);
}

TEST(Plot, FewPointsHaveMarkers) {
  EXPECT_EQ(count(to_svg(std::vector<Panel>{sine(30, "a")}, {}), "class=\"m\""), 30u);
  EXPECT_EQ(count(to_svg(std::vector<Panel>{sine(31, "a")}, {}), "class=\"m\""), 0u);
  EXPECT_EQ(count(to_svg(std::vector<Panel>{sine(1, "a")}, {}), "class=\"m\""), 1u);
}

// Without colours, every two of six curves still differ: in dashes and in markers.
TEST(Plot, StylesDifferInGrey) {
  Panel panel = sine(100, "a");
  for (const char* const label : {"b", "c", "d", "e", "f"})
    panel.curves.push_back({label, panel.curves[0].trace});
  const std::string svg = to_svg(std::vector<Panel>{panel}, {});
  std::set<std::string> dashes;
  for (std::size_t at = svg.find("stroke-dasharray=\""); at != std::string::npos;
       at = svg.find("stroke-dasharray=\"", at + 1))
    dashes.insert(svg.substr(at, svg.find('"', at + 18) - at));
  EXPECT_EQ(dashes.size(), 5u);  // and one without
  EXPECT_EQ(count(svg, "class=\"m\""), 6u * (7u + 1u));
}

TEST(Plot, LongTextsAreBrokenOrShortened) {
  Panel panel = sine(100, std::string(300, 'a') + ".1");
  panel.title = "a long title, ";
  for (int i = 0; i < 3; ++i) panel.title += panel.title;
  panel.y_label = std::string(40, 'y') + " [m]";
  panel.curves.push_back({std::string(300, 'a') + ".2", {}});
  const std::string svg = to_svg(std::vector<Panel>{panel}, {.title = std::string(2000, 'w')});
  for (std::size_t at = svg.find("<text "); at != std::string::npos;
       at = svg.find("<text ", at + 1)) {
    const std::size_t begin = svg.find('>', at) + 1;
    EXPECT_LE(svg.find('<', begin) - begin, 60u) << svg.substr(at, 200);
  }
  EXPECT_EQ(count(svg, "a.1</text>"), 1u);  // what tells curves apart is still there
  EXPECT_EQ(count(svg, "a.2</text>"), 1u);
  EXPECT_EQ(count(svg, "rotate"),
            0u);  // the label of y is longer than its axis and stands above it
  EXPECT_EQ(count(svg, ">↑ yyyy"), 1u);
}

// Texts that end at an axis, the labels of y: the greatest number of letters and where they end.
std::pair<std::size_t, std::set<std::string>> y_labels(const std::string& svg) {
  std::size_t most = 0;
  std::set<std::string> ends;
  for (std::size_t at = svg.find("text-anchor=\"end\">"); at != std::string::npos;
       at = svg.find("text-anchor=\"end\">", at + 1)) {
    std::string text = svg.substr(at + 18, svg.find('<', at) - at - 18);
    if (text.starts_with("−")) text.replace(0, std::string("−").size(), "-");
    most = std::max(most, text.size());
    const std::size_t x = svg.rfind("<text x=\"", at) + 9;
    ends.insert(svg.substr(x, svg.find('"', x) - x));
  }
  return {most, ends};
}

Panel line(double from, double to) {
  Panel panel{.y_label = "u [m]", .x_is_time = true};
  panel.curves.push_back({"a", {}});
  for (int i = 0; i <= 100; ++i) panel.curves[0].trace.add({0.01 * i, i % 2 == 0 ? from : to});
  return panel;
}

// Heights of the points on the paths of curves.
std::set<std::string> heights(const std::string& svg) {
  std::set<std::string> found;
  const std::size_t begin = svg.find("<path", svg.find("<g clip-path"));
  const std::size_t from = svg.find("d=\"", begin) + 3;
  const std::string path = svg.substr(from, svg.find('"', from) - from);
  for (std::size_t at = path.find(','); at != std::string::npos; at = path.find(',', at + 1))
    found.insert(path.substr(at + 1, path.find_first_of(" M", at) - at - 1));
  return found;
}

TEST(Plot, ConstantsAreFlatLinesWithShortLabels) {
  for (const double value : {6.2831853072, -6.2831853072, 1e-3, 123456.0, 20000.0, 1e-20}) {
    for (const double noise : {1e-15, 1e-11, 9e-7}) {
      const std::string svg = to_svg(std::vector<Panel>{line(value, value * (1.0 + noise))}, {});
      EXPECT_EQ(heights(svg).size(), 1u) << value << " " << noise;
      EXPECT_LE(y_labels(svg).first, 6u) << value << " " << noise;
    }
    const std::string svg = to_svg(std::vector<Panel>{line(value, value * (1.0 + 2e-6))}, {});
    EXPECT_EQ(heights(svg).size(), 2u) << value;  // a motion, if a small one
    EXPECT_LE(y_labels(svg).first, 10u) << value;
  }
}

TEST(Plot, AxesOfAllPanelsBeginRightOfTheWidestLabel) {
  const std::vector<Panel> panels = {line(0.0, 1.0), line(-40000.0, 10000.0)};
  const auto [most, ends] = y_labels(to_svg(panels, {}));
  ASSERT_EQ(most, 6u);
  ASSERT_EQ(ends.size(), 1u);
  const double width = (5.0 * 0.636 + 0.838) * 22.0;        // of -40000 in DejaVu Sans
  EXPECT_GT(std::stod(*ends.begin()) - width, 24.0 + 5.0);  // below the base line of "u [m]"
  const auto alone = y_labels(to_svg(std::vector<Panel>{panels[0]}, {}));
  EXPECT_LT(std::stod(*alone.second.begin()), std::stod(*ends.begin()));
}

TEST(Plot, LabelsOfYStandAllBesideOrAllAbove) {
  std::vector<Panel> panels = {line(0.0, 1.0), line(0.0, 1.0)};
  EXPECT_EQ(count(to_svg(panels, {}), "rotate"), 2u);
  panels[1].y_label = std::string(40, 'y');
  const std::string svg = to_svg(panels, {});
  EXPECT_EQ(count(svg, "rotate"), 0u);
  EXPECT_EQ(count(svg, ">↑ "), 2u);
}

TEST(Plot, ZeroComponentsHaveNoMarkers) {
  Panel panel = sine(100, "a");
  for (const double value : {0.0, 1e-13, 1e-11}) {  // nothing, round-off, something
    panel.curves.push_back({"b", {}});
    panel.curves.back().trace.add({0.0, value});
    panel.curves.back().trace.add({10.0, value});
  }
  const std::string svg = to_svg(std::vector<Panel>{panel}, {});
  EXPECT_EQ(count(svg, "class=\"m\""), (7u + 1u) + (2u + 1u));
  EXPECT_EQ(count(svg, ">b</text>"), 3u);
}

TEST(Plot, CurvesWithoutALabelAreNotInTheLegend) {
  Panel panel = sine(100, "a");
  panel.curves.push_back({"", panel.curves[0].trace, 0, true});
  std::string svg = to_svg(std::vector<Panel>{panel}, {});
  EXPECT_EQ(count(svg, "<line "), 0u);       // one label is no legend
  EXPECT_EQ(count(svg, "class=\"m\""), 0u);  // broad and thin tell them apart
  panel.curves.push_back({"b", panel.curves[0].trace, 1});
  svg = to_svg(std::vector<Panel>{panel}, {});
  EXPECT_EQ(count(svg, "<line "), 3u);  // "a" shows its broad curve as well
}

TEST(Plot, QuantitiesHavePanelsWithUnits) {
  const std::vector<Column> columns = {
      {"time", "s"}, {"C.u.1", "m"}, {"D.angle", "rad"}, {"C.u.2", "m"}};
  const QuantityPanels made = quantity_panels(columns, std::vector<std::size_t>{1, 2, 3}, 0);
  ASSERT_EQ(made.panels.size(), 2u);
  EXPECT_EQ(made.panels[0].y_label, "C.u [m]");
  EXPECT_EQ(made.panels[1].y_label, "D.angle [rad]");
  EXPECT_EQ(made.panels[0].x_label, "time [s]");
  EXPECT_EQ(made.panels[0].curves.size(), 2u);
  EXPECT_EQ(made.left_out, 0u);
}

}  // namespace
}  // namespace mbd::plot::test_plot
