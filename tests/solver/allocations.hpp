// Counts the memory allocations of this thread: malloc and its variants, also through operator new or a library.
//
// The program's own malloc replaces the C library's, so that Eigen, the standard library and PETSc are counted.
// Under the address sanitizer, the sanitizer's hook counts instead.
#pragma once

namespace rodsweep::test {

long allocations();

}  // namespace rodsweep::test
