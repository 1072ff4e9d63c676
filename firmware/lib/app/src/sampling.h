// From sums of ADC conversions to angles and references, and what the supervisor watches: rails and distances.
#pragma once
#include <hal.h>
#include <multiply.h>
#include <params/table.h>
#include <stdint.h>
#include <supervisor.h>

namespace app {

class Sampling {
 public:
  void configure(const params::Table& table);
  // Takes the sums of every pot, as hal::pot_sums() has them; notes rails and distances in `seen`.
  void tick(const uint16_t* sums, supervisor::Observation& seen);

  int16_t leader(uint8_t joint) const { return pots_[joint].angle; }   // q12 rad
  int16_t follower(uint8_t joint) const { return pots_[hal::joint_count + joint].angle; }
  // The leader within the joint's limits: what the follower is asked for.
  int16_t reference(uint8_t joint) const { return joints_[joint].reference; }

 private:
  struct Pot {
    uint16_t filtered;   // the 10-bit count x 64
    int16_t scale;
    hal::Offset offset;  // angle = (filtered * scale + offset) / 2^15
    int16_t angle;
  };
  struct Joint {
    int16_t limit_min, limit_max, reference;
  };
  // The low-pass: filtered = filtered * keep / 2^8 + sum * gain
  struct Filter {
    uint8_t keep, gain;
  };
  // Sums within lowest .. lowest + span are not at a rail.
  struct Inside {
    uint16_t lowest, span;
  };
  static void calibrate(Pot& pot, const params::PotParameters& parameters);
  template <uint8_t pot>
  int16_t angle(uint16_t sum, Filter filter, Inside inside, supervisor::Observation& seen);
  template <uint8_t joint>
  void lead(uint16_t sum, Filter filter, Inside inside, supervisor::Observation& seen);
  template <uint8_t joint>
  void follow(uint16_t sum, Filter filter, Inside inside, supervisor::Observation& seen);

  Pot pots_[hal::pot_count] = {};
  Joint joints_[hal::joint_count] = {};
  Inside inside_ = {0, 0xffff};
  Filter chosen_ = {};        // by the parameters
  Filter filter_ = {0, 16};   // at work: takes the first sample whole
  bool primed_ = false;
};

}  // namespace app
