/* SPDX-License-Identifier: MIT */
/* feed.c: speeds of the path as the cells allow them (NM7, NF1). */
#include "frame.h"

struct cnc_override cnc_feed_override(const struct cnc *cnc)
{
    if (cnc->machine.override_cancelled)
        return (struct cnc_override){1000, 1000};
    const int64_t word = cnc_read_number(&cnc->cells, cnc_cell_place(CNC_CELL_BZH09), CNC_WORD);
    const uint32_t pot = cnc->panel.feed < CNC_PERCENT_MAX ? cnc->panel.feed : CNC_PERCENT_MAX;
    return (struct cnc_override){cnc_is_set(cnc, CNC_BIT_FEED_OVR) ? (uint32_t)word : pot * 10u,
                                 (uint32_t)cnc_number(&cnc->cells, CNC_CELL_FEED_OVR_MULTIPLIER, 0)};
}

int64_t cnc_feed_speed(int64_t feed, struct cnc_override override, int64_t speed)
{
    /* 16 384 / 15 u/T a mm/min; 10^15 = 2^15 * 5^15 of millionths and three factors of per mille. 10^12 (F) * 2^31 (speed) *
     * 2^32 (overrides) / divisor is 1.1 * 10^19. */
    const int64_t divisor = INT64_C(30) * 30517578125;
    if (feed <= 0 || speed <= 0)
        return 0;
    return cnc_scale(feed * override.multiplier, speed * override.percent, divisor);
}

int64_t cnc_programmed_speed(const struct cnc *cnc, const struct cnc_nc_block *block, struct cnc_override override)
{
    const bool threads = block->motion == CNC_MOTION_THREAD;
    const bool per_revolution = threads || (block->modes & CNC_NC_PER_REVOLUTION) != 0;
    return cnc_feed_speed(cnc_nc_value(cnc->program, block->feed), threads ? (struct cnc_override){1000, 1000} : override,
                          per_revolution ? cnc_number(&cnc->cells, CNC_CELL_ACT_SPEED_PM, 0) : 1000);
}

int64_t cnc_feed_limit(const struct cnc *cnc, bool rapid)
{
    if (!cnc_is_set(cnc, rapid ? CNC_BIT_LIMIT_FEED_G00_REQ : CNC_BIT_LIMIT_FEED_REQ))
        return CNC_SPEED_LIMIT;
    const int64_t limit = cnc_number(&cnc->cells, rapid ? CNC_CELL_LIMIT_FEED_G00 : CNC_CELL_LIMIT_FEED, 0);
    return limit > 0 ? limit : 0;
}

static int64_t segment_target(const struct cnc *cnc, unsigned k, struct cnc_override override)
{
    const struct cnc_segment *segment = &cnc->move.section.segment[k];
    const struct cnc_nc_block *block = &cnc->program->blocks[cnc->move.section.first + k];
    const bool is_rapid = block->motion == CNC_MOTION_RAPID;
    const int64_t limit = cnc_feed_limit(cnc, is_rapid);
    int64_t target = is_rapid ? cnc_scale(segment->rapid, (int64_t)override.percent * override.multiplier, 1000000)
                              : cnc_programmed_speed(cnc, block, override);
    target = target < segment->rapid ? target : segment->rapid;
    return target < limit ? target : limit;
}

void cnc_find_targets(const struct cnc *cnc, int64_t target[CNC_SEGMENTS_MAX])
{
    const struct cnc_section *section = &cnc->move.section;
    const struct cnc_override override = cnc_feed_override(cnc);
    bool is_slow = false;
    for (unsigned i = 0; i < CNC_AXES; i++)
        if (cnc_has_axis(section->axes, i))
            is_slow |= cnc_is_set(cnc, CNC_BIT_ZPx0 + i) || cnc_is_set(cnc, CNC_BIT_ZPx1 + i);
    for (unsigned k = 0; k < section->count; k++) {
        target[k] = segment_target(cnc, k, override);
        if (is_slow && section->segment[k].slow < target[k])
            target[k] = section->segment[k].slow;
    }
}
