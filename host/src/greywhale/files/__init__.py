"""The files that people keep: arms, models, controllers, parameter tables, leader motions and logs.

Each is read whole and checked, or refused in one sentence. Each is written whole or not at all.
"""
