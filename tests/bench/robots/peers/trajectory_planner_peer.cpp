// Runs ROS's own trajectory planner (base_local_planner) for one robot, without ROS around it.
//
// usage: trajectory_planner_peer NAME=VALUE...   (the parameters of BaseLocalPlanner.cfg, all of them; also sim_period,
//        meter_scoring, xy_goal_tolerance, and footprint=X,Y,X,Y,...: padded corners, base frame)
// stdin, a record for each command: int32 rows, cols, points; double resolution, x and y of the costmap's origin, x, y
//        and theta of the robot, v and w; then the points of a new plan (x and y, double), none if it is still the last
//        one; then uint8 costs, row 0 at the origin.
// stdout, a record for each command: double v, w, and the score, negative if no trajectory is valid.
//
// TrajectoryPlannerROS itself is little more than what `prune` and `in_reach` do: it hands the planner the part of the
// plan that lies within half the costmap's side, less what the robot has passed (base_local_planner/src/goal_functions.cpp).
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <map>
#include <sstream>

#include <base_local_planner/costmap_model.h>
#include <base_local_planner/trajectory_planner.h>
#include <costmap_2d/costmap_2d.h>

using Plan = std::vector<geometry_msgs::PoseStamped>;

void costmap_2d::calculateMinAndMaxDistances(const std::vector<geometry_msgs::Point> &footprint, double &least,
                                             double &most) {
  least = std::numeric_limits<double>::max();
  most = 0.0;
  for (size_t i = 0; i < footprint.size(); ++i) {
    const auto &a = footprint[i], &b = footprint[(i + 1) % footprint.size()];
    const double dx = b.x - a.x, dy = b.y - a.y;
    const double share = std::min(1.0, std::max(0.0, -(a.x * dx + a.y * dy) / (dx * dx + dy * dy)));
    least = std::min(least, std::hypot(a.x + share * dx, a.y + share * dy));
    most = std::max(most, std::hypot(a.x, a.y));
  }
}

template <typename T> static bool take(T *values, size_t count) { return fread(values, sizeof(T), count, stdin) == count; }

static double away(const geometry_msgs::PoseStamped &pose, const double *robot) {
  return std::hypot(pose.pose.position.x - robot[0], pose.pose.position.y - robot[1]);
}

// Return the first part of the plan that lies within `reach` of the robot.
static Plan in_reach(const Plan &plan, const double *robot, double reach) {
  size_t begin = 0;
  while (begin < plan.size() && away(plan[begin], robot) > reach) ++begin;
  size_t end = begin;
  while (end < plan.size() && away(plan[end], robot) <= reach) ++end;
  return Plan(plan.begin() + begin, plan.begin() + end);
}

// Drop the points before the first that is less than 1 m away from the part in reach, and as many from the plan.
static void prune(Plan &part, Plan &plan, const double *robot) {
  size_t passed = 0;
  while (passed < part.size() && away(part[passed], robot) >= 1.0) ++passed;
  part.erase(part.begin(), part.begin() + passed);
  plan.erase(plan.begin(), plan.begin() + passed);
}

int main(int argc, char **argv) {
  std::map<std::string, std::string> given;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const size_t equals = word.find('=');
    given[word.substr(0, equals)] = word.substr(equals + 1);
  }
  const auto number = [&](const char *name) {
    if (!given.count(name)) {
      fprintf(stderr, "no %s\n", name);
      exit(2);
    }
    return atof(given[name].c_str());
  };
  std::vector<geometry_msgs::Point> footprint;
  std::stringstream corners(given["footprint"]);
  for (std::string x, y; std::getline(corners, x, ',') && std::getline(corners, y, ',');) {
    footprint.emplace_back();
    footprint.back().x = atof(x.c_str());
    footprint.back().y = atof(y.c_str());
  }
  base_local_planner::BaseLocalPlannerConfig config;
