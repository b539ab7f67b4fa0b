// Whose results a directory holds, and whether a run that is told to end, or stands in strange surroundings, leaves what it
// promises: run ids (libmbd/results/history.hpp), signals at random instants, faults one call at a time, environments, and
// directories that are the same twice.
//
// What failed before: files of two runs side by side, and those of killed and failed runs, were read without a word; a
// model took the results of another of the same name; campbell, floquet and modes looked for requests to end between
// rates only, or not at all. Mutations tried in it, and killed: the id is not written into motion.bin; report.json is
// not looked at; a failed run is no doubt; locales reach std::from_chars' place (strtod in number()); a part that
// could not be renamed stays behind; files are made without O_EXCL and O_NOFOLLOW; the reader does not look whether it is to
// end.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <clocale>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "libmbd/core/error.hpp"
#include "libmbd/core/stop.hpp"
#include "libmbd/language/reader.hpp"
#include "libmbd/results/build_facts.hpp"
#include "libmbd/results/history.hpp"
#include "libmbd/run/run.hpp"
#include "libmbd/study/modes/campbell.hpp"
#include "libmbd/study/modes/floquet.hpp"
#include "libmbd/study/modes/modes.hpp"
#include "libmbd/text/files.hpp"
#include "libmbd/view/motion.hpp"
#include "tests/support/faults.hpp"
#include "tests/support/program.hpp"
#include "tests/support/shell.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/support/this_build.hpp"

namespace mbd::test::test_results_of_runs {
namespace {

namespace fs = std::filesystem;

fs::path model_file(const std::string& name) {
  return fs::path(MBD_SOURCE_DIR) / "models" / (name + ".xml");
}

bool says(const std::vector<std::string>& notes, const std::string& what) {
  for (const std::string& note : notes)
    if (note.find(what) != std::string::npos) return true;
  return false;
}

// ---- whose they are ------------------------------------------------------------------------------

class Runs : public testing::Test {
 protected:
  RunReport run_into(const std::string& out, double duration = 0.0) const {
    Scene scene = read_model(model_file("pendulum"));
    scene.motion_output.emplace();
    if (duration > 0.0) scene.transient->duration = duration;
    scene.expects.clear();
    return run(scene, {.output = path(out), .estimate_error = false});
  }
  fs::path path(const std::string& name) const { return directory_.path() / name; }
  std::string mbd(const std::string& arguments) const {
    return shell(quote(mbd_program) + " " + arguments).text;
  }

