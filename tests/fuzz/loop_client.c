/* SPDX-License-Identifier: MIT */
#include "loop_client.h"

#include <errno.h>
#include <inttypes.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "control/control_connection.h"
#include "control/control_rpc.h"
#include "fuzz.h"
#include "sim/watch.h"

static unsigned lines_there;
static struct sockaddr_un here;
static struct sockaddr_in by_port; /* port 0: `here' is used */

/* ---- What is due ---------------------------------------------------------------------------------------------------- */

static void expect(struct client *client, enum due_kind kind, const json_t *id, json_t *params, unsigned line)
{
    struct due *due = calloc(1, sizeof *due), **at = &client->first;
    FUZZ_CHECK(due, "no memory");
    *due = (struct due){.kind = kind, .id = json_deep_copy(id), .params = json_incref(params), .line = line};
    for (; *at; at = &(*at)->next) {
        if (json_equal((*at)->id, id))
            (*at)->doubtful = due->doubtful = true;
    }
    *at = due;
    if (due->doubtful)
        client->silent_subscribe = true;
}

static void forget(struct due **at)
{
    struct due *due = *at;
    *at = due->next;
    json_decref(due->id);
    json_decref(due->params);
    free(due);
}

static enum due_kind kind_of(const char *method)
{
    static const char *const names[] = {
        [DUE_WAIT] = "wait", [DUE_ADVANCE] = "advance", [DUE_SUBSCRIBE] = "subscribe", [DUE_UNSUBSCRIBE] = "unsubscribe",
        [DUE_TRACE_STOP] = "trace.stop", [DUE_SHUTDOWN] = "shutdown", [DUE_AUTHENTICATE] = "authenticate",
    };
    for (unsigned i = 1; i < sizeof names / sizeof names[0]; i++)
        if (strcmp(names[i], method) == 0)
            return (enum due_kind)i;
    return DUE_OTHER;
}

static void expect_error(struct client *client)
{
    expect(client, DUE_OTHER, json_null(), NULL, 0);
}

static void sent_line(struct client *client, const char *line, size_t length)
{
    struct rpc_request request;
    struct refusal refusal;
    if (strspn(line, " \t\r") >= length)
        return;
    bool ok = rpc_read(&request, line, length, lines_there, &refusal);
    enum due_kind kind = ok ? kind_of(request.method) : DUE_OTHER;
    if (kind == DUE_SHUTDOWN) {
        client->shutdowns++;
        client->shutdowns_silent += !request.id;
    }
    if (request.id)
        expect(client, kind, request.id, ok ? request.params : NULL, request.line);
    else if (kind == DUE_SUBSCRIBE)
        client->silent_subscribe = true;
    rpc_end(&request);
}

/* What the other end makes of the bytes that it has taken. */
static void sent(struct client *client, const char *text, size_t length)
{
    if (client->part_room < client->part_length + length + 1u) {
        client->part_room = 2u * (client->part_length + length + 1u);
        client->part = realloc(client->part, client->part_room);
        FUZZ_CHECK(client->part, "no memory");
    }
    memcpy(client->part + client->part_length, text, length);
    client->part_length += length;
    size_t at = 0;
    for (char *end; (end = memchr(client->part + at, '\n', client->part_length - at)) != NULL;) {
        size_t count = (size_t)(end - (client->part + at));
        *end = '\0';
        if (!client->skipping && count > CONNECTION_LINE_MAX)
            expect_error(client);
        else if (!client->skipping)
            sent_line(client, client->part + at, count);
        client->skipping = false;
        at += count + 1u;
    }
    memmove(client->part, client->part + at, client->part_length - at);
    client->part_length -= at;
    if (client->part_length > CONNECTION_LINE_MAX && !client->skipping) {
        expect_error(client);
        client->skipping = true;
    }
    if (client->skipping)
        client->part_length = 0;
}

/* ---- What comes ----------------------------------------------------------------------------------------------------- */

/* An answer that is not in its turn may be that of a wait. */
static struct due **due_of(struct client *client, const json_t *id)
{
    struct due **at = &client->first;
    while (*at && (*at)->kind == DUE_WAIT)
        at = &(*at)->next;
    if (*at && json_equal((*at)->id, id))
        return at;
    for (at = &client->first; *at; at = &(*at)->next)
        if ((*at)->kind == DUE_WAIT && json_equal((*at)->id, id))
            return at;
    return NULL;
}

