#include "tools/mbd/completion_command.hpp"

#include <fmt/format.h>

#include <memory>
#include <string>
#include <vector>

#include "libmbd/language/schema.hpp"
#include "tools/mbd/command_line.hpp"

namespace mbd {
namespace {

// What a shell offers for an argument or the value of an option.
struct Offer {
  enum class Kind { nothing, models, files, directories, words } kind = Kind::nothing;
  std::string words = {};  // separated by blanks
};

// The type of an option, or the name of an argument, says what it is (see set_up).
Offer offer_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t open = type.find('{');
  if (open != std::string::npos && type.back() == '}') {
    std::string words = type.substr(open + 1, type.size() - open - 2);
    for (char& c : words)
      if (c == ',') c = ' ';
    return {Offer::Kind::words, words};
  }
  const bool is_argument = option.get_positional() && option.get_lnames().empty();
  const std::string name = is_argument ? option.get_name(true, false) : type;
  if (name.starts_with("MODEL")) return {Offer::Kind::models};
  if (name.starts_with("FILE")) return {Offer::Kind::files};
  if (name.starts_with("DIR")) return {Offer::Kind::directories};
  if (name != "ELEMENT") return {};
  Offer offer{Offer::Kind::words};
  for (const schema::Element& element : schema::elements())
    offer.words += (offer.words.empty() ? "" : " ") + std::string(element.name);
  return offer;
}

struct OptionWords {
  std::vector<std::string> names;  // with hyphens: -o --out
  bool has_value, repeatable;
  Offer offer;
  std::string doc;
};

struct Argument {
  std::string name;
  bool repeatable;
  Offer offer;
};

struct Words {
  std::string name, doc;  // of the command
  std::vector<OptionWords> options;
  std::vector<Argument> arguments;
};

Words words_of(const CLI::App& app) {
  Words words{app.get_name(), app.get_description(), {}, {}};
  for (const CLI::Option* option : app.get_options()) {
    const bool repeatable = option->get_expected_max() > 1;
    if (option->get_positional() && option->get_lnames().empty()) {
      words.arguments.push_back({option->get_name(true, false), repeatable, offer_of(*option)});
      continue;
    }
    OptionWords one{
        {}, option->get_items_expected_max() != 0, repeatable, {}, option->get_description()};
    for (const std::string& name : option->get_snames()) one.names.push_back("-" + name);
    for (const std::string& name : option->get_lnames()) one.names.push_back("--" + name);
    if (one.has_value) one.offer = offer_of(*option);
    words.options.push_back(std::move(one));
  }
  return words;
}

std::vector<Words> words_of_commands(const CLI::App& app) {
  std::vector<Words> all;
  for (const CLI::App* command : app.get_subcommands({})) all.push_back(words_of(*command));
  return all;
}

std::string joined(const std::vector<std::string>& words, std::string_view between) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : std::string(between)) + word;
  return text;
}

// In single quotes, for any of the three shells; characters of `special` get a backslash.
std::string in_quotes(std::string_view text, std::string_view special = "") {
  std::string result = "'";
  for (const char c : text) {
    if (special.find(c) != std::string_view::npos) result += '\\';
    if (c == '\'')
      result += "'\\''";
    else
      result += c;
  }
  return result + "'";
}

// ---- bash -------------------------------------------------------------------------------------

std::string bash_offer(const Offer& offer) {
  switch (offer.kind) {
    case Offer::Kind::nothing:
      return "kind=nothing";
    case Offer::Kind::models:
      return "kind=models";
    case Offer::Kind::files:
      return "kind=files";
    case Offer::Kind::directories:
      return "kind=directories";
    case Offer::Kind::words:
      return "kind=words words=" + in_quotes(offer.words);
  }
  return {};
}

// The branch of one command: the options it has, and what to offer for the value of each and for the
// argument at $position.
std::string bash_branch(const Words& command) {
  std::string options, values, arguments;
  for (const OptionWords& option : command.options) {
    options += (options.empty() ? "" : " ") + joined(option.names, " ");
    if (option.has_value)
      values +=
          fmt::format("        {}) {} ;;\n", joined(option.names, "|"), bash_offer(option.offer));
  }
  int position = 0;
  for (const Argument& argument : command.arguments)
    arguments +=
        fmt::format("          {}) {} ;;\n", argument.repeatable ? "*" : std::to_string(position++),
                    bash_offer(argument.offer));
  std::string text =
      fmt::format("    {})\n      options={}\n", in_quotes(command.name), in_quotes(options));
  text += "      case \"$option\" in\n" + values;
  text += "        *) case $position in\n" + arguments + "        esac ;;\n      esac ;;\n";
  return text;
}

