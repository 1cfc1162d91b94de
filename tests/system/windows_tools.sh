#!/bin/bash
# SPDX-License-Identifier: MIT
# rkm04.exe under Wine with other programs: an editor at `lsp', diff of `fmt --diff', rsvg-convert of `plot -o FILE.png'.

. "$(dirname "$0")/lib.sh"
. "$(dirname "$0")/../../tools/wine.sh"

: "${RKM04_EXE=}"
[[ -f $RKM04_EXE ]] || skip_all "rkm04.exe is not built; apt-get install gcc-mingw-w64-x86-64-win32"
has_wine || skip_all "there is no Wine; apt-get install wine64"
root=$(cd "$(dirname "$0")/../.." && pwd)
build=${BUILD-${TMPDIR-/tmp}}

# One prefix for all cases: it takes its time.
prefix=$(mktemp -d)
trap 'end_wine "$prefix"; rm -rf "$prefix"' EXIT
make_wine "$prefix" || skip_all "Wine makes no prefix"

exe() { wine_in "$prefix" "$RKM04_EXE" "$@"; }

# An editor starts programs, not functions.
as_program() {
    printf '#!/bin/bash\n. %q\nwine_in %q %q "$@" 2>>%q\n' "$root/tools/wine.sh" "$prefix" "$RKM04_EXE" "$folder/editor.err" \
        >"$folder/rkm04"
    chmod +x "$folder/rkm04"
}

with_pygls() {
    local python reason status
    python=$(sed -n 's/^Python_EXECUTABLE:.*=\|^_Python_EXECUTABLE:.*=//p' "$build/CMakeCache.txt" 2>/dev/null | head -n 1)
    reason=$("$root/tools/python-env" "$build/python-env" "${python:-python3}")
    status=$?
    ((status != 77)) || skip_case "${reason#skipped: }"
    ((status == 0)) || fail "$reason"
    "$build/python-env/bin/python" -c 'import pygls' 2>/dev/null || skip_case "pygls needs Python 3.10 or later"
    as_program
    exits 0 "$build/python-env/bin/python" -B "$root/tests/system/lsp_client.py" "$1" "$folder/rkm04"
}

test_lsp_reports_what_follows_edits() { with_pygls diagnostics_follow_edits; }
test_lsp_finds_labels() { with_pygls labels; }
test_lsp_explains_and_lays_out() { with_pygls hover_lens_and_layout; }
test_lsp_completes() { with_pygls completion_has_ranges; }
test_lsp_keeps_up_with_a_fast_typist() { with_pygls a_fast_typist; }

# message TEXT: a frame.
message() { printf 'Content-Length: %d\r\n\r\n%s' "${#1}" "$1"; }

test_lsp_answers_byte_for_byte_and_ends_alike() {
    local document='"uri":"file:///C:/p.rks","languageId":"rks","version":1,"text":"F5 R @1 q\nJ1 {\u010dau \ud83d\ude00} q"'
    {
        message '{"jsonrpc":"2.0","id":1,"method":"initialize","params":{"capabilities":{}}}'
        message '{"jsonrpc":"2.0","method":"initialized","params":{}}'
        message '{"jsonrpc":"2.0","method":"textDocument/didOpen","params":{"textDocument":{'"$document"'}}}'
        message '{"jsonrpc":"2.0","id":2,"method":"textDocument/hover","params":{"textDocument":{"uri":"file:///C:/p.rks"},
            "position":{"line":0,"character":0}}}'
        message '{"jsonrpc":"2.0","id":3,"method":"shutdown"}'
        message '{"jsonrpc":"2.0","method":"exit"}'
    } >"$folder/messages"
    "$RKM04" lsp <"$folder/messages" >"$folder/here" 2>"$folder/here.err"
    same 0 $? "exit status here"
    exe lsp <"$folder/messages" >"$folder/there" 2>"$folder/there.err"
    same 0 $? "exit status there"
    grep -q '"contents"' "$folder/here" || fail "the editor is told nothing"
    cmp "$folder/here" "$folder/there" || fail "the answers"
    exe lsp </dev/null >"$folder/there" 2>"$folder/there.err"
    same 1 $? "exit status without an editor"
    echo hello | exe lsp >"$folder/there" 2>"$folder/there.err"
    same 1 $? "exit status with nonsense"
    cmp "$folder/there.err" <(echo hello | "$RKM04" lsp 2>&1) || fail "the reason"
}

