#include "libmbd/study/effects/ablation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>

#include "libmbd/compile/model.hpp"
#include "libmbd/language/quantities.hpp"
#include "libmbd/language/schema.hpp"
#include "libmbd/results/history.hpp"
#include "libmbd/scene/label.hpp"
#include "libmbd/scene/places.hpp"
#include "libmbd/scene/reference_line.hpp"
#include "libmbd/scene/section_table.hpp"
#include "libmbd/study/effects/straightened.hpp"
#include "libmbd/text/spelling.hpp"

namespace mbd::ablation_list {
namespace {

using schema::shortest;

struct Effect {
  Ablation ablation;
  std::function<void(Scene&)> leave_out;
};

std::string left_out(std::string_view element, const std::string& name) {
  return name.empty() ? fmt::format("(without <{}>)", element)
                      : fmt::format("(without <{} name=\"{}\" …>)", element, name);
}

// Items without a name are known by their number.
template <class T>
void name_all(std::vector<T>& items, std::string_view kind) {
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (!items[i].name.empty()) continue;
    std::string name = fmt::format("{}{}", kind, i + 1);
    while (std::any_of(items.begin(), items.end(), [&](const T& x) { return x.name == name; }))
      name += "_";
    items[i].name = std::move(name);
  }
}

template <class T>
void erase_named(std::vector<T>& items, const std::string& name) {
  std::erase_if(items, [&](const T& x) { return x.name == name; });
}

bool is_used(const Scene& scene, const Section& section) {
  return std::any_of(scene.beams.begin(), scene.beams.end(), [&](const BeamScene& b) {
    return b.section == section.name && rigid_with(scene, b.name) == nullptr;
  });
}

void each_stiffness(Section& section, const std::function<void(Mat6&)>& change) {
  change(section.stiffness);
  for (Station& station : section.stations) change(station.stiffness);
}

void each_mass(Section& section, const std::function<void(Mat6&)>& change) {
  if (section.mass) change(*section.mass);
  for (Station& station : section.stations)
    if (station.mass) change(*station.mass);
}

// Whether strains of the section may be held at zero: what its beams are knows no such rows otherwise.
bool may_hold(const Scene& scene, const Section& section) {
  return std::all_of(scene.beams.begin(), scene.beams.end(), [&](const BeamScene& beam) {
    return beam.section != section.name || rigid_with(scene, beam.name) != nullptr ||
           (beam.kinematics == Kinematics::motion && beam.form == Form::energy &&
            beam.rule == Rule::gauss && reduction_with(scene, beam.name) == nullptr);
  });
}

const Mat6& first_stiffness(const Section& section) {
  return section.stations.empty() ? section.stiffness : section.stations.front().stiffness;
}

using StiffnessRows = std::vector<Index>;

bool is_infinite(const Section& section, const StiffnessRows& rows) {
  const std::array<bool, 6> held = infinite_stiffnesses(section);
  return std::all_of(rows.begin(), rows.end(),
                     [&](Index i) { return held[static_cast<std::size_t>(i)]; });
}

// Of all sections: infinite, without couplings, where that may be. Elsewhere rows and columns by the root of a factor:
// couplings grow less, and D stays positive definite.
void stiffen(Scene& scene, const StiffnessRows& rows) {
  const double root = std::sqrt(reduction);
  for (Section& section : scene.sections) {
    const bool holds = may_hold(scene, section);
    each_stiffness(section, [&](Mat6& D) {
      for (const Index i : rows) {
        if (!std::isfinite(D(i, i))) continue;
        if (holds) {
          D.row(i).setZero();
          D.col(i).setZero();
          D(i, i) = std::numeric_limits<double>::infinity();
        } else {
          D.row(i) *= root;
          D.col(i) *= root;
        }
      }
    });
  }
}

// About the mass centre; that of the centre about the reference line stays.
void lower_rotary_inertia(Mat6& M) {
  const double m = M(0, 0);
  if (!(m > 0.0)) return;
  const Mat3 S = M.bottomLeftCorner<3, 3>();  // m c~
  const Mat3 of_centre = -S * S / m;
  M.bottomRightCorner<3, 3>() = of_centre + (M.bottomRightCorner<3, 3>() - of_centre) / reduction;
}

std::string changed_stiffness(const Scene& scene, const StiffnessRows& rows) {
  constexpr std::array<std::string_view, 3> names = {"EA", "GA2", "GA3"};
  std::string text;
  for (const Section& section : scene.sections) {
    if (!is_used(scene, section) || is_infinite(section, rows)) continue;
    const bool holds = may_hold(scene, section), varies = !section.stations.empty();
    text += fmt::format("<section name=\"{}\">{} <stiffness", section.name,
                        varies ? " each station:" : "");
    bool is_coupled = false;
    for (const Index i : rows) {
      const std::string_view name = names[static_cast<std::size_t>(i)];
      text += holds ? fmt::format(" {}=\"inf\"", name)
              : varies
                  ? fmt::format(" {} times {}", name, shortest(reduction))
                  : fmt::format(" {}=\"{}\"", name, shortest(reduction * section.stiffness(i, i)));
      for (Index k = 0; k < 6; ++k) is_coupled |= k != i && first_stiffness(section)(i, k) != 0.0;
    }
    text += holds && is_coupled ? " …/> without their couplings\n" : " …/>\n";
  }
  return text;
}

class Effects {
 public:
  explicit Effects(const Scene& scene) : scene_(scene) {
    flexibility();
    sections();
    inertia();
    axial_waves();
    damping();
    forces();
    curvature();
  }

