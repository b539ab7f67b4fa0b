// Linearise and place poles: a pole on a cart is held upright by a force on the cart that a program sets a thousand times a second, from
// the state, with gains that put the poles of the linearised motion where they are wanted.
//
// Build: see CMakeLists.txt beside this file. Run: placed_poles
// Expect: the open loop has the poles +-sqrt((M + m) g/(M L)) of the closed form; from 0.2 rad the pole comes upright and the cart
// back to its place. Exit status 0 if so.
#include <mbd/mbd.hpp>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <cstdio>
#include <vector>

namespace {

// Outputs: where the cart and the pole are, and their rates; they are the states of the law.
std::string cart(double tilt) {
  char text[1200];
  std::snprintf(text, sizeof text, R"(<mbd name="cart">
  <input name="push" unit="N"/>
  <body name="cart" at="0 0 0" mass="2" inertia="0 0 0"/>
  <body name="bob" at="%.12f 0 %.12f" mass="0.5" inertia="0 0 0"/>
  <prismatic name="rail" between="ground cart" axis="1 0 0"/>
  <revolute name="pole" between="cart bob" at="0 0 0" axis="0 1 0"/>
  <load at="cart" force="push 0 0"/>
  <gravity acceleration="0 0 -9.81"/>
  <transient duration="6" step="1 ms"/>
  <record name="rail" joint="rail" quantities="displacement speed"/>
  <record name="pole" joint="pole" quantities="angle rate"/>
</mbd>)",
                0.8 * std::sin(tilt), 0.8 * std::cos(tilt));
  return text;
}

}  // namespace

int main() try {
  const mbd::Model upright = mbd::compile(mbd::read_model_text(cart(0.0), "cart"));
  const mbd::Linearization linear = mbd::linearize(upright, upright.initial);
  const mbd::ReducedMotion& r = *linear.reduced;
  // y = C x takes the place of x: y' = A y + b u.
  const Eigen::MatrixXd E = r.E, T = linear.C,
                        A = T * E.partialPivLu().solve(Eigen::MatrixXd(r.A)) * T.inverse();
  const Eigen::VectorXd b = T * E.partialPivLu().solve(Eigen::MatrixXd(r.G)).col(0);
  const double unstable = A.eigenvalues().real().maxCoeff(),
               closed_form = std::sqrt(2.5 * 9.81 / (2.0 * 0.8));

  // Ackermann: K = [0 0 0 1] [b Ab A2b A3b]^-1 p(A), p with the wanted poles -2, -2.5, -3, -3.5.
  Eigen::Matrix4d reach, p = Eigen::Matrix4d::Identity();
  for (int i = 0; i < 4; ++i)
    reach.col(i) = i == 0 ? Eigen::Vector4d(b) : Eigen::Vector4d(A * reach.col(i - 1));
  for (const double pole : {-2.0, -2.5, -3.0, -3.5})
    p = p * (A - pole * Eigen::Matrix4d::Identity());
  const Eigen::RowVector4d K = Eigen::RowVector4d(0, 0, 0, 1) * reach.inverse() * p;

  const double tilt = 0.2;
  const mbd::Scene scene = mbd::read_model_text(cart(tilt), "cart");
  const mbd::Model model = mbd::compile(scene);
  const auto stepper = mbd::make_stepper(*model.system, *scene.transient);
  const std::size_t push = mbd::input_index(model, "push"),
                    angle = mbd::output_index(model, "pole.angle");
  mbd::State state = model.initial;
  mbd::StepReport report = stepper->start(state);
  std::vector<double> y(4);
  while (report.converged && state.t < 6 - 1e-9) {
    mbd::outputs(model, state, y);
    y[angle] += tilt;  // angles of joints begin at 0
    state.inputs[push].hold(-K.dot(Eigen::RowVector4d(y[0], y[1], y[2], y[3])), state.t);
    report = stepper->step(state);
  }
  if (!report.converged) throw mbd::Error(report.failure, report.kind);
  mbd::outputs(model, state, y);
  std::printf(
      "open loop: pole at %.6f 1/s (%.6f); after 6 s the cart is at %.1e m, the pole at %.1e rad\n",
      unstable, closed_form, y[0], y[angle] + tilt);
  const bool right = std::abs(unstable - closed_form) < 1e-5 && std::abs(y[0]) < 1e-3 &&
                     std::abs(y[angle] + tilt) < 1e-3;
  return right ? 0 : 1;
} catch (const mbd::Error& error) {
  std::printf("%s (%s)\n", error.what(), std::string(mbd::name_of(error.kind())).c_str());
  return 2;
}
