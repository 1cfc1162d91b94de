/* SPDX-License-Identifier: MIT */
/* manual.c: manual moves (NA1 to NA5, NM11), and what motions of single axes have in common. */
#include "frame.h"

/* ---- Motions of single axes -------------------------------------------------------------------------------------------- */

void cnc_begin_single(struct cnc *cnc, unsigned axis, enum cnc_single_kind kind, int direction, int64_t length)
{
    struct cnc_axis *moved = &cnc->axis[axis];
    cnc_path_begin(&moved->path, NULL, length, cnc->config->axis[axis].acceleration[CNC_SET_NORMAL], 1);
    moved->kind = (uint8_t)kind;
    moved->direction = (int8_t)direction;
}

void cnc_request_single(struct cnc *cnc, unsigned axis, bool is_requested)
{
    cnc_set(cnc, CNC_BIT_PO_OSxPI + axis, is_requested || cnc_is_set(cnc, CNC_BIT_PO_OSx + axis));
}

void cnc_end_single(struct cnc *cnc, unsigned axis)
{
    cnc->axis[axis].kind = CNC_SINGLE_NONE;
    cnc->axis[axis].direction = 0;
    cnc_request_single(cnc, axis, false);
}

int64_t cnc_step_single(struct cnc *cnc, unsigned axis, int64_t target, bool by_emergency)
{
    struct cnc_axis *moved = &cnc->axis[axis];
    const struct cnc_axis_config *config = &cnc->config->axis[axis];
    const int64_t hold = by_emergency ? config->acceleration[CNC_SET_EMERGENCY] : 0, most = cnc_speed_of(config->feed_rapid);
    const bool is_far = moved->direction * moved->position >= CNC_REACH;
    if (is_far || cnc_number(&cnc->cells, CNC_CELL_BZH13, 0) != 0) {
        cnc_path_halt(&moved->path, NULL);
        return 0;
    }
    const int64_t v = cnc_path_step(&moved->path, NULL, target < most ? target : most, hold, NULL);
    moved->position += moved->direction * v;
    if (v > 0)
        cnc_set(cnc, CNC_BIT_SM_POxPI + axis, moved->direction < 0);
    return v;
}

bool cnc_has_single(const struct cnc *cnc, uint16_t axes)
{
    for (unsigned i = 0; i < CNC_AXES; i++)
        if (cnc_has_axis(axes, i) && cnc->axis[i].kind != CNC_SINGLE_NONE)
            return true;
    return false;
}

/* ---- Manual moves ------------------------------------------------------------------------------------------------------ */

/* Do axes still run out? */
static bool is_busy(const struct cnc *cnc)
{
    for (unsigned i = 0; i < CNC_AXES; i++)
        if (cnc->axis[i].kind == CNC_SINGLE_MANUAL)
            return true;
    return false;
}

/* May axes be moved by hand (NA1)? */
static bool is_active(const struct cnc *cnc)
{
    const bool is_asked = cnc_is_set(cnc, CNC_BIT_AUTMAN_REQ) || cnc->panel.manual;
    return cnc_is_set(cnc, CNC_BIT_EN_AUTMAN) && is_asked && !cnc->machine.is_reference &&
           (cnc->machine.phase == CNC_IDLE || cnc_is_set(cnc, CNC_BIT_PO_STOP));
}

/* Speed of an axis in u/T (NA3). */
static int64_t find_speed(const struct cnc *cnc, unsigned axis, bool rapid)
{
    const struct cnc_axis_config *config = &cnc->config->axis[axis];
    const bool has_own = cnc_is_set(cnc, rapid ? CNC_BIT_REQ_EXT_G00_AUTMAN : CNC_BIT_REQ_EXT_FEED_AUTMAN);
    const int64_t own = cnc_number(&cnc->cells, rapid ? CNC_CELL_EXT_FEED_G00_AUTMAN : CNC_CELL_EXT_FEED_AUTMAN, 0) * 1000;
    int64_t feed = rapid ? config->feed_rapid : config->feed;
    if (has_own && (!rapid || own != 0))
        feed = own;
    int64_t speed = cnc_feed_speed(feed * 1000, cnc_feed_override(cnc), 1000);
    const int64_t slow = cnc_speed_of(config->feed_slow), limit = cnc_feed_limit(cnc, rapid);
    speed = speed < limit ? speed : limit;
    if ((cnc_is_set(cnc, CNC_BIT_ZPx0 + axis) || cnc_is_set(cnc, CNC_BIT_ZPx1 + axis)) && slow < speed)
        speed = slow;
    return speed;
}

