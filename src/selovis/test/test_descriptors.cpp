// Fast histograms against the equations as they stand; sizes of the thesis' tables; refusals.
#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <opencv2/imgproc.hpp>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/rng.hpp"
#include "hyselam_common/testing/files.hpp"
#include "selovis/descriptors/color_lbp.hpp"
#include "selovis/descriptors/descriptor.hpp"
#include "selovis/descriptors/vanishing_point.hpp"
#include "transcription/plain_lbp.hpp"

namespace selovis {
namespace {

using hyselam::testing::messageOf;

/// Noise, plain areas, ramps and few colours: ties and borders of all classes come up.
cv::Mat randomImage(hyselam::Rng& rng, int rows, int cols) {
  cv::Mat image(rows, cols, CV_8UC3);
  const int kind = static_cast<int>(rng.below(4));
  const int steps = 2 + static_cast<int>(rng.below(5));
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < cols; ++x) {
      cv::Vec3b& p = image.at<cv::Vec3b>(y, x);
      for (int c = 0; c < 3; ++c) {
        int v = static_cast<int>(rng.below(256));
        if (kind == 1) v = v * steps / 256 * 255 / (steps - 1);
        if (kind == 2) v = (x * 3 + y * (c + 1) + v / 32) & 255;
        if (kind == 3) v = x / 7 % 2 ? 20 + v / 64 : 200;
        p[c] = static_cast<std::uint8_t>(v);
      }
    }
  }
  return image;
}

/// A view into a larger image: rows do not follow each other in memory.
cv::Mat asRegion(const cv::Mat& image, cv::Mat& holder) {
  holder = cv::Mat(image.rows + 5, image.cols + 9, CV_8UC3, cv::Scalar(1, 2, 3));
  cv::Mat view = holder(cv::Rect(4, 2, image.cols, image.rows));
  image.copyTo(view);
  return view;
}

std::vector<float> shares(const std::vector<int>& counts, double total) {
  std::vector<float> out;
  for (const int n : counts) out.push_back(static_cast<float>(n / std::max(1.0, total)));
  return out;
}

void expectNear(const std::vector<float>& a, const std::vector<float>& b, const std::string& what) {
  ASSERT_EQ(a.size(), b.size()) << what;
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_NEAR(a[i], b[i], 1e-6) << what << " bin " << i;
  }
}

using Member = std::function<bool(int, int)>;

std::vector<float> plainLbpByHsv(const cv::Mat& im, bool uniform, int n, char second,
                                 const std::vector<Member>& regions, const DescriptorParams& p) {
  const int r = p.lbp.radius;
  const double total = double(std::max(0, im.rows - 2 * r)) * std::max(0, im.cols - 2 * r);
  std::vector<int> all, sum;
  for (const Member& m : regions) {
    const auto h =
        plain::byColor(im, uniform, n, p.value_min, p.saturation_min, r, p.lbp.disc_mean, m);
    all.insert(all.end(), h.begin(), h.end());
    sum.resize(h.size());
    for (std::size_t i = 0; i < h.size(); ++i) sum[i] += h[i];
  }
  if (regions.size() > 1) all.insert(all.end(), sum.begin(), sum.end());
  std::vector<float> out = shares(all, total);
  if (second != 'N') {
    const auto h =
        plain::secondStage(im, second == 'U', n, p.value_min, p.saturation_min, r, p.lbp.disc_mean);
    const double inner = double(std::max(0, im.rows - 4 * r)) * std::max(0, im.cols - 4 * r);
    const auto s = shares(h, inner);
    out.insert(out.end(), s.begin(), s.end());
  }
  return out;
}

std::vector<Member> regionsOf(const std::string& suffix, int rows, int cols) {
  if (suffix == "-D") {
    return {[=](int, int y) { return y < rows / 2; }, [=](int, int y) { return y >= rows / 2; }};
  }
  if (suffix == "-IRIS") {
    const int middle_col = cols / 2, middle_row = rows / 2;  // the static point
    const double cx = middle_col, cy = middle_row;
    const auto part = [=](int x, int y) {
      const bool above = y < cy;
      const double depth = above ? y : rows - y, height = above ? cy : rows - cy;
      if (x * height < depth * cx) return 1;
      if ((cols - x) * height <= depth * (cols - cx)) return 2;
      return above ? 0 : 3;
    };
    std::vector<Member> members;
    for (int k = 0; k < 4; ++k) members.push_back([=](int x, int y) { return part(x, y) == k; });
    return members;
  }
  return {[](int, int) { return true; }};
}