# stand_in NAME BODY: a program for Windows that the emulator finds, in $folder/bin.
stand_in() {
    mkdir -p "$folder/bin"
    printf '#include <%s>\n' fcntl.h io.h stdio.h string.h >"$folder/$1.c"
    printf 'int main(int argc, char **argv)\n{\n%s\n}\n' "$2" >>"$folder/$1.c"
    x86_64-w64-mingw32-gcc -o "$folder/bin/$1.exe" "$folder/$1.c" 2>"$folder/$1.err" || fail "$1"
}

with_bin() { WINEPATH="Z:${folder//\//\\}\\bin" exe "$@"; }

test_fmt_diff_runs_diff_with_names_and_texts() {
    stand_in diff '_setmode(1, _O_BINARY);
        for (int i = 1; i < argc - 2; i++) printf("<%s>\n", argv[i]);
        for (int i = argc - 2; i < argc; i++) {
            FILE *file = strpbrk(argv[i], "/\\") ? fopen(argv[i], "rb") : NULL; /* not where we are: that may be read-only */
            for (int c; file && (c = getc(file)) != EOF;) putchar(c);
            puts("--");
        }
        return 1;'
    cd "$folder" || fail "cd"
    mkdir "my programs"
    printf '  \\C100   S100\n' >"my programs/p.rks"
    : >diff.err
    ls -A >before
    same $'<-u>\n<--label=my programs/p.rks>\n<--label=my programs/p.rks (formatted)>\n  \\C100   S100\n--\n\\ C100 S100\n--' \
        "$(with_bin fmt --diff "my programs/p.rks" 2>diff.err)" "what diff is given"
    ls -A >after
    same "$(<before)" "$(grep -v '^after$' after)" "the folder, in which nothing is left"
}

test_a_file_that_another_program_has_open_is_reported() {
    local arguments
    stand_in holder 'for (int i = 1; i < argc; i++)
            if (_sopen(argv[i], _O_RDWR | _O_CREAT, 0x10 /* _SH_DENYRW */, 0600) < 0) return 1;
        puts("open"); fflush(stdout);
        return getchar();'
    cd "$folder" || fail "cd"
    mkfifo until
    wine_in "$prefix" bin/holder.exe held.rks held.csv held.flash <until >holder.out 2>holder.err &
    processes+=($!)
    exec 3>until
    soon "the files are open" grep -qs open holder.out
    printf 'F5 R' >p.rks
    for arguments in "exec held.rks" "check held.rks" "exec --trace held.csv p.rks" "serve --tcp 0 --flash held.flash"; do
        # shellcheck disable=SC2086
        exits 1 exe $arguments
        holds "$complained" ": another program has it open" "the message of $arguments"
    done
    exec 3>&-
}

test_without_diff_and_rsvg_convert_the_message_says_so() {
    cd "$folder" || fail "cd"
    printf 'F5 R' >p.rks
    exe fmt --diff p.rks >there.out 2>there.err
    same 1 $? "exit status of fmt --diff"
    holds "$(<there.err)" "cannot run diff" "the message"
    exe plot -o p.png p.rks >there.out 2>there.err
    same 1 $? "exit status of plot"
    holds "$(<there.err)" "rsvg-convert is not installed; ask for .svg" "the message"
    [[ ! -e p.png ]] || fail "a picture is left behind"
}

test_plot_makes_a_PNG_of_all_its_bytes() {
    stand_in rsvg-convert '_setmode(0, _O_BINARY); _setmode(1, _O_BINARY);
        fwrite("\x89PNG\r\n\x1a\n", 1, 8, stdout);
        for (int i = 1; i < argc; i++) printf("%s ", argv[i]);
        for (int c; (c = getchar()) != EOF;) putchar(c);
        return 0;'
    cd "$folder" || fail "cd"
    printf '\\C100 S100 V1000 A2000 F500 R' >p.rks
    with_bin plot -o there.png p.rks >there.out 2>there.err || fail "plot"
    "$RKM04" plot -o here.svg p.rks >here.out 2>here.err || fail "plot here"
    { printf '\x89PNG\r\n\x1a\n--format png --zoom 2 '; cat here.svg; } >wanted
    cmp wanted there.png || fail "the picture: $(head -c 60 there.png)"
}

run_cases "$@"
