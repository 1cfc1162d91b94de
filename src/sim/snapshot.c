#include "snapshot.h"

#include "command.h"

struct snapshot *snapshot_take(struct sim *sim) { (void)sim; return NULL; }
bool snapshot_put(struct sim *sim, const struct snapshot *snapshot) { (void)sim, (void)snapshot; return false; }
bool snapshot_fits(const struct sim *sim, const struct snapshot *snapshot) { (void)sim, (void)snapshot; return false; }
void snapshot_free(struct snapshot *snapshot) { (void)snapshot; }
void snapshots_free(struct sim_snapshots *snapshots) { (void)snapshots; }
json_t *command_snapshot(struct sim *sim, const json_t *params, struct refusal *refusal) { (void)sim, (void)params; return refuse(refusal, REFUSED_STATE, "not yet"); }
json_t *command_restore(struct sim *sim, const json_t *params, struct refusal *refusal) { (void)sim, (void)params; return refuse(refusal, REFUSED_STATE, "not yet"); }
