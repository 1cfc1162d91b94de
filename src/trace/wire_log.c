/* SPDX-License-Identifier: MIT */
/* wire_log.c: a line of text for every frame, or what was dropped of one. */
#include "wire/wire.h"
#include "wire_format.h"

#define TIME_WIDTH 12      /* columns of a time: eleven days */
#define DIRECTION_WIDTH 14 /* columns of most directions */

static void log_head(struct wire_text *out, const struct sim *sim)
{
    wire_text_string(out, "# rkm04 wire log 1: ");
    wire_text_string(out, sim->monitor.framing->link->name);
    wire_text_string(out, sim->segment.config.timed ? ", " : ", bytes take no time");
    if (sim->segment.config.timed) {
        wire_text_number(out, sim->segment.config.baud, 0);
        wire_text_string(out, " baud");
    }
    wire_text_string(out, sim_units(sim) == 1 ? ", unit" : ", units");
    for (unsigned number = 1; number <= sim_units(sim); number++) {
        wire_text_put(out, ' ');
        wire_text_string(out, sim->unit[number - 1u].name);
    }
    wire_text_string(out, "\n#  begins us      ends us  direction       message | bytes\n");
}

static void put_times(struct wire_text *out, uint64_t start, uint64_t end)
{
    wire_text_number(out, start, TIME_WIDTH);
    wire_text_put(out, ' ');
    wire_text_number(out, end, TIME_WIDTH);
    wire_text_string(out, "  ");
}

static void log_message(struct wire_text *out, const struct sim *sim, const struct wire_message *message)
{
    put_times(out, message->start, message->end);
    size_t column = out->length;
    const struct wire_names names = sim_wire_names(sim);
    wire_words_direction(out, &names, message);
    do
        wire_text_put(out, ' ');
    while (out->length < column + DIRECTION_WIDTH + 2u);
    wire_words_story(out, &names, message);
    wire_text_string(out, " | ");
    wire_text_hex(out, message->raw, message->raw_length);
    if (message->raw_total > message->raw_length) {
        wire_text_string(out, " and more, ");
        wire_text_number(out, message->raw_total, 0);
        wire_text_string(out, " in all");
    }
    wire_text_put(out, '\n');
}

static void log_news(struct wire_text *out, const struct sim *sim, const struct watch_event *event)
{
    put_times(out, event->tick, event->tick);
    wire_text_string(out, "-- ");
    wire_news_words(out, sim, event);
    wire_text_put(out, '\n');
}

const struct wire_format wire_log = {
    .suffix = ".log",
    .kind = {.name = "a log of the wires", .begins = {"# rkm04 wire log "}},
    .head = log_head,
    .message = log_message,
    .news = log_news,
};
