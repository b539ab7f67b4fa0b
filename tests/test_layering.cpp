// The rooms of the house: who may include whom, where third-party headers may appear, what may lie
// at the top level; and how long a function may be. The rules are the tables below; violations() and
// too_long() apply them to a set of files; the tests apply these to small sets with one violation
// each, then to the repository's own sources.
//
// Includes are written from the root of the repository ("elements/beam.hpp"), so a line says by
// itself which room it enters; nothing has to be resolved.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cctype>
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

// A room is the files of its folder and of the folders in it that are no rooms of their own; or one file.
struct Room {
  std::string_view folder;
  std::vector<std::string_view> uses;  // earlier rooms; of a folder of rooms: all of them
};

constexpr std::string_view plugin_interface =
    "libmbd/plugin.h";  // of C, for those who write plug-ins
constexpr std::string_view solvers = "solvers/", study = "libmbd/study/";

// Each room uses itself and rooms above it only. Scenes are plain data: they know neither kernels nor solvers; and
// what computes knows nothing of scenes.
const std::vector<Room>& rooms() {
  static const std::vector<Room> table = [] {
    const std::vector<std::string_view> core{"libmbd/core/"};
    const auto with = [](std::vector<std::string_view> some,
                         std::initializer_list<std::string_view> more) {
      some.insert(some.end(), more);
      return some;
    };
    const auto elements = with(core, {"elements/"}), joints = with(elements, {"joints/"});
    const auto newton = with(joints, {"solvers/newton/"});
    const auto constraints = with(newton, {"solvers/linear/", "solvers/constraints/"});
    const auto scene = with(core, {"libmbd/text/", "libmbd/scene/"});
    const auto material = with(scene, {"libmbd/section/", "libmbd/material/"});
    const auto language = with(material, {"joints/", "libmbd/language/"});
    const auto compile =
        with(language, {"elements/", "elements/beam/", "elements/node/", "elements/pair/",
                        "elements/component/", solvers, plugin_interface, "libmbd/compile/"});
    const auto results = with(compile, {"libmbd/results/"});
    const auto pictures = with(results, {"libmbd/pictures/"});
    const auto view = with(results, {"libmbd/view/"});
    const auto run = with(pictures, {"libmbd/view/", "libmbd/run/"});
    const auto trial = with(run, {"libmbd/study/trial/"});
    const auto accuracy = with(trial, {"libmbd/study/accuracy/"});
    const auto library = with(accuracy, {study});
    return std::vector<Room>{
        {"libmbd/core/", {}},
        {"libmbd/text/", core},
        {"libmbd/section/", core},
        {"elements/", core},
        {"elements/beam/", elements},
        {"elements/node/", elements},
        {"elements/pair/", elements},
        {"elements/component/", with(elements, {"elements/node/", "elements/pair/"})},
        {"joints/", with(elements, {"elements/pair/"})},
        {"solvers/newton/", joints},
        {"solvers/linear/", newton},
        {"solvers/constraints/", constraints},
        {"solvers/statics/", constraints},
        {"solvers/laws/", core},
        {"solvers/time/", with(constraints, {"solvers/laws/"})},
        {"solvers/modes/", with(constraints, {"solvers/statics/", "elements/component/"})},
        {"libmbd/scene/", scene},
        {"libmbd/material/", material},
        {"libmbd/language/", language},
        {plugin_interface, {}},
        {"libmbd/compile/", compile},
        {"libmbd/results/", results},
        {"libmbd/pictures/", pictures},
        {"libmbd/view/", view},
        {"libmbd/run/", run},
        {"libmbd/study/trial/", trial},
        {"libmbd/study/accuracy/", accuracy},
        {"libmbd/study/effects/", accuracy},
        {"libmbd/study/sweep/", run},
        {"libmbd/study/modes/", with(trial, {"libmbd/study/sweep/"})},
        {"libmbd/study/trust/", trial},
        {"tools/", library},
        {"tests/", with(library, {"libmbd/section/"})},
    };
  }();
  return table;
}
bool is_outside_the_library(const Room& room) {
  return room.folder == "tools/" || room.folder == "tests/";
}
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
      {"tinyxml2.h", {"libmbd/language/"}, true, true},
      {"udunits2.h", {"libmbd/language/"}, true, true},
      {"hdf5.h", {"libmbd/view/"}, true, true},
      {"assimp/", {"libmbd/material/"}, true, true},
      {"zlib.h", {"libmbd/view/"}, true, false},
      {"klu.h", {"solvers/linear/", "tests/faults/"}, true, true},
      {"suitesparse/klu.h", {"solvers/linear/"}, true, true},
      {"dmumps_c.h", {"solvers/linear/"}, true, true},
      {"kinsol/", {"solvers/statics/"}, true, true},
      {"ida/", {"solvers/time/"}, true, true},
      {"nvector/", {"solvers/newton/sundials.hpp"}, false, true},
      {"sundials/", {"solvers/newton/sundials.hpp"}, false, true},
      {"solvers/newton/sundials.hpp",  // ours
       {"solvers/time/ida.cpp", "solvers/statics/kinsol.cpp"},
       true,
       false},
      {"CLI/", {"tools/"}, false, false},
      {"nlohmann/",
       {"libmbd/results/", "libmbd/pictures/", "libmbd/view/", "libmbd/run/", "libmbd/study/",
        "tools/", "tests/"},
       true,
       false},
      {"png.h", {"tools/mbd/"}, true, true},
      {"webp/encode.h", {"tools/mbd/"}, true, true},
      {"webp/mux.h", {"tools/mbd/"}, true, true},
      {"fmt/", everywhere, true, false},
      {"gtest/", {"tests/"}, false, false},
      {"gmock/", {"tests/"}, false, false},
      {"benchmark/", {"tools/"}, false, false},
      {"pybind11/", {"tools/python/"}, false, false},
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

