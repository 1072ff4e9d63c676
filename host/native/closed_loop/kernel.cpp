// The closed loop of sixteen candidates over the whole experiment. core.cmake compiles it once for each instruction
// set.
#include <cstddef>
#include <cstdint>

#include "arm/random.h"
#include "block.h"
#include "lanes.h"
#include "lanes_gather.h"
#include "no_denormals.h"

namespace greywhale::loop::GREYWHALE_INSTRUCTIONS {

namespace {

constexpr std::size_t kFlush = 256;  // ticks between additions to the sums in double precision

struct Totals {
  Float mse[kJoints], itae[kJoints], itau[kJoints];
};

class Run {
 public:
  Run(const Experiment& x, const Shared& shared, const Block& block, int steps)
      : x_(x),
        shared_(shared),
        pots_(shared.pots),
        block_(block),
        steps_(static_cast<std::size_t>(steps)),
        traced_(block.traces[0].every != 0) {
    const double h = kTick / steps;
    plant_.body = body_of(block);
    sensors_ = sensors_of(block, pots_);
    sag_ = sag_of(block, x.settings.pwm_top);
    losses_ = losses_of(block, x.settings.pwm_top);
    worn_ = is_worn(block);
    plant_.step = all(static_cast<float>(h));
    plant_.travel = all(static_cast<float>(h) * kRadian);
    plant_.per_step = all(static_cast<float>(1.0 / h));
    plant_.rigid = has_rigid_joint(block);
    for (std::size_t i = 0; i < kJoints; ++i) {
      plant_.joints[i] = joint_of(block, i, h, x.settings.pwm_top[i]);
      laws_[i] = law_of(block, i, short_ramps_);
      reset(memories_[i]);
      state_[i] = {all(static_cast<std::int32_t>(units(x.home[i]))), all(0.0f),
                   plant_.joints[i].gap * all(static_cast<float>(x.gap[i])), all(0.0f)};
      begin(sensors_, i, counts(i, state_[i].q));
      const Int count = count_of<true>(i, counts(i, state_[i].q), 0.0f);
      curved_ = curved_ || pots_.linearity[i] != 0.0f;
      sum_[i] = shift_left<2>(count);
      filtered_[i] = shift_left<4>(sum_[i]);
      commanded_[i] = all(0);
      compare_[i] = all(0);
      duty_[i] = all(0.0f);
    }
  }

  void through(Measures* measures) {
    double sums[3][kJoints][kBlock] = {};
    Totals totals = nothing();
    for (std::size_t tick = 0; tick < x_.ticks; ++tick) {
      Float error[kJoints];
      for (std::size_t i = 0; i < kJoints; ++i) {
        error[i] = all(static_cast<float>(x_.leader[tick * kJoints + i])) - shown(i);
      }
      control(tick);
      act(tick);
      add(tick, error, totals);
      if (traced_) record(tick);
      if (worn_) {
        move<true, true>(tick);
      } else if (curved_) {
        move<true, false>(tick);
      } else {
        move<false, false>(tick);
      }
      if (tick % kFlush == kFlush - 1 || tick + 1 == x_.ticks) {
        flush(totals, sums);
        totals = nothing();
      }
    }
    finish(sums, measures);
  }

 private:
  // A pot's place in converter counts at an angle.
  GREYWHALE_INLINE Float counts(std::size_t i, Int q) const {
    return to_float(q) * all(pots_.gain[i]) + all(pots_.offset[i]);
  }

  // The angle that a pot shows, rad.
  GREYWHALE_INLINE Float shown(std::size_t i) const {
    const Float angle = to_float(state_[i].q) * all(kUnit);
    if (__builtin_expect(sensors_.on, 0)) {
      const Float behind = (sensors_.after[i] - all(pots_.offset[i])) * all(kUnit / pots_.gain[i]);
      return choose(sensors_.play[i] + sensors_.kept[i] > all(0.0f), behind, angle);
    }
    return angle;
  }

  template <bool kCurved>
  GREYWHALE_INLINE Int count_of(std::size_t i, Float place, float noise) const {
    if (kCurved) {
      Float sine, cosine;
      sine_cosine(to_nearest(place * all(1048576.0f)), sine, cosine);  // 1024 counts are a turn
      place = place + all(pots_.linearity[i]) * sine;
    }
    const Float seen = greatest(least(place + all(noise), all(static_cast<float>(kTopCount))), all(0.0f));
    return to_int(seen);
  }

