/* SPDX-License-Identifier: MIT */
#include "client_cut.h"

#include <stdlib.h>
#include <string.h>

#include <rkm04/text.h>

/* Bytes kept free in a piece: a `}` that closes a comment at the cut, and a `[` that joins a lone command. */
#define SPARE 2
#define NOWHERE SIZE_MAX

struct cutter {
    struct client_cut *cut;
    const char *text;
    size_t length, room;
    size_t open_block;   /* index of the first `[` after the last `]` and `\`; NOWHERE: none */
    size_t released;     /* the piece with a `]` added before that block; NOWHERE: none */
    bool in_comment;
    bool held;  /* an added `[` is open */
    bool ended; /* an open block has begun: no brackets from here on */
    enum client_cut_result result;
};

/* ---- Commands of the text ----------------------------------------------------------------------------------------- */

static enum client_cut_result list_commands(struct client_cut *cut, const char *text, size_t length)
{
    struct rkm04_reader reader;
    struct rkm04_command command;
    enum rkm04_read found;
    size_t room = 0;
    rkm04_read_begin(&reader, text, length);
    while ((found = rkm04_read(&reader, &command)) == RKM04_READ_COMMAND) {
        if (cut->commands == room) {
            room = room > 0 ? 2 * room : 64;
            struct client_command *grown = realloc(cut->command, room * sizeof *grown);
            if (grown == NULL)
                return CLIENT_CUT_NO_MEMORY;
            cut->command = grown;
        }
        bool resume = command.op == 'C' && command.argument == 75;
        cut->command[cut->commands++] = (struct client_command){
            .start = reader.start,
            .end = reader.at,
            .op = command.op,
            .stored = command.op != '\\' && command.op != 'K' && !resume,
        };
    }
    cut->wrong = reader.start;
    return found == RKM04_READ_END ? CLIENT_CUT_DONE : CLIENT_CUT_INVALID;
}

/* Find how much the last `\` leaves of the program, and a block that stays open. */
static void find_open_block(struct cutter *c)
{
    for (size_t i = 0; i < c->cut->commands; i++) {
        uint8_t op = c->cut->command[i].op;
        c->cut->program = op == '\\' ? 0 : c->cut->program + c->cut->command[i].stored;
        if (op == '[' && c->open_block == NOWHERE)
            c->open_block = i;
        else if (op == ']' || op == '\\')
            c->open_block = NOWHERE;
    }
}

/* ---- Pieces ------------------------------------------------------------------------------------------------------- */

static void set_error(struct cutter *c, enum client_cut_result result)
{
    if (c->result == CLIENT_CUT_DONE)
        c->result = result;
}

static struct client_piece *present_piece(struct cutter *c)
{
    return &c->cut->piece[c->cut->pieces - 1];
}

static void append(struct cutter *c, const char *bytes, size_t length)
{
    struct client_piece *piece = present_piece(c);
    memcpy(piece->text + piece->length, bytes, length);
    piece->length += length;
}

static void insert_bracket(struct cutter *c)
{
    struct client_piece *piece = present_piece(c);
    memmove(piece->text + 1, piece->text, piece->length);
    piece->text[0] = '[';
    piece->length++;
    piece->commands++;
    c->cut->places++;
    for (size_t i = 0; i < c->cut->commands; i++) {
        if (c->cut->command[i].piece == c->cut->pieces - 1)
            c->cut->command[i].at++;
    }
}

static void end_piece(struct cutter *c)
{
    if (c->in_comment)
        append(c, "}", 1);
    if (present_piece(c)->commands == 1 && present_piece(c)->sole && c->cut->commands > 1)
        insert_bracket(c);
}

static bool begin_piece(struct cutter *c)
{
    struct client_piece *grown = realloc(c->cut->piece, (c->cut->pieces + 1) * sizeof *grown);
    if (grown != NULL) {
        c->cut->piece = grown;
        c->cut->piece[c->cut->pieces] = (struct client_piece){.text = malloc(c->room)};
        if (c->cut->piece[c->cut->pieces].text != NULL) {
            c->cut->pieces++;
            if (c->in_comment)
                append(c, "{", 1);
            return true;
        }
    }
    set_error(c, CLIENT_CUT_NO_MEMORY);
    return false;
}

/* Add what must not be cut. */
static bool add_text(struct cutter *c, const char *bytes, size_t length)
{
    if (length > c->room - SPARE - (c->in_comment ? 1 : 0)) {
        set_error(c, CLIENT_CUT_LONG_COMMAND);
        return false;
    }
    if (present_piece(c)->length + length > c->room - SPARE) {
        end_piece(c);
        if (!begin_piece(c))
            return false;
    }
    append(c, bytes, length);
    return true;
}

