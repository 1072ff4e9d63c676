// Model of the EEPROM after the data sheets, section "EEPROM Data Memory": EEMPE opens a window of four cycles for
// EEPE; 3.4 ms to erase and write, 1.8 ms to do one of them; the CPU stands still for 4 cycles after a read and 2
// after a write.
#include "eeprom.h"

#include "error.h"
#include "random.h"

namespace board {

namespace {
enum : uint8_t { EEPM = 0x30, EERIE = 0x08, EEMPE = 0x04, EEPE = 0x02, EERE = 0x01 };
constexpr unsigned write_stall = 2, read_stall = 4, window_cycles = 4;
}  // namespace

Eeprom::Eeprom(Mcu& mcu, Interrupts& interrupts, Trace& trace)
    : mcu_(mcu), interrupts_(interrupts), trace_(trace), cells_(mcu.chip.eeprom_bytes, uint8_t{0xFF}) {
  interrupts_.connect(mcu.chip.eeprom_vector, {reg::EECR, EERIE});
  on_write<&Eeprom::write_control>(mcu_, reg::EECR, *this);
}

void Eeprom::reset() {
  if (!busy_) return;
  control() |= EEPE;
  schedule<&Eeprom::on_done>(mcu_, end_, *this);
}

uint16_t Eeprom::address() const {
  const unsigned address = static_cast<unsigned>(mcu_.data[reg::EEARL] | mcu_.data[reg::EEARH] << 8);
  return static_cast<uint16_t>(address % cells_.size());
}

uint64_t Eeprom::busy_cycles(Mode mode) const {
  return uint64_t{crystal_hertz} * (mode == Mode::erase_and_write ? 34u : 18u) / 10000u;
}

void Eeprom::on_done(uint64_t) {
  uint8_t& cell = cells_[cell_];
  switch (mode_) {
    case Mode::erase_and_write: cell = byte_; break;
    case Mode::erase: cell = 0xFF; break;
    case Mode::write: cell &= byte_; break;  // without erasing, bits can only be cleared
    case Mode::reserved: break;
  }
  busy_ = false;
  control() = static_cast<uint8_t>(control() & ~EEPE);
  refresh_interrupt();
}

// Erasing sets bits and writing clears them, one cell at a time: power that fails leaves some done and some not.
void Eeprom::lose_power(uint64_t seed) {
  if (!busy_) return;
  busy_ = false;
  uint8_t& cell = cells_[cell_];
  const auto done = static_cast<uint8_t>(Random(seed).next());
  const bool erasing =
      mode_ == Mode::erase || (mode_ == Mode::erase_and_write && mcu_.cycle - begin_ < (end_ - begin_) / 2);
  if (erasing) cell = static_cast<uint8_t>(cell | done);
  else cell = static_cast<uint8_t>((mode_ == Mode::write ? cell : 0xFF) & (byte_ | done));
}

void Eeprom::on_window_closed(uint64_t) { control() = static_cast<uint8_t>(control() & ~EEMPE); }

void Eeprom::write_control(uint16_t, uint8_t value) {
  const uint8_t old = control();
  const unsigned mode = busy_ ? (old & EEPM) | EEPE : value & EEPM;  // fixed during a write
  uint8_t now = static_cast<uint8_t>((value & EERIE) | (old & EEMPE) | mode);
  unsigned stalled = 0;
  if ((value & EEPE) && (old & EEMPE) && !busy_) {
    mode_ = static_cast<Mode>((value & EEPM) >> 4);
    cell_ = address();
    byte_ = mcu_.data[reg::EEDR];
    begin_ = store_ends(mcu_);
    end_ = begin_ + busy_cycles(mode_);
    busy_ = true;
    ++writes_;
    trace_.add(Trace::Kind::eeprom_write, begin_, static_cast<uint32_t>(cell_ << 8 | byte_));
    now = static_cast<uint8_t>((now | EEPE) & ~EEMPE);
    schedule<&Eeprom::on_done>(mcu_, end_, *this);
    cancel<&Eeprom::on_window_closed>(mcu_, *this);
    stalled = write_stall;
  } else if (value & EEMPE) {
    now |= EEMPE;
    schedule<&Eeprom::on_window_closed>(mcu_, store_ends(mcu_) + window_cycles, *this);
  }
  if ((value & EERE) && !busy_) {
    mcu_.data[reg::EEDR] = cells_[address()];
    stalled = read_stall;
  }
  control() = now;
  refresh_interrupt();
  mcu_.cycle += stalled;
}

void Eeprom::refresh_interrupt() { interrupts_.set_level(mcu_.chip.eeprom_vector, (control() & EERIE) && !busy_); }

std::string Eeprom::content() const { return {reinterpret_cast<const char*>(cells_.data()), cells_.size()}; }

void Eeprom::set_content(const std::string& bytes) {
  if (bytes.size() != cells_.size())
    throw BoardError("the EEPROM content has " + std::to_string(bytes.size()) + " bytes, but this chip has " +
                     std::to_string(cells_.size()) + "; give exactly that many");
  bytes.copy(reinterpret_cast<char*>(cells_.data()), bytes.size());
}

}  // namespace board
