// Reads skeletons of trees from SWC files, as written by tools that reconstruct trees (and neurons). One node per line:
//   id type x y z radius parent
// `parent`: the id of an earlier line, or -1 for the first node only. '#' begins a comment; the type is ignored. As in
// the original format (Cannon et al. 1998), a node's radius is that of the cylinder from its parent.
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

/// Strict: throws SkeletonError with file, line, value and the allowed values.
Skeleton parse_skeleton(const std::string& text, const std::filesystem::path& file);

/// The skeleton of a file with this content hash; read once per process.
std::shared_ptr<const Skeleton> shared_skeleton(const std::filesystem::path& file, const std::string& hash);

}  // namespace rodsweep
