#include "runner/specs/scene_keys.hpp"

#include "runner/inputs/curve_file.hpp"
#include "runner/inputs/skeleton_file.hpp"
#include "runner/text/job_error.hpp"

namespace rodsweep {

// An overload used by KeyTable.
static void read_value(const KeyValue& at, std::shared_ptr<const std::vector<Skeleton>>& trees) {
  const InputFile& file = at.job().files.at(at.text());
  try {
    const SkeletonFile& read = shared_skeleton(file.path, file.hash);
    trees = {std::shared_ptr<void>(), &read.trees};  // kept by shared_skeleton()
  } catch (const SkeletonError& error) {
    throw job_error(at.job().path, at.path(), error.what());
  }
}

static void read_value(const KeyValue& at, std::shared_ptr<const std::vector<Curve>>& curves) {
  const InputFile& file = at.job().files.at(at.text());
  try {
    curves = {std::shared_ptr<void>(), &shared_curves(file.path, file.hash)};  // kept there
  } catch (const CurveError& error) {
    throw job_error(at.job().path, at.path(), error.what());
  }
}

namespace {

using Json = nlohmann::ordered_json;
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
struct OwnSection {
  std::optional<SectionShape>& operator()(OpenRod& scene) const { return scene.section; }
  std::optional<SectionShape>& operator()(Ring& scene) const { return scene.section; }
};
struct OwnRadius {
  double& operator()(RodParameters& scene) const { return scene.radius_m; }
  void operator()(SkeletonTree&) const = delete;
};

Key length_key(const char* name, const char* help) { return number_key(name, help).in("m").positive(1e6); }
Key angle_key(const char* name, const char* help, double least, double most) {
  return number_key(name, help).in("deg").from(least, most);
}

void add_shapes(Table& table) {
  table.optional(
      choice_key("clamp", "how the first end is held: by its segment, by an exact wall (not for rings), or not at all")
          .otherwise("use \"held\" for nets and lattices; trees are fixed to the ground"),
      Words<Clamp>{{"segment", Clamp::segment}, {"wall", Clamp::wall}, {"free", Clamp::free}}, &OpenRod::clamp,
      &Ring::clamp);
  table.optional(choice_key("held",
                            "what is held. Nets: the crossings of the first rod along x (side), the four corners, or "
                            "nothing; lattices: the nodes with the least x (side), the eight corners, or nothing")
                     .otherwise("use \"clamp\" for the end of a rod"),
                 Words<Held>{{"side", Held::side}, {"corners", Held::corners}, {"free", Held::free}}, &Net::held,
                 &Lattice::held);
  table.required(integer_key("segments",
                             "segments per rod, without a wall's static one; in nets and lattices from one crossing to "
                             "the next; in trees of the trunk and of each branch")
                     .from(1, 1000000)
                     .also_called({"n", "number_of_segments", "elements"})
                     .on_sobol(7)
                     .otherwise("a skeleton has one segment per edge"),
                 segments, shape(&TreeShape::segments));
  table.required(length_key("length_m", "length of the rod or of a tree's trunk").plausibly(1e-4, 1e3).on_sobol(1),
                 length_m, shape(&TreeShape::length_m));
  table.optional(angle_key("twist_deg", "total twist of a ring before its ends are joined", -1e6, 1e6),
                 &Ring::twist_deg);
  table.optional(choice_key("rest_shape", "rest shape of a ring's rod if it is cut open"),
                 Words<Ring::RestShape>{{"straight", Ring::RestShape::straight}, {"circle", Ring::RestShape::circle}},
                 &Ring::rest_shape);
  table.required(integer_key("rows", "rods of a net along x; rows of a forest").from(1, 1000), &Net::rows,
                 &Forest::rows);
  table.required(integer_key("columns", "rods of a net along z; trees in a row of a forest").from(1, 1000),
                 &Net::columns, &Forest::columns);
  table.required(length_key("mesh_m", "distance between neighbouring rods of a net; edge of a lattice cell")
                     .plausibly(1e-5, 1e2)
                     .on_sobol(9),
                 &Net::mesh_m, &Lattice::mesh_m);
  table.optional(
      choice_key("cell",
                 "rods of a lattice: along the edges of its cells, their diagonals, or the diagonals of their faces"),
      Words<Lattice::Cell>{{"cubic", Lattice::Cell::cubic},
                           {"body_centred", Lattice::Cell::body_centred},
                           {"octet", Lattice::Cell::octet}},
      &Lattice::cell);
  table.required(integer_key("nodes_x", "corners of lattice cells along x").from(2, 1000), &Lattice::nodes_x);
  table.optional(integer_key("nodes_y", "corners of lattice cells along y; 0: as many as along x").from(0, 1000),
                 &Lattice::nodes_y);
  table.optional(integer_key("nodes_z", "corners of lattice cells along z; 0: as many as along x").from(0, 1000),
                 &Lattice::nodes_z);
  table.optional(number_key("node_stiffness",
                            "stiffness of the joints at lattice nodes, relative to a piece of rod two radii long")
                     .positive(1e9),
                 &Lattice::node_stiffness);
  table.required(length_key("helix_radius_m", "radius of the helix").plausibly(1e-5, 1e2).on_sobol(4),
                 &Helix::helix_radius_m);
  table.required(length_key("helix_height_m", "height of the helix").plausibly(1e-5, 1e3).on_sobol(5),
                 &Helix::helix_height_m);
  table.required(number_key("windings", "turns of the helix").positive(1e6).also_called({"turns"}).on_sobol(6),
                 &Helix::windings);
}

void add_rods(Table& table) {
  table.required(number_key("radius_m", "radius of the rod, or of a tree's trunk at the ground")
                     .in("m")
                     .positive(1e3)
                     .plausibly(1e-6, 10)
                     .on_sobol(8)
                     .otherwise("a skeleton has its own radii"),
                 OwnRadius());
  table.optional(
      object_key("section", "cross-section other than a solid circle; contacts and drag use radius_m", {}, "type")
          .or_word("circle"),
      section_keys(), OwnSection());
  table.required(number_key("density_kg_m3", "density")
                     .in("kg/m^3")
                     .positive(1e6)
                     .plausibly(10, 25000, "water has 1000, steel 7850")
                     .also_called({"rho"})
                     .on_sobol(10),
                 &Rods::density_kg_m3);
  table.required(number_key("youngs_modulus_pa", "Young's modulus, for bending")
                     .in("Pa")
                     .positive(1e15)
                     .plausibly(1e3, 2e12, "rubber has 1e6 to 1e8, steel 2e11")
                     .also_called({"bending_modulus_pa", "elastic_modulus_pa", "e", "y"})
                     .on_sobol(0),
                 &Rods::youngs_modulus_pa);
  table.required(number_key("torsion_modulus_pa", "torsion modulus, for twisting and shear")
                     .in("Pa")
                     .positive(1e15)
                     .plausibly(1e3, 2e12, "rubber has 3e5 to 3e7, steel 8e10")
                     .also_accepted_as("shear_modulus_pa")
                     .also_called({"g", "t"})
                     .on_sobol(3),
                 &Rods::torsion_modulus_pa);
  table.optional(
      angle_key("initial_angle_deg",
                "initial angle from the horizontal; bundles: of the outermost rods from the vertical", -360, 360)
          .on_sobol(2),
      &BendingRod::initial_angle_deg, &Bundle::initial_angle_deg, &Lattice::initial_angle_deg);
  table.optional(vector_key("gravity_m_s2", "acceleration of gravity")
                     .in("m/s^2")
                     .from(-1e6, 1e6)
                     .plausibly(0, 300, "the Earth has 9.81"),
                 &Rods::gravity_m_s2);
  table.optional(number_key("damping_per_s", "viscous damping: velocities decay at this rate").in("1/s").from(0, 1e6),
                 &Rods::damping_per_s);
  table.optional(
      number_key("internal_damping_s", "damping of the material, tau of stress E (strain + tau d strain / dt)")
          .in("s")
          .from(0, 1e6),
      &Rods::internal_damping_s);
  table.optional(vector_key("tip_force_n",
                            "constant force on the free end; lattices: total force on the nodes with the greatest x")
                     .in("N")
                     .from(-1e12, 1e12),
                 tip_force_n);
  table.optional(
      vector_key("tip_torque_nm", "constant torque on the free end, fixed in the world").in("N m").from(-1e12, 1e12),
      &OpenRod::tip_torque_nm);
  table.optional(object_key("tip_motion", "prescribed motion of the end, which is held as \"clamp\" says, or by a wall")
                     .or_word("free"),
                 tip_motion_keys(), &OpenRod::tip_motion);
  table.optional(choice_key("stretch",
                            "stiffness against stretch and shear: chosen from the expected forces, or EA and kappa G A "
                            "(kappa of the section)"),
                 Words<Stretch>{{"inextensible", Stretch::inextensible}, {"physical", Stretch::physical}},
                 &Rods::stretch);
  table.optional(number_key("stretch_compliance_per_j",
                            "compliance of the stretch and shear constraints; \"from_stretch\": as set by \"stretch\"")
                     .in("1/J")
                     .from(0, 1e6)
                     .or_word("from_stretch"),
                 &Rods::stretch_compliance_per_j);
  table.optional(object_key("wind", "motion of the air around the rods; segments have quadratic drag").or_word("none"),
                 wind_keys(), &Rods::wind);
  table.optional(obstacles_key(), &Rods::obstacles);
  table.optional(loads_key(), [](Rods& rods) -> std::vector<PrescribedLoad>& { return rods.prescribed.loads; });
  table.optional(motions_key(), [](Rods& rods) -> std::vector<PrescribedMotion>& { return rods.prescribed.motions; });
  table.optional(gravity_changes_key(),
                 [](Rods& rods) -> std::vector<GravityChange>& { return rods.prescribed.gravity; });
}

void add_trees(Table& table) {
  using Shape = TreeShape;
  table.required(integer_key("depth", "levels of branching of a tree").from(0, 100), shape(&Shape::depth));
  table.required(integer_key("branches", "new branches at the end of each branch").from(1, 100),
                 shape(&Shape::branches));
  table.optional(number_key("length_ratio", "length of a branch over that of its parent").positive(10),
                 shape(&Shape::length_ratio));
  table.optional(
      number_key("taper", "end radius of a branch over its start radius; 1: only the pipe model").positive(1),
      shape(&Shape::taper));
  table.optional(
      number_key("pipe_exponent", "e of the pipe model r^e = r_1^e + r_2^e + ... at every branching of a tree")
          .from(0.5, 10),
      shape(&Shape::pipe_exponent));
  table.optional(angle_key("branching_angle_deg", "angle between a branch and its parent", 0, 150),
                 shape(&Shape::branching_angle_deg));
  table.optional(angle_key("angle_spread_deg", "maximum deviation from branching_angle_deg", 0, 150),
                 shape(&Shape::angle_spread_deg));
  table.optional(
      choice_key("phyllotaxis",
                 "direction of branches around their parent: by the golden angle from one to the next, or random"),
      Words<Shape::Phyllotaxis>{{"golden", Shape::Phyllotaxis::golden}, {"random", Shape::Phyllotaxis::random}},
      shape(&Shape::phyllotaxis));
  table.optional(integer_key("tree_seed", "seed of the random parts of a tree or forest").from(0, 1e15),
                 shape(&Shape::seed));
  table.optional(number_key("modulus_exponent", "both moduli of a branch are proportional to its radius to this power")
                     .from(-4, 4),
                 &Tree::modulus_exponent, &SkeletonTree::modulus_exponent);
  table.required(length_key("spacing_m", "distance between neighbouring trees of a forest"), &Forest::spacing_m);
  table.optional(number_key("jitter", "range of the random displacement of a tree, relative to the spacing").from(0, 1),
                 &Forest::jitter);
  table.required(file_key("skeleton", FileKind::skeleton, "SWC file of a tree: id, type, x, y, z, radius, parent"),
                 &SkeletonTree::trees);
  table.optional(length_key("skeleton_unit_m", "length unit of the skeleton file"), &SkeletonTree::unit_m);
  table.optional(choice_key("skeleton_up", "axis of the skeleton file that points up"),
                 Words<Up>{{"y", Up::y}, {"z", Up::z}}, &SkeletonTree::up);
}

void add_curves(Table& table) {
  const auto how = [](auto CurveCut::*member) {
    return [member](Curves & curves) -> auto& { return curves.how.*member; };
  };
  table.required(
      file_key("curves", FileKind::curves, "file of lines through points: .csv, .txt, .json or .obj (docs/curves.md)"),
      &Curves::curves);
  table.optional(length_key("curves_unit_m", "length unit of the curves' file"), &Curves::unit_m);
  table.optional(choice_key("interpolation", "between the points of a curve: straight lines, or a smooth spline"),
                 Words<Interpolation>{{"linear", Interpolation::linear}, {"spline", Interpolation::spline}},
                 how(&CurveCut::interpolation));
  table.optional(number_key("segment_m", "greatest length of a segment of a curve; 0: a segment from point to point")
                     .in("m")
                     .from(0, 1e6),
                 how(&CurveCut::segment_m));
  table.optional(
      number_key("join_m", "curves are joined at points that are not farther apart; 0: a millionth of their extent")
          .in("m")
          .from(0, 1e6),
      how(&CurveCut::join_m));
  table.optional(choice_key("held_ends", "what is clamped: nothing, or the ends at which curves are not joined"),
                 Words<HeldPoints>{{"none", HeldPoints::none}, {"all", HeldPoints::ends}}, how(&CurveCut::held));
  table.optional(list_key("held_at_m", "points of curves that are clamped, in addition",
                          vector_key("point", "a point of a curve").in("m").from(-1e6, 1e6))
                     .in("m"),
                 how(&CurveCut::held_at_m));
  table.optional(
      choice_key("curve_rest_shape", "rest shape of curves: as drawn, or straight where two edges meet"),
      Words<Curves::RestShape>{{"drawn", Curves::RestShape::drawn}, {"straight", Curves::RestShape::straight}},
      &Curves::rest_shape);
}

void add_touching(Table& table) {
  table.optional(object_key("contact", "contact of rods with each other, themselves and the floor").or_word("none"),
                 contact_keys(), &Rods::contact);
  table.required(integer_key("rods", "number of rods").from(1, 30000), &FallingRods::rods, &Bundle::rods);
  table.required(integer_key("rings", "number of rings of a chain").from(1, 30000), &RingChain::rings);
  table.required(
      length_key("height_m",
                 "distance between falling rods and to the floor; height of a coiling rod's end above the floor"),
      &FallingRods::height_m, &CoilingRod::height_m);
  table.optional(angle_key("turn_deg", "angle of each falling rod relative to the one below", -360, 360),
                 &FallingRods::turn_deg);
  table.required(number_key("feed_m_s", "downward speed of the held end of a coiling rod").in("m/s").from(0, 1e3),
                 &CoilingRod::feed_m_s);
  table.required(
      number_key("pull_m_s", "speed at which each end of a knot is pulled").in("m/s").from(0, 1e3).on_sobol(11),
      &Knot::pull_m_s);
}

}  // namespace

const KeyTable<SceneSpec>& scene_keys() {
  static const Table table = [] {
    Table keys;
    add_shapes(keys);
    add_rods(keys);
    add_trees(keys);
    add_curves(keys);
    add_touching(keys);
    return keys;
  }();
  return table;
}

Key scene_key() {
  Key type = choice_key("type", "type of the scene")
                 .unswept(
                     "to sweep over scenes, list complete scenes: \"scene\": {\"grid\": [{\"type\": \"bending_rod\", "
                     "...}, {\"type\": \"helix\", ...}]}");
  KindsOf<SceneSpec>::each([&](const auto& scene) { type.choices.emplace_back(scene.name); });
  std::vector<Key> keys{type};
  keys.insert(keys.end(), scene_keys().keys().begin(), scene_keys().keys().end());
  return object_key("scene", "the rods that are simulated", std::move(keys), type.name.c_str());
}

}  // namespace rodsweep
