/* SPDX-License-Identifier: MIT */
/* bench_control: what the control socket costs.
 *
 *     bench_control RKM04 [SECONDS [CALLS]]
 *
 * RKM04 is the program; it is started in a folder of its own. All figures are taken while the four motors of a unit run at
 * 16 000 steps/s. One JSON object a line:
 *
 *     round_trip  CALLS requests one after another with a clock that goes: median, 99 of 100, longest, in us
 *     advance     CALLS times `advance` by 1 ms: us a call, and how much faster than real time that is
 *     events      pulses through `subscribe` for SECONDS of real time, then as fast as it goes: events a second; lost
 *
 * Every pulse must come, in order: exits with 1 if one is missing. */
#include <err.h>
#include <fcntl.h>
#include <inttypes.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <rkm04/link.h>
#include <rkm04/unit.h>

#define MOTORS 4u
#define PROGRAM "\2" "0\\C100 A60000 S2000 V16000 G+"
#define STEP_TICKS 1000u
#define INPUT (1u << 20)

static char folder[] = "/tmp/rkm04-bench-XXXXXX", link_path[64], socket_path[64];
static pid_t emulator;
static int control = -1, line = -1;

static char input[INPUT];
static size_t input_at, input_length;
static uint64_t pulses;          /* seen as events */
static int32_t position[MOTORS]; /* of the last one of each motor */
static bool seen[MOTORS];
static unsigned subscriptions;

static double now(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + (double)time.tv_nsec / 1e9;
}

/* ---- The emulator --------------------------------------------------------------------------------------------------- */

static void clean_up(void)
{
    if (emulator > 0) {
        kill(emulator, SIGTERM);
        waitpid(emulator, NULL, 0);
    }
    rmdir(folder);
}

/* Start it; its READY line says that everything is there. */
static void start(const char *program)
{
    int ready[2];
    if (!mkdtemp(folder) || pipe(ready) != 0)
        err(1, "cannot start");
    snprintf(link_path, sizeof link_path, "%s/bus", folder);
    snprintf(socket_path, sizeof socket_path, "%s/control", folder);
    emulator = fork();
    if (emulator == 0) {
        int nowhere = open("/dev/null", O_WRONLY);
        dup2(ready[1], STDOUT_FILENO);
        dup2(nowhere, STDERR_FILENO);
        close(ready[0]);
        close(ready[1]);
        execl(program, program, "serve", "--link", link_path, "--control", socket_path, (char *)NULL);
        _exit(127);
    }
    atexit(clean_up);
    char byte = 0;
    close(ready[1]);
    while (byte != '\n')
        if (read(ready[0], &byte, 1) != 1)
            errx(1, "%s does not start", program);
}

static void connect_to_it(void)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    snprintf(address.sun_path, sizeof address.sun_path, "%s", socket_path);
    control = socket(AF_UNIX, SOCK_STREAM, 0);
    line = open(link_path, O_RDWR | O_NOCTTY);
    if (control < 0 || line < 0 || connect(control, (const struct sockaddr *)&address, sizeof address) != 0)
        err(1, "cannot connect");
}

/* ---- Requests ------------------------------------------------------------------------------------------------------- */

/* The next line, without its newline; valid until the next call. */
static char *next_line(void)
{
    for (;;) {
        char *begin = input + input_at, *end = memchr(begin, '\n', input_length - input_at);
        if (end) {
            *end = '\0';
            input_at = (size_t)(end - input) + 1;
            return begin;
        }
        memmove(input, begin, input_length - input_at);
        input_length -= input_at;
        input_at = 0;
        ssize_t length = read(control, input + input_length, INPUT - input_length);
        if (length <= 0)
            errx(1, "the emulator has gone");
        input_length += (size_t)length;
    }
}

static int64_t member(const char *text, const char *name)
{
    const char *at = strstr(text, name);
    if (!at)
        errx(1, "there is no %s in %s", name, text);
    return strtoll(at + strlen(name), NULL, 10);
}

/* Count a pulse; each must follow the one before. */
static void look_at_event(const char *text)
{
    if (!strstr(text, "\"kind\":\"step\""))
        errx(1, "lost events: %s", text);
    size_t motor = (size_t)member(text, "\"motor\":") - 1;
    int32_t value = (int32_t)member(text, "\"value\":");
    if (motor >= MOTORS || (seen[motor] && value != position[motor] + 1))
        errx(1, "motor %zu: pulse %" PRId32 " follows %" PRId32, motor + 1, value, position[motor]);
    position[motor] = value;
    seen[motor] = true;
    pulses++;
}

/* The answer, events before it are counted. */
static char *answer(void)
{
    for (;;) {
        char *text = next_line();
        if (strstr(text, "\"method\":")) {
            look_at_event(text);
            continue;
        }
        if (!strstr(text, "\"result\""))
            errx(1, "%s", text);
        return text;
    }
}

