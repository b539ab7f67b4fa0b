#include "libmbd/compile/loads.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "libmbd/core/stop.hpp"
#include "libmbd/scene/label.hpp"
#include "libmbd/scene/reference_line.hpp"

namespace mbd {
namespace {

bool any(const load::Signals& signals) {
  return std::any_of(signals.begin(), signals.end(), [](int i) { return i >= 0; });
}

bool is_unturned(const Pose<double>& frame) { return frame.p.vec().isZero(0.0); }

}  // namespace

std::array<Expression, 3> turned_law(const std::array<Expression, 3>& laws, const Mat3& R) {
  const auto row = [&](Index i) {
    const Expression::Term terms[] = {
        {R(i, 0), &laws[0]}, {R(i, 1), &laws[1]}, {R(i, 2), &laws[2]}};
    return Expression::sum(terms);
  };
  return {row(0), row(1), row(2)};
}

std::vector<BeamNode> nodes_between(std::span<const BeamNode> nodes, double from, double to) {
  std::vector<BeamNode> result;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    BeamNode here = nodes[k];
    if (k + 1 < nodes.size() && nodes[k + 1].node == here.node && nodes[k + 1].s == here.s) {
      const bool before = from + same_parameter < here.s && here.s < to + same_parameter;
      const bool after = from - same_parameter < here.s && here.s < to - same_parameter;
      here.weight = (before ? here.weight : 0.0) + (after ? nodes[k + 1].weight : 0.0);
      ++k;
    }
    if (here.s < from - same_parameter || here.s > to + same_parameter || here.weight == 0.0)
      continue;
    result.push_back(here);
  }
  return result;
}

template <class E>
ElementBatch<E>& Loads::batch(std::unique_ptr<ElementBatch<E>>& made) {
  if (!made) made = std::make_unique<ElementBatch<E>>(E::name, typename E::Shared{});
  return *made;
}

int Loads::signal(const Expression& e, const std::string& name) {
  const auto named = [&] { return fmt::format("{} \"{}\"", name, excerpt(e.text())); };
  if (!e.is_constant())
    return static_cast<int>(
        system_.add_signal(Signal::from_expression(e), SignalUse::load, named()));
  if (e.value() == 0.0) return -1;
  const auto [it, is_new] = constants_.try_emplace(e.value(), -1);
  if (is_new)
    it->second =
        static_cast<int>(system_.add_signal(Signal::constant(e.value()), SignalUse::load, named()));
  return it->second;
}

load::Signals Loads::signals(const LoadScene& load, int node, std::string_view kind,
                             const Components& force, const Components& moment) {
  load::Signals result{-1, -1, -1, -1, -1, -1};
  const auto name = [&](std::string_view of, std::size_t i) {
    return said(load.source, fmt::format("{} on {}: {}{} {}", label(load), system_.node_name(node),
                                         kind, of, i + 1));
  };
  for (std::size_t i = 0; i < 3; ++i) {
    if (force) result[i] = signal((*force)[i], name("force", i));
    if (moment) result[3 + i] = signal((*moment)[i], name("moment", i));
  }
  return result;
}

void Loads::add_dead(const load::Signals& signals, double weight, const Vec3& offset, int node) {
  if (!any(signals)) return;
  batch(dead_).add({signals, weight}, std::array{node},
                   fmt::format("load on {}", system_.node_name(node)));
  const bool has_force =
      std::any_of(signals.begin(), signals.begin() + 3, [](int i) { return i >= 0; });
  if (has_force && !offset.isZero(0.0))
    batch(arm_).add({signals, weight, offset}, std::array{node},
                    fmt::format("arm of a load on {}", system_.node_name(node)));
}

void Loads::add_follower(const load::Signals& signals, double weight, const Vec3& offset,
                         int node) {
  if (any(signals))
    batch(follower_).add({signals, weight, offset}, std::array{node},
                         fmt::format("follower load on {}", system_.node_name(node)));
}

void Loads::add(const LoadScene& load) {
  const Attachment at = nodes_.find_moving(load, load.at, label(load));
  const int node = at.node;
  const Pose<double> frame = nodes_.frame_of(at);
  const Vec3 offset = frame * load.offset;
  add_dead(signals(load, node, "", load.force, load.moment), 1.0, offset, node);
  const auto in_node = [&](const Components& laws) {
    return laws && !is_unturned(frame) ? Components(turned_law(*laws, frame.R())) : laws;
  };
  add_follower(
      signals(load, node, "follower_", in_node(load.follower_force), in_node(load.follower_moment)),
      1.0, offset, node);
}

// One distributed load.
class Loads::Distribution {
 public:
  // Throws Error where the load cannot be evaluated.
  Distribution(Loads& loads, const DistributedLoadScene& load) : loads_(loads), load_(load) {
    for (Row& row : rows_)
      for (std::size_t i = 0; i < 3; ++i)
        if (row.fields && !(*row.fields)[i].varies())
          row.everywhere[i] = signal_at(row, i, load.from);
  }

