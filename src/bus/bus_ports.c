/* SPDX-License-Identifier: MIT */
#include "bus_ports.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "wire/wire.h"

#define READ_STINT 2000000u       /* ns: longest time a turn of the loop for reading one bus */
#define REFUSED_LOGGED 100u       /* network clients that were sent away, in the log */
#define RETRY_MS 1000u            /* between two tries to have a new pty */

unsigned bus_ports_clients(const struct bus_ports *ports)
{
    return (ports->options->pty ? ports->line.clients : 0) + (ports->tcp && ports->tcp->attached) +
           (ports->rfc2217 && ports->rfc2217->attached);
}

uint64_t bus_ports_dropped(const struct bus_ports *ports)
{
    return ports->line.dropped + (ports->tcp ? ports->tcp->dropped : 0) + (ports->rfc2217 ? ports->rfc2217->dropped : 0);
}

/* ---- What the client has set ---------------------------------------------------------------------------------------- */

static bool is_strict(const struct bus_ports *ports)
{
    return ports->options->strict_line && !line_settings_equal(ports->known, ports->unit);
}

/* The settings of the client who is there. Raw TCP has none. */
static struct line_settings present_settings(const struct bus_ports *ports)
{
    struct line_settings settings = ports->unit;
    if (ports->rfc2217 && ports->rfc2217->attached)
        return ports->net;
    if (ports->options->pty && ports->line.clients > 0)
        line_settings_read(ports->line.fd, &settings);
    return settings;
}

/* Log the settings of the client if they have changed. */
static void apply_new_settings(struct bus_ports *ports)
{
    char change[LINE_SETTINGS_CHANGE_MAX];
    if (!line_settings_changed(&ports->known, present_settings(ports), ports->unit, change))
        return;
    bus_log(ports->log, "%s", change);
    line_receiver_begin(&ports->to_units, ports->known, ports->unit, false);
    line_receiver_begin(&ports->to_client, ports->unit, ports->known, true);
}

/* ---- To the units --------------------------------------------------------------------------------------------------- */

/* Bytes of the client that can be taken. Each may be received as several, and one more when it falls silent. */
static size_t free_room(const struct bus_ports *ports)
{
    size_t most = ports->calls->room(ports->context);
    return !ports->options->strict_line ? most : most > 0 ? (most - 1) / LINE_RECEIVER_MAX : 0;
}

static void pass_received(struct bus_ports *ports, const struct line_received *received, size_t number)
{
    for (size_t i = 0; i < number; i++)
        ports->calls->take(ports->context, &received[i].byte, 1, received[i].tick);
}

/* The client has sent something; `length` <= free_room(). */
static void pass_to_units(struct bus_ports *ports, const uint8_t *bytes, size_t length)
{
    struct line_received received[LINE_RECEIVER_MAX];
    uint64_t tick = ports->log->present(ports->log->context);
    if (!is_strict(ports)) {
        ports->calls->take(ports->context, bytes, length, tick);
        return;
    }
    for (size_t i = 0; i < length; i++)
        pass_received(ports, received, line_receiver_byte(&ports->to_units, bytes[i], tick, received));
    pass_received(ports, received, line_receiver_silence(&ports->to_units, received));
}

/* ---- To the clients ------------------------------------------------------------------------------------------------- */

static void send_to_client(struct bus_ports *ports, const uint8_t *bytes, size_t length)
{
    struct line *line = &ports->line;
    bool nobody = bus_ports_clients(ports) == 0;
    if (ports->tcp && (ports->tcp->attached || (nobody && line->fd < 0)))
        net_port_send(ports->tcp, bytes, length);
    if (ports->rfc2217 && (ports->rfc2217->attached || (nobody && line->fd < 0 && !ports->tcp)))
        net_port_send(ports->rfc2217, bytes, length);
    if (line->fd < 0 || (line->clients == 0 && !nobody))
        return;
    size_t dropped = line_write(line, bytes, length);
    if (line->raised)
        bus_rts_lower_after(&ports->rts, length);
    if (dropped > 0 && line->clients > 0 && ports->dropped_logged == line->dropped - dropped) {
        bus_log(ports->log, "the client does not read: bytes are dropped");
        ports->dropped_logged = line->dropped;
    }
}

