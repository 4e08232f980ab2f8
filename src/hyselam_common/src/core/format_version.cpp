#include "hyselam_common/format_version.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>

namespace hyselam {
namespace {

constexpr std::size_t kMostShown = 40;  // of what stands there: damaged files may have anything

std::optional<int> wholeNumber(std::string_view text) {
  constexpr std::size_t kMostDigits = 9;
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  if (text.empty() || text.size() > kMostDigits || !std::all_of(text.begin(), text.end(), digit)) {
    return std::nullopt;
  }
  return std::stoi(std::string(text));
}

/// "selovis model " and "2" of "selovis model 2".
struct NameAndVersion {
  std::string_view name, version;
};

NameAndVersion split(std::string_view text) {
  const std::size_t space = text.rfind(' ');
  if (space == std::string_view::npos) return {text, {}};
  return {text.substr(0, space + 1), text.substr(space + 1)};
}

}  // namespace

std::string versionRefusal(std::string_view found, FormatVersions read) {
  const auto number = wholeNumber(found);
  std::string text = "has version ";
  if (number) {
    text += found;
  } else {
    text.append("'").append(found.substr(0, kMostShown)).append("'");
  }
  text += ", this program reads " + std::to_string(read.oldest);
  if (read.newest > read.oldest) text += " to " + std::to_string(read.newest);
  if (!number) return text;
  if (*number > read.newest) text += "; it was written by a newer HySeLAM";
  if (*number < read.oldest) text += "; it was written by an older HySeLAM";
  return text;
}

std::string formatRefusal(std::string_view found, std::string_view newest, int oldest) {
  const NameAndVersion theirs = split(found), ours = split(newest);
  const auto now = wholeNumber(ours.version);
  if (theirs.name != ours.name || !now || !wholeNumber(theirs.version)) {
    return "is no '" + std::string(newest) + "'";
  }
  return versionRefusal(theirs.version, {oldest > 0 ? oldest : *now, *now});
}

}  // namespace hyselam
