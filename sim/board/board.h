// A simulated Arduino: one AVR chip at 16 MHz and 5 V with its peripherals, driven from outside in lock step.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "adc.h"
#include "chip.h"
#include "cpu.h"
#include "eeprom.h"
#include "flash.h"
#include "interrupts.h"
#include "mcu.h"
#include "ports.h"
#include "prescaler.h"
#include "timer.h"
#include "trace.h"
#include "uart.h"
#include "watchdog.h"

namespace board {

enum class RunState : int { running = 0, done = 1, crashed = 2 };

struct Stats {
  uint64_t sleep_cycles = 0;
  uint64_t resets = 0;  // of every cause
  uint64_t watchdog_resets = 0;
};

// A piece of a program: bytes and where they go, in the addresses of avr-gcc's linker.
struct Segment {
  uint32_t address = 0;
  std::string bytes;
};

class Board {
 public:
  explicit Board(const std::string& chip);
  Board(const Board&) = delete;
  Board& operator=(const Board&) = delete;

  // Programming, as a programmer would do it: the reset that follows is up to the caller.
  // `name` stands in the message where a piece has no room; nothing is written then. A bootloader protects itself.
  void write_program(const std::vector<Segment>& segments, const std::string& name, bool bootloader);
  void erase_flash();
  std::string flash() const;

  void power_on(uint64_t seed);
  void power_off(uint64_t seed);
  void reset();  // the RESET pin
  // The supply's voltage from now on; the converter's references follow it. Below its level the brown-out detector
  // holds the chip in reset, and an EEPROM byte being written is torn as the seed says. Far below, memory is lost as
  // well.
  void set_supply(uint32_t millivolts, uint64_t seed);
  bool powered() const { return powered_; }

  // Runs to the first instruction boundary at or after the cycle. Without power only time passes.
  RunState run_until(uint64_t cycle);
  RunState state() const;
  const std::string& crash_reason() const { return mcu_.crash_reason; }

  // Runs a compiled function as if called, interrupts off, and returns its exact cycles, RET included. Arguments and
  // results are in the registers of the ABI (data addresses 0..31), which stay as the function leaves them. Throws if
  // it takes more cycles than limit.
  uint64_t call(uint32_t address, uint64_t limit);

  // Bytes to USART0; without power they are lost.
  void send(const std::string& bytes);

  uint64_t cycle() const { return mcu_.cycle; }
  uint32_t pc() const { return mcu_.pc; }
  void set_pc(uint32_t address) { mcu_.pc = address & (chip_.flash_bytes - 1) & ~1u; }
  bool in_bootloader() const { return mcu_.pc >= boot_start_; }
  std::string peek(uint32_t address, uint32_t count);
  void poke(uint32_t address, const std::string& bytes);

  // Output registered once, read all together. Returns the place of the value in outputs().
  size_t add_duty_output(unsigned timer, const std::string& channel);
  size_t add_pin_output(const std::string& port, unsigned bit);
  size_t output_count() const { return outputs_.size(); }
  void read_outputs(double* values);
  double duty(unsigned timer, const std::string& channel);
  bool pin(const std::string& port, unsigned bit) const;

  // Input from outside: see Ports.
  void hold_pin(const std::string& port, unsigned bit, bool high);
  void let_pin_go(const std::string& port, unsigned bit);

  const Chip& chip() const { return chip_; }
  Uart& uart() { return uart_; }
  Adc& adc() { return adc_; }
  Eeprom& eeprom() { return eeprom_; }
  const Flash& flash_model() const { return flash_; }
  const Interrupts& interrupts() const { return interrupts_; }
  const Stats& stats() const { return stats_; }
  uint64_t trace_hash() const { return trace_.hash(); }

 private:
  struct Output {
    Timer* timer = nullptr;  // a duty, or else a pin
    unsigned channel = 0;
    uint16_t port = 0;
    unsigned bit = 0;
  };

  void restart(uint8_t cause);
  void step();
  void sleep();
  bool ended() const { return state() != RunState::running; }
  void on_stop(uint64_t) {}
  Output find_duty(unsigned timer, const std::string& channel);
  Output find_pin(const std::string& port, unsigned bit) const;
  void require_memory(uint32_t address, size_t count) const;

  const Chip& chip_;
  Mcu mcu_;
  Trace trace_;
  Cpu cpu_;
  Interrupts interrupts_;
  Watchdog watchdog_;
  Ports ports_;
  Uart uart_;
  Adc adc_;
  Eeprom eeprom_;
  Flash flash_;
  std::deque<Timer> timers_;
  Prescaler prescaler_;
  std::vector<Output> outputs_;
  Stats stats_;
  uint32_t boot_start_ = UINT32_MAX;
  uint64_t stop_at_ = 0;
  bool powered_ = false;
  bool browned_out_ = false;  // powered, but held in reset
};

}  // namespace board
