// A robot drives two laps of a circuit of five regions. The sequence of the words of their
// free-space densities tells that it was there before.
#include <cstdio>

#include "ngram_slam/matching/ngram_recognizer.hpp"

int main() {
  ngram_slam::NgramRecognizerParams params;
  params.levels = 1;
  params.matcher.min_n = {3};  // words of a match
  ngram_slam::NgramRecognizer recognizer(params);
  const double densities[] = {0.2, 0.6, 0.3, 0.9, 0.5};
  ngram_slam::DensityObservation observation;  // one each 0.1 m
  for (int region = 0; region < 10; ++region) {
    for (int i = 0; i < 20 + 10 * (region % 5); ++i) {
      observation.soft = densities[region % 5];
      observation.base_in_odom.x += 0.1;
      for (const ngram_slam::NgramMatch& match : recognizer.add(observation).matches) {
        std::printf("word %u is word %u again: %d words in sequence\n", match.newer, match.older,
                    match.n);
      }
    }
  }
  return 0;
}
