/* SPDX-License-Identifier: MIT */
/* What clients can use of an RKM04, and what of it they have used: the list is derived from the core's own tables, so a new
 * command is in it by itself. */
#include <string.h>

#include "coverage.h"
#include "rkm04_device.h"

#define SET_COMMAND 2
#define STORE_FLASH 3
#define HEAD 2                             /* bytes before the text of Set Command, and before an error text (P5) */
#define ERROR_TEXT "ERROR COMMAND! "
#define FLAGS 4
#define COMMENT '{'

/* Which message a thing of the group COVERAGE_MESSAGES is about, and to whom. */
enum address { TO_UNIT, TO_ALL_MOTORS, TO_ONE_MOTOR, BROADCAST };
#define MESSAGE_KEY(number, address) ((uint32_t)(number) << 8 | (address))
#define UNKNOWN 0 /* stands for all numbers that the unit does not know */

static const struct message {
    const char *name;
    bool has_motor;
    bool broadcast; /* is executed when it goes to all units; the others do nothing then (P10) */
    bool error;     /* may be answered with ERROR COMMAND! (P4, P5) */
} messages[] = {
    [UNKNOWN] = {"unknown message", false, false, false},
    [1] = {"1 Version", false, false, false},
    [SET_COMMAND] = {"2 Set Command", true, true, false},
    [STORE_FLASH] = {"3 Store Flash", true, true, false},
    [4] = {"4 Get Position", true, false, true},
    [5] = {"5 Get Command", true, false, true},
    [6] = {"6 Get Tabul Run", true, false, true},
    [7] = {"7 Get Pozic Run", true, false, true},
};
#define MESSAGES (sizeof messages / sizeof messages[0])

/* The functions that do something, each kind by itself; 42..50 are accepted and have no effect (C10-C12). */
static const struct rkm04_range functions[] = {{40, 40}, {41, 41}, {51, 58}};

/* ---- The list ----------------------------------------------------------------------------------------------------- */

static void add_messages(struct coverage *coverage)
{
    for (unsigned number = 1; number < MESSAGES; number++) {
        const struct message *message = &messages[number];
        if (!message->has_motor)
            coverage_add(coverage, COVERAGE_MESSAGES, MESSAGE_KEY(number, TO_UNIT), "%s", message->name);
        if (message->has_motor) {
            coverage_add(coverage, COVERAGE_MESSAGES, MESSAGE_KEY(number, TO_ALL_MOTORS), "%s, motor 0", message->name);
            coverage_add(coverage, COVERAGE_MESSAGES, MESSAGE_KEY(number, TO_ONE_MOTOR), "%s, motor 1..%d", message->name,
                         RKM04_MOTORS);
        }
        if (message->broadcast)
            coverage_add(coverage, COVERAGE_MESSAGES, MESSAGE_KEY(number, BROADCAST), "%s, broadcast", message->name);
    }
    coverage_add(coverage, COVERAGE_MESSAGES, MESSAGE_KEY(UNKNOWN, TO_UNIT), "%s", messages[UNKNOWN].name);
}

/* K, C75 and V mean one thing as the only command of a message and another in a longer text (C3, C4). */
static bool depends_on_place(struct rkm04_command command)
{
    return command.op == 'K' || command.op == 'V' || (command.op == 'C' && command.argument == 75);
}

/* Commands from `low` to `high`: the same character, arguments of one range. */
static void add_command(struct coverage *coverage, struct rkm04_command low, struct rkm04_command high, int64_t first,
                        int64_t last, unsigned level)
{
    char from[RKM04_COMMAND_TEXT_MAX], to[RKM04_COMMAND_TEXT_MAX];
    int from_length = (int)rkm04_format(low, from), to_length = (int)rkm04_format(high, to);
    bool one = low.argument == high.argument;
    for (enum coverage_place place = COVERAGE_ANYWHERE; place <= COVERAGE_INSIDE; place++) {
        static const char *const where[] = {"", " alone", " in a text"};
        if ((place != COVERAGE_ANYWHERE) != depends_on_place(low))
            continue;
        struct coverage_item *item = coverage_add(coverage, COVERAGE_COMMANDS, low.op, "%.*s%s%.*s%s", from_length, from,
                                                  one ? "" : "..", one ? 0 : to_length, to, where[place]);
        item->place = (uint8_t)place;
        item->low = first;
        item->high = last;
        item->level = (uint8_t)level;
    }
}

static void add_range(struct coverage *coverage, uint8_t op, int64_t low, int64_t high)
{
    add_command(coverage, (struct rkm04_command){op, (uint32_t)low}, (struct rkm04_command){op, (uint32_t)high}, low, high, 0);
}

