/* SPDX-License-Identifier: MIT */
/* sim_service.c: the clients of the servers that a kind of device has (device_service), in virtual time. */
#include <stdlib.h>
#include <string.h>

#include "sim.h"

#define PART 1024u /* bytes that are sent at once */

struct sim_client {
    const struct device_service *service; /* NULL: this place is free */
    struct device_client *state;
    uint64_t since;  /* how many came before it */
    uint64_t next;   /* us at which send() is to be asked; DEVICE_NEVER */
    size_t seen;     /* bytes that were reported and not taken: they come again */
    char peer[DEVICE_PEER_SIZE];
};

struct sim_services {
    uint64_t arrived, next; /* next: the first of the clients' */
    unsigned last;          /* clients above this number have never been there */
    struct sim_client client[DEVICE_CLIENTS_MAX];
};

/* ---- What a server sees --------------------------------------------------------------------------------------------- */

static void list_peers(const struct sim_services *all, const struct device_service *service, struct device_bus *bus)
{
    const struct sim_client *order[DEVICE_CLIENTS_MAX];
    for (unsigned i = 0; i < all->last; i++) {
        const struct sim_client *client = &all->client[i];
        if (client->service != service)
            continue;
        unsigned at = bus->clients++;
        for (; at > 0 && order[at - 1u]->since > client->since; at--)
            order[at] = order[at - 1u];
        order[at] = client;
    }
    for (unsigned i = 0; i < bus->clients; i++)
        bus->peer[i] = order[i]->peer;
}

static void describe_bus(struct sim *sim, const struct device_service *service, struct device_bus *bus)
{
    bus->now = sim_now(sim);
    bus->units = sim_units(sim);
    bus->clients = 0;
    for (unsigned number = 1; number <= bus->units; number++) {
        bus->unit[number - 1u] = sim_powered(sim, number) ? sim_core(sim, number) : NULL;
        bus->node[number - 1u] = (uint8_t)sim_device(sim)->node(sim_core(sim, number));
    }
    list_peers(sim->services, service, bus);
}

static void report(struct sim *sim, unsigned number, enum watch_service_act act, const uint8_t *bytes, size_t length)
{
    struct watch_event event = {.tick = sim_now(sim), .value = (int32_t)number, .kind = WATCH_SERVICE};
    if ((sim->watch.kinds & WATCH_BIT(WATCH_SERVICE)) == 0)
        return;
    struct watch_service *news = malloc(sizeof *news + length);
    event.service = news;
    if (!news) {
        sim->watch.short_of_memory = true;
        return;
    }
    *news = (struct watch_service){.name = sim->services->client[number - 1u].service->name, .act = act, .length = length};
    if (length > 0)
        memcpy(news->bytes, bytes, length);
    sim_report(sim, WATCH_DELIVERED, &event);
}

/* ---- One client ----------------------------------------------------------------------------------------------------- */

static struct sim_client *client_of(const struct sim *sim, unsigned number)
{
    struct sim_client *client =
        sim->services && number >= 1 && number <= DEVICE_CLIENTS_MAX ? &sim->services->client[number - 1u] : NULL;
    return client && client->service ? client : NULL;
}

static void find_next(struct sim_services *all)
{
    all->next = DEVICE_NEVER;
    for (unsigned i = 0; i < all->last; i++)
        if (all->client[i].service && all->client[i].next < all->next)
            all->next = all->client[i].next;
}

void sim_service_close(struct sim *sim, unsigned number)
{
    struct sim_client *client = client_of(sim, number);
    if (!client)
        return;
    report(sim, number, WATCH_SERVICE_CLOSED, NULL, 0);
    free(client->state);
    client->service = NULL;
    client->state = NULL;
    find_next(sim->services);
    if (sim->config.service_out)
        sim->config.service_out(sim->config.context, number, NULL, 0);
}

static void send_part(struct sim *sim, unsigned number, const uint8_t *bytes, size_t length, struct sim_service_sent *sent)
{
    report(sim, number, WATCH_SERVICE_SENT, bytes, length);
    if (sent && length <= sizeof sent->bytes - sent->length) {
        memcpy(sent->bytes + sent->length, bytes, length);
        sent->length += length;
    } else if (sent) {
        sent->is_cut = true;
    }
    if (sim->config.service_out)
        sim->config.service_out(sim->config.context, number, bytes, length);
}

static bool is_over(const struct sim_client *client)
{
    return client->service->is_over && client->service->is_over(client->state);
}

