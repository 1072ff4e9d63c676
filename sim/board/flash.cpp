// SPDX-License-Identifier: GPL-3.0-or-later
// Model of SPM after the data sheets, chapter "Boot Loader Support". Erasing or writing a page takes 4 ms (3.7 .. 4.5);
// the CPU runs on when the page lies in the read-while-write section and stands still otherwise. Lock bits, SPM
// interrupt and the signature row are not modelled; reading the section that is being written is not punished.
#include "flash.h"

#include <algorithm>
#include <cstring>

#include "error.h"

extern "C" {
#include <simavr/avr_flash.h>
}

namespace board {

namespace {
enum : uint8_t { RWWSB = 0x40, RWWSRE = 0x10, BLBSET = 0x08, PGWRT = 0x04, PGERS = 0x02, SPMEN = 0x01 };
constexpr unsigned window_cycles = 4;
constexpr uint64_t page_milliseconds = 4;
}  // namespace

Flash::Flash(avr_t& avr, const Chip& chip, Cpu& cpu, Trace& trace)
    : avr_(avr), chip_(chip), cpu_(cpu), trace_(trace), buffer_(chip.flash_page), filled_(chip.flash_page / 2) {
  plain_register(avr_, reg::SPMCSR);
  on_write<&Flash::write_control>(avr_, reg::SPMCSR, *this);
  for (avr_io_t* io = avr.io_port; io; io = io->next) {
    if (std::strcmp(io->kind, "flash") != 0) continue;
    io->ioctl = &Flash::on_spm;
    hooks_of(avr).flash = this;
    return;
  }
  throw BoardError("this libsimavr has no self-programming for the chip; install Debian's libsimavr-dev 1.6");
}

void Flash::reset() {
  busy_ = false;
  clear_buffer();
}

void Flash::clear_buffer() {
  std::fill(buffer_.begin(), buffer_.end(), uint8_t{0xFF});
  std::fill(filled_.begin(), filled_.end(), false);
}

void Flash::write_control(uint16_t reg, uint8_t value) {
  if (busy_) return;
  avr_.data[reg] = static_cast<uint8_t>((value & ~RWWSB) | (avr_.data[reg] & RWWSB));
  if (value & SPMEN) schedule<&Flash::on_window_closed>(avr_, store_ends(avr_) + window_cycles, *this);
}

avr_cycle_count_t Flash::on_window_closed(avr_cycle_count_t) {
  if (!busy_) avr_.data[reg::SPMCSR] &= static_cast<uint8_t>(~(RWWSRE | BLBSET | PGWRT | PGERS | SPMEN));
  return 0;
}

avr_cycle_count_t Flash::on_done(avr_cycle_count_t) {
  busy_ = false;
  avr_.data[reg::SPMCSR] &= static_cast<uint8_t>(~(PGWRT | PGERS | SPMEN));
  return 0;
}

int Flash::on_spm(avr_io_t* io, uint32_t request, void*) {
  if (request != AVR_IOCTL_FLASH_SPM) return -1;
  hooks_of(*io->avr).flash->store_program_memory();
  return 0;
}

void Flash::store_program_memory() {
  uint8_t& control = avr_.data[reg::SPMCSR];
  if (busy_ || !(control & SPMEN) || avr_.pc < chip_.nrww_start) return;  // only the boot section may
  cancel<&Flash::on_window_closed>(avr_, *this);
  uint32_t address = avr_.data[R_ZL] | static_cast<uint32_t>(avr_.data[R_ZH]) << 8;
  if (avr_.rampz) address |= static_cast<uint32_t>(avr_.data[reg::RAMPZ]) << 16;
  address %= avr_.flashend + 1;

  if (control & (PGERS | PGWRT)) {
    program_page(address, control & PGERS);
    return;
  }
  if (control & RWWSRE) {
    control = static_cast<uint8_t>(control & ~RWWSB);
    clear_buffer();
  } else if (!(control & BLBSET)) {
    fill_buffer(address);
  }
  control = static_cast<uint8_t>(control & RWWSB);
}

void Flash::fill_buffer(uint32_t address) {
  const uint32_t offset = (address % chip_.flash_page) & ~1u;
  if (filled_[offset / 2]) return;  // each word can be written once
  filled_[offset / 2] = true;
  buffer_[offset] = avr_.data[0];
  buffer_[offset + 1] = avr_.data[1];
}

void Flash::program_page(uint32_t address, bool erase) {
  const uint32_t page = address - address % chip_.flash_page;
  if (page < protected_from_) {
    for (uint32_t i = 0; i < chip_.flash_page; ++i) {
      uint8_t& cell = avr_.flash[page + i];
      cell = erase ? uint8_t{0xFF} : static_cast<uint8_t>(cell & buffer_[i]);  // writing only clears bits
    }
    cpu_.flash_changed(page, chip_.flash_page);
    ++page_writes_;
  }
  trace_.add(Trace::Kind::flash_write, avr_.cycle, page);
  if (!erase) clear_buffer();

  const uint64_t cycles = uint64_t{avr_.frequency} * page_milliseconds / 1000;
  if (page >= chip_.nrww_start) {
    on_done(avr_.cycle);
    stall(avr_, cycles);
    return;
  }
  busy_ = true;
  avr_.data[reg::SPMCSR] |= RWWSB;
  schedule<&Flash::on_done>(avr_, avr_.cycle + cycles, *this);
}

}  // namespace board