  TemporaryDirectory directory_;
};

TEST_F(Runs, FilesBearTheIdOfTheirRun) {
  std::set<std::string> ids;
  for (const std::string out : {"a", "b", "a"}) {
    const RunReport report = run_into(out);
    EXPECT_EQ(report.id.size(), 16U);
    EXPECT_TRUE(ids.insert(report.id).second) << "twice the same";
    const mbd::History history = read_history(path(out));
    EXPECT_EQ(history.run, report.id);
    EXPECT_EQ(history.notes, std::vector<std::string>());
    EXPECT_EQ(read_motion(path(out) / "motion.bin").run, report.id);
    EXPECT_EQ(nlohmann::json::parse(contents(path(out) / "report.json")).at("run"), report.id);
  }
  EXPECT_EQ(run(read_model(model_file("pendulum")), {.id = "mine", .estimate_error = false}).id,
            "mine");
}

TEST_F(Runs, FilesOfDifferentRunsAreNotTakenForOne) {
  run_into("a");
  run_into("b");
  fs::copy_file(path("b") / "report.json", path("a") / "report.json",
                fs::copy_options::overwrite_existing);
  EXPECT_TRUE(says(read_history(path("a")).notes, "are of different runs"));
  const std::string a = quote(path("a").string()), b = quote(path("b").string());
  for (const std::string& said : {mbd("compare " + a + " " + b), mbd("plot " + a),
                                  mbd("view " + a + " --image " + a + ".svg"),
                                  mbd("export " + a + " --vtk " + a + "_vtk --frames 2")})
    EXPECT_NE(said.find("are of different runs"), std::string::npos) << said;
  EXPECT_EQ(mbd("plot " + b).find("note"), std::string::npos);
  EXPECT_EQ(mbd("view " + b + " --image " + b + ".svg").find("note"), std::string::npos);
}

TEST_F(Runs, AnEndThatIsMissingIsSaid) {
  run_into("a");
  const std::string report = contents(path("a") / "report.json");
  fs::remove(path("a") / "report.json");
  EXPECT_TRUE(says(read_history(path("a")).notes, "its run was killed"));
  {
    const DirectoryLock others(path("a"));
    EXPECT_TRUE(says(read_history(path("a")).notes, "its run goes on"));
  }
  auto failed = nlohmann::json::parse(report);
  failed["failure"] = "the disk is full";
  write_file(path("a") / "report.json", failed.dump());
  EXPECT_TRUE(says(read_history(path("a")).notes, "its run failed: the disk is full"));
  for (const char* const other : {"", "[]", "{\"run\": 3}", "{", "\xff\xfe"}) {
    write_file(path("a") / "report.json", other);
    EXPECT_EQ(read_history(path("a")).notes.size(), 1U) << other;
  }
  // Tables of others, and of earlier versions, say nothing of runs.
  write_file(path("b.csv"), "time,x\n0,1\n1,2\n");
  EXPECT_EQ(read_history(path("b.csv")).notes, std::vector<std::string>());
}

TEST_F(Runs, EquallyNamedModelsDoNotTakeEachOthersResults) {
  for (const char* const of : {"one", "other"}) {
    fs::create_directory(path(of));
    fs::copy_file(model_file("pendulum"), path(of) / "m.xml");
  }
  const auto run_in = [&](const std::string& model) {
    return shell("cd " + quote(directory_.path().string()) + " && " + quote(mbd_program) +
                 " run -q " + model + " --no-estimate");
  };
  EXPECT_EQ(run_in("one/m.xml").status, 0);
  const std::string before = contents(path("results/m/history.csv"));
  const Output other = run_in("other/m.xml");
  EXPECT_EQ(other.status, 1);
  EXPECT_NE(other.text.find("holds results of one/m.xml, another model"), std::string::npos)
      << other.text;
  EXPECT_EQ(contents(path("results/m/history.csv")), before);
  EXPECT_EQ(run_in("./one/m.xml").status, 0) << "the same file by another name";
  EXPECT_EQ(run_in("other/m.xml -o elsewhere").status, 0);
  fs::remove(path("one/m.xml"));  // moved, say: nobody's results any more
  EXPECT_EQ(run_in("other/m.xml").status, 0);
}

// ---- the same twice --------------------------------------------------------------------------------

// All that a run leaves but for its date, its id and what it took of time.
std::map<std::string, std::string> lasting(const fs::path& directory) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(directory)) {
    if (!entry.is_regular_file()) continue;
    const std::string name = fs::relative(entry.path(), directory).string();
    std::string text = contents(entry.path());
    if (name == "report.json") {
      auto report = nlohmann::json::parse(text);
      for (const char* const fleeting : {"date", "run", "seconds"}) report.erase(fleeting);
      text = report.dump(1);
    } else if (name == "motion.bin" || name.ends_with(".csv")) {
      const std::string key = name == "motion.bin" ? R"("run":")" : "# run: ";
      constexpr std::size_t digits = 16;
      if (const std::size_t at = text.find(key); at != std::string::npos)
        text.erase(at, key.size() + digits + 1);
    }
    files[name] = text;
  }
  return files;
}

void expect_same_twice(const std::string& name) {
  SCOPED_TRACE(name);
  const TemporaryDirectory directory;
  Scene scene = read_model(model_file(name));
  if (!scene.path) scene.motion_output.emplace();
  std::map<std::string, std::string> first;
  for (const char* const out : {"first", "second"}) {
    run(scene, {.output = directory.path() / out});
    const auto files = lasting(directory.path() / out);
    EXPECT_GE(files.size(), 4U);
    if (first.empty()) {
      first = files;
      continue;
    }
    std::set<std::string> names, differ;
    for (const auto& all : {first, files})
      for (const auto& [file, text] : all) names.insert(file);
    for (const std::string& file : names)
      if (!first.contains(file) || !files.contains(file) || first.at(file) != files.at(file))
        differ.insert(file);
    EXPECT_EQ(differ, std::set<std::string>());
  }
}

TEST(Determinism, OfResultDirectories) {
  for (const char* const name : {"pendulum", "four_bar_static", "bushing", "every_joint",
                                 "portal_frame", "damped_oscillator", "heavy_top"})
    expect_same_twice(name);
}

TEST(DeterminismSlow, OfResultDirectoriesOfEveryModel) {
  for (const auto& entry : fs::directory_iterator(model_file("pendulum").parent_path()))
    if (entry.path().extension() == ".xml") expect_same_twice(entry.path().stem());
}

