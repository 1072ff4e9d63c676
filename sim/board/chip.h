// What differs between the two chips, and where their common registers are (data-sheet names, data-space addresses).
#pragma once

#include <cstdint>
#include <string>

namespace board {

constexpr uint32_t crystal_hertz = 16000000;
constexpr uint16_t first_register = 0x20;  // behind the 32 working registers

// A timer/counter. Its registers follow TCCRnA as in every timer of its width.
struct TimerMap {
  struct Pin {
    char port;
    uint8_t bit;
  };
  uint8_t number;
  bool wide;        // 16 bits
  uint16_t tccra;   // address of TCCRnA
  uint8_t match_a;  // vector of compare match A; those of the other channels and the overflow follow
  uint8_t channels;
  Pin pins[3];  // OCnA, OCnB, OCnC
};

struct Chip {
  const char* name;           // as avr-gcc calls it
  const char* title;          // as people call it
  unsigned elf_architecture;  // EF_AVR_MACH of programs built for it
  unsigned interrupt_entry;   // cycles from accepting an interrupt to its vector; as many again to wake up
  unsigned reti;              // cycles of RETI
  uint32_t flash_bytes;       // a power of two
  uint32_t nrww_start;        // first flash byte that cannot be read while it is written
  uint32_t flash_page;        // bytes
  uint16_t first_ram;         // registers end here
  uint16_t ram_end;           // last address
  uint16_t eeprom_bytes;
  bool wide_pc;       // more than 128 KB of flash: 22-bit program counter, RAMPZ, EIND
  bool wide_adc_mux;  // six multiplexer bits (MUX5 in ADCSRB) instead of four
  const char* ports;  // port letters
  char adc_port;      // ADC0 is its bit 0
  uint8_t adc_pins;   // those of ADC0..7 that are pins of a port, and so have a pull-up
  // Interrupt vectors; UDRE0 and TX0 follow RX0.
  uint8_t watchdog_vector, usart_vector, adc_vector, eeprom_vector;
  const TimerMap* timers;
  unsigned timer_count;
};

// Throws BoardError for anything but "atmega2560" and "atmega328p".
const Chip& find_chip(const std::string& name);

namespace reg {
enum : uint16_t {
  ZL = 0x1E,
  ZH = 0x1F,
  PINA = 0x20,
  TIFR0 = 0x35,  // those of the other timers follow
  EECR = 0x3F,
  EEDR = 0x40,
  EEARL = 0x41,
  EEARH = 0x42,
  GTCCR = 0x43,
  SMCR = 0x53,
  MCUSR = 0x54,
  SPMCSR = 0x57,
  RAMPZ = 0x5B,
  EIND = 0x5C,
  SPL = 0x5D,
  SPH = 0x5E,
  SREG = 0x5F,
  WDTCSR = 0x60,
  TIMSK0 = 0x6E,  // here too
  ADCL = 0x78,
  ADCH = 0x79,
  ADCSRA = 0x7A,
  ADCSRB = 0x7B,
  ADMUX = 0x7C,
  UCSR0A = 0xC0,
  UCSR0B = 0xC1,
  UCSR0C = 0xC2,
  UBRR0L = 0xC4,
  UBRR0H = 0xC5,
  UDR0 = 0xC6,
};
}  // namespace reg

// Bits of MCUSR, the cause of the last reset.
enum : uint8_t { PORF = 0x01, EXTRF = 0x02, BORF = 0x04, WDRF = 0x08 };
constexpr uint8_t SE = 0x01;  // in SMCR: without it SLEEP does nothing

// Address of PINx; DDRx and PORTx follow it.
constexpr uint16_t port_base(char letter) {
  const char order[] = "ABCDEFG";
  for (uint16_t i = 0; i < 7; ++i)
    if (order[i] == letter) return static_cast<uint16_t>(reg::PINA + 3 * i);
  return static_cast<uint16_t>(letter == 'H' ? 0x100 : 0x103 + 3 * (letter - 'J'));
}

}  // namespace board
