#include "libmbd/language/units.hpp"

#include <udunits2.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>
#include <numbers>
#include <optional>
#include <vector>

#include "libmbd/core/error.hpp"
#include "libmbd/text/spelling.hpp"
#include "libmbd/text/text.hpp"

namespace mbd {
namespace {

struct FreeUnit {
  void operator()(ut_unit* unit) const { ut_free(unit); }
};
using Unit = std::unique_ptr<ut_unit, FreeUnit>;

struct AngleUnit {
  const char* name;
  double in_rad;  // or rad/s
  bool is_rate = false;
};
constexpr double radians_per_degree = std::numbers::pi / 180.0;  // as `deg` in expressions
constexpr double radians_per_turn = 2.0 * std::numbers::pi;
constexpr std::array angle_units = {
    AngleUnit{"deg", radians_per_degree},
    AngleUnit{"degree", radians_per_degree},
    AngleUnit{"degrees", radians_per_degree},
    AngleUnit{"arc_degree", radians_per_degree},
    AngleUnit{"arcdeg", radians_per_degree},
    AngleUnit{"°", radians_per_degree},
    AngleUnit{"arc_minute", radians_per_degree / 60.0},
    AngleUnit{"arcminute", radians_per_degree / 60.0},
    AngleUnit{"arcmin", radians_per_degree / 60.0},
    AngleUnit{"arc_second", radians_per_degree / 3600.0},
    AngleUnit{"arcsecond", radians_per_degree / 3600.0},
    AngleUnit{"arcsec", radians_per_degree / 3600.0},
    AngleUnit{"rev", radians_per_turn},
    AngleUnit{"revolution", radians_per_turn},
    AngleUnit{"turn", radians_per_turn},
    AngleUnit{"circle", radians_per_turn},
    AngleUnit{"cycle", radians_per_turn},
    AngleUnit{"rpm", radians_per_turn / 60.0, true},
    AngleUnit{"revolutions_per_minute", radians_per_turn / 60.0, true},
    AngleUnit{"rps", radians_per_turn, true},
};

// UDUNITS knows all other quantities by their dimensions.
struct Meaning {
  double factor = 1.0;  // to SI base units and rad
  double zero = 0.0;    // of the scale
  bool is_number = true;
  std::map<std::string, int> powers;  // of base units
};

// The database, read when a model first writes a unit.
class Database {
 public:
  Database() {
    ut_set_error_message_handler(ut_ignore);
    system_ = ut_read_xml(nullptr);
    if (system_ == nullptr)
      throw Error(
          "units cannot be used: the data of UDUNITS-2 are not found; install libudunits2-data, or "
          "write the number in SI units");
    rename("radian");
    rename("rad");
    const Unit rad(ut_new_base_unit(system_));
    ut_map_name_to_unit("radian", UT_UTF8, rad.get());
    ut_map_unit_to_name(rad.get(), "radian", UT_UTF8);
    ut_map_symbol_to_unit("rad", UT_UTF8, rad.get());
    ut_map_unit_to_symbol(rad.get(), "rad", UT_UTF8);
    const Unit second(ut_get_unit_by_name(system_, "second"));
    const Unit rate(ut_divide(rad.get(), second.get()));
    for (const AngleUnit& unit : angle_units) {
      rename(unit.name);
      const Unit scaled(ut_scale(unit.in_rad, unit.is_rate ? rate.get() : rad.get()));
      ut_map_name_to_unit(unit.name, UT_UTF8, scaled.get());
    }
  }
  ~Database() { ut_free_system(system_); }
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  std::optional<Meaning> look_up(const std::string& text) const {
    const Unit unit(ut_parse(system_, text.c_str(), UT_UTF8));
    if (!unit) return std::nullopt;
    static const ut_visitor visitor{&basic, &product, &galilean, &timestamp, &logarithmic};
    Meaning meaning;
    ut_accept_visitor(unit.get(), &visitor, &meaning);
    return meaning;
  }

 private:
  void rename(const char* name) {  // takes the name from its present owner
    ut_unmap_name_to_unit(system_, name, UT_UTF8);
    ut_unmap_symbol_to_unit(system_, name, UT_UTF8);
  }

  static ut_status basic(const ut_unit* unit, void* to) {
    return product(unit, 1, &unit, std::array{1}.data(), to);
  }
  static ut_status product(const ut_unit*, int count, const ut_unit* const* base, const int* powers,
                           void* to) {
    auto& meaning = *static_cast<Meaning*>(to);
    for (int i = 0; i < count; ++i) {
      const char* name = ut_get_name(base[i], UT_UTF8);
      meaning.powers[name != nullptr ? name : "?"] += powers[i];
    }
    std::erase_if(meaning.powers, [](const auto& entry) { return entry.second == 0; });
    return UT_SUCCESS;
  }
  static ut_status galilean(const ut_unit*, double scale, const ut_unit* under, double zero,
                            void* to) {
    static const ut_visitor visitor{&basic, &product, &galilean, &timestamp, &logarithmic};
    auto& meaning = *static_cast<Meaning*>(to);
    const ut_status status = ut_accept_visitor(under, &visitor, to);
    meaning.zero += zero * scale * meaning.factor;
    meaning.factor *= scale;
    return status;
  }
  static ut_status timestamp(const ut_unit*, const ut_unit*, double, void* to) {
    static_cast<Meaning*>(to)->is_number = false;
    return UT_SUCCESS;
  }
  static ut_status logarithmic(const ut_unit*, double, const ut_unit*, void* to) {
    static_cast<Meaning*>(to)->is_number = false;
    return UT_SUCCESS;
  }

