/* SPDX-License-Identifier: MIT */
#include "wire_rig.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "wire/wire_words.h"

struct wire_rig wire_rig;

static unsigned looked_at; /* lines */

static void on_event(void *context, const struct watch_event *event)
{
    struct wire_rig *rig = context;
    ck_assert_uint_lt(rig->lines, WIRE_RIG_LINES);
    struct wire_text text = {.text = rig->line[rig->lines], .room = WIRE_RIG_COLUMNS};
    const struct wire_names names = sim_wire_names(&rig->sim);
    wire_words_direction(&text, &names, event->message);
    wire_text_string(&text, ": ");
    wire_words_story(&text, &names, event->message);
    wire_text_end(&text);
    rig->message[rig->lines++] = *event->message;
}

static void begin(const char *nodes, const struct rkm04_framing *framing, bool timed, uint32_t turnaround)
{
    struct sim_config config = {
        .unit = rkm04_device_config(&(struct rkm04_config){.framing = framing}),
        .timed = timed, .turnaround = turnaround,
    };
    wire_rig_end();
    ck_assert(node_list_read(&config.nodes, nodes));
    ck_assert(sim_begin(&wire_rig.sim, &config));
    wire_rig.watcher = (struct watcher){.kinds = WATCH_BIT(WATCH_MESSAGE), .on_event = on_event, .context = &wire_rig};
    sim_watch(&wire_rig.sim, &wire_rig.watcher);
}

void wire_rig_begin(const char *nodes, const struct rkm04_framing *framing)
{
    begin(nodes, framing, true, SEGMENT_TURNAROUND);
}

void wire_rig_begin_untimed(const char *nodes, const struct rkm04_framing *framing)
{
    begin(nodes, framing, false, 0);
}

void wire_rig_begin_slow(const char *nodes, const struct rkm04_framing *framing, uint32_t turnaround)
{
    begin(nodes, framing, true, turnaround);
}

void wire_rig_end(void)
{
    if (sim_units(&wire_rig.sim) > 0)
        sim_end(&wire_rig.sim);
    memset(&wire_rig, 0, sizeof wire_rig);
    looked_at = 0;
}

void wire_rig_bytes(const char *hex)
{
    for (char *end; *hex; hex = end + (*end == ' ')) {
        uint8_t byte = (uint8_t)strtoul(hex, &end, 16);
        ck_assert_ptr_ne(hex, end);
        sim_queue_bytes(&wire_rig.sim, &byte, 1, sim_now(&wire_rig.sim));
    }
}

size_t wire_rig_frame(uint8_t dnode, uint8_t snode, const void *message, size_t length, uint8_t *out)
{
    const struct rkm04_framing *framing = wire_rig.sim.monitor.framing->link;
    struct rkm04_sender sender = {0};
    size_t at = framing->begin(&sender, dnode, snode, length, false, out);
    for (size_t i = 0; i < length; i++)
        at += framing->put(&sender, ((const uint8_t *)message)[i], out + at);
    return at + framing->end(&sender, out + at);
}

void wire_rig_send(uint8_t dnode, const void *message, size_t length)
{
    static uint8_t frame[WIRE_RAW_MAX];
    size_t size = wire_rig_frame(dnode, 0, message, length, frame);
    for (size_t at = 0, some; at < size; at += some) {
        while (sim_room(&wire_rig.sim) == 0)
            sim_advance(&wire_rig.sim, sim_due(&wire_rig.sim));
        some = size - at < sim_room(&wire_rig.sim) ? size - at : sim_room(&wire_rig.sim);
        sim_queue_bytes(&wire_rig.sim, frame + at, some, sim_now(&wire_rig.sim));
    }
}

void wire_rig_ask(uint8_t dnode, const void *message, size_t length)
{
    wire_rig_send(dnode, message, length);
    wire_rig_settle();
}

void wire_rig_settle(void)
{
    while (sim_due(&wire_rig.sim) != RKM04_NEVER)
        sim_advance(&wire_rig.sim, sim_due(&wire_rig.sim));
}

void wire_rig_pass(uint64_t ticks)
{
    sim_advance(&wire_rig.sim, sim_now(&wire_rig.sim) + ticks);
}

void wire_rig_says(const char *line)
{
    ck_assert_msg(looked_at < wire_rig.lines, "expected '%s', but nothing more was said", line);
    ck_assert_str_eq(wire_rig.line[looked_at++], line);
}

void wire_rig_says_no_more(void)
{
    ck_assert_msg(looked_at == wire_rig.lines, "unexpected: '%s'", wire_rig.line[looked_at]);
}
