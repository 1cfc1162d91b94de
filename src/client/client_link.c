/* SPDX-License-Identifier: MIT */
#include "client_link.h"

#include <errno.h>
#include <inttypes.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <termios.h>
#include <unistd.h>

#include "client_cause.h"
#include "client_port.h"
#include "client_report.h"

#define NUMBER_UNKNOWN 255  /* message number of "unknown message" */
#define PROGRESS_MS 100
#define CLOSE_GRACE_US 20000 /* a line that is closed at once may lose what is still in a buffer */

/* Time that so many bytes take on the line, us. */
static uint64_t line_time(size_t bytes)
{
    return (uint64_t)bytes * 10u * RKM04_TICKS_PER_SECOND / CLIENT_BAUD;
}

static size_t encode_frame(struct client *client, const uint8_t *message, size_t length)
{
    struct rkm04_sender sender = {0};
    size_t n = client->framing->begin(&sender, client->node, 0, length, false, client->wire);
    for (size_t i = 0; i < length; i++)
        n += client->framing->put(&sender, message[i], client->wire + n);
    return n + client->framing->end(&sender, client->wire + n);
}

/* One dialogue in progress. */
struct dialogue {
    struct client *client;
    const uint8_t *request;
    size_t length; /* of the request */
    size_t frame;  /* bytes of it on the line */
    uint64_t begun, deadline, last_moment;
};

/* ---- Waiting ------------------------------------------------------------------------------------------------------ */

static void show_progress(const struct dialogue *d)
{
    if (d->client->progress == NULL)
        return;
    uint64_t gone = (client_now() - d->begun) * CLIENT_BAUD / 10u / RKM04_TICKS_PER_SECOND;
    d->client->progress(d->client->context, gone < d->frame ? (size_t)gone : d->frame);
}

/* Wait for an event on the line. Returns true if there is one, false at the deadline. */
static bool wait_for(const struct dialogue *d, short events)
{
    const int *cancel = d->client->cancel;
    struct pollfd files[] = {{.fd = d->client->fd, .events = events}, {.fd = cancel != NULL ? *cancel : -1, .events = POLLIN}};
    for (;;) {
        uint64_t now = client_now();
        uint64_t left = now < d->deadline ? (d->deadline - now + 999u) / 1000u : 0; /* 0: what has come meanwhile counts */
        poll(files, 2, left < PROGRESS_MS ? (int)left : PROGRESS_MS);
        show_progress(d);
        if (files[1].revents != 0)
            return false;
        if (files[0].revents != 0)
            return true;
        if (left == 0)
            return false;
    }
}

static bool is_cancelled(const struct client *client)
{
    struct pollfd file = {.fd = client->cancel != NULL ? *client->cancel : -1, .events = POLLIN};
    return poll(&file, 1, 0) > 0;
}

/* Give up; what has not left yet stays unsent. */
static enum client_outcome drop_request(const struct client *client)
{
    tcflush(client->fd, TCOFLUSH);
    return CLIENT_CANCELLED;
}

/* Read what has come. Returns as read(2). What came first is kept. */
static ssize_t read_bytes(struct client *client, uint8_t *bytes, size_t room)
{
    ssize_t n = read(client->fd, bytes, room);
    for (ssize_t i = 0; i < n && client->first_count < sizeof client->first - 1; i++)
        client->first[client->first_count++] = (char)bytes[i];
    return n;
}

/* The emulator has sent us away with a text instead of an answer. Returns the reason without line end; NULL: it has not. */
static const char *find_refusal(struct client *client)
{
    static const char begin[] = "rkm04: refused: ";
    char *reason = client->first + sizeof begin - 1;
    client->first[client->first_count] = '\0';
    if (strncmp(client->first, begin, sizeof begin - 1) != 0)
        return NULL;
    for (char *at = reason; *at; at++)
        if (*at < ' ' || *at > '~')
            *at = '\0';
    return reason;
}

static enum client_outcome report_lost(struct client *client)
{
    uint8_t bytes[256];
    int why = errno;
    for (unsigned i = 0; i < 4 && read_bytes(client, bytes, sizeof bytes) > 0; i++)
        ; /* a text may have come before the line failed */
    const char *reason = find_refusal(client);
    errno = why;
    if (reason) {
        client_report("%s: refused: %s", client->port, reason);
        return CLIENT_LOST;
    }
    client_report("%s: the connection was closed at its other end (%s)", client->port,
                  errno != 0 ? strerror(errno) : "end of file");
    return CLIENT_LOST;
}

