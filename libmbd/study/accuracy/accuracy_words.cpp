#include "libmbd/study/accuracy/accuracy_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <set>

namespace mbd::study {
namespace {

// A value of a knob as it is said in a sentence: "order 3", "1 element", "radau", "step 0.001".
std::string words_of(const Setting& setting, Knob knob) {
  const std::string value = value_of(setting, knob);
  if (value.empty()) return {};
  switch (knob) {
    case Knob::elements:
      return value + (value == "1" ? " element" : " elements");
    case Knob::order:
    case Knob::step:
    case Knob::tolerance:
      return std::string(name_of(knob)) + " " + value;
    case Knob::metric:
    case Knob::rule:
    case Knob::form:
    case Knob::method:
      break;
    case Knob::errors:
      return "errors of " + value;
  }
  return value;
}

std::size_t values_of(const AccuracyStudy& study, Knob knob) {
  std::set<std::string> values;
  for (const TrialPoint& point : study.points)
    if (std::string value = value_of(point.setting, knob); !value.empty())
      values.insert(std::move(value));
  return values.size();
}

// Whether points differ in it, if only in whether they have it.
bool differs(const AccuracyStudy& study, Knob knob) {
  return std::any_of(study.points.begin(), study.points.end(), [&](const TrialPoint& point) {
    return value_of(point.setting, knob) != value_of(study.points.front().setting, knob);
  });
}

// Larger is finer.
double fineness(const Setting& setting, Knob knob) {
  const std::optional<double> number = number_of(setting, knob);
  if (!number) return 0.0;
  return knob == Knob::step || knob == Knob::tolerance ? -*number : *number;
}

using Key = std::map<Knob, std::string>;

Key key_of(const Setting& setting, Knob along) {
  Key key;
  for (const Knob knob : knobs)
    if (knob != along) key[knob] = value_of(setting, knob);
  return key;
}

std::string label_of(const AccuracyStudy& study, const Setting& setting,
                     const std::vector<Knob>& without) {
  std::string label;
  for (const Knob knob : knobs) {
    if (std::find(without.begin(), without.end(), knob) != without.end() || !differs(study, knob))
      continue;
    if (const std::string words = words_of(setting, knob); !words.empty())
      label += (label.empty() ? "" : ", ") + words;
  }
  return label;
}

void sort_by_fineness(const AccuracyStudy& study, Family& family) {
  std::stable_sort(family.points.begin(), family.points.end(), [&](std::size_t a, std::size_t b) {
    return fineness(study.points[a].setting, family.along) <
           fineness(study.points[b].setting, family.along);
  });
}

// Two families of one name are told apart by what runs along them.
void tell_apart(std::vector<Family>& families) {
  std::map<std::string, int> names;
  for (const Family& family : families) ++names[family.label];
  for (Family& family : families)
    if (names[family.label] > 1)
      family.label += (family.label.empty() ? "by " : ", by ") + std::string(name_of(family.along));
}

std::string error_text(const AccuracyStudy& study, std::size_t point, std::size_t quantity,
                       double QuantityError::*error, double reference) {
  if (!known(study, point, quantity)) return "-";
  const QuantityError& e = study.points[point].errors[quantity];
  if (e.below_reference) return "< " + bound_text(reference + e.*error);
  return number_text(e.*error);
}

}  // namespace

std::string seconds_text(double seconds) {
  if (!std::isfinite(seconds)) return "-";
  if (seconds >= 9.95) return fmt::format("{:.0f}", seconds);
  return fmt::format("{:.2g}", seconds);
}

std::string number_text(double value, int digits) {
  if (!std::isfinite(value)) return "-";
  if (value == 0.0) return "0";
  if (std::abs(value) >= 1.0 && std::abs(value) < 1000.0)
    return fmt::format("{:.{}g}", value, std::max(digits, std::abs(value) >= 10.0 ? 3 : digits));
  std::string text = fmt::format("{:.{}e}", value, digits - 1);
  const std::size_t e = text.find('e');
  std::string lead = text.substr(0, e);
  const int power = std::stoi(text.substr(e + 1));
  if (lead.find('.') != std::string::npos) {
    lead.erase(lead.find_last_not_of('0') + 1);
    if (lead.back() == '.') lead.pop_back();
  }
  return fmt::format("{}e{}", lead, power);
}

std::string bound_text(double reference_error) {
  if (!(reference_error > 0.0) || !std::isfinite(reference_error))
    return number_text(reference_error);
  const double power = std::pow(10.0, std::floor(std::log10(reference_error)));
  return number_text(std::ceil(reference_error / power - 1e-9) * power, 1);
}

std::string reference_text(const Quantity& quantity, double Quantity::*error) {
  return quantity.reference_known ? bound_text(quantity.*error) : "not known";
}

std::string rms_text(const AccuracyStudy& study, std::size_t point, std::size_t quantity) {
  return error_text(study, point, quantity, &QuantityError::rms,
                    study.quantities[quantity].reference_rms);
}

std::string largest_text(const AccuracyStudy& study, std::size_t point, std::size_t quantity) {
  return error_text(study, point, quantity, &QuantityError::largest,
                    study.quantities[quantity].reference_largest);
}

std::string until_text(const AccuracyStudy& study, const Quantity& quantity) {
  if (!(quantity.until > 0.0)) return "nowhere";
  if (quantity.until >= study.end * (1.0 - 1e-12)) return {};
  const std::string unit = study.place == "time" ? " s" : "";
  return fmt::format("up to {} {:.4g}{} of {:.6g}{}", study.place, quantity.until, unit, study.end,
                     unit);
}

std::string state_text(const Trial& trial) {
  if (trial.complete) return "complete";
  if (trial.stopped) return fmt::format("stopped after {} s", seconds_text(trial.cpu));
  return "failed" + (trial.failure.empty() ? "" : ": " + trial.failure);
}

Tally tally_of(const AccuracyStudy& study) {
  Tally tally;
  for (const TrialPoint& point : study.points)
    ++(point.trial.complete ? tally.complete : point.trial.stopped ? tally.stopped : tally.failed);
  return tally;
}

std::string tally_text(const AccuracyStudy& study) {
  const Tally tally = tally_of(study);
  const std::size_t all = study.points.size();
  std::string text = fmt::format("{} {}", all, all == 1 ? "run" : "runs");
  std::string parts;
  if (tally.stopped + tally.failed > 0) {
    parts = fmt::format("{} complete", tally.complete);
    if (tally.stopped > 0) parts += fmt::format(", {} stopped", tally.stopped);
    if (tally.failed > 0) parts += fmt::format(", {} failed", tally.failed);
  } else {
    parts = "all complete";
  }
  text += ": " + parts;
  if (study.untried > 0) text += fmt::format("; {} not tried", study.untried);
  return text;
}

std::string norm_text(const AccuracyStudy& study) {
  const std::string over = study.place == "time" ? fmt::format("over {} times", study.places)
                           : study.place == "load factor"
                               ? "at the last load"
                               : fmt::format("over {} points of the path", study.places);
  return fmt::format(
      "Errors are lengths of the difference to the reference, root mean square and largest {}, "
      "divided by the "
      "largest length of the reference.",
      over);
}

bool known(const AccuracyStudy& study, std::size_t point, std::size_t quantity) {
  const TrialPoint& p = study.points[point];
  return quantity < p.errors.size() && p.errors[quantity].known;
}

bool on_front(const AccuracyStudy& study, std::size_t point, std::size_t quantity) {
  if (quantity >= study.fronts.size()) return false;
  const std::vector<std::size_t>& front = study.fronts[quantity];
  return std::find(front.begin(), front.end(), point) != front.end();
}

std::string place_label(const AccuracyStudy& study) {
  return study.place == "time" ? "time [s]" : study.place;
}

std::vector<Range> ranges_of(const AccuracyStudy& study, std::size_t quantity) {
  std::vector<Advice> advice;
  for (const Advice& a : study.advice)
    if (a.quantity == quantity) advice.push_back(a);
  std::stable_sort(advice.begin(), advice.end(),
                   [](const Advice& a, const Advice& b) { return a.accuracy > b.accuracy; });
  std::vector<Range> ranges;
  for (const Advice& a : advice) {
    if (!ranges.empty() && ranges.back().point == a.point)
      ranges.back().to = a.accuracy;
    else
      ranges.push_back({a.accuracy, a.accuracy, a.point});
  }
  return ranges;
}

std::string text_of(const Range& range) {
  const std::string to = number_text(range.to, 1);
  return range.from == range.to ? to : number_text(range.from, 1) + " to " + to;
}

std::vector<Family> families_of(const AccuracyStudy& study) {
  const std::vector<Knob> varied = numeric_knobs(study);
  const auto along_of = [&](const Setting& setting) {
    for (const Knob knob : varied)
      if (number_of(setting, knob)) return knob;
    return Knob::step;
  };
  std::vector<Family> families;
  std::map<std::pair<Knob, Key>, std::size_t> found;
  for (std::size_t i = 0; i < study.points.size(); ++i) {
    const Setting& setting = study.points[i].setting;
    const Knob along = along_of(setting);
    const auto [it, added] = found.try_emplace({along, key_of(setting, along)}, families.size());
    if (added)
      families.push_back(
          {label_of(study, setting, {along, Knob::step, Knob::tolerance}), along, {}});
    families[it->second].points.push_back(i);
  }
  for (Family& family : families) sort_by_fineness(study, family);
  tell_apart(families);
  return families;
}

std::vector<Family> families_over(const AccuracyStudy& study, Knob knob, std::size_t quantity) {
  const bool in_time = knob == Knob::step || knob == Knob::tolerance;
  const std::vector<Knob> finest =
      in_time ? std::vector{Knob::order, Knob::elements} : std::vector{Knob::step, Knob::tolerance};
  // Candidates for a curve: they differ in how fine the other numbers are. Those with steps and those with tolerances
  // are curves of their own.
  struct Candidate {
    Family family;
    std::vector<double> fine;
    std::size_t known = 0;
  };
  std::map<Key, std::map<Key, Candidate>> curves;
  std::vector<Key> order;  // of appearance
  for (std::size_t i = 0; i < study.points.size(); ++i) {
    const Setting& setting = study.points[i].setting;
    if (!number_of(setting, knob)) continue;
    const Key whole = key_of(setting, knob);
    Key curve = whole;
    for (const Knob other : finest) {
      std::string& value = curve[other];
      if (!value.empty()) value = "finest";
    }
    const auto [it, added] = curves.try_emplace(curve);
    if (added) order.push_back(curve);
    Candidate& candidate = it->second[whole];
    if (candidate.family.points.empty()) {
      std::vector<Knob> without = finest;
      without.push_back(knob);
      candidate.family.label = label_of(study, setting, without);
      candidate.family.along = knob;
      for (const Knob other : finest) candidate.fine.push_back(fineness(setting, other));
    }
    candidate.family.points.push_back(i);
    if (known(study, i, quantity)) ++candidate.known;
  }
  std::vector<Family> families;
  for (const Key& key : order) {
    const Candidate* best = nullptr;
    for (const auto& [whole, candidate] : curves[key])
      if (best == nullptr || candidate.known > best->known ||
          (candidate.known == best->known && candidate.fine > best->fine))
        best = &candidate;
    if (best == nullptr || best->known == 0) continue;
    families.push_back(best->family);
    sort_by_fineness(study, families.back());
  }
  // What runs along is the same for all: they differ in whether the rest has steps or tolerances.
  std::map<std::string, int> names;
  for (const Family& family : families) ++names[family.label];
  for (Family& family : families)
    if (names[family.label] > 1) {
      const Setting& setting = study.points[family.points.front()].setting;
      const std::string by = setting.step        ? "fixed steps"
                             : setting.tolerance ? "tolerance"
                                                 : "neither";
      family.label += (family.label.empty() ? "" : ", ") + by;
    }
  return families;
}

std::vector<Knob> numeric_knobs(const AccuracyStudy& study) {
  std::vector<Knob> varied;
  for (const Knob knob : {Knob::step, Knob::tolerance, Knob::elements, Knob::order})
    if (values_of(study, knob) > 1) varied.push_back(knob);
  return varied;
}

std::string slope_text(const OrderFit& fit) {
  std::string text = fmt::format("{:.2f}", fit.slope);
  if (fit.theory) text += fmt::format(" (theory {:g})", *fit.theory);
  return text;
}

std::string family_text(const AccuracyStudy& study, const OrderFit& fit) {
  if (fit.points.empty()) return {};
  const Setting& setting = study.points[fit.points.front()].setting;
  std::string text;
  for (const Knob knob : knobs) {
    if (knob == fit.knob) continue;
    if (const std::string words = words_of(setting, knob); !words.empty())
      text += (text.empty() ? "" : ", ") + words;
  }
  return text;
}

}  // namespace mbd::study
