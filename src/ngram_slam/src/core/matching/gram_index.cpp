#include "ngram_slam/matching/gram_index.hpp"

#include <algorithm>
#include <cmath>

#include "hyselam_common/rng.hpp"

namespace ngram_slam {
namespace {
constexpr Position kFirstReach = 4096;
constexpr std::size_t kPart = 1024;  // entries of a part, about
constexpr std::uint32_t kMostAngleBuckets = 64;
}  // namespace

GramIndex::GramIndex(const WordLattice& text, const WordTolerance& tolerance, int n, int bits,
                     bool backwards)
    : text_(text), tolerance_(tolerance), n_(n), shift_(64 - bits), backwards_(backwards) {
  log_width_ = -2.0 * std::log1p(-tolerance.size);
  // Of a width >= 2 eps_a, and no more than a key tells apart.
  angle_buckets_ = static_cast<std::uint32_t>(
      std::clamp(hyselam::kPi / tolerance.angle, 1.0, static_cast<double>(kMostAngleBuckets)));
  heads_.assign(std::size_t{1} << bits, 0);
  pool_.push_back(0);  // chunk 0 means none
}

std::uint32_t GramIndex::sizeBucket(double size) const {
  return static_cast<std::uint32_t>(std::log(std::max(size, 1.0)) / log_width_);
}

namespace {
/// The bucket of an angle, counted from the one whose middle is 0 (straight on, the commonest
/// word).
int angleBucket(double angle, std::uint32_t buckets) {
  return static_cast<int>(std::floor(angle / (2.0 * hyselam::kPi) * buckets + 0.5));
}
std::uint32_t wrapped(int bucket, std::uint32_t buckets) {
  const int n = static_cast<int>(buckets);
  return static_cast<std::uint32_t>(((bucket % n) + n) % n);
}
std::uint32_t pack(int density_class, std::uint32_t size, std::uint32_t angle) {
  return (static_cast<std::uint32_t>(density_class) << 16 | size) * kMostAngleBuckets + angle;
}
}  // namespace

std::uint32_t GramIndex::bucket(const Syllables& s) const {
  return pack(s.density_class, sizeBucket(s.size),
              wrapped(angleBucket(s.angle, angle_buckets_), angle_buckets_));
}

/// A sum, so that a gram has one key whichever end it is read from.
std::uint64_t GramIndex::keyOf(int place, std::uint32_t bucket) {
  return hyselam::mix(static_cast<std::uint64_t>(place), bucket);
}

void GramIndex::insert(WordIndex last) {
  targets_.clear();
  insertPaths(last, 0, 0);
  std::sort(targets_.begin(), targets_.end(), [](const Target& a, const Target& b) {
    return a.list != b.list ? a.list < b.list : a.entry < b.entry;
  });
  const Target* before = nullptr;
  for (const Target& t : targets_) {
    if (before == nullptr || before->list != t.list || before->entry != t.entry) {
      add(t.list, t.entry);
    }
    before = &t;
  }
}

void GramIndex::insertPaths(WordIndex word, int depth, std::uint64_t key) {
  key += keyOf(backwards_ ? n_ - 1 - depth : depth, bucket(text_.syllables(word)));
  const Entry entry = text_.first(word) << 4 | static_cast<std::uint32_t>(text_.level(word));
  if (depth + 1 == n_) {
    targets_.push_back({listOf(key), entry});
    return;
  }
  const std::size_t from = targets_.size();
  const WordRange before = text_.predecessors(word);
  for (WordIndex w = before.begin; w < before.end; ++w) insertPaths(w, depth + 1, key);
  if (depth == 0 && !backwards_) {
    for (std::size_t i = from; i < targets_.size(); ++i) targets_[i].entry = entry;
  }
}

void GramIndex::startQuery(WordIndex last) {
  lists_.clear();
  collect(last, 0, 0);
  sortLists();
  cursors_.clear();
  for (std::uint32_t list : lists_) {
    if (heads_[list] != 0) cursors_.push_back({heads_[list], pool_[heads_[list] + 1]});
  }
  until_ = text_.positions();
  reach_ = kFirstReach;
}

bool GramIndex::nextPart(std::vector<Entry>& part) {
  part.clear();
  while (part.empty() && !cursors_.empty()) {
    until_ = until_ > reach_ ? until_ - reach_ : 0;
    // Within a list grams lie in the order in which they end.
    std::size_t open = 0;
    for (Cursor c : cursors_) {
      for (;;) {
        const Entry* entries = &pool_[c.chunk + kHeader];
        while (c.left > 0 && endOf(entries[c.left - 1]) >= until_) {
          part.push_back(entries[--c.left]);
        }
        if (c.left > 0) break;
        c.chunk = pool_[c.chunk];
        if (c.chunk == 0) break;
        c.left = pool_[c.chunk + 1];
      }
      if (c.chunk != 0) cursors_[open++] = c;
    }
    cursors_.resize(open);
    if (part.size() < kPart) reach_ *= 2;
  }
  return !part.empty();
}

void GramIndex::collect(WordIndex word, int depth, std::uint64_t key) {
  const WordRange before = depth + 1 == n_ ? WordRange{} : text_.predecessors(word);
  if (depth + 1 < n_ && before.empty()) return;
  const Syllables s = backwards_ ? reversed(text_.syllables(word)) : text_.syllables(word);
  // A hair more than the tolerance, against rounding at the edges of buckets.
  const double share = 1.0 - tolerance_.size - 1e-9, turn = tolerance_.angle + 1e-6;
  const std::uint32_t size_from = sizeBucket(s.size * share), size_to = sizeBucket(s.size / share);
  const int angle_from = angleBucket(s.angle - turn, angle_buckets_);
  const int angle_to = std::min(angleBucket(s.angle + turn, angle_buckets_),
                                angle_from + static_cast<int>(angle_buckets_) - 1);
  for (std::uint32_t size = size_from; size <= size_to; ++size) {
    for (int angle = angle_from; angle <= angle_to; ++angle) {
      const std::uint64_t longer =
          key + keyOf(depth, pack(s.density_class, size, wrapped(angle, angle_buckets_)));
      if (depth + 1 == n_) {
        lists_.push_back(listOf(longer));
      } else {
        for (WordIndex w = before.begin; w < before.end; ++w) collect(w, depth + 1, longer);
      }
    }
  }
}

void GramIndex::sortLists() {
  std::sort(lists_.begin(), lists_.end());
  lists_.erase(std::unique(lists_.begin(), lists_.end()), lists_.end());
}

void GramIndex::add(std::uint32_t list, std::uint32_t entry) {
  std::uint32_t& head = heads_[list];
  if (head == 0) {
    head = newChunk(0, kSmallest);
  } else if (pool_[head + 1] == pool_[head + 2]) {
    head = newChunk(head, std::min(2 * (pool_[head + 2] + kHeader), kLargest));
  }
  pool_[head + kHeader + pool_[head + 1]++] = entry;
}

std::uint32_t GramIndex::newChunk(std::uint32_t before, std::uint32_t size) {
  // A chunk lies in one block of the pool, so that its entries are neighbours in memory.
  constexpr std::size_t kBlock = std::size_t{1} << kBlockBits;
  std::size_t at = pool_.size();
  if (at / kBlock != (at + size - 1) / kBlock) at = (at / kBlock + 1) * kBlock;
  pool_.grow(at + size);
  pool_[at] = before;
  pool_[at + 2] = size - kHeader;
  return static_cast<std::uint32_t>(at);
}

}  // namespace ngram_slam
