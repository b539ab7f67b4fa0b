#include "libmbd/language/xml.hpp"

#include <tinyxml2.h>

#include <algorithm>
#include <cstdint>
#include <fstream>

#include "libmbd/scene/label.hpp"

namespace mbd::xml {
namespace {

constexpr std::uintmax_t largest_file = 64u << 20;
constexpr int most_attributes = 1000;

bool is_blank(std::string_view text) {
  return text.find_first_not_of(" \t\r\n\f\v") == std::string_view::npos;
}

// --- what is wrong with a text that is not XML -----------------------------------------------------
// tinyxml2 tells a kind of error only. This reads the tags once more, for the message.

class Diagnosis {
 public:
  Diagnosis(std::string_view text, const std::string& file) : text_(text), file_(file) {}

  // Throws Error for the first mistake it understands; returns if it finds none.
  void run() {
    while (at_ < text_.size()) {
      if (text_[at_] != '<')
        text();
      else if (starts("<!--"))
        skip("-->", "this comment does not end; close it with -->");
      else if (starts("<![CDATA["))
        skip("]]>", "this CDATA section does not end; close it with ]]>");
      else if (starts("<?") && !open_.empty())
        fail(line_, "<?…?> does not belong inside the model; leave it out");
      else if (starts("<?"))
        skip("?>", "<?…?> must stand before the model and end with ?>; leave it out");
      else if (starts("</"))
        end_tag();
      else
        start_tag();
    }
    if (!open_.empty())
      fail(open_.back().line, "<" + open_.back().name + "> is not closed; close it with </" +
                                  open_.back().name + ">, or write <" + open_.back().name + " …/>");
  }

 private:
  struct Open {
    std::string name;
    int line;
  };

  [[noreturn]] void fail(int line, const std::string& what) const {
    throw Error(Source{file_, line}, "not well-formed XML: " + what);
  }
  bool starts(std::string_view with) const { return text_.substr(at_).starts_with(with); }
  void step() { line_ += text_[at_++] == '\n'; }
  void text() {
    if (open_.empty() && !is_blank(text_.substr(at_, 1)) &&
        static_cast<unsigned char>(text_[at_]) < 0x80)  // not the mark that a file is UTF-8
      fail(
          line_,
          "text after the end of the model does not belong there; a comment is written <!-- … -->");
    step();
  }
  void skip(std::string_view end, const std::string& otherwise) {
    const std::size_t to = text_.find(end, at_);
    if (to == std::string_view::npos) fail(line_, otherwise);
    while (at_ < to + end.size()) step();
  }
  void blanks() {
    while (at_ < text_.size() && is_blank(text_.substr(at_, 1))) step();
  }
  std::string word() {
    const std::size_t end = std::min(text_.find_first_of(" \t\r\n=/><\"'", at_), text_.size());
    const std::string result = excerpt(text_.substr(at_, end - at_));
    at_ = end;
    return result;
  }

  void end_tag() {
    at_ += 2;
    const int line = line_;
    const std::string name = word();
    blanks();
    if (open_.empty()) fail(line, "</" + name + "> closes nothing that is open; leave it out");
    if (open_.back().name != name) {
      const bool known = std::any_of(open_.begin(), open_.end(),
                                     [&name](const Open& o) { return o.name == name; });
      const std::string open =
          "<" + open_.back().name + "> (line " + std::to_string(open_.back().line) + ")";
      fail(line, known ? "</" + name + "> while " + open +
                             " is not closed; close that first, with </" + open_.back().name + ">"
                       : "</" + name + "> where " + open + " is to be closed; write </" +
                             open_.back().name + ">, or leave it out");
    }
    open_.pop_back();
    if (at_ >= text_.size() || text_[at_] != '>')
      fail(line, "</" + name + " does not end; close it with >");
    step();
  }

  void start_tag() {
    ++at_;
    const int line = line_;
    const std::string name = word();
    if (name.empty()) fail(line, "< without a name; in text and values write &lt;");
    std::vector<std::string> seen;
    for (;;) {
      const bool apart = at_ < text_.size() && is_blank(text_.substr(at_, 1));
      blanks();
      if (at_ >= text_.size()) fail(line, "<" + name + " does not end; close it with > or />");
      if (starts("/>")) {
        at_ += 2;
        return;
      }
      if (starts(">")) {
        step();
        open_.push_back({name, line});
        return;
      }
      const int here = line_;
      if (!apart && !seen.empty())
        fail(here, "<" + name + ">: no blank after the value of the attribute " + seen.back() +
                       "; is a quote missing? Write " + seen.back() + "=\"…\"");
      attribute(name, seen, here);
    }
  }

