// Reader and compile on texts that are no models: what the fuzzer found (tests/fuzz/findings), and models cut short
// or changed, the same in every run. Each is read or refused by an Error that says where; nothing else comes out.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "libmbd/compile/model.hpp"
#include "libmbd/core/error.hpp"
#include "libmbd/language/quantities.hpp"
#include "libmbd/language/reader.hpp"
#include "libmbd/language/schema.hpp"
#include "tests/fuzz/mutation.hpp"
#include "tests/hard/hard_case.hpp"
#include "tests/support/machine.hpp"

namespace mbd::test::test_fuzz_findings {
namespace {

namespace fs = std::filesystem;
const fs::path root = MBD_SOURCE_DIR;

// A guard: a text takes milliseconds, one with sections from material a second, and 15 of them under sanitizers.
constexpr double most_seconds = 10.0, most_seconds_of_sections = 200.0;
constexpr long most_nodes = 300;  // larger ones are not built

std::string contents(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

std::vector<fs::path> files_of(const std::vector<std::string>& directories,
                               const std::string& extension) {
  std::vector<fs::path> files;
  for (const std::string& directory : directories)
    if (fs::exists(root / directory))
      for (const auto& entry : fs::directory_iterator(root / directory))
        if (entry.is_regular_file() && (extension.empty() || entry.path().extension() == extension))
          files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

std::vector<fs::path> models() { return files_of({"models", "models/hard"}, ".xml"); }

// What became of a text.
struct Outcome {
  bool refused = false;
  std::string message;  // why, if it was
  std::string
      wrong;  // what should not be: another exception, a message without place, too much time
};

// `f` reads; what it throws is what counts.
Outcome outcome_of(const std::function<void()>& f, const std::string& file,
                   double longest = most_seconds) {
  Outcome outcome;
  const std::clock_t begun = std::clock();
  try {
    f();
  } catch (const Error& error) {
    outcome.refused = true;
    outcome.message = error.what();
    if (!outcome.message.starts_with(file + ":"))
      outcome.wrong = "a message that does not say where: " + outcome.message;
  } catch (const std::exception& error) {
    outcome.wrong = std::string("another exception: ") + error.what();
  }
  const double seconds = static_cast<double>(std::clock() - begun) / CLOCKS_PER_SEC;
  if (seconds > guard(longest)) outcome.wrong = fmt::format("{:.0f} s", seconds);
  return outcome;
}

bool has_material(const std::string& text) { return text.find("<material") != std::string::npos; }

Outcome outcome_of(const std::string& text, bool all = false) {
  const std::string file = "no_such_directory/model.xml";
  return outcome_of(
      [&] {
        const Scene scene = read_model_text(text, file);
        long nodes = std::ssize(scene.bodies);
        for (const BeamScene& b : scene.beams) nodes += 1 + long{b.elements} * long{b.order};
        if (nodes > most_nodes && !all) return;
        const Model model = compile(scene);
        VecX residual;
        model.system->residual(model.initial, residual);
      },
      file, has_material(text) ? most_seconds_of_sections : most_seconds);
}

TEST(FuzzFindings, WhatIsNeitherReadNorRefusedIsNoticed) {
  const auto wrong = [](const std::function<void()>& f) { return outcome_of(f, "m.xml").wrong; };
  EXPECT_EQ(wrong([] {}), "");
  EXPECT_EQ(wrong([] { throw Error(Source{"m.xml", 3}, "load: nothing"); }), "");
  EXPECT_NE(wrong([] { throw Error("load: nothing"); }), "");
  EXPECT_NE(wrong([] { throw std::out_of_range("vector"); }), "");
  EXPECT_NE(wrong([] { throw std::bad_alloc(); }), "");
}

TEST(FuzzFindings, EachIsReadOrRefused) {
  const std::vector<fs::path> findings = files_of({"tests/fuzz/findings"}, "");
  ASSERT_FALSE(findings.empty());
  for (const fs::path& file : findings)
    EXPECT_EQ(outcome_of(contents(file), true).wrong, "") << file;
  hard::record({.id = "9z",
                .what = "fuzzing of reader and compile",
                .run = "tools/fuzz",
                .reference = "read, or refused by an Error that says where",
                .error = fmt::format("{} input kept (tests/fuzz/findings), found by size; the "
                                     "fuzzer has found none",
                                     findings.size()),
                .shown = "in the test: other exceptions, messages without place"});
}

// Found by size, not by the fuzzer: entries of the matrix were counted beyond the largest int.
TEST(FuzzFindings, MoreNodesThanCanBeSolvedForAreRefused) {
  const Outcome outcome =
      outcome_of(contents(root / "tests/fuzz/findings/nodes_too_many.xml"), true);
  EXPECT_NE(outcome.message.find("may have 1000000"), std::string::npos) << outcome.message;
}

// Wherever a file ends too early, it is refused, by a line that it has.
TEST(FuzzFindings, ModelsCutShortAreRefused) {
  constexpr std::size_t cuts = 40;
  std::size_t texts = 0;
  for (const fs::path& file : models()) {
    const std::string text = contents(file);
    const std::size_t end = text.rfind("</mbd>") + 5;  // of all but the last character
    for (std::size_t k = 0; k < cuts; ++k) {
      const std::string cut = text.substr(0, end * (k + 1) / cuts);
      const Outcome outcome = outcome_of(cut);
      EXPECT_TRUE(outcome.refused) << file << " cut after " << cut.size() << " bytes";
      EXPECT_EQ(outcome.wrong, "") << file << " cut after " << cut.size() << " bytes";
      const auto colon = outcome.message.find(".xml:");
      const int line =
          colon == std::string::npos ? 0 : std::atoi(outcome.message.c_str() + colon + 5);
      EXPECT_LE(line, 1 + std::count(cut.begin(), cut.end(), '\n')) << outcome.message;
      EXPECT_GE(line, 1) << outcome.message;
      ++texts;
    }
  }
  hard::record({.id = "9x",
                .what = "models cut short",
                .run = "in C++",
                .reference = "invariant: refused, with a line the text has",
                .error = fmt::format("0 of {} accepted", texts),
                .shown = "the whole text, which is accepted"});
}

TEST(FuzzFindings, WholeModelsAreRead) {
  for (const fs::path& file : models()) {
    const Outcome outcome = outcome_of(contents(file));
    EXPECT_FALSE(outcome.refused) << file << outcome.message;
  }
}

// One byte, or a tag or a value.
TEST(FuzzFindings, ModelsChangedAreReadOrRefused) {
  constexpr unsigned most_changes = 40, changes_of_sections = 8;
  std::size_t texts = 0, refused = 0;
  unsigned seed = 1;
  for (const fs::path& file : models()) {
    const std::string text = contents(file);
    const unsigned changes = has_material(text) ? changes_of_sections : most_changes;
    for (unsigned k = 0; k < changes; ++k, ++seed) {
      Mutation mutation(seed);
      std::string changed = k % 4 == 0 ? mutation.byte(text) : mutation(text);
      if (k % 4 == 3) changed = mutation(changed);
      const Outcome outcome = outcome_of(changed);
      EXPECT_EQ(outcome.wrong, "") << file << " changed by " << seed;
      ++texts;
      refused += outcome.refused ? 1 : 0;
    }
  }
  // Or they would not go deep enough, or change nothing.
  EXPECT_GT(refused, texts / 10);
  EXPECT_LT(refused, texts - texts / 10);
  hard::record({.id = "9y",
                .what = "models with a byte, a tag or a value changed",
                .run = "in C++",
                .reference = "invariant: read, or refused by an Error that says where",
                .error = fmt::format("{} of {} read, the others refused", texts - refused, texts),
                .shown = "in the test: other exceptions, messages without place"});
}

// tests/fuzz/model.dict: the words of the schema, of expressions, and pieces of XML.
std::string dictionary() {
  std::set<std::string> words;
  const auto add = [&words](std::string_view word) {
    for (const std::string_view w : schema::words(word)) words.emplace(w);
  };
  for (const schema::Element& element : schema::elements()) {
    add(element.name);
    for (const schema::Attribute& attribute : element.attributes) {
      add(attribute.name);
      add(attribute.choices);
    }
  }
  for (const auto quantities : {schema::place_quantities(), schema::joint_quantities(),
                                schema::spring_quantities(), schema::system_quantities()})
    for (const schema::Quantity& quantity : quantities) add(quantity.name);
  add("sin( cos( sqrt( exp( log( abs( min( max( pi deg t s ground .start .end @0.5 1e9 1e-9 1e308 "
      "nan mm kN rad/s");
  add("<mbd <!-- --> <![CDATA[ ]]> <?xml &lt; &amp; &#0; /> </ =");
  std::string text =
      "# Words of models, for tools/fuzz. Written by FuzzFindings.DictionaryHasTheWordsOfTheSchema "
      "with "
      "MBD_UPDATE_TABLES=1.\n";
  for (const std::string& word : words) text += "\"" + word + "\"\n";
  return text;
}

TEST(FuzzFindings, DictionaryHasTheWordsOfTheSchema) {
  const fs::path file = root / "tests/fuzz/model.dict";
  if (std::getenv("MBD_UPDATE_TABLES") != nullptr) std::ofstream(file) << dictionary();
  EXPECT_EQ(contents(file), dictionary());
}

}  // namespace
}  // namespace mbd::test::test_fuzz_findings
