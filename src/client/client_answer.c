/* SPDX-License-Identifier: MIT */
#include "client_answer.h"

#include <err.h>
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <rkm04/limits.h>

#include "text/text.h"

enum { HEAD = 2 /* message number and motor, or length */, TEXT_MAX = 16384 };

/* ---- Parts of messages -------------------------------------------------------------------------------------------- */

/* The answer is not what the manual says. */
static enum exit_status report_malformed(const struct client_answer *answer)
{
    fprintf(stderr, "%s: the unit's answer is malformed:", program_invocation_short_name);
    for (size_t i = 0; i < answer->length && i < 32; i++)
        fprintf(stderr, " %02x", answer->bytes[i]);
    fprintf(stderr, "%s\n", answer->length > 32 ? " ..." : "");
    return STATUS_FAILURE;
}

/* Bytes of a unit as text; those that are not printable ASCII as \xNN, so that no terminal interprets them. */
static void print_text(const uint8_t *bytes, size_t length)
{
    for (size_t i = 0; i < length; i++) {
        if (bytes[i] >= 0x20 && bytes[i] < 0x7F)
            putchar(bytes[i]);
        else
            printf("\\x%02X", bytes[i]);
    }
}

json_t *client_json_text(const uint8_t *bytes, size_t length)
{
    char *utf8 = malloc(2 * length + 1);
    if (utf8 == NULL)
        return NULL;
    size_t n = 0;
    for (size_t i = 0; i < length; i++) {
        if (bytes[i] < 0x80) {
            utf8[n++] = (char)bytes[i];
        } else {
            utf8[n++] = (char)(0xC0 | bytes[i] >> 6);
            utf8[n++] = (char)(0x80 | (bytes[i] & 0x3F));
        }
    }
    json_t *string = json_stringn(utf8, n);
    free(utf8);
    return string;
}

/* The text after the head as a C string in `text`. Returns false if it has no place or holds other characters than lists of
 * numbers do. */
static bool copy_text(const struct client_answer *answer, char text[TEXT_MAX])
{
    size_t length = answer->length - HEAD;
    if (answer->length < HEAD || length >= TEXT_MAX || memchr(answer->bytes + HEAD, '\0', length) != NULL)
        return false;
    memcpy(text, answer->bytes + HEAD, length);
    text[length] = '\0';
    return text[strspn(text, " 0123456789;,()[]")] == '\0'; /* sscanf takes signs and any white space, too */
}

/* One field of a position: length byte and a decimal number, right-aligned with blanks. Returns the bytes it takes; 0: none. */
static size_t read_position(const uint8_t *bytes, size_t left, int64_t *position)
{
    char text[16];
    size_t length = left > 0 ? bytes[0] : 0;
    if (length == 0 || length >= sizeof text || length >= left)
        return 0;
    memcpy(text, bytes + 1, length);
    text[length] = '\0';
    return number_read_signed(text + strspn(text, " "), INT32_MIN, INT32_MAX, position) ? 1 + length : 0;
}

enum exit_status client_print_json(json_t *object)
{
    if (object == NULL) {
        warnx("%s", strerror(ENOMEM));
        return STATUS_FAILURE;
    }
    json_dumpf(object, stdout, JSON_COMPACT);
    putchar('\n');
    json_decref(object);
    return STATUS_SUCCESS;
}

/* ---- One function a message --------------------------------------------------------------------------------------- */

enum exit_status client_show_version(const struct client_answer *answer)
{
    if (answer->length < HEAD || answer->length != (size_t)HEAD + answer->bytes[1])
        return report_malformed(answer);
    if (answer->json)
        return client_print_json(json_pack("{s:o}", "version", client_json_text(answer->bytes + HEAD, answer->length - HEAD)));
    print_text(answer->bytes + HEAD, answer->length - HEAD);
    putchar('\n');
    return STATUS_SUCCESS;
}

void client_print_motor(char motor)
{
    if (motor == '0')
        printf("all motors: ");
    else
        printf("motor %c: ", motor);
}

enum exit_status client_show_store(const struct client_answer *answer)
{
    if (answer->length != HEAD + 1)
        return report_malformed(answer);
    int error = answer->bytes[HEAD];
    enum exit_status status = error == 0 ? STATUS_SUCCESS : STATUS_FAILURE;
    if (answer->json) {
        enum exit_status printed = client_print_json(json_pack("{s:i,s:i}", "motor", answer->motor - '0', "error", error));
        status = printed != STATUS_SUCCESS ? printed : status;
    } else if (error == 0) {
        client_print_motor(answer->motor);
        printf("stored\n");
    }
    if (error != 0)
        warnx("the unit could not write its flash memory (error %d)", error);
    return status;
}

