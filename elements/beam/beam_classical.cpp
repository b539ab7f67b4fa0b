#include "elements/beam/beam_classical.hpp"

#include "elements/beam/beam_elastic_batch.hpp"
#include "elements/element_batch.hpp"
#include "libmbd/core/error.hpp"

namespace mbd {
namespace beam {
namespace {

template <int N>
class ClassicalBatch final : public ElementBatch<Classical<N>, BeamElasticBatch> {
  using Kernel = Classical<N>;
  using Base = ElementBatch<Kernel, BeamElasticBatch>;

 public:
  explicit ClassicalBatch(const SpectralTable& table)
      : Base("beam elastic, classical, N = " + std::to_string(table.order) +
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
    this->add(Kernel::make_data(this->shared().table, J, reference, stiffness, stride), nodes,
              std::move(name));
    return this->size() - 1;
  }

  void set_frames_of(Index element, std::span<const Pose<double>> frames) override {
    this->set_frames(element, frames);
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
  SpectralTable table_;
};

std::unique_ptr<BeamElasticBatch> make_classical(const SpectralTable& table, bool run_time_order) {
#ifndef MBD_RUNTIME_ORDER_ONLY
  if (!run_time_order) {
    switch (table.order) {
      case 1:
        return std::make_unique<ClassicalBatch<1>>(table);
      case 2:
        return std::make_unique<ClassicalBatch<2>>(table);
      case 3:
        return std::make_unique<ClassicalBatch<3>>(table);
      case 4:
        return std::make_unique<ClassicalBatch<4>>(table);
      case 5:
        return std::make_unique<ClassicalBatch<5>>(table);
      default:
        break;
    }
  }
#else
  (void)run_time_order;
#endif
  return std::make_unique<ClassicalBatch<0>>(table);
}

}  // namespace
}  // namespace beam

std::unique_ptr<BeamElasticBatch> make_beam_classical(Rule rule, int order, bool run_time_order) {
  if (order < 1 || order > beam::max_order)
    throw Error("the order of a beam element must lie in 1 … " + std::to_string(beam::max_order) +
                ", not " + std::to_string(order));
  return beam::make_classical(spectral_table(order, rule), run_time_order);
}

}  // namespace mbd
