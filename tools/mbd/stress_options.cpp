#include "tools/mbd/stress_options.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "libmbd/language/reader.hpp"
#include "tools/mbd/command_line.hpp"
#include "tools/mbd/overrides.hpp"

namespace mbd {
namespace {

// Of the model, by `of`.
template <class Of>
auto by_the_model(const StressOptions& options, const std::vector<std::string>& set,
                  const Motion& motion, Of of) {
  if (!has_section_stresses(motion))
    throw Error(
        "--stresses: no beam of this run has resultants and one section by material and shape");
  try {
    const auto file =
        options.model.empty()
            ? nlohmann::json::parse(motion.head).at("drawing").at("file").get<std::string>()
            : options.model;
    return of(read_model(file, to_overrides(set)), motion);
  } catch (const Error& error) {
    throw Error(
        fmt::format("--stresses: {} (--model FILE names the model that was run, --set what "
                    "was set then)",
                    error.what()));
  }
}

}  // namespace

void add_stress_options(CLI::App& command, StressOptions& options, const std::string& says) {
  command.add_flag("--stresses", options.asked, says);
  command
      .add_option("--model", options.model,
                  "with --stresses: the model that was run; default: the file it was read from")
      ->check(not_empty, "", "")
      ->type_name("FILE");
}

void check_model_has_use(const StressOptions& options) {
  if (!options.asked && !options.model.empty())
    throw Error("--model " + options.model + ": it is for --stresses; give that too");
}

void check_no_stresses_of_model(const StressOptions& options) {
  if (options.asked || !options.model.empty())
    throw Error(
        "--stresses: a model has none; run it with --motion and name the directory of its "
        "results");
}

StressesOfBeams stresses_of_beams(const StressOptions& options, const std::vector<std::string>& set,
                                  const Motion& motion) {
  return by_the_model(options, set, motion, [](const Scene& model, const Motion& of) {
    return stresses_of_beams(model, of);
  });
}

StressesOfOutlines stresses_of_outlines(const StressOptions& options,
                                        const std::vector<std::string>& set, const Motion& motion) {
  return by_the_model(options, set, motion, [](const Scene& model, const Motion& of) {
    return stresses_of_outlines(model, of);
  });
}

}  // namespace mbd
