#include "texture.hpp"

#include <algorithm>
#include <cmath>

namespace hyselam_sim {
namespace {

std::uint32_t hash(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  std::uint32_t h =
      a * 0x9e3779b1u ^ (b + 0x7f4a7c15u) * 0x85ebca6bu ^ (c + 0x165667b1u) * 0xc2b2ae35u;
  h ^= h >> 15;
  h *= 0x2c1b3c6du;
  h ^= h >> 12;
  h *= 0x297a2d39u;
  return h ^ (h >> 15);
}

float unit(std::uint32_t h) {
  return static_cast<float>(h >> 8) * (1.0f / 16777216.0f);
}

std::uint32_t cellOf(float v) {
  return static_cast<std::uint32_t>(static_cast<std::int32_t>(std::floor(v)));
}

// How much of a detail of that size is left after the blur.
float shown(float size, float blur) {
  return std::clamp(1.5f - blur / size, 0.0f, 1.0f);
}

float patch(std::uint32_t seed, float s, float t, float size) {
  return unit(hash(seed, cellOf(s / size), cellOf(t / size)));
}

// Patches, smoothly joined.
float clouds(std::uint32_t seed, float s, float t, float size) {
  const float x = s / size, y = t / size;
  const float fx = x - std::floor(x), fy = y - std::floor(y);
  const std::uint32_t cx = cellOf(x), cy = cellOf(y);
  const float a = unit(hash(seed, cx, cy)), b = unit(hash(seed, cx + 1, cy));
  const float c = unit(hash(seed, cx, cy + 1)), d = unit(hash(seed, cx + 1, cy + 1));
  return (a * (1 - fx) + b * fx) * (1 - fy) + (c * (1 - fx) + d * fx) * fy;
}

Color scaled(const Color& color, float by) {
  return {color[0] * by, color[1] * by, color[2] * by};
}

Color blend(const Color& a, const Color& b, float share) {
  Color out;
  for (std::size_t i = 0; i < 3; ++i) out[i] = a[i] + share * (b[i] - a[i]);
  return out;
}

Color vivid(std::uint32_t h) {
  const float hue = 6.0f * unit(h), strong = 0.35f + 0.6f * unit(hash(h, 1, 2));
  const float light = 0.12f + 0.6f * unit(hash(h, 3, 4));
  const auto channel = [&](float at) {
    const float d = std::abs(std::fmod(hue - at + 9.0f, 6.0f) - 3.0f);
    return light * (1.0f - strong * std::clamp(2.0f - (3.0f - d), 0.0f, 1.0f));
  };
  return {channel(0.0f), channel(2.0f), channel(4.0f)};
}

// 1 within a joint of that width at the lattice of that spacing.
float joint(float v, float spacing, float width, float blur) {
  const float d = std::abs(v / spacing - std::round(v / spacing)) * spacing;
  const float soft = std::max(blur, 1e-4f);
  return std::clamp((0.5f * width + 0.5f * soft - d) / soft, 0.0f, 1.0f) *
         std::min(1.0f, width / soft);
}

}  // namespace

Color textureAt(const Surface& surface, float s, float t, float blur, float height) {
  const std::uint32_t seed = surface.seed;
  const Color& base = surface.color;
  switch (surface.material) {
    case Material::kPaint: {
      const float dirt = 1.0f + 0.06f * (clouds(seed, s, t, 0.7f) - 0.5f);
      if (height > 1.5f && t < 0.09f) return scaled(base, 0.35f);  // skirting board
      return scaled(base, dirt);
    }
    case Material::kBrick: {
      const float row = std::floor(t / 0.075f);
      const float shift = std::fmod(std::abs(row), 2.0f) * 0.125f;
      const float tone = patch(seed, s + shift, t, 0.0f + 0.25f) * 0.5f +
                         unit(hash(seed, cellOf((s + shift) / 0.25f), cellOf(t / 0.075f))) * 0.5f;
      const float gap =
          std::max(joint(t, 0.075f, 0.01f, blur), joint(s + shift, 0.25f, 0.01f, blur));
      return blend(scaled(base, 1.0f + 0.5f * shown(0.1f, blur) * (tone - 0.5f)),
                   {0.5f, 0.48f, 0.45f}, 0.8f * gap);
    }
    case Material::kTiles: {
      const float size = 0.3f + 0.05f * static_cast<float>(seed % 5u);
      const float gap = std::max(joint(s, size, 0.012f, blur), joint(t, size, 0.012f, blur));
      const float tone = 1.0f + 0.14f * shown(size, blur) * (patch(seed, s, t, size) - 0.5f);
      return blend(scaled(base, tone), scaled(base, 0.45f), gap);
    }
    case Material::kWood: {
      const float board = unit(hash(seed, cellOf(t / 0.14f), 7u));
      const float grain = clouds(seed, s * 0.35f + 31.0f * board, t * 9.0f, 0.25f);
      const float tone = 1.0f + 0.25f * shown(0.14f, blur) * (board - 0.5f) +
                         0.3f * shown(0.03f, blur) * (grain - 0.5f);
      return blend(scaled(base, tone), scaled(base, 0.4f), 0.7f * joint(t, 0.14f, 0.004f, blur));
    }
    case Material::kCarpet: {
      const float speckle = patch(seed, s, t, 0.02f) - 0.5f;
      const float wear = clouds(seed, s, t, 0.9f) - 0.5f;
      return scaled(base, 1.0f + 0.5f * shown(0.02f, blur) * speckle + 0.12f * wear);
    }
    case Material::kCupboard: {
      const float gap = std::max(joint(s, 0.5f, 0.012f, blur), joint(t, 0.95f, 0.012f, blur));
      const float in_door = s / 0.5f - std::floor(s / 0.5f);
      const bool handle = in_door > 0.8f && in_door < 0.87f && std::abs(t - 0.55f * height) < 0.09f;
      return handle ? Color{0.12f, 0.12f, 0.13f} : blend(base, scaled(base, 0.35f), gap);
    }
    case Material::kShelf: {
      const float board = 0.34f;
      if (joint(t, board, 0.03f, blur) > 0.5f) return base;
      const float level = std::floor(t / board);
      const float width = 0.03f + 0.05f * unit(hash(seed, cellOf(s / 0.4f), cellOf(level)));
      const std::uint32_t back = hash(seed, cellOf(s / width), cellOf(level + 50.0f));
      const float tall = board * (0.55f + 0.35f * unit(hash(back, 5u, 6u)));
      if (t - level * board > tall) return scaled(base, 0.18f);
      return blend(scaled(base, 0.4f), vivid(back), 0.4f + 0.6f * shown(width, blur));
    }
    case Material::kPoster: {
      const float size = 0.12f + 0.04f * static_cast<float>(seed % 4u);
      const Color ground = vivid(hash(seed, 11u, 12u));
      const std::uint32_t spot = hash(seed, cellOf(s / size), cellOf(t / size));
      if (t < 0.03f || t > height - 0.03f) return {0.85f, 0.85f, 0.83f};
      return unit(spot) < 0.55f ? vivid(spot) : ground;
    }
    case Material::kWindow:
    case Material::kLamp:
    case Material::kPlain:
      break;
  }
  return base;
}

}  // namespace hyselam_sim
