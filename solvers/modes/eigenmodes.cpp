#include "solvers/modes/eigenmodes.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>

#include "libmbd/core/stop.hpp"
#include "solvers/modes/condition.hpp"
#include "solvers/statics/stability.hpp"

namespace mbd {
namespace {

using Complex = std::complex<double>;

constexpr double tiny = 1e-4;  // |l| that is not well seen, of the shift
constexpr double good_residual = 1e-6;
constexpr double unseen = 1e-14;  // share of what cancels in K that is round-off
// Of what cancels: twice the most that was seen on cantilevers of 139 to 4000 elements (as little as a sixtieth of it is lost).
constexpr double share_lost = 1e-16;

// T of (2) or (3). Motions are measured in lengths of the scene and radians, w in those times `omega`. Of (2) vectors are
// weighed by the mass: T is symmetric in that where K is, and what is left of a vector beside the motions that are known has
// no share in the softest of them, which round-off makes most of.
class ShiftInvert final : public WeightedOperator {
 public:
  ShiftInvert(const MotionPencil& motions, Complex shift, double omega)
      : motions_(motions),
        shift_(shift),
        omega_(omega),
        first_order_(motions.is_damped_or_turns()) {
    const Index n = motions.motions();
    scale_.setOnes(n);
    for (Index i = 0; i < n; i += 6) scale_.segment<3>(i).setConstant(motions.length_scale());
  }

  bool first_order() const { return first_order_; }
  // Complex arithmetic is needed, and done in real vectors [Re; Im]: T has each eigenvalue and its conjugate then.
  bool is_doubled() const { return first_order_ && shift_.imag() != 0.0; }
  Index size() const override {
    return (first_order_ ? 2 : 1) * (is_doubled() ? 2 : 1) * motions_.motions();
  }

  Eigen::MatrixXd weigh(const Eigen::MatrixXd& X) const override {
    if (first_order_) return X;
    return scale_.asDiagonal() * motions_.mass_times(Eigen::MatrixXd(scale_.asDiagonal() * X));
  }

  Eigen::MatrixXd times(const Eigen::MatrixXd& X) const override {
    stop::check();
    if (is_doubled()) {
      const Index half = X.rows() / 2;
      Eigen::MatrixXcd Z(half, X.cols());
      Z.real() = X.topRows(half);
      Z.imag() = X.bottomRows(half);
      Z = first(Z);
      Eigen::MatrixXd Y(X.rows(), X.cols());
      Y << Z.real(), Z.imag();
      return Y;
    }
    if (first_order_) return first(X);
    Eigen::MatrixXd B = motions_.mass_times(Eigen::MatrixXd(scale_.asDiagonal() * X));
    if (shift_.imag() == 0.0) {
      motions_.solve(B);
    } else {
      Eigen::MatrixXcd C = B;  // Q(s) = K - |s|^2 M is real
      motions_.solve(C);
      B = C.real();
    }
    return scale_.cwiseInverse().asDiagonal() * B;
  }

  // Eigenvalues of (1) that belong to one of T.
  std::vector<Complex> eigenvalues(Complex theta) const {
    if (first_order_) return {shift_ + 1.0 / theta};
    const Complex root = std::sqrt(shift_ * shift_ - 1.0 / theta);
    return {root, -root};
  }
  // x of an eigenvector of T.
  VecXc shape(const VecXc& v) const {
    const Index n = motions_.motions();
    VecXc x(n);
    if (is_doubled())
      x = v.head(n) + Complex(0.0, 1.0) * v.segment(2 * n, n);
    else
      x = v.head(n);
    return x.cwiseProduct(scale_.cast<Complex>());
  }

