// Binds sim/board.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>

#include "bindings.h"
#include "board/board.h"
#include "board/error.h"
#include "py_board.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace {

using board::BoardError;
using greywhale::bind::PyBoard;

nb::bytes to_bytes(const std::string& text) { return nb::bytes(text.data(), text.size()); }
std::string to_string(const nb::bytes& bytes) { return {bytes.c_str(), bytes.size()}; }

struct InterruptTimes {
  uint64_t count, shortest, longest;
  double mean;
};

struct Stats {
  board::Stats counted;
  uint64_t interrupts, adc_conversions, uart_sent, rx_overruns, eeprom_writes, flash_pages;
  nb::dict vectors;
};

Stats collect(PyBoard& self) {
  Stats stats{self.stats(),           self.interrupts().entered(), self.adc().conversions(),         self.uart().sent(),
              self.uart().overruns(), self.eeprom().writes(),      self.flash_model().page_writes(), nb::dict()};
  for (unsigned vector = 1; vector < board::Interrupts::vector_count; ++vector) {
    const board::HandlerTimes& times = self.interrupts().times(vector);
    if (times.count == 0) continue;
    const double mean = static_cast<double>(times.cycles) / static_cast<double>(times.count);
    stats.vectors[nb::int_(vector)] = InterruptTimes{times.count, times.shortest, times.longest, mean};
  }
  return stats;
}

void bind_stats(nb::module_& m) {
  nb::class_<InterruptTimes>(m, "InterruptTimes",
                             "Cycles of one interrupt handler, from accepting the interrupt to the end of RETI.")
      .def_ro("count", &InterruptTimes::count, "Finished runs.")
      .def_ro("min", &InterruptTimes::shortest)
      .def_ro("mean", &InterruptTimes::mean)
      .def_ro("max", &InterruptTimes::longest);

  nb::class_<Stats>(m, "Stats", "Counts of what happened since the board was made.")
      .def_prop_ro("sleep_cycles", [](const Stats& s) { return s.counted.sleep_cycles; })
      .def_prop_ro(
          "resets", [](const Stats& s) { return s.counted.resets; }, "Of every cause, power-on included.")
      .def_prop_ro("watchdog_resets", [](const Stats& s) { return s.counted.watchdog_resets; })
      .def_ro("interrupts", &Stats::interrupts)
      .def_ro("adc_conversions", &Stats::adc_conversions)
      .def_ro("uart_sent", &Stats::uart_sent, "Bytes from the AVR.")
      .def_ro("rx_overruns", &Stats::rx_overruns, "Bytes to the AVR lost because it did not read in time.")
      .def_ro("eeprom_writes", &Stats::eeprom_writes)
      .def_ro("flash_pages", &Stats::flash_pages, "Flash pages erased or written by the program.")
      .def_prop_ro(
          "vectors", [](const Stats& s) { return s.vectors; },
          nb::sig("def vectors(self) -> dict[int, InterruptTimes]"), "By vector number, those that ran.");
}

using BoardClass = nb::class_<PyBoard>;

void bind_running(BoardClass& c) {
  c.def(
       "write_program",
       [](PyBoard& b, const std::vector<std::pair<uint32_t, nb::bytes>>& pieces, const std::string& name,
          bool bootloader) {
         std::vector<board::Segment> segments;
         for (const auto& piece : pieces)
           segments.push_back({piece.first, {piece.second.c_str(), piece.second.size()}});
         b.write_program(segments, name, bootloader);
       },
       "pieces"_a, "name"_a, "bootloader"_a = false,
       "Write pieces (address, bytes) to flash and EEPROM; a bootloader's lowest address becomes the reset vector. "
       "greywhale_sim.programs reads them from files.")
      .def_prop_ro(
          "family", [](const PyBoard& b) { return b.chip().elf_architecture; }, "5 of avr5, 6 of avr6.")
      .def("erase_flash", &PyBoard::erase_flash, "Erase the flash, the bootloader too.")
      .def("flash", [](const PyBoard& b) { return to_bytes(b.flash()); })

      .def("power_on", &PyBoard::power_on, "seed"_a = 1, "Start with PORF set; the seed makes what is in RAM.")
      .def("power_off", &PyBoard::power_off, "seed"_a = 1,
           "Cut the supply; an EEPROM byte being written is torn as the seed says.")
      .def("set_supply", &PyBoard::set_supply, "millivolts"_a, "seed"_a = 1,
           "The supply's voltage from now on. Below 2.7 V the brown-out detector holds the chip in reset until 2.75 V, "
           "and an EEPROM byte being written is torn as the seed says; below 1.1 V memory is lost as well.")
      .def("reset", &PyBoard::reset, "Pulse the RESET pin: RAM stays, EXTRF is set.")
      .def_prop_ro("powered", &PyBoard::powered)

      .def("run_until", &PyBoard::run, "cycle"_a,
           "Run to the first instruction boundary at or after the cycle. 0 running, 1 done (asleep with interrupts "
           "off), 2 crashed. Without power only time passes.")
      .def_prop_ro("crash_reason", [](const PyBoard& b) { return b.crash_reason(); })
      .def("call", &PyBoard::call, "address"_a, "limit"_a,
           "Call a compiled function by its flash byte address, interrupts off; its exact cycles, RET included. "
           "Arguments and results are in the registers, data addresses 0..31.")
      .def_prop_ro("cycle", &PyBoard::cycle)
      .def_prop_rw("pc", &PyBoard::pc, &PyBoard::set_pc, "Program counter, a byte address.")
      .def_prop_ro("in_bootloader", &PyBoard::in_bootloader);
}

