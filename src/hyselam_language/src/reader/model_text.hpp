// The text of a learnt model: its format with a version, lines that say where it comes from, and
// sections "[name]".
#pragma once

#include <istream>
#include <map>
#include <string>

namespace hyselam_topo {
namespace language {

/// What a model says of itself, each a line of its head.
struct ModelOrigin {
  std::string language;
  std::string command;   ///< that made it
  std::string data;      ///< that it was learnt from
  std::string left_out;  ///< how it fares on writers whom it was not learnt from

  /// With the line of the format before it.
  std::string toText(const std::string& format) const;
};

struct ModelText {
  ModelOrigin origin;
  std::map<std::string, std::string> sections;

  /// Throws hyselam::InputError that names `source`, and the line, for a text of another format;
  /// `retrain`: the command that makes it anew.
  static ModelText read(const std::string& source, const std::string& text,
                        const std::string& format, const std::string& retrain);
  /// Throws hyselam::InputError if it is missing.
  const std::string& section(const std::string& source, const std::string& name) const;
};

}  // namespace language
}  // namespace hyselam_topo
