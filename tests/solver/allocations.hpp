// How often this thread has asked for memory: malloc and its relatives, from any library, operator new included.
//
// The program's own malloc stands before the C library's, so that Eigen, the standard library and PETSc are counted
// alike. Under the address sanitizer, which has its own, the sanitizer's hook counts instead.
#pragma once

namespace rodsweep::test {

long allocations();

}  // namespace rodsweep::test
