/* SPDX-License-Identifier: MIT */
/* A line over TCP.
 *
 *     client --on_read--> in --digest--> to_line --deliver--> bytes()
 *                              |
 *                              v
 *                           replies --+
 *     net_port_send() --> to_client --+--pump--> wire --> client
 *
 * transfer() does all of it until nothing moves any more. Commands of RFC 2217 overtake data that wait for room, as they do on a
 * serial port; replies that the client does not read stop the port from reading it, so that none is lost. */
#include "net_port.h"

#include <stdio.h>
#include <string.h>

#include "log.h"
#include "net_listen.h"
#include "net_socket.h"
#include "text/text.h"

#define LAST_READS 8    /* of NET_IN bytes each: what is still read of a client that gives way */
#define KEEPALIVE_S 30  /* a client that has vanished gives the line free */
#define LINGER_MS 1000  /* how long one that only sends no more is kept without a byte, and one that is sent away at most */

enum connection_state {
    CONNECTION_FREE,
    CONNECTION_CLIENT,  /* has the line */
    CONNECTION_LEAVING, /* has closed its side, and may wait for an answer; gives way to a new client */
    CONNECTION_REFUSED, /* is being sent away */
    CONNECTION_CLOSING
};

static void transfer(struct net_port *port);
static void on_linger(uv_timer_t *timer);
static void accept_connection(struct net_port *port);

static size_t min_size(size_t a, size_t b)
{
    return a < b ? a : b;
}

/* ---- Peers ---------------------------------------------------------------------------------------------------------- */

static void on_connection_closed(uv_handle_t *handle)
{
    struct net_connection *connection = handle->data;
    if (--connection->open_handles > 0)
        return;
    connection->state = CONNECTION_FREE;
    if (connection->port->waiting)
        accept_connection(connection->port);
}

static void close_connection(struct net_connection *connection)
{
    connection->state = CONNECTION_CLOSING;
    uv_close((uv_handle_t *)&connection->tcp, on_connection_closed);
    uv_close((uv_handle_t *)&connection->timer, on_connection_closed);
}

/* The client no longer has the line. What it has written stays and goes to the units. */
static void detach_client(struct net_port *port)
{
    struct net_connection *connection = port->client;
    port->unread = port->in_length - port->in_at + net_socket_waiting(&connection->tcp);
    port->client = NULL;
    port->attached = port->reading = false;
    port->dropped += port->to_client_count;
    port->to_client_count = port->replies_length = port->in_at = port->in_length = 0;
    close_connection(connection);
    if (port->rfc2217.breaking && port->calls->line_break)
        port->calls->line_break(port->context, false);
    port->calls->event(port->context, NET_DETACHED, connection->name);
}

/* ---- To the client -------------------------------------------------------------------------------------------------- */

static void fail_connection(struct net_connection *connection)
{
    connection->failed = true; /* reading reports it, too, unless it has ended */
    if (connection->state == CONNECTION_LEAVING)
        uv_timer_start(&connection->timer, on_linger, 0, 0);
}

static void on_written(uv_write_t *write, int status)
{
    struct net_connection *connection = write->data;
    connection->writing = false;
    if (connection->port->client != connection)
        return;
    if (status < 0)
        fail_connection(connection);
    transfer(connection->port);
}

/* Data as they go over the connection. `out` takes 2 * length bytes with RFC 2217. Returns their number there. */
static size_t encode_output(const struct net_port *port, const uint8_t *data, size_t length, uint8_t *out)
{
    if (port->kind == NET_RFC2217)
        return rfc2217_escape(data, length, out);
    memcpy(out, data, length);
    return length;
}

/* Fill the wire of a client with replies and data. A reply is never cut, for data must not get into it. */
static void fill_wire(struct net_port *port, struct net_connection *connection)
{
    memcpy(connection->wire, port->replies, port->replies_length);
    connection->wire_length = port->replies_length;
    port->replies_length = 0;
    while (port->to_client_count > 0 && !port->rfc2217.suspended) {
        const uint8_t *from = port->to_client + port->to_client_head;
        size_t room = NET_WIRE - connection->wire_length;
        size_t length = min_size(port->to_client_count, NET_TO_CLIENT - port->to_client_head);
        length = min_size(length, port->kind == NET_RFC2217 ? room / 2 : room);
        if (length == 0)
            return;
        connection->wire_length += encode_output(port, from, length, connection->wire + connection->wire_length);
        port->to_client_head = (port->to_client_head + length) % NET_TO_CLIENT;
        port->to_client_count -= length;
    }
}