const std::set<std::string_view> top_level{"libmbd",
                                           "joints",
                                           "elements",
                                           "solvers",
                                           "models",
                                           "tests",
                                           "tools",
                                           "build",
                                           "CMakeLists.txt",
                                           "README.md",
                                           "CMakePresets.json",
                                           "LICENSE",
                                           "results",
                                           "pyproject.toml"};

// What only exists on a developer's machine. In pieces, so that this file does not contain it.
const std::vector<std::string> outside_paths{
    "../"
    "shared",
    "/work"
    "/"};

// A function is read at one glance: its pieces have names.
constexpr std::ptrdiff_t most_lines = 60;  // from its opening to its closing brace
const std::vector<std::string_view> of_short_functions{"libmbd/", "joints/", "elements/",
                                                       "solvers/", "tools/mbd/"};

// Those that are longer all the same.
struct LongFunction {
  std::string_view path, name;  // as written where it is defined
  std::string_view reason;
};
const std::vector<LongFunction> long_functions{};  // none

// ---- checks -----------------------------------------------------------------------------------

bool begins_with_any(std::string_view path, const std::vector<std::string_view>& folders) {
  return std::any_of(folders.begin(), folders.end(),
                     [&](std::string_view folder) { return path.starts_with(folder); });
}

const Room* room_of(std::string_view path) {
  const Room* best = nullptr;
  for (const Room& room : rooms())
    if (path.starts_with(room.folder) &&
        (best == nullptr || room.folder.size() > best->folder.size()))
      best = &room;
  return best;
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
  if (target == umbrella) {
    return from != nullptr && is_outside_the_library(*from)
               ? ""
               : "the umbrella is for users of the library; include what is needed";
  }
  if (path == umbrella) {
    return to != nullptr && !is_outside_the_library(*to) ? ""
                                                         : "the umbrella takes in the library only";
  }
  if (to == nullptr) return "no such room";
  if (from == to) return "";
  if (is_outside_the_library(*to)) return "tools/ and tests/ are included by nobody else";
  if (std::none_of(from->uses.begin(), from->uses.end(), [&](std::string_view used) {
        return used == to->folder ||
               ((used == solvers || used == study) && to->folder.starts_with(used));
      }))
    return std::string(from->folder) + " does not use " + std::string(to->folder) +
           "; move what is needed to a room that both use";
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
    if (!is_cpp(file.path) && !file.path.ends_with(".hpp") && file.path != plugin_interface) {
      found.push_back(file.path + ": sources end in .hpp or .cpp");
    }
    if (room_of(file.path) == nullptr && file.path != umbrella) {
      found.push_back(file.path + ": is in no room");
      continue;
    }

    // What a program that uses the library should know is in reports and errors.
    if (const Room* const room = room_of(file.path);
        room != nullptr && !is_outside_the_library(*room))
      for (const std::string_view stream :
           {"std::cerr", "std::cout", "std::clog", "stderr", "fmt::print", "perror"})
        if (file.text.find(stream) != std::string::npos)
          found.push_back(file.path + ": the library writes to no stream: " + std::string(stream));

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
      }
      for (const ThirdParty& party : third_parties()) {
        if (!include.name.starts_with(party.header)) continue;
        if (!begins_with_any(file.path, party.folders)) {
          found.push_back(where + "not allowed here");
        } else if (party.cpp_only && !is_cpp(file.path)) {
          found.push_back(where + "allowed in .cpp files only");
        } else if (party.one_file && !file.path.starts_with("tests/faults/")) {  // stands in for it
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

struct Function {
  std::string name;
  std::ptrdiff_t line, lines;  // of its opening brace; from that to the closing one
};

// `Newton::iterate` of "bool Newton::iterate(int k) {"; "lambda" of what has no name before its parentheses
std::string name_in(const std::string& head) {
  const auto end = head.find('(');
  const auto before = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
           std::string_view("_:~<>").find(c) != std::string_view::npos;
  };
  auto begin = end;
  while (begin != std::string::npos && begin > 0 && before(head[begin - 1])) --begin;
  return end == std::string::npos || begin == end ? "lambda" : head.substr(begin, end - begin);
}

// `class`, or a word like it, begins what follows `template <...>`.
bool begins_with(std::string_view head, std::initializer_list<std::string_view> words) {
  if (head.starts_with("template <")) {
    std::size_t at = 9;
    int depth = 0;
    do depth += head[at] == '<' ? 1 : head[at] == '>' ? -1 : 0;
    while (++at < head.size() && depth > 0);
    head.remove_prefix(std::min(head.find_first_not_of(' ', at), head.size()));
  }
  return std::any_of(words.begin(), words.end(),
                     [&](std::string_view word) { return head.starts_with(word); });
}

// Lines without what stands in raw strings and behind code as a comment
std::vector<std::string> code_lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  std::string raw_end;  // of the raw string that a line begins in
  for (std::string line; std::getline(stream, line);) {
    if (!raw_end.empty()) {
      const auto end = line.find(raw_end);
      const bool ends = end != std::string::npos;
      line = ends ? std::string(100, ' ') + line.substr(end + raw_end.size()) : std::string();
      if (ends) raw_end.clear();
    }
    if (const auto raw = line.find("R\"");
        raw != std::string::npos &&
        (raw == 0 || std::string_view(" ({").find(line[raw - 1]) != std::string_view::npos)) {
      const auto open = std::min(line.find('(', raw), line.size());
      raw_end = ')' + line.substr(raw + 2, open - raw - 2) + '"';
      if (line.find(raw_end, open) != std::string::npos) raw_end.clear();
    }
    line.erase(std::min(line.find("  // "), line.size()));
    line.erase(line.find_last_not_of(' ') + 1);
    lines.push_back(line);
  }
  return lines;
}

