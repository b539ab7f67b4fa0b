// Every model of models/ runs to its end and gives the numbers it expects; runs that go wrong keep
// their results and say why; the command's exit status tells.

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "libmbd/language/reader.hpp"
#include "libmbd/results/expect.hpp"
#include "libmbd/results/history.hpp"
#include "libmbd/results/summary.hpp"
#include "libmbd/run/run.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/support/this_build.hpp"

namespace mbd::test::test_models {
namespace {

namespace fs = std::filesystem;
using mbd::History;

const fs::path models = fs::path(MBD_SOURCE_DIR) / "models";

std::vector<std::string> all_models() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(models))
    if (entry.path().extension() == ".xml") names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

class Models : public testing::TestWithParam<std::string> {};

TEST_P(Models, GiveWhatTheyExpect) {
  const Scene scene = read_model(models / (GetParam() + ".xml"));
  EXPECT_EQ(scene.name, GetParam());
  ASSERT_FALSE(scene.expects.empty()) << "a model is a test: give it <expect> rows";
  const RunReport report = run(scene);
  EXPECT_TRUE(report.complete()) << report.failure;
  EXPECT_TRUE(report.as_expected()) << summary(report);
}

INSTANTIATE_TEST_SUITE_P(Every, Models, testing::ValuesIn(all_models()),
                         [](const auto& model) { return model.param; });

// Models that have expectations for other values of their parameters meet those too.
struct Variant {
  std::string model;
  Overrides set;
  std::size_t rows;  // that hold then
};
void PrintTo(const Variant& v, std::ostream* out) {
  *out << v.model;
  for (const auto& [name, value] : v.set) *out << ' ' << name << '=' << value;
}

class Variants : public testing::TestWithParam<Variant> {};

TEST_P(Variants, GiveWhatTheyExpect) {
  const auto& [name, set, rows] = GetParam();
  const Scene scene = read_model(models / (name + ".xml"), set);
  EXPECT_EQ(scene.expects.size(), rows);
  const RunReport report = run(scene);
  EXPECT_TRUE(report.complete()) << report.failure;
  EXPECT_TRUE(report.as_expected()) << summary(report);
}

std::vector<Variant> all_variants() {
  std::vector<Variant> all;
  for (const char* const turns : {"2", "3.3"}) all.push_back({"roll_up", {{"turns", turns}}, 6});
  all.push_back({"roll_up", {{"turns", "10"}}, 7});
  for (const char* const load : {"1", "2", "5", "10"})
    all.push_back({"elastica", {{"load", load}}, 3});
  for (const char* const angle : {"0", "15", "30", "45", "60", "75", "90"}) {
    const bool plane = angle == std::string("0") || angle == std::string("90");
    all.push_back({"princeton", {{"angle", angle}}, plane ? 4u : 5u});
  }
  all.push_back({"shallow_arch", {{"EI", "1e8"}}, 4});
  all.push_back({"right_angle_frame", {{"d1", "-1"}}, 1});
  for (const char* const d2 : {"1", "-1"})
    all.push_back({"right_angle_frame", {{"d1", "0"}, {"d2", d2}}, 1});
  for (const char* const P : {"4.448", "13.345"}) all.push_back({"princeton", {{"P", P}}, 3});
  return all;
}

INSTANTIATE_TEST_SUITE_P(Every, Variants, testing::ValuesIn(all_variants()), [](const auto& v) {
  std::string name = v.param.model;
  for (const auto& [parameter, value] : v.param.set) name += "_" + parameter + "_" + value;
  std::replace(name.begin(), name.end(), '.', 'p');
  std::replace(name.begin(), name.end(), '-', 'm');
  return name;
});

// ---- runs that go wrong -----------------------------------------------------------------------

Scene falling_ball() {
  return read_model_text(R"(<mbd name="ball">
      <body name="ball" mass="1" inertia="1 1 1"/>
      <gravity acceleration="0 0 -9.81"/>
      <transient duration="1" step="0.01"/>
      <record name="ball" at="ball" quantities="position velocity"/>
    </mbd>)");
}

class Directory : public testing::Test {
 protected:
  nlohmann::json json() const {
    return nlohmann::json::parse(std::ifstream(path_ / "report.json"));
  }
  long rows() const {
    std::ifstream file(path_ / "history.csv");
    long n = 0;
    for (std::string line; std::getline(file, line);)
      n += line.starts_with('#') || line.starts_with("time") ? 0 : 1;
    return n;
  }