void bind_memory(BoardClass& c) {
  c.def(
       "peek", [](PyBoard& b, uint32_t address, uint32_t count) { return to_bytes(b.peek(address, count)); },
       "address"_a, "count"_a = 1, "Bytes of the data space: registers, I/O registers, RAM. Has no side effect.")
      .def(
          "poke", [](PyBoard& b, uint32_t address, const nb::bytes& bytes) { b.poke(address, to_string(bytes)); },
          "address"_a, "bytes"_a, "Overwrite bytes of the data space, without what a program's write would set off.")
      .def("eeprom", [](PyBoard& b) { return to_bytes(b.eeprom().content()); })
      .def(
          "set_eeprom", [](PyBoard& b, const nb::bytes& bytes) { b.eeprom().set_content(to_string(bytes)); }, "data"_a,
          "Replace the whole content.")
      .def("stats", &collect)
      .def_prop_ro("trace_hash", &PyBoard::trace_hash,
                   "Equal for two boards that behaved alike to the cycle: interrupts, UART bytes, EEPROM and flash "
                   "writes, resets.");
}

void bind_pins(BoardClass& c) {
  c.def("set_millivolts", &PyBoard::set_millivolts, "millivolts"_a,
        "Voltages at ADC0..7 from now on, eight float64 in mV.")
      .def(
          "set_floating", [](PyBoard& b, uint8_t inputs) { b.adc().set_floating(inputs); }, "inputs"_a,
          "Inputs without a wire, bit i for ADCi: they read what the conversion before left on the sampling capacitor.")
      .def(
          "set_joined", [](PyBoard& b, uint8_t inputs, unsigned wipers) { b.adc().set_joined(inputs, wipers); },
          "inputs"_a, "wipers"_a,
          "Inputs on one wire, bit i for ADCi, with so many wipers on it: the pull-up of one pulls all.")
      .def("add_duty_output", &PyBoard::add_duty_output, "timer"_a, "channel"_a,
           "Watch a PWM output, for example (3, \"A\") for OC3A; its place in outputs().")
      .def("add_pin_output", &PyBoard::add_pin_output, "port"_a, "bit"_a,
           "Watch a pin, for example (\"H\", 6); its place in outputs().")
      .def("outputs", &PyBoard::outputs, nb::sig("def outputs(self) -> numpy.typing.NDArray[numpy.float64]"),
           "All watched outputs, duties 0..1 and pins 0 or 1. The same array each time: copy what must stay.")
      .def("duty", &PyBoard::duty, "timer"_a, "channel"_a,
           "Mean level of an output-compare pin, 0..1, from the registers.")
      .def("pin", &PyBoard::pin, "port"_a, "bit"_a, "True if the pin is driven high.")
      .def("hold_pin", &PyBoard::hold_pin, "port"_a, "bit"_a, "high"_a,
           "Hold a pin at a level from outside, as a button does, until let_pin_go(). It matters while the pin is an "
           "input.")
      .def("let_pin_go", &PyBoard::let_pin_go, "port"_a, "bit"_a,
           "Hold a pin no longer: an input then reads its pull-up.");
}

void bind_serial(BoardClass& c) {
  c.def(
       "uart_send", [](PyBoard& b, const nb::bytes& bytes) { b.send(to_string(bytes)); }, "data"_a,
       "Queue bytes for the AVR; they take their time on the line. Without power they are lost.")
      .def(
          "uart_pending", [](PyBoard& b) { return b.uart().pending(); }, "Bytes the AVR's receiver does not have yet.")
      .def(
          "uart_receive", [](PyBoard& b) { return to_bytes(b.uart().receive()); },
          "Bytes the AVR sent since the last call.")
      .def_prop_ro(
          "uart_available", [](PyBoard& b) { return b.uart().available(); }, "Bytes uart_receive() would return.")
      .def_prop_ro(
          "uart_sent", [](PyBoard& b) { return b.uart().sent(); }, "Bytes the AVR ever sent.")
      .def_prop_rw(
          "uart_loopback", [](PyBoard& b) { return b.uart().loopback; },
          [](PyBoard& b, bool on) { b.uart().loopback = on; },
          "A wire from TX0 to RX0: the AVR also receives what it sends.")
      .def_prop_ro("baud", [](PyBoard& b) { return b.uart().baud(); }, "Baud rate the AVR is set to.");
}

}  // namespace

void bind_board(nb::module_& m) {
  nb::exception<BoardError>(m, "BoardError", PyExc_ValueError);
  bind_stats(m);
  BoardClass board(m, "Board",
                   "A simulated Arduino: an AVR at 16 MHz and 5 V. Boards are independent of each other; use each "
                   "from one thread at a time. A new board has no power.");
  board.def(nb::init<const std::string&>(), "chip"_a, "chip: \"atmega2560\" or \"atmega328p\".")
      .def_prop_ro("chip", [](const PyBoard& b) { return b.chip().name; });
  bind_running(board);
  bind_memory(board);
  bind_pins(board);
  bind_serial(board);
}
