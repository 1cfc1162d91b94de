/* SPDX-License-Identifier: MIT */
#include "serve_process.h"

#include <fcntl.h>
#include <inttypes.h>
#include <signal.h>
#include <string.h>
#include <sys/resource.h>

#include "control/control.h"

#define FILES_LOOP 8u     /* descriptors: of the event loop */
#define FILES_WATCH 3u    /* of the watch for clients of ptys */
#define FILES_SERIAL 3u   /* of a pty or device, besides the timer of its bus */
#define FILES_CONTROL 2u  /* of the control socket */
#define FILES_COVERAGE 2u /* of the reports */
#define FILES_SPARE 8u   /* descriptors that are still free when all is open: for clients, traces, an adapter plugged in again */
#define FILES_BESIDE 64u /* as many more if the system allows: for more clients and traces */

const int serve_signals[SERVE_SIGNALS] = {SIGINT, SIGTERM, SIGHUP};

bool serve_signal_ends(int number)
{
    struct sigaction present;
    return number != SIGHUP || sigaction(number, NULL, &present) != 0 || present.sa_handler != SIG_IGN;
}

const char *serve_signal_name(int number)
{
    return number == SIGINT ? "SIGINT" : number == SIGTERM ? "SIGTERM" : "SIGHUP";
}

const char *serve_option_text(const char *name, const char *text)
{
    (void)name;
    return text;
}

const char serve_ended_by[] = "SIGINT or SIGTERM";

const char serve_examples[] =
    "  rkm04 serve\n"
    "  rkm04 serve --node 3 --flash unit3.flash --link ~/rkm04-3\n"
    "  rkm04 serve --node 1,2,5-8 --flash unit%n.flash\n"
    "  rkm04 serve --tcp 4000 --rfc2217 4001\n"
    "  rkm04 serve --port /dev/ttyUSB0 --framing plain\n"
    "  rkm04 serve --clock x20 --baud 0\n"
    "  rkm04 serve --readings hold-exit=latch,speed-change=500ms\n"
    "  rkm04 serve --clock stepped --control test.control --plant axis.yaml\n"
    "  rkm04 serve --control tcp:0 --control-file test.control\n"
    "  rkm04 serve --trace pulses.vcd --wire line.pcapng --record session.record\n"
    "  rkm04 serve --exit-when-idle=2 --coverage covered.txt --min-coverage 80\n";

static unsigned count_services(const struct bus_options *options)
{
    unsigned count = 0;
    while (count < DEVICE_SERVICES_MAX && options->service[count].name)
        count++;
    return count;
}

/* Descriptors that are open for good when the emulator is ready. */
static rlim_t count_files(const struct bus_options *options)
{
    rlim_t line = 1u + (options->pty || options->port ? FILES_SERIAL : 0) + (options->tcp != NULL) + (options->rfc2217 != NULL) +
                  count_services(options) + (options->record != NULL) + (options->flash ? options->nodes.count : 0);
    for (unsigned i = 0; i < BUS_FILES_MAX; i++)
        line += (rlim_t)(options->trace[i] != NULL) + (options->wire[i] != NULL);
    return FILES_LOOP + options->lines * line + (options->pty ? FILES_WATCH : 0) + (options->no_control ? 0 : FILES_CONTROL) +
           (options->coverage ? FILES_COVERAGE : 0) + (options->window != NULL) + (options->control_tcp ? CONTROL_STRANGERS : 0);
}

/* The lowest `ulimit -n' with so many free numbers: some are in use already by the process that started us. */
static rlim_t find_limit(rlim_t files)
{
    int number = 0;
    for (rlim_t found = 0; found < files; number++)
        found += fcntl(number, F_GETFD) < 0;
    return (rlim_t)number;
}

/* Many lines need more files than a process gets unasked; and without a free descriptor a connection cannot even be refused, and
 * would wake the loop without end. Nothing has been opened yet. */
bool serve_allow_files(const struct bus_options *options)
{
    struct rlimit limit;
    rlim_t least = find_limit(count_files(options) + FILES_SPARE), wanted = least + FILES_BESIDE;
    if (getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur >= wanted)
        return true;
    limit.rlim_cur = wanted < limit.rlim_max ? wanted : limit.rlim_max;
    setrlimit(RLIMIT_NOFILE, &limit);
    if (limit.rlim_cur >= least)
        return true;
    log_error("too few file descriptors: `ulimit -n' is %ju, expected at least %ju", (uintmax_t)limit.rlim_cur, (uintmax_t)least);
    return false;
}
