// pile --seed N --out NAME: things of a household in a pile on a table, as a depth camera sees
// them; or one of them alone, from all around.
#include "hyselam_sim/pile.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <iostream>
#include <limits>
#include <opencv2/imgcodecs.hpp>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/folder.hpp"
#include "hyselam_common/tool.hpp"

namespace {

using hyselam_sim::Article;
using hyselam_sim::CameraFrame;
using hyselam_sim::CameraParams;
using hyselam_sim::PlacedArticle;
using hyselam_sim::Pose3;

/// As a Kinect's.
CameraParams depthCamera() {
  CameraParams camera;
  camera.view = 2.0 * std::atan(320.0 / 525.0);
  return camera;
}

/// A binary PCD file with rows, fields x, y, z, rgb in the optical frame [m].
void writePcd(const std::string& path, const CameraParams& camera, const CameraFrame& frame) {
  const int width = frame.depth.cols, height = frame.depth.rows;
  const auto focal = static_cast<float>(camera.focalLength());
  const float nan = std::numeric_limits<float>::quiet_NaN();
  hyselam::writeFileAtomically(path, [&](std::ostream& out) {
    out << "VERSION 0.7\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F U\nCOUNT 1 1 1 1\nWIDTH "
        << width << "\nHEIGHT " << height << "\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " << width * height
        << "\nDATA binary\n";
    for (int v = 0; v < height; ++v) {
      for (int u = 0; u < width; ++u) {
        const std::uint16_t mm = frame.depth.at<std::uint16_t>(v, u);
        const float z = mm > 0 ? 0.001f * static_cast<float>(mm) : nan;
        const float xyz[3] = {
            (static_cast<float>(u) - 0.5f * static_cast<float>(width - 1)) * z / focal,
            (static_cast<float>(v) - 0.5f * static_cast<float>(height - 1)) * z / focal, z};
        const auto bgr = frame.color.at<cv::Vec3b>(v, u);
        const std::uint32_t rgb = std::uint32_t{bgr[2]} << 16 | std::uint32_t{bgr[1]} << 8 | bgr[0];
        out.write(reinterpret_cast<const char*>(xyz), sizeof xyz);
        out.write(reinterpret_cast<const char*>(&rgb), sizeof rgb);
      }
    }
  });
}

void writeView(const std::string& name, const CameraParams& camera, const CameraFrame& frame) {
  writePcd(name + ".pcd", camera, frame);
  if (!cv::imwrite(name + ".png", frame.color)) {
    throw hyselam::InputError(name + ".png", "", "cannot be written");
  }
}

nlohmann::json matrixOf(const Pose3& pose) {
  nlohmann::json rows = nlohmann::json::array();
  for (int r = 0; r < 3; ++r) {
    rows.push_back({pose.turn(r, 0), pose.turn(r, 1), pose.turn(r, 2), pose.at[r]});
  }
  rows.push_back({0.0, 0.0, 0.0, 1.0});
  return rows;
}

/// A line of the TUM format: number, position, quaternion.
std::string tumLine(int number, const Pose3& pose) {
  const cv::Matx33d& m = pose.turn;
  const auto half = [](double square) { return 0.5 * std::sqrt(std::max(0.0, square)); };
  char line[256];
  std::snprintf(line, sizeof line, "%d %.9f %.9f %.9f %.9f %.9f %.9f %.9f\n", number, pose.at[0],
                pose.at[1], pose.at[2],
                std::copysign(half(1.0 + m(0, 0) - m(1, 1) - m(2, 2)), m(2, 1) - m(1, 2)),
                std::copysign(half(1.0 - m(0, 0) + m(1, 1) - m(2, 2)), m(0, 2) - m(2, 0)),
                std::copysign(half(1.0 - m(0, 0) - m(1, 1) + m(2, 2)), m(1, 0) - m(0, 1)),
                half(1.0 + m(0, 0) + m(1, 1) + m(2, 2)));
  return line;
}

struct Options {
  std::string out, with, without, show;
  std::uint64_t seed = 1;
  int things = 8, looks = 1;
};

/// Where a robot believes its camera to be, a little beside where it is.
Pose3 believed(const Pose3& pose, hyselam::Rng& rng) {
  constexpr double kOff = 0.002, kOffTurn = 0.0035;  // [m], [rad]
  const auto three = [&](double sigma) {
    return cv::Vec3d{rng.gaussian(0.0, sigma), rng.gaussian(0.0, sigma), rng.gaussian(0.0, sigma)};
  };
  const cv::Vec3d turn = three(kOffTurn);
  return pose * Pose3{hyselam_sim::turnAbout(turn, cv::norm(turn)), three(kOff)};
}

/// The thing alone, from eight sides.
nlohmann::json showAlone(const Options& o) {
  constexpr int kViews = 8;
  constexpr double kDistance = 0.7;  // [m]
  const CameraParams camera = depthCamera();
  const std::vector<PlacedArticle> table{standing(hyselam_sim::householdThing(o.show))};
  hyselam::Rng rng(o.seed);
  hyselam::makeFolder(o.out);
  std::string poses;
  for (int i = 0; i < kViews; ++i) {
    const Pose3 pose = hyselam_sim::cameraAround(2.0 * hyselam::kPi * i / kViews,
                                                 hyselam::radians(40.0), kDistance);
    writeView(o.out + "/view_" + std::to_string(i), camera, viewOfPile(camera, table, pose, rng));
    poses += tumLine(i, believed(pose, rng));
  }
  hyselam::writeFileAtomically(o.out + "/poses.tum", [&](std::ostream& out) { out << poses; });
  std::cout << kViews << " views of the " << o.show << " -> " << o.out << "\n";
  return {{"thing", o.show}, {"views", kViews}, {"thing_on_table", matrixOf(table[0].pose)}};
}

std::vector<const Article*> drawThings(const Options& o, hyselam::Rng& rng) {
  std::vector<const Article*> others, out;
  for (const Article& article : hyselam_sim::household()) {
    if (article.name != o.with && article.name != o.without) others.push_back(&article);
  }
  if (!o.with.empty()) out.push_back(&hyselam_sim::householdThing(o.with));
  while (static_cast<int>(out.size()) < o.things && !others.empty()) {
    const auto at = rng.below(static_cast<std::uint32_t>(others.size()));
    out.push_back(others[at]);
    others.erase(others.begin() + at);
  }
  for (std::size_t i = out.size(); i > 1; --i) {
    std::swap(out[i - 1], out[rng.below(static_cast<std::uint32_t>(i))]);
  }
  return out;
}

int pixelsOf(const CameraFrame& frame, std::size_t thing) {
  return cv::countNonZero(frame.owner == static_cast<int>(thing) + 1);
}

/// Cameras all around the pile, from anywhere on.
std::vector<Pose3> drawCameras(int looks, hyselam::Rng& rng) {
  const double first = rng.uniform(0.0, 2.0 * hyselam::kPi);
  std::vector<Pose3> out;
  for (int i = 0; i < looks; ++i) {
    const double elevation = hyselam::radians(rng.uniform(40.0, 60.0));
    out.push_back(hyselam_sim::cameraAround(first + 2.0 * hyselam::kPi * i / looks, elevation,
                                            rng.uniform(0.75, 0.95)));
  }
  return out;
}

/// The share of a thing that its pile leaves to be seen, in the mean of all looks.
double visibleShare(const std::vector<PlacedArticle>& pile, std::size_t thing,
                    const std::vector<Pose3>& cameras, const std::vector<CameraFrame>& frames,
                    hyselam::Rng& rng) {
  int seen = 0, alone = 0;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    seen += pixelsOf(frames[i], thing);
    alone += pixelsOf(viewOfPile(depthCamera(), {pile[thing]}, cameras[i], rng), 0);
  }
  return static_cast<double>(seen) / std::max(1, alone);
}

