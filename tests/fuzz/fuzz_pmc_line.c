/* SPDX-License-Identifier: MIT */
/* fuzz_pmc_line.c: any bytes on the line of text of a PMC; a byte from 80h on lets time go by and fetches the answer. The first
 * byte chooses the unit. Whatever comes, answers are lines, counters add up, and the unit stays within its ranges. */
#include <string.h>

#include "fuzz.h"
#include "pmc/pmc.h"

#define TICKS_A_STEP 4000u

static void check_axis(const struct pmc_unit *unit, unsigned number)
{
    struct pmc_axis_state state;
    pmc_axis_state(unit, number, &state);
    FUZZ_CHECK(state.commanded >= PMC_COUNTER_MIN && state.commanded <= PMC_COUNTER_MAX, "counter %d", (int)state.commanded);
    FUZZ_CHECK(state.fifth >= 1 && state.fifth <= PMC_SPEED_MAX, "speed %u", state.fifth);
    FUZZ_CHECK(state.speed <= 4000000u, "speed %u", (unsigned)state.speed);
}

static void check_answer(const uint8_t *answer, size_t length)
{
    FUZZ_CHECK(length <= PMC_ANSWER_MAX, "%zu bytes", length);
    FUZZ_CHECK(length == 0 || answer[length - 1] == '\r', "%zu bytes without CR", length);
    for (size_t i = 0; i + 2 < length; i++)
        FUZZ_CHECK(answer[i] >= ' ' && answer[i] <= 'Z', "byte %02X", answer[i]);
}

static void fetch(struct pmc_unit *unit, uint8_t code)
{
    uint8_t answer[2 * PMC_ANSWER_MAX];
    pmc_advance(unit, (uint64_t)(code & 0x7Fu) * TICKS_A_STEP);
    check_answer(answer, pmc_ascii_face.send(unit, answer, sizeof answer));
    for (unsigned axis = 0; axis < unit->config.axes; axis++)
        check_axis(unit, axis);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const struct pmc_port port;
    struct pmc_unit unit;
    struct pmc_config config = {.face = &pmc_ascii_face, .axes = 2};
    uint32_t ends = 0;
    if (size == 0)
        return 0;
    config.axes = data[0] & 1u ? 1 : 2;
    config.first_answer_late = data[0] & 2u ? 5 : 0;
    pmc_init(&unit, &config, &port, NULL);
    for (size_t i = 1; i < size; i++) {
        if (data[i] >= 0x80) {
            fetch(&unit, data[i]);
            continue;
        }
        while (pmc_ascii_face.receive(&unit, &data[i], 1) == 0)
            fetch(&unit, 0x8A);
        ends += data[i] == '\r';
    }
    while (unit.face.ascii.is_waiting)
        fetch(&unit, 0x8A);
    const struct pmc_counters *counters = &unit.face.reply.counters;
    FUZZ_CHECK(counters->requests + counters->dropped == ends, "%u lines", ends);
    return 0;
}
