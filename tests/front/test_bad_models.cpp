// Wrong models. Each gives one message, on one line: file and line, the item, what is wrong and what to do;
// exit status 1, no crash, no result, and an earlier result stays. The same mistake in a Scene filled in
// C++ gives the same message without file and line.
//
// tests/bad_models/README.md is the table of files and messages. MBD_UPDATE_TABLES=1 writes it anew from
// what the tests got; without it, they compare. It is a regression table: what a message must say stands
// in bad_models_table.cpp, written before the messages were seen.
//
// How to add one: copy a model of tests/bad_models/good, make the mistake, say it in the comment on line 1,
// add a row to bad_models_table.cpp and write the table anew.

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <deque>
#include <limits>
#include <map>
#include <optional>
#include <regex>
#include <set>
#include <thread>

#include "libmbd/language/reader.hpp"
#include "libmbd/run/run.hpp"
#include "libmbd/text/files.hpp"
#include "tests/front/bad_models.hpp"
#include "tests/support/program.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/support/this_build.hpp"

namespace mbd::test::test_bad_models {
namespace {

namespace fs = std::filesystem;
using test::bad_models;
using test::BadModel;
using test::contents;
using test::Ended;
using test::Program;

constexpr double most_cpu = 2.0;  // [s] a guard: a small model is refused in milliseconds
constexpr std::size_t longest_message = 2000;  // [bytes]
constexpr std::size_t at_once = 2;             // programs

const fs::path models = fs::path(MBD_SOURCE_DIR) / "tests" / "bad_models";

std::string name_of(const BadModel& model) { return std::string(model.file) + ".xml"; }

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    lines.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return lines;
}

// Whether f holds for one of the alternatives of "a|b".
template <class F>
bool any_of(std::string_view alternatives, const F& f) {
  for (std::size_t at = 0; at <= alternatives.size();) {
    const std::size_t end = std::min(alternatives.find('|', at), alternatives.size());
    if (f(alternatives.substr(at, end - at))) return true;
    at = end + 1;
  }
  return false;
}

bool contains(const std::string& text, std::string_view part) {
  return text.find(part) != std::string::npos;
}

// One line that people can read.
void expect_readable(const std::string& message) {
  EXPECT_FALSE(message.empty());
  EXPECT_LE(message.size(), longest_message);
  EXPECT_TRUE(std::none_of(message.begin(), message.end(), [](char c) {
    return std::iscntrl(static_cast<unsigned char>(c));
  })) << "control characters or several lines";
}

// "FILE:LINE: " cut off, or nothing if the message begins otherwise.
std::optional<std::pair<int, std::string>> split(const std::string& message,
                                                 const std::string& file) {
  if (!message.starts_with(file + ":")) return std::nullopt;
  std::size_t at = file.size() + 1;
  const std::size_t digits = at;
  while (at < message.size() && message[at] >= '0' && message[at] <= '9') ++at;
  if (at == digits || at - digits > 6 || message.substr(at, 2) != ": ") return std::nullopt;
  return std::pair(std::stoi(message.substr(digits, at - digits)), message.substr(at + 2));
}

// Without the lines of other items, which a Scene does not know: " (line 3)", " (other.xml:3)".
std::string without_lines(const std::string& message) {
  static const std::regex other(R"( \((line |[^ ()]*:)[0-9]+\))");
  return std::regex_replace(message, other, "");
}

// After the semicolon, or in words that ask for something or tell what there is.
bool has_remedy(const std::string& message) {
  return any_of("; |must |give |write |leave | are: |is missing: ",
                [&](std::string_view either) { return contains(message, either); });
}

void expect_says(const std::string& message, const BadModel& model) {
  expect_readable(message);
  const std::string file = model.where.empty() ? name_of(model) : std::string(model.where);
  const auto parts = split(message, file);
  ASSERT_TRUE(parts) << "does not begin with " << file << ":LINE: ";
  const auto& [line, rest] = *parts;
  EXPECT_NE(std::find(model.lines.begin(), model.lines.end(), line), model.lines.end())
      << "line " << line << ", not " << ::testing::PrintToString(model.lines);
  EXPECT_TRUE(any_of(model.label,
                     [&](std::string_view label) {
                       return label.empty() || rest.starts_with(std::string(label) + ": ");
                     }))
      << "does not begin with the item " << model.label;
  for (const std::string_view part : model.parts)
    EXPECT_TRUE(any_of(part, [&](std::string_view either) { return contains(rest, either); }))
        << "does not say " << part;
  EXPECT_TRUE(has_remedy(rest)) << "has no remedy";
}

// What the library says of a model; where something has been written, or all went well, that.
template <class Read>
std::string message_of(const Read& read, const fs::path& output) {
  std::string message;
  try {
    const Scene scene = read();
    const RunReport report = run(scene, {.output = output, .observers = {}, .progress = {}});
    message = report.complete() ? "(no error)" : "(the run ended) " + report.failure;
  } catch (const Error& error) {
    message = error.what();
  } catch (const std::exception& error) {
    message = std::string("(not an mbd::Error) ") + error.what();
  }
  if (fs::exists(output)) {
    message += " (results were written)";
    fs::remove_all(output);
  }
  return message;
}

// In the directory of the wrong models, with a scratch directory elsewhere.
class BadModels : public ::testing::Test {
 protected:
  void SetUp() override {
    before_ = fs::current_path();
    fs::current_path(models);
  }
  void TearDown() override { fs::current_path(before_); }