/* Write what waits until the system takes no more. */
static void write_output(struct net_port *port)
{
    struct net_connection *connection = port->client;
    while (connection && !connection->writing) {
        fill_wire(port, connection);
        if (connection->wire_length == 0)
            return;
        port->moved = uv_now(connection->tcp.loop);
        uv_buf_t rest = uv_buf_init((char *)connection->wire, (unsigned)connection->wire_length);
        int written = connection->failed ? (int)connection->wire_length : uv_try_write((uv_stream_t *)&connection->tcp, &rest, 1);
        if (written < 0 && written != UV_EAGAIN) {
            fail_connection(connection);
        } else if (written < (int)connection->wire_length) {
            size_t done = written < 0 ? 0 : (size_t)written;
            rest = uv_buf_init((char *)connection->wire + done, (unsigned)(connection->wire_length - done));
            connection->writing = uv_write(&connection->write, (uv_stream_t *)&connection->tcp, &rest, 1, on_written) == 0;
            if (!connection->writing)
                fail_connection(connection);
        }
    }
}

size_t net_port_send(struct net_port *port, const uint8_t *bytes, size_t length)
{
    size_t taken = port->client && !port->client->failed ? min_size(length, NET_TO_CLIENT - port->to_client_count) : 0;
    for (size_t i = 0; i < taken; i++)
        port->to_client[(port->to_client_head + port->to_client_count++) % NET_TO_CLIENT] = bytes[i];
    port->dropped += length - taken;
    write_output(port);
    return length - taken;
}

/* ---- From the client ------------------------------------------------------------------------------------------------ */

/* Hand over what there is room for. */
static void deliver_input(struct net_port *port)
{
    while (port->to_line_count > 0) {
        size_t room = port->calls->room ? port->calls->room(port->context) : SIZE_MAX;
        size_t length = min_size(min_size(port->to_line_count, NET_TO_LINE - port->to_line_head), room);
        if (length == 0)
            return;
        const uint8_t *bytes = port->to_line + port->to_line_head;
        port->to_line_head = (port->to_line_head + length) % NET_TO_LINE;
        port->to_line_count -= length;
        port->moved = uv_now(port->listener.loop);
        port->calls->bytes(port->context, bytes, length);
    }
}

static void purge(struct net_port *port)
{
    if (port->rfc2217.purge & RFC2217_PURGE_TO_CLIENT)
        port->to_client_count = 0;
    if (port->rfc2217.purge & RFC2217_PURGE_TO_LINE) {
        port->to_line_count = 0;
        if (port->calls->purge)
            port->calls->purge(port->context);
    }
}

static void set_break(struct net_port *port, bool on)
{
    if (port->calls->line_break)
        port->calls->line_break(port->context, on);
}

/* Follow what the client has commanded, after the data it sent before. */
static void apply_event(struct net_port *port, enum rfc2217_event event)
{
    const struct rfc2217 *set = &port->rfc2217;
    if (event == RFC2217_PURGE) {
        purge(port);
        return;
    }
    deliver_input(port);
    if (event == RFC2217_SETTINGS && port->calls->settings)
        port->calls->settings(port->context, set->baud, set->data_bits, set->parity, set->stop_bits);
    else if (event == RFC2217_LINES && port->calls->lines)
        port->calls->lines(port->context, set->dtr, set->rts);
    if (event == RFC2217_BREAK_PULSE)
        set_break(port, true);
    if (event == RFC2217_BREAK || event == RFC2217_BREAK_PULSE)
        set_break(port, set->breaking);
}

static void queue_data(struct net_port *port, uint8_t byte)
{
    port->to_line[(port->to_line_head + port->to_line_count++) % NET_TO_LINE] = byte;
}

static void queue_reply(struct net_port *port)
{
    memcpy(port->replies + port->replies_length, port->rfc2217.reply, port->rfc2217.reply_length);
    port->replies_length += port->rfc2217.reply_length;
}

/* Check the bytes read while there is room for what they bring. Returns true if there were any. */
static bool process_input(struct net_port *port)
{
    size_t before = port->in_at;
    while (port->in_at < port->in_length && port->to_line_count < NET_TO_LINE &&
           port->replies_length + RFC2217_REPLY_MAX <= NET_REPLIES) {
        uint8_t byte = port->in[port->in_at++];
        if (port->kind == NET_RAW) {
            queue_data(port, byte);
            continue;
        }
        enum rfc2217_event event = rfc2217_receive(&port->rfc2217, byte);
        queue_reply(port);
        if (event == RFC2217_DATA)
            queue_data(port, port->rfc2217.data);
        else if (event != RFC2217_NOTHING)
            apply_event(port, event);
    }
    return port->in_at > before;
}

