// Probabilities as odds, and their calibration.
#pragma once

#include <istream>
#include <string>

namespace hyselam_topo {
namespace language {

/// log(p / (1 - p)), kept finite.
double logOdds(double probability);

/// How probable it is that something read is right, by a logistic regression over what the
/// classifiers say of it and of the whole text, were all their decisions independent.
struct Odds {
  double own = 1.0;
  double whole = 0.0;
  double offset = 0.0;

  double of(double own_log_odds, double whole_log_odds) const;
  double probability(double own_p, double whole_p) const;
};

/// Reads "NAME OWN WHOLE OFFSET"; throws hyselam::InputError, naming the source, for anything else.
Odds readOdds(std::istream* in, const std::string& source, const std::string& name);

}  // namespace language
}  // namespace hyselam_topo
