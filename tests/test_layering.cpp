// The rooms of the house: who may include whom, where third-party headers may appear, what may lie
// at the top level. The rules are the tables below; violations() applies them to a set of files;
// the tests apply it to small sets with one violation each, then to the repository's own sources.
//
// Includes are written from the root of the repository ("elements/beam.hpp"), so a line says by
// itself which room it enters; nothing has to be resolved.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace mbd::test::test_layering {
namespace {

namespace fs = std::filesystem;

struct SourceFile {
  std::string path;  // from the root of the repository, with '/'
  std::string text;
};

// ---- rules ------------------------------------------------------------------------------------

struct Room {
  std::string_view folder;
  int level;  // a file may include from its own room and from rooms of a lower level
};

constexpr std::array rooms{
    Room{"libmbd/core/", 0},  Room{"elements/", 1},     Room{"joints/", 2}, Room{"solvers/", 3},
    Room{"libmbd/front/", 4}, Room{"libmbd/study/", 5}, Room{"tools/", 6},  Room{"tests/", 6},
};
constexpr int outside_the_library = 6;                   // level of tools/ and tests/
constexpr std::string_view umbrella = "libmbd/mbd.hpp";  // includes the library, for its users

struct ThirdParty {
  std::string_view header;                // the beginning of what is included, or all of it
  std::vector<std::string_view> folders;  // where it may be included; none: nowhere
  bool cpp_only;                          // not in headers, so that users do not need it
  bool one_file;                          // in one file of the repository
};

const std::vector<ThirdParty>& third_parties() {
  static const std::vector<std::string_view> everywhere{""};
  static const std::vector<ThirdParty> table{
      {"tinyxml2.h", {"libmbd/front/"}, true, true},
      {"udunits2.h", {"libmbd/front/"}, true, true},
      {"klu.h", {"solvers/"}, true, true},
      {"suitesparse/klu.h", {"solvers/"}, true, true},
      {"dmumps_c.h", {"solvers/"}, true, true},
      {"kinsol/", {"solvers/"}, true, true},
      {"ida/", {"solvers/"}, true, true},
      {"nvector/", {"solvers/"}, true, false},
      {"sundials/", {"solvers/"}, true, false},
      {"CLI/", {"tools/"}, false, false},
      {"nlohmann/", {"libmbd/front/", "tools/", "tests/"}, true, false},
      {"fmt/", everywhere, true, false},
      {"gtest/", {"tests/"}, false, false},
      {"gmock/", {"tests/"}, false, false},
      {"benchmark/", {"tools/"}, false, false},
      // under the GPL
      {"umfpack.h", {}, true, false},
      {"suitesparse/umfpack.h", {}, true, false},
      {"SuiteSparseQR", {}, true, false},
      {"suitesparse/SuiteSparseQR", {}, true, false},
      {"Eigen/UmfPackSupport", {}, true, false},
      {"Eigen/SPQRSupport", {}, true, false},
      {"Eigen/CholmodSupport", {}, true, false},  // its supernodal part
  };
  return table;
}

const std::set<std::string_view> top_level{
    "libmbd", "joints",         "elements",  "solvers",           "models",  "tests",  "tools",
    "build",  "CMakeLists.txt", "README.md", "CMakePresets.json", "LICENSE", "results"};

// What only exists on a developer's machine. In pieces, so that this file does not contain it.
const std::vector<std::string> outside_paths{
    "../"
    "shared",
    "/work"
    "/"};

// ---- checks -----------------------------------------------------------------------------------

bool begins_with_any(std::string_view path, const std::vector<std::string_view>& folders) {
  return std::any_of(folders.begin(), folders.end(),
                     [&](std::string_view folder) { return path.starts_with(folder); });
}

const Room* room_of(std::string_view path) {
  const auto* room = std::find_if(rooms.begin(), rooms.end(),
                                  [&](const Room& r) { return path.starts_with(r.folder); });
  return room == rooms.end() ? nullptr : room;
}

bool is_cpp(std::string_view path) { return path.ends_with(".cpp"); }

bool is_source(std::string_view path) {
  static const std::set<std::string, std::less<>> extensions{
      ".hpp", ".cpp", ".h", ".hh", ".hxx", ".c", ".cc", ".cxx", ".ipp", ".inl", ".tpp"};
  return extensions.contains(fs::path(path).extension().string());
}

struct Include {
  int line;
  bool quoted;
  std::string name;
};

// `#include "name"` or `#include <name>` at the beginning of a line, with any blanks
std::optional<Include> parse_include(std::string_view text, int line) {
  const auto skip_blanks = [&] {
    text.remove_prefix(std::min(text.find_first_not_of(" \t"), text.size()));
  };
  for (const std::string_view word : {"#", "include"}) {
    skip_blanks();
    if (!text.starts_with(word)) return std::nullopt;
    text.remove_prefix(word.size());
  }
  skip_blanks();
  if (text.empty() || (text[0] != '"' && text[0] != '<')) return std::nullopt;
  const bool quoted = text[0] == '"';
  const auto end = text.find(quoted ? '"' : '>', 1);
  if (end == std::string_view::npos) return std::nullopt;
  return Include{line, quoted, std::string(text.substr(1, end - 1))};
}

std::vector<Include> includes_of(const std::string& text) {
  std::vector<Include> found;
  std::istringstream stream(text);
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    if (auto include = parse_include(line, number)) found.push_back(std::move(*include));
  }
  return found;
}

