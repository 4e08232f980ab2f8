// The two mistakes a caller can make: an input that cannot be used, and a parameter out of range.
#pragma once

#include <sstream>
#include <stdexcept>
#include <string>

namespace hyselam {

/// What the cores throw across public functions: InputError or ParameterError.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// An input that cannot be used: says which file (or topic), where in it, and why.
class InputError : public Error {
 public:
  /// `place` may be empty ("line 12", "byte 0x40", "key 'resolution'").
  InputError(const std::string& source, const std::string& place, const std::string& reason)
      : Error(source + (place.empty() ? "" : ": " + place) + ": " + reason) {}
};

/// A parameter with its rejected value and the range that it must lie in.
class ParameterError : public Error {
 public:
  template <typename T>
  ParameterError(const std::string& name, const T& value, const std::string& allowed)
      : Error(text(name, value, allowed)) {}

 private:
  template <typename T>
  static std::string text(const std::string& name, const T& value, const std::string& allowed) {
    std::ostringstream out;
    out << "parameter '" << name << "' is " << value << ", but must be " << allowed;
    return out.str();
  }
};

}  // namespace hyselam
