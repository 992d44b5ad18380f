"""Answers calls by the real rosmaster, run by the Python that ROS is installed for.

Standard input has one JSON list a line: [] begins anew, [method, [parameters]] calls. Standard output answers each with
[reply, notifications]. Nothing goes over a socket: a list stands in for the threads that would carry notifications.
"""

import contextlib
import json
import logging
import sys

import rosmaster.master_api

logging.disable(logging.CRITICAL)


class Tasks:
    def __init__(self):
        self.queued = []

    def queue_task(self, api, task, arguments):
        name = task.__name__
        if name == "publisher_update_task":
            self.queued.append(["PublisherUpdate", arguments[0], arguments[1], list(arguments[2])])
        elif name == "param_update_task":
            self.queued.append(["ParamUpdate", arguments[1], arguments[2], arguments[3]])
        else:
            self.queued.append(["Shutdown", arguments[0], arguments[1], arguments[2]])

    def join_all(self, **waiting):
        """End, which there is nothing to."""


def fresh():
    tasks = Tasks()
    handler = rosmaster.master_api.ROSMasterHandler(num_workers=0)
    handler.thread_pool = handler.reg_manager.thread_pool = tasks
    handler.uri = "http://master:11311/"
    return handler, tasks


handler, tasks = fresh()
for line in sys.stdin:
    call = json.loads(line)
    if not call:
        handler, tasks = fresh()
        answer = None
    else:
        tasks.queued = []
        with contextlib.redirect_stdout(sys.stderr):
            reply = getattr(handler, call[0])(*call[1])
        handler.thread_pool = tasks
        answer = [reply, tasks.queued]
    print(json.dumps(answer), flush=True)
