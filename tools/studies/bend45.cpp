// The paper's first example (HB 9.1, models/bend45.xml): figures 4 and 5, error of the tip's displacement over
// the number of elements, for Gauss-Lobatto and Gauss; the same over CPU time; figures 6 and 7, interpolated
// and assumed strains along the root element.
#include <fmt/format.h>

#include <cstdio>
#include <numbers>

#include "elements/beam/beam_field.hpp"
#include "libmbd/language/reader.hpp"
#include "tools/studies/study.hpp"

namespace mbd::studies {
namespace {

// Converged, 20 digits, calculated apart from this project in extended precision [in].
const Vec3 converged(-13.73548151312558962, -23.82504922387786265, 53.61385809953141840);

constexpr int bend_orders[] = {1, 2, 3, 4, 5, 6};
constexpr int bend_meshes[] = {1, 2, 4, 8, 16, 32};

// In inches and pounds.
Scene bend(const Series& series, Rule rule, int order, int elements) {
  Scene scene = read_model(std::filesystem::path(MBD_SOURCE_DIR) / "models" / "bend45.xml",
                           {{"in", "1"}, {"lb", "1"}});
  BeamScene& beam = scene.beams.at(0);
  series.choose(beam);
  beam.rule = rule;
  beam.order = order;
  beam.elements = elements;
  return scene;
}

struct Point {
  const Series* series;
  Rule rule;
  int order, elements;
  double error, cpu;
};

std::vector<Point> convergence(const std::filesystem::path& directory) {
  Csv csv(
      "# bend45: relative error of the tip's displacement (Euclidean norm), CPU time of the static "
      "solution; lengths in inches\n"
      "rule,form,series,order,elements,converged,error,cpu_seconds,iterations,load_steps,u1,u2,u3");
  std::vector<Point> points;
  for (const Rule rule : {Rule::gauss_lobatto, Rule::gauss}) {
    for (const Series& series : all_series()) {
      for (const int order : bend_orders) {
        for (const int elements : bend_meshes) {
          const Solution s = solve(bend(series, rule, order, elements), 3);
          const double error = (s.tip() - converged).norm() / converged.norm();
          csv << name_of(rule) << series.form << series.name << long{order} << long{elements};
          csv << long{s.converged};
          if (s.converged)
            csv << error << s.cpu << s.iterations << s.load_steps << s.tip()(0) << s.tip()(1)
                << s.tip()(2);
          else
            csv << ""
                << "" << s.iterations << s.load_steps << ""
                << ""
                << "";
          csv.end_row();
          if (s.converged) points.push_back({&series, rule, order, elements, error, s.cpu});
        }
      }
      std::printf("bend45, %s, %s, %s\n", name_of(rule).c_str(), series.form.c_str(),
                  series.name.c_str());
      std::fflush(stdout);
    }
  }
  write(directory, "bend45.csv", csv.text());
  return points;
}

// Forms in the order in which they first appear, and the series of each.
std::vector<std::vector<const Series*>> by_form() {
  std::vector<std::vector<const Series*>> forms;
  for (const Series& series : all_series()) {
    auto found = forms.begin();
    while (found != forms.end() && found->front()->form != series.form) ++found;
    if (found == forms.end()) found = forms.insert(forms.end(), {{}});
    found->push_back(&series);
  }
  return forms;
}

plot::Curve curve_of(const std::vector<Point>& points, const Series* series, Rule rule, int order,
                     double Point::*x, const std::string& label, int style) {
  plot::Curve curve{label, {}, style};
  for (const Point& p : points)
    if (p.series == series && p.rule == rule && p.order == order)
      curve.trace.add({x != nullptr ? p.*x : p.elements, p.error});
  return curve;
}

void figures_4_and_5(const std::filesystem::path& directory, const std::vector<Point>& points) {
  for (const Rule rule : {Rule::gauss_lobatto, Rule::gauss}) {
    std::vector<plot::Panel> panels;
    for (const auto& form : by_form()) {
      plot::Panel panel{.title = form.front()->form + " form",
                        .x_label = "number of elements",
                        .y_label = "error in tip displacement",
                        .x_log = true,
                        .y_log = true};
      int style = 0;
      for (const Series* series : form) {
        for (const int order : bend_orders)
          panel.curves.push_back(curve_of(points, series, rule, order, nullptr,
                                          order == bend_orders[0] ? series->name : "", style));
        ++style;
      }
      panels.push_back(std::move(panel));
    }
    const bool gauss = rule == Rule::gauss;
    write(directory, gauss ? "figure_5.svg" : "figure_4.svg",
          plot::to_svg(panels, {.columns = 2,
                                .note = "N = 1 … 6 from above; meshes without equilibrium are left "
                                        "out. Round-off is 1e-15.",
                                .title = gauss ? "bend45, Gauss rules (the paper's figure 5)"
                                               : "bend45, Gauss-Lobatto rules (figure 4)"}));
  }
}

void error_over_cpu(const std::filesystem::path& directory, const std::vector<Point>& points) {
  std::vector<plot::Panel> panels;
  for (const Series& series : all_series()) {
    plot::Panel panel{.title = series.form + " form, " + series.name,
                      .x_label = "CPU time [s]",
                      .y_label = "error in tip displacement",
                      .x_log = true,
                      .y_log = true};
    for (const int order : bend_orders)
      panel.curves.push_back(curve_of(points, &series, Rule::gauss, order, &Point::cpu,
                                      fmt::format("N = {}", order), order - 1));
    panels.push_back(std::move(panel));
  }
  write(directory, "error_over_cpu.svg",
        plot::to_svg(panels, {.columns = 3,
                              .note = "1, 2, 4 … 32 elements; time of the static solution alone, "
                                      "tolerance 1e-12.",
                              .title = "bend45, Gauss rules: error over CPU time"}));
}

// Strains of the root element, 8 four-node elements, at 201 places.
struct Strains {
  std::string name;
  std::vector<double> xi;
  std::vector<Vec6> interpolated, assumed;
  std::vector<double> gauss, nodes;  // places
};

template <class MetricType>
Strains root_strains(Metric metric, const std::string& name) {
  const Series series{"paper", name, [metric](BeamScene& beam) {
                        beam.form = Form::paper;
                        beam.metric = metric;
                      }};
  const Solution s = solve(bend(series, Rule::gauss, 3, 8));
  const SpectralTable table = spectral_table(3, Rule::gauss);
  const std::vector<double> J(4, 0.5 * 100 * std::numbers::pi / 4 / 8);
  const auto nodes = [](const State& state) {  // node 0 is the ground
    return std::vector<Pose<double>>(state.pose.begin() + 1, state.pose.begin() + 5);
  };
  const auto before = nodes(s.reference), after = nodes(s.state);
  const auto interpolated = [&](const std::vector<Pose<double>>& pose, double xi) -> Vec6 {
    return beam::interpolated_field<MetricType, double>(table, J, pose, xi).K;
  };
  const auto assumed = [&](const std::vector<Pose<double>>& pose, double xi) -> Vec6 {
    return beam::assumed_curvature<MetricType>(table, J, pose, xi);
  };
  Strains strains{name, {}, {}, {}, table.rule.points, table.nodes.points};
  for (int i = 0; i <= 200; ++i) {
    const double xi = -1 + i / 100.0;
    strains.xi.push_back(xi);
    strains.interpolated.push_back(interpolated(after, xi) - interpolated(before, xi));
    strains.assumed.push_back(assumed(after, xi) - assumed(before, xi));
  }
  return strains;
}

// The value at a place, between the 201.
double at_place(const std::vector<double>& xi, const std::vector<Vec6>& E, Index component,
                double place) {
  const double p = (place + 1) * 100.0;
  const auto i = std::min(static_cast<std::size_t>(p), xi.size() - 2);
  const double part = p - static_cast<double>(i);
  return (1 - part) * E[i](component) + part * E[i + 1](component);
}

void figures_6_and_7(const std::filesystem::path& directory) {
  const Strains all[] = {root_strains<MatrixMetric>(Metric::matrix, "matrix"),
                         root_strains<QuaternionMetric>(Metric::quaternion, "quaternion"),
                         root_strains<GeodesicMetric>(Metric::geodesic, "geodesic")};
  Csv csv(
      "# bend45, 8 four-node elements, the paper's form: strains along the root element\n"
      "series,xi,axial_interpolated,axial_assumed,shear12_interpolated,shear12_assumed");
  for (const Strains& s : all)
    for (std::size_t i = 0; i < s.xi.size(); ++i) {
      csv << s.name << s.xi[i] << s.interpolated[i](0) << s.assumed[i](0) << s.interpolated[i](1)
          << s.assumed[i](1);
      csv.end_row();
    }
  write(directory, "root_strains.csv", csv.text());
  for (const Index component : {0, 1}) {
    std::vector<plot::Panel> panels;
    for (const Strains& s : {all[1], all[2], all[0]}) {
      plot::Panel panel{.title = s.name + " metric",
                        .x_label = "ξ",
                        .y_label = component == 0 ? "axial strain [1e-6]" : "shear strain [1e-6]",
                        .x_range = std::array{-1.0, 1.0}};
      plot::Curve interpolated{"interpolated", {}, 1}, assumed{"assumed", {}, 0};
      for (std::size_t i = 0; i < s.xi.size(); ++i) {
        interpolated.trace.add({s.xi[i], 1e6 * s.interpolated[i](component)});
        assumed.trace.add({s.xi[i], 1e6 * s.assumed[i](component)});
      }
      panel.curves = {interpolated, assumed};
      const auto places = [&](const std::vector<double>& at) {
        std::vector<plot::Point> points;
        for (const double xi : at)
          points.push_back({xi, 1e6 * at_place(s.xi, s.interpolated, component, xi)});
        return points;
      };
      add_points(panel, "at Gauss points", 4, places(s.gauss));
      add_points(panel, "at nodes", 2, places(s.nodes));
      panels.push_back(std::move(panel));
    }
    write(directory, component == 0 ? "figure_6.svg" : "figure_7.svg",
          plot::to_svg(panels,
                       {.columns = 1,
                        .note = "8 four-node elements, the paper's form. The greatest strains "
                                "of the paper's figures, 250 and 80, are the quaternion metric's.",
                        .title = component == 0 ? "bend45: axial strain of the root element"
                                                : "bend45: shear strain γ12 of the root element"}));
  }
}

}  // namespace

void bend45(const std::filesystem::path& directory) {
  const std::vector<Point> points = convergence(directory);
  figures_4_and_5(directory, points);
  error_over_cpu(directory, points);
  figures_6_and_7(directory);
}

}  // namespace mbd::studies
