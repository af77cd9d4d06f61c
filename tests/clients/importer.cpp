// Bullet's importer of .bullet files, whose joints are those that it is compiled with.
#include <btBulletDynamicsCommon.h>
#include <btBulletWorldImporter.h>

#include <cstdio>

int main(int argc, char** argv) {
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);
  btBulletWorldImporter importer(&world);
  for (int i = 1; i < argc; ++i)
    if (!importer.loadFile(argv[i])) return 1;
  std::printf("%d joints\n", world.getNumConstraints());
}
