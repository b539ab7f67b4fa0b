#include "libmbd/section/shapes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string_view>
#include <utility>

#include "libmbd/core/error.hpp"
#include "libmbd/core/spectral.hpp"
#include "libmbd/section/places.hpp"

namespace mbd::section {
namespace {

constexpr double turn = 2.0 * std::numbers::pi;

// A region that is the image of the unit square, right-handed, of one ply.
struct Patch {
  std::function<Point(double xi, double eta)> map;
  std::function<double(double xi, double eta)> normal;  // angle from b2
  std::vector<double> xi, eta;                          // where its elements end, 0 to 1
  int material;
  double angle;
  std::string name;
};

Mesh mesh_of(const std::vector<Patch>& patches, int order,
             const std::vector<MeshMaterial>& materials, double size) {
  Mesh mesh;
  mesh.materials = materials;
  Places nodes(mesh.nodes, 1e-10 * size);
  const std::vector<double> places = gauss_lobatto_rule(order + 1).points;
  for (const Patch& patch : patches)
    for (std::size_t b = 0; b + 1 < patch.eta.size(); ++b)
      for (std::size_t a = 0; a + 1 < patch.xi.size(); ++a) {
        Element element;
        element.order = order;
        element.material = patch.material;
        element.angle = patch.angle;
        element.name = patch.name;
        element.normals.clear();
        const auto between = [](const std::vector<double>& ends, std::size_t i, double at) {
          return 0.5 * ((1.0 - at) * ends[i] + (1.0 + at) * ends[i + 1]);
        };
        for (const double eta : places)
          for (const double xi : places) {
            const double x = between(patch.xi, a, xi), y = between(patch.eta, b, eta);
            element.nodes.push_back(nodes.at(patch.map(x, y)));
            element.normals.push_back(patch.normal(x, y));
          }
        const auto [low, high] = std::ranges::minmax(element.normals);
        if (low == high) element.normals.resize(1);
        mesh.elements.push_back(std::move(element));
      }
  return mesh;
}

// 0 to 1, elements shrinking by `ratio` towards both ends.
constexpr double ratio = 0.18;
std::vector<double> graded(int layers) {
  std::vector<double> ends{0.0};
  for (int i = layers; i-- > 0;) ends.push_back(0.5 * std::pow(ratio, i));
  for (std::size_t i = ends.size(); i-- > 0;)
    if (ends[i] < 0.5) ends.push_back(1.0 - ends[i]);
  return ends;
}
std::vector<double> even(int parts) {
  std::vector<double> ends;
  for (int i = 0; i <= parts; ++i) ends.push_back(static_cast<double>(i) / parts);
  return ends;
}

// The same of a length, elements no longer than 50 times the thinnest part of the section, or a sixteenth of what they
// were: matrices of more slender ones are not definite to round-off.
std::vector<double> graded(int layers, double length, double thinnest) {
  const std::vector<double> all = graded(layers);
  std::vector<double> ends{0.0};
  for (std::size_t i = 0; i + 1 < all.size(); ++i) {
    const double part = all[i + 1] - all[i];
    const auto pieces =
        static_cast<int>(std::clamp(std::ceil(part * length / (50.0 * thinnest)), 1.0, 16.0));
    for (int k = 1; k <= pieces; ++k)
      ends.push_back(k == pieces ? all[i + 1] : all[i] + part * k / pieces);
  }
  return ends;
}

void check_size(std::string_view name, double value) {
  if (!(value > 0.0) || !std::isfinite(value))
    throw Error(fmt::format("{} = {:g} is not positive and finite", name, value));
}

void check_layup(std::string_view what, const Layup& layup,
                 const std::vector<MeshMaterial>& materials) {
  if (layup.empty()) throw Error(fmt::format("{}: its layup has no plies", what));
  for (std::size_t i = 0; i < layup.size(); ++i) {
    check_size(fmt::format("{}: thickness of ply {}", what, i + 1), layup[i].thickness);
    if (!std::isfinite(layup[i].angle))
      throw Error(fmt::format("{}: the angle of ply {} is not finite", what, i + 1));
    if (layup[i].material < 0 || static_cast<std::size_t>(layup[i].material) >= materials.size())
      throw Error(fmt::format("{}: ply {} has no material", what, i + 1));
  }
}

std::string ply_name(std::size_t i, std::string_view wall) {
  return fmt::format("ply {} of the {}", i + 1, wall);
}

// ---- sections of rectangles -------------------------------------------------------------------

struct Region {
  double left, right, bottom, top;
  int material;
  double angle, normal;
  std::string name;
};

// Plies side by side along `normal`, which points along b2 or b3, either way: the first at the end it points from.
void stack(std::vector<Region>& regions, double left, double right, double bottom, double top,
           const Layup& layup, double normal, std::string_view wall) {
  const bool along2 = std::abs(std::cos(normal)) > 0.5;
  const bool forward = along2 ? std::cos(normal) > 0.0 : std::sin(normal) > 0.0;
  double at = along2 ? (forward ? left : right) : (forward ? bottom : top);
  const double other = along2 ? (forward ? right : left) : (forward ? top : bottom);
  for (std::size_t i = 0; i < layup.size(); ++i) {
    // The last ends where the wall does, without round-off.
    const double next =
        i + 1 == layup.size() ? other : at + (forward ? 1.0 : -1.0) * layup[i].thickness;
    const double low = std::min(at, next), high = std::max(at, next);
    Region region{left,           right,  bottom,           top, layup[i].material,
                  layup[i].angle, normal, ply_name(i, wall)};
    (along2 ? region.left : region.bottom) = low;
    (along2 ? region.right : region.top) = high;
    regions.push_back(std::move(region));
    at = next;
  }
}

std::vector<double> lines_of(std::vector<double> all, double size) {
  std::ranges::sort(all);
  std::vector<double> lines;
  for (const double x : all)
    if (lines.empty() || x - lines.back() > 1e-9 * size) lines.push_back(x);
  return lines;
}

Mesher of_regions(std::vector<Region> regions, std::vector<MeshMaterial> materials) {
  std::vector<double> x, y;
  for (const Region& r : regions) {
    x.insert(x.end(), {r.left, r.right});
    y.insert(y.end(), {r.bottom, r.top});
  }
  const auto [x0, x1] = std::ranges::minmax(x);
  const auto [y0, y1] = std::ranges::minmax(y);
  const double size = std::max(x1 - x0, y1 - y0);
  x = lines_of(x, size);
  y = lines_of(y, size);
  double thinnest = size;
  for (const auto& lines : {x, y})
    for (std::size_t i = 0; i + 1 < lines.size(); ++i)
      thinnest = std::min(thinnest, lines[i + 1] - lines[i]);
  return [=](const Fineness& fineness) {
    std::vector<Patch> patches;
    for (const Region& r : regions)
      for (std::size_t i = 0; i + 1 < x.size(); ++i)
        for (std::size_t j = 0; j + 1 < y.size(); ++j) {
          const double a = x[i], b = x[i + 1], c = y[j], d = y[j + 1];
          const double middle2 = 0.5 * (a + b), middle3 = 0.5 * (c + d);
          if (middle2 < r.left || middle2 > r.right || middle3 < r.bottom || middle3 > r.top)
            continue;
          const double normal = r.normal;
          patches.push_back({[=](double xi, double eta) {
                               return Point((1 - xi) * a + xi * b, (1 - eta) * c + eta * d);
                             },
                             [normal](double, double) { return normal; },
                             graded(fineness.layers, b - a, thinnest),
                             graded(fineness.layers, d - c, thinnest), r.material, r.angle,
                             r.name});
        }
    return mesh_of(patches, fineness.order, materials, size);
  };
}

void check_wall(std::string_view what, const Layup& layup, double room, std::string_view limit) {
  if (!(thickness_of(layup) < room * (1.0 - 1e-9)))
    throw Error(fmt::format("{}: its plies are {:g} thick together and do not fit: {} is {:g}",
                            what, thickness_of(layup), limit, room));
}

}  // namespace

double thickness_of(const Layup& layup) {
  double sum = 0.0;
  for (const Ply& ply : layup) sum += ply.thickness;
  return sum;
}

Layup reversed(Layup layup) {
  std::ranges::reverse(layup);
  return layup;
}

Mesher tube(double outer_radius, const Layup& layup, const std::vector<MeshMaterial>& materials) {
  check_size("tube: outer radius", outer_radius);
  check_layup("tube", layup, materials);
  check_wall("tube", layup, outer_radius, "the outer radius");
  double thinnest = outer_radius;
  for (const Ply& ply : layup) thinnest = std::min(thinnest, ply.thickness);
  constexpr std::size_t many_plies = 6;  // each is divided by its order only
  // Elements of thin plies are not too slender, as above.
  const int sectors =
      8 * static_cast<int>(std::clamp(turn / 8 * outer_radius / (400.0 * thinnest), 1.0, 16.0));
  return [=](const Fineness& fineness) {
    std::vector<Patch> patches;
    double radius = outer_radius - thickness_of(layup);
    for (std::size_t i = 0; i < layup.size(); ++i) {
      const double inner = radius;
      const double outer = i + 1 == layup.size() ? outer_radius : radius + layup[i].thickness;
      for (int s = 0; s < sectors; ++s) {
        // xi along the radius, eta around: right-handed.
        const auto around = [s, sectors](double eta) { return turn * (s + eta) / sectors; };
        patches.push_back({[=](double xi, double eta) {
                             const double r = (1 - xi) * inner + xi * outer;
                             return Point(r * std::cos(around(eta)), r * std::sin(around(eta)));
                           },
                           [around](double, double eta) { return around(eta); },
                           even(layup.size() > many_plies ? 1 : fineness.layers),
                           even(fineness.layers), layup[i].material, layup[i].angle,
                           ply_name(i, "tube")});
      }
      radius = outer;
    }
    return mesh_of(patches, fineness.order, materials, 2.0 * outer_radius);
  };
}

Mesher bar(double radius, int material, double angle, const std::vector<MeshMaterial>& materials) {
  check_size("bar: radius", radius);
  check_layup("bar", {{material, radius, angle}}, materials);
  return [=](const Fineness& fineness) {
    std::vector<Patch> patches;
    const auto normal = [](double, double) { return 0.25 * turn; };
    const double half = 0.5 * radius;  // of the square's diagonal
    const std::vector<double> ends = even(fineness.layers);
    const auto corner = [](int i, double r) {
      return Point(r * std::cos(turn * (i + 0.5) / 4.0), r * std::sin(turn * (i + 0.5) / 4.0));
    };
    const Point a = corner(2, half), b = corner(3, half), c = corner(0, half), d = corner(1, half);
    patches.push_back({[=](double xi, double eta) {
                         return Point((1 - eta) * ((1 - xi) * a + xi * b) +
                                      eta * ((1 - xi) * d + xi * c));
                       },
                       normal, ends, ends, material, angle, "bar"});
    for (int i = 0; i < 4; ++i)
      patches.push_back(
          {[=](double xi, double eta) {
             const double at = turn * (i + 0.5 + eta) / 4.0;
             const Point inner = (1 - eta) * corner(i, half) + eta * corner((i + 1) % 4, half);
             return Point((1 - xi) * inner + xi * radius * Point(std::cos(at), std::sin(at)));
           },
           normal, ends, ends, material, angle, "bar"});
    return mesh_of(patches, fineness.order, materials, 2.0 * radius);
  };
}

Mesher rectangle(double width, const Layup& layup, const std::vector<MeshMaterial>& materials) {
  check_size("rectangle: width", width);
  check_layup("rectangle", layup, materials);
  const double height = thickness_of(layup);
  std::vector<Region> regions;
  stack(regions, -0.5 * width, 0.5 * width, -0.5 * height, 0.5 * height, layup, 0.25 * turn,
        "rectangle");
  return of_regions(std::move(regions), materials);
}

Mesher box(double width, double height, const Layup& layup, Corners corners,
           const std::vector<MeshMaterial>& materials) {
  check_size("box: width", width);
  check_size("box: height", height);
  check_layup("box", layup, materials);
  check_wall("box", layup, 0.5 * std::min(width, height), "half its smaller side");
  const double thickness = thickness_of(layup), right = 0.5 * width, top = 0.5 * height;
  if (corners == Corners::butt) {
    std::vector<Region> regions;
    const double inner = top - thickness;
    stack(regions, -right, right, inner, top, layup, 0.25 * turn, "top wall");
    stack(regions, -right, right, -top, -inner, layup, -0.25 * turn, "bottom wall");
    stack(regions, right - thickness, right, -inner, inner, layup, 0.0, "right wall");
    stack(regions, -right, -right + thickness, -inner, inner, layup, 0.5 * turn, "left wall");
    return of_regions(std::move(regions), materials);
  }
  double thinnest = thickness;
  for (const Ply& ply : layup) thinnest = std::min(thinnest, ply.thickness);
  return [=](const Fineness& fineness) {
    std::vector<Patch> patches;
    constexpr std::array<std::string_view, 4> walls{"right wall", "top wall", "left wall",
                                                    "bottom wall"};
    double inner = -thickness;  // of a ply, from the outer surface
    for (std::size_t i = 0; i < layup.size(); ++i) {
      const double outer = i + 1 == layup.size() ? 0.0 : inner + layup[i].thickness;
      for (int w = 0; w < 4; ++w) {
        const auto corner = [=](int k, double depth) {
          const double x = right + depth, y = top + depth;
          return Point(k == 0 || k == 3 ? x : -x, k == 0 || k == 1 ? y : -y);
        };
        // Round the box from the corner at the lower right; xi outward, eta around.
        const Point a = corner((w + 3) % 4, inner), b = corner((w + 3) % 4, outer),
                    c = corner(w, outer), d = corner(w, inner);
        const double normal = 0.25 * turn * w, length = w % 2 == 0 ? height : width;
        patches.push_back({[=](double xi, double eta) {
                             return Point((1 - eta) * ((1 - xi) * a + xi * b) +
                                          eta * ((1 - xi) * d + xi * c));
                           },
                           [normal](double, double) { return normal; }, graded(fineness.layers),
                           graded(fineness.layers, length, thinnest), layup[i].material,
                           layup[i].angle, ply_name(i, walls[static_cast<std::size_t>(w)])});
      }
      inner = outer;
    }
    return mesh_of(patches, fineness.order, materials, std::max(width, height));
  };
}

namespace {
Mesher flanged(std::string_view what, double left, double right, double web_left, double height,
               const Layup& flange, const Layup& web, double web_normal,
               const std::vector<MeshMaterial>& materials) {
  check_size(fmt::format("{}: width", what), right - left);
  check_size(fmt::format("{}: height", what), height);
  check_layup(fmt::format("flange of the {}", what), flange, materials);
  check_layup(fmt::format("web of the {}", what), web, materials);
  check_wall(fmt::format("flange of the {}", what), flange, 0.5 * height, "half its height");
  check_wall(fmt::format("web of the {}", what), web, right - left, "its width");
  std::vector<Region> regions;
  const double top = 0.5 * height, inner = top - thickness_of(flange);
  stack(regions, left, right, inner, top, flange, 0.25 * turn, "top flange");
  stack(regions, left, right, -top, -inner, flange, -0.25 * turn, "bottom flange");
  stack(regions, web_left, web_left + thickness_of(web), -inner, inner, web, web_normal, "web");
  return of_regions(std::move(regions), materials);
}
}  // namespace

Mesher i_section(double width, double height, const Layup& flange, const Layup& web,
                 const std::vector<MeshMaterial>& materials) {
  return flanged("I", -0.5 * width, 0.5 * width, -0.5 * thickness_of(web), height, flange, web, 0.0,
                 materials);
}

Mesher c_section(double width, double height, const Layup& flange, const Layup& web,
                 const std::vector<MeshMaterial>& materials) {
  return flanged("C", 0.0, width, 0.0, height, flange, web, 0.5 * turn, materials);
}

namespace {

constexpr double round_off = 1e-11;

}  // namespace

// Errors of entries of D from its last two changes. D of a finite element method is too large by a matrix that is
// positive semi-definite, so the diagonal says what the rest can be; a change of the rest may be small by luck.
Mat6 error_of(const Mat6& d, const Mat6& now, const Mat6& before) {
  const Vec6 size = d.diagonal(), root = size.cwiseSqrt();
  const Vec6 last = now.diagonal().cwiseQuotient(size).cwiseMax(round_off),
             first = before.diagonal().cwiseQuotient(size).cwiseMax(round_off);
  const double ratio_of_all = last.maxCoeff() / first.maxCoeff();
  Vec6 error;
  for (Index i = 0; i < 6; ++i) {
    const double shrinks = std::max(last(i) / first(i), ratio_of_all);
    // What is left of a geometric series is less than 0.7 of its last term up to a ratio of 0.41. A ratio that is smaller now
    // says little of the next ones: where rings are added at every other mesh they take turns, and what is singular is late
    // to show.
    error(i) = shrinks <= 0.5 ? 0.7 * last(i) : 2.0 * std::max(last(i), first(i));
  }
  error = error.cwiseMax(0.1 * error.maxCoeff());
  Mat6 result;
  for (Index i = 0; i < 6; ++i)
    for (Index j = 0; j < 6; ++j) {
      const double scale = root(i) * root(j);
      const bool zero = std::max(std::abs(d(i, j)), now(i, j)) < round_off * scale;  // by symmetry
      result(i, j) = scale * std::max(round_off, zero ? 0.0 : std::sqrt(error(i) * error(j)));
    }
  return result;
}

namespace {
// From the level on where there is an estimate: from two changes, or where one will do from one.
Converged refine(const Mesher& mesher, const Vec3& curvature, double tolerance, int most_unknowns,
                 const std::vector<Fineness>& levels, std::size_t first_estimate) {
  Converged result;
  Mat6 last = Mat6::Zero(), change = Mat6::Zero();
  for (std::size_t level = 0; level < levels.size(); ++level) {
    const Mesh mesh = mesher(levels[level]);
    const auto unknowns = 3 * static_cast<int>(mesh.nodes.size());
    if (level > 1 && unknowns > most_unknowns) break;
    result.analysis = analyse(mesh, curvature);
    result.fineness = levels[level];
    result.elements = static_cast<int>(mesh.elements.size());
    result.unknowns = unknowns;
    const Mat6& d = result.analysis.stiffness;
    const Vec6 root = d.diagonal().cwiseSqrt();
    const Mat6 scale = root * root.transpose();
    const Mat6 now = (d - last).cwiseAbs();
    if (level >= first_estimate) {
      result.error = error_of(d, now, level > 1 ? change : now);
      result.reached =
          (result.error.array() <= std::max(tolerance, round_off) * scale.array()).all();
      if (result.reached) break;
    }
    last = d;
    change = now;
  }
  return result;
}
}  // namespace

std::vector<Fineness> levels_of(bool of_one_mesh) {
  std::vector<Fineness> levels;
  if (of_one_mesh)
    for (int order = 1; order <= 8; ++order) levels.push_back({order, 1});
  else  // beyond nine, grading comes near to round-off
    for (int level = 0; level < 9; ++level) levels.push_back({level + 2, level + 1});
  return levels;
}

Converged converge(const Mesher& mesher, const Vec3& curvature, double tolerance,
                   int most_unknowns) {
  return refine(mesher, curvature, tolerance, most_unknowns, levels_of(false), 2);
}

Converged converge_orders(const Mesher& mesher, const Vec3& curvature, double tolerance,
                          int most_unknowns) {
  return refine(mesher, curvature, tolerance, most_unknowns, levels_of(true), 1);
}

}  // namespace mbd::section
