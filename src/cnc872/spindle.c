/* SPDX-License-Identifier: MIT */
/* spindle.c: speed of the spindle and its gear (NF2 to NF5), spindle axes (NF6). */
#include "frame.h"
#include "wide.h"

#define VOLTAGE_MAX 32767 /* 7FFFh */
#define SPEED_MAX INT64_C(1000000000000000) /* 1/1000 rev/min: no gear reaches it, whatever the overrides */
#define TURN (INT64_C(360000) * CNC_U_PER_UM)

/* a * b / divisor, rounded down; the result fits. */
static int64_t scale(int64_t a, int64_t b, int64_t divisor)
{
    uint64_t rest;
    return (int64_t)wide_divide(wide_product((uint64_t)a, (uint64_t)b), (uint64_t)divisor, &rest);
}

/* The gear that is in, or `gear` if it is not 0; NULL: the configuration does not have it. */
static const struct cnc_gear *find_limits(const struct cnc *cnc, int64_t gear)
{
    gear = gear != 0 ? gear : cnc_number(&cnc->cells, CNC_CELL_SPINDLE_GEAR_ACT_1, 0);
    return gear <= (int64_t)CNC_GEARS && cnc->config->gear[gear].is_configured ? &cnc->config->gear[gear] : NULL;
}

/* ---- M40 to M44 (NF5) --------------------------------------------------------------------------------------------------- */

/* The lowest of the gears 1 to 4 that reaches S, or else the highest of them. */
static unsigned choose_gear(const struct cnc *cnc, int64_t speed)
{
    unsigned chosen = 1;
    for (unsigned gear = 1; gear <= 4; gear++) {
        if (!cnc->config->gear[gear].is_configured)
            continue;
        chosen = gear;
        if ((int64_t)cnc->config->gear[gear].max_speed * 1000 >= speed)
            break;
    }
    return chosen;
}

/* The gear that the block asks for: by M41 to M44, by M40, or by S while M40 is in force; 0: it asks for none. */
static unsigned find_gear(const struct cnc *cnc, const struct cnc_nc_block *block)
{
    const uint8_t m = block->m[3];
    const bool has_speed = block->has_speed && (block->modes & CNC_NC_CONSTANT_CUT) == 0;
    if (m > 40 && m <= 44)
        return m - 40u;
    if (m == 40 || (m == CNC_NC_NO_M && has_speed && cnc->machine.m[3] == 40))
        return choose_gear(cnc, cnc_nc_value(cnc->program, block->speed));
    return 0;
}

static bool has_external_gear(const struct cnc *cnc)
{
    return cnc_is_set(cnc, CNC_BIT_REQ_EXT_SPINDLE_GEAR) && cnc_is_set(cnc, CNC_BIT_REQ_MAN_SPINDLE_GEAR);
}

void cnc_publish_gear(struct cnc *cnc, const struct cnc_nc_block *block)
{
    const unsigned gear = find_gear(cnc, block);
    if (gear == 0)
        return;
    if (!cnc_is_set(cnc, CNC_BIT_M41PI + gear - 1))
        cnc_set(cnc, CNC_BIT_ZMMnPI + 3 - 1, true);
    for (unsigned i = 1; i <= 4; i++)
        cnc_set(cnc, CNC_BIT_M41PI + i - 1, i == gear);
    if (!has_external_gear(cnc)) /* else the PLC program writes the gear */
        cnc_put_number(&cnc->cells, CNC_CELL_SPINDLE_GEAR_ACT_1, 0, gear);
}

bool cnc_gear_fits(const struct cnc *cnc, const struct cnc_nc_block *block)
{
    const int64_t speed = cnc_nc_value(cnc->program, block->speed);
    const unsigned asked = find_gear(cnc, block);
    if ((block->modes & CNC_NC_CONSTANT_CUT) != 0 || speed == 0 || !(block->has_speed || asked != 0) || has_external_gear(cnc))
        return true;
    const struct cnc_gear *limits = find_limits(cnc, asked);
    if (limits == NULL)
        return true;
    return speed >= (int64_t)limits->min_speed * 1000 && speed <= (int64_t)limits->max_speed * 1000;
}

