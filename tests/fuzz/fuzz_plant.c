/* SPDX-License-Identifier: MIT */
/* fuzz_plant.c: any text as a plant of one unit or three. Refused with a reason; or it is taken, and the units run with it,
 * report their state, and take the same text again or say why not. */
#include <string.h>

#include "command/command.h"
#include "device/rkm04_device.h"
#include "fuzz.h"

static struct sim sim;

static void run_programs(void)
{
    static const char *const programs[] = {"S300 (01 C100 F90 R W5 B40 R", "V9000 A60000 F300 R H", "G+", "X02 L9 F5 R D E"};
    for (unsigned number = 1; number <= sim_units(&sim); number++)
        for (unsigned i = 0; i < RKM04_MOTORS; i++)
            rkm04_set_command(rkm04_of(sim_core(&sim, number)), (char)('1' + i), programs[i], strlen(programs[i]), NULL);
    sim_advance(&sim, sim_now(&sim) + 400000);
}

static void check_state(void)
{
    struct refusal refusal;
    for (unsigned number = 1; number <= sim_units(&sim); number++) {
        json_t *params = json_pack("{s:s}", "unit", sim.unit[number - 1u].name);
        json_t *state = sim_command(&sim, "state", params, &refusal);
        FUZZ_CHECK(state != NULL, "state: %s", refusal.text);
        json_decref(state);
        json_decref(params);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct sim_config config = {
        .unit = rkm04_device_config(&(struct rkm04_config){.framing = &rkm04_hdlc}),
        .timed = true, .turnaround = SEGMENT_TURNAROUND, .seed = 1,
    };
    char *said = NULL;
    size_t length;
    FILE *errors = open_memstream(&said, &length);
    memset(&sim, 0, sizeof sim);
    const char *nodes = size > 0 && data[0] == 'u' ? "3,5,5" : "3";
    FUZZ_CHECK(node_list_read(&config.nodes, nodes) && sim_begin(&sim, &config), "no memory");
    bool ok = sim_configure_plants(&sim, "plant", (const char *)data, size, errors);
    fflush(errors);
    FUZZ_CHECK(ok == (length == 0), "%d: %s", ok, said);
    if (ok) {
        run_programs();
        check_state();
        ok = sim_configure_plants(&sim, "plant", (const char *)data, size, errors); /* unless a motor has left its end stops */
        fflush(errors);
        FUZZ_CHECK(ok == (length == 0), "%d: %s", ok, said);
        run_programs();
    }
    sim_end(&sim);
    fclose(errors);
    free(said);
    return 0;
}
