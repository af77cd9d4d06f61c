// The rows of any graph of joints in a JointMatrix, and in Eigen's dense ones, against which it is tested.
#pragma once

#include <pintle/solver/system/joint_matrix.h>

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include <algorithm>
#include <numeric>

#include "joint_graphs.h"

namespace joint_matrix_problem {

using pintle::InverseInertia;
using pintle::IslandBody;
using pintle::JointMatrix;
using pintle::Matrix3d;
using pintle::RowJacobian;
using pintle::Vector3d;
using pintle::Vector6d;
using namespace joint_graphs;

inline IslandBody body(Random& random, bool is_locked) {
  IslandBody of = {};
  of.mass = random.uniform(0.1, 3);
  of.inverse_mass.setConstant(1 / of.mass);
  const Matrix3d some = numbers(3, 3, random);
  of.inertia = some * some.transpose() + 0.3 * Matrix3d::Identity();
  of.inverse_inertia = of.inertia.inverse();
  of.scale[0] = std::sqrt(of.mass);
  of.scale[1] = std::sqrt(of.inertia.trace() / 3);
  of.locked = {};
  if (!is_locked) return of;
  of.locked = {false, true, false, true, true, false};
  of.inverse_mass[1] = 0;
  of.inverse_inertia.setZero();
  of.inverse_inertia(2, 2) = 1 / of.inertia(2, 2);
  return of;
}

// The same rows in a JointMatrix and in dense ones.
struct Problem {
  Eigen::MatrixXd J, acting, inverse_A, K;
  std::vector<std::vector<char>> acts;  ///< of each joint
  std::vector<int> first;
  std::vector<double> roots;  ///< of K, of each row

  Problem(JointMatrix& matrix, const Graph& graph, const std::vector<int>& sizes, bool all_act,
          Random& random) {
    const int n = graph.bodies;
    inverse_A.setZero(6 * n, 6 * n);
    std::vector<InverseInertia>& bodies = matrix.bodies();
    bodies.clear();
    for (int b = 0; b < n; ++b) {
      const Matrix3d some = numbers(3, 3, random);
      const Matrix3d stiffness =
          below(random, 2) ? Matrix3d(some * some.transpose()) : Matrix3d(Matrix3d::Zero());
      bodies.emplace_back(body(random, below(random, 8) == 0), stiffness);
      inverse_A.block<3, 3>(6 * b, 6 * b) = bodies.back().linear.asDiagonal();
      inverse_A.block<3, 3>(6 * b + 3, 6 * b + 3) = bodies.back().angular;
    }
    int rows = 0;
    for (const int size : sizes) {
      first.push_back(rows);
      rows += size;
    }
    J.setZero(rows, 6 * n);
    Eigen::VectorXd softness = Eigen::VectorXd::Ones(rows);
    for (size_t c = 0; c < sizes.size(); ++c) {
      acts.emplace_back();
      for (int i = 0; i < sizes[c]; ++i) {
        acts[c].push_back(all_act || below(random, 4) > 0);
        const int r = first[c] + i;
        const RowJacobian row = {numbers(3, 1, random), numbers(3, 1, random),
                                 numbers(3, 1, random), numbers(3, 1, random)};
        const double root_K = random.uniform(0.5, 2);
        roots.push_back(root_K);
        if (acts[c].back()) softness[r] = 0.1;
        for (int side = 0; side < 2; ++side) {
          const int b = graph.joints[c][size_t(side)];
          if (b < 0) continue;
          J.block<1, 3>(r, 6 * b) = row.L(side).transpose() / root_K;
          J.block<1, 3>(r, 6 * b + 3) = row.A(side).transpose() / root_K;
        }
        matrix.setRow(int(c), i, row, root_K, 1 / root_K);
        matrix.setActing(matrix.row(int(c), i), acts[c].back(), softness[r]);
      }
    }
    acting = J;
    for (size_t c = 0; c < acts.size(); ++c)
      for (size_t i = 0; i < acts[c].size(); ++i)
        if (!acts[c][i]) acting.row(first[c] + Eigen::Index(i)).setZero();
    K = acting * inverse_A * acting.transpose();
    K.diagonal() += softness;
  }

