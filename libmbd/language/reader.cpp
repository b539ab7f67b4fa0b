#include "libmbd/language/reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include "libmbd/core/stop.hpp"
#include "libmbd/language/item.hpp"
#include "libmbd/language/read_tree.hpp"
#include "libmbd/material/shaped_sections.hpp"
#include "libmbd/material/solid_shapes.hpp"
#include "libmbd/scene/label.hpp"
#include "libmbd/scene/laws.hpp"
#include "libmbd/scene/reading_limits.hpp"
#include "libmbd/text/spelling.hpp"

namespace mbd {
namespace {

constexpr int most_includes = 1000;

class Reader {
 public:
  Reader(std::string file, const Overrides& overrides) : overrides_(overrides) {
    scene_.file = std::move(file);
  }

  Scene read(const xml::Element& root) {
    check_overrides();
    files_.push_back(identity(scene_.file));
    const ReadingContext context{scene_.file, parameters_, defaults_, units_};
    check_version(root, scene_.file);
    const Item model(root, context);
    root_ = &root;
    scene_.source = model.source();
    scene_.name = model.text("name");
    read_children(model);
    check_unused_overrides();
    check_expects();
    analyse_shapes(scene_);
    read_meshes(scene_);
    return std::move(scene_);
  }

 private:
  using Read = void (Reader::*)(const Item&);

  // Before anything else is looked at: a newer file may hold what this version does not know.
  void check_version(const xml::Element& root, const std::string& file) const {
    std::string_view name;
    for (const xml::Attribute& a : root.attributes)
      if (a.name == "name") name = a.value;
    const std::string who = label(root.name, name);
    for (const xml::Attribute& a : root.attributes) {
      if (root.name != "mbd" || a.name != "version") continue;
      const std::vector<std::string_view> words = schema::words(a.value);
      const bool is_number = words.size() == 1 && words[0].size() < 10 &&
                             words[0].find_first_not_of("0123456789") == std::string_view::npos;
      const int version = is_number ? std::stoi(std::string(words[0])) : 0;
      const Source at{file, a.line};
      if (version < 1)
        throw Error(at, who + ": version=" + in_quotes(excerpt(a.value)) +
                            ": must be a whole number; the newest is " +
                            std::to_string(schema::format_version));
      if (version > schema::format_version)
        throw Error(at, who + ": version=" + in_quotes(a.value) +
                            ": the file is of a newer format than this mbd reads, which is " +
                            std::to_string(schema::format_version) + "; get a newer mbd");
    }
  }

  void check_overrides() const {
    std::set<std::string_view> seen;
    for (const auto& [name, value] : overrides_)
      if (!seen.insert(name).second)
        throw Error("--set " + name + "=" + value + ": set twice; leave one out");
  }

  // Every --set names a parameter of the model or of a file it includes.
  void check_unused_overrides() const {
    std::vector<std::string_view> known;
    for (const auto& parameter : scene_.parameters) known.emplace_back(parameter.first);
    for (const auto& [name, value] : overrides_)
      if (std::find(known.begin(), known.end(), name) == known.end())
        throw Error("--set " + name + "=" + value + ": " + scene_.file + " has no such parameter" +
                    suggest(name, known, "parameters"));
  }

  void read_children(const Item& parent) {
    static const std::map<std::string_view, Read> readers = {
        {"parameter", &Reader::parameter},  //
        {"include", &Reader::include},
        {"defaults", &Reader::defaults},
        {"repeat", &Reader::repeat_children},
    };
    for (const xml::Element& child : parent.xml().children) {
      stop::check();
      const Item item(child, parent);
      if (const auto read = readers.find(child.name); read != readers.end())
        (this->*read->second)(item);
      else
        each_kind(scene_, [&](auto& items) { read_into(items, item); });
    }
  }

  template <class T>
  static void set_once(std::optional<T>& slot, const Item& item, T value) {
    if (slot)
      item.fail("there may be one; another is " +
                (slot->source.file == item.source().file
                     ? "on line " + std::to_string(slot->source.line)
                     : "in " + slot->source.file + ", line " + std::to_string(slot->source.line)));
    slot = std::move(value);
  }

  // --- what the model is made of ---

  static std::string identity(const std::filesystem::path& file) {
    std::error_code code;
    const std::filesystem::path whole = std::filesystem::weakly_canonical(file, code);
    return code ? file.string() : whole.string();
  }

  void include(const Item& item) {
    const std::filesystem::path here(item.context().file);
    const std::filesystem::path file = here.parent_path() / item.text("file");
    const std::string id = identity(file);
    if (const auto first = std::find(files_.begin(), files_.end(), id); first != files_.end()) {
      std::string chain;
      for (auto it = first; it != files_.end(); ++it)
        chain += std::filesystem::path(*it).filename().string() + " includes ";
      item.fail("file", "a circle: " + chain + file.filename().string() +
                            "; put what both need into a third file");
    }
    std::error_code code;
    if (std::filesystem::is_directory(file, code))
      item.fail("file", "is a directory, not a model; give an XML file");
    if (std::filesystem::exists(file, code) && !std::filesystem::is_regular_file(file, code))
      item.fail("file", "is a device or a pipe, not a model; give an XML file");
    if (!std::filesystem::exists(file, code))
      item.fail("file", "no such file: " + excerpt(file.string()) +
                            "; give its name relative to the file that includes it");
    if (++includes_ > most_includes)
      item.fail("more than " + std::to_string(most_includes) +
                " includes in one model; put files together");
    const xml::Element root = xml::parse_file(file);
    const ReadingContext context{file.string(), parameters_, defaults_, units_};
    check_version(root, context.file);
    files_.push_back(id);
    scene_.includes.push_back(file.string());
    read_children(Item(root, context));
    files_.pop_back();
  }

