/* SPDX-License-Identifier: MIT */
/* code.h: the program of one motor as commands with their places in the texts. Read by the core's reader. */
#ifndef RKM04_PROGRAM_TOOLS_CODE_H
#define RKM04_PROGRAM_TOOLS_CODE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <rkm04/text.h>

#include "diagnostic.h"

struct code_command {
    struct rkm04_command command;
    uint32_t source;         /* of code.sources */
    uint32_t offset, length; /* in its text */
};

struct code_comment {
    uint32_t source, offset, length; /* with its braces */
    bool after; /* a command precedes it in its line */
};

struct code {
    const struct program_source *sources;
    size_t source_count;
    struct code_command *commands; /* all that are stored, and `\`; K and C75 are never stored (C3) */
    size_t count;
    size_t first;                  /* of the program: the command after the last `\` (C1) */
    bool has_reset;
    struct code_comment *comments;
    size_t comment_count;
    size_t command_room, comment_room;
};

/* What a reader reports that is no command: errors, K and C75. `found`: RKM04_READ_COMMAND for these two. `next`: the offset
 * at which reading continues. */
typedef void code_notice(void *context, size_t source, const struct rkm04_reader *reader, enum rkm04_read found,
                         struct rkm04_command command);

/* Begin with no command. */
void code_begin(struct code *code, const struct program_source *sources, size_t count);

/* Read source number `source` after what was read before. `text` is its text, mapped in place (program_text_map_in_place()).
 * Returns false if out of memory. */
bool code_read(struct code *code, size_t source, const char *text, code_notice *notice, void *context);

void code_free(struct code *code);

/* Where a command is, for a diagnostic: through the end of command `last`, or of the last one in the same source. */
struct diagnostic code_place(const struct code *code, size_t command, size_t last);

/* Bit and label of an I, label of J and '. */
static inline unsigned code_bit(struct rkm04_command command)
{
    return command.argument & 0xFF;
}

static inline unsigned code_label(struct rkm04_command command)
{
    return command.op == 'I' ? command.argument >> 16 : command.argument;
}

static inline bool code_is_jump(struct rkm04_command command)
{
    return command.op == 'I' || command.op == 'J' || command.op == '\'';
}

/* R, G, H, `)` and `(`. */
static inline bool code_is_motion(struct rkm04_command command)
{
    return command.op == 'R' || command.op == 'G' || command.op == 'H' || command.op == '(' || command.op == ')';
}

static inline bool code_is_endless(struct rkm04_command command)
{
    return command.op == 'G' && (command.argument == RKM04_G_FORWARD || command.argument == RKM04_G_BACK);
}

#endif
