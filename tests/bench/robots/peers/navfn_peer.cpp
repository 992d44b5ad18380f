// Runs ROS's own navfn over queries on one costmap, without ROS around it.
//
// usage: navfn_peer QUERIES MODE   (MODE: dijkstra, astar or whole; whole spreads over the whole map and traces nothing)
// QUERIES: int32 rows, cols, queries; uint8 costs, row 0 at the origin; int32 start column, row, goal column, row a query.
// Prints a line per query: cells of path times 2 (half-cell steps), length of the path in cells, CPU microseconds.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <vector>

#include <navfn/navfn.h>

template <typename T> static std::vector<T> take(FILE *file, size_t count) {
  std::vector<T> values(count);
  if (fread(values.data(), sizeof(T), count, file) != count) exit(2);
  return values;
}

static double seconds() {
  timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return now.tv_sec + 1e-9 * now.tv_nsec;
}

int main(int argc, char **argv) {
  if (argc != 3) return 2;
  FILE *file = fopen(argv[1], "rb");
  if (!file) return 2;
  const auto head = take<int32_t>(file, 3);
  const int rows = head[0], cols = head[1];
  auto costs = take<uint8_t>(file, static_cast<size_t>(rows) * cols);
  const auto queries = take<int32_t>(file, 4 * static_cast<size_t>(head[2]));
  const bool astar = !strcmp(argv[2], "astar"), whole = !strcmp(argv[2], "whole");
  const int cycles = std::max(cols * rows / 20, cols + rows);  // what navfn itself allows

  navfn::NavFn planner(cols, rows);
  for (size_t i = 0; i < queries.size(); i += 4) {
    int start[2] = {queries[i], queries[i + 1]}, goal[2] = {queries[i + 2], queries[i + 3]};
    const double began = seconds();
    planner.setNavArr(cols, rows);
    planner.setCostmap(costs.data(), true, true);
    // As NavfnROS does: the wave begins at the robot, and the path is traced from the goal.
    planner.setStart(goal);
    planner.setGoal(start);
    planner.setupNavFn(true);
    if (astar) {
      planner.propNavFnAstar(cycles);
    } else {
      planner.propNavFnDijkstra(cycles, !whole);
    }
    const int points = whole ? 0 : planner.calcPath(4 * cols);
    const double spent = seconds() - began;
    double length = 0.0;
    for (int k = 1; k < points; ++k)
      length += std::hypot(planner.getPathX()[k] - planner.getPathX()[k - 1], planner.getPathY()[k] - planner.getPathY()[k - 1]);
    printf("%d %.6f %.1f\n", points, length, 1e6 * spent);
  }
  return 0;
}
