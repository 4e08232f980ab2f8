// Parameters described once give a range check and a table.
#include <iostream>

#include "hyselam_common/parameter_documents.hpp"

struct FilterParams {
  int particles = 500;
  double update_distance = 0.1;  // [m]

  void describe(hyselam::ParameterVisitor& visit) {
    using hyselam::Range;
    visit("particles", particles, Range::between(1, 100000), "", "size of the filter");
    visit("update_distance", update_distance, Range::atLeast(0.0), "m", "travel between updates");
  }
};

int main() {
  std::cout << hyselam::parameterMarkdown(hyselam::parameterRows<FilterParams>());
  FilterParams params;
  params.particles = 0;
  try {
    hyselam::checkParameters(params);
  } catch (const hyselam::ParameterError& error) {
    std::cout << error.what() << "\n";
  }
  return 0;
}