// ---- told to end -----------------------------------------------------------------------------------

// Work that takes T alone and is told to end at T/10 ends before 0.6 T: by Stopped, or with what it has.
template <class Work>
void expect_ends_when_told(const Work& work) {
  std::atomic<bool> stop = false;
  const double begun = used_cpu();
  work(stop);
  const double whole = used_cpu() - begun, again = used_cpu();
  std::jthread watch([&stop, again, whole](const std::stop_token& over) {
    while (used_cpu() < again + 0.1 * whole && !over.stop_requested())
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    stop = true;
  });
  try {
    work(stop);
  } catch (const Stopped&) {
  }
  EXPECT_LT(used_cpu() - again, 0.6 * whole);
}

const char* const shaft = R"(<mbd name="m"><section name="s">
    <stiffness EA="1e6" GA2="4e5" GA3="4e5" GJ="80" EI2="100" EI3="100"/>
    <mass per_length="1" inertia="2e-4 1e-4 1e-4"/></section>
    <beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" elements="{}"/>
    {}<transient duration="1" step="1e-2"/></mbd>)";
const char* const clamp = R"(<fixed name="clamp" between="ground b.start"/>)";

TEST(StopsSlow, InsideModes) {
  const Scene scene = read_model_text(fmt::format(fmt::runtime(shaft), 600, clamp));
  expect_ends_when_told([&](const std::atomic<bool>& stop) {
    const stop::Scope scope(&stop);
    study_modes(scene, {.count = 60});
  });
}

TEST(StopsSlow, InsideCampbell) {
  const Scene scene = read_model_text(fmt::format(
      fmt::runtime(shaft), 200, R"(<revolute name="r" between="ground b.start" axis="1 0 0"/>)"));
  CampbellOptions options;
  options.rotation.axis = Vec3::UnitX();
  options.from = 1.0;
  options.to = 30.0;
  options.points = 2;  // one rate to the other: a request between rates would come too late
  options.count = 8;
  CampbellStudy whole;
  expect_ends_when_told([&](const std::atomic<bool>& stop) {
    options.interrupted = &stop;
    const CampbellStudy study = study_campbell(scene, options);
    for (const CampbellBranch& branch : study.branches)
      EXPECT_EQ(branch.points.size(), study.rates.size());
    EXPECT_TRUE(!stop || says(study.notes, "interrupted"));
  });
}

TEST(StopsSlow, InsideFloquet) {
  const Scene scene = read_model_text(
      fmt::format(fmt::runtime(shaft), 3,
                  std::string(clamp) + R"x(<load at="b.end" force="0 0 sin(2*pi*t)"/>)x"));
  FloquetOptions options;
  options.period = 1.0;
  options.settle = 1;
  options.harmonics = 24;
  expect_ends_when_told([&](const std::atomic<bool>& stop) {
    options.interrupted = &stop;
    try {
      study_floquet(scene, options, {});
    } catch (const Error& error) {
      if (!stop) throw;
      EXPECT_NE(std::string(error.what()).find("interrupted"), std::string::npos) << error.what();
    }
  });
}

// A mistake at the end of the text: all before it is reading.
TEST(StopsSlow, InsideTheReader) {
  const std::string model = R"(<mbd name="m"><repeat count="100000" index="i">
    <body name="b{i}" mass="1+i" inertia="1 1 1" at="i sin(i) 0"/></repeat><body name="b0"/></mbd>)";
  expect_ends_when_told([&](const std::atomic<bool>& stop) {
    const stop::Scope scope(&stop);
    try {
      read_model_text(model);
      ADD_FAILURE() << "no error";
    } catch (const Stopped&) {
      throw;
    } catch (const Error& error) {
      EXPECT_SAYS(std::string(error.what()), "mass");
    }
  });
}

TEST(StopsSlow, InsideSections) {
  const char* const section =
      R"(<mbd name="m"><material name="steel" E="2e11" nu="0.3"/>
      <section name="s"><I width="0.08" height="0.16" flange_thickness="0.008" web_thickness="0.006" material="steel"
      tolerance="1e-4"/></section>
      <beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1"/><fixed name="c" between="ground b.start"/>
      <static/></mbd>)";
  expect_ends_when_told([&](const std::atomic<bool>& stop) {
    const stop::Scope scope(&stop);
    read_model_text(section);
  });
}

