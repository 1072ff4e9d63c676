"""python -m greywhale_sim.run_elf: output, exit codes, options."""

from __future__ import annotations

import subprocess
import sys

import pytest

from tests.simulated_board.avr import Compile

PRINT = """
static void put(const char *s) { while (*s) { while (!(UCSR0A & _BV(UDRE0))); UCSR0A |= _BV(TXC0); UDR0 = *s++; } }
int main(void) {
    UBRR0 = 0; UCSR0B = _BV(TXEN0);
    put("test.cpp:1:first:PASS\\n");
    ADMUX = 0x41; ADCSRA = _BV(ADEN) | _BV(ADSC) | 7; while (ADCSRA & _BV(ADSC));
    put(ADC > 500 ? "high\\n" : "low\\n");
    while (!(UCSR0A & _BV(TXC0)));
    END
}
"""


def run_elf(*arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "greywhale_sim.run_elf", *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False)


@pytest.mark.parametrize("chip", ["atmega2560", "atmega328p"])
@pytest.mark.parametrize(("voltages", "word"), [("0,4000", "high"), ("5000", "low")])
def test_it_prints_what_the_program_sends_and_ends_with_it(
    compile_avr: Compile, chip: str, voltages: str, word: str
) -> None:
    path = compile_avr(PRINT.replace("END", "DONE();"), chip)
    result = run_elf(str(path), "--mcu", chip, "--millivolts", voltages)
    assert (result.returncode, result.stdout, result.stderr) == (0, f"test.cpp:1:first:PASS\n{word}\n", "")


def test_a_hang_and_a_crash_are_failures_with_the_output_so_far(compile_avr: Compile) -> None:
    hung = run_elf(str(compile_avr(PRINT.replace("END", "for (;;);"), "atmega2560")), "--limit-s", "0.1")
    assert (hung.returncode, hung.stdout) == (1, "test.cpp:1:first:PASS\nlow\n")
    assert "did not end within 0.1 s of simulated time" in hung.stderr
    crashed = run_elf(str(compile_avr(PRINT.replace("END", "*(volatile uint8_t *)0x7000 = 1;"), "atmega2560")))
    assert (crashed.returncode, crashed.stdout) == (1, "test.cpp:1:first:PASS\nlow\n")
    assert "crashed at address 0x" in crashed.stderr
