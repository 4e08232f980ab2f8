#include "pattern.hpp"

#include <algorithm>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>

#include "hyselam_common/utf8.hpp"
#include "minimal_automaton.hpp"
#include "word_cuts.hpp"

namespace hyselam_topo {
namespace language {
namespace {

constexpr int kSeveral = 2;  // at least
constexpr int kMaxDepth = 16;
constexpr std::size_t kMaxStates = 100000;

class Compiler {
 public:
  Compiler(const PatternContext& context, CompiledGrammar* grammar)
      : context_(context), grammar_(grammar) {
    automaton_.states.resize(1);
  }

  Automaton compile(const std::string& pattern) {
    const int end = whole(pattern, 0, 0);
    automaton_.accept = end;
    if (reachableByNothing(0, end)) throw PatternError("it matches nothing at all");
    findFirstWords();
    findNeededWords();
    return minimal(automaton_, kMaxStates);
  }

  /// A part of patterns, small and without first and needed words; nothing if it has a list, whose
  /// separators must be known in the whole.
  std::optional<Automaton> compilePart(const std::string& part, int depth) {
    automaton_.accept = whole(part, 0, depth);
    if (!separators_.empty()) return std::nullopt;
    return minimal(automaton_, kMaxStates);
  }

 private:
  int newState() {
    if (automaton_.states.size() >= kMaxStates) throw PatternError("it is too large");
    automaton_.states.emplace_back();
    return static_cast<int>(automaton_.states.size()) - 1;
  }
  void edge(int from, Edge e) { automaton_.states[static_cast<std::size_t>(from)].push_back(e); }
  int step(int from, EdgeKind kind, int a = -1, int b = -1) {
    const int to = newState();
    edge(from, {kind, to, a, b});
    return to;
  }

  /// A text of its own: a pattern, an entry of a macro or class.
  int whole(const std::string& text, int from, int depth) {
    if (depth > kMaxDepth) throw PatternError("macros contain one another");
    std::size_t at = 0;
    const int end = alternatives(text, &at, from, '\0', depth);
    return end;
  }

  int anyOf(const std::vector<std::string>& texts, int from, int depth) {
    if (texts.empty()) throw PatternError("there are no alternatives");
    std::vector<int> ends;
    ends.reserve(texts.size());
    for (const std::string& text : texts) {
      ends.push_back(whole(text, step(from, EdgeKind::kSkip), depth));
    }
    return joined(ends);
  }

  int joined(const std::vector<int>& ends) {
    const int join = newState();
    for (const int end : ends) edge(end, {EdgeKind::kSkip, join, -1, -1});
    return join;
  }

  int alternatives(const std::string& text, std::size_t* at, int from, char close, int depth) {
    std::vector<int> ends;
    while (true) {
      ends.push_back(sequence(text, at, step(from, EdgeKind::kSkip), depth));
      if (*at < text.size() && text[*at] == '|') {
        ++*at;
        continue;
      }
      break;
    }
    const char here = *at < text.size() ? text[*at] : '\0';
    if (here != close) {
      throw PatternError(close == '\0' ? "'" + std::string(1, here) + "' closes nothing"
                                       : "'" + std::string(1, close) + "' is missing");
    }
    if (close != '\0') ++*at;
    return joined(ends);
  }

  std::string upTo(const std::string& text, std::size_t* at, char close) {
    const std::size_t end = text.find(close, *at);
    if (end == std::string::npos) {
      throw PatternError("'" + std::string(1, close) + "' is missing");
    }
    std::string inside = text.substr(*at, end - *at);
    *at = end + 1;
    return inside;
  }