// Functions of a source in the layout of clang-format (tools/format): what stands in a namespace begins in the first column, what
// stands in a class two farther in, and a block is closed in the column in which what opens it begins.
std::vector<Function> functions_of(const std::string& text) {
  const std::vector<std::string> lines = code_lines(text);
  const auto column = [](const std::string& line) {
    return std::min(line.find_first_not_of(' '), line.size());
  };
  std::vector<Function> found;
  std::size_t level = 0;  // column of what stands in the present namespace or class
  std::string head;       // what has been read of a declaration
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::string& line = lines[i];
    const std::size_t at = column(line);
    if (at == line.size() || line[at] == '#' || line.compare(at, 2, "//") == 0) continue;
    if (head.empty() && line[at] == '}') {
      if (at + 2 == level) level = at;
      continue;
    }
    if (at < level) continue;  // public: and its like
    head += (head.empty() ? "" : " ") + line.substr(at);
    const bool opens = head.ends_with("{");
    if (opens && begins_with(head, {"class ", "struct ", "union "})) {
      level += 2;
    } else if (opens && !begins_with(head, {"namespace", "inline namespace", "extern \"C\""})) {
      const std::size_t begin = i;
      const auto is_inside = [&](const std::string& l) {
        return l.empty() || l[0] == '#' || column(l) > level;
      };
      while (i + 1 < lines.size() && is_inside(lines[i + 1])) ++i;
      if (i + 1 < lines.size() && column(lines[i + 1]) == level && lines[i + 1][level] == '}') ++i;
      if (head.ends_with(") {") || head.ends_with("const {") || head.ends_with("override {") ||
          head.ends_with("noexcept {") || head.find("-> ") != std::string::npos ||
          head.find(") : ") != std::string::npos)
        found.push_back({name_in(head), static_cast<std::ptrdiff_t>(begin) + 1,
                         static_cast<std::ptrdiff_t>(i - begin) + 1});
    }
    if (opens || head.ends_with("}") || head.ends_with(";")) head.clear();
  }
  return found;
}

