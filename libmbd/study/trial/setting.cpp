#include "libmbd/study/trial/setting.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "libmbd/language/schema.hpp"
#include "libmbd/scene/label.hpp"
#include "libmbd/scene/transient.hpp"
#include "libmbd/text/spelling.hpp"

namespace mbd {
namespace {

constexpr int most_values = 1000;  // of one knob
constexpr int most_elements_of_a_beam = 100000;

bool is_of_time(Knob knob) {
  return knob == Knob::method || knob == Knob::step || knob == Knob::tolerance ||
         knob == Knob::errors;
}

// The attribute that a knob stands for in a model.
const schema::Attribute& attribute_of(Knob knob) {
  return *schema::find_attribute(*schema::find_element(is_of_time(knob) ? "transient" : "beam"),
                                 name_of(knob));
}

template <class Choice>
std::string word(Knob knob, Choice choice) {
  return std::string(schema::words(attribute_of(knob).choices)[static_cast<std::size_t>(choice)]);
}

[[noreturn]] void fail(std::string_view text, const std::string& why) {
  throw Error(fmt::format("--vary {}: {}", text, why));
}

double parse_number(std::string_view text, std::string_view value) {
  double number = 0.0;
  const auto [end, code] = std::from_chars(value.data(), value.data() + value.size(), number);
  if (code != std::errc() || end != value.data() + value.size() || !std::isfinite(number))
    fail(text, fmt::format("\"{}\" is not a number", value));
  return number;
}

std::vector<std::string_view> split(std::string_view text, char at) {
  std::vector<std::string_view> parts;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(at, begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

// "2", or "2:6": all whole numbers between, or of steps and tolerances those of 1, 10, 100 … times the smaller
// that are not above the larger, from the larger to the smaller.
std::vector<double> parse_range(std::string_view text, std::string_view value, bool whole) {
  const std::vector<std::string_view> ends = split(value, ':');
  if (ends.size() == 1) return {parse_number(text, ends[0])};
  if (ends.size() != 2) fail(text, fmt::format("\"{}\" is not a range FROM:TO", value));
  const double first = parse_number(text, ends[0]), last = parse_number(text, ends[1]);
  std::vector<double> values;
  if (whole) {
    if (!(last - first < most_values)) fail(text, "the range is too long");
    if (first > last) fail(text, "the range is empty; write the smaller number first");
    for (double v = first; v <= last; v += 1.0) values.push_back(v);
  } else {
    const double least = std::min(first, last), most = std::max(first, last);
    if (!(least > 0.0)) fail(text, "must be positive");
    for (int k = static_cast<int>(std::floor(std::log10(most / least) + 1e-9)); k >= 0; --k)
      // By way of a decimal number, so that 1e-3 is that.
      values.push_back(std::stod(fmt::format("{:.12g}", least * std::pow(10.0, k))));
  }
  return values;
}

void check_number(std::string_view text, Knob knob, double value) {
  const schema::Attribute& attribute = attribute_of(knob);
  if (attribute.kind == schema::Kind::count && value != std::round(value))
    fail(text, fmt::format("{} must be a whole number, and is {}", name_of(knob), value));
  if (const std::string fault = schema::fault(attribute, value); !fault.empty())
    fail(text, fmt::format("{} {}", name_of(knob), fault));
}

template <class Value>
void add(std::vector<Value>& values, Value value) {
  if (std::find(values.begin(), values.end(), value) == values.end()) values.push_back(value);
}

template <class Choice>
void add_choices(std::vector<Choice>& values, Knob knob, std::string_view text,
                 std::string_view value) {
  const std::vector<std::string_view> known = schema::words(attribute_of(knob).choices);
  if (value == "all") {
    for (std::size_t k = 0; k < known.size(); ++k) add(values, static_cast<Choice>(k));
    return;
  }
  const auto found = std::find(known.begin(), known.end(), value);
  if (found == known.end())
    fail(text, fmt::format("unknown {}{}", name_of(knob),
                           suggest(value, known, fmt::format("values of {}", name_of(knob)))));
  add(values, static_cast<Choice>(found - known.begin()));
}

int fewest_elements(const Scene& scene) {
  int least = 0;
  for (const BeamScene& beam : scene.beams)
    least = least == 0 ? beam.elements : std::min(least, beam.elements);
  return least;
}

int elements_of(const Scene& scene, const BeamScene& beam, int fewest) {
  const double share = static_cast<double>(beam.elements) / fewest_elements(scene);
  return std::max(
      1, static_cast<int>(std::lround(std::min<double>(share * fewest, most_elements_of_a_beam))));
}

// "2/4/2", or "2" where all beams have as many.
std::string elements_text(const Scene& scene) {
  std::string all;
  bool same = true;
  for (const BeamScene& beam : scene.beams) {
    all += (all.empty() ? "" : "/") + std::to_string(beam.elements);
    same = same && beam.elements == scene.beams.front().elements;
  }
  return same || scene.beams.size() > 8 ? std::to_string(fewest_elements(scene)) : all;
}

// Every combination of what there is so far with each of the values.
template <class Value, class Set>
void multiply(std::vector<Setting>& settings, const std::vector<Value>& values, const Set& set) {
  if (values.empty()) return;
  std::vector<Setting> product;
  for (const Setting& setting : settings)
    for (const Value& value : values) {
      product.push_back(setting);
      set(product.back()) = value;
    }
  settings = std::move(product);
}

}  // namespace

std::string_view name_of(Knob knob) {
  constexpr std::array<std::string_view, knobs.size()> names = {
      "order", "elements", "metric", "rule", "form", "method", "step", "tolerance", "errors"};
  return names[static_cast<std::size_t>(knob)];
}

std::string value_of(const Setting& setting, Knob knob) {
  switch (knob) {
    case Knob::metric:
      return setting.metric ? word(knob, *setting.metric) : "";
    case Knob::rule:
      return setting.rule ? word(knob, *setting.rule) : "";
    case Knob::form:
      return setting.form ? word(knob, *setting.form) : "";
    case Knob::method:
      return setting.method ? word(knob, *setting.method) : "";
    case Knob::errors:
      return setting.errors ? word(knob, *setting.errors) : "";
    default:
      break;
  }
  const std::optional<double> number = number_of(setting, knob);
  return number ? schema::shortest(*number) : "";
}

std::optional<double> number_of(const Setting& setting, Knob knob) {
  switch (knob) {
    case Knob::order:
      return setting.order;
    case Knob::elements:
      return setting.elements;
    case Knob::step:
      return setting.step;
    case Knob::tolerance:
      return setting.tolerance;
    default:
      return std::nullopt;
  }
}

Scene with(const Scene& scene, const Setting& setting) {
  Scene varied = scene;
  for (const Knob knob : knobs) {
    if (value_of(setting, knob).empty()) continue;
    const bool in_time = is_of_time(knob);
    if (in_time && !scene.transient)
      throw Error(scene.source,
                  fmt::format("{} cannot be varied: the model has no <transient>", name_of(knob)));
    if (!in_time && scene.beams.empty())
      throw Error(scene.source,
                  fmt::format("{} cannot be varied: the model has no beams", name_of(knob)));
    if (const std::optional<double> number = number_of(setting, knob)) {
      const std::string fault = schema::fault(attribute_of(knob), *number);
      if (!fault.empty()) throw Error(fmt::format("{} {}", name_of(knob), fault));
    }
  }
  for (std::size_t i = 0; i < varied.beams.size(); ++i) {
    BeamScene& beam = varied.beams[i];
    if (setting.order) beam.order = *setting.order;
    if (setting.elements) beam.elements = elements_of(scene, scene.beams[i], *setting.elements);
    if (setting.metric) beam.metric = *setting.metric;
    if (setting.rule) beam.rule = *setting.rule;
    if (setting.form) beam.form = *setting.form;
  }
  if (varied.transient)
    change_stepping(*varied.transient, {setting.method, setting.step, setting.tolerance});
  if (setting.errors) {
    TransientScene& transient = *varied.transient;
    if (transient.method != TimeMethod::radau || !transient.tolerance)
      throw Error(scene.source,
                  "errors cannot be varied but of steps of radau that follow a tolerance; vary "
                  "method=radau and tolerance too");
    transient.errors = setting.errors;
    if (setting.errors == ErrorsOf::motion) {
      transient.velocity_tolerance.reset();
      transient.angular_velocity_tolerance.reset();
    }
  }
  return varied;
}

Setting setting_of(const Scene& scene) {
  Setting setting;
  if (!scene.beams.empty()) {
    const BeamScene& first = scene.beams.front();
    const auto same = [&](auto member) {
      return std::all_of(scene.beams.begin(), scene.beams.end(),
                         [&](const BeamScene& beam) { return beam.*member == first.*member; });
    };
    if (same(&BeamScene::order)) setting.order = first.order;
    setting.elements = fewest_elements(scene);
    if (same(&BeamScene::metric)) setting.metric = first.metric;
    if (same(&BeamScene::rule)) setting.rule = first.rule;
    if (same(&BeamScene::form)) setting.form = first.form;
  }
  if (scene.transient) {
    setting.method = scene.transient->method;
    setting.step = scene.transient->step;
    setting.tolerance = scene.transient->tolerance;
    setting.errors = scene.transient->errors;
  }
  return setting;
}

std::string to_text(const Scene& scene, const Setting& setting) {
  std::vector<std::string> parts;
  if (setting.order) parts.push_back(fmt::format("order {}", *setting.order));
  if (setting.elements) {
    const std::string count = elements_text(with(scene, {.elements = setting.elements}));
    parts.push_back(fmt::format("{} element{}", count, count == "1" ? "" : "s"));
  }
  for (const Knob knob : {Knob::metric, Knob::rule, Knob::form, Knob::method})
    if (const std::string value = value_of(setting, knob); !value.empty()) parts.push_back(value);
  if (setting.step) parts.push_back(fmt::format("step {:.6g} s", *setting.step));
  if (setting.tolerance) parts.push_back(fmt::format("tolerance {:g}", *setting.tolerance));
  if (setting.errors) parts.push_back("errors of " + value_of(setting, Knob::errors));
  return parts.empty() ? "as it is" : fmt::format("{}", fmt::join(parts, ", "));
}

std::string snippet(const Scene& scene, const Setting& setting) {
  const Scene varied = with(scene, setting);
  std::string text;
  for (std::size_t i = 0; i < scene.beams.size(); ++i) {
    const BeamScene &was = scene.beams[i], &is = varied.beams[i];
    std::string attributes;
    const auto say = [&](Knob knob, const auto& before, const auto& after,
                         const std::string& value) {
      if (before != after) attributes += fmt::format(" {}=\"{}\"", name_of(knob), value);
    };
    say(Knob::order, was.order, is.order, std::to_string(is.order));
    say(Knob::elements, was.elements, is.elements, std::to_string(is.elements));
    say(Knob::metric, was.metric, is.metric, word(Knob::metric, is.metric));
    say(Knob::rule, was.rule, is.rule, word(Knob::rule, is.rule));
    say(Knob::form, was.form, is.form, word(Knob::form, is.form));
    if (!attributes.empty())
      text += fmt::format("<{} name=\"{}\" …{}/>\n", element_of(is), is.name, attributes);
  }
  if (!scene.transient) return text;
  const TransientScene &was = *scene.transient, &is = *varied.transient;
  if (was.method == is.method && was.step == is.step && was.tolerance == is.tolerance &&
      was.errors == is.errors)
    return text;
  text += fmt::format("<transient duration=\"{}\" method=\"{}\"", schema::shortest(is.duration),
                      name_of(is.method));
  const auto say = [&](std::string_view name, const std::optional<double>& value) {
    if (value) text += fmt::format(" {}=\"{}\"", name, schema::shortest(*value));
  };
  say("step", is.step);
  say("tolerance", is.tolerance);
  say("position_tolerance", is.position_tolerance);
  say("rotation_tolerance", is.rotation_tolerance);
  say("velocity_tolerance", is.velocity_tolerance);
  say("angular_velocity_tolerance", is.angular_velocity_tolerance);
  if (is.errors) text += fmt::format(" errors=\"{}\"", name_of(*is.errors));
  say("max_step", is.max_step);
  say("newton_tolerance", is.newton_tolerance);
  say("rho_infinity", is.rho_infinity);
  if (is.balance == Balance::momentum) text += " balance=\"momentum\"";
  if (is.inertia == InertiaTerms::no_gyroscopic) text += " inertia=\"no_gyroscopic\"";
  if (is.output_steps) text += " output=\"steps\"";
  say("output", is.output);
  return text + "/>\n";
}

void add_variation(Variations& variations, const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == 0 || equals == std::string::npos || equals + 1 == text.size())
    fail(text, "write KNOB=VALUES, such as order=2:6 or step=1e-3,5e-4, without blanks");
  const std::string_view name = std::string_view(text).substr(0, equals);
  std::vector<std::string_view> known;
  for (const Knob knob : knobs) known.push_back(name_of(knob));
  const auto found = std::find(known.begin(), known.end(), name);
  if (found == known.end()) fail(text, "unknown knob" + suggest(name, known, "knobs"));
  const Knob knob = knobs[static_cast<std::size_t>(found - known.begin())];
  for (const std::string_view value : split(std::string_view(text).substr(equals + 1), ',')) {
    if (value.empty()) fail(text, "a value is missing between commas");
    switch (knob) {
      case Knob::metric:
        add_choices(variations.metric, knob, text, value);
        continue;
      case Knob::rule:
        add_choices(variations.rule, knob, text, value);
        continue;
      case Knob::form:
        add_choices(variations.form, knob, text, value);
        continue;
      case Knob::method:
        add_choices(variations.method, knob, text, value);
        continue;
      case Knob::errors:
        add_choices(variations.errors, knob, text, value);
        continue;
      default:
        break;
    }
    const bool whole = knob == Knob::order || knob == Knob::elements;
    for (const double number : parse_range(text, value, whole)) {
      check_number(text, knob, number);
      if (knob == Knob::order) add(variations.order, static_cast<int>(number));
      if (knob == Knob::elements) {
        if (number > most_elements_of_a_beam)
          fail(text, fmt::format("at most {} elements", most_elements_of_a_beam));
        add(variations.elements, static_cast<int>(number));
      }
      if (knob == Knob::step) add(variations.step, number);
      if (knob == Knob::tolerance) add(variations.tolerance, number);
    }
  }
}

Variations default_variations(const Scene& scene, Variations given) {
  const auto fill = [](auto& values, auto usual) {
    if (values.empty()) values = std::move(usual);
  };
  if (!scene.beams.empty()) {
    // Of a model with curved or many elements one element more is not a small change: factors of two.
    const int own = fewest_elements(scene);
    fill(given.order, scene.transient ? std::vector{2, 3, 4, 5, 6} : std::vector{1, 2, 3, 4, 5, 6});
    fill(given.elements,
         scene.transient ? std::vector{own, 2 * own} : std::vector{own, 2 * own, 4 * own, 8 * own});
  }
  if (scene.transient) {
    // With steps or tolerances given, nothing is missing.
    if (!given.step.empty() || !given.tolerance.empty()) return given;
    if (given.method.empty()) given.method = {TimeMethod::generalized_alpha, TimeMethod::radau};
    const bool alpha = std::find(given.method.begin(), given.method.end(),
                                 TimeMethod::generalized_alpha) != given.method.end();
    // About the scene's own; else about a thousandth of the duration.
    const double duration = scene.transient->duration;
    const double wanted = scene.transient->step.value_or(duration / 1000.0);
    const double own = duration / std::max(4.0, std::round(duration / wanted));
    if (alpha) given.step = {2 * own, own, own / 2, own / 4, own / 8};
    if (given.method.size() > (alpha ? 1u : 0u))
      given.tolerance = {1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8};
  }
  return given;
}

std::vector<Setting> settings_of(const Variations& variations) {
  std::vector<Setting> in_time{{}};
  multiply(
      in_time, variations.method, [](Setting & s) -> auto& { return s.method; });
  if (!variations.step.empty() || !variations.tolerance.empty()) {
    std::vector<Setting> all;
    for (const Setting& setting : in_time) {
      const bool chosen = setting.method.has_value();
      const bool alpha = setting.method == TimeMethod::generalized_alpha;
      const bool both = !variations.step.empty() && !variations.tolerance.empty() && chosen &&
                        variations.method.size() > 1;
      std::vector<Setting> one{setting}, other{setting};
      if (!both || alpha)
        if (setting.method != TimeMethod::ida) {
          multiply(
              one, variations.step, [](Setting & s) -> auto& { return s.step; });
          if (!variations.step.empty()) all.insert(all.end(), one.begin(), one.end());
        }
      if (!both || !alpha) {
        multiply(
            other, variations.tolerance, [](Setting & s) -> auto& { return s.tolerance; });
        if (!chosen || setting.method == TimeMethod::radau)
          multiply(
              other, variations.errors, [](Setting & s) -> auto& { return s.errors; });
        if (!variations.tolerance.empty()) all.insert(all.end(), other.begin(), other.end());
      }
    }
    in_time = std::move(all);
  } else {
    multiply(
        in_time, variations.errors, [](Setting & s) -> auto& { return s.errors; });
  }
  std::vector<Setting> settings{{}};
  multiply(
      settings, variations.metric, [](Setting & s) -> auto& { return s.metric; });
  multiply(
      settings, variations.rule, [](Setting & s) -> auto& { return s.rule; });
  multiply(
      settings, variations.form, [](Setting & s) -> auto& { return s.form; });
  multiply(
      settings, variations.order, [](Setting & s) -> auto& { return s.order; });
  multiply(
      settings, variations.elements, [](Setting & s) -> auto& { return s.elements; });
  std::vector<Setting> product;
  for (const Setting& space : settings)
    for (const Setting& time : in_time) {
      product.push_back(space);
      product.back().method = time.method;
      product.back().step = time.step;
      product.back().tolerance = time.tolerance;
      product.back().errors = time.errors;
    }
  return product;
}

}  // namespace mbd
