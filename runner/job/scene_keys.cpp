#include "runner/job/scene_keys.hpp"

#include <iterator>

#include "runner/job/contact_keys.hpp"
#include "runner/job/obstacle_keys.hpp"
#include "runner/job/tree_keys.hpp"
#include "runner/job/wind_keys.hpp"

namespace rodsweep {

using Json = nlohmann::ordered_json;

Key scene_key() {
  Key scene = object_key(
      "scene", "the rods that are simulated",
      {
          choice_key("type", "which scene",
                     {"bending_rod", "helix", "ring", "net", "tree", "forest", "skeleton", "falling_rods",
                      "coiling_rod", "knot", "ring_chain", "bundle"})
              .unswept(
                  "to sweep over scenes, list whole ones: \"scene\": {\"grid\": [{\"type\": \"bending_rod\", ...}, "
                  "{\"type\": \"helix\", ...}]}"),
          choice_key("clamp", "how the first end is held: its segment, an exact wall (not of a ring), or not at all",
                     {"segment", "wall", "free"})
              .defaults_to("segment")
              .only({"bending_rod", "helix", "ring"}, "a net is \"held\", trees stand on the ground"),
          choice_key("held",
                     "what of a net is held: the first segments of all its rods along z, the end segments of the "
                     "outermost two of them, or nothing",
                     {"side", "corners", "free"})
              .defaults_to("corners")
              .only({"net"}, "a rod's end has a \"clamp\""),
          integer_key(
              "segments",
              "number of segments of the rod, or of each of them, without a wall's static one; of a net from one "
              "crossing to the next; of a tree's trunk and of each of its branches")
              .at_least(1)
              .at_most(1000000)
              .also_called({"n", "number_of_segments", "elements"})
              .only({"bending_rod", "helix", "ring", "net", "tree", "forest", "falling_rods", "coiling_rod", "knot",
                     "ring_chain", "bundle"},
                    "a skeleton has one for every edge"),
          number_key("length_m", "length of the rod; of a tree's trunk")
              .in("m")
              .above(0)
              .at_most(1e6)
              .only({"bending_rod", "ring", "tree", "forest", "falling_rods", "coiling_rod", "knot", "ring_chain",
                     "bundle"}),
          number_key("twist_deg", "total angle by which a ring was twisted before its ends were joined")
              .in("deg")
              .at_least(-1e6)
              .at_most(1e6)
              .defaults_to(0)
              .only({"ring"}),
          choice_key("rest_shape", "what the rod of a ring would be without load, cut open", {"straight", "circle"})
              .defaults_to("straight")
              .only({"ring"}),
          integer_key("rows", "rods of a net along x; rows of a forest")
              .at_least(1)
              .at_most(1000)
              .only({"net", "forest"}),
          integer_key("columns", "rods of a net along z; trees in a row of a forest")
              .at_least(1)
              .at_most(1000)
              .only({"net", "forest"}),
          number_key("mesh_m", "distance of neighbouring rods of a net").in("m").above(0).at_most(1e6).only({"net"}),
          number_key("helix_radius_m", "radius of the helix").in("m").above(0).at_most(1e6).only({"helix"}),
          number_key("helix_height_m", "height of the helix").in("m").above(0).at_most(1e6).only({"helix"}),
          number_key("windings", "turns of the helix").above(0).at_most(1e6).only({"helix"}).also_called({"turns"}),
          number_key("radius_m", "radius of the rod's cross-section; of a tree's trunk at the ground")
              .in("m")
              .above(0)
              .at_most(1e3)
              .only({"bending_rod", "helix", "ring", "net", "tree", "forest", "falling_rods", "coiling_rod", "knot",
                     "ring_chain", "bundle"},
                    "a skeleton has its own radii"),
          number_key("density_kg_m3", "density").in("kg/m^3").above(0).at_most(1e6).also_called({"rho"}),
          number_key("youngs_modulus_pa", "Young's modulus, for bending")
              .in("Pa")
              .above(0)
              .at_most(1e15)
              .also_called({"bending_modulus_pa", "elastic_modulus_pa", "e", "y"}),
          number_key("torsion_modulus_pa", "torsion modulus, for twisting and shear")
              .in("Pa")
              .above(0)
              .at_most(1e15)
              .also_called({"shear_modulus_pa", "g", "t"}),
          number_key("initial_angle_deg",
                     "angle from the horizontal at the start; of a bundle's outermost rods from the vertical")
              .in("deg")
              .at_least(-360)
              .at_most(360)
              .defaults_to(0)
              .only({"bending_rod", "bundle"}),
          vector_key("gravity_m_s2", "acceleration of gravity")
              .in("m/s^2")
              .at_least(-1e6)
              .at_most(1e6)
              .defaults_to(Json::array({0, -9.81, 0})),
          number_key("damping_per_s", "viscous damping: velocities decay at this rate")
              .in("1/s")
              .at_least(0)
              .at_most(1e6)
              .defaults_to(0),
          vector_key("tip_force_n", "constant force at the free end")
              .in("N")
              .at_least(-1e12)
              .at_most(1e12)
              .defaults_to(Json::array({0, 0, 0}))
              .only({"bending_rod", "helix"}),
          choice_key("stretch",
                     "stretching and shearing: held back by a stiffness chosen from the expected forces, or by EA and "
                     "kappa G A (Timoshenko's coefficient of a circle)",
                     {"inextensible", "physical"})
              .defaults_to("inextensible"),
          number_key("stretch_compliance_per_j",
                     "compliance of the stretch and shear constraints, or the one that \"stretch\" means")
              .in("1/J")
              .at_least(0)
              .at_most(1e6)
              .or_word("from_stretch")
              .defaults_to("from_stretch"),
          wind_key(),
          obstacles_key(),
      },
      "type");
  for (std::vector<Key> keys : {tree_keys(), contact_keys()})
    scene.keys.insert(scene.keys.end(), std::make_move_iterator(keys.begin()), std::make_move_iterator(keys.end()));
  return scene;
}

}  // namespace rodsweep
