/* SPDX-License-Identifier: MIT */
/* soak: days of virtual time of random host traffic against sixteen units, in one process.
 *
 *     soak --days DAYS [--seed SEED] [--quiet]
 *
 * Programs whose outcome is known are given, polled, held, stored and run from flash; garbage, floods and faults of every
 * kind come between. Every answer, position, output and counter is checked, and memory has to stay as it is. Says how far it
 * is on stderr, and writes a line of JSON to stdout. Exit status: 0 all is well, 1 something is not, 2 usage. */
#include "soak.h"

#include <getopt.h>
#include <inttypes.h>
#include <malloc.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "record/record.h"

#if defined __SANITIZE_ADDRESS__
#define MEMORY_JUDGED false /* its own memory grows; it looks for leaks at the end */
#else
#define MEMORY_JUDGED true
#endif

#define HEAP_SLACK (64u << 10) /* bytes: snapshots that are kept differ in what is under way */
#define RESIDENT_SLACK (1u << 20)

static struct {
    double days;
    uint64_t seed;
    bool quiet;
} options = {.days = 30, .seed = 1};

struct memory {
    size_t heap, resident; /* bytes */
};

static double elapsed(void)
{
    static double begin;
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    double seconds = (double)now.tv_sec + (double)now.tv_nsec / 1e9;
    begin = begin > 0 ? begin : seconds;
    return seconds - begin;
}

/* Without the table of events under way, which grows to the most there ever were at a time. */
static struct memory memory_now(const struct soak *soak)
{
    size_t events = soak->sim.watch.room * sizeof *soak->sim.watch.events;
    struct mallinfo2 heap = mallinfo2();
    unsigned long pages = 0;
    FILE *file = fopen("/proc/self/statm", "re");
    if (!file || fscanf(file, "%*u %lu", &pages) != 1)
        pages = 0;
    if (file)
        fclose(file);
    return (struct memory){.heap = heap.uordblks + heap.hblkhd > events ? heap.uordblks + heap.hblkhd - events : 0,
                           .resident = pages * (size_t)sysconf(_SC_PAGESIZE)};
}

void soak_fail(const struct soak *soak, const char *format, ...)
{
    va_list arguments;
    fprintf(stderr, "soak: round %" PRIu64 " (%s), tick %" PRIu64 ": ", soak->rounds, soak->what, sim_now(&soak->sim));
    va_start(arguments, format);
    vfprintf(stderr, format, arguments);
    va_end(arguments);
    fprintf(stderr, "\nsoak: again: soak --days %g --seed %" PRIu64 "\n", options.days, options.seed);
    exit(EXIT_FAILURE);
}

/* ---- A life --------------------------------------------------------------------------------------------------------- */

static void begin(struct soak *soak)
{
    struct sim_config config = {
        .unit = rkm04_device_config(&(struct rkm04_config){.framing = &rkm04_hdlc}),
        .timed = true,
        .turnaround = SEGMENT_TURNAROUND,
        .seed = options.seed,
        .out = host_receive,
        .context = soak,
    };
    soak->dice.state = options.seed;
    soak->exact = true;
    if (!node_list_read(&config.nodes, "1-16") || !sim_begin(&soak->sim, &config) || !snapshots_attach(&soak->sim))
        soak_fail(soak, "no memory");
    counters_begin(soak);
}

static const struct {
    const char *name;
    void (*run)(struct soak *soak);
    unsigned percent;
} kinds[] = {{"jobs", round_jobs, 55}, {"power", round_power, 10}, {"garbage", round_garbage, 20}, {"chaos", round_chaos, 15}};

static void run_round(struct soak *soak, size_t kind)
{
    soak->rounds++;
    snprintf(soak->what, sizeof soak->what, "%s", kinds[kind].name);
    kinds[kind].run(soak);
}

static void random_round(struct soak *soak)
{
    int64_t at = dice_roll(&soak->dice, 0, 99);
    size_t kind = 0;
    while (at >= kinds[kind].percent)
        at -= kinds[kind++].percent;
    run_round(soak, kind);
}

/* Everything has been in use once: tables have grown as far as they do. */
static void warm_up(struct soak *soak)
{
    for (int i = 0; i < 3; i++)
        for (size_t kind = 0; kind < sizeof kinds / sizeof *kinds; kind++)
            run_round(soak, kind);
    for (int name = 1; name <= 4; name++)
        soak_command(soak, "snapshot", "{\"name\":\"%d\"}", name);
}

