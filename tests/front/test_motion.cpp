// The motion that a run keeps: motion.bin, read here by itself, against history.csv, closed forms and other runs.
//
// Tried in the library, and killed: quaternions written w first; positions without the frame of a place in its node;
// viscous resultants left out; frames of their own at ends of steps only; frames = N taken as N intervals; the last frame
// left out; reactions that constraints share not of least norm; a row that is cut read as whole; old files not removed.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <csignal>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "libmbd/language/reader.hpp"
#include "libmbd/results/history.hpp"
#include "libmbd/run/run.hpp"
#include "libmbd/view/motion.hpp"
#include "tests/support/history_text.hpp"
#include "tests/support/program.hpp"
#include "tests/support/shell.hpp"

namespace mbd::test::test_motion {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using Row = std::vector<double>;

const fs::path models = fs::path(MBD_SOURCE_DIR) / "models";

// motion.bin as its documentation says it is.
struct Kept {
  Json head;
  std::vector<Row> rows;
  std::size_t pose = 0, twist = 0, resultant = 0, joint = 0;  // where the blocks begin

  explicit Kept(const fs::path& file) {
    const std::string text = read_text(file);
    const std::size_t end = text.find('\n');
    head = Json::parse(text.substr(0, end));
    EXPECT_EQ((end + 1) % 8, 0U);
    const auto size = head.at("row").get<std::size_t>();
    for (std::size_t at = end + 1; at + 8 * size <= text.size(); at += 8 * size) {
      rows.emplace_back(size);
      std::memcpy(rows.back().data(), text.data() + at, 8 * size);
    }
    const Json& blocks = head.at("blocks");
    pose = 1;
    twist = pose + blocks.at("pose").get<std::size_t>();
    resultant = twist + blocks.at("twist").get<std::size_t>();
    joint = resultant + blocks.at("resultant").get<std::size_t>();
  }

  const Json& part(const std::string& kind, const std::string& name) const {
    for (const Json& part : head.at("drawing").at("parts"))
      if (part.at("kind") == kind && part.at("name") == name) return part;
    throw std::runtime_error("no " + kind + " " + name);
  }
  // Of a place [node, r, q], the ground being 0.
  Vec3 position(const Row& row, const Json& at) const {
    const auto node = at.at(0).get<std::size_t>();
    const Vec3 local(at.at(1), at.at(2), at.at(3));
    if (node == 0) return local;
    const double* const h = row.data() + pose + 7 * (node - 1);
    const Eigen::Quaterniond q(h[6], h[3], h[4], h[5]);
    EXPECT_NEAR(q.norm(), 1.0, 1e-12);
    return Vec3(h[0], h[1], h[2]) + Vec3(q * local);
  }
};

std::vector<std::size_t> columns_of(const mbd::History& history, const std::string& quantity) {
  return choose_columns(history, std::vector{quantity});
}

class MotionOutput : public testing::Test {
 protected:
  RunReport run_with(Scene scene, const std::string& name, std::optional<int> frames = {},
                     bool motion = true) {
    if (motion) scene.motion_output = MotionOutputScene{{}, frames};
    RunOptions options;
    options.output = directory_ / name;
    options.estimate_error = false;
    return run(scene, options);
  }
  Scene model(const std::string& text) {
    write_text(directory_ / "model.xml", text);
    return read_model((directory_ / "model.xml").string());
  }
  fs::path file(const std::string& run) const { return directory_ / run / "motion.bin"; }

