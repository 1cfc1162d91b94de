#!/bin/bash
# SPDX-License-Identifier: MIT
# The control socket: every example of docs/CONTROL.md, and clients that behave badly.
. "${0%/*}/lib.sh"

command -v python3 >/dev/null || skip_all "python3 is not there"
here=$(cd "${0%/*}" && pwd)
export RKM04 RKMCTL PYTHONDONTWRITEBYTECODE=1

test_every_example_of_the_document_is_so() {
    python3 "$here/control_examples.py" "$here/../../docs/CONTROL.md" >"$folder/examples" 2>&1 ||
        fail "$(grep -v '^ok' "$folder/examples")"
}

test_every_method_is_in_the_document_and_has_an_example() {
    local method methods
    methods=$(sed -n 's/^    {"\([a-z._]*\)", [a-z_]*\(, [a-z]*\)\?\(, N[A-Z_]*.*\)\?},$/\1/p' \
        "$here"/../../src/control/control_methods.c \
        "$here"/../../src/command/*.c "$here"/../../src/record/snapshot_command.c "$here"/../../src/device/pmc_device_methods.c)
    (($(wc -w <<<"$methods") >= 38)) || fail "the tables of methods are not where they were: $methods"
    for method in $methods; do
        grep -q "^#.*\`$method\`" "$here/../../docs/CONTROL.md" || fail "docs/CONTROL.md has no heading for $method"
        grep -q "^--> .*\"method\": \"$method\"" "$here/../../docs/CONTROL.md" || fail "docs/CONTROL.md has no example of $method"
    done
}

for name in $(sed -n 's/^def test_\([a-z_]*\).*/\1/p' "$here/control_robust.py"); do
    eval "test_$name() { python3 '$here/control_robust.py' 'test_$name' >\$folder/robust 2>&1 || fail \"\$(<\$folder/robust)\"; }"
done

run_cases "$@"
