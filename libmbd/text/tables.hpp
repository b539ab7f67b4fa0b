// What reports of studies share: tables for the terminal, cells of CSV, text in Markdown.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace mbd::study {

std::string capital(std::string text);  // its first letter, if it is of ASCII

std::string one_line(std::string_view text);  // control characters as blanks

// "name       words", broken into lines that begin where the words do.
void paragraph(std::string& text, std::string_view name, std::string_view words);

// Columns of numbers right-aligned, the last column to the left and broken into lines.
void table(std::string& text, const std::vector<std::vector<std::string>>& rows);

// In quotes where it needs them.
std::string csv_cell(std::string_view text);

// On one line; what Markdown or HTML would read as its own is escaped.
std::string markdown_escaped(std::string_view text);

}  // namespace mbd::study