  void compare(JointMatrix& matrix, const std::string& name, Random& random) const {
    ASSERT_TRUE(matrix.factorise(0)) << name;
    const Eigen::VectorXd b = numbers(int(K.rows()), 1, random), x = K.llt().solve(b);
    std::vector<double> y(matrix.vectorSize(), 0.);
    for (size_t c = 0; c < first.size(); ++c)
      for (size_t i = 0; i < acts[c].size(); ++i)
        y[matrix.row(int(c), int(i))] = b[first[c] + Eigen::Index(i)];
    matrix.solve(y.data());
    Eigen::VectorXd found(b.size());
    for (size_t c = 0; c < first.size(); ++c)
      for (size_t i = 0; i < acts[c].size(); ++i)
        found[first[c] + Eigen::Index(i)] = y[matrix.row(int(c), int(i))];
    ASSERT_LE((found - x).norm(), 1e-9 * x.norm()) << name;
    std::vector<Vector6d> v(size_t(J.cols() / 6), Vector6d::Ones());
    matrix.addResponse(y.data(), v.data());
    const Eigen::VectorXd expected =
        inverse_A * J.transpose() * x + Eigen::VectorXd::Ones(J.cols());
    for (size_t k = 0; k < v.size(); ++k)
      ASSERT_LT((v[k] - expected.segment<6>(6 * Eigen::Index(k))).norm(), 1e-8 * expected.norm())
          << name;
    comparePaths(matrix, name, random);
    compareResidual(matrix, name, random);
    std::vector<Vector6d> w;
    Eigen::VectorXd all_w(J.cols());
    for (size_t k = 0; k < v.size(); ++k) {
      w.push_back(numbers(6, 1, random));
      all_w.segment<6>(6 * Eigen::Index(k)) = w.back();
    }
    std::fill(y.begin(), y.end(), 0.);
    matrix.subtractVelocities(w.data(), y.data());
    const Eigen::VectorXd along = acting * all_w;
    for (size_t c = 0; c < first.size(); ++c)
      for (size_t i = 0; i < acts[c].size(); ++i)
        ASSERT_NEAR(y[matrix.row(int(c), int(i))], -along[first[c] + Eigen::Index(i)], 1e-12)
            << name;
  }
  void compareResidual(const JointMatrix& matrix, const std::string& name, Random& random) const {
    const Eigen::VectorXd v = numbers(int(J.cols()), 1, random),
                          aims = numbers(int(J.rows()), 1, random),
                          impulses = numbers(int(J.rows()), 1, random),
                          softness = (K - acting * inverse_A * acting.transpose()).diagonal();
    std::vector<Vector6d> of_bodies;
    for (Eigen::Index k = 0; k < v.size(); k += 6) of_bodies.push_back(v.segment<6>(k));
    std::vector<double> aim(matrix.vectorSize(), 0.), y = aim, x = aim;
    const auto forEach = [&](const auto& visit) {
      for (size_t c = 0; c < first.size(); ++c)
        for (size_t i = 0; i < acts[c].size(); ++i)
          visit(first[c] + Eigen::Index(i), matrix.row(int(c), int(i)), acts[c][i] != 0);
    };
    forEach([&](Eigen::Index r, size_t at, bool) {
      aim[at] = aims[r];
      y[at] = impulses[r];
    });
    const auto find = [&] {
      return matrix.findResidual(aim.data(), y.data(), of_bodies.data(), x.data());
    };
    const double most = find();
    double largest = 0;
    size_t last = aim.size();
    forEach([&](Eigen::Index r, size_t at, bool is_acting) {
      const double left =
          is_acting ? aims[r] - softness[r] * impulses[r] - acting.row(r).dot(v) : 0;
      ASSERT_NEAR(x[at], left, 1e-12) << name;
      largest = std::max(largest, std::abs(left) * roots[size_t(r)]);
      if (is_acting) last = at;
    });
    ASSERT_NEAR(most, largest, 1e-12) << name;
    if (last == aim.size()) return;
    aim[last] = std::nan("");
    ASSERT_EQ(find(), pintle::infinity) << name;
  }
  // Other rows of those that are set.
  void actOtherwise(JointMatrix& matrix, Random& random) {
    acting = J;
    for (size_t c = 0; c < acts.size(); ++c)
      for (size_t i = 0; i < acts[c].size(); ++i) {
        const Eigen::Index r = first[c] + Eigen::Index(i);
        acts[c][i] = below(random, 2);
        matrix.setActing(matrix.row(int(c), int(i)), acts[c][i], 0.2);
        if (!acts[c][i]) acting.row(r).setZero();
      }
    K = acting * inverse_A * acting.transpose();
    for (size_t c = 0; c < acts.size(); ++c)
      for (size_t i = 0; i < acts[c].size(); ++i) {
        const Eigen::Index r = first[c] + Eigen::Index(i);
        K(r, r) += acts[c][i] ? 0.2 : 1;
      }
  }

