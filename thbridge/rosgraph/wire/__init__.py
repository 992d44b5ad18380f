"""ROS 1 graph without its sockets: XML-RPC, the master, a node, TCPROS."""
