#include "libmbd/material/shaped_sections.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <mutex>
#include <tuple>
#include <utility>
#include <vector>

#include "libmbd/material/scene_files.hpp"
#include "libmbd/scene/label.hpp"
#include "libmbd/scene/reading_limits.hpp"
#include "libmbd/section/airfoil.hpp"
#include "libmbd/section/gmsh.hpp"
#include "libmbd/text/spelling.hpp"

namespace mbd {
namespace {

using section::EngineeringConstants;

constexpr std::size_t most_plies = 100;  // of a layup, equal neighbours being one

template <class Item>
[[noreturn]] void fail(const Item& item, const std::string& what) {
  throw Error(item.source, label(item) + ": " + what);
}

EngineeringConstants constants_of(const MaterialScene& m) {
  struct Constant {
    std::string_view name;
    bool given, needed;
  };
  const std::array<Constant, 9> along_axes{{{"EL", m.e_l.has_value(), true},
                                            {"ET", m.e_t.has_value(), true},
                                            {"GLT", m.g_lt.has_value(), true},
                                            {"nuLT", m.nu_lt.has_value(), true},
                                            {"EN", m.e_n.has_value(), false},
                                            {"GLN", m.g_ln.has_value(), false},
                                            {"GTN", m.g_tn.has_value(), false},
                                            {"nuLN", m.nu_ln.has_value(), false},
                                            {"nuTN", m.nu_tn.has_value(), true}}};
  const auto of_axes = std::ranges::find_if(along_axes, &Constant::given);
  if (m.young || m.poisson) {
    if (of_axes != along_axes.end())
      fail(m, fmt::format("E and nu are of an isotropic material, {} of one that is not; give one "
                          "or the other",
                          of_axes->name));
    if (!m.young) fail(m, "attribute \"E\" is missing: Young's modulus [Pa]");
    if (!m.poisson) fail(m, "attribute \"nu\" is missing: Poisson's ratio");
    if (!(*m.poisson > -1.0 && *m.poisson < 0.5))
      fail(m, fmt::format("nu is {}, must lie between -1 and 0.5", *m.poisson));
    return section::isotropic(*m.young, *m.poisson);
  }
  if (of_axes == along_axes.end())
    fail(m,
         "it has no stiffness; give E and nu of an isotropic material, or EL, ET, GLT, nuLT and "
         "nuTN");
  for (const Constant& constant : along_axes)
    if (constant.needed && !constant.given)
      fail(m, fmt::format("attribute \"{}\" is missing: a material that is not isotropic has EL, "
                          "ET, GLT, nuLT and nuTN at least",
                          constant.name));
  if (!m.g_tn && !(*m.nu_tn > -1.0))
    fail(m, fmt::format("nuTN is {}, must be greater than -1", *m.nu_tn));
  return {*m.e_l,
          *m.e_t,
          m.e_n.value_or(*m.e_t),
          *m.g_lt,
          m.g_ln.value_or(*m.g_lt),
          m.g_tn.value_or(*m.e_t / (2.0 * (1.0 + *m.nu_tn))),
          *m.nu_lt,
          m.nu_ln.value_or(*m.nu_lt),
          *m.nu_tn};
}

// None where the material has none. Throws Error where some are missing, or are of the other kind of material.
std::optional<section::Strengths> strengths_of(const MaterialScene& m) {
  struct Strength {
    std::string_view name;
    const std::optional<double>& value;
  };
  const std::array<Strength, 9> all{{{"Xt", m.xt},
                                     {"Xc", m.xc},
                                     {"Yt", m.yt},
                                     {"Yc", m.yc},
                                     {"SLT", m.s_lt},
                                     {"STN", m.s_tn},
                                     {"Zt", m.zt},
                                     {"Zc", m.zc},
                                     {"SLN", m.s_ln}}};
  const auto given = [](const Strength& s) { return s.value.has_value(); };
  const auto first = std::ranges::find_if(all, given);
  if (m.young && first != all.end())
    fail(m, fmt::format("{} is of a material with axes, this one is isotropic; give yield",
                        first->name));
  if (!m.young && m.yield)
    fail(m,
         "yield is of an isotropic material; give strengths along its axes: Xt Xc Yt Yc SLT STN");
  if (first == all.end()) return std::nullopt;
  for (std::size_t i = 0; i < 6; ++i)
    if (!given(all[i]))
      fail(m, fmt::format("attribute \"{}\" is missing: strengths are given by Xt Xc Yt Yc SLT STN "
                          "at least, or not at all",
                          all[i].name));
  return section::Strengths{*m.xt,
                            *m.xc,
                            *m.yt,
                            *m.yc,
                            m.zt.value_or(*m.yt),
                            m.zc.value_or(*m.yc),
                            *m.s_lt,
                            m.s_ln.value_or(*m.s_lt),
                            *m.s_tn};
}

// Of materials or layups.
template <class Items>
const auto& named(const Items& items, const std::string& name, const Source& source,
                  const std::string& who, std::string_view plural) {
  const auto found = std::ranges::find(items, name, [](const auto& item) { return item.name; });
  if (found != items.end()) return *found;
  std::vector<std::string_view> names;
  for (const auto& item : items) names.push_back(item.name);
  using Item = typename Items::value_type;
  throw Error(source, fmt::format("{}: {} {} is not in the model{}", who, Item::item.element,
                                  in_quotes(excerpt(name)), suggest(name, names, plural)));
}

// A shape while it is turned into what libmbd/section knows.
class Shaped {
 public:
  Shaped(const Scene& scene, const SectionShape& shape, std::string of)
      : scene_(scene), s_(shape), of_(std::move(of)) {}