  const TemporaryDirectory scratch_;
  const fs::path directory_ = scratch_.path();
};

// Positions of what is recorded, from poses of nodes: with a transient (four_bar: hinges; rigid_frame: places in rigid
// bodies; shaft), load steps (swept_cantilever) and a path. All rows; error over the largest displacement.
TEST_F(MotionOutput, PosesAreThoseOfTheHistory) {
  struct Case {
    const char *model, *record, *quantity;
    Overrides set;
  };
  for (const Case& c :
       {Case{"four_bar", "C", "displacement", {}}, Case{"shaft", "M", "displacement", {}},
        Case{"swept_cantilever", "tip", "displacement", {}},
        Case{"shallow_arch", "crown", "displacement", {}},
        Case{"rigid_frame", "end", "position", {}}, Case{"pendulum", "bob", "position", {}},
        Case{"portal_frame", "B", "displacement", {}}}) {
    SCOPED_TRACE(c.model);
    const Scene scene = read_model((models / c.model).string() + ".xml", c.set);
    const RunReport report = run_with(scene, c.model);
    const Kept kept(file(c.model));
    const mbd::History history = read_history(directory_ / c.model);
    ASSERT_EQ(kept.rows.size(), history.rows());
    const auto columns = columns_of(history, std::string(c.record) + "." + c.quantity);
    ASSERT_EQ(columns.size(), 3U);
    const Json& record = kept.part("record", c.record);
    const bool is_displacement = std::string(c.quantity) == "displacement";
    const Vec3 from = is_displacement ? Vec3(record.at("from").at(0), record.at("from").at(1),
                                             record.at("from").at(2))
                                      : Vec3(Vec3::Zero());
    double worst = 0.0, most = 0.0;
    for (std::size_t i = 0; i < kept.rows.size(); ++i) {
      EXPECT_EQ(kept.rows[i][0], history.values[0][i]);
      const Vec3 r = kept.position(kept.rows[i], record.at("at"));
      for (std::size_t k = 0; k < 3; ++k) {
        const double expected = history.values[columns[k]][i];
        worst = std::max(
            worst, std::abs(r(static_cast<Index>(k)) - from(static_cast<Index>(k)) - expected));
        most = std::max(most, std::abs(expected));
      }
    }
    EXPECT_GT(most, 0.0);
    EXPECT_LE(worst, 1e-12 * std::max(most, kept.head.at("drawing").at("size").get<double>()));
  }
}

// Places away from the origin of their node: at the end of a beam that is rigid with a body, and of a body
// that is fixed to a flexible beam and one node with it.
TEST_F(MotionOutput, PlacesAreInTheirNodes) {
  const Scene scene = model(R"(<mbd name="frame"><section name="s">
      <stiffness EA="1e5" GA2="4e4" GA3="4e4" GJ="80" EI2="100" EI3="100"/>
      <mass per_length="1" inertia="1e-2 5e-3 5e-3"/></section>
    <body name="hub" mass="2" inertia="0.1 0.1 0.2" orientation="0.3 -0.2 0.5"/>
    <beam name="bar" section="s" from="1 0 0" to="2 1 0.5" normal="0 0 1"/>
    <rigid name="both" of="hub bar"/>
    <revolute name="pin" between="ground hub" at="0 0 0" axis="1 1 0"/>
    <beam name="soft" section="s" from="2 1 0.5" to="3 1 0.5" normal="0 0 1" elements="2"/>
    <fixed name="on" between="bar.end soft.start"/>
    <body name="tool" at="3.2 0.7 0.6" mass="0.5" inertia="0.01 0.01 0.01"/>
    <fixed name="held" between="soft.end tool"/>
    <spherical name="ball" between="tool bob"/>
    <body name="bob" at="3.2 0.7 0.6" mass="0.1" center="0 0 -0.2" inertia="0.01 0.01 0.01"/>
    <gravity acceleration="0 0 -9.81"/>
    <transient duration="0.5" step="0.01" rho_infinity="0.5"/>
    <record name="hub" at="hub" quantities="position"/>
    <record name="bar" at="bar.end" quantities="position"/>
    <record name="tip" at="soft.end" quantities="position"/>
    <record name="tool" at="tool" quantities="position"/></mbd>)");
  run_with(scene, "out");
  const Kept kept(file("out"));
  const mbd::History history = read_history(directory_ / "out");
  ASSERT_EQ(kept.rows.size(), history.rows());
  for (const std::string name : {"hub", "bar", "tip", "tool"}) {
    const auto columns = columns_of(history, name + ".position");
    double moved = 0.0;
    for (std::size_t i = 0; i < kept.rows.size(); ++i) {
      const Vec3 r = kept.position(kept.rows[i], kept.part("record", name).at("at"));
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(r(static_cast<Index>(k)), history.values[columns[k]][i], 1e-12) << name << i;
        moved = std::max(moved,
                         std::abs(history.values[columns[k]][i] - history.values[columns[k]][0]));
      }
    }
    if (name != "hub") {
      EXPECT_GT(moved, 0.1);
    }
  }
  // Their nodes are fewer than they: rigid, fused.
  EXPECT_EQ(kept.part("record", "hub").at("at").at(0), kept.part("record", "bar").at("at").at(0));
  EXPECT_EQ(kept.part("record", "tip").at("at").at(0), kept.part("record", "tool").at("at").at(0));
}

