// Training and evaluation of the reader of tours.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "annotated_tour.hpp"
#include "hyselam_language/grammar/grammar.hpp"
#include "hyselam_language/reader/tour_reader.hpp"
#include "reader/reader_model.hpp"
#include "reader/tour_model.hpp"

namespace hyselam_topo {
namespace language {

struct TourTrainingParams {
  double cost = 1.0;           ///< liblinear's C: smaller gives fewer weights
  std::size_t least_seen = 3;  ///< features of fewer examples are left out
  std::size_t folds = 5;       ///< of kinds of buildings
  TourWeights weights;
};

/// `reader`: the second reader's model, whose tagger helps.
TourModel trainTours(const Grammar& grammar, const ReaderModel& reader,
                     const std::vector<const AnnotatedTour*>& tours,
                     const TourTrainingParams& params);

/// How tours are read that the model was not trained with.
struct TourScore {
  std::size_t tours = 0;
  std::size_t rooms = 0;                        ///< that were told
  std::size_t named = 0;                        ///< of them, those that the reader has
  std::size_t others = 0;                       ///< that it has and nobody told of
  std::size_t sides_right = 0;                  ///< of those named
  std::size_t pairs = 0;                        ///< of two rooms in one row, read and true
  std::size_t pairs_right = 0;                  ///< in the true order
  std::vector<std::pair<double, bool>> sides;   ///< certainty, right
  std::vector<std::pair<double, bool>> orders;  ///< of neighbours in a row that are on that side

  /// Names given to the true doors: how probable, right.
  std::vector<std::pair<double, bool>> named_doors;
  std::size_t doors = 0;  ///< of rooms that were told
  /// After so many questions, of which each is answered: doors with their right names.
  std::vector<std::size_t> right_after;
  std::string words;  ///< what was missed or taken wrongly, for people

  void add(const TourScore& other);
};

TourScore scoreOf(const TourReader& reader, const AnnotatedTour& tour);

/// Fits the odds of sides and orders to what was left out; `score`: of models that are not
/// calibrated.
void calibrate(const TourScore& score, TourModel* model);

/// Kinds of buildings left out in turn.
TourScore evaluateTours(const Grammar& grammar, const ReaderModel& reader,
                        const std::vector<const AnnotatedTour*>& tours,
                        const TourTrainingParams& params);

}  // namespace language
}  // namespace hyselam_topo
