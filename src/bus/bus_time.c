/* SPDX-License-Identifier: MIT */
#include "bus_time.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "line/line.h"

#define NS_PER_MS 1000000u
#define NS_PER_SECOND 1000000000u
#define REST (100u * NS_PER_MS)          /* longest sleep while motors or programs run */
#define REST_WATCHED (10u * NS_PER_MS)   /* while there are watchers */
#define LATE (500u * NS_PER_MS)          /* so much behind, and the process was stopped */
#define LONG_BEHIND NS_PER_SECOND        /* without having caught up once, after which it is logged */
#define HEARTBEAT (250u * NS_PER_MS)     /* --late skip: longest sleep, so that it is noticed when the process was stopped */
#define STINT (5u * NS_PER_MS)           /* longest time without checking the line and signals */
#define STEP 100000u                     /* ticks that the units are advanced at once while they are at work */
#define LEAP 10000u                      /* ticks: shortest leap of --clock max; less would cost more than it shows */
#define CUTS_TOLD 100u                   /* units that were cut off from answering one another, in the log */
#define FRAME_SILENCE (100u * NS_PER_MS) /* --clock max: how long the rest of a frame is waited for (L2) */

bool bus_time_is_stepped(const struct bus_time *time)
{
    return time->clock.stands;
}

/* Where the clock is at `now` (ns). */
static uint64_t clock_tick(const struct bus_time *time, uint64_t now)
{
    uint64_t tick = virtual_clock_tick(&time->clock, now);
    return tick < SIM_TIME_MAX ? tick : SIM_TIME_MAX;
}

uint64_t bus_time_present(const struct bus_time *time)
{
    if (!time->running)
        return 0;
    return bus_time_is_stepped(time) || time->behind > 0 ? sim_now(time->sim) : clock_tick(time, uv_hrtime());
}

/* ---- Who waits ------------------------------------------------------------------------------------------------------ */

static void remove_waiter(struct bus_time *time, struct bus_waiter *waiter)
{
    for (struct bus_waiter **at = &time->waiters; *at; at = &(*at)->next) {
        if (*at == waiter) {
            *at = waiter->next;
            break;
        }
    }
    if (time->advancing == waiter) {
        time->advancing = NULL;
        time->goal = sim_now(time->sim);
    }
}

/* Call the waiters that are done. A waiter may wait again or remove others in its call. */
static void serve_waiters(struct bus_time *time)
{
    for (struct bus_waiter *waiter = time->waiters; waiter;) {
        bool holds = waiter->condition && condition_holds(waiter->condition);
        if (!holds && sim_now(time->sim) < waiter->limit) {
            waiter = waiter->next;
            continue;
        }
        remove_waiter(time, waiter);
        waiter->done(waiter, holds);
        waiter = time->waiters;
    }
}

/* The tick up to which no waiter can be done. */
static uint64_t next_waiter_tick(const struct bus_time *time)
{
    uint64_t next = DEVICE_NEVER, now = sim_now(time->sim);
    for (const struct bus_waiter *waiter = time->waiters; waiter; waiter = waiter->next) {
        uint64_t when = waiter->condition ? condition_next(waiter->condition) : DEVICE_NEVER;
        if (waiter->limit < when)
            when = waiter->limit;
        if (when <= now)
            when = now + 1u;
        if (when < next)
            next = when;
    }
    return next;
}

void bus_time_wait(struct bus_time *time, struct bus_waiter *waiter)
{
    waiter->next = time->waiters;
    time->waiters = waiter;
    bus_time_update(time);
}

void bus_time_cancel_wait(struct bus_time *time, struct bus_waiter *waiter)
{
    remove_waiter(time, waiter);
}

bool bus_time_advance(struct bus_time *time, struct bus_waiter *waiter)
{
    if (!bus_time_is_stepped(time) || time->advancing)
        return false;
    time->advancing = waiter;
    time->goal = waiter->limit;
    bus_time_wait(time, waiter);
    return true;
}

/* ---- Where time goes ------------------------------------------------------------------------------------------------ */

/* The earliest tick at which a byte is to be moved. */
static uint64_t next_byte_tick(const struct bus_time *time)
{
    uint64_t tick = sim_due(time->sim), answer = time->calls->due(time->context);
    return answer < tick ? answer : tick;
}

/* --clock max: the tick to leap to at `now` (ns): that of the next byte under way; else, unless the rest of a frame is on its
 * way, past the next thing that happens. DEVICE_NEVER: no reason to leap. */
