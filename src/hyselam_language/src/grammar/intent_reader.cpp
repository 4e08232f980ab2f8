#include "intent_reader.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>

namespace hyselam_topo {
namespace language {
namespace {

UtteranceKind kindOf(const GrammarNode& value) {
  constexpr std::array<UtteranceKind, 4> kKinds{UtteranceKind::kStatement, UtteranceKind::kCommand,
                                                UtteranceKind::kQuestion, UtteranceKind::kAnswer};
  const auto kind = std::find_if(kKinds.begin(), kKinds.end(), [&](UtteranceKind each) {
    return value.text() == toString(each);
  });
  if (kind == kKinds.end()) {
    value.fail("must be statement, command, question or answer, but is '" + value.text() + "'");
  }
  return *kind;
}

int costOf(const GrammarNode& value) {
  const double cost = value.number();
  if (!(cost >= -10.0 && cost <= 100.0)) value.fail("must be -10 .. 100");
  return static_cast<int>(cost);
}

void addPatterns(const GrammarNode& value, const PatternContext& context, CompiledGrammar* grammar,
                 IntentInfo* intent) {
  for (const std::string& pattern : value.texts()) {
    try {
      intent->patterns.push_back(compilePattern(pattern, context, grammar));
    } catch (const PatternError& e) {
      value.fail("pattern '" + pattern + "': " + e.what());
    }
  }
}

}  // namespace

void readIntent(const std::string& name, const GrammarNode& node, const PatternContext& context,
                CompiledGrammar* grammar) {
  auto& all = grammar->intents;
  auto found = std::find_if(all.begin(), all.end(),
                            [&](const IntentInfo& intent) { return intent.name == name; });
  const bool is_new = found == all.end();
  if (is_new) {
    all.emplace_back();
    found = all.end() - 1;
    found->name = name;
  }
  IntentInfo& intent = *found;
  bool has_kind = !is_new;
  node.each([&](const std::string& key, const GrammarNode& value) {
    if (key == "kind") {
      intent.kind = kindOf(value);
      has_kind = true;
    } else if (key == "refuse") {
      intent.refuse = value.text();
      if (grammar->reasons.count(intent.refuse) == 0) {
        value.fail("there is no reason '" + intent.refuse + "'");
      }
      has_kind = true;
    } else if (key == "cost") {
      intent.cost = costOf(value);
    } else if (key == "only_expected") {
      intent.only_expected = value.truth();
    } else if (key == "only_correction") {
      intent.only_correction = value.truth();
    } else if (key == "as") {
      intent.as = value.text();
    } else if (key == "corrects_next") {
      intent.corrects_next = value.truth();
    } else if (key == "examples") {
      const auto examples = value.texts();
      intent.examples.insert(intent.examples.end(), examples.begin(), examples.end());
    } else if (key == "patterns") {
      addPatterns(value, context, grammar, &intent);
    } else {
      value.fail("this key is not known");
    }
  });
  if (!has_kind) node.fail("the key 'kind' is missing");
  if (intent.patterns.empty()) node.fail("there are no patterns");
}

}  // namespace language
}  // namespace hyselam_topo
