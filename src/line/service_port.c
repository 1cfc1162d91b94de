/* SPDX-License-Identifier: MIT */
#include "service_port.h"

#include <stdlib.h>
#include <string.h>

#include "log.h"
#include "net_listen.h"

#define KEEPALIVE_S 30
#define LINGER_MS 1000u /* how long one that is hung up is kept for what it has not read */

struct service_connection {
    struct service_port *port;
    struct service_connection *next;
    unsigned client;     /* 0: none of ours, or no more */
    unsigned handles;    /* that are open */
    bool reading, writing, leaving, closing;
    bool was_read;       /* in this round; the others come first */
    uv_tcp_t tcp;
    uv_timer_t timer;    /* ends one that is leaving */
    uv_write_t write;
    size_t length, under_way; /* bytes in `out`; of these, those given to the system */
    uint8_t *out;        /* NULL: nothing waits */
    size_t at, end;      /* what was read and not taken: in[at..end) */
    uint8_t in[SERVICE_IN];
    char peer[NET_NAME_SIZE];
};

static void set_reading(struct service_connection *connection);
static void go_on_reading(struct service_connection *connection);

/* ---- The end of a connection ---------------------------------------------------------------------------------------- */

static void on_closed(uv_handle_t *handle)
{
    struct service_connection *connection = handle->data;
    struct service_connection **at = &connection->port->first;
    if (--connection->handles > 0)
        return;
    while (*at != connection)
        at = &(*at)->next;
    *at = connection->next;
    free(connection->out);
    free(connection);
}

static void close_connection(struct service_connection *connection)
{
    if (connection->closing)
        return;
    connection->closing = true;
    connection->client = 0;
    uv_close((uv_handle_t *)&connection->tcp, on_closed);
    uv_close((uv_handle_t *)&connection->timer, on_closed);
}

/* It has gone of itself, or is to go. */
static void lose_client(struct service_connection *connection, const char *why)
{
    unsigned client = connection->client;
    struct service_port *port = connection->port;
    close_connection(connection);
    if (client > 0)
        port->calls->closed(port->context, client, why);
}

static void on_linger(uv_timer_t *timer)
{
    close_connection(timer->data);
}

/* Reported from the loop, so that no call comes from within service_port_send(). */
static void on_failed(uv_timer_t *timer)
{
    lose_client(timer->data, "it does not read: hung up");
}

static void leave(struct service_connection *connection)
{
    connection->leaving = true;
    connection->client = 0;
    set_reading(connection);
    if (connection->length == 0)
        close_connection(connection);
    else
        uv_timer_start(&connection->timer, on_linger, LINGER_MS, 0);
}

/* ---- To a client ---------------------------------------------------------------------------------------------------- */

static void write_out(struct service_connection *connection);

static void on_written(uv_write_t *write, int status)
{
    struct service_connection *connection = write->data;
    connection->writing = false;
    connection->length -= connection->under_way;
    memmove(connection->out, connection->out + connection->under_way, connection->length);
    if (connection->closing)
        return;
    if (status < 0)
        lose_client(connection, "the connection has failed");
    else if (connection->length > 0)
        write_out(connection);
    else if (connection->leaving)
        close_connection(connection);
    else
        go_on_reading(connection);
}

static void write_out(struct service_connection *connection)
{
    uv_buf_t buffer = uv_buf_init((char *)connection->out, (unsigned)connection->length);
    connection->under_way = connection->length;
    connection->writing = uv_write(&connection->write, (uv_stream_t *)&connection->tcp, &buffer, 1, on_written) == 0;
    if (!connection->writing)
        uv_timer_start(&connection->timer, on_failed, 0, 0);
}

static void send_bytes(struct service_connection *connection, const uint8_t *bytes, size_t length)
{
    if (connection->closing || connection->leaving)
        return;
    if (!connection->writing && connection->length == 0) {
        uv_buf_t buffer = uv_buf_init((char *)bytes, (unsigned)length);
        int written = uv_try_write((uv_stream_t *)&connection->tcp, &buffer, 1);
        if (written == (int)length)
            return;
        bytes += written > 0 ? written : 0;
        length -= written > 0 ? (size_t)written : 0;
    }
    if (!connection->out)
        connection->out = malloc(SERVICE_OUT_MAX);
    if (!connection->out || length > SERVICE_OUT_MAX - connection->length) {
        uv_timer_start(&connection->timer, on_failed, 0, 0);
        return;
    }
    memcpy(connection->out + connection->length, bytes, length);
    connection->length += length;
    if (!connection->writing)
        write_out(connection);
    set_reading(connection);
}

static struct service_connection *find_connection(struct service_port *port, unsigned client)
{
    struct service_connection *connection = port->first;
    while (connection && connection->client != client)
        connection = connection->next;
    return connection;
}

void service_port_send(struct service_port *port, unsigned client, const uint8_t *bytes, size_t length)
{
    struct service_connection *connection = find_connection(port, client);
    if (connection)
        send_bytes(connection, bytes, length);
}

void service_port_greet(struct service_port *port, const uint8_t *bytes, size_t length)
{
    if (port->opening && length > 0)
        send_bytes(port->opening, bytes, length);
}

bool service_port_hang_up(struct service_port *port, unsigned client)
{
    struct service_connection *connection = find_connection(port, client);
    if (connection)
        leave(connection);
    return connection != NULL;
}

/* ---- From a client -------------------------------------------------------------------------------------------------- */

static void on_room(uv_handle_t *handle, size_t suggested, uv_buf_t *buffer)
{
    struct service_connection *connection = handle->data;
    (void)suggested;
    *buffer = uv_buf_init((char *)connection->in, SERVICE_IN);
}

