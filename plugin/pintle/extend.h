// Purpose: what a joint of one's own is written with: the base classes, the bodies in the document's notation, rows,
// and the equations. Only here Eigen is needed (CMake: pintle::extend_single, pintle::extend_double), and the
// names of this header may change from one version to the next.
// tests/consumer/own_joint.cpp is an example.
#pragma once

#include <pintle/body_pair.h>
#include <pintle/equations/angle_about.h>
#include <pintle/equations/angular_limit.h>
#include <pintle/equations/cone_twist.h>
#include <pintle/equations/constant_velocity.h>
#include <pintle/equations/contact.h>
#include <pintle/equations/distance.h>
#include <pintle/equations/dot.h>
#include <pintle/equations/dot_hinge.h>
#include <pintle/equations/effective_mass.h>
#include <pintle/equations/gear.h>
#include <pintle/equations/impulse.h>
#include <pintle/equations/impulse_reaction.h>
#include <pintle/equations/orientation_lock.h>
#include <pintle/equations/position.h>
#include <pintle/equations/quaternion.h>
#include <pintle/equations/quaternion_hinge.h>
#include <pintle/equations/quaternion_hinge_limit.h>
#include <pintle/equations/slider.h>
#include <pintle/equations/swing_twist.h>
#include <pintle/equations/two_point_hinge.h>
#include <pintle/equations/universal.h>
#include <pintle/equations/velocity.h>
#include <pintle/equations/wedge.h>
#include <pintle/frame.h>
#include <pintle/joints/frame_joint.h>
#include <pintle/joints/joint.h>
#include <pintle/joints/joint_of.h>
#include <pintle/joints/observed_joint_rows.h>
#include <pintle/joints/standalone_joint.h>
#include <pintle/rows/far_limit.h>
#include <pintle/rows/limit_reach.h>
#include <pintle/rows/position_rows.h>
#include <pintle/rows/row.h>
#include <pintle/rows/row_shape.h>
#include <pintle/rows/step_motion.h>
#include <pintle/rows/swing_rows.h>
#include <pintle/rows/turn_of_step.h>
#include <pintle/rows/unwrapped_angle.h>

#include <LinearMath/btIDebugDraw.h>
