// The reference loop of tools/calibrate: work of the engine's kinds, with nothing but the compiler. Prints the least CPU
// time of a few repetitions [s]. What it does must not change: figures of years are told in its unit.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <map>
#include <memory>
#include <vector>

namespace {

constexpr int n = 6;
using Matrix = std::array<double, n * n>;

double used_cpu() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

struct Random {  // the same everywhere
  std::uint64_t state = 88172645463325252u;
  std::uint64_t operator()() {
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return state;
  }
  double unit() { return static_cast<double>((*this)() >> 11) * 0x1p-53; }
};

Matrix product(const Matrix& a, const Matrix& b) {
  Matrix c{};
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k) c[i * n + j] += a[i * n + k] * b[k * n + j];
  return c;
}

// An element: 6 x 6 products, and functions of angles.
struct Element {
  virtual ~Element() = default;
  virtual void assemble(Matrix& sum, double angle) const = 0;
};
template <int kind>
struct Kind : Element {
  Matrix stiffness;
  explicit Kind(Random& random) {
    for (double& x : stiffness) x = random.unit() / n;
  }
  void assemble(Matrix& sum, double angle) const override {
    Matrix turn{};
    const double s = std::sin(angle + kind), c = std::cos(angle + kind), f = std::sqrt(1.0 + s * c);
    for (int i = 0; i < n; ++i) {
      turn[i * n + i] = c / f;
      turn[i * n + (i + 1 + kind) % n] = s / f;
    }
    const Matrix all = product(product(turn, stiffness), turn);
    for (int i = 0; i < n * n; ++i) sum[i] += 1e-3 * all[i];
  }
};

// A sparse lower triangle by columns, with indices as they come: solved as factors are.
struct Triangle {
  std::vector<int> begin{0}, row;
  std::vector<double> value;
  Triangle(int size, int entries, Random& random) {
    for (int j = 0; j < size; ++j) {
      for (int e = 0; e < entries && j + 1 < size; ++e) {
        row.push_back(
            j + 1 +
            static_cast<int>(random() % static_cast<unsigned>(std::min(200, size - j - 1))));
        value.push_back(0.1 * (random.unit() - 0.5));
      }
      begin.push_back(static_cast<int>(row.size()));
    }
  }
  void solve(std::vector<double>& x) const {
    for (std::size_t j = 0; j + 1 < begin.size(); ++j)
      for (int e = begin[j]; e < begin[j + 1]; ++e)
        x[static_cast<std::size_t>(row[static_cast<std::size_t>(e)])] -=
            value[static_cast<std::size_t>(e)] * x[j];
  }
};

double work() {
  Random random;
  std::vector<std::unique_ptr<Element>> elements;
  for (int i = 0; i < 400; ++i) {
    if (i % 2 == 0)
      elements.push_back(std::make_unique<Kind<0>>(random));
    else
      elements.push_back(std::make_unique<Kind<1>>(random));
  }
  double result = 0.0;
  for (int round = 0; round < 120; ++round) {
    Matrix sum{};
    for (const auto& element : elements) element->assemble(sum, 1e-3 * round + result * 1e-9);
    result += sum[7];
  }
  // Round after round of solutions of about 1 MB.
  const Triangle triangle(6000, 12, random);
  std::vector<double> x(6000, 1.0);
  for (int round = 0; round < 100; ++round) {
    triangle.solve(x);
    for (double& one : x) one = 1.0 + std::fmod(one, 1.0);
  }
  result += x.back();
  // Maps from numbers to numbers, in memory as it comes.
  std::map<std::uint64_t, std::uint64_t> tree;
  for (int i = 0; i < 20'000; ++i) tree[random() % 1'000'000] = random();
  for (int i = 0; i < 60'000; ++i) {
    const auto found = tree.lower_bound(random() % 1'000'000);
    if (found != tree.end()) result += static_cast<double>(found->second & 1u);
  }
  return result;
}

}  // namespace

int main() {
  double least = 1e300;
  volatile double result = 0.0;  // so that the work is done
  for (int repetition = 0; repetition < 10; ++repetition) {
    const double begun = used_cpu();
    result = result + work();
    least = std::min(least, used_cpu() - begun);
  }
  std::printf("%.5f\n", least);
}