/* Add a bracket of our own. */
static bool add_bracket(struct cutter *c, const char *bracket)
{
    if (!add_text(c, bracket, 1))
        return false;
    present_piece(c)->commands++;
    present_piece(c)->sole = false;
    c->cut->places++;
    return true;
}

/* Add blanks and comments; these may be cut anywhere. */
static bool add_gap(struct cutter *c, size_t from, size_t to)
{
    for (size_t i = from; i < to; i++) {
        if (c->in_comment && c->text[i] == '}') {
            append(c, "}", 1); /* into the place kept for it */
            c->in_comment = false;
        } else {
            if (!add_text(c, c->text + i, 1))
                return false;
            c->in_comment = c->in_comment || c->text[i] == '{';
        }
    }
    return true;
}

/* Let go before a block that stays open. All after the `]` has to be in the last piece, so it begins one. */
static bool release_hold(struct cutter *c)
{
    c->ended = true;
    if (!c->held)
        return true;
    end_piece(c);
    c->released = c->cut->pieces;
    return begin_piece(c) && add_bracket(c, "]");
}

/* Hold execution where a command of the program could begin to run. A single command has nothing to wait for. */
static bool add_hold(struct cutter *c, size_t index)
{
    if (c->cut->commands == 1 || c->ended)
        return true;
    if (index == c->open_block)
        return release_hold(c);
    if (c->held || c->cut->command[index].op == '\\')
        return true;
    c->held = true;
    return add_bracket(c, "[");
}

static bool add_command(struct cutter *c, size_t index)
{
    struct client_command *command = &c->cut->command[index];
    c->cut->wrong = command->start;
    if (!add_hold(c, index) || !add_text(c, c->text + command->start, command->end - command->start))
        return false;
    struct client_piece *piece = present_piece(c);
    command->piece = c->cut->pieces - 1;
    command->at = piece->length - (command->end - command->start);
    piece->commands++;
    piece->sole = command->op == 'V' || command->op == 'K' || (command->op == 'C' && !command->stored);
    if (command->op == '\\') {
        c->held = false;
        c->cut->places = 0;
    } else if (command->stored) {
        c->cut->places++;
    }
    return true;
}

/* Pieces of the whole text, brackets added. */
static bool fill_pieces(struct cutter *c)
{
    size_t gap = 0;
    if (!begin_piece(c))
        return false;
    for (size_t i = 0; i < c->cut->commands; i++) {
        if (!add_gap(c, gap, c->cut->command[i].start) || !add_command(c, i))
            return false;
        gap = c->cut->command[i].end;
    }
    if (!add_gap(c, gap, c->length) || (c->held && !c->ended && !add_bracket(c, "]")))
        return false;
    end_piece(c);
    return true;
}

/* A `]` that arrives before the rest would release too early. */
static void hold_inner_ends(struct client_cut *cut)
{
    for (size_t i = 0; i < cut->commands; i++) {
        const struct client_command *command = &cut->command[i];
        if (command->op == ']' && command->piece + 1 < cut->pieces)
            cut->piece[command->piece].text[command->at] = '[';
    }
}

/* ---- Calls -------------------------------------------------------------------------------------------------------- */

static enum client_cut_result make_one_piece(struct cutter *c)
{
    struct client_cut *cut = c->cut;
    if (!begin_piece(c))
        return c->result;
    append(c, c->text, c->length);
    cut->piece[0].commands = (unsigned)cut->commands;
    for (size_t i = 0; i < cut->commands; i++)
        cut->command[i].at = cut->command[i].start;
    cut->places = cut->program;
    return CLIENT_CUT_DONE;
}

enum client_cut_result client_cut(struct client_cut *cut, const char *text, size_t length, size_t room)
{
    *cut = (struct client_cut){0};
    struct cutter c = {.cut = cut, .text = text, .length = length, .room = room, .open_block = NOWHERE, .released = NOWHERE};
    enum client_cut_result listed = list_commands(cut, text, length);
    if (listed != CLIENT_CUT_DONE)
        return listed;
    find_open_block(&c);
    if (length <= room)
        return make_one_piece(&c);
    if (!fill_pieces(&c))
        return c.result;
    if (c.released != NOWHERE && c.released + 1 < cut->pieces) {
        cut->wrong = cut->command[c.open_block].start;
        return CLIENT_CUT_OPEN_BLOCK;
    }
    hold_inner_ends(cut);
    return cut->places > RKM04_PROGRAM_MAX ? CLIENT_CUT_TOO_MANY : CLIENT_CUT_DONE;
}

void client_cut_free(struct client_cut *cut)
{
    for (size_t i = 0; i < cut->pieces; i++)
        free(cut->piece[i].text);
    free(cut->piece);
    free(cut->command);
    *cut = (struct client_cut){0};
}
