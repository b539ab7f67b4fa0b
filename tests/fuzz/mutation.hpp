// Changes of the text of a model that leave most of it in order, so that they come past the XML parser.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <random>
#include <string>
#include <string_view>
#include <vector>

namespace mbd::test {

class Mutation {
 public:
  explicit Mutation(unsigned seed) : random_(seed) {}

  // A tag left out, doubled or moved, or a value replaced by another of the text or by one that is seldom.
  std::string operator()(std::string text) {
    switch (below(5)) {
      case 0:
        if (const auto tag = a_tag(text)) text.erase(tag->begin, tag->size);
        break;
      case 1:
        if (const auto tag = a_tag(text))
          text.insert(tag->begin, text.substr(tag->begin, tag->size));
        break;
      case 2:
        if (const auto tag = a_tag(text)) {
          const std::string moved = text.substr(tag->begin, tag->size);
          text.erase(tag->begin, tag->size);
          if (const auto other = a_tag(text)) text.insert(other->begin, moved);
        }
        break;
      case 3:
        if (const auto value = a_value(text))
          text.replace(value->begin, value->size, seldom[below(seldom.size())]);
        break;
      default:
        if (const auto value = a_value(text))
          if (const auto other = a_value(text))
            text.replace(value->begin, value->size, text.substr(other->begin, other->size));
    }
    return text;
  }

  // One byte replaced by any other.
  std::string byte(std::string text) {
    if (!text.empty()) text[below(text.size())] = static_cast<char>(below(256));
    return text;
  }

 private:
  struct Piece {
    std::size_t begin, size;
  };

  static constexpr auto seldom = std::to_array<std::string_view>(
      {"",       "0",        "-0",      "1",           "-1",     "2",       "1e-300",
       "1e300",  "-1e308",   "nan",     "1/0",         "1e-16",  "1e16",    "1e9",
       "1e6",    "1000",     "0.5",     "pi",          "t",      "s",       "sqrt(-1)",
       "log(0)", "exp(800)", "1/t",     "t<1?0:1/0",   "i",      "{i}",     "0 0 0",
       "1 0 0",  "0 0 1e-9", "1 2 3 4", "1 1 1 0 0 0", "ground", "b.start", "b.end",
       "b@0.5",  "1 mm",     "5 deg",   "1e3 kg",      "steps",  "1e400"});

  std::size_t below(std::size_t n) {
    return std::uniform_int_distribution<std::size_t>(0, n - 1)(random_);
  }

  std::optional<Piece> one_of(const std::vector<Piece>& pieces) {
    if (pieces.empty()) return std::nullopt;
    return pieces[below(pieces.size())];
  }

  // From < to >.
  std::optional<Piece> a_tag(const std::string& text) {
    std::vector<Piece> tags;
    for (std::size_t at = text.find('<'); at != std::string::npos; at = text.find('<', at + 1))
      if (const std::size_t end = text.find('>', at); end != std::string::npos)
        tags.push_back({at, end + 1 - at});
    return one_of(tags);
  }

  // What stands in quotes, without them.
  std::optional<Piece> a_value(const std::string& text) {
    std::vector<Piece> found;
    for (std::size_t at = text.find("=\""); at != std::string::npos; at = text.find("=\"", at)) {
      at += 2;
      const std::size_t end = text.find('"', at);
      if (end == std::string::npos) break;
      found.push_back({at, end - at});
      at = end;
    }
    return one_of(found);
  }

  std::minstd_rand random_;
};

}  // namespace mbd::test
