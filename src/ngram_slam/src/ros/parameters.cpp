#include "ngram_slam/ros/parameters.hpp"

#include <sys/stat.h>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/ros/rate_limit.hpp"

namespace ngram_slam {

using hyselam::ParameterError;
using hyselam::ParamLoader;
using hyselam::Range;

namespace {

void loadMinN(ParamLoader& loader, NgramRecognizerParams& p) {
  const std::vector<int>& known = p.matcher.min_n;
  const int step = known.back() > known.front() ? 3 : 0;
  std::vector<double> least;
  for (std::size_t l = 0; l < static_cast<std::size_t>(p.levels); ++l)
    least.push_back(l < known.size() ? known[l] : least.back() + step);
  loader.get("min_n", least, Range::between(1, 65535), static_cast<std::size_t>(p.levels),
             "least words of a match, one number per level");
  if (least.size() != static_cast<std::size_t>(p.levels))
    throw ParameterError("min_n", std::to_string(least.size()) + " numbers",
                         "one per level, " + std::to_string(p.levels));
  p.matcher.min_n.clear();
  for (double n : least) {
    if (n != static_cast<int>(n)) throw ParameterError("min_n", n, "whole numbers");
    p.matcher.min_n.push_back(static_cast<int>(n));
  }
}

void loadRecogniser(ParamLoader& loader, NgramRecognizerParams& p) {
  loader.get("levels", p.levels, Range::between(1, WordLattice::kMaxLevels), "levels of words");
  loadMinN(loader, p);
  loader.get("size_tolerance", p.matcher.tolerance.size, {0.0, 1.0, true, true}, "epsilon_s");
  loader.get("angle_tolerance", p.matcher.tolerance.angle, {0.0, hyselam::kPi, true, true},
             "[rad] epsilon_a");
  loader.get("max_followed", p.matcher.max_followed, Range::between(1, 1e9),
             "old places followed at a time; of more, the newest");
  loader.get("min_region", p.min_region, Range::between(1, 10000),
             "[observations] t_o, least length of a region");
  loader.get("uniform_classes", p.uniform_classes, Range::between(1, WordLattice::kMaxClasses),
             "density classes of equal width");
  loader.get("learn_classes", p.learn_classes, "density classes by mean shift instead");
  loader.get("class_hysteresis", p.class_hysteresis, {0.0, 0.5, false, true},
             "a class is kept while the density lies within this of its bounds");
  loader.getEnum<WordDensity>("word_density", p.word_density,
                              {{"soft", WordDensity::kSoft}, {"full", WordDensity::kFull}},
                              "density that words are made of");
  loader.get("reverse", p.reverse, "also look for places that were travelled the other way");
  loader.get("max_chance", p.max_chance, Range::atLeast(0.0),
             "matches with fewer expected by chance are told whatever their length; 0: off");
  loader.get("with_probability", p.with_probability, "tell how probable a match is right");
  loader.get("min_probability", p.min_probability, Range::between(0.0, 1.0),
             "of a match, to be told");
  p.validate();
}

void loadCorpus(ParamLoader& loader, WordsServerParams& p) {
  loader.get("corpus", p.corpus, "file loaded at the start and saved; empty: none");
  struct stat info {};
  const auto slash = p.corpus.rfind('/');
  const std::string folder = slash == std::string::npos ? "." : p.corpus.substr(0, slash + 1);
  if (!p.corpus.empty() && (::stat(folder.c_str(), &info) != 0 || !S_ISDIR(info.st_mode)))
    throw ParameterError("corpus", p.corpus, "a file in an existing folder");
  loader.get("save_period", p.save_period, Range::between(0.0, 1e6),
             "[s] of wall time between savings; 0: only at the end and when asked");
}

}  // namespace

WordsServerParams loadWordsParams(ParamLoader& loader) {
  WordsServerParams p;
  std::string preset = "thesis";
  loader.get("preset", preset, {"thesis", "improved"},
             "defaults of what is recognised; improved needs input scan");
  if (preset == "improved") p.recognizer = NgramRecognizerParams::improved();
  std::string input = "fsd_observation";
  loader.get("input", input, {"fsd_observation", "scan"}, "topic that observations are made from");
  p.from_scan = input == "scan";
  if (preset == "improved" && !p.from_scan)
    throw ParameterError("preset", "'improved'", "'thesis' unless input is scan");
  hyselam::loadScanInputParams(loader, p.input);
  loader.get("bandwidth", p.sensor.bandwidth, Range::between(0.2, 50.0),
             "[m] radius of the uniform kernel");
  loader.get("step", p.sensor.step, Range::between(0.01, 10.0), "[m] of way between observations");
  loader.get("resolution", p.sensor.resolution, Range::between(0.01, 1.0),
             "[m/cell] of the local map; with input scan");
  loader.get("usable_range", p.sensor.usable_range, Range::atLeast(0.0),
             "[m] beams say nothing beyond it; 0: all that fits the local map; with input scan");
  if (preset == "improved") p.sensor.look_back = p.sensor.bandwidth + 0.5;
  loader.get("look_back", p.sensor.look_back, Range::between(0.0, 20.0),
             "[m] driven before a second look at a spot, for word_density full; with input scan");
  if (!p.from_scan && p.sensor.look_back > 0.0)
    throw ParameterError("look_back", p.sensor.look_back, "0 unless input is scan");
  p.sensor.validate();
  loadRecogniser(loader, p.recognizer);
  loader.get("semantics", p.semantics, "tell regions of meaning");
  p.semantic.validate();
  loadCorpus(loader, p);
  hyselam::loadRate(loader, "gui_publish_rate", p.gui_publish_rate,
                    "[Hz] of word_markers; -1: no limit");
  loader.get("shown_words", p.shown_words, Range::between(1, 100000),
             "in word_markers, the newest");
  loader.get("diagnostic_period", p.diagnostic_period, Range::between(0.05, 60.0), "[s]");
  return p;
}

}  // namespace ngram_slam
