// Whether a text is in a language that the robot does not speak.
#pragma once

#include <map>
#include <set>
#include <string>

namespace hyselam_topo {

class OtherLanguages {
 public:
  /// Throws hyselam::InputError for text that is no such file.
  static OtherLanguages fromYaml(const std::string& source, const std::string& yaml);
  /// The shipped file.
  static const OtherLanguages& shipped();

  /// The language that most words are of: "fr"; "" where it is one of `spoken`, or not clear.
  std::string find(const std::string& text, const std::set<std::string>& spoken) const;

 private:
  std::map<std::string, std::set<std::string>> words_;  ///< of each language, in lower case
};

}  // namespace hyselam_topo
