/* SPDX-License-Identifier: MIT */
/* device.h: the face of the room for what a device on a bus is to everything around it. One const struct device_kind for each
 * kind of device; the rooms above know units through it alone.
 *
 * To add a kind: a folder with its core, one file here that fills in a struct device_kind (rkm04_device.c is the example), and
 * one row in device_kinds[] of device_kinds.c. A test program adds kinds without touching that table: it defines
 *
 *     const struct device_kind *const device_kinds_added[] = {&fake_device, NULL};
 *
 * which the linker finds; a program that does not define it has the kinds of the table alone.
 *
 * Time. Everything around a unit counts in us. A unit may count finer: `ticks_per_us` of its ticks make one us. `now`, `advance`,
 * `next_event` and `next_report` are in us since its power-up; the ticks that a unit reports to its port are its own. */
#ifndef RKM04_DEVICE_H
#define RKM04_DEVICE_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <rkm04/unit.h>

#include "coverage.h"
#include "serve_names.h"
#include "text/text.h"

#define DEVICE_FLASH_BLOCKS_MAX 64u  /* blocks of flash */
#define DEVICE_FLASH_BLOCK_MAX 4096u /* bytes of a block */
#define DEVICE_MESSAGE_MAX 9216u  /* bytes of a message, without framing */
#define DEVICE_NEVER UINT64_MAX   /* no time */
#define DEVICE_TURNAROUND 521u    /* us: one character */
#define DEVICE_BAUD 19200u        /* of the bus, where a kind has no other */
#define DEVICE_AXES_MAX 16u       /* of a unit; axis 1..DEVICE_AXES_MAX, 0 is the unit */
#define DEVICE_BITS_MAX 32u       /* inputs, outputs, variables: bit 0 is the first */
#define DEVICE_SETTINGS_SIZE 128u /* bytes that a kind has for its own settings */
#define DEVICE_COMMAND_SIZE 64u   /* bytes of a command as text */
#define DEVICE_ERROR_SIZE 256u    /* bytes of a message */
#define DEVICE_VALUES_MAX 16u     /* of a unit; value 1..DEVICE_VALUES_MAX */
#define DEVICE_BIT_NAME_SIZE 16u  /* bytes of the name of an input or output, with its end */
#define DEVICE_FILE_MIB_MAX 32u   /* of a file that an option names */
#define DEVICE_TEXT_OVERFLOWS 3   /* flag of set_text: more than the memory holds */

/* A unit of any kind: kind->size bytes of plain memory. Copying them is a snapshot; what is copied back, or elsewhere, needs
 * kind->attach() before anything else. */
struct device_unit;


/* Settings of a unit. All zero but `node` is the default of every kind. */
struct device_config {
    uint8_t node;                /* its address, 1..kind->addresses */
    union {
        uint8_t byte[DEVICE_SETTINGS_SIZE];
        uint64_t whole;
        const void *pointer;
    } own;                       /* the kind's; what it points to must stay while the config or a unit with it is used */
};

/* What happens in a unit, besides steps, direction and outputs. */
enum device_event {
    DEVICE_EVENT_MOTION,   /* value 1: a motion begins, 0: it has ended */
    DEVICE_EVENT_COMMAND,  /* value: place from 1 of the command being executed; 0: none */
    DEVICE_EVENT_LED,      /* value: enum device_led */
    DEVICE_EVENT_VARIABLE, /* axis 0; value: all variables, the first in bit 0 */
    DEVICE_EVENT_FAULT,    /* value: kind->fault_name(); 0: none. Axis 0: of the unit as a whole */
    DEVICE_EVENT_POSITION, /* value: counter, as two's complement, that no step led to */
    DEVICE_EVENT_VALUE     /* axis: which of the values, from 1; value: what it is now, as two's complement */
};

/* What a unit reports and asks; called from within begin, receive, send and advance. `axis` from 1, `tick` of the unit. What
 * concerns one axis comes in the order of time. Any may be NULL. None may call back into the unit. */
