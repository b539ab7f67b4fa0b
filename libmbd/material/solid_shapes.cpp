#include "libmbd/material/solid_shapes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>
#include <unordered_map>
#include <vector>

#include "libmbd/core/disjoint_sets.hpp"
#include "libmbd/material/mesh_file.hpp"
#include "libmbd/material/scene_files.hpp"
#include "libmbd/scene/label.hpp"

namespace mbd {
namespace {

// Each edge of a closed surface lies between two triangles that pass it in opposite directions.
void check_closed(const TriangleMesh& surface) {
  std::unordered_map<std::uint64_t, int> times;  // of an edge from its lower to its higher point
  std::unordered_map<std::uint64_t, int> turns;  // that way less the other
  const auto key = [](std::uint32_t a, std::uint32_t b) { return std::uint64_t{a} << 32U | b; };
  for (const auto& t : surface.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(t[k], t[(k + 1) % 3]);
      const std::uint64_t edge = key(low, high);
      ++times[edge];
      turns[edge] += t[k] == low ? 1 : -1;
    }
  const auto where = [&](std::uint64_t edge) {
    const Vec3 x = surface.points[edge >> 32U];
    return fmt::format("({:.6g}, {:.6g}, {:.6g})", x(0), x(1), x(2));
  };
  for (const auto& [edge, count] : times)
    if (count % 2 != 0)
      throw Error(fmt::format("its surface is not closed, at {} among others", where(edge)));
  for (const auto& [edge, turn] : turns)
    if (turn != 0)
      throw Error(
          fmt::format("its triangles are not all turned outward, at {} among others", where(edge)));
}

// Triangles that hang together by their edges: a surface that is closed by itself.
struct Shell {
  std::vector<std::size_t> triangles;
  Vec3 low, high;
  double volume = 0.0, size = 0.0;  // negative: turned inward; sum of the sizes of its tetrahedra
  Vec3 first = Vec3::Zero();        // moments about the middle
  Mat3 second = Mat3::Zero();
};

// Tetrahedra from the middle to each triangle (a, b, c): volume v = det/6, first moment v (a + b + c)/4, second moments
// v (s s' + a a' + b b' + c c')/20, s = a + b + c.
void measure(const TriangleMesh& surface, const Vec3& middle, Shell& shell) {
  shell.low = shell.high = surface.points[surface.triangles[shell.triangles.front()][0]];
  for (const std::size_t k : shell.triangles) {
    const auto& t = surface.triangles[k];
    const Vec3 a = surface.points[t[0]] - middle, b = surface.points[t[1]] - middle,
               c = surface.points[t[2]] - middle, s = a + b + c;
    const double v = a.dot(b.cross(c)) / 6.0;
    shell.volume += v;
    shell.size += std::abs(v);
    shell.first += 0.25 * v * s;
    shell.second +=
        v / 20.0 * (s * s.transpose() + a * a.transpose() + b * b.transpose() + c * c.transpose());
    for (const std::uint32_t i : t) {
      shell.low = shell.low.cwiseMin(surface.points[i]);
      shell.high = shell.high.cwiseMax(surface.points[i]);
    }
  }
}

std::vector<Shell> shells_of(const TriangleMesh& surface, const Vec3& middle) {
  const std::size_t count = surface.triangles.size();
  DisjointSets joined(static_cast<int>(count));
  std::unordered_map<std::uint64_t, int> at;  // a triangle at an edge
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& t = surface.triangles[i];
      const auto [low, high] = std::minmax(t[k], t[(k + 1) % 3]);
      const auto [it, is_new] =
          at.try_emplace(std::uint64_t{low} << 32U | high, static_cast<int>(i));
      if (!is_new) joined.join(it->second, static_cast<int>(i));
    }
  std::map<int, Shell> shells;
  for (std::size_t i = 0; i < count; ++i)
    shells[joined.root(static_cast<int>(i))].triangles.push_back(i);
  std::vector<Shell> all;
  for (auto& [root, shell] : shells) {
    measure(surface, middle, shell);
    all.push_back(std::move(shell));
  }
  return all;
}

// How often it goes round x: 1 or -1 of a point within, 0 outside (van Oosterom, Strackee, "The solid angle of a plane
// triangle", IEEE Trans. Biomed. Eng. 30, 1983).
int times_round(const TriangleMesh& surface, const Shell& shell, const Vec3& x) {
  if ((x.array() < shell.low.array()).any() || (x.array() > shell.high.array()).any()) return 0;
  double angle = 0.0;
  for (const std::size_t k : shell.triangles) {
    const auto& t = surface.triangles[k];
    const Vec3 a = surface.points[t[0]] - x, b = surface.points[t[1]] - x,
               c = surface.points[t[2]] - x;
    const double A = a.norm(), B = b.norm(), C = c.norm();
    angle +=
        2.0 * std::atan2(a.dot(b.cross(c)), A * B * C + a.dot(b) * C + b.dot(c) * A + c.dot(a) * B);
  }
  return static_cast<int>(std::lround(angle / (4.0 * std::numbers::pi)));
}

// Beside the middle of its largest triangle: not on another that it touches. `turned`: 1 outward, -1 inward.
Vec3 point_within(const TriangleMesh& surface, const Shell& shell, int turned) {
  constexpr double beside = 1e-4;  // of the triangle's size
  Vec3 normal = Vec3::Zero(), middle = Vec3::Zero();
  for (const std::size_t k : shell.triangles) {
    const auto& t = surface.triangles[k];
    const Vec3 a = surface.points[t[0]], b = surface.points[t[1]], c = surface.points[t[2]];
    const Vec3 n = (b - a).cross(c - a);
    if (!(n.squaredNorm() > normal.squaredNorm())) continue;
    normal = n;
    middle = (a + b + c) / 3.0;
  }
  const double area = normal.norm();
  if (!(area > 0.0)) return middle;
  return middle - turned * beside / std::sqrt(area) * normal;
}

// Solids count, and what is hollow in them does not, whichever way all of it is turned.
void turn_outward(const TriangleMesh& surface, std::vector<Shell>& shells) {
  for (std::size_t i = 0; i < shells.size(); ++i) {
    const int own = shells[i].volume < 0.0 ? -1 : 1;
    const Vec3 x = point_within(surface, shells[i], own);
    int depth = 0, round = 0;  // solids and hollows about it; those turned outward less the others
    for (std::size_t j = 0; j < shells.size(); ++j) {
      const int one = i == j ? 0 : times_round(surface, shells[j], x);
      depth += std::abs(one);
      round += one;
    }
    // Each lies in one that is turned the other way; so of the shells about it one is left over, or none.
    const bool is_hollow = depth % 2 != 0;
    if (std::abs(round) != (is_hollow ? 1 : 0) || (is_hollow && round == own))
      throw Error(fmt::format(
          "the part of it at ({:.6g}, {:.6g}, {:.6g}) lies within another that is turned "
          "the same way: its place would count twice",
          x(0), x(1), x(2)));
    if (is_hollow == (own > 0)) {
      shells[i].volume = -shells[i].volume;
      shells[i].first = -shells[i].first;
      shells[i].second = -shells[i].second;
    }
  }
}

// Of density 1, about the middle of the form, in the axes of the shape.
MassProperties solid_form(const ShapeScene& shape, const std::string& of) {
  constexpr double pi = std::numbers::pi;
  MassProperties is;
  if (shape.box) {
    const Vec3 s2 = shape.box->cwiseProduct(*shape.box);
    is.mass = shape.box->prod();
    is.inertia.diagonal() = is.mass / 12.0 * Vec3(s2.sum() * Vec3::Ones() - s2);
  } else if (shape.cylinder) {
    const auto [d, h] = *shape.cylinder;
    is.mass = 0.25 * pi * d * d * h;
    const double across = is.mass * (d * d / 16.0 + h * h / 12.0);
    is.inertia.diagonal() = Vec3(across, across, is.mass * d * d / 8.0);
  } else if (shape.sphere) {
    const double d = *shape.sphere;
    is.mass = pi / 6.0 * d * d * d;
    is.inertia = 0.1 * is.mass * d * d * Mat3::Identity();
  } else {
    const auto surface = surface_of(shape, of);
    try {
      is = solid_of(*surface);
    } catch (const Error& error) {
      throw Error(shape.source, fmt::format("{}: density: {} is no solid: {}; mend the mesh, or "
                                            "leave density out and give the body mass and inertia",
                                            of, shape.mesh, error.what()));
    }
    const double u = shape.unit.value_or(1.0), volume = u * u * u;
    is.mass *= volume;
    is.center *= u;
    is.inertia *= volume * u * u;
  }
  return is;
}

}  // namespace

