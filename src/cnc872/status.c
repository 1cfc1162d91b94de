/* SPDX-License-Identifier: MIT */
/* status.c: cells that show what the cnc does (NS1 to NS5, NB5, NB6). */
#include "frame.h"

#define SHORT_AXES 6u /* of B_POL, B_INK, MPx */

int64_t cnc_position(const struct cnc *cnc, unsigned axis, unsigned space)
{
    const struct cnc_axis_config *config = &cnc->config->axis[axis];
    int64_t position = cnc->axis[axis].position;
    position += space >= 3 ? config->length_correction : 0;
    position += space >= 4 ? config->offset1 : 0;
    position += space >= 5 ? config->offset2 : 0;
    position -= space >= 6 ? cnc->axis[axis].position - cnc->axis[axis].actual : 0;
    return position;
}

/* In 1/8 um, rounded down. */
static int64_t eighths(int64_t position)
{
    return position >= 0 ? position / 8192 : -((8191 - position) / 8192);
}

static void put_positions(struct cnc *cnc, unsigned i)
{
    const struct cnc_axis *axis = &cnc->axis[i];
    if (i < SHORT_AXES) {
        cnc_put_number(&cnc->cells, CNC_CELL_B_POL, i, eighths(axis->block_start));
        cnc_put_number(&cnc->cells, CNC_CELL_B_INK, i, eighths(axis->position) - eighths(axis->block_start));
    }
    cnc_put_number(&cnc->cells, CNC_CELL_B_POL_EX, i, axis->block_start);
    cnc_put_number(&cnc->cells, CNC_CELL_B_INK_EX, i, axis->position - axis->block_start);
    static const enum cnc_cell space[] = {CNC_CELL_POSITION_POS1_EX, CNC_CELL_POSITION_POS2_EX, CNC_CELL_POSITION_POS3_EX,
                                          CNC_CELL_POSITION_POS4_EX, CNC_CELL_POSITION_POS5_EX};
    for (unsigned k = 0; k < sizeof space / sizeof *space; k++)
        cnc_put_number(&cnc->cells, space[k], i, cnc_position(cnc, i, k + 1));
}

/* NE2, of one axis; manual: manual moves are active. */
static bool may_move(const struct cnc *cnc, unsigned i, bool manual)
{
    const bool by_man = manual && cnc->config->manual_by_man;
    return cnc_is_set(cnc, (by_man ? CNC_BIT_MPxMAN : CNC_BIT_MPxPI) + i) && cnc_find_limit(cnc, i, 1) == CNC_LIMIT_NONE &&
           cnc_find_limit(cnc, i, -1) == CNC_LIMIT_NONE && cnc_number(&cnc->cells, CNC_CELL_BZH13, 0) == 0;
}

static void put_axes(struct cnc *cnc)
{
    const bool manual = cnc_is_set(cnc, CNC_BIT_ACK_AUTMAN);
    bool switches = false, software = false, same = true;
    for (unsigned i = 0; i < SHORT_AXES; i++)
        cnc_set(cnc, CNC_BIT_MPx + i, may_move(cnc, i, manual));
    for (unsigned i = 0; i < CNC_AXES; i++) {
        if (!cnc->config->axis[i].is_configured)
            continue;
        put_positions(cnc, i);
        switches |= cnc_is_set(cnc, CNC_BIT_KHx0 + i) || cnc_is_set(cnc, CNC_BIT_KHx1 + i);
        software |= cnc_find_limit(cnc, i, 1) == CNC_LIMIT_SOFTWARE || cnc_find_limit(cnc, i, -1) == CNC_LIMIT_SOFTWARE;
        same &= cnc->axis[i].position == cnc->axis[i].stop_position;
    }
    const bool elsewhere = cnc->machine.has_stop_position && !same;
    cnc_set(cnc, CNC_BIT_SF_LS, switches);
    cnc_set(cnc, CNC_BIT_SF_SLS, software);
    cnc_set(cnc, CNC_BIT_INPOS_STOP, !elsewhere);
    cnc_set(cnc, CNC_BIT_SF_STOPPOSCHANGED, elsewhere && cnc_is_set(cnc, CNC_BIT_PO_STOP));
}

