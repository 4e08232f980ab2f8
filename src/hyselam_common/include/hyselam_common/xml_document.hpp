// What the readers of all XML formats share: hostile text is refused before it takes memory or
// time, and parts that may stand once stand once.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "hyselam_common/xml_element.hpp"

namespace hyselam {

/// More than these and a file is refused before it takes the memory.
struct XmlLimits {
  std::size_t max_bytes = std::size_t{256} << 20;  ///< of the text
  std::size_t max_elements = 2000000;              ///< elements, comments and the like
  std::size_t max_attributes = 8000000;            ///< in the whole file
  int max_depth = 32;                              ///< elements within elements
};

/// Calls `read` with the outermost element. @throws hyselam::InputError for text that is no XML,
/// holds a document type declaration or entities, or more than the limits allow.
void readXmlDocument(const std::string& text, const std::string& source, const XmlLimits& limits,
                     const std::function<void(XmlElement& root)>& read);

/// A part that may stand only once.
template <typename T>
class Once {
 public:
  void set(XmlElement& element, T value) {
    if (value_) element.fail("this element stands twice");
    value_ = std::move(value);
  }
  T take(const XmlElement& parent, const char* name) {
    if (!value_) parent.fail("the element <" + std::string(name) + "> is missing");
    return std::move(*value_);
  }
  std::optional<T> takeIfThere() { return std::move(value_); }

 private:
  std::optional<T> value_;
};

}  // namespace hyselam
