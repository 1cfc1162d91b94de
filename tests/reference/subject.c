/* SPDX-License-Identifier: MIT */
/* subject: runs stories of the differential test on the core and prints what happened.
 *
 * Standard input, a line each: `i TICK MASK` inputs, `m TICK HEX` a message, `q NUMBER...` a new unit with its thirteen
 * readings in the order of struct rkm04_readings, `e TICK` the end of the story. Standard output: `a HEX` the answer,
 * `n TICK MOTOR WHAT VALUE` a happening, `p COUNT COUNT COUNT COUNT` and so many ticks (64 bits, the machine's order) of pulses
 * of each motor, at the end. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <rkm04/unit.h>

#define LINE_MAX_LENGTH (2 * RKM04_MESSAGE_MAX + 64)
#define ANSWER_MAX 16384

struct pulses {
    uint64_t *tick;
    size_t count, room;
};

static struct rkm04_unit unit;
static struct pulses pulses[RKM04_MOTORS];

static void step(void *context, uint64_t tick, unsigned motor, int32_t position)
{
    struct pulses *p = &pulses[motor - 1];

    (void)context;
    (void)position;
    if (p->count == p->room) {
        p->room = p->room == 0 ? 65536 : 2 * p->room;
        p->tick = realloc(p->tick, p->room * sizeof *p->tick);
        if (p->tick == NULL)
            abort();
    }
    p->tick[p->count++] = tick;
}

static void outputs(void *context, uint64_t tick, uint8_t mask)
{
    (void)context;
    printf("n %" PRIu64 " 0 outputs %u\n", tick, mask);
}

static void event(void *context, uint64_t tick, unsigned motor, enum rkm04_event what, uint32_t value)
{
    static const char *const name[] = {
        [RKM04_EVENT_MOTION] = "motion", [RKM04_EVENT_COMMAND] = "command", [RKM04_EVENT_LED] = "led",
        [RKM04_EVENT_VARIABLE] = "variable", [RKM04_EVENT_FAULT] = "fault"
    };

    (void)context;
    if ((unsigned)what < sizeof name / sizeof *name && name[what] != NULL) /* the counter is asked for by message 4 */
        printf("n %" PRIu64 " %u %s %" PRIu32 "\n", tick, motor, name[what], value);
}

static struct rkm04_readings read_readings(const char *text)
{
    unsigned n[13] = {0};
    char *rest = NULL;

    for (size_t i = 0; i < sizeof n / sizeof *n; i++, text = rest)
        n[i] = (unsigned)strtoul(text, &rest, 10);
    return (struct rkm04_readings){
        (uint8_t)n[0], (uint8_t)n[1], (uint8_t)n[2], (uint8_t)n[3], (uint8_t)n[4], (uint8_t)n[5], (uint8_t)n[6],
        (uint8_t)n[7], (uint8_t)n[8], (uint8_t)n[9], (uint16_t)n[10], (uint16_t)n[11], (uint16_t)n[12],
    };
}

static void message(const char *hex)
{
    static uint8_t data[RKM04_MESSAGE_MAX], answer[ANSWER_MAX];
    size_t length = 0;

    for (unsigned byte; length < sizeof data && sscanf(hex + 2 * length, "%2x", &byte) == 1; )
        data[length++] = (uint8_t)byte;
    length = rkm04_exchange(&unit, data, length, answer, sizeof answer);
    fputs("a ", stdout);
    for (size_t i = 0; i < length; i++)
        printf("%02x", answer[i]);
    putchar('\n');
}

static void end(void)
{
    fputs("p", stdout);
    for (unsigned i = 0; i < RKM04_MOTORS; i++)
        printf(" %zu", pulses[i].count);
    putchar('\n');
    for (unsigned i = 0; i < RKM04_MOTORS; i++) {
        if (pulses[i].count > 0)
            fwrite(pulses[i].tick, sizeof *pulses[i].tick, pulses[i].count, stdout);
        pulses[i].count = 0;
    }
    fflush(stdout);
}

int main(void)
{
    static const struct rkm04_port port = { .step = step, .outputs = outputs, .event = event };
    static char line[LINE_MAX_LENGTH];
    struct rkm04_config config = { .node = 1 };

    while (fgets(line, sizeof line, stdin) != NULL) {
        char *rest;
        uint64_t number = strtoull(line + 1, &rest, 10);

        if (line[0] == 'q') {
            config.readings = read_readings(line + 1);
            rkm04_init(&unit, &config, &port, NULL);
            continue;
        }
        rkm04_advance(&unit, number - rkm04_now(&unit));
        if (line[0] == 'i')
            rkm04_set_inputs(&unit, (uint8_t)strtoul(rest, NULL, 10));
        else if (line[0] == 'm')
            message(rest + 1);
        else
            end();
    }
    for (unsigned i = 0; i < RKM04_MOTORS; i++)
        free(pulses[i].tick);
    return EXIT_SUCCESS;
}
