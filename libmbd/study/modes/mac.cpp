#include "libmbd/study/modes/mac.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <unordered_map>

#include "libmbd/core/error.hpp"
#include "libmbd/core/types.hpp"

namespace mbd {
namespace {

using Json = nlohmann::ordered_json;
using Eigen::MatrixXcd;
using Groups = std::vector<std::vector<std::size_t>>;

constexpr double alike = 0.5;            // and more: a pair
constexpr double one_eigenvalue = 1e-6;  // relative, where round-off leaves that much
constexpr double no_mass = 1e-14;        // of what the shape that moves most moves

Index column(std::size_t mode) { return static_cast<Index>(mode); }

Groups groups_of(const ShapesOfModes& modes) {
  Groups groups;
  const auto same = [&](std::size_t a, std::size_t b) {
    constexpr double most = 1e-3;
    const double round_off = 10.0 * (modes.round_off[a] + modes.round_off[b]);
    const double size = std::max(std::abs(modes.eigenvalues[a]), std::abs(modes.eigenvalues[b]));
    return std::abs(modes.eigenvalues[a] - modes.eigenvalues[b]) <=
           std::clamp(round_off, one_eigenvalue, most) * size;
  };
  for (std::size_t mode = 0; mode < modes.names.size(); ++mode) {
    const auto its = std::ranges::find_if(groups, [&](const std::vector<std::size_t>& group) {
      return std::ranges::any_of(group, [&](std::size_t one) { return same(one, mode); });
    });
    if (its == groups.end())
      groups.push_back({mode});
    else
      its->push_back(mode);
  }
  return groups;
}

MacTable::Side side_of(const ShapesOfModes& modes) {
  return {modes.model, modes.file, modes.names, modes.frequencies, groups_of(modes)};
}

MatrixXcd block(const MatrixXcd& A, const std::vector<std::size_t>& rows,
                const std::vector<std::size_t>& columns) {
  MatrixXcd part(column(rows.size()), column(columns.size()));
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (std::size_t j = 0; j < columns.size(); ++j)
      part(column(i), column(j)) = A(column(rows[i]), column(columns[j]));
  return part;
}

// Makes an orthonormal basis of shapes with these products, but for what moves no mass: coefficients, a column each.
MatrixXcd orthonormal(const MatrixXcd& products) {
  constexpr double independent = 1e-10;
  const Eigen::SelfAdjointEigenSolver<MatrixXcd> solver(products);
  const Eigen::VectorXd& values = solver.eigenvalues();
  const double most = values.maxCoeff();
  Index first = 0;
  while (first < values.size() && !(values(first) > independent * most)) ++first;
  const Index count = values.size() - first;
  return solver.eigenvectors().rightCols(count) *
         values.tail(count).cwiseSqrt().cwiseInverse().asDiagonal();
}

// Products a^H M b of modes, of modes with others, and of others.
struct Products {
  MatrixXcd modes, both, others;
};

double share(const Products& p, Index a, Index b) {
  const double mass = p.modes(a, a).real() * p.others(b, b).real();
  const double most = p.modes.diagonal().real().maxCoeff() * p.others.diagonal().real().maxCoeff();
  if (!(mass > no_mass * most)) return std::numeric_limits<double>::quiet_NaN();
  return std::norm(p.both(a, b)) / mass;
}

void compare(const Products& p, MacTable& table) {
  const Groups &G = table.modes.groups, &H = table.others.groups;
  table.mac.resize(p.both.rows(), p.both.cols());
  for (Index a = 0; a < p.both.rows(); ++a)
    for (Index b = 0; b < p.both.cols(); ++b) table.mac(a, b) = share(p, a, b);
  std::vector<MatrixXcd> bases_of_G, bases_of_H;
  for (const auto& group : G) bases_of_G.push_back(orthonormal(block(p.modes, group, group)));
  for (const auto& group : H) bases_of_H.push_back(orthonormal(block(p.others, group, group)));
  table.groups.resize(column(G.size()), column(H.size()));
  for (std::size_t g = 0; g < G.size(); ++g) {
    std::vector<MacTable::Pair> pairs;
    for (std::size_t h = 0; h < H.size(); ++h) {
      double& found = table.groups(column(g), column(h));
      const Index least = std::min(bases_of_G[g].cols(), bases_of_H[h].cols());
      if (G[g].size() == 1 && H[h].size() == 1)
        found = table.mac(column(G[g][0]), column(H[h][0]));
      else if (least == 0)
        found = std::numeric_limits<double>::quiet_NaN();
      else
        found =
            (bases_of_G[g].adjoint() * block(p.both, G[g], H[h]) * bases_of_H[h]).squaredNorm() /
            static_cast<double>(least);
      if (found >= alike) pairs.push_back({g, h, found});
    }
    std::ranges::stable_sort(pairs, std::ranges::greater(), &MacTable::Pair::alike);
    table.pairs.insert(table.pairs.end(), pairs.begin(), pairs.end());
  }
}

// Of others, the shapes at the nodes of `modes`; those of nodes that others do not have become zero in both. Says what is left out.
MatrixXcd at_common_nodes(const ShapesOfModes& others, ShapesOfModes& modes,
                          std::vector<std::string>& notes) {
  constexpr double same_place = 1e-6;  // of the size
  std::unordered_map<std::string, std::size_t> known;
  for (std::size_t n = 0; n < others.nodes.size(); ++n) known.emplace(others.nodes[n], n);
  MatrixXcd shapes = MatrixXcd::Zero(modes.shapes.rows(), others.shapes.cols());
  std::size_t common = 0, moved = 0;
  std::string missing;
  double farthest = 0.0, size = 0.0;
  for (std::size_t n = 0; n < modes.nodes.size(); ++n) {
    const auto found = known.find(modes.nodes[n]);
    const Index row = 6 * column(n);
    if (found == known.end()) {
      modes.shapes.middleRows(row, 6).setZero();
      if (missing.empty()) missing = modes.nodes[n];
      continue;
    }
    ++common;
    shapes.middleRows(row, 6) = others.shapes.middleRows(6 * column(found->second), 6);
    size = std::max(size, (modes.positions[n] - modes.positions.front()).norm());
    const double apart = (modes.positions[n] - others.positions[found->second]).norm();
    if (apart > farthest) {
      farthest = apart;
      moved = n;
    }
  }
  if (common == 0)
    throw Error(fmt::format("{}: has no node of a name that {} has ({}, …)", others.file,
                            modes.model, missing));
  if (common < modes.nodes.size() || common < others.nodes.size())
    notes.push_back(
        fmt::format("compared at the {} nodes whose names both have, of {} here and {} there{}",
                    common, modes.nodes.size(), others.nodes.size(),
                    missing.empty() ? "" : " (not at " + missing + ")"));
  if (farthest > same_place * std::max(size, farthest))
    notes.push_back(fmt::format(
        "nodes of one name are up to {:.3g} m apart ({}): another mesh, or another state", farthest,
        modes.nodes[moved]));
  return shapes;
}

void note_groups(const MacTable::Side& side, const std::string& where,
                 std::vector<std::string>& notes) {
  for (const auto& group : side.groups)
    if (group.size() > 1)
      notes.push_back(
          fmt::format("modes {}{} have one eigenvalue: any mixture of their shapes is one too, so "
                      "only the group "
                      "is compared with others, not each of its modes",
                      numbers_of(group), where));
}

std::vector<Eigen::Vector3d> positions_of(const Json& nodes) {
  std::vector<Eigen::Vector3d> positions;
  for (const Json& node : nodes) {
    const Json& r = node.at("position");
    positions.emplace_back(r.at(0).get<double>(), r.at(1).get<double>(), r.at(2).get<double>());
  }
  return positions;
}

void add_mode(const Json& mode, Index number, ShapesOfModes& all) {
  all.names.push_back(mode.at("name").get<std::string>());
  const Json& l = mode.at("eigenvalue");
  all.eigenvalues.emplace_back(l.at(0).get<double>(), l.at(1).get<double>());
  all.frequencies.push_back(mode.at("frequency").get<double>());
  all.round_off.push_back(mode.at("round_off").get<double>());
  const Json& shape = mode.at("shape");
  if (shape.size() != all.nodes.size()) throw Error("a shape has not the nodes that there are");
  for (std::size_t n = 0; n < shape.size(); ++n)
    for (std::size_t k = 0; k < 6; ++k) {
      const Json& x = shape[n].at(k);
      all.shapes(column(6 * n + k), number) = {x.at(0).get<double>(), x.at(1).get<double>()};
    }
}

}  // namespace

std::string numbers_of(const std::vector<std::size_t>& group) {
  std::string text;
  for (const std::size_t mode : group)
    text += (text.empty() ? "" : ", ") + std::to_string(mode + 1);
  return text;
}

ShapesOfModes read_modes(const std::filesystem::path& path) {
  std::error_code code;
  const std::filesystem::path file =
      std::filesystem::is_directory(path, code) ? path / "modes.json" : path;
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw Error(file.string() + ": cannot be read");
  ShapesOfModes all;
  try {
    const Json json = Json::parse(stream);
    all.model = json.at("model").get<std::string>();
    all.file = file.string();
    for (const Json& node : json.at("nodes")) all.nodes.push_back(node.at("name"));
    all.positions = positions_of(json.at("nodes"));
    const Json& modes = json.at("modes");
    all.shapes.resize(column(6 * all.nodes.size()), column(modes.size()));
    for (std::size_t i = 0; i < modes.size(); ++i) add_mode(modes[i], column(i), all);
  } catch (const std::exception& error) {
    throw Error(file.string() + ": is not what `mbd modes` writes to modes.json (" + error.what() +
                ")");
  }
  return all;
}

MacTable mac_table(const ShapesOfModes& modes, const Weigh& weigh) {
  MacTable table;
  table.modes = table.others = side_of(modes);
  if (modes.names.empty()) return table;
  Products products;
  products.modes = modes.shapes.adjoint() * weigh(modes.shapes);
  products.both = products.others = products.modes;
  compare(products, table);
  note_groups(table.modes, "", table.notes);
  return table;
}

MacTable mac_table(const ShapesOfModes& modes, const Weigh& weigh, const ShapesOfModes& others) {
  MacTable table;
  table.among_themselves = false;
  table.modes = side_of(modes);
  table.others = side_of(others);
  ShapesOfModes here = modes;
  const MatrixXcd there = at_common_nodes(others, here, table.notes);
  if (modes.names.empty() || others.names.empty()) return table;
  const MatrixXcd weighed = weigh(there);
  compare({here.shapes.adjoint() * weigh(here.shapes), here.shapes.adjoint() * weighed,
           there.adjoint() * weighed},
          table);
  note_groups(table.modes, "", table.notes);
  note_groups(table.others, " of " + others.file, table.notes);
  return table;
}

}  // namespace mbd
