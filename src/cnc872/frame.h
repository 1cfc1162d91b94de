/* SPDX-License-Identifier: MIT */
/* frame.h: what the parts of a T (NT2) call of each other. */
#ifndef CNC872_FRAME_H
#define CNC872_FRAME_H

#include "cnc872.h"

/* A start (NE4). */
enum cnc_start_state { CNC_START_NONE, CNC_START_ASKED, CNC_START_WAITS /* for START_SUSPEND */ };

/* Central annulment (NB8). */
enum cnc_annulment_state { CNC_ANNULMENT_NONE, CNC_ANNULMENT_ASKED, CNC_ANNULMENT_PASSES };

static inline bool cnc_is_set(const struct cnc *cnc, unsigned place)
{
    return cnc_bit(&cnc->cells, place);
}

static inline void cnc_set(struct cnc *cnc, unsigned place, bool value)
{
    cnc_put_bit(&cnc->cells, place, value);
}

/* The lowest three digits, BCD; a byte has the lowest two of them. */
static inline int64_t cnc_bcd(int64_t number)
{
    return number / 100 % 10 << 8 | number / 10 % 10 << 4 | number % 10;
}

static inline void cnc_report_event(struct cnc *cnc, enum cnc_event event, int64_t value)
{
    if (cnc->port != NULL && cnc->port->event != NULL)
        cnc->port->event(cnc->context, event, value);
}

/* ---- The block machine: block.c, start.c --------------------------------------------------------------------------- */

/* Step 2: a start that has been asked for, with its event (NE4). */
void cnc_begin_start(struct cnc *cnc);

/* Step 3: STOPPI, STOP_REQ, STOP_EMERGENCY_REQ and the panel's STOP. */
void cnc_take_stop(struct cnc *cnc);

/* Step 3: start, phases, central annulment. */
void cnc_run_machine(struct cnc *cnc);

/* Step 4: the motion of the present block has ended, or a stop is at rest. */
void cnc_end_motion(struct cnc *cnc);

/* Step 4, last: STATUS_RESTART in the T in which PO_STOP becomes 1. */
void cnc_note_stop(struct cnc *cnc);

/* Publish the next block of the NC program (NB1). */
void cnc_publish_block(struct cnc *cnc);

/* The present block, or the pass of a reference or a central annulment, has ended. */
void cnc_end_block(struct cnc *cnc);

/* Phase INIT or DONE with its pass before it. */
void cnc_begin_phase(struct cnc *cnc, enum cnc_phase phase);

/* A block, a reference or a central annulment has been started: `mode` is CNC_BIT_AUTPI, _REFPI or _CAPI. It is neither rapid nor
 * threading until a block says so (8.2.2 to 8.2.4). */
void cnc_show_start(struct cnc *cnc, enum cnc_bit mode);

/* What comes after the motion, or in its place: DELAY or DONE. */
void cnc_begin_delay(struct cnc *cnc);

/* The start goes on once START_SUSPEND is 0: the next block is published, or the stopped one goes on (NB7). Returns whether it
 * did. */
bool cnc_finish_start(struct cnc *cnc);

/* Do the axes stand elsewhere than where the selected block begins (NQ2)? */
bool cnc_is_elsewhere(const struct cnc *cnc);

/* Line of the present block in the NC text; 0: none. */
int64_t cnc_block_line(const struct cnc *cnc);

/* The present block of the NC program; NULL: none. */
const struct cnc_nc_block *cnc_present_block(const struct cnc *cnc);

/* ---- PLC program: program.c -------------------------------------------------------------------------------------------- */

/* Step 2: the pass under way, of the PLC text and, while EXT_PLC is 1, of the program outside (NB4). */
void cnc_run_pass(struct cnc *cnc);

/* A call of a section (NP6). Returns whether it has ended; true without PLC program. */
bool cnc_call_plc(struct cnc *cnc, enum cnc_plc_section section);

/* The next call of the section begins at its beginning. */
void cnc_rewind_plc(struct cnc *cnc, enum cnc_plc_section section);

/* _ON_EVENT with PLCEVENT_START_REQ. */
void cnc_call_start_event(struct cnc *cnc);

/* ---- Motion: motion.c, hold.c, feed.c -------------------------------------------------------------------------------- */

/* The way of the present block from where the axes are, and of its section. */
void cnc_prepare_motion(struct cnc *cnc);

/* Begin, or go on with, the motion of the present block. Returns false if there is none (any more). */
bool cnc_begin_motion(struct cnc *cnc);

/* Forget the path. */
void cnc_drop_motion(struct cnc *cnc);

/* One T of the path, and of the servo loop (NS3). */
void cnc_move_path(struct cnc *cnc);
void cnc_run_servo(struct cnc *cnc);

/* Will the path go on moving, or has its average still something to give? */
bool cnc_path_moves(const struct cnc *cnc);

/* Do any axes move: path, manual moves, references, spindle axes? */
bool cnc_axes_move(const struct cnc *cnc);

/* Are the following errors of these axes within MaxDifference? */
bool cnc_in_tolerance(const struct cnc *cnc, uint16_t axes);

enum cnc_limit { CNC_LIMIT_NONE, CNC_LIMIT_SWITCH, CNC_LIMIT_SOFTWARE };

/* Is an axis held by a limit in this direction, 1 or -1 (NA4, NH4)? */
enum cnc_limit cnc_find_limit(const struct cnc *cnc, unsigned axis, int direction);

