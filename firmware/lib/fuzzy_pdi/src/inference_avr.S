// infer() of inference.h in AVR assembly: the same bits in a quarter of the cycles. Optional: defining FUZZY_PDI_PORTABLE compiles the
// C++ there instead. The tests hold the two equal.
//
//   Defuzzified fuzzy_pdi_infer(const Side *e, uint16_t e_size, const Side *ce, uint16_t ce_size, bool same_sign)
//                               r25:r24        r23:r22          r21:r20         r19:r18           r16
//   returns size in r23:r22, flip in r24, no_rule in r25
//
// fuzzy_pdi_infer_bare is the same without saving r10..r17, for step_avr.S.
#if defined(__AVR__) && !defined(FUZZY_PDI_PORTABLE)

#include "inference_avr.inc"

// ---- Rules -----------------------------------------------------------------------------------------------------------------
.macro compare x0, x1, x2, y0, y1, y2
  cp \x0, \y0
  cpc \x1, \y1
  cpc \x2, \y2
.endm

// x = min(x, y)
.macro lesser x0, x1, x2, y0, y1, y2
  compare \y0, \y1, \y2, \x0, \x1, \x2
  brcc 20f
  mov \x0, \y0
  mov \x1, \y1
  mov \x2, \y2
20:
.endm

// x = max(x, y)
.macro greater x0, x1, x2, y0, y1, y2
  compare \x0, \x1, \x2, \y0, \y1, \y2
  brcc 20f
  mov \x0, \y0
  mov \x1, \y1
  mov \x2, \y2
20:
.endm

.macro add3 x0, x1, x2, y0, y1, y2
  add \x0, \y0
  adc \x1, \y1
  adc \x2, \y2
.endm

.macro sub3 x0, x1, x2, y0, y1, y2
  sub \x0, \y0
  sbc \x1, \y1
  sbc \x2, \y2
.endm

// com leaves the carry set.
.macro negate x0, x1, x2
  ldi S, 0
  com \x0
  com \x1
  com \x2
  adc \x0, S
  adc \x1, S
  adc \x2, S
.endm

// Into the fourth byte of the sum.
#define SUM3 ZERO
.macro carry
  brcc 20f
  inc SUM3
20:
.endm

  .section .text.fuzzy_pdi_infer_bare, "ax", @progbits
  .global fuzzy_pdi_infer_bare
  .type fuzzy_pdi_infer_bare, @function
fuzzy_pdi_infer_bare:
  bst r16, 0
  clr ZERO
  ldi HALF, 0x80
  movw r30, r24
  rjmp 19f
.Lslow_e:
  rjmp .Lslow_e_far
.Lsmall_e:
  rjmp .Lsmall_e_far
19:
  fuzzify .Lslow_e, .Lslow_e_far, .Lsmall_e, .Lsmall_e_far, r22, r23, a0, a1, a2, A0, A1, A2
  rjmp 19f
.Lslow_ce:
  rjmp .Lslow_ce_far
.Lsmall_ce:
  rjmp .Lsmall_ce_far
19:movw r30, r20
  fuzzify .Lslow_ce, .Lslow_ce_far, .Lsmall_ce, .Lsmall_ce_far, r18, r19, b0, b1, b2, B0, B1, B2
19:
// From here: with - against ends in A, its sign in T (flip), with + zero + against in SUM3:a.
  compare b0, b1, b2, a0, a1, a2
  brcs .Lb_is_less
  brts .La_least_same
  rjmp .La_least_opposite
.Lb_is_less:
  brts .Lb_least_same
  rjmp .Lb_least_opposite

// Same sign, a <= b: zero = a. with = max(min(a, B), min(A, max(b, B))): the second unless A < a.
.La_least_same:
  clt
  compare A0, A1, A2, a0, a1, a2
  brcs 1f
  greater b0, b1, b2, B0, B1, B2
  lesser A0, A1, A2, b0, b1, b2
2:add3 a0, a1, a2, A0, A1, A2
  carry
  rjmp .Ldivide
1:lesser B0, B1, B2, a0, a1, a2
  greater A0, A1, A2, B0, B1, B2
  rjmp 2b

// The same with the inputs exchanged: zero = b.
.Lb_least_same:
  clt
  compare B0, B1, B2, b0, b1, b2
  brcs 1f
  greater a0, a1, a2, A0, A1, A2
  lesser B0, B1, B2, a0, a1, a2
2:movw r10, r20
  movw r12, r22
  movw r14, r24
  add3 a0, a1, a2, A0, A1, A2
  carry
  rjmp .Ldivide
1:lesser A0, A1, A2, b0, b1, b2
  greater B0, B1, B2, A0, A1, A2
  rjmp 2b

// Opposite signs: with = min(A, b), against = min(a, B), zero = max(min(a, b), min(A, B)).
// a <= b: zero = max(a, min(A, B)).
.La_least_opposite:
  compare B0, B1, B2, a0, a1, a2
  brcc 1f
  // B < a: against = B, zero = a
  lesser A0, A1, A2, b0, b1, b2
  rjmp .Lwith_A_against_B_zero_a
1:compare A0, A1, A2, a0, a1, a2
  brcs 2f
  // a is the least of all: against = a, zero = min(A, B)
  lesser B0, B1, B2, A0, A1, A2
  lesser b0, b1, b2, A0, A1, A2
  rjmp .Lwith_b_against_a_zero_B
