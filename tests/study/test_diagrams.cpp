// tools/diagrams, with a program in place of mbd that writes what a study would: pictures are kept, models/README.md
// is made, and what is not run or fails stays.

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/support/shell.hpp"

namespace mbd::test::test_diagrams {
namespace {

namespace fs = std::filesystem;

class Diagrams : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(at("tools"));
    fs::create_directories(at("models"));
    fs::copy_file(fs::path(MBD_SOURCE_DIR) / "tools" / "diagrams", at("tools/diagrams"));
    write_text(
        at("models/arm.xml"),
        "<?xml version=\"1.0\"?>\n<!--\n  arm: a < b & c,\n  over two lines.\n\n  More of it.\n"
        "-->\n<mbd/>\n");
    write_text(at("models/beam.xml"), "<!-- beam: one line. -->\n<mbd/>\n");
    write_text(at("models/crank.xml"), "<mbd name=\"crank\"/>\n");
    program("");
  }

  fs::path at(const std::string& name) const { return directory_.path() / name; }

  // accuracy MODEL --budget SECONDS --out DIRECTORY, after what is in `before`.
  void program(const std::string& before) const {
    write_text(at("fake"),
               "#!/bin/sh\n" + before +
                   "\nmkdir -p \"$6\"\necho \"<svg>$2 $4</svg>\" > \"$6/accuracy.svg\"\n"
                   "echo \"- advice of $2\" > \"$6/advice.md\"\n");
    fs::permissions(at("fake"), fs::perms::owner_all);
  }

  Output run(const std::string& arguments) const {
    return shell("sh " + quote(at("tools/diagrams").string()) + " --program ./fake " + arguments);
  }

  std::string readme() const { return read_text(at("models/README.md")); }

  TemporaryDirectory directory_;
};

TEST_F(Diagrams, WithEffectsKeepWhatIsThereAndAreKept) {
  ASSERT_EQ(run("arm").status, 0);
  write_text(at("accuracy"), read_text(at("fake")));
  write_text(at("fake"),
             "#!/bin/sh\n[ \"$1\" = effects ] || exec sh ./accuracy \"$@\"\nmkdir -p \"$6\"\n"
             "echo \"<svg>$1 $2</svg>\" > \"$6/effects.svg\"\n"
             "echo \"| without | of $2 |\" > \"$6/effects.md\"\n");
  fs::permissions(at("fake"), fs::perms::owner_all);
  Output output = run("--effects arm");
  ASSERT_EQ(output.status, 0) << output.text;
  const auto check = [&] {
    const std::string text = readme();
    const std::size_t advice = text.find("- advice of models/arm.xml\n"),
                      effects = text.find("\n### Effects\n"),
                      table = text.find("| without | of models/arm.xml |\n");
    EXPECT_LT(advice, effects) << text;
    EXPECT_LT(effects, table) << text;
    EXPECT_LT(table, text.size()) << text;
    EXPECT_EQ(text.find("### Effects", effects + 5), std::string::npos) << text;
  };
  check();
  EXPECT_EQ(read_text(at("models/pictures/arm_effects.svg")),
            "<svg>effects models/arm.xml</svg>\n");
  EXPECT_EQ(run("arm").status, 0);  // a new study of accuracy
  check();
  EXPECT_EQ(run("--effects arm").status, 0);
  check();
}

TEST_F(Diagrams, OfAllModels) {
  const Output output = run("");
  ASSERT_EQ(output.status, 0) << output.text;
  const std::string text = readme();
  const std::size_t arm = text.find("\n## arm\n\na &lt; b &amp; c, over two lines.\n"),
                    beam = text.find("\n## beam\n\none line.\n"), crank = text.find("\n## crank\n");
  EXPECT_LT(arm, beam) << text;
  EXPECT_LT(beam, crank) << text;
  EXPECT_LT(crank, text.size()) << text;
  EXPECT_NE(text.find("`mbd accuracy models/arm.xml --budget 120`, 20"), std::string::npos) << text;
  EXPECT_NE(text.find("- advice of models/arm.xml\n"), std::string::npos) << text;
  EXPECT_NE(text.find("](pictures/arm.svg)"), std::string::npos) << text;
  EXPECT_EQ(read_text(at("models/pictures/crank.svg")), "<svg>models/crank.xml 120</svg>\n");
}

TEST_F(Diagrams, WhatIsNotRunStays) {
  ASSERT_EQ(run("").status, 0);
  const std::string before = readme();
  Output output = run("--budget 7.5 beam");
  ASSERT_EQ(output.status, 0) << output.text;
  EXPECT_NE(readme().find("`mbd accuracy models/beam.xml --budget 7.5`"), std::string::npos);
  EXPECT_NE(readme().find("`mbd accuracy models/arm.xml --budget 120`"), std::string::npos);
  ASSERT_EQ(run("beam").status, 0);
  EXPECT_EQ(readme(), before);

  program("case \"$2\" in */arm.xml) echo no memory >&2; exit 3 ;; esac");
  output = run("--budget 60");
  EXPECT_EQ(output.status, 1);
  EXPECT_NE(output.text.find("no memory"), std::string::npos) << output.text;
  EXPECT_NE(output.text.find("without a new diagram: arm\n"), std::string::npos) << output.text;
  EXPECT_NE(readme().find("`mbd accuracy models/arm.xml --budget 120`"), std::string::npos);
  EXPECT_NE(readme().find("`mbd accuracy models/crank.xml --budget 60`"), std::string::npos);
}

TEST_F(Diagrams, RefusesWhatItDoesNotKnow) {
  for (const char* arguments : {"wheel", "--budget", "--budget soon", "--fast", "--program no"}) {
    EXPECT_EQ(run(arguments).status, 2) << arguments;
    EXPECT_FALSE(fs::exists(at("models/README.md"))) << arguments;
  }
  const Output help = run("--help");
  EXPECT_EQ(help.status, 0);
  EXPECT_TRUE(help.text.starts_with("Usage: tools/diagrams")) << help.text;
}

}  // namespace
}  // namespace mbd::test::test_diagrams
