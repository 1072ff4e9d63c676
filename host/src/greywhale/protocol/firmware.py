"""The constants of the firmware that no parameter changes: joints, ticks, and the steps of each board's PWM."""

from __future__ import annotations

from greywhale.protocol.schema import Board, LeadPointRequest, Sample

JOINTS = 4  # of the firmware; an arm may use fewer
# One tick, s: the firmware samples the potentiometers a thousand times a second.
TICK_S = 1e-3
# Conversions of each potentiometer in a tick; the firmware adds them up.
CONVERSIONS = 4
CONVERTER_COUNTS = 1024  # of 10 bits
# The unit of an angle in samples and limits, rad.
ANGLE_LSB = Sample.LSB["leader"]
# While the host leads: so many ticks from one point of the reference to the next, and the longest step between them.
POINT_TICKS = 16
POINT_S = POINT_TICKS * TICK_S
STEP_LSB = LeadPointRequest.LSB["step"]  # rad
LONGEST_STEP = 127  # in STEP_LSB
FASTEST_LED_RAD_S = LONGEST_STEP * STEP_LSB / POINT_S
# PWM steps from 0 to full of each joint's motor. A Nano's last two motors are on an 8-bit timer.
PWM_STEPS = {Board.MEGA2560: (400, 400, 400, 400), Board.NANO328: (400, 400, 255, 255)}


def pwm_steps(board: Board) -> tuple[int, int, int, int]:
    """The PWM steps of all four joints. A board that is no Arduino we know (another tool's log) counts as a Mega."""
    return PWM_STEPS.get(board, PWM_STEPS[Board.MEGA2560])
