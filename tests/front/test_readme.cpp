// The terminal sessions of README.md and of the pages it leads to are true: their commands are run, in order, in one new directory, and
// print what it says they print.
//
//   ```console       lines "$ command" are run by bash; what follows is the expected output, standard
//   $ mbd --version  error included. "…" alone on a line stands for any number of lines, inside a line for
//   mbd …            any text. A command whose line ends in \ goes on in the next. All commands of a
//   …                block are one session: variables, `cd` and $? last to its end.
//   ```
//   ```xml           after a line that has the file's name in backticks and ends in a colon ("Save this
//                    as `cantilever.xml`:") makes that file.
//
// The program is first in the PATH as `mbd`; the models are a directory `models`.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <optional>
#include <sstream>
#include <vector>

#include "tests/support/machine.hpp"
#include "tests/support/shell.hpp"
#include "tests/support/this_build.hpp"

namespace mbd::test::test_readme {
namespace {

namespace fs = std::filesystem;
using test::quote;
using test::write_text;

constexpr std::string_view anything = "…";

struct Line {
  int number;  // in the document
  std::string text;
};

struct Step {
  Line command;
  std::vector<Line> expected;
};

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    while (!line.empty() && (line.back() == ' ' || line.back() == '\r')) line.pop_back();
    lines.push_back(line);
  }
  while (!lines.empty() && lines.back().empty()) lines.pop_back();
  return lines;
}

// Whether a line is as expected, "…" being any text.
bool matches(std::string_view expected, std::string_view actual) {
  const std::size_t wild = expected.find(anything);
  if (wild == std::string_view::npos) return expected == actual;
  if (!actual.starts_with(expected.substr(0, wild))) return false;
  const std::string_view rest = expected.substr(wild + anything.size());
  for (std::size_t at = wild; at <= actual.size(); ++at)
    if (matches(rest, actual.substr(at))) return true;
  return false;
}

// The number of the first expected line that the output cannot have, or nothing if it is as expected;
// expected.size() when there is more output than expected.
std::optional<std::size_t> first_difference(const std::vector<Line>& expected,
                                            const std::vector<std::string>& actual) {
  // reached[j]: the lines so far can be the first j of the output
  std::vector<bool> reached(actual.size() + 1, false);
  reached[0] = true;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    std::vector<bool> next(actual.size() + 1, false);
    bool any = false;
    for (std::size_t j = 0; j <= actual.size(); ++j) {
      if (expected[i].text == anything)
        next[j] = reached[j] || (j > 0 && next[j - 1]);
      else
        next[j] = j > 0 && reached[j - 1] && matches(expected[i].text, actual[j - 1]);
      any = any || next[j];
    }
    if (!any) return i;
    reached = std::move(next);
  }
  if (reached[actual.size()]) return std::nullopt;
  return expected.size();
}

class Document {
 public:
  Document(std::string name, const std::string& text) : name_(std::move(name)) {
    fs::create_directories(work());
    fs::create_directories(bin());
    fs::create_symlink(test::mbd_program, bin() / "mbd");
    fs::create_directory_symlink(fs::path(MBD_SOURCE_DIR) / "models", work() / "models");
    read(text);
  }

  // One message for each command that does not print what is expected, each block that is wrong.
  const std::vector<std::string>& differences() const { return differences_; }
  int commands() const { return commands_; }

 private:
  fs::path work() const { return directory_.path() / "work"; }
  fs::path bin() const { return directory_.path() / "bin"; }

  void complain(int line, const std::string& what) {
    differences_.push_back(name_ + ":" + std::to_string(line) + ": " + what);
  }

  void read(const std::string& text) {
    std::istringstream stream(text);
    std::string last, kind;  // the line before that is not blank; of the block we are in
    std::vector<Line> block;
    bool inside = false;
    int number = 0, begin = 0;
    std::string file;
    for (std::string line; std::getline(stream, line);) {
      ++number;
      if (!line.starts_with("```")) {
        if (inside)
          block.push_back({number, line});
        else if (!line.empty())
          last = line;
        continue;
      }
      inside = !inside;
      if (inside) {
        kind = line.substr(3);
        file = file_named(last);
        block.clear();
        begin = number;
      } else {
        if (kind == "console") run(begin, block);
        if (kind == "xml" && !file.empty()) save(file, block);
        last.clear();
      }
    }
    if (inside) complain(begin, "the block does not end");
  }

  // The last name in backticks of a line that ends in a colon.
  static std::string file_named(const std::string& line) {
    if (!line.ends_with(':')) return {};
    const std::size_t end = line.rfind('`');
    if (end == std::string::npos || end == 0) return {};
    const std::size_t begin = line.rfind('`', end - 1);
    if (begin == std::string::npos) return {};
    const std::string name = line.substr(begin + 1, end - begin - 1);
    const bool plain = name.ends_with(".xml") && name.find_first_of("/ <") == std::string::npos;
    return plain ? name : std::string();
  }

