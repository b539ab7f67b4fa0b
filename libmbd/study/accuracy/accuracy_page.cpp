#include "libmbd/study/accuracy/accuracy_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>
#include <string_view>

#include "libmbd/pictures/page.hpp"
#include "libmbd/pictures/plot.hpp"
#include "libmbd/study/accuracy/accuracy_words.hpp"
#include "libmbd/text/text.hpp"

namespace mbd::study_page {
namespace {

using namespace study;

// --- pictures ---

// Of plot.hpp's styles: as many families can be told from each other.
constexpr std::size_t styles = 6;

// Where the error is drawn. One that is exactly zero is drawn as large as the reference's own.
std::optional<double> height_of(const AccuracyStudy& study, std::size_t point, std::size_t q) {
  if (!known(study, point, q)) return std::nullopt;
  const double rms = study.points[point].errors[q].rms;
  const double height = rms > 0.0 ? rms : study.quantities[q].reference_rms;
  if (!(height > 0.0) || !std::isfinite(height)) return std::nullopt;
  return height;
}

// Which families have a style and a name: all, if there are not more than styles; else those with the most `merit`.
// Entries: the style, or -1.
std::vector<int> styles_of(const std::vector<double>& merit) {
  std::vector<std::size_t> order(merit.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (merit.size() > styles) {
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return merit[a] > merit[b]; });
    order.resize(styles);
    std::erase_if(order, [&](std::size_t i) { return !(merit[i] > 0.0); });
    std::sort(order.begin(), order.end());
  }
  std::vector<int> result(merit.size(), -1);
  for (std::size_t i = 0; i < order.size(); ++i) result[order[i]] = static_cast<int>(i);
  return result;
}

std::string title_of(const AccuracyStudy& study, const Quantity& quantity) {
  const std::string until = until_text(study, quantity);
  return quantity.name + (until.empty() ? "" : ", " + until);
}

// Adds a curve of each family; those without a style pale, with one name for all.
void add_families(plot::Panel& panel, const AccuracyStudy& study, std::size_t q,
                  const std::vector<Family>& families, const std::vector<int>& style,
                  const std::function<std::optional<double>(std::size_t)>& x) {
  bool named = false;
  for (std::size_t f = 0; f < families.size(); ++f) {
    plot::Curve curve;
    curve.pale = style[f] < 0;
    curve.style = style[f];
    for (const std::size_t point : families[f].points) {
      const std::optional<double> height = height_of(study, point, q), at = x(point);
      if (!height || !at) continue;
      curve.trace.add({*at, *height});
      curve.hollow.push_back(study.points[point].errors[q].below_reference);
    }
    if (curve.hollow.empty()) continue;
    if (!curve.pale) curve.label = families[f].label.empty() ? "runs" : families[f].label;
    if (curve.pale && !named) {
      curve.label = "other settings";
      named = true;
    }
    panel.curves.push_back(std::move(curve));
  }
}

// The reference's own error is drawn where it does not press the curves together.
void add_level(plot::Panel& panel, const Quantity& quantity) {
  constexpr double nearest = 30.0;
  double least = std::numeric_limits<double>::infinity();
  for (const plot::Curve& curve : panel.curves)
    for (const plot::Point& p : curve.trace.points()) least = std::min(least, p[1]);
  if (quantity.reference_rms > 0.0 && quantity.reference_rms * nearest >= least)
    panel.levels.push_back(
        {quantity.reference_rms, "reference's own error " + bound_text(quantity.reference_rms)});
}

bool resolved(const Quantity& quantity) { return quantity.until > 0.0; }

// Error over CPU time, a panel for each quantity that has errors; and which quantity each is of.
std::vector<plot::Panel> cost_panels(const AccuracyStudy& study, std::vector<std::size_t>& of) {
  const std::vector<Family> families = families_of(study);
  std::vector<double> merit(families.size());
  for (std::size_t f = 0; f < families.size(); ++f)
    for (std::size_t q = 0; q < study.quantities.size(); ++q)
      for (const std::size_t point : families[f].points)
        merit[f] += on_front(study, point, q) ? 1.0 : 0.0;
  const std::vector<int> style = styles_of(merit);
  std::vector<plot::Panel> panels;
  for (std::size_t q = 0; q < study.quantities.size(); ++q) {
    if (!resolved(study.quantities[q])) continue;
    plot::Panel panel{.title = title_of(study, study.quantities[q]),
                      .x_label = "CPU time of the whole run [s]",
                      .y_label = "error (rms)",
                      .x_log = true,
                      .y_log = true};
    add_families(panel, study, q, families, style, [&](std::size_t point) -> std::optional<double> {
      const double cpu = study.points[point].trial.cpu;
      return cpu > 0.0 ? std::optional(cpu) : std::nullopt;
    });
    if (panel.curves.empty()) continue;
    plot::Curve front;
    front.label = "cheapest for its error";
    front.style = 0;
    front.wide = front.plain = true;
    if (q < study.fronts.size())
      for (const std::size_t point : study.fronts[q])
        if (const std::optional<double> height = height_of(study, point, q))
          front.trace.add({study.points[point].trial.cpu, *height});
    if (front.trace.points().size() > 1) panel.curves.push_back(std::move(front));
    std::stable_partition(panel.curves.begin(), panel.curves.end(),
                          [](const plot::Curve& c) { return !c.pale; });
    add_level(panel, study.quantities[q]);
    panels.push_back(std::move(panel));
    of.push_back(q);
  }
  return panels;
}

// A triangle below the fitted line, between two neighbouring points near its middle. The picture spans `width` and
// `decades` powers of ten.
std::optional<plot::Slope> slope_of(const AccuracyStudy& study, const OrderFit& fit, double width,
                                    double decades) {
  std::vector<double> x;
  double log_x = 0.0, log_y = 0.0;
  for (const std::size_t point : fit.points) {
    const std::optional<double> at = number_of(study.points[point].setting, fit.knob);
    const std::optional<double> height = height_of(study, point, fit.quantity);
    if (!at || !height) return std::nullopt;
    x.push_back(*at);
    log_x += std::log10(*at);
    log_y += std::log10(*height);
  }
  std::sort(x.begin(), x.end());
  x.erase(std::unique(x.begin(), x.end()), x.end());
  if (x.size() < 2 || !std::isfinite(fit.slope)) return std::nullopt;
  const auto n = static_cast<double>(fit.points.size());
  const double below = 0.05 * decades;
  const auto line = [&](double at) {
    return std::pow(10.0, (log_y - fit.slope * log_x) / n + fit.slope * std::log10(at) - below);
  };
  const std::size_t i = (x.size() - 2) / 2;
  // Its width: half of what lies between the points, or less.
  const double middle = std::sqrt(x[i] * x[i + 1]);
  const double ratio = std::min(std::sqrt(x[i + 1] / x[i]), std::pow(10.0, 0.15 * width));
  std::string text = fmt::format("{:.2f}", fit.slope);
  if (fit.theory) text += fmt::format(" ({:g})", *fit.theory);
  for (std::size_t at = text.find('-'); at != std::string::npos; at = text.find('-', at))
    text.replace(at, 1, "−");
  const double left = middle / std::sqrt(ratio), right = middle * std::sqrt(ratio);
  return plot::Slope{{left, line(left)}, {right, line(right)}, std::move(text)};
}

// One triangle for each theoretical order, three at most: more would hide the curves.
void add_slopes(plot::Panel& panel, const AccuracyStudy& study, Knob knob, std::size_t q,
                const std::vector<Family>& families, const std::vector<int>& style) {
  constexpr std::size_t most = 3;
  constexpr double infinite = std::numeric_limits<double>::infinity();
  plot::Point least = {infinite, infinite}, greatest = {0.0, 0.0};
  for (const plot::Curve& curve : panel.curves)
    for (const plot::Point& p : curve.trace.points())
      for (const std::size_t axis : {0u, 1u}) {
        least[axis] = std::min(least[axis], p[axis]);
        greatest[axis] = std::max(greatest[axis], p[axis]);
      }
  const double width = std::log10(greatest[0] / least[0]);
  const double decades = std::log10(greatest[1] / least[1]);
  std::vector<double> shown;
  for (const OrderFit& fit : study.fits) {
    if (fit.knob != knob || fit.quantity != q || shown.size() == most) continue;
    bool drawn = false;
    for (std::size_t f = 0; f < families.size(); ++f) {
      const std::vector<std::size_t>& all = families[f].points;
      drawn = drawn || (style[f] >= 0 &&
                        std::all_of(fit.points.begin(), fit.points.end(), [&](std::size_t p) {
                          return std::find(all.begin(), all.end(), p) != all.end();
                        }));
    }
    const double order = fit.theory.value_or(std::round(fit.slope));
    if (!drawn || std::find(shown.begin(), shown.end(), order) != shown.end()) continue;
    if (std::optional<plot::Slope> slope = slope_of(study, fit, width, decades)) {
      panel.slopes.push_back(std::move(*slope));
      shown.push_back(order);
    }
  }
}

std::vector<plot::Panel> knob_panels(const AccuracyStudy& study) {
  std::vector<plot::Panel> panels;
  for (const Knob knob : numeric_knobs(study))
    for (std::size_t q = 0; q < study.quantities.size(); ++q) {
      if (!resolved(study.quantities[q])) continue;
      const std::string name(name_of(knob));
      const bool rises = knob == Knob::step || knob == Knob::tolerance;  // the error with it
      plot::Panel panel{.title = study.quantities[q].name + " over " + name,
                        .x_label = knob == Knob::step       ? "step [s]"
                                   : knob == Knob::elements ? "elements"
                                                            : name,
                        .y_label = "error (rms)",
                        .x_log = knob != Knob::order,
                        .y_log = true};
      const std::vector<Family> families = families_over(study, knob, q);
      std::vector<double> merit;  // the more a curve shows, the more it is worth a name
      for (const Family& family : families)
        merit.push_back(static_cast<double>(
            std::count_if(family.points.begin(), family.points.end(),
                          [&](std::size_t p) { return height_of(study, p, q).has_value(); })));
      const std::vector<int> style = styles_of(merit);
      add_families(panel, study, q, families, style,
                   [&](std::size_t point) { return number_of(study.points[point].setting, knob); });
      if (panel.curves.empty()) continue;
      add_level(panel, study.quantities[q]);
      add_slopes(panel, study, knob, q, families, style);
      if (!rises) {
        std::set<double> values;
        for (const TrialPoint& point : study.points)
          if (const std::optional<double> value = number_of(point.setting, knob))
            values.insert(*value);
        panel.x_ticks.assign(values.begin(), values.end());
      }
      panels.push_back(std::move(panel));
    }
  return panels;
}

// What a picture does not show.
std::string missing_text(const AccuracyStudy& study) {
  const Tally tally = tally_of(study);
  std::string text = "Hollow: not well above the reference's own error.";
  if (tally.stopped + tally.failed > 0)
    text += fmt::format(" Not shown: runs that were stopped ({}) or failed ({}).", tally.stopped,
                        tally.failed);
  return text;
}

constexpr std::string_view slopes_text =
    "Triangles: fitted order (in theory, where the solution is smooth).";

std::string cost_svg(const AccuracyStudy& study) {
  std::vector<std::size_t> of;
  return plot::to_svg(cost_panels(study, of), {.note = missing_text(study),
                                               .title = study.model + ": error against CPU time"});
}

std::string knob_svg(const AccuracyStudy& study) {
  return plot::to_svg(
      knob_panels(study),
      {.note = std::string(slopes_text) + " " + missing_text(study),
       .title = study.model + ": error against each setting, the others at their finest"});
}

// --- page ---

// The picture of one panel for a page, with what it is for those who do not see it.
std::string figure(const plot::Panel& panel, const std::string& ids, const std::string& label) {
  return "<figure>\n" + plot::to_svg({&panel, 1}, {.ids = ids, .label = label}) + "</figure>\n";
}

std::string times_text(double ratio) {
  if (!std::isfinite(ratio)) return "-";
  return ratio >= 9.95 ? fmt::format("{:.0f}", ratio) : fmt::format("{:.1f}", ratio);
}

// "C.displacement to 1e-2: 0.12 s of CPU time (order 2 …); to 1e-4: 0.9 s, 7.5 times as long (order 3 …)." The
// coarsest, that nearest to 1e-4, and the finest.
std::string answer(const AccuracyStudy& study, std::size_t q) {
  const Quantity& quantity = study.quantities[q];
  const std::string name = fmt::format("<strong>{}</strong>", xml_escaped(quantity.name));
  if (!resolved(quantity))
    return name + ": no accuracy can be told, since refinements do not approach each other.";
  const std::vector<Range> ranges = ranges_of(study, q);
  if (ranges.empty()) return name + ": no power of ten was reached.";
  const auto from_usual = [](const Range& r) { return std::abs(std::log10(r.to) + 4.0); };
  const auto usual =
      static_cast<std::size_t>(std::min_element(ranges.begin(), ranges.end(),
                                                [&](const Range& a, const Range& b) {
                                                  return from_usual(a) < from_usual(b);
                                                }) -
                               ranges.begin());
  const std::string until = until_text(study, quantity);
  std::string text = name + (until.empty() ? "" : " (" + xml_escaped(until) + ")");
  const double first = study.points[ranges.front().point].trial.cpu;
  for (const std::size_t i : std::set<std::size_t>{0, usual, ranges.size() - 1}) {
    const TrialPoint& point = study.points[ranges[i].point];
    text += fmt::format("{} to {}: {} s", i == 0 ? "" : ";", prose(number_text(ranges[i].to, 1)),
                        seconds_text(point.trial.cpu));
    text += i == 0 ? " of CPU time"
                   : fmt::format(", {} times as long", times_text(point.trial.cpu / first));
    text += fmt::format(" ({})", point.text.empty() ? "as the model is" : prose(point.text));
  }
  return text + ".";
}

// The parts of the page append to it.
class Page {
 public:
  Page(const AccuracyStudy& study, const Scene& scene) : study_(study), scene_(scene) {}

