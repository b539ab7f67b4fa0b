#include "tests/elements/laws.hpp"

#include "elements/beam/beam_classical.hpp"
#include "elements/beam/beam_elastic_batch.hpp"
#include "elements/metrics.hpp"

namespace mbd::laws {
Pose<D1> seeded(const Pose<double>& H, const Vec6& U) {
  const Quaternion<double> dp = H.p * Quaternion<double>(0.0, 0.5 * U(3), 0.5 * U(4), 0.5 * U(5));
  const Vec3 dr = H.p * Vec3(linear(U));
  Pose<D1> G;
  G.p = Quaternion<D1>(D1(H.p.w(), dp.w()), D1(H.p.x(), dp.x()), D1(H.p.y(), dp.y()),
                       D1(H.p.z(), dp.z()));
  for (Index i = 0; i < 3; ++i) G.r(i) = D1(H.r(i), dr(i));
  return G;
}

Vector6<D1> seeded(const Vec6& V, const Vec6& dV) {
  Vector6<D1> x;
  for (Index i = 0; i < 6; ++i) x(i) = D1(V(i), dV(i));
  return x;
}

VecX units(Index rows, double l) {
  VecX u(rows);
  for (Index i = 0; i < rows; ++i) u(i) = i % 6 < 3 ? 1.0 : l;
  return u;
}

MatrixXd scaled(const MatrixXd& K, double l) {
  return units(K.rows(), l).cwiseInverse().asDiagonal() * K *
         units(K.cols(), l).cwiseInverse().asDiagonal();
}

double force_size(const VecX& r, double l) {
  return r.cwiseQuotient(units(r.size(), l)).cwiseAbs().maxCoeff();
}

double tangent_size(const MatrixXd& K, double l) { return scaled(K, l).cwiseAbs().maxCoeff(); }

double tangent_error(const MatrixXd& got, const MatrixXd& want, double l) {
  return tangent_size(got - want, l) / tangent_size(want, l);
}

Vec6 resultant(const VecX& F, const std::vector<Pose<double>>& H) {
  Vec6 sum = Vec6::Zero();
  for (std::size_t a = 0; a < H.size(); ++a) {
    const Vec6 f = F.segment<6>(6 * static_cast<Index>(a));
    const Vec3 n = H[a].p * linear(f), m = H[a].p * angular(f);
    sum += six<double>(n, m + (H[a].r - H[0].r).cross(n));
  }
  return sum;
}

MatrixXd skew_part(const VecX& F) {
  MatrixXd W = MatrixXd::Zero(F.size(), F.size());
  for (Index a = 0; a < F.size(); a += 6) W.block<6, 6>(a, a) = wrench_hat<double>(F.segment<6>(a));
  return W;
}

double max_angle(const std::vector<Pose<double>>& H) {
  double angle = 0;
  for (std::size_t j = 0; j < H.size(); ++j) {
    for (std::size_t k = j + 1; k < H.size(); ++k) {
      const Quaternion<double> p = H[j].p.conjugate() * H[k].p;
      angle = std::max(angle, 2 * std::atan2(p.vec().norm(), std::abs(p.w())));
    }
  }
  return angle;
}

void set_rotations(std::vector<Pose<double>>& H, const std::vector<Vec3>& phi, double angle) {
  double factor = 1e-6;
  for (int i = 0; i < 60; ++i) {
    for (std::size_t k = 0; k < H.size(); ++k) H[k].p = exp_so3<double>(factor * phi[k]);
    const double now = max_angle(H);
    if (i == 59 || std::abs(now - angle) < 1e-13 * angle) break;
    factor *= angle / now;
  }
}

Beam random_beam(Rng& rng, Metric metric, Form form, Rule rule, int order, double range,
                 double angle) {
  using test::uniform;
  const SpectralTable table = spectral_table(order, rule);
  const double length = test::log_uniform(rng, 1e-2, 1e2),
               stiffness = test::log_uniform(rng, 1, 1e9);
  Beam beam{metric, form, rule, order, length, {}, {}, {}, {}};
  const std::size_t points = uniform(rng, 0, 1) < 0.5 ? 1 : table.rule.points.size();
  for (std::size_t i = 0; i < points; ++i)
    beam.D.push_back(test::random_spd(rng, stiffness, length));

  const Pose<double> G = test::random_pose(rng, length);
  const Vec3 turn = uniform(rng, 0, 0.3 * range) * test::random_direction(rng),
             bow = test::random_vector<3>(rng, 0.1);
  const Vec3 a = test::random_vector<3>(rng), b = test::random_vector<3>(rng);
  const bool smooth = uniform(rng, 0, 1) < 0.5, near = uniform(rng, 0, 1) < 0.25;
  const double displacement = test::log_uniform(rng, 1e-12, 0.5);
  std::vector<Vec3> phi;
  for (std::size_t k = 0; k <= static_cast<std::size_t>(order); ++k) {
    const double s = 0.5 * (1 + table.nodes.points[k]);
    beam.J.push_back(0.5 * length * (1 + uniform(rng, -0.1, 0.1)));
    beam.reference.push_back(G * Pose<double>{exp_so3<double>(s * turn + 0.1 * s * s * bow),
                                              length * (s * Vec3::UnitX() + s * s * bow)});
    Pose<double> H;
    H.r = length * (s * Vec3::UnitX() + displacement * test::random_vector<3>(rng));
    beam.pose.push_back(H);
    phi.push_back(smooth ? Vec3(s * a + s * s * b) : test::random_vector<3>(rng));
  }
  set_rotations(beam.pose, phi, angle);
  if (near) {
    const double u = std::min(displacement, 0.1 * range);
    for (std::size_t k = 0; k < beam.pose.size(); ++k) {
      Vec6 U = test::random_vector<6>(rng, u);
      U.head<3>() *= length;
      beam.pose[k] = beam.reference[k] * exp_se3(U);
    }
  }
  const Pose<double> motion = test::random_pose(rng, length);
  for (auto& H : beam.pose) {
    H = motion * H;
    if (uniform(rng, 0, 1) < 0.5) H.p.coeffs() *= -1.0;  // the same rotation
  }
  return beam;
}

std::vector<NodeState<double>> node_states(const std::vector<Pose<double>>& pose) {
  std::vector<NodeState<double>> x;
  for (const auto& H : pose) x.push_back({H, Vec6::Zero(), Vec6::Zero()});
  return x;
}

Vec6 curvature_of(const std::function<Pose<D1>(const D1&)>& curve, double s) {
  const Pose<D1> H = curve(D1(s, 1.0));
  const Matrix3<D1> R = H.R();
  Mat3 R0, dR;
  Vec3 dr;
  for (Index i = 0; i < 3; ++i) {
    dr(i) = H.r(i).d;
    for (Index j = 0; j < 3; ++j) R0(i, j) = R(i, j).v, dR(i, j) = R(i, j).d;
  }
  return six<double>(R0.transpose() * dr, axial<double>(R0.transpose() * dR));
}

namespace {

template <class S>
Pose<S> smooth_reference(const S& s) {
  Vector6<S> U;
  U << s, S(0), S(0), S(0.2) * s, S(-0.5) * s, S(0.6) * s;
  return exp_se3(U);
}
template <class S>
Pose<S> smooth_pose(const S& s) {
  using std::cos, std::sin;
  const Vector3<S> phi(S(0.8) * s + S(0.2) * sin(S(3) * s), S(0.3) * s * s - S(0.6) * s,
                       s - S(0.2) * cos(S(2) * s));
  const Vector3<S> r(S(1.1) * s, S(0.2) * sin(S(2) * s),
                     S(0.15) * s * s * s - S(0.1) * cos(S(2.5) * s));
  return {exp_so3(phi), r};
}

}  // namespace

Vec6 smooth_field(int n, double s) {
  Vec6 eta;
  for (int i = 0; i < 6; ++i) eta(i) = std::sin((1.0 + 0.3 * i + n) * s + 0.7 * i * n + 0.5 * i);
  return eta;
}

Beam smooth_element(Metric metric, Form form, int order, int e, int n, const Mat6& D) {
  const double h = 1.0 / n;
  Beam b{metric, form, Rule::gauss, order, h, {}, {}, {}, {D}};
  for (const double xi : gauss_lobatto_rule(order + 1).points) {
    const double s = h * (e + 0.5 * (1 + xi));
    b.J.push_back(0.5 * h);
    b.reference.push_back(smooth_reference(s));
    b.pose.push_back(smooth_pose(s));
  }
  return b;
}

BeamSystem::BeamSystem(const Beam& beam, bool run_time_order) {
  auto batch =
      beam.kinematics == Kinematics::classical
          ? make_beam_classical(beam.rule, beam.order, run_time_order)
          : make_beam_elastic(beam.metric, beam.form, beam.rule, beam.order, run_time_order);
  std::vector<int> nodes;
  for (const auto& H : beam.reference)
    nodes.push_back(static_cast<int>(system_.add_node("node", H)));
  const int first = batch->add_stiffness(beam.D[0]);
  for (std::size_t i = 1; i < beam.D.size(); ++i) batch->add_stiffness(beam.D[i]);
  batch->add_element(beam.J, beam.reference, nodes, first, beam.D.size() > 1 ? 1 : 0,
                     "element 'x'");
  batch_ = batch.get();
  system_.add_batch(std::move(batch));
  system_.finish(false, beam.length);
  dense_.analyze(system_.graph());
}
State BeamSystem::state(const std::vector<Pose<double>>& pose) const {
  State s = system_.reference_state();
  for (std::size_t k = 0; k < pose.size(); ++k) s.pose[k + 1] = pose[k];
  return s;
}
BeamValue BeamSystem::operator()(const std::vector<Pose<double>>& pose) {
  const State s = state(pose);
  BeamValue v;
  VecX r;
  v.in_range = system_.linearize(s, {}, r, dense_);
  v.r = r.tail(r.size() - 6);
  v.K = dense_.matrix();
  v.energy = system_.energies(s).strain;
  return v;
}
VecX BeamSystem::residual(const std::vector<Pose<double>>& pose) const {
  VecX r;
  system_.residual(state(pose), r);
  return r.tail(r.size() - 6);
}
Vec6 BeamSystem::resultants(const std::vector<Pose<double>>& pose, double xi) const {
  const std::vector<double>& points = batch_->table().rule.points;
  std::vector<Vec6> S(points.size());
  batch_->resultants(state(pose), 0, S);
  const VecX l = lagrange(points, xi);
  Vec6 sum = Vec6::Zero();
  for (std::size_t i = 0; i < S.size(); ++i) sum += l(static_cast<Index>(i)) * S[i];
  return sum;
}
double BeamSystem::energy(const std::vector<Pose<double>>& pose) const {
  return system_.energies(state(pose)).strain;
}

namespace {

#ifdef MBD_RUNTIME_ORDER_ONLY  // sanitizers: slow, and the two sizes of kernel are one
constexpr int samples_divided_by = 4;
#else
constexpr int samples_divided_by = 1;
#endif

std::vector<Pose<double>> moved(const Pose<double>& G, std::vector<Pose<double>> H) {
  for (auto& one : H) one = G * one;
  return H;
}

// Motion parameters q of a relative pose and T^-1(q).
struct PairOfNodes {
  Vec6 q;
  Mat6 T_inverse;
};
template <class MetricType>
PairOfNodes pair_of(const Pose<double>& g) {
  const typename MetricType::template Pair<double> pair(g);
  return {pair.q(), pair.T_inverse().matrix()};
}
PairOfNodes pair_of(Metric metric, const Pose<double>& g) {
  switch (metric) {
    case Metric::matrix:
      return pair_of<MatrixMetric>(g);
    case Metric::quaternion:
      return pair_of<QuaternionMetric>(g);
    case Metric::geodesic:
      break;
  }
  return pair_of<GeodesicMetric>(g);
}

// The equations of NOTATION.md 3 as they stand there (HB 19, 20, 22, 39), dense and slow; the kernels
// sum over pairs instead.
struct Written {
  VecX F;
  double energy = 0.0;
  std::vector<Vec6> S;  // sectional forces at the quadrature points
};
Written written(const Beam& b) {
  const SpectralTable t = spectral_table(b.order, b.rule);
  const Index n = b.order + 1;
  const auto at = [](Index i) { return static_cast<std::size_t>(i); };
  const auto pair = [&](const std::vector<Pose<double>>& H, Index j, Index k) {
    return pair_of(b.metric, inverse(H[at(j)]) * H[at(k)]);
  };
  std::vector<Vec6> K(at(n), Vec6::Zero()), K0(at(n), Vec6::Zero());
  MatrixXd B = MatrixXd::Zero(6 * n, 6 * n);
  for (Index j = 0; j < n; ++j) {
    const double J = b.J[at(j)];
    for (Index k = 0; k < n; ++k) {
      if (k == j) continue;
      K[at(j)] += t.d(j, k) / J * pair(b.pose, j, k).q;
      K0[at(j)] += t.d(j, k) / J * pair(b.reference, j, k).q;
      B.block<6, 6>(6 * j, 6 * k) = t.d(j, k) / J * pair(b.pose, j, k).T_inverse;
      B.block<6, 6>(6 * j, 6 * j) -= t.d(j, k) / J * pair(b.pose, k, j).T_inverse;  // T^-1(-q_jk)
    }
  }
  Written w{VecX::Zero(6 * n), 0.0, {}};
  for (std::size_t i = 0; i < t.rule.points.size(); ++i) {
    const VecX l = lagrange(t.nodes.points, t.rule.points[i]);
    const VecX dl = lagrange_derivative(t.nodes.points, t.rule.points[i]);
    Vec6 full = Vec6::Zero(), strain = Vec6::Zero();
    double J = 0;
    for (Index j = 0; j < n; ++j) {
      full += l(j) * K[at(j)];
      strain += l(j) * (K[at(j)] - K0[at(j)]);
      J += l(j) * b.J[at(j)];
    }
    const Vec6 S = b.D[b.D.size() > 1 ? i : 0] * strain;
    w.S.push_back(S);
    w.energy += 0.5 * t.rule.weights[i] * J * strain.dot(S);
    for (Index a = 0; a < n; ++a) {
      if (b.form == Form::paper) {
        w.F.segment<6>(6 * a) +=
            t.rule.weights[i] * (dl(a) * S + J * l(a) * (twist_hat(full).transpose() * S));
      } else {
        w.F += B.middleRows<6>(6 * a).transpose() * (t.rule.weights[i] * J * l(a) * S);
      }
    }
  }
  return w;
}

}  // namespace

State state_of(const std::vector<NodeState<double>>& x, const Environment& env) {
  State state;
  state.t = env.t;
  state.load_factor = env.load_factor;
  state.signals.assign(env.signals.begin(), env.signals.end());
  state.angles.assign(env.angles.begin(), env.angles.end());
  state.momentum_rate = env.momentum_rate;
  state.pose.emplace_back();
  state.V.push_back(Vec6::Zero());
  state.Vdot.push_back(Vec6::Zero());
  for (const NodeState<double>& node : x) {
    state.pose.push_back(node.H);
    state.V.push_back(node.V);
    state.Vdot.push_back(node.Vdot);
  }
  return state;
}

BatchValue linearized(Batch& batch, const State& state, RateWeights w) {
  const Index n = 6 * static_cast<Index>(state.pose.size());
  BlockGraph graph;
  batch.connect(graph);
  const auto tangent = [&](const TangentWeights& weights, BatchValue& v) {
    MatrixXd S = MatrixXd::Zero(n - 6, n - 6);
    std::vector<Slot> slots;
    for (const auto& [row, column] : graph.contributions)
      slots.push_back({&S(6 * row, 6 * column), S.outerStride()});
    VecX r = VecX::Zero(n);
    v.in_range = batch.linearize(state, weights, r, slots);
    EXPECT_TRUE(v.r.size() == 0 || v.r == r.tail(n - 6));
    v.r = r.tail(n - 6);
    return S;
  };
  BatchValue v;
  v.K = tangent({.U = 1.0, .V = 0.0, .A = 0.0, .T_inv = {}}, v);
  v.D = tangent({.U = 0.0, .V = w.V, .A = w.A, .T_inv = {}}, v);
  return v;
}

VecX residual_of(const Batch& batch, const State& state) {
  VecX r = VecX::Zero(6 * static_cast<Index>(state.pose.size()));
  return batch.residual(state, r) ? VecX(r.tail(r.size() - 6)) : VecX();
}

BeamLaws BeamLaws::classical() {
  BeamLaws laws(Metric::geodesic, Form::energy);
  laws.kinematics_ = Kinematics::classical;
  return laws;
}

double BeamLaws::largest_angle() const {
  if (kinematics_ == Kinematics::classical) return beam::ClassicalRange::max_angle;
  switch (metric_) {
    case Metric::matrix:
      return MatrixMetric::max_angle;
    case Metric::quaternion:
      return QuaternionMetric::max_angle;
    case Metric::geodesic:
      break;
  }
  return GeodesicMetric::max_angle;
}

Beam BeamLaws::random(Rng& rng, Rule rule, int order, double angle) const {
  Beam b = random_beam(rng, metric_, form_, rule, order, largest_angle(), angle);
  b.kinematics = kinematics_;
  return b;
}

void BeamLaws::sample(int count, const std::function<void(Rng&, const Beam&)>& f) const {
  count = std::max(1, count / samples_divided_by);
  Rng rng(21);
  for (int order = 1; order <= beam::max_order; ++order)
    for (const Rule rule : {Rule::gauss, Rule::gauss_lobatto})
      for (int i = 0; i < count; ++i) {
        const double angle = i == 0 ? largest_angle() * (1 - 1e-6)
                                    : test::random_angle(rng, largest_angle() * (1 - 1e-6));
        Beam b = random(rng, rule, order, angle);
        // Nodes turned at random may have no classical interpolation, at any of these angles.
        while (kinematics_ == Kinematics::classical && !BeamSystem(b, true)(b.pose).in_range)
          b = random(rng, rule, order, angle);
        f(rng, b);
      }
}

std::string BeamLaws::name(const Beam& b) {
  return "N = " + std::to_string(b.order) +
         (b.rule == Rule::gauss ? ", Gauss" : ", Gauss-Lobatto") + ", largest angle " +
         testing::PrintToString(max_angle(b.pose)) + ", length " + testing::PrintToString(b.length);
}

void BeamLaws::tangent_is_the_derivative() const {
  Worst fixed("fixed_size", 1e-12), run_time("run_time_size", 1e-12);
  sample(8, [&](Rng&, const Beam& b) {
    const MatrixXd want = dual_tangent(b);
    fixed.add(tangent_error(BeamSystem(b, false)(b.pose).K, want, b.length), name(b));
    run_time.add(tangent_error(BeamSystem(b, true)(b.pose).K, want, b.length), name(b));
  });
}

// Either a stiffness that is 10 % off in one entry, or no geometric part: neither goes unnoticed. The
// geometric part is left out by a reference that is the state itself.
void BeamLaws::tangent_fails_under_mutation() const {
  int geometric = 0, total = 0;
  sample(2, [&](Rng&, const Beam& b) {
    const MatrixXd want = dual_tangent(b);
    Beam mutant = b;
    for (Mat6& D : mutant.D) D(1, 1) *= 1.1;
    EXPECT_GT(tangent_error(BeamSystem(mutant, false)(b.pose).K, want, b.length), 1e-6) << name(b);
    mutant = b;
    mutant.reference = b.pose;
    geometric += tangent_error(BeamSystem(mutant, false)(b.pose).K, want, b.length) > 1e-6;
    ++total;
  });
  // unless the state is next to the reference
  EXPECT_GT(geometric, (2 * total) / 3);
}

void BeamLaws::residual_is_the_same_with_and_without_tangent() const {
  int same = 0, total = 0;
  sample(8, [&](Rng&, const Beam& b) {
    for (const bool run_time : {false, true}) {
      BeamSystem s(b, run_time);
      const VecX with = s(b.pose).r, without = s.residual(b.pose);
      same += (with.array() == without.array()).all();  // NaN is not equal to itself
      ++total;
    }
  });
  EXPECT_EQ(same, total) << "to the last bit";
}

void BeamLaws::sizes_agree() const {
  Worst force("force", 16), tangent("tangent", 32 * eps), energy("energy", 16);
  sample(8, [&](Rng&, const Beam& b) {
    const BeamValue fixed = BeamSystem(b, false)(b.pose), run_time = BeamSystem(b, true)(b.pose);
    const double K = tangent_size(run_time.K, b.length), F = force_size(run_time.r, b.length);
    const double dU = eps * b.length;
    force.add(force_size(fixed.r - run_time.r, b.length) / (K * dU + eps * F), name(b));
    tangent.add(tangent_error(fixed.K, run_time.K, b.length), name(b));
    // dphi = F dU, and second order at the reference
    energy.add(std::abs(fixed.energy - run_time.energy) / ((F + K * dU) * dU + eps * fixed.energy),
               name(b));
  });
}

// Body-frame forces do not change under a rigid motion of all nodes. One rounding of a position far away
// is worth eps * distance.
void BeamLaws::objectivity() const {
  Worst force("force", 16), tangent("tangent", 16), energy("energy", 16);
  sample(8, [&](Rng& rng, const Beam& b) {
    BeamSystem s(b, false);
    const BeamValue here = s(b.pose);
    const double distance = b.length * test::log_uniform(rng, 1, 1e6);
    const Pose<double> G = test::random_pose(rng, distance);
    const BeamValue there = s(moved(G, b.pose));
    const double K = tangent_size(here.K, b.length), unit = eps * K * (b.length + distance);
    force.add(force_size(there.r - here.r, b.length) / (unit + eps * force_size(here.r, b.length)),
              name(b));
    tangent.add(tangent_size(there.K - here.K, b.length) / (eps * K * (1 + distance / b.length)),
                name(b));
    // dphi = F dU, and second order at the reference
    const double dU = eps * (b.length + distance);
    energy.add(std::abs(there.energy - here.energy) /
                   ((force_size(here.r, b.length) + K * dU) * dU + eps * here.energy),
               name(b));
  });
}

void BeamLaws::rigid_motion_costs_nothing() const {
  Worst force("force", 32), energy("energy", 128);
  sample(8, [&](Rng& rng, const Beam& b) {
    BeamSystem s(b, false);
    const BeamValue v = s(moved(test::random_pose(rng, b.length), b.reference));
    const double unit = eps * tangent_size(v.K, b.length) * b.length;
    force.add(force_size(v.r, b.length) / unit, name(b));
    energy.add(v.energy / (unit * eps * b.length), name(b));
    EXPECT_GT(s(b.pose).energy, 0.0);
  });
}

void BeamLaws::force_is_as_written() const {
  Worst force("force", 32), energy("energy", 32), resultants("resultants", 32);
  double mutated = INFINITY;
  sample(8, [&](Rng&, const Beam& b) {
    BeamSystem s(b, false);
    const BeamValue v = s(b.pose);
    const Written w = written(b);
    const double unit = eps * (tangent_size(v.K, b.length) * b.length + force_size(w.F, b.length));
    force.add(force_size(v.r - w.F, b.length) / unit, name(b));
    energy.add(std::abs(v.energy - w.energy) / (unit * b.length), name(b));
    const SpectralTable t = spectral_table(b.order, b.rule);
    for (std::size_t i = 0; i < w.S.size(); ++i)
      resultants.add(force_size(s.resultants(b.pose, t.rule.points[i]) - w.S[i], b.length) / unit,
                     name(b));
    if (force_size(v.r, b.length) > 1e6 * unit) {
      Beam mutant = b;
      for (Mat6& D : mutant.D) D(1, 1) *= 1.1;
      mutated = std::min(mutated, force_size(v.r - written(mutant).F, b.length) / unit);
    }
  });
  EXPECT_GT(mutated, 1e3) << "D 10 % off in one entry may pass unnoticed";
}

// A straight beam rolled up by end moments: exact for the geodesic metric, at any order.
void BeamLaws::rolls_up_exactly() const {
  Worst energy("energy", 64 * eps), force("force", 64 * eps), resultants("resultants", 64 * eps);
  for (int order = 1; order <= beam::max_order; ++order) {
    for (const Rule rule : {Rule::gauss, Rule::gauss_lobatto}) {
      const double length = 2.0, bend = 3.0;
      Mat6 D = Mat6::Zero();
      D.diagonal() << 5, 3, 2, 1, 1.5, 0.7;
      Beam b{Metric::geodesic, form_, rule, order, length, {}, {}, {}, {D}};
      const double kappa = std::min(bend, 0.9 * largest_angle()) / length;
      for (const double xi : gauss_lobatto_rule(order + 1).points) {
        const double s = 0.5 * length * (1 + xi);
        b.J.push_back(0.5 * length);
        b.reference.push_back({{1, 0, 0, 0}, s * Vec3::UnitX()});
        b.pose.push_back({test::rotation(kappa * s, Vec3::UnitZ()),
                          Vec3(std::sin(kappa * s), 1 - std::cos(kappa * s), 0) / kappa});
      }
      BeamSystem system(b, false);
      const double M = 0.7 * kappa;
      VecX want = VecX::Zero(6 * (order + 1));
      want(5) = -M;
      want(want.size() - 1) = M;
      force.add(force_size(system.residual(b.pose) - want, 1.0) / (order * order), name(b));
      energy.add(std::abs(system.energy(b.pose) - 0.5 * M * kappa * length), name(b));
      for (const double xi : {-1.0, -0.3, 0.8})
        resultants.add((system.resultants(b.pose, xi) - Vec6::Unit(5) * M).norm() / (order * order),
                       name(b));
    }
  }
}

// A free element at its reference: six zero singular values and no more.
void BeamLaws::rank() const {
  Worst zero("zero", 1e-14);
  double smallest = 1;
  sample(4, [&](Rng&, const Beam& b) {
    BeamSystem s(b, false);
    const VecX sigma = test::dense::singular_values(scaled(s(b.reference).K, b.length));
    const Index n = sigma.size();
    zero.add(sigma(n - 6) / sigma(0), name(b));
    smallest = std::min(smallest, sigma(n - 7) / sigma(0));
  });
  EXPECT_GT(smallest, 1e-7);
  testing::Test::RecordProperty("smallest", testing::PrintToString(smallest));
}

// In range exactly where no two nodes are turned further than the limit, and by name.
void BeamLaws::range() const {
  Rng rng(23);
  for (int order = 1; order <= beam::max_order; ++order) {
    for (const double factor : {1 - 1e-9, 1 + 1e-9, 1.02}) {
      Beam b = random(rng, Rule::gauss, order, 0.5 * largest_angle());
      std::vector<Vec3> phi;
      for (std::size_t k = 0; k < b.pose.size(); ++k)
        phi.push_back(static_cast<double>(k) * Vec3::UnitZ() + test::random_vector<3>(rng, 0.3));
      set_rotations(b.pose, phi, factor * largest_angle());
      ASSERT_NEAR(max_angle(b.pose) / largest_angle(), factor, 1e-12);
      BeamSystem s(b, false);
      VecX r;
      const State state = s.state(b.pose);
      EXPECT_EQ(s(b.pose).in_range, factor < 1) << name(b);
      EXPECT_EQ(s.system().residual(state, r), factor < 1) << name(b);
      EXPECT_EQ(s.system().out_of_range(state), factor < 1 ? "" : "element 'x'") << name(b);
    }
  }
}

// The energy of a smooth strained curve, order 2N in the size of the elements.
void BeamLaws::energy_converges_to_the_continuum() const {
  Rng rng(32);
  const Mat6 D = test::random_spd(rng, 1.0, 1.0);
  const auto energy_of = [](const Mat6& stiffness) {
    double sum = 0;
    const Quadrature q = gauss_rule(40);
    for (std::size_t i = 0; i < q.points.size(); ++i) {
      const double s = 0.5 * (1 + q.points[i]);
      const Vec6 E = curvature_of([](const D1& x) { return smooth_pose(x); }, s) -
                     curvature_of([](const D1& x) { return smooth_reference(x); }, s);
      sum += 0.25 * q.weights[i] * E.dot(stiffness * E);
    }
    return sum;
  };
  Mat6 mutant = D;
  mutant(1, 1) *= 1.1;
  const double exact = energy_of(D);
  EXPECT_GT(std::abs(energy_of(mutant) / exact - 1), 1e-3);
  for (int order = 1; order <= 4; ++order) {
    const auto error = [&](int elements) {
      double sum = 0;
      for (int e = 0; e < elements; ++e) {
        Beam b = smooth_element(metric_, Form::energy, order, e, elements, D);
        b.kinematics = kinematics_;
        sum += BeamSystem(b, false).energy(b.pose);
      }
      return std::abs(sum / exact - 1);
    };
    const double coarse = error(8), fine = error(16), slope = std::log2(coarse / fine);
    EXPECT_NEAR(slope, 2 * order, 0.15) << "N = " << order << ", error " << fine;
    EXPECT_LT(fine, 0.01);
    testing::Test::RecordProperty("slope" + std::to_string(order), testing::PrintToString(slope));
  }
}

}  // namespace mbd::laws