 private:
  // (3); of real or complex numbers.
  template <class Columns>
  Columns first(const Columns& z) const {
    using Scalar = typename Columns::Scalar;
    const Index n = motions_.motions();
    const Scalar s = scalar<Scalar>();
    const Columns x = scale_.asDiagonal() * z.topRows(n),
                  w = omega_ * (scale_.asDiagonal() * z.bottomRows(n));
    Columns b = motions_.mass_times(Columns(w + s * x));
    b += motions_.rate_times(x);
    b = -b;
    motions_.solve(b);
    Columns result(2 * n, z.cols());
    result.topRows(n) = scale_.cwiseInverse().asDiagonal() * b;
    result.bottomRows(n) = scale_.cwiseInverse().asDiagonal() * ((x + s * b) / omega_);
    return result;
  }
  template <class Scalar>
  Scalar scalar() const {
    if constexpr (std::is_same_v<Scalar, double>)
      return shift_.real();
    else
      return shift_;
  }
  const MotionPencil& motions_;
  Complex shift_;
  double omega_;
  bool first_order_;
  VecX scale_;
};

// Modes near a shift that has been factored, of which conjugates are left out.
ModesFound modes_at(const MotionPencil& motions, Complex shift, double omega, int count) {
  ModesFound result;
  const ShiftInvert T(motions, shift, omega);
  // Of T: conjugates, and their doubles.
  const Index each = T.is_doubled() ? 4 : T.first_order() ? 2 : 1;
  const EigenPairs pairs =
      largest_eigenpairs(T, each * count + (T.first_order() ? 2 : 1), result.work);
  result.failure = pairs.failure;
  if (!pairs.failure.empty() || pairs.values.size() == 0) return result;
  const double most = std::abs(pairs.values(0));
  for (Index i = 0; i < pairs.values.size(); ++i) {
    const Complex theta = pairs.values(i);
    if (!(std::abs(theta) > least_share * most)) continue;  // l is infinite
    VecXc x = T.shape(pairs.vectors.col(i));
    const double whole = pairs.vectors.col(i).norm();
    // The conjugate of a doubled eigenvector is none.
    constexpr double is_none = 1e-6;
    VecXc in_lengths = x;
    for (Index k = 0; k < x.size(); k += 6) in_lengths.segment<3>(k) /= motions.length_scale();
    if (!(in_lengths.norm() > is_none * whole) && T.is_doubled()) continue;
    Index at = 0;
    const double size = in_lengths.cwiseAbs().maxCoeff(&at);
    if (!(size > 0.0)) continue;
    x /= in_lengths(at);
    for (const Complex value : T.eigenvalues(theta)) {
      const double slack = 1e-9 * std::abs(value);
      const Complex l = T.first_order()
                            ? value
                            : Complex(std::abs(value.real()) < slack ? 0.0 : value.real(),
                                      std::abs(value.imag()) < slack ? 0.0 : value.imag());
      if (l.imag() < 0.0) continue;
      result.modes.push_back({l, x, pairs.residuals[static_cast<std::size_t>(i)]});
    }
  }
  return result;
}

struct Stiffness {
  Eigen::SparseMatrix<double> K, sizes;  // its entries, and their sizes
  double least;  // [rad/s] less than round-off of its largest entries makes of anything
};

// Size of what cancels in the stiffness of a mode, as the square of a frequency.
double cancelling(const SmallMotions& motions, const Eigen::SparseMatrix<double>& sizes,
                  const Mode& mode) {
  const double mass = mode.shape.dot(motions.mass_times(mode.shape)).real();
  const VecX size = mode.shape.cwiseAbs();
  return size.dot(sizes * size) / std::max(mass, 1e-300);
}

// Whether an eigenvalue is round-off of what cancels in K, or of the shift.
bool is_hidden(const SmallMotions& motions, const Stiffness& stiffness, const Mode& mode,
               double shift) {
  const double hidden =
      std::max(stiffness.least, std::sqrt(unseen * cancelling(motions, stiffness.sizes, mode)));
  // What is left of it where 1/theta takes it off: of an eigenvalue 0 with one shape (a place and its velocity) the root of
  // round-off.
  constexpr double of_shift = 1e-7;
  return std::abs(mode.eigenvalue) <= std::max(hidden, of_shift * shift);
}

// x^H A x.
Complex along(const VecXc& x, const Eigen::SparseMatrix<double>& A) {
  const VecX re = x.real(), im = x.imag(), a = A * re, b = A * im;
  return {re.dot(a) + im.dot(b), re.dot(b) - im.dot(a)};
}

// Whether a mode's forces add up to nothing along it, x^H (l^2 M + l C + K) x = 0, but for round-off of what cancels. Of what
// moves freely they do not: its eigenvalue is round-off of the factors, which none of its own forces has made.
bool answers_itself(const SmallMotions& motions, const Stiffness& stiffness, const Mode& mode) {
  constexpr double same = 1e-2;
  const VecXc& x = mode.shape;
  const Complex l = mode.eigenvalue, m = l * l * along(x, motions.mass_matrix()),
                c = l * along(x, motions.rate_matrix()), k = along(x, stiffness.K);
  const VecX size = x.cwiseAbs();
  return std::abs(m + c + k) <= same * (std::abs(m) + std::abs(c) + std::abs(k)) +
                                    unseen * size.dot(stiffness.sizes * size);
}

// Whether nothing answers a motion: its eigenvalue is hidden, or round-off, and it strains no beam (one may be so slender that its
// bending is as soft as round-off).
bool is_rigid(const SmallMotions& motions, const Stiffness& stiffness, const Mode& mode,
              double shift) {
  if (!is_hidden(motions, stiffness, mode, shift) &&
      (std::abs(mode.eigenvalue) > tiny * shift || answers_itself(motions, stiffness, mode)))
    return false;
  constexpr double none = 1e-3;
  const auto strains = [&](VecX x) {
    if (!(x.norm() > none * mode.shape.norm())) return false;
    x.conservativeResizeLike(VecX::Zero(motions.unknowns()));
    return strains_beams(motions.system(), motions.state(), x);
  };
  return !strains(mode.shape.real()) && !strains(mode.shape.imag());
}

// Modes that open constraints, which none may: of eigenvalues that are infinite, and that round-off makes finite where a system
// that damps or turns has fewer than were asked for.
class OpenModes {
 public:
  explicit OpenModes(const SmallMotions& motions)
      : weight_(motions.motions()), B_(motions.constraint_gradient()) {
    for (Index k = 0; k < weight_.size(); ++k)
      weight_(k) = k % 6 < 3 ? motions.length_scale()
                             : 1.0;  // of a motion of size 1, lengths by the scene's
    most_ = B_.cwiseAbs() * weight_;
  }

