// A PETSc call failed: a bug or lack of memory, not an error of the user. The text names the call.
#pragma once

#include <stdexcept>

namespace rodsweep {

class PetscError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace rodsweep