  void defaults(const Item& item) {
    for (const xml::Element& child : item.xml().children) {
      const Item of_kind(child, item);
      of_kind.try_attributes();
      std::vector<DefaultValue>& values = defaults_[child.name];
      for (const xml::Attribute& a : child.attributes) {
        std::erase_if(values, [&a](const DefaultValue& v) { return v.attribute.name == a.name; });
        values.push_back({of_kind.context().file, a});
      }
    }
  }

  void parameter(const Item& item) {
    const std::string name = item.text("name");
    const auto set = std::find_if(overrides_.begin(), overrides_.end(),
                                  [&](const auto& entry) { return entry.first == name; });
    const std::string written = item.text_of("value");
    const std::string own(split_unit(written).unit);
    double value = 0.0;
    if (set == overrides_.end()) {
      value = item.number("value");
    } else {
      // Read as if it stood in the file; messages begin with the option instead of the place.
      const std::string option = "--set " + name + "=" + set->second;
      const xml::Element given{"parameter", 0,  {{"name", name, 0}, {"value", set->second, 0}},
                               {},          {}, 0};
      const ReadingContext context{option, parameters_, defaults_, units_};
      value = Item(given, context, item).number("value");
      check_unit_of_override(option, set->second, name, own);
    }
    const std::string& text = set == overrides_.end() ? written : set->second;
    if (std::string unit = unit_within(text); !unit.empty()) units_.emplace(name, std::move(unit));
    define(item, name, value);
    scene_.parameters.emplace_back(name, value);
  }

  // The unit that follows a number, or that was given to a parameter in it; else empty.
  std::string unit_within(std::string_view text) const {
    const NumberAndUnit parts = split_unit(text);
    if (!parts.unit.empty()) return std::string(parts.unit);
    for (const std::string_view word : Item::words_of(parts.number))
      if (const auto it = units_.find(word); it != units_.end()) return it->second;
    return {};
  }

  // A number that the model gives with a unit is set with one, of the same quantity.
  static void check_unit_of_override(const std::string& option, const std::string& value,
                                     const std::string& name, const std::string& own) {
    if (own.empty()) return;
    const std::string_view unit = split_unit(value).unit;
    if (unit.empty())
      throw Error(option + ": a unit is missing: the model gives " + name + " in " + own +
                  "; write --set " + name + "=\"" + value + " " + own + "\"");
    try {
      unit_factor(unit, own);
    } catch (const Error& error) {
      throw Error(option + ": " + error.what());
    }
  }

  // A name that expressions may use for something else than it means already.
  void check_free(const Item& item, const std::string& name) const {
    if (name.empty() || !schema::is_name(name) || name.find('-') != std::string::npos ||
        (name[0] >= '0' && name[0] <= '9'))
      item.fail("expressions cannot use the name " + in_quotes(name) +
                "; it must have letters, digits and _ only and not begin with a digit");
    if (Expression::is_reserved(name))
      item.fail(in_quotes(name) + " means something else in expressions; choose another name");
    if (parameters_.contains(name))
      item.fail("there is a parameter " + in_quotes(name) + " already; choose another name");
    if (parameters_.inputs.contains(name))
      item.fail("there is an input " + in_quotes(name) + " already; choose another name");
    if (parameters_.functions.contains(name))
      item.fail("there is a function " + in_quotes(name) + " already; choose another name");
  }

  void define(const Item& item, const std::string& name, double value) {
    check_free(item, name);
    parameters_.emplace(name, value);
  }

  // f(item) for what stands in an element, and in any <repeat> there.
  template <class F>
  void each(const Item& parent, const F& f) {
    for (const xml::Element& child : parent.xml().children) {
      stop::check();
      const Item item(child, parent);
      if (item.element().name == "repeat")
        repeat(item, [&] { each(item, f); });
      else
        f(item);
    }
  }

  // --- items: their fields as their lists say, and what is special to some of them ---

  template <class Items>
  void read_into(Items& items, const Item& item) {
    using T = typename Items::value_type;
    if (!stands_for<T>(item.element().name)) return;
    T made = read<T>(item);
    if (!complete(item, made)) return;
    if constexpr (requires { items.push_back(made); })
      items.push_back(std::move(made));
    else
      set_once(items, item, std::move(made));
  }

  template <class T>
  static bool stands_for(std::string_view element) {
    if constexpr (std::is_same_v<T, JointScene>)
      return schema::find_joint_kind(element) != nullptr;
    else if constexpr (std::is_same_v<T, BeamScene>)
      return element == Straight::item.element || element == Arc::item.element ||
             element == Curve::item.element;
    else
      return element == T::item.element;
  }