static void send_received(struct bus_ports *ports, const struct line_received *received, size_t number)
{
    for (size_t i = 0; i < number; i++)
        send_to_client(ports, &received[i].byte, 1);
}

void bus_ports_send(struct bus_ports *ports, const uint8_t *bytes, size_t length)
{
    struct line_received received[LINE_RECEIVER_MAX];
    if (ports->options->strict_line)
        apply_new_settings(ports);
    if (!is_strict(ports)) {
        send_to_client(ports, bytes, length);
        return;
    }
    for (size_t i = 0; i < length; i++) {
        uint64_t tick = ports->calls->reached(ports->context);
        send_received(ports, received, line_receiver_byte(&ports->to_client, bytes[i], tick, received));
    }
}

void bus_ports_silence(struct bus_ports *ports)
{
    struct line_received received[LINE_RECEIVER_MAX];
    if (is_strict(ports))
        send_received(ports, received, line_receiver_silence(&ports->to_client, received));
}

/* ---- The pty or device ---------------------------------------------------------------------------------------------- */

static void on_retry(uv_timer_t *timer);
static void on_pty_closed(void *context);
static void follow_adapter(struct bus_ports *ports);

static void on_event(void *context, enum line_event event)
{
    struct bus_ports *ports = context;
    uint64_t dropped = ports->line.dropped - ports->dropped_logged;
    switch (event) {
    case LINE_DETACHED:
        bus_log_detail(ports->log, "the client has closed the bus");
        break;
    case LINE_ATTACHED:
        if (dropped > 0)
            bus_log(ports->log, "a client has opened the bus; %" PRIu64 " bytes were dropped before, without a client", dropped);
        else
            bus_log_detail(ports->log, "a client has opened the bus");
        ports->dropped_logged = ports->line.dropped;
        ports->known = ports->unit;
        break;
    case LINE_SHARED:
        bus_log(ports->log, "another client has opened the bus: each gets only a part of the answers");
        break;
    case LINE_FAILED:
        if (!ports->lost)
            bus_log(ports->log, "a client has locked the pty %s and has closed it: a new pty replaces it",
                    ports->line.path);
        ports->lost = true;
        uv_timer_start(&ports->retry, on_retry, 0, 0);
        return;
    }
    ports->calls->presence(ports->context);
}

/* Read what there is room for, or as much as does not take long: bytes of a strange speed may come to nothing, so that there is
 * always room. Returns false if the line is gone. */
static bool read_line(struct bus_ports *ports)
{
    uint8_t bytes[256];
    size_t most;
    struct line *line = &ports->line;
    uint64_t start = uv_hrtime();
    while ((most = free_room(ports)) > 0 && uv_hrtime() - start < READ_STINT) {
        ssize_t length = line_read(line, bytes, most < sizeof bytes ? most : sizeof bytes);
        if (length < 0)
            return false;
        if (length == 0)
            return true;
        if (line->watch)
            line_watch_update(line->watch); /* who has sent them is there before an answer is */
        if (line->watch && line->clients == 0)
            line_pty_recount(line);
        apply_new_settings(ports);
        pass_to_units(ports, bytes, (size_t)length);
    }
    return true;
}

static void on_readable(void *context)
{
    struct bus_ports *ports = context;
    struct line *line = &ports->line;
    if (line->watch)
        line_watch_update(line->watch);
    ports->calls->expect(ports->context);
    if (!ports->reading)
        return; /* there is no room any more, or the adapter has been unplugged */
    if (!read_line(ports)) {
        bus_log(ports->log, "%s has disappeared: %s; restart the emulator when it is back",
                ports->options->port ? ports->options->port : line->path, errno ? strerror(errno) : "hung up");
        ports->calls->failed(ports->context);
        return;
    }
    ports->calls->changed(ports->context);
    if (ports->options->port)
        ports->calls->presence(ports->context);
}

