// One element of a file while it is read: every attribute is asked for, kept as an extra, or
// refused; errors name the line and the element.
#pragma once

#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "hyselam_common/xml_extras.hpp"

namespace tinyxml2 {
class XMLElement;
}

namespace hyselam {

class XmlElement {
 public:
  /// Both must outlive this. @throws InputError for an attribute that stands twice.
  XmlElement(const tinyxml2::XMLElement& element, const std::string& source);

  [[noreturn]] void fail(const std::string& reason) const;

  std::string name() const;
  /// Throw InputError if the attribute is missing or not what it should be.
  std::string text(const char* attribute);
  double number(const char* attribute);
  int integer(const char* attribute);
  /// A number above 0, as ids are.
  std::uint32_t id(const char* attribute);
  bool truth(const char* attribute);
  bool has(const char* attribute) const;

  /// The text between the tags; no elements may stand there.
  const char* content() const;
  /// The numbers in content(), separated by white space.
  std::vector<double> numbers() const;

  /// Calls `take` for each child element; if it gives false, the child is unknown.
  using Take = std::function<bool(XmlElement& child)>;
  /// Unknown children and attributes that nobody has asked for become extras.
  void children(const Take& take, XmlExtras* extras);
  /// Unknown children and attributes are refused.
  void children(const Take& take);
  /// No children, no attributes but those asked for.
  void finish();

 private:
  const char* attribute(const char* attribute);
  std::vector<std::pair<std::string, std::string>> unknownAttributes() const;
  void walk(const Take& take, std::vector<std::string>* unknown) const;

  const tinyxml2::XMLElement& element_;
  const std::string& source_;
  std::set<std::string> asked_;
};

}  // namespace hyselam
