// Valid models made at random from the schema's own table (tests/support/grammar.hpp): each compiles, and runs ten steps or
// says why not; numbers are finite; and none that passes its certificate is far from a second integrator's.
//
// tools/fuzz makes such models for as long as one likes, under sanitizers.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>

#include "libmbd/language/schema.hpp"
#include "tests/hard/hard_case.hpp"
#include "tests/support/grammar.hpp"

namespace mbd::test::test_grammar {
namespace {

// Elements and attributes of the schema that none of the scenes had.
std::set<std::string> missing(const std::set<std::string>& said) {
  std::set<std::string> all;
  const auto look = [&](const std::string& what) {
    if (!said.contains(what)) all.insert(what);
  };
  for (const schema::Element& element : schema::elements()) {
    if (std::any_of(Grammar::never().begin(), Grammar::never().end(),
                    [&](const Grammar::Never& never) { return never.element == element.name; }))
      continue;
    look(std::string(element.name));
    for (const schema::Attribute& a : element.attributes)
      if (!Grammar::leaves_out(element.name, a.name))
        look(fmt::format("{}@{}", element.name, a.name));
  }
  return all;
}

TEST(GrammarSlow, NoneThatPassesIsFarOff) {
  constexpr int models = 80;
  int passed = 0, ended_early = 0, seen = 0;
  double worst = 0.0;
  for (int seed = 0; seed < models; ++seed) {
    const Grammar grammar(static_cast<std::uint64_t>(seed));
    SCOPED_TRACE(fmt::format("model {}:\n{}", seed, grammar.text()));
    const GrammarTrial trial = try_two_integrators(grammar.text());
    EXPECT_EQ(trial.refusal, "") << "valid for reader and compile, and refused by the run";
    EXPECT_EQ(trial.fault(), "");
    passed += trial.passed ? 1 : 0;
    ended_early += trial.failure.empty() ? 0 : 1;
    if (trial.passed) worst = std::max(worst, trial.error);
    GrammarTrial wrong = trial;  // an estimate that is a fiftieth of what it should be is seen
    wrong.claimed *= 0.02;
    seen += wrong.fault().empty() ? 0 : 1;
  }
  EXPECT_GT(passed, models / 4);
  EXPECT_LT(ended_early, models / 20);
  EXPECT_GT(seen, passed / 4);
  hard::record({"9za", "valid models made at random from the schema", "tools/fuzz",
                "Radau, tolerance 1e-8",
                fmt::format("{} of {} pass their certificate, the worst of these {:.1g} of the "
                            "motion off (bound 0.1)",
                            passed, models, worst),
                "in the test: the estimate of the error in time times 0.02"});
}

TEST(GrammarSlow, SaysAllOfTheSchema) {
  constexpr std::uint64_t most = 300;
  std::set<std::string> said;
  for (const schema::Element& element : schema::elements()) {
    const auto is_left = [&] {
      return std::ranges::any_of(missing(said), [&](const std::string& what) {
        return what == element.name || what.starts_with(std::string(element.name) + "@");
      });
    };
    for (std::uint64_t seed = 0; seed < most && is_left(); ++seed) {
      const Grammar grammar(seed, element.name);
      said.insert(grammar.said().begin(), grammar.said().end());
    }
  }
  EXPECT_EQ(missing(said), std::set<std::string>());
}

TEST(Grammar, IsTheSameForTheSameSeed) {
  EXPECT_EQ(Grammar(7).text(), Grammar(7).text());
  EXPECT_NE(Grammar(7).text(), Grammar(8).text());
}

}  // namespace
}  // namespace mbd::test::test_grammar
