/* SPDX-License-Identifier: MIT */
/* test_output_file.c: which files are written, and which stay as they are. Real files in a folder of the test. */
#include <check.h>
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "file/output_file.h"
#include "trace/trace_writer.h"
#include "trace/wire_format.h"

static char folder[64];

static void setup(void)
{
    snprintf(folder, sizeof folder, "/tmp/rkm04-output-XXXXXX");
    ck_assert_ptr_nonnull(mkdtemp(folder));
    ck_assert_int_eq(chdir(folder), 0);
}

static void teardown(void)
{
    char command[96];
    ck_assert_int_eq(chdir("/"), 0);
    snprintf(command, sizeof command, "rm -rf '%s'", folder);
    ck_assert_int_eq(system(command), 0);
}

static void put(const char *path, const char *text)
{
    FILE *file = fopen(path, "w");
    ck_assert(file && fputs(text, file) >= 0 && fclose(file) == 0);
}

static void holds(const char *path, const char *text)
{
    char found[200] = "";
    FILE *file = fopen(path, "r");
    ck_assert_msg(file != NULL, "%s is gone", path);
    size_t length = fread(found, 1, sizeof found - 1u, file);
    found[length] = '\0';
    fclose(file);
    ck_assert_str_eq(found, text);
}

static void refused(const char *path, const struct output_kind *kind, unsigned flags, const char *expected)
{
    char *why;
    FILE *file = output_file_open(path, kind, flags, &why);
    ck_assert_msg(file == NULL, "%s was opened", path);
    ck_assert_msg(why != NULL && strstr(why, expected) != NULL, "%s: `%s' does not say `%s'", path, why, expected);
    free(why);
}

static FILE *opened(const char *path, const struct output_kind *kind, unsigned flags)
{
    char *why;
    FILE *file = output_file_open(path, kind, flags, &why);
    ck_assert_msg(file != NULL, "%s: %s", path, why);
    return file;
}

static void written(const char *path, const struct output_kind *kind, unsigned flags, const char *text)
{
    FILE *file = opened(path, kind, flags);
    ck_assert_int_ge(fputs(text, file), 0);
    ck_assert_int_eq(output_file_close(file), 0);
    holds(path, text);
}

/* ---- Kinds ---- */

static const struct {
    const struct output_kind *kind;
    const char *text;
} samples[] = {
    {&trace_csv.kind, "t_us,source,event,value\n0,m1,dir,1\n"},
    {&trace_vcd.kind, "$version rkm04 1.0 $end\n$timescale 1 us $end\n"},
    {&trace_vcd.kind, "$date today $end\n"},
    {&trace_jsonl.kind, "{\"t_us\":0,\"kind\":\"begin\",\"units\":[]}\n"},
    {&wire_log.kind, "# rkm04 wire log 1: hdlc, 19200 baud, unit 1\n"},
    {&wire_pcapng.kind, "\n\r\r\n...."},
    {&output_recording, "{\"rkm04_record\":1,\"program\":\"rkm04 1.0\"}\n"},
    {&output_junit, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites tests=\"1\">"},
    {&output_junit, "<testsuite name=\"of another program\">"},
    {&output_coverage, "protocol     covered      of       %\n"},
    {&output_coverage_json, "{\n  \"covered\": 5,"},
};
#define SAMPLES (sizeof samples / sizeof samples[0])

static const char *const others[] = {
    "S100 V1000 F5 R",           "name: Five steps\nsteps:\n", "\x7f" "ELF", "#!/bin/sh\n", "{\"name\": \"package\"}",
    "<?xml version=\"1.0\"?>\n<html>", "RK4P", "\n", " ", "a;b\n1;2\n", "t,source\n", "# notes\n", "\xff\xff\xff\xff",
};

START_TEST(a_kind_is_recognised_and_no_other)
{
    for (size_t i = 0; i < SAMPLES; i++)
        for (size_t k = 0; k < SAMPLES; k++)
            ck_assert_msg(output_kind_is(samples[k].kind, samples[i].text, strlen(samples[i].text)) ==
                              (samples[k].kind == samples[i].kind), "is `%s' %s?", samples[i].text, samples[k].kind->name);
}
END_TEST

START_TEST(other_files_are_of_no_kind)
{
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++)
        for (size_t k = 0; k < SAMPLES; k++)
            if (samples[k].kind != &wire_pcapng.kind || others[i][0] != '\n') /* a pcapng file, cut after its first byte */
                ck_assert_msg(!output_kind_is(samples[k].kind, others[i], strlen(others[i])), "is `%s' %s?", others[i],
                              samples[k].kind->name);
}
END_TEST

