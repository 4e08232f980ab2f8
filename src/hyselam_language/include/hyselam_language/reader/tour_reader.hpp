// The reader of tours: somebody who knows a building shows the robot round and talks as people do
// ("... and that one, with the coats outside, that's the staff room, the lab's past it, and across
// from us you've got Maureen"). No sentence of it has to be understood. What the words around the
// rooms' names say of sides and order, as learnt from such talk, is laid out together: the
// likeliest rows on both sides of the corridor, and how sure each place in them is.
//
// It never decides: rows are read back and asked, and what is not sure weighs less in TopoMerg.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hyselam_language/building/described_building.hpp"
#include "hyselam_language/grammar/grammar.hpp"
#include "hyselam_language/grammar/utterance.hpp"
#include "hyselam_language/reader/tour_evidence.hpp"

namespace hyselam_topo {

struct TourName {
  std::string name;                  ///< as first said, without article: "staff room"
  std::vector<std::string> aliases;  ///< what else it was called: "doctor" of "Doctor Silva"
  std::vector<TextRange> said;       ///< where in the text
  bool is_name = true;               ///< false: "my office", "the next door"
};

struct TourRoom : TourName {
  double side_certainty = 1.0;   ///< that it is on this side
  double order_certainty = 1.0;  ///< that it comes behind the one before it in its row
};

/// Seen from the beginning of the corridor, along it.
struct ToldTour {
  std::vector<TourRoom> left, right;  ///< the nearest first
  std::vector<TourName> names;        ///< of all rooms that were spoken of ...
  TourEvidence evidence;              ///< ... and what was said of them

  bool empty() const { return left.empty() && right.empty(); }
};

/// Immutable and cheap to copy.
class TourReader {
 public:
  /// `reader`: a model of the second reader (fact_reader.hpp), `tours`: one of this; of the
  /// language of the grammar. Throws hyselam::InputError, naming the source and the line.
  TourReader(const Grammar& grammar, const GrammarSource& reader, const GrammarSource& tours);
  /// The shipped models of the grammar's language; throws hyselam::InputError if there are none.
  static TourReader shipped(const Grammar& grammar);
  static bool isShipped(const std::string& language);

  /// Texts of any content; of those longer than 20,000 bytes or 60 rooms only what comes before.
  /// The same text gives the same result.
  ToldTour read(const std::string& text) const;
  /// Which name of a tour a name means, that was said besides; nothing: none, or several.
  std::optional<std::size_t> find(const ToldTour& tour, const std::string& name) const;

 private:
  struct Model;
  std::shared_ptr<const Model> model_;
};

/// The tour as a description: both rows are seen from the corridor, in which the robot stands at
/// the beginning and looks along it. `corridor`: what it is called.
DescribedBuilding describeTour(const ToldTour& tour, const std::string& corridor);

}  // namespace hyselam_topo
