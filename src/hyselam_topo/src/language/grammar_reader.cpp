#include "grammar_reader.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/numbers.hpp"
#include "hyselam_topo/text.hpp"
#include "letters.hpp"
#include "pattern.hpp"

namespace hyselam_topo {
namespace language {
namespace {

constexpr char kFormat[] = "hyselam_grammar";
constexpr char kVersion[] = "1";

/// A node of a file with the keys that lead there, for errors.
class Node {
 public:
  Node(YAML::Node node, std::string source, std::string path)
      : node_(std::move(node)), source_(std::move(source)), path_(std::move(path)) {}

  [[noreturn]] void fail(const std::string& reason) const {
    std::string place = path_.empty() ? "" : "key '" + path_ + "'";
    const int line = node_.IsDefined() ? node_.Mark().line : -1;
    if (line >= 0) place = "line " + std::to_string(line + 1) + (place.empty() ? "" : ", ") + place;
    throw hyselam::InputError(source_, place, reason);
  }

  bool isMap() const { return node_.IsMap(); }

  std::string text() const {
    if (!node_.IsScalar()) fail("here must be a text");
    const std::string value = node_.Scalar();
    if (!isUtf8(value)) fail("this is not UTF-8 text");
    return value;
  }
  bool truth() const {
    const std::string value = text();
    if (value == "true") return true;
    if (value == "false") return false;
    fail("here must be true or false, but is '" + value + "'");
  }
  double number() const {
    const auto value = hyselam::parseNumber(text());
    if (!value) fail("here must be a number, but is '" + text() + "'");
    return *value;
  }
  /// A list of texts; a single one is a list of one.
  std::vector<std::string> texts() const {
    if (node_.IsScalar()) return {text()};
    if (!node_.IsSequence()) fail("here must be a list");
    std::vector<std::string> all;
    for (std::size_t i = 0; i < node_.size(); ++i) {
      all.push_back(Node(node_[i], source_, path_ + "[" + std::to_string(i) + "]").text());
    }
    return all;
  }

  /// Calls f(key, node) for all keys in their order.
  template <typename F>
  void each(F&& f) const {
    if (!node_.IsMap()) fail("here must be keys with values");
    std::set<std::string> seen;
    for (const auto& entry : node_) {
      if (!entry.first.IsScalar()) fail("a key is no text");
      const std::string key = entry.first.Scalar();
      const Node value(entry.second, source_, path_.empty() ? key : path_ + "." + key);
      if (!isUtf8(key)) fail("a key is not UTF-8 text");
      if (!seen.insert(key).second) value.fail("this key stands twice");
      f(key, value);
    }
  }

 private:
  YAML::Node node_;
  std::string source_;
  std::string path_;
};

std::vector<std::string> splitWords(const std::string& text) {
  std::vector<std::string_view> fields;
  hyselam::splitFields(text, &fields);
  return {fields.begin(), fields.end()};
}

void addFolded(const std::vector<std::string>& words, std::set<std::string>* set) {
  for (const std::string& word : words) set->insert(folded(word));
}

/// Without accents, long words mean the same ("tambem"), short ones do not: "dá", "da".
void addStops(const std::vector<std::string>& words, std::set<std::string>* set) {
  constexpr std::size_t kLong = 4;
  for (const std::string& word : words) {
    set->insert(lowered(word));
    if (folded(word).size() >= kLong) set->insert(folded(word));
  }
}

class Reader {
 public:
  std::shared_ptr<const CompiledGrammar> read(const std::vector<GrammarSource>& sources) {
    std::vector<Node> roots;
    for (const GrammarSource& source : sources) {
      try {
        roots.emplace_back(YAML::Load(source.yaml), source.name, "");
      } catch (const YAML::Exception& e) {
        throw hyselam::InputError(source.name, "line " + std::to_string(e.mark.line + 1),
                                  "this is no YAML: " + e.msg);
      }
    }
    if (roots.empty()) throw hyselam::InputError("grammar", "", "there is no source");
    // Patterns come last: they refer to everything else, of later sources too.
    for (const Node& root : roots) readAllButIntents(root);
    checkSeparators(roots.front());
    for (const auto& [name, node] : intents_) readIntent(name, node);
    if (grammar_->intents.empty()) roots.front().fail("there are no intents");
    finishKnownWords();
    return grammar_;
  }

