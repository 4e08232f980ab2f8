#include "fsd_localization/search/probation.hpp"

namespace fsd_localization {

void Probation::answered(double way, double probability, double sure) {
  if (!from_) return;
  doubtful_ = probability < 0.5;
  if (probability >= sure && way - *from_ >= kOwnScans) from_.reset();
}

}  // namespace fsd_localization
