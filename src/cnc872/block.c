/* SPDX-License-Identifier: MIT */
/* block.c: the block machine (NB1, NB2, NB7, NB8). */
#include "frame.h"

const struct cnc_nc_block *cnc_present_block(const struct cnc *cnc)
{
    return cnc->machine.block == CNC_NO_BLOCK ? NULL : &cnc->program->blocks[cnc->machine.block];
}

int64_t cnc_block_line(const struct cnc *cnc)
{
    const struct cnc_nc_block *block = cnc_present_block(cnc);
    return block == NULL ? 0 : block->line;
}

void cnc_begin_phase(struct cnc *cnc, enum cnc_phase phase)
{
    cnc->machine.phase = (uint8_t)phase;
    cnc_rewind_plc(cnc, phase == CNC_INIT ? CNC_PLC_BLOCK_INIT : CNC_PLC_BLOCK_DONE);
    cnc->machine.text_passed = cnc->machine.outside_passed = cnc->machine.is_passed = false;
    if (phase == CNC_INIT)
        cnc_put_number(&cnc->cells, CNC_CELL_CNT_NEXT_BLOCKS, 0, cnc_queue_length(cnc));
}

void cnc_show_start(struct cnc *cnc, enum cnc_bit mode)
{
    static const enum cnc_bit modes[] = {CNC_BIT_AUTPI, CNC_BIT_REFPI, CNC_BIT_CAPI};
    for (unsigned i = 0; i < 3; i++)
        cnc_set(cnc, modes[i], modes[i] == mode);
    cnc_set(cnc, CNC_BIT_G00PI, false);
    cnc_set(cnc, CNC_BIT_G33PI, false);
    cnc_set(cnc, CNC_BIT_PO_F, true);
    cnc_set(cnc, CNC_BIT_SF_BLOCKFINISHED, false);
}

static void set_request_bits(struct cnc *cnc, uint16_t axes, bool value)
{
    for (unsigned i = 0; i < CNC_AXES; i++)
        if (cnc_has_axis(axes, i)) {
            cnc_set(cnc, CNC_BIT_PO_OSxPI + i, value);
            cnc_set(cnc, CNC_BIT_PO_OSx + i, value);
        }
}

/* ---- The begin of a block ---------------------------------------------------------------------------------------------- */

/* The motion of the block that is being published: a path of its own, or the next segment of a section. */
static void publish_motion(struct cnc *cnc)
{
    struct cnc_machine *machine = &cnc->machine;
    struct cnc_move *move = &cnc->move;
    if (move->section.count > 0)
        move->segment = (uint8_t)(machine->block - move->section.first);
    else
        cnc_prepare_motion(cnc);
    for (unsigned i = 0; i < CNC_AXES; i++)
        cnc->axis[i].block_start = cnc->axis[i].position;
    machine->is_reached = move->section.count == 0;
    if (machine->is_reached)
        return;
    const struct cnc_segment *segment = &move->section.segment[move->segment];
    cnc_set(cnc, CNC_BIT_PO_POL, false);
    set_request_bits(cnc, segment->axes, true);
    if (!cnc_is_set(cnc, CNC_BIT_REQ_LINEARACCEL))
        cnc_put_number(&cnc->cells, CNC_CELL_dwAxGLinearAccel, 0, cnc_segment_linear(segment, cnc->config));
    if (!cnc_is_set(cnc, CNC_BIT_REQ_PARABACCEL))
        cnc_put_real(&cnc->cells, CNC_CELL_rAxGParabAccel, 0, cnc_segment_change(segment, cnc->config));
}

/* The speed of the spindle does not fit its gear: the program stops before this block (NF5). */
static void refuse_block(struct cnc *cnc, const struct cnc_nc_block *block)
{
    cnc_set(cnc, CNC_BIT_SF_STOP, true);
    cnc_report_event(cnc, CNC_EVENT_BLOCK_REFUSED, block->line);
}

