#include "solvers/modes/component_modes.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <string>

#include "libmbd/core/error.hpp"
#include "libmbd/core/stop.hpp"
#include "solvers/modes/eigenmodes.hpp"

namespace mbd {
namespace {

using component::MatX;
using Sparse = Eigen::SparseMatrix<double>;
using Cholesky = Eigen::SimplicialLDLT<Sparse>;

// Sixes of rows and columns, of nodes.
Sparse submatrix(const Sparse& all, std::span<const int> rows, std::span<const int> columns) {
  std::vector<Index> row_of(static_cast<std::size_t>(all.rows()), -1);
  for (std::size_t k = 0; k < rows.size(); ++k)
    for (Index c = 0; c < 6; ++c)
      row_of[static_cast<std::size_t>(6 * (rows[k] - 1) + c)] = 6 * static_cast<Index>(k) + c;
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t k = 0; k < columns.size(); ++k)
    for (Index c = 0; c < 6; ++c)
      for (Sparse::InnerIterator it(all, 6 * (columns[k] - 1) + c); it; ++it)
        if (const Index row = row_of[static_cast<std::size_t>(it.row())]; row >= 0)
          entries.emplace_back(static_cast<int>(row),
                               static_cast<int>(6 * static_cast<Index>(k) + c), it.value());
  Sparse part(6 * static_cast<Index>(rows.size()), 6 * static_cast<Index>(columns.size()));
  part.setFromTriplets(entries.begin(), entries.end());
  return part;
}

MatX rows_of(const MatX& all, std::span<const int> places) {
  MatX some(6 * static_cast<Index>(places.size()), all.cols());
  for (std::size_t k = 0; k < places.size(); ++k)
    some.middleRows<6>(6 * static_cast<Index>(k)) = all.middleRows<6>(6 * Index{places[k]});
  return some;
}

// Of what is held at its interfaces. A pivot that is round-off of its row belongs to a motion that nothing answers.
void factor(Cholesky& solver, const Sparse& K) {
  solver.compute(K);
  constexpr double round_off = 1e-14;
  const double smallest =
      solver.info() == Eigen::Success && K.rows() > 0
          ? (solver.vectorD().array() / (solver.permutationP() * VecX(K.diagonal())).array())
                .minCoeff()
          : 1.0;
  if (solver.info() != Eigen::Success || !(smallest > round_off))
    throw Error(
        "some of its parts move freely against the others; fix them to each other with <fixed>, or "
        "leave them out");
}

// K - l M of what is held, without damping.
class HeldPencil final : public MotionPencil {
 public:
  HeldPencil(const Sparse& K, const Sparse& M, double length) : K_(K), M_(M), length_(length) {}

  Index motions() const override { return K_.rows(); }
  double length_scale() const override { return length_; }
  bool is_damped_or_turns() const override { return false; }
  MatX mass_times(const MatX& X) const override { return M_ * X; }
  MatX stiffness_times(const MatX& X) const { return K_ * X; }
  MatX rate_times(const MatX& X) const override { return MatX::Zero(X.rows(), X.cols()); }
  bool factor(double s) override {
    solver_.compute(Sparse(K_ + s * s * M_));
    return solver_.info() == Eigen::Success;
  }
  bool factor(std::complex<double>) override {
    return false;
  }  // of what is damped, or sought elsewhere
  void solve(MatX& B) const override { B = MatX(solver_.solve(B)); }
  void solve(Eigen::MatrixXcd& B) const override {
    const MatX real = solver_.solve(MatX(B.real())), imaginary = solver_.solve(MatX(B.imag()));
    B.real() = real;
    B.imag() = imaginary;
  }

