#include "tools/mbd/command_line.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <memory>
#include <new>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "libmbd/core/error.hpp"
#include "libmbd/core/stop.hpp"
#include "libmbd/language/manual.hpp"
#include "libmbd/results/build_facts.hpp"
#include "libmbd/results/report.hpp"
#include "libmbd/text/spelling.hpp"

namespace mbd {
namespace {

constexpr std::size_t width = 90, column = 26;

// Two columns, what it is and what it does, wrapped.
std::string row(std::string_view name, std::string_view meaning) {
  std::string text = "  " + std::string(name);
  text += text.size() + 2 > column ? "\n" + std::string(column, ' ')
                                   : std::string(column - text.size(), ' ');
  return text + manual::wrap(meaning, width, column) + "\n";
}

// "-o, --out DIR", or "MODEL".
std::string name_of(const CLI::Option& option) {
  std::string text;
  if (option.get_positional() && option.get_lnames().empty()) {
    text = option.get_name(true, false);
  } else {
    for (const std::string& name : option.get_snames()) text += (text.empty() ? "-" : ", -") + name;
    for (const std::string& name : option.get_lnames())
      text += (text.empty() ? "--" : ", --") + name;
    if (option.get_items_expected_max() != 0) text += " " + option.get_type_name();
  }
  return text;
}

std::string meaning_of(const CLI::Option& option) {
  std::string text = option.get_description();
  if (!option.get_default_str().empty()) text += "; default: " + option.get_default_str();
  return text;
}

class HelpFormatter : public CLI::Formatter {
 public:
  std::string make_help(const CLI::App* app, std::string name,
                        CLI::AppFormatMode /*mode*/) const override {
    std::string text =
        manual::wrap(app->get_description(), width) + "\n\n" + usage(*app, name) + "\n";
    std::string arguments, options, commands;
    for (const CLI::Option* option : app->get_options()) {
      const bool is_argument = option->get_positional() && option->get_lnames().empty();
      (is_argument ? arguments : options) += row(name_of(*option), meaning_of(*option));
    }
    for (const CLI::App* command : app->get_subcommands({}))
      commands += row(command->get_name(), command->get_description());
    if (!commands.empty()) text += "\nCommands:\n" + commands;
    if (!arguments.empty()) text += "\nArguments:\n" + arguments;
    if (!options.empty()) text += "\nOptions:\n" + options;
    if (const std::string footer = app->get_footer(); !footer.empty()) text += "\n" + footer + "\n";
    return text;
  }

 private:
  static std::string usage(const CLI::App& app, const std::string& name) {
    if (!app.get_subcommands({}).empty()) return "Usage: " + name + " COMMAND [OPTIONS] …";
    std::string text = "Usage: " + name + " [OPTIONS]";
    for (const CLI::Option* option : app.get_options()) {
      if (!option->get_positional() || !option->get_lnames().empty()) continue;
      std::string argument = option->get_name(true, false);
      if (option->get_expected_max() > 1) argument += "…";
      text += option->get_required() ? " " + argument : " [" + argument + "]";
    }
    return text;
  }
};

std::vector<std::string> options_of(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    for (const std::string& name : option->get_snames()) names.push_back("-" + name);
  }
  return names;
}

std::vector<std::string> commands_of(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  return names;
}

std::string suggestion(std::string_view word, const std::vector<std::string>& known,
                       const std::string& what) {
  const std::vector<std::string_view> views(known.begin(), known.end());
  return suggest(word, views, what);
}

// What is wrong with the arguments, and what would be right.
std::string misuse(const CLI::App& app, const CLI::App& command, const std::string& name,
                   const CLI::ParseError& error) {
  // The first option that is not known, or else the first word that has no place.
  std::string wrong;
  for (const std::string& word : app.remaining(true)) {
    if (word == "--") continue;
    const bool is_option = word.size() > 1 && word[0] == '-';
    if (wrong.empty() || (is_option && wrong[0] != '-')) wrong = word;
  }
  if (wrong.empty()) return error.what();
  if (wrong.size() > 1 && wrong[0] == '-') {
    const std::string option = wrong.substr(0, wrong.find('='));
    return fmt::format("unknown option {}{}", option,
                       suggestion(option, options_of(command), "options of " + name));
  }
  if (&command == &app)
    return fmt::format("unknown command \"{}\"{}", wrong,
                       suggestion(wrong, commands_of(app), "commands"));
  if (dynamic_cast<const CLI::ExtrasError*>(&error) == nullptr) return error.what();
  return fmt::format("the argument \"{}\" is one too many", wrong);
}

int answer(CLI::App& app, const CLI::ParseError& error) {
  if (error.get_exit_code() == 0) return app.exit(error);  // help and version
  const std::vector<CLI::App*> named = app.get_subcommands();
  const CLI::App& command = named.empty() ? app : *named.back();
  if (named.empty() && app.remaining(true).empty()) {  // nothing was asked for
    complain(app.help());
    return error.get_exit_code();
  }
  const std::string name =
      named.empty() ? app.get_name() : app.get_name() + " " + command.get_name();
  complain(fmt::format("{}: {}\nTry: {} --help\n", name, misuse(app, command, name, error), name));
  return error.get_exit_code();
}

std::string version_text() {
  std::string text = fmt::format("mbd {}\n", version());
  for (const auto& [name, value] : to_lines(build_facts()))
    text += fmt::format("{}: {}\n", name, value);
  text.pop_back();  // the line's end is added when it is printed
  return text;
}

}  // namespace

