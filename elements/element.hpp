// What an element kernel is: a pure function of (constants, node states, environment) to residual and
// tangent, written once on a scalar type S. It knows nothing of dof numbers, sparsity, time stepping
// or XML. ElementBatch (element_batch.hpp) gathers, evaluates and hands over.
#pragma once

#include <span>
#include <vector>

#include "libmbd/core/se3.hpp"
#include "libmbd/core/signal.hpp"
#include "libmbd/core/types.hpp"

namespace mbd {

enum class Want { residual, tangent };

template <class S>
struct NodeState {
  Pose<S> H;
  Vector6<S> V;  // only for elements that need rates
  Vector6<S> Vdot;
};

// What acts on all elements at once.
struct Environment {
  double t = 0.0;                        // [s]
  double load_factor = 1.0;              // on every load
  std::span<const SignalValue> signals;  // values at t
  double momentum_rate = 0.0;            // as in State
  std::span<const double> angles = {};   // followed angles of the last accepted state [rad]
};

// Weights of dr/dV and dr/dVdot in the rate tangent D of an element.
struct RateWeights {
  double V = 0.0;
  double A = 0.0;
};

// Residual and tangent of an element of n nodes (n = Eigen::Dynamic: a run-time count up to max_n).
template <class S, int n, int max_n = n>
struct ElementOutput {
  static constexpr int size = n == Eigen::Dynamic ? Eigen::Dynamic : 6 * n;
  static constexpr int options = Eigen::ColMajor | Eigen::DontAlign;
  using Vector = Eigen::Matrix<S, size, 1, options, 6 * max_n, 1>;
  using Square = Eigen::Matrix<S, size, size, options, 6 * max_n, 6 * max_n>;

  Vector r;  // internal minus external forces, 6 per node, body frames [N, N.m]
  Square K;  // dr/dU
  Square D;  // weights.V dr/dV + weights.A dr/dVdot
};

// The contract:
//   Shared, Data            constants of the batch and of one element
//   nodes, max_nodes        count of nodes (or Eigen::Dynamic and its bound)
//   has_K, has_D            which tangents exist; an absent one costs nothing
//   needs_rates             whether V and Vdot are gathered
//   node_count(shared)      the count at run time
//   evaluate<want>(shared, data, node states, environment, weights, out) -> margin: how far the element
//       is from the limit of its validity; not positive is out of range (1 where there is no limit)
//   energies(shared, data, node states, environment)                      where it stores any
//   may_be_offset           that its nodes may sit in those of the batch at constant poses (ElementBatch::set_frames)
//   scales_with_load        that the residual is linear in the load factor, not constant
//   load_power(shared, data, node states with V, environment) -> power [W] of a load on its nodes
//   each_law(shared, data, node states, environment, visit): visit(law, argument, ArgumentOf) for each nonlinear law
//   damping_power(shared, data, node states, environment)    -> power [W] of its forces that depend on rates
template <class E>
concept Element = requires(const typename E::Shared& shared, const typename E::Data& data,
                           const NodeState<double>* x, const Environment& env, RateWeights w,
                           typename E::template Output<double>& out) {
  { E::nodes } -> std::convertible_to<int>;
  { E::has_K } -> std::convertible_to<bool>;
  { E::has_D } -> std::convertible_to<bool>;
  { E::needs_rates } -> std::convertible_to<bool>;
  { E::node_count(shared) } -> std::convertible_to<int>;
  {
    E::template evaluate<Want::residual>(shared, data, x, env, w, out)
    } -> std::convertible_to<double>;
  {
    E::template evaluate<Want::tangent>(shared, data, x, env, w, out)
    } -> std::convertible_to<double>;
};

// Constants of a list of elements, a pack at a time, the last one filled up. An element type that has them says has_packs,
// and has besides
//   Packed                  an element type on packs, of the same residual
//   packed(shared, data)    the constants
template <class E>
struct PackedElements {
  typename E::Packed::Shared shared;
  std::vector<typename E::Packed::Data> data;
};
template <class E>
inline constexpr bool has_packs = false;
template <class E>
requires requires { E::has_packs; }
inline constexpr bool has_packs<E> = E::has_packs;

// An element whose resultants may be iterates of Newton's method (Batch::linearized_resultants); it has besides
//   point_count(shared)     quadrature points
//   evaluate_mixed(shared, data, node states, S, out) -> margin: as evaluate<Want::tangent>, the geometric
//       stiffness that of the resultants S, one a point
//   linearized_resultants(shared, data, node states, dU by node, S): sets S_i = D (E_i + B_i dU)
template <class E>
concept Mixed = requires(const typename E::Shared& shared, const typename E::Data& data,
                         const NodeState<double>* x, const Vec6* given, Vec6* set,
                         typename E::template Output<double>& out) {
  { E::point_count(shared) } -> std::convertible_to<int>;
  { E::evaluate_mixed(shared, data, x, given, out) } -> std::convertible_to<double>;
  E::linearized_resultants(shared, data, x, given, set);
};

}  // namespace mbd
