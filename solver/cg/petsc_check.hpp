// The check of PETSc calls. Included by sources only: the solver's headers do not include PETSc. It throws, so
// callbacks from PETSc must not use it: an exception must not cross C frames, and callbacks are noexcept.
#pragma once

#include <petscsys.h>

#include <new>
#include <string>

#include "solver/cg/petsc_session.hpp"

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
