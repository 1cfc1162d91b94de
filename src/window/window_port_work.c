/* SPDX-License-Identifier: MIT */
#include "window_port_work.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include <rkm04/limits.h>

#include "window_system.h"

#define SET_COMMAND 2
#define HEAD 2u          /* message number and motor */
#define STOP_MS 50u      /* how long a unit may take to answer K: the bus is to be stopped, too */
#define OPEN_MS 1000u

static const char *outcome_name(enum client_outcome outcome)
{
    static const char *const names[] = {"answered", "sent", "silent", "lost", "cancelled"};
    return names[outcome];
}

static json_t *hex(const uint8_t *bytes, size_t length)
{
    static const char digits[] = "0123456789abcdef";
    char *text = malloc(2 * length + 1);
    if (text == NULL)
        return json_null();
    for (size_t i = 0; i < length; i++) {
        text[2 * i] = digits[bytes[i] >> 4];
        text[2 * i + 1] = digits[bytes[i] & 15];
    }
    json_t *string = json_stringn(text, 2 * length);
    free(text);
    return string;
}

static double wall_ms(void)
{
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    return (double)now.tv_sec * 1000.0 + (double)now.tv_nsec / 1e6;
}

void port_work_close(struct window_port *port)
{
    if (port->client.fd >= 0)
        close(port->client.fd);
    port->client.fd = -1;
    port->name[0] = '\0';
}

/* One request and its answer as an object. */
static json_t *exchange(struct window_port *port, const uint8_t *message, size_t length, enum client_outcome *outcome)
{
    struct client *client = &port->client;
    uint64_t begun = client_now();
    double time = wall_ms();
    *outcome = client_exchange(client, message, length);
    json_t *answer = json_pack("{s:s, s:i, s:o, s:o, s:f, s:I}", "outcome", outcome_name(*outcome), "node", client->node,
                               "request", hex(message, length), "answer",
                               *outcome == CLIENT_ANSWERED ? hex(client->answer, client->length) : json_null(), "t_ms", time,
                               "round_trip_us", (json_int_t)(client_now() - begun));
    if (*outcome == CLIENT_LOST)
        port_work_close(port);
    return answer;
}

/* ---- Jobs ------------------------------------------------------------------------------------------------------------- */

static void work_open(struct window_port *port, struct port_job *job)
{
    port_work_close(port);
    if (!client_port_valid(job->text)) {
        client_report("expected tcp:HOST:PORT, PORT 1 to 65535, like tcp:localhost:4001, found '%s'", job->text);
    } else {
        port->client.fd = client_port_open(job->text, OPEN_MS);
        port->client.framing = job->framing;
        if (port->client.fd >= 0)
            snprintf(port->name, sizeof port->name, "%s", job->text);
        port->client.port = port->name;
    }
    job->result = json_pack("{s:s}", "outcome", port->client.fd >= 0 ? "open" : "lost");
}

static void work_request(struct window_port *port, struct port_job *job)
{
    enum client_outcome outcome;
    port->client.node = (uint8_t)job->node;
    port->client.timeout_ms = job->timeout_ms;
    job->result = exchange(port, job->message, job->message_length, &outcome);
}

/* K to all motors of the unit, then to those of all units. */
static void work_stop(struct window_port *port, struct port_job *job)
{
    static const uint8_t stop[] = {SET_COMMAND, '0', 'K'};
    enum client_outcome outcome = CLIENT_SENT;
    json_t *unit = json_null(), *bus = NULL;
    port->client.timeout_ms = STOP_MS;
    if (job->node > 0) {
        port->client.node = (uint8_t)job->node;
        unit = exchange(port, stop, sizeof stop, &outcome);
    }
    port->client.node = 0;
    if (port->client.fd >= 0)
        bus = exchange(port, stop, sizeof stop, &outcome);
    job->trouble[0] = '\0'; /* a unit that is silent has got the second one */
    job->result = json_pack("{s:s, s:o, s:o}", "outcome", bus != NULL ? outcome_name(outcome) : "lost", "unit", unit, "bus",
                            bus != NULL ? bus : json_null());
}

static void on_progress(void *context, size_t sent)
{
    struct window_port *port = context;
    (void)sent;
    uv_async_send(&port->progress);
}

