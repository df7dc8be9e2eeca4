#!/bin/sh
# packages.sh LIST GROUP...: installs the missing Debian packages of these groups of LIST. No output if none is missing.
# Root installs with apt-get; for other users it prints the command to run and fails.
set -eu
list=$1
shift
if ! command -v dpkg-query >/dev/null; then
  echo "rodsweep: no dpkg-query here, so packages are not checked; ${list} names what is needed." >&2
  exit 0
fi

wanted=$(awk -v groups=" $* " '!/^#/ && NF == 2 && index(groups, " " $1 " ") { print $2 }' "$list")
# shellcheck disable=SC2086  # one word per package, here and below
installed=$(dpkg-query -W -f '${db:Status-Status} ${Package}\n' $wanted 2>/dev/null | sed -n 's/^installed //p') || true
missing=
for package in $wanted; do
  case "
$installed
" in *"
$package
"*) ;; *) missing="$missing $package" ;; esac
done
[ -n "$missing" ] || exit 0

install="apt-get install --yes --no-install-recommends$missing"
if [ "$(id -u)" != 0 ]; then
  cat >&2 <<MESSAGE
rodsweep: these Debian packages are needed and not installed:
 $missing
Install them with the next line, then run make again:
  sudo apt-get update && sudo $install
Where they come from elsewhere (modules, containers), skip this check: make SKIP_PACKAGES=1 ...
MESSAGE
  exit 1
fi

log=$(mktemp "${TMPDIR:-/tmp}/rodsweep-packages.XXXXXX")
# shellcheck disable=SC2086
set -- $missing
echo "rodsweep: installing $# Debian packages and what they need (a few minutes; log: $log):$missing"
export DEBIAN_FRONTEND=noninteractive
if ! { apt-get update && $install -o DPkg::Lock::Timeout=600; } </dev/null >"$log" 2>&1; then
  tail -n 20 "$log" >&2
  echo "rodsweep: apt-get failed, see $log. The packages:$missing" >&2
  exit 1
fi
rm -f "$log"