2:// A < a <= b, B: with = A, against = a, zero = a
  mov B0, a0
  mov B1, a1
  mov B2, a2
  rjmp .Lwith_A_against_B_zero_a

// b < a: zero = max(b, min(A, B)).
.Lb_least_opposite:
  compare A0, A1, A2, b0, b1, b2
  brcc 1f
  // A < b: with = A, zero = b
  lesser B0, B1, B2, a0, a1, a2
  mov a0, b0
  mov a1, b1
  mov a2, b2
  rjmp .Lwith_A_against_B_zero_a
1:compare B0, B1, B2, b0, b1, b2
  brcs 2f
  // b is the least of all: with = b, zero = min(A, B)
  lesser a0, a1, a2, B0, B1, B2
  lesser B0, B1, B2, A0, A1, A2
  rjmp .Lwith_b_against_a_zero_B
2:// B < b <= A, b < a: with = b, against = B, zero = b
  mov a0, b0
  mov a1, b1
  mov a2, b2
  mov A0, b0
  mov A1, b1
  mov A2, b2

.Lwith_A_against_B_zero_a:
  add3 a0, a1, a2, A0, A1, A2
  carry
  add3 a0, a1, a2, B0, B1, B2
  carry
  sub3 A0, A1, A2, B0, B1, B2
  brcs .Lagainst_is_more
  rjmp .Ldivide

.Lwith_b_against_a_zero_B:
  mov A0, b0
  mov A1, b1
  mov A2, b2
  sub3 A0, A1, A2, a0, a1, a2
  brcc 1f
  set
  negate A0, A1, A2
1:add3 a0, a1, a2, b0, b1, b2
  carry
  add3 a0, a1, a2, B0, B1, B2
  carry
  rjmp .Ldivide

.Ltoo_big:
  lsr SUM3
  ror a2
  ror a1
  ror a0
  lsr A2
  ror A1
  ror A0
  tst SUM3
  brne .Ltoo_big
.Lin_place:
  movw r20, a0
  mov r22, a2
  mov r26, A0
  mov r27, A1
  mov r23, A2
  ldi r31, hi8(fuzzy_pdi_tables)
  rjmp .Lnormalised

.Lnothing:
  ldi r22, 0
  ldi r23, 0
  ldi r25, 1
  clt
  rjmp .Linferred

.Lagainst_is_more:
  set
  negate A0, A1, A2

// ---- Defuzzification: A / (SUM3:a), see ratio_q15() ------------------------------------------------------------------------
// Normalised into d = r22:r21:r20 (2^23..2^24-1) and n = r23:r27:r26.
.Ldivide:
  tst SUM3
  brne .Ltoo_big
  tst a2
  breq .Lnothing
  brmi .Lin_place
  ldi r31, hi8(fuzzy_pdi_tables)
  mov r30, a2
  lpm r18, Z
  mul a0, r18
  movw r20, r0
  mul a1, r18
  or r21, r0
  mov r22, r1
  mul a2, r18
  or r22, r0
  mul A0, r18
  movw r26, r0
  mul A1, r18
  or r27, r0
  mov r23, r1
  mul A2, r18
  or r23, r0

.Lnormalised:
  mov r30, r21
  lsl r30
  mov r30, r22
  rol r30
  inc r31
  lpm r19, Z  // R - 256
  // d * R, its bytes 1..3 in r12:r11:r10
  mul r21, r19
  movw r10, r0
  mul r22, r19
  mov r12, r1
  add r11, r0
  adc r12, ZERO
  mul r20, r19
  add r10, r1
  adc r11, ZERO
  adc r12, ZERO
  add3 r10, r11, r12, r20, r21, r22
  // E in r11:r10
  lsr r12
  ror r11
  ror r10
  com r11
  com r10
  // + E^2
  mul r11, r11
  lsl r0
  rol r1
  adc r11, ZERO
  add r10, r1
  adc r11, ZERO
  // n * R, its bytes 1..3 in r25:r24:r22
  mul r27, r19
  mov r22, r0
  mov r24, r1
  mul r23, r19
  mov r25, r1
  add r24, r0
  adc r25, ZERO
  mul r26, r19
  add r22, r1
  adc r24, ZERO
  adc r25, ZERO
  add3 r22, r24, r25, r26, r27, r23
  // times (E + E^2)
  mul r25, r11
  movw r20, r0
  mul r25, r10
  add r20, r1
  adc r21, ZERO
  mul r24, r11
  add r20, r1
  adc r21, ZERO
  lsl r20
  rol r21
  adc r25, ZERO
  add3 r22, r24, r25, r20, r21, ZERO
  // to q15
  adiw r24, 1
  ror r25
  ror r24
  movw r22, r24
  ldi r25, 0
.Linferred:
  ldi r24, 0
  bld r24, 0
  clr r1
  ret
  .size fuzzy_pdi_infer_bare, . - fuzzy_pdi_infer_bare

  .section .text.fuzzy_pdi_infer, "ax", @progbits
  .global fuzzy_pdi_infer
  .type fuzzy_pdi_infer, @function
fuzzy_pdi_infer:
  push r10
  push r11
  push r12
  push r13
  push r14
  push r15
  push r16
  push r17
  call fuzzy_pdi_infer_bare
  pop r17
  pop r16
  pop r15
  pop r14
  pop r13
  pop r12
  pop r11
  pop r10
  ret
  .size fuzzy_pdi_infer, . - fuzzy_pdi_infer

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