  int sequence(const std::string& text, std::size_t* at, int state, int depth) {
    static const std::string kSpecial = "()[]|<>{}";
    while (*at < text.size()) {
      const char c = text[*at];
      if (c == ' ' || c == '\n') {
        ++*at;
      } else if (c == '(') {
        ++*at;
        state = alternatives(text, at, state, ')', depth);
      } else if (c == '[') {
        ++*at;
        const int begin = state;
        state = alternatives(text, at, begin, ']', depth);
        edge(begin, {EdgeKind::kSkip, state, -1, -1});
      } else if (c == '<') {
        ++*at;
        state = reference(upTo(text, at, '>'), state, depth);
      } else if (c == '{') {
        ++*at;
        state = slot(upTo(text, at, '}'), state, depth);
      } else if (c == ',') {
        throw PatternError("commas are never part of a pattern");
      } else if (kSpecial.find(c) != std::string::npos) {
        return state;
      } else {
        const std::size_t end = std::min(text.find_first_of(" \n,()[]|<>{}", *at), text.size());
        const std::string word = text.substr(*at, end - *at);
        *at = end;
        state = step(state, EdgeKind::kWord, grammar_->vocabulary.add(word));
      }
    }
    return state;
  }

  /// What many patterns have in common is compiled once: the end of a copy of it, -1 if it cannot
  /// be copied.
  int copyOfPart(const std::string& part, int state, int depth) {
    if (part == part_) return -1;
    auto known = context_.parts.find(part);
    if (known == context_.parts.end()) {
      if (depth > kMaxDepth) throw PatternError("macros contain one another");
      Compiler compiler(context_, grammar_);
      compiler.part_ = part;
      known = context_.parts.emplace(part, compiler.compilePart(part, depth + 1)).first;
    }
    return known->second ? copyOf(*known->second, state) : -1;
  }

  int copyOf(const Automaton& part, int state) {
    const int first = static_cast<int>(automaton_.states.size());
    if (automaton_.states.size() + part.states.size() > kMaxStates) {
      throw PatternError("it is too large");
    }
    std::vector<int> slots;
    slots.reserve(part.slots.size());
    for (const SlotType& slot : part.slots) slots.push_back(slotNumber(slot));
    for (const auto& edges : part.states) {
      automaton_.states.push_back(edges);
      for (Edge& e : automaton_.states.back()) {
        e.to += first;
        const bool of_slot =
            e.kind != EdgeKind::kSkip && e.kind != EdgeKind::kWord && e.kind != EdgeKind::kComma;
        if (of_slot) e.a = slots[static_cast<std::size_t>(e.a)];
      }
    }
    edge(state, {EdgeKind::kSkip, first, -1, -1});
    return first + part.accept;
  }

  int reference(const std::string& name, int state, int depth) {
    const int copy = copyOfPart("<" + name + ">", state, depth);
    if (copy >= 0) return copy;
    const auto macro = context_.macros.find(name);
    if (macro != context_.macros.end()) return anyOf(macro->second, state, depth + 1);
    const auto word_class = context_.classes.find(name);
    if (word_class == context_.classes.end()) {
      throw PatternError("there is no macro or word class '" + name + "'");
    }
    std::vector<std::string> all;
    for (const auto& [value, texts] : word_class->second) {
      all.insert(all.end(), texts.begin(), texts.end());
    }
    return anyOf(all, state, depth + 1);
  }

  int slotNumber(const SlotType& slot) {
    const auto found = std::find_if(automaton_.slots.begin(), automaton_.slots.end(),
                                    [&](const SlotType& each) { return each.name == slot.name; });
    if (found == automaton_.slots.end()) {
      automaton_.slots.push_back(slot);
      return static_cast<int>(automaton_.slots.size()) - 1;
    }
    if (found->type != slot.type) {
      throw PatternError("slot '" + slot.name + "' has two types");
    }
    return static_cast<int>(found - automaton_.slots.begin());
  }

  int valueNumber(const std::string& value) {
    auto& values = grammar_->values;
    const auto found = std::find(values.begin(), values.end(), value);
    if (found != values.end()) return static_cast<int>(found - values.begin());
    values.push_back(value);
    return static_cast<int>(values.size()) - 1;
  }

