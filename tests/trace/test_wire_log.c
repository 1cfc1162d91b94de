/* SPDX-License-Identifier: MIT */
/* test_wire_log.c: the files that record what passes on the wires. What tshark makes of the capture file is tested in
 * system/wire.sh. One case alone: CK_RUN_CASE=CASE ./test_wire_log */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "core/rig.h"
#include "trace/wire_file.h"
#include "wire/wire_rig.h"

#define sim (&wire_rig.sim)
#define HDLC &rkm04_hdlc
#define FILE_MAX 262144

static char folder[] = "/tmp/wire-XXXXXX";
static char path[64];
static char content[FILE_MAX + 1];
static size_t length; /* of the content */

static void make_folder(void)
{
    ck_assert_ptr_nonnull(mkdtemp(folder));
}

static void remove_folder(void)
{
    wire_rig_end();
    if (path[0] != '\0')
        unlink(path);
    ck_assert_int_eq(rmdir(folder), 0);
}

static struct wire_file *open_file(const char *name)
{
    char *error = NULL;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    struct wire_file *file = wire_file_begin(sim, path, 0, &error);
    ck_assert_msg(file != NULL, "%s", error ? error : "?");
    return file;
}

static void read_back(void)
{
    FILE *in = fopen(path, "rb");
    ck_assert_ptr_nonnull(in);
    length = fread(content, 1, FILE_MAX, in);
    content[length] = '\0';
    ck_assert_int_eq(ferror(in), 0);
    fclose(in);
}

/* One of everything. */
static void session(void)
{
    wire_rig_pass(1000);
    wire_rig_ask(3, "\4" "1", 2);
    wire_rig_ask(3, "\2" "1f5", 4);
    wire_rig_bytes("7E 03 00 01 12 34 7E");
    wire_rig_settle();
    sim_power(sim, 1, false);
    wire_rig_ask(3, "\1", 1);
    wire_rig_bytes("7E 03");
    wire_rig_settle();
}

START_TEST(the_name_chooses_the_format)
{
    ck_assert(wire_file_named("bus.log"));
    ck_assert(wire_file_named("/a/b.pcapng"));
    ck_assert(!wire_file_named("bus.pcap"));
    ck_assert(!wire_file_named("bus.log.gz"));
    ck_assert(!wire_file_named(".log"));
    ck_assert(!wire_file_named(""));
}
END_TEST

START_TEST(a_log_has_times_direction_message_reason_and_bytes)
{
    wire_rig_begin("3", HDLC);
    struct wire_file *file = open_file("bus.log");
    session();
    ck_assert_int_eq(wire_file_end(file), 0);
    read_back();
    ck_assert_str_eq(
        content,
        "# rkm04 wire log 1: hdlc, 19200 baud, unit 3\n"
        "#  begins us      ends us  direction       message | bytes\n"
        "        1000         5167  master > 3      4 Get Position m1 | 7E 03 00 04 31 79 9E 7E\n"
        "        5687        15584  3 > master      4 Get Position m1 -> 0 | "
        "7E 00 03 04 31 0A 20 20 20 20 20 20 20 20 20 30 64 F0 7E\n"
        "       15584        20793  master > 3      2 Set Command m1 \"f5\" | 7E 03 00 02 31 66 35 5D 49 7E\n"
        "       21313        26522  3 > master      2 Set Command m1 -> flag 2 'f'; refused: unknown command 'f' | "
        "7E 00 03 02 31 02 66 C7 3A 7E\n"
        "       26522        30168  master          dropped: wrong FCS | 7E 03 00 01 12 34 7E\n"
        "       30168        30168  -- unit 3: power off\n"
        "       30167        33814  master > 3      1 Version; ignored: no power at unit 3 | 7E 03 00 01 21 38 7E\n"
        "       33813        34856  master          unfinished | 7E 03\n");
}
END_TEST

START_TEST(K3_a_file_is_the_same_however_time_is_cut)
{
    static char once[FILE_MAX];
    static const char *const names[] = {"bus.log", "bus.pcapng"};
    for (unsigned format = 0; format < 2; format++) {
        for (unsigned cut = 0; cut < 2; cut++) {
            wire_rig_begin("3,5", HDLC);
            struct wire_file *file = open_file(names[format]);
            for (unsigned i = 0; i < 4; i++)
                wire_rig_send((uint8_t)(3 + i % 3), "\2" "0F10 R", 7);
            while (sim_now(sim) < 300 * MS)
                wire_rig_pass(cut == 0 ? 300 * MS : 37);
            ck_assert_int_eq(wire_file_end(file), 0);
            read_back();
            ck_assert_uint_gt(length, 500);
            if (cut == 0)
                memcpy(once, content, length + 1);
            else
                ck_assert_mem_eq(once, content, length);
        }
        unlink(path);
    }
    path[0] = '\0';
}
END_TEST

