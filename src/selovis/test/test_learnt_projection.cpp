// The learnt part of FUSION-LEARNT: its file, its arithmetic, and where it stands in a signature.
#include <gtest/gtest.h>

#include <cmath>

#include "../src/core/descriptors/learnt_projection.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/rng.hpp"
#include "hyselam_common/testing/files.hpp"
#include "selovis/descriptors/descriptor.hpp"

using namespace selovis;  // NOLINT: a test
using hyselam::InputError;
using hyselam::testing::messageOf;

namespace {

const char* const kHead =
    "selovis learnt projection 1\ncommand c\ndata d\nin_sample i\nleft_out l\n";

LearntProjection parsed(const std::string& lines) {
  return LearntProjection::parse(hyselam::withChecksum(kHead + lines), "file");
}

std::string refusalOf(const std::string& lines) {
  return messageOf<InputError>([&] { parsed(lines); });
}

TEST(LearntProjection, IsOffsetPlusUnitTimesWeightsBroughtToLengthOne) {
  const LearntProjection p =
      parsed("inputs 2\nA 2 0.5\nB 1 1\nvalues 2\n1 0.5 2 0 -4\n0 2 1 1 0\n");
  ASSERT_EQ(p.inputs().size(), 2u);
  EXPECT_EQ(p.inputs()[0].name, "A");
  EXPECT_EQ(p.inputs()[0].size, 2);
  EXPECT_DOUBLE_EQ(p.inputs()[0].power, 0.5);
  EXPECT_EQ(p.origin().left_out, "l");
  ASSERT_EQ(p.size(), 2);
  float out[2];
  p.project({1.0f, 0.5f, 0.25f}, out);  // (1 + 1 - 0.5, 2 + 1) = (1.5, 3)
  EXPECT_NEAR(out[0], 1.5 / std::sqrt(11.25), 1e-6);
  EXPECT_NEAR(out[1], 3.0 / std::sqrt(11.25), 1e-6);
}

TEST(LearntProjection, FilesWithMistakesAreRefusedWithTheLine) {
  EXPECT_NE(refusalOf("inputs 1\nA 2\nvalues 1\n0 1 1 1\n").find("line 7"), std::string::npos);
  EXPECT_NE(refusalOf("inputs 1\nA 2 0.5\nvalues 1\n0 1 1\n").find("3 numbers instead of 4"),
            std::string::npos);
  EXPECT_NE(refusalOf("inputs 1\nA 2 0.5\nvalues 1\n0 1 1 128\n").find("'128'"), std::string::npos);
  EXPECT_NE(refusalOf("inputs 1\nA 2 0.5\nvalues 2\n0 1 1 1\n").find("too early"),
            std::string::npos);
  EXPECT_NE(refusalOf("inputs 1\nA 2 0.5\nvalues 1\n0 1 1 1\nmore\n").find("more than"),
            std::string::npos);
  EXPECT_THROW(LearntProjection::parse("no checksum", "file"), InputError);
}

// The values are those of `bench/learnt_part export`, in PyTorch.
TEST(LearntProjection, ShippedOneGivesWhatTheTrainingProgramComputes) {
  const LearntProjection& p = LearntProjection::shipped();
  std::size_t width = 0;
  for (const SignaturePart& part : p.inputs()) width += static_cast<std::size_t>(part.size);
  std::vector<float> parts(width);
  for (std::size_t i = 0; i < width; ++i) parts[i] = static_cast<float>(37 * i % 101) / 1010.0f;
  std::vector<float> out(static_cast<std::size_t>(p.size()));
  p.project(parts, out.data());
  const float expected[] = {-0.0421206f, -0.0852299f, -0.0722060f,
                            0.1375526f,  -0.0339457f, 0.0916209f};
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(out[static_cast<std::size_t>(i)], expected[i], 1e-5) << i;
}

TEST(LearntProjection, StandsAtTheEndOfFusionLearnt) {
  hyselam::Rng rng(5);
  cv::Mat image(240, 320, CV_8UC3);
  for (int y = 0; y < image.rows; ++y) {
    for (int k = 0; k < 3 * image.cols; ++k) {
      image.ptr(y)[k] = static_cast<std::uint8_t>(rng.below(256));
    }
  }
  const auto fusion = makeDescriptor("FUSION"), with = makeDescriptor("FUSION-LEARNT");
  const LearntProjection& p = LearntProjection::shipped();
  ASSERT_EQ(with->size(), fusion->size() + p.size());
  ASSERT_EQ(with->parts().size(), fusion->parts().size() + 1);
  EXPECT_EQ(with->parts().back().name, "LEARNT");
  EXPECT_EQ(with->parts().back().size, p.size());
  EXPECT_FALSE(with->parts().back().absolute_color);
  const auto a = fusion->compute(image), b = with->compute(image);
  for (std::size_t i = 0; i < a.size(); ++i) ASSERT_EQ(a[i], b[i]) << i;
  std::vector<float> inputs;
  for (const SignaturePart& input : p.inputs()) {
    std::size_t begin = 0;
    for (const SignaturePart& part : fusion->parts()) {
      if (part.name == input.name) break;
      begin += static_cast<std::size_t>(part.size);
    }
    for (int i = 0; i < input.size; ++i) {
      const float v = a[begin + static_cast<std::size_t>(i)];
      inputs.push_back(input.power == 1.0 ? v : std::copysign(std::sqrt(std::abs(v)), v));
    }
  }
  std::vector<float> projected(static_cast<std::size_t>(p.size()));
  p.project(inputs, projected.data());
  for (std::size_t i = 0; i < projected.size(); ++i) {
    EXPECT_NEAR(b[a.size() + i], projected[i], 1e-5) << i;
  }
}

}  // namespace
