#include "hyselam_language/reader/tour_reader.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "hyselam_common/embedded_text.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/utf8.hpp"
#include "hyselam_language/building/place_names.hpp"
#include "reader_model.hpp"
#include "shipped_readers.hpp"
#include "shipped_tours.hpp"
#include "tour_evidence.hpp"
#include "tour_mentions.hpp"

namespace hyselam_topo {

using namespace language;  // NOLINT: the implementation of a class of its parent

struct TourReader::Model {
  Grammar grammar;
  PlaceNames names;
  ReaderModel reader;
  TourModel tours;
};

namespace {

constexpr std::size_t kLongestText = 20000;  // bytes
constexpr std::size_t kMostRooms = 60;

template <std::size_t N>
const hyselam::EmbeddedText* embedded(const hyselam::EmbeddedText (&all)[N],
                                      const std::string& language) {
  const auto* found =
      std::find_if(std::begin(all), std::end(all),
                   [&](const hyselam::EmbeddedText& each) { return language == each.key; });
  return found == std::end(all) ? nullptr : found;
}

void requireLanguage(const std::string& source, const ModelOrigin& origin, const Grammar& grammar) {
  if (origin.language == grammar.language()) return;
  throw hyselam::InputError(source, "language",
                            "is '" + origin.language + "', not '" + grammar.language() + "'");
}

/// Not within a character.
std::string beginningOf(const std::string& text) {
  if (text.size() <= kLongestText) return text;
  std::size_t end = kLongestText;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xc0u) == 0x80u) --end;
  return text.substr(0, end);
}

std::vector<TourRoom> rowOf(const TourModel& model, const std::vector<TourLayout::Room>& row,
                            const std::vector<TourName>& names) {
  std::vector<TourRoom> told;
  double certainty = 1.0;  // of the order across rooms without a name
  for (const TourLayout::Room& each : row) {
    certainty = std::min(certainty, each.order_certainty);
    if (!names[each.room].is_name) continue;
    TourRoom room{names[each.room], model.of_sides.probability(each.side_certainty, 0.5), 1.0};
    if (!told.empty()) room.order_certainty = model.of_orders.probability(certainty, 0.5);
    told.push_back(std::move(room));
    certainty = 1.0;
  }
  return told;
}

std::vector<TourName> namesOf(const HeardText& text, const std::vector<Mention>& mentions,
                              const NamedRooms& rooms) {
  std::vector<TourName> names;
  for (std::size_t room = 0; room < rooms.names.size(); ++room) {
    const auto& said = rooms.names[room];
    names.push_back({said.front(), {said.begin() + 1, said.end()}, {}, rooms.has_name[room] != 0});
  }
  for (std::size_t m = 0; m < mentions.size(); ++m)
    names[rooms.room_of[m]].said.push_back(text.rangeOf(mentions[m]));
  return names;
}

}  // namespace

TourReader::TourReader(const Grammar& grammar, const GrammarSource& reader,
                       const GrammarSource& tours)
    : model_(std::make_shared<const Model>(Model{grammar, PlaceNames({grammar}),
                                                 ReaderModel::fromText(reader.name, reader.yaml),
                                                 TourModel::fromText(tours.name, tours.yaml)})) {
  requireLanguage(reader.name, model_->reader.origin, grammar);
  requireLanguage(tours.name, model_->tours.origin, grammar);
}

bool TourReader::isShipped(const std::string& language) {
  return embedded(kShippedReaders, language) != nullptr &&
         embedded(kShippedTours, language) != nullptr;
}

TourReader TourReader::shipped(const Grammar& grammar) {
  const std::string& language = grammar.language();
  if (!isShipped(language))
    throw hyselam::InputError("reader of tours", language, "no such model is shipped");
  return TourReader(grammar,
                    {"reader_" + language + ".txt", embedded(kShippedReaders, language)->text},
                    {"tours_" + language + ".txt", embedded(kShippedTours, language)->text});
}

ToldTour TourReader::read(const std::string& said) const {
  const CompiledGrammar& grammar = model_->grammar.compiled();
  const HeardText text(grammar, model_->reader.lexicon, beginningOf(said));
  std::vector<Mention> mentions =
      roomMentions(model_->reader.tagger, model_->tours.tagger, text, model_->tours.weights.name);
  // What the tour leads along is no room beside it.
  mentions.erase(std::remove_if(mentions.begin(), mentions.end(),
                                [&](const Mention& each) {
                                  return model_->names.kindOf(text.nameOf(each)) ==
                                         PlaceKind::kCorridor;
                                }),
                 mentions.end());
  NamedRooms rooms = namedRooms(grammar, model_->names, text, mentions);
  while (rooms.names.size() > kMostRooms) {
    mentions.pop_back();
    rooms = namedRooms(grammar, model_->names, text, mentions);
  }
  const TourContext context(grammar.tour_words, text, mentions, rooms.room_of);
  ToldTour tour;
  tour.names = namesOf(text, mentions, rooms);
  tour.evidence = evidenceOf(model_->tours, context, rooms.room_of, rooms.names.size());
  const TourLayout layout = layOut(tour.evidence);
  tour.left = rowOf(model_->tours, layout.left, tour.names);
  tour.right = rowOf(model_->tours, layout.right, tour.names);
  return tour;
}

std::optional<std::size_t> TourReader::find(const ToldTour& tour, const std::string& name) const {
  std::vector<std::vector<std::string>> all;
  for (const TourName& each : tour.names) {
    all.push_back(each.aliases);
    all.back().insert(all.back().begin(), each.name);
  }
  const std::vector<std::size_t> same = sameRooms(model_->names, all, name);
  return same.size() == 1 ? std::optional(same.front()) : std::nullopt;
}

DescribedBuilding describeTour(const ToldTour& tour, const std::string& corridor) {
  DescribedBuilding building;
  const auto add = [&](const std::string& name) -> DescribedPlace& {
    DescribedPlace place;
    place.id = static_cast<Id>(building.places.size() + 1);
    place.name = name;
    building.places.push_back(std::move(place));
    return building.places.back();
  };
  DescribedPlace& within = add(corridor);
  within.kind = PlaceKind::kCorridor;
  const Id from = within.id;
  building.robot_place = from;
  for (const auto& [row, side] :
       {std::make_pair(&tour.left, Side::kLeft), std::make_pair(&tour.right, Side::kRight)}) {
    for (std::size_t k = 0; k < row->size(); ++k) {
      const TourRoom& room = (*row)[k];
      DescribedPlace& place = add(room.name);
      place.aliases = room.aliases;
      DescribedConnection connection;
      connection.from = from;
      connection.to = place.id;
      connection.side = side;
      connection.order = k;
      connection.side_certainty = room.side_certainty;
      connection.order_certainty = room.order_certainty;
      building.connections.push_back(connection);
    }
  }
  return building;
}

}  // namespace hyselam_topo
