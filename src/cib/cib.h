/* SPDX-License-Identifier: MIT */
/* cib.h: the face of the room for the CIB module C-OS-0808M: 8 inputs, 8 outputs that drive two stepper motors, or are plain or
 * PWM outputs. A pure core like the RKM04's: whole numbers, no heap, no operating system; its surroundings bring time and bytes.
 * How the host reaches it (Modbus, lines) is not its concern: faces read and write the registers below.
 * BU, BK, BT, BP, BC, BM, BW, BL are clauses of docs/CIB.md.
 *
 * A tick is 1 us. What a host delivers acts at cib_now(), in the order of the calls, in front of what else happens in that tick
 * (BK2), but after inputs that have become old enough to show. */
#ifndef RKM04_CIB_CIB_H
#define RKM04_CIB_CIB_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <rkm04/motion.h>

#define CIB_INPUTS 8u
#define CIB_OUTPUTS 8u
#define CIB_DRIVES 2u                  /* 0 is drive A, DO1-DO4; 1 is drive B, DO5-DO8 */
#define CIB_USES 3u                    /* outputs whose use is chosen together: DO1-2, DO3-4, DO5-8 */
#define CIB_TICKS_PER_SECOND 1000000u
#define CIB_SLOT_TICKS 1000u           /* BK2 */
#define CIB_INPUT_TICKS 5000u          /* BU2 */
#define CIB_NEVER UINT64_MAX           /* no tick */
#define CIB_SPEED_MIN 5u
#define CIB_SPEED_MAX 10000u           /* pulses/s */
#define CIB_ACCELERATION_MIN 5u
#define CIB_ACCELERATION_MAX 240u      /* pulses/s^2, times acc_unit */
#define CIB_DUTY_MAX 10000u            /* 0.01 % */
#define CIB_PERIOD_MIN 10u
#define CIB_PERIOD_MAX 1000000u        /* us */
#define CIB_BRAKE_ERROR_MAX 20         /* pulses either way (BM8) */
#define CIB_TYPE 0x0808u
#define CIB_FIRMWARE_1_1 0x0101u
#define CIB_FIRMWARE_1_2 0x0102u

/* ---- Configuration ------------------------------------------------------------------------------------------------- */

enum cib_use { CIB_USE_DO, CIB_USE_PWM, CIB_USE_DRIVE };

/* Of one drive, registers 110H and 120H on; all words take any value until they are checked (BL8). */
struct cib_drive_setup {
    uint16_t mode;             /* 16, 17, 20, 21, 32, 33 (BT1) */
    uint16_t start_speed;      /* 5..10 000 pulses/s */
    uint16_t speed_max;        /* 5..10 000 pulses/s */
    uint16_t acceleration_max; /* 5..240 */
    uint16_t deceleration_max; /* 5..240 */
    uint16_t ramps;            /* 0, 1 */
};

/* Registers 101H-125H: what the outputs are, and how. */
struct cib_setup {
    uint16_t use[CIB_USES];    /* enum cib_use */
    uint32_t period[CIB_USES]; /* of PWM, us */
    uint16_t bipolar;          /* bit 0 DO1-2, 1 DO3-4, 2 DO5-8: bipolar PWM */
    uint16_t active;           /* bit 0 is PWM1: the level of the pulse is log. 1 */
    struct cib_drive_setup drive[CIB_DRIVES];
};

/* The default (BU9): two drives, mode 20. */
extern const struct cib_setup cib_default_setup;

/* Check a setup as APPLY does (BL8, BU4-BU6). Returns 0, or the address of the first register that is wrong. */
uint16_t cib_check_setup(const struct cib_setup *setup, uint16_t firmware);

/* Settings at power-up. */
struct cib_config {
    struct cib_setup setup; /* has to pass cib_check_setup() */
    uint16_t firmware;      /* CIB_FIRMWARE_1_1, CIB_FIRMWARE_1_2 (BU5) */
    uint32_t idle_off;      /* ms after which a drive at rest is switched off; 0: never (BT3) */
    uint32_t comm_timeout;  /* ms without a request after which both drives stop; 0: never (BC9) */
    uint8_t acc_unit;       /* 1, 10 or 100 pulses/s^2 (BP2) */
    int8_t brake_error;     /* -20..20 pulses (BM8) */
};

/* The defaults of all of it. */
extern const struct cib_config cib_default_config;

/* ---- What the surroundings provide ----------------------------------------------------------------------------------------- */

enum cib_event {
    CIB_EVENT_STATUS,   /* axis; value: MCSTAT, changed (BC4) */
    CIB_EVENT_MOTION,   /* axis; value 1: a motion begins, 0: it has ended. A motion planned anew, or a turn, is still one */
    CIB_EVENT_TAKEN,    /* axis; value: number of the command (BC2) */
    CIB_EVENT_REFUSED,  /* axis; value: MCERR 1..5 (BC3) */
    CIB_EVENT_POSITION, /* axis; value: position as two's complement that no pulse led to (command 100, APPLY) */
    CIB_EVENT_INPUTS,   /* axis 0; value: inputs as they show, mask (BU2) */
    CIB_EVENT_DUTY,     /* axis: output 1..8; value: its duty register, changed */
    CIB_EVENT_APPLY,    /* axis 0; value: result (BU8) */
    CIB_EVENT_TIMEOUT   /* axis 0; value 0: no request for comm_timeout (BC9) */
};

