/* SPDX-License-Identifier: MIT */
/* pmc.h: one virtual PMC-1HS or PMC-2HS (Autonics), the motion controller for one or two axes, as plain data.
 *
 * No heap, no clock, no operating system, no globals; one call at a time for a unit, any number of units in a process. Copying a
 * struct pmc_unit is a snapshot, copying it back is a restore (port and context are kept by address).
 *
 *     static struct pmc_unit unit;
 *     pmc_init(&unit, &config, &port, context);                                  // power-up
 *     pmc_request(&unit, &(struct pmc_request){.kind = PMC_MOVE_BY, .axes = 1, .value = {1000}});
 *     pmc_advance(&unit, 8000);                                                  // one millisecond: pulses through port.steps
 *
 * Axes count from 0: X is 0, Y is 1, of a set of axes X is bit 0. A tick is 1/8 us. Clauses in brackets refer to docs/PMC.md. */
#ifndef PMC_PMC_H
#define PMC_PMC_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <rkm04/motion.h>

#include "pmc_face.h"

/* ---- Figures ------------------------------------------------------------------------------------------------------- */

#define PMC_AXES 2u
#define PMC_REGISTERS 64u             /* of the program of an axis (AU2) */
#define PMC_REPETITIONS 3u            /* inside each other (AC3) */
#define PMC_TICKS_PER_SECOND 8000000u /* AT1 */
#define PMC_TICKS_PER_US 8u
#define PMC_SLOT_TICKS 8000u          /* slots are the ticks 8000, 16 000, ... */
#define PMC_PULSE_TICKS 80u           /* of the longest pulse; as long after the last one a motion is over (AT4, AT5) */
#define PMC_NEVER UINT64_MAX          /* no tick */
#define PMC_SPEED_MAX 8000            /* a speed as it is set, in units of the multiplier */
#define PMC_COUNTER_MIN (-8388608)    /* AM4 */
#define PMC_COUNTER_MAX 8388607
#define PMC_PENDING_MAX 8u            /* requests of an axis that wait for the next slot; one more is refused as PMC_BUSY */
#define PMC_FLASH_BLOCKS 4u           /* two generations of each axis */
#define PMC_FLASH_BLOCK_SIZE 1024u

/* Inputs: bits of an axis, as levels and as register 9 of AB6 has them. X is in bits 0..6, Y in bits 8..14, emg is bit 7. */
enum pmc_input {
    PMC_IN0 = 1,
    PMC_IN1 = 2,
    PMC_NEAR = 4,
    PMC_HOME = 8,
    PMC_Z = 16,
    PMC_LIMIT_PLUS = 32,
    PMC_LIMIT_MINUS = 64,
    PMC_EMG = 128 /* common to the axes */
};
#define PMC_INPUT_SHIFT 8u /* of axis Y */

/* Outputs: X has OUT0 in bit 0 and OUT1 in bit 1, Y has them in bits 2 and 3. */
#define PMC_OUTPUT_SHIFT 2u

/* Errors of an axis (AL5). */
enum pmc_error {
    PMC_ERROR_SL_PLUS = 0x01,
    PMC_ERROR_SL_MINUS = 0x02,
    PMC_ERROR_HL_PLUS = 0x04,
    PMC_ERROR_HL_MINUS = 0x08,
    PMC_ERROR_EMG = 0x10,
    PMC_ERROR_PGM = 0x20,
    PMC_ERROR_HOM = 0x40,
    PMC_ERROR_INX = 0x80
};

/* What a call answers. */
enum pmc_answer {
    PMC_OK,
    PMC_RANGE,      /* a value that is not legal (AS4 `range`) */
    PMC_BUSY,       /* an axis is busy (AS3), or too many requests wait for the slot */
    PMC_NO_AXIS,    /* an axis that the unit does not have, or none at all */
    PMC_STORE_FAILED
};

/* ---- Parameters (section 3) ---------------------------------------------------------------------------------------- */

enum pmc_parameter {
    PMC_MULTIPLIER,
    PMC_ACCELERATION,
    PMC_DECELERATION,
    PMC_START_SPEED,
    PMC_SPEED1,
    PMC_SPEED2,
    PMC_SPEED3,
    PMC_SPEED4,
    PMC_HOME_LOW,
    PMC_HOME_HIGH,
    PMC_SOFT_PLUS,
    PMC_SOFT_MINUS,
    PMC_NUMERATOR,
    PMC_DENOMINATOR,
    PMC_TIMER1,
    PMC_TIMER2,
    PMC_TIMER3,
    PMC_HOME_OFFSET,
    PMC_FLAGS,
    PMC_STEPS,
    PMC_END_PULSE_WIDTH,
    PMC_JERK,
    PMC_PARAMETERS /* how many there are */
};