static uint64_t tick_of(const json_t *object, const char *name, const char *text)
{
    const json_t *tick = json_object_get(object, name);
    FUZZ_CHECK(json_is_integer(tick) && json_integer_value(tick) >= 0, "%s", text);
    return (uint64_t)json_integer_value(tick);
}

/* An answer is behind the events up to its tick, and those to requests of a line are in the order of time; a wait may have come
 * true while a later one was executed. */
static void answered(struct client *client, const struct due *due, uint64_t tick, const char *text)
{
    if (tick > client->told[due->line])
        client->told[due->line] = tick;
    if (due->kind == DUE_WAIT)
        return;
    FUZZ_CHECK(tick >= client->answered[due->line], "after %" PRIu64 ": %s", client->answered[due->line], text);
    client->answered[due->line] = tick;
}

static void subscribe(struct client *client, const struct due *due, const json_t *result, const char *text)
{
    const json_t *number = json_object_get(result, "subscription");
    json_int_t value = json_integer_value(number);
    FUZZ_CHECK(json_is_integer(number) && value > 0 && value < CLIENT_SUBSCRIPTIONS && !client->subscription[value].there, "%s",
               text);
    client->subscription[value] =
        (struct subscribed){.there = true, .line = due->line, .kinds = json_incref(json_object_get(due->params, "kinds"))};
}

static void unsubscribe(struct client *client, const struct due *due, const char *text)
{
    json_int_t value = json_integer_value(json_object_get(due->params, "subscription"));
    FUZZ_CHECK(value > 0 && value < CLIENT_SUBSCRIPTIONS, "%s", text);
    struct subscribed *subscribed = &client->subscription[value];
    FUZZ_CHECK(subscribed->there || client->silent_subscribe, "there was none: %s", text);
    json_decref(subscribed->kinds);
    *subscribed = (struct subscribed){0};
}

static void take_result(struct client *client, const struct due *due, const json_t *result, const char *text)
{
    FUZZ_CHECK(due->params && json_is_object(result), "no request, and obeyed: %s", text);
    if (due->kind == DUE_UNSUBSCRIBE)
        unsubscribe(client, due, text);
    if (due->kind != DUE_UNSUBSCRIBE && due->kind != DUE_AUTHENTICATE &&
        due->kind != DUE_TRACE_STOP) /* whose line may be another */
        answered(client, due, tick_of(result, "t_us", text), text);
    if (due->kind == DUE_SUBSCRIBE)
        subscribe(client, due, result, text);
    if (due->kind == DUE_SHUTDOWN)
        client->shutdowns_answered++;
    if (due->kind == DUE_WAIT || json_object_get(due->params, "until")) {
        const json_t *holds = json_object_get(result, "holds"), *instead = json_object_get(result, "text");
        FUZZ_CHECK(json_is_true(holds) ? !instead : json_is_false(holds) && json_string_length(instead) > 0, "%s", text);
    }
}

static void take_error(const json_t *error, const char *text)
{
    static const json_int_t codes[] = {-32700, -32600, -32601, -32602, -32000};
    const json_t *code = json_object_get(error, "code");
    bool known = false;
    for (unsigned i = 0; i < sizeof codes / sizeof codes[0]; i++)
        known = known || json_integer_value(code) == codes[i];
    FUZZ_CHECK(json_is_integer(code) && known, "%s", text);
    FUZZ_CHECK(json_string_length(json_object_get(error, "message")) > 0, "%s", text);
}

static void take_answer(struct client *client, const json_t *answer, const char *text)
{
    const json_t *id = json_object_get(answer, "id"), *result = json_object_get(answer, "result"),
                 *error = json_object_get(answer, "error");
    FUZZ_CHECK(json_object_size(answer) == 3 && id && !result != !error, "%s", text);
    struct due **due = due_of(client, id);
    if (!due && client->crowded && json_is_null(id) && error) {
        client->left = true; /* one too many: it is closed */
        return;
    }
    FUZZ_CHECK(due, "nothing of that kind is due now: %s", text);
    if (error)
        take_error(error, text);
    else if ((*due)->doubtful)
        client->shutdowns_answered++; /* perhaps */
    else
        take_result(client, *due, result, text);
    forget(due);
}