  /// One of the entries of a class or of the references of a name type, told by its value.
  int entries(const std::map<std::string, std::vector<std::string>>& all, int slot, int state,
              int depth) {
    std::vector<int> ends;
    const int begin = step(state, EdgeKind::kBegin, slot);
    for (const auto& [value, texts] : all) {
      const int end = anyOf(texts, step(begin, EdgeKind::kSkip), depth + 1);
      ends.push_back(step(end, EdgeKind::kValue, slot, valueNumber(value)));
    }
    return joined(ends);
  }

  int oneName(int slot, int type, int state, int depth) {
    std::vector<int> ends{step(state, EdgeKind::kName, slot, type)};
    const auto references =
        context_.references.find(grammar_->name_types[static_cast<std::size_t>(type)].name);
    if (references != context_.references.end()) {
      ends.push_back(entries(references->second, slot, state, depth));
    }
    return joined(ends);
  }

  int slot(const std::string& text, int state, int depth) {
    const std::size_t equals = text.find('=');
    if (equals != std::string::npos) {
      const std::string before = text.substr(0, equals);
      const std::size_t type_at = std::min(before.find(':'), before.size());
      const std::string type =
          type_at < before.size() ? before.substr(type_at + 1) : std::string("constant");
      const int number = slotNumber({before.substr(0, type_at), type, false});
      return step(step(state, EdgeKind::kBegin, number), EdgeKind::kValue, number,
                  valueNumber(text.substr(equals + 1)));
    }
    const std::size_t colon = text.find(':');
    if (colon == std::string::npos || colon == 0) {
      throw PatternError("'{" + text + "}' must be {slot:type} or {slot=value}");
    }
    SlotType type{text.substr(0, colon), text.substr(colon + 1), false};
    if (!type.type.empty() && type.type.back() == '+') {
      type.type.pop_back();
      type.is_list = true;
    }
    const auto& names = grammar_->name_types;
    const auto name_type = std::find_if(
        names.begin(), names.end(), [&](const NameType& each) { return each.name == type.type; });
    if (name_type != names.end()) {
      const int number = slotNumber(type);
      const int index = static_cast<int>(name_type - names.begin());
      if (!type.is_list) return oneName(number, index, state, depth);
      // The loop comes back to its beginning only behind a separator, so that something is
      // consumed.
      const int begin = step(state, EdgeKind::kSkip);
      const int end = oneName(number, index, begin, depth);
      const std::size_t before = automaton_.states.size();
      for (const std::string& separator : context_.list_separators) {
        const int behind = whole(separator, step(end, EdgeKind::kSkip), depth + 1);
        if (reachableByNothing(end, behind)) {
          throw PatternError("a separator of lists matches nothing at all");
        }
        edge(behind, {EdgeKind::kSkip, begin, -1, -1});
      }
      separators_.emplace_back(before, automaton_.states.size());
      edge(end, {EdgeKind::kComma, begin, -1, -1});
      return step(end, EdgeKind::kSkip);
    }
    if (type.is_list) throw PatternError("only names make lists, not '" + type.type + "'");
    if (type.type == "count") return step(state, EdgeKind::kCount, slotNumber(type));
    if (type.type == "several") return step(state, EdgeKind::kCount, slotNumber(type), kSeveral);
    if (type.type == "number") return step(state, EdgeKind::kNumber, slotNumber(type));
    const auto& quantities = grammar_->quantities;
    for (std::size_t i = 0; i < quantities.size(); ++i) {
      if (quantities[i].name != type.type) continue;
      return step(state, EdgeKind::kQuantity, slotNumber(type), static_cast<int>(i));
    }
    const auto word_class = context_.classes.find(type.type);
    if (word_class == context_.classes.end()) {
      throw PatternError("there is no type '" + type.type + "' of slots");
    }
    const int copy = copyOfPart("{" + text + "}", state, depth);
    if (copy >= 0) return copy;
    return entries(word_class->second, slotNumber(type), state, depth);
  }

