"""Idle motion of a person: a posture space, balance shifts, and small variations.

Source: Egges, *Real-time Animation of Interactive Virtual Humans*, PhD thesis, Geneva, 2006.
"""