 private:
  Phrase phrase(const std::string& text) {
    Phrase numbers;
    for (const std::string& word : splitWords(text)) numbers.push_back(g().vocabulary.add(word));
    return numbers;
  }
  void addPhrases(const Node& node, std::vector<Phrase>* phrases) {
    for (const std::string& text : node.texts()) {
      phrases->push_back(phrase(text));
      if (phrases->back().empty()) node.fail("there is an empty entry");
    }
  }
  CompiledGrammar& g() { return *grammar_; }

  void readAllButIntents(const Node& root) {
    std::string format, version;
    root.each([&](const std::string& key, const Node& node) {
      if (key == "format") {
        format = node.text();
      } else if (key == "version") {
        version = node.text();
      } else if (key == "language") {
        if (!g().language.empty() && g().language != node.text()) {
          node.fail("this is '" + node.text() + "', but the grammar that it adds to is '" +
                    g().language + "'");
        }
        g().language = node.text();
      } else if (key == "title") {
        if (g().title.empty()) g().title = node.text();
      } else if (key == "vocatives" || key == "fillers") {
        readFillers(key, node);
      } else if (key == "corrections") {
        addPhrases(node, &g().corrections);
      } else if (key == "clause_separators") {
        addPhrases(node, &g().clause_separators);
      } else if (key == "list_separators") {
        const auto texts = node.texts();
        context_.list_separators.insert(context_.list_separators.end(), texts.begin(), texts.end());
      } else if (key == "abbreviations") {
        for (const std::string& word : node.texts()) g().abbreviations.insert(lowered(word));
      } else if (key == "contractions") {
        node.each([&](const std::string& word, const Node& meaning) {
          g().contractions[lowered(word)] = splitWords(meaning.text());
        });
      } else if (key == "known_words") {
        addFolded(node.texts(), &g().known_words);
      } else if (key == "numbers") {
        readNumbers(node);
      } else if (key == "units") {
        node.each([&](const std::string& name, const Node& unit) { readQuantity(name, unit); });
      } else if (key == "names") {
        node.each([&](const std::string& name, const Node& type) { readNameType(name, type); });
      } else if (key == "macros") {
        node.each([&](const std::string& name, const Node& macro) {
          for (const std::string& text : macro.texts()) context_.macros[name].push_back(text);
        });
      } else if (key == "classes") {
        node.each([&](const std::string& name, const Node& entries) {
          entries.each([&](const std::string& value, const Node& texts) {
            for (const std::string& text : texts.texts()) {
              context_.classes[name][value].push_back(text);
            }
          });
        });
      } else if (key == "refusing_words") {
        node.each([&](const std::string& code, const Node& words) {
          for (const std::string& word : words.texts()) g().refusing_words[folded(word)] = code;
        });
      } else if (key == "reasons") {
        readTexts(node, &g().reasons);
      } else if (key == "say") {
        readTexts(node, &g().say);
      } else if (key == "intents") {
        node.each([&](const std::string& name, const Node& intent) {
          intents_.emplace_back(name, intent);
        });
      } else {
        node.fail("this key is not known");
      }
    });
    if (format != kFormat) root.fail("the key 'format' must be " + std::string(kFormat));
    if (version != kVersion) {
      root.fail("the key 'version' must be " + std::string(kVersion) + ", but is '" + version +
                "'");
    }
    if (g().language.empty()) root.fail("the key 'language' is missing");
  }

  static void readTexts(const Node& node, std::map<std::string, std::string>* texts) {
    node.each([&](const std::string& name, const Node& text) { (*texts)[name] = text.text(); });
  }

  void readFillers(const std::string& key, const Node& node) {
    if (key == "vocatives") {
      addPhrases(node, &g().fillers_before);
      addPhrases(node, &g().fillers_after);
      return;
    }
    node.each([&](const std::string& where, const Node& words) {
      if (where == "before") {
        addPhrases(words, &g().fillers_before);
      } else if (where == "after") {
        addPhrases(words, &g().fillers_after);
      } else if (where == "within") {
        for (const std::string& word : words.texts()) {
          const Phrase numbers = phrase(word);
          if (numbers.size() != 1) words.fail("'" + word + "' must be one word");
          g().fillers_inner.insert(numbers.front());
        }
      } else {
        words.fail("this key is not known: before, within, after");
      }
    });
  }

