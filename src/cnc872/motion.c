/* SPDX-License-Identifier: MIT */
/* motion.c: the path of a block or section, T by T, and the servo loop (sections 4 and 6). */
#include "frame.h"

#include <string.h>

#define LOOK_STEPS_MAX 100000 /* of a look ahead, what is known at once apart */

void cnc_drop_motion(struct cnc *cnc)
{
    cnc->move.section.count = 0;
    cnc->move.is_begun = cnc->move.is_going = false;
    cnc->move.has_look = false;
    cnc->move.segment = 0;
    cnc_set(cnc, CNC_BIT_G23ACT, false);
    cnc_put_number(&cnc->cells, CNC_CELL_TIME_DIST, 0, 0);
}

void cnc_prepare_motion(struct cnc *cnc)
{
    int64_t position[CNC_AXES];
    for (unsigned i = 0; i < CNC_AXES; i++)
        position[i] = cnc->axis[i].position;
    cnc_drop_motion(cnc);
    cnc_section_build(&cnc->move.section, cnc->config, cnc->program, cnc->machine.block, position, cnc->panel.block_by_block);
}

bool cnc_path_moves(const struct cnc *cnc)
{
    const struct cnc_path *path = &cnc->move.path;
    return cnc->move.is_going && cnc_path_rest(path) > 0 && !cnc_path_is_at_rest(path);
}

bool cnc_axes_move(const struct cnc *cnc)
{
    for (unsigned i = 0; i < CNC_AXES; i++)
        if (cnc->axis[i].direction != 0)
            return true;
    return cnc_path_moves(cnc);
}

/* Are the axes elsewhere than the path left them, or than it begins? */
static bool has_moved(const struct cnc *cnc)
{
    const struct cnc_section *section = &cnc->move.section;
    int64_t place[CNC_AXES] = {0};
    cnc_section_place(section, cnc->move.is_begun ? cnc->move.path.done : 0, place);
    for (unsigned i = 0; i < CNC_AXES; i++)
        if (cnc_has_axis(section->axes, i) && place[i] != cnc->axis[i].position)
            return true;
    return false;
}

bool cnc_begin_motion(struct cnc *cnc)
{
    struct cnc_move *move = &cnc->move;
    if (!move->is_going && has_moved(cnc)) {
        cnc->machine.is_continued |= move->is_begun || cnc_is_set(cnc, CNC_BIT_BLOCK_RESTART); /* NA5 */
        cnc_prepare_motion(cnc);
    }
    if (move->section.count == 0)
        return false;
    if (!move->is_begun) {
        const bool rapid = cnc->program->blocks[move->section.first].motion == CNC_MOTION_RAPID;
        if (!rapid)
            cnc_section_request(
                &move->section, cnc->config,
                cnc_is_set(cnc, CNC_BIT_REQ_LINEARACCEL) ? cnc_number(&cnc->cells, CNC_CELL_dwAxGLinearAccel, 0) : 0,
                cnc_is_set(cnc, CNC_BIT_REQ_PARABACCEL) ? cnc_real(&cnc->cells, CNC_CELL_rAxGParabAccel, 0) : 0);
        const enum cnc_set set = rapid ? CNC_SET_RAPID : CNC_SET_NORMAL;
        cnc_path_begin(&move->path, move->ring, move->section.length, move->section.acceleration[set], move->section.n[set]);
        move->is_begun = true;
    }
    move->is_going = true;
    return true;
}

int64_t cnc_lowest_target(const struct cnc_section *section, const struct cnc_path *path, const int64_t target[CNC_SEGMENTS_MAX])
{
    const unsigned last = cnc_section_at(section, path->length - path->left);
    int64_t lowest = CNC_SPEED_LIMIT;
    for (unsigned k = cnc_section_at(section, path->done); k <= last; k++)
        lowest = target[k] < lowest ? target[k] : lowest;
    return lowest;
}