/* The direction in which an axis is to move, 1, -1 or 0 (NA2). */
static int find_request(const struct cnc *cnc, unsigned axis)
{
    const bool outside = cnc_is_set(cnc, CNC_BIT_REQ_EXT_CONT_AUTMAN);
    const bool plus = outside ? cnc_is_set(cnc, CNC_BIT_EXM_x0 + axis) : cnc_has_axis(cnc->panel.jog_plus, axis);
    const bool minus = outside ? cnc_is_set(cnc, CNC_BIT_EXM_x1 + axis) : cnc_has_axis(cnc->panel.jog_minus, axis);
    return (int)plus - (int)minus;
}

static void move_axis(struct cnc *cnc, unsigned i, bool may_move, bool rapid)
{
    struct cnc_axis *axis = &cnc->axis[i];
    const uint16_t bit = (uint16_t)(1u << i);
    int request = find_request(cnc, i);
    if (request == 0)
        cnc->manual_stopped = (uint16_t)(cnc->manual_stopped & ~bit);
    if (!may_move || (cnc->manual_stopped & bit) != 0)
        request = 0;
    if (axis->kind == CNC_SINGLE_NONE) {
        if (request == 0 || cnc_number(&cnc->cells, CNC_CELL_BZH13, 0) != 0)
            return;
        cnc_begin_single(cnc, i, CNC_SINGLE_MANUAL, request, CNC_ENDLESS);
        cnc->manual_emergency = (uint16_t)(cnc->manual_emergency & ~bit);
    }
    if (axis->kind != CNC_SINGLE_MANUAL)
        return;
    const bool enabled = cnc_is_set(cnc, (cnc->config->manual_by_man ? CNC_BIT_MPxMAN : CNC_BIT_MPxPI) + i);
    const bool is_held = !enabled || cnc_find_limit(cnc, i, axis->direction) != CNC_LIMIT_NONE;
    const int64_t target = request == axis->direction && !is_held ? find_speed(cnc, i, rapid) : 0;
    const int64_t v = cnc_step_single(cnc, i, target, is_held || (cnc->manual_emergency & bit) != 0);
    cnc_request_single(cnc, i, v > 0);
    if (v == 0)
        cnc_end_single(cnc, i);
}

void cnc_move_manual(struct cnc *cnc)
{
    const bool active = is_active(cnc), shown = active || is_busy(cnc);
    const bool outside = cnc_is_set(cnc, CNC_BIT_REQ_EXT_CONT_AUTMAN);
    const bool chosen_only = cnc_is_set(cnc, CNC_BIT_REQ_EXT_SELECT_AUTMAN);
    const bool rapid = cnc_is_set(cnc, CNC_BIT_REQ_EXT_G00_AUTMAN) || cnc->panel.rapid;
    cnc_set(cnc, CNC_BIT_ACK_AUTMAN, shown);
    cnc_set(cnc, CNC_BIT_SF_MANUALMODE, shown);
    cnc_set(cnc, CNC_BIT_AUTMAN_CONT_NC, shown && !outside && !cnc->panel.hand);
    cnc_set(cnc, CNC_BIT_AUTMAN_CONT_TOC, shown && !outside && cnc->panel.hand);
    cnc_set(cnc, CNC_BIT_AUTMAN_CONT_SELECT, shown && chosen_only);
    cnc_set(cnc, CNC_BIT_AUTMAN_CONT_G00, shown && rapid);
    for (unsigned i = 0; i < CNC_AXES; i++)
        if (cnc->config->axis[i].is_configured)
            move_axis(cnc, i, active && !chosen_only, rapid);
}

void cnc_stop_manual(struct cnc *cnc, bool by_emergency)
{
    for (unsigned i = 0; i < CNC_AXES; i++) {
        if (cnc->axis[i].kind != CNC_SINGLE_MANUAL)
            continue;
        cnc->manual_stopped = (uint16_t)(cnc->manual_stopped | 1u << i);
        if (by_emergency)
            cnc->manual_emergency = (uint16_t)(cnc->manual_emergency | 1u << i);
    }
}
