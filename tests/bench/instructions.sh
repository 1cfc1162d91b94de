#!/bin/bash
# SPDX-License-Identifier: MIT
# instructions.sh: instructions of the core, counted by callgrind: the same on every run, whatever the machine does besides.
# One JSON object a line. Needs valgrind. CC and CFLAGS (-O2) may be set.
#
# Counted is what is spent inside rkm04_advance, apart from the sink that stores the time stamps.
set -u
cd "$(dirname "${BASH_SOURCE[0]}")/../.." || exit 1
command -v valgrind callgrind_annotate >/dev/null || { echo "valgrind not found: apt-get install valgrind" >&2; exit 1; }
folder=$(mktemp -d) || exit 1
trap 'rm -rf "$folder"' EXIT

read -ra flags <<<"${CFLAGS:--O2}"
"${CC:-gcc}" -std=c11 -D_GNU_SOURCE -g "${flags[@]}" -Iinclude src/*.c tests/bench/bench.c -o "$folder/bench" || exit 1

# count NAME: sets `instructions`, the core's own in this benchmark, and `line`, what it printed.
count() {
    line=$(valgrind --quiet --tool=callgrind --toggle-collect=rkm04_advance --callgrind-out-file="$folder/out" \
        "$folder/bench" --repeat 1 "$1") || exit 1
    instructions=$(callgrind_annotate --auto=no --threshold=100 --show=Ir "$folder/out" | awk '
        { gsub(",", "", $1) }
        /PROGRAM TOTALS/ { total = $1 }
        /:sink_step/ { sink = $1 }
        END { print total - sink }')
}

for name in constant ramp mixed exec; do
    count "$name"
    pulses=$(sed 's/.*"pulses":\([0-9]*\).*/\1/' <<<"$line")
    awk -v name="$name" -v pulses="$pulses" -v instructions="$instructions" 'BEGIN {
        printf "{\"bench\":\"instructions\",\"work\":\"%s\",\"pulses\":%d,\"instructions_per_pulse\":%.2f}\n",
            name, pulses, instructions / pulses }'
done
for name in idle_hour wait_hour; do
    count "$name"
    echo "{\"bench\":\"instructions\",\"work\":\"$name\",\"instructions\":$instructions}"
done