  GREYWHALE_INLINE void control(std::size_t tick) {
    const Settings& s = x_.settings;
    const bool on = tick > 0;
    const bool due = on && (tick - 1) % static_cast<std::size_t>(s.period_ms) == 0;
    for (std::size_t i = 0; i < kJoints; ++i) filtered_[i] = low_pass(filtered_[i], sum_[i], s.filter_shift);
    if (!due) return;
    Int leader[kJoints], follower[kJoints], millivolts[kJoints];
    for (std::size_t i = 0; i < kJoints; ++i) {
      const std::int32_t is = x_.reference[tick * kJoints + i];
      leader[i] = all(is < s.limit_min[i] ? s.limit_min[i] : is > s.limit_max[i] ? s.limit_max[i] : is);
      follower[i] = to_angle(filtered_[i], s.follower.zero[i], s.follower.scale[i]);
    }
    step(laws_, memories_, leader, follower, shared_.limit_mv[tick], short_ramps_, millivolts);
    for (std::size_t i = 0; i < kJoints; ++i)
      commanded_[i] = compare_value(millivolts[i], shared_.duty_scale[i], s.motor_sign[i]);
  }

  // The duties that the firmware commands, or those of `late` ticks ago.
  GREYWHALE_INLINE void act(std::size_t tick) {
    for (std::size_t i = 0; i < kJoints; ++i) {
      compare_[i] = commanded_[i];
      if (x_.timing.late != 0) {
        std::int32_t* const then =
            block_.waiting + (tick % static_cast<std::size_t>(x_.timing.late) * kJoints + i) * kBlock;
        compare_[i] = load(then);
        store(then, commanded_[i]);
      }
      duty_[i] = to_float(compare_[i]);
    }
  }

  // The arm from the end of a tick's first slice to that of the next tick's, and what the converter sees on the way.
  template <bool kCurved, bool kWorn>
  GREYWHALE_INLINE void move(std::size_t tick) {
    Float place[kSlices + 1][kJoints];
    for (std::size_t i = 0; i < kJoints; ++i) place[0][i] = counts(i, state_[i].q);
    const std::size_t stride = kSlices / steps_;
    Geometry geometry = geometry_of(plant_.body, state_);
    for (std::size_t slice = stride; slice <= kSlices; slice += stride) {
      const std::size_t first = kSlices * tick + slice - stride + 1;
      // Between two steps of a tick the links move so little that the geometry may stay; four are as exact as can be.
      if (steps_ == 4) geometry = geometry_of(plant_.body, state_);
      if (first > static_cast<std::size_t>(x_.timing.on)) {
        Float duty[kJoints];
        arrive(duty);
        advance<kWorn>(plant_, geometry, state_, duty);
      }
      for (std::size_t i = 0; i < kJoints; ++i) place[slice][i] = counts(i, state_[i].q);
      for (std::size_t part = 1; part < stride; ++part) {  // between the steps the links move evenly
        const Float share = all(static_cast<float>(part) / static_cast<float>(stride));
        for (std::size_t i = 0; i < kJoints; ++i) {
          const Float before = place[slice - stride][i];
          place[slice - stride + part][i] = before + (place[slice][i] - before) * share;
        }
      }
    }
    if (sensors_.on) look(place);
    for (std::size_t i = 0; i < kJoints; ++i) {
      Int sum = all(0);
      for (std::size_t slice = 0; slice <= kSlices; ++slice) {
        const std::int32_t turns = shared_.turns[i][slice];
        if (turns == 0) continue;
        const float noise = pots_.noise ? pots_.noise[(kSlices * tick + slice) * kJoints + i] : 0.0f;
        const Int count = count_of<kCurved>(i, place[slice][i], noise);
        sum = sum + (turns == 1 ? count : count * all(turns));
      }
      sum_[i] = sum;
    }
  }

  // What arrives of the duties.
  GREYWHALE_INLINE void arrive(Float (&duty)[kJoints]) const {
    for (std::size_t i = 0; i < kJoints; ++i) duty[i] = duty_[i];
    if (__builtin_expect(sag_.on, 0)) sag(sag_, state_, duty_, duty);
    if (__builtin_expect(losses_.on, 0)) lose(losses_, duty);
  }

  // The joints' places become those that the converter sees.
  void look(Float (&place)[kSlices + 1][kJoints]) {
    for (std::size_t i = 0; i < kJoints; ++i) {
      place[0][i] = sensors_.after[i];
      for (std::size_t slice = 1; slice <= kSlices; ++slice) place[slice][i] = follow(sensors_, i, place[slice][i]);
    }
  }

  static Totals nothing() {
    Totals t{};
    for (std::size_t i = 0; i < kJoints; ++i) t.mse[i] = t.itae[i] = t.itau[i] = all(0.0f);
    return t;
  }

  GREYWHALE_INLINE void add(std::size_t tick, const Float (&error)[kJoints], Totals& totals) const {
    const Float weight = all(static_cast<float>(x_.weight[tick]));
    for (std::size_t i = 0; i < kJoints; ++i) {
      totals.mse[i] = totals.mse[i] + error[i] * error[i];
      totals.itae[i] = totals.itae[i] + weight * absolute(error[i]);
      totals.itau[i] = totals.itau[i] + weight * absolute(duty_[i]);
    }
  }

