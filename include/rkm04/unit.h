/* SPDX-License-Identifier: MIT */
/* rkm04/unit.h: one virtual RKM04, the unit for four stepper motors.
 *
 * Purpose: a firmware-faithful RKM04 as plain data. Bytes of the line and inputs come in, time comes in as an argument,
 * answers, pulses and outputs come out. No heap, no clock, no operating system, no globals; one call at a time for a unit,
 * any number of units in a process. Copying a struct rkm04_unit is a snapshot, copying it back is a restore.
 *
 *     static struct rkm04_unit unit;
 *     rkm04_init(&unit, &config, &port, context);      // power-up: flash slots are loaded and start
 *     rkm04_receive(&unit, bytes, n);                  // a request came in at this tick
 *     rkm04_advance(&unit, 1000);                      // one millisecond: pulses through port.steps or port.step
 *     n = rkm04_send(&unit, buffer, sizeof buffer);    // the answer
 *
 * Clauses in brackets refer to docs/SPEC.md. */
#ifndef RKM04_UNIT_H
#define RKM04_UNIT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <rkm04/limits.h>
#include <rkm04/link.h>
#include <rkm04/motion.h>
#include <rkm04/readings.h>
#include <rkm04/text.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Errors ------------------------------------------------------------------------------------------------------- */

/* Why a program stopped; one latch a motor, the reason stays until `\` (C3, C7, E1; reading `fault-exit`). */
enum rkm04_fault {
    RKM04_FAULT_NONE,
    RKM04_FAULT_NO_LABEL,   /* jump or call to a label that is not in memory (C7, reading `label`) */
    RKM04_FAULT_LOOP_LEVELS, /* a 9th loop level (C7) */
    RKM04_FAULT_NO_LOOP,    /* E without a loop (C7) */
    RKM04_FAULT_CALL_LEVELS, /* a 7th call level (C7) */
    RKM04_FAULT_NO_CALL,    /* . without a call (C7) */
    RKM04_FAULT_OVERWRITTEN, /* loop start or return place has been overwritten (C10) */
    RKM04_FAULT_MOTION      /* the motion could not be computed: the LED blinks (E1) */
};

/* What a motor has in flash (U5): as power-up found it, until a program is stored. */
enum rkm04_slot {
    RKM04_SLOT_EMPTY,
    RKM04_SLOT_LOADED,    /* the program that power-up has loaded */
    RKM04_SLOT_UNTRUSTED, /* something that is no whole program: counts as empty */
    RKM04_SLOT_STORED     /* a program that was stored since power-up */
};

/* ---- Port --------------------------------------------------------------------------------------------------------- */

enum rkm04_led { RKM04_LED_OFF, RKM04_LED_ON, RKM04_LED_BLINK /* 0.5 s on, 0.5 s off, begins on */ };

/* Things worth tracing, besides steps and outputs. */
enum rkm04_event {
    RKM04_EVENT_MOTION,   /* value 1: a motion begins (or continues after a hold), 0: it has ended */
    RKM04_EVENT_COMMAND,  /* value: place 1..700 of the command being executed; 0: the motor went idle or ended */
    RKM04_EVENT_LED,      /* value: enum rkm04_led */
    RKM04_EVENT_VARIABLE, /* motor 0; value: all 16 variables, VAR 80 in bit 0 */
    RKM04_EVENT_FAULT,    /* value: enum rkm04_fault */
    RKM04_EVENT_POSITION  /* value: counter, as two's complement, that no pulse led to: set (C100, =), or at the end of a motion
                             under T41 */
};

/* What a unit asks of its surroundings. All are called from within rkm04_init, _receive, _send or _advance. The calls about one
 * motor come in the order of time; those about two motors only from slot to slot: sort by tick to merge them. A pointer may be
 * NULL: then it is not reported (flash: stores fail, slots are empty). `motor` is 1..4, `tick` the tick of the happening.
 * None may call back into the unit. */
