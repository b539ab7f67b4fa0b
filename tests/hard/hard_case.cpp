#include "tests/hard/hard_case.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <utility>

namespace mbd::test::hard {
namespace {

constexpr std::string_view first_line = "| case | what | run | reference | error reached |";

struct Cost {
  std::clock_t begun = 0;
  std::map<std::pair<int, std::string>, std::string> rows;  // by number and letters of the case
};

Cost& cost() {
  static Cost one;
  return one;
}

std::pair<int, std::string> key_of(const std::string& id) {
  std::size_t letters = 0;
  const int number = std::stoi(id, &letters);
  return {number, id.substr(letters)};
}

class Clock : public testing::EmptyTestEventListener {
  void OnTestStart(const testing::TestInfo& /*test*/) override { cost().begun = std::clock(); }
};

class Table : public testing::Environment {
 public:
  void SetUp() override { testing::UnitTest::GetInstance()->listeners().Append(new Clock); }
  void TearDown() override {
    if (std::getenv("MBD_UPDATE_TABLES") == nullptr) return;
    const auto file = std::filesystem::path(MBD_SOURCE_DIR) / "tests" / "README.md";
    std::ifstream in(file);
    std::string before, after, line;
    auto rows = cost().rows;
    enum { text, table, rest } where = text;
    while (std::getline(in, line)) {
      if (where == table && !line.starts_with("|")) where = rest;
      if (where == table && !line.starts_with("|-"))
        rows.emplace(key_of(line.substr(2, line.find(" |") - 2)), line);
      if (where != table) (where == text ? before : after) += line + '\n';
      if (where == table && line.starts_with("|-")) before += line + '\n';
      if (where == text && line.starts_with(first_line)) where = table;
    }
    in.close();
    std::ofstream out(file);
    out << before;
    for (const auto& [key, row] : rows) out << row << '\n';
    out << after;
  }
};

[[maybe_unused]] const auto* const registered =
    testing::AddGlobalTestEnvironment(new Table);  // gtest owns it

}  // namespace

void record(Row row) {
  const double seconds =
      static_cast<double>(std::clock() - cost().begun) / static_cast<double>(CLOCKS_PER_SEC);
  cost().rows[key_of(row.id)] =
      fmt::format("| {} | {} | {} | {} | {} | {} | {:.2g} |", row.id, row.what, row.run,
                  row.reference, row.error, row.shown, seconds);
}

std::string bounded(double error, double bound) {
  return fmt::format("{:.1e} (bound {:.0e})", error, bound);
}

}  // namespace mbd::test::hard
