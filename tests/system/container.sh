#!/bin/bash
# SPDX-License-Identifier: MIT
# The container file. The image is built where podman or buildah is there; everywhere its text and its packages are checked, and
# what the container would start is started.

. "$(dirname "$0")/lib.sh"
source=$(cd "$(dirname "$0")/../.." && pwd)
file=$source/packaging/Containerfile

# The instructions of the file, one a line, without comments.
instructions() {
    sed '/^[[:space:]]*#/d; /^[[:space:]]*$/d' "$file" | sed -e ':more' -e '/\\$/{N; s/\\\n[[:space:]]*//; bmore' -e '}'
}

# words INSTRUCTION: the words of its JSON array, one a line.
words() {
    instructions | sed -n "s/^$1 \[\(.*\)\]\$/\1/p" | grep -o '"[^"]*"' | tr -d '"'
}

test_every_instruction_is_known_and_has_its_arguments() {
    local line word arguments stages=' '
    local array='^\[ *"[^"\]*"( *, *"[^"\]*")* *\]$'
    while IFS= read -r line; do
        read -r word arguments <<<"$line"
        [[ $stages != ' ' || $word == FROM ]] || fail "'$line' stands before FROM"
        case $word in
            FROM)
                [[ $arguments =~ ^[a-z0-9./_-]+:[a-z0-9._-]+(\ AS\ [a-z]+)?$ ]] || fail "image, its tag and AS: $line"
                stages+="${arguments##*AS } "
                ;;
            RUN) sh -n -c "$arguments" 2>"$folder/sh.err" || fail "the shell does not understand: $arguments" ;;
            COPY)
                if [[ $arguments == --from=* ]]; then
                    word=${arguments%% *}
                    holds "$stages" " ${word#--from=} " "stages before $line"
                else
                    [[ -e $source/${arguments%% *} ]] || fail "there is no ${arguments%% *} to be copied"
                fi
                [[ $arguments == *' '* ]] || fail "COPY needs two places: $line"
                ;;
            USER) [[ $arguments =~ ^[0-9]+:[0-9]+$ && $arguments != 0:* ]] || fail "expected a user other than root: $line" ;;
            WORKDIR | VOLUME) [[ $arguments == /* ]] || fail "expected a path: $line" ;;
            EXPOSE) [[ $arguments =~ ^[0-9]+$ ]] || fail "expected a port: $line" ;;
            ENTRYPOINT | CMD) [[ $arguments =~ $array ]] || fail "expected a JSON array: $line" ;;
            *) fail "unknown instruction: $line" ;;
        esac
    done < <(instructions)
    [[ $stages == *' build '* ]] || fail "the file has no stage that builds"
}

test_the_command_of_the_container_serves_tcp_to_all_and_on_the_port_that_is_exposed() {
    local words
    mapfile -t words < <(words ENTRYPOINT && words CMD)
    same "rkm04 serve --tcp 0.0.0.0:$(instructions | sed -n 's/^EXPOSE //p')" "${words[*]}" "what the container runs"
}

# The same command here, on a port that is free and for this machine alone.
test_the_command_of_the_container_starts_and_answers() {
    local words port
    mapfile -t words < <(words CMD)
    start unit "$RKM04" "${words[@]/#0.0.0.0:*/127.0.0.1:0}"
    soon "the unit is ready" ready unit
    port=$(sed -n 's/^READY .*"tcp":[^0-9]*\(127.0.0.1:\)\{0,1\}\([0-9]*\).*/\2/p' "$folder/unit.out")
    exits 0 "$RKMCTL" -p "tcp:127.0.0.1:$port" version
    kill -TERM "$started"
    status_of "$started"
    same 0 "$status" "exit status after SIGTERM, with which engines end a container"
}

test_what_is_built_in_the_source_stays_out_of_the_image() {
    grep -qx build/ "$source/.dockerignore" || fail "the image would take the build folder along"
}

# A list of packages that is not the one with which the tree builds makes no image.
test_the_image_is_built_with_the_packages_that_the_set_up_installs() {
    local wanted listed
    wanted=$(. "$source/tools/setup.sh" && printf '%s\n' "${run_packages[@]}" "${package_packages[@]}" | sort)
    listed=$(instructions | sed -n '/ AS build$/,/^FROM [^ ]*$/s/.* install [^&]*--no-install-recommends *\([^&]*\)&&.*/\1/p' |
        tr -s ' ' '\n' | grep . | sort)
    same "$wanted" "$listed" "packages of the stage that builds"
}

test_the_image_can_be_built_where_there_is_an_engine() {
    local engine image=rkm04-test-$$
    for engine in podman buildah; do
        command -v "$engine" >/dev/null && break
        engine=
    done
    [[ -n $engine ]] || return 0 # the packages are compared above, the command is started above
    "$engine" build -t "$image" -f "$file" "$source" >"$folder/build.err" 2>&1 || fail "$engine build"
    "$engine" rmi "$image" >"$folder/rmi.out" 2>&1 || fail "$engine rmi"
}

run_cases "$@"
