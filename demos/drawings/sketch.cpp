#include "sketch.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace drawings {
namespace {

constexpr double kWidth = 760, kHeight = 400;
constexpr double kMiddleX = 225, kMiddleY = 232;
constexpr double kPanel = 462;  // where the text beside the picture begins
constexpr int kShades = 5;
constexpr btScalar kMargin = btScalar(0.25);  // a count of segments is the same in both precisions

// Okabe and Ito's colours, which the colour-blind tell apart: blue (A), orange (B), green (what is free).
constexpr const char* kStyle = R"(<style>
text{font:13px system-ui,-apple-system,"Segoe UI",Roboto,"DejaVu Sans",sans-serif;fill:#1f2328}
.title{font-size:19px;font-weight:700}.soft{fill:#59636e}.bold{font-weight:700}
.code{font-family:ui-monospace,SFMono-Regular,Menlo,Consolas,"DejaVu Sans Mono",monospace;font-size:12px}
.card{fill:#fff;stroke:#d1d9e0}.rule{stroke:#d1d9e0}
.halo{paint-order:stroke;stroke:#fff;stroke-width:4px;stroke-linejoin:round}
.big{font-size:15px;font-weight:700}.green{fill:#00755a}.mid{text-anchor:middle}
.ink,.axis,.zero,.point{fill:none;stroke:#1f2328;stroke-linecap:round;stroke-linejoin:round}
.ink{stroke-width:2.6}.axis{stroke-width:1.3;stroke-dasharray:9 3 2 3}.zero{stroke-width:1.3;stroke-dasharray:3 4}.point{stroke-width:2}
.range{fill:#009e73;fill-opacity:.22}.rim{fill:none;stroke:#009e73;stroke-width:1.2}
.go{fill:none;stroke:#008563;stroke-width:3;stroke-linecap:round}.head{fill:#008563}.tip,.dot{fill:#1f2328}
.free{fill:#009e73;fill-opacity:.2;stroke:#009e73}.limited{fill:#e69f00;fill-opacity:.22;stroke:#e69f00}.held{fill:#8b949e;fill-opacity:.2;stroke:#8b949e}
.a0{fill:#1b5685}.a1{fill:#266ca3}.a2{fill:#3a83bd}.a3{fill:#5a9dd2}.a4{fill:#80b8e4}
.b0{fill:#9c5b14}.b1{fill:#bb7422}.b2{fill:#d68d37}.b3{fill:#e8a957}.b4{fill:#f3c47f}
.o0{fill:#4f5761}.o1{fill:#68717c}.o2{fill:#838c97}.o3{fill:#a0a8b2}.o4{fill:#bcc3cb}
.edge{stroke:#0003;stroke-width:.8;stroke-linejoin:round}
@media(prefers-color-scheme:dark){text{fill:#e6edf3}.soft{fill:#9198a1}.card{fill:#151b23;stroke:#3d444d}.rule{stroke:#3d444d}
.halo{stroke:#151b23}.ink,.axis,.zero,.point{stroke:#e6edf3}.tip,.dot{fill:#e6edf3}
.green{fill:#3fd6ab}.go{stroke:#2fc498}.head{fill:#2fc498}.range{fill-opacity:.38}}
</style>
)";

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f", value);
  std::string s = text;
  if (s.size() > 2 && s.compare(s.size() - 2, 2, ".0") == 0) s.resize(s.size() - 2);
  return s == "-0" ? "0" : s;
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text)
    out += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : std::string(1, c);
  return out;
}

std::string text(double x, double y, const std::string& what, const char* look) {
  return "<text x=\"" + number(x) + "\" y=\"" + number(y) + "\" class=\"" + look + "\">" +
         escaped(what) + "</text>\n";
}

// Up to the card that everything is on.
std::string begin(const std::string& title, double width, double height) {
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + number(width) + " " +
         number(height) + "\" role=\"img\">\n<title>" + escaped(title) + "</title>\n" + kStyle +
         "<rect class=\"card\" x=\".5\" y=\".5\" width=\"" + number(width - 1) + "\" height=\"" +
         number(height - 1) + "\" rx=\"10\"/>\n";
}

std::string withClass(const std::string& path, const std::string& look) {
  return "<path class=\"" + look + "\" d=\"" + path + "\"/>\n";
}

btVector3 middleOf(const std::vector<btVector3>& points) {
  btVector3 middle(0, 0, 0);
  for (const btVector3& p : points) middle += p / btScalar(points.size());
  return middle;
}

btScalar radians(btScalar degrees) { return degrees * SIMD_RADS_PER_DEG; }

}  // namespace

btVector3 Arc::at(btScalar angle, btScalar part) const {
  return centre + part * radius * (btCos(angle) * zero + btSin(angle) * normal.cross(zero));
}

Sketch::Sketch(View view) : m_view(view) {
  const btScalar az = radians(view.azimuth), el = radians(view.elevation);
  m_eye = {btCos(el) * btCos(az), btCos(el) * btSin(az), btSin(el)};
  m_right = {-btSin(az), btCos(az), 0};
  m_up = m_eye.cross(m_right);
}

Sketch::Point Sketch::project(const btVector3& point) const {
  const btVector3 p = point - m_view.centre;
  return {kMiddleX + double(m_view.scale * p.dot(m_right)),
          kMiddleY - double(m_view.scale * p.dot(m_up))};
}

std::string Sketch::path(const std::vector<btVector3>& points, bool closed) const {
  std::string d;
  for (const btVector3& p : points) {
    const Point q = project(p);
    d += (d.empty() ? "M" : "L") + number(q.x) + " " + number(q.y);
  }
  return closed ? d + "Z" : d;
}

// From the upper left, by the eye.
int Sketch::shade(const btVector3& normal) const {
  const btVector3 light =
      (btScalar(0.55) * m_eye + btScalar(0.75) * m_up - btScalar(0.35) * m_right).normalized();
  const double lit = 0.5 + 0.5 * double(normal.dot(light));
  return std::min(kShades - 1, std::max(0, int(std::floor(lit * kShades))));
}

void Sketch::face(Paint paint, const std::vector<btVector3>& corners, const btVector3& normal,
                  bool edges) {
  if (normal.dot(m_eye) <= btScalar(1e-4)) return;
  const std::string look =
      std::string(1, char(paint)) + std::to_string(shade(normal)) + (edges ? " edge" : "");
  add(depth(middleOf(corners)), withClass(path(corners, true), look));
}

void Sketch::box(Paint paint, const btTransform& pose, const btVector3& h) {
  for (int i = 0; i < 3; ++i)
    for (const btScalar side : {btScalar(-1), btScalar(1)}) {
      std::vector<btVector3> corners;
      for (const auto& [s, t] : {std::pair{-1, -1}, {-1, 1}, {1, 1}, {1, -1}}) {
        btVector3 p;
        p[i] = side * h[i];
        p[(i + 1) % 3] = btScalar(s) * h[(i + 1) % 3];
        p[(i + 2) % 3] = btScalar(t) * h[(i + 2) % 3];
        corners.push_back(pose * p);
      }
      face(paint, corners, side * pose.getBasis().getColumn(i), true);
    }
}

void Sketch::cylinder(Paint paint, const btTransform& pose, btScalar radius, btScalar half_length,
                      bool capped) {
  constexpr int segments = 32;
  const auto rim = [&](int i, btScalar z) {
    const btScalar way = SIMD_2_PI * btScalar(i) / segments;
    return pose * btVector3(radius * btCos(way), radius * btSin(way), z);
  };
  std::vector<btVector3> top, bottom;
  for (int i = 0; i < segments; ++i) {
    top.push_back(rim(i, half_length));
    bottom.push_back(rim(i, -half_length));
  }
  // Neighbours of one shade are one face.
  const btVector3 z = pose.getBasis().getColumn(2);
  const auto normal = [&](int i) {
    const btScalar way = SIMD_2_PI * (btScalar(i) + btScalar(0.5)) / segments;
    return pose.getBasis() * btVector3(btCos(way), btSin(way), 0);
  };
  const auto visible = [&](int i) { return normal(i).dot(m_eye) > btScalar(1e-4); };
  int start = 0;
  while (start < segments && visible(start)) ++start;
  for (int i = start; i < start + segments;) {
    int next = i + 1;
    if (visible(i)) {
      while (next < start + segments && visible(next) && shade(normal(next)) == shade(normal(i)))
        ++next;
      std::vector<btVector3> corners;
      for (int k = i; k <= next; ++k) corners.push_back(rim(k, half_length));
      for (int k = next; k >= i; --k) corners.push_back(rim(k, -half_length));
      face(paint, corners, normal(i), false);
    }
    i = next;
  }
  if (!capped) return;
  face(paint, top, z, true);
  face(paint, bottom, -z, true);
}

// A disc with highlights that shift towards the light.
void Sketch::ball(Paint paint, const btVector3& centre, btScalar radius) {
  const Point c = project(centre);
  const double r = double(radius * m_view.scale);
  std::string circles;
  for (int i = 0; i < kShades; ++i) {
    const double part = 1 - 0.2 * i, shift = 0.32 * r * (1 - part);
    circles += "<circle class=\"" + std::string(1, char(paint)) + std::to_string(i) + "\" cx=\"" +
               number(c.x - shift) + "\" cy=\"" + number(c.y - 1.5 * shift) + "\" r=\"" +
               number(r * part) + "\"/>\n";
  }
  add(depth(centre), circles);
}

void Sketch::patch(const std::vector<btVector3>& corners) {
  add(depth(middleOf(corners)), withClass(path(corners, true), "range"));
}
void Sketch::outline(const std::vector<btVector3>& corners) {
  add(depth(middleOf(corners)), withClass(path(corners, true), "rim"));
}

void Sketch::cone(const btVector3& apex, const std::vector<btVector3>& rim) {
  // What is seen of it: the rim's disc, and the side that reaches out from behind it.
  std::vector<std::pair<Point, btVector3>> points{{project(apex), apex}};
  for (const btVector3& p : rim) points.push_back({project(p), p});
  std::sort(points.begin(), points.end(), [](const auto& p, const auto& q) {
    return p.first.x != q.first.x ? p.first.x < q.first.x : p.first.y < q.first.y;
  });
  std::vector<std::pair<Point, btVector3>> hull;  // Andrew's monotone chain
  for (int half = 0; half < 2; ++half) {
    const std::size_t start = hull.size();
    for (const auto& p : points) {
      while (hull.size() >= start + 2) {
        const Point &u = hull[hull.size() - 2].first, &v = hull.back().first;
        if ((v.x - u.x) * (p.first.y - u.y) - (v.y - u.y) * (p.first.x - u.x) > 0) break;
        hull.pop_back();
      }
      hull.push_back(p);
    }
    hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  std::vector<btVector3> seen;
  for (const auto& p : hull) seen.push_back(p.second);
  patch(seen);
  patch(rim);
  outline(rim);
}

void Sketch::range(const Arc& arc) {
  const bool whole = !(arc.low <= arc.high && arc.high - arc.low < SIMD_2_PI);
  const btScalar low = whole ? 0 : arc.low, high = whole ? SIMD_2_PI : arc.high;
  std::vector<btVector3> corners;
  const int segments = btMax(2, int((high - low) / radians(6) + kMargin));
  for (int i = 0; i <= segments; ++i)
    corners.push_back(arc.at(low + (high - low) * btScalar(i) / btScalar(segments)));
  if (!whole) corners.push_back(arc.centre);
  add(depth(arc.centre), withClass(path(corners, true), "range"));
  if (whole) return;
  stop(arc.centre, arc.at(low));
  stop(arc.centre, arc.at(high));
}

void Sketch::stroke(const char* look, const std::vector<btVector3>& points, bool head) {
  std::string text = withClass(path(points, false), look);
  if (head) {
    const Point to = project(points.back()), from = project(points[points.size() - 2]);
    const double length = std::hypot(to.x - from.x, to.y - from.y);
    const double x = (to.x - from.x) / length, y = (to.y - from.y) / length;
    const auto corner = [&](double along, double across) {
      return number(to.x + along * x - across * y) + " " + number(to.y + along * y + across * x);
    };
    const bool go = std::string(look) == "go";
    const double size = go ? 11 : 8;
    text += withClass("M" + corner(size * 0.75, 0) + "L" + corner(-size * 0.45, size * 0.55) + "L" +
                          corner(-size * 0.45, -size * 0.55) + "Z",
                      go ? "head" : "tip");
  }
  add(depth(middleOf(points)), std::move(text));
}

void Sketch::stop(const btVector3& from, const btVector3& to) { stroke("ink", {from, to}); }
void Sketch::move(const btVector3& from, const btVector3& to) { stroke("go", {from, to}, true); }
void Sketch::axis(const btVector3& from, const btVector3& to) { stroke("axis", {from, to}); }
void Sketch::pointer(const btVector3& from, const btVector3& to) {
  stroke("point", {from, to}, true);
}
void Sketch::zero(const btVector3& from, const btVector3& to) { stroke("zero", {from, to}); }

void Sketch::turn(const Arc& arc) {
  std::vector<btVector3> points;
  const int segments = btMax(4, int(btFabs(arc.high - arc.low) / radians(5) + kMargin));
  for (int i = 0; i <= segments; ++i)
    points.push_back(arc.at(arc.low + (arc.high - arc.low) * btScalar(i) / btScalar(segments)));
  stroke("go", points, true);
}

void Sketch::dot(const btVector3& at) {
  const Point p = project(at);
  add(depth(at),
      "<circle class=\"dot\" cx=\"" + number(p.x) + "\" cy=\"" + number(p.y) + "\" r=\"3.6\"/>\n");
}

void Sketch::label(const btVector3& at, const std::string& what, double right, double down,
                   const char* look) {
  const Point p = project(at);
  m_items.push_back({100, 0,
                     text(p.x + right, p.y + down, what, (std::string("halo mid ") + look).c_str()),
                     true});
}

std::string Sketch::picture(bool with_text) const {
  std::vector<Item> items = m_items;
  std::stable_sort(items.begin(), items.end(), [](const Item& a, const Item& b) {
    return a.layer != b.layer ? a.layer < b.layer : a.depth < b.depth;
  });
  std::string out;
  for (const Item& item : items)
    if (with_text || !item.is_text) out += item.text;
  return out;
}

std::string Sketch::overview(const std::string& title, const std::vector<Tile>& tiles,
                             int columns) {
  constexpr double width = 220, height = 196, part = 0.46;
  const int count = int(tiles.size()), rows = (count + columns - 1) / columns;
  std::string out = begin(title, width * columns, height * rows + 12);
  for (int i = 0; i < count; ++i) {
    const double x = width * (i % columns), y = height * (i / columns);
    const Tile& tile = tiles[std::size_t(i)];
    out += "<g transform=\"translate(" + number(x + width / 2 - part * kMiddleX) + " " +
           number(y + 92 - part * kMiddleY) + ")scale(" + std::to_string(part).substr(0, 4) +
           ")\">\n" + tile.picture + "</g>\n" +
           text(x + width / 2, y + height - 8, tile.title, "mid bold");
  }
  return out + "</svg>\n";
}

std::string Sketch::svg(const Caption& caption) const {
  std::string out = begin(caption.title + ": " + caption.subtitle, kWidth, kHeight) + picture(true);
  out += text(24, 36, caption.title, "title");
  out += text(24, 58, caption.subtitle, "soft");
  out += "<path class=\"rule\" d=\"M446 84V376\"/>\n";
  double y = 96;
  out += text(kPanel, y, caption.table_title, "bold");
  const double columns[] = {kPanel + 88, kPanel + 158, kPanel + 228};
  y += 24;
  for (int k = 0; k < 3; ++k) out += text(columns[k], y, std::string(1, char('x' + k)), "soft mid");
  for (int i = 0; i < 2; ++i) {
    y += 26;
    out += text(kPanel, y, i == 0 ? "slide" : "turn", "");
    for (int k = 0; k < 3; ++k) {
      const std::string& cell = caption.cells[i][k];
      out += "<rect class=\"" + cell + "\" x=\"" + number(columns[k] - 32) + "\" y=\"" +
             number(y - 15) + "\" width=\"64\" height=\"21\" rx=\"6\"/>\n";
      out += text(columns[k], y, cell, "mid");
    }
  }
  y += 18;
  for (const auto& [code, value] : caption.readings) {
    y += 21;
    out += text(kPanel, y, code, "code");
    out += text(kWidth - 24, y, value, "code\" text-anchor=\"end");
  }
  y += caption.readings.empty() ? 4 : 12;
  for (const std::string& note : caption.notes) out += text(kPanel, y += 20, note, "");
  return out + "</svg>\n";
}

}  // namespace drawings
