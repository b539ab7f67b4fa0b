// Costs stay bounded: CPU time over size, as an exponent between n and 4 n in one process (the least of three), below 1.6
// where it should be 1 and was 2 or 3; and limits, with their reasons, where it cannot be.
//
// What failed before: `check` of a chain 2.7 to 3.2 (Householder QR of all constraints), smooth tables 3 (dense matrix of
// interpolation), 500 joints in one place 3.8 and 346 MB, 2000 attributes and repeats of nothing 2.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "libmbd/compile/model.hpp"
#include "libmbd/core/error.hpp"
#include "libmbd/language/reader.hpp"
#include "libmbd/results/build_facts.hpp"
#include "libmbd/run/describe.hpp"
#include "libmbd/run/run.hpp"
#include "libmbd/scene/section_table.hpp"

namespace mbd::test::test_costs {
namespace {

constexpr double near_linear = 1.6;

// Of the time that work(n) takes, from n to 4 n.
double exponent(int n, const std::function<void(int)>& work) {
  const auto least = [&work](int size) {
    double best = 1e9;
    for (int k = 0; k < 3; ++k) {
      const double before = used_cpu();
      work(size);
      best = std::min(best, used_cpu() - before);
    }
    return best;
  };
  const double small = least(n), large = least(4 * n);
  return std::log(large / small) / std::log(4.0);
}

std::string model(const std::string& inside) {
  return "<mbd name=\"m\"><transient duration=\"1\" step=\"0.1\"/>" + inside + "</mbd>";
}

std::string failure_of(const std::string& text) {
  try {
    compile(read_model_text(text));
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

std::string body(const std::string& name, double x) {
  return fmt::format("<body name=\"{}\" at=\"{} 0 0\" mass=\"1\" inertia=\"0.1 0.1 0.1\"/>", name,
                     x);
}
std::string joint(const std::string& kind, const std::string& name, const std::string& between,
                  double x) {
  return fmt::format("<{} name=\"{}\" between=\"{}\" at=\"{} 0 0\"{}/>", kind, name, between, x,
                     kind == "revolute" ? " axis=\"0 1 0\"" : "");
}

// Bodies in a row on spherical joints; closed: the last is held too.
Scene chain(int n, bool closed) {
  std::string text;
  for (int i = 0; i < n; ++i)
    text += body(fmt::format("b{}", i), i) +
            joint("spherical", fmt::format("j{}", i),
                  i == 0 ? "ground b0" : fmt::format("b{} b{}", i - 1, i), i - 0.5);
  if (closed) text += joint("spherical", "last", fmt::format("b{} ground", n - 1), n - 0.5);
  return read_model_text(model(text));
}

TEST(CostsSlow, ChecksOfChains) {
  for (const bool closed : {false, true}) {
    Index freedoms = 0;
    EXPECT_LT(exponent(300,
                       [&](int n) {
                         const Scene scene = chain(n, closed);
                         freedoms = check_model(scene, compile(scene)).mechanism.freedoms();
                         // Each joint takes three of the six of a body; of the chain that is straight and held at
                         // both ends, the last takes two: along the chain it repeats the others.
                         EXPECT_EQ(freedoms, 3 * n - (closed ? 2 : 0)) << n;
                       }),
              near_linear)
        << closed;
  }
}

// A ladder: loops that share bodies, all of them redundant.
TEST(CostsSlow, LoopsThatShareBodies) {
  const double of_loops = exponent(20, [](int n) {
    std::string text;
    for (int i = 0; i < n; ++i)
      for (const char* const side : {"l", "r"})
        text +=
            fmt::format("<body name=\"{}{}\" at=\"{} {} 0\" mass=\"1\" inertia=\"0.1 0.1 0.1\"/>",
                        side, i, i, side[0] == 'l' ? 0 : 1) +
            joint("revolute", fmt::format("j{}{}", side, i),
                  i == 0 ? fmt::format("ground {}0", side)
                         : fmt::format("{}{} {}{}", side, i - 1, side, i),
                  i - 0.5);
    for (int i = 0; i < n; ++i)
      text += fmt::format(
          "<body name=\"rung{0}\" at=\"{0} 0.5 0\" mass=\"1\" inertia=\"1 1 1\"/>"
          "<revolute name=\"a{0}\" between=\"l{0} rung{0}\" at=\"{0} 0 0\" axis=\"0 1 0\"/>"
          "<revolute name=\"b{0}\" between=\"rung{0} r{0}\" at=\"{0} 1 0\" axis=\"0 1 0\"/>",
          i);
    const Scene scene = read_model_text(model(text));
    const Model compiled = compile(scene);
    EXPECT_GT(compiled.redundant.size(), static_cast<std::size_t>(2 * n));
  });
  EXPECT_LT(of_loops, 3.0);  // idle rows are chosen by dense algebra, up to 1000 of them
}

// Whole runs, of parts in one row, in a tree and in a grid.
void run_of(const std::string& inside) {
  const RunReport report =
      run(read_model_text("<mbd name=\"m\">" + inside + "</mbd>"), {.estimate_error = false});
  ASSERT_TRUE(report.complete()) << report.failure;
}

const char* const soft =
    R"(<section name="s"><stiffness EA="1e5" GA2="4e4" GA3="4e4" GJ="80" EI2="100" EI3="100"/>
    <mass per_length="1" inertia="2e-4 1e-4 1e-4"/></section>)";
const char* const steps =
    R"(<gravity acceleration="0 0 -9.81"/><transient duration="0.01" step="0.002" rho_infinity="0.5"/>)";

std::string bar(const std::string& name, double x, double y, double to_x, double to_y) {
  return fmt::format(
      "<beam name=\"{}\" section=\"s\" from=\"{} {} 0\" to=\"{} {} 0\" normal=\"0 0 1\"/>", name, x,
      y, to_x, to_y);
}
std::string weld(const std::string& a, const std::string& b) {
  return fmt::format("<fixed name=\"{0}_{1}\" between=\"{2} {3}\"/>",
                     a.substr(0, a.find('.')) + a.substr(a.find('.') + 1),
                     b.substr(0, b.find('.')) + b.substr(b.find('.') + 1), a, b);
}

TEST(CostsSlow, RunsOfCantilevers) {
  EXPECT_LT(exponent(400,
                     [](int n) {
                       run_of(soft +
                              fmt::format(R"(<beam name="b" section="s" from="0 0 0" to="1 0 0"
                           normal="0 0 1" elements="{}"/>)",
                                          n) +
                              R"(<fixed name="f" between="ground b.start"/>
                              <load at="b.end" force="0 0 -100"/><static/>)");
                     }),
            near_linear);
}

TEST(CostsSlow, RunsOfChains) {
  EXPECT_LT(exponent(250,
                     [](int n) {
                       std::string text;
                       for (int i = 0; i < n; ++i)
                         text += body(fmt::format("b{}", i), i) +
                                 joint("spherical", fmt::format("j{}", i),
                                       i == 0 ? "ground b0" : fmt::format("b{} b{}", i - 1, i),
                                       i - 0.5);
                       run_of(text + steps);
                     }),
            near_linear);
}

// Each beam has two at its end.
TEST(CostsSlow, RunsOfTrees) {
  EXPECT_LT(
      exponent(120,
               [](int n) {
                 std::string text = soft;
                 std::vector<std::array<double, 2>> end;
                 for (int i = 0; i < n; ++i) {
                   const auto parent = static_cast<std::size_t>((i - 1) / 2);
                   const std::array<double, 2> from = i == 0 ? std::array{0.0, 0.0} : end[parent];
                   end.push_back({from[0] + 1.0, from[1] + (i % 2 == 0 ? 1.0 : -1.0) / (1.0 + i)});
                   const std::string name = fmt::format("b{}", i);
                   text += bar(name, from[0], from[1], end.back()[0], end.back()[1]) +
                           (i == 0 ? R"(<fixed name="f" between="ground b0.start"/>)"
                                   : weld(fmt::format("b{}.end", parent), name + ".start"));
                 }
                 run_of(text + steps);
               }),
      near_linear);
}

// Squares of beams, k in a row, held along one side.
TEST(CostsSlow, RunsOfGrids) {
  EXPECT_LT(exponent(36,
                     [](int n) {
                       const int k = static_cast<int>(std::lround(std::sqrt(n)));
                       std::string text = soft;
                       for (int i = 0; i <= k; ++i)
                         for (int j = 0; j <= k; ++j) {
                           // Which ends meet at the node (i, j): each but the first is welded to the first.
                           std::vector<std::string> ends;
                           const std::string across = fmt::format("x{}y{}", i, j),
                                             up = fmt::format("u{}y{}", i, j);
                           if (i < k)
                             text += bar(across, i, j, i + 1, j), ends.push_back(across + ".start");
                           if (j < k)
                             text += bar(up, i, j, i, j + 1), ends.push_back(up + ".start");
                           if (i > 0) ends.push_back(fmt::format("x{}y{}.end", i - 1, j));
                           if (j > 0) ends.push_back(fmt::format("u{}y{}.end", i, j - 1));
                           if (i == 0)
                             text += fmt::format("<fixed name=\"f{}\" between=\"ground {}\"/>", j,
                                                 ends[0]);
                           for (std::size_t e = 1; e < ends.size(); ++e)
                             text += weld(ends[0], ends[e]);
                         }
                       run_of(text + R"(<load at="x0y0.end" force="0 0 -1"/><static/>)");
                     }),
            near_linear);
}

TEST(Costs, JointsInOnePlaceHaveALimit) {
  const auto many = [](int n) {
    std::string text = body("b", 0.0);
    for (int i = 0; i < n; ++i) text += joint("revolute", fmt::format("j{}", i), "ground b", 0.0);
    return model(text);
  };
  EXPECT_EQ(failure_of(many(150)), "");
  const double before = used_cpu();
  EXPECT_NE(failure_of(many(300)).find("more than 1000 constraint rows repeat others"),
            std::string::npos);
  const double of_300 = used_cpu() - before;
  EXPECT_NE(failure_of(many(1200)).find("leave joints out"), std::string::npos);
  EXPECT_LT(used_cpu() - before - of_300, 16.0 * of_300 + 0.1);  // it was 4^3.8
}

TEST(Costs, SmoothTables) {
  const auto table = [](int n) {
    Section section;
    section.name = "s";
    section.interpolation = Interpolation::smooth;
    for (int i = 0; i < n; ++i) {
      Station station;
      station.at = i / (n - 1.0);
      station.stiffness = Mat6::Identity() * (2.0 + std::sin(3.0 * station.at));
      section.stations.push_back(station);
    }
    return section;
  };
  // A dense matrix had 3. Fresh pages of memory, which large tables alone need, make up to 2 of 1 here.
  EXPECT_LT(exponent(2000, [&](int n) { const SectionTable made(table(n)); }), 2.5);
  // It goes through its stations, and follows a smooth law between them.
  const Section fine = table(3001);
  const SectionTable made(fine);
  for (int i = 0; i < 3000; i += 37) {
    EXPECT_NEAR(made.stiffness(fine.stations[static_cast<std::size_t>(i)].at)(0, 0),
                fine.stations[static_cast<std::size_t>(i)].stiffness(0, 0), 1e-13);
    const double between = (i + 0.5) / 3000.0;
    EXPECT_NEAR(made.stiffness(between)(3, 3), 2.0 + std::sin(3.0 * between), 1e-12);
  }
}

TEST(Costs, AttributesHaveALimit) {
  const auto with = [](int n) {
    std::string text = "<body name=\"b\" mass=\"1\" inertia=\"1 1 1\"";
    for (int i = 0; i < n; ++i) text += fmt::format(" a{}='{}>='", i, i);
    return model(text + "/>");
  };
  EXPECT_NE(failure_of(with(900)).find("unknown attribute"), std::string::npos);
  EXPECT_NE(failure_of(with(1001)).find("<body> has more than 1000 attributes"), std::string::npos);
  EXPECT_LT(exponent(20000, [&](int n) { EXPECT_NE(failure_of(with(n)), ""); }), near_linear);
  // What only looks like attributes is none.
  std::string many;
  for (int i = 0; i < 3000; ++i) many += "a='1' ";
  EXPECT_EQ(failure_of(model("<!-- <b " + many + "/> -->" + body("b", 0.0))), "");
}

TEST(Costs, RepeatsOfNothing) {
  const auto with = [](int n) {
    std::string text =
        fmt::format("<repeat count=\"{}\" index=\"i\"><repeat count=\"0\" index=\"j\">", n);
    for (int i = 0; i < n; ++i) text += body("b", 0.0);
    return model(body("a", 0.0) + text + "</repeat></repeat>");
  };
  EXPECT_EQ(failure_of(with(900)), "");
  EXPECT_NE(failure_of(with(1100)).find("more than 1000000 elements by repetitions"),
            std::string::npos);
}

TEST(Costs, NamesAndPlacesOfTrees) {
  EXPECT_LT(
      exponent(255,
               [](int n) {
                 std::string text =
                     "<section name=\"s\"><stiffness EA=\"1\" GA2=\"1\" GA3=\"1\" GJ=\"1\" "
                     "EI2=\"1\" EI3=\"1\"/><mass per_length=\"1\" inertia=\"1 1 1\"/></section>";
                 for (int k = 1; k <= n; ++k)
                   text += fmt::format(
                       "<beam name=\"b{0}\" section=\"s\" from=\"{1} {2} 0\" to=\"{3} {4} 0\" "
                       "normal=\"0 0 1\" order=\"1\"/><fixed name=\"f{0}\" "
                       "between=\"{5} b{0}.start\"/>",
                       k, k / 2, k / 2, k, k, k == 1 ? "ground" : fmt::format("b{}.end", k / 2));
                 compile(read_model_text(model(text)));
               }),
      near_linear);
}

// Bodies that are attached to one another come in any order, and in any number.
TEST(Costs, BodiesAttachedInAChain) {
  EXPECT_LT(exponent(2000,
                     [](int n) {
                       std::string text = body("b0", 0.0);
                       for (int i = n; i > 0; --i)
                         text += fmt::format(
                             "<body name=\"b{}\" attached_to=\"b{}\" mass=\"1\" "
                             "inertia=\"1 1 1\"/>",
                             i, i - 1);
                       compile(read_model_text(model(text)));
                     }),
            near_linear);
}

}  // namespace
}  // namespace mbd::test::test_costs
