/* SPDX-License-Identifier: MIT */
#include "client_condition.h"

#include <errno.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "text/text.h"

#define NAME_MAX_LENGTH 48
#define VALUE_MAX_LENGTH 48
#define MOTORS_MAX 16 /* the emulator knows how many there are */
#define NAME_CHARACTERS "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_.+-[]"
#define MOTOR_NAMES "position, true, steps, index, commands, state, led, fault or idle"
#define EXPECTED_NAME "m1." MOTOR_NAMES "; idle, do1, di1, var80, cell.NAME, powered, message, dropped or t"

struct reader {
    const char *at;
    const char *unit; /* of terms that name none; "": not named either */
    char *wrong;
};

/* One term, taken apart. */
struct term {
    char name[NAME_MAX_LENGTH];
    char compare[3]; /* "": none */
    char value[VALUE_MAX_LENGTH];
};

static json_t *report_expected(const struct reader *reader, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Report what was expected. Always returns NULL. */
static json_t *report_expected(const struct reader *reader, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    int length = snprintf(reader->wrong, CLIENT_CONDITION_WRONG_SIZE, "expected ");
    vsnprintf(reader->wrong + length, CLIENT_CONDITION_WRONG_SIZE - (size_t)length, format, arguments);
    va_end(arguments);
    return NULL;
}

static json_t *no_memory(const struct reader *reader, json_t *json)
{
    if (json == NULL)
        snprintf(reader->wrong, CLIENT_CONDITION_WRONG_SIZE, "%s", strerror(ENOMEM));
    return json;
}

/* The only one of a list, or {key: list}. Takes the reference. */
static json_t *one_or_list(const struct reader *reader, json_t *list, const char *key)
{
    if (json_array_size(list) > 1)
        return no_memory(reader, json_pack("{s:o}", key, list));
    json_t *only = json_incref(json_array_get(list, 0));
    json_decref(list);
    return only;
}

/* ---- Words ---------------------------------------------------------------------------------------------------------- */

static void skip_blanks(struct reader *reader)
{
    reader->at += strspn(reader->at, " \t\n");
}

/* Take the connective `word` or `sign` if it is next. */
static bool accept_word(struct reader *reader, const char *word, const char *sign)
{
    skip_blanks(reader);
    size_t length = strlen(word);
    if (strncmp(reader->at, sign, strlen(sign)) == 0)
        reader->at += strlen(sign);
    else if (strncmp(reader->at, word, length) == 0 && strcspn(reader->at + length, " \t\n") == 0)
        reader->at += length;
    else
        return false;
    return true;
}

/* Take characters of `set`, at most room - 1. Returns false if there are none, or more. */
static bool accept_span(struct reader *reader, const char *set, char *text, size_t room)
{
    size_t length = strspn(reader->at, set);
    if (length == 0 || length >= room)
        return false;
    memcpy(text, reader->at, length);
    text[length] = '\0';
    reader->at += length;
    return true;
}

static bool accept_comparison(struct reader *reader, char compare[3])
{
    static const char *const signs[] = {">=", "<=", "!=", "==", ">", "<", "="};
    for (size_t i = 0; i < sizeof signs / sizeof *signs; i++) {
        if (strncmp(reader->at, signs[i], strlen(signs[i])) == 0) {
            reader->at += strlen(signs[i]);
            strcpy(compare, strcmp(signs[i], "==") == 0 ? "=" : signs[i]);
            return true;
        }
    }
    return false;
}

static bool scan_term(struct reader *reader, struct term *term)
{
    skip_blanks(reader);
    const char *from = reader->at;
    if (!accept_span(reader, NAME_CHARACTERS, term->name, sizeof term->name)) {
        report_expected(reader, "a condition such as m1.position>=5000, do3=1 or idle, found '%.40s'", from);
        return false;
    }
    skip_blanks(reader);
    term->compare[0] = term->value[0] = '\0';
    if (!accept_comparison(reader, term->compare))
        return true;
    skip_blanks(reader);
    if (accept_span(reader, NAME_CHARACTERS, term->value, sizeof term->value))
        return true;
    report_expected(reader, "a value after %s%s, found '%.40s'", term->name, term->compare, reader->at);
    return false;
}

/* ---- Values --------------------------------------------------------------------------------------------------------- */

static bool read_number(const char *text, int64_t *number)
{
    return number_read_signed(text, INT64_MIN, INT64_MAX, number);
}

/* The number after `word` in a name, low..high, at most two digits; -1: the name is another. */
static int number_behind(const char *name, const char *word, int low, int high)
{
    size_t length = strlen(word);
    uint64_t number;
    if (strncmp(name, word, length) != 0)
        return -1;
    name += length;
    return strlen(name) <= 2 && number_read(name, (uint64_t)low, (uint64_t)high, &number) ? (int)number : -1;
}

/* The value as it is, or {">=": value}. Takes the reference. */
static json_t *make_comparison(const struct term *term, json_t *value)
{
    return strcmp(term->compare, "=") == 0 ? value : json_pack("{s:o}", term->compare, value);
}

static json_t *read_integer(const struct reader *reader, const struct term *term)
{
    int64_t number;
    if (term->compare[0] == '\0')
        return report_expected(reader, "a comparison after %s, as in %s>=5000", term->name, term->name);
    if (!read_number(term->value, &number))
        return report_expected(reader, "a whole number after %s%s, found '%s'", term->name, term->compare, term->value);
    return no_memory(reader, make_comparison(term, json_integer(number)));
}

/* The name of a state, LED or fault. Which ones there are the emulator knows. */
static json_t *word_term(const struct reader *reader, const struct term *term, const char *key, int motor)
{
    if (strcmp(term->compare, "=") != 0 && strcmp(term->compare, "!=") != 0)
        return report_expected(reader, "= or != and a word after %s, found '%s%s'", term->name, term->compare, term->value);
    json_t *value = make_comparison(term, json_string(term->value));
    return no_memory(reader, json_pack("{s:i, s:o}", "motor", motor, key, value));
}

/* A time with its unit, or a number of us. */
static json_t *read_time(const struct reader *reader, const struct term *term)
{
    int64_t number;
    if (term->compare[0] == '\0')
        return report_expected(reader, "t>= and a time, as in t>=2.5s");
    json_t *value = read_number(term->value, &number) ? json_integer(number) : json_string(term->value);
    return no_memory(reader, make_comparison(term, value));
}

/* 0 or 1; 1 if the value may be left out and is. Returns -1 if it is none of them: reported. */
static int read_bit(const struct reader *reader, const struct term *term, bool bare)
{
    if (bare && term->compare[0] == '\0')
        return 1;
    bool right = strcmp(term->value, "0") == 0 || strcmp(term->value, "1") == 0;
    bool equal = strcmp(term->compare, "=") == 0;
    if (right && (equal || strcmp(term->compare, "!=") == 0))
        return (term->value[0] == '1') == equal;
    report_expected(reader, "%s=0 or %s=1, found '%s%s%s'", term->name, term->name, term->name, term->compare, term->value);
    return -1;
}

/* ---- Terms ---------------------------------------------------------------------------------------------------------- */

/* What holds of motor `motor`; `name` is what follows "m1.". */
static json_t *motor_term(const struct reader *reader, const struct term *term, const char *name, int motor)
{
    static const struct {
        const char *name, *key;
    } numbers[] = {{"position", "position"}, {"true", "true_position"}, {"true_position", "true_position"},
                   {"steps", "steps"}, {"index", "index"}, {"commands", "commands"}};
    if (strcmp(name, "idle") == 0) {
        int bit = read_bit(reader, term, true);
        return bit < 0 ? NULL : no_memory(reader, json_pack("{s:i, s:b}", "motor", motor, "idle", bit));
    }
    if (strcmp(name, "state") == 0 || strcmp(name, "led") == 0 || strcmp(name, "fault") == 0)
        return word_term(reader, term, name, motor);
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        if (strcmp(name, numbers[i].name) != 0)
            continue;
        json_t *value = read_integer(reader, term);
        return value == NULL ? NULL : no_memory(reader, json_pack("{s:i, s:o}", "motor", motor, numbers[i].key, value));
    }
    return report_expected(reader, "m%d." MOTOR_NAMES ", found '%s'%s", motor, term->name, nearest_hint(name, MOTOR_NAMES));
}

