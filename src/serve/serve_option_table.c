/* SPDX-License-Identifier: MIT */
#include "serve_option_table.h"

#include <stdio.h>

#include "serve_process.h"
#include "trace/trace.h"

static const struct argp_option table[] = {
    {NULL, 0, NULL, 0, "The units:", 1},
    {"node", KEY_NODE, "LIST", 0,
     "Addresses (DNode) of the units on the bus, 1 to 16, as in 3 or 1,2,5-8; default 1. The same address may be given twice",
     0},
    {"flash", KEY_FLASH, "FILE", 0,
     "Flash image of a unit; created if it does not exist. %n in it stands for the unit's address, %l for the number of the bus. "
     "Without it stored programs are lost when the emulator ends", 0},
    {"backup", KEY_BACKUP, "FILE", 0,
     "Backup memory of a CNC872, kept in this file; created if it does not exist. The same as --flash", 0},
    {NULL, 0, NULL, 0, "The bus:", 2},
    {"link", KEY_LINK, "PATH", 0,
     "Name of the symbolic link to the pty; default $XDG_RUNTIME_DIR/rkm04/bus0, else rkm04-UID/bus0 in the temporary "
     "directory. %l in it stands for the number of the bus", 0},
    {"wine", KEY_WINE, "PREFIX:COMn", 0,
     "Let the COM port of this Wine prefix lead to the link, as in ~/.wine:COM5; further buses have the next ports", 0},
    {"port", KEY_PORT, "DEVICE", 0,
     "Use this serial device or pty instead of creating a pty; on Windows a COM port, as in COM3", 0},
    {"rts", KEY_RTS, "WHO", 0,
     "What switches the driver of an RS485 device on while units send: driver (default), the kernel's driver if it can, else the "
     "adapter; toggles: the emulator, which switches RTS on while it sends", 0},
    {"tcp", KEY_TCP, "HOST:PORT", 0,
     "Offer the bus over TCP as plain bytes; default host 127.0.0.1, port 0: a free one. No pty without --link",
     0},
    {"rfc2217", KEY_RFC2217, "HOST:PORT", 0,
     "Offer the bus over TCP with RFC 2217: settings, purge, break and modem lines; HOST and PORT as of --tcp", 0},
    {"service", KEY_SERVICE, "NAME=HOST:PORT", 0,
     "Listen for clients of a server that the device has itself (`rkm04 devices --json' lists them); up to four", 0},
    {"baud", KEY_BAUD, "RATE", 0,
     "The rate of the unit (default; of an RKM04 19200): each byte takes its time, 520.8 us, in both directions; 0: bytes take "
     "no time", 0},
    {"turnaround", KEY_TURNAROUND, "US", 0,
     "Time from the end of a request to the start of the answer, 0 to 1000000 us; default 521, one character", 0},
    {"strict-line", KEY_STRICT_LINE, NULL, 0,
     "Bytes of a client with another speed or character format than the unit (RKM04: 19200 8N1) are garbled or lost, as on a "
     "real bus", 0},
    {"lines", KEY_LINES, "N", 0,
     "Number of buses, 1 to 256, each with all these units and a pty (bus0, bus1, ...) or TCP port (PORT, PORT+1, ...) of its "
     "own; default 1", 0},
    {NULL, 0, NULL, 0, "Time:", 3},
    {"clock", KEY_CLOCK, "CLOCK", 0,
     "real (default); xN: N times as fast, 0.001 to 10000; max: no pacing; time runs as fast as the machine "
     "allows; stepped: time is stopped until a client advances it; bytes take no time", 0},
    {"late", KEY_LATE, "WHAT", 0,
     "What happens after the process was stopped for a while: catch-up (default), the units catch up; skip: the units' clock was "
     "paused", 0},
    {NULL, 0, NULL, 0, "For tests:", 4},
    {"control", KEY_CONTROL, "PATH|tcp:HOST:PORT", 0,
     "Unix socket to read and change the state of all units (JSON-RPC; rkmctl --control); default: the link's name and "
     ".control; without a link, a name from the serial device, address or kind of device, in the folder of default links. "
     "tcp:PORT: a TCP port of this machine instead (0: a free one), and at that path a file with its address and a token, which "
     "clients take in place of the socket", 0},
    {"control-file", KEY_CONTROL_FILE, "PATH", 0, "With --control tcp:PORT: this file instead", 0},
    {"no-control", KEY_NO_CONTROL, NULL, 0, "No control socket", 0},
    {"window", KEY_WINDOW, "ADDRESS:PORT", OPTION_ARG_OPTIONAL,
     "Show the units in a browser, too (rkmctl window): the address is printed after READY; default 127.0.0.1:0, any port", 0},
    {"plant", KEY_PLANT, "FILE", 0, "Attach simulated mechanics: true positions, end stops, switches that drive inputs", 0},
    {"trace", KEY_TRACE, "FILE", 0,
     "Record every pulse, input, output and other event: " TRACE_HELP "; may be "
     "given up to eight times. %l in it stands for the number of the bus", 0},
    {"wire", KEY_WIRE, "FILE", 0, "Record the frames on the bus: FILE.log as text, FILE.pcapng for Wireshark; as --trace", 0},
    {"record", KEY_RECORD, "FILE", 0, "Record all inputs, so that `rkm04 replay FILE' can repeat the run", 0},
    {"force", KEY_FORCE, NULL, 0,
     "Also overwrite files of another kind with traces, logs, recordings and reports; never one that is also read or written "
     "otherwise", 0},
    {"seed", KEY_SEED, "N", 0, "Seed for injected faults with a probability; default 1", 0},
    {NULL, 0, NULL, 0, "Start, end and reports:", 5},
    {"verbose", KEY_VERBOSE, NULL, 0, "Also log each client that opens or closes the bus", 0},
    {"allow-folder", KEY_ALLOW_FOLDER, "DIR", 0,
     "Let control clients also read and write files below this folder; may be given up to 16 times. Without it: below the "
     "working directory (unless that is / or your home), and in the folders of the files named here", 0},
    {"no-sandbox", KEY_NO_SANDBOX, NULL, 0,
     "Allow all files and system calls; default: only those that are needed (Landlock, seccomp)", 0},
    {"ready-fd", KEY_READY_FD, "FD", 0, "Also write the READY line to this file descriptor, then close it", 0},
    {"exit-when-idle", KEY_EXIT_WHEN_IDLE, "SECONDS", OPTION_ARG_OPTIONAL,
     "End when no client has had the bus open for this many seconds of real time, 0 to 86400; default 10. With --port: when "
     "no byte has been received", 0},
    {"coverage", KEY_COVERAGE, "FILE", 0,
     "At the end write which messages, commands, flags and faults clients have used, as text, and to FILE.json",
     0},
    {"min-coverage", KEY_MIN_COVERAGE, "PERCENT", 0,
     "Exit status 4 if clients have used less than this percentage, 0 to 100, as in 72.5", 0},
    {0},
};