#define READ(name) config.name = number(#name)
  READ(acc_lim_x); READ(acc_lim_theta); READ(max_vel_x); READ(min_vel_x); READ(max_vel_theta); READ(min_vel_theta);
  READ(min_in_place_vel_theta); READ(sim_time); READ(sim_granularity); READ(angular_sim_granularity);
  READ(path_distance_bias); READ(goal_distance_bias); READ(occdist_scale); READ(oscillation_reset_dist);
  READ(escape_reset_dist); READ(escape_reset_theta); READ(heading_lookahead); READ(escape_vel);
  READ(heading_scoring_timestep); READ(vx_samples); READ(vtheta_samples); READ(dwa); READ(heading_scoring);
  READ(simple_attractor);
#undef READ
  config.acc_lim_y = config.acc_lim_x;
  config.holonomic_robot = false;
  const double tolerance = number("xy_goal_tolerance");

  costmap_2d::Costmap2D *costmap = nullptr;
  base_local_planner::CostmapModel *model = nullptr;
  base_local_planner::TrajectoryPlanner *planner = nullptr;
  Plan plan;
  int32_t sizes[3];
  while (take(sizes, 3)) {
    const int rows = sizes[0], cols = sizes[1];
    double head[8];  // resolution, origin, robot, velocities
    if (!take(head, 8)) return 2;
    const double *robot = head + 3;
    std::vector<double> points(2 * static_cast<size_t>(sizes[2]));
    if (!take(points.data(), points.size())) return 2;
    if (!points.empty()) plan.assign(sizes[2], geometry_msgs::PoseStamped());
    for (size_t i = 0; 2 * i < points.size(); ++i) {
      plan[i].pose.position.x = points[2 * i];
      plan[i].pose.position.y = points[2 * i + 1];
    }
    if (!costmap) {
      costmap = new costmap_2d::Costmap2D(cols, rows, head[0], head[1], head[2]);
      model = new base_local_planner::CostmapModel(*costmap);
      planner = new base_local_planner::TrajectoryPlanner(
          *model, *costmap, footprint, config.acc_lim_x, config.acc_lim_y, config.acc_lim_theta, config.sim_time,
          config.sim_granularity, config.vx_samples, config.vtheta_samples, config.path_distance_bias,
          config.goal_distance_bias, config.occdist_scale, config.heading_lookahead, config.oscillation_reset_dist,
          config.escape_reset_dist, config.escape_reset_theta, false, config.max_vel_x, config.min_vel_x,
          config.max_vel_theta, config.min_vel_theta, config.min_in_place_vel_theta, config.escape_vel, config.dwa,
          config.heading_scoring, config.heading_scoring_timestep, number("meter_scoring") != 0, config.simple_attractor,
          std::vector<double>(), 0.2, number("sim_period"), config.angular_sim_granularity);
      planner->reconfigure(config);  // as dynamic_reconfigure does at once: it scales the weights by the resolution
    }
    costmap->resizeMap(cols, rows, head[0], head[1], head[2]);
    if (!take(costmap->getCharMap(), static_cast<size_t>(rows) * cols)) return 2;

    double reply[3] = {0.0, 0.0, -1.0};
    Plan part = in_reach(plan, robot, std::max(rows, cols) * head[0] / 2);
    prune(part, plan, robot);
    if (!part.empty() && away(part.back(), robot) <= tolerance) {
      reply[2] = 0.0;
    } else if (!part.empty()) {
      geometry_msgs::PoseStamped pose, velocity, command;
      tf2::Quaternion turned;
      pose.pose.position.x = robot[0];
      pose.pose.position.y = robot[1];
      turned.setRPY(0, 0, robot[2]);
      tf2::convert(turned, pose.pose.orientation);
      velocity.pose.position.x = head[6];
      turned.setRPY(0, 0, head[7]);
      tf2::convert(turned, velocity.pose.orientation);
      planner->updatePlan(part);
      const auto best = planner->findBestPath(pose, velocity, command);
      reply[0] = command.pose.position.x;
      reply[1] = tf2::getYaw(command.pose.orientation);
      reply[2] = best.cost_;
    }
    fwrite(reply, sizeof(double), 3, stdout);
    fflush(stdout);
  }
  return 0;
}