/* What a unit reports, called from within its calls. `axis` 1 is drive A, 2 drive B. Everything comes in the order of ticks as
 * long as `outputs` or `edges` is set; without both, what concerns one axis does. Any may be NULL. None may call back into the
 * unit. */
struct cib_port {
    /* `count` >= 1 pulses of a drive, at tick[0] to tick[count - 1]; position: after the first, each further one counts it up
     * (forward) or down. */
    void (*steps)(void *context, unsigned axis, const uint64_t *tick, size_t count, int32_t position, bool forward);
    void (*direction)(void *context, uint64_t tick, unsigned axis, bool forward);
    /* What is driven has changed, but for edges of PWM: bits 0-7 DO1-DO8 on or +, bits 8-15 DO1-DO8 -. */
    void (*outputs)(void *context, uint64_t tick, uint16_t driven);
    /* The same by edges of PWM outputs. NULL: they are not computed, up to 200 000 a second and output. */
    void (*edges)(void *context, uint64_t tick, uint16_t driven);
    void (*event)(void *context, uint64_t tick, unsigned axis, enum cib_event what, uint32_t value);
};

/* ---- State (read through the calls below) ---------------------------------------------------------------------------------- */

/* A motion command from the tick at which it is taken. */
struct cib_order {
    uint8_t kind;        /* of drive.c; 0: none */
    int32_t value;       /* position, distance, speed with sign */
    uint16_t speed;
};

struct cib_drive {
    uint64_t invel_due;  /* tick at which INVEL is set; CIB_NEVER: none */
    uint64_t idle_due;   /* tick at which the outputs are switched off (BT3); CIB_NEVER: none */
    uint64_t slot;       /* in which `waiting` acts; CIB_NEVER: none waits */
    struct cib_order waiting;
    uint32_t check;      /* pulse at which the drive updates its motion; 0: none */
    int32_t position;    /* BM9 */
    uint16_t sequence, command, p2; /* registers SEQ, CMD, P2 */
    uint32_t p1;         /* register P1 */
    uint16_t ack, error; /* ACK, MCERR */
    uint16_t start_speed, acceleration, deceleration, stop_deceleration; /* s, a, d, d! */
    struct {
        int64_t way;         /* to a position: left from motion.done 0 on, forward > 0 */
        int32_t speed;       /* for ever: with sign */
        uint16_t start_speed, acceleration, deceleration; /* pulses/s, pulses/s^2 */
        uint8_t kind;        /* enum profile_goal_kind */
    } goal;              /* of the motion under way, or of the one after its turn (BP3) */
    uint8_t after;       /* of drive.c: what the last pulse leads to */
    uint8_t status;      /* MCSTAT (BC4) */
    uint8_t row;         /* pulses +, less pulses -, modulo the rows of the table */
    bool started;        /* a pulse has come since power-up or APPLY */
    bool off;            /* switched off by idle_off */
    struct rkm04_motion motion;
};

struct cib_pwm {
    uint64_t from;       /* first tick of the period in which `duty` counts */
    uint16_t duty;       /* register */
    uint16_t before;     /* duty that counts in front of `from` */
};

struct cib_unit {
    const struct cib_port *port;
    void *context;
    struct cib_config config; /* its setup is the one of power-up */
    uint64_t now;        /* first tick not yet done */
    uint64_t since;      /* tick of power-up or the last APPLY that was right: PWM periods begin there */
    uint64_t request_due; /* tick at which BC9 finds that no request has come; CIB_NEVER: none */
    uint64_t stop_slot;  /* slot in which it stops the drives; CIB_NEVER: none */
    uint64_t edge;       /* next edge of PWM; CIB_NEVER: none, or not watched */
    uint64_t input_due[CIB_INPUTS]; /* tick at which `lines` shows */
    uint8_t lines, shown; /* DI on the terminals, DI as they show */
    uint8_t buttons;
    uint8_t outputs;     /* register DO */
    uint16_t steady;     /* outputs but for PWM as last reported */
    uint16_t result;     /* of the last APPLY */
    struct cib_setup setup; /* as it counts now */
    struct cib_setup proposal;
    struct cib_pwm pwm[CIB_OUTPUTS];
    struct cib_drive drive[CIB_DRIVES];
};

/* ---- Calls --------------------------------------------------------------------------------------------------------- */

/* Power up at tick 0. `config` is copied, `port` must stay. Inputs and buttons are 0: set them before the first advance. */
void cib_begin(struct cib_unit *unit, const struct cib_config *config, const struct cib_port *port, void *context);

