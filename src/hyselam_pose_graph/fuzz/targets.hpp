// What scripts/fuzz feeds with bytes of all kinds, and test_g2o_file.cpp with those kept.
#pragma once

#include <cstddef>
#include <cstdint>

namespace hyselam_pose_graph {
namespace fuzz {

/// A pose graph in g2o's format: refused, or sound, and written and read as the same. Aborts else.
void g2o(const std::uint8_t* data, std::size_t size);

}  // namespace fuzz
}  // namespace hyselam_pose_graph
