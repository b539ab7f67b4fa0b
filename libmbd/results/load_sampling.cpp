#include "libmbd/results/load_sampling.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "libmbd/core/spectral.hpp"
#include "libmbd/scene/label.hpp"
#include "libmbd/scene/reference_line.hpp"

namespace mbd {
namespace {

constexpr std::size_t most_elements = 400;               // looked at of a beam
constexpr int parts_of_element = 3, points_of_part = 4;  // of the quadrature in an element

using Fields = std::array<FieldExpression, 3>;

// One row of a load on one beam.
class SampledRow {
 public:
  SampledRow(const Fields& fields, int order, std::span<const InputValue> inputs)
      : fields_(fields), nodes_(gauss_lobatto_rule(order + 1)), inputs_(inputs) {
    const Quadrature gauss = gauss_rule(points_of_part);
    for (int part = 0; part < parts_of_element; ++part)
      for (std::size_t i = 0; i < gauss.points.size(); ++i) {
        const double xi = -1.0 + (2.0 * part + 1.0 + gauss.points[i]) / parts_of_element;
        xi_.push_back(xi);
        weights_.push_back(gauss.weights[i] / parts_of_element);
        shapes_.push_back(lagrange(nodes_.points, xi));
      }
  }

  // `nodes`: s of those of the beam, each once. What elements share is added.
  double error(std::span<const double> s, const std::vector<double>& times) {
    const std::size_t order = nodes_.points.size() - 1, elements = (s.size() - 1) / order,
                      stride = (elements + most_elements - 1) / most_elements;
    const std::size_t n = times.size();
    std::vector<std::vector<Vec3>> sampled(s.size(), std::vector<Vec3>(n, Vec3::Zero())),
        whole = sampled;
    for (std::size_t e = 0; e < elements; e += stride) {
      const double a = s[e * order], half = 0.5 * (s[(e + 1) * order] - a);
      for (std::size_t k = 0; k <= order; ++k)
        add(a + half * (1.0 + nodes_.points[k]), times, [&](std::size_t i, const Vec3& q) {
          sampled[e * order + k][i] += half * nodes_.weights[k] * q;
        });
      for (std::size_t j = 0; j < xi_.size(); ++j)
        add(a + half * (1.0 + xi_[j]), times, [&](std::size_t i, const Vec3& q) {
          for (std::size_t k = 0; k <= order; ++k)
            whole[e * order + k][i] += half * weights_[j] * shapes_[j](static_cast<Index>(k)) * q;
        });
    }
    double worst = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      double missed = 0.0, size = 0.0;
      for (std::size_t k = 0; k < s.size(); ++k) {
        missed += (sampled[k][i] - whole[k][i]).squaredNorm();
        size += whole[k][i].squaredNorm();
      }
      if (size > 0.0) worst = std::max(worst, std::sqrt(missed / size));
    }
    return worst;
  }

 private:
  template <class Add>
  void add(double s, const std::vector<double>& times, const Add& add) {
    const std::array<Expression, 3> laws{fields_[0].at(s), fields_[1].at(s), fields_[2].at(s)};
    // Sensors are not known here: what they read is taken to be some number.
    constexpr double reading = 0.73;
    std::array<std::vector<double>, 3> read;
    for (std::size_t c = 0; c < 3; ++c) read[c].assign(laws[c].sensors().size(), reading);
    for (std::size_t i = 0; i < times.size(); ++i) {
      Vec3 q;
      for (std::size_t c = 0; c < 3; ++c)
        q(static_cast<Index>(c)) = laws[c](times[i], Side::right, inputs_, read[c]).v;
      if (q.allFinite()) add(i, q);
    }
  }

  const Fields& fields_;
  const Quadrature nodes_;
  std::span<const InputValue> inputs_;
  std::vector<double> xi_, weights_;
  std::vector<VecX> shapes_;
};

}  // namespace

LoadSampling load_sampling(const Scene& scene, const Model& model) {
  LoadSampling found;
  const std::vector<InputValue> inputs = model.system->initial_inputs();
  std::vector<double> times{0.0};
  if (scene.transient)
    for (const double share : {0.31, 0.73}) times.push_back(share * scene.transient->duration);
  for (const DistributedLoadScene& load : scene.distributed_loads) {
    const auto line = std::ranges::find(model.lines, load.beam, &Model::Line::name);
    const auto beam = std::ranges::find(scene.beams, load.beam, &BeamScene::name);
    if (line == model.lines.end() || beam == scene.beams.end()) continue;
    std::vector<double> s;
    for (const double one : line->s)
      if (one >= load.from - same_parameter && one <= load.to + same_parameter) s.push_back(one);
    const auto order = static_cast<std::size_t>(beam->order);
    if (s.size() < order + 1 || (s.size() - 1) % order != 0) continue;  // of a reduction
    for (const auto* const fields :
         {&load.force, &load.moment, &load.follower_force, &load.follower_moment}) {
      if (!*fields ||
          std::ranges::none_of(**fields, [](const FieldExpression& f) { return f.varies(); }))
        continue;
      found.any = true;
      const double error = SampledRow(**fields, beam->order, inputs).error(s, times);
      if (error > found.error) {
        found.error = error;
        found.where = fmt::format("{} on {}", label(load), load.beam);
      }
    }
  }
  return found;
}

}  // namespace mbd
