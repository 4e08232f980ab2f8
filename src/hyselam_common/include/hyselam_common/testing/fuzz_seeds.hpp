// The one test of hyselam_fuzz_seeds(): every seed of every target of the package is read.
#pragma once

#include <gtest/gtest.h>

#include <iterator>

#include "hyselam_common/testing/fuzz_target.hpp"

TEST(FuzzSeeds, AreRead) {
  namespace fs = std::filesystem;
  EXPECT_FALSE(hyselam::testing::fuzzTargets().empty());
  for (const hyselam::testing::FuzzTarget& target : hyselam::testing::fuzzTargets()) {
    int files = 0;
    for (const auto& entry :
         fs::directory_iterator(fs::path(HYSELAM_FUZZ_SEEDS) / seedsFolder(target))) {
      SCOPED_TRACE(entry.path().string());
      std::ifstream in(entry.path(), std::ios::binary);
      const std::string bytes((std::istreambuf_iterator<char>(in)), {});
      target.feed(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
      ++files;
    }
    EXPECT_GE(files, 2) << target.name;
  }
}