/* Bits of PMC_FLAGS. */
enum pmc_flag {
    PMC_FLAG_SLOW_LIMIT = 0x001,
    PMC_FLAG_LIMIT_LEVEL = 0x002,
    PMC_FLAG_S_CURVE = 0x004,
    PMC_FLAG_END_PULSE = 0x008,
    PMC_FLAG_DECELERATION = 0x010, /* it is set on its own; else it follows the acceleration (AP4) */
    PMC_FLAG_SOFT_LIMITS = 0x020,
    PMC_FLAG_HOME_FIRST = 0x040,   /* home search at power-on */
    PMC_FLAG_RUN_FIRST = 0x080,    /* program at power-on */
    PMC_FLAG_CLEAR_AT_HOME = 0x100
};

/* Bits of PMC_STEPS: step n of the home search (0..3) is on, its direction is +, levels of inputs. */
#define PMC_STEP_ON(n) (1u << (n))
#define PMC_STEP_PLUS(n) (16u << (n))
#define PMC_LEVEL_NEAR 0x0100u
#define PMC_LEVEL_HOME 0x0200u
#define PMC_LEVEL_Z 0x0400u
#define PMC_LEVEL_IN0 0x0800u
#define PMC_LEVEL_IN1 0x1000u

/* The row of a parameter. */
struct pmc_parameter_row {
    const char *key;           /* in files: "multiplier" */
    int32_t low, high, standard; /* range, and the value of T1 */
    uint16_t address[PMC_AXES]; /* Modbus: its first register for X and Y */
    bool is_wide;              /* two registers, the high word first */
    bool is_bits;              /* written as 0x and four digits */
};
extern const struct pmc_parameter_row pmc_parameter_rows[PMC_PARAMETERS];

/* The parameters of an axis, as they were written; PMC_DECELERATION counts with its flag only. */
struct pmc_parameters {
    int32_t value[PMC_PARAMETERS];
};

/* All values as in T1. */
void pmc_parameters_clear(struct pmc_parameters *parameters);

/* A value as it reads: PMC_DECELERATION while it follows is the acceleration. */
int32_t pmc_parameter(const struct pmc_parameters *parameters, enum pmc_parameter which);

/* Write a value (AP4: of PMC_DECELERATION also its flag). Returns false, and changes nothing, if it is out of range. */
bool pmc_parameter_put(struct pmc_parameters *parameters, enum pmc_parameter which, int32_t value);

/* ---- Commands (section 4) ------------------------------------------------------------------------------------------ */

enum pmc_op {
    PMC_NOP,
    PMC_ABS,
    PMC_INC,
    PMC_HOM,
    PMC_IJP,
    PMC_OUT,
    PMC_OTP,
    PMC_JMP,
    PMC_REP,
    PMC_RPE,
    PMC_END,
    PMC_TIM,
    PMC_OPS /* how many there are */
};

/* Operands of a command, in the order of a text. */
enum pmc_operand {
    PMC_OPERAND_VALUE = 1,   /* value: tenths of a unit */
    PMC_OPERAND_SPEED = 2,   /* speed: 1..4 */
    PMC_OPERAND_DWELL = 4,   /* ms 0..65 535, or number 1..3: a post timer; may be left out */
    PMC_OPERAND_INPUT = 8,   /* number: 0, 1 */
    PMC_OPERAND_OUTPUT = 16, /* number: 0, 1 */
    PMC_OPERAND_STATE = 32,  /* argument: 1 ON, 0 OFF */
    PMC_OPERAND_TARGET = 64, /* argument: REG 0..63 */
    PMC_OPERAND_COUNT = 128, /* argument: 1..255 */
    PMC_OPERAND_MS = 256,    /* ms: 1..65 535 */
    PMC_OPERAND_WAIT = 512   /* wait; may be left out */
};

/* A program register. What its command does not use is 0. */
struct pmc_command {
    int32_t value;     /* tenths of a unit, -83 886 080..83 886 070 */
    uint16_t ms;
    uint8_t op;        /* enum pmc_op */
    uint8_t speed;     /* 1..4 */
    uint8_t argument;  /* REG; count; ON is 1 */
    uint8_t number;    /* of an input or output 0, 1; of a post timer 1..3 */
    bool wait;
};

