#include "hyselam_common/numbers.hpp"

#include <locale.h>
#include <stdlib.h>

#include <cctype>
#include <cmath>
#include <cstring>
#include <locale>
#include <sstream>

namespace hyselam {

std::optional<double> parseNumber(std::string_view field) {
  // strtod wants a terminated string; longer fields than this are no measured numbers.
  char buffer[64];
  if (field.empty() || field.size() >= sizeof buffer) return std::nullopt;
  if (field.find_first_not_of("0123456789+-.eE") != std::string_view::npos) return std::nullopt;
  std::memcpy(buffer, field.data(), field.size());
  buffer[field.size()] = '\0';
  static const locale_t c_locale = newlocale(LC_ALL_MASK, "C", nullptr);
  char* end = nullptr;
  const double value = strtod_l(buffer, &end, c_locale);
  if (end != buffer + field.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::string formatNumber(double value) {
  for (int digits = 15;; ++digits) {
    std::ostringstream out;
    out.imbue(std::locale::classic());
    out.precision(digits);
    out << value;
    if (digits >= 17 || parseNumber(out.str()) == value) return out.str();
  }
}

void splitFields(std::string_view line, std::vector<std::string_view>* fields) {
  fields->clear();
  std::size_t i = 0;
  const auto blank = [&](std::size_t k) {
    return line[k] == ' ' || line[k] == '\t' || line[k] == '\r';
  };
  while (i < line.size()) {
    while (i < line.size() && blank(i)) ++i;
    const std::size_t begin = i;
    while (i < line.size() && !blank(i)) ++i;
    if (i > begin) fields->push_back(line.substr(begin, i - begin));
  }
}

std::string printable(std::string_view text) {
  std::string out;
  for (const char c : text.substr(0, 20))
    out += std::isprint(static_cast<unsigned char>(c)) != 0 ? c : '?';
  return out + (text.size() > 20 ? "..." : "");
}

}  // namespace hyselam