/* The set of a hold; CNC_SETS: none, it stops at once (NM9). */
static enum cnc_set hold_set(const struct cnc *cnc, enum cnc_hold hold)
{
    const bool rapid = cnc->program->blocks[cnc->move.section.first].motion == CNC_MOTION_RAPID;
    switch (hold) {
    case CNC_HOLD_NONE:
        return rapid ? CNC_SET_RAPID : CNC_SET_NORMAL;
    case CNC_HOLD_STOP:
        return CNC_SET_RAPID;
    case CNC_HOLD_LIMIT:
        return cnc->config->is_parabolic ? CNC_SET_RAPID : CNC_SET_EMERGENCY;
    case CNC_HOLD_EMERGENCY:
        return CNC_SET_EMERGENCY;
    case CNC_HOLD_ENABLE:
        return cnc->config->is_parabolic ? CNC_SETS : CNC_SET_EMERGENCY;
    case CNC_HOLD_ERROR:
        break;
    }
    return CNC_SETS;
}

/* One T of the path under a hold (NM10). */
static void step_path(struct cnc *cnc, enum cnc_hold hold)
{
    struct cnc_move *move = &cnc->move;
    const struct cnc_section *section = &move->section;
    const enum cnc_set set = hold_set(cnc, hold);
    int64_t target[CNC_SEGMENTS_MAX];
    struct cnc_borders borders;
    cnc_find_targets(cnc, target);
    borders.count = section->count - 1u;
    for (unsigned k = 0; k < borders.count; k++)
        borders.border[k] = (struct cnc_border){section->segment[k].border, target[k + 1]};
    bool is_held = hold != CNC_HOLD_NONE;
    int64_t deceleration = 0;
    if (set == CNC_SETS)
        cnc_path_halt(&move->path, move->ring);
    else if (!cnc->config->is_parabolic)
        deceleration = is_held ? section->acceleration[set] : 0;
    else
        is_held = cnc_path_change(&move->path, move->ring, section->acceleration[set], section->n[set]) && is_held;
    if (section->count > 1)
        cnc_watch_section(cnc, hold, target, &borders);
    if (set == CNC_SETS)
        return;
    const int64_t speed = is_held ? 0 : cnc_lowest_target(section, &move->path, target);
    cnc_path_step(&move->path, move->ring, speed, deceleration, &borders);
}

void cnc_move_path(struct cnc *cnc)
{
    struct cnc_move *move = &cnc->move;
    move->v = 0;
    if (!move->is_going || cnc_path_rest(&move->path) == 0)
        return;
    step_path(cnc, cnc_find_hold(cnc));
    move->v = move->path.v;
    int64_t position[CNC_AXES];
    cnc_section_place(&move->section, move->path.done, position);
    const struct cnc_segment *now = &move->section.segment[cnc_section_at(&move->section, move->path.done)];
    for (unsigned i = 0; i < CNC_AXES; i++) {
        if (!cnc_has_axis(move->section.axes, i))
            continue;
        cnc->axis[i].position = position[i];
        if (move->v > 0 && now->way[i] != 0)
            cnc_set(cnc, CNC_BIT_SM_POxPI + i, now->way[i] < 0);
    }
    if (cnc_path_rest(&move->path) == 0) {
        cnc_set(cnc, CNC_BIT_G23ACT, false);
        cnc_put_number(&cnc->cells, CNC_CELL_TIME_DIST, 0, 0);
    }
}

/* ---- Looking ahead --------------------------------------------------------------------------------------------------- */

