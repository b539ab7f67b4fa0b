// A run that chooses its own settings for an accuracy of its recorded quantities.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "libmbd/front/run.hpp"
#include "libmbd/study/accuracy.hpp"
#include "libmbd/study/setting.hpp"

namespace mbd {

struct ChooseOptions {
  double accuracy = 1e-3;  // largest rms error of the quantities, in the norm of Quantity
  std::vector<std::string> quantities;                    // names; none: all that the scene records
  double limit = 600.0;                                   // CPU time for choosing [s]
  std::function<void(const std::string& what)> progress;  // told before each pilot run
};

// One of the runs that led to the choice.
struct Pilot {
  Setting setting;
  std::string text;
  double cpu = 0.0;                      // [s]
  double error = 0.0;                    // believed, rms, worst quantity; 0: not known
  double in_time = 0.0, in_space = 0.0;  // its parts
  std::string failure;
};

struct Choice {
  Setting setting;        // to be run
  double accuracy = 0.0;  // requested
  double error = 0.0;     // believed of it
  std::string worst;      // the quantity of `error`
  bool met = false;       // error <= accuracy
  std::string reason;     // if not: why no better setting was taken
  std::vector<Pilot> pilots;
  std::vector<std::string> notes;
};

// Throws Error as run() does when the scene cannot be run at all.
Choice choose(const Scene& scene, const ChooseOptions& options);

}  // namespace mbd
