#include "libmbd/scene/field_expression.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <utility>

#include "libmbd/core/error.hpp"
#include "libmbd/core/law_cells.hpp"

namespace mbd {
namespace {

bool is_word(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || (c >= '0' && c <= '9') ||
         c == '.';
}

// Whether one of its names is this; sensors are names with a point in them.
bool mentions(std::string_view text, std::string_view name) {
  for (std::size_t i = 0; i < text.size();) {
    std::size_t end = i;
    while (end < text.size() && is_word(text[end])) ++end;
    if (text.substr(i, end - i) == name) return true;
    i = std::max(end, i + 1);
  }
  return false;
}

}  // namespace

bool FieldExpression::Part::varies() const { return mentions(text, "s"); }

Expression FieldExpression::Part::at(double s) const {
  if (!varies()) return Expression::parse(text, *parameters, Variables::time);
  Parameters all = *parameters;
  const bool is_input = all.inputs.contains("s");
  if (!all.try_emplace("s", from + (to - from) * s).second || is_input)
    throw Error("\"" + text + "\": s is the place along the beam here, and " +
                (is_input ? "an input" : "a parameter") + " of the model too; give the " +
                (is_input ? "input" : "parameter") + " another name");
  return Expression::parse(text, all, Variables::time);
}

FieldExpression::FieldExpression(std::string text, Parameters parameters, double factor)
    : parts_{{.text = std::move(text),
              .parameters = std::make_shared<const Parameters>(std::move(parameters)),
              .factor = factor}} {}

FieldExpression FieldExpression::sum(std::span<const Term> terms, double stretch) {
  FieldExpression result;
  for (const Term& term : terms)
    for (Part part : term.of->parts_) {
      part.factor *= term.factor;
      part.stretch *= stretch;
      result.parts_.push_back(std::move(part));
    }
  return result;
}

bool FieldExpression::varies() const {
  return std::any_of(parts_.begin(), parts_.end(), [](const Part& part) { return part.varies(); });
}

std::string FieldExpression::text() const {
  std::string result;
  for (const Part& part : parts_) {
    if (!result.empty()) result += " + ";
    result += part.factor == 1.0 ? part.text : fmt::format("({})*{}", part.text, part.factor);
  }
  return result;
}

FieldExpression FieldExpression::on_part(double from, double to) const {
  FieldExpression result = *this;
  for (Part& part : result.parts_) {
    const double length = part.to - part.from;
    part.to = part.from + to * length;
    part.from += from * length;
  }
  return result;
}

Expression FieldExpression::at(double s) const {
  if (parts_.empty()) return Expression::parse("", {}, Variables::time);
  std::vector<Expression> scaled;
  for (const Part& part : parts_) {
    const Expression own = part.at(s);
    const Expression::Term one[] = {{part.factor, &own}};
    const bool as_it_is = part.factor == 1.0 && part.stretch == 1.0;
    scaled.push_back(as_it_is ? own : Expression::sum(one, part.stretch));
  }
  if (scaled.size() == 1) return scaled.front();
  std::vector<Expression::Term> terms;
  for (const Expression& e : scaled) terms.push_back({1.0, &e});
  return Expression::sum(terms);
}

double FieldExpression::Profile::operator()(double s) const {
  double sum = 0.0;
  for (const Part& part : parts_)
    sum += part.factor * part.of_place(part.from + (part.to - part.from) * s).v;
  return sum;
}

std::optional<FieldExpression::Profile> FieldExpression::profile(double t) const {
  constexpr long most = 20'000;  // cells
  Profile profile;
  for (const Part& part : parts_) {
    Parameters all = *part.parameters;
    all["t"] = t / part.stretch;
    try {
      profile.parts_.push_back(
          {Expression::parse(part.text, all, Variables::place), part.factor, part.from, part.to});
    } catch (const Error&) {
      return std::nullopt;
    }
    const double length = part.to - part.from;
    if (!part.varies() || !(length > 0.0)) continue;
    for (const double s :
         find_cells(profile.parts_.back().of_place, {}, part.from, part.to, most).ends)
      profile.ends_.push_back((s - part.from) / length);
  }
  std::ranges::sort(profile.ends_);
  return profile;
}

}  // namespace mbd