/// NAME.pcd, or NAME_0.pcd ... with NAME.tum.
void writeLooks(const Options& o, const std::vector<Pose3>& cameras,
                const std::vector<CameraFrame>& frames, hyselam::Rng& rng) {
  std::string poses;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const std::string number = frames.size() > 1 ? "_" + std::to_string(i) : "";
    writeView(o.out + number, depthCamera(), frames[i]);
    poses += tumLine(static_cast<int>(i), believed(cameras[i], rng));
  }
  if (frames.size() == 1) return;
  hyselam::writeFileAtomically(o.out + ".tum", [&](std::ostream& out) { out << poses; });
}

/// A pile; one that hides most of the thing that is looked for is thrown away.
nlohmann::json drawPile(const Options& o) {
  constexpr int kTries = 50;
  constexpr double kLeastVisible = 0.4;
  if (!o.without.empty()) hyselam_sim::householdThing(o.without);
  hyselam::Rng rng(o.seed);
  for (int tries = 1; tries <= kTries; ++tries) {
    const std::vector<PlacedArticle> pile = dropPile(drawThings(o, rng), rng);
    const std::vector<Pose3> cameras = drawCameras(o.looks, rng);
    std::vector<CameraFrame> frames;
    for (const Pose3& camera : cameras) {
      frames.push_back(viewOfPile(depthCamera(), pile, camera, rng));
    }
    nlohmann::json out{
        {"seed", o.seed}, {"tries", tries}, {"camera_on_table", matrixOf(cameras[0])}};
    for (std::size_t i = 0; i < pile.size(); ++i) {
      const Article& article = *pile[i].article;
      out["things"].push_back(article.name);
      if (article.name != o.with) continue;
      out["visible"] = visibleShare(pile, i, cameras, frames, rng);
      out["thing_in_camera"] = matrixOf(cameras[0].inverse() * pile[i].pose);
      out["thing_on_table"] = matrixOf(pile[i].pose);
    }
    if (!o.with.empty() && out["visible"] < kLeastVisible) continue;
    writeLooks(o, cameras, frames, rng);
    std::cout << pile.size() << " things -> " << o.out << (o.looks > 1 ? "_0.pcd ..." : ".pcd")
              << "\n";
    return out;
  }
  throw hyselam::InputError("pile", "--with", "is hidden in all piles that were tried");
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Lets things of a household fall in a pile on a table and writes what a depth camera sees, "
      "as "
      "NAME.pcd and NAME.png; with --show the views of one thing alone, FOLDER/view_0.pcd ..., and "
      "where the camera believes to have been, FOLDER/poses.tum.",
      "pile");
  Options o;
  app.option_defaults()->always_capture_default();
  app.add_option("--out", o.out, "NAME of the pile, FOLDER of the views")->required();
  app.add_option("--seed", o.seed, "of the pile, the camera's place and its noise");
  app.add_option("--things", o.things, "in the pile")->check(CLI::Range(1, 12));
  app.add_option(
         "--looks", o.looks,
         "views of the pile from all around, NAME_0.pcd ..., with where the camera believes to "
         "have been, NAME.tum")
      ->check(CLI::Range(1, 36));
  auto* with =
      app.add_option("--with", o.with, "thing that is in the pile, for at least 40 % seen");
  auto* without = app.add_option("--without", o.without, "thing that is not");
  auto* show = app.add_option("--show", o.show, "thing that stands there alone");
  with->excludes(without)->excludes(show);
  without->excludes(show);
  return hyselam::runTool(argc, argv, app,
                          [&] { return o.show.empty() ? drawPile(o) : showAlone(o); });
}
