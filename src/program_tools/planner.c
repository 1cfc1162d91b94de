/* SPDX-License-Identifier: MIT */
#include "planner.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <rkm04/unit.h>

static const struct rkm04_port no_port;

static bool begin(struct planner *planner)
{
    static const struct rkm04_config config = {.node = 1};
    if (planner->unit != NULL)
        return true;
    planner->unit = malloc(sizeof *planner->unit);
    if (planner->unit == NULL)
        return false;
    rkm04_init(planner->unit, &config, &no_port, NULL);
    return true;
}

void planner_end(struct planner *planner)
{
    free(planner->unit);
    planner->unit = NULL;
}

size_t planner_read(const uint8_t *answer, size_t length, struct planner_point points[PLANNER_POINTS_MAX])
{
    size_t count = 0;
    for (size_t at = 2; at < length && count < PLANNER_POINTS_MAX; at++) {
        uint32_t number[2] = {0, 0};
        if (answer[at] != '(')
            continue;
        for (unsigned which = 0; ++at < length && answer[at] != ')';) {
            if (answer[at] == ';')
                which = 1;
            else
                number[which] = 10 * number[which] + (uint32_t)(answer[at] - '0');
        }
        points[count++] = (struct planner_point){number[0], number[1]};
    }
    return count;
}

/* The text that makes this motion. Returns the number of its commands after `\`. */
static size_t write_motion(char *text, size_t size, uint16_t start_speed, const struct planner_segment *segments, size_t count)
{
    size_t at = (size_t)snprintf(text, size, "\\C100 S%u ", start_speed);
    for (size_t i = 0; i < count; i++)
        at += (size_t)snprintf(text + at, size - at, count == 1 ? "V%u A%u G%" PRIu32 : "V%u A%u F%" PRIu32 " Y ",
                               segments[i].speed, segments[i].acceleration, segments[i].steps);
    if (count == 1)
        return 5;
    snprintf(text + at, size - at, "R");
    return 2 + 4 * count + 1;
}

size_t planner_ask(struct planner *planner, uint16_t start_speed, const struct planner_segment *segments, size_t count,
                   struct planner_point points[PLANNER_POINTS_MAX])
{
    static const uint8_t get_table[] = {6, '1'};
    char text[64 * (RKM04_SEGMENTS_MAX + 1)];
    uint8_t answer[1024];
    if (!begin(planner))
        return 0;
    const size_t commands = write_motion(text, sizeof text, start_speed, segments, count);
    rkm04_set_command(planner->unit, '1', text, strlen(text), NULL);
    /* Up to the slot of the last command; the first one is executed in the next slot, which is not that of tick 0. */
    const uint64_t now = rkm04_now(planner->unit), slot = RKM04_SLOT_TICKS;
    const uint64_t first = now == 0 ? slot : (now + slot - 1) / slot * slot;
    rkm04_advance(planner->unit, first + (commands - 1) * slot + 1 - now);
    size_t length = rkm04_exchange(planner->unit, get_table, sizeof get_table, answer, sizeof answer);
    return planner_read(answer, length < sizeof answer ? length : sizeof answer, points);
}
