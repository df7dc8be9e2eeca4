#!/bin/bash
# alone.sh COMMAND...: runs a command with its own processes, network, mounts and host name. When the command ends, for
# any reason, all processes that it started end too, and its mounts and links are gone. Needs root. Exit code 77 (CTest:
# skipped) if the kernel does not permit namespaces.
set -eu
spaces=(--mount --pid --net --uts --ipc --fork --kill-child --mount-proc)
if ! why=$(unshare "${spaces[@]}" true 2>&1); then
  echo "skipped: no namespaces of our own here: $why"
  exit 77
fi
# The first process of a PID namespace inherits all orphans. This shell stays and reaps them.
exec unshare "${spaces[@]}" bash -c '
  ip link set lo up
  mount -t tmpfs none /run
  mount -t tmpfs none /dev/shm
  "$@"
  exit $?' alone "$@"
