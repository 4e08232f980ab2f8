// Writes made-up floor plans: see hyselam_sim/generate_plan.hpp.
#include "hyselam_sim/generate_plan.hpp"

#include "hyselam_common/atomic_file.hpp"
#include "hyselam_common/tool.hpp"

int main(int argc, char** argv) {
  CLI::App app(
      "Writes the floor plan that belongs to a seed: rooms, corridors, doors of many widths.");
  std::string out;
  std::uint64_t seed = 1;
  hyselam_sim::PlanParams params;
  double rotation = 0.0;
  std::string layout = "any";
  bool no_openings = false;
  app.add_option("OUT", out, "floor plan to write (.yaml)")->required();
  app.add_option("--seed", seed, "decides everything that is left open");
  app.add_option("--layout", layout, "any, corridor, corner or flat")
      ->check(CLI::IsMember({"any", "corridor", "corner", "flat"}));
  app.add_option("--min-door", params.min_door, "narrowest door [m], default 0.7");
  app.add_option("--max-door", params.max_door, "widest door [m], default 2.0");
  app.add_option("--rotation", rotation, "turn the floor [degrees]");
  app.add_flag("--furniture", params.furniture, "with furniture");
  app.add_flag("--no-openings", no_openings, "no passages wider than doors");
  return hyselam::runTool(argc, argv, app, [&]() -> nlohmann::json {
    using Layout = hyselam_sim::PlanParams::Layout;
    params.layout = layout == "corridor" ? Layout::kCorridor
                    : layout == "corner" ? Layout::kCorner
                    : layout == "flat"   ? Layout::kFlat
                                         : Layout::kAny;
    params.rotation = hyselam::radians(rotation);
    params.openings = !no_openings;
    const hyselam_sim::FloorPlan plan = hyselam_sim::generatePlan(seed, params);
    hyselam::writeFileAtomically(out,
                                 [&](std::ostream& file) { file << hyselam_sim::toYaml(plan); });
    return {{"plan", plan.name},
            {"places", plan.places.size()},
            {"doors", plan.doors.size()},
            {"furniture", plan.furniture.size()}};
  });
}
