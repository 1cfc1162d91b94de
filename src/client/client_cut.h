/* SPDX-License-Identifier: MIT */
/* client_cut.h: a program text cut into the messages it takes (manual 4.3; specification L4, C1-C4, C9). No I/O. */
#ifndef RKM04_CLIENT_CUT_H
#define RKM04_CLIENT_CUT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A command of the text, in its order. */
struct client_command {
    size_t start, end; /* offsets in the text */
    size_t piece;      /* the piece it is sent in */
    size_t at;         /* its offset there */
    uint8_t op;        /* the character of the command table */
    bool stored;       /* takes a place in memory: not `\`, K, C75 */
};

struct client_piece {
    char *text;
    size_t length;
    unsigned commands; /* in the piece, added brackets included */
    bool sole;         /* the last of them would act at once if it were the only one: V, K, C75 */
};

struct client_cut {
    struct client_piece *piece;
    size_t pieces;
    struct client_command *command;
    size_t commands;
    size_t program; /* commands of the program itself that will be in memory: stored ones after the last `\` */
    size_t places;  /* places they take there, with what was added */
    size_t wrong;   /* offset of what prevents cutting */
};

enum client_cut_result {
    CLIENT_CUT_DONE,
    CLIENT_CUT_INVALID,      /* the unit would refuse what is at `wrong` */
    CLIENT_CUT_TOO_MANY,     /* `program` commands and the brackets around them do not fit into memory */
    CLIENT_CUT_LONG_COMMAND, /* the command at `wrong` alone is longer than a message */
    CLIENT_CUT_OPEN_BLOCK,   /* after the `[` at `wrong`, which is never closed, is more than one message */
    CLIENT_CUT_NO_MEMORY
};

#define CLIENT_ROOM_MIN 16 /* bytes of text a message has to take at least */

/* Cut a text into pieces of up to `room` bytes, >= CLIENT_ROOM_MIN. A text that fits is one piece, as it is. Otherwise:
 * - cuts are at the borders of commands; a comment that is cut is closed and opened again;
 * - a `[` before the first command and after each `\`, and a `]` at the end, hold execution until the last piece is there;
 *   where the text ends with an open block of its own, the `]` is before that block;
 * - a `]` of the text itself in a piece before the last becomes `[`, which holds now and is passed in the same one slot later;
 * - V, K or C75 is never left alone in a piece, where it would act at once: a `[` joins it.
 * The result is to be given to client_cut_free() in any case. Returns what came of it. */
enum client_cut_result client_cut(struct client_cut *cut, const char *text, size_t length, size_t room);

void client_cut_free(struct client_cut *cut);

#endif
