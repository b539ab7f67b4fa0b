#include "libmbd/material/solid_shapes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <unordered_map>

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
      throw Error(shape.source,
                  fmt::format("{}: density: {} encloses nothing: {}; mend the mesh, or "
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
  // From the middle of the points, for fewer digits to cancel. Tetrahedra from there to each triangle (a, b, c):
  // volume v = det/6, first moment v (a + b + c)/4, second moments v (s s' + a a' + b b' + c c')/20, s = a + b + c.
  Vec3 middle = Vec3::Zero();
  for (const Vec3& x : surface.points) middle += x / static_cast<double>(surface.points.size());
  Vec3 first = Vec3::Zero();
  Mat3 second = Mat3::Zero();
  double size = 0.0;
  for (const auto& t : surface.triangles) {
    const Vec3 a = surface.points[t[0]] - middle, b = surface.points[t[1]] - middle,
               c = surface.points[t[2]] - middle, s = a + b + c;
    const double v = a.dot(b.cross(c)) / 6.0;
    is.mass += v;
    size += std::abs(v);
    first += 0.25 * v * s;
    second +=
        v / 20.0 * (s * s.transpose() + a * a.transpose() + b * b.transpose() + c * c.transpose());
  }
  if (is.mass < 0.0) {  // all turned inward
    is.mass = -is.mass;
    first = -first;
    second = -second;
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
