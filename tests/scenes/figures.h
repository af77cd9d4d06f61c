// Key figures of every scene, by which a change in behaviour is seen: errors, rows, and where its
// bodies end after a second.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace figures {

/// By "scene,contender,figure".
using Figures = std::map<std::string, double>;

Figures measure();
Figures read();  ///< what is stored for this precision; empty: nothing
void write(const Figures& figures);

/// A scene amplifies rounding, which differs between compilers: by so much at most, of a figure or
/// of 1e-3 if that is more.
double tolerance();
/// What differs by more, a line each: the figure, was, is.
std::vector<std::string> differences(const Figures& stored, const Figures& measured);

}  // namespace figures
