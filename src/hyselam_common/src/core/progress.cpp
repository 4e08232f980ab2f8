#include "hyselam_common/progress.hpp"

#include <unistd.h>

#include <cstdio>
#include <utility>

namespace hyselam {

Progress::Progress(std::string label, std::size_t total)
    : label_(std::move(label)),
      total_(total),
      shown_(static_cast<std::size_t>(-1)),
      enabled_(::isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (printed_) std::fputc('\n', stderr);
}

void Progress::update(std::size_t done) {
  if (!enabled_) return;
  const std::size_t step = total_ > 0 ? 100 * done / total_ : done / 1000;
  if (step == shown_) return;
  shown_ = step;
  printed_ = true;
  if (total_ > 0) {
    std::fprintf(stderr, "\r%s %3zu %%", label_.c_str(), step);
  } else {
    std::fprintf(stderr, "\r%s %zu", label_.c_str(), done);
  }
  std::fflush(stderr);
}

}  // namespace hyselam
