// step_error() of fuzzy_pdi.h in AVR assembly: the same bits in a quarter of the cycles. Optional: defining FUZZY_PDI_PORTABLE
// compiles the C++ of fuzzy_pdi.cpp instead. The tests hold the two equal.
//
//   Output fuzzy_pdi_step_error(Joint *joint, int16_t error, uint16_t limit_mv)
//                               r25:r24       r23:r22        r21:r20
//   returns u_fuzzy in r19:r18, volts_mv in r21:r20, saturated in r22, no_rule in r23
//
// fuzzy_pdi_step_bare does the work, for callers that save registers once for several joints:
//
//   takes    joint in r31:r30, error (+-32767) in r25:r24, limit_mv in r5:r4
//   returns  size of the voltage in r27:r26, its sign in bit 7 of r17; no_rule in r6; saturated in T;
//            size of u_fuzzy (up to 32768) in r3:r2, its sign in bit 7 of r7
//
// It uses every register but r5:r4 and r29:r28, and leaves r1 = 0.
#if defined(__AVR__) && !defined(FUZZY_PDI_PORTABLE)

// Joint, see the assertions in fuzzy_pdi.cpp: the coefficients
#define SIDE_SIZE 9
#define C_CE (2 * SIDE_SIZE)
#define C_INTEGRAL (4 * SIDE_SIZE)
#define C_KU (4 * SIDE_SIZE + 4)
// and the state.
#define C_CE_TICKS (4 * SIDE_SIZE + 6)
#define STATE (4 * SIDE_SIZE + 7)
#define STATE_INTEGRAL (STATE + 0)
#define STATE_FRACTION (STATE + 4)
#define STATE_UNTIL_CHANGE (STATE + 6)
#define STATE_OLDEST (STATE + 7)
#define STATE_ERRORS (STATE + 8)

// r3:r2 holds the joint until the inference is done, then the size of u_fuzzy. r9:r8 is the size of e. Signs in bit 7:
#define E_SIGN r6  /* until the inference is done, then in T */
#define U_SIGN r7
#define SIGN r17   /* of the voltage */
#define NO_RULE r6
#define SCRATCH r17

#include "memberships_avr.inc"

.macro negate16 low, high
  neg \high
  neg \low
  sbc \high, ZERO
.endm

// r27:r26 = size in mV of drive (r27..r24, at least 0) + integral (i3..i0), rounded half away from zero. All is seen from
// u's side: where u is below 0 the integral is taken off, and SIGN begins as negative.
.macro volts i0, i1, i2, i3
  mov SIGN, U_SIGN
  sbrc U_SIGN, 7
  rjmp 4f
  add r24, \i0
  adc r25, \i1
  adc r26, \i2
  adc r27, \i3
  brmi 5f
3:lsl r24
  rol r25
  rol r26
  rol r27
  lsl r25
  adc r26, ZERO
  adc r27, ZERO
  rjmp 6f
4:sub r24, \i0
  sbc r25, \i1
  sbc r26, \i2
  sbc r27, \i3
  brpl 3b
5:com SIGN
  lsl r24
  rol r25
  rol r26
  rol r27
  com r26  // -upper half, less one if the lower half is above 1/2
  com r27
  subi r24, 0x01
  sbci r25, 0x80
  adc r26, ZERO
  adc r27, ZERO
6:
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

  .section .text.fuzzy_pdi_step_bare, "ax", @progbits
  .type fuzzy_pdi_step_detours, @function
fuzzy_pdi_step_detours:
.Lslow_e:
  rjmp .Lslow_far_e

.Lno_change:
  dec S
  std Z+STATE_UNTIL_CHANGE, S
  clr S
  ldi r18, 0
  ldi r19, 0
  rjmp .Lchange

// The change is beyond 16 bits, and its sign the wrong one.
.Loverflow:
  com S
.Lmost:
  ldi r18, 0xFF
  ldi r19, 0x7F
  rjmp .Lchange
  .size fuzzy_pdi_step_detours, . - fuzzy_pdi_step_detours

  .global fuzzy_pdi_step_bare
  .type fuzzy_pdi_step_bare, @function
fuzzy_pdi_step_bare:
  clr ZERO
  movw r2, r30

  // e takes the place of the oldest error, which goes to r21:r20
  movw r26, r30
  ldd r18, Z+STATE_OLDEST
  add r26, r18
  adc r27, ZERO
  add r26, r18
  adc r27, ZERO
  adiw r26, STATE_ERRORS
  ld r20, X+
  ld r21, X
  st X, r25
  st -X, r24
  inc r18
  ldd r19, Z+C_CE_TICKS
  cp r18, r19
  brlo 1f
  clr r18
1:std Z+STATE_OLDEST, r18

  // size of e's change in r19:r18, its sign in S
  ldd S, Z+STATE_UNTIL_CHANGE
  tst S
  brne .Lno_change
  movw r18, r24
  sub r18, r20
  sbc r19, r21
  mov S, r19
  brvs .Loverflow
  brpl .Lchange
  negate16 r18, r19
  brmi .Lmost  // -32768 counts as -32767
.Lchange:
  eor S, r25
  bst S, 7  // T: opposite signs

  // size of e in r9:r8; Z at its side
  mov E_SIGN, r25
  movw r8, r24
  tst r25
  brpl 1f
  negate16 r8, r9
  adiw r30, SIDE_SIZE
1:
fuzzy_pdi_inference:
  ldi HALF, 0x80
  .set SIDE, 0
  fuzzify e, r8, r9, a0, a1, a2, A0, A1, A2
  rjmp .Ldone_e
  fuzzify_detours e, r8, r9, a0, a1, a2, A0, A1, A2
  fuzzify_slowly e, r8, r9, a0, a1, a2, A0, A1, A2
  .set SIDE, C_CE
  fuzzify_slowly ce, r18, r19, b0, b1, b2, B0, B1, B2
