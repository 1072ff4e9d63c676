// The board, with simavr for its CPU, behind plain C functions.
#include <algorithm>
#include <memory>

#include "board.h"

using board::Board;

extern "C" {

Board* simavr_new(const char* chip) { return std::make_unique<Board>(chip).release(); }

void simavr_delete(Board* self) { std::default_delete<Board>()(self); }

void simavr_write(Board* self, uint32_t address, const char* bytes, uint32_t count) {
  self->write_program({{address, {bytes, count}}}, "program", false);
}

void simavr_power_on(Board* self, uint64_t seed) { self->power_on(seed); }

void simavr_poke(Board* self, uint32_t address, const char* bytes, uint32_t count) {
  self->poke(address, {bytes, count});
}

void simavr_peek(Board* self, uint32_t address, char* bytes, uint32_t count) {
  const std::string seen = self->peek(address, count);
  std::copy(seen.begin(), seen.end(), bytes);
}

void simavr_flash(Board* self, char* bytes) {
  const std::string seen = self->flash();
  std::copy(seen.begin(), seen.end(), bytes);
}

// How many bytes the program has sent, of which so many fit.
uint32_t simavr_uart_receive(Board* self, char* bytes, uint32_t room) {
  const std::string sent = self->uart().receive();
  std::copy_n(sent.begin(), std::min<size_t>(room, sent.size()), bytes);
  return static_cast<uint32_t>(sent.size());
}

int simavr_run_until(Board* self, uint64_t cycle) { return static_cast<int>(self->run_until(cycle)); }

uint64_t simavr_cycle(Board* self) { return self->cycle(); }

uint32_t simavr_pc(Board* self) { return self->pc(); }

void simavr_set_pc(Board* self, uint32_t address) { self->set_pc(address); }

uint64_t simavr_trace_hash(Board* self) { return self->trace_hash(); }

unsigned simavr_family(Board* self) { return self->chip().elf_architecture; }
}
