#include "ngram_slam/words/density_regions.hpp"

#include "hyselam_common/errors.hpp"

namespace ngram_slam {

DensityRegionBuilder::DensityRegionBuilder(int t_o, std::uint32_t begin)
    : t_o_(static_cast<std::uint32_t>(t_o)), next_(begin), begin_(begin), last_begin_(begin) {
  if (t_o < 1) throw hyselam::ParameterError("t_o", t_o, ">= 1 [observations]");
}

std::optional<DensityRegion> DensityRegionBuilder::add(int density_class) {
  const bool same = next_ != begin_ && density_class == last_;
  if (!same) {
    last_ = density_class;
    last_begin_ = next_;
  }
  ++next_;
  if (next_ - last_begin_ < t_o_) return std::nullopt;
  if (region_ && region_->density_class == last_) return std::nullopt;
  // The class has come of age: it has been a region since it was first seen.
  std::optional<DensityRegion> complete = region_;
  if (complete) {
    complete->end = last_begin_;
    begin_ = last_begin_;
  }
  region_ = DensityRegion{last_, begin_, next_};
  return complete;
}

std::optional<DensityRegion> DensityRegionBuilder::current() const {
  std::optional<DensityRegion> r = region_;
  if (r) r->end = next_;
  return r;
}

std::optional<DensityRegion> DensityRegionBuilder::finish() {
  const std::optional<DensityRegion> r = current();
  region_.reset();
  begin_ = last_begin_ = next_;
  return r;
}

}  // namespace ngram_slam
