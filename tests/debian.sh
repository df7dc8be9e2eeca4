#!/bin/bash
# debian.sh SUITE FOLDER REFERENCE: the README's commands, `make demo` and `make test`, in a clean clone of HEAD on another
# Debian (trixie, sid, ...), as root. The system is made in FOLDER by debootstrap, and upgraded by later calls. The
# iterations of the smoke job must be those of REFERENCE, a results file of this system.
set -euo pipefail
suite=$1 root=$(realpath -m "$2") reference=$3
source=$(git rev-parse --show-toplevel)
[ "$(id -u)" = 0 ] || { echo "debian.sh: needs root, for debootstrap and chroot" >&2; exit 2; }

if [ ! -e "$root/etc/debian_version" ]; then
  echo "debian.sh: installing $suite into $root (some minutes; log: $root.log)"
  rm -rf "$root.new"
  mkdir -p "$root.new"
  debootstrap --variant=minbase --include=make,git,ca-certificates,ccache "$suite" "$root.new" >"$root.log" 2>&1 ||
    { tail "$root.log" >&2; exit 1; }
  mv "$root.new" "$root"
fi
cp /etc/resolv.conf "$root/etc/"
mkdir -p "$root/mnt/source"

# Mounts of its own, which end with the process.
unshare --mount --propagation private bash -euo pipefail -c '
  cd "$1"
  mount -t proc proc proc 2>/dev/null || mount --bind /proc proc
  mount --bind /sys sys
  mount -t tmpfs -o mode=755 tmpfs dev
  mkdir dev/pts dev/shm
  for device in null zero full random urandom tty; do touch dev/$device; mount --bind /dev/$device dev/$device; done
  mount -t devpts -o newinstance,ptmxmode=0666 devpts dev/pts
  ln -s pts/ptmx dev/ptmx
  ln -s /proc/self/fd dev/fd
  for stream in in:0 out:1 err:2; do ln -s /proc/self/fd/${stream#*:} dev/std${stream%:*}; done
  mount -t tmpfs tmpfs dev/shm
  mount --bind "$2" mnt/source
  exec chroot . env -i HOME=/root TERM="${TERM:-dumb}" LANG=C.UTF-8 PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin \
    CCACHE_NOHASHDIR=1 bash -euo pipefail -c '\''
      export DEBIAN_FRONTEND=noninteractive
      echo "Acquire::Check-Valid-Until false;" >/etc/apt/apt.conf.d/old-mirrors
      { apt-get update && apt-get dist-upgrade --yes; } >/tmp/upgrade.log 2>&1 || { tail /tmp/upgrade.log >&2; exit 1; }
      git config --global --replace-all safe.directory "*"
      rm -rf /root/rodsweep
      git clone --quiet /mnt/source /root/rodsweep
      cd /root/rodsweep
      make demo
      rm -f /tmp/smoke.h5
      build/rodsweep run jobs/smoke.json -o /tmp/smoke.h5 >/dev/null
      make test
      build/rodsweep --version | paste -sd " " | tr -s " "
    '\''
' debian.sh "$root" "$source"

# Sums of each task, of the first Newton iterations. Later ones start at rounding and may differ by an iteration.
h5diff "$reference" "$root/tmp/smoke.h5" /tasks/iterations_sum
echo "debian.sh: $suite: demo and tests pass; the smoke job needs the same iterations as on this system"