  template <class T>
  T read(const Item& item) {
    if constexpr (std::is_same_v<T, FunctionScene>)
      if (item.has("value")) check_circle(item);
    return read_fields<T>(item);
  }

  template <class T>
  static T read_fields(const Item& item) {
    T made;
    if constexpr (requires { made.source; }) made.source = item.source();
    T::each_field([&]<class F>(const F& field) {
      if constexpr (requires { field.member; }) read_field(item, made, field);
    });
    return made;
  }

  template <class T, class Value>
  static void read_field(const Item& item, T& made, const field::Field<T, Value>& field) {
    const schema::Attribute& a = field.about.attribute;
    if (a.name.empty() || field.about.has(field::second_place) || !item.has(a.name)) return;
    if constexpr (requires { made.b; })
      if (field.about.has(field::first_place)) {
        std::tie(made.a, made.b) = item.places(a.name);
        return;
      }
    if constexpr (std::is_same_v<Value, std::optional<double>>)
      if (!a.choices.empty() && item.is_word(a.name)) return;
    made.*field.member = value<typename field::Plain<Value>::type>(item, field.about);
  }

  // One of several lines: that of the element's name.
  template <class T, class... Line>
  static void read_field(const Item& item, T& made,
                         const field::Parts<T, std::variant<Line...>>& line) {
    const auto read_line = [&]<class L>() {
      if (item.element().name == L::item.element) made.*line.member = read_fields<L>(item);
    };
    (read_line.template operator()<Line>(), ...);
  }
  template <class T, class Value>
  static void read_field(const Item&, T&, const field::Parts<T, Value>&) {}

  template <class T>
  static T value(const Item& item, const field::About& about) {
    const std::string_view name = about.attribute.name;
    if constexpr (std::is_same_v<T, std::string>) {
      return item.text(name);
    } else if constexpr (std::is_same_v<T, std::vector<std::string>>) {
      return item.names(name);
    } else if constexpr (std::is_same_v<T, Place>) {
      return item.place(name);
    } else if constexpr (std::is_same_v<T, double>) {
      return item.number(name);
    } else if constexpr (std::is_same_v<T, int>) {
      return item.count(name);
    } else if constexpr (std::is_same_v<T, bool>) {
      return item.choice<int>(name) == 1;
    } else if constexpr (std::is_enum_v<T>) {
      return item.choice<T>(name);
    } else if constexpr (std::is_same_v<T, Vec3>) {
      return item.vector(name);
    } else if constexpr (std::is_same_v<T, Mat3>) {
      return about.has(field::rotation) || about.has(field::own_rotation) ? item.orientation(name)
                                                                          : item.symmetric(name);
    } else if constexpr (std::is_same_v<T, Mat6>) {
      return upper_half(item.numbers(name));
    } else if constexpr (std::is_same_v<T, std::array<double, 2>>) {
      const std::vector<double> ends = item.numbers(name);
      return {ends[0], ends[1]};
    } else if constexpr (std::is_same_v<T, Expression>) {
      return item.signal(name);
    } else if constexpr (std::is_same_v<T, LawVector>) {
      return item.signals(name);
    } else if constexpr (std::is_same_v<T, FieldVector>) {
      return item.fields(name);
    } else {
      static_assert(std::is_same_v<T, LawScene>);
      return item.law(name);
    }
  }

  // Of a symmetric matrix: the upper half row by row, or the diagonal.
  static Mat6 upper_half(const std::vector<double>& numbers) {
    Mat6 M = Mat6::Zero();
    std::size_t k = 0;
    for (Index i = 0; i < 6; ++i)
      for (Index j = i; j < (numbers.size() == 6 ? i + 1 : 6); ++j)
        M(i, j) = M(j, i) = numbers[k++];
    return M;
  }

  // What no list of fields says. False: the item is not meant.
  template <class T>
  bool complete(const Item&, T&) {
    return true;
  }

  bool complete(const Item& item, Section& section) {
    bool stiff = false;
    each(item, [&](const Item& part) {
      if (part.element().name == "station")
        section.stations.push_back(station(part));
      else if (part.element().name == "damping")
        set_once(section.damping, part, damping(part));
      else
        matrix(item, part, section, stiff);
    });
    if (section.stations.empty()) {
      if (!stiff && !section.shape)
        item.fail(
            "<stiffness> is missing: give EA, GA2, GA3, GJ, EI2, EI3 or 36 numbers, a shape, or "
            "stations");
      if (item.has("interpolation"))
        item.refuse("interpolation", "is between stations; leave it out or give <station>s");
    } else if (stiff || section.mass || section.shape) {
      item.fail("stiffness and mass must stand in the stations, or there must be no stations" +
                std::string(section.shape ? "; so must its shape" : ""));
    }
    return true;
  }

  bool complete(const Item& item, LayupScene& layup) {
    each(item, [&](const Item& part) { layup.plies.push_back(read<PlyScene>(part)); });
    if (layup.plies.empty()) item.fail("it has no plies; give a <ply> or more");
    return true;
  }

