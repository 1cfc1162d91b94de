/* SPDX-License-Identifier: MIT */
/* reference.c: references of axes (NH1 to NH4). */
#include "frame.h"

#define NULL_POINT_MAX ((int64_t)CNC_POSITION_MAX_MM * CNC_U_PER_MM)

static bool has_bit(const struct cnc *cnc, enum cnc_cell cell, unsigned axis)
{
    return (cnc_number(&cnc->cells, cell, 0) >> axis & 1) != 0;
}

static void put_bit(struct cnc *cnc, enum cnc_cell cell, unsigned axis, bool value)
{
    const int64_t bits = cnc_number(&cnc->cells, cell, 0), bit = INT64_C(1) << axis;
    cnc_put_number(&cnc->cells, cell, 0, value ? bits | bit : bits & ~bit);
}

/* The axis stands at this position of POS5 from now on. */
static void put_position(struct cnc *cnc, unsigned i, int64_t position)
{
    struct cnc_axis *axis = &cnc->axis[i];
    const int64_t by = position - cnc_position(cnc, i, 5);
    axis->position += by;
    axis->actual += by;
    axis->block_start = axis->position;
    put_bit(cnc, CNC_CELL_HOMING, i, true);
}

static bool is_referencing(const struct cnc *cnc)
{
    for (unsigned i = 0; i < CNC_AXES; i++)
        if (cnc->axis[i].reference.state != CNC_REFERENCE_NONE)
            return true;
    return false;
}

/* ---- Requests ---------------------------------------------------------------------------------------------------------- */

/* HOMING_REQ: the axis gets its position from the PLC program (NH1). */
static void take_position(struct cnc *cnc, unsigned i)
{
    const bool moves = cnc->machine.phase == CNC_MOVE && !cnc_is_set(cnc, CNC_BIT_PO_STOP);
    if (moves || cnc->move.is_going || cnc->axis[i].kind != CNC_SINGLE_NONE)
        return; /* it waits */
    const int64_t distance = cnc_number(&cnc->cells, CNC_CELL_REFPOINT_DIST, i);
    put_bit(cnc, CNC_CELL_HOMING_REQ, i, false);
    if (!cnc->config->axis[i].is_configured || distance < -NULL_POINT_MAX || distance > NULL_POINT_MAX)
        cnc_report_event(cnc, CNC_EVENT_REFERENCE_FAILED, i);
    else
        put_position(cnc, i, cnc->config->axis[i].null_point + distance);
}

/* The passes of a reference begin, as of a block. */
static void begin_block(struct cnc *cnc)
{
    cnc->machine.is_reference = true;
    cnc_begin_phase(cnc, CNC_INIT);
    cnc_show_start(cnc, CNC_BIT_REFPI);
    cnc_report_event(cnc, CNC_EVENT_BLOCK, 0);
}

/* HOMING_START_REQ (NH2). */
static void take_reference(struct cnc *cnc, unsigned i)
{
    struct cnc_axis *axis = &cnc->axis[i];
    const struct cnc_machine *machine = &cnc->machine;
    if (axis->reference.state != CNC_REFERENCE_NONE)
        return;
    if (cnc_is_set(cnc, CNC_BIT_START_DISABLE) || !cnc->config->axis[i].is_configured) {
        put_bit(cnc, CNC_CELL_HOMING_START_REQ, i, false);
        cnc_report_event(cnc, CNC_EVENT_REFERENCE_FAILED, i);
        return;
    }
    const bool fits = machine->phase == CNC_IDLE || (machine->is_reference && machine->phase < CNC_DELAY);
    if (!fits || machine->annulment != CNC_ANNULMENT_NONE || axis->kind != CNC_SINGLE_NONE)
        return; /* it waits */
    axis->reference = (struct cnc_reference){.state = CNC_REFERENCE_WAITS, .was_kr = cnc_is_set(cnc, CNC_BIT_KRx + i),
                                             .was_krr = cnc_is_set(cnc, CNC_BIT_KRRx + i)};
    if (!machine->is_reference)
        begin_block(cnc);
}

void cnc_take_references(struct cnc *cnc)
{
    for (unsigned i = 0; i < CNC_AXES; i++)
        if (has_bit(cnc, CNC_CELL_HOMING_REQ, i))
            take_position(cnc, i);
    for (unsigned i = 0; i < CNC_AXES; i++)
        if (has_bit(cnc, CNC_CELL_HOMING_START_REQ, i))
            take_reference(cnc, i);
}

