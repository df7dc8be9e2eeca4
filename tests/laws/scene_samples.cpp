#include "tests/laws/scene_samples.hpp"

namespace rodsweep::scene_samples {

std::vector<Json> samples() {
  std::vector<Json> out;
  for (const char* keys : {
           R"("type": "bending_rod", "clamp": "wall", "segments": 6, "length_m": 1, "initial_angle_deg": 20,
              "tip_force_n": [0.1, 0.2, -0.3], "stretch": "physical",
              "section": {"type": "rectangle", "width_m": 0.03, "height_m": 0.05})",
           R"("type": "bending_rod", "segments": 6, "length_m": 1, "stretch": "physical",
              "tip_motion": {"displacement_m": [0.01, 0.02, 0], "rotation_deg": [20, 0, 5], "duration_s": 0.05})",
           R"("type": "helix", "segments": 8, "helix_radius_m": 0.3, "helix_height_m": 0.3, "windings": 0.8,
              "tip_torque_nm": [0.1, 0.2, -0.3])",
           R"("type": "ring", "segments": 8, "length_m": 1.5, "twist_deg": 100)",
           R"("type": "net", "rows": 2, "columns": 3, "segments": 2, "mesh_m": 0.3, "stretch": "physical")",
           R"("type": "lattice", "cell": "octet", "nodes_x": 2, "segments": 1, "mesh_m": 0.5, "held": "side",
              "tip_force_n": [1, 2, 3])",
           R"("type": "tree", "depth": 1, "branches": 3, "segments": 2, "length_m": 0.6)",
           R"("type": "forest", "depth": 1, "branches": 2, "segments": 1, "length_m": 0.6, "rows": 1, "columns": 2,
              "spacing_m": 2)",
           R"("type": "skeleton", "skeleton": "fork.swc", "skeleton_unit_m": 0.01)",
           R"("type": "curves", "curves": "fork.csv", "curves_unit_m": 0.01, "segment_m": 0.2,
              "held_at_m": [[0, 0, 0]])",
           R"("type": "falling_rods", "rods": 2, "segments": 4, "length_m": 0.6, "height_m": 0.07,
              "contact": {"tolerance": 1e-5})",
           R"("type": "coiling_rod", "segments": 6, "length_m": 0.6, "height_m": 0.02, "feed_m_s": 1,
              "contact": {"tolerance": 1e-5})",
           R"("type": "knot", "segments": 40, "length_m": 5, "pull_m_s": 0.2,
              "contact": {"tolerance": 1e-5})",
           R"("type": "ring_chain", "rings": 2, "segments": 8, "length_m": 1.5,
              "contact": {"tolerance": 1e-5})",
           R"("type": "bundle", "rods": 3, "segments": 3, "length_m": 0.5, "initial_angle_deg": 10,
              "contact": {"tolerance": 1e-5})",
       }) {
    Json scene = Json::parse(std::string("{") + keys +
                             R"(, "density_kg_m3": 1000, "youngs_modulus_pa": 1e6, "torsion_modulus_pa": 4e5,
                                "gravity_m_s2": [1, -9, 2], "damping_per_s": 0.5, "internal_damping_s": 0.01})");
    if (scene["type"] != "skeleton") scene["radius_m"] = 0.03;
    out.push_back(scene);
  }
  return out;
}

}  // namespace rodsweep::scene_samples
