#include "fault.h"

#include "sim.h"

void faults_begin(struct faults *faults, uint64_t seed) { *faults = (struct faults){.random = seed}; }
const struct fault *fault_acts(struct sim *sim, enum fault_kind kind, unsigned unit, enum fault_direction direction) { (void)sim, (void)kind, (void)unit, (void)direction; return NULL; }
const struct fault *fault_lasts(const struct sim *sim, enum fault_kind kind, unsigned unit) { (void)sim, (void)kind, (void)unit; return NULL; }
uint8_t faults_hold_inputs(const struct sim *sim, unsigned unit, uint8_t levels) { (void)sim, (void)unit; return levels; }
void faults_look(struct sim *sim) { (void)sim; }
uint64_t faults_next(const struct sim *sim) { (void)sim; return RKM04_NEVER; }
void faults_shift(struct faults *faults, uint64_t shift) { (void)faults, (void)shift; }
