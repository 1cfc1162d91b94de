/* SPDX-License-Identifier: MIT */
/* in_process.c: a unit and nothing around it, for the conformance kit (--port in:PROGRAM): the core called directly, without
 * emulator, line or clock. A request a line on standard input, its answer a line that begins with `=` on standard output, the
 * events of an advance in lines before it:
 *
 *     bytes HEX           they come in; = HEX, all that the unit has to send
 *     advance TICKS       = TICK
 *     idle MOTOR LIMIT    advance until the motor is idle or ended, LIMIT ticks at most; = TICK 1, or 0 if it is not
 *     inputs MASK         = TICK
 *     outputs             = MASK
 *     reset               power off and on, flash stays; = TICK, 0
 *
 *     event NAME MOTOR TICK VALUE
 *
 * Numbers are decimal, MOTOR is 0 where there is none. Argument: the framing, hdlc or plain. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <rkm04/unit.h>

#include "core/flash_fake.h"
#include "core/recorder.h"

static struct rkm04_unit unit;
static struct flash_fake flash;
static struct recorder record;
static struct rkm04_config config = {.node = 1};

static void power_up(void)
{
    recorder_clear(&record);
    record.flash = &flash;
    rkm04_init(&unit, &config, &recorder_flash_port, &record);
}

static int digit(char c)
{
    return c >= '0' && c <= '9' ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
}

/* The bytes come in one after the other; what the unit has to send goes out at once. */
static void bytes(const char *hex)
{
    printf("=");
    for (; digit(hex[0]) >= 0 && digit(hex[1]) >= 0; hex += 2) {
        uint8_t byte = (uint8_t)(digit(hex[0]) << 4 | digit(hex[1])), out[64];
        rkm04_receive(&unit, &byte, 1);
        for (size_t n; (n = rkm04_send(&unit, out, sizeof out)) > 0;) {
            for (size_t i = 0; i < n; i++)
                printf("%02x", out[i]);
        }
    }
    printf("\n");
}

static void tell_events(void)
{
    recorder_sort(&record);
    for (size_t i = 0; i < record.count; i++) {
        const struct record *now = &record.list[i];
        if (now->kind == RECORD_OUTPUTS)
            printf("event outputs 0 %" PRIu64 " %" PRId64 "\n", now->tick, now->value);
        if (now->kind == RECORD_EVENT && now->what == RKM04_EVENT_MOTION)
            printf("event motion %u %" PRIu64 " %" PRId64 "\n", now->motor, now->tick, now->value);
    }
    recorder_clear(&record);
}

static bool idle(unsigned motor)
{
    struct rkm04_motor_state state;
    return rkm04_motor_state(&unit, motor, &state) && (state.state == RKM04_IDLE || state.state == RKM04_ENDED);
}

/* From one happening to the next; between them no motor goes idle. */
static bool until_idle(unsigned motor, uint64_t limit)
{
    uint64_t end = rkm04_now(&unit) + limit;
    while (!idle(motor) && rkm04_now(&unit) < end) {
        uint64_t next = rkm04_next_event(&unit);
        rkm04_advance(&unit, (next < end ? next + 1 : end) - rkm04_now(&unit));
    }
    return idle(motor);
}

static bool obey(const char *line)
{
    unsigned motor, mask;
    uint64_t ticks;
    if (strncmp(line, "bytes ", 6) == 0) {
        bytes(line + 6);
    } else if (sscanf(line, "advance %" SCNu64, &ticks) == 1) {
        rkm04_advance(&unit, ticks);
        tell_events();
        printf("= %" PRIu64 "\n", rkm04_now(&unit));
    } else if (sscanf(line, "idle %u %" SCNu64, &motor, &ticks) == 2) {
        bool holds = until_idle(motor, ticks);
        tell_events();
        printf("= %" PRIu64 " %d\n", rkm04_now(&unit), holds);
    } else if (sscanf(line, "inputs %u", &mask) == 1) {
        rkm04_set_inputs(&unit, (uint8_t)mask);
        printf("= %" PRIu64 "\n", rkm04_now(&unit));
    } else if (strncmp(line, "outputs", 7) == 0) {
        printf("= %u\n", (unsigned)rkm04_outputs(&unit));
    } else if (strncmp(line, "reset", 5) == 0) {
        power_up();
        printf("= %" PRIu64 "\n", rkm04_now(&unit));
    } else {
        return false;
    }
    return true;
}

int main(int argc, char **argv)
{
    static char line[4 * RKM04_MESSAGE_MAX];
    config.framing = argc > 1 && strcmp(argv[1], "plain") == 0 ? &rkm04_plain : &rkm04_hdlc;
    flash_fake_init(&flash);
    power_up();
    while (fgets(line, sizeof line, stdin)) {
        if (!obey(line)) {
            fprintf(stderr, "in_process: not understood: %s", line);
            return EXIT_FAILURE;
        }
        fflush(stdout);
    }
    recorder_free(&record);
    return EXIT_SUCCESS;
}
