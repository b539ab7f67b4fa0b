// motion.bin: the motion of a run, frame by frame.
//
// The first line is JSON, filled with blanks to a multiple of 8 bytes; then come rows of equal length, of double
// precision, the least byte first. The JSON says what a row holds ("blocks", in their order; n numbers each) and what is
// drawn of it (drawing.hpp), and which run it is of ("run", results/history.hpp):
//   key        1       time [s], or load_factor
//   pose       7 n     of each node but the ground: position [m], unit quaternion (x, y, z, w), to inertial axes
//   twist      6 n     of each node but the ground: velocity [m/s], angular velocity [rad/s], node axes; with a
//                      <transient> only
//   resultant  6 m     at each quadrature point of each flexible beam: N Q2 Q3 [N] M1 M2 M3 [N.m], section axes
//   joint      7 j     of each joint with multipliers: its angle [rad] (0 of those without one), and the force [N]
//                      and moment [N.m] on b, joint axes
// What is on disk is a valid file at any time, at most half a second and 1 MB behind the run; a last row that a killed
// program left in part is not read.
#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "libmbd/compile/model.hpp"
#include "libmbd/results/observers.hpp"
#include "libmbd/text/files.hpp"

namespace mbd {

// How many numbers each block of a row has.
struct MotionBlocks {
  std::size_t key = 1, pose = 0, twist = 0, resultant = 0, joint = 0;

  std::size_t size() const { return key + pose + twist + resultant + joint; }
};

// Those of a model.
MotionBlocks motion_blocks(const Model& model);

// A row of a state. `row` has motion_blocks(model).size() numbers.
void motion_row(const Model& model, const State& state, std::span<double> row);

// An observer of a run that is shown its frames of motion too: motion_row() of what <motion_output> keeps.
class MotionObserver : public Observer {
 public:
  virtual void frame(std::span<const double> row) = 0;
};

class MotionWriter {
 public:
  // `drawing`: JSON (drawing.hpp). Throws Error if the file cannot be written.
  MotionWriter(const std::filesystem::path& file, std::string_view drawing,
               const MotionBlocks& blocks, const std::string& run = {});
  ~MotionWriter();  // writes what it was given, also where a run ends by an exception
  MotionWriter(const MotionWriter&) = delete;
  MotionWriter& operator=(const MotionWriter&) = delete;

  // A motion_row(). Throws Error if the disk is full; the file then holds the rows before.
  void write(std::span<const double> row);
  void close();

 private:
  void flush();

  AppendedFile file_;
  std::vector<double> rows_;  // not written yet
  std::chrono::steady_clock::time_point flushed_;
};

// A file read back.
struct Motion {
  std::filesystem::path file;
  std::string head;  // the JSON of its first line
  std::string run;   // which run it is of (results/history.hpp)
  MotionBlocks blocks;
  std::size_t rows = 0;
};

// Its head; rows are read by read_motion_rows(). Throws Error for a file that cannot be read, is none of these, or
// holds no row.
Motion read_motion(const std::filesystem::path& file);

// Those rows, one after the other: of each its blocks.size() numbers.
std::vector<double> read_motion_rows(const Motion& motion, std::span<const std::size_t> rows);

// The first number of each row, without the others.
std::vector<double> read_motion_keys(const Motion& motion);

// Row a, moved towards row b by the share u: numbers are linear, quaternions the normalised mean of the two, the shorter
// way round.
void blend_rows(std::vector<double>& a, const std::vector<double>& b, double u,
                const MotionBlocks& blocks);

// Of `all` rows `count` (or all, if they are fewer), evenly, with the first and the last; of one, the last.
std::vector<std::size_t> evenly_chosen(std::size_t all, std::size_t count);

}  // namespace mbd
