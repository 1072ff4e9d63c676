// follow_pots_portable() of signals.cpp in AVR assembly: the same bits in 700 cycles. test/target/test_signals holds the two equal.
//
//   void app_follow_pots(const uint16_t* sums, Signals* signals, Observation* seen)
//                        r25:r24               r23:r22           r21:r20
//
// For follow_pots() of signals.h only: it uses every register from r8 on, saves only Y, and leaves r1 = 0.
#ifdef __AVR__
#include "signals_layout.h"

#define ZERO r17
#define KEEP r16
#define GAIN r15
#define LOWEST_LOW r13
#define LOWEST_HIGH r14
#define RAILS r10
#define SPAN_LOW r11
#define SPAN_HIGH r12

// Places in the record of one joint, from Z. Z is at Signals for joint 0 and one record further for each next joint.
#define LEADER (SIGNALS_JOINT + JOINT_LEADER)
#define FOLLOWER (SIGNALS_JOINT + JOINT_FOLLOWER)
#define FOLLOWER_ANGLE (SIGNALS_JOINT + JOINT_FOLLOWER_ANGLE)
#define LIMIT_MIN (SIGNALS_JOINT + JOINT_LIMIT_MIN)
#define LIMIT_MAX (SIGNALS_JOINT + JOINT_LIMIT_MAX)
#define ERROR (SIGNALS_JOINT + JOINT_ERROR)

// filtered (r19:r18) = (filtered * KEEP + 128) / 256 + sum (r25:r24) * GAIN
.macro low_pass
  mul r18, KEEP
  lsl r0
  mov r18, r1
  adc r18, ZERO
  mul r19, KEEP
  add r18, r0
  mov r19, r1
  adc r19, ZERO
  mul r24, GAIN
  add r18, r0
  adc r19, r1
  mul r25, GAIN
  add r19, r0
.endm

// The same for a KEEP of 128.
.macro halving_low_pass
  mul r24, GAIN
  lsr r19
  ror r18
  adc r18, r0
  adc r19, r1
  mul r25, GAIN
  add r19, r0
.endm

// The angle of a pot into r25:r24. `pot` is 0..7, `at` the place of its Pot after Z; X is at distance[joint].
.macro angle pot, at, joint, filter
  ldd r24, Y+2*(\pot)
  ldd r25, Y+2*(\pot)+1
  movw r18, r24
  sub r18, LOWEST_LOW
  sbc r19, LOWEST_HIGH
  cp SPAN_LOW, r18
  cpc SPAN_HIGH, r19
  brcc 1f
  ldi r22, 1 << (\pot)
  ldi r23, SEEN_RAIL_LOW - SEEN_DISTANCE - 2*(\joint)
  ldd r18, Z+(\at)+POT_FILTERED
  ldd r19, Z+(\at)+POT_FILTERED+1
  rcall .Lat_a_rail
  brts 6f
1:
  ldd r18, Z+(\at)+POT_FILTERED
  ldd r19, Z+(\at)+POT_FILTERED+1
  \filter
  std Z+(\at)+POT_FILTERED, r18
  std Z+(\at)+POT_FILTERED+1, r19
6:
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

.macro joint number, filter
  angle \number, LEADER, \number, \filter
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
  angle \number+4, FOLLOWER, \number, \filter
  std Z+FOLLOWER_ANGLE, r24
  std Z+FOLLOWER_ANGLE+1, r25
  movw r18, r8
  sub r18, r24
  sbc r19, r25
  brvs 5f
  std Z+ERROR, r18
  std Z+ERROR+1, r19
  brpl 4f
  com r19
  neg r18
  sbci r19, 0xff
  brpl 4f
  rcall .Lleast
  rjmp 4f
5:rcall .Lfar_apart
4:st X+, r18
  st X+, r19
.endm

.macro joints filter
  joint 0, \filter
  adiw r30, JOINT_SIZE
  joint 1, \filter
  adiw r30, JOINT_SIZE
  joint 2, \filter
  adiw r30, JOINT_SIZE
  joint 3, \filter
.endm

  .section .text.app_follow_pots, "ax", @progbits
  .global app_follow_pots
  .type app_follow_pots, @function
app_follow_pots:
  push r28
  push r29
  movw r28, r24
  movw r30, r22
  movw r26, r20   // at the first distance
  clr ZERO
  ldd KEEP, Z+SIGNALS_KEEP
  ldd GAIN, Z+SIGNALS_GAIN
  ldd LOWEST_LOW, Z+SIGNALS_LOWEST
  ldd LOWEST_HIGH, Z+SIGNALS_LOWEST+1
  ldd RAILS, Z+SIGNALS_RAILS
  ldd SPAN_LOW, Z+SIGNALS_SPAN
  ldd SPAN_HIGH, Z+SIGNALS_SPAN+1
  cpi KEEP, 128
  brne 1f
  rjmp .Lhalving
1:joints low_pass
.Ldone:
  clr r1
  pop r29
  pop r28
  ret

.Lhalving:   // filter_shift's default
  joints halving_low_pass
  rjmp .Ldone

// The error has more than 16 bits; it is positive if N is set. It saturates; the distance, in r19:r18, does not.
.Lfar_apart:
  ldi r24, 0xff
  ldi r25, 0x7f
  brmi 1f
  com r19
  neg r18
  sbci r19, 0xff
// The least error is -32767.
.Lleast:
  ldi r24, 0x01
  ldi r25, 0x80
1:std Z+ERROR, r24
  std Z+ERROR+1, r25
  ret

// The sum in r25:r24 is at a rail, or has marks: takes them off, and sets the bit r22 of rail_low or rail_high. rail_low
// is at X + r23; the pot's low-pass is in r19:r18. T says whether it stays as it is.
.Lat_a_rail:
  andi r25, 0x0f
  clt
  sbrs RAILS, 1
  ret
  movw r20, r26
  add r26, r23
  adc r27, ZERO
  cp r24, LOWEST_LOW
  cpc r25, LOWEST_HIGH
  brcs 2f
  movw r0, r24
  sub r0, LOWEST_LOW
  sbc r1, LOWEST_HIGH
  cp SPAN_LOW, r0
  cpc SPAN_HIGH, r1
  brcs 1f
  movw r0, r24        // only some conversions were at a rail
  lsl r0
  rol r1
  lsl r0
  rol r1
  lsl r0
  rol r1
  lsl r0
  rol r1
  cp r0, r18
  cpc r1, r19
  brcs 2f
1:adiw r26, 1
2:ld r23, X
  or r23, r22
  st X, r23
  movw r26, r20
  bst RAILS, 0
  ret
  .size app_follow_pots, . - app_follow_pots
#endif  // __AVR__