  void attribute(const std::string& element, std::vector<std::string>& seen, int line) {
    const std::string name = word();
    if (name.empty())
      fail(line, "<" + element + "> does not end, or holds a stray " +
                     excerpt(text_.substr(at_, 1)) + "; close it with > or />");
    if (std::find(seen.begin(), seen.end(), name) != seen.end())
      fail(line, "<" + element + ">: the attribute " + name + " is given twice; leave one out");
    seen.push_back(name);
    blanks();
    if (!starts("="))
      fail(line,
           "<" + element + ">: the attribute " + name + " has no value; write " + name + "=\"…\"");
    step();
    blanks();
    const char quote = at_ < text_.size() ? text_[at_] : ' ';
    if (quote != '"' && quote != '\'')
      fail(line, "<" + element + ">: the value of the attribute " + name +
                     " is not in quotes; write " + name + "=\"…\"");
    const int begun = line_;
    step();
    while (at_ < text_.size() && text_[at_] != quote && text_[at_] != '<') step();
    if (at_ >= text_.size() || text_[at_] == '<')
      fail(begun, "<" + element + ">: the value of the attribute " + name +
                      " does not end, or holds a <; close it with " + std::string(1, quote) +
                      ", and write &lt; for <");
    step();
  }

  std::string_view text_;
  const std::string& file_;
  std::size_t at_ = 0;
  int line_ = 1;
  std::vector<Open> open_;
};

int line_of(std::string_view text, std::size_t at) {
  return 1 + static_cast<int>(
                 std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
}

// Bytes that are no UTF-8 would make the results unreadable, which quote names and titles.
void check_utf8(std::string_view text, const std::string& file) {
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t size = utf8_size(text, i);
    if (size == 0)
      throw Error(Source{file, line_of(text, i)},
                  "a character is not in UTF-8; save the file in UTF-8");
    i += size;
  }
}

// tinyxml2 compares each attribute of an element with all before it: refused while there are few. Of text that is not
// well-formed this sees something or nothing; what is wrong with it is said later.
void check_attributes(std::string_view text, const std::string& file) {
  const auto behind = [&](std::string_view end, std::size_t from) {
    const std::size_t at = text.find(end, from);
    return at == std::string_view::npos ? text.size() : at + end.size();
  };
  for (std::size_t at = text.find('<'); at != std::string_view::npos; at = text.find('<', at)) {
    if (text.substr(at).starts_with("<!--")) {
      at = behind("-->", at + 4);
      continue;
    }
    if (text.substr(at).starts_with("<![CDATA[")) {
      at = behind("]]>", at);
      continue;
    }
    const std::size_t begin = at++;
    int attributes = 0;
    while (at < text.size() && text[at] != '>' && text[at] != '<') {
      if (text[at] == '"' || text[at] == '\'') {
        at = behind(text.substr(at, 1), at + 1);
        continue;
      }
      if (text[at] == '=' && ++attributes > most_attributes)
        throw Error(
            Source{file, line_of(text, begin)},
            "<" +
                excerpt(text.substr(
                    begin + 1,
                    std::min(text.find_first_of(" \t\r\n/>", begin), text.size()) - begin - 1)) +
                "> has more than " + std::to_string(most_attributes) +
                " attributes; no element of a model has as many");
      ++at;
    }
  }
}

// What <?xml … encoding="…"?> says: the text is read as UTF-8, whatever stands there.
void check_declared(std::string_view text, const std::string& file) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  if (!text.starts_with("<?xml")) return;
  const std::string_view declaration = text.substr(0, text.find("?>"));
  std::size_t at = declaration.find("encoding");
  if (at == std::string_view::npos) return;
  at = declaration.find_first_of("\"'", at);
  if (at == std::string_view::npos) return;
  const std::string_view name =
      declaration.substr(at + 1, declaration.find(declaration[at], at + 1) - at - 1);
  std::string upper(name);
  for (char& c : upper)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  if (upper == "UTF-8" || upper == "UTF8" || upper == "US-ASCII" || upper == "ASCII") return;
  const bool plain = std::all_of(text.begin(), text.end(),
                                 [](char c) { return static_cast<unsigned char>(c) < 0x80; });
  const bool wide = upper.starts_with("UTF-16") || upper.starts_with("UTF-32") ||
                    upper.starts_with("UCS") || upper.starts_with("ISO-10646");
  if (plain && !wide) return;  // the same in all of them
  throw Error(Source{file, 1},
              "it says that it is in " + excerpt(name) + (wide ? ", and is not" : "") +
                  "; save it in UTF-8, and write encoding=\"UTF-8\" or leave encoding out");
}

// A letter that is none, by its number (&#xD800;): tinyxml2 writes what is no UTF-8.
void check_letters(std::string_view value, const std::string& who, const Source& at) {
  for (std::size_t i = 0; i < value.size();) {
    const std::size_t size = utf8_size(value, i);
    if (size == 0)
      throw Error(at, who +
                          ": holds a letter by a number (&#…;) that is none; write the letter "
                          "itself (UTF-8)");
    i += size;
  }
}

// tinyxml2 leaves entities that it does not know as they are.
void check_entities(std::string_view value, const std::string& who, const Source& at) {
  for (std::size_t i = value.find('&'); i != std::string_view::npos; i = value.find('&', i + 1)) {
    const std::size_t end = value.find_first_of("; \t\n&", i + 1);
    if (end == std::string_view::npos || value[end] != ';' || end == i + 1) continue;
    if (value.substr(i + 1, end - i - 1)
            .find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789#") !=
        std::string_view::npos)
      continue;
    const std::string_view entity = value.substr(i, end - i + 1);
    if (entity == "&lt;" || entity == "&gt;" || entity == "&amp;" || entity == "&quot;" ||
        entity == "&apos;")
      throw Error(at, who + ": &amp;" + std::string(entity.substr(1)) + " is " +
                          std::string(entity) + " escaped twice; write " + std::string(entity));
    throw Error(
        at, who + ": " + excerpt(entity) +
                " is nothing that XML knows; write the character itself (UTF-8), or &amp; for &");
  }
}

[[noreturn]] void malformed(const tinyxml2::XMLDocument& document, std::string_view text,
                            const std::string& file) {
  if (document.ErrorID() != tinyxml2::XML_ELEMENT_DEPTH_EXCEEDED) Diagnosis(text, file).run();
  using namespace tinyxml2;
  const auto what = [&]() -> std::string {
    switch (document.ErrorID()) {
      case XML_ERROR_EMPTY_DOCUMENT:
        return "the file is empty; a model is one <mbd name=\"…\"> element";
      case XML_ERROR_MISMATCHED_ELEMENT:
        return "this element is not closed, or closed by another name; every <name …> ends with "
               "/> or with </name>";
      case XML_ERROR_PARSING_ATTRIBUTE:
        return "an attribute of this element is not of the form name=\"value\", or is given twice";
      case XML_ERROR_PARSING_ELEMENT:
      case XML_ERROR_PARSING:
        return "this element does not end; close it with > or />";
      case XML_ERROR_PARSING_TEXT:
        return "text does not end; is an element left open?";
      case XML_ERROR_PARSING_COMMENT:
        return "a comment is not of the form <!-- … -->";
      case XML_ERROR_PARSING_CDATA:
        return "a CDATA section is not of the form <![CDATA[ … ]]>";
      case XML_ERROR_PARSING_DECLARATION:
        return "<?xml … ?> is not closed, or does not stand first";
      case XML_ERROR_PARSING_UNKNOWN:
        return "<! … > is not closed";
      case XML_ELEMENT_DEPTH_EXCEEDED:
        return "elements are nested too deeply; <repeat> reads its contents several times";
      default:
        return std::string(XMLDocument::ErrorIDToName(document.ErrorID())) +
               "; an XML editor shows where";
    }
  }();
  throw Error(Source{file, std::max(1, document.ErrorLineNum())}, "not well-formed XML: " + what);
}

// The depth is that of tinyxml2, which is bounded.
Element convert(const tinyxml2::XMLElement& from, const std::string& file) {
  Element element;
  element.name = from.Name();
  element.line = from.GetLineNum();
  for (const tinyxml2::XMLAttribute* a = from.FirstAttribute(); a; a = a->Next()) {
    check_entities(a->Value(), element.name + ": " + a->Name(), {file, a->GetLineNum()});
    check_letters(a->Value(), element.name + ": " + a->Name(), {file, a->GetLineNum()});
    element.attributes.push_back({a->Name(), a->Value(), a->GetLineNum()});
  }
  for (const tinyxml2::XMLNode* node = from.FirstChild(); node; node = node->NextSibling()) {
    if (const tinyxml2::XMLElement* const child = node->ToElement()) {
      element.children.push_back(convert(*child, file));
    } else if (const tinyxml2::XMLText* const text = node->ToText()) {
      check_letters(text->Value(), element.name, {file, text->GetLineNum()});
      if (!text->CData()) check_entities(text->Value(), element.name, {file, text->GetLineNum()});
      element.text += text->Value();
      if (element.text_line == 0 && !is_blank(text->Value()))
        element.text_line = text->GetLineNum();
    } else if (!node->ToComment()) {
      throw Error(
          Source{file, node->GetLineNum()},
          element.name + ": <!…> and <?…> do not belong here; comments are written <!-- … -->");
    }
  }
  return element;
}

}  // namespace

