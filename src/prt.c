/* SPDX-License-Identifier: MIT */
#include "prt.h"

#include "interp.h"
#include "profile.h"
#include "program.h"
#include "reading.h"
#include "store.h"

enum message {
    MESSAGE_VERSION = 1,
    MESSAGE_SET_COMMAND = 2,
    MESSAGE_STORE_FLASH = 3,
    MESSAGE_GET_POSITION = 4,
    MESSAGE_GET_COMMAND = 5,
    MESSAGE_GET_TABLE = 6,
    MESSAGE_GET_PROGRESS = 7,
    MESSAGE_UNKNOWN = 255
};

/* What follows the head of an answer. */
enum answer_kind { ANSWER_NONE, ANSWER_HEAD_ONLY, ANSWER_VERSION, ANSWER_PROGRAM, ANSWER_TABLE };

enum flag { FLAG_RIGHT = 0, FLAG_BAD_VALUE = 1, FLAG_UNKNOWN = 2, FLAG_OVERFLOW = 3 };

/* ---- Set Command ------------------------------------------------------------------------------------------------------ */

/* What a text turned out to be. */
struct text {
    struct rkm04_reader program; /* after the last `\`, or at the beginning */
    struct rkm04_command sole;   /* the command, if there is just one */
    unsigned commands; /* one that is not to be taken as alone counts twice */
    bool reset;
    uint8_t character; /* what is wrong, with FLAG_BAD_VALUE and FLAG_UNKNOWN */
};

/* First stage: read all, change nothing. */
static enum flag check_text(const struct rkm04_unit *unit, const uint8_t *bytes, size_t length, struct text *text)
{
    struct rkm04_reader reader;
    *text = (struct text){.commands = 0};
    rkm04_read_begin(&reader, bytes, length);
    text->program = reader;
    for (;;) {
        struct rkm04_command command;
        enum rkm04_read found = rkm04_read(&reader, &command);
        if (found == RKM04_READ_END)
            return FLAG_RIGHT;
        if (found != RKM04_READ_COMMAND) {
            text->character = bytes[reader.start];
            return found == RKM04_READ_BAD_VALUE ? FLAG_BAD_VALUE : FLAG_UNKNOWN;
        }
        text->commands++;
        if (READING(unit, v_alone) && (reader.start | (length - reader.at)) != 0) /* blanks, or another command */
            text->commands++;
        text->sole = command;
        if (command.op == '\\') {
            text->reset = true;
            text->program = reader;
        } else if (READING(unit, negative_position) && command.op == '=' && command.argument > INT32_MAX) {
            text->character = '=';
            return FLAG_BAD_VALUE;
        }
    }
}

static bool is_request(struct rkm04_command command)
{
    return command.op == 'K' || (command.op == 'C' && command.argument == 75);
}

/* Store a command, unless the memory is full and kept (T40). Returns false then. *flag: it was full. */
static bool store_command(struct rkm04_motor *motor, struct rkm04_command command, enum flag *flag)
{
    if (program_count(&motor->program) == RKM04_PROGRAM_MAX) {
        *flag = FLAG_OVERFLOW;
        if (motor->keep)
            return false;
    }
    program_append(&motor->program, command);
    return true;
}

/* Store a checked text in the memory of these motors, bit 0 is motor 1; it is read once. */
static enum flag store_text(struct rkm04_unit *unit, uint8_t motors, struct rkm04_reader reader)
{
    struct rkm04_command command;
    enum flag flag = FLAG_RIGHT;
    uint64_t first[RKM04_MOTORS];
    uint8_t open = motors;
    for (unsigned i = 0; i < RKM04_MOTORS; i++)
        first[i] = unit->motor[i].program.written;
    while (open != 0 && rkm04_read(&reader, &command) == RKM04_READ_COMMAND) {
        if (is_request(command)) /* ignored inside a longer text (C3) */
            continue;
        for (unsigned i = 0; i < RKM04_MOTORS; i++)
            if ((open >> i & 1) != 0 && !store_command(&unit->motor[i], command, &flag))
                open = (uint8_t)(open & ~(1u << i));
    }
    for (unsigned i = 0; i < RKM04_MOTORS; i++)
        if (unit->motor[i].program.written != first[i])
            interp_note_stored(unit, &unit->motor[i], first[i]);
    return flag;
}

/* Obey a text for one motor, which decides for itself (P3). Returns false if there is nothing to be stored. */
static bool execute_text(struct rkm04_unit *unit, struct rkm04_motor *motor, const struct text *text)
{
    if (text->commands == 1 && is_request(text->sole)) {
        interp_request(motor, (char)text->sole.op);
        return false;
    }
    if (text->commands == 1 && text->sole.op == 'V' && interp_change_speed(unit, motor, (uint16_t)text->sole.argument))
        return false;
    if (text->reset)
        interp_reset(unit, motor);
    return true;
}

static bool is_motor(uint8_t character)
{
    return character >= '0' && character <= '0' + RKM04_MOTORS;
}