static uint32_t number_at(size_t at)
{
    const uint8_t *bytes = (const uint8_t *)content + at;
    ck_assert_uint_le(at + 4, length);
    return (uint32_t)bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
}

START_TEST(a_capture_consists_of_blocks_with_their_length_at_both_ends)
{
    unsigned blocks = 0;
    wire_rig_begin("3", HDLC);
    struct wire_file *file = open_file("bus.pcapng");
    session();
    ck_assert_int_eq(wire_file_end(file), 0);
    read_back();
    for (size_t at = 0; at < length; blocks++) {
        uint32_t size = number_at(at + 4);
        ck_assert_uint_eq(size % 4, 0);
        ck_assert_uint_ge(size, 12);
        ck_assert_uint_eq(number_at(at), blocks == 0 ? 0x0A0D0D0A : blocks == 1 ? 1 : 6);
        if (blocks == 1)
            ck_assert_uint_eq(number_at(at + 8) & 0xFFFF, 250);
        at += size;
        ck_assert_uint_eq(number_at(at - 4), size);
    }
    ck_assert_uint_eq(blocks, 2 + 8);
}
END_TEST

START_TEST(what_has_passed_is_in_the_file_at_once)
{
    wire_rig_begin("3", HDLC);
    struct wire_file *file = open_file("bus.log");
    wire_rig_ask(3, "\1", 1);
    read_back();
    ck_assert_ptr_nonnull(strstr(content, "3 > master      1 Version -> "));
    ck_assert_int_eq(wire_file_end(file), 0);
}
END_TEST

START_TEST(the_longest_messages_fit)
{
    static uint8_t text[RKM04_MESSAGE_MAX];
    static const char *const names[] = {"bus.log", "bus.pcapng"};
    memset(text, 0x7E, sizeof text);
    memcpy(text, "\2" "1{", 3);
    for (unsigned format = 0; format < 2; format++) {
        wire_rig_begin("3", HDLC);
        struct wire_file *file = open_file(names[format]);
        memset(text + 3, format == 0 ? 0x7E : 0x03, sizeof text - 3); /* most bytes on the wire; most characters in words */
        wire_rig_ask(3, text, sizeof text);
        ck_assert_int_eq(wire_file_end(file), 0);
        read_back();
        if (format == 0)
            ck_assert_ptr_nonnull(strstr(content, " 7D 5E 7D 5E"));
        ck_assert_uint_gt(length, 4 * sizeof text);
        ck_assert_ptr_nonnull(memmem(content, length, "unknown command '{'", 19));
        unlink(path);
    }
    path[0] = '\0';
}
END_TEST

START_TEST(a_file_that_cannot_be_opened_is_refused_with_its_name)
{
    char *error = NULL;
    wire_rig_begin("3", HDLC);
    ck_assert_ptr_null(wire_file_begin(sim, "/nowhere/bus.log", 0, &error));
    ck_assert_str_eq(error, "cannot write /nowhere/bus.log: No such file or directory");
    free(error);
}
END_TEST

START_TEST(a_full_disk_is_told_and_nothing_is_written_any_more)
{
    char *error = NULL;
    wire_rig_begin("3", HDLC);
    snprintf(path, sizeof path, "%s/full.log", folder);
    ck_assert_int_eq(symlink("/dev/full", path), 0);
    struct wire_file *file = wire_file_begin(sim, path, 0, &error);
    ck_assert_ptr_nonnull(file);
    wire_rig_ask(3, "\1", 1);
    ck_assert_int_eq(wire_file_failed(file), ENOSPC);
    ck_assert_int_eq(wire_file_end(file), ENOSPC);
}
END_TEST

static Suite *wire_log_suite(void)
{
    Suite *suite = suite_create("wire_log");
    TCase *files = tcase_create("files");
    tcase_add_checked_fixture(files, make_folder, remove_folder);
    tcase_add_test(files, the_name_chooses_the_format);
    tcase_add_test(files, a_log_has_times_direction_message_reason_and_bytes);
    tcase_add_test(files, K3_a_file_is_the_same_however_time_is_cut);
    tcase_add_test(files, a_capture_consists_of_blocks_with_their_length_at_both_ends);
    tcase_add_test(files, what_has_passed_is_in_the_file_at_once);
    tcase_add_test(files, the_longest_messages_fit);
    tcase_add_test(files, a_file_that_cannot_be_opened_is_refused_with_its_name);
    tcase_add_test(files, a_full_disk_is_told_and_nothing_is_written_any_more);
    suite_add_tcase(suite, files);
    return suite;
}

int main(void)
{
    return rig_run(wire_log_suite(), "test_wire_log");
}
