#include "command.h"

json_t *command_fault_inject(struct sim *sim, const json_t *params, struct refusal *refusal) { (void)sim, (void)params; return refuse(refusal, REFUSED_STATE, "no faults"); }
json_t *command_fault_clear(struct sim *sim, const json_t *params, struct refusal *refusal) { (void)sim, (void)params; return refuse(refusal, REFUSED_STATE, "no faults"); }
json_t *command_fault_list(struct sim *sim, const json_t *params, struct refusal *refusal) { (void)sim, (void)params; return refuse(refusal, REFUSED_STATE, "no faults"); }