int prt_set_command(struct rkm04_unit *unit, uint8_t motor, const uint8_t *bytes, size_t length, uint8_t *character)
{
    struct text text;
    *character = 0;
    if (!is_motor(motor)) {
        *character = motor;
        return FLAG_BAD_VALUE;
    }
    enum flag flag = check_text(unit, bytes, length, &text);
    if (flag != FLAG_RIGHT) {
        *character = text.character;
        return (int)flag;
    }
    unit->touched = true;
    uint8_t storing = 0;
    for (unsigned i = 0; i < RKM04_MOTORS; i++)
        if ((motor == '0' || motor == '1' + i) && execute_text(unit, &unit->motor[i], &text))
            storing = (uint8_t)(storing | 1u << i);
    return (int)store_text(unit, storing, text.program);
}

/* ---- Answers ------------------------------------------------------------------------------------------------------------ */

static void put(struct rkm04_answer *answer, uint8_t byte)
{
    answer->byte[answer->head++] = byte;
}

static void put_text(struct rkm04_answer *answer, const char *text)
{
    while (*text)
        put(answer, (uint8_t)*text++);
}

/* Decimal digits of a number at `text`. Returns their count, 1..10. */
static uint8_t digits(uint32_t number, uint8_t *text)
{
    uint8_t count = 1;
    for (uint32_t rest = number; rest >= 10; rest /= 10)
        count++;
    for (uint8_t i = count; i-- > 0; number /= 10)
        text[i] = (uint8_t)('0' + number % 10);
    return count;
}

static void put_number(struct rkm04_answer *answer, uint32_t number)
{
    answer->head = (uint8_t)(answer->head + digits(number, answer->byte + answer->head));
}

/* Length byte and the counter, right-aligned in 10 characters or 11. */
static void put_position(struct rkm04_answer *answer, int32_t position)
{
    const uint8_t width = 10;
    uint8_t text[10];
    bool negative = position < 0;
    uint8_t count = digits(negative ? 0u - (uint32_t)position : (uint32_t)position, text);
    uint8_t length = (uint8_t)(count + negative);
    put(answer, length > width ? length : width);
    for (; length < width; length++)
        put(answer, ' ');
    if (negative)
        put(answer, '-');
    for (uint8_t i = 0; i < count; i++)
        put(answer, text[i]);
}

/* The break points as they are now, so that the answer does not change while it goes out (P7). */
static void store_table(const struct rkm04_motor *motor, struct rkm04_answer *answer)
{
    struct profile_point point;
    answer->points = 0;
    if (motor->motion.kind == RKM04_MOTION_NONE)
        return;
    for (unsigned i = 0; profile_point(&motor->motion, i, &point); i++) {
        if (answer->points > 0 && answer->point[answer->points - 1].step == point.step &&
            answer->point[answer->points - 1].speed == point.speed)
            continue;
        answer->point[answer->points].step = point.step;
        answer->point[answer->points].speed = (uint16_t)point.speed;
        answer->points++;
    }
}

static void answer_about_motor(const struct rkm04_unit *unit, struct rkm04_answer *answer, uint8_t message, uint8_t motor)
{
    put(answer, motor);
    if (motor == '0' && message == MESSAGE_GET_POSITION) {
        for (unsigned i = 0; i < RKM04_MOTORS; i++)
            put_position(answer, unit->motor[i].position);
        return;
    }
    if (!is_motor(motor) || motor == '0') {
        put_text(answer, "ERROR COMMAND! ");
        return;
    }
    answer->motor = (uint8_t)(motor - '0');
    const struct rkm04_motor *of = &unit->motor[answer->motor - 1];
    if (message == MESSAGE_GET_POSITION) {
        put_position(answer, of->position);
    } else if (message == MESSAGE_GET_COMMAND) {
        answer->kind = ANSWER_PROGRAM;
    } else if (message == MESSAGE_GET_TABLE) {
        answer->kind = ANSWER_TABLE;
        store_table(of, answer);
        put(answer, ' ');
        put_number(answer, answer->points);
        put_text(answer, ";[");
    } else {
        put(answer, ' ');
        put_number(answer, of->motion.kind == RKM04_MOTION_NONE ? 0 : of->motion.done);
        put_text(answer, "; ");
        put_number(answer, interp_index(of));
    }
}

static uint8_t store_flash(struct rkm04_unit *unit, uint8_t motor)
{
    uint8_t error = 0;
    if (!is_motor(motor))
        return 1;
    if (READING(unit, store_time) != 0) {
        unit->busy = (uint16_t)(READING(unit, store_time) + 1); /* the slot at or after now counts, too */
        unit->touched = true;
    }
    for (unsigned i = 0; i < RKM04_MOTORS; i++) {
        if (motor != '0' && motor != '1' + i)
            continue;
        int one = store_save(unit->port, unit->context, i + 1, &unit->motor[i].program);
        if (one == 0)
            unit->motor[i].slot = program_count(&unit->motor[i].program) > 0 ? RKM04_SLOT_STORED : RKM04_SLOT_EMPTY;
        if (error == 0)
            error = (uint8_t)one;
    }
    return error;
}