static uint64_t leap_target(const struct bus_time *time, uint64_t now)
{
    if (!time->clock.runs_ahead || sim_time_is_over(time->sim))
        return DEVICE_NEVER;
    uint64_t byte = next_byte_tick(time);
    if (byte != DEVICE_NEVER)
        return byte < SIM_TIME_MAX ? byte : SIM_TIME_MAX;
    if (segment_in_frame(&time->sim->segment) && now - time->last_byte < FRAME_SILENCE)
        return DEVICE_NEVER;
    uint64_t event = sim_next_event(time->sim), least = sim_now(time->sim) + LEAP;
    if (event == DEVICE_NEVER)
        return DEVICE_NEVER;
    uint64_t leap = event < least ? least : event + 1;
    return leap < SIM_TIME_MAX ? leap : SIM_TIME_MAX;
}

/* Up to which tick the units are to be at `now` (ns). */
static uint64_t find_target(struct bus_time *time, uint64_t now)
{
    if (bus_time_is_stepped(time))
        return time->goal;
    uint64_t tick = clock_tick(time, now), leap = leap_target(time, now);
    if (leap == DEVICE_NEVER || leap <= tick)
        return tick;
    virtual_clock_leap(&time->clock, now, leap);
    return leap;
}

/* Units of one address may take each other's answers for requests: plain framing, a fault that makes one of them late. */
static void report_cuts(struct bus_time *time)
{
    struct segment_counters counters = segment_counters(&time->sim->segment);
    if (counters.cuts > time->cuts && time->cuts < CUTS_TOLD)
        bus_log(time->log, "units have answered one another more than %u times without a request, for %" PRIu64 ".%06" PRIu64
                     " s in all: stopped; do two units have the same address?", SEGMENT_UNASKED_MAX,
                counters.cut_ticks / US_PER_SECOND, counters.cut_ticks % US_PER_SECOND);
    time->cuts = counters.cuts;
}

/* One step towards `tick`: a span in which nothing happens, or STEP, and no further than a waiter waits for. Anything may be
 * reached in one call of the sim, but then the line and signals would not be served for a long time. */
static void advance_sim(struct bus_time *time, uint64_t tick)
{
    uint64_t end = sim_now(time->sim) + STEP, wanted = next_waiter_tick(time);
    if (end < tick) {
        uint64_t event = sim_next_event(time->sim);
        if (end <= event)
            end = event == DEVICE_NEVER ? DEVICE_NEVER : event + 1;
    }
    if (wanted < end)
        end = wanted;
    sim_advance(time->sim, tick < end ? tick : end);
    report_cuts(time);
    serve_waiters(time);
}

static bool is_watched(const struct bus_time *time)
{
    return time->waiters || (time->sim->watch.kinds & ~time->own_kinds) != 0;
}

/* When (ns) there will be something to do; 0: not before bytes come. */
static uint64_t next_wake_time(const struct bus_time *time, uint64_t now)
{
    uint64_t byte = next_byte_tick(time), event = sim_next_event(time->sim), wanted = next_waiter_tick(time), when = 0;
    if (bus_time_is_stepped(time) || sim_time_is_over(time->sim))
        return 0;
    if (leap_target(time, now) != DEVICE_NEVER)
        return now;
    if (wanted < byte)
        byte = wanted;
    if (faults_next(&time->sim->faults) < byte)
        byte = faults_next(&time->sim->faults); /* an adapter that is unplugged shows at once */
    if (byte != DEVICE_NEVER) {
        when = virtual_clock_when(&time->clock, byte);
        when = when > 0 ? when : now;
    }
    if (event != DEVICE_NEVER) {
        uint64_t look = virtual_clock_when(&time->clock, event + 1), rest = is_watched(time) ? REST_WATCHED : REST;
        if (look < now + rest)
            look = now + rest;
        if (when == 0 || look < when)
            when = look;
    }
    return when;
}

static void set_timer(struct bus_time *time, uint64_t when)
{
    wake_timer_set(&time->timer, when);
    time->wake = when;
}

/* The process has slept for much longer than it wanted to: it was stopped, or the machine was. */
static void handle_late_wake(struct bus_time *time, uint64_t now)
{
    if (time->wake == 0 || now < time->wake + LATE)
        return;
    uint64_t late = now - time->wake;
    if (time->options->late_skips)
        virtual_clock_skip(&time->clock, late);
    bus_log(time->log, "late by %" PRIu64 ".%03" PRIu64 " s: was the process stopped? %s", late / NS_PER_SECOND,
            late % NS_PER_SECOND / NS_PER_MS,
            time->options->late_skips ? "the units' clock was paused meanwhile (--late skip)"
                                     : "the units catch up (--late catch-up)");
}

