/* SPDX-License-Identifier: MIT */
#include "client_send.h"

#include <err.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "client_cut.h"
#include "client_port.h"
#include "text/text.h"

enum { SET_COMMAND = 2, HEAD = 2 /* message number and motor */ };
enum { FLAG_OK, FLAG_BAD_VALUE, FLAG_UNKNOWN, FLAG_OVERFLOW }; /* of the answer, P1 */

#define PROGRESS_AFTER_US 2000000u
#define PROGRESS_WIDTH 40

/* A program on its way. */
struct sending {
    const struct client_send *send;
    const char *name; /* of the file, for messages */
    const char *text; /* as people see it: places refer to it */
    size_t length;
    struct client_cut cut;
    size_t piece; /* under way */
    bool file;    /* counts are shown */
    int flag;          /* the worst the unit has answered, */
    uint8_t character; /* and the character it named */
    /* For the bar. */
    uint64_t begun;
    size_t sent, total; /* bytes */
    bool bar;
};

/* ---- Progress bar ------------------------------------------------------------------------------------------------- */

static void draw_bar(struct sending *s, size_t done)
{
    if (!isatty(STDERR_FILENO) || client_now() - s->begun < PROGRESS_AFTER_US || s->total == 0)
        return;
    size_t full = done >= s->total ? PROGRESS_WIDTH : done * PROGRESS_WIDTH / s->total;
    s->bar = true;
    fprintf(stderr, "\r%s [%.*s%*s] %3zu %%", s->name, (int)full, "########################################",
            (int)(PROGRESS_WIDTH - full), "", done >= s->total ? 100 : done * 100 / s->total);
}

static void on_progress(void *context, size_t sent)
{
    struct sending *s = context;
    draw_bar(s, s->sent + sent);
}

static void end_bar(struct sending *s)
{
    if (s->bar)
        fputs("\r\033[K", stderr);
    s->bar = false;
}

/* ---- What the unit says ------------------------------------------------------------------------------------------- */

/* The unit names a character; the first command of the piece with that character is the first it can mean. */
static const struct client_command *find_refused(const struct sending *s, uint8_t character, unsigned *candidates)
{
    const struct client_command *first = NULL;
    *candidates = 0;
    for (size_t i = 0; i < s->cut.commands; i++) {
        const struct client_command *command = &s->cut.command[i];
        if (command->piece != s->piece || (uint8_t)s->text[command->start] != character)
            continue;
        if ((*candidates)++ == 0)
            first = command;
    }
    return first;
}

static bool is_refusal(int flag)
{
    return flag == FLAG_BAD_VALUE || flag == FLAG_UNKNOWN;
}

/* What the unit said, then where: the errors that can be seen from here. If there is none, the unit knows other commands or
 * ranges than we do, and the character has to show the place. */
static void report_refusal(const struct sending *s)
{
    fprintf(stderr, "%s: the unit refuses the text: %s ", program_invocation_short_name,
            s->flag == FLAG_BAD_VALUE ? "bad value after" : "unknown command");
    if (s->character > 0x20 && s->character < 0x7F)
        fprintf(stderr, "%c", s->character);
    else
        fprintf(stderr, "byte %02X", s->character);
    fprintf(stderr, " (flag %d)\n", s->flag);
    if (diagnose_text(s->name, s->text, s->length, stderr) > 0)
        return;
    unsigned candidates;
    const struct client_command *command = find_refused(s, s->character, &candidates);
    if (command == NULL)
        return;
    struct text_place place = text_place_begin(s->text, s->length);
    text_place_move(&place, command->start);
    fprintf(stderr, "%s:%zu:%zu: error: refused by the unit%s\n", s->name, place.line, place.column,
            candidates > 1 ? ", or a later one like it in the same message" : "");
}

/* Take the answer to one piece. Returns false if it is none. */
static bool take_answer(struct sending *s)
{
    const struct client *client = s->send->client;
    if (client->length != HEAD + 2 || client->answer[0] != SET_COMMAND || client->answer[HEAD] > FLAG_OVERFLOW) {
        warnx("the unit's answer is malformed: message %u of %zu bytes", client->answer[0], client->length);
        return false;
    }
    int flag = client->answer[HEAD];
    if (is_refusal(flag) || flag > s->flag) {
        s->flag = flag;
        s->character = client->answer[HEAD + 1];
    }
    return true;
}

/* The pieces before this one are in the unit's memory after a `[`. */
static void explain_rest(const struct sending *s)
{
    if (s->piece > 0)
        warnx("%zu of %zu messages have arrived; they wait after a [ and do not run. Reset the motor (set '\\') before you send "
              "again", s->piece, s->cut.pieces);
}

static enum exit_status print_json_result(const struct sending *s)
{
    if (s->send->client->node == 0)
        return client_print_json(json_pack("{s:b}", "broadcast", 1));
    json_t *object = json_pack("{s:i,s:i}", "motor", s->send->motor - '0', "flag", s->flag);
    if (is_refusal(s->flag))
        json_object_set_new(object, "character", client_json_text(&s->character, 1));
    if (s->file) {
        json_object_set_new(object, "commands", json_integer((json_int_t)s->cut.commands));
        json_object_set_new(object, "messages", json_integer((json_int_t)s->cut.pieces));
    }
    return client_print_json(object);
}

