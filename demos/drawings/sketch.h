// Purpose: a small drawing of solids, ranges, axes and arrows in space, as SVG. It follows the reader's light or dark mode.
#pragma once

#include <LinearMath/btTransform.h>

#include <string>
#include <utility>
#include <vector>

namespace drawings {

/// Whose colour a solid has.
enum class Paint : char { a = 'a', b = 'b', other = 'o' };

/// An arc about a unit vector, from a direction of angle zero (rad, right-handed).
struct Arc {
  btVector3 centre, normal, zero;
  btScalar radius, low, high;

  btVector3 at(btScalar angle, btScalar part = 1) const;
};

/// Lengths are in metres, along the world's axes; z is up. What is nearer to the eye covers what is farther, within a layer.
class Sketch {
 public:
  struct View {
    btScalar azimuth = -60, elevation = 24;  // degrees: where the eye is
    btScalar scale = 118;                    // pixels a metre
    btVector3 centre = {0, 0, 0};            // in the middle of the picture
  };
  explicit Sketch(View view);

  // Solids. The axis of a cylinder and of a cone is z of its pose.
  void box(Paint paint, const btTransform& pose, const btVector3& half_extents);
  void cylinder(Paint paint, const btTransform& pose, btScalar radius, btScalar half_length,
                bool capped = true);
  void ball(Paint paint, const btVector3& centre, btScalar radius);
  void layer(int layer) { m_layer = layer; }  ///< of what follows: higher ones cover lower ones

  /// Where something may go: green, with its ends as bold lines.
  void range(const Arc& arc);
  void patch(const std::vector<btVector3>& corners);
  void outline(const std::vector<btVector3>& corners);
  /// Between a point and a closed curve.
  void cone(const btVector3& apex, const std::vector<btVector3>& rim);
  void stop(const btVector3& from, const btVector3& to);
  /// How it may move, with a head at its end.
  void turn(const Arc& arc);
  void move(const btVector3& from, const btVector3& to);
  void axis(const btVector3& from, const btVector3& to);     ///< dashes and dots
  void pointer(const btVector3& from, const btVector3& to);  ///< what a reading is measured to
  void zero(const btVector3& from, const btVector3& to);     ///< what it is measured from
  void dot(const btVector3& at);
  void label(const btVector3& at, const std::string& text, double right = 0, double down = 0,
             const char* look = "");

  /// The whole file, with a table and lines of text beside the picture.
  struct Caption {
    std::string title, subtitle;
    std::string table_title;
    std::string cells[2][3];  ///< move and turn along x, y and z
    std::vector<std::pair<std::string, std::string>> readings;
    std::vector<std::string> notes;
  };
  std::string svg(const Caption& caption) const;

  /// Pictures without their text, in rows, each with its title.
  struct Tile {
    std::string title, picture;
  };
  Tile tile(const std::string& title) const { return {title, picture(false)}; }
  static std::string overview(const std::string& title, const std::vector<Tile>& tiles,
                              int columns);

 private:
  struct Item {
    int layer;
    double depth;
    std::string text;
    bool is_text = false;
  };
  std::string picture(bool with_text) const;
  struct Point {
    double x, y;
  };
  Point project(const btVector3& point) const;
  double depth(const btVector3& point) const { return double(point.dot(m_eye)); }
  std::string path(const std::vector<btVector3>& points, bool closed) const;
  int shade(const btVector3& normal) const;
  void face(Paint paint, const std::vector<btVector3>& corners, const btVector3& normal,
            bool edges);
  void add(double depth, std::string text) {
    m_items.push_back({m_layer, depth, std::move(text), false});
  }
  void stroke(const char* look, const std::vector<btVector3>& points, bool head = false);

  View m_view;
  btVector3 m_eye, m_right, m_up;
  int m_layer = 0;
  std::vector<Item> m_items;
};

}  // namespace drawings
