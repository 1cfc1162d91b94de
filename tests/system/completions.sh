#!/bin/bash
# SPDX-License-Identifier: MIT
# Completion of commands and options in each shell, made from --help.

. "$(dirname "$0")/lib.sh"
root=$(cd "$(dirname "$0")/../.." && pwd)
made=$(mktemp -d)
trap 'rm -rf "$made"' EXIT
RKM04=$RKM04 RKMCTL=$RKMCTL "$root/tools/completions" "$made" || exit 1

# bash_offers WORD...: what bash offers for the last word.
bash_offers() {
    bash -c 'source "$1/$2"; COMP_WORDS=("${@:2}"); COMP_CWORD=$((${#COMP_WORDS[@]} - 1))
        "_$2" "$2" "${COMP_WORDS[COMP_CWORD]}" "${COMP_WORDS[COMP_CWORD - 1]}"; printf "%s\n" "${COMPREPLY[@]}"' \
        - "$made/bash" "$@"
}

test_bash_offers_commands_and_options() {
    holds "$(bash_offers rkm04 se)" "serve" "a command"
    holds "$(bash_offers rkm04 serve --fl)" "--flash=" "an option"
    same "" "$(bash_offers rkm04 exec --fl)" "an option of another command"
    holds "$(bash_offers rkmctl pos)" "position" "a command of rkmctl"
    holds "$(bash_offers rkmctl --po)" "--port=" "an option of rkmctl"
    for command in set send raw; do
        holds "$(bash_offers rkmctl "$command")" "$command" "a command with an argument"
    done
}

test_fish_offers_commands_and_options() {
    fish_offers() { fish --no-config -c "source $made/fish/$1.fish; complete -C '$2'"; }
    export HOME=$folder
    holds "$(fish_offers rkm04 'rkm04 se')" "serve" "a command"
    holds "$(fish_offers rkm04 'rkm04 serve --fl')" "--flash" "an option"
    holds "$(fish_offers rkmctl 'rkmctl --po')" "--port" "an option of rkmctl"
}

# A person at zsh, who types and presses Tab.
test_zsh_completes_commands_and_options() {
    export HOME=$folder
    shown=$(python3 - "$made/zsh" <<'END'
import os, pty, select, sys, time
child, terminal = pty.fork()
if child == 0:
    os.environ.update(TERM="dumb", PS1="ready> ")
    os.execvp("zsh", ["zsh", "-f", "-i"])
shown = b""
def read_until(part, limit=30):
    global shown
    begin, end = len(shown), time.monotonic() + limit
    while part not in shown[begin:] and time.monotonic() < end:
        if select.select([terminal], [], [], 1)[0]:
            shown += os.read(terminal, 4096)
read_until(b"ready> ")
os.write(terminal, f"fpath=({sys.argv[1]} $fpath); autoload -U compinit; compinit -u -D; echo is-$((1 + 1))\n".encode())
read_until(b"is-2")
os.write(terminal, b"rkm04 ser\t")
read_until(b"serve ")
os.write(terminal, b"--fla\t")
read_until(b"--flash=")
os.write(terminal, b"\x15rkmctl posi\t")
read_until(b"position ")
os.write(terminal, b"\x15exit\n")
print(shown.decode(errors="replace"))
END
    )
    holds "$shown" "rkm04 serve" "a command"
    holds "$shown" "--flash=" "an option"
    holds "$shown" "rkmctl position" "a command of rkmctl"
}

test_all_files_are_right_for_their_shell() {
    for file in "$made"/bash/*; do bash -n "$file" || fail "$file"; done
    for file in "$made"/zsh/*; do zsh -n "$file" || fail "$file"; done
    for file in "$made"/fish/*; do fish --no-config -n "$file" || fail "$file"; done
}

run_cases "$@"
