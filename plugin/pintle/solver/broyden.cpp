#include <pintle/solver/broyden.h>

#include <pintle/vectors.h>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

auto map(std::vector<double>& of) {
  return Eigen::Map<Eigen::VectorXd>(of.data(), Eigen::Index(of.size()));
}

}  // namespace

bool Broyden::step(const JointMatrix& K, const std::vector<double>& x, std::vector<double>& y) {
  if (m_steps.size() <= m_count) m_steps.emplace_back();
  Step& now = m_steps[m_count];
  now.s = now.Ks = x;
  K.solve(now.s.data());
  for (size_t j = 0; j < m_count; ++j) {
    Step& before = m_steps[j];
    const double part = map(before.Ks).dot(map(now.s)) / before.length2;
    if (j + 1 < m_count) {
      map(now.s) += part * map(m_steps[j + 1].s);
      map(now.Ks) += part * map(m_steps[j + 1].Ks);
    } else {
      map(now.s) /= 1 - part;
      map(now.Ks) /= 1 - part;
    }
  }
  now.length2 = map(now.s).dot(map(now.Ks));
  const auto isLonger = [&](size_t back) {
    return m_count >= back && !(now.length2 <= m_steps[m_count - back].length2);
  };
  if (!(now.length2 >= 0) || (isLonger(1) && (!m_may_wander || isLonger(2)))) return false;
  map(y) += map(now.s);
  ++m_count;
  return true;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
