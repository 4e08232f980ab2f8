#include "hyselam_common/trajectory_io.hpp"

#include <array>
#include <cstdio>
#include <string_view>

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/numbers.hpp"

namespace hyselam {
namespace {

constexpr std::size_t kTumColumns = 8;
constexpr std::size_t kReferenceColumns = 6;  // further ones are not needed, but for this one
constexpr std::string_view kEstimatedColumn = "is_rbpf_update";

std::string lineText(std::size_t line) {
  return "line " + std::to_string(line);
}

/// Calls f(line, numbers) for each line with data; each must hold `columns` numbers or, if `more`,
/// at least as many.
template <typename F>
void forEachRow(const std::string& text, const std::string& path, std::size_t columns, bool more,
                F&& f) {
  std::vector<std::string_view> fields;
  std::array<double, kTumColumns> numbers{};
  forEachLine(text, [&](std::size_t line, std::string_view content) {
    splitFields(content, &fields);
    if (fields.empty() || fields[0][0] == '#') return;
    if (fields.size() < columns || (!more && fields.size() > columns)) {
      throw InputError(path, lineText(line),
                       std::to_string(fields.size()) + " columns instead of " +
                           (more ? "at least " : "") + std::to_string(columns));
    }
    for (std::size_t i = 0; i < columns; ++i) {
      const auto number = parseNumber(fields[i]);
      if (!number) {
        throw InputError(path, lineText(line),
                         "column " + std::to_string(i + 1) + " is not a finite number");
      }
      numbers[i] = *number;
    }
    f(line, numbers);
  });
}

/// Whether the seventh column of a reference table tells which poses were estimated.
bool tellsEstimates(const std::string& text) {
  bool tells = false;
  std::vector<std::string_view> fields;
  forEachLine(text, [&](std::size_t, std::string_view content) {
    splitFields(content, &fields);
    if (fields.size() < 2 || fields[0] != "#" || fields[1] != "scan_index") return;
    tells =
        fields.size() > kReferenceColumns + 1 && fields[kReferenceColumns + 1] == kEstimatedColumn;
  });
  return tells;
}

std::vector<StampedPose2> parseTum(const std::string& text, const std::string& path) {
  std::vector<StampedPose2> trajectory;
  forEachRow(text, path, kTumColumns, false, [&](std::size_t line, const auto& v) {
    const double qx = v[4], qy = v[5], qz = v[6], qw = v[7];
    const double norm = std::sqrt(qx * qx + qy * qy + qz * qz + qw * qw);
    if (!(std::abs(norm - 1.0) <= 0.01)) {
      throw InputError(path, lineText(line),
                       "the quaternion has length " + formatNumber(norm) + " instead of 1");
    }
    const double yaw = std::atan2(2.0 * (qw * qz + qx * qy), 1.0 - 2.0 * (qy * qy + qz * qz));
    trajectory.push_back({v[0], {v[1], v[2], normalizeAngle(yaw)}});
  });
  if (trajectory.empty()) throw InputError(path, "", "holds no pose");
  return trajectory;
}

PoseFile parseReference(const std::string& text, const std::string& path) {
  PoseFile file;
  file.one_per_scan = true;
  const bool tells = tellsEstimates(text);
  const std::size_t columns = tells ? kReferenceColumns + 1 : kReferenceColumns;
  forEachRow(text, path, columns, true, [&](std::size_t line, const auto& v) {
    if (v[0] != static_cast<double>(file.poses.size())) {
      throw InputError(path, lineText(line),
                       "scan_index is " + formatNumber(v[0]) + " instead of " +
                           std::to_string(file.poses.size()));
    }
    file.poses.push_back({v[2], {v[3], v[4], normalizeAngle(v[5])}});
    if (tells) file.estimated.push_back(v[kReferenceColumns] != 0.0);
  });
  if (file.poses.empty()) throw InputError(path, "", "holds no pose");
  return file;
}

/// The header comment names the columns of a reference table; a TUM file has no such line.
bool isReferenceTable(const std::string& text) {
  bool reference = false, decided = false;
  std::vector<std::string_view> fields;
  forEachLine(text, [&](std::size_t, std::string_view content) {
    if (decided) return;
    splitFields(content, &fields);
    if (fields.empty()) return;
    if (fields[0][0] == '#') {
      reference = reference || content.find("scan_index") != std::string_view::npos;
      return;
    }
    decided = true;
  });
  return reference;
}

}  // namespace

std::vector<StampedPose2> readTum(const std::string& path) {
  return parseTum(readTextFile(path), path);
}

std::vector<StampedPose2> readReferenceTable(const std::string& path) {
  return parseReference(readTextFile(path), path).poses;
}

PoseFile readPoses(const std::string& path) {
  const std::string text = readTextFile(path);
  if (isReferenceTable(text)) return parseReference(text, path);
  return {parseTum(text, path), false, {}};
}

void writeTum(const std::string& path, const std::vector<StampedPose2>& trajectory) {
  writeFileAtomically(path, [&](std::ostream& out) {
    char line[256];
    for (const StampedPose2& p : trajectory) {
      std::snprintf(line, sizeof line, "%.9f %.9f %.9f 0 0 0 %.9f %.9f\n", p.stamp, p.pose.x,
                    p.pose.y, std::sin(p.pose.theta / 2.0), std::cos(p.pose.theta / 2.0));
      out << line;
    }
  });
}

}  // namespace hyselam
