#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/binary_io.hpp"
#include "hyselam_common/checksum.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/folder.hpp"
#include "hyselam_common/format_version.hpp"
#include "hyselam_common/json_integer.hpp"
#include "selovis/learning/error_source.hpp"
#include "selovis/learning/place_model.hpp"

namespace selovis {
namespace {

using hyselam::InputError;
using hyselam::integerOf;
using nlohmann::json;

constexpr const char* kFormat = "selovis model 2";
// Format 1 wrote the numbers in the byte order of the machine, without a header in the data files.
constexpr const char* kFormerFormat = "selovis model 1";
constexpr const char* kManifest = "model.json";
constexpr std::size_t kMaxBytes = std::size_t{2} << 30, kMaxManifestBytes = std::size_t{16} << 20;
constexpr std::size_t kMaxPlaces = 10000;

std::string pathIn(const std::string& directory, const std::string& name) {
  return (std::filesystem::path(directory) / name).string();
}

std::string headerOf(const std::string& kind) {
  return "selovis " + kind + " 2\n";
}

/// Writes bytes under a name with their checksum; returns what model.json says of them.
json saveData(const std::string& directory, const std::string& kind, const std::string& content) {
  const std::string bytes = headerOf(kind) + content;
  const std::string crc = hyselam::crc32Text(bytes), name = kind + "-" + crc + ".bin";
  hyselam::writeFileAtomically(pathIn(directory, name), [&](std::ostream& out) {
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  });
  return {{"file", name}, {"bytes", bytes.size()}, {"crc32", crc}};
}

/// A model directory that is being read.
class ModelDirectory {
 public:
  explicit ModelDirectory(const std::string& directory)
      : directory_(directory), manifest_(pathIn(directory, kManifest)) {}

  const std::string& manifest() const { return manifest_; }

  json readManifest() {
    const std::string text = hyselam::readTextFile(manifest_, kMaxManifestBytes);
    json j = json::parse(text);
    const std::string format = j.is_object() ? j.value("format", "") : "";
    if (format != kFormat && format != kFormerFormat) {
      throw InputError(manifest_, "format", hyselam::formatRefusal(format, kFormat, 1));
    }
    has_headers_ = format == kFormat;
    return j;
  }

  /// Checks a data file and hands its content to `parse`, whose errors get the file's name.
  template <typename F>
  void readData(const std::string& kind, const json& entry, F&& parse) const {
    const auto name = entry.at("file").get<std::string>(),
               crc = entry.at("crc32").get<std::string>();
    if (name != kind + "-" + crc + ".bin" || name.find('/') != std::string::npos) {
      throw InputError(manifest_, kind, "'" + name + "' is no name of a data file");
    }
    const std::string path = pathIn(directory_, name);
    std::string bytes = hyselam::readTextFile(path, kMaxBytes);
    const auto size =
        withSource(manifest_, [&] { return integerOf<std::size_t>(entry.at("bytes")); });
    if (bytes.size() != size) {
      throw InputError(path, "byte " + std::to_string(bytes.size()),
                       "must have " + std::to_string(size) + " bytes: it was cut short or changed");
    }
    if (hyselam::crc32Text(bytes) != crc) throw InputError(path, "", "its checksum is not " + crc);
    if (has_headers_) {
      const std::string header = headerOf(kind);
      if (bytes.compare(0, header.size(), header) != 0) {
        throw InputError(path, "byte 0",
                         "does not begin with '" + header.substr(0, header.size() - 1) + "'");
      }
      bytes.erase(0, header.size());
    }
    withSource(path, [&] { parse(bytes); });
  }

