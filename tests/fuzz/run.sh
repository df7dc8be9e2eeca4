#!/bin/bash
# run.sh FOLDER SECONDS: runs FOLDER/fuzz_jobs for so many seconds, beginning with the shipped jobs. What it learns is kept in
# FOLDER/corpus. Fails where it found something.
set -euo pipefail
folder=$(realpath "$1") seconds=$2
jobs=$(realpath "$(dirname "$0")/../../jobs")
mkdir -p "$folder/corpus/jobs"
# As in the unit tests: Open MPI's hooks into malloc and the address sanitizer's exclude each other.
export OMPI_MCA_memory=^patcher UBSAN_OPTIONS=print_stacktrace=1
export ASAN_OPTIONS=allow_addr2line=1:detect_leaks=0  # what MPI keeps to the end
"$folder/fuzz_jobs" -max_total_time="$seconds" -max_len=20000 -timeout=60 -rss_limit_mb=4096 -print_final_stats=1 \
  -artifact_prefix="$folder/corpus/found-" "$folder/corpus/jobs" "$jobs"
