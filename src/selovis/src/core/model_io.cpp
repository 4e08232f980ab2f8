#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "binary.hpp"
#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/checksum.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/json_integer.hpp"
#include "selovis/model.hpp"

namespace selovis {
namespace {

using hyselam::InputError;
using hyselam::integerOf;
using nlohmann::json;

constexpr const char* kFormat = "selovis model 1";
constexpr const char* kManifest = "model.json";
constexpr std::size_t kMaxBytes = std::size_t{2} << 30;
constexpr int kMaxPlaces = 10000;

std::string pathIn(const std::string& directory, const std::string& name) {
  return (std::filesystem::path(directory) / name).string();
}

/// Writes bytes under a name with their checksum; returns what model.json says of them.
json saveData(const std::string& directory, const std::string& kind, const std::string& bytes) {
  const std::string crc = hyselam::crc32Text(bytes), name = kind + "-" + crc + ".bin";
  hyselam::writeFileAtomically(pathIn(directory, name), [&](std::ostream& out) {
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  });
  return {{"file", name}, {"bytes", bytes.size()}, {"crc32", crc}};
}

std::string loadData(const std::string& directory, const std::string& kind, const json& entry) {
  const auto name = entry.at("file").get<std::string>(), crc = entry.at("crc32").get<std::string>();
  const std::string manifest = pathIn(directory, kManifest);
  if (name != kind + "-" + crc + ".bin" || name.find('/') != std::string::npos) {
    throw InputError(manifest, kind, "'" + name + "' is no name of a data file");
  }
  const std::string path = pathIn(directory, name);
  std::string bytes = hyselam::readTextFile(path, kMaxBytes);
  if (bytes.size() != integerOf<std::size_t>(entry.at("bytes"))) {
    throw InputError(
        path, "byte " + std::to_string(bytes.size()),
        "must have " + entry.at("bytes").dump() + " bytes: it was cut short or changed");
  }
  if (hyselam::crc32Text(bytes) != crc) throw InputError(path, "", "its checksum is not " + crc);
  return bytes;
}

std::string samplesToBytes(const Model& model) {
  BinaryWriter out;
  out.value(static_cast<std::uint64_t>(model.samples.size));
  out.values(model.samples.values);
  out.values(model.samples.places);
  out.values(model.samples.frames);
  out.values(model.learnt);
  return out.bytes();
}

void samplesFromBytes(const std::string& bytes, Model& model) {
  BinaryReader in(bytes);
  Samples& s = model.samples;
  s.size = static_cast<std::size_t>(in.value<std::uint64_t>());
  s.values = in.values<float>();
  s.places = in.values<int>();
  s.frames = in.values<int>();
  model.learnt = in.values<float>();
  in.end();
  const int places = static_cast<int>(model.graph.places.size());
  const auto finite = [](const std::vector<float>& v) {
    return std::all_of(v.begin(), v.end(), [](float x) { return std::isfinite(x); });
  };
  if (s.size == 0 || s.frames.size() != s.count() || s.values.size() / s.size != s.count() ||
      s.values.size() % s.size != 0) {
    throw std::invalid_argument("has parts that do not fit each other");
  }
  if (!std::is_sorted(s.frames.begin(), s.frames.end())) {
    throw std::invalid_argument("has frames out of order");
  }
  if (!finite(s.values) || !finite(model.learnt)) {
    throw std::invalid_argument("has numbers that are none");
  }
  for (const int p : s.places) {
    if (p < 0 || p >= places)
      throw std::invalid_argument("has a signature of a place that is not listed");
  }
}

json parametersOf(const DescriptorParams& p) {
  return {{"lbp_radius", p.lbp.radius},    {"lbp_disc_mean", p.lbp.disc_mean},
          {"value_min", p.value_min},      {"saturation_min", p.saturation_min},
          {"near_range", p.near_range},    {"middle_range", p.middle_range},
          {"range_max", p.range_max},      {"heading_weight", p.heading_weight},
          {"range_weight", p.range_weight}};
}

DescriptorParams descriptorParams(const json& j) {
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
  validate(p);
  return p;
}

json parametersOf(const ClassifierParams& p) {
  return {{"kernel", nameOf(p.kernel)},
          {"power", p.power},
          {"cost", p.cost},
          {"gamma", p.gamma},
          {"beta", p.beta},
          {"neighbours", p.neighbours},
          {"seed", p.seed}};
}

ClassifierParams classifierParams(const json& j) {
  ClassifierParams p;
  p.kernel = kernelOf(j.at("kernel").get<std::string>());
  p.power = j.at("power").get<double>();
  p.cost = j.at("cost").get<double>();
  p.gamma = j.at("gamma").get<double>();
  p.beta = j.at("beta").get<double>();
  p.neighbours = integerOf<int>(j.at("neighbours"));
  p.seed = integerOf<unsigned>(j.at("seed"));
  validate(p);
  return p;
}

PlaceGraph graphOf(const json& j) {
  PlaceGraph graph;
  for (const auto& place : j.at("places")) {
    const auto name = place.get<std::string>();
    if (name.empty() || graph.find(name) >= 0 || graph.places.size() >= kMaxPlaces) {
      throw std::invalid_argument("places are empty, there twice or too many");
    }
    graph.places.push_back(name);
  }
  const int n = static_cast<int>(graph.places.size());
  for (const auto& pair : j.at("transitions")) {
    const int a = integerOf<int>(pair.at(0)), b = integerOf<int>(pair.at(1));
    if (a < 0 || b < 0 || a >= n || b >= n)
      throw std::invalid_argument("a transition joins no places");
    graph.transitions.emplace_back(a, b);
  }
  return graph;
}

}  // namespace

void saveModel(const Model& model, const std::string& directory) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (error) throw InputError(directory, "", "cannot be made: " + error.message());
  json j;
  j["format"] = kFormat;
  j["descriptor"] = model.descriptor;
  j["descriptor_parameters"] = parametersOf(model.descriptor_params);
  j["classifier"] = parametersOf(model.classifier);
  j["places"] = model.graph.places;
  j["transitions"] = model.graph.transitions;
  j["views"] = model.views;
  j["aperture"] = model.aperture;
  j["signature_size"] = model.samples.size;
  j["signatures"] = saveData(directory, "signatures", samplesToBytes(model));
  const auto& poses = model.samples.poses;
  if (std::any_of(poses.begin(), poses.end(), [](const auto& p) { return p.isFinite(); })) {
    BinaryWriter out;
    out.values(poses);
    j["poses"] = saveData(directory, "poses", out.bytes());
  }
  if (!model.state.empty()) j["svm"] = saveData(directory, "svm", model.state);
  hyselam::writeFileAtomically(pathIn(directory, kManifest),
                               [&](std::ostream& out) { out << j.dump(1) << '\n'; });
  // What belonged to an earlier model goes last.
  for (const auto& entry : std::filesystem::directory_iterator(directory, error)) {
    const std::string name = entry.path().filename().string();
    const bool data = entry.path().extension() == ".bin" &&
                      (name.compare(0, 11, "signatures-") == 0 ||
                       name.compare(0, 6, "poses-") == 0 || name.compare(0, 4, "svm-") == 0);
    const bool used = name == j["signatures"]["file"] ||
                      (j.count("poses") && name == j["poses"]["file"]) ||
                      (j.count("svm") && name == j["svm"]["file"]);
    if (data && !used) std::filesystem::remove(entry.path(), error);
  }
}

