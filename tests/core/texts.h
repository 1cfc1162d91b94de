/* SPDX-License-Identifier: MIT */
/* texts.h: the commands of section 5 of the specification, written down once more, and ways to read texts, for tests.
 *
 * The tables are on purpose not made from src/commands.h. */
#ifndef RKM04_TESTS_TEXTS_H
#define RKM04_TESTS_TEXTS_H

#include <rkm04/text.h>

#define COUNT(array) (sizeof(array) / sizeof(array)[0])
#define UNTOUCHED ((struct rkm04_command){0xEE, 0xDEADBEEF})

/* Commands without a number, commands with one, as strings. The remaining one is I. */
#define PLAIN_COMMANDS "\\DEHKRUY.[]"
#define NUMBER_COMMANDS "@ABCFGJLMNOSTVWXZ)('="

/* Commands with one number, a line for each range. */
struct limits {
    char op;
    int digits; /* at least, in canonical text */
    int64_t low, high;
};
#define NUMBER_ROWS 29
extern const struct limits numbers[NUMBER_ROWS];

/* Is the value in the table above? */
bool legal(char op, int64_t value);

/* The same for the number of a command as the interface encodes it, commands without a number included; not for I. */
bool legal_argument(uint8_t op, uint32_t argument);

/* Begin to read a copy that ends where its memory ends, for the sanitizer to watch. One at a time, up to 200 000 bytes. */
struct rkm04_reader begin_text(const void *text, size_t length);

/* Is the text this one command and nothing else? */
bool is_command(const void *text, size_t length, char op, uint32_t argument);

/* Is the first thing in the text this error, with nothing written to the command? */
bool is_error(const char *text, enum rkm04_read what, size_t start, size_t wrong);

/* The two above as assertions that show the text. Checks of Check itself are slow, so these count as one when they fail. */
void expect_command(const char *text, char op, uint32_t argument);
void expect_error(const char *text, enum rkm04_read what, size_t start, size_t wrong);

/* What the text reads as, in a line: commands canonically, a bad value as "!start:wrong", an unknown command as "?start". */
const char *reading_of(const char *text);
#define ck_assert_reads(text, line) ck_assert_str_eq(reading_of(text), line)

#endif