static void on_linger(uv_timer_t *timer)
{
    struct net_connection *connection = timer->data;
    struct net_port *port = connection->port;
    if (connection->state == CONNECTION_REFUSED)
        close_connection(connection);
    else if (!connection->failed && (port->to_line_count > 0 || uv_now(timer->loop) - port->moved < LINGER_MS))
        uv_timer_start(timer, on_linger, LINGER_MS, 0);
    else
        detach_client(port);
}

/* The client sends no more. It may have closed its sending side alone, as nc and socat do at the end of their input. */
static void end_input(struct net_connection *connection)
{
    struct net_port *port = connection->port;
    uv_read_stop((uv_stream_t *)&connection->tcp);
    port->reading = false;
    connection->state = CONNECTION_LEAVING;
    port->moved = uv_now(connection->tcp.loop);
    uv_timer_start(&connection->timer, on_linger, connection->failed ? 0 : LINGER_MS, 0);
}

static void on_room(uv_handle_t *handle, size_t suggested, uv_buf_t *buffer)
{
    static uint8_t refused[256];
    struct net_connection *connection = handle->data;
    (void)suggested;
    if (connection->state == CONNECTION_REFUSED)
        *buffer = uv_buf_init((char *)refused, sizeof refused);
    else
        *buffer = uv_buf_init((char *)connection->port->in, NET_IN);
}

static void on_read(uv_stream_t *stream, ssize_t length, const uv_buf_t *buffer)
{
    struct net_connection *connection = stream->data;
    struct net_port *port = connection->port;
    (void)buffer;
    if (length == 0)
        return;
    if (connection->state == CONNECTION_REFUSED) {
        if (length < 0)
            close_connection(connection);
    } else if (length == UV_EOF) {
        end_input(connection);
    } else if (length < 0) {
        detach_client(port);
    } else {
        port->in_at = 0;
        port->in_length = (size_t)length;
        transfer(port);
    }
}

/* Read on when all that has been read is on its way. */
static void set_reading(struct net_port *port)
{
    struct net_connection *connection = port->client;
    bool wanted = connection && connection->state == CONNECTION_CLIENT && port->in_at == port->in_length;
    if (wanted == port->reading)
        return;
    if (wanted)
        wanted = uv_read_start((uv_stream_t *)&connection->tcp, on_room, on_read) == 0;
    else if (connection)
        uv_read_stop((uv_stream_t *)&connection->tcp);
    port->reading = wanted;
}

static void transfer(struct net_port *port)
{
    if (port->moving)
        return;
    port->moving = true;
    do {
        deliver_input(port); /* before the input is read again: it may be all that there was no room for */
        write_output(port);
    } while (process_input(port));
    port->moving = false;
    set_reading(port);
}

void net_port_wake(struct net_port *port)
{
    if (port->open && port->to_line_count > 0)
        transfer(port);
}

/* ---- Who comes ------------------------------------------------------------------------------------------------------ */

static void attach_client(struct net_port *port, struct net_connection *connection)
{
    connection->state = CONNECTION_CLIENT;
    port->client = connection;
    port->attached = true;
    if (port->kind == NET_RFC2217) {
        rfc2217_begin(&port->rfc2217);
        queue_reply(port);
    }
    port->calls->event(port->context, NET_ATTACHED, connection->name);
    transfer(port);
}

/* The text of the refusal has to arrive, so what the client sends is read until it has closed its side, or for a while. */
static void refuse_client(struct net_port *port, struct net_connection *connection, const char *owner)
{
    connection->state = CONNECTION_REFUSED;
    int length = snprintf((char *)connection->wire, NET_WIRE, "rkm04: refused: the bus is in use by %.200s\r\n", owner);
    uv_buf_t text = uv_buf_init((char *)connection->wire, (unsigned)length);
    if (uv_try_write((uv_stream_t *)&connection->tcp, &text, 1) != length ||
        uv_shutdown(&connection->shutdown, (uv_stream_t *)&connection->tcp, NULL) != 0 ||
        uv_read_start((uv_stream_t *)&connection->tcp, on_room, on_read) != 0)
        close_connection(connection);
    else
        uv_timer_start(&connection->timer, on_linger, LINGER_MS, 0);
    port->calls->event(port->context, NET_REFUSED, connection->name);
}