static json_t *named_bit_term(const struct reader *reader, const struct term *term, const char *key, const char *name)
{
    int bit = read_bit(reader, term, false);
    return bit < 0 ? NULL : no_memory(reader, json_pack("{s:{s:i}}", key, name, bit));
}

static json_t *bits_term(const struct reader *reader, const struct term *term, const char *key, int number)
{
    char digits[12];
    snprintf(digits, sizeof digits, "%02d", number);
    return named_bit_term(reader, term, key, digits);
}

/* A message that passes; `from` NULL: from any sender. */
static json_t *message_term(const struct reader *reader, const struct term *term, const char *from)
{
    int64_t number;
    json_t *message = json_object();
    if (term->compare[0] != '\0') {
        if (strcmp(term->compare, "=") != 0 || !read_number(term->value, &number) || number < 0 || number > 255) {
            json_decref(message);
            return report_expected(reader, "message=0 to message=255, found '%s%s%s'", term->name, term->compare, term->value);
        }
        json_object_set_new(message, "number", json_integer(number));
    }
    if (from != NULL)
        json_object_set_new(message, "from", json_string(from));
    return no_memory(reader, json_pack("{s:o}", "message", message));
}

static json_t *dropped_term(const struct reader *reader, const struct term *term)
{
    if (term->compare[0] != '\0')
        return report_expected(reader, "%s alone, found '%s%s%s'", term->name, term->name, term->compare, term->value);
    return no_memory(reader, json_pack("{s:{s:b}}", "message", "dropped", 1));
}

