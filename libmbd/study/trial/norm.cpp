#include "libmbd/study/trial/norm.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "libmbd/language/quantities.hpp"
#include "libmbd/results/history.hpp"

namespace mbd {
namespace {

constexpr double zero_angle = 1e-8;  // [rad]

bool is_rotation(const Components& vector) {
  return vector.columns.size() == 3 && vector.name.ends_with(".rotation");
}

// The same rotation the other way round, and a turn further. Of an angle of round-off the axis is round-off too, but
// then the other one is far from zero, if they are not near anyhow.
double to_turned(const Vec3& a, const Vec3& b) {
  double least = (a - b).norm();
  const double angle = a.norm();
  if (angle > 0.0)
    for (const double turn : {-2.0, 2.0})
      least = std::min(least, (a * (1.0 + turn * std::numbers::pi / angle) - b).norm());
  return least;
}

bool on_branch(const Findings& findings, std::size_t row) {
  return row < findings.branch.size() && findings.branch[row] != 0;
}

}  // namespace

bool depends_on_origin(std::string_view column) {
  std::string_view name = quantity_of(column);
  name.remove_prefix(name.rfind('.') + 1);
  using schema::Quantity;
  const Quantity* quantity = schema::find_quantity(schema::place_quantities(), name);
  if (!quantity) quantity = schema::find_quantity(schema::system_quantities(), name);
  return quantity && (quantity->moved == Quantity::Moved::as_point ||
                      quantity->moved == Quantity::Moved::as_potential ||
                      quantity->moved == Quantity::Moved::as_momentum);
}

void add_components(std::vector<Components>& all, const Findings& findings,
                    std::span<const std::string> names, const std::string& file, bool apart) {
  History history;  // for its names of columns
  history.file = file;
  history.columns.push_back({"", ""});
  for (std::size_t c = 0; c < findings.columns.size(); ++c)
    history.columns.push_back({findings.columns[c], findings.units[c]});
  for (const std::size_t column : choose_columns(history, names)) {
    const std::string& full = findings.columns[column - 1];
    const std::string name(apart ? std::string_view(full) : quantity_of(full));
    auto found =
        std::find_if(all.begin(), all.end(), [&](const Components& c) { return c.name == name; });
    if (found == all.end()) {
      all.push_back({name, findings.units[column - 1], {}});
      found = all.end() - 1;
    }
    if (std::find(found->columns.begin(), found->columns.end(), column - 1) == found->columns.end())
      found->columns.push_back(column - 1);
  }
}

double length(const Components& vector, const std::vector<double>& row) {
  double sum = 0.0;
  for (const std::size_t c : vector.columns) sum += row[c] * row[c];
  return std::sqrt(sum);
}

double distance(const Components& vector, const Findings& a, std::size_t i, const Findings& b,
                std::size_t k) {
  const bool mirrored = on_branch(a, i) && on_branch(b, k);
  const auto value = [&](const std::vector<double>& row, std::size_t c) {
    return mirrored ? std::abs(row[c]) : row[c];
  };
  if (is_rotation(vector)) {
    const auto rotation = [&](const std::vector<double>& row) {
      return Vec3(value(row, vector.columns[0]), value(row, vector.columns[1]),
                  value(row, vector.columns[2]));
    };
    const Vec3 x = rotation(a.rows[i]), y = rotation(b.rows[k]);
    return std::min(to_turned(x, y), to_turned(y, x));
  }
  double sum = 0.0;
  for (const std::size_t c : vector.columns) {
    const double d = value(a.rows[i], c) - value(b.rows[k], c);
    sum += d * d;
  }
  return std::sqrt(sum);
}

Scale scale_of(const Components& vector, const Findings& findings, std::size_t places, double zero,
               Measure measure) {
  double own = 0.0, of_unit = vector.unit == "J" ? findings.energy : 0.0;
  std::vector<double> zero_of(findings.columns.size(), 0.0), row;
  if (places > 1 && measure == Measure::change)
    for (std::size_t c = 0; c < zero_of.size(); ++c)
      if (findings.units[c] == vector.unit && depends_on_origin(findings.columns[c]))
        zero_of[c] = findings.rows.front()[c];
  for (std::size_t k = 0; k < places; ++k) {
    row = findings.rows[k];
    for (std::size_t c = 0; c < row.size(); ++c) row[c] -= zero_of[c];
    own = std::max(own, length(vector, row));
    for (std::size_t c = 0; c < row.size(); ++c)
      if (findings.units[c] == vector.unit) of_unit = std::max(of_unit, std::abs(row[c]));
  }
  // Angles have a size of their own: two whole turns are a rotation by round-off.
  if (vector.unit == "rad" && of_unit < zero_angle) of_unit = 1.0;
  Scale scale{own, own <= zero * of_unit};
  if (scale.is_zero) scale.value = of_unit;
  if (!(scale.value > 0.0)) scale.value = 1.0;
  return scale;
}

bool anything_changes(const Findings& findings) {
  constexpr double round_off = 1e-13;
  for (std::size_t c = 0; c < findings.columns.size(); ++c) {
    double least = std::numeric_limits<double>::infinity(), most = -least;
    for (const auto& row : findings.rows) {
      least = std::min(least, row[c]);
      most = std::max(most, row[c]);
    }
    if (most - least > round_off * std::max(std::abs(least), std::abs(most))) return true;
  }
  return false;
}

}  // namespace mbd
