// Instantiation of the viscous term for one metric: included by one small .cpp each, as
// beam_elastic_instances.hpp. Neither a choice of form nor kernels of fixed size: those would save 1 to 15 % of the
// residual and 5 to 30 % of the tangent (N = 2 … 4), and nearly treble the time to compile.
#pragma once

#include "elements/beam/beam_damping.hpp"
#include "elements/beam/beam_damping_batch.hpp"
#include "elements/element_batch.hpp"

namespace mbd::beam {

template <class MetricType, int N>
class DampingBatch final : public ElementBatch<Damping<MetricType, N>, BeamDampingBatch> {
  using Kernel = Damping<MetricType, N>;
  using Base = ElementBatch<Kernel, BeamDampingBatch>;

 public:
  explicit DampingBatch(const SpectralTable& table)
      : Base(std::string("beam damping, ") + MetricType::name +
                 ", N = " + std::to_string(table.order) +
                 (table.rule.points.size() == table.nodes.points.size() ? ", Gauss-Lobatto"
                                                                        : ", Gauss"),
             typename Kernel::Shared{table.order, static_cast<int>(table.rule.points.size()), {}}),
        table_(table) {}

  bool is_structure() const override { return true; }

  int add_viscosity(const Mat6& C) override {
    this->shared().viscosity.push_back(C);
    return static_cast<int>(this->shared().viscosity.size()) - 1;
  }

  Index add_element(std::span<const double> J, std::span<const Pose<double>> reference,
                    std::span<const int> nodes, int viscosity, int stride,
                    std::string name) override {
    this->add(
        Kernel::make_data(make_data<MetricType, N>(table_, J, reference, 0, 0), viscosity, stride),
        nodes, std::move(name));
    return this->size() - 1;
  }

  void set_frames_of(Index element, std::span<const Pose<double>> frames) override {
    this->set_frames(element, frames);
  }

  void resultants(const State& state, Index element, std::span<Vec6> S) const override {
    typename Base::NodeStates x;
    this->gather(state, static_cast<std::size_t>(element), x);
    Kernel::resultants(this->shared(), this->data(element), x.data(), S.data());
  }

 private:
  SpectralTable table_;
};

template <class MetricType>
std::unique_ptr<BeamDampingBatch> make_damping(const SpectralTable& table) {
  return std::make_unique<DampingBatch<MetricType, 0>>(table);
}

}  // namespace mbd::beam
