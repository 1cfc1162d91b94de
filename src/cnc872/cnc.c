/* SPDX-License-Identifier: MIT */
/* cnc.c: power-up, the order of a T (NT2), and what the panel asks for. */
#include <string.h>

#include "frame.h"

/* ---- Programs ----------------------------------------------------------------------------------------------------------- */

static void take_program(struct cnc *cnc, const struct cnc_nc_program *program)
{
    cnc->program = program;
    cnc->program_axes = 0;
    for (uint32_t i = 0; program != NULL && i < program->block_count; i++)
        cnc->program_axes |= program->blocks[i].axes;
    cnc->machine.next = 0;
    cnc->machine.block = cnc->machine.selected = CNC_NO_BLOCK;
    cnc_set(cnc, CNC_BIT_SF_STOP, program != NULL);
}

/* What speaks against another program or another block to begin with; CNC_OK: nothing. */
static enum cnc_result find_obstacle(const struct cnc *cnc)
{
    if (cnc->machine.phase != CNC_IDLE)
        return CNC_UNDER_WAY;
    return cnc->machine.start != CNC_START_NONE ? CNC_STARTING : CNC_OK;
}

enum cnc_result cnc_load(struct cnc *cnc, const struct cnc_nc_program *program)
{
    const enum cnc_result why = find_obstacle(cnc);
    if (why == CNC_OK)
        take_program(cnc, program);
    return why;
}

enum cnc_result cnc_select(struct cnc *cnc, uint32_t block, bool technology)
{
    struct cnc_machine *machine = &cnc->machine;
    const enum cnc_result why = find_obstacle(cnc);
    if (why != CNC_OK)
        return why;
    if (cnc->program == NULL || block >= cnc->program->block_count)
        return CNC_NO_SUCH_BLOCK;
    machine->next = machine->selected = block;
    machine->technology_off = !technology;
    machine->selected_axes = 0;
    for (uint32_t k = block; k-- > 0 && machine->selected_axes != cnc->program_axes;)
        for (unsigned i = 0; i < CNC_AXES; i++)
            if (!cnc_has_axis(machine->selected_axes, i) &&
                cnc_nc_target(cnc->program, &cnc->program->blocks[k], i, &machine->selected_start[i]))
                machine->selected_axes = (uint16_t)(machine->selected_axes | 1u << i);
    return CNC_OK;
}

bool cnc_is_elsewhere(const struct cnc *cnc)
{
    for (unsigned i = 0; i < CNC_AXES; i++)
        if (cnc_has_axis(cnc->machine.selected_axes, i) && cnc->machine.selected_start[i] != cnc->axis[i].position)
            return true;
    return false;
}

/* ---- Time --------------------------------------------------------------------------------------------------------------- */

/* What a restart keeps. */
struct kept {
    uint64_t tick, turn, beyond_queue;
    int64_t position[CNC_AXES], actual[CNC_AXES], homing;
    struct cnc_panel panel;
};

static void power_up(struct cnc *cnc, const struct cnc_setup *setup, const struct kept *kept)
{
    memset(cnc, 0, sizeof *cnc);
    cnc->config = setup->config;
    cnc->port = setup->port;
    cnc->context = setup->context;
    cnc->tick = kept->tick;
    cnc->turn = kept->turn;
    cnc->beyond_queue = kept->beyond_queue;
    cnc->panel = kept->panel;
    cnc->machine.is_reached = true;
    memset(cnc->machine.m, CNC_NC_NO_M, sizeof cnc->machine.m);
    cnc->switches = setup->switches;
    cnc->switch_count = setup->switch_count;
    cnc_clear_cells(&cnc->cells);
    for (unsigned i = 0; i < CNC_AXES; i++) {
        cnc->axis[i].position = cnc->axis[i].block_start = kept->position[i];
        cnc->axis[i].actual = kept->actual[i];
    }
    cnc_put_number(&cnc->cells, CNC_CELL_HOMING, 0, kept->homing);
    if (setup->backup != NULL)
        memcpy(cnc->cells.memory + cnc_cell_place(CNC_CELL_PLC_MEM_BACKUP), setup->backup, CNC_BACKUP_SIZE);
    cnc->plc_program = setup->plc;
    cnc->plc.no_license = setup->config->no_license;
    if (cnc->plc_program != NULL)
        cnc_begin_plc(&cnc->plc, cnc->plc_program, &cnc->cells);
    take_program(cnc, setup->program);
    cnc_put_configuration(cnc);
    cnc_put_time(cnc);
    cnc_call_plc(cnc, CNC_PLC_INIT);
    cnc_put_status(cnc);
}

