// Instantiation of the elastic term for one metric and form, all orders: included by one small .cpp for each metric, since
// a templated kernel is slow to compile.
#pragma once

#include "elements/beam/beam_elastic.hpp"
#include "elements/beam/beam_elastic_batch.hpp"
#include "elements/element_batch.hpp"

namespace mbd::beam {

template <class MetricType, class FormType, int N>
class ElasticBatch final : public ElementBatch<Elastic<MetricType, FormType, N>, BeamElasticBatch> {
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

  Vec6 resultants(const State& state, Index element, double xi) const override {
    typename Base::NodeStates x;
    this->gather(state, static_cast<std::size_t>(element), x);
    return Kernel::resultants(this->shared(), this->data(element), x.data(), table_.rule.points,
                              xi);
  }

  const SpectralTable& table() const override { return table_; }

  MeshError mesh_error(const State& state, Index element,
                       const MeshErrorRule& rule) const override {
    typename Base::NodeStates x;
    this->gather(state, static_cast<std::size_t>(element), x);
    return mesh_error_of<Kernel>(this->shared(), this->data(element), x.data(), table_, rule);
  }

  const std::string& name_of(Index element) const override { return this->name(element); }

 private:
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
