# SPDX-License-Identifier: MIT
# tools/wine.sh: programs for Windows under Wine, without a screen, in a prefix of the caller's. Sourced; needs nothing but bash.

wine=$(command -v wine || command -v wine64 || echo /usr/lib/wine/wine64)
wineserver=$(command -v wineserver || echo /usr/lib/wine/wineserver64)

has_wine() { [[ -x $wine && -x $wineserver ]]; }

# wine_in PREFIX COMMAND...: run a program; the prefix is made if there is none.
wine_in() {
    env -u DISPLAY WINEPREFIX="$1" WINEDEBUG=-all WINEDLLOVERRIDES="mscoree,mshtml=" LC_ALL=C.UTF-8 timeout 200 "$wine" "${@:2}"
}

# make_wine PREFIX: make a prefix and have its server ready; what Wine says about that is not of interest. The server stays for
# WINE_IDLE seconds without programs (default 600): else it and the programs of Wine's system end after three, begin anew with the
# next program, and write to its stderr, now and then that one of them has ended by a page fault.
make_wine() {
    mkdir -p "$1"
    WINEPREFIX=$1 WINEDEBUG=-all timeout 60 "$wineserver" "-p${WINE_IDLE-600}" >/dev/null 2>&1
    wine_in "$1" cmd /c exit >/dev/null 2>&1
    [[ -d $1/dosdevices ]]
}

# end_wine PREFIX: end all that runs there, and remove the folder of its server's socket, which Wine leaves behind.
end_wine() {
    local folder=
    [[ -f $1/wineserver ]] && folder=${TMPDIR:-/tmp}/$(<"$1/wineserver")
    WINEPREFIX=$1 timeout 60 "$wineserver" -k 2>/dev/null
    WINEPREFIX=$1 timeout 60 "$wineserver" -w 2>/dev/null
    [[ $folder == */wine-?????? ]] && rm -rf "$folder"
    return 0
}
