#include "libmbd/view/letters.hpp"

#include <algorithm>
#include <iterator>
#include <string_view>

namespace mbd {
namespace {

constexpr int base = 2, capital = 8;  // y of the base line and of the top of capitals
constexpr double between = 1.8, blank = 2.5;

// Points "xy" of strokes, which a blank ends; y upward. In the order of characters.
struct Letter {
  char of;
  std::string_view strokes;
};
// clang-format off
constexpr Letter letters[] = {
    {'!', "0804 0203"}, {'"', "0807 2827"}, {'%', "0248 0708 4243"}, {'\'', "0807"},
    {'(', "19070311"}, {')', "09171301"}, {'*', "0446 0644 2723"}, {'+', "0545 2723"},
    {',', "1301"}, {'-', "0535"}, {'.', "0203"}, {'/', "0148"}, {'0', "183847433212030718"},
    {'1', "072822"}, {'2', "07183847460242"}, {'3', "07183847463515 354443321203"},
    {'4', "32380444"}, {'5', "4808053544433202"}, {'6', "38280603123243443505"}, {'7', "084822"},
    {'8', "183847463515060718 1504031232434435"}, {'9', "12224447381807061545"},
    {':', "0506 0203"}, {';', "1506 1301"}, {'<', "460542"}, {'=', "0646 0444"}, {'>', "064502"},
    {'A', "022842 1434"}, {'B', "02083847463505 3544433202"}, {'C', "4738180703123243"},
    {'D', "02082846442202"}, {'E', "48080242 0535"}, {'F', "480802 0535"},
    {'G', "47381807031232434525"}, {'H', "0802 4842 0545"}, {'I', "0828 1812 0222"},
    {'J', "4843321203"}, {'K', "0802 480542"}, {'L', "080242"}, {'M', "0208254842"},
    {'N', "02084248"}, {'O', "183847433212030718"}, {'P', "02083847463505"},
    {'Q', "183847433212030718 2442"}, {'R', "02083847463505 2542"},
    {'S', "473818070615354443321203"}, {'T', "0848 2822"}, {'U', "080312324348"}, {'V', "082248"},
    {'W', "0812253248"}, {'X', "0842 4802"}, {'Y', "082548 2522"}, {'Z', "08480242"},
    {'[', "19090111"}, {']', "09191101"}, {'^', "062846"}, {'_', "0141"},
    {'a', "16364542 441403123243"}, {'b', "0802 0516364543321203"}, {'c', "4536160503123243"},
    {'d', "4842 4536160503123243"}, {'e', "04444536160503123243"}, {'f', "38281712 0636"},
    {'g', "4641301001 4536160503123243"}, {'h', "0802 0516364542"}, {'i', "0602 0807"},
    {'j', "26211000 2827"}, {'k', "0802 3604 1532"}, {'l', "080312"},
    {'m', "0602 05162522 25364542"}, {'n', "0602 0516364542"}, {'o', "163645433212030516"},
    {'p', "0600 0516364543321203"}, {'q', "4640 4536160503123243"}, {'r', "0602 051636"},
    {'s', "45361605143443321203"}, {'t', "18132232 0636"}, {'u', "0603123243 4642"},
    {'v', "062246"}, {'w', "0612253246"}, {'x', "0642 4602"}, {'y', "0622 4610"},
    {'z', "06460242"}, {'|', "0901"},
};
// clang-format on
static_assert(std::ranges::is_sorted(letters, {}, &Letter::of));

constexpr std::string_view strokes_of(char c) {
  const auto* const letter = std::ranges::lower_bound(letters, c, {}, &Letter::of);
  return letter != std::end(letters) && letter->of == c ? letter->strokes : "07183847462524 2223";
}

}  // namespace

Lettering lettering(std::string_view text, double height) {
  const double unit = height / (capital - base);
  Lettering made;
  double at = 0.0;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x80 && byte < 0xc0) continue;  // the rest of a letter of UTF-8
    if (c == ' ') {
      at += blank + between;
      continue;
    }
    const std::string_view points = strokes_of(c);
    int widest = 0;
    made.strokes.emplace_back();
    for (std::size_t i = 0; i < points.size();) {
      if (points[i] == ' ') {
        made.strokes.emplace_back();
        ++i;
        continue;
      }
      const int x = points[i] - '0', y = points[i + 1] - '0';
      widest = std::max(widest, x);
      made.strokes.back().push_back({unit * (at + x), unit * (base - y)});
      i += 2;
    }
    at += widest + between;
  }
  made.width = unit * std::max(0.0, at - between);
  return made;
}

}  // namespace mbd
