#include "libmbd/core/expression.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <system_error>
#include <utility>

#include "libmbd/core/error.hpp"
#include "libmbd/core/hash.hpp"
#include "libmbd/core/opcode.hpp"

namespace mbd {

namespace {

constexpr std::size_t kMaxLength = 100'000;  // of the text, bytes
constexpr int kMaxNesting = 200;             // parentheses, calls, choices, signs and powers
constexpr std::size_t kMaxStack = Expression::most_pending;

struct Function {
  std::string_view name;
  int arity;
  Opcode op;
};

constexpr std::array kFunctions{
    Function{"sin", 1, Opcode::sin},     Function{"cos", 1, Opcode::cos},
    Function{"tan", 1, Opcode::tan},     Function{"asin", 1, Opcode::asin},
    Function{"acos", 1, Opcode::acos},   Function{"atan", 1, Opcode::atan},
    Function{"atan2", 2, Opcode::atan2}, Function{"sinh", 1, Opcode::sinh},
    Function{"cosh", 1, Opcode::cosh},   Function{"tanh", 1, Opcode::tanh},
    Function{"exp", 1, Opcode::exp},     Function{"log", 1, Opcode::log},
    Function{"ln", 1, Opcode::log},      Function{"log10", 1, Opcode::log10},
    Function{"sqrt", 1, Opcode::sqrt},   Function{"pow", 2, Opcode::power},
    Function{"abs", 1, Opcode::abs},     Function{"min", 2, Opcode::min},
    Function{"max", 2, Opcode::max},     Function{"floor", 1, Opcode::floor},
    Function{"ceil", 1, Opcode::ceil},   Function{"round", 1, Opcode::round},
};

struct Constant {
  std::string_view name;
  double value;
};

constexpr std::array kConstants{
    Constant{"pi", std::numbers::pi},
    Constant{"deg", std::numbers::pi / 180.0},
};

constexpr std::string_view kTime = "t";

std::string_view name_of(Variables allowed) {
  return allowed == Variables::x       ? "x"
         : allowed == Variables::v     ? "v"
         : allowed == Variables::place ? "s"
                                       : kTime;
}

template <class Table>
auto find_name(const Table& table, std::string_view name) {
  const auto* found =
      std::find_if(table.begin(), table.end(), [&](const auto& row) { return row.name == name; });
  return found == table.end() ? nullptr : found;
}

template <class S>
Taylor<S> apply(Opcode op, const Taylor<S>& x) {
  switch (op) {
    case Opcode::negate:
      return -x;
    case Opcode::sin:
      return sin(x);
    case Opcode::cos:
      return cos(x);
    case Opcode::tan:
      return tan(x);
    case Opcode::asin:
      return asin(x);
    case Opcode::acos:
      return acos(x);
    case Opcode::atan:
      return atan(x);
    case Opcode::sinh:
      return sinh(x);
    case Opcode::cosh:
      return cosh(x);
    case Opcode::tanh:
      return tanh(x);
    case Opcode::exp:
      return exp(x);
    case Opcode::log:
      return log(x);
    case Opcode::log10:
      return log10(x);
    case Opcode::sqrt:
      return sqrt(x);
    default:
    case Opcode::opposite:
      return {S(1) - x.v, x.d, x.dd};
    case Opcode::abs:
      return x.v < S(0) ? -x : x;
    case Opcode::floor:
      return {std::floor(x.v), S(0), S(0)};
    case Opcode::ceil:
      return {std::ceil(x.v), S(0), S(0)};
    case Opcode::round:
      return {std::round(x.v), S(0), S(0)};
      return {std::numeric_limits<S>::quiet_NaN(), S(0), S(0)};
  }
}

template <class S>
Taylor<S> apply(Opcode op, const Taylor<S>& x, const Taylor<S>& y) {
  switch (op) {
    case Opcode::add:
      return x + y;
    case Opcode::subtract:
      return x - y;
    case Opcode::multiply:
      return x * y;
    case Opcode::divide:
      return x / y;
    case Opcode::power:
      return pow(x, y);
    case Opcode::atan2:
      return atan2(x, y);
    case Opcode::both:
      return {x.v * y.v, x.d, x.dd};
    case Opcode::either:
      return {std::max(x.v, y.v), x.d, x.dd};
    case Opcode::less:
      return {x.v < y.v ? S(1) : S(0), S(0), S(0)};
    case Opcode::less_equal:
      return {x.v <= y.v ? S(1) : S(0), S(0), S(0)};
    case Opcode::equal:
      return {x.v == y.v ? S(1) : S(0), S(0), S(0)};
    case Opcode::min:
      return !(x.v <= y.v) || std::isnan(y.v) ? y : x;
    case Opcode::max:
      return !(x.v >= y.v) || std::isnan(y.v) ? y : x;
    default:
      return {std::numeric_limits<S>::quiet_NaN(), S(0), S(0)};
  }
}

double fold(Opcode op, double x) {
  return op == Opcode::abs ? std::abs(x) : apply(op, Taylor2{x, 0.0, 0.0}).v;
}

double fold(Opcode op, double x, double y) {
  switch (op) {
    case Opcode::min:
      return std::min(x, y);
    case Opcode::max:
      return std::max(x, y);
    default:
      return apply(op, Taylor2{x, 0.0, 0.0}, Taylor2{y, 0.0, 0.0}).v;
  }
}

std::string to_text(double x) {
  std::array<char, 32> buffer;
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), x).ptr;
  return {buffer.data(), end};
}

// Whether `c` is a byte of a UTF-8 character other than its first.
bool is_continuation(char c) { return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U; }

// A piece of the text for a message, shortened if long.
std::string quoted(std::string_view text) {
  std::size_t size = std::min<std::size_t>(text.size(), 40);
  while (size < text.size() && is_continuation(text[size])) ++size;
  return "'" + std::string(text.substr(0, size)) + (size < text.size() ? "...'" : "'");
}

// UTF-8 characters in `text`.
std::size_t count_characters(std::string_view text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return !is_continuation(c); }));
}

// The text, or the part of it near `position`, on one line.
std::string excerpt(std::string_view text, std::size_t position) {
  constexpr std::size_t reach = 50;
  std::size_t begin = position > reach ? position - reach : 0;
  std::size_t end = std::min(text.size(), position + reach);
  while (begin > 0 && is_continuation(text[begin])) --begin;
  while (end < text.size() && is_continuation(text[end])) ++end;
  std::string part(text.substr(begin, end - begin));
  for (char& c : part) {
    if (std::iscntrl(static_cast<unsigned char>(c)) != 0) c = ' ';
  }
  return (begin > 0 ? "..." : "") + part + (end < text.size() ? "..." : "");
}

