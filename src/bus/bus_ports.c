/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/timerfd.h>

#include "bus.h"
#include "line/line.h"

#define NS_PER_SECOND 1000000000u
#define NS_PER_BYTE 520834u       /* 10 bits at 19200 baud */
#define READ_STINT 2000000u       /* ns: longest time a turn of the loop for reading one bus */
#define NS_PER_LOOK 200000u       /* between two looks whether a device has sent all */
#define REFUSED_TOLD 100u         /* network clients that were sent away, in the log */
#define AGAIN_MS 1000u            /* between two tries to have a new pty */

unsigned bus_ports_clients(const struct bus *bus)
{
    const struct bus_ports *ports = &bus->ports;
    return (bus->options->pty ? ports->line.clients : 0) + (ports->tcp && ports->tcp->attached) +
           (ports->rfc2217 && ports->rfc2217->attached);
}

uint64_t bus_ports_dropped(const struct bus *bus)
{
    const struct bus_ports *ports = &bus->ports;
    return ports->line.dropped + (ports->tcp ? ports->tcp->dropped : 0) + (ports->rfc2217 ? ports->rfc2217->dropped : 0);
}

/* ---- What the client has set ---------------------------------------------------------------------------------------- */

static bool strict(const struct bus *bus)
{
    return bus->options->strict_line && !line_settings_equal(bus->ports.known, line_settings_unit);
}

/* The settings of the client who is there. Raw TCP has none. */
static struct line_settings present_settings(const struct bus *bus)
{
    const struct bus_ports *ports = &bus->ports;
    struct line_settings settings = line_settings_unit;
    if (ports->rfc2217 && ports->rfc2217->attached)
        return ports->net;
    if (bus->options->pty && ports->line.clients > 0)
        line_settings_read(ports->line.fd, &settings);
    return settings;
}

/* Look what the client has set, and tell what is new. */
static void look(struct bus *bus)
{
    struct bus_ports *ports = &bus->ports;
    char news[LINE_NEWS_MAX];
    if (!line_settings_news(&ports->known, present_settings(bus), news))
        return;
    bus_log(bus, "%s", news);
    line_ear_begin(&ports->to_units, ports->known, line_settings_unit, false);
    line_ear_begin(&ports->to_client, line_settings_unit, ports->known, true);
}

/* ---- To the units --------------------------------------------------------------------------------------------------- */

/* Bytes of the client that can be taken. Each may be heard as several, and one more when it falls silent. */
static size_t room(const struct bus *bus)
{
    size_t most = bus_room(bus);
    return !bus->options->strict_line ? most : most > 0 ? (most - 1) / LINE_EAR_MAX : 0;
}

static void take_heard(struct bus *bus, const struct line_heard *heard, size_t number)
{
    for (size_t i = 0; i < number; i++)
        bus_take(bus, &heard[i].byte, 1, heard[i].tick);
}

/* The client has sent something; `length` <= room(). */
static void take(struct bus *bus, const uint8_t *bytes, size_t length)
{
    struct line_heard heard[LINE_EAR_MAX];
    uint64_t tick = bus_present(bus);
    if (!strict(bus)) {
        bus_take(bus, bytes, length, tick);
        return;
    }
    for (size_t i = 0; i < length; i++)
        take_heard(bus, heard, line_ear_byte(&bus->ports.to_units, bytes[i], tick, heard));
    take_heard(bus, heard, line_ear_silence(&bus->ports.to_units, heard));
}

/* ---- To the clients ------------------------------------------------------------------------------------------------- */

static void set_lower(struct bus *bus, uint64_t when)
{
    struct itimerspec spec = {
        .it_value = {.tv_sec = (time_t)(when / NS_PER_SECOND), .tv_nsec = (long)(when % NS_PER_SECOND)},
    };
    timerfd_settime(bus->ports.lower_fd, TFD_TIMER_ABSTIME, &spec, NULL);
}

static void on_lower(uv_poll_t *handle, int status, int events)
{
    struct bus *bus = handle->data;
    uint64_t expired;
    (void)status;
    (void)events;
    if (read(bus->ports.lower_fd, &expired, sizeof expired) < 0 && errno == EAGAIN)
        return;
    if (bus->ports.line.raised && !line_serial_lower(&bus->ports.line))
        set_lower(bus, uv_hrtime() + NS_PER_LOOK);
}

