// The one check for PETSc calls. Included by sources only: PETSc stays out of the solver's headers. It throws, so it is
// not for what PETSc calls back: an exception may not cross its C frames, and such functions are noexcept.
#pragma once

#include <petscsys.h>

#include <new>
#include <string>

#include "solver/linear/petsc_error.hpp"

namespace rodsweep {

inline void petsc_check(PetscErrorCode code, const char* call) {
  if (code == 0) return;
  if (code == PETSC_ERR_MEM) throw std::bad_alloc();
  const char* text = nullptr;
  PetscErrorMessage(code, &text, nullptr);
  throw PetscError(std::string(call) + " failed with PETSc error " + std::to_string(code) +
                   (text ? std::string(": ") + text : ""));
}

}  // namespace rodsweep
