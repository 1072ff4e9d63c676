// Model of SPM after the data sheets, chapter "Boot Loader Support". Erasing or writing a page takes 4 ms (3.7 .. 4.5);
// the CPU runs on when the page lies in the read-while-write section and stands still otherwise. Lock bits, SPM
// interrupt and the signature row are not modelled; reading the section that is being written is not punished.
#include "flash.h"

#include <algorithm>

namespace board {

namespace {
enum : uint8_t { RWWSB = 0x40, RWWSRE = 0x10, BLBSET = 0x08, PGWRT = 0x04, PGERS = 0x02, SPMEN = 0x01 };
constexpr unsigned window_cycles = 4;
constexpr uint64_t page_milliseconds = 4;
}  // namespace

Flash::Flash(Mcu& mcu, const Chip& chip, Cpu& cpu, Trace& trace)
    : mcu_(mcu), chip_(chip), cpu_(cpu), trace_(trace), buffer_(chip.flash_page), filled_(chip.flash_page / 2) {
  on_write<&Flash::write_control>(mcu_, reg::SPMCSR, *this);
  mcu_.spm = action<&Flash::store_program_memory>(*this);
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
  mcu_.data[reg] = static_cast<uint8_t>((value & ~RWWSB) | (mcu_.data[reg] & RWWSB));
  if (value & SPMEN) schedule<&Flash::on_window_closed>(mcu_, store_ends(mcu_) + window_cycles, *this);
}

void Flash::on_window_closed(uint64_t) {
  if (!busy_) mcu_.data[reg::SPMCSR] &= static_cast<uint8_t>(~(RWWSRE | BLBSET | PGWRT | PGERS | SPMEN));
}

void Flash::on_done(uint64_t) {
  busy_ = false;
  mcu_.data[reg::SPMCSR] &= static_cast<uint8_t>(~(PGWRT | PGERS | SPMEN));
}

void Flash::store_program_memory() {
  uint8_t& control = mcu_.data[reg::SPMCSR];
  if (busy_ || !(control & SPMEN) || mcu_.pc < chip_.nrww_start) return;  // only the boot section may
  cancel<&Flash::on_window_closed>(mcu_, *this);
  uint32_t address = mcu_.data[reg::ZL] | static_cast<uint32_t>(mcu_.data[reg::ZH]) << 8;
  if (chip_.wide_pc) address |= static_cast<uint32_t>(mcu_.data[reg::RAMPZ]) << 16;
  address %= chip_.flash_bytes;

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
  buffer_[offset] = mcu_.data[0];
  buffer_[offset + 1] = mcu_.data[1];
}

void Flash::program_page(uint32_t address, bool erase) {
  const uint32_t page = address - address % chip_.flash_page;
  if (page < protected_from_) {
    for (uint32_t i = 0; i < chip_.flash_page; ++i) {
      uint8_t& cell = mcu_.flash[page + i];
      cell = erase ? uint8_t{0xFF} : static_cast<uint8_t>(cell & buffer_[i]);  // writing only clears bits
    }
    cpu_.flash_changed(page, chip_.flash_page);
    ++page_writes_;
  }
  trace_.add(Trace::Kind::flash_write, mcu_.cycle, page);
  if (!erase) clear_buffer();

  const uint64_t cycles = uint64_t{crystal_hertz} * page_milliseconds / 1000;
  if (page >= chip_.nrww_start) {
    on_done(mcu_.cycle);
    mcu_.cycle += cycles;
    return;
  }
  busy_ = true;
  mcu_.data[reg::SPMCSR] |= RWWSB;
  schedule<&Flash::on_done>(mcu_, mcu_.cycle + cycles, *this);
}

}  // namespace board
