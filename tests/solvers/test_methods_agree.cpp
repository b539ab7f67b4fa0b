// IDA, which shares nothing of the integration with Radau IIA, finds the same motion on every dynamic model.
//
// Difference: the largest, over 50 times evenly spread and all nodes, of positions over the length of the scene and of
// rotations in radians; Radau at a tolerance a hundred times finer. IDA's tolerance is of the local error, and the
// motion amplifies what is left of it: `factor` is what of it may remain at the end, about three times what was
// measured when the test was written. Durations end where IDA becomes slow (stretching waves of beams) or fails
// (windows: its first change point is at 0.714 s).
#include <cmath>
#include <ostream>

#include "libmbd/compile/time_stepping.hpp"
#include "tests/support/stepping.hpp"

namespace mbd::test::test_methods_agree {
namespace {

struct AgreementCase {
  const char* model;
  double duration;   // [s]
  double tolerance;  // of IDA
  double factor;
};
void PrintTo(const AgreementCase& c, std::ostream* out) { *out << c.model; }

using Motion = std::vector<std::vector<Pose<double>>>;

Motion motion(const AgreementCase& c, TimeMethod method, double tolerance) {
  constexpr int samples = 50;
  Scene scene = model_scene(c.model);
  TransientScene& transient = *scene.transient;
  transient.method = method;
  transient.duration = c.duration;
  transient.step = std::nullopt;
  transient.tolerance = tolerance;
  transient.output_steps = false;
  transient.rho_infinity = std::nullopt;
  transient.stages = std::nullopt;
  transient.balance = std::nullopt;
  transient.newton_tolerance = std::nullopt;
  scene.expects.clear();
  const Model model = compile(scene);
  State state = start_of(scene, model), dense = state;
  const auto stepper = make_stepper(*model.system, transient);
  Motion result;
  stepper->on_substep([&](const DenseStep& step) {
    const auto time = [&] { return c.duration * static_cast<double>(result.size() + 1) / samples; };
    while (result.size() < samples && time() <= step.end() * (1.0 + 1e-12)) {
      step.at(std::min(time(), step.end()), dense);
      result.push_back(dense.pose);
    }
  });
  StepReport report = stepper->start(state);
  while (report.converged && state.t < c.duration * (1.0 - 1e-12)) report = stepper->step(state);
  EXPECT_TRUE(report.converged) << report.failure;
  EXPECT_EQ(result.size(), static_cast<std::size_t>(samples));
  return result;
}

class MethodsAgreeSlow : public testing::TestWithParam<AgreementCase> {};

TEST_P(MethodsAgreeSlow, IdaAndRadau) {
  const AgreementCase& c = GetParam();
  const Motion ida = motion(c, TimeMethod::ida, c.tolerance);
  const Motion radau = motion(c, TimeMethod::radau, 0.01 * c.tolerance);
  ASSERT_EQ(ida.size(), radau.size());
  const double length = compile(model_scene(c.model)).system->length_scale();
  double difference = 0.0;
  for (std::size_t k = 0; k < ida.size(); ++k)
    for (std::size_t n = 1; n < ida[k].size(); ++n) {
      const Pose<double>&A = ida[k][n], &B = radau[k][n];
      difference = std::max(difference, (A.r - B.r).norm() / length);
      difference = std::max(difference, log_so3<double>(A.p.conjugate() * B.p).norm());
    }
  RecordProperty("difference_over_tolerance", std::to_string(difference / c.tolerance));
  EXPECT_LE(difference, c.factor * c.tolerance) << difference / c.tolerance << " tolerances";
  EXPECT_GT(difference, 0.0);
}
INSTANTIATE_TEST_SUITE_P(Dynamic, MethodsAgreeSlow,
                         testing::Values(AgreementCase{"pendulum", 10.0, 1e-8, 500.0},
                                         AgreementCase{"heavy_top", 0.5, 1e-8, 1000.0},
                                         AgreementCase{"dzhanibekov", 10.0, 1e-8, 500.0},
                                         AgreementCase{"double_pendulum", 2.0, 1e-8, 100.0},
                                         AgreementCase{"chain", 1.0, 1e-8, 40.0},
                                         AgreementCase{"windows", 0.6, 1e-8, 5.0},
                                         AgreementCase{"free_beam", 5.0, 1e-8, 500.0},
                                         AgreementCase{"shaft", 0.25, 1e-6, 12.0},
                                         AgreementCase{"slider_crank", 0.02, 1e-6, 8.0},
                                         AgreementCase{"every_joint", 0.1, 1e-6, 5.0},
                                         AgreementCase{"double_pendulum_beams", 0.2, 1e-6, 5.0},
                                         AgreementCase{"four_bar", 2.0, 1e-6, 1.0},
                                         AgreementCase{"cart_pole", 0.4, 1e-8, 10.0}),
                         [](const auto& c) { return std::string(c.param.model); });

}  // namespace
}  // namespace mbd::test::test_methods_agree