/* Give a unit that has been copied, or whose port has changed, its surroundings. To have edges of PWM for a while
 * only, give it a port with `edges` for that while. */
void cib_attach(struct cib_unit *unit, const struct cib_port *port, void *context);

/* The first tick that is not yet done. */
uint64_t cib_now(const struct cib_unit *unit);

/* Do the ticks now .. now + ticks - 1. */
void cib_advance(struct cib_unit *unit, uint64_t ticks);

/* The earliest tick, >= now, in which something is due if nothing comes in; CIB_NEVER: nothing ever is. */
uint64_t cib_next_event(const struct cib_unit *unit);

/* The same, but pulses do not count while the port has neither `steps` nor `outputs`. */
uint64_t cib_next_report(const struct cib_unit *unit);

/* Levels at the terminals of DI, mask: they show when they have been constant for 5000 ticks. At tick 0 they are those of
 * power-up, which count at once (BU2). */
void cib_set_inputs(struct cib_unit *unit, uint8_t mask);
uint8_t cib_inputs(const struct cib_unit *unit);       /* at the terminals */
uint8_t cib_shown_inputs(const struct cib_unit *unit); /* as they show in front of what happens at tick now */

/* Push buttons that are pressed, mask; bit 0 is the one of DO1 (BU7). */
void cib_set_buttons(struct cib_unit *unit, uint8_t mask);

/* A request is complete, executed or not, or a line: BC9 counts from here. */
void cib_note_request(struct cib_unit *unit);

/* ---- Registers (BL7) ----------------------------------------------------------------------------------------------- */

enum cib_zone {
    CIB_OUTPUT_ZONE, /* holding registers, coils */
    CIB_INPUT_ZONE   /* input registers, discrete inputs */
};

/* Is there such a register? */
bool cib_has_register(enum cib_zone zone, uint16_t address);

/* Its value in front of what happens at tick now; 0 if there is none. */
uint16_t cib_read(const struct cib_unit *unit, enum cib_zone zone, uint16_t address);

enum cib_answer {
    CIB_DONE,
    CIB_NO_REGISTER, /* Modbus exception 02 */
    CIB_BAD_VALUE    /* Modbus exception 03 */
};

/* One message writes `count` registers of the output zone from `address` on: all or none of them. Then APPLY, then commands
 * (BU8, BC2): a drive whose SEQ differs from ACK takes its command. */
enum cib_answer cib_write(struct cib_unit *unit, uint16_t address, const uint16_t *value, unsigned count);

/* Bits: coils 0-7 are DO1-DO8; discrete inputs 0-7 are DI1-DI8, 8-15 the LEDs of DO1-DO8. */
#define CIB_COILS 8u
#define CIB_DISCRETE_INPUTS 16u
uint16_t cib_read_bits(const struct cib_unit *unit, enum cib_zone zone);

/* One message writes the coils of `mask`, as they are in `bits`. */
void cib_write_coils(struct cib_unit *unit, uint8_t mask, uint8_t bits);

/* ---- What can be seen ---------------------------------------------------------------------------------------------- */

/* MCSTAT (BC4). */
#define CIB_MOVE 0x01u
#define CIB_DIR 0x02u
#define CIB_INVEL 0x04u
#define CIB_TRG 0x08u
#define CIB_ERR 0x10u
#define CIB_RAMP 0x20u

struct cib_drive_state {
    bool configured;
    int32_t position;
    int32_t speed;      /* pulses/s, cut to a whole number, with sign; 0: it does not move */
    uint32_t steps;     /* done since the present motion began or was planned last */
    uint16_t status;    /* MCSTAT */
    uint16_t error;     /* MCERR */
    uint16_t ack;
    uint16_t row;       /* 1-8; 0: before the first pulse */
    uint16_t start_speed, acceleration, deceleration, stop_deceleration; /* operating values: s, a, d, d! */
    bool moving;        /* a motion is under way: pulses come */
    bool stopping;      /* and it brakes: to stop, or to turn */
    bool turning;       /* it brakes to turn */
    bool waiting;       /* a motion command waits for its slot */
    bool forward;       /* DIR is 0 */
    bool off;           /* switched off at rest (BT3) */
};

/* State of a drive, 0 or 1, in front of what happens at tick now. */
void cib_drive_state(const struct cib_unit *unit, unsigned drive, struct cib_drive_state *state);

/* Is this drive configured? */
bool cib_has_drive(const struct cib_unit *unit, unsigned drive);

/* What is driven at the terminals in front of what happens at tick now: bits 0-7 DO1-DO8 on or +, bits 8-15 -. */
uint16_t cib_driven(const struct cib_unit *unit);

/* Use of an output, 0..7. */
enum cib_use cib_use_of(const struct cib_unit *unit, unsigned output);

/* "none", "command", "no drive", "range", "maximum", "moving": MCERR for people. Never NULL. */
const char *cib_error_name(uint16_t error);

#endif
