#include "libmbd/compile/redundancy.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace mbd {
namespace {

constexpr double same_law = 1e-9;  // [m, rad] of rows that a law does not move
constexpr double agree = 1e-6;     // of accelerations, relative
constexpr double still = 1e-9;     // scene lengths, or radians, per s^2
constexpr int instants = 16;       // at which laws are looked at

// Gaps with the mechanism held where it is, at times of the scene; in statics without loads and with them.
std::vector<VecX> gaps_of_laws(const Scene& scene, const System& system, State state) {
  std::vector<VecX> gaps;
  VecX r;
  state.idle.clear();
  const auto look = [&] {
    system.residual(state, r);
    gaps.emplace_back(r.tail(system.multipliers()));
  };
  if (scene.transient) {
    for (int k = 0; k <= instants; ++k) {
      system.set_time(state, scene.transient->duration * k / instants, Side::left);
      look();
    }
  } else {
    for (const double factor : {0.0, 1.0}) {
      state.load_factor = factor;
      look();
    }
  }
  return gaps;
}

// Labels of who made the rows of a dependence but `blamed`, the most important first.
std::vector<std::string> others(const std::vector<Model::Maker>& makers, const RedundantRow& row,
                                const std::string& blamed) {
  std::vector<std::string> labels;
  for (const Index i : row.repeats) {
    const std::string& label = makers[static_cast<std::size_t>(i)].label;
    if (label != blamed && std::find(labels.begin(), labels.end(), label) == labels.end())
      labels.push_back(label);
  }
  constexpr std::size_t most = 6;
  if (labels.size() > most) {
    labels.resize(most);
    labels.push_back("others");
  }
  return labels;
}

std::string joined(const std::vector<std::string>& labels) {
  return labels.empty() ? std::string("the ground") : fmt::format("{}", fmt::join(labels, ", "));
}

}  // namespace

void refuse_contradictions(const Scene& scene, const System& system, const State& initial,
                           const std::vector<Model::Maker>& makers, const Redundancy& redundancy) {
  const std::vector<VecX> gaps = gaps_of_laws(scene, system, initial);
  std::vector<bool> moved(makers.size(), false);
  for (const VecX& g : gaps)
    for (std::size_t i = 0; i < moved.size(); ++i) {
      const auto I = static_cast<Index>(i);
      moved[i] = moved[i] || std::abs(g(I) - gaps[0](I)) > same_law;
    }
  VecX gdot, rest;
  if (system.with_rates()) {
    State all = initial;
    all.idle.clear();
    system.constraint_rates(all, gdot, rest);
  }
  for (std::size_t k = 0; k < redundancy.rows.size(); ++k) {
    const RedundantRow& row = redundancy.rows[k];
    const Eigen::SparseVector<double> n = redundancy.null.col(static_cast<Index>(k));
    const double largest = n.coeffs().cwiseAbs().maxCoeff();
    const Model::Maker& blamed = makers[static_cast<std::size_t>(row.row)];
    // Who prescribes; with one only, what it asks for is the whole difference.
    std::vector<std::string> laws;
    for (Eigen::SparseVector<double>::InnerIterator it(n); it; ++it) {
      const auto i = static_cast<std::size_t>(it.index());
      if (moved[i] && std::abs(it.value()) > 1e-6 * largest &&
          std::find(laws.begin(), laws.end(), makers[i].label) == laws.end())
        laws.push_back(makers[i].label);
    }
    if (laws.empty()) continue;
    bool contradiction = false;
    if (laws.size() == 1)
      for (const VecX& g : gaps)
        contradiction = contradiction || std::abs(n.dot(VecX(g - gaps[0]))) > same_law * largest;
    if (rest.size() > 0 && !contradiction) {
      const double L = std::max(system.length_scale(), 1.0);
      double dot = 0.0, size = 0.0;
      for (Eigen::SparseVector<double>::InnerIterator it(n); it; ++it) {
        dot += it.value() * rest(it.index());
        size += std::abs(it.value() * rest(it.index()));
      }
      contradiction = std::abs(dot) > std::max(agree * size, still * L * largest);
    }
    if (!contradiction) continue;
    const std::string words = row_in_words(system, row.row);
    throw Error(
        blamed.source,
        fmt::format(
            "{}: its {} is held already by {}, which contradict it or are locked there; leave one "
            "of them out, or start where the mechanism can move",
            blamed.label, words.substr(words.find(", ") + 2),
            joined(others(makers, row, blamed.label))));
  }
}

std::vector<std::string> repetitions(const Model& model) {
  std::vector<std::string> sentences;
  std::vector<std::string> labels;  // in the order of their first rows
  std::map<std::string, std::vector<const RedundantRow*>> rows_of;
  for (const RedundantRow& row : model.redundant) {
    const std::string& label = model.makers[static_cast<std::size_t>(row.row)].label;
    auto& its_rows = rows_of[label];
    if (its_rows.empty()) labels.push_back(label);
    its_rows.push_back(&row);
  }
  std::vector<char> of_strains;  // by rows
  for (const ConstraintInfo& info : model.system->constraints())
    of_strains.insert(of_strains.end(), static_cast<std::size_t>(info.rows),
                      info.of_strains ? 1 : 0);
  for (const std::string& label : labels) {
    std::vector<std::string> rows;
    RedundantRow all;
    bool is_beam = false;
    for (const RedundantRow* const each : rows_of[label]) {
      const RedundantRow& row = *each;
      const std::string words = row_in_words(*model.system, row.row);
      rows.push_back(words.substr(words.find(", ") + 2));
      is_beam = is_beam || of_strains[static_cast<std::size_t>(row.row)] != 0;
      all.repeats.insert(all.repeats.end(), row.repeats.begin(), row.repeats.end());
    }
    sentences.push_back(fmt::format(
        "{} repeats {} in {}{}", label, joined(others(model.makers, all, label)),
        fmt::join(rows, ", "),
        is_beam ? ", which cannot deform between its supports: without stretching a straight beam "
                  "cannot bend there; give that stiffness a number, or let a support move"
                : ""));
  }
  return sentences;
}

}  // namespace mbd