struct pmc_unit;
struct pmc_axis;

/* The row of a command. */
struct pmc_command_row {
    const char *name;   /* "ABS" */
    uint16_t operands;  /* enum pmc_operand */
    void (*execute)(struct pmc_unit *unit, struct pmc_axis *axis, const struct pmc_command *command);
};
extern const struct pmc_command_row pmc_command_rows[PMC_OPS];

/* Is it a command with legal operands, and 0 in all that it does not use? (AB3: of ms and post timer one at most.) */
bool pmc_command_valid(const struct pmc_command *command);

/* Units in tenths -> pulses, rounded to the nearest, ties away from zero (AM5). Exact for every legal command and more. */
int64_t pmc_pulses_of(const struct pmc_parameters *parameters, int64_t tenths);

/* Pulses -> tenths of a unit, rounded likewise: what is displayed. */
int64_t pmc_tenths_of(const struct pmc_parameters *parameters, int64_t pulses);

/* ---- Surroundings -------------------------------------------------------------------------------------------------- */

/* Things worth tracing, besides steps and outputs. */
enum pmc_event {
    PMC_EVENT_MOTION,   /* value 1: a motion begins, 0: it has ended */
    PMC_EVENT_COMMAND,  /* value: REG + 1 of the command being executed; 0: none */
    PMC_EVENT_ERRORS,   /* value: enum pmc_error, all that are set */
    PMC_EVENT_POSITION  /* value: commanded counter, as two's complement, that no pulse led to */
};

/* What a unit reports and asks; called from within pmc_init and pmc_advance. What concerns one axis comes in the order of time.
 * Any may be NULL. None may call back into the unit, but for pmc_pulse_ticks(). */
struct pmc_port {
    /* `count` >= 1 pulses of an axis at tick[0] to tick[count - 1]; position: of the commanded counter after the first, each
     * further one counts it up (forward) or down; the counter does not wrap within one call. */
    void (*steps)(void *context, unsigned axis, const uint64_t *tick, size_t count, int32_t position, bool forward);
    void (*direction)(void *context, uint64_t tick, unsigned axis, bool forward);
    void (*outputs)(void *context, uint64_t tick, uint8_t mask);
    void (*event)(void *context, uint64_t tick, unsigned axis, enum pmc_event what, uint32_t value);
    /* Flash, blocks 0..PMC_FLASH_BLOCKS-1 of PMC_FLASH_BLOCK_SIZE bytes; offsets and lengths of programs are multiples of 8;
     * erased bytes read FF. Return 0, or another value if it failed. */
    int (*flash_read)(void *context, unsigned block, unsigned offset, void *data, unsigned length);
    int (*flash_erase)(void *context, unsigned block);
    int (*flash_program)(void *context, unsigned block, unsigned offset, const void *data, unsigned length);
};

/* The line that a host is at: the ASCII face or Modbus. It keeps its state in unit->face, which is 0 at power-up. */
struct pmc_face {
    const char *name; /* "ascii" */
    /* Bytes arrive at the present tick. Returns how many were taken. */
    size_t (*receive)(struct pmc_unit *unit, const uint8_t *bytes, size_t length);
    /* Bytes of the answer, at most `room`. Returns their number; 0: nothing now. */
    size_t (*send)(struct pmc_unit *unit, uint8_t *bytes, size_t room);
    /* Is there an answer, now or later? */
    bool (*has_answer)(const struct pmc_unit *unit);
    /* The tick, now or later, at which act() is to be called, or PMC_NEVER; NULL: never. act() comes before the pulses and the
     * slot of that tick, and leaves a later one. */
    uint64_t (*due)(const struct pmc_unit *unit);
    void (*act)(struct pmc_unit *unit);
    /* RST takes effect, in a slot; NULL: nothing to do. */
    void (*reset)(struct pmc_unit *unit);
};

/* ---- Settings (AU8) ------------------------------------------------------------------------------------------------ */

struct pmc_config {
    const struct pmc_face *face; /* NULL: no line */
    uint8_t axes;                /* 1, 2 */
    uint8_t address;             /* of Modbus, 1..16 */
    bool passes;                 /* REP n: n passes in all, instead of going back n times (AC3) */
    bool refuse;                 /* ABS without a home search: PGM, instead of a warning (AL6) */
    uint32_t baud;               /* of the line, as it is set */
    uint32_t first_answer_late;  /* ms (AS6) */
};

/* ---- Requests ------------------------------------------------------------------------------------------------------ */