enum cnc_result cnc_home(struct cnc *cnc, unsigned axis)
{
    static const enum cnc_bit bits[] = {CNC_BIT_HOMING_SINGLE, CNC_BIT_HOMING_PLC, CNC_BIT_HOMING_GROUP};
    const struct cnc_axis_config *config = axis < CNC_AXES ? &cnc->config->axis[axis] : NULL;
    if (config == NULL || !config->is_configured)
        return CNC_NO_AXIS;
    if (cnc_is_set(cnc, CNC_BIT_START_DISABLE)) {
        cnc_report_event(cnc, CNC_EVENT_REFERENCE_FAILED, axis);
        return CNC_DISABLED;
    }
    if (config->reference_method == 0)
        put_bit(cnc, CNC_CELL_HOMING_START_REQ, axis, true);
    cnc_set(cnc, bits[config->reference_method], true);
    return CNC_OK;
}

void cnc_stop_references(struct cnc *cnc, bool by_emergency)
{
    for (unsigned i = 0; i < CNC_AXES; i++) {
        struct cnc_reference *reference = &cnc->axis[i].reference;
        if (reference->state == CNC_REFERENCE_NONE)
            continue;
        reference->state = CNC_REFERENCE_ENDS;
        reference->by_emergency = reference->by_emergency || by_emergency;
    }
}

void cnc_drop_references(struct cnc *cnc)
{
    cnc_put_number(&cnc->cells, CNC_CELL_HOMING_START_REQ, 0, 0);
    cnc_set(cnc, CNC_BIT_HOMING_SINGLE, false);
    for (unsigned i = 0; i < CNC_AXES; i++)
        cnc->axis[i].reference.state = CNC_REFERENCE_NONE;
}

/* ---- Motion ------------------------------------------------------------------------------------------------------------ */

/* The switches in this T. */
struct switches {
    bool kr, kr_rises, krr_rises, slow;
};

static struct switches read_switches(struct cnc *cnc, unsigned i)
{
    struct cnc_reference *reference = &cnc->axis[i].reference;
    const bool kr = cnc_is_set(cnc, CNC_BIT_KRx + i), krr = cnc_is_set(cnc, CNC_BIT_KRRx + i);
    const bool slow = cnc_is_set(cnc, CNC_BIT_ZPRx + i);
    const struct switches switches = {kr, kr && !reference->was_kr, krr && !reference->was_krr, slow};
    reference->was_kr = kr;
    reference->was_krr = krr;
    return switches;
}

/* What the switches change. */
static void follow_switches(struct cnc_axis *axis, const struct switches *switches)
{
    struct cnc_reference *reference = &axis->reference;
    if (reference->state == CNC_REFERENCE_SEARCH && switches->kr_rises) {
        reference->state = CNC_REFERENCE_STOP;
        reference->seen_at = axis->position;
    } else if (reference->state == CNC_REFERENCE_SEARCH && switches->krr_rises) {
        reference->state = CNC_REFERENCE_TO_BACK;
    } else if (reference->state == CNC_REFERENCE_BACK && switches->kr) {
        reference->has_seen_kr = true;
    } else if (reference->state == CNC_REFERENCE_BACK && reference->has_seen_kr) {
        reference->state = CNC_REFERENCE_TO_SEARCH;
    }
}

/* 1, -1: the direction of the present state. */
static int find_direction(const struct cnc *cnc, unsigned i)
{
    const struct cnc_axis *axis = &cnc->axis[i];
    const int forward = cnc->config->axis[i].searches_plus ? 1 : -1;
    switch ((enum cnc_reference_state)axis->reference.state) {
    case CNC_REFERENCE_BACK:
    case CNC_REFERENCE_TO_SEARCH:
        return -forward;
    case CNC_REFERENCE_ENDS:
        return axis->direction;
    default:
        return forward;
    }
}

