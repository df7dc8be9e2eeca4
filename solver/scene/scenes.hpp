// The scenes of jobs, each a struct of its parameters (SI units): the bending rod and the hanging helix of Shao et al.
// 2021, a ring, nets and lattices, trees, and rods in contact. A scene's struct has its name in jobs and, in a source
// of its kind:
//
//   check()  throws SceneError with the bound if parameters do not fit together
//   size()   counts segments, joints and rods without building them
//   build()  adds its rods, loads, solids and moving clamps to an empty scene
#pragma once

#include <memory>
#include <optional>
#include <variant>
#include <vector>

#include "solver/numbers/types.hpp"
#include "solver/scene/curve_graph.hpp"
#include "solver/scene/scene.hpp"
#include "solver/scene/tree_skeleton.hpp"

namespace rodsweep {

/// The most rods of a scene: results number them in 16 bits.
constexpr int most_rods = 32767;

struct SceneSize {
  int segments = 0;               ///< graph nodes
  int joints = 0;                 ///< graph edges
  int rods = 1;                   ///< at most `most_rods`
  const char* rods_key = "rods";  ///< the scene's keys that set it
};

enum class Clamp {
  segment,  ///< holds the whole first segment: free length L - L/N
  wall,     ///< adds a static segment of zero length and a first joint of half length: an exact clamp, not for a ring
  free      ///< holds nothing
};

enum class Stretch {
  inextensible,  ///< see inextensible_compliance()
  physical       ///< EA along the rod, kappa G A across it, see Section
};

// Cross-sections (cross_section.hpp). A rectangle or an ellipse has its height upwards in a bending rod, outwards in a
// helix or a ring. Contacts and drag are those of the rod's radius, which is the outer one of a tube.
struct Tube {
  static constexpr const char* name = "tube";
  double wall_m = 0;
};
struct Ellipse {
  static constexpr const char* name = "ellipse";
  double width_m = 0, height_m = 0;
};
struct Rectangle {
  static constexpr const char* name = "rectangle";
  double width_m = 0, height_m = 0;
};
struct GivenSection {
  static constexpr const char* name = "numbers";
  double area_m2 = 0, second_moment_width_m4 = 0, second_moment_height_m4 = 0, torsion_constant_m4 = 0;
  double shear_coefficient = 1;
};
using SectionShape = std::variant<Tube, Ellipse, Rectangle, GivenSection>;

/// The parameters of all scenes.
struct RodParameters {
  double radius_m = 0.05;
  std::optional<SectionShape> section;  ///< empty: a solid circle
  double density_kg_m3 = 1000;
  double youngs_modulus_pa = 1e5;
  double torsion_modulus_pa = 1e6;
  Vector3 gravity_m_s2{0, -9.81, 0};
  double damping_per_s = 0, internal_damping_s = 0;
  Stretch stretch = Stretch::inextensible;
  std::optional<double> stretch_compliance_per_j;  ///< of the three stretch-shear rows [1/J], instead of `stretch`
  std::optional<WindParameters> wind;
  std::optional<ContactSettings> contact;
  std::vector<Obstacle> obstacles;  ///< in addition to a scene's own floor
  Prescribed prescribed;
  bool may_stretch() const { return stretch == Stretch::physical || stretch_compliance_per_j; }
};

/// The end of a rod moves by a displacement, and by a rotation about an axis in the world, in a time; then it rests.
struct TipMotion {
  Vector3 displacement_m{0, 0, 0};
  Vector3 rotation_deg{0, 0, 0};
  double duration_s = 1;
  Quaternion rotation(double done) const;  ///< after this part of it
};

/// A rod with two ends. Its tip bears a dead load, or moves as prescribed: held as `clamp` holds the first end, or by a
/// wall if the first end is free.
struct OpenRod : RodParameters {
  int segments = 30;
  Clamp clamp = Clamp::segment;
  Vector3 tip_force_n{0, 0, 0}, tip_torque_nm{0, 0, 0};
  std::optional<TipMotion> tip_motion;
  bool has_tip_load() const { return !tip_force_n.isZero(0) || !tip_torque_nm.isZero(0); }
  bool has_end_wall() const { return tip_motion && clamp != Clamp::segment; }
  void check() const;
  SceneSize size() const;
};

/// Straight and at rest, its first end at the origin, pointing along +x raised by `initial_angle_deg` towards +y;
/// gravity bends it.
struct BendingRod : OpenRod {
  static constexpr const char* name = "bending_rod";
  double length_m = 2;
  double initial_angle_deg = 0;
  Vector3 vertex_m(int joint) const;
  void check() const;
  void build(Scene& scene) const;
};

/// Joints on the curve (R cos t, -H t / (2 pi windings), R sin t), t in [0, 2 pi windings]. The axis is vertical (y),
/// and the rod hangs from its first segment; the rest shape is the initial shape.
struct Helix : OpenRod {
  static constexpr const char* name = "helix";
  double helix_radius_m = 0.5;
  double helix_height_m = 0.5;
  double windings = 2.5;
  double turned(double joint) const;  ///< t [rad]
  Vector3 vertex_m(int joint) const;
  void check() const;
  void build(Scene& scene) const;
};

/// A closed regular polygon in the vertical xy-plane below the origin, which is the middle of its first and topmost
/// side. It is naturally straight or circular, and twisted by a total angle before its ends are joined.
struct Ring : RodParameters {
  static constexpr const char* name = "ring";
  enum class RestShape { straight, circle };
  int segments = 30;
  Clamp clamp = Clamp::segment;
  double length_m = 2;  ///< circumference
  double twist_deg = 0;
  RestShape rest_shape = RestShape::straight;
  void check() const;
  SceneSize size() const;
  void build(Scene& scene) const;
};

/// The held segments of a net or a lattice.
enum class Held {
  side,     ///< the crossings of a net's first rod along x; the nodes of a lattice with the least x
  corners,  ///< the four corners of a net; the eight corners of a lattice's box
  free      ///< nothing
};

/// `rows` rods along x and `columns` rods along z in the horizontal plane, the first ones crossing at the origin. Where
/// rods cross, the centres of their segments are joined at the angle that they have there, with the stiffness EI / l
/// about every axis: one rod of many loops. A held crossing is a point that clamps all rods through it.
struct Net : RodParameters {
  static constexpr const char* name = "net";
  int rows = 5, columns = 5;
  int segments = 1;  ///< from one crossing to the next
  double mesh_m = 0.2;
  Held held = Held::corners;
  void check() const;
  SceneSize size() const;
  void build(Scene& scene) const;
};

/// Straight rods through all nodes of a crystal lattice in a box, the first corner at the origin; the box is raised by
/// `initial_angle_deg` about z, from x towards y. Where rods cross, the centres of their segments are joined to that of
/// the first of them. Each joint is as stiff as `node_stiffness` rods two radii long: kappa G A / 2r against shifting,
/// EI / 2r against rotation about every axis. Every rod extends half a segment beyond its last nodes, so the
/// material of a node counts once for every rod through it. The lattice is one rod of many loops with more constraints
/// than degrees of freedom. Stretch is `physical` by default, because multipliers of rigid joints are not unique.
struct Lattice : RodParameters {
  static constexpr const char* name = "lattice";
  enum class Cell {
    cubic,         ///< rods along the edges of the cells
    body_centred,  ///< along their diagonals: nodes are corners and centres
    octet          ///< along the diagonals of their faces: nodes are corners and centres of faces
  };
  Cell cell = Cell::cubic;
  int nodes_x = 4;               ///< corners of cells along x
  int nodes_y = 0, nodes_z = 0;  ///< 0: as nodes_x
  double mesh_m = 0.2;           ///< edge of a cell
  int segments = 3;              ///< from one node to the next
  Held held = Held::corners;
  double node_stiffness = 1;
  double initial_angle_deg = 0;
  Vector3 tip_force_n{0, 0, 0};  ///< shared by the nodes with the greatest x
  Lattice() { stretch = Stretch::physical; }
  void check() const;
  SceneSize size() const;
  void build(Scene& scene) const;
};

/// A grown tree (tree_skeleton.hpp) with a segment for every edge, on the ground in an exact clamp (a static segment of
/// zero length at the root). Both moduli of an edge of radius r are those of the widest edge at the ground times (r /
/// its radius)^`modulus_exponent`. An edge is a cone: the segment is the cylinder of its volume, and joints have the
/// cone's compliance. A joint is half of one edge and half of the next in series; at a fork it is half of its branch
/// alone, and the joint below carries the whole edge below (tree_scenes.cpp). An "inextensible" joint is stiff enough
/// for the weight above it. The initial shape is without load: at first gravity makes it sag a little.
struct Tree : RodParameters {  ///< radius and moduli: those of the trunk at the ground
  static constexpr const char* name = "tree";
  TreeShape shape;
  double modulus_exponent = 0;
  void check() const;
  SceneSize size() const;
  void build(Scene& scene) const;
};

/// Trees of one shape with different seeds on a grid along x and z, the first near the origin. Each is displaced by up
/// to half of `jitter` spacings along both axes. Each tree is a rod.
struct Forest : Tree {
  static constexpr const char* name = "forest";
  int rows = 3, columns = 3;  ///< along z and x
  double spacing_m = 3;
  double jitter = 0.5;
  void check() const;
  SceneSize size() const;
  void build(Scene& scene) const;
};

/// Measured trees. Their radii are the skeleton's: an edge is a cone from its lower node's to its upper's. At a fork,
/// every branch begins with the radius of its own first node: thin twigs leave thick trunks.
struct SkeletonTree : RodParameters {
  static constexpr const char* name = "skeleton";
  std::shared_ptr<const std::vector<Skeleton>> trees;  ///< each a rod
  double unit_m = 1;                                   ///< unit of its lengths
  Up up = Up::y;
  double modulus_exponent = 0;
  void check() const;
  SceneSize size() const;
  void build(Scene& scene) const;
};

/// Curves as drawn (curve_graph.hpp): an edge is a cone between the radii of its nodes, a segment the cylinder of its
/// volume. What is connected is one rod. Joints have the halves of the two edges that meet (softness.hpp). Where three and
/// more edges meet, all are joined to the widest: each with its half, and the widest one's half belongs to the joint at its
/// other end, a shift of compliance of second order in edge lengths. A held node is an exact clamp of all its edges.
struct Curves : RodParameters {  ///< radius, moduli and density: of curves without their own
  static constexpr const char* name = "curves";
  enum class RestShape { drawn, straight };  ///< straight: without bends between the two edges of a node
  std::shared_ptr<const std::vector<Curve>> curves;
  double unit_m = 1;  ///< unit of their points and radii
  CurveCut how;
  RestShape rest_shape = RestShape::drawn;
  /// Kept until curves are cut otherwise: a plan asks for sizes of many equal graphs in a row.
  std::shared_ptr<const CurveGraph> graph() const;
  void check() const;
  SceneSize size() const;
  void build(Scene& scene) const;
};

/// Scenes whose rods touch have contact, unless it is switched off.
struct TouchingRods : RodParameters {
  TouchingRods() { contact = ContactSettings{}; }
};

/// Horizontal rods, each `height_m` above the one below or the floor y = 0, rotated against it by `turn_deg`.
struct FallingRods : TouchingRods {
  static constexpr const char* name = "falling_rods";
  int rods = 8;
  int segments = 10;
  double length_m = 1;
  double height_m = 0.2;
  double turn_deg = 50;
  void check() const;
  SceneSize size() const;
  void build(Scene& scene) const;
};

/// A vertical rod, straight except for a hundredth of a turn of a helix of its own radius. Its lower end is `height_m`
/// above the floor y = 0. Its first and topmost segment is held and moves down at `feed_m_s`.
struct CoilingRod : TouchingRods {
  static constexpr const char* name = "coiling_rod";
  int segments = 60;
  double length_m = 2;
  double height_m = 0.1;
  double feed_m_s = 1;
  void check() const;
  SceneSize size() const;
  void build(Scene& scene) const;
};

/// An overhand knot in a naturally straight rod, loose at first (an opened trefoil between straight ends along x). Its
/// end segments are held and move apart along x, each at `pull_m_s`.
struct Knot : TouchingRods {
  static constexpr const char* name = "knot";
  int segments = 80;
  double length_m = 5;
  double pull_m_s = 0.2;
  void check() const;
  SceneSize size() const;
  void build(Scene& scene) const;
};

/// Naturally circular rings, each hanging through the one above at right angles to it, the first one from its first
/// segment.
struct RingChain : TouchingRods {
  static constexpr const char* name = "ring_chain";
  int rings = 5;
  int segments = 16;    ///< of each
  double length_m = 2;  ///< circumference
  void check() const;
  SceneSize size() const;
  void build(Scene& scene) const;
};

/// Rods in hexagonal packing, a tenth of a radius apart, that hang from their first segments, splayed by up to
/// `initial_angle_deg` outwards.
struct Bundle : TouchingRods {
  static constexpr const char* name = "bundle";
  int rods = 100;
  int segments = 10;
  double length_m = 1;
  double initial_angle_deg = 0;
  void check() const;
  SceneSize size() const;
  void build(Scene& scene) const;
};

using SceneSpec = std::variant<BendingRod, Helix, Ring, Net, Lattice, Tree, Forest, SkeletonTree, Curves, FallingRods,
                               CoilingRod, Knot, RingChain, Bundle>;

/// The scene's rod if it is a single rod with two ends, else null.
const OpenRod* open_rod(const SceneSpec& spec);

/// The parameters that all scenes share.
const RodParameters& rod_parameters(const SceneSpec& spec);

/// Throws SceneError if parameters do not fit together, and for more than `most_rods`; build_scene() does so too.
void validate(const SceneSpec& spec);

Scene build_scene(const SceneSpec& spec);

// Counts of a scene that is not built, for the plan.
SceneSize size_of(const SceneSpec& spec);
inline int segment_count(const SceneSpec& spec) { return size_of(spec).segments; }
inline int joint_count(const SceneSpec& spec) { return size_of(spec).joints; }
inline int rod_count(const SceneSpec& spec) { return size_of(spec).rods; }

}  // namespace rodsweep
