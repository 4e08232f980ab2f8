#include "hyselam_sim/camera.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "hyselam_common/errors.hpp"
#include "sensor.hpp"
#include "texture.hpp"

namespace hyselam_sim {
namespace {

constexpr double kNear = 0.05;     // [m]
constexpr double kInFront = 0.15;  // how far before a wall its room and light are looked up [m]
constexpr float kInfinite = std::numeric_limits<float>::infinity();
constexpr Color kLampShine{2.4f, 2.1f, 1.7f};

/// A part of a column that belongs to one face.
struct Span {
  const Body* body = nullptr;
  enum class Face { kSide, kTop, kUnderside } face = Face::kSide;
  float along = 0.0f;  // of a side: where on its edge [m]
  const Surface* surface = nullptr;
  Color light{};  // of a side
  Point2 front;   // of a side: a point before it
};

struct Crossing {
  float depth = 0.0f;
  float along = 0.0f;
  Point2 out;  // unit normal of the edge, away from the body
};

/// Paints one picture, column by column, each with its own depth buffer.
class Painter {
 public:
  Painter(const CameraParams& params, const Scene& scene, const LightParams& light,
          const Pose2& base)
      : params_(params),
        scene_(scene),
        sky_(light),
        focal_(params.focalLength()),
        eye_(base * params.camera_in_base),
        origin_{eye_.x, eye_.y},
        forward_{std::cos(eye_.theta), std::sin(eye_.theta)},
        right_{forward_.y, -forward_.x},
        color_(params.height, params.width, CV_32FC3),
        depth_(params.height, params.width, CV_32FC1),
        owner_(params.height, params.width, CV_32SC1),
        nearest_(static_cast<std::size_t>(params.height)),
        span_of_(static_cast<std::size_t>(params.height)),
        columns_(static_cast<std::size_t>(params.width)) {}

  void add(const std::vector<Body>& bodies) {
    for (const Body& body : bodies) add(body);
  }

  void paint() {
    for (int u = 0; u < params_.width; ++u) paintColumn(u);
  }

  const cv::Mat& color() const { return color_; }
  const cv::Mat& depth() const { return depth_; }
  const cv::Mat& owner() const { return owner_; }

 private:
  // Notes the body in the columns that it may cover.
  void add(const Body& body) {
    double least = std::numeric_limits<double>::infinity(), most = -least, nearest = least,
           farthest = -least;
    bool behind = false;
    for (const Point2& p : body.outline) {
      const double z = dot(p - origin_, forward_), x = dot(p - origin_, right_);
      nearest = std::min(nearest, z);
      farthest = std::max(farthest, z);
      if (z < kNear) {
        behind = true;
        continue;
      }
      least = std::min(least, x / z);
      most = std::max(most, x / z);
    }
    if (farthest < kNear || nearest > params_.range) return;
    int from = 0, to = params_.width - 1;
    if (!behind) {
      const double middle = 0.5 * params_.width;
      if (middle + focal_ * most < 0.0 || middle + focal_ * least > params_.width) return;
      from = std::max(0, static_cast<int>(std::floor(middle + focal_ * least - 1.0)));
      to = std::min(to, static_cast<int>(std::ceil(middle + focal_ * most + 1.0)));
    }
    for (int u = from; u <= to; ++u) columns_[static_cast<std::size_t>(u)].push_back(&body);
  }

  // Where the column's plane crosses the outline: entry and exit.
  bool cross(const Body& body, Point2 direction, Crossing* in, Crossing* out) const {
    in->depth = kInfinite;
    out->depth = -kInfinite;
    const std::size_t n = body.outline.size();
    for (std::size_t i = 0; i < n; ++i) {
      const Point2 a = body.outline[i], e = body.outline[(i + 1) % n] - a;
      const double det = hyselam_sim::cross(direction, e);
      if (std::abs(det) < 1e-12) continue;
      const Point2 to_a = a - origin_;
      const double depth = hyselam_sim::cross(to_a, e) / det;
      const double share = hyselam_sim::cross(to_a, direction) / det;
      if (share < 0.0 || share > 1.0) continue;
      const double l = length(e);
      Point2 normal = (1.0 / l) * Point2{e.y, -e.x};
      if (dot(normal, direction) > 0.0) normal = -1.0 * normal;
      const Crossing crossing{static_cast<float>(depth), static_cast<float>(share * l), normal};
      if (crossing.depth < in->depth) *in = crossing;
      if (crossing.depth > out->depth) *out = crossing;
    }
    return in->depth > static_cast<float>(kNear) && in->depth < static_cast<float>(params_.range);
  }

  double rowOf(double z, double depth) const {
    return 0.5 * params_.height + focal_ * (params_.above_floor - z) / depth;
  }

