/* SPDX-License-Identifier: MIT */
/* fields.h: lines of a text, cut into fields; numbers and names in them; text that is written. */
#ifndef PMC_FIELDS_H
#define PMC_FIELDS_H

#include "pmc.h"

/* A text that is read line by line. */
struct pmc_reader {
    const char *text;
    size_t length, at;     /* at: where the next line begins */
    unsigned line;         /* the present one, from 1 */
    size_t begin, end;     /* of the present line, without its comment */
    bool is_wrong;         /* an error has been reported */
    pmc_text_report *report;
    void *context;
};

/* A part of the present line. */
struct pmc_field {
    const char *text;
    size_t length;
    unsigned column;
};

/* Go to the next line. Returns false if there is none. */
bool pmc_reader_next(struct pmc_reader *reader);

/* Take the next field of the line, up to a blank or one of the characters in `stops`, which is not taken. If there is none its
 * length is 0, and its place is the end of the line. */
struct pmc_field pmc_reader_field(struct pmc_reader *reader, const char *stops);

/* Take the character `c` if it comes next, blanks apart. */
bool pmc_reader_take(struct pmc_reader *reader, char c);

/* Report what is wrong at a field. Returns false. */
bool pmc_reader_fail(struct pmc_reader *reader, const struct pmc_field *field, const char *expected);
void pmc_reader_warn(struct pmc_reader *reader, unsigned line, unsigned column, const char *text);

bool pmc_field_is(const struct pmc_field *field, const char *text);

/* A whole number low..high, with a sign before it. */
bool pmc_field_number(const struct pmc_field *field, int32_t low, int32_t high, int32_t *number);

/* 0x and four hexadecimal digits. */
bool pmc_field_bits(const struct pmc_field *field, int32_t high, int32_t *number);

/* A number with at most one decimal place, in tenths. */
bool pmc_field_tenths(const struct pmc_field *field, int32_t *tenths);

/* Text that is written: `length` goes on where `room` ends. */
struct pmc_writer {
    char *text;
    size_t length, room;
};

void pmc_write(struct pmc_writer *writer, const char *text);
void pmc_write_number(struct pmc_writer *writer, int32_t number, unsigned digits); /* at least so many */
void pmc_write_tenths(struct pmc_writer *writer, int32_t tenths);
void pmc_write_bits(struct pmc_writer *writer, int32_t bits);

#endif
