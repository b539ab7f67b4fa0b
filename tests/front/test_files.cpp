// Files as such: a file that cannot be replaced leaves nothing beside it.

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <vector>

#include "libmbd/core/error.hpp"
#include "libmbd/text/files.hpp"

namespace mbd::test::test_files {
namespace {

namespace fs = std::filesystem;

TEST(WriteFile, LeavesNothingBesideAFileItCannotReplace) {
  const fs::path directory =
      fs::temp_directory_path() / ("mbd_" + std::to_string(getpid()) + "_write_file");
  fs::remove_all(directory);
  const fs::path file = directory / "report.json";
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
  for (const fs::directory_entry& entry : fs::directory_iterator(directory))
    left.push_back(entry.path().filename());
  EXPECT_EQ(left, std::vector<fs::path>{"report.json"});
  EXPECT_TRUE(fs::is_directory(file / "in_the_way"));
  fs::remove_all(directory);
}

}  // namespace
}  // namespace mbd::test::test_files