  std::string make() {
    begin();
    advice();
    pictures();
    orders();
    reference();
    caveats();
    runs();
    origin();
    text_ += page_end;
    return std::move(text_);
  }

 private:
  std::string run_link(std::size_t point) const {
    return fmt::format("<a href=\"#run-{0}\">run {0}</a>", point + 1);
  }

  std::string setting_text(std::size_t point) const {
    const std::string& text = study_.points[point].text;
    return text.empty() ? "as the model is" : prose(text);
  }

  // A table that scrolls inside its box, for which it can be focused.
  void open_table(const std::string& label, const std::string& kind) {
    text_ += fmt::format(
        "<div class=\"box\" role=\"region\" aria-label=\"{}\" tabindex=\"0\">\n<table "
        "class=\"{}\">\n",
        xml_escaped(label), kind);
  }
  void close_table() { text_ += "</tbody>\n</table>\n</div>\n"; }
  // A name that begins with '#' is that of a column of numbers.
  void head(const std::vector<std::string>& names) {
    text_ += "<thead><tr>";
    for (const std::string& name : names)
      text_ += name.starts_with('#') ? fmt::format("<th scope=\"col\" class=\"n\">{}</th>",
                                                   xml_escaped(name.substr(1)))
                                     : fmt::format("<th scope=\"col\">{}</th>", xml_escaped(name));
    text_ += "</tr></thead>\n<tbody>\n";
  }
  static std::string numeric(std::string_view text) {
    return fmt::format("<td class=\"n\">{}</td>", xml_escaped(text));
  }

