// What scripts/fuzz feeds with bytes of all kinds, and test_fuzz_seeds.cpp with those kept. The
// checksums of the bytes are put right first, so that what lies behind them is reached. Each aborts
// if something holds that must not.
#pragma once

#include <cstddef>
#include <cstdint>

namespace ngram_slam {
namespace fuzz {

/// A corpus of words: refused, or written to the same bytes.
void corpus(const std::uint8_t* data, std::size_t size);
/// The state of SLAM: refused, or sound, and written and read as the same.
void slamState(const std::uint8_t* data, std::size_t size);

}  // namespace fuzz
}  // namespace ngram_slam
