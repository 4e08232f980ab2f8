// Facts of two or three places taken into a description: connections, relations, denials, each
// checked against what was told before.
#pragma once

#include <optional>

#include "statement.hpp"

namespace hyselam_topo {

/// A connection to record, without side unless one is given; its order follows from rank and
/// `behind`.
struct Placement {
  Placement() = default;
  Placement(Id from_place, Id to_place) : from(from_place), to(to_place) {}

  Id from = 0;
  Id to = 0;
  Side side = Side::kUnknown;
  std::optional<int> rank;
  std::optional<double> distance;
  Id behind = 0;  ///< right after this one, if it is in the same row
  /// From where side, rank and distance are meant; recordConnection() sets it.
  std::optional<hyselam::Pose2> seen_from;
};

/// Joins two places, or tells more of two joined ones. Contradictions are reported and left out
/// (Statement::Failed for those of rank and distance).
void recordConnection(Statement& statement, const Placement& placement);

/// Records a relation unless it is known.
void recordRelation(Statement& statement, const DescribedRelation& relation);

/// "not": an equal fact is removed, the denial is kept.
void recordDenial(Statement& statement, DescribedRelation denial);

/// "The next one": right after the place `last`, seen from where the robot is (0: nowhere).
void recordNext(Statement& statement, Id place, Id last, Id robot);

/// A relation of two or three places.
DescribedRelation relationOf(RelationKind kind, Id a, Id b, Id c = 0);

}  // namespace hyselam_topo
