// The motion over a step of Radau IIA of five and seven stages, of which the quintic (dense_output.hpp) would err by more
// than the step. The polynomial is that of degree s + 1 whose rates are those of the start and of all stages: it ends where
// the collocation polynomial does, and as the rates of that are wrong at the start by the estimated error, it is nearer by an
// order. With q as in radau.hpp, in a step of h:
//   H = H_i exp((t - t_i) V_i) exp(q),   q = h sum_k q'_k M_k,   M_k = int_0 m_k,
// m_k through 0, c_1 … c_s. It errs by h^(s+2), and V by h^(s+1); multipliers, of degree s - 1 through the stages, by h^s.
// What the projection moves the end by is added as delta (3 - 2 x) x^2. Where rows are idle, multipliers are made those of least
// norm at each stage first: with some of them 0 the others go through poles, where the rows that are left come close to repeating
// each other, and no polynomial follows them.
//
// Work is the integral of the polynomial through the powers at the start and all stages.
#pragma once

#include <array>
#include <vector>

#include "solvers/time/dense_output.hpp"
#include "solvers/time/radau_tableau.hpp"

namespace mbd {

class CollocationStep final : public StepBetween {
 public:
  explicit CollocationStep(const System& system) : system_(system) {}

  // Of the stages, the end of the step among them.
  struct Inside {
    static constexpr std::size_t most = RadauTableau::most_stages;
    const RadauTableau* tableau = nullptr;
    std::array<std::span<const Vec6>, most> q, dV;  // by node; dV = V - V_i
    std::array<const State*, most> stage{};         // the end itself for the last
    std::array<Work, most> power{};
    // A rank-tolerant step: no row is idle, though some repeat others at its end.
    bool tolerant = false;
  };
  // Refers to all of it until the next call. Costs nothing until at() is called.
  void set(const State& begin, const State& end, const Inside& inside);

  void at(double t, State& out) const override;
  Balance balance() const override;

 private:
  static constexpr std::size_t most = RadauTableau::most_stages + 1;
  using Weights = std::array<double, most>;
  // M_k, m_k and m'_k at x.
  struct WeightsAt {
    Weights sum{}, value{}, slope{};
  };
  WeightsAt weights_at(double x) const;
  void prepare() const;
  Work work_at(const Weights& sums) const;

  const System& system_;
  Inside inside_;
  mutable bool prepared_ = false;
  mutable Weights node_{}, scale_{};  // 0, c_1 …, and 1/prod (node_k - node_j)
  mutable std::array<std::vector<Vec6>, RadauTableau::most_stages> rate_;  // h q'_k
  mutable std::array<VecX, RadauTableau::most_stages> lambda_;
  mutable std::vector<Vec6> delta_;
  mutable Work power_begin_{}, work_left_{};
};

}  // namespace mbd
