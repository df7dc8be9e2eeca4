/* The plug-in of the tests: the last solution of the same rod and Newton iteration, and the diagonal as preconditioner. Its
 * options ask for other things: "b": x0 = A b; "products N": zero, of N products; "nan": x0 and z are not numbers; "create",
 * "propose", "accept", "set_up", "apply": an error there; "none": no preconditioner; "rounds": each function changes how
 * numbers are rounded; "endless": propose returns when it is interrupted;
 * "forks": it returns twice. */
#include <fenv.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "solver/plugin/plugin.h"

enum { most_rods = 16, most_newton = 16 };

struct guess {
  char options[32];
  int joints[most_rods];
  double* last[most_rods][most_newton];
  int step[most_rods][most_newton];
  double* inverse_diagonal;
};

static volatile int interrupted;

void rodsweep_plugin_interrupt(void) { interrupted = 1; }

/* Does to the process what "rounds" asks for. */
static void disturb(const struct guess* self) {
  if (strcmp(self->options, "rounds") != 0) return;
  fesetround(FE_UPWARD);
#ifdef __SSE2__
  __builtin_ia32_ldmxcsr(__builtin_ia32_stmxcsr() | 0x8040); /* tiny numbers are zero */
#endif
}

static void* create(const char* options, const rodsweep_rod* rods, int count, char* error) {
  struct guess* self = calloc(1, sizeof *self);
  snprintf(self->options, sizeof self->options, "%s", options);
  if (strcmp(options, "create") == 0 || count > most_rods) {
    snprintf(error, RODSWEEP_ERROR_BYTES, "no guess for %d rods", count);
    free(self);
    return NULL;
  }
  disturb(self);
  for (int rod = 0; rod < count; ++rod) {
    self->joints[rod] = rods[rod].joints;
    for (int newton = 0; newton < most_newton; ++newton) {
      self->last[rod][newton] = calloc((size_t)(6 * rods[rod].joints), sizeof(double));
      self->step[rod][newton] = -2;
    }
  }
  return self;
}

static void destroy(void* instance) {
  struct guess* self = instance;
  disturb(self);
  for (int rod = 0; rod < most_rods; ++rod)
    for (int newton = 0; newton < most_newton; ++newton) free(self->last[rod][newton]);
  free(self->inverse_diagonal);
  free(self);
}

static void multiply(const rodsweep_system* system, const double* x, double* y) {
  for (int i = 0; i < 6 * system->joints; ++i) y[i] = 0;
  for (int row = 0; row < system->joints; ++row)
    for (int k = system->row_begin[row]; k < system->row_begin[row + 1]; ++k)
      for (int r = 0; r < 6; ++r)
        for (int c = 0; c < 6; ++c)
          y[6 * row + r] += system->blocks[48 * k + 8 * c + r] * x[6 * system->columns[k] + c];
}

static int propose(void* instance, const rodsweep_system* system, double* x0, int* products, char* error) {
  struct guess* self = instance;
  const size_t bytes = (size_t)(6 * system->joints) * sizeof(double);
  if (strcmp(self->options, "propose") == 0) {
    snprintf(error, RODSWEEP_ERROR_BYTES, "no guess in step %d", system->step);
    return -1;
  }
  disturb(self);
  if (strcmp(self->options, "endless") == 0) {
    for (interrupted = 0; !interrupted;) usleep(1000);
    snprintf(error, RODSWEEP_ERROR_BYTES, "given up in step %d", system->step);
    return -1;
  }
  if (strcmp(self->options, "forks") == 0) {
    int status = 0;
    const pid_t child = fork();
    if (child > 0) waitpid(child, &status, 0);
    x0[0] = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    return 1;
  }
  if (sscanf(self->options, "products %d", products) == 1) return 0;
  if (strcmp(self->options, "b") == 0) {
    multiply(system, system->b, x0);
    *products = 1;
    return 1;
  }
  if (self->step[system->rod][system->newton] != system->step - 1) return 0;
  memcpy(x0, self->last[system->rod][system->newton], bytes);
  if (strcmp(self->options, "nan") == 0) x0[0] = 0.0 / 0.0;
  return 1;
}

static int accept(void* instance, const rodsweep_system* system, const double* solution, char* error) {
  struct guess* self = instance;
  disturb(self);
  if (strcmp(self->options, "accept") == 0) {
    snprintf(error, RODSWEEP_ERROR_BYTES, "the solution of step %d is not wanted", system->step);
    return -1;
  }
  memcpy(self->last[system->rod][system->newton], solution, (size_t)(6 * system->joints) * sizeof(double));
  self->step[system->rod][system->newton] = system->step;
  return 0;
}

static int set_up(void* instance, const rodsweep_system* system, char* error) {
  struct guess* self = instance;
  disturb(self);
  if (strcmp(self->options, "set_up") == 0) {
    snprintf(error, RODSWEEP_ERROR_BYTES, "no preconditioner in step %d", system->step);
    return -1;
  }
  if (!self->inverse_diagonal) self->inverse_diagonal = calloc((size_t)(6 * system->joints), sizeof(double));
  for (int row = 0; row < system->joints; ++row)
    for (int k = system->row_begin[row]; k < system->row_begin[row + 1]; ++k)
      for (int r = 0; r < 6 && system->columns[k] == row; ++r)
        self->inverse_diagonal[6 * row + r] = 1 / system->blocks[48 * k + 9 * r];
  return strcmp(self->options, "none") != 0;
}

static int apply(void* instance, const double* r, double* z, char* error) {
  const struct guess* self = instance;
  disturb(self);
  if (strcmp(self->options, "apply") == 0) {
    snprintf(error, RODSWEEP_ERROR_BYTES, "not applied");
    return -1;
  }
  for (int i = 0; i < 6 * self->joints[0]; ++i) z[i] = r[i] * self->inverse_diagonal[i];
  if (strcmp(self->options, "nan") == 0) z[0] = 0.0 / 0.0;
  return 0;
}

const rodsweep_plugin_functions* rodsweep_plugin(void) {
  static const rodsweep_plugin_functions functions = {.version = RODSWEEP_PLUGIN_VERSION,
                                                      .create = create,
                                                      .destroy = destroy,
                                                      .propose = propose,
                                                      .accept = accept,
                                                      .set_up = set_up,
                                                      .apply = apply};
  return &functions;
}
