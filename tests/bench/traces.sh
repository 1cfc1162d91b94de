#!/bin/bash
# traces.sh RKM04 [SECONDS]: what a trace of each format costs. Four motors at 16 000 steps/s, SECONDS of virtual time (100);
# the files go to a folder in memory. One line a format: processor time, times real time, bytes a second of virtual time.
set -eu
rkm04=${1:?usage: traces.sh RKM04 [SECONDS]} seconds=${2:-100}
folder=$(mktemp -d -p /dev/shm)
trap 'rm -rf "$folder"' EXIT
echo 'S2000 V16000 A60000 F16000000 R' >"$folder/run.rks"

# cost FORMAT: one run; its processor time in ms is in $spent.
cost() {
    local trace=() TIMEFORMAT='%3U %3S' user system
    [[ $1 == none ]] || trace=(--trace "$folder/run.$1")
    { time "$rkm04" exec 0="$folder/run.rks" --until "${seconds}s" "${trace[@]}" >/dev/null 2>&1 || (($? == 124)); } 2>"$folder/time"
    read -r user system <"$folder/time"
    spent=$((10#${user/./} + 10#${system/./}))
}

printf '%-6s %12s %16s %18s\n' format 'CPU seconds' 'times real time' 'bytes per second'
for format in none csv vcd jsonl; do
    least=
    for _ in 1 2 3; do
        cost $format
        [[ -n $least ]] && ((least <= spent)) || least=$spent
    done
    bytes=0
    [[ $format == none ]] || bytes=$(($(stat -c %s "$folder/run.$format") / seconds))
    printf '%-6s %8d.%03d %16d %18d\n' $format $((least / 1000)) $((least % 1000)) \
        $((seconds * 1000 / (least > 0 ? least : 1))) $bytes
    rm -f "$folder/run.$format"
done
