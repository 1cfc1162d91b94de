#!/bin/bash
# SPDX-License-Identifier: MIT
# tools/stall, which stops processes of a test at random.

. "$(dirname "$0")/lib.sh"
stall=$(cd "$(dirname "$0")/../../tools" && pwd)/stall

test_processes_are_stopped_and_go_on() {
    cat >"$folder/children.py" <<'END'
import subprocess
children = [subprocess.Popen(["sleep", "1000"]) for _ in range(8)]
def state(child):
    with open(f"/proc/{child.pid}/stat", encoding="ascii") as file:
        return file.read().rpartition(")")[2].split()[0]
stopped = None
while stopped is None:
    stopped = next((child for child in children if state(child) == "T"), None)
while state(stopped) == "T":
    pass
for child in children:
    child.kill()
END
    exits 0 timeout 200 "$stall" --seed 1 --names sleep python3 "$folder/children.py"
    holds "$complained" "stall: --seed 1, exit status 0" "what it says"
}

test_the_status_is_that_of_the_command() {
    exits 7 "$stall" sh -c 'exit 7'
    exits 143 "$stall" sh -c 'kill $$'
    exits 2 "$stall"
    holds "$complained" "expected a command" "the message"
}

run_cases "$@"
