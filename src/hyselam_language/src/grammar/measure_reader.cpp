#include "measure_reader.hpp"

#include <algorithm>
#include <utility>

#include "hyselam_common/numbers.hpp"
#include "hyselam_common/utf8.hpp"
#include "word_lists.hpp"

namespace hyselam_topo {
namespace language {

void readNumbers(const GrammarNode& node, CompiledGrammar* grammar) {
  node.each([&](const std::string& key, const GrammarNode& value) {
    if (key == "words" || key == "tens") {
      value.each([&](const std::string& word, const GrammarNode& number) {
        grammar->number_words[hyselam::utf8Fold(word)] = {number.number(), key == "tens"};
      });
    } else if (key == "joiners") {
      addFolded(value, &grammar->number_joiners);
    } else if (key == "half") {
      addPhrases(value, &grammar->vocabulary, &grammar->halves);
    } else {
      value.fail("this key is not known: words, tens, joiners, half");
    }
  });
}

void readQuantity(const std::string& name, const GrammarNode& node, CompiledGrammar* grammar) {
  auto& all = grammar->quantities;
  if (std::any_of(all.begin(), all.end(), [&](const auto& q) { return q.name == name; })) {
    node.fail("this quantity is there already");
  }
  Quantity quantity;
  quantity.name = name;
  node.each([&](const std::string& key, const GrammarNode& value) {
    if (key == "default") {
      quantity.default_factor = value.number();
      if (!(quantity.default_factor > 0.0)) value.fail("a factor must be > 0");
      return;
    }
    const auto factor = hyselam::parseNumber(key);
    if (!factor || !(*factor > 0.0)) value.fail("the key must be a factor > 0 to SI units");
    Unit unit;
    unit.factor = *factor;
    addPhrases(value, &grammar->vocabulary, &unit.phrases);
    for (const std::string& text : value.texts()) {
      if (splitWords(text).size() == 1) grammar->unit_words.insert(hyselam::utf8Fold(text));
    }
    quantity.units.push_back(std::move(unit));
  });
  if (quantity.units.empty()) node.fail("there are no units");
  all.push_back(std::move(quantity));
}

}  // namespace language
}  // namespace hyselam_topo
