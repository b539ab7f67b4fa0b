// Reads a table of numbers: lines with #, one line of column names, then rows.
#pragma once

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace mbd::test {

struct Table {
  std::vector<std::string> names;
  std::vector<std::vector<double>> columns;  // by name

  std::size_t rows() const { return columns.empty() ? 0 : columns.front().size(); }

  const std::vector<double>& operator[](const std::string& name) const {
    for (std::size_t i = 0; i < names.size(); ++i)
      if (names[i] == name) return columns[i];
    throw std::runtime_error("there is no column " + name);
  }
};

inline Table read_csv(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error("cannot read " + file.string());
  Table table;
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line.front() == '#') continue;
    const bool is_header = table.names.empty();
    std::istringstream cells(line);
    std::size_t i = 0;
    for (std::string cell; std::getline(cells, cell, ','); ++i) {
      if (is_header)
        table.names.push_back(cell);
      else
        table.columns.at(i).push_back(std::stod(cell));
    }
    table.columns.resize(table.names.size());
    if (i != table.names.size())
      throw std::runtime_error(file.string() + ": a row of another length");
  }
  return table;
}

// Largest magnitude of a column.
inline double largest(const std::vector<double>& x) {
  double m = 0.0;
  for (const double v : x)
    m = std::isnan(v) ? std::numeric_limits<double>::infinity() : std::max(m, std::abs(v));
  return m;
}

}  // namespace mbd::test
