#include "bus.h"

#include <errno.h>
#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include "log.h"

#define NS_PER_MS 1000000u
#define NS_PER_SECOND 1000000000u
#define REST (100u * NS_PER_MS)  /* longest sleep while motors or programs run */
#define STINT (5u * NS_PER_MS)   /* longest time without a look at the line and at signals */
#define STEP 100000u             /* ticks that the units are advanced at once while they are at work */
#define LEAP 10000u              /* ticks: shortest leap of --clock max; less would cost more than it shows */
#define FRAME_SILENCE (100u * NS_PER_MS) /* --clock max: how long the rest of a frame is waited for (L2) */

uint64_t bus_present(const struct bus *bus)
{
    return bus->running ? virtual_clock_tick(&bus->clock, uv_hrtime()) : 0;
}

static void say(const struct bus *bus, uint64_t tick, const char *format, va_list list)
{
    char text[512];
    vsnprintf(text, sizeof text, format, list);
    if (bus->options->lines > 1)
        log_at(tick, "line %u: %s", bus->number, text);
    else
        log_at(tick, "%s", text);
}

void bus_log(const struct bus *bus, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    say(bus, bus_present(bus), format, list);
    va_end(list);
}

/* ---- The units' port ------------------------------------------------------------------------------------------------ */

static void unit_log(const struct bus_unit *unit, uint64_t tick, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    say(unit->bus, segment_since(&unit->bus->segment, unit->number) + tick, format, list);
    va_end(list);
}

static void on_event(void *context, uint64_t tick, unsigned motor, enum rkm04_event what, uint32_t value)
{
    struct bus_unit *unit = context;
    if (what == RKM04_EVENT_COMMAND && value != 0)
        unit->place[motor - 1] = value;
    if (what != RKM04_EVENT_FAULT || value == RKM04_FAULT_NONE)
        return;
    unit_log(unit, tick, "unit %s, motor %u: fault %s at command %" PRIu32, unit->name, motor,
             rkm04_fault_name((enum rkm04_fault)value), unit->place[motor - 1]);
    if (unit->bus->coverage)
        coverage_fault(unit->bus->coverage, (enum rkm04_fault)value);
}

static int flash_read(void *context, unsigned block, unsigned offset, void *data, unsigned length)
{
    struct bus_unit *unit = context;
    return flash_file_read(&unit->flash, block, offset, data, length);
}

static int flash_erase(void *context, unsigned block)
{
    struct bus_unit *unit = context;
    return flash_file_erase(&unit->flash, block);
}

static int flash_program(void *context, unsigned block, unsigned offset, const void *data, unsigned length)
{
    struct bus_unit *unit = context;
    return flash_file_program(&unit->flash, block, offset, data, length);
}

static const struct rkm04_port port = {
    .event = on_event,
    .flash_read = flash_read,
    .flash_erase = flash_erase,
    .flash_program = flash_program,
};

/* ---- Bytes ---------------------------------------------------------------------------------------------------------- */

size_t bus_room(const struct bus *bus)
{
    return segment_room(&bus->segment);
}

void bus_take(struct bus *bus, const uint8_t *bytes, size_t length, uint64_t tick)
{
    bus->heard = uv_hrtime();
    uint64_t present = virtual_clock_tick(&bus->clock, bus->heard);
    if (bus->taken < present)
        bus->taken = present;
    if (bus->taken < tick)
        bus->taken = tick;
    segment_take(&bus->segment, bytes, length, bus->taken);
}

static void send_gathered(struct bus *bus)
{
    if (bus->gathered > 0)
        bus_ports_send(bus, bus->out, bus->gathered);
    bus->gathered = 0;
}

/* On a real wire bytes take their time outside, so the units' line takes none; the turnaround is kept here. */
static void gather(void *context, const uint8_t *bytes, size_t length)
{
    struct bus *bus = context;
    if (bus->gathered == 0)
        bus->answered = segment_now(&bus->segment) + (bus->ports.line.is_wire ? bus->options->turnaround : 0);
    if (length > sizeof bus->out - bus->gathered)
        send_gathered(bus);
    memcpy(bus->out + bus->gathered, bytes, length);
    bus->gathered += length;
}

