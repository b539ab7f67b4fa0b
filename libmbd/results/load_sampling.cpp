#include "libmbd/results/load_sampling.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "libmbd/core/spectral.hpp"
#include "libmbd/scene/label.hpp"
#include "libmbd/scene/reference_line.hpp"

namespace mbd {
namespace {

constexpr std::size_t most_elements =
    400;                            // looked at of a beam, besides those in which a load does more
constexpr int points_of_piece = 4;  // of the quadrature
constexpr std::size_t pieces_of_element = 3,
                      pieces_of_beam = 600;  // of what is known place by place alone

using Fields = std::array<FieldExpression, 3>;

// One row of a load on one beam.
class SampledRow {
 public:
  SampledRow(const Fields& fields, int order, std::span<const InputValue> inputs)
      : fields_(fields), nodes_(gauss_lobatto_rule(order + 1)), inputs_(inputs) {}

  // `s`: of the nodes of the beam, each once. What elements share is added.
  double error(std::span<const double> s, const std::vector<double>& times) {
    look_along(times);
    const std::size_t order = nodes_.points.size() - 1, elements = (s.size() - 1) / order,
                      stride = (elements + most_elements - 1) / most_elements;
    const std::size_t n = times.size();
    std::vector<std::vector<Vec3>> sampled(s.size(), std::vector<Vec3>(n, Vec3::Zero())),
        whole = sampled;
    for (std::size_t e = 0; e < elements; ++e) {
      const double a = s[e * order], b = s[(e + 1) * order], half = 0.5 * (b - a);
      const std::vector<double> pieces = pieces_of(a, b, elements);
      if (e % stride != 0 && pieces.size() == pieces_of_element + 1) continue;
      for (std::size_t k = 0; k <= order; ++k)
        add(a + half * (1.0 + nodes_.points[k]), times, [&](std::size_t i, const Vec3& q) {
          sampled[e * order + k][i] += half * nodes_.weights[k] * q;
        });
      for (std::size_t piece = 0; piece + 1 < pieces.size(); ++piece)
        for (std::size_t j = 0; j < gauss_.points.size(); ++j) {
          const double part = 0.5 * (pieces[piece + 1] - pieces[piece]),
                       x = pieces[piece] + part * (1.0 + gauss_.points[j]);
          const VecX N = lagrange(nodes_.points, (x - a) / half - 1.0);
          add(x, times, [&](std::size_t i, const Vec3& q) {
            for (std::size_t k = 0; k <= order; ++k)
              whole[e * order + k][i] += part * gauss_.weights[j] * N(static_cast<Index>(k)) * q;
          });
        }
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
  using Profiles = std::array<FieldExpression::Profile, 3>;

  // Where the load is known as a function of the place, with the ends of what it does there; else all of it is looked at place by
  // place.
  void look_along(const std::vector<double>& times) {
    for (const double t : times) {
      Profiles all;
      for (std::size_t c = 0; c < 3; ++c) {
        std::optional<FieldExpression::Profile> one = fields_[c].profile(t);
        if (!one) {
          profiles_.clear();
          ends_.clear();
          return;
        }
        ends_.insert(ends_.end(), one->ends().begin(), one->ends().end());
        all[c] = std::move(*one);
      }
      profiles_.push_back(std::move(all));
    }
    std::ranges::sort(ends_);
  }

  // Ends of the pieces of an element in which the load is integrated.
  std::vector<double> pieces_of(double a, double b, std::size_t elements) const {
    const std::size_t count = profiles_.empty()
                                  ? std::max(pieces_of_element, pieces_of_beam / elements)
                                  : pieces_of_element;
    std::vector<double> pieces;
    for (std::size_t i = 0; i <= count; ++i)
      pieces.push_back(a + (b - a) * static_cast<double>(i) / static_cast<double>(count));
    pieces.insert(pieces.end(), std::ranges::upper_bound(ends_, a),
                  std::ranges::lower_bound(ends_, b));
    std::ranges::sort(pieces);
    return pieces;
  }

  template <class Add>
  void add(double s, const std::vector<double>& times, const Add& add) {
    if (!profiles_.empty()) {
      for (std::size_t i = 0; i < times.size(); ++i) {
        const Vec3 q(profiles_[i][0](s), profiles_[i][1](s), profiles_[i][2](s));
        if (q.allFinite()) add(i, q);
      }
      return;
    }
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
  const Quadrature nodes_, gauss_ = gauss_rule(points_of_piece);
  std::span<const InputValue> inputs_;
  std::vector<Profiles> profiles_;  // by time; none: place by place
  std::vector<double> ends_;        // places, rising
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