enum exit_status client_show_position(const struct client_answer *answer)
{
    int64_t position[RKM04_MOTORS];
    bool all = answer->motor == '0';
    int count = all ? RKM04_MOTORS : 1;
    size_t at = HEAD;
    for (int i = 0; i < count; i++) {
        size_t field = at <= answer->length ? read_position(answer->bytes + at, answer->length - at, &position[i]) : 0;
        if (field == 0)
            return report_malformed(answer);
        at += field;
    }
    if (at != answer->length)
        return report_malformed(answer);
    int first = all ? 1 : answer->motor - '0';
    if (answer->json && !all)
        return client_print_json(json_pack("{s:i,s:I}", "motor", first, "position", (json_int_t)position[0]));
    json_t *motors = answer->json ? json_array() : NULL;
    for (int i = 0; i < count; i++) {
        if (answer->json)
            json_array_append_new(motors, json_pack("{s:i,s:I}", "motor", first + i, "position", (json_int_t)position[i]));
        else
            printf("motor %d: %" PRId64 "\n", first + i, position[i]);
    }
    return answer->json ? client_print_json(json_pack("{s:o}", "motors", motors)) : STATUS_SUCCESS;
}

enum exit_status client_show_command(const struct client_answer *answer)
{
    if (answer->length < HEAD)
        return report_malformed(answer);
    const uint8_t *text = answer->bytes + HEAD;
    size_t length = answer->length - HEAD;
    if (answer->json)
        return client_print_json(json_pack("{s:i,s:o}", "motor", answer->motor - '0', "program", client_json_text(text, length)));
    print_text(text, length); /* nothing before it: it may be sent again as it is */
    putchar('\n');
    return STATUS_SUCCESS;
}

/* The points of " n;[(step;speed),…]". Returns an array, or NULL if the text is not of that form. */
static json_t *read_points(const char *text)
{
    unsigned long announced;
    int used = 0;
    json_t *points = json_array();
    if (sscanf(text, " %19lu;[%n", &announced, &used) != 1 || used == 0)
        goto report_malformed;
    for (text += used; *text == '('; text += *text == ',') {
        unsigned long step, speed;
        used = 0;
        if (sscanf(text, "(%19lu;%19lu)%n", &step, &speed, &used) != 2 || used == 0)
            goto report_malformed;
        json_array_append_new(points, json_pack("{s:I,s:I}", "step", (json_int_t)step, "speed", (json_int_t)speed));
        text += used;
    }
    if (strcmp(text, "]") == 0 && json_array_size(points) == announced)
        return points;
report_malformed:
    json_decref(points);
    return NULL;
}

enum exit_status client_show_table(const struct client_answer *answer)
{
    char text[TEXT_MAX];
    json_t *points = copy_text(answer, text) ? read_points(text) : NULL;
    if (points == NULL)
        return report_malformed(answer);
    if (answer->json)
        return client_print_json(json_pack("{s:i,s:o}", "motor", answer->motor - '0', "points", points));
    json_decref(points);
    client_print_motor(answer->motor);
    printf("%s\n", text + strspn(text, " "));
    return STATUS_SUCCESS;
}

enum exit_status client_show_progress(const struct client_answer *answer)
{
    char text[TEXT_MAX];
    unsigned long steps, place;
    int used = 0;
    if (!copy_text(answer, text) || sscanf(text, " %19lu; %19lu%n", &steps, &place, &used) != 2 || text[used] != '\0')
        return report_malformed(answer);
    if (answer->json)
        return client_print_json(json_pack("{s:i,s:I,s:I}", "motor", answer->motor - '0', "steps", (json_int_t)steps, "index",
                                           (json_int_t)place));
    client_print_motor(answer->motor);
    if (place == 0)
        printf("%lu steps, no command\n", steps);
    else
        printf("%lu steps, command %lu\n", steps, place);
    return STATUS_SUCCESS;
}

enum exit_status client_show_raw(const struct client_answer *answer)
{
    char *hex = malloc(2 * answer->length + 1);
    if (hex == NULL)
        return client_print_json(NULL);
    hex[0] = '\0'; /* of a message without bytes */
    for (size_t i = 0; i < answer->length; i++)
        sprintf(hex + 2 * i, "%02x", answer->bytes[i]);
    enum exit_status status = STATUS_SUCCESS;
    if (answer->json)
        status = client_print_json(json_pack("{s:s}", "answer", hex));
    else
        for (size_t i = 0; i < answer->length; i++)
            printf("%.2s%c", hex + 2 * i, i + 1 < answer->length ? ' ' : '\n');
    free(hex);
    return status;
}
