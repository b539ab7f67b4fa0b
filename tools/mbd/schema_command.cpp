#include "tools/mbd/schema_command.hpp"

#include <fmt/format.h>

#include <memory>
#include <string>
#include <vector>

#include "libmbd/core/error.hpp"
#include "libmbd/language/manual.hpp"
#include "libmbd/language/schema.hpp"
#include "libmbd/text/spelling.hpp"
#include "tools/mbd/command_line.hpp"

namespace mbd {
namespace {

struct SchemaArguments {
  std::string element;
  bool xsd = false, markdown = false;
};

const schema::Element& find_element(std::string name) {
  if (name.size() > 2 && name.front() == '<' && name.back() == '>')
    name = name.substr(1, name.size() - 2);
  if (const schema::Element* const element = schema::find_element(name)) return *element;
  std::vector<std::string_view> known;
  for (const schema::Element& element : schema::elements()) known.push_back(element.name);
  throw Error("schema: unknown element \"" + name + "\"" + suggest(name, known, "elements"));
}

std::string schema_text(const SchemaArguments& arguments) {
  if (arguments.xsd) return to_xsd();
  if (!arguments.element.empty()) {
    const schema::Element& element = find_element(arguments.element);
    return arguments.markdown ? to_markdown(element) : to_text(element);
  }
  if (arguments.markdown) return to_markdown();
  return "Elements of a model file; mbd schema ELEMENT prints the page of one.\n\n" +
         list_of_elements();
}

}  // namespace

void add_schema_command(CLI::App& app, int& status) {
  const auto arguments = std::make_shared<SchemaArguments>();
  CLI::App* const command = app.add_subcommand(
      "schema",
      "Prints what a model file may say: all elements, the page of one, the manual, or a grammar.");
  CLI::Option* const element =
      command->add_option("ELEMENT", arguments->element, "print the page of this element");
  CLI::Option* const markdown = command->add_flag(
      "--markdown", arguments->markdown, "print the manual (or the element's part) in Markdown");
  command->add_flag("--xsd", arguments->xsd, "print an XML Schema of model files, for XML editors")
      ->excludes(markdown)
      ->excludes(element);
  set_examples(*command,
               "mbd schema\n"
               "mbd schema beam\n"
               "mbd schema --xsd > mbd.xsd\n"
               "mbd schema --markdown > MANUAL.md");
  command->callback([arguments, &status] {
    fmt::print("{}", schema_text(*arguments));
    status = 0;
  });
}

}  // namespace mbd