// What stands in the history is a beginning of the undisturbed one, and the rest is there whole or not at all.
void expect_whole_or_absent(const fs::path& out,
                            const std::map<std::string, std::string>& undisturbed) {
  if (!fs::exists(out)) return;
  for (const auto& entry : fs::directory_iterator(out))
    EXPECT_FALSE(entry.path().filename().string().ends_with(".part")) << entry.path();
  for (const auto& [name, text] : lasting(out)) {
    ASSERT_TRUE(undisturbed.contains(name)) << name;
    const std::string& whole = undisturbed.at(name);
    if (name == "history.csv" || name == "motion.bin") {
      EXPECT_TRUE(whole.starts_with(text)) << name;
      EXPECT_TRUE(name == "motion.bin" || text.ends_with('\n')) << name;
    } else if (name == "report.json") {
      EXPECT_TRUE(nlohmann::json::parse(text).contains("status"));
    } else if (name != "history.svg") {  // a picture of what was there
      EXPECT_EQ(text, whole) << name;
    }
  }
}

const fs::path many_rows = fs::path(MBD_SOURCE_DIR) / "tests" / "hard" / "models" / "many_rows.xml";

// What that model writes undisturbed.
struct Undisturbed {
  explicit Undisturbed(const TemporaryDirectory& directory) {
    const Ended ended =
        Program(arguments(directory.path() / "undisturbed"), directory.path() / "program").wait();
    EXPECT_EQ(ended.status, 0) << ended.err;
    files = lasting(directory.path() / "undisturbed");
    cpu = ended.cpu;
  }
  std::vector<std::string> arguments(const fs::path& out) const {
    return {"run", many_rows.string(), "--set", "steps=600", "--motion", "--no-estimate", "-q",
            "-o",  out.string()};
  }
  std::map<std::string, std::string> files;
  double cpu = 0.0;
};

TEST(SignalsSlow, AtTwoHundredInstants) {
  const TemporaryDirectory directory;
  const Undisturbed undisturbed(directory);
  std::mt19937 random(29);
  int ended_early = 0, said = 0;
  for (int i = 0; i < 200; ++i) {
    SCOPED_TRACE(i);
    const fs::path out = directory.path() / "out";
    fs::remove_all(out);
    const int signal = i % 2 == 0 ? SIGINT : SIGTERM;
    const auto instant = std::chrono::microseconds(
        static_cast<long>(1.2e6 * undisturbed.cpu * static_cast<double>(random() % 1000) / 1000.0));
    Program program(undisturbed.arguments(out), directory.path() / "program");
    std::this_thread::sleep_for(instant);
    program.signal(signal);
    const Ended ended = program.wait();
    ASSERT_TRUE(ended.status == 0 || ended.status == 1 || ended.status == -signal)
        << ended.status << " " << ended.err;
    expect_whole_or_absent(out, undisturbed.files);
    ended_early += ended.status != 0 ? 1 : 0;
    if (ended.status != 1) continue;
    ++said;
    EXPECT_NE(ended.err.find("interrupted"), std::string::npos) << ended.err;
    const bool nothing = ended.err.find("nothing has been written") != std::string::npos;
    EXPECT_EQ(fs::exists(out / "report.json"), !nothing) << ended.err;
  }
  EXPECT_GT(ended_early, 40);
  EXPECT_GT(said, 10);
}

// ---- faults, each call in turn -----------------------------------------------------------------------

// Numbers that the preloaded library counts: of calls, of allocations that were not given back, and which of them were the
// first from their place in the program.
struct Counted {
  long calls = 0, kept = 0;
  std::vector<long> places;
};
Counted counted(const fs::path& file) {
  Counted all;
  std::istringstream text(contents(file));
  text >> all.calls >> all.kept;
  for (long n; text >> n;) all.places.push_back(n);
  return all;
}

// A run with faults in it.
struct FaultyRuns {
  explicit FaultyRuns(fs::path of, std::vector<std::string> with = {})
      : model(std::move(of)), more(std::move(with)) {}

  fs::path model;
  std::vector<std::string> more;  // arguments