  void begin();
  void advice();
  void pictures();
  void orders();
  void reference();
  void caveats();
  void runs();
  void origin();

  const AccuracyStudy& study_;
  const Scene& scene_;
  std::string text_;
};

void Page::begin() {
  text_ += page_begin(study_.model + ": error against CPU time",
                      fmt::format("{}, {}. {}, in {} s.", study_.file, study_.date,
                                  tally_text(study_), seconds_text(study_.seconds)));
  for (std::size_t q = 0; q < study_.quantities.size(); ++q)
    text_ += "<p>" + answer(study_, q) + "</p>\n";
}

void Page::advice() {
  // Of one quantity the table has the picture beside it where there is room.
  text_ += study_.quantities.size() == 1 ? "<div class=\"halves\">\n" : "<div>\n";
  text_ +=
      "<section>\n<h2 id=\"advice\">What to take for which accuracy</h2>\n<div "
      "class=\"quantities\">\n";
  for (std::size_t q = 0; q < study_.quantities.size(); ++q) {
    const std::vector<Range> ranges = ranges_of(study_, q);
    const std::string name = title_of(study_, study_.quantities[q]);
    if (ranges.empty()) {
      text_ += fmt::format(
          "<div>\n<h3>{}</h3>\n<p>{}</p>\n</div>\n", xml_escaped(study_.quantities[q].name),
          resolved(study_.quantities[q])
              ? "No run reached a power of ten."
              : "Refinements do not approach each other: there is nothing to measure errors by.");
      continue;
    }
    text_ += fmt::format("<div>\n<h3>{}</h3>\n", xml_escaped(name));
    open_table("What to take for " + name, "advice");
    head({"accuracy", "#error", "#CPU [s]", "#ratio", "#run"});
    const double least = study_.points[ranges.front().point].trial.cpu;
    for (const Range& range : ranges) {
      const double cpu = study_.points[range.point].trial.cpu;
      text_ += fmt::format("<tr class=\"numbers\"><th scope=\"row\">{}</th>", text_of(range));
      text_ += numeric(rms_text(study_, range.point, q)) + numeric(seconds_text(cpu)) +
               numeric(times_text(cpu / least));
      text_ +=
          fmt::format("<td class=\"n\"><a href=\"#run-{0}\">{0}</a></td></tr>\n", range.point + 1);
      const std::string change = snippet(scene_, study_.points[range.point].setting);
      text_ += fmt::format(
          "<tr><td class=\"change\" "
          "colspan=\"5\"><details><summary>{}</summary>\n<pre>{}</pre></details></td></tr>\n",
          setting_text(range.point), change.empty() ? "the model as it is" : escaped_lines(change));
    }
    close_table();
    text_ += "</div>\n";
  }
  text_ += fmt::format(
      "</div>\n<p>{} Ratio: CPU time over that of the cheapest in the table. A setting opens to "
      "the "
      "lines that replace those of the model; “…” stands for attributes that stay.</p>\n"
      "</section>\n",
      xml_escaped(norm_text(study_)));
}

void Page::pictures() {
  std::vector<std::size_t> of;
  const std::vector<plot::Panel> cost = cost_panels(study_, of);
  if (!cost.empty()) {
    text_ += "<section>\n<h2 id=\"cost\">Error against CPU time</h2>\n<div class=\"pictures\">\n";
    for (std::size_t i = 0; i < cost.size(); ++i)
      text_ += figure(cost[i], fmt::format("cost-{}-", i),
                      "Error against CPU time: " + study_.quantities[of[i]].name);
    text_ += fmt::format(
        "</div>\n<p>The broad line joins the runs that none beats in both. {}</p>\n"
        "</section>\n",
        missing_text(study_));
  }
  text_ += "</div>\n";
  const std::vector<plot::Panel> over = knob_panels(study_);
  if (!over.empty()) {
    text_ +=
        "<section>\n<h2 id=\"knobs\">Error against each setting, the others at their "
        "finest</h2>\n<div class=\"pictures\">\n";
    bool slopes = false;
    for (std::size_t i = 0; i < over.size(); ++i) {
      text_ += figure(over[i], fmt::format("knob-{}-", i), "Error: " + over[i].title);
      slopes = slopes || !over[i].slopes.empty();
    }
    text_ += fmt::format("</div>\n<p>{}{}</p>\n</section>\n", slopes ? slopes_text : "",
                         (slopes ? " " : "") + missing_text(study_));
  }
}

void Page::orders() {
  if (study_.fits.empty()) return;
  text_ +=
      "<section>\n<h2 id=\"orders\">Fitted orders</h2>\n<p>Error ~ setting^order, by least "
      "squares over points of one family whose errors are below 0.1 and clearly above the "
      "reference's own. Theory holds where the solution is smooth; departure: of the farthest "
      "point from the line, as a factor.</p>\n";
  open_table("Fitted orders", "orders");
  head({"quantity", "over", "#order", "#theory", "#departure", "#points", "of"});
  std::vector<OrderFit> fits = study_.fits;
  std::stable_sort(fits.begin(), fits.end(), [](const OrderFit& one, const OrderFit& other) {
    return one.quantity < other.quantity;
  });
  for (const OrderFit& fit : fits)
    text_ += fmt::format(
        "<tr><th scope=\"row\">{}</th><td>{}</td>{}{}{}{}<td class=\"t\">{}</td></tr>\n",
        xml_escaped(study_.quantities[fit.quantity].name), name_of(fit.knob),
        numeric(fmt::format("{:.2f}", fit.slope)),
        numeric(fit.theory ? fmt::format("{:g}", *fit.theory) : "-"),
        numeric(fmt::format("{:.2f}", fit.spread)), numeric(std::to_string(fit.points.size())),
        prose(family_text(study_, fit)));
  close_table();
  text_ += "</section>\n";
}

void Page::reference() {
  text_ += fmt::format(
      "<section>\n<h2 id=\"reference\">The reference and its own error</h2>\n"
      "<p>{}</p>\n",
      xml_escaped(study_.reference));
  open_table("Error of the reference", "reference");
  head({"quantity", "#its error (rms)", "#its error (largest)", "#divided by", "known"});
  for (const Quantity& q : study_.quantities) {
    const std::string until = until_text(study_, q);
    const bool has = resolved(q);
    text_ +=
        fmt::format("<tr><th scope=\"row\">{}</th>{}{}{}<td>{}</td></tr>\n", xml_escaped(q.name),
                    numeric(has ? reference_text(q, &Quantity::reference_rms) : "-"),
                    numeric(has ? reference_text(q, &Quantity::reference_largest) : "-"),
                    numeric(has ? fmt::format("{:.4g} {}", q.scale, q.unit) : "-"),
                    until.empty() ? "to the end" : xml_escaped(until));
  }
  close_table();
  if (!study_.ways.empty()) {
    text_ += "<h3>Runs that made it</h3>\n";
    open_table("Runs that made the reference", "ways");
    head({"setting", "#CPU [s]", "state"});
    for (const TrialPoint& way : study_.ways)
      text_ +=
          fmt::format("<tr><td class=\"t\">{}</td>{}<td>{}</td></tr>\n", prose(way.text),
                      numeric(seconds_text(way.trial.cpu)), xml_escaped(state_text(way.trial)));
    close_table();
  }
  text_ += "</section>\n";
}

void Page::caveats() {
  std::string items;
  for (const Quantity& q : study_.quantities) {
    const std::string until = until_text(study_, q);
    if (until.empty()) continue;
    items += fmt::format(
        "<li>{}: successive refinements approach each other {}{}; its errors are {}.</li>\n",
        xml_escaped(q.name), xml_escaped(until), resolved(q) ? ", no further" : "",
        resolved(q) ? "those up to there" : "not known");
  }
  if (study_.untried > 0)
    items += fmt::format(
        "<li>{} settings were not tried, for want of time or because the study "
        "was interrupted.</li>\n",
        study_.untried);
  for (const std::string& note : study_.notes)
    items += fmt::format("<li>{}</li>\n", xml_escaped(note));
  std::string rows;
  for (std::size_t i = 0; i < study_.points.size(); ++i)
    if (const Trial& trial = study_.points[i].trial; !trial.complete)
      rows += fmt::format(
          "<tr><th scope=\"row\" class=\"n\">{}</th><td class=\"t\">{}</td>{}<td "
          "class=\"t\">{}</td></tr>\n",
          run_link(i), setting_text(i), numeric(seconds_text(trial.cpu)),
          xml_escaped(state_text(trial)));
  if (items.empty() && rows.empty()) return;
  text_ += "<section>\n<h2 id=\"caveats\">What to keep in mind</h2>\n";
  if (!items.empty()) text_ += "<ul>\n" + items + "</ul>\n";
  if (!rows.empty()) {
    text_ += "<h3>Runs that did not come to the end</h3>\n";
    open_table("Runs that did not come to the end", "ends");
    head({"run", "setting", "#CPU [s]", "what became of it"});
    text_ += rows;
    close_table();
  }
  text_ += "</section>\n";
}

void Page::runs() {
  text_ += fmt::format(
      "<section class=\"all\">\n<h2 id=\"runs\">All runs</h2>\n<details>\n<summary>{}</summary>\n",
      xml_escaped(tally_text(study_)));
  open_table("All runs", "runs");
  std::vector<std::string> names = {"run", "setting", "state", "#CPU [s]", "#of stepping [s]"};
  std::vector<std::size_t> shown;  // quantities
  for (std::size_t q = 0; q < study_.quantities.size(); ++q)
    if (resolved(study_.quantities[q])) shown.push_back(q);
  for (const std::size_t q : shown) {
    names.push_back("#" + study_.quantities[q].name + " rms");
    names.push_back("#largest");
  }
  for (const char* name :
       {"#steps", "#residuals", "#tangents", "#factorisations", "#unknowns", "#memory [MB]"})
    names.emplace_back(name);
  head(names);
  for (std::size_t i = 0; i < study_.points.size(); ++i) {
    const Trial& trial = study_.points[i].trial;
    bool front = false;
    for (std::size_t q = 0; q < study_.quantities.size(); ++q)
      front = front || on_front(study_, i, q);
    text_ += fmt::format("<tr id=\"run-{0}\"{1}><th scope=\"row\">{0}{2}</th>", i + 1,
                         front ? " class=\"front\"" : "", front ? " ●" : "");
    text_ += fmt::format("<td class=\"t\">{}</td><td>{}</td>", setting_text(i),
                         trial.complete  ? "complete"
                         : trial.stopped ? "stopped"
                                         : "failed");
    text_ += numeric(seconds_text(trial.cpu)) + numeric(seconds_text(trial.cpu_stepping));
    for (const std::size_t q : shown) {
      const std::string rms = rms_text(study_, i, q);
      text_ +=
          numeric(on_front(study_, i, q) ? "● " + rms : rms) + numeric(largest_text(study_, i, q));
    }
    for (const long count :
         {trial.counters.steps, trial.counters.residuals, trial.counters.tangents,
          trial.counters.factorizations, static_cast<long>(trial.unknowns)})
      text_ += numeric(std::to_string(count));
    text_ += numeric(fmt::format("{:.0f}", trial.memory * 1e-6)) + "</tr>\n";
  }
  close_table();
  text_ += "<p>●: cheapest for its error, of all runs.</p>\n</details>\n</section>\n";
}

void Page::origin() {
  text_ += "<section>\n<h2 id=\"origin\">Machine, and how to make it again</h2>\n<dl>\n";
  const auto fact = [&](const std::string& name, const std::string& value) {
    text_ += fmt::format("<dt>{}</dt><dd>{}</dd>\n", xml_escaped(name), xml_escaped(value));
  };
  fact("model", study_.file);
  fact("date", study_.date);
  fact("machine", study_.machine);
  for (const auto& [name, value] : study_.build) fact(name, value);
  fact("wall time",
       fmt::format("{} s of {} s", seconds_text(study_.seconds), seconds_text(study_.budget)));
  text_ += fmt::format("</dl>\n<pre>{}</pre>\n</section>\n", escaped_lines(study_.command));
}

}  // namespace
}  // namespace mbd::study_page

namespace mbd {

std::string accuracy_svg(const AccuracyStudy& study) { return study_page::cost_svg(study); }
std::string knobs_svg(const AccuracyStudy& study) { return study_page::knob_svg(study); }
std::string accuracy_page(const AccuracyStudy& study, const Scene& scene) {
  return study_page::Page(study, scene).make();
}

}  // namespace mbd
