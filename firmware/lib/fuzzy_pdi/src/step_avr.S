// step() of fuzzy_pdi.h in AVR assembly: the same bits in a quarter of the cycles. Optional: defining FUZZY_PDI_PORTABLE compiles the
// C++ of fuzzy_pdi.cpp instead. The tests hold the two equal.
//
//   Output fuzzy_pdi_step(const Coefficients *c, State *state, int16_t leader, int16_t follower, uint16_t limit_mv)
//                         r25:r24                r23:r22       r21:r20         r19:r18           r17:r16
//   returns u_fuzzy in r19:r18, volts_mv in r21:r20, saturated in r22, no_rule in r23
//
// fuzzy_pdi_step_bare is the same for a caller in assembly that wants to save registers once for several joints: it uses every
// register but r28 and r29, and leaves r1 = 0.
#if defined(__AVR__) && !defined(FUZZY_PDI_PORTABLE)

// Coefficients and State, see the assertions in fuzzy_pdi.cpp.
#define SIDE_SIZE 9
#define C_CE (2 * SIDE_SIZE)
#define C_INTEGRAL (4 * SIDE_SIZE)
#define C_KU (4 * SIDE_SIZE + 4)
#define STATE_INTEGRAL 0
#define STATE_FRACTION 4
#define STATE_PREVIOUS 6
#define STATE_STARTED 8

// Across the inference: r3:r2 coefficients, Y state, r5:r4 limit, r9:r8 size of e, r6 sign of e (bit 7).
// After it: r3:r2 size of u_fuzzy, r7 no_rule, T its sign.
#define E_SIGN r6
#define NO_RULE r7
#define ZERO r16
#define SCRATCH r17

// high:low = a - b, saturated to +-32767
.macro difference low, high, b_low, b_high
  sub \low, \b_low
  sbc \high, \b_high
  brvs 1f
  cpi \high, 0x80
  brne 3f
  cpi \low, 0
  brne 3f
  ldi \low, 1  // -32768
  rjmp 3f
1:ldi \low, 0xFF
  ldi \high, 0x7F
  brmi 3f  // the difference was too large; too small:
  ldi \low, 0x01
  ldi \high, 0x80
3:
.endm

.macro negate16 low, high
  neg \high
  neg \low
  sbc \high, ZERO
.endm

// r31:r30 = size of drive + integral in mV, rounded; SCRATCH: its sign in bit 7. drive in r27..r24, integral in r31:r30:r9:r8.
.macro volts
  add r8, r24
  adc r9, r25
  adc r30, r26
  adc r31, r27
  mov SCRATCH, r31
  brpl 4f
  com r31
  com r30
  com r9
  com r8
  adc r8, ZERO
  adc r9, ZERO
  adc r30, ZERO
  adc r31, ZERO
4:lsl r8
  rol r9
  rol r30
  rol r31
  lsl r9
  adc r30, ZERO
  adc r31, ZERO
.endm

// A byte of the integral's factor times the size of e.
.macro integral_row at, low, mid, hi
  ldd SCRATCH, Z+(C_INTEGRAL + \at)
  mul r9, SCRATCH
  mov \hi, r1
  add \mid, r0
  adc \hi, ZERO
  mul r8, SCRATCH
  add \low, r0
  adc \mid, r1
  adc \hi, ZERO
.endm

.macro plus register, at
  ldd SCRATCH, Y+\at
  adc \register, SCRATCH
.endm

.macro minus register, at
  ldd SCRATCH, Y+\at
  sbc SCRATCH, \register
  mov \register, SCRATCH
.endm

  .section .text.fuzzy_pdi_step, "ax", @progbits
  .global fuzzy_pdi_step
  .type fuzzy_pdi_step, @function
fuzzy_pdi_step:
  push r2
  push r3
  push r4
  push r5
  push r6
  push r7
  push r8
  push r9
  push r10
  push r11
  push r12
  push r13
  push r14
  push r15
  push r16
  push r17
  rcall fuzzy_pdi_step_bare
  pop r17
  pop r16
  pop r15
  pop r14
  pop r13
  pop r12
  pop r11
  pop r10
  pop r9
  pop r8
  pop r7
  pop r6
  pop r5
  pop r4
  pop r3
  pop r2
  ret
  .size fuzzy_pdi_step, . - fuzzy_pdi_step

  .global fuzzy_pdi_step_bare
  .type fuzzy_pdi_step_bare, @function
fuzzy_pdi_step_bare:
  push r28
  push r29
  movw r2, r24
  movw r28, r22
  movw r4, r16
  clr ZERO

  // e in r23:r22, its change in r19:r18
  movw r22, r20
  difference r22, r23, r18, r19
  ldd r20, Y+STATE_PREVIOUS
  ldd r21, Y+STATE_PREVIOUS+1
  std Y+STATE_PREVIOUS, r22
  std Y+STATE_PREVIOUS+1, r23
  ldd SCRATCH, Y+STATE_STARTED
  tst SCRATCH
  brne 1f
  rjmp .Lfirst
1:  movw r18, r22
  difference r18, r19, r20, r21

  // sizes; the sides' addresses in r25:r24 and r21:r20
