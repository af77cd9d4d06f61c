// Runs scenes with Bullet's joints and with Pintle's, and prints what was measured: those with a table of their own, or any that are
// asked for.
//
// The ratios are Pintle's number over the stock joint's: below 1 Pintle is better, above 1 worse.
// Errors repeat exactly on one machine, and each run is repeated here to see that they do. Times do
// not: the joints take turns, the fastest turn of each counts, and only the ratio is shown.

#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "../engines/engine.h"
#include "tables.h"

namespace {

using tables::Entry;
using tables::Output;
using tables::Plan;

std::vector<std::string> names(const std::vector<Entry>& of) {
  std::vector<std::string> names;
  for (const Entry& entry : of) names.push_back(entry.name);
  return names;
}

// Without a run.
Plan plan_of(const std::vector<Entry>& entries) {
  Plan plan;
  Output out;
  out.plan = &plan;
  for (const Entry& entry : entries) entry.run(out);
  return plan;
}

void print_list(const std::vector<Entry>& entries) {
  for (const Entry& entry : entries) {
    const Plan plan = plan_of({entry});
    for (const std::string& title : plan.titles)
      std::printf("%-17s %s\n", &title == &plan.titles.front() ? entry.name.c_str() : "",
                  title.c_str());
    std::printf("%-17s   contenders:", "");
    for (const std::string& who : plan.contenders)
      std::printf("%s %s", who == *plan.contenders.begin() ? "" : ",", who.c_str());
    std::printf("\n");
  }
}

void print_legend() {
  std::printf(
      "Pintle and Bullet's hinge, %s precision. A ratio below 1: better than stock;\n"
      "above 1: worse. Times are those of the world's whole step.\n"
      "  stock   btHingeConstraint; stock c. btHingeAccumulatedAngleConstraint;\n"
      "          s. cfm btHingeConstraint with the spring as ERP and CFM of its stop\n"
      "  pintle  pintle::QuaternionHinge; plain without block rows;\n"
      "          doc. with Formulation::document\n"
      "In rope, stock: sticks on btPoint2PointConstraint, and pintle::DistanceJoint;\n"
      "in wedge, stock: btGeneric6DofSpring2Constraint, and pintle::WedgeJoint;\n"
      "in bounce, stock: a collision, and pintle::ContactJoint.\n"
      "In scenes without a table of their own: all of Bullet's joints, all of Pintle's,\n"
      "and exact: Pintle's on ExactJointSolver.\n",
      engines::precision());
}

bool complain(const char* option, const std::string& path) {
  std::fprintf(stderr, "%s: cannot write %s\n", option, path.c_str());
  return false;
}

bool open(tables::NumberFiles& files, const std::string& csv, const std::string& json) {
  if (!csv.empty() && !files.open_csv(csv)) return complain("--csv", csv);
  if (!json.empty() && !files.open_json(json)) return complain("--json", json);
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<Entry> of_their_own = tables::tables_of_their_own();
  std::vector<Entry> all = of_their_own;
  for (const Entry& entry : tables::tables_of_errors()) all.push_back(entry);
  std::vector<std::string> scenes, contenders;
  std::string csv, json, brief;
  bool list = false, once = false;
  CLI::App app("Runs the scenes with Bullet's joints and with Pintle's, and compares them.");
  app.add_option("--scene", scenes,
                 "Only this scene, as --list names it; may be given more than once\n"
                 "(without it: those with a table of their own)")
      ->check(CLI::IsMember(names(all)))
      ->allow_extra_args(false);
  app.add_option("--contender", contenders,
                 "Only this contender, as --list names it; may be given more than once")
      ->allow_extra_args(false);
  app.add_option("--csv", csv,
                 "Also write every number to this file, one a line\n"
                 "(inf: never reached, or lost; nan: no such quantity)")
      ->take_last();
  app.add_option("--json", json,
                 "The same as an array of objects\n"
                 "(\"inf\": never reached, or lost; null: no such quantity)")
      ->take_last();
  app.add_option("--brief", brief,
                 "Also write the documentation's table of scenes to this file\n"
                 "(without --scene: those that it is of)");
  app.add_flag("--once", once, "Run each once: times are rough, and nothing is repeated");
  app.add_flag("--list", list, "Name the scenes and their contenders, and run nothing");
  CLI11_PARSE(app, argc, argv);

  if (scenes.empty())
    scenes = list ? names(all) : brief.empty() ? names(of_their_own) : tables::Brief::tables();
  std::vector<Entry> chosen;
  for (const std::string& name : scenes) {
    for (const Entry& entry : all)
      if (entry.name == name) chosen.push_back(entry);
  }
  if (list) {
    print_list(chosen);
    return EXIT_SUCCESS;
  }
  const Plan plan = plan_of(chosen);
  for (const std::string& who : contenders) {
    if (plan.contenders.count(who) > 0) continue;
    std::fprintf(stderr, "--contender: %s is in none of the scenes; --list names who is\n",
                 who.c_str());
    return EXIT_FAILURE;
  }
  Output out;
  out.contenders = contenders;
  out.once = once;
  if (!open(out.files, csv, json)) return EXIT_FAILURE;

  Progress progress(plan.cases);
  out.progress = &progress;
  print_legend();
  for (const Entry& entry : chosen) entry.run(out);
  progress.clear();
  if (!out.files.close()) {
    std::fprintf(stderr, "--csv, --json: a file could not be written to its end\n");
    return EXIT_FAILURE;
  }
  if (!brief.empty() && !out.brief.write(brief)) {
    std::fprintf(stderr, "--brief: %s lacks a number, or cannot be written\n", brief.c_str());
    return EXIT_FAILURE;
  }
  return out.all_repeated ? EXIT_SUCCESS : EXIT_FAILURE;
}