static void hear(void *context, const struct segment_byte *byte)
{
    struct bus *bus = context;
    bus_listener_hear(&bus->listener, byte);
}

/* ---- Time ----------------------------------------------------------------------------------------------------------- */

/* The earliest tick at which a byte is to be moved. */
static uint64_t due(const struct bus *bus)
{
    uint64_t tick = segment_due(&bus->segment);
    return bus->gathered > 0 && bus->answered < tick ? bus->answered : tick;
}

/* --clock max: the tick to leap to at `now` (ns): that of the next byte under way; else, unless the rest of a frame is on its
 * way, past the next thing that happens. RKM04_NEVER: no reason to leap. */
static uint64_t leap_to(const struct bus *bus, uint64_t now)
{
    if (!bus->clock.runs_ahead)
        return RKM04_NEVER;
    uint64_t byte = due(bus);
    if (byte != RKM04_NEVER)
        return byte;
    if (segment_in_frame(&bus->segment) && now - bus->heard < FRAME_SILENCE)
        return RKM04_NEVER;
    uint64_t event = segment_next_event(&bus->segment), least = segment_now(&bus->segment) + LEAP;
    return event == RKM04_NEVER ? RKM04_NEVER : event < least ? least : event + 1;
}

/* Up to which tick the units are to be at `now` (ns). */
static uint64_t goal(struct bus *bus, uint64_t now)
{
    uint64_t tick = virtual_clock_tick(&bus->clock, now), leap = leap_to(bus, now);
    if (leap == RKM04_NEVER || leap <= tick)
        return tick;
    virtual_clock_leap(&bus->clock, now, leap);
    return leap;
}

/* One step towards `tick`: a span in which nothing happens, or STEP. Anything may be reached in one call of the segment, but
 * then nobody would look at the line and at signals for a long while. */
static void step(struct bus *bus, uint64_t tick)
{
    uint64_t end = segment_now(&bus->segment) + STEP;
    if (end < tick) {
        uint64_t event = segment_next_event(&bus->segment);
        if (end <= event)
            end = event == RKM04_NEVER ? RKM04_NEVER : event + 1;
    }
    segment_advance(&bus->segment, tick < end ? tick : end);
}

/* When (ns) there will be something to do; 0: not before bytes come. */
static uint64_t next_wake(const struct bus *bus, uint64_t now)
{
    uint64_t byte = due(bus), event = segment_next_event(&bus->segment), when = 0;
    if (leap_to(bus, now) != RKM04_NEVER)
        return now;
    if (byte != RKM04_NEVER) {
        when = virtual_clock_when(&bus->clock, byte);
        when = when > 0 ? when : now;
    }
    if (event != RKM04_NEVER) {
        uint64_t look = virtual_clock_when(&bus->clock, event + 1);
        if (look < now + REST)
            look = now + REST;
        if (when == 0 || look < when)
            when = look;
    }
    return when;
}

static void set_timer(struct bus *bus, uint64_t when)
{
    struct itimerspec spec = {
        .it_value = {.tv_sec = (time_t)(when / NS_PER_SECOND), .tv_nsec = (long)(when % NS_PER_SECOND)},
    };
    timerfd_settime(bus->timer_fd, TFD_TIMER_ABSTIME, &spec, NULL);
}

void bus_catch_up(struct bus *bus)
{
    uint64_t start = uv_hrtime(), now = start, tick;
    bus->busy = true;
    do {
        tick = goal(bus, now);
        step(bus, tick);
        now = uv_hrtime();
    } while (now - start < STINT && (segment_now(&bus->segment) < tick || leap_to(bus, now) != RKM04_NEVER));
    if (bus->answered <= segment_now(&bus->segment))
        send_gathered(bus);
    if (segment_idle(&bus->segment))
        bus_ports_silence(bus);
    bus_ports_listen(bus);
    bus->busy = false;
    set_timer(bus, segment_now(&bus->segment) < tick ? now : next_wake(bus, now));
}