/* RTS has gone on: see that it goes off when the bytes are out. */
static void expect_lower(struct bus *bus, size_t length)
{
    struct bus_ports *ports = &bus->ports;
    uint64_t now = uv_hrtime();
    if (ports->sent_until < now)
        ports->sent_until = now;
    ports->sent_until += length * NS_PER_BYTE;
    set_lower(bus, ports->sent_until);
}

static void send_now(struct bus *bus, const uint8_t *bytes, size_t length)
{
    struct bus_ports *ports = &bus->ports;
    struct line *line = &ports->line;
    bool nobody = bus_ports_clients(bus) == 0;
    if (ports->tcp && (ports->tcp->attached || (nobody && line->fd < 0)))
        net_port_send(ports->tcp, bytes, length);
    if (ports->rfc2217 && (ports->rfc2217->attached || (nobody && line->fd < 0 && !ports->tcp)))
        net_port_send(ports->rfc2217, bytes, length);
    if (line->fd < 0 || (line->clients == 0 && !nobody))
        return;
    size_t dropped = line_write(line, bytes, length);
    if (line->raised)
        expect_lower(bus, length);
    if (dropped > 0 && line->clients > 0 && ports->told == line->dropped - dropped) {
        bus_log(bus, "the client does not read: bytes are being dropped");
        ports->told = line->dropped;
    }
}

static void send_heard(struct bus *bus, const struct line_heard *heard, size_t number)
{
    for (size_t i = 0; i < number; i++)
        send_now(bus, &heard[i].byte, 1);
}

void bus_ports_send(struct bus *bus, const uint8_t *bytes, size_t length)
{
    struct line_heard heard[LINE_EAR_MAX];
    if (bus->options->strict_line)
        look(bus);
    if (!strict(bus)) {
        send_now(bus, bytes, length);
        return;
    }
    for (size_t i = 0; i < length; i++)
        send_heard(bus, heard, line_ear_byte(&bus->ports.to_client, bytes[i], sim_now(&bus->sim), heard));
}

void bus_ports_silence(struct bus *bus)
{
    struct line_heard heard[LINE_EAR_MAX];
    if (strict(bus))
        send_heard(bus, heard, line_ear_silence(&bus->ports.to_client, heard));
}

/* ---- The pty or device ---------------------------------------------------------------------------------------------- */

static void on_again(uv_timer_t *timer);
static void follow_adapter(struct bus *bus);

static void on_news(void *context, enum line_news news)
{
    struct bus *bus = context;
    struct bus_ports *ports = &bus->ports;
    uint64_t dropped = ports->line.dropped - ports->told;
    switch (news) {
    case LINE_DETACHED:
        bus_log_detail(bus, "the client has closed the line");
        break;
    case LINE_ATTACHED:
        if (dropped > 0)
            bus_log(bus, "a client has opened the line; %" PRIu64 " bytes for nobody were dropped before", dropped);
        else
            bus_log_detail(bus, "a client has opened the line");
        ports->told = ports->line.dropped;
        ports->known = line_settings_unit;
        break;
    case LINE_SHARED:
        bus_log(bus, "one more client has opened the line: they will take each other's answers (%u now)", ports->line.clients);
        break;
    case LINE_FAILED:
        if (!ports->lost)
            bus_log(bus, "a client has locked the pty %s for good and gone: another pty takes its place", ports->line.path);
        ports->lost = true;
        uv_timer_start(&ports->again, on_again, 0, 0);
        return;
    }
    bus->calls->presence(bus->context);
}

/* Read what there is room for, or as much as does not take long: bytes of a strange speed may come to nothing, so that there is
 * always room. Returns false if the line is gone. */
static bool read_line(struct bus *bus)
{
    uint8_t bytes[256];
    size_t most;
    struct line *line = &bus->ports.line;
    uint64_t start = uv_hrtime();
    while ((most = room(bus)) > 0 && uv_hrtime() - start < READ_STINT) {
        ssize_t length = line_read(line, bytes, most < sizeof bytes ? most : sizeof bytes);
        if (length < 0)
            return false;
        if (length == 0)
            return true;
        if (line->watch)
            line_watch_follow(line->watch); /* who has sent them is there before an answer is */
        if (line->watch && line->clients == 0)
            line_pty_count_again(line);
        look(bus);
        take(bus, bytes, (size_t)length);
    }
    return true;
}

