/* SPDX-License-Identifier: MIT */
#include "cib_bus.h"

#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "command/command.h"
#include "device/cib_device.h"
#include "record/record.h"

static void hear(void *context, const uint8_t *bytes, size_t length)
{
    struct cib_bus *bus = context;
    if (bus->length == 0) {
        bus->first_tick = sim_now(&bus->sim);
        bus->start = bus->first_tick - 521;
    }
    for (size_t i = 0; i < length; i++)
        bus->length += (size_t)snprintf(bus->heard + bus->length, sizeof bus->heard - bus->length, "%s%02X",
                                        bus->length > 0 ? " " : "", bytes[i]);
    ck_assert_uint_lt(bus->length, sizeof bus->heard);
}

void cib_bus_begin(struct cib_bus *bus, const char *nodes, bool timed, const struct device_config *own)
{
    struct sim_config config = {
        .device = &cib_device,
        .timed = timed,
        .turnaround = timed ? CIB_TURNAROUND : 0,
        .seed = 1,
        .out = hear,
        .context = bus,
    };
    memset(bus, 0, sizeof *bus);
    if (own)
        config.unit = *own;
    ck_assert(node_list_read_up_to(&config.nodes, nodes, cib_device.addresses));
    ck_assert(sim_begin(&bus->sim, &config));
    ck_assert(snapshots_attach(&bus->sim));
}

void cib_bus_end(struct cib_bus *bus)
{
    sim_end(&bus->sim);
}

void cib_bus_to(struct cib_bus *bus, uint64_t tick)
{
    sim_advance(&bus->sim, tick);
}

static size_t bytes_of(const char *hex, uint8_t bytes[512])
{
    size_t length = 0;
    while (*hex != '\0') {
        char *end;
        char pair[3] = {hex[0], hex[1], '\0'};
        bytes[length++] = (uint8_t)strtoul(pair, &end, 16);
        ck_assert_msg(*end == '\0' && length < 512, "no bytes: %s", hex);
        for (hex += 2; *hex == ' ';)
            hex++;
    }
    return length;
}

static void send(struct cib_bus *bus, const uint8_t *bytes, size_t length)
{
    bus->length = 0;
    bus->heard[0] = '\0';
    sim_queue_bytes(&bus->sim, bytes, length, sim_now(&bus->sim));
    sim_finish_tick(&bus->sim);
}

void cib_bus_send(struct cib_bus *bus, const char *hex)
{
    uint8_t bytes[512];
    send(bus, bytes, bytes_of(hex, bytes));
}

void cib_bus_expect(struct cib_bus *bus, const char *request, const char *answer)
{
    cib_bus_send(bus, request);
    ck_assert_msg(strcmp(bus->heard, answer) == 0, "at %llu: %s\n got %s\nexpected %s", (unsigned long long)sim_now(&bus->sim),
                  request, bus->heard, answer);
}

void cib_bus_expect_checked(struct cib_bus *bus, const char *request, const char *answer)
{
    uint8_t bytes[512];
    char expected[2048] = "";
    size_t at = 0, length = answer[0] != '\0' ? modbus_append_crc(bytes, bytes_of(answer, bytes)) : 0;
    for (size_t i = 0; i < length; i++)
        at += (size_t)snprintf(expected + at, sizeof expected - at, "%s%02X", i > 0 ? " " : "", bytes[i]);
    send(bus, bytes, modbus_append_crc(bytes, bytes_of(request, bytes)));
    ck_assert_msg(strcmp(bus->heard, expected) == 0, "%s\n got %s\nexpected %s", request, bus->heard, expected);
}

unsigned cib_bus_input(struct cib_bus *bus, unsigned address)
{
    return cib_read(&cib_device_of(sim_core(&bus->sim, 1))->unit, CIB_INPUT_ZONE, (uint16_t)address);
}

json_t *cib_bus_command(struct cib_bus *bus, const char *method, const char *text)
{
    struct refusal refusal;
    json_t *params = json_loads(text, 0, NULL), *result = sim_command(&bus->sim, method, params, &refusal);
    ck_assert_ptr_nonnull(params);
    json_decref(params);
    ck_assert_msg(result != NULL, "%s %s: %s", method, text, result ? "" : refusal.text);
    return result;
}

void cib_bus_do(struct cib_bus *bus, const char *method, const char *params)
{
    json_decref(cib_bus_command(bus, method, params));
}

void cib_bus_expect_refusal(struct cib_bus *bus, const char *method, const char *text, const char *expected)
{
    struct refusal refusal;
    json_t *params = json_loads(text, 0, NULL), *result = sim_command(&bus->sim, method, params, &refusal);
    json_decref(params);
    ck_assert_msg(!result && strstr(refusal.text, expected), "%s %s: %s", method, text, result ? "accepted" : refusal.text);
}