// Insertions, deletions, substitutions and swaps of neighbours that make `a` into `b`, upper and
// lower case being the same.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return std::tolower(static_cast<unsigned char>(c)); };
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::swap(before, last);
    std::swap(last, row);
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t cost = lower(a[i - 1]) == lower(b[j - 1]) ? 0 : 1;
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + cost});
      if (i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) &&
          lower(a[i - 2]) == lower(b[j - 1])) {
        row[j] = std::min(row[j], before[j - 2] + 1);
      }
    }
  }
  return row[b.size()];
}

// What to write instead of a symbol that is not in the grammar, or not where it stands.
std::string_view remedy_for_symbol(std::string_view symbol) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 24> table{{
      {"**", "write ^ for a power"},
      {"=", "compare with ==, or in t with < or >"},
      {"==", "compare two values at a time and join comparisons by &&"},
      {"&", "write && for 'and'"},
      {"|", "write || for 'or'"},
      {"%", "there is no remainder; write a percentage as a fraction"},
      {",", "a comma separates the arguments of a function; the decimal sign is a point"},
      {")", "remove it or open a parenthesis before it"},
      {":", "a choice is written condition ? value : value"},
      {"?", "a choice is written condition ? value : value"},
      {"[", "group with ( and )"},
      {"]", "group with ( and )"},
      {"{", "group with ( and )"},
      {"}", "group with ( and )"},
      {"−", "write - for minus"},
      {"–", "write - for minus"},
      {"×", "write * for a product"},
      {"·", "write * for a product"},
      {"÷", "write / for a quotient"},
      {"π", "write pi"},
      {"°", "write *deg for degrees"},
      {"²", "write ^2"},
      {"≤", "write <="},
      {"≥", "write >="},
  }};
  const auto* found = std::find_if(table.begin(), table.end(),
                                   [&](const auto& row) { return row.first == symbol; });
  return found == table.end() ? "remove it" : found->second;
}

}  // namespace

// Recursive descent. Code is appended to one program as it is read; what proves constant or
// unreachable is cut off its end again, so no tree is built.
class Expression::Parser {
  static constexpr int most_calls = 10'000;

 public:
  Parser(std::string_view text, const Parameters& parameters, Variables allowed)
      : text_(text), parameters_(&parameters), allowed_(allowed), variable_(name_of(allowed)) {}

  Expression run() {
    if (text_.size() > kMaxLength) {
      fail(0, std::to_string(text_.size()) + " bytes", "at most " + std::to_string(kMaxLength),
           "split the expression into parameters or tabulate it");
    }
    advance();
    const Operand whole = choice();
    if (token_.kind != Token::end) fail_at_token("an operator or the end");
    number(whole);
    for (const Instruction& i : program_) {
      if (i.op == Opcode::constant && i.target != kSound) report(faults_[to_index(i.target)]);
    }
    if (deepest(program_) > kMaxStack)
      fail(0, "more than " + std::to_string(kMaxStack) + " pending values", "less nesting",
           "name parts of the expression as parameters or split it");
    Expression expression;
    expression.breakpoints_ = join_switching_times(program_);
    expression.sensors_ = std::move(sensors_);
    program_.shrink_to_fit();
    expression.program_ = std::move(program_);
    expression.text_ = text_;
    return expression;
  }

  static bool is_switch(const Instruction& i) {
    return i.op == Opcode::before || i.op == Opcode::after || i.op == Opcode::negate_before ||
           i.op == Opcode::negate_after || i.op == Opcode::first_before ||
           i.op == Opcode::first_after;
  }

  // Breakpoints; in the program, times that differ by rounding only become equal.
  static std::vector<double> join_switching_times(std::vector<Instruction>& program) {
    std::vector<double> all;
    for (const Instruction& i : program) {
      if (is_switch(i)) all.push_back(i.value);
    }
    std::sort(all.begin(), all.end());
    std::vector<double> times;
    for (const double t : all) {
      constexpr double unit = std::numeric_limits<double>::epsilon();
      if (times.empty() || t - times.back() > 4.0 * unit * std::abs(t)) times.push_back(t);
    }
    for (Instruction& i : program) {
      if (is_switch(i)) i.value = *(std::upper_bound(times.begin(), times.end(), i.value) - 1);
    }
    return times;
  }

  // Most pending values. Both branches of a choice push one value: `jump`, which ends the first, takes it off the count.
  static std::size_t deepest(const std::vector<Instruction>& program) {
    std::size_t depth = 0, most = 0;
    for (const Instruction& i : program) {
      switch (i.op) {
        case Opcode::constant:
        case Opcode::time:
        case Opcode::input:
        case Opcode::sensor:
        case Opcode::before:
        case Opcode::after:
          ++depth;
          break;
        case Opcode::add:
        case Opcode::subtract:
        case Opcode::multiply:
        case Opcode::divide:
        case Opcode::power:
        case Opcode::atan2:
        case Opcode::first_before:
        case Opcode::first_after:
        case Opcode::min:
        case Opcode::max:
        case Opcode::less:
        case Opcode::less_equal:
        case Opcode::equal:
        case Opcode::both:
        case Opcode::either:
        case Opcode::jump:
        case Opcode::jump_if_false:
          --depth;
          break;
        default:
          break;
      }
      most = std::max(most, depth);
    }
    return most;
  }

 private:
  struct Token {
    enum Kind { number, name, symbol, end } kind = end;
    std::size_t position = 0;  // in text_, bytes
    std::string_view text;
    double value = 0.0;  // of a number
  };

  // A part of the text that has been read, its code the end of the program.
  struct Operand {
    enum Kind {
      constant,   // number: offset
      affine,     // number: slope t + offset, slope not 0
      general,    // number that depends on t in any other way
      truth,      // condition with the constant value offset != 0; has no code
      condition,  // condition that depends on t
    } kind;
    std::size_t begin;     // of its code
    std::size_t position;  // of its text
    double slope = 0.0;    // [1/s]
    double offset = 0.0;
    std::int32_t fault = kSound;  // of a constant or truth: index in faults_

    bool is_number() const { return kind == constant || kind == affine || kind == general; }
    bool is_faulty() const { return fault != kSound; }
  };

  // A constant that is not finite. Reported only if it is still in the program at the end.
  struct Fault {
    std::size_t position;
    std::string found;
  };

  static constexpr std::int32_t kSound = -1;

  static std::size_t to_index(std::int32_t i) { return static_cast<std::size_t>(i); }

  // ---- errors

  [[noreturn]] void fail(std::size_t position, const std::string& found,
                         const std::string& expected, const std::string& remedy) const {
    throw Error("expression \"" + excerpt(text_, position) + "\", column " +
                std::to_string(count_characters(text_.substr(0, position)) + 1) + ": found " +
                found + ", expected " + expected + "; " + remedy);
  }

