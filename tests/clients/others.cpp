// Examples, and bases of examples, that use joints and are compiled and linked only.
#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include <CommonInterfaces/CommonDeformableBodyBase.h>
#include <CommonInterfaces/CommonExampleInterface.h>
#include <CommonInterfaces/CommonMultiBodyBase.h>

CommonExampleInterface* SoftDemoCreateFunc(CommonExampleOptions&);
CommonExampleInterface* MultiThreadedDemoCreateFunc(CommonExampleOptions&);

CommonExampleInterface::CreateFunc* volatile linked[] = {SoftDemoCreateFunc,
                                                         MultiThreadedDemoCreateFunc};

int main() { return linked[0] == linked[1]; }