  // Where two elements meet, the load's signals and kernel are needed once.
  void act_on(std::span<const BeamNode> nodes) {
    const int node = nodes.front().node;
    const bool rigid = std::all_of(nodes.begin(), nodes.end(),
                                   [&](const BeamNode& here) { return here.node == node; });
    Sums dead, follower;
    for (const BeamNode& here : nodes_between(nodes, load_.from, load_.to)) {
      const load::Signals followers = is_unturned(here.frame) ? at(2, here.s) : turned(here);
      if (rigid) {
        add_to(dead, at(0, here.s), here);
        add_to(follower, followers, here);
      } else {
        loads_.add_dead(at(0, here.s), here.weight, here.frame.r, here.node);
        loads_.add_follower(followers, here.weight, here.frame.r, here.node);
      }
    }
    for (const auto& [signals, sum] : dead)
      loads_.add_dead(signals, sum.weight, sum.moment / sum.weight, node);
    for (const auto& [signals, sum] : follower)
      loads_.add_follower(signals, sum.weight, sum.moment / sum.weight, node);
  }

 private:
  using Fields = std::optional<std::array<FieldExpression, 3>>;
  struct Row {
    std::string_view name;
    const Fields& fields;
    std::array<int, 3> everywhere{-1, -1,
                                  -1};  // an expression without s is one signal for all nodes
  };

  // Of a rigid beam: all points with the same signals are one load at their centre.
  struct Sum {
    double weight = 0.0;
    Vec3 moment = Vec3::Zero();  // sum of weight x offset [m2]
  };
  using Sums = std::map<load::Signals, Sum>;

  static void add_to(Sums& sums, const load::Signals& signals, const BeamNode& here) {
    Sum& sum = sums[signals];
    sum.weight += here.weight;
    sum.moment += here.weight * here.frame.r;
  }

  std::string said_of(const Row& row) const {
    return fmt::format("{} on {}: {}", label(load_), load_.beam, row.name);
  }

  int signal_at(const Row& row, std::size_t i, double s) {
    const FieldExpression& field = (*row.fields)[i];
    try {
      std::string name = said(load_.source, fmt::format("{} {}", said_of(row), i + 1));
      if (field.varies()) name += fmt::format(" at s = {:.6g}", s);
      return loads_.signal(field.at(s), name);
    } catch (const Stopped&) {
      throw;
    } catch (const Error& e) {
      throw Error(load_.source, fmt::format("{}, at s = {:.6g}: {}", label(load_), s, e.what()));
    }
  }

  // Force and moment at s: of two rows, in the axes in which they are given.
  load::Signals at(std::size_t force, double s) {
    load::Signals result{-1, -1, -1, -1, -1, -1};
    for (std::size_t k = 0; k < 6; ++k) {
      const Row& row = rows_[force + k / 3];
      const std::size_t i = k % 3;
      if (!row.fields) continue;
      result[k] = (*row.fields)[i].varies() ? signal_at(row, i, s) : row.everywhere[i];
    }
    return result;
  }

  // Those that follow, of the axes of a node that are not the section's: three laws at a time.
  load::Signals turned(const BeamNode& here) {
    const bool varies = std::any_of(rows_.begin() + 2, rows_.end(), [](const Row& row) {
      return row.fields && std::any_of(row.fields->begin(), row.fields->end(),
                                       [](const FieldExpression& f) { return f.varies(); });
    });
    if (last_ && !varies && last_->first.coeffs() == here.frame.p.coeffs()) return last_->second;
    load::Signals result{-1, -1, -1, -1, -1, -1};
    for (std::size_t r = 0; r < 2; ++r) {
      const Row& row = rows_[2 + r];
      if (!row.fields) continue;
      const auto law = [&](std::size_t i) { return (*row.fields)[i].at(here.s); };
      const auto laws = turned_law({law(0), law(1), law(2)}, here.frame.R());
      for (std::size_t i = 0; i < 3; ++i)
        result[3 * r + i] = loads_.signal(
            laws[i],
            said(load_.source,
                 fmt::format("{}, component {} in the axes of {} at s = {:.6g}", said_of(row),
                             i + 1, loads_.system_.node_name(here.node), here.s)));
    }
    last_ = {here.frame.p, result};
    return result;
  }

  Loads& loads_;
  const DistributedLoadScene& load_;
  std::array<Row, 4> rows_{Row{"force", load_.force}, Row{"moment", load_.moment},
                           Row{"follower_force", load_.follower_force},
                           Row{"follower_moment", load_.follower_moment}};
  std::optional<std::pair<Quaternion<double>, load::Signals>> last_;  // turned, and by what
};

void Loads::add(const DistributedLoadScene& load) {
  const std::string who = label(load);
  const std::span<const BeamNode> nodes = nodes_.along(load.beam, load.source, who);
  if (!(load.from >= 0.0 && load.to - load.from > 2.0 * same_parameter && load.to <= 1.0))
    throw Error(load.source,
                fmt::format("{}: from={:g} and to={:g} must be fractions of the beam's length, "
                            "0 <= from < to <= 1",
                            who, load.from, load.to));
  Distribution(*this, load).act_on(nodes);
}

void Loads::finish() {
  if (dead_) system_.add_batch(std::move(dead_));
  if (follower_) system_.add_batch(std::move(follower_));
  if (arm_) system_.add_batch(std::move(arm_));
}

}  // namespace mbd