// Joint angles, reactions and velocities as records have them.
TEST_F(MotionOutput, JointsAndVelocitiesAreThoseOfTheHistory) {
  Scene scene = model(R"(<mbd name="crank">
    <body name="rod" mass="2" center="0.5 0 0" inertia="0.001 0.2 0.2" angular_velocity="0 3 0"/>
    <revolute name="hinge" between="ground rod" at="0 0 0" axis="0 1 0"/>
    <body name="bob" at="1 0 0" mass="1" inertia="0.01 0.01 0.01" velocity="0 0 -3"/>
    <spherical name="ball" between="rod bob" at="1 0 0"/>
    <gravity acceleration="0 0 -9.81"/>
    <transient duration="1" step="0.005"/>
    <record name="h" joint="hinge" quantities="angle reaction_force reaction_moment"/>
    <record name="r" at="bob" quantities="velocity"/></mbd>)");
  run_with(scene, "out");
  const Kept kept(file("out"));
  const mbd::History history = read_history(directory_ / "out");
  const auto value = [&](const char* name, std::size_t row) {
    return history.values[choose_column(history, name)][row];
  };
  ASSERT_EQ(kept.head.at("drawing").at("joints"), Json({"hinge", "ball"}));
  const Json& bob = kept.part("body", "bob");
  for (std::size_t i = 0; i < kept.rows.size(); i += 7) {
    const double* const hinge = kept.rows[i].data() + kept.joint;
    EXPECT_EQ(hinge[0], value("h.angle", i));
    for (int k = 0; k < 3; ++k) {
      const std::string n = "." + std::to_string(k + 1);
      EXPECT_EQ(hinge[1 + k], value(("h.reaction_force" + n).c_str(), i));
      EXPECT_EQ(hinge[4 + k], value(("h.reaction_moment" + n).c_str(), i));
    }
    const auto node = bob.at("at").at(0).get<std::size_t>() - 1;
    const double* const h = kept.rows[i].data() + kept.pose + 7 * node;
    const double* const v = kept.rows[i].data() + kept.twist + 6 * node;
    const Vec3 inertial = Eigen::Quaterniond(h[6], h[3], h[4], h[5]) * Vec3(v[0], v[1], v[2]);
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(inertial(k), value(("r.velocity." + std::to_string(k + 1)).c_str(), i), 1e-12);
  }
}

// A thin cantilever under a small tip force: M2 = -F (L - s) and Q3 = F, to the small change of its length.
TEST_F(MotionOutput, ResultantsAreThoseOfACantilever) {
  const Scene scene = model(R"(<mbd name="strip"><section name="s">
    <stiffness EA="1e6" GA2="4e5" GA3="4e5" GJ="80" EI2="100" EI3="100"/></section>
    <beam name="b" section="s" from="1 2 3" to="3 2 3" normal="0 0 1" elements="3"/>
    <fixed name="clamp" between="ground b.start"/>
    <load at="b.end" force="0 0 10 mN"/><static/>
    <record name="tip" at="b.end" quantities="displacement"/></mbd>)");
  run_with(scene, "out");
  const Kept kept(file("out"));
  const std::vector<double> s = kept.part("beam", "b").at("stations");
  ASSERT_EQ(s.size(), 9U);
  EXPECT_EQ(kept.head.at("blocks").at("resultant"), 54);
  for (std::size_t i = 0; i < s.size(); ++i) {
    const double* const S = kept.rows.back().data() + kept.resultant + 6 * i;
    EXPECT_NEAR(S[2], 1e-2, 1e-7);
    EXPECT_NEAR(S[4], -1e-2 * 2.0 * (1.0 - s[i]), 1e-7);
  }
}

