#include "hyselam_language/grammar/topo_parser.hpp"

#include <algorithm>
#include <optional>

#include "compiled_grammar.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/utf8.hpp"
#include "reader/second_reading.hpp"
#include "text_reader.hpp"

namespace hyselam_topo {
namespace {

using language::CompiledGrammar;

std::vector<Grammar> allShipped() {
  std::vector<Grammar> grammars;
  for (const std::string& each : Grammar::shippedLanguages()) {
    grammars.push_back(Grammar::shipped(each));
  }
  return grammars;
}

ParsedText parseWith(const Grammar& grammar, const std::string& text,
                     const std::set<std::string>& expected) {
  return {grammar.language(), language::readText(grammar.compiled(), text, expected)};
}

std::size_t knownWords(const Grammar& grammar, const std::string& text) {
  const CompiledGrammar& compiled = grammar.compiled();
  const auto tokens = language::tokenize(text, {0, text.size()}, compiled.tokenRules());
  return static_cast<std::size_t>(std::count_if(tokens.begin(), tokens.end(), [&](const auto& t) {
    return compiled.known_words.count(t.folded) != 0;
  }));
}

ParsedText refused(const Grammar& grammar, const std::string& text, const std::string& code) {
  ParsedText parsed;
  parsed.language = grammar.language();
  Utterance utterance;
  utterance.range = utterance.culprit = {0, text.size()};
  utterance.reason_code = code;
  utterance.reason = grammar.compiled().reason(code);
  parsed.utterances.push_back(std::move(utterance));
  return parsed;
}

}  // namespace

std::size_t ParsedText::misunderstood() const {
  return static_cast<std::size_t>(std::count_if(
      utterances.begin(), utterances.end(), [](const Utterance& u) { return !u.understood(); }));
}

TopoParser::TopoParser() : TopoParser(allShipped()) {}

TopoParser::TopoParser(std::vector<Grammar> grammars) : grammars_(std::move(grammars)) {
  if (grammars_.empty()) throw hyselam::ParameterError("grammars", 0, "at least one");
  for (const Grammar& each : grammars_) {
    const bool known = FactReader::isShipped(each.language());
    readers_.push_back(known ? std::optional<FactReader>(FactReader::shipped(each)) : std::nullopt);
  }
}

const Grammar& TopoParser::grammar(const std::string& language) const {
  std::string known;
  for (const Grammar& each : grammars_) {
    if (each.language() == language) return each;
    known += (known.empty() ? "" : ", ") + each.language();
  }
  throw hyselam::ParameterError("language", language, "auto, " + known);
}

ParsedText TopoParser::parse(const std::string& text, const ParseOptions& options) const {
  const bool any = options.language == "auto";
  const auto preferred = std::find_if(grammars_.begin(), grammars_.end(), [&](const Grammar& each) {
    return each.language() == options.preferred;
  });
  const Grammar& first = !any                           ? grammar(options.language)
                         : preferred == grammars_.end() ? grammars_.front()
                                                        : *preferred;
  if (text.size() > options.max_bytes) return refused(first, text, "too_long");
  if (text.find('\0') != std::string::npos || !hyselam::isUtf8(text)) {
    return refused(first, text, "not_text");
  }
  if (!any) {
    ParsedText parsed = parseWith(first, text, options.expected);
    readAgain(text, &parsed);
    return parsed;
  }
  // The language of most of its words first.
  std::vector<std::pair<std::size_t, std::size_t>> order;
  for (std::size_t i = 0; i < grammars_.size(); ++i) {
    order.emplace_back(grammars_.size() > 1 ? knownWords(grammars_[i], text) : 0, i);
  }
  if (preferred != grammars_.end()) {
    const auto at = order.begin() + (preferred - grammars_.begin());
    std::rotate(order.begin(), at, at + 1);
  }
  std::stable_sort(order.begin(), order.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  std::optional<ParsedText> best;
  for (const auto& [known, index] : order) {
    const Grammar& each = grammars_[index];
    // Words of another language are names in this one: "One is next to the lift".
    if (best && 2 * known < order.front().first) continue;
    // In a language that knows less of it, any words would do as the name that was asked for.
    static const std::set<std::string> kNothing;
    ParsedText parsed =
        parseWith(each, text, known == order.front().first ? options.expected : kNothing);
    if (!best || parsed.misunderstood() < best->misunderstood()) best = std::move(parsed);
    if (best->misunderstood() == 0) break;
  }
  readAgain(text, &*best);
  return *best;
}

void TopoParser::readAgain(const std::string& text, ParsedText* parsed) const {
  for (std::size_t i = 0; i < grammars_.size(); ++i) {
    if (grammars_[i].language() != parsed->language || !readers_[i]) continue;
    hyselam_topo::readAgain(*readers_[i], grammars_[i], text, &parsed->utterances);
  }
  for (const Grammar& each : grammars_) {
    if (each.language() == parsed->language) {
      language::confirmParts(each.compiled(), text, &parsed->utterances);
    }
  }
}

}  // namespace hyselam_topo
