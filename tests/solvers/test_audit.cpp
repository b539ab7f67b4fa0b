// The energy audit: what is in the system at the end is what was in it at the start and the work of loads and
// drives, but for what the integrator takes out.
//
// Norm: largest |E(t) - E(0) - W(t)| over all steps, divided by the largest |E(t) - E(0)| or, where gravity is
// the only force, by the largest kinetic energy. E kinetic, strain and potential; W by the trapezoidal rule.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include "tests/support/scenes.hpp"

namespace mbd::test::test_audit {
namespace {

struct Audit {
  double gap = 0.0;    // the norm above
  double taken = 0.0;  // E(0) + W - E at the end, over the same size
  double work = 0.0;   // largest |W|, over the same size
};

Audit audit(Scene scene, double step, double rho) {
  scene.transient->step = step;
  scene.transient->rho_infinity = rho;
  scene.records.clear();
  RecordScene record;
  record.name = "all";
  record.quantities = {"total_energy", "kinetic_energy", "work_of_loads", "work_of_drives"};
  scene.records.push_back(record);
  const History h = run_to_table(scene);
  EXPECT_TRUE(h.report.complete()) << h.report.failure;
  const auto& E = h.table["all.total_energy"];
  Audit a;
  double size = 0.0;
  for (std::size_t k = 0; k < E.size(); ++k) {
    const double W = h.table["all.work_of_loads"][k] + h.table["all.work_of_drives"][k];
    a.gap = std::max(a.gap, std::abs(E[k] - E[0] - W));
    a.work = std::max(a.work, std::abs(W));
    size = std::max(size, std::abs(E[k] - E[0]));
    a.taken = E[0] + W - E[k];
  }
  if (a.work == 0.0) {
    size = 0.0;
    for (const double T : h.table["all.kinetic_energy"]) size = std::max(size, T);
  }
  // The report says the same of the end.
  EXPECT_NEAR(h.report.dissipated(), a.taken, 1e-9 * size);
  a.gap /= size;
  a.taken /= size;
  a.work /= size;
  return a;
}

// Order two, with the scheme that damps nothing (or next to nothing where constraints make it unstable).
struct Case {
  const char* model;
  double duration, step, rho, bound;  // gap at a quarter of the step
  Balance balance = Balance::acceleration;
  bool works = true;
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.model; }

class EnergyAudit : public testing::TestWithParam<Case> {};
TEST_P(EnergyAudit, ClosesToOrderTwo) {
  const Case& c = GetParam();
  Scene scene = model_scene(c.model);
  scene.transient->duration = c.duration;
  scene.transient->balance = c.balance;
  const std::vector<double> h = {c.step, c.step / 2, c.step / 4};
  std::vector<double> gap;
  for (const double step : h) {
    const Audit a = audit(scene, step, c.rho);
    gap.push_back(a.gap);
    if (c.works) {
      EXPECT_GT(a.work, 0.5);
    }
  }
  EXPECT_LT(gap.back(), c.bound);
  EXPECT_GT(fitted_order(h, gap), 1.8) << testing::PrintToString(gap);
}
INSTANTIATE_TEST_SUITE_P(
    Models, EnergyAudit,
    testing::Values(Case{"free_beam", 8, 6.25e-3, 1.0, 1e-5, Balance::momentum},
                    Case{"free_beam", 8, 6.25e-3, 1.0, 1e-4, Balance::acceleration},
                    Case{"double_pendulum", 1, 4e-3, 0.95, 1e-4, Balance::acceleration, false},
                    Case{"shaft", 0.5, 2e-3, 0.9, 1e-3}, Case{"every_joint", 1, 4e-3, 0.9, 1e-3}),
    [](const auto& named) {
      return std::string(named.param.model) +
             (named.param.balance == Balance::momentum ? "_momentum" : "");
    });

// What a damping integrator takes out is positive, and seen: rho = 0 on a beam set ringing by its loads.
TEST(EnergyAuditOfDamping, IsWhatTheIntegratorTakesOut) {
  Scene scene = model_scene("free_beam");
  scene.transient->duration = 8;
  const Audit damped = audit(scene, 0.025, 0.0), kept = audit(scene, 0.025, 1.0);
  EXPECT_GT(damped.taken, 1e-4);
  EXPECT_LT(std::abs(kept.taken), 0.5 * damped.taken);
}

// A constant force on a ball: accelerations are constant, and the audit closes to round-off.
TEST(EnergyAuditOfABall, ClosesToRoundOff) {
  const Scene scene = read_model_text(R"xml(<mbd name="ball">
    <body name="ball" mass="2" inertia="1 1 1" velocity="1 2 3"/>
    <load at="ball" force="t&lt;0.2345?3:-1 2 -4"/><gravity acceleration="0 0 -9.81"/>
    <transient duration="1" step="0.01" rho_infinity="0.5" balance="acceleration"/></mbd>)xml",
                                      "ball.xml", {});
  EXPECT_LT(audit(scene, 0.01, 0.5).gap, 1e-13);
}

}  // namespace
}  // namespace mbd::test::test_audit
