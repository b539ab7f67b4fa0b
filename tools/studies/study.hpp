// What the studies share: the kinds of beam that are compared, one static solution with what it cost, tables
// and pictures.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "libmbd/core/state.hpp"
#include "libmbd/pictures/plot.hpp"
#include "libmbd/scene/scene.hpp"

namespace mbd::studies {

// A curve of the convergence plots: how a beam is discretised.
struct Series {
  std::string form;  // panel it stands in
  std::string name;  // entry in the legend
  std::function<void(BeamScene&)> choose;
};

// Every series of the plots. A new kind of beam is one line in study.cpp; with an old `form` its curves stand
// beside those, with a new one in a panel of its own.
const std::vector<Series>& all_series();

std::string name_of(Rule rule);

// A scene in static equilibrium.
struct Solution {
  bool converged = false;
  double cpu = 0.0;  // [s] of solve_statics, the least of several solutions
  long iterations = 0;
  long load_steps = 0;
  State reference, state;  // node 0 is the ground, the last is the tip of the only beam
  Vec3 tip() const { return state.pose.back().r - reference.pose.back().r; }
};
// At least `repeats` times, and for .02 s.
Solution solve(const Scene& scene, int repeats = 1);

// Comma-separated values, numbers to 17 digits.
class Csv {
 public:
  explicit Csv(std::string comment_and_header) : text_(std::move(comment_and_header) + '\n') {}
  Csv& operator<<(const std::string& cell);
  Csv& operator<<(double value);
  Csv& operator<<(const std::optional<double>& value) {
    return value ? *this << *value : *this << "";
  }
  Csv& operator<<(long value) { return *this << std::to_string(value); }
  void end_row();
  const std::string& text() const { return text_; }

 private:
  std::string text_;
  bool first_ = true;
};

// Points of a plot, markers only.
void add_points(plot::Panel& panel, const std::string& label, int style,
                const std::vector<plot::Point>& points);

void write(const std::filesystem::path& directory, const std::string& name,
           const std::string& text);

// The studies: write their files into a directory.
void bend45(const std::filesystem::path& directory);
void locking(const std::filesystem::path& directory);
void dynamic(const std::filesystem::path& directory);
void time(const std::filesystem::path& directory);
struct ChosenOptions {
  double limit = 20.0;                                  // CPU time for choosing, each [s]
  std::vector<std::string> models;                      // names; none: all
  std::vector<double> accuracies = {1e-3, 1e-4, 1e-6};  // falling
};
void chosen(const std::filesystem::path& directory, const ChosenOptions& options);

}  // namespace mbd::studies
