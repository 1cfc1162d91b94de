#!/bin/bash
# SPDX-License-Identifier: MIT
# The licence: every source says it, the package says the same, and what the programs are linked with is named.

. "$(dirname "$0")/lib.sh"
source=$(cd "$(dirname "$0")/../.." && pwd)

test_a_source_without_its_licence_is_found() {
    mkdir "$folder/tree"
    printf '// SPDX-License-Identifier: MIT\n' >"$folder/tree/good.c"
    exits 0 "$source/tools/check-licence" "$folder/tree"
    printf 'int x;\n' >"$folder/tree/bad.c"
    exits 1 "$source/tools/check-licence" "$folder/tree"
    holds "$said" "bad.c: expected" "the file"
}

# The texts as words, without the marks of Debian's form.
words() { sed 's/^ \.$//' | tr -s ' \n' ' '; }

test_the_package_has_the_text_of_the_licence() {
    same "$(sed '1,/^Copyright/d' "$source/LICENSE" | words | sed 's/^ //')" \
        "$(sed '1,/^License: Expat$/d' "$source/packaging/debian/copyright" | sed '1,/^License: Expat$/d' | words |
            sed 's/^ //')" \
        "the licence in packaging/debian/copyright"
}

test_every_library_that_the_programs_are_linked_with_is_named() {
    local program library found
    for program in "$RKM04" "$RKMCTL" ${RKM04_WINDOW:+"$RKM04_WINDOW"}; do
        found=0
        while IFS= read -r library; do
            found=$((found + 1))
            case $library in libasan | libubsan | libm | ld-linux*) continue ;; esac # of the compiler and of libc
            grep -qE "^\|.*\b$library\b.*\|" "$source/THIRD-PARTY.md" || fail "$library is not in THIRD-PARTY.md"
        done < <(readelf -d "$program" | sed -n 's/.*NEEDED.*\[\(lib[a-z0-9]*\).*/\1/p')
        ((found >= 3)) || fail "$program is linked with $found libraries only"
    done
}

run_cases "$@"
