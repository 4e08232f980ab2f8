// What scripts/fuzz feeds with bytes of all kinds, and test_fuzz_seeds.cpp with those kept. Each
// aborts if something holds that must not.
#pragma once

#include <cstddef>
#include <cstdint>

namespace selovis {
namespace fuzz {

/// A model's model.json, its signatures and its SVM, parted by "\n===\n"; names, lengths and
/// checksums of the parts are put right first. Refused, or it tells probabilities, and is written
/// and read as the same.
void placeModel(const std::uint8_t* data, std::size_t size);
/// A list of images and places: refused, or each frame has an image and a place.
void placeLabels(const std::uint8_t* data, std::size_t size);

}  // namespace fuzz
}  // namespace selovis