  bool operator()(const Mode& mode) const {
    constexpr double open = 1e-4;
    return opens(mode, VecX::Zero(most_.size()), open);
  }
  // By what the mode itself does in a row, so that a part that is small beside the scene counts. What is in a row may be
  // round-off of what moves elsewhere: a doubt, not a verdict.
  bool perhaps(const Mode& mode) const {
    constexpr double closed = 1e-9, round_off = 1e-10;
    return opens(mode, closed * (B_.cwiseAbs() * VecX(mode.shape.cwiseAbs())), round_off);
  }

 private:
  // By more than `most` and `share` of what the largest motion may do in a row.
  bool opens(const Mode& mode, const VecX& most, double share) const {
    const double size = mode.shape.cwiseAbs().cwiseQuotient(weight_).maxCoeff();
    const VecX opening =
        (B_ * VecX(mode.shape.real())).cwiseAbs2() + (B_ * VecX(mode.shape.imag())).cwiseAbs2();
    for (Index row = 0; row < opening.size(); ++row)
      if (std::sqrt(opening(row)) > most(row) + share * size * most_(row)) return true;
    return false;
  }

  VecX weight_, most_;
  Eigen::SparseMatrix<double> B_;
};

// Rigid motions come in pairs (a place and a velocity, a defective eigenvalue 0), and in any combination: leaves as many
// as there are. Some combinations are told apart as motions of reference points, in lengths of the scene, others by the mass: of
// a rotation about a point far from the centre and one about the centre the one sees a translation, the other not.
void leave_independent_rigid_ones(const SmallMotions& motions, std::vector<Mode>& modes) {
  constexpr double independent = 1e-3, noise = 1e-7;
  VecX scale = VecX::Ones(motions.motions());
  for (Index i = 0; i < scale.size(); i += 6)
    scale.segment<3>(i).setConstant(1.0 / motions.length_scale());
  struct Basis {
    std::vector<VecXc> q, weighed;  // q^H weighed = 1
  } by_place, by_mass;
  // What is left of x beside the basis: its size over that of x.
  const auto rest_of = [](const Basis& basis, VecXc& x, const auto& weigh) {
    const double whole = std::sqrt(std::abs(x.dot(weigh(x))));
    for (std::size_t k = 0; k < basis.q.size(); ++k) x -= basis.q[k] * basis.weighed[k].dot(x);
    return whole > 0.0 ? std::sqrt(std::abs(x.dot(weigh(x)))) / whole : 0.0;
  };
  const auto add = [](Basis& basis, const VecXc& rest, const auto& weigh) {
    const double size = std::sqrt(std::abs(rest.dot(weigh(rest))));
    if (!(size > 0.0)) return;
    basis.q.push_back(rest / size);
    basis.weighed.push_back(weigh(basis.q.back()));
  };
  const auto place = [&](const VecXc& x) {
    return VecXc(scale.cwiseAbs2().cast<Complex>().cwiseProduct(x));
  };
  const auto mass = [&](const VecXc& x) {
    return VecXc(motions.mass_matrix().cast<Complex>() * x);
  };
  std::vector<Mode> kept;
  for (Mode& mode : modes) {
    if (mode.rigid) {
      VecXc a = mode.shape, b = mode.shape;
      const double rest_a = rest_of(by_place, a, place), rest_b = rest_of(by_mass, b, mass);
      if (!(std::max(rest_a, rest_b) > independent)) continue;
      if (rest_a > noise) add(by_place, a, place);
      if (rest_b > noise) add(by_mass, b, mass);
    }
    kept.push_back(std::move(mode));
  }
  modes = std::move(kept);
}

}  // namespace

double Mode::frequency() const {
  return eigenvalue.imag() > 0.0 ? std::abs(eigenvalue) / (2.0 * std::numbers::pi) : 0.0;
}

double Mode::damping_ratio() const {
  const double size = std::abs(eigenvalue);
  return size > 0.0 ? -eigenvalue.real() / size : 0.0;
}

ModesFound find_modes_near(MotionPencil& motions, Complex shift, double expected, int count) {
  stop::check();
  const bool ok = shift.imag() == 0.0 ? motions.factor(shift.real()) : motions.factor(shift);
  if (ok) return modes_at(motions, shift, expected, count);
  ModesFound none;
  none.failure = "the matrix of the shift is singular";
  return none;
}

namespace {

// Without estimates of round-off.
struct ModeSearch {
  SmallMotions& motions;
  const Stiffness& stiffness;
  const ModeOptions& options;
  const int wanted = options.count;
  const OpenModes opens = OpenModes(motions);
  double fastest = 0.0, omega = 0.0;  // of all motions; of those that are looked for
  KrylovWork work = {};

