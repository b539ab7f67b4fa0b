// What the command line changes of a model: parameters, before it is read, and how it is integrated, after.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "libmbd/language/reader.hpp"

namespace mbd {

// --set NAME=VALUE, as often as wanted.
void add_set_option(CLI::App& command, std::vector<std::string>& set);

// --plugin FILE, as often as wanted.
void add_plugin_option(CLI::App& command, std::vector<std::string>& plugins);

// A model with what these options say. Throws Error for files that are no plug-ins, or not for this model.
Scene read_model(const std::string& file, const Overrides& overrides,
                 const std::vector<std::string>& plugins);

// --without EFFECT, as often as wanted: keys of without() (libmbd/study/effects/ablation.hpp).
void add_without_option(CLI::App& command, std::vector<std::string>& without);

// Throws Error for what is not name=value.
Overrides to_overrides(const std::vector<std::string>& set);

// Those, and more after them: of a parameter given twice the later holds.
Overrides with(Overrides overrides, const Overrides& more);

// The value of an option that is an expression of the model's parameters, in `unit` (SI) or with one of its own. Throws
// Error that names the option.
double option_value(std::string_view name, const std::string& text, std::string_view unit,
                    const Scene& scene);

// As given; empty: not given. Numbers are expressions of the model's parameters, with a unit of time (but the
// tolerance).
struct TransientOptions {
  std::string method, step, tolerance, output, stages = {};
};
void add_transient_options(CLI::App& command, TransientOptions& options);

// Changes the <transient> of a scene, and leaves out what does not go with it then. Returns what a report should
// say of that. Throws Error for a scene without <transient>, and for values that its attributes do not allow.
std::vector<std::string> apply(const TransientOptions& options, Scene& scene);

// For CLI::Option::check: an empty argument is said to be one.
std::string not_empty(const std::string& text);

}  // namespace mbd