  Station station(const Item& item) {
    Station station = read_fields<Station>(item);
    bool stiff = false;
    each(item, [&](const Item& part) { matrix(item, part, station, stiff); });
    if (!stiff && !station.shape)
      item.fail(
          "<stiffness> is missing: give EA, GA2, GA3, GJ, EI2, EI3 or 36 numbers, or a shape");
    return station;
  }

  SectionShape shape(const Item& item) {
    SectionShape made;
    made.source = item.source();
    const auto kind = std::find(std::begin(SectionShape::kinds), std::end(SectionShape::kinds),
                                item.element().name);
    made.kind = static_cast<SectionShape::Kind>(kind - std::begin(SectionShape::kinds));
    SectionShape::each_field([&](const auto& field) {
      if constexpr (requires { field.is_there; })
        if (field.is_there == nullptr || field.is_there(made)) read_field(item, made, field);
    });
    each(item, [&](const Item& part) {
      if (part.element().name == "points")
        set_once(made.points, part, AirfoilPoints{part.source(), pairs(part)});
      else if (part.element().name == "sector")
        made.sectors.push_back(read<AirfoilSectorScene>(part));
      else if (part.element().name == "web")
        made.webs.push_back(read<AirfoilWebScene>(part));
      else
        made.regions.push_back(read<MeshRegionScene>(part));
    });
    if (SectionShape::is_airfoil(made)) {
      if (!made.points) item.fail("it has no <points>; give those of its outer surface");
      if (made.sectors.empty()) item.fail("it has no <sector>; give one or more, with plies");
    }
    return made;
  }

  static bool is_a_shape(const Item& part) {
    return std::find(std::begin(SectionShape::kinds), std::end(SectionShape::kinds),
                     part.element().name) != std::end(SectionShape::kinds);
  }

  // <stiffness>, <mass> or a shape of a section or station.
  template <class Of>
  void matrix(const Item& item, const Item& part, Of& of, bool& stiff) {
    const bool is_mass = part.element().name == "mass", is_shape = is_a_shape(part);
    const std::string owner(item.element().name);
    if (is_shape ? stiff : !is_mass && of.shape.has_value())
      part.fail("the " + owner + " has both a stiffness and a shape; leave one of them out");
    if (is_shape) {
      if (of.shape) part.fail("the " + owner + " has a shape already; leave one of them out");
      of.shape = shape(part);
      return;
    }
    if (is_mass ? of.mass.has_value() : stiff)
      part.fail("the " + std::string(item.element().name) +
                " has one already; leave one of them out");
    if (is_mass) {
      of.mass = mass(part);
    } else {
      of.stiffness = stiffness(part);
      stiff = true;
    }
  }

  static Mat6 stiffness(const Item& item) {
    Mat6 D = Mat6::Zero();
    const std::vector<std::string_view> words = schema::words(item.xml().text);
    if (words.empty()) {
      constexpr std::array<std::string_view, 6> diagonal = {"EA", "GA2", "GA3", "GJ", "EI2", "EI3"};
      for (int i = 0; i < 6; ++i) {
        const std::string_view name = diagonal[static_cast<std::size_t>(i)];
        D(i, i) =
            item.is_word(name) ? std::numeric_limits<double>::infinity() : item.any_number(name);
        for (int j = i + 1; j < 6; ++j)
          D(i, j) = D(j, i) = item.any_number("D" + std::to_string(i + 1) + std::to_string(j + 1));
      }
      return D;
    }
    if (!item.xml().attributes.empty())
      item.fail("give the 36 numbers or the entries by name, not both");
    if (words.size() != 36)
      item.fail("has " + std::to_string(words.size()) +
                " numbers, must have 36, row by row; an expression contains no blanks");
    for (int k = 0; k < 36; ++k)
      D(k / 6, k % 6) = item.evaluate("text", words[static_cast<std::size_t>(k)]);
    // Round-off of the numbers as printed; more is refused with the section.
    const double round_off = 1e-12 * D.cwiseAbs().maxCoeff();
    for (int i = 0; i < 6; ++i)
      for (int j = i + 1; j < 6; ++j)
        if (std::abs(D(i, j) - D(j, i)) <= round_off) D(j, i) = D(i, j);
    return D;
  }

  static SectionDamping damping(const Item& item) {
    if (std::none_of(item.element().attributes.begin(), item.element().attributes.end(),
                     [&item](const schema::Attribute& a) { return item.has(a.name); }))
      item.fail(
          "give stiffness_proportional, mass_proportional, or viscous entries EA, GA2, GA3, "
          "GJ, EI2, EI3, D12 …; or leave it out");
    SectionDamping damping = read_fields<SectionDamping>(item);
    constexpr std::array<std::string_view, 6> diagonal = {"EA", "GA2", "GA3", "GJ", "EI2", "EI3"};
    for (int i = 0; i < 6; ++i) {
      damping.viscous(i, i) = item.number(diagonal[static_cast<std::size_t>(i)]);
      for (int j = i + 1; j < 6; ++j)
        damping.viscous(i, j) = damping.viscous(j, i) =
            item.any_number("D" + std::to_string(i + 1) + std::to_string(j + 1));
    }
    return damping;
  }