constexpr std::string_view bash_begin =
    "# Completion of mbd in bash. For now:  source <(mbd completion bash)\n"
    "# For good: put that line into ~/.bashrc, or this text into\n"
    "# ~/.local/share/bash-completion/completions/mbd\n"
    "_mbd() {\n"
    "  local current=\"${COMP_WORDS[COMP_CWORD]}\" command='' option='' position=0 i=1\n"
    "  local options='' kind=nothing words=''\n"
    "  COMPREPLY=()\n"
    "  # What stands before: the command, how many arguments, an option whose value comes now. "
    "Bash\n"
    "  # makes three words of a=b.\n"
    "  while ((i < COMP_CWORD)); do\n"
    "    option=''\n"
    "    case \"$command ${COMP_WORDS[i]}\" in\n";
constexpr std::string_view bash_of_values =
    "        option=\"${COMP_WORDS[i]}\"\n"
    "        [[ ${COMP_WORDS[i + 1]} == = ]] && ((++i))\n"
    "        ((++i < COMP_CWORD)) && option=''\n"
    "        while [[ ${COMP_WORDS[i + 1]} == = ]]; do ((i += 2)); done\n"
    "        ((i >= COMP_CWORD)) && [[ -z $option ]] && return 0 ;;\n"
    "      *' '-*) ;;\n"
    "      ' '*) command=\"${COMP_WORDS[i]}\" ;;\n"
    "      *) ((++position)) ;;\n"
    "    esac\n"
    "    ((++i))\n"
    "  done\n"
    "  [[ $current == = ]] && current=''\n"
    "  case \"$command\" in\n";
constexpr std::string_view bash_end =
    "  if [[ -z $option && $current == -* ]]; then kind=words words=\"$options\"; fi\n"
    "  case $kind in\n"
    "    models)\n"
    "      compopt -o filenames 2>/dev/null\n"
    "      mapfile -t COMPREPLY < <(compgen -f -X '!*.xml' -- \"$current\"; compgen -d -- "
    "\"$current\") ;;\n"
    "    files)\n"
    "      compopt -o filenames 2>/dev/null\n"
    "      mapfile -t COMPREPLY < <(compgen -f -- \"$current\") ;;\n"
    "    directories)\n"
    "      compopt -o filenames 2>/dev/null\n"
    "      mapfile -t COMPREPLY < <(compgen -d -- \"$current\") ;;\n"
    "    words) mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$current\") ;;\n"
    "  esac\n"
    "  return 0\n"
    "}\n"
    "complete -F _mbd mbd\n";

std::string bash_script(const CLI::App& app) {
  const std::vector<Words> commands = words_of_commands(app);
  std::vector<std::string> names, with_value;
  std::string branches;
  for (const Words& command : commands) {
    names.push_back(command.name);
    branches += bash_branch(command);
    for (const OptionWords& option : command.options)
      if (option.has_value)
        for (const std::string& name : option.names)
          with_value.push_back(in_quotes(command.name + " " + name));
  }
  Words top = words_of(app);
  top.name.clear();
  top.arguments = {{"COMMAND", false, {Offer::Kind::words, joined(names, " ")}}};

  std::string text(bash_begin);
  text += fmt::format("      {})\n", with_value.empty() ? "''" : joined(with_value, "|"));
  text += bash_of_values;
  text += bash_branch(top) + branches + "  esac\n";
  text += bash_end;
  return text;
}

// ---- zsh --------------------------------------------------------------------------------------

std::string zsh_action(const Offer& offer) {
  switch (offer.kind) {
    case Offer::Kind::nothing:
      return " ";
    case Offer::Kind::models:
      return "_files -g \"*.xml\"";
    case Offer::Kind::files:
      return "_files";
    case Offer::Kind::directories:
      return "_files -/";
    case Offer::Kind::words:
      return "(" + offer.words + ")";
  }
  return {};
}

// Arguments of _arguments: one a line.
std::string zsh_arguments(const Words& words, std::string_view indent) {
  const auto special = std::string_view(":[]\\");
  std::string text;
  for (const OptionWords& option : words.options) {
    std::string rest = "[" + in_quotes(option.doc, special).substr(1);
    rest.pop_back();
    rest += "]";
    if (option.has_value) rest += ":value:" + zsh_action(option.offer);
    // Excluded by itself under any of its names, or allowed again.
    const std::string before = option.repeatable ? "*" : "(" + joined(option.names, " ") + ")";
    const std::string names =
        option.names.size() > 1 ? "{" + joined(option.names, ",") + "}" : option.names.front();
    text += fmt::format(" \\\n{}'{}'{}'{}'", indent, before, names, rest);
  }
  int position = 1;
  for (const Argument& argument : words.arguments)
    text += fmt::format(" \\\n{}'{}:{}:{}'", indent,
                        argument.repeatable ? "*" : std::to_string(position++), argument.name,
                        zsh_action(argument.offer));
  return text;
}

