/* SPDX-License-Identifier: MIT */
#include "control_connection.h"

#include <stdlib.h>
#include <string.h>

#include "control_rpc.h"
#include "control_system.h"

#define BYTES_AT_FIRST 4096u
#define BYTES_KEPT 65536u /* a larger buffer is given back when it is empty */
#define TOO_LONG "too long: expected a request of at most 1048576 bytes"

_Static_assert(CONNECTION_LINE_MAX == 1048576u, "TOO_LONG says so");

/* ---- Bytes ---------------------------------------------------------------------------------------------------------- */

static size_t unread_length(const struct bytes *bytes)
{
    return bytes->length - bytes->at;
}

/* Make room for `more` bytes after those there are. Returns false if out of memory. */
static bool reserve(struct bytes *bytes, size_t more)
{
    if (bytes->room - bytes->length >= more)
        return true;
    if (bytes->at > 0) {
        memmove(bytes->byte, bytes->byte + bytes->at, unread_length(bytes));
        bytes->length -= bytes->at;
        bytes->at = 0;
    }
    size_t room = bytes->room > 0 ? bytes->room : BYTES_AT_FIRST;
    while (room - bytes->length < more)
        room *= 2;
    char *byte = room > bytes->room ? realloc(bytes->byte, room) : bytes->byte;
    if (!byte)
        return false;
    bytes->byte = byte;
    bytes->room = room;
    return true;
}

static void release_if_empty(struct bytes *bytes)
{
    if (unread_length(bytes) > 0)
        return;
    bytes->at = bytes->length = 0;
    if (bytes->room > BYTES_KEPT) {
        free(bytes->byte);
        *bytes = (struct bytes){0};
    }
}

/* ---- To the client -------------------------------------------------------------------------------------------------- */

size_t connection_unread(const struct connection *connection)
{
    return unread_length(&connection->out) + unread_length(&connection->wire);
}

/* Nothing more can be done for it. */
static void mark_failed(struct connection *connection)
{
    connection->failed = true;
}

void connection_send(struct connection *connection, const char *text, size_t length)
{
    if (connection->closing || connection->failed || connection->gone)
        return;
    if (!reserve(&connection->out, length)) {
        mark_failed(connection);
        return;
    }
    memcpy(connection->out.byte + connection->out.length, text, length);
    connection->out.length += length;
}

char *connection_begin_event(struct connection *connection, size_t room, uint64_t tick)
{
    if (connection->closing || connection->failed || connection->gone)
        return NULL;
    if (connection->lost > 0 || connection_unread(connection) + room > CONNECTION_EVENTS_MAX ||
        !reserve(&connection->out, room)) {
        if (connection->lost++ == 0)
            connection->lost_tick = tick;
        return NULL;
    }
    return connection->out.byte + connection->out.length;
}

void connection_end_event(struct connection *connection, const char *end)
{
    connection->out.length = (size_t)(end - connection->out.byte);
}

/* Half of what it had to read is read: say what it has missed. */
static void report_lost_events(struct connection *connection)
{
    char *text = rpc_notification("lost", json_pack("{s:I, s:I}", "events", (json_int_t)connection->lost, "t_us",
                                                    (json_int_t)connection->lost_tick));
    if (!text)
        return;
    connection->lost = 0;
    connection_send(connection, text, strlen(text));
    free(text);
}

static void on_written(uv_write_t *write, int status)
{
    struct connection *connection = write->data;
    connection->writing = false;
    connection->wire.at = connection->wire.length;
    release_if_empty(&connection->wire);
    if (status < 0)
        connection_forsake(connection);
    if (!connection->closing)
        connection_flush(connection);
}

/* Write what waits; the rest of it when the system takes it. */
static void write_out(struct connection *connection)
{
    while (!connection->writing && !connection->failed && unread_length(&connection->out) > 0) {
        struct bytes empty = connection->wire;
        connection->wire = connection->out;
        connection->out = empty;
        uv_buf_t rest = uv_buf_init(connection->wire.byte + connection->wire.at, (unsigned)unread_length(&connection->wire));
        int written = uv_try_write(&connection->end.stream, &rest, 1);
        if (written < 0 && written != UV_EAGAIN) {
            connection_forsake(connection);
            return;
        }
        connection->wire.at += written > 0 ? (size_t)written : 0;
        if (unread_length(&connection->wire) == 0) {
            release_if_empty(&connection->wire);
            continue;
        }
        rest = uv_buf_init(connection->wire.byte + connection->wire.at, (unsigned)unread_length(&connection->wire));
        connection->writing = uv_write(&connection->write, &connection->end.stream, &rest, 1, on_written) == 0;
        if (!connection->writing)
            mark_failed(connection);
    }
}

