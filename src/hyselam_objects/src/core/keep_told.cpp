#include "keep_told.hpp"

namespace hyselam_objects {

void keepTold(Id from, Id to, ObjectMap* map) {
  std::vector<ObjectRelation> told;
  for (const ObjectRelation& r : map->relations) {
    if (r.told && (r.object == from || r.other == from)) told.push_back(r);
  }
  for (ObjectRelation& r : told) {
    if (r.object == from) r.object = to;
    if (r.other == from) r.other = to;
    const bool place_known = r.place != 0 && map->placeOf(to) != 0;
    if (r.object != r.other && !place_known) map->relate(r);
  }
}

}  // namespace hyselam_objects
