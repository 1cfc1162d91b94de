#!/bin/bash
# SPDX-License-Identifier: MIT
# What `cmake --install` puts in place is enough for a program of others.
# BUILD: the build folder; CC: the compiler; SANITIZE: its options if the library was built with sanitizers.

. "$(dirname "$0")/lib.sh"
: "${CC:=cc}" "${BUILD:=build/dev}" "${SANITIZE:=}"

install_there() {
    DESTDIR=$folder/stage cmake --install "$BUILD" --prefix /opt/rkm04 >"$folder/install.err" 2>&1 || fail "cmake --install"
    staged=$folder/stage/opt/rkm04
    PKG_CONFIG_PATH=$(dirname "$(find "$staged" -name rkm04.pc)")
    export PKG_CONFIG_PATH
}

test_a_program_builds_against_the_installed_library() {
    install_there
    cat >"$folder/user.c" <<'END'
#include <stdio.h>
#include <rkm04/unit.h>

int main(void)
{
    static struct rkm04_unit unit;
    static const struct rkm04_port port;
    struct rkm04_config config = {.node = 1};
    struct rkm04_motor_state state;

    rkm04_init(&unit, &config, &port, NULL);
    rkm04_set_command(&unit, '2', "S100 V1000 A2000 F5000 R", 24, NULL);
    rkm04_advance(&unit, 10 * RKM04_TICKS_PER_SECOND);
    rkm04_motor_state(&unit, 2, &state);
    printf("%d\n", (int)state.position);
    return 0;
}
END
    # shellcheck disable=SC2046,SC2086
    $CC -std=c11 -Wall -Wextra -Werror $SANITIZE -o "$folder/user" "$folder/user.c" $(pkg-config --cflags --libs rkm04) \
        2>"$folder/cc.err" || fail "the program does not build"
    exits 0 "$folder/user"
    same 5000 "$said" "position of motor 2"
    same "$("$RKM04" --version)" "rkm04 $(pkg-config --modversion rkm04)" "version in rkm04.pc"
}

test_every_public_header_compiles_alone() {
    install_there
    local header
    for header in "$staged"/include/rkm04/*.h; do
        # shellcheck disable=SC2046
        echo "#include <rkm04/${header##*/}>" |
            $CC -std=c11 -Wall -Wextra -Wconversion -Werror $(pkg-config --cflags rkm04) -fsyntax-only -x c - \
                2>"$folder/cc.err" || fail "${header##*/} does not compile alone"
    done
}

test_every_public_header_is_one_of_Cpp_too() {
    install_there
    local header
    for header in "$staged"/include/rkm04/*.h; do
        # shellcheck disable=SC2046
        echo "#include <rkm04/${header##*/}>" |
            c++ -std=c++17 -Wall -Wextra -Wconversion -pedantic -Werror $(pkg-config --cflags rkm04) -fsyntax-only -x c++ - \
                2>"$folder/cc.err" || fail "${header##*/} does not compile as C++"
    done
}

test_CMake_finds_the_library_for_a_program_in_Cpp() {
    install_there
    mkdir "$folder/user"
    cat >"$folder/user/CMakeLists.txt" <<'END'
cmake_minimum_required(VERSION 3.25)
project(user LANGUAGES CXX)
find_package(rkm04 0.1 REQUIRED CONFIG)
add_executable(user user.cpp)
target_link_libraries(user PRIVATE rkm04::rkm04)
END
    cat >"$folder/user/user.cpp" <<'END'
#include <iostream>
#include <memory>
#include <string>
#include <rkm04/unit.h>

int main()
{
    static const rkm04_port port{};
    auto unit = std::make_unique<rkm04_unit>();
    rkm04_config config{};
    config.node = 1;
    const std::string program = "S100 V1000 A2000 F5000 R";
    struct rkm04_motor_state state{};

    rkm04_init(unit.get(), &config, &port, nullptr);
    rkm04_set_command(unit.get(), '2', program.data(), program.size(), nullptr);
    rkm04_advance(unit.get(), 10 * RKM04_TICKS_PER_SECOND);
    rkm04_motor_state(unit.get(), 2, &state);
    std::cout << state.position << '\n';
}
END
    cmake -S "$folder/user" -B "$folder/made" -DCMAKE_PREFIX_PATH="$staged" -DCMAKE_CXX_FLAGS="$SANITIZE -Wall -Wextra -Werror" \
        >"$folder/cmake.err" 2>&1 || fail "find_package"
    cmake --build "$folder/made" >"$folder/make.err" 2>&1 || fail "the program does not build"
    exits 0 "$folder/made/user"
    same 5000 "$said" "position of motor 2"
}

test_programs_and_man_pages_are_installed() {
    install_there
    local page
    exits 0 "$staged/bin/rkm04" --version
    exits 0 "$staged/bin/rkmctl" --version
    for page in rkm04.1 rkmctl.1; do
        [[ -s $(find "$staged" -path "*/man1/$page") ]] || fail "$page is missing"
    done
}

test_completions_lie_where_the_shells_look() {
    install_there
    for file in bash-completion/completions/rkm04 bash-completion/completions/rkmctl zsh/vendor-completions/_rkm04 \
        zsh/vendor-completions/_rkmctl fish/vendor_completions.d/rkm04.fish fish/vendor_completions.d/rkmctl.fish; do
        [[ -s $staged/share/$file ]] || fail "no $file"
    done
}

run_cases "$@"
