#!/bin/bash
# alone.sh COMMAND...: runs a command as if on a machine of its own, as far as processes, network, mounts and names go. When it
# ends, however it does, all that it started ends with it, and its mounts and links are gone. Needs root; exit code 77 (CTest:
# skipped) where the kernel does not let it.
set -eu
spaces=(--mount --pid --net --uts --ipc --fork --kill-child --mount-proc)
if ! why=$(unshare "${spaces[@]}" true 2>&1); then
  echo "skipped: no namespaces of our own here: $why"
  exit 77
fi
# The first process of a PID namespace inherits all orphans; this shell stays there and buries them.
exec unshare "${spaces[@]}" bash -c '
  ip link set lo up
  mount -t tmpfs none /run
  mount -t tmpfs none /dev/shm
  "$@"
  exit $?' alone "$@"
