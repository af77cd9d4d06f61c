#include "stored.h"

#include <algorithm>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "../measures/run.h"
#include "integrator.h"

namespace reference {

using scenes::Vector3d;

namespace {
std::string path(const std::string& scene) {
  return std::string(PINTLE_DEMOS_DIR) + "/reference/" + scene + ".csv";
}
}  // namespace

std::vector<Vector3d> stored(const std::string& scene, int samples) {
  std::ifstream file(path(scene));
  std::vector<Vector3d> wanted;
  for (std::string line; int(wanted.size()) < samples && std::getline(file, line);) {
    if (line[0] == '#' || line[0] == 't') continue;
    std::replace(line.begin(), line.end(), ',', ' ');
    double time;
    Vector3d p;
    if (std::istringstream(line) >> time >> p.x() >> p.y() >> p.z()) wanted.push_back(p);
  }
  if (int(wanted.size()) < samples)
    throw std::runtime_error(path(scene) + ": not there, or too short; demos/run.sh reference");
  return wanted;
}

void store(const scenes::Scene& scene, double dt) {
  const double interval = measures::sample_interval;
  const Solution coarse = solve(scene, dt, interval), fine = solve(scene, dt / 2, interval);
  double difference = 0;
  for (size_t i = 0; i < fine.probe.size(); ++i)
    difference = std::max(difference, (fine.probe[i] - coarse.probe[i]).norm());
  std::ofstream file(path(scene.name));
  file << "# " << scene.title << ": the probe's position\n"
       << "# by: bash demos/run.sh reference --scene " << scene.name << "\n"
       << "# method: accelerations by Lagrange multipliers, Runge-Kutta of 4th order, projection\n"
       << "# step: " << dt / 2 << " s; differs from that of twice the step by " << difference
       << " m at most\n"
       << "# constraints are broken by " << fine.gap << " at most";
  if (scene.has(scenes::Error::energy))
    file << ", energy changes by " << fine.energy_change / scene.energy_scale << ", relative";
  file << "\n"
       << "t/s,x/m,y/m,z/m\n";
  file.precision(12);
  for (size_t i = 0; i < fine.probe.size(); ++i) {
    const Vector3d& p = fine.probe[i];
    file << double(i + 1) * interval << ',' << p.x() << ',' << p.y() << ',' << p.z() << '\n';
  }
  if (!file) throw std::runtime_error("cannot write " + path(scene.name));
}

}  // namespace reference
