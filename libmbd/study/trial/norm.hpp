// How far two runs of a scene are apart, quantity by quantity: which columns are one vector, what its size is, and the
// distance of two of its values.
//
// Four things that a difference of numbers would get wrong: what is zero beside others of its unit is measured by
// those (the load that symmetry makes vanish), and total energies by the kinetic and strain energies too; what depends
// on where the origin is (positions, potentials, moments of momentum) may be measured by its changes; rotation
// vectors stand for the rotation, and of the vectors for one rotation the nearest is compared; on a branch of a path
// signs do not count: the two sides of a symmetric bifurcation are mirror images, and round-off chooses.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "libmbd/study/trial/trial.hpp"

namespace mbd {

// Columns of Findings that are one vector.
struct Components {
  std::string name;  // "C.displacement", "C.displacement.3"
  std::string unit;  // of the columns
  std::vector<std::size_t> columns;
};

// Adds the columns `names` (none: all) to `all`: those of one quantity together, or each by itself (`apart`). Throws
// Error, with `file` in it, for names that are not recorded.
void add_components(std::vector<Components>& all, const Findings& findings,
                    std::span<const std::string> names, const std::string& file,
                    bool apart = false);

// Of the vector, the Euclidean length.
double length(const Components& vector, const std::vector<double>& row);

// From row `i` of `a` to row `k` of `b`, in its unit.
double distance(const Components& vector, const Findings& a, std::size_t i, const Findings& b,
                std::size_t k);

struct Scale {
  double value = 1.0;    // not zero
  bool is_zero = false;  // it is that of others of its unit
};

// By the largest change from the first row of what depends on where the origin is (positions, potentials, moments of
// momentum), so that a scene may stand anywhere; or by its value, as all else.
enum class Measure { change, value };

// Of a vector the largest length in the first `places` rows (of a single row never a change). Where that is not above `zero`
// times the largest number that any column of its unit has there, that number; of energies it is at least Findings::energy, of
// angles, if all of them are round-off, one radian. 1 if all are zero.
Scale scale_of(const Components& vector, const Findings& findings, std::size_t places, double zero,
               Measure measure);

// Whether the column is a place, potential or momentum that is another in a scene that stands elsewhere.
bool depends_on_origin(std::string_view column);

// Whether any number changes from place to place, by more than round-off. Of a motion where none does, runs agree that
// may all have missed what should move it.
bool anything_changes(const Findings& findings);

}  // namespace mbd
