/* SPDX-License-Identifier: MIT */
/* replay.c: the calls that a firmware has made to the unit, made again here, and what the unit then asks for.
 *
 * Standard input, a line each: `i NODE` rkm04_init, `a TICKS` rkm04_advance, `r HEX` rkm04_receive, `d MASK` rkm04_set_inputs,
 * `s ROOM` rkm04_send. Standard output: `i` at each rkm04_init, `step MOTOR TICK 1`, `direction MOTOR TICK LEVEL`,
 * `outputs 0 TICK MASK`. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <rkm04/unit.h>

static struct rkm04_unit unit;
static uint8_t flash[RKM04_FLASH_BLOCKS][RKM04_FLASH_BLOCK_SIZE];

static void on_steps(void *context, unsigned motor, const uint64_t *tick, size_t count, int32_t position, bool forward)
{
    (void)context, (void)position, (void)forward;
    for (size_t i = 0; i < count; i++)
        printf("step %u %" PRIu64 " 1\n", motor, tick[i]);
}

static void on_direction(void *context, uint64_t tick, unsigned motor, bool forward)
{
    (void)context;
    printf("direction %u %" PRIu64 " %d\n", motor, tick, forward);
}

static void on_outputs(void *context, uint64_t tick, uint8_t mask)
{
    (void)context;
    printf("outputs 0 %" PRIu64 " %u\n", tick, mask);
}

static int on_read(void *context, unsigned block, unsigned offset, void *data, unsigned length)
{
    (void)context;
    memcpy(data, flash[block] + offset, length);
    return 0;
}

static int on_erase(void *context, unsigned block)
{
    (void)context;
    memset(flash[block], 0xff, sizeof flash[block]);
    return 0;
}

static int on_program(void *context, unsigned block, unsigned offset, const void *data, unsigned length)
{
    (void)context;
    memcpy(flash[block] + offset, data, length);
    return 0;
}

static const struct rkm04_port port = {
    .steps = on_steps, .direction = on_direction, .outputs = on_outputs,
    .flash_read = on_read, .flash_erase = on_erase, .flash_program = on_program,
};

static void receive(const char *hex)
{
    static uint8_t bytes[RKM04_MESSAGE_MAX];
    size_t count = 0;
    for (unsigned byte; count < sizeof bytes && sscanf(hex + 2 * count, "%2x", &byte) == 1;)
        bytes[count++] = (uint8_t)byte;
    (void)rkm04_receive(&unit, bytes, count);
}

int main(void)
{
    static char line[2 * RKM04_MESSAGE_MAX + 16];
    struct rkm04_config config = {.node = 1};
    uint8_t answer[1024];
    memset(flash, 0xff, sizeof flash);
    while (fgets(line, sizeof line, stdin) != NULL) {
        unsigned long long value = strtoull(line + 1, NULL, 10);
        switch (line[0]) {
        case 'i':
            printf("i\n");
            config.node = (uint8_t)value;
            rkm04_init(&unit, &config, &port, NULL);
            break;
        case 'a':
            rkm04_advance(&unit, value);
            break;
        case 'r':
            receive(line + 2);
            break;
        case 'd':
            rkm04_set_inputs(&unit, (uint8_t)value);
            break;
        case 's':
            (void)rkm04_send(&unit, answer, value < sizeof answer ? value : sizeof answer);
            break;
        default:
            fprintf(stderr, "replay: unknown line: %s", line);
            return 1;
        }
    }
    return 0;
}