struct rkm04_port {
    /* A step pulse begins (10 us wide, R7). position: of the counter after it. Not called in simulation mode (T41). Must be
     * quick: up to 16 000 times a second and motor. */
    void (*step)(void *context, uint64_t tick, unsigned motor, int32_t position);
    /* The same for `count` >= 1 pulses of one motor at once, at tick[0] to tick[count - 1]. position: of the counter after the
     * first; each further one counts it up (forward) or down. Called instead of `step` where both are set; costs a third. The
     * ticks are valid during the call. */
    void (*steps)(void *context, unsigned motor, const uint64_t *tick, size_t count, int32_t position, bool forward);
    /* The direction output changes, at least 20 us before the first pulse. forward = output at 1. */
    void (*direction)(void *context, uint64_t tick, unsigned motor, bool forward);
    /* The outputs DO change; bit 0 is DO 01. All 0 in simulation mode. */
    void (*outputs)(void *context, uint64_t tick, uint8_t mask);
    /* Anything of enum rkm04_event. For traces and LEDs. */
    void (*event)(void *context, uint64_t tick, unsigned motor, enum rkm04_event what, uint32_t value);
    /* Flash, blocks 0..RKM04_FLASH_BLOCKS-1 of RKM04_FLASH_BLOCK_SIZE bytes. Offsets and lengths of programs are multiples of
     * 8; a byte is programmed once after an erase, erased bytes read FF. May block. Each returns 0, or another value if it
     * failed. */
    int (*flash_read)(void *context, unsigned block, unsigned offset, void *data, unsigned length);
    int (*flash_erase)(void *context, unsigned block);
    int (*flash_program)(void *context, unsigned block, unsigned offset, const void *data, unsigned length);
};

/* ---- Configuration ------------------------------------------------------------------------------------------------ */

struct rkm04_config {
    uint8_t node;                        /* DNode 1..16, switch S1 (U4) */
    struct rkm04_readings readings;      /* all 0: as specified */
    const struct rkm04_framing *framing; /* NULL: rkm04_hdlc */
    const char *version_text;            /* up to 255 characters, must stay valid; NULL: RKM04_VERSION_TEXT */
};

/* ---- State (read through the calls below) ------------------------------------------------------------------------- */

/* The tape (C2, C10). A command's number counts from 0 since the last `\`; its place in memory is number % 700. */
struct rkm04_program {
    uint64_t written; /* number of the next command to arrive */
    uint64_t closed;  /* number of the last `]`, plus 1; 0 = none */
    uint16_t label[RKM04_LABELS]; /* place of the label written last, plus 1; 0 = not in memory (C8) */
    uint32_t argument[RKM04_PROGRAM_MAX];
    uint8_t op[RKM04_PROGRAM_MAX];
};

struct rkm04_loop {
    uint64_t start; /* number of its L */
    uint8_t left;   /* passes left, the present one included */
    uint8_t level;  /* call level it was opened in */
};

enum rkm04_state {
    RKM04_IDLE,   /* nothing to execute */
    RKM04_READY,  /* executes a command in the first slot at or after `due` */
    RKM04_MOVING, /* in a motion or its stop ramp */
    RKM04_DWELL,  /* W, until `due`; also a motion that is being planned (reading `planning`) */
    RKM04_WAIT,   /* O, Z; J, I, ' to a label that has not arrived */
    RKM04_BLOCK,  /* [ */
    RKM04_HELD,   /* after K */
    RKM04_ENDED,  /* by X */
    RKM04_FAULTY  /* see `fault` */
};

/* What the end of a motion leads to. */
enum rkm04_after {
    RKM04_AFTER_GO_ON,
    RKM04_AFTER_HOLD_REST, /* K: hold with the rest of the motion to do */
    RKM04_AFTER_HOLD_NEXT, /* K on the ramp of M or N: hold before the next command */
    RKM04_AFTER_END        /* X */
};

struct rkm04_motor {
    /* First what is used all over: small offsets make small code. */
    uint64_t next;       /* number of the next command */
    uint64_t number;     /* number of the command being executed */
    struct rkm04_command command;
    uint64_t due;        /* READY, DWELL: tick from which it continues */
    uint64_t fresh;      /* number of the first command stored since K, X or a fault, not begun; RKM04_NEVER: none (C3) */
    uint64_t wake;       /* slot in which its turn has something to do; RKM04_NEVER: none */
    uint64_t last_pulse; /* tick of the last pulse */
    uint64_t blink_from; /* tick from which the LED blinks */