.Lsplit:
  movw r20, r2
  subi r20, lo8(-C_CE)
  sbci r21, hi8(-C_CE)
  mov E_SIGN, r23
  mov SCRATCH, r23
  eor SCRATCH, r19  // bit 7: opposite signs
  tst r23
  brpl 1f
  negate16 r22, r23
  adiw r24, SIDE_SIZE
1:tst r19
  brpl 2f
  negate16 r18, r19
  subi r20, lo8(-SIDE_SIZE)
  sbci r21, hi8(-SIDE_SIZE)
2:movw r8, r22
  lsl SCRATCH
  ldi r16, 1
  sbci r16, 0
  call fuzzy_pdi_infer_bare

  mov NO_RULE, r25
  movw r30, r2
  movw r2, r22
  clr ZERO
  mov SCRATCH, E_SIGN
  sbrc r24, 0
  com SCRATCH
  bst SCRATCH, 7

  // drive = size of u * Ku in r27..r24
  ldd r20, Z+C_KU
  ldd r21, Z+C_KU+1
  mul r22, r20
  movw r24, r0
  mul r23, r21
  movw r26, r0
  mul r23, r20
  add r25, r0
  adc r26, r1
  adc r27, ZERO
  mul r22, r21
  add r25, r0
  adc r26, r1
  adc r27, ZERO
  brtc 1f
  com r27
  com r26
  com r25
  neg r24
  sbci r25, 0xFF
  sbci r26, 0xFF
  sbci r27, 0xFF

1:// what e adds to the integral, in r23..r18: fraction r19:r18, whole r23..r20
  ldd SCRATCH, Z+C_INTEGRAL
  mul r9, SCRATCH
  mov r19, r0
  mov r20, r1
  mul r8, SCRATCH
  mov r18, r0
  add r19, r1
  adc r20, ZERO
  integral_row 1, r19, r20, r21
  integral_row 2, r20, r21, r22
  ldd SCRATCH, Z+(C_INTEGRAL + 3)
  tst SCRATCH
  brne 2f
  clr r23  // as with any ordinary Ki
  rjmp 3f
2:integral_row 3, r21, r22, r23
3:  sbrc E_SIGN, 7
  rjmp .Ldown
  ldd SCRATCH, Y+STATE_FRACTION
  add r18, SCRATCH
  plus r19, STATE_FRACTION+1
  plus r20, STATE_INTEGRAL
  plus r21, STATE_INTEGRAL+1
  plus r22, STATE_INTEGRAL+2
  plus r23, STATE_INTEGRAL+3
.Ltaken:
  mov SCRATCH, r23
  lsl SCRATCH
  eor SCRATCH, r23
  brpl .Lclamped
  rjmp .Lclamp
.Lclamped:
  movw r8, r20
  movw r30, r22
  volts
  cp r4, r30
  cpc r5, r31
  brcc 1f
  rjmp .Lsaturated
1:ldi r24, 0
.Lstore:
  std Y+STATE_FRACTION, r18
  std Y+STATE_FRACTION+1, r19
  std Y+STATE_INTEGRAL, r20
  std Y+STATE_INTEGRAL+1, r21
  std Y+STATE_INTEGRAL+2, r22
  std Y+STATE_INTEGRAL+3, r23

.Lreturn:
  movw r18, r2
  sbrs r19, 7
  rjmp 1f
  ldi r18, 0xFF  // 1.0
  ldi r19, 0x7F
1:brtc 2f
  negate16 r18, r19
2:movw r20, r30
  sbrs SCRATCH, 7
  rjmp 3f
  negate16 r20, r21
3:mov r22, r24
  mov r23, NO_RULE
  clr r1
  pop r29
  pop r28
  ret

.Lfirst:
  ldi SCRATCH, 1
  std Y+STATE_STARTED, SCRATCH
  ldi r18, 0
  ldi r19, 0
  rjmp .Lsplit

.Ldown:
  ldd SCRATCH, Y+STATE_FRACTION
  sub SCRATCH, r18
  mov r18, SCRATCH
  minus r19, STATE_FRACTION+1
  minus r20, STATE_INTEGRAL
  minus r21, STATE_INTEGRAL+1
  minus r22, STATE_INTEGRAL+2
  minus r23, STATE_INTEGRAL+3
  rjmp .Ltaken

// Beyond +-2^30: 2^30 - 2^-16 or -2^30.
.Lclamp:
  ldi r18, 0xFF
  ldi r23, 0x3F
  sbrs E_SIGN, 7
  rjmp 1f
  ldi r18, 0x00
  ldi r23, 0xC0
1:mov r19, r18
  mov r20, r18
  mov r21, r18
  mov r22, r18
  rjmp .Lclamped

// Beyond the limit: on e's own side the integral stays as it was.
.Lsaturated:
  mov r1, SCRATCH
  eor r1, E_SIGN
  brmi 1f
  ldd r8, Y+STATE_INTEGRAL
  ldd r9, Y+STATE_INTEGRAL+1
  ldd r30, Y+STATE_INTEGRAL+2
  ldd r31, Y+STATE_INTEGRAL+3
  volts
  ldi r24, 1
  cp r4, r30
  cpc r5, r31
  brcc 2f
  movw r30, r4
2:rjmp .Lreturn
1:movw r30, r4
  ldi r24, 1
  rjmp .Lstore
  .size fuzzy_pdi_step_bare, . - fuzzy_pdi_step_bare
#endif