  bool reachableByNothing(int from, int to) const {
    std::vector<int> open{from};
    std::vector<bool> seen(automaton_.states.size(), false);
    while (!open.empty()) {
      const int state = open.back();
      open.pop_back();
      if (state == to) return true;
      if (seen[static_cast<std::size_t>(state)]) continue;
      seen[static_cast<std::size_t>(state)] = true;
      for (const Edge& e : automaton_.states[static_cast<std::size_t>(state)]) {
        const bool free =
            e.kind == EdgeKind::kSkip || e.kind == EdgeKind::kBegin || e.kind == EdgeKind::kValue;
        if (free) open.push_back(e.to);
      }
    }
    return false;
  }

  void findFirstWords() {
    std::vector<int> open{0};
    std::set<int> seen, words;
    while (!open.empty()) {
      const int state = open.back();
      open.pop_back();
      if (!seen.insert(state).second) continue;
      for (const Edge& e : automaton_.states[static_cast<std::size_t>(state)]) {
        if (e.kind == EdgeKind::kSkip || e.kind == EdgeKind::kBegin || e.kind == EdgeKind::kValue) {
          open.push_back(e.to);
        } else if (e.kind == EdgeKind::kWord) {
          words.insert(e.a);
        } else {
          return;  // anything may come first
        }
      }
    }
    automaton_.first_words.assign(words.begin(), words.end());
  }

  /// Whether states with this number were made for what stands between the names of a list.
  bool isSeparator(int state) const {
    return std::any_of(separators_.begin(), separators_.end(), [state](const auto& range) {
      const auto number = static_cast<std::size_t>(state);
      return number >= range.first && number < range.second;
    });
  }

  /// "room", "door": words that names hold, too.
  bool isCommon(int word) const {
    auto& known = context_.common_words;
    known.resize(std::max(known.size(), grammar_->vocabulary.size()), -1);
    signed char& common = known[static_cast<std::size_t>(word)];
    if (common >= 0) return common != 0;
    const std::string text = hyselam::utf8Fold(grammar_->vocabulary.text(word));
    const auto& types = grammar_->name_types;
    const bool found = std::any_of(types.begin(), types.end(), [&](const NameType& type) {
      return type.nouns.count(text) != 0 || type.generic.count(text) != 0 ||
             type.titles.count(text) != 0;
    });
    common = found ? 1 : 0;
    return found;
  }

  /// The words outside of lists, if there is no way around all of them; of those that names may
  /// hold no more than needed. Then the rarer ones, which are taken for the longer ones.
  void findNeededWords() {
    std::vector<bool> in_list(automaton_.states.size());
    for (std::size_t state = 0; state < in_list.size(); ++state) {
      in_list[state] = isSeparator(static_cast<int>(state));
    }
    WordCuts cuts(automaton_, in_list, grammar_->vocabulary.size());
    std::vector<int> common, others;
    for (const int word : cuts.words()) (isCommon(word) ? common : others).push_back(word);
    if (!cuts.block()) return;
    cuts.drop(common);
    if (automaton_.first_words.empty()) automaton_.telling_words = cuts.blocked();
    std::stable_sort(others.begin(), others.end(), [this](int a, int b) {
      return grammar_->vocabulary.text(a).size() < grammar_->vocabulary.text(b).size();
    });
    cuts.drop(others);
    automaton_.needed_words = cuts.blocked();
  }

  const PatternContext& context_;
  CompiledGrammar* grammar_;
  Automaton automaton_;
  std::string part_;  ///< what this compiles; "": a whole pattern
  std::vector<std::pair<std::size_t, std::size_t>> separators_;  ///< states [first, second)
};

}  // namespace

Automaton compilePattern(const std::string& pattern, const PatternContext& context,
                         CompiledGrammar* grammar) {
  return Compiler(context, grammar).compile(pattern);
}

}  // namespace language
}  // namespace hyselam_topo