 private:
  const Sparse &K_, &M_;
  double length_;
  Cholesky solver_;
};

// Modes to round-off of the matrices, by subspace iteration: what is a little off in them would be so in the element, where
// two that ought to be alike (moved, turned) are compared. `pencil` has its factors at 0.
// Returns their squared frequencies; empty where they could not be told apart.
VecX refine(const HeldPencil& pencil, MatX& shapes) {
  constexpr int times =
      8;  // after 4 parts of a pair differed by 1e-6 … 1e-3, by how well the last ones were found
  VecX squares;
  for (int i = 0; i < times; ++i) {
    stop::check();
    shapes = pencil.mass_times(shapes);
    pencil.solve(shapes);
    for (Index c = 0; c < shapes.cols(); ++c) shapes.col(c) /= shapes.col(c).cwiseAbs().maxCoeff();
    const MatX M = shapes.transpose() * pencil.mass_times(shapes),
               K = shapes.transpose() * pencil.stiffness_times(shapes);
    const Eigen::GeneralizedSelfAdjointEigenSolver<MatX> ritz(0.5 * (K + K.transpose()),
                                                              0.5 * (M + M.transpose()));
    if (ritz.info() != Eigen::Success) return squares;
    shapes = MatX(shapes * ritz.eigenvectors());
    squares = ritz.eigenvalues();
  }
  return squares;
}

// The slowest of them, in columns.
MatX held_modes(const Sparse& K, const Sparse& M, double length, int count) {
  if (count == 0) return MatX(K.rows(), 0);
  if (count > K.rows())
    throw Error("modes is " + std::to_string(count) + ", but with its interfaces fixed it has " +
                std::to_string(K.rows()) + " motions; ask for fewer, or give it more elements");
  HeldPencil pencil(K, M, length);
  // Some more are looked for, which part the last ones from those that follow.
  constexpr int more = 6;
  ModesFound found =
      find_modes_near(pencil, 0.0, 1.0, std::min(count + more, static_cast<int>(K.rows())));
  if (found.failure.empty() && found.modes.size() < static_cast<std::size_t>(count))
    found.failure = "there are " + std::to_string(found.modes.size()) + ", not " +
                    std::to_string(count) + ": the other motions have no mass";
  if (!found.failure.empty()) throw Error("its modes were not found: " + found.failure);
  std::ranges::stable_sort(found.modes, {},
                           [](const Mode& mode) { return std::abs(mode.eigenvalue); });
  MatX all(K.rows(), static_cast<Index>(found.modes.size()));
  for (Index k = 0; k < all.cols(); ++k) {
    const Mode& mode = found.modes[static_cast<std::size_t>(k)];
    Index largest = 0;
    mode.shape.cwiseAbs().maxCoeff(&largest);
    all.col(k) = (mode.shape / mode.shape(largest)).real();
  }
  const VecX squares = refine(pencil, all);
  // Of some that are equal, as those of a round section, any part would have directions of its own.
  constexpr double equal = 1e-6;
  Index kept = count;
  while (kept < squares.size() && squares(kept) <= (1.0 + equal) * squares(kept - 1)) ++kept;
  return all.leftCols(kept);
}

// Displacements over the length.
MatX weighed(MatX rows, double length) {
  for (Index k = 0; k < rows.rows(); k += 6) rows.middleRows<3>(k) /= length;
  return rows;
}

// Places in J of the nodes within: see the head of component_modes.hpp.
std::vector<int> choose_within(const MatX& shapes, double length) {
  constexpr double good = 0.01, better = 1e-6;
  std::vector<int> chosen;
  if (shapes.cols() == 0) return chosen;
  MatX all = weighed(shapes, length);
  for (Index c = 0; c < all.cols(); ++c) all.col(c) /= all.col(c).cwiseAbs().maxCoeff();
  while (true) {
    stop::check();
    MatX weak = MatX::Identity(all.cols(), all.cols());
    if (!chosen.empty()) {
      const Eigen::JacobiSVD<MatX> svd(rows_of(all, chosen), Eigen::ComputeFullV);
      VecX sizes = VecX::Zero(all.cols());
      sizes.head(svd.singularValues().size()) = svd.singularValues();
      const Index first = (sizes.array() >= good * sizes(0)).count();
      if (first == all.cols()) return chosen;
      weak = svd.matrixV().rightCols(all.cols() - first);
    }
    int best = -1;
    double most = 0.0;
    for (int k = 0; k < all.rows() / 6; ++k) {
      if (std::ranges::find(chosen, k) != chosen.end()) continue;
      const double shown = (all.middleRows<6>(6 * Index{k}) * weak).squaredNorm();
      if (shown > most * (1.0 + better)) most = shown, best = k;
    }
    if (best < 0 || chosen.size() == most_component_nodes) return chosen;  // all, or too many
    chosen.push_back(best);
  }
}

// The nodes of a part: the frame, the other interfaces, what is kept within, and the rest.
struct Nodes {
  int frame;
  std::vector<int> held, kept, rest;
};

// Rows of (1), (2) of the rest; columns of held, then kept.
MatX shapes_of_rest(const Sparse& K, const Nodes& nodes, const MatX& S_m, const MatX& F_m,
                    const MatX& F_i, double length) {
  const Index held = 6 * static_cast<Index>(nodes.held.size());
  const Index kept = 6 * static_cast<Index>(nodes.kept.size());
  MatX shapes = MatX::Zero(6 * static_cast<Index>(nodes.rest.size()), held + kept);
  if (nodes.rest.empty()) return shapes;
  Cholesky solver;
  factor(solver, submatrix(K, nodes.rest, nodes.rest));
  std::vector<int> both = nodes.held;
  both.insert(both.end(), nodes.kept.begin(), nodes.kept.end());
  if (!both.empty()) shapes = -solver.solve(MatX(submatrix(K, nodes.rest, both)));
  if (F_m.cols() == 0) return shapes;
  // F_m^+ with displacements over the length.
  const Eigen::JacobiSVD<MatX> svd(weighed(F_m, length), Eigen::ComputeThinU | Eigen::ComputeThinV);
  const MatX inverse =
      weighed(MatX(svd.solve(MatX::Identity(kept, kept)).transpose()), length).transpose();
  const MatX X = (F_i - shapes.rightCols(kept) * F_m) * inverse;
  shapes.rightCols(kept) += X;
  if (held > 0) shapes.leftCols(held) -= X * S_m;
  return shapes;
}

MatX symmetric(const MatX& A) { return 0.5 * (A + A.transpose()); }

// The matrices of the element, of the shapes of all nodes. K: of all of the part.
void set_matrices(const SmallMotions& motions, const Sparse& K, const Nodes& nodes,
                  std::span<const Mat6> mass_damping, ComponentModes& result) {
  const System& system = motions.system();
  const auto all = static_cast<Index>(system.nodes()) - 1;
  const Pose<double> frame = system.reference_pose(nodes.frame);
  MatX rigid(6 * all, 6);
  for (Index n = 1; n <= all; ++n)
    rigid.middleRows<6>(6 * (n - 1)) =
        adjoint_inverse(relative(frame, system.reference_pose(n))).matrix();
  const MatX& T = result.shapes;
  MatX of_element(T.cols(), 6);
  for (std::size_t k = 1; k < result.nodes.size(); ++k)
    of_element.middleRows<6>(6 * static_cast<Index>(k - 1)) =
        rigid.middleRows<6>(6 * Index{result.nodes[k] - 1});
  MatX whole(6 * all, 6 + T.cols());
  whole << rigid - T * of_element, T;

  component::Data& element = result.element;
  for (std::size_t k = 1; k < result.nodes.size(); ++k)
    element.A.push_back(relative(frame, system.reference_pose(result.nodes[k])));
  element.K = symmetric(T.transpose() * (K * T));
  result.M = symmetric(whole.transpose() * (motions.mass_matrix() * whole));
  const MatX of_rigid = rigid.transpose() * (motions.mass_matrix() * rigid);
  element.mass = of_rigid(0, 0);
  element.static_moment = axial<double>(Mat3(of_rigid.block<3, 3>(3, 0)));
  element.P = rigid.leftCols<3>().transpose() * (motions.mass_matrix() * T);
  if (!motions.is_damped_or_turns()) return;
  Sparse viscous = motions.rate_matrix();
  if (!mass_damping.empty()) {
    std::vector<Eigen::Triplet<double>> entries;
    for (Index n = 1; n <= all; ++n)
      for (Index i = 0; i < 6; ++i)
        for (Index j = 0; j < 6; ++j)
          entries.emplace_back(static_cast<int>(6 * (n - 1) + i), static_cast<int>(6 * (n - 1) + j),
                               mass_damping[static_cast<std::size_t>(n)](i, j));
    Sparse of_mass(6 * all, 6 * all);
    of_mass.setFromTriplets(entries.begin(), entries.end());
    element.M_a = symmetric(whole.transpose() * (of_mass * whole));
    viscous -= of_mass;
  }
  element.C = symmetric(T.transpose() * (viscous * T));
  if (element.C.isZero(0.0)) element.C.resize(0, 0);
}

}  // namespace