/* Flags of the unit: idle, powered. */
static json_t *flag_term(const struct reader *reader, const struct term *term, const char *key)
{
    int bit = read_bit(reader, term, true);
    return bit < 0 ? NULL : no_memory(reader, json_pack("{s:b}", key, bit));
}

/* What concerns the line as a whole; `unit` "": not named. */
static json_t *line_term(const struct reader *reader, const struct term *term, const char *name, const char *unit, bool *known)
{
    *known = true;
    if (strcmp(name, "message") == 0)
        return message_term(reader, term, unit[0] != '\0' ? unit : NULL);
    if (strcmp(name, "master.message") == 0 && unit[0] == '\0')
        return message_term(reader, term, "master");
    if (strcmp(name, "unit.message") == 0 && unit[0] == '\0')
        return message_term(reader, term, "unit");
    if (strcmp(name, "dropped") == 0 && unit[0] == '\0')
        return dropped_term(reader, term);
    if (strcmp(name, "t") == 0 && unit[0] == '\0') {
        json_t *time = read_time(reader, term);
        return time == NULL ? NULL : no_memory(reader, json_pack("{s:o}", "t", time));
    }
    *known = false;
    return NULL;
}

/* A cell of an interface. */
static json_t *cell_term(const struct reader *reader, const struct term *term, const char *name)
{
    json_t *value = read_integer(reader, term);
    return value == NULL ? NULL : no_memory(reader, json_pack("{s:{s:o}}", "cell", name, value));
}

/* The motor in front of "m12.position"; 0: there is none. */
static int motor_of(const char *name)
{
    int motor = 0;
    if (*name++ != 'm')
        return 0;
    for (; *name >= '0' && *name <= '9' && motor <= MOTORS_MAX; name++)
        motor = 10 * motor + *name - '0';
    return *name == '.' && motor <= MOTORS_MAX ? motor : 0;
}