void cnc_begin(struct cnc *cnc, const struct cnc_setup *setup)
{
    power_up(cnc, setup, &(struct kept){.panel = {.feed = 100, .spindle = 100}});
}

enum cnc_result cnc_restart_refusal(const struct cnc *cnc)
{
    bool moves = cnc->move.is_going || cnc->machine.phase == CNC_MOVE || cnc->machine.phase == CNC_DELAY;
    for (unsigned i = 0; i < CNC_AXES; i++)
        moves = moves || cnc->axis[i].direction != 0;
    return moves ? CNC_MOVES : CNC_OK;
}

enum cnc_result cnc_restart(struct cnc *cnc, const struct cnc_setup *setup)
{
    struct kept kept = {.tick = cnc->tick, .turn = cnc->turn, .beyond_queue = cnc->beyond_queue, .panel = cnc->panel,
                        .homing = cnc_number(&cnc->cells, CNC_CELL_HOMING, 0)};
    const enum cnc_result result = cnc_restart_refusal(cnc);
    if (result != CNC_OK)
        return result;
    for (unsigned i = 0; i < CNC_AXES; i++) {
        kept.position[i] = cnc->axis[i].position;
        kept.actual[i] = cnc->axis[i].actual;
    }
    power_up(cnc, setup, &kept);
    return CNC_OK;
}

void cnc_tick(struct cnc *cnc)
{
    cnc->turn++;
    cnc->tick = cnc->turn * CNC_TICKS_PER_T;
    /* from outside */
    cnc_drive_switches(cnc);
    cnc_put_time(cnc);
    /* PLC */
    cnc->reported = 0;
    cnc_begin_start(cnc);
    cnc_run_pass(cnc);
    cnc_call_plc(cnc, CNC_PLC_MAIN);
    /* requests and block machine */
    cnc_take_stop(cnc);
    cnc_take_references(cnc);
    cnc_take_backup(cnc);
    cnc_take_displays(cnc);
    cnc_run_machine(cnc);
    /* motion */
    cnc_move_path(cnc);
    if (!cnc->move.is_going) {
        cnc_move_manual(cnc);
        cnc_move_references(cnc);
    }
    cnc_move_spindles(cnc);
    cnc_run_servo(cnc);
    cnc_end_motion(cnc);
    cnc_note_stop(cnc);
    /* status */
    cnc_put_status(cnc);
}

void cnc_advance(struct cnc *cnc, uint64_t ticks)
{
    const uint64_t end = cnc->tick + ticks;
    while (cnc->turn < end / CNC_TICKS_PER_T)
        cnc_tick(cnc);
    cnc->tick = end;
}

/* ---- Requests ----------------------------------------------------------------------------------------------------------- */

void cnc_set_critical(struct cnc *cnc, uint8_t number)
{
    if (number != 0 && number != cnc_number(&cnc->cells, CNC_CELL_BZH13, 0))
        cnc_report_event(cnc, CNC_EVENT_CRITICAL, number);
    cnc_put_number(&cnc->cells, CNC_CELL_BZH13, 0, number);
}

const char *cnc_result_text(enum cnc_result result)
{
    static const char *const text[CNC_RESULTS] = {
        [CNC_OK] = "done",
        [CNC_NO_PROGRAM] = "no NC program is loaded",
        [CNC_UNDER_WAY] = "a block is under way",
        [CNC_IN_REFERENCE] = "a reference is under way: PO_F is 1 until it has ended",
        [CNC_MANUAL] = "manual moves are active",
        [CNC_CRITICAL] = "there is a critical error (BZH13)",
        [CNC_NO_REFERENCE] = "an axis of the program needs a reference",
        [CNC_STOPPI] = "STOPPI is 1",
        [CNC_DISABLED] = "START_DISABLE is 1",
        [CNC_NO_SUCH_BLOCK] = "the NC program has no such block",
        [CNC_NO_AXIS] = "the configuration has no such axis",
        [CNC_MOVES] = "an axis moves, or a block is in its motion or delay: stop it and RESET",
        [CNC_STARTING] = "a START is under way",
        [CNC_STOPPED] = "a stop came before the start was done",
    };
    return text[result];
}
