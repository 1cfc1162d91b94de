#include "command.h"

json_t *command_plant_get(struct sim *sim, const json_t *params, struct refusal *refusal) { (void)sim, (void)params; return refuse(refusal, REFUSED_STATE, "no plant"); }
json_t *command_plant_set(struct sim *sim, const json_t *params, struct refusal *refusal) { (void)sim, (void)params; return refuse(refusal, REFUSED_STATE, "no plant"); }
