/* A plug-in of rodsweep: an initial guess for CG or a preconditioner, in any language that can export C functions.
 *
 * A shared library exports rodsweep_plugin(), and a job names it in its guesses, {"plugin": {"library": "libmine.so"}},
 * or as {"preconditioner": "plugin", "plugin_preconditioner": {"library": "libmine.so"}} in its "solve". Every task makes
 * instances of its own. An error ends the task with its text: write it to `error`, with a zero at the end and at most
 * RODSWEEP_ERROR_BYTES bytes, and return the value that says so. Numbers are doubles in SI units; pointers are valid
 * during the call. After a call floating-point rounding is as before, and after create and destroy the current folder.
 * docs/extending.md has an example. */
#ifndef RODSWEEP_PLUGIN_H
#define RODSWEEP_PLUGIN_H

#ifdef __cplusplus
extern "C" {
#endif

#define RODSWEEP_PLUGIN_VERSION 2
#define RODSWEEP_ERROR_BYTES 1024
#define RODSWEEP_MOST_PRODUCTS 32000 /* files store counts in 16 bits */
#ifdef __GNUC__
#define RODSWEEP_EXPORT __attribute__((visibility("default")))
#else
#define RODSWEEP_EXPORT
#endif

/* What does not change during a simulation. Joints are numbered as the block rows of A. */
typedef struct rodsweep_rod {
  int segments, joints;
  const int* joint_segments;   /* [joints][2], the segments that a joint connects */
  const double* compliance;    /* [joints][6] alpha in 1/J: across the rod (2), along it, bending (2), twisting */
  const double* length_m;      /* [segments] */
  const double* radius_m;      /* [segments] */
  const double* mass_kg;       /* [segments] */
} rodsweep_rod;

/* A x = b of a Newton iteration. A is symmetric and positive definite, in blocks of 6 x 6 in compressed block rows, both
 * triangles. x are increments of the joints' multipliers in kg m^2, in the joints' frames. */
typedef struct rodsweep_system {
  int rod, step, newton;          /* from 0; step and newton are -1 for a preconditioner */
  double dt_s;                    /* of A: with bdf2 two thirds of the time step */
  int joints, segments;
  const int* row_begin;           /* [joints + 1], first block of each block row */
  const int* columns;             /* [row_begin[joints]], block column of each block */
  const double* blocks;           /* entry (r, c) of block k: blocks[48 * k + 8 * c + r]; r of 6 and 7 are unused */
  const double* b;                /* [joints][6] */
  const double* multipliers;      /* [joints][6], of the rod before the solve */
  const double* position_m;       /* [segments][3] */
  const double* orientation;      /* [segments][4], quaternions x y z w */
} rodsweep_system;

typedef struct rodsweep_plugin_functions {
  int version; /* RODSWEEP_PLUGIN_VERSION */
  /* An instance for rods 0 to count - 1; a preconditioner has one rod. `options` is the text of the job, "" without one.
   * NULL: error. */
  void* (*create)(const char* options, const rodsweep_rod* rods, int count, char* error);
  void (*destroy)(void* instance);
  /* Writes x0 [joints][6]. Returns 1, or 0 for a guess of zero, or -1: error. `products` is 0; set it to the number of
   * products with A that were made, at most RODSWEEP_MOST_PRODUCTS. Is called several times for a system, and must give
   * the same each time. */
  int (*propose)(void* instance, const rodsweep_system* system, double* x0, int* products, char* error);
  /* Receives the system last proposed for, with its solution. Returns 0, or -1: error. May be NULL. */
  int (*accept)(void* instance, const rodsweep_system* system, const double* solution, char* error);
  /* Only within the guess "totals", before a rod's next step: receives the sum of the solutions [joints][6] of all Newton
   * iterations of a step. It is a better guess for the first iteration of the next step than the accepted solution of
   * this one's, but not the solution of any system. Returns 0, or -1: error. NULL: the guess does not use sums. */
  int (*accept_total)(void* instance, int rod, int step, const double* total, char* error);
  /* Prepares a preconditioner P for A. Returns 1, or 0 if there is none for this A (CG ends as `indefinite`), or -1:
   * error. Here and in apply, a guess has NULL; a preconditioner has NULL in propose. */
  int (*set_up)(void* instance, const rodsweep_system* system, char* error);
  /* Writes z = P^-1 r [joints][6], which must be linear, symmetric and positive definite. Returns 0, or -1: error. */
  int (*apply)(void* instance, const double* r, double* z, char* error);
} rodsweep_plugin_functions;

/* Exported by the library. */
RODSWEEP_EXPORT const rodsweep_plugin_functions* rodsweep_plugin(void);

/* The library may export this too. It is called from another thread, every second, while one of the functions above runs
 * whose result is no longer wanted (a time limit, Ctrl-C), and makes that function return soon. Without it the function is
 * waited for, up to a minute; then it counts as hung. */
RODSWEEP_EXPORT void rodsweep_plugin_interrupt(void);

#ifdef __cplusplus
}
#endif

#endif