  ModesFound run() {
    ModesFound result;
    if (motions.motions() == 0 || !(motions.mass() > 0.0)) {
      result.failure = "nothing that moves has mass";
      return result;
    }
    fastest = std::sqrt(motions.stiffness() / motions.mass());
    omega = options.expected > 0.0 ? options.expected
            : options.near > 0.0   ? options.near
            : fastest > 0.0        ? 1e-3 * fastest
                                   : 1.0;
    result = options.near > 0.0 ? near_frequency() : slowest();
    leave_true_ones(result);
    if (!(options.near > 0.0) && options.free_motions == FreeMotions::looked_for)
      add_far_faster(result);
    if (result.modes.size() > static_cast<std::size_t>(wanted))
      result.modes.resize(static_cast<std::size_t>(wanted));
    result.work = work;
    return result;
  }

  void sort(std::vector<Mode>& modes) const {
    const Complex target(0.0, options.near);
    std::stable_sort(modes.begin(), modes.end(), [&](const Mode& a, const Mode& b) {
      return std::abs(a.eigenvalue - target) < std::abs(b.eigenvalue - target);
    });
  }

  ModesFound at(Complex shift, int count) {
    ModesFound found = find_modes_near(motions, shift, omega, count);
    work += found.work;
    std::erase_if(found.modes, opens);
    sort(found.modes);
    return found;
  }

