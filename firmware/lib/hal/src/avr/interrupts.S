/* The interrupts that come often: a conversion every 416 cycles, a byte every 160 cycles each way. They are in assembly
   because avr-gcc saves twice the registers that they need. */
#ifdef __AVR__
#define __SFR_OFFSET 0
#include <avr/io.h>
#include <avr/interrupt.h>

#include "pins.h"
#include "shared_state.h"

.section .bss, "aw", @nobits    ; comes first in RAM: see BEHIND_RINGS
.balign 32                      ; the address of a sum changes in its low byte only
.global hal_sums, hal_tx_ring, hal_rx_ring
hal_sums:    .skip 32           ; two sets of eight
hal_tx_ring: .skip RING_SIZE
hal_rx_ring: .skip RING_SIZE

.section .bss.hal_places, "aw", @nobits   ; the assembler fills an aligned section up to the next multiple of 32
.global hal_tx_head, hal_rx_head, hal_rx_tail, hal_rx_lost
hal_tx_head: .skip 1
hal_rx_head: .skip 1
hal_rx_tail: .skip 1
hal_rx_lost: .skip 1

.section .text.hal, "ax", @progbits

.macro enter
    push r30
    in   r30, SREG
    push r30
    push r31
    push r24
    push r25
.endm

; Z := ring + position. AVR cannot add a constant, so this subtracts its negative.
.macro point ring, position
    mov  r30, \position
    ldi  r31, 0
    subi r30, lo8(-(\ring))
    sbci r31, hi8(-(\ring))
.endm

.macro leave
    pop  r25
    pop  r24
    pop  r31
    pop  r30
    out  SREG, r30
    pop  r30
    reti
.endm

; Conversion n is in ADC. Conversion n + 1 is under way, its channel latched. This chooses the channel of n + 2.
; Pots are read in turn, not four times in a row, so that all eight are averaged over the same time.
.global ADC_vect
ADC_vect:
    enter
    in   r30, SUM_POSITION
    lds  r24, ADCL
    mov  r31, r24
    subi r31, -4                ; below 8 for a lower byte of 0..3 and of 252..255
    cpi  r31, 8
    brcs 6f
    ldi  r31, hi8(hal_sums)
    sbic CONVERSION, 7
    rjmp 4f
    ld   r25, Z
    add  r24, r25
    st   Z+, r24
    lds  r24, ADCH
    ld   r25, Z
    adc  r24, r25
    st   Z+, r24
1:  in   r24, CONVERSION
    inc  r24
    out  CONVERSION, r24
    mov  r25, r30
    andi r25, 15
    brne 2f
    subi r30, 16                ; after the eighth pot comes the first
2:  out  SUM_POSITION, r30
    lsr  r25                    ; the pot of conversion n + 1
    inc  r25
    andi r25, 7
    ori  r25, 1 << REFS0
    cpi  r24, CHAIN_END - 1     ; signed
    brge 5f
3:  sts  ADMUX, r25
    leave
4:  st   Z+, r24                ; the first round
    lds  r24, ADCH
    st   Z+, r24
    rjmp 1b
5:  ldi  r25, (1 << REFS0) | FIRST_POT   ; the chain of the next tick begins there
    brne 3b
    ldi  r24, ADC_SINGLE        ; the conversion under way is the last
    sts  ADCSRA, r24
    rjmp 3b
6:  lds  r25, ADCH              ; a conversion of 0..3 or 1020..1023 gets its mark
    cpi  r31, 4
    brcs 7f
    cpi  r25, 0
    breq 8f
    rjmp 9f
7:  cpi  r25, 3
    brne 9f
8:  ori  r25, MARK
9:  ldi  r31, hi8(hal_sums)
    sbic CONVERSION, 7
    rjmp 10f
    push r23
    ld   r23, Z
    add  r23, r24
    st   Z+, r23
    ld   r23, Z
    adc  r23, r25
    st   Z+, r23
    pop  r23
    rjmp 1b
10: st   Z+, r24                ; the first round
    st   Z+, r25
    rjmp 1b

; The transmitter takes a byte. After the last byte, this interrupt is turned off.
.global SENDABLE_vect
SENDABLE_vect:
    enter
    in   r24, TX_TAIL
    point hal_tx_ring, r24
    ld   r25, Z
    sts  UDR0, r25
    inc  r24
    andi r24, RING_SIZE - 1
    out  TX_TAIL, r24
    lds  r25, hal_tx_head
    cpse r24, r25
    rjmp 1f
    ldi  r25, UART_ON
    sts  UCSR0B, r25
1:  leave

; A byte has come. When the ring is full, the byte stays in the chip and this interrupt is turned off until there is room
; again. A babbling host then takes no more time than the main loop spends on reading. The chip reports the bytes it drops.
.global RECEIVED_vect
RECEIVED_vect:
    enter
    lds  r24, hal_rx_head
    mov  r25, r24
    inc  r25
    andi r25, RING_SIZE - 1
    lds  r30, hal_rx_tail
    cp   r25, r30
    breq 2f
    sts  hal_rx_head, r25
    point hal_rx_ring, r24
    lds  r24, UCSR0A            ; before UDR0, which clears it
    lds  r25, UDR0
    st   Z, r25
    sbrs r24, DOR0
    rjmp 1f
    lds  r24, hal_rx_lost
    inc  r24
    breq 1f                     ; stays at 255
    sts  hal_rx_lost, r24
1:  leave
2:  lds  r24, UCSR0B
    andi r24, 0xff - (1 << RXCIE0)
    sts  UCSR0B, r24
    leave
#endif  /* __AVR__ */
