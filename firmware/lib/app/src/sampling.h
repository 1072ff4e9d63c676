// From sums of ADC conversions to filtered angles and rail flags.
#pragma once
#include <hal.h>
#include <params/table.h>
#include <stdint.h>

namespace app {

class Sampling {
  public:
    void configure(const params::Table& table);
    void tick(const uint16_t (&sums)[hal::pot_count]);

    const int16_t* leader() const { return angle_; }   // q12 rad
    const int16_t* follower() const { return angle_ + hal::joint_count; }
    uint8_t rail_low() const { return rail_low_; }     // bit i: pot i
    uint8_t rail_high() const { return rail_high_; }

  private:
    struct Pot {
        uint16_t filtered;   // the 10-bit count x 64
        uint16_t zero;
        int16_t scale;
    };
    Pot pots_[hal::pot_count] = {};
    int16_t angle_[hal::pot_count] = {};
    uint16_t low_sum_ = 0, high_sum_ = 0xffff;   // a sum below / above is at the rail
    uint8_t shift_ = 0, half_ = 0;
    uint8_t rail_low_ = 0, rail_high_ = 0;
    bool primed_ = false;
};

}  // namespace app