  const TemporaryDirectory scratch_;
  const fs::path path_ = scratch_.path();
};

using RunOf = Directory;

TEST_F(RunOf, WritesItsResults) {
  const RunReport report = run(falling_ball(), {.output = path_});
  EXPECT_TRUE(report.complete()) << report.failure;
  EXPECT_EQ(report.rows, 101);
  EXPECT_EQ(rows(), 101);
  EXPECT_EQ(report.results.size(), 3u);
  for (const fs::path& file : report.results) EXPECT_GT(fs::file_size(file), 500u) << file;
  EXPECT_EQ(json()["status"], "complete");
  EXPECT_NEAR(double(json()["energy"]["end"]["total"]), 0.0, 1e-9);
  EXPECT_LE(int(json()["sampled_states"]), 202);
}

TEST_F(RunOf, APathWritesItsResults) {
  std::ofstream(path_ / "history.csv") << "of an earlier run";
  Scene scene = read_model(models / "shallow_arch.xml", {{"EI", "1e8"}});
  scene.path->branch = 0;
  const RunReport report = run(scene, {.output = path_});
  EXPECT_TRUE(report.complete()) << report.failure;
  EXPECT_FALSE(fs::exists(path_ / "history.csv"));
  std::vector<std::string> names;
  for (const fs::path& file : report.results) names.push_back(file.filename().string());
  EXPECT_EQ(names, (std::vector<std::string>{"path.csv", "path.svg", "shapes.svg", "report.json"}));
  for (const fs::path& file : report.results) EXPECT_GT(fs::file_size(file), 500u) << file;

  const History history = read_history(path_);
  const auto column = [&](std::string_view name) {
    for (std::size_t i = 0; i < history.columns.size(); ++i)
      if (history.columns[i].name == name) return history.values[i];
    ADD_FAILURE() << name;
    return std::vector<double>{};
  };
  EXPECT_EQ(history.columns[0].name, "load_factor");
  const std::vector<double> event = column("event"), negative = column("negative_eigenvalues");
  EXPECT_EQ(std::count(event.begin(), event.end(), 1.0), 2);  // limit points
  EXPECT_EQ(event.back(), 3.0);                               // the stop
  EXPECT_EQ(*std::max_element(negative.begin(), negative.end()), 1.0);
  EXPECT_EQ(negative.back(), 0.0);

  const nlohmann::json all = json();
  EXPECT_EQ(all["status"], "complete");
  EXPECT_EQ(all["path"]["special_points"].size(), 3u);
  EXPECT_EQ(all["path"]["special_points"][0]["event"], "limit point");
  EXPECT_NEAR(double(all["path"]["special_points"][0]["load_factor"]), 193950.1924 / 2e5, 2e-9);
  EXPECT_EQ(all["path"]["special_points"][0]["negative_eigenvalues_after"], 1);
  const std::string said = summary(report);
  EXPECT_NE(said.find("limit point 1"), std::string::npos) << said;
  EXPECT_NE(said.find("negative eigenvalues 0 -> 1"), std::string::npos) << said;
  std::ifstream file(path_ / "shapes.svg");
  const std::string svg(std::istreambuf_iterator<char>(file), {});
  EXPECT_NE(svg.find("limit point 1, 0.96975"), std::string::npos);
}

class EndsAfter : public Observer {
 public:
  explicit EndsAfter(int states) : left_(states) {}
  void accepted(const Sample& /*sample*/) override {
    if (left_-- == 0) throw Error("the observer has seen enough");
  }
  void finished(const RunReport& /*report*/) override { finished_ = true; }
  bool finished_ = false;

