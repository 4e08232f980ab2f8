// Place graphs, and the filters over places in time.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/rng.hpp"
#include "hyselam_common/testing/files.hpp"
#include "selovis/filters/place_filter.hpp"
#include "selovis/places/place_transitions.hpp"

namespace selovis {
namespace {

using hyselam::InputError;
using hyselam::testing::messageOf;
using hyselam::testing::TemporaryDirectory;
using hyselam::testing::writeFile;

/// a - b - c - d in a row, e joined to b, f alone.
PlaceTransitions sixPlaces() {
  return {{"a", "b", "c", "d", "e", "f"}, {{0, 1}, {1, 2}, {2, 3}, {1, 4}}};
}

TEST(PlaceTransitions, ShortestPathsHaveDistanceAndFirstStep) {
  const PlaceDistances p = shortestPaths(sixPlaces());
  const auto d = [&](int i, int j) { return p.distance[static_cast<std::size_t>(i * 6 + j)]; };
  const auto a = [&](int i, int j) { return p.first_step[static_cast<std::size_t>(i * 6 + j)]; };
  EXPECT_EQ(d(3, 0), 3);
  EXPECT_EQ(a(3, 0), 1);  // from a towards d: b comes first
  EXPECT_EQ(a(0, 3), 2);
  EXPECT_EQ(a(4, 2), 1);
  EXPECT_EQ(d(5, 0), -1);
  EXPECT_EQ(a(5, 0), -1);
  EXPECT_EQ(d(2, 2), 0);
}

TEST(PlaceTransitions, JsonAndEdgeListAreTheSame) {
  TemporaryDirectory folder;
  writeFile(folder / "g.json",
            R"({"places": ["a", "b", "c"], "transitions": [["a", "b"], ["c", "b"]]})");
  writeFile(folder / "g.csv", "from,to\na,b\r\n# note\n\nb,c\na,b\n");
  const PlaceTransitions x = readPlaceTransitions(folder / "g.json"),
                         y = readPlaceTransitions(folder / "g.csv");
  EXPECT_EQ(x.places, y.places);
  EXPECT_EQ(x.pairs, y.pairs);
  EXPECT_TRUE(x.connected(2, 1));
  EXPECT_FALSE(x.connected(0, 2));
}

TEST(PlaceTransitions, BadFilesAreRefusedWithTheirName) {
  TemporaryDirectory folder;
  const std::pair<const char*, const char*> cases[] = {
      {"", "no places"},
      {"a,b,c\n", "line 1"},
      {"a,b\n,c\n", "line 2"},
      {"{\"places\": [\"a\"]}", "transitions"},
      {"{\"places\": [\"a\", \"a\"], \"transitions\": []}", "twice"},
      {"{\"places\": [\"a\"], \"transitions\": [[\"a\", \"x\"]]}", "not listed"},
      {"{\"places\": 3", "is no place graph"}};
  for (const auto& c : cases) {
    writeFile(folder / "g", c.first);
    const std::string what = messageOf<InputError>([&] { readPlaceTransitions(folder / "g"); });
    EXPECT_NE(what.find(c.second), std::string::npos) << c.first << ": " << what;
  }
  EXPECT_THROW(readPlaceTransitions(folder / "none"), InputError);
}

TEST(PlaceFilter, LowPassIsEquation615) {
  PlaceFilterParams p;
  p.kind = PlaceFilterKind::kLowPass;
  p.low_pass_alpha = 2.0;
  PlaceFilter filter({{"a", "b"}, {}}, p);
  filter.update({0.6, 0.4});
  EXPECT_NEAR(filter.probabilities()[0], 0.6, 1e-12);
  filter.update({0.0, 1.0});
  EXPECT_NEAR(filter.probabilities()[0], 1.2 / 3.0, 1e-12);
}

/// Eq. 6.21 to 6.25 as they stand, with the row scaled as in the filter.
std::vector<double> plainMarkov(const PlaceTransitions& g, const PlaceFilterParams& p,
                                const std::vector<double>& state,
                                const std::vector<double>& rating) {
  const int n = static_cast<int>(g.places.size());
  const PlaceDistances paths = shortestPaths(g);
  const double largest = *std::max_element(rating.begin(), rating.end());
  std::vector<std::vector<double>> t(n, std::vector<double>(n, 0.0));
  for (int j = 0; j < n; ++j) {
    double leaving = 0.0;
    for (int i = 0; i < n; ++i) {
      const int d = paths.distance[i * n + j];
      if (i == j || d < 0) continue;
      const double q = std::pow(p.markov.rho1 / d, p.markov.rho2) * rating[i] * largest;
      t[paths.first_step[i * n + j]][j] += q;
      leaving += q;
    }
    if (leaving > 1.0 - p.markov.min_stay_probability) {
      for (int i = 0; i < n; ++i) t[i][j] *= (1.0 - p.markov.min_stay_probability) / leaving;
      leaving = 1.0 - p.markov.min_stay_probability;
    }
    t[j][j] = 1.0 - leaving;
  }
  std::vector<double> next(n, 0.0);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) next[i] += t[i][j] * state[j];
  }
  return next;
}

PlaceTransitions randomGraph(hyselam::Rng& rng) {
  PlaceTransitions g;
  const int n = 1 + static_cast<int>(rng.below(15));
  for (int i = 0; i < n; ++i) g.places.push_back("p" + std::to_string(i));
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < i; ++j) {
      if (rng.below(4) == 0) g.pairs.emplace_back(i, j);
    }
  }
  return g;
}

