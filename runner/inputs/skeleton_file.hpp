// Reads skeletons of trees from SWC files, as written by tools that reconstruct trees (and neurons). One node per line:
//   id type x y z radius parent
// `parent`: the id of another line, or negative for a root. As in the original format (Cannon et al. 1998), a node's
// radius is that of the cylinder from its parent. '#' begins a comment.
//
// Files of the world deviate. Read without a word: parents below their children, ids of 64 bits or with ".0", commas,
// tabs and all ends of lines, a byte order mark. Read with a warning: more than 7 columns (ignored), radius 0 (the
// parent's), a node at its parent's place (left out), a root without children (left out), a soma of three points (its
// centre). Refused with the line: anything that is no number, a negative radius, a parent that is not there, loops.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "runner/text/formatted_error.hpp"
#include "solver/scene/tree_skeleton.hpp"

namespace rodsweep {

/// "FILE:LINE: TEXT".
struct SkeletonError : FormattedError<> {
  using FormattedError::FormattedError;
};

struct SkeletonFile {
  std::vector<Skeleton> trees;  ///< one for each root
  std::vector<std::string> warnings;
};

/// Throws SkeletonError with file, line, value and the allowed values.
SkeletonFile parse_skeleton(const std::string& text, const std::filesystem::path& file);

/// The skeletons of a file with this content hash; read once per process.
const SkeletonFile& shared_skeleton(const std::filesystem::path& file, const std::string& hash);

}  // namespace rodsweep