  [[noreturn]] void report(const Fault& fault) const {
    fail(fault.position, fault.found, "a finite number",
         "check the values, or exclude them by condition ? value : value");
  }

  std::string describe_token() const {
    if (token_.kind == Token::end) return "the end";
    const auto first = static_cast<unsigned char>(token_.text.front());
    if (std::iscntrl(first) != 0) return "control character " + std::to_string(int{first});
    return quoted(token_.text);
  }

  // The token cannot stand here.
  [[noreturn]] void fail_at_token(const std::string& expected) const {
    std::string remedy(remedy_for_symbol(token_.text));
    const bool opens = token_.kind == Token::number || token_.kind == Token::name || is_symbol("(");
    if (token_.kind == Token::end) {
      remedy = text_.find_first_not_of(" \t\r\n") == std::string_view::npos
                   ? "the expression is empty: give a value"
                   : "complete the expression";
    } else if (opens) {
      remedy = "write * for a product";
    } else if (expected.starts_with("a number") && remedy == "remove it") {
      remedy = "give a value before it or remove it";
    }
    fail(token_.position, describe_token(), expected, remedy);
  }

  // ---- tokens

  void advance() {
    const std::size_t begin = std::min(text_.find_first_not_of(" \t\r\n", at_), text_.size());
    token_ = {Token::end, begin, {}, 0.0};
    at_ = begin;
    if (begin == text_.size()) return;
    const auto byte = [&](std::size_t i) {
      return i < text_.size() ? static_cast<unsigned char>(text_[i]) : 0;
    };
    const auto is_name_part = [&](std::size_t i) {
      return byte(i) < 128 && (std::isalnum(byte(i)) != 0 || byte(i) == '_');
    };
    if (std::isdigit(byte(begin)) != 0 ||
        (byte(begin) == '.' && std::isdigit(byte(begin + 1)) != 0)) {
      read_number();
    } else if (is_name_part(begin)) {
      token_.kind = Token::name;
      // Of sensors, after their first letter, anything that names of items, places and components have but a minus.
      while (is_name_part(at_) || ((byte(at_) == '.' || byte(at_) == '@') && is_name_part(at_ + 1)))
        ++at_;
    } else {
      token_.kind = Token::symbol;
      constexpr std::array<std::string_view, 7> doubles{"<=", ">=", "==", "!=", "&&", "||", "**"};
      const std::string_view pair = text_.substr(begin, 2);
      at_ += std::find(doubles.begin(), doubles.end(), pair) != doubles.end() ? 2U : 1U;
      while (at_ < text_.size() && is_continuation(text_[at_])) ++at_;
    }
    token_.text = text_.substr(begin, at_ - begin);
  }

  void read_number() {
    token_.kind = Token::number;
    const char* const first = text_.data() + at_;
    const auto [last, error] = std::from_chars(first, text_.data() + text_.size(), token_.value);
    const std::size_t begin = at_;
    at_ += static_cast<std::size_t>(last - first);
    if (error != std::errc()) {
      fail(begin, "the number " + quoted(text_.substr(begin, at_ - begin)),
           "a number between 1e-307 and 1e308",
           "double precision holds no other; choose other units");
    }
  }

  bool is_symbol(std::string_view symbol) const {
    return token_.kind == Token::symbol && token_.text == symbol;
  }

  bool accept(std::string_view symbol) {
    if (!is_symbol(symbol)) return false;
    advance();
    return true;
  }

  // ---- code

  std::size_t emit(Opcode op, double value = 0.0, std::int32_t target = kSound) {
    program_.push_back({op, target, value});
    return program_.size() - 1;
  }

  void cut(std::size_t begin) { program_.resize(begin); }

  // Replaces the code from `begin` by a constant.
  Operand constant(std::size_t begin, std::size_t position, double value,
                   std::int32_t fault = kSound) {
    cut(begin);
    emit(Opcode::constant, value, fault);
    return {Operand::constant, begin, position, 0.0, value, fault};
  }

  // Replaces the code from `begin` by a constant that may not be finite; `found` says how it came.
  template <class Found>
  Operand checked_constant(std::size_t begin, std::size_t position, double value,
                           std::size_t fault_position, const Found& found) {
    if (std::isfinite(value)) return constant(begin, position, value);
    faults_.push_back({fault_position, found() + " = " + to_text(value)});
    return constant(begin, position, value, static_cast<std::int32_t>(faults_.size() - 1));
  }

  Operand truth(const Operand& at, bool value) {
    cut(at.begin);
    return {Operand::truth, at.begin, at.position, 0.0, value ? 1.0 : 0.0, kSound};
  }

  // The constant or truth `x` that is not finite, in the place of `at`.
  Operand faulty_number(const Operand& at, const Operand& x) {
    return constant(at.begin, at.position, std::numeric_limits<double>::quiet_NaN(), x.fault);
  }
  Operand faulty_truth(const Operand& at, const Operand& x) {
    cut(at.begin);
    return {Operand::truth, at.begin, at.position, 0.0, 0.0, x.fault};
  }

  Operand general(const Operand& at) const { return {Operand::general, at.begin, at.position}; }

  // The same code, known to be slope t + offset.
  Operand affine(const Operand& at, double slope, double offset) {
    if (slope == 0.0 && std::isfinite(offset)) return constant(at.begin, at.position, offset);
    return {Operand::affine, at.begin, at.position, slope, offset, kSound};
  }

  // ---- types

  const Operand& number(const Operand& x) const {
    if (!x.is_number()) {
      fail(x.position, "a condition", "a number", "choose values by condition ? value : value");
    }
    return x;
  }

  const Operand& condition(const Operand& x) const {
    if (x.is_number()) {
      fail(x.position, "a number", "a condition",
           "compare it with something, as in " + variable_ + " < 1");
    }
    return x;
  }

  // ---- grammar

  // Counts the levels of recursion while it lives.
  class Level {
   public:
    explicit Level(Parser& parser) : depth_(parser.depth_) {
      if (++depth_ > kMaxNesting) {
        parser.fail(parser.token_.position, "more than " + std::to_string(kMaxNesting) + " levels",
                    "less nesting", "name parts of the expression as parameters or split it");
      }
    }
    ~Level() { --depth_; }
    Level(const Level&) = delete;
    Level& operator=(const Level&) = delete;

   private:
    int& depth_;
  };

