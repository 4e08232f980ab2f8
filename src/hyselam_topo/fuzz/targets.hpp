// What scripts/fuzz feeds with bytes of all kinds, and test_fuzz_corpus.cpp with those kept. Each
// aborts if something holds that must not.
#pragma once

#include <cstddef>
#include <cstdint>

namespace hyselam_topo {
namespace fuzz {

/// Text into utterances and a description, which comes back from XML as it was.
void parser(const std::uint8_t* data, std::size_t size);
/// XML of a description: refused, or read and written to the same again.
void descriptionXml(const std::uint8_t* data, std::size_t size);
/// XML of a topological map: the same.
void mapXml(const std::uint8_t* data, std::size_t size);

}  // namespace fuzz
}  // namespace hyselam_topo
