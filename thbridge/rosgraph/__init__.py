"""ROS 1 graph: XML-RPC, master, node and TCPROS as `wire`, the same over TCP as `sockets`, and its `files`."""