    uint8_t state;       /* enum rkm04_state */
    uint8_t held;        /* HELD: the state to go back to */
    uint8_t after;       /* enum rkm04_after */
    uint8_t fault;       /* enum rkm04_fault */
    uint8_t led;         /* enum rkm04_led */
    bool resume;         /* C75 came: continue as soon as the motor may */
    bool hold_fresh;     /* K came after the commands at `fresh`: hold before them */
    bool pin_forward;    /* the direction output */
    uint8_t slot;        /* enum rkm04_slot: what is in flash */

    /* Requests waiting for the next slot, in order of arrival (K2, C3, C4). */
    uint8_t pendings;
    char pending[4];         /* 'K' and 'C' (C75) */
    uint16_t change_speed;   /* C4: new speed; 0 = none. It came before all of the pendings */
    uint64_t change_due;     /* tick from which it may act */

    uint32_t count;      /* F, B, G: steps of the next R */
    int32_t position;    /* counter (R8) */
    uint16_t start_speed, speed, acceleration; /* S, V, A */
    bool forward;        /* direction of the next R */

    uint8_t functions;   /* T51-58: bit 0 is 51 */
    bool keep;           /* T40 */
    uint8_t guard_m, guard_n, guard_x; /* input 1..8; 0 = not armed */

    uint8_t segments;    /* entered in the Y table; more than RKM04_SEGMENTS_MAX: too many */
    bool segments_bad;   /* a segment without steps or two directions (E1) */
    bool segments_forward;
    uint8_t segments_marks; /* T51-58 on when the table's first Y came (C12) */
    struct rkm04_segment segment[RKM04_SEGMENTS_MAX]; /* the Y table */

    uint8_t loops, calls;
    uint64_t call[RKM04_CALL_LEVELS]; /* number of the command to return to */
    struct rkm04_loop loop[RKM04_LOOP_LEVELS];

    struct rkm04_motion motion;
    struct rkm04_program program;
};

/* The answer going out. Its content is that of the tick of the request, whatever happens meanwhile. */
struct rkm04_answer {
    uint8_t kind;        /* of prt.c; 0 = none */
    uint8_t motor;       /* 1..4 */
    uint8_t to;          /* asker's node */
    uint8_t phase;       /* begin, body, end */
    uint16_t at;         /* next item of the body: byte, command or point */
    uint8_t head, head_at; /* bytes in `byte` that precede the body, and how many of them are out */
    uint8_t points;
    uint8_t chunk_at, chunk_length; /* within `chunk` */
    uint8_t byte[64];
    uint8_t chunk[RKM04_COMMAND_TEXT_MAX + 16];
    struct {
        uint32_t step;
        uint16_t speed;
    } point[RKM04_BREAKS_MAX + 2];
    uint8_t out[2 * RKM04_FRAME_EDGE_MAX]; /* encoded, not yet sent */
    uint8_t out_at, out_length;
};

/* Line counters. */
struct rkm04_counters {
    uint32_t requests;     /* addressed to this unit and taken, broadcasts included */
    uint32_t answers;      /* sent to the end */
    uint32_t others;       /* whole frames for other nodes, or answers of others */
    uint32_t dropped;      /* frames dropped by the framing: bad check, malformed, too long */
};

struct rkm04_unit {
    /* First what is used all over: small offsets make small code. */
    struct rkm04_config config;
    const struct rkm04_port *port;
    void *context;
    uint64_t now;        /* first tick not yet done */
    uint16_t variables;  /* VAR 80 in bit 0 */
    uint16_t busy;       /* slots until commands are executed and answers sent again (reading `store-time`) */
    uint8_t inputs, outputs; /* DI as they are, the register DO */
    uint8_t seen;        /* DI as they count in the slot done last */
    uint8_t differs[RKM04_INPUTS]; /* slots in a row in which an input was not as it counts (reading `input-filter`) */
    bool simulation;     /* T41 */
    bool touched;        /* something came in or VAR changed: every motor has its turn in the next slot */
    bool waiting;        /* a request is in `message` until the answer has gone (P10) */

    struct rkm04_receiver receiver;
    struct rkm04_sender sender;
    struct rkm04_answer answer;
    struct rkm04_counters counters;
    struct rkm04_motor motor[RKM04_MOTORS];
    uint8_t message[RKM04_MESSAGE_MAX];
};

/* ---- Calls -------------------------------------------------------------------------------------------------------- */

