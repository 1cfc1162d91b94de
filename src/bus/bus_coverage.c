/* SPDX-License-Identifier: MIT */
#include "bus_coverage.h"

void bus_coverage_message(struct coverage *coverage, const struct wire_message *message)
{
    if (message->dropped)
        return;
    if (message->answer)
        coverage_answer(coverage, message->message, message->length);
    else if (!message->ignored)
        coverage_request(coverage, message->dnode, message->message, message->length);
}