static enum exit_status print_result(const struct sending *s)
{
    bool overflow = s->flag == FLAG_OVERFLOW, failed = is_refusal(s->flag) || (overflow && !s->send->allow_overflow);
    enum exit_status status = failed ? STATUS_FAILURE : STATUS_SUCCESS;
    if (is_refusal(s->flag)) {
        report_refusal(s);
        explain_rest(s);
    } else if (overflow) {
        warnx("%s: the program memory of 700 commands has overflowed (flag 3): the oldest commands are overwritten or, "
              "with T40, the newest are lost%s", failed ? "error" : "warning",
              failed ? "; to allow this, use --allow-overflow" : "");
    }
    if (s->send->json) {
        enum exit_status printed = print_json_result(s);
        return printed != STATUS_SUCCESS ? printed : status;
    }
    if (status != STATUS_SUCCESS || s->send->client->node == 0)
        return status;
    client_print_motor(s->send->motor);
    if (s->file)
        printf("%zu command%s sent in %zu message%s\n", s->cut.commands, s->cut.commands == 1 ? "" : "s", s->cut.pieces,
               s->cut.pieces == 1 ? "" : "s");
    else
        puts("ok");
    return status;
}

/* ---- Sending ------------------------------------------------------------------------------------------------------ */

static enum exit_status send_piece(struct sending *s)
{
    const struct client_piece *piece = &s->cut.piece[s->piece];
    uint8_t message[CLIENT_MESSAGE_MAX] = {SET_COMMAND, (uint8_t)s->send->motor};
    memcpy(message + HEAD, piece->text, piece->length);
    enum client_outcome outcome = client_exchange(s->send->client, message, HEAD + piece->length);
    s->sent += piece->length;
    if (outcome == CLIENT_SILENT)
        return STATUS_NO_ANSWER;
    if (outcome == CLIENT_LOST || (outcome == CLIENT_ANSWERED && !take_answer(s)))
        return STATUS_FAILURE;
    return STATUS_SUCCESS;
}

static enum exit_status send_pieces(struct sending *s)
{
    enum exit_status status = STATUS_SUCCESS;
    s->begun = client_now();
    s->send->client->progress = on_progress;
    s->send->client->context = s;
    for (size_t i = 0; i < s->cut.pieces; i++)
        s->total += s->cut.piece[i].length;
    while (s->piece < s->cut.pieces) {
        status = send_piece(s);
        if (status != STATUS_SUCCESS || is_refusal(s->flag))
            break;
        s->piece++;
    }
    s->send->client->progress = NULL;
    end_bar(s);
    if (status == STATUS_SUCCESS)
        return print_result(s);
    explain_rest(s);
    return status;
}

/* The errors of a file that cannot be sent. */
static void report_cut(const struct sending *s, enum client_cut_result result)
{
    struct text_place place = text_place_begin(s->text, s->length);
    text_place_move(&place, s->cut.wrong);
    switch (result) {
    case CLIENT_CUT_TOO_MANY:
        fprintf(stderr, "%s: error: %zu commands: a program longer than one message can have at most %zu, because "
                "the brackets around it are stored, too\n",
                s->name, s->cut.program, RKM04_PROGRAM_MAX - (s->cut.places - s->cut.program));
        break;
    case CLIENT_CUT_LONG_COMMAND:
        fprintf(stderr, "%s:%zu:%zu: error: this command alone is longer than a message of %zu bytes\n", s->name, place.line,
                place.column, s->send->message_max);
        break;
    case CLIENT_CUT_OPEN_BLOCK:
        fprintf(stderr, "%s:%zu:%zu: error: this [ is never closed, and the text after it does not fit into one message: send "
                "that part as a separate file\n", s->name, place.line, place.column);
        break;
    default:
        warnx("%s: %s", s->name, strerror(ENOMEM));
        break;
    }
}

enum exit_status client_send_text(const struct client_send *send, const char *text)
{
    struct client_piece piece = {.text = strdup(text)};
    struct sending s = {.send = send, .name = "TEXT", .text = piece.text, .cut = {.piece = &piece, .pieces = 1}};
    if (piece.text == NULL) {
        warnx("%s", strerror(ENOMEM));
        return STATUS_FAILURE;
    }
    enum exit_status status = STATUS_FAILURE;
    s.length = piece.length = program_text_map(piece.text, strlen(piece.text));
    if (piece.length > send->message_max - HEAD)
        warnx("the text has %zu bytes, a message holds %zu: write it to a file and use send", piece.length,
              send->message_max - HEAD);
    else
        status = send_pieces(&s);
    free(piece.text);
    return status;
}

enum exit_status client_send_file(const struct client_send *send, const char *path)
{
    struct program_text text;
    enum exit_status status = STATUS_FAILURE;
    struct sending s = {.send = send, .name = strcmp(path, "-") == 0 ? "<stdin>" : path, .file = true};
    const char *wrong = program_text_read(&text, path);
    if (wrong != NULL) {
        warnx("cannot read %s: %s", s.name, wrong);
    } else if (diagnose_text(s.name, text.text, text.length, stderr) == 0) {
        s.text = text.text;
        s.length = text.length;
        enum client_cut_result result = client_cut(&s.cut, text.text, text.length, send->message_max - HEAD);
        if (result == CLIENT_CUT_DONE)
            status = send_pieces(&s);
        else
            report_cut(&s, result);
        client_cut_free(&s.cut);
    }
    program_text_free(&text);
    return status;
}
