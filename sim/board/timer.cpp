// SPDX-License-Identifier: GPL-3.0-or-later
// Counting, flags and interrupts of the timer/counters after the data sheets. A match or overflow flag appears one
// timer clock after the counter reached the value. Not modelled: external clocks, input capture, asynchronous clock,
// the delay of OCR updates in PWM modes.
#include "timer.h"

#include <algorithm>

namespace board {

Timer::Timer(avr_t& avr, avr_timer_t& stock, Interrupts& interrupts)
    : avr_(avr),
      stock_(stock),
      interrupts_(interrupts),
      number_(static_cast<unsigned>(stock.name - '0')),
      channels_(stock.comp[AVR_TIMER_COMPC].r_ocr ? 3 : 2),
      flags_reg_(stock.overflow.raised.reg),
      mask_reg_(stock.overflow.enable.reg) {
  const auto hook_value = [this](uint16_t low, uint16_t high) {
    plain_register(avr_, low);
    on_write<&Timer::write_low>(avr_, low, *this);
    if (!high) return;
    plain_register(avr_, high);
    on_write<&Timer::write_high>(avr_, high, *this);
  };
  for (unsigned channel = 0; channel < channels_; ++channel)
    hook_value(stock_.comp[channel].r_ocr, stock_.comp[channel].r_ocrh);
  hook_value(stock_.r_tcnt, stock_.r_tcnth);
  on_read<&Timer::read_count>(avr_, stock_.r_tcnt, *this);
  if (wide()) {
    hook_value(stock_.r_icr, stock_.r_icrh);
    on_read<&Timer::read_count_high>(avr_, stock_.r_tcnth, *this);
  }
  for (const avr_regbit_t& bit : {stock_.wgm[0], stock_.cs[0]}) {
    const auto config = static_cast<uint16_t>(bit.reg);
    plain_register(avr_, config);
    on_write<&Timer::write_config>(avr_, config, *this);
  }
  plain_register(avr_, flags_reg_);
  on_write<&Timer::write_flags>(avr_, flags_reg_, *this);
  on_read<&Timer::read_flags>(avr_, flags_reg_, *this);
  plain_register(avr_, mask_reg_);
  on_write<&Timer::write_mask>(avr_, mask_reg_, *this);
}

void Timer::reset() {
  prescaler_origin_ = avr_.cycle;
  tick_ = 0;
  count_ = 0;
  falling_ = has_run_ = false;
  mode_ = mode();
  divider_ = 0;
}

// ---- what the registers say ----

uint32_t Timer::register_pair(uint16_t low, uint16_t high) const {
  return avr_.data[low] | (high ? static_cast<uint32_t>(avr_.data[high]) << 8 : 0u);
}

uint32_t Timer::compare(unsigned channel) const {
  return register_pair(stock_.comp[channel].r_ocr, stock_.comp[channel].r_ocrh);
}

Timer::Mode Timer::mode() const {
  const unsigned wgm = avr_regbit_get_array(&avr_, stock_.wgm, 4);
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
  const uint32_t icr = register_pair(stock_.r_icr, stock_.r_icrh);
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
  const unsigned select = avr_.data[stock_.cs[0].reg] & 7u;
  return number_ == 2 ? timer2[select] : common[select];
}

avr_int_vector_t& Timer::vector(unsigned event) {
  return event == overflow ? stock_.overflow : stock_.comp[event - match_a].interrupt;
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
  for (unsigned event = overflow; event <= channels_; ++event) {
    const uint64_t ticks = ticks_until(event);
    if (ticks && ticks <= elapsed) avr_regbit_set(&avr_, vector(event).raised);
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
  const uint64_t now = store_ends(avr_);
  catch_up(now);
  prescaler_origin_ = now;
  configure(now);
}

// ---- interrupts ----

void Timer::refresh_interrupts() {
  const unsigned active = avr_.data[flags_reg_] & avr_.data[mask_reg_];
  for (unsigned event = overflow; event <= channels_; ++event)
    interrupts_.set_level(vector(event), active >> vector(event).raised.bit & 1u);
}

void Timer::schedule_next() {
  uint64_t nearest = 0;
  if (divider_) {
    for (unsigned event = overflow; event <= channels_; ++event) {
      if (!avr_regbit_get(&avr_, vector(event).enable)) continue;
      const uint64_t ticks = ticks_until(event);
      if (ticks && (!nearest || ticks < nearest)) nearest = ticks;
    }
  }
  if (nearest) schedule<&Timer::on_event>(avr_, prescaler_origin_ + (tick_ + nearest) * divider_, *this);
  else cancel<&Timer::on_event>(avr_, *this);
}

avr_cycle_count_t Timer::on_event(avr_cycle_count_t when) {
  catch_up(when);
  refresh_interrupts();
  schedule_next();
  return 0;
}

// ---- registers ----

void Timer::write_config(uint16_t reg, uint8_t value) {
  const uint64_t now = store_ends(avr_);
  catch_up(now);
  avr_.data[reg] = value;
  configure(now);
}

void Timer::write_high(uint16_t, uint8_t value) { temporary_ = value; }

// TCNT, ICR and OCR; the high byte of a 16-bit register comes out of TEMP.
void Timer::write_low(uint16_t reg, uint8_t value) {
  const uint64_t now = store_ends(avr_);
  catch_up(now);
  avr_.data[reg] = value;
  if (wide()) avr_.data[reg + 1] = temporary_;
  if (reg == stock_.r_tcnt) {
    count_ = register_pair(stock_.r_tcnt, stock_.r_tcnth);
    falling_ = false;
  }
  configure(now);
}

void Timer::write_flags(uint16_t reg, uint8_t value) {
  catch_up(store_ends(avr_));
  avr_.data[reg] = static_cast<uint8_t>(avr_.data[reg] & ~bits_written(avr_, value));
  refresh_interrupts();
  schedule_next();
}

void Timer::write_mask(uint16_t reg, uint8_t value) {
  catch_up(store_ends(avr_));
  avr_.data[reg] = value;
  refresh_interrupts();
  schedule_next();
}

uint8_t Timer::read_count(uint16_t reg) {
  catch_up(avr_.cycle);
  if (wide()) temporary_ = static_cast<uint8_t>(count_ >> 8);
  avr_.data[reg] = static_cast<uint8_t>(count_);
  return avr_.data[reg];
}

uint8_t Timer::read_count_high(uint16_t) { return temporary_; }

uint8_t Timer::read_flags(uint16_t reg) {
  catch_up(avr_.cycle);
  return avr_.data[reg];
}

// ---- output ----

double Timer::duty(unsigned channel) {
  const avr_timer_comp_t& output = stock_.comp[channel];
  const uint16_t port = output.com_pin.reg;
  const unsigned mask = 1u << output.com_pin.bit;
  if (!(avr_.data[port - 1] & mask)) return 0.0;  // DDR: an input drives nothing
  const unsigned com = avr_regbit_get(&avr_, output.com);
  const Mode now = mode();
  const bool pwm = now.wave == Wave::fast_pwm || now.wave == Wave::phase_correct;
  const bool toggles = com == 1 && (!pwm || (channel == 0 && now.top_is_ocra));
  if (com == 0 || (com == 1 && !toggles)) return (avr_.data[port] & mask) ? 1.0 : 0.0;
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
