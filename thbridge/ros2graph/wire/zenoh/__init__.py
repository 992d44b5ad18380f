"""ROS 2 over zenoh: keys, attachments and gids of rmw_zenoh (since 0.2.4), as functions of text and bytes."""
