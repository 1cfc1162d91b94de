#!/bin/bash
# SPDX-License-Identifier: MIT
# What the README and the documents show is so: their commands are run and their output is compared (transcripts.py).

. "$(dirname "$0")/lib.sh"
here=$(cd "$(dirname "$0")" && pwd)
source=$(cd "$here/../.." && pwd)

run_document() {
    python3 "$here/transcripts.py" "$source/$1" >"$folder/transcripts" 2>&1 || fail "$(<"$folder/transcripts")"
}

test_the_readme_does_what_it_shows() {
    run_document README.md
}

# CONTROL.md and FAULTS.md, which have dialogues in JSON, are run by control.sh and faults.sh.
test_the_documents_do_what_they_show() {
    local document
    for document in "$source"/docs/*.md; do
        [[ $document == */CONTROL.md || $document == */FAULTS.md ]] || run_document "docs/${document##*/}"
    done
}

test_a_transcript_that_is_wrong_is_found() {
    # shellcheck disable=SC2016
    printf '# A document\n\n    $ echo right\n    wrong\n' >"$folder/document.md"
    exits 1 python3 "$here/transcripts.py" "$folder/document.md"
    holds "$said" "echo right" "the command"
    printf '# A document\n\n<!-- run -->\n\n    false\n' >"$folder/document.md"
    exits 1 python3 "$here/transcripts.py" "$folder/document.md"
}

# manual PAGE: the text of a page, with plain hyphens and without its macros' fonts.
manual() {
    sed 's/\\-/-/g; s/\\f[BIRP]//g' "$source/docs/man/$1.1"
}

test_the_manual_pages_have_every_option() {
    local page option file
    for page in 'rkm04 serve' 'rkm04 exec' 'rkm04 test' 'rkm04 replay' 'rkm04 plot' \
        'rkm04 check' 'rkm04 fmt' 'rkm04 explain' 'rkm04 estimate' 'rkmctl'; do
        file=${page// /-} # rkm04-check(1), or all in rkm04(1)
        [[ -e $source/docs/man/$file.1 ]] || file=${page%% *}
        # shellcheck disable=SC2086
        set -- $page
        [[ $1 == rkm04 ]] && shift && set -- "$RKM04" "$@" || set -- "$RKMCTL"
        while IFS= read -r option; do
            [[ $option == --help || $option == --usage || $option == --version ]] && continue
            grep -qF -e "$option" <(manual "$file") || fail "$page $option is not in the manual page"
        done < <("$@" --help | grep -oE '^ +(-[a-z], )?--[a-z0-9-]+' | grep -oE -e '--[a-z0-9-]+')
    done
}

# Their section EXAMPLES as a document; an emulator of `rkm04 serve' stays, as in the shell of a document.
test_the_examples_of_the_manual_pages_work() {
    local page
    for page in rkm04 rkm04-check rkm04-fmt rkm04-explain rkm04-estimate; do
        {
            echo "<!-- run: echo 'S100 V500 F1000 R' >drill.rks; cp drill.rks x.rks; cp drill.rks y.rks;" \
                "echo 'motors: {1: {offset: 3}}' >axes.yaml -->"
            echo
            sed '1,/^\.SH EXAMPLES/d' "$source/docs/man/$page.1" |
                sed -n '/^\.EX$/,/^\.EE$/{/^\./d;s/\\-/-/g;s/ &$//;s,/tmp/,,g;s/^/    /;p}' |
                grep -v 'import serial' # at a port of its own
        } >"$folder/$page.md"
        python3 "$here/transcripts.py" "$folder/$page.md" >"$folder/transcripts" 2>&1 || fail "$(<"$folder/transcripts")"
        grep -qx '1 blocks' "$folder/transcripts" || fail "no examples in $page.1"
    done
}

test_the_manual_pages_have_every_kind_of_event() {
    local kind
    serve bus
    exits 2 "$RKMCTL" -c "$folder/bus.control" events bogus
    [[ $complained == *': step, '* ]] || complained=${complained/some of/: }
    for kind in $(sed 's/.*: *//; s/,//g' <<<"$complained"); do
        grep -qE "^[.]BR $kind [,.]$" <(manual rkmctl) || fail "the kind $kind is not in rkmctl(1)"
    done
    # Rows of a CSV trace: ",dir," and so on, in the table of trace_csv.c.
    for kind in $(grep -oE '",[a-z]+,"' "$source/src/trace/trace_csv.c" | tr -d '",'); do
        grep -qE "^(m1|unit),([a-z]+\|)*$kind[,|]" <(manual rkm04) || fail "the event $kind is not in rkm04(1)"
    done
}

run_cases "$@"
