#!/bin/sh
# revision.sh CMAKE: the header that cmake/revision.cmake writes, for clones in all conditions.
set -eu
cmake=$1
header() { "$cmake" -D SOURCE_DIR="$PWD/$1" -D OUTPUT="$PWD/revision.hpp" -P "$SOURCE_DIR/cmake/revision.cmake"; }
revision() { header "$1"; sed -n 's/.*built_revision = "\(.*\)";/\1/p' revision.hpp; }
is() { [ "$1" = "$2" ] || { echo "FAILED: expected '$2', found '$1'"; exit 1; }; }
export GIT_CONFIG_GLOBAL=/dev/null GIT_CONFIG_NOSYSTEM=1 GIT_CEILING_DIRECTORIES="$PWD"
export GIT_AUTHOR_NAME=a GIT_AUTHOR_EMAIL=a@example.org GIT_COMMITTER_NAME=a GIT_COMMITTER_EMAIL=a@example.org

mkdir -p plain clone/unpacked
is "$(revision plain)" unknown

git init -q clone
echo one >clone/file
git -C clone add file
git -C clone commit -q -m one
commit=$(git -C clone rev-parse --short=12 HEAD)
is "$(revision clone)" "$commit"
is "$(revision clone/unpacked)" unknown  # sources unpacked inside another repository do not have its revision

# An unchanged revision does not touch the header, so nothing is recompiled. Untracked files do not count.
touch -d '2001-01-01' revision.hpp
echo new >clone/untracked
is "$(revision clone)" "$(git -C clone describe --always --abbrev=12)"
touch -d '2001-01-01' revision.hpp
header clone
is "$(date -r revision.hpp +%Y)" 2001

echo two >clone/file
is "$(revision clone)" "$commit-dirty"
