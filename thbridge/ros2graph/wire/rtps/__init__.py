"""RTPS 2.3, the protocol of DDS, as state machines of datagrams: no sockets and no clocks.

Source: OMG DDSI-RTPS 2.3. Fast DDS and Cyclone DDS are the implementations that robots use; remarks name them where the
specification leaves a choice.
"""
