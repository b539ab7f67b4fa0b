// What mbd check and mbd explain say of models: counts, what is there and what is not, and the mistakes
// that a run would find before its first step.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>

#include "libmbd/run/describe.hpp"
#include "tests/support/program.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/temporary_directory.hpp"

namespace mbd::test::test_describe {
namespace {

namespace fs = std::filesystem;

const fs::path models = fs::path(MBD_SOURCE_DIR) / "models";
const fs::path bad_models = fs::path(MBD_SOURCE_DIR) / "tests" / "bad_models";

std::vector<fs::path> all_models() {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(models))
    if (entry.path().extension() == ".xml") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

CheckReport check_of(const Scene& scene) { return check_model(scene, compile(scene)); }
Explanation explanation_of(const Scene& scene) { return explain_model(scene, compile(scene)); }
CheckReport check_of(const std::string& name) {
  return check_of(read_model(models / (name + ".xml")));
}
Explanation explanation_of(const std::string& name) {
  return explanation_of(read_model(models / (name + ".xml")));
}

Index stated(const CheckReport& report, const std::string& what) {
  for (const Count& count : report.stated)
    if (count.what == what) return count.count;
  ADD_FAILURE() << "no count of " << what;
  return -1;
}

const Term& term(const Explanation& e, const std::string& type) {
  for (const Term& one : e.terms)
    if (one.type.starts_with(type)) return one;
  throw std::runtime_error("no term " + type);
}

// Where an effect comes from, joined by ";"; empty: it is not simulated.
std::string origin(const Explanation& e, const std::string& what) {
  std::string all;
  for (const Effect& effect : e.effects)
    if (effect.what.find(what) != std::string::npos)
      for (const std::string& from : effect.from) all += (all.empty() ? "" : ";") + from;
  return all;
}

// Why an effect is absent; empty: it is not said to be.
std::string why(const Explanation& e, const std::string& what) {
  for (const Absence& absence : e.absent)
    if (absence.what.find(what) != std::string::npos) return absence.why;
  return {};
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

std::string message_of(const Scene& scene) {
  try {
    check_of(scene);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

// ---- check ------------------------------------------------------------------------------------

TEST(Check, CountsAPendulum) {
  const CheckReport report = check_of("pendulum");
  EXPECT_EQ(report.model, "pendulum");
  EXPECT_EQ(stated(report, "bodies"), 1);
  EXPECT_EQ(stated(report, "beams"), 0);
  EXPECT_EQ(stated(report, "joints"), 1);
  EXPECT_EQ(report.elements, 0);
  EXPECT_EQ(report.nodes, 2);
  EXPECT_EQ(report.multipliers, 5);
  EXPECT_EQ(report.unknowns, 6 + 5);
  EXPECT_EQ(report.steps, 10000);
  EXPECT_EQ(report.columns, 11);
  EXPECT_FALSE(report.statics);
  EXPECT_TRUE(report.notes.empty());
}

TEST(Check, CountsAFourBar) {
  const CheckReport report = check_of("four_bar");
  EXPECT_EQ(stated(report, "sections"), 2);
  EXPECT_EQ(stated(report, "beams"), 3);
  EXPECT_EQ(stated(report, "elements"), 8);
  EXPECT_EQ(report.elements, 8);  // every attachment is where elements meet
  EXPECT_EQ(stated(report, "joints"), 4);
  EXPECT_EQ(stated(report, "drives"), 1);
  EXPECT_EQ(report.nodes, 1 + (2 + 4 + 2) * 3 + 3);
  EXPECT_EQ(report.multipliers, 4 * 5 + 1);
  EXPECT_EQ(report.unknowns, 6 * (report.nodes - 1) + report.multipliers);
  EXPECT_EQ(report.steps, 4000);
  EXPECT_EQ(report.energy.total(), report.energy.strain);
  EXPECT_NEAR(report.energy.strain, 0.0, 1e-20);
  EXPECT_LT(report.position.value, 1e-12);
}

TEST(Check, CountsAChainOfAnyLength) {
  const CheckReport report = check_of(read_model(models / "chain.xml", {{"N", "7"}}));
  EXPECT_EQ(stated(report, "bodies"), 7);
  EXPECT_EQ(stated(report, "joints"), 7);
  EXPECT_EQ(report.nodes, 8);
  EXPECT_EQ(report.multipliers, 21);
}

TEST(Check, CountsTheElementsThatAttachmentsAdd) {
  Scene scene = read_model(models / "bend45.xml");
  RecordScene record;
  record.name = "between";
  record.at = {Place::Kind::beam, scene.beams[0].name, 0.31};
  record.quantities = {"displacement"};
  scene.records.push_back(record);
  EXPECT_EQ(check_of(scene).elements, 8);  // what is recorded there needs no node
  LoadScene load;
  load.at = *record.at;
  const Expression one = Expression::parse("1", {}, Variables::time);
  load.force = {one, one, one};
  scene.loads.push_back(load);
  const CheckReport report = check_of(scene);
  EXPECT_EQ(stated(report, "elements"), 8);
  EXPECT_EQ(report.elements, 9);
}

TEST(Check, TellsSizeAndMass) {
  const CheckReport bar = check_of("four_bar");
  EXPECT_LT((bar.high - Vec3(0.24, 0.12, 0.0)).norm(), 1e-12);
  EXPECT_EQ(bar.low, Vec3(0.0, 0.0, 0.0));
  ASSERT_TRUE(bar.mass);
  EXPECT_NEAR(*bar.mass, 1.9968 * 0.36 + 0.4992 * 0.12, 1e-12);  // two thick bars and a thin one
  EXPECT_FALSE(check_of("bend45").mass);
}

TEST(Check, TellsEnergiesOfTheStart) {
  const CheckReport top = check_of("heavy_top");
  Scene scene = test::model_scene("heavy_top");
  scene.transient->duration = 2.0 * scene.transient->step.value();
  const test::History history = test::run_to_table(scene);
  EXPECT_GT(top.energy.kinetic, 5000.0);
  EXPECT_NEAR(top.energy.total(), history.report.energy_start.total(), 1e-9);
}

TEST(Check, FindsWhatARunRefuses) {
  Scene scene = read_model(models / "pendulum.xml");
  scene.plots.at(0).y = {"bob.positon.3"};
  EXPECT_TRUE(contains(message_of(scene), "plot: \"bob.positon.3\" is not a column"));
  scene = read_model(models / "pendulum.xml");
  scene.plots.at(0).x = "tme";
  EXPECT_TRUE(contains(message_of(scene), "plot: \"tme\" is not a column"));
  scene = read_model(models / "pendulum.xml");
  scene.expects.at(0).at = 0.00055;
  scene.expects.at(0).of = ExpectScene::Of::value_at;
  EXPECT_TRUE(contains(message_of(scene), "whole number of steps"));
  scene = read_model(models / "pendulum.xml");
  scene.expects.at(0).quantity = "bob.mood";
  EXPECT_TRUE(contains(message_of(scene), "expect: \"bob.mood\" is not a column"));
  scene = read_model(models / "pendulum.xml");
  scene.transient->step = 3e-3;
  scene.expects.clear();
  EXPECT_TRUE(contains(message_of(scene), "not a whole number of steps"));
  EXPECT_EQ(message_of(read_model(models / "pendulum.xml")), "no error");
}

TEST(Check, NotesSayWhatToMend) {
  // The same hinge twice: each of its five rows is there already.
  const CheckReport twice = check_of(read_model(bad_models / "good" / "joints_twice.xml"));
  EXPECT_EQ(twice.redundant.size(), 5u);
  EXPECT_TRUE(twice.notes.empty());
  const CheckReport loose = check_of(read_model(bad_models / "nothing_holds_it.xml"));
  ASSERT_EQ(loose.notes.size(), 1u);
  EXPECT_TRUE(contains(loose.notes[0], "free to move")) << loose.notes[0];
}

// ---- explain ----------------------------------------------------------------------------------

TEST(Explain, TermsOfAPendulum) {
  const Explanation e = explanation_of("pendulum");
  ASSERT_EQ(e.terms.size(), 3u);
  EXPECT_EQ(term(e, "inertia").contributions, 36);
  EXPECT_EQ(term(e, "gravity").contributions, 36);
  EXPECT_EQ(term(e, "revolute").contributions, 36 + 2 * 5 * 6);  // the ground takes nothing
  EXPECT_EQ(e.nonzeros, 36 + 2 * 5 * 6);                         // all on the one node
}

TEST(Explain, TermsOfAFourBar) {
  const Explanation e = explanation_of("four_bar");
  EXPECT_EQ(term(e, "inertia").size, 27);
  EXPECT_EQ(term(e, "inertia").contributions, 27 * 36);
  EXPECT_EQ(term(e, "beam elastic").size, 8);
  EXPECT_EQ(term(e, "beam elastic").contributions, 8 * 4 * 4 * 36);
  EXPECT_EQ(term(e, "revolute").contributions,
            2 * (36 + 2 * 5 * 6) + 2 * (4 * 36 + 4 * 5 * 6));  // two on the ground, two not
  EXPECT_EQ(term(e, "driven rotation").contributions, 36 + 2 * 6);
}

TEST(Explain, NonzerosAreThoseOfTheGraph) {
  for (const fs::path& file : all_models()) {
    SCOPED_TRACE(file.filename());
    const Scene scene = read_model(file);
    const Model model = compile(scene);
    const Explanation e = explain_model(scene, model);
    const BlockGraph& graph = model.system->graph();
    std::set<std::pair<int, int>> places;
    Index added = 0;
    const auto numbers = [&](int row, int column) {
      return graph.blocks[static_cast<std::size_t>(row)].size *
             graph.blocks[static_cast<std::size_t>(column)].size;
    };
    for (const auto& [row, column] : graph.contributions) {
      if (row < 0 || column < 0) continue;
      places.insert({row, column});
      added += numbers(row, column);
    }
    Index nonzeros = 0;
    for (const auto& [row, column] : places) nonzeros += numbers(row, column);
    EXPECT_EQ(e.nonzeros, nonzeros);
    Index contributions = 0;
    std::size_t bytes = 0;
    for (std::size_t i = 0; i < e.terms.size(); ++i) {
      contributions += e.terms[i].contributions;
      bytes += e.terms[i].bytes;
      EXPECT_EQ(e.terms[i].type, model.system->batches()[i]->type());
      EXPECT_EQ(e.terms[i].size, model.system->batches()[i]->size());
    }
    EXPECT_EQ(contributions, added);
    EXPECT_EQ(e.batch_bytes, bytes);
    EXPECT_GE(e.state_bytes,
              sizeof(State) + static_cast<std::size_t>(e.nodes) * 7 * sizeof(double));
  }
}

TEST(Explain, SaysWhereEffectsAreStated) {
  const Explanation e = explanation_of("four_bar");
  const Scene scene = read_model(models / "four_bar.xml");
  EXPECT_EQ(origin(e, "driven joints"),
            "drive \"A\", line " + std::to_string(scene.drives.at(0).source.line));
  EXPECT_TRUE(contains(origin(e, "coupling"), "section \"box8\", line "));
  EXPECT_TRUE(contains(origin(e, "revolute joints"), "revolute \"D\", line "));
  EXPECT_TRUE(contains(origin(e, "inertia"), "section \"box16\""));
  EXPECT_EQ(why(e, "gravity"), "no <gravity>");
  EXPECT_EQ(origin(e, "gravity"), "");
}

TEST(Explain, NamesTheFileOfAnIncludedStatement) {
  Scene scene = read_model(models / "pendulum.xml");
  scene.gravity->source = {"earth.xml", 3};
  EXPECT_EQ(origin(explanation_of(scene), "gravity"), "<gravity>, earth.xml:3");
  scene.gravity->source = {};
  EXPECT_EQ(origin(explanation_of(scene), "gravity"), "<gravity>");
}

TEST(Explain, SaysWhatIsAbsentAndWhy) {
  const Explanation pendulum = explanation_of("pendulum");
  EXPECT_TRUE(contains(why(pendulum, "elastic deformation"), "every body is rigid"));
  EXPECT_TRUE(contains(why(pendulum, "structural damping"), "rho_infinity = 0.9"));
  EXPECT_NE(origin(pendulum, "gravity"), "");
  EXPECT_EQ(why(pendulum, "gravity"), "");
  EXPECT_EQ(why(pendulum, "distributed loads"), "no <distributed>");

  const Explanation bend = explanation_of("bend45");  // an equilibrium only
  EXPECT_TRUE(contains(why(bend, "inertia"), "no <transient>"));
  EXPECT_EQ(why(bend, "course in time"), "no <transient>");
  EXPECT_EQ(why(bend, "structural damping"), "no <damping> in a <section> used");
  Scene damped = read_model(models / "damped_beam.xml");
  EXPECT_TRUE(contains(origin(explanation_of(damped), "structural damping"), "section \"bar\""));
  EXPECT_TRUE(contains(origin(explanation_of(damped), "proportional to mass"), "section \"bar\""));
  EXPECT_EQ(why(explanation_of(damped), "structural damping"), "");
  damped.sections[0].damping = SectionDamping{};
  EXPECT_TRUE(contains(why(explanation_of(damped), "structural damping"), "is zero: section"));
  damped = read_model(models / "damped_beam.xml");
  damped.transient.reset();
  EXPECT_TRUE(contains(why(explanation_of(damped), "structural damping"), "no <transient>"));
  EXPECT_NE(origin(bend, "curved beams"), "");
  const Explanation frame = explanation_of("portal_frame");
  EXPECT_EQ(why(frame, "coupling"), "the stiffness of every section used is diagonal");
  EXPECT_EQ(why(frame, "sections that vary"), "no section used has stations");
  const Explanation blade = explanation_of("swept_cantilever");
  EXPECT_TRUE(contains(origin(blade, "coupling"), "section \"blade\""));
  EXPECT_TRUE(contains(origin(blade, "sections that vary"), "section \"blade\""));
}

TEST(Explain, FollowsTheScene) {
  Scene scene = read_model(models / "four_bar.xml");
  for (Section& section : scene.sections)
    section.stiffness = Mat6(section.stiffness.diagonal().asDiagonal());
  scene.transient->rho_infinity = 1.0;
  Explanation e = explanation_of(scene);
  EXPECT_EQ(origin(e, "coupling"), "");
  EXPECT_NE(why(e, "coupling"), "");
  EXPECT_TRUE(contains(why(e, "numerical damping"), "rho_infinity = 1"));
  EXPECT_EQ(origin(e, "numerical damping"), "");

  scene = read_model(models / "pendulum.xml");
  scene.gravity->acceleration.setZero();
  e = explanation_of(scene);
  EXPECT_EQ(origin(e, "gravity"), "");
  EXPECT_TRUE(contains(why(e, "gravity"), "its acceleration is zero"));

  // Stated, but zero.
  scene = read_model(models / "pendulum.xml");
  LoadScene load;
  load.name = "push";
  load.at = {Place::Kind::body, scene.bodies.at(0).name, 0.0};
  const Expression zero = Expression::parse("0", {}, Variables::time);
  load.force = {zero, zero, zero};
  scene.loads.push_back(load);
  e = explanation_of(scene);
  EXPECT_EQ(origin(e, "fixed direction"), "");
  EXPECT_TRUE(contains(why(e, "fixed direction"), "those stated are zero: load \"push\""));
  EXPECT_EQ(why(e, "follow"), "no follower_force or follower_moment");
}

TEST(Explain, TellsWhenTheIntegratorStartsAfresh) {
  Scene scene = read_model(models / "pendulum.xml");
  EXPECT_EQ(why(explanation_of(scene), "new starts"), "");  // nothing that could jump
  LoadScene load;
  load.name = "push";
  load.at = {Place::Kind::body, scene.bodies.at(0).name, 0.0};
  const auto component = [](const char* text) {
    return Expression::parse(text, {}, Variables::time);
  };
  load.force = {component("t"), component("0"), component("0")};
  scene.loads.push_back(load);
  EXPECT_NE(why(explanation_of(scene), "new starts"), "");
  scene.loads[0].force->at(0) = component("t < 0.25 ? 0 : 1");
  const Explanation e = explanation_of(scene);
  EXPECT_EQ(origin(e, "new starts"), "t = 0.25 s");
  EXPECT_EQ(origin(e, "loads at places"), "load \"push\"");
}

TEST(Explain, NothingIsBothThereAndAbsent) {
  for (const fs::path& file : all_models()) {
    SCOPED_TRACE(file.filename());
    const Explanation e = explanation_of(read_model(file));
    std::set<std::string> seen;
    for (const Effect& effect : e.effects) {
      EXPECT_TRUE(seen.insert(effect.what).second) << effect.what;
      EXPECT_FALSE(effect.from.empty()) << effect.what;
    }
    for (const Absence& absence : e.absent) {
      EXPECT_TRUE(seen.insert(absence.what).second) << absence.what;
      EXPECT_FALSE(absence.why.empty()) << absence.what;
    }
  }
}

// ---- both, as text and JSON -------------------------------------------------------------------

std::size_t longest_line(const std::string& text) {
  std::istringstream lines(text);
  std::size_t longest = 0;
  for (std::string line; std::getline(lines, line);)
    longest = std::max(longest,
                       static_cast<std::size_t>(std::count_if(line.begin(), line.end(), [](char c) {
                         return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;
                       })));
  return longest;
}

TEST(Describe, TextFitsAndJsonParses) {
  for (const fs::path& file : all_models()) {
    SCOPED_TRACE(file.filename());
    Scene scene = read_model(file);
    const Model model = compile(scene);
    scene.file = file.filename();
    const CheckReport report = check_model(scene, model);
    const Explanation e = explain_model(scene, model);
    EXPECT_LE(longest_line(to_text(report)), 80u) << to_text(report);
    EXPECT_LE(longest_line(to_text(e)), 80u) << to_text(e);
    for (const std::string& text : {to_text(report), to_text(e)})
      EXPECT_FALSE(contains(text, " \n")) << text;
    const auto checked = nlohmann::json::parse(to_json(report));
    EXPECT_EQ(checked["model"], scene.name);
    EXPECT_EQ(checked["system"]["unknowns"], report.unknowns);
    EXPECT_EQ(checked["stated"]["distributed_loads"], scene.distributed_loads.size());
    EXPECT_EQ(checked["settings"].contains("transient"), scene.transient.has_value());
    const auto explained = nlohmann::json::parse(to_json(e));
    EXPECT_EQ(explained["totals"]["nonzeros"], e.nonzeros);
    EXPECT_EQ(explained["terms"].size(), e.terms.size());
    EXPECT_EQ(explained["absent"].size(), e.absent.size());
  }
}

TEST(Describe, FilesThatAreNotUtf8AreWritten) {
  Scene scene = read_model(models / "pendulum.xml");
  const Model model = compile(scene);
  scene.file = "caf\xe9.xml";
  const std::string json = to_json(check_model(scene, model));
  EXPECT_EQ(nlohmann::json::parse(json)["file"], "caf\xef\xbf\xbd.xml");
  EXPECT_TRUE(nlohmann::json::accept(to_json(explain_model(scene, model))));
}

// ---- the commands -----------------------------------------------------------------------------

class DescribeCommands : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(path_ / "empty");
    before_ = fs::current_path();
    fs::current_path(path_ / "empty");
  }
  void TearDown() override {
    EXPECT_TRUE(fs::is_empty(path_ / "empty")) << "a command that only reads has written a file";
    fs::current_path(before_);
  }
  test::Ended mbd(const std::vector<std::string>& arguments) const {
    return test::Program(arguments, path_ / "scratch").wait();
  }

  const TemporaryDirectory scratch_;
  const fs::path path_ = scratch_.path();
  fs::path before_;
};

TEST_F(DescribeCommands, CheckEveryModel) {
  std::vector<std::string> arguments = {"check"};
  for (const fs::path& file : all_models()) arguments.push_back(file.string());
  const test::Ended all = mbd(arguments);
  EXPECT_EQ(all.status, 0);
  EXPECT_EQ(all.err, "");
  for (std::size_t i = 1; i < arguments.size(); ++i)
    EXPECT_TRUE(contains(all.out, "(" + arguments[i] + ")\n")) << arguments[i];
}

TEST_F(DescribeCommands, ExplainEveryModel) {
  for (const fs::path& file : all_models()) {
    const test::Ended one = mbd({"explain", file.string()});
    EXPECT_EQ(one.status, 0) << one.err;
    EXPECT_TRUE(contains(one.out, "Absent, and why\n"));
  }
}

TEST_F(DescribeCommands, CheckGoesOnAfterAModelThatIsWrong) {
  const std::string wrong = (bad_models / "plot_of_no_column.xml").string();
  const std::string missing = "missing.xml";
  const std::string right = (models / "pendulum.xml").string();
  const test::Ended ended = mbd({"check", wrong, missing, right});
  EXPECT_EQ(ended.status, 1);
  EXPECT_EQ(std::count(ended.err.begin(), ended.err.end(), '\n'), 2) << ended.err;
  EXPECT_TRUE(ended.err.starts_with("mbd: " + wrong + ":")) << ended.err;
  EXPECT_TRUE(contains(ended.err, "\nmbd: missing.xml")) << ended.err;
  EXPECT_TRUE(ended.out.starts_with("pendulum (")) << ended.out;
}

TEST_F(DescribeCommands, SetGivesParameters) {
  const std::string chain = (models / "chain.xml").string();
  test::Ended ended = mbd({"check", "--set", "N=4", chain});
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_TRUE(contains(ended.out, "4 bodies, 4 joints")) << ended.out;
  ended = mbd({"explain", chain, "--set", "N=4", "--json"});
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(nlohmann::json::parse(ended.out)["totals"]["multipliers"], 12);
  ended = mbd({"check", chain, "--set", "N"});
  EXPECT_EQ(ended.status, 1);
  EXPECT_EQ(ended.err, "mbd: --set N: write --set name=value, without blanks around =\n");
  EXPECT_EQ(mbd({"explain", chain, "--set", "M=4"}).status, 1);
  EXPECT_GT(mbd({"check"}).status, 99);
  EXPECT_GT(mbd({"explain"}).status, 99);
}

}  // namespace
}  // namespace mbd::test::test_describe
