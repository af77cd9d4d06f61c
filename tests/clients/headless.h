// Bullet's own examples without a window. No joint is named here: the programs that include this may rename them.
#pragma once

#include <btBulletDynamicsCommon.h>

#include <CommonInterfaces/CommonExampleInterface.h>
#include <CommonInterfaces/CommonGUIHelperInterface.h>
#include <CommonInterfaces/CommonParameterInterface.h>

CommonExampleInterface* AllConstraintCreateFunc(CommonExampleOptions&);
CommonExampleInterface* ConstraintCreateFunc(CommonExampleOptions&);
CommonExampleInterface* TestHingeTorqueCreateFunc(CommonExampleOptions&);
CommonExampleInterface* MotorControlCreateFunc(CommonExampleOptions&);
CommonExampleInterface* ET_BridgeCreateFunc(CommonExampleOptions&);
CommonExampleInterface* ET_ChainCreateFunc(CommonExampleOptions&);
CommonExampleInterface* ET_NewtonsCradleCreateFunc(CommonExampleOptions&);
CommonExampleInterface* ET_NewtonsRopeCradleCreateFunc(CommonExampleOptions&);
CommonExampleInterface* ET_MultiPendulumCreateFunc(CommonExampleOptions&);
CommonExampleInterface* ET_SimpleJointCreateFunc(CommonExampleOptions&);
CommonExampleInterface* ForkLiftCreateFunc(CommonExampleOptions&);
CommonExampleInterface* Hinge2VehicleCreateFunc(CommonExampleOptions&);
CommonExampleInterface* BenchmarkCreateFunc(CommonExampleOptions&);
CommonExampleInterface* VoronoiFractureCreateFunc(CommonExampleOptions&);

namespace headless {

struct Scene {
  const char* name;
  CommonExampleInterface::CreateFunc* create;
  int option;
};
inline const Scene scenes[] = {
    {"motor", MotorControlCreateFunc, 0},
    {"motorized_hinge", ConstraintCreateFunc, 0},
    {"hinge_torque", TestHingeTorqueCreateFunc, 0},
    {"constraints", AllConstraintCreateFunc, 0},
    {"simple_joint", ET_SimpleJointCreateFunc, 0},
    {"chain", ET_ChainCreateFunc, 0},
    {"bridge", ET_BridgeCreateFunc, 0},
    {"newtons_cradle", ET_NewtonsCradleCreateFunc, 0},
    {"newtons_rope_cradle", ET_NewtonsRopeCradleCreateFunc, 0},
    {"multi_pendulum", ET_MultiPendulumCreateFunc, 0},
    {"fork_lift", ForkLiftCreateFunc, 0},
    {"hinge_2_vehicle", Hinge2VehicleCreateFunc, 0},
    {"ragdolls", BenchmarkCreateFunc, 3},
    {"voronoi_fracture", VoronoiFractureCreateFunc, 0},
};

// Sliders and buttons that nobody moves.
struct NoParameters : CommonParameterInterface {
  void registerSliderFloatParameter(SliderParams&) override {}
  void registerButtonParameter(ButtonParams&) override {}
  void registerComboBox(ComboBoxParams&) override {}
  void syncParameters() override {}
  void removeAllParameters() override {}
  void setSliderValue(int, double) override {}
};

struct NoLines : btIDebugDraw {
  void drawLine(const btVector3&, const btVector3&, const btVector3&) override {}
  void drawContactPoint(const btVector3&, const btVector3&, btScalar, int,
                        const btVector3&) override {}
  void reportErrorWarning(const char*) override {}
  void draw3dText(const btVector3&, const char*) override {}
  void setDebugMode(int) override {}
  int getDebugMode() const override { return 0; }
};

// Examples hand over the world for its lines to be drawn.
struct WorldCatcher : DummyGUIHelper {
  btDiscreteDynamicsWorld* world = nullptr;
  NoParameters parameters;
  NoLines lines;
  void createPhysicsDebugDrawer(btDiscreteDynamicsWorld* made) override {
    world = made;
    world->setDebugDrawer(&lines);
  }
  CommonParameterInterface* getParameterInterface() override { return &parameters; }
};

}  // namespace headless
