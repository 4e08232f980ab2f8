#include "ngram_slam/matching/ngram.hpp"

#include <algorithm>
#include <unordered_map>

namespace ngram_slam {
namespace {

/// The pairs that may stand before a pair, those of low levels first.
std::vector<WordPair> predecessorPairs(const WordLattice& text, const WordTolerance& tolerance,
                                       const WordPair& pair, int levels, Direction direction) {
  std::vector<WordPair> out;
  const WordRange newer = text.predecessors(pair.newer), older = text.predecessors(pair.older);
  for (WordIndex a = newer.begin; a < newer.end; ++a) {
    const auto take = [&](WordIndex b) {
      if (mayPair(text, tolerance, {a, b}, levels, direction)) out.push_back({a, b});
    };
    if (direction == Direction::kReverse) {
      text.forEachSuccessor(pair.older, levels, take);
    } else {
      for (WordIndex b = older.begin; b < older.end; ++b) take(b);
    }
  }
  return out;
}

std::uint64_t key(const WordPair& p) {
  return static_cast<std::uint64_t>(p.newer) << 32 | p.older;
}

}  // namespace

bool mayPair(const WordLattice& text, const WordTolerance& tolerance, const WordPair& pair,
             int levels, Direction direction) {
  const Syllables older = text.syllables(pair.older);
  return text.level(pair.newer) < levels && text.level(pair.older) < levels &&
         text.last(pair.older) < text.first(pair.newer) &&
         wordsMatch(text.syllables(pair.newer),
                    direction == Direction::kReverse ? reversed(older) : older, tolerance);
}

std::vector<WordPair> longestNgram(const WordLattice& text, const WordTolerance& tolerance,
                                   const WordPair& last, int levels, std::size_t max_words,
                                   Direction direction) {
  if (!mayPair(text, tolerance, last, levels, direction) || max_words == 0) return {};
  struct Node {
    WordPair pair;
    std::vector<WordPair> before;
    std::size_t length = 1;
    const Node* best = nullptr;
  };
  // Breadth first: all pairs within `max_words` steps back. A node's address stays.
  std::unordered_map<std::uint64_t, Node> nodes;
  std::vector<WordPair> layer = {last};
  std::vector<Node*> order;
  for (std::size_t step = 0; step < max_words && !layer.empty(); ++step) {
    std::vector<WordPair> next;
    for (const WordPair& pair : layer) {
      const auto [at, fresh] = nodes.try_emplace(key(pair));
      if (!fresh) continue;
      at->second.pair = pair;
      at->second.before = predecessorPairs(text, tolerance, pair, levels, direction);
      order.push_back(&at->second);
      next.insert(next.end(), at->second.before.begin(), at->second.before.end());
    }
    layer = std::move(next);
  }
  // A predecessor has a smaller index than its successor.
  std::sort(order.begin(), order.end(),
            [](const Node* a, const Node* b) { return key(a->pair) < key(b->pair); });
  for (Node* node : order) {
    for (const WordPair& pair : node->before) {
      const auto at = nodes.find(key(pair));
      if (at == nodes.end() || at->second.length + 1 <= node->length) continue;
      node->length = at->second.length + 1;
      node->best = &at->second;
    }
  }
  std::vector<WordPair> chain;
  for (const Node* n = &nodes.at(key(last)); n != nullptr && chain.size() < max_words;
       n = n->best) {
    chain.push_back(n->pair);
  }
  std::reverse(chain.begin(), chain.end());
  return chain;
}

void forEachMaximalNgram(const WordLattice& text, const WordTolerance& tolerance,
                         const WordPair& last, int levels,
                         const std::function<bool(const std::vector<WordPair>&)>& use,
                         std::size_t max_words, Direction direction) {
  if (!mayPair(text, tolerance, last, levels, direction) || max_words == 0) return;
  struct Step {
    std::vector<WordPair> choices;
    std::size_t next = 0;
  };
  std::vector<Step> steps = {{{last}, 0}};
  std::vector<WordPair> chain;  // newest first
  while (!steps.empty()) {
    Step& step = steps.back();
    if (step.next == step.choices.size()) {
      steps.pop_back();
      if (!chain.empty()) chain.pop_back();
      continue;
    }
    chain.push_back(step.choices[step.next++]);
    std::vector<WordPair> before =
        predecessorPairs(text, tolerance, chain.back(), levels, direction);
    if (before.empty() || chain.size() == max_words) {
      if (!use(std::vector<WordPair>(chain.rbegin(), chain.rend()))) return;
      chain.pop_back();
    } else {
      steps.push_back({std::move(before), 0});
    }
  }
}

}  // namespace ngram_slam
