// A place found by the scans of a metre: how it is confirmed, and when it is not to be relied on.
#include <gtest/gtest.h>

#include "fsd_localization/search/probation.hpp"

using fsd_localization::Probation;

TEST(Probation, endsWithAnAnswerOfScansSeenSince) {
  Probation probation;
  EXPECT_FALSE(probation.isOpen());
  probation.begin(10.0);
  EXPECT_TRUE(probation.isOpen());
  probation.answered(11.4, 0.999, 0.98);
  EXPECT_TRUE(probation.isOpen()) << "by the scans that found it";
  probation.answered(12.0, 0.97, 0.98);
  EXPECT_TRUE(probation.isOpen()) << "not as sure as what is believed";
  probation.answered(13.0, 0.98, 0.98);
  EXPECT_FALSE(probation.isOpen());
  EXPECT_FALSE(probation.isDoubtful());
}

TEST(Probation, isDoubtfulWhileOtherPlacesAreLikelier) {
  Probation probation;
  probation.begin(0.0);
  EXPECT_FALSE(probation.isDoubtful());
  probation.answered(1.0, 0.49, 0.98);
  EXPECT_TRUE(probation.isDoubtful());
  EXPECT_TRUE(probation.isOpen());
  probation.answered(2.0, 0.5, 0.98);
  EXPECT_FALSE(probation.isDoubtful()) << "the last answer counts";
  probation.answered(3.0, 0.1, 0.98);
  probation.answered(4.0, 0.99, 0.98);
  EXPECT_FALSE(probation.isDoubtful());
  EXPECT_FALSE(probation.isOpen());
}

TEST(Probation, anotherPlaceBeginsAnew) {
  Probation probation;
  probation.begin(0.0);
  probation.answered(1.0, 0.1, 0.98);
  probation.begin(5.0);
  EXPECT_FALSE(probation.isDoubtful());
  probation.answered(6.0, 0.99, 0.98);
  EXPECT_TRUE(probation.isOpen());
}

TEST(Probation, aPoseThatWasToldIsOnNone) {
  Probation probation;
  probation.answered(3.0, 0.0, 0.98);
  EXPECT_FALSE(probation.isDoubtful());
  probation.begin(4.0);
  probation.answered(5.0, 0.0, 0.98);
  probation.reset();
  EXPECT_FALSE(probation.isDoubtful());
  EXPECT_FALSE(probation.isOpen());
}
