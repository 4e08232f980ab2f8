#include "hyselam_common/xml_document.hpp"

#include <tinyxml2.h>

#include <algorithm>

#include "hyselam_common/errors.hpp"
#include "hyselam_common/utf8.hpp"

namespace hyselam {
namespace {

/// Refuses what would take memory or time out of proportion before anything is parsed.
void checkText(const std::string& text, const std::string& source, const XmlLimits& limits) {
  const auto refuse = [&](const std::string& reason) {
    throw hyselam::InputError(source, "", reason);
  };
  const auto count = [&](char c) {
    return static_cast<std::size_t>(std::count(text.begin(), text.end(), c));
  };
  if (text.size() > limits.max_bytes) {
    refuse("it has " + std::to_string(text.size()) + " bytes, more than " +
           std::to_string(limits.max_bytes));
  }
  if (text.find('\0') != std::string::npos || !isUtf8(text)) refuse("this is not UTF-8 text");
  if (text.find("<!DOCTYPE") != std::string::npos || text.find("<!ENTITY") != std::string::npos) {
    refuse("a document type declaration or entities are not allowed");
  }
  // Every element has a tag, most have two.
  if (count('<') > 2 * limits.max_elements) {
    refuse("it has more than " + std::to_string(limits.max_elements) + " elements");
  }
  if (count('=') > limits.max_attributes) {
    refuse("it has more than " + std::to_string(limits.max_attributes) + " attributes");
  }
}

void checkDepth(const tinyxml2::XMLElement& element, const std::string& source, int left) {
  if (left == 0) {
    throw hyselam::InputError(source, "line " + std::to_string(element.GetLineNum()),
                              "elements are nested too deeply");
  }
  for (auto* child = element.FirstChildElement(); child != nullptr;
       child = child->NextSiblingElement()) {
    checkDepth(*child, source, left - 1);
  }
}

}  // namespace

void readXmlDocument(const std::string& text, const std::string& source, const XmlLimits& limits,
                     const std::function<void(XmlElement& root)>& read) {
  checkText(text, source, limits);
  tinyxml2::XMLDocument document;
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
    const std::string place = "line " + std::to_string(document.ErrorLineNum());
    throw hyselam::InputError(source, place,
                              std::string("this is no XML: ") + document.ErrorName());
  }
  const tinyxml2::XMLElement* root = document.RootElement();
  if (root == nullptr || root->NextSiblingElement() != nullptr) {
    throw hyselam::InputError(source, "", "this is no XML: there must be one outermost element");
  }
  checkDepth(*root, source, limits.max_depth);
  XmlElement element(*root, source);
  read(element);
}

}  // namespace hyselam
