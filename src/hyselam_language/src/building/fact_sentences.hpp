// Each fact of a description as one sentence that TopoParser understands.
#pragma once

#include <string>
#include <vector>

#include "hyselam_language/building/described_building.hpp"
#include "hyselam_language/building/place_names.hpp"
#include "sentence_writer.hpp"

namespace hyselam_topo {

class FactSentences {
 public:
  /// `building` must outlive this.
  FactSentences(const DescribedBuilding& building, const Grammar& grammar, bool capitals = true);

  /// Sizes, parts, kind (unless the name implies it), doors, floor, aliases; not that it exists.
  std::vector<std::string> ofPlace(const DescribedPlace& place) const;
  /// Where `to` lies, seen from `from`: "The second place on the left of the corridor is room B."
  std::string ofConnection(const DescribedConnection& connection) const;
  /// Several places at one side without rank and distance, in their order.
  std::string ofRow(Id from, Side side, const std::vector<Id>& ids) const;
  /// `robot`: where the robot is by then; "after" of another place says on the way from where.
  std::string ofRelation(const DescribedRelation& relation, Id robot) const;
  std::string exists(Id id) const;
  std::string placeCount(int count) const;
  /// A key of `say` with one {place}.
  std::string ofPlace(const std::string& key, Id id) const;

  const SentenceWriter& writer() const { return writer_; }

 private:
  SaidValue where(Id from, Side side) const;
  SaidValue which(int rank) const;

  const DescribedBuilding& building_;
  Grammar grammar_;
  PlaceNames names_;
  SentenceWriter writer_;
};

/// Whether the relation "at the end" tells the connection, too.
bool isTold(const DescribedConnection& connection, const DescribedBuilding& building);

}  // namespace hyselam_topo
