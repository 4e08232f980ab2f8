// The fuzzer's seeds are read, each as its target demands.
#include <gtest/gtest.h>

#include "hyselam_common/testing/fuzz_file.hpp"
#include "targets.hpp"

namespace {

int fed(const char* folder, void (*target)(const std::uint8_t*, std::size_t)) {
  return hyselam::testing::feedSeeds(std::string(HYSELAM_FUZZ_SEEDS "/") + folder, target);
}

TEST(FuzzSeeds, AreRead) {
  EXPECT_GE(fed("place_model", selovis::fuzz::placeModel), 3);
  EXPECT_GE(fed("place_labels", selovis::fuzz::placeLabels), 3);
}

}  // namespace