  // M of [v; w] about the reference line: [m I, -m c~; m c~, J], c = (0, x2, x3).
  static Mat6 mass(const Item& item) {
    const double m = item.any_number("per_length");
    const std::vector<double> center = item.numbers("center");
    Mat3 c_tilde;
    c_tilde << 0.0, -center[1], center[0], center[1], 0.0, 0.0, -center[0], 0.0, 0.0;
    Mat6 M = Mat6::Zero();
    M.topLeftCorner<3, 3>() = m * Mat3::Identity();
    M.topRightCorner<3, 3>() = -m * c_tilde;
    M.bottomLeftCorner<3, 3>() = m * c_tilde;
    M.bottomRightCorner<3, 3>() = item.symmetric("inertia");
    return M;
  }

  bool complete(const Item& item, BeamScene& beam) {
    if (beam.kinematics == Kinematics::classical)
      for (const std::string_view of_motion : {"metric", "form"})
        if (item.has(of_motion))
          item.refuse(of_motion,
                      "is of kinematics=\"motion\", not of \"classical\"; leave one of them out");
    if (auto* const curve = std::get_if<Curve>(&beam.line))
      each(item, [&](const Item& part) {
        if (part.element().name == CurvePoint::item.element)
          curve->points.push_back(read_fields<CurvePoint>(part));
        else
          set_once(beam.shape, part, read_fields<ShapeScene>(part));
      });
    else
      each(item,
           [&](const Item& part) { set_once(beam.shape, part, read_fields<ShapeScene>(part)); });
    return true;
  }

  bool complete(const Item& item, InputScene& input) {
    check_free(item, input.name);
    if (!input.unit.empty()) try {
        input.factor = unit_factor(input.unit, any_unit);
      } catch (const Error& error) {
        item.fail("unit", error.what());
      }
    parameters_.inputs.emplace(input.name,
                               NamedInput{static_cast<int>(scene_.inputs.size()), input.factor});
    return true;
  }

  bool complete(const Item& item, ExtensionScene& extension) {
    const std::string text = item.text_of("values");
    for (const std::string_view word : schema::words(text)) {
      const std::size_t equals = word.find('=');
      if (equals == 0 || equals == std::string_view::npos || equals + 1 == word.size())
        item.fail("values",
                  in_quotes(excerpt(word)) + ": write name=expression, without blanks around =");
      const std::string name(word.substr(0, equals));
      for (const auto& [other, value] : extension.values)
        if (other == name)
          item.refuse("values", "hold " + in_quotes(excerpt(name)) + " twice; leave one out");
      extension.values.emplace_back(name, item.evaluate("values", word.substr(equals + 1)));
    }
    return true;
  }

  // --- functions and controllers ---

  bool complete(const Item& item, FunctionScene& function) {
    const bool has_table = !schema::words(item.xml().text).empty();
    if (item.has("value") == has_table)
      item.fail(std::string("give the value, or a table as text") +
                (has_table ? ", not both" : ""));
    if (item.has("value"))
      for (const std::string_view of : {"unit", "interpolation"})
        if (item.has(of)) item.refuse(of, "is of a table; leave it out");
    check_free(item, function.name);
    NamedFunction made{nullptr, std::make_shared<const Parameters>(parameters_), 1.0};
    if (has_table) {
      function.table = table(item);
      if (item.has("unit")) try {
          const double factor = unit_factor(item.text("unit"), any_unit);
          for (auto& [t, value] : function.table->points) value *= factor;
        } catch (const Error& error) {
          item.fail("unit", error.what());
        }
      check_law(*function.table, LawOf::displacement, item.source(),
                label(item.element().name, function.name), "values");
      made.text = std::make_shared<const std::string>(function_text(*function.table));
    } else {
      made.text = std::make_shared<const std::string>(function.value->text());
    }
    parameters_.functions.emplace(function.name, std::move(made));
    return true;
  }

  // The functions that a function calls and that are not there yet: itself, or those after it. What the expression says of an
  // unknown name says less.
  void check_circle(const Item& item) const {
    std::map<std::string_view, std::vector<std::string_view>> calls;
    const auto collect = [&](const auto& self, const xml::Element& parent) -> void {
      for (const xml::Element& child : parent.children) {
        if (child.name == "repeat") self(self, child);
        if (child.name != "function") continue;
        std::string_view name, value;
        for (const xml::Attribute& a : child.attributes) {
          if (a.name == "name") name = a.value;
          if (a.name == "value") value = a.value;
        }
        calls[name] = Item::words_of(value);
      }
    };
    if (root_ != nullptr) collect(collect, *root_);
    const std::string name = item.text_of("name");
    std::vector<std::string_view> chain{name};
    std::set<std::string_view> seen;
    const auto returns = [&](const auto& self, std::string_view from) -> bool {
      const auto it = calls.find(from);
      if (it == calls.end()) return false;
      for (const std::string_view to : it->second) {
        if (to == name) return true;
        if (!calls.contains(to) || !seen.insert(to).second) continue;
        chain.push_back(to);
        if (self(self, to)) return true;
        chain.pop_back();
      }
      return false;
    };
    if (returns(returns, name)) {
      std::string circle;
      for (const std::string_view one : chain) circle += std::string(one) + " calls ";
      item.fail("value", "a circle: " + circle + name + "; what is known must not ask for itself");
    }
    const std::string text = item.text_of("value");  // of which words are parts
    for (const std::string_view word : Item::words_of(text))
      if (calls.contains(word) && !parameters_.functions.contains(word) && word != name)
        item.fail("value",
                  "the function " + in_quotes(word) + " stands after this one; put it before it");
  }

