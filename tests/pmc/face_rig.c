/* SPDX-License-Identifier: MIT */
#include "face_rig.h"

#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "modbus/modbus.h"

static void on_steps(void *context, unsigned axis, const uint64_t *tick, size_t count, int32_t position, bool forward)
{
    struct face_rig *rig = context;
    (void)tick;
    (void)position;
    (void)forward;
    rig->pulses[axis] += (uint32_t)count;
}

static int on_read(void *context, unsigned block, unsigned offset, void *data, unsigned length)
{
    struct face_rig *rig = context;
    memcpy(data, rig->flash[block] + offset, length);
    return 0;
}

static int on_erase(void *context, unsigned block)
{
    struct face_rig *rig = context;
    memset(rig->flash[block], 0xFF, PMC_FLASH_BLOCK_SIZE);
    return rig->stores ? 0 : -1;
}

static int on_program(void *context, unsigned block, unsigned offset, const void *data, unsigned length)
{
    struct face_rig *rig = context;
    memcpy(rig->flash[block] + offset, data, length);
    return rig->stores ? 0 : -1;
}

void face_begin(struct face_rig *rig, const struct pmc_config *config)
{
    static const struct pmc_port port = {
        .steps = on_steps, .flash_read = on_read, .flash_erase = on_erase, .flash_program = on_program};
    memset(rig, 0, sizeof *rig);
    memset(rig->flash, 0xFF, sizeof rig->flash);
    rig->stores = true;
    pmc_init(&rig->unit, config, &port, rig);
}

void face_wait(struct face_rig *rig, unsigned ms)
{
    for (; ms > 0; ms--)
        pmc_advance(&rig->unit, FACE_MS);
}

const char *face_line(struct face_rig *rig, const char *line)
{
    const struct pmc_face *face = rig->unit.config.face;
    size_t length = strlen(line);
    ck_assert_uint_eq(face->receive(&rig->unit, (const uint8_t *)line, length), length);
    ck_assert_uint_eq(face->receive(&rig->unit, (const uint8_t *)"\r", 1), 1);
    length = face->send(&rig->unit, (uint8_t *)rig->answer, sizeof rig->answer - 1);
    rig->answer[length] = '\0';
    return rig->answer;
}

static size_t read_hex(const char *hex, uint8_t *bytes)
{
    size_t length = 0;
    char *end;
    for (unsigned long byte = strtoul(hex, &end, 16); end != hex; byte = strtoul(hex = end, &end, 16))
        bytes[length++] = (uint8_t)byte;
    return length;
}

static void fetch(struct face_rig *rig, unsigned us, size_t without)
{
    uint8_t bytes[PMC_FRAME_MAX];
    pmc_advance(&rig->unit, (uint64_t)us * FACE_US);
    size_t length = rig->unit.config.face->send(&rig->unit, bytes, sizeof bytes);
    rig->answer[0] = '\0';
    for (size_t i = 0; i + without < length; i++)
        sprintf(rig->answer + (i > 0 ? 3 * i - 1 : 0), i > 0 ? " %02X" : "%02X", bytes[i]);
}

const char *face_frame(struct face_rig *rig, const char *hex, unsigned us)
{
    uint8_t bytes[PMC_FRAME_MAX + 64];
    size_t length = read_hex(hex, bytes);
    ck_assert_uint_eq(rig->unit.config.face->receive(&rig->unit, bytes, length), length);
    fetch(rig, us, 0);
    return rig->answer;
}

const char *face_ask(struct face_rig *rig, const char *hex)
{
    uint8_t bytes[PMC_FRAME_MAX + 64];
    size_t length = modbus_append_crc(bytes, read_hex(hex, bytes));
    ck_assert_uint_eq(rig->unit.config.face->receive(&rig->unit, bytes, length), length);
    fetch(rig, 5000, 2);
    return rig->answer;
}

int32_t face_position(const struct face_rig *rig, unsigned axis)
{
    struct pmc_axis_state state;
    pmc_axis_state(&rig->unit, axis, &state);
    return state.commanded;
}