static const char doc[] =
    "Serve virtual RKM04 units on a bus until %s.\v"
    "When everything is ready, one line is printed to stdout: READY {\"pty\":...,\"link\":...,\"node\":...}. Logs go to stderr, "
    "with the units' own time in seconds.\n"
    "\n"
    "Examples:\n"
    "%s"
    "\n"
    "Exit status: 0 ended by a signal or --exit-when-idle, 1 failure at run time, 2 usage, 4 less than --min-coverage.";

const struct argp_option *serve_option_table(void)
{
    static struct argp_option fitted[sizeof table / sizeof table[0]];
    for (size_t i = 0; i < sizeof table / sizeof table[0]; i++) {
        fitted[i] = table[i];
        if (table[i].name)
            fitted[i].doc = serve_option_text(table[i].name, table[i].doc);
        if (table[i].name && !fitted[i].doc)
            fitted[i].flags |= OPTION_HIDDEN;
    }
    return fitted;
}

const char *serve_option_doc(void)
{
    static char fitted[2048];
    snprintf(fitted, sizeof fitted, doc, serve_ended_by, serve_examples);
    return fitted;
}

const char *serve_option_missing(int key)
{
    for (const struct argp_option *option = table; option->name || option->doc; option++)
        if (option->name && option->key == key && !serve_option_text(option->name, option->doc))
            return option->name;
    return NULL;
}
