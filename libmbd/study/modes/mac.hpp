// How alike mode shapes are: the modal assurance criterion (Allemang and Brown 1982), weighted by mass,
//   MAC(a, b) = |a^H M b|^2 / ((a^H M a) (b^H M b))                                                     (1)
// 1: the same motion but for a factor, 0: none in common. M makes one sum of displacements and rotations, of nodes that stand
// as closely as one likes, so that (1) depends neither on units nor on the mesh; and modes of what neither damps nor
// turns are orthogonal in it: their table is the identity. Shapes that damp or turn need not be orthogonal.
//
// Of an eigenvalue that is there several times any basis of its shapes is as good, and (1) of one of them says nothing. Modes are
// taken together in groups of one eigenvalue, and groups G, H compared by the principal angles t between their spans
// (Bjoerck and Golub 1973), in the same scalar product:
//   S(G, H) = sum of cos^2 t / the smaller dimension,                                                  (2)
// which is (1) of single modes, and 1 where one span holds the other.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace mbd {

// Modes as they can be compared with others: shapes of nodes of these names.
struct ShapesOfModes {
  std::string model, file;
  std::vector<std::string> nodes;
  std::vector<Eigen::Vector3d> positions;         // of the nodes, in what the motions are about [m]
  std::vector<std::string> names;                 // of the modes; so below
  std::vector<std::complex<double>> eigenvalues;  // [1/s]
  std::vector<double> frequencies;                // [Hz]
  std::vector<double> round_off;                  // as Mode::round_off
  Eigen::MatrixXcd
      shapes;  // displacements [m] and rotations [rad] of one node after the other, inertial axes; a column a mode
};

// From modes.json, or from that of a directory. Throws Error, with the file, for one that cannot be read or is none.
ShapesOfModes read_modes(const std::filesystem::path& file);

struct MacTable {
  struct Side {
    std::string model, file;
    std::vector<std::string> names;
    std::vector<double> frequencies;               // [Hz]
    std::vector<std::vector<std::size_t>> groups;  // modes of one eigenvalue, in order
  };
  struct Pair {
    std::size_t group = 0, other = 0;  // of the two sides
    double alike = 0.0;                // (2)
  };

  bool among_themselves = true;  // both sides are the same modes
  Side modes, others;
  Eigen::MatrixXd mac;     // (1): modes by others; not a number where a shape moves no mass
  Eigen::MatrixXd groups;  // (2), of groups; the same
  // Of each group all of the others that are alike by half or more, the most alike first.
  std::vector<Pair> pairs;
  std::vector<std::string> notes;
};

std::string numbers_of(const std::vector<std::size_t>& group);  // "1, 2": counted from 1

// M times shapes, both in inertial axes.
using Weigh = std::function<Eigen::MatrixXcd(const Eigen::MatrixXcd&)>;

// Modes among themselves.
MacTable mac_table(const ShapesOfModes& modes, const Weigh& weigh);
// With others, at the nodes of the same names, weighted by the mass of `modes` there. Throws Error if there are none.
MacTable mac_table(const ShapesOfModes& modes, const Weigh& weigh, const ShapesOfModes& others);

std::string to_text(const MacTable& table);
// One row a mode and another: (1), (2) of their groups, frequencies [Hz].
std::string to_csv(const MacTable& table);
std::string to_json(const MacTable& table);

}  // namespace mbd
