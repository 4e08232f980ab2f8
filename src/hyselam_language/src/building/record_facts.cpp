#include "record_facts.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <tuple>
#include <utility>

#include "edit_description.hpp"
#include "fact_sentences.hpp"
#include "issue_texts.hpp"

namespace hyselam_topo {
namespace {

/// Distances are told by rule of thumb.
constexpr double kDistanceTolerance = 0.2;
constexpr std::size_t kBehindAll = static_cast<std::size_t>(-1);

bool isSymmetric(RelationKind kind) {
  return kind == RelationKind::kNextTo || kind == RelationKind::kOpposite ||
         kind == RelationKind::kJoined;
}

/// The same for relations that say the same.
std::tuple<RelationKind, Id, Id, Id, Side> meaning(const DescribedRelation& r) {
  Id a = r.a, b = r.b, c = r.c;
  if (isSymmetric(r.kind) && b < a) std::swap(a, b);
  if (r.kind == RelationKind::kBetween && c < b) std::swap(b, c);
  // From where the way comes does not change what comes after what.
  if (r.kind == RelationKind::kAfter) c = 0;
  return {r.kind, a, b, c, r.side};
}

std::string sideWords(Statement& s, Side side) {
  return issueText(s.listener().grammar, std::string("side_") + toString(side));
}

std::string sentenceOf(Statement& s, const DescribedRelation& relation) {
  const FactSentences facts(s.building(), s.listener().grammar, false);
  return facts.ofRelation(relation, s.building().robot_place.value_or(0));
}

/// The position of a rank among others of its side: those counted from the end come last.
int position(int rank) {
  constexpr int kFromEnd = 1 << 20;
  return rank > 0 ? rank : kFromEnd + rank;
}

/// The order for a place in its row: `wanted`, unless ranks tell otherwise.
std::size_t orderFor(const DescribedBuilding& building, const Placement& p, std::size_t wanted) {
  std::size_t low = 0, end = 0, high = kBehindAll;
  for (const DescribedConnection& other : building.connections) {
    if (other.from != p.from || other.side != p.side) continue;
    end = std::max(end, other.order + 1);
    if (!other.rank) continue;
    const bool before = p.rank ? position(*other.rank) < position(*p.rank) : *other.rank > 0;
    if (p.rank && before) low = std::max(low, other.order + 1);
    if (!before && (p.rank || *other.rank < 0)) high = std::min(high, other.order);
  }
  return std::max(low, std::min({wanted, end, high}));
}

void insertConnection(Statement& s, const Placement& p, std::size_t wanted) {
  auto& all = s.building().connections;
  DescribedConnection made;
  made.from = p.from;
  made.to = p.to;
  made.side = p.side;
  made.rank = p.rank;
  made.distance = p.distance;
  const bool seen = p.side != Side::kUnknown || p.distance;
  if (seen) made.seen_from = p.seen_from;
  for (const DescribedConnection& other : all) {
    const bool same_row = other.from == p.from && other.side == p.side;
    if (same_row && other.to == p.behind) wanted = other.order + 1;
  }
  made.order = orderFor(s.building(), p, wanted);
  for (DescribedConnection& other : all) {
    const bool same_row = other.from == p.from && other.side == p.side;
    if (same_row && other.order >= made.order) ++other.order;
  }
  all.push_back(made);
}

/// Whether they say the same when the one is said now: sides and orders are those of a view.
bool saysTheSame(Statement& s, const DescribedRelation& told, const DescribedRelation& now) {
  if (meaning(told) != meaning(now)) return false;
  const bool of_view = told.kind == RelationKind::kAtSide || told.kind == RelationKind::kAfter ||
                       told.kind == RelationKind::kBehind;
  return !of_view || lookAlike(told.seen_from, s.listener().viewpoint);
}

/// A side or a connection that was denied.
void checkDenied(Statement& s, const DescribedRelation& fact) {
  auto& all = s.building().relations;
  const auto denied = std::find_if(all.begin(), all.end(), [&](const DescribedRelation& other) {
    return other.denied && saysTheSame(s, other, fact);
  });
  if (denied == all.end()) return;
  s.replaces("denied", {{"fact", sentenceOf(s, *denied)}});
  all.erase(denied);
}

/// A correction takes the number of another place, and its order, which is put into `wanted`.
void checkRank(Statement& s, const Placement& p, std::size_t* wanted) {
  if (!p.rank) return;
  for (DescribedConnection& other : s.building().connections) {
    const bool taken = other.from == p.from && other.side == p.side && other.to != p.to &&
                       other.rank == p.rank && areSameView(other.seen_from, p.seen_from);
    if (!taken) continue;
    s.replaces("rank_taken", {{"rank", std::to_string(*p.rank)},
                              {"side", sideWords(s, p.side)},
                              {"place", s.nameOf(other.to)}});
    other.rank.reset();
    *wanted = other.order;
  }
}

/// What is told of a connection besides what was told before.
void mergeInto(Statement& s, const DescribedConnection& known, Placement* p) {
  if (p->side == Side::kUnknown && known.from == p->from) {
    p->side = sideSeenFrom(known.side, known.seen_from, p->seen_from);
    if (!p->rank && !p->distance) {
      p->side = known.side;
      p->seen_from = known.seen_from;
    }
  }
  const bool same_view = areSameView(known.seen_from, p->seen_from);
  const bool other_rank = same_view && known.rank && p->rank && *known.rank != *p->rank;
  if (other_rank) {
    s.replaces("other_rank", {{"place", s.nameOf(p->to)},
                              {"known", std::to_string(*known.rank)},
                              {"rank", std::to_string(*p->rank)}});
  }
  const bool both = same_view && known.distance && p->distance;
  const double apart = both ? std::abs(*known.distance - *p->distance) : 0.0;
  if (both && apart <= kDistanceTolerance * *known.distance) p->distance = known.distance;
  if (both && *p->distance != *known.distance) {
    s.replaces("other_distance", {{"place", s.nameOf(p->to)},
                                  {"known", shown(*known.distance)},
                                  {"distance", shown(*p->distance)}});
  }
  const bool same_side = known.side == p->side || known.side == Side::kUnknown;
  // "Here" is where the robot stands now, the third door was counted from elsewhere; the last is so
  // from everywhere.
  const bool here = p->distance == 0.0, was_here = known.distance == 0.0;
  const bool counted = known.rank.value_or(-1) > 0;
  if (!p->rank && same_side && !(here && counted)) p->rank = known.rank;
  const bool counts = p->rank.value_or(-1) > 0;
  if (!p->distance && !(was_here && counts)) p->distance = known.distance;
}

/// Whether nothing is left to do: seen from the other place, or contradicted.
bool isSettled(Statement& s, const DescribedConnection& known, const Placement& p) {
  if (p.side == Side::kUnknown) {
    if (known.from != p.to || known.side == Side::kUnknown) return false;
    if (p.rank || p.distance) {
      s.report(IssueKind::kNotice, "seen_from", {{"place", s.nameOf(known.from)}});
    }
    return true;
  }
  if (known.side == Side::kUnknown) return false;
  if (known.from == p.to) {
    if (s.isCorrection()) {
      s.setCorrected();
      return false;
    }
    s.report(IssueKind::kNotice, "seen_from", {{"place", s.nameOf(known.from)}});
    return true;
  }
  if (known.side == p.side) return false;
  if (s.isCorrection()) {
    s.setCorrected();
    return false;
  }
  s.report(IssueKind::kContradiction, "other_side",
           {{"place", s.nameOf(p.to)},
            {"known", sideWords(s, known.side)},
            {"side", sideWords(s, p.side)}});
  return true;
}

}  // namespace

DescribedRelation relationOf(RelationKind kind, Id a, Id b, Id c) {
  return {kind, a, b, c};
}

void recordConnection(Statement& s, const Placement& placement) {
  Placement p = placement;
  p.seen_from = s.listener().viewpoint;
  if (p.from == p.to) s.fail(IssueKind::kMeaningless, "itself", {{"place", s.nameOf(p.to)}});
  checkDenied(s, relationOf(RelationKind::kJoined, p.from, p.to));
  if (p.side != Side::kUnknown) {
    DescribedRelation at_side = relationOf(RelationKind::kAtSide, p.to, p.from);
    at_side.side = p.side;
    checkDenied(s, at_side);
  }
  const DescribedConnection* found = findConnection(s.building(), p.from, p.to);
  std::size_t wanted = kBehindAll;
  if (found != nullptr) {
    const DescribedConnection known = *found;
    // Seen from elsewhere it may well be on another side, and another number.
    const bool seen_anew = p.side != Side::kUnknown && known.side != Side::kUnknown &&
                           known.from == p.from && !areSameView(known.seen_from, p.seen_from);
    // "On the left" of the third on the left, said from farther on, tells nothing new.
    const bool said_again = seen_anew && !p.rank && !p.distance && p.behind == 0 &&
                            known.side == p.side && lookAlike(known.seen_from, p.seen_from);
    if (said_again) return;
    if (seen_anew) {
      s.setCorrected();
    } else {
      if (isSettled(s, known, p)) return;
      mergeInto(s, known, &p);
    }
    const bool stays = known.from == p.from && known.side == p.side && !seen_anew;
    if (stays && known.rank == p.rank && known.distance == p.distance && p.behind == 0) return;
    if (stays) wanted = known.order;
    checkRank(s, p, &wanted);
    removeConnection(known, &s.building());
  } else {
    checkRank(s, p, &wanted);
  }
  insertConnection(s, p, wanted);
}

/// What a correction takes the place of. "No, it is next to the lab": what it was said to be next
/// to; if nothing was, the one relation that the last statement told of it.
std::vector<DescribedRelation>::iterator replacedBy(Statement& s,
                                                    const DescribedRelation& relation) {
  auto& all = s.building().relations;
  const DescribedBuilding* before = s.listener().before_last;
  const auto wasTold = [&](const DescribedRelation& other) {
    if (before == nullptr) return false;
    const auto& told = before->relations;
    return std::find(told.begin(), told.end(), other) != told.end();
  };
  std::vector<std::vector<DescribedRelation>::iterator> same, last;
  for (auto i = all.begin(); i != all.end(); ++i) {
    if (i->denied || i->a != relation.a) continue;
    if (i->kind == relation.kind) same.push_back(i);
    if (!wasTold(*i)) last.push_back(i);
  }
  if (same.size() > 1) {
    same.erase(std::remove_if(same.begin(), same.end(), [&](auto i) { return wasTold(*i); }),
               same.end());
  } else if (same.empty()) {
    same = last;
  }
  return same.size() == 1 ? same.front() : all.end();
}

void recordRelation(Statement& s, const DescribedRelation& relation) {
  const auto& [kind, a, b, c, side, denied, seen_from] = relation;
  if (a == b || a == c || b == c) s.fail(IssueKind::kMeaningless, "twice");
  checkDenied(s, relation);
  auto& all = s.building().relations;
  const bool ordered = kind == RelationKind::kAfter || kind == RelationKind::kInside ||
                       kind == RelationKind::kLarger;
  if (ordered) {
    const DescribedRelation reversed = relationOf(kind, b, a);
    const auto found = std::find_if(all.begin(), all.end(), [&](const DescribedRelation& other) {
      return !other.denied && saysTheSame(s, other, reversed);
    });
    if (found != all.end()) {
      s.replaces("reversed", {{"fact", sentenceOf(s, *found)}});
      all.erase(found);
    }
  }
  const bool known = std::any_of(all.begin(), all.end(), [&](const DescribedRelation& other) {
    return !other.denied && saysTheSame(s, other, relation);
  });
  if (known) return;
  if (s.isCorrection() && !s.hasCorrected()) {
    if (const auto replaced = replacedBy(s, relation); replaced != all.end()) {
      all.erase(replaced);
      s.setCorrected();
    }
  }
  all.push_back(relation);
  const bool seen = kind == RelationKind::kAfter || kind == RelationKind::kBehind;
  if (seen) all.back().seen_from = s.listener().viewpoint;
}

void recordDenial(Statement& s, DescribedRelation denial) {
  denial.denied = true;
  if (denial.a == denial.b || denial.a == denial.c || denial.b == denial.c) {
    s.fail(IssueKind::kMeaningless, "twice");
  }
  auto& all = s.building().relations;
  bool is_known = false;
  all.erase(std::remove_if(all.begin(), all.end(),
                           [&](const DescribedRelation& other) {
                             if (!saysTheSame(s, other, denial)) return false;
                             is_known = is_known || other.denied;
                             return !other.denied;
                           }),
            all.end());
  s.setCorrected();
  if (const DescribedConnection* found = findConnection(s.building(), denial.a, denial.b)) {
    const bool side = denial.kind == RelationKind::kAtSide && found->from == denial.b &&
                      found->to == denial.a && found->side == denial.side &&
                      lookAlike(found->seen_from, s.listener().viewpoint);
    const bool end = denial.kind == RelationKind::kAtEndOf && found->side == Side::kUnknown &&
                     found->from == denial.b;
    if (side || end || denial.kind == RelationKind::kJoined) {
      removeConnection(*found, &s.building());
    }
  }
  if (is_known) return;
  all.push_back(denial);
  if (denial.kind == RelationKind::kAtSide) all.back().seen_from = s.listener().viewpoint;
}

void recordNext(Statement& s, Id place, Id last, Id robot) {
  recordRelation(s, relationOf(RelationKind::kAfter, place, last, robot));
  const DescribedConnection* found = findConnection(s.building(), robot, last);
  if (found == nullptr || found->from != robot || found->side == Side::kUnknown) return;
  Placement placement(robot, place);
  placement.side = found->side;
  placement.behind = last;
  recordConnection(s, placement);
}

}  // namespace hyselam_topo
