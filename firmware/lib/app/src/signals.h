// A tick's pass over the potentiometers: from sums of conversions to angles, references, distances and rails.
#pragma once
#include <hal.h>
#include <multiply.h>
#include <stdint.h>
#include <supervisor.h>

namespace app {

struct Pot {
  uint16_t filtered;    // the 10-bit count x 64
  int16_t scale;
  hal::Offset offset;   // angle = (filtered * scale + offset) / 2^15
  int16_t angle;        // q12 rad
};

struct JointSignals {
  Pot leader, follower;
  int16_t limit_min, limit_max;
  int16_t reference;    // the leader within the limits
};

struct Signals {
  uint8_t keep, gain;       // the low-pass: filtered = filtered * keep / 2^8 + sum * gain
  uint16_t lowest, span;    // sums within lowest .. lowest + span are not at a rail
  JointSignals joint[hal::joint_count];
};

// `sums` of every pot as hal::pot_sums() has them. Sets all of `seen` but `late`; its rails must be 0 before.
void follow_pots_portable(const uint16_t* sums, Signals* signals, supervisor::Observation* seen);

#if defined(__AVR__)

// The same bits in assembly: signals_avr.S, which counts on this layout.
extern "C" void app_follow_pots(const uint16_t* sums, Signals* signals, supervisor::Observation* seen);
static_assert(sizeof(Pot) == 10 && sizeof(JointSignals) == 26 && sizeof(Signals) == 6 + 4 * 26, "signals_avr.S");
static_assert(sizeof(supervisor::Observation) == 11 && hal::pot_count == 8, "signals_avr.S");
inline void follow_pots(const uint16_t* sums, Signals* signals, supervisor::Observation* seen) {
  app_follow_pots(sums, signals, seen);
}

#else

inline void follow_pots(const uint16_t* sums, Signals* signals, supervisor::Observation* seen) {
  follow_pots_portable(sums, signals, seen);
}

#endif

}  // namespace app