/* Is it to be closed: has it ended its sending, and got all that it may wait for? */
static bool is_done(const struct connection *connection)
{
    const struct connection_calls *calls = connection->calls;
    if (!connection->leaving || connection_unread(connection) > 0)
        return false;
    bool is_served = unread_length(&connection->in) == 0;
    if (connection->gone)
        return is_served || connection->blocked || calls->is_held(connection);
    return connection->is_tcp ? is_served || calls->is_held(connection) : is_served && !calls->is_expecting(connection);
}

void connection_flush(struct connection *connection)
{
    if (connection->closing)
        return;
    size_t before = connection_unread(connection);
    write_out(connection);
    if (connection->lost > 0 && connection_unread(connection) <= CONNECTION_EVENTS_MAX / 2) {
        report_lost_events(connection);
        write_out(connection);
    }
    if (connection->failed || is_done(connection)) {
        connection_close(connection);
        return;
    }
    if (before > CONNECTION_QUEUE_MAX && connection_unread(connection) <= CONNECTION_QUEUE_MAX)
        connection->calls->more(connection);
    connection->calls->flushed(connection);
}

/* ---- From the client ------------------------------------------------------------------------------------------------ */

static void on_room(uv_handle_t *handle, size_t suggested, uv_buf_t *buffer)
{
    struct connection *connection = handle->data;
    (void)suggested;
    size_t limit = connection->stranger ? BYTES_AT_FIRST : CONNECTION_IN_MAX, most = limit - unread_length(&connection->in);
    size_t room = most < BYTES_KEPT ? most : BYTES_KEPT;
    if (room == 0 || !reserve(&connection->in, room)) {
        *buffer = uv_buf_init(NULL, 0);
        return;
    }
    *buffer = uv_buf_init(connection->in.byte + connection->in.length, (unsigned)room);
}

/* It sends no more. Its last line is one only if it has its newline. */
static void end_input(struct connection *connection)
{
    connection->reading = false;
    connection->leaving = true;
    uv_read_stop(&connection->end.stream);
    if (connection_is_gone(connection)) {
        connection_forsake(connection);
        return;
    }
    connection->calls->leaving(connection);
    connection->calls->more(connection);
}

static void set_reading(struct connection *connection);

/* Bytes of one that has been turned away. */
static void ignore(struct connection *connection, size_t length)
{
    connection->ignored += length;
    if (connection->ignored > CONNECTION_IGNORED_MAX)
        connection_close(connection);
}

static void on_read(uv_stream_t *stream, ssize_t length, const uv_buf_t *buffer)
{
    struct connection *connection = stream->data;
    (void)buffer;
    if (length < 0 && (length != UV_EOF || connection->turned_away || connection->stranger)) {
        connection_forsake(connection);
    } else if (length < 0) {
        end_input(connection);
    } else if (connection->turned_away) {
        ignore(connection, (size_t)length);
    } else if (length > 0) {
        connection->in.length += (size_t)length;
        if (connection->calls->is_queued(connection) || connection_serve(connection, 0))
            connection->calls->more(connection);
        set_reading(connection);
    }
}

/* Hear it while there is room for what it says. */
static void set_reading(struct connection *connection)
{
    bool wanted = !connection->closing && !connection->leaving && unread_length(&connection->in) < CONNECTION_IN_MAX;
    if (wanted == connection->reading)
        return;
    if (wanted && uv_read_start(&connection->end.stream, on_room, on_read) != 0)
        mark_failed(connection);
    if (!wanted)
        uv_read_stop(&connection->end.stream);
    connection->reading = wanted;
}

/* `length` bytes of `in` have been dealt with. */
static void consume(struct connection *connection, size_t length)
{
    connection->in.at += length;
    connection->scanned = 0;
    release_if_empty(&connection->in);
}

static size_t line_max(const struct connection *connection)
{
    return connection->stranger ? CONNECTION_FIRST_MAX : CONNECTION_LINE_MAX;
}

/* What there is has no newline: too much of it is given up, up to the newline. */
static void skip_long_line(struct connection *connection)
{
    connection->scanned = unread_length(&connection->in);
    if (connection->skipping) {
        consume(connection, unread_length(&connection->in));
    } else if (unread_length(&connection->in) > line_max(connection)) {
        connection->skipping = true;
        connection->calls->refuse(connection, RPC_NO_REQUEST, TOO_LONG);
        consume(connection, unread_length(&connection->in));
    } else if (connection->leaving && unread_length(&connection->in) > 0) {
        connection->calls->refuse(connection, RPC_NO_JSON, "the last line has no newline: it was ignored");
        consume(connection, unread_length(&connection->in));
    }
}