  // A chain c1 ? v1 : c2 ? v2 : … is a loop, so that tables of any length can be written:
  //   c1, jump_if_false 2, v1, jump end, 2: c2, jump_if_false 3, v2, jump end, 3: …
  // With constant conditions only the code of the branch taken remains.
  Operand choice() {
    const Level level(*this);
    const std::size_t position = token_.position;
    const std::size_t begin = program_.size();
    std::vector<std::size_t> exits;  // jumps to the end
    std::optional<Operand> last;     // the value when all conditions so far are false, once known
    Operand head = disjunction();
    if (!is_symbol("?")) return head;
    while (accept("?")) {
      condition(head);
      const bool is_excluded =
          last.has_value() || (head.kind == Operand::truth && head.offset == 0.0);
      std::optional<std::size_t> skip;
      if (head.kind == Operand::condition) skip = emit(Opcode::jump_if_false);
      const Operand value = number(choice());
      if (token_.kind == Token::end) {
        fail(token_.position, describe_token(), "an operator or ':'",
             "a choice is written condition ? value : value");
      }
      if (!accept(":")) fail_at_token("an operator or ':'");
      if (last.has_value()) {
        cut(head.begin);
      } else if (head.is_faulty()) {
        last = faulty_number(head, head);
      } else if (is_excluded) {
        cut(head.begin);
      } else if (head.kind == Operand::truth) {
        last = value;
      } else {
        exits.push_back(emit(Opcode::jump));
        program_[*skip].target = static_cast<std::int32_t>(program_.size());
      }
      head = disjunction();
    }
    number(head);
    if (last.has_value()) {
      cut(head.begin);
    } else {
      last = head;
    }
    for (const std::size_t exit : exits) {
      program_[exit].target = static_cast<std::int32_t>(program_.size());
    }
    if (exits.empty()) {
      last->position = position;
      return *last;
    }
    return {Operand::general, begin, position};
  }

  Operand disjunction() {
    Operand left = conjunction();
    while (accept("||")) left = join(left, conjunction(), Opcode::either);
    return left;
  }

  Operand conjunction() {
    Operand left = negation();
    while (accept("&&")) left = join(left, negation(), Opcode::both);
    return left;
  }

  // left && right, left || right. The constant that decides alone is false for &&, true for ||.
  Operand join(const Operand& left, const Operand& right, Opcode op) {
    condition(left);
    condition(right);
    const bool deciding = op == Opcode::either;
    if (left.is_faulty()) return faulty_truth(left, left);
    if (left.kind == Operand::truth) {
      if ((left.offset != 0.0) == deciding) return truth(left, deciding);
      Operand result = right;
      result.position = left.position;
      return result;
    }
    if (right.is_faulty()) return faulty_truth(left, right);
    if (right.kind == Operand::truth) {
      return (right.offset != 0.0) == deciding ? truth(left, deciding) : left;
    }
    emit(op);
    return left;
  }

  Operand negation() {
    if (!is_symbol("!")) return comparison();
    const Level level(*this);
    const std::size_t position = token_.position;
    advance();
    Operand x = condition(negation());
    x.position = position;
    if (x.kind == Operand::truth) {
      x.offset = x.offset == 0.0 ? 1.0 : 0.0;
    } else {
      emit(Opcode::opposite);
    }
    return x;
  }

  bool is_comparison() const {
    constexpr std::array<std::string_view, 6> all{"<", "<=", ">", ">=", "==", "!="};
    return token_.kind == Token::symbol &&
           std::find(all.begin(), all.end(), token_.text) != all.end();
  }

  Operand comparison() {
    const Operand left = sum();
    if (!is_comparison()) return left;
    const Token op = token_;
    advance();
    number(left);
    const Operand result = compare(left, number(sum()), op);
    if (is_comparison()) {
      fail(token_.position, "a second comparison", "the end of the condition",
           "join comparisons by &&, as in 0 < " + variable_ + " && " + variable_ + " < 1");
    }
    return result;
  }

  Operand compare(const Operand& left, const Operand& right, const Token& op) {
    if (left.is_faulty()) return faulty_truth(left, left);
    if (right.is_faulty()) return faulty_truth(left, right);
    const bool is_equality = op.text == "==" || op.text == "!=";
    if (is_sampled() && !(left.kind == Operand::constant && right.kind == Operand::constant))
      return compare_values(left, op);
    if (left.kind == Operand::constant && right.kind == Operand::constant) {
      if (is_equality) return truth(left, (left.offset == right.offset) == (op.text == "=="));
      const double x = left.offset, y = right.offset;
      return truth(left, op.text == "<"    ? x < y
                         : op.text == "<=" ? x <= y
                         : op.text == ">"  ? x > y
                                           : x >= y);
    }
    if (is_equality) {
      fail(
          op.position, quoted(op.text) + " in " + variable_, "<, <=, > or >=",
          "equality holds at an instant only and has no effect on the motion; compare with < or >");
    }
    const bool is_less = op.text.front() == '<';
    if (left.kind == Operand::general || right.kind == Operand::general) {
      fail(op.position, "a comparison of a general function of " + variable_,
           "terms of the form a*" + variable_ + " + b",
           has_sensors_ ? "sensors cannot be compared, as a law must have a derivative: write a "
                          "smooth step, such as tanh, or a <controller>, which may compare them"
           : has_inputs_
               ? "inputs cannot be compared; decide in the program that sets them"
               : "solve for the switching " + std::string(is_of_time() ? "time" : "point") +
                     " and compare " + variable_ + " with it; write abs(x) < a as -a < x && x < a");
    }
    const double slope = left.slope - right.slope;
    if (slope == 0.0) {
      const double difference = left.offset - right.offset;
      const bool is_strict = op.text.size() == 1;
      return truth(left, is_less ? (difference < 0.0 || (!is_strict && difference == 0.0))
                                 : (difference > 0.0 || (!is_strict && difference == 0.0)));
    }
    const double time = switching_time(left, right, op.position);
    cut(left.begin);
    emit(is_less == (slope > 0.0) ? Opcode::before : Opcode::after, time);
    return {Operand::condition, left.begin, left.position};
  }

  bool is_sampled() const { return allowed_ == Variables::sampled; }

  // Of two numbers at an instant.
  Operand compare_values(const Operand& left, const Token& op) {
    const bool equality = op.text == "==" || op.text == "!=";
    const bool turned = op.text == "!=" || op.text.front() == '>';  // !(x <= y), !(x < y)
    const bool strict = op.text == "<" || op.text == ">=";
    emit(equality ? Opcode::equal : strict ? Opcode::less : Opcode::less_equal);
    if (turned) emit(Opcode::opposite);
    return {Operand::condition, left.begin, left.position};
  }

  // When two affine terms of different slope are equal.
  double switching_time(const Operand& x, const Operand& y, std::size_t position) const {
    const double time = (y.offset - x.offset) / (x.slope - y.slope);
    if (!std::isfinite(time) || !std::isfinite(x.slope - y.slope)) {
      fail(position, "a switching time that is not finite", "a finite time",
           "check the magnitude of the constants");
    }
    return time + 0.0;  // not -0
  }

