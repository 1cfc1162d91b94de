/* SPDX-License-Identifier: MIT */
/* bus_time.c: how a line follows its clock: catches up, sleeps, waits, steps. */
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <sys/timerfd.h>

#include "bus.h"
#include "line/line.h"

#define NS_PER_MS 1000000u
#define NS_PER_SECOND 1000000000u
#define REST (100u * NS_PER_MS)  /* longest sleep while motors or programs run */
#define REST_WATCHED (10u * NS_PER_MS) /* while somebody watches what they do */
#define LATE (500u * NS_PER_MS)  /* so much behind, and the process was stopped */
#define LONG_BEHIND NS_PER_SECOND /* without having caught up once, and it is told */
#define HEARTBEAT (250u * NS_PER_MS) /* --late skip: longest sleep, so that it is noticed when the process was stopped */
#define STINT (5u * NS_PER_MS)   /* longest time without a look at the line and at signals */
#define STEP 100000u             /* ticks that the units are advanced at once while they are at work */
#define LEAP 10000u              /* ticks: shortest leap of --clock max; less would cost more than it shows */
#define CUTS_TOLD 100u           /* units that were cut off from answering one another, in the log */
#define FRAME_SILENCE (100u * NS_PER_MS) /* --clock max: how long the rest of a frame is waited for (L2) */

bool bus_stepped(const struct bus *bus)
{
    return bus->clock.stands;
}

/* Where the clock stands at `now` (ns). */
static uint64_t clock_tick(const struct bus *bus, uint64_t now)
{
    uint64_t tick = virtual_clock_tick(&bus->clock, now);
    return tick < SIM_TIME_MAX ? tick : SIM_TIME_MAX;
}

uint64_t bus_present(const struct bus *bus)
{
    if (!bus->running)
        return 0;
    return bus_stepped(bus) || bus->behind > 0 ? sim_now(&bus->sim) : clock_tick(bus, uv_hrtime());
}

/* ---- Who waits ------------------------------------------------------------------------------------------------------ */

static void take_off(struct bus *bus, struct bus_waiter *waiter)
{
    for (struct bus_waiter **at = &bus->waiters; *at; at = &(*at)->next) {
        if (*at == waiter) {
            *at = waiter->next;
            break;
        }
    }
    if (bus->advancing == waiter) {
        bus->advancing = NULL;
        bus->goal = sim_now(&bus->sim);
    }
}

/* Tell those who have waited long enough. A waiter who is told may wait again, or take others off. */
static void serve_waiters(struct bus *bus)
{
    for (struct bus_waiter *waiter = bus->waiters; waiter;) {
        bool holds = waiter->condition && condition_holds(waiter->condition);
        if (!holds && sim_now(&bus->sim) < waiter->limit) {
            waiter = waiter->next;
            continue;
        }
        take_off(bus, waiter);
        waiter->done(waiter, holds);
        waiter = bus->waiters;
    }
}

/* The tick up to which nobody who waits has to look. */
static uint64_t waiters_next(const struct bus *bus)
{
    uint64_t next = RKM04_NEVER, now = sim_now(&bus->sim);
    for (const struct bus_waiter *waiter = bus->waiters; waiter; waiter = waiter->next) {
        uint64_t when = waiter->condition ? condition_next(waiter->condition) : RKM04_NEVER;
        if (waiter->limit < when)
            when = waiter->limit;
        if (when <= now)
            when = now + 1u;
        if (when < next)
            next = when;
    }
    return next;
}

void bus_wait(struct bus *bus, struct bus_waiter *waiter)
{
    waiter->next = bus->waiters;
    bus->waiters = waiter;
    if (!bus->busy)
        bus_catch_up(bus);
}

void bus_wait_cancel(struct bus *bus, struct bus_waiter *waiter)
{
    take_off(bus, waiter);
}

bool bus_advance(struct bus *bus, struct bus_waiter *waiter)
{
    if (!bus_stepped(bus) || bus->advancing)
        return false;
    bus->advancing = waiter;
    bus->goal = waiter->limit;
    bus_wait(bus, waiter);
    return true;
}

/* ---- Where time goes ------------------------------------------------------------------------------------------------ */

/* The earliest tick at which a byte is to be moved. */
static uint64_t due(const struct bus *bus)
{
    uint64_t tick = sim_due(&bus->sim);
    return bus->gathered > 0 && bus->answered < tick ? bus->answered : tick;
}

/* --clock max: the tick to leap to at `now` (ns): that of the next byte under way; else, unless the rest of a frame is on its
 * way, past the next thing that happens. RKM04_NEVER: no reason to leap. */
