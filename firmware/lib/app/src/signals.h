// A tick's pass over the potentiometers: from sums of conversions to angles, errors, distances and rails.
#pragma once
#include <hal.h>
#include <multiply.h>
#include <stdint.h>
#include <supervisor.h>

namespace app {

struct Pot {
  uint16_t filtered;    // the 10-bit count x 64
  int16_t scale;
  hal::Offset offset;   // angle = (filtered * scale + offset) / 2^15, q12 rad
};

inline int16_t angle(const Pot& pot) { return hal::line(pot.filtered, pot.scale, pot.offset); }

struct JointSignals {
  Pot leader, follower;
  int16_t follower_angle;         // q12 rad
  int16_t limit_min, limit_max;   // of the reference, which is the leader within them
  int16_t error;                  // reference - follower, saturated at +-32767
};

struct Signals {
  uint8_t keep, gain;       // the low-pass: filtered = filtered * keep / 2^8 + sum * gain
  uint16_t lowest, span;    // sums within lowest .. lowest + span are not at a rail
  JointSignals joint[hal::joint_count];
};

// `sums` of every pot as hal::pot_sums() has them. Sets all of `seen` but `late`; its rails must be 0 before.
void follow_pots_portable(const uint16_t* sums, Signals* signals, supervisor::Observation* seen);

#if defined(__AVR__)

// The same bits in assembly: signals_avr.S, which counts on this layout. It saves no registers but Y: the tick has saved them
// once, for this and for the controllers.
static_assert(sizeof(Pot) == 8 && sizeof(JointSignals) == 24 && sizeof(Signals) == 6 + 4 * 24, "signals_avr.S");
static_assert(sizeof(supervisor::Observation) == 11 && hal::pot_count == 8, "signals_avr.S");
inline void follow_pots(const uint16_t* sums, Signals* signals, supervisor::Observation* seen) {
  register const uint16_t* r24 __asm__("r24") = sums;
  register Signals* r22 __asm__("r22") = signals;
  register supervisor::Observation* r20 __asm__("r20") = seen;
  __asm__ volatile("%~call app_follow_pots"
      : "+r"(r24), "+r"(r22), "+r"(r20)
      :
      : "r8", "r9", "r10", "r11", "r12", "r13", "r14", "r15", "r16", "r17", "r18", "r19", "r26", "r27", "r30", "r31", "memory");
}

#else

inline void follow_pots(const uint16_t* sums, Signals* signals, supervisor::Observation* seen) {
  follow_pots_portable(sums, signals, seen);
}

#endif

}  // namespace app
