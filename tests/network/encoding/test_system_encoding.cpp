// The encoding `linear_system` is invariant when a scene turns or is mirrored, or when its frames roll.
#include <string>

#include "network/guess/coping_net_guess.hpp"
#include "tests/catch.hpp"
#include "tests/network/models.hpp"
#include "tests/solver/turned.hpp"

namespace rodsweep::test_system_encoding {

Scene rolled(Scene scene) {
  for (Rod& rod : scene.rods) rod = test::rolled(rod, 2.1);
  return scene;
}

CopingNetSettings settings_of(Processor processor) {
  CopingNetSettings settings;
  settings.base = BaseGuess::none;
  settings.processor = processor;
  settings.latent = 16;
  return settings;
}

CopingNetSettings of_all_couplings() {
  CopingNetSettings settings = settings_of(Processor::factors);
  settings.couplings = Couplings::all;
  return settings;
}

/// Errors of a guess with random weights over the errors of zero, squared energy norms, for each system.
std::vector<double> left(Scene scene, const CopingNetSettings& settings) {
  CopingNetGuess guess(test::random_model(settings), scene, 3);
  std::vector<double> out;
  int seen = 0;
  test::observe(scene, [&](const LinearSystem& system) {
    VectorX x0(system.rhs().size()), solution(x0.size()), ax(x0.size());
    BlockFactor(system.matrix(), root_to_leaf_order(scene.rods[0])).solve(system.matrix(), system.rhs(), solution);
    guess.propose(system, {seen / 3, seen % 3, 0}, x0);
    ++seen;
    out.push_back(energy_norm_squared(system.matrix(), x0 - solution, ax) /
                  energy_norm_squared(system.matrix(), solution, ax));
  });
  return out;
}

TEST_CASE("to a network with canonical frames turned, mirrored and rolled scenes are one") {
  const CopingNetSettings settings =
      GENERATE(settings_of(Processor::message_passing), settings_of(Processor::factors), of_all_couplings());
  for (const test::TurnedCase& each : test::turned_cases()) {
    if (std::string(each.name) == "ring") continue;  // only rounding gives its residual an axis and a handedness
    const bool lattice = std::string(each.name) == "lattice";
    INFO(each.name);
    const std::vector<double> original = left(each.scene, settings);
    std::vector<Scene> images{test::mirrored(each.scene)};
    if (!lattice) {  // compliance at its nodes depends on the axes of its frames
      images.push_back(rolled(each.scene));
      images.push_back(rolled(test::mirrored(each.scene)));
    }
    for (const test::RigidMotion& motion : test::motions) images.push_back(moved(each.scene, motion));
    for (const Scene& image : images) {
      const std::vector<double> same = left(image, settings);
      REQUIRE(same.size() == original.size());
      // In the first step a helix's residual is planar: its handedness is rounding, and random factors amplify it. A
      // lattice's residual is its own mirror image.
      const bool handed = settings.processor != Processor::factors && !lattice;
      for (std::size_t i = handed ? 0 : 3; i < same.size(); ++i)
        CHECK(same[i] == Approx(original[i]).epsilon(i < 3 ? 2e-2 : 1e-3));
    }
  }
}

TEST_CASE("frames are orthogonal, and units come back") {
  Scene scene = build_scene(test::bending_rod(6));
  const Rod& rod = scene.rods[0];
  test::observe(scene, [&](const LinearSystem& system) {
    FeatureEncoder encoder(settings_of(Processor::message_passing), rod, system.matrix());
    Tensor<float> nodes(0, 6), edges(SystemEncoding::size, 5);
    encoder.encode(rod, system, 0, VectorX(), system.rhs(), nodes, edges);
    CHECK(edges.topRows(6).squaredNorm() / 30 == Approx(1).epsilon(1e-5));  // the root mean square of r^ is one
    const Lane8 v = {0.3, -1, 2, 0.7, 5, -0.2, 0, 0};
    for (int place = 0; place < 5; ++place) {
      const CanonicalFrame& frame = encoder.system()->frames().frame(place);
      const Lane8 turned = frame(v), back = frame.back(turned);
      const Lane8 there = encoder.system()->to_unit(place, encoder.system()->from_unit(place, v));
      for (int i = 0; i < 6; ++i) {
        CHECK(back[i] == Approx(v[i]));
        CHECK(there[i] == Approx(v[i]));
      }
    }
  });
}

}  // namespace rodsweep::test_system_encoding
