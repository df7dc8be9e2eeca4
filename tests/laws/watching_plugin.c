/* A guess that watches the calls: it proposes a part of the last solution, and reports an error if accept() gets another
 * system than the one last proposed for, or x that does not solve it, or if accept_total() gets another sum than that of
 * the solutions that it accepted (options "sums"). As a preconditioner it is the diagonal, made wrong by its options:
 * "first": zero beyond the first joint; "nothing": z is not written; "every other": each second entry is zero; "negative":
 * the last entry has the other sign. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "solver/plugin/plugin.h"

enum { most_rods = 16 };

struct rod {
  int joints, step, newton, summed_step;
  uint64_t seen; /* a checksum of the system last proposed for; 0: none */
  double *last, *sum, *product;
};

struct watcher {
  char options[32];
  int count;
  struct rod rods[most_rods];
  double* inverse_diagonal;
};

static void* create(const char* options, const rodsweep_rod* rods, int count, char* error) {
  struct watcher* self = calloc(1, sizeof *self);
  (void)error;
  snprintf(self->options, sizeof self->options, "%s", options);
  self->count = count;
  for (int rod = 0; rod < count; ++rod) {
    struct rod* own = &self->rods[rod];
    const size_t size = (size_t)(6 * rods[rod].joints);
    own->joints = rods[rod].joints;
    own->summed_step = -1;
    own->last = calloc(size, sizeof(double));
    own->sum = calloc(size, sizeof(double));
    own->product = calloc(size, sizeof(double));
  }
  self->inverse_diagonal = calloc(count > 0 ? (size_t)(6 * rods[0].joints) : 1, sizeof(double));
  return self;
}

static void destroy(void* instance) {
  struct watcher* self = instance;
  for (int rod = 0; rod < self->count; ++rod) {
    free(self->rods[rod].last);
    free(self->rods[rod].sum);
    free(self->rods[rod].product);
  }
  free(self->inverse_diagonal);
  free(self);
}

static uint64_t with_bits(const double* values, int count, uint64_t hash) {
  for (int i = 0; i < count; ++i) {
    uint64_t bits = 0;
    memcpy(&bits, values + i, sizeof bits);
    hash = (hash ^ bits) * 1099511628211U;
  }
  return hash;
}

static uint64_t seen_of(const rodsweep_system* system) {
  uint64_t hash = with_bits(system->b, 6 * system->joints, 14695981039346656037U);
  for (int k = 0; k < system->row_begin[system->joints]; ++k)
    for (int column = 0; column < 6; ++column) hash = with_bits(system->blocks + 48 * k + 8 * column, 6, hash);
  hash = with_bits(system->multipliers, 6 * system->joints, hash);
  return with_bits(system->position_m, 3 * system->segments, hash);
}

static int propose(void* instance, const rodsweep_system* system, double* x0, int* products, char* error) {
  struct rod* own = &((struct watcher*)instance)->rods[system->rod];
  (void)products, (void)error;
  own->step = system->step;
  own->newton = system->newton;
  own->seen = seen_of(system);
  if (system->step == 0) return 0;
  for (int i = 0; i < 6 * system->joints; ++i) x0[i] = 0.7 * own->last[i];
  return 1;
}

/* ||b - A x|| / ||b|| */
static double residual(struct rod* own, const rodsweep_system* system, const double* x) {
  double of_r = 0, of_b = 0;
  for (int row = 0; row < system->joints; ++row) {
    double* r = own->product + 6 * row;
    memcpy(r, system->b + 6 * row, 6 * sizeof(double));
    for (int k = system->row_begin[row]; k < system->row_begin[row + 1]; ++k)
      for (int i = 0; i < 6; ++i)
        for (int j = 0; j < 6; ++j) r[i] -= system->blocks[48 * k + 8 * j + i] * x[6 * system->columns[k] + j];
    for (int i = 0; i < 6; ++i) of_r += r[i] * r[i], of_b += system->b[6 * row + i] * system->b[6 * row + i];
  }
  return sqrt(of_r / of_b);
}

static int accept(void* instance, const rodsweep_system* system, const double* solution, char* error) {
  struct rod* own = &((struct watcher*)instance)->rods[system->rod];
  const int size = 6 * own->joints;
  if (system->joints != own->joints || system->step != own->step || system->newton != own->newton ||
      seen_of(system) != own->seen) {
    snprintf(error, RODSWEEP_ERROR_BYTES, "accept() got another system than that of step %d, iteration %d", own->step,
             own->newton);
    return -1;
  }
  const double left = residual(own, system, solution);
  if (!(left < 0.02)) {
    snprintf(error, RODSWEEP_ERROR_BYTES, "accept() got a solution with a residual of %g", left);
    return -1;
  }
  for (int i = 0; i < size; ++i) own->sum[i] = system->newton == 0 ? solution[i] : own->sum[i] + solution[i];
  memcpy(own->last, solution, (size_t)size * sizeof(double));
  own->summed_step = system->step;
  own->seen = 0;
  return 0;
}

static int accept_total(void* instance, int rod, int step, const double* total, char* error) {
  struct watcher* self = instance;
  struct rod* own = &self->rods[rod];
  if (step != own->summed_step ||
      (strcmp(self->options, "sums") == 0 && memcmp(total, own->sum, (size_t)(6 * own->joints) * sizeof(double)) != 0)) {
    snprintf(error, RODSWEEP_ERROR_BYTES, "accept_total() got another sum than that of step %d of rod %d", step, rod);
    return -1;
  }
  memcpy(own->last, total, (size_t)(6 * own->joints) * sizeof(double));
  return 0;
}

static int set_up(void* instance, const rodsweep_system* system, char* error) {
  struct watcher* self = instance;
  (void)error;
  for (int row = 0; row < system->joints; ++row)
    for (int k = system->row_begin[row]; k < system->row_begin[row + 1]; ++k)
      for (int r = 0; r < 6 && system->columns[k] == row; ++r)
        self->inverse_diagonal[6 * row + r] = 1 / system->blocks[48 * k + 9 * r];
  return 1;
}

static int apply(void* instance, const double* r, double* z, char* error) {
  const struct watcher* self = instance;
  const int size = 6 * self->rods[0].joints;
  (void)error;
  if (strcmp(self->options, "nothing") == 0) return 0;
  for (int i = 0; i < size; ++i) z[i] = r[i] * self->inverse_diagonal[i];
  for (int i = 6; i < size && strcmp(self->options, "first") == 0; ++i) z[i] = 0;
  for (int i = 0; i < size && strcmp(self->options, "every other") == 0; i += 2) z[i] = 0;
  if (strcmp(self->options, "negative") == 0) z[size - 1] *= -1;
  return 0;
}

const rodsweep_plugin_functions* rodsweep_plugin(void) {
  static const rodsweep_plugin_functions functions = {.version = RODSWEEP_PLUGIN_VERSION,
                                                      .create = create,
                                                      .destroy = destroy,
                                                      .propose = propose,
                                                      .accept = accept,
                                                      .accept_total = accept_total,
                                                      .set_up = set_up,
                                                      .apply = apply};
  return &functions;
}
