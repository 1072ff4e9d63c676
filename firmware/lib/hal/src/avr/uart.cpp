// USART0 at 1 Mbaud with a ring each way. At that speed a byte comes every 160 cycles and the chip holds three.
#ifdef __AVR__
#include <avr/interrupt.h>
#include <avr/io.h>

#include "../hal.h"
#include "internal.h"

#ifdef USART_RX_vect   // the ATmega328P has one USART and no number in the vector's name
#define GREYWHALE_RX_vect USART_RX_vect
#define GREYWHALE_UDRE_vect USART_UDRE_vect
#else
#define GREYWHALE_RX_vect USART0_RX_vect
#define GREYWHALE_UDRE_vect USART0_UDRE_vect
#endif

namespace hal {
namespace {

constexpr uint8_t mask = 127;
static_assert(rx_capacity == mask && tx_capacity == mask, "one place of a ring stays empty");

uint8_t rx_ring[mask + 1];
uint8_t tx_ring[mask + 1];
volatile uint8_t rx_head = 0, rx_tail = 0;   // head is written by the producer, tail by the consumer
volatile uint8_t tx_head = 0, tx_tail = 0;
volatile uint8_t lost = 0;

constexpr uint8_t uart_on = (1 << RXEN0) | (1 << TXEN0) | (1 << RXCIE0);

}  // namespace

ISR(GREYWHALE_RX_vect) {
    const uint8_t status = UCSR0A;   // before UDR0, which clears it
    const uint8_t byte = UDR0;
    const uint8_t head = rx_head;
    const uint8_t next = (head + 1) & mask;
    if (status & (1 << DOR0)) lost = static_cast<uint8_t>(lost + 1);
    if (next == rx_tail) {
        lost = static_cast<uint8_t>(lost + 1);
        return;
    }
    rx_ring[head] = byte;
    rx_head = next;
}

ISR(GREYWHALE_UDRE_vect) {
    const uint8_t tail = tx_tail;
    if (tail == tx_head) {
        UCSR0B = uart_on;   // nothing left: silence this interrupt
        return;
    }
    UDR0 = tx_ring[tail];
    tx_tail = (tail + 1) & mask;
}

namespace internal {

void start_uart() {
    UBRR0 = 0;   // 16 MHz / 16 = 1 Mbaud exactly
    UCSR0A = 0;
    UCSR0C = (1 << UCSZ01) | (1 << UCSZ00);   // 8N1
    UCSR0B = uart_on;
}

}  // namespace internal

bool rx_available() { return rx_head != rx_tail; }

uint8_t rx_read() {
    const uint8_t tail = rx_tail;
    const uint8_t byte = rx_ring[tail];
    rx_tail = (tail + 1) & mask;
    return byte;
}

uint8_t tx_free() { return static_cast<uint8_t>(mask - ((tx_head - tx_tail) & mask)); }

void tx_write(uint8_t byte) {
    const uint8_t head = tx_head;
    tx_ring[head] = byte;
    tx_head = (head + 1) & mask;
    UCSR0B = uart_on | (1 << UDRIE0);
}

uint8_t rx_lost() {
    cli();
    const uint8_t count = lost;
    lost = 0;
    sei();
    return count;
}

}  // namespace hal
#endif  // __AVR__