  [[noreturn]] void fail(const std::string& what) const {
    throw Error(s_.source, of_ + ": " + what);
  }

  section::Mesher mesher() { return in_place(as_drawn()); }

  bool has_mass() const {
    return std::ranges::any_of(used_,
                               [](const MaterialScene* m) { return m->density.has_value(); });
  }

  // All numbers that the result depends on.
  std::vector<double> key() const {
    std::vector<double> all{static_cast<double>(s_.kind),
                            s_.radius,
                            s_.width,
                            s_.height,
                            s_.own_height.value_or(0.0),
                            static_cast<double>(s_.corners),
                            s_.x2,
                            s_.x3,
                            s_.turn,
                            s_.angle,
                            s_.curvature(0),
                            s_.curvature(1),
                            s_.curvature(2),
                            s_.tolerance};
    all.insert(all.end(), {s_.mesh_tolerance, s_.airfoil_tolerance});
    all.insert(all.end(), mesh_key_.begin(), mesh_key_.end());
    if (SectionShape::is_mesh(s_))
      for (const section::MeshMaterial& m : materials_) {
        all.push_back(m.density);
        all.insert(all.end(), m.stiffness.data(), m.stiffness.data() + m.stiffness.size());
      }
    for (const section::Layup& layup : layups_) {
      all.push_back(static_cast<double>(layup.size()));
      for (const section::Ply& ply : layup) {
        all.insert(all.end(), {ply.thickness, ply.angle});
        const auto m = static_cast<std::size_t>(ply.material);
        all.push_back(materials_[m].density);
        all.insert(all.end(), materials_[m].stiffness.data(),
                   materials_[m].stiffness.data() + materials_[m].stiffness.size());
      }
    }
    return all;
  }

 private:
  section::Mesher as_drawn() {
    for (const auto& [name, value] :
         {std::pair{"x2", s_.x2}, {"x3", s_.x3}, {"turn", s_.turn}, {"angle", s_.angle}})
      if (!std::isfinite(value)) fail(std::string(name) + " is not finite");
    if (s_.material.empty() && s_.angle != 0.0)
      fail("angle is of a material that is given by itself; those of plies stand in the layup");
    switch (s_.kind) {
      case SectionShape::Kind::tube: {
        const section::Layup wall = wall_of(own(s_.layup, s_.thickness), "layup", "thickness");
        return made(section::tube, s_.radius, wall);
      }
      case SectionShape::Kind::bar: {
        const section::Layup whole = one_ply(own({}, s_.radius));
        return made(section::bar, s_.radius, whole[0].material, s_.angle);
      }
      case SectionShape::Kind::rectangle: {
        const section::Layup plies = wall_of(own(s_.layup, s_.own_height), "layup", "height");
        return made(section::rectangle, s_.width, plies);
      }
      case SectionShape::Kind::box: {
        const section::Layup wall = wall_of(own(s_.layup, s_.thickness), "layup", "thickness");
        return made(section::box, s_.width, s_.height, wall, corners());
      }
      case SectionShape::Kind::mesh:
        return meshed();
      case SectionShape::Kind::airfoil:
        return of_contour();
      default:
        break;
    }
    const section::Layup flange =
        wall_of(own(s_.flange, s_.flange_thickness), "flange", "flange_thickness");
    const section::Layup web = wall_of(own(s_.web, s_.web_thickness), "web", "web_thickness");
    return made(s_.kind == SectionShape::Kind::I ? section::i_section : section::c_section,
                s_.width, s_.height, flange, web);
  }

