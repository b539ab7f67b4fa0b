// The manual and the grammar for XML editors are made from the schema, are checked in as they are made, say
// all there is, and are true: the examples run, the grammar accepts every model and refuses wrong ones.

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "libmbd/core/expression.hpp"
#include "libmbd/language/manual.hpp"
#include "libmbd/language/manual_chapters.hpp"
#include "libmbd/language/quantities.hpp"
#include "libmbd/language/reader.hpp"
#include "libmbd/run/run.hpp"
#include "tests/support/shell.hpp"
#include "tests/support/this_build.hpp"

namespace mbd::test::test_manual {
namespace {

namespace fs = std::filesystem;
using test::read_text;
using test::shell;
using test::write_text;

const fs::path models = fs::path(MBD_SOURCE_DIR) / "models";

#define EXPECT_HAS(text, part) \
  EXPECT_NE((text).find(part), std::string::npos) << "no \"" << (part) << "\" in:\n" << (text)

// ---- the files that are checked in ------------------------------------------------------------

void expect_current(const std::string& file, const std::string& generated,
                    const std::string& option) {
  if (read_text(models / file) == generated) return;
  ADD_FAILURE() << "models/" << file << " is not what the schema says now; renew it:\n  "
                << test::mbd_program << " schema " << option << " > models/" << file;
}
TEST(Manual, CheckedInPageIsCurrent) { expect_current("MANUAL.md", to_markdown(), "--markdown"); }
TEST(Manual, CheckedInGrammarIsCurrent) { expect_current("mbd.xsd", to_xsd(), "--xsd"); }

// ---- it says all there is ---------------------------------------------------------------------

TEST(Manual, DescribesEachElementOnce) {
  const std::string page = to_markdown();
  for (const schema::Element& element : schema::elements()) {
    const std::string section = to_markdown(element);
    const std::size_t first = page.find(section);
    ASSERT_NE(first, std::string::npos)
        << "<" << element.name << "> is in no group of libmbd/language/manual_chapters.cpp";
    EXPECT_EQ(page.find("### " + std::string(element.name) + "\n", first + 5), std::string::npos)
        << element.name;
    for (const schema::Attribute& attribute : element.attributes) {
      if (attribute.name.find(':') != std::string_view::npos) continue;
      EXPECT_HAS(section, "| `" + std::string(attribute.name) + "` ");
      EXPECT_FALSE(attribute.doc.empty()) << element.name << " " << attribute.name;
    }
  }
}

TEST(Manual, ListsJointsAndQuantities) {
  const std::string page = to_markdown();
  for (const schema::JointKind& joint : schema::joint_kinds())
    EXPECT_HAS(page, "| `" + std::string(joint.name) + "` ");
  for (const auto& all : {schema::place_quantities(), schema::joint_quantities(),
                          schema::spring_quantities(), schema::system_quantities()})
    for (const schema::Quantity& quantity : all)
      EXPECT_HAS(page, "| `" + std::string(quantity.name) + "` ");
  const std::string transient = to_markdown(*schema::find_element("transient"));
  EXPECT_HAS(
      transient,
      "| `duration`                   | s     | required           | number > 0              ");
  EXPECT_HAS(transient, "| acceleration or momentum         |");
  EXPECT_HAS(transient, "| number from 0 to 1               |");
  EXPECT_HAS(transient, "| number > 0, or steps             |");
}

TEST(Manual, LinksLeadToHeadings) {
  const std::string page = to_markdown();
  std::set<std::string> anchors;
  for (std::size_t at = 0; (at = page.find("\n## ", at)) != std::string::npos; at += 4) {
    std::string anchor;
    for (const char c : page.substr(at + 4, page.find('\n', at + 4) - at - 4))
      if (c == ' ' || c == '-')
        anchor += '-';
      else if (std::isalnum(static_cast<unsigned char>(c)))
        anchor += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    anchors.insert(anchor);
  }
  std::size_t links = 0;
  for (std::size_t at = 0; (at = page.find("](#", at)) != std::string::npos; at += 3, ++links)
    EXPECT_TRUE(anchors.contains(page.substr(at + 3, page.find(')', at) - at - 3)))
        << page.substr(at, 40);
  EXPECT_EQ(links, anchors.size());
}

// The words of an expression's message about an unknown one, from `title` to the next ';' or the end.
std::set<std::string> known_words(const std::string& title) {
  std::string message;
  try {
    Expression::parse("no_such_word_at_all", {}, Variables::time);
  } catch (const Error& error) {
    message = error.what();
  }
  std::size_t at = message.find(title);
  EXPECT_NE(at, std::string::npos) << message;
  at += title.size();
  std::string list = message.substr(at, message.find(';', at) - at);
  std::replace(list.begin(), list.end(), ',', ' ');
  std::set<std::string> words;
  for (const std::string_view word : schema::words(list)) words.emplace(word);
  return words;
}

TEST(Manual, ListsTheWordsOfExpressionsAndNoOthers) {
  std::set<std::string> functions, constants;
  for (const manual::Word& word : manual::functions()) {
    functions.emplace(word.name);
    std::string arguments;  // each as 0.5, which all of them take
    for (const char c : word.arguments)
      arguments += c == ',' || c == ' ' ? std::string(1, c) : "0.5";
    const std::string call = std::string(word.name) + "(" + arguments + ")";
    EXPECT_NO_THROW(Expression::parse(call, {}, Variables::none)) << call;
  }
  for (const manual::Word& word : manual::constants()) constants.emplace(word.name);
  EXPECT_EQ(functions, known_words("functions "));
  EXPECT_EQ(constants, known_words("constants "));
}

TEST(Manual, TerminalPagesAreNarrow) {
  for (const schema::Element& element : schema::elements()) {
    const std::string page = to_text(element, 80);
    const std::string head = page.substr(0, page.find("\nFor example:"));
    EXPECT_LT(head.size(), page.size()) << "no example with <" << element.name << ">";
    for (std::size_t at = 0; at < head.size();) {
      const std::size_t end = std::min(head.find('\n', at), head.size());
      EXPECT_LE(manual::characters(head.substr(at, end - at)), 80u) << head.substr(at, end - at);
      at = end + 1;
    }
  }
}

// ---- its examples -----------------------------------------------------------------------------

struct Example {
  std::string file, text;
};

// The ```xml blocks; one after a line "`name.xml`:" has that name.
std::vector<Example> examples() {
  const std::string page = to_markdown();
  std::vector<Example> all;
  for (std::size_t at = 0; (at = page.find("\n```xml\n", at)) != std::string::npos;) {
    const std::size_t begin = at + 8, end = page.find("\n```\n", begin) + 1;
    Example example{"example" + std::to_string(all.size()) + ".xml",
                    page.substr(begin, end - begin)};
    const std::size_t line = page.rfind('\n', at - 2) + 1;
    const std::string before = page.substr(line, at - 1 - line);
    if (before.starts_with('`') && before.ends_with("`:"))
      example.file = before.substr(1, before.size() - 3);
    all.push_back(example);
    at = end;
  }
  return all;
}

// The file of Gmsh that an example reads: the block after "`block.msh`:".
Example example_mesh() {
  const std::string page = to_markdown(), head = "\n`block.msh`:\n\n```text\n";
  const std::size_t begin = page.find(head) + head.size();
  return {"block.msh", page.substr(begin, page.find("\n```\n", begin) + 1 - begin)};
}

TEST(Manual, ExamplesRunAndAreAsExpected) {
  const test::TemporaryDirectory directory;
  const std::vector<Example> all = examples();
  EXPECT_EQ(all.size(), manual::groups().size() + 4);
  for (const Example& example : all) write_text(directory.path() / example.file, example.text);
  const Example mesh = example_mesh();
  write_text(directory.path() / mesh.file, mesh.text);
  for (const Example& example : all) {
    SCOPED_TRACE(example.text);
    try {
      const Scene scene = read_model(directory.path() / example.file);
      if (!scene.statics && !scene.transient) continue;  // a file to be included
      const RunReport report = run(scene);
      EXPECT_TRUE(report.complete()) << report.failure;
      for (const ExpectResult& result : report.expects)
        EXPECT_TRUE(result.pass())
            << result.what << " is " << (result.got ? std::to_string(*result.got) : "nothing");
    } catch (const Error& error) {
      ADD_FAILURE() << error.what();
    }
  }
}

TEST(Manual, EachElementStandsInAnExample) {
  std::string text;
  for (const Example& example : examples()) text += example.text;
  for (const schema::Element& element : schema::elements())
    if (schema::find_joint_kind(element.name) == nullptr &&
        element.name != "extension") {  // it needs a plug-in
      EXPECT_HAS(text, "<" + std::string(element.name));
    }
}

// ---- the grammar ------------------------------------------------------------------------------

class Grammar : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(shell("xmllint --version").status, 0)
        << "xmllint is missing: install libxml2-utils (tools/install-dependencies --with-tests)";
    write_text(directory_.path() / "mbd.xsd", to_xsd());
  }
  // What xmllint says of a file; empty when it is valid.
  std::string complaint(const fs::path& model) const {
    const test::Output output =
        shell("xmllint --noout --nowarning --schema " + (directory_.path() / "mbd.xsd").string() +
              " " + model.string());
    return output.status == 0 ? "" : output.text;
  }
  std::string complaint_of(const std::string& text) const {
    write_text(directory_.path() / "model.xml", text);
    return complaint(directory_.path() / "model.xml");
  }
  std::string inside(const std::string& text) const {
    return complaint_of("<mbd name=\"m\">" + text + "</mbd>");
  }
  const test::TemporaryDirectory directory_;
};

