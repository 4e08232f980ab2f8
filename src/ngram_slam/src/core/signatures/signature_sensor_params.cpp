#include "ngram_slam/signatures/signature_sensor.hpp"

namespace ngram_slam {

void SignatureSensorParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("spacing", spacing, Range::between(0.1, 5.0), "m",
        "of way between places with a signature");
  visit("half_window", half_window, Range::between(1.0, 20.0), "m",
        "of way before and after a place, whose scans its signature is made of");
  visit("resolution", resolution, Range::between(0.05, 0.5), "m", "of the map of these scans");
}

void SignatureSensorParams::validate() const {
  hyselam::checkParameters(*this);
}

}  // namespace ngram_slam