  Operand sum() {
    Operand left = product();
    while (is_symbol("+") || is_symbol("-")) {
      left = binary(left, is_symbol("+") ? Opcode::add : Opcode::subtract, &Parser::product);
    }
    return left;
  }

  Operand product() {
    Operand left = sign();
    while (is_symbol("*") || is_symbol("/")) {
      left = binary(left, is_symbol("*") ? Opcode::multiply : Opcode::divide, &Parser::sign);
    }
    return left;
  }

  Operand sign() {
    if (!is_symbol("-") && !is_symbol("+")) return power();
    const Level level(*this);
    const bool is_minus = is_symbol("-");
    const std::size_t position = token_.position;
    advance();
    Operand x = number(sign());
    x.position = position;
    if (!is_minus) return x;
    if (x.kind == Operand::constant) return constant(x.begin, position, -x.offset, x.fault);
    emit(Opcode::negate);
    return x.kind == Operand::affine ? affine(x, -x.slope, -x.offset) : x;
  }

  Operand power() {
    const Operand base = primary();
    if (!is_symbol("^")) return base;
    const Level level(*this);
    return binary(base, Opcode::power, &Parser::sign);
  }

  // Reads the operator, which is the current token, and the operand on its right.
  Operand binary(const Operand& left, Opcode op, Operand (Parser::*read_right)()) {
    const Token token = token_;
    number(left);
    advance();
    const Operand right = number((this->*read_right)());
    return combine(left, right, op, token.position, " " + std::string(token.text) + " ");
  }

  // left op right. `symbol` and `position` are for the message if the result is not finite.
  Operand combine(const Operand& left, const Operand& right, Opcode op, std::size_t position,
                  std::string_view symbol) {
    if (left.is_faulty()) return faulty_number(left, left);
    if (right.is_faulty()) return faulty_number(left, right);
    const double x = left.offset, y = right.offset;
    if (left.kind == Operand::constant && right.kind == Operand::constant) {
      return checked_constant(left.begin, left.position, fold(op, x, y), position, [&] {
        return symbol.front() == ' '
                   ? to_text(x) + std::string(symbol) + to_text(y)
                   : std::string(symbol) + "(" + to_text(x) + ", " + to_text(y) + ")";
      });
    }
    const bool is_right_constant = right.kind == Operand::constant;
    if (op == Opcode::divide && is_right_constant && y == 0.0) {
      faults_.push_back({position, "a division by zero"});
      return constant(left.begin, left.position, std::numeric_limits<double>::quiet_NaN(),
                      static_cast<std::int32_t>(faults_.size() - 1));
    }
    if (op == Opcode::power && is_right_constant) {
      cut(right.begin);
      emit(Opcode::power_constant, y);
      return general(left);
    }
    emit(op);
    const bool is_left_general = left.kind == Operand::general;
    const bool is_right_general = right.kind == Operand::general;
    if (is_left_general || is_right_general) return general(left);
    switch (op) {
      case Opcode::add:
        return affine(left, left.slope + right.slope, x + y);
      case Opcode::subtract:
        return affine(left, left.slope - right.slope, x - y);
      case Opcode::multiply:
        if (left.kind == Operand::constant) return affine(left, x * right.slope, x * y);
        if (is_right_constant) return affine(left, y * left.slope, x * y);
        return general(left);
      case Opcode::divide:
        return is_right_constant ? affine(left, left.slope / y, x / y) : general(left);
      default:
        return general(left);
    }
  }

  Operand primary() {
    const Token token = token_;
    if (token.kind == Token::number) {
      advance();
      return constant(program_.size(), token.position, token.value);
    }
    if (token.kind == Token::name) {
      advance();
      return named(token);
    }
    if (accept("(")) {
      Operand x = choice();
      if (!is_symbol(")")) fail_unclosed(token.position, "an operator or ')'");
      advance();
      x.position = token.position;
      return x;
    }
    fail_at_token("a number, a name or '('");
  }

  [[noreturn]] void fail_unclosed(std::size_t opened, const std::string& expected) const {
    if (token_.kind != Token::end) fail_at_token(expected);
    fail(token_.position, describe_token(), expected,
         "close the parenthesis opened at column " +
             std::to_string(count_characters(text_.substr(0, opened)) + 1));
  }

  Operand named(const Token& name) {
    const auto parameter = parameters_->find(name.text);
    const bool is_parameter = parameter != parameters_->end();
    const bool is_variable = allowed_ != Variables::none && name.text == variable_;
    const bool is_instant = allowed_ == Variables::place && name.text == kTime;
    if (is_parameter && !is_instant && (is_variable || is_reserved(name.text))) {
      fail(name.position, "a parameter named " + quoted(name.text),
           "the built-in meaning of this name", "rename the parameter");
    }
    if (is_parameter) {
      return checked_constant(program_.size(), name.position, parameter->second, name.position,
                              [&] { return "the parameter " + std::string(name.text); });
    }
    if (const auto* known = find_name(kConstants, name.text)) {
      return constant(program_.size(), name.position, known->value);
    }
    if (name.text == kTime && allowed_ == Variables::none) {
      fail(name.position, "the time t", "a constant",
           "this value cannot vary; use numbers and parameters");
    }
    if (name.text == kTime && !is_of_time()) {
      fail(name.position, "the time t", "a function of " + variable_,
           "a law does not vary in time; use " + variable_ + ", numbers and parameters");
    }
    if (is_variable) return argument_ ? argument(name.position) : time(name.position);
    if (const auto input = parameters_->inputs.find(name.text);
        input != parameters_->inputs.end()) {
      if (!is_of_time())
        fail(name.position, "the input " + quoted(name.text),
             allowed_ == Variables::none ? "a constant" : "a function of " + variable_,
             "inputs vary in time, and are for the laws of loads and drives");
      has_inputs_ = true;
      const std::size_t begin = emit(Opcode::input, input->second.factor, input->second.index);
      return {Operand::general, begin, name.position};
    }
    if (const auto function = parameters_->functions.find(name.text);
        function != parameters_->functions.end())
      return call(function->second, name);
    if (const auto* function = find_name(kFunctions, name.text)) return call(*function, name);
    const bool is_sensor = name.text.find_first_of(".@") != std::string_view::npos;
    if (is_sensor || parameters_->own.contains(name.text)) return sensor(name);
    fail_unknown(name);
  }

  bool is_of_time() const { return allowed_ == Variables::time || is_sampled(); }

  Operand time(std::size_t position) {
    const std::size_t begin = emit(Opcode::time);
    if (is_sampled()) return {Operand::general, begin, position};
    return {Operand::affine, begin, position, 1.0, 0.0, kSound};
  }

