/* SPDX-License-Identifier: MIT */
/* cnc872.h: the CNC system of the CNC872's interface to a PLC program, as plain data.
 *
 * No heap, no clock, no operating system, no globals; one call at a time for a cnc, any number of them in a process. Copying a
 * struct cnc is a snapshot, copying it back is a restore: configuration, NC program, PLC code and port lie outside and are kept
 * by address.
 *
 *     cnc_begin(&cnc, &(struct cnc_setup){.config = &config, .program = &program, .port = &port});    // power-up
 *     cnc_start(&cnc);                             // the panel's START
 *     cnc_tick(&cnc);                              // one T, 1 ms
 *     if (cnc_bit(&cnc.cells, CNC_BIT_PO_F)) ...
 *
 * Everything from outside, a cell written (cnc_put_bit, cnc_put_number) or a request, acts in the next T. Reading the fields
 * below is allowed at any time; only functions change them, `panel` apart. Positions are in u (2^-16 um, of rotary axes 2^-16 of
 * 1/1000 degree), speeds in u/T. Clauses in brackets refer to docs/CNC872.md. */
#ifndef CNC872_CNC872_H
#define CNC872_CNC872_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "backup.h"
#include "cells.h"
#include "config.h"
#include "nc.h"
#include "operand.h"
#include "path.h"
#include "plc.h"
#include "section.h"
#include "single.h"

#define CNC_TICKS_PER_T 1000u /* of 1 us (NT1) */
#define CNC_PERCENT_MAX 200u /* of the pots %F and %S */
#define CNC_GEAR_SPEED_STANDARD 4000000 /* 1/1000 rev/min, of a gear without configuration */
#define CNC_DISPLAYS 2u       /* DISPTOC1, DISPTOC2 (NO2) */
#define CNC_DISPLAY_LINES 8u
#define CNC_DISPLAY_COLUMNS 16u
#define CNC_BACKUP_PAUSE 1000u /* T's after a save that failed, until the next one */
#define CNC_QUEUE_MAX 15u     /* blocks behind the present one (NQ1) */
#define CNC_NO_BLOCK UINT32_MAX

/* Phases of a block (NB1): the values of STATUS_RESTART. */
enum cnc_phase { CNC_IDLE, CNC_INIT, CNC_MOVE, CNC_DELAY, CNC_DONE };

/* What holds a motion, the weakest first (NM9). */
enum cnc_hold { CNC_HOLD_NONE, CNC_HOLD_STOP, CNC_HOLD_LIMIT, CNC_HOLD_EMERGENCY, CNC_HOLD_ENABLE, CNC_HOLD_ERROR };

/* What a request answers; cnc_result_text() has the words. Events and digests have their numbers: new ones come last. */
enum cnc_result {
    CNC_OK,
    CNC_NO_PROGRAM,   /* no NC program is loaded */
    CNC_UNDER_WAY,    /* a block is under way, or a stop still decelerates */
    CNC_MANUAL,       /* manual moves are active */
    CNC_CRITICAL,     /* BZH13 is not 0 */
    CNC_NO_REFERENCE, /* an axis of the program needs a reference */
    CNC_STOPPI,       /* STOPPI is still 1 */
    CNC_DISABLED,     /* START_DISABLE is 1 */
    CNC_NO_SUCH_BLOCK,
    CNC_NO_AXIS,      /* the configuration has no such axis */
    CNC_STOPPED,      /* a stop came while START_SUSPEND held the start back */
    CNC_MOVES,        /* an axis moves, or a block is in its motion or delay */
    CNC_STARTING,     /* a START is under way */
    CNC_IN_REFERENCE, /* a reference is under way, its DONE pass with it */
    CNC_RESULTS
};

/* What a cnc reports. */
enum cnc_event {
    CNC_EVENT_START_REFUSED, /* value: enum cnc_result (NE4) */
    CNC_EVENT_BLOCK,         /* a block is published; value: its line in the NC text, 0: a reference or central annulment */
    CNC_EVENT_BLOCK_END,     /* value: the same */
    CNC_EVENT_SHORT_STOPPI,  /* value: T's that STOPPI was 1, fewer than 200 (NB3) */
    CNC_EVENT_BEYOND_QUEUE,  /* a BLK beyond the queue has been read; value: n (NQ1) */
    CNC_EVENT_PLC_ERROR,     /* ESET; value: PLC_ERROR (NP7) */
    CNC_EVENT_PLC_DIVISION,  /* division by 0; value: line of the PLC text */
    CNC_EVENT_PLC_FAULT,     /* the PLC program has halted; value: line of the PLC text (NP8) */
    CNC_EVENT_CRITICAL,      /* BZH13 has become this value (NS5) */
    CNC_EVENT_BLOCK_REFUSED, /* S is outside of the limits of the gear (NF5); value: line of the block */
    CNC_EVENT_REFERENCE_DONE,   /* value: the axis (NH2) */
    CNC_EVENT_REFERENCE_FAILED, /* value: the axis; it has ended, or was refused */
    CNC_EVENT_SAVED,         /* the backup memory (NO3) */
    CNC_EVENT_NOT_SAVED,     /* the backup memory could not be saved; it is tried again after CNC_BACKUP_PAUSE */
    CNC_EVENTS
};