enum pmc_request_kind {
    /* Starts: refused as PMC_BUSY while an axis of theirs is busy. They act in the first slot at or after now. */
    PMC_RUN,        /* value: REG 0..63 */
    PMC_JOG,        /* value: > 0 forward, < 0 back */
    PMC_MOVE_TO,    /* value: pulses, within the counter's range */
    PMC_MOVE_BY,    /* value: pulses, within the same range */
    PMC_SEARCH,     /* home search */
    /* Refused likewise. */
    PMC_CLEAR_COMMANDED,
    PMC_CLEAR_ACTUAL,
    /* Always taken. */
    PMC_SET_SPEED,  /* value: 1..8000, the fifth speed; read at once, in a motion from the slot on */
    PMC_STOP,       /* with a ramp; drops a start that has not had its slot (AM8, AT3) */
    PMC_STOP_NOW,   /* at once (AM9), otherwise as PMC_STOP */
    PMC_STOP_PROGRAM, /* as PMC_STOP, on axes whose program runs */
    PMC_CLEAR_ERRORS,
    PMC_RESET       /* RST; the axes do not count */
};

struct pmc_request {
    uint8_t kind; /* enum pmc_request_kind */
    uint8_t axes; /* bits 0, 1: which ones it is for */
    int32_t value[PMC_AXES];
};

/* ---- State (read through the calls below) -------------------------------------------------------------------------- */

/* From this place on the slope holds until the next break point. */
struct pmc_break {
    struct rkm04_place at;
    struct rkm04_fixed w; /* 2 * rate * speed */
    int32_t slope;        /* pulses/s^2 */
};

#define PMC_BREAKS_MAX 6u

/* A motion from its begin to the slot in which it is over. */
struct pmc_motion {
    struct rkm04_ramp ramp;
    struct pmc_break point[PMC_BREAKS_MAX];
    uint64_t last;       /* tick of the last pulse */
    uint64_t over;       /* slot in which it is over, once it does not move any more */
    uint32_t done;       /* pulses since the place that the points count from */
    uint32_t made;       /* pulses since the begin, modulo 2^32 */
    uint32_t total;      /* pulses, counted as `done`, of a motion with an end */
    uint16_t top;        /* the highest speed commanded, as it is set (AT5) */
    uint8_t count, leg;  /* points in use; the motion is between point[leg] and the next one */
    bool endless;
    bool moving;         /* a pulse is to come */
    bool active;         /* moving, or not yet in the slot in which it is over */
    bool forward;
    bool stopping;       /* on the ramp of a stop */
    bool manual;         /* of JOG, PAB, PIC: the fifth speed counts (AM7) */
    bool limited;        /* it has been made shorter to end at a software limit (AL1) */
};

/* A request that waits for the slot. */
struct pmc_pending {
    uint8_t kind;
    int32_t value;
};

/* What an axis does. */
enum pmc_state {
    PMC_IDLE,
    PMC_MANUAL,   /* a manual move, or a ramp that outlives what it belonged to */
    PMC_PROGRAM,
    PMC_SEARCHING /* also in a program */
};

struct pmc_repetition {
    uint8_t reg;  /* of its REP */
    uint8_t left; /* how many times it still goes back */
};

struct pmc_axis {
    struct pmc_motion motion;
    uint64_t due;         /* slot from which the program goes on */
    uint64_t off[2];      /* slot in which an OTP ends, by output; PMC_NEVER: none */
    int32_t commanded, actual; /* counters */
    uint16_t speed;       /* the fifth */
    uint16_t dwell;       /* slots after the move under way */
    uint8_t errors;
    bool not_homed;       /* warning (AL6) */
    bool homed;
    bool forward;         /* the direction output */
    uint8_t inputs;       /* enum pmc_input: which are active, as the last slot saw them */
    bool running;         /* a program */
    bool run_after;       /* a program begins where the search ends well (AU5) */
    uint8_t reg, next;    /* of the command being executed, and of the next one */
    bool executing;       /* `reg` counts */
    bool after_move;      /* it waits for the end of a move */
    uint8_t phase;        /* of the home search (pmc_home.c); 0: none */
    bool begun;           /* the phase has its motion */
    bool turned;          /* a limit has been met in its step 2 */
    uint8_t pendings;
    uint8_t repetitions;
    struct pmc_pending pending[PMC_PENDING_MAX];
    struct pmc_repetition repetition[PMC_REPETITIONS];
    struct pmc_parameters parameters;
    struct pmc_command program[PMC_REGISTERS];
};