MassProperties solid_of(const TriangleMesh& surface) {
  check_closed(surface);
  MassProperties is;
  // From the middle of the points, for fewer digits to cancel.
  Vec3 middle = Vec3::Zero();
  for (const Vec3& x : surface.points) middle += x / static_cast<double>(surface.points.size());
  std::vector<Shell> shells = shells_of(surface, middle);
  turn_outward(surface, shells);
  Vec3 first = Vec3::Zero();
  Mat3 second = Mat3::Zero();
  double size = 0.0;
  for (const Shell& shell : shells) {
    is.mass += shell.volume;
    first += shell.first;
    second += shell.second;
    size += shell.size;
  }
  constexpr double flat = 1e-9;
  if (!(is.mass > flat * size)) throw Error("its volume is 0");
  const Vec3 c = first / is.mass;
  is.center = middle + c;
  second -= is.mass * c * c.transpose();
  is.inertia = second.trace() * Mat3::Identity() - second;
  return is;
}

std::shared_ptr<const TriangleMesh> surface_of(const ShapeScene& shape, const std::string& of) {
  if (shape.surface) return shape.surface;
  try {
    return std::make_shared<const TriangleMesh>(
        read_mesh_file(file_beside(shape.source, shape.mesh)));
  } catch (const Error& error) {
    throw Error(shape.source, fmt::format("{}: mesh: {}", of, error.what()));
  }
}