/* Send what there is to be sent now. */
static void pump(struct sim *sim, unsigned number, struct device_bus *bus, struct sim_service_sent *sent)
{
    struct sim_client *client = client_of(sim, number);
    uint8_t part[PART];
    for (size_t length; (length = client->service->send(client->state, bus, part, sizeof part)) > 0;)
        send_part(sim, number, part, length, sent);
    uint64_t next = client->service->next ? client->service->next(client->state, bus) : DEVICE_NEVER;
    client->next = next > bus->now ? next : bus->now + 1u; /* asked a moment ago */
    find_next(sim->services);
}

size_t sim_service_receive(struct sim *sim, unsigned number, const uint8_t *bytes, size_t length, size_t room,
                           struct sim_service_sent *sent)
{
    struct sim_client *client = client_of(sim, number);
    struct device_bus bus;
    size_t at = 0;
    if (!client)
        return length;
    describe_bus(sim, client->service, &bus);
    if (length > client->seen)
        report(sim, number, WATCH_SERVICE_RECEIVED, bytes + client->seen, length - client->seen);
    while (at < length && sent->length < room) {
        size_t taken = client->service->receive(client->state, &bus, bytes + at, length - at);
        pump(sim, number, &bus, sent);
        at += taken;
        if (taken > 0 && !is_over(client))
            continue;
        sim_service_close(sim, number);
        return length;
    }
    client->seen = length - at;
    return at;
}

bool sim_service_is_open(const struct sim *sim, unsigned number)
{
    return client_of(sim, number) != NULL;
}

/* ---- Clients that come ---------------------------------------------------------------------------------------------- */

static unsigned count_clients(const struct sim_services *all, const struct device_service *service)
{
    unsigned count = 0;
    for (unsigned i = 0; i < all->last; i++)
        count += all->client[i].service == service;
    return count;
}

static unsigned find_place(const struct sim_services *all)
{
    unsigned at = 0;
    while (at < DEVICE_CLIENTS_MAX && all->client[at].service)
        at++;
    return at;
}

const struct device_service *sim_service_named(const struct sim *sim, const char *name)
{
    const struct device_service *service = sim_device(sim)->services;
    while (service && service->name && strcmp(service->name, name) != 0)
        service++;
    return service && service->name ? service : NULL;
}

unsigned sim_service_open(struct sim *sim, const struct device_service *service, const char *peer)
{
    if (!sim->services)
        sim->services = calloc(1, sizeof *sim->services);
    struct sim_services *all = sim->services;
    unsigned at = all ? find_place(all) : DEVICE_CLIENTS_MAX;
    struct device_client *state = at < DEVICE_CLIENTS_MAX && count_clients(all, service) < service->clients
                                      ? calloc(1, service->size + 1u)
                                      : NULL;
    struct device_bus bus;
    if (!state)
        return 0;
    struct sim_client *client = &all->client[at];
    *client = (struct sim_client){.service = service, .state = state, .since = all->arrived++, .next = DEVICE_NEVER};
    strncpy(client->peer, peer, sizeof client->peer - 1u);
    all->last = at >= all->last ? at + 1u : all->last;
    describe_bus(sim, service, &bus);
    report(sim, at + 1u, WATCH_SERVICE_OPEN, NULL, 0);
    if (service->open)
        service->open(state, &bus);
    return at + 1u;
}

void sim_service_start(struct sim *sim, unsigned number, struct sim_service_sent *sent)
{
    struct device_bus bus;
    struct sim_client *client = client_of(sim, number);
    if (!client)
        return;
    describe_bus(sim, client->service, &bus);
    pump(sim, number, &bus, sent);
    if (is_over(client))
        sim_service_close(sim, number);
}

/* ---- Time ----------------------------------------------------------------------------------------------------------- */

uint64_t sim_services_next(const struct sim *sim)
{
    return sim->services ? sim->services->next : DEVICE_NEVER;
}

void sim_services_run(struct sim *sim)
{
    struct sim_services *all = sim->services;
    for (unsigned number = 1; all->next <= sim_now(sim) && number <= all->last; number++)
        if (all->client[number - 1u].service && all->client[number - 1u].next <= sim_now(sim))
            sim_service_start(sim, number, NULL);
}

void sim_services_close(struct sim *sim)
{
    for (unsigned number = 1; sim->services && number <= sim->services->last; number++)
        sim_service_close(sim, number);
}

bool sim_services_are_open(const struct sim *sim)
{
    for (unsigned number = 1; sim->services && number <= sim->services->last; number++)
        if (client_of(sim, number))
            return true;
    return false;
}

void sim_services_free(struct sim *sim)
{
    for (unsigned at = 0; sim->services && at < sim->services->last; at++)
        free(sim->services->client[at].state);
    free(sim->services);
    sim->services = NULL;
}
