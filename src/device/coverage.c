/* SPDX-License-Identifier: MIT */
#include "coverage.h"

#include <stdarg.h>

struct coverage_item *coverage_add(struct coverage *coverage, enum coverage_group group, uint32_t key, const char *name, ...)
{
    if (coverage->items == COVERAGE_ITEMS_MAX)
        return &coverage->item[COVERAGE_ITEMS_MAX - 1]; /* the kind's table has outgrown the list: a test fails */
    struct coverage_item *item = &coverage->item[coverage->items++];
    va_list arguments;
    *item = (struct coverage_item){.group = (uint8_t)group, .key = key};
    va_start(arguments, name);
    vsnprintf(item->name, sizeof item->name, name, arguments);
    va_end(arguments);
    return item;
}

void coverage_count(struct coverage *coverage, enum coverage_group group, uint32_t key)
{
    for (size_t i = 0; i < coverage->items; i++)
        if (coverage->item[i].group == group && coverage->item[i].key == key)
            coverage->item[i].count++;
}

struct coverage_sum coverage_sum(const struct coverage *coverage, enum coverage_group group)
{
    struct coverage_sum sum = {0, 0};
    for (size_t i = 0; i < coverage->items; i++) {
        if (group != COVERAGE_GROUPS && coverage->item[i].group != group)
            continue;
        sum.total++;
        sum.covered += coverage->item[i].count > 0;
    }
    return sum;
}
