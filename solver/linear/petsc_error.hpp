// A PETSc call that failed: a bug or an exhausted machine, never the user's input. The text names the call.
#pragma once

#include <stdexcept>

namespace rodsweep {

class PetscError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace rodsweep