static uint64_t leap_to(const struct bus *bus, uint64_t now)
{
    if (!bus->clock.runs_ahead || sim_time_is_over(&bus->sim))
        return RKM04_NEVER;
    uint64_t byte = due(bus);
    if (byte != RKM04_NEVER)
        return byte < SIM_TIME_MAX ? byte : SIM_TIME_MAX;
    if (segment_in_frame(&bus->sim.segment) && now - bus->heard < FRAME_SILENCE)
        return RKM04_NEVER;
    uint64_t event = sim_next_event(&bus->sim), least = sim_now(&bus->sim) + LEAP;
    if (event == RKM04_NEVER)
        return RKM04_NEVER;
    uint64_t leap = event < least ? least : event + 1;
    return leap < SIM_TIME_MAX ? leap : SIM_TIME_MAX;
}

/* Up to which tick the units are to be at `now` (ns). */
static uint64_t goal(struct bus *bus, uint64_t now)
{
    if (bus_stepped(bus))
        return bus->goal;
    uint64_t tick = clock_tick(bus, now), leap = leap_to(bus, now);
    if (leap == RKM04_NEVER || leap <= tick)
        return tick;
    virtual_clock_leap(&bus->clock, now, leap);
    return leap;
}

/* Units of one address may take each other's answers for requests: plain framing, a fault that makes one of them late. */
static void report_cuts(struct bus *bus)
{
    struct segment_counters counters = segment_counters(&bus->sim.segment);
    if (counters.cuts > bus->cuts && bus->cuts < CUTS_TOLD)
        bus_log(bus, "units have answered one another more than %u times without a request, for %" PRIu64 ".%06" PRIu64
                     " s in all: cut off; have two units the same address?", SEGMENT_UNASKED_MAX,
                counters.cut_ticks / RKM04_TICKS_PER_SECOND, counters.cut_ticks % RKM04_TICKS_PER_SECOND);
    bus->cuts = counters.cuts;
}

/* One step towards `tick`: a span in which nothing happens, or STEP, and no further than somebody waits for. Anything may be
 * reached in one call of the sim, but then nobody would look at the line and at signals for a long while. */
static void step(struct bus *bus, uint64_t tick)
{
    uint64_t end = sim_now(&bus->sim) + STEP, wanted = waiters_next(bus);
    if (end < tick) {
        uint64_t event = sim_next_event(&bus->sim);
        if (end <= event)
            end = event == RKM04_NEVER ? RKM04_NEVER : event + 1;
    }
    if (wanted < end)
        end = wanted;
    sim_advance(&bus->sim, tick < end ? tick : end);
    report_cuts(bus);
    serve_waiters(bus);
}

static bool is_watched(const struct bus *bus)
{
    return bus->waiters || (bus->sim.watch.kinds & ~bus->news.kinds) != 0;
}

