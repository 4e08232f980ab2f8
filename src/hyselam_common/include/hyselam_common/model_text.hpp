// Models as text: a line with the format, four with the origin, lines of weights, a checksum.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace hyselam {

/// Where a model comes from, as stands in its file; a line each.
struct ModelOrigin {
  std::string command;    ///< that trained it
  std::string data;       ///< what it was trained on, with checksums
  std::string in_sample;  ///< scores on what it was trained on
  std::string left_out;   ///< scores on what was left out of the training
};

/// What stands in a file before a model's weights: `format`, e.g. "hyselam_border_trees 1".
std::string modelHead(const std::string& format, const ModelOrigin& origin);

/// The whole file: the body with the line of its checksum.
std::string withChecksum(const std::string& body);

/// Reads the lines of a model one after another; knows where it is for its messages. All methods
/// throw InputError with source and line.
class ModelLines {
 public:
  /// Checks size and checksum. `what`: the file's kind for messages, e.g. "file of border trees".
  /// Text and source must outlive this.
  ModelLines(std::string_view text, const std::string& source, const std::string& what,
             std::size_t most_mebibytes);

  /// Takes what modelHead() gives; another format or version is refused.
  ModelOrigin head(const std::string& format);

  std::string_view next();
  /// The fields of the next line, at least one.
  std::vector<std::string_view> nextFields();
  /// What follows "KEY " in the next line.
  std::string valueOf(const std::string& key);
  /// The same, as a whole number of 1 .. most.
  std::size_t countOf(const std::string& key, std::size_t most);
  /// Refuses lines after the last one. `what`: that was read, e.g. "trees".
  void end(const std::string& what);

  [[noreturn]] void fail(const std::string& reason) const;

 private:
  const std::string& source_;
  std::string_view rest_;
  std::size_t line_ = 0;
};

}  // namespace hyselam