/* Power-up or reset at tick 0 (U5, U8): clears everything, then loads the flash slots, which start at the first slot.
 * config, port: copied / kept by address; port must stay valid, context is handed to it. For a reset in the middle of
 * things call it again. Returns nothing: what was found in flash is in rkm04_motor_state.slot. */
void rkm04_init(struct rkm04_unit *unit, const struct rkm04_config *config, const struct rkm04_port *port, void *context);

/* The first tick that is not yet done. */
uint64_t rkm04_now(const struct rkm04_unit *unit);

/* Bytes arrive from the line at the present tick (K4). Requests act at once; an answer waits for rkm04_send.
 * Returns how many bytes were taken: fewer than `length` when a request is complete while the answer before is still
 * going out (P10): offer the rest again once rkm04_send has emptied it. A port that cannot wait counts them as lost. */
size_t rkm04_receive(struct rkm04_unit *unit, const uint8_t *bytes, size_t length);

/* Fetch up to `room` bytes of the answer for the line. Returns their number; 0: nothing to send now. */
size_t rkm04_send(struct rkm04_unit *unit, uint8_t *bytes, size_t room);

/* Is there anything to send now? */
bool rkm04_sending(const struct rkm04_unit *unit);

/* Set the inputs from the present tick on; bit 0 is DI 01 (U2). */
void rkm04_set_inputs(struct rkm04_unit *unit, uint8_t mask);

/* Do the ticks now .. now + ticks - 1 (K2, K3). Skips over ticks in which nothing is due. */
void rkm04_advance(struct rkm04_unit *unit, uint64_t ticks);

/* The earliest tick, >= now, in which something is due if nothing comes in from outside; RKM04_NEVER if nothing ever is.
 * Doing nothing until then and advancing past it is the same as advancing all along. */
uint64_t rkm04_next_event(const struct rkm04_unit *unit);

/* The same, but pulses do not count while they are not reported (no `step` and `steps` in the port, or T41): up to then nothing
 * is reported, and only counters change. */
uint64_t rkm04_next_report(const struct rkm04_unit *unit);

/* What can be seen of a motor. */
struct rkm04_motor_state {
    int32_t position;  /* counter */
    uint32_t steps;    /* done in the present motion (P9) */
    uint32_t speed;    /* present speed, steps/s, rounded down; 0 when not moving */
    uint16_t index;    /* place 1..700 of the command being executed; 0 idle (P9) */
    uint16_t commands; /* in memory */
    enum rkm04_state state;
    enum rkm04_fault fault;
    enum rkm04_led led;
    bool lit;          /* is the LED bright at this tick? */
    bool stopping;     /* on a stop ramp */
    bool forward;      /* direction output */
    enum rkm04_slot slot;
};

/* Read the state of motor 1..4. Returns false if there is no such motor. */
bool rkm04_motor_state(const struct rkm04_unit *unit, unsigned motor, struct rkm04_motor_state *state);

uint8_t rkm04_inputs(const struct rkm04_unit *unit);
uint8_t rkm04_outputs(const struct rkm04_unit *unit);   /* as on the terminals: 0 in simulation mode (C11) */
uint16_t rkm04_variables(const struct rkm04_unit *unit); /* VAR 80 in bit 0 */

/* Line counters since power-up. */
struct rkm04_counters rkm04_counters(const struct rkm04_unit *unit);

/* The same as message 2 (Set Command) without a line: store a text for motor '0'..'4' at the present tick. For programs
 * run without a host. Must not be called while an answer is going out on the line. Returns the flag 0..3 of P1 and, with 1
 * and 2, the character in *character (may be NULL). */
int rkm04_set_command(struct rkm04_unit *unit, char motor, const void *text, size_t length, uint8_t *character);

/* Any message, without framing, as if from node 0 at the present tick. `answer` receives up to `room` bytes of what the
 * unit answers, at once, Store Flash too. Returns the length of the whole answer (which may be more than `room`); 0: none.
 * Must not be called while an answer is going out on the line. */
size_t rkm04_exchange(struct rkm04_unit *unit, const uint8_t *message, size_t length, uint8_t *answer, size_t room);

/* Names for people and traces: "idle", "no_label", "off", … Never NULL. */
const char *rkm04_state_name(enum rkm04_state state);
const char *rkm04_fault_name(enum rkm04_fault fault);
const char *rkm04_led_name(enum rkm04_led led);

#ifdef __cplusplus
}
#endif

#endif
