"""Streams to and from other programs: OSC, VMC and LSL, a file each, over the same channels.

Each is an `Instrument` of a session. Robots and players over MQTT are in `app.running.network`.
"""
