"""A robot as a MAVLink rover: `vehicle` composes it of microservices, each of which handles and sends messages.

Microservices are in `command`, `mission`, `mode`, `parameter`, `component_files`, `telemetry` and `ping_timesync`.
Their commands lead to `mode.state_machine`, which moves the robot in its mode, for the station in command.
"""
