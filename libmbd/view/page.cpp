#include "libmbd/view/page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <span>
#include <utility>
#include <vector>

#include "libmbd/core/error.hpp"
#include "libmbd/results/report.hpp"
#include "libmbd/text/html.hpp"
#include "libmbd/text/text.hpp"

namespace mbd {
namespace {

using PageJson = nlohmann::ordered_json;

constexpr double history_share = 0.25;      // of the page, at most
constexpr std::size_t few_frames = 50;      // rather without resultants than with fewer
constexpr std::size_t longest_number = 26;  // of a key in JSON

std::string base64(std::span<const float> numbers) {
  constexpr std::string_view letters_of =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const auto* const bytes = reinterpret_cast<const unsigned char*>(numbers.data());
  const std::size_t size = numbers.size() * sizeof(float);
  std::string text;
  text.reserve((size + 2) / 3 * 4);
  for (std::size_t i = 0; i < size; i += 3) {
    const unsigned a = bytes[i], b = i + 1 < size ? bytes[i + 1] : 0,
                   c = i + 2 < size ? bytes[i + 2] : 0;
    const unsigned all = a << 16 | b << 8 | c;
    text += letters_of[all >> 18 & 63];
    text += letters_of[all >> 12 & 63];
    text += i + 1 < size ? letters_of[all >> 6 & 63] : '=';
    text += i + 2 < size ? letters_of[all & 63] : '=';
  }
  return text;
}

std::string script_text(const PageJson& json) {
  return in_script(json.dump(-1, ' ', false, PageJson::error_handler_t::replace));
}

std::string made(const PageParts& parts, PageJson drawing, const PageJson& history,
                 const std::string& frames) {
  // Reference poses in single precision, from the centre: as the frames are.
  std::vector<float> nodes;
  for (const PageJson& node : drawing.at("nodes"))
    for (std::size_t i = 0; i < 7; ++i)
      nodes.push_back(static_cast<float>(node.at(i).get<double>() -
                                         (i < 3 ? drawing.at("centre").at(i).get<double>() : 0.0)));
  drawing["nodes"] = base64(nodes);
  const std::string title = xml_escaped(drawing.at("name").get<std::string>()),
                    licence = xml_escaped(parts.licence), data = script_text(drawing),
                    rows = script_text(history);
  const std::array<std::pair<std::string_view, std::string_view>, 9> words = {
      {{"@TITLE@", title},
       {"@STYLE@", parts.style},
       {"@LICENCE@", licence},
       {"@DRAWING@", data},
       {"@HISTORY@", rows},
       {"@FRAMES@", frames},
       {"@THREE@", parts.three},
       {"@CONTROLS@", parts.controls},
       {"@SCRIPT@", parts.script}}};
  return filled(parts.html, words);
}

std::string megabytes(std::size_t bytes) {
  return fmt::format("{:.3g} MB", static_cast<double>(bytes) / 1e6);
}

void describe(PageJson& drawing, const std::string& subtitle, const std::string& about) {
  std::string with;
  for (const PageJson& parameter : drawing.at("parameters"))
    with += fmt::format("{}{} = {:.6g}", with.empty() ? "" : ", ",
                        parameter.at(0).get<std::string>(), parameter.at(1).get<double>());
  drawing["subtitle"] = subtitle;
  drawing["about"] =
      fmt::format("{} of {}, made by mbd {}. {}{}", subtitle, drawing.at("file").get<std::string>(),
                  version(), about, with.empty() ? "" : " Parameters: " + with + ".");
}

PageJson history_of(const History* history, std::size_t most_bytes,
                    std::vector<std::size_t>& rows) {
  if (history == nullptr) return PageJson();
  const std::size_t per_row = history->columns.size() * sizeof(float) * 4 / 3 + 1;
  rows = evenly_chosen(history->rows(), std::max<std::size_t>(2, most_bytes / per_row));
  PageJson columns = PageJson::array();
  std::vector<float> values;
  for (std::size_t c = 0; c < history->columns.size(); ++c) {
    columns.push_back({{"name", history->columns[c].name}, {"unit", history->columns[c].unit}});
    for (const std::size_t row : rows)
      values.push_back(static_cast<float>(history->values[c][row]));
  }
  return {{"columns", columns}, {"rows", rows.size()}, {"values", base64(values)}};
}

Page still_page(const PageParts& parts, PageJson drawing, const std::string& subtitle,
                const PageOptions& options) {
  describe(drawing, subtitle, "");
  Page page{made(parts, std::move(drawing), PageJson(), ""), 1, 1, false};
  if (page.html.size() > options.most_bytes)
    throw Error(fmt::format("the page would have {}, more than {}; give a larger --size",
                            megabytes(page.html.size()), megabytes(options.most_bytes)));
  return page;
}

}  // namespace

Page model_page(const PageParts& parts, std::string_view drawing, const PageOptions& options) {
  return still_page(parts, PageJson::parse(drawing), "the model, before a run", options);
}

namespace {

// What moves: rows as those of a motion (motion.hpp).
struct Rows {
  std::string name;  // for messages
  MotionBlocks blocks;
  std::size_t count = 0;
  std::function<std::vector<double>(std::size_t)> at;
};

// What a page has room for: all blocks, or those that matter more, of so many rows.
struct Fit {
  MotionBlocks blocks;
  std::size_t rows = 0;
};

// `fixed`: bytes of all else. Throws Error where there is no room for two frames.
Fit fit(const Rows& motion, std::size_t fixed, const PageOptions& options) {
  const std::size_t room = options.most_bytes > fixed ? options.most_bytes - fixed : 0;
  const auto per_frame = [](const MotionBlocks& blocks) {
    // A key, the row of the history, and 4 bytes a number as 16/3 letters.
    return longest_number + 10 + ((blocks.size() - 1) * 16 + 2) / 3;
  };
  const std::size_t wanted =
      std::min(motion.count, options.frames ? static_cast<std::size_t>(std::max(*options.frames, 1))
                                            : motion.count);
  MotionBlocks shown = motion.blocks;
  const auto fits = [&] { return std::min(wanted, room / per_frame(shown)); };
  if (fits() < std::min(wanted, few_frames)) shown.resultant = shown.joint = 0;
  if (fits() < std::min(wanted, few_frames)) shown.twist = 0;
  const std::size_t count = fits();
  if (count < std::min<std::size_t>(wanted, 2))
    throw Error(fmt::format(
        "{}: a page of {} has no room for two frames: one takes {} and all else {}; give a larger "
        "--size",
        motion.name, megabytes(options.most_bytes), megabytes(per_frame(shown)), megabytes(fixed)));
  return {shown, count};
}

// Numbers of a row that are shown, positions from the centre.
void add_frame(const std::vector<double>& row, const MotionBlocks& has, const MotionBlocks& shown,
               const std::array<double, 3>& centre, std::vector<float>& numbers) {
  std::size_t at = has.key;
  const auto take = [&](std::size_t size, std::size_t kept, bool is_pose) {
    for (std::size_t i = 0; i < kept; ++i)
      numbers.push_back(
          static_cast<float>(row[at + i] - (is_pose && i % 7 < 3 ? centre[i % 7] : 0.0)));
    at += size;
  };
  take(has.pose, shown.pose, true);
  take(has.twist, shown.twist, false);
  take(has.resultant, shown.resultant, false);
  take(has.joint, shown.joint, false);
}

// Puts the motion into the drawing. Returns the numbers of its frames.
std::vector<float> add_motion(PageJson& drawing, const Rows& motion, const Fit& fit,
                              const std::vector<std::size_t>* history_rows) {
  const MotionBlocks& shown = fit.blocks;
  const std::vector<std::size_t> rows = evenly_chosen(motion.count, fit.rows);
  const std::array<double, 3> centre = drawing.at("centre").get<std::array<double, 3>>();
  std::vector<float> numbers;
  numbers.reserve(rows.size() * (shown.size() - 1));
  PageJson keys = PageJson::array(), of_rows = PageJson::array();
  for (const std::size_t row : rows) {
    const std::vector<double> frame = motion.at(row);
    keys.push_back(frame[0]);
    if (history_rows != nullptr) {
      const auto at = std::lower_bound(history_rows->begin(), history_rows->end(), row);
      of_rows.push_back(
          std::min<std::ptrdiff_t>(at - history_rows->begin(), std::ssize(*history_rows) - 1));
    }
    add_frame(frame, motion.blocks, shown, centre, numbers);
  }
  drawing["motion"] = {{"keys", keys},
                       {"pose", shown.pose},
                       {"twist", shown.twist},
                       {"resultant", shown.resultant},
                       {"joint", shown.joint}};
  if (history_rows != nullptr) drawing["motion"]["history"] = of_rows;
  return numbers;
}

Page moving_page(const PageParts& parts, PageJson drawing, const Rows& motion,
                 const History* history, const History* second, const PageOptions& options) {
  std::vector<std::size_t> history_rows;
  const auto room_for_history =
      static_cast<std::size_t>(history_share * static_cast<double>(options.most_bytes));
  PageJson table =
      history_of(history, room_for_history / (second == nullptr ? 1 : 2), history_rows);
  if (std::vector<std::size_t> unused; history != nullptr && second != nullptr)
    table["second"] = history_of(second, room_for_history / 2, unused);

  // What is there anyhow, and what a frame costs with less and less in it.
  PageJson bare = drawing;
  describe(bare, std::string(200, ' '), std::string(200, ' '));
  const Fit room = fit(motion, made(parts, std::move(bare), table, "").size() + 1000, options);
  const bool row_for_row = history != nullptr && history->rows() == motion.count;
  const std::vector<float> numbers =
      add_motion(drawing, motion, room, row_for_row ? &history_rows : nullptr);
  const std::size_t count = drawing.at("motion").at("keys").size();
  const std::string of = count == motion.count
                             ? fmt::format("{} frames", count)
                             : fmt::format("{} of {} frames", count, motion.count);
  const bool less = room.blocks.size() < motion.blocks.size();
  std::string what = "the motion of a run, ";
  if (drawing.contains("runs"))
    what = fmt::format("{} and {} (translucent), ", drawing.at("runs").at(0).get<std::string>(),
                       drawing.at("runs").at(1).get<std::string>());
  describe(drawing, what + of,
           less ? "Resultants and reactions are left out for want of room." : "");
  return {made(parts, std::move(drawing), table, base64(numbers)), count, motion.count, !less};
}

// Of a place of the second drawing in one that holds both.
void shift(PageJson& place, int nodes) {
  if (const int node = place.at(0).get<int>(); node != 0) place.at(0) = node + nodes;
}

// The parts of `second` in `first`, after its own.
void merge(PageJson& first, const PageJson& second, const std::string& name, bool moves) {
  const int before = static_cast<int>(first.at("nodes").size()) - 1;
  const auto renamed = [&name](PageJson& word) { word = name + ": " + word.get<std::string>(); };
  for (std::size_t n = 1; n < second.at("nodes").size(); ++n)
    first["nodes"].push_back(second.at("nodes").at(n));
  for (PageJson part : second.at("parts")) {
    const std::string kind = part.at("kind").get<std::string>();
    if (kind == "load" || kind == "gravity") continue;
    part["run"] = 1;
    renamed(part["name"]);
    for (const char* place : {"at", "a", "b"})
      if (part.contains(place)) shift(part[place], before);
    if (part.contains("on")) renamed(part["on"]["beam"]);
    if (part.contains("points"))
      for (PageJson& place : part["points"]) shift(place, before);
    if (part.contains("outline")) renamed(part["outline"]);
    if (!moves) part.erase("stations");
    first["parts"].push_back(std::move(part));
  }
  if (second.contains("outlines"))
    for (const auto& [section, outline] : second.at("outlines").items())
      first["outlines"][name + ": " + section] = outline;
  if (moves)
    for (PageJson joint : second.at("joints")) {
      renamed(joint);
      first["joints"].push_back(std::move(joint));
    }
}

void clear_motion(PageJson& drawing) {
  for (PageJson& part : drawing["parts"]) part.erase("stations");
  drawing["joints"] = PageJson::array();
}

// A row of a model: nothing moves.
std::vector<double> row_of(const PageJson& drawing, const MotionBlocks& blocks) {
  std::vector<double> row{0.0};
  for (std::size_t n = 1; n < drawing.at("nodes").size(); ++n)
    for (const PageJson& number : drawing.at("nodes").at(n)) row.push_back(number.get<double>());
  row.resize(blocks.size());
  return row;
}

void check_order(const Shown& shown, const std::vector<double>& keys) {
  if (!std::is_sorted(keys.begin(), keys.end()))
    throw Error(
        shown.motion->file.string() +
        ": the load factor of this path comes back, so that it says no instant; view it alone");
}

// Rows of two motions as one, or of a motion and a model that stands still: at the instants of the first that moves.
class Overlay {
 public:
  // `drawings`: of each alone. Refers to what is shown.
  Overlay(const std::array<const Shown*, 2>& shown, const std::array<PageJson, 2>& drawings)
      : shown_(shown), lead_(shown[0]->motion != nullptr ? 0 : 1) {
    const bool both = shown[0]->motion != nullptr && shown[1]->motion != nullptr;
    for (const std::size_t i : {0U, 1U}) {
      if (const Motion* const motion = shown[i]->motion; motion != nullptr) {
        of_[i] = motion->blocks;
        keys_[i] = read_motion_keys(*motion);
        if (both) check_order(*shown[i], keys_[i]);
      } else {  // without resultants and joints
        of_[i].pose = 7 * (drawings[i].at("nodes").size() - 1);
        of_[i].twist = leader().motion->blocks.twist == 0 ? 0 : of_[i].pose / 7 * 6;
        still_[i] = row_of(drawings[i], of_[i]);
      }
    }
  }

