#!/bin/bash
# SPDX-License-Identifier: MIT
# On which readings do the examples depend? rkm04 test --readings all of each.

. "$(dirname "$0")/lib.sh"
examples=$(cd "$(dirname "$0")/../../examples" && pwd)

# depends FILE LINE: what is said of an example.
depends() {
    exits 0 "$RKM04" test --readings all "$examples/$1.yaml"
    same "$examples/$1.yaml: $2" "$(sed -n 2p <<<"$said")" "the line about $1"
}

test_the_manuals_examples_depend_on_times_alone() {
    depends manual/9-1 "passes under 21 of 23; depends on planning"
    depends manual/9-2 "passes under 21 of 23; depends on planning"
    depends manual/9-3 "passes under 20 of 23; depends on planning"
    depends manual/9-4 "passes under 21 of 23; depends on planning"
    depends manual/9-5-at-once "passes under 21 of 23; depends on planning"
    depends manual/9-5 "passes under 20 of 23; depends on planning, input-filter"
    depends manual/9-6-both "passes under 17 of 23; depends on planning, input-filter"
    depends manual/9-6 "passes under 19 of 23; depends on planning"
    depends manual/9-7-stop "passes under 21 of 23; depends on input-filter"
    depends manual/9-7 "passes under 18 of 23; depends on planning, input-filter"
    depends manual/9-8 "passes under 21 of 23; depends on planning"
    depends manual/9-9 "passes under 21 of 23; depends on planning"
}

test_the_set_ups_depend_on_times_alone() {
    depends faults "passes under 21 of 23; depends on planning, input-filter"
    depends hand-over "passes under 21 of 23; depends on input-filter"
    depends linear-axis "passes under 20 of 23; depends on planning, input-filter"
    depends turntable "passes under 20 of 23; depends on planning, input-filter"
}

test_another_device_has_no_readings() {
    depends cib-feeder "passes under 1 of 1"
    depends pmc-drill "passes under 1 of 1"
}

test_every_example_is_tested_here() {
    local file
    for file in $(cd "$examples" && grep -l '^steps:' ./*.yaml manual/*.yaml | sed 's|^\./||; s|\.yaml$||'); do
        grep -q "depends $file " "$0" || fail "$file is not here"
    done
}

run_cases "$@"
