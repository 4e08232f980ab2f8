#include "fsd_localization/density/fsd_map.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"

namespace fsd_localization {

using hyselam::OccupancyGrid;

namespace {

constexpr char kMagic[8] = {'F', 'S', 'D', 'M', 'A', 'P', '0', '1'};

class Fnv1a {
 public:
  void add(const void* data, std::size_t size) {
    const auto* p = static_cast<const unsigned char*>(data);
    for (std::size_t i = 0; i < size; ++i) hash_ = (hash_ ^ p[i]) * 0x100000001b3ULL;
  }
  void add(double v) { add(&v, sizeof v); }
  std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325ULL;
};

}  // namespace

void FsdMapParams::describe(hyselam::ParameterVisitor& visit) {
  using hyselam::Range;
  describeKernels(visit, kernels);
  visit.group("gradient_", gradient);
  visit("map_free_below", thresholds.free_below, Range::between(1, 100), "",
        "a cell of the map is free for 0 <= value < this");
  visit("map_occupied_from", thresholds.occupied_from, Range::between(1, 100), "",
        "occupied from this value on, unknown between");
}

void FsdMapParams::validate() const {
  checkKernels(kernels);
  hyselam::checkParameters(*this);
  if (thresholds.occupied_from < thresholds.free_below) {
    throw hyselam::ParameterError("map_occupied_from", thresholds.occupied_from,
                                  ">= map_free_below");
  }
}

void FsdMap::allocate(const OccupancyGrid& map, const FsdMapParams& params) {
  params.validate();
  geometry_ = map.geometry;
  params_ = params;
  stride_ = kernelCount() <= 4 ? 8 : 16;
  cells_.assign(geometry_.cellCount() * static_cast<std::size_t>(stride_), 0);
}

FsdMap::FsdMap(const OccupancyGrid& map, const FsdMapParams& params, int threads,
               const std::function<void(double)>& progress) {
  allocate(map, params);
  const FreeSpaceGrid space = freeSpaceOf(map, params.thresholds);
  const int w = geometry_.width, h = geometry_.height;
  // A frame of two zero cells lets the gradient be taken at the rim without a question.
  const int padded_width = w + 4;
  std::vector<float> padded;
  for (int k = 0; k < kernelCount(); ++k) {
    const Kernel kernel(params.kernels[static_cast<std::size_t>(k)], geometry_.resolution);
    const DensityField field = densityField(space, kernel, threads, [&](double share) {
      if (progress) progress((k + share) / kernelCount());
    });
    padded.assign(static_cast<std::size_t>(padded_width) * static_cast<std::size_t>(h + 4), 0.0F);
    for (int y = 0; y < h; ++y) {
      std::copy_n(
          &field.values[static_cast<std::size_t>(y) * static_cast<std::size_t>(w)], w,
          &padded[static_cast<std::size_t>(y + 2) * static_cast<std::size_t>(padded_width) + 2]);
    }
    for (int y = 0; y < h; ++y) {
      for (int x = 0; x < w; ++x) {
        std::uint8_t* out = &cells_[geometry_.index({x, y}) * static_cast<std::size_t>(stride_) +
                                    static_cast<std::size_t>(2 * k)];
        if (!space.free.get(x, y)) {
          out[0] = kNotFree;
          continue;
        }
        const float d = std::min(1.0F, field.at(x, y));
        out[0] = static_cast<std::uint8_t>(std::lround(d * kMaxDensity));
        const float* patch =
            &padded[static_cast<std::size_t>(y) * static_cast<std::size_t>(padded_width) +
                    static_cast<std::size_t>(x)];
        if (const auto a =
                stableDescent(patch, padded_width, geometry_.resolution, params.gradient)) {
          out[1] = static_cast<std::uint8_t>(kStable | directionByte(*a));
        }
      }
    }
  }
  listFreeCells();
}

void FsdMap::listFreeCells() {
  free_cells_.clear();
  for (std::size_t i = 0; i < geometry_.cellCount(); ++i) {
    if (cells_[i * static_cast<std::size_t>(stride_)] != kNotFree) {
      free_cells_.push_back(static_cast<std::uint32_t>(i));
    }
  }
}

std::optional<double> FsdMap::descent(hyselam::Cell c, int kernel) const {
  const std::uint8_t byte = cell(c)[2 * kernel + 1];
  if ((byte & kStable) == 0) return std::nullopt;
  return hyselam::normalizeAngle((byte & 0x7F) * (2.0 * hyselam::kPi / 128.0));
}

std::uint64_t FsdMap::fingerprint(const OccupancyGrid& map, const FsdMapParams& params) {
  Fnv1a hash;
  hash.add(map.cells.data(), map.cells.size());
  const auto& g = map.geometry;
  for (double v : {static_cast<double>(g.width), static_cast<double>(g.height), g.resolution,
                   g.origin.x, g.origin.y, g.origin.theta}) {
    hash.add(v);
  }
  for (const KernelSpec& k : params.kernels) {
    hash.add(static_cast<double>(static_cast<int>(k.profile)));
    hash.add(k.bandwidth);
  }
  hash.add(static_cast<double>(params.thresholds.free_below));
  hash.add(static_cast<double>(params.thresholds.occupied_from));
  hash.add(params.gradient.max_direction_spread);
  hash.add(params.gradient.min_slope);
  return hash.value();
}

bool FsdMap::readCells(const std::string& cache_path, std::uint64_t key) {
  std::ifstream in{cache_path, std::ios::binary};
  if (!in) return false;
  char magic[sizeof kMagic];
  std::uint64_t stored_key = 0, checksum = 0;
  in.read(magic, sizeof magic);
  in.read(reinterpret_cast<char*>(&stored_key), sizeof stored_key);
  in.read(reinterpret_cast<char*>(&checksum), sizeof checksum);
  if (!in || std::memcmp(magic, kMagic, sizeof magic) != 0 || stored_key != key) return false;
  in.read(reinterpret_cast<char*>(cells_.data()), static_cast<std::streamsize>(cells_.size()));
  Fnv1a sum;
  sum.add(cells_.data(), cells_.size());
  return in && in.peek() == std::ifstream::traits_type::eof() && sum.value() == checksum;
}

void FsdMap::writeCells(const std::string& cache_path, std::uint64_t key) const {
  hyselam::writeFileAtomically(cache_path, [&](std::ostream& out) {
    Fnv1a sum;
    sum.add(cells_.data(), cells_.size());
    const std::uint64_t checksum = sum.value();
    out.write(kMagic, sizeof kMagic);
    out.write(reinterpret_cast<const char*>(&key), sizeof key);
    out.write(reinterpret_cast<const char*>(&checksum), sizeof checksum);
    out.write(reinterpret_cast<const char*>(cells_.data()),
              static_cast<std::streamsize>(cells_.size()));
  });
}

FsdMap FsdMap::cached(const std::string& cache_path, const OccupancyGrid& map,
                      const FsdMapParams& params, int threads,
                      const std::function<void(double)>& progress, bool* from_cache,
                      std::string* problem) {
  const std::uint64_t key = fingerprint(map, params);
  if (problem != nullptr) problem->clear();
  FsdMap result;
  result.allocate(map, params);
  const bool found = result.readCells(cache_path, key);
  if (from_cache != nullptr) *from_cache = found;
  if (found) {
    result.listFreeCells();
    return result;
  }
  result = FsdMap(map, params, threads, progress);
  try {
    result.writeCells(cache_path, key);
  } catch (const hyselam::InputError& e) {
    // A map on a read-only disk is common; the fields are here, only the next start is slower.
    if (problem != nullptr) *problem = e.what();
  }
  return result;
}

}  // namespace fsd_localization
