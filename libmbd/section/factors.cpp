#include "libmbd/section/factors.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>

namespace mbd::section {
namespace {

constexpr int leaf_unknowns =
    96;  // of elements that are not halved any more; measured: 50 to 200 are alike

class Divider {
 public:
  explicit Divider(const Mesh& mesh) : mesh_(mesh), degree_(mesh.nodes.size(), 0) {
    for (const Element& element : mesh.elements) {
      Point centre = Point::Zero();
      for (const int node : element.nodes) {
        ++degree_[static_cast<std::size_t>(node)];
        centre += mesh.nodes[static_cast<std::size_t>(node)];
      }
      centres_.push_back(centre / static_cast<double>(element.nodes.size()));
    }
  }

  std::vector<Front> divide() {
    std::vector<int> all(mesh_.elements.size());
    std::iota(all.begin(), all.end(), 0);
    if (!all.empty()) divide(all);
    return std::move(fronts_);
  }

 private:
  using Seen =
      std::map<int,
               int>;  // how many of a node's elements are in the set, of nodes not eliminated in it

  std::pair<int, Seen> divide(std::span<int> elements) {
    Front front;
    Seen seen;
    std::size_t unknowns = 0;
    for (const int e : elements)
      unknowns += mesh_.elements[static_cast<std::size_t>(e)].nodes.size();
    if (elements.size() == 1 || unknowns * 3 <= leaf_unknowns) {
      front.elements.assign(elements.begin(), elements.end());
      for (const int e : elements)
        for (const int node : mesh_.elements[static_cast<std::size_t>(e)].nodes) ++seen[node];
    } else {
      const auto middle = elements.begin() + static_cast<std::ptrdiff_t>(elements.size() / 2);
      const Index side = longer_side(elements);
      std::nth_element(elements.begin(), middle, elements.end(), [&](int a, int b) {
        const double of_a = centre(a)(side), of_b = centre(b)(side);
        return of_a < of_b || (of_a == of_b && a < b);
      });
      const auto half = static_cast<std::size_t>(middle - elements.begin());
      for (const auto part : {elements.first(half), elements.subspan(half)}) {
        auto [child, of_child] = divide(part);
        front.children.push_back(child);
        for (const auto& [node, count] : of_child) seen[node] += count;
      }
    }
    for (auto it = seen.begin(); it != seen.end();) {
      const bool whole = it->second == degree_[static_cast<std::size_t>(it->first)];
      (whole ? front.own : front.border).push_back(it->first);
      it = whole ? seen.erase(it) : std::next(it);
    }
    fronts_.push_back(std::move(front));
    return {static_cast<int>(fronts_.size()) - 1, std::move(seen)};
  }

  const Point& centre(int element) const { return centres_[static_cast<std::size_t>(element)]; }

  Index longer_side(std::span<const int> elements) const {
    Eigen::Array2d low = Eigen::Array2d::Constant(std::numeric_limits<double>::infinity()),
                   high = -low;
    for (const int e : elements) {
      low = low.min(centre(e).array());
      high = high.max(centre(e).array());
    }
    return high(1) - low(1) > high(0) - low(0) ? 1 : 0;
  }

  const Mesh& mesh_;
  std::vector<int> degree_;
  std::vector<Point> centres_;
  std::vector<Front> fronts_;
};

}  // namespace

std::vector<Front> dissect(const Mesh& mesh) { return Divider(mesh).divide(); }

}  // namespace mbd::section