/* The strongest hold of the path (NM9). */
enum cnc_hold cnc_find_hold(const struct cnc *cnc);

/* The override of the feed as two factors of per mille (NF1). */
struct cnc_override {
    uint32_t percent, multiplier;
};
struct cnc_override cnc_feed_override(const struct cnc *cnc);

/* F times the override, u/T, rounded down once (NU4). feed: millionths of mm/min, or of mm/rev; speed: 1/1000 rev/min, 1000 with
 * mm/min. */
int64_t cnc_feed_speed(int64_t feed, struct cnc_override override, int64_t speed);

/* The same of a block with G1 or G33 as it is programmed; the override does not count with G33. */
int64_t cnc_programmed_speed(const struct cnc *cnc, const struct cnc_nc_block *block, struct cnc_override override);

/* Speeds that the cells allow in all segments of the path (NM7), u/T. */
void cnc_find_targets(const struct cnc *cnc, int64_t target[CNC_SEGMENTS_MAX]);

/* TIME_DIST and G23ACT of a section (NM8), before its step of this T. */
void cnc_watch_section(struct cnc *cnc, enum cnc_hold hold, const int64_t target[CNC_SEGMENTS_MAX],
                       const struct cnc_borders *borders);

/* The lowest target of the segments from that in which the path is to that in which the input stage is. */
int64_t cnc_lowest_target(const struct cnc_section *section, const struct cnc_path *path, const int64_t target[CNC_SEGMENTS_MAX]);

/* LIMIT_FEED_G00 or LIMIT_FEED, u/T; CNC_SPEED_LIMIT if it is not requested. */
int64_t cnc_feed_limit(const struct cnc *cnc, bool rapid);

/* ---- Single axes: manual.c, reference.c, spindle.c ------------------------------------------------------------------- */

/* Begin a motion of an axis at rest, in a direction, 1 or -1; length: u or CNC_ENDLESS. */
void cnc_begin_single(struct cnc *cnc, unsigned axis, enum cnc_single_kind kind, int direction, int64_t length);

/* PO_OSxPI while it moves; of an axis of a block, also of a stopped one, it stays 1 (NE3). */
void cnc_request_single(struct cnc *cnc, unsigned axis, bool is_requested);

/* It is over. */
void cnc_end_single(struct cnc *cnc, unsigned axis);

/* Single motions come so far from 0, in u (70 000 million km): differences of positions have 64 bits. */
#define CNC_REACH (INT64_C(1) << 62)

/* One T of it towards a target speed, FeedRT at most (NM6); by_emergency: with AccelerationEmergency. Returns the speed, 0 while
 * BZH13 is not 0 and at CNC_REACH. */
int64_t cnc_step_single(struct cnc *cnc, unsigned axis, int64_t target, bool by_emergency);

/* Does one of these axes move by itself? */
bool cnc_has_single(const struct cnc *cnc, uint16_t axes);

/* Step 4: manual moves, references, spindle axes. */
void cnc_move_manual(struct cnc *cnc);
void cnc_move_references(struct cnc *cnc);
void cnc_move_spindles(struct cnc *cnc);

/* Step 3: HOMING_REQ and HOMING_START_REQ. */
void cnc_take_references(struct cnc *cnc);

/* A stop came: moved axes run out, references end. */
void cnc_stop_manual(struct cnc *cnc, bool by_emergency);
void cnc_stop_references(struct cnc *cnc, bool by_emergency);

/* Central annulment, all axes being at rest: no reference is left. */
void cnc_drop_references(struct cnc *cnc);

/* SPI_AX_x (NF6). Nothing happens if it is not a rotary axis. */
void cnc_position_spindle(struct cnc *cnc, unsigned axis);

/* ---- Technology: m_functions.c, spindle.c ---------------------------------------------------------------------------- */

/* What a block says to the PLC program: M, S, T, H (NG1, NG2); and the bits that are over with it. */
void cnc_publish_functions(struct cnc *cnc, const struct cnc_nc_block *block);
void cnc_end_functions(struct cnc *cnc);

/* Parts of it: the gear; S. */
void cnc_publish_gear(struct cnc *cnc, const struct cnc_nc_block *block);
void cnc_publish_spindle(struct cnc *cnc, const struct cnc_nc_block *block);

/* Is S of the block within the limits of its gear (NF5)? */
bool cnc_gear_fits(const struct cnc *cnc, const struct cnc_nc_block *block);

/* Step 5: cells of the spindle. */
void cnc_put_spindle(struct cnc *cnc);

/* ---- Surroundings: panel.c ------------------------------------------------------------------------------------------- */

/* Step 1: cells of time; switches of the machine, keys. */
void cnc_put_time(struct cnc *cnc);
void cnc_drive_switches(struct cnc *cnc);

/* Step 3: DISPTOC1, DISPTOC2; REQ_BACKUP_MEM. */
void cnc_take_displays(struct cnc *cnc);
void cnc_take_backup(struct cnc *cnc);

/* ---- Cells: status.c, queue.c ----------------------------------------------------------------------------------------- */

/* Cells of the configuration, at power-up (section 8.4.6 of the source). */
void cnc_put_configuration(struct cnc *cnc);

/* Step 5. */
void cnc_put_status(struct cnc *cnc);

#endif
