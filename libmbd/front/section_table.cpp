#include "libmbd/front/section_table.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "libmbd/front/spline.hpp"

namespace mbd {
namespace {

bool is_symmetric(const Mat6& M) {
  const Vec6 d = M.diagonal().cwiseAbs().cwiseSqrt();
  for (Index i = 0; i < 6; ++i)
    for (Index j = 0; j < i; ++j)
      if (!(std::abs(M(i, j) - M(j, i)) <= 1e-10 * d(i) * d(j))) return false;
  return true;
}

void check_matrices(const Source& source, const std::string& who, const Mat6& D,
                    const std::optional<Mat6>& M) {
  if (!is_symmetric(D)) throw Error(source, fmt::format("{}: the stiffness is not symmetric", who));
  if (!(scaled_definiteness(D) > definite))
    throw Error(source, fmt::format("{}: the stiffness is not positive definite; check signs and "
                                    "couplings",
                                    who));
  if (M && (!is_symmetric(*M) || scaled_definiteness(*M) < -definite))
    throw Error(source, fmt::format("{}: the mass is not symmetric and positive", who));
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

double scaled_definiteness(const Mat6& M) {
  const Vec6 d = M.diagonal();
  if (!(d.minCoeff() > 0.0)) return d.minCoeff() < 0.0 ? -1.0 : 0.0;
  const Vec6 s = d.cwiseSqrt().cwiseInverse();
  const Eigen::Matrix<double, 6, 6> scaled = s.asDiagonal() * M * s.asDiagonal();
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>>(scaled, Eigen::EigenvaluesOnly)
      .eigenvalues()(0);
}

void check_section(const Section& section) {
  const std::string who = fmt::format("section \"{}\"", section.name);
  if (section.stations.empty()) {
    check_matrices(section.source, who, section.stiffness, section.mass);
    return;
  }
  const std::vector<Station>& stations = section.stations;
  if (stations.size() < 2 || stations.front().at != 0.0 || stations.back().at != 1.0)
    throw Error(
        section.source,
        fmt::format("{}: stations run from at=\"0\" to at=\"1\", the ends of the beam", who));
  for (std::size_t i = 0; i < stations.size(); ++i) {
    const Station& station = stations[i];
    const std::string here = fmt::format("{}, station at {:g}", who, station.at);
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
  }
}

struct SectionTable::Smooth {
  Spline stiffness;
  std::optional<Spline> mass;
};

SectionTable::SectionTable(const Section& section) : section_(section) {
  if (is_uniform() || section.interpolation != Section::Interpolation::smooth) return;
  auto smooth = std::make_shared<Smooth>(Smooth{spline(section.stations, false), {}});
  if (has_mass()) smooth->mass = spline(section.stations, true);
  smooth_ = std::move(smooth);
}

bool SectionTable::has_mass() const {
  return is_uniform() ? section_.mass.has_value() : section_.stations[0].mass.has_value();
}

Mat6 SectionTable::stiffness(double s) const {
  if (is_uniform()) return section_.stiffness;
  const Mat6 D = interpolated(s, false);
  if (!(scaled_definiteness(D) > definite))
    throw Error(section_.source,
                fmt::format("section \"{}\": the smooth table of the stiffness is not positive "
                            "definite at {:.3g}; give more stations there, or "
                            "interpolation=\"linear\"",
                            section_.name, s));
  return D;
}

Mat6 SectionTable::mass(double s) const {
  if (is_uniform()) return *section_.mass;
  const Mat6 M = interpolated(s, true);
  if (scaled_definiteness(M) < -definite)
    throw Error(
        section_.source,
        fmt::format("section \"{}\": the smooth table of the mass is not positive at {:.3g}; "
                    "give more stations there, or interpolation=\"linear\"",
                    section_.name, s));
  return M;
}

Mat6 SectionTable::interpolated(double s, bool of_mass) const {
  if (smooth_) {
    return (of_mass ? *smooth_->mass : smooth_->stiffness).value(s).reshaped(6, 6);
  }
  std::size_t i = 1;
  while (i + 1 < section_.stations.size() && section_.stations[i].at < s) ++i;
  const Station &a = section_.stations[i - 1], &b = section_.stations[i];
  const double x = (s - a.at) / (b.at - a.at);
  const Mat6 &A = of_mass ? *a.mass : a.stiffness, &B = of_mass ? *b.mass : b.stiffness;
  return (1.0 - x) * A + x * B;
}

}  // namespace mbd