static void on_readable(uv_poll_t *handle, int status, int events)
{
    struct bus *bus = handle->data;
    struct line *line = &bus->ports.line;
    (void)status; /* a hang-up shows when reading */
    (void)events;
    if (line->watch)
        line_watch_follow(line->watch);
    bus_expect(bus);
    if (!bus->ports.reading)
        return; /* there is no room any more, or the adapter has been unplugged */
    if (!read_line(bus)) {
        bus_log(bus, "%s is gone: %s; start again when it is back", bus->options->port ? bus->options->port : line->path,
                errno ? strerror(errno) : "hung up");
        bus->calls->failed(bus->context);
        return;
    }
    bus_catch_up(bus);
    if (bus->options->port)
        bus->calls->presence(bus->context);
}

void bus_ports_listen(struct bus *bus)
{
    struct bus_ports *ports = &bus->ports;
    size_t most = bus_room(bus);
    follow_adapter(bus);
    if (ports->reading && room(bus) == 0) {
        uv_poll_stop(&ports->readable);
        ports->reading = false;
    } else if (!ports->reading && ports->line.fd >= 0 && most >= SEGMENT_ROOM / 2) {
        ports->reading = uv_poll_start(&ports->readable, UV_READABLE, on_readable) == 0;
    }
    if (most >= SEGMENT_ROOM / 2 && ports->tcp)
        net_port_wake(ports->tcp);
    if (most >= SEGMENT_ROOM / 2 && ports->rfc2217)
        net_port_wake(ports->rfc2217);
}

/* ---- TCP ------------------------------------------------------------------------------------------------------------ */

/* The units catch up first, which may fill the line with bytes of others. */
static size_t net_room(void *context)
{
    bus_expect(context);
    return room(context);
}

static void net_bytes(void *context, const uint8_t *bytes, size_t length)
{
    struct bus *bus = context;
    look(bus);
    take(bus, bytes, length);
    if (!bus->busy)
        bus_catch_up(bus);
}

/* Who has the line, for one who comes over TCP. */
static const char *net_owner(void *context)
{
    struct bus *bus = context;
    const struct bus_ports *ports = &bus->ports;
    if (ports->line.watch)
        line_watch_follow(ports->line.watch); /* somebody may have closed the pty just now */
    if (bus->options->pty && ports->line.clients > 0)
        return "a client of the pty";
    const char *owner = ports->tcp ? net_port_client(ports->tcp) : NULL;
    return !owner && ports->rfc2217 ? net_port_client(ports->rfc2217) : owner;
}

/* Bytes of the client that has gone just now, which gave way to another one before there was room for them. */
static uint64_t take_unheard(struct bus_ports *ports)
{
    struct net_port *each[] = {ports->tcp, ports->rfc2217};
    uint64_t unheard = 0;
    for (size_t i = 0; i < sizeof each / sizeof each[0]; i++) {
        if (each[i]) {
            unheard += each[i]->unheard;
            each[i]->unheard = 0;
        }
    }
    return unheard;
}

/* Whoever knocks without an end must not fill the log. */
static void tell_refused(struct bus *bus, const char *peer)
{
    if (++bus->ports.refused <= REFUSED_TOLD)
        bus_log(bus, "the client %s was sent away: another one has the line", peer);
    if (bus->ports.refused == REFUSED_TOLD)
        bus_log(bus, "many were sent away: no more of it is told until the line has another client");
}

static void net_told(void *context, enum net_news news, const char *peer)
{
    struct bus *bus = context;
    uint64_t unheard = take_unheard(&bus->ports);
    switch (news) {
    case NET_DETACHED:
        bus_log_detail(bus, "the client %s has closed the line", peer);
        if (unheard > 0)
            bus_log(bus, "it gives way to another client: %" PRIu64 " bytes that it had sent were dropped", unheard);
        break;
    case NET_ATTACHED:
        bus->ports.refused = 0;
        bus_log_detail(bus, "the client %s has opened the line", peer);
        bus->ports.known = bus->ports.net = line_settings_unit;
        break;
    case NET_REFUSED:
        tell_refused(bus, peer);
        break;
    }
    bus->calls->presence(bus->context);
}

