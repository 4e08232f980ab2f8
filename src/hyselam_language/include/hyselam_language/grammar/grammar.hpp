// A language as data: sentence patterns, word classes, number words, units, what may be a name.
// The files are share/hyselam_language/grammar/*.yaml; their format is explained in their comments
// and in the README. The library carries the shipped ones within itself.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "hyselam_language/grammar/utterance.hpp"

namespace hyselam_topo {

namespace language {
struct CompiledGrammar;
}

/// Where a grammar's text comes from.
struct GrammarSource {
  std::string name;  ///< for errors: the file
  std::string yaml;
};

/// Immutable and cheap to copy.
class Grammar {
 public:
  /// What one kind of sentence means.
  struct Intent {
    std::string name;
    UtteranceKind kind = UtteranceKind::kStatement;
    std::vector<std::string> examples;
    bool only_expected = false;  ///< understood only when ParseOptions::expected names it
    bool refused = false;        ///< recognized in order to say why it is not understood
  };

  /// One grammar of one or several sources of one language: later ones add word classes, macros,
  /// kinds of names, intents and words to the first. Throws hyselam::InputError, naming source, key
  /// and reason, for text that is no YAML, unknown or missing keys, patterns with unbalanced
  /// brackets or unknown parts, macros that contain themselves, and patterns that match nothing or
  /// everything.
  static Grammar fromYaml(const std::vector<GrammarSource>& sources);
  /// The same from files; throws also if one cannot be read.
  static Grammar load(const std::vector<std::string>& paths);
  /// "en" or "pt"; throws hyselam::InputError for other languages.
  static Grammar shipped(const std::string& language);
  static std::vector<std::string> shippedLanguages();
  /// The text of a shipped grammar, to build on with fromYaml().
  static GrammarSource shippedSource(const std::string& language);

  const std::string& language() const;  ///< "en"
  const std::string& title() const;     ///< "English"
  std::vector<Intent> intents() const;
  /// Text of the section `say` of the file, for what the robot or a simulated person says;
  /// throws hyselam::InputError if it is missing.
  const std::string& say(const std::string& key) const;
  bool has(const std::string& key) const;
  /// The reason of a refusal by its code, with the words at fault put in; "" for unknown codes.
  std::string reason(const std::string& code, const std::string& word) const;

  /// Whether a name can be said without quotation marks and is then understood as it is.
  bool isPlainName(const std::string& name, const std::string& type = "place") const;
  /// All words that the grammar knows, for vocabularies of speech recognisers and completion.
  std::vector<std::string> words() const;

  const language::CompiledGrammar& compiled() const { return *compiled_; }

 private:
  explicit Grammar(std::shared_ptr<const language::CompiledGrammar> compiled)
      : compiled_(std::move(compiled)) {}
  std::shared_ptr<const language::CompiledGrammar> compiled_;
};

}  // namespace hyselam_topo
