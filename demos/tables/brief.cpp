#include "brief.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>

#include "output.h"

namespace tables {

const std::vector<Brief::Row>& Brief::rows() {
  static const std::vector<Row> rows = {
      {"chain of 10, 10 iterations", "mean gap", "chain", "10x1 60Hz 10it", "mean gap", " m"},
      {"the same, 100 iterations", "mean gap", "chain", "10x1 60Hz 100it", "mean gap", " m"},
      {"chain of 10, load 100:1, 10 iterations", "mean gap", "chain", "10x100 60Hz 10it",
       "mean gap", " m"},
      {"the same", "largest angle between axes", "chain", "10x100 60Hz 10it", "axes", "°"},
      {"the same, 100 iterations", "mean gap", "chain", "10x100 60Hz 100it", "mean gap", " m"},
      {"chain of 100, load 1000:1, 240 Hz", "mean gap", "chain", "100x1000 240Hz 10it", "mean gap",
       " m"},
      {"chain of 10, load 10 000:1", "mean gap: torn", "chain", "10x10000 60Hz 10it", "mean gap",
       " m"},
      {"recovery from axes 180° apart", "steps to 1°", "recovery", "180 about (0.6 0.8 0)", "steps",
       ""},
      {"the same", "fastest", "recovery", "180 about (0.6 0.8 0)", "speed", " rad/s"},
      {"recovery from 120°", "steps to 1°", "recovery", "120 about (0.6 0.8 0)", "steps", ""},
      {"pendulum from 120°", "error of the period", "pendulum", "from 120 deg 60Hz", "period", ""},
      {"pendulum from 10°", "error of the period", "pendulum", "from 10 deg 60Hz", "period", ""},
      {"valve, five turns onto its stop", "stops at", "valve", "12 rad/s 60Hz", "up", "°"},
      {"slider-crank, 10 iterations", "largest error of the piston", "slider_crank", "60Hz 10it",
       "piston", " m"},
      {"the same, 100 iterations", "largest error of the piston", "slider_crank", "60Hz 100it",
       "piston", " m"},
      {"drive shaft bent by 40°, 20 rpm", "error of a universal joint's turn", "drive_shaft",
       "40 deg 20rpm 60Hz", "error", "°", "stock u.", "pintle u"},
      {"the same", "ripple: universal joint, constant velocity joint", "drive_shaft",
       "40 deg 20rpm 60Hz", "ripple", "", "stock u.", "pintle c"},
      {"shoulder 30° by 70°, limb thrown at 12 rad/s", "swing beyond the cone", "shoulder",
       "30x70 30; 12", "swing", "°"},
      {"the same", "twist beyond its limit", "shoulder", "30x70 30; 12", "twist", "°"},
      {"the same", "speed at rest", "shoulder", "30x70 30; 12", "rest", " rad/s"},
      {"wedge of 90°", "beyond it", "wedge", "90 deg 60Hz", "beyond", "°"},
      {"the same", "off the corner at rest", "wedge", "90 deg 60Hz", "off", "°"},
      {"rope that goes taut, 240 Hz", "stretch", "rope", "rope 240Hz", "stretch", " m"},
      {"bounce, e = 0.5", "rebound, over e² h", "bounce", "e = 0.5 60Hz", "rebound", ""},
      {"the same", "deepest", "bounce", "e = 0.5 60Hz", "below", " m"},
  };
  return rows;
}

std::vector<std::string> Brief::tables() {
  std::vector<std::string> found;
  for (const Row& row : rows()) {
    if (std::find(found.begin(), found.end(), row.table) == found.end())
      found.emplace_back(row.table);
  }
  return found;
}

std::string Brief::head() { return "| scene | what | stock | Pintle |\n|---|---|---|---|\n"; }

void Brief::note(const Number& number) {
  numbers_[{number.scene, number.name, number.who, number.quantity}] = number.value;
}

// Empty: it was not measured.
std::string Brief::value(const Row& row, const char* who) const {
  const auto found = numbers_.find({row.table, row.name, who, row.quantity});
  if (found == numbers_.end() || std::isnan(found->second)) return "";
  if (std::isinf(found->second)) return "never";
  char text[32];
  const bool is_whole =
      std::abs(found->second) >= 100 || found->second == std::round(found->second);
  std::snprintf(text, sizeof text, is_whole ? "%.0f" : "%.2g", found->second);
  return text + std::string(row.unit);
}

bool Brief::write(const std::string& path) const {
  std::ofstream file(path);
  file << head();
  bool is_complete = true;
  for (const Row& row : rows()) {
    const std::string stock = value(row, row.stock), ours = value(row, row.ours);
    is_complete = is_complete && !stock.empty() && !ours.empty();
    file << "| " << row.scene << " | " << row.what << " | " << stock << " | " << ours << " |\n";
  }
  return is_complete && file.flush();
}

}  // namespace tables