/* Report a clock that is too fast for the machine. */
static void log_if_behind(struct bus_time *time, uint64_t now, bool behind)
{
    if (!behind || time->behind == 0)
        time->behind = behind ? now : 0;
    if (behind && !time->behind_logged && !bus_time_is_stepped(time) && now - time->behind > LONG_BEHIND) {
        bus_log(time->log, "too slow for clock %s for a second: the units run as fast as this machine can", time->clock_text);
        time->behind_logged = true;
    }
}

static void log_end_of_time(struct bus_time *time)
{
    if (time->over_logged || !sim_time_is_over(time->sim))
        return;
    bus_log(time->log, "virtual time has reached its end, %" PRIu64 " s: the units' time has stopped, and they no "
            "longer answer. Restart the emulator", SIM_TIME_MAX / US_PER_SECOND);
    time->over_logged = true;
}

void bus_time_catch_up(struct bus_time *time)
{
    uint64_t start = uv_hrtime(), now = start, tick;
    if (!bus_time_is_stepped(time))
        handle_late_wake(time, now);
    time->busy = true;
    do {
        tick = find_target(time, now);
        advance_sim(time, tick);
        time->calls->advanced(time->context);
        now = uv_hrtime();
    } while (now - start < STINT && (sim_now(time->sim) < tick || leap_target(time, now) != DEVICE_NEVER));
    log_if_behind(time, now, sim_now(time->sim) < tick);
    log_end_of_time(time);
    time->calls->before_sleep(time->context);
    time->busy = false;
    if (bus_time_is_stepped(time))
        tick = time->goal; /* its waiter may be done */
    uint64_t wake = sim_now(time->sim) < tick ? now : next_wake_time(time, now);
    if (time->options->late_skips && !bus_time_is_stepped(time) && (wake == 0 || wake > now + HEARTBEAT))
        wake = now + HEARTBEAT;
    set_timer(time, wake);
}

static void on_timer(void *context)
{
    bus_time_catch_up(context);
}

void bus_time_prepare(struct bus_time *time, const struct bus_options *options, bool timed, struct sim *sim,
                      const struct bus_log *log, const struct bus_time_calls *calls, void *context)
{
    time->options = options;
    time->timed = timed;
    time->sim = sim;
    time->log = log;
    time->calls = calls;
    time->context = context;
    time->clock = options->clock;
    snprintf(time->clock_text, sizeof time->clock_text, "%s", options->clock_text);
}

bool bus_time_begin(struct bus_time *time, uv_loop_t *loop)
{
    return wake_timer_open(&time->timer, loop, on_timer, time);
}

void bus_time_start(struct bus_time *time)
{
    virtual_clock_start(&time->clock, uv_hrtime(), 0);
    time->running = true;
    bus_time_catch_up(time);
}

void bus_time_end(struct bus_time *time)
{
    wake_timer_close(&time->timer);
}

/* ---- From outside --------------------------------------------------------------------------------------------------- */

/* Unless it is being done already. */
void bus_time_update(struct bus_time *time)
{
    if (!time->busy)
        bus_time_catch_up(time);
}

void bus_time_note_bytes(struct bus_time *time)
{
    time->last_byte = uv_hrtime();
}

/* --clock max leaps when there is nothing to read. */
void bus_time_before_read(struct bus_time *time)
{
    if (!time->busy && !time->clock.runs_ahead)
        bus_time_catch_up(time);
}

/* What a command does may take time along: a snapshot that is restored may be of a later tick. */
void bus_time_changed(struct bus_time *time)
{
    uint64_t reached = sim_now(time->sim), now = uv_hrtime();
    if (bus_time_is_stepped(time) && time->goal < reached)
        time->goal = reached;
    if (!bus_time_is_stepped(time) && virtual_clock_tick(&time->clock, now) < reached)
        virtual_clock_leap(&time->clock, now, reached);
    if (!time->busy)
        bus_time_catch_up(time);
}

bool bus_time_set_clock(struct bus_time *time, const char *text, struct refusal *refusal)
{
    struct virtual_clock clock;
    if (strlen(text) >= sizeof time->clock_text || !virtual_clock_read(&clock, text)) {
        refuse(refusal, REFUSED_PARAMS, "clock: `%.40s' is wrong: expected " VIRTUAL_CLOCK_EXPECTED, text);
        return false;
    }
    if (time->advancing) {
        refuse(refusal, REFUSED_STATE, "a client is advancing the clock: change it when that has ended");
        return false;
    }
    bus_time_update(time);
    time->behind = 0;
    time->behind_logged = false;
    sim_set_timed(time->sim, time->timed && !clock.stands);
    time->goal = sim_now(time->sim);
    time->clock = clock;
    virtual_clock_start(&time->clock, uv_hrtime(), time->goal);
    snprintf(time->clock_text, sizeof time->clock_text, "%s", text);
    bus_log(time->log, "clock %s", text);
    bus_time_changed(time);
    return true;
}