void bus_ports_listen(struct bus_ports *ports)
{
    size_t most = ports->calls->room(ports->context);
    follow_adapter(ports);
    if (ports->reading && free_room(ports) == 0) {
        line_poll_stop(&ports->readable);
        ports->reading = false;
    } else if (!ports->reading && ports->line.fd >= 0 && most >= SEGMENT_ROOM / 2) {
        ports->reading = line_poll_start(&ports->readable) == 0;
    }
    if (most >= SEGMENT_ROOM / 2 && ports->tcp)
        net_port_wake(ports->tcp);
    if (most >= SEGMENT_ROOM / 2 && ports->rfc2217)
        net_port_wake(ports->rfc2217);
}

/* ---- TCP ------------------------------------------------------------------------------------------------------------ */

/* The units catch up first, which may fill the line with bytes of others. */
static size_t on_net_room(void *context)
{
    struct bus_ports *ports = context;
    ports->calls->expect(ports->context);
    return free_room(ports);
}

static void on_net_bytes(void *context, const uint8_t *bytes, size_t length)
{
    struct bus_ports *ports = context;
    apply_new_settings(ports);
    pass_to_units(ports, bytes, length);
    ports->calls->changed(ports->context);
}

/* Who has the line, for one who comes over TCP. */
static const char *on_net_owner(void *context)
{
    struct bus_ports *ports = context;
    if (ports->line.watch)
        line_watch_update(ports->line.watch); /* a client may have closed the pty just now */
    if (ports->options->pty && ports->line.clients > 0)
        return "a client of the pty";
    const char *owner = ports->tcp ? net_port_client(ports->tcp) : NULL;
    return !owner && ports->rfc2217 ? net_port_client(ports->rfc2217) : owner;
}

/* Bytes of the client that has gone just now, which gave way to another one before there was room for them. */
static uint64_t collect_unread(struct bus_ports *ports)
{
    struct net_port *each[] = {ports->tcp, ports->rfc2217};
    uint64_t unread = 0;
    for (size_t i = 0; i < sizeof each / sizeof each[0]; i++) {
        if (each[i]) {
            unread += each[i]->unread;
            each[i]->unread = 0;
        }
    }
    return unread;
}

/* Clients that try again and again must not fill the log. */
static void log_refused(struct bus_ports *ports, const char *peer)
{
    if (++ports->refused <= REFUSED_LOGGED)
        bus_log(ports->log, "the client %s was refused: another client uses the bus", peer);
    if (ports->refused == REFUSED_LOGGED)
        bus_log(ports->log, "many clients were refused: further ones are not logged until another client opens the bus");
}

static void on_net_event(void *context, enum net_event event, const char *peer)
{
    struct bus_ports *ports = context;
    uint64_t unread = collect_unread(ports);
    switch (event) {
    case NET_DETACHED:
        bus_log_detail(ports->log, "the client %s has closed the bus", peer);
        if (unread > 0)
            bus_log(ports->log, "another client replaces it: %" PRIu64 " bytes that it had sent were dropped", unread);
        break;
    case NET_ATTACHED:
        ports->refused = 0;
        bus_log_detail(ports->log, "the client %s has opened the bus", peer);
        ports->known = ports->net = ports->unit;
        break;
    case NET_REFUSED:
        log_refused(ports, peer);
        break;
    }
    ports->calls->presence(ports->context);
}

static void on_net_settings(void *context, uint32_t baud, unsigned data_bits, char parity, unsigned stop_bits)
{
    struct bus_ports *ports = context;
    ports->net = (struct line_settings){
        .baud = baud,
        .data_bits = (uint8_t)data_bits,
        .parity = parity,
        .stop_halves = (uint8_t)(stop_bits == 3 ? 3 : 2 * stop_bits),
    };
}

