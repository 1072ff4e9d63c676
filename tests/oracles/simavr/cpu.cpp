// Stands for sim/board/cpu.cpp: a Cpu that executes each instruction with simavr's own decoder. Memories are shared;
// registers, time and the instructions that concern a peripheral go to the board's models.
#include "cpu.h"

#include <algorithm>
#include <map>

extern "C" {
#include <simavr/avr_flash.h>
#include <simavr/avr_watchdog.h>
#include <simavr/sim_avr.h>
#include <simavr/sim_core.h>
}

namespace board {

namespace {

constexpr unsigned reti = 0x9518;

struct Simavr {
  avr_t* avr = nullptr;
  avr_io_t requests{};
  Mcu* mcu = nullptr;
  bool ready = false;

  void hand_over() const {
    std::copy_n(avr->sreg, mcu->flags.size(), mcu->flags.begin());
    mcu->cycle = avr->cycle;
  }
};

Simavr& simavr_of(const avr_t* avr) { return *static_cast<Simavr*>(avr->custom.data); }

uint8_t read_register(avr_t* avr, avr_io_addr_t address, void*) {
  const Simavr& self = simavr_of(avr);
  self.hand_over();
  const uint8_t value = self.mcu->read(address);
  avr->cycle = self.mcu->cycle;
  return value;
}

void write_register(avr_t* avr, avr_io_addr_t address, uint8_t value, void*) {
  const Simavr& self = simavr_of(avr);
  self.hand_over();
  self.mcu->write(address, value);
  avr->cycle = self.mcu->cycle;
}

// SPM and WDR.
int request(avr_io_t* port, uint32_t what, void*) {
  const Simavr& self = simavr_of(port->avr);
  self.hand_over();
  if (what == AVR_IOCTL_FLASH_SPM) self.mcu->spm();
  else if (what == AVR_IOCTL_WATCHDOG_RESET) self.mcu->wdr();
  port->avr->cycle = self.mcu->cycle;
  return 0;
}

void say_nothing(avr_t*, const int, const char*, va_list) {}

// Cpu has no place for it, and is not to have one.
std::map<const Mcu*, Simavr>& all() {
  static std::map<const Mcu*, Simavr> each;
  return each;
}

// Every register goes to the models that are there by the first instruction.
void replace_registers(Simavr& self) {
  for (unsigned i = 0; i < MAX_IOs; ++i) {
    const bool exists = i < self.mcu->registers.size();
    auto& stock = self.avr->io[i];
    stock.r = {nullptr, exists && self.mcu->registers[i].read ? read_register : nullptr};
    stock.w = {nullptr, exists && self.mcu->registers[i].write ? write_register : nullptr};
    stock.irq = nullptr;
  }
  self.ready = true;
}

}  // namespace

Cpu::Cpu(Mcu& mcu) : mcu_(mcu), decoder_(nullptr, 1, false), mask_(0), wide_pc_(mcu.chip.wide_pc) {
  avr_global_logger_set(say_nothing);
  Simavr& self = all()[&mcu] = {};
  self.mcu = &mcu;
  self.avr = avr_make_mcu_by_name(mcu.chip.name);
  avr_init(self.avr);
  self.avr->custom.data = &self;
  self.avr->data = mcu.data.data();
  self.avr->flash = mcu.flash.data();
  self.requests.kind = "requests";
  self.requests.ioctl = request;
  avr_register_io(self.avr, &self.requests);
}

void Cpu::flash_changed(uint32_t, uint32_t) {}

void Cpu::run() {
  Simavr& self = all().at(&mcu_);
  if (!self.ready) replace_registers(self);
  avr_t& avr = *self.avr;
  avr.pc = mcu_.pc;
  avr.cycle = mcu_.cycle;
  avr.state = cpu_Running;
  avr.interrupt_state = 0;
  avr.run_cycle_count = avr.run_cycle_limit = 1;
  std::copy_n(mcu_.flags.begin(), mcu_.flags.size(), avr.sreg);
  const uint8_t interrupts_before = mcu_.flags[flag::I];
  const bool returns = (mcu_.flash[mcu_.pc] | mcu_.flash[mcu_.pc + 1] << 8) == reti;

  const avr_flashaddr_t next = avr_run_one(&avr);
  if (returns) mcu_.reti();
  self.hand_over();
  mcu_.flags[flag::I] = interrupts_before;
  mcu_.set_interrupt_flag(avr.sreg[S_I]);
  mcu_.pc = next & (mcu_.chip.flash_bytes - 1);
  if (avr.state == cpu_Crashed) mcu_.state = Mcu::State::crashed;
  if (avr.state == cpu_Sleeping && !(mcu_.pending && mcu_.flags[flag::I])) mcu_.state = Mcu::State::asleep;
}

}  // namespace board
