/* SPDX-License-Identifier: MIT */
/* bench_files: what the files cost that `rkm04 serve` writes, --trace and --wire.
 *
 *     bench_files [SECONDS [FORMAT…]]
 *
 * The work: SECONDS (60) of virtual time of one unit whose four motors run at 16 000 steps/s while the host asks it for the
 * four positions without a pause, as fast as 19200 baud allow. FORMAT: none, log, pcapng, vcd, csv, jsonl; all of them if none
 * is given. Each is one JSON object a line: cpu_s, processor time of it all; times_real_time, how much faster than real time
 * that is; overhead, processor time of the file alone in parts of real time; mb, size of the file; messages and pulses in it
 * all. The files are in the folder TMPDIR (or /tmp) and are removed. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "device/rkm04_device.h"
#include "sim/sim.h"
#include "trace/trace_file.h"
#include "trace/wire_file.h"

#define SECOND ((uint64_t)RKM04_TICKS_PER_SECOND)
#define PROGRAM "\2" "0\\C100 A60000 S2000 V16000 G+"
#define QUESTION "\4" "0"

static struct sim sim;
static uint64_t polls;

static double cpu_time(void)
{
    struct timespec time;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return (double)time.tv_sec + (double)time.tv_nsec / 1e9;
}

static void send(const char *message, size_t length)
{
    struct rkm04_sender sender = {0};
    uint8_t frame[128];
    size_t at = rkm04_hdlc.begin(&sender, 1, 0, length, false, frame);
    for (size_t i = 0; i < length; i++)
        at += rkm04_hdlc.put(&sender, (uint8_t)message[i], frame + at);
    at += rkm04_hdlc.end(&sender, frame + at);
    sim_queue_bytes(&sim, frame, at, sim_now(&sim));
}

static void run(uint64_t end)
{
    send(PROGRAM, sizeof PROGRAM - 1);
    while (sim_now(&sim) < end) {
        uint64_t due = sim_due(&sim);
        if (due == RKM04_NEVER) { /* the answer is here */
            send(QUESTION, sizeof QUESTION - 1);
            polls++;
        } else {
            sim_advance(&sim, due);
        }
    }
}

static void die(const char *what)
{
    fprintf(stderr, "bench_files: %s\n", what);
    exit(1);
}

/* Returns the processor time in seconds; *size receives that of the file. */
static double measure(const char *format, uint64_t seconds, double *size)
{
    struct sim_config config = {.timed = true, .turnaround = SEGMENT_TURNAROUND};
    struct wire_file *wire = NULL;
    struct trace_file *trace = NULL;
    const char *folder = getenv("TMPDIR") ? getenv("TMPDIR") : "/tmp";
    char path[4096], *error = NULL;
    struct stat status;
    memset(&sim, 0, sizeof sim);
    node_list_read(&config.nodes, "1");
    if (!sim_begin(&sim, &config))
        die("out of memory");
    snprintf(path, sizeof path, "%s/bench-%ld.%s", folder, (long)getpid(), format);
    polls = 0;
    double begun = cpu_time();
    if (wire_file_named(path))
        wire = wire_file_begin(&sim, path, 0, &error);
    else if (trace_file_named(path))
        trace = trace_file_begin(&sim, path, 0, &error);
    if (error)
        die(error);
    run(seconds * SECOND);
    if ((wire && wire_file_end(wire) != 0) || (trace && trace_file_end(trace) != 0))
        die("a file cannot be written");
    double spent = cpu_time() - begun;
    *size = stat(path, &status) == 0 ? (double)status.st_size : 0;
    unlink(path);
    return spent;
}

int main(int count, char **arguments)
{
    static const char *const all[] = {"none", "log", "pcapng", "vcd", "csv", "jsonl"};
    const char *const *formats = count > 2 ? (const char *const *)arguments + 2 : all;
    size_t number = count > 2 ? (size_t)count - 2 : sizeof all / sizeof all[0];
    char *end = NULL;
    unsigned long seconds = count > 1 ? strtoul(arguments[1], &end, 10) : 60;
    if (seconds == 0 || (end && *end != '\0'))
        die("expected: bench_files [SECONDS [FORMAT...]], SECONDS a whole number from 1");
    double size, bare = measure("none", seconds, &size);
    sim_end(&sim);
    for (size_t i = 0; i < number; i++) {
        double spent = measure(formats[i], seconds, &size);
        printf("{\"format\":\"%s\",\"virtual_s\":%lu,\"cpu_s\":%.3f,\"times_real_time\":%.0f,\"overhead\":%.6f,\"mb\":%.1f,"
               "\"messages\":%" PRIu64 ",\"pulses\":%" PRId64 "}\n",
               formats[i], seconds, spent, (double)seconds / spent, (spent - bare) / (double)seconds, size / 1e6, 2 * polls,
               4 * (int64_t)rkm04_of(sim_core(&sim, 1))->motor[0].position);
        sim_end(&sim);
    }
    return 0;
}
