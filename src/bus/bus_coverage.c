/* SPDX-License-Identifier: MIT */
#include "bus_coverage.h"

void bus_coverage_message(struct coverage *coverage, const struct device_kind *device, const struct wire_message *message)
{
    if (message->dropped)
        return;
    if (message->answer)
        device->coverage->answer(coverage, message->message, message->length);
    else if (!message->ignored)
        device->coverage->request(coverage, message->dnode, message->message, message->length);
}