  // What it gives is an input of the laws after it.
  void add_output(const Item& item, const ControllerScene& controller, const std::string& name,
                  double start) {
    check_free(item, name);
    parameters_.inputs.emplace(name, NamedInput{static_cast<int>(scene_.inputs.size()), 1.0});
    InputScene input;
    input.source = item.source();
    input.name = name;
    input.value = start;
    input.controller = controller.name;
    scene_.inputs.push_back(std::move(input));
  }

  // With the states of a controller: all of them, whose names only its expressions know.
  Parameters of_controller(const Item& item) {
    std::set<std::string, std::less<>> own;
    each(item, [&](const Item& part) {
      if (part.element().name != "state") return;
      const std::string name = part.text("name");
      check_free(part, name);
      if (!own.insert(name).second)
        part.fail("the controller has a state " + in_quotes(name) +
                  " already; choose another name");
    });
    Parameters all = parameters_;
    all.own = own;
    return all;
  }

  bool complete(const Item& item, ControllerScene& controller) {
    if (item.xml().children.empty())
      item.fail("it does nothing; give it an <output>, a <pid> or a <state_space>");
    const Parameters with_states = of_controller(item);
    const auto parameters = [&] {  // with the outputs so far
      Parameters all = with_states;
      all.inputs = parameters_.inputs;
      return all;
    };
    each(item, [&](const Item& part) {
      const std::string_view kind = part.element().name;
      if (kind == "state") {
        controller.parts.emplace_back(ControlStateScene{part.source(), part.text("name"),
                                                        part.number("start"),
                                                        part.sampled("next", parameters())});
      } else if (kind == "output") {
        ControlOutputScene output{part.source(), part.text("name"), part.number("start"),
                                  part.sampled("value", parameters())};
        if (with_states.own.contains(output.name))
          part.fail("the controller has a state of that name; choose another");
        add_output(part, controller, output.name, output.start);
        controller.parts.emplace_back(std::move(output));
      } else if (kind == "pid") {
        controller.parts.emplace_back(pid(part, controller, parameters()));
      } else {
        controller.parts.emplace_back(state_space(part, controller, parameters()));
      }
    });
    return true;
  }

  PidScene pid(const Item& part, const ControllerScene& controller, const Parameters& parameters) {
    PidScene pid{part.source(),
                 part.text("name"),
                 part.number("start"),
                 part.sampled("error", parameters),
                 part.number("proportional"),
                 part.number("integral"),
                 part.number("derivative"),
                 part.number("filter"),
                 {}};
    if (part.has("limits")) {
      const std::vector<double> ends = part.numbers("limits");
      if (!(ends[0] < ends[1])) part.refuse("limits", "must rise: the least output, the largest");
      if (pid.start < ends[0] || pid.start > ends[1])
        part.refuse("start", "is the output before the first instant, and lies outside limits");
      pid.limits = {ends[0], ends[1]};
    }
    if (pid.proportional == 0.0 && pid.integral == 0.0 && pid.derivative == 0.0)
      part.fail("it gives nothing; give proportional, integral or derivative");
    add_output(part, controller, pid.name, pid.start);
    return pid;
  }

  StateSpaceScene state_space(const Item& part, const ControllerScene& controller,
                              const Parameters& parameters) {
    StateSpaceScene all;
    all.source = part.source();
    const std::string inputs = part.text("inputs");
    for (const std::string_view text : schema::words(inputs))
      all.inputs.push_back(part.sampled("inputs", text, parameters));
    all.outputs = part.names("outputs");
    const auto numbers = [&](std::string_view name) {
      std::vector<double> values;
      const std::string text = part.text_of(name);
      for (const std::string_view word : schema::words(text))
        values.push_back(part.evaluate(name, word));
      return values;
    };
    all.A = numbers("A");
    const auto states = static_cast<std::size_t>(std::lround(std::sqrt(double(all.A.size()))));
    const std::size_t m = all.inputs.size(), p = all.outputs.size();
    const auto sized = [&](std::string_view name, std::vector<double>& values, std::size_t rows,
                           std::size_t columns, bool may_miss) {
      if (may_miss && !part.has(name)) values.assign(rows * columns, 0.0);
      if (values.size() != rows * columns)
        part.fail(std::string(name) + " has " + std::to_string(values.size()) +
                  " numbers, must have " + std::to_string(rows) + " x " + std::to_string(columns) +
                  ", row by row");
    };
    all.B = numbers("B");
    all.C = numbers("C");
    all.D = numbers("D");
    all.start = numbers("start");
    sized("A", all.A, states, states, false);
    sized("B", all.B, states, m, false);
    sized("C", all.C, p, states, false);
    sized("D", all.D, p, m, true);
    sized("start", all.start, states, 1, true);
    for (const std::string& name : all.outputs) add_output(part, controller, name, 0.0);
    return all;
  }