/* Speed to be reached, 1/1000 mm/min. */
static int64_t find_feed(const struct cnc *cnc, unsigned i, const struct switches *switches)
{
    const struct cnc_axis_config *config = &cnc->config->axis[i];
    const struct cnc_reference *reference = &cnc->axis[i].reference;
    if (reference->state == CNC_REFERENCE_SEARCH)
        return switches->slow || reference->is_slow ? config->feed_reference : config->feed;
    if (reference->state == CNC_REFERENCE_BACK)
        return switches->kr || switches->slow ? config->feed_reference : config->feed;
    return 0;
}

static void end_reference(struct cnc *cnc, unsigned i, bool is_done)
{
    put_bit(cnc, CNC_CELL_HOMING_START_REQ, i, false);
    cnc->axis[i].reference.state = CNC_REFERENCE_NONE;
    cnc_end_single(cnc, i);
    cnc_report_event(cnc, is_done ? CNC_EVENT_REFERENCE_DONE : CNC_EVENT_REFERENCE_FAILED, i);
}

/* The axis has come to rest. */
static void advance_state(struct cnc *cnc, unsigned i)
{
    struct cnc_axis *axis = &cnc->axis[i];
    switch ((enum cnc_reference_state)axis->reference.state) {
    case CNC_REFERENCE_TO_BACK:
        axis->reference.state = CNC_REFERENCE_BACK;
        break;
    case CNC_REFERENCE_TO_SEARCH:
        axis->reference.state = CNC_REFERENCE_SEARCH;
        axis->reference.is_slow = true;
        break;
    case CNC_REFERENCE_STOP:
        put_position(cnc, i, cnc->config->axis[i].null_point + axis->position - axis->reference.seen_at);
        end_reference(cnc, i, true);
        break;
    case CNC_REFERENCE_ENDS:
        end_reference(cnc, i, false);
        break;
    default:
        break;
    }
}

static void begin_reference(struct cnc *cnc, unsigned i)
{
    struct cnc_reference *reference = &cnc->axis[i].reference;
    if (reference->state == CNC_REFERENCE_WAITS)
        reference->state = cnc_is_set(cnc, CNC_BIT_KRx + i) ? CNC_REFERENCE_BACK : CNC_REFERENCE_SEARCH;
    cnc_begin_single(cnc, i, CNC_SINGLE_REFERENCE, find_direction(cnc, i), CNC_ENDLESS);
    cnc_request_single(cnc, i, true);
}

static void move_reference(struct cnc *cnc, unsigned i)
{
    struct cnc_axis *axis = &cnc->axis[i];
    const struct switches switches = read_switches(cnc, i);
    if (axis->kind == CNC_SINGLE_SPINDLE)
        return; /* it comes to its place first */
    if (axis->kind == CNC_SINGLE_NONE)
        begin_reference(cnc, i);
    follow_switches(axis, &switches);
    const int direction = find_direction(cnc, i);
    const bool is_limit = cnc_find_limit(cnc, i, direction) != CNC_LIMIT_NONE;
    if (is_limit)
        axis->reference.state = CNC_REFERENCE_ENDS;
    const bool is_held = !cnc_is_set(cnc, CNC_BIT_MPxPI + i);
    const int64_t feed = find_feed(cnc, i, &switches);
    axis->direction = (int8_t)direction;
    const bool by_emergency = is_held || is_limit || axis->reference.by_emergency;
    const int64_t v = cnc_step_single(cnc, i, is_held ? 0 : cnc_speed_of(feed), by_emergency);
    const bool is_ending = axis->reference.state == CNC_REFERENCE_ENDS;
    if (v == 0 && feed == 0 && (is_ending || cnc_number(&cnc->cells, CNC_CELL_BZH13, 0) == 0))
        advance_state(cnc, i);
}

void cnc_move_references(struct cnc *cnc)
{
    const bool moves = cnc->machine.is_reference && cnc->machine.phase == CNC_MOVE;
    for (unsigned i = 0; i < CNC_AXES; i++) {
        if (cnc->axis[i].reference.state == CNC_REFERENCE_NONE)
            continue;
        if (moves)
            move_reference(cnc, i);
        else
            (void)read_switches(cnc, i);
    }
    if (is_referencing(cnc))
        return;
    if (moves)
        cnc_begin_phase(cnc, CNC_DONE);
    if (cnc_number(&cnc->cells, CNC_CELL_HOMING_START_REQ, 0) == 0)
        cnc_set(cnc, CNC_BIT_HOMING_SINGLE, false);
}