// What is wrong with entering the room of `target` from `path`; empty when nothing is
std::string room_violation(std::string_view path, std::string_view target) {
  const Room* from = room_of(path);
  const Room* to = room_of(target);
  const bool library_user = from != nullptr && from->level == outside_the_library;
  if (target == umbrella) {
    return library_user ? "" : "the umbrella is for users of the library; include what is needed";
  }
  if (path == umbrella) {
    return to != nullptr && to->level < outside_the_library
               ? ""
               : "the umbrella takes in the library only";
  }
  if (to == nullptr) return "no such room";
  if (from == to) return "";
  if (to->level == outside_the_library) return "tools/ and tests/ are included by nobody else";
  if (to->level > from->level) {
    return std::string(to->folder) + " comes after " + std::string(from->folder) +
           "; move what is needed to an earlier room";
  }
  return "";
}

std::vector<std::string> violations(const std::vector<SourceFile>& files) {
  std::vector<std::string> found;
  std::map<std::string_view, std::string> first_user;  // of headers that one file may include
  const auto base_name = [](std::string_view header) {
    return header.substr(header.starts_with("suitesparse/") ? 12 : 0);
  };

  for (const SourceFile& file : files) {
    for (const std::string& outside : outside_paths) {
      const auto at = file.text.find(outside);
      if (at == std::string::npos) continue;
      const auto line = 1 + std::count(file.text.begin(),
                                       file.text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
      found.push_back(file.path + ":" + std::to_string(line) + ": mentions " + outside +
                      ", which is outside the repository");
    }

    if (!is_source(file.path)) continue;
    if (!is_cpp(file.path) && !file.path.ends_with(".hpp")) {
      found.push_back(file.path + ": sources end in .hpp or .cpp");
    }
    if (room_of(file.path) == nullptr && file.path != umbrella) {
      found.push_back(file.path + ": is in no room");
      continue;
    }

    for (const Include& include : includes_of(file.text)) {
      const std::string where =
          file.path + ":" + std::to_string(include.line) + ": includes " + include.name + ": ";
      const bool ours = room_of(include.name) != nullptr || include.name.starts_with("libmbd/");
      const bool is_users = file.path.starts_with("tools/example/");  // uses the installed library
      if (ours != include.quoted && !is_users) {
        found.push_back(where +
                        (ours ? "write our own headers in quotes"
                              : "quotes are for our own headers, written from the root of the "
                                "repository"));
      }
      if (ours) {
        if (const std::string wrong = room_violation(file.path, include.name); !wrong.empty()) {
          found.push_back(where + wrong);
        }
        continue;
      }
      for (const ThirdParty& party : third_parties()) {
        if (!include.name.starts_with(party.header)) continue;
        if (!begins_with_any(file.path, party.folders)) {
          found.push_back(where + "not allowed here");
        } else if (party.cpp_only && !is_cpp(file.path)) {
          found.push_back(where + "allowed in .cpp files only");
        } else if (party.one_file) {
          const auto user = first_user.try_emplace(base_name(party.header), file.path).first;
          if (user->second != file.path) {
            found.push_back(where + "already included by " + user->second + ", and one is enough");
          }
        }
      }
    }
  }
  return found;
}

std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + '\n';
  return text;
}

std::string include(const std::string& name) { return "#include " + name + "\n"; }

bool is_hidden(const fs::path& path) { return path.filename().string().starts_with('.'); }

// All files of the repository, without what is ignored (build/, results/) and git's own
std::vector<SourceFile> read_repository(const fs::path& root) {
  const std::set<std::string> left_out{".git", ".cache", ".vscode", ".idea", "build", "results"};
  std::vector<SourceFile> files;
  for (auto entry = fs::recursive_directory_iterator(root);
       entry != fs::recursive_directory_iterator(); ++entry) {
    const std::string path = fs::relative(entry->path(), root).generic_string();
    if (entry.depth() == 0 && left_out.contains(path)) {
      entry.disable_recursion_pending();
      continue;
    }
    if (!entry->is_regular_file()) continue;
    std::ifstream stream(entry->path(), std::ios::binary);
    files.push_back({path, {std::istreambuf_iterator<char>(stream), {}}});
  }
  return files;
}

// ---- the checks find what they should ---------------------------------------------------------

struct Case {
  std::string what;
  std::vector<SourceFile> files;
};

