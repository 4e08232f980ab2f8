// What a text may state: of one mention ("the kitchen is on your left") or of two ("the kitchen is
// next to the lab"), with the words around them that tell which, as features.
#pragma once

#include <optional>
#include <vector>

#include "heard_text.hpp"
#include "linear_classifier.hpp"

namespace hyselam_topo {
namespace language {

/// Numbers of mentions; the fact is told of `what`.
struct FactCandidate {
  std::size_t what = 0;
  std::optional<std::size_t> by;
};

/// The mentions of a text and which of them are told in a row ("the kitchen, the lab and the
/// store"): what is said before the first counts for all.
class MentionContext {
 public:
  /// Text and mentions must outlive this.
  MentionContext(const ReaderLexicon& lexicon, const HeardText& text,
                 const std::vector<Mention>& mentions);

  /// All mentions, and all pairs of them that are near each other, in both orders.
  std::vector<FactCandidate> candidates() const;
  Features features(const FactCandidate& candidate) const;
  /// Of the whole text, for orders and answers without names.
  Features textFeatures() const;

 private:
  void addUnary(std::size_t what, const std::string& prefix, Features* out) const;
  void addBetween(std::size_t left, std::size_t right, const std::string& prefix,
                  Features* out) const;
  /// The word at a place, or the kind of the mention there.
  std::string word(std::ptrdiff_t at) const;
  std::string headOf(std::size_t mention) const;
  std::size_t rowBegin(std::size_t mention) const;
  std::size_t sentenceBegin(std::size_t at) const;
  std::size_t sentenceEnd(std::size_t at) const;
  std::vector<std::string> words(std::size_t begin, std::size_t end) const;

  const HeardText& text_;
  const std::vector<Mention>& mentions_;
  std::vector<std::optional<std::size_t>> mention_at_;  // of each token
  std::vector<bool> goes_on_;  // the mention is in a row with the one before
};

}  // namespace language
}  // namespace hyselam_topo