MassProperties mass_properties(const BodyScene& body) {
  MassProperties all{body.mass, body.center, body.inertia};
  if (std::ranges::none_of(body.shapes, [](const ShapeScene& s) { return s.density.has_value(); }))
    return all;
  const std::string of = label(body) + ", shape";
  const auto shifted = [](double mass, const Vec3& by) {  // Steiner's term
    return Mat3(mass * (by.squaredNorm() * Mat3::Identity() - by * by.transpose()));
  };
  for (const ShapeScene& shape : body.shapes) {
    if (!shape.density) continue;
    const MassProperties form = solid_form(shape, of);
    const Mat3& R = shape.orientation;
    const double mass = *shape.density * form.mass;
    const Vec3 center = shape.at + R * form.center;
    const Mat3 inertia = *shape.density * R * form.inertia * R.transpose();
    const double sum = all.mass + mass;
    const Vec3 middle = (all.mass * all.center + mass * center) / sum;
    all.inertia +=
        shifted(all.mass, all.center - middle) + inertia + shifted(mass, center - middle);
    all.inertia = 0.5 * (all.inertia + all.inertia.transpose()).eval();
    all.mass = sum;
    all.center = middle;
  }
  return all;
}

void read_meshes(Scene& scene) {
  std::size_t triangles = 0;
  for (BodyScene& body : scene.bodies)
    for (ShapeScene& shape : body.shapes) {
      if (shape.mesh.empty()) continue;
      const std::string of = label(body) + ", shape";
      shape.surface = surface_of(shape, of);
      triangles += shape.surface->triangles.size();
      if (triangles > most_triangles)
        throw Error(shape.source,
                    fmt::format("{}: with it the model has {} triangles, {} at most; make its "
                                "meshes coarser",
                                of, triangles, most_triangles));
    }
}

}  // namespace mbd
