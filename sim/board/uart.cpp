// Model of USART0 after the data sheets of both chips, chapter "USART". Asynchronous mode; no parity or frame errors,
// since the line here has no noise.
#include "uart.h"

namespace board {

namespace {
enum : uint8_t { RXC = 0x80, TXC = 0x40, UDRE = 0x20, FE = 0x10, DOR = 0x08, UPE = 0x04, U2X = 0x02, MPCM = 0x01 };
enum : uint8_t { RXCIE = 0x80, TXCIE = 0x40, UDRIE = 0x20, RXEN = 0x10, TXEN = 0x08, UCSZ2 = 0x04 };
}  // namespace

Uart::Uart(Mcu& mcu, Interrupts& interrupts, Trace& trace)
    : mcu_(mcu),
      interrupts_(interrupts),
      trace_(trace),
      rx_vector_(mcu.chip.usart_vector),
      udre_vector_(rx_vector_ + 1u),
      tx_vector_(rx_vector_ + 2u) {
  interrupts_.connect(rx_vector_, {reg::UCSR0B, RXCIE});
  interrupts_.connect(udre_vector_, {reg::UCSR0B, UDRIE});
  interrupts_.connect(tx_vector_, {reg::UCSR0B, TXCIE, reg::UCSR0A, TXC});
  on_write<&Uart::write_status>(mcu_, reg::UCSR0A, *this);
  on_write<&Uart::write_control>(mcu_, reg::UCSR0B, *this);
  on_write<&Uart::write_data>(mcu_, reg::UDR0, *this);
  on_read<&Uart::read_data>(mcu_, reg::UDR0, *this);
}

// The line does not stop because the chip was reset: a byte on its way is lost, those behind it follow.
void Uart::reset() {
  mcu_.data[reg::UCSR0A] = UDRE;
  mcu_.data[reg::UCSR0B] = 0;
  mcu_.data[reg::UCSR0C] = 0x06;  // 8 data bits, no parity, 1 stop bit
  transmitting_ = transmit_buffer_full_ = false;
  flush_receiver();
  if (receiving_) {
    receiving_ = false;
    line_.pop_front();
    line_free_at_ = mcu_.cycle;
  }
  if (!line_.empty()) start_reception(mcu_.cycle);
}

uint64_t Uart::bit_cycles() const {
  const uint64_t divisor = (mcu_.data[reg::UBRR0L] | (mcu_.data[reg::UBRR0H] & 0x0Fu) << 8) + 1u;
  return divisor * ((mcu_.data[reg::UCSR0A] & U2X) ? 8 : 16);
}

uint64_t Uart::frame_cycles() const {
  const unsigned format = mcu_.data[reg::UCSR0C];
  const unsigned size = (format >> 1 & 3u) | (control() & UCSZ2);
  const unsigned data_bits = size == 7 ? 9 : 5 + (size & 3u);
  const unsigned parity_bits = (format & 0x20u) ? 1 : 0;
  const unsigned stop_bits = (format & 0x08u) ? 2 : 1;
  return bit_cycles() * (1 + data_bits + parity_bits + stop_bits);
}

double Uart::baud() const { return static_cast<double>(crystal_hertz) / static_cast<double>(bit_cycles()); }

// ---- receiver ----

void Uart::send(const uint8_t* bytes, size_t count) {
  line_.insert(line_.end(), bytes, bytes + count);
  if (!receiving_ && !line_.empty()) start_reception(mcu_.cycle > line_free_at_ ? mcu_.cycle : line_free_at_);
}

void Uart::drop_pending() {
  line_.clear();
  receiving_ = false;
  cancel<&Uart::on_start_bit>(mcu_, *this);
  cancel<&Uart::on_stop_bit>(mcu_, *this);
}

// The chip samples the middle of each bit: it is sure of the start bit after half a bit, and has the byte in the middle
// of the stop bit.
void Uart::start_reception(uint64_t start) {
  receiving_ = true;
  const uint64_t half_bit = bit_cycles() / 2;
  if (receive_shift_full_) schedule<&Uart::on_start_bit>(mcu_, start + half_bit, *this);
  schedule<&Uart::on_stop_bit>(mcu_, start + frame_cycles() - half_bit, *this);
}

// A new frame begins while two bytes wait in the buffer and one in the shift register: that one is lost.
void Uart::on_start_bit(uint64_t) {
  if (receive_shift_full_ && (control() & RXEN)) {
    receive_shift_full_ = false;
    frame_lost_ = true;
    ++overruns_;
  }
}

void Uart::on_stop_bit(uint64_t when) {
  const uint8_t byte = line_.front();
  line_.pop_front();
  if (control() & RXEN) {
    receive_shift_ = {byte, frame_lost_};
    receive_shift_full_ = true;
    frame_lost_ = false;
    fill_buffer();
  }
  receiving_ = false;
  line_free_at_ = when + bit_cycles() / 2;
  if (!line_.empty()) start_reception(line_free_at_);
}

void Uart::fill_buffer() {
  if (receive_shift_full_ && buffered_ < 2) {
    buffer_[buffered_++] = receive_shift_;
    receive_shift_full_ = false;
  }
  uint8_t flags = static_cast<uint8_t>(status() & ~(RXC | FE | DOR | UPE));
  if (buffered_ > 0) flags = static_cast<uint8_t>(flags | RXC | (buffer_[0].overrun_before ? DOR : 0));
  status() = flags;
  refresh_interrupts();
}

void Uart::flush_receiver() {
  buffered_ = 0;
  receive_shift_full_ = frame_lost_ = false;
  fill_buffer();
}

uint8_t Uart::read_data(uint16_t) {
  const uint8_t byte = buffer_[0].byte;
  if (buffered_ > 0) {
    buffer_[0] = buffer_[1];
    --buffered_;
    fill_buffer();
  }
  return byte;
}

// ---- transmitter ----

void Uart::write_data(uint16_t, uint8_t value) {
  if (!(control() & TXEN) || !(status() & UDRE)) return;  // the data sheet: ignored
  if (transmitting_) {
    transmit_buffer_ = value;
    transmit_buffer_full_ = true;
    status() = static_cast<uint8_t>(status() & ~UDRE);
    refresh_interrupts();
  } else {
    transmit_shift_ = value;
    transmitting_ = true;
    if (loopback) send(&transmit_shift_, 1);
    schedule<&Uart::on_transmitted>(mcu_, store_ends(mcu_) + frame_cycles(), *this);
  }
}

void Uart::on_transmitted(uint64_t when) {
  received_.push_back(static_cast<char>(transmit_shift_));
  ++sent_;
  trace_.add(Trace::Kind::uart_byte, when, transmit_shift_);
  if (transmit_buffer_full_) {
    transmit_shift_ = transmit_buffer_;
    transmit_buffer_full_ = false;
    status() |= UDRE;
    refresh_interrupts();
    if (loopback) send(&transmit_shift_, 1);
    schedule<&Uart::on_transmitted>(mcu_, when + frame_cycles(), *this);
    return;
  }
  transmitting_ = false;
  interrupts_.raise(tx_vector_);  // sets TXC
}

std::string Uart::receive() {
  std::string bytes;
  bytes.swap(received_);
  return bytes;
}

// ---- registers ----

void Uart::write_status(uint16_t, uint8_t value) {
  uint8_t flags = static_cast<uint8_t>((status() & ~(U2X | MPCM)) | (value & (U2X | MPCM)));
  if (value & TXC) {
    flags = static_cast<uint8_t>(flags & ~TXC);
    interrupts_.withdraw(tx_vector_);
  }
  status() = flags;
}

void Uart::write_control(uint16_t reg, uint8_t value) {
  mcu_.data[reg] = value;
  if (!(value & RXEN)) flush_receiver();
  interrupts_.set_level(tx_vector_, (value & TXCIE) && (status() & TXC));
  refresh_interrupts();
}

void Uart::refresh_interrupts() {
  interrupts_.set_level(rx_vector_, (status() & RXC) && (control() & RXCIE));
  interrupts_.set_level(udre_vector_, (status() & UDRE) && (control() & UDRIE));
}

}  // namespace board