  // Of infinite eigenvalues of (1) round-off makes finite ones. What opens a constraint a little, or solves (1) badly, is looked
  // for again about its own eigenvalue, where a mode is found to its last digits and nothing else is near.
  void leave_true_ones(ModesFound& found) {
    std::vector<Mode> kept;
    for (Mode& mode : found.modes) {
      const bool is_doubtful = !mode.rigid && std::abs(mode.eigenvalue) > 0.0 &&
                               (mode.residual > good_residual || opens.perhaps(mode) ||
                                !answers_itself(motions, stiffness, mode));
      if (!is_doubtful || found_again(mode)) kept.push_back(std::move(mode));
    }
    found.modes = std::move(kept);
  }

  bool found_again(Mode& mode) {
    constexpr double beside = 1e-3, same = 1e-2;  // of the eigenvalue
    constexpr int several = 3;                    // that may be equal
    const double size = std::abs(mode.eigenvalue);
    ModesFound near = find_modes_near(motions, mode.eigenvalue * (1.0 + beside), size, several);
    work += near.work;
    const Mode* best = nullptr;
    double most = -1.0;
    for (const Mode& other : near.modes) {
      if (std::abs(other.eigenvalue - mode.eigenvalue) > same * size ||
          other.residual > good_residual || opens.perhaps(other))
        continue;
      const double overlap =
          std::abs(other.shape.dot(mode.shape)) / (other.shape.norm() * mode.shape.norm());
      if (overlap > most) most = overlap, best = &other;
    }
    if (best != nullptr) mode = *best;
    return best != nullptr;
  }

  ModesFound near_frequency() {
    ModesFound result = at({0.0, options.near}, wanted);
    if (!result.failure.empty()) result = at({0.0, options.near * (1.0 + 1e-5)}, wanted);
    return result;
  }

  // Motions that nothing answers make 0 singular, or nearly, and hide the others, or give them any shape: a spin without a
  // drive, one shape for a double eigenvalue, takes all but a few of their digits.
  ModesFound slowest() {
    if (options.free_motions == FreeMotions::some) return at(omega, wanted);
    if (!(options.expected > 0.0) && motions.is_damped_or_turns()) omega = rate_of_slowest();
    // About 0 first, and then, if it is so, about something of the size of the slowest that is answered.
    ModesFound result = at(0.0, wanted);
    const bool is_clear = result.failure.empty() &&
                          result.modes.size() >= static_cast<std::size_t>(wanted) &&
                          std::none_of(result.modes.begin(), result.modes.end(),
                                       [&](const Mode& mode) { return !is_seen(mode); });
    if (options.free_motions == FreeMotions::none) return is_clear ? result : at(omega, wanted);
    if (!is_clear) {
      double shift = beneath_the_seen(result.modes);
      result = about_slowest(shift);
      if (!result.failure.empty()) return result;
      see_far_below(result, shift);
    }
    for (Mode& mode : result.modes)
      if (mode.rigid) mode.eigenvalue = 0.0;
    sort(result.modes);
    leave_independent_rigid_ones(motions, result.modes);
    return result;
  }

  // Modes so much faster than those found that they are taken for infinite beside these (least_share), as long as there are fewer
  // than what moves has.
  void add_far_faster(ModesFound& found) {
    constexpr double far = 100.0, other = 1.001;
    const auto wanted_size = static_cast<std::size_t>(wanted);
    const Index most =
        2 * (motions.motions() - motions.system().multipliers() + std::ssize(motions.state().idle));
    const double slow = omega, bound = most_rate();
    double shift = slow;
    while (found.failure.empty() && found.modes.size() < wanted_size) {
      Index pairs = 0;  // of a shape and its rate, halves of them
      double fastest_found = 0.0;
      for (const Mode& mode : found.modes) {
        pairs += mode.rigid || mode.eigenvalue.imag() > 0.0 ? 2 : 1;
        fastest_found = std::max(fastest_found, std::abs(mode.eigenvalue));
      }
      shift = far * std::max(shift, fastest_found);
      if (pairs >= most || found.modes.empty() || shift > far * bound) break;
      omega = shift;  // the scale of their rates
      ModesFound more = at(shift, wanted);
      if (!more.failure.empty()) break;
      const auto is_known = [&](const Mode& mode) {
        return !(std::abs(mode.eigenvalue) > other * fastest_found) ||
               is_rigid(motions, stiffness, mode, shift);
      };
      std::erase_if(more.modes, is_known);
      leave_true_ones(more);
      std::move(more.modes.begin(), more.modes.end(), std::back_inserter(found.modes));
    }
    omega = slow;
  }

