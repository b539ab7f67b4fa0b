#include "libmbd/scene/section_table.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "libmbd/scene/label.hpp"
#include "libmbd/scene/spline.hpp"

namespace mbd {
namespace {

// The first pair of entries that should be equal and are not.
std::optional<std::array<Index, 2>> unsymmetric(const Mat6& M) {
  const Vec6 d = M.diagonal().cwiseAbs().cwiseSqrt();
  for (Index i = 0; i < 6; ++i)
    for (Index j = i + 1; j < 6; ++j)
      if (!(std::abs(M(i, j) - M(j, i)) <= 1e-10 * d(i) * d(j))) return {{i, j}};
  return std::nullopt;
}

void check_finite(const Source& source, const std::string& who, std::string_view what,
                  const Mat6& M) {
  for (Index i = 0; i < 6; ++i)
    for (Index j = 0; j < 6; ++j)
      if (!std::isfinite(M(i, j)))
        throw Error(source, fmt::format("{}: {}: row {}, column {} is {}, must be a finite number",
                                        who, what, i + 1, j + 1, M(i, j)));
}

void check_symmetric(const Source& source, const std::string& who, std::string_view what,
                     const Mat6& M) {
  if (const auto at = unsymmetric(M)) {
    const auto [i, j] = *at;
    throw Error(source, fmt::format("{}: {}: row {}, column {} is {} but row {}, column {} is {}; "
                                    "the matrix must be symmetric",
                                    who, what, i + 1, j + 1, M(i, j), j + 1, i + 1, M(j, i)));
  }
}

constexpr std::array<std::string_view, 6> names = {"EA", "GA2", "GA3", "GJ", "EI2", "EI3"};

// D with finite entries: what is infinite there as stiff as what bends over a length, or else as shear.
void stand_in(Mat6& D, double length) {
  const std::array<bool, 6> held = infinite_stiffnesses(D);
  const double bends = 12.0 / (length * length);  // forces by stiffnesses against bending
  double shears = 0.0, least = std::numeric_limits<double>::infinity();
  for (Index c = 0; c < 6; ++c) {
    if (held[static_cast<std::size_t>(c)]) continue;
    if (c < 3)
      shears = std::max(shears, D(c, c));
    else
      least = std::min(least, D(c, c) * bends);
  }
  const double force = std::isfinite(least) ? least : shears;
  for (Index c = 0; c < 6; ++c)
    if (held[static_cast<std::size_t>(c)]) D(c, c) = c < 3 ? force : force / bends;
}

// What is infinite does not take part in the other checks.
Mat6 check_infinite(const Source& source, const std::string& who, Mat6 D) {
  const std::array<bool, 6> held = infinite_stiffnesses(D);
  if (std::find(held.begin(), held.end(), true) == held.end()) return D;
  if (std::find(held.begin(), held.end(), false) == held.end())
    throw Error(source,
                who +
                    ": stiffness: all six are infinite: that is a rigid body; put the beam in a "
                    "<rigid of=…>, or write a <body>");
  for (Index i = 0; i < 6; ++i) {
    if (!held[static_cast<std::size_t>(i)]) continue;
    for (Index j = 0; j < 6; ++j)
      if (j != i && (D(i, j) != 0.0 || D(j, i) != 0.0))
        throw Error(source, fmt::format("{}: stiffness: {} is infinite and coupled (row {}, column "
                                        "{}); a strain that is always zero has no couplings, leave "
                                        "them out",
                                        who, names[static_cast<std::size_t>(i)], i + 1, j + 1));
    D(i, i) = 1.0;
  }
  return D;
}

void check_stiffness(const Source& source, const std::string& who, const Mat6& stated) {
  const Mat6 D = check_infinite(source, who, stated);
  check_finite(source, who, "stiffness", D);
  for (Index i = 0; i < 6; ++i)
    if (!(D(i, i) > 0.0))
      throw Error(source,
                  fmt::format("{}: stiffness: {} (row {}, column {}) is {}, must be positive", who,
                              names[static_cast<std::size_t>(i)], i + 1, i + 1, D(i, i)));
  check_symmetric(source, who, "stiffness", D);
  if (scaled_definiteness(D) > definite) return;
  for (Index i = 0; i < 6; ++i)
    for (Index j = i + 1; j < 6; ++j)
      if (!(D(i, j) * D(i, j) < D(i, i) * D(j, j)))
        throw Error(
            source,
            fmt::format("{}: stiffness: not positive definite: D{}{} is {}, larger than {:.6g}, "
                        "the root of {} {}; check the coupling",
                        who, i + 1, j + 1, D(i, j), std::sqrt(D(i, i) * D(j, j)),
                        names[static_cast<std::size_t>(i)], names[static_cast<std::size_t>(j)]));
  throw Error(
      source,
      fmt::format("{}: stiffness: not positive definite: some strain would set energy free; "
                  "check signs and sizes of the couplings",
                  who));
}

void check_mass(const Source& source, const std::string& who, const Mat6& M) {
  check_finite(source, who, "mass", M);
  if (!(M(0, 0) > 0.0))
    throw Error(source, fmt::format("{}: mass: per_length is {}, must be positive", who, M(0, 0)));
  for (Index i = 3; i < 6; ++i)
    if (!(M(i, i) >= 0.0))
      throw Error(source, fmt::format("{}: mass: inertia J{}{} is {}, must not be negative", who,
                                      i - 2, i - 2, M(i, i)));
  check_symmetric(source, who, "mass", M);
  if (scaled_definiteness(M) < -definite)
    throw Error(
        source,
        fmt::format("{}: mass: not positive: the inertia is about the reference line and so is "
                    "at least that of the mass at its center; check inertia and center",
                    who));
}

// The viscous stiffness where the elastic one is D.
void check_viscosity(const SectionDamping& damping, const std::string& who, Mat6 D) {
  stand_in(D, 1.0);
  const Mat6 C = viscosity(damping, D);
  if (definiteness_of_some(C) >= -definite) return;
  for (Index i = 0; i < 6; ++i)
    for (Index j = i + 1; j < 6; ++j)
      if (!(C(i, j) * C(i, j) <= C(i, i) * C(j, j) * (1.0 + definite)))
        throw Error(
            damping.source,
            fmt::format("{}: damping: C = beta D + viscous entries must not be negative: row {}, "
                        "column {} is {}, larger than {:.6g}, the root of the product of its "
                        "diagonal entries; check the coupling D{}{}",
                        who, i + 1, j + 1, C(i, j), std::sqrt(C(i, i) * C(j, j)), i + 1, j + 1));
  throw Error(damping.source,
              fmt::format("{}: damping: C = beta D + viscous entries must not be negative: some "
                          "rate of strain would set power free; check signs and sizes of the "
                          "couplings",
                          who));
}

void check_damping(const SectionDamping& damping, const std::string& who) {
  check_finite(damping.source, who, "damping", damping.viscous);
  check_symmetric(damping.source, who, "damping", damping.viscous);
}

void check_matrices(const Source& source, const std::string& who, const Mat6& D,
                    const std::optional<Mat6>& M) {
  check_stiffness(source, who, D);
  if (M) check_mass(source, who, *M);
}

Spline spline(const std::vector<Station>& stations, bool of_mass) {
  const auto count = static_cast<Index>(stations.size());
  Eigen::MatrixXd data(36, count);
  VecX at(count);
  for (Index i = 0; i < count; ++i) {
    const Station& station = stations[static_cast<std::size_t>(i)];
    data.col(i) = (of_mass ? *station.mass : station.stiffness).reshaped();
    at(i) = station.at;
  }
  return {data, at, static_cast<int>(std::min<Index>(3, count - 1))};
}

}  // namespace

Mat6 viscosity(const SectionDamping& damping, const Mat6& D) {
  return damping.stiffness_proportional * D + damping.viscous;
}

std::array<bool, 6> infinite_stiffnesses(const Mat6& D) {
  std::array<bool, 6> held;
  for (Index c = 0; c < 6; ++c)
    held[static_cast<std::size_t>(c)] = D(c, c) == std::numeric_limits<double>::infinity();
  return held;
}

std::array<bool, 6> infinite_stiffnesses(const Section& section) {
  return infinite_stiffnesses(section.stations.empty() ? section.stiffness
                                                       : section.stations.front().stiffness);
}

double scaled_definiteness(const Mat6& M) {
  const Vec6 d = M.diagonal();
  if (!(d.minCoeff() > 0.0)) return d.minCoeff() < 0.0 ? -1.0 : 0.0;
  const Vec6 s = d.cwiseSqrt().cwiseInverse();
  const Eigen::Matrix<double, 6, 6> scaled = s.asDiagonal() * M * s.asDiagonal();
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>>(scaled, Eigen::EigenvaluesOnly)
      .eigenvalues()(0);
}

double definiteness_of_some(Mat6 M) {
  for (Index i = 0; i < 6; ++i)
    if (M.row(i).isZero(0.0)) M(i, i) = 1.0;
  for (Index i = 0; i < 6; ++i)
    if (!(M(i, i) > 0.0)) return -1.0;  // couplings without a diagonal entry, or a negative one
  return scaled_definiteness(M);
}

void check_section(const Section& section) {
  const std::string who = label(section);
  if (section.damping) check_damping(*section.damping, who);
  if (section.stations.empty()) {
    check_matrices(section.source, who, section.stiffness, section.mass);
    if (section.damping) check_viscosity(*section.damping, who, section.stiffness);
    return;
  }
  const std::vector<Station>& stations = section.stations;
  for (std::size_t i = 0; i < stations.size(); ++i) {
    const Station& station = stations[i];
    if (!std::isfinite(station.at))
      throw Error(station.source,
                  fmt::format("{}: station: at is {}, must be a finite number", who, station.at));
    const std::string here = fmt::format("{}: station at {:g}", who, station.at);
    if (i > 0 && !(station.at > stations[i - 1].at))
      throw Error(
          station.source,
          fmt::format("{}: must lie behind the one before it, at {:g}; stations are given in "
                      "order",
                      here, stations[i - 1].at));
    if (station.mass.has_value() != stations[0].mass.has_value())
      throw Error(
          station.source,
          fmt::format("{}: {} a mass, unlike the first; give one to all stations or to none", here,
                      station.mass ? "has" : "lacks"));
    check_matrices(station.source, here, station.stiffness, station.mass);
    if (infinite_stiffnesses(station.stiffness) != infinite_stiffnesses(stations[0].stiffness))
      throw Error(station.source,
                  here +
                      ": other stiffnesses are infinite than at the first station; let the same "
                      "be infinite at all, or none");
    if (section.damping) check_viscosity(*section.damping, here, station.stiffness);
  }
  if (stations.size() < 2 || stations.front().at != 0.0 || stations.back().at != 1.0)
    throw Error(section.source,
                who +
                    ": stations must run from at=\"0\" to at=\"1\", the ends of the "
                    "beam; two at least");
}

struct SectionTable::Smooth {
  Spline stiffness;
  std::optional<Spline> mass;
};

SectionTable::SectionTable(const Section& section, double length)
    : section_(&section), held_(infinite_stiffnesses(section)) {
  if (std::find(held_.begin(), held_.end(), true) != held_.end()) {
    auto finite = std::make_shared<Section>(section);
    stand_in(finite->stiffness, length);
    for (Station& station : finite->stations) stand_in(station.stiffness, length);
    finite_ = std::move(finite);
    section_ = finite_.get();
  }
  if (is_uniform() || section.interpolation != Interpolation::smooth) return;
  auto smooth = std::make_shared<Smooth>(Smooth{spline(section_->stations, false), {}});
  if (has_mass()) smooth->mass = spline(section_->stations, true);
  smooth_ = std::move(smooth);
}

bool SectionTable::has_mass() const {
  return is_uniform() ? section_->mass.has_value() : section_->stations[0].mass.has_value();
}

Mat6 SectionTable::stiffness(double s) const {
  if (is_uniform()) return section_->stiffness;
  const Mat6 D = interpolated(s, false);
  if (!(scaled_definiteness(D) > definite))
    throw Error(section_->source,
                fmt::format("{}: the smooth table of the stiffness is not positive "
                            "definite at {:.3g}; give more stations there, or "
                            "interpolation=\"linear\"",
                            label(*section_), s));
  return D;
}

Mat6 SectionTable::viscosity_of(const Mat6& D, double s) const {
  const Mat6 C = viscosity(*section_->damping, D);
  if (definiteness_of_some(C) < -definite)
    throw Error(section_->damping->source,
                fmt::format("{}: damping: C = beta D + viscous entries is negative at {:.3g}, "
                            "where the smooth table of the stiffness makes it so; check the "
                            "couplings",
                            label(*section_), s));
  return C;
}

Mat6 SectionTable::mass(double s) const {
  if (is_uniform()) return *section_->mass;
  const Mat6 M = interpolated(s, true);
  if (scaled_definiteness(M) < -definite)
    throw Error(section_->source,
                fmt::format("{}: the smooth table of the mass is not positive at {:.3g}; "
                            "give more stations there, or interpolation=\"linear\"",
                            label(*section_), s));
  return M;
}

std::vector<SectionTable::Sample> SectionTable::rule(double a, double b) const {
  static const Quadrature gauss = gauss_rule(8);
  std::vector<double> ends{a};
  const auto begin =
      std::upper_bound(section_->stations.begin(), section_->stations.end(), a,
                       [](double at, const Station& station) { return at < station.at; });
  for (auto it = begin; it != section_->stations.end() && it->at < b; ++it) ends.push_back(it->at);
  ends.push_back(b);
  std::vector<Sample> samples;
  for (std::size_t e = 0; e + 1 < ends.size(); ++e) {
    const double half = 0.5 * (ends[e + 1] - ends[e]);
    for (std::size_t i = 0; i < gauss.points.size(); ++i)
      samples.push_back({ends[e] + half * (1.0 + gauss.points[i]), half * gauss.weights[i]});
  }
  return samples;
}

std::vector<Mat6> SectionTable::stiffnesses(double a, double b, const Quadrature& points) const {
  std::vector<Mat6> D(points.points.size(), Mat6::Zero());
  for (const auto& [s, weight] : rule(a, b)) {
    const VecX l = lagrange(points.points, 2.0 * (s - a) / (b - a) - 1.0);
    const Mat6 here = stiffness(s);
    for (std::size_t i = 0; i < D.size(); ++i) D[i] += weight * l(static_cast<Index>(i)) * here;
  }
  for (std::size_t i = 0; i < D.size(); ++i) {
    D[i] /= 0.5 * (b - a) * points.weights[i];
    if (!(scaled_definiteness(D[i]) > definite))
      D[i] = stiffness(a + 0.5 * (b - a) * (1.0 + points.points[i]));
  }
  return D;
}

std::vector<Mat6> SectionTable::masses(double a, double b, const Quadrature& nodes) const {
  const std::vector<double>& xi = nodes.points;
  std::vector<Mat6> M(xi.size(), Mat6::Zero()), beside = M;
  for (const auto& [s, weight] : rule(a, b)) {
    const double x = 2.0 * (s - a) / (b - a) - 1.0;
    const VecX l = lagrange(xi, x);
    const Mat6 here = weight * mass(s);
    for (std::size_t k = 0; k < M.size(); ++k) M[k] += l(static_cast<Index>(k)) * here;
    const auto next =
        static_cast<std::size_t>(std::upper_bound(xi.begin() + 1, xi.end() - 1, x) - xi.begin());
    const double share = (x - xi[next - 1]) / (xi[next] - xi[next - 1]);
    beside[next - 1] += (1.0 - share) * here;
    beside[next] += share * here;
  }
  const bool usable = std::all_of(
      M.begin(), M.end(), [](const Mat6& one) { return definiteness_of_some(one) >= -definite; });
  return usable ? M : beside;
}

Mat6 SectionTable::interpolated(double s, bool of_mass) const {
  if (smooth_) {
    return (of_mass ? *smooth_->mass : smooth_->stiffness).value(s).reshaped(6, 6);
  }
  const auto next = std::lower_bound(section_->stations.begin() + 1, section_->stations.end() - 1,
                                     s, [](const Station& one, double at) { return one.at < at; });
  const Station &a = *(next - 1), &b = *next;
  const double x = (s - a.at) / (b.at - a.at);
  const Mat6 &A = of_mass ? *a.mass : a.stiffness, &B = of_mass ? *b.mass : b.stiffness;
  return (1.0 - x) * A + x * B;
}

}  // namespace mbd