/* The client may have closed its side after more bytes than have been read. Then those that there is room for are read. */
static void check_for_end(struct net_port *port)
{
    struct net_connection *connection = port->client;
    if (!connection || connection->state != CONNECTION_CLIENT || port->moving || !net_socket_has_ended(&connection->tcp))
        return;
    for (unsigned i = 0; i < LAST_READS && port->in_at == port->in_length && port->client == connection; i++) {
        ssize_t length = net_socket_read(&connection->tcp, port->in, NET_IN);
        if (length <= 0) {
            connection->failed = connection->failed || length < 0;
            break;
        }
        port->in_at = 0;
        port->in_length = (size_t)length;
        transfer(port);
    }
    if (port->client == connection)
        end_input(connection);
}

const char *net_port_client(struct net_port *port)
{
    check_for_end(port);
    return port->client && port->client->state == CONNECTION_CLIENT ? port->client->name : NULL;
}

/* A place for one more. NULL: there is one as soon as a connection has been closed. */
static struct net_connection *find_free_connection(struct net_port *port)
{
    struct net_connection *oldest = NULL;
    for (size_t i = 0; i < NET_CONNECTIONS; i++) {
        struct net_connection *connection = &port->connections[i];
        if (connection->state == CONNECTION_FREE)
            return connection;
        if (connection->state == CONNECTION_REFUSED && (!oldest || connection->number < oldest->number))
            oldest = connection;
    }
    if (oldest)
        close_connection(oldest);
    return NULL;
}

/* Returns false if it has been torn away already. */
static bool name_connection(struct net_connection *connection)
{
    struct sockaddr_storage from = {0};
    int size = sizeof from;
    if (uv_tcp_getpeername(&connection->tcp, (struct sockaddr *)&from, &size) != 0)
        return false;
    net_address_write(connection->name, &from);
    return true;
}

/* Take the connection that waits, if there is room to remember it; otherwise it waits on. */
static void accept_connection(struct net_port *port)
{
    struct net_connection *connection = port->open ? find_free_connection(port) : NULL;
    uv_loop_t *loop = port->listener.loop;
    port->waiting = port->open && !connection;
    if (!connection)
        return;
    *connection = (struct net_connection){.port = port, .open_handles = 2, .number = port->arrived++};
    uv_tcp_init(loop, &connection->tcp);
    uv_timer_init(loop, &connection->timer);
    connection->tcp.data = connection->timer.data = connection->write.data = connection;
    if (uv_accept((uv_stream_t *)&port->listener, (uv_stream_t *)&connection->tcp) != 0) {
        close_connection(connection);
        return;
    }
    if (port->unplugged || !name_connection(connection)) {
        close_connection(connection);
        return;
    }
    uv_tcp_nodelay(&connection->tcp, 1);
    uv_tcp_keepalive(&connection->tcp, 1, KEEPALIVE_S);
    const char *owner = net_port_client(port);
    if (port->client && !owner)
        detach_client(port); /* it gives way */
    if (!owner && port->calls->owner)
        owner = port->calls->owner(port->context);
    if (owner)
        refuse_client(port, connection, owner);
    else
        attach_client(port, connection);
}

static void on_connection(uv_stream_t *listener, int status)
{
    if (status == 0)
        accept_connection(listener->data);
}

/* ---- Begin and end -------------------------------------------------------------------------------------------------- */

static bool report_cannot_listen(const char *address, const char *why)
{
    log_error("cannot listen at %s: %s", address, why);
    return false;
}

bool net_port_open(struct net_port *port, uv_loop_t *loop, const char *address, enum net_kind kind,
                   const struct net_port_calls *calls, void *context)
{
    port->kind = kind;
    port->calls = calls;
    port->context = context;
    port->listener.data = port;
    int error = uv_tcp_init(loop, &port->listener);
    if (error != 0)
        return report_cannot_listen(address, uv_strerror(error));
    port->open = true;
    const char *wrong = net_listen(&port->listener, address, on_connection, port->address);
    if (!wrong)
        return true;
    net_port_close(port);
    return report_cannot_listen(address, wrong);
}

void net_port_plug(struct net_port *port, bool plugged)
{
    port->unplugged = !plugged;
    if (plugged)
        return;
    if (port->client)
        detach_client(port);
    port->to_line_count = 0;
}

void net_port_close(struct net_port *port)
{
    if (!port->open)
        return;
    port->open = port->attached = port->reading = port->waiting = false;
    port->client = NULL;
    port->to_line_count = port->in_at = port->in_length = 0;
    uv_close((uv_handle_t *)&port->listener, NULL);
    for (size_t i = 0; i < NET_CONNECTIONS; i++)
        if (port->connections[i].state != CONNECTION_FREE && port->connections[i].state != CONNECTION_CLOSING)
            close_connection(&port->connections[i]);
}
