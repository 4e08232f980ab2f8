// train_signatures: learns the signatures of places from recorded runs and simulated buildings.
#include <iostream>

#include "hyselam_common/checksum.hpp"
#include "hyselam_common/folder.hpp"
#include "hyselam_common/numbers.hpp"
#include "hyselam_common/rng.hpp"
#include "hyselam_common/tool.hpp"
#include "hyselam_sim/generate_corridors.hpp"
#include "hyselam_sim/simulation.hpp"
#include "place_logs.hpp"

namespace {

using namespace ngram_slam;  // NOLINT: a program, not a header

struct Options {
  PlaceLogOptions logs;
  SignatureTrainingParams training;
  int buildings = 0;
  std::uint64_t seed = 1;
  std::string out, out_without_each;
};

PlaceLog drive(const Options& o, int number) {
  const std::uint64_t seed = hyselam::mix(o.seed, static_cast<std::uint64_t>(number));
  const auto building = hyselam_sim::generateCorridors(seed);
  const auto log = hyselam_sim::simulate(building.plan, building.route, seed).log;
  return placesOf("building " + std::to_string(number), log, log.ground_truth, {});
}

nlohmann::json train(const Options& o) {
  if (o.buildings < 0 || o.buildings > 10000) {
    throw hyselam::ParameterError("--buildings", o.buildings, "0 to 10000");
  }
  if (!o.out_without_each.empty() && o.logs.logs.size() < 2) {
    throw hyselam::ParameterError("--out-without-each", o.logs.logs.size(), "two logs or more");
  }
  if (!o.out_without_each.empty()) {
    hyselam::makeFolder(o.out_without_each);
  }
  std::vector<std::vector<SignatureExample>> ways;
  SignatureOrigin origin;
  std::size_t places = 0;
  std::uint32_t sum = 0;
  std::string names;
  const auto take = [&](const PlaceLog& log) {
    ways.push_back(examplesOf(log));
    places += ways.back().size();
    for (const SignatureExample& e : ways.back()) {
      sum = hyselam::crc32Of(
          {reinterpret_cast<const char*>(e.features.data()), e.features.size() * sizeof(float)},
          sum);
    }
  };
  for (const PlaceLog& log : o.logs.read()) {
    take(log);
    names += log.name + ", ";
  }
  for (int i = 0; i < o.buildings; ++i) take(drive(o, i));
  char sum_text[16];
  std::snprintf(sum_text, sizeof(sum_text), "%08x", sum);
  origin.command = "train_signatures LOG... --reference FILE... --buildings " +
                   std::to_string(o.buildings) + " --seed " + std::to_string(o.seed) + " --ridge " +
                   hyselam::formatNumber(o.training.ridge);
  origin.data = std::to_string(places) + " places: " + names +
                "simulated buildings: " + std::to_string(o.buildings) + "; crc32 " + sum_text;
  origin.in_sample = "see out of sample";
  origin.out_of_sample = "evaluate_places --leave-one-out, docs/algorithms/signatures.md";
  const SignatureModel model = trainSignatures(ways, o.training, origin);
  if (!o.out.empty()) model.save(o.out);
  for (std::size_t i = 0; !o.out_without_each.empty() && i < o.logs.logs.size(); ++i) {
    auto others = ways;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    const std::string left_out = nameOfLog(o.logs.logs[i]);
    SignatureOrigin other = origin;
    other.command += " --out-without-each DIR";
    other.data += "; without " + left_out;
    trainSignatures(others, o.training, other)
        .save(o.out_without_each + "/without-" + left_out + ".txt");
  }
  nlohmann::json j = {{"places", places}, {"ways", ways.size()}, {"features_crc32", sum_text}};
  std::cout << j.dump(2) << "\n";
  return j;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Learns the signatures of places from recorded runs on which places were visited again and "
      "from simulated corridors. The same input gives the same bytes.",
      "train_signatures");
  Options o;
  o.logs.addTo(app);
  app.add_option("--out", o.out, "file for the model");
  app.add_option(
      "--out-without-each", o.out_without_each,
      "folder, made if it is not there, for a model for each log, without-LOG.txt, learnt from "
      "all but it");
  app.add_option("--buildings", o.buildings, "simulated ones to learn from as well");
  app.add_option("--seed", o.seed, "of the buildings and of all noise");
  app.add_option("--ridge", o.training.ridge, "part of each variance between visits added to it");
  return hyselam::runTool(argc, argv, app, [&] { return train(o); });
}
