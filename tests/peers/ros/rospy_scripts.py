"""Scripts for ROS's own Python beside a running session; each prints one line of JSON."""

ACTION_CLIENT = """
import json, sys
import actionlib, rospy
from actionlib_msgs.msg import GoalStatus
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal

rospy.init_node("client")
client = actionlib.SimpleActionClient(sys.argv[1] + "/move_base", MoveBaseAction)
found = client.wait_for_server(rospy.Duration(60))

def goal(x, y):
    wanted = MoveBaseGoal()
    wanted.target_pose.header.frame_id = "map"
    wanted.target_pose.pose.position.x, wanted.target_pose.pose.position.y = x, y
    wanted.target_pose.pose.orientation.w = 1.0
    return wanted

def drive(x, y, leave_after=None):
    seen = []
    client.send_goal(goal(x, y), feedback_cb=lambda f: seen.append(f.base_position.header.frame_id))
    if leave_after is not None:
        while len(seen) < leave_after:
            rospy.sleep(0.05)
        return seen
    client.wait_for_result(rospy.Duration(120))
    return client.get_state(), len(seen), sorted(set(seen))

places = json.loads(sys.argv[2])
said = {"found": found, "arrived": drive(*places[0])}
drive(*places[1], leave_after=3)
client.cancel_goal()
client.wait_for_result(rospy.Duration(30))
said["cancelled"] = client.get_state()
drive(*places[1], leave_after=3)
other = actionlib.SimpleActionClient(sys.argv[1] + "/move_base", MoveBaseAction)
other.wait_for_server(rospy.Duration(30))
other.send_goal(goal(*places[0]))
client.wait_for_result(rospy.Duration(30))
said["replaced"] = client.get_state()
other.wait_for_result(rospy.Duration(120))
said["replacing"] = other.get_state()
client.send_goal(goal(-1000.0, 0.0))
client.wait_for_result(rospy.Duration(60))
said["impossible"] = [client.get_state(), client.get_goal_status_text()]
print(json.dumps(said))
"""

PARAMETERS = """
import json, sys
import rospy

rospy.init_node("reader")
print(json.dumps({name: rospy.get_param(name) for name in rospy.get_param_names() if name.startswith(sys.argv[1])}))
"""

SET_MAP = """
import json, sys
import rospy
from geometry_msgs.msg import PoseWithCovarianceStamped
from nav_msgs.srv import GetMap, SetMap

rospy.init_node("mapper")
rospy.wait_for_service("/static_map")
whole = rospy.ServiceProxy("/static_map", GetMap)().map
whole.info.width -= int(sys.argv[1])
whole.data = whole.data[: whole.info.width * whole.info.height]
# The robot is told what it believes: told another place it would be lost for those who come next.
pose = rospy.wait_for_message("/robot2/amcl_pose", PoseWithCovarianceStamped, 60)
print(json.dumps({"success": rospy.ServiceProxy("/robot2/set_map", SetMap)(whole, pose).success}))
"""

TF_LISTENER = """
import json, sys
import rospy, tf2_ros

rospy.init_node("listener")
buffer = tf2_ros.Buffer()
tf2_ros.TransformListener(buffer)
found = {}
for pair in sys.argv[1:]:
    target, source = pair.split(",")
    transform = buffer.lookup_transform(target, source, rospy.Time(0), rospy.Duration(60))
    where = transform.transform.translation
    found[pair] = [where.x, where.y, where.z]
print(json.dumps(found))
"""

LOCALIZED = """
import json, queue, sys
import rospy
from geometry_msgs.msg import PoseWithCovarianceStamped

rospy.init_node("localized")
poses = queue.Queue()
# The robot soon notices that the pose is wrong, so no message may be missed.
rospy.Subscriber("/robot1/amcl_pose", PoseWithCovarianceStamped, poses.put)
poses.get(timeout=60)
out = rospy.Publisher("/robot1/initialpose", PoseWithCovarianceStamped, queue_size=1)
while out.get_num_connections() == 0:
    rospy.sleep(0.05)
message = PoseWithCovarianceStamped()
message.header.frame_id = "map"
x, y = json.loads(sys.argv[1])
message.pose.pose.position.x, message.pose.pose.position.y = x, y
message.pose.pose.orientation.w = 1.0
message.pose.covariance = [0.01 if i in (0, 7, 35) else 0.0 for i in range(36)]
out.publish(message)
while True:
    pose = poses.get(timeout=60).pose.pose.position
    if abs(pose.x - x) < 0.5 and abs(pose.y - y) < 0.5:
        break
print(json.dumps([pose.x, pose.y]))
"""

NAMESAKE = """
import sys
import rospy

rospy.init_node(sys.argv[1])
print("here", flush=True)
rospy.spin()
"""

OF_ANOTHER_TYPE = """
import rospy
from std_msgs.msg import String

rospy.init_node("mistaken")
rospy.Subscriber("/robot1/odom", String, print)
rospy.spin()
"""

UNBROKEN = """
import json, sys
import rospy
from nav_msgs.msg import Odometry

rospy.init_node("attentive")
numbers = []
rospy.Subscriber("/robot1/odom", Odometry, lambda message: numbers.append(message.header.seq))
while len(numbers) < int(sys.argv[1]):
    rospy.sleep(0.5)
print(json.dumps(numbers))
"""

WHERE = """
import json, sys, xmlrpc.client
import rosgraph

api = xmlrpc.client.ServerProxy(rosgraph.Master("/asker").lookupNode(sys.argv[1]))
_, _, (transport, host, port) = api.requestTopic("/asker", sys.argv[2], [["TCPROS"]])
print(json.dumps([host, port]))
"""

ASKING = """
import actionlib_msgs.msg, geometry_msgs.msg, rospy, std_srvs.srv

rospy.init_node("asking")

def say(topic, kind, fill):
    message = kind()
    fill(message)
    out = rospy.Publisher(topic, kind, queue_size=1)
    while out.get_num_connections() == 0:
        rospy.sleep(0.02)
    out.publish(message)

def place(message):
    message.header.frame_id = "map"
    message.pose.position.x, message.pose.position.y, message.pose.orientation.w = 0.5, 0.5, 1.0

def belief(message):
    message.header.frame_id = "map"
    at = message.pose.pose
    at.position.x, at.position.y, at.orientation.w = 0.5, 0.5, 1.0
    message.pose.covariance = [0.1 if i in (0, 7, 35) else 0.0 for i in range(36)]

def turn(message):
    message.angular.z = 0.3

say("/robot1/move_base_simple/goal", geometry_msgs.msg.PoseStamped, place)
say("/robot2/initialpose", geometry_msgs.msg.PoseWithCovarianceStamped, belief)
say("/robot2/cmd_vel", geometry_msgs.msg.Twist, turn)
rospy.set_param("/robot1/amcl/max_particles", 444)
rospy.ServiceProxy("/robot2/global_localization", std_srvs.srv.Empty)()
rospy.ServiceProxy("/robot1/move_base/clear_costmaps", std_srvs.srv.Empty)()
say("/robot1/move_base/cancel", actionlib_msgs.msg.GoalID, lambda message: None)
rospy.sleep(2.0)  # of the session, in which robots do it
print("true")
"""
