#include "hyselam_common/yaml_text.hpp"

#include <algorithm>

#include "hyselam_common/errors.hpp"

namespace hyselam {
namespace {

// Brackets in texts and comments count as well, which no sensible file notices.
void requireShallow(const std::string& text, const std::string& source) {
  constexpr int kDeepest = 64, kWidestIndent = 256;
  int brackets = 0, indent = 0, dashes = 0, line = 1;
  bool leading = true;
  for (const char c : text) {
    if (c == '\n') {
      ++line;
      indent = dashes = 0;
      leading = true;
    } else if (leading && (c == ' ' || c == '-' || c == '?')) {
      ++indent;
      dashes += c != ' ';
    } else {
      leading = false;
    }
    if (c == '[' || c == '{') ++brackets;
    if (c == ']' || c == '}') brackets = std::max(0, brackets - 1);
    if (brackets > kDeepest || dashes > kDeepest || indent > kWidestIndent) {
      throw InputError(source, "line " + std::to_string(line), "nested too deep");
    }
  }
}

}  // namespace

YAML::Node parseYaml(const std::string& text, const std::string& source) {
  requireShallow(text, source);
  try {
    YAML::Node node = YAML::Load(text);
    if (!node || node.IsNull()) throw InputError(source, "", "the file is empty");
    return node;
  } catch (const YAML::Exception& e) {
    const std::string where = e.mark.line >= 0 ? "line " + std::to_string(e.mark.line + 1) : "";
    throw InputError(source, where, "is not YAML: " + e.msg);
  }
}

}  // namespace hyselam