  bool complete(const Item& item, BodyScene& body) {
    if (body.attached_to)
      for (const std::string_view other : {"at", "orientation", "velocity", "angular_velocity"})
        if (item.has(other))
          item.refuse(other, "is taken from the place of attached_to; leave one of them out");
    bool has_mass = false;
    each(item, [&](const Item& part) {
      body.shapes.push_back(read_fields<ShapeScene>(part));
      if (!body.shapes.back().mesh.empty() && !body.shapes.back().unit)
        body.shapes.back().unit = 1.0;
      has_mass = has_mass || body.shapes.back().density;
    });
    // Its shapes may be all that there is of it; without any, what is left out was forgotten.
    const bool is_scenery =
        body.attached_to && body.attached_to->kind == Place::Kind::ground && !body.shapes.empty();
    if ((has_mass || is_scenery) && !item.has("mass") && !item.has("inertia")) return true;
    for (const std::string_view name : {"mass", "inertia"})
      if (!item.has(name))
        item.fail(schema::missing(*schema::find_attribute(item.element(), name)));
    return true;
  }

  bool complete(const Item& item, JointScene& joint) {
    joint.kind = item.element().name;
    const joint::Parameter& parameter = schema::find_joint_kind(joint.kind)->traits.parameter;
    if (parameter.name[0] != '\0') joint.parameter = item.number(parameter.name);
    return true;
  }

  // Pairs, as text.
  static TableScene table(const Item& item) {
    return {item.source(), pairs(item), item.choice<Interpolation>("interpolation")};
  }

  static std::vector<std::array<double, 2>> pairs(const Item& item) {
    const std::vector<std::string_view> words = schema::words(item.xml().text);
    if (words.size() % 2 != 0)
      item.fail("has " + std::to_string(words.size()) +
                " numbers, must have pairs; an expression contains no blanks");
    std::vector<std::array<double, 2>> all;
    for (std::size_t k = 0; k + 1 < words.size(); k += 2)
      all.push_back({item.evaluate("text", words[k]), item.evaluate("text", words[k + 1])});
    return all;
  }

  // A law by a <table> in place of its attribute.
  static void law(const Item& part, std::optional<LawScene>& slot) {
    if (slot) part.fail("its " + part.text_of("of") + " is given already; leave one of them out");
    slot = table(part);
  }

  bool complete(const Item& item, SpringScene& spring) {
    each(item, [&](const Item& part) {
      const int of = part.choice<int>("of");
      if (of > 1) part.refuse("of", "is a moment of a joint_spring; write force or damping_force");
      law(part, of == 0 ? spring.force : spring.damping_force);
    });
    return true;
  }

  bool complete(const Item& item, BushingScene& bushing) {
    std::array<bool, 2> given{};
    const auto diagonal = [&](std::string_view name, Mat6& M, Index first, bool& is_given) {
      if (!item.has(name)) return;
      M.diagonal().segment<3>(first) = item.vector(name);
      is_given = true;
    };
    diagonal("stiffness", bushing.stiffness, 0, given[0]);
    diagonal("angular_stiffness", bushing.stiffness, 3, given[0]);
    diagonal("damping", bushing.damping, 0, given[1]);
    diagonal("angular_damping", bushing.damping, 3, given[1]);
    each(item, [&](const Item& part) {
      if (part.element().name == "law") {
        bushing.laws.push_back(bushing_law(part));
        return;
      }
      const int of = part.choice<int>("of");
      bool& is_given = given[static_cast<std::size_t>(of)];
      if (is_given)
        part.fail("the bushing's " + part.text_of("of") +
                  " is given already; leave one of them out");
      is_given = true;
      (of == 0 ? bushing.stiffness : bushing.damping) = full_matrix(part);
    });
    return true;
  }

  static Mat6 full_matrix(const Item& item) {
    const std::vector<std::string_view> words = schema::words(item.xml().text);
    if (words.size() != 36)
      item.fail("has " + std::to_string(words.size()) +
                " numbers, must have 36, row by row; an expression contains no blanks");
    Mat6 M;
    for (int k = 0; k < 36; ++k)
      M(k / 6, k % 6) = item.evaluate("text", words[static_cast<std::size_t>(k)]);
    return M;
  }

  static BushingLawScene bushing_law(const Item& item) {
    const int component = item.count("component");
    const std::string_view name = component <= 3 ? "force" : "moment";
    if (const std::string_view other = component <= 3 ? "moment" : "force"; item.has(other))
      item.refuse(other, "belongs to components " +
                             std::string(component <= 3 ? "4 to 6" : "1 to 3") + "; write " +
                             std::string(name));
    const bool has_table = !schema::words(item.xml().text).empty();
    if (item.has(name) == has_table)
      item.fail("give the " + std::string(name) + ", or a table of it as text" +
                (has_table ? ", not both" : ""));
    if (item.has(name) && item.has("interpolation"))
      item.refuse("interpolation", "is of a table; leave it out");
    return {item.source(), component, has_table ? LawScene(table(item)) : LawScene(item.law(name))};
  }