// With damping they hold its forces too, as records at the same place do: a bar in steady stretching at the rate e would
// have N = EA e t + c e; here against the record, whose place is a Gauss point of the one element.
TEST_F(MotionOutput, ResultantsHaveTheirViscousPart) {
  const double xi = std::sqrt(0.6);  // of three points
  const Scene scene = model(fmt::format(R"(<mbd name="bar"><section name="s">
    <stiffness EA="1e4" GA2="4e3" GA3="4e3" GJ="80" EI2="100" EI3="100"/>
    <mass per_length="1" inertia="1e-2 5e-3 5e-3"/><damping stiffness_proportional="0.1"/></section>
    <beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1"/>
    <fixed name="clamp" between="ground b.start"/><load at="b.end" force="100*sin(20*t) 0 0"/>
    <transient duration="0.2" step="0.01"/>
    <record name="in" at="b@{:.17g}" quantities="force"/></mbd>)",
                                        0.5 * (1.0 + xi)));
  run_with(scene, "out");
  const Kept kept(file("out"));
  const mbd::History history = read_history(directory_ / "out");
  const std::size_t N = choose_column(history, "in.force.1");
  ASSERT_EQ(kept.part("beam", "b").at("stations").size(), 3U);
  double most = 0.0;
  for (std::size_t i = 0; i < kept.rows.size(); ++i) {
    EXPECT_NEAR(kept.rows[i][kept.resultant + 12], history.values[N][i], 1e-9);
    most = std::max(most, std::abs(history.values[N][i]));
  }
  EXPECT_GT(most, 10.0);
}

// N frames at equal times, the first at the start and the last at the end, between rows and inside steps: a mass on a
// spring, x = cos(w t), by Radau at 1e-10.
TEST_F(MotionOutput, FramesHaveTimesOfTheirOwn) {
  const Scene scene = model(R"(<mbd name="mass">
    <body name="m" at="1 0 0" mass="2" inertia="1 1 1"/>
    <prismatic name="rail" between="ground m" at="0 0 0" axis="1 0 0"/>
    <spring name="k" between="ground m" at_a="-9 0 0" stiffness="50" length="9"/>
    <transient duration="2" method="radau" tolerance="1e-10" output="0.31"/>
    <record name="m" at="m" quantities="position"/></mbd>)");
  run_with(scene, "out", 53);
  const Kept kept(file("out"));
  EXPECT_EQ(read_history(directory_ / "out").rows(), 8U);
  ASSERT_EQ(kept.rows.size(), 53U);
  for (std::size_t i = 0; i < 53; ++i) {
    const double t = 2.0 * static_cast<double>(i) / 52.0;
    EXPECT_NEAR(kept.rows[i][0], t, 1e-12);
    EXPECT_NEAR(kept.position(kept.rows[i], kept.part("body", "m").at("at"))(0), std::cos(5.0 * t),
                1e-7);
  }
}

// The same times by rows: to the last bit, in fixed steps too, and the history is the same with motion and without.
TEST_F(MotionOutput, FramesAreRowsAtTheirTimes) {
  for (const std::string stepping : {R"(step="0.01")", R"(tolerance="1e-6")"}) {
    const auto scene = [&](const std::string& output) {
      return model(
          R"(<mbd name="p"><body name="rod" mass="2" center="0.5 0 0" inertia="0.001 0.2 0.2"/>
        <revolute name="hinge" between="ground rod" at="0 0 0" axis="0 1 0"/>
        <gravity acceleration="0 0 -9.81"/><transient duration="1" )" +
          stepping + output + R"(/>
        <record name="rod" at="rod" quantities="position rotation"/></mbd>)");
    };
    run_with(scene(R"( output="1/48")"), "rows");
    run_with(scene(""), "frames", 49);
    run_with(scene(""), "none", {}, false);
    const Kept rows(file("rows")), frames(file("frames"));
    ASSERT_EQ(rows.rows.size(), 49U);
    ASSERT_EQ(frames.rows.size(), 49U);
    for (std::size_t i = 0; i < 49; ++i) {
      EXPECT_NEAR(rows.rows[i][0], frames.rows[i][0], 1e-15);
      for (std::size_t k = 1; k < 8; ++k)
        EXPECT_NEAR(rows.rows[i][k], frames.rows[i][k], 1e-13) << i << " " << k;
    }
    EXPECT_EQ(history_text(directory_ / "frames/history.csv"),
              history_text(directory_ / "none/history.csv"));
    EXPECT_FALSE(fs::exists(file("none")));
  }
}

