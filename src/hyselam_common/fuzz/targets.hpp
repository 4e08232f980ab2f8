// What scripts/fuzz feeds with bytes of all kinds, and fuzz_seeds_test.cpp with those kept. Each
// aborts if something holds that must not.
#pragma once

#include <cstddef>
#include <cstdint>

namespace hyselam {
namespace fuzz {

/// A CARMEN log: refused, or scans and odometry in order of time with numbers that are numbers.
void carmenLog(const std::uint8_t* data, std::size_t size);
/// The YAML file of a map, beside an image of 4 x 3 cells: refused, or saved and read as the same.
void mapYaml(const std::uint8_t* data, std::size_t size);
/// The image of a map, PGM in both forms or whatever OpenCV takes it for: the same.
void mapImage(const std::uint8_t* data, std::size_t size);
/// A trajectory, TUM or a table of reference poses: refused, or finite.
void poses(const std::uint8_t* data, std::size_t size);

}  // namespace fuzz
}  // namespace hyselam