static void net_settings(void *context, uint32_t baud, unsigned data_bits, char parity, unsigned stop_bits)
{
    struct bus *bus = context;
    bus->ports.net = (struct line_settings){
        .baud = baud,
        .data_bits = (uint8_t)data_bits,
        .parity = parity,
        .stop_halves = (uint8_t)(stop_bits == 3 ? 3 : 2 * stop_bits),
    };
}

static void net_break(void *context, bool on)
{
    struct bus *bus = context;
    struct sim *sim = bus_sim(bus);
    sim_break(sim, on);
    bus_changed(bus);
}

static void net_purge(void *context)
{
    struct bus *bus = context;
    struct sim *sim = bus_sim(bus);
    sim_purge(sim);
    bus_changed(bus);
}

static const struct net_port_calls net_calls = {
    .bytes = net_bytes,
    .room = net_room,
    .news = net_told,
    .owner = net_owner,
    .settings = net_settings,
    .line_break = net_break,
    .purge = net_purge,
};

/* Returns NULL if it did not work (reported). */
static struct net_port *open_net(struct bus *bus, uv_loop_t *loop, const char *address, enum net_kind kind)
{
    char own[NET_NAME_SIZE];
    struct net_port *port = calloc(1, sizeof *port);
    if (!port)
        log_error("out of memory");
    else if (!name_address(address, bus->number, own, sizeof own))
        log_error("%s: there is no port for line %u: expected one up to 65535 less the number of lines", address, bus->number);
    else if (net_port_open(port, loop, own, kind, &net_calls, bus))
        return port;
    free(port);
    return NULL;
}

/* ---- Begin and end -------------------------------------------------------------------------------------------------- */

static bool poll_fd(struct bus *bus, uv_loop_t *loop, uv_poll_t *poll, int fd, uv_poll_cb callback)
{
    poll->data = bus;
    int error = uv_poll_init(loop, poll, fd);
    if (error == 0)
        error = uv_poll_start(poll, UV_READABLE, callback);
    if (error != 0)
        log_error("cannot watch the line: %s", uv_strerror(error));
    return error == 0;
}

static bool open_line(struct bus *bus, uv_loop_t *loop, struct line_watch *watch)
{
    const struct bus_options *options = bus->options;
    struct bus_ports *ports = &bus->ports;
    char path[PATH_MAX];
    if (options->port) {
        if (!line_serial_open(&ports->line, options->port, options->rts))
            return false;
        if (options->rts == LINE_RTS_TOGGLES) {
            ports->lower_fd = timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC);
            if (!poll_fd(bus, loop, &ports->lower, ports->lower_fd, on_lower))
                return false;
        }
    } else if (options->pty) {
        if (options->link && !name_expand(options->link, NULL, bus->number, path)) {
            log_error("--link: the path is too long");
            return false;
        }
        uv_timer_init(loop, &ports->again);
        ports->again.data = bus;
        if (!link_path_claim(&ports->link, options->link ? path : NULL, bus->number) ||
            !line_pty_open(&ports->line, watch, on_news, bus))
            return false;
    } else {
        return true;
    }
    ports->reading = poll_fd(bus, loop, &ports->readable, ports->line.fd, on_readable);
    return ports->reading;
}

bool bus_ports_open(struct bus *bus, uv_loop_t *loop, struct line_watch *watch)
{
    const struct bus_options *options = bus->options;
    struct bus_ports *ports = &bus->ports;
    ports->known = ports->net = line_settings_unit;
    ports->watch = watch;
    if (!open_line(bus, loop, watch))
        return false;
    if (options->tcp && !(ports->tcp = open_net(bus, loop, options->tcp, NET_RAW)))
        return false;
    if (options->rfc2217 && !(ports->rfc2217 = open_net(bus, loop, options->rfc2217, NET_RFC2217)))
        return false;
    return true;
}

bool bus_ports_publish(struct bus *bus)
{
    return !bus->options->pty || link_path_make(&bus->ports.link, bus->ports.line.path);
}

void bus_ports_close(struct bus *bus)
{
    bus->ports.ended = true;
    link_path_release(&bus->ports.link);
    if (bus->ports.tcp)
        net_port_close(bus->ports.tcp);
    if (bus->ports.rfc2217)
        net_port_close(bus->ports.rfc2217);
}

/* ---- The adapter ---------------------------------------------------------------------------------------------------- */