struct device_port {
    /* `count` >= 1 steps of an axis at tick[0] to tick[count - 1]; position: of the counter after the first, each further one
     * counts it up (forward) or down. A device that drives coils reports a step for each row of its table; the levels are
     * outputs. */
    void (*steps)(void *context, unsigned axis, const uint64_t *tick, size_t count, int32_t position, bool forward);
    void (*direction)(void *context, uint64_t tick, unsigned axis, bool forward);
    void (*outputs)(void *context, uint64_t tick, uint32_t mask);
    void (*event)(void *context, uint64_t tick, unsigned axis, enum device_event what, uint32_t value);
    /* What a device reports in words, one line: "start refused: no NC program is loaded". */
    void (*note)(void *context, uint64_t tick, unsigned axis, const char *text);
    /* A slot of a device with cells is over, which was done at `tick`. It may look at cells: kind->cell(). */
    void (*slot)(void *context, uint64_t tick);
    /* Flash, blocks 0..kind->flash_blocks-1; erased bytes read FF. Return 0, or another value if it failed. */
    int (*flash_read)(void *context, unsigned block, unsigned offset, void *data, unsigned length);
    int (*flash_erase)(void *context, unsigned block);
    int (*flash_program)(void *context, unsigned block, unsigned offset, const void *data, unsigned length);
};

enum device_led { DEVICE_LED_OFF, DEVICE_LED_ON, DEVICE_LED_BLINK /* 0.5 s on, 0.5 s off, begins on */ };

/* What an axis has in flash: as power-up found it, until a program is stored. */
enum device_slot {
    DEVICE_SLOT_EMPTY,
    DEVICE_SLOT_LOADED,    /* the program that power-up has loaded */
    DEVICE_SLOT_UNTRUSTED, /* something that is no whole program: counts as empty */
    DEVICE_SLOT_STORED     /* a program that was stored since power-up */
};

/* What can be seen of an axis. */
struct device_axis {
    int32_t position;  /* counter */
    uint32_t steps;    /* done in the present motion */
    uint32_t speed;    /* steps/s, rounded down; 0: it does not move */
    uint16_t index;    /* place from 1 of the command being executed; 0: none */
    uint16_t commands; /* in memory */
    uint8_t state;     /* kind->state_name() */
    uint8_t fault;     /* kind->fault_name(); 0: none */
    uint8_t led;       /* enum device_led */
    uint64_t blink_from; /* us since power-up from which the LED blinks */
    bool lit;          /* is the LED bright now? */
    bool absent;       /* the configuration has no such axis */
    bool idle;         /* it has nothing more to do */
    bool running;      /* it continues by itself: it moves, or time will bring its next command */
    bool moving;
    bool stopping;     /* on a stop ramp */
    bool forward;      /* direction output */
    enum device_slot slot;
};

/* A corner of the planned speed over time. Between two of them the acceleration is constant; two at one time are a jump. */
struct device_plan_point {
    double us;       /* since power-up */
    double speed;    /* steps/s, negative: back */
    double position; /* of the counter, with a part of a step */
};

#define DEVICE_PLAN_POINTS 96u /* of one motion, at most */

/* Counters since power-up, mod 2^32. */
struct device_counters {
    uint32_t requests; /* for this unit */
    uint32_t answers;  /* that have gone out whole */
    uint32_t others;   /* frames for others */
    uint32_t dropped;  /* frames that were none. With each frame that ends one of these three counts up */
};

/* ---- What a kind may offer besides its units ---------------------------------------------------------------------------- */

enum device_option_flag {
    DEVICE_OPTION_SWITCH = 1, /* also --NAME VALUE on the command line */
    DEVICE_OPTION_BUS = 2     /* is about bytes on the bus: not for `rkm04 exec` */
};

/* A setting of a unit that people choose: --device-option NAME=VALUE, and a key of scenarios, in which `-` is written `_`.
 * Either `read` or `read_file` is set. Texts must stay as long as the config and units with it are used. */
