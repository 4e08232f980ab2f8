#include "capture.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "matching_costs.hpp"

namespace hyselam_topo {
namespace language {
namespace {

using Step = PatternRun::Step;

constexpr char kAgain[] = "again";  ///< "it", where something is corrected

class Capture {
 public:
  Capture(const Automaton& pattern, SentenceWords* words, Clause* clause)
      : pattern_(pattern), words_(*words), clause_(*clause) {}

  void take(const Step& step) {
    const Edge& edge = *step.edge;
    switch (edge.kind) {
      case EdgeKind::kWord:
        takeSpelling(step);
        break;
      case EdgeKind::kName:
        for (const FoundName& name : words_.namesAt(step.from, edge.b)) {
          if (name.end != step.to) continue;
          auto& names = slotOf(edge, step.from, step.to).names;
          names.push_back(name.name);
          std::size_t& end = name_ends_[edge.a];
          names.back().follows = end > 0 && tellsOrder(end, step.from);
          contradicts_ = contradicts_ || (end > 0 && endsList(end, step.from));
          end = step.to;
          names.insert(names.end(), name.more.begin(), name.more.end());
        }
        break;
      case EdgeKind::kCount:
      case EdgeKind::kNumber:
        for (const FoundNumber& number : words_.numbersAt(step.from)) {
          if (number.end == step.to) setNumber(edge, step, number.value);
        }
        break;
      case EdgeKind::kQuantity:
        takeMeasure(step);
        break;
      case EdgeKind::kBegin:
        begins_[edge.a] = step.from;
        break;
      case EdgeKind::kValue:
        takeValue(step);
        break;
      default:
        break;
    }
  }

  /// "On the left, on the right": a slot that gets two values.
  bool contradicts() const { return contradicts_; }

  /// "6 by 8 metres": both are metres. False if a unit is needed and missing.
  bool resolveUnits() {
    for (const OpenMeasure& each : open_) {
      Slot& slot = clause_.slots[each.slot];
      double factor = each.measure.factor;
      for (const OpenMeasure& other : open_) {
        if (factor <= 0.0 && other.quantity == each.quantity) factor = other.measure.factor;
      }
      if (factor <= 0.0) {
        const auto quantity = static_cast<std::size_t>(each.quantity);
        factor = words_.grammar.quantities[quantity].default_factor;
        slot.unit_assumed = true;
      }
      if (factor <= 0.0) return false;
      slot.number = each.measure.value * factor;
    }
    return true;
  }

 private:
  /// A captured number whose unit may stand with another one: "6 by 8 metres".
  struct OpenMeasure {
    std::size_t slot = 0;
    int quantity = 0;
    FoundMeasure measure;
  };

  /// The slot of an edge, which now reaches over the tokens [from, to), too.
  Slot& slotOf(const Edge& edge, std::size_t from, std::size_t to) {
    const SlotType& type = pattern_.slots[static_cast<std::size_t>(edge.a)];
    const auto& tokens = words_.tokens;
    // What takes no word ("there", left out) stands behind the word before.
    const std::size_t behind = from > 0 ? tokens[from - 1].range.end : tokens.front().range.begin;
    const TextRange range = to > from
                                ? TextRange{tokens[from].range.begin, tokens[to - 1].range.end}
                                : TextRange{behind, behind};
    for (Slot& slot : clause_.slots) {
      if (slot.name != type.name) continue;
      slot.range.end = std::max(slot.range.end, range.end);
      return slot;
    }
    clause_.slots.push_back({});
    Slot& slot = clause_.slots.back();
    slot.name = type.name;
    slot.type = type.type;
    slot.range = range;
    return slot;
  }

  /// "A, then B": whether words between two names put the second behind the first.
  bool tellsOrder(std::size_t from, std::size_t to) const {
    for (std::size_t at = from; at < to; ++at) {
      if (words_.grammar.order_words.count(words_.tokens[at].folded) != 0) return true;
    }
    return false;
  }

  /// "X, logo a seguir à copa": no list of X and the copa; in an order, "depois à copa" is one.
  bool endsList(std::size_t from, std::size_t to) const {
    if (clause_.intent->kind != UtteranceKind::kStatement || !tellsOrder(from, to)) return false;
    return to > from && words_.grammar.list_ends.count(words_.tokens[to - 1].lower) != 0;
  }

  void setNumber(const Edge& edge, const Step& step, double value) {
    Slot& slot = slotOf(edge, step.from, step.to);
    contradicts_ = contradicts_ || (slot.number && *slot.number != value);
    slot.number = value;
  }

  void takeSpelling(const Step& step) {
    for (const auto& match : words_.matches[step.from]) {
      if (match.word == step.edge->a && match.cost >= kSlipCost) {
        clause_.spelling.push_back(
            {words_.tokens[step.from].text, words_.grammar.vocabulary.text(match.word)});
      }
    }
  }

  void takeMeasure(const Step& step) {
    const Edge& edge = *step.edge;
    std::optional<FoundMeasure> best;
    for (const FoundMeasure& measure : words_.measuresAt(step.from, edge.b)) {
      if (measure.end == step.to && (!best || measure.cost < best->cost)) best = measure;
    }
    if (!best) return;
    Slot& slot = slotOf(edge, step.from, step.to);
    slot.number = best->value;
    open_.push_back({static_cast<std::size_t>(&slot - clause_.slots.data()), edge.b, *best});
  }

  /// A value of a word class; one that stands for a name ("it") is a name.
  void takeValue(const Step& step) {
    const Edge& edge = *step.edge;
    const std::string& value = words_.grammar.values[static_cast<std::size_t>(edge.b)];
    Slot& slot = slotOf(edge, begins_[edge.a], step.to);
    if (words_.grammar.nameType(slot.type) == nullptr) {
      contradicts_ = contradicts_ || (!slot.word.empty() && slot.word != value);
      slot.word = value;
      return;
    }
    SaidName reference;
    reference.reference = value == kAgain ? "it" : value;
    clause_.only_corrects = clause_.only_corrects || value == kAgain;
    reference.range = slot.range;
    // One that was not spoken ("[the workshop is] João's") is named by what it stands for.
    reference.text =
        slot.range.begin < slot.range.end ? words_.textOf(slot.range) : reference.reference;
    slot.names.push_back(std::move(reference));
  }

  const Automaton& pattern_;
  SentenceWords& words_;
  Clause& clause_;
  std::map<int, std::size_t> begins_;     ///< of slots of word classes: their first token
  std::map<int, std::size_t> name_ends_;  ///< of slots of names: behind the last one
  std::vector<OpenMeasure> open_;
  bool contradicts_ = false;
};

}  // namespace

bool capture(const Automaton& pattern, const std::vector<Step>& path, SentenceWords* words,
             Clause* clause) {
  Capture captured(pattern, words, clause);
  for (const Step& step : path) {
    if (step.edge) captured.take(step);
  }
  return !captured.contradicts() && captured.resolveUnits();
}

}  // namespace language
}  // namespace hyselam_topo