  static void flush(const Totals& totals, double (&sums)[3][kJoints][kBlock]) {
    for (std::size_t i = 0; i < kJoints; ++i) {
      const Float parts[3] = {totals.mse[i], totals.itae[i], totals.itau[i]};
      for (std::size_t k = 0; k < 3; ++k) {
        float lanes[kBlock];
        store(lanes, parts[k]);
        for (std::size_t n = 0; n < kBlock; ++n) sums[k][i][n] += static_cast<double>(lanes[n]);
      }
    }
  }

  void record(std::size_t tick) const {
    const std::size_t every = block_.traces[0].every;
    if (tick % every != 0) return;
    const std::size_t at = tick / every * kJoints;
    float angles[kJoints][kBlock];
    std::int16_t duties[kJoints][kBlock];
    for (std::size_t i = 0; i < kJoints; ++i) {
      std::int32_t q[kBlock], compare[kBlock];
      store(q, state_[i].q);
      store(compare, compare_[i]);
      for (std::size_t n = 0; n < kBlock; ++n) {
        angles[i][n] = static_cast<float>(q[n] * (6.283185307179586 / 1073741824.0));
        duties[i][n] = static_cast<std::int16_t>(compare[n]);
      }
    }
    for (std::size_t n = 0; n < block_.count; ++n) {
      for (std::size_t i = 0; i < kJoints; ++i) {
        block_.traces[n].angles[at + i] = angles[i][n];
        block_.traces[n].duties[at + i] = duties[i][n];
      }
    }
  }

  // Once a velocity is no number it stays so.
  void finish(const double (&sums)[3][kJoints][kBlock], Measures* measures) const {
    float lost[kBlock] = {};
    for (const State& s : state_) {
      float v[kBlock], motor_v[kBlock];
      store(v, s.v);
      store(motor_v, s.motor_v);
      for (std::size_t n = 0; n < kBlock; ++n) lost[n] += (v[n] - v[n]) + (motor_v[n] - motor_v[n]);
    }
    for (std::size_t n = 0; n < block_.count; ++n) {
      Measures& m = measures[n];
      m.diverged = !(lost[n] == 0.0f);
      for (std::size_t i = 0; i < kJoints; ++i) {
        const double volts = block_.plants[n]->supply.volts / x_.settings.pwm_top[i];
        m.mse[i] = m.diverged ? kDiverged : sums[0][i][n] / static_cast<double>(x_.ticks);
        m.itae[i] = m.diverged ? kDiverged : kTick * sums[1][i][n];
        m.itau[i] = m.diverged ? kDiverged : kTick * volts * sums[2][i][n];
      }
    }
  }

  const Experiment& x_;
  const Shared& shared_;
  const Pots& pots_;
  const Block& block_;
  const std::size_t steps_;
  const bool traced_;
  bool short_ramps_ = false;
  bool curved_ = false;  // some potentiometer's line is not straight
  bool worn_ = false;
  Plant plant_;
  Sensors sensors_;
  Sag sag_;
  Losses losses_;
  Law laws_[kJoints];
  Memory memories_[kJoints];
  State state_[kJoints];
  Int sum_[kJoints], filtered_[kJoints], commanded_[kJoints], compare_[kJoints];
  Float duty_[kJoints];
};

void run_block(const Experiment& x, const Shared& shared, const Block& block, int steps, Measures* measures) {
  const NoDenormals here;
  Run(x, shared, block, steps).through(measures);
}

void check_law(const LawCheck& c) {
  Block block{};
  for (std::size_t n = 0; n < kBlock; ++n) block.controllers[n] = c.laws + n;
  bool short_ramps = false;
  const Law law[1] = {law_of(block, 0, short_ramps)};
  Memory memory[1];
  reset(memory[0]);
  for (std::size_t k = 0; k < c.n; ++k) {
    const Int leader[1] = {load(c.leader + k * kBlock)}, follower[1] = {load(c.follower + k * kBlock)};
    Int millivolts[1];
    step(law, memory, leader, follower, c.limit_mv[k], short_ramps, millivolts);
    store(c.millivolts + k * kBlock, millivolts[0]);
  }
}

void draw_noise(const Experiment& x, std::size_t slices, float* noise) {
  for (std::size_t i = 0; i < kJoints; ++i) {
    const arm::Noise source(x.seed, i);
    const double counts = x.pots[i].noise * 1000.0 * 1024.0 / kConverterMillivolts;
    for (std::size_t slice = 0; slice < slices; ++slice)
      noise[slice * kJoints + i] = static_cast<float>(counts * source.gaussian(slice));
  }
}

}  // namespace

const Kernel kKernel = {run_block, check_law, draw_noise};

}  // namespace greywhale::loop::GREYWHALE_INSTRUCTIONS
