#!/bin/bash
# run.sh FOLDER SECONDS: runs FOLDER/fuzz_jobs for this many seconds, starting with the shipped jobs. Keeps its corpus
# in FOLDER/corpus. Fails if it finds an error.
set -euo pipefail
folder=$(realpath "$1") seconds=$2
jobs=$(realpath "$(dirname "$0")/../../jobs")
mkdir -p "$folder/corpus/jobs"
# Open MPI's malloc hooks conflict with those of the address sanitizer, as in the unit tests.
export OMPI_MCA_memory=^patcher UBSAN_OPTIONS=print_stacktrace=1
export ASAN_OPTIONS=allow_addr2line=1:detect_leaks=0  # MPI keeps memory to the end
"$folder/fuzz_jobs" -max_total_time="$seconds" -max_len=20000 -timeout=60 -rss_limit_mb=4096 -print_final_stats=1 \
  -artifact_prefix="$folder/corpus/found-" "$folder/corpus/jobs" "$jobs"
