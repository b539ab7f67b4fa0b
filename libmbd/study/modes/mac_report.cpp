#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "libmbd/study/modes/mac.hpp"
#include "libmbd/text/tables.hpp"

namespace mbd {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t most_columns = 12;  // on a line of a terminal

Eigen::Index entry(std::size_t i) { return static_cast<Eigen::Index>(i); }

// Of each mode the group it is in.
std::vector<std::size_t> group_of_modes(const MacTable::Side& side) {
  std::vector<std::size_t> all(side.names.size());
  for (std::size_t g = 0; g < side.groups.size(); ++g)
    for (const std::size_t mode : side.groups[g]) all[mode] = g;
  return all;
}

std::string short_number(double mac) {
  constexpr double seen = 5e-3;
  return std::isnan(mac) ? "-" : mac < seen ? "." : fmt::format("{:.2f}", mac);
}

void append_table(const MacTable& table, std::string& text) {
  const std::size_t columns = std::min(table.others.names.size(), most_columns);
  std::vector<std::vector<std::string>> rows{{""}};
  for (std::size_t b = 0; b < columns; ++b) rows[0].push_back(std::to_string(b + 1));
  rows[0].emplace_back();
  for (std::size_t a = 0; a < std::min(table.modes.names.size(), most_columns); ++a) {
    std::vector<std::string> row{std::to_string(a + 1)};
    for (std::size_t b = 0; b < columns; ++b)
      row.push_back(short_number(table.mac(entry(a), entry(b))));
    row.push_back(table.modes.names[a]);
    rows.push_back(std::move(row));
  }
  study::table(text, rows);
  if (table.modes.names.size() > most_columns || table.others.names.size() > most_columns)
    text += fmt::format("({} by {} are shown, of {} by {}; all are in mac.csv)\n", rows.size() - 1,
                        columns, table.modes.names.size(), table.others.names.size());
}

void append_pairs(const MacTable& table, std::string& text) {
  std::vector<char> has(table.modes.groups.size(), 0);
  std::vector<std::vector<std::string>> rows{
      {"", "there", "alike", "undamped Hz", "undamped Hz there", "change"}};
  for (const MacTable::Pair& pair : table.pairs) {
    const auto &group = table.modes.groups[pair.group], &other = table.others.groups[pair.other];
    has[pair.group] = 1;
    const double here = table.modes.frequencies[group[0]],
                 there = table.others.frequencies[other[0]];
    rows.push_back({numbers_of(group), numbers_of(other), fmt::format("{:.4f}", pair.alike),
                    fmt::format("{:.6g}", here), fmt::format("{:.6g}", there),
                    here > 0.0 ? fmt::format("{:+.3g} %", 100.0 * (there / here - 1.0)) : ""});
  }
  text += '\n';
  if (rows.size() > 1) study::table(text, rows);
  for (std::size_t g = 0; g < has.size(); ++g)
    if (has[g] == 0)
      text += fmt::format("mode {}: none there is like it by half\n",
                          numbers_of(table.modes.groups[g]));
}

Json side_json(const MacTable::Side& side) {
  Json json = Json::object();
  json["model"] = side.model;
  json["file"] = side.file;
  json["names"] = side.names;
  json["frequencies"] = side.frequencies;
  json["groups"] = side.groups;
  return json;
}

// What is not a number is written as null.
Json matrix_json(const Eigen::MatrixXd& matrix) {
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    Json row = Json::array();
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) row.push_back(matrix(i, j));
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace

std::string to_text(const MacTable& table) {
  std::string text = fmt::format(
      "MAC, weighted by mass, of modes {} (1: the same shape, 0: nothing in common)\n\n",
      table.among_themselves ? "among themselves"
                             : fmt::format("with those of {}", table.others.file));
  append_table(table, text);
  if (!table.among_themselves) append_pairs(table, text);
  for (const std::string& note : table.notes) text += "\nnote: " + note + "\n";
  return text;
}

std::string to_csv(const MacTable& table) {
  std::string text = "mode,other,mac,mac_of_groups,frequency,other_frequency\n# -,-,-,-,Hz,Hz\n";
  const std::vector<std::size_t> groups = group_of_modes(table.modes),
                                 others = group_of_modes(table.others);
  const auto number = [](double x) { return std::isnan(x) ? "" : fmt::format("{:.17g}", x); };
  for (std::size_t a = 0; a < groups.size(); ++a)
    for (std::size_t b = 0; b < others.size(); ++b)
      text += fmt::format("{},{},{},{},{:.17g},{:.17g}\n", a + 1, b + 1,
                          number(table.mac(entry(a), entry(b))),
                          number(table.groups(entry(groups[a]), entry(others[b]))),
                          table.modes.frequencies[a], table.others.frequencies[b]);
  return text;
}

std::string to_json(const MacTable& table) {
  Json json = Json::object();
  json["weight"] = "mass of " + table.modes.model;
  json["modes"] = side_json(table.modes);
  if (!table.among_themselves) json["others"] = side_json(table.others);
  json["mac"] = matrix_json(table.mac);
  json["mac_of_groups"] = matrix_json(table.groups);
  Json& pairs = json["pairs"] = Json::array();
  for (const MacTable::Pair& pair : table.pairs)
    pairs.push_back({{"modes", table.modes.groups[pair.group]},
                     {"others", table.others.groups[pair.other]},
                     {"alike", pair.alike}});
  json["notes"] = table.notes;
  return json.dump(1) + "\n";
}

}  // namespace mbd