  void save(const std::string& file, const std::vector<Line>& block) {
    std::string text;
    for (const Line& line : block) text += line.text + "\n";
    write_text(work() / file, text);
  }

  std::vector<Step> steps_of(int begin, const std::vector<Line>& block) {
    std::vector<Step> steps;
    bool goes_on = false;
    for (const Line& line : block) {
      if (goes_on) {
        steps.back().command.text += "\n" + line.text;
      } else if (line.text.starts_with("$ ")) {
        steps.push_back({{line.number, line.text.substr(2)}, {}});
      } else if (steps.empty()) {
        complain(begin, "a session begins with a line \"$ command\"");
        return {};
      } else {
        steps.back().expected.push_back(line);
        continue;
      }
      goes_on = line.text.ends_with('\\');
    }
    for (Step& step : steps) {
      for (Line& line : step.expected)
        while (!line.text.empty() && line.text.back() == ' ') line.text.pop_back();
      while (!step.expected.empty() && step.expected.back().text.empty()) step.expected.pop_back();
    }
    return steps;
  }

  void run(int begin, const std::vector<Line>& block) {
    const std::vector<Step> steps = steps_of(begin, block);
    if (steps.empty()) return;
    // A line with a record separator ends the output of each command; $? is kept for the next.
    std::string script;
    for (const Step& step : steps)
      script += step.command.text + "\n_status=$?; printf '\\n\\036\\n'; (exit $_status)\n";
    write_text(directory_.path() / "session", script);
    const std::string text =
        test::shell("cd " + quote(work().string()) + " && PATH=" + quote(bin().string()) +
                    ":\"$PATH\" timeout " + std::to_string(test::whole_guard(600)) + " bash " +
                    quote((directory_.path() / "session").string()))
            .text;
    std::size_t at = 0;
    for (const Step& step : steps) {
      ++commands_;
      const std::size_t end = text.find("\n\036\n", at);
      compare(step, text.substr(at, end == std::string::npos ? end : end - at));
      if (end == std::string::npos) {
        complain(step.command.number, "the session ended with this command, or took too long");
        return;
      }
      at = end + 3;
    }
  }

  void compare(const Step& step, const std::string& output) {
    const std::vector<std::string> actual = lines_of(output);
    const std::optional<std::size_t> wrong = first_difference(step.expected, actual);
    if (!wrong) return;
    std::string message;
    int line = step.command.number;
    if (*wrong < step.expected.size()) {
      line = step.expected[*wrong].number;
      message = "expected \"" + step.expected[*wrong].text + "\"";
    } else {
      message = "the command prints more than is expected";
    }
    message += "\n$ " + step.command.text + " prints:\n";
    for (const std::string& printed : actual) message += printed + "\n";
    complain(line, message);
  }

  std::string name_;
  const test::TemporaryDirectory directory_;
  std::vector<std::string> differences_;
  int commands_ = 0;
};

std::string joined(const std::vector<std::string>& all) {
  std::string text;
  for (const std::string& one : all) text += one + "\n";
  return text;
}

std::string differences(const std::string& text) {
  return joined(Document("x.md", text).differences());
}

// ---- the harness itself -----------------------------------------------------------------------

TEST(ReadmeHarness, AcceptsWhatIsTrue) {
  EXPECT_EQ(differences(R"(Text, and `code`:

```sh
no session
```
```console
$ echo one; echo two >&2
one
two
$ printf 'a\n\nb\n'
a

b

$ true
$ seq 1 20
1
…
19
20
$ seq 1 3
…
$ echo "energy 1.234e-5 J, 17 steps"
energy … J, … steps
$ echo \
  continued
continued
$ x=5; cd ..; (exit 3)
$ echo $? $x; basename $PWD/work
3 5
work
```
Save this as `small.xml`:

```xml
<mbd name="small"/>
```
```console
$ cat small.xml; ls
<mbd name="small"/>
models
small.xml
$ ls models/pendulum.xml
models/pendulum.xml
$ mbd --version
mbd …
…
```
)"),
            "");
}

TEST(ReadmeHarness, SaysWhichLineIsFalse) {
  EXPECT_EQ(differences("```console\n$ seq 1 3\n1\n3\n```\n"),
            "x.md:4: expected \"3\"\n$ seq 1 3 prints:\n1\n2\n3\n\n");
  EXPECT_EQ(differences("a\n\n```console\n$ seq 1 2\n1\n```\n"),
            "x.md:4: the command prints more than is expected\n$ seq 1 2 prints:\n1\n2\n\n");
  EXPECT_EQ(differences("```console\n$ true\nmore\n$ echo x\ny\n```\n"),
            "x.md:3: expected \"more\"\n$ true prints:\n\nx.md:5: expected \"y\"\n$ echo x "
            "prints:\nx\n\n");
  EXPECT_EQ(differences("```console\n$ seq 1 9\n…\n5\n…\n4\n…\n```\n").substr(0, 23),
            "x.md:6: expected \"4\"\n$ ");
  EXPECT_EQ(differences("```console\n$ echo ab\na…c\n```\n").substr(0, 24),
            "x.md:3: expected \"a…c\"");
  EXPECT_EQ(differences("```console\n$ exit 1\n$ echo x\nx\n```\n"),
            "x.md:2: the session ended with this command, or took too long\n");
  EXPECT_EQ(differences("```console\nprompt> x\n```\n"),
            "x.md:1: a session begins with a line \"$ command\"\n");
  EXPECT_EQ(differences("```console\n$ true\n"), "x.md:1: the block does not end\n");
}