static bool is_blank(const char *line, size_t length)
{
    while (length > 0 && (line[length - 1] == ' ' || line[length - 1] == '\t' || line[length - 1] == '\r'))
        length--;
    return length == 0;
}

/* Handle one line. Returns false if there is none that could be executed now. */
static bool serve_line(struct connection *connection)
{
    const char *begin = NULL, *end = NULL;
    if (unread_length(&connection->in) > connection->scanned) { /* otherwise there may be no buffer either */
        begin = connection->in.byte + connection->in.at;
        end = memchr(begin + connection->scanned, '\n', unread_length(&connection->in) - connection->scanned);
    }
    if (!end) {
        skip_long_line(connection);
        return false;
    }
    size_t length = (size_t)(end - begin);
    connection->scanned = length;
    if (connection->skipping) {
        connection->skipping = false;
    } else if (length > line_max(connection)) {
        connection->calls->refuse(connection, RPC_NO_REQUEST, TOO_LONG);
    } else if (!is_blank(begin, length)) {
        if (!connection->calls->handle_line(connection, begin, length)) {
            connection->blocked = true;
            return false;
        }
    }
    if (!connection->closing && !connection->turned_away)
        consume(connection, length + 1);
    return true;
}

bool connection_serve(struct connection *connection, uint64_t budget)
{
    uint64_t begin = uv_hrtime();
    while (!connection->closing && !connection->failed && !connection->turned_away && !connection->blocked &&
           !connection->calls->is_held(connection) && connection_unread(connection) <= CONNECTION_QUEUE_MAX) {
        if (!serve_line(connection)) {
            set_reading(connection);
            return false;
        }
        if (uv_hrtime() - begin >= budget)
            return unread_length(&connection->in) > 0;
    }
    return false;
}

/* ---- Coming and going ----------------------------------------------------------------------------------------------- */

bool connection_accept(struct connection *connection, uv_loop_t *loop, uv_stream_t *listener,
                       const struct connection_calls *calls)
{
    connection->calls = calls;
    connection->is_tcp = connection->stranger = listener->type == UV_TCP;
    if (connection->is_tcp)
        uv_tcp_init(loop, &connection->end.tcp);
    else
        uv_pipe_init(loop, &connection->end.pipe, 0);
    connection->end.handle.data = connection->write.data = connection;
    if (uv_accept(listener, &connection->end.stream) == 0)
        return true;
    connection_close(connection);
    return false;
}

void connection_start(struct connection *connection)
{
    if (connection->is_tcp)
        uv_tcp_nodelay(&connection->end.tcp, 1);
    set_reading(connection);
}

void connection_admit(struct connection *connection)
{
    connection->stranger = false;
}

void connection_turn_away(struct connection *connection)
{
    connection_flush(connection);
    if (connection->closing)
        return;
    connection->turned_away = true;
    connection->in.at = connection->in.length = connection->scanned = 0;
    if (uv_shutdown(&connection->shutdown, &connection->end.stream, NULL) != 0)
        connection_close(connection);
}

void connection_forsake(struct connection *connection)
{
    if (connection->closing || connection->gone)
        return;
    if (connection->stranger || connection->turned_away) {
        connection_close(connection);
        return;
    }
    connection->gone = connection->leaving = true;
    connection->reading = false;
    uv_read_stop(&connection->end.stream);
    connection->out.at = connection->out.length;
    if (!connection->writing)
        connection->wire.at = connection->wire.length;
    connection->calls->more(connection);
}

bool connection_is_gone(const struct connection *connection)
{
    return !connection->is_tcp && control_system_is_gone(&connection->end.pipe);
}

static void on_closed(uv_handle_t *handle)
{
    struct connection *connection = handle->data;
    free(connection->in.byte);
    free(connection->out.byte);
    free(connection->wire.byte);
    connection->calls->closed(connection);
}

void connection_abandon(struct connection *connection)
{
    connection->closing = true;
    connection->calls->gone(connection);
}

void connection_hang_up(struct connection *connection)
{
    uv_close(&connection->end.handle, on_closed);
}

void connection_close(struct connection *connection)
{
    if (connection->closing)
        return;
    connection_abandon(connection);
    connection_hang_up(connection);
}
