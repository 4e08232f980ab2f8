// What scripts/fuzz feeds with bytes of all kinds, and test_fuzz_seeds.cpp with those kept. Each
// aborts if something holds that must not.
#pragma once

#include <cstddef>
#include <cstdint>

namespace hyselam_objects {
namespace fuzz {

/// Text, a line at a time, into an object map that stays sound and comes back from XML as it was.
void objectText(const std::uint8_t* data, std::size_t size);
/// XML of an object map: refused, or read and written to the same again.
void objectMapXml(const std::uint8_t* data, std::size_t size);
/// XML of an object dictionary: the same, and it can be merged and used.
void objectDictionaryXml(const std::uint8_t* data, std::size_t size);

}  // namespace fuzz
}  // namespace hyselam_objects