/* ---- Speed -------------------------------------------------------------------------------------------------------------- */

void cnc_publish_spindle(struct cnc *cnc, const struct cnc_nc_block *block)
{
    struct cnc_spindle *spindle = &cnc->spindle;
    spindle->speed = cnc_nc_value(cnc->program, block->speed);
    spindle->cutting_speed = cnc_nc_value(cnc->program, block->cutting_speed);
    spindle->limit = cnc_nc_value(cnc->program, block->speed_limit);
    spindle->constant_cut = (block->modes & CNC_NC_CONSTANT_CUT) != 0;
}

/* G96: the speed of X as radius (NF4), 1/1000 rev/min. */
static int64_t find_cut_speed(const struct cnc *cnc)
{
    const struct cnc_spindle *spindle = &cnc->spindle;
    const uint64_t radius = size_of(cnc->axis[0].position);
    const int64_t limit = spindle->limit > 0 ? spindle->limit / 1000 : SPEED_MAX;
    if (spindle->cutting_speed == 0)
        return 0;
    if (radius == 0)
        return limit;
    /* S in millionths of m/min is V in thousandths of mm/min: V * 10^9 * 1000 * 65 536 000 / (2 * 3 141 592 654 * |X|). */
    uint64_t rest;
    const struct wide product = wide_product((uint64_t)spindle->cutting_speed, UINT64_C(16384000000000000));
    const uint64_t way = wide_divide(product, 1570796327, &rest);
    return way / radius < (uint64_t)limit ? (int64_t)(way / radius) : limit;
}

/* The two factors of NF2 in per mille; none with G33. */
static int64_t find_override(const struct cnc *cnc)
{
    if (cnc_is_set(cnc, CNC_BIT_G33PI))
        return 1000000;
    const int64_t pot = cnc->panel.spindle < CNC_PERCENT_MAX ? cnc->panel.spindle : (int64_t)CNC_PERCENT_MAX;
    const int64_t factor = cnc_is_set(cnc, CNC_BIT_SPEED_OVR) ? cnc_number(&cnc->cells, CNC_CELL_SPEED_OVR_EXT, 0) : pot * 10;
    return factor * cnc_number(&cnc->cells, CNC_CELL_SPEED_OVR_MULTIPLIER, 0);
}

static int64_t find_voltage(int64_t speed, int64_t unit, int64_t most)
{
    return speed / unit >= most ? VOLTAGE_MAX : speed * VOLTAGE_MAX / (most * unit);
}

static void put_actual_speed(struct cnc *cnc, int64_t pm, int64_t pt)
{
    const bool turns = cnc_is_set(cnc, CNC_BIT_M03PI) || cnc_is_set(cnc, CNC_BIT_M04PI);
    const int64_t simulated = cnc_number(&cnc->cells, CNC_CELL_SIM_SPEED_PT, 0);
    if (simulated != 0) {
        pt = simulated;
        pm = simulated * 1000 / 6;
    }
    cnc_put_number(&cnc->cells, CNC_CELL_ACT_SPEED_PM, 0, turns ? pm : 0);
    cnc_put_number(&cnc->cells, CNC_CELL_AVG_SPEED_PM, 0, turns ? pm : 0);
    cnc_put_number(&cnc->cells, CNC_CELL_ACT_SPEED_PT, 0, turns ? pt : 0);
    cnc_put_number(&cnc->cells, CNC_CELL_AVG_SPEED_PT, 0, turns ? pt : 0);
}

