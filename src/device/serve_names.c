/* SPDX-License-Identifier: MIT */
#include "serve_names.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "text/text.h"

#define PORT_MAX 65535ul

/* Read an address and step over it. Returns 0 if there is none. */
static unsigned read_node(const char **text, unsigned addresses)
{
    unsigned node = 0;
    for (; **text >= '0' && **text <= '9' && node <= addresses; ++*text)
        node = node * 10 + (unsigned)(**text - '0');
    return node <= addresses ? node : 0;
}

bool node_list_read_up_to(struct node_list *list, const char *text, unsigned addresses)
{
    list->count = 0;
    for (;; text++) {
        unsigned first = read_node(&text, addresses), last = first;
        if (*text == '-') {
            text++;
            last = read_node(&text, addresses);
        }
        if (first == 0 || last < first || last - first >= NODE_LIST_MAX - list->count)
            return false;
        while (first <= last)
            list->node[list->count++] = (uint8_t)first++;
        if (!*text)
            return true;
        if (*text != ',')
            return false;
    }
}

bool node_list_read(struct node_list *list, const char *text)
{
    return node_list_read_up_to(list, text, RKM04_NODE_MAX);
}

void node_list_name(const struct node_list *list, unsigned at, char name[NODE_NAME_SIZE])
{
    unsigned same = 1;
    for (unsigned i = 0; i < at; i++)
        same += list->node[i] == list->node[at];
    if (same == 1)
        snprintf(name, NODE_NAME_SIZE, "%u", list->node[at]);
    else
        snprintf(name, NODE_NAME_SIZE, "%u-%u", list->node[at], same);
}

bool name_pattern_has(const char *pattern, char what)
{
    for (; *pattern; pattern++) {
        if (*pattern != '%')
            continue;
        if (*++pattern == what)
            return true;
        if (!*pattern)
            break;
    }
    return false;
}

bool name_pattern_valid(const char *pattern)
{
    for (; *pattern; pattern++)
        if (*pattern == '%' && (!*++pattern || !strchr("nl%", *pattern)))
            return false;
    return true;
}

bool name_expand(const char *pattern, const char *unit, unsigned line, char path[PATH_MAX])
{
    size_t length = 0;
    for (; *pattern; pattern++) {
        char number[12], one[2] = {*pattern, '\0'};
        const char *part = one;
        if (*pattern == '%' && *++pattern == 'n' && unit)
            part = unit;
        else if (*pattern == 'l' && one[0] == '%') {
            snprintf(number, sizeof number, "%u", line);
            part = number;
        }
        if (strlen(part) >= PATH_MAX - length)
            return false;
        memcpy(path + length, part, strlen(part));
        length += strlen(part);
    }
    path[length] = '\0';
    return true;
}

bool name_address(const char *address, unsigned line, char *out, size_t size)
{
    const char *colon = strrchr(address, ':');
    const char *port = colon ? colon + 1 : address;
    uint64_t number;
    if (!number_read(port, 0, PORT_MAX, &number) || (number != 0 && (number += line) > PORT_MAX))
        return false;
    int length = snprintf(out, size, "%.*s%" PRIu64, (int)(port - address), address, number);
    return length >= 0 && (size_t)length < size;
}