void prt_handle(struct rkm04_unit *unit, const uint8_t *message, size_t length, uint8_t from, bool broadcast)
{
    struct rkm04_answer *answer = &unit->answer;
    if (length == 0)
        return;
    uint8_t number = message[0], motor = length > 1 ? message[1] : '0', character;
    *answer = (struct rkm04_answer){.kind = ANSWER_HEAD_ONLY, .to = from};
    put(answer, number);
    switch (number) {
    case MESSAGE_VERSION:
        answer->kind = ANSWER_VERSION;
        break;
    case MESSAGE_SET_COMMAND:
        put(answer, motor);
        if (length > 1) {
            put(answer, (uint8_t)prt_set_command(unit, motor, message + 2, length - 2, &character));
        } else {
            put(answer, FLAG_BAD_VALUE);
            character = 0;
        }
        put(answer, character);
        break;
    case MESSAGE_STORE_FLASH:
        put(answer, motor);
        put(answer, length > 1 ? store_flash(unit, motor) : 1);
        break;
    case MESSAGE_GET_POSITION:
    case MESSAGE_GET_COMMAND:
    case MESSAGE_GET_TABLE:
    case MESSAGE_GET_PROGRESS:
        answer_about_motor(unit, answer, number, length > 1 ? motor : 0);
        if (length == 1)
            answer->byte[1] = '0';
        break;
    default:
        answer->byte[0] = MESSAGE_UNKNOWN;
        put(answer, number);
        put(answer, 0);
        put(answer, 0);
        break;
    }
    if (broadcast)
        answer->kind = ANSWER_NONE;
}

/* ---- Sending it byte by byte ---------------------------------------------------------------------------------------------- */

static const char *version_text(const struct rkm04_unit *unit)
{
    return unit->config.version_text ? unit->config.version_text : RKM04_VERSION_TEXT;
}

/* One command of a program; a blank between two. */
static bool program_chunk(const struct rkm04_unit *unit, struct rkm04_answer *answer)
{
    const struct rkm04_program *program = &unit->motor[answer->motor - 1].program;
    if (answer->at >= program_count(program))
        return false;
    char text[RKM04_COMMAND_TEXT_MAX];
    size_t length = rkm04_format(program_at(program, program_oldest(program) + answer->at), text);
    uint8_t *to = answer->chunk;
    if (answer->at > 0)
        *to++ = ' ';
    for (size_t i = 0; i < length; i++)
        *to++ = (uint8_t)text[i];
    answer->chunk_length = (uint8_t)(to - answer->chunk);
    return true;
}

/* One point of a table; after the last one the closing bracket. */
static bool table_chunk(struct rkm04_answer *answer)
{
    uint8_t *to = answer->chunk;
    if (answer->at > answer->points)
        return false;
    if (answer->at == answer->points) {
        *to++ = ']';
    } else {
        if (answer->at > 0)
            *to++ = ',';
        *to++ = '(';
        to += digits(answer->point[answer->at].step, to);
        *to++ = ';';
        to += digits(answer->point[answer->at].speed, to);
        *to++ = ')';
    }
    answer->chunk_length = (uint8_t)(to - answer->chunk);
    return true;
}

/* The version text: its length byte, then character by character. */
static bool version_chunk(const struct rkm04_unit *unit, struct rkm04_answer *answer)
{
    const char *text = version_text(unit);
    size_t length = 0;
    while (length < 255 && text[length])
        length++;
    if (answer->at > length)
        return false;
    answer->chunk[0] = answer->at == 0 ? (uint8_t)length : (uint8_t)text[answer->at - 1];
    answer->chunk_length = 1;
    return true;
}

static bool next_chunk(const struct rkm04_unit *unit, struct rkm04_answer *answer)
{
    bool more = false;
    if (answer->kind == ANSWER_PROGRAM)
        more = program_chunk(unit, answer);
    else if (answer->kind == ANSWER_TABLE)
        more = table_chunk(answer);
    else if (answer->kind == ANSWER_VERSION)
        more = version_chunk(unit, answer);
    answer->chunk_at = 0;
    if (more)
        answer->at++;
    return more;
}

bool prt_answer_byte(const struct rkm04_unit *unit, struct rkm04_answer *answer, uint8_t *byte)
{
    if (answer->head_at < answer->head) {
        *byte = answer->byte[answer->head_at++];
        return true;
    }
    if (answer->chunk_at == answer->chunk_length && !next_chunk(unit, answer))
        return false;
    *byte = answer->chunk[answer->chunk_at++];
    return true;
}

size_t prt_answer_length(const struct rkm04_unit *unit, const struct rkm04_answer *answer)
{
    struct rkm04_answer dry = *answer;
    size_t length = 0;
    uint8_t byte;
    while (prt_answer_byte(unit, &dry, &byte))
        length++;
    return length;
}
