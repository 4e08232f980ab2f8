// train_tours: learns the reader of tours of a language from tours with marked rooms.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <iomanip>
#include <iostream>
#include <sstream>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/checksum.hpp"
#include "hyselam_common/tool.hpp"
#include "tour_training.hpp"

namespace {

using namespace hyselam_topo;            // NOLINT: a program, not a header
using namespace hyselam_topo::language;  // NOLINT

struct Options {
  std::vector<std::string> files, test_files;
  std::string language = "en", reader, out;
  bool show = false;
  TourTrainingParams params;
};

std::string percent(std::size_t part, std::size_t of) {
  std::ostringstream out;
  out << std::fixed << std::setprecision(1)
      << (of == 0 ? 0.0 : 100.0 * static_cast<double>(part) / static_cast<double>(of)) << " %";
  return out.str();
}

std::string summaryOf(const TourScore& score) {
  return std::to_string(score.tours) + " tours, rooms named " + percent(score.named, score.rooms) +
         " of " + std::to_string(score.rooms) + ", others " + std::to_string(score.others) +
         ", sides right " + percent(score.sides_right, score.named) + ", order right " +
         percent(score.pairs_right, score.pairs) + " of " + std::to_string(score.pairs) + " pairs";
}

void printTold(const std::string& what, const std::vector<std::pair<double, bool>>& all) {
  constexpr std::array<double, 7> kFrom{{0.0, 0.6, 0.8, 0.9, 0.95, 0.98, 0.99}};
  std::cout << "  " << what << ", told as at least: right of number\n";
  for (std::size_t bin = 0; bin < kFrom.size(); ++bin) {
    std::size_t count = 0, right = 0;
    for (const auto& [certainty, is_right] : all) {
      if (certainty < kFrom[bin] || (bin + 1 < kFrom.size() && certainty >= kFrom[bin + 1]))
        continue;
      ++count;
      right += is_right ? 1 : 0;
    }
    std::cout << "    " << kFrom[bin] << ": " << percent(right, count) << " of " << count << '\n';
  }
}

void print(const std::string& what, const TourScore& score) {
  std::cout << what << ": " << summaryOf(score) << '\n';
  printTold("sides", score.sides);
  printTold("order of neighbours", score.orders);
  printTold("names on doors", score.named_doors);
  std::cout << "  doors with their right names, at once and after each of eight questions:";
  for (const std::size_t right : score.right_after) std::cout << ' ' << percent(right, score.doors);
  std::cout << '\n';
}

std::vector<AnnotatedTour> loadAll(const std::vector<std::string>& files) {
  std::vector<AnnotatedTour> all;
  for (const std::string& file : files) {
    for (AnnotatedTour& each : loadTours(file)) all.push_back(std::move(each));
  }
  return all;
}

std::vector<const AnnotatedTour*> pointersTo(const std::vector<AnnotatedTour>& tours) {
  std::vector<const AnnotatedTour*> all;
  for (const AnnotatedTour& each : tours) all.push_back(&each);
  return all;
}

ModelOrigin originOf(const Options& o, std::size_t tours, const std::string& left_out) {
  std::ostringstream command;
  command << "train_tours FILE... --language " << o.language << " --cost " << o.params.cost
          << " --least-seen " << o.params.least_seen << " --folds " << o.params.folds
          << " (bench/tours --retrain)";
  std::string contents;
  for (const std::string& file : o.files) contents += hyselam::readTextFile(file);
  return {o.language, command.str(),
          std::to_string(tours) + " tours of " + std::to_string(o.files.size()) +
              " files (CRC-32 " + hyselam::crc32Text(contents) + ")",
          left_out};
}

nlohmann::json jsonOf(const TourScore& score) {
  return {{"tours", score.tours},
          {"rooms", score.rooms},
          {"named", score.named},
          {"others", score.others},
          {"sides_right", score.sides_right},
          {"pairs", score.pairs},
          {"pairs_right", score.pairs_right}};
}

nlohmann::json run(const Options& o) {
  const std::vector<AnnotatedTour> all = loadAll(o.files), test = loadAll(o.test_files);
  const Grammar grammar = Grammar::shipped(o.language);
  const ReaderModel reader = ReaderModel::fromText(o.reader, hyselam::readTextFile(o.reader));
  nlohmann::json json;
  const TourScore left_out = evaluateTours(grammar, reader, pointersTo(all), o.params);
  print("kinds of buildings left out, before the calibration", left_out);
  json["left_out"] = jsonOf(left_out);
  TourModel model = trainTours(grammar, reader, pointersTo(all), o.params);
  calibrate(left_out, &model);
  model.origin = originOf(o, all.size(), summaryOf(left_out));
  if (!test.empty()) {
    const TourReader tours(grammar, {o.reader, reader.toText()}, {"model", model.toText()});
    TourScore score;
    for (const AnnotatedTour& each : test) {
      const TourScore one = scoreOf(tours, each);
      if (o.show) std::cout << each.id << ": " << summaryOf(one) << '\n' << one.words;
      score.add(one);
    }
    print("tours to test with", score);
    json["test"] = jsonOf(score);
  }
  if (!o.out.empty())
    hyselam::writeFileAtomically(o.out, [&](std::ostream& out) { out << model.toText(); });
  return json;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Learns the reader of tours of a language from tours with marked rooms, and tells how it "
      "fares on kinds of buildings left out.");
  Options o;
  app.add_option("files", o.files, "tours with marked rooms")->required();
  app.add_option("--language", o.language, "of the tours")->capture_default_str();
  app.add_option("--reader", o.reader, "model of the second reader of that language")->required();
  app.add_option("--test", o.test_files, "tours that are not learnt from, to score");
  app.add_flag("--show", o.show, "print a line for each of these");
  app.add_option("--out", o.out, "model to write");
  app.add_option("--cost", o.params.cost, "C of the regressions: smaller gives fewer weights")
      ->capture_default_str();
  app.add_option("--least-seen", o.params.least_seen, "features of fewer examples are left out")
      ->capture_default_str();
  app.add_option("--folds", o.params.folds, "parts of the kinds of buildings, each left out once")
      ->capture_default_str();
  app.add_option("--weight-own-side", o.params.weights.own_side,
                 "of what is said of the side of a room with a word of its own for it")
      ->capture_default_str();
  app.add_option("--weight-side", o.params.weights.side, "of what is said of another room's side")
      ->capture_default_str();
  app.add_option("--weight-far-pair", o.params.weights.far_pair, "of two rooms with one between")
      ->capture_default_str();
  app.add_option("--weight-pair", o.params.weights.pair, "of what is said of two rooms")
      ->capture_default_str();
  app.add_option("--weight-position", o.params.weights.position, "of its place in a row")
      ->capture_default_str();
  app.add_option("--weight-name", o.params.weights.name, "nats for each word of a name")
      ->capture_default_str();
  return hyselam::runTool(argc, argv, app, [&] { return run(o); });
}
