#include "libmbd/front/xml.hpp"

#include <tinyxml2.h>

#include <algorithm>
#include <cstdint>
#include <fstream>

namespace mbd::xml {
namespace {

constexpr std::uintmax_t largest_file = 64u << 20;

bool is_blank(std::string_view text) {
  return text.find_first_not_of(" \t\r\n\f\v") == std::string_view::npos;
}

[[noreturn]] void malformed(const tinyxml2::XMLDocument& document, const std::string& file) {
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
  for (const tinyxml2::XMLAttribute* a = from.FirstAttribute(); a; a = a->Next())
    element.attributes.push_back({a->Name(), a->Value(), a->GetLineNum()});
  for (const tinyxml2::XMLNode* node = from.FirstChild(); node; node = node->NextSibling()) {
    if (const tinyxml2::XMLElement* const child = node->ToElement()) {
      element.children.push_back(convert(*child, file));
    } else if (const tinyxml2::XMLText* const text = node->ToText()) {
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
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF"))
    throw Error(Source{file, 1}, "the file is in UTF-16; save it in UTF-8");
  if (const std::size_t zero = text.find('\0'); zero != std::string_view::npos) {
    const auto line =
        std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(zero), '\n');
    throw Error(Source{file, static_cast<int>(line) + 1},
                "not an XML file: it contains zero bytes; save the model as text in UTF-8");
  }
  tinyxml2::XMLDocument document;
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) malformed(document, file);
  const tinyxml2::XMLElement* const root = document.RootElement();
  if (!root) throw Error(Source{file, 1}, "no model: it is one <mbd name=\"…\"> element");
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