  section::Corners corners() const {
    return s_.corners == BoxCorners::butt ? section::Corners::butt : section::Corners::mitred;
  }

  section::Mesher of_contour() {
    section::Airfoil stated;
    if (!s_.points) fail("it has no points; give those of its outer surface");
    for (const auto& [x2, x3] : s_.points->all)
      stated.points.emplace_back(s_.unit * x2, s_.unit * x3);
    stated.corner_angle = s_.corner_angle;
    stated.corners = corners();
    for (const AirfoilSectorScene& sector : s_.sectors) {
      section::AirfoilSector part{sector.source, {}, {}, sector.bare, {}};
      std::tie(part.from, part.to) = places_of(sector);
      if (!sector.bare)
        part.layup = wall_of(part_of(sector), "layup", "thickness");
      else if (!sector.layup.empty() || !sector.material.empty() || sector.thickness)
        throw Error(sector.source,
                    of_ + ", sector: it is bare and has plies; leave one of them out");
      stated.sectors.push_back(std::move(part));
    }
    for (const AirfoilWebScene& web : s_.webs) {
      section::AirfoilWeb part{web.source, {}, {}, wall_of(part_of(web), "layup", "thickness")};
      std::tie(part.from, part.to) = places_of(web);
      if (!(web.from || web.from_point) || !(web.to || web.to_point))
        throw Error(web.source, of_ +
                                    ", web: its ends are missing; give from and to, fractions of "
                                    "the contour, or from_point and to_point");
      stated.webs.push_back(std::move(part));
    }
    for (const section::Point& x : stated.points) mesh_key_.insert(mesh_key_.end(), {x(0), x(1)});
    mesh_key_.push_back(s_.corner_angle);
    for (const auto& part : stated.sectors) {
      add_to_key(part);
      mesh_key_.push_back(part.bare);
    }
    for (const auto& part : stated.webs) add_to_key(part);
    return made(section::airfoil, stated);
  }

  void add_to_key(const auto& part) {
    for (const section::ContourPlace& at : {part.from, part.to})
      mesh_key_.insert(mesh_key_.end(), {static_cast<double>(at.point.value_or(0)), at.fraction});
  }

  // Of a sector or web: where it begins and ends.
  std::pair<section::ContourPlace, section::ContourPlace> places_of(const auto& part) const {
    for (const auto& [fraction, point, name] :
         {std::tuple{part.from, part.from_point, "from"}, {part.to, part.to_point, "to"}})
      if (fraction && point)
        throw Error(part.source, fmt::format("{0}, {1}: {2} and {2}_point say the same; leave one "
                                             "of them out",
                                             of_, part.item.element, name));
    return {{part.from_point, part.from.value_or(0.0)}, {part.to_point, part.to.value_or(1.0)}};
  }

  // Plies by the name of a layup, or one of a material; and who has them.
  struct Wall {
    const Source& source;
    std::string who;
    const std::string& layup;
    const std::string& material;
    std::optional<double> thickness;
    double angle;
  };
  Wall own(const std::string& layup, const std::optional<double>& thickness) const {
    return {s_.source, of_, layup, s_.material, thickness, s_.angle};
  }
  Wall part_of(const auto& part) const {
    if (part.layup.empty() ? !std::isfinite(part.angle) : part.angle != 0.0)
      throw Error(part.source,
                  fmt::format("{}, {}: angle is of a material that is given by itself; "
                              "those of plies stand in the layup",
                              of_, part.item.element));
    return {part.source,    fmt::format("{}, {}", of_, part.item.element),
            part.layup,     part.material,
            part.thickness, part.angle};
  }

