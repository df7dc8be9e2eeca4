// Contact in a job, and the scenes that are made for it: their keys, and what they describe.
#pragma once

#include <optional>
#include <vector>

#include "runner/job/key.hpp"
#include "runner/job/sweep_space.hpp"
#include "solver/scene/scenes.hpp"

namespace rodsweep {

/// `contact` of every scene, and what only scenes of rods that touch each other have.
std::vector<Key> contact_keys();

/// At a parameter point; nothing where there is "none".
std::optional<ContactSettings> contact_settings(const Point& point);

// Scenes without what all scenes share.
FallingRods falling_rods(const Point& point);
CoilingRod coiling_rod(const Point& point);
Knot knot(const Point& point);
RingChain ring_chain(const Point& point);
Bundle bundle(const Point& point);

}  // namespace rodsweep