struct device_option {
    const char *name;     /* "version-text" */
    const char *argument; /* what it takes, for --help: "TEXT" */
    const char *help;     /* for --help: what it is, values, default */
    unsigned flags;       /* enum device_option_flag */
    unsigned file_mib;    /* MiB that its file has at most, up to DEVICE_FILE_MIB_MAX; 0: 1 */
    /* Read a value into the config. Returns false and a message that says what was expected. */
    bool (*read)(struct device_config *config, const char *value, char error[DEVICE_ERROR_SIZE]);
    /* The value is a file: read its content, `text` with a zero after it. Errors go to `errors`, a line each,
     * NAME:LINE:COLUMN: error: expected …; then false. */
    bool (*read_file)(struct device_config *config, const char *name, const char *text, size_t length, FILE *errors);
    /* The value of a scenario's key. Errors are reported at their nodes (config_error()). NULL: a text for `read`. */
    bool (*read_node)(struct device_config *config, const char *key, const struct config_node *node);
    /* Print the values there are: of NAME=list. NULL: `list` is a value like any other. */
    void (*list)(FILE *out);
};

/* The message that the steps `set` and `program` of scenarios send, and its answer. */
struct device_program_message {
    unsigned head;  /* bytes before the text */
    unsigned flags; /* an answer has a flag 0..flags; 0: the text is taken */
    void (*begin)(uint8_t *message, unsigned axis); /* write the bytes before the text for an axis; 0: all */
    /* The flag of an answer to `message`; -1: it is none. */
    int (*flag)(const uint8_t *message, const uint8_t *answer, size_t length);
    /* What the flag of an answer says, "bad value 'X'". Returns whether something in the text is wrong. */
    bool (*explain)(const uint8_t *answer, char text[DEVICE_ERROR_SIZE]);
};

/* What clients have used of all that there is (coverage.h). */
struct device_coverage {
    /* Make the list for units with these settings: what they cannot do is not on it. Nothing has been used. */
    void (*begin)(struct coverage *coverage, const struct device_config *config);
    /* A client has sent a whole, well-framed message to `dnode`: 0 or the address of a unit that is there. */
    void (*request)(struct coverage *coverage, uint8_t dnode, const uint8_t *message, size_t length);
    /* A unit answers with this message. */
    void (*answer)(struct coverage *coverage, const uint8_t *message, size_t length);
    /* The program of an axis has stopped with a fault (DEVICE_EVENT_FAULT); 0, none, does not count. */
    void (*fault)(struct coverage *coverage, unsigned fault);
};

#define DEVICE_READINGS_MAX 64u /* of a kind */
#define DEVICE_TRIED_MAX 8u     /* values of one reading */
#define DEVICE_TEXT_SIZE 320u   /* bytes of a text that names readings */

/* How a kind reads what its manual leaves open: `at` is 0..count-1. `rkm04 test --readings all` runs scenarios under
 * each value. */
struct device_readings {
    unsigned count;
    const char *(*name)(unsigned at);
    unsigned (*tried)(unsigned at, unsigned values[DEVICE_TRIED_MAX]); /* values other than the default. Returns how many */
    void (*put)(struct device_config *config, unsigned at, unsigned value);
    bool (*is_chosen)(const struct device_config *config, unsigned at); /* by an option or a scenario */
    void (*take_others)(struct device_config *config, const struct device_config *from); /* those that are not chosen */
    const char *(*text)(const struct device_config *config, char text[DEVICE_TEXT_SIZE]); /* "hold-exit=latch"; "": defaults */
    json_t *(*json)(const struct device_config *config); /* those that are not at their default; NULL: out of memory */
};

/* The bytes of messages on the bus. */
struct device_framing {
    const struct rkm04_framing *link; /* finds messages and makes them */
    int flag, escape;                 /* bytes: every frame begins and ends with `flag`, `escape` before it aborts; -1: none */
    uint32_t silence;                 /* us after which bytes belong to no frame that was begun; 0: any time */
    /* Messages that end with `silence` us in which no byte comes: link->receive gathers receiver->length bytes in `buffer` and
     * returns false; after the silence, or when the other side begins to send, this is called. Are they a message? Then `dnode`,
     * and `length` bytes of content at the begin of `buffer`; otherwise one of the counters is raised. `answer`: of a unit. Zero
     * *receiver before the next message. NULL: a byte ends each message. */
    bool (*end)(struct rkm04_receiver *receiver, uint8_t *buffer, bool answer);
    const char *no_address;           /* what bytes are that cannot be an address: "no frame, no address above 16" */
};

