"""Robot as a MAVLink rover.

`vehicle` composes the rover from microservices. Each microservice handles and sends messages.

The microservices are in `command`, `mission`, `mode`, `parameter`, `component_files`, `telemetry` and `ping_timesync`.
They pass commands to `mode.state_machine`. It moves the robot in its current mode, for the station that commands it.
"""