void cnc_put_status(struct cnc *cnc)
{
    const struct cnc_machine *machine = &cnc->machine;
    const bool moves = cnc_axes_move(cnc) || cnc->move.v > 0;
    const bool passes = machine->phase == CNC_INIT || machine->phase == CNC_DONE;
    put_axes(cnc);
    cnc_put_spindle(cnc);
    const bool in_position = !moves && cnc_in_tolerance(cnc, cnc->config->axes);
    cnc_set(cnc, CNC_BIT_INPOS, in_position);
    cnc_set(cnc, CNC_BIT_SF_NOTINPOS, !in_position);
    cnc_set(cnc, CNC_BIT_SF_RUN, moves || (machine->phase != CNC_IDLE && !cnc_is_set(cnc, CNC_BIT_PO_STOP)));
    cnc_set(cnc, CNC_BIT_SF_BLOCKINPROGR, machine->phase != CNC_IDLE);
    cnc_set(cnc, CNC_BIT_SF_DELAYINPROGR, machine->phase == CNC_DELAY);
    cnc_set(cnc, CNC_BIT_SF_CONDSTOPMODE, cnc->panel.m01);
    cnc_set(cnc, CNC_BIT_SF_BLOCKBYBLOCK, cnc->panel.block_by_block);
    cnc_set(cnc, CNC_BIT_SF_INDICATIONMODE, cnc->panel.indication);
    cnc_set(cnc, CNC_BIT_SF_SIMULATIONMODE, cnc->panel.simulation);
    cnc_set(cnc, CNC_BIT_SF_HIGHSPEEDMODE, cnc->panel.high_speed);
    cnc_put_number(&cnc->cells, CNC_CELL_PLC_PASS, 0, passes && !machine->is_passed ? machine->phase : 0);
}

static void put_set(struct cnc *cnc, unsigned i, enum cnc_set set)
{
    static const enum cnc_cell acceleration[] = {CNC_CELL_dwAxNCAcceleration, CNC_CELL_dwAxNCAccelerationRT,
                                                 CNC_CELL_dwAxNCAccelerationEmergency};
    static const enum cnc_cell linear[] = {CNC_CELL_dwAxNCLinearAccel, CNC_CELL_dwAxNCLinearAccelRT,
                                           CNC_CELL_dwAxNCLinearAccelEmergency};
    static const enum cnc_cell parabolic[] = {CNC_CELL_rAxNCParabAccel, CNC_CELL_rAxNCParabAccelRT,
                                              CNC_CELL_rAxNCParabAccelEmergency};
    const struct cnc_axis_config *axis = &cnc->config->axis[i];
    cnc_put_number(&cnc->cells, acceleration[set], i, axis->acceleration[set]);
    cnc_put_number(&cnc->cells, linear[set], i, axis->linear[set]);
    cnc_put_real(&cnc->cells, parabolic[set], i, (double)((int64_t)axis->parabolic[set] * CNC_U_PER_UM) / 1e6);
}

void cnc_put_configuration(struct cnc *cnc)
{
    for (unsigned i = 0; i < CNC_AXES; i++) {
        const struct cnc_axis_config *axis = &cnc->config->axis[i];
        if (!axis->is_configured)
            continue;
        for (unsigned set = 0; set < CNC_SETS; set++)
            put_set(cnc, i, (enum cnc_set)set);
        cnc_put_number(&cnc->cells, CNC_CELL_dwAxNcFeed, i, cnc_speed_of(axis->feed));
        cnc_put_number(&cnc->cells, CNC_CELL_dwAxNcFeedRT, i, cnc_speed_of(axis->feed_rapid));
    }
}
