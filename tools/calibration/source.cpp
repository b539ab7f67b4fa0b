// What tools/calibrate compiles: templates as the engine's, of standard headers only. It must not change: figures of
// years are told in its unit.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

template <class L, class R, class Operation>
struct Binary {
  const L& l;
  const R& r;
  double operator[](int i) const { return Operation()(l[i], r[i]); }
};

template <int n>
struct Vector {
  std::array<double, n> x{};
  double operator[](int i) const { return x[static_cast<std::size_t>(i)]; }
  double& operator[](int i) { return x[static_cast<std::size_t>(i)]; }
  template <class E>
  Vector& operator=(const E& e) {
    for (int i = 0; i < n; ++i) x[static_cast<std::size_t>(i)] = e[i];
    return *this;
  }
};

template <class L, class R>
Binary<L, R, std::plus<>> operator+(const L& l, const R& r) {
  return {l, r};
}
template <class L, class R>
Binary<L, R, std::multiplies<>> operator*(const L& l, const R& r) {
  return {l, r};
}

template <int n>
double kernel(int steps) {
  Vector<n> a, b, c, d;
  for (int i = 0; i < n; ++i) a[i] = i, b[i] = 1.0 / (1 + i), c[i] = 0.5;
  std::map<std::string, std::vector<double>> table;
  std::vector<std::variant<int, double, std::string>> items;
  for (int k = 0; k < steps; ++k) {
    d = a * b + c * (a + b) + b * b * c;
    a = d + a * c;
    table[std::to_string(k % (n + 1))].push_back(std::sqrt(std::abs(d[0])));
    if (k % 3 == 0) items.emplace_back(k);
    if (k % 3 == 1) items.emplace_back(d[n - 1]);
    if (k % 3 == 2) items.emplace_back(std::string(n, 'a'));
  }
  double sum = 0.0;
  for (auto& [name, values] : table) {
    std::sort(values.begin(), values.end(), [](double x, double y) { return x > y + n * 1e-300; });
    sum += values.front() + static_cast<double>(name.size());
  }
  for (const auto& item : items)
    sum += std::visit(
        [](const auto& value) {
          if constexpr (std::is_arithmetic_v<std::decay_t<decltype(value)>>)
            return static_cast<double>(value) + n;
          else
            return static_cast<double>(value.size() + n);
        },
        item);
  return sum;
}

template <int... n>
double all(std::integer_sequence<int, n...>) {
  const std::vector<std::function<double(int)>> kernels = {kernel<n + 1>...};
  double sum = 0.0;
  for (const auto& one : kernels) sum += one(10);
  return sum;
}

int main() { return all(std::make_integer_sequence<int, 12>()) > 0.0 ? 0 : 1; }