TEST_F(Grammar, AcceptsEveryModel) {
  int count = 0;
  for (const auto& entry : fs::directory_iterator(models)) {
    if (entry.path().extension() != ".xml") continue;
    ++count;
    EXPECT_EQ(complaint(entry.path()), "");
  }
  EXPECT_GT(count, 10);
}

TEST_F(Grammar, AcceptsEveryExampleOfTheManual) {
  for (const Example& example : examples())
    EXPECT_EQ(complaint_of(example.text), "") << example.text;
}

TEST_F(Grammar, AcceptsWhatTheReaderAccepts) {
  for (const char* const text : {
           "",
           "<static/><!-- comment --><static/>",  // twice: only the reader knows
           "<static> <!-- a comment\n --> </static>",
           "<gravity acceleration=' 0 0\n -9.81 '/>",
           "<parameter name='a' value='t > 1 ? 2*3 : (1 + 2) mm'/>",
           "<record name='r{i + 1}' at=' bar{ i }@{i}/3 ' quantities='velocity'/>",
           "<repeat count='2'><repeat count='3' index='j'><body name='b{i}-{j}' mass='1' "
           "inertia='1 1 1'/></repeat></repeat>",
           "<curve name='c' section='s' normal='0 0 1'><repeat count='2'><point at='i 0 0'/>"
           "<repeat count='1' index='j'><point at='i j 1'/></repeat></repeat></curve>",
           "<section name='s'><repeat count='2'><station at='i'><stiffness>1 2 3</stiffness>"
           "</station></repeat></section>",
           "<fixed name='f' between='ground  b.start'/>",
       })
    EXPECT_EQ(inside(text), "") << text;
}

