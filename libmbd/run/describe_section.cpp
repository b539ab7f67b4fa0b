#include "libmbd/run/describe_section.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string_view>

#include "libmbd/language/schema.hpp"
#include "libmbd/material/shaped_sections.hpp"
#include "libmbd/scene/label.hpp"
#include "libmbd/scene/section_table.hpp"
#include "libmbd/text/spelling.hpp"
#include "libmbd/text/tables.hpp"

namespace mbd {
namespace {

using Json = nlohmann::ordered_json;
using Mat2 = Eigen::Matrix2d;

// What is round-off of an angle or of a length over that of the section is zero.
double clean(double x, double scale) { return std::abs(x) < 1e-9 * scale ? 0.0 : x; }

template <class Of>
SectionReport report_of(const Scene& scene, const std::string& name, const Of& of) {
  SectionReport r;
  r.section = name;
  const Source& source = of.shape ? of.shape->source : of.source;
  r.from = of.shape ? std::string(element_of(*of.shape)) : "matrices";
  if (source.line > 0) r.from += fmt::format(", {}:{}", source.file, source.line);
  r.stiffness = of.stiffness;
  r.mass = of.mass;
  r.found = of.found;

  const Mat6 s = of.stiffness.inverse();
  // A length of the section: that of its bending over its stretching.
  const double size = std::sqrt(std::max(s(0, 0) / s(4, 4), s(0, 0) / s(5, 5)));
  if (of.mass && (*of.mass)(0, 0) > 0.0) {
    const Mat6& m = *of.mass;
    r.mass_centre = {clean(-m(0, 5) / m(0, 0), size), clean(m(0, 4) / m(0, 0), size)};
  }
  // A force N1 at (y2, y3) has the moments y3 N1, -y2 N1 about b2 and b3.
  Mat2 bend;
  bend << s(4, 4), s(4, 5), s(5, 4), s(5, 5);
  const Eigen::Vector2d moments = -bend.inverse() * Eigen::Vector2d(s(4, 0), s(5, 0));
  r.tension_centre = {clean(-moments(1), size), clean(moments(0), size)};
  // Forces Q2, Q3 at (y2, y3) have the moment y2 Q3 - y3 Q2 about b1.
  r.shear_centre = {clean(-s(3, 2) / s(3, 3), size), clean(s(3, 1) / s(3, 3), size)};

  Eigen::SelfAdjointEigenSolver<Mat2> bending(Mat2(bend.inverse()));
  r.bending = {bending.eigenvalues()(1), bending.eigenvalues()(0)};
  const Eigen::Vector2d axis = bending.eigenvectors().col(1);
  double angle = std::atan2(axis(1), axis(0));
  if (angle > 0.5 * std::numbers::pi) angle -= std::numbers::pi;
  if (angle <= -0.5 * std::numbers::pi + 1e-12) angle += std::numbers::pi;
  // Where both are the same, any axis is one.
  r.bending_axis = r.bending[0] - r.bending[1] < 1e-9 * r.bending[0] ? 0.0 : clean(angle, 1.0);

  for (Index i = 0; i < 2; ++i)
    r.shear[static_cast<std::size_t>(i)] =
        1.0 / (s(1 + i, 1 + i) - s(1 + i, 3) * s(3, 1 + i) / s(3, 3));
  if (of.shape) {
    const std::string label = mbd::label("section", name);
    const section::Mesh mesh = mesher_of(scene, *of.shape, label)({1, 1});
    const section::Stiffness& c = mesh.materials.front().stiffness;
    const double g = c(5, 5);
    section::Stiffness isotropic = c;
    isotropic.setZero();
    isotropic.diagonal() << c(0, 0), c(0, 0), c(0, 0), g, g, g;
    for (const auto& [i, j] : {std::pair{0, 1}, {0, 2}, {1, 2}})
      isotropic(i, j) = isotropic(j, i) = c(0, 0) - 2.0 * g;
    const double area = analysed(scene, *of.shape, label).analysis.area;
    if (mesh.materials.size() == 1 && (c - isotropic).cwiseAbs().maxCoeff() < 1e-9 * c(0, 0) &&
        of.shape->curvature.isZero(0.0))
      r.shear_coefficients = {r.shear[0] / (g * area), r.shear[1] / (g * area)};
  }
  return r;
}

std::string number(double x) { return x == 0.0 ? "0" : fmt::format("{:.8g}", x); }

std::string matrix_text(std::string_view title, const Mat6& m, const auto& cell) {
  std::string text = fmt::format("{}\n", title);
  std::vector<std::vector<std::string>> rows;
  std::array<std::size_t, 6> width{};
  for (Index i = 0; i < 6; ++i) {
    rows.emplace_back();
    for (Index j = 0; j < 6; ++j) {
      rows.back().push_back(cell(m(i, j)));
      auto& w = width[static_cast<std::size_t>(j)];
      w = std::max(w, rows.back().back().size());
    }
  }
  for (const auto& row : rows) {
    text += " ";
    for (std::size_t j = 0; j < 6; ++j) text += fmt::format(" {:>{}}", row[j], width[j]);
    text += "\n";
  }
  return text;
}

Json json_of(const Mat6& m) {
  Json rows = Json::array();
  for (Index i = 0; i < 6; ++i) {
    Json row = Json::array();
    for (Index j = 0; j < 6; ++j) row.push_back(m(i, j));
    rows.push_back(std::move(row));
  }
  return rows;
}

std::string point_text(const std::array<double, 2>& x) {
  return fmt::format("x2 = {}, x3 = {} m", number(x[0]), number(x[1]));
}

}  // namespace

std::vector<SectionReport> describe_sections(const Scene& scene, const std::string& name) {
  std::vector<SectionReport> reports;
  std::vector<std::string_view> names;
  for (const Section& section : scene.sections) {
    names.push_back(section.name);
    if (!name.empty() && section.name != name) continue;
    check_section(section);
    if (section.stations.empty()) reports.push_back(report_of(scene, section.name, section));
    for (const Station& station : section.stations) {
      reports.push_back(report_of(scene, section.name, station));
      reports.back().at = station.at;
    }
  }
  if (names.empty()) throw Error(scene.source, "the model has no <section>");
  if (reports.empty())
    throw Error(scene.source, fmt::format("there is no section {}{}", in_quotes(excerpt(name)),
                                          suggest(name, names, "sections")));
  return reports;
}

std::string to_text(const SectionReport& r) {
  std::string text = label("section", r.section);
  if (r.at) text += fmt::format(", station at {}", schema::shortest(*r.at));
  text += fmt::format(": {}\n", r.from);
  text += matrix_text(
      "D, from [stretch shear2 shear3; twist curvature2 curvature3] to [N1 Q2 Q3; M1 M2 M3]\n"
      "[N, N.m; N.m, N.m2]",
      r.stiffness, number);
  if (r.found)
    text += matrix_text("Error of D, estimated, an entry ij over sqrt(Dii Djj)", r.found->error,
                        [](double x) { return fmt::format("{:.0e}", x); });
  if (r.mass)
    text +=
        matrix_text("M, from [v; w] to momenta per length [kg/m, kg; kg, kg.m]", *r.mass, number);
  const auto line = [&text](std::string_view name, const std::string& value) {
    text += fmt::format("{:<19}{}\n", name, value);
  };
  if (r.mass) line("mass per length", number((*r.mass)(0, 0)) + " kg/m");
  if (r.mass_centre) line("mass centre", point_text(*r.mass_centre));
  line("tension centre", point_text(r.tension_centre));
  line("shear centre", point_text(r.shear_centre));
  line("principal bending",
       fmt::format("{} N.m2 about the axis at {} deg from b2, {} N.m2 about that across it",
                   number(r.bending[0]), number(r.bending_axis * 180.0 / std::numbers::pi),
                   number(r.bending[1])));
  line("shear stiffness", fmt::format("{} N along b2, {} N along b3 at the shear centre",
                                      number(r.shear[0]), number(r.shear[1])));
  if (r.shear_coefficients)
    line("shear coefficients",
         fmt::format("{} along b2, {} along b3, of G A", number((*r.shear_coefficients)[0]),
                     number((*r.shear_coefficients)[1])));
  if (r.found)
    line("mesh", fmt::format("{} elements of order {}, {} unknowns; largest error {:.0e}",
                             r.found->elements, r.found->order, r.found->unknowns,
                             r.found->error.maxCoeff()));
  return text;
}

std::string to_json(const std::vector<SectionReport>& reports) {
  Json all = Json::array();
  for (const SectionReport& r : reports) {
    Json one{{"section", r.section}};
    if (r.at) one["at"] = *r.at;
    one["from"] = r.from;
    one["D"] = json_of(r.stiffness);
    if (r.found) one["error_of_D"] = json_of(r.found->error);
    if (r.mass) {
      one["M"] = json_of(*r.mass);
      one["mass_per_length"] = (*r.mass)(0, 0);
    }
    if (r.mass_centre) one["mass_centre"] = *r.mass_centre;
    one["tension_centre"] = r.tension_centre;
    one["shear_centre"] = r.shear_centre;
    one["principal_bending"] = {{"stiffness", r.bending}, {"axis", r.bending_axis}};
    one["shear_stiffness"] = r.shear;
    if (r.shear_coefficients) one["shear_coefficients"] = *r.shear_coefficients;
    if (r.found)
      one["mesh"] = {{"elements", r.found->elements},
                     {"order", r.found->order},
                     {"unknowns", r.found->unknowns}};
    all.push_back(std::move(one));
  }
  return all.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string to_csv(const std::vector<SectionReport>& reports) {
  std::string text = "section,at,matrix,row,1,2,3,4,5,6\n";
  for (const SectionReport& r : reports) {
    const auto add = [&](std::string_view matrix, const Mat6& m) {
      for (Index i = 0; i < 6; ++i) {
        text += fmt::format("{},{},{},{}", study::csv_cell(r.section),
                            r.at ? schema::shortest(*r.at) : "", matrix, i + 1);
        for (Index j = 0; j < 6; ++j) text += "," + schema::shortest(m(i, j));
        text += "\n";
      }
    };
    add("D", r.stiffness);
    if (r.found) add("error", r.found->error);
    if (r.mass) add("M", *r.mass);
  }
  return text;
}

}  // namespace mbd