  // t in a function of the model: what it is called with.
  Operand argument(std::size_t position) {
    const auto [slope, offset] = *argument_;
    const std::size_t begin = program_.size();
    if (slope == 0.0) return constant(begin, position, offset);
    const Operand t = time(position);
    if (slope != 1.0) {
      emit(Opcode::constant, slope);
      emit(Opcode::multiply);
    }
    if (offset != 0.0) {
      emit(Opcode::constant, offset);
      emit(Opcode::add);
    }
    if (t.kind == Operand::general) return {Operand::general, begin, position};
    return {Operand::affine, begin, position, slope, offset, kSound};
  }

  Operand sensor(const Token& name) {
    if (!is_of_time() || argument_)
      fail(name.position, "the sensor " + quoted(name.text),
           allowed_ == Variables::none ? "a constant" : "a function of " + variable_,
           argument_
               ? "a <function> is of time; use sensors in the laws of loads and in controllers"
               : "sensors vary in time, and are for the laws of loads and for controllers");
    has_sensors_ = true;
    const auto known = std::find(sensors_.begin(), sensors_.end(), name.text);
    const auto place = static_cast<std::int32_t>(known - sensors_.begin());
    if (known == sensors_.end()) sensors_.emplace_back(name.text);
    const std::size_t begin = emit(Opcode::sensor, 0.0, place);
    return {Operand::general, begin, name.position};
  }

  void count_call(const Token& name) {
    if (++calls_ > most_calls)
      fail(name.position,
           "more than " + std::to_string(most_calls) + " calls of functions in one law",
           "fewer, those within functions counted",
           "functions that call others several times are read that often: give a <table>, or "
           "shorten the chain");
  }

  // A function of the model: its text is read in place of the call, with the argument as its t.
  Operand call(const NamedFunction& function, const Token& name) {
    const Level level(*this);
    const std::string shape = std::string(name.text) + "(t)";
    count_call(name);
    if (!is_of_time())
      fail(name.position, "the function of time " + quoted(name.text),
           allowed_ == Variables::none ? "a constant" : "a function of " + variable_,
           "this value does not vary in time");
    const std::size_t opened = token_.position;
    if (!accept("("))
      fail(token_.position, describe_token(), "'(' after " + std::string(name.text),
           "write " + shape);
    if (is_symbol(")")) fail(token_.position, "no argument", shape, "give the argument");
    const std::size_t begin = program_.size();
    // Read as an expression of time, also where the rest is sampled: then it is known to be a*t + b.
    const Variables around = std::exchange(allowed_, Variables::time);
    const Operand x = number(choice());
    allowed_ = around;
    if (is_symbol(","))
      fail(token_.position, "one argument too many", shape,
           "remove it; the decimal sign is a point, not a comma");
    if (!is_symbol(")")) fail_unclosed(opened, "an operator or ')'");
    if (x.is_faulty()) {
      advance();
      return x;
    }
    if (x.kind == Operand::general)
      fail(x.position, "a general function of t as the argument of " + std::string(name.text),
           "t, or an argument of the form a*t + b",
           "a function of time is called at the time, or at another that goes with it");
    cut(begin);
    const auto text = std::exchange(text_, std::string_view(*function.text));
    const auto* const parameters = std::exchange(parameters_, function.parameters.get());
    const std::size_t at = std::exchange(at_, 0);
    const Token token = token_;
    const auto outer =
        std::exchange(argument_, std::pair(x.kind == Operand::constant ? 0.0 : x.slope, x.offset));
    const auto variable = std::exchange(variable_, std::string(kTime));
    advance();
    Operand value = number(choice());
    if (token_.kind != Token::end) fail_at_token("an operator or the end");
    text_ = text;
    parameters_ = parameters;
    at_ = at;
    token_ = token;
    argument_ = outer;
    variable_ = variable;
    advance();
    value.position = name.position;
    if (function.factor == 1.0 || value.is_faulty()) return value;
    if (value.kind == Operand::constant)
      return constant(value.begin, value.position, function.factor * value.offset);
    emit(Opcode::constant, function.factor);
    emit(Opcode::multiply);
    return value.kind == Operand::affine
               ? affine(value, function.factor * value.slope, function.factor * value.offset)
               : value;
  }

  Operand call(const Function& function, const Token& name) {
    const std::string shape = std::string(function.name) + (function.arity == 1 ? "(x)" : "(x, y)");
    const std::size_t opened = token_.position;
    if (!is_symbol("(")) {
      fail(token_.position, describe_token(), "'(' after " + std::string(function.name),
           "write " + shape);
    }
    advance();
    if (is_symbol(")")) fail(token_.position, "no argument", shape, "give the arguments");
    const Operand first = number(choice());
    std::optional<Operand> second;
    if (function.arity == 2) {
      if (is_symbol(")")) fail(token_.position, "one argument", shape, "give a second argument");
      if (!accept(",")) fail_unclosed(opened, "an operator or ','");
      second = number(choice());
    }
    if (is_symbol(",")) {
      fail(token_.position, "one argument too many", shape,
           "remove it; the decimal sign is a point, not a comma");
    }
    if (!is_symbol(")")) fail_unclosed(opened, "an operator or ')'");
    advance();
    Operand result =
        second ? call_two(function, first, *second, name) : call_one(function, first, name);
    result.position = name.position;
    return result;
  }

  Operand call_one(const Function& function, const Operand& x, const Token& name) {
    if (x.is_faulty()) return x;
    if (x.kind == Operand::constant) {
      return checked_constant(x.begin, x.position, fold(function.op, x.offset), name.position, [&] {
        return std::string(function.name) + "(" + to_text(x.offset) + ")";
      });
    }
    if (is_sampled()) {
      emit(function.op);
      return general(x);
    }
    switch (function.op) {
      case Opcode::abs: {
        if (x.kind != Operand::affine) fail_kink(function, x);
        const Operand zero{Operand::constant, x.begin, x.position};
        const double time = switching_time(x, zero, x.position);
        emit(x.slope > 0.0 ? Opcode::negate_before : Opcode::negate_after, time);
        return general(x);
      }
      case Opcode::floor:
      case Opcode::ceil:
      case Opcode::round:
        fail(x.position, std::string(function.name) + " of a function of " + variable_,
             "a constant argument",
             "it jumps at many times; write the steps as " + variable_ + " < " + variable_ +
                 "1 ? v1 : " + variable_ + " < " + variable_ + "2 ? v2 : v3");
      default:
        emit(function.op);
        return general(x);
    }
  }

