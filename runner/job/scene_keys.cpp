#include "runner/job/scene_keys.hpp"

#include "runner/job/scene_part_keys.hpp"
#include "runner/job/skeleton_file.hpp"

namespace rodsweep {

// An overload used by KeyTable.
static void read_value(const Place& at, std::shared_ptr<const Skeleton>& skeleton) {
  const InputFile& file = at.job.files.at(at.point.text(at.path));
  try {
    skeleton = shared_skeleton(file.path, file.hash);
  } catch (const SkeletonError& error) {
    throw job_error(at.job.path, at.path, error.what());
  }
}

namespace {

using Table = KeyTable<SceneSpec>;
using Rods = RodParameters;

// Members that several scenes have, or a tree's shape.
const auto segments = [](auto& scene) -> decltype((scene.segments)) { return scene.segments; };
const auto tip_force_n = [](auto& scene) -> decltype((scene.tip_force_n)) { return scene.tip_force_n; };
const auto length_m = [](auto& scene) -> decltype((scene.length_m)) { return scene.length_m; };
template <class Value>
auto shape(Value TreeShape::*value) {
  return [value](Tree& tree) -> Value& { return tree.shape.*value; };
}
struct OwnRadius {
  double& operator()(RodParameters& scene) const { return scene.radius_m; }
  void operator()(SkeletonTree&) const = delete;
};

Key length_key(const char* name, const char* help) { return number_key(name, help).in("m").above(0).at_most(1e6); }
Key angle_key(const char* name, const char* help, double least, double most) {
  return number_key(name, help).in("deg").from(least, most);
}

void add_shapes(Table& table) {
  table.optional(
      choice_key("clamp", "how the first end is held: its segment, an exact wall (not of a ring), or not at all")
          .otherwise("a net is \"held\", trees stand on the ground"),
      Words<Clamp>{{"segment", Clamp::segment}, {"wall", Clamp::wall}, {"free", Clamp::free}}, &OpenRod::clamp,
      &Ring::clamp);
  table.optional(choice_key("held",
                            "what is held, of a net: the first segments of all its rods along z (side), the end "
                            "segments of the outermost two of them (corners), or nothing; of a lattice: the nodes of "
                            "the least x (side), its eight corners, or nothing")
                     .otherwise("a rod's end has a \"clamp\""),
                 Words<Held>{{"side", Held::side}, {"corners", Held::corners}, {"free", Held::free}}, &Net::held,
                 &Lattice::held);
  table.required(
      integer_key("segments",
                  "number of segments of the rod, or of each of them, without a wall's static one; of nets and "
                  "lattices from one crossing to the next; of a tree's trunk and of each of its branches")
          .from(1, 1000000)
          .also_called({"n", "number_of_segments", "elements"})
          .otherwise("a skeleton has one for every edge"),
      segments, shape(&TreeShape::segments));
  table.required(length_key("length_m", "length of the rod; of a tree's trunk").plausibly(1e-4, 1e3), length_m,
                 shape(&TreeShape::length_m));
  table.optional(
      angle_key("twist_deg", "total angle by which a ring was twisted before its ends were joined", -1e6, 1e6),
      &Ring::twist_deg);
  table.optional(choice_key("rest_shape", "what the rod of a ring would be without load, cut open"),
                 Words<Ring::RestShape>{{"straight", Ring::RestShape::straight}, {"circle", Ring::RestShape::circle}},
                 &Ring::rest_shape);
  table.required(integer_key("rows", "rods of a net along x; rows of a forest").from(1, 1000), &Net::rows,
                 &Forest::rows);
  table.required(integer_key("columns", "rods of a net along z; trees in a row of a forest").from(1, 1000),
                 &Net::columns, &Forest::columns);
  table.required(
      length_key("mesh_m", "distance of neighbouring rods of a net; edge of a lattice's cell").plausibly(1e-5, 1e2),
      &Net::mesh_m, &Lattice::mesh_m);
  table.optional(choice_key("cell",
                            "where the rods of a lattice run: along the edges of its cells, along their "
                            "diagonals, or along the diagonals of their faces"),
                 Words<Lattice::Cell>{{"cubic", Lattice::Cell::cubic},
                                      {"body_centred", Lattice::Cell::body_centred},
                                      {"octet", Lattice::Cell::octet}},
                 &Lattice::cell);
  table.required(integer_key("nodes_x", "corners of a lattice's cells along x").from(2, 1000), &Lattice::nodes_x);
  table.optional(integer_key("nodes_y", "corners of a lattice's cells along y; 0: as many as along x").from(0, 1000),
                 &Lattice::nodes_y);
  table.optional(integer_key("nodes_z", "corners of a lattice's cells along z; 0: as many as along x").from(0, 1000),
                 &Lattice::nodes_z);
  table.optional(
      number_key("node_stiffness", "how stiff the joints of a lattice's nodes are, over a piece of rod two radii long")
          .above(0)
          .at_most(1e9),
      &Lattice::node_stiffness);
  table.required(length_key("helix_radius_m", "radius of the helix").plausibly(1e-5, 1e2), &Helix::helix_radius_m);
  table.required(length_key("helix_height_m", "height of the helix").plausibly(1e-5, 1e3), &Helix::helix_height_m);
  table.required(number_key("windings", "turns of the helix").above(0).at_most(1e6).also_called({"turns"}),
                 &Helix::windings);
}

void add_rods(Table& table) {
  table.required(number_key("radius_m", "radius of the rod's cross-section; of a tree's trunk at the ground")
                     .in("m")
                     .above(0)
                     .at_most(1e3)
                     .plausibly(1e-6, 10)
                     .otherwise("a skeleton has its own radii"),
                 OwnRadius());
  table.required(number_key("density_kg_m3", "density")
                     .in("kg/m^3")
                     .above(0)
                     .at_most(1e6)
                     .plausibly(10, 25000, "water has 1000, steel 7850")
                     .also_called({"rho"}),
                 &Rods::density_kg_m3);
  table.required(number_key("youngs_modulus_pa", "Young's modulus, for bending")
                     .in("Pa")
                     .above(0)
                     .at_most(1e15)
                     .plausibly(1e3, 2e12, "rubber has 1e6 to 1e8, steel 2e11")
                     .also_called({"bending_modulus_pa", "elastic_modulus_pa", "e", "y"}),
                 &Rods::youngs_modulus_pa);
  table.required(number_key("torsion_modulus_pa", "torsion modulus, for twisting and shear")
                     .in("Pa")
                     .above(0)
                     .at_most(1e15)
                     .plausibly(1e3, 2e12, "rubber has 3e5 to 3e7, steel 8e10")
                     .also_accepted_as("shear_modulus_pa")
                     .also_called({"g", "t"}),
                 &Rods::torsion_modulus_pa);
  table.optional(
      angle_key("initial_angle_deg",
                "angle from the horizontal at the start; of a bundle's outermost rods from the vertical", -360, 360),
      &BendingRod::initial_angle_deg, &Bundle::initial_angle_deg, &Lattice::initial_angle_deg);
  table.optional(vector_key("gravity_m_s2", "acceleration of gravity")
                     .in("m/s^2")
                     .from(-1e6, 1e6)
                     .plausibly(0, 300, "the Earth has 9.81"),
                 &Rods::gravity_m_s2);
  table.optional(number_key("damping_per_s", "viscous damping: velocities decay at this rate").in("1/s").from(0, 1e6),
                 &Rods::damping_per_s);
  table.optional(vector_key("tip_force_n",
                            "constant force at the free end; on the nodes of a lattice with the greatest x together")
                     .in("N")
                     .from(-1e12, 1e12),
                 tip_force_n);
  table.optional(choice_key("stretch",
                            "stretching and shearing: held back by a stiffness chosen from the expected forces, or by "
                            "EA and kappa G A (Timoshenko's coefficient of a circle)"),
                 Words<Stretch>{{"inextensible", Stretch::inextensible}, {"physical", Stretch::physical}},
                 &Rods::stretch);
  table.optional(number_key("stretch_compliance_per_j",
                            "compliance of the stretch and shear constraints, or the one that \"stretch\" means")
                     .in("1/J")
                     .from(0, 1e6)
                     .or_word("from_stretch"),
                 &Rods::stretch_compliance_per_j);
  table.optional(
      object_key("wind", "what the air around the rods does; segments have quadratic drag in it").or_word("none"),
      wind_keys(), &Rods::wind);
  table.optional(obstacles_key(), &Rods::obstacles);
}

void add_trees(Table& table) {
  using Shape = TreeShape;
  table.required(integer_key("depth", "branchings of a tree between the ground and a twig").from(0, 100),
                 shape(&Shape::depth));
  table.required(integer_key("branches", "new branches at the end of each branch of a tree").from(1, 100),
                 shape(&Shape::branches));
  table.optional(
      number_key("length_ratio", "length of a tree's branch over that of the one it grows from").above(0).at_most(10),
      shape(&Shape::length_ratio));
  table.optional(
      number_key("taper", "radius of a tree's branch where it ends over that where it begins; 1: the pipe model's own")
          .above(0)
          .at_most(1),
      shape(&Shape::taper));
  table.optional(
      number_key("pipe_exponent", "e of the pipe model r^e = r_1^e + r_2^e + ... at every branching of a tree")
          .from(0.5, 10),
      shape(&Shape::pipe_exponent));
  table.optional(angle_key("branching_angle_deg", "angle between a tree's branch and the one it grows from", 0, 150),
                 shape(&Shape::branching_angle_deg));
  table.optional(angle_key("angle_spread_deg", "by how much at most the branching angles differ from that", 0, 150),
                 shape(&Shape::angle_spread_deg));
  table.optional(
      choice_key("phyllotaxis", "how branches go around: by the golden angle from one to the next, or at random"),
      Words<Shape::Phyllotaxis>{{"golden", Shape::Phyllotaxis::golden}, {"random", Shape::Phyllotaxis::random}},
      shape(&Shape::phyllotaxis));
  table.optional(integer_key("tree_seed", "which tree of all those of this shape; which forest").from(0, 1e15),
                 shape(&Shape::seed));
  table.optional(
      number_key("modulus_exponent", "both moduli of a tree's branch grow with its radius to this power").from(-4, 4),
      &Tree::modulus_exponent, &SkeletonTree::modulus_exponent);
  table.required(length_key("spacing_m", "distance of neighbouring trees of a forest"), &Forest::spacing_m);
  table.optional(
      number_key("jitter", "how much of the spacing the places of a forest's trees are spread over").from(0, 1),
      &Forest::jitter);
  table.required(file_key("skeleton", "SWC file of a tree: id, type, x, y, z, radius, parent"),
                 &SkeletonTree::skeleton);
  table.optional(length_key("skeleton_unit_m", "size of the skeleton file's unit"), &SkeletonTree::unit_m);
  table.optional(choice_key("skeleton_up", "which axis of the skeleton file points up"),
                 Words<Up>{{"y", Up::y}, {"z", Up::z}}, &SkeletonTree::up);
}

void add_touching(Table& table) {
  table.optional(
      object_key("contact", "rods touch each other, themselves and the floor, without rebound").or_word("none"),
      contact_keys(), &Rods::contact);
  table.required(integer_key("rods", "number of rods").from(1, 30000), &FallingRods::rods, &Bundle::rods);
  table.required(integer_key("rings", "number of rings of a chain").from(1, 30000), &RingChain::rings);
  table.required(
      length_key("height_m", "from one falling rod to the next and to the floor; of a coiling rod's end above it"),
      &FallingRods::height_m, &CoilingRod::height_m);
  table.optional(angle_key("turn_deg", "of each falling rod against the one below", -360, 360), &FallingRods::turn_deg);
  table.required(number_key("feed_m_s", "how fast the held end of a coiling rod goes down").in("m/s").from(0, 1e3),
                 &CoilingRod::feed_m_s);
  table.required(number_key("pull_m_s", "how fast each end of a knot is pulled away").in("m/s").from(0, 1e3),
                 &Knot::pull_m_s);
}

}  // namespace

const KeyTable<SceneSpec>& scene_keys() {
  static const Table table = [] {
    Table keys;
    add_shapes(keys);
    add_rods(keys);
    add_trees(keys);
    add_touching(keys);
    return keys;
  }();
  return table;
}

Key scene_key() {
  Key type = choice_key("type", "which scene")
                 .unswept(
                     "to sweep over scenes, list whole ones: \"scene\": {\"grid\": [{\"type\": \"bending_rod\", "
                     "...}, {\"type\": \"helix\", ...}]}");
  KindsOf<SceneSpec>::each([&](const auto& scene) { type.choices.emplace_back(scene.name); });
  std::vector<Key> keys{type};
  keys.insert(keys.end(), scene_keys().keys().begin(), scene_keys().keys().end());
  return object_key("scene", "the rods that are simulated", std::move(keys), type.name.c_str());
}

}  // namespace rodsweep