Element parse(std::string_view text, const std::string& file) {
  if (text.starts_with(std::string_view("\xFF\xFE\0\0", 4)) ||
      text.starts_with(std::string_view("\0\0\xFE\xFF", 4)) ||
      text.starts_with(std::string_view("<\0\0\0", 4)) ||
      text.starts_with(std::string_view("\0\0\0<", 4)))
    throw Error(Source{file, 1}, "the file is in UTF-32; save it in UTF-8");
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF"))
    throw Error(Source{file, 1}, "the file is in UTF-16; save it in UTF-8");
  if (const std::size_t zero = text.find('\0'); zero != std::string_view::npos) {
    throw Error(Source{file, line_of(text, zero)},
                "not an XML file: it contains zero bytes; save the model as text in UTF-8");
  }
  check_utf8(text, file);
  check_declared(text, file);
  if (const std::size_t first = text.find_first_not_of(" \t\r\n\f\v\xEF\xBB\xBF");
      first != std::string_view::npos && text[first] != '<')
    throw Error(Source{file, line_of(text, first)},
                "not an XML file; a model must be one <mbd name=\"…\"> element");
  check_attributes(text, file);
  tinyxml2::XMLDocument document;
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS)
    malformed(document, text, file);
  const tinyxml2::XMLElement* const root = document.RootElement();
  if (!root) throw Error(Source{file, 1}, "no model: it must be one <mbd name=\"…\"> element");
  for (const tinyxml2::XMLNode* node = document.FirstChild(); node; node = node->NextSibling()) {
    const Source at{file, node->GetLineNum()};
    if (node->ToUnknown())
      throw Error(at, "<!…> before or after the model (a DOCTYPE, say) is not read; leave it out");
    if (node->ToText() && !is_blank(node->Value()))
      throw Error(at,
                  "text outside the model; it is one <mbd name=\"…\"> element, and comments are "
                  "written <!-- … -->");
    if (const tinyxml2::XMLElement* const other = node->ToElement(); other && other != root)
      throw Error(at, "<" + std::string(other->Name()) +
                          ">: a model is one <mbd> element, and this is a second; put its contents "
                          "into the first");
  }
  return convert(*root, file);
}

Element parse_file(const std::filesystem::path& file) {
  const std::string name = file.string();
  std::error_code code;
  if (std::filesystem::is_directory(file, code))
    throw Error(name + ": is a directory, not a model; give an XML file");
  const auto too_large = [&name] {
    return Error(name + ": is larger than a model may be, 64 MB; use <repeat> and expressions");
  };
  const std::uintmax_t size = std::filesystem::file_size(file, code);
  if (!code && size > largest_file) throw too_large();
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw Error(name + ": no such file, or it cannot be read; check its name");
  std::string text;
  char buffer[1 << 16];
  while (stream.read(buffer, sizeof buffer) || stream.gcount() > 0) {
    text.append(buffer, static_cast<std::size_t>(stream.gcount()));
    if (text.size() > largest_file) throw too_large();  // of a pipe, say
  }
  if (stream.bad()) throw Error(name + ": cannot be read to its end; is the disk sound?");
  return parse(text, name);
}

}  // namespace mbd::xml
