// A confusion matrix in a file, for scripts/plot_confusion or a spreadsheet.
#pragma once

#include <cstddef>
#include <ostream>
#include <string>
#include <vector>

#include "hyselam_common/atomic_file.hpp"

namespace hyselam {

/// Counts of answers: a row for each true class, a column for each predicted one.
struct ConfusionTable {
  std::vector<std::string> truth;      ///< names of the rows
  std::vector<std::string> predicted;  ///< names of the columns
  std::vector<std::vector<std::size_t>> counts;
};

/// A field of a CSV file (RFC 4180), between quotes where it has to be.
inline std::string csvField(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string out = "\"";
  for (char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

/// Writes `truth,NAME,NAME…` and a line of counts for each true class.
/// @throws InputError if the file cannot be written
inline void writeConfusionCsv(const std::string& path, const ConfusionTable& table) {
  writeFileAtomically(path, [&](std::ostream& out) {
    out << "truth";
    for (const std::string& name : table.predicted) out << ',' << csvField(name);
    out << '\n';
    for (std::size_t row = 0; row < table.truth.size(); ++row) {
      out << csvField(table.truth[row]);
      for (const std::size_t n : table.counts[row]) out << ',' << n;
      out << '\n';
    }
  });
}

}  // namespace hyselam
