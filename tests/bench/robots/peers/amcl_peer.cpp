// Runs ROS's own particle filter (amcl's pf, sensors and map) over a recorded run, without ROS around it.
//
// usage: amcl_peer MAP LOG MODEL MIN MAX SEED X Y THETA | amcl_peer MAP LOG MODEL MIN MAX SEED global
// MAP: int32 rows, cols; float64 resolution, origin x, y; int8 cells, row 0 at the origin (100 occupied, 0 free).
// LOG: int32 beams; float64 first angle, angle increment, range_max, laser x, y, theta;
//      then per scan float64 odometry x, y, theta and float32 ranges.
// Prints a line per update: number of the scan, x, y, theta, particles, CPU microseconds of the update.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <vector>

#include "amcl/map/map.h"
#include "amcl/pf/pf.h"
#include "amcl/sensors/amcl_laser.h"
#include "amcl/sensors/amcl_odom.h"

using namespace amcl;

static std::vector<std::pair<int, int>> free_cells;

static pf_vector_t anywhere(void *data) {
  map_t *map = static_cast<map_t *>(data);
  const auto &cell = free_cells[static_cast<size_t>(drand48() * free_cells.size())];
  pf_vector_t pose;
  pose.v[0] = MAP_WXGX(map, cell.first);
  pose.v[1] = MAP_WYGY(map, cell.second);
  pose.v[2] = drand48() * 2 * M_PI - M_PI;
  return pose;
}

template <typename T> static T take(FILE *file) {
  T value;
  if (fread(&value, sizeof value, 1, file) != 1) exit(2);
  return value;
}

static double seconds() {
  timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return now.tv_sec + 1e-9 * now.tv_nsec;
}

static double wrapped(double angle) { return atan2(sin(angle), cos(angle)); }

int main(int argc, char **argv) {
  if (argc < 8) return 2;
  FILE *file = fopen(argv[1], "rb");
  if (!file) return 2;
  const int rows = take<int32_t>(file), cols = take<int32_t>(file);
  map_t *map = map_alloc();
  map->size_x = cols;
  map->size_y = rows;
  map->scale = take<double>(file);
  const double corner_x = take<double>(file), corner_y = take<double>(file);
  map->origin_x = corner_x + (cols / 2) * map->scale;
  map->origin_y = corner_y + (rows / 2) * map->scale;
  map->cells = static_cast<map_cell_t *>(malloc(sizeof(map_cell_t) * rows * cols));
  for (int row = 0; row < rows; ++row)
    for (int col = 0; col < cols; ++col) {
      const int8_t value = take<int8_t>(file);
      map->cells[row * cols + col].occ_state = value == 0 ? -1 : value == 100 ? 1 : 0;
      if (value == 0) free_cells.emplace_back(col, row);
    }
  fclose(file);

  srand48(atoi(argv[6]));
  pf_t *pf = pf_alloc(atoi(argv[4]), atoi(argv[5]), 0.001, 0.1, anywhere, map);
  pf->pop_err = 0.01;
  pf->pop_z = 0.99;
  if (!strcmp(argv[7], "global")) {
    pf_init_model(pf, anywhere, map);
  } else {
    pf_vector_t mean = pf_vector_zero();
    pf_matrix_t covariance = pf_matrix_zero();
    for (int i = 0; i < 3; ++i) mean.v[i] = atof(argv[7 + i]);
    covariance.m[0][0] = covariance.m[1][1] = 0.25;
    covariance.m[2][2] = M_PI / 12.0 * (M_PI / 12.0);
    pf_init(pf, mean, covariance);
  }

  file = fopen(argv[2], "rb");
  if (!file) return 2;
  const int beams = take<int32_t>(file);
  const double first = take<double>(file), increment = take<double>(file), range_max = take<double>(file);
  pf_vector_t mount;
  for (int i = 0; i < 3; ++i) mount.v[i] = take<double>(file);

  AMCLOdom odom;
  odom.SetModel(ODOM_MODEL_DIFF, 0.2, 0.2, 0.2, 0.2, 0.2);
  const int used = atoi(getenv("BEAMS") ? getenv("BEAMS") : "60");
  AMCLLaser laser(used, map);
  if (!strcmp(argv[3], "beam"))
    laser.SetModelBeam(0.95, 0.1, 0.05, 0.05, 0.2, 0.1, 0.0);
  else if (!strcmp(argv[3], "likelihood_field_prob"))
    laser.SetModelLikelihoodFieldProb(0.95, 0.05, 0.2, 2.0, false, 0.5, 0.3, 0.9);
  else
    laser.SetModelLikelihoodField(0.95, 0.05, 0.2, 2.0);
  pf_vector_t laser_pose = mount;
  laser_pose.v[2] = 0;  // as amcl_node does: the beams' angles carry the yaw
  laser.SetLaserPose(laser_pose);

  bool begun = false;
  int updates = 0;
  pf_vector_t last = pf_vector_zero(), corrected = last, corrected_at = last;
  std::vector<float> ranges(beams);
  for (int scan = 0;; ++scan) {
    double pose[3];
    if (fread(pose, sizeof pose, 1, file) != 1) break;
    if (fread(ranges.data(), sizeof(float), beams, file) != static_cast<size_t>(beams)) break;
    pf_vector_t here;
    for (int i = 0; i < 3; ++i) here.v[i] = pose[i];
    pf_vector_t delta = pf_vector_zero();
    if (begun) {
      delta.v[0] = here.v[0] - last.v[0];
      delta.v[1] = here.v[1] - last.v[1];
      delta.v[2] = wrapped(here.v[2] - last.v[2]);
      if (!(fabs(delta.v[0]) > 0.2 || fabs(delta.v[1]) > 0.2 || fabs(delta.v[2]) > M_PI / 6.0)) continue;
    }
    const double began = seconds();
    if (begun) {
      AMCLOdomData moved;
      moved.pose = here;
      moved.delta = delta;
      odom.UpdateAction(pf, &moved);
    }
    begun = true;
    AMCLLaserData data;
    data.sensor = &laser;
    data.range_count = beams;
    data.range_max = range_max;
    data.ranges = new double[beams][2];
    for (int i = 0; i < beams; ++i) {
      const double range = ranges[i];
      data.ranges[i][0] = std::isnan(range) || range <= 0.0 ? range_max : range;
      data.ranges[i][1] = first + i * increment + mount.v[2];
    }
    laser.UpdateSensor(pf, &data);
    last = here;
    // As amcl_node does: a pose is taken from the particles when they have been resampled, and carried by odometry until
    // the next time.
    const bool resampled = ++updates % 2 == 0;
    if (resampled) pf_update_resample(pf);
    double weight, heaviest = 0.0;
    pf_vector_t mean, best = pf_vector_zero();
    pf_matrix_t covariance;
    for (int cluster = 0; pf_get_cluster_stats(pf, cluster, &weight, &mean, &covariance); ++cluster)
      if (weight > heaviest) {
        heaviest = weight;
        best = mean;
      }
    if (resampled || updates == 1) {
      corrected = best;
      corrected_at = here;
    }
    best = pf_vector_coord_add(pf_vector_coord_sub(here, corrected_at), corrected);
    printf("%d %.6f %.6f %.6f %d %.1f\n", scan, best.v[0], best.v[1], best.v[2], pf->sets[pf->current_set].sample_count,
           1e6 * (seconds() - began));
  }
  return 0;
}