/* What messages mean, for people; each may be NULL. They write to `out`; nothing written: there is nothing to say. */
struct device_words {
    void (*message)(struct wire_text *out, const uint8_t *message, size_t length, bool is_answer);
    void (*refusal)(struct wire_text *out, const uint8_t *message, size_t length); /* what an answer objects to */
    /* Why no unit executes a whole request, whatever units there are. */
    void (*ignored)(struct wire_text *out, uint8_t dnode, uint8_t snode, const uint8_t *message, size_t length);
};

/* How the outputs of a device drive the coils of a motor: lead 1 and 3 are coil a, lead 2 and 4 coil b. */
struct device_coils {
    uint8_t output[4]; /* of lead 1 to 4, from 1; an output that is 1 makes its lead positive */
    uint8_t eighths;   /* of a turn of the field that are a step of the counter: 1 (half steps) or 2 */
    uint8_t rest;      /* levels of the four outputs that a rotor rests at which was never driven: output[0] in bit 0 */
};

/* Why a method was refused. */
struct device_refusal {
    bool is_state; /* it cannot be done now; false: the parameters are wrong */
    char text[DEVICE_ERROR_SIZE];
};

/* A method of a kind for the control socket, scenarios (`call`) and recordings: "pmc.program". */
struct device_method {
    const char *name; /* NULL: the end of the table */
    /* Do it to a unit at the present us. `params`: an object, whose `unit` has been read, or NULL. Returns the result, a new
     * reference; NULL: refused, nothing has changed. */
    json_t *(*call)(struct device_unit *unit, const json_t *params, struct device_refusal *refusal);
    bool changes; /* anything: then recordings have it */
    const char *const *parameters; /* the names of all but `unit`; ends with NULL. NULL: any */
};

/* A method that takes time: what `set` has is given to the method `set` as {member: ...}, slots pass, the method `get` answers
 * {member: ...} with what `get` has. For the control socket, on a stepped clock. */
struct device_exchange {
    const char *name, *set, *get; /* of the methods */
    const char *member;           /* of their parameters */
    uint64_t (*end)(const struct device_unit *unit, unsigned slots); /* us at which so many slots have passed, since power-up */
};

/* ---- Servers ------------------------------------------------------------------------------------------------------------ */

#define DEVICE_BUS_UNITS 16u     /* on a bus */
#define DEVICE_CLIENTS_MAX 128u  /* of all servers of a bus at a time */
#define DEVICE_SERVICES_MAX 4u   /* of a kind */
#define DEVICE_PEER_SIZE 80u     /* bytes of a client's address */

/* What a server keeps of a client: service->size bytes of plain memory, all zero at first. */
struct device_client;

/* What a server sees of its bus. */
struct device_bus {
    uint64_t now;                               /* us of the bus: the present one */
    unsigned units;
    struct device_unit *unit[DEVICE_BUS_UNITS]; /* at the present us; NULL: it has no power */
    uint8_t node[DEVICE_BUS_UNITS];             /* their addresses, without power the last ones */
    unsigned clients;                           /* of this server */
    const char *peer[DEVICE_CLIENTS_MAX];       /* their addresses, "127.0.0.1:4000", in the order in which they came */
};

/* A server on TCP for many clients, in virtual time: Modbus TCP, lines of text. It reaches all units of the bus. Clients and
 * their state outlive power cuts; restoring a snapshot hangs them up. `rkm04 serve --service NAME=HOST:PORT` listens; without it
 * the commands service.open, service.bytes and service.close do the same. */