struct pmc_unit {
    struct pmc_config config;
    const struct pmc_port *port;
    void *context;
    uint64_t now;       /* first tick not yet done */
    uint16_t inputs;    /* levels */
    uint8_t outputs;
    uint8_t start[PMC_AXES]; /* registers from which Modbus command 07 runs the program (AB4) */
    bool touched;       /* something came in: every axis has its turn in the next slot */
    struct pmc_axis axis[PMC_AXES];
    union pmc_face_state face;
};

/* ---- Calls --------------------------------------------------------------------------------------------------------- */

/* Power up at tick 0 (AU5). config: copied; port: kept by address, context is handed to it. */
void pmc_init(struct pmc_unit *unit, const struct pmc_config *config, const struct pmc_port *port, void *context);

/* The first tick that is not yet done. */
uint64_t pmc_now(const struct pmc_unit *unit);

/* Do the ticks now .. now + ticks - 1 (AT2). However the time is cut, the same comes out. */
void pmc_advance(struct pmc_unit *unit, uint64_t ticks);

/* The earliest tick, >= now, in which something is due if nothing comes in from outside; PMC_NEVER. */
uint64_t pmc_next_event(const struct pmc_unit *unit);

/* The same, but pulses do not count while the port has no `steps`. */
uint64_t pmc_next_report(const struct pmc_unit *unit);

/* Set the levels of all inputs from the present tick on; they are looked at in slots. */
void pmc_set_inputs(struct pmc_unit *unit, uint16_t levels);

/* Ask for something at the present tick. All axes are checked before anything is done (AS3). */
enum pmc_answer pmc_request(struct pmc_unit *unit, const struct pmc_request *request);

/* The same without doing it. */
enum pmc_answer pmc_check(const struct pmc_unit *unit, const struct pmc_request *request);

/* Write a parameter of an axis, or a register of its program (AP6). PMC_BUSY: the axis is busy. */
enum pmc_answer pmc_set_parameter(struct pmc_unit *unit, unsigned axis, enum pmc_parameter which, int32_t value);
enum pmc_answer pmc_set_command(struct pmc_unit *unit, unsigned axis, unsigned reg, const struct pmc_command *command);

/* Write all parameters of an axis, or all 64 registers: for files, which have been checked. */
enum pmc_answer pmc_set_parameters(struct pmc_unit *unit, unsigned axis, const struct pmc_parameters *parameters);
enum pmc_answer pmc_set_program(struct pmc_unit *unit, unsigned axis, const struct pmc_command program[PMC_REGISTERS]);

/* Store parameters and program of an axis (AP6). A power cut leaves the old or the new ones, whole. */
enum pmc_answer pmc_store(struct pmc_unit *unit, unsigned axis);

/* Write `ABS` with the present position, V1, into a register (AU7, 9). PMC_RANGE: outside what ABS can have. */
enum pmc_answer pmc_register_position(struct pmc_unit *unit, unsigned axis, unsigned reg);

/* Is the axis busy (AT3)? Then starts are refused. */
bool pmc_is_busy(const struct pmc_unit *unit, unsigned axis);

/* Was emg active in the last slot (AL4)? */
bool pmc_emergency(const struct pmc_unit *unit);

/* What can be seen of an axis. */
struct pmc_axis_state {
    int32_t commanded, actual; /* counters */
    uint32_t speed;     /* pulses/s, rounded down; 0: no pulse is to come */
    uint32_t made;      /* pulses of the present motion; 0: none */
    enum pmc_state state;
    uint8_t driving;    /* INR: 1 moving, 2 program, 4 search; also what waits for its slot */
    int16_t reg;        /* being executed; -1: none */
    uint8_t errors;
    uint8_t inputs;     /* active ones, register 9 of AB6 */
    uint8_t outputs;    /* OUT0 in bit 0 */
    bool homed, not_homed;
    bool moving;        /* a pulse is to come */
    bool stopping;
    bool forward;
    bool endless;       /* the motion has no end of its own */
    uint8_t repetitions; /* open ones */
    uint16_t fifth;     /* speed, as it is set */
};
void pmc_axis_state(const struct pmc_unit *unit, unsigned axis, struct pmc_axis_state *state);

/* Levels of the inputs, and the outputs. */
uint16_t pmc_inputs(const struct pmc_unit *unit);
uint8_t pmc_outputs(const struct pmc_unit *unit);

/* How many ticks the pulses of the present motion are long (AT5). */
unsigned pmc_pulse_ticks(const struct pmc_unit *unit, unsigned axis);

#include "pmc_text.h"

#endif