std::vector<double> randomRatings(hyselam::Rng& rng, std::size_t n) {
  std::vector<double> r(n);
  double sum = 0.0;
  for (double& v : r) sum += v = rng.below(3) == 0 ? 0.0 : std::pow(rng.uniform(), 4.0);
  if (sum == 0.0) return std::vector<double>(n, 1.0 / static_cast<double>(n));
  for (double& v : r) v /= sum;
  return r;
}

TEST(MarkovChain, EqualsTheTranscriptionOfTheEquations) {
  hyselam::Rng rng(21);
  for (int round = 0; round < 200; ++round) {
    const PlaceTransitions g = randomGraph(rng);
    PlaceFilterParams p;
    p.kind = PlaceFilterKind::kMarkov;
    p.markov.rho1 = rng.uniform(0.2, 5.0);
    p.markov.rho2 = rng.uniform(0.0, 4.0);
    PlaceFilter filter(g, p);
    std::vector<double> state = filter.probabilities();
    for (int k = 0; k < 20; ++k) {
      const auto rating = randomRatings(rng, state.size());
      state = plainMarkov(g, p, state, rating);
      filter.update(rating);
      for (std::size_t i = 0; i < state.size(); ++i)
        ASSERT_NEAR(filter.probabilities()[i], state[i], 1e-9);
    }
  }
}

TEST(PlaceFilter, EveryFilterKeepsADistributionAndColumnsOfTheMarkovChainSumToOne) {
  hyselam::Rng rng(22);
  for (int round = 0; round < 300; ++round) {
    const PlaceTransitions g = randomGraph(rng);
    const std::size_t n = g.places.size();
    for (const PlaceFilterKind kind : {PlaceFilterKind::kNone, PlaceFilterKind::kLowPass,
                                       PlaceFilterKind::kMarkov, PlaceFilterKind::kBayes}) {
      PlaceFilterParams p;
      p.kind = kind;
      p.markov.rho1 = rng.uniform(0.01, 100.0);
      p.markov.rho2 = rng.uniform(0.0, 10.0);
      p.low_pass_alpha = rng.uniform(0.0, 50.0);
      p.bayes.likelihood_exponent = rng.uniform(0.1, 3.0);
      PlaceFilter filter(g, p);
      for (int k = 0; k < 30; ++k) {
        auto observed = randomRatings(rng, n);
        for (double& v : observed) v *= rng.uniform(0.5, 2.0);  // need not sum to 1
        filter.update(observed);
        double sum = 0.0;
        for (const double v : filter.probabilities()) {
          ASSERT_GE(v, 0.0);
          sum += v;
        }
        ASSERT_NEAR(sum, 1.0, 1e-9);
        for (std::size_t j = 0; kind == PlaceFilterKind::kMarkov && j < n; ++j) {
          double column = 0.0;
          for (std::size_t i = 0; i < n; ++i) {
            ASSERT_GE(filter.markovChain().matrix()[i * n + j], 0.0);
            column += filter.markovChain().matrix()[i * n + j];
          }
          ASSERT_NEAR(column, 1.0, 1e-9);
        }
      }
    }
  }
}

TEST(MarkovChain, IgnoresAnOutlierAndFollowsAChange) {
  PlaceFilter filter(sixPlaces(), {});
  for (int k = 0; k < 30; ++k) filter.update({0.9, 0.02, 0.02, 0.02, 0.02, 0.02});
  EXPECT_EQ(filter.estimate().place, 0);
  filter.update({0.02, 0.02, 0.02, 0.9, 0.02, 0.02});  // one outlier, three doors away
  EXPECT_NE(filter.estimate().place, 3);
  for (int k = 0; k < 30; ++k) filter.update({0.02, 0.02, 0.02, 0.9, 0.02, 0.02});
  EXPECT_EQ(filter.estimate().place, 3);
}

TEST(PlaceFilter, TwoLikelyNeighborsAreATransition) {
  PlaceFilterParams p;
  p.kind = PlaceFilterKind::kNone;
  PlaceFilter filter(sixPlaces(), p);
  filter.update({0.45, 0.4, 0.15, 0.0, 0.0, 0.0});
  EXPECT_EQ(filter.estimate().place, 0);
  EXPECT_EQ(filter.estimate().second, 1);
  filter.update({0.45, 0.0, 0.4, 0.15, 0.0, 0.0});  // likely both, but no door between them
  EXPECT_EQ(filter.estimate().second, -1);
  filter.update({0.6, 0.24, 0.1, 0.06, 0.0, 0.0});
  EXPECT_EQ(filter.estimate().second, -1);
}

TEST(PlaceFilter, UnknownBelowTheLimitAndInvalidProbabilitiesAreRefused) {
  PlaceFilterParams p;
  p.kind = PlaceFilterKind::kNone;
  p.min_place_probability = 0.5;
  PlaceFilter filter(sixPlaces(), p);
  EXPECT_EQ(filter.estimate().place, -1);  // nothing seen yet
  filter.update({0.4, 0.3, 0.3, 0, 0, 0});
  EXPECT_EQ(filter.estimate().place, -1);
  filter.update({0.6, 0.2, 0.2, 0, 0, 0});
  EXPECT_EQ(filter.estimate().place, 0);
  EXPECT_THROW(filter.update({0.5, 0.5}), InputError);
  EXPECT_THROW(filter.update({0.5, -0.1, 0.6, 0, 0, 0}), InputError);
  EXPECT_THROW(filter.update({NAN, 0, 0, 0, 0, 0}), InputError);
  filter.update({0, 0, 0, 0, 0, 0});  // tells nothing
  EXPECT_EQ(filter.estimate().place, 0);
  p.low_pass_alpha = -1.0;
  EXPECT_THROW(PlaceFilter(sixPlaces(), p), hyselam::ParameterError);
  EXPECT_THROW(placeFilterKindFromString("median"), InputError);
}

}  // namespace
}  // namespace selovis