struct device_service {
    const char *name;        /* "modbus-tcp"; NULL: the end of the table */
    const char *description; /* for --help */
    size_t size;             /* bytes of what it keeps of a client */
    unsigned clients;        /* at most so many at a time, up to DEVICE_CLIENTS_MAX */
    const char *refusal;     /* what one more is sent before it is hung up; NULL: nothing */
    /* A client has come; NULL: there is nothing to do. */
    void (*open)(struct device_client *client, const struct device_bus *bus);
    /* Bytes of a client. Returns how many it takes now; the others come again when send() has nothing more. If it takes none of
     * them then, the client is hung up. */
    size_t (*receive)(struct device_client *client, const struct device_bus *bus, const uint8_t *bytes, size_t length);
    /* What is to be sent to the client now, a part of at most `room` bytes. Returns its length; 0: nothing more at this us. */
    size_t (*send)(struct device_client *client, const struct device_bus *bus, uint8_t *bytes, size_t room);
    /* Is the client to be hung up, when all has been sent? NULL: it never is. */
    bool (*is_over)(const struct device_client *client);
    /* The us of the bus at which send() has to be asked although no bytes have come; DEVICE_NEVER. NULL: never. */
    uint64_t (*next)(const struct device_client *client, const struct device_bus *bus);
};

/* A kind of device. Every function is set unless it says otherwise. */
struct device_kind {
    const char *name;        /* "rkm04": of options, scenarios, recordings */
    const char *description; /* for people, one line */

    size_t size;             /* bytes of a unit */
    unsigned axes, inputs, outputs, variables; /* 0..DEVICE_AXES_MAX, 0..DEVICE_BITS_MAX */
    unsigned first_variable; /* number of the first variable: 80 is VAR 80 */
    /* Names of inputs and outputs, the first one first: "near", "lmt+"; letters, digits and `_ . + -`, shorter than
     * DEVICE_BIT_NAME_SIZE, no number. They may be used in place of the numbers. NULL: numbers alone. */
    const char *const *input_names, *const *output_names;
    /* Numbers that a unit has besides, as the duties of PWM outputs, for traces: 0..DEVICE_VALUES_MAX, and their names as above.
     * All are 0 at power-up. value(): what number 1..values is now; NULL if there are none. */
    unsigned values;
    const char *const *value_names;
    int32_t (*value)(const struct device_unit *unit, unsigned number);
    unsigned addresses;      /* 1..addresses are addresses; at most 247 */
    const char *address_note; /* how they are set, for messages: ", as set with switch S1"; NULL: nothing is said */
    unsigned ticks_per_us;
    unsigned slot;           /* us of the period in which it reads inputs and executes commands */
    unsigned pulse;          /* us of a step pulse; see pulse_ticks */
    bool has_no_steps;       /* its axes make no steps and drive no coils: a plant has nothing to follow */
    unsigned speed_max;      /* steps/s that an axis can reach, so that plants can follow; 0: at most 128 000 */
    /* Speed of the bus with these settings, 9600..115200 baud, a divisor of 115200. NULL: DEVICE_BAUD. */
    unsigned (*baud)(const struct device_config *config);
    unsigned turnaround;     /* us from a request to its answer, unless --turnaround says otherwise; 0: one character */
    bool deaf_to_answers;    /* where bytes take no time, no unit receives the answers of others: they look like requests */
    unsigned program;        /* commands that an axis can have in memory; 0: it has no program */
    const struct device_program_message *program_message; /* NULL: scenarios have no steps `set` and `program` */
    bool is_program_whole;   /* a text is for all axes (axis 0), not for one */
    unsigned flash_blocks, flash_block_size; /* 0: no flash */
    const char *flash_name; /* what people call what lies there, also an option and a key of scenarios: "backup"; NULL: flash */
    unsigned request_max, answer_max; /* bytes of the longest message, without framing; at most DEVICE_MESSAGE_MAX */

    /* Power up at us 0 with the node and settings of `config`, which are copied; `port` must stay. The memory is zero before the
     * first power-up, and as the unit left it before another. */
    void (*begin)(struct device_unit *unit, const struct device_config *config, const struct device_port *port, void *context);
    /* Give a unit that has been copied, or whose port has changed, its surroundings. `config`: the settings that it had at begin,
     * with pointers of its own. */
    void (*attach)(struct device_unit *unit, const struct device_config *config, const struct device_port *port, void *context);

    /* The emulator ends in good order, outside of time: what is kept without power is stored. NULL: nothing is to be done. */
    void (*end)(struct device_unit *unit);