  std::vector<std::string> arguments() const {
    std::vector<std::string> all = {"run",      model.string(), "--no-estimate", "-q",
                                    "--motion", "-o",           out.string()};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  // Also tells what was counted, if asked.
  Ended run(const std::string& fault, Counted* count = nullptr) const {
    const fs::path file = directory.path() / "count";
    fs::remove_all(out);
    fs::remove(file);
    if (count != nullptr) setenv("MBD_FAULT_COUNT", file.c_str(), 1);
    const Fault one(MBD_FAULTS, fault);
    const Ended ended = Program(arguments(), directory.path() / "program").wait();
    unsetenv("MBD_FAULT_COUNT");
    if (count != nullptr && fs::exists(file)) *count = counted(file);
    return ended;
  }

  TemporaryDirectory directory;
  fs::path out = directory.path() / "out";
};

TEST(FailingCallsSlow, EachInTurn) {
  if (!faults_work()) GTEST_SKIP() << "the sanitizers are loaded first";
  const FaultyRuns runs(many_rows, {"--set", "steps=600"});
  for (const char* const call : {"write", "open", "rename", "mkdir"}) {
    Counted all;
    EXPECT_EQ(runs.run(fmt::format("{} * 0", call), &all).status, 0);
    const auto undisturbed = lasting(runs.out);
    EXPECT_GE(all.calls, std::string(call) == "mkdir" ? 1 : 2);
    EXPECT_LT(all.calls, 100);
    for (long n = 1; n <= all.calls; ++n) {
      SCOPED_TRACE(fmt::format("{} {} of {}", call, n, all.calls));
      const Ended ended = runs.run(fmt::format("{} * {}", call, n));
      expect_whole_or_absent(runs.out, undisturbed);
      // A directory without a row holds nothing.
      EXPECT_TRUE(fs::exists(runs.out / "report.json") || !fs::exists(runs.out / "history.csv") ||
                  read_history(runs.out / "history.csv").rows() > 0);
      EXPECT_EQ(ended.status, 1) << "it is not told of: " << ended.err;
      EXPECT_NE(ended.err.find(runs.out.string()), std::string::npos) << ended.err;
      EXPECT_NE(ended.err.find('('), std::string::npos)
          << "without the system's reason: " << ended.err;
    }
  }
}

// Somebody is quicker: links stand where files are to be made. What they show to stays as it is.
TEST(FailingCallsSlow, LinksPlantedInTurn) {
  if (!faults_work()) GTEST_SKIP() << "the sanitizers are loaded first";
  const FaultyRuns runs(model_file("pendulum"));
  const fs::path victim = runs.directory.path() / "victim";
  write_file(victim, "as it was");
  setenv("MBD_FAULT_VICTIM", victim.c_str(), 1);
  Counted all;
  EXPECT_EQ(runs.run("plant * 0", &all).status, 0);
  EXPECT_GE(all.calls, 3);
  for (long n = 1; n <= all.calls; ++n) {
    const Ended ended = runs.run(fmt::format("plant * {}", n));
    EXPECT_TRUE(contents(victim) == "as it was") << n;
    EXPECT_EQ(ended.status, 1) << n;
    EXPECT_SAYS(ended.err, "File exists");
  }
  unsetenv("MBD_FAULT_VICTIM");
}

// Once from each of a part of the places of the program that ask for memory (12 frames of the stack; every third and every twelfth
// passed once, 2026-11-25): the run ends with what it has and says why, or it does not matter; nothing is left half written, nor
// kept.
void each_place_fails_once(const FaultyRuns& runs, std::size_t stride) {
  const std::string name = runs.model.stem().string();
  SCOPED_TRACE(name);
  Counted all;
  ASSERT_EQ(runs.run(fmt::format("malloc {} 0", name), &all).status, 0);
  const auto undisturbed = lasting(runs.out);
  EXPECT_GT(all.places.size(), 1000U);
  int said = 0, harmless = 0;
  for (std::size_t i = 0; i < all.places.size(); i += stride) {
    SCOPED_TRACE(fmt::format("allocation {} of {}", all.places[i], all.calls));
    Counted after;
    const Ended ended = runs.run(fmt::format("malloc {} {}", name, all.places[i]), &after);
    ASSERT_GE(ended.status, 0) << "a signal: " << ended.err;
    EXPECT_LE(after.kept, all.kept) << "memory is lost";
    if (ended.status == 0) {
      EXPECT_EQ(lasting(runs.out), undisturbed);
      ++harmless;
      continue;
    }
    EXPECT_EQ(ended.status, 1);
    EXPECT_NE(ended.err.find("memory"), std::string::npos) << ended.err;
    expect_whole_or_absent(runs.out, undisturbed);
    // Nothing is there, or a report that says so.
    EXPECT_EQ(fs::exists(runs.out / "history.csv"), fs::exists(runs.out / "report.json"))
        << ended.err;
    ++said;
  }
  EXPECT_GT(said, harmless);
}

TEST(FailingCallsSlow, EachPlaceThatAllocates) {
  if (!faults_work()) GTEST_SKIP() << "the sanitizers are loaded first";
  each_place_fails_once(FaultyRuns(model_file("pendulum")), 10);
  each_place_fails_once(FaultyRuns(model_file("roll_up")), 40);
  each_place_fails_once(FaultyRuns(model_file("bushing")), 40);
}

// Two in a row, so that what is kept for the end does not serve either: as where an allocation is larger than that. Destructors
// of JSON that ask for memory may abort then; files are whole all the same.
TEST(FailingCallsSlow, TwoAllocationsInARow) {
  if (!faults_work()) GTEST_SKIP() << "the sanitizers are loaded first";
  const FaultyRuns runs(model_file("pendulum"));
  Counted all;
  ASSERT_EQ(runs.run("malloc pendulum 0", &all).status, 0);
  const auto undisturbed = lasting(runs.out);
  int said = 0, aborted = 0, tried = 0;
  for (std::size_t i = 0; i < all.places.size(); i += 50, ++tried) {
    SCOPED_TRACE(fmt::format("allocation {} of {}", all.places[i], all.calls));
    const Ended ended = runs.run(fmt::format("malloc pendulum {} 2", all.places[i]));
    expect_whole_or_absent(runs.out, undisturbed);
    if (ended.status == -SIGABRT && ended.err.find("std::bad_alloc") != std::string::npos) {
      ++aborted;
      continue;
    }
    ASSERT_EQ(ended.status, 1) << ended.err;
    EXPECT_NE(ended.err.find("memory"), std::string::npos) << ended.err;
    EXPECT_EQ(fs::exists(runs.out / "history.csv"), fs::exists(runs.out / "report.json"))
        << ended.err;
    ++said;
  }
  EXPECT_GT(said, tried / 2);
  EXPECT_LT(aborted, tried / 5);
}

// Every call of a solver's function, or each of some of many, ends once with each status that it may have: the run comes to the same
// end all the same, or ends with its rows and the reason, which is memory where the status says so.
void each_call_fails_once(const FaultyRuns& runs, const std::string& function,
                          const std::vector<int>& statuses) {
  constexpr int no_memory = -2;  // of KLU
  Counted all;
  ASSERT_EQ(runs.run(function + " 0 0", &all).status, 0);
  ASSERT_GT(all.calls, 0) << function;
  const mbd::History whole = read_history(runs.out / "history.csv");
  for (const int status : statuses)
    for (long n = 1; n <= all.calls; n += std::max(1L, all.calls / 6)) {
      SCOPED_TRACE(fmt::format("{} {} at call {} of {}", function, status, n, all.calls));
      const Ended ended = runs.run(fmt::format("{} {} {}", function, status, n));
      if (ended.status == 0) {
        const mbd::History history = read_history(runs.out / "history.csv");
        ASSERT_GE(history.rows(), whole.rows());  // load steps may be divided
        for (std::size_t c = 0; c < whole.columns.size(); ++c)
          EXPECT_NEAR(history.values[c].back(), whole.values[c].back(), 2e-3)
              << whole.columns[c].name;
        continue;
      }
      ASSERT_EQ(ended.status, 1) << ended.err;
      EXPECT_NE(ended.err, "");
      if (status == no_memory && function.starts_with("klu") &&
          function.find("solve") == std::string::npos) {
        EXPECT_NE(ended.err.find("out of memory"), std::string::npos) << ended.err;
      }
      EXPECT_EQ(fs::exists(runs.out / "history.csv"), fs::exists(runs.out / "report.json"))
          << ended.err;
    }
}

TEST(FailingCallsSlow, EachSolution) {
  if (!faults_work()) GTEST_SKIP() << "the sanitizers are loaded first";
  const char* const model = R"(<mbd name="m"><section name="s">
    <stiffness EA="1e5" GA2="4e4" GA3="4e4" GJ="80" EI2="100" EI3="100"/>
    <mass per_length="1" inertia="2e-4 1e-4 1e-4"/></section>
    <beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" elements="2"/>{}
    <record name="end" at="b.end" quantities="position"/></mbd>)";
  const char* const swinging = R"(<revolute name="r" between="ground b.start" axis="0 1 0"/>
    <body name="c" at="1 0 0" mass="1" inertia="0.1 0.1 0.1"/><spherical name="j" between="b.end c" at="1 0 0"/>
    <gravity acceleration="0 0 -9.81"/><transient duration="0.05" output="0.01" )";
  const char* const bent =
      R"(<fixed name="r" between="ground b.start"/><load at="b.end" force="0 0 -200"/><static steps="2" linear_solver="klu" )";
  const std::vector<std::string> real = {"klu_analyze", "klu_factor", "klu_refactor", "klu_solve"},
                                 both = {"klu_analyze", "klu_factor",   "klu_refactor",
                                         "klu_solve",   "klu_z_factor", "klu_z_refactor",
                                         "klu_z_solve"};
  struct Case {
    std::string inside;
    std::vector<std::string> functions;
    std::string of_its_own = {};
    std::vector<int> statuses = {};
  };
  const Case cases[] = {
      {std::string(swinging) + R"(step="2e-3" linear_solver="klu"/>)", real},
      {std::string(swinging) + R"(method="radau" step="2e-3" linear_solver="klu"/>)", both},
      // IDA_TOO_MUCH_WORK, _ERR_FAIL, _CONV_FAIL, _LINIT_FAIL, _LSETUP_FAIL, _RES_FAIL, _REP_RES_ERR, _NO_RECOVERY, _MEM_NULL
      {std::string(swinging) + R"(method="ida" tolerance="1e-5"/>)",
       real,
       "IDASolve",
       {-1, -3, -4, -5, -6, -8, -9, -14, -20}},
      {std::string(bent) + "/>", real},
      // KIN_MEM_NULL, _LINESEARCH_NONCONV, _MAXITER_REACHED, _MXNEWT_5X_EXCEEDED, _LSETUP_FAIL, _REPTD_SYSFUNC_ERR
      {std::string(bent) + R"(solver="kinsol"/>)", real, "KINSol", {-1, -5, -6, -7, -11, -14}},
  };
  for (const Case& one : cases) {
    FaultyRuns runs("");
    runs.model = runs.directory.path() / "m.xml";
    write_file(runs.model, fmt::format(fmt::runtime(model), one.inside));
    SCOPED_TRACE(one.inside);
    // KLU_SINGULAR, _OUT_OF_MEMORY, _INVALID, _TOO_LARGE
    for (const std::string& function : one.functions)
      each_call_fails_once(runs, function, {1, -2, -3, -4});
    if (!one.of_its_own.empty()) each_call_fails_once(runs, one.of_its_own, one.statuses);
  }
}