static void on_timer(uv_poll_t *handle, int status, int events)
{
    (void)status;
    (void)events;
    bus_catch_up(handle->data);
}

/* ---- Begin and end -------------------------------------------------------------------------------------------------- */

static bool add_unit(struct bus *bus, unsigned at)
{
    const struct serve_options *options = bus->options;
    struct bus_unit *unit = &bus->unit[at];
    char path[PATH_MAX];
    unit->bus = bus;
    unit->number = at + 1;
    unit->flash.fd = -1;
    node_list_name(&options->nodes, at, unit->name);
    if (options->flash) {
        if (!name_expand(options->flash, unit->name, bus->number, path)) {
            log_error("--flash: the path is too long");
            return false;
        }
        unit->flash_path = strdup(path);
    }
    if (!flash_file_open(&unit->flash, unit->flash_path))
        return false;
    struct rkm04_config config = options->config;
    config.node = options->nodes.node[at];
    return segment_add_unit(&bus->segment, &config, &port, unit) != 0;
}

static bool start_timer(struct bus *bus, uv_loop_t *loop)
{
    bus->timer_fd = timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC);
    int error = bus->timer_fd < 0 ? -errno : uv_poll_init(loop, &bus->timer, bus->timer_fd);
    bus->timer.data = bus;
    if (error == 0)
        error = uv_poll_start(&bus->timer, UV_READABLE, on_timer);
    if (error != 0)
        log_error("cannot make a timer: %s", uv_strerror(error));
    return error == 0;
}

bool bus_begin(struct bus *bus, unsigned number, const struct serve_options *options, uv_loop_t *loop, struct line_watch *watch,
               struct coverage *coverage, const struct bus_calls *calls, void *context)
{
    bus->number = number;
    bus->options = options;
    bus->coverage = coverage;
    bus->calls = calls;
    bus->context = context;
    bus->timer_fd = bus->ports.lower_fd = bus->ports.link.lock = -1;
    line_none(&bus->ports.line);
    bus->clock = options->clock;
    if (!bus_listener_begin(&bus->listener, coverage, options->config.framing, &options->nodes)) {
        log_error("out of memory");
        return false;
    }
    if (!bus_ports_open(bus, loop, watch))
        return false;
    struct segment_config config = {
        .timed = options->baud != 0 && !bus->ports.line.is_wire,
        .turnaround = options->turnaround,
        .out = gather,
        .monitor = coverage ? hear : NULL,
        .context = bus,
    };
    segment_begin(&bus->segment, &config);
    for (unsigned at = 0; at < options->nodes.count; at++)
        if (!add_unit(bus, at))
            return false;
    return start_timer(bus, loop);
}

bool bus_start(struct bus *bus)
{
    if (!bus_ports_publish(bus))
        return false;
    virtual_clock_start(&bus->clock, uv_hrtime());
    bus->running = true;
    bus_catch_up(bus);
    return true;
}

bool bus_power(struct bus *bus, const char *name, bool on)
{
    for (unsigned at = 0; at < bus->segment.units; at++) {
        if (strcmp(bus->unit[at].name, name) != 0)
            continue;
        bus_catch_up(bus);
        segment_power(&bus->segment, bus->unit[at].number, on);
        bus_log(bus, "unit %s: power %s", name, on ? "on" : "off");
        bus_catch_up(bus);
        return true;
    }
    return false;
}

bool bus_end(struct bus *bus)
{
    bool well = true;
    bus_ports_close(bus);
    bus_listener_end(&bus->listener);
    for (unsigned at = 0; at < NODE_LIST_MAX; at++)
        if (bus->unit[at].bus && !flash_file_close(&bus->unit[at].flash))
            well = false;
    return well;
}

void bus_free(struct bus *bus)
{
    if (bus->timer_fd >= 0)
        close(bus->timer_fd);
    for (unsigned at = 0; at < NODE_LIST_MAX; at++)
        free(bus->unit[at].flash_path);
    free(bus->ports.tcp);
    free(bus->ports.rfc2217);
    line_close(&bus->ports.line);
    if (bus->ports.lower_fd >= 0)
        close(bus->ports.lower_fd);
    free(bus);
}