    uint64_t (*now)(const struct device_unit *unit);              /* the first us that is not yet done */
    void (*advance)(struct device_unit *unit, uint64_t us);       /* do the us now .. now + us - 1 */
    uint64_t (*next_event)(const struct device_unit *unit);       /* >= now: when something is due of itself; DEVICE_NEVER */
    /* The same for who runs a program to its end: without steps while the port has no `steps`, and without what goes on of
     * itself for ever. */
    uint64_t (*next_report)(const struct device_unit *unit);

    /* Ticks of the pulses that an axis makes now, if they are not all `pulse` long; called from within port->steps. NULL: they
     * are. */
    unsigned (*pulse_ticks)(const struct device_unit *unit, unsigned axis);

    /* How the outputs drive the motor of an axis now; false: they do not. A plant then follows port->outputs, not port->steps.
     * Called from within port->outputs, too. NULL: no axis is driven in this way. */
    bool (*coils)(const struct device_unit *unit, unsigned axis, struct device_coils *coils);

    /* The bus. `receive` NULL: the device has none; then none of these is called, nor framing(), and all may be NULL. */
    size_t (*receive)(struct device_unit *unit, const uint8_t *bytes, size_t length); /* returns how many it took */
    size_t (*send)(struct device_unit *unit, uint8_t *bytes, size_t room); /* bytes of its answer; 0: nothing now */
    /* At the present us a byte came whose stop bit was missing. NULL: the unit does not notice. */
    void (*lose_byte)(struct device_unit *unit);
    /* Has the line a pair of wires for each direction, as RS-232 has, with these settings: what the host sends and what a unit
     * answers do not collide? NULL: it has one, as RS485 has. */
    bool (*is_full_duplex)(const struct device_config *config);
    /* Requests that end with a silence: the us at which the silence that the unit waits for is over, if no byte comes before;
     * DEVICE_NEVER: it waits for none. At that us, before anything else happens in it, `receive` is called with 0 bytes: now it
     * is over, and silence_end() must be later. NULL: a byte ends each request. */
    uint64_t (*silence_end)(const struct device_unit *unit);
    bool (*has_answer)(const struct device_unit *unit);           /* is there an answer, now or later? */
    uint64_t (*answer_wait)(const struct device_unit *unit);      /* us until it can begin with that answer; 0: now */
    struct device_counters (*counters)(const struct device_unit *unit);
    /* Where the check value of the answer that is about to go out can be made wrong so that the frame stays as long: the byte *at
     * of the answer, bits *mask. Asked only if messages with these settings have one. */
    bool (*has_check_value)(const struct device_config *config);
    void (*find_check_value)(const struct device_unit *unit, uint32_t *at, uint8_t *mask);
    /* A message without framing at the present us, as if from the host. Returns the length of the answer, which may be more than
     * `room`; 0: none. NULL: not possible. */
    size_t (*exchange)(struct device_unit *unit, const uint8_t *message, size_t length, uint8_t *answer, size_t room);

    void (*set_inputs)(struct device_unit *unit, uint32_t mask);
    uint32_t (*inputs_of)(const struct device_unit *unit);
    uint32_t (*outputs_of)(const struct device_unit *unit);
    uint32_t (*variables_of)(const struct device_unit *unit);
    unsigned (*node)(const struct device_unit *unit);             /* the address, as read at power-up */
    void (*axis)(const struct device_unit *unit, unsigned axis, struct device_axis *state); /* 1..axes */

    /* What is planned of the present motion: the corners from the present us on, at most `room`; the last one has speed 0, unless
     * the motion is endless. Returns their number; 0: the axis does not move. NULL: there is no such plan. */
    size_t (*plan)(const struct device_unit *unit, unsigned axis, struct device_plan_point *point, size_t room);

    /* The command being executed, as text without an end. Returns its length; 0: none. NULL: an axis has
     * no program. */
    size_t (*command_text)(const struct device_unit *unit, unsigned axis, char text[DEVICE_COMMAND_SIZE]);

    /* The program of an axis: {first, commands}, the texts of its commands, the oldest first, and the place of that one from 1;
     * those that follow have the next places, after place `program` comes 1. New reference; NULL: out of memory. Itself NULL: an
     * axis has no program. */
    json_t *(*program_of)(const struct device_unit *unit, unsigned axis);

