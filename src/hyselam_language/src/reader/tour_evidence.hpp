// What the words of a tour say of its rooms, by the classifiers.
#pragma once

#include <vector>

#include "tour_context.hpp"
#include "tour_layout.hpp"
#include "tour_model.hpp"

namespace hyselam_topo {
namespace language {

/// `room_of`: number of the room, below `rooms`, of each mention.
TourEvidence evidenceOf(const TourModel& model, const TourContext& context,
                        const std::vector<std::size_t>& room_of, std::size_t rooms);

}  // namespace language
}  // namespace hyselam_topo
