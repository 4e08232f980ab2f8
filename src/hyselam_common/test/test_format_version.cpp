// What is said of files of versions that are not read.
#include <gtest/gtest.h>

#include "hyselam_common/format_version.hpp"

namespace {

using hyselam::formatRefusal;
using hyselam::versionRefusal;

TEST(FormatVersion, SaysWhatWasFoundAndWhatIsRead) {
  EXPECT_EQ(versionRefusal("5", {1, 4}),
            "has version 5, this program reads 1 to 4; it was written by a newer HySeLAM");
  EXPECT_EQ(versionRefusal("1", {2, 2}),
            "has version 1, this program reads 2; it was written by an older HySeLAM");
}

TEST(FormatVersion, WhatIsNoNumberIsNeitherNewerNorOlder) {
  EXPECT_EQ(versionRefusal("two", {1, 1}), "has version 'two', this program reads 1");
  EXPECT_EQ(versionRefusal("", {1, 1}), "has version '', this program reads 1");
  EXPECT_EQ(versionRefusal("-1", {1, 1}), "has version '-1', this program reads 1");
  EXPECT_EQ(versionRefusal("1.5", {1, 2}), "has version '1.5', this program reads 1 to 2");
  const std::string endless(1000, '7');
  EXPECT_EQ(versionRefusal(endless, {1, 1}),
            "has version '" + endless.substr(0, 40) + "', this program reads 1");
}

TEST(FormatVersion, FirstLines) {
  EXPECT_EQ(formatRefusal("selovis model 3", "selovis model 2", 1),
            "has version 3, this program reads 1 to 2; it was written by a newer HySeLAM");
  EXPECT_EQ(formatRefusal("ngram_slam semantic forest 2", "ngram_slam semantic forest 3"),
            "has version 2, this program reads 3; it was written by an older HySeLAM");
  for (const char* other : {"", "3", "selovis", "selovis model", "selovis model x", "selovis  2"}) {
    EXPECT_EQ(formatRefusal(other, "selovis model 2", 1), "is no 'selovis model 2'") << other;
  }
}

}  // namespace