  void readNumbers(const Node& node) {
    node.each([&](const std::string& key, const Node& value) {
      if (key == "words" || key == "tens") {
        value.each([&](const std::string& word, const Node& number) {
          g().number_words[folded(word)] = {number.number(), key == "tens"};
        });
      } else if (key == "joiners") {
        addFolded(value.texts(), &g().number_joiners);
      } else if (key == "half") {
        addPhrases(value, &g().halves);
      } else {
        value.fail("this key is not known: words, tens, joiners, half");
      }
    });
  }

  void readQuantity(const std::string& name, const Node& node) {
    auto& all = g().quantities;
    if (std::any_of(all.begin(), all.end(), [&](const auto& q) { return q.name == name; })) {
      node.fail("this quantity is there already");
    }
    Quantity quantity;
    quantity.name = name;
    node.each([&](const std::string& key, const Node& value) {
      if (key == "default") {
        quantity.default_factor = value.number();
        if (!(quantity.default_factor > 0.0)) value.fail("a factor must be > 0");
        return;
      }
      const auto factor = hyselam::parseNumber(key);
      if (!factor || !(*factor > 0.0)) value.fail("the key must be a factor > 0 to SI units");
      Unit unit;
      unit.factor = *factor;
      addPhrases(value, &unit.phrases);
      for (const std::string& text : value.texts()) {
        if (splitWords(text).size() == 1) g().unit_words.insert(folded(text));
      }
      quantity.units.push_back(std::move(unit));
    });
    if (quantity.units.empty()) node.fail("there are no units");
    all.push_back(std::move(quantity));
  }

  void readNameType(const std::string& name, const Node& node) {
    auto& types = g().name_types;
    auto found = std::find_if(types.begin(), types.end(),
                              [&](const NameType& type) { return type.name == name; });
    if (found == types.end()) {
      NameType type;
      node.each([&](const std::string& key, const Node& value) {
        if (key != "like") return;
        const NameType* other = g().nameType(value.text());
        if (other == nullptr) value.fail("there is no kind of names '" + value.text() + "'");
        type = *other;
        const auto references = context_.references.find(value.text());
        if (references != context_.references.end()) {
          context_.references[name] = references->second;
        }
      });
      type.name = name;
      types.push_back(std::move(type));
      found = types.end() - 1;
    }
    NameType& type = *found;
    node.each([&](const std::string& key, const Node& value) {
      if (key == "like") {
      } else if (key == "definite") {
        addFolded(value.texts(), &type.definite);
      } else if (key == "indefinite") {
        addFolded(value.texts(), &type.indefinite);
      } else if (key == "joiners") {
        addFolded(value.texts(), &type.joiners);
      } else if (key == "stop") {
        addStops(value.texts(), &type.stop);
      } else if (key == "generic") {
        addFolded(value.texts(), &type.generic);
      } else if (key == "quantities") {
        addFolded(value.texts(), &type.quantities);
      } else if (key == "feminine") {
        addFolded(value.texts(), &type.feminine);
      } else if (key == "forbidden") {
        value.each([&](const std::string& code, const Node& words) {
          for (const std::string& word : words.texts()) type.forbidden[folded(word)] = code;
        });
      } else if (key == "nouns") {
        value.each([&](const std::string& kind, const Node& words) {
          for (const std::string& word : words.texts()) type.nouns[folded(word)] = kind;
        });
      } else if (key == "titles") {
        value.each([&](const std::string& title, const Node& words) {
          for (const std::string& word : words.texts()) type.titles[folded(word)] = title;
        });
      } else if (key == "plurals") {
        value.each([&](const std::string& title, const Node& words) {
          for (const std::string& word : words.texts()) type.plurals[folded(word)] = title;
        });
      } else if (key == "between") {
        addFolded(value.texts(), &type.between);
      } else if (key == "parts") {
        addFolded(value.texts(), &type.parts);
      } else if (key == "part_joiners") {
        addFolded(value.texts(), &type.part_joiners);
      } else if (key == "references") {
        value.each([&](const std::string& word, const Node& texts) {
          context_.references[name][word] = texts.texts();
        });
      } else if (key == "head") {
        if (value.text() != "first" && value.text() != "last") value.fail("must be first or last");
        type.head_first = value.text() == "first";
      } else if (key == "needs_noun") {
        type.needs_noun = value.truth();
      } else if (key == "indefinite_needs_noun") {
        type.indefinite_needs_noun = value.truth();
      } else if (key == "max_words") {
        const double count = value.number();
        if (count < 1.0 || count > 20.0 || count != std::floor(count)) {
          value.fail("must be 1 .. 20");
        }
        type.max_words = static_cast<std::size_t>(count);
      } else {
        value.fail("this key is not known");
      }
    });
  }

