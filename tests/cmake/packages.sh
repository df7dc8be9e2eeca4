#!/bin/sh
# cmake/packages.sh with a list of this test and with replacements of id and apt-get; nothing is installed.
set -eu
fail() { echo "FAILED: $*"; echo "--- said:"; cat said; exit 1; }
says() { grep -qF -- "$1" said || fail "expected '$1'"; }
packages() { code=0; PATH="$PWD/bin:$PATH" sh "$SOURCE_DIR/cmake/packages.sh" list.txt "$@" >said 2>&1 </dev/null || code=$?; }

cat >list.txt <<'LIST'
# comment
build    coreutils
build    coreutils-nonesuch
develop  nonesuch-tool
other    bash
LIST
mkdir bin
printf '#!/bin/sh\necho "$FAKE_UID"\n' >bin/id
printf '#!/bin/sh\necho "$DEBIAN_FRONTEND: $*" >>apt-calls\n[ "$1" != "${FAKE_APT_FAILS:-}" ] || { echo "E: no such mirror"; exit 100; }\n' >bin/apt-get
chmod +x bin/*

# Nothing is missing: no output.
export FAKE_UID=1000
packages other
[ $code = 0 ] && [ ! -s said ] || fail "a complete group is silent"

# Not root: the message names only missing packages and the command to run; nothing is installed.
packages build develop
[ $code != 0 ] || fail "missing packages must fail for a user who is not root"
says "sudo apt-get update && sudo apt-get install --yes --no-install-recommends coreutils-nonesuch nonesuch-tool"
says "SKIP_PACKAGES=1"
[ ! -e apt-calls ] || fail "apt-get was called for a user who is not root"

# Root: one update and one install of the missing packages in these groups, without questions.
export FAKE_UID=0
packages build
[ $code = 0 ] || fail "root installs"
says "installing 1 Debian packages"
printf '%s\n' "noninteractive: update" \
  "noninteractive: install --yes --no-install-recommends coreutils-nonesuch -o DPkg::Lock::Timeout=600" >expected
cmp -s expected apt-calls || { cp apt-calls said; fail "calls of apt-get"; }

# apt-get fails: the end of its output, the packages, and a nonzero exit code.
export FAKE_APT_FAILS=install TMPDIR=.
packages build
[ $code != 0 ] || fail "a failing apt-get must fail"
says "E: no such mirror"
says "apt-get failed"
says "coreutils-nonesuch"