 private:
  std::string directory_, manifest_;
  bool has_headers_ = true;
};

std::string samplesToBytes(const PlaceModel& model) {
  std::ostringstream bytes;
  hyselam::BinaryWriter out(bytes);
  out.put(static_cast<std::uint64_t>(model.samples.size));
  out.putSized(model.samples.values);
  out.putSized(model.samples.places);
  out.putSized(model.samples.frames);
  out.putSized(model.dictionary);
  out.flush();
  return bytes.str();
}

void samplesFromBytes(const std::string& bytes, PlaceModel& model) {
  hyselam::BinaryReader in(bytes, "signatures");
  Samples& s = model.samples;
  s.size = static_cast<std::size_t>(in.get<std::uint64_t>());
  s.values = in.getSized<float>();
  s.places = in.getSized<int>();
  s.frames = in.getSized<int>();
  model.dictionary = in.getSized<float>();
  in.requireEnd();
  const auto require = [](bool good, const char* otherwise) {
    if (!good) throw InputError("signatures", "", otherwise);
  };
  const auto finite = [](const std::vector<float>& v) {
    return std::all_of(v.begin(), v.end(), [](float x) { return std::isfinite(x); });
  };
  require(s.size != 0 && s.frames.size() == s.count() && s.values.size() / s.size == s.count() &&
              s.values.size() % s.size == 0,
          "have parts that do not fit each other");
  require(std::is_sorted(s.frames.begin(), s.frames.end()), "have frames out of order");
  require(finite(s.values) && finite(model.dictionary), "have values that are not finite");
  const int places = static_cast<int>(model.transitions.places.size());
  for (const int p : s.places) {
    require(p >= 0 && p < places, "have one of a place that is not listed");
  }
}

std::string posesToBytes(const std::vector<hyselam::Pose2>& poses) {
  std::ostringstream bytes;
  hyselam::BinaryWriter out(bytes);
  out.put(static_cast<std::uint64_t>(poses.size()));
  for (const auto& p : poses) {
    out.put(p.x);
    out.put(p.y);
    out.put(p.theta);
  }
  out.flush();
  return bytes.str();
}

std::vector<hyselam::Pose2> posesFromBytes(const std::string& bytes, std::size_t count) {
  hyselam::BinaryReader in(bytes, "poses");
  if (in.get<std::uint64_t>() != count) {
    throw InputError("poses", "", "are not one for each signature");
  }
  std::vector<hyselam::Pose2> poses(count);
  for (auto& p : poses) {
    p.x = in.get<double>();
    p.y = in.get<double>();
    p.theta = in.get<double>();
  }
  in.requireEnd();
  return poses;
}

json toJson(const DescriptorParams& p) {
  return {{"lbp_radius", p.lbp.radius},    {"lbp_disc_mean", p.lbp.disc_mean},
          {"value_min", p.value_min},      {"saturation_min", p.saturation_min},
          {"near_range", p.near_range},    {"middle_range", p.middle_range},
          {"range_max", p.range_max},      {"heading_weight", p.heading_weight},
          {"range_weight", p.range_weight}};
}

DescriptorParams descriptorParamsOf(const json& j) {
  DescriptorParams p;
  p.lbp.radius = integerOf<int>(j.at("lbp_radius"));
  p.lbp.disc_mean = j.at("lbp_disc_mean").get<bool>();
  p.value_min = integerOf<int>(j.at("value_min"));
  p.saturation_min = integerOf<int>(j.at("saturation_min"));
  p.near_range = j.at("near_range").get<double>();
  p.middle_range = j.at("middle_range").get<double>();
  p.range_max = j.at("range_max").get<double>();
  p.heading_weight = j.at("heading_weight").get<double>();
  p.range_weight = j.at("range_weight").get<double>();
  p.validate();
  return p;
}

json toJson(const ClassifierParams& p) {
  return {{"kernel", toString(p.kernel)},
          {"power", p.power},
          {"cost", p.cost},
          {"gamma", p.gamma},
          {"beta", p.beta},
          {"neighbours", p.neighbors},
          {"seed", p.seed}};
}

ClassifierParams classifierParamsOf(const json& j) {
  ClassifierParams p;
  p.kernel = svmKernelFromString(j.at("kernel").get<std::string>());
  p.power = j.at("power").get<double>();
  p.cost = j.at("cost").get<double>();
  p.gamma = j.at("gamma").get<double>();
  p.beta = j.at("beta").get<double>();
  p.neighbors = integerOf<int>(j.at("neighbours"));
  p.seed = integerOf<unsigned>(j.at("seed"));
  p.validate();
  return p;
}

PlaceTransitions transitionsFromJson(const json& j) {
  PlaceTransitions transitions;
  for (const auto& place : j.at("places")) {
    const auto name = place.get<std::string>();
    if (name.empty() || transitions.indexOf(name) >= 0 || transitions.places.size() >= kMaxPlaces) {
      throw InputError("places", "", "are empty, there twice or too many");
    }
    transitions.places.push_back(name);
  }
  const int n = static_cast<int>(transitions.places.size());
  for (const auto& pair : j.at("transitions")) {
    const int a = integerOf<int>(pair.at(0)), b = integerOf<int>(pair.at(1));
    if (a < 0 || b < 0 || a >= n || b >= n) {
      throw InputError("transitions", "", "one joins no places");
    }
    transitions.pairs.emplace_back(a, b);
  }
  return transitions;
}

/// What the manifest says itself, without the data files.
PlaceModel modelFromManifest(const json& j) {
  PlaceModel model;
  model.descriptor = j.at("descriptor").get<std::string>();
  model.descriptor_params = descriptorParamsOf(j.at("descriptor_parameters"));
  model.classifier = classifierParamsOf(j.at("classifier"));
  model.transitions = transitionsFromJson(j);
  model.views = j.at("views").get<std::vector<double>>();
  model.horizontal_fov = j.value("aperture", kDefaultFov);
  if (!(model.horizontal_fov >= 0.01 && model.horizontal_fov <= 2.0 * hyselam::kPi)) {
    throw InputError("aperture", "", "is not 0.01 to 2 pi");
  }
  return model;
}

/// Refuses a descriptor that this version does not know, and a dictionary that does not fit.
void checkDescriptor(PlaceModel& model) {
  const auto descriptor = model.makeDescriptor();
  const int size = descriptor->size();
  if (static_cast<std::size_t>(size) != model.samples.size) {
    throw InputError("descriptor", "",
                     "'" + model.descriptor + "' gives " + std::to_string(size) +
                         " values, but the signatures have " + std::to_string(model.samples.size));
  }
  model.samples.parts = descriptor->parts();
}

/// Removes the data files of earlier models.
void removeOtherData(const std::string& directory, const json& manifest) {
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(directory, error)) {
    const std::string name = entry.path().filename().string();
    for (const std::string kind : {"signatures", "poses", "svm", "reliability"}) {
      const bool data =
          entry.path().extension() == ".bin" && name.compare(0, kind.size() + 1, kind + "-") == 0;
      const bool used = manifest.count(kind) && name == manifest[kind]["file"];
      if (data && !used) std::filesystem::remove(entry.path(), error);
    }
  }
}

/// With the memory, whose data file comes first; what the manifest does not name is removed last.
void writeManifest(const std::string& directory, json& manifest, const ReliabilityMemory& memory) {
  manifest.erase("reliability");
  if (memory.size() > 0) {
    manifest["reliability"] = saveData(directory, "reliability", memory.toBytes());
  }
  hyselam::writeFileAtomically(pathIn(directory, kManifest),
                               [&](std::ostream& out) { out << manifest.dump(1) << '\n'; });
  removeOtherData(directory, manifest);
}

}  // namespace

