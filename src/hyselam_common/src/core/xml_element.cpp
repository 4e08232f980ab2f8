#include "hyselam_common/xml_element.hpp"

#include <tinyxml2.h>

#include <cmath>
#include <limits>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/numbers.hpp"

namespace hyselam {

XmlElement::XmlElement(const tinyxml2::XMLElement& element, const std::string& source)
    : element_(element), source_(source) {
  std::set<std::string> names;
  for (auto* a = element.FirstAttribute(); a != nullptr; a = a->Next()) {
    if (!names.insert(a->Name()).second) {
      fail("the attribute '" + std::string(a->Name()) + "' stands twice");
    }
  }
}

std::string XmlElement::name() const {
  return element_.Name();
}

bool XmlElement::has(const char* attribute) const {
  return element_.Attribute(attribute) != nullptr;
}

void XmlElement::fail(const std::string& reason) const {
  throw hyselam::InputError(
      source_, "line " + std::to_string(element_.GetLineNum()) + ", <" + name() + ">", reason);
}

const char* XmlElement::attribute(const char* attribute) {
  const char* value = element_.Attribute(attribute);
  if (value == nullptr) fail("the attribute '" + std::string(attribute) + "' is missing");
  asked_.insert(attribute);
  return value;
}

std::string XmlElement::text(const char* attribute_name) {
  return attribute(attribute_name);
}

double XmlElement::number(const char* attribute_name) {
  const char* value = attribute(attribute_name);
  const auto number = hyselam::parseNumber(value);
  if (!number) {
    fail("the attribute '" + std::string(attribute_name) + "' is '" + value +
         "', which is no finite number");
  }
  return *number;
}

int XmlElement::integer(const char* attribute_name) {
  const double value = number(attribute_name);
  if (value != std::floor(value) || std::abs(value) > std::numeric_limits<int>::max()) {
    fail("the attribute '" + std::string(attribute_name) + "' is no whole number");
  }
  return static_cast<int>(value);
}

std::uint32_t XmlElement::id(const char* attribute_name) {
  const double value = number(attribute_name);
  if (value != std::floor(value) || value < 1.0 ||
      value > std::numeric_limits<std::uint32_t>::max()) {
    fail("the attribute '" + std::string(attribute_name) + "' is no id: 1 .. 4294967295");
  }
  return static_cast<std::uint32_t>(value);
}

bool XmlElement::truth(const char* attribute_name) {
  const std::string value = attribute(attribute_name);
  if (value == "true" || value == "1") return true;
  if (value == "false" || value == "0") return false;
  fail("the attribute '" + std::string(attribute_name) + "' is '" + value +
       "', but must be true or false");
}

const char* XmlElement::content() const {
  const tinyxml2::XMLNode* only = nullptr;
  for (auto* node = element_.FirstChild(); node != nullptr; node = node->NextSibling()) {
    if (node->ToComment() != nullptr) continue;
    if (node->ToText() == nullptr || only != nullptr) fail("here must be text and nothing else");
    only = node;
  }
  return only == nullptr ? "" : only->Value();
}

std::vector<double> XmlElement::numbers() const {
  std::vector<double> values;
  const std::string text = content();
  constexpr char kSpace[] = " \t\r\n";
  for (std::size_t begin = text.find_first_not_of(kSpace); begin != std::string::npos;) {
    const std::size_t end = std::min(text.find_first_of(kSpace, begin), text.size());
    const std::string field = text.substr(begin, end - begin);
    const auto number = hyselam::parseNumber(field);
    if (!number) fail("'" + field.substr(0, 40) + "' is no finite number");
    values.push_back(*number);
    begin = text.find_first_not_of(kSpace, end);
  }
  return values;
}

std::vector<std::pair<std::string, std::string>> XmlElement::unknownAttributes() const {
  std::vector<std::pair<std::string, std::string>> unknown;
  for (auto* a = element_.FirstAttribute(); a != nullptr; a = a->Next()) {
    if (asked_.count(a->Name()) == 0) unknown.emplace_back(a->Name(), a->Value());
  }
  return unknown;
}

void XmlElement::walk(const Take& take, std::vector<std::string>* unknown) const {
  for (auto* node = element_.FirstChild(); node != nullptr; node = node->NextSibling()) {
    if (node->ToComment() != nullptr) continue;
    if (node->ToElement() == nullptr) fail("text stands where only elements may");
    XmlElement child(*node->ToElement(), source_);
    if (take(child)) continue;
    if (unknown == nullptr) child.fail("this element is not known here");
    tinyxml2::XMLPrinter printer(nullptr, true);
    node->Accept(&printer);
    unknown->push_back(printer.CStr());
  }
}

void XmlElement::children(const Take& take, XmlExtras* extras) {
  walk(take, &extras->elements);
  extras->attributes = unknownAttributes();
}

void XmlElement::children(const Take& take) {
  walk(take, nullptr);
  const auto unknown = unknownAttributes();
  if (!unknown.empty()) fail("the attribute '" + unknown.front().first + "' is not known here");
}

void XmlElement::finish() {
  children([](XmlElement&) { return false; });
}

}  // namespace hyselam
