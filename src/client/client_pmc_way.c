/* SPDX-License-Identifier: MIT */
#include "client_pmc_way.h"

#include <errno.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "client_port.h"
#include "client_report.h"

/* Wait until `end` for an event. */
static bool wait_for(const struct pmc_link *link, short events, uint64_t end)
{
    struct pollfd file = {.fd = link->fd, .events = events};
    uint64_t now = client_now();
    return poll(&file, 1, now < end ? (int)((end - now + 999u) / 1000u) : 0) > 0; /* what has come meanwhile counts */
}

enum exit_status client_pmc_send(struct pmc_link *link, const uint8_t *bytes, size_t length)
{
    uint64_t end = client_now() + link->timeout_ms * UINT64_C(1000);
    uint8_t old[256];
    while (client_now() < link->free_at)
        poll(NULL, 0, 1);
    while (read(link->fd, old, sizeof old) > 0)
        ; /* what came before */
    for (size_t sent = 0; sent < length;) {
        ssize_t n = write(link->fd, bytes + sent, length - sent);
        if (n > 0) {
            sent += (size_t)n;
        } else if (n < 0 && errno != EAGAIN && errno != EINTR) {
            client_report("%s: %s", link->port, strerror(errno));
            return STATUS_FAILURE;
        } else if (!wait_for(link, POLLOUT, end)) {
            client_report("%s accepts no bytes", link->port);
            return STATUS_NO_ANSWER;
        }
    }
    return STATUS_SUCCESS;
}

size_t client_pmc_receive(struct pmc_link *link, uint8_t *bytes, size_t room,
                          bool (*is_whole)(const uint8_t *bytes, size_t length))
{
    uint64_t end = client_now() + link->timeout_ms * UINT64_C(1000);
    size_t length = 0;
    while (length < room && !is_whole(bytes, length)) {
        if (!wait_for(link, POLLIN, end)) {
            client_report("no answer from %s within %u ms (%zu bytes came)", link->port, link->timeout_ms, length);
            client_advise("  - is the face right (--face ascii or modbus), the address (--node), the speed (--baud)?\n");
            return 0;
        }
        ssize_t n = read(link->fd, bytes + length, room - length);
        if (n > 0) {
            length += (size_t)n;
        } else if (n == 0 || (errno != EAGAIN && errno != EINTR)) {
            client_report("%s: the connection was closed at its other end", link->port);
            return 0;
        }
    }
    return length;
}

void client_pmc_print_error(void *context, const struct pmc_text_error *error)
{
    const char *name = context;
    fprintf(stderr, "%s:%u:%u: %s: %s\n", name, error->line, error->column, error->is_warning ? "warning" : "error", error->text);
}
