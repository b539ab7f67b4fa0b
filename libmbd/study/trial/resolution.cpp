#include "libmbd/study/trial/resolution.hpp"

#include <algorithm>
#include <cmath>

#include "elements/metrics.hpp"
#include "libmbd/core/spectral.hpp"
#include "libmbd/scene/places.hpp"

namespace mbd {
namespace {

using Columns6 = Eigen::Matrix<double, 6, Eigen::Dynamic>;

Vec6 logarithm(const Pose<double>& from, const Pose<double>& to) {
  return GeodesicMetric::Pair<double>(relative(from, to)).q();
}

// P_n(xi).
double legendre(int n, double xi) {
  double before = 0.0, now = 1.0;
  for (int k = 1; k <= n; ++k) {
    const double next = ((2 * k - 1) * xi * now - (k - 1) * before) / k;
    before = now;
    now = next;
  }
  return now;
}

double size(const Vec6& q, double length) { return linear(q).norm() / length + angular(q).norm(); }

// d log / d xi at the nodes of an element that begins at `first`, pose by node.
Columns6 slopes(const SpectralTable& table, const std::vector<Pose<double>>& pose,
                const Model::Line& line, std::size_t first) {
  const Index count = table.order + 1;
  Columns6 K = Columns6::Zero(6, count);
  for (Index j = 0; j < count; ++j)
    for (Index k = 0; k < count; ++k) {
      if (k == j) continue;
      const Pose<double> a = line.pose(pose, first + static_cast<std::size_t>(j)),
                         b = line.pose(pose, first + static_cast<std::size_t>(k));
      K.col(j) += table.d(j, k) * logarithm(a, b);
    }
  return K;
}

}  // namespace

double BeamResolution::decay() const {
  const std::size_t n = coefficients.size();
  // Of order 1 there is one coefficient; of order 2, one of the variation: nothing to compare.
  if (n < 4 || !(coefficients[n - 1] > 0.0)) return n < 4 ? 4.0 : 1000.0;
  // By parity one of two may be small: the last two against the two before.
  const double last = std::max(coefficients[n - 1], coefficients[n - 2]);
  const double before = std::max(coefficients[n - 2], coefficients[n - 3]);
  const double sigma =
      std::max(before / last, std::sqrt(std::max(before, last) / coefficients[n - 1]));
  return std::clamp(sigma, 1.0, 1000.0);
}

double BeamResolution::last() const {
  const double most = *std::max_element(coefficients.begin() + 1, coefficients.end());
  return most > 0.0 ? coefficients.back() / most : 0.0;
}

void ResolutionMeter::set_up(const Model& model) {
  for (const Model::Line& line : model.lines) {
    const auto beam = std::find_if(scene_.beams.begin(), scene_.beams.end(),
                                   [&](const BeamScene& b) { return b.name == line.name; });
    BeamResolution one;
    one.name = line.name;
    one.order = beam->order;
    one.elements = static_cast<int>(line.nodes.size() - 1) / one.order;
    one.coefficients.assign(static_cast<std::size_t>(one.order) + 1, 0.0);
    beams_.push_back(one);

    // Where elements end, as a fraction of the length of the line through the nodes: near enough to the
    // reference length to know which of them a place is.
    std::vector<double> along{0.0};
    for (std::size_t k = 1; k < line.size(); ++k)
      along.push_back(
          along.back() +
          (line.pose(model.initial.pose, k).r - line.pose(model.initial.pose, k - 1).r).norm());
    std::vector<double> places;
    each_node_place(scene_, [&](const Place& place) {
      if (place.kind == Place::Kind::beam && place.name == line.name)
        places.push_back(place.parameter);
    });
    std::vector<bool> attached;
    for (int e = 1; e < one.elements; ++e) {
      const double s = along[static_cast<std::size_t>(e * one.order)] / along.back();
      attached.push_back(std::any_of(places.begin(), places.end(), [&](double at) {
        return std::abs(at - s) < 0.25 / one.elements;
      }));
    }
    attached_.push_back(std::move(attached));
  }
}

void ResolutionMeter::look(const Model& model, const State& state) {
  if (beams_.empty()) set_up(model);
  for (std::size_t b = 0; b < beams_.size(); ++b) {
    BeamResolution& beam = beams_[b];
    const Model::Line& line = model.lines[b];
    const SpectralTable table = spectral_table(beam.order, Rule::gauss);
    const auto order = static_cast<std::size_t>(beam.order);
    Vec6 end = Vec6::Zero();  // strain at the end of the element before
    for (int e = 0; e < beam.elements; ++e) {
      const std::size_t first = static_cast<std::size_t>(e) * order;
      const auto pose = [&](std::size_t k) { return line.pose(state.pose, first + k); };
      Columns6 q(6, beam.order + 1);
      for (std::size_t k = 0; k <= order; ++k)
        q.col(static_cast<Index>(k)) = logarithm(pose(0), pose(k));
      const Columns6 before = slopes(table, model.initial.pose, line, first);
      const Columns6 now = slopes(table, state.pose, line, first);
      double length = 0.0;
      for (Index k = 0; k <= beam.order; ++k)
        length += table.nodes.weights[static_cast<std::size_t>(k)] * before.col(k).head<3>().norm();
      for (int n = 1; n <= beam.order; ++n) {
        Vec6 a = Vec6::Zero();
        double norm = 0.0;
        for (std::size_t k = 0; k <= order; ++k) {
          const double P = legendre(n, table.nodes.points[k]);
          a += table.nodes.weights[k] * P * q.col(static_cast<Index>(k));
          norm += table.nodes.weights[k] * P * P;
        }
        double& worst = beam.coefficients[static_cast<std::size_t>(n)];
        worst = std::max(worst, size(a / norm, length));
      }
      const auto strain = [&](Index j) -> Vec6 {
        Vec6 E = (now.col(j) - before.col(j)) / before.col(j).head<3>().norm();
        E.tail<3>() *= length;
        return E;
      };
      for (Index j = 0; j <= beam.order; ++j) beam.strain = std::max(beam.strain, strain(j).norm());
      if (e > 0 && !attached_[b][static_cast<std::size_t>(e - 1)])
        beam.jump = std::max(beam.jump, (strain(0) - end).norm());
      end = strain(beam.order);
    }
  }
}

}  // namespace mbd
