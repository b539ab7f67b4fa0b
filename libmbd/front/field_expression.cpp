#include "libmbd/front/field_expression.hpp"

#include "libmbd/core/error.hpp"

namespace mbd {
namespace {

bool starts_word(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool continues_word(char c) { return starts_word(c) || (c >= '0' && c <= '9'); }

}  // namespace

bool FieldExpression::varies() const {
  for (std::size_t i = 0; i < text.size();) {
    if (!continues_word(text[i]) && text[i] != '.') {
      ++i;
      continue;
    }
    std::size_t end = i;  // of a word or a number
    while (end < text.size() && (continues_word(text[end]) || text[end] == '.')) ++end;
    if (text.compare(i, end - i, "s") == 0) return true;
    i = end;
  }
  return false;
}

Expression FieldExpression::at(double s) const {
  if (!varies()) return Expression::parse(text, parameters, Variables::time);
  Parameters all = parameters;
  if (!all.try_emplace("s", s).second)
    throw Error(
        "\"" + text +
        "\": s is the place along the beam here, and a parameter of the model too; give the "
        "parameter another name");
  return Expression::parse(text, all, Variables::time);
}

}  // namespace mbd