static void on_pty_closed(uv_handle_t *handle)
{
    struct bus *bus = handle->data;
    bus->ports.closing = false;
    if (!bus->ports.resting)
        follow_adapter(bus);
}

static void plug_network(struct bus_ports *ports, bool plugged)
{
    if (ports->tcp)
        net_port_plug(ports->tcp, plugged);
    if (ports->rfc2217)
        net_port_plug(ports->rfc2217, plugged);
}

/* The pty goes away with its link. */
static void drop_pty(struct bus *bus)
{
    struct bus_ports *ports = &bus->ports;
    uint64_t dropped = ports->line.dropped;
    struct stat found;
    if (stat(ports->line.path, &found) == 0) {
        ports->group = found.st_gid;
        ports->mode = found.st_mode & 0777;
    }
    link_path_hide(&ports->link);
    ports->closing = true;
    ports->reading = false;
    uv_close((uv_handle_t *)&ports->readable, on_pty_closed);
    line_close(&ports->line);
    line_none(&ports->line);
    ports->line.dropped = dropped;
}

static void pull_out(struct bus *bus)
{
    struct bus_ports *ports = &bus->ports;
    ports->out = true;
    if (bus->options->pty) {
        if (!ports->lost)
            bus_log(bus, "the adapter is unplugged: %s and its link are gone", ports->line.path);
        drop_pty(bus);
    } else {
        bus_log(bus, "the adapter is unplugged%s", bus->options->port ? ": the device stays, and is silent" : "");
    }
    plug_network(ports, false);
    bus->calls->presence(bus->context);
}

/* The new pty is for whom the old one was for. */
static void keep_access(const struct bus_ports *ports)
{
    const char *path = ports->line.path;
    struct stat found;
    if (ports->mode == 0 || stat(path, &found) != 0)
        return;
    if (found.st_gid != ports->group && chown(path, (uid_t)-1, ports->group) != 0)
        log_error("cannot give %s the group %u of the pty before: %s", path, (unsigned)ports->group, strerror(errno));
    else if ((found.st_mode & 0777) != ports->mode && chmod(path, ports->mode) != 0)
        log_error("cannot give %s the mode %03o of the pty before: %s", path, (unsigned)ports->mode, strerror(errno));
}

static bool make_pty(struct bus *bus)
{
    struct bus_ports *ports = &bus->ports;
    uint64_t dropped = ports->line.dropped;
    bool made = line_pty_open(&ports->line, ports->watch, on_news, bus);
    ports->line.dropped = dropped;
    if (!made)
        return false;
    ports->reading = poll_fd(bus, ports->again.loop, &ports->readable, ports->line.fd, on_readable);
    if (!ports->reading) {
        line_close(&ports->line);
        return false;
    }
    keep_access(ports);
    if (bus_ports_publish(bus))
        return true;
    drop_pty(bus);
    return false;
}

static void put_in(struct bus *bus)
{
    struct bus_ports *ports = &bus->ports;
    if (bus->options->pty && !make_pty(bus)) {
        if (!ports->rest_told)
            bus_log(bus, "the adapter cannot be plugged in again: trying every second");
        ports->resting = ports->rest_told = true;
        uv_timer_start(&ports->again, on_again, AGAIN_MS, 0);
        return;
    }
    ports->out = ports->rest_told = false;
    ports->known = ports->net = line_settings_unit;
    plug_network(ports, true);
    if (bus->options->pty)
        bus_log(bus, "the adapter is plugged in again: %s, link %s", ports->line.path, ports->link.path);
    else
        bus_log(bus, "the adapter is plugged in again");
}

/* What the fault of the adapter has come to since the last look. It may have come and gone: then it is another pty. */
static void follow_adapter(struct bus *bus)
{
    struct bus_ports *ports = &bus->ports;
    if (ports->ended)
        return;
    if (ports->pulled || ports->lost) {
        if (!ports->out)
            pull_out(bus);
        ports->pulled = ports->lost = false;
    }
    if (ports->out && !ports->unplugged && !ports->closing && !ports->resting)
        put_in(bus);
}

static void on_again(uv_timer_t *timer)
{
    struct bus *bus = timer->data;
    bus->ports.resting = false;
    follow_adapter(bus);
}

void bus_ports_plug(struct bus *bus, bool plugged)
{
    bus->ports.pulled = bus->ports.pulled || !plugged;
    bus->ports.unplugged = !plugged;
}
