#include <pintle/solver/system/broyden.h>

#include <pintle/vectors.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

bool Broyden::step(const JointMatrix& K, const std::vector<double>& x, std::vector<double>& y) {
  using Map = Eigen::Map<Eigen::VectorXd>;
  using Before = Eigen::Map<const Eigen::VectorXd>;
  m_unknowns = x.size();
  const auto n = Eigen::Index(m_unknowns);
  const size_t before = count();
  m_numbers.insert(m_numbers.end(), x.begin(), x.end());
  m_numbers.insert(m_numbers.end(), x.begin(), x.end());
  double* const first = m_numbers.data() + 2 * before * m_unknowns;
  Map now(first, n), K_now(first + n, n);
  K.solve(first);
  for (size_t j = 0; j < before; ++j) {
    const double part = Before(Ks(j), n).dot(now) / m_length2[j];
    if (j + 1 < before) {
      now += part * Before(s(j + 1), n);
      K_now += part * Before(Ks(j + 1), n);
    } else {
      now /= 1 - part;
      K_now /= 1 - part;
    }
  }
  const double length2 = now.dot(K_now);
  const auto isLonger = [&](size_t back) {
    return before >= back && !(length2 <= m_length2[before - back]);
  };
  if (!(length2 >= 0) || (isLonger(1) && (!m_may_wander || isLonger(2)))) {
    m_numbers.resize(2 * before * m_unknowns);
    return false;
  }
  Map(y.data(), n) += now;
  m_length2.push_back(length2);
  return true;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
