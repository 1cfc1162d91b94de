/* SPDX-License-Identifier: MIT */
/* test_flash_file.c: the flash image of the emulator when its process is killed, the machine loses its power, or the disk is
 * full (U5, P6). RKM04_TEST_LONG=1 makes more of it. One case alone: CK_RUN_CASE=CASE ./test_flash_file */
#include <check.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/store_rig.h"
#include "disk_shim.h"
#include "file/output_file.h"
#include "line/log.h"

/* So many cuts at the least, if no case was chosen. */
#define CUTS_SHORT 2000ul
#define CUTS_LONG 100000ul

static char folder[64], path[80];
static struct flash_file file;
static struct rkm04_unit unit;
static unsigned complaints;
static unsigned long *cuts;

void log_error(const char *format, ...)
{
    (void)format;
    complaints++;
}

/* ---- A unit on an image ---- */

static int port_read(void *context, unsigned block, unsigned offset, void *data, unsigned length)
{
    return flash_file_read(context, block, offset, data, length);
}

static int port_erase(void *context, unsigned block)
{
    return flash_file_erase(context, block);
}

static int port_program(void *context, unsigned block, unsigned offset, const void *data, unsigned length)
{
    return flash_file_program(context, block, offset, data, length);
}

static bool open_image(void)
{
    return flash_file_open(&file, path, NULL, RKM04_FLASH_BLOCKS, RKM04_FLASH_BLOCK_SIZE);
}

static void get_image(uint8_t image[FLASH_FILE_SIZE])
{
    FILE *from = fopen(path, "rb");
    ck_assert(from && fread(image, 1, FLASH_FILE_SIZE, from) == FLASH_FILE_SIZE && fgetc(from) == EOF);
    fclose(from);
}

static void put_file(const uint8_t *bytes, size_t length)
{
    FILE *to = fopen(path, "wb");
    ck_assert(to && fwrite(bytes, 1, length, to) == length && fclose(to) == 0);
}

/* Power-up on the image as it is. */
static void start_process(void)
{
    static const struct rkm04_config config = {.node = 1};
    static const struct rkm04_port port = {.flash_read = port_read, .flash_erase = port_erase, .flash_program = port_program};
    disk_next_process();
    ck_assert(open_image());
    rkm04_init(&unit, &config, &port, &file);
}

/* The same on a disk that is well, with all that was written. */
static void power_up(void)
{
    static uint8_t image[FLASH_FILE_SIZE];
    get_image(image);
    disk_well(image);
    start_process();
}

/* The process ends, in whatever way. */
static void end(void)
{
    if (file.fd >= 0) {
        output_file_release(file.fd);
        close(file.fd);
    }
    file.fd = -1;
}

static int store_flash(char motor)
{
    uint8_t request[2] = {3, (uint8_t)motor}, answer[3] = {0};
    ck_assert_uint_eq(rkm04_exchange(&unit, request, 2, answer, 3), 3);
    return answer[2];
}