// ---- surroundings --------------------------------------------------------------------------------------

class Surroundings : public testing::Test {
 protected:
  // A command line before the program's: variables, limits.
  Output run_in(const std::string& before, const std::string& arguments = "") {
    fs::remove_all(out());
    return shell(before + " " + quote(mbd_program) + " run -q --no-estimate " +
                 quote(model_file("pendulum").string()) + " --motion -o " + quote(out().string()) +
                 " " + arguments);
  }
  fs::path out() const { return directory_.path() / "out"; }
  void expect_the_same(const std::string& before) {
    SCOPED_TRACE(before);
    const Output output = run_in(before);
    EXPECT_EQ(output.status, 0) << output.text;
    EXPECT_EQ(lasting(out()), usual_);
  }
  void SetUp() override {
    EXPECT_EQ(run_in("").status, 0);
    usual_ = lasting(out());
  }

  TemporaryDirectory directory_;
  std::map<std::string, std::string> usual_;
};

TEST_F(Surroundings, ChangeNothing) {
  expect_the_same("env -u HOME");
  expect_the_same("env HOME=/proc");  // where nobody can write
  expect_the_same("env HOME=/nowhere TMPDIR=/nowhere");
  expect_the_same("env TZ=Asia/Kathmandu");
  expect_the_same("env TZ=nonsense");
  expect_the_same("env -i");
  // Three of them are the standard streams; the sanitizers need files to look at addresses.
  if (!sanitized()) expect_the_same("ulimit -n 8; exec");
  expect_the_same("umask 077; exec");
}