TEST(Descriptors, LbpByHsvEqualsTheTranscriptionOnRandomImages) {
  hyselam::Rng rng(11);
  for (int round = 0; round < 60; ++round) {
    const int rows = 2 + static_cast<int>(rng.below(50)),
              cols = 2 + static_cast<int>(rng.below(70));
    const cv::Mat image = randomImage(rng, rows, cols);
    cv::Mat holder;
    const cv::Mat input = round % 2 ? asRegion(image, holder) : image;
    DescriptorParams p;
    p.lbp.radius = round % 3 ? 3 : 1 + static_cast<int>(rng.below(9));
    p.lbp.disc_mean = round % 5 != 0;
    p.value_min = static_cast<int>(rng.below(256));
    p.saturation_min = static_cast<int>(rng.below(256));
    p.threads = 1 + static_cast<int>(rng.below(3));
    const bool narrow = p.lbp.disc_mean && p.lbp.radius > 4;  // sums of two stages exceed 16 bits
    for (const std::string name : {"U8N", "U8U", "U8S", "U16N", "U16S", "S8N", "U5N", "S3N"}) {
      for (const std::string suffix : {"", "-D", "-IRIS"}) {
        if (name.back() != 'N' && (narrow || !suffix.empty())) continue;
        const auto d = makeDescriptor("LBPbyHSV-" + name + suffix, p);
        const int n = std::stoi(name.substr(1));
        expectNear(
            d->compute(input),
            plainLbpByHsv(image, name[0] == 'U', n, name.back(), regionsOf(suffix, rows, cols), p),
            name + suffix + " round " + std::to_string(round));
      }
    }
  }
}

TEST(Descriptors, DepthLbpEqualsTheTranscription) {
  hyselam::Rng rng(12);
  for (int round = 0; round < 12; ++round) {
    const cv::Mat image = randomImage(rng, 30 + round, 45 + 3 * round);
    SensorReadings readings;
    for (int i = 0; i < 20; ++i) {
      readings.ranges.push_back(static_cast<float>(rng.uniform(0.2, 4.0)));
    }
    readings.ranges[3] = std::numeric_limits<float>::infinity();
    const auto section = [&](int x) {
      int i = 0;  // column i covers pixels from i * cols / 20 on
      while (i < 19 && x >= (i + 1) * image.cols / 20) ++i;
      const float d = readings.ranges[static_cast<std::size_t>(i)];
      return d < 1.0f ? 0 : d < 2.0f ? 1 : 2;
    };
    const DescriptorParams p;
    const double total = double(image.rows - 6) * (image.cols - 6);
    std::vector<int> counts, whole(472), uniform(59);
    for (int s = 0; s < 3; ++s) {
      const auto h = plain::byColor(image, true, 8, p.value_min, p.saturation_min, 3, true,
                                    [&](int x, int) { return section(x) == s; });
      counts.insert(counts.end(), h.begin(), h.end());
      for (std::size_t k = 0; k < h.size(); ++k) {
        whole[k] += h[k];
        uniform[k % 59] += h[k];
      }
    }
    const auto joined = [&](const std::vector<int>& tail) {
      std::vector<int> all = counts;
      all.insert(all.end(), tail.begin(), tail.end());
      return shares(all, total);
    };
    expectNear(makeDescriptor("sLBP-(N)LRF20")->compute(image, readings), joined({}), "N");
    expectNear(makeDescriptor("sLBP-(A)LRF20")->compute(image, readings), joined(whole), "A");
    expectNear(makeDescriptor("sLBP-(S)LRF20")->compute(image, readings), joined(uniform), "S");
  }
}

