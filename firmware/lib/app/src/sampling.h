// From sums of ADC conversions to filtered angles and rail flags.
#pragma once
#include <hal.h>
#include <params/table.h>
#include <stdint.h>

namespace app {

class Sampling {
 public:
  void configure(const params::Table& table);
  void tick(const uint16_t* sums);   // of every pot, as hal::pot_sums() has them

  int16_t leader(uint8_t joint) const { return pots_[joint].angle; }   // q12 rad
  int16_t follower(uint8_t joint) const { return pots_[hal::joint_count + joint].angle; }
  uint8_t rail_low() const { return rail_low_; }   // bit i: pot i
  uint8_t rail_high() const { return rail_high_; }

 private:
  struct Pot {
    uint16_t filtered;   // the 10-bit count x 64
    uint16_t zero;
    int16_t scale;
    int16_t angle;
  };
  static void follow(Pot& pot, uint16_t sum, uint8_t halvings);
  void note_rail(uint8_t pot, bool low);

  Pot pots_[hal::pot_count] = {};
  uint16_t lowest_ = 0, span_ = 0xffff;   // sums within lowest_ .. lowest_ + span_ are not at a rail
  uint8_t halvings_ = 0;                  // filter_shift - 1, or no_filter
  uint8_t rail_low_ = 0, rail_high_ = 0;
  bool primed_ = false;
};

}  // namespace app
