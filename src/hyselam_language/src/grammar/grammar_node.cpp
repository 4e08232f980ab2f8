#include "grammar_node.hpp"

#include <set>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/numbers.hpp"
#include "hyselam_common/utf8.hpp"
#include "hyselam_common/yaml_text.hpp"

namespace hyselam_topo {
namespace language {

GrammarNode GrammarNode::parse(const std::string& yaml, const std::string& source) {
  return GrammarNode(hyselam::parseYaml(yaml, source), source, "");
}

void GrammarNode::fail(const std::string& reason) const {
  std::string place = path_.empty() ? "" : "key '" + path_ + "'";
  const int line = node_.IsDefined() ? node_.Mark().line : -1;
  if (line >= 0) place = "line " + std::to_string(line + 1) + (place.empty() ? "" : ", ") + place;
  throw hyselam::InputError(source_, place, reason);
}

std::string GrammarNode::text() const {
  if (!node_.IsScalar()) fail("here must be a text");
  std::string value = node_.Scalar();
  if (!hyselam::isUtf8(value)) fail("this is not UTF-8 text");
  return value;
}

bool GrammarNode::truth() const {
  const std::string value = text();
  if (value == "true") return true;
  if (value == "false") return false;
  fail("here must be true or false, but is '" + value + "'");
}

double GrammarNode::number() const {
  const auto value = hyselam::parseNumber(text());
  if (!value) fail("here must be a number, but is '" + text() + "'");
  return *value;
}

std::vector<std::string> GrammarNode::texts() const {
  if (node_.IsScalar()) return {text()};
  if (!node_.IsSequence()) fail("here must be a list");
  std::vector<std::string> all;
  for (std::size_t i = 0; i < node_.size(); ++i) {
    all.push_back(GrammarNode(node_[i], source_, path_ + "[" + std::to_string(i) + "]").text());
  }
  return all;
}

void GrammarNode::each(const Visit& visit) const {
  if (!node_.IsMap()) fail("here must be keys with values");
  std::set<std::string> seen;
  for (const auto& entry : node_) {
    if (!entry.first.IsScalar()) fail("a key is no text");
    const std::string key = entry.first.Scalar();
    const GrammarNode value(entry.second, source_, path_.empty() ? key : path_ + "." + key);
    if (!hyselam::isUtf8(key)) fail("a key is not UTF-8 text");
    if (!seen.insert(key).second) value.fail("this key stands twice");
    visit(key, value);
  }
}

}  // namespace language
}  // namespace hyselam_topo