/* ---- Sending ------------------------------------------------------------------------------------------------------ */

/* Forget what has come so far. Returns false if the line is gone. */
static bool drop_input(struct client *client)
{
    uint8_t bytes[512];
    ssize_t n;
    while ((n = read_bytes(client, bytes, sizeof bytes)) > 0)
        ;
    memset(&client->receiver, 0, sizeof client->receiver);
    memset(&client->unbroken, 0, sizeof client->unbroken);
    if (n == 0)
        errno = 0;
    return n < 0 && (errno == EAGAIN || errno == EINTR);
}

static enum client_outcome send_frame(const struct dialogue *d)
{
    struct client *client = d->client;
    for (size_t sent = 0; sent < d->frame;) {
        ssize_t n = write(client->fd, client->wire + sent, d->frame - sent);
        if (n > 0) {
            sent += (size_t)n;
        } else if (n < 0 && errno != EAGAIN && errno != EINTR) {
            return report_lost(client);
        } else {
            if (!wait_for(d, POLLOUT | POLLIN)) {
                if (is_cancelled(client))
                    return drop_request(client);
                client_report("%s accepts no bytes: is the program or the device at its other end stuck?", client->port);
                return CLIENT_SILENT;
            }
            if (!drop_input(client)) /* no answer yet; but who sends us something must not wait for us to read it */
                return report_lost(client);
        }
    }
    return CLIENT_SENT;
}

/* To all units: no answer shows when it has arrived. */
static void wait_until_sent(const struct dialogue *d)
{
    uint64_t end = d->begun + line_time(d->frame) + CLOSE_GRACE_US;
    tcdrain(d->client->fd);
    for (uint64_t now = client_now(); now < end && !is_cancelled(d->client); now = client_now()) {
        uint64_t left = (end - now + 999u) / 1000u;
        poll(NULL, 0, left < PROGRESS_MS ? (int)left : PROGRESS_MS);
        show_progress(d);
    }
}

/* ---- Receiving ---------------------------------------------------------------------------------------------------- */

/* Messages 2 to 7 repeat the motor. */
static bool is_for_motor(const struct dialogue *d, const struct rkm04_receiver *r, const uint8_t *message)
{
    bool named = d->request[0] >= 2 && d->request[0] <= 7 && d->length >= 2 && d->request[1] >= '0' &&
                 d->request[1] <= '0' + RKM04_MOTORS;
    return !named || (r->length >= 2 && message[1] == d->request[1]);
}

/* Is the message that was received the answer? */
static bool is_answer(const struct dialogue *d, const struct rkm04_receiver *r, const uint8_t *message)
{
    const struct client *client = d->client;
    if (client->framing->answer_names_sender ? r->dnode != 0 || r->snode != client->node : r->dnode != client->node)
        return false;
    if (message[0] == NUMBER_UNKNOWN && r->length >= 2 && message[1] == d->request[0])
        return true;
    return message[0] == d->request[0] && is_for_motor(d, r, message);
}

static const struct rkm04_framing *other_framing(const struct client *client)
{
    return client->framing == &rkm04_hdlc ? &rkm04_plain : &rkm04_hdlc;
}

/* A whole message that is not the answer. */
static void count_unexpected(const struct dialogue *d)
{
    struct client *client = d->client;
    client->unexpected++;
    client->echoed += client->receiver.dnode == client->node && client->receiver.length == d->length &&
                      memcmp(client->answer, d->request, d->length) == 0;
}

/* The plain framing takes a silence for the end of a frame that was cut. Where this machine, or the one at the other end, was
 * busy, there was none on the line: then the byte ends the answer as it is without silences. Returns true if it does. */
static bool ends_unbroken(struct dialogue *d, uint8_t byte)
{
    struct client *client = d->client;
    struct rkm04_receiver *r = &client->unbroken;
    if (!client->framing->receive(r, byte, 0, client->unbroken_message, sizeof client->unbroken_message) ||
        !is_answer(d, r, client->unbroken_message))
        return false;
    memcpy(client->answer, client->unbroken_message, r->length);
    client->length = r->length;
    return true;
}