void cnc_put_spindle(struct cnc *cnc)
{
    const struct cnc_gear *gear = find_limits(cnc, 0);
    const int64_t most = gear != NULL ? gear->max_speed : CNC_GEAR_SPEED_STANDARD, override = find_override(cnc);
    /* Either way 1/1000 rev/min are rounded down once, after the overrides. */
    const int64_t speed = cnc->spindle.constant_cut ? scale(find_cut_speed(cnc), override, 1000000)
                                                    : scale(cnc->spindle.speed, override, 1000000000);
    const int64_t voltage = find_voltage(speed, 1, most), pm = voltage * most / VOLTAGE_MAX, pt = pm * 6 / 1000;
    cnc_write_number(&cnc->cells, cnc_cell_place(CNC_CELL_PB11), CNC_WORD, find_voltage(cnc->spindle.speed, 1000, most));
    cnc_put_number(&cnc->cells, CNC_CELL_VYSOVERS, 0, voltage);
    cnc_put_number(&cnc->cells, CNC_CELL_REQ_SPEED_PM, 0, pm);
    cnc_put_number(&cnc->cells, CNC_CELL_REQ_SPEED_PT, 0, pt);
    put_actual_speed(cnc, pm, pt);
}

/* ---- Spindle axes (NF6) ------------------------------------------------------------------------------------------------- */

/* Way in + to the next whole turn, 0: it is there. */
static int64_t find_way_to_turn(int64_t position)
{
    const int64_t beyond = position % TURN;
    return beyond == 0 ? 0 : beyond > 0 ? TURN - beyond : -beyond;
}

/* Does the path or a motion of its own move the axis? */
static bool is_moved(const struct cnc *cnc, unsigned i)
{
    return cnc->axis[i].kind != CNC_SINGLE_NONE || (cnc->move.is_going && cnc_has_axis(cnc->move.section.axes, i));
}

static void put_asked(struct cnc *cnc, unsigned i, bool is_asked)
{
    const uint16_t bit = (uint16_t)(1u << i);
    cnc->spindle_asked = (uint16_t)(is_asked ? cnc->spindle_asked | bit : cnc->spindle_asked & ~bit);
    cnc_set(cnc, CNC_BIT_POLOHV_x + i, is_asked);
}

void cnc_position_spindle(struct cnc *cnc, unsigned axis)
{
    const struct cnc_axis_config *config = &cnc->config->axis[axis];
    if (config->is_configured && config->is_rotary && cnc->axis[axis].kind != CNC_SINGLE_SPINDLE)
        put_asked(cnc, axis, is_moved(cnc, axis) || find_way_to_turn(cnc->axis[axis].position) != 0);
}

/* Begin once nothing else moves the axis. */
static void begin_axis(struct cnc *cnc, unsigned i)
{
    const int64_t way = find_way_to_turn(cnc->axis[i].position);
    if (is_moved(cnc, i))
        return;
    put_asked(cnc, i, false);
    if (way == 0)
        return;
    cnc_set(cnc, CNC_BIT_POLOHV_x + i, true);
    cnc_begin_single(cnc, i, CNC_SINGLE_SPINDLE, 1, way);
    cnc_request_single(cnc, i, true);
}

/* One T of the motion to the whole turn; central annulment ends it at rest. */
static void move_axis(struct cnc *cnc, unsigned i)
{
    const bool is_annulled = cnc->machine.annulment == CNC_ANNULMENT_ASKED;
    const bool is_held = !cnc_is_set(cnc, CNC_BIT_MPxPI + i) || cnc_find_limit(cnc, i, 1) != CNC_LIMIT_NONE;
    const int64_t target = is_held || is_annulled ? 0 : cnc_speed_of(cnc->config->axis[i].feed_reference);
    const int64_t v = cnc_step_single(cnc, i, target, is_held);
    if (cnc_path_rest(&cnc->axis[i].path) > 0 && !(is_annulled && v == 0))
        return;
    cnc_set(cnc, CNC_BIT_POLOHV_x + i, false);
    cnc_end_single(cnc, i);
}

void cnc_move_spindles(struct cnc *cnc)
{
    for (unsigned i = 0; i < CNC_AXES; i++) {
        const bool is_asked = cnc_has_axis(cnc->spindle_asked, i);
        if (is_asked && cnc->machine.annulment == CNC_ANNULMENT_ASKED)
            put_asked(cnc, i, false);
        else if (is_asked)
            begin_axis(cnc, i);
        if (cnc->axis[i].kind == CNC_SINGLE_SPINDLE)
            move_axis(cnc, i);
    }
}