void cnc_publish_block(struct cnc *cnc)
{
    struct cnc_machine *machine = &cnc->machine;
    const struct cnc_nc_block *next = &cnc->program->blocks[machine->next];
    const bool is_silent = machine->next == machine->selected && machine->technology_off;
    if (cnc->move.section.count == 0 && !is_silent && !cnc_gear_fits(cnc, next)) {
        refuse_block(cnc, next);
        return;
    }
    machine->block = machine->next++;
    const struct cnc_nc_block *block = cnc_present_block(cnc);
    const bool is_selected = machine->block == machine->selected;
    machine->is_continued = is_selected && cnc_is_elsewhere(cnc);
    cnc_begin_phase(cnc, CNC_INIT);
    cnc_show_start(cnc, CNC_BIT_AUTPI);
    cnc_set(cnc, CNC_BIT_G00PI, block->motion == CNC_MOTION_RAPID);
    cnc_set(cnc, CNC_BIT_G33PI, block->motion == CNC_MOTION_THREAD);
    cnc_end_functions(cnc);
    if (!is_selected || !machine->technology_off)
        cnc_publish_functions(cnc, block);
    const int64_t delay = cnc_nc_word(cnc->program, block, CNC_NC_DELAY);
    machine->delay = (delay + 999) / 1000;
    publish_motion(cnc);
    cnc_report_event(cnc, CNC_EVENT_BLOCK, block->line);
}

/* ---- Its end ------------------------------------------------------------------------------------------------------------ */

void cnc_begin_delay(struct cnc *cnc)
{
    if (cnc->machine.delay > 0) {
        cnc->machine.phase = CNC_DELAY;
        cnc_set(cnc, CNC_BIT_PRODLEVA, true);
    } else {
        cnc_begin_phase(cnc, CNC_DONE);
    }
}

/* Does the program stop after this block (NB2)? */
static bool stops_after(const struct cnc *cnc, uint32_t index)
{
    const struct cnc_nc_block *block = &cnc->program->blocks[index];
    return block->m[1] == 0 || (block->m[1] == 1 && cnc->panel.m01) || cnc->panel.block_by_block;
}

void cnc_end_block(struct cnc *cnc)
{
    struct cnc_machine *machine = &cnc->machine;
    const uint32_t index = machine->block;
    const bool is_inside = cnc->move.section.count > 0 && cnc->move.segment + 1u < cnc->move.section.count;
    cnc_report_event(cnc, CNC_EVENT_BLOCK_END, cnc_block_line(cnc));
    cnc_set(cnc, CNC_BIT_PO_F, false);
    cnc_set(cnc, CNC_BIT_BLOCK_RESTART, false);
    cnc_set(cnc, CNC_BIT_SF_BLOCKFINISHED, true);
    cnc_put_number(&cnc->cells, CNC_CELL_STATUS_RESTART, 0, 0);
    cnc_end_functions(cnc);
    machine->phase = CNC_IDLE;
    machine->block = CNC_NO_BLOCK;
    machine->is_reference = machine->is_continued = false;
    if (index == machine->selected)
        machine->selected = CNC_NO_BLOCK;
    if (index == CNC_NO_BLOCK)
        return;
    if (is_inside) {
        cnc_publish_block(cnc);
        return;
    }
    cnc_drop_motion(cnc);
    const uint8_t m = cnc->program->blocks[index].m[1];
    const bool is_over = m == 2 || m == 30 || index + 1 == cnc->program->block_count;
    if (is_over)
        machine->next = 0;
    if (is_over || stops_after(cnc, index))
        cnc_set(cnc, CNC_BIT_SF_STOP, true);
    else
        cnc_publish_block(cnc);
}

/* ---- A stop is at rest; motion ends ------------------------------------------------------------------------------------- */

/* The stop of a block is confirmed. */
static void confirm_stop(struct cnc *cnc)
{
    if (cnc_is_set(cnc, CNC_BIT_PO_STOP))
        return;
    cnc_set(cnc, CNC_BIT_PO_STOP, true);
    cnc_set(cnc, CNC_BIT_SF_STOP, true);
    cnc->move.is_going = false;
    cnc->machine.has_stop_position = true;
    for (unsigned i = 0; i < CNC_AXES; i++)
        cnc->axis[i].stop_position = cnc->axis[i].position;
}

void cnc_end_motion(struct cnc *cnc)
{
    struct cnc_machine *machine = &cnc->machine;
    struct cnc_move *move = &cnc->move;
    if (!move->is_going)
        return;
    const struct cnc_segment *segment = &move->section.segment[move->segment];
    if (machine->phase != CNC_MOVE || move->path.done < segment->border) {
        if (machine->is_stopped && cnc_path_is_at_rest(&move->path))
            confirm_stop(cnc);
        return;
    }
    const bool is_last = move->segment + 1u == move->section.count;
    set_request_bits(cnc, segment->axes, false);
    if (is_last && !cnc_in_tolerance(cnc, move->section.axes))
        return;
    cnc_set(cnc, CNC_BIT_PO_POL, true);
    machine->is_reached = true;
    if (is_last)
        move->is_going = false;
    cnc_begin_delay(cnc);
    if (is_last && machine->is_stopped)
        confirm_stop(cnc);
}

