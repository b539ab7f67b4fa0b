// What is asked of stresses over sections of a run, the same in `mbd view` and `mbd export`.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "libmbd/view/section_stresses.hpp"

namespace mbd {

struct StressOptions {
  bool asked = false;
  std::string model;  // that was run; empty: the file that the motion names
};

// --stresses, which does what `says` says, and --model.
void add_stress_options(CLI::App& command, StressOptions& options, const std::string& says);

// Before anything is read. Throw Error for --model without --stresses, and for --stresses of what is a model.
void check_model_has_use(const StressOptions& options);
void check_no_stresses_of_model(const StressOptions& options);

// Throws Error, with what to do, where no beam of the run has any, and where the model is not the one that was run.
// `set`: what was set in it then.
StressesOfBeams stresses_of_beams(const StressOptions& options, const std::vector<std::string>& set,
                                  const Motion& motion);
StressesOfOutlines stresses_of_outlines(const StressOptions& options,
                                        const std::vector<std::string>& set, const Motion& motion);

}  // namespace mbd
