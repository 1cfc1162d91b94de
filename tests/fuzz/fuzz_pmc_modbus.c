/* SPDX-License-Identifier: MIT */
/* fuzz_pmc_modbus.c: frames to a PMC: a byte with the length and flags, then the bytes of the frame. What comes back is a frame
 * from the unit that fits its request; parameters and program registers stay legal, whatever is written. */
#include <string.h>

#include "fuzz.h"
#include "modbus/modbus.h"
#include "pmc/pmc.h"

#define ADDRESS 1u
#define SILENCE 40000u /* ticks: more than 3.5 characters */

static void check_unit(const struct pmc_unit *unit)
{
    for (unsigned axis = 0; axis < unit->config.axes; axis++) {
        const struct pmc_axis *state = &unit->axis[axis];
        for (unsigned which = 0; which < PMC_PARAMETERS; which++) {
            const struct pmc_parameter_row *row = &pmc_parameter_rows[which];
            FUZZ_CHECK(state->parameters.value[which] >= row->low && state->parameters.value[which] <= row->high, "%s", row->key);
        }
        for (unsigned reg = 0; reg < PMC_REGISTERS; reg++)
            FUZZ_CHECK(pmc_command_valid(&state->program[reg]), "register %u", reg);
        FUZZ_CHECK(unit->start[axis] < PMC_REGISTERS, "start %u", unit->start[axis]);
        FUZZ_CHECK(state->speed >= 1 && state->speed <= PMC_SPEED_MAX, "speed %u", state->speed);
    }
}

static void check_answer(struct pmc_unit *unit, const uint8_t *request, size_t length, bool is_asked)
{
    uint8_t answer[PMC_FRAME_MAX + 1];
    size_t found = pmc_modbus_face.send(unit, answer, sizeof answer);
    FUZZ_CHECK((found > 0) == is_asked, "%zu bytes of answer to %zu", found, length);
    if (found == 0)
        return;
    FUZZ_CHECK(modbus_is_frame(answer, found), "%zu bytes are no frame", found);
    FUZZ_CHECK(answer[0] == ADDRESS && (answer[1] | 0x80u) == (request[1] | 0x80u), "function %02X", answer[1]);
    if (request[1] < 0x80u)
        FUZZ_CHECK(modbus_answer_length(answer, found) == found, "length %zu", found);
}

/* Send a frame; with `is_sealed` its check value is made right. */
static void send(struct pmc_unit *unit, const uint8_t *data, size_t length, bool is_sealed)
{
    uint8_t frame[PMC_FRAME_MAX + 2];
    memcpy(frame, data, length);
    if (is_sealed)
        length = modbus_append_crc(frame, length);
    if (length > 0)
        FUZZ_CHECK(pmc_modbus_face.receive(unit, frame, length) == length, "%zu bytes", length);
    pmc_advance(unit, SILENCE);
    check_answer(unit, frame, length, modbus_is_frame(frame, length) && frame[0] == ADDRESS);
    check_unit(unit);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const struct pmc_port port;
    struct pmc_unit unit;
    struct pmc_config config = {.face = &pmc_modbus_face, .address = ADDRESS, .axes = 2};
    if (size == 0)
        return 0;
    config.axes = data[0] & 1u ? 1 : 2;
    pmc_init(&unit, &config, &port, NULL);
    for (size_t at = 1; at < size;) {
        size_t length = data[at] & 0x7Fu, rest = size - at - 1u;
        bool is_sealed = data[at] < 0x80u;
        at++;
        length = length < rest ? length : rest;
        if (length > 0)
            send(&unit, data + at, length, is_sealed);
        else
            pmc_advance(&unit, 100u * SILENCE);
        at += length;
    }
    return 0;
}