  // [rad/s] That no motion is faster than, but for a small factor: by each motion alone.
  double most_rate() const {
    const VecX M = motions.mass_matrix().diagonal(), K = stiffness.sizes.diagonal();
    double square = 0.0;
    for (Index i = 0; i < M.size(); ++i)
      if (M(i) > 0.0) square = std::max(square, K(i) / M(i));
    return std::sqrt(square);
  }

  // [rad/s] About, by what the inverse iteration x <- K^-1 M x shrinks: with another scale of rates eigenvectors of (3) are
  // all rate or all displacement, and what is left of the other half is round-off. (The fastest is no bound: it counts the
  // inertia of nodes that cannot turn.)
  double rate_of_slowest() const {
    if (!motions.factor(0.0)) return omega;
    constexpr int passes = 4;
    constexpr double least = 1e-6;
    Eigen::MatrixXd x = Eigen::MatrixXd::Ones(motions.motions(), 1);
    double rate = 0.0;
    for (int pass = 0; pass < passes; ++pass) {
      Eigen::MatrixXd next = motions.mass_times(x);
      motions.solve(next);
      rate = std::sqrt(x.norm() / next.norm());
      x = next.normalized();
    }
    return std::isfinite(rate) && rate > least * fastest ? rate : omega;
  }

  // About 0, that is.
  bool is_seen(const Mode& mode) const {
    return mode.residual <= blurred && !is_hidden(motions, stiffness, mode, 0.0) &&
           answers_itself(motions, stiffness, mode);
  }

  // A shift of the size of the slowest motion that is not hidden, which 1e-3 of the fastest is far from in a fine mesh; that where
  // nothing is seen.
  double beneath_the_seen(const std::vector<Mode>& modes) const {
    double slowest = std::numeric_limits<double>::infinity();
    for (const Mode& mode : modes)
      if (is_seen(mode)) slowest = std::min(slowest, 0.5 * std::abs(mode.eigenvalue));
    return std::isfinite(slowest) && slowest > 0.0 ? slowest : omega;
  }

  // With a shift, from the one given, of the size of the slowest motion that is answered.
  ModesFound about_slowest(double& shift) {
    ModesFound found;
    // Of all passes: from far away shapes of a manifold eigenvalue 0, each of a place and its velocity, are one another's.
    std::vector<Mode> rigid;
    constexpr int passes = 12;
    for (int pass = 0; pass < passes; ++pass) {
      found = at(shift, wanted + 6);
      if (!found.failure.empty()) return found;
      for (Mode& mode : found.modes) {
        mode.rigid = is_rigid(motions, stiffness, mode, shift);
        if (mode.rigid) rigid.push_back(mode);
      }
      double slowest = std::numeric_limits<double>::infinity();
      for (const Mode& mode : found.modes)
        if (!mode.rigid && std::abs(mode.eigenvalue) > tiny * shift)
          slowest = std::min(slowest, std::abs(mode.eigenvalue));
      if (!std::isfinite(slowest)) {
        shift *= 100.0;
        if (shift > 100.0 * fastest) break;
        continue;
      }
      if (slowest > 0.2 * shift && slowest < 5.0 * shift) break;
      omega = shift = 0.5 * slowest;
    }
    std::erase_if(found.modes, [](const Mode& mode) { return mode.rigid; });
    double slowest = std::numeric_limits<double>::infinity();
    for (const Mode& mode : found.modes) slowest = std::min(slowest, std::abs(mode.eigenvalue));
    // What round-off mixed with the slowest that is answered is no rigid motion; what is answered by itself, if slowly, neither.
    for (Mode& mode : rigid)
      mode.rigid = !(is_mixed(mode, slowest) && answers_itself(motions, stiffness, mode));
    std::erase_if(rigid, [&](const Mode& mode) { return mode.rigid && is_mixed(mode, slowest); });
    std::move(rigid.begin(), rigid.end(), std::back_inserter(found.modes));
    return found;
  }

