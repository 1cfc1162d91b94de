/* SPDX-License-Identifier: MIT */
/* The server of PMC controllers for clients on TCP: modbus-tcp. */
#include <string.h>

#include "modbus/modbus.h"
#include "pmc_device.h"

#define ANY_UNIT 255u

struct tcp_client {
    struct modbus_tcp tcp;
    uint16_t length, sent; /* bytes of the answer */
    bool is_over;
    uint8_t answer[MODBUS_TCP_MAX];
};

/* The controller that is meant. NULL: there is none, or it has no power. */
static struct device_unit *find_unit(const struct device_bus *bus, uint8_t address)
{
    if ((address == 0 || address == ANY_UNIT) && bus->units == 1)
        return bus->unit[0];
    for (unsigned i = 0; i < bus->units; i++)
        if (bus->node[i] == address)
            return bus->unit[i];
    return NULL;
}

static void execute(struct tcp_client *client, const struct device_bus *bus)
{
    const uint8_t *request = client->tcp.frame + MODBUS_TCP_HEAD;
    uint8_t *answer = client->answer + MODBUS_TCP_HEAD;
    struct device_unit *unit = find_unit(bus, client->tcp.frame[MODBUS_TCP_UNIT]);
    size_t length;
    if (unit)
        length = pmc_modbus_exchange(pmc_of(unit), request, client->tcp.length - MODBUS_TCP_HEAD, answer, MODBUS_PDU_MAX);
    else
        length = modbus_put_exception(answer, request[0], MODBUS_NO_TARGET);
    client->length = (uint16_t)modbus_tcp_answer(&client->tcp, client->answer, length);
    client->sent = 0;
}

/* Up to the end of a request: its answer goes out before the next one is executed. */
static size_t receive(struct device_client *state, const struct device_bus *bus, const uint8_t *bytes, size_t length)
{
    struct tcp_client *client = (struct tcp_client *)state;
    size_t taken = 0;
    while (taken < length && !client->is_over && client->length == 0) {
        const enum modbus_tcp_result result = modbus_tcp_take(&client->tcp, bytes[taken++]);
        client->is_over = result == MODBUS_TCP_WRONG;
        if (result == MODBUS_TCP_WHOLE)
            execute(client, bus);
    }
    return taken;
}

static size_t send(struct device_client *state, const struct device_bus *bus, uint8_t *bytes, size_t room)
{
    struct tcp_client *client = (struct tcp_client *)state;
    const size_t left = client->length - client->sent, length = left < room ? left : room;
    (void)bus;
    memcpy(bytes, client->answer + client->sent, length);
    client->sent = (uint16_t)(client->sent + length);
    if (client->sent == client->length)
        client->length = client->sent = 0;
    return length;
}

static bool is_over(const struct device_client *state)
{
    return ((const struct tcp_client *)state)->is_over;
}

const struct device_service pmc_services[] = {
    {.name = "modbus-tcp",
     .description = "Modbus TCP, whatever `face` is; the unit of a request is the controller's address",
     .size = sizeof(struct tcp_client),
     .clients = DEVICE_CLIENTS_MAX,
     .receive = receive,
     .send = send,
     .is_over = is_over},
    {.name = NULL},
};