  ut_system* system_ = nullptr;
};

// For suggestions.
constexpr std::string_view common[] = {
    "Pa",     "kPa",    "MPa",      "GPa",   "N.m",   "kN.m",       "m",      "mm",   "cm",
    "km",     "um",     "in",       "ft",    "s",     "ms",         "us",     "min",  "h",
    "kg",     "g",      "t",        "lb",    "N",     "kN",         "MN",     "lbf",  "N.m2",
    "N/m",    "rad",    "deg",      "rev",   "rpm",   "rad/s",      "deg/s",  "m/s",  "m/s2",
    "kg.m2",  "kg/m",   "kg.m",     "meter", "metre", "millimeter", "second", "gram", "degree",
    "newton", "radian", "kilogram", "minute"};

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '%' || c == '_' ||
         static_cast<unsigned char>(c) >= 0x80;  // °, µ
}

// Where any quantity will do, a slip of the pen must not become one: 1.5d3 is not cubic days, 2 e no electrons.
void check_usual(std::string_view unit) {
  constexpr std::string_view more[] = {
      "cm2",    "dm",     "nm",      "µm",      "mg",     "kgf",    "kN",         "J",       "kJ",
      "MJ",     "W",      "kW",      "MW",      "mrad",   "°",      "degree",     "degrees", "turn",
      "arcmin", "arcsec", "gravity", "seconds", "meters", "metres", "millimetre", "inch",    "foot",
      "pound",  "hour",   "day",     "days",    "hours",  "minutes"};
  for (std::size_t at = 0; at < unit.size();) {
    const std::size_t end = std::min(unit.find_first_of("./*^-0123456789", at), unit.size());
    const std::string_view word = unit.substr(at, end - at);
    at = end + 1;
    if (word.empty()) continue;
    if (std::find(std::begin(common), std::end(common), word) == std::end(common) &&
        std::find(std::begin(more), std::end(more), word) == std::end(more))
      throw Error("the unit " + in_quotes(unit) +
                  " is not taken here, where any quantity may stand: " + in_quotes(word) +
                  " is none of the usual ones (mm, s, kg, N, Pa, J, W, deg, rev, rpm, … and their "
                  "products); "
                  "write it in those");
  }
}

}  // namespace

double unit_factor(std::string_view unit, std::string_view wanted) {
  if (unit == wanted) return 1.0;
  static std::mutex mutex;  // UDUNITS has one error state for all
  const std::scoped_lock lock(mutex);
  static const Database database;
  const std::optional<Meaning> given = database.look_up(std::string(unit));
  if (!given) {
    const std::string_view near = nearest(unit, common);
    throw Error("there is no unit " + in_quotes(unit) +
                (near.empty() ? "; units" : "; did you mean " + in_quotes(near) + "? Units") +
                " are written like mm, ms, kN, N.m2, kg/m, deg, rpm");
  }
  if (!given->is_number || given->zero != 0.0)
    throw Error("the unit " + in_quotes(unit) +
                " has a zero of its own or is no multiple of an SI unit; convert the number");
  if (wanted == any_unit) check_usual(unit);
  if (wanted == any_unit) return given->factor;
  if (wanted == pure_number)
    throw Error("this is a pure number; leave out the unit " + in_quotes(unit));
  const std::optional<Meaning> si = database.look_up(std::string(wanted));
  if (!si || si->powers != given->powers)
    throw Error("the unit " + in_quotes(unit) + " is of another quantity; give the number in " +
                std::string(wanted) + " or a multiple of it");
  return given->factor / si->factor;
}

bool reads_like_unit(std::string_view word) {
  return !word.empty() && is_letter(word.front()) &&
         std::all_of(word.begin(), word.end(), [](char c) {
           return is_letter(c) || (c >= '0' && c <= '9') || c == '.' || c == '*' || c == '/' ||
                  c == '^' || c == '-';
         });
}

NumberAndUnit split_unit(std::string_view text) {
  text = trimmed(text);
  if (const std::size_t blank = text.find_last_of(" \t\r\n"); blank != std::string_view::npos) {
    const std::string_view word = text.substr(blank + 1), before = trimmed(text.substr(0, blank));
    // After an operator, "mm" would be a parameter.
    constexpr std::string_view goes_on = "+-*/^<>=!&|?:(,";
    if (reads_like_unit(word) && goes_on.find(before.back()) == std::string_view::npos)
      return {before, word};
    return {text, {}};
  }
  double literal = 0.0;
  const char* const end = text.data() + text.size();
  const auto [rest, code] = std::from_chars(text.data(), end, literal);
  if (code == std::errc() && rest != end && reads_like_unit({rest, end}))
    return {{text.data(), rest}, {rest, end}};
  return {text, {}};
}

}  // namespace mbd
