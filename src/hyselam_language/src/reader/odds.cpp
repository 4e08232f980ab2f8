#include "odds.hpp"

#include <algorithm>
#include <cmath>

#include "hyselam_common/errors.hpp"

namespace hyselam_topo {
namespace language {
namespace {

constexpr double kMostOdds = 1000.0;  // of a calibration: more is a mistake

}  // namespace

double logOdds(double probability) {
  constexpr double kSmallest = 1e-12;  // no decision is ever all
  const double p = std::min(std::max(probability, kSmallest), 1.0 - kSmallest);
  return std::log(p / (1.0 - p));
}

double Odds::of(double own_log_odds, double whole_log_odds) const {
  return 1.0 / (1.0 + std::exp(-(own * own_log_odds + whole * whole_log_odds + offset)));
}

double Odds::probability(double own_p, double whole_p) const {
  return of(logOdds(own_p), logOdds(whole_p));
}

Odds readOdds(std::istream* in, const std::string& source, const std::string& name) {
  Odds odds;
  std::string said;
  if (!(*in >> said >> odds.own >> odds.whole >> odds.offset) || said != name) {
    throw hyselam::InputError(source, "[calibration]", "needs '" + name + "' and three numbers");
  }
  for (const double each : {odds.own, odds.whole, odds.offset}) {
    if (std::abs(each) > kMostOdds) {
      throw hyselam::InputError(source, "[calibration]",
                                "the numbers of '" + name + "' are too large");
    }
  }
  return odds;
}

}  // namespace language
}  // namespace hyselam_topo