  // Rows whose centres lie within [top, bottom).
  template <typename Paint>
  void rows(double top, double bottom, Paint paint) {
    const int from = std::max(0, static_cast<int>(std::ceil(std::clamp(top, -1e6, 1e6) - 0.5)));
    const int to = std::min(params_.height - 1,
                            static_cast<int>(std::ceil(std::clamp(bottom, -1e6, 1e6) - 0.5)) - 1);
    for (int v = from; v <= to; ++v) paint(v);
  }

  void cover(int v, float depth, int span) {
    float& nearest = nearest_[static_cast<std::size_t>(v)];
    if (depth >= nearest) return;
    nearest = depth;
    span_of_[static_cast<std::size_t>(v)] = span;
  }

  // Depth of a level plane in a row; infinite where the row does not meet it.
  float planeDepth(double z, int v) const {
    const double down = v + 0.5 - 0.5 * params_.height;
    const double depth = focal_ * (params_.above_floor - z) / down;
    return depth > 0.0 ? static_cast<float>(depth) : kInfinite;
  }

  void paintColumn(int u) {
    const double x = (u + 0.5 - 0.5 * params_.width) / focal_;
    const Point2 direction = forward_ + x * right_;
    std::fill(nearest_.begin(), nearest_.end(), kInfinite);
    std::fill(span_of_.begin(), span_of_.end(), -1);
    spans_.clear();
    for (const Body* body : columns_[static_cast<std::size_t>(u)]) {
      Crossing in, out;
      if (cross(*body, direction, &in, &out)) addSpans(*body, in, out, direction);
    }
    for (int v = 0; v < params_.height; ++v) paintPixel(u, v, direction);
  }

  void addSpans(const Body& body, const Crossing& in, const Crossing& out, Point2 direction) {
    const double eye = params_.above_floor;
    Span span;
    span.body = &body;
    span.along = in.along;
    span.front = origin_ + static_cast<double>(in.depth) * direction + kInFront * in.out;
    span.surface = body.painted ? &scene_.paint(scene_.regions().roomAt(span.front)) : &body.side;
    span.light = sideLight(span.front, in.out);
    const int side = static_cast<int>(spans_.size());
    spans_.push_back(span);
    rows(rowOf(body.to, static_cast<double>(in.depth)),
         rowOf(body.from, static_cast<double>(in.depth)), [&](int v) { cover(v, in.depth, side); });
    for (const bool top : {true, false}) {
      const double z = top ? body.to : body.from;
      if (top ? eye <= z : eye >= z) continue;
      span.face = top ? Span::Face::kTop : Span::Face::kUnderside;
      span.surface = &body.top;
      const int level = static_cast<int>(spans_.size());
      spans_.push_back(span);
      const double a = rowOf(z, static_cast<double>(in.depth));
      const double b = rowOf(z, static_cast<double>(out.depth));
      rows(std::min(a, b), std::max(a, b), [&](int v) { cover(v, planeDepth(z, v), level); });
    }
  }

  Color sideLight(Point2 front, Point2 out) const {
    Color light = scene_.light().at(front, sky_);
    // Sides of a room differ a little in brightness, as they do where light comes from one side.
    const auto shade = static_cast<float>(0.9 + 0.1 * dot(out, Point2{0.8, 0.6}));
    for (float& channel : light) channel *= shade;
    return light;
  }

  void paintPixel(int u, int v, Point2 direction) {
    const auto row = static_cast<std::size_t>(v);
    float depth = nearest_[row];
    Color color{};
    std::uint32_t owner = 0;
    const bool down = 2 * v + 1 > params_.height;
    const float level = planeDepth(down ? 0.0 : scene_.ceiling(), v);
    if (span_of_[row] >= 0 && depth <= level) {
      const Span& span = spans_[static_cast<std::size_t>(span_of_[row])];
      owner = span.body->owner;
      color = span.face == Span::Face::kSide ? sideColor(span, depth, v)
                                             : levelColor(span, depth, direction);
    } else {
      depth = level;
      if (static_cast<double>(depth) > 4.0 * params_.range) depth = kInfinite;
      if (depth < kInfinite) {
        const Point2 p = origin_ + static_cast<double>(depth) * direction;
        const int room = scene_.regions().roomAt(p);
        const Surface& surface = down ? scene_.floor(room) : scene_.ceilingSurface(room);
        color = lit(textureAt(surface, static_cast<float>(p.x), static_cast<float>(p.y),
                              levelBlur(depth, down ? 0.0 : scene_.ceiling()), 0.0f),
                    scene_.light().at(p, sky_), down ? 1.0f : 0.7f);
      }
    }
    depth_.at<float>(v, u) = depth;
    owner_.at<std::int32_t>(v, u) = static_cast<std::int32_t>(owner);
    color_.at<cv::Vec3f>(v, u) = {color[2], color[1], color[0]};
  }

  static Color lit(const Color& albedo, const Color& light, float share) {
    Color out;
    for (std::size_t i = 0; i < 3; ++i) out[i] = share * albedo[i] * light[i];
    return out;
  }

