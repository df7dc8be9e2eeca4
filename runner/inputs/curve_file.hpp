// Reads curves from files of lines through points. The ending of the name tells the format:
//
//   .csv, .txt   a point per line, "x y z" or "x y z radius", between spaces, tabs, commas or semicolons; a blank line
//                begins the next curve; '#' begins a comment. A first line of names says which column is which; the
//                first column may be an index without a name, which is left out
//   .json        {"curves": [{"points": [[x, y, z], ...], "radius": 0.01, ...}]}; "radius" may be a list, one for each
//                point; also "name", "youngs_modulus_pa", "torsion_modulus_pa", "density_kg_m3"
//   .obj         "v x y z" and "l 1 2 3"; other elements are ignored
//
// Quotes, capitals in names, plus signs and all ends of lines are accepted. Refused, with the line or the key: what is
// not a finite number, such as an empty field; a radius that is not positive; curves of one point.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "runner/text/formatted_error.hpp"
#include "solver/scene/curve_graph.hpp"

namespace rodsweep {

/// "FILE:LINE: TEXT", in JSON "FILE: KEY: TEXT".
struct CurveError : FormattedError<> {
  using FormattedError::FormattedError;
};

std::vector<Curve> parse_curves(const std::string& text, const std::filesystem::path& file);

/// The curves of a file with this content hash; read once per process.
const std::vector<Curve>& shared_curves(const std::filesystem::path& file, const std::string& hash);

}  // namespace rodsweep
