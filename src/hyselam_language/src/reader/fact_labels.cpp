#include "fact_labels.hpp"

#include <algorithm>
#include <set>
#include <sstream>

#include "hyselam_common/errors.hpp"

namespace hyselam_topo {
namespace language {

std::vector<std::string> labelParts(const std::string& label) {
  std::vector<std::string> parts;
  std::istringstream fields(label);
  for (std::string part; std::getline(fields, part, '/');) parts.push_back(part);
  return parts;
}

void checkLabels(const std::string& source, const LinearClassifier& classifier, int names) {
  const auto& labels = classifier.classes();
  if (std::find(labels.begin(), labels.end(), kNoFact) == labels.end()) {
    throw hyselam::InputError(source, "'" + kNoFact + "'", "no such class");
  }
  for (const std::string& label : labels) {
    const std::vector<std::string> parts = labelParts(label);
    const bool any_empty =
        parts.empty() || label.back() == '/' || std::count(parts.begin(), parts.end(), "") != 0;
    const bool has_names = std::count(parts.begin(), parts.end(), "*") == names;
    if (label == kNoFact || (!any_empty && has_names && parts.front() != "*")) continue;
    throw hyselam::InputError(source, "'" + label + "'",
                              "is no label of a fact with " + std::to_string(names) + " names");
  }
}

bool isSymmetric(const std::string& relation) {
  static const std::set<std::string> kSymmetric{"next", "opposite", "joined", "same"};
  return kSymmetric.count(relation) != 0;
}

ReadFact factOf(const std::string& label, const std::vector<FactArgument>& mentions) {
  const std::vector<std::string> parts = labelParts(label);
  ReadFact fact;
  fact.relation = parts.front();
  auto next = mentions.begin();
  for (std::size_t i = 1; i < parts.size(); ++i) {
    if (parts[i] == "*" && next != mentions.end()) {
      fact.arguments.push_back(*next++);
    } else {
      fact.arguments.push_back({parts[i], "", {}});
    }
  }
  return fact;
}

}  // namespace language
}  // namespace hyselam_topo
