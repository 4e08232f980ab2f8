// A person's sentences become a description of the building, or are refused with a reason.
#include <cstdio>

#include "hyselam_language/building/description_builder.hpp"
#include "hyselam_language/grammar/topo_parser.hpp"

int main() {
  const hyselam_topo::TopoParser parser;
  hyselam_topo::DescriptionBuilder builder(parser);
  const hyselam_topo::ParsedText text = parser.parse(
      "You are in the corridor. On your left you have the kitchen, then room 5. "
      "The kitchen is 6 by 8 meters. The weather is nice.");
  builder.add(text);
  const hyselam_topo::DescribedBuilding& building = builder.building();
  for (const hyselam_topo::DescribedConnection& c : building.connections)
    std::printf("%s: %s, %s\n", building.findPlace(c.from)->name.c_str(),
                building.findPlace(c.to)->name.c_str(), toString(c.side));
  for (const hyselam_topo::DescribedPlace& place : building.places)
    if (place.area) std::printf("%s: %.0f m2\n", place.name.c_str(), *place.area);
  for (const hyselam_topo::Utterance& u : text.utterances)
    if (!u.understood()) std::printf("not understood: %s\n", u.text.c_str());
  return 0;
}