std::string zsh_script(const CLI::App& app) {
  std::string text =
      "#compdef mbd\n"
      "# Completion of mbd in zsh. For now:  source <(mbd completion zsh)\n"
      "# For good: put this text into a file _mbd in a directory of $fpath.\n"
      "_mbd() {\n"
      "  local curcontext=\"$curcontext\" state line\n"
      "  local -a commands\n"
      "  commands=(\n";
  const std::vector<Words> commands = words_of_commands(app);
  for (const Words& command : commands)
    text += fmt::format("    {}\n", in_quotes(command.name + ":" + command.doc));
  text += "  )\n  _arguments -C" + zsh_arguments(words_of(app), "    ") +
          " \\\n    '1:command:->command' '*::argument:->argument'\n"
          "  case $state in\n"
          "    command) _describe command commands ;;\n"
          "    argument)\n"
          "      case $words[1] in\n";
  for (const Words& command : commands)
    text += fmt::format("        {}) _arguments{} ;;\n", command.name,
                        zsh_arguments(command, "          "));
  return text +
         "      esac ;;\n"
         "  esac\n"
         "}\n"
         "if [[ $funcstack[1] == _mbd ]]; then _mbd \"$@\"; else compdef _mbd mbd; fi\n";
}

// ---- fish -------------------------------------------------------------------------------------

std::string fish_offer(const Offer& offer) {
  switch (offer.kind) {
    case Offer::Kind::nothing:
      return "";
    case Offer::Kind::models:
      return " -k -a '(__fish_complete_suffix .xml)'";
    case Offer::Kind::files:
      return " -F";
    case Offer::Kind::directories:
      return " -a '(__fish_complete_directories)'";
    case Offer::Kind::words:
      return " -a " + in_quotes(offer.words);
  }
  return {};
}

std::string fish_lines(const Words& words, const std::string& when) {
  std::string text;
  for (const OptionWords& option : words.options) {
    text += fmt::format("complete -c mbd -n {}", in_quotes(when));
    for (const std::string& name : option.names)
      text += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
    if (option.has_value)
      text += (option.offer.kind == Offer::Kind::files ? " -r" : " -x") + fish_offer(option.offer);
    text += " -d " + in_quotes(option.doc, "\\") + "\n";
  }
  for (const Argument& argument : words.arguments)
    if (argument.offer.kind != Offer::Kind::nothing)
      text += fmt::format("complete -c mbd -n {}{}\n", in_quotes(when), fish_offer(argument.offer));
  return text;
}

std::string fish_script(const CLI::App& app) {
  std::string text =
      "# Completion of mbd in fish. For now:  mbd completion fish | source\n"
      "# For good: mbd completion fish > ~/.config/fish/completions/mbd.fish\n"
      "complete -c mbd -f\n";
  const std::string none_yet = "__fish_use_subcommand";
  text += fish_lines(words_of(app), none_yet);
  for (const Words& command : words_of_commands(app)) {
    text += fmt::format("complete -c mbd -n {} -a {} -d {}\n", in_quotes(none_yet),
                        in_quotes(command.name), in_quotes(command.doc, "\\"));
    text += fish_lines(command, "__fish_seen_subcommand_from " + command.name);
  }
  return text;
}

}  // namespace

void add_completion_command(CLI::App& app, int& status) {
  const auto shell = std::make_shared<std::string>();
  CLI::App* const command = app.add_subcommand(
      "completion", "Prints a script that makes a shell complete mbd's arguments.");
  command->add_option("SHELL", *shell, "bash, zsh or fish")
      ->required()
      ->check(CLI::IsMember(std::vector<std::string>{"bash", "zsh", "fish"}));
  set_examples(
      *command,
      "source <(mbd completion bash)       # in ~/.bashrc; zsh: in ~/.zshrc, after compinit\n"
      "mbd completion fish > ~/.config/fish/completions/mbd.fish");
  command->callback([shell, &app, &status] {
    fmt::print("{}", *shell == "bash"  ? bash_script(app)
                     : *shell == "zsh" ? zsh_script(app)
                                       : fish_script(app));
    status = 0;
  });
}

}  // namespace mbd