static void on_net_break(void *context, bool on)
{
    struct bus_ports *ports = context;
    ports->calls->line_break(ports->context, on);
}

static void on_net_purge(void *context)
{
    struct bus_ports *ports = context;
    ports->calls->purge(ports->context);
}

static const struct net_port_calls net_calls = {
    .bytes = on_net_bytes,
    .room = on_net_room,
    .event = on_net_event,
    .owner = on_net_owner,
    .settings = on_net_settings,
    .line_break = on_net_break,
    .purge = on_net_purge,
};

/* Returns NULL if it did not work (reported). */
static struct net_port *open_net(struct bus_ports *ports, uv_loop_t *loop, const char *address, enum net_kind kind)
{
    char own[NET_NAME_SIZE];
    struct net_port *port = calloc(1, sizeof *port);
    if (!port)
        log_error("out of memory");
    else if (!name_address(address, ports->log->number, own, sizeof own))
        log_error("%s: no TCP port for bus %u: expected a port of at most 65535 minus the number of buses", address,
                  ports->log->number);
    else if (net_port_open(port, loop, own, kind, &net_calls, ports))
        return port;
    free(port);
    return NULL;
}

/* ---- Begin and end -------------------------------------------------------------------------------------------------- */

static bool poll_line(struct bus_ports *ports, uv_loop_t *loop)
{
    int error = line_poll_open(&ports->readable, loop, &ports->line);
    if (error != 0)
        log_error("cannot watch the bus: %s", uv_strerror(error));
    return error == 0;
}

static bool open_line(struct bus_ports *ports, uv_loop_t *loop, struct line_watch *watch)
{
    const struct bus_options *options = ports->options;
    if (options->port) {
        if (!line_serial_open(&ports->line, options->port, options->rts))
            return false;
        if (options->rts == LINE_RTS_TOGGLES && !bus_rts_begin(&ports->rts, &ports->line, ports->unit.baud, loop))
            return false;
    } else if (options->pty) {
        uv_timer_init(loop, &ports->retry);
        ports->retry.data = ports;
        if (!bus_pty_claim(&ports->pty, options, ports->log->number) || !line_pty_open(&ports->line, watch, on_event, ports))
            return false;
    } else {
        return true;
    }
    ports->reading = poll_line(ports, loop);
    return ports->reading;
}

void bus_ports_prepare(struct bus_ports *ports, const struct bus_options *options, const struct bus_log *log,
                       const struct bus_ports_calls *calls, void *context)
{
    ports->options = options;
    ports->unit = line_settings_unit;
    ports->unit.baud = device_baud(options->device.kind, &options->device.config);
    ports->log = log;
    ports->calls = calls;
    ports->context = context;
    ports->readable = (struct line_poll){.readable = on_readable, .closed = on_pty_closed, .context = ports};
    bus_pty_prepare(&ports->pty);
    line_none(&ports->line);
}

bool bus_ports_open(struct bus_ports *ports, uv_loop_t *loop, struct line_watch *watch)
{
    const struct bus_options *options = ports->options;
    ports->known = ports->net = ports->unit;
    ports->watch = watch;
    if (!open_line(ports, loop, watch))
        return false;
    if (ports->line.fd >= 0 && ports->unit.baud != line_settings_unit.baud)
        line_set_baud(&ports->line, ports->unit.baud);
    if (options->tcp && !(ports->tcp = open_net(ports, loop, options->tcp, NET_RAW)))
        return false;
    if (options->rfc2217 && !(ports->rfc2217 = open_net(ports, loop, options->rfc2217, NET_RFC2217)))
        return false;
    return true;
}

bool bus_ports_publish(struct bus_ports *ports)
{
    return !ports->options->pty || bus_pty_publish(&ports->pty, ports->options, &ports->line);
}

