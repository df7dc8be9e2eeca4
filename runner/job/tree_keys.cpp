#include "runner/job/tree_keys.hpp"

#include "runner/job/choice.hpp"

namespace rodsweep {

std::vector<Key> tree_keys() {
  const std::vector<std::string> grown{"tree", "forest"}, trees{"tree", "forest", "skeleton"};
  return {
      integer_key("depth", "branchings of a tree between the ground and a twig").at_least(0).at_most(100).only(grown),
      integer_key("branches", "new branches at the end of each branch of a tree").at_least(1).at_most(100).only(grown),
      number_key("length_ratio", "length of a tree's branch over that of the one it grows from")
          .above(0)
          .at_most(10)
          .defaults_to(0.75)
          .only(grown),
      number_key("taper", "radius of a tree's branch where it ends over that where it begins; 1: the pipe model's own")
          .above(0)
          .at_most(1)
          .defaults_to(1)
          .only(grown),
      number_key("pipe_exponent", "e of the pipe model r^e = r_1^e + r_2^e + ... at every branching of a tree")
          .at_least(0.5)
          .at_most(10)
          .defaults_to(2)
          .only(grown),
      number_key("branching_angle_deg", "angle between a tree's branch and the one it grows from")
          .in("deg")
          .at_least(0)
          .at_most(150)
          .defaults_to(35)
          .only(grown),
      number_key("angle_spread_deg", "by how much at most the branching angles differ from that")
          .in("deg")
          .at_least(0)
          .at_most(150)
          .defaults_to(10)
          .only(grown),
      choice_key("phyllotaxis", "how branches go around: by the golden angle from one to the next, or at random",
                 {"golden", "random"})
          .defaults_to("golden")
          .only(grown),
      integer_key("tree_seed", "which tree of all those of this shape; which forest")
          .at_least(0)
          .at_most(1e15)
          .defaults_to(0)
          .only(grown),
      number_key("modulus_exponent", "both moduli of a tree's branch grow with its radius to this power")
          .at_least(-4)
          .at_most(4)
          .defaults_to(0)
          .only(trees),
      number_key("spacing_m", "distance of neighbouring trees of a forest")
          .in("m")
          .above(0)
          .at_most(1e6)
          .only({"forest"}),
      number_key("jitter", "how much of the spacing the places of a forest's trees are spread over")
          .at_least(0)
          .at_most(1)
          .defaults_to(0.5)
          .only({"forest"}),
      file_key("skeleton", "SWC file of a tree: id, type, x, y, z, radius, parent").only({"skeleton"}),
      number_key("skeleton_unit_m", "size of the skeleton file's unit")
          .in("m")
          .above(0)
          .at_most(1e6)
          .defaults_to(1)
          .only({"skeleton"}),
      choice_key("skeleton_up", "which axis of the skeleton file points up", {"y", "z"})
          .defaults_to("y")
          .only({"skeleton"}),
  };
}

TreeShape tree_shape(const Point& point) {
  static const std::map<std::string, TreeShape::Phyllotaxis> phyllotaxes{{"golden", TreeShape::Phyllotaxis::golden},
                                                                         {"random", TreeShape::Phyllotaxis::random}};
  TreeShape shape;
  shape.depth = static_cast<int>(point.integer("scene.depth"));
  shape.branches = static_cast<int>(point.integer("scene.branches"));
  shape.segments = static_cast<int>(point.integer("scene.segments"));
  shape.length_m = point.number("scene.length_m");
  shape.length_ratio = point.number("scene.length_ratio");
  shape.taper = point.number("scene.taper");
  shape.pipe_exponent = point.number("scene.pipe_exponent");
  shape.branching_angle_deg = point.number("scene.branching_angle_deg");
  shape.angle_spread_deg = point.number("scene.angle_spread_deg");
  shape.phyllotaxis = choice(phyllotaxes, point.text("scene.phyllotaxis"));
  shape.seed = static_cast<std::uint64_t>(point.integer("scene.tree_seed"));
  return shape;
}

}  // namespace rodsweep