// A day less whenever it is asked for: nothing waits, and times that were taken are not negative.
TEST_F(Surroundings, AClockThatIsSetBackChangesNothing) {
  if (!faults_work()) GTEST_SKIP() << "the sanitizers are loaded first";
  const fs::path count = out().string() + "_count";
  expect_the_same(fmt::format("env LD_PRELOAD={} MBD_FAULT=\"clock 1 0\" MBD_FAULT_COUNT={}",
                              quote(std::string(MBD_FAULTS)), quote(count.string())));
  EXPECT_GT(std::stol(contents(count)), 0) << "it was never asked for";
  const auto report = nlohmann::json::parse(contents(out() / "report.json"));
  for (const auto& value : report.at("seconds").flatten())
    if (value.is_number()) {
      EXPECT_GE(value.get<double>(), 0.0);
    }
}

TEST_F(Surroundings, TooFewFilesAreSaid) {
  const Output output = run_in("ulimit -n 4; exec");
  if (output.status == 0) return;    // one at a time will do
  if (output.status == 127) return;  // the program did not begin: the loader says it
  EXPECT_EQ(output.status, 1) << output.text;
  EXPECT_NE(output.text.find("Too many open files"), std::string::npos) << output.text;
}

TEST_F(Surroundings, TooLittleAddressSpaceIsSaid) {
  if (sanitized()) GTEST_SKIP() << "the sanitizers map terabytes";
  // How much there has to be is the machine's: between what is too little to print a version (which may be the loader's
  // word) and what is enough, every end says what is missing, and no file is left in part.
  const auto limited = [](long kilobytes) { return fmt::format("ulimit -v {}; exec", kilobytes); };
  const auto least = [](long below, long enough, const auto& works) {  // by halving, to 16 kB
    while (enough - below > 16) {
      const long middle = (below + enough) / 2;
      (works(middle) ? enough : below) = middle;
    }
    return enough;
  };
  const long begins = least(0, 4'000'000, [&](long kilobytes) {
    return shell(limited(kilobytes) + " " + quote(mbd_program) + " --version").status == 0;
  });
  const long ends = least(begins, 4'000'000,
                          [&](long kilobytes) { return run_in(limited(kilobytes)).status == 0; });
  ASSERT_GT(ends - begins, 200) << begins;  // rows of results
  int said = 0;
  for (int k = 1; k < 20; ++k) {
    const long kilobytes = begins + k * (ends - begins) / 20;
    SCOPED_TRACE(fmt::format("{} kB of {} to {}", kilobytes, begins, ends));
    const Output output = run_in(limited(kilobytes));
    if (output.status == 0) continue;  // the system lays things out anew each time
    EXPECT_EQ(output.status, 1) << output.text;
    EXPECT_NE(output.text.find("memory"), std::string::npos) << output.text;
    if (fs::exists(out() / "history.csv")) {
      EXPECT_EQ(usual_.at("history.csv").find(lasting(out()).at("history.csv")), 0U);
    }
    ++said;
  }
  EXPECT_GT(said, 0);
  expect_the_same(limited(ends + ends / 10));
}

