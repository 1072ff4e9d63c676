// See motion.h.
#ifdef __AVR__
#pragma GCC optimize("Os")  // between ticks there is time, and flash is short
#endif

#include "motion.h"

namespace supervisor {
namespace {

constexpr uint16_t pushes_mv = 2000;    // from here on a voltage counts as one that the joint runs against
constexpr uint16_t turns = 8;           // q12 rad a look: noise moves a reading less
constexpr uint8_t noise = 2;            // 1/1024 rad a look, of a speed
constexpr int16_t play = 33;            // q12 rad: noise moves a reading less to either side, 8 mrad
constexpr int16_t most_way = 8191;      // q14 rad a look: four of these fit into 16 bits
constexpr uint16_t try_from = 4915;     // q14 rad missing, 0.3 rad: from here on the joint is pushed gently
constexpr uint16_t gentle_looks = 16;   // after so many it is held back
constexpr uint8_t late_looks = 6;       // of a reading behind its joint: noise, play and smoothing
constexpr uint16_t most_late = 2000;    // q14 rad, 0.12 rad
constexpr int16_t most_held = 5914;     // q14 rad missing of a joint that is held back, which is tried again after 2 s
constexpr int16_t most_missing = 7914;  // q14 rad: four numbers like most_way fit into 16 bits
constexpr int16_t leak = 2;             // q14 rad a look, of what is missing: 30 mrad/s
constexpr uint16_t looks_in_a_quarter = 62;
constexpr int16_t most_load_mv = 4000;  // that is not known
constexpr int16_t loads_mv = 128;       // a look, 32 V/s
constexpr uint16_t unloads_mv = 64;     // a look

__attribute__((noinline)) int16_t within(int32_t value, int16_t most) {
  return value > most ? most : value < -most ? static_cast<int16_t>(-most) : static_cast<int16_t>(value);
}

__attribute__((noinline)) int16_t toward_zero(int16_t value, uint16_t by) {
  if (size_of(value) <= by) return 0;
  return static_cast<int16_t>(value < 0 ? value + by : value - by);
}

// q14 rad a look that so many mV give in the end.
__attribute__((noinline)) int16_t steady_speed(uint16_t mv, uint8_t speed_per_volt) {
  const auto product = static_cast<int32_t>(static_cast<uint32_t>(mv) * speed_per_volt);
  const int16_t speed = within(product >> 9, most_way - most_way / 16);
  return static_cast<int16_t>(speed + (speed >> 4));
}

}  // namespace

// Not inline: from the array's own address on, the code is longer.
__attribute__((noinline)) MotionFault Motion::look_at(Joint& own, const JointSeen& seen, const MotionLimits& limits) {
  const auto moved = static_cast<int16_t>(static_cast<uint16_t>(seen.follower) - static_cast<uint16_t>(own.last));
  own.last = seen.follower;
  if (own.hold == Hold::unknown) {
    own = Joint{};
    own.last = own.place = seen.follower;
    own.hold = Hold::free;
    return MotionFault::none;
  }
  if (limits.speed != 0 && size_of(moved) > way_of_look(limits.speed)) return MotionFault::speed;
  const Push push = push_of(seen, limits);
  const bool back = goes_back(own, moved, push);
  if (runs_away(own, limits.runaway)) return MotionFault::runaway;
  if (limits.stall == 0) return MotionFault::none;
  const int16_t way = follow(own);
  learn(own, push, way);
  expect(own, push, limits.travel, way, back);
  return hold(own, push.way, seen.error, limits.time);
}

// What the voltage of a look gives.
inline Motion::Push Motion::push_of(const JointSeen& seen, const MotionLimits& limits) {
  Push push;
  push.left_mv = static_cast<int16_t>(seen.volts_mv - seen.gravity_mv);
  push.starts_mv =
      static_cast<uint16_t>((limits.travel.breakaway != 0 ? limits.travel.breakaway : limits.stall) * 100u);
  const uint16_t size_mv = size_of(push.left_mv);
  push.way = 0;
  if (size_mv > push.starts_mv)
    push.way = steady_speed(static_cast<uint16_t>(size_mv - push.starts_mv + push.starts_mv / 4u),
                            limits.travel.speed_per_volt);
  return push;
}

// Whether the joint goes against its voltage in this look, as if the voltage were the reason.
inline bool Motion::goes_back(Joint& joint, int16_t moved, const Push& push) {
  const bool against = (push.left_mv < 0) == (moved > 0);
  const uint16_t way = size_of(moved);
  if (way > turns && (!against || (moved > 0) != (joint.back > 0))) joint.back = joint.peak = 0;
  if (!against || size_of(push.left_mv) < (push.starts_mv < pushes_mv ? push.starts_mv : pushes_mv)) return false;
  const auto speed = static_cast<uint16_t>(way / 4u);
  if (joint.peak == 0) joint.brought = static_cast<uint8_t>(speed > 255 ? 255 : speed);
  if (speed > joint.peak) joint.peak = speed > 255 ? uint8_t{255} : static_cast<uint8_t>(speed);
  if (speed + joint.peak / 16u + noise < joint.peak) return false;
  if (way >= static_cast<uint16_t>(push.way) / 32u) joint.back = static_cast<int16_t>(joint.back + moved);
  return true;
}

// A joint that was fast already when its voltage came to be against it may go twice the way.
inline bool Motion::runs_away(const Joint& joint, uint8_t limit) {
  auto most = static_cast<uint16_t>(limit * 32u);
  if (joint.peak - joint.brought < joint.brought / 2) most = static_cast<uint16_t>(2u * most);
  return limit != 0 && size_of(joint.back) > most;
}

// The place follows the reading as far as that leaves it by more than its noise. The way, in q14 rad.
inline int16_t Motion::follow(Joint& joint) {
  const auto apart = static_cast<int16_t>(static_cast<uint16_t>(joint.last) - static_cast<uint16_t>(joint.place));
  const int16_t way = within(toward_zero(apart, play), most_way / 4);
  joint.place = static_cast<int16_t>(static_cast<uint16_t>(joint.place) + static_cast<uint16_t>(way));
  return static_cast<int16_t>(way * 4);
}

// A joint that gives way while it is pushed gently carries more than is known: one that has gone against the push
// before this look and goes on. Noise does not, nor does a reading that froze. One that stays where it is, or goes the
// other way, although its load should take it along, does not carry that.
inline void Motion::learn(Joint& joint, const Push& push, int16_t way) {
  const bool sinks = (push.left_mv ^ joint.load_mv) < 0;  // if the load is right
  if (sinks && push.way != 0 && (joint.speed == 0 || (push.left_mv ^ joint.speed) < 0)) {
    joint.load_mv = toward_zero(joint.load_mv, unloads_mv);
  } else if (joint.speed != 0 && way != 0 && joint.hold != Hold::free && (joint.speed ^ joint.missing) < 0 &&
             (way ^ joint.missing) < 0) {
    joint.load_mv = within(joint.load_mv + (joint.missing < 0 ? -loads_mv : loads_mv), most_load_mv);
  }
}

// What the voltage of this look gives, less what the reading shows of it. Below breakaway friction takes what is
// missing, unless the joint is held back. A reading that moves is better known than the model: each way that it makes
// takes off twice as much of what it and the model disagree about.
inline void Motion::expect(Joint& joint, const Push& push, const Travel& travel, int16_t way, bool back) {
  const bool held = joint.hold != Hold::free;
  const int16_t before = joint.speed;
  joint.speed = toward_zero(static_cast<int16_t>(before + (way - before) / 4), way == 0);
  const auto turned = static_cast<int16_t>(joint.speed - before);
  const int16_t change = within(int32_t{turned + thrown_ / 2} * travel.time_constant, most_way);
  thrown_ = turned;
  auto apart = static_cast<int16_t>(joint.missing + (push.left_mv < 0 ? -push.way : push.way) - way - change);
  if (push.way == 0 && !held)
    apart = toward_zero(apart, static_cast<uint16_t>(steady_speed(push.starts_mv / 2u, travel.speed_per_volt)));
  if (way != 0 && !back && (!held || (way > 0) == (joint.missing > 0))) {
    const int16_t coming = within(int32_t{joint.speed} * travel.time_constant, most_way);
    const uint16_t size = size_of(apart);
    apart = toward_zero(apart, size_of(coming) > size / 8u ? size / 4u : 2u * size_of(way));
  }
  joint.missing = within(toward_zero(apart, leak), joint.hold == Hold::back ? most_held : most_missing);
}

inline MotionFault Motion::hold(Joint& joint, int16_t given, int16_t error, uint8_t time) {
  const uint16_t missing = size_of(joint.missing);
  const int16_t speed = joint.missing < 0 ? static_cast<int16_t>(-joint.speed) : joint.speed;
  // A joint that goes away from its reference is braked by its voltage.
  const bool wanted = (error > 0) == (joint.missing > 0) && speed > -moves;
  const auto way = static_cast<uint16_t>(given);
  uint16_t from = try_from;
  if (joint.hold != Hold::back)
    from = static_cast<uint16_t>(from +
                                 (way > most_late / late_looks ? most_late : static_cast<uint16_t>(way * late_looks)));
  if (wanted && missing > from && (given != 0 || joint.hold != Hold::free)) {
    if (joint.hold != Hold::back) joint.hold = joint.waited > gentle_looks ? Hold::back : Hold::gentle;
    ++joint.waited;
  } else {
    joint.hold = Hold::free;
    if (!wanted || missing < try_from / 2) joint.waited = 0;
  }
  return joint.waited > static_cast<uint16_t>(time * looks_in_a_quarter) ? MotionFault::stalled : MotionFault::none;
}

}  // namespace supervisor