  const Shown& leader() const { return *shown_[lead_]; }

  MotionBlocks blocks() const {
    MotionBlocks all;
    for (const auto block : each_block) all.*block = of_[0].*block + of_[1].*block;
    return all;
  }

  std::vector<double> row(std::size_t of_leader) const {
    const double key = keys_[lead_][of_leader];
    std::array<std::vector<double>, 2> rows;
    for (const std::size_t i : {0U, 1U})
      rows[i] = shown_[i]->motion == nullptr ? still_[i]
                : i == lead_ ? read_motion_rows(*shown_[i]->motion, std::span(&of_leader, 1))
                             : at(i, key);
    std::vector<double> all{key};
    std::array<std::size_t, 2> at{1, 1};
    for (const auto block : each_block)
      for (const std::size_t i : {0U, 1U}) {
        const auto begin = rows[i].begin() + static_cast<std::ptrdiff_t>(at[i]);
        const std::size_t size = of_[i].*block;
        all.insert(all.end(), begin, begin + static_cast<std::ptrdiff_t>(size));
        at[i] += size;
      }
    return all;
  }

 private:
  static constexpr std::array each_block{&MotionBlocks::pose, &MotionBlocks::twist,
                                         &MotionBlocks::resultant, &MotionBlocks::joint};

  // Between two of its rows; before the first and after the last those.
  std::vector<double> at(std::size_t i, double key) const {
    const Motion& motion = *shown_[i]->motion;
    const std::vector<double>& keys = keys_[i];
    const auto next = std::upper_bound(keys.begin(), keys.end(), key);
    const std::size_t after = static_cast<std::size_t>(next - keys.begin()),
                      k = after == 0 ? 0 : after - 1;
    std::vector<double> row = read_motion_rows(motion, std::span(&k, 1));
    if (after == 0 || next == keys.end()) return row;
    const double u = (key - keys[k]) / (keys[after] - keys[k]);
    if (u > 0.0) blend_rows(row, read_motion_rows(motion, std::span(&after, 1)), u, motion.blocks);
    return row;
  }

