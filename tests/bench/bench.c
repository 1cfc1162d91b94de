/* SPDX-License-Identifier: MIT */
/* bench.c: what the core costs. Prints one JSON object a line; every time is CPU time, the median of some runs.
 *
 *     bench [--quick] [--single] [--repeat N] [NAME]...
 *
 * Instructions instead of times, which depend on the machine and its load: instructions.sh. */
#include <getopt.h>
#include <inttypes.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <rkm04/unit.h>

#define SECOND UINT64_C(1000000)
#define HOUR (3600 * SECOND)
#define RUNS_MAX 99
#define NODE 1
#define MASTER 0

#define PULSES_MAX 4100000 /* of any run: nothing below makes more */

/* One time stamp a pulse, nothing else. */
struct sink {
    uint64_t *stamp;
    size_t count;
};

static struct rkm04_unit unit;
static struct sink sink;
static unsigned runs = 7;
static bool quick;

static void sink_step(void *context, uint64_t tick, unsigned motor, int32_t position)
{
    struct sink *to = context;
    (void)motor;
    (void)position;
    to->stamp[to->count++] = tick;
}

static void sink_steps(void *context, unsigned motor, const uint64_t *tick, size_t count, int32_t position, bool forward)
{
    struct sink *to = context;
    (void)motor;
    (void)position;
    (void)forward;
    memcpy(to->stamp + to->count, tick, count * sizeof *tick);
    to->count += count;
}

static struct rkm04_port port = {.steps = sink_steps};

static _Noreturn void fail(const char *what)
{
    fprintf(stderr, "bench: %s\n", what);
    exit(1);
}