  // Of which coordinate it is, the attributes and tables say.
  bool complete(const Item& item, JointSpringScene& spring) {
    using Coordinate = JointSpringScene::Coordinate;
    constexpr std::array<std::string_view, 4> laws = {"force", "damping_force", "moment",
                                                      "damping_moment"};
    std::string_view first;  // that says which coordinate
    const auto choose = [&](bool turns, std::string_view by, const Item& of) {
      const Coordinate coordinate = turns ? Coordinate::angle : Coordinate::displacement;
      if (!first.empty() && coordinate != spring.coordinate)
        of.fail(std::string(first) + " and " + std::string(by) +
                " are of different coordinates, angle and displacement; give each its own "
                "joint_spring");
      spring.coordinate = coordinate;
      if (first.empty()) first = by;
    };
    const JointSpringScene turning;
    JointSpringScene::each_field([&](const auto& field) {
      const std::string_view name = field.about.attribute.name;
      if (field.is_there != nullptr && item.has(name)) choose(field.is_there(turning), name, item);
    });
    each(item, [&](const Item& part) {
      const int of = part.choice<int>("of");
      choose(of > 1, laws[static_cast<std::size_t>(of)], part);
    });
    each(item, [&](const Item& part) {
      law(part, part.choice<int>("of") % 2 == 0 ? spring.force : spring.damping_force);
    });
    return true;
  }

  bool complete(const Item& item, PathScene& path) {
    each(item, [&](const Item& part) {
      path.marks.push_back(read_fields<PathMarkScene>(part));
      path.marks.back().stops = part.element().name == "stop";
    });
    return true;
  }

  bool complete(const Item& item, TransientScene& transient) {
    transient.output_steps = item.has("output") && item.is_word("output");
    return true;
  }

  bool complete(const Item& item, ExpectScene& expect) {
    const bool timed = expect.of == ExpectScene::Of::value_at;
    if (item.has("at") && !timed)
      item.refuse("at",
                  "is the time of a value; an extreme is taken over the whole run, leave it out");
    if (timed && !item.has("at")) untimed_.push_back(expect.source);
    return !item.has("when") || holds(item);
  }

  // Whether every parameter=value of `when` is so.
  bool holds(const Item& item) const {
    bool all = true;
    for (const std::string& condition : item.names("when")) {
      const std::size_t equals = condition.find('=');
      const auto known = parameters_.find(std::string_view(condition).substr(0, equals));
      if (equals == std::string::npos || known == parameters_.end())
        item.fail("when", in_quotes(condition) +
                              " must be of the form parameter=value, of a parameter of the model");
      const double wanted =
          item.evaluate("when", std::string_view(condition).substr(equals + 1), any_unit);
      constexpr double round_off = 1e-12;  // "9 mm" is not 0.009 to the last bit
      all = all && std::abs(known->second - wanted) <= round_off * std::abs(wanted);
    }
    return all;
  }

  // A value needs its time, unless there is equilibrium only.
  void check_expects() const {
    if (scene_.transient && !untimed_.empty())
      throw Error(untimed_.front(), "expect: attribute \"at\" is missing: time of the value [s]");
  }

  void repeat_children(const Item& item) {
    repeat(item, [&] { read_children(item); });
  }

  template <class Body>
  void repeat(const Item& item, const Body& body) {
    const int count = item.count("count");
    const std::string index = item.name("index");
    // Contents are looked through where they are repeated 0 times, too.
    for (int i = 0; i < std::max(count, 1); ++i) {
      repetitions_ += std::max(std::ssize(item.xml().children), std::ptrdiff_t{1});
      if (repetitions_ > reading_limits().repetitions)
        item.fail("more than " + std::to_string(reading_limits().repetitions) +
                  " elements by repetitions in one model; use fewer or smaller counts");
      if (count == 0) break;
      define(item, index, i);
      body();
      parameters_.erase(index);
    }
  }

  const Overrides& overrides_;
  Scene scene_;
  Parameters parameters_;
  const xml::Element* root_ = nullptr;  // of the file given
  std::map<std::string, std::vector<DefaultValue>, std::less<>> defaults_;
  std::map<std::string, std::string, std::less<>> units_;  // that parameters were given in
  std::vector<std::string> files_;  // being read, each included by the one before
  std::vector<Source> untimed_;     // expected values without a time
  long repetitions_ = 0;
  int includes_ = 0;
};

}  // namespace

Scene read_model(const std::filesystem::path& file, const Overrides& overrides) {
  return Reader(file.string(), overrides).read(xml::parse_file(file));
}

Scene read_model_text(std::string_view text, const std::string& file, const Overrides& overrides) {
  return Reader(file, overrides).read(xml::parse(text, file));
}

Scene read_model_tree(const xml::Element& root, const std::string& file,
                      const Overrides& overrides) {
  return Reader(file, overrides).read(root);
}

}  // namespace mbd
