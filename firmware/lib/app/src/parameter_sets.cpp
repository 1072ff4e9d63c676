// See parameter_sets.h.
#include "parameter_sets.h"

namespace app {

// Loaded where it will be staged: a third table, on the stack, would be a tenth of a Nano's memory.
bool ParameterSets::begin(Controllers& controllers) {
  params::Table& table = const_cast<params::Table&>(sets_.staged());
  source_ = store_.load(table);
  bool runs = true;
  for (uint8_t i = 0; i < hal::joint_count && runs; ++i) runs = take(controllers, table, i);
  if (!runs) {
    params::load_defaults(table);
    source_ = wire::ParamSource::defaults;
    for (uint8_t i = 0; i < hal::joint_count; ++i) controllers.take(table, i);
  }
  sets_.begin(table);
  return runs;
}

bool ParameterSets::take(Controllers& controllers, const params::Table& table, uint8_t joint) {
  const fuzzy_pdi::Refusal refusal = controllers.take(table, joint);
  if (refusal == fuzzy_pdi::Refusal::none) return true;
  unfit_ = {joint, refusal};
  return false;
}

ParameterSets::Progress ParameterSets::work_on_apply(Controllers& controllers) {
  if (undoing_) {
    if (joint_ < unfit_.joint) {
      controllers.take(sets_.running(), joint_++);
      return Progress::going_on;
    }
    undoing_ = false;
    joint_ = idle;
    return Progress::refused;
  }
  if (!take(controllers, sets_.staged(), joint_)) {
    undoing_ = true;
    joint_ = 0;
    return Progress::going_on;
  }
  if (++joint_ < hal::joint_count) return Progress::going_on;
  sets_.apply();
  joint_ = idle;
  return Progress::applied;
}

bool ParameterSets::work_on_save() {
  if (store_.state() != wire::SaveState::saving || hal::eeprom_busy()) return false;
  store_.poll();
  return !hal::eeprom_busy();
}

}  // namespace app
