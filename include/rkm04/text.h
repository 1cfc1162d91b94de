/* SPDX-License-Identifier: MIT */
/* rkm04/text.h: the command language, text <-> commands (manual chapters 6 and 7, specification section 5).
 *
 * A reader takes a text apart command by command without storing anything:
 *
 *     struct rkm04_reader r;
 *     struct rkm04_command c;
 *     rkm04_read_begin(&r, text, length);
 *     while (rkm04_read(&r, &c) == RKM04_READ_COMMAND)
 *         use(c);
 */
#ifndef RKM04_TEXT_H
#define RKM04_TEXT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <rkm04/limits.h>

#ifdef __cplusplus
extern "C" {
#endif

/* One command: the character of the table (the call is always '\'') and its number.
 *
 * argument: the number as such, except
 *   '='      the value as two's complement
 *   'G'      1..2 000 000 000, or RKM04_G_FORWARD, RKM04_G_BACK for G+ and G-
 *   'I'      bit | level << 8 | label << 16: bit 1..8 or 80..95, level 1 = H or 0 = L, label 1..80
 *   commands without a number: 0 */
struct rkm04_command {
    uint8_t op;
    uint32_t argument;
};

#define RKM04_G_FORWARD UINT32_MAX
#define RKM04_G_BACK (UINT32_MAX - 1)

/* Cursor over a text. The text must stay where it is; nothing is copied. */
struct rkm04_reader {
    const uint8_t *text;
    size_t length;
    size_t at;    /* next character to be read; after an error: where reading continues */
    size_t start; /* offset of the character of the command read last, or of the wrong one */
    size_t wrong; /* after an error: offset of the character that did not fit; may be `length` */
};

enum rkm04_read {
    RKM04_READ_END,       /* no more commands */
    RKM04_READ_COMMAND,   /* *command is set */
    RKM04_READ_BAD_VALUE, /* flag 1: a number missing, out of range or too long; text[start] is the command */
    RKM04_READ_UNKNOWN    /* flag 2: text[start] is no command, or a '{' that is never closed */
};

/* Begin to read `length` bytes at `text`. */
void rkm04_read_begin(struct rkm04_reader *reader, const void *text, size_t length);

/* Read the next command, passing over blanks and comments (manual 5.3.2). `\`, `K` and `C75` are read like the others.
 * After an error reading may continue after it, to find the errors that follow.
 * Returns what was found; *command is set with RKM04_READ_COMMAND only. */
enum rkm04_read rkm04_read(struct rkm04_reader *reader, struct rkm04_command *command);

/* Is this command one that the reader could have given, its number within the range of the table? For data from flash.
 * `\`, `K` and `C75` count as valid. */
bool rkm04_command_valid(struct rkm04_command command);

/* Write the canonical text of one valid command (P8): two digits for DI, DO, VAR and functions, no leading zeros elsewhere,
 * no blank. Returns the length, 1..RKM04_COMMAND_TEXT_MAX; no terminating zero. */
size_t rkm04_format(struct rkm04_command command, char text[RKM04_COMMAND_TEXT_MAX]);

/* What may follow a command, for messages to people. */
struct rkm04_range {
    int32_t low, high; /* inclusive */
};
#define RKM04_RANGES_MAX 5

enum rkm04_form {
    RKM04_FORM_NONE,     /* no number */
    RKM04_FORM_NUMBER,   /* a number in one of the ranges */
    RKM04_FORM_SIGNED,   /* the same with an optional '-' */
    RKM04_FORM_ABSOLUTE, /* a number in the range, '+' or '-' */
    RKM04_FORM_JUMP_IF   /* bit in ranges 0 and 1, H or L, label in range 2 */
};

/* Look a command's form up. `ranges` receives up to RKM04_RANGES_MAX ranges.
 * Returns the number of ranges and sets *form, or returns -1 if `op` is no command. */
int rkm04_form_of(uint8_t op, enum rkm04_form *form, struct rkm04_range ranges[RKM04_RANGES_MAX]);

#ifdef __cplusplus
}
#endif

#endif
