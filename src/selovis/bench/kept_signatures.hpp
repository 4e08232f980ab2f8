// Signatures of a filmed drive in a file, so that a second run need not film again.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/pose2.hpp"

namespace selovis {
namespace bench {

struct KeptFrame {
  double stamp = 0.0;
  hyselam::Pose2 base;
  int place = -1;
  std::vector<float> signature;
};

inline std::string signatureFile(const std::string& folder) {
  return folder + "/signatures.bin";
}
inline bool holdsSignatures(const std::string& folder) {
  return std::filesystem::exists(signatureFile(folder));
}

/// Frames of this machine's numbers, one after the other; complete after close().
class SignatureFile {
 public:
  explicit SignatureFile(const std::string& folder)
      : folder_(folder), out_(signatureFile(folder) + ".part", std::ios::binary) {}
  void add(const KeptFrame& f) {
    const double head[4] = {f.stamp, f.base.x, f.base.y, f.base.theta};
    const std::int32_t place = f.place;
    out_.write(reinterpret_cast<const char*>(head), sizeof(head));
    out_.write(reinterpret_cast<const char*>(&place), sizeof(place));
    out_.write(reinterpret_cast<const char*>(f.signature.data()),
               static_cast<std::streamsize>(f.signature.size() * sizeof(float)));
  }
  void close() {
    out_.close();
    if (!out_) throw hyselam::InputError(folder_, "", "cannot be written");
    std::filesystem::rename(signatureFile(folder_) + ".part", signatureFile(folder_));
  }

 private:
  std::string folder_;
  std::ofstream out_;
};

inline void readSignatures(const std::string& folder, std::size_t size,
                           const std::function<void(const KeptFrame&)>& use) {
  std::ifstream in(signatureFile(folder), std::ios::binary);
  KeptFrame f;
  f.signature.resize(size);
  double head[4];
  std::int32_t place = 0;
  while (in.read(reinterpret_cast<char*>(head), sizeof(head))) {
    in.read(reinterpret_cast<char*>(&place), sizeof(place));
    in.read(reinterpret_cast<char*>(f.signature.data()),
            static_cast<std::streamsize>(size * sizeof(float)));
    if (!in) throw hyselam::InputError(signatureFile(folder), "", "ends within a frame");
    f.stamp = head[0];
    f.base = {head[1], head[2], head[3]};
    f.place = place;
    use(f);
  }
}

}  // namespace bench
}  // namespace selovis
