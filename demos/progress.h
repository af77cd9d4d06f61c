// A bar on stderr for what takes longer than two seconds. It is quiet where nobody sees it.

#pragma once

#include <chrono>
#include <string>

class Progress {
 public:
  // Of all that is to be done, in any unit that is about proportional to its time.
  explicit Progress(double total);
  ~Progress() { clear(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // This much more is done; `what` follows.
  void advance(double amount, const std::string& what);
  // This much need not be done.
  void skip(double amount) { total_ -= amount; }
  // Takes the bar away, so that its line can be written on.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;

  double total_, done_ = 0;
  bool is_seen_, is_drawn_ = false;
  Clock::time_point start_ = Clock::now(), drawn_ = start_;
};
