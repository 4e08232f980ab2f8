#include "grammar_reader.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <utility>

#include "grammar_node.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/format_version.hpp"
#include "hyselam_common/utf8.hpp"
#include "intent_reader.hpp"
#include "measure_reader.hpp"
#include "name_type_reader.hpp"
#include "pattern.hpp"
#include "word_lists.hpp"

namespace hyselam_topo {
namespace language {
namespace {

constexpr char kFormat[] = "hyselam_grammar";
constexpr int kVersion = 1;

class Reader {
 public:
  std::shared_ptr<const CompiledGrammar> read(const std::vector<GrammarSource>& sources) {
    std::vector<GrammarNode> roots;
    roots.reserve(sources.size());
    for (const GrammarSource& source : sources) {
      roots.push_back(GrammarNode::parse(source.yaml, source.name));
    }
    if (roots.empty()) throw hyselam::InputError("grammar", "", "there is no source");
    // Patterns come last: they refer to everything else, of later sources too.
    for (const GrammarNode& root : roots) readAllButIntents(root);
    checkSeparators(roots.front());
    for (const auto& [name, node] : intents_) readIntent(name, node, context_, grammar_.get());
    for (IntentInfo& intent : grammar_->intents) {
      for (Automaton& pattern : intent.patterns) {
        grammar_->index.add(&pattern);
        pattern.pack();
      }
    }
    if (grammar_->intents.empty()) roots.front().fail("there are no intents");
    grammar_->telling_words.insert(grammar_->unit_words.begin(), grammar_->unit_words.end());
    addLightWords();
    finishKnownWords();
    for (NameType& type : grammar_->name_types) indexWords(&type);
    indexPhrases();
    for (const auto* phrases : {&grammar_->fillers_before, &grammar_->fillers_after}) {
      for (const Phrase& phrase : *phrases) {
        // A single word may stand for a name.
        if (phrase.size() < 2) continue;
        grammar_->long_fillers[grammar_->vocabulary.text(phrase.front())].push_back(phrase);
      }
    }
    grammar_->examples = ExampleSentences(*grammar_);
    return grammar_;
  }

 private:
  void readAllButIntents(const GrammarNode& root) {
    using Read = std::function<void(const GrammarNode&)>;
    CompiledGrammar& g = *grammar_;
    std::string format, version;
    const auto phrases = [&g](std::vector<Phrase>* all) -> Read {
      return [&g, all](const GrammarNode& node) { addPhrases(node, &g.vocabulary, all); };
    };
    const auto texts = [](std::map<std::string, std::string>* all) -> Read {
      return [all](const GrammarNode& node) {
        node.each(
            [&](const std::string& key, const GrammarNode& text) { (*all)[key] = text.text(); });
      };
    };
    const std::map<std::string, Read> keys{
        {"format", [&](const GrammarNode& node) { format = node.text(); }},
        {"version", [&](const GrammarNode& node) { version = node.text(); }},
        {"language", [&](const GrammarNode& node) { readLanguage(node); }},
        {"title",
         [&](const GrammarNode& node) {
           if (g.title.empty()) g.title = node.text();
         }},
        {"vocatives", [&](const GrammarNode& node) { readVocatives(node); }},
        {"fillers", [&](const GrammarNode& node) { readFillers(node); }},
        {"told_anyway", [&](const GrammarNode& node) { readToldAnyway(node); }},
        {"past_asides", [&](const GrammarNode& node) { addWords(node, &g.past_asides); }},
        {"idle_asides", [&](const GrammarNode& node) { addWords(node, &g.idle_asides); }},
        {"clause_starts", [&](const GrammarNode& node) { addWords(node, &g.clause_starts); }},
        {"no_clause_after", [&](const GrammarNode& node) { addFolded(node, &g.no_clause_after); }},
        {"only_behind_comma",
         [&](const GrammarNode& node) { addFolded(node, &g.only_behind_comma); }},
        {"saying_words", [&](const GrammarNode& node) { addFolded(node, &g.saying_words); }},
        {"doubt_words", [&](const GrammarNode& node) { addFolded(node, &g.doubt_words); }},
        {"asking_words", [&](const GrammarNode& node) { addFolded(node, &g.asking_words); }},
        {"corrections", phrases(&g.corrections)},
        {"clause_separators", phrases(&g.clause_separators)},
        {"list_separators", [&](const GrammarNode& node) { readListSeparators(node); }},
        {"reflexive", [&](const GrammarNode& node) { addFolded(node, &g.reflexive); }},
        {"reflexive_after", [&](const GrammarNode& node) { addFolded(node, &g.reflexive_after); }},
        {"here_words", [&](const GrammarNode& node) { addFolded(node, &g.here_words); }},
        {"pointing_words", [&](const GrammarNode& node) { addFolded(node, &g.pointing_words); }},
        {"pointed_words", [&](const GrammarNode& node) { addFolded(node, &g.pointed_words); }},
        {"tour_words", [&](const GrammarNode& node) { readTourWords(node); }},
        {"list_ends",
         [&](const GrammarNode& node) {
           for (const std::string& word : node.texts()) g.list_ends.insert(word);
         }},
        {"order_words", [&](const GrammarNode& node) { addFolded(node, &g.order_words); }},
        {"abbreviations", [&](const GrammarNode& node) { readAbbreviations(node); }},
        {"acronyms",
         [&](const GrammarNode& node) {
           for (const std::string& word : node.texts()) g.acronyms.insert(word);
         }},
        {"contracted_verbs", texts(&g.contracted_verbs)},
        {"loose_contractions", [&](const GrammarNode& node) { readLooseContractions(node); }},
        {"same_words", [&](const GrammarNode& node) { readSameWords(node); }},
        {"loose_before", [&](const GrammarNode& node) { addWords(node, &g.loose_before); }},
        {"contractions", [&](const GrammarNode& node) { readContractions(node); }},
        {"known_words", [&](const GrammarNode& node) { addFolded(node, &g.known_words); }},
        {"numbers", [&](const GrammarNode& node) { readNumbers(node, &g); }},
        {"units", [&](const GrammarNode& node) { readUnits(node); }},
        {"names", [&](const GrammarNode& node) { readNameTypes(node); }},
        {"macros", [&](const GrammarNode& node) { readMacros(node); }},
        {"classes", [&](const GrammarNode& node) { readClasses(node); }},
        {"refusing_words", [&](const GrammarNode& node) { addMeanings(node, &g.refusing_words); }},
        {"placing_words", [&](const GrammarNode& node) { addFolded(node, &g.placing_words); }},
        {"telling_words", [&](const GrammarNode& node) { addFolded(node, &g.telling_words); }},
        {"urgent", [&](const GrammarNode& node) { readUrgent(node, &g.urgent); }},
        {"reasons", texts(&g.reasons)},
        {"say", texts(&g.say)},
        {"intents", [&](const GrammarNode& node) { noteIntents(node); }}};
    root.each([&](const std::string& key, const GrammarNode& node) {
      const auto read = keys.find(key);
      if (read == keys.end()) node.fail("this key is not known");
      read->second(node);
    });
    if (format != kFormat) root.fail("the key 'format' must be " + std::string(kFormat));
    if (version != std::to_string(kVersion)) {
      root.fail("the key 'version': " + hyselam::versionRefusal(version, {kVersion, kVersion}));
    }
    if (g.language.empty()) root.fail("the key 'language' is missing");
  }