// Two hinges on one axis share what they carry: of least norm, the half each, at frames as in records.
TEST_F(MotionOutput, SharedReactionsAreOfLeastNorm) {
  const std::string door =
      R"(<mbd name="door"><body name="d" mass="3" center="0 0 0" inertia="1 1 1"/>
    <revolute name="one" between="ground d" at="0 0 0" axis="0 0 1"/>
    <revolute name="two" between="ground d" at="0 0 0" axis="0 0 1"/>
    <gravity acceleration="0 0 -10"/><transient duration="0.1" step="0.01"/>
    <record name="d" at="d" quantities="position"/></mbd>)";
  for (const std::optional<int> frames : {std::optional<int>(), std::optional<int>(4)}) {
    run_with(model(door), "out", frames);
    const Kept kept(file("out"));
    for (const Row& row : kept.rows) {
      EXPECT_NEAR(row[kept.joint + 3], 15.0, 1e-9);
      EXPECT_NEAR(row[kept.joint + 7 + 3], 15.0, 1e-9);
    }
  }
}

// --- the file ---

// Where the file ends within a row, as after a kill, the rows before are read; where it is none, it is said.
TEST_F(MotionOutput, WhatIsCutIsRead) {
  run_with(read_model((models / "pendulum.xml").string(), {}), "out");
  const std::string text = read_text(file("out"));
  const Motion whole = read_motion(file("out"));
  const fs::path cut = directory_ / "cut.bin";
  write_text(cut, text.substr(0, text.size() - 3));
  EXPECT_EQ(read_motion(cut).rows, whole.rows - 1);
  const std::size_t last = whole.rows - 2;
  EXPECT_EQ(read_motion_rows(read_motion(cut), std::span(&last, 1)),
            read_motion_rows(whole, std::span(&last, 1)));
  const auto message = [&](const std::string& content) -> std::string {
    write_text(cut, content);
    try {
      read_motion(cut);
    } catch (const Error& error) {
      return error.what();
    }
    return "read";
  };
  const std::size_t head = text.find('\n') + 1;
  const auto changed = [&](const std::string& what, const std::string& into) {
    const std::size_t at = text.find(what);
    EXPECT_LT(at, head) << what;
    return text.substr(0, at) + into + text.substr(std::min(at, head) + what.size());
  };
  for (const std::string& wrong :
       {std::string(), text.substr(0, 100), text.substr(0, head), text.substr(0, head + 20),
        std::string("time,x\n0,1\n"), "{}\n" + text.substr(head), "\n" + text,
        R"({"format":"mbd motion 2","row":3,"blocks":{"key":1},"drawing":{}})"
        "\n" +
            text.substr(head),
        changed("\"key\":1,", "\"key\":11111111111111111111111111111111111,"),
        changed("\"key\":1,", "\"key\":1.5,"), changed("\"key\":1,", "\"key\":-1,"),
        changed("\"key\":1,", "\"key\":0,"), changed("\"key\":1,", "\"key\":18446744073709551615,"),
        changed("\"checksum\":", "\"sum\":"), changed("\"at\":[1,", "\"at\":[9,")}) {
    const std::string said = message(wrong);
    EXPECT_NE(said.find("cut.bin"), std::string::npos) << said;
    EXPECT_NE(said.find("--motion"), std::string::npos) << said;
  }
}