TEST(Layering, AcceptsWhatIsAllowed) {
  const std::vector<SourceFile> files{
      {"libmbd/core/se3.hpp", include("\"libmbd/core/so3.hpp\"") + include("<Eigen/Core>")},
      {"elements/beam.hpp",
       include("\"libmbd/core/se3.hpp\"") + include("\"elements/section.hpp\"")},
      {"joints/revolute.hpp", include("\"elements/rigid_body.hpp\"")},
      {"solvers/klu_solver.cpp", include("<suitesparse/klu.h>") + include("<fmt/format.h>")},
      {"libmbd/front/xml_reader.cpp", include("<tinyxml2.h>") + include("\"solvers/newton.hpp\"")},
      {"libmbd/front/report.cpp", include("<nlohmann/json.hpp>")},
      {"libmbd/mbd.hpp", include("\"libmbd/front/compile.hpp\"")},
      {"tools/mbd/main.cpp", include("\"libmbd/mbd.hpp\"") + include("<CLI/CLI.hpp>")},
      {"tests/test_beam.cpp", include("\"tests/laws.hpp\"") + include("<gtest/gtest.h>")},
      {"README.md", "Some text.\n"},
  };
  EXPECT_EQ(joined(violations(files)), "");
}

TEST(Layering, FindsEachViolation) {
  const std::vector<Case> cases{
      {"earlier room includes later room",
       {{"elements/beam.hpp", "// text\n" + include("\"joints/revolute.hpp\"")}}},
      {"core includes front", {{"libmbd/core/state.cpp", include("\"libmbd/front/scene.hpp\"")}}},
      {"blanks do not hide it", {{"elements/a.hpp", " #  include  \"solvers/newton.hpp\"\n"}}},
      {"library includes a test", {{"solvers/newton.cpp", include("\"tests/laws.hpp\"")}}},
      {"a test includes a tool", {{"tests/test_beam.cpp", include("\"tools/mbd/plot.hpp\"")}}},
      {"library includes the umbrella", {{"solvers/newton.cpp", include("\"libmbd/mbd.hpp\"")}}},
      {"umbrella includes a tool", {{"libmbd/mbd.hpp", include("\"tools/mbd/plot.hpp\"")}}},
      {"include not from the root", {{"elements/beam.hpp", include("\"section.hpp\"")}}},
      {"include through a parent", {{"elements/beam.hpp", include("\"../joints/revolute.hpp\"")}}},
      {"own header in angle brackets", {{"elements/a.hpp", include("<libmbd/core/se3.hpp>")}}},
      {"source outside the rooms", {{"libmbd/extra.hpp", "\n"}}},
      {"include of no room", {{"elements/a.hpp", include("\"libmbd/extra.hpp\"")}}},
      {"foreign extension", {{"elements/a.h", "\n"}}},
      {"XML in the core", {{"libmbd/core/a.cpp", include("<tinyxml2.h>")}}},
      {"XML in a header", {{"libmbd/front/a.hpp", include("<tinyxml2.h>")}}},
      {"two XML readers",
       {{"libmbd/front/a.cpp", include("<tinyxml2.h>")},
        {"libmbd/front/b.cpp", include("<tinyxml2.h>")}}},
      {"two users of KLU, two spellings",
       {{"solvers/a.cpp", include("<klu.h>")}, {"solvers/b.cpp", include("<suitesparse/klu.h>")}}},
      {"command line in the library", {{"libmbd/front/a.cpp", include("<CLI/CLI.hpp>")}}},
      {"JSON in a header", {{"libmbd/front/a.hpp", include("<nlohmann/json.hpp>")}}},
      {"JSON in a kernel", {{"elements/a.cpp", include("<nlohmann/json.hpp>")}}},
      {"fmt in a header", {{"libmbd/core/error.hpp", include("<fmt/format.h>")}}},
      {"GPL", {{"solvers/a.cpp", include("<Eigen/SPQRSupport>")}}},
      {"path outside, relative", {{"README.md", "line\nsee " + outside_paths[0] + "/x\n"}}},
      {"path outside, absolute", {{"tools/run", outside_paths[1] + "main\n"}}},
  };
  for (const Case& c : cases) {
    EXPECT_EQ(violations(c.files).size(), 1U) << c.what << "\n" << joined(violations(c.files));
  }
}

TEST(Layering, SaysWhereAndWhy) {
  const auto found =
      violations({{"elements/beam.hpp", "// text\n" + include("\"joints/revolute.hpp\"")}});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(
      found[0],
      "elements/beam.hpp:2: includes joints/revolute.hpp: joints/ comes after elements/; move "
      "what is needed to an earlier room");
}

// ---- the repository ---------------------------------------------------------------------------

TEST(Layering, RepositoryKeepsToItsRooms) {
  const auto files = read_repository(MBD_SOURCE_DIR);
  const auto sources = std::count_if(files.begin(), files.end(),
                                     [](const SourceFile& file) { return is_source(file.path); });
  EXPECT_GT(sources, 1) << "the repository was not found in " << MBD_SOURCE_DIR;
  EXPECT_EQ(joined(violations(files)), "");
}

TEST(Layering, NothingElseAtTheTopLevel) {
  for (const auto& entry : fs::directory_iterator(MBD_SOURCE_DIR)) {
    const std::string name = entry.path().filename().string();
    EXPECT_TRUE(is_hidden(entry.path()) || top_level.contains(name))
        << name << " is not one of the names at the top level; it belongs in a room";
  }
}

}  // namespace
}  // namespace mbd::test::test_layering
