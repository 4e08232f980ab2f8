#include "tour_training.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "hyselam_language/reader/tour_match.hpp"
#include "linear_training.hpp"
#include "reader/mention_tagger.hpp"
#include "reader/tour_context.hpp"
#include "reader/tour_mentions.hpp"
#include "reader_training.hpp"

namespace hyselam_topo {
namespace language {
namespace {

/// Doors that are so near each other along the corridor face each other [m].
constexpr double kFacing = 2.0;

std::string pairLabel(const TourDoor& a, const TourDoor& b) {
  if (a.is_left == b.is_left) return a.along < b.along ? kTourBefore : kTourBehind;
  return std::abs(a.along - b.along) < kFacing ? kTourOpposite : kTourApart;
}

std::string positionLabel(const AnnotatedTour& tour, const TourDoor& door) {
  bool first = true, last = true;
  for (const auto& [room, other] : tour.doors) {
    if (other.is_left != door.is_left) continue;
    first = first && other.along >= door.along;
    last = last && other.along <= door.along;
  }
  return first ? kTourFirst : last ? kTourLast : kTourInner;
}

/// Words of names that are no words of the language: "Okafor".
std::set<std::string> strangeWords(const HeardText& text, const std::vector<Mention>& mentions) {
  std::set<std::string> words;
  for (const Mention& mention : mentions) {
    for (std::size_t at = mention.begin; at < mention.end; ++at) {
      const auto word = static_cast<std::ptrdiff_t>(at);
      if (!text.isNoun(word) && (!text.isKeyword(word) || text.tokens()[at].starts_upper))
        words.insert(text.word(word));
    }
  }
  return words;
}

/// As if nobody had ever heard of these names: without the features that have them or their ends.
Features withoutWords(const Features& features, const std::set<std::string>& words,
                      const std::string& own) {
  Features left;
  for (const std::string& feature : features) {
    const std::size_t sign = feature.find('=');
    bool has = words.count(own) != 0 && feature.compare(0, 3, "end") == 0;
    for (std::size_t at = sign; at != std::string::npos && !has;) {
      const std::size_t next = feature.find('_', at + 1);
      const std::size_t length = next == std::string::npos ? next : next - at - 1;
      has = words.count(feature.substr(at + 1, length)) != 0;
      at = next;
    }
    if (!has) left.push_back(feature);
  }
  return left;
}

struct Sets {
  TrainingSet tagger, of_side, of_pair, of_position;
};

void addExamples(const CompiledGrammar& grammar, const ReaderModel& reader,
                 const AnnotatedTour& tour, Sets* sets) {
  const HeardText text(grammar, reader.lexicon, tour.text);
  const MarkedMentions marked = markedMentions(grammar, text, tour);
  const auto tags = tagsOf(text, marked.mentions);
  const auto more = readerFeatures(reader.tagger, text);
  const std::set<std::string> strange = strangeWords(text, marked.mentions);
  for (std::size_t at = 0; at < tags.size(); ++at) {
    if (text.endsSentence(at)) continue;
    Features features = tokenFeatures(text, at);
    features.insert(features.end(), more[at].begin(), more[at].end());
    addTagBefore(text, at, at == 0 ? "O" : tags[at - 1], &features);
    sets->tagger.add(features, tags[at]);
    // Other buildings have other people.
    const std::string& own = text.word(static_cast<std::ptrdiff_t>(at));
    sets->tagger.add(withoutWords(features, strange, own), tags[at]);
  }
  std::vector<std::size_t> room_of;
  for (const std::string& room : marked.rooms)
    room_of.push_back(
        static_cast<std::size_t>(std::distance(tour.doors.begin(), tour.doors.find(room))));
  const TourContext context(grammar.tour_words, text, marked.mentions, room_of);
  const auto doorOf = [&](std::size_t mention) { return tour.doors.at(marked.rooms[mention]); };
  for (std::size_t m = 0; m < marked.mentions.size(); ++m) {
    const TourDoor door = doorOf(m);
    sets->of_position.add(context.ofPosition(m), positionLabel(tour, door));
    const Features side = context.ofSide(m);
    if (side.empty()) continue;
    sets->of_side.add(side, door.is_left ? kTourLeft : kTourRight);
    sets->of_side.add(TourContext::mirrored(side), door.is_left ? kTourRight : kTourLeft);
  }
  for (const auto& [first, second] : context.pairs()) {
    if (marked.rooms[first] == marked.rooms[second]) continue;
    sets->of_pair.add(context.ofPair(first, second), pairLabel(doorOf(first), doorOf(second)));
  }
}

/// The room of which somebody spoke most in these words; nothing: of none.
std::optional<std::string> roomSaid(const AnnotatedTour& tour,
                                    const std::vector<TextRange>& ranges) {
  std::map<std::string, std::size_t> times;
  for (const TextRange& range : ranges) {
    for (const AnnotatedTour::Said& said : tour.said) {
      if (said.range.begin < range.end && range.begin < said.range.end) ++times[said.room];
    }
  }
  const auto most = std::max_element(
      times.begin(), times.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  return most == times.end() ? std::nullopt : std::optional(most->first);
}

void scoreRow(const AnnotatedTour& tour, const std::vector<TourRoom>& row, bool is_left,
              std::set<std::string>* seen, TourScore* score) {
  std::vector<std::pair<const TourRoom*, TourDoor>> there;  // of those on the side they are read on
  const TourRoom* before = nullptr;
  std::optional<TourDoor> door_before;
  for (const TourRoom& room : row) {
    const auto said = roomSaid(tour, room.said);
    if (!said || !seen->insert(*said).second) {
      ++score->others;
      score->words += "  other: " + room.name + (said ? " (" + *said + " again)" : "") + '\n';
      before = nullptr;
      continue;
    }
    const TourDoor door = tour.doors.at(*said);
    const bool right = door.is_left == is_left;
    if (!right)
      score->words +=
          "  other side: " + room.name + ", told as " + std::to_string(room.side_certainty) + '\n';
    ++score->named;
    score->sides_right += right ? 1 : 0;
    score->sides.emplace_back(room.side_certainty, right);
    if (before != nullptr && right && door_before->is_left == is_left)
      score->orders.emplace_back(room.order_certainty, door_before->along < door.along);
    before = &room;
    door_before = door;
    if (!right) continue;
    for (const auto& [other, other_door] : there) {
      ++score->pairs;
      score->pairs_right += other_door.along < door.along ? 1 : 0;
    }
    there.emplace_back(&room, door);
  }
}

}  // namespace

TourModel trainTours(const Grammar& grammar, const ReaderModel& reader,
                     const std::vector<const AnnotatedTour*>& tours,
                     const TourTrainingParams& params) {
  Sets sets;
  for (const AnnotatedTour* each : tours) addExamples(grammar.compiled(), reader, *each, &sets);
  TourModel model;
  model.origin.language = grammar.language();
  model.tagger = sets.tagger.train(params.cost, params.least_seen);
  model.of_side = sets.of_side.train(params.cost, params.least_seen);
  model.of_pair = sets.of_pair.train(params.cost, params.least_seen);
  model.of_position = sets.of_position.train(params.cost, params.least_seen);
  model.weights = params.weights;
  return model;
}

void TourScore::add(const TourScore& other) {
  tours += other.tours;
  rooms += other.rooms;
  named += other.named;
  others += other.others;
  sides_right += other.sides_right;
  pairs += other.pairs;
  pairs_right += other.pairs_right;
  sides.insert(sides.end(), other.sides.begin(), other.sides.end());
  orders.insert(orders.end(), other.orders.begin(), other.orders.end());
  named_doors.insert(named_doors.end(), other.named_doors.begin(), other.named_doors.end());
  doors += other.doors;
  right_after.resize(std::max(right_after.size(), other.right_after.size()));
  for (std::size_t k = 0; k < other.right_after.size(); ++k) right_after[k] += other.right_after[k];
  words += other.words;
}

namespace {

/// The names on the doors that there are, at once and after questions that a person answers.
void scoreDoors(const AnnotatedTour& tour, const ToldTour& told, const std::set<std::string>& rooms,
                TourScore* score) {
  constexpr std::size_t kQuestions = 8;
  std::vector<TourSlot> slots;
  std::vector<std::string> room_at;
  for (const auto& [room, door] : tour.doors) {
    slots.push_back({door.is_left, door.along});
    room_at.push_back(room);
  }
  std::vector<std::string> room_of;  // of each name; "" for what is no room
  for (const TourName& name : told.names) room_of.push_back(roomSaid(tour, name.said).value_or(""));
  score->doors += rooms.size();
  TourConstraints known;
  for (std::size_t asked = 0; asked <= kQuestions; ++asked) {
    const TourMatch match = matchTour(told.evidence, slots, {}, known);
    std::size_t right = 0;
    for (std::size_t slot = 0; slot < slots.size(); ++slot) {
      if (!match.best[slot]) continue;
      const bool is_right = room_of[*match.best[slot]] == room_at[slot];
      right += is_right ? 1 : 0;
      if (asked == 0 && told.names[*match.best[slot]].is_name)
        score->named_doors.emplace_back(match.of(slot, *match.best[slot]), is_right);
    }
    score->right_after.push_back(right);
    const auto slot = match.question();
    if (!slot) {
      score->right_after.resize(kQuestions + 1, right);
      return;
    }
    const auto name = std::find(room_of.begin(), room_of.end(), room_at[*slot]);
    if (name == room_of.end()) {
      known.unnamed.push_back(*slot);
    } else {
      known.confirmed.emplace_back(*slot, static_cast<std::size_t>(name - room_of.begin()));
    }
  }
}

}  // namespace

TourScore scoreOf(const TourReader& reader, const AnnotatedTour& tour) {
  const ToldTour told = reader.read(tour.text);
  TourScore score;
  score.tours = 1;
  std::set<std::string> rooms, seen;
  for (const AnnotatedTour::Said& said : tour.said) rooms.insert(said.room);
  score.rooms = rooms.size();
  scoreRow(tour, told.left, true, &seen, &score);
  scoreRow(tour, told.right, false, &seen, &score);
  scoreDoors(tour, told, rooms, &score);
  for (const std::string& room : rooms) {
    if (seen.count(room) != 0) continue;
    score.words += "  missed:";
    for (const AnnotatedTour::Said& said : tour.said) {
      if (said.room == room)
        score.words +=
            " '" + tour.text.substr(said.range.begin, said.range.end - said.range.begin) + "'";
    }
    score.words += '\n';
  }
  return score;
}

void calibrate(const TourScore& score, TourModel* model) {
  const auto fitted = [](const std::vector<std::pair<double, bool>>& told) {
    std::vector<ReaderEvaluation::Guess> guesses;
    for (const auto& [certainty, right] : told) guesses.push_back({logOdds(certainty), 0.0, right});
    return fittedOdds(guesses);
  };
  model->of_sides = fitted(score.sides);
  model->of_orders = fitted(score.orders);
}

TourScore evaluateTours(const Grammar& grammar, const ReaderModel& reader,
                        const std::vector<const AnnotatedTour*>& tours,
                        const TourTrainingParams& params) {
  std::set<std::string> names;
  for (const AnnotatedTour* each : tours) names.insert(each->kind);
  const std::vector<std::string> kinds(names.begin(), names.end());
  const auto foldOf = [&](const AnnotatedTour& tour) {
    return static_cast<std::size_t>(std::lower_bound(kinds.begin(), kinds.end(), tour.kind) -
                                    kinds.begin()) %
           params.folds;
  };
  TourScore all;
  for (std::size_t fold = 0; fold < params.folds; ++fold) {
    std::vector<const AnnotatedTour*> others;
    for (const AnnotatedTour* each : tours) {
      if (foldOf(*each) != fold) others.push_back(each);
    }
    if (others.size() == tours.size()) continue;
    const TourReader left_out(grammar, {"reader", reader.toText()},
                              {"tours", trainTours(grammar, reader, others, params).toText()});
    for (const AnnotatedTour* each : tours) {
      if (foldOf(*each) == fold) all.add(scoreOf(left_out, *each));
    }
  }
  return all;
}

}  // namespace language
}  // namespace hyselam_topo