 private:
  int left_;
};

TEST_F(RunOf, KeepsItsResultsWhenAnObserverEndsIt) {
  EndsAfter observer(40);
  const RunReport report = run(falling_ball(), {.output = path_, .observers = {&observer}});
  EXPECT_EQ(report.failure, "the observer has seen enough");
  EXPECT_TRUE(observer.finished_);
  EXPECT_NEAR(report.t, 0.4, 1e-12);
  EXPECT_EQ(rows(), 41);  // the writer comes before the user's observers
  EXPECT_EQ(json()["status"], "failed");
}

TEST_F(RunOf, AColumnThatIsNotFiniteEndsIt) {
  Scene scene = falling_ball();
  const auto component = [](const char* text) {
    return Expression::parse(text, {}, Variables::time);
  };
  LoadScene load;
  load.at = {Place::Kind::body, "ball", 0.0};
  load.force = {component("sqrt(0.5 - t)"), component("0"), component("0")};
  scene.loads.push_back(load);
  const RunReport report = run(scene, {.output = path_});
  EXPECT_FALSE(report.complete());
  EXPECT_NEAR(report.t, 0.5, 0.011);
  EXPECT_GE(rows(), 50);
  std::ifstream file(path_ / "history.csv");
  for (std::string line; std::getline(file, line);)
    EXPECT_EQ(line.find("nan"), std::string::npos) << line;
}

TEST_F(RunOf, RefusesWhatItCannotDo) {
  Scene scene = falling_ball();
  scene.transient.reset();
  EXPECT_THROW(run(scene), Error);  // nothing to do
  scene = falling_ball();
  ExpectScene expect;
  expect.quantity = "ball.position.3";
  expect.at = 0.505;
  scene.expects.push_back(expect);
  EXPECT_THROW(run(scene), Error);  // between two samples
  scene = falling_ball();
  scene.plots.emplace_back().y = {"ball.positon.3"};
  EXPECT_THROW(run(scene, {.output = path_}), Error);
  std::ofstream(path_ / "file") << "x";
  EXPECT_THROW(run(falling_ball(), {.output = path_ / "file"}), Error);
}

// ---- the command ------------------------------------------------------------------------------

using Command = Directory;

int status_of(const std::string& arguments) {
  const int status =
      std::system((std::string(test::mbd_program) + " " + arguments + " > /dev/null 2>&1").c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST_F(Command, ExitStatusTells) {
  const std::string out = " --out " + path_.string();
  const std::string pendulum = (models / "pendulum.xml").string();
  EXPECT_EQ(status_of("run " + pendulum + out), 0);
  EXPECT_EQ(status_of("run " + pendulum + " --set step=0.1" + out),
            2);  // too coarse for its expectations
  EXPECT_EQ(status_of("run " + pendulum + " --set stp=1" + out), 1);
  EXPECT_EQ(status_of("run " + pendulum + " --quiet --out /proc/nowhere"), 1);
  EXPECT_EQ(status_of("run nowhere.xml" + out), 1);
  EXPECT_EQ(status_of("--version"), 0);
  EXPECT_EQ(status_of("--help"), 0);
  EXPECT_GT(status_of("run"), 99);
  EXPECT_GT(status_of("walk " + pendulum), 99);
}

TEST_F(Command, AChainOfAnyLength) {
  const std::string chain = (models / "chain.xml").string();
  for (const char* const length : {"1", "3", "40"})
    EXPECT_EQ(status_of("run " + chain + " --set N=" + length + " --out " + path_.string()), 0)
        << length;
}

}  // namespace
}  // namespace mbd::test::test_models
