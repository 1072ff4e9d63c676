// follow_pots_portable() of signals.cpp in AVR assembly: the same bits in 700 cycles. test/target/test_signals holds the two equal.
//
//   void app_follow_pots(const uint16_t* sums, Signals* signals, Observation* seen)
//                        r25:r24               r23:r22           r21:r20
//
// For follow_pots() of signals.h only: it uses every register from r6 on, saves only Y, and leaves r1 = 0.
#ifdef __AVR__
#include "signals_layout.h"

#define ZERO r17
#define GAIN r15
#define LOWEST_LOW r13
#define LOWEST_HIGH r14
#define RAILS r10
#define HIGHEST_LOW r11
#define HIGHEST_HIGH r12
#define AT_LOW r6   /* pots at a rail, as in Observation */
#define AT_HIGH r7

// Places in the record of one joint, from Z. Z is at Signals for joint 0 and one record further for each next joint.
#define LEADER (SIGNALS_JOINT + JOINT_LEADER)
#define FOLLOWER (SIGNALS_JOINT + JOINT_FOLLOWER)
#define LEADER_OLD_SHARE (SIGNALS_JOINT + JOINT_LEADER_OLD_SHARE)
#define FOLLOWER_OLD_SHARE (SIGNALS_JOINT + JOINT_FOLLOWER_OLD_SHARE)
#define FOLLOWER_ANGLE (SIGNALS_JOINT + JOINT_FOLLOWER_ANGLE)
#define LIMIT_MIN (SIGNALS_JOINT + JOINT_LIMIT_MIN)
#define LIMIT_MAX (SIGNALS_JOINT + JOINT_LIMIT_MAX)
#define ERROR (SIGNALS_JOINT + JOINT_ERROR)

// The low-pass of a pot into r19:r18. `pot` is 0..7, `at` the place of its Pot after Z, `share` that of its old
// value's share. Where its sum is at a rail and must not be used, this jumps to `held`.
.macro filtered pot, at, share, held
  ldd r24, Y+2*(\pot)
  ldd r25, Y+2*(\pot)+1
  cp HIGHEST_LOW, r24
  cpc HIGHEST_HIGH, r25
  brcs 2f
  cp r24, LOWEST_LOW
  cpc r25, LOWEST_HIGH
  brcc 5f
1:ldi r22, 1 << (\pot)
  or AT_LOW, r22
  sbrc RAILS, 0
  rjmp \held
  rjmp 5f
2:andi r25, 0x0f       // at a rail, or with marks
  cp HIGHEST_LOW, r24
  cpc HIGHEST_HIGH, r25
  brcs 3f
  cp r24, LOWEST_LOW
  cpc r25, LOWEST_HIGH
  brcs 1b
  ldi r22, 1 << (\pot)
  ldd r18, Z+(\at)+POT_FILTERED
  ldd r19, Z+(\at)+POT_FILTERED+1
  rcall .Lpartly_at_a_rail
  brts 4f
  rjmp 5f
3:ldi r22, 1 << (\pot)
  or AT_HIGH, r22
  sbrs RAILS, 0
  rjmp 5f
4:rjmp \held
5:
  // the old share + sum (r25:r24) * GAIN
  ldd r18, Z+(\share)
  ldd r19, Z+(\share)+1
  mul r24, GAIN
  add r18, r0
  adc r19, r1
  mul r25, GAIN
  add r19, r0
  std Z+(\at)+POT_FILTERED, r18
  std Z+(\at)+POT_FILTERED+1, r19
.endm

// The angle of a pot into r25:r24, from its low-pass in r19:r18.
.macro angle at
  // r25:r24:r23:r22 = offset + filtered * scale (r21:r20)
  ldd r20, Z+(\at)+POT_SCALE
  ldd r21, Z+(\at)+POT_SCALE+1
  ldd r22, Z+(\at)+POT_OFFSET
  ldd r23, Z+(\at)+POT_OFFSET+1
  ldd r24, Z+(\at)+POT_OFFSET+2
  ldd r25, Z+(\at)+POT_OFFSET+3
  mul r18, r20
  add r22, r0
  adc r23, r1
  adc r24, ZERO
  adc r25, ZERO
  mul r19, r20
  add r23, r0
  adc r24, r1
  adc r25, ZERO
  mulsu r21, r18
  sbc r25, ZERO          // the carry is the sign of a mixed product
  add r23, r0
  adc r24, r1
  adc r25, ZERO
  mulsu r21, r19
  add r24, r0
  adc r25, r1
  lsl r23
  rol r24
  rol r25
