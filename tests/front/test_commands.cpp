// The command mbd: its help, its version, shell completion, and what it answers to wrong use.

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <vector>

#include "libmbd/language/manual.hpp"
#include "libmbd/results/build_facts.hpp"
#include "libmbd/results/report.hpp"
#include "tests/support/program.hpp"
#include "tests/support/shell.hpp"
#include "tests/support/this_build.hpp"

namespace mbd::test::test_commands {
namespace {

namespace fs = std::filesystem;
using test::bash;
using test::Output;
using test::quote;
using test::read_text;
using test::shell;
using test::write_text;

Output mbd_command(const std::string& arguments) {
  return shell(quote(test::mbd_program) + " " + arguments);
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

// The commands, from what the help says.
std::vector<std::string> commands() {
  std::vector<std::string> names;
  bool listed = false;
  for (const std::string& line : lines_of(mbd_command("--help").text)) {
    if (listed && line.empty()) break;
    if (listed && line.size() > 3 && line[2] != ' ')
      names.push_back(line.substr(2, line.find(' ', 2) - 2));
    if (line == "Commands:") listed = true;
  }
  return names;
}

#define EXPECT_HAS(text, part) \
  EXPECT_NE((text).find(part), std::string::npos) << "no \"" << (part) << "\" in:\n" << (text)

// ---- help -------------------------------------------------------------------------------------

TEST(Help, OfEachCommandHasExamplesAndExitStatus) {
  ASSERT_GE(commands().size(), 3u);
  std::vector<std::string> pages{"--help", "-h"};
  for (const std::string& command : commands()) pages.push_back(command + " --help");
  for (const std::string& arguments : pages) {
    SCOPED_TRACE(arguments);
    const Output help = mbd_command(arguments);
    EXPECT_EQ(help.status, 0);
    EXPECT_HAS(help.text, "\nUsage: mbd ");
    EXPECT_HAS(help.text, "\nOptions:\n  -h, --help ");
    EXPECT_HAS(help.text, "\nExamples:\n  ");
    EXPECT_HAS(help.text, "\nExit status: 0 all went well; 1 an error");
    EXPECT_FALSE(help.text.ends_with("\n\n"));
    for (const std::string& line : lines_of(help.text))
      EXPECT_LE(manual::characters(line), 100u) << line;
  }
}

TEST(Help, ExamplesAreAcceptedByTheirCommands) {
  // Those without files to read or write are run; in all of them the command exists.
  const std::vector<std::string> known = commands();
  for (const std::string& command : known)
    for (const std::string& line : lines_of(mbd_command(command + " --help").text)) {
      if (!line.starts_with("  mbd ")) continue;
      const std::string name = line.substr(6, line.find(' ', 6) - 6);
      EXPECT_NE(std::find(known.begin(), known.end(), name), known.end()) << line;
      if (line.find("models/") == std::string::npos && line.find('>') == std::string::npos &&
          name == "schema") {
        EXPECT_EQ(mbd_command(line.substr(6)).status, 0) << line;
      }
    }
}

// ---- version ----------------------------------------------------------------------------------

TEST(VersionCommand, SaysHowItWasBuilt) {
  const Output output = mbd_command("--version");
  EXPECT_EQ(output.status, 0);
  const std::vector<std::string> lines = lines_of(output.text);
  const auto facts = to_lines(build_facts());
  ASSERT_EQ(lines.size(), facts.size() + 1) << output.text;
  EXPECT_EQ(lines[0], "mbd " + std::string(mbd::version()));
  for (std::size_t i = 0; i < facts.size(); ++i) {
    EXPECT_EQ(lines[i + 1], facts[i].first + ": " + facts[i].second);
    EXPECT_FALSE(facts[i].second.empty()) << facts[i].first;
  }
  for (const char* const library :
       {"Eigen 3.", "KLU 1.", "tinyxml2 ", "fmt ", "nlohmann_json 3.", "UDUNITS 2."})
    EXPECT_HAS(lines[4], library);
  // and so does report.json
  const std::string report = to_json(RunReport{});
  for (const auto& [name, value] : facts) EXPECT_HAS(report, "\"" + name + "\": \"" + value + "\"");
}

// The script that finds the commit, in trees made here.
class Commit : public testing::Test {
 protected:
  void make_repository() const {
    const Output made =
        bash("cd " + root().string() +
             " && git init -q && git config user.name x && git config user.email x@x "
             "&& echo 1 > a && git add a && git commit -qm 1");
    ASSERT_EQ(made.status, 0) << made.text;
  }
  // What the script writes for a tree.
  std::string header(const fs::path& source, const std::string& option = "") const {
    const Output run = shell(quote(MBD_CMAKE) + " " + option + " -DSOURCE=" + source.string() +
                             " -DHEADER=" + header_file().string() + " -P " + MBD_SOURCE_DIR +
                             "/tools/cmake/write_commit.cmake");
    EXPECT_EQ(run.status, 0) << run.text;
    return read_text(header_file());
  }
  fs::path root() const { return directory_.path(); }
  fs::path header_file() const { return other_.path() / "commit.hpp"; }
  const test::TemporaryDirectory directory_, other_;
};

TEST_F(Commit, IsThatOfTheTree) {
  make_repository();
  const std::string commit =
      bash("git -C " + root().string() + " rev-parse --short=12 HEAD").text.substr(0, 12);
  EXPECT_HAS(header(root()), "MBD_COMMIT \"" + commit + "\"\n#define MBD_COMMIT_MODIFIED false");
  write_text(root() / "a", "2\n");
  EXPECT_HAS(header(root()), "MBD_COMMIT \"" + commit + "\"\n#define MBD_COMMIT_MODIFIED true");
}

TEST_F(Commit, IsUnknownOutsideOfItsRepository) {
  const std::string unknown = "MBD_COMMIT \"unknown\"\n#define MBD_COMMIT_MODIFIED false";
  EXPECT_HAS(header(root()), unknown);
  make_repository();
  fs::create_directories(root() / "archive");
  EXPECT_HAS(header(root() / "archive"), unknown);            // inside another repository
  EXPECT_HAS(header(root(), "-DGIT=/nowhere/git"), unknown);  // without git
}

TEST_F(Commit, IsWrittenOnlyWhenItChanges) {
  make_repository();
  header(root());
  const auto before = fs::last_write_time(header_file()) - std::chrono::hours(1);
  fs::last_write_time(header_file(), before);
  header(root());
  EXPECT_EQ(fs::last_write_time(header_file()), before);
  write_text(root() / "a", "2\n");
  header(root());
  EXPECT_NE(fs::last_write_time(header_file()), before);
}

// ---- wrong use --------------------------------------------------------------------------------

TEST(WrongUse, IsAnsweredWithTheNearestAndARefusal) {
  const struct {
    std::string arguments, says, then;
  } cases[] = {
      {"rnu model.xml", "mbd: unknown command \"rnu\"; did you mean \"run\"?", "mbd --help"},
      {"schem", "did you mean \"schema\"?", "mbd --help"},
      {"--verson", "mbd: unknown option --verson; did you mean \"--version\"?", "mbd --help"},
      {"run --ouput=x model.xml",
       "mbd run: unknown option --ouput; did you mean \"--output\"? The options of mbd run are: ",
       "mbd run --help"},
      {"run --ouput x model.xml", "unknown option --ouput", "mbd run --help"},
      {"run", "mbd run: MODEL is required", "mbd run --help"},
      {"run a.xml b.xml", "the argument \"b.xml\" is one too many", "mbd run --help"},
      {"run a.xml --set", "--set: 1 required NAME=VALUE missing", "mbd run --help"},
      {"completion tcsh", "tcsh not in {bash,zsh,fish}", "mbd completion --help"},
      {"schema --xsd beam", "ELEMENT excludes --xsd", "mbd schema --help"},
  };
  for (const auto& c : cases) {
    const Output output = mbd_command(c.arguments);
    EXPECT_GE(output.status, 100) << c.arguments;
    EXPECT_HAS(output.text, c.says);
    EXPECT_TRUE(output.text.ends_with("\nTry: " + c.then + "\n")) << output.text;
    EXPECT_EQ(mbd_command(c.arguments + " 2>/dev/null").text, "") << "not on standard error";
  }
}

TEST(WrongUse, NothingAskedForIsAnsweredWithHelp) {
  const Output output = mbd_command("");
  EXPECT_GE(output.status, 100);
  EXPECT_EQ(output.text, mbd_command("--help").text);
}

// Standard streams that are closed or full: an exit status, no abort, and no message in the file that took their place.
TEST(WrongUse, ClosedAndFullStreamsAreSurvived) {
  const std::string mbd = quote(test::mbd_program),
                    model = quote(std::string(MBD_SOURCE_DIR) + "/models/pendulum.xml");
  const TemporaryDirectory directory;
  const std::string out = (directory.path() / "out").string();
  for (const char* stream : {"2>&-", "2>/dev/full"}) {
    EXPECT_EQ(shell(mbd + " run no_such_model.xml " + stream).status, 1) << stream;
    EXPECT_GE(shell(mbd + " no_such_command " + stream).status, 100) << stream;
    EXPECT_EQ(
        shell(mbd + " run " + model + " --out " + quote(out) + " >/dev/null " + stream).status, 0)
        << stream;
  }
  for (const char* stream : {">&-", ">/dev/full", ">&- 2>&- <&-"}) {
    EXPECT_EQ(shell(mbd + " run " + model + " --out " + quote(out) + " " + stream).status, 1)
        << stream;
    const std::string rows = contents(directory.path() / "out/history.csv");
    EXPECT_TRUE(rows.starts_with("# model: pendulum")) << stream << rows.substr(0, 200);
    EXPECT_EQ(rows.find("mbd:"), std::string::npos) << stream;
  }
}

// A limit of the size of files is an error like a full disk: what was written stays, with the reason.
TEST(WrongUse, AFileThatMayNotGrowIsAnError) {
  const TemporaryDirectory directory;
  const Output output = shell("ulimit -f 16; " + quote(test::mbd_program) + " run " +
                              quote(std::string(MBD_SOURCE_DIR) + "/models/chain.xml") + " --out " +
                              quote((directory.path() / "out").string()));
  EXPECT_EQ(output.status, 1) << output.text;
  EXPECT_HAS(output.text, "File too large");
}

TEST(WrongUse, WhatCannotBePrintedIsAnError) {
  const Output output = shell(quote(test::mbd_program) + " schema --xsd > /dev/full");
  EXPECT_EQ(output.status, 1);
  EXPECT_HAS(output.text, "could not be written");
}

// ---- mbd schema -------------------------------------------------------------------------------

TEST(SchemaCommand, PrintsWhatIsAskedFor) {
  EXPECT_EQ(mbd_command("schema --xsd").text, to_xsd());
  EXPECT_EQ(mbd_command("schema --markdown").text, to_markdown());
  const schema::Element& beam = *schema::find_element("beam");
  EXPECT_EQ(mbd_command("schema beam").text, to_text(beam));
  EXPECT_EQ(mbd_command("schema '<beam>'").text, to_text(beam));
  EXPECT_EQ(mbd_command("schema --markdown beam").text, to_markdown(beam));
  EXPECT_HAS(mbd_command("schema").text, list_of_elements());
  const Output unknown = mbd_command("schema baem");
  EXPECT_EQ(unknown.status, 1);
  EXPECT_HAS(unknown.text, "mbd: schema: unknown element \"baem\"; did you mean \"beam\"?");
}

// ---- completion -------------------------------------------------------------------------------

class Completion : public testing::Test {
 protected:
  Completion() {
    fs::create_directories(directory_.path() / "results/fine");
    fs::create_directories(directory_.path() / "two words");
    for (const char* const name : {"arm.xml", "arc 2.xml", "table.csv"})
      write_text(directory_.path() / name, "");
  }
  // What bash offers, sorted, for words before the cursor; the last of them is being written. Bash makes
  // words of "=" too.
  std::vector<std::string> offers(const std::vector<std::string>& words) const {
    std::string array;
    for (const std::string& word : words) array += " " + quote(word);
    const Output output = bash(
        "cd " + quote(directory_.path().string()) + "\nsource <(" + quote(test::mbd_program) +
        " completion bash) || exit 9\nCOMP_WORDS=(mbd" + array +
        ")\nCOMP_CWORD=" + std::to_string(words.size()) +
        "\n_mbd || exit 8\n((${#COMPREPLY[@]})) && printf '%s\\n' \"${COMPREPLY[@]}\"\nexit 0");
    EXPECT_EQ(output.status, 0) << output.text;
    std::vector<std::string> all = lines_of(output.text);
    std::sort(all.begin(), all.end());
    return all;
  }
  const test::TemporaryDirectory directory_;
};

using Words = std::vector<std::string>;

TEST_F(Completion, OffersCommandsAndOptions) {
  Words all = commands();
  std::sort(all.begin(), all.end());
  EXPECT_EQ(offers({""}), all);
  EXPECT_EQ(offers({"sch"}), (Words{"schema"}));
  EXPECT_EQ(offers({"--v"}), (Words{"--version"}));
  EXPECT_EQ(offers({"run", "--o"}), (Words{"--out", "--output"}));
  EXPECT_EQ(offers({"run", "arm.xml", "--s"}), (Words{"--set", "--stages", "--step"}));
  EXPECT_EQ(offers({"nonsense", ""}), Words{});
  // every option of every command's help
  for (const std::string& command : commands()) {
    const Words known = offers({command, "-"});
    for (const std::string& line : lines_of(mbd_command(command + " --help").text)) {
      if (!line.starts_with("  -")) continue;
      std::istringstream words(line);
      for (std::string word; words >> word && word[0] == '-';) {
        if (word.back() == ',') word.pop_back();
        EXPECT_NE(std::find(known.begin(), known.end(), word), known.end())
            << command << " " << word;
      }
    }
  }
}

TEST_F(Completion, OffersFilesWhereTheyBelong) {
  const Words models{"arc 2.xml", "arm.xml", "results", "two words"};
  const Words directories{"results", "two words"};
  EXPECT_EQ(offers({"run", ""}), models);
  EXPECT_EQ(offers({"run", "arm"}), (Words{"arm.xml"}));
  EXPECT_EQ(offers({"run", "--quiet", ""}), models);
  EXPECT_EQ(offers({"run", "arm.xml", ""}), Words{});
  EXPECT_EQ(offers({"run", "arm.xml", "--out", ""}), directories);
  EXPECT_EQ(offers({"run", "arm.xml", "-o", "results/"}), (Words{"results/fine"}));
  EXPECT_EQ(offers({"run", "--out", "=", "res"}), (Words{"results"}));
  EXPECT_EQ(offers({"run", "--out", "="}), directories);
  EXPECT_EQ(offers({"run", "--out", "results", ""}), models);
  EXPECT_EQ(offers({"run", "--out", "=", "results", ""}), models);
  EXPECT_EQ(offers({"run", "--set", ""}), Words{});
  EXPECT_EQ(offers({"run", "--set", "a", "=", "1"}), Words{});
  EXPECT_EQ(offers({"run", "--set", "a", "=", "1", ""}), models);
}

TEST_F(Completion, OffersChoices) {
  EXPECT_EQ(offers({"completion", ""}), (Words{"bash", "fish", "zsh"}));
  EXPECT_EQ(offers({"schema", "bea"}), (Words{"beam"}));
  EXPECT_EQ(offers({"schema", ""}).size(), schema::elements().size());
}

// Shells that are not here cannot be asked: then their scripts are looked at only.
TEST_F(Completion, OfOtherShellsHasEveryCommandAndOption) {
  const std::string zsh = mbd_command("completion zsh").text,
                    fish = mbd_command("completion fish").text;
  EXPECT_TRUE(zsh.starts_with("#compdef mbd\n"));
  for (const std::string& command : commands()) {
    EXPECT_HAS(zsh, "\n    '" + command + ":");
    EXPECT_HAS(zsh, "\n        " + command + ") _arguments \\\n");
    EXPECT_HAS(fish, "-n '__fish_use_subcommand' -a '" + command + "' -d '");
    for (const std::string& option : offers({command, "-"})) {
      const bool is_long = option.starts_with("--");
      const std::string when = "-n '__fish_seen_subcommand_from " + command + "'";
      bool found = false;
      for (const std::string& line : lines_of(fish))
        found =
            found || (line.find(when) != std::string::npos &&
                      line.find((is_long ? " -l " + option.substr(2) : " -s " + option.substr(1)) +
                                " ") != std::string::npos);
      EXPECT_TRUE(found) << command << " " << option;
      const std::size_t begin = zsh.find("\n        " + command + ") _arguments");
      EXPECT_NE(zsh.substr(begin, zsh.find(";;", begin) - begin).find(option), std::string::npos)
          << command << " " << option;
    }
  }
  for (const std::string* const script : {&zsh, &fish}) {  // quotes are in pairs on each line
    for (std::string line : lines_of(*script)) {
      if (line.starts_with('#')) continue;
      for (std::size_t at; (at = line.find("'\\''")) != std::string::npos;) line.erase(at, 4);
      EXPECT_EQ(std::count(line.begin(), line.end(), '\'') % 2, 0) << line;
    }
  }
  write_text(directory_.path() / "script", zsh);
  if (shell("command -v zsh").status == 0) {
    EXPECT_EQ(shell("zsh -n " + (directory_.path() / "script").string()).text, "");
  }
  write_text(directory_.path() / "script", fish);
  if (shell("command -v fish").status == 0) {
    EXPECT_EQ(shell("fish -n " + (directory_.path() / "script").string()).text, "");
  }
}

}  // namespace
}  // namespace mbd::test::test_commands
