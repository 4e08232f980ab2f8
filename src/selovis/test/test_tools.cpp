// train and evaluate as a user calls them, lists and images that cannot be used.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/testing/files.hpp"
#include "hyselam_common/testing/program_run.hpp"
#include "selovis/learning/labeled_frames.hpp"
#include "selovis/learning/place_model.hpp"

namespace selovis {
namespace {

using hyselam::InputError;
using hyselam::testing::fileBytes;
using hyselam::testing::messageOf;
using hyselam::testing::ProgramRun;
using hyselam::testing::TemporaryDirectory;
using hyselam::testing::writeFile;

ProgramRun run(const std::string& command) {
  return hyselam::testing::runProgram(std::string(HYSELAM_TOOLS) + "/" + command);
}

/// Two rooms, ten frames each, as PNG; list "labels.csv".
void makeTour(const TemporaryDirectory& folder) {
  std::string list = "image_path,place\n";
  for (int i = 0; i < 20; ++i) {
    const int place = i / 10;
    cv::Mat image(60, 80, CV_8UC3, place ? cv::Scalar(40, 160, 60) : cv::Scalar(180, 90, 200));
    for (int x = i % 7; x < 80; x += place ? 9 : 4) image.col(x).setTo(cv::Scalar::all(10));
    const std::string name = std::to_string(i) + ".png";
    cv::imwrite(folder / name, image);
    list += name + (place ? ",kitchen\n" : ",hall\n");
  }
  writeFile(folder / "labels.csv", list);
}

TEST(Tools, TrainAndEvaluateWriteTheirFiles) {
  TemporaryDirectory f;
  makeTour(f);
  ASSERT_EQ(run("train --labels " + (f / "labels.csv") +
                " --descriptor LBPbyHSV-U8N --kernel linear --libsvm " + (f / "x.svm") + " --out " +
                (f / "m"))
                .status,
            0);
  EXPECT_NE(fileBytes(f / "x.svm").find("svm_type c_svc"), std::string::npos);
  // Without a support vector machine the file stays what it was.
  EXPECT_EQ(run("train --labels " + (f / "labels.csv") + " --libsvm " + (f / "x.svm") + " --out " +
                (f / "n"))
                .status,
            2);
  EXPECT_NE(fileBytes(f / "x.svm").find("svm_type c_svc"), std::string::npos);
  writeFile(f / "map.csv", "hall,kitchen\n");
  for (const std::string filter : {"none", "lowpass", "markov", "bayes"}) {
    const ProgramRun r =
        run("evaluate " + (f / "m") + " --labels " + (f / "labels.csv") + " --filter " + filter +
            " --topology " + (f / "map.csv") + " --json " + (f / "r.json") + " --predictions " +
            (f / "p.csv") + " --plots " + (f / "plots"));
    ASSERT_EQ(r.status, 0) << r.errors;
    const auto j = nlohmann::json::parse(fileBytes(f / "r.json"));
    EXPECT_GE(j["accuracy"].get<double>(), 0.8) << filter;
    EXPECT_EQ(j["accuracy_frame_alone"], 1.0);
    EXPECT_EQ(j["per_place"]["hall"]["frames"], 10);
    EXPECT_GE(j["confusion"]["kitchen"]["kitchen"].get<int>(), 7);
    EXPECT_TRUE(j["descriptor_ms"].is_number());
    const std::string predictions = fileBytes(f / "p.csv");
    EXPECT_EQ(std::count(predictions.begin(), predictions.end(), '\n'), 21);
    EXPECT_EQ(fileBytes(f / "plots/predictions.csv"), predictions);
    const std::string confusion = fileBytes(f / "plots/confusion.csv");
    EXPECT_EQ(confusion.find("truth,hall,kitchen,unknown\n"), 0u) << confusion;
    EXPECT_EQ(std::count(confusion.begin(), confusion.end(), '\n'), 4);
  }
}

TEST(Tools, EvaluateWarnsWherePosesCannotBeUsed) {
  TemporaryDirectory f;
  makeTour(f);
  const auto evaluate = [&](const std::string& step, const std::string& filter) {
    std::string list = "image_path,place,stamp,x,y,theta,odom_x,odom_y,odom_theta\n";
    for (int i = 0; i < 20; ++i) {
      const std::string n = std::to_string(i);
      list += n + ".png," + (i < 10 ? "hall," : "kitchen,") + n + "," + n + step + ",0,0,,,\n";
    }
    writeFile(f / "posed.csv", list);
    const std::string m = f / "m", labels = " --labels " + (f / "posed.csv");
    EXPECT_EQ(run("train --descriptor LGOP --kernel exemplar --out " + m + labels).status, 0);
    const ProgramRun r = run("evaluate " + m + labels + " --filter " + filter);
    EXPECT_EQ(r.status, 0) << r.errors;
    return r.errors;
  };
  EXPECT_NE(evaluate("", "poses").find("warning: the filter poses has no odometry"),
            std::string::npos);
  EXPECT_EQ(evaluate("", "auto").find("warning"), std::string::npos);
  EXPECT_NE(evaluate("000", "auto").find("5 km apart"), std::string::npos);
}

TEST(Tools, TwoTrainingsWriteTheSameBytes) {
  TemporaryDirectory f;
  makeTour(f);
  for (const std::string out : {"a", "b"}) {
    ASSERT_EQ(run("train --labels " + (f / "labels.csv") +
                  " --descriptor LBPbyHSV-U8N --kernel rbf --out " + (f / out))
                  .status,
              0);
  }
  EXPECT_EQ(fileBytes(f / "a/model.json"), fileBytes(f / "b/model.json"));
}

TEST(Tools, UnknownPlacesAreReportedAndCanBeAdded) {
  TemporaryDirectory f;
  makeTour(f);
  ASSERT_EQ(run("train --labels " + (f / "labels.csv") +
                " --descriptor LGOP --kernel exemplar --out " + (f / "m"))
                .status,
            0);
  writeFile(f / "more.csv", "3.png,attic\n4.png,attic\n");
  ASSERT_EQ(
      run("evaluate " + (f / "m") + " --labels " + (f / "more.csv") + " --json " + (f / "r.json"))
          .status,
      0);
  const auto j = nlohmann::json::parse(fileBytes(f / "r.json"));
  EXPECT_EQ(j["accuracy"], 0.0);
  EXPECT_EQ(j["unknown_places"][0], "attic");
  ASSERT_EQ(
      run("train --add --labels " + (f / "more.csv") + " --kernel exemplar --out " + (f / "m"))
          .status,
      0);
  EXPECT_EQ(loadPlaceModel(f / "m").transitions.places,
            (std::vector<std::string>{"hall", "kitchen", "attic"}));
}

TEST(Tools, BadInputEndsWithOneLineAndStatus2) {
  TemporaryDirectory f;
  makeTour(f);
  const std::string labels = f / "labels.csv",
                    train = "train --out " + (f / "m") + " --kernel linear ";
  const auto refused = [&](const std::string& command, const std::string& says) {
    EXPECT_TRUE(hyselam::testing::refused(run(command), says)) << command;
  };
  refused(train + "--labels " + (f / "none.csv"), "none.csv");
  refused(train + "--labels " + labels + " --descriptor LBPbyHSV-Q8N", "LBPbyHSV-Q8N");
  refused(train + "--labels " + labels + " --cost -1", "cost");
  refused(train + "--labels " + labels + " --views 0,x", "--views");
  refused(train + "--labels " + labels + " --views 0,0.7", "half");
  refused("train --labels " + labels + " --kernel sigmoid --out " + (f / "m"), "sigmoid");
  writeFile(f / "one.csv", "0.png,hall\n1.png,hall\n");
  refused(train + "--labels " + (f / "one.csv"), "two places");
  refused(train + "--labels " + labels + " --descriptor sLBP-\\(N\\)LRF20", "distances");
  refused("evaluate " + (f / "m") + " --labels " + labels, "model.json");
  ASSERT_EQ(run(train + "--descriptor LBPbyHSV-U8N --labels " + labels).status, 0);
  refused("evaluate " + (f / "m") + " --labels " + labels + " --filter median", "median");
  refused("evaluate " + (f / "m") + " --labels " + labels + " --topology " + (f / "0.png"),
          "0.png");
  refused("evaluate " + (f / "m") + " --labels " + labels + " --images blur", "blur");
  cv::Mat image = cv::imread(f / "3.png"), gray;
  cv::cvtColor(image, gray, cv::COLOR_BGR2GRAY);
  cv::imwrite(f / "3.png", gray);
  refused("evaluate " + (f / "m") + " --labels " + labels, "3.png: LBPbyHSV: needs a colour image");
}

TEST(LabeledFrames, ColumnsAreReadByNameAndWithoutAHeader) {
  TemporaryDirectory f;
  writeFile(f / "a.csv",
            "file,stamp,place,x,psi,mag_x,mag_y,mag_z,range_0,range_1,scan_0\n"
            "rgb/1.jpg,12.5,hall,3,0.5,1,2,3,1.5,,4\n");
  const auto a = readLabeledFrames(f / "a.csv");
  ASSERT_EQ(a.size(), 1u);
  EXPECT_EQ(a[0].image, f / "rgb/1.jpg");
  EXPECT_EQ(a[0].place, "hall");
  EXPECT_EQ(a[0].readings.heading, 0.5);
  EXPECT_EQ(a[0].readings.magnetic[2], 3.0);
  ASSERT_EQ(a[0].readings.ranges.size(), 2u);
  EXPECT_TRUE(std::isnan(a[0].readings.ranges[1]));
  EXPECT_EQ(a[0].readings.scan[0], 4.0f);
  writeFile(f / "b.csv", "# a note\n/x/1.jpg,hall,1.5,2.5\r\n/x/2.jpg,hall,1.5,2.5\n");
  const auto b = readLabeledFrames(f / "b.csv");
  ASSERT_EQ(b.size(), 2u);
  EXPECT_EQ(b[0].image, "/x/1.jpg");
  EXPECT_EQ(b[1].readings.ranges[1], 2.5f);
}

TEST(LabeledFrames, PosesOdometryAndQuotedNamesAreRead) {
  TemporaryDirectory f;
  writeFile(f / "a.csv",
            "image_path,place,stamp,x,y,theta,odom_x,odom_y,odom_theta\n"
            "1.jpg,\"hall, east \"\"wing\"\"\",7.5,1,2,0.5,4,5,6\n"
            "\"2,3.jpg\",hall,,,,,,,\n");
  const auto a = readLabeledFrames(f / "a.csv");
  ASSERT_EQ(a.size(), 2u);
  EXPECT_EQ(a[0].place, "hall, east \"wing\"");
  EXPECT_EQ(csvCell(a[0].place), "\"hall, east \"\"wing\"\"\"");
  EXPECT_EQ(csvCell("hall"), "hall");
  EXPECT_EQ(a[0].readings.stamp, 7.5);
  EXPECT_EQ(a[0].pose.y, 2.0);
  ASSERT_TRUE(a[0].readings.odometry);
  EXPECT_EQ(a[0].readings.odometry->theta, 6.0);
  EXPECT_EQ(a[1].image, f / "2,3.jpg");
  EXPECT_FALSE(a[1].pose.isFinite());
  EXPECT_FALSE(a[1].readings.odometry);
}

TEST(LabeledFrames, BadListsAreRefusedWithTheLine) {
  TemporaryDirectory f;
  const std::pair<std::string, const char*> cases[] = {
      {"", "no frames"},
      {"image_path,place\n", "no frames"},
      {"a.jpg\n", "line 1"},
      {"a.jpg,hall\nb.jpg\n", "line 2"},
      {"a.jpg,hall\nb.jpg,\n", "line 2: has no place"},
      {"a.jpg,hall\n,hall\n", "line 2: has no image"},
      {"a.jpg,hall,1.5\nb.jpg,hall,x\n", "'x' is no number"},
      {std::string("a.jpg,ha\0ll\n", 12), "is no text"},
      {"a.jpg,hall\nb.jpg,\"hall\n", "line 2: has a quotation mark that is not closed"},
      {"a.jpg,\"hall\"s\n", "line 1: has text after a closing quotation mark"},
      {"a,b" + std::string(5000, ','), "too many columns"}};
  for (const auto& c : cases) {
    writeFile(f / "l.csv", c.first);
    const std::string what = messageOf<InputError>([&] { readLabeledFrames(f / "l.csv"); });
    EXPECT_NE(what.find(c.second), std::string::npos) << what;
  }
}

TEST(Images, TruncatedFilesAreRefusedWithTheirName) {
  TemporaryDirectory f;
  cv::Mat image(120, 160, CV_8UC3);
  cv::randu(image, 0, 255);
  for (const std::string name : {"a.jpg", "a.png"}) {
    cv::imwrite(f / name, image);
    const std::string good = fileBytes(f / name);
    EXPECT_EQ(readImage(f / name).size(), image.size());
    for (const double share : {0.02, 0.5, 0.95}) {
      writeFile(f / ("cut" + name),
                good.substr(0, static_cast<std::size_t>(share * double(good.size()))));
      const std::string what = messageOf<InputError>([&] { readImage(f / ("cut" + name)); });
      EXPECT_NE(what.find("cut" + name), std::string::npos) << share;
    }
  }
  writeFile(f / "t.jpg", "this is text");
  EXPECT_NE(messageOf<InputError>([&] { readImage(f / "t.jpg"); }), "");
  writeFile(f / "e.jpg", "");
  EXPECT_NE(messageOf<InputError>([&] { readImage(f / "e.jpg"); }).find("empty"),
            std::string::npos);
  EXPECT_THROW(readImage(f / "none.jpg"), InputError);
  EXPECT_THROW(readImage(f.path()), InputError);
}

TEST(Images, RangesAreTakenFromADepthImage) {
  TemporaryDirectory f;
  cv::Mat depth(240, 320, CV_16U, cv::Scalar(3000));
  depth(cv::Rect(0, 80, 160, 80)).setTo(cv::Scalar(1200));
  depth(cv::Rect(304, 0, 16, 240)).setTo(cv::Scalar(0));
  cv::imwrite(f / "d.png", depth);
  LabeledFrame frame;
  frame.depth = f / "d.png";
  const SensorReadings r = readingsOf(frame);
  ASSERT_EQ(r.ranges.size(), 20u);
  EXPECT_FLOAT_EQ(r.ranges[0], 1.2f);
  EXPECT_FLOAT_EQ(r.ranges[12], 3.0f);
  EXPECT_TRUE(std::isinf(r.ranges[19]));
  cv::imwrite(f / "d.png", cv::Mat(240, 320, CV_8U, cv::Scalar(3)));
  EXPECT_NE(messageOf<InputError>([&] { readingsOf(frame); }).find("16 bits"), std::string::npos);
}

}  // namespace
}  // namespace selovis