  Operand call_two(const Function& function, const Operand& x, const Operand& y,
                   const Token& name) {
    const bool is_constant = x.kind == Operand::constant && y.kind == Operand::constant;
    const bool is_selection = function.op == Opcode::min || function.op == Opcode::max;
    if (!is_selection || is_constant || x.is_faulty() || y.is_faulty()) {
      return combine(x, y, function.op, name.position, function.name);
    }
    if (is_sampled()) {
      emit(function.op);
      return general(x);
    }
    if (x.kind == Operand::general) fail_kink(function, x);
    if (y.kind == Operand::general) fail_kink(function, y);
    const double slope = x.slope - y.slope;
    const bool is_min = function.op == Opcode::min;
    if (slope == 0.0) {  // never equal, or always: one of them for all times
      if ((x.offset <= y.offset) == is_min) {
        cut(y.begin);
        return x;
      }
      using Offset = std::vector<Instruction>::difference_type;
      program_.erase(program_.begin() + static_cast<Offset>(x.begin),
                     program_.begin() + static_cast<Offset>(y.begin));  // affine: has no jumps
      Operand result = y;
      result.begin = x.begin;
      return result;
    }
    const double time = switching_time(x, y, name.position);
    emit(is_min == (slope > 0.0) ? Opcode::first_before : Opcode::first_after, time);
    return general(x);
  }

  [[noreturn]] void fail_kink(const Function& function, const Operand& x) const {
    fail(x.position, std::string(function.name) + " of a general function of " + variable_,
         "arguments that are constant or of the form a*" + variable_ + " + b",
         has_sensors_
             ? std::string("a law of sensors must have a derivative: limit it smoothly, as "
                           "a*tanh(u/a), or in a <controller>")
         : has_inputs_ ? std::string("limit inputs in the program that sets them")
                       : "the times of its kinks are not known; write them as " + variable_ +
                             " < " + variable_ + "1 ? value : value");
  }

  [[noreturn]] void fail_unknown(const Token& name) const {
    std::vector<std::string_view> names;
    std::string list;
    const auto add = [&](std::string_view title, const auto& table, const auto& name_of) {
      constexpr std::size_t most = 40;
      std::size_t count = 0;
      for (const auto& row : table) {
        names.push_back(name_of(row));
        if (++count <= most)
          list += (count == 1 ? std::string(title) : ", ") + std::string(name_of(row));
      }
      if (count > most) list += " and " + std::to_string(count - most) + " more";
    };
    const auto by_name = [](const auto& row) { return row.name; };
    add("parameters ", *parameters_, [](const auto& row) { return std::string_view(row.first); });
    if (list.empty()) list = "no parameters";
    if (is_of_time() && !parameters_->inputs.empty())
      add("; inputs ", parameters_->inputs,
          [](const auto& row) { return std::string_view(row.first); });
    if (is_of_time() && !parameters_->functions.empty())
      add("; functions of time ", parameters_->functions,
          [](const auto& row) { return std::string_view(row.first); });
    if (is_of_time() && !parameters_->own.empty())
      add("; states ", parameters_->own,
          [](const std::string& own) { return std::string_view(own); });
    add("; constants ", kConstants, by_name);
    if (allowed_ != Variables::none) {
      names.push_back(variable_);
      list += (is_of_time() ? "; the time " : "; the variable ") + variable_;
    }
    add("; functions ", kFunctions, by_name);
    const auto distance = [&](std::string_view other) { return edit_distance(name.text, other); };
    const std::string_view nearest = *std::min_element(
        names.begin(), names.end(),
        [&](std::string_view a, std::string_view b) { return distance(a) < distance(b); });
    const bool is_near = distance(nearest) <= (name.text.size() + 1) / 3;
    fail(name.position, "the unknown name " + quoted(name.text),
         "a parameter, a constant or a function",
         (is_near ? "did you mean " + quoted(nearest) + "? " : "") + "there are: " + list);
  }

  std::string_view text_;
  const Parameters* parameters_;
  Variables allowed_;
  std::string variable_;     // its name, for messages
  std::size_t at_ = 0;       // where the next token is looked for
  Token token_;              // the current token
  int depth_ = -1;           // levels of recursion; the whole is level 0
  int calls_ = 0;            // of functions of the model
  bool has_inputs_ = false;  // the text names one
  bool has_sensors_ = false;
  std::vector<std::string> sensors_;
  std::optional<std::pair<double, double>>
      argument_;  // slope and offset of t, in a function that is called
  std::vector<Instruction> program_;
  std::vector<Fault> faults_;
};

Expression Expression::parse(std::string_view text, const Parameters& parameters,
                             Variables allowed) {
  return Parser(text, parameters, allowed).run();
}

Expression Expression::sum(std::span<const Term> terms, double stretch) {
  if (!(stretch > 0.0 && std::isfinite(stretch)))
    throw Error("a law of time stretched by " + to_text(stretch) + "; that must be positive");
  Expression result;
  std::vector<Instruction>& program = result.program_;
  constexpr std::int32_t none = -1;
  double constant = 0.0;  // of all constant terms
  for (const auto& [factor, of] : terms) {
    if (factor == 0.0) continue;
    if (!result.text_.empty()) result.text_ += " + ";
    result.text_ += to_text(factor) + "*(" + of->text_ + ")";
    if (of->is_constant()) {
      constant += factor * of->value();
      continue;
    }
    const bool first = program.empty();
    std::vector<std::int32_t> places;  // of its sensors
    for (const std::string& name : of->sensors_) {
      auto& all = result.sensors_;
      const auto known = std::find(all.begin(), all.end(), name);
      places.push_back(static_cast<std::int32_t>(known - all.begin()));
      if (known == all.end()) all.push_back(name);
    }
    std::vector<std::int32_t> moved;  // where each instruction, and the end, have gone
    std::vector<std::size_t> jumps;
    for (const Instruction& i : of->program_) {
      moved.push_back(static_cast<std::int32_t>(program.size()));
      program.push_back(i);
      if (i.op == Opcode::sensor)
        program.back().target = places[static_cast<std::size_t>(i.target)];
      if (i.op == Opcode::jump || i.op == Opcode::jump_if_false)
        jumps.push_back(program.size() - 1);
      if (stretch == 1.0) continue;
      if (Parser::is_switch(i)) program.back().value *= stretch;
      if (i.op == Opcode::time) {
        program.push_back({Opcode::constant, none, stretch});
        program.push_back({Opcode::divide, none, 0.0});
      }
    }
    moved.push_back(static_cast<std::int32_t>(program.size()));
    for (const std::size_t j : jumps)
      program[j].target = moved[static_cast<std::size_t>(program[j].target)];
    if (factor != 1.0) {
      program.push_back({Opcode::constant, none, factor});
      program.push_back({Opcode::multiply, none, 0.0});
    }
    if (!first) program.push_back({Opcode::add, none, 0.0});
  }
  if (program.empty() || constant != 0.0) {
    program.push_back({Opcode::constant, none, constant});
    if (program.size() > 1) program.push_back({Opcode::add, none, 0.0});
  }
  if (result.text_.empty()) result.text_ = "0";
  if (stretch != 1.0) result.text_ += " at t/" + to_text(stretch);
  if (Parser::deepest(program) > kMaxStack)
    throw Error("the sum of the laws " + result.text_ + " has too many pending values");
  result.breakpoints_ = Parser::join_switching_times(program);
  return result;
}