// ---- README -----------------------------------------------------------------------------------

const fs::path root = MBD_SOURCE_DIR;

void expect_true(const std::string& page) {
  const std::string text = test::read_text(root / page);
  ASSERT_FALSE(text.empty()) << page;
  const Document document(page, text);
  EXPECT_EQ(joined(document.differences()), "");
  EXPECT_EQ(document.commands() > 0, text.find("```console") != std::string::npos);
}

TEST(Readme, ItsSessionsAreTrue) { expect_true("README.md"); }
TEST(Readme, SessionsOfTheGuideAreTrue) { expect_true("models/GUIDE.md"); }
TEST(Readme, SessionsOfStudiesAreTrue) { expect_true("models/STUDIES.md"); }
TEST(Readme, SessionsOfTheEngineAreTrue) { expect_true("libmbd/ENGINE.md"); }

// A heading as GitHub's link to it.
std::string anchor_of(const std::string& heading) {
  std::string anchor;
  for (const char c : heading) {
    if (c == ' ')
      anchor += '-';
    else if (std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_')
      anchor += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return anchor;
}

// Links and pictures of a page that lead nowhere, in Markdown and in src="…".
std::vector<std::string> dead_links(const fs::path& page, const std::string& text) {
  std::vector<std::string> dead, targets;
  for (const std::string_view mark : {"](", "src=\""})
    for (std::size_t at = 0; (at = text.find(mark, at)) != std::string::npos; ++at) {
      const std::size_t begin = at + mark.size();
      targets.push_back(text.substr(begin, text.find_first_of(")\"", begin) - begin));
    }
  for (const std::string& target : targets) {
    if (target.starts_with("http")) continue;
    const std::size_t hash = target.find('#');
    const fs::path file = hash == 0 ? page : page.parent_path() / target.substr(0, hash);
    bool is_there = fs::exists(file);
    if (is_there && hash != std::string::npos) {
      is_there = false;
      std::istringstream lines(hash == 0 ? text : test::read_text(file));
      for (std::string line; std::getline(lines, line);)
        if (line.starts_with('#'))
          is_there = is_there ||
                     anchor_of(line.substr(std::min(line.find_first_not_of("# "), line.size()))) ==
                         target.substr(hash + 1);
    }
    if (!is_there) dead.push_back(target);
  }
  return dead;
}

TEST(Readme, LinksLeadSomewhere) {
  const fs::path here = root / "README.md";
  EXPECT_EQ(
      dead_links(here,
                 "[a](LICENSE) [b](#x-y) <img src=\"no.png\"> [c](none.md) [d](#z)\n## X, y\n"),
      (std::vector<std::string>{"none.md", "#z", "no.png"}));
  for (const char* page : {"README.md", "models/GUIDE.md", "models/STUDIES.md", "libmbd/ENGINE.md"})
    EXPECT_EQ(joined(dead_links(root / page, test::read_text(root / page))), "") << page;
}

// At most 1,500 words; a mechanism that moves, of less than 1 MB, and how to run it within the first screen (40 lines);
// and every page of the table of contents.
TEST(Readme, IsAFrontPage) {
  const std::string text = test::read_text(root / "README.md");
  std::istringstream words(text);
  int count = 0;
  for (std::string word; words >> word;) ++count;
  EXPECT_LE(count, 1500);
  std::istringstream lines(text);
  std::string screen;
  int number = 0;
  for (std::string line; number < 40 && std::getline(lines, line); ++number) screen += line + "\n";
  EXPECT_NE(screen.find("tools/quickstart"), std::string::npos);
  EXPECT_NE(screen.find("Not: "), std::string::npos);
  const std::size_t at = screen.find("src=\"");
  ASSERT_NE(at, std::string::npos);
  const std::string picture = screen.substr(at + 5, screen.find('"', at + 5) - at - 5),
                    bytes = test::read_text(root / picture);
  EXPECT_LT(bytes.size(), 1'000'000U);
  int frames = 0;
  for (std::size_t i = 0; (i = bytes.find("ANMF", i)) != std::string::npos; ++i) ++frames;
  EXPECT_GE(frames, 50) << picture;
  for (const char* page :
       {"models/GUIDE.md", "models/MANUAL.md", "models/STUDIES.md", "models/README.md",
        "libmbd/ENGINE.md", "libmbd/NOTATION.md", "tests/README.md"})
    EXPECT_NE(text.find("](" + std::string(page) + ")"), std::string::npos) << page;
}

}  // namespace
}  // namespace mbd::test::test_readme