START_TEST(an_empty_file_and_one_that_was_cut_are_of_the_kind)
{
    for (size_t i = 0; i < SAMPLES; i++)
        for (size_t length = 0; length < 5; length++)
            ck_assert_msg(output_kind_is(samples[i].kind, samples[i].text, length), "%zu of `%s'", length, samples[i].text);
}
END_TEST

START_TEST(a_file_is_written_over_one_of_its_kind_alone)
{
    for (size_t i = 0; i < SAMPLES; i++) {
        put("file", samples[i].text);
        written("file", samples[i].kind, 0, "next");
        refused("file", samples[i].kind, 0, "it exists and is not ");
        refused("file", samples[i].kind, 0, samples[i].kind->name);
        refused("file", samples[i].kind, 0, "overwrite it with --force");
        refused("file", samples[i].kind, OUTPUT_REQUESTED, "overwrite it with `force': true");
        holds("file", "next");
        written("file", samples[i].kind, OUTPUT_FORCE, "forced");
    }
}
END_TEST

/* ---- Files in use ---- */

START_TEST(what_is_read_is_never_written_by_any_name)
{
    put("program", "");
    ck_assert_int_eq(link("program", "hard"), 0);
    ck_assert_int_eq(symlink("program", "soft"), 0);
    ck_assert(output_file_spare("program"));
    ck_assert(output_file_spare("nowhere"));
    ck_assert(output_file_spare("/dev/null"));
    refused("program", &trace_csv.kind, OUTPUT_FORCE, "it is read, too: choose another name");
    refused("./program", &trace_csv.kind, OUTPUT_FORCE, "it is the same file as program, which is read: choose another name");
    refused("hard", &trace_csv.kind, OUTPUT_FORCE, "it is the same file as program, which is read");
    refused("soft", &trace_csv.kind, OUTPUT_FORCE, "it is the same file as program, which is read");
    written("other", &trace_csv.kind, 0, "t_us");
    output_file_close(opened("/dev/null", &trace_csv.kind, 0));
}
END_TEST

START_TEST(a_file_that_has_the_number_of_one_that_is_gone_is_another)
{
    put("plant", "old");
    ck_assert(output_file_spare("plant"));
    ck_assert_int_eq(rename("plant", "trace"), 0); /* the same inode by another name, as after an editor has replaced the plant */
    put("plant", "new");
    written("trace", &trace_csv.kind, OUTPUT_FORCE, "t_us");
    ck_assert(output_file_spare("plant"));
    refused("plant", &trace_csv.kind, OUTPUT_FORCE, "it is read");
}
END_TEST

START_TEST(what_is_written_is_not_written_otherwise_until_it_is_closed)
{
    FILE *first = opened("a", &trace_csv.kind, 0);
    ck_assert_int_eq(symlink("a", "soft"), 0);
    refused("a", &trace_csv.kind, 0, "it is being written already");
    refused("./a", &trace_csv.kind, 0, "it is the same file as a, which is written");
    refused("soft", &trace_vcd.kind, OUTPUT_FORCE, "it is the same file as a, which is written");
    FILE *second = opened("b", &trace_csv.kind, 0);
    output_file_close(first);
    written("soft", &trace_csv.kind, 0, "t_us,");
    output_file_close(second);
}
END_TEST

START_TEST(a_claimed_file_is_written_by_its_owner_alone)
{
    char *why;
    put("image", "bytes");
    int fd = open("image", O_RDWR), again = open("./image", O_RDWR);
    ck_assert(output_file_claim(fd, "image", &why));
    ck_assert(!output_file_claim(again, "./image", &why));
    ck_assert_str_eq(why, "it is the same file as image, which is written: choose another name");
    free(why);
    refused("image", &trace_csv.kind, OUTPUT_FORCE, "it is being written already");
    holds("image", "bytes");
    output_file_release(fd);
    ck_assert(output_file_claim(again, "image", &why));
    output_file_release(again);
    close(fd);
    close(again);
}
END_TEST

START_TEST(pipes_and_folders_are_no_outputs_unless_one_may_wait)
{
    ck_assert_int_eq(mkfifo("pipe", 0600), 0);
    int reader = open("pipe", O_RDONLY | O_NONBLOCK);
    refused("pipe", &trace_csv.kind, OUTPUT_FORCE, "it is not a regular file");
    output_file_close(opened("pipe", &trace_csv.kind, OUTPUT_MAY_WAIT));
    close(reader);
    refused("pipe", &trace_csv.kind, 0, strerror(ENXIO)); /* no reader: no waiting */
    refused(".", &trace_csv.kind, OUTPUT_FORCE, strerror(EISDIR));
    refused("no/folder", &trace_csv.kind, OUTPUT_FORCE, strerror(ENOENT));
}
END_TEST