  void readLanguage(const GrammarNode& node) {
    std::string& language = grammar_->language;
    if (!language.empty() && language != node.text()) {
      node.fail("this is '" + node.text() + "', but the grammar that it adds to is '" + language +
                "'");
    }
    language = node.text();
  }

  void readVocatives(const GrammarNode& node) {
    addPhrases(node, &grammar_->vocabulary, &grammar_->fillers_before);
    addPhrases(node, &grammar_->vocabulary, &grammar_->fillers_after);
  }

  void readFillers(const GrammarNode& node) {
    node.each([&](const std::string& where, const GrammarNode& words) {
      if (where == "before") {
        addPhrases(words, &grammar_->vocabulary, &grammar_->fillers_before);
      } else if (where == "after") {
        addPhrases(words, &grammar_->vocabulary, &grammar_->fillers_after);
      } else if (where == "within") {
        for (const std::string& word : words.texts()) {
          const Phrase numbers = phraseOf(word, &grammar_->vocabulary);
          if (numbers.size() != 1) words.fail("'" + word + "' must be one word");
          grammar_->fillers_inner.insert(numbers.front());
        }
      } else {
        words.fail("this key is not known: before, within, after");
      }
    });
  }

  void readToldAnyway(const GrammarNode& node) {
    node.each([&](const std::string& where, const GrammarNode& phrases) {
      if (where != "before" && where != "after")
        phrases.fail("this key is not known: before, after");
      auto& all = where == "before" ? grammar_->told_before : grammar_->told_after;
      addWords(phrases, &all);
      std::stable_sort(all.begin(), all.end(),
                       [](const Words& a, const Words& b) { return a.size() > b.size(); });
    });
  }

  static void addWords(const GrammarNode& node, WordPhrases* all) {
    for (const std::string& text : node.texts()) {
      for (const std::string& phrase : expanded(node, text)) {
        const Words words = splitWords(phrase);
        if (words.empty()) node.fail("'" + text + "' may be nothing");
        all->add(words);
      }
    }
  }

  static void addWords(const GrammarNode& node, std::vector<Words>* all) {
    for (const std::string& text : node.texts()) {
      for (const std::string& phrase : expanded(node, text)) all->push_back(splitWords(phrase));
    }
  }

  void readTourWords(const GrammarNode& node) {
    TourWords& words = grammar_->tour_words;
    const std::map<std::string, WordSet*> keys{
        {"left", &words.left},   {"right", &words.right}, {"side", &words.side},
        {"other", &words.other}, {"same", &words.same},   {"across", &words.across},
        {"back", &words.back},   {"order", &words.order}, {"and", &words.and_}};
    node.each([&](const std::string& key, const GrammarNode& all) {
      const auto found = keys.find(key);
      if (found == keys.end()) all.fail("this key is not known");
      addFolded(all, found->second);
    });
  }

