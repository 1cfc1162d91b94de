#!/bin/bash
# SPDX-License-Identifier: MIT
# check_output.sh BENCH: every benchmark runs, and each line it prints is one flat JSON object with positive figures.
set -u
bench=${1:?usage: check_output.sh BENCH}

output=$("$bench" --quick) || { echo "bench --quick failed"; exit 1; }

string='"[a-z0-9_]+"'
number='[0-9]+(\.[0-9]+)?(e[+-]?[0-9]+)?'
while read -r line; do
    [[ $line =~ ^\{\"bench\":$string(,$string:($string|$number))+\}$ ]] || { echo "not well formed: $line"; exit 1; }
    [[ $line =~ :-?0+(\.0+)?[,}] ]] && { echo "a figure is zero: $line"; exit 1; }
done <<<"$output"

# Every name that --help lists, and nothing else.
wanted=$("$bench" --help | sed -n '/^NAME/,$ s/^  \([a-z_]*\) .*/\1/p' | sort)
found=$(sed 's/^{"bench":"\([a-z_]*\)".*/\1/' <<<"$output" | sort -u)
[[ -n $wanted && $wanted == "$found" ]] || { printf 'listed:\n%s\nprinted:\n%s\n' "$wanted" "$found"; exit 1; }

"$bench" nonsense 2>/dev/null
[[ $? == 2 ]] || { echo "an unknown name is not refused with exit status 2"; exit 1; }
echo "$output"
