// Files as such: a file that cannot be replaced leaves nothing beside it.

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "libmbd/core/error.hpp"
#include "libmbd/text/files.hpp"
#include "tests/support/temporary_directory.hpp"

namespace mbd::test::test_files {
namespace {

namespace fs = std::filesystem;

TEST(WriteFile, LeavesNothingBesideAFileItCannotReplace) {
  const TemporaryDirectory directory;
  const fs::path file = directory.path() / "report.json";
  fs::create_directories(file / "in_the_way");  // no file can take the name of a full directory
  try {
    write_file(file, "new");
    ADD_FAILURE() << "no error";
  } catch (const Error& error) {
    const std::string what = error.what();
    EXPECT_TRUE(what.starts_with(file.string() + ": cannot be written (")) << what;
    EXPECT_EQ(what.find("Success"), std::string::npos) << what;  // the reason of the rename
  }
  std::vector<fs::path> left;
  for (const fs::directory_entry& entry : fs::directory_iterator(directory.path()))
    left.push_back(entry.path().filename());
  EXPECT_EQ(left, std::vector<fs::path>{"report.json"});
  EXPECT_TRUE(fs::is_directory(file / "in_the_way"));
}

}  // namespace
}  // namespace mbd::test::test_files
