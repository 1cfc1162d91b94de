/* SPDX-License-Identifier: MIT */
#include "store_rig.h"

#include <string.h>

const struct rkm04_port store_port = {
    .flash_read = flash_fake_read,
    .flash_erase = flash_fake_erase,
    .flash_program = flash_fake_program,
};

struct flash_fake flash;
struct rkm04_program programs[CONTENTS];

static struct rkm04_command some_command(unsigned i)
{
    switch (i % 6) {
    case 0:
        return (struct rkm04_command){'F', 1 + i * 21841u % 16000000u};
    case 1:
        return (struct rkm04_command){'@', 1 + i % 80};
    case 2:
        return (struct rkm04_command){'=', 0u - i * 2000001u % 2000000000u};
    case 3:
        return (struct rkm04_command){'I', (1 + i % 8) | (i / 6 & 1) << 8 | (1 + i % 80) << 16};
    case 4:
        return (struct rkm04_command){'G', i & 8 ? RKM04_G_BACK : 2000000000u - i};
    default:
        return (struct rkm04_command){'R', 0};
    }
}

void fill(struct rkm04_program *program, unsigned first, unsigned count)
{
    program_clear(program);
    for (unsigned i = 0; i < count; i++)
        program_append(program, some_command(first + i));
}

static void set_up(void)
{
    flash_fake_init(&flash);
    fill(&programs[NOTHING], 0, 0);
    fill(&programs[EMPTY], 0, 0);
    fill(&programs[ONE], 0, 1);
    fill(&programs[SHORT], 100, 37);
    fill(&programs[FULL], 200, 700);
    fill(&programs[WRAPPED], 1000, 700 + 123);
}

static void tear_down(void)
{
    ck_assert_msg(flash.misuse == 0, "the store broke a rule of the flash %u times", flash.misuse);
}

bool same(const struct rkm04_program *a, const struct rkm04_program *b)
{
    if (program_count(a) != program_count(b))
        return false;
    for (unsigned i = 0; i < program_count(a); i++) {
        struct rkm04_command x = program_at(a, program_oldest(a) + i), y = program_at(b, program_oldest(b) + i);
        if (x.op != y.op || x.argument != y.argument)
            return false;
    }
    return true;
}

int save(unsigned motor, const struct rkm04_program *program)
{
    return store_save(&store_port, &flash, motor, program);
}

enum rkm04_slot load(unsigned motor, struct rkm04_program *program)
{
    memset(program, 0x55, sizeof *program);
    return store_load(&store_port, &flash, motor, program);
}

void assert_slot(unsigned motor, const struct rkm04_program *expected)
{
    struct rkm04_program found;
    enum rkm04_slot slot = load(motor, &found);
    ck_assert_msg(same(&found, expected), "motor %u: %u commands in place of %u", motor, program_count(&found),
                  program_count(expected));
    ck_assert_int_eq(slot, program_count(expected) > 0 ? RKM04_SLOT_LOADED : RKM04_SLOT_EMPTY);
}

void assert_untrusted(unsigned motor)
{
    struct rkm04_program found;
    ck_assert_int_eq(load(motor, &found), RKM04_SLOT_UNTRUSTED);
    ck_assert_uint_eq(program_count(&found), 0);
}

TCase *add_store_case(Suite *suite, const char *name, double seconds)
{
    TCase *tcase = tcase_create(name);
    tcase_add_checked_fixture(tcase, set_up, tear_down);
    tcase_set_timeout(tcase, seconds);
    suite_add_tcase(suite, tcase);
    return tcase;
}