void bus_ports_close(struct bus_ports *ports)
{
    ports->ended = true;
    bus_pty_release(&ports->pty);
    line_poll_close(&ports->readable);
    bus_rts_end(&ports->rts);
    if (ports->tcp)
        net_port_close(ports->tcp);
    if (ports->rfc2217)
        net_port_close(ports->rfc2217);
}

void bus_ports_free(struct bus_ports *ports)
{
    free(ports->tcp);
    free(ports->rfc2217);
    line_close(&ports->line);
}

/* ---- The adapter ---------------------------------------------------------------------------------------------------- */

static void on_pty_closed(void *context)
{
    struct bus_ports *ports = context;
    ports->closing = false;
    if (!ports->retrying)
        follow_adapter(ports);
}

static void plug_network(struct bus_ports *ports, bool plugged)
{
    if (ports->tcp)
        net_port_plug(ports->tcp, plugged);
    if (ports->rfc2217)
        net_port_plug(ports->rfc2217, plugged);
}

/* The pty goes away with its link. */
static void remove_pty(struct bus_ports *ports)
{
    uint64_t dropped = ports->line.dropped;
    bus_pty_hide(&ports->pty, &ports->line);
    ports->closing = true;
    ports->reading = false;
    line_poll_close(&ports->readable);
    line_close(&ports->line);
    line_none(&ports->line);
    ports->line.dropped = dropped;
}

static void unplug_adapter(struct bus_ports *ports)
{
    ports->out = true;
    if (ports->options->pty) {
        if (!ports->lost)
            bus_log(ports->log, "the adapter is unplugged: %s and its link are removed", ports->line.path);
        remove_pty(ports);
    } else {
        bus_log(ports->log, "the adapter is unplugged%s", ports->options->port ? ": the device stays open, but is silent" : "");
    }
    plug_network(ports, false);
    ports->calls->presence(ports->context);
}

static bool make_pty(struct bus_ports *ports)
{
    uint64_t dropped = ports->line.dropped;
    bool made = line_pty_open(&ports->line, ports->watch, on_event, ports);
    ports->line.dropped = dropped;
    if (!made)
        return false;
    ports->reading = poll_line(ports, ports->retry.loop);
    if (!ports->reading) {
        line_close(&ports->line);
        return false;
    }
    bus_pty_restore_access(&ports->pty, &ports->line);
    if (bus_ports_publish(ports))
        return true;
    remove_pty(ports);
    return false;
}

static void plug_in_adapter(struct bus_ports *ports)
{
    if (ports->options->pty && !make_pty(ports)) {
        if (!ports->retry_logged)
            bus_log(ports->log, "cannot plug the adapter in again: trying every second");
        ports->retrying = ports->retry_logged = true;
        uv_timer_start(&ports->retry, on_retry, RETRY_MS, 0);
        return;
    }
    ports->out = ports->retry_logged = false;
    ports->known = ports->net = ports->unit;
    plug_network(ports, true);
    if (ports->options->pty)
        bus_log(ports->log, "the adapter is plugged in again: %s, link %s", ports->line.path, ports->pty.link.path);
    else
        bus_log(ports->log, "the adapter is plugged in again");
}

/* What the fault of the adapter has come to since the last check. It may have come and gone: then it is another pty. */
static void follow_adapter(struct bus_ports *ports)
{
    if (ports->ended)
        return;
    if (ports->pulled || ports->lost) {
        if (!ports->out)
            unplug_adapter(ports);
        ports->pulled = ports->lost = false;
    }
    if (ports->out && !ports->unplugged && !ports->closing && !ports->retrying)
        plug_in_adapter(ports);
}

static void on_retry(uv_timer_t *timer)
{
    struct bus_ports *ports = timer->data;
    ports->retrying = false;
    follow_adapter(ports);
}

void bus_ports_plug(struct bus_ports *ports, bool plugged)
{
    ports->pulled = ports->pulled || !plugged;
    ports->unplugged = !plugged;
}
