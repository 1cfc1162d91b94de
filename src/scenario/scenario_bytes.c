/* SPDX-License-Identifier: MIT */
#include "scenario_bytes.h"

#include <stdlib.h>
#include <string.h>

#define PRINTED_MAX 200 /* bytes of a message that a report shows */

static int digit(char c)
{
    static const char digits[] = "0123456789abcdef";
    char lower = c >= 'A' && c <= 'F' ? (char)(c - 'A' + 'a') : c;
    const char *at = c != '\0' ? strchr(digits, lower) : NULL;
    return at != NULL ? (int)(at - digits) : -1;
}

static void put(struct scenario_bytes *bytes, unsigned byte, bool any)
{
    bytes->byte[bytes->length] = (uint8_t)byte;
    bytes->any[bytes->length++] = any;
    bytes->anys = bytes->anys || any;
}

/* Take what is at `text`, which is no blank. Returns the characters taken; 0: it is nothing. */
static size_t read_item(struct scenario_bytes *bytes, const char *text)
{
    if (*text == '"') {
        const char *end = strchr(text + 1, '"');
        for (const char *c = text + 1; end != NULL && c < end; c++)
            put(bytes, (uint8_t)*c, false);
        return end != NULL ? (size_t)(end - text) + 1 : 0;
    }
    if (strncmp(text, "..", 2) == 0) {
        put(bytes, 0, true);
        return 2;
    }
    if (*text == '*' && text[1 + strspn(text + 1, " ")] == '\0') {
        bytes->rest = true;
        return 1;
    }
    if (digit(text[0]) < 0 || digit(text[1]) < 0)
        return 0;
    put(bytes, (unsigned)(digit(text[0]) << 4 | digit(text[1])), false);
    return 2;
}

const char *scenario_bytes_read(struct scenario_bytes *bytes, const char *text)
{
    size_t room = strlen(text) + 1; /* a byte takes a character or two */
    *bytes = (struct scenario_bytes){.byte = malloc(room), .any = malloc(room * sizeof(bool))};
    if (bytes->byte == NULL || bytes->any == NULL)
        return "less: out of memory";
    while (*text != '\0') {
        size_t taken = *text == ' ' || *text == '\n' ? 1 : read_item(bytes, text);
        if (taken == 0)
            return "bytes: pairs of hexadecimal digits and texts in double quotes, as in '04 \"1\"'";
        text += taken;
    }
    return NULL;
}

void scenario_bytes_free(struct scenario_bytes *bytes)
{
    free(bytes->byte);
    free(bytes->any);
    *bytes = (struct scenario_bytes){0};
}

bool scenario_bytes_match(const struct scenario_bytes *bytes, const uint8_t *byte, size_t length)
{
    if (length < bytes->length || (length > bytes->length && !bytes->rest))
        return false;
    for (size_t i = 0; i < bytes->length; i++) {
        if (!bytes->any[i] && bytes->byte[i] != byte[i])
            return false;
    }
    return true;
}

/* Part of a text rather than a number? The first byte is the number of the message. */
static bool is_text(const struct scenario_bytes *bytes, size_t at)
{
    uint8_t byte = bytes->byte[at];
    return at > 0 && byte >= 0x20 && byte < 0x7F && byte != '"' && !(bytes->any != NULL && bytes->any[at]);
}

void scenario_bytes_print(FILE *out, const struct scenario_bytes *bytes)
{
    size_t end = bytes->length < PRINTED_MAX ? bytes->length : PRINTED_MAX;
    for (size_t at = 0; at < end; at++) {
        if (is_text(bytes, at)) {
            fputs(at > 0 && is_text(bytes, at - 1) ? "" : at > 0 ? " \"" : "\"", out);
            fputc(bytes->byte[at], out);
            fputs(at + 1 == end || !is_text(bytes, at + 1) ? "\"" : "", out);
        } else if (bytes->any != NULL && bytes->any[at]) {
            fprintf(out, "%s..", at > 0 ? " " : "");
        } else {
            fprintf(out, "%s%02X", at > 0 ? " " : "", bytes->byte[at]);
        }
    }
    if (end < bytes->length)
        fprintf(out, " … (%zu bytes)", bytes->length);
    if (bytes->rest)
        fputs(" *", out);
}
