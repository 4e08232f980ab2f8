#include "fact_labels.hpp"

#include <sstream>

namespace hyselam_topo {
namespace language {

std::vector<std::string> labelParts(const std::string& label) {
  std::vector<std::string> parts;
  std::istringstream fields(label);
  for (std::string part; std::getline(fields, part, '/');) parts.push_back(part);
  return parts;
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
