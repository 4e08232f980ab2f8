// What a description consists of while people are telling it: the facts, and what they have in mind
// when they say "it" or "the same side".
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "hyselam_language/building/described_building.hpp"

namespace hyselam_topo {

struct DescriptionContext {
  /// What places were called besides their names and aliases: "110" for "room 110".
  std::map<Id, std::vector<std::string>> variants;
  std::vector<Id> subjects;  ///< what "it" and "they" may mean
  /// The places last listed or counted, for "the first one", "the other one".
  std::vector<Id> group;
  std::vector<Id> pair;        ///< two places told to lie side by side or opposite: "the two"
  std::set<Id> told_of_group;  ///< those that a statement of its own was about since
  std::optional<Side> side;    ///< what "the same side" may mean
  /// The kind of the place named last, for "Mary's" after "John's office": "office".
  std::string kind_word;
  /// The same of the last name that told more than the kind ("the small kitchen"), for "the big
  /// one", and of the last that told whose it is ("the girls' toilets"), for "the boys'".
  std::string described_kind, owned_kind;
  /// The last sentence was not understood: a correction may mean it.
  bool after_refusal = false;

  /// What "it", "they" and "the other one" mean is forgotten; names stay.
  void forgetReferences();
};

struct DescriptionState {
  DescribedBuilding building;
  DescriptionContext context;
};

}  // namespace hyselam_topo
