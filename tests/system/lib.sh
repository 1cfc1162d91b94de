# SPDX-License-Identifier: MIT
# lib.sh: what the system tests share. Real processes, one temporary folder a case, no fixed ports or paths, and no waiting
# but for a condition with a time limit.
#
# A test file sources this, defines functions test_CLAUSE_what_is_so and ends with: run_cases "$@"
# RKM04 and RKMCTL name the programs; ctest sets them. Each case runs in a shell of its own, which starts with the folder
# $folder and ends with everything it started.

set -u
: "${RKM04:=rkm04}" "${RKMCTL:=rkmctl}"
limit=60 # seconds until a condition counts as never coming true
export RKM04_TIMEOUT=20000 # ms: a busy machine may let a unit wait; a test that wants silence gives its --timeout

# What went wrong, with what the programs said, and out.
fail() {
    local file
    printf '  failed: %s\n' "$*"
    for file in "$folder"/*.err; do
        [[ -s $file ]] && printf '  %s said:\n' "${file##*/}" && tail -n 15 "$file" | sed 's/^/    /'
    done
    exit 1
}

# skip_all REASON: out, before any case: the tests of this file need what is not there. tools/test shows the reason.
skip_all() {
    echo "skipped: $*"
    exit 77
}

# skip_case REASON: out of a case that needs what is not there.
skip_case() {
    echo "  skipped: ${FUNCNAME[1]}: $*"
    exit 0
}

# same WANTED GOT WHAT: both texts are equal.
same() {
    [[ $1 == "$2" ]] || fail "$3: expected '$1', got '$2'"
}

# holds TEXT PART WHAT: the text has the part in it.
holds() {
    [[ $1 == *"$2"* ]] || fail "$3: expected '$2' in '$1'"
}

# exits STATUS COMMAND...: the command ends with this status; its output is in $said and its errors in $complained.
exits() {
    local wanted=$1 status
    shift
    said=$("$@" 2>"$folder/complained" </dev/null)
    status=$?
    complained=$(<"$folder/complained")
    [[ $status == "$wanted" ]] || fail "'$*': expected exit status $wanted, got $status; it said '$said' '$complained'"
}

# alone COMMAND...: in a network namespace of its own, where rkmctl finds no emulator of another test.
alone() {
    local map=()
    [[ $(id -u) == 0 ]] || map=(--map-root-user)
    unshare --net "${map[@]}" "$@"
}

# make_in FOLDER COMMAND...: the command makes what is in this folder of the build, which belongs to several tests: one at a time.
make_in() {
    mkdir -p "$1"
    flock "$1.lock" "${@:2}"
}

# soon WHAT COMMAND...: the command succeeds before the time limit.
soon() {
    local what=$1 end=$((SECONDS + limit))
    shift
    until "$@"; do
        ((SECONDS < end)) || fail "not within $limit s: $what"
        sleep 0.02
    done
}

# start NAME COMMAND...: begin a process; $started is its id, its output goes to $folder/NAME.out and NAME.err.
start() {
    local name=$1
    shift
    rm -f "$folder/$name.out" "$folder/$name.err" # of a process of the same name before
    : >"$folder/$name.out"
    : >"$folder/$name.err"
    "$@" >"$folder/$name.out" 2>"$folder/$name.err" </dev/null &
    started=$!
    processes+=("$started")
}

# ended PID: the process is no more (or waits to be asked for its status).
ended() {
    local state
    state=$(ps -o stat= -p "$1")
    [[ -z $state || $state == Z* ]]
}

# status_of PID: wait for a process started here to end; its exit status is in $status.
status_of() {
    soon "process $1 ends" ended "$1"
    wait "$1"
    status=$?
}

# serve NAME OPTIONS...: start a unit on $folder/NAME and wait until it is ready; $started is its id.
serve() {
    local name=$1
    shift
    start "$name" "$RKM04" serve --link "$folder/$name" --verbose "$@"
    soon "unit $name is ready" ready "$name"
}

ready() {
    local over=
    ended "$started" && over=1 # asked first: it may be ready and end at once
    grep -qs '^READY ' "$folder/$1.out" && return
    [[ -z $over ]] || fail "unit $1 ended before it was ready"
    return 1
}

# ctl NAME ARGUMENTS...: the client on the unit's link.
ctl() {
    "$RKMCTL" -p "$folder/$1" "${@:2}"
}

# position_is NAME MOTOR STEPS
position_is() {
    [[ $(ctl "$1" -m "$2" position 2>"$folder/ctl.err") == "motor $2: $3" ]]
}

# say_bytes FD HEX: bytes as they are.
say_bytes() {
    local hex=${2// /}
    # shellcheck disable=SC2059
    printf "$(sed 's/../\\x&/g' <<<"$hex")" >&"$1"
}

# hear_bytes FD COUNT: so many bytes as hex, or fewer if they do not come in time.
hear_bytes() {
    timeout "$limit" head -c "$2" <&"$1" | od -An -v -tx1 | tr -d ' \n'
}

# dialogue FD REQUEST ANSWER WHAT: these bytes are answered by those; both in hex, blanks do not count.
dialogue() {
    local wanted=${3// /}
    say_bytes "$1" "$2"
    same "$wanted" "$(hear_bytes "$1" $((${#wanted} / 2)))" "$4"
}

# The end of a case: of its processes and folders. What a sanitizer has found in a process, at its end too (leaks), is a failure.
leave() {
    local process found=
    for process in ${processes[@]+"${processes[@]}"}; do
        kill "$process" 2>/dev/null
    done
    for process in ${processes[@]+"${processes[@]}"}; do
        wait "$process" 2>/dev/null
        (($? == 99)) && found+=" $process"
    done
    [[ -z $found ]] || (fail "a sanitizer has ended:$found")
    rm -rf "$folder" "$folder.runtime"
    [[ -z $found ]] || exit 1
}

run_case() {
    processes=()
    folder=$(mktemp -d) || exit 1
    trap leave EXIT
    export XDG_RUNTIME_DIR=$folder.runtime # default links and control sockets are in it
    mkdir "$XDG_RUNTIME_DIR"
    "$1"
}

# run_cases [NAME...]: every test_ function of the file, or these.
run_cases() {
    local name failed=0
    # shellcheck disable=SC2046
    (($# > 0)) || set -- $(compgen -A function test_)
    for name; do
        if (run_case "$name"); then
            echo "ok $name"
        else
            echo "FAILED $name; alone: RKM04=$RKM04 RKMCTL=$RKMCTL${RKM04_WINDOW:+ RKM04_WINDOW=$RKM04_WINDOW} $0 $name"
            failed=1
        fi
    done
    exit $failed
}
