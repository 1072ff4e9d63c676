// What the interrupts in interrupts.S share with the C++ code: sizes, registers and variables.
#pragma once
#ifdef __AVR__

#define RING_SIZE 128
#define CONVERSIONS 32

// The first pot of each round. Followers come before leaders, so the leaders' readings are the younger ones.
#define FIRST_POT 4

// The chip's general purpose registers, which take one cycle to read. CONVERSION counts from -8 to CHAIN_END. Bit 7 is
// set during the first round, whose conversions replace the sums; later ones are added.
#define CONVERSION GPIOR0
#define CHAIN_START 0xf8
#define CHAIN_END (CONVERSIONS - 8)
#define SUM_POSITION GPIOR1  // low byte of the address of the sum that the next conversion belongs to
#define TX_TAIL GPIOR2       // position in the ring of the byte to be sent next

// In the upper byte of a conversion at a rail: hal::rail_mark.
#define MARK 0x10

#define UART_ON ((1 << RXEN0) | (1 << TXEN0) | (1 << RXCIE0))

// Prescaler 32: an ADC clock of 500 kHz. A free-running conversion takes exactly 13 ADC clocks (416 cycles), however
// late its interrupt is, so the chain takes 13,312 of a tick's 16,000 cycles.
#define ADC_SINGLE ((1 << ADEN) | (1 << ADIE) | (1 << ADPS2) | (1 << ADPS0))
#define ADC_ONCE ((1 << ADEN) | (1 << ADSC) | (1 << ADPS2) | (1 << ADPS0))
#define ADC_CHAIN (ADC_SINGLE | (1 << ADATE) | (1 << ADSC) | (1 << ADIF))

#ifndef __ASSEMBLER__
#include <stdint.h>

extern "C" {
extern uint8_t hal_tx_ring[RING_SIZE];
extern uint8_t hal_rx_ring[RING_SIZE];
extern uint16_t hal_sums[2][8];  // each set within 16 bytes that begin at a multiple of 16
extern volatile uint8_t hal_tx_head;
extern volatile uint8_t hal_rx_head, hal_rx_tail;  // head is written by the producer, tail by the consumer
extern volatile uint8_t hal_rx_lost;
}
#endif

#endif  // __AVR__