  const std::vector<Effect>& all() const { return all_; }

 private:
  void add(std::string key, std::string effect, std::string change,
           std::function<void(Scene&)> leave_out) {
    while (change.ends_with('\n')) change.pop_back();
    all_.push_back({{std::move(key), std::move(effect), std::move(change)}, std::move(leave_out)});
  }

  template <class T>
  void add_each(const std::vector<T>& items) {
    const std::string_view element = T::item.element;
    for (const T& item : items)
      add(fmt::format("{}:{}", element, item.name), label(item), left_out(element, item.name),
          [name = item.name](Scene& s) {
            each_kind(s, [&name](auto& all) {
              if constexpr (std::is_same_v<decltype(all), std::vector<T>&>) erase_named(all, name);
            });
          });
  }

  void flexibility() {
    for (const BeamScene& beam : scene_.beams) {
      if (rigid_with(scene_, beam.name) != nullptr) continue;
      const std::string name = free_name(scene_, beam.name + "_rigid");
      add("rigid:" + beam.name, "flexibility of " + label(beam),
          fmt::format("<rigid name=\"{}\" of=\"{}\"/>", name, beam.name),
          [name, of = beam.name](Scene& s) {
            s.rigids.push_back({{}, name, {of}});
          });
    }
  }

  void sections() {
    const bool any = std::any_of(scene_.sections.begin(), scene_.sections.end(),
                                 [this](const Section& s) { return is_used(scene_, s); });
    if (!any) return;
    stiffnesses("axial", "axial flexibility", {0});
    stiffnesses("shear", "shear flexibility", {1, 2});
    for (const Section& section : scene_.sections) couplings(section);
  }

  // How much of a flexibility is left out is said in its name.
  void stiffnesses(const std::string& key, const std::string& of, const StiffnessRows& rows) {
    bool any = false, all_held = true;
    for (const Section& section : scene_.sections) {
      if (!is_used(scene_, section) || is_infinite(section, rows)) continue;
      any = true;
      all_held = all_held && may_hold(scene_, section);
    }
    if (any)
      add(key, all_held ? of : fmt::format("{} (stiffened {} times)", of, shortest(reduction)),
          changed_stiffness(scene_, rows), [rows](Scene& s) { stiffen(s, rows); });
  }

  void couplings(const Section& section) {
    if (!is_used(scene_, section)) return;
    for (Index i = 0; i < 6; ++i)
      for (Index k = i + 1; k < 6; ++k) {
        bool there = section.stations.empty() && section.stiffness(i, k) != 0.0;
        for (const Station& station : section.stations) there |= station.stiffness(i, k) != 0.0;
        if (!there) continue;
        const std::string entry = fmt::format("D{}{}", i + 1, k + 1);
        add(fmt::format("{}:{}", entry, section.name),
            fmt::format("coupling {} of {}", entry, label(section)),
            fmt::format("<section name=\"{}\"> <stiffness {}=\"0\" …/>", section.name, entry),
            [i, k, name = section.name](Scene& s) {
              for (Section& one : s.sections)
                if (one.name == name)
                  each_stiffness(one, [&](Mat6& D) { D(i, k) = D(k, i) = 0.0; });
            });
      }
  }