TEST(Descriptors, BaselinesEqualTheTranscription) {
  hyselam::Rng rng(13);
  for (int round = 0; round < 10; ++round) {
    const cv::Mat image = randomImage(rng, 25 + 3 * round, 31 + 5 * round);
    cv::Mat hsv, gray;
    cv::cvtColor(image, hsv, cv::COLOR_BGR2HSV);
    cv::cvtColor(image, gray, cv::COLOR_BGR2GRAY);
    const double total = double(image.rows - 6) * (image.cols - 6);
    std::vector<int> all(768), uniform(174), pyramid(21 * 58), census(256);
    for (int y = 1; y < image.rows - 1; ++y) {
      for (int x = 1; x < image.cols - 1; ++x) {
        ++census[plain::lbp([&](int u, int v) { return gray.at<std::uint8_t>(v, u); }, x, y, 1,
                            false)];
      }
    }
    for (int y = 3; y < image.rows - 3; ++y) {
      for (int x = 3; x < image.cols - 3; ++x) {
        for (int c = 0; c < 3; ++c) {
          const int code =
              plain::lbp([&](int u, int v) { return hsv.at<cv::Vec3b>(v, u)[c]; }, x, y, 3, true);
          ++all[c * 256 + code];
          if (plain::isUniform(code)) ++uniform[c * 58 + plain::uniformLabel(code)];
        }
        const int code =
            plain::lbp([&](int u, int v) { return gray.at<std::uint8_t>(v, u); }, x, y, 3, true);
        if (!plain::isUniform(code)) continue;
        const int label = plain::uniformLabel(code);
        int row = 0, col = 0;
        while (row < 3 && y * 4 / image.rows > row) ++row;
        while (col < 3 && x >= (col + 1) * image.cols / 4) ++col;
        ++pyramid[label];
        ++pyramid[(1 + row / 2 * 2 + col / 2) * 58 + label];
        ++pyramid[(5 + row * 4 + col) * 58 + label];
      }
    }
    expectNear(makeDescriptor("HSV-LBP")->compute(image), shares(all, total), "HSV-LBP");
    expectNear(makeDescriptor("HSV-LBP-u")->compute(image), shares(uniform, total), "HSV-LBP-u");
    expectNear(makeDescriptor("SLBP")->compute(image), shares(pyramid, total), "SLBP");
    expectNear(makeDescriptor("CENTRIST")->compute(image),
               shares(census, double(image.rows - 2) * (image.cols - 2)), "CENTRIST");
  }
}

TEST(Descriptors, ColorClassesAreThoseOfEquation613) {
  std::vector<cv::Vec3b> colors;
  for (int b = 0; b < 256; b += 5) {
    for (int g = 0; g < 256; g += 5) {
      for (int r = 0; r < 256; r += 3) colors.emplace_back(b, g, r);
    }
  }
  std::vector<std::uint8_t> gray(colors.size() + 16), classes(colors.size() + 16);
  for (const int n : {3, 7, 8, 16}) {
    classifyRow(colors.front().val, static_cast<int>(colors.size()), {n, 40, 40}, gray.data(),
                classes.data());
    for (std::size_t i = 0; i < colors.size(); ++i) {
      ASSERT_EQ(classes[i], plain::colorClass(colors[i], n, 40, 40)) << n << " " << colors[i];
      ASSERT_EQ(gray[i], plain::gray(colors[i]));
    }
  }
}

TEST(Descriptors, SizesAreThoseOfTheTables) {
  const std::pair<const char*, int> sizes[] = {{"LBPbyHSV-U8N", 472},
                                               {"LBPbyHSV-U8U", 531},
                                               {"LBPbyHSV-U8S", 728},
                                               {"LBPbyHSV-U16N", 944},
                                               {"LBPbyHSV-U16S", 1200},
                                               {"LBPbyHSV-U8N-D", 1416},
                                               {"LBPbyHSV-U8N-IRIS", 2360},
                                               {"hLBP", 2360},
                                               {"hLBP+psi", 2361},
                                               {"hLBP+ψ+A20", 2381},
                                               {"hLBP+[ψ]+A20", 2384},
                                               {"sLBP-(N)LRF20", 1416},
                                               {"sLBP-(N)LRF20+ψ", 1417},
                                               {"sLBP-(A)LRF20", 1888},
                                               {"sLBP-(A)LRF20+ψ", 1889},
                                               {"sLBP-(S)LRF20", 1475},
                                               {"sLBP-(S)LRF20+ψ", 1476},
                                               {"sLBP-LRF(S)20+[ψ]", 1479},
                                               {"HSV-LBP", 768},
                                               {"HSV-LBP-u", 174},
                                               {"SLBP", 1218},
                                               {"HSV-GIST", 960},
                                               {"LGOP", 540},
                                               {"GLANCE", 1180},
                                               {"GLANCE+scan", 1241},
                                               {"HSV-HIST", 256},
                                               {"LOGCHROMA", 384},
                                               {"RANKS", 576},
                                               {"GRAY", 768},
                                               {"FUSION", 4406},
                                               {"FUSION+scan", 4467},
                                               {"FUSION-LEARNT", 4534},
                                               {"BOF-SIFT200", 200},
                                               {"BOF-ORB500-D", 1500},
                                               {"LBPbyHSV-U8N-D+BOF-ORB500", 1916},
                                               {"LBPbyHSV-U8N-D+HSV-GIST", 2376},
                                               {"CENTRIST", 256}};
  for (const auto& s : sizes) EXPECT_EQ(makeDescriptor(s.first)->size(), s.second) << s.first;
}