    /* A text from `set` or from the key `program:`, for an axis (0: all), at the present us. Returns 0; or a flag from 1, and a
     * message; DEVICE_TEXT_OVERFLOWS: it is taken, and fills the memory. NULL: it takes no texts. */
    int (*set_text)(struct device_unit *unit, unsigned axis, const char *text, size_t length, char error[DEVICE_ERROR_SIZE]);

    /* Do the settings have a program that set_text() with text NULL starts? NULL: no. */
    bool (*has_program)(const struct device_config *config);

    /* Does `text` have anything that a unit with these settings refuses? Then it is reported on `out` (NULL: none), as
     * NAME:LINE:COLUMN: error: … NULL: it takes no texts. */
    bool (*check_text)(const struct device_config *config, const char *name, const char *text, size_t length, FILE *out);

    /* Is there a fault, or does the axis wait for what only new commands can bring? Then the text says what. */
    bool (*is_stuck)(const struct device_unit *unit, unsigned axis, char text[DEVICE_ERROR_SIZE]);

    /* Names for people, conditions and traces; NULL after the last one. */
    const char *(*state_name)(unsigned state);
    const char *(*fault_name)(unsigned fault);
    const char *(*led_name)(unsigned led);

    /* JSON (docs/CONTROL.md, `state`), new references, NULL if out of memory. state: {t_us, motors: [{motor, position, state,
     * index, led, fault}], di, do, var}. describe: that, `true_position` null for each axis, `node`, and what else there is. */
    json_t *(*state)(const struct device_unit *unit, uint64_t t_us);
    json_t *(*describe)(const struct device_unit *unit, uint64_t t_us);

    /* What people may choose; the list ends with a row without name. Recordings have all settings: put writes them into a
     * recording's head, read reads the one called `settings[…]`, a list that ends with NULL; value NULL: it is not there. The
     * value must stay. Returns false and a message. unlike: what differs but for the node, in words; NULL: nothing. */
    const struct device_option *options; /* NULL: none */
    const struct device_readings *readings; /* NULL: none */
    const struct device_method *methods; /* NULL: none */
    const struct device_exchange *exchange_of; /* NULL: none */

    /* Numbers that conditions and subscriptions may name, as cells of an interface, which change in slots only (port->slot): what
     * find_cell() returns for a name is never 0 and valid as long as the unit's settings; 0 and a message: there is no such cell.
     * NULL: none. */
    uint64_t (*find_cell)(const struct device_unit *unit, const char *name, char error[DEVICE_ERROR_SIZE]);
    int64_t (*cell)(const struct device_unit *unit, uint64_t found);
    const struct device_service *services; /* ends with a row without name; NULL: none */
    const char *const *settings;
    void (*put_settings)(const struct device_config *config, json_t *object);
    bool (*read_setting)(struct device_config *config, const char *name, const json_t *value, char error[DEVICE_ERROR_SIZE]);
    const char *(*unlike)(const struct device_config *a, const struct device_config *b);

    /* Messages on the wires, for their monitor and a scenario's host: their bytes. */
    const struct device_framing *(*framing)(const struct device_config *config);
    const struct device_words *words; /* NULL: messages are shown as bytes */

    /* Does the state repeat without end? Called again and again with `memory`, `repeat_size` bytes, zero at first.
     * Returns after how many us it has repeated; 0: it has not. repeat_size 0: that is not known. */
    size_t repeat_size;
    uint64_t (*find_repeat)(void *memory, const struct device_unit *unit);

    /* Is the axis in a motion without an end of its own? Then the text says so: "is in an endless motion". */
    bool (*is_endless)(const struct device_unit *unit, unsigned axis, char text[DEVICE_ERROR_SIZE]);

    const struct device_coverage *coverage; /* NULL: not known */
};

/* The framing of messages with these settings; of a device without a bus one that finds none. */
const struct device_framing *device_framing_of(const struct device_kind *kind, const struct device_config *config);

/* The speed of the bus of units with these settings. */
unsigned device_baud(const struct device_kind *kind, const struct device_config *config);

