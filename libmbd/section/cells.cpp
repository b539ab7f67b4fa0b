#include "libmbd/section/cells.hpp"

#include <algorithm>

#include "libmbd/core/spectral.hpp"
#include "libmbd/section/places.hpp"

namespace mbd::section {
namespace {

using Quad = std::array<Point, 4>;
using Marks = std::array<bool, 4>;

Point within(const Quad& q, double u, double v) {
  return (1 - u) * (1 - v) * q[0] + u * (1 - v) * q[1] + u * v * q[2] + (1 - u) * v * q[3];
}

template <class T>
std::array<T, 4> turned(const std::array<T, 4>& a, std::size_t first) {
  return {a[first], a[(first + 1) % 4], a[(first + 2) % 4], a[(first + 3) % 4]};
}

// Round the first corner.
void add_rings(const Quad& q, int rings, std::vector<Quad>& all) {
  double r = 1.0;
  for (int k = 0; k < rings; ++k) {
    const double s = r * ring_ratio;
    all.push_back({within(q, s, 0), within(q, r, 0), within(q, r, r), within(q, s, s)});
    all.push_back({within(q, 0, s), within(q, s, s), within(q, r, r), within(q, 0, r)});
    r = s;
  }
  all.push_back({q[0], within(q, r, 0), within(q, r, r), within(q, 0, r)});
}

void divide(const Quad& quad, const Marks& marks, int rings, std::vector<Quad>& all) {
  const auto count = std::ranges::count(marks, true);
  if (count == 0) {
    all.push_back(quad);
    return;
  }
  const auto first = static_cast<std::size_t>(std::ranges::find(marks, true) - marks.begin());
  if (count == 1) {
    add_rings(turned(quad, first), rings, all);
    return;
  }
  if (count == 2 && marks[(first + 2) % 4] == false) {  // at the ends of the side from 3 to 0
    const Quad q = turned(quad, marks[(first + 3) % 4] ? first : (first + 1) % 4);
    constexpr double third = 1.0 / 3.0;
    const Point a = within(q, 0, third), b = within(q, 0, 2 * third), c = within(q, third, third),
                d = within(q, third, 2 * third);
    all.push_back({c, q[1], q[2], d});
    all.push_back({a, c, d, b});
    add_rings({q[0], q[1], c, a}, rings, all);
    add_rings({q[3], b, d, q[2]}, rings, all);
    return;
  }
  const double low = 1.0 / 3.0, high = 2.0 / 3.0;
  const Quad inner{within(quad, low, low), within(quad, high, low), within(quad, high, high),
                   within(quad, low, high)};
  all.push_back(inner);
  for (std::size_t k = 0; k < 4; ++k) {
    const std::size_t next = (k + 1) % 4;
    divide({quad[k], quad[next], inner[next], inner[k]}, {marks[k], marks[next], false, false},
           rings, all);
  }
}

}  // namespace

Mesh mesh_of(const std::vector<Cell>& cells, const Fineness& fineness,
             const std::vector<MeshMaterial>& materials, double near) {
  Mesh mesh;
  mesh.materials = materials;
  Places nodes(mesh.nodes, near);
  const std::vector<double> places = gauss_lobatto_rule(fineness.order + 1).points;
  const Quad whole{Point(0, 0), Point(1, 0), Point(1, 1), Point(0, 1)};
  std::vector<Quad> quads;
  for (const Cell& cell : cells) {
    quads.clear();
    divide(whole, cell.marked, fineness.layers, quads);
    for (const Quad& quad : quads) {
      Element element;
      element.order = fineness.order;
      element.material = cell.material;
      element.angle = cell.angle;
      element.name = cell.name;
      element.normals.clear();
      for (const double eta : places)
        for (const double xi : places) {
          const Point x = within(quad, 0.5 * (1 + xi), 0.5 * (1 + eta));
          element.nodes.push_back(nodes.at(cell.map(x(0), x(1))));
          element.normals.push_back(cell.normal(x(0), x(1)));
        }
      const auto [least, most] = std::ranges::minmax(element.normals);
      if (most - least < 1e-14) element.normals.resize(1);
      mesh.elements.push_back(std::move(element));
    }
  }
  return mesh;
}

}  // namespace mbd::section