.endm

.macro joint number
  filtered \number, LEADER, LEADER_OLD_SHARE, .Lleader_held_\number
.Lleader_\number:
  angle LEADER
  ldd r18, Z+LIMIT_MIN
  ldd r19, Z+LIMIT_MIN+1
  cp r24, r18
  cpc r25, r19
  brlt 2f
  ldd r18, Z+LIMIT_MAX
  ldd r19, Z+LIMIT_MAX+1
  cp r18, r24
  cpc r19, r25
  brge 3f
2:movw r24, r18
3:movw r8, r24
  filtered \number+4, FOLLOWER, FOLLOWER_OLD_SHARE, .Lfollower_held_\number
  angle FOLLOWER
  std Z+FOLLOWER_ANGLE, r24
  std Z+FOLLOWER_ANGLE+1, r25
.Lfollower_\number:
  movw r18, r8
  sub r18, r24
  sbc r19, r25
  brvs 5f
  cpi r19, 0x80
  brne 4f
5:rcall .Lsaturate
4:std Z+ERROR, r18
  std Z+ERROR+1, r19
.endm

// A low-pass that is held leaves the angle as it was.
.macro held number
.Lleader_held_\number:
  ldd r18, Z+LEADER+POT_FILTERED
  ldd r19, Z+LEADER+POT_FILTERED+1
  rjmp .Lleader_\number
.Lfollower_held_\number:
  ldd r24, Z+FOLLOWER_ANGLE
  ldd r25, Z+FOLLOWER_ANGLE+1
  rjmp .Lfollower_\number
.endm

  .section .text.app_follow_pots, "ax", @progbits
  .global app_follow_pots
  .type app_follow_pots, @function
app_follow_pots:
  push r28
  push r29
  movw r28, r24
  movw r30, r22
  movw r26, r20
  clr ZERO
  ldd GAIN, Z+SIGNALS_GAIN
  ldd LOWEST_LOW, Z+SIGNALS_LOWEST
  ldd LOWEST_HIGH, Z+SIGNALS_LOWEST+1
  ldd RAILS, Z+SIGNALS_RAILS
  ldd HIGHEST_LOW, Z+SIGNALS_SPAN
  ldd HIGHEST_HIGH, Z+SIGNALS_SPAN+1
  add HIGHEST_LOW, LOWEST_LOW
  adc HIGHEST_HIGH, LOWEST_HIGH
  clr AT_LOW
  clr AT_HIGH
  joint 0
  adiw r30, JOINT_SIZE
  joint 1
  adiw r30, JOINT_SIZE
  joint 2
  adiw r30, JOINT_SIZE
  joint 3
  st X+, AT_LOW
  st X, AT_HIGH
  clr r1
  pop r29
  pop r28
  ret

// The error in r19:r18 has more than 16 bits, and is positive if N is set; or else its upper byte is 0x80. The least error
// is -32767.
.Lsaturate:
  brvc 2f
  brmi 3f
1:ldi r18, 0x01
  ldi r19, 0x80
  ret
2:tst r18
  breq 1b
  ret
3:ldi r18, 0xff
  ldi r19, 0x7f
  ret

  held 0
  held 1
  held 2
  held 3

// Only some conversions of the sum in r25:r24 were at a rail: sets the bit r22 of AT_LOW or AT_HIGH. The pot's low-pass is in
// r19:r18. T says whether it stays as it is.
.Lpartly_at_a_rail:
  clt
  sbrs RAILS, 1
  ret
  bst RAILS, 0
  movw r20, r24
  swap r21
  swap r20
  mov r23, r20
  andi r20, 0xf0
  andi r23, 0x0f
  or r21, r23
  cp r20, r18
  cpc r21, r19
  brcs 1f
  or AT_HIGH, r22
  ret
1:or AT_LOW, r22
  ret
  .size app_follow_pots, . - app_follow_pots
#endif  // __AVR__