  // What the room of sections refuses is told with the place of the shape, or of its part.
  template <class Make, class... Sizes>
  section::Mesher made(const Make& make, const Sizes&... sizes) const {
    const std::vector<section::MeshMaterial>& all = materials();
    try {
      return make(sizes..., all);
    } catch (const section::PartError& error) {
      throw Error(error.source, of_ + ", " + error.what());
    } catch (const Error& error) {
      fail(error.what());
    }
  }

  // Of a file; its groups are given materials by regions, or by the mesh's own.
  section::Mesher meshed() {
    const std::filesystem::path file = file_beside(s_.source, s_.file);
    section::GmshMesh read;
    try {
      read = section::read_gmsh(file, s_.unit);
    } catch (const Error& error) {
      fail(error.what());
    }
    std::vector<std::string_view> names;
    for (const std::string& group : read.groups) names.push_back(group);
    std::vector<section::MeshPart> parts(read.groups.size());
    std::vector<bool> stated(read.groups.size(), false);
    for (const MeshRegionScene& region : s_.regions) {
      const auto found = std::ranges::find(read.groups, region.name);
      if (found == read.groups.end())
        throw Error(region.source, fmt::format("{}, region: {} has no physical surface {}{}", of_,
                                               file.string(), in_quotes(excerpt(region.name)),
                                               suggest(region.name, names, "physical surfaces")));
      const auto g = static_cast<std::size_t>(found - read.groups.begin());
      if (stated[g])
        throw Error(region.source,
                    fmt::format("{}, region: {} has been stated before; leave one out", of_,
                                in_quotes(region.name)));
      stated[g] = true;
      if (!std::isfinite(region.angle) || !std::isfinite(region.normal))
        throw Error(region.source, fmt::format("{}, region {}: angle or normal is not finite", of_,
                                               in_quotes(region.name)));
      parts[g] = {number_of(region.material, region.source, of_ + ", region"), region.angle,
                  region.normal};
    }
    for (std::size_t g = 0; g < parts.size(); ++g) {
      if (stated[g]) continue;
      if (s_.material.empty() && read.groups[g].empty())
        fail(
            "what is of no physical surface has no material: give material, which elements of no "
            "<region> have");
      if (s_.material.empty())
        fail(
            fmt::format("physical surface {0} has no material: give <region name={0} "
                        "material=…/>, or material",
                        in_quotes(read.groups[g])));
      parts[g].material = number_of(s_.material, s_.source, of_);
    }
    for (std::size_t g = 0; g < parts.size(); ++g)
      mesh_key_.insert(mesh_key_.end(),
                       {parts[g].angle, parts[g].normal, static_cast<double>(parts[g].material)});
    read.each_number([this](double x) { mesh_key_.push_back(x); });
    return made([&](const std::vector<section::MeshMaterial>& all) {
      return section::mesher_of(read, parts, all);
    });
  }

  section::Mesher in_place(section::Mesher drawn) const {
    if (s_.x2 == 0.0 && s_.x3 == 0.0 && s_.turn == 0.0) return drawn;
    const double c = std::cos(s_.turn), s = std::sin(s_.turn);
    return [drawn = std::move(drawn), c, s, turn = s_.turn, x2 = s_.x2,
            x3 = s_.x3](const section::Fineness& fineness) {
      section::Mesh mesh = drawn(fineness);
      for (section::Point& x : mesh.nodes)
        x = section::Point(c * x(0) - s * x(1) + x2, s * x(0) + c * x(1) + x3);
      for (section::Element& element : mesh.elements)
        for (double& normal : element.normals) normal += turn;
      return mesh;
    };
  }