void savePlaceModel(const PlaceModel& model, const std::string& directory) {
  if (model.samples.count() == 0) throw InputError(directory, "", "nothing has been learned");
  if (model.classifier.kernel != SvmKernel::kExemplar && model.svm.empty()) {
    throw InputError(directory, "", "the model has signatures, but has not been trained with them");
  }
  hyselam::makeFolder(directory);
  json j;
  j["format"] = kFormat;
  j["descriptor"] = model.descriptor;
  j["descriptor_parameters"] = toJson(model.descriptor_params);
  j["classifier"] = toJson(model.classifier);
  j["places"] = model.transitions.places;
  j["transitions"] = model.transitions.pairs;
  j["views"] = model.views;
  j["aperture"] = model.horizontal_fov;
  j["signature_size"] = model.samples.size;
  j["signatures"] = saveData(directory, "signatures", samplesToBytes(model));
  const auto& poses = model.samples.poses;
  if (std::any_of(poses.begin(), poses.end(), [](const auto& p) { return p.isFinite(); })) {
    j["poses"] = saveData(directory, "poses", posesToBytes(poses));
  }
  const bool fusion = model.classifier.kernel == SvmKernel::kFusion;
  if (fusion) j["fusion"] = json::parse(model.svm);
  if (!fusion && !model.svm.empty()) j["svm"] = saveData(directory, "svm", model.svm);
  writeManifest(directory, j, model.reliability);
}

void saveReliability(const PlaceModel& model, const ReliabilityMemory& memory,
                     const std::string& directory) {
  ModelDirectory files(directory);
  try {
    json j = files.readManifest();
    const std::string crc = hyselam::crc32Text(headerOf("signatures") + samplesToBytes(model));
    if (j.at("signatures").at("crc32") != crc || j.at("places") != model.transitions.places) {
      throw InputError(files.manifest(), "",
                       "is of another model, or was written by an older version");
    }
    writeManifest(directory, j, memory);
  } catch (const json::exception& e) {
    throw InputError(files.manifest(), "", std::string("is no model: ") + e.what());
  }
}

bool holdsPlaceModel(const std::string& directory) {
  std::error_code error;
  return !directory.empty() && std::filesystem::exists(pathIn(directory, kManifest), error);
}

PlaceModel loadPlaceModel(const std::string& directory) {
  ModelDirectory files(directory);
  const std::string& manifest = files.manifest();
  try {
    const json j = files.readManifest();
    PlaceModel model = withSource(manifest, [&] { return modelFromManifest(j); });
    files.readData("signatures", j.at("signatures"),
                   [&](const std::string& bytes) { samplesFromBytes(bytes, model); });
    model.samples.poses.assign(model.samples.count(), kNoPose);
    if (j.count("poses")) {
      files.readData("poses", j.at("poses"), [&](const std::string& bytes) {
        model.samples.poses = posesFromBytes(bytes, model.samples.count());
      });
    }
    if (j.count("reliability")) {  // not of older versions, nor before the robot drove
      files.readData("reliability", j.at("reliability"), [&](const std::string& bytes) {
        model.reliability =
            ReliabilityMemory::fromBytes(bytes, static_cast<int>(model.transitions.places.size()));
      });
    }
    withSource(manifest, [&] { checkDescriptor(model); });
    if (comparesExemplars(model.classifier.kernel)) {
      if (model.classifier.kernel == SvmKernel::kFusion) model.svm = j.at("fusion").dump();
      withSource(manifest, [&] { model.makeClassifier(); });
    } else {
      files.readData("svm", j.at("svm"), [&](const std::string& bytes) {
        model.svm = bytes;
        model.makeClassifier();
      });
    }
    return model;
  } catch (const json::exception& e) {
    throw InputError(manifest, "", std::string("is no model: ") + e.what());
  }
}

}  // namespace selovis
