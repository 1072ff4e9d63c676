// The 1 kHz tick by timer 0, and the chain of 32 ADC conversions that it starts.
#ifdef __AVR__
#include <avr/interrupt.h>
#include <avr/io.h>

#include "../hal.h"
#include "internal.h"
#include "pins.h"

namespace hal {
namespace {

// Prescaler 32: 500 kHz ADC clock. Free-running: a conversion takes exactly 13 ADC clocks (416 cycles) however late
// the interrupt is, so 32 of them take 13,312 of the tick's 16,000 cycles.
constexpr uint8_t adc_one = (1 << ADEN) | (1 << ADIE) | (1 << ADPS2) | (1 << ADPS0);
constexpr uint8_t adc_start = adc_one | (1 << ADATE) | (1 << ADSC) | (1 << ADIF);
constexpr uint8_t conversions = pot_count * conversions_per_pot;

constexpr uint8_t channel(uint8_t n) { return static_cast<uint8_t>((1 << REFS0) | (n & 7)); }   // reference AVcc

uint16_t sums[2][pot_count];
uint16_t* volatile filling = sums[0];   // the interrupt adds here; the other one is the main loop's
volatile uint8_t full = 0;              // the main loop's one holds sums that it has not read
volatile uint8_t conversion = conversions;
volatile uint8_t running = 0;           // a tick has started and tick_end() has not been called
volatile uint8_t elapsed = 0;
volatile uint8_t late = 0;

}  // namespace

// The first conversion is started before anything else: its moment does not depend on the work below.
ISR(TIMER0_COMPA_vect) {
    const bool restart = conversion == conversions && !full;
    if (restart) {
        ADCSRA = adc_start;   // channel 0 was chosen by the last interrupt of the chain before
        conversion = 0;
        filling = filling == sums[0] ? sums[1] : sums[0];
        full = 1;
    } else {
        late = 1;
    }
    elapsed = static_cast<uint8_t>(elapsed + 1);
    if (running) {
        pins::drivers_off();
        late = 1;
        const uint8_t missed = internal::missed_ticks;
        if (missed != 255) internal::missed_ticks = static_cast<uint8_t>(missed + 1);
    }
    running = 1;
    // The channel of conversion 1: allowed one ADC clock (32 cycles) after the start of conversion 0.
    if (restart) {
        __builtin_avr_delay_cycles(12);
        ADMUX = channel(1);
    }
}

// Conversion n is in ADC, n + 1 is under way with its channel latched: this chooses the channel of n + 2.
// Pots are visited in turn, not four times in a row, so that all eight are averaged over the same time.
ISR(ADC_vect) {
    const uint8_t n = conversion;
    uint16_t* const sum = filling + (n & 7);
    if (n == conversions - 2) ADCSRA = adc_one;   // the one under way is the last
    ADMUX = n == conversions - 1 ? channel(0) : channel(static_cast<uint8_t>(n + 2));
    *sum = static_cast<uint16_t>(*sum + ADC);
    conversion = static_cast<uint8_t>(n + 1);
}

namespace internal {

void start_tick() {
    TIMSK0 = 0;   // the framework's millis() interrupt
    TCCR0A = 1 << WGM01;
    TCCR0B = (1 << CS01) | (1 << CS00);   // prescaler 64
    OCR0A = 249;
    TCNT0 = 0;
    TIFR0 = (1 << OCF0A) | (1 << TOV0);
    TIMSK0 = 1 << OCIE0A;

    DIDR0 = 0xff;   // no digital inputs on the pots
    ADCSRB = 0;     // channels 0..7, free-running
    ADMUX = channel(0);
    ADCSRA = adc_one | (1 << ADIF);
}

}  // namespace internal

bool tick_pending() { return running != 0; }

TickStart tick_begin() {
    cli();
    const TickStart start = {elapsed, late != 0};
    elapsed = 0;
    late = 0;
    sei();
    return start;
}

void tick_end() {
    internal::missed_ticks = 0;
    running = 0;
}

uint16_t tick_age_us() {
    uint8_t ticks, count;
    do {
        ticks = elapsed;
        count = TCNT0;
    } while (ticks != elapsed);   // a tick in between: read again
    return static_cast<uint16_t>(ticks * 1000u + count * 4u);
}

bool read_pots(uint16_t (&out)[pot_count]) {
    if (!full) return false;
    uint16_t* const sum = filling == sums[0] ? sums[1] : sums[0];
    for (uint8_t i = 0; i < pot_count; ++i) {
        out[i] = sum[i];
        sum[i] = 0;
    }
    full = 0;
    return true;
}

}  // namespace hal
#endif  // __AVR__