  section::Layup wall_of(const Wall& wall, std::string_view layup_attribute,
                         std::string_view own_attribute) {
    const auto refuse = [&wall](const std::string& what) {
      throw Error(wall.source, wall.who + ": " + what);
    };
    if (wall.material.empty() == wall.layup.empty())
      refuse(fmt::format("give {}, or material and {}{}", layup_attribute, own_attribute,
                         wall.layup.empty() ? "" : "; not both"));
    if (wall.layup.empty()) {
      if (!wall.thickness)
        refuse(
            fmt::format("attribute \"{}\" is missing: where there is a material and no layup, it "
                        "is of that [m]",
                        own_attribute));
      return one_ply(wall);
    }
    if (wall.thickness)
      refuse(fmt::format("{} is that of the layup; leave one of them out", own_attribute));
    const LayupScene& found = named(scene_.layups, wall.layup, wall.source, wall.who, "layups");
    section::Layup plies;
    for (const PlyScene& ply : found.plies) {
      const section::Ply next{number_of(ply.material, ply.source, label(found) + ", ply"),
                              ply.thickness, ply.angle};
      if (!plies.empty() && plies.back().material == next.material &&
          plies.back().angle == next.angle)
        plies.back().thickness += next.thickness;
      else
        plies.push_back(next);
    }
    if (plies.size() > most_plies)
      mbd::fail(found, fmt::format("it has {} plies, must have {} at most, where neighbours of one "
                                   "material and angle are one; put some together",
                                   plies.size(), most_plies));
    if (found.listed == ListedFrom::outside) plies = section::reversed(plies);
    layups_.push_back(plies);
    return plies;
  }

  section::Layup one_ply(const Wall& wall) {
    layups_.push_back(
        {{number_of(wall.material, wall.source, wall.who), *wall.thickness, wall.angle}});
    return layups_.back();
  }

  int number_of(const std::string& material, const Source& source, const std::string& who) {
    const MaterialScene& m = named(scene_.materials, material, source, who, "materials");
    if (const auto at = std::ranges::find(used_, &m); at != used_.end())
      return static_cast<int>(at - used_.begin());
    used_.push_back(&m);
    materials_.push_back(
        {stiffness_of(m), m.density.value_or(0.0), m.name, strengths_of(m), m.yield});
    return static_cast<int>(used_.size()) - 1;
  }

  // When all are known.
  const std::vector<section::MeshMaterial>& materials() const {
    for (const MaterialScene* m : used_)
      if (!m->density && has_mass())
        fail(
            fmt::format("material {} has no density rho, but others of the section have one; "
                        "give all or none",
                        in_quotes(m->name)));
    return materials_;
  }

