// A tick's pass over the potentiometers: from sums of conversions to angles, errors, distances and rails.
#pragma once
#include <hal.h>
#include <signal_chain/pot.h>
#include <stdint.h>
#include <supervisor.h>

namespace app {

struct JointSignals {
  signal_chain::Pot leader, follower;
  uint16_t leader_old_share, follower_old_share;  // see signal_chain::LowPass
  int16_t follower_angle;                         // q12 rad
  int16_t limit_min, limit_max;                   // of the reference, which is the leader within them
  int16_t error;                                  // reference - follower, saturated at +-32767
};

// What a sum at a rail means. tell_rails: Observation has the pot's bit. hold_rails: its angle stays that of the last
// good sum.
enum Rails : uint8_t { hold_rails = 1, tell_rails = 2 };

struct Signals {
  signal_chain::LowPass low_pass;
  uint16_t lowest, span;  // a sum from lowest to lowest + span is not at a rail
  uint8_t rails;          // what a sum at a rail means: bits of Rails
  JointSignals joint[hal::joint_count];
};

// `sums` are those of all pots, as hal::pot_sums() gives them, marks included. Writes the rails of `seen`.
void follow_pots_portable(const uint16_t* sums, Signals* signals, supervisor::Observation* seen);

// Between ticks: works out the share of the old value in each low-pass, for the next tick.
void prepare_low_passes(Signals& signals);

#if defined(__AVR__)

// The same bits in assembly: signals_avr.S. It saves only Y: hal::run_tick() lets the tick use all registers.
inline void follow_pots(const uint16_t* sums, Signals* signals, supervisor::Observation* seen) {
  register const uint16_t* r24 __asm__("r24") = sums;
  register Signals* r22 __asm__("r22") = signals;
  register supervisor::Observation* r20 __asm__("r20") = seen;
  __asm__ volatile("%~call app_follow_pots"
                   : "+r"(r24), "+r"(r22), "+r"(r20)
                   :
                   : "r6", "r7", "r8", "r9", "r10", "r11", "r12", "r13", "r14", "r15", "r16", "r17", "r18", "r19",
                     "r26", "r27", "r30", "r31", "memory");
}

#else

inline void follow_pots(const uint16_t* sums, Signals* signals, supervisor::Observation* seen) {
  follow_pots_portable(sums, signals, seen);
}

#endif

}  // namespace app