static void set_up(void)
{
    const char *where = getenv("TMPDIR");
    snprintf(folder, sizeof folder, "%.40s/rkm04.XXXXXX", where && strlen(where) <= 40 ? where : "/tmp");
    ck_assert_ptr_nonnull(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/flash", folder);
    file.fd = -1;
    complaints = 0;
}

static void tear_down(void)
{
    end();
    unlink(path);
    rmdir(folder);
}

/* ---- Sequences ---- */

static const struct sequence {
    const char *name;
    unsigned old, new; /* commands */
    unsigned times;    /* the old programs were stored so often */
    char motor;        /* of Store Flash */
} sequences[] = {
    {"the first store", 0, 37, 0, '2'},
    {"the second store", 20, 37, 1, '3'},
    {"the third store", 37, 1, 2, '1'},
    {"an emptied slot", 37, 0, 1, '4'},
    {"all motors", 20, 37, 1, '0'},
    {"all motors, third store", 37, 20, 2, '0'},
    {"a full memory", 700, 823, 1, '2'},
};
#define SEQUENCES (sizeof sequences / sizeof sequences[0])

static const struct sequence *sequence;
static struct rkm04_program old[RKM04_MOTORS], new[RKM04_MOTORS];
static uint8_t start[FLASH_FILE_SIZE];

static bool asked_for(unsigned i)
{
    return sequence->motor == '0' || (unsigned)(sequence->motor - '1') == i;
}

/* An image with the old programs. */
static void prepare(const struct sequence *wanted)
{
    sequence = wanted;
    memset(start, 0xff, sizeof start);
    put_file(start, sizeof start);
    power_up();
    for (unsigned i = 0; i < RKM04_MOTORS; i++) {
        fill(&old[i], 1000 * i, sequence->times > 0 ? sequence->old : 0);
        fill(&new[i], 1000 * i + 10000, sequence->new);
        unit.motor[i].program = old[i];
    }
    for (unsigned i = 0; i < sequence->times; i++)
        ck_assert_int_eq(store_flash('0'), 0);
    end();
    get_image(start);
}

/* Store the new programs; the n-th call will go wrong. Returns err. */
static int store_new(unsigned n, enum disk_fault fault, unsigned done)
{
    for (unsigned i = 0; i < RKM04_MOTORS; i++)
        if (asked_for(i))
            unit.motor[i].program = new[i];
    disk_arm(n, fault, done);
    return store_flash(sequence->motor);
}

/* The same on the prepared image, after a restart. */
static int store_with(unsigned n, enum disk_fault fault, unsigned done)
{
    put_file(start, sizeof start);
    power_up();
    return store_new(n, fault, done);
}

/* Writes and syncs of the stores. */
static unsigned calls(void)
{
    ck_assert_int_eq(store_with(0, DISK_WELL, 0), 0);
    unsigned calls = disk_calls();
    end();
    ck_assert_uint_ge(calls, 4);
    return calls;
}

static bool holds(unsigned i, const struct rkm04_program *program)
{
    return same(&unit.motor[i].program, program) && (unit.motor[i].slot == RKM04_SLOT_LOADED) == (program_count(program) > 0);
}

/* Power-up on what is left. */
static void assert_old_or_new(int err, const char *what, unsigned n, unsigned detail)
{
    power_up();
    for (unsigned i = 0; i < RKM04_MOTORS; i++) {
        bool is_old = holds(i, &old[i]), is_new = asked_for(i) && holds(i, &new[i]);
        ck_assert_msg(is_old || is_new, "%s, %s in call %u, %u: motor %u has neither the old nor the new program", sequence->name,
                      what, n, detail, i + 1);
        ck_assert_msg(!asked_for(i) || is_new || err != 0, "%s, %s in call %u, %u: motor %u has the old program after err 0",
                      sequence->name, what, n, detail, i + 1);
    }
    end();
    (*cuts)++;
}

static bool thorough(void)
{
    return getenv("RKM04_TEST_LONG") != NULL;
}

/* ---- Ends ---- */

START_TEST(P6_a_process_that_is_killed_in_any_write_leaves_the_old_or_the_new_program)
{
    prepare(&sequences[_i]);
    unsigned n, last = calls();
    for (n = 1; n <= last; n++) {
        unsigned done = 0, length;
        do {
            int err = store_with(n, DISK_KILL, done);
            ck_assert(disk_off());
            length = disk_length();
            end();
            assert_old_or_new(err, "killed", n, done);
            done += thorough() && length < 100 ? 1 : thorough() ? 37 : 1 + length / 3;
        } while (done <= length && length > 0);
    }
}
END_TEST

START_TEST(P6_a_machine_that_loses_its_power_at_any_call_has_the_old_or_the_new_program)
{
    static uint8_t image[FLASH_FILE_SIZE];
    prepare(&sequences[_i]);
    unsigned last = calls();
    for (unsigned n = 1; n <= last; n++) {
        for (uint32_t seed = 0; seed < (thorough() ? 400 : 6); seed++) {
            int err = store_with(n, DISK_POWER, 48 * (seed % 3));
            end();
            disk_survives(image, seed);
            put_file(image, sizeof image);
            assert_old_or_new(err, "without power", n, seed);
        }
    }
}
END_TEST

/* A killed process leaves writes that are not on the disk, and the next one begins with them. */
START_TEST(P6_a_machine_that_loses_its_power_after_a_process_was_killed_has_the_old_or_the_new_program)
{
    static uint8_t image[FLASH_FILE_SIZE];
    prepare(&sequences[_i]);
    unsigned last = calls();
    for (unsigned n = 1; n <= last; n++) {
        for (unsigned m = 1; m <= last; m++) {
            for (uint32_t seed = 0; seed < (thorough() ? 60 : 4); seed++) {
                store_with(n, DISK_KILL, 16);
                end();
                start_process();
                int err = store_new(m, DISK_POWER, 4096);
                end();
                disk_survives(image, seed);
                put_file(image, sizeof image);
                assert_old_or_new(err, "killed, and later without power", 100 * n + m, seed);
            }
        }
    }
}
END_TEST

START_TEST(P6_what_was_answered_with_err_0_is_on_the_disk)
{
    static uint8_t image[FLASH_FILE_SIZE];
    prepare(&sequences[_i]);
    for (uint32_t seed = 0; seed < 10; seed++) {
        ck_assert_int_eq(store_with(0, DISK_WELL, 0), 0);
        end();
        disk_survives(image, seed);
        put_file(image, sizeof image);
        assert_old_or_new(0, "stored", 0, seed);
    }
}
END_TEST

/* The disk is full from a call on; then there is room again. */
static void fill_disk(enum disk_fault fault, unsigned n, unsigned done)
{
    static uint8_t image[FLASH_FILE_SIZE];
    int err = store_with(n, fault, done);
    ck_assert_msg(err != 0 || fault == DISK_FULL, "%s: the disk was full at call %u, and nobody was told", sequence->name, n);
    ck_assert_msg(err == 0 || complaints > 0, "%s: err %d, and no word about it", sequence->name, err);
    get_image(image);
    disk_well(image);
    ck_assert_msg(store_flash(sequence->motor) == 0, "%s: with room on the disk again the store failed", sequence->name);
    end();
    assert_old_or_new(0, "full, and later not", n, done);
    err = store_with(n, fault, done);
    end();
    assert_old_or_new(err, "full", n, done);
}

START_TEST(P6_on_a_full_disk_a_store_is_refused_and_the_old_program_stays)
{
    prepare(&sequences[_i]);
    unsigned last = calls();
    for (unsigned n = 1; n <= last; n++) {
        fill_disk(DISK_FULL, n, 0);
        fill_disk(DISK_FULL, n, 8);
        fill_disk(DISK_FULL_LATE, n, 0);
    }
}
END_TEST

/* ---- New images ---- */

static uint8_t erased[FLASH_FILE_SIZE];

static void make_erased(void)
{
    memset(erased, 0xff, sizeof erased);
    disk_well(erased);
}

static void assert_erased(void)
{
    static uint8_t image[FLASH_FILE_SIZE];
    get_image(image);
    ck_assert(memcmp(image, erased, sizeof image) == 0);
}

START_TEST(U5_an_image_whose_making_was_cut_is_made_anew)
{
    make_erased();
    for (unsigned length = 0; length < FLASH_FILE_SIZE; length += length < 20 ? 1 : length < 32700 ? 509 : 1) {
        put_file(erased, length);
        ck_assert_msg(open_image(), "%u bytes of an erased image were refused", length);
        end();
        assert_erased();
    }
    ck_assert_uint_eq(complaints, 0);
}
END_TEST

START_TEST(a_short_file_with_something_in_it_is_refused_and_stays_as_it_is)
{
    static const uint8_t text[] = {0xff, 0xff, 0xff, 'a'};
    disk_arm(0, DISK_WELL, 0);
    put_file(text, sizeof text);
    ck_assert(!open_image());
    ck_assert_uint_eq(complaints, 1);
    ck_assert_uint_eq(disk_calls(), 0);
}
END_TEST

START_TEST(U5_an_image_can_be_made_after_the_disk_was_too_full_for_it)
{
    static const unsigned room[] = {0, 1, 4096, 32767};
    make_erased();
    for (size_t i = 0; i < sizeof room / sizeof room[0]; i++) {
        for (unsigned n = 1; n <= 2; n++) {
            disk_well(erased);
            disk_arm(n, n == 1 ? DISK_FULL : DISK_FULL_LATE, room[i]);
            ck_assert(!open_image());
            ck_assert_uint_gt(complaints, 0);
            struct stat found;
            ck_assert(stat(path, &found) != 0 && errno == ENOENT); /* nothing is left behind */
            disk_well(erased);
            ck_assert(open_image());
            end();
            assert_erased();
            unlink(path);
        }
    }
}
END_TEST

START_TEST(U5_a_new_image_is_on_the_disk_with_its_name_before_it_is_used)
{
    static uint8_t image[FLASH_FILE_SIZE];
    make_erased();
    unsigned before = disk_folders_synced();
    ck_assert(open_image());
    ck_assert_uint_eq(disk_folders_synced(), before + 1);
    end();
    assert_erased();
    disk_survives(image, 1);
    ck_assert(memcmp(image, erased, sizeof image) == 0);
    ck_assert(open_image());
    ck_assert_uint_eq(disk_folders_synced(), before + 1);
}
END_TEST

static TCase *add_case(Suite *suite, const char *name)
{
    TCase *tcase = tcase_create(name);
    tcase_add_checked_fixture(tcase, set_up, tear_down);
    tcase_set_timeout(tcase, thorough() ? 7200 : 100);
    suite_add_tcase(suite, tcase);
    return tcase;
}

static Suite *flash_file_suite(void)
{
    Suite *suite = suite_create("flash_file");
    int count = (int)SEQUENCES;
    tcase_add_loop_test(add_case(suite, "killed"), P6_a_process_that_is_killed_in_any_write_leaves_the_old_or_the_new_program, 0,
                        count);
    TCase *power = add_case(suite, "power");
    tcase_add_loop_test(power, P6_a_machine_that_loses_its_power_at_any_call_has_the_old_or_the_new_program, 0, count);
    tcase_add_loop_test(power, P6_a_machine_that_loses_its_power_after_a_process_was_killed_has_the_old_or_the_new_program, 0,
                        thorough() ? count : 4);
    tcase_add_loop_test(power, P6_what_was_answered_with_err_0_is_on_the_disk, 0, count);
    tcase_add_loop_test(add_case(suite, "full"), P6_on_a_full_disk_a_store_is_refused_and_the_old_program_stays, 0, count);
    TCase *image = add_case(suite, "image");
    tcase_add_test(image, U5_an_image_whose_making_was_cut_is_made_anew);
    tcase_add_test(image, a_short_file_with_something_in_it_is_refused_and_stays_as_it_is);
    tcase_add_test(image, U5_an_image_can_be_made_after_the_disk_was_too_full_for_it);
    tcase_add_test(image, U5_a_new_image_is_on_the_disk_with_its_name_before_it_is_used);
    return suite;
}

int main(void)
{
    cuts = mmap(NULL, sizeof *cuts, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (cuts == MAP_FAILED)
        return EXIT_FAILURE;
    SRunner *runner = srunner_create(flash_file_suite());
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    printf("ends of the process, the power or the disk: %lu\n", *cuts);
    if (failed > 0)
        printf("One case alone: CK_RUN_CASE=killed|power|full|image ./test_flash_file\n");
    if (!getenv("CK_RUN_CASE") && *cuts < (thorough() ? CUTS_LONG : CUTS_SHORT)) {
        printf("fewer than promised\n");
        failed = 1;
    }
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