.Lslow_ce:
  rjmp .Lslow_far_ce
.Ldone_e:
  brtc 1f
  adiw r30, SIDE_SIZE  // the other side
  sbrc E_SIGN, 7
  sbiw r30, 2 * SIDE_SIZE
1:
  fuzzify ce, r18, r19, b0, b1, b2, B0, B1, B2
.Ldone_ce:
#include "rules_avr.inc"
fuzzy_pdi_inferred:

  // size of u_fuzzy in r25:r24, T: against e
  movw r30, r2
  movw r2, r24
  mov U_SIGN, E_SIGN
  brtc 1f
  com U_SIGN
1:
  bst E_SIGN, 7

  // drive = size of u * Ku in r27..r24
  ldd r20, Z+C_KU
  ldd r21, Z+C_KU+1
  mul r2, r20
  movw r24, r0
  mul r3, r21
  movw r26, r0
  mul r3, r20
  add r25, r0
  adc r26, r1
  adc r27, ZERO
  mul r2, r21
  add r25, r0
  adc r26, r1
  adc r27, ZERO

  // what e adds to the integral in r15..r10
  mov NO_RULE, NONE
  ldd SCRATCH, Z+C_INTEGRAL
  mul r8, SCRATCH
  movw r10, r0
  mul r9, SCRATCH
  add r11, r0
  mov r12, r1
  adc r12, ZERO
  integral_row 1, r11, r12, r13
  integral_row 2, r12, r13, r14
  ldd SCRATCH, Z+(C_INTEGRAL + 3)
  clr r15
  tst SCRATCH
  breq .Lmore  // as with any ordinary Ki
  mul r9, SCRATCH
  mov r15, r1
  add r14, r0
  adc r15, ZERO
  mul r8, SCRATCH
  add r13, r0
  adc r14, r1
  adc r15, ZERO
.Lmore:
  ldd r18, Z+STATE_FRACTION
  ldd r19, Z+STATE_FRACTION+1
  ldd r20, Z+STATE_INTEGRAL
  ldd r21, Z+STATE_INTEGRAL+1
  ldd r22, Z+STATE_INTEGRAL+2
  ldd r23, Z+STATE_INTEGRAL+3
  movw r8, r20  // the integral as it was goes to r11..r8
  brtc .Lup  // e below 0 is the dearer side until here
  sub r18, r10
  sbc r19, r11
  movw r10, r22
  sbc r20, r12
  sbc r21, r13
  sbc r22, r14
  sbc r23, r15
.Ltaken:
  mov SCRATCH, r23
  lsl SCRATCH
  eor SCRATCH, r23
  brmi .Lclamp
.Lclamped:
  movw r12, r24
  movw r14, r26
  volts r20, r21, r22, r23
  cp r4, r26
  cpc r5, r27
  brcs .Lsaturated
  clt
.Lstore:
  std Z+STATE_FRACTION, r18
  std Z+STATE_FRACTION+1, r19
  std Z+STATE_INTEGRAL, r20
  std Z+STATE_INTEGRAL+1, r21
  std Z+STATE_INTEGRAL+2, r22
  std Z+STATE_INTEGRAL+3, r23
  clr r1
  ret

.Lup:
  add r18, r10
  adc r19, r11
  movw r10, r22
  adc r20, r12
  adc r21, r13
  adc r22, r14
  adc r23, r15
  rjmp .Ltaken

// Beyond +-2^30: 2^30 - 2^-16 or -2^30.
.Lclamp:
  ldi r18, 0xFF
  ldi r23, 0x3F
  brtc 1f
  ldi r18, 0x00
  ldi r23, 0xC0
1:mov r19, r18
  movw r20, r18
  mov r22, r18
  rjmp .Lclamped

// Beyond the limit: on e's own side the integral stays as it was.
.Lsaturated:
  bld r0, 7
  eor r0, SIGN
  set
  sbrc r0, 7
  rjmp 2f
  movw r24, r12
  movw r26, r14
  volts r8, r9, r10, r11
  cp r4, r26
  cpc r5, r27
  brcc 3f
  movw r26, r4
3:clr r1
  ret
2:movw r26, r4
  rjmp .Lstore

  .size fuzzy_pdi_step_bare, . - fuzzy_pdi_step_bare

  .global fuzzy_pdi_step_error
  .type fuzzy_pdi_step_error, @function
fuzzy_pdi_step_error:
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
  movw r30, r24
  movw r24, r22
  movw r4, r20
  rcall fuzzy_pdi_step_bare
  clr ZERO
  movw r20, r26
  sbrs SIGN, 7
  rjmp 1f
  negate16 r20, r21
1:movw r18, r2
  sbrs r19, 7
  rjmp 2f
  ldi r18, 0xFF  // 1.0
  ldi r19, 0x7F
2:sbrs U_SIGN, 7
  rjmp 3f
  negate16 r18, r19
3:ldi r22, 0
  bld r22, 0
  mov r23, NO_RULE
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
  .size fuzzy_pdi_step_error, . - fuzzy_pdi_step_error

// Two pages: the shift that normalises a sum with this top byte, as a factor; and the reciprocals R - 256.
  .section .progmem.data.fuzzy_pdi_tables, "a", @progbits
  .balign 256
fuzzy_pdi_tables:
  .byte 0, 128, 64, 64
  .fill 4, 1, 32
  .fill 8, 1, 16
  .fill 16, 1, 8
  .fill 32, 1, 4
  .fill 64, 1, 2
  .fill 128, 1, 1
  .set i, 0
  .rept 256
  .byte 131072 / (257 + i) - 256
  .set i, i + 1
  .endr
#endif