bool Expression::is_reserved(std::string_view name) {
  return name == kTime || find_name(kConstants, name) != nullptr ||
         find_name(kFunctions, name) != nullptr;
}

std::uint64_t Expression::signature() const {
  Hash hash;
  for (const Instruction& one : program_) {
    hash.add(one.op);
    hash.add(one.target);
    hash.add(one.value);
  }
  for (const std::string& sensor : sensors_) hash.add(std::string_view(sensor));
  return hash.value();
}

bool Expression::is_constant() const {
  return program_.size() == 1 && program_.front().op == Opcode::constant;
}

bool Expression::has_inputs() const {
  return std::any_of(program_.begin(), program_.end(),
                     [](const Instruction& i) { return i.op == Opcode::input; });
}

Expression Expression::held_at(double sensors, double inputs) const {
  Expression held = *this;
  for (Instruction& i : held.program_) {
    const double place = i.target;
    if (i.op == Opcode::sensor) i = {Opcode::constant, -1, sensors * (1.0 + 0.37 * place)};
    if (i.op == Opcode::input) i = {Opcode::constant, -1, i.value * inputs * (0.77 + 0.29 * place)};
  }
  held.sensors_.clear();
  return held;
}

std::optional<Expression> Expression::of_sensor(std::size_t k, std::span<const double> sensors,
                                                double t) const {
  if (!breakpoints_.empty() || has_inputs()) return std::nullopt;
  Expression result = *this;
  for (Instruction& i : result.program_) {
    const auto place = static_cast<std::size_t>(i.target);
    if (i.op == Opcode::time) i = {Opcode::constant, -1, t};
    if (i.op == Opcode::sensor && place != k) i = {Opcode::constant, -1, sensors[place]};
    if (i.op == Opcode::sensor) i = {Opcode::time, -1, 0.0};
  }
  result.sensors_.clear();
  return result;
}

double Expression::value() const {
  if (!is_constant()) {
    throw Error("expression \"" + excerpt(text_, 0) +
                "\": found a function of t, expected a constant; use numbers and parameters");
  }
  return program_.front().value;
}

template <class S>
Taylor<S> Expression::evaluate(S t, Side side, std::span<const InputValue> inputs,
                               std::span<const double> sensors) const {
  return run(t, side, inputs, sensors, {});
}

double Expression::derivative(std::size_t sensor, double t, Side side,
                              std::span<const InputValue> inputs,
                              std::span<const double> sensors) const {
  return run(t, side, inputs, sensors, {.time = 0.0, .sensor = sensor}).d;
}

namespace {

// Where a program is evaluated, and whose derivatives are wanted.
template <class S>
struct Surroundings {
  S t;
  Side side;
  std::span<const InputValue> inputs;
  std::span<const double> sensors;
  S seed_of_time;
  std::size_t seeded;  // sensor

  bool is_after(double time) const { return side == Side::right ? t >= S(time) : t > S(time); }

  // The time, an input or a sensor.
  Taylor<S> pushed(Opcode op, double value, std::size_t place) const {
    constexpr S unknown = std::numeric_limits<S>::quiet_NaN();
    switch (op) {
      case Opcode::time:
        return {t, seed_of_time, S(0)};
      case Opcode::input: {
        const Taylor<S> u =
            place < inputs.size() ? inputs[place].at(t) : Taylor<S>{unknown, unknown, unknown};
        const S rate = S(value) * seed_of_time;
        return {S(value) * u.v, rate * u.d, rate * u.dd};
      }
      default:
        return {place < sensors.size() ? S(sensors[place]) : unknown, place == seeded ? S(1) : S(0),
                S(0)};
    }
  }
};

}  // namespace

template <class S>
Taylor<S> Expression::run(S t, Side side, std::span<const InputValue> inputs,
                          std::span<const double> sensors, const Seed& seed) const {
  const Surroundings<S> here{t, side, inputs, sensors, S(seed.time), seed.sensor};
  std::array<Taylor<S>, kMaxStack> stack;  // uninitialised; the parser has checked the depth
  std::size_t size = 0;
  for (std::size_t i = 0; i < program_.size(); ++i) {
    const auto& [op, target, value] = program_[i];
    switch (op) {
      case Opcode::constant:
        stack[size++] = {S(value), S(0), S(0)};
        break;
      case Opcode::time:
      case Opcode::input:
      case Opcode::sensor:
        stack[size++] = here.pushed(op, value, static_cast<std::size_t>(target));
        break;
      case Opcode::before:
      case Opcode::after:
        stack[size++] = {here.is_after(value) == (op == Opcode::after) ? S(1) : S(0), S(0), S(0)};
        break;
      case Opcode::add:
      case Opcode::subtract:
      case Opcode::multiply:
      case Opcode::divide:
      case Opcode::power:
      case Opcode::atan2:
      case Opcode::both:
      case Opcode::either:
      case Opcode::less:
      case Opcode::less_equal:
      case Opcode::equal:
      case Opcode::min:
      case Opcode::max:
        --size;
        stack[size - 1] = apply(op, stack[size - 1], stack[size]);
        break;
      case Opcode::power_constant:
        stack[size - 1] = pow(stack[size - 1], S(value));
        break;
      case Opcode::negate_before:
      case Opcode::negate_after:
        if (here.is_after(value) == (op == Opcode::negate_after))
          stack[size - 1] = -stack[size - 1];
        break;
      case Opcode::first_before:
      case Opcode::first_after:
        --size;
        if (here.is_after(value) == (op == Opcode::first_before)) stack[size - 1] = stack[size];
        break;
      case Opcode::jump:
      case Opcode::jump_if_false:
        if (op == Opcode::jump || stack[--size].v == S(0)) i = static_cast<std::size_t>(target) - 1;
        break;
      default:
        stack[size - 1] = apply(op, stack[size - 1]);
        break;
    }
  }
  return stack[0];
}

template Taylor<double> Expression::evaluate(double, Side, std::span<const InputValue>,
                                             std::span<const double>) const;
template Taylor<long double> Expression::evaluate(long double, Side, std::span<const InputValue>,
                                                  std::span<const double>) const;

}  // namespace mbd
