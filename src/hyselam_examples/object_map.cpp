// A person describes where objects are; the robot records it in its object map and answers
// questions.
#include <cstdio>

#include "hyselam_objects/language/fill_map.hpp"

int main() {
  const auto parser = hyselam_objects::ObjectParser::shipped("en");
  hyselam_objects::ObjectMap map;
  hyselam_objects::FillMap fill_map(parser, map);
  for (const char* sentence : {"There is a red cup on the table in the kitchen.",
                               "I moved the cup to the office.", "Where is the cup?"}) {
    for (const auto& reply : fill_map.process(sentence)) {
      std::printf("%s\n  %s\n", sentence, reply.text.c_str());
    }
  }
  for (const std::string& line : summaryLines(map)) std::printf("%s\n", line.c_str());
  return 0;
}
