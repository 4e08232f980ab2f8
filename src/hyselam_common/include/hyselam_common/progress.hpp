// A progress line for people: on stderr, and only if that is a terminal.
#pragma once

#include <cstddef>
#include <string>

namespace hyselam {

class Progress {
 public:
  /// `total` 0: unknown, a count is shown.
  Progress(std::string label, std::size_t total);
  /// Ends the line if anything was shown.
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Cheap: prints only when the shown percentage (or every 1000th count) changes.
  void update(std::size_t done);

 private:
  std::string label_;
  std::size_t total_;
  std::size_t shown_;
  bool enabled_;
  bool printed_ = false;
};

}  // namespace hyselam
