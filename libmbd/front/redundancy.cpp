#include "libmbd/front/redundancy.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string>
#include <vector>

namespace mbd {

void refuse_redundant(const Model& model, const Mechanism& mechanism) {
  if (mechanism.redundant.empty()) return;

  const System& system = *model.system;
  const auto maker = [&model](Index row) -> const Model::Maker& {
    return model.makers[static_cast<std::size_t>(row)];
  };
  const Model::Maker& blamed = maker(mechanism.redundant.front().row);
  std::vector<std::string> rows, others;
  std::size_t more = 0;
  for (const RedundantRow& r : mechanism.redundant) {
    if (maker(r.row).label != blamed.label) {
      ++more;
      continue;
    }
    const std::string words = row_in_words(system, r.row);
    rows.push_back(words.substr(words.find(", ") + 2));
    for (const Index row : r.repeats)
      if (std::find(others.begin(), others.end(), maker(row).label) == others.end())
        others.push_back(maker(row).label);
  }
  constexpr std::size_t most = 6;
  if (others.size() > most) {
    others.resize(most);
    others.push_back("others");
  }
  throw Error(
      blamed.source,
      fmt::format("{}: redundant constraints cannot be solved: its {} {} held already by {}{}; "
                  "leave one of them out, or take a joint that holds less",
                  blamed.label, fmt::join(rows, ", "), rows.size() == 1 ? "is" : "are",
                  others.empty() ? "the ground" : fmt::format("{}", fmt::join(others, ", ")),
                  more > 0 ? fmt::format(" (and {} more in other joints)", more) : ""));
}

}  // namespace mbd