START_TEST(what_is_kept_stays_until_it_is_emptied)
{
    put("report", "protocol     covered");
    output_file_close(opened("report", &output_coverage, OUTPUT_KEEP));
    holds("report", "protocol     covered");
    FILE *file = opened("report", &output_coverage, OUTPUT_KEEP);
    ck_assert(output_file_empty(file));
    holds("report", "");
    output_file_close(file);
}
END_TEST

/* ---- Replacing ---- */

static bool write_text(void *context, FILE *out)
{
    errno = EIO;
    return context && fputs(context, out) >= 0;
}

static void replace_refused(const char *path, unsigned flags, const char *expected)
{
    char *why, text[] = "new";
    ck_assert_msg(!output_file_replace(path, &output_recording, flags, write_text, text, &why), "%s was replaced", path);
    ck_assert_msg(why != NULL && strstr(why, expected) != NULL, "%s: `%s' does not say `%s'", path, why, expected);
    free(why);
}

START_TEST(only_regular_files_are_replaced)
{
    char *why, text[] = "{\"rkm04_record\":1}", shorter[] = "{\"rkm04";
    struct stat status;
    put("target", "precious");
    ck_assert_int_eq(mkfifo("pipe", 0600), 0);
    ck_assert_int_eq(symlink("target", "soft"), 0);
    ck_assert_int_eq(symlink("/dev/full", "device"), 0);
    replace_refused("pipe", OUTPUT_FORCE, "it is not a regular file");
    replace_refused("soft", OUTPUT_FORCE, "it is not a regular file");
    replace_refused("device", OUTPUT_FORCE, "it is not a regular file");
    replace_refused(".", OUTPUT_FORCE, "it is not a regular file");
    replace_refused("/dev/null", OUTPUT_FORCE, "it is not a regular file");
    replace_refused("target", OUTPUT_REQUESTED, "it exists and is not a recording");
    ck_assert(lstat("pipe", &status) == 0 && S_ISFIFO(status.st_mode));
    holds("target", "precious");
    ck_assert(output_file_replace("target", &output_recording, OUTPUT_FORCE, write_text, text, &why));
    holds("target", text);
    ck_assert(output_file_spare("target"));
    ck_assert(output_file_replace("target", &output_recording, 0, write_text, shorter, &why)); /* what was restored */
    holds("target", shorter);
    FILE *file = opened("open", &output_recording, 0);
    replace_refused("./open", OUTPUT_FORCE, "it is the same file as open, which is written");
    output_file_close(file);
}
END_TEST

START_TEST(a_replacement_that_fails_changes_nothing)
{
    char *why;
    put("target", "{\"rkm04_record\":1}");
    put("target.new", "precious");
    ck_assert(!output_file_replace("target", &output_recording, 0, write_text, NULL, &why));
    ck_assert_str_eq(why, strerror(EIO));
    free(why);
    replace_refused("no/folder", 0, strerror(ENOENT));
    holds("target", "{\"rkm04_record\":1}");
    holds("target.new", "precious");
    ck_assert_int_eq(system("test \"$(ls -A | wc -l)\" = 2"), 0);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("output_file");
    TCase *cases = tcase_create("output_file");
    tcase_add_checked_fixture(cases, setup, teardown);
    tcase_add_test(cases, a_kind_is_recognised_and_no_other);
    tcase_add_test(cases, other_files_are_of_no_kind);
    tcase_add_test(cases, an_empty_file_and_one_that_was_cut_are_of_the_kind);
    tcase_add_test(cases, a_file_is_written_over_one_of_its_kind_alone);
    tcase_add_test(cases, what_is_read_is_never_written_by_any_name);
    tcase_add_test(cases, a_file_that_has_the_number_of_one_that_is_gone_is_another);
    tcase_add_test(cases, what_is_written_is_not_written_otherwise_until_it_is_closed);
    tcase_add_test(cases, a_claimed_file_is_written_by_its_owner_alone);
    tcase_add_test(cases, pipes_and_folders_are_no_outputs_unless_one_may_wait);
    tcase_add_test(cases, what_is_kept_stays_until_it_is_emptied);
    tcase_add_test(cases, only_regular_files_are_replaced);
    tcase_add_test(cases, a_replacement_that_fails_changes_nothing);
    suite_add_tcase(suite, cases);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_NORMAL);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? 1 : 0;
}