/* us from the end of a request to its answer where nothing else is said. */
unsigned device_turnaround(const struct device_kind *kind);

/* The kind of this name, or the one at `at` from 0 on: NULL if there is none. */
const struct device_kind *device_kind_named(const char *name);
const struct device_kind *device_kind_at(unsigned at);

/* Writes the names of all kinds, "rkm04, fake", for messages. Returns `text`. */
const char *device_kind_names(char text[DEVICE_ERROR_SIZE]);

/* The number of an input, or output, from 1, by its name or number ("near", "3", "03"). Returns 0: there is none. */
unsigned device_input_named(const struct device_kind *kind, const char *name);
unsigned device_output_named(const struct device_kind *kind, const char *name);

/* What addresses of units are expected, for messages: "expected addresses from 1 to 16, as in 3 or 1,2,5-8, at most 16 units".
 * Returns `text`. */
const char *device_addresses(const struct device_kind *kind, char text[DEVICE_ERROR_SIZE]);

/* What inputs, or outputs, are expected, for messages: "1 to 8", "1 to 3 or near, home, z". Returns `text`. */
const char *device_input_names(const struct device_kind *kind, char text[DEVICE_ERROR_SIZE]);
const char *device_output_names(const struct device_kind *kind, char text[DEVICE_ERROR_SIZE]);

/* Bytes that the file of an option has at most. */
size_t device_option_file_max(const struct device_option *option);

/* The option of this name, or the one of this key of scenarios (`-` is `_`). NULL: the kind has none. */
const struct device_option *device_option_named(const struct device_kind *kind, const char *name);
const struct device_option *device_option_keyed(const struct device_kind *kind, const char *key);

/* Read a setting (`value`, NULL: it is not there) that stands for the content of the file of an option. Returns false and what
 * is wrong: the first message of the option's read_file(). */
bool device_read_content(const struct device_option *option, struct device_config *config, const json_t *value,
                         char error[DEVICE_ERROR_SIZE]);

/* ---- Command lines: device_arguments.c --------------------------------------------------------------------------------- */

struct argp; /* argp.h */
struct argp_state;

#define DEVICE_ARGUMENTS_MAX 64u /* values of options on a command line */

/* What a command line says about the device: --device, --device-option, and the options of kinds that are switches. */
struct device_arguments {
    unsigned without;     /* flags of options that are not offered */
    const char *own;      /* name of an option that the caller reads itself and hands on; NULL: none */
    /* Out, when the command line is read: */
    const struct device_kind *kind;
    struct device_config config; /* node is the caller's */
    /* Inside. */
    unsigned count;
    const char *name[DEVICE_ARGUMENTS_MAX], *value[DEVICE_ARGUMENTS_MAX];
    char *text[DEVICE_ARGUMENTS_MAX]; /* of files */
};

/* The parser, for argp_option.children; its input (state->child_inputs) is a struct device_arguments, of which the first part is
 * set. The values are read when all are there; what is wrong is a usage error. */
const struct argp *device_arguments_argp(struct device_arguments *arguments);

/* As if the command line had --NAME VALUE; before the end of the parse. */
void device_arguments_add(struct device_arguments *arguments, const char *name, const char *value, struct argp_state *state);

/* Free the texts. Units and configs must not be used any more. */
void device_arguments_free(struct device_arguments *arguments);

/* --backup FILE is for kinds whose flash is a backup memory: a usage error for others. has_flash: there is --flash, too. */
void device_arguments_check_backup(const struct device_kind *kind, bool has_flash, const struct argp_state *state);

/* The kind that is meant where none is named: the RKM04. Its settings as they lie in a config; `node` is that of the config. */
extern const struct device_kind rkm04_device;
extern const struct device_kind cib_device;
struct rkm04_config rkm04_settings(const struct device_config *config);

/* Put them there; the node of the config stays. */
void rkm04_settings_put(struct device_config *config, const struct rkm04_config *settings);

/* A config with them and their node. */
struct device_config rkm04_device_config(const struct rkm04_config *settings);

/* The other kinds. */
extern const struct device_kind pmc_1hs_device, pmc_2hs_device, cnc872_device;

#endif
