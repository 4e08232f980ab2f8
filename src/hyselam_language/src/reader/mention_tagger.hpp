// Where a text names things, persons and values: each word begins a mention, goes on with it, or
// is none (BIO tags), by its own looks and its neighbours; the likeliest row of tags counts.
#pragma once

#include <string>
#include <vector>

#include "heard_text.hpp"
#include "linear_classifier.hpp"

namespace hyselam_topo {
namespace language {

/// "O", or B or I with the kind of the mention: "B-thing".
std::vector<std::string> tagsOf(const HeardText& text, const std::vector<Mention>& mentions);

/// Refuses a tagger that has no "O", or tags that tagsOf() never gives. Throws InputError with the
/// source.
void checkTags(const std::string& source, const LinearClassifier& tagger);

/// What the word at that place looks like to the tagger.
Features tokenFeatures(const HeardText& text, std::size_t at);
/// What it looks like besides, behind a word of that tag.
void addTagBefore(const HeardText& text, std::size_t at, const std::string& tag,
                  Features* features);

struct FoundMentions {
  /// Their probability is that of the least likely tag within and at the end.
  std::vector<Mention> mentions;
  /// That each word, seen without the tag before it, belongs to a mention.
  std::vector<double> name_probabilities;
};
/// `more`: further features of each word; empty: none. `eager`: as many nats a word counts more as
/// part of a name than the tagger has it.
FoundMentions findMentions(const LinearClassifier& tagger, const HeardText& text,
                           const std::vector<Features>& more = {}, double eager = 0.0);

}  // namespace language
}  // namespace hyselam_topo