  std::string library_says(const BadModel& model) const {
    return message_of([&] { return read_model(name_of(model)); }, scratch_ / "results");
  }

  // Runs a command for each model, a few at a time, and shows how each ended.
  template <class Show>
  void run_each(const std::vector<std::string>& command, bool with_output, const Show& show) const {
    std::deque<std::pair<const BadModel*, Program>> running;
    const auto take = [&] {
      const auto& [model, program] = running.front();
      SCOPED_TRACE(name_of(*model));
      show(*model, running.front().second.wait());
      running.pop_front();
    };
    for (const BadModel& model : bad_models()) {
      const fs::path output = scratch_ / model.file;
      std::vector<std::string> arguments = command;
      arguments.push_back(name_of(model));
      if (with_output) {
        fs::create_directory(output);
        for (const char* name : results_) write_file(output / name, "an earlier result\n");
        arguments.insert(arguments.end(), {"--out", output.string()});
      }
      if (running.size() == at_once) take();
      running.emplace_back(&model, Program(arguments, scratch_ / (std::string(model.file) + "_")));
    }
    while (!running.empty()) take();
  }

  static void expect_refused(const Ended& ended, double cpu = most_cpu) {
    EXPECT_FALSE(ended.hung);
    EXPECT_EQ(ended.status, 1);
    EXPECT_LT(ended.cpu, guard(cpu));
    EXPECT_EQ(ended.out, "");
    EXPECT_TRUE(ended.err.starts_with("mbd: ") && ended.err.ends_with("\n"));
  }

  // "mbd: " and the end of the line cut off.
  static std::string message_in(const std::string& err) {
    return err.size() > 6 ? err.substr(5, err.size() - 6) : err;
  }

  // An earlier result is what it was, and nothing is beside it.
  static void expect_earlier_results(const fs::path& output) {
    std::set<std::string> there;
    for (const fs::directory_entry& entry : fs::directory_iterator(output))
      there.insert(entry.path().filename().string());
    EXPECT_EQ(there, std::set<std::string>(results_.begin(), results_.end()));
    for (const char* name : results_) EXPECT_EQ(contents(output / name), "an earlier result\n");
  }

