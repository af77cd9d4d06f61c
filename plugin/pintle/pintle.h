// Purpose: all joints. Each has a header of its own, too: nobody need pay for those that he does not use. The exact
// solvers (solver/exact_joint_solver.h) and the joints that are there for comparison (unstable/) are not here.
#pragma once

#include <pintle/joints/angular_limit.h>
#include <pintle/joints/ball_joint.h>
#include <pintle/joints/cone_twist_joint.h>
#include <pintle/joints/constant_velocity_joint.h>
#include <pintle/joints/contact_joint.h>
#include <pintle/joints/distance_joint.h>
#include <pintle/joints/dot_hinge.h>
#include <pintle/joints/draw_joints.h>
#include <pintle/joints/fixed_joint.h>
#include <pintle/joints/gear_joint.h>
#include <pintle/joints/generic_6dof_joint.h>
#include <pintle/joints/generic_6dof_spring_2_joint.h>
#include <pintle/joints/generic_6dof_spring_joint.h>
#include <pintle/joints/hinge_2_joint.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/joints/slider_joint.h>
#include <pintle/joints/two_point_hinge.h>
#include <pintle/joints/universal_joint.h>
#include <pintle/joints/wedge_joint.h>
