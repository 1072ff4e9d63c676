// A motor with a potentiometer follows a potentiometer in your hand. An H-bridge with two PWM inputs drives it.
// Begin with the motor off its gears: if it runs away, swap its wires.
#include <GreywhaleFuzzy.h>

const uint8_t hand_pin = A0, motor_pin = A1, forward_pin = 9, backward_pin = 10;
const uint16_t supply_mv = 12000;
const uint8_t period_ms = 20;

// kp, kd, ki, ku: begin with a small ku, then raise it until the motor follows briskly.
constexpr fuzzy_pdi::Settings settings = greywhale::settings(0.5, 0.16, 0.3, 12.0);
greywhale::FuzzyPdi motor;

// A potentiometer of 300 degrees: 1024 counts are 5.24 rad, so one is 21/4096 rad.
int16_t angle_at(uint8_t pin) { return static_cast<int16_t>((analogRead(pin) - 512) * 21); }

void setup() {
  pinMode(forward_pin, OUTPUT);
  pinMode(backward_pin, OUTPUT);
  pinMode(LED_BUILTIN, OUTPUT);
  if (!motor.begin(settings, period_ms)) {
    digitalWrite(LED_BUILTIN, HIGH);  // a setting is refused: motor.refusal()
    while (true) {
    }
  }
}

void loop() {
  static uint32_t next = 0;
  if (static_cast<int32_t>(millis() - next) < 0) return;
  next += period_ms;

  const int16_t volts_mv = motor.update(angle_at(hand_pin), angle_at(motor_pin), supply_mv);
  const uint8_t duty = greywhale::duty(volts_mv, supply_mv);
  analogWrite(forward_pin, volts_mv > 0 ? duty : 0);
  analogWrite(backward_pin, volts_mv < 0 ? duty : 0);
}