  static constexpr std::array<const char*, 3> results_ = {"history.csv", "history.svg",
                                                          "report.json"};
  const TemporaryDirectory directory_;
  const fs::path scratch_ = directory_.path();
  fs::path before_;
};

// ---- the files --------------------------------------------------------------------------------

// What the wrong models were made from runs, and gives the numbers it expects.
TEST_F(BadModels, AreMadeFromSoundOnes) {
  for (const fs::directory_entry& entry : fs::directory_iterator("good")) {
    SCOPED_TRACE(entry.path());
    const RunReport report = run(read_model(entry.path()));
    EXPECT_TRUE(report.complete()) << report.failure;
    EXPECT_TRUE(report.as_expected());
    for (const std::string& note : report.notes)  // of a follower load, and of a hinge given twice
      EXPECT_TRUE(note.find("stability") != std::string::npos ||
                  note.find("repeat others") != std::string::npos)
          << note;
  }
}

TEST_F(BadModels, AllStandInTheTable) {
  std::set<std::string> here, there;
  for (const fs::directory_entry& entry : fs::directory_iterator("."))
    if (entry.path().extension() == ".xml") here.insert(entry.path().filename().string());
  for (const BadModel& model : bad_models())
    EXPECT_TRUE(there.insert(name_of(model)).second) << name_of(model) << " stands there twice";
  EXPECT_EQ(here, there);
  EXPECT_GE(here.size(), 50u);
}

// A wrong model says in its first line what is wrong, and differs from a sound one there only.
TEST_F(BadModels, HoldOneMistakeEach) {
  for (const BadModel& model : bad_models()) {
    SCOPED_TRACE(name_of(model));
    const std::string text = contents(name_of(model));
    if (text.starts_with("\xFF\xFE") || text.empty() || text[0] != '<') continue;  // no XML
    EXPECT_TRUE(text.starts_with("<!-- wrong: "));
    if (model.base.empty()) continue;
    const std::vector<std::string> bad = lines_of(text);
    const std::vector<std::string> good =
        lines_of(contents("good/" + std::string(model.base) + ".xml"));
    std::size_t same = 1, end = 0;
    while (same < std::min(bad.size(), good.size()) && bad[same] == good[same]) ++same;
    const std::size_t rest = std::min(bad.size(), good.size()) - same;
    while (end < rest && bad[bad.size() - 1 - end] == good[good.size() - 1 - end]) ++end;
    const std::size_t edited = std::max(bad.size(), good.size()) - end - same;
    EXPECT_LE(edited, static_cast<std::size_t>(model.edited));
  }
}

// ---- the program ------------------------------------------------------------------------------

using BadModelsSlow = BadModels;
TEST_F(BadModelsSlow, AreRefusedByTheProgram) {
  run_each({"run"}, true, [&](const BadModel& model, const Ended& ended) {
    SCOPED_TRACE(ended.err);
    expect_refused(ended);
    expect_says(message_in(ended.err), model);
    expect_earlier_results(scratch_ / model.file);
  });
  EXPECT_FALSE(fs::exists("results"));
}

// `mbd check` says what `mbd run` says.
// Twice as many programs under the sanitizers would show nothing new.
using BadModelsSlow = BadModels;

TEST_F(BadModelsSlow, AreRefusedByCheck) {
  if (!contains(Program({"--help"}, scratch_ / "help").wait().out, "\n  check "))
    GTEST_SKIP() << "this mbd has no command check";
  // What only the solution of the first equations finds; check reports the freedoms, and that is all.
  const std::set<std::string> found_by_a_run = {"body_without_inertia_on_a_hinge",
                                                "nothing_holds_it"};
  run_each({"check"}, false, [&](const BadModel& model, const Ended& ended) {
    SCOPED_TRACE(ended.err);
    if (found_by_a_run.contains(std::string(model.file))) {
      EXPECT_EQ(ended.status, 0);
      EXPECT_TRUE(contains(ended.out, " is left") || contains(ended.out, " are left")) << ended.out;
      return;
    }
    expect_refused(ended);
    EXPECT_EQ(message_in(ended.err), library_says(model));
  });
  EXPECT_FALSE(fs::exists("results"));
}

// The library throws what the program prints, and makes no directory.
TEST_F(BadModels, AreRefusedByTheLibrary) {
  for (const BadModel& model : bad_models()) {
    const std::string message = library_says(model);
    SCOPED_TRACE(name_of(model) + ": " + message);
    EXPECT_FALSE(message.starts_with("(") || message.ends_with("(results were written)"));
    EXPECT_TRUE(contains(message, ".xml:"));
  }
}

// ---- scenes filled in C++ ---------------------------------------------------------------------

void forget_sources(Scene& scene) {
  scene.file.clear();
  const auto clear = [](auto& items) {
    for (auto& item : items) item.source = Source{};
  };
  clear(scene.sections);
  for (Section& section : scene.sections) clear(section.stations);
  clear(scene.beams);
  for (BeamScene& beam : scene.beams)
    if (Curve* const curve = std::get_if<Curve>(&beam.line)) clear(curve->points);
  clear(scene.bodies);
  clear(scene.joints);
  clear(scene.drives);
  clear(scene.motions);
  clear(scene.loads);
  clear(scene.distributed_loads);
  clear(scene.point_masses);
  clear(scene.drags);
  clear(scene.added_masses);
  for (BodyScene& body : scene.bodies) clear(body.shapes);
  for (BeamScene& beam : scene.beams)
    if (beam.shape) beam.shape->source = Source{};
  if (scene.base_motion) scene.base_motion->source = Source{};
  const auto clear_law = [](std::optional<LawScene>& law) {
    if (TableScene* const table = law ? std::get_if<TableScene>(&*law) : nullptr)
      table->source = Source{};
  };
  clear(scene.springs);
  for (SpringScene& spring : scene.springs)
    clear_law(spring.force), clear_law(spring.damping_force);
  clear(scene.bushings);
  for (BushingScene& bushing : scene.bushings) clear(bushing.laws);
  clear(scene.joint_springs);
  clear(scene.joint_torques);
  clear(scene.rigids);
  scene.source = Source{};
  if (scene.gravity) scene.gravity->source = Source{};
  if (scene.statics) scene.statics->source = Source{};
  if (scene.transient) scene.transient->source = Source{};
  clear(scene.records);
  clear(scene.plots);
  clear(scene.expects);
}

// A sound scene as if filled in C++.
Scene sound(std::string_view base) {
  Scene scene = read_model("good/" + std::string(base) + ".xml");
  forget_sources(scene);
  return scene;
}

// While it lives, a scene that asks for all of the memory gets std::bad_alloc, not the machine's swap.
class LimitedMemory {
 public:
  LimitedMemory() {
    getrlimit(RLIMIT_AS, &before_);
    if (sanitized()) return;  // it maps terabytes
    const rlimit limit{rlim_t{4} << 30, before_.rlim_max};
    setrlimit(RLIMIT_AS, &limit);
  }
  ~LimitedMemory() { setrlimit(RLIMIT_AS, &before_); }

