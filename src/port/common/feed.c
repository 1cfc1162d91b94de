/* SPDX-License-Identifier: MIT */
#include "feed.h"

#include "board.h"

enum { BACK = 0, STEP = 1, FORWARD = 2 }; /* levels of a motor */

static struct {
    uint32_t end;    /* tick at which the pins change by the last word */
    uint32_t levels; /* as they are then, without pulse */
} fed[PULSES_LANES];

void feed_start(unsigned lane, uint32_t end)
{
    fed[lane].end = end;
    fed[lane].levels = 0;
}

void feed_levels(uint32_t of, uint32_t mask)
{
    fed[0].levels = (fed[0].levels & ~of) | mask;
}

uint32_t feed_level(void)
{
    return fed[0].levels;
}

static void give(unsigned lane, uint32_t tick, uint32_t step)
{
    uint32_t after = tick - fed[lane].end;
    fed[lane].end = tick;
    board_feed_give(lane, after, fed[lane].levels | step);
}

/* Take the item out of the lane. Returns STEP if it is one. */
static uint32_t take(unsigned lane, uint32_t tick, uint32_t item)
{
    pulses_drop(&board_pulses, lane);
    if (lane > 0 && item == PULSE_STEP)
        return STEP;
    if (lane > 0) {
        fed[lane].levels = item == PULSE_FORWARD ? FORWARD : BACK;
        return 0;
    }
    uint32_t next;
    uint8_t other = (uint8_t)item;
    do
        feed_levels(0xff, other);
    while (pulses_peek(&board_pulses, 0, &next, &other) && next == tick && (pulses_drop(&board_pulses, 0), true));
    return 0;
}

void feed(unsigned lane, const struct feed_timing *timing, uint32_t now)
{
    uint32_t tick;
    uint8_t item;
    unsigned room = board_feed_room(lane);
    if ((int32_t)(fed[lane].end + timing->rest - now) < 0)
        fed[lane].end = now - timing->rest; /* it has run dry, and begins with the next word */
    while (pulses_peek(&board_pulses, lane, &tick, &item) && (int32_t)(tick - now) < FEED_WINDOW) {
        if (room-- == 0)
            return;
        uint32_t step = take(lane, tick, item), earliest = fed[lane].end + timing->apart;
        if ((int32_t)(earliest - tick) > 0) {
            board_pulses.latest = earliest - tick > board_pulses.latest ? earliest - tick : board_pulses.latest;
            tick = earliest;
        }
        give(lane, tick, step);
    }
    if ((int32_t)(fed[lane].end - now) < FEED_WINDOW / 4 && room > 0)
        give(lane, now + FEED_WINDOW / 2, 0);
}
