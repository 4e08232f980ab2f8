#include "hyselam_common/model_text.hpp"

#include "hyselam_common/checksum.hpp"
#include "hyselam_common/errors.hpp"
#include "hyselam_common/format_version.hpp"
#include "hyselam_common/numbers.hpp"

namespace hyselam {
namespace {
constexpr const char* kChecksum = "checksum ";
}

std::string modelHead(const std::string& format, const ModelOrigin& origin) {
  return format + "\ncommand " + origin.command + "\ndata " + origin.data + "\nin_sample " +
         origin.in_sample + "\nleft_out " + origin.left_out + "\n";
}

std::string withChecksum(const std::string& body) {
  return body + kChecksum + crc32Text(body) + "\n";
}

ModelLines::ModelLines(std::string_view text, const std::string& source, const std::string& what,
                       std::size_t most_mebibytes)
    : source_(source), rest_(text) {
  if (text.size() > most_mebibytes << 20) {
    fail("has more than " + std::to_string(most_mebibytes) + " MiB");
  }
  const std::size_t last = text.rfind(kChecksum);
  if (last == std::string_view::npos || (last > 0 && text[last - 1] != '\n')) {
    fail("has no checksum: it is cut short, or no " + what);
  }
  rest_ = text.substr(0, last);
  if (text.substr(last) != kChecksum + crc32Text(rest_) + "\n") {
    fail("the checksum is wrong: it was damaged or changed by hand");
  }
}

ModelOrigin ModelLines::head(const std::string& format) {
  const std::string_view first = next();
  if (first != format) fail(formatRefusal(first, format));
  ModelOrigin origin;
  origin.command = valueOf("command");
  origin.data = valueOf("data");
  origin.in_sample = valueOf("in_sample");
  origin.left_out = valueOf("left_out");
  return origin;
}

std::string_view ModelLines::next() {
  ++line_;
  const std::size_t end = rest_.find('\n');
  if (end == std::string_view::npos) fail("it ends too early");
  const std::string_view line = rest_.substr(0, end);
  rest_.remove_prefix(end + 1);
  return line;
}

std::vector<std::string_view> ModelLines::nextFields() {
  std::vector<std::string_view> fields;
  splitFields(next(), &fields);
  if (fields.empty()) fail("the line is empty");
  return fields;
}

std::string ModelLines::valueOf(const std::string& key) {
  const std::string_view line = next();
  if (line.substr(0, key.size() + 1) != key + " ") fail("'" + key + "' is expected");
  return std::string(line.substr(key.size() + 1));
}

std::size_t ModelLines::countOf(const std::string& key, std::size_t most) {
  const auto value = parseNumber(valueOf(key));
  if (!value || *value < 1.0 || *value > static_cast<double>(most) ||
      *value != static_cast<double>(static_cast<std::size_t>(*value))) {
    fail(key + " must be a number of 1 .. " + std::to_string(most));
  }
  return static_cast<std::size_t>(*value);
}

void ModelLines::end(const std::string& what) {
  if (rest_.empty()) return;
  next();
  fail("there is more than the " + what);
}

void ModelLines::fail(const std::string& reason) const {
  throw InputError(source_, line_ == 0 ? "" : "line " + std::to_string(line_), reason);
}

}  // namespace hyselam