  void inertia() {
    const bool any =
        scene_.transient && std::any_of(scene_.sections.begin(), scene_.sections.end(),
                                        [this](const Section& s) { return is_used(scene_, s); });
    if (any)
      add("rotary_inertia",
          fmt::format("rotary inertia of sections (lowered {} times)", shortest(reduction)),
          fmt::format("inertia of <mass> of each <section> about the mass centre over {}",
                      shortest(reduction)),
          [](Scene& s) {
            for (Section& section : s.sections) each_mass(section, lower_rotary_inertia);
          });
    add_each(scene_.point_masses);
    add_each(scene_.added_masses);
    if (scene_.transient && scene_.transient->inertia == InertiaTerms::full &&
        scene_.reductions.empty() &&
        scene_.transient->balance.value_or(Balance::acceleration) == Balance::acceleration)
      add("gyroscopic", "gyroscopic moments of rotary inertia",
          "<transient … inertia=\"no_gyroscopic\"/>",
          [](Scene& s) { s.transient->inertia = InertiaTerms::no_gyroscopic; });
  }

  void damping() {
    for (const Section& section : scene_.sections)
      if (scene_.transient && section.damping && is_used(scene_, section))
        add("damping:" + section.name, "damping of " + label(section),
            fmt::format("<section name=\"{}\"> (without <damping>)", section.name),
            [name = section.name](Scene& s) {
              for (Section& one : s.sections)
                if (one.name == name) one.damping.reset();
            });
  }

  // The waves of fibres that are critically damped over the longest beam of a section: steps need not follow them.
  void axial_waves() {
    if (!scene_.transient) return;
    std::string change;
    std::vector<std::pair<std::string, double>> viscous;  // by section [N.s]
    for (const Section& section : scene_.sections) {
      const std::optional<Mat6>& mass =
          section.stations.empty() ? section.mass : section.stations.front().mass;
      const double EA = first_stiffness(section)(0, 0);
      if (!is_used(scene_, section) || !mass || !std::isfinite(EA)) continue;
      double length = 0.0;
      bool has_viscous = true;
      for (const BeamScene& beam : scene_.beams) {
        if (beam.section != section.name || rigid_with(scene_, beam.name) != nullptr) continue;
        length = std::max(length, make_reference_line(beam).length);
        has_viscous = has_viscous && beam.kinematics == Kinematics::motion &&
                      reduction_with(scene_, beam.name) == nullptr;
      }
      if (!has_viscous) continue;
      // 2 EA/omega, of the slowest wave between held ends: omega = pi/L sqrt(EA/m).
      const double c = 2.0 * length * std::sqrt(EA * (*mass)(0, 0)) / std::numbers::pi;
      viscous.emplace_back(section.name, c);
      const double all = c + (section.damping ? section.damping->viscous(0, 0) : 0.0);
      change += fmt::format("<section name=\"{}\"> <damping EA=\"{}\" …/>\n", section.name,
                            shortest(all));
    }
    if (viscous.empty()) return;
    add("axial_waves", "axial waves (critically damped)", change, [viscous](Scene& s) {
      for (Section& section : s.sections)
        for (const auto& [name, c] : viscous) {
          if (section.name != name) continue;
          if (!section.damping) section.damping.emplace().source = section.source;
          section.damping->viscous(0, 0) += c;
        }
    });
  }

  void forces() {
    if (scene_.base_motion)
      add("base_motion", "motion of the base", left_out("base_motion", {}),
          [](Scene& s) { s.base_motion.reset(); });
    add_each(scene_.drags);
    if (scene_.gravity && !scene_.gravity->acceleration.isZero(0.0))
      add("gravity", "gravity", left_out("gravity", {}), [](Scene& s) { s.gravity.reset(); });
    each_kind(scene_, [this]<class Items>(const Items& items) {
      using Item = typename Items::value_type;
      constexpr bool has_been = std::is_same_v<Item, PointMassScene> ||
                                std::is_same_v<Item, AddedMassScene> ||
                                std::is_same_v<Item, DragScene>;
      if constexpr (Item::item.is_an_effect && !has_been) add_each(items);
    });
  }

