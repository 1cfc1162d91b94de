/* SPDX-License-Identifier: MIT */
#include "window_control.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "client/client.h"
#include "window_system.h"

#define LINE_MAX_BYTES (4u * 1024u * 1024u)
#define ROOM_FIRST 65536u

struct window_control {
    union window_stream connection;
    struct window_control_calls calls;
    char *buffer;
    size_t length, room;
    bool closed;
};

struct sending {
    uv_write_t write;
    char text[];
};

static void on_closed(uv_handle_t *handle)
{
    struct window_control *control = handle->data;
    free(control->buffer);
    free(control);
}

void window_control_close(struct window_control *control)
{
    if (control == NULL || control->closed)
        return;
    control->closed = true;
    uv_close(&control->connection.handle, on_closed);
}

static void on_room(uv_handle_t *handle, size_t suggested, uv_buf_t *buffer)
{
    struct window_control *control = handle->data;
    (void)suggested;
    if (control->room - control->length < ROOM_FIRST / 2) {
        size_t room = control->room > 0 ? 2 * control->room : ROOM_FIRST;
        char *grown = room <= LINE_MAX_BYTES ? realloc(control->buffer, room) : NULL;
        if (grown != NULL) {
            control->buffer = grown;
            control->room = room;
        }
    }
    size_t left = control->room - control->length;
    *buffer = uv_buf_init(left > 0 ? control->buffer + control->length : NULL, (unsigned)left);
}

/* Hand on the whole lines; what is left moves to the front. */
static void take_lines(struct window_control *control)
{
    size_t begin = 0;
    char *end;
    while (!control->closed && (end = memchr(control->buffer + begin, '\n', control->length - begin)) != NULL) {
        char *line = control->buffer + begin;
        *end = '\0';
        begin = (size_t)(end - control->buffer) + 1;
        control->calls.line(control->calls.context, line, (size_t)(end - line));
    }
    memmove(control->buffer, control->buffer + begin, control->length - begin);
    control->length -= begin;
}

static void on_read(uv_stream_t *stream, ssize_t length, const uv_buf_t *buffer)
{
    struct window_control *control = stream->data;
    (void)buffer;
    if (length < 0) {
        uv_read_stop(stream);
        control->calls.ended(control->calls.context);
        return;
    }
    control->length += (size_t)length;
    take_lines(control);
}

struct window_control *window_control_open(uv_loop_t *loop, const char *path, const struct window_control_calls *calls,
                                           char trouble[256])
{
    struct client_rpc rpc = {.quiet = true};
    struct window_control *control = calloc(1, sizeof *control);
    if (control == NULL || !client_rpc_open(&rpc, path)) {
        snprintf(trouble, 256, "%.255s", control == NULL ? "out of memory" : rpc.trouble);
        free(control);
        return NULL;
    }
    free(rpc.buffer); /* nothing comes unasked */
    control->calls = *calls;
    int error = window_stream_open(loop, &control->connection, rpc.fd);
    control->connection.handle.data = control;
    if (error != 0 || uv_read_start(&control->connection.stream, on_room, on_read) != 0) {
        snprintf(trouble, 256, "%.200s: cannot be read", path);
        window_control_close(control);
        return NULL;
    }
    return control;
}

static void on_sent(uv_write_t *write, int status)
{
    (void)status; /* reading shows that the emulator has gone */
    free(write->data);
}

void window_control_send(struct window_control *control, const char *text, size_t length)
{
    struct sending *sending = control->closed ? NULL : malloc(sizeof *sending + length + 1);
    if (sending == NULL)
        return;
    memcpy(sending->text, text, length);
    sending->text[length] = '\n';
    sending->write.data = sending;
    uv_buf_t buffer = uv_buf_init(sending->text, (unsigned)length + 1);
    if (uv_write(&sending->write, &control->connection.stream, &buffer, 1, on_sent) != 0)
        free(sending);
}
