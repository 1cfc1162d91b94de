/* SPDX-License-Identifier: MIT */
#include "handle.h"

#define SLICE 1000000u /* ticks in which something happens, between two questions whether to pause */

static uint64_t earlier(uint64_t a, uint64_t b)
{
    return a < b ? a : b;
}

static bool is_paused(const struct handle *handle)
{
    return handle->paused && handle->paused(handle->paused_context);
}

/* The end of a slice that begins now. A while in which nothing happens does not count. */
static uint64_t slice_end(const struct sim *sim)
{
    uint64_t now = sim_now(sim), quiet = earlier(sim_next_event(sim), sim_due(sim));
    uint64_t from = quiet > now ? quiet : now;
    return from > DEVICE_NEVER - SLICE ? DEVICE_NEVER : from + SLICE;
}

bool handle_advance(struct handle *handle, uint64_t tick)
{
    struct sim *sim = &handle->sim;
    tick = earlier(tick, SIM_TIME_MAX);
    if (tick <= sim_now(sim))
        sim_finish_tick(sim);
    while (sim_now(sim) < tick) {
        sim_advance(sim, earlier(tick, slice_end(sim)));
        if (sim_now(sim) < tick && is_paused(handle))
            return false;
    }
    handle_host_finish(handle);
    return true;
}

/* Has the host `count` bytes, or `stop` among those from *seen on? *seen becomes the number of those examined. */
static bool has_bytes(const struct handle_host *host, size_t count, size_t *seen, int stop)
{
    for (; stop >= 0 && *seen < host->count; (*seen)++)
        if (host->heard[(host->head + *seen) % host->room].byte == stop)
            return true;
    return host->count >= count;
}

bool handle_advance_to_bytes(struct handle *handle, uint64_t tick, size_t count, int stop)
{
    struct sim *sim = &handle->sim;
    size_t seen = 0;
    tick = earlier(tick, SIM_TIME_MAX);
    sim_finish_tick(sim);
    while (!has_bytes(&handle->host, count, &seen, stop) && sim_now(sim) < tick) {
        uint64_t now = sim_now(sim), next = earlier(sim_due(sim), faults_next(&sim->faults));
        next = earlier(next > now ? next : now + 1, slice_end(sim));
        sim_advance(sim, earlier(tick, next));
        handle_host_finish(handle);
        if (is_paused(handle))
            return false;
    }
    return true;
}

bool handle_advance_until(struct handle *handle, struct condition *condition, uint64_t end, bool *holds)
{
    struct sim *sim = &handle->sim;
    condition_arm(condition);
    sim_finish_tick(sim);
    *holds = condition_holds(condition);
    while (!*holds && sim_now(sim) < end) {
        *holds = condition_step(condition, earlier(end, slice_end(sim)));
        if (!*holds && is_paused(handle))
            return false;
    }
    handle_host_finish(handle);
    return true;
}
