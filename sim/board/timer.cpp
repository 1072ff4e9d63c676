// Counting, flags and interrupts of the timer/counters after the data sheets. A match or overflow flag appears one
// timer clock after the counter reached the value. Not modelled: external clocks, input capture, asynchronous clock,
// the delay of OCR updates in PWM modes.
#include "timer.h"

#include <algorithm>

namespace board {

Timer::Timer(Mcu& mcu, const TimerMap& map, Interrupts& interrupts)
    : mcu_(mcu),
      map_(map),
      interrupts_(interrupts),
      tccra_(map.tccra),
      tccrb_(address(1)),
      tcnt_(address(map.wide ? 4 : 2)),
      icr_(address(6)),
      flags_reg_(static_cast<uint16_t>(reg::TIFR0 + map.number)),
      mask_reg_(static_cast<uint16_t>(reg::TIMSK0 + map.number)) {
  const auto hook_value = [this](uint16_t low) {
    on_write<&Timer::write_low>(mcu_, low, *this);
    if (wide()) on_write<&Timer::write_high>(mcu_, static_cast<uint16_t>(low + 1), *this);
  };
  for (unsigned channel = 0; channel < channels(); ++channel) hook_value(ocr(channel));
  hook_value(tcnt_);
  on_read<&Timer::read_count>(mcu_, tcnt_, *this);
  if (wide()) {
    hook_value(icr_);
    on_read<&Timer::read_count_high>(mcu_, static_cast<uint16_t>(tcnt_ + 1), *this);
  }
  on_write<&Timer::write_config>(mcu_, tccra_, *this);
  on_write<&Timer::write_config>(mcu_, tccrb_, *this);
  on_write<&Timer::write_flags>(mcu_, flags_reg_, *this);
  on_read<&Timer::read_flags>(mcu_, flags_reg_, *this);
  on_write<&Timer::write_mask>(mcu_, mask_reg_, *this);
  for (unsigned event = overflow; event <= channels(); ++event)
    interrupts_.connect(vector(event), {mask_reg_, bit(event), flags_reg_, bit(event)});
}

void Timer::reset() {
  prescaler_origin_ = mcu_.cycle;
  tick_ = 0;
  count_ = 0;
  falling_ = has_run_ = false;
  mode_ = mode();
  divider_ = 0;
}

// ---- what the registers say ----

uint32_t Timer::register_value(uint16_t reg) const {
  return mcu_.data[reg] | (wide() ? static_cast<uint32_t>(mcu_.data[reg + 1]) << 8 : 0u);
}

Timer::Mode Timer::mode() const {
  const unsigned wgm = (mcu_.data[tccra_] & 3u) | (mcu_.data[tccrb_] >> 1 & 0xCu);
  const uint32_t ocra = compare(0);
  if (!wide()) {
    switch (wgm & 7u) {
      case 1: return {Wave::phase_correct, 0xFF, false};
      case 2: return {Wave::clear_on_match, ocra, true};
      case 3: return {Wave::fast_pwm, 0xFF, false};
      case 5: return {Wave::phase_correct, ocra, true};
      case 7: return {Wave::fast_pwm, ocra, true};
      default: return {Wave::normal, 0xFF, false};
    }
  }
  const uint32_t icr = register_value(icr_);
  switch (wgm) {
    case 1: return {Wave::phase_correct, 0xFF, false};
    case 2: return {Wave::phase_correct, 0x1FF, false};
    case 3: return {Wave::phase_correct, 0x3FF, false};
    case 4: return {Wave::clear_on_match, ocra, true};
    case 5: return {Wave::fast_pwm, 0xFF, false};
    case 6: return {Wave::fast_pwm, 0x1FF, false};
    case 7: return {Wave::fast_pwm, 0x3FF, false};
    case 8:
    case 10: return {Wave::phase_correct, icr, false};
    case 9:
    case 11: return {Wave::phase_correct, ocra, true};
    case 12: return {Wave::clear_on_match, icr, false};
    case 14: return {Wave::fast_pwm, icr, false};
    case 15: return {Wave::fast_pwm, ocra, true};
    default: return {Wave::normal, 0xFFFF, false};
  }
}

uint32_t Timer::divider() const {
  static constexpr std::array<uint16_t, 8> common{0, 1, 8, 64, 256, 1024, 0, 0};
  static constexpr std::array<uint16_t, 8> timer2{0, 1, 8, 32, 64, 128, 256, 1024};
  const unsigned select = mcu_.data[tccrb_] & 7u;
  return number() == 2 ? timer2[select] : common[select];
}

// ---- counting ----

// Phase: how far the counter is in its period. Rising it is the count; falling, the mirror image.
uint64_t Timer::ticks_until_phase(uint32_t phase) const {
  const uint32_t top = mode_.top;
  if (mode_.wave == Wave::phase_correct) {
    const uint32_t period = top ? 2 * top : 1;
    const uint32_t now = falling_ ? period - std::min(count_, period) : std::min(count_, top);
    const uint32_t distance = (phase % period + period - now % period) % period;
    return distance ? distance : period;
  }
  if (count_ > top) return maximum() - count_ + 1 + phase;  // TOP was moved below the count: on to the maximum first
  const uint32_t period = top + 1;
  const uint32_t distance = (phase % period + period - count_) % period;
  return distance ? distance : period;
}

// Ticks until the event's flag is set; 0 for never.
uint64_t Timer::ticks_until(unsigned event) const {
  const uint32_t top = mode_.top;
  const bool beyond_top = mode_.wave != Wave::phase_correct && count_ > top;
  if (event == overflow) {
    if (mode_.wave == Wave::phase_correct) return ticks_until_phase(1);
    if (mode_.wave == Wave::clear_on_match && top < maximum() && !beyond_top) return 0;
    return ticks_until_phase(0);
  }
  const uint32_t value = compare(event - match_a);
  if (mode_.wave == Wave::phase_correct) {
    if (value > top) return 0;
    return std::min(ticks_until_phase(value + 1), ticks_until_phase(2 * top - value + 1));
  }
  if (beyond_top && value >= count_) return value - count_ + 1;
  if (value > top) return 0;
  return ticks_until_phase(value + 1);
}

void Timer::advance(uint64_t ticks) {
  const uint32_t top = mode_.top;
  if (mode_.wave == Wave::phase_correct) {
    const uint32_t period = top ? 2 * top : 1;
    const uint32_t now = falling_ ? period - std::min(count_, period) : std::min(count_, top);
    const auto phase = static_cast<uint32_t>((now + ticks) % period);
    falling_ = phase > top || (top > 0 && phase == top);
    count_ = phase <= top ? phase : period - phase;
    return;
  }
  if (count_ > top) {
    const uint64_t wrap = maximum() - count_ + 1;
    if (ticks < wrap) {
      count_ += static_cast<uint32_t>(ticks);
      return;
    }
    ticks -= wrap;
    count_ = 0;
  }
  count_ = static_cast<uint32_t>((count_ + ticks) % (uint64_t{top} + 1));
}

// Brings count and flags up to the given cycle.
void Timer::catch_up(uint64_t cycle) {
  if (!divider_) return;
  const uint64_t tick = tick_at(cycle);
  if (tick <= tick_) return;
  const uint64_t elapsed = tick - tick_;
  for (unsigned event = overflow; event <= channels(); ++event) {
    const uint64_t ticks = ticks_until(event);
    if (ticks && ticks <= elapsed) mcu_.data[flags_reg_] |= bit(event);
  }
  advance(elapsed);
  tick_ = tick;
}

// Takes over what the registers say now.
void Timer::configure(uint64_t cycle) {
  divider_ = divider();
  mode_ = mode();
  if (mode_.wave != Wave::phase_correct) falling_ = false;
  if (divider_) {
    has_run_ = true;
    tick_ = tick_at(cycle);
  }
  refresh_interrupts();
  schedule_next();
}

void Timer::restart_prescaler() {
  const uint64_t now = store_ends(mcu_);
  catch_up(now);
  prescaler_origin_ = now;
  configure(now);
}

// ---- interrupts ----

void Timer::refresh_interrupts() {
  const unsigned active = mcu_.data[flags_reg_] & mcu_.data[mask_reg_];
  for (unsigned event = overflow; event <= channels(); ++event)
    interrupts_.set_level(vector(event), active & bit(event));
}

void Timer::schedule_next() {
  uint64_t nearest = 0;
  if (divider_) {
    for (unsigned event = overflow; event <= channels(); ++event) {
      if (!(mcu_.data[mask_reg_] & bit(event))) continue;
      const uint64_t ticks = ticks_until(event);
      if (ticks && (!nearest || ticks < nearest)) nearest = ticks;
    }
  }
  if (nearest) schedule<&Timer::on_event>(mcu_, prescaler_origin_ + (tick_ + nearest) * divider_, *this);
  else cancel<&Timer::on_event>(mcu_, *this);
}

void Timer::on_event(uint64_t when) {
  catch_up(when);
  refresh_interrupts();
  schedule_next();
}

// ---- registers ----

void Timer::write_config(uint16_t reg, uint8_t value) {
  const uint64_t now = store_ends(mcu_);
  catch_up(now);
  mcu_.data[reg] = value;
  configure(now);
}

void Timer::write_high(uint16_t, uint8_t value) { temporary_ = value; }

// TCNT, ICR and OCR; the high byte of a 16-bit register comes out of TEMP.
void Timer::write_low(uint16_t reg, uint8_t value) {
  const uint64_t now = store_ends(mcu_);
  catch_up(now);
  mcu_.data[reg] = value;
  if (wide()) mcu_.data[reg + 1] = temporary_;
  if (reg == tcnt_) {
    count_ = register_value(tcnt_);
    falling_ = false;
  }
  configure(now);
}

void Timer::write_flags(uint16_t reg, uint8_t value) {
  catch_up(store_ends(mcu_));
  mcu_.data[reg] = static_cast<uint8_t>(mcu_.data[reg] & ~bits_written(mcu_, value));
  refresh_interrupts();
  schedule_next();
}

void Timer::write_mask(uint16_t reg, uint8_t value) {
  catch_up(store_ends(mcu_));
  mcu_.data[reg] = value;
  refresh_interrupts();
  schedule_next();
}

uint8_t Timer::read_count(uint16_t reg) {
  catch_up(mcu_.cycle);
  if (wide()) temporary_ = static_cast<uint8_t>(count_ >> 8);
  mcu_.data[reg] = static_cast<uint8_t>(count_);
  return mcu_.data[reg];
}

uint8_t Timer::read_count_high(uint16_t) { return temporary_; }

uint8_t Timer::read_flags(uint16_t reg) {
  catch_up(mcu_.cycle);
  return mcu_.data[reg];
}

// ---- output ----

double Timer::duty(unsigned channel) {
  const TimerMap::Pin& pin = map_.pins[channel];
  const uint16_t pins = port_base(pin.port);
  const unsigned mask = 1u << pin.bit;
  if (!(mcu_.data[pins + 1] & mask)) return 0.0;  // DDR: an input drives nothing
  const unsigned com = mcu_.data[tccra_] >> (6 - 2 * channel) & 3u;
  const Mode now = mode();
  const bool pwm = now.wave == Wave::fast_pwm || now.wave == Wave::phase_correct;
  const bool toggles = com == 1 && (!pwm || (channel == 0 && now.top_is_ocra));
  if (com == 0 || (com == 1 && !toggles)) return (mcu_.data[pins + 2] & mask) ? 1.0 : 0.0;
  if (!divider_) {  // stopped: the output stays as the last match left it
    const bool high = has_run_ && (count_ < compare(channel)) == (com != 3);
    return high ? 1.0 : 0.0;
  }
  if (toggles) return 0.5;
  if (!pwm) return com == 3 ? 1.0 : 0.0;

  const double top = now.top, value = std::min(compare(channel), now.top);
  double high = 0.0;
  if (now.wave == Wave::fast_pwm) high = (value + 1.0) / (top + 1.0);
  else if (now.top > 0) high = value / top;
  return com == 3 ? 1.0 - high : high;
}

}  // namespace board