// A run that is killed leaves whole rows of what it has kept so far.
TEST_F(MotionOutput, SurvivesAKill) {
  write_text(directory_ / "long.xml", R"(<mbd name="long">
    <body name="rod" mass="2" center="0.5 0 0" inertia="0.001 0.2 0.2"/>
    <revolute name="hinge" between="ground rod" at="0 0 0" axis="0 1 0"/>
    <gravity acceleration="0 0 -9.81"/><transient duration="100000" step="1e-3" output="0.1"/>
    <record name="rod" at="rod" quantities="position"/></mbd>)");
  Program program({"run", (directory_ / "long.xml").string(), "--motion", "--quiet", "--out",
                   (directory_ / "out").string()},
                  directory_ / "program");
  std::error_code code;
  while (!program.ended() && !(fs::file_size(file("out"), code) > 100'000 && !code))
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  program.signal(SIGKILL);
  ASSERT_EQ(program.wait().status, -SIGKILL);
  const Kept kept(file("out"));
  ASSERT_GT(kept.rows.size(), 100U);
  for (std::size_t i = 0; i < kept.rows.size(); ++i)
    EXPECT_NEAR(kept.rows[i][0], 0.1 * static_cast<double>(i), 1e-6);
}

// A disk that is full ends the run with the file's name, and what was written before stays.
TEST_F(MotionOutput, SaysThatTheDiskIsFull) {
  const std::string model = (models / "pendulum.xml").string();
  const fs::path out = directory_ / "out";
  const Output output = shell("ulimit -f 60; " + quote(mbd_program) + " run " + quote(model) +
                              " --motion --no-estimate --quiet --out " + quote(out.string()));
  EXPECT_EQ(output.status, 1) << output.text;
  EXPECT_NE(output.text.find("cannot be written"), std::string::npos) << output.text;
  EXPECT_LE(fs::file_size(out / "motion.bin"), 61'440U);
}

// An older motion does not stay beside newer results.
TEST_F(MotionOutput, OldOnesAreRemoved) {
  const Scene scene = read_model((models / "elastica.xml").string(), {});
  run_with(scene, "out");
  write_text(directory_ / "out/view.html", "old");
  EXPECT_TRUE(fs::exists(file("out")));
  run_with(scene, "out", {}, false);
  EXPECT_FALSE(fs::exists(file("out")));
  EXPECT_FALSE(fs::exists(directory_ / "out/view.html"));
}

TEST_F(MotionOutput, OptionsOfTheCommand) {
  const std::string pendulum = (models / "pendulum.xml").string(),
                    elastica = (models / "elastica.xml").string();
  const auto mbd = [&](const std::string& words) {
    return shell("cd " + quote(directory_.string()) + " && " + quote(mbd_program) + " " + words);
  };
  const Output kept = mbd("run " + quote(pendulum) + " --frames 11 --out a --no-estimate");
  EXPECT_EQ(kept.status, 0) << kept.text;
  EXPECT_NE(kept.text.find("motion.bin"), std::string::npos) << kept.text;
  EXPECT_EQ(Kept(directory_ / "a/motion.bin").rows.size(), 11U);
  EXPECT_EQ(mbd("run " + quote(elastica) + " --motion --out b --quiet").status, 0);
  EXPECT_EQ(Kept(directory_ / "b/motion.bin").rows.size(), read_history(directory_ / "b").rows());
  for (const std::string wrong : {"1", "0", "2.5", "ten", "-3", "1e3", "99999999"}) {
    const Output output = mbd("run " + quote(pendulum) + " --frames=" + wrong + " --out c");
    EXPECT_EQ(output.status, 1) << output.text;
    EXPECT_NE(output.text.find("--frames " + wrong + ": write a whole number"), std::string::npos)
        << output.text;
  }
  const Output statics = mbd("run " + quote(elastica) + " --frames 10 --out c");
  EXPECT_EQ(statics.status, 1);
  EXPECT_NE(statics.text.find("<transient>"), std::string::npos) << statics.text;
  EXPECT_FALSE(fs::exists(directory_ / "c"));
}

}  // namespace
}  // namespace mbd::test::test_motion