/* At rest, so that what is there can be compared. */
static struct memory rest(struct soak *soak)
{
    snprintf(soak->what, sizeof soak->what, "at rest");
    soak_settle(soak);
    struct segment_counters line = segment_counters(&soak->sim.segment);
    if (!segment_idle(&soak->sim.segment) || line.bytes == 0)
        soak_fail(soak, "the line is not at rest");
    return memory_now(soak);
}

static void report_day(const struct soak *soak, double days, struct memory memory)
{
    if (options.quiet)
        return;
    fprintf(stderr, "soak: day %.2f of %g after %.0f s: %" PRIu64 " requests, %" PRIu64 " jobs, %" PRIu64 " resets, %" PRIu64
            " faults; heap %zu bytes, resident %.1f MiB\n", days, options.days, elapsed(), soak->requests, soak->jobs,
            soak->resets, soak->faults, memory.heap, (double)memory.resident / 1048576);
}

static bool report(const struct soak *soak, struct memory first, struct memory last, struct memory most)
{
    bool ok = !MEMORY_JUDGED || (last.heap <= first.heap + HEAP_SLACK && last.resident <= first.resident + RESIDENT_SLACK);
    double seconds = elapsed(), days = (double)sim_now(&soak->sim) / (double)DAY;
    printf("{\"virtual_days\":%.3f,\"seconds\":%.1f,\"times_real\":%.0f,\"seed\":%" PRIu64 ",\"units\":%u,\"rounds\":%" PRIu64
           ",\"requests\":%" PRIu64 ",\"answers\":%" PRIu64 ",\"jobs\":%" PRIu64 ",\"steps\":%" PRIu64 ",\"stores\":%" PRIu64
           ",\"garbage\":%" PRIu64 ",\"faults\":%" PRIu64 ",\"resets\":%" PRIu64 ",\"snapshots\":%" PRIu64
           ",\"heap_begin\":%zu,\"heap_end\":%zu,\"heap_most\":%zu"
           ",\"resident_begin\":%zu,\"resident_end\":%zu,\"resident_most\":%zu"
           ",\"well\":%s}\n", days, seconds, days * 86400 / seconds, options.seed, UNITS, soak->rounds, soak->requests,
           soak->answers, soak->jobs, soak->steps_done, soak->stores, soak->garbage, soak->faults, soak->resets, soak->snapshots,
           first.heap, last.heap, most.heap, first.resident, last.resident, most.resident, ok ? "true" : "false");
    if (!ok)
        fprintf(stderr, "soak: memory has grown: heap from %zu to %zu bytes, resident from %zu to %zu\n", first.heap, last.heap,
                first.resident, last.resident);
    return ok;
}

static bool live(struct soak *soak)
{
    uint64_t end = (uint64_t)(options.days * (double)DAY), step = end / 30 < DAY ? end / 30 : DAY, next = step;
    warm_up(soak);
    struct memory first = rest(soak), last = first, most = first;
    while (sim_now(&soak->sim) < end) {
        random_round(soak);
        if (sim_now(&soak->sim) < next)
            continue;
        last = rest(soak);
        if (next <= end / 10)
            first = last; /* the first tenth: memory of units is touched when it is used first */
        most.heap = last.heap > most.heap ? last.heap : most.heap;
        most.resident = last.resident > most.resident ? last.resident : most.resident;
        report_day(soak, (double)sim_now(&soak->sim) / (double)DAY, last);
        next = sim_now(&soak->sim) + step;
    }
    last = rest(soak);
    return report(soak, first, last, most);
}

static void read_options(int argc, char **argv)
{
    static const struct option known[] = {
        {"days", required_argument, NULL, 'd'}, {"seed", required_argument, NULL, 's'}, {"quiet", no_argument, NULL, 'q'}, {0},
    };
    char *end = "";
    int option;
    while ((option = getopt_long(argc, argv, "", known, NULL)) != -1) {
        if (option == 'd')
            options.days = strtod(optarg, &end);
        else if (option == 's')
            options.seed = strtoull(optarg, &end, 0);
        else if (option == 'q')
            options.quiet = true;
        if (option == '?' || *end != '\0' || !(options.days > 0 && options.days <= 100000)) {
            fputs("usage: soak [--days DAYS] [--seed NUMBER] [--quiet]: expected 0 < DAYS <= 100000\n", stderr);
            exit(2);
        }
    }
}

int main(int argc, char **argv)
{
    static struct soak soak;
    read_options(argc, argv);
    elapsed();
    begin(&soak);
    bool ok = live(&soak);
    sim_end(&soak.sim);
    return ok ? EXIT_SUCCESS : EXIT_FAILURE;
}
