/* SPDX-License-Identifier: MIT */
/* What a bus and its traces cost: the basic blocks of the rooms wire, sim and trace and of the RKM04 as a kind of device, counted
 * by the compiler as in test_cost.c. They are the same on every run and machine. The limits are a fiftieth above what was
 * counted. */
#include <check.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "device/rkm04_device.h"
#include "sim/sim.h"
#include "trace/trace_file.h"

#define SECOND ((uint64_t)RKM04_TICKS_PER_SECOND)
#define PROGRAM "\2" "0\\C100 A60000 S2000 V16000 G+"

void __sanitizer_cov_trace_pc(void);

static struct sim sim;
static uint64_t blocks, bytes;

/* Called at each basic block of what is counted. */
void __sanitizer_cov_trace_pc(void)
{
    blocks++;
}

static void on_out(void *context, const uint8_t *part, size_t length)
{
    (void)context;
    (void)part;
    bytes += length;
}

static void send(uint8_t node, const char *message, size_t length)
{
    struct rkm04_sender sender = {0};
    uint8_t frame[128];
    size_t at = rkm04_hdlc.begin(&sender, node, 0, length, false, frame);
    for (size_t i = 0; i < length; i++)
        at += rkm04_hdlc.put(&sender, (uint8_t)message[i], frame + at);
    at += rkm04_hdlc.end(&sender, frame + at);
    sim_queue_bytes(&sim, frame, at, sim_now(&sim));
    bytes += at;
}

/* A bus whose units run all their motors at 16 000 steps/s. */
static void begin(const char *nodes, bool timed)
{
    struct sim_config config = {.timed = timed, .turnaround = SEGMENT_TURNAROUND, .out = on_out};
    node_list_read(&config.nodes, nodes);
    ck_assert(sim_begin(&sim, &config));
    send(0, PROGRAM, sizeof PROGRAM - 1);
    sim_advance(&sim, SECOND);
    bytes = blocks = 0;
}

/* Ask one unit after the other for its positions, without a pause. */
static void poll_units(unsigned polls)
{
    for (unsigned i = 0; i < polls; i++) {
        send((uint8_t)(i % sim_units(&sim) + 1u), "\4" "0", 2);
        for (uint64_t due; (due = sim_due(&sim)) != DEVICE_NEVER;)
            sim_advance(&sim, due);
    }
}

/* ---- Bytes ---- */

static const struct {
    const char *nodes;
    bool timed;
    unsigned polls;
    uint64_t bytes, most; /* most: blocks for a byte on the bus, times 100 */
} polled[] = {
    {"1", true, 100, 6001, 164800},
    {"1-16", true, 160, 9603, 656700},
    {"1-16", false, 160, 9610, 62800},
};

START_TEST(K3_a_byte_on_the_bus_costs_little)
{
    begin(polled[_i].nodes, polled[_i].timed);
    poll_units(polled[_i].polls);
    uint64_t each = 100 * blocks / bytes;
    ck_assert_msg(bytes == polled[_i].bytes && each <= polled[_i].most,
                  "units %s: %" PRIu64 " bytes, each %" PRIu64 "/100 blocks, expected %" PRIu64 ", at most %" PRIu64 "/100",
                  polled[_i].nodes, bytes, each, polled[_i].bytes, polled[_i].most);
    sim_end(&sim);
}
END_TEST

/* ---- Pulses in a trace ---- */

static const struct {
    enum trace_format format;
    uint64_t most; /* blocks for a pulse in the trace, times 100 */
} traces[] = {{TRACE_CSV, 12430}, {TRACE_VCD, 18550}, {TRACE_JSONL, 16100}};

START_TEST(K3_a_pulse_in_a_trace_costs_little)
{
    const uint64_t pulses = UINT64_C(4) * 16000;
    begin("1", true);
    FILE *out = fopen("/dev/null", "w");
    struct trace_file *trace = trace_file_begin_on(&sim, out, traces[_i].format);
    ck_assert(out && trace);
    sim_advance(&sim, 2 * SECOND);
    uint64_t each = 100 * blocks / pulses;
    ck_assert_int_eq(trace_file_end(trace), 0);
    ck_assert_msg(each <= traces[_i].most, "format %d: a pulse costs %" PRIu64 "/100 blocks, expected at most %" PRIu64 "/100",
                  (int)traces[_i].format, each, traces[_i].most);
    fclose(out);
    sim_end(&sim);
}
END_TEST

#define COUNT(list) ((int)(sizeof(list) / sizeof *(list)))

int main(void)
{
    Suite *suite = suite_create("bus_cost");
    TCase *one = tcase_create("cost");
    tcase_set_timeout(one, 60);
    tcase_add_loop_test(one, K3_a_byte_on_the_bus_costs_little, 0, COUNT(polled));
    tcase_add_loop_test(one, K3_a_pulse_in_a_trace_costs_little, 0, COUNT(traces));
    suite_add_tcase(suite, one);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_NORMAL);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}
