// Two solvers' answers compared.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "hyselam_topo/topomerg/topomerg.hpp"

/// The same answers in the same order.
inline void expectSame(const hyselam_topo::PlaceAssignment& a,
                       const hyselam_topo::PlaceAssignment& b, const std::string& what) {
  ASSERT_EQ(a.found(), b.found()) << what;
  ASSERT_EQ(a.solutions.size(), b.solutions.size()) << what;
  EXPECT_EQ(a.equal, b.equal) << what;
  for (std::size_t k = 0; k < a.solutions.size(); ++k) {
    EXPECT_EQ(a.solutions[k].assignment, b.solutions[k].assignment) << what;
    EXPECT_NEAR(a.solutions[k].fitness, b.solutions[k].fitness, 1e-12) << what;
  }
}
