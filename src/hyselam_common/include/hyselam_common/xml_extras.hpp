// What stands in an XML file beyond its format.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace hyselam {

/// What does not belong to the format but stood in a file: kept and written again.
struct XmlExtras {
  std::vector<std::pair<std::string, std::string>> attributes;  ///< name, value
  std::vector<std::string> elements;                            ///< XML text of each element
};

inline bool operator==(const XmlExtras& a, const XmlExtras& b) {
  return a.attributes == b.attributes && a.elements == b.elements;
}

}  // namespace hyselam
