// A recording of the program's own world, in the page that Pintle's target knows, or in one that it is told of.
#include <pintle/record.h>

#include <BulletDynamics/Dynamics/btDynamicsWorld.h>

#include <cstdio>
#include <cstring>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

static std::string contents(const char* path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

bool can_record(btDynamicsWorld& world) {
  pintle::Recorder record(world);
  for (int step = 0; step < 3; ++step) {
    world.stepSimulation(btScalar(1) / 60, 0);
    record.step();
  }
  std::ofstream("form.html") << "<!-- pintle: runs -->";
  record.write("told.html", "form.html");
  if (contents("told.html").find("pintle-run") == std::string::npos) return false;

  std::printf("the page is %s\n", PINTLE_PAGE_TEMPLATE);
  if (std::strlen(PINTLE_PAGE_TEMPLATE) == 0) return false;
  const bool is_there = bool(std::ifstream(PINTLE_PAGE_TEMPLATE));
  try {
    record.write("run.html");
    return is_there && contents("run.html").size() > 100000;
  } catch (const std::runtime_error& error) {
    std::printf("%s\n", error.what());
    return !is_there && std::strstr(error.what(), "PINTLE_PAGE_TEMPLATE") != nullptr;
  }
}