TEST_F(Grammar, RefusesWhatIsWrong) {
  const std::string bar = "<beam name='b' section='s' from='0 0 0' to='1 0 0' normal='0 0 1' ";
  ASSERT_EQ(inside(bar + "/>"), "");
  const std::map<std::string, std::string> wrong{
      {"<baem/>", "'baem'"},
      {bar + "ordr='3'/>", "'ordr'"},
      {"<beam name='b' section='s' from='0 0 0' normal='0 0 1'/>", "'to' is required"},
      {"<parameter name='a'/>", "'value' is required"},
      {"<revolute name='A' axis='0 0 1'/>", "'between' is required"},
      {"<load force='0 0 1'/>", "'at' is required"},
      {bar + "metric='geodesi'/>", "'geodesi'"},
      {bar + "order=''/>", "'order'"},
      {"<fixed name='f' between='ground b.strat'/>", "b.strat"},
      {"<fixed name='f' between='ground'/>", "'ground'"},
      {"<body name='two words' mass='1' inertia='1 1 1'/>", "two words"},
      {"<point at='0 0 0'/>", "'point'"},
      {"<repeat count='2'><point at='0 0 0'/></repeat>", "'point'"},
      {"<repeat count='2'><gravity acceleration='0 0 1'/></repeat>", "'gravity'"},
      {"<repeat count='2' indx='j'/>", "'indx'"},
      {"<curve name='c' section='s' normal='0 0 1'><repeat count='2'>" + bar +
           "/></repeat></curve>",
       "'beam'"},
      {bar + "><point at='0 0 0'/></beam>", "'point'"},
      {"some text", "'mbd'"},
      {"<static>text</static>", "'static'"},
  };
  for (const auto& [text, part] : wrong) {
    const std::string said = inside(text);
    EXPECT_NE(said, "") << "accepted: " << text;
    EXPECT_HAS(said, part);
  }
  EXPECT_HAS(complaint_of("<mbd/>"), "'name' is required");
  EXPECT_HAS(complaint_of(bar + "/>"), "'beam'");  // no root
}

// <defaults>: elements with any of their attributes but a name.
TEST_F(Grammar, OfDefaults) {
  EXPECT_EQ(inside("<defaults><beam order='4' metric='quaternion'/><revolute axis='0 0 1'/>"
                   "<mass per_length='1'/><station/><point twist='1'/><curve degree='3'/>"
                   "<stiffness EA='1'/><load force='0 0 1'/></defaults>"),
            "");
  const std::string given =
      "<defaults><beam section='s' normal='0 0 1'/><record quantities='velocity'/></defaults>";
  EXPECT_EQ(inside(given + "<beam name='b' from='0 0 0' to='1 0 0'/><record name='r' at='b.end'/>"),
            "");
  EXPECT_HAS(inside(given + "<beam name='b' from='0 0 0'/>"), "'to' is required");
  EXPECT_HAS(inside("<defaults><beam name='b'/></defaults>"), "'name' is not allowed");
  EXPECT_HAS(inside("<defaults><load name='b'/></defaults>"), "'name' is not allowed");
  EXPECT_HAS(inside("<defaults><beam ordr='3'/></defaults>"), "'ordr' is not allowed");
  EXPECT_HAS(inside("<defaults><beam metric='geo'/></defaults>"), "'geo'");
  EXPECT_HAS(inside("<defaults><curve><point/></curve></defaults>"), "'curve'");
  EXPECT_HAS(inside("<defaults><parameter value='1'/></defaults>"), "'parameter'");
  EXPECT_HAS(inside("<repeat count='1'><defaults/></repeat>"), "'defaults'");
}

}  // namespace
}  // namespace mbd::test::test_manual