/* Where events and the backup memory go: during cnc_tick() and requests, which must not be called from there. Each may be
 * NULL. */
struct cnc_port {
    void (*event)(void *context, enum cnc_event event, int64_t value);
    /* Save the backup memory (NO3). Returns whether it is saved. NULL: there is no file, a request is done at once. */
    bool (*save_backup)(void *context, const uint8_t *bytes, size_t size);
};

/* A switch of the machine: a bit that is 1 while POS6 of an axis is in a range, in step 1 of every T (NJ4). */
struct cnc_switch {
    uint16_t place; /* of the bit */
    uint8_t axis;
    bool has_at_least, has_at_most;
    int64_t at_least, at_most; /* u */
};

/* The switches, keys and pots of the panel: to be written at any time, they act in the next T. */
struct cnc_panel {
    uint16_t feed, spindle;         /* pots in percent, 0 ... 200; 100 at power-up */
    uint16_t jog_plus, jog_minus;   /* jog keys, a bit an axis */
    uint16_t key[4];                /* PTLTOC_P1, _P1_2, _P2, _P2_2 */
    bool manual;                    /* mode: manual, else AUT */
    bool rapid, hand;               /* rapid key; the jog keys are those of a hand-wheel panel */
    bool block_by_block, m01;
    bool indication, simulation, high_speed; /* shown, without effect */
};

struct cnc_axis {
    int64_t position, actual; /* commanded and actual, POS0 */
    int64_t block_start;      /* position at the start of the present block (B_POL_EX) */
    int64_t stop_position;    /* where the last stop left it */
    struct cnc_path path;     /* of a motion of its own: manual, reference, spindle axis */
    int8_t direction;         /* of that motion, 1 or -1; 0: there is none */
    uint8_t kind;             /* of that motion, enum cnc_single_kind */
    struct cnc_reference reference;
};

/* The block machine (section 10). */
struct cnc_machine {
    uint32_t block, next;      /* index of the present block, or CNC_NO_BLOCK; of the next one */
    uint32_t selected;         /* chosen by cnc_select(), or CNC_NO_BLOCK */
    uint8_t phase;             /* enum cnc_phase */
    bool technology_off;       /* of the selected block */
    bool is_reference;         /* the block is a reference (NH2) */
    bool text_passed, outside_passed; /* of the pass under way: the PLC text, and the program outside (NB4) */
    bool is_passed;            /* both */
    bool is_reached;           /* the present block has no motion before it */
    bool is_continued;         /* BLK[0].Cont */
    bool is_stopped;           /* by STOP or STOP EMERGENCY, also while it still decelerates */
    uint8_t stop;              /* enum cnc_hold, the kind of that stop */
    uint8_t start;             /* enum cnc_start_state */
    uint8_t annulment;         /* enum cnc_annulment_state (NB8) */
    bool stop_requested;       /* by the panel, to be taken in the next T */
    bool was_stoppi, was_stop; /* STOPPI, PO_STOP in the last T */
    uint16_t stoppi_turns;     /* T's since its rising edge, 200 at most */
    bool has_stop_position;
    bool override_cancelled;   /* M48 */
    uint8_t m[CNC_M_GROUPS + 1]; /* function in force of each group, or CNC_NC_NO_M */
    int64_t delay;             /* T's left */
    int64_t selected_start[CNC_AXES]; /* where the selected block begins, u, of the axes: */
    uint16_t selected_axes;
};

/* Motion of the path (section 6). */
struct cnc_move {
    struct cnc_section section;  /* count 0: none */
    struct cnc_path path;
    int64_t ring[CNC_AVERAGE_MAX];
    uint8_t segment;             /* of the present block */
    bool is_begun, is_going;     /* the path has been begun; moves, or would but for a hold */
    int64_t v;                   /* u/T of this T */
    /* What TIME_DIST was worked out for. */
    struct cnc_path look;
    int64_t look_ring[CNC_AVERAGE_MAX];
    int64_t look_target[CNC_SEGMENTS_MAX], look_acceleration;
    uint16_t look_n;
    uint8_t look_hold;
    bool has_look;
};

/* The spindle (NF2 to NF4): what is programmed, in millionths. */
struct cnc_spindle {
    int64_t speed, limit;  /* the last S of G97, L: rev/min; 0: none */
    int64_t cutting_speed; /* the last S of G96, m/min; 0: none */
    bool constant_cut;     /* G96 */
};

/* What the display of a hand-wheel panel shows (NO2); a place that nothing was written to is 0. */
struct cnc_display {
    uint8_t text[CNC_DISPLAY_LINES][CNC_DISPLAY_COLUMNS];
    uint8_t size, inverse;
};

