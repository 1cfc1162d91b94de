/* SPDX-License-Identifier: MIT */
/* fake_service.c: a server of the device without a bus: requests as fake.h has them, a line each, for several clients.
 *
 *     TELL     send the position at each 100 ms of the bus, if it has changed      WHO     the clients
 *     BYE      hang up */
#include <stdio.h>
#include <string.h>

#include "fake.h"
#include "fake_device.h"

#define TELL_US 100000u

struct fake_client {
    bool telling, over;
    int32_t told;
    uint8_t length;
    char line[FAKE_TEXT_MAX + 1], out[128];
};

static struct fake_client *client_of(struct device_client *client)
{
    return (struct fake_client *)client;
}

static void say(struct fake_client *client, const char *text)
{
    size_t length = strlen(client->out);
    snprintf(client->out + length, sizeof client->out - length, "%s\r\n", text);
}

static void greet(struct device_client *client, const struct device_bus *bus)
{
    char text[32];
    snprintf(text, sizeof text, "HELLO %u", bus->clients);
    say(client_of(client), text);
}

static void list_clients(struct fake_client *client, const struct device_bus *bus)
{
    for (unsigned i = 0; i < bus->clients; i++)
        say(client, bus->peer[i]);
}

static void obey(struct fake_client *client, const struct device_bus *bus)
{
    struct fake_unit *unit = fake_alone_core(bus->unit[0]);
    if (strcmp(client->line, "BYE") == 0)
        client->over = true;
    else if (strcmp(client->line, "WHO") == 0)
        list_clients(client, bus);
    else if (!unit)
        say(client, "no power");
    else if (strcmp(client->line, "TELL") == 0)
        client->telling = true;
    else
        say(client, fake_obey(unit, client->line));
}

/* A line at a time. */
static size_t receive(struct device_client *state, const struct device_bus *bus, const uint8_t *bytes, size_t length)
{
    struct fake_client *client = client_of(state);
    for (size_t at = 0; at < length; at++) {
        if (bytes[at] == '\n') {
            client->line[client->length] = '\0';
            client->length = 0;
            obey(client, bus);
            return at + 1u;
        }
        if (client->length == FAKE_TEXT_MAX)
            return 0;
        client->line[client->length++] = (char)bytes[at];
    }
    return length;
}

static size_t send(struct device_client *state, const struct device_bus *bus, uint8_t *bytes, size_t room)
{
    struct fake_client *client = client_of(state);
    const struct fake_unit *unit = fake_alone_core(bus->unit[0]);
    char text[32];
    if (client->telling && unit && bus->now % TELL_US == 0 && unit->position != client->told) {
        client->told = unit->position;
        snprintf(text, sizeof text, "POS %d", (int)unit->position);
        say(client, text);
    }
    size_t length = strlen(client->out);
    length = length < room ? length : room;
    memcpy(bytes, client->out, length);
    memmove(client->out, client->out + length, sizeof client->out - length);
    return length;
}

static bool is_over(const struct device_client *client)
{
    return ((const struct fake_client *)client)->over;
}

static uint64_t next(const struct device_client *client, const struct device_bus *bus)
{
    return ((const struct fake_client *)client)->telling ? (bus->now / TELL_US + 1u) * TELL_US : DEVICE_NEVER;
}

const struct device_service fake_services[] = {
    {.name = "lines",
     .description = "requests, a line each",
     .size = sizeof(struct fake_client),
     .clients = 8,
     .refusal = "FULL\r\n",
     .open = greet,
     .receive = receive,
     .send = send,
     .is_over = is_over,
     .next = next},
    {.name = NULL},
};