TEST(Descriptors, ListedNamesAllWorkOnAColorImage) {
  hyselam::Rng rng(14);
  const cv::Mat image = randomImage(rng, 120, 160);
  SensorReadings readings;
  readings.ranges.assign(20, 1.5f);
  readings.scan.assign(181, 2.0f);
  for (const auto& name : descriptorNames()) {
    const auto d = makeDescriptor(name);
    if (d->needsDictionary()) continue;
    for (const float v : d->compute(image, readings)) ASSERT_TRUE(std::isfinite(v)) << name;
  }
}

TEST(Descriptors, BagOfFeaturesLearnsADictionaryAndRestoresIt) {
  hyselam::Rng rng(15);
  std::vector<cv::Mat> images;
  for (int i = 0; i < 4; ++i) images.push_back(randomImage(rng, 120, 160));
  const auto d = makeDescriptor("BOF-ORB20-D");
  EXPECT_NE(messageOf<hyselam::InputError>([&] { d->compute(images[0]); }).find("train"),
            std::string::npos);
  d->learnDictionary(images, 1);
  const auto before = d->compute(images[0]);
  float sum = 0.0f;
  for (int i = 0; i < 20; ++i) sum += before[i];
  EXPECT_NEAR(sum, 1.0f, 1e-4);
  const auto copy = makeDescriptor("BOF-ORB20-D");
  copy->setDictionary(d->dictionary());
  EXPECT_EQ(copy->compute(images[0]), before);
  EXPECT_THROW(copy->setDictionary({1.0f, 2.0f}), hyselam::InputError);
}

TEST(Descriptors, GrayAndUnsuitableImagesAreRefusedWithTheDescriptorsName) {
  const cv::Mat gray(40, 40, CV_8UC1, cv::Scalar(9)), deep(40, 40, CV_16UC3, cv::Scalar(9));
  for (const std::string name :
       {"LBPbyHSV-U8N", "LBPbyHSV-U8S-D", "HSV-LBP", "HSV-GIST", "hLBP", "GLANCE", "FUSION",
        "FUSION-LEARNT", "HSV-HIST", "LOGCHROMA", "RANKS"}) {
    const auto d = makeDescriptor(name);
    EXPECT_NE(messageOf<hyselam::InputError>([&] { d->compute(gray); }).find("grey"),
              std::string::npos)
        << name;
    EXPECT_NE(messageOf<hyselam::InputError>([&] { d->compute(deep); }), "") << name;
    EXPECT_NE(messageOf<hyselam::InputError>([&] { d->compute(cv::Mat()); }), "") << name;
  }
  for (const std::string name :
       {"LBP8,1", "SLBP", "CENTRIST", "LGOP", "GRAY"}) {  // these need no colour
    EXPECT_NO_THROW(makeDescriptor(name)->compute(gray)) << name;
  }
}

TEST(Descriptors, MissingReadingsAreReported) {
  const cv::Mat image(40, 40, CV_8UC3, cv::Scalar(9, 8, 7));
  const std::pair<const char*, const char*> cases[] = {{"sLBP-(N)LRF20", "distances"},
                                                       {"hLBP+psi", "heading"},
                                                       {"hLBP+[psi]", "magnetic"},
                                                       {"hLBP+A20", "distances"},
                                                       {"LGOP+scan", "laser scan"}};
  for (const auto& c : cases) {
    const auto d = makeDescriptor(c.first);
    EXPECT_NE(messageOf<hyselam::InputError>([&] { d->compute(image); }).find(c.second),
              std::string::npos)
        << c.first;
  }
}

TEST(Descriptors, UnknownNamesAreRefused) {
  for (const std::string name :
       {"", "LBP", "LBPbyHSV-U8", "LBPbyHSV-X8N", "LBPbyHSV-U2N", "LBPbyHSV-U17N", "LBPbyHSV-S8S",
        "hLBP+", "+hLBP", "sLBP-(X)LRF20", "sLBP-(N)LRF0", "A99999999999", "BOF-SIFT1",
        "HSV-GIST30", "BOF-ORB50+BOF-SIFT50"}) {
    EXPECT_THROW(makeDescriptor(name), hyselam::InputError) << name;
  }
}

TEST(Descriptors, BlackAndTinyImagesGiveFiniteSignatures) {
  SensorReadings readings;
  readings.scan.assign(181, 2.0f);
  for (const cv::Size size :
       {cv::Size(640, 480), cv::Size(1, 1), cv::Size(5, 300), cv::Size(7, 7)}) {
    const cv::Mat black(size, CV_8UC3, cv::Scalar::all(0));
    for (const std::string name : {"LBPbyHSV-U8S-IRIS", "LBPbyHSV-U8N-IRIS-VP", "SLBP", "HSV-LBP",
                                   "LGOP", "HSV-GIST", "GLANCE+scan", "GRAY", "FUSION+scan"}) {
      for (const float v : makeDescriptor(name)->compute(black, readings)) {
        ASSERT_TRUE(std::isfinite(v)) << name << " " << size;
      }
    }
  }
}

