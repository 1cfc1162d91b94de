/* SPDX-License-Identifier: MIT */
/* hold.c: what holds a motion (NM9, NH4). */
#include "frame.h"

enum cnc_limit cnc_find_limit(const struct cnc *cnc, unsigned axis, int direction)
{
    const struct cnc_axis_config *config = &cnc->config->axis[axis];
    if (cnc_is_set(cnc, (direction > 0 ? CNC_BIT_KHx0 : CNC_BIT_KHx1) + axis))
        return CNC_LIMIT_SWITCH;
    if (!(direction > 0 ? config->has_sls_plus : config->has_sls_minus))
        return CNC_LIMIT_NONE;
    const int64_t both = cnc_number(&cnc->cells, CNC_CELL_SLS_REFER, 0) & cnc_number(&cnc->cells, CNC_CELL_HOMING, 0);
    if ((both >> axis & 1) == 0)
        return CNC_LIMIT_NONE;
    const int64_t position = cnc_position(cnc, axis, 5);
    if (direction > 0 ? position >= config->sls_plus : position <= config->sls_minus)
        return CNC_LIMIT_SOFTWARE;
    return CNC_LIMIT_NONE;
}

static enum cnc_hold stronger(enum cnc_hold a, enum cnc_hold b)
{
    return a > b ? a : b;
}

enum cnc_hold cnc_find_hold(const struct cnc *cnc)
{
    const struct cnc_section *section = &cnc->move.section;
    const struct cnc_segment *now = &section->segment[cnc_section_at(section, cnc->move.path.done)];
    if (cnc_number(&cnc->cells, CNC_CELL_BZH13, 0) != 0)
        return CNC_HOLD_ERROR;
    enum cnc_hold hold = cnc->machine.is_stopped ? (enum cnc_hold)cnc->machine.stop : CNC_HOLD_NONE;
    for (unsigned i = 0; i < CNC_AXES; i++) {
        if (!cnc_has_axis(section->axes, i))
            continue;
        if (!cnc_is_set(cnc, CNC_BIT_MPxPI + i))
            return CNC_HOLD_ENABLE;
        if (cnc_is_set(cnc, CNC_BIT_KHx0 + i) || cnc_is_set(cnc, CNC_BIT_KHx1 + i) ||
            (now->way[i] != 0 && cnc_find_limit(cnc, i, now->way[i] > 0 ? 1 : -1) != CNC_LIMIT_NONE))
            hold = stronger(hold, CNC_HOLD_LIMIT);
    }
    return hold;
}
