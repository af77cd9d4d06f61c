// MuJoCo: reduced coordinates of a spanning tree, loops closed by soft equalities, its default
// solver and integrator. The scene goes in as its XML.

#include <mujoco/mujoco.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cstring>
#include <sstream>
#include <stdexcept>

#include "peers.h"

namespace engines {
namespace {

using scenes::Isometry3d;
using scenes::Joint;
using scenes::Kind;
using scenes::Scene;
using scenes::Vector3d;

std::string text(const Vector3d& v) {
  std::ostringstream out;
  out.precision(17);
  out << v.x() << ' ' << v.y() << ' ' << v.z();
  return out.str();
}
std::string text(const Isometry3d& pose) {
  const Eigen::Quaterniond q(pose.linear());
  std::ostringstream out;
  out.precision(17);
  out << "pos=\"" << text(Vector3d(pose.translation())) << "\" quat=\"" << q.w() << ' ' << q.x()
      << ' ' << q.y() << ' ' << q.z() << '"';
  return out.str();
}

class Xml {
 public:
  explicit Xml(const Scene& scene) : scene_(scene), parent_(scene.bodies.size(), -1) {
    // The first joint that leads to a body is in the tree, the others close loops.
    for (size_t i = 0; i < scene.joints.size(); ++i) {
      const size_t b = size_t(scene.joints[i].b);
      if (parent_[b] < 0) {
        parent_[b] = int(i);
      } else {
        loops_.push_back(scene.joints[i]);
      }
    }
  }

  std::string write() {
    out_.precision(17);
    out_ << "<mujoco><compiler angle=\"radian\"/><option gravity=\"0 0 " << -scene_.gravity
         << "\"/><worldbody>";
    children(0);
    for (size_t body = 1; body < scene_.bodies.size(); ++body) {
      if (parent_[body] < 0) add(int(body), -1);  // free
    }
    out_ << "</worldbody><equality>";
    for (const Joint& loop : loops_) close(loop);
    out_ << "</equality><actuator>" << motors_.str() << "</actuator></mujoco>";
    return out_.str();
  }

 private:
  void children(int body) {
    for (size_t i = 0; i < scene_.joints.size(); ++i) {
      const Joint& joint = scene_.joints[i];
      if (joint.a == body && parent_[size_t(joint.b)] == int(i)) add(joint.b, int(i));
    }
  }

  void add(int index, int joint_index) {
    const scenes::Body& body = scene_.bodies[size_t(index)];
    const int parent = joint_index < 0 ? 0 : scene_.joints[size_t(joint_index)].a;
    const Isometry3d pose = scene_.bodies[size_t(parent)].pose.inverse() * body.pose;
    out_ << "<body name=\"b" << index << "\" " << text(pose) << "><inertial pos=\"0 0 0\" mass=\""
         << body.mass << "\" diaginertia=\"" << text(body.inertia) << "\"/>";
    if (joint_index < 0) {
      out_ << "<freejoint/>";
    } else {
      joint(scene_.joints[size_t(joint_index)], joint_index);
    }
    children(index);
    out_ << "</body>";
  }

  void joint(const Joint& joint, int index) {
    const std::string at = "pos=\"" + text(Vector3d(joint.in_b.translation())) + "\"";
    const auto axis = [&](int i) {
      return " axis=\"" + text(Vector3d(joint.in_b.linear().col(i))) + "\"";
    };
    if (joint.kind == Kind::ball) {
      out_ << "<joint type=\"ball\" " << at << "/>";
    } else if (joint.kind == Kind::hinge) {
      out_ << "<joint name=\"j" << index << "\" type=\"hinge\" " << at << axis(2);
      if (joint.range.limited())
        out_ << " limited=\"true\" range=\"" << joint.range.low << ' ' << joint.range.high << '"';
      out_ << "/>";
      motor(joint, index);
    } else if (joint.kind == Kind::slider) {
      out_ << "<joint name=\"j" << index << "\" type=\"slide\" " << at << axis(0);
      if (joint.spring.frequency > 0) {
        const auto inverse = [&](int body) {
          return body == 0 ? 0 : 1 / scene_.bodies[size_t(body)].mass;
        };
        const double mass = 1 / (inverse(joint.a) + inverse(joint.b));
        const double w = 2 * scenes::pi * joint.spring.frequency;
        out_ << " stiffness=\"" << mass * w * w << "\" damping=\""
             << 2 * joint.spring.damping_ratio * mass * w << '"';
      }
      out_ << "/>";
      motor(joint, index);
    } else if (joint.kind == Kind::universal) {  // about z of a, then about y of b
      out_ << "<joint type=\"hinge\" " << at << axis(2) << "/><joint type=\"hinge\" " << at
           << axis(1) << "/>";
    }  // fixed: no joint
  }

  void motor(const Joint& joint, int index) {
    if (!joint.motor.speed) return;
    motors_ << "<velocity joint=\"j" << index << "\" kv=\"" << velocity_gain
            << "\" forcelimited=\"true\" forcerange=\"" << -joint.motor.max_torque << ' '
            << joint.motor.max_torque << "\"/>";
  }

