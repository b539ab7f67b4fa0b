#include "libmbd/scene/field_expression.hpp"

#include <fmt/format.h>

#include "libmbd/core/error.hpp"

namespace mbd {
namespace {

bool is_word(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || (c >= '0' && c <= '9') ||
         c == '.';
}

}  // namespace

std::string FieldExpression::reworded(
    const std::function<std::string(std::string_view)>& word) const {
  std::string result;
  for (std::size_t i = 0; i < text.size();) {
    std::size_t end = i;
    while (end < text.size() && is_word(text[end])) ++end;
    if (end == i) {
      result += text[i++];
      continue;
    }
    result += word(std::string_view(text).substr(i, end - i));
    i = end;
  }
  return result;
}

bool FieldExpression::varies() const {
  bool found = false;
  reworded([&](std::string_view word) {
    found |= word == "s";
    return std::string();
  });
  return found;
}

FieldExpression FieldExpression::on_part(double from, double to) const {
  const std::string place = fmt::format("({}+{}*s)", from, to - from);
  return {reworded([&](std::string_view word) { return word == "s" ? place : std::string(word); }),
          parameters};
}

Expression FieldExpression::at(double s) const {
  if (!varies()) return Expression::parse(text, parameters, Variables::time);
  Parameters all = parameters;
  const bool is_input = all.inputs.contains("s");
  if (!all.try_emplace("s", s).second || is_input)
    throw Error("\"" + text + "\": s is the place along the beam here, and " +
                (is_input ? "an input" : "a parameter") + " of the model too; give the " +
                (is_input ? "input" : "parameter") + " another name");
  return Expression::parse(text, all, Variables::time);
}

}  // namespace mbd
