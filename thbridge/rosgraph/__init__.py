"""ROS 1 graph: XML-RPC, master, node and TCPROS as bytes (`wire`), the same over TCP (`sockets`), and `files`."""