// Functions that are too long, but for those that may be.
std::vector<std::string> too_long(const std::vector<SourceFile>& files,
                                  const std::vector<LongFunction>& allowed) {
  std::vector<std::string> found;
  std::set<const LongFunction*> met;
  for (const SourceFile& file : files) {
    if (!is_source(file.path) || !begins_with_any(file.path, of_short_functions)) continue;
    for (const Function& function : functions_of(file.text)) {
      if (function.lines <= most_lines) continue;
      const auto one = std::find_if(allowed.begin(), allowed.end(), [&](const LongFunction& may) {
        return may.path == file.path && may.name == function.name;
      });
      if (one != allowed.end())
        met.insert(&*one);
      else
        found.push_back(file.path + ":" + std::to_string(function.line) + ": " + function.name +
                        " has " + std::to_string(function.lines) + " lines, more than " +
                        std::to_string(most_lines) + "; divide it into pieces with names");
    }
  }
  for (const LongFunction& may : allowed)
    if (!met.contains(&may))
      found.push_back(std::string(may.path) + ": " + std::string(may.name) +
                      " is listed as a long function, and is none; take it off the list");
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
      {"solvers/linear/klu_solver.cpp", include("<suitesparse/klu.h>") + include("<fmt/format.h>")},
      {"solvers/newton/sundials.hpp", include("<sundials/sundials_matrix.h>")},
      {"solvers/time/ida.cpp", include("<ida/ida.h>") + include("\"solvers/newton/sundials.hpp\"")},
      {"libmbd/language/xml_reader.cpp",
       include("<tinyxml2.h>") + include("\"joints/joint_list.hpp\"")},
      {"libmbd/results/report.cpp", include("<nlohmann/json.hpp>")},
      {"libmbd/study/accuracy/accuracy_report.cpp",
       include("\"libmbd/text/text.hpp\"") + include("<nlohmann/json.hpp>")},
      {"libmbd/mbd.hpp", include("\"libmbd/compile/compile.hpp\"")},
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
      {"core includes a scene", {{"libmbd/core/state.cpp", include("\"libmbd/scene/scene.hpp\"")}}},
      {"a scene includes a kernel",
       {{"libmbd/scene/scene.hpp", include("\"elements/element.hpp\"")}}},
      {"a kernel includes a scene",
       {{"elements/element.hpp", include("\"libmbd/scene/scene.hpp\"")}}},
      {"the language includes a solver",
       {{"libmbd/language/a.cpp", include("\"solvers/time/radau.hpp\"")}}},
      {"statics include steps in time",
       {{"solvers/statics/a.cpp", include("\"solvers/time/radau.hpp\"")}}},
      {"trust includes effects",
       {{"libmbd/study/trust/a.cpp", include("\"libmbd/study/effects/a.hpp\"")}}},
      {"blanks do not hide it",
       {{"elements/beam/a.hpp", " #  include  \"joints/revolute.hpp\"\n"}}},
      {"a run includes a study",
       {{"libmbd/run/run.cpp", include("\"libmbd/study/trial/trial.hpp\"")}}},
      {"XML in a study", {{"libmbd/study/trial/a.cpp", include("<tinyxml2.h>")}}},
      {"JSON in a header of a study",
       {{"libmbd/study/trial/a.hpp", include("<nlohmann/json.hpp>")}}},
      {"library includes a test", {{"solvers/newton/newton.cpp", include("\"tests/laws.hpp\"")}}},
      {"a test includes a tool", {{"tests/test_beam.cpp", include("\"tools/mbd/plot.hpp\"")}}},
      {"library includes the umbrella",
       {{"solvers/newton/newton.cpp", include("\"libmbd/mbd.hpp\"")}}},
      {"umbrella includes a tool", {{"libmbd/mbd.hpp", include("\"tools/mbd/plot.hpp\"")}}},
      {"include not from the root", {{"elements/beam.hpp", include("\"section.hpp\"")}}},
      {"include through a parent", {{"elements/beam.hpp", include("\"../joints/revolute.hpp\"")}}},
      {"own header in angle brackets", {{"elements/a.hpp", include("<libmbd/core/se3.hpp>")}}},
      {"source outside the rooms", {{"libmbd/extra.hpp", "\n"}}},
      {"include of no room", {{"elements/a.hpp", include("\"libmbd/extra.hpp\"")}}},
      {"foreign extension", {{"elements/a.h", "\n"}}},
      {"XML in the core", {{"libmbd/core/a.cpp", include("<tinyxml2.h>")}}},
      {"XML in a header", {{"libmbd/language/a.hpp", include("<tinyxml2.h>")}}},
      {"the library writes to a stream",
       {{"solvers/time/a.cpp", "void f() { std::cerr << 1; }\n"}}},
      {"the library prints", {{"libmbd/run/a.cpp", "void f() { fmt::print(\"a\"); }\n"}}},
      {"two XML readers",
       {{"libmbd/language/a.cpp", include("<tinyxml2.h>")},
        {"libmbd/language/b.cpp", include("<tinyxml2.h>")}}},
      {"two users of KLU, two spellings",
       {{"solvers/linear/a.cpp", include("<klu.h>")},
        {"solvers/linear/b.cpp", include("<suitesparse/klu.h>")}}},
      {"SUNDIALS in another header",
       {{"solvers/time/a.hpp", include("<nvector/nvector_serial.h>")}}},
      {"SUNDIALS in another solver",
       {{"solvers/time/a.cpp", include("\"solvers/newton/sundials.hpp\"")}}},
      {"command line in the library", {{"libmbd/results/a.cpp", include("<CLI/CLI.hpp>")}}},
      {"JSON in a header", {{"libmbd/results/a.hpp", include("<nlohmann/json.hpp>")}}},
      {"JSON in a kernel", {{"elements/a.cpp", include("<nlohmann/json.hpp>")}}},
      {"fmt in a header", {{"libmbd/core/error.hpp", include("<fmt/format.h>")}}},
      {"GPL", {{"solvers/time/a.cpp", include("<Eigen/SPQRSupport>")}}},
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
      "elements/beam.hpp:2: includes joints/revolute.hpp: elements/ does not use joints/; move "
      "what is needed to a room that both use");
}

