#!/bin/sh
# install.sh CMAKE: what is installed works away from the source tree: program, jobs, analysis scripts, Python package,
# manual page, completion, MPI settings. What a tool that is not here would check is skipped, with a word.
set -eu
fail() { echo "FAILED: $*"; exit 1; }
"$1" --install "$BUILD_DIR" --prefix "$PWD/a prefix" >install.log || { cat install.log; exit 1; }
prefix="$PWD/a prefix"
share="$prefix/share/rodsweep"
mkdir elsewhere
cd elsewhere
"../a prefix/bin/rodsweep" validate --later "$share"/jobs/*.json
"../a prefix/bin/rodsweep" run "$share/jobs/smoke.json" -o smoke.h5 | tee run.txt
sh -c "$(sed -n 's/^next: //p' run.txt)" | tee summary.txt
[ -s summary.txt ]

bin="$prefix/bin"
for script in "$share"/analysis/*.py; do
  name=$(basename "$script" .py | tr _ -)
  [ -x "$bin/rodsweep-$name" ] && [ "$(realpath "$bin/rodsweep-$name")" = "$(realpath "$script")" ] ||
    fail "$bin/rodsweep-$name does not lead to $script"
done
"$bin/rodsweep-summary" smoke.h5 | cmp - summary.txt
"$bin/rodsweep-summary" --help | grep -q '^  rodsweep-summary results/demo.h5'
PYTHONPATH="$share/analysis" /usr/bin/python3 -c 'import rodsweep; print(rodsweep.open("smoke.h5"))' | grep 'tasks ok, none failed'
"$bin/rodsweep-report" smoke.h5    # style, scripts and libraries of the page were installed too
grep -q 'Observable Plot' smoke.html
"$share/mpi-env.sh" "$MPIRUN" -n 2 "../a prefix/bin/rodsweep" --version

"../a prefix/bin/rodsweep" manual >manual.1
cmp manual.1 "$prefix/share/man/man1/rodsweep.1"
if command -v man >/dev/null; then
  MANWIDTH=80 man --warnings -l "$prefix/share/man/man1/rodsweep.1" >manual.txt 2>warnings.txt || fail "man"
  [ ! -s warnings.txt ] || { cat warnings.txt; fail "man warns"; }
  grep -q '^ *rodsweep run \[OPTION\]\.\.\. JOB$' manual.txt || fail "the manual page does not say how to run"
else
  echo "skipped: man is not installed"
fi

for completion in bash:bash-completion/completions/rodsweep zsh:zsh/site-functions/_rodsweep fish:fish/vendor_completions.d/rodsweep.fish; do
  shell=${completion%%:*}
  file="$prefix/share/${completion#*:}"
  "../a prefix/bin/rodsweep" completion "$shell" | cmp - "$file"
  if command -v "$shell" >/dev/null; then "$shell" -n "$file"; else echo "skipped: $shell is not installed"; fi
done
if command -v fish >/dev/null; then  # finds it by itself
  offered=$(XDG_DATA_DIRS="$prefix/share" HOME="$PWD" PATH="$prefix/bin:$PATH" fish -c "complete -C 'rodsweep mer'")
  [ "${offered%%	*}" = merge ] || fail "fish offers '$offered'"
fi
