// Pattern and factorisation against CHOLMOD, on random graphs.
#include <gtest/gtest.h>

#include <Eigen/CholmodSupport>
#include <Eigen/Dense>
#include <set>

#include "../src/core/graph_blocks.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/rng.hpp"

namespace {

using namespace hyselam_pose_graph;  // NOLINT: a test

struct Problem {
  int size;
  std::vector<std::pair<int, int>> couplings;
  Eigen::MatrixXd matrix;  ///< positive definite, 3 rows per variable
};

Problem randomProblem(std::uint64_t seed) {
  hyselam::Rng rng(seed);
  Problem p;
  p.size = 1 + static_cast<int>(rng.below(40));
  std::set<std::pair<int, int>> pairs;
  const auto tries = rng.below(static_cast<std::uint32_t>(3 * p.size));
  for (std::uint32_t k = 0; k < tries; ++k) {
    const auto a = static_cast<int>(rng.below(static_cast<std::uint32_t>(p.size)));
    const auto b = static_cast<int>(rng.below(static_cast<std::uint32_t>(p.size)));
    if (a != b) pairs.insert({std::min(a, b), std::max(a, b)});
  }
  p.matrix = Eigen::MatrixXd::Identity(3 * p.size, 3 * p.size);
  for (const auto& [a, b] : pairs) {
    // A sum of J^T J stays positive.
    Eigen::Matrix<double, 3, 6> j;
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 6; ++c) j(r, c) = 2.0 * rng.uniform() - 1.0;
    const Eigen::Matrix<double, 6, 6> h = j.transpose() * j;
    const int at[2] = {a, b};
    for (int r = 0; r < 2; ++r)
      for (int c = 0; c < 2; ++c)
        p.matrix.block<3, 3>(3 * at[r], 3 * at[c]) += h.block<3, 3>(3 * r, 3 * c);
    // Either order, and some pairs twice.
    p.couplings.emplace_back(rng.below(2) == 0 ? a : b, 0);
    p.couplings.back().second = p.couplings.back().first == a ? b : a;
    if (rng.below(4) == 0) p.couplings.emplace_back(a, b);
  }
  return p;
}

void fill(const Problem& p, const CholeskyPattern& pattern, BlockCholesky<Block3>* h) {
  h->setZero();
  const auto put = [&](int entry, const Eigen::Matrix3d& m) {
    for (int c = 0; c < 3; ++c)
      h->entry(entry).column[c] = Block3::Vector{m(0, c), m(1, c), m(2, c), 0.0};
  };
  for (int i = 0; i < p.size; ++i) put(pattern.diagonal(i), p.matrix.block<3, 3>(3 * i, 3 * i));
  for (const auto& [a, b] : p.couplings) {
    const CholeskyPattern::Slot slot = pattern.slot(a, b);
    const Eigen::Matrix3d m = p.matrix.block<3, 3>(3 * a, 3 * b);
    if (slot.transposed)
      put(slot.entry, m.transpose());
    else
      put(slot.entry, m);
  }
}

TEST(BlockCholesky, SolvesAsCholmodDoes) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    const Problem p = randomProblem(seed);
    const CholeskyPattern pattern = analyzePattern(p.size, p.couplings);
    BlockCholesky<Block3> h(pattern);
    fill(p, pattern, &h);
    ASSERT_TRUE(factorPoses(&h)) << seed;
    const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(3 * p.size, -1.0, 2.0);
    std::vector<Block3::Vector> x;
    for (int i = 0; i < p.size; ++i)
      x.push_back(Block3::Vector{b[3 * i], b[3 * i + 1], b[3 * i + 2], 0.0});
    h.solve(&x);
    Eigen::SparseMatrix<double> sparse = p.matrix.sparseView();
    Eigen::CholmodSupernodalLLT<Eigen::SparseMatrix<double>> cholmod(sparse);
    const Eigen::VectorXd expected = cholmod.solve(b);
    for (int i = 0; i < p.size; ++i)
      for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(x[static_cast<std::size_t>(i)][k], expected[3 * i + k],
                    1e-9 * (1.0 + expected.norm()))
            << seed;
  }
}

TEST(BlockCholesky, DispatchedFactorEqualsThePlainOne) {
  const Problem p = randomProblem(17);
  const CholeskyPattern pattern = analyzePattern(p.size, p.couplings);
  BlockCholesky<Block3> a(pattern), b(pattern);
  fill(p, pattern, &a);
  fill(p, pattern, &b);
  ASSERT_TRUE(factorPoses(&a));
  ASSERT_TRUE(b.factor());
  for (int i = 0; i < pattern.entries(); ++i)
    for (int c = 0; c < 3; ++c)
      for (int r = 0; r < 3; ++r) EXPECT_EQ(a.entry(i).column[c][r], b.entry(i).column[c][r]);
}

TEST(BlockCholesky, ReportsMatricesThatAreNotPositiveDefinite) {
  const CholeskyPattern pattern = analyzePattern(2, {{0, 1}});
  BlockCholesky<BlockComplex> h(pattern);
  h.setZero();
  h.entry(pattern.diagonal(0)).value = 1.0;
  h.entry(pattern.diagonal(1)).value = 1.0;
  h.entry(pattern.slot(0, 1).entry).value = 2.0;
  EXPECT_FALSE(h.factor());
}

TEST(BlockCholesky, SolvesComplexSystems) {
  const CholeskyPattern pattern = analyzePattern(2, {{0, 1}});
  BlockCholesky<BlockComplex> h(pattern);
  h.setZero();
  const std::complex<double> z{0.3, 0.8};
  h.entry(pattern.diagonal(0)).value = 2.0;
  h.entry(pattern.diagonal(1)).value = 3.0;
  const CholeskyPattern::Slot slot = pattern.slot(0, 1);
  h.entry(slot.entry).value = slot.transposed ? std::conj(z) : z;
  ASSERT_TRUE(h.factor());
  std::vector<std::complex<double>> x = {{1.0, 2.0}, {-1.0, 0.5}};
  const auto b = x;
  h.solve(&x);
  EXPECT_LT(std::abs(2.0 * x[0] + z * x[1] - b[0]), 1e-12);
  EXPECT_LT(std::abs(std::conj(z) * x[0] + 3.0 * x[1] - b[1]), 1e-12);
}

TEST(CholeskyPattern, RejectsVariablesOutOfRange) {
  EXPECT_THROW(analyzePattern(2, {{0, 2}}), hyselam::InputError);
  EXPECT_THROW(analyzePattern(2, {{1, 1}}), hyselam::InputError);
  EXPECT_THROW(analyzePattern(2, {{-1, 1}}), hyselam::InputError);
  EXPECT_EQ(analyzePattern(0, {}).entries(), 0);
}

}  // namespace
