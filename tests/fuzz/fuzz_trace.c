/* SPDX-License-Identifier: MIT */
/* fuzz_trace.c: any text as a trace for plot. It is refused with one message that names a line, or the curves are in order of
 * time and can be drawn in every format. First byte: which unit is meant. */
#include <string.h>

#include "fuzz.h"
#include "plot/plot.h"

static void check_curves(const struct plot_curves *curves)
{
    FUZZ_CHECK(curves->motors <= PLOT_MOTORS, "%u motors", curves->motors);
    for (unsigned i = 0; i < curves->motors; i++) {
        const struct plot_motor *motor = &curves->motor[i];
        for (size_t at = 1; at < motor->points; at++)
            FUZZ_CHECK(motor->point[at].us >= motor->point[at - 1].us, "motor %u: %f behind %f", i + 1, motor->point[at].us,
                       motor->point[at - 1].us);
        for (size_t at = 0; at < motor->motions; at++)
            FUZZ_CHECK(motor->motion[at].from <= motor->motion[at].to, "motor %u: motion %zu", i + 1, at);
    }
}

static void draw(const struct plot_curves *curves)
{
    static FILE *nowhere;
    const struct plot_view view = {"trace", 400, 0, curves->end > 1 ? curves->end : 1};
    if (nowhere == NULL)
        nowhere = fopen("/dev/null", "w");
    plot_draw_svg(nowhere, curves, &view);
    plot_draw_html(nowhere, curves, &view);
    plot_draw_csv(nowhere, curves, &view);
    FUZZ_CHECK(nowhere != NULL && !ferror(nowhere), "not written");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static struct plot_curves curves;
    struct fuzz fuzz = {data, size};
    const char *unit = fuzz_byte(&fuzz) & 1 ? "3" : NULL;
    char *said = NULL;
    size_t length;
    FILE *in = fmemopen((void *)fuzz.at, fuzz.left, "r"), *errors = open_memstream(&said, &length);
    if (in == NULL) /* nothing to read */
        in = fopen("/dev/null", "r");
    FUZZ_CHECK(in != NULL && errors != NULL, "memory");
    memset(&curves, 0, sizeof curves);
    const bool ok = plot_read_trace(&curves, "trace", in, unit, errors);
    fclose(in);
    fclose(errors);
    FUZZ_CHECK(ok == (length == 0), "%d: %s", ok, said);
    FUZZ_CHECK(ok || (strncmp(said, "trace:", 6) == 0 && strchr(said, '\n') == said + length - 1), "%s", said);
    free(said);
    if (ok) {
        check_curves(&curves);
        draw(&curves);
    }
    plot_free(&curves);
    return 0;
}
