// Model of the ADC after the data sheets, chapter "Analog to Digital Converter": a conversion starts at the next rising
// edge of the ADC clock, samples 1.5 ADC clocks later (13.5 in the first after enabling) and ends after 13 (25).
// Single-ended channels, single and free-running conversions; other auto-trigger sources and gain are not modelled.
#include "adc.h"

namespace board {

namespace {
enum : uint8_t { ADEN = 0x80, ADSC = 0x40, ADATE = 0x20, ADIF = 0x10, ADIE = 0x08, ADPS = 0x07 };
constexpr unsigned ADLAR = 0x20, ADTS = 0x07, MUX5 = 0x08;
constexpr double bandgap_millivolts = 1100.0;
constexpr double temperature_millivolts = 314.0;  // ATmega328P at 25 degrees Celsius
constexpr double track_ohm = 10e3;                // of a potentiometer
constexpr double pull_up_ohm = 35e3;              // data sheets: 20 to 50 kOhm
}  // namespace

Adc::Adc(Mcu& mcu, const Chip& chip, Interrupts& interrupts) : mcu_(mcu), chip_(chip), interrupts_(interrupts) {
  interrupts_.connect(chip.adc_vector, {reg::ADCSRA, ADIE, reg::ADCSRA, ADIF});
  on_write<&Adc::write_control>(mcu_, reg::ADCSRA, *this);
  on_write<&Adc::write_mux>(mcu_, reg::ADMUX, *this);
  on_write<&Adc::write_mux>(mcu_, reg::ADCSRB, *this);
  on_write<&Adc::write_port>(mcu_, static_cast<uint16_t>(port_base(chip.adc_port) + 2), *this);
  on_read<&Adc::read_low>(mcu_, reg::ADCL, *this);
  on_read<&Adc::read_high>(mcu_, reg::ADCH, *this);
}

void Adc::reset() {
  first_ = true;
  result_locked_ = false;
  end_ = 0;
}

// Inputs change between two runs of the CPU and with their pull-ups only, so sampling may wait until the result or a
// change needs it.
void Adc::set_millivolts(const std::array<double, input_count>& millivolts) {
  sample_if_due(mcu_.cycle);
  millivolts_ = millivolts;
}

void Adc::set_floating(uint8_t inputs) {
  sample_if_due(mcu_.cycle);
  floating_ = inputs;
}

void Adc::set_joined(uint8_t inputs, unsigned wipers) {
  sample_if_due(mcu_.cycle);
  joined_ = inputs;
  wipers_ = wipers;
}

unsigned Adc::selected() const {
  const unsigned admux = mcu_.data[reg::ADMUX];
  if (!chip_.wide_adc_mux) return admux & 0x0Fu;
  return (admux & 0x1Fu) | (mcu_.data[reg::ADCSRB] & MUX5) << 2;
}

double Adc::millivolts_at(unsigned mux) const {
  if (mux == (chip_.wide_adc_mux ? 0x1Eu : 0x0Eu)) return bandgap_millivolts;
  if (mux == 8 && !chip_.wide_adc_mux) return temperature_millivolts;
  return 0.0;  // ground, ADC8..15 and the differential channels: nothing is connected
}

double Adc::reference_millivolts(unsigned admux) const {
  const double supply = mcu_.supply_millivolts;
  switch (admux >> 6) {
    case 2: return chip_.wide_adc_mux ? 1100.0 : supply;
    case 3: return chip_.wide_adc_mux ? 2560.0 : 1100.0;
    default: return supply;  // AVCC, or the AREF pin, taken as tied to 5 V
  }
}

void Adc::start(uint64_t edge) {
  const unsigned select = mcu_.data[reg::ADCSRA] & ADPS;
  const uint64_t clock = 1u << (select ? select : 1);
  edge_ = edge;
  sample_at_ = edge + (first_ ? 27 : 3) * clock / 2;
  end_ = edge + (first_ ? 25 : 13) * clock;
  first_ = false;
  sampled_ = false;
  mux_ = selected();
  admux_ = mcu_.data[reg::ADMUX];
}

void Adc::sample_if_due(uint64_t cycle) {
  if (running() && !sampled_ && sample_at_ <= cycle) sample();
}

// A wiper's source has the resistance of its track from there to both ends.
double Adc::pulled_up(unsigned input) const {
  const uint16_t pins = port_base(chip_.adc_port);
  const unsigned on = mcu_.data[pins + 2] & ~mcu_.data[pins + 1] & chip_.adc_pins;
  const bool joined = joined_ >> input & 1u;
  const unsigned pulling = on & (joined ? joined_ : 1u << input);
  if (pulling == 0) return millivolts_[input];
  const double volts = millivolts_[input], supply = mcu_.supply_millivolts, share = volts / supply;
  const double source = track_ohm * share * (1.0 - share) / (joined ? wipers_ : 1);
  return volts + (supply - volts) * source / (source + pull_up_ohm / __builtin_popcount(pulling));
}

void Adc::sample() {
  const bool floats = mux_ < input_count && (floating_ >> mux_ & 1);
  if (!floats) charge_ = mux_ < input_count ? pulled_up(mux_) : millivolts_at(mux_);
  const double count = charge_ * 1024.0 / reference_millivolts(admux_);
  held_ = static_cast<uint16_t>(count >= 1023.0 ? 1023.0 : count > 0.0 ? count : 0.0);
  sampled_ = true;
}

void Adc::on_done(uint64_t when) {
  if (!sampled_) sample();
  ++conversions_;
  end_ = 0;
  if (!result_locked_) {
    const unsigned result = (mcu_.data[reg::ADMUX] & ADLAR) ? unsigned{held_} << 6u : held_;
    mcu_.data[reg::ADCL] = static_cast<uint8_t>(result);
    mcu_.data[reg::ADCH] = static_cast<uint8_t>(result >> 8);
  }
  uint8_t& control = mcu_.data[reg::ADCSRA];
  const bool free_running = (control & ADATE) && !(mcu_.data[reg::ADCSRB] & ADTS);
  if (!free_running) control = static_cast<uint8_t>(control & ~ADSC);
  interrupts_.raise(chip_.adc_vector);  // sets ADIF
  if (!free_running) return;
  start(when);
  schedule<&Adc::on_done>(mcu_, end_, *this);
}

void Adc::write_control(uint16_t, uint8_t value) {
  uint8_t& control = mcu_.data[reg::ADCSRA];
  const uint8_t old = control;
  const bool enabled = value & ADEN;
  const bool flag = (old & ADIF) && !(value & ADIF);  // written one clears
  uint8_t now = static_cast<uint8_t>((value & (ADEN | ADATE | ADIE | ADPS)) | (flag ? ADIF : 0));
  if (enabled && (running() || (value & ADSC))) now |= ADSC;
  control = now;
  interrupts_.set_level(chip_.adc_vector, flag && (value & ADIE));

  if (!enabled) {
    cancel<&Adc::on_done>(mcu_, *this);
    end_ = 0;
    first_ = true;
    return;
  }
  const uint64_t end_of_store = store_ends(mcu_);
  if (!(old & ADEN)) enabled_at_ = end_of_store;
  if ((value & ADSC) && !running()) {
    const uint64_t clock = 1u << ((value & ADPS) ? (value & ADPS) : 1);
    const uint64_t late = (end_of_store - enabled_at_) % clock;
    start(end_of_store + (late ? clock - late : 0));
    schedule<&Adc::on_done>(mcu_, end_, *this);
  }
}

// Until the conversion's first clock edge a new channel still counts.
void Adc::write_mux(uint16_t reg, uint8_t value) {
  mcu_.data[reg] = value;
  if (running() && store_ends(mcu_) <= edge_) {
    mux_ = selected();
    admux_ = mcu_.data[reg::ADMUX];
  }
}

void Adc::write_port(uint16_t reg, uint8_t value) {
  sample_if_due(store_ends(mcu_));
  mcu_.data[reg] = value;
}

// Reading ADCL holds the result until ADCH is read too.
uint8_t Adc::read_low(uint16_t reg) {
  result_locked_ = true;
  return mcu_.data[reg];
}

uint8_t Adc::read_high(uint16_t reg) {
  result_locked_ = false;
  return mcu_.data[reg];
}

}  // namespace board
