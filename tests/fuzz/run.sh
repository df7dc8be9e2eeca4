#!/bin/bash
# run.sh FOLDER SECONDS: runs the fuzzers of a folder side by side, one a core, for so many seconds in all, beginning with
# the corpus beside this and the shipped jobs. What they learn is kept in FOLDER/corpus, for the next run. Fails where one of
# them found something, and says how to see it.
set -euo pipefail
folder=$(realpath "$1") seconds=$2
here=$(realpath "$(dirname "$0")") jobs=$(realpath "$(dirname "$0")/../../jobs")
fuzzers=(jobs results datasets models)
cores=$(nproc)
each=$((seconds * (cores < ${#fuzzers[@]} ? cores : ${#fuzzers[@]}) / ${#fuzzers[@]}))

# As in the unit tests: Open MPI's hooks into malloc and the address sanitizer's exclude each other.
export OMPI_MCA_memory=^patcher UBSAN_OPTIONS=print_stacktrace=1
export ASAN_OPTIONS=allow_addr2line=1:detect_leaks=0  # what MPI keeps to the end

fuzz() {
  local name=$1 seeds=$jobs digits k=0
  mkdir -p "$folder/corpus/$name"
  if [ "$name" != jobs ]; then
    seeds=$folder/corpus/seeds-$name
    rm -rf "$seeds" && mkdir "$seeds"
    while read -r digits; do printf '%b' "$(sed 's/../\\x&/g' <<<"$digits")" >"$seeds/$((++k))"; done <"$here/corpus/$name.txt"
  fi
  if "$folder/fuzz_$name" -max_total_time="$each" -max_len=$([ "$name" = jobs ] && echo 20000 || echo 300) -timeout=60 \
      -rss_limit_mb=4096 -print_final_stats=1 -artifact_prefix="$folder/corpus/found-$name-" \
      "$folder/corpus/$name" "$seeds" >"$folder/corpus/$name.log" 2>&1; then
    echo "fuzz_$name: $(sed -n 's/^stat::number_of_executed_units: *//p' "$folder/corpus/$name.log") inputs in $each s, nothing found"
    return
  fi
  tail -n 40 "$folder/corpus/$name.log"
  echo "fuzz_$name found something; see it again with: OMPI_MCA_memory=^patcher $folder/fuzz_$name $folder/corpus/found-$name-..."
  return 1
}
export -f fuzz
export folder here jobs each
printf '%s\n' "${fuzzers[@]}" | xargs -P "$cores" -I{} bash -c 'fuzz {}'
