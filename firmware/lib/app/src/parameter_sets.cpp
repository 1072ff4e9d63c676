// See parameter_sets.h.
#include "parameter_sets.h"

namespace app {

bool ParameterSets::begin(Controllers& controllers) {
  params::Table table;
  source_ = store_.load(table);
  bool runs = true;
  for (uint8_t i = 0; i < hal::joint_count && runs; ++i) runs = fit(table, i);
  if (!runs) {
    params::load_defaults(table);
    source_ = wire::ParamSource::defaults;
  }
  sets_.begin(table);
  for (uint8_t i = 0; i < hal::joint_count; ++i) controllers.take(table, i);
  return runs;
}

bool ParameterSets::fit(const params::Table& table, uint8_t joint) {
  unfit_ = {joint, Controllers::check(table, joint)};
  return unfit_.refusal == fuzzy_pdi::Refusal::none;
}

// Steps 0..3 check, so that a refused set leaves the running one whole; steps 4..7 take over.
ParameterSets::Progress ParameterSets::work_on_apply(Controllers& controllers) {
  const uint8_t step = step_++;
  if (step < hal::joint_count) {
    if (fit(sets_.staged(), step)) return Progress::going_on;
    step_ = idle;
    return Progress::refused;
  }
  const uint8_t joint = static_cast<uint8_t>(step - hal::joint_count);
  controllers.take(sets_.staged(), joint);
  if (joint < hal::joint_count - 1) return Progress::going_on;
  sets_.apply();
  step_ = idle;
  return Progress::applied;
}

bool ParameterSets::work_on_save() {
  if (store_.state() != wire::SaveState::saving || hal::eeprom_busy()) return false;
  store_.poll();
  return !hal::eeprom_busy();
}

}  // namespace app