  void checkSeparators(const Node& root) const {
    for (const std::string& separator : context_.list_separators) {
      if (splitWords(separator).empty()) root.fail("a list separator is empty");
    }
  }

  void readIntent(const std::string& name, const Node& node) {
    auto& all = g().intents;
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
    node.each([&](const std::string& key, const Node& value) {
      if (key == "kind") {
        constexpr std::array<UtteranceKind, 4> kKinds{
            UtteranceKind::kStatement, UtteranceKind::kCommand, UtteranceKind::kQuestion,
            UtteranceKind::kAnswer};
        const auto kind = std::find_if(kKinds.begin(), kKinds.end(), [&](UtteranceKind each) {
          return value.text() == toString(each);
        });
        if (kind == kKinds.end()) {
          value.fail("must be statement, command, question or answer, but is '" + value.text() +
                     "'");
        }
        intent.kind = *kind;
        has_kind = true;
      } else if (key == "refuse") {
        intent.refuse = value.text();
        if (g().reasons.count(intent.refuse) == 0) {
          value.fail("there is no reason '" + intent.refuse + "'");
        }
        has_kind = true;
      } else if (key == "cost") {
        const double cost = value.number();
        if (!(cost >= 0.0 && cost <= 100.0)) value.fail("must be 0 .. 100");
        intent.cost = static_cast<int>(cost);
      } else if (key == "only_expected") {
        intent.only_expected = value.truth();
      } else if (key == "corrects_next") {
        intent.corrects_next = value.truth();
      } else if (key == "examples") {
        const auto examples = value.texts();
        intent.examples.insert(intent.examples.end(), examples.begin(), examples.end());
      } else if (key == "patterns") {
        for (const std::string& pattern : value.texts()) {
          try {
            intent.patterns.push_back(compilePattern(pattern, context_, &g()));
          } catch (const std::invalid_argument& e) {
            value.fail("pattern '" + pattern + "': " + e.what());
          }
        }
      } else {
        value.fail("this key is not known");
      }
    });
    if (!has_kind) node.fail("the key 'kind' is missing");
    if (intent.patterns.empty()) node.fail("there are no patterns");
  }

  /// Words that mean something here are no slips of the pen of others.
  void finishKnownWords() {
    auto& known = g().known_words;
    for (std::size_t i = 0; i < g().vocabulary.size(); ++i) {
      known.insert(folded(g().vocabulary.text(static_cast<int>(i))));
    }
    for (const auto& [word, value] : g().number_words) known.insert(word);
    for (const NameType& type : g().name_types) {
      for (const auto& words :
           {type.definite, type.indefinite, type.stop, type.generic, type.quantities, type.parts}) {
        known.insert(words.begin(), words.end());
      }
      for (const auto& [phrase_text, kind] : type.nouns) {
        for (const std::string& word : splitWords(phrase_text)) known.insert(word);
      }
      for (const auto& words : {type.forbidden, type.titles, type.plurals}) {
        for (const auto& [word, meaning] : words) known.insert(word);
      }
    }
    for (const auto& [word, code] : g().refusing_words) known.insert(word);
  }

  std::shared_ptr<CompiledGrammar> grammar_ = std::make_shared<CompiledGrammar>();
  PatternContext context_;
  std::vector<std::pair<std::string, Node>> intents_;
};

}  // namespace

std::shared_ptr<const CompiledGrammar> readGrammar(const std::vector<GrammarSource>& sources) {
  try {
    return Reader().read(sources);
  } catch (const YAML::Exception& e) {
    throw hyselam::InputError(sources.front().name, "line " + std::to_string(e.mark.line + 1),
                              e.msg);
  }
}

}  // namespace language
}  // namespace hyselam_topo
