#include "plant.h"

#include <stdlib.h>

#include "sim.h"

bool plant_configure(struct sim *sim, const char *name, const char *text, size_t length, FILE *errors)
{
    (void)sim, (void)text, (void)length;
    fprintf(errors, "%s:1:1: error: expected no plant\n", name);
    return false;
}
void plant_free(struct plant *plant) { free(plant); }
uint8_t plant_mask(const struct plant *plant) { (void)plant; return 0; }
uint8_t plant_levels(const struct plant *plant) { (void)plant; return 0; }
void plant_step(struct plant *plant, uint64_t tick, unsigned motor, bool forward) { (void)plant, (void)tick, (void)motor, (void)forward; }
bool plant_take_change(struct plant *plant, uint64_t tick, struct plant_change *change) { (void)plant, (void)tick, (void)change; return false; }
uint64_t plant_next(const struct plant *plant) { (void)plant; return RKM04_NEVER; }
bool plant_position(const struct plant *plant, unsigned motor, int64_t *position) { (void)plant, (void)motor, (void)position; return false; }
json_t *plant_json(const struct plant *plant) { (void)plant; return json_null(); }
struct plant *plant_copy(const struct plant *plant, uint64_t shift) { (void)plant, (void)shift; return NULL; }
