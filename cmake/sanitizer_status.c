/* SPDX-License-Identifier: MIT */
/* In each program of a build with sanitizers: what they find ends it with a status that no program has of itself. With their own
 * status, 1, a test that expects a failure would pass. Options in the environment still count. */
__attribute__((visibility("default"))) const char *__asan_default_options(void);
__attribute__((visibility("default"))) const char *__ubsan_default_options(void);

const char *__asan_default_options(void)
{
    return "exitcode=99";
}

const char *__ubsan_default_options(void)
{
    return "exitcode=99:print_stacktrace=1";
}