// A locale that writes 1,5 for 1.5, made for the test; the program, and a program that uses the library and has set it.
TEST_F(Surroundings, CommasInNumbersChangeNothing) {
  const fs::path locales = directory_.path() / "locales";
  fs::create_directory(locales);
  const Output made =
      shell("localedef -i de_DE -f UTF-8 " + quote((locales / "de_DE.UTF-8").string()));
  if (!fs::exists(locales / "de_DE.UTF-8" / "LC_NUMERIC"))
    GTEST_SKIP() << "no localedef, or no de_DE: " << made.text;
  expect_the_same("env LOCPATH=" + quote(locales.string()) + " LC_ALL=de_DE.UTF-8");
  setenv("LOCPATH", locales.c_str(), 1);
  const char* const set = std::setlocale(LC_ALL, "de_DE.UTF-8");
  const std::string comma = fmt::format("{}", std::localeconv()->decimal_point);
  Scene scene;
  std::string failure;
  try {
    scene = read_model(model_file("pendulum"));
    scene.motion_output.emplace();
    run(scene, {.output = out(), .estimate_error = false});
    EXPECT_GT(read_history(out()).rows(), 10U);
  } catch (const Error& error) {
    failure = error.what();
  }
  std::setlocale(LC_ALL, "C");
  unsetenv("LOCPATH");
  ASSERT_TRUE(set != nullptr && comma == ",");
  EXPECT_EQ(failure, "");
  std::map<std::string, std::string> here = lasting(out());
  here.erase("report.json");  // of another program: commands write the path otherwise
  std::map<std::string, std::string> usual = usual_;
  usual.erase("report.json");
  EXPECT_EQ(here, usual);
}

}  // namespace
}  // namespace mbd::test::test_results_of_runs