static double now_ns(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

static void power_up(void)
{
    const struct rkm04_config config = {.node = NODE};
    rkm04_init(&unit, &config, &port, &sink);
    sink.count = 0;
}

static void set(char motor, const char *text)
{
    if (rkm04_set_command(&unit, motor, text, strlen(text), NULL) != 0)
        fail("a program was refused");
}

static bool all_idle(void)
{
    for (unsigned motor = 1; motor <= RKM04_MOTORS; motor++) {
        struct rkm04_motor_state state;
        if (!rkm04_motor_state(&unit, motor, &state) || state.state != RKM04_IDLE)
            return false;
    }
    return true;
}

/* What one run of a benchmark did; times in ns, simulated time in ticks. */
struct result {
    double ns;
    uint64_t simulated;
    uint64_t count; /* of what it is about: pulses, slots, … */
};

static int by_time(const void *a, const void *b)
{
    double x = ((const struct result *)a)->ns, y = ((const struct result *)b)->ns;
    return (x > y) - (x < y);
}

/* Run a benchmark some times and take the run in the middle. */
static struct result measure(struct result (*run)(const void *), const void *with)
{
    struct result result[RUNS_MAX];
    for (unsigned i = 0; i < runs; i++)
        result[i] = run(with);
    qsort(result, runs, sizeof result[0], by_time);
    return result[runs / 2];
}

/* ---- Pulses ---- */

static const char constant_program[] = "\\ S100 V16000 A20000 F1000000 R";
static const char ramp_program[] = "\\ S100 V16000 A20000 L80 F12500 R E"; /* at 12 500 steps V is not quite reached */
/* Speeds and accelerations of which none is a multiple of another: ramps end within a tick, intervals are no whole ticks. */
static const char *const mixed_program[RKM04_MOTORS] = {
    "\\ S100 V16000 A20000 F1000000 R", "\\ S137 V13337 A9001 F1000000 R", "\\ S211 V9871 A30011 F1000000 R",
    "\\ S2000 V7123 A4999 F1000000 R"};
static const char *const quick_mixed_program[RKM04_MOTORS] = {
    "\\ S100 V16000 A20000 F30000 R", "\\ S137 V13337 A9001 F30000 R", "\\ S211 V9871 A30011 F30000 R",
    "\\ S2000 V7123 A4999 F30000 R"};
static const char quick_constant_program[] = "\\ S100 V16000 A20000 F20000 R";
static const char quick_ramp_program[] = "\\ S100 V16000 A20000 L2 F12500 R E";

/* To the end of all programs, a second at a time. */
static struct result run_to_end(void)
{
    double from = now_ns();
    do {
        rkm04_advance(&unit, SECOND);
    } while (!all_idle());
    return (struct result){now_ns() - from, rkm04_now(&unit), sink.count};
}

static struct result run_text(const void *text)
{
    power_up();
    set('0', text);
    return run_to_end();
}

static struct result run_texts(const void *texts)
{
    power_up();
    for (unsigned i = 0; i < RKM04_MOTORS; i++)
        set((char)('1' + i), ((const char *const *)texts)[i]);
    return run_to_end();
}

static void print_pulses(const char *name, struct result (*run)(const void *), const void *with)
{
    struct result r = measure(run, with);
    if (r.count == 0)
        fail("no pulses came");
    printf("{\"bench\":\"%s\",\"motors\":%d,\"pulses\":%" PRIu64 ",\"ns_per_pulse\":%.2f,\"simulated_s\":%.3f,"
           "\"simulated_s_per_s\":%.0f}\n",
           name, RKM04_MOTORS, r.count, r.ns / (double)r.count, (double)r.simulated / 1e6, (double)r.simulated * 1e3 / r.ns);
}

static void bench_constant(void)
{
    print_pulses("constant", run_text, quick ? quick_constant_program : constant_program);
}

static void bench_ramp(void)
{
    print_pulses("ramp", run_text, quick ? quick_ramp_program : ramp_program);
}

static void bench_mixed(void)
{
    print_pulses("mixed", run_texts, quick ? quick_mixed_program : mixed_program);
}

/* Not to the end but at full speed all the while: what "four motors at 16 000 steps/s" cost. */
static struct result run_cruise(const void *seconds)
{
    power_up();
    set('0', "\\ S100 V16000 A20000 G+");
    rkm04_advance(&unit, 2 * SECOND);
    size_t before = sink.count;
    double from = now_ns();
    for (unsigned i = 0; i < *(const unsigned *)seconds; i++)
        rkm04_advance(&unit, SECOND);
    return (struct result){now_ns() - from, *(const unsigned *)seconds * SECOND, sink.count - before};
}

static void bench_cruise(void)
{
    unsigned seconds = quick ? 1 : 60;
    struct result r = measure(run_cruise, &seconds);
    if (r.count != 4 * UINT64_C(16000) * seconds)
        fail("four motors at 16 000 steps/s do not give 64 000 pulses a second");
    printf("{\"bench\":\"cruise\",\"motors\":%d,\"pulses\":%" PRIu64 ",\"ns_per_pulse\":%.2f,\"simulated_s_per_s\":%.0f}\n",
           RKM04_MOTORS, r.count, r.ns / (double)r.count, (double)r.simulated * 1e3 / r.ns);
}

/* ---- Slots ---- */

struct leaps {
    const char *text; /* for all four motors */
    uint64_t ticks;   /* simulated */
    uint64_t leap;    /* of one call */
};

static struct result run_leaps(const void *with)
{
    const struct leaps *leaps = with;
    power_up();
    set('0', leaps->text);
    rkm04_advance(&unit, 100000);
    double from = now_ns();
    for (uint64_t done = 0; done < leaps->ticks; done += leaps->leap)
        rkm04_advance(&unit, leaps->leap);
    return (struct result){now_ns() - from, leaps->ticks, leaps->ticks / RKM04_SLOT_TICKS};
}

static void print_slots(const char *name, struct leaps leaps)
{
    struct result r = measure(run_leaps, &leaps);
    printf("{\"bench\":\"%s\",\"motors\":%d,\"slots\":%" PRIu64 ",\"ns_per_slot\":%.4g,\"simulated_s_per_s\":%.3g}\n", name,
           RKM04_MOTORS, r.count, r.ns / (double)r.count, (double)r.simulated * 1e3 / r.ns);
}

static void bench_idle_slot(void)
{
    print_slots("idle_slot", (struct leaps){"\\", quick ? SECOND : 100 * SECOND, RKM04_SLOT_TICKS});
}

static void bench_wait_slot(void)
{
    print_slots("wait_slot", (struct leaps){"\\ X01 M02 O03", quick ? SECOND : 100 * SECOND, RKM04_SLOT_TICKS});
}

/* Every motor executes a command in every slot. */
static void bench_command_slot(void)
{
    print_slots("command_slot", (struct leaps){"\\ @1 V5000 L3 T80 C80 E I08H5 J1", quick ? SECOND : 100 * SECOND, SECOND});
}

static void print_hour(const char *name, const char *text)
{
    struct leaps leaps = {text, HOUR, HOUR};
    struct result r = measure(run_leaps, &leaps);
    printf("{\"bench\":\"%s\",\"ms_per_hour\":%.6f}\n", name, r.ns / 1e6);
}

static void bench_idle_hour(void)
{
    print_hour("idle_hour", "\\");
}

static void bench_wait_hour(void)
{
    print_hour("wait_hour", "\\ X01 M02 O03");
}

/* ---- Messages ---- */

struct exchange {
    const char *name;
    const char *message;
    bool full; /* the memory of motor 1 holds 700 commands */
};

/* Put a request into a frame. Returns its length. */
static size_t frame(const char *message, uint8_t *line)
{
    struct rkm04_sender sender = {0};
    size_t length = strlen(message), at = rkm04_hdlc.begin(&sender, NODE, MASTER, length, false, line);
    for (size_t i = 0; i < length; i++)
        at += rkm04_hdlc.put(&sender, (uint8_t)message[i], line + at);
    return at + rkm04_hdlc.end(&sender, line + at);
}

static void fill_memory(void)
{
    char text[8 * RKM04_PROGRAM_MAX] = "\\";
    size_t length = 1;
    for (unsigned i = 0; i < RKM04_PROGRAM_MAX; i++)
        length += (size_t)snprintf(text + length, sizeof text - length, " A%u", 100 + i);
    set('1', text);
}

static struct result run_exchange(const void *with)
{
    const struct exchange *exchange = with;
    unsigned count = quick ? 20 : exchange->full ? 2000 : 50000;
    uint8_t line[256], answer[512];
    size_t length = frame(exchange->message, line), bytes = 0;
    power_up();
    if (exchange->full)
        fill_memory();
    double from = now_ns();
    for (unsigned i = 0; i < count; i++) {
        if (rkm04_receive(&unit, line, length) != length)
            fail("a request was not taken");
        size_t n;
        while ((n = rkm04_send(&unit, answer, sizeof answer)) > 0)
            bytes += n;
    }
    double ns = now_ns() - from;
    if (bytes == 0)
        fail("a request was not answered");
    return (struct result){ns, bytes / count, count};
}

static void bench_message(void)
{
    static const struct exchange list[] = {
        {"version", "\x01", false},
        {"set_command", "\x02" "1\\ S100 V1000 A2000 F5000 R W100 B5000 R", false},
        {"get_position", "\x04" "0", false},
        {"get_command_700", "\x05" "1", true},
        {"get_tabul_run", "\x06" "1", false},
        {"get_pozic_run", "\x07" "1", false},
    };
    for (size_t i = 0; i < sizeof list / sizeof list[0]; i++) {
        struct result r = measure(run_exchange, &list[i]);
        printf("{\"bench\":\"message\",\"message\":\"%s\",\"framing\":\"hdlc\",\"answer_bytes\":%" PRIu64
               ",\"ns_per_message\":%.0f}\n",
               list[i].name, r.simulated, r.ns / (double)r.count);
    }
}

/* ---- A long program ---- */

/* 255 times: six motions to and fro, dwells, outputs, a subroutine and a compound motion. */
static const char long_program[] =
    "\\ S100 V3000 A9000 L255 L3 F400 R W10 T01 B400 R W20 C01 E '1 E J2"
    " @1 V500 F300 Y V2500 F900 Y V800 F200 Y R =0 V3000 . @2";
static const char quick_long_program[] = "\\ S100 V3000 A9000 L2 F400 R W10 T01 B400 R W20 C01 E";

static void bench_exec(void)
{
    struct result r = measure(run_text, quick ? quick_long_program : long_program);
    printf("{\"bench\":\"exec\",\"motors\":%d,\"pulses\":%" PRIu64 ",\"ms\":%.3f,\"simulated_s\":%.3f,"
           "\"simulated_s_per_s\":%.0f}\n",
           RKM04_MOTORS, r.count, r.ns / 1e6, (double)r.simulated / 1e6, (double)r.simulated * 1e3 / r.ns);
}

/* ---- Command line ---- */

static const struct {
    const char *name;
    void (*run)(void);
    const char *what;
} benches[] = {
    {"constant", bench_constant, "four motors, 1 000 000 steps each, 16 000 steps/s: a pulse"},
    {"ramp", bench_ramp, "four motors, 80 triangular moves of 12 500 steps each: a pulse"},
    {"mixed", bench_mixed, "four motors, 1 000 000 steps each, speeds and accelerations that do not fit together: a pulse"},
    {"cruise", bench_cruise, "four motors at 16 000 steps/s for a minute"},
    {"idle_slot", bench_idle_slot, "four idle motors, advanced slot by slot"},
    {"wait_slot", bench_wait_slot, "four motors in a wait, advanced slot by slot"},
    {"command_slot", bench_command_slot, "four motors that execute a command in every slot"},
    {"idle_hour", bench_idle_hour, "an hour of an idle unit"},
    {"wait_hour", bench_wait_hour, "an hour of a unit that waits for inputs"},
    {"message", bench_message, "a request and its answer, framing included"},
    {"exec", bench_exec, "a long program from begin to end"},
};
#define BENCHES (sizeof benches / sizeof benches[0])

static _Noreturn void usage(FILE *to, int status)
{
    fprintf(to, "Usage: bench [--quick] [--repeat N] [NAME]...\n\n"
                "Measure the core; one JSON object a line. Times are CPU times, each the median of the runs.\n\n"
                "  -q, --quick       little work, one run: to see that it works\n"
                "  -s, --single      take pulses one by one (port.step), not in blocks (port.steps)\n"
                "  -r, --repeat N    runs of each, 1..99 (7)\n"
                "  -h, --help        this text\n\n"
                "NAME, all if none is given:\n");
    for (size_t i = 0; i < BENCHES; i++)
        fprintf(to, "  %-17s %s\n", benches[i].name, benches[i].what);
    exit(status);
}

static void run_named(const char *name)
{
    for (size_t i = 0; i < BENCHES; i++) {
        if (strcmp(benches[i].name, name) == 0) {
            benches[i].run();
            return;
        }
    }
    fprintf(stderr, "bench: no benchmark named '%s'; --help lists them\n", name);
    exit(2);
}

static void read_options(int argc, char **argv)
{
    static const struct option options[] = {
        {"quick", no_argument, NULL, 'q'},
        {"single", no_argument, NULL, 's'},
        {"repeat", required_argument, NULL, 'r'},
        {"help", no_argument, NULL, 'h'},
        {NULL, 0, NULL, 0},
    };
    for (int option; (option = getopt_long(argc, argv, "qsr:h", options, NULL)) != -1;) {
        char *end = NULL;
        long number = option == 'r' ? strtol(optarg, &end, 10) : 0;
        if (option == 'h')
            usage(stdout, 0);
        if (option == '?')
            usage(stderr, 2);
        if (option == 'r' && (*end != '\0' || end == optarg || number < 1 || number > RUNS_MAX)) {
            fprintf(stderr, "bench: --repeat wants a number 1..%d, not '%s'\n", RUNS_MAX, optarg);
            exit(2);
        }
        if (option == 'r')
            runs = (unsigned)number;
        else if (option == 's')
            port = (struct rkm04_port){.step = sink_step};
        else
            quick = true, runs = 1;
    }
}

int main(int argc, char **argv)
{
    read_options(argc, argv);
    /* Written to once, so that no run pays for getting the pages. */
    sink.stamp = malloc(PULSES_MAX * sizeof sink.stamp[0]);
    if (!sink.stamp)
        fail("no memory");
    memset(sink.stamp, 0xff, PULSES_MAX * sizeof sink.stamp[0]);
    if (optind == argc)
        for (size_t i = 0; i < BENCHES; i++)
            benches[i].run();
    for (int i = optind; i < argc; i++)
        run_named(argv[i]);
    free(sink.stamp);
    return 0;
}
