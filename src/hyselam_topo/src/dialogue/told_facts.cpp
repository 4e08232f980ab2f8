#include "told_facts.hpp"

#include <algorithm>
#include <array>

#include "hyselam_language/building/describe_change.hpp"

namespace hyselam_topo {
namespace {

bool isOwned(const std::string& name) {
  static const std::array<const char*, 2> kEnglish{"'s ", "\xe2\x80\x99s "};
  if (std::any_of(kEnglish.begin(), kEnglish.end(),
                  [&](const char* sign) { return name.find(sign) != std::string::npos; })) {
    return true;
  }
  // "gabinete do Rui", but not "sala de estar".
  static const std::array<const char*, 5> kOf{" de ", " do ", " da ", " dos ", " das "};
  return std::any_of(kOf.begin(), kOf.end(), [&](const std::string& of) {
    const std::size_t at = name.find(of);
    if (at == std::string::npos || at + of.size() >= name.size()) return false;
    const char next = name[at + of.size()];
    return next >= 'A' && next <= 'Z';
  });
}

}  // namespace

Utterance asStatement(const Utterance& question, const std::string& intent) {
  Utterance statement = question;
  statement.kind = UtteranceKind::kStatement;
  statement.intent = intent;
  return statement;
}

Truth truthOf(const DescriptionBuilder& builder, Utterance statement) {
  DescriptionBuilder trial = builder;
  statement.correction = false;
  const std::vector<DescriptionIssue> issues = trial.add(statement);
  for (const DescriptionIssue& issue : issues) {
    if (issue.kind == IssueKind::kContradiction) return {false, issue.reason};
    if (issue.kind != IssueKind::kNotice) return {};
  }
  if (trial.building() == builder.building()) return {true, ""};
  return {};
}

std::vector<std::string> placesWhere(const DescriptionBuilder& builder, const Utterance& question) {
  std::vector<std::string> found;
  for (const DescribedPlace& place : builder.building().places) {
    Utterance statement = asStatement(question, "located");
    Slot slot;
    slot.name = "places";
    slot.type = "place";
    slot.names.emplace_back();
    slot.names.back().text = place.name;
    slot.names.back().quoted = true;
    statement.slots.push_back(std::move(slot));
    if (truthOf(builder, std::move(statement)).told == true) found.push_back(place.name);
  }
  return found;
}

std::vector<std::string> ownersOf(const DescribedPlace& place) {
  std::vector<std::string> owners;
  for (const std::string& name : allNamesOf(place)) {
    if (isOwned(name)) owners.push_back(name);
  }
  return owners;
}

std::vector<std::string> factsOf(const DescribedBuilding& building, Id place,
                                 const Grammar& grammar) {
  DescribedBuilding of_it, bare;
  for (const DescribedPlace& each : building.places) {
    DescribedPlace plain;
    plain.id = each.id;
    plain.name = each.name;
    plain.kind = each.kind;
    bare.places.push_back(plain);
    of_it.places.push_back(each.id == place ? each : plain);
  }
  for (const DescribedConnection& c : building.connections) {
    if (c.from == place || c.to == place) of_it.connections.push_back(c);
  }
  for (const DescribedRelation& r : building.relations) {
    if (r.a == place || r.b == place || r.c == place) of_it.relations.push_back(r);
  }
  return describeChange(bare, of_it, grammar);
}

}  // namespace hyselam_topo
