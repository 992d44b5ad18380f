"""ROS 1 graph: XML-RPC, master, node and TCPROS. `wire` handles their bytes, `sockets` uses them over TCP."""
