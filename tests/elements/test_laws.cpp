// Laws of all elements on one node, on two and on coordinates of joints (elements/element_list.hpp), at random large
// motions: tangents against dual numbers, residuals the same with and without tangent, objectivity, power. Each law is
// shown to see a coefficient that is 10 % off. (Beams: test_laws_elastic_*.cpp, test_laws_damping.cpp.) What single types are
// to be by mechanics stands in test_laws_nodal.cpp.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "tests/elements/dual_tangent.hpp"
#include "tests/elements/element_cases.hpp"

namespace mbd::test::test_laws {
namespace {

using namespace mbd::laws;

constexpr RateWeights weights{1.7, 0.6};

// A random instance of an element and of its motion: all that the laws need to know of its type.
struct Sample {
  double length = 1.0;
  Nodes x;

  virtual ~Sample() = default;
  virtual Environment environment() const = 0;
  virtual MatrixXd derivative(bool of_rates) const = 0;  // of the residual, by dual numbers
  virtual std::unique_ptr<Batch> batch() const = 0;
  virtual double size() const = 0;
  virtual void mutate() = 0;
  virtual void move(const Pose<double>& G) = 0;
};

enum class Work { of_load, of_damping, stored, of_inertia };

struct Type {
  std::string name;
  int nodes;
  bool has_K, has_D, scales_with_load;
  Work work;
  std::unique_ptr<Sample> (*make)(Rng&, int i);
};
void PrintTo(const Type& type, std::ostream* out) { *out << type.name; }

template <class E>
struct SampleOf final : Sample {
  Case<E> one;