/* Take what came. Returns true when the answer is in the buffer. */
static bool process_bytes(struct dialogue *d, const uint8_t *bytes, size_t length)
{
    struct client *client = d->client;
    uint64_t now = client_now();
    client->received += (uint32_t)length;
    for (size_t i = 0; i < length; i++) {
        client->foreign += other_framing(client)->receive(&client->other, bytes[i], now, client->foreign_message,
                                                          sizeof client->foreign_message);
        bool whole = client->framing->receive(&client->receiver, bytes[i], now, client->answer, sizeof client->answer);
        if (whole && is_answer(d, &client->receiver, client->answer)) {
            client->length = client->receiver.length;
            return true;
        }
        if (whole)
            count_unexpected(d);
        if (ends_unbroken(d, bytes[i]))
            return true;
    }
    uint64_t limit = now + (uint64_t)client->timeout_ms * 1000u;
    d->deadline = limit < d->last_moment ? limit : d->last_moment;
    return false;
}

/* Print causes that the received bytes suggest. Returns whether there are any. */
static bool print_causes(const struct dialogue *d)
{
    const struct client *client = d->client;
    const struct rkm04_receiver *r = &client->receiver;
    uint32_t others = client->unexpected - client->echoed;
    if (client->foreign > 0)
        client_advise("  - %" PRIu32 " messages came in the framing %s: try --framing %s.\n", client->foreign,
                other_framing(client)->name, other_framing(client)->name);
    if (client->echoed > 0)
        client_advise("  - the request itself came back: the adapter echoes, or its two wires are connected.\n");
    if (others > 0)
        client_advise("  - %" PRIu32 " messages came that are not the answer: is another program or unit on this address?\n",
                others);
    if (r->bad_check > 0)
        client_advise("  - %" PRIu32 " frames came with a wrong check value: do two units have the address %u, or does another "
                "program send at the same time (a collision)? Or is the bus disturbed?\n", r->bad_check, client->node);
    if (r->malformed > 0 && client->foreign == 0)
        client_advise("  - %" PRIu32 " frames came that are cut or malformed: do two units have the address %u and answer at "
                "different times (a collision)? Does another program read from %s, too?\n", r->malformed, client->node,
                client->port);
    bool told = client->foreign > 0 || client->unexpected > 0 || r->bad_check > 0 || r->malformed > 0;
    if (!told && client->received > 0)
        client_advise("  - %" PRIu32 " bytes came, but no whole message: is the baud rate 19200, the framing right?\n",
                client->received);
    return told || client->received > 0;
}

static void print_advice(const struct dialogue *d)
{
    const struct client *client = d->client;
    client_report("no answer from unit %u within %u ms", client->node, client->timeout_ms);
    client_advise("Please check:\n");
    bool known = client_print_emulator_causes(client->port, client->framing, client->node);
    if (print_causes(d) || known)
        return;
    client_advise("  - nothing was received.\n"
            "  - does the unit have power, and is its bus (A, B) connected to %s?\n"
            "  - is its address %u (switch S1; rkm04 serve --node %u)? Select another one with -n.\n"
            "  - does it use the framing %s? The other one is --framing %s.\n"
            "  - is it slow? --timeout MS waits longer.\n",
            client->port, client->node, client->node, client->framing->name, other_framing(client)->name);
}

static enum client_outcome await_answer(struct dialogue *d)
{
    uint8_t bytes[512];
    while (wait_for(d, POLLIN)) {
        ssize_t n = read_bytes(d->client, bytes, sizeof bytes);
        if (n == 0) {
            errno = 0;
            return report_lost(d->client);
        }
        if (n < 0 && errno != EAGAIN && errno != EINTR)
            return report_lost(d->client);
        if (n > 0 && process_bytes(d, bytes, (size_t)n))
            return CLIENT_ANSWERED;
    }
    if (is_cancelled(d->client))
        return drop_request(d->client);
    print_advice(d);
    return CLIENT_SILENT;
}

enum client_outcome client_exchange(struct client *client, const uint8_t *request, size_t length)
{
    struct dialogue d = {.client = client, .request = request, .length = length, .frame = encode_frame(client, request, length)};
    client->received = 0;
    client->unexpected = client->echoed = client->foreign = 0;
    client->other = (struct rkm04_receiver){0};
    d.begun = client_now();
    d.deadline = d.begun + line_time(d.frame) + (uint64_t)client->timeout_ms * 1000u;
    d.last_moment = d.deadline + line_time(sizeof client->wire);
    if (!drop_input(client))
        return report_lost(client);
    enum client_outcome outcome = send_frame(&d);
    if (outcome != CLIENT_SENT)
        return outcome;
    if (client->node == 0) {
        wait_until_sent(&d);
        if (is_cancelled(client))
            return drop_request(client);
        return drop_input(client) ? CLIENT_SENT : report_lost(client);
    }
    return await_answer(&d);
}
