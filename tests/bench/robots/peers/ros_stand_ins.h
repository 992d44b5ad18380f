// The few types and functions of ROS, tf2, boost and Eigen that base_local_planner's trajectory planner needs, so that it
// compiles without any of them.
#pragma once
#include <algorithm>
#include <climits>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <mutex>
#include <string>
#include <vector>

#define ROS_DEBUG(...)
#define ROS_INFO(...)
#define ROS_WARN(...)
#define ROS_ERROR(...)
#define ROS_ASSERT(...)

namespace geometry_msgs {
struct Point { double x = 0, y = 0, z = 0; };
struct Quaternion { double x = 0, y = 0, z = 0, w = 1; };
struct Pose { Point position; Quaternion orientation; };
struct Header { std::string frame_id; };
struct PoseStamped { Header header; Pose pose; };
struct Polygon {};
}  // namespace geometry_msgs

namespace base_local_planner {
struct Position2DInt { int64_t x = 0, y = 0; };

// The parameters of BaseLocalPlanner.cfg under their names.
struct BaseLocalPlannerConfig {
  double acc_lim_x, acc_lim_y, acc_lim_theta, max_vel_x, min_vel_x, max_vel_theta, min_vel_theta, min_in_place_vel_theta;
  double sim_time, sim_granularity, angular_sim_granularity, path_distance_bias, goal_distance_bias, occdist_scale;
  double oscillation_reset_dist, escape_reset_dist, escape_reset_theta, heading_lookahead, escape_vel;
  double heading_scoring_timestep;
  int vx_samples, vtheta_samples;
  bool holonomic_robot, dwa, heading_scoring, simple_attractor;
  std::string y_vels;
};
}  // namespace base_local_planner

namespace costmap_2d {
void calculateMinAndMaxDistances(const std::vector<geometry_msgs::Point> &footprint, double &least, double &most);
inline geometry_msgs::Polygon toPolygon(const std::vector<geometry_msgs::Point> &) { return {}; }
}

namespace tf2 {
struct Quaternion {
  double yaw = 0;
  void setRPY(double, double, double angle) { yaw = angle; }
};
inline void convert(const Quaternion &from, geometry_msgs::Quaternion &to) {
  to.z = std::sin(from.yaw / 2);
  to.w = std::cos(from.yaw / 2);
}
inline double getYaw(const geometry_msgs::Quaternion &q) { return 2 * std::atan2(q.z, q.w); }
}  // namespace tf2

namespace angles {
inline double shortest_angular_distance(double from, double to) { return std::remainder(to - from, 2 * M_PI); }
}  // namespace angles

namespace boost {
struct mutex : std::mutex { using scoped_lock = std::lock_guard<std::mutex>; };
using recursive_mutex = std::recursive_mutex;
template <typename M> using unique_lock = std::unique_lock<M>;
enum { token_compress_on };
inline std::string is_any_of(const char *characters) { return characters; }
// Only for speeds sideways, of which a robot with two wheels has none.
inline void split(std::vector<std::string> &parts, const std::string &, const std::string &, int) { parts.clear(); }
}  // namespace boost

namespace Eigen {
struct Vector3f {
  float values[3];
  Vector3f(double x, double y, double z) : values{float(x), float(y), float(z)} {}
  float operator[](int i) const { return values[i]; }
};
}  // namespace Eigen
