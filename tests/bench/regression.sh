#!/bin/bash
# SPDX-License-Identifier: MIT
# regression.sh: fails if a pulse, or a cycle of the CNC872, takes more than 3 % more instructions than tests/bench/figures.txt
# says. Counted by callgrind with gcc 12, whose figures these are; skipped without (the test `cost` counts basic blocks on every
# machine).
#
#   regression.sh           compare
#   regression.sh --renew   write the file anew, after a change that is worth its price
set -u
cd "$(dirname "${BASH_SOURCE[0]}")" || exit 1
figures=figures.txt
[[ $# == 0 || $* == --renew ]] || { echo "usage: regression.sh [--renew]" >&2; exit 2; }
[[ $(gcc -dumpversion 2>/dev/null) == 12* && $(uname -m) == x86_64 ]] || { echo "skipped: needs gcc 12 on x86-64"; exit 77; }
command -v valgrind >/dev/null || { echo "skipped: valgrind not found"; exit 77; }
export CC=gcc
unset CFLAGS

found=$(./instructions.sh |
    sed -n 's/.*"work":"\([a-z]*\)","sink":"\([a-z]*\)".*instructions_per_[a-z]*":\([0-9.]*\)}/\1 \2 \3/p')
[[ $(wc -l <<<"$found") == 18 ]] || { echo "regression: instructions.sh did not count eighteen figures" >&2; exit 1; }
if [[ ${1-} == --renew ]]; then
    printf '%s\n' '# SPDX-License-Identifier: MIT' '# work, sink, instructions a pulse, of cnc… a cycle: regression.sh --renew' \
        "$found" >$figures
    cat $figures
    exit
fi
awk '
    /^#/ { next }
    NR == FNR { wanted[$1 " " $2] = $3; next }
    { most = 1.03 * wanted[$1 " " $2]
      printf "%-11s %-7s %7.2f instructions, at most %.2f\n", $1, $2, $3, most
      if ($3 > most) { print "regression: " $1 " " $2 " has become slower"; bad = 1 } }
    END { exit bad }' $figures - <<<"$found"
