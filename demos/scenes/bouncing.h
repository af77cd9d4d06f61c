// What is pulled back, and bounces.

#pragma once

namespace scenes {

// How far from where it bounces it is a time after it left there at this speed: each time with the part
// `restitution` of its speed.
inline double bouncing(double time, double speed, double acceleration, double restitution) {
  while (speed > 1e-6 && time > 2 * speed / acceleration) {
    time -= 2 * speed / acceleration;
    speed *= restitution;
  }
  return speed > 1e-6 ? time * (speed - acceleration * time / 2) : 0;
}

}  // namespace scenes