  SampleOf(Rng& rng, double l, int i) : one(rng, l) {
    length = l;
    for (int a = 0; a < E::nodes; ++a) {
      x.push_back(
          {test::random_pose(rng, l), test::random_vector<6>(rng), test::random_vector<6>(rng)});
      x.back().V.template head<3>() *= l;
      x.back().Vdot.template head<3>() *= l;
    }
    one.place(rng, i, x);
  }
  Environment environment() const override { return one.environment(); }
  MatrixXd derivative(bool of_rates) const override {
    return dual_tangent<E>(one.shared, one.data, x, environment(), of_rates, weights);
  }
  // As a model has it.
  std::unique_ptr<Batch> batch() const override {
    auto batch = std::make_unique<ElementBatch<E>>("it", one.shared);
    std::vector<int> nodes;
    for (int a = 0; a < E::nodes; ++a) nodes.push_back(a + 1);
    batch->add(one.data, nodes, "it");
    return batch;
  }
  double size() const override { return one.size(x); }
  void mutate() override { one.mutate(); }
  void move(const Pose<double>& G) override {
    one.move(G);
    for (NodeState<double>& node : x) node.H = G * node.H;
  }
};

template <class E>
constexpr Work work_of() {
  constexpr bool load = requires(Case<E> c, const NodeState<double>* x, Environment env) {
    E::load_power(c.shared, c.data, x, env);
  };
  constexpr bool damping = requires(Case<E> c, const NodeState<double>* x, Environment env) {
    E::damping_power(c.shared, c.data, x, env);
  };
  constexpr bool inertia = requires(Case<E> c, const NodeState<double>* x) {
    E::momentum(c.shared, c.data, x);
  };
  return load      ? Work::of_load
         : damping ? Work::of_damping
         : inertia ? Work::of_inertia
                   : Work::stored;
}

// A name of a test, from that of the type, which is for messages.
template <class E>
std::string name_of(std::size_t place) {
  std::string name;
  for (const char c : std::string(E::name))
    name += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  return std::to_string(place) + "_" + name;
}

template <class E>
constexpr bool scales = requires {
  E::scales_with_load;
};

template <class E>
std::unique_ptr<Sample> make(Rng& rng, int i) {
  return std::make_unique<SampleOf<E>>(rng, log_uniform(rng, 1e-2, 1e2), i);
}

template <class... E>
void add_types(ElementList<E...>, std::vector<Type>& all) {
  (all.push_back(
       {name_of<E>(all.size()), E::nodes, E::has_K, E::has_D, scales<E>, work_of<E>(), make<E>}),
   ...);
}

std::vector<Type> types() {
  std::vector<Type> all;
  add_types(NodalElements{}, all);
  add_types(PairElements{}, all);
  add_types(JointElements{}, all);
  return all;
}
std::vector<Type> types_of_pairs(bool with_rates) {
  std::vector<Type> all = types();
  std::erase_if(all, [with_rates](const Type& type) {
    return type.nodes != 2 || (with_rates && !type.has_D);
  });
  return all;
}

struct ElementLaws : testing::TestWithParam<Type> {
  static void sample(const std::function<void(Rng&, Sample&)>& f) {
    Rng rng(43);
    for (int i = 0; i < 200; ++i) f(rng, *GetParam().make(rng, i));
  }
  static State state(const Sample& s) { return state_of(s.x, s.environment()); }
  static BatchValue value(const Sample& s) {
    const BatchValue v = linearized(*s.batch(), state(s), weights);
    EXPECT_TRUE(v.in_range);
    return v;
  }
  static VecX residual(const Sample& s) {
    VecX r = residual_of(*s.batch(), state(s));
    EXPECT_EQ(r.size(), 6 * GetParam().nodes);
    return r;
  }
  static double bound(double one_node, double two_nodes) {
    return GetParam().nodes == 1 ? one_node : two_nodes;
  }
  static VecX rates(const Sample& s) {
    VecX V(6 * GetParam().nodes);
    for (std::size_t a = 0; a < s.x.size(); ++a) V.segment<6>(6 * static_cast<Index>(a)) = s.x[a].V;
    return V;
  }
};
const auto name_of_case = [](const testing::TestParamInfo<Type>& it) { return it.param.name; };
INSTANTIATE_TEST_SUITE_P(Every, ElementLaws, testing::ValuesIn(types()), name_of_case);

// With respect to poses; and to V and Vdot by their weights. A tangent that an element says it has not is zero.
TEST_P(ElementLaws, TangentsAreDerivatives) {
  Worst K("K", bound(2e-14, 1e-13)), D("D", bound(2e-14, 1e-13));
  double mutated = INFINITY;
  sample([&](Rng&, Sample& s) {
    const MatrixXd of_poses = s.derivative(false), of_rates = s.derivative(true);
    const auto error = [&](const MatrixXd& got, const MatrixXd& want, bool has) {
      if (has) return tangent_error(got, want, s.length);
      return std::max(got.cwiseAbs().maxCoeff(), want.cwiseAbs().maxCoeff());
    };
    const auto errors = [&] {
      const BatchValue v = value(s);
      return std::array{error(v.K, of_poses, GetParam().has_K),
                        error(v.D, of_rates, GetParam().has_D)};
    };
    const auto [of_K, of_D] = errors();
    K.add(of_K);
    D.add(of_D);
    s.mutate();
    const auto [wrong_K, wrong_D] = errors();
    mutated = std::min(mutated, std::max(wrong_K, wrong_D));
  });
  if (GetParam().has_K || GetParam().has_D) {
    EXPECT_GT(mutated, 1e-8) << "10 % off in one coefficient may pass unnoticed";
  }
}

TEST_P(ElementLaws, ResidualIsTheSameWithAndWithoutTangent) {
  int same = 0, total = 0;
  sample([&](Rng&, Sample& s) {
    const VecX with = value(s).r, without = residual(s);
    same += (with.array() == without.array()).all();
    ++total;
  });
  EXPECT_EQ(same, total) << "to the last bit";
}

// Turned and moved with its nodes and its field, nothing changes in the body frame.
TEST_P(ElementLaws, Objectivity) {
  Worst worst("error", bound(32 * eps, 1e-11));
  sample([&](Rng& rng, Sample& s) {
    const VecX r = residual(s);
    s.move(test::random_pose(rng, bound(1e6, 10) * s.length));
    worst.add(force_size(residual(s) - r, s.length) / (force_size(r, s.length) + bound(0.0, 1e-3)));
  });
}

// What an element says of its power is that of its residual, -r.V; what it stores is a potential of its force. What scales
// with loads is linear in their factor.
TEST_P(ElementLaws, PowerIsThatOfTheForce) {
  const Work work = GetParam().work;
  if (work == Work::of_inertia) return;  // Inertia.PowerBalance
  Worst power("power", work == Work::stored ? 1e-10 : 64 * eps), rate("load_rate", 16 * eps);
  int mutated = 0, total = 0;
  sample([&](Rng&, Sample& s) {
    const VecX r = residual(s), V = rates(s);
    const auto stated = [&] {
      const std::unique_ptr<Batch> batch = s.batch();
      const State now = state(s);
      EXPECT_TRUE(work == Work::of_damping || batch->damping_power(now) == 0.0);
      EXPECT_TRUE(work == Work::of_load || batch->load_power(now) == 0.0);
      if (work == Work::of_damping) return -batch->damping_power(now);
      if (work == Work::of_load) return -batch->load_power(now);
      const auto energy = [&](double step) {
        State moved = now;
        for (std::size_t a = 0; a < s.x.size(); ++a)
          moved.pose[a + 1] = s.x[a].H * exp_se3<double>(Vec6(step * s.x[a].V));
        const Energies e = batch->energies(moved);
        return Eigen::Matrix<double, 1, 1>(e.strain + e.potential);
      };
      return first_difference(energy, 2e-3)(0);
    };
    double size = s.size();
    if (work == Work::stored) size += force_size(r, s.length) * s.length;
    for (Index i = 0; i < r.size(); i += 3) size += r.segment<3>(i).norm() * V.segment<3>(i).norm();
    const double want = r.dot(V);
    power.add(std::abs(stated() - want) / size);

    State still = state(s);
    still.V.clear();
    still.Vdot.clear();
    EXPECT_EQ(s.batch()->load_power(still) + s.batch()->damping_power(still), 0.0);
    VecX F = VecX::Zero(6 + r.size());
    s.batch()->load_rate(state(s), F);
    const VecX by_factor = F.tail(r.size()) * (GetParam().scales_with_load ? factor_of_cases : 1.0);
    rate.add(force_size(GetParam().scales_with_load ? VecX(by_factor - r) : by_factor, s.length) /
             force_size(r, s.length));

    s.mutate();
    mutated += std::abs(stated() - want) / size > 1e-6;
    ++total;
  });
  EXPECT_GT(mutated, (9 * total) / 10);  // unless the motion happens to be across what was changed
}

// What acts between two nodes balances.
struct PairLaws : ElementLaws {};
INSTANTIATE_TEST_SUITE_P(Every, PairLaws, testing::ValuesIn(types_of_pairs(false)), name_of_case);

TEST_P(PairLaws, Balance) {
  Worst balance("balance", 1e-13);
  sample([&](Rng&, Sample& s) {
    const VecX r = residual(s);
    balance.add(force_size(resultant(r, {s.x[0].H, s.x[1].H}), s.length) /
                (force_size(r, s.length) + 1e-3));
  });
}

// A rigid velocity makes no force of rates.
struct PairDamperLaws : ElementLaws {};
INSTANTIATE_TEST_SUITE_P(Every, PairDamperLaws, testing::ValuesIn(types_of_pairs(true)),
                         name_of_case);

TEST_P(PairDamperLaws, NoForceInRigidMotion) {
  Worst rest("rest", 1e-11);
  sample([&](Rng&, Sample& s) {
    const double size = force_size(residual(s), s.length) + 1e-3;
    s.x[1].V = adjoint_inverse(relative(s.x[0].H, s.x[1].H)) * s.x[0].V;
    rest.add(force_size(residual(s), s.length) / size);
  });
}

}  // namespace
}  // namespace mbd::test::test_laws