  void readListSeparators(const GrammarNode& node) {
    const auto texts = node.texts();
    context_.list_separators.insert(context_.list_separators.end(), texts.begin(), texts.end());
  }

  void readAbbreviations(const GrammarNode& node) {
    for (const std::string& word : node.texts())
      grammar_->abbreviations.insert(hyselam::utf8Lower(word));
  }

  void readContractions(const GrammarNode& node) {
    node.each([&](const std::string& word, const GrammarNode& meaning) {
      grammar_->contractions[hyselam::utf8Lower(word)] = splitWords(meaning.text());
    });
  }

  void readLooseContractions(const GrammarNode& node) {
    node.each([&](const std::string& word, const GrammarNode& meaning) {
      const Words words = splitWords(meaning.text());
      if (words.empty()) meaning.fail("there is no word");
      grammar_->loose_contractions[hyselam::utf8Lower(word)] = words;
    });
  }

  void readSameWords(const GrammarNode& node) {
    node.each([&](const std::string& meaning, const GrammarNode& said) {
      const Words means = splitWords(meaning);
      for (const std::string& text : said.texts()) {
        for (const std::string& each : expanded(said, text)) {
          const Words words = splitWords(each);
          if (words.empty() || means.empty()) said.fail("'" + text + "' may be nothing");
          grammar_->same_words.emplace_back(words, means);
        }
      }
    });
  }

  void readUnits(const GrammarNode& node) {
    node.each([&](const std::string& name, const GrammarNode& unit) {
      readQuantity(name, unit, grammar_.get());
    });
  }

  void readNameTypes(const GrammarNode& node) {
    node.each([&](const std::string& name, const GrammarNode& type) {
      readNameType(name, type, grammar_.get(), &context_);
    });
  }

  void readMacros(const GrammarNode& node) {
    node.each([&](const std::string& name, const GrammarNode& macro) {
      for (const std::string& text : macro.texts()) context_.macros[name].push_back(text);
    });
  }

  void readClasses(const GrammarNode& node) {
    node.each([&](const std::string& name, const GrammarNode& entries) {
      entries.each([&](const std::string& value, const GrammarNode& texts) {
        for (const std::string& text : texts.texts()) {
          context_.classes[name][value].push_back(text);
        }
      });
    });
  }

  void noteIntents(const GrammarNode& node) {
    node.each([&](const std::string& name, const GrammarNode& intent) {
      intents_.emplace_back(name, intent);
    });
  }

  /// What may stand around clauses may stand around urgent words, too.
  void addLightWords() {
    CompiledGrammar& g = *grammar_;
    for (const auto* phrases : {&g.fillers_before, &g.fillers_after, &g.corrections}) {
      for (const Phrase& phrase : *phrases) {
        std::string text;
        for (const int word : phrase) text += g.vocabulary.text(word) + " ";
        g.urgent.add(UrgentKind::kAround, text);
      }
    }
    for (const int word : g.fillers_inner)
      g.urgent.add(UrgentKind::kAround, g.vocabulary.text(word));
  }

  void checkSeparators(const GrammarNode& root) const {
    for (const std::string& separator : context_.list_separators) {
      if (splitWords(separator).empty()) root.fail("a list separator is empty");
    }
  }

  /// Words that mean something here are no slips of the pen of others.
  void finishKnownWords() {
    CompiledGrammar& g = *grammar_;
    auto& known = g.known_words;
    for (std::size_t i = 0; i < g.vocabulary.size(); ++i) {
      known.insert(hyselam::utf8Fold(g.vocabulary.text(static_cast<int>(i))));
    }
    for (const auto& [word, value] : g.number_words) known.insert(word);
    for (const NameType& type : g.name_types) {
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
    for (const auto& [word, code] : g.refusing_words) known.insert(word);
    for (const std::string& word : g.abbreviations) known.insert(hyselam::utf8Fold(word));
  }

  void indexPhrases() {
    CompiledGrammar& g = *grammar_;
    g.before_starts = PhraseStarts(g.fillers_before);
    g.after_starts = PhraseStarts(g.fillers_after);
    g.correction_starts = PhraseStarts(g.corrections);
    g.separator_starts = PhraseStarts(g.clause_separators);
  }

  static void indexWords(NameType* type) {
    constexpr std::size_t kShortest = 2;
    for (const std::string& word : type->stop) {
      if (word.size() >= kShortest) type->stop_slips.add(word, 0);
    }
    for (const auto& [noun, kind] : type->nouns) {
      type->noun_beginnings.insert(noun.substr(0, noun.find(' ')));
    }
  }

  std::shared_ptr<CompiledGrammar> grammar_ = std::make_shared<CompiledGrammar>();
  PatternContext context_;
  std::vector<std::pair<std::string, GrammarNode>> intents_;
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