static void set_all_reading(struct service_port *port)
{
    for (struct service_connection *connection = port->first; connection; connection = connection->next)
        set_reading(connection);
}

/* May it be asked for more, in this round and turn? A client that does not read what it is sent is not. */
static bool is_next(const struct service_connection *connection)
{
    return !connection->closing && !connection->leaving && connection->client > 0 && connection->length == 0 &&
           !connection->was_read && !connection->port->is_over;
}

/* Hand in what was read. What is not taken waits until the client has got its answers. */
static void hand_in(struct service_connection *connection)
{
    struct service_port *port = connection->port;
    port->reads++;
    connection->was_read = true;
    set_reading(connection);
    connection->at += port->calls->bytes(port->context, connection->client, connection->in + connection->at,
                                         connection->end - connection->at);
    port->is_over = uv_hrtime() >= port->stint_end;
    if (port->is_over)
        set_all_reading(port);
}

/* A turn of the loop begins. When each client that has sent something has been read, a new round begins. */
static void on_turn(uv_idle_t *turn)
{
    struct service_port *port = turn->data;
    if (port->reads == 0) {
        uv_idle_stop(turn);
        for (struct service_connection *connection = port->first; connection; connection = connection->next)
            connection->was_read = false;
    }
    port->reads = 0;
    port->is_over = false;
    port->stint_end = uv_hrtime() + SERVICE_STINT;
    for (struct service_connection *connection = port->first; connection; connection = connection->next)
        if (connection->at < connection->end && is_next(connection))
            hand_in(connection);
    if (port->reads > 0)
        uv_idle_start(turn, on_turn);
    set_all_reading(port);
}

static void begin_turn(struct service_port *port)
{
    if (uv_is_active((uv_handle_t *)&port->turn))
        return;
    uv_idle_start(&port->turn, on_turn);
    port->stint_end = uv_hrtime() + SERVICE_STINT;
}

/* It has got its answers. */
static void go_on_reading(struct service_connection *connection)
{
    if (connection->at < connection->end)
        begin_turn(connection->port);
    set_reading(connection);
}

static void on_read(uv_stream_t *stream, ssize_t length, const uv_buf_t *buffer)
{
    struct service_connection *connection = stream->data;
    (void)buffer;
    if (length < 0)
        lose_client(connection, NULL);
    if (length <= 0)
        return;
    begin_turn(connection->port);
    connection->at = 0;
    connection->end = (size_t)length;
    hand_in(connection);
}

/* However many clients send however much, each is read once in a round, and a turn of the loop has an end. */
static void set_reading(struct service_connection *connection)
{
    bool wanted = connection->at == connection->end && is_next(connection);
    if (wanted == connection->reading)
        return;
    if (!wanted)
        uv_read_stop((uv_stream_t *)&connection->tcp);
    connection->reading = wanted && uv_read_start((uv_stream_t *)&connection->tcp, on_room, on_read) == 0;
}

/* ---- Clients that come ---------------------------------------------------------------------------------------------- */

/* Returns false if it has been torn away already. */
static bool name_connection(struct service_connection *connection)
{
    struct sockaddr_storage from = {0};
    int size = sizeof from;
    if (uv_tcp_getpeername(&connection->tcp, (struct sockaddr *)&from, &size) != 0)
        return false;
    net_address_write(connection->peer, &from);
    return true;
}

static void admit_client(struct service_port *port, struct service_connection *connection)
{
    port->opening = connection;
    unsigned client = port->calls->open(port->context, connection->peer);
    port->opening = NULL;
    connection->client = client;
    if (client == 0 && port->refusal)
        send_bytes(connection, (const uint8_t *)port->refusal, strlen(port->refusal));
    if (client == 0)
        leave(connection);
    else
        set_reading(connection);
}

static void on_connection(uv_stream_t *listener, int status)
{
    struct service_port *port = listener->data;
    struct service_connection *connection = status == 0 ? calloc(1, sizeof *connection) : NULL;
    if (!connection)
        return;
    connection->port = port;
    connection->handles = 2;
    connection->next = port->first;
    port->first = connection;
    uv_tcp_init(listener->loop, &connection->tcp);
    uv_timer_init(listener->loop, &connection->timer);
    connection->tcp.data = connection->timer.data = connection->write.data = connection;
    if (uv_accept(listener, (uv_stream_t *)&connection->tcp) != 0 || !name_connection(connection)) {
        close_connection(connection);
        return;
    }
    uv_tcp_nodelay(&connection->tcp, 1);
    uv_tcp_keepalive(&connection->tcp, 1, KEEPALIVE_S);
    admit_client(port, connection);
}

/* ---- Begin and end -------------------------------------------------------------------------------------------------- */

bool service_port_open(struct service_port *port, uv_loop_t *loop, const char *address, const char *refusal,
                       const struct service_port_calls *calls, void *context)
{
    port->calls = calls;
    port->context = context;
    port->refusal = refusal;
    port->listener.data = port;
    int error = uv_tcp_init(loop, &port->listener);
    port->open = error == 0;
    port->turn.data = port;
    if (port->open)
        uv_idle_init(loop, &port->turn);
    const char *wrong =
        error != 0 ? uv_strerror(error) : net_listen(&port->listener, address, on_connection, port->address);
    if (!wrong)
        return true;
    log_error("cannot listen at %s: %s", address, wrong);
    service_port_close(port);
    return false;
}

void service_port_close(struct service_port *port)
{
    if (!port->open)
        return;
    port->open = false;
    uv_close((uv_handle_t *)&port->listener, NULL);
    uv_close((uv_handle_t *)&port->turn, NULL);
    for (struct service_connection *connection = port->first; connection; connection = connection->next)
        close_connection(connection);
}
