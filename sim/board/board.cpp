// SPDX-License-Identifier: GPL-3.0-or-later
// The board: builds chip and models, resets them, and runs the CPU between events.
#include "board.h"

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "error.h"
#include "random.h"

namespace board {

namespace {

constexpr uint32_t crystal_hertz = 16000000;
constexpr uint32_t supply_millivolts = 5000;
// The detector's level by the fuses of an Arduino, and its hysteresis (data sheet, typical). Below the last one the
// power-on reset acts.
constexpr uint32_t brown_out_millivolts = 2700, hysteresis_millivolts = 50, memory_millivolts = 1100;
constexpr avr_cycle_count_t longest_run = 1000000000;             // events bound a run of the CPU, nothing else
constexpr uint32_t eeprom_base = 0x810000, fuse_base = 0x820000;  // where avr-gcc's linker puts other memories
constexpr uint8_t sleep_enable = 0x01;

// simavr reports through one logger for all boards; an error is kept as the reason of a crash.
void keep_error(avr_t* avr, const int level, const char* format, va_list arguments) {
  if (level > LOG_ERROR || !avr || !avr->custom.data) return;
  char text[300];
  std::vsnprintf(text, sizeof text, format, arguments);
  std::string& kept = hooks_of(*avr).last_error;
  if (kept.empty()) kept = text;
}

std::string hex(uint32_t value) {
  char text[16];
  std::snprintf(text, sizeof text, "0x%X", value);
  return text;
}

}  // namespace

void Board::FreeAvr::operator()(avr_t* avr) const {
  avr->custom.data = nullptr;
  avr_terminate(avr);
  std::free(avr);
}

Board::Board(const std::string& chip) : chip_(find_chip(chip)) {
  avr_global_logger_set(keep_error);
  avr_t* avr = avr_make_mcu_by_name(chip_.name);
  if (!avr) throw BoardError("this libsimavr does not know the " + chip + "; install Debian's libsimavr-dev 1.6");
  avr_init(avr);
  avr_.reset(avr);
  avr->custom.data = &hooks_;
  avr->frequency = crystal_hertz;
  avr->vcc = avr->avcc = avr->aref = supply_millivolts;
  avr->log = LOG_ERROR;
  normal_run_ = avr->run;
  build_models();
  restart(0);
}

Board::~Board() = default;

void Board::build_models() {
  avr_t& avr = *avr_;
  cpu_ = std::make_unique<Cpu>(avr, chip_);
  interrupts_ = std::make_unique<Interrupts>(avr, chip_, trace_);
  ports_ = std::make_unique<Ports>(avr, chip_);
  std::vector<Timer*> timers;
  for (avr_io_t* io = avr.io_port; io; io = io->next) {
    if (!std::strcmp(io->kind, "uart")) {
      auto& stock = *reinterpret_cast<avr_uart_t*>(io);
      stock.flags = 0;  // no usleep() when the program polls
      if (stock.name == '0') uart_ = std::make_unique<Uart>(avr, stock, *interrupts_, trace_);
    } else if (!std::strcmp(io->kind, "eeprom")) {
      eeprom_ = std::make_unique<Eeprom>(avr, *reinterpret_cast<avr_eeprom_t*>(io), *interrupts_, trace_);
    } else if (!std::strcmp(io->kind, "watchdog")) {
      watchdog_ = reinterpret_cast<avr_watchdog_t*>(io);
    } else if (!std::strcmp(io->kind, "timer")) {
      timers_.push_back(std::make_unique<Timer>(avr, *reinterpret_cast<avr_timer_t*>(io), *interrupts_));
      timers.push_back(timers_.back().get());
    }
  }
  if (!uart_ || !eeprom_ || !watchdog_ || timers_.empty())
    throw BoardError("this libsimavr lacks peripherals of the " + std::string(chip_.title) +
                     "; install Debian's libsimavr-dev 1.6");
  adc_ = std::make_unique<Adc>(avr, chip_, *interrupts_);
  flash_ = std::make_unique<Flash>(avr, chip_, *cpu_, trace_);
  prescaler_ = std::make_unique<Prescaler>(avr, std::move(timers));
}

// ---- programming ----

void Board::write_program(const std::vector<Segment>& segments, const std::string& name, bool bootloader) {
  const uint32_t flash_size = avr_->flashend + 1;
  std::string eeprom = eeprom_->content();
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
      std::copy(segment.bytes.begin(), segment.bytes.end(), avr_->flash + segment.address);
  cpu_->flash_changed(0, flash_size);
  eeprom_->set_content(eeprom);
  if (!bootloader) return;
  const auto lowest = std::min_element(segments.begin(), segments.end(),
                                       [](const Segment& a, const Segment& b) { return a.address < b.address; });
  boot_start_ = lowest->address;
  avr_->reset_pc = boot_start_;
  flash_->protect_from(boot_start_);
}

void Board::erase_flash() {
  std::fill_n(avr_->flash, avr_->flashend + 1, uint8_t{0xFF});
  cpu_->flash_changed(0, avr_->flashend + 1);
  boot_start_ = UINT32_MAX;
  avr_->reset_pc = 0;
  flash_->protect_from(UINT32_MAX);
}

std::string Board::flash() const { return {reinterpret_cast<const char*>(avr_->flash), avr_->flashend + 1}; }

// ---- power and reset ----

// Every reset comes through here. MCUSR collects causes until the program or a loss of power clears it. While it holds
// the watchdog's, every reset starts the watchdog at its shortest time.
void Board::restart(uint8_t cause) {
  avr_t& avr = *avr_;
  const auto flags = static_cast<uint8_t>(cause == PORF ? PORF : avr.data[reg::MCUSR] | cause);
  watchdog_->reset_context = {static_cast<uint8_t>(flags & WDRF), normal_run_};
  avr_reset(&avr);  // also forgets all events
  avr.run_cycle_limit = longest_run;
  avr.data[reg::MCUSR] = flags;
  hooks_.last_error.clear();
  interrupts_->reset();
  for (auto& timer : timers_) timer->reset();
  adc_->reset();
  flash_->reset();
  eeprom_->reset();
  uart_->reset();
  if (stop_at_ > avr.cycle) schedule<&Board::on_stop>(avr, stop_at_, *this);
  trace_.add(Trace::Kind::reset, avr.cycle, flags);
}

void Board::power_on(uint64_t seed) {
  Random random(seed);
  avr_t& avr = *avr_;
  for (uint32_t address = 0; address <= avr.ramend; ++address)
    if (address < 32 || address > avr.ioend) avr.data[address] = static_cast<uint8_t>(random.next());
  powered_ = true;
  browned_out_ = false;
  ++stats_.resets;
  restart(PORF);
}

void Board::power_off(uint64_t seed) {
  eeprom_->lose_power(seed);
  uart_->drop_pending();
  restart(0);
  powered_ = false;
}

void Board::set_supply(uint32_t millivolts, uint64_t seed) {
  avr_->vcc = avr_->avcc = avr_->aref = millivolts;
  const bool enough = millivolts >= brown_out_millivolts + hysteresis_millivolts;
  if (!powered_) {
    if (enough) power_on(seed);
  } else if (millivolts < memory_millivolts) {
    power_off(seed);
  } else if (millivolts < brown_out_millivolts && !browned_out_) {
    eeprom_->lose_power(seed);
    uart_->drop_pending();
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
  avr_t& avr = *avr_;
  if (avr.run != normal_run_) {  // simavr's watchdog asks for a reset this way
    ++stats_.resets;
    ++stats_.watchdog_resets;
    restart(WDRF);
    return;
  }
  avr_flashaddr_t next_pc = avr.pc;
  if (avr.state == cpu_Running) next_pc = reference_decoder_ ? avr_run_one(&avr) : cpu_->run();
  const bool asleep = avr.state == cpu_Sleeping;
  const avr_cycle_count_t idle = avr_cycle_timer_process(&avr);
  avr.pc = next_pc;
  if (avr.state == cpu_Sleeping) {
    if (!avr.sreg[S_I]) {
      avr.state = cpu_Done;
    } else if (!(avr.data[reg::SMCR] & sleep_enable)) {
      avr.state = cpu_Running;
    } else {
      const avr_cycle_count_t wake_at = std::min(avr.cycle + idle, std::max(avr.cycle, stop_at_));
      stats_.sleep_cycles += wake_at - avr.cycle;
      avr.cycle = wake_at;
    }
    return;
  }
  if (avr.interrupt_state && interrupts_->service(asleep)) {
    uart_->refresh_interrupts();
    eeprom_->refresh_interrupt();
  }
}

RunState Board::run_until(uint64_t cycle) {
  avr_t& avr = *avr_;
  if (!powered_ || browned_out_) {
    avr.cycle = std::max(avr.cycle, cycle);
    return RunState::running;
  }
  if (avr.cycle >= cycle || ended()) return state();
  stop_at_ = cycle;
  schedule<&Board::on_stop>(avr, cycle, *this);
  while (avr.cycle < cycle && !ended()) step();
  stop_at_ = 0;
  return state();
}

RunState Board::state() const {
  if (avr_->state == cpu_Done) return RunState::done;
  return avr_->state == cpu_Crashed ? RunState::crashed : RunState::running;
}

uint64_t Board::call(uint32_t address, uint64_t limit) {
  avr_t& avr = *avr_;
  if (!powered_) throw BoardError("the board has no power; call power_on() before call()");
  if (address > avr.flashend) throw BoardError("there is no function at " + hex(address) + "; the flash ends before");
  const avr_flashaddr_t back = avr.pc;
  const int state = avr.state;
  std::array<uint8_t, 8> flags;
  std::copy_n(avr.sreg, flags.size(), flags.begin());
  const auto stack = static_cast<uint16_t>(avr.data[reg::SPL] | avr.data[reg::SPH] << 8);
  const avr_flashaddr_t return_address = avr.flashend - 1;

  avr_sreg_set(&avr, S_I, 0);
  avr.data[1] = 0;  // the ABI's zero register
  avr.state = cpu_Running;
  avr.pc = return_address;
  _avr_push_addr(&avr, return_address);
  avr.pc = address;
  avr.run_cycle_limit = 1;
  const uint64_t start = avr.cycle;
  while (avr.pc != return_address && avr.cycle - start <= limit && avr.state == cpu_Running) {
    avr.run_cycle_count = 1;
    step();
  }
  const uint64_t cycles = avr.cycle - start;
  const bool returned = avr.pc == return_address;
  const bool crashed = avr.state == cpu_Crashed;

  avr.run_cycle_limit = longest_run;
  avr.run_cycle_count = 1;
  avr.pc = back;
  avr.data[reg::SPL] = static_cast<uint8_t>(stack);
  avr.data[reg::SPH] = static_cast<uint8_t>(stack >> 8);
  if (!crashed) avr.state = state;
  for (uint8_t bit = 0; bit < flags.size(); ++bit) avr_sreg_set(&avr, bit, flags[bit]);
  if (crashed) throw BoardError("the function at " + hex(address) + " crashed: " + crash_reason());
  if (!returned)
    throw BoardError("the function at " + hex(address) + " did not return within " + std::to_string(limit) + " cycles");
  return cycles;
}

void Board::send(const std::string& bytes) {
  if (powered_ && !browned_out_) uart_->send(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size());
}

// ---- memory ----

void Board::require_memory(uint32_t address, size_t count) const {
  const size_t end = avr_->ramend + size_t{1};
  if (address > end || count > end - address)
    throw BoardError("data addresses " + hex(address) + " .. " + hex(static_cast<uint32_t>(address + count)) +
                     " do not all exist; the " + chip_.title + " has 0 .. " + hex(avr_->ramend));
}

std::string Board::peek(uint32_t address, uint32_t count) {
  require_memory(address, count);
  unsigned sreg = 0;  // simavr keeps the bits apart
  for (unsigned bit = 0; bit < 8; ++bit) sreg |= static_cast<unsigned>(avr_->sreg[bit] & 1u) << bit;
  avr_->data[reg::SREG] = static_cast<uint8_t>(sreg);
  return {reinterpret_cast<const char*>(avr_->data) + address, count};
}

void Board::poke(uint32_t address, const std::string& bytes) {
  require_memory(address, bytes.size());
  std::copy(bytes.begin(), bytes.end(), avr_->data + address);
  if (address <= reg::SREG && address + bytes.size() > reg::SREG)
    for (uint8_t bit = 0; bit < 8; ++bit)
      avr_sreg_set(avr_.get(), bit, static_cast<uint8_t>(avr_->data[reg::SREG] >> bit & 1));
}

// ---- outputs ----

Board::Output Board::find_duty(unsigned number, const std::string& channel) {
  for (auto& timer : timers_) {
    if (timer->number() != number) continue;
    const unsigned index = channel.size() == 1 ? static_cast<unsigned>(channel[0] - 'A') : timer->channels();
    if (index < timer->channels()) return {timer.get(), index, 0, 0};
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
                             : static_cast<double>(ports_->driven_high(output.port, output.bit));
}

double Board::duty(unsigned timer, const std::string& channel) {
  const Output output = find_duty(timer, channel);
  return output.timer->duty(output.channel);
}

bool Board::pin(const std::string& port, unsigned bit) const {
  const Output output = find_pin(port, bit);
  return ports_->driven_high(output.port, output.bit);
}

void Board::hold_pin(const std::string& port, unsigned bit, bool high) {
  const Output pin = find_pin(port, bit);
  ports_->hold(pin.port, pin.bit, high);
}

void Board::let_pin_go(const std::string& port, unsigned bit) {
  const Output pin = find_pin(port, bit);
  ports_->let_go(pin.port, pin.bit);
}

}  // namespace board