/* When (ns) there will be something to do; 0: not before bytes come. */
static uint64_t next_wake(const struct bus *bus, uint64_t now)
{
    uint64_t byte = due(bus), event = sim_next_event(&bus->sim), wanted = waiters_next(bus), when = 0;
    if (bus_stepped(bus) || sim_time_is_over(&bus->sim))
        return 0;
    if (leap_to(bus, now) != RKM04_NEVER)
        return now;
    if (wanted < byte)
        byte = wanted;
    if (faults_next(&bus->sim) < byte)
        byte = faults_next(&bus->sim); /* an adapter that is unplugged shows at once */
    if (byte != RKM04_NEVER) {
        when = virtual_clock_when(&bus->clock, byte);
        when = when > 0 ? when : now;
    }
    if (event != RKM04_NEVER) {
        uint64_t look = virtual_clock_when(&bus->clock, event + 1), rest = is_watched(bus) ? REST_WATCHED : REST;
        if (look < now + rest)
            look = now + rest;
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
    bus->wake = when;
}

/* The process has slept for much longer than it wanted to: it was stopped, or the machine was. */
static void look_if_late(struct bus *bus, uint64_t now)
{
    if (bus->wake == 0 || now < bus->wake + LATE)
        return;
    uint64_t late = now - bus->wake;
    if (bus->options->late_skips)
        virtual_clock_skip(&bus->clock, late);
    bus_log(bus, "late by %" PRIu64 ".%03" PRIu64 " s: was the process stopped? %s", late / NS_PER_SECOND,
            late % NS_PER_SECOND / NS_PER_MS,
            bus->options->late_skips ? "the units' time has not gone on meanwhile (--late skip)"
                                     : "the units catch up (--late catch-up)");
}

/* Whoever has chosen the clock should know that it is too fast. */
static void note_behind(struct bus *bus, uint64_t now, bool behind)
{
    if (!behind || bus->behind == 0)
        bus->behind = behind ? now : 0;
    if (behind && !bus->behind_told && !bus_stepped(bus) && now - bus->behind > LONG_BEHIND) {
        bus_log(bus, "behind clock %s for a second: the units go as fast as this machine can", bus->clock_text);
        bus->behind_told = true;
    }
}

static void note_end_of_time(struct bus *bus)
{
    if (bus->over_told || !sim_time_is_over(&bus->sim))
        return;
    bus_log(bus, "virtual time has come to its end, %" PRIu64 " s: the units' time does not go on, and they answer no more. "
            "Start again", SIM_TIME_MAX / RKM04_TICKS_PER_SECOND);
    bus->over_told = true;
}

void bus_catch_up(struct bus *bus)
{
    uint64_t start = uv_hrtime(), now = start, tick;
    if (!bus_stepped(bus))
        look_if_late(bus, now);
    bus->busy = true;
    do {
        tick = goal(bus, now);
        step(bus, tick);
        if (bus->answered <= sim_now(&bus->sim) && bus->gathered > 0) {
            bus_ports_send(bus, bus->out, bus->gathered);
            bus->gathered = 0;
        }
        now = uv_hrtime();
    } while (now - start < STINT && (sim_now(&bus->sim) < tick || leap_to(bus, now) != RKM04_NEVER));
    note_behind(bus, now, sim_now(&bus->sim) < tick);
    note_end_of_time(bus);
    if (segment_idle(&bus->sim.segment))
        bus_ports_silence(bus);
    bus_ports_listen(bus);
    bus_files_look(bus);
    bus->busy = false;
    if (bus_stepped(bus))
        tick = bus->goal; /* whoever it was advanced for may be content */
    uint64_t wake = sim_now(&bus->sim) < tick ? now : next_wake(bus, now);
    if (bus->options->late_skips && !bus_stepped(bus) && (wake == 0 || wake > now + HEARTBEAT))
        wake = now + HEARTBEAT;
    set_timer(bus, wake);
}

static void on_timer(uv_poll_t *handle, int status, int events)
{
    (void)status;
    (void)events;
    bus_catch_up(handle->data);
}

bool bus_time_begin(struct bus *bus, uv_loop_t *loop)
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

/* ---- From outside --------------------------------------------------------------------------------------------------- */

struct sim *bus_sim(struct bus *bus)
{
    if (!bus->busy)
        bus_catch_up(bus);
    return &bus->sim;
}

/* --clock max leaps when there is nothing to read. */
void bus_expect(struct bus *bus)
{
    if (!bus->busy && !bus->clock.runs_ahead)
        bus_catch_up(bus);
}

/* What a command does may take time along: a snapshot that is restored may be of a later tick. */
void bus_changed(struct bus *bus)
{
    uint64_t reached = sim_now(&bus->sim), now = uv_hrtime();
    if (bus_stepped(bus) && bus->goal < reached)
        bus->goal = reached;
    if (!bus_stepped(bus) && virtual_clock_tick(&bus->clock, now) < reached)
        virtual_clock_leap(&bus->clock, now, reached);
    if (!bus->busy)
        bus_catch_up(bus);
}

bool bus_set_clock(struct bus *bus, const char *text, struct refusal *refusal)
{
    struct virtual_clock clock;
    if (strlen(text) >= sizeof bus->clock_text || !virtual_clock_read(&clock, text)) {
        refuse(refusal, REFUSED_PARAMS, "clock: `%.40s' is wrong: expected " VIRTUAL_CLOCK_EXPECTED, text);
        return false;
    }
    if (bus->advancing) {
        refuse(refusal, REFUSED_STATE, "the clock is being advanced: change it when that has ended");
        return false;
    }
    bus_sim(bus);
    bus->behind = 0;
    bus->behind_told = false;
    sim_set_timed(&bus->sim, bus->options->baud != 0 && !bus->ports.line.is_wire && !clock.stands);
    bus->goal = sim_now(&bus->sim);
    bus->clock = clock;
    virtual_clock_start(&bus->clock, uv_hrtime(), bus->goal);
    snprintf(bus->clock_text, sizeof bus->clock_text, "%s", text);
    bus_log(bus, "clock %s", text);
    bus_changed(bus);
    return true;
}
