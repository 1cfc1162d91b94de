/* SPDX-License-Identifier: MIT */
#include "program.h"

void program_clear(struct rkm04_program *program)
{
    program->written = 0;
    program->closed = 0;
    for (unsigned i = 0; i < RKM04_LABELS; i++)
        program->label[i] = 0;
}

uint64_t program_oldest(const struct rkm04_program *program)
{
    return program->written > RKM04_PROGRAM_MAX ? program->written - RKM04_PROGRAM_MAX : 0;
}

unsigned program_count(const struct rkm04_program *program)
{
    return (unsigned)(program->written - program_oldest(program));
}

static unsigned slot_of(uint64_t number)
{
    return (unsigned)(number % RKM04_PROGRAM_MAX);
}

unsigned program_place(uint64_t number)
{
    return slot_of(number) + 1;
}

struct rkm04_command program_at(const struct rkm04_program *program, uint64_t number)
{
    unsigned slot = slot_of(number);
    return (struct rkm04_command){program->op[slot], program->argument[slot]};
}

void program_append(struct rkm04_program *program, struct rkm04_command command)
{
    unsigned slot = slot_of(program->written);
    if (program->written >= RKM04_PROGRAM_MAX && program->op[slot] == '@') {
        uint16_t *lost = &program->label[program->argument[slot] - 1];
        if (*lost == slot + 1)
            *lost = 0;
    }
    program->op[slot] = command.op;
    program->argument[slot] = command.argument;
    program->written++;
    if (command.op == '@')
        program->label[command.argument - 1] = (uint16_t)(slot + 1);
    else if (command.op == ']')
        program->closed = program->written;
}

bool program_label(const struct rkm04_program *program, unsigned label, uint64_t *number)
{
    unsigned place = program->label[label - 1];
    if (place == 0)
        return false;
    /* The one number that has this place and is still in memory. */
    uint64_t last = program->written - 1;
    unsigned back = (slot_of(last) + RKM04_PROGRAM_MAX - (place - 1)) % RKM04_PROGRAM_MAX;
    *number = last - back;
    return true;
}

bool program_closed_after(const struct rkm04_program *program, uint64_t number)
{
    return program->closed > number + 1;
}