bool holdsModel(const std::string& directory) {
  std::error_code error;
  return !directory.empty() && std::filesystem::exists(pathIn(directory, kManifest), error);
}

Model loadModel(const std::string& directory) {
  const std::string manifest = pathIn(directory, kManifest);
  const std::string text = hyselam::readTextFile(manifest, std::size_t{16} << 20);
  Model model;
  std::string reading = manifest;
  try {
    const json j = json::parse(text);
    if (!j.is_object() || j.value("format", "") != kFormat) {
      throw InputError(manifest, "format", std::string("is not '") + kFormat + "'");
    }
    model.descriptor = j.at("descriptor").get<std::string>();
    model.descriptor_params = descriptorParams(j.at("descriptor_parameters"));
    model.classifier = classifierParams(j.at("classifier"));
    model.graph = graphOf(j);
    model.views = j.at("views").get<std::vector<double>>();
    const json& signatures = j.at("signatures");
    const std::string samples = loadData(directory, "signatures", signatures);
    reading = pathIn(directory, signatures.at("file").get<std::string>());
    samplesFromBytes(samples, model);
    reading = manifest;
    model.aperture = j.value("aperture", kAperture);
    if (!(model.aperture >= 0.01 && model.aperture <= 2.0 * hyselam::kPi)) {
      throw InputError(manifest, "aperture", "is not 0.01 to 2 pi");
    }
    model.samples.poses.assign(model.samples.count(), kNoPose);
    if (j.count("poses")) {
      const std::string poses = loadData(directory, "poses", j.at("poses"));
      reading = pathIn(directory, j.at("poses").at("file").get<std::string>());
      BinaryReader in(poses);
      model.samples.poses = in.values<hyselam::Pose2>();
      in.end();
      if (model.samples.poses.size() != model.samples.count()) {
        throw std::invalid_argument("has not one pose for each signature");
      }
      reading = manifest;
    }
    // Also tells a descriptor that this version does not know, and a dictionary that does not fit.
    const int size = model.makeDescriptor()->size();
    if (static_cast<std::size_t>(size) != model.samples.size) {
      throw InputError(manifest, "descriptor",
                       "'" + model.descriptor + "' gives " + std::to_string(size) +
                           " values, but the signatures have " +
                           std::to_string(model.samples.size));
    }
    if (model.classifier.kernel != Kernel::kExemplar) {
      model.state = loadData(directory, "svm", j.at("svm"));
      reading = pathIn(directory, j.at("svm").at("file").get<std::string>());
    }
    model.makeClassifier();
  } catch (const json::exception& e) {
    throw InputError(manifest, "", std::string("is no model: ") + e.what());
  } catch (const hyselam::ParameterError& e) {
    throw InputError(reading, "", e.what());
  } catch (const std::invalid_argument& e) {
    throw InputError(reading, "", e.what());
  }
  return model;
}

}  // namespace selovis
