// Instantiation of the elastic term for one metric and form, all orders: included by one small .cpp for each metric, since
// a templated kernel is slow to compile.
#pragma once

#include "elements/beam/beam_elastic.hpp"
#include "elements/beam/beam_elastic_batch.hpp"
#include "elements/element_batch.hpp"
#include "elements/iterated_beams.hpp"

namespace mbd::beam {

template <class MetricType, class FormType, int N>
class ElasticBatch final : public ElementBatch<Elastic<MetricType, FormType, N>, BeamElasticBatch>,
                           public IteratedBeams {
  using Kernel = Elastic<MetricType, FormType, N>;
  using Base = ElementBatch<Kernel, BeamElasticBatch>;

 public:
  explicit ElasticBatch(const SpectralTable& table)
      : Base(std::string("beam elastic, ") + MetricType::name + ", " + FormType::name +
                 ", N = " + std::to_string(table.order) +
                 (table.rule.points.size() == table.nodes.points.size() ? ", Gauss-Lobatto"
                                                                        : ", Gauss"),
             typename Kernel::Shared{make_table<N>(table), {}}),
        table_(table) {}

  bool is_structure() const override { return true; }

  int add_stiffness(const Mat6& D) override {
    this->shared().stiffness.push_back(D);
    return static_cast<int>(this->shared().stiffness.size()) - 1;
  }

  Index add_element(std::span<const double> J, std::span<const Pose<double>> reference,
                    std::span<const int> nodes, int stiffness, int stride,
                    std::string name) override {
    this->add(make_data<MetricType, N>(table_, J, reference, stiffness, stride), nodes,
              std::move(name));
    return this->size() - 1;
  }

  void set_frames_of(Index element, std::span<const Pose<double>> frames) override {
    this->set_frames(element, frames);
  }

  Sizes sizes() const override { return {units() * numbers(), units() * kept_numbers()}; }

  double slenderness() const override {
    const auto& all = this->shared().stiffness;
    std::vector<double> per_length_squared(all.size());
    for (std::size_t k = 0; k < all.size(); ++k) {
      const Mat6 compliance = all[k].ldlt().solve(Mat6::Identity());
      per_length_squared[k] = all[k].diagonal().template head<3>().maxCoeff() *
                              compliance.diagonal().template tail<3>().maxCoeff();
    }
    double largest = 0.0;
    const int points = this->shared().table.points;
    for (Index e = 0; e < this->size(); ++e) {
      const auto& data = this->data(e);
      double length = 0.0;
      for (int i = 0; i < points; ++i) length += data.wJ[static_cast<std::size_t>(i)];
      for (int i = 0; i < (data.stiffness_stride == 0 ? 1 : points); ++i)
        largest = std::max(largest, length * length *
                                        per_length_squared[static_cast<std::size_t>(
                                            data.stiffness + i * data.stiffness_stride)]);
    }
    return largest;
  }

  bool residual_kept(const State& state, std::span<const double> T0, std::span<const double> S,
                     std::span<double> DE, VecX& r) const override {
    typename Side::template Output<Number> out;
    States x;
    double margin = 1.0;
    each_unit([&](std::size_t u, const PackOf& pack, const auto& shared, const auto& data) {
      gather_unit(state, pack, x);
      const double m =
          smallest_of(Side::residual_kept(shared, data, x.data(), &T0[u * kept_numbers()],
                                          &S[u * numbers()], &DE[u * numbers()], out));
      margin = m < margin ? m : margin;
      if constexpr (is_packed) {
        this->add_residuals(out, pack, r);
      } else {
        this->template carry<Want::residual>(pack.first, out);
        this->add_residual(out, pack.first, r);
      }
    });
    return margin > 0.0;
  }

  void keep(const State& state, std::span<double> T0, std::span<double> DE) const override {
    States x;
    each_unit([&](std::size_t u, const PackOf& pack, const auto& shared, const auto& data) {
      gather_unit(state, pack, x);
      Side::keep(shared, data, x.data(), T0.empty() ? nullptr : &T0[u * kept_numbers()],
                 &DE[u * numbers()]);
    });
  }

  void add_geometric_stiffness(const State& state, double U, std::span<const double> S,
                               std::span<const double> DE,
                               std::span<const Slot> slots) const override {
    typename Kernel::template Output<double> out;
    typename Base::NodeStates x;
    std::array<Vec6, static_cast<std::size_t>(Kernel::Z::max_points)> difference;
    const auto points = static_cast<std::size_t>(Kernel::point_count(this->shared()));
    for (std::size_t e = 0; e < static_cast<std::size_t>(this->size()); ++e) {
      std::size_t at = e / lanes * numbers() + e % lanes;
      for (std::size_t i = 0; i < points; ++i)
        for (int q = 0; q < 6; ++q, at += lanes) difference[i](q) = S[at] - DE[at];
      this->gather(state, e, x);
      Kernel::geometric_stiffness(this->shared(), this->data(static_cast<Index>(e)), x.data(),
                                  difference.data(), out);
      this->template carry<Want::tangent>(e, out);
      this->hand_over(out, e, U, {}, slots);
    }
  }

  void advance(std::span<const double> T0, std::span<const double> dU, std::span<const double> DE,
               std::span<double> S) const override {
    std::array<Vector6<Number>, static_cast<std::size_t>(Base::max_nodes)> increments;
    each_unit([&](std::size_t u, const PackOf& pack, const auto& shared, const auto& data) {
      this->gather_increments(dU, pack, increments);
      Side::advance(shared, data, &T0[u * kept_numbers()], increments.data(), &DE[u * numbers()],
                    &S[u * numbers()]);
    });
  }

  void elastic_resultants(const State& state, Index element, std::span<Vec6> S) const override {
    typename Base::NodeStates x;
    this->gather(state, static_cast<std::size_t>(element), x);
    Kernel::resultants(this->shared(), this->data(element), x.data(), S.data());
  }

  const SpectralTable& table() const override { return table_; }

  MeshError mesh_error(const State& state, Index element,
                       const MeshErrorRule& rule) const override {
    typename Base::NodeStates x;
    this->gather(state, static_cast<std::size_t>(element), x);
    return mesh_error_of<Kernel>(this->shared(), this->data(element), x.data(), table_, rule,
                                 this->section_samples(element), this->held_forces(state, element));
  }

  const std::string& name_of(Index element) const override { return this->name(element); }

 private:
  // What works on resultants as iterates: elements side by side where there are packs of them, or one at a time.
  static constexpr bool is_packed = has_packs<Kernel>;
  static constexpr std::size_t lanes = is_packed ? pack_count : 1;
  using Number = std::conditional_t<is_packed, Pack, double>;
  using Side = std::conditional_t<is_packed, typename Kernel::Packed, Kernel>;
  using States = std::array<NodeState<Number>, static_cast<std::size_t>(Base::max_nodes)>;

  std::size_t units() const { return (static_cast<std::size_t>(this->size()) + lanes - 1) / lanes; }
  std::size_t numbers() const {
    return 6 * lanes * static_cast<std::size_t>(Kernel::point_count(this->shared()));
  }
  std::size_t kept_numbers() const { return lanes * Kernel::kept_count(this->shared()); }
  template <class F>
  void each_unit(const F& f) const {
    const auto end = static_cast<std::size_t>(this->size());
    if constexpr (is_packed)
      each_pack(0, end, [&](const PackOf& pack) {
        const std::size_t unit = pack.first / lanes;
        f(unit, pack, this->packs().shared, this->packs().data[unit]);
      });
    else
      for (std::size_t e = 0; e < end; ++e)
        f(e, PackOf{e, e + 1}, this->shared(), this->data(static_cast<Index>(e)));
  }
  void gather_unit(const State& state, const PackOf& pack, States& x) const {
    if constexpr (is_packed)
      this->gather(state, pack, x);
    else
      this->gather(state, pack.first, x);
  }

  SpectralTable table_;
};

template <class MetricType, class FormType>
std::unique_ptr<BeamElasticBatch> make_elastic(const SpectralTable& table, bool run_time_order) {
#ifndef MBD_RUNTIME_ORDER_ONLY
  if (!run_time_order) {
    switch (table.order) {
      case 1:
        return std::make_unique<ElasticBatch<MetricType, FormType, 1>>(table);
      case 2:
        return std::make_unique<ElasticBatch<MetricType, FormType, 2>>(table);
      case 3:
        return std::make_unique<ElasticBatch<MetricType, FormType, 3>>(table);
      case 4:
        return std::make_unique<ElasticBatch<MetricType, FormType, 4>>(table);
      case 5:
        return std::make_unique<ElasticBatch<MetricType, FormType, 5>>(table);
      default:
        break;
    }
  }
#else
  (void)run_time_order;
#endif
  return std::make_unique<ElasticBatch<MetricType, FormType, 0>>(table);
}

}  // namespace mbd::beam
