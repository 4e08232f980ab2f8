// "The third room on the right", "second left": a place told by its number and its side stands
// where a name of a place may stand.
#pragma once

#include <optional>
#include <vector>

#include "name_finder.hpp"
#include "pattern_run.hpp"

namespace hyselam_topo {
namespace language {

class NumberedPlaces {
 public:
  /// `words` must outlive this.
  explicit NumberedPlaces(SentenceWords* words) : words_(*words) {}

  /// Those that begin at token `at`, with or without an article, the shortest first: names with the
  /// reference kNumbered.
  std::vector<FoundName> find(std::size_t at, const NameType& type);

 private:
  bool mayBegin(std::size_t at, const NameType& type) const;
  /// "The third on the left of the lift": of that, not of the robot.
  bool goesOn(std::size_t end, const NameType& type) const;

  SentenceWords& words_;
  std::optional<PatternRun> run_;  ///< made where a number of a row is said
};

}  // namespace language
}  // namespace hyselam_topo
