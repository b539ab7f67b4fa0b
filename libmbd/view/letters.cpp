#include "libmbd/view/letters.hpp"

#include <algorithm>

namespace mbd {
namespace {

constexpr int base = 2, capital = 8;  // y of the base line and of the top of capitals
constexpr double between = 1.8, blank = 2.5;

// Points "xy" of strokes, which a blank ends; y upward.
constexpr std::string_view strokes_of(char c) {
  switch (c) {
    case 'A':
      return "022842 1434";
    case 'B':
      return "02083847463505 3544433202";
    case 'C':
      return "4738180703123243";
    case 'D':
      return "02082846442202";
    case 'E':
      return "48080242 0535";
    case 'F':
      return "480802 0535";
    case 'G':
      return "47381807031232434525";
    case 'H':
      return "0802 4842 0545";
    case 'I':
      return "0828 1812 0222";
    case 'J':
      return "4843321203";
    case 'K':
      return "0802 480542";
    case 'L':
      return "080242";
    case 'M':
      return "0208254842";
    case 'N':
      return "02084248";
    case 'O':
      return "183847433212030718";
    case 'P':
      return "02083847463505";
    case 'Q':
      return "183847433212030718 2442";
    case 'R':
      return "02083847463505 2542";
    case 'S':
      return "473818070615354443321203";
    case 'T':
      return "0848 2822";
    case 'U':
      return "080312324348";
    case 'V':
      return "082248";
    case 'W':
      return "0812253248";
    case 'X':
      return "0842 4802";
    case 'Y':
      return "082548 2522";
    case 'Z':
      return "08480242";
    case 'a':
      return "16364542 441403123243";
    case 'b':
      return "0802 0516364543321203";
    case 'c':
      return "4536160503123243";
    case 'd':
      return "4842 4536160503123243";
    case 'e':
      return "04444536160503123243";
    case 'f':
      return "38281712 0636";
    case 'g':
      return "4641301001 4536160503123243";
    case 'h':
      return "0802 0516364542";
    case 'i':
      return "0602 0807";
    case 'j':
      return "26211000 2827";
    case 'k':
      return "0802 3604 1532";
    case 'l':
      return "080312";
    case 'm':
      return "0602 05162522 25364542";
    case 'n':
      return "0602 0516364542";
    case 'o':
      return "163645433212030516";
    case 'p':
      return "0600 0516364543321203";
    case 'q':
      return "4640 4536160503123243";
    case 'r':
      return "0602 051636";
    case 's':
      return "45361605143443321203";
    case 't':
      return "18132232 0636";
    case 'u':
      return "0603123243 4642";
    case 'v':
      return "062246";
    case 'w':
      return "0612253246";
    case 'x':
      return "0642 4602";
    case 'y':
      return "0622 4610";
    case 'z':
      return "06460242";
    case '0':
      return "183847433212030718";
    case '1':
      return "072822";
    case '2':
      return "07183847460242";
    case '3':
      return "07183847463515 354443321203";
    case '4':
      return "32380444";
    case '5':
      return "4808053544433202";
    case '6':
      return "38280603123243443505";
    case '7':
      return "084822";
    case '8':
      return "183847463515060718 1504031232434435";
    case '9':
      return "12224447381807061545";
    case '.':
      return "0203";
    case ',':
      return "1301";
    case ':':
      return "0506 0203";
    case ';':
      return "1506 1301";
    case '-':
      return "0535";
    case '+':
      return "0545 2723";
    case '=':
      return "0646 0444";
    case '_':
      return "0141";
    case '(':
      return "19070311";
    case ')':
      return "09171301";
    case '[':
      return "19090111";
    case ']':
      return "09191101";
    case '|':
      return "0901";
    case '/':
      return "0148";
    case '%':
      return "0248 0708 4243";
    case '\'':
      return "0807";
    case '"':
      return "0807 2827";
    case '<':
      return "460542";
    case '>':
      return "064502";
    case '*':
      return "0446 0644 2723";
    case '^':
      return "062846";
    case '!':
      return "0804 0203";
    default:
      return "07183847462524 2223";
  }
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
