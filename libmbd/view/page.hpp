// One HTML file that shows a model, or the motion of a run: no network, no other file.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "libmbd/results/history.hpp"
#include "libmbd/view/motion.hpp"
#include "libmbd/view/page_parts.hpp"
#include "libmbd/view/section_stresses.hpp"

namespace mbd {

struct PageOptions {
  std::size_t most_bytes = 20'000'000;           // of the page
  std::optional<int> frames = {};                // at most so many
  const StressesOfOutlines* stresses = nullptr;  // of the motion of one run: further colours
};

struct Page {
  std::string html;
  std::size_t frames = 1, of = 1;  // shown, of those that the motion has
  bool has_resultants = true;      // and reactions: left out where there is no room for them
};

// Of a drawing (drawing.hpp) alone. Throws Error if it is longer than that.
Page model_page(const PageParts& parts, std::string_view drawing, const PageOptions& options = {});

// Frames are evenly chosen so that the page keeps its size; so are rows of the history, which may be absent. Throws
// Error if not even two frames find room.
Page motion_page(const PageParts& parts, const Motion& motion, const History* history,
                 const PageOptions& options = {});

// One of two that a page shows together: the motion of a run, or a model.
struct Shown {
  std::string name;                  // in the legend
  std::string drawing;               // of a model
  const Motion* motion = nullptr;    // of a run, in its place
  const History* history = nullptr;  // of a run; it may be absent
};

// Both in one picture, the second translucent in another colour, at the times of the first that moves; the other is
// interpolated between its frames, and stands where it ends. Loads and gravity are those of the first. Throws Error as above,
// and where one goes in time and the other in load steps, or load factors come back (a path): they say no instant.
Page overlaid_page(const PageParts& parts, const Shown& first, const Shown& second,
                   const PageOptions& options = {});

}  // namespace mbd