/* T's to the end of the section if nothing changes; INT32_MAX: it has none, or not within LOOK_STEPS_MAX. */
static int64_t time_to_end(struct cnc *cnc, const int64_t target[CNC_SEGMENTS_MAX], const struct cnc_borders *borders)
{
    struct cnc_move *move = &cnc->move;
    const struct cnc_section *section = &move->section;
    int64_t time = 0;
    move->look = move->path;
    memcpy(move->look_ring, move->ring, sizeof move->look_ring);
    for (unsigned steps = 0; cnc_path_rest(&move->look) > 0; steps++) {
        struct cnc_path *path = &move->look;
        const unsigned input = cnc_section_at(section, path->length - path->left);
        const unsigned at = cnc_section_at(section, path->done);
        const int64_t speed = cnc_lowest_target(section, path, target);
        const int64_t glided = cnc_path_glide(path, move->look_ring, speed, borders, section->segment[input].border,
                                              section->segment[at].border, INT32_MAX - time);
        if (glided == 0)
            cnc_path_step(path, move->look_ring, speed, 0, borders);
        time += glided == 0 ? 1 : glided;
        if (steps == LOOK_STEPS_MAX || time >= INT32_MAX || (speed == 0 && cnc_path_is_at_rest(path)))
            return INT32_MAX;
    }
    return time;
}

/* Is everything as it was when TIME_DIST was worked out? It is remembered for the next T. */
static bool is_as_before(struct cnc_move *move, enum cnc_hold hold, const int64_t target[CNC_SEGMENTS_MAX])
{
    bool same = move->has_look && move->look_hold == hold && move->look_acceleration == move->path.acceleration &&
                move->look_n == move->path.n;
    for (unsigned k = 0; k < move->section.count; k++) {
        same = same && move->look_target[k] == target[k];
        move->look_target[k] = target[k];
    }
    move->has_look = true;
    move->look_hold = (uint8_t)hold;
    move->look_acceleration = move->path.acceleration;
    move->look_n = move->path.n;
    return same;
}

void cnc_watch_section(struct cnc *cnc, enum cnc_hold hold, const int64_t target[CNC_SEGMENTS_MAX],
                       const struct cnc_borders *borders)
{
    const bool same = is_as_before(&cnc->move, hold, target);
    cnc_set(cnc, CNC_BIT_G23ACT, true);
    if (hold != CNC_HOLD_NONE)
        return;
    int64_t time = same ? cnc_number(&cnc->cells, CNC_CELL_TIME_DIST, 0) : time_to_end(cnc, target, borders);
    if (time < INT32_MAX)
        time--;
    cnc_put_number(&cnc->cells, CNC_CELL_TIME_DIST, 0, time);
}

/* ---- Servo ------------------------------------------------------------------------------------------------------------ */

/* Following error in whole um, rounded down (DIFCIT_X). */
static int64_t following_error(const struct cnc_axis *axis)
{
    const int64_t error = axis->position - axis->actual;
    return error >= 0 ? error / CNC_U_PER_UM : -((CNC_U_PER_UM - 1 - error) / CNC_U_PER_UM);
}

void cnc_run_servo(struct cnc *cnc)
{
    for (unsigned i = 0; i < CNC_AXES; i++) {
        const struct cnc_axis_config *config = &cnc->config->axis[i];
        struct cnc_axis *axis = &cnc->axis[i];
        if (!config->is_configured)
            continue;
        if (cnc_is_set(cnc, CNC_BIT_VAZBA_x + i))
            axis->actual += (axis->position - axis->actual) / (int64_t)config->lag;
        const int64_t error = following_error(axis);
        cnc_put_number(&cnc->cells, CNC_CELL_DIFCIT_X, i, error);
        if (config->max_lag > 0 && (error < 0 ? -error : error) > (int64_t)config->max_lag &&
            cnc_number(&cnc->cells, CNC_CELL_BZH13, 0) == 0)
            cnc_set_critical(cnc, 1);
    }
}

bool cnc_in_tolerance(const struct cnc *cnc, uint16_t axes)
{
    for (unsigned i = 0; i < CNC_AXES; i++) {
        const int64_t error = cnc->axis[i].position - cnc->axis[i].actual;
        if (cnc_has_axis(axes, i) && (error < 0 ? -error : error) > cnc->config->axis[i].max_difference)
            return false;
    }
    return true;
}
