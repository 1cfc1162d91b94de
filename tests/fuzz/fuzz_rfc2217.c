/* SPDX-License-Identifier: MIT */
/* fuzz_rfc2217.c: any bytes of a client over telnet (RFC 2217). Replies fit their buffer and have no lone IAC, settings stay
 * within what they may be, and what is escaped for the other side is received as the same data, whatever came before. */
#include "line/rfc2217.h"

#include "fuzz.h"

#define IAC 255u
#define DATA_MAX 512

static void check_port(const struct rfc2217 *port)
{
    FUZZ_CHECK(port->reply_length <= RFC2217_REPLY_MAX, "%zu bytes", port->reply_length);
    FUZZ_CHECK(port->reply_length == 0 || port->reply[0] == IAC, "a reply that begins with %02x", port->reply[0]);
    FUZZ_CHECK(port->data_bits >= 5 && port->data_bits <= 8 && port->stop_bits >= 1 && port->stop_bits <= 3 && port->parity,
               "%u bits, parity %d, %u stop bits", port->data_bits, port->parity, port->stop_bits);
    FUZZ_CHECK(port->command_length <= RFC2217_COMMAND_MAX, "%zu", port->command_length);
}

static void check_escape(const uint8_t *data, size_t length)
{
    static uint8_t escaped[2 * DATA_MAX];
    struct rfc2217 port;
    size_t n = rfc2217_escape(data, length, escaped), came = 0;
    rfc2217_begin(&port);
    FUZZ_CHECK(n <= 2 * length, "%zu of %zu", n, length);
    for (size_t i = 0; i < n; i++) {
        if (rfc2217_receive(&port, escaped[i]) != RFC2217_DATA)
            continue;
        FUZZ_CHECK(came < length && port.data == data[came], "byte %zu", came);
        came++;
    }
    FUZZ_CHECK(came == length, "%zu of %zu came", came, length);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct rfc2217 port;
    rfc2217_begin(&port);
    check_port(&port);
    for (size_t i = 0; i < size; i++) {
        enum rfc2217_event event = rfc2217_receive(&port, data[i]);
        FUZZ_CHECK(event <= RFC2217_FLOW, "event %d", event);
        check_port(&port);
    }
    check_escape(data, size < DATA_MAX ? size : DATA_MAX);
    return 0;
}