  // Last, as it renames beams and copies sections.
  void curvature() {
    for (const BeamScene& beam : scene_.beams) {
      if (!can_be_straightened(scene_, beam)) continue;
      const std::vector<std::string> names = names_of_pieces(scene_, beam);
      add("curvature:" + beam.name, "initial curvature of " + label(beam) + " (straight pieces)",
          fmt::format(
              "<beam name=\"{}\" …/> to {}, straight between the ends of the elements of {}, "
              "joined by <fixed>",
              names.front(), names.back(), label(beam)),
          [name = beam.name](Scene& s) {
            if (rigid_with(s, name) == nullptr) straighten(s, name);
          });
    }
  }

  const Scene& scene_;
  std::vector<Effect> all_;
};

Scene named(Scene scene) {
  each_kind(scene, []<class Items>(Items& items) {
    using Item = typename Items::value_type;
    if constexpr (Item::item.is_an_effect) name_all(items, Item::item.element);
  });
  return scene;
}

// Of sectional forces in a rigid beam, and of springs that were left out.
void leave_out_records(Scene& scene) {
  std::vector<std::string> gone;
  const auto exists = [&](const std::string& spring) {
    bool found = false;
    each_item(scene, [&]<class T>(const T& item) {
      if constexpr (T::item.names == field::of_springs) found = found || item.name == spring;
    });
    return found;
  };
  for (RecordScene& record : scene.records) {
    if (record.spring && !exists(*record.spring)) {
      for (const std::string& q : record.quantities) gone.push_back(record.name + "." + q);
      record.quantities.clear();
      continue;
    }
    if (!record.at || record.at->kind != Place::Kind::beam ||
        rigid_with(scene, record.at->name) == nullptr)
      continue;
    std::erase_if(record.quantities, [&](const std::string& q) {
      const schema::Quantity* const known = schema::find_quantity(schema::place_quantities(), q);
      if (known == nullptr ||
          (known->of != schema::Quantity::Of::beam_place && !known->of_section_point()))
        return false;
      gone.push_back(record.name + "." + q);
      return true;
    });
  }
  std::erase_if(scene.records, [](const RecordScene& r) { return r.quantities.empty(); });
  const auto is_gone = [&](const std::string& column) {
    return std::find(gone.begin(), gone.end(), quantity_of(column)) != gone.end();
  };
  std::erase_if(scene.expects, [&](const ExpectScene& e) { return is_gone(e.quantity); });
  for (PlotScene& plot : scene.plots) std::erase_if(plot.y, is_gone);
  std::erase_if(scene.plots,
                [&](const PlotScene& plot) { return plot.y.empty() || is_gone(plot.x); });
}

}  // namespace
}  // namespace mbd::ablation_list

namespace mbd {

std::vector<Ablation> ablations_of(const Scene& scene) {
  using namespace ablation_list;
  const Scene all = named(scene);
  std::vector<Ablation> result;
  const Effects effects(all);
  for (const Effect& effect : effects.all()) result.push_back(effect.ablation);
  return result;
}

Scene without(const Scene& scene, std::span<const std::string> keys) {
  using namespace ablation_list;
  Scene result = named(scene);
  const Scene all = result;
  const Effects effects(all);
  for (const std::string& key : keys) {
    const auto is_key = [&](const Effect& e) { return e.ablation.key == key; };
    if (std::any_of(effects.all().begin(), effects.all().end(), is_key)) continue;
    std::vector<std::string_view> known;
    for (const Effect& e : effects.all()) known.push_back(e.ablation.key);
    throw Error(fmt::format("without: {} has no effect \"{}\"{}", label("mbd", scene.name),
                            excerpt(key), suggest(key, known, "effects")));
  }
  for (const Effect& effect : effects.all())
    if (std::find(keys.begin(), keys.end(), effect.ablation.key) != keys.end())
      effect.leave_out(result);
  leave_out_records(result);
  return result;
}

}  // namespace mbd