// A body of that many lines, braces included.
std::string block(int lines, const std::string& indent = "") {
  std::string text = " {\n";
  for (int i = 2; i < lines; ++i) text += indent + "  f({1}, [] { return 2; });\n";
  return text + indent + "}\n";
}

TEST(Layering, FindsLongFunctions) {
  const auto names = [](const std::string& text) {
    std::vector<std::string> found;
    for (const std::string& line : too_long({{"solvers/newton/a.cpp", text}}, {}))
      found.push_back(line.substr(0, line.find(" lines")));
    return found;
  };
  const std::string where = "solvers/newton/a.cpp:";
  using Names = std::vector<std::string>;
  EXPECT_EQ(names("int f(int x)" + block(60)), Names{});
  EXPECT_EQ(names("int f(int x)" + block(61)), Names{where + "1: f has 61"});
  EXPECT_EQ(names("namespace mbd {\nnamespace {\n\n// f\nvoid A::f(int x,\n       int y) const" +
                  block(62) + "\n}  // namespace\n"),
            Names{where + "6: A::f has 62"});
  EXPECT_EQ(names("class A : public B {\n public:\n  A() = default;\n  struct C {\n    int c;\n"
                  "    bool f() const" +
                  block(70, "    ") + "  };\n\n private:\n  A(int x)\n      : x_(x)" +
                  block(63, "  ") + "  int x_;\n};\n\nvoid g()" + block(64)),
            (Names{where + "6: f has 70", where + "80: A has 63", where + "146: g has 64"}));
  EXPECT_EQ(names("template <class T, class U = A<B<int>>>\nstruct A {\n  void f()" +
                  block(61, "  ") + "};\n"),
            Names{where + "3: f has 61"});
  EXPECT_EQ(names("void f() {\n#pragma x\n  g(R\"(\n}\n)\");\n" + block(60).substr(3)),
            Names{where + "1: f has 64"});
  EXPECT_EQ(names("constexpr auto f = [](int x)" + block(61)).size(), 1U);
  EXPECT_EQ(names("constexpr int table[] =" + block(100)), Names{});
  EXPECT_EQ(too_long({{"tests/a.cpp", "int f()" + block(100)}}, {}), Names{});
}