/* One range of a command with a number; that of the functions by their kinds. */
static void add_number(struct coverage *coverage, uint8_t op, struct rkm04_range range)
{
    const size_t kinds = sizeof functions / sizeof functions[0];
    bool of_functions = (op == 'C' || op == 'T') && range.low == functions[0].low;
    for (size_t i = 0; of_functions && i < kinds; i++)
        add_range(coverage, op, functions[i].low, functions[i].high);
    if (!of_functions)
        add_range(coverage, op, range.low, range.high);
}

static void add_jump_if(struct coverage *coverage, uint8_t op, struct rkm04_range bit, struct rkm04_range label)
{
    for (unsigned level = 0; level <= 1; level++) {
        struct rkm04_command low = {op, (uint32_t)bit.low | level << 8 | (uint32_t)label.low << 16};
        struct rkm04_command high = {op, (uint32_t)bit.high | level << 8 | (uint32_t)label.high << 16};
        add_command(coverage, low, high, bit.low, bit.high, level);
    }
}

/* All forms of the command `op`. */
static void add_forms(struct coverage *coverage, uint8_t op, enum rkm04_form form, const struct rkm04_range *ranges, int count)
{
    if (form == RKM04_FORM_NONE)
        add_range(coverage, op, 0, 0);
    if (form == RKM04_FORM_JUMP_IF) {
        for (int i = 0; i < count - 1; i++)
            add_jump_if(coverage, op, ranges[i], ranges[count - 1]);
    }
    for (int i = 0; (form == RKM04_FORM_NUMBER || form == RKM04_FORM_ABSOLUTE) && i < count; i++)
        add_number(coverage, op, ranges[i]);
    if (form == RKM04_FORM_ABSOLUTE) {
        add_range(coverage, op, RKM04_G_FORWARD, RKM04_G_FORWARD);
        add_range(coverage, op, RKM04_G_BACK, RKM04_G_BACK);
    }
    if (form == RKM04_FORM_SIGNED) {
        add_range(coverage, op, 0, ranges[0].high);
        add_range(coverage, op, ranges[0].low, -1);
    }
}

/* What the reader would give for a command; other spellings of the call have a form as well, but are not canonical. */
static bool is_canonical(uint8_t op)
{
    const char text[] = {(char)op, '0', '1', 'H', '1'};
    struct rkm04_reader reader;
    struct rkm04_command command = {.op = op};
    rkm04_read_begin(&reader, text, sizeof text);
    rkm04_read(&reader, &command);
    return command.op == op;
}

static void add_commands(struct coverage *coverage)
{
    for (unsigned op = 0; op <= UINT8_MAX; op++) {
        enum rkm04_form form;
        struct rkm04_range ranges[RKM04_RANGES_MAX];
        int count = rkm04_form_of((uint8_t)op, &form, ranges);
        if (count >= 0 && is_canonical((uint8_t)op))
            add_forms(coverage, (uint8_t)op, form, ranges, count);
    }
    coverage_add(coverage, COVERAGE_COMMANDS, COMMENT, "{ comment }");
}

static void begin(struct coverage *coverage, const struct device_config *config)
{
    static const char *const meaning[FLAGS] = {"ok", "bad value", "unknown command", "memory overflowed"};
    const struct rkm04_config settings = rkm04_settings(config);
    coverage->items = 0;
    add_messages(coverage);
    for (unsigned motor = 1; motor <= RKM04_MOTORS; motor++)
        coverage_add(coverage, COVERAGE_MOTORS, motor, "motor %u", motor);
    add_commands(coverage);
    for (unsigned flag = 0; flag < FLAGS; flag++)
        coverage_add(coverage, COVERAGE_FLAGS, flag, "flag %u, %s", flag, meaning[flag]);
    coverage_add(coverage, COVERAGE_ERRORS, MESSAGE_KEY(STORE_FLASH, 0), "%s, written", messages[STORE_FLASH].name);
    coverage_add(coverage, COVERAGE_ERRORS, MESSAGE_KEY(STORE_FLASH, 1), "%s, not written", messages[STORE_FLASH].name);
    for (unsigned number = 1; number < MESSAGES; number++)
        if (messages[number].error)
            coverage_add(coverage, COVERAGE_ERRORS, MESSAGE_KEY(number, 1), "%s, ERROR COMMAND!", messages[number].name);
    for (unsigned fault = RKM04_FAULT_NONE + 1; fault <= RKM04_FAULT_MOTION; fault++)
        if (fault != RKM04_FAULT_NO_LABEL || settings.readings.label == RKM04_LABEL_FAULT)
            coverage_add(coverage, COVERAGE_FAULTS, fault, "%s", rkm04_fault_name((enum rkm04_fault)fault));
}

