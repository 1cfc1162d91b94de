#!/bin/bash
# SPDX-License-Identifier: MIT
# The units for systemd: understood by systemd, and what they start is what they promise. No service manager is needed: systemd's
# own checker reads the units, and a socket takes the part of the manager.
# BUILD: the build folder.

. "$(dirname "$0")/lib.sh"
: "${BUILD:=build/dev}"

# A root folder with the units installed, and with a shell that the checker can find.
install_root() {
    root=$folder/root
    DESTDIR=$root cmake --install "$BUILD" --prefix /usr >"$folder/install.err" 2>&1 || fail "cmake --install"
    rm "$folder/install.err"
    install -D -m 755 /bin/sh "$root/bin/sh"
}

# analyze WHAT...: systemd-analyze, which must have nothing to complain about.
analyze() {
    mkdir -p "$folder/runtime"
    XDG_RUNTIME_DIR=$folder/runtime SYSTEMD_LOG_LEVEL=notice \
        systemd-analyze "$@" >"$folder/analyze.out" 2>"$folder/analyze.err" ||
        fail "systemd-analyze $*"
    same "" "$(<"$folder/analyze.err")" "complaints of systemd-analyze $*"
}

test_systemd_understands_the_unit_of_the_system() {
    command -v systemd-analyze >/dev/null || skip_case "systemd is not installed"
    install_root
    local instance
    for instance in 3 press; do
        analyze verify --root="$root" --man=no --recursive-errors=no "rkm04@$instance.service"
    done
}

# For users the checker takes no other root, and would look for the program in /usr.
test_systemd_understands_the_unit_of_a_user() {
    command -v systemd-analyze >/dev/null || skip_case "systemd is not installed"
    install_root
    mkdir "$folder/user"
    sed "s,^ExecStart=rkm04 ,ExecStart=$root/usr/bin/rkm04 ," "$root/usr/lib/systemd/user/rkm04@.service" \
        >"$folder/user/rkm04@.service"
    analyze verify --user --man=no --recursive-errors=no "$folder/user/rkm04@.service"
}

test_the_service_of_the_system_has_few_rights() {
    command -v systemd-analyze >/dev/null || skip_case "systemd is not installed"
    install_root
    analyze security --offline=true --threshold=10 --root="$root" --no-pager rkm04@3.service # 0 none … 100 all
}

# A user's manager cannot do more without privileges (docs/INSTALL.md).
test_the_service_of_a_user_has_the_limits_that_need_no_privileges() {
    command -v systemd-analyze >/dev/null || skip_case "systemd is not installed"
    install_root
    analyze security --user --offline=true --threshold=65 --no-pager "$root/usr/lib/systemd/user/rkm04@.service"
}

# unit_line KEY: the value of a key of the unit of this scope, with the specifiers that systemd replaces.
unit_line() {
    sed -n "s/^$1=//p" "$root/usr/lib/systemd/$scope/rkm04@.service" |
        sed "s,%i,$instance,g; s,%t,$folder/run,g; s,%S,$folder/state,g; s,%%,%,g"
}

# Do what systemd does for an instance: make its folders, set its variables (further ones: the arguments), listen to its
# notifications, and start it. $started is its process.
start_instance() {
    local variables command
    mkdir -p "$folder/run/$(unit_line RuntimeDirectory)" "$folder/state/$(unit_line StateDirectory)"
    eval "variables=($(unit_line Environment))"
    command=$(unit_line ExecStart)
    start manager socat -u "UNIX-RECV:$folder/notify" -
    soon "the manager listens" test -S "$folder/notify"
    # Without quotes, so that LINE and the like become words, as systemd has it.
    start "$instance" env NOTIFY_SOCKET="$folder/notify" "${variables[@]}" "$@" bash -c "exec '$RKM04' ${command#rkm04 }"
    soon "the manager hears that the unit is ready" told READY=1
}

told() {
    grep -qsa "$1" "$folder/manager.out" && return
    ended "$started" && fail "the service ended"
    return 1
}

test_an_instance_is_ready_when_it_says_so_and_tells_its_end() {
    local scope instance=3
    install_root
    for scope in system user; do
        start_instance
        [[ -L $folder/run/rkm04/3/bus0 ]] || fail "there is no link when the unit is ready"
        exits 0 "$RKMCTL" -p "$folder/run/rkm04/3/bus0" -n 3 version
        kill -TERM "$started"
        status_of "$started"
        same 0 "$status" "exit status"
        soon "the manager hears that the unit ends" grep -qa STOPPING=1 "$folder/manager.out"
        same "" "$(ls -A "$folder/run/rkm04/3")" "files left in the folder of the instance"
        [[ -s $folder/state/rkm04/3/3 ]] || fail "there is no flash image"
        kill "${processes[-2]}" # the manager, which removes its socket
        status_of "${processes[-2]}"
        rm -f "$folder/notify"
    done
}

test_an_instance_with_a_name_takes_its_nodes_from_its_file() {
    local scope=system instance=press
    install_root
    start_instance NODE=2,5 "LINE=--tcp 127.0.0.1:0"
    local port
    port=$(sed -n 's/^READY .*"tcp":[^0-9]*\([0-9.]*:\)\{0,1\}\([0-9]*\).*/\2/p' "$folder/press.out")
    for node in 2 5; do
        exits 0 "$RKMCTL" -p "tcp:127.0.0.1:$port" -n "$node" version
    done
    exits 0 "$RKMCTL" -c "$folder/run/rkm04/press/control" state
}

test_an_instance_with_a_name_and_no_file_says_what_is_missing() {
    local scope=system instance=press variables
    install_root
    eval "variables=($(unit_line Environment))"
    local command
    command=$(unit_line ExecStart)
    exits 2 env "${variables[@]}" bash -c "exec '$RKM04' ${command#rkm04 }"
    holds "$complained" "\`press'" "complaint"
    same 2 "$(unit_line RestartPreventExitStatus)" "exit status after which it is not started again"
}

# The pty belongs to the service; those who may use serial ports may use it too.
test_the_group_of_serial_ports_may_use_pty_and_control_socket_of_the_service() {
    [[ $(id -u) == 0 ]] || skip_case "it needs root"
    getent group dialout >/dev/null || skip_case "there is no group dialout"
    local scope=system instance=3 post
    install_root
    start_instance
    eval "post=($(unit_line ExecStartPost))"
    "${post[0]}" "${post[1]}" "${post[2]//\$\$/\$}" || fail "ExecStartPost"
    same "dialout 660" "$(stat -L -c '%G %a' "$folder/run/rkm04/3/bus0")" "group and mode of the pty"
    same "dialout 660" "$(stat -c '%G %a' "$folder/run/rkm04/3/control")" "group and mode of the control socket"
}

run_cases "$@"