ComponentModes component_modes(const SmallMotions& motions, std::span<const int> interfaces,
                               int modes, std::span<const Mat6> mass_damping) {
  const System& system = motions.system();
  const double length = motions.length_scale();
  const Sparse K0 = motions.stiffness_matrix(), &M = motions.mass_matrix();
  const Sparse K = 0.5 * (K0 + Sparse(K0.transpose()));
  Nodes nodes{interfaces.front(), {interfaces.begin() + 1, interfaces.end()}, {}, {}};
  std::vector<int> within;
  for (int n = 1; n < system.nodes(); ++n)
    if (std::ranges::find(interfaces, n) == interfaces.end()) within.push_back(n);

  ComponentModes result;
  MatX S, F;  // of all within
  {
    // What is held at its frame alone does not move freely, nor what is held at all of its interfaces.
    std::vector<int> all_but_frame = nodes.held;
    all_but_frame.insert(all_but_frame.end(), within.begin(), within.end());
    Cholesky whole;
    factor(whole, submatrix(K, all_but_frame, all_but_frame));
    const Sparse K_J = submatrix(K, within, within);
    Cholesky solver;
    factor(solver, K_J);
    if (!nodes.held.empty() && !within.empty())
      S = -solver.solve(MatX(submatrix(K, within, nodes.held)));
    F = held_modes(K_J, submatrix(M, within, within), length, modes);
  }
  const std::vector<int> chosen = choose_within(F, length);
  std::vector<int> left;
  for (int k = 0; k < static_cast<int>(within.size()); ++k) {
    const bool is_kept = std::ranges::find(chosen, k) != chosen.end();
    if (!is_kept) left.push_back(k), nodes.rest.push_back(within[static_cast<std::size_t>(k)]);
  }
  for (const int k : chosen) nodes.kept.push_back(within[static_cast<std::size_t>(k)]);
  const MatX S_m = nodes.held.empty() ? MatX() : rows_of(S, chosen);
  const MatX of_rest = shapes_of_rest(K, nodes, S_m, rows_of(F, chosen), rows_of(F, left), length);

  result.nodes.assign(interfaces.begin(), interfaces.end());
  result.nodes.insert(result.nodes.end(), nodes.kept.begin(), nodes.kept.end());
  if (result.nodes.size() > most_component_nodes)
    throw Error("it would have " + std::to_string(result.nodes.size()) +
                " nodes, at each of which something acts or that its modes need; it may have " +
                std::to_string(most_component_nodes) + ": make it several parts");
  const Index unknowns = 6 * static_cast<Index>(result.nodes.size() - 1);
  result.shapes.setZero(motions.motions(), unknowns);
  for (std::size_t k = 1; k < result.nodes.size(); ++k)
    result.shapes.block<6, 6>(6 * Index{result.nodes[k] - 1}, 6 * static_cast<Index>(k - 1))
        .setIdentity();
  for (std::size_t k = 0; k < nodes.rest.size(); ++k)
    result.shapes.middleRows<6>(6 * Index{nodes.rest[k] - 1}) =
        of_rest.middleRows<6>(6 * static_cast<Index>(k));
  set_matrices(motions, K, nodes, mass_damping, result);
  return result;
}

}  // namespace mbd
