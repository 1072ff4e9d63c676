// The board: builds chip and models, resets them, and runs the CPU between events.
#include "board.h"

#include <algorithm>
#include <cstdio>

#include "error.h"
#include "random.h"

namespace board {

namespace {

constexpr uint32_t supply_millivolts = 5000;
// The detector's level by the fuses of an Arduino, and its hysteresis (data sheet, typical). Below the last one the
// power-on reset acts.
constexpr uint32_t brown_out_millivolts = 2700, hysteresis_millivolts = 50, memory_millivolts = 1100;
constexpr uint32_t eeprom_base = 0x810000, fuse_base = 0x820000;  // where avr-gcc's linker puts other memories

std::string hex(uint32_t value) {
  char text[16];
  std::snprintf(text, sizeof text, "0x%X", value);
  return text;
}

}  // namespace

Board::Board(const std::string& chip)
    : chip_(find_chip(chip)),
      mcu_(chip_),
      cpu_(mcu_),
      interrupts_(mcu_, trace_),
      watchdog_(mcu_, interrupts_),
      ports_(mcu_, chip_),
      uart_(mcu_, interrupts_, trace_),
      adc_(mcu_, chip_, interrupts_),
      eeprom_(mcu_, interrupts_, trace_),
      flash_(mcu_, chip_, cpu_, trace_),
      prescaler_(mcu_, timers_) {
  for (unsigned i = 0; i < chip_.timer_count; ++i) timers_.emplace_back(mcu_, chip_.timers[i], interrupts_);
  mcu_.supply_millivolts = supply_millivolts;
  restart(PORF);
}

// ---- programming ----

void Board::write_program(const std::vector<Segment>& segments, const std::string& name, bool bootloader) {
  const uint32_t flash_size = chip_.flash_bytes;
  std::string eeprom = eeprom_.content();
  for (const Segment& segment : segments) {
    const size_t size = segment.bytes.size();
    if (segment.address >= fuse_base) continue;  // fuses, lock bits, signature: fixed here
    const bool in_eeprom = segment.address >= eeprom_base;
    const uint32_t at = in_eeprom ? segment.address - eeprom_base : segment.address;
    const size_t room = in_eeprom ? eeprom.size() : flash_size;
    if (at > room || size > room - at)
      throw BoardError(name + " has bytes up to address " + hex(static_cast<uint32_t>(segment.address + size - 1)) +
                       ", but the " + chip_.title + " has " + std::to_string(room / 1024) + " KB of " +
                       (in_eeprom ? "EEPROM" : "flash") + "; build it for this chip");
    if (in_eeprom) eeprom.replace(at, size, segment.bytes);
  }
  for (const Segment& segment : segments)
    if (segment.address < flash_size)
      std::copy(segment.bytes.begin(), segment.bytes.end(), mcu_.flash.data() + segment.address);
  cpu_.flash_changed(0, flash_size);
  eeprom_.set_content(eeprom);
  if (!bootloader) return;
  const auto lowest = std::min_element(segments.begin(), segments.end(),
                                       [](const Segment& a, const Segment& b) { return a.address < b.address; });
  boot_start_ = lowest->address;
  mcu_.reset_vector = boot_start_;
  flash_.protect_from(boot_start_);
}

void Board::erase_flash() {
  std::fill(mcu_.flash.begin(), mcu_.flash.end(), uint8_t{0xFF});
  cpu_.flash_changed(0, chip_.flash_bytes);
  boot_start_ = UINT32_MAX;
  mcu_.reset_vector = 0;
  flash_.protect_from(UINT32_MAX);
}

std::string Board::flash() const { return {reinterpret_cast<const char*>(mcu_.flash.data()), mcu_.flash.size()}; }

// ---- power and reset ----

// Every reset comes through here. MCUSR collects causes until the program or a loss of power clears it. While it holds
// the watchdog's, every reset starts the watchdog at its shortest time.
void Board::restart(uint8_t cause) {
  const auto flags = static_cast<uint8_t>(cause == PORF ? PORF : mcu_.data[reg::MCUSR] | cause);
  mcu_.reset();  // also forgets all events
  mcu_.data[reg::MCUSR] = flags;
  watchdog_.reset();
  interrupts_.reset();
  for (auto& timer : timers_) timer.reset();
  adc_.reset();
  flash_.reset();
  eeprom_.reset();
  uart_.reset();
  if (stop_at_ > mcu_.cycle) schedule<&Board::on_stop>(mcu_, stop_at_, *this);
  trace_.add(Trace::Kind::reset, mcu_.cycle, flags);
}

void Board::power_on(uint64_t seed) {
  Random random(seed);
  for (uint32_t address = 0; address <= chip_.ram_end; ++address)
    if (address < first_register || address >= chip_.first_ram)
      mcu_.data[address] = static_cast<uint8_t>(random.next());
  powered_ = true;
  browned_out_ = false;
  ++stats_.resets;
  restart(PORF);
}

void Board::power_off(uint64_t seed) {
  eeprom_.lose_power(seed);
  uart_.drop_pending();
  restart(0);
  powered_ = false;
}

void Board::set_supply(uint32_t millivolts, uint64_t seed) {
  mcu_.supply_millivolts = millivolts;
  const bool enough = millivolts >= brown_out_millivolts + hysteresis_millivolts;
  if (!powered_) {
    if (enough) power_on(seed);
  } else if (millivolts < memory_millivolts) {
    power_off(seed);
  } else if (millivolts < brown_out_millivolts && !browned_out_) {
    eeprom_.lose_power(seed);
    uart_.drop_pending();
    restart(BORF);
    browned_out_ = true;
  } else if (browned_out_ && enough) {
    browned_out_ = false;
    ++stats_.resets;
    restart(BORF);
  }
}

void Board::reset() {
  if (!powered_ || browned_out_) return;
  ++stats_.resets;
  restart(EXTRF);
}

// ---- running ----

// One turn: instructions until something is due, then the events, then an interrupt.
void Board::step() {
  if (mcu_.state == Mcu::State::watchdog_reset) {
    ++stats_.resets;
    ++stats_.watchdog_resets;
    restart(WDRF);
    return;
  }
  if (mcu_.state == Mcu::State::running) cpu_.run();
  const bool asleep = mcu_.state == Mcu::State::asleep;
  mcu_.events.run(mcu_.cycle);
  if (mcu_.state == Mcu::State::asleep) sleep();
  else if (mcu_.state == Mcu::State::running && interrupts_.service(asleep) == chip_.watchdog_vector)
    watchdog_.acknowledge();
}

// Without interrupts nothing but a reset wakes the CPU, and of resets only the watchdog's comes by itself.
void Board::sleep() {
  if (!mcu_.flags[flag::I] && !watchdog_.resets()) {
    mcu_.state = Mcu::State::done;
    return;
  }
  const uint64_t wake_at = std::min(mcu_.events.next(), std::max(mcu_.cycle, stop_at_));
  stats_.sleep_cycles += wake_at - mcu_.cycle;
  mcu_.cycle = wake_at;
}

RunState Board::run_until(uint64_t cycle) {
  if (!powered_ || browned_out_) {
    mcu_.cycle = std::max(mcu_.cycle, cycle);
    return RunState::running;
  }
  if (mcu_.cycle >= cycle || ended()) return state();
  stop_at_ = cycle;
  schedule<&Board::on_stop>(mcu_, cycle, *this);
  while (mcu_.cycle < cycle && !ended()) step();
  stop_at_ = 0;
  return state();
}

RunState Board::state() const {
  if (mcu_.state == Mcu::State::done) return RunState::done;
  return mcu_.state == Mcu::State::crashed ? RunState::crashed : RunState::running;
}

uint64_t Board::call(uint32_t address, uint64_t limit) {
  if (!powered_) throw BoardError("the board has no power; call power_on() before call()");
  if (address >= chip_.flash_bytes)
    throw BoardError("there is no function at " + hex(address) + "; the flash ends before");
  const uint32_t back = mcu_.pc, return_address = chip_.flash_bytes - 2;
  const Mcu::State state = mcu_.state;
  const uint8_t sreg = mcu_.sreg();
  const std::array<uint8_t, 2> stack{mcu_.data[reg::SPL], mcu_.data[reg::SPH]};

  mcu_.set_interrupt_flag(false);
  mcu_.data[1] = 0;  // the ABI's zero register
  mcu_.state = Mcu::State::running;
  mcu_.push_address(return_address);
  mcu_.pc = address;
  const uint64_t start = mcu_.cycle;
  while (mcu_.pc != return_address && mcu_.cycle - start <= limit && mcu_.state == Mcu::State::running) {
    schedule<&Board::on_stop>(mcu_, mcu_.cycle + 1, *this);  // instruction by instruction
    step();
  }
  const uint64_t cycles = mcu_.cycle - start;
  const bool returned = mcu_.pc == return_address;
  const bool crashed = mcu_.state == Mcu::State::crashed;

  mcu_.pc = back;
  mcu_.data[reg::SPL] = stack[0];
  mcu_.data[reg::SPH] = stack[1];
  if (mcu_.state < Mcu::State::crashed) mcu_.state = state;
  mcu_.set_sreg(sreg);
  if (crashed) throw BoardError("the function at " + hex(address) + " crashed: " + crash_reason());
  if (!returned)
    throw BoardError("the function at " + hex(address) + " did not return within " + std::to_string(limit) + " cycles");
  return cycles;
}

void Board::send(const std::string& bytes) {
  if (powered_ && !browned_out_) uart_.send(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size());
}

// ---- memory ----

void Board::require_memory(uint32_t address, size_t count) const {
  const size_t end = chip_.ram_end + size_t{1};
  if (address > end || count > end - address)
    throw BoardError("data addresses " + hex(address) + " .. " + hex(static_cast<uint32_t>(address + count)) +
                     " do not all exist; the " + chip_.title + " has 0 .. " + hex(chip_.ram_end));
}

std::string Board::peek(uint32_t address, uint32_t count) {
  require_memory(address, count);
  mcu_.data[reg::SREG] = mcu_.sreg();
  return {reinterpret_cast<const char*>(mcu_.data.data()) + address, count};
}

void Board::poke(uint32_t address, const std::string& bytes) {
  require_memory(address, bytes.size());
  std::copy(bytes.begin(), bytes.end(), mcu_.data.data() + address);
  if (address <= reg::SREG && address + bytes.size() > reg::SREG) mcu_.set_sreg(mcu_.data[reg::SREG]);
}

// ---- outputs ----

Board::Output Board::find_duty(unsigned number, const std::string& channel) {
  for (auto& timer : timers_) {
    if (timer.number() != number) continue;
    const unsigned index = channel.size() == 1 ? static_cast<unsigned>(channel[0] - 'A') : timer.channels();
    if (index < timer.channels()) return {&timer, index, 0, 0};
  }
  throw BoardError("the " + std::string(chip_.title) + " has no output OC" + std::to_string(number) + channel +
                   "; channels are A, B and on some timers C");
}

Board::Output Board::find_pin(const std::string& port, unsigned bit) const {
  if (port.size() != 1 || bit > 7 || !Ports::exists(chip_, port[0]))
    throw BoardError("the " + std::string(chip_.title) + " has no pin P" + port + std::to_string(bit) +
                     "; its ports are " + chip_.ports + ", bits 0 to 7");
  return {nullptr, 0, port_base(port[0]), bit};
}

size_t Board::add_duty_output(unsigned timer, const std::string& channel) {
  outputs_.push_back(find_duty(timer, channel));
  return outputs_.size() - 1;
}

size_t Board::add_pin_output(const std::string& port, unsigned bit) {
  outputs_.push_back(find_pin(port, bit));
  return outputs_.size() - 1;
}

void Board::read_outputs(double* values) {
  for (const Output& output : outputs_)
    *values++ = output.timer ? output.timer->duty(output.channel)
                             : static_cast<double>(ports_.driven_high(output.port, output.bit));
}

double Board::duty(unsigned timer, const std::string& channel) {
  const Output output = find_duty(timer, channel);
  return output.timer->duty(output.channel);
}

bool Board::pin(const std::string& port, unsigned bit) const {
  const Output output = find_pin(port, bit);
  return ports_.driven_high(output.port, output.bit);
}

void Board::hold_pin(const std::string& port, unsigned bit, bool high) {
  const Output pin = find_pin(port, bit);
  ports_.hold(pin.port, pin.bit, high);
}

void Board::let_pin_go(const std::string& port, unsigned bit) {
  const Output pin = find_pin(port, bit);
  ports_.let_go(pin.port, pin.bit);
}

}  // namespace board
