#include "hyselam_common/parameter_documents.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "hyselam_common/numbers.hpp"

namespace hyselam {
namespace {

/// Between characters that would end a cell of a table.
std::string cell(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '|') escaped += '\\';
    escaped += c;
  }
  return escaped;
}

std::string withoutQuotes(const std::string& text) {
  std::string bare = text;
  bare.erase(std::remove(bare.begin(), bare.end(), '\''), bare.end());
  return bare;
}

std::string quotedForPython(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) {
    if (c == '\'' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + "'";
}

std::string withUnit(const ParameterRow& row) {
  const std::string space = row.unit.empty() || row.meaning.empty() ? "" : " ";
  return (row.unit.empty() ? "" : "[" + row.unit + "]") + space + row.meaning;
}

/// ", low, high"; dynamic_reconfigure knows closed ranges only.
std::string limits(const ParameterRow& row) {
  const auto text = [&](double value) {
    if (row.type == ParameterType::kInt) return std::to_string(static_cast<long long>(value));
    const std::string number = formatNumber(value);
    return number.find_first_of(".e") == std::string::npos ? number + ".0" : number;
  };
  double low = row.range.min, high = row.range.max;
  if (!std::isnan(row.range.special)) {
    low = std::min(low, row.range.special);
    high = std::max(high, row.range.special);
  }
  std::string all;
  if (std::isfinite(low)) all += ", min=" + text(low);
  if (std::isfinite(high)) all += ", max=" + text(high);
  return all;
}

}  // namespace

std::string parameterMarkdown(const std::vector<ParameterRow>& rows) {
  std::ostringstream out;
  out << "| parameter | default | unit | allowed | meaning |\n|---|---|---|---|---|\n";
  for (const ParameterRow& r : rows) {
    const std::string fallback = withoutQuotes(r.default_value);
    out << "| `" << r.name << "` | " << (fallback.empty() ? "(empty)" : cell(fallback)) << " | "
        << cell(r.unit) << " | " << cell(r.allowed) << " | " << cell(r.meaning) << " |\n";
  }
  return out.str();
}

std::string parameterYaml(const std::vector<ParameterRow>& rows,
                          const std::set<std::string>& commented_out) {
  std::ostringstream out;
  for (const ParameterRow& r : rows) {
    const std::string meaning = withUnit(r);
    out << "\n# " << meaning << (meaning.empty() ? "" : "; ") << r.allowed << "\n";
    const bool comment = r.default_yaml.empty() || commented_out.count(r.name) > 0;
    out << (comment ? "# " : "") << r.name << ":" << (r.default_yaml.empty() ? "" : " ")
        << r.default_yaml << "\n";
  }
  return out.str();
}

std::string reconfigureCfg(const std::vector<ParameterRow>& rows,
                           const std::vector<std::string>& names, const std::string& package,
                           const std::string& node, const std::string& name) {
  std::ostringstream out;
  out << "#!/usr/bin/env python3\n"
         "\"\"\"Parameters of "
      << package << "/" << name
      << " that may change while it runs; written by scripts/docs.\"\"\"\n"
         "from dynamic_reconfigure.parameter_generator_catkin import (ParameterGenerator, bool_t,\n"
         "                                                            double_t, int_t, str_t)\n\n"
         "gen = ParameterGenerator()\n";
  for (const std::string& wanted : names) {
    const auto found = std::find_if(rows.begin(), rows.end(),
                                    [&](const ParameterRow& r) { return r.name == wanted; });
    if (found == rows.end()) throw InputError(name + ".cfg", wanted, "there is no such parameter");
    const ParameterRow& r = *found;
    const auto add = [&](const std::string& type, const std::string& value,
                         const std::string& rest) {
      out << "gen.add('" << r.name << "', " << type << ", 0, " << quotedForPython(withUnit(r))
          << ",\n        " << value << rest << ")\n";
    };
    switch (r.type) {
      case ParameterType::kDouble:
        add("double_t", r.default_yaml, limits(r));
        break;
      case ParameterType::kInt:
        add("int_t", r.default_yaml, limits(r));
        break;
      case ParameterType::kBool:
        add("bool_t", r.default_yaml == "true" ? "True" : "False", "");
        break;
      case ParameterType::kString: {
        if (!r.choices.empty()) {
          out << r.name << " = gen.enum([";
          for (std::size_t i = 0; i < r.choices.size(); ++i) {
            const std::string word = quotedForPython(r.choices[i]);
            out << (i > 0 ? ",\n    " : "\n    ") << "gen.const('" << r.choices[i] << "_" << r.name
                << "', str_t, " << word << ", " << word << ")";
          }
          out << "],\n    " << quotedForPython(r.meaning) << ")\n";
        }
        add("str_t", quotedForPython(withoutQuotes(r.default_value)),
            r.choices.empty() ? "" : ", edit_method=" + r.name);
        break;
      }
      case ParameterType::kDoubles:
      case ParameterType::kInts:
        throw InputError(name + ".cfg", wanted, "dynamic_reconfigure has no lists");
    }
  }
  out << "\nexit(gen.generate('" << package << "', '" << node << "', '" << name << "'))\n";
  return out.str();
}

}  // namespace hyselam