TEST(Layering, TheListOfLongFunctionsDoesNotRot) {
  const std::vector<LongFunction> allowed{{"libmbd/run/a.cpp", "f", "for a reason"}};
  EXPECT_EQ(joined(too_long({{"libmbd/run/a.cpp", "int f()" + block(61)}}, allowed)), "");
  for (const std::string& text : {"int f()" + block(60), std::string("int g();\n")}) {
    EXPECT_EQ(
        joined(too_long({{"libmbd/run/a.cpp", text}}, allowed)),
        "libmbd/run/a.cpp: f is listed as a long function, and is none; take it off the list\n");
  }
}

// ---- the repository ---------------------------------------------------------------------------

TEST(Layering, RepositoryKeepsToItsRooms) {
  const auto files = read_repository(MBD_SOURCE_DIR);
  const auto sources = std::count_if(files.begin(), files.end(),
                                     [](const SourceFile& file) { return is_source(file.path); });
  EXPECT_GT(sources, 1) << "the repository was not found in " << MBD_SOURCE_DIR;
  EXPECT_EQ(joined(violations(files)), "");
}

TEST(Layering, RoomsAreListedAfterThoseTheyUse) {
  std::set<std::string_view> before;
  for (const Room& room : rooms()) {
    for (const std::string_view used : room.uses)
      EXPECT_TRUE(used == room.folder || used == solvers || used == study || before.contains(used))
          << room.folder << " uses " << used;
    before.insert(room.folder);
  }
}

// So many that one can still look around in it.
TEST(Layering, NoRoomIsTooLarge) {
  std::map<const Room*, std::pair<int, std::ptrdiff_t>> sizes;
  for (const SourceFile& file : read_repository(MBD_SOURCE_DIR)) {
    const Room* const room = room_of(file.path);
    if (room == nullptr || is_outside_the_library(*room) || !is_source(file.path)) continue;
    auto& [count, lines] = sizes[room];
    ++count;
    lines += std::count(file.text.begin(), file.text.end(), '\n');
  }
  for (const auto& [room, size] : sizes) {
    EXPECT_LE(size.first, 30) << room->folder;
    EXPECT_LE(size.second, 6000) << room->folder;
  }
}

TEST(Layering, FunctionsAreShort) {
  EXPECT_EQ(joined(too_long(read_repository(MBD_SOURCE_DIR), long_functions)), "");
  for (const LongFunction& one : long_functions) EXPECT_FALSE(one.reason.empty()) << one.name;
}

// Files of the library and the program that hold a text.
std::string holders_of(const std::vector<SourceFile>& files, std::string_view text) {
  std::vector<std::string> paths;
  for (const SourceFile& file : files)
    if (begins_with_any(file.path, of_short_functions) && is_source(file.path) &&
        file.text.find(text) != std::string::npos)
      paths.push_back(file.path);
  std::sort(paths.begin(), paths.end());
  return joined(paths);
}

TEST(Layering, OneWriterOfSvg) {
  const std::string svg = "f(\"<svg xmlns=\\\"\")";
  EXPECT_EQ(holders_of({{"libmbd/run/b.cpp", svg}, {"tools/mbd/a.hpp", svg}, {"tests/c.cpp", svg}},
                       "<svg"),
            "libmbd/run/b.cpp\ntools/mbd/a.hpp\n");
  const std::vector<SourceFile> files = read_repository(MBD_SOURCE_DIR);
  for (const std::string_view written : {"<svg ", "<text ", "<line ", "<circle "})
    EXPECT_EQ(holders_of(files, written), "libmbd/text/svg.cpp\n") << written;
}

// Precompiled headers hide it from those who build with the presets, and from nobody else.
TEST(Layering, LibrariesAreIncludedWhereTheyAreUsed) {
  const auto lacking = [](const std::vector<SourceFile>& files) {
    std::string paths;
    for (const SourceFile& file : files)
      for (const std::string name : {"fmt", "nlohmann"})
        if (is_source(file.path) && file.text.find(name + "::") != std::string::npos &&
            file.text.find("#include <" + name + "/") == std::string::npos)
          paths += file.path + " uses " + name + " and does not include it\n";
    return paths;
  };
  const std::string use = "auto s = fmt::format(1);\n";
  EXPECT_EQ(lacking({{"tests/a.cpp", use}}), "tests/a.cpp uses fmt and does not include it\n");
  EXPECT_EQ(lacking({{"tests/a.cpp", "#include <fmt/format.h>\n" + use}}), "");
  EXPECT_EQ(lacking(read_repository(MBD_SOURCE_DIR)), "");
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