 private:
  rlimit before_{};
};

TEST_F(BadModels, GiveTheSameMessageAsScenes) {
  const LimitedMemory limit;
  int twins = 0;
  for (const BadModel& model : bad_models()) {
    if (!model.twin.spoil) {
      EXPECT_FALSE(model.twin.reason.empty()) << name_of(model);
      continue;
    }
    ++twins;
    const std::string of_file = library_says(model);
    const auto parts = split(of_file, name_of(model));
    SCOPED_TRACE(name_of(model) + ": " + of_file);
    const std::string of_scene = message_of(
        [&] {
          Scene scene = sound(model.base);
          model.twin.spoil(scene);
          return scene;
        },
        scratch_ / "results");
    EXPECT_EQ(of_scene, without_lines(parts ? parts->second : of_file));
  }
  EXPECT_GE(twins, 100);
}

// What only C++ can do: put what is not finite where a number belongs.
struct NotFinite {
  std::string_view base, label, member;  // as written in a model; "a|b": either
  std::function<void(Scene&, double)> put;
};

const std::vector<NotFinite>& not_finite() {
  static const std::vector<NotFinite> all = {
      {"cantilever", "beam \"b\"", "from",
       [](Scene& s, double x) { std::get<Straight>(s.beams[0].line).from(1) = x; }},
      {"cantilever", "beam \"b\"", "to",
       [](Scene& s, double x) { std::get<Straight>(s.beams[0].line).to(0) = x; }},
      {"cantilever", "beam \"b\"", "normal", [](Scene& s, double x) { s.beams[0].normal(2) = x; }},
      {"bow", "arc \"bow\"", "from",
       [](Scene& s, double x) { std::get<Arc>(s.beams[0].line).from(0) = x; }},
      {"bow", "arc \"bow\"", "center",
       [](Scene& s, double x) { std::get<Arc>(s.beams[0].line).center(0) = x; }},
      {"bow", "arc \"bow\"", "axis",
       [](Scene& s, double x) { std::get<Arc>(s.beams[0].line).axis(2) = x; }},
      {"bow", "arc \"bow\"", "angle",
       [](Scene& s, double x) { std::get<Arc>(s.beams[0].line).angle = x; }},
      {"curve", "point|curve \"c\"", "at",
       [](Scene& s, double x) { std::get<Curve>(s.beams[0].line).points[1].at(0) = x; }},
      {"curve", "point|curve \"c\"", "twist",
       [](Scene& s, double x) { std::get<Curve>(s.beams[0].line).points[1].twist = x; }},
      {"curve", "point|curve \"c\"", "normal",
       [](Scene& s, double x) {
         std::get<Curve>(s.beams[0].line).points[1].normal = Vec3(0, 0, x);
       }},
      {"cantilever", "section \"strip\"|stiffness", "stiffness|EA",
       [](Scene& s, double x) { s.sections[0].stiffness(0, 0) = -x; }},
      {"cantilever", "section \"strip\"|stiffness", "stiffness|D14",
       [](Scene& s, double x) {
         s.sections[0].stiffness(0, 3) = s.sections[0].stiffness(3, 0) = x;
       }},
      {"blade", "section \"taper\"|station|mass", "mass",
       [](Scene& s, double x) { (*s.sections[0].stations[1].mass)(5, 5) = x; }},
      {"blade", "section \"taper\"|station", "at",
       [](Scene& s, double x) { s.sections[0].stations[1].at = x; }},
      {"pendulum", "body \"rod\"", "mass", [](Scene& s, double x) { s.bodies[0].mass = x; }},
      {"pendulum", "body \"rod\"", "center", [](Scene& s, double x) { s.bodies[0].center(0) = x; }},
      {"pendulum", "body \"rod\"", "inertia",
       [](Scene& s, double x) { s.bodies[0].inertia(1, 1) = x; }},
      {"pendulum", "body \"rod\"", "at", [](Scene& s, double x) { s.bodies[0].at(0) = x; }},
      {"pendulum", "body \"rod\"", "orientation",
       [](Scene& s, double x) { s.bodies[0].orientation(0, 0) = x; }},
      {"pendulum", "body \"rod\"", "velocity",
       [](Scene& s, double x) { s.bodies[0].velocity(0) = x; }},
      {"pendulum", "body \"rod\"", "angular_velocity",
       [](Scene& s, double x) { s.bodies[0].angular_velocity(1) = x; }},
      {"pendulum", "revolute \"hinge\"", "at",
       [](Scene& s, double x) { s.joints[0].at = Vec3(x, 0, 0); }},
      {"pendulum", "revolute \"hinge\"", "axis",
       [](Scene& s, double x) { s.joints[0].axis = Vec3(0, x, 0); }},
      {"machine", "screw \"guide\"", "pitch",
       [](Scene& s, double x) {
         s.joints[1].kind = "screw";
         s.joints[1].parameter = x;
       }},
      {"machine", "distance \"rope\"", "at_a",
       [](Scene& s, double x) {
         JointScene& j = s.joints.emplace_back(s.joints[1]);
         j.kind = "distance";
         j.name = "rope";
         j.axis.reset();
         j.at.reset();
         j.at_a = Vec3(x, 0, 0);
       }},
      {"cantilever", "load \"push\"", "at|b@",
       [](Scene& s, double x) { s.loads[0].at.parameter = x; }},
      {"cantilever", "load \"push\"", "offset",
       [](Scene& s, double x) { s.loads[0].offset(0) = x; }},
      {"blade", "distributed", "from", [](Scene& s, double x) { s.distributed_loads[0].from = x; }},
      {"blade", "distributed", "to", [](Scene& s, double x) { s.distributed_loads[0].to = x; }},
      {"pendulum", "point_mass \"bob\"", "mass",
       [](Scene& s, double x) { s.point_masses[0].mass = x; }},
      {"pendulum", "point_mass \"bob\"", "offset",
       [](Scene& s, double x) { s.point_masses[0].offset(0) = x; }},
      {"diver", "drag \"fin\"", "density", [](Scene& s, double x) { s.drags[1].density = x; }},
      {"diver", "drag \"fin\"", "area", [](Scene& s, double x) { s.drags[1].area = x; }},
      {"diver", "drag \"fin\"", "coefficient",
       [](Scene& s, double x) { s.drags[1].coefficient = x; }},
      {"diver", "drag \"fin\"", "offset",
       [](Scene& s, double x) { s.drags[1].offset = Vec3(0, x, 0); }},
      {"diver", "drag \"current\"", "diameter",
       [](Scene& s, double x) { s.drags[0].diameter = x; }},
      {"diver", "drag \"current\"", "from", [](Scene& s, double x) { s.drags[0].from = x; }},
      {"diver", "drag \"current\"", "to", [](Scene& s, double x) { s.drags[0].to = x; }},
      {"diver", "drag \"current\"", "normal_coefficient",
       [](Scene& s, double x) { s.drags[0].normal_coefficient = x; }},
      {"diver", "drag \"current\"", "tangential_coefficient",
       [](Scene& s, double x) { s.drags[0].tangential_coefficient = x; }},
      {"diver", "added_mass \"water\"", "density",
       [](Scene& s, double x) { s.added_masses[0].density = x; }},
      {"diver", "added_mass \"water\"", "diameter",
       [](Scene& s, double x) { s.added_masses[0].diameter = x; }},
      {"diver", "added_mass \"water\"", "coefficient",
       [](Scene& s, double x) { s.added_masses[0].coefficient = x; }},
      {"diver", "added_mass \"sole\"", "matrix",
       [](Scene& s, double x) { (*s.added_masses[1].matrix)(2, 4) = x; }},
      {"pendulum", "gravity", "acceleration",
       [](Scene& s, double x) { s.gravity->acceleration(2) = x; }},
      {"pendulum", "transient", "duration", [](Scene& s, double x) { s.transient->duration = x; }},
      {"pendulum", "transient", "step", [](Scene& s, double x) { s.transient->step = x; }},
      {"pendulum", "transient", "rho_infinity",
       [](Scene& s, double x) { s.transient->rho_infinity = x; }},
      {"pendulum", "transient", "newton_tolerance",
       [](Scene& s, double x) { s.transient->newton_tolerance = x; }},
      {"pendulum", "transient", "output", [](Scene& s, double x) { s.transient->output = x; }},
      {"pendulum", "transient", "tolerance",
       [](Scene& s, double x) {
         s.transient->step.reset();
         s.transient->tolerance = x;
       }},
      {"pendulum", "transient", "max_step",
       [](Scene& s, double x) {
         s.transient->step.reset();
         s.transient->tolerance = 1e-6;
         s.transient->max_step = x;
       }},
      {"cantilever", "static", "tolerance", [](Scene& s, double x) { s.statics->tolerance = x; }},
      {"pendulum", "plot", "x_scale", [](Scene& s, double x) { s.plots[0].x_scale = x; }},
      {"pendulum", "plot", "y_scale", [](Scene& s, double x) { s.plots[0].y_scale = x; }},
      {"pendulum", "plot", "x_range",
       [](Scene& s, double x) {
         s.plots[0].x_range = {0.0, x};
       }},
      {"pendulum", "expect", "at", [](Scene& s, double x) { s.expects[0].at = x; }},
      {"pendulum", "expect", "value", [](Scene& s, double x) { s.expects[0].value = x; }},
      {"pendulum", "expect", "tolerance", [](Scene& s, double x) { s.expects[0].tolerance = x; }},
  };
  return all;
}

TEST_F(BadModels, ScenesAreFiniteThroughout) {
  const LimitedMemory limit;
  for (const NotFinite& row : not_finite())
    for (const double x :
         {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
      const std::string message = message_of(
          [&] {
            Scene scene = sound(row.base);
            row.put(scene, x);
            return scene;
          },
          scratch_ / "results");
      SCOPED_TRACE(std::string(row.label) + " " + std::string(row.member) + "=" +
                   std::to_string(x) + ": " + message);
      expect_readable(message);
      EXPECT_TRUE(any_of(
          row.label, [&](auto label) { return message.starts_with(std::string(label) + ": "); }));
      EXPECT_TRUE(any_of(row.member, [&](auto member) { return contains(message, member); }));
      EXPECT_TRUE(contains(message, "nan") || contains(message, "inf") ||
                  contains(message, "finite"));
      EXPECT_FALSE(contains(message, "(results were written)"));
    }
}

// Other mistakes that a model file cannot make.
TEST_F(BadModels, ScenesHoldMoreMistakes) {
  struct Row {
    std::string_view base, label, part;
    std::function<void(Scene&)> spoil;
  };
  const std::vector<Row> rows = {
      {"blade", "section \"taper\"|station", "symmetric",
       [](Scene& s) { (*s.sections[0].stations[1].mass)(0, 1) = 0.1; }},
      {"pendulum", "body \"rod\"", "symmetric", [](Scene& s) { s.bodies[0].inertia(0, 1) = 0.01; }},
      {"pendulum", "hinge \"hinge\"", "hinge", [](Scene& s) { s.joints[0].kind = "hinge"; }},
      {"pendulum", "point_mass|load|body", "name", [](Scene& s) { s.bodies[0].name.clear(); }},
      {"cantilever", "plot", "column", [](Scene& s) { s.plots[0].y[0].clear(); }},
      {"cantilever", "plot", "y", [](Scene& s) { s.plots[0].y.clear(); }},
      {"diver", "added_mass \"sole\"", "symmetric",
       [](Scene& s) { (*s.added_masses[1].matrix)(2, 4) = 0.1; }},
      {"cantilever", "static", "steps", [](Scene& s) { s.statics->steps = -1; }},
      {"cantilever", "beam \"b\"", "order", [](Scene& s) { s.beams[0].order = -1; }},
      {"curve", "curve \"c\"", "degree",
       [](Scene& s) { std::get<Curve>(s.beams[0].line).degree = -1; }},
      {"curve", "curve \"c\"", "point",
       [](Scene& s) { std::get<Curve>(s.beams[0].line).points.clear(); }},
      {"blade", "section \"taper\"", "station", [](Scene& s) { s.sections[0].stations.resize(1); }},
      {"cantilever", "load \"push\"", "0", [](Scene& s) { s.loads[0].at.parameter = -1e-3; }},
  };
  const LimitedMemory limit;
  for (const Row& row : rows) {
    const std::string message = message_of(
        [&] {
          Scene scene = sound(row.base);
          row.spoil(scene);
          return scene;
        },
        scratch_ / "results");
    SCOPED_TRACE(std::string(row.label) + ": " + message);
    expect_readable(message);
    EXPECT_TRUE(
        any_of(row.label, [&](auto label) { return message.starts_with(std::string(label)); }));
    EXPECT_TRUE(contains(message, row.part));
    EXPECT_FALSE(message.starts_with("(") || message.ends_with("(results were written)"));
  }
}

// ---- made while the test runs: too large to keep ----------------------------------------------

// A model of any size, written piece by piece.
template <class Write>
void make(const fs::path& file, const Write& write) {
  std::ofstream stream(file, std::ios::binary);
  write(stream);
  if (!stream.flush()) throw std::runtime_error("cannot write " + file.string());
}

const std::string in_model = "<mbd name=\"large\">\n";
const std::string end_model = "\n<static/>\n</mbd>\n";

std::string repeated(std::string_view text, std::size_t count) {
  std::string all;
  all.reserve(text.size() * count);
  for (std::size_t i = 0; i < count; ++i) all += text;
  return all;
}

class LargeModelsSlow : public BadModels {
 protected:
  const Ended& run_large(const fs::path& file, const std::string& part) {
    const fs::path output = scratch_ / "results";
    program_.emplace(std::vector<std::string>{"run", file.string(), "--out", output.string()},
                     scratch_ / "large");
    const Ended& ended = program_->wait();
    SCOPED_TRACE(file.filename().string() + ": " + ended.err.substr(0, longest_message));
    expect_refused(ended, 60.0);  // the largest takes 2 s
    expect_readable(message_in(ended.err));
    EXPECT_TRUE(message_in(ended.err).starts_with(file.string() + ":"));
    EXPECT_TRUE(contains(ended.err, part)) << "does not say " << part;
    rusage own{};  // of which a new process inherits the peak
    getrusage(RUSAGE_SELF, &own);
    EXPECT_LE(ended.memory, std::max(most_memory, own.ru_maxrss)) << "kB";
    EXPECT_FALSE(fs::exists(output));
    return ended;
  }

  void run_text(const std::string& name, const std::string& text, const std::string& part) {
    const fs::path file = scratch_ / (name + ".xml");
    make(file, [&](std::ostream& stream) { stream << text; });
    run_large(file, part);
  }

  // The same with a text twice as long: that costs less than `most` times as much. `text` makes one of that many pieces.
  // What a run costs at least is no part of it, and of some runs each the least counts.
  template <class Text>
  void run_twice_as_large(const std::string& name, std::size_t count, const Text& text,
                          const std::string& part, double most = 2.5) {
    run_text(name, text(2 * count), part);
    const double base = least_cpu_;
    double half = 1e300, whole = 1e300;
    const fs::path small = scratch_ / "half.xml", large = scratch_ / (name + ".xml");
    make(small, [&](std::ostream& stream) { stream << text(count); });
    constexpr int most_runs = 30;  // beside other work the least of a few is too much, by a tenth
    for (int k = 0; k < most_runs; ++k) {
      half = std::min(half, run_large(small, part).cpu);
      whole = std::min(whole, run_large(large, part).cpu);
      if (whole - base < most * (half - base) + base) break;
    }
    EXPECT_LT(whole - base, most * (half - base) + base)
        << name << ": " << half << " s and, twice as large, " << whole << " s";
  }

  void SetUp() override {
    BadModels::SetUp();
    const fs::path file = scratch_ / "least.xml";
    make(file, [](std::ostream& stream) { stream << in_model << "<body/>" << end_model; });
    for (int k = 0; k < 5; ++k) least_cpu_ = std::min(least_cpu_, run_large(file, "name").cpu);
  }

  // [kB]; sanitizers keep what is freed, and much beside.
  const long most_memory = (sanitized() ? 8 : 1) << 20;
  std::optional<Program> program_;
  double least_cpu_ = 1e300;  // [s] of a model that is refused at once
};

// The size of a file is looked at; of a pipe, no more is read than a model may have.
TEST_F(LargeModelsSlow, AttributeOfAGigabyte) {
  constexpr std::uintmax_t gigabyte = 1u << 30;
  const fs::path file = scratch_ / "gigabyte.xml", pipe = scratch_ / "pipe.xml";
  make(file, [&](std::ostream& stream) { stream << "<mbd name=\""; });
  fs::resize_file(file, gigabyte);  // takes no place on the disk
  run_large(file, "64");
  fs::remove(file);

  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const auto before = std::signal(SIGPIPE, SIG_IGN);
  std::thread writer([&] {
    std::ofstream stream(pipe, std::ios::binary);
    stream << "<mbd name=\"";
    const std::string piece(1 << 16, 'a');
    for (std::uintmax_t n = 0; n < gigabyte && stream; n += piece.size()) stream << piece;
  });
  run_large(pipe, "64");
  close(open(pipe.c_str(), O_RDONLY | O_NONBLOCK));  // if the program has never opened it
  writer.join();
  std::signal(SIGPIPE, before);
}

TEST_F(LargeModelsSlow, EndlessFile) {
  if (!fs::exists("/dev/zero")) GTEST_SKIP();
  run_large("/dev/zero", "64");
}

// What is quoted in a message is cut.
TEST_F(LargeModelsSlow, LongTextsAreCutInMessages) {
  const std::string text(10u << 20, 'a');
  run_text("value", in_model + "<gravity acceleration=\"0 0 " + text + "\"/>" + end_model,
           "acceleration");
  run_text("components",
           in_model + "<gravity acceleration=\"" + repeated("0 ", 1u << 20) + "\"/>" + end_model,
           "acceleration");
  run_text("name", in_model + "<body name=\"" + text + "\" mas=\"1\"/>" + end_model, "mas");
  run_text("bad_name",
           in_model + "<body name=\"" + text + ".\" mass=\"1\" inertia=\"1 1 1\"/>" + end_model,
           "name");
  run_text("attribute", in_model + "<gravity " + text + "=\"1\"/>" + end_model, "attribute");
  run_text("element", in_model + "<" + text + "/>" + end_model, "element");
  run_text("root", "<" + text + "/>", "<mbd");
  run_text("text", in_model + text + end_model, "text");
  run_text("place", in_model + "<load at=\"" + text + ".middle\" force=\"0 0 1\"/>" + end_model,
           "place");
  run_text("unknown_place",
           in_model + "<body name=\"b\" mass=\"1\" inertia=\"1 1 1\"/><load at=\"" + text +
               "\" force=\"0 0 1\"/>" + end_model,
           "load");
  run_text(
      "choice",
      in_model + "<static/><transient duration=\"1\" step=\"1\" balance=\"" + text + "\"/></mbd>",
      "balance");
}

TEST_F(LargeModelsSlow, DeepAndWideOnesEndInLinearTime) {
  constexpr std::size_t half_a_million = 500'000;
  run_twice_as_large(
      "repeats", half_a_million,
      [](std::size_t n) {
        return in_model + repeated("<repeat count=\"1\">", n) + repeated("</repeat>", n) + "</mbd>";
      },
      "deep");
  run_twice_as_large(
      "unclosed", half_a_million, [](std::size_t n) { return in_model + repeated("<a>", n); },
      "deep");
  const auto gravity = [&](const std::string& name, const auto& expression) {
    run_twice_as_large(
        name, half_a_million,
        [&](std::size_t n) {
          return in_model + "<gravity acceleration=\"0 0 " + expression(n) + "\"/>" + end_model;
        },
        "acceleration");
  };
  gravity("parentheses", [](std::size_t n) { return repeated("(", n) + "1" + repeated(")", n); });
  gravity("signs", [](std::size_t n) { return repeated("-", n); });
  gravity("powers", [](std::size_t n) { return repeated("1^", n) + "x"; });
  gravity("conditions", [](std::size_t n) { return repeated("1?1:", n) + "x"; });
  gravity("functions", [](std::size_t n) { return repeated("sin(", n); });
  run_twice_as_large(
      "braces", half_a_million,
      [](std::size_t n) {
        return in_model + "<load at=\"" + repeated("{", n) + "\" force=\"0 0 1\"/>" + end_model;
      },
      "at=");
  run_twice_as_large(
      "elements", 100'000,
      [](std::size_t n) {
        std::string many = in_model;
        for (std::size_t i = 0; i < n; ++i)
          many += "<body name=\"b" + std::to_string(i) + "\" mass=\"1\"/>\n";
        return many + end_model;
      },
      "inertia");
  // tinyxml2 compares each attribute of an element with all before it: there is a limit before it does.
  run_twice_as_large(
      "attributes", 10'000,
      [](std::size_t n) {
        std::string wide = in_model + "<gravity";
        for (std::size_t i = 0; i < n; ++i) wide += " a" + std::to_string(i) + "=\"1\"";
        return wide + "/>" + end_model;
      },
      "more than 1000 attributes", 5.0);
}

// Characters that would move the cursor of a terminal, or break the line, are not passed on.
TEST_F(LargeModelsSlow, ControlCharactersAreNotPassedOn) {
  run_text("escape", in_model + "<body name=\"\x1b[2J\" mas=\"1\"/>" + end_model, "mas");
  run_text("escape_element", in_model + "<a\x1b[2J/>" + end_model, "a");
  run_text("break", in_model + "<body name=\"a\nb\" mas=\"1\"/>" + end_model, "mas");
  run_text("character", in_model + "<body name=\"&#10;\" mas=\"1\"/>" + end_model, "mas");
  run_text("bell", in_model + "<gravity acceleration=\"0 0 \a\"/>" + end_model, "acceleration");
}

// ---- the command line and the disk ------------------------------------------------------------

class BadOutputs : public BadModels {
 protected:
  void expect_message(const std::vector<std::string>& arguments,
                      const std::vector<std::string>& parts) {
    Program program(arguments, scratch_ / "output");
    const Ended& ended = program.wait();
    SCOPED_TRACE(::testing::PrintToString(arguments) + ": " + ended.err);
    expect_refused(ended);
    expect_readable(message_in(ended.err));
    for (const std::string& part : parts)
      EXPECT_TRUE(any_of(part, [&](auto either) { return contains(ended.err, either); }))
          << "does not say " << part;
  }
};

TEST_F(BadOutputs, NoModel) {
  expect_message({"run", "nowhere.xml"}, {"nowhere.xml: ", "no such file"});
  expect_message({"run", "good"}, {"good: ", "directory"});
  expect_message({"run", "good/cantilever"}, {"good/cantilever: ", "no such file"});
  expect_message({"run", ""}, {"no such file|name"});
  EXPECT_FALSE(fs::exists("results"));
}

TEST_F(BadOutputs, BadParameters) {
  const std::string model = "good/pendulum.xml";
  const std::string output = scratch_ / "results";
  const auto set = [&](const std::string& text, const std::vector<std::string>& parts) {
    expect_message({"run", model, "--out", output, "--set", text}, parts);
    EXPECT_FALSE(fs::exists(output));
  };
  set("DT=1", {"--set DT=1", "\"dt\"|dt"});
  set("dt", {"--set dt", "name=value"});
  set("dt=", {"--set dt=", "name=value"});
  set("=1", {"--set =1", "name=value"});
  set("dt=ten", {"--set dt=ten", "ten"});
  set("dt=1/0", {"--set dt=1/0", "finite|zero"});
  set("dt=t", {"--set dt=t", "t"});
  set("dt=5 xyz", {"--set dt=5 xyz", "there is no unit \"xyz\""});
  set("dt=0", {"pendulum.xml:8: transient: ", "step|duration", "positive"});
  expect_message({"run", model, "--out", output, "--set", "dt=1", "--set", "dt=2"},
                 {"--set dt=2", "twice"});
}

TEST_F(BadOutputs, NoPlaceForResults) {
  const std::string model = "good/pendulum.xml";
  const fs::path file = scratch_ / "file";
  write_file(file, "mine\n");
  expect_message({"run", model, "--out", file}, {file, "--out"});
  expect_message({"run", model, "--out", file / "below"}, {file / "below", "--out"});
  EXPECT_EQ(contents(file), "mine\n");
  expect_message({"run", model, "--out", "/dev/full"}, {"/dev/full", "--out"});
  expect_message({"run", model, "--out", "/proc/nowhere/results"}, {"/proc/nowhere", "--out"});
  const fs::path too_long = scratch_ / std::string(300, 'a');
  expect_message({"run", model, "--out", too_long}, {"--out"});
  if (geteuid() == 0) return;  // root may write everywhere
  const fs::path locked = scratch_ / "locked";
  fs::create_directory(locked);
  fs::permissions(locked, fs::perms::owner_read | fs::perms::owner_exec);
  expect_message({"run", model, "--out", locked}, {locked, "--out"});
  expect_message({"run", model, "--out", locked / "below"}, {locked / "below", "--out"});
  EXPECT_TRUE(fs::is_empty(locked));
}

// ---- the table --------------------------------------------------------------------------------

TEST_F(BadModels, TableOfMessagesIsCurrent) {
  std::string table =
      "# Wrong models\n\n"
      "What `mbd run` says of each, with status 1 and without results. A message in the third "
      "column is\n"
      "also that of a Scene with the same mistake, without file and line; or it says what only the "
      "file\n"
      "has. The models of `good` are those the others were made from, by one mistake each.\n\n"
      "Written by the test `BadModels.TableOfMessagesIsCurrent` with `MBD_UPDATE_TABLES=1`: a "
      "regression\n"
      "table. What a message must say stands in `tests/front/bad_models_table.cpp`.\n\n"
      "| file | message | Scene |\n|---|---|---|\n";
  for (const BadModel& model : bad_models()) {
    std::string message = library_says(model);
    for (std::size_t at = 0; (at = message.find('|', at)) != std::string::npos; at += 2)
      message.insert(at, 1, '\\');
    std::replace(message.begin(), message.end(), '\n', ' ');
    table += "| [" + std::string(model.file) + "](" + name_of(model) + ") | `` " + message +
             " `` | " + (model.twin.spoil ? "the same" : std::string(model.twin.reason)) + " |\n";
  }
  if (const char* const update = std::getenv("MBD_UPDATE_TABLES"); update && *update == '1')
    write_file("README.md", table);
  EXPECT_EQ(contents("README.md"), table)
      << "if the new messages are better, run this test with MBD_UPDATE_TABLES=1";
}

}  // namespace
}  // namespace mbd::test::test_bad_models
