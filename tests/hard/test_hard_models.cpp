// Every model of models/hard runs to its end from its file and gives the numbers it expects.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "libmbd/language/reader.hpp"
#include "libmbd/results/summary.hpp"
#include "libmbd/run/run.hpp"

namespace mbd::test::test_hard_models {
namespace {

namespace fs = std::filesystem;
const fs::path models = fs::path(MBD_SOURCE_DIR) / "models" / "hard";

std::vector<std::string> all_models() {
  std::vector<std::string> names;
  if (fs::exists(models))
    for (const auto& entry : fs::directory_iterator(models))
      if (entry.path().extension() == ".xml") names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

class HardModels : public testing::TestWithParam<std::string> {};

TEST_P(HardModels, GiveWhatTheyExpect) {
  const Scene scene = read_model(models / (GetParam() + ".xml"));
  EXPECT_EQ(scene.name, GetParam());
  ASSERT_FALSE(scene.expects.empty()) << "a model is a test: give it <expect> rows";
  const RunReport report = run(scene);
  EXPECT_TRUE(report.complete()) << report.failure;
  EXPECT_TRUE(report.as_expected()) << summary(report);
}

GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(HardModels);
INSTANTIATE_TEST_SUITE_P(Every, HardModels, testing::ValuesIn(all_models()),
                         [](const auto& model) { return model.param; });

}  // namespace
}  // namespace mbd::test::test_hard_models
