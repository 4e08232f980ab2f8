// train_segmentation FOLDER ... --model FILE: learns which patches of a cloud belong to one object.
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <map>
#include <sstream>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/tool.hpp"
#include "train/relation_training.hpp"

namespace {

using namespace hyselam_objects;  // NOLINT: a program, not a header

/// Scores by group: all, those of one beginning of the name, and by number of objects.
using Groups = std::map<std::string, SegmentationScore>;

std::string kindOf(const std::string& name) {
  return name.substr(0, name.find_first_of("0123456789"));
}

void add(Groups& groups, const LabelledCloud& cloud, const SegmentationScore& score) {
  const char* many = score.objects >= 8 ? "8 and more" : score.objects >= 4 ? "4 to 7" : "up to 3";
  for (const std::string& group : {std::string("all"), kindOf(cloud.name), std::string(many)}) {
    groups[group] += score;
  }
}

nlohmann::json print(const std::string& title, const Groups& groups) {
  nlohmann::json out;
  std::cout << title << "\n";
  for (const auto& [group, score] : groups) {
    std::cout << "  " << std::left << std::setw(12) << group << std::right << std::setw(4)
              << score.objects << " objects: mean best IoU " << std::fixed << std::setprecision(3)
              << score.meanIou() << ", split " << score.over << ", joined " << score.under << "\n";
    out[group] = {{"objects", score.objects},
                  {"iou", score.meanIou()},
                  {"over", score.over},
                  {"under", score.under}};
  }
  return out;
}

/// Of a folder, without where it is, in one line.
std::string nameOf(const std::string& folder) {
  const std::filesystem::path path(folder);
  std::string name = (path.has_filename() ? path : path.parent_path()).filename().string();
  for (char& c : name) {
    if (static_cast<unsigned char>(c) <= ' ') c = '_';
  }
  return name;
}

std::string textOf(const Groups& groups) {
  std::ostringstream out;
  out << std::fixed << std::setprecision(3);
  for (const auto& [group, score] : groups) {
    out << (out.tellp() > 0 ? ", " : "mean best IoU ") << group << ' ' << score.meanIou();
  }
  return out.str();
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Learns from clouds labelled by hand which patches belong to one object, and tells how well "
      "objects are found: in sample, with each cloud left out in turn, and with each kind of "
      "clouds (the name without number) left out.",
      "train_segmentation");
  std::vector<std::string> folders;
  std::string model_file;
  app.add_option("FOLDER", folders,
                 "of PCD files with the labels of mOSD (10 k ... 10 k + 9: parts of object k)")
      ->required();
  app.add_option("--model", model_file, "file to write");
  return hyselam::runTool(argc, argv, app, [&] {
    const std::vector<LabelledCloud> clouds = readLabelledClouds(folders);
    RelationModel model = trainRelations(clouds, [](const LabelledCloud&) { return true; });
    Groups in_sample, left_out, without_colors, other_kinds;
    std::map<std::string, RelationModel> of_others;  // by kind that was left out
    for (const LabelledCloud& cloud : clouds) {
      const auto other = [&](const LabelledCloud& each) { return &each != &cloud; };
      const RelationModel others = trainRelations(clouds, other);
      add(in_sample, cloud, scoreCloud(cloud, model));
      add(left_out, cloud, scoreCloud(cloud, others));
      add(without_colors, cloud, scoreCloud(cloud, others, false));
      const std::string kind = kindOf(cloud.name);
      if (of_others.count(kind) == 0) {
        of_others[kind] = trainRelations(
            clouds, [&](const LabelledCloud& each) { return kindOf(each.name) != kind; });
      }
      add(other_kinds, cloud, scoreCloud(cloud, of_others[kind]));
    }
    nlohmann::json report{{"clouds", clouds.size()}};
    report["in_sample"] = print("in sample:", in_sample);
    report["left_out"] = print("each cloud left out in turn:", left_out);
    report["left_out_without_colors"] = print("the same, without colors:", without_colors);
    if (of_others.size() > 1) {
      report["kind_left_out"] = print("each kind of clouds left out:", other_kinds);
    }
    if (!model_file.empty()) {
      std::string data = std::to_string(clouds.size()) + " clouds of mOSD:";
      for (const LabelledCloud& cloud : clouds) data += " " + cloud.name;
      std::string command = "train_segmentation";
      for (const std::string& folder : folders) command += " " + nameOf(folder);
      model.origin = {command, data, textOf(in_sample), textOf(left_out)};
      hyselam::writeFileAtomically(model_file, [&](std::ostream& out) { out << model.toText(); });
      std::cout << "-> " << model_file << "\n";
    }
    return report;
  });
}
