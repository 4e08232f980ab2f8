// Numbers out of text and back, independent of the locale that the process runs in.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hyselam {

/// A finite decimal number that fills the whole field; nothing for "nan", "inf", hexadecimal,
/// "1.5x".
std::optional<double> parseNumber(std::string_view field);

/// The shortest of 15, 16 or 17 significant digits that reads back as the same number.
std::string formatNumber(double value);

/// Splits at spaces, tabs and carriage returns; the views point into `line`.
void splitFields(std::string_view line, std::vector<std::string_view>* fields);

/// The first 20 characters of something read, fit for a message: '?' for what a terminal might
/// obey.
std::string printable(std::string_view text);

/// Calls f(line number from 1, line without its end) for each line of a text.
template <typename F>
void forEachLine(std::string_view text, F&& f) {
  std::size_t number = 0;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    f(++number, text.substr(0, end));
    if (end == std::string_view::npos) break;
    text.remove_prefix(end + 1);
  }
}

}  // namespace hyselam
