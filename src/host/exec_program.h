/* exec_program.h: the arguments [M=]FILE of `rkm04 exec`, and texts read from files. */
#ifndef RKM04_HOST_EXEC_PROGRAM_H
#define RKM04_HOST_EXEC_PROGRAM_H

#include <stdbool.h>
#include <stddef.h>

/* A text from a file, in the bytes the unit takes: a UTF-8 byte order mark is gone, typographic apostrophes are 0x27
 * (docs/SPEC.md, the subroutine call). */
struct exec_text {
    char *name; /* as given; "<stdin>" for "-" */
    char *text; /* NULL: not read yet */
    size_t length;
};

/* One argument. */
struct exec_program {
    char motor; /* '0'..'4' */
    struct exec_text text;
};

/* Read the whole file `path`, "-" for standard input, into *text. A failure is reported on stderr.
 * Returns true if it worked; exec_text_free() is due in any case. */
bool exec_text_read(struct exec_text *text, const char *path);

void exec_text_free(struct exec_text *text);

/* Map in place to the bytes the unit takes. Returns the new length. */
size_t exec_text_map(char *text, size_t length);

/* Take an argument [M=]FILE apart; M is a motor 0..4, 1 if it is missing. *path points into `argument`.
 * Returns false if M is a number but not a motor. */
bool exec_program_argument(const char *argument, char *motor, const char **path);

#endif
