#include "tests/support/grammar.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <utility>

#include "libmbd/compile/model.hpp"
#include "libmbd/core/error.hpp"
#include "libmbd/language/check_scene.hpp"
#include "libmbd/language/quantities.hpp"
#include "libmbd/language/reader.hpp"
#include "libmbd/run/run.hpp"

namespace mbd::test {
namespace {

using schema::Attribute;
using schema::Element;
using schema::Kind;

// Sizes of what has a unit, so that ten steps move parts by a visible part of their size.
struct Size {
  std::string_view unit;
  double least, most;
};
constexpr Size sizes[] = {
    {"m", 0.02, 0.2},     {"m2", 0.01, 0.1},     {"s", 0.01, 0.1},     {"rad", 0.05, 1.0},
    {"kg", 0.5, 2.0},     {"kg/m", 0.5, 2.0},    {"kg.m", 0.02, 0.04}, {"kg.m2", 0.1, 0.19},
    {"kg/m3", 500, 2000}, {"N", 1.0, 50.0},      {"N.m", 0.5, 10.0},   {"N/m", 20.0, 2000.0},
    {"N.s/m", 0.1, 10.0}, {"N.m.s", 0.01, 1.0},  {"m/s", 0.1, 3.0},    {"rad/s", 0.1, 5.0},
    {"m/s2", 1.0, 10.0},  {"rad/s2", 1.0, 10.0}, {"Pa", 5e6, 1e8},     {"N.m2", 5.0, 50.0},
    {"", 0.05, 1.5},      {"any", 0.1, 2.0}};

Size size_of(std::string_view unit) {
  for (const Size& size : sizes)
    if (size.unit == unit) return size;
  return {unit, 0.1, 1.0};
}

bool one_of_words(std::string_view word, std::string_view words) {
  const auto all = schema::words(words);
  return std::find(all.begin(), all.end(), word) != all.end();
}

}  // namespace

bool Grammar::leaves_out(std::string_view element, std::string_view attribute) {
  if (element == "mbd") return attribute != "name";
  if (element == "transient")  // what the trial sets itself
    return !one_of_words(attribute, "duration step rho_infinity balance inertia linear_solver");
  if (element == "shape") return one_of_words(attribute, "mesh unit");  // another file
  return false;
}

const std::vector<Grammar::Never>& Grammar::never() {
  static const std::vector<Never> all = {
      {"include", "another file"},
      {"region", "a mesh from another file"},
      {"mesh", "the same"},
      {"extension", "needs a plug-in"},
      {"repeat", "makes several of the same: 8d"},
      {"defaults", "the same"},
      {"path", "has no steps in time"},
      {"mark", "of a path"},
      {"stop", "of a path"},
      {"expect", "a number that is known"},
      {"plot", "draws columns"},
      {"static", "what moves freely has no equilibrium"},
  };
  return all;
}

Grammar::Grammar(std::uint64_t seed, std::string_view aim) : random_(seed), aim_(aim) {
  said_ = {"mbd", "mbd@name"};
  choose_steps();
  constexpr std::string_view of_material =
      "material layup ply tube bar rectangle box I C airfoil points sector web record";
  if (chance(aim.empty() ? 0.25 : one_of_words(aim, of_material) ? 1.0 : 0.0)) {
    add_material();
    if (chance(0.6)) try_item("layup");
  }
  add_section();
  if (chance(0.5)) try_item("function");
  if (chance(0.3)) try_item("input");
  for (std::size_t n = 1 + below(aim.empty() ? 4 : 2); n > 0 || parts_.empty(); n -= n > 0 ? 1 : 0)
    add_part();
  if (chance(0.5)) try_item("gravity");
  add_others();
}

void Grammar::choose_steps() {
  const double step = std::exp(uniform(std::log(3e-4), std::log(1e-2)));
  const Element& transient = *schema::find_element("transient");
  const std::string plain =
      fmt::format("<transient duration=\"{0:.17g}*10\" step=\"{0:.17g}\"", step);
  Item none{"", {"transient", "transient@duration", "transient@step"}};
  ending_ = plain;
  for (const Attribute& a : transient.attributes)
    if (!leaves_out("transient", a.name) && !one_of_words(a.name, "duration step") &&
        chance(0.25)) {
      ending_ += fmt::format(" {}=\"{}\"", a.name, value(transient, a));
      none.says.insert(fmt::format("transient@{}", a.name));
    }
  ending_ += "/>";
  if (!accepts(none)) ending_ = plain + "/>";
}

std::string Grammar::text() const {
  std::string all = "<mbd name=\"grammar\">\n";
  for (const Item& item : items_) all += item.text + "\n";
  return all + ending_ + "\n</mbd>\n";
}

double Grammar::uniform(double low, double high) {
  // By hand: the distributions of the standard library differ between libraries.
  return low + (high - low) * static_cast<double>(random_() >> 11) * 0x1p-53;
}

std::string Grammar::vector(double size) {
  double v[3];
  for (double& x : v) x = uniform(-size, size);
  return fmt::format("{:.6g} {:.6g} {:.6g}", v[0], v[1], v[2]);
}

bool Grammar::accepts(const Item& item) {
  items_.push_back(item);
  try {
    Scene scene = read_model_text(text());
    if (scene.bodies.empty() && scene.beams.empty()) {
      BodyScene& probe = scene.bodies.emplace_back();
      probe.name = "probe";
      probe.mass = 1.0;
      probe.inertia = Mat3::Identity();
    }
    check_scene(scene);
    compile(scene);
    said_.insert(item.says.begin(), item.says.end());
    return true;
  } catch (const Error& error) {
    refused_.push_back(item.text + "\n  " + error.what());
    items_.pop_back();
    return false;
  }
}

// ---- parts ---------------------------------------------------------------------------------------

// Isotropic, or with directions, and strengths of some.
void Grammar::add_material() {
  const std::string name = fmt::format("m{}", ++count_);
  Item one{fmt::format("<material name=\"{}\"", name), {"material", "material@name"}};
  const auto say = [&one](std::string_view attribute, double value) {
    one.text += fmt::format(" {}=\"{:.6g}\"", attribute, value);
    one.says.insert(fmt::format("material@{}", attribute));
  };
  say("rho", uniform(500.0, 2000.0));
  if (chance(0.5)) {
    say("E", uniform(1e7, 1e9));
    say("nu", uniform(0.0, 0.45));
    if (chance(0.5)) say("yield", 1e6);
  } else {
    const double ET = uniform(1e7, 1e8);
    say("EL", ET * uniform(1.0, 20.0));
    say("ET", ET);
    say("GLT", ET * uniform(0.3, 1.0));
    say("nuLT", 0.3);
    for (const char* const more : {"EN", "GLN", "GTN"})
      if (chance(0.3)) say(more, ET * uniform(0.3, 1.0));
    for (const char* const more : {"nuLN", "nuTN"})
      if (chance(0.3)) say(more, 0.2);
    if (chance(0.5))
      for (const char* const strength : {"Xt", "Xc", "Yt", "Yc", "SLT", "STN", "Zt", "Zc", "SLN"})
        say(strength, 1e6);
  }
  one.text += "/>";
  if (accepts(one)) materials_.push_back(name);
}

// D and M of a section or a station.
std::string Grammar::stiffness_and_mass(Item& one) {
  const double EA = uniform(1e3, 1e5), EI = uniform(5.0, 100.0);
  one.says.merge(std::set<std::string>{"stiffness", "mass", "mass@per_length", "mass@inertia"});
  const double D[6] = {EA, uniform(0.2, 0.5) * EA, uniform(0.2, 0.5) * EA, uniform(0.3, 1.0) * EI,
                       EI, uniform(0.5, 2.0) * EI};
  std::string inside = "<stiffness";
  const char* const names[] = {"EA", "GA2", "GA3", "GJ", "EI2", "EI3"};
  for (int i = 0; i < 6; ++i) {
    inside += fmt::format(" {}=\"{:.6g}\"", names[i], D[i]);
    one.says.insert(std::string("stiffness@") + names[i]);
  }
  for (int i = 0; i < 6; ++i)
    for (int k = i + 1; k < 6; ++k)
      if (chance(aim_ == "stiffness" ? 0.3 : 0.03)) {
        inside += fmt::format(" D{}{}=\"{:.6g}\"", i + 1, k + 1,
                              uniform(-0.2, 0.2) * std::sqrt(D[i] * D[k]));
        one.says.insert(fmt::format("stiffness@D{}{}", i + 1, k + 1));
      }
  inside += fmt::format("/><mass per_length=\"{:.6g}\" inertia=\"0.02 0.01 {:.6g}\"",
                        uniform(0.5, 2.0), uniform(0.01, 0.02));
  if (chance(0.3)) {
    inside += fmt::format(" center=\"{:.6g} {:.6g}\"", uniform(-0.03, 0.03), uniform(-0.03, 0.03));
    one.says.insert("mass@center");
  }
  return inside + "/>";
}

void Grammar::add_section() {
  for (int attempt = 0; attempt < 8 && sections_.empty(); ++attempt) try_section();
}

void Grammar::try_section() {
  const std::string name = fmt::format("s{}", ++count_);
  Item one;
  one.says = {"section", "section@name"};
  std::string inside, more;
  if (!materials_.empty() && chance(0.8)) {
    const std::vector<std::string_view> shapes = {"tube", "bar", "rectangle", "box",
                                                  "I",    "C",   "airfoil"};
    const bool is_part = one_of_words(aim_, "points sector web");
    const bool is_aim = std::find(shapes.begin(), shapes.end(), aim_) != shapes.end();
    const Item shape = item(*schema::find_element(is_part  ? "airfoil"
                                                  : is_aim ? aim_
                                                           : one_of(shapes)),
                            uniform(0.1, 0.6));
    inside = shape.text;
    one.says.insert(shape.says.begin(), shape.says.end());
  } else if (chance(aim_ == "station" || aim_ == "section" ? 0.8 : 0.2)) {
    one.says.merge(std::set<std::string>{"station", "station@at", "section@interpolation"});
    for (const double at : {0.0, 0.4, 1.0})
      inside += fmt::format("<station at=\"{}\">{}</station>", at, stiffness_and_mass(one));
    more = fmt::format(" interpolation=\"{}\"", chance(0.5) ? "linear" : "smooth");
  } else {
    inside = stiffness_and_mass(one);
  }
  if (chance(0.4)) {
    const Item damping = item(*schema::find_element("damping"), 0.3);
    inside += damping.text;
    one.says.insert(damping.says.begin(), damping.says.end());
  }
  one.text = fmt::format("<section name=\"{}\"{}>{}</section>", name, more, inside);
  if (accepts(one)) sections_.push_back(name);
}

// A place of the part for a joint, and its point.
std::string Grammar::place_of(const Part& part, std::string& point) {
  double at[3];
  std::string place = part.name;
  const double s = part.is_beam && chance(0.5) ? 1.0 : 0.0;
  for (int i = 0; i < 3; ++i)
    at[i] =
        part.is_beam ? part.at[i] + s * (part.to[i] - part.at[i]) : part.at[i] + uniform(-0.3, 0.3);
  if (part.is_beam) place += s > 0.5 ? ".end" : ".start";
  point = fmt::format("{:.17g} {:.17g} {:.17g}", at[0], at[1], at[2]);
  return place;
}

// Puts a value in place of the one that was drawn.
void Grammar::put(Item& item, std::string_view attribute, const std::string& value) {
  const std::string key = fmt::format(" {}=\"", attribute);
  std::size_t begin = item.text.find(key);
  if (begin == std::string::npos) return;
  begin += key.size();
  item.text.replace(begin, item.text.find('"', begin) - begin, value);
}

// A beam, an arc or a curve that begins at part.at; says where it ends.
Grammar::Item Grammar::line_of(Part& part) {
  const auto words = [](const double* x) {
    return fmt::format("{:.17g} {:.17g} {:.17g}", x[0], x[1], x[2]);
  };
  for (int i = 0; i < 3; ++i)
    part.to[i] = part.at[i] + uniform(0.2, 0.8) * (chance(0.5) ? 1.0 : -1.0);
  const std::string kind = aim_ == "arc" || aim_ == "beam"      ? std::string(aim_)
                           : aim_ == "curve" || aim_ == "point" ? "curve"
                           : chance(0.6)                        ? "beam"
                           : chance(0.5)                        ? "arc"
                                                                : "curve";
  Item one = item(*schema::find_element(kind), 0.3);
  put(one, "name", part.name);
  put(one, "from", words(part.at));
  put(one, "to", words(part.to));
  put(one, "normal", "0.3 -0.5 0.1");
  if (kind == "arc") {  // a half of a circle about i3
    const double radius = uniform(0.2, 0.6);
    const double center[] = {part.at[0] + radius, part.at[1], part.at[2]};
    for (int i = 0; i < 3; ++i) part.to[i] = part.at[i] + (i == 0 ? 2.0 * radius : 0.0);
    put(one, "center", words(center));
    put(one, "axis", "0 0 1");
    put(one, "angle", "pi");
    put(one, "normal", "0 0 1");
  } else if (kind == "curve") {
    double middle[3];
    for (int i = 0; i < 3; ++i) middle[i] = 0.5 * (part.at[i] + part.to[i]) + uniform(-0.1, 0.1);
    std::string points;
    for (const double* const at : {part.at, middle, part.to}) {
      Item point = item(*schema::find_element("point"), 0.2);
      put(point, "at", words(at));
      put(point, "normal", "0.3 -0.5 0.2");
      points += point.text;
      one.says.insert(point.says.begin(), point.says.end());
    }
    if (one.text.ends_with("/>"))
      one.text.replace(one.text.size() - 2, 2, ">" + points + "</curve>");
    else
      one.text.insert(one.text.size() - std::string_view("</curve>").size(), points);
  }
  return one;
}

void Grammar::add_part() {
  Part part{fmt::format("p{}", ++count_),
            !sections_.empty() && chance(aim_ == "shape" ? 0.7 : 0.4),
            {},
            {}};
  std::string point = vector(1.0), other = "ground";
  if (!parts_.empty() && chance(0.8)) other = place_of(one_of(parts_), point);
  double at[3];
  std::sscanf(point.c_str(), "%lf %lf %lf", &at[0], &at[1], &at[2]);
  const bool joined = chance(other == "ground" && parts_.empty() ? 0.8 : 0.85);
  // What is not joined stands elsewhere.
  for (int i = 0; i < 3; ++i)
    part.at[i] = at[i] + (joined && part.is_beam ? 0.0 : uniform(-0.3, 0.3) + (joined ? 0.0 : 2.0));
  const std::string start =
      fmt::format("{:.17g} {:.17g} {:.17g}", part.at[0], part.at[1], part.at[2]);
  Item one;
  if (part.is_beam) {
    one = line_of(part);
  } else {
    one.text = fmt::format(
        "<body name=\"{}\" at=\"{}\" mass=\"{}\" inertia=\"{:.6g} {:.6g} {:.6g}\" center=\"{}\"",
        part.name, start, uniform(0.5, 2.0), uniform(0.1, 0.19), uniform(0.1, 0.19),
        uniform(0.1, 0.19), vector(0.2));
    one.says = {"body", "body@name", "body@at", "body@mass", "body@inertia", "body@center"};
    if (chance(0.5)) {
      one.text += fmt::format(" orientation=\"{}\"", vector(1.0));
      one.says.insert("body@orientation");
    }
    if (!joined) {
      one.text += fmt::format(" velocity=\"{}\" angular_velocity=\"{}\"", vector(2.0), vector(3.0));
      one.says.insert("body@velocity");
      one.says.insert("body@angular_velocity");
    }
    one.text += "/>";
  }
  if (!accepts(one)) return;
  parts_.push_back(part);
  for (const char* const end : {".start", ".end", "@0.4"})
    if (part.is_beam) places_.push_back(part.name + end);
  if (!part.is_beam) places_.push_back(part.name);
  if (!joined) return;
  for (int attempt = 0; attempt < 4; ++attempt) {  // joints with two points need their places only
    const schema::JointKind* const aimed = schema::find_joint_kind(aim_);
    const schema::JointKind& kind =
        aimed != nullptr ? *aimed : schema::joint_kinds()[below(schema::joint_kinds().size())];
    Item joint = item(*schema::find_element(kind.name), 0.2);
    put(joint, "between",
        fmt::format("{} {}", other, part.is_beam ? part.name + ".start" : part.name));
    put(joint, "at", point);
    if (joint.text.find(" at=\"") == std::string::npos &&
        kind.traits.points != joint::Points::two) {
      joint.text.insert(joint.text.find(' '), fmt::format(" at=\"{}\"", point));
      joint.says.insert(fmt::format("{}@at", kind.name));
    }
    put(joint, "second_axis", "0 0 1");
    if (kind.traits.second_axis) put(joint, "axis", "1 1 0");
    const std::string name = new_names_.front();
    if (accepts(joint)) {
      joints_.push_back(name);
      return;
    }
  }
}

namespace {

// Whether an item of the kind is, may hold, or is needed by one of the kind that is aimed at.
bool serves(const Element& element, std::string_view aim) {
  if (element.name == aim) return true;
  const std::vector<std::string_view> inside = schema::children(element.name);
  return std::find(inside.begin(), inside.end(), aim) != inside.end() ||
         (aim == "record" && one_of_words(element.name, "spring bushing joint_spring"));
}

}  // namespace

void Grammar::add_others() {
  for (const Element& element : schema::elements()) {
    const auto in = schema::words(element.parents);
    const bool top = std::find(in.begin(), in.end(), "mbd") != in.end();
    const bool is_never = std::any_of(never().begin(), never().end(),
                                      [&](const Never& n) { return n.element == element.name; });
    const std::vector<std::string_view> made = {"material", "layup",     "section",  "beam", "arc",
                                                "curve",    "transient", "function", "input"};
    if (!aim_.empty() && !serves(element, aim_)) continue;
    if (!top || is_never || std::find(made.begin(), made.end(), element.name) != made.end() ||
        schema::find_joint_kind(element.name) != nullptr)
      continue;
    if (!aim_.empty())
      for (int i = 0; i < 3; ++i) try_item(std::string(element.name));
    const double often = !aim_.empty()                                         ? 0.0
                         : element.name == "record"                            ? 0.7
                         : element.name == "motion" || element.name == "drive" ? 0.2
                                                                               : 0.35;
    while (chance(often) && items_.size() < 30) try_item(std::string(element.name));
  }
}

// An item of that kind, if the scene takes one within some attempts.
void Grammar::try_item(const std::string& element) {
  for (int attempt = 0; attempt < 6; ++attempt) {
    Item one = item(*schema::find_element(element), uniform(0.1, 0.6));
    if (element == "record" && !materials_.empty() && !places_.empty() && chance(0.5)) {
      one.text = fmt::format(
          "<record name=\"{}\" at=\"{}\" section_point=\"{:.4g} {:.4g}\" "
          "quantities=\"ply_stress\"/>",
          new_names_.front(), one_of(places_), uniform(-0.1, 0.1), uniform(-0.1, 0.1));
      one.says = {"record", "record@name", "record@at", "record@section_point",
                  "record@quantities"};
    }
    put(one, "second_axis", "0 0 1");
    if (one.text.find(" second_axis=") != std::string::npos) put(one, "axis", "1 1 0");
    const std::vector<std::string> names = new_names_;
    if (!accepts(one)) continue;
    if (names.empty()) return;
    if (element == "material") materials_.push_back(names.front());
    if (element == "layup") layups_.push_back(names.front());
    if (element == "function") functions_.push_back(names.front());
    if (element == "input") inputs_.push_back(names.front());
    if (element == "controller")
      inputs_.insert(inputs_.end(), inner_names_.begin(), inner_names_.end());
    if (element == "spring" || element == "bushing" || element == "joint_spring")
      springs_.push_back(names.front());
    if (element == "body") places_.push_back(names.front());
    return;
  }
}

// ---- one item ------------------------------------------------------------------------------------

Grammar::Item Grammar::item(const Element& element, double share) {
  const std::string kind(element.name);
  Item one{"<" + kind, {kind}};
  // Of what acts along a beam or at a place: one of them, with what it needs.
  const bool either = schema::find_attribute(element, "beam") != nullptr &&
                      schema::find_attribute(element, "at") != nullptr;
  const bool along = chance(0.5);
  const bool is_attached = chance(0.5);  // a body
  const std::vector<std::string_view> forms = {"box", "cylinder", "sphere", "rectangle", "ellipse"};
  const std::string_view form = one_of(forms);            // a shape
  const bool of_plies = !layups_.empty() && chance(0.5);  // walls of a section
  law_is_table_ = chance(0.4);
  const bool is_moment = chance(0.5);  // a law
  if (kind == "state_space") share = chance(0.5) ? 1.0 : 0.0;
  if (kind == "shape") share = 0.5;
  new_names_.clear();
  if (kind == "controller") inner_names_.clear();
  for (const Attribute& a : element.attributes) {
    if (leaves_out(kind, a.name)) continue;
    const bool of_beam = a.name == "beam" || a.doc.starts_with("of a beam"),
               of_place = a.name == "at" || a.doc.starts_with("at a place");
    if (either && (along ? of_place : of_beam)) continue;
    if (kind == "body" &&
        one_of_words(a.name,
                     is_attached ? "at orientation velocity angular_velocity" : "attached_to"))
      continue;
    if (schema::find_attribute(element, "tolerance") != nullptr && kind != "static" &&
        one_of_words(a.name, of_plies ? "material thickness angle flange_thickness web_thickness"
                                      : "layup flange web"))
      continue;
    if (kind == "modes" && one_of_words(a.name, is_attached ? "at" : "rate axis through at_rest"))
      continue;
    if (kind == "law" && one_of_words(a.name, law_is_table_ ? "force moment"
                                              : is_moment   ? "force interpolation"
                                                            : "moment interpolation"))
      continue;
    const bool is_outline = form == "rectangle" || form == "ellipse";  // of a beam
    if (kind == "shape" && one_of_words(a.name, is_outline ? "at orientation density" : "to"))
      continue;
    if (kind == "shape" && a.name != form &&
        std::find(forms.begin(), forms.end(), a.name) != forms.end())
      continue;
    const bool needed =
        a.fallback == schema::required ||
        (kind == "law" && (a.name == "force" || a.name == "moment")) ||
        (kind == "shape" && a.name == form) || (kind == "modes" && a.name == "rate") ||
        // Sections are analysed anew for each item that is tried: coarse ones are enough.
        (a.name == "tolerance" && one_of_words(kind, "tube bar rectangle box I C airfoil")) ||
        (kind == "body" && one_of_words(a.name, "attached_to mass inertia")) ||
        (either && (a.name == "beam" || a.name == "at" ||
                    a.doc.find("which needs it") != std::string_view::npos));
    if (!needed && !chance(share)) continue;
    std::string text = value(element, a);
    if (kind == "law" && a.name == "component")
      text = std::to_string((is_moment ? 4 : 1) + below(3));
    if (text.empty()) continue;
    one.text += fmt::format(" {}=\"{}\"", a.name, text);
    one.says.insert(fmt::format("{}@{}", kind, a.name));
  }
  const std::vector<std::string> names = new_names_;
  const std::string inside = content(element, one, share);
  new_names_ = names;
  one.text += inside.empty() ? "/>" : fmt::format(">{}</{}>", inside, kind);
  return one;
}

// What an airfoil has: two sectors between places on an oval, by fractions or by points, and a web in most.
std::string Grammar::along_a_curve(Item& one) {
  one.says.merge(std::set<std::string>{"points", "sector"});
  const auto wall = [&](std::string_view kind, bool may_be_bare) {
    const auto say = [&](std::string_view attribute) {
      one.says.insert(fmt::format("{}@{}", kind, attribute));
    };
    if (may_be_bare && chance(0.3)) {
      say("bare");
      return std::string("bare=\"on\"");
    }
    if (!layups_.empty() && chance(0.5)) {
      say("layup");
      return fmt::format("layup=\"{}\"", one_of(layups_));
    }
    say("material");
    say("thickness");
    std::string text = fmt::format("material=\"{}\" thickness=\"{:.3g} mm\"", one_of(materials_),
                                   uniform(0.5, 5.0));
    if (chance(0.5)) {
      say("angle");
      text += fmt::format(" angle=\"{:.3g}\"", uniform(-1.5, 1.5));
    }
    return text;
  };
  const auto place = [&](std::string_view kind, std::string_view end, int point) {
    const bool by_point = chance(0.5);
    one.says.insert(fmt::format("{}@{}{}", kind, end, by_point ? "_point" : ""));
    return by_point ? fmt::format(" {}_point=\"{}\"", end, point)
                    : fmt::format(" {}=\"{:.6g}\"", end, (point - 1) / 8.0);
  };
  std::string inside = "<points>";
  for (int i = 0; i < 8; ++i)
    inside += fmt::format(" {:.12g} {:.12g}", std::cos(0.25 * std::numbers::pi * i),
                          0.6 * std::sin(0.25 * std::numbers::pi * i));
  inside += "</points>";
  // By the eighth points and fractions of an oval are alike at its axes only.
  inside += fmt::format("<sector{}{} {}/>", place("sector", "from", 3), place("sector", "to", 7),
                        wall("sector", false));
  inside += fmt::format("<sector{}{} {}/>", place("sector", "from", 7), place("sector", "to", 3),
                        wall("sector", true));
  if (chance(0.7)) {
    one.says.insert("web");
    inside += fmt::format("<web{}{} {}/>", place("web", "from", 3), place("web", "to", 7),
                          wall("web", false));
  }
  return inside;
}

std::string Grammar::content(const Element& element, Item& one, double share) {
  std::string inside;
  if (element.content == "pairs of numbers" &&
      (element.name == "law" ? law_is_table_ : element.name == "table" || chance(0.4))) {
    double x = -2.0;
    for (int i = 0; i < 5; ++i, x += uniform(0.5, 1.5))
      inside += fmt::format("{:.6g} {:.6g}  ", x,
                            element.name == "function" ? uniform(-1.0, 1.0) : 20.0 * x);
    return inside;
  }
  if (element.name == "airfoil") return along_a_curve(one);
  if (element.name == "matrix") {
    for (int i = 0; i < 36; ++i)
      inside += fmt::format("{:.6g} ", i % 7 == 0         ? uniform(100.0, 300.0)
                                       : i == 1 || i == 6 ? 20.0
                                                          : 0.0);
    return inside;
  }
  for (const std::string_view name : schema::children(element.name)) {
    const bool needed = (element.name == "layup" && name == "ply") ||
                        (element.name == "controller" && name == "output");
    if (name == "repeat" || name == "point" ||
        (!needed && !chance(name == aim_ ? 0.9 : 0.5 * share)))
      continue;
    const Item part = item(*schema::find_element(name), share);
    if (element.name == "controller" && name != "state")
      inner_names_.insert(inner_names_.end(), new_names_.begin(), new_names_.end());
    inside += part.text;
    one.says.insert(part.says.begin(), part.says.end());
  }
  return inside;
}

std::string Grammar::number(const Attribute& a) {
  Size size = size_of(a.unit);
  if (a.name.find("thickness") != std::string_view::npos) size = {"m", 0.003, 0.015};
  if (a.name == "tolerance") size = {"", 5e-3, 3e-2};
  if (a.name == "section_point") size = {"m", 0.01, 0.1};
  double x = std::exp(uniform(std::log(size.least), std::log(size.most)));
  if (a.kind == Kind::count) x = static_cast<double>(1 + below(3));
  const bool sign = a.range.min < 0.0 && a.kind != Kind::count;
  if (sign && chance(0.5)) x = -x;
  if (std::isfinite(a.range.max) && x > a.range.max)
    x = a.range.min + (a.range.max - a.range.min) * uniform(0.0, 1.0);
  if (x < a.range.min) x = a.range.min;
  if (a.kind == Kind::count) return fmt::format("{:.0f}", x);
  // Some in another unit.
  if (a.kind == Kind::numbers) return fmt::format("{:.6g}", x);
  if (a.unit == "m" && chance(0.1)) return fmt::format("{:.6g} mm", 1e3 * x);
  if (a.unit == "rad" && chance(0.1)) return fmt::format("{:.6g} deg", 57.29577951308232 * x);
  return fmt::format("{:.6g}", x);
}

std::string Grammar::law_of_time(double size) {
  const double a = uniform(-size, size);
  switch (below(functions_.empty() && inputs_.empty() ? 5 : 7)) {
    case 0:
      return fmt::format("{:.6g}", a);
    case 1:
      return fmt::format("{:.6g}*sin({:.6g}*t)", a, uniform(1.0, 30.0));
    case 2:
      return fmt::format("{:.6g}*t", 10.0 * a);
    case 3:
      return fmt::format("{:.6g}*(1-exp(-{:.6g}*t))", a, uniform(5.0, 50.0));
    case 4:
      return fmt::format("{:.6g}*t^2/(0.1+t)", 10.0 * a);
    case 5:
      return functions_.empty() ? fmt::format("{:.6g}*{}", a, one_of(inputs_))
                                : fmt::format("{:.6g}*{}(t)", a, one_of(functions_));
    default:
      return inputs_.empty() ? fmt::format("{:.6g}*{}(2*t)", a, one_of(functions_))
                             : fmt::format("{:.6g}*{}", a, one_of(inputs_));
  }
}

std::string Grammar::quantities() {
  std::vector<std::string_view> all;
  switch (below(4)) {
    case 0:
      all = schema::names(schema::place_quantities());
      break;
    case 1:
      all = schema::names(schema::joint_quantities());
      break;
    case 2:
      all = schema::names(schema::spring_quantities());
      break;
    default:
      all = schema::names(schema::system_quantities());
  }
  std::string some;
  for (std::size_t n = 1 + below(3); n > 0; --n) {
    const std::string word(one_of(all));
    if (some.find(word) == std::string::npos) some += (some.empty() ? "" : " ") + word;
  }
  return some;
}

// Empty if there is none.
std::string Grammar::a_beam() {
  std::vector<std::string> beams;
  for (const Part& part : parts_)
    if (part.is_beam) beams.push_back(part.name);
  return beams.empty() ? std::string() : one_of(beams);
}

std::string Grammar::text_value(std::string_view element, std::string_view attribute) {
  const auto from = [this](const std::vector<std::string>& names) {
    return names.empty() ? std::string() : one_of(names);
  };
  if (attribute == "section") return from(sections_);
  if (attribute == "material") return from(materials_);
  if (attribute == "layup" || attribute == "flange" || attribute == "web") return from(layups_);
  if (attribute == "beam") return a_beam();
  if (attribute == "joint") return from(joints_);
  if (attribute == "spring") return from(springs_);
  if (attribute == "colour") return "teal";
  if (attribute == "unit") return "mm";
  if (attribute == "name") return new_names_.emplace_back(fmt::format("n{}", ++count_));
  if (element == "state_space") {
    if (attribute == "inputs") return "sin(t)";
    if (attribute == "A") return "0.5";
    if (attribute == "B" || attribute == "C" || attribute == "D" || attribute == "start")
      return "0.3";
  }
  return {};
}

// Kind::names.
std::string Grammar::word_values(std::string_view element, std::string_view attribute) {
  if (attribute == "quantities") return quantities();
  if (element == "reduction") return reduced_ = a_beam();
  if (element == "modes") return parts_.empty() ? std::string() : one_of(parts_).name;
  if (element == "rigid")
    return parts_.size() < 2 ? std::string() : one_of(parts_).name + " " + one_of(parts_).name;
  if (attribute == "outputs") return new_names_.emplace_back(fmt::format("n{}", ++count_));
  return {};
}

std::string Grammar::value(const Element& element, const Attribute& a) {
  const Size size = size_of(a.unit);
  if (element.name == "reduction" && a.name == "modes") return std::to_string(below(5));
  if (element.name == "modes" && a.name == "at") return "0";
  if (element.name == "reduction" && a.name == "frame")
    return reduced_.empty() ? std::string() : reduced_ + (chance(0.5) ? ".start" : "@0.5");
  switch (a.kind) {
    case Kind::name:
      return new_names_.emplace_back(fmt::format("n{}", ++count_));
    case Kind::text:
      return text_value(element.name, a.name);
    case Kind::place:
      return places_.empty() ? std::string() : one_of(places_);
    case Kind::places:
      if (places_.empty()) return {};
      return (chance(0.4) ? "ground" : one_of(places_)) + " " + one_of(places_);
    case Kind::names:
      return word_values(element.name, a.name);
    case Kind::number:
    case Kind::count:
      return number(a);
    case Kind::numbers: {
      std::string all;
      const int n = a.sizes[below(2)];
      for (int i = 0; i < n; ++i) all += (i > 0 ? " " : "") + number(a);
      return all;
    }
    case Kind::signal:
    case Kind::signals:
      if (element.name == "motion" || element.name == "drive") {  // from rest
        std::string all;
        for (int i = 0; i < (a.kind == Kind::signal ? 1 : 3); ++i)
          all +=
              fmt::format("{}{:.6g}*t^2/(0.1+t)", i > 0 ? " " : "", uniform(-size.most, size.most));
        return all;
      }
      if (a.kind == Kind::signal) return law_of_time(size.most);
      return law_of_time(size.most) + " " + law_of_time(size.most) + " " +
             law_of_time(0.5 * size.most);
    case Kind::fields:
      return law_of_time(size.most) + " " +
             fmt::format("{:.6g}*s*(1-s)", uniform(-size.most, size.most)) + " 0";
    case Kind::law:
      return fmt::format("{:.6g}*x{}", uniform(10.0, 500.0), chance(0.5) ? "+100*x^3" : "");
    case Kind::rate_law:
      return fmt::format("{:.6g}*v{}", uniform(0.1, 5.0), chance(0.5) ? "+0.5*v*abs(v)" : "");
    case Kind::choice: {
      const auto words = schema::words(a.choices);
      return words.empty() ? std::string() : std::string(one_of(words));
    }
  }
  return {};
}

// ---- the trial -----------------------------------------------------------------------------------

namespace {

// Poses of all nodes at the rows.
class Poses : public Observer {
 public:
  void accepted(const Sample& sample) override {
    for (const double x : sample.row)
      if (!std::isfinite(x)) throw std::runtime_error("a row has a number that is not finite");
    length = sample.model.system->length_scale();
    times.push_back(sample.state.t);
    rows.push_back(sample.state.pose);
  }
  std::vector<double> times;
  std::vector<std::vector<Pose<double>>> rows;
  double length = 1.0;
};

double turn(const Pose<double>& a, const Pose<double>& b) {
  const auto q = a.p.conjugate() * b.p;
  return 2.0 * std::atan2(q.vec().norm(), std::abs(q.w()));
}

// (2) of libmbd/results/time_error.hpp, of the poses themselves.
double difference(const Poses& a, const Poses& b) {
  double farthest = 0.0, turned = 0.0, worst = 0.0;
  for (const auto& row : a.rows)
    for (std::size_t n = 1; n < row.size(); ++n) {
      farthest = std::max(farthest, (row[n].r - a.rows[0][n].r).norm());
      turned = std::max(turned, turn(row[n], a.rows[0][n]));
    }
  const double length = std::max(a.length, farthest);
  const double motion = std::min(1.0, std::max(farthest / length, turned));
  if (motion < 1e-9) return 0.0;  // round-off
  for (std::size_t k = 0; k < std::min(a.rows.size(), b.rows.size()); ++k)
    for (std::size_t n = 1; n < a.rows[k].size(); ++n)
      worst = std::max({worst, (a.rows[k][n].r - b.rows[k][n].r).norm() / length / motion,
                        turn(a.rows[k][n], b.rows[k][n]) / motion});
  return worst;
}

}  // namespace

GrammarTrial try_two_integrators(const std::string& text) {
  GrammarTrial trial;
  const Scene scene = read_model_text(text);
  Poses alpha, radau;
  try {
    const RunReport report = run(scene, {.observers = {&alpha}});
    trial.failure = report.failure;
    if (!report.complete() && report.kind == Failure::none)
      throw std::runtime_error("a failure of no kind");
    trial.passed = report.complete() && report.certificate.verdict() == Verdict::pass;
    trial.estimated = report.time_error && report.time_error->known;
    if (trial.estimated) trial.claimed = report.time_error->relative;
  } catch (const Error& error) {
    trial.refusal = error.what();
    if (trial.refusal.empty()) throw std::runtime_error("an Error that says nothing");
    return trial;
  }
  Scene other = scene;
  const double step = scene.transient->step.value();
  TransientScene& transient = *other.transient;
  const InertiaTerms inertia = transient.inertia;
  transient = TransientScene();
  transient.source = scene.transient->source;
  transient.duration = scene.transient->duration;
  transient.method = TimeMethod::radau;
  transient.tolerance = 1e-8;
  transient.errors = ErrorsOf::motion;
  transient.output = step;
  transient.inertia = inertia;
  try {
    const RunReport report = run(other, {.observers = {&radau}, .estimate_error = false});
    trial.reference = report.failure;
  } catch (const Error& error) {
    trial.reference = error.what();
  }
  trial.error = difference(alpha, radau);
  return trial;
}

std::string GrammarTrial::fault() const {
  // What the check "error in time" fails from on; and how far estimates of the first order may be off.
  constexpr double far_off = 0.1, most_beyond = 30.0, small = 1e-4;
  if (passed && error > far_off)
    return fmt::format("its certificate passes, and the motion is {:.2g} off", error);
  if (passed && estimated && error > small && error > most_beyond * claimed)
    return fmt::format("its certificate passes with an error of {:.2g}, which is {:.2g}", claimed,
                       error);
  return {};
}

}  // namespace mbd::test
