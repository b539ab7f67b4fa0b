// The knobs of accuracy, and scenes with other values of them.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libmbd/scene/scene.hpp"

namespace mbd {

// In the order in which tables and pictures list them.
enum class Knob { order, elements, metric, rule, form, method, step, tolerance, errors };
inline constexpr std::array knobs = {Knob::order, Knob::elements,  Knob::metric,
                                     Knob::rule,  Knob::form,      Knob::method,
                                     Knob::step,  Knob::tolerance, Knob::errors};

// As --vary and the columns of trials.csv write it: "order", "elements", …
std::string_view name_of(Knob knob);

// What a scene's own settings are replaced by; what is absent stays. Those of space hold for all beams, those of
// time for the <transient>.
struct Setting {
  std::optional<int> order = {};  // N of elements with N + 1 nodes
  // Of the beams that have the fewest in the scene; the others have more in proportion (rounded, at least 1).
  std::optional<int> elements = {};
  std::optional<Metric> metric = {};
  std::optional<Rule> rule = {};
  std::optional<Form> form = {};
  std::optional<TimeMethod> method = {};
  std::optional<double> step = {};       // [s], fixed steps; in place of a tolerance
  std::optional<double> tolerance = {};  // relative, adaptive steps; in place of a step
  std::optional<ErrorsOf> errors = {};   // that radau's adaptive steps are held by

  bool operator==(const Setting&) const = default;
};

// The value of a knob as a word or number ("geodesic", "0.001"); empty where it is absent.
std::string value_of(const Setting& setting, Knob knob);
// The value of order, elements, step or tolerance; nothing for others and where it is absent.
std::optional<double> number_of(const Setting& setting, Knob knob);

// The scene with these settings. Its own choices that do not go with them are left out (rho_infinity of another
// method than generalized_alpha, newton_tolerance of other steps, limits in units of a tolerance). Throws Error
// for knobs that the scene does not have (order without beams, step without <transient>, errors of other steps than
// radau's with a tolerance), and values out of range.
Scene with(const Scene& scene, const Setting& setting);

// The scene's own: of beams those of the first, where all agree.
Setting setting_of(const Scene& scene);

// "order 3, 2/4/2 elements, radau, tolerance 1e-05"; what the scene has by itself is not said.
std::string to_text(const Scene& scene, const Setting& setting);

// What to write into the model for it: one line for each element that changes, e.g.
//   <beam name="bar1" … order="3" elements="2"/>
//   <transient … method="radau" tolerance="1e-05"/>
// where "…" are the attributes that stay.
std::string snippet(const Scene& scene, const Setting& setting);

// Values of knobs, whose combinations are tried.
struct Variations {
  std::vector<int> order, elements;
  std::vector<Metric> metric;
  std::vector<Rule> rule;
  std::vector<Form> form;
  std::vector<TimeMethod> method;
  std::vector<double> step, tolerance;
  std::vector<ErrorsOf> errors;
};

// Adds "order=2:6", "elements=1,2,4,8", "step=1e-3,5e-4", "tolerance=1e-2:1e-6" (powers of ten between),
// "method=radau,ida", "metric=all", … Throws Error, saying what is allowed, for anything else.
void add_variation(Variations& variations, const std::string& text);

// What makes a study useful when nothing is asked for: with beams orders and meshes; with a <transient>
// generalized-alpha over steps about the scene's, and Radau over tolerances. `given` keeps what it has.
Variations default_variations(const Scene& scene, Variations given = {});

// All combinations that make sense (errors with a tolerance of radau): a method with steps, and with tolerances, where both are given (generalized-alpha
// with fixed steps alone, unless steps are not varied at all; IDA with tolerances alone).
std::vector<Setting> settings_of(const Variations& variations);

}  // namespace mbd