static bool is_one_of(const json_t *kinds, const char *kind)
{
    size_t i;
    const json_t *one;
    json_array_foreach(kinds, i, one) {
        if (strcmp(json_string_value(one), kind) == 0)
            return true;
    }
    return !kinds;
}

static void on_event(struct client *client, json_int_t number, uint64_t tick, const char *kind, const char *text)
{
    FUZZ_CHECK(number > 0 && number < CLIENT_SUBSCRIPTIONS && watch_kind_named(kind) != WATCH_KINDS, "%s", text);
    const struct subscribed *subscribed = &client->subscription[number];
    FUZZ_CHECK(subscribed->there || client->silent_subscribe, "nobody asked for it: %s", text);
    FUZZ_CHECK(is_one_of(subscribed->kinds, kind), "not of the kinds asked for: %s", text);
    if (!subscribed->there)
        return;
    FUZZ_CHECK(tick >= client->told[subscribed->line], "after %" PRIu64 ": %s", client->told[subscribed->line], text);
    client->told[subscribed->line] = client->latest = tick;
}

static void take_event(struct client *client, const json_t *event, const char *text)
{
    const json_t *params = json_object_get(event, "params"), *number = json_object_get(params, "subscription");
    const char *kind = json_string_value(json_object_get(params, "kind"));
    FUZZ_CHECK(json_is_integer(number) && kind && json_object_get(params, "value"), "%s", text);
    on_event(client, json_integer_value(number), tick_of(params, "t_us", text), kind, text);
}

/* A step is read by its form alone: there may be very many. Returns false if it is something else, or due for a closer look. */
static bool take_step(struct client *client, const char *text, size_t length)
{
    static const char head[] = "{\"jsonrpc\":\"2.0\",\"method\":\"event\",\"params\":{\"subscription\":";
    unsigned number, motor;
    uint64_t tick;
    int used = 0;
    if (length < sizeof head || memcmp(text, head, sizeof head - 1) != 0 || client->events++ % 64 == 0)
        return false;
    sscanf(text + sizeof head - 1,
           "%u,\"t_us\":%" SCNu64 ",\"kind\":\"step\",\"unit\":\"%*[0-9-]\",\"motor\":%u,\"value\":%*d}}%n", &number, &tick,
           &motor, &used);
    if (used == 0 || text[sizeof head - 1 + (size_t)used] != '\0')
        return false;
    FUZZ_CHECK(motor >= 1 && motor <= 4, "%s", text);
    on_event(client, number, tick, "step", text);
    return true;
}

static void take_lost(struct client *client, const json_t *lost, const char *text)
{
    const json_t *params = json_object_get(lost, "params"), *events = json_object_get(params, "events");
    FUZZ_CHECK(json_is_integer(events) && json_integer_value(events) > 0, "%s", text);
    uint64_t tick = tick_of(params, "t_us", text);
    if (lines_there == 1)
        FUZZ_CHECK(tick >= client->latest, "after an event of %" PRIu64 ": %s", client->latest, text);
}

static void take_line(struct client *client, const char *text, size_t length)
{
    json_error_t error;
    if (take_step(client, text, length))
        return;
    json_t *object = json_loadb(text, length, JSON_REJECT_DUPLICATES | JSON_ALLOW_NUL, &error);
    FUZZ_CHECK(json_is_object(object), "%s: %s", error.text, text);
    const char *version = json_string_value(json_object_get(object, "jsonrpc")),
               *method = json_string_value(json_object_get(object, "method"));
    FUZZ_CHECK(version && strcmp(version, "2.0") == 0, "%s", text);
    if (!method)
        take_answer(client, object, text);
    else if (strcmp(method, "event") == 0 && !json_object_get(object, "id"))
        take_event(client, object, text);
    else if (strcmp(method, "lost") == 0 && !json_object_get(object, "id"))
        take_lost(client, object, text);
    else
        FUZZ_CHECK(false, "%s", text);
    json_decref(object);
}

