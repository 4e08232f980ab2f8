// The fuzzer's seeds are read, each as its target demands.
#include <gtest/gtest.h>

#include "hyselam_common/testing/fuzz_file.hpp"
#include "targets.hpp"

namespace {

int fed(const char* folder, void (*target)(const std::uint8_t*, std::size_t)) {
  return hyselam::testing::feedSeeds(std::string(HYSELAM_FUZZ_SEEDS "/") + folder, target);
}

TEST(FuzzSeeds, AreRead) {
  using namespace hyselam::fuzz;  // NOLINT: a test
  EXPECT_GE(fed("carmen_log", carmenLog), 7);
  EXPECT_GE(fed("map_yaml", mapYaml), 6);
  EXPECT_GE(fed("map_image", mapImage), 9);
  EXPECT_GE(fed("poses", poses), 4);
}

}  // namespace
