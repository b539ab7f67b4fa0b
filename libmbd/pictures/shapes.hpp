// shapes.svg: beams as they are deformed at the start of a path, at its limit points, bifurcations and
// marks, and at the end, to one scale in both directions.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "libmbd/results/observers.hpp"

namespace mbd {

class ShapesPlot : public Observer {
 public:
  ShapesPlot(std::filesystem::path file, std::string title);

  void accepted(const Sample& sample) override;
  void finished(const RunReport& report) override;

 private:
  struct Shape {
    std::string label;
    std::vector<std::vector<Vec3>> lines;  // of each beam, inertial [m]
    std::vector<Vec3> bodies;
  };
  static Shape shape_of(const Sample& sample, std::string label);

  std::filesystem::path file_;
  std::string title_;
  std::vector<Shape> shapes_;
  std::array<int, 3> events_{};  // limit points, bifurcations and marks so far
  Shape last_;
  bool is_last_shown_ = false;  // as an event
};

}  // namespace mbd