/* What concerns a unit; `name` is the name of the term without that of the unit. */
static json_t *unit_term(const struct reader *reader, const struct term *term, const char *name)
{
    static const struct {
        const char *name;
        int low, high;
    } bits[] = {{"do", 1, 32}, {"di", 1, 32}, {"var", 1, 99}}; /* the emulator knows which there are */
    const int motor = motor_of(name);
    if ((name[0] == 'd') && (name[1] == 'i' || name[1] == 'o') && name[2] == '.' && name[3] != '\0')
        return named_bit_term(reader, term, name[1] == 'i' ? "di" : "do", name + 3);
    if (strncmp(name, "cell.", 5) == 0 && name[5] != '\0')
        return cell_term(reader, term, name + 5);
    if (motor > 0)
        return motor_term(reader, term, strchr(name, '.') + 1, motor);
    for (size_t i = 0; i < sizeof bits / sizeof *bits; i++) {
        size_t length = strlen(bits[i].name);
        if (strncmp(name, bits[i].name, length) != 0)
            continue;
        int number = number_behind(name, bits[i].name, bits[i].low, bits[i].high);
        return number > 0 ? bits_term(reader, term, bits[i].name, number)
                          : report_expected(reader, "%s%d to %s%d, found '%s'", bits[i].name, bits[i].low, bits[i].name,
                                            bits[i].high, term->name);
    }
    if (strcmp(name, "idle") == 0 || strcmp(name, "powered") == 0)
        return flag_term(reader, term, name);
    return report_expected(reader, EXPECTED_NAME ", found '%s'%s", term->name,
                           nearest_hint(name, "idle, powered, message, dropped"));
}

/* The name of the unit in front of a name, "u3." or "u3-2."; returns what follows it, or the whole if there is none. */
static const char *unit_of(const char *name, char unit[NAME_MAX_LENGTH])
{
    unit[0] = '\0';
    if (name[0] != 'u' || name[1] < '0' || name[1] > '9')
        return name;
    size_t length = strcspn(name + 1, ".");
    if (name[1 + length] == '\0')
        return name;
    memcpy(unit, name + 1, length);
    unit[length] = '\0';
    return name + length + 2;
}

/* Put the name of the unit into a term. */
static json_t *add_unit(json_t *json, const char *unit)
{
    if (json != NULL && unit[0] != '\0')
        json_object_set_new(json, "unit", json_string(unit));
    return json;
}

static json_t *read_term(struct reader *reader)
{
    struct term term;
    char unit[NAME_MAX_LENGTH];
    bool of_line;
    if (!scan_term(reader, &term))
        return NULL;
    const char *name = unit_of(term.name, unit);
    json_t *json = line_term(reader, &term, name, unit, &of_line);
    return of_line ? json : add_unit(unit_term(reader, &term, name), unit[0] != '\0' ? unit : reader->unit);
}

/* ---- Several -------------------------------------------------------------------------------------------------------- */

/* Terms that hold together, up to an "or" or the end. */
static json_t *read_all_of(struct reader *reader)
{
    json_t *all = json_array();
    for (;;) {
        json_t *term = read_term(reader);
        if (term == NULL || json_array_append_new(all, term) != 0) {
            json_decref(all);
            return NULL;
        }
        if (accept_word(reader, "and", "&&") || accept_word(reader, "and", ","))
            continue;
        struct reader ahead = *reader;
        if (*reader->at == '\0' || accept_word(&ahead, "or", "||"))
            return one_or_list(reader, all, "all");
    }
}

static json_t *read_any_of(struct reader *reader)
{
    json_t *any = json_array();
    do {
        json_t *group = read_all_of(reader);
        if (group == NULL || json_array_append_new(any, group) != 0) {
            json_decref(any);
            return NULL;
        }
    } while (accept_word(reader, "or", "||"));
    return one_or_list(reader, any, "any");
}

json_t *client_condition(const char *text, const char *unit, char wrong[CLIENT_CONDITION_WRONG_SIZE])
{
    struct reader reader = {.at = text, .unit = unit != NULL ? unit : "", .wrong = wrong};
    json_error_t error;
    snprintf(wrong, CLIENT_CONDITION_WRONG_SIZE, "%s", strerror(ENOMEM));
    skip_blanks(&reader);
    if (*reader.at != '{')
        return read_any_of(&reader);
    json_t *json = json_loads(reader.at, JSON_REJECT_DUPLICATES, &error);
    return json != NULL ? json : report_expected(&reader, "a condition in JSON: %s", error.text);
}
