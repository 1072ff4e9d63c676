// Model of the watchdog after the data sheets, section "Watchdog Timer": its own oscillator of 128 kHz, WDE and the
// time guarded by a sequence within four cycles. Another time does not restart the counter: a shorter one may be over
// at once. The fuse WDTON is unprogrammed.
#include "watchdog.h"

#include <algorithm>

namespace board {

namespace {
constexpr uint64_t oscillator_hertz = 128000, shortest = 2048;
constexpr unsigned window_cycles = 4;
}  // namespace

Watchdog::Watchdog(Mcu& mcu, Interrupts& interrupts) : mcu_(mcu), interrupts_(interrupts) {
  interrupts_.connect(mcu.chip.watchdog_vector, {reg::WDTCSR, WDIE, reg::WDTCSR, WDIF});
  on_write<&Watchdog::write_control>(mcu_, reg::WDTCSR, *this);
  mcu_.wdr = action<&Watchdog::restart>(*this);
}

void Watchdog::reset() {
  if (!(mcu_.data[reg::MCUSR] & WDRF)) return;
  control() = WDE;
  count_from(mcu_.cycle);
}

void Watchdog::restart() {
  if (on()) count_from(mcu_.cycle);
}

uint64_t Watchdog::period() const {
  const unsigned control = mcu_.data[reg::WDTCSR], select = (control & WDP) | (control & WDP3 ? 8u : 0u);
  return (shortest << select) * crystal_hertz / oscillator_hertz;
}

void Watchdog::count_from(uint64_t cycle) {
  counts_from_ = cycle;
  wait();
}

void Watchdog::wait() { schedule<&Watchdog::on_time_out>(mcu_, std::max(mcu_.cycle, counts_from_ + period()), *this); }

// With both modes on, the interrupt that is not handled in time, or has switched itself off, is followed by the reset.
void Watchdog::on_time_out(uint64_t cycle) {
  const bool resets = control() & WDE, ignored = control() & WDIF;
  if ((control() & WDIE) && !(resets && ignored)) {
    interrupts_.raise(mcu_.chip.watchdog_vector);  // sets WDIF
    count_from(cycle);
  } else if (resets) {
    mcu_.state = Mcu::State::watchdog_reset;
  }
}

void Watchdog::acknowledge() {
  if (control() & WDE) control() = static_cast<uint8_t>(control() & ~WDIE);
}

void Watchdog::on_window_closed(uint64_t) { control() = static_cast<uint8_t>(control() & ~WDCE); }

void Watchdog::write_control(uint16_t, uint8_t value) {
  const uint8_t old = control();
  const bool was_on = on(), opens = (value & WDCE) && (value & WDE), changes = (old & WDCE) && !(value & WDCE);
  unsigned now = (value & WDIE) | (old & WDIF & ~value);  // WDIF written one clears
  if (changes) now |= value & (WDE | WDP3 | WDP);
  else now |= (value & WDE) | (old & (WDE | WDP3 | WDP));
  if (mcu_.data[reg::MCUSR] & WDRF) now |= WDE;
  if (opens) {
    now |= WDCE;
    schedule<&Watchdog::on_window_closed>(mcu_, store_ends(mcu_) + window_cycles, *this);
  } else {
    cancel<&Watchdog::on_window_closed>(mcu_, *this);
  }
  control() = static_cast<uint8_t>(now);
  interrupts_.set_level(mcu_.chip.watchdog_vector, (now & WDIF) && (now & WDIE));
  if (!on()) cancel<&Watchdog::on_time_out>(mcu_, *this);
  else if (!was_on) count_from(mcu_.cycle);
  else if (changes) wait();
}

}  // namespace board