  std::array<const Shown*, 2> shown_;
  std::size_t lead_;
  std::array<MotionBlocks, 2> of_;
  std::array<std::vector<double>, 2> keys_, still_;
};

// Seven digits of each.
PageJson numbers_of(std::span<const double> values) {
  PageJson all = PageJson::array();
  for (const double v : values) all.push_back(std::stod(fmt::format("{:.7g}", v)));
  return all;
}

// Outlines become the finer ones, with what their points say of stresses: upper halves by rows, of each point.
void add_stresses(PageJson& drawing, const StressesOfOutlines& stresses) {
  for (const auto& [section, of] : stresses) {
    PageJson& outline = drawing["outlines"][section];
    outline = PageJson::parse(outline_text(of.outline));
    std::vector<double> halves, fibres;
    for (const Mat6& A : of.von_mises)
      for (Index i = 0; i < 6; ++i)
        for (Index j = i; j < 6; ++j) halves.push_back(A(i, j));
    for (const Vec6& b : of.fibres) fibres.insert(fibres.end(), b.data(), b.data() + 6);
    outline["von_mises"] = numbers_of(halves);
    if (!fibres.empty()) outline["fibres"] = numbers_of(fibres);
  }
}

}  // namespace

Page motion_page(const PageParts& parts, const Motion& motion, const History* history,
                 const PageOptions& options) {
  PageJson drawing = PageJson::parse(motion.head).at("drawing");
  if (options.stresses != nullptr) add_stresses(drawing, *options.stresses);
  return moving_page(
      parts, std::move(drawing),
      {motion.file.string(), motion.blocks, motion.rows,
       [&motion](std::size_t row) { return read_motion_rows(motion, std::span(&row, 1)); }},
      history, nullptr, options);
}

Page overlaid_page(const PageParts& parts, const Shown& first, const Shown& second,
                   const PageOptions& options) {
  const auto drawing_of = [](const Shown& shown) {
    return shown.motion != nullptr ? PageJson::parse(shown.motion->head).at("drawing")
                                   : PageJson::parse(shown.drawing);
  };
  PageJson drawing = drawing_of(first);
  const PageJson other = drawing_of(second);
  const std::array<PageJson, 2> alone{drawing, other};
  if (first.motion != nullptr && second.motion != nullptr && drawing.at("key") != other.at("key"))
    throw Error(
        fmt::format("{} goes in {}, {} in {}: they have no instants in common; view them apart",
                    first.name, drawing.at("key") == "time" ? "time" : "load steps", second.name,
                    other.at("key") == "time" ? "time" : "load steps"));
  if (first.motion == nullptr && second.motion != nullptr) {
    clear_motion(drawing);
    drawing["key"] = other.at("key");
    drawing["unit"] = other.at("unit");
  }
  merge(drawing, other, second.name, second.motion != nullptr);
  drawing["runs"] = {first.name, second.name};
  if (first.motion == nullptr && second.motion == nullptr)
    return still_page(parts, std::move(drawing),
                      "two models: " + first.name + " and " + second.name, options);

  const Overlay overlay({&first, &second}, alone);
  const Rows rows{overlay.leader().motion->file.string(), overlay.blocks(),
                  overlay.leader().motion->rows,
                  [&overlay](std::size_t row) { return overlay.row(row); }};
  return moving_page(parts, std::move(drawing), rows, overlay.leader().history,
                     first.motion != nullptr ? second.history : nullptr, options);
}

}  // namespace mbd
