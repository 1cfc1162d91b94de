/* SPDX-License-Identifier: MIT */
#include "device/rkm04_device.h"
#include "segment_rig.h"

#include <string.h>

struct line_rig line_rig;

static void keep(void *context, const uint8_t *bytes, size_t length)
{
    struct line_rig *line = context;
    struct line_bytes *host = &line->host;
    for (size_t i = 0; i < length; i++) {
        ck_assert_uint_lt(host->count, LINE_BYTES_MAX);
        host->byte[host->count] = bytes[i];
        host->tick[host->count++] = segment_now(&line->segment);
    }
}

static void watch(void *context, const struct segment_byte *byte)
{
    struct line_rig *line = context;
    ck_assert_uint_lt(line->monitored, LINE_BYTES_MAX);
    ck_assert_uint_eq(byte->tick, segment_now(&line->segment));
    line->monitor[line->monitored++] = *byte;
}

struct segment_config line_timed(void)
{
    return (struct segment_config){.timed = true, .turnaround = SEGMENT_TURNAROUND};
}

void line_begin(const struct segment_config *config, const uint8_t *nodes, const struct rkm04_framing *framing)
{
    static const struct device_port nothing;
    struct segment_config mine = *config;
    mine.out = keep;
    mine.monitor = watch;
    mine.context = &line_rig;
    line_rig.framing = framing ? framing : &rkm04_hdlc;
    line_rig.host.count = line_rig.monitored = 0;
    segment_end(&line_rig.segment);
    segment_begin(&line_rig.segment, &mine);
    for (unsigned number = 1; *nodes != 0; number++) {
        const struct device_config unit = rkm04_device_config(&(struct rkm04_config){.node = *nodes++, .framing = framing});
        ck_assert_uint_eq(segment_add_unit(&line_rig.segment, &unit, &nothing, NULL), number);
    }
}

size_t line_frame(uint8_t dnode, const void *message, size_t length, uint8_t *out)
{
    const uint8_t *bytes = message;
    struct rkm04_sender sender = {0};
    size_t n = line_rig.framing->begin(&sender, dnode, 0, length, false, out);
    for (size_t i = 0; i < length; i++)
        n += line_rig.framing->put(&sender, bytes[i], out + n);
    return n + line_rig.framing->end(&sender, out + n);
}

size_t line_ask(uint8_t dnode, const void *message, size_t length, uint64_t tick)
{
    uint8_t bytes[2 * REQUEST_MAX + 2 * RKM04_FRAME_EDGE_MAX];
    ck_assert_uint_le(length, REQUEST_MAX);
    size_t n = line_frame(dnode, message, length, bytes);
    segment_advance(&line_rig.segment, tick);
    ck_assert_uint_ge(segment_room(&line_rig.segment), n);
    segment_queue_bytes(&line_rig.segment, bytes, n, tick);
    return n;
}

size_t line_set(uint8_t dnode, char motor, const char *text, uint64_t tick)
{
    uint8_t message[REQUEST_MAX] = {2, (uint8_t)motor};
    size_t length = strlen(text);
    ck_assert_uint_le(length, REQUEST_MAX - 2);
    memcpy(message + 2, text, length);
    return line_ask(dnode, message, 2 + length, tick);
}

uint64_t line_settle(void)
{
    for (uint64_t due; (due = segment_due(&line_rig.segment)) != RKM04_NEVER;)
        segment_advance(&line_rig.segment, due);
    ck_assert(segment_idle(&line_rig.segment));
    return segment_now(&line_rig.segment);
}

uint64_t line_passed(uint64_t tick, size_t bytes)
{
    return (tick * 12 + bytes * 6250 + 11) / 12;
}

/* Count whole answers: of `node` (0: any) with this number (0: any). */
static struct line_count look(uint8_t node, uint8_t number)
{
    static uint8_t buffer[RKM04_MESSAGE_MAX];
    struct rkm04_receiver receiver = {0};
    struct line_count count = {0};
    const struct line_bytes *host = &line_rig.host;
    for (size_t i = 0; i < host->count; i++) {
        if (!line_rig.framing->receive(&receiver, host->byte[i], host->tick[i], buffer, sizeof buffer))
            continue;
        uint8_t from = line_rig.framing->answer_names_sender ? receiver.snode : receiver.dnode;
        count.whole += (node == 0 || node == from) && (number == 0 || buffer[0] == number);
    }
    count.dropped = receiver.bad_check + receiver.malformed + receiver.too_long;
    return count;
}

unsigned line_answers(uint8_t node, uint8_t number)
{
    return look(node, number).whole;
}

struct line_count line_count(void)
{
    return look(0, 0);
}

struct rkm04_counters line_unit_counters(unsigned number)
{
    return rkm04_counters(rkm04_of(segment_unit(&line_rig.segment, number)));
}

struct rkm04_motor_state line_motor(unsigned number, unsigned motor)
{
    struct rkm04_motor_state state;
    ck_assert(rkm04_motor_state(rkm04_of(segment_unit(&line_rig.segment, number)), motor, &state));
    return state;
}
