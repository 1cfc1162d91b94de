/* SPDX-License-Identifier: MIT */
#include <embedded/page_js.h>

#include "draw.h"
#include "picture.h"

static void draw_corners(FILE *out, const struct plot_curves *curves)
{
    const char *comma = "";
    fputs("<script type=\"application/json\" id=\"corners\">{", out);
    for (unsigned i = 0; i < curves->motors; i++) {
        const struct plot_motor *motor = &curves->motor[i];
        if (!motor->is_used || motor->points == 0)
            continue;
        fprintf(out, "%s\"%u\":[", comma, i + 1);
        for (size_t k = 0; k < motor->points; k++)
            fprintf(out, "%s[%.3f,%.6g,%.10g]", k > 0 ? "," : "", motor->point[k].us, motor->point[k].speed,
                    motor->point[k].position);
        fputs("]", out);
        comma = ",";
    }
    fputs("}</script>\n", out);
}

void plot_draw_html(FILE *out, const struct plot_curves *curves, const struct plot_view *view)
{
    fputs("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>", out);
    plot_text(out, view->title);
    fputs("</title>\n<meta name=\"viewport\" content=\"width=device-width\">\n<style>\n"
          ":root{color-scheme:light dark}body{margin:8px;font:13px 'DejaVu Sans',Verdana,sans-serif}"
          "svg.plot{max-width:100%;height:auto;touch-action:none;cursor:crosshair}"
          "#readout{min-height:1.4em;white-space:pre-wrap;font-variant-numeric:tabular-nums}\n</style>\n</head>\n<body>\n", out);
    fputs("<p>Wheel or + and -: zoom in time. Drag or arrow keys: move. Double click or 0: all.</p>\n"
          "<div id=\"readout\" role=\"status\" aria-live=\"off\"></div>\n", out);
    plot_draw_svg(out, curves, view);
    draw_corners(out, curves);
    fputs("<script>\n", out);
    fwrite(page_js, 1, sizeof page_js, out);
    fputs("</script>\n</body>\n</html>\n", out);
}
