"""python -m greywhale_sim.run_elf: output, exit codes, options."""

from __future__ import annotations

import subprocess
import sys

import pytest

from greywhale_sim.run_elf import main
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


@pytest.mark.parametrize(
    ("chip", "voltages", "word"), [("atmega2560", "0,4000", "high"), ("atmega328p", "5000", "low")]
)
def test_it_prints_what_the_program_sends_and_ends_with_it(
    compile_avr: Compile, chip: str, voltages: str, word: str
) -> None:
    path = compile_avr(PRINT.replace("END", "DONE();"), chip)
    command = [sys.executable, "-m", "greywhale_sim.run_elf", str(path), "--mcu", chip, "--millivolts", voltages]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (result.returncode, result.stdout, result.stderr) == (0, f"test.cpp:1:first:PASS\n{word}\n", "")


@pytest.mark.parametrize(
    ("end", "words"),
    [
        ("for (;;);", "did not end within 0.1 s of simulated time"),
        ("*(volatile uint8_t *)0x7000 = 1;", "crashed at address 0x"),
    ],
    ids=["a hang", "a crash"],
)
def test_a_failure_comes_with_the_output_so_far(
    compile_avr: Compile, capsys: pytest.CaptureFixture[str], end: str, words: str
) -> None:
    assert main([str(compile_avr(PRINT.replace("END", end), "atmega2560")), "--limit-s", "0.1"]) == 1
    said = capsys.readouterr()
    assert said.out == "test.cpp:1:first:PASS\nlow\n"
    assert words in said.err
