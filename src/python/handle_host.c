/* SPDX-License-Identifier: MIT */
/* The host at the end of the bus: what it sends and receives, at its own speed. */
#include <stdlib.h>
#include <string.h>

#include "handle.h"

#define ROOM_FIRST 64u /* bytes */
#define TICKS_PER_SECOND 1000000u

void handle_host_configure(struct handle *handle, struct line_settings settings)
{
    struct handle_host *host = &handle->host;
    if (host->settings.baud != 0 && line_settings_equal(host->settings, settings))
        return;
    host->settings = settings;
    host->differs = !line_settings_equal(settings, host->unit);
    line_receiver_begin(&host->to_units, settings, host->unit, false);
    line_receiver_begin(&host->to_host, host->unit, settings, true);
}

/* ---- Sending ---------------------------------------------------------------------------------------------------------- */

/* How long the host sends so many bytes, rounded up. */
static uint64_t duration(const struct handle_host *host, size_t bytes)
{
    const struct line_settings *settings = &host->settings;
    uint64_t halves = 2u + 2u * settings->data_bits + (settings->parity != 'N' ? 2u : 0u) + settings->stop_halves;
    uint64_t per_second = 2u * (uint64_t)settings->baud;
    return (bytes * halves * TICKS_PER_SECOND + per_second - 1u) / per_second;
}

/* Hand over one byte, as soon as there is room. */
static bool hand_over(struct handle *handle, uint8_t byte, uint64_t tick)
{
    struct sim *sim = &handle->sim;
    while (sim_room(sim) == 0)
        if (!handle_advance(handle, sim_now(sim) + sim_device(sim)->slot) || sim_time_is_over(sim))
            return false;
    sim_queue_bytes(sim, &byte, 1, tick > sim_now(sim) ? tick : sim_now(sim));
    return true;
}

static bool hand_over_heard(struct handle *handle, const struct line_received *heard, size_t number)
{
    for (size_t i = 0; i < number; i++)
        if (!hand_over(handle, heard[i].byte, heard[i].tick))
            return false;
    return true;
}

/* Bytes that are received as others, if at all. */
static bool write_otherwise(struct handle *handle, const uint8_t *bytes, size_t length)
{
    struct handle_host *host = &handle->host;
    struct line_received heard[LINE_RECEIVER_MAX];
    uint64_t start = host->free > sim_now(&handle->sim) ? host->free : sim_now(&handle->sim);
    for (size_t i = 0; i < length; i++)
        if (!hand_over_heard(handle, heard, line_receiver_byte(&host->to_units, bytes[i], start, heard)))
            return false;
    host->free = start + duration(host, length);
    return hand_over_heard(handle, heard, line_receiver_silence(&host->to_units, heard));
}

bool handle_host_write(struct handle *handle, const uint8_t *bytes, size_t length)
{
    struct sim *sim = &handle->sim;
    if (handle->host.differs)
        return length == 0 || write_otherwise(handle, bytes, length);
    for (size_t at = 0; at < length;) {
        size_t room = sim_room(sim), part = length - at < room ? length - at : room;
        if (part > 0)
            sim_queue_bytes(sim, bytes + at, part, sim_now(sim));
        else if (!handle_advance(handle, sim_now(sim) + sim_device(sim)->slot) || sim_time_is_over(sim))
            return false;
        at += part;
    }
    uint64_t passed = (sim->segment.host_free + WIRE_TICK - 1u) / WIRE_TICK;
    handle->host.free = sim->segment.config.timed ? passed : sim_now(sim);
    return true;
}

/* ---- Hearing ---------------------------------------------------------------------------------------------------------- */

static bool make_room(struct handle_host *host)
{
    if (host->count < host->room)
        return true;
    size_t room = host->room > 0 ? 2u * host->room : ROOM_FIRST;
    struct handle_byte *heard = room <= HANDLE_HEARD_MAX ? malloc(room * sizeof *heard) : NULL;
    if (!heard)
        return false;
    for (size_t i = 0; i < host->count; i++)
        heard[i] = host->heard[(host->head + i) % host->room];
    free(host->heard);
    host->heard = heard;
    host->head = 0;
    host->room = room;
    return true;
}

static void keep(struct handle *handle, uint8_t byte)
{
    struct handle_host *host = &handle->host;
    if (make_room(host))
        host->heard[(host->head + host->count++) % host->room] = (struct handle_byte){sim_now(&handle->sim), byte};
    else
        host->lost++;
}

void handle_host_receive(void *context, const uint8_t *bytes, size_t length)
{
    struct handle *handle = context;
    struct line_received heard[LINE_RECEIVER_MAX];
    uint64_t byte = wire_byte_parts(&handle->sim.segment.wire) / WIRE_TICK; /* ticks */
    for (size_t i = 0; i < length; i++) {
        size_t number = 1;
        heard[0].byte = bytes[i];
        if (handle->host.differs) /* the byte began as long ago as it takes */
            number = line_receiver_byte(&handle->host.to_host, bytes[i], sim_now(&handle->sim) - byte, heard);
        for (size_t at = 0; at < number; at++)
            keep(handle, heard[at].byte);
    }
}

void handle_host_finish(struct handle *handle)
{
    struct line_received heard[LINE_RECEIVER_MAX];
    if (!handle->host.differs || sim_due(&handle->sim) != DEVICE_NEVER)
        return;
    size_t number = line_receiver_silence(&handle->host.to_host, heard);
    for (size_t at = 0; at < number; at++)
        keep(handle, heard[at].byte);
}

size_t handle_host_read(struct handle *handle, struct handle_byte *bytes, size_t length)
{
    struct handle_host *host = &handle->host;
    size_t number = length < host->count ? length : host->count;
    for (size_t i = 0; i < number; i++)
        bytes[i] = host->heard[(host->head + i) % host->room];
    host->head = host->room > 0 ? (host->head + number) % host->room : 0;
    host->count -= number;
    return number;
}