static void take_lines(struct client *client)
{
    size_t at = 0;
    for (char *end; (end = memchr(client->in + at, '\n', client->in_length - at)) != NULL;) {
        *end = '\0';
        take_line(client, client->in + at, (size_t)(end - (client->in + at)));
        at = (size_t)(end - client->in) + 1u;
    }
    memmove(client->in, client->in + at, client->in_length - at);
    client->in_length -= at;
}

bool client_take(struct client *client)
{
    bool some = false;
    while (client->fd >= 0 && client->reading && !client->hung_up) {
        if (client->in_room - client->in_length < 65536) {
            client->in_room = 2u * client->in_room + 65536;
            client->in = realloc(client->in, client->in_room);
            FUZZ_CHECK(client->in, "no memory");
        }
        ssize_t length = recv(client->fd, client->in + client->in_length, client->in_room - client->in_length, MSG_DONTWAIT);
        if (length < 0 && errno == EAGAIN)
            break;
        some = true;
        if (length > 0) {
            client->in_length += (size_t)length;
            client->received += (size_t)length;
            take_lines(client);
        } else {
            client->hung_up = true;
            FUZZ_CHECK(client->in_length == 0 || client->over, "half a line, then the end: %.*s", (int)client->in_length,
                       client->in);
        }
    }
    return some;
}

/* ---- Coming and going ----------------------------------------------------------------------------------------------- */

void client_none(struct client *client)
{
    memset(client, 0, sizeof *client);
    client->fd = -1;
}

void client_find(const char *path, const char *tcp, unsigned lines)
{
    lines_there = lines;
    here = (struct sockaddr_un){.sun_family = AF_UNIX};
    by_port = (struct sockaddr_in){.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    FUZZ_CHECK(strlen(path) < sizeof here.sun_path, "TMPDIR is too long");
    strcpy(here.sun_path, path);
    if (tcp)
        by_port.sin_port = htons((uint16_t)strtoul(strrchr(tcp, ':') + 1, NULL, 10));
}

bool client_connect(struct client *client)
{
    bool tcp = by_port.sin_port != 0;
    int on = 1;
    client_none(client);
    client->reading = true;
    client->fd = socket(tcp ? AF_INET : AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | (tcp ? 0 : SOCK_NONBLOCK), 0);
    if (client->fd >= 0 && tcp) /* what is sent is there at once */
        setsockopt(client->fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    return client->fd >= 0 && (tcp ? connect(client->fd, (const struct sockaddr *)&by_port, sizeof by_port)
                                   : connect(client->fd, (const struct sockaddr *)&here, sizeof here)) == 0;
}

size_t client_send(struct client *client, const char *text, size_t length)
{
    size_t done = 0;
    while (done < length && !client->left && !client->hung_up) {
        ssize_t taken = send(client->fd, text + done, length - done, MSG_NOSIGNAL | MSG_DONTWAIT);
        if (taken <= 0)
            break;
        sent(client, text + done, (size_t)taken);
        done += (size_t)taken;
    }
    return done;
}

void client_leave(struct client *client)
{
    if (client->left || client->hung_up)
        return;
    client->left = true;
    shutdown(client->fd, SHUT_WR);
    if (client->part_length > 0 && !client->skipping)
        expect_error(client);
}

void client_check_quiet(const struct client *client)
{
    if (client->fd < 0 || client->crowded)
        return;
    FUZZ_CHECK(client->in_length == 0, "half a line: %.*s", (int)client->in_length, client->in);
    for (const struct due *due = client->first; due; due = due->next) {
        char *id = json_dumps(due->id, JSON_ENCODE_ANY);
        bool given_up = by_port.sin_port != 0 && client->left && (due->kind == DUE_WAIT || due->kind == DUE_ADVANCE);
        FUZZ_CHECK(given_up || (due->kind == DUE_WAIT && !client->hung_up), "request %s is not answered%s", id,
                   client->hung_up ? ", and the connection is closed" : "");
        free(id);
    }
    FUZZ_CHECK(!client->hung_up || client->left, "the connection was closed for no reason");
}

void client_close(struct client *client)
{
    while (client->first)
        forget(&client->first);
    for (unsigned i = 0; i < CLIENT_SUBSCRIPTIONS; i++)
        json_decref(client->subscription[i].kinds);
    if (client->fd >= 0)
        close(client->fd);
    free(client->part);
    free(client->in);
    client_none(client);
}