TEST(Descriptors, OneObjectTakesImagesOfChangingSize) {
  hyselam::Rng rng(16);
  const cv::Mat a = randomImage(rng, 60, 80), b = randomImage(rng, 33, 121);
  for (const std::string name : {"LBPbyHSV-U8S", "LBPbyHSV-U8N-IRIS", "SLBP", "HSV-LBP", "GLANCE",
                                 "HSV-GIST", "GRAY", "FUSION"}) {
    const auto d = makeDescriptor(name);
    const auto first = d->compute(a);
    EXPECT_EQ(d->compute(b), makeDescriptor(name)->compute(b)) << name;
    EXPECT_EQ(d->compute(a), first) << name;
  }
}

TEST(VanishingPoint, IsFoundWhereLinesMeet) {
  hyselam::Rng rng(17);
  for (int round = 0; round < 10; ++round) {
    const cv::Point at(220 + static_cast<int>(rng.below(200)),
                       170 + static_cast<int>(rng.below(140)));
    cv::Mat image(480, 640, CV_8UC3, cv::Scalar::all(210));
    for (const cv::Point corner :
         {cv::Point(0, 0), cv::Point(639, 0), cv::Point(0, 479), cv::Point(639, 479),
          cv::Point(0, 100), cv::Point(639, 120), cv::Point(60, 479), cv::Point(500, 479)}) {
      cv::line(image, corner, at, cv::Scalar::all(30), 5, cv::LINE_AA);
    }
    const cv::Point2f found = VanishingPoint().find(image);
    EXPECT_NEAR(found.x, at.x, 40.0f);
    EXPECT_NEAR(found.y, at.y, 30.0f);
  }
  EXPECT_EQ(VanishingPoint().find(cv::Mat(100, 200, CV_8UC1, cv::Scalar(7))), cv::Point2f(100, 50));
}

// scikit-image interpolates between pixels; with 4 samples, or where all 8 fall on pixels, it
// defines the same. Its 8 samples at radius 1 are compared through the 4 that fall on pixels.
TEST(Descriptors, LbpCodesEqualScikitImageWhereDefinitionsCoincide) {
  const char* python = std::getenv("HYSELAM_PYTHON");
  const std::string run = python != nullptr ? python : "python3";
  if (std::system((run + " -c 'import skimage' > /dev/null 2>&1").c_str()) != 0) {
    GTEST_SKIP() << "no scikit-image: set HYSELAM_PYTHON to a Python that has it";
  }
  hyselam::testing::TemporaryDirectory folder;
  hyselam::Rng rng(18);
  const int rows = 47, cols = 61;
  cv::Mat gray(rows, cols, CV_8U);
  for (int i = 0; i < rows * cols; ++i) gray.data[i] = static_cast<std::uint8_t>(rng.below(40));
  std::ofstream(folder / "in", std::ios::binary)
      .write(reinterpret_cast<char*>(gray.data), rows * cols);
  for (const int radius : {1, 2, 3}) {
    const std::string script =
        "import numpy as np; from skimage.feature import local_binary_pattern as l; a = "
        "np.fromfile('" +
        (folder / "in") + "', np.uint8).reshape(47, 61); l(a, 4, " + std::to_string(radius) +
        ").astype(np.uint8).tofile('" + (folder / "out") + "')";
    ASSERT_EQ(std::system((run + " -c \"" + script + "\"").c_str()), 0);
    const std::string theirs = hyselam::testing::fileBytes(folder / "out");
    ASSERT_EQ(theirs.size(), std::size_t(rows * cols));
    LbpStream<std::uint8_t> stream({radius, false});
    stream.begin(cols);
    for (int y = 0; y < rows; ++y) {
      std::copy(gray.ptr(y), gray.ptr(y) + cols, stream.next());
      if (!stream.push()) continue;
      const int center = y - radius;
      for (int x = radius; x < cols - radius; ++x) {
        int even = 0;  // samples 0, 2, 4, 6 of 8 are the 4
        for (int p = 0; p < 4; ++p) even |= ((stream.codes()[x] >> (2 * p)) & 1) << p;
        ASSERT_EQ(even,
                  static_cast<std::uint8_t>(theirs[static_cast<std::size_t>(center * cols + x)]));
      }
    }
  }
}

}  // namespace
}  // namespace selovis
