// What the motors must be told: the fuzzy law of the set that should run, worked out beside the firmware from the
// angles that the firmware reports. If another set ran, or a controller kept something from before, the voltages would
// differ.
#pragma once
#include <fuzzy_pdi.h>
#include <link/schema.h>
#include <params/params.h>

#include <array>
#include <cstdint>

namespace attack {

// Whether every joint's controller can run the set.
bool can_run(const params::Table& table);

class Law {
 public:
  void take(const params::Table& table);  // the set that should run, which can be run
  void start(bool after_short_stop);      // the motors have gone on; after a short stop the integrals go on
  void tick();                            // they were on in this tick
  void judge(const wire::Sample& sample, bool leading);

 private:
  void predict(const wire::Sample& sample, bool leading);
  bool is_held_back(int volts_mv, int asked_mv) const;
  void judge_size(std::uint8_t joint, int volts_mv) const;
  std::uint16_t limit_mv() const;

  params::Table table_ = {};
  std::array<fuzzy_pdi::Joint, 4> joints_ = {};
  std::array<int, 4> volts_mv_ = {};
  std::uint32_t ticks_on_ = 0;
  std::uint8_t until_control_ = 1;
  bool control_ = false;  // the last tick was one of control, and its sample has not been seen
  bool known_ = false;    // no sample of a tick of control was missed since the integrals began
};

}  // namespace attack
