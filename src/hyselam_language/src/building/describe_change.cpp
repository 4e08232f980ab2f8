#include "hyselam_language/building/describe_change.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "connection_rows.hpp"
#include "edit_description.hpp"
#include "fact_sentences.hpp"

namespace hyselam_topo {
namespace {

template <typename Value>
bool isIn(const std::vector<Value>& all, const Value& value) {
  return std::find(all.begin(), all.end(), value) != all.end();
}

/// Equal but for the order, which moves when another place goes.
bool sameFact(const DescribedConnection& a, const DescribedConnection& b) {
  DescribedConnection moved = b;
  moved.order = a.order;
  return a == moved;
}

/// Whether `now` tells all that was told before of two places.
bool refines(const DescribedConnection& now, const DescribedConnection& before) {
  if (before.side != Side::kUnknown && (now.side != before.side || now.from != before.from)) {
    return false;
  }
  return (!before.rank || before.rank == now.rank) &&
         (!before.distance || before.distance == now.distance);
}

class ChangeTeller {
 public:
  ChangeTeller(const DescribedBuilding& before, const DescribedBuilding& after,
               const Grammar& grammar)
      : before_(before),
        after_(after),
        old_(before_, grammar),
        new_(after_, grammar),
        lost_(before_, grammar, false) {
    if (before.robot_place) robot_ = *before.robot_place;
  }

  std::vector<std::string> tell() {
    if (after_.places.empty() && !before_.places.empty()) {
      say(new_.writer().sentence("all_gone", {}));
      return std::move(sentences_);
    }
    tellNames();
    if (after_.place_count && after_.place_count != before_.place_count) {
      say(new_.placeCount(*after_.place_count));
    }
    tellRelations(true);
    tellConnections();
    tellPlaces();
    tellRelations(false);
    for (const DescribedPlace& place : after_.places) {
      const bool is_new = before_.findPlace(place.id) == nullptr;
      if (is_new && told_.count(place.id) == 0) say(new_.exists(place.id));
    }
    tellRobot(after_.robot_place);
    tellLost();
    return std::move(sentences_);
  }

 private:
  void say(const std::string& sentence) { sentences_.push_back(sentence); }

  bool isGone(Id id) const { return after_.findPlace(id) == nullptr; }

  void tellNames() {
    for (DescribedPlace& place : before_.places) {
      const DescribedPlace* now = after_.findPlace(place.id);
      if (now == nullptr || now->name == place.name) continue;
      const SentenceWriter& writer = old_.writer();
      say(writer.sentence("renamed", {writer.place("place", before_, place.id),
                                      {"name", writer.quoted(now->name), false, false}}));
      // From here on its facts are compared under the new name.
      place.name = now->name;
      told_.insert(place.id);
    }
  }

  void tellRobot(const std::optional<Id>& place) {
    if (!place || robot_ == *place) return;
    robot_ = *place;
    told_.insert(robot_);
    say(new_.ofPlace("robot_place", robot_));
  }

  void tellConnections() {
    std::vector<DescribedConnection> news;
    for (const DescribedConnection& each : after_.connections) {
      const auto& old = before_.connections;
      const bool known = std::any_of(old.begin(), old.end(),
                                     [&](const auto& other) { return sameFact(each, other); });
      if (!known && !isTold(each, after_)) news.push_back(each);
    }
    const std::vector<ConnectionRow> rows = rowsOf(news, after_);
    // First what is seen from where the robot is now.
    if (after_.robot_place) {
      for (const ConnectionRow& row : rows) {
        if (row.from == *after_.robot_place) tell(row);
      }
    }
    for (const ConnectionRow& row : rows) {
      if (!after_.robot_place || row.from != *after_.robot_place) tell(row);
    }
  }

  void tell(const ConnectionRow& row) {
    // Sides are those that the robot sees.
    if (row.side != Side::kUnknown && (after_.robot_place || robot_ != 0)) tellRobot(row.from);
    for (const std::vector<DescribedConnection>& each : row.sentences()) {
      std::vector<Id> ids;
      ids.reserve(each.size());
      for (const DescribedConnection& connection : each) ids.push_back(connection.to);
      if (each.size() > 1 && row.side != Side::kUnknown) {
        say(new_.ofRow(row.from, row.side, ids));
      } else {
        for (const DescribedConnection& connection : each) say(new_.ofConnection(connection));
      }
      told_.insert(row.from);
      told_.insert(ids.begin(), ids.end());
    }
  }

  void tellPlaces() {
    for (const DescribedPlace& place : after_.places) {
      const DescribedPlace* old = before_.findPlace(place.id);
      const auto known = old == nullptr ? std::vector<std::string>{} : old_.ofPlace(*old);
      for (const std::string& sentence : new_.ofPlace(place)) {
        if (isIn(known, sentence)) continue;
        say(sentence);
        told_.insert(place.id);
      }
    }
  }

  /// `unplaced`: what comes after what, on no way from anywhere, before the robot is somewhere.
  void tellRelations(bool unplaced) {
    for (const DescribedRelation& each : after_.relations) {
      const bool is_unplaced = each.kind == RelationKind::kAfter && each.c == 0;
      if (is_unplaced != unplaced || isIn(before_.relations, each)) continue;
      if (each.side != Side::kUnknown && (after_.robot_place || robot_ != 0)) tellRobot(each.b);
      say(new_.ofRelation(each, robot_));
      for (const Id id : {each.a, each.b, each.c}) told_.insert(id);
    }
  }

  void tellLost() {
    for (const DescribedPlace& place : before_.places) {
      if (isGone(place.id)) say(old_.ofPlace("gone", place.id));
    }
    const auto noLonger = [&](const std::string& sentence) {
      say(new_.writer().sentence("no_longer", {{"fact", sentence, false, false}}));
    };
    for (const DescribedConnection& each : before_.connections) {
      if (isGone(each.from) || isGone(each.to)) continue;
      const DescribedConnection* now = findConnection(after_, each.from, each.to);
      if (now == nullptr ? isTold(each, before_) : refines(*now, each)) continue;
      noLonger(lost_.ofConnection(each));
    }
    for (const DescribedRelation& each : before_.relations) {
      const bool gone = isGone(each.a) || isGone(each.b) || (each.c != 0 && isGone(each.c));
      if (!gone && !isIn(after_.relations, each)) noLonger(lost_.ofRelation(each, robot_));
    }
    for (const DescribedPlace& place : before_.places) {
      if (isGone(place.id)) continue;
      const auto now = new_.ofPlace(*after_.findPlace(place.id));
      const auto old = old_.ofPlace(place), lost = lost_.ofPlace(place);
      for (std::size_t i = 0; i < old.size(); ++i) {
        if (!isIn(now, old[i])) noLonger(lost[i]);
      }
    }
    if (before_.place_count && !after_.place_count) {
      noLonger(lost_.placeCount(*before_.place_count));
    }
  }

  DescribedBuilding before_;  ///< under the names of `after_`
  const DescribedBuilding& after_;
  FactSentences old_, new_;
  FactSentences lost_;  ///< `old_` without capitals, for within a sentence
  Id robot_ = 0;
  std::set<Id> told_;
  std::vector<std::string> sentences_;
};

}  // namespace

std::vector<std::string> describeChange(const DescribedBuilding& before,
                                        const DescribedBuilding& after, const Grammar& grammar) {
  checkDescription(before, "description before");
  checkDescription(after, "description after");
  return ChangeTeller(before, after, grammar).tell();
}

}  // namespace hyselam_topo
