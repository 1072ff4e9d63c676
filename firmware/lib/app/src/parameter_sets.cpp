// See parameter_sets.h.
#include "parameter_sets.h"

namespace app {
namespace {

bool has_pins(const params::Table& table) { return hal::has_driver(static_cast<hal::Driver>(table.driver)); }

}  // namespace

// Loads the table where it will be staged. A third table, on the stack, would take a tenth of a Nano's memory.
bool ParameterSets::begin(Controllers& controllers) {
  params::Table& table = sets_.staged();
  source_ = store_.load(table);
  bool runs = has_pins(table);
  for (uint8_t i = 0; i < hal::joint_count && runs; ++i) runs = take(controllers, table, i);
  if (!runs) {
    params::load_defaults(table);
    source_ = wire::ParamSource::defaults;
    for (uint8_t i = 0; i < hal::joint_count; ++i) controllers.take(table, i);
  }
  sets_.begin(table);
  return runs && !store_.lost();
}

bool ParameterSets::take(Controllers& controllers, const params::Table& table, uint8_t joint) {
  const fuzzy_pdi::Refusal refusal = controllers.take(table, joint);
  if (refusal == fuzzy_pdi::Refusal::none) return true;
  unfit_ = {joint, refusal};
  return false;
}

void ParameterSets::begin_apply(uint16_t crc) {
  apply_crc_ = crc;
  at_ = 0;
  step_ = Step::crc;
}

void ParameterSets::begin_safe() {
  params::Table& table = sets_.staged();
  table = sets_.running();
  for (uint8_t i = 0; i < hal::joint_count; ++i) params::make_safe(table, i);
  safe_ = Safe::begun;
  at_ = 0;
  step_ = Step::joints;
}

ParameterSets::Progress ParameterSets::end(Progress how) {
  step_ = Step::none;
  return how;
}

ParameterSets::Progress ParameterSets::work_on_apply(Controllers& controllers) {
  switch (step_) {
    case Step::crc: {
      const uint16_t wanted = apply_crc_;
      apply_crc_ = params::crc(sets_.staged());
      if (apply_crc_ != wanted) return end(Progress::crc_differs);
      step_ = Step::consistency;
      break;
    }
    case Step::consistency:
      at_ = params::first_inconsistent(sets_.staged());
      if (at_ != params::none) return end(Progress::inconsistent);
      if (!has_pins(sets_.staged())) return end(Progress::no_pins);
      at_ = 0;
      step_ = Step::joints;
      break;
    case Step::joints:
      if (!take(controllers, sets_.staged(), at_)) {
        at_ = 0;
        step_ = Step::undo;
      } else if (++at_ == hal::joint_count) {
        step_ = Step::finish;
      }
      break;
    case Step::undo:
      if (at_ == unfit_.joint) return end(Progress::refused);
      controllers.take(sets_.running(), at_++);
      break;
    case Step::finish:
      sets_.apply();
      safe_ = safe_ == Safe::begun ? Safe::applied : Safe::no;
      return end(Progress::applied);
    case Step::none: break;
  }
  return Progress::going_on;
}

bool ParameterSets::work_on_save() {
  if (store_.state() != wire::SaveState::saving || hal::eeprom_busy()) return false;
  store_.poll();
  return !hal::eeprom_busy();
}

}  // namespace app
