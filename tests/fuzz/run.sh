#!/usr/bin/env bash
# Fuzzes every reader for so many seconds each (default 600), one after the other. Ends with status
# 1 after a finding, whose file stands in build/fuzz/findings. Build first: cmake --build --preset fuzz
set -euo pipefail
cd "$(dirname "$0")/../.."
seconds=${1:-600}
bin=build/fuzz/tests/fuzz
mkdir -p build/fuzz/findings
[ -d build/fuzz/seeds ] || "$bin/write_fuzz_seeds" build/fuzz/seeds
status=0
for name in ${2:-capture volume point_list mat5 mat73 npy npz ti json csv ply glb gltf scene response obj stl mitsuba mitsuba_json ytal}; do
    fuzzer=$name
    case $name in mat5 | mat73 | npy | npz | ti | json | csv) fuzzer=arrays ;; esac
    mkdir -p "build/fuzz/corpus/$name"
    # What happens in a child that runs a library is contained: its reports go to a folder.
    ASAN_OPTIONS=log_path=build/fuzz/findings/asan:detect_leaks=0 \
        "$bin/${fuzzer}_fuzzer" -max_total_time="$seconds" -timeout=60 -rss_limit_mb=4096 -max_len=20000 \
        -artifact_prefix="build/fuzz/findings/${name}_" -print_final_stats=1 \
        "build/fuzz/corpus/$name" "build/fuzz/seeds/$name" >"build/fuzz/$name.log" 2>&1 || status=1
    echo "$name: $(grep -o 'number_of_executed_units: .*' "build/fuzz/$name.log"), $(grep -o 'cov: [0-9]*' "build/fuzz/$name.log" | tail -1)"
done
exit $status