  bool is_mixed(const Mode& mode, double slowest) const {
    constexpr double pure = 1e-2;  // share of another motion
    const VecX size = mode.shape.cwiseAbs();
    const double m = along(mode.shape, motions.mass_matrix()).real(),
                 k = std::abs(along(mode.shape, stiffness.K).real());
    return k > m * std::pow(pure * slowest, 2) + unseen * size.dot(stiffness.sizes * size);
  }

  // Of what is far below the shift and no free motion, the shift is lowered to see it better.
  void see_far_below(ModesFound& found, double shift) {
    ModesFound lower;
    for (Mode& mode : found.modes) {
      if (mode.rigid || std::abs(mode.eigenvalue) > tiny * shift) continue;
      if (lower.modes.empty()) lower = at(tiny * shift, wanted + 6);
      double match = 0.0;
      for (const Mode& other : lower.modes) {
        const double overlap =
            std::abs(other.shape.dot(mode.shape)) / (other.shape.norm() * mode.shape.norm());
        if (overlap > match) match = overlap, mode.eigenvalue = other.eigenvalue;
      }
      mode.rigid = is_rigid(motions, stiffness, mode, tiny * shift);
    }
  }
};

}  // namespace

ModesFound find_modes(SmallMotions& motions, const ModeOptions& options) {
  const Eigen::SparseMatrix<double> K = motions.stiffness_matrix();
  constexpr double round_off = 1e-12;  // of the fastest motion
  const double fastest =
      motions.mass() > 0.0 ? std::sqrt(motions.stiffness() / motions.mass()) : 0.0;
  const Stiffness stiffness{K, K.cwiseAbs(), round_off * fastest};
  ModesFound found = ModeSearch{motions, stiffness, options}.run();
  if (options.conditions) set_conditions(motions, found.modes);
  // Where T is not symmetric, what is left of a pair shows in the eigenvalue as it is, not squared.
  const double shows = motions.is_damped_or_turns() ? 0.0 : blurred;
  for (Mode& mode : found.modes) {
    const double square = std::norm(mode.eigenvalue);
    const double condition = mode.condition > 0.0 ? mode.condition : 1.0;
    if (!mode.rigid && square > 0.0)
      mode.round_off = std::max(
          0.5 * share_lost * condition * cancelling(motions, stiffness.sizes, mode) / square,
          mode.residual > shows ? condition * mode.residual : 0.0);
  }
  return found;
}

VecXc eigenvalues_of(Eigen::MatrixXd matrix) {
  constexpr int most_sweeps = 100;
  constexpr double worth_it = 0.95;
  bool is_balanced = false;
  for (int sweep = 0; sweep < most_sweeps && !is_balanced; ++sweep) {
    is_balanced = true;
    for (Index i = 0; i < matrix.rows(); ++i) {
      const double own = std::abs(matrix(i, i)),
                   column = std::sqrt(std::max(0.0, matrix.col(i).squaredNorm() - own * own)),
                   row = std::sqrt(std::max(0.0, matrix.row(i).squaredNorm() - own * own));
      if (!(column > 0.0) || !(row > 0.0)) continue;
      const double f = std::exp2(std::round(0.5 * std::log2(row / column)));
      if (!(std::hypot(column * f, row / f) < worth_it * std::hypot(column, row))) continue;
      is_balanced = false;
      matrix.col(i) *= f;
      matrix.row(i) /= f;
    }
  }
  return matrix.eigenvalues();
}

}  // namespace mbd
