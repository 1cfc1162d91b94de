/* SPDX-License-Identifier: MIT */
#include "control_peer.h"

#include <poll.h>
#include <stdlib.h>
#include <string.h>

#include "control_rpc.h"

#define BYTES_AT_FIRST 4096u
#define BYTES_KEPT 65536u /* a larger buffer is given back when it is empty */
#define TOO_LONG "too long: expected a request of at most 1048576 bytes"

_Static_assert(PEER_LINE_MAX == 1048576u, "TOO_LONG says so");

/* ---- Bytes ---------------------------------------------------------------------------------------------------------- */

static size_t held(const struct bytes *bytes)
{
    return bytes->length - bytes->at;
}

/* Make room for `more` bytes behind those there are. Returns false if out of memory. */
static bool make_room(struct bytes *bytes, size_t more)
{
    if (bytes->room - bytes->length >= more)
        return true;
    if (bytes->at > 0) {
        memmove(bytes->byte, bytes->byte + bytes->at, held(bytes));
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

static void give_back(struct bytes *bytes)
{
    if (held(bytes) > 0)
        return;
    bytes->at = bytes->length = 0;
    if (bytes->room > BYTES_KEPT) {
        free(bytes->byte);
        *bytes = (struct bytes){0};
    }
}

/* ---- To the client -------------------------------------------------------------------------------------------------- */

size_t peer_queue(const struct peer *peer)
{
    return held(&peer->out) + held(&peer->wire);
}

/* Nothing more can be done for it. */
static void fail(struct peer *peer)
{
    peer->failed = true;
}

void peer_say(struct peer *peer, const char *text, size_t length)
{
    if (peer->closing || peer->failed)
        return;
    if (!make_room(&peer->out, length)) {
        fail(peer);
        return;
    }
    memcpy(peer->out.byte + peer->out.length, text, length);
    peer->out.length += length;
}

char *peer_tell(struct peer *peer, size_t room, uint64_t tick)
{
    if (peer->closing || peer->failed)
        return NULL;
    if (peer->lost > 0 || peer_queue(peer) + room > PEER_EVENTS_MAX || !make_room(&peer->out, room)) {
        if (peer->lost++ == 0)
            peer->lost_tick = tick;
        return NULL;
    }
    return peer->out.byte + peer->out.length;
}

void peer_told(struct peer *peer, const char *end)
{
    peer->out.length = (size_t)(end - peer->out.byte);
}

/* Half of what it had to read is read: say what it has missed. */
static void tell_lost(struct peer *peer)
{
    char *text = rpc_notification("lost", json_pack("{s:I, s:I}", "events", (json_int_t)peer->lost, "t_us",
                                                    (json_int_t)peer->lost_tick));
    if (!text)
        return;
    peer->lost = 0;
    peer_say(peer, text, strlen(text));
    free(text);
}

static void on_written(uv_write_t *write, int status)
{
    struct peer *peer = write->data;
    peer->writing = false;
    peer->wire.at = peer->wire.length;
    give_back(&peer->wire);
    if (status < 0)
        fail(peer);
    if (!peer->closing)
        peer_pump(peer);
}

/* Write what waits; the rest of it when the system takes it. */
static void write_out(struct peer *peer)
{
    while (!peer->writing && !peer->failed && held(&peer->out) > 0) {
        struct bytes empty = peer->wire;
        peer->wire = peer->out;
        peer->out = empty;
        uv_buf_t rest = uv_buf_init(peer->wire.byte + peer->wire.at, (unsigned)held(&peer->wire));
        int written = uv_try_write((uv_stream_t *)&peer->pipe, &rest, 1);
        if (written < 0 && written != UV_EAGAIN) {
            fail(peer);
            return;
        }
        peer->wire.at += written > 0 ? (size_t)written : 0;
        if (held(&peer->wire) == 0) {
            give_back(&peer->wire);
            continue;
        }
        rest = uv_buf_init(peer->wire.byte + peer->wire.at, (unsigned)held(&peer->wire));
        peer->writing = uv_write(&peer->write, (uv_stream_t *)&peer->pipe, &rest, 1, on_written) == 0;
        if (!peer->writing)
            fail(peer);
    }
}

/* Is it to be let go: has it ended its sending, and got all that it may wait for? */
static bool is_done(const struct peer *peer)
{
    return peer->leaving && held(&peer->in) == 0 && peer_queue(peer) == 0 && !peer->calls->is_expecting(peer);
}

void peer_pump(struct peer *peer)
{
    if (peer->closing)
        return;
    size_t before = peer_queue(peer);
    write_out(peer);
    if (peer->lost > 0 && peer_queue(peer) <= PEER_EVENTS_MAX / 2) {
        tell_lost(peer);
        write_out(peer);
    }
    if (peer->failed || is_done(peer)) {
        peer_close(peer);
        return;
    }
    if (before > PEER_QUEUE_MAX && peer_queue(peer) <= PEER_QUEUE_MAX)
        peer->calls->more(peer);
    peer->calls->pumped(peer);
}

/* ---- From the client ------------------------------------------------------------------------------------------------ */

static void on_room(uv_handle_t *handle, size_t suggested, uv_buf_t *buffer)
{
    struct peer *peer = handle->data;
    (void)suggested;
    size_t most = PEER_IN_MAX - held(&peer->in), room = most < BYTES_KEPT ? most : BYTES_KEPT;
    if (room == 0 || !make_room(&peer->in, room)) {
        *buffer = uv_buf_init(NULL, 0);
        return;
    }
    *buffer = uv_buf_init(peer->in.byte + peer->in.length, (unsigned)room);
}

/* It sends no more. Its last line is one only if it has its newline. */
static void leave(struct peer *peer)
{
    peer->reading = false;
    peer->leaving = true;
    uv_read_stop((uv_stream_t *)&peer->pipe);
    if (peer_gone(peer)) {
        peer_close(peer);
        return;
    }
    peer->calls->leaving(peer);
    peer->calls->more(peer);
}

static void set_reading(struct peer *peer);

static void on_read(uv_stream_t *stream, ssize_t length, const uv_buf_t *buffer)
{
    struct peer *peer = stream->data;
    (void)buffer;
    if (length == UV_EOF) {
        leave(peer);
    } else if (length < 0) {
        peer_close(peer);
    } else if (length > 0) {
        peer->in.length += (size_t)length;
        if (peer->calls->is_queued(peer) || peer_serve(peer, 0))
            peer->calls->more(peer);
        set_reading(peer);
    }
}

/* Hear it while there is room for what it says. */
static void set_reading(struct peer *peer)
{
    bool wanted = !peer->closing && !peer->leaving && held(&peer->in) < PEER_IN_MAX;
    if (wanted == peer->reading)
        return;
    if (wanted && uv_read_start((uv_stream_t *)&peer->pipe, on_room, on_read) != 0)
        fail(peer);
    if (!wanted)
        uv_read_stop((uv_stream_t *)&peer->pipe);
    peer->reading = wanted;
}

/* `length` bytes of `in` have been dealt with. */
static void consume(struct peer *peer, size_t length)
{
    peer->in.at += length;
    peer->looked = 0;
    give_back(&peer->in);
}

/* What there is has no newline: too much of it is given up, up to the newline. */
static void look_at_part(struct peer *peer)
{
    peer->looked = held(&peer->in);
    if (peer->skipping) {
        consume(peer, held(&peer->in));
    } else if (held(&peer->in) > PEER_LINE_MAX) {
        peer->skipping = true;
        peer->calls->refuse(peer, RPC_NO_REQUEST, TOO_LONG);
        consume(peer, held(&peer->in));
    } else if (peer->leaving && held(&peer->in) > 0) {
        peer->calls->refuse(peer, RPC_NO_JSON, "the last line has no newline: it was ignored");
        consume(peer, held(&peer->in));
    }
}

static bool is_blank(const char *line, size_t length)
{
    while (length > 0 && (line[length - 1] == ' ' || line[length - 1] == '\t' || line[length - 1] == '\r'))
        length--;
    return length == 0;
}

/* Deal with one line. Returns false if there is none that could be obeyed now. */
static bool serve_line(struct peer *peer)
{
    const char *begin = NULL, *end = NULL;
    if (held(&peer->in) > peer->looked) { /* otherwise there may be no buffer either */
        begin = peer->in.byte + peer->in.at;
        end = memchr(begin + peer->looked, '\n', held(&peer->in) - peer->looked);
    }
    if (!end) {
        look_at_part(peer);
        return false;
    }
    size_t length = (size_t)(end - begin);
    peer->looked = length;
    if (peer->skipping) {
        peer->skipping = false;
    } else if (length > PEER_LINE_MAX) {
        peer->calls->refuse(peer, RPC_NO_REQUEST, TOO_LONG);
    } else if (!is_blank(begin, length)) {
        if (!peer->calls->obey(peer, begin, length)) {
            peer->blocked = true;
            return false;
        }
    }
    if (!peer->closing)
        consume(peer, length + 1);
    return true;
}

bool peer_serve(struct peer *peer, uint64_t budget)
{
    uint64_t begin = uv_hrtime();
    while (!peer->closing && !peer->failed && !peer->calls->is_held(peer) && !peer->blocked &&
           peer_queue(peer) <= PEER_QUEUE_MAX) {
        if (!serve_line(peer)) {
            set_reading(peer);
            return false;
        }
        if (uv_hrtime() - begin >= budget)
            return held(&peer->in) > 0;
    }
    return false;
}

/* ---- Coming and going ----------------------------------------------------------------------------------------------- */

bool peer_accept(struct peer *peer, uv_loop_t *loop, uv_stream_t *listener, const struct peer_calls *calls)
{
    peer->calls = calls;
    peer->pipe.data = peer->write.data = peer;
    uv_pipe_init(loop, &peer->pipe, 0);
    if (uv_accept(listener, (uv_stream_t *)&peer->pipe) == 0)
        return true;
    peer_close(peer);
    return false;
}

void peer_start(struct peer *peer)
{
    set_reading(peer);
}

bool peer_gone(const struct peer *peer)
{
    uv_os_fd_t fd;
    if (uv_fileno((const uv_handle_t *)&peer->pipe, &fd) != 0)
        return true;
    struct pollfd look = {.fd = fd};
    return poll(&look, 1, 0) > 0 && (look.revents & (POLLHUP | POLLERR)) != 0;
}

static void on_closed(uv_handle_t *handle)
{
    struct peer *peer = handle->data;
    free(peer->in.byte);
    free(peer->out.byte);
    free(peer->wire.byte);
    peer->calls->closed(peer);
}

void peer_close(struct peer *peer)
{
    if (peer->closing)
        return;
    peer->closing = true;
    peer->calls->gone(peer);
    uv_close((uv_handle_t *)&peer->pipe, on_closed);
}
