"""A compiled AVR program on a simulated board, as the tests of the board use it."""

from __future__ import annotations

import struct
from collections.abc import Callable
from pathlib import Path
from typing import Protocol

from greywhale._native import Board
from greywhale_sim.programs import load_elf
from greywhale_sim.symbols import Symbol, read_symbols

PRELUDE = """
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>
#include <avr/wdt.h>
#include <stdint.h>
#define DONE() do { cli(); sleep_enable(); sleep_cpu(); } while (1)
"""
# A tick, a chain of conversions, a serial echo and an EEPROM writer, all by interrupt, around a sleeping main loop.
BUSY = """
volatile uint16_t sum, ticks; volatile uint8_t address;
ISR(TIMER0_COMPA_vect) { ++ticks; ADCSRA |= _BV(ADSC); }
ISR(ADC_vect) { sum += ADC; ADMUX = 0x40 | (sum & 7); if (sum & 3) ADCSRA |= _BV(ADSC); }
ISR(USART0_RX_vect) { uint8_t c = UDR0; UDR0 = c ^ (uint8_t)sum; }
ISR(EE_READY_vect) { EEAR = ++address; EEDR = sum; EECR |= _BV(EEMPE); EECR |= _BV(EEPE); }
int main(void) {
    TCCR0A = 2; OCR0A = 249; TCCR0B = 3; TIMSK0 = 2;
    ADMUX = 0x40; ADCSRA = _BV(ADEN) | _BV(ADIE) | 5;
    UBRR0 = 0; UCSR0B = _BV(RXEN0) | _BV(TXEN0) | _BV(RXCIE0); EECR = _BV(EERIE);
    uint16_t work = 1; sleep_enable(); sei();
    for (;;) { for (uint8_t i = sum & 63; i; --i) work = work * 31 + sum; GPIOR1 = work; sleep_cpu(); }
}
"""
DONE = 1
# compile_avr(source, chip): the linked program; the same source is compiled once.
Compile = Callable[[str, str], Path]


class Program:
    """A compiled program on a board of its own."""

    def __init__(self, path: Path, chip: str) -> None:
        self.path = path
        self.symbols: dict[str, Symbol] = read_symbols(path)
        self.board = Board(chip)
        load_elf(self.board, path)

    def start(self, seed: int = 1) -> Program:
        self.board.power_on(seed)
        return self

    def run(self, cycles: int) -> int:
        """As Board.run_until: 0 running, 1 done, 2 crashed."""
        return self.board.run_until(self.board.cycle + cycles)

    def finish(self, limit: int = 4_000_000) -> Program:
        """Starts the program and runs it to its DONE()."""
        self.start()
        assert self.run(limit) == DONE, f"still at {self.board.pc:#x} after {limit} cycles"
        return self

    def u8(self, name: str) -> list[int]:
        symbol = self.symbols[name]
        return list(self.board.peek(symbol.address, symbol.size))

    def u16(self, name: str) -> list[int]:
        symbol = self.symbols[name]
        return list(struct.unpack(f"<{symbol.size // 2}H", self.board.peek(symbol.address, symbol.size)))

    def set_u8(self, name: str, value: int) -> None:
        self.board.poke(self.symbols[name].address, bytes([value]))


class MakeProgram(Protocol):
    """program(source, chip): a Program, loaded but not started."""

    def __call__(self, source: str, chip: str = "atmega2560") -> Program: ...
