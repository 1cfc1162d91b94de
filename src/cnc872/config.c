/* SPDX-License-Identifier: MIT */
/* The configuration: licences, groups, conversions. config_xml.c reads it. */
#include "config.h"

#include <string.h>

int cnc_find_license(const char *text, size_t length)
{
    static const char feature[] = "FeaturePlc";
    const size_t size = sizeof feature - 1;
    if (cnc_same_name("HwKeyConnected", text, length))
        return CNC_LICENSE_HW_KEY;
    if (length == size + 1 && cnc_same_name(feature, text, size) && text[size] >= '0' && text[size] <= '9')
        return CNC_LICENSE_FEATURE_PLC0 + (text[size] - '0');
    return -1;
}

unsigned cnc_fixed_group(unsigned m)
{
    static const uint8_t groups[][2] = {{0, 1}, {1, 1}, {2, 1}, {30, 1}, {3, 2}, {4, 2}, {5, 2}, {19, 2},
                                        {41, 3}, {42, 3}, {43, 3}, {44, 3}, {40, 3}, {7, 5}, {8, 5}, {9, 5}, {17, 5},
                                        {50, 6}, {51, 6}, {52, 6}, {53, 6}, {10, 7}, {11, 7}, {48, 8}, {49, 8}, {6, 9}, {60, 9}};
    for (size_t i = 0; i < sizeof groups / sizeof groups[0]; i++)
        if (groups[i][0] == m)
            return groups[i][1];
    return 0;
}

int64_t cnc_speed_of(int64_t feed)
{
    return feed * 16384 / 15000;
}

int64_t cnc_acceleration_of(int64_t acceleration)
{
    int64_t a = (acceleration * 2 * 65536 + 1000000) / 2000000;
    return a >= 1 ? a : 1;
}
