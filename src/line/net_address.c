/* SPDX-License-Identifier: MIT */
#include "net_address.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <stdio.h>
#include <string.h>

#include "options/options.h"
#include "text/text.h"

#define DEFAULT_HOST "127.0.0.1"
#define HOST_SIZE 256

struct parts {
    char host[HOST_SIZE];
    const char *port; /* digits */
    bool ipv6;
};

static bool read_parts(struct parts *parts, const char *text)
{
    const char *colon = strrchr(text, ':'), *host = text;
    size_t length = colon ? (size_t)(colon - text) : 0;
    uint64_t number;
    parts->port = colon ? colon + 1 : text;
    parts->ipv6 = length > 2 && host[0] == '[' && host[length - 1] == ']';
    if (parts->ipv6) {
        host++;
        length -= 2;
    }
    bool strange = !parts->ipv6 && (memchr(host, ':', length) || memchr(host, '[', length));
    if (length >= HOST_SIZE || strange || !number_read(parts->port, 0, UINT16_MAX, &number))
        return false;
    snprintf(parts->host, sizeof parts->host, "%.*s", length > 0 ? (int)length : HOST_SIZE, length > 0 ? host : DEFAULT_HOST);
    return true;
}

bool net_address_valid(const char *address)
{
    struct parts parts;
    return read_parts(&parts, address);
}

static const char *find(const char *text, unsigned limit_ms, struct sockaddr_storage *address)
{
    struct parts parts;
    struct addrinfo *found = NULL;
    if (!read_parts(&parts, text))
        return "expected " NET_ADDRESS_EXPECTED;
    const char *wrong = host_address_find(parts.host, parts.port, parts.ipv6 ? AF_INET6 : AF_INET, limit_ms, &found);
    if (wrong)
        return wrong;
    memset(address, 0, sizeof *address);
    memcpy(address, found->ai_addr, found->ai_addrlen);
    freeaddrinfo(found);
    return NULL;
}

const char *net_address_find(const char *address, unsigned limit_ms, char found[NET_NAME_SIZE])
{
    struct sockaddr_storage storage;
    const char *wrong = find(address, limit_ms, &storage);
    if (!wrong)
        net_address_write(found, &storage);
    return wrong;
}

const char *net_address_read(const char *digits, struct sockaddr_storage *address)
{
    return find(digits, 0, address);
}

void net_address_write(char digits[NET_NAME_SIZE], const struct sockaddr_storage *address)
{
    char host[INET6_ADDRSTRLEN] = "?", scope[16] = "";
    if (address->ss_family == AF_INET6) {
        const struct sockaddr_in6 *six = (const void *)address;
        inet_ntop(AF_INET6, &six->sin6_addr, host, sizeof host);
        if (six->sin6_scope_id != 0)
            snprintf(scope, sizeof scope, "%%%u", (unsigned)six->sin6_scope_id);
        snprintf(digits, NET_NAME_SIZE, "[%s%s]:%u", host, scope, (unsigned)ntohs(six->sin6_port));
    } else {
        const struct sockaddr_in *four = (const void *)address;
        inet_ntop(AF_INET, &four->sin_addr, host, sizeof host);
        snprintf(digits, NET_NAME_SIZE, "%s:%u", host, (unsigned)ntohs(four->sin_port));
    }
}
