#!/bin/sh
# debian.sh packages | build | runtime: steps of Dockerfile and rodsweep.def for an image of Debian 12. The first two
# run at the top of the tree, in a temporary stage. `runtime` runs in the final stage, next to their /opt/rodsweep,
# whose packages.txt names the packages of the shared libraries.
set -eu
prefix=/opt/rodsweep
export DEBIAN_FRONTEND=noninteractive

case $1 in
packages)
  apt-get update
  apt-get install --yes --no-install-recommends git make  # git: for the revision in `rodsweep info`
  cmake/packages.sh packages.txt build run
  ;;
build)
  make install SKIP_PACKAGES=1 PORTABLE=1 BUILD=/tmp/rodsweep-build PREFIX=$prefix
  {
    awk '$1 == "run" { print $2 }' packages.txt
    # From the linker's list, so that no library version is written here.
    for library in $(objdump -p $prefix/bin/rodsweep | awk '$1 == "NEEDED" { print $2 }'); do
      dpkg-query --search "*lib/$(gcc -dumpmachine)/$library" | cut -d: -f1  # not the links of -dev packages
    done
  } | sort -u >$prefix/packages.txt
  ;;
runtime)
  apt-get update
  # shellcheck disable=SC2046  # one word per package
  apt-get install --yes --no-install-recommends $(cat $prefix/packages.txt)
  rm -rf /var/lib/apt/lists/*
  $prefix/bin/rodsweep --version
  ;;
*)
  echo "debian.sh: packages, build or runtime; not '$1'" >&2
  exit 2
  ;;
esac
