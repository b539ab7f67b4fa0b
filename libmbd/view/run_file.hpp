// run.h5: all of a run in one HDF5 file, which h5py, pandas, MATLAB, Julia and h5dump read.
//
//   /                     attributes: format, model, file, mbd (its version), commit, date, run (results/history.hpp)
//   /history/COLUMN       [rows] the columns of history.csv (path.csv of a path) by their names and in their order;
//                         attributes: unit ("1" of pure numbers), label, and frame of what has axes
//   /motion/time          [frames] s, or /motion/load_factor
//   /motion/position      [frames, nodes, 3] m, inertial axes; nodes without the ground
//   /motion/quaternion    [frames, nodes, 4] unit quaternion (x, y, z, w), node to inertial axes
//   /motion/velocity, angular_velocity   [frames, nodes, 3] m/s, rad/s, node axes; with a <transient> only
//   /motion/force, moment [frames, points, 3] N (N Q2 Q3), N.m (M1 M2 M3) at quadrature points, section axes
//   /motion/joint_angle   [frames, joints] rad, 0 of those without one
//   /motion/joint_force, joint_moment    [frames, joints, 3] N, N.m on b, joint axes
//   /motion/nodes, joints what messages call them; /motion/points: the beam of each, points_s: the fraction of its length
//   /parameters           attributes: a number each
//   /model                attribute name; text, and include_1, …: the files it was read from, as they are
//   /drawing              JSON (drawing.hpp)
//   /report               bytes of report.json; none as long as the run goes on, or where it was killed
//
// Datasets without a row, such as those of joints where there are none, are left out. The file is written for SWMR: at any
// time, also while the run goes on and after a kill, it opens with h5py.File(…, swmr=True) and holds what is at most half a
// second older than the run; datasets may differ in length by what is being written, so the shortest counts. Chunks are
// shuffled, and compressed (deflate) where that saves a tenth. libhdf5 is loaded when the first such file is written, and
// not before.
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "libmbd/scene/scene.hpp"
#include "libmbd/view/motion.hpp"

namespace mbd {

class Hdf5File;

// Throws Error, which names the file, where such files cannot be written: built without libhdf5, or it cannot be loaded.
void require_hdf5(std::string_view file = "run.h5");

// What such a file says of where it comes from: the attributes above but `run`, /parameters and /model.
void add_origin(Hdf5File& file, std::string_view format, const Scene& scene);

// Shown to run() as one of its observers. The file is there from the first row on. Throws Error if the disk is full: the
// file then holds what was written before, and the run ends.
class RunFile : public MotionObserver {
 public:
  // Both must outlive it.
  RunFile(const std::filesystem::path& file, const Scene& scene, std::string run = {});
  ~RunFile() override;

  void accepted(const Sample& sample) override;
  void frame(std::span<const double> row) override;
  void finished(const RunReport& report) override;  // all is on disk then

  // With report.json.
  void close(std::string_view report);

 private:
  struct Content;
  std::filesystem::path file_;
  const Scene& scene_;
  std::string run_;
  std::unique_ptr<Content> content_;
};

}  // namespace mbd
