// See law.h.
#include "law.h"

#include <fake/fake_hal.h>
#include <signal_chain/duty.h>
#include <signal_chain/pot.h>

#include <cstdlib>

#include "must.h"

namespace attack {
namespace {

constexpr std::uint16_t whole_q15 = 32768;

fuzzy_pdi::Refusal compile(const params::Table& table, std::uint8_t joint, fuzzy_pdi::Coefficients& out) {
  const params::JointParameters& p = table.joint[joint];
  const std::uint8_t ce_ticks = table.change[joint].ce_ticks;
  const fuzzy_pdi::Settings settings = {p.ne_c,  p.ze_a, p.ze_c, p.pe_b, p.nce_c, p.zce_a, p.zce_c,
                                        p.pce_b, p.kp,   p.kd,   p.ki,   p.ku_mv, ce_ticks};
  return fuzzy_pdi::compile(settings, table.period_ms, out);
}

}  // namespace

bool can_run(const params::Table& table) {
  fuzzy_pdi::Coefficients unused;
  for (std::uint8_t i = 0; i < 4; ++i) {
    if (compile(table, i, unused) != fuzzy_pdi::Refusal::none) return false;
  }
  return true;
}

void Law::take(const params::Table& table) {
  table_ = table;
  for (std::uint8_t i = 0; i < 4; ++i) {
    must(compile(table, i, joints_[i].coefficients) == fuzzy_pdi::Refusal::none, "only a set that can be run runs");
  }
}

void Law::start(bool after_short_stop) {
  for (fuzzy_pdi::Joint& joint : joints_) {
    const bool keep = after_short_stop && joint.coefficients.integral != 0;
    fuzzy_pdi::reset(joint.coefficients, joint.state, keep ? joint.state.integral : 0);
  }
  known_ = !after_short_stop || (known_ && !control_);
  volts_mv_ = {};
  ticks_on_ = 0;
  until_control_ = 1;
  control_ = false;
}

void Law::tick() {
  if (control_) known_ = false;
  ++ticks_on_;
  if (--until_control_) return;
  until_control_ = table_.period_ms;
  control_ = true;
}

std::uint16_t Law::limit_mv() const {
  const std::uint32_t step = (std::uint32_t{1} << 31) / table_.soft_start_ms;
  const bool whole = ticks_on_ >= table_.soft_start_ms;
  const auto share = whole ? whole_q15 : static_cast<std::uint16_t>(step * ticks_on_ >> 16);
  return signal_chain::limit_mv(table_.supply_mv, share);
}

void Law::predict(const wire::Sample& sample, bool leading) {
  for (std::uint8_t i = 0; i < 4; ++i) {
    const params::JointParameters& own = table_.joint[i];
    const std::int16_t leader =
        leading ? sample.leader[i] : signal_chain::clamp(sample.leader[i], own.limit_min, own.limit_max);
    const std::int16_t error = fuzzy_pdi::difference(leader, sample.follower[i]);
    volts_mv_[i] = fuzzy_pdi::step_error(joints_[i], error, limit_mv()).volts_mv;
  }
}

void Law::judge_size(std::uint8_t joint, int volts_mv) const {
  using hal::fake::board;
  const std::int64_t supply = table_.supply_mv, size = std::abs(volts_mv);
  must(size <= supply, "no voltage above the supply");
  must(size * table_.soft_start_ms <= supply * ticks_on_ || size == 0 || ticks_on_ >= table_.soft_start_ms,
       "no voltage above the ramp of the soft start");
  const std::int64_t duty = std::int64_t{board.duty[joint]} * table_.joint[joint].motor_sign;
  const std::int64_t away = std::abs(duty * supply - std::int64_t{volts_mv} * hal::fake::full_duty);
  // Half a step, and what the 16 bits of the scale leave at 30 V.
  must(100 * away <= 56 * supply, "the duty is the one nearest to the voltage");
}

// A joint that does not move gets less than the law asks for, and never something the other way.
bool Law::is_held_back(int volts_mv, int asked_mv) const {
  return table_.stall_volts != 0 && std::abs(volts_mv) < std::abs(asked_mv) &&
         (volts_mv == 0 || (volts_mv < 0) == (asked_mv < 0));
}

void Law::judge(const wire::Sample& sample, bool leading) {
  if (control_) predict(sample, leading);
  control_ = false;
  for (std::uint8_t i = 0; i < 4; ++i) {
    judge_size(i, sample.voltage[i]);
    must(!known_ || sample.voltage[i] == volts_mv_[i] || is_held_back(sample.voltage[i], volts_mv_[i]),
         "the voltage is that of the law with the set that should run");
    // What a controller keeps depends on what it may give.
    known_ = known_ && sample.voltage[i] == volts_mv_[i];
  }
}

}  // namespace attack
