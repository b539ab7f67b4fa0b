#include "libmbd/text/spelling.hpp"

#include <algorithm>
#include <cctype>

namespace mbd {
namespace {

constexpr std::size_t most_listed = 60;
constexpr std::size_t longest_compared = 200;

char lower(char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); }

// Edits from a to b: letters inserted, deleted, changed, or two neighbours exchanged; case is free.
std::size_t distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), current(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    current[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const bool same = lower(a[i - 1]) == lower(b[j - 1]);
      current[j] = std::min({last[j] + 1, current[j - 1] + 1, last[j - 1] + (same ? 0 : 1)});
      if (i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) &&
          lower(a[i - 2]) == lower(b[j - 1]))
        current[j] = std::min(current[j], before[j - 2] + 1);
    }
    before.swap(last);
    last.swap(current);
  }
  return last[b.size()];
}

}  // namespace

std::string_view nearest(std::string_view word, std::span<const std::string_view> known) {
  if (word.size() > longest_compared) return {};
  std::string_view best;
  std::size_t least = word.size() / 3 + 2;
  for (const std::string_view candidate : known) {
    if (candidate.size() > longest_compared) continue;
    const std::size_t limit = std::max<std::size_t>(1, std::max(word.size(), candidate.size()) / 3);
    const std::size_t edits = distance(word, candidate);
    if (edits < least && edits <= limit) {
      least = edits;
      best = candidate;
    }
  }
  return best;
}

std::string list(std::span<const std::string_view> words) {
  std::string text;
  for (std::size_t i = 0; i < std::min(words.size(), most_listed); ++i) {
    if (i > 0) text += ", ";
    text += words[i];
  }
  if (words.size() > most_listed)
    text += ", …, and " + std::to_string(words.size() - most_listed) + " more";
  return text;
}

std::string suggest(std::string_view word, std::span<const std::string_view> known,
                    std::string_view what) {
  std::string text;
  if (const std::string_view near = nearest(word, known); !near.empty())
    text += "; did you mean \"" + std::string(near) + "\"?";
  else
    text += ".";
  if (known.empty()) return text + " There are no " + std::string(what);
  return text + " The " + std::string(what) + " are: " + list(known);
}

}  // namespace mbd
