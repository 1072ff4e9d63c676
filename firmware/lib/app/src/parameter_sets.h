// The running and the staged parameter set: how the staged one becomes the running one, and how that is kept in EEPROM.
#pragma once
#include <fuzzy_pdi.h>
#include <hal.h>
#include <params/params.h>
#include <params/store.h>
#include <stdint.h>

#include "controllers.h"

namespace app {

struct HalEeprom {
  uint8_t read(uint16_t address) { return hal::eeprom_read(address); }
  void begin_write(uint16_t address, uint8_t value) { hal::eeprom_begin_write(address, value); }
  bool busy() { return hal::eeprom_busy(); }
};

// The joint whose settings cannot be run, and why.
struct Unfit {
  uint8_t joint;
  fuzzy_pdi::Refusal refusal;
};

class ParameterSets {
 public:
  // Loads the stored set, or the defaults. False when it need not be the set that ran before: the stored set cannot be
  // run and the defaults stand in, or a bank of the EEPROM is lost.
  bool begin(Controllers& controllers);

  const params::Table& running() const { return sets_.running(); }
  uint16_t crc() const { return sets_.running_crc(); }
  wire::ParamSource source() const { return source_; }
  params::Access stage(uint16_t index, int32_t value) { return sets_.stage(index, value); }
  void stage_defaults() { sets_.stage_defaults(); }

  // Checks the staged set and hands it to the controllers, one step in each call. A step takes about 2 ms at most.
  // When a joint refuses its settings, the joints before it get their running settings back.
  enum class Progress : uint8_t { going_on, applied, crc_differs, inconsistent, no_pins, refused };
  void begin_apply(uint16_t crc);
  bool applying() const { return step_ != Step::none; }
  // The same for the safe set, by the board itself: the running set with the controllers of the defaults, and with no
  // gain and no voltage above the running one. The staged set is lost. Not while a set is being saved or applied.
  enum class Safe : uint8_t { no, begun, applied, runs };
  void begin_safe();
  Safe safe() const { return safe_; }
  void safe_runs() { safe_ = Safe::runs; }
  Progress work_on_apply(Controllers& controllers);
  // What was wrong: the CRC of the staged set, the index of the parameter that contradicts another, the joint.
  uint16_t staged_crc() const { return apply_crc_; }
  uint8_t misfit() const { return at_; }
  uint8_t staged_driver() const { return sets_.staged().driver; }
  Unfit unfit() const { return unfit_; }  // also when begin() has found that the stored set cannot be run

  void save() { store_.save(sets_.running()); }
  bool work_on_save();  // at most one byte; true when the next can follow at once
  wire::SaveState save_state() const { return store_.state(); }
  uint16_t saves() const { return store_.sequence(); }

 private:
  enum class Step : uint8_t { none, crc, consistency, joints, undo, finish };

  Progress end(Progress how);
  bool take(Controllers& controllers, const params::Table& table, uint8_t joint);

  params::Sets sets_;
  params::Store<HalEeprom> store_;
  uint16_t apply_crc_ = 0;  // the CRC that the host wants, then the one that was found
  Step step_ = Step::none;
  Safe safe_ = Safe::no;
  uint8_t at_ = 0;  // the joint that is next, or the parameter that does not fit
  Unfit unfit_ = {0, fuzzy_pdi::Refusal::none};
  wire::ParamSource source_ = wire::ParamSource::defaults;
};

}  // namespace app