struct cnc {
    const struct cnc_config *config;
    const struct cnc_nc_program *program;
    const struct cnc_plc_program *plc_program;
    const struct cnc_port *port;
    void *context;
    uint64_t tick;          /* us since power-up */
    uint64_t turn;          /* the last T that has been done; 0: none yet */
    uint16_t program_axes;  /* that the NC program names */
    uint64_t beyond_queue;  /* how often a BLK beyond the queue has been read (NQ1) */
    uint32_t reported;      /* bits of the events that come once a T at most, of this T */
    struct cnc_cells cells;
    struct cnc_plc plc;
    struct cnc_panel panel;
    struct cnc_axis axis[CNC_AXES];
    struct cnc_machine machine;
    struct cnc_move move;
    struct cnc_spindle spindle;
    struct cnc_display display[CNC_DISPLAYS];
    const struct cnc_switch *switches;
    uint16_t switch_count;
    uint16_t spindle_asked;                     /* axes that SPI_AX_x has asked for (NF6) */
    uint16_t manual_stopped, manual_emergency;  /* axes that a stop has stopped in a manual move; by STOP EMERGENCY */
    uint16_t backup_pause;                      /* T's until saving is tried again */
};

/* What a cnc is begun with; all of it stays the caller's. */
struct cnc_setup {
    const struct cnc_config *config;
    const struct cnc_nc_program *program; /* NULL: none */
    const struct cnc_plc_program *plc;    /* NULL: none */
    const struct cnc_port *port;          /* NULL: none */
    const struct cnc_switch *switches;    /* of the machine */
    uint16_t switch_count;
    const uint8_t *backup;                /* CNC_BACKUP_SIZE bytes of PLC_MEM_BACKUP; NULL: all 0. They are copied */
    void *context;
};

/* Power-up (NT3). */
void cnc_begin(struct cnc *cnc, const struct cnc_setup *setup);

/* Power-up again, with another PLC program or other switches; T's count on. Positions, HOMING and the panel stay as they are, all
 * else is as after cnc_begin(). A block that waits for a pass of the PLC program is over; CNC_MOVES: nothing is changed. */
enum cnc_result cnc_restart(struct cnc *cnc, const struct cnc_setup *setup);

/* What speaks against a restart now; CNC_OK: nothing. */
enum cnc_result cnc_restart_refusal(const struct cnc *cnc);

/* One T (NT2). */
void cnc_tick(struct cnc *cnc);

/* Advance by ticks of 1 us; the T's are the ticks 1000, 2000, ... (NT1). */
void cnc_advance(struct cnc *cnc, uint64_t ticks);

/* Load another NC program, NULL: none; it begins at its first block. CNC_UNDER_WAY, CNC_STARTING: a block or a START is under
 * way, nothing is changed. The old program is no longer used once this is done. */
enum cnc_result cnc_load(struct cnc *cnc, const struct cnc_nc_program *program);

/* The panel's START (NE4): begins the program, its next block, or goes on with a stopped one. What speaks against it now is the
 * answer, with CNC_EVENT_START_REFUSED; what speaks against it in the next T is an event alone. */
enum cnc_result cnc_start(struct cnc *cnc);

/* What speaks against a START now; CNC_OK: nothing. */
enum cnc_result cnc_start_refusal(const struct cnc *cnc);

/* The panel's STOP (NB3). */
void cnc_stop(struct cnc *cnc);

/* The panel's RESET: central annulment (NB8). */
void cnc_reset(struct cnc *cnc);

/* Choose the block at which the next START begins (NQ2), by index from 0; technology: publish its M, S, T, H. */
enum cnc_result cnc_select(struct cnc *cnc, uint32_t block, bool technology);

/* The panel's key `home` of an axis (NH3). */
enum cnc_result cnc_home(struct cnc *cnc, unsigned axis);

/* The bytes of PLC_MEM_BACKUP, to be saved at a regular end (NO3). */
const uint8_t *cnc_backup(const struct cnc *cnc);

/* A critical error of the real time (NS5): BZH13. 0: none. */
void cnc_set_critical(struct cnc *cnc, uint8_t number);

/* Words of a result: "a block is under way". */
const char *cnc_result_text(enum cnc_result result);

/* Position of an axis in the space POS0 ... POS6 (NS1); space 0 ... 6. */
int64_t cnc_position(const struct cnc *cnc, unsigned axis, unsigned space);

/* Blocks behind the present one that a PLC program may look at: 0 ... CNC_QUEUE_MAX (NQ1). */
unsigned cnc_queue_length(const struct cnc *cnc);

/* A field of BLK[n], 0 beyond the queue: bits and whole numbers, or REAL, by the field's type. index: below the field's count. */
int64_t cnc_queue_number(const struct cnc *cnc, unsigned n, enum cnc_queue_field field, unsigned index);
double cnc_queue_real(const struct cnc *cnc, unsigned n, enum cnc_queue_field field, unsigned index);

/* Is there a BLK[n]? The caller reports CNC_EVENT_BEYOND_QUEUE if not. */
bool cnc_queue_has(const struct cnc *cnc, unsigned n);

#endif
