/* SPDX-License-Identifier: MIT */
/* fuzz_cib_rtu.c: any bytes at any times to a CIB module on its bus. Answers are frames from its address; bytes that come at the
 * same times have the same answers however the time between them is cut. Input: pairs of a time (0-127 us, above 127: tenths of
 * the silence) and a byte; a byte behind FFH stands for a good check value of what came since the last one. */
#include <string.h>

#include "cib/cib.h"
#include "cib_faces/cib_faces.h"
#include "fuzz.h"

#define OUT_MAX 65536u

struct module {
    struct cib_unit unit;
    struct cib_rtu rtu;
    size_t length;
    uint8_t out[OUT_MAX];
};

static const struct cib_port nobody;
static struct module whole, cut;

static void power_up(struct module *module)
{
    memset(module, 0, sizeof *module);
    module->rtu.address = 1;
    module->rtu.silence = CIB_SILENCE;
    cib_begin(&module->unit, &cib_default_config, &nobody, NULL);
}

static void advance(struct module *module, uint64_t ticks)
{
    uint64_t end = cib_now(&module->unit) + ticks;
    while (cib_now(&module->unit) < end) {
        uint64_t due = cib_rtu_due(&module->rtu), now = cib_now(&module->unit), stop = due < end ? due : end;
        cib_advance(&module->unit, stop > now ? stop - now : 0);
        if (stop < end)
            cib_rtu_check_silence(&module->rtu, &module->unit);
    }
}

static void send(struct module *module, uint8_t byte)
{
    uint32_t answers = module->rtu.counters.answers;
    (void)cib_rtu_receive(&module->rtu, &module->unit, byte);
    size_t begin = module->length;
    while (module->length < OUT_MAX && cib_rtu_send(&module->rtu, &module->unit, &module->out[module->length])) {
        module->length++;
        if (module->rtu.counters.answers == answers)
            continue;
        answers = module->rtu.counters.answers;
        FUZZ_CHECK(modbus_is_frame(module->out + begin, module->length - begin), "%zu bytes", module->length - begin);
        FUZZ_CHECK(module->out[begin] == 1, "an answer from %u", module->out[begin]);
        begin = module->length;
    }
}

static void deliver(uint64_t ticks, uint8_t byte)
{
    advance(&whole, ticks);
    advance(&cut, ticks / 3);
    advance(&cut, ticks - ticks / 3);
    send(&whole, byte);
    send(&cut, byte);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct fuzz fuzz = {data, size};
    uint16_t check = MODBUS_CRC_START;
    power_up(&whole);
    power_up(&cut);
    while (fuzz.left > 0) {
        uint8_t time = fuzz_byte(&fuzz), byte = fuzz_byte(&fuzz);
        uint64_t ticks = time < 128 ? time : (time - 127u) * (CIB_SILENCE / 10u);
        if (time == 0xff) {
            uint16_t now = check;
            deliver(0, (uint8_t)now);
            deliver(0, (uint8_t)(now >> 8));
            check = MODBUS_CRC_START;
            continue;
        }
        check = modbus_crc_update(check, byte);
        deliver(ticks, byte);
    }
    const struct cib_rtu_counters *counters = &whole.rtu.counters;
    FUZZ_CHECK(counters->requests + counters->others + counters->dropped <= size, "more frames than bytes");
    FUZZ_CHECK(whole.length == cut.length && memcmp(whole.out, cut.out, whole.length) == 0, "time was cut");
    return 0;
}