static void send_request(const char *method, const char *params)
{
    char text[256];
    int length = snprintf(text, sizeof text, "{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"%s\",\"params\":%s}\n", method, params);
    if (write(control, text, (size_t)length) != length)
        err(1, "cannot write");
}

static char *request(const char *method, const char *params)
{
    send_request(method, params);
    return answer();
}

/* Let all motors run, and wait until they have their speed. */
static void run_motors(void)
{
    struct rkm04_sender sender = {0};
    uint8_t frame[128], byte;
    size_t length = sizeof PROGRAM - 1, at = rkm04_hdlc.begin(&sender, 1, 0, length, false, frame);
    for (size_t i = 0; i < length; i++)
        at += rkm04_hdlc.put(&sender, (uint8_t)PROGRAM[i], frame + at);
    at += rkm04_hdlc.end(&sender, frame + at);
    if (write(line, frame, at) != (ssize_t)at)
        err(1, "cannot write");
    if (read(line, &byte, 1) != 1) /* the answer begins */
        err(1, "cannot read");
    request("wait", "{\"until\":{\"motor\":4,\"position\":{\">\":5000}}}");
}

/* ---- The figures ---------------------------------------------------------------------------------------------------- */

static int compare(const void *left, const void *right)
{
    double a = *(const double *)left, b = *(const double *)right;
    return (a > b) - (a < b);
}

static void round_trip(const char *method, const char *params, size_t calls)
{
    double *took = malloc(calls * sizeof *took);
    if (!took)
        errx(1, "out of memory");
    for (size_t i = 0; i < calls; i++) {
        double begin = now();
        request(method, params);
        took[i] = (now() - begin) * 1e6;
    }
    qsort(took, calls, sizeof *took, compare);
    printf("{\"figure\": \"round_trip\", \"method\": \"%s\", \"calls\": %zu, \"median_us\": %.1f, \"p99_us\": %.1f, "
           "\"longest_us\": %.1f}\n", method, calls, took[calls / 2], took[calls * 99 / 100], took[calls - 1]);
    free(took);
}

static void advance(size_t calls)
{
    char params[64];
    int64_t from = member(request("units", "{}"), "\"t_us\":"), to = from;
    double begin = now();
    snprintf(params, sizeof params, "{\"ticks\":%u}", STEP_TICKS);
    for (size_t i = 0; i < calls; i++)
        to = member(request("advance", params), "\"t_us\":");
    double took = now() - begin;
    if (to - from != (int64_t)(calls * STEP_TICKS))
        errx(1, "%zu advances went %" PRId64 " ticks", calls, to - from);
    printf("{\"figure\": \"advance\", \"calls\": %zu, \"seconds\": %.3f, \"us_a_call\": %.1f, \"times_real_time\": %.1f}\n",
           calls, took, took * 1e6 / (double)calls, (double)calls * STEP_TICKS / 1e6 / took);
}

/* Events of a subscription while a request is answered. */
static void events(const char *clock, const char *method, const char *params)
{
    char number[64];
    pulses = 0;
    memset(seen, 0, sizeof seen);
    request("subscribe", "{\"kinds\":[\"step\"]}");
    int64_t from = member(request("units", "{}"), "\"t_us\":");
    uint64_t before = pulses;
    double begin = now();
    int64_t to = member(request(method, params), "\"t_us\":");
    double took = now() - begin;
    uint64_t count = pulses - before;
    snprintf(number, sizeof number, "{\"subscription\":%u}", ++subscriptions);
    request("unsubscribe", number);
    double virtual = (double)(to - from) / 1e6;
    if ((double)count < virtual * 16000.0 * MOTORS * 0.99)
        errx(1, "only %" PRIu64 " events in %.3f s of the unit", count, virtual);
    printf("{\"figure\": \"events\", \"clock\": \"%s\", \"events\": %" PRIu64 ", \"seconds\": %.3f, \"unit_seconds\": %.3f, "
           "\"events_a_second\": %.0f, \"lost\": 0}\n", clock, count, took, virtual, (double)count / took);
}

int main(int argc, char **argv)
{
    char params[96];
    if (argc < 2)
        errx(2, "expected the path of rkm04, seconds, and a number of calls");
    unsigned seconds = argc > 2 ? (unsigned)strtoul(argv[2], NULL, 10) : 5;
    size_t calls = argc > 3 ? strtoul(argv[3], NULL, 10) : 100000;
    if (seconds == 0 || calls == 0)
        errx(2, "expected at least one second and one call");
    start(argv[1]);
    connect_to_it();
    run_motors();
    round_trip("units", "{}", calls);
    round_trip("di.set", "{\"di\":{\"3\":1}}", calls);
    round_trip("state", "{}", calls);
    snprintf(params, sizeof params, "{\"until\":{\"di\":{\"8\":1}},\"limit\":\"%us\"}", seconds);
    events("real", "wait", params);
    request("clock", "{\"clock\":\"stepped\"}");
    advance(calls);
    snprintf(params, sizeof params, "{\"ticks\":\"%us\"}", seconds * 4);
    events("stepped", "advance", params);
    return 0;
}