  const Scene& scene_;
  const SectionShape& s_;
  std::string of_;
  std::vector<const MaterialScene*> used_;
  std::vector<section::MeshMaterial> materials_;  // of used_
  std::vector<section::Layup> layups_;
  std::vector<double> mesh_key_;  // all numbers of a mesh
};

// The entry of D whose error is the largest.
std::pair<std::string, double> worst_of(const section::Converged& c) {
  const Vec6 root = c.analysis.stiffness.diagonal().cwiseSqrt();
  Index i = 0, j = 0;
  const double worst =
      (c.error.array() / (root * root.transpose()).array()).matrix().maxCoeff(&i, &j);
  return {fmt::format("D{}{}", std::min(i, j) + 1, std::max(i, j) + 1), worst};
}

void clear_round_off(Mat6& matrix) {
  constexpr double round_off = 1e-10;
  const Vec6 root = matrix.diagonal().cwiseAbs().cwiseSqrt();
  for (Index i = 0; i < 6; ++i)
    for (Index j = i + 1; j < 6; ++j) {
      const double mean = 0.5 * (matrix(i, j) + matrix(j, i));
      matrix(i, j) = matrix(j, i) = std::abs(mean) <= round_off * root(i) * root(j) ? 0.0 : mean;
    }
}

section::Converged analysed(const SectionShape& shape, Shaped& shaped) {
  static std::mutex mutex;
  static std::map<std::vector<double>, section::Converged> known;
  const int most_unknowns = reading_limits().section_unknowns;
  const double tolerance = SectionShape::is_mesh(shape)      ? shape.mesh_tolerance
                           : SectionShape::is_airfoil(shape) ? shape.airfoil_tolerance
                                                             : shape.tolerance;
  constexpr std::size_t most_known = 100;
  const section::Mesher mesher = shaped.mesher();
  const std::vector<double> key = shaped.key();
  {
    const std::scoped_lock lock(mutex);
    if (const auto it = known.find(key); it != known.end()) return it->second;
  }
  section::Converged result;
  try {
    result = SectionShape::is_mesh(shape)
                 ? section::converge_orders(mesher, shape.curvature, tolerance, most_unknowns)
                 : section::converge(mesher, shape.curvature, tolerance, most_unknowns);
  } catch (const Error& error) {
    shaped.fail(error.what());
  }
  if (!result.reached) {
    const auto [entry, error] = worst_of(result);
    if (!std::isfinite(error))
      shaped.fail(fmt::format("its plies are too many for a mesh of {} unknowns; put some together",
                              most_unknowns));
    shaped.fail(
        fmt::format("tolerance {} is not reached with {} unknowns: {} is known to {:.1e} only; ask "
                    "for a tolerance above that, or {}",
                    tolerance, result.unknowns, entry, error,
                    SectionShape::is_mesh(shape) ? "make the mesh finer where stresses are singular"
                                                 : "put plies together"));
  }
  result.analysis.warping.resize(0, 0);
  const std::scoped_lock lock(mutex);
  if (known.size() >= most_known) known.clear();
  return known[key] = result;
}

// Of a section or station.
template <class Of>
void analyse_shape(const Scene& scene, Of& of, const std::string& label) {
  if (!of.shape) return;
  Shaped shaped(scene, *of.shape, label);
  const section::Converged c = analysed(*of.shape, shaped);
  of.stiffness = c.analysis.stiffness;
  clear_round_off(of.stiffness);
  const bool mass = shaped.has_mass() && (!of.mass || (of.found && of.found->mass));
  if (mass) {
    of.mass = c.analysis.mass;
    clear_round_off(*of.mass);
  }
  const Vec6 root = of.stiffness.diagonal().cwiseSqrt();
  of.found = ShapeFound{c.error.cwiseQuotient(root * root.transpose()), c.elements, c.unknowns,
                        c.fineness.order, mass};
}

}  // namespace

section::Stiffness stiffness_of(const MaterialScene& material) {
  const EngineeringConstants constants = constants_of(material);
  try {
    return section::stiffness_of(constants);
  } catch (const Error& error) {
    fail(material, error.what());
  }
}

section::Mesher mesher_of(const Scene& scene, const SectionShape& shape, const std::string& of) {
  return Shaped(scene, shape, of).mesher();
}

section::Converged analysed(const Scene& scene, const SectionShape& shape, const std::string& of) {
  Shaped shaped(scene, shape, of);
  return analysed(shape, shaped);
}

namespace {
std::shared_ptr<const section::StressField> field_of(const SectionShape& shape,
                                                     const section::Mesher& mesher,
                                                     const section::Fineness& fineness) {
  section::Mesh mesh = mesher(fineness);
  const section::Analysis analysis = section::analyse(mesh, shape.curvature);
  return std::make_shared<section::StressField>(std::move(mesh), shape.curvature, analysis);
}
}  // namespace

std::shared_ptr<const section::StressField> stress_field(const Scene& scene,
                                                         const SectionShape& shape,
                                                         const std::string& of) {
  return field_of(shape, mesher_of(scene, shape, of), analysed(scene, shape, of).fineness);
}

StressFields stress_fields(const Scene& scene, const SectionShape& shape, const std::string& of) {
  const section::Mesher mesher = mesher_of(scene, shape, of);
  const section::Fineness fine = analysed(scene, shape, of).fineness;
  return {field_of(shape, mesher, fine),
          field_of(shape, mesher, {std::max(fine.order - 1, 1), std::max(fine.layers - 1, 1)})};
}

void analyse_shapes(Scene& scene) {
  for (const MaterialScene& material : scene.materials) {
    stiffness_of(material);
    strengths_of(material);
  }
  for (const LayupScene& layup : scene.layups)
    for (const PlyScene& ply : layup.plies)
      named(scene.materials, ply.material, ply.source, label(layup) + ", ply", "materials");
  for (Section& section : scene.sections) {
    analyse_shape(scene, section, label(section));
    for (Station& station : section.stations)
      analyse_shape(scene, station, fmt::format("{}, station at {}", label(section), station.at));
  }
}

}  // namespace mbd