  // A hinge by two points of its axis.
  void close(const Joint& joint) {
    const auto connect = [&](const Vector3d& in_b) {
      out_ << "<connect body1=\"b" << joint.b << "\" anchor=\"" << text(in_b) << "\""
           << (joint.a == 0 ? "" : " body2=\"b" + std::to_string(joint.a) + "\"") << "/>";
    };
    const Vector3d p = joint.in_b.translation(), z = joint.in_b.linear().col(2);
    if (joint.kind == Kind::ball) return connect(p);
    if (joint.kind == Kind::hinge) {
      connect(p - 0.5 * z);
      connect(p + 0.5 * z);
      return;
    }
    out_ << "<weld body1=\"b" << joint.b << "\" body2=\"b" << joint.a << "\"/>";
  }

 public:
  // MuJoCo has no equality that closes a loop through one of these.
  bool unknown() const {
    return std::any_of(loops_.begin(), loops_.end(), [](const Joint& loop) {
      return loop.kind == Kind::slider || loop.kind == Kind::universal;
    });
  }

 private:
  static constexpr double velocity_gain = 1e4;  // N m s: a stiff motor

  const Scene& scene_;
  std::vector<int> parent_;  // joint that leads to each body
  std::vector<Joint> loops_;
  std::ostringstream out_, motors_;
};

class MujocoEngine : public Engine {
 public:
  MujocoEngine(const Scene& scene, mjModel* model, int iterations)
      : scene_(scene), model_(model), data_(mj_makeData(model)) {
    model_->opt.iterations = iterations;
    start();
  }
  ~MujocoEngine() override {
    mj_deleteData(data_);
    mj_deleteModel(model_);
  }

  void drive(double time, double dt) override {
    model_->opt.timestep = dt;
    int motor = 0;
    for (const Joint& joint : scene_.joints) {
      if (joint.motor.speed) data_->ctrl[motor++] = joint.motor.speed(time);
    }
  }
  void step(double) override {
    mj_step(model_, data_);
    looked_ = false;
  }
  State state(int index) const override {
    if (index == 0) return {scene_.bodies[0].pose, Vector3d::Zero(), Vector3d::Zero()};
    if (!looked_) {
      mj_kinematics(model_, data_);
      mj_comPos(model_, data_);
      mj_comVel(model_, data_);
      looked_ = true;
    }
    const int body = id(index);
    State state;
    state.pose.setIdentity();
    mjtNum velocity[6];  // angular, linear
    mj_objectVelocity(model_, data_, mjOBJ_BODY, body, velocity, 0);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) state.pose.linear()(i, j) = data_->xmat[9 * body + 3 * i + j];
      state.pose.translation()[i] = data_->xpos[3 * body + i];
      state.angular_velocity[i] = velocity[i];
      state.velocity[i] = velocity[3 + i];
    }
    return state;
  }

 private:
  int id(int index) const {
    return mj_name2id(model_, mjOBJ_BODY, ("b" + std::to_string(index)).c_str());
  }

  // Joint velocities from those of the bodies: the least squares that their Jacobians give.
  void start() {
    mj_forward(model_, data_);
    const int dofs = model_->nv;
    Eigen::MatrixXd J(6 * (scene_.bodies.size() - 1), dofs);
    Eigen::VectorXd v(J.rows());
    std::vector<mjtNum> linear(3 * size_t(dofs)), angular(3 * size_t(dofs));
    for (size_t i = 1; i < scene_.bodies.size(); ++i) {
      mj_jacBodyCom(model_, data_, linear.data(), angular.data(), id(int(i)));
      const Eigen::Index row = 6 * Eigen::Index(i - 1);
      for (int k = 0; k < 3; ++k) {
        for (int dof = 0; dof < dofs; ++dof) {
          J(row + k, dof) = linear[size_t(k * dofs + dof)];
          J(row + 3 + k, dof) = angular[size_t(k * dofs + dof)];
        }
      }
      v.segment<3>(row) = scene_.bodies[i].velocity;
      v.segment<3>(row + 3) = scene_.bodies[i].angular_velocity;
    }
    const Eigen::VectorXd speeds = (J.transpose() * J).ldlt().solve(J.transpose() * v);
    for (int dof = 0; dof < dofs; ++dof) data_->qvel[dof] = speeds[dof];
  }

  const Scene& scene_;
  mjModel* model_;
  mjData* data_;
  mutable bool looked_ = false;
};

}  // namespace

std::unique_ptr<Engine> make_mujoco(const Scene& scene, int iterations) {
  mju_user_warning = [](const char*) {};  // else it writes a file where it is run
  if (!is_known(scene)) return nullptr;
  Xml xml(scene);
  if (xml.unknown()) return nullptr;
  const std::string written = xml.write();
  mjVFS files;
  mj_defaultVFS(&files);
  mj_makeEmptyFileVFS(&files, "scene.xml", int(written.size()));
  std::memcpy(files.filedata[0], written.data(), written.size());
  char error[500] = "";
  mjModel* const model = mj_loadXML("scene.xml", &files, error, sizeof error);
  mj_deleteVFS(&files);
  if (model == nullptr) throw std::runtime_error(scene.name + ": " + error);
  return std::make_unique<MujocoEngine>(scene, model, iterations);
}

}  // namespace engines
