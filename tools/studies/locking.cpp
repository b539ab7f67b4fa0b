// Locking: error of the tip's displacement of slender cantilevers over their slenderness, on a fixed mesh, for
// Gauss and Gauss-Lobatto rules.
//
// A cantilever of length 1 with a square section of height h = 1/slenderness and EI = 1, so EA = 12/h^2 and
// GA = 5/h^2 (Poisson's ratio 0, shear factor 5/6): bending stays as it is, extension and shear become as stiff
// as you like. A dead force of 2 across its tip: `straight`; or the same force towards the centre of a quarter
// circle: `arc`. In the limit the straight one is the elastica: shortening .160641721, deflection .493457480.
// Reference: 8 elements of order 8, geodesic metric, energy form, Gauss; 16 elements of order 7 differ by less
// than is told in the table.
#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <numbers>

#include "tools/studies/study.hpp"

namespace mbd::studies {
namespace {

constexpr int elements = 4;
constexpr int locking_orders[] = {1, 2, 3, 4};

enum class Line { straight, arc };
std::string name_of(Line line) { return line == Line::straight ? "straight" : "arc"; }

Scene cantilever(Line line, double slenderness) {
  Scene scene;
  scene.name = "cantilever";
  const double h = 1.0 / slenderness, EA = 12 / (h * h), GA = 5 / (h * h);
  Section section;
  section.name = "square";
  section.stiffness = Vec6(EA, GA, GA, 0.843462, 1.0, 1.0).asDiagonal();  // GJ = .1405770 h^4 E/2
  BeamScene beam;
  beam.name = "beam";
  beam.section = section.name;
  if (line == Line::straight) {
    beam.line = Straight{Vec3::Zero(), Vec3::UnitX()};
  } else {
    Arc arc;
    arc.center = Vec3(0, 2 / std::numbers::pi, 0);
    arc.axis = Vec3::UnitZ();
    arc.angle = std::numbers::pi / 2;
    beam.line = arc;
  }
  const auto place = [&beam](double parameter) {
    return Place{Place::Kind::beam, beam.name, parameter};
  };
  JointScene clamp;
  clamp.kind = "fixed";
  clamp.name = "clamp";
  clamp.b = place(0.0);
  LoadScene load;
  load.at = place(1.0);
  const auto number = [](const char* text) { return Expression::parse(text, {}, Variables::time); };
  load.force = line == Line::straight ? std::array{number("0"), number("2"), number("0")}
                                      : std::array{number("-2"), number("0"), number("0")};
  scene.sections = {section};
  scene.beams = {beam};
  scene.joints = {clamp};
  scene.loads = {load};
  scene.statics = StaticScene{{}, 4, 1e-12};
  return scene;
}

Solution solved(Line line, double slenderness, const std::function<void(BeamScene&)>& choose,
                Rule rule, int order, int count) {
  Scene scene = cantilever(line, slenderness);
  BeamScene& beam = scene.beams[0];
  choose(beam);
  beam.rule = rule;
  beam.order = order;
  beam.elements = count;
  return solve(scene);
}

struct TipReference {
  Vec3 tip;
  double uncertainty;
};

TipReference reference_of(Line line, double slenderness) {
  const auto best = [](BeamScene& beam) {
    beam.metric = Metric::geodesic;
    beam.form = Form::energy;
  };
  const Solution a = solved(line, slenderness, best, Rule::gauss, 8, 8);
  const Solution b = solved(line, slenderness, best, Rule::gauss, 7, 16);
  const TipReference reference{a.tip(), (b.tip() - a.tip()).norm() / a.tip().norm()};
  std::printf("locking, %s, slenderness %.3g: reference (%.12g, %.12g), +- %.1e%s\n",
              name_of(line).c_str(), slenderness, reference.tip(0), reference.tip(1),
              reference.uncertainty, a.converged && b.converged ? "" : ", not converged");
  std::fflush(stdout);
  return reference;
}

}  // namespace

void locking(const std::filesystem::path& directory) {
  Csv csv(fmt::format(
      "# locking: relative error of the tip's displacement, {} elements; reference_uncertainty: "
      "difference of two references\n"
      "line,form,series,rule,order,slenderness,converged,error,iterations,load_steps,reference_u1,"
      "reference_u2,"
      "reference_uncertainty",
      elements));
  for (const Line line : {Line::straight, Line::arc}) {
    std::vector<plot::Panel> panels;
    for (const Series& series : all_series())
      panels.push_back({.title = series.form + " form, " + series.name,
                        .x_label = "slenderness",
                        .y_label = "error in tip displacement",
                        .x_log = true,
                        .y_log = true,
                        .curves = std::vector<plot::Curve>(2 * std::size(locking_orders))});
    for (int i = 0; i <= 8; ++i) {
      const double slenderness = std::pow(10.0, 1 + 0.5 * i);
      const auto [reference, uncertainty] = reference_of(line, slenderness);
      for (std::size_t s = 0; s < all_series().size(); ++s) {
        const Series& series = all_series()[s];
        for (const Rule rule : {Rule::gauss, Rule::gauss_lobatto}) {
          for (std::size_t n = 0; n < std::size(locking_orders); ++n) {
            const Solution solution =
                solved(line, slenderness, series.choose, rule, locking_orders[n], elements);
            const double error = (solution.tip() - reference).norm() / reference.norm();
            csv << name_of(line) << series.form << series.name << studies::name_of(rule)
                << long{locking_orders[n]} << slenderness << long{solution.converged};
            csv << (solution.converged ? std::optional(error) : std::nullopt) << solution.iterations
                << solution.load_steps << reference(0) << reference(1) << uncertainty;
            csv.end_row();
            const bool gauss = rule == Rule::gauss;
            plot::Curve& curve = panels[s].curves[2 * n + (gauss ? 0 : 1)];
            curve.style = gauss ? 0 : 2;
            curve.label = n > 0 ? "" : gauss ? "Gauss" : "Gauss-Lobatto";
            if (solution.converged) curve.trace.add({slenderness, error});
          }
        }
      }
    }
    write(directory, "locking_" + name_of(line) + ".svg",
          plot::to_svg(
              panels,
              {.columns = 3,
               .note = fmt::format(
                   "{} elements; N = 1 … 4 from above, N = 1 alike for both rules. Meshes without "
                   "equilibrium are left out.",
                   elements),
               .title = "Locking: " + name_of(line) + " cantilever"}));
  }
  write(directory, "locking.csv", csv.text());
}

}  // namespace mbd::studies