/* ---- Counting ------------------------------------------------------------------------------------------------------- */

static void count_command(struct coverage *coverage, struct rkm04_command command, bool alone)
{
    enum rkm04_form form = RKM04_FORM_NONE;
    struct rkm04_range ranges[RKM04_RANGES_MAX];
    rkm04_form_of(command.op, &form, ranges);
    int64_t value = command.argument;
    unsigned level = 0;
    if (form == RKM04_FORM_SIGNED && value > INT32_MAX)
        value -= INT64_C(1) << 32;
    if (form == RKM04_FORM_JUMP_IF) {
        level = command.argument >> 8 & 1;
        value = command.argument & 0xFF;
    }
    for (size_t i = 0; i < coverage->items; i++) {
        struct coverage_item *item = &coverage->item[i];
        if (item->group == COVERAGE_COMMANDS && item->key == command.op && item->level == level && item->low <= value &&
            value <= item->high && item->place != (alone ? COVERAGE_INSIDE : COVERAGE_ALONE))
            item->count++;
    }
}

/* The text of Set Command: it counts only if all of it is right (P2), and from the last `\` on: what is before is dropped
 * (C1). */
static void count_text(struct coverage *coverage, const uint8_t *text, size_t length)
{
    struct rkm04_reader reader, from;
    struct rkm04_command command, reset = {.op = 0};
    enum rkm04_read found;
    unsigned commands = 0;
    rkm04_read_begin(&reader, text, length);
    from = reader;
    while ((found = rkm04_read(&reader, &command)) == RKM04_READ_COMMAND) {
        commands++;
        if (command.op == '\\') {
            reset = command;
            from = reader;
        }
    }
    if (found != RKM04_READ_END)
        return;
    if (length > 0 && memchr(text, COMMENT, length) != NULL)
        coverage_count(coverage, COVERAGE_COMMANDS, COMMENT);
    if (reset.op != 0)
        count_command(coverage, reset, false);
    while (rkm04_read(&from, &command) == RKM04_READ_COMMAND)
        count_command(coverage, command, commands == 1);
}

static void count_request(struct coverage *coverage, uint8_t dnode, const uint8_t *message, size_t length)
{
    if (length == 0)
        return;
    unsigned number = message[0] < MESSAGES ? message[0] : UNKNOWN;
    const struct message *known = &messages[number];
    if (dnode == 0 && !known->broadcast)
        return;
    if (!known->has_motor) {
        coverage_count(coverage, COVERAGE_MESSAGES, MESSAGE_KEY(number, TO_UNIT));
        return;
    }
    if (length < HEAD || message[1] < '0' || message[1] > '0' + RKM04_MOTORS)
        return;
    uint32_t motor = (uint32_t)message[1] - '0';
    coverage_count(coverage, COVERAGE_MESSAGES, MESSAGE_KEY(number, motor == 0 ? TO_ALL_MOTORS : TO_ONE_MOTOR));
    if (dnode == 0)
        coverage_count(coverage, COVERAGE_MESSAGES, MESSAGE_KEY(number, BROADCAST));
    coverage_count(coverage, COVERAGE_MOTORS, motor);
    if (number == SET_COMMAND)
        count_text(coverage, message + HEAD, length - HEAD);
}

static void count_answer(struct coverage *coverage, const uint8_t *message, size_t length)
{
    if (length <= HEAD || message[0] >= MESSAGES)
        return;
    unsigned number = message[0];
    if (number == SET_COMMAND)
        coverage_count(coverage, COVERAGE_FLAGS, message[HEAD]);
    if (number == STORE_FLASH)
        coverage_count(coverage, COVERAGE_ERRORS, MESSAGE_KEY(number, message[HEAD] != 0));
    if (messages[number].error && length == HEAD + strlen(ERROR_TEXT) &&
        memcmp(message + HEAD, ERROR_TEXT, strlen(ERROR_TEXT)) == 0)
        coverage_count(coverage, COVERAGE_ERRORS, MESSAGE_KEY(number, 1));
}

static void count_fault(struct coverage *coverage, unsigned fault)
{
    coverage_count(coverage, COVERAGE_FAULTS, fault);
}

const struct device_coverage rkm04_coverage = {
    .begin = begin, .request = count_request, .answer = count_answer, .fault = count_fault};
