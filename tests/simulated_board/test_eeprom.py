"""EEPROM: busy times, the write window, the level interrupt, and what a failing supply leaves."""

from __future__ import annotations

import pytest

from tests.simulated_board.avr import MakeProgram

BUSY = """
volatile uint16_t took[3];
int main(void) {
    TCCR1B = 2;
    for (uint8_t mode = 0; mode < 3; ++mode) {
        EEAR = 5; EEDR = 0x3C; EECR = mode << EEPM0;
        TCNT1 = 0; EECR |= _BV(EEMPE); EECR |= _BV(EEPE);
        while (EECR & _BV(EEPE)); took[mode] = TCNT1;
    }
    DONE();
}
"""


@pytest.mark.parametrize("chip", ["atmega2560", "atmega328p"])
def test_a_write_keeps_the_eeprom_busy_for_3_4_ms_and_half_of_it_for_1_8_ms(program: MakeProgram, chip: str) -> None:
    took = program(BUSY, chip).finish().u16("took")
    assert [count * 8 / 16000 for count in took] == pytest.approx([3.4, 1.8, 1.8], abs=0.005)


MODES = """
static void put(uint8_t address, uint8_t value, uint8_t mode) {
    EEAR = address; EEDR = value; EECR = mode << EEPM0; EECR |= _BV(EEMPE); EECR |= _BV(EEPE);
    while (EECR & _BV(EEPE));
}
volatile uint8_t read;
int main(void) {
    put(0, 0x3C, 0); put(0, 0xF0, 2);
    put(1, 0x55, 0); put(1, 0x00, 1);
    EEAR = 2; EEDR = 9; EECR = 0; EECR |= _BV(EEMPE); __builtin_avr_delay_cycles(6); EECR |= _BV(EEPE);
    put(3, 0x77, 0); EEAR = 3; EECR |= _BV(EERE); read = EEDR;
    DONE();
}
"""


def test_erasing_sets_bits_writing_clears_them_and_a_late_eepe_does_nothing(program: MakeProgram) -> None:
    run = program(MODES).finish()
    assert run.board.eeprom()[:4] == bytes([0x30, 0xFF, 0xFF, 0x77])
    assert run.u8("read") == [0x77]
    assert run.board.stats().eeprom_writes == 5


WRITER = """
volatile uint8_t next;
ISR(EE_READY_vect) {
    if (next == 4) DONE();
    EEAR = 16 + next; EEDR = 0xA0 + next; ++next;
    EECR |= _BV(EEMPE); EECR |= _BV(EEPE);
}
int main(void) { EECR = _BV(EERIE); sleep_enable(); sei(); for (;;) sleep_cpu(); }
"""


def test_the_ready_interrupt_alone_drives_a_writer(program: MakeProgram) -> None:
    run = program(WRITER).finish()
    assert run.board.eeprom()[16:20] == bytes([0xA0, 0xA1, 0xA2, 0xA3])
    assert run.board.cycle == pytest.approx(4 * 54_400, rel=0.01)


ONE_WRITE = """
int main(void) {
    if (MCUSR & _BV(EXTRF)) { while (EECR & _BV(EEPE)); DONE(); }
    EEAR = 7; EEDR = 0x5A; EECR |= _BV(EEMPE); EECR |= _BV(EEPE); for (;;);
}
"""


@pytest.mark.parametrize("elapsed_ms", [0.5, 2.5])
def test_losing_power_tears_the_byte_being_written_and_no_other(program: MakeProgram, elapsed_ms: float) -> None:
    left = set()
    for seed in range(20):
        run = program(ONE_WRITE)
        before = bytearray(range(256)) * 16
        before[7] = 0x3C
        run.board.set_eeprom(bytes(before))
        run.start()
        run.run(int(elapsed_ms * 16000))
        run.board.power_off(seed)
        after = run.board.eeprom()
        assert after[:7] + after[8:] == bytes(before[:7] + before[8:])
        left.add(after[7])
        expected_ones = 0x3C if elapsed_ms < 1.7 else 0x5A  # of the old byte; of the new
        assert after[7] & expected_ones == expected_ones
    assert len(left) > 5


def test_a_reset_does_not_stop_a_write(program: MakeProgram) -> None:
    run = program(ONE_WRITE).start()
    run.run(20_000)
    run.board.reset()
    assert run.run(100_000) == 1
    assert run.board.eeprom()[7] == 0x5A
    assert run.board.cycle == pytest.approx(54_400, abs=200)


def test_eeprom_content_survives_power_and_must_have_the_chips_size(program: MakeProgram) -> None:
    run = program(ONE_WRITE)
    content = bytes(255 - i % 256 for i in range(4096))
    run.board.set_eeprom(content)
    run.start()
    run.board.power_off()
    run.start()
    assert run.board.eeprom() == content
    with pytest.raises(ValueError, match="has 100 bytes, but this chip has 4096"):
        run.board.set_eeprom(bytes(100))
