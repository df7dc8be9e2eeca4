// Skeletons of trees from SWC files, which tools that reconstruct trees (and neurons) write: text, a node a line,
//   id type x y z radius parent
// `parent` the id of a line above, -1 of the first node alone. '#' begins a comment; the type is not looked at. As it
// was meant (Cannon et al. 1998), a node's radius is that of the cylinder from its parent to it.
#pragma once

#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>

#include "solver/scene/tree_skeleton.hpp"

namespace rodsweep {

/// "FILE:LINE: TEXT".
class SkeletonError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Strict: throws SkeletonError that names file, line, value and what is allowed.
Skeleton parse_skeleton(const std::string& text, const std::filesystem::path& file);

/// Of a file whose content has this hash, read once a process.
std::shared_ptr<const Skeleton> shared_skeleton(const std::filesystem::path& file, const std::string& hash);

}  // namespace rodsweep
