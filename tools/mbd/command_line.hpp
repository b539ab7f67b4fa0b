// What all commands of mbd have in common: how help looks, what wrong use is answered, exit statuses.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace mbd {

// What every command's help ends with.
inline constexpr std::string_view exit_status_text =
    "Exit status: 0 all went well; 1 an error, or the run failed; 2 not the numbers that the\n"
    "model expects; 100 and more: wrong use of the command.";

// Writes a message to standard error. Where that is closed or full nobody can be told, and that is no error.
void complain(const std::string& text);

// To be called first: closed standard streams stay closed when files are opened, and a file that may not grow further
// is an error where it is written, not a signal.
void secure_streams();

// Gives the app its help and its version. To be called before commands are added, which take over how help
// looks. The types of arguments tell the help and shell completion what they are: MODEL a model
// file, FILE any file, DIR… a directory, ELEMENT an element of models, and CLI::IsMember its choices.
void set_up(CLI::App& app);

// Sets what stands below the options in a command's help: examples, one a line, and exit statuses.
void set_examples(CLI::App& command, std::string_view examples,
                  std::string_view exit_status = exit_status_text);

// The directory of --out, or, where it is empty, results/, the name of the model file without .xml, and in it `study`.
std::filesystem::path results_directory(const std::string& given, const std::string& model,
                                        std::string_view study = {});

// To be called once, at the beginning. Keeps some memory for the end: the first allocation that fails gets it, and what runs then
// ends at once (stop::memory_is_low), with rows and report in order. Without it, code that must not throw and yet asks for
// memory, destructors of JSON among it, would abort the program.
void keep_memory_for_the_end();

// "Out of memory", said without asking for any; returns the exit status.
int say_no_memory();

// Parses the arguments and so runs the command they name. Returns the exit status: that of the command
// (`status`); 1 if it threw, or if what it printed could not be written; 100 and more for wrong use, which is
// answered with the nearest command or option.
int run_command_line(CLI::App& app, int argc, char** argv, const int& status);

// " --set a=1 --set b=2": an option as often as it was given, as a shell reads it; words with blanks or quotes in quotes.
std::string given(std::string_view option, const std::vector<std::string>& words);

// Overwrites the line on a terminal that says what a study is doing.
void show_progress(const std::string& text);

}  // namespace mbd
