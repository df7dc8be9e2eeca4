// Preloaded into the program. Once the file FAIL_FILE exists, pwrite() (used by MPI-IO) on rank FAIL_RANK fails as on a
// full disk. With FAIL_LOCKS, file locks fail, as on some network file systems.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static int disk_is_full(void) {
  const char* rank = getenv("OMPI_COMM_WORLD_RANK");
  const char* failing = getenv("FAIL_RANK");
  const char* file = getenv("FAIL_FILE");
  return rank && failing && file && strcmp(rank, failing) == 0 && access(file, F_OK) == 0;
}

ssize_t pwrite(int descriptor, const void* data, size_t bytes, off_t offset) {
  ssize_t (*real)(int, const void*, size_t, off_t) = dlsym(RTLD_NEXT, "pwrite");
  if (!disk_is_full()) return real(descriptor, data, bytes, offset);
  errno = ENOSPC;
  return -1;
}

ssize_t pwrite64(int descriptor, const void* data, size_t bytes, off_t offset) {
  return pwrite(descriptor, data, bytes, offset);
}

int fcntl64(int descriptor, int command, ...) {
  va_list arguments;
  va_start(arguments, command);
  void* argument = va_arg(arguments, void*);
  va_end(arguments);
  if ((command == F_OFD_SETLK || command == F_OFD_GETLK) && getenv("FAIL_LOCKS")) {
    errno = ENOLCK;
    return -1;
  }
  int (*real)(int, int, ...) = dlsym(RTLD_NEXT, "fcntl64");
  return real(descriptor, command, argument);
}

int fcntl(int descriptor, int command, ...) {
  va_list arguments;
  va_start(arguments, command);
  void* argument = va_arg(arguments, void*);
  va_end(arguments);
  return fcntl64(descriptor, command, argument);
}
