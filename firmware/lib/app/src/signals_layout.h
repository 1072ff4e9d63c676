// Where signals_avr.S finds what it reads and writes. signals.cpp checks every place against the C++ structures.
#pragma once

// In Signals
#define SIGNALS_GAIN 1
#define SIGNALS_LOWEST 2
#define SIGNALS_SPAN 4
#define SIGNALS_RAILS 6
#define SIGNALS_JOINT 7

// In JointSignals, which are in a row
#define JOINT_LEADER 0
#define JOINT_FOLLOWER 8
#define JOINT_LEADER_OLD_SHARE 16
#define JOINT_FOLLOWER_OLD_SHARE 18
#define JOINT_FOLLOWER_ANGLE 20
#define JOINT_LIMIT_MIN 22
#define JOINT_LIMIT_MAX 24
#define JOINT_ERROR 26
#define JOINT_SIZE 28

// In Pot
#define POT_FILTERED 0
#define POT_SCALE 2
#define POT_OFFSET 4

// In Observation: the lower rails, just behind them the upper ones
#define SEEN_RAIL_LOW 0