void cnc_note_stop(struct cnc *cnc)
{
    const bool is_stop = cnc_is_set(cnc, CNC_BIT_PO_STOP);
    if (is_stop && !cnc->machine.was_stop)
        cnc_put_number(&cnc->cells, CNC_CELL_STATUS_RESTART, 0, cnc->machine.phase);
    cnc->machine.was_stop = is_stop;
}

/* ---- Step 3 ------------------------------------------------------------------------------------------------------------- */

/* The INIT pass is over. */
static void begin_work(struct cnc *cnc)
{
    struct cnc_machine *machine = &cnc->machine;
    if (machine->is_reference) {
        machine->phase = CNC_MOVE;
        return;
    }
    if (!machine->is_reached && cnc_has_single(cnc, cnc->move.section.axes))
        return; /* a spindle axis has to come to its place first */
    if (!machine->is_reached) {
        const uint16_t axes = cnc->move.section.segment[cnc->move.segment].axes;
        if (cnc_begin_motion(cnc)) {
            set_request_bits(cnc, axes, false);
            set_request_bits(cnc, cnc->move.section.segment[cnc->move.segment].axes, true);
            machine->phase = CNC_MOVE;
            return;
        }
        set_request_bits(cnc, axes, false); /* the axes have got to the target meanwhile */
        cnc_set(cnc, CNC_BIT_PO_POL, true);
        machine->is_reached = true;
    }
    cnc_begin_delay(cnc);
}

/* The next phase of the block if its time has come. */
static void advance_block(struct cnc *cnc)
{
    struct cnc_machine *machine = &cnc->machine;
    if (machine->phase == CNC_INIT && machine->is_passed) {
        begin_work(cnc);
    } else if (machine->phase == CNC_DELAY && --machine->delay <= 0) {
        cnc_begin_phase(cnc, CNC_DONE);
        cnc_set(cnc, CNC_BIT_PRODLEVA, false);
    } else if (machine->phase == CNC_DONE && machine->is_passed) {
        cnc_end_block(cnc);
    }
}

/* Begin the passes of a central annulment, once nothing moves (NB8). */
static void begin_annulment(struct cnc *cnc)
{
    struct cnc_machine *machine = &cnc->machine;
    const bool is_passing = (machine->phase == CNC_INIT || machine->phase == CNC_DONE) && !machine->is_passed;
    machine->annulment = CNC_ANNULMENT_PASSES;
    cnc_show_start(cnc, CNC_BIT_CAPI);
    cnc_set(cnc, CNC_BIT_PO_STOP, false);
    cnc_set(cnc, CNC_BIT_PRODLEVA, false);
    cnc_set(cnc, CNC_BIT_BLOCK_RESTART, false);
    cnc_put_number(&cnc->cells, CNC_CELL_STATUS_RESTART, 0, 0);
    cnc_drop_references(cnc);
    cnc_set_critical(cnc, 0);
    cnc_end_functions(cnc);
    set_request_bits(cnc, 0xFFFF, false);
    cnc_drop_motion(cnc);
    machine->block = machine->selected = CNC_NO_BLOCK;
    machine->next = 0;
    machine->is_stopped = machine->is_reference = machine->is_continued = machine->was_stop = false;
    machine->is_reached = true;
    machine->delay = 0;
    if (!is_passing)
        cnc_begin_phase(cnc, CNC_INIT);
    cnc_report_event(cnc, CNC_EVENT_BLOCK, 0);
}

void cnc_run_machine(struct cnc *cnc)
{
    struct cnc_machine *machine = &cnc->machine;
    const bool started = cnc_finish_start(cnc);
    if (!started && !machine->is_stopped)
        advance_block(cnc);
    else if (machine->is_stopped && machine->annulment == CNC_ANNULMENT_NONE && machine->phase != CNC_MOVE &&
             !cnc_path_moves(cnc))
        confirm_stop(cnc);
    if (machine->annulment == CNC_ANNULMENT_ASKED && !cnc_axes_move(cnc)) {
        begin_annulment(cnc);
    } else if (machine->annulment == CNC_ANNULMENT_PASSES && machine->phase == CNC_IDLE) {
        machine->annulment = CNC_ANNULMENT_NONE;
        cnc_set(cnc, CNC_BIT_SF_STOP, true);
    }
}