  // What one pixel covers of a level plane, seen at a flat angle.
  float levelBlur(float depth, double z) const {
    const double drop = std::max(0.05, std::abs(params_.above_floor - z));
    const double d = static_cast<double>(depth);
    return static_cast<float>(d / focal_ * std::min(6.0, std::max(1.0, 0.5 * d / drop)));
  }

  Color sideColor(const Span& span, float depth, int v) const {
    const double z = params_.above_floor -
                     (v + 0.5 - 0.5 * params_.height) * static_cast<double>(depth) / focal_;
    const auto height = static_cast<float>(span.body->to - span.body->from);
    const auto up = static_cast<float>(z - span.body->from);
    switch (span.surface->material) {
      case Material::kWindow:
        return windowColor(span, up / height);
      case Material::kLamp:
        if (scene_.light().lampsShine(span.front, sky_)) return kLampShine;
        break;
      default:
        break;
    }
    const auto blur = static_cast<float>(static_cast<double>(depth) / focal_);
    return lit(textureAt(*span.surface, span.along, up, blur, height), span.light, 1.0f);
  }

  // Sky above, a dull ground below; a bar in the middle. Windows shine towards the point in front.
  Color windowColor(const Span& span, float up) const {
    const Point2 way = span.body->outline[3] - span.body->outline[0];
    const Color passed = sky_.through((1.0 / length(way)) * way);
    const double width = length(span.body->outline[1] - span.body->outline[0]);
    if (std::abs(static_cast<double>(span.along) - 0.5 * width) < 0.025) {
      return lit({0.8f, 0.8f, 0.78f}, span.light, 1.0f);
    }
    const float shine = up > 0.35f ? 1.6f : 0.5f;
    Color out;
    for (std::size_t i = 0; i < 3; ++i) out[i] = shine * passed[i] + 0.03f * span.light[i];
    return out;
  }

  Color levelColor(const Span& span, float depth, Point2 direction) const {
    const Point2 p = origin_ + static_cast<double>(depth) * direction;
    if (span.surface->material == Material::kLamp && scene_.light().lampsShine(p, sky_)) {
      return kLampShine;
    }
    const bool top = span.face == Span::Face::kTop;
    const Color albedo = textureAt(*span.surface, static_cast<float>(p.x), static_cast<float>(p.y),
                                   levelBlur(depth, top ? span.body->to : span.body->from), 0.0f);
    return lit(albedo, scene_.light().at(p, sky_), top ? 1.1f : 0.5f);
  }

  const CameraParams& params_;
  const Scene& scene_;
  Sky sky_;
  double focal_;
  Pose2 eye_;
  Point2 origin_, forward_, right_;
  cv::Mat color_, depth_, owner_;
  std::vector<float> nearest_;  // depth of each row of the current column
  std::vector<int> span_of_;
  std::vector<Span> spans_;
  std::vector<std::vector<const Body*>> columns_;
};

}  // namespace

void CameraParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  visit("width", width, Range::between(16, 4096), "pixel", "of a picture");
  visit("height", height, Range::between(16, 4096), "pixel", "of a picture");
  visit("view", view, Range::aboveUpTo(0.0, hyselam::radians(170.0)), "rad",
        "horizontal field of view");
  visit("above_floor", above_floor, Range::inside(0.0, 100.0), "m", "height of the camera");
  visit("range", range, Range::aboveUpTo(1.0, 1000.0), "m", "what is farther is not drawn");
  visit("depth_min", depth_min, Range::atLeast(0.0), "m", "nearer depths read 0");
  visit("depth_max", depth_max, Range::aboveUpTo(0.0, 65.0), "m", "farther depths read 0");
  visit("depth_sigma", depth_sigma, Range::between(0.0, 1.0), "m",
        "noise of a depth at 1 m; grows with its square");
  visit("noise", noise, Range::between(0.0, 1.0), "", "of a color at full gain, of 1");
  visit("exposure", exposure, Range::between(0.0, 1.0), "", "how far exposure follows the light");
  visit("white_balance", white_balance, Range::between(0.0, 1.0), "",
        "how far colors follow that of the light");
}

void CameraParams::validate() const {
  hyselam::checkParameters(*this);
  if (!(depth_max > depth_min)) {
    throw hyselam::ParameterError("depth_max", depth_max, "above depth_min, up to 65");
  }
}

double CameraParams::focalLength() const {
  return 0.5 * width / std::tan(0.5 * view);
}

CameraFrame takePicture(const CameraParams& params, const Scene& scene, const LightParams& light,
                        const std::vector<Person>& people, const Pose2& base, double time,
                        hyselam::Rng& rng) {
  params.validate();
  const std::vector<Body> doors = scene.doors(time),
                          persons = scene.people(people, time, {base.x, base.y});
  Painter painter(params, scene, light, base);
  painter.add(scene.bodies());
  painter.add(doors);
  painter.add(persons);
  painter.paint();
  const std::uint64_t seed = rng();
  return {develop(params, painter.color(), seed), measureDepth(params, painter.depth(), seed),
          painter.owner().clone()};
}

}  // namespace hyselam_sim
