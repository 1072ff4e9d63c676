// See board.h. The order of all within a slice is fixed, so that the same bytes and voltages give the same frames.
#include "board.h"

#include <app.h>
#include <web/web_hal.h>

#include <algorithm>
#include <cmath>
#include <new>

namespace greywhale::web {
namespace {

constexpr unsigned kSlices = 4;
constexpr unsigned kSliceUs = 250;
constexpr unsigned kBytes = 25;      // a slice each way: 1 Mbaud
constexpr unsigned kPieceUs = 60;    // what a piece of the firmware's work is taken to last
constexpr double kReference = 5000;  // mV, of the converter
constexpr double kTrackOhm = 10e3, kPullUpOhm = 35e3;

// As in hal/avr/tick.cpp: each tick's chain of conversions starts 132 us after the tick, a conversion takes 26 us and
// samples its input 3 us after its start; the followers come first.
constexpr unsigned sampled_us(unsigned conversion) { return 132 + 26 * conversion + 3; }
constexpr unsigned kFirstPot = hal::pot_count - hal::joint_count;

// The voltage of two wipers' wires that touch, with the pull-up of one input on: see sim/board/adc.cpp.
double pulled_up(double millivolts) {
  const double share = millivolts / kReference, source = kTrackOhm * share * (1.0 - share) / 2.0;
  return millivolts + (kReference - millivolts) * source / (source + kPullUpOhm);
}

alignas(app::App) unsigned char storage[sizeof(app::App)];
app::App* arm = nullptr;

}  // namespace

void Board::power_on(hal::ResetCause cause) {
  hal::web::power_on(cause);
  powered_ = true;
  ++starts_;
  slice_ = converted_ = 0;
  to_board_.clear();
  arm = new (storage) app::App;
  arm->begin();
}

void Board::power_off() {
  hal::web::power_off();
  powered_ = false;
  to_board_.clear();
}

void Board::run_slice(const Millivolts& millivolts, unsigned floating, unsigned joined) {
  if (!powered_) return to_board_.clear();
  if (slice_ == 0 && converted_ == hal::web::conversions) {
    tick();
    probe(before_, floating, joined);
  }
  convert(millivolts, floating);
  move_bytes();
  work();
  before_ = millivolts;
  slice_ = (slice_ + 1) % kSlices;
}

void Board::tick() {
  converted_ = 0;
  hal::web::start_tick();
  hal::web::set_age(0);
  hal::run_tick();
}

void Board::convert(const Millivolts& millivolts, unsigned floating) {
  const unsigned end_us = (slice_ + 1) * kSliceUs;
  for (; converted_ < hal::web::conversions && sampled_us(converted_) < end_us; ++converted_) {
    const unsigned pot = (kFirstPot + converted_) % hal::pot_count;
    if (!(floating >> pot & 1u)) charge_ = millivolts[pot];
    hal::web::convert(static_cast<std::uint8_t>(pot), count());
  }
}

// After ground, the pot that the tick has chosen, with the pull-ups of all others on.
void Board::probe(const Millivolts& millivolts, unsigned floating, unsigned joined) {
  const unsigned pot = hal::web::probed();
  charge_ = floating >> pot & 1u ? 0.0 : millivolts[pot];
  if (joined >> pot & 1u) charge_ = pulled_up(charge_);
  hal::web::probe(count());
}

unsigned Board::count() const { return static_cast<unsigned>(std::clamp(charge_ * 1024.0 / kReference, 0.0, 1023.0)); }

void Board::move_bytes() {
  for (unsigned left = kBytes; left && !to_board_.empty(); --left) {
    hal::web::receive(to_board_.front());
    to_board_.pop_front();
  }
  std::uint8_t byte = 0;
  for (unsigned left = kBytes; left && hal::web::take_sent(byte); --left) said_.push_back(byte);
}

void Board::work() {
  for (unsigned us = slice_ * kSliceUs; us < (slice_ + 1) * kSliceUs; us += kPieceUs) {
    hal::web::set_age(static_cast<std::uint16_t>(us));
    if (!arm->service()) return;
  }
}

}  // namespace greywhale::web

extern "C" void firmware_tick() { greywhale::web::arm->tick(); }
