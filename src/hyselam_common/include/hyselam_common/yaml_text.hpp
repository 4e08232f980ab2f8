// YAML of people's making: what is none is refused with its line, whatever version reads it.
#pragma once

#include <yaml-cpp/yaml.h>

#include <string>

namespace hyselam {

/// The node of a text. @throws InputError, naming source and line, for text that is no YAML, is
/// empty, or nests absurdly deep (which older yaml-cpp would follow until the stack ends).
YAML::Node parseYaml(const std::string& text, const std::string& source);

}  // namespace hyselam