  // -R^T K^-1 R, R = J A^-1, of impulses on any bodies: by the blocks that two of them share. And A^-1 of bodies that are unknowns.
  void comparePaths(JointMatrix& matrix, const std::string& name, Random& random) const {
    const Eigen::MatrixXd R = acting * inverse_A, all = R.transpose() * K.llt().solve(R);
    const auto bodies = int(J.cols() / 6);
    pintle::PathBlocks blocks;
    std::vector<size_t> end = {0};
    Eigen::MatrixXd impulses = Eigen::MatrixXd::Zero(J.cols(), 2 * bodies);
    for (Eigen::Index i = 0; i < impulses.cols(); ++i) {
      const JointMatrix::Joint on = {below(random, bodies + 1) - 1, below(random, bodies)};
      pintle::RowJacobian along;
      Eigen::Vector3d* const parts[] = {&along.L_a, &along.A_a, &along.L_b, &along.A_b};
      for (int k = 0; k < 4; ++k) {
        *parts[k] = numbers(3, 1, random);
        if (on[size_t(k / 2)] >= 0 && (k > 1 || on[0] != on[1]))
          impulses.col(i).segment<3>(6 * on[size_t(k / 2)] + 3 * (k % 2)) = *parts[k];
      }
      matrix.findPath({on[0] == on[1] ? -1 : on[0], on[1]}, along, blocks);
      size_t most = 0;
      for (const int body : on) most += body < 0 ? 0 : size_t(matrix.pathLength(body));
      EXPECT_LE(blocks.size() - end.back(), most) << name;
      end.push_back(blocks.size());
    }
    // What is read of what they all add.
    Eigen::MatrixXd response = -all;
    for (int b = 0; b < bodies; ++b)
      if (matrix.isUnknown(b))
        response.block<6, 6>(6 * b, 6 * b) += inverse_A.block<6, 6>(6 * b, 6 * b);
    const Eigen::MatrixXd expected = impulses.transpose() * response * impulses;
    std::vector<double> state(matrix.vectorSize());
    for (size_t i = 0; i + 1 < end.size(); ++i) {
      std::fill(state.begin(), state.end(), 0.);
      for (size_t p = end[i]; p < end[i + 1]; ++p)
        for (size_t k = 0; k < 4; ++k) state[blocks.begin()[p].at + k] += blocks.begin()[p].adds[k];
      for (size_t j = 0; j + 1 < end.size(); ++j) {
        double read = 0;
        for (size_t p = end[j]; p < end[j + 1]; ++p)
          for (size_t k = 0; k < 4; ++k)
            read += blocks.begin()[p].reads[k] * state[blocks.begin()[p].at + k];
        ASSERT_NEAR(read, expected(Eigen::Index(j), Eigen::Index(i)),
                    1e-8 * (1 + expected.cwiseAbs().maxCoeff()))
            << name << ", " << i << " and " << j;
      }
    }
  }
};

}  // namespace joint_matrix_problem
