#include "progress.h"

#include <algorithm>
#include <cstdio>

#if defined(_WIN32)
#include <io.h>
#else
#include <unistd.h>
#endif

namespace {

bool is_terminal() {
#if defined(_WIN32)
  return _isatty(2) != 0;
#else
  return isatty(STDERR_FILENO) != 0;
#endif
}

}  // namespace

Progress::Progress(double total) : total_(total), is_seen_(is_terminal()) {}

void Progress::advance(double amount, const std::string& what) {
  done_ += amount;
  const Clock::time_point now = Clock::now();
  const double elapsed = std::chrono::duration<double>(now - start_).count();
  if (!is_seen_ || elapsed < 2 || now - drawn_ < std::chrono::milliseconds(100)) return;
  drawn_ = now;
  is_drawn_ = true;
  constexpr int width = 24;
  const double part = total_ > 0 ? std::clamp(done_ / total_, 0., 1.) : 1;
  std::string bar(size_t(width), '.');
  std::fill_n(bar.begin(), int(part * width), '#');
  const double left = part > 0 ? elapsed * (1 - part) / part : 0;
  std::fprintf(stderr, "\r\033[K[%s] %3.0f %%, %.0f s left: %.32s", bar.c_str(), 100 * part, left,
               what.c_str());
  std::fflush(stderr);
}

void Progress::clear() {
  if (!is_drawn_) return;
  is_drawn_ = false;
  std::fputs("\r\033[K", stderr);
}
