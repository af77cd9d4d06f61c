#include <pintle/solver/exact_joint_solver_pool.h>

#include <stdexcept>
#include <string>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

std::vector<ExactJointSolver*> makeSolvers(int count) {
  if (count < 1)
    throw std::invalid_argument("pintle::ExactJointSolverPool: count = " + std::to_string(count) +
                                ": must be 1 or more");
  std::vector<ExactJointSolver*> all;
  for (int i = 0; i < count; ++i) all.push_back(new ExactJointSolver);
  return all;
}

// Bullet copies the array.
std::vector<btConstraintSolver*> asBullets(const std::vector<ExactJointSolver*>& solvers) {
  return {solvers.begin(), solvers.end()};
}

}  // namespace

ExactJointSolverPool::ExactJointSolverPool(int count) : ExactJointSolverPool(makeSolvers(count)) {}

ExactJointSolverPool::ExactJointSolverPool(const Solvers& solvers)
    : btConstraintSolverPoolMt(asBullets(solvers).data(), int(solvers.size())), m_solvers(solvers) {
  for (ExactJointSolver* of : m_solvers) of->shareMemoryOf(*m_solvers.front());
}

void ExactJointSolverPool::setOptions(const SolverOptions& options) {
  for (ExactJointSolver* of : m_solvers) of->setOptions(options);
}

void ExactJointSolverPool::setUpgradesBulletJoints(bool upgrades) {
  for (ExactJointSolver* of : m_solvers) of->setUpgradesBulletJoints(upgrades);
}

void ExactJointSolverPool::prepareSolve(int numBodies, int numManifolds) {
  m_solvers.front()->prepareSolve(numBodies, numManifolds);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