void secure_streams() {
  // A file that is opened next would take the place of a stream that is closed, and get what is meant for it.
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (fcntl(stream, F_GETFD) < 0) open("/dev/null", O_RDONLY);  // writing to it fails
#ifdef SIGXFSZ
  std::signal(SIGXFSZ, SIG_IGN);  // a file as large as may be is an error like a full disk
#endif
}

void set_up(CLI::App& app) {
  app.formatter(std::make_shared<HelpFormatter>());
  app.set_help_flag("-h,--help", "print this help");
  app.set_version_flag("--version", version_text, "print the version, and how this mbd was built");
  app.require_subcommand(1);
}

namespace {

// Equally named models of other directories have the same directory for results.
void refuse_results_of_another(const std::filesystem::path& results, const std::string& model) {
  std::ifstream stream(results / "report.json", std::ios::binary);
  const auto report = nlohmann::json::parse(stream, nullptr, false);
  if (!report.is_object()) return;
  const auto file = report.find("file");
  if (file == report.end() || !file->is_string()) return;
  const std::string other = file->get<std::string>();
  std::error_code code;
  if (!std::filesystem::exists(other, code) || !std::filesystem::exists(model, code) ||
      std::filesystem::equivalent(other, model, code))
    return;
  throw Error(fmt::format(
      "{}: holds results of {}, another model of the same name; name a directory with --out, or "
      "remove those results",
      results.string(), other));
}

}  // namespace

std::filesystem::path results_directory(const std::string& given, const std::string& model,
                                        std::string_view study) {
  if (!given.empty()) return given;
  const std::filesystem::path stem = std::filesystem::path(model).stem();
  if (stem.empty() || stem == "." || stem == "..")
    throw Error(model +
                ": its name without .xml is no name of a directory for results; name one "
                "with --out");
  const std::filesystem::path own = std::filesystem::path("results") / stem;
  refuse_results_of_another(own, model);
  return study.empty() ? own : own / study;
}

void set_examples(CLI::App& command, std::string_view examples, std::string_view exit_status) {
  std::string text = "Examples:\n";
  for (std::size_t at = 0; at < examples.size();) {
    const std::size_t end = std::min(examples.find('\n', at), examples.size());
    text += "  " + std::string(examples.substr(at, end - at)) + "\n";
    at = end + 1;
  }
  command.footer(text + "\n" + std::string(exit_status));
}

void keep_memory_for_the_end() {
  constexpr std::size_t size =
      2 << 20;  // not touched, so it costs no memory as long as there is some
  static std::atomic<void*> kept = std::malloc(size);
  std::set_new_handler([] {
    void* const mine = kept.exchange(nullptr);
    if (mine == nullptr) throw std::bad_alloc();
    std::free(mine);
    stop::memory_is_low = true;
  });
}

int say_no_memory() {
  std::fputs("mbd: out of memory; take a smaller model, fewer rows, or more memory\n", stderr);
  return 1;
}

int run_command_line(CLI::App& app, int argc, char** argv, const int& status) {
  int result = 0;
  try {
    app.parse(argc, argv);
    result = status;
  } catch (const CLI::ParseError& error) {
    result = answer(app, error);
  } catch (const std::bad_alloc&) {
    result = say_no_memory();
  } catch (const std::exception& error) {
    complain(fmt::format("mbd: {}\n", error.what()));
    result = 1;
  }
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
    complain("mbd: what was printed could not be written in full; is the disk full?\n");
    if (result == 0) result = 1;
  }
  return result;
}

std::string given(std::string_view option, const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words)
    text +=
        fmt::format(" {} {}", option,
                    word.find_first_of(" \t'\"") == std::string::npos ? word : "\"" + word + "\"");
  return text;
}

void complain(const std::string& text) {
  std::fputs(text.c_str(), stderr);  // where that fails, nobody can be told
  std::fflush(stderr);
}

void show_progress(const std::string& text) { complain(fmt::format("\r\033[K{}", text)); }

}  // namespace mbd