/* Send the pieces up to the first that is refused. Returns how many have been taken. */
static size_t send_pieces(struct window_port *port, const struct port_job *job, const struct client_cut *cut, json_t *messages,
                          int *flag)
{
    enum client_outcome outcome = CLIENT_ANSWERED;
    size_t i;
    for (i = 0; i < cut->pieces; i++) {
        uint8_t message[CLIENT_MESSAGE_MAX] = {SET_COMMAND, (uint8_t)('0' + job->motor)};
        memcpy(message + HEAD, cut->piece[i].text, cut->piece[i].length);
        json_array_append_new(messages, exchange(port, message, HEAD + cut->piece[i].length, &outcome));
        if (outcome != CLIENT_ANSWERED && outcome != CLIENT_SENT)
            return i;
        const struct client *client = &port->client;
        int answered = outcome == CLIENT_ANSWERED && client->length == HEAD + 2 ? client->answer[HEAD] : 0;
        if (answered > *flag)
            *flag = answered;
        if (answered == 1 || answered == 2)
            return i;
        atomic_fetch_add(&port->sent, cut->piece[i].length);
        uv_async_send(&port->progress);
    }
    return i;
}

static void report_cut(const struct client_cut *cut, enum client_cut_result result)
{
    static const char *const texts[] = {
        [CLIENT_CUT_INVALID] = "the unit would refuse the text",
        [CLIENT_CUT_LONG_COMMAND] = "a command alone is longer than a message",
        [CLIENT_CUT_OPEN_BLOCK] = "a [ is never closed, and the text after it does not fit into one message",
        [CLIENT_CUT_NO_MEMORY] = "out of memory",
    };
    if (result == CLIENT_CUT_TOO_MANY)
        client_report("%zu commands: a program longer than one message can have at most %zu, because the brackets around it are "
                      "stored, too", cut->program, RKM04_PROGRAM_MAX - (cut->places - cut->program));
    else
        client_report("%s", texts[result]);
}

static void work_send(struct window_port *port, struct port_job *job)
{
    struct client_cut cut = {0};
    json_t *messages = json_array();
    int flag = 0;
    size_t taken = 0;
    job->length = program_text_map(job->text, job->length);
    enum client_cut_result result = client_cut(&cut, job->text, job->length, job->message_max - HEAD);
    port->client.node = (uint8_t)job->node;
    port->client.timeout_ms = job->timeout_ms;
    if (result == CLIENT_CUT_DONE) {
        for (size_t i = 0; i < cut.pieces; i++)
            atomic_fetch_add(&port->total, cut.piece[i].length);
        port->client.progress = on_progress;
        port->client.context = port;
        taken = send_pieces(port, job, &cut, messages, &flag);
        port->client.progress = NULL;
    } else {
        report_cut(&cut, result);
    }
    json_t *last = json_array_get(messages, json_array_size(messages) - 1);
    const char *outcome = last != NULL ? json_string_value(json_object_get(last, "outcome")) : "refused";
    job->result = json_pack("{s:s, s:i, s:i, s:I, s:I, s:I, s:o}", "outcome", outcome, "node", (int)job->node, "flag", flag,
                            "taken", (json_int_t)taken, "pieces", (json_int_t)cut.pieces, "commands", (json_int_t)cut.commands,
                            "messages", messages);
    client_cut_free(&cut);
}

void port_work(struct window_port *port, struct port_job *job)
{
    static void (*const works[])(struct window_port *, struct port_job *) = {
        [PORT_OPEN] = work_open, [PORT_REQUEST] = work_request, [PORT_SEND] = work_send, [PORT_STOP] = work_stop,
    };
    if (job->kind == PORT_STOP)
        window_cancel_clear(port->cancel); /* what it was about has ended */
    client_report_into(job->trouble, sizeof job->trouble);
    if (job->kind == PORT_CLOSE) {
        port_work_close(port);
        job->result = json_pack("{s:s}", "outcome", "closed");
    } else if (job->kind != PORT_OPEN && port->client.fd < 0) {
        client_report("no port is open");
        job->result = json_pack("{s:s}", "outcome", "lost");
    } else {
        works[job->kind](port, job);
    }
    client_report_into(NULL, 0);
}
