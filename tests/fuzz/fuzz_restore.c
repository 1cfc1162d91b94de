/* SPDX-License-Identifier: MIT */
/* fuzz_restore.c: any bytes as the file that `restore` reads: refused with a reason, and nothing but what flash shows is
 * changed; or the line is as it was, and continues. The file is one in memory. */
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "command/command.h"
#include "device/rkm04_device.h"
#include "fuzz.h"
#include "record/snapshot.h"

#define LOOKS_MAX 300 /* tenths of a second of its replay, at most, in which something happens */

static struct sim sim;

static bool is_enough(void *context)
{
    unsigned *looks = context;
    return ++*looks > LOOKS_MAX;
}

static json_t *command(const char *method, json_t *params, struct refusal *refusal)
{
    json_t *result = sim_command(&sim, method, params, refusal);
    json_decref(params);
    return result;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct sim_config config = {
        .unit = rkm04_device_config(&(struct rkm04_config){.framing = &rkm04_hdlc}),
        .timed = true, .turnaround = SEGMENT_TURNAROUND, .seed = 1,
    };
    struct refusal refusal = {0};
    char path[40];
    int file = memfd_create("snapshot", 0);
    FUZZ_CHECK(file >= 0 && write(file, data, size) == (ssize_t)size, "no memory");
    snprintf(path, sizeof path, "/proc/self/fd/%d", file);
    memset(&sim, 0, sizeof sim);
    FUZZ_CHECK(node_list_read(&config.nodes, "1") && sim_begin(&sim, &config) && snapshots_attach(&sim), "no memory");
    FUZZ_CHECK(snapshots_keep_journal(&sim), "no memory");
    rkm04_set_command(rkm04_of(sim_core(&sim, 1)), '1', "L5 F20 R W3 E", 13, NULL);
    sim_advance(&sim, 30000);
    unsigned looks = 0;
    sim.interrupted = is_enough;
    sim.interrupted_context = &looks;
    json_t *result = command("restore", json_pack("{s:s}", "file", path), &refusal);
    FUZZ_CHECK(result || refusal.text[0], "no reason");
    json_decref(result);
    sim_advance(&sim, sim_now(&sim) + 300000);
    result = command("state", NULL, &refusal);
    FUZZ_CHECK(result, "state: %s", refusal.text);
    json_decref(result);
    sim_end(&sim);
    close(file);
    return 0;
}
