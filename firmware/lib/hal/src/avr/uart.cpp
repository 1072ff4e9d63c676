// USART0 at 1 Mbaud with a ring for each direction; interrupts.S moves the bytes. At that speed a byte comes every 160
// cycles, and the chip holds three.
#ifdef __AVR__
#include <avr/interrupt.h>
#include <avr/io.h>

#include "../hal.h"
#include "internal.h"
#include "shared_state.h"

namespace hal {
namespace {

constexpr uint8_t mask = RING_SIZE - 1;
static_assert(rx_capacity == mask && tx_capacity == mask, "one place of a ring stays empty");

}  // namespace

namespace internal {

void start_uart() {
  TX_TAIL = 0;
  UBRR0 = 0;  // 16 MHz / 16 = 1 Mbaud exactly
  UCSR0A = 0;
  UCSR0C = (1 << UCSZ01) | (1 << UCSZ00);  // 8N1
  UCSR0B = UART_ON;
}

}  // namespace internal

bool rx_available() { return hal_rx_head != hal_rx_tail; }

uint8_t rx_read() {
  const uint8_t tail = hal_rx_tail;
  const uint8_t byte = hal_rx_ring[tail];
  hal_rx_tail = (tail + 1) & mask;
  if (!(UCSR0B & (1 << RXCIE0))) {  // a full ring has turned the interrupt off
    cli();
    UCSR0B |= 1 << RXCIE0;
    sei();
  }
  return byte;
}

uint8_t tx_free() { return static_cast<uint8_t>(mask - ((hal_tx_head - TX_TAIL) & mask)); }

// The head moves once, behind the last byte, and together with turning the interrupt on. The interrupt sends whatever
// is at the tail, so it must never be on with an empty ring.
void tx_write(const uint8_t* bytes, uint8_t count) {
  uint8_t head = hal_tx_head;
  for (; count; --count) {
    hal_tx_ring[head] = *bytes++;
    head = (head + 1) & mask;
  }
  cli();
  hal_tx_head = head;
  UCSR0B = UART_ON | (1 << UDRIE0);
  sei();
}

uint8_t rx_lost() {
  if (hal_rx_lost == 0) return 0;
  cli();
  const uint8_t count = hal_rx_lost;
  hal_rx_lost = 0;
  sei();
  return count;
}

}  // namespace hal
#endif  // __AVR__
