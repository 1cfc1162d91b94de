#!/bin/bash
# SPDX-License-Identifier: MIT
# Editor support in tools/editor: the grammar with VS Code's own engine, the extension, snippets, Vim.

. "$(dirname "$0")/lib.sh"
. "$(dirname "$0")/../../tools/setup.sh"

root=$(cd "$(dirname "$0")/../.." && pwd)
modules=${BUILD-${TMPDIR-/tmp}}/node-editor
setup_node_packages "$root/tests/system/editor" "$modules" vscode-textmate || no_node=yes

# with_node CASE [FILE]...: a case of editor/test.js.
with_node() {
    [[ -z ${no_node-} ]] || skip_case "there is no node with npm, or npm cannot install vscode-textmate (see $modules/npm.log)"
    NODE_PATH=$modules/node_modules exits 0 timeout 200 node "$root/tests/system/editor/test.js" \
        "$1" "$root/tools/editor" "$RKM04" "${@:2}"
}

test_the_grammar_gives_scopes() { with_node grammarScopes; }
test_snippets_are_programs() { with_node snippets; }
test_the_manifest_names_files_that_are_there() { with_node filesOfTheManifest; }
test_the_extension_starts_the_server() { with_node extensionStartsTheServer; }

# The good programs of CHECK.md, and a program with everything in it.
programs() {
    awk -v out="$folder" '/^```rks good/ { file = out "/good" ++n ".rks"; next } /^```/ { file = ""; next }
        file != "" { print > file }' "$root/docs/CHECK.md"
    printf "%s\n" "\\C100 {a {b} =-5 = - 5 D I 01 H 20 G + G-" "V" "9000 A1 S1 X01 U M01 N08 O80 Z95 (01 )08 '5 ’5" \
        "@20 @5 L 3 F1 Y R B1 E T58 C58 [ ] . H J20 W5 G7" >"$folder/all.rks"
}

test_the_grammar_agrees_with_the_unit() {
    programs
    with_node grammarAgreesWithTheUnit "$folder"/*.rks
}

# vim_says FILE EXPRESSION: what Vim says with the files of tools/editor/vim.
vim_says() {
    HOME=$folder vim -u NONE -i NONE -N -n -es --cmd "set runtimepath^=$root/tools/editor/vim encoding=utf-8" \
        --cmd 'filetype plugin on' --cmd 'syntax on' "$1" -c "call writefile([$2], '$folder/says')" -c 'qa!' </dev/null
    cat "$folder/says"
}

# group LINE COLUMN: the group of the syntax there, in Vim.
group() {
    echo "synIDattr(synID($1, $2, 1), 'name')"
}

test_vim_knows_type_and_syntax() {
    command -v vim >/dev/null && vim --version | grep -q '+syntax' || skip_case "there is no vim with syntax"
    printf '%s\n' "@5 q {nolint x} F" "5 R I01H5" >"$folder/p.rks"
    same "rks {%s}" "$(vim_says "$folder/p.rks" "&filetype . ' ' . &commentstring")" "the type"
    same "rksLabel rksError rksNolint rksComment rksParameter rksNumber rksMotion rksFlow rksTarget" "$(vim_says "$folder/p.rks" \
        "join([$(group 1 1), $(group 1 4), $(group 1 8), $(group 1 14), $(group 1 17), $(group 2 1), $(group 2 3), $(group 2 5), \
        $(group 2 9)])")" "the groups"
}

test_vim_finds_no_error_in_programs_without_one() {
    command -v vim >/dev/null && vim --version | grep -q '+syntax' || skip_case "there is no vim with syntax"
    programs
    for file in "$folder"/*.rks; do
        same "" "$(vim_says "$file" "join(filter(map(range(1, line('$')), {_, l -> join(map(filter(range(1, col([l, '$'])), \
            {_, c -> synIDattr(synID(l, c, 1), 'name') ==# 'rksError'}), {_, c -> l . ':' . c}))}), {_, t -> t != ''}))")" "$file"
    done
}

test_vim_checks_and_lays_out() {
    command -v vim >/dev/null && vim --version | grep -q '+syntax' || skip_case "there is no vim with syntax"
    mkdir "$folder/bin"
    ln -s "$RKM04" "$folder/bin/rkm04"
    export PATH=$folder/bin:$PATH
    printf 'W5\nF5 r\n' >"$folder/bad.rks"
    HOME=$folder vim -u NONE -i NONE -N -n -es --cmd "set runtimepath^=$root/tools/editor/vim" --cmd 'filetype plugin on' \
        "$folder/bad.rks" -c 'silent make!' \
        -c "call writefile(map(getqflist(), {_, q -> q.lnum . ':' . q.col . q.type . ' ' . q.text}), '$folder/says')" -c 'qa!' \
        </dev/null >/dev/null 2>&1
    holds "$(<"$folder/says")" "2:4e expected a command, found 'r'" "the error"
    printf 'L2 F5 R E' >"$folder/good.rks"
    HOME=$folder vim -u NONE -i NONE -N -n -es --cmd "set runtimepath^=$root/tools/editor/vim" --cmd 'filetype plugin on' \
        "$folder/good.rks" -c 'silent normal! gggqG' -c 'wq' </dev/null
    same $'L2\n    F5 R\nE' "$(<"$folder/good.rks")" "the layout"
}

run_cases "$@"
