// USART0 with the timing and the limits of the chip: whole frames on the line, two bytes of receive buffer and a shift
// register, one byte of transmit buffer, overruns.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>

#include "interrupts.h"
#include "mcu.h"
#include "trace.h"

namespace board {

class Uart {
 public:
  Uart(Mcu& mcu, Interrupts& interrupts, Trace& trace);
  void reset();

  // Bytes towards the AVR. They follow each other on the line without a gap, at the baud rate the AVR is set to.
  void send(const uint8_t* bytes, size_t count);
  size_t pending() const { return line_.size(); }
  void drop_pending();
  // Bytes from the AVR that have left the line since the last call.
  std::string receive();
  size_t available() const { return received_.size(); }

  // A wire from TX0 to RX0: what the AVR sends it also receives.
  bool loopback = false;

  double baud() const;
  uint64_t sent() const { return sent_; }
  uint64_t overruns() const { return overruns_; }

 private:
  struct Frame {
    uint8_t byte = 0;
    bool overrun_before = false;
  };

  uint8_t& status() { return mcu_.data[reg::UCSR0A]; }
  uint8_t control() const { return mcu_.data[reg::UCSR0B]; }
  uint64_t bit_cycles() const;
  uint64_t frame_cycles() const;

  void start_reception(uint64_t start);
  void on_start_bit(uint64_t when);
  void on_stop_bit(uint64_t when);
  void on_transmitted(uint64_t when);
  void fill_buffer();
  void flush_receiver();
  void refresh_interrupts();

  void write_status(uint16_t reg, uint8_t value);
  void write_control(uint16_t reg, uint8_t value);
  void write_data(uint16_t reg, uint8_t value);
  uint8_t read_data(uint16_t reg);

  Mcu& mcu_;
  Interrupts& interrupts_;
  Trace& trace_;
  const unsigned rx_vector_, udre_vector_, tx_vector_;

  std::deque<uint8_t> line_;  // towards the AVR; the front byte is on the line while receiving_
  bool receiving_ = false;
  uint64_t line_free_at_ = 0;
  Frame buffer_[2];
  unsigned buffered_ = 0;
  Frame receive_shift_;
  bool receive_shift_full_ = false;
  bool frame_lost_ = false;

  bool transmitting_ = false;
  bool transmit_buffer_full_ = false;
  uint8_t transmit_shift_ = 0;
  uint8_t transmit_buffer_ = 0;

  std::string received_;
  uint64_t sent_ = 0;
  uint64_t overruns_ = 0;
};

}  // namespace board
