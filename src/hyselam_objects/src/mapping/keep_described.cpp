#include "keep_described.hpp"

namespace hyselam_objects {

void keepDescribedRelations(ObjectMap& map, Id from, Id to) {
  std::vector<ObjectRelation> described;
  for (const ObjectRelation& r : map.relations) {
    if (r.described && (r.object == from || r.other == from)) described.push_back(r);
  }
  for (ObjectRelation& r : described) {
    if (r.object == from) r.object = to;
    if (r.other == from) r.other = to;
    const bool place_known = r.word == RelationWord::kAt && map.placeOf(to) != 0;
    if (r.object != r.other && !place_known) map.relate(r);
  }
}

}  // namespace hyselam_objects
