#!/bin/bash
# SPDX-License-Identifier: MIT
# instructions.sh: instructions of the core, counted by callgrind: the same on every run, whatever the machine does besides.
# One JSON object a line. Needs valgrind. CC and CFLAGS may be set; CFLAGS are those of a release build otherwise
# (cmake/Hardening.cmake).
#
# Counted is what is spent inside rkm04_advance, the sink included, which stores one time stamp a pulse: once with pulses in
# blocks (port.steps), once one by one (port.step, "single"). Of the CIB module (work "cib…") the same inside cib_advance, slot by
# slot; "single" is with the outputs. Of the CNC872 (work "cnc…") a cycle inside cnc_advance: one axis, sixteen, these with a PLC
# program of 500 instructions.
set -u
cd "$(dirname "${BASH_SOURCE[0]}")/../.." || exit 1
command -v valgrind >/dev/null || { echo "valgrind not found: apt-get install valgrind" >&2; exit 1; }
folder=$(mktemp -d) || exit 1
trap 'rm -rf "$folder"' EXIT

release="-O3 -DNDEBUG -fPIE -fstack-protector-strong -fstack-clash-protection -U_FORTIFY_SOURCE -D_FORTIFY_SOURCE=3"
[[ $(uname -m) != x86_64 ]] || release+=" -fcf-protection=full"
read -ra flags <<<"${CFLAGS:-$release}"
"${CC:-gcc}" -std=c11 -D_GNU_SOURCE -g "${flags[@]}" -Iinclude src/*.c tests/bench/bench.c -o "$folder/bench" || exit 1
"${CC:-gcc}" -std=c11 -D_GNU_SOURCE -g "${flags[@]}" -Iinclude -Isrc src/*.c src/cib/*.c tests/bench/cib_bench.c \
    -o "$folder/cib_bench" || exit 1
"${CC:-gcc}" -std=c11 -D_GNU_SOURCE -g "${flags[@]}" -Iinclude -Isrc src/{ramp,ramp_pulses,wide,crc32}.c src/pmc/pmc_*.c \
    tests/bench/bench_pmc.c -o "$folder/bench_pmc" || exit 1

"${CC:-gcc}" -std=c11 -D_GNU_SOURCE -g "${flags[@]}" -Iinclude -Isrc src/{wide,crc32}.c src/cnc872/*.c tests/bench/bench_cnc.c \
    -o "$folder/bench_cnc" || exit 1

# count FUNCTION PROGRAM [OPTION]... NAME: sets `instructions`, and `line`, what the benchmark printed.
count() {
    line=$(valgrind --quiet --tool=callgrind "--toggle-collect=$1" --callgrind-out-file="$folder/out" \
        "$folder/$2" "${@:3}") || exit 1
    instructions=$(sed -n 's/^totals: //p' "$folder/out")
}

for name in constant ramp mixed exec cibconstant cibramp pmcconstant pmcramp pmctop; do
    for sink in blocks single; do
        [[ $name$sink != pmc*single ]] || continue # the PMC's port takes blocks
        options=(--repeat=1)
        [[ $sink == single ]] && options+=(--single)
        case $name in
        pmctop) count pmc_advance bench_pmc --quick top ;;
        pmc*) count pmc_advance bench_pmc --once "${name#pmc}" ;;
        cib*) count cib_advance cib_bench "${options[@]:1}" "${name#cib}" ;;
        *) count rkm04_advance bench "${options[@]}" "$name" ;;
        esac
        pulses=$(sed 's/.*"pulses":\([0-9]*\).*/\1/' <<<"$line")
        awk -v name="$name" -v sink="$sink" -v pulses="$pulses" -v instructions="$instructions" 'BEGIN {
            printf "{\"bench\":\"instructions\",\"work\":\"%s\",\"sink\":\"%s\",\"pulses\":%d,\"instructions_per_pulse\":%.2f}\n",
                name, sink, pulses, instructions / pulses }'
    done
done
for name in one sixteen plc; do
    count cnc_advance bench_cnc --quick "$name"
    cycles=$(sed 's/.*"cycles":\([0-9]*\).*/\1/' <<<"$line")
    awk -v name="cnc$name" -v cycles="$cycles" -v instructions="$instructions" 'BEGIN {
        printf "{\"bench\":\"instructions\",\"work\":\"%s\",\"sink\":\"none\",\"cycles\":%d,\"instructions_per_cycle\":%.2f}\n",
            name, cycles, instructions / cycles }'
done
for name in idle_hour wait_hour; do
    count rkm04_advance bench --repeat=1 "$name"
    echo "{\"bench\":\"instructions\",\"work\":\"$name\",\"instructions\":$instructions}"
done
