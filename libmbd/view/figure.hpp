// What is to be seen at an instant, in space: faces, lines, arrows and points, with their colours. Pictures (picture.hpp)
// project it. It shows the parts of a drawing (drawing.hpp) as the page does: beams as cubics between nodes, their
// sections swept along them.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "libmbd/core/se3.hpp"
#include "libmbd/view/motion.hpp"

namespace mbd {

struct Colour {
  double r = 0.0, g = 0.0, b = 0.0;  // 0 to 1
};
std::string code_of(const Colour& colour);  // #rrggbb

// Positions [m] are from the drawing's centre, along inertial axes.
struct Figure {
  struct Face {  // convex and flat, counter-clockwise as seen from outside
    std::size_t first = 0;
    int count = 0;
    int part = 0;  // its index in the drawing
    Colour colour{};
    double opacity = 1.0;
    bool two_sided = false;  // of a mesh that need not be closed
  };
  struct Line {
    Vec3 a, b;
    double width = 1.0;  // [pixels]
    int part = -1;       // of none
    Colour colour{};
    bool behind = false;  // all else
  };
  struct Arrow {  // in front of all else
    Vec3 tail, tip;
    int heads = 1, part = 0;
    Colour colour{};
  };
  struct Trail {  // of a point, in front of all else
    std::vector<Vec3> points;
    Vec3 now;
    int part = 0;
    Colour colour{};
  };
  std::vector<Vec3> points;
  std::vector<Face> faces;
  std::vector<Line> lines;
  std::vector<Arrow> arrows;
  std::vector<Trail> trails;
};

struct FigureOptions {
  std::string colour =
      {};  // a quantity by which beams are coloured, one of quantities(); plain if empty
  double scale = 1.0;   // of displacements and rotations from the reference configuration
  bool trails = false;  // of records of places and of bodies, up to the instant
  int round = 24;       // sides of what is round
  int pieces = 4;       // of a curve between two nodes
};

// The parts of a drawing, to be set to instants. An instant is a number of a frame, from 0 to frames() - 1; between two
// frames positions are linear and rotations the normalised mean of quaternions.
class Stage {
 public:
  // Of a model, which has one frame. Throws Error where `options` ask for what it has not.
  Stage(std::string_view drawing, const FigureOptions& options);
  // Of a motion. Throws Error too where its file is not to be read.
  Stage(const Motion& motion, const FigureOptions& options);
  ~Stage();
  Stage(Stage&&) noexcept;

  std::size_t frames() const;
  const std::vector<double>& keys() const;  // time [s] or load_factor of the frames
  bool is_time() const;
  // The first instant with this key. Throws Error if there is none.
  double instant(double key) const;
  double key(double instant) const;

  Figure figure(double instant) const;

  const std::string& name() const;
  std::string part_name(int part) const;
  double size() const;                 // of the model [m]
  Vec3 centre() const;                 // [m], inertial axes
  Vec3 up() const;                     // an axis: against gravity, or the third
  std::array<Vec3, 2> bounds() const;  // of all frames, from the centre [m]
  const std::vector<Vec3>& outline()
      const;  // points about all that is drawn in them, from the centre [m]
  struct Legend {
    std::string title;  // with unit
    double low = 0.0, high = 0.0;
  };
  const Legend* legend() const;  // nullptr: beams are plain
  static Colour shade(double share);

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

// Names of quantities: displacement, velocity, N, Q, T, M, energy.
std::vector<std::string> picture_quantities();

}  // namespace mbd
